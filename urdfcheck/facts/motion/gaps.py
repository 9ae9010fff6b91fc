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
    """Whether one of some points (n, 3) is within ``reach`` (m) of one of others (m, 3)."""
    from scipy.spatial import cKDTree  # loaded only where it is used

    if not len(others):
        return False
    low, high = others.min(axis=0) - reach, others.max(axis=0) + reach
    near = points[((points >= low) & (points <= high)).all(axis=1)]
    if not len(near):
        return False
    distances, _ = cKDTree(others).query(near, distance_upper_bound=reach)
    return bool(np.isfinite(distances).any())
