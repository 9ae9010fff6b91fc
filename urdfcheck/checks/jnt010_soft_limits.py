"""JNT010 reports soft limits of safety controllers outside the joint's limits."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.model import Model
from urdfcheck.model.parts import Joint
from urdfcheck.source.text.grammar import is_attribute_missing
from urdfcheck.source.text.values import read_attribute_number
from urdfcheck.source.text.xml import Element


def check(model: Model, rule: Rule, *, slack: float) -> Iterator[Finding]:
    for joint in model.joints:
        safety = joint.element.find_child("safety_controller")
        if safety is None:
            continue
        if is_attribute_missing(safety, "k_velocity"):
            yield rule.finding("gain", at=safety, severity=Severity.ERROR, joint=joint.name)
        lower, upper = joint.get_limit_value("lower"), joint.get_limit_value("upper")
        soft = _read_soft_limit(safety, "soft_lower_limit"), _read_soft_limit(safety, "soft_upper_limit")
        if joint.type not in {"revolute", "prismatic"} or lower is None or upper is None or lower >= upper:
            continue  # nothing to compare with: JNT004, JNT005
        if soft[0] is not None and soft[1] is not None:
            yield from _check_soft_limits(rule, joint, safety, (lower, upper), (soft[0], soft[1]), slack)


def _check_soft_limits(
    rule: Rule, joint: Joint, safety: Element, hard: tuple[float, float], soft: tuple[float, float], slack: float
) -> Iterator[Finding]:
    data: dict[str, Any] = {
        "joint": joint.name,
        "soft_lower": soft[0],
        "soft_upper": soft[1],
        "lower": hard[0],
        "upper": hard[1],
        "unit": "rad" if joint.type == "revolute" else "m",
    }
    beyond = max(hard[0] - soft[0], soft[1] - hard[1])
    if not {"soft_lower_limit", "soft_upper_limit"} & set(safety.attributes):
        yield rule.finding("absent", at=safety, **data)
    elif max(soft[0], hard[0]) >= min(soft[1], hard[1]):
        yield rule.finding("locked", at=safety, **data)
    elif beyond > slack:
        edits = [edit for side in ("lower", "upper") for edit in _propose_edits(joint, safety, side)]
        yield rule.finding("outside", at=safety, edits=edits, beyond=beyond, **data)


def _read_soft_limit(safety: Element, name: str) -> float | None:
    """A soft limit, 0 where it is absent; None when malformed."""
    return read_attribute_number(safety, name) if name in safety.attributes else 0.0


def _propose_edits(joint: Joint, safety: Element, side: str) -> Iterator[Edit]:
    """Write the hard limit where the soft one lies beyond it."""
    hard = None if joint.limit is None else joint.limit.attributes.get(side)
    soft = safety.attributes.get(f"soft_{side}_limit")
    if hard is None or soft is None or not (hard.literal and soft.literal) or soft.span is None:
        return
    apart = float(soft.value) - float(hard.value)
    if (apart if side == "upper" else -apart) > 0:
        yield Edit(soft.span, soft.typed, hard.typed)
