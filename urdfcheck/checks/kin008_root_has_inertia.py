"""KIN008 reports root links with an inertia, which some programs ignore and others need."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    if not model.joints:
        return  # a single body: nothing hangs on it
    root = model.link_by_name[model.tree.root]
    inertial = root.inertial
    if inertial is None or not inertial.mass:
        return
    masses = [link.inertial.mass for link in model.links if link.inertial is not None]
    known = [mass for mass in masses if mass is not None and mass >= 0]
    if len(known) < len(masses):
        return  # a sum that counts a wrong mass says nothing
    total = sum(known)
    yield rule.finding(
        "ignored",
        at=inertial.element,
        link=root.name,
        mass=inertial.mass,
        total=total,
        rest=total - inertial.mass,
    )
