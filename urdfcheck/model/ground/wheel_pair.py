"""A lone pair of wheels, known by its names or its symmetry, compared with its mirror image about the robot's own plane."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from urdfcheck.core import FactUnavailableError
from urdfcheck.core.records import dataclass
from urdfcheck.model.fact import fact
from urdfcheck.model.ground.wheels import Wheel, are_beside_each_other, is_carried_by_one_body, rolling_wheels
from urdfcheck.model.likeness.side_names import pair_by_name
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.corners import collect_body_corners
from urdfcheck.model.wheel_names import CASTER_NAME, NOT_DRIVEN_NAME, PASSIVE_NAME

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# What is the same of two wheels within this share of the radius, this length (m) or this angle (rad) shows that they are a pair.
_SAME_SHARE, _SAME_LENGTH, _SAME_ANGLE = 0.02, 5e-4, 0.01
# The parts of the plane's evidence agree to a millimetre, or this share of the track.
_MIDDLE, _MIDDLE_SHARE = 1e-3, 3e-3


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class WheelPair:
    """Two wheels that should be mirror images; lengths in m, in root coordinates."""

    left: Wheel
    right: Wheel
    is_named: bool
    """Whether names say left and right; otherwise symmetry does."""
    lateral: Array
    """Unit vector (3,) to the left: the root's axis that is nearest to the wheels' own."""
    ahead: float
    """How far the left wheel is ahead of the right one."""
    above: float
    """How far the axle of the left wheel is above that of the right one."""
    angle: float
    """Angle (rad) between the left axis and the mirror image of the right one."""
    tilts: tuple[float, float]
    """Angle (rad) of the left and of the right axis from the lateral direction."""
    larger: float
    """By how much the radius of the left wheel is larger."""
    outside: float | None
    """How much farther out than the right one the left wheel is; None where nothing shows where the middle is."""

    @property
    def radius(self) -> float:
        """The smaller radius."""
        return min(self.left.radius, self.right.radius)


@fact
def find_lone_wheel_pair(model: Model) -> WheelPair | None:
    """Find the one pair of wheels of a robot that has casters or nothing else; None where it has more wheels, or others.

    Names that differ in nothing but the side make two wheels a pair, or symmetry: of height, distance ahead, radius, direction
    of the axes and distance from the middle at most one differs from side to side.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    import numpy as np

    wheels = [w for w in rolling_wheels(model) if not _is_caster(w)]
    if len(wheels) != 2 or not is_carried_by_one_body(model, wheels) or not are_beside_each_other(*wheels):
        return None
    one, other = wheels
    is_named = _are_named_left_and_right(wheels)
    mean = one.axis + (other.axis if one.axis @ other.axis > 0 else -other.axis)
    direction = int(np.abs(mean).argmax())
    lateral = np.eye(3)[direction]
    if direction == 2 or abs(mean[direction]) < 0.9 * np.linalg.norm(mean):
        return None
    # To the left of +x is +y; to the left of +y is -x.
    lateral = lateral if direction == 1 else -lateral
    apart = one.centre - other.centre
    left, right = (one, other) if apart @ lateral > 0 else (other, one)
    apart = left.centre - right.centre
    ahead = np.cross(lateral, (0.0, 0.0, 1.0))
    tilts = tuple(math.acos(min(1.0, abs(float(w.axis @ lateral)))) for w in (left, right))
    mirrored = right.axis - 2 * float(right.axis @ lateral) * lateral
    pair = WheelPair(
        left=left,
        right=right,
        is_named=is_named,
        lateral=lateral,
        ahead=float(apart @ ahead),
        above=float(apart[2]),
        angle=_measure_angle(left.axis, mirrored),
        tilts=(tilts[0], tilts[1]),
        larger=left.radius - right.radius,
        outside=_measure_outside(model, left, right, lateral),
    )
    return pair if is_named or (_have_no_roles(wheels) and _is_symmetric_but_for_one(pair)) else None


def _is_caster(wheel: Wheel) -> bool:
    names = f"{wheel.joint.name} {wheel.joint.child}"
    return bool(CASTER_NAME.search(names) or NOT_DRIVEN_NAME.search(names))


def _are_named_left_and_right(wheels: Sequence[Wheel]) -> bool:
    """Whether names say left and right."""
    joints = [wheel.joint for wheel in wheels]
    names = [joint.name for joint in joints], [joint.child for joint in joints]
    return any(any(pair_by_name(two)) for two in names)


def _have_no_roles(wheels: Sequence[Wheel]) -> bool:
    """Whether no name says that one of the wheels is not driven."""
    return not any(PASSIVE_NAME.search(f"{wheel.joint.name} {wheel.joint.child}") for wheel in wheels)


def _is_symmetric_but_for_one(pair: WheelPair) -> bool:
    """Whether at most one quantity differs from side to side: more would not show that the wheels are a pair."""
    same = max(_SAME_SHARE * pair.radius, _SAME_LENGTH)
    lengths = [pair.above, pair.ahead, pair.larger] + ([] if pair.outside is None else [pair.outside / 2])
    return sum(abs(length) > same for length in lengths) + (pair.angle > _SAME_ANGLE) <= 1


def _measure_outside(model: Model, left: Wheel, right: Wheel, lateral: Array) -> float | None:
    """Measure by how much farther from the middle of the body that carries them the left wheel is.

    The middle is that of the root's frame, where what the body draws and collides with has its middle there, too.
    """
    try:
        points = collect_body_corners(model, model.tree.list_body_links(left.joint.parent))
    except FactUnavailableError:
        return None
    if points is None or not len(points):
        return None
    across = points @ lateral
    track = float((left.centre - right.centre) @ lateral)
    if abs(float(across.min() + across.max())) / 2 > max(_MIDDLE, _MIDDLE_SHARE * track):
        return None
    return float((left.centre + right.centre) @ lateral)


def _measure_angle(one: Array, other: Array) -> float:
    from urdfcheck.facts.likeness.revolution import measure_line_angle

    return measure_line_angle(one, other)
