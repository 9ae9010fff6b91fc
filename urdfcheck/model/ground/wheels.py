"""The wheels that carry a robot."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.likeness.revolution import measure_outline
from urdfcheck.model.fact import fact
from urdfcheck.model.parts import Joint, Link
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.corners import collect_shape_corners, compute_shape_corners, has_known_shapes
from urdfcheck.model.wheel_names import CASTER_NAME, NOT_DRIVEN_NAME, WHEEL_NAME

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# A wheel's axis is level to within its camber, and parallel to another to within its toe: 6°.
LEVEL = 0.1
# What is named a wheel is one with its axis up to 15° off level. Of 735 published models, the wheels of one are between both.
_TILTED = 0.26
_NOT_WHEEL_NAME = re.compile(r"roller|steering_?wheel|fly_?wheel|reaction|momentum|spare", re.IGNORECASE)
# Round parts that turn in air or water: no robot stands on them, however low they reach.
_PROPELLER_NAME = re.compile(r"propell|impeller|thruster|rotor", re.IGNORECASE)
# Wheels of radii that differ by more are not one pair; nor are wheels less than this share of whose distance is along the axle.
_ONE_SIZE, _BESIDE = 1.5, 0.7
# Copies of one wheel have its radius and width within this share, and its height within this share of the radius (chosen).
_SAME_SIZE, _SAME_HEIGHT = 0.01, 0.1


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Wheel:
    """A wheel that can stand on the ground; vectors in root coordinates."""

    joint: Joint
    centre: Array
    """(3,), in the middle of the wheel's width."""
    axis: Array
    """Unit vector (3,)."""
    radius: float
    """Metres: the farthest point from the axis."""
    width: float
    """Metres."""
    bottom: float
    """The height of the lowest drawn point."""

    @property
    def contact(self) -> Array:
        """The lowest point (3,) of the wheel, as a circle of its radius, in root coordinates with z up."""
        down = self.axis[2] * self.axis - (0.0, 0.0, 1.0)
        lowest: Array = self.centre + self.radius / np.linalg.norm(down) * down
        return lowest


@dataclass(frozen=True, slots=True, eq=False)
class DrivenWheel:
    """A wheel of which only joint and axis matter."""

    joint: Joint
    axis: Array
    """Unit vector (3,) in root coordinates."""
    stands: bool = True
    """Whether it reaches the ground; of the wheels that are found, some may be far from it by mistake."""


def find_driven_wheels(model: Model) -> tuple[DrivenWheel, ...]:
    """Find the wheels that no joint steers, and whether the robot stands on them when all joints are at zero and z is up.

    A link whose shapes are not known counts as a wheel when its name says so.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    known = rolling_wheels(model)
    driven = [
        w
        for w in known
        if not NOT_DRIVEN_NAME.search(_join_joint_names(w.joint)) and not _is_steered(model, w.joint, w.axis)
    ]
    ground = min((w.bottom for w in driven), default=0.0)
    found = [DrivenWheel(w.joint, w.axis, w.bottom - ground < 0.2 * w.radius) for w in driven]
    return (*found, *_find_unseen_wheels(model))


@fact
def rolling_wheels(model: Model) -> tuple[Wheel, ...]:
    """Find all wheels that can stand on the ground, driven, steered or free.

    A wheel is the child of a continuous joint with a level axis, or nearly, drawn round about it; its name, or that of a like
    part on the same link, says wheel or caster, or it reaches as low as anything of the robot, or it is one of the only two such
    parts, beside each other on one body.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    parts = list_round_parts(model)
    named = [
        part
        for part in parts
        if WHEEL_NAME.search(_join_joint_names(part.joint)) or CASTER_NAME.search(_join_joint_names(part.joint))
    ]
    # The rotor of a motor in a hub is named after its wheel, too.
    wheels = [part for part in parts if part in named or not _PROPELLER_NAME.search(_join_joint_names(part.joint))]
    # One of several like wheels may have another name: what is as large, and turns about a parallel axis, is one as well.
    named = [wheel for wheel in wheels if any(_is_like(wheel, other) for other in named)]
    # A mesh that was not read may reach lower than all that is known.
    if len(named) == len(wheels) or not all(has_known_shapes(model, link) for link in model.links):
        return tuple(named)
    ground = min(find_lowest_z(model, link) for link in model.links)
    reach = 1.0 if _are_lone_pair(model, wheels) else 0.1
    return tuple(wheel for wheel in wheels if wheel in named or wheel.bottom - ground < reach * wheel.radius)


@fact
def list_round_parts(model: Model) -> tuple[Wheel, ...]:
    """List the children of continuous joints with level axes, or nearly, that are drawn round about them, wheels or not.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    return tuple(wheel for joint in model.joints if (wheel := _measure_wheel(model, joint)) is not None)


def are_beside_each_other(one: Wheel, other: Wheel) -> bool:
    """Whether two wheels of about one size can be those of one axle."""
    if max(one.radius, other.radius) > _ONE_SIZE * min(one.radius, other.radius):
        return False
    mean = one.axis + (other.axis if one.axis @ other.axis > 0 else -other.axis)
    apart = one.centre - other.centre
    return abs(float(apart @ mean)) > _BESIDE * float(np.linalg.norm(apart) * np.linalg.norm(mean))


def is_carried_by_one_body(model: Model, wheels: Sequence[Wheel]) -> bool:
    """Whether no joint that moves, such as a suspension, is between the wheels."""
    bodies = {model.tree.list_body_links(wheel.joint.parent)[0] for wheel in wheels}
    return len(bodies) == 1 and not any(is_suspended(model, wheel.joint.child) for wheel in wheels)


def _is_like(one: Wheel, other: Wheel) -> bool:
    """Whether one is the other, or a part of its size on the same link, at its height and with a parallel axis."""
    if one is other:
        return True
    sizes = ((one.radius, other.radius), (one.width, other.width))
    is_one_size = all(abs(a - b) <= _SAME_SIZE * min(a, b) for a, b in sizes)
    is_level = abs(one.bottom - other.bottom) <= _SAME_HEIGHT * one.radius
    is_parallel = abs(float(one.axis @ other.axis)) > 1 - LEVEL**2 / 2
    return is_one_size and is_level and is_parallel and one.joint.parent == other.joint.parent


def _are_lone_pair(model: Model, wheels: Sequence[Wheel]) -> bool:
    """Whether these are two parts that look like the wheels of one axle: by mistake, one or both may be off the ground."""
    return len(wheels) == 2 and is_carried_by_one_body(model, wheels) and are_beside_each_other(*wheels)


def is_suspended(model: Model, link: str) -> bool:
    """Whether the link can move up and down against the robot: a joint before its own does anything but steer about z."""
    before = [joint for joint in model.tree.find_path_to(link)[:-1] if joint.is_movable]
    axes = [model.axes.get(joint.name) if joint.type in {"revolute", "continuous"} else None for joint in before]
    return any(axis is None or abs(float(axis[2])) < 1 - LEVEL for axis in axes)


def is_on_vertical_slide(model: Model, link: str) -> bool:
    """Whether a prismatic joint can move the link up and down against the robot: a spring, a lift or a fork."""
    slides = [joint for joint in model.tree.find_path_to(link) if joint.type == "prismatic"]
    axes = [model.axes.get(joint.name) for joint in slides]
    return any(axis is None or abs(float(axis[2])) > LEVEL for axis in axes)


def find_lowest_z(model: Model, link: Link) -> float:
    """Find the height (m) in root coordinates of the lowest point of what a link draws or collides as; infinite for nothing.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    frame = model.frames[link.name]
    parts = [
        p
        for shape in (*link.visuals, *link.collisions)
        if (p := compute_shape_corners(model, shape, circumscribed=False)) is not None
    ]
    return min((float((p @ frame[2, :3]).min() + frame[2, 3]) for p in parts), default=math.inf)


def _measure_wheel(model: Model, joint: Joint) -> Wheel | None:
    axis, names = model.axes.get(joint.name), _join_joint_names(joint)
    if joint.type != "continuous" or axis is None or _NOT_WHEEL_NAME.search(names):
        return None
    if abs(axis[2]) > (_TILTED if WHEEL_NAME.search(names) else LEVEL):
        return None
    link = model.link_by_name[joint.child]
    frame = model.frames[link.name]
    # The collision shapes, where they are round: some wheels collide as boxes.
    for shapes in (link.collisions, link.visuals):
        points = collect_shape_corners(model, shapes)
        if points is None or not len(points):
            continue
        placed = points @ frame[:3, :3].T + frame[:3, 3]
        outline = measure_outline(placed, axis, frame[:3, 3])
        if outline.is_round() and outline.width <= 4 * outline.radius:
            return Wheel(
                joint=joint,
                centre=outline.centre,
                axis=axis,
                radius=outline.radius,
                width=outline.width,
                bottom=float(placed[:, 2].min()),
            )
    return None


def _find_unseen_wheels(model: Model) -> Iterator[DrivenWheel]:
    for joint in model.joints:
        axis = model.axes.get(joint.name)
        if joint.type != "continuous" or axis is None or abs(axis[2]) > LEVEL:
            continue
        if (
            not WHEEL_NAME.search(_join_joint_names(joint))
            or NOT_DRIVEN_NAME.search(_join_joint_names(joint))
            or _is_steered(model, joint, axis)
        ):
            continue
        link = model.link_by_name[joint.child]
        shapes = (*link.visuals, *link.collisions)
        if all(compute_shape_corners(model, shape, circumscribed=False) is None for shape in shapes):
            yield DrivenWheel(joint, axis)


def _is_steered(model: Model, joint: Joint, axis: Array) -> bool:
    """Whether a joint before the wheel turns the wheel's axis."""
    before = [
        other for other in model.tree.find_path_to(joint.child)[:-1] if other.is_movable and other.type != "prismatic"
    ]
    axes = [model.axes.get(other.name) for other in before]
    return any(other is None or abs(float(other @ axis)) < 1 - LEVEL for other in axes)


def _join_joint_names(joint: Joint) -> str:
    return f"{joint.name} {joint.child}"
