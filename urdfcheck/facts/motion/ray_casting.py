"""Rays of a range sensor against shapes: how far from the sensor each ray meets one.

Of meshes only surfaces that face the sensor count, of primitives also the far side where a ray is collided from inside.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from urdfcheck.facts.arrays import Array, Indices

# Pairs of a ray and a triangle that are compared at once.
_MOST_PAIRS = 2_000_000
# A ray along an edge of two triangles meets one of them, and rounding must not let it pass between.
_EDGE = 1e-9


def make_scan_directions(azimuths: Array, elevations: Array) -> Array:
    """Make the unit vectors (E, A, 3) of a scan, x ahead and z up."""
    azimuth, elevation = np.meshgrid(azimuths, elevations)
    across = np.cos(elevation)
    return np.stack((across * np.cos(azimuth), across * np.sin(azimuth), np.sin(elevation)), axis=-1)


def cross_primitive(kind: str, size: Sequence[float], origin: Array, directions: Array) -> tuple[Array, Array]:
    """Return where rays enter and leave a convex primitive: distances (N,), negative ones behind ``origin``.

    A ray that misses it does not enter before it leaves. ``size`` as in `urdfcheck.model.parts.Shape`; ``origin`` (3,) and the
    unit ``directions`` (N, 3) in the frame of the shape.
    """
    if kind == "box":
        return _cross_slabs(origin, directions, np.array(size) / 2)
    if kind == "sphere":
        return _cross_round(origin, directions, size[0])
    radius, length = size
    flat = np.array((1.0, 1.0, 0.0))
    low, high = _cross_round(origin * flat, directions * flat, radius)
    slab = _cross_slabs(origin[2:], directions[:, 2:], np.array((length / 2,)))
    low, high = np.maximum(low, slab[0]), np.minimum(high, slab[1])
    if kind == "capsule":
        centres = [origin - (0, 0, side * length / 2) for side in (-1, 1)]
        parts = [(low, high), *(_cross_round(centre, directions, radius) for centre in centres)]
        low = np.min([np.where(enters < leaves, enters, np.inf) for enters, leaves in parts], axis=0)
        high = np.max([np.where(enters < leaves, leaves, -np.inf) for enters, leaves in parts], axis=0)
    return low, high


def _cross_slabs(origin: Array, directions: Array, half: Array) -> tuple[Array, Array]:
    """Return where rays enter and leave the common part of slabs about the axes, half as thick as ``half``."""
    with np.errstate(divide="ignore", invalid="ignore"):
        one, other = (-half - origin) / directions, (half - origin) / directions
    # A ray along a slab is inside it all the way, or never.
    along = directions == 0
    within = np.abs(origin) < half
    low = np.where(along, np.where(within, -np.inf, np.inf), np.minimum(one, other))
    high = np.where(along, np.where(within, np.inf, -np.inf), np.maximum(one, other))
    return low.max(axis=1), high.min(axis=1)


def _cross_round(origin: Array, directions: Array, radius: float) -> tuple[Array, Array]:
    """Return where rays enter and leave a sphere about 0, or a cylinder where the third coordinates are 0."""
    a = (directions**2).sum(axis=1)
    b, c = directions @ origin, float(origin @ origin) - radius**2
    root = b**2 - a * c
    with np.errstate(divide="ignore", invalid="ignore"):
        low, high = (-b - np.sqrt(root)) / a, (-b + np.sqrt(root)) / a
    misses, along = root <= 0, a < 1e-18  # along the axis of the cylinder
    low = np.where(along, -np.inf if c < 0 else np.inf, np.where(misses, np.inf, low))
    return low, np.where(along, np.inf if c < 0 else -np.inf, np.where(misses, -np.inf, high))


def measure_mesh_entries(vertices: Array, faces: Indices, azimuths: Array, elevations: Array, least: float) -> Array:
    """Measure where the rays of a scan from 0 meet triangles that face them: distances (E, A), inf for none.

    ``vertices`` (V, 3) in the frame of the sensor; ``azimuths`` (A,) and ``elevations`` (E,) ascending, in rad; nearer
    than ``least`` nothing counts.
    """
    directions = make_scan_directions(azimuths, elevations)
    found = np.full(directions.shape[:2], np.inf)
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    offsets = np.einsum("ij,ij->i", normals, corners[:, 0])
    facing = offsets < 0  # the sensor is before the plane
    corners, normals, offsets = corners[facing], normals[facing], offsets[facing]
    for triangle, e, a in _iter_candidates(corners, azimuths, elevations):
        ray = directions[e, a]
        slope = np.einsum("ij,ij->i", normals[triangle], ray)
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = offsets[triangle] / slope
        points = ray * distance[:, None]
        hit = (slope < 0) & (distance >= least) & np.isfinite(distance)
        for i in range(3):
            start, end = corners[triangle, i], corners[triangle, (i + 1) % 3]
            side = np.einsum("ij,ij->i", np.cross(end - start, points - start), normals[triangle])
            hit &= side >= -_EDGE * np.einsum("ij,ij->i", normals[triangle], normals[triangle])
        np.minimum.at(found, (e[hit], a[hit]), distance[hit])
    return found


def _iter_candidates(corners: Array, azimuths: Array, elevations: Array) -> Iterator[tuple[Indices, Indices, Indices]]:
    """Yield triangles with the rays that may meet them: indices of triangles, elevations and azimuths.

    Seen from the sensor, a triangle is inside the cone about its middle that holds its corners.
    """
    lengths = np.linalg.norm(corners, axis=2, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        seen = corners / lengths
        middle = seen.sum(axis=1)
        middle /= np.linalg.norm(middle, axis=1, keepdims=True)
    cone = np.arccos(np.clip(np.einsum("ijk,ik->ij", seen, middle).min(axis=1), -1, 1)) + 1e-9
    up, around = np.arcsin(np.clip(middle[:, 2], -1, 1)), np.arctan2(middle[:, 1], middle[:, 0])
    is_near_pole = ~(np.abs(up) + cone < np.pi / 2)  # also where the middle is not a number
    with np.errstate(invalid="ignore"):
        width = np.where(is_near_pole, np.pi, np.arcsin(np.clip(np.sin(cone) / np.cos(up), -1, 1)))
    low = np.searchsorted(elevations, np.where(is_near_pole, -np.inf, up - cone))
    high = np.searchsorted(elevations, np.where(is_near_pole, np.inf, up + cone), side="right")
    around = np.where(np.isfinite(around), around, 0.0)
    for turn in (-2 * np.pi, 0.0, 2 * np.pi):  # azimuths need not be within one turn about 0
        first = np.searchsorted(azimuths, around + turn - width)
        last = np.searchsorted(azimuths, around + turn + width, side="right")
        counts = (high - low) * (last - first)
        chosen = counts.nonzero()[0]
        for part in _split_by_size(chosen, counts):
            yield _list_pairs(part, low, high, first, last)


def _split_by_size(chosen: Indices, counts: Indices) -> Iterator[Indices]:
    """Split triangles so that each part has about as many pairs as are compared at once."""
    totals = np.cumsum(counts[chosen])
    edges = np.searchsorted(
        totals, np.arange(1, 1 + (int(totals[-1]) if len(totals) else 0) // _MOST_PAIRS) * _MOST_PAIRS
    )
    yield from (part for part in np.split(chosen, np.unique(edges)) if len(part))


def _list_pairs(
    part: Indices, low: Indices, high: Indices, first: Indices, last: Indices
) -> tuple[Indices, Indices, Indices]:
    rows, columns = (high - low)[part], (last - first)[part]
    triangle = np.repeat(part, rows * columns)
    ends = np.cumsum(rows * columns)
    index = np.arange(len(triangle)) - np.repeat(ends - rows * columns, rows * columns)
    across = np.repeat(columns, rows * columns)
    return triangle, low[triangle] + index // across, first[triangle] + index % across
