"""Cylinders in the surface of a mesh: bores, hubs and rims, and the lines that they are round about.

A cylinder is stored as a strip of flat facets. Two facets that share an edge along the cylinder, are equally wide and meet at a
small angle have one axis: the line at the radius behind both. Each such edge is a vote for a line.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.median import compute_median, compute_medians

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Bools, Indices, Mat4, Vec3

# Angles (rad) at which two facets of a cylinder meet: 240 facets to eight.
_FLATTEST, _SHARPEST = math.radians(1.5), math.radians(46.0)
# Two facets belong to one cylinder if their widths and centres agree to this share.
_EQUAL = 0.02
# Radii (m) of what may be a bearing, a bore or a rim.
_LEAST_RADIUS, _LARGEST_RADIUS = 1e-3, 0.5
# Sectors of a turn in which a ring is counted.
_SECTORS = 48
# A ring has so many edges at least, and covers so much of a turn.
_LEAST_EDGES, _LEAST_COVERAGE = 4, 0.25
# Two directions are parallel within this angle (rad), and a line passes through a point within this distance (m) and share of the
# ring's radius: typed digits and single precision.
_PARALLEL, _NEAR, _NEAR_SHARE = 0.01, 1e-3, 0.02
# Lines of one surface that are compared, those with the most edges first.
_MOST_LINES = 30


@dataclass(frozen=True, slots=True)
class Ring:
    """A cylinder about a known line: its ``radius`` (m), and the share of a turn that it covers."""

    radius: float
    coverage: float


@dataclass(frozen=True, slots=True, eq=False)
class RoundLine:
    """A line that parts of a surface are round about."""

    point: Vec3
    """Of the line, the nearest to the point of which it was asked (m)."""
    direction: Vec3
    """Unit vector; its sign means nothing."""
    rings: tuple[Ring, ...]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class RoundStrips:
    """The edges (n) between facets of cylinders."""

    directions: Array
    """(n, 3), unit vectors along the edges, and so along the cylinders' axes."""
    centres: Array
    """(n, 3), a point of each axis (m)."""
    radii: Array
    """(n,), m."""
    normals: Array
    """(n, 3), unit normals of the surface at the edges."""
    angles: Array
    """(n,), between the two facets (rad): what the edge covers of a turn."""

    def place(self, pose: Mat4) -> RoundStrips:
        """Return the strips of the surface at a pose (4, 4)."""
        turn = pose[:3, :3]
        return RoundStrips(
            directions=self.directions @ turn.T,
            centres=self.centres @ turn.T + pose[:3, 3],
            radii=self.radii,
            normals=self.normals @ turn.T,
            angles=self.angles,
        )

    def list_rings_about(self, point: Array, axis: Array) -> tuple[Ring, ...]:
        """List the rings about a line through a point (3,) along a unit axis (3,)."""
        inside = self._mask_parallel(axis)
        off = np.linalg.norm(_remove_along(self.centres - point, axis), axis=1)
        return self._list_rings(inside & (off < _NEAR + _NEAR_SHARE * self.radii), axis)

    def list_parallel_lines(self, point: Array, axis: Array, reach: float) -> tuple[RoundLine, ...]:
        """List the lines with rings that are parallel to a unit axis (3,) and within ``reach`` (m) of a point (3,)."""
        offsets = _remove_along(self.centres - point, axis)
        chosen = np.flatnonzero(self._mask_parallel(axis) & (np.linalg.norm(offsets, axis=1) < reach))
        lines = []
        for members in _iter_clusters(offsets[chosen], _NEAR):
            rings = self._list_rings(chosen[members], axis)
            if rings:
                lines.append(RoundLine(point + compute_medians(offsets[chosen[members]]), axis, rings))
        return tuple(lines)

    def list_lines_through(self, point: Array) -> tuple[RoundLine, ...]:
        """List the lines with rings through a point (3,)."""
        away = self.centres - point
        along = np.einsum("ij,ij->i", away, self.directions)
        off = np.linalg.norm(away - along[:, None] * self.directions, axis=1)
        chosen = np.flatnonzero(off < _NEAR + _NEAR_SHARE * self.radii)
        ways = self.directions[chosen]
        ways = ways * np.sign(np.take_along_axis(ways, np.abs(ways).argmax(axis=1, keepdims=True), axis=1))
        lines = []
        for members in _iter_clusters(ways, _PARALLEL):
            mean = compute_medians(ways[members])
            direction = mean / np.linalg.norm(mean)
            rings = self._list_rings(chosen[members], direction)
            if rings:
                lines.append(RoundLine(point, direction, rings))
        return tuple(lines)

    def _mask_parallel(self, axis: Array) -> Bools:
        parallel: Bools = np.linalg.norm(np.cross(self.directions, axis), axis=1) < _PARALLEL
        return parallel

    def _list_rings(self, chosen: Bools | Indices, axis: Array) -> tuple[Ring, ...]:
        """List the rings that some edges make about their common axis, by radius."""
        radii, normals, angles = self.radii[chosen], self.normals[chosen], self.angles[chosen]
        if len(radii) < _LEAST_EDGES:
            return ()
        across = np.cross(axis, np.eye(3)[int(np.abs(axis).argmin())])
        across /= np.linalg.norm(across)
        at = np.arctan2(normals @ np.cross(axis, across), normals @ across)
        first, last = (np.floor((at + side * angles / 2) / math.tau * _SECTORS).astype(np.int64) for side in (-1, 1))
        order = np.argsort(radii, kind="stable")
        group = np.cumsum(np.concatenate(([False], np.diff(radii[order]) > _EQUAL * radii[order][1:])))
        rings = []
        for number in range(int(group[-1]) + 1):
            members = order[group == number]
            if len(members) < _LEAST_EDGES:
                continue
            covered = np.zeros(_SECTORS, dtype=bool)
            for step in range(int((last[members] - first[members]).max()) + 1):
                sectors = first[members] + step
                covered[sectors[sectors <= last[members]] % _SECTORS] = True
            if covered.mean() >= _LEAST_COVERAGE:
                rings.append(Ring(compute_median(radii[members]), float(covered.mean())))
        return tuple(rings)


def find_round_strips(vertices: Array, faces: Indices) -> RoundStrips:
    """Find the cylinders in a mesh of ``vertices`` (V, 3) in m and ``faces`` (F, 3)."""
    corners = vertices[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(normals, axis=1)
    faces, normals = faces[areas > 0], normals[areas > 0] / areas[areas > 0, None]
    one, other, start, end = _pair_edges(faces, len(vertices))
    cosines = np.einsum("ij,ij->i", normals[one // 3], normals[other // 3])
    bent = (cosines < math.cos(_FLATTEST)) & (cosines > math.cos(_SHARPEST))
    one, other, start, end, cosines = one[bent], other[bent], start[bent], end[bent], cosines[bent]
    along = vertices[end] - vertices[start]
    along /= np.linalg.norm(along, axis=1)[:, None]
    first, second = normals[one // 3], normals[other // 3]
    # Seen along the edge, each facet is a line from it to the facet's third corner.
    middles, widths = [], []
    for edge in (one, other):
        apex = faces[edge // 3, (edge + 2) % 3]
        way = _remove_along(vertices[apex] - vertices[start], along)
        middles.append(way / 2)
        widths.append(np.linalg.norm(way, axis=1))
    between = first - second
    radii = np.einsum("ij,ij->i", middles[0] - middles[1], between) / np.einsum("ij,ij->i", between, between)
    centres = middles[0] - radii[:, None] * first, middles[1] - radii[:, None] * second
    size = np.abs(radii)
    good = np.abs(widths[0] - widths[1]) < _EQUAL * np.maximum(*widths)
    good &= np.linalg.norm(centres[0] - centres[1], axis=1) < _EQUAL * size
    good &= (size > _LEAST_RADIUS) & (size < _LARGEST_RADIUS)
    outward = first + second
    return RoundStrips(
        directions=along[good],
        centres=vertices[start[good]] + (centres[0] + centres[1])[good] / 2,
        radii=size[good],
        normals=outward[good] / np.linalg.norm(outward[good], axis=1)[:, None],
        angles=np.arccos(np.clip(cosines[good], -1.0, 1.0)),
    )


def join_strips(parts: Sequence[RoundStrips]) -> RoundStrips:
    """Join the strips of several surfaces, one at least."""
    names = ("directions", "centres", "radii", "normals", "angles")
    return RoundStrips(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in names})


def _pair_edges(faces: Indices, count: int) -> tuple[Indices, Indices, Indices, Indices]:
    """Pair the edges that two faces share: edges ``3 * face + k`` (E,) of one and the other, and their two ends (E,)."""
    starts, ends = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    low, high = np.minimum(starts, ends), np.maximum(starts, ends)
    edges = low * count + high
    order = np.argsort(edges, kind="stable")
    key = edges[order]
    same = np.flatnonzero(key[1:] == key[:-1])
    one, other = order[same], order[same + 1]
    return one, other, low[one], high[one]


def _remove_along(vectors: Array, axis: Array) -> Array:
    """Return the parts of vectors (n, 3) across a unit axis (3,), or across one for each (n, 3)."""
    along = np.einsum("ij,ij->i", vectors, np.broadcast_to(axis, vectors.shape))
    across: Array = vectors - along[:, None] * axis
    return across


def _iter_clusters(points: Array, width: float) -> Iterator[Indices]:
    """Yield the indices of points (n, 3) that are near each other, by cells of this width; the largest clusters first."""
    if len(points) < _LEAST_EDGES:
        return
    cells, member, counts = np.unique(
        np.round(points / width).astype(np.int64), axis=0, return_inverse=True, return_counts=True
    )
    member = member.ravel()
    used = np.zeros(len(cells), dtype=bool)
    for index in np.argsort(-counts, kind="stable")[:_MOST_LINES]:
        if not used[index]:
            near = np.abs(cells - cells[index]).max(axis=1) <= 1
            used |= near
            yield np.flatnonzero(near[member])
