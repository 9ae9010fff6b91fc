"""Bodies of revolution: the axis of a surface or a mass, and how round it is."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from urdfcheck.facts.arrays import Array, Vec3


# A body of revolution has one moment that differs from the others by more than the first share of the largest, and two that
# differ by less than the second: this finds the axis of 87 of 96 wheels of published robots, to 0.24° for 95 % of them.
_STANDS_OUT = 0.10
_ALIKE = 0.05
# Directions in which the support is measured; opposite ones make a diameter.
_DIRECTIONS = 16
# By how much (rad) the edges of sectors are turned.
_OFF_CORNERS = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class RoundOutline:
    """The outline of points seen along an axis; all in m."""

    centre: Vec3
    """Of the outline, at half the width."""
    radius: float
    """The farthest reach of the outline from the centre."""
    usual_radius: float
    """The farthest reach in most directions: a bump or a notch does not change it."""
    inner_radius: float
    """The least reach of the outline from the centre."""
    width: float
    """Along the axis."""

    def is_round(self, min_ratio: float = 0.95) -> bool:
        """Whether the outline reaches equally far in all directions; 0.95 leaves room for a polygon of ten corners."""
        return self.radius > 0.0 and self.inner_radius > min_ratio * self.radius


def find_revolution_axis(covariance: ArrayLike) -> Array | None:
    """Find the unit axis (3,) of the body of revolution with this covariance (3, 3) of its surface or its mass.

    None when no moment stands out or the other two differ. The sign is arbitrary.
    """
    moments, axes = np.linalg.eigh(np.asarray(covariance, dtype=float))
    least, middle, largest = moments.tolist()
    if not largest > 0.0:
        return None
    for place, one, other, along in ((0, middle, largest, least), (2, least, middle, largest)):
        if abs(one - other) < _ALIKE * largest and abs(along - (one + other) / 2.0) > _STANDS_OUT * largest:
            axis: Array = axes[:, place]
            return axis
    return None


def measure_outline(points: ArrayLike, axis: ArrayLike, centre: ArrayLike | None = None) -> RoundOutline:
    """Measure how round ``points`` (n, 3) are about a unit ``axis`` (3,) through ``centre``, or the middle of their outline.

    The outline is that of their convex hull, from its support in 16 directions.
    """
    corners, along = np.asarray(points, dtype=float), np.asarray(axis, dtype=float)
    first = np.cross(along, np.eye(3)[int(np.abs(along).argmin())])
    first /= np.linalg.norm(first)
    across = np.array((first, np.cross(along, first)))
    flat, depth = corners @ across.T, corners @ along
    middle = _find_outline_centre(flat) if centre is None else across @ np.asarray(centre, dtype=float)
    reach = ((flat - middle) @ _sample_circle_directions().T).max(axis=0)
    distances = np.linalg.norm(flat - middle, axis=1)
    low, high = float(depth.min()), float(depth.max())
    return RoundOutline(
        centre=middle @ across + (low + high) / 2.0 * along,
        radius=float(distances.max()),
        usual_radius=_find_usual_reach(flat - middle, distances),
        inner_radius=float(reach.min()),
        width=high - low,
    )


def _find_usual_reach(flat: Array, distances: Array) -> float:
    """Return the median, over the sectors of the outline, of the farthest of the points ``flat`` (n, 2) in each.

    The corners of a polygon have equal reach: their distance is the radius that was meant, and the support between them is less.
    """
    # Corners are usually at whole fractions of a turn: the edges of the sectors are not.
    turned = np.arctan2(flat[:, 1], flat[:, 0]) + _OFF_CORNERS
    sectors = np.floor(turned * (_DIRECTIONS / math.tau)).astype(int) % _DIRECTIONS
    farthest = np.zeros(_DIRECTIONS)
    np.maximum.at(farthest, sectors, distances)
    return float(np.median(farthest[farthest > 0.0])) if farthest.any() else 0.0


def measure_line_angle(one: ArrayLike, other: ArrayLike) -> float:
    """Measure the angle (rad, within [0, π/2]) between two axes (3,), regardless of their signs and lengths."""
    a, b = np.asarray(one, dtype=float), np.asarray(other, dtype=float)
    return math.atan2(float(np.linalg.norm(np.cross(a, b))), abs(float(a @ b)))


def _find_outline_centre(flat: Array) -> Array:
    """Find the point (2,) from which opposite supports are equal, in the sense of least squares."""
    directions = _sample_circle_directions()
    support = (flat @ directions.T).max(axis=0)
    half = _DIRECTIONS // 2
    offsets = (support[:half] - support[half:]) / 2.0
    # The directions are spread evenly, so that the normal matrix is a multiple of one.
    middle: Array = 2.0 / half * offsets @ directions[:half]
    return middle


def _sample_circle_directions() -> Array:
    angles = np.arange(_DIRECTIONS) * math.tau / _DIRECTIONS
    return np.column_stack((np.cos(angles), np.sin(angles)))
