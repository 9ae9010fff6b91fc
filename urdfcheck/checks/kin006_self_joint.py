"""KIN006 reports joints whose parent is their child."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for joint in model.joints:
        attribute = joint.child_attribute
        if attribute is not None and attribute.value and joint.parent == attribute.value:
            yield rule.finding("itself", at=attribute, joint=joint.name, link=attribute.value)
