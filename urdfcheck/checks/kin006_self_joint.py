"""KIN006 reports joints whose parent is their child."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for joint in model.joints:
        child = joint.element.find_child("child")
        if child is not None and joint.child and joint.parent == joint.child:
            yield rule.finding("itself", at=child.attributes["link"], joint=joint.name, link=joint.child)
