"""A mechanism with all joints at zero, as screws and contents in one frame: it does not depend on where link frames are.

At zero every moving joint is a line (or a direction) in the frame of an anchor link, and every mass and shape is at a place in
it. Two trees with equal lines, places and limits move alike in every configuration: the product of exponentials needs nothing
else (Brockett, *Robotic manipulators and the product of exponentials formula*, 1984).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from urdfcheck.core.mechanism import MechanismJoint, MechanismLink, RobotMechanism
from urdfcheck.core.records import dataclass
from urdfcheck.facts.arrays import Mat4, Vec3
from urdfcheck.facts.motion.kinematics import compute_axis_angle

# Angles and lengths that differ by less are one value in different digits: π to five digits is off by 7e-6.
ANGLE_TOLERANCE, LENGTH_TOLERANCE = 2e-5, 2e-5
# Shares of masses, moments, limits and scales that differ by less are one value: six digits are off by at most 5e-6.
RELATIVE_TOLERANCE = 1e-5


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class HomePose:
    """A mechanism with all joints at zero."""

    mechanism: RobotMechanism
    links: Mapping[str, MechanismLink]
    joints: Mapping[str, MechanismJoint]
    frames: Mapping[str, Mat4]
    """Of each link, in the anchor's frame."""
    joint_above: Mapping[str, MechanismJoint]
    """The joint on which each link but the root hangs."""
    joints_below: Mapping[str, Sequence[MechanismJoint]]
    """The joints that hang on each link."""

    @property
    def order(self) -> tuple[str, ...]:
        """The links from the root outwards."""
        return tuple(self.links)


@dataclass(frozen=True, slots=True, eq=False)
class Screw:
    """The axis of a joint with all joints at zero, in the anchor's frame."""

    direction: Vec3
    point: Vec3


def compute_home_pose(mechanism: RobotMechanism, anchor: str | None = None) -> HomePose:
    """Place the links of a mechanism with all joints at zero, in the frame of the link ``anchor`` (default: the root)."""
    frames: dict[str, Mat4] = {mechanism.root: np.eye(4)}
    below: dict[str, list[MechanismJoint]] = {link.name: [] for link in mechanism.links}
    for joint in mechanism.joints:
        frames[joint.child] = frames[joint.parent] @ np.array(joint.pose).reshape(4, 4)
        below[joint.parent].append(joint)
    if anchor is not None:
        back = invert_pose(frames[anchor])
        frames = {name: back @ frame for name, frame in frames.items()}
    return HomePose(
        mechanism=mechanism,
        links={link.name: link for link in mechanism.links},
        joints={joint.name: joint for joint in mechanism.joints},
        frames=frames,
        joint_above={joint.child: joint for joint in mechanism.joints},
        joints_below=below,
    )


def locate_screw(home: HomePose, joint: MechanismJoint) -> Screw | None:
    """Return the screw of a joint; None for a joint without axis."""
    if not joint.axis:
        return None
    frame = home.frames[joint.child]
    return Screw(frame[:3, :3] @ np.array(joint.axis), frame[:3, 3])


def invert_pose(pose: Mat4) -> Mat4:
    """Invert a rigid transform."""
    inverse = np.eye(4)
    inverse[:3, :3] = pose[:3, :3].T
    inverse[:3, 3] = -pose[:3, :3].T @ pose[:3, 3]
    return inverse


def measure_shift(first: Mat4, second: Mat4) -> tuple[float, float]:
    """Return the distance (m) and the angle (rad) between two poses."""
    distance = float(np.linalg.norm(second[:3, 3] - first[:3, 3]))
    return distance, compute_axis_angle(second[:3, :3] @ first[:3, :3].T)[1]


def is_same_pose(first: Mat4, second: Mat4) -> bool:
    """Whether two poses differ by less than the tolerances."""
    distance, angle = measure_shift(first, second)
    return distance <= LENGTH_TOLERANCE and angle <= ANGLE_TOLERANCE


def measure_axis_change(first: Screw, second: Screw, *, is_line: bool) -> tuple[float, float, bool]:
    """Return the angle (rad) between two axes, the distance (m) between their lines and whether one is reversed.

    The angle is between the lines: a reversed axis has 0. ``is_line``: the place counts, like for a rotation.
    """
    cosine = float(first.direction @ second.direction)
    sine = float(np.linalg.norm(np.cross(first.direction, second.direction)))
    angle = float(np.arctan2(sine, abs(cosine)))
    apart = second.point - first.point
    apart = apart - first.direction * float(apart @ first.direction)
    return angle, float(np.linalg.norm(apart)) if is_line else 0.0, cosine < 0.0


def is_same_number(first: float | None, second: float | None, scale: float = 0.0) -> bool:
    """Whether two values are one in different digits; ``scale``: a size below which their difference counts as a share of it."""
    if first is None or second is None:
        return first is second
    if first == second:
        return True
    return abs(first - second) <= RELATIVE_TOLERANCE * max(abs(first), abs(second), scale)
