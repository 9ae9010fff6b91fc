"""What differs in the joints: place, axis, type, limits, friction and mimicry."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from urdfcheck.core.mechanism import NO_TRACE, MechanismJoint
from urdfcheck.core.model_diff import MechanismChange
from urdfcheck.facts.comparison.alignment import PlacedPair, carry_screw, find_zero_offset
from urdfcheck.facts.comparison.home_pose import (
    ANGLE_TOLERANCE,
    LENGTH_TOLERANCE,
    is_same_number,
    is_same_pose,
    locate_screw,
    measure_axis_change,
)
from urdfcheck.facts.motion.kinematics import compute_axis_angle

ROTATING = frozenset({"revolute", "continuous"})
ONE_DOF = frozenset({"revolute", "continuous", "prismatic"})


def compare_joints(pair: PlacedPair) -> Iterator[MechanismChange]:
    """Yield the changes of matched joints, and of links that are elsewhere under the same joint."""
    for old, new in pair.match.joints.items():
        first, second = pair.before.joints[old], pair.after.joints[new]
        yield from _compare_placement(pair, first, second)
        yield from _compare_axes(pair, first, second)
        yield from _compare_limits(first, second)
        yield from _compare_mimics(pair, first, second)


def _make_change(
    first: MechanismJoint,
    second: MechanismJoint,
    what: tuple[str, str],
    trace: str,
    numbers: dict[str, float] | None = None,
    words: dict[str, str] | None = None,
) -> MechanismChange:
    category, name = what
    return MechanismChange(
        category=category,
        id=name,
        subject=f"joint[{first.name}]",
        new_name="" if first.name == second.name else second.name,
        numbers=numbers or {},
        words=words or {},
        before=first.traces.get(trace, NO_TRACE),
        after=second.traces.get(trace, NO_TRACE),
    )


def _compare_placement(pair: PlacedPair, first: MechanismJoint, second: MechanismJoint) -> Iterator[MechanismChange]:
    displacement = pair.moved.get(first.child)
    if displacement is None or pair.match.links.get(first.child) != second.child:
        return
    frame = pair.before.frames[first.child]
    offset = (
        find_zero_offset(locate_screw(pair.before, first), displacement, rotates=first.type in ROTATING)
        if first.type in ONE_DOF
        else None
    )
    if offset is not None:
        unit = "m" if first.type == "prismatic" else "rad"
        words = {"unit": unit, "link": first.child}
        yield _make_change(first, second, ("kinematic", "zero-offset"), "pose", {"offset": offset}, words)
        return
    shift = displacement[:3, :3] @ frame[:3, 3] + displacement[:3, 3] - frame[:3, 3]
    local = pair.before.frames[first.parent][:3, :3].T @ shift
    axis, angle = compute_axis_angle(displacement[:3, :3])
    turned = pair.before.frames[first.parent][:3, :3].T @ axis
    numbers = {
        "distance": float(np.linalg.norm(shift)),
        "angle": angle,
        **{f"shift_{name}": float(value) for name, value in zip("xyz", local, strict=True)},
        **{f"axis_{name}": float(value) for name, value in zip("xyz", turned, strict=True)},
    }
    words = {"parent": first.parent, "link": first.child}
    yield _make_change(first, second, ("kinematic", "joint-moved"), "pose", numbers, words)


def _compare_axes(pair: PlacedPair, first: MechanismJoint, second: MechanismJoint) -> Iterator[MechanismChange]:
    if first.type != second.type:
        category = "limits" if {first.type, second.type} == ROTATING else "kinematic"
        words = {"before": first.type, "after": second.type}
        yield _make_change(first, second, (category, "type"), "type", words=words)
    if first.type in {"planar", "floating"} and first.type == second.type:
        # Their positions are given in the axes of the joint's own frame.
        taken = pair.maps[first.child] @ pair.before.frames[first.child]
        if first.child in pair.reframed and not is_same_pose(taken, pair.after.frames[second.child]):
            yield _make_change(first, second, ("kinematic", "joint-frame"), "pose", words={"type": first.type})
    one, two = locate_screw(pair.before, first), locate_screw(pair.after, second)
    if one is None or two is None:
        return
    is_line = first.type in ROTATING and second.type in ROTATING
    angle, apart, is_reversed = measure_axis_change(carry_screw(one, pair.maps[first.child]), two, is_line=is_line)
    if is_reversed and angle <= ANGLE_TOLERANCE:
        yield _make_change(first, second, ("kinematic", "axis-reversed"), "axis")
    elif angle > ANGLE_TOLERANCE:
        turned = math.pi - angle if is_reversed else angle
        yield _make_change(first, second, ("kinematic", "axis-tilted"), "axis", {"angle": turned})
    if apart > LENGTH_TOLERANCE:
        yield _make_change(first, second, ("kinematic", "axis-shifted"), "pose", {"distance": apart})


def _compare_limits(first: MechanismJoint, second: MechanismJoint) -> Iterator[MechanismChange]:
    is_bounded = first.type == second.type or {first.type, second.type} <= {"revolute", "prismatic"}
    for name in ("lower", "upper", "effort", "velocity"):
        old, new = getattr(first, name), getattr(second, name)
        if is_same_number(old, new) or (name in {"lower", "upper"} and not is_bounded):
            continue
        if "fixed" in {first.type, second.type}:
            continue  # the change of the type says it
        yield _change_value(first, second, "limits", name, old, new)
    for name in ("damping", "friction"):
        old, new = getattr(first, name), getattr(second, name)
        if not is_same_number(old, new) and "fixed" not in {first.type, second.type}:
            yield _change_value(first, second, "dynamic", name, old, new)


def _change_value(
    first: MechanismJoint, second: MechanismJoint, category: str, name: str, old: float | None, new: float | None
) -> MechanismChange:
    numbers = {key: value for key, value in (("before", old), ("after", new)) if value is not None}
    linear = second.type == "prismatic"
    units = {
        "effort": "N" if linear else "N·m",
        "velocity": "m/s" if linear else "rad/s",
        "damping": "N·s/m" if linear else "N·m·s/rad",
        "friction": "N" if linear else "N·m",
    }
    words = {"unit": units.get(name, "m" if linear else "rad")}
    return _make_change(first, second, (category, name), name, numbers, words)


def _compare_mimics(pair: PlacedPair, first: MechanismJoint, second: MechanismJoint) -> Iterator[MechanismChange]:
    old, new = first.mimic, second.mimic
    if old is None and new is None:
        return
    if old is not None and new is not None:
        leader = pair.match.joints.get(old[0], old[0])
        if leader == new[0] and is_same_number(old[1], new[1]) and is_same_number(old[2], new[2], scale=1.0):
            return
    if "fixed" in {first.type, second.type}:
        return
    words = {"before": _describe_mimic(old), "after": _describe_mimic(new)}
    yield _make_change(first, second, ("kinematic", "mimic"), "mimic", words=words)


def _describe_mimic(mimic: tuple[str, float, float] | None) -> str:
    if mimic is None:
        return "its own motion"
    leader, multiplier, offset = mimic
    return f"{multiplier:.6g} × {leader}" + (f" {offset:+.6g}" if offset else "")
