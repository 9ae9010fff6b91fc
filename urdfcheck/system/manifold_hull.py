"""Convex hulls by Manifold, where scipy is not installed: its wheels take a thirtieth of the space.

The names are those of ``scipy.spatial``, so that `urdfcheck.facts.mesh.convex_hull` can use either.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

# Points whose least spread is below this share of the largest are taken to be in a plane: Manifold leaves out a point that is
# outside by less than about 1e-7 of the size.
_FLAT = 1e-6
# How far a point may be outside, in units of the box's edges. Of one in 400 meshes of published robots Manifold 3.5 leaves out a
# part; with their points in another order it does not.
_OUTSIDE = 1e-6
_ORDERS = 6
# The square of the angle (rad) up to which faces count as parts of one.
_STRAIGHT = 1e-14
# Distances of points to planes that are computed at a time.
_MOST_DISTANCES = 1 << 17


class QhullError(ValueError):
    """The points have no volume."""


class ConvexHull:
    """The convex hull of points (n, 3), with what is read of scipy's.

    No point is outside by more than a millionth of its size, which is verified.

    :raises QhullError: when the points are in a plane.
    :raises ImportError: when Manifold is not installed.
    :raises ArithmeticError: when Manifold fails.
    """

    def __init__(self, points: NDArray[np.float64]) -> None:
        self.points = np.asarray(points, dtype=np.float64)
        self.simplices = _compute_faces(_scale(self.points))
        self.vertices: NDArray[np.int64] = np.unique(self.simplices)
        self._measure()

    def _measure(self) -> None:
        """Compute the planes, whose normals point outwards, the area and the volume."""
        middle = self.points[self.vertices].mean(axis=0)
        a, b, c = (self.points[column] - middle for column in self.simplices.T)
        normals = np.cross(b - a, c - a)
        self.area = float(np.linalg.norm(normals, axis=1).sum()) / 2.0
        self.volume = float(np.einsum("ij,ij->", normals, a)) / 6.0
        self.equations = _compute_planes(self.points, self.simplices)


def _scale(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the points (n, 3) about the middle of their box, in units of its edges.

    Points in a plane across an axis stay in one. They would not if the frame were turned too, to make a thin body thick.

    :raises QhullError: when the points are in a plane.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    extent = high - low
    if not (np.isfinite(extent).all() and (extent > 0.0).all()):
        raise QhullError("the points have no extent")
    scaled = np.ascontiguousarray((points - (low + high) / 2.0) / extent)
    centred = scaled - scaled.mean(axis=0)
    variances = np.linalg.eigvalsh(centred.T @ centred / len(points))
    if not variances[0] > _FLAT**2 * variances[2]:
        raise QhullError("the points are in a plane")
    return scaled


def _compute_faces(points: NDArray[np.float64]) -> NDArray[np.int64]:
    """Compute the faces (F, 3) of the hull of points (n, 3) in a box of edge 1, as numbers of points.

    :raises QhullError, ArithmeticError: see `ConvexHull`.
    """
    faces = _triangulate_hull(points, points)
    corners = _find_corners(points, faces)
    # Points in the middle of a side or of an edge are no vertices for Qhull, and some sizes are about the mean of the vertices.
    return faces if corners is None else corners[_triangulate_hull(points[corners], points)]


def _triangulate_hull(points: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.int64]:
    """Compute the faces (F, 3) of the hull of points (n, 3), outside which none of others (m, 3) is either.

    :raises QhullError, ArithmeticError: see `ConvexHull`.
    """
    from manifold3d import Manifold

    random = np.random.default_rng(0)
    order = np.arange(len(points))
    for _ in range(_ORDERS):
        ordered = np.ascontiguousarray(points[order])
        mesh = Manifold.hull_points(ordered).to_mesh64()
        triangles = np.asarray(mesh.tri_verts, dtype=np.int64)
        if len(triangles) < 4:
            raise QhullError("the points are in a plane")
        faces: NDArray[np.int64] = order[_find_rows(ordered, np.asarray(mesh.vert_properties)[:, :3])][triangles]
        if _measure_outside(others, _compute_planes(points, faces)) <= _OUTSIDE:
            return faces
        order = random.permutation(len(points))
    raise ArithmeticError("Manifold leaves points outside their convex hull")


def _find_corners(points: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.int64] | None:
    """Find the vertices at which faces of three directions meet; None if all are."""
    vertices, place = np.unique(faces, return_inverse=True)
    normals = _compute_planes(points, faces)[:, :3]
    spread = np.zeros((len(vertices), 3, 3))
    for column in place.reshape(faces.shape).T:
        np.add.at(spread, column, normals[:, :, None] * normals[:, None, :])
    is_corner = np.linalg.eigvalsh(spread)[:, 0] > _STRAIGHT
    return None if is_corner.all() or is_corner.sum() < 4 else vertices[is_corner]


def _compute_planes(points: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.float64]:
    """Compute the planes (F, 4) of faces; those of faces without area are zero, and nothing is outside them."""
    a, b, c = (points[column] for column in faces.T)
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    units = normals / np.where(lengths > 0.0, lengths, 1.0)[:, None]
    return np.column_stack((units, -np.einsum("ij,ij->i", units, a)))


def _measure_outside(points: NDArray[np.float64], planes: NDArray[np.float64]) -> float:
    """Measure how far the farthest of points (n, 3) is outside planes (F, 4)."""
    rows, across = max(1, _MOST_DISTANCES // len(planes)), np.ascontiguousarray(planes[:, :3].T)
    return max(
        float((points[start : start + rows] @ across + planes[:, 3]).max()) for start in range(0, len(points), rows)
    )


def _find_rows(points: NDArray[np.float64], wanted: NDArray[Any]) -> NDArray[np.int64]:
    """Return which of the points (n, 3) each of the ``wanted`` (k, 3) is, bit by bit."""
    keys = [np.ascontiguousarray(rows + 0.0).view("V24").ravel() for rows in (points, wanted)]
    place = {key.tobytes(): number for number, key in enumerate(keys[0])}
    return np.array([place[key.tobytes()] for key in keys[1]], dtype=np.int64)
