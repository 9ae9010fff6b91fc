"""Rotations and rigid transforms in URDF's conventions, and the motions of joints."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.small_matrices import Placement, find_turn, make_quaternion_rotation, make_rotation

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from urdfcheck.facts.arrays import Array, Mat3, Mat4, Vec3


# Below this cosine of the pitch, roll and yaw turn about the same axis and only their sum is determined. sqrt(eps):
# there the two entries that would determine yaw are dominated by rounding.
_GIMBAL = 1e-8


def rpy_to_matrix(rpy: Sequence[float]) -> Mat3:
    """Convert URDF's fixed-axis roll, pitch, yaw (rad) to a (3, 3) rotation: ``Rz(yaw) Ry(pitch) Rx(roll)``."""
    return np.array(make_rotation(rpy))


def matrix_to_rpy(rotation: ArrayLike) -> tuple[float, float, float]:
    """Convert a (3, 3) rotation to roll, pitch, yaw (rad); pitch within ±π/2, roll 0 where pitch is ±π/2."""
    r = np.asarray(rotation, dtype=float)
    cos_pitch = math.hypot(r[0, 0], r[1, 0])
    pitch = math.atan2(-r[2, 0], cos_pitch)
    if cos_pitch < _GIMBAL:
        return 0.0, pitch, math.atan2(-r[0, 1], r[1, 1])
    return math.atan2(r[2, 1], r[2, 2]), pitch, math.atan2(r[1, 0], r[0, 0])


def quaternion_to_matrix(xyzw: Sequence[float]) -> Mat3:
    """Convert a quaternion ``x y z w`` of any length to a (3, 3) rotation.

    :raises ValueError: when its length is zero or not finite.
    """
    return np.array(make_quaternion_rotation(xyzw))


def build_origin_transform(xyz: Sequence[float], rpy: Sequence[float]) -> Mat4:
    """Build the (4, 4) homogeneous transform of a URDF ``<origin>`` (m, rad) in its parent's frame."""
    transform = np.eye(4)
    transform[:3, :3] = rpy_to_matrix(rpy)
    transform[:3, 3] = xyz
    return transform


def build_transform(placement: Placement) -> Mat4:
    """Build the (4, 4) homogeneous transform of a placement."""
    transform = np.eye(4)
    transform[:3, :3] = placement.rotation
    transform[:3, 3] = placement.place
    return transform


def compute_axis_angle(rotation: ArrayLike) -> tuple[Vec3, float]:
    """Compute the unit axis (3,) and the angle (rad) of a (3, 3) rotation with `find_turn`."""
    axis, angle = find_turn(np.asarray(rotation, dtype=float).tolist())
    return np.array(axis), angle


def compute_joint_motions(axis: ArrayLike, values: ArrayLike, *, rotates: bool) -> Array:
    """Compute the transforms (N, 4, 4) of a joint with the unit ``axis`` (3,) at each of its ``values`` (N,), rad or m.

    Rotations by Rodrigues' formula.
    """
    direction, amounts = np.asarray(axis, dtype=float), np.asarray(values, dtype=float)
    motions = np.zeros((len(amounts), 4, 4))
    motions[:] = np.eye(4)
    if rotates:
        x, y, z = direction
        skew = np.array(((0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)))
        motions[:, :3, :3] += np.sin(amounts)[:, None, None] * skew
        motions[:, :3, :3] += (1.0 - np.cos(amounts))[:, None, None] * (skew @ skew)
    else:
        motions[:, :3, 3] = amounts[:, None] * direction
    return motions
