"""INR015 reports robots whose total mass is implausible."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model


def check(model: Model, rule: Rule, *, least: float, most: float) -> Iterator[Finding]:
    masses = [link.inertial.mass for link in model.links if link.inertial is not None]
    known = [mass for mass in masses if mass is not None and mass > 0]
    total = sum(known)
    if not known or least <= total <= most:
        return
    name = model.robot.attributes.get("name")
    message, cause = ("light", "tonnes") if total < least else ("heavy", "grams")
    yield rule.finding(
        message,
        at=model.location if name is None else name.location,
        cause=cause,
        robot=model.name,
        total=total,
        links=len(known),
    )
