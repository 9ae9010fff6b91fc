"""INR003: principal moments obey the triangle inequality."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.facts.inertia import digits_needed, principal_moments, triangle_excess
from urdfcheck.model import Model
from urdfcheck.model.parts import TENSOR


def check(model: Model, rule: Rule, *, rel_tol: float, rounding: float) -> Iterator[Finding]:
    for link in model.links:
        inertial = link.inertial
        if inertial is None or inertial.tensor is None or inertial.tensor_element is None:
            continue
        moments, _ = principal_moments(inertial.tensor)
        if moments[0] <= 0:
            continue  # not positive definite: INR004
        excess = -triangle_excess(inertial.tensor)
        if excess <= rel_tol:
            continue
        data = {
            "link": link.name,
            "moments": ", ".join(f"{m:.6g}" for m in moments),
            "sum": float(moments[0] + moments[1]),
            "excess": float(excess),
        }
        typed = [inertial.tensor_element.get(name) for name in TENSOR]
        digits = digits_needed(typed) if excess < rounding else None
        if digits is not None:
            yield rule.finding(
                "rounded", at=inertial.tensor_element, severity=Severity.WARNING, digits=digits, **data
            )
        else:
            yield rule.finding("violated", at=inertial.tensor_element, **data)
