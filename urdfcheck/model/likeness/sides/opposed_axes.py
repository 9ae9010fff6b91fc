"""Axes of joints on both sides that send their parts to sides that do not match: one of them is reversed."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import TYPE_CHECKING, Literal

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.model.likeness.mirror_pairs import MirrorPair, list_named_pairs
from urdfcheck.model.likeness.mirrored_joints import TURNING, find_pair_joints
from urdfcheck.model.likeness.shape_comparison import compute_centroid, is_alike
from urdfcheck.model.parts import Joint
from urdfcheck.model.robot import Model
from urdfcheck.model.wheel_names import WHEEL_NAME

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# Axes are parallel, or across each other, within this (1 - cosine, and cosine).
_PARALLEL, _ACROSS = 2e-3, 0.1
# Ends of a range agree within this share of it, with each other or with zero.
_SAME = 1e-3
# A range is one-sided if one end is so many times as far from zero as the other.
_ONE_SIDED = 2.0
# A finger swings towards the other one, or away from it, if it goes by this share (a cosine) along the line between them.
_ASIDE = 0.5
# The parts of a gripper are apart (m) along the line on which they slide, to within this cosine.
_LEAST_SPACE, _ALONG = 1e-3, 0.9
_GRIPPER = re.compile(r"finger|jaw|grip|claw|pinc|tong|effector|(?<![a-z])ee(?![a-z])", re.IGNORECASE)

Kind = Literal["opposed", "steering", "together", "crosswise"]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class OpposedAxes:
    """Two joints of which one is reversed; the file does not show which."""

    joint: Joint
    """The one whose axis has the negative number, where only one has."""
    twin: Joint
    kind: Kind
    """``opposed``: left and right bend to opposite sides, unlike those of ``others``. ``steering``: so do steered wheels.
    ``together``: the two parts of a gripper go the same way. ``crosswise``: they slide along two lines."""
    others: tuple[Joint, ...] = ()


def iter_opposed_axes(model: Model, pairs: Sequence[MirrorPair]) -> Iterator[OpposedAxes]:
    """Yield pairs of joints of which one is reversed.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    yield from _find_bending_apart(model, pairs)
    yield from _find_steering_apart(model)
    yield from _find_sliding_apart(model)
    yield from _find_turning_apart(model)


def _find_bending_apart(model: Model, pairs: Sequence[MirrorPair]) -> Iterator[OpposedAxes]:
    """Yield the only pair of left and right joints that bend to opposite sides about the line from left to right.

    About this line alone a mirror and a copy of the limb bend the same way.
    """
    alike: list[tuple[MirrorPair, tuple[Joint, Joint]]] = []
    opposed: list[tuple[MirrorPair, tuple[Joint, Joint]]] = []
    for pair in pairs:
        joints = find_pair_joints(model, pair)
        if joints is None or not pair.is_named or joints[0].type != "revolute":
            continue
        axes = [model.axes[joint.name] for joint in joints]
        if min(abs(float(axis @ pair.plane.normal)) for axis in axes) < 1 - _PARALLEL:
            continue
        (opposed if float(axes[0] @ axes[1]) < 0 else alike).append((pair, joints))
    if len(opposed) == 1 and alike and opposed[0][0].is_in_place and _have_one_range(*opposed[0][1]):
        one, other = opposed[0][1]
        yield _order(one, other, "opposed", tuple(joint for _, joints in alike for joint in joints))


def _find_steering_apart(model: Model) -> Iterator[OpposedAxes]:
    """Yield left and right joints that steer wheels to opposite sides."""
    for names in list_named_pairs(model):
        one, other = (model.tree.parent_joint.get(name) for name in names)
        if one is None or other is None or not all(_steers(model, joint) for joint in (one, other)):
            continue
        if float(model.axes[one.name] @ model.axes[other.name]) < _PARALLEL - 1 and _have_one_range(one, other):
            yield _order(one, other, "steering")


def _steers(model: Model, joint: Joint) -> bool:
    """Whether a joint turns a wheel about a line across the wheel's axis."""
    if joint.type != "revolute" or joint.mimic is not None or joint.name not in model.axes:
        return False
    below = [one for name in model.tree.list_body_links(joint.child) for one in model.tree.child_joints[name]]
    wheels = [
        one
        for one in below
        if one.type == "continuous" and one.name in model.axes and WHEEL_NAME.search(f"{one.name} {one.child}")
    ]
    return bool(wheels) and all(abs(float(model.axes[w.name] @ model.axes[joint.name])) < _ACROSS for w in wheels)


def _have_one_range(one: Joint, other: Joint) -> bool:
    """Whether two joints have the same range, as far to either side of zero: it does not show which way they turn."""
    (a, b), (c, d) = (_get_range(joint) for joint in (one, other))
    return b > a and max(abs(a + b), abs(a - c), abs(b - d)) <= _SAME * (b - a)


def _find_sliding_apart(model: Model) -> Iterator[OpposedAxes]:
    """Yield two fingers of a gripper that slide to the same side, or along two lines."""
    slides = [joint for joint in model.joints if joint.type == "prismatic" and joint.name in model.axes]
    for one, other in combinations(slides, 2):
        if one.parent != other.parent or not _is_gripper(one, other):
            continue
        siblings = [joint for joint in slides if joint.parent == one.parent]
        if len(siblings) != 2 or is_alike(model, one.child, other.child) is False:
            continue
        if abs(float(model.axes[one.name] @ model.axes[other.name])) < _ACROSS:
            yield _order(one, other, "crosswise")
        ways, apart = _compute_ways(model, one, other), _compute_way_between(model, one, other)
        if ways is None or float(ways[0] @ ways[1]) < (1 - _PARALLEL) * float(np.linalg.norm(ways[0]) ** 2):
            continue
        if apart is not None and abs(float(apart @ model.axes[one.name])) > _ALONG * float(np.linalg.norm(apart)):
            yield _order(one, other, "together")


def _is_gripper(*joints: Joint) -> bool:
    return all(_GRIPPER.search(f"{joint.name} {joint.child}") for joint in joints)


def _find_turning_apart(model: Model) -> Iterator[OpposedAxes]:
    """Yield two fingers of a gripper that swing to the same side."""
    for one, other in _iter_finger_pairs(model):
        if any(joint.type != "revolute" or joint.name not in model.axes for joint in (one, other)):
            continue
        if is_alike(model, one.child, other.child) is False:
            continue
        ways, apart = _compute_ways(model, one, other), _compute_way_between(model, one, other)
        if ways is None or apart is None:
            continue
        first, second = (_compute_swing(model, joint, way) for joint, way in zip((one, other), ways, strict=True))
        along = [float(swing @ apart) / float(np.linalg.norm(apart)) for swing in (first, second)]
        if min(along) * max(along) > 0 and all(
            abs(part) > _ASIDE * float(np.linalg.norm(swing))
            for part, swing in zip(along, (first, second), strict=True)
        ):
            yield _order(one, other, "together")


def _iter_finger_pairs(model: Model) -> Iterator[tuple[Joint, Joint]]:
    """Yield two fingers that are the only hinges on their link, and the only hinges on two such fingers: the tips."""
    hinges = {
        link: [joint for joint in joints if joint.type in TURNING] for link, joints in model.tree.child_joints.items()
    }
    for on_one_link in hinges.values():
        pair = on_one_link
        while len(pair) == 2 and _is_gripper(*pair):
            yield pair[0], pair[1]
            behind = [hinges[joint.child] for joint in pair]
            pair = [joints[0] for joints in behind if len(joints) == 1]


def _compute_swing(model: Model, joint: Joint, way: Array) -> Array:
    """Compute where the part of a hinge begins to go (3,), in m, when it turns by a ``way`` (3,) in rad."""
    place = _find_place(model, joint.child)
    arm = np.zeros(3) if place is None else place - model.frames[joint.child][:3, 3]
    swing: Array = np.cross(way, arm)
    return swing


def _find_place(model: Model, name: str) -> Array | None:
    """Find where a link's part is (3,), in root coordinates: what it draws, or else its COM (one at zero was
    not filled in); None where neither is known."""
    drawn, inertial = compute_centroid(model, name), model.link_by_name[name].inertial
    com = None if inertial is None else inertial.origin.xyz
    if drawn is not None or com is None or not any(com):
        return drawn
    place: Array = model.frames[name][:3, :3] @ np.array(com) + model.frames[name][:3, 3]
    return place


def _compute_way_between(model: Model, one: Joint, other: Joint) -> Array | None:
    """Compute the way (3,) in m from the part of one joint to that of the other; None where either is not known, or both are in
    one place."""
    places = [_find_place(model, joint.child) for joint in (one, other)]
    if places[0] is None or places[1] is None:
        return None
    apart: Array = places[1] - places[0]
    return apart if float(np.linalg.norm(apart)) > _LEAST_SPACE else None


def _compute_ways(model: Model, one: Joint, other: Joint) -> tuple[Array, Array] | None:
    """Compute the ways (3,) of two joints along or about their axes (m or rad) from zero to the far ends of their ranges, where
    these are as long; None where a range is on both sides of zero."""
    ends = [_get_far_end(model, joint) for joint in (one, other)]
    if ends[0] is None or ends[1] is None or abs(abs(ends[1]) - abs(ends[0])) > _SAME * abs(ends[0]):
        return None
    return ends[0] * model.axes[one.name], ends[1] * model.axes[other.name]


def _get_far_end(model: Model, joint: Joint) -> float | None:
    """Return the end of a joint's range that is far from zero (m or rad), or where it is at that of the joint that it follows;
    None where both are far."""
    leader, factor = joint, 1.0
    if joint.mimic is not None:
        followed, coefficients = model.joint_by_name.get(joint.mimic.get("joint")), joint.mimic_coefficients
        if followed is None or followed.mimic is not None or coefficients is None:
            return None
        leader, factor = followed, coefficients[0]
    both = _get_range(leader)
    if not all(map(math.isfinite, both)):
        return None
    near, far = sorted(both, key=abs)
    return factor * far if abs(far) > _ONE_SIDED * abs(near) else None


def _get_range(joint: Joint) -> tuple[float, float]:
    lower, upper = (joint.get_limit_value(name) for name in ("lower", "upper"))
    return math.nan if lower is None else lower, math.nan if upper is None else upper


def _order(one: Joint, other: Joint, kind: Kind, others: tuple[Joint, ...] = ()) -> OpposedAxes:
    """Put the joint with the negative axis first, else the second one."""
    is_first = sum(one.axis or ()) < 0 <= sum(other.axis or ())
    joint, twin = (one, other) if is_first else (other, one)
    return OpposedAxes(joint=joint, twin=twin, kind=kind, others=others)
