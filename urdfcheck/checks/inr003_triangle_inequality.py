"""INR003: principal moments obey the triangle inequality."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.merging import alike
from urdfcheck.core.text import listed
from urdfcheck.facts.inertials.inertia_tensor import Rounding, digits_needed, principal_moments, triangle_excess
from urdfcheck.model import Link, Model
from urdfcheck.model.parts import TENSOR
from urdfcheck.model.repairs.inertial_edits import proposal
from urdfcheck.model.rigid_bodies import is_point, whole_of
from urdfcheck.source.text.xml import Element


def check(model: Model, rule: Rule, *, rel_tol: float, rounding: float) -> Iterator[Finding]:
    """A finger that was copied is one finding."""
    yield from alike(rule, _each(model, rule, rel_tol, rounding), "link", "other")


def _each(model: Model, rule: Rule, rel_tol: float, rounding: float) -> Iterator[Finding]:
    helpers: list[tuple[Link, Element]] = []
    for link in model.links:
        inertial = link.inertial
        if inertial is None or inertial.tensor is None or inertial.tensor_element is None or is_point(inertial):
            continue
        excess = -triangle_excess(inertial.tensor)
        if not excess > rel_tol:  # nor a tensor whose largest moment is not positive: INR004
            continue
        whole = whole_of(model, link)
        typed = digits_needed([inertial.tensor_element.get(name) for name in TENSOR], rel_tol)
        data = _data(link, excess, typed)
        if excess < rounding and typed.explained:
            yield _impossible(model, rule, "rounded", link, typed, data)
        elif whole is None or not whole.possible(rel_tol):
            yield _impossible(model, rule, "violated", link, typed, data)
        elif whole.negligible:
            if principal_moments(inertial.tensor)[0][0] >= 0:  # else INR004
                helpers.append((link, inertial.tensor_element))
        else:
            data |= {"other": whole.heaviest, "whole": _listed(whole.moments)}
            yield _impossible(model, rule, "fused", link, typed, data)
    if helpers:
        yield rule.finding(
            "helper",
            at=helpers[0][1],
            related=[element for _, element in helpers[1:]],
            severity=Severity.INFO,
            links=listed(link.name for link, _ in helpers),
        )


def _impossible(
    model: Model, rule: Rule, message: str, link: Link, typed: Rounding, data: Mapping[str, Any]
) -> Finding:
    assert link.inertial is not None
    assert link.inertial.tensor_element is not None
    repair = proposal(model, link)
    return rule.finding(
        message,
        at=link.inertial.tensor_element,
        cause="digits" if typed.explained and message != "rounded" and not repair.found else None,
        edits=repair.edits if repair.found or message != "rounded" else (),
        severity=Severity.WARNING if message == "rounded" else None,
        found=repair.found,
        remedy=repair.remedy if repair.found or message != "rounded" else "",
        **data,
    )


def _data(link: Link, excess: float, typed: Rounding) -> dict[str, Any]:
    assert link.inertial is not None
    assert link.inertial.tensor is not None
    moments, _ = principal_moments(link.inertial.tensor)
    # What the eigenvalue solver leaves of a zero is no number to print.
    shown = [0.0 if abs(m) < 1e-12 * moments[2] else float(m) for m in moments]
    return {
        "link": link.name,
        "moments": _listed(shown),
        "sum": shown[0] + shown[1],
        "excess": float(excess),
        "percent": float(excess * 100),
        "typed": typed.typed_digits,
        "digits": typed.digits,
    }


def _listed(moments: Iterable[float]) -> str:
    return ", ".join(f"{m:.6g}" for m in moments)
