"""The greatest distance of two of many points."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.mesh.convex_hull import MOST_EXACT, compute_convex_hull

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from urdfcheck.facts.arrays import Array

# Points of which all pairs are compared more quickly than their hull is made.
_FEW = 1000
# Rows of points that are compared with all others at once.
_ROWS = 256
# Distances that are computed at once, of which each takes 32 bytes: a mesh may have a million corners.
_COMPARED = 1_000_000


def measure_diameter(points: ArrayLike) -> float:
    """Measure the greatest distance of two of ``points`` (K, 3): the length that a reader measures, and never more than
    `urdfcheck.facts.inertials.hull_bounds.measure_extent`."""
    corners = _drop_inner_points(np.asarray(points, dtype=float))
    corners = corners - corners.mean(axis=0)
    reach = np.linalg.norm(corners, axis=1)
    order = np.argsort(-reach)
    corners, reach = corners[order], reach[order]
    # Two points are no farther apart than both are from the middle: those near it are in no pair that is longer than one known.
    farthest = float(np.linalg.norm(corners - corners[0], axis=1).max())
    rows = max(1, min(_ROWS, _COMPARED // len(corners)))
    for start in range(0, len(corners), rows):
        if reach[start] + reach[0] <= farthest:
            break
        last = int(np.searchsorted(-reach, float(reach[start]) - farthest, side="right"))
        apart = corners[start : start + rows, None] - corners[None, start : max(last, start + 1)]
        farthest = max(farthest, float(np.einsum("ijk,ijk->ij", apart, apart).max()) ** 0.5)
    return farthest


def _drop_inner_points(points: Array) -> Array:
    """Return those of ``points`` (K, 3) that are corners of their convex hull, if they are many, and perhaps a few others."""
    if len(points) <= _FEW:
        return points
    hulls = []
    for start in range(0, len(points), MOST_EXACT):
        part = points[start : start + MOST_EXACT]
        hull = compute_convex_hull(part)
        hulls.append(hull.vertices if hull.volume else part)  # of flat points it is a box about them
    corners = np.concatenate(hulls)
    return _drop_inner_points(corners) if len(corners) < len(points) else corners
