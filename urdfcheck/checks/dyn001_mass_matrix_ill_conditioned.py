"""DYN001: no link has so little inertia beside what it carries that two joints move the same."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model
from urdfcheck.model.motion.joint_loads import mobility


def check(model: Model, rule: Rule, *, limit: float) -> Iterator[Finding]:
    found = mobility(model)
    if found is None or found.light is None or not found.number > limit:
        return
    joint = found.light
    link = model.link_by_name[joint.child]
    yield rule.finding(
        "light",
        at=link if link.inertial is None else link.inertial,
        related=[joint],
        link=link.name,
        joint=joint.name,
        number=found.number,
        limit=limit,
        own=found.own,
        moved=found.moved,
        unit="kg" if joint.type == "prismatic" else "kg·m²",
        enough=0.01 * found.moved,
    )
