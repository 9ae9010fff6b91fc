"""How often closed surfaces wind around points: which points are inside."""

from __future__ import annotations

import numpy as np

from urdfcheck.facts.arrays import Array, Bools, Indices

# Pairs of a point and a triangle that are compared at once.
_MOST_PAIRS = 300_000


def compute_winding_numbers(triangles: Array, points: Array) -> Array:
    """Compute how many times closed surfaces of ``triangles`` (F, 3, 3) wind around each of some points (N, 3).

    The sum of their solid angles (van Oosterom and Strackee, *The solid angle of a plane triangle*, 1983) over that of a
    sphere.
    """
    step = max(1, _MOST_PAIRS // max(1, len(triangles)))
    windings = [_sum_solid_angles(triangles, points[i : i + step]) for i in range(0, len(points), step)]
    return np.concatenate(windings) / (4.0 * np.pi) if windings else np.zeros(0)


def has_body_against(triangles: Array, labels: Indices, volume: float) -> bool:
    """Whether one of several closed bodies faces inwards while all together, of this signed ``volume``, face outwards, or the
    other way round, and is not a hollow in them. ``labels``: the body of each of the ``triangles`` (F, 3, 3)."""
    against = np.bincount(labels, np.linalg.det(triangles)) * volume < 0.0
    solid = triangles[~against[labels]]
    firsts = [int(np.argmax(labels == k)) for k in np.flatnonzero(against)]
    return bool((np.abs(compute_winding_numbers(solid, triangles[firsts].mean(axis=1))) < 0.5).any())


def are_inside(triangles: Array, points: Array) -> Bools:
    """Return whether each point (N, 3) is inside a surface (F, 3, 3), whichever way its triangles face.

    A surface with small holes counts as closed.
    """
    corners = triangles.reshape(-1, 3)
    inside: Bools = ((points >= corners.min(axis=0)) & (points <= corners.max(axis=0))).all(axis=1)
    inside[inside] = np.abs(compute_winding_numbers(triangles, points[inside])) > 0.5
    return inside


def _sum_solid_angles(triangles: Array, points: Array) -> Array:
    """Return the sum (N,) of the solid angles of all triangles, seen from each point."""
    a, b, c = np.moveaxis(triangles[None] - points[:, None, None], 2, 0)
    la, lb, lc = (np.linalg.norm(side, axis=2) for side in (a, b, c))
    across = np.einsum("nfi,nfi->nf", a, np.cross(b, c))
    along = la * lb * lc + lc * (a * b).sum(axis=2) + lb * (a * c).sum(axis=2) + la * (b * c).sum(axis=2)
    angles: Array = 2.0 * np.arctan2(across, along).sum(axis=1)
    return angles
