"""JNT010 reports soft limits of safety controllers outside the joint's limits."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.text import format_count, join_names
from urdfcheck.model import Joint, Model
from urdfcheck.model.repairs.edits import edit_literal
from urdfcheck.source.text.grammar import get_known_attributes, guess_attribute, is_attribute_missing
from urdfcheck.source.text.values import read_attribute_number
from urdfcheck.source.text.xml import Element


def check(model: Model, rule: Rule, *, slack: float) -> Iterator[Finding]:
    for joint in model.joints:
        safety = joint.element.find_child("safety_controller")
        if safety is None:
            continue
        if is_attribute_missing(safety, "k_velocity"):
            yield rule.finding("gain", at=safety, severity=Severity.ERROR, joint=joint.name)
        yield from _check_soft_limits(rule, joint, safety, slack=slack)
    if disabled := [joint for joint in model.joints if _is_disabled(joint, slack)]:
        yield build_group_finding(
            rule,
            "off",
            [safety for joint in disabled if (safety := joint.element.find_child("safety_controller")) is not None],
            severity=Severity.INFO,
            joints=join_names(joint.name for joint in disabled),
            count=format_count(len(disabled), "joint"),
        )


def _is_disabled(joint: Joint, slack: float) -> bool:
    """Whether the soft limits are beyond the hard ones on both sides."""
    safety, hard = joint.element.find_child("safety_controller"), joint.position_range
    if safety is None or hard is None:
        return False
    lower, upper = _read_soft_limit(safety, "soft_lower_limit"), _read_soft_limit(safety, "soft_upper_limit")
    return lower is not None and upper is not None and lower < hard[0] - slack and upper > hard[1] + slack


def _check_soft_limits(rule: Rule, joint: Joint, safety: Element, *, slack: float) -> Iterator[Finding]:
    hard = joint.position_range
    soft_lower, soft_upper = _read_soft_limit(safety, "soft_lower_limit"), _read_soft_limit(safety, "soft_upper_limit")
    if hard is None or soft_lower is None or soft_upper is None:
        return  # nothing to compare with: JNT004, JNT005
    if _is_misspelt(safety) or _is_disabled(joint, slack):
        return
    lower, upper = hard
    data: dict[str, Any] = {
        "joint": joint.name,
        "soft_lower": soft_lower,
        "soft_upper": soft_upper,
        "lower": lower,
        "upper": upper,
        "unit": joint.position_unit,
    }
    beyond = max(lower - soft_lower, soft_upper - upper)
    if not {"soft_lower_limit", "soft_upper_limit"} & set(safety.attributes):
        yield rule.finding("absent", at=safety, **data)
    elif max(soft_lower, lower) >= min(soft_upper, upper):
        yield rule.finding("locked", at=safety, **data)
    elif beyond > slack:
        edits = [edit for side in ("lower", "upper") for edit in _propose_edits(joint, safety, side)]
        yield rule.finding("outside", at=safety, edits=edits, severity=Severity.INFO, beyond=beyond, **data)


def _is_misspelt(safety: Element) -> bool:
    """Whether an attribute is a misspelt soft limit, which XML004 reports."""
    unknown = safety.attributes.keys() - get_known_attributes(safety.tag)
    return any((guess_attribute(safety, name) or "").startswith("soft_") for name in unknown)


def _read_soft_limit(safety: Element, name: str) -> float | None:
    """Return a soft limit, 0 if it is absent, or None if it is malformed."""
    return read_attribute_number(safety, name) if name in safety.attributes else 0.0


def _propose_edits(joint: Joint, safety: Element, side: str) -> list[Edit]:
    """Return the edit that writes the hard limit in place of a soft one beyond it."""
    hard = None if joint.limit is None else joint.limit.attributes.get(side)
    soft = safety.attributes.get(f"soft_{side}_limit")
    if hard is None or soft is None or not hard.literal:
        return []
    excess = float(soft.value) - float(hard.value)
    return edit_literal(soft, hard.typed) if (excess if side == "upper" else -excess) > 0 else []
