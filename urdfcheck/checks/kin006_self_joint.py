"""KIN006 reports joints whose parent is their child."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model

# urdfdom makes the link its own child: what walks the tree never ends.
_REACHED = {"urdfdom": "loads it with the link as its own child", "pinocchio": "refuses the file, or crashes"}
_LOST = {"urdfdom": "drops the link without a message", "bullet": "drops the link without a message"}


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    for joint in model.joints:
        attribute = joint.child_attribute
        if attribute is not None and attribute.value and joint.parent == attribute.value:
            is_reached = any(other.child == joint.child and other.parent != joint.child for other in model.joints)
            yield rule.finding(
                "itself",
                at=attribute,
                consequences=_REACHED if is_reached else _LOST,
                joint=joint.name,
                link=attribute.value,
            )
