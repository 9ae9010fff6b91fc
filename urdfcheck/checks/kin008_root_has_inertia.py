"""KIN008 reports root links with an inertia, which some programs ignore and others need."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    if not model.joints:
        return  # a single body
    root = model.mass_by_name.get(model.tree.root)
    if root is None or not root.mass:
        return
    masses = [declared.mass for declared in model.masses if declared.mass >= 0]
    if len(masses) < sum(link.inertial is not None for link in model.links):
        return  # a sum that includes a wrong mass is meaningless
    total = sum(masses)
    yield rule.finding(
        "ignored",
        at=root.inertial.element,
        link=root.link.name,
        mass=root.mass,
        total=total,
        rest=total - root.mass,
    )
