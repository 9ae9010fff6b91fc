"""Distances between shapes at rest, with coal."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.facts.motion.coal_shapes import build_coal_primitive, fill_coal_tree
from urdfcheck.facts.motion.collision_geometry import CollisionGeometry, PlacedGeometry

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# Vertices of a mesh that are compared with those of another one, to see that both touch.
_MOST_POINTS = 2000
# Points that are compared with others at a time.
_BATCH = 64


class Gaps:
    """Measures distances, with what coal prepares for a geometry kept.

    :raises ImportError: when coal is not installed.
    """

    def __init__(self) -> None:
        import coal

        self._coal = coal
        self._prepared: dict[int, tuple[CollisionGeometry, Any]] = {}

    def measure(self, one: PlacedGeometry, other: PlacedGeometry) -> float:
        """Measure the distance (m) between two surfaces in one frame; 0 where they meet."""
        coal = self._coal
        request, result = coal.DistanceRequest(), coal.DistanceResult()
        ends = [
            end
            for placed in (one, other)
            for end in (
                self._prepare(placed.geometry),
                coal.Transform3s(np.ascontiguousarray(placed.pose[:3, :3]), placed.pose[:3, 3]),
            )
        ]
        return max(0.0, float(coal.distance(*ends, request, result)))

    def _prepare(self, geometry: CollisionGeometry) -> Any:
        if id(geometry) not in self._prepared:
            # The geometry is kept too: its id would be used again.
            self._prepared[id(geometry)] = geometry, self._build(geometry)
        return self._prepared[id(geometry)][1]

    def _build(self, geometry: CollisionGeometry) -> Any:
        coal = self._coal
        if geometry.vertices is None or geometry.faces is None:
            return build_coal_primitive(coal, geometry.kind, geometry.size)
        # Distances of meshes need spheres that are swept along rectangles.
        return fill_coal_tree(coal.BVHModelOBBRSS(), geometry.vertices, geometry.faces)


def sample_vertices(placed: PlacedGeometry) -> Array | None:
    """Return some vertices (n, 3) of a mesh, in the frame in which it is placed; None for a primitive."""
    vertices = placed.geometry.vertices
    if vertices is None:
        return None
    some = vertices[:: max(1, len(vertices) // _MOST_POINTS)]
    some = some[np.isfinite(some).all(axis=1)]
    points: Array = some @ placed.pose[:3, :3].T + placed.pose[:3, 3]
    return points


def is_within(points: Array, others: Array, reach: float) -> bool:
    """Whether one of some points (n, 3) is nearer than ``reach`` (m) to one of others (m, 3).

    Both are sorted along the longest side of what they share, so that each is compared with those beside it. A k-d tree would be
    quicker in itself; to load scipy's takes a third of the time in which a robot is checked.
    """
    if not len(points) or not len(others):
        return False
    low = np.maximum(points.min(axis=0), others.min(axis=0)) - reach
    high = np.minimum(points.max(axis=0), others.max(axis=0)) + reach
    axis = int((high - low).argmax())
    near, far = (
        inside[inside[:, axis].argsort()]
        for some in (points, others)
        for inside in (some[((some >= low) & (some <= high)).all(axis=1)],)
    )
    for start in range(0, len(near), _BATCH):
        batch = near[start : start + _BATCH]
        first, last = np.searchsorted(far[:, axis], (batch[0, axis] - reach, batch[-1, axis] + reach))
        if (((batch[:, None] - far[first:last]) ** 2).sum(axis=-1) < reach**2).any():
            return True
    return False
