"""A rotation as the rpy of an origin: the angles that change as few of the author's as possible, and their text."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.likeness.symmetry import measure_rotation_angle
from urdfcheck.facts.motion.kinematics import matrix_to_rpy, rpy_to_matrix

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# Predicted frames are only as exact as the rpy of the siblings; 1.57 is the coarsest that is common.
ANGLE_TOLERANCE = 2e-3
ROUND_STEP = math.pi / 12
# Angles that were computed from the same digits.
_EXACT = 1e-6


def find_nearest_rpy(rotation: Array, typed: Sequence[float] | None) -> list[float]:
    """Return the angles of a rotation (3, 3), with two of the author's three where those do.

    Near a pitch of 90° many angles are one rotation: those with the fewest that are not round are what the author meant.
    """
    true = matrix_to_rpy(rotation)
    rpy = [_snap_angle(angle) for angle in true]
    if typed is not None:
        rpy = [_keep_typed(*three) for three in zip(true, rpy, typed, strict=True)]
    if typed is None or sum(abs(a - b) > ANGLE_TOLERANCE for a, b in zip(rpy, typed, strict=True)) < 2:
        return rpy
    best, least = rpy, (len(rpy) + 1, ANGLE_TOLERANCE)
    roll, pitch, yaw = (rpy_to_matrix(np.eye(3)[slot] * typed[slot]) for slot in range(3))
    # The rotation is yaw @ pitch @ roll: what is left of it without the two that stay.
    for slot, left in (
        (0, (yaw @ pitch).T @ rotation),
        (1, yaw.T @ rotation @ roll.T),
        (2, rotation @ (pitch @ roll).T),
    ):
        kept = [float(angle) for angle in typed]
        kept[slot] = _snap_angle(matrix_to_rpy(left)[slot])
        off = measure_rotation_angle(rpy_to_matrix(kept), rotation)
        misfit = (sum(not is_round(angle) for angle in kept), off)
        if off < ANGLE_TOLERANCE and misfit < least:
            best, least = kept, misfit
    return best


def _keep_typed(true: float, rounded: float, typed: float) -> float:
    """Return what the author typed where it is the ``true`` angle, else the ``rounded`` one; half a turn with the sign that was
    typed."""
    if abs(true - typed) < _EXACT:
        return float(typed)
    return math.copysign(rounded, typed) if math.pi - abs(rounded) < ANGLE_TOLERANCE else rounded


def _snap_angle(angle: float) -> float:
    """Round a predicted angle to a near multiple of 15°, else to 1e-6 rad."""
    return round(angle / ROUND_STEP) * ROUND_STEP if is_round(angle) else round(angle, 6)


def has_round_angles(rpy: Sequence[float]) -> bool:
    """Whether all angles are near multiples of 15°."""
    return all(map(is_round, rpy))


def is_round(angle: float) -> bool:
    """Whether an angle is near a multiple of 15°."""
    return abs(math.remainder(angle, ROUND_STEP)) < ANGLE_TOLERANCE


def format_angle(angle: float, *, xacro: bool) -> str:
    """Return a number with all its digits, or an expression of pi in a xacro."""
    parts = round(angle / ROUND_STEP)
    if not xacro or not parts or abs(angle - parts * ROUND_STEP) > 1e-12:
        return f"{angle:.15g}" if angle else "0"
    common = math.gcd(parts, 12)
    top, bottom = abs(parts) // common, 12 // common
    text = ("-" if parts < 0 else "") + (f"{top}*pi" if top > 1 else "pi") + (f"/{bottom}" if bottom > 1 else "")
    return f"${{{text}}}"
