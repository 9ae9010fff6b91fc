"""Where spheres and points get to when a joint moves: bounds that prove that links never meet."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from urdfcheck.facts.arrays import Array, Vec3


def compute_swept_spheres(
    centres: Array, radii: Array, axis: Vec3, *, lower: float, upper: float, rotates: bool
) -> tuple[Array, Array]:
    """Return spheres that contain given spheres (n) wherever a joint moves them, its value between ``lower`` and ``upper`` (rad
    if it ``rotates``, otherwise m).

    ``axis`` (3,): unit vector through the origin of the frame in which ``centres`` (n, 3) are given; ``radii`` (n,), in m.
    """
    middle, half = (lower + upper) / 2, (upper - lower) / 2
    if not rotates:
        return centres + middle * axis, radii + half
    foot = (centres @ axis)[:, None] * axis
    arm = centres - foot
    distance = np.linalg.norm(arm, axis=1)
    if half >= math.pi / 2:
        return foot, radii + distance
    turned = arm * math.cos(middle) + np.cross(axis, arm) * math.sin(middle)
    return foot + math.cos(half) * turned, radii + distance * math.sin(half)


def compute_least_distance(
    centres: Array, others: Array, axis: Vec3, *, lower: ArrayLike, upper: ArrayLike, rotates: bool
) -> Array:
    """Compute the least distance (n,) in m between points that a joint moves and points that stay, its value between ``lower``
    and ``upper`` (rad if it ``rotates``, otherwise m).

    ``axis`` (3,): unit vector through the origin of the frame in which ``centres`` and ``others`` (n, 3) are given.
    """
    apart = others - centres
    if not rotates:
        along = np.clip(apart @ axis, lower, upper)
        gap: Array = np.linalg.norm(apart - along[:, None] * axis, axis=1)
        return gap
    arm, goal = (points - (points @ axis)[:, None] * axis for points in (centres, others))
    radius, distance = np.linalg.norm(arm, axis=1), np.linalg.norm(goal, axis=1)
    turn = np.arctan2(np.cross(arm, goal) @ axis, np.einsum("ni,ni->n", arm, goal))
    passed = np.floor((upper - turn) / (2 * math.pi)) >= np.ceil((lower - turn) / (2 * math.pi))
    cosine = np.where(passed, 1.0, np.maximum(np.cos(turn - lower), np.cos(turn - upper)))
    squared = (apart @ axis) ** 2 + radius**2 + distance**2 - 2 * radius * distance * cosine
    near: Array = np.sqrt(np.maximum(squared, 0.0))
    return near
