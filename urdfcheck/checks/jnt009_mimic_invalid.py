"""JNT009 reports mimic joints whose leader is unusable, or whose motion exceeds their own limits."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import SLIP_LIKENESS, find_only_near_name, format_name_hint
from urdfcheck.model import Joint, Model
from urdfcheck.model.repairs.edits import edit_value
from urdfcheck.source.text.xml import Attribute

# What Drake does with the <mimic> of a fixed joint: the numbers of degrees of freedom must agree.
_EQUAL, _UNEQUAL = "ignores the <mimic>, with a warning", "refuses the file: a fixed joint cannot mimic one that moves"

# One slide is beside another along its axis if this share of the distance between them is along it (chosen).
_ALONG = 0.9


def check(model: Model, rule: Rule, *, slack: float, slight: float) -> Iterator[Finding]:
    for joint in model.joints:
        mimic = joint.mimic
        if mimic is None or not mimic.get("joint"):
            continue
        at = mimic.attributes["joint"]
        leader = model.joint_by_name.get(at.value)
        loop = _find_mimic_loop(model, joint)
        if leader is None:
            known = {one.name for one in model.joints if one.is_movable} - {joint.name}
            near = find_only_near_name(at.value, known, SLIP_LIKENESS)
            edits = edit_value(at, near) if near is not None else []
            hint = format_name_hint(at.value, known)
            yield rule.finding("unknown", at=at, edits=edits, joint=joint.name, leader=at.value, near=hint)
        elif joint.type == "fixed":
            yield rule.finding(
                "idle",
                at=at,
                severity=Severity.INFO,
                consequences={"drake": _EQUAL if leader.type == "fixed" and leader is not joint else _UNEQUAL},
                joint=joint.name,
                leader=leader.name,
                related=[leader],
            )
        elif leader.name == joint.name:
            yield rule.finding("itself", at=at, joint=joint.name)
        elif loop:
            if joint.name == min(loop, key=[j.name for j in model.joints].index):
                yield rule.finding("cycle", at=at, joint=joint.name, loop=" → ".join((*loop, loop[0])))
        elif leader.type == "fixed":
            yield rule.finding("fixed", at=at, joint=joint.name, leader=leader.name, related=[leader])
        else:
            yield from _check_range(model, rule, joint, leader, reference=at, slack=slack, slight=slight)


def _find_mimic_loop(model: Model, start: Joint) -> tuple[str, ...]:
    """Return the names of the joints that follow each other in a cycle through ``start``, or nothing; a fixed joint follows
    none."""
    names: list[str] = []
    joint: Joint | None = start
    while joint is not None and joint.name not in names:
        names.append(joint.name)
        follows = joint.mimic if joint.type != "fixed" else None
        joint = model.joint_by_name.get("" if follows is None else follows.get("joint"))
    return tuple(names) if joint is not None and joint.name == start.name else ()


def _find_first_leader(model: Model, joint: Joint) -> Joint:
    """Return the joint that leads a row of joints that follow each other: its limits alone are what MoveIt plans in."""
    seen = {joint.name}
    while joint.mimic is not None and joint.type != "fixed":
        above = model.joint_by_name.get(joint.mimic.get("joint"))
        if above is None or above.name in seen:
            break
        seen.add(above.name)
        joint = above
    return joint


def _find_motion(model: Model, joint: Joint) -> tuple[float, float] | None:
    """Find the positions that a joint reaches: its range, and of one that follows another only what that one's range gives it."""
    span, coefficients = joint.position_range, joint.mimic_coefficients
    mimic = joint.mimic
    leader = None if mimic is None else model.joint_by_name.get(mimic.get("joint"))
    if span is None or coefficients is None or leader is None or _find_mimic_loop(model, joint):
        return span
    led = _find_motion(model, leader)
    if led is None or leader.type == "fixed":
        return span
    low, high = sorted(coefficients[0] * position + coefficients[1] for position in led)
    low, high = max(low, span[0]), min(high, span[1])
    # One that only exceeds its limits is reported itself.
    return (low, high) if low < high else span


def _slide_apart(joint: Joint, leader: Joint, multiplier: float) -> bool:
    """Whether two slides that one link carries beside each other, along their axes, move to opposite sides: fingers.

    False where their frames are rotated.
    """
    places, angles, axes = zip(*((j.origin.xyz, j.origin.rpy, j.axis) for j in (joint, leader)), strict=True)
    if joint.parent != leader.parent or {joint.type, leader.type} != {"prismatic"} or None in (*places, *axes):
        return False
    if any(angles[0] or ()) or any(angles[1] or ()):
        return False
    gap = [a - b for a, b in zip(*places, strict=True)]
    along = sum(map(operator.mul, gap, axes[1])) / math.hypot(*axes[1])
    is_beside: bool = abs(along) > _ALONG * math.hypot(*gap)
    against: bool = multiplier * sum(map(operator.mul, *axes)) < 0
    return is_beside and against


def _check_range(
    model: Model, rule: Rule, joint: Joint, leader: Joint, *, reference: Attribute, slack: float, slight: float
) -> Iterator[Finding]:
    """Report a follower whose own limits are narrower than its leader's range demands."""
    follower_range, leader_range = joint.position_range, _find_motion(model, leader)
    coefficients = joint.mimic_coefficients
    if follower_range is None or leader_range is None or coefficients is None:
        return
    (lower, upper), (multiplier, offset) = follower_range, coefficients
    low, high = sorted(multiplier * q + offset for q in leader_range)
    beyond = max(lower - low, high - upper)
    if beyond > slack:
        own = f"the limits of {joint.name} to {low:.6g} … {high:.6g} {joint.position_unit}"
        back = sorted(-multiplier * q + offset for q in leader_range)
        if max(lower - back[0], back[1] - upper) <= slack:
            sign = f'write multiplier="{-multiplier:g}", with which it stays within'
            repair = f"{sign}, or set {own}: whichever moves it the right way"
            if _slide_apart(joint, leader, multiplier):
                repair = f"set {own}: the two are beside each other and slide to opposite sides: two fingers"
        else:
            repair = (
                f"set {own}, narrow those of {_find_first_leader(model, leader).name}, or correct multiplier and offset"
            )
        is_slight = beyond <= slight * (upper - lower)
        yield rule.finding(
            "slight" if is_slight else "range",
            at=reference,
            severity=Severity.INFO if is_slight else Severity.WARNING,
            related=[limit for limit in (joint.limit, leader.limit) if limit is not None],
            joint=joint.name,
            leader=leader.name,
            low=low,
            high=high,
            lower=lower,
            upper=upper,
            beyond=beyond,
            unit=joint.position_unit,
            repair=repair,
        )
