"""INR003 reports inertia tensors whose principal moments break the triangle inequality."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.merging import merge_identical
from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.inertia_tensor import (
    TensorRounding,
    compute_principal_moments,
    compute_triangle_excess,
    measure_tensor_rounding,
)
from urdfcheck.model import Link, Model
from urdfcheck.model.parts import TENSOR_NAMES
from urdfcheck.model.repairs.inertial_edits import propose_repair
from urdfcheck.model.rigid_bodies import find_merged_body, is_point_mass
from urdfcheck.source.text.xml import Element


def check(model: Model, rule: Rule, *, rel_tol: float, rounding: float) -> Iterator[Finding]:
    """A finger that was copied is one finding."""
    yield from merge_identical(rule, _check_each_link(model, rule, rel_tol, rounding), "link", "other")


def _check_each_link(model: Model, rule: Rule, rel_tol: float, rounding: float) -> Iterator[Finding]:
    helpers: list[tuple[Link, Element]] = []
    for link in model.links:
        inertial = link.inertial
        if inertial is None or inertial.tensor is None or inertial.tensor_element is None or is_point_mass(inertial):
            continue
        excess = -compute_triangle_excess(inertial.tensor)
        if not excess > rel_tol:  # nor a tensor whose largest moment is not positive: INR004
            continue
        whole = find_merged_body(model, link)
        typed = measure_tensor_rounding([inertial.tensor_element.get(name) for name in TENSOR_NAMES], rel_tol)
        data = _collect_data(link, excess, typed)
        if excess < rounding and typed.explained_by_rounding:
            yield _build_finding(model, rule, "rounded", link, typed, data)
        elif whole is None or not whole.is_physically_valid(rel_tol):
            yield _build_finding(model, rule, "violated", link, typed, data)
        elif whole.link_is_negligible:
            if compute_principal_moments(inertial.tensor)[0][0] >= 0:  # else INR004
                helpers.append((link, inertial.tensor_element))
        else:
            data |= {"other": whole.heaviest, "whole": _format_moments(whole.moments)}
            yield _build_finding(model, rule, "fused", link, typed, data)
    if helpers:
        yield rule.finding(
            "helper",
            at=helpers[0][1],
            related=[element for _, element in helpers[1:]],
            severity=Severity.INFO,
            links=join_names(link.name for link, _ in helpers),
        )


def _build_finding(
    model: Model, rule: Rule, message: str, link: Link, typed: TensorRounding, data: Mapping[str, Any]
) -> Finding:
    assert link.inertial is not None
    assert link.inertial.tensor_element is not None
    repair = propose_repair(model, link)
    return rule.finding(
        message,
        at=link.inertial.tensor_element,
        cause="digits" if typed.explained_by_rounding and message != "rounded" and not repair.message else None,
        edits=repair.edits if repair.message or message != "rounded" else (),
        severity=Severity.WARNING if message == "rounded" else None,
        found=repair.message,
        remedy=repair.remedy if repair.message or message != "rounded" else "",
        **data,
    )


def _collect_data(link: Link, excess: float, typed: TensorRounding) -> dict[str, Any]:
    assert link.inertial is not None
    assert link.inertial.tensor is not None
    moments, _ = compute_principal_moments(link.inertial.tensor)
    # What the eigenvalue solver leaves of a zero is no number to print.
    shown = [0.0 if abs(m) < 1e-12 * moments[2] else float(m) for m in moments]
    return {
        "link": link.name,
        "moments": _format_moments(shown),
        "sum": shown[0] + shown[1],
        "excess": float(excess),
        "percent": float(excess * 100),
        "typed": typed.typed_digits,
        "digits": typed.digits,
    }


def _format_moments(moments: Iterable[float]) -> str:
    return ", ".join(f"{m:.6g}" for m in moments)
