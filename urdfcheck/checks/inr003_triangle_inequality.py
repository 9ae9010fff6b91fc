"""INR003: principal moments obey the triangle inequality."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.facts.inertia import digits_needed, principal_moments, triangle_excess
from urdfcheck.model import Model
from urdfcheck.model.body import is_point
from urdfcheck.model.parts import TENSOR


def check(model: Model, rule: Rule, *, rel_tol: float, rounding: float) -> Iterator[Finding]:
    for link in model.links:
        inertial = link.inertial
        if inertial is None or inertial.tensor is None or inertial.tensor_element is None:
            continue
        moments, _ = principal_moments(inertial.tensor)
        if moments[2] <= 0 or is_point(inertial):
            continue  # INR004
        excess = -triangle_excess(inertial.tensor)
        if excess <= rel_tol:
            continue
        # What the eigenvalue solver leaves of a zero is no number to print.
        shown = [0.0 if abs(m) < 1e-12 * moments[2] else float(m) for m in moments]
        data: dict[str, Any] = {
            "link": link.name,
            "moments": ", ".join(f"{m:.6g}" for m in shown),
            "sum": shown[0] + shown[1],
            "excess": float(excess),
            "percent": float(excess * 100),
        }
        typed = digits_needed([inertial.tensor_element.get(name) for name in TENSOR], rel_tol)
        if excess < rounding and typed.explained:
            yield rule.finding(
                "rounded",
                at=inertial.tensor_element,
                severity=Severity.WARNING,
                typed=typed.typed_digits,
                digits=typed.digits,
                **data,
            )
        else:
            yield rule.finding("violated", at=inertial.tensor_element, **data)
