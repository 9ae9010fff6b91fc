"""KIN007 reports robots without links."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model
from urdfcheck.model.link_graph import KinematicGraph


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    KinematicGraph.from_model(model)  # raises if the xacro is not expanded: its links are still to come
    if not model.links:
        yield rule.finding("none", at=model, robot=model.name)
