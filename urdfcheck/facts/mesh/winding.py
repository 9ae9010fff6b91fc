"""How often closed surfaces wind around points: which points are inside."""

from __future__ import annotations

import numpy as np

from urdfcheck.facts.arrays import Array, Bools, Indices
from urdfcheck.facts.mesh.topology import compute_bounds

# Pairs of a point and a triangle that are compared at once.
_MOST_PAIRS = 100_000
# How far points of a body's surface are moved towards its middle: a hollow may reach the surface of what is around it.
_INWARDS = 1e-3


def compute_winding_numbers(triangles: Array, points: Array) -> Array:
    """Compute how many times closed surfaces of ``triangles`` (F, 3, 3) wind around each of some points (N, 3).

    The sum of their solid angles (van Oosterom and Strackee, *The solid angle of a plane triangle*, 1983) over that of a
    sphere. Of corners a, b and c, seen from a point, the triple product is linear in the point, and the product of two follows
    from the distances to the corners and the length of the edge: matrix products, in place of vectors from each point to each
    corner.
    """
    if not len(triangles) or not len(points):
        return np.zeros(len(points))
    centre = triangles.reshape(-1, 3).mean(axis=0)  # near the origin, little is lost in differences of squares
    points, corners = points - centre, np.moveaxis(triangles - centre, 1, 0)
    a, b, c = corners
    across_ab = np.cross(a, b)
    normals, volumes = across_ab + np.cross(b, c) + np.cross(c, a), _multiply_rows(across_ab, c)
    ab2, bc2, ca2 = (_multiply_rows(edge, edge) for edge in (a - b, b - c, c - a))
    windings = []
    step = max(1, _MOST_PAIRS // len(triangles))
    for seen_from in (points[i : i + step] for i in range(0, len(points), step)):
        squares = _multiply_rows(seen_from, seen_from)[:, None]
        a2, b2, c2 = (
            np.maximum(squares - 2.0 * (seen_from @ corner.T) + _multiply_rows(corner, corner), 0.0)
            for corner in corners
        )
        la, lb, lc = np.sqrt(a2), np.sqrt(b2), np.sqrt(c2)
        products = (a2 + b2 - ab2) * lc + (b2 + c2 - bc2) * la + (c2 + a2 - ca2) * lb
        angles = np.arctan2(volumes - seen_from @ normals.T, la * lb * lc + 0.5 * products)
        windings.append(angles.sum(axis=1) / (2.0 * np.pi))
    return np.concatenate(windings)


def has_body_against(triangles: Array, labels: Indices, volume: float) -> bool:
    """Whether one of several closed bodies faces inwards while all together, of this signed ``volume``, face outwards, or the
    other way round, and is not a hollow in them. ``labels``: the body of each of the ``triangles`` (F, 3, 3)."""
    against = np.bincount(labels, np.linalg.det(triangles)) * volume < 0.0
    solid, points = triangles[~against[labels]], []
    for body in (triangles[labels == k].mean(axis=1) for k in np.flatnonzero(against)):
        # The outermost triangles: a collar begins inside what it surrounds, and sticks out of it.
        outer = body[np.concatenate((body.argmin(axis=0), body.argmax(axis=0)))]
        points.append(outer + _INWARDS * (body.mean(axis=0) - outer))
    return bool(points) and bool((np.abs(compute_winding_numbers(solid, np.concatenate(points))) < 0.5).any())


def are_inside(triangles: Array, points: Array) -> Bools:
    """Return whether each point (N, 3) is inside a surface (F, 3, 3), whichever way its triangles face.

    A surface with small holes counts as closed.
    """
    low, high = compute_bounds(triangles.reshape(-1, 3))
    inside: Bools = ((points >= low) & (points <= high)).all(axis=1)
    inside[inside] = np.abs(compute_winding_numbers(triangles, points[inside])) > 0.5
    return inside


def _multiply_rows(one: Array, other: Array) -> Array:
    """Return the scalar products (N,) of the rows of two arrays (N, 3)."""
    products: Array = np.einsum("ni,ni->n", one, other)
    return products
