"""SYM008 reports the two wheels of a robot that has one pair of them and that are not mirror images."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.facts.likeness.revolution import measure_line_angle
from urdfcheck.model import Joint, Model
from urdfcheck.model.ground.wheel_pair import WheelPair, find_lone_wheel_pair
from urdfcheck.model.ground.wheels import Wheel
from urdfcheck.model.repairs.origin_edits import locate_origin_attribute

# A wheel this straight (rad) is not the tilted one of a pair.
_STRAIGHT = 0.003
# Coordinates (m) that are the same on both sides to within this: chosen.
_SAME_PLACE = 5e-4


def check(model: Model, rule: Rule, *, spread: float, least: float, angle: float) -> Iterator[Finding]:
    pair = find_lone_wheel_pair(model)
    if pair is None:
        return
    differences = _describe_differences(pair, least=max(spread * pair.radius, least), angle=math.radians(angle))
    if not differences:
        return
    if len(differences) == 1 and pair.angle > math.radians(angle) and _has_parallel_axes(pair):
        yield _build_tilted_finding(rule, pair)
        return
    tilted = _find_tilted_wheel(pair) if pair.angle > math.radians(angle) else None
    first, second = (pair.right, pair.left) if tilted is pair.right else (pair.left, pair.right)
    attribute = "rpy" if tilted is not None and len(differences) == 1 else "xyz"
    joints = first.joint, second.joint
    if attribute == "xyz":
        joints = _find_unlike_joints(model, *joints) or joints
    yield rule.finding(
        "pair",
        at=locate_origin_attribute(joints[0], attribute),
        related=[locate_origin_attribute(joints[1], attribute)],
        wheel=first.joint.child,
        twin=second.joint.child,
        main=_describe_main(pair, differences[0], tilted),
        differences=join_names(differences),
        repair=_describe_repair(*joints, tilted if attribute == "rpy" else None),
        between=list(dict.fromkeys(f"joint[{joint.name}]" for joint in (first.joint, second.joint, *joints))),
    )


def _find_unlike_joints(model: Model, one: Joint, other: Joint) -> tuple[Joint, Joint] | None:
    """Find the only two joints, at one place of the two chains to the wheels, whose origins differ in more than signs."""
    unlike = []
    while True:
        places = [np.abs(joint.origin.xyz or (0.0, 0.0, 0.0)) for joint in (one, other)]
        if np.abs(places[0] - places[1]).max() > _SAME_PLACE:
            unlike.append((one, other))
        above = [model.tree.parent_joint.get(joint.parent) for joint in (one, other)]
        if one.parent == other.parent or above[0] is None or above[1] is None:
            return unlike[0] if len(unlike) == 1 and one.parent == other.parent else None
        one, other = above[0], above[1]


def _describe_differences(pair: WheelPair, *, least: float, angle: float) -> list[str]:
    """Describe how the left wheel differs from the mirror image of the right one, by more than ``least`` (m)."""
    left = pair.left.joint.child
    words = []
    if abs(pair.above) > least:
        words.append(f"the axle of {left} is {abs(pair.above) * 1e3:.3g} mm {'higher' if pair.above > 0 else 'lower'}")
    if abs(pair.ahead) > least:
        words.append(f"{left} is {abs(pair.ahead) * 1e3:.3g} mm {'ahead' if pair.ahead > 0 else 'behind'}")
    if pair.outside is not None and abs(pair.outside) > 2 * least:
        far = "farther out" if pair.outside > 0 else "farther in"
        words.append(f"{left} is {abs(pair.outside) * 1e3:.3g} mm {far}")
    if abs(pair.larger) > least:
        size = "larger" if pair.larger > 0 else "smaller"
        words.append(f"the radius of {left} is {abs(pair.larger) * 1e3:.3g} mm {size}")
    if pair.angle > angle and _has_parallel_axes(pair):
        words.append(f"both axes are {math.degrees(max(pair.tilts)):.3g}° off the normal of that plane")
    elif pair.angle > angle:
        words.append(f"one axis is {math.degrees(pair.angle):.3g}° off the mirror image of the other")
    return words


def _has_parallel_axes(pair: WheelPair) -> bool:
    return measure_line_angle(pair.left.axis, pair.right.axis) < _STRAIGHT


def _build_tilted_finding(rule: Rule, pair: WheelPair) -> Finding:
    """Build the finding about two parallel axes: on one axle that is tilted, nothing pulls to a side."""
    wheels = pair.left, pair.right
    return rule.finding(
        "tilted",
        at=wheels[0].joint.axis_location,
        related=[wheels[1].joint.axis_location],
        severity=Severity.INFO,
        wheel=wheels[0].joint.child,
        twin=wheels[1].joint.child,
        tilt=math.degrees(max(pair.tilts)),
        across="xyz"[int(np.abs(pair.lateral).argmax())],
        between=[f"joint[{wheel.joint.name}]" for wheel in wheels],
    )


def _find_tilted_wheel(pair: WheelPair) -> Wheel | None:
    """Find the wheel whose axis is off; None where both are."""
    left, right = pair.tilts
    if min(left, right) > _STRAIGHT:
        return None
    return pair.left if left > right else pair.right


def _describe_main(pair: WheelPair, first: str, tilted: Wheel | None) -> str:
    if first.startswith("one axis") and tilted is not None:
        return f"{tilted.joint.child} is tilted by {math.degrees(pair.angle):.3g}° against {_get_other(pair, tilted)}"
    return f"{first} than {pair.right.joint.child}" if first.endswith(("er", "out", "in")) else first


def _get_other(pair: WheelPair, wheel: Wheel) -> str:
    return (pair.right if wheel is pair.left else pair.left).joint.child


def _describe_repair(first: Joint, second: Joint, tilted: Wheel | None) -> str:
    if tilted is not None:
        return f"compare axis and rpy of {tilted.joint.name} with those of {second.name}, and correct them"
    return f"compare the origins of {first.name} and {second.name}, and the wheels' shapes; correct the wrong one"
