"""INR015 reports robots whose total mass is implausible."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model


def check(model: Model, rule: Rule, *, least: float, most: float) -> Iterator[Finding]:
    masses = [declared.mass for declared in model.masses if declared.mass > 0]
    total = sum(masses)
    if not masses or least <= total <= most:
        return
    message, cause = ("light", "tonnes") if total < least else ("heavy", "grams")
    yield rule.finding(
        message,
        at=model.name_location,
        cause=cause,
        robot=model.name,
        total=total,
        links=len(masses),
    )
