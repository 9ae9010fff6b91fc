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


def find_nearest_rpy(rotation: Array, typed: Sequence[float] | None) -> list[float]:
    """Return the angles of a rotation (3, 3), with two of the author's three where those do.

    Near a pitch of 90° many angles are one rotation.
    """
    rpy = [_snap_angle(angle) for angle in matrix_to_rpy(rotation)]
    if typed is None or sum(abs(a - b) > ANGLE_TOLERANCE for a, b in zip(rpy, typed, strict=True)) < 2:
        return rpy
    best, least = rpy, ANGLE_TOLERANCE
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
        if off < least:
            best, least = kept, off
    return best


def _snap_angle(angle: float) -> float:
    """Round a predicted angle to a near multiple of 15°, else to 1e-6 rad."""
    nearest = round(angle / ROUND_STEP) * ROUND_STEP
    return nearest if abs(angle - nearest) < ANGLE_TOLERANCE else round(angle, 6)


def format_angle(angle: float, *, xacro: bool) -> str:
    """Return a number with all its digits, or an expression of pi in a xacro."""
    parts = round(angle / ROUND_STEP)
    if not xacro or not parts or abs(angle - parts * ROUND_STEP) > 1e-12:
        return f"{angle:.15g}" if angle else "0"
    common = math.gcd(parts, 12)
    top, bottom = abs(parts) // common, 12 // common
    text = ("-" if parts < 0 else "") + (f"{top}*pi" if top > 1 else "pi") + (f"/{bottom}" if bottom > 1 else "")
    return f"${{{text}}}"
