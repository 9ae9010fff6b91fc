"""JNT008 reports limits that have no effect: on continuous or fixed joints, and ranges of several turns."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from collections.abc import Set as AbstractSet

from urdfcheck.core import FactUnavailableError, Finding, Rule, Severity
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.text import format_count, join_names
from urdfcheck.model import Joint, Model
from urdfcheck.model.stated_reasons import collect_reasoned_joints
from urdfcheck.model.wheel_names import WHEEL_CARRIER_NAME, WHEEL_NAME

# A limit of this size means "no limit".
_ENDLESS = 1e6
# A range of less than a turn has an end that is not reached from the other side; 3.14 is a rounded half turn.
_TURN = 0.99 * math.tau
# A limb; a lone steering joint with limits is not one.
_LEAST_STOPS = 3
# Which is likelier is named first.
_LIMB_REPAIR = "make the joint revolute, or delete lower and upper if it has no stop"
_WHEEL_REPAIR = "delete lower and upper, or make the joint revolute if it has a stop"


def check(model: Model, rule: Rule, *, turns: float) -> Iterator[Finding]:
    joints_by_message: dict[str, list[Joint]] = {"continuous": [], "fixed": [], "wide": []}
    for joint in model.joints:
        lower, upper = joint.get_limit_value("lower"), joint.get_limit_value("upper")
        if lower is None or upper is None or lower == upper:
            continue  # exporters write zeros for every joint
        if joint.name in collect_reasoned_joints(model):
            continue
        if joint.type == "fixed" or (
            joint.type == "continuous"
            and max(-lower, upper) < _ENDLESS
            and not _stays_within(model, joint, lower, upper)
        ):
            joints_by_message[joint.type].append(joint)
        elif joint.type == "revolute" and upper - lower > turns * math.tau and not _is_all_endless(joint):
            joints_by_message["wide"].append(joint)
    for message, joints in joints_by_message.items():
        stops = _find_stops(model, joints) if message == "continuous" else []
        if stops:
            yield _build_limits_finding(rule, message, stops, is_limb=True)
        others = [joint for joint in joints if joint not in stops]
        # A range of a turn says what the type says: each angle is within it.
        winding = [joint for joint in others if message == "continuous" and _get_span(joint) >= _TURN]
        if winding:
            yield _build_limits_finding(rule, "winding", winding, is_limb=False)
        if others := [joint for joint in others if joint not in winding]:
            yield _build_limits_finding(rule, message, others, is_limb=False)


def _stays_within(model: Model, joint: Joint, lower: float, upper: float) -> bool:
    """Whether ``<mimic>`` moves a joint only within its limits, as its leader's range shows: no program stops it there."""
    leader = None if joint.mimic is None else model.joint_by_name.get(joint.mimic.get("joint"))
    span, coefficients = None if leader is None else leader.position_range, joint.mimic_coefficients
    if span is None or coefficients is None:
        return False
    low, high = sorted(coefficients[0] * position + coefficients[1] for position in span)
    return lower <= low and high <= upper


def _get_span(joint: Joint) -> float:
    """Return the size of the range of a joint, whatever its type."""
    return (joint.get_limit_value("upper") or 0.0) - (joint.get_limit_value("lower") or 0.0)


def _is_all_endless(joint: Joint) -> bool:
    """Whether every limit of a joint is a placeholder for "no limit", which JNT007 reports at the same element."""
    sizes = [abs(joint.get_limit_value(name) or 0.0) for name in ("lower", "upper", "effort", "velocity")]
    return min(sizes) >= _ENDLESS


def _find_stops(model: Model, joints: Sequence[Joint]) -> list[Joint]:
    """Find the continuous joints that are an arm's or a leg's, and not a wheel's, to which exporters give ±π.

    All of them if most rotating joints of the robot have limits of less than a turn, like stops; or else those of the limbs of
    which that holds.
    """
    joints = [joint for joint in joints if not _is_named_wheel(joint)]
    stops = {joint.name for joint in joints if 0 < _get_span(joint) < _TURN}
    if len(stops) < _LEAST_STOPS:
        return []
    if _are_most(stops, model.joints):
        return list(joints)
    limbs = [limb for limb in _list_limbs(model) if _are_most(stops, limb)]
    return [joint for joint in joints if joint.name in stops and any(joint in limb for limb in limbs)]


def _is_named_wheel(joint: Joint) -> bool:
    """Whether names say that a joint turns a wheel: it has no stop, whatever its limits."""
    words = f"{joint.name} {joint.child}"
    return bool(WHEEL_NAME.search(words)) and not WHEEL_CARRIER_NAME.search(words)


def _are_most(stops: AbstractSet[str], joints: Sequence[Joint]) -> bool:
    """Whether most rotating ones of some joints have stops, and enough for a limb."""
    rotating = [joint for joint in joints if joint.type in {"revolute", "continuous"} and joint.mimic is None]
    count = sum(joint.name in stops for joint in rotating)
    return count >= _LEAST_STOPS and 2 * count > len(rotating)


def _list_limbs(model: Model) -> list[Sequence[Joint]]:
    """List the joints from the root to each last link; none where the links are not one tree."""
    try:
        tree = model.tree
    except FactUnavailableError:
        return []
    return [tree.find_path_to(name) for name in tree.order if not tree.child_joints[name]]


def _build_limits_finding(rule: Rule, message: str, joints: list[Joint], *, is_limb: bool) -> Finding:
    """Report similar joints together: they come from one template or one exporter's default."""
    lower, upper = joints[0].get_limit_value("lower"), joints[0].get_limit_value("upper")
    return build_group_finding(
        rule,
        message,
        [joint.limit for joint in joints if joint.limit is not None],
        severity=Severity.WARNING if is_limb else None,
        joints=join_names(joint.name for joint in joints),
        count=format_count(len(joints), "joint"),
        verb="has" if len(joints) == 1 else "have",
        lower=lower,
        upper=upper,
        repair=_LIMB_REPAIR if is_limb else _WHEEL_REPAIR,
        turns=(upper or 0) / math.tau - (lower or 0) / math.tau,  # in this order no number is infinite
    )
