"""A lone left/right pair of wheels, compared with its mirror image about the robot's own plane."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from urdfcheck.core import FactUnavailableError
from urdfcheck.core.records import dataclass
from urdfcheck.model.fact import fact
from urdfcheck.model.ground.wheels import Wheel, is_suspended, rolling_wheels
from urdfcheck.model.likeness.side_names import pair_by_name
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.corners import collect_body_corners
from urdfcheck.model.wheel_names import CASTER_NAME, NOT_DRIVEN_NAME

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# Wheels of radii that differ by more are not one pair.
_ONE_SIZE = 1.5
# The parts of the plane's evidence agree to a millimetre, or this share of the track.
_MIDDLE, _MIDDLE_SHARE = 1e-3, 3e-3


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class WheelPair:
    """Two wheels that should be mirror images; lengths in m, in root coordinates."""

    left: Wheel
    right: Wheel
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

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    import numpy as np

    wheels = [w for w in rolling_wheels(model) if not _is_caster(w)]
    if len(wheels) != 2 or not _is_left_right_pair(model, wheels):
        return None
    one, other = wheels
    if max(one.radius, other.radius) > _ONE_SIZE * min(one.radius, other.radius):
        return None
    mean = one.axis + (other.axis if one.axis @ other.axis > 0 else -other.axis)
    direction = int(np.abs(mean).argmax())
    lateral = np.eye(3)[direction]
    if direction == 2 or abs(mean[direction]) < 0.9 * np.linalg.norm(mean):
        return None
    # To the left of +x is +y; to the left of +y is -x.
    lateral = lateral if direction == 1 else -lateral
    apart = one.centre - other.centre
    if abs(float(apart @ lateral)) < 0.7 * float(np.linalg.norm(apart)):
        return None
    left, right = (one, other) if apart @ lateral > 0 else (other, one)
    apart = left.centre - right.centre
    ahead = np.cross(lateral, (0.0, 0.0, 1.0))
    tilts = tuple(math.acos(min(1.0, abs(float(w.axis @ lateral)))) for w in (left, right))
    mirrored = right.axis - 2 * float(right.axis @ lateral) * lateral
    return WheelPair(
        left=left,
        right=right,
        lateral=lateral,
        ahead=float(apart @ ahead),
        above=float(apart[2]),
        angle=_measure_angle(left.axis, mirrored),
        tilts=(tilts[0], tilts[1]),
        larger=left.radius - right.radius,
        outside=_measure_outside(model, left, right, lateral),
    )


def _is_caster(wheel: Wheel) -> bool:
    names = f"{wheel.joint.name} {wheel.joint.child}"
    return bool(CASTER_NAME.search(names) or NOT_DRIVEN_NAME.search(names))


def _is_left_right_pair(model: Model, wheels: Sequence[Wheel]) -> bool:
    """Whether names say left and right, and one body carries both without a joint that moves."""
    joints = [wheel.joint for wheel in wheels]
    names = [joint.name for joint in joints], [joint.child for joint in joints]
    if not any(any(pair_by_name(two)) for two in names):
        return False
    bodies = {model.tree.list_body_links(joint.parent)[0] for joint in joints}
    return len(bodies) == 1 and not any(is_suspended(model, joint.child) for joint in joints)


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
