"""Triangles as a surface: merged corners, edges, and the boundaries of what is open."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Indices = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Boundary:
    """A run of edges that belong to one triangle only: the rim of a hole when ``closed``.

    ``points`` (k, 3), the first not repeated at the end of a closed one; ``length``; ``centre`` (3,) of the line.
    """

    points: Array
    closed: bool
    length: float
    centre: Array


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Triangles ``faces`` (F, 3) over ``vertices`` (V, 3), and how many were dropped for a repeated corner
    (``degenerate``) or for having the corners of an earlier one (``duplicate``)."""

    vertices: Array
    faces: Indices
    degenerate: int
    duplicate: int


@dataclass(frozen=True, slots=True, eq=False)
class Edges:
    """How faces meet; see `urdfcheck.facts.mesh.MeshFacts`. ``open`` (n, 2): the vertices of each edge that belongs to
    one face, in the direction in which that face runs along it."""

    open: Indices
    non_manifold: int
    watertight: bool
    winding_consistent: bool
    closed: bool


def _unique_rows(rows: NDArray[np.generic]) -> tuple[Indices, Indices]:
    """Index of the first of each group of equal rows, and the group of each row. Sorting columns beats np.unique."""
    order = np.lexsort(rows.T)
    ranked = rows[order]
    starts = np.concatenate(((True,), (ranked[1:] != ranked[:-1]).any(axis=1)))
    group = np.empty(len(rows), dtype=np.int64)
    group[order] = np.cumsum(starts) - 1
    return order[starts], group


def weld_exact(vertices: Array, faces: Indices) -> Surface:
    """Merge equal corners; vertices that no face uses are left out."""
    used, corners = np.unique(faces, return_inverse=True)
    points = vertices[used]
    first, group = _unique_rows(points)
    return without_repeats(points[first], group[corners.reshape(-1, 3)])


def weld_near(surface: Surface, distance: float) -> Surface:
    """Merge corners that lie within ``distance``, or in one cell of twice that size.

    Two points within half a cell of each other along every axis share a cell in one of eight grids, each shifted by
    half a cell along some of the axes: no pair is missed because a cell's border runs between its points.
    """
    points = surface.vertices - surface.vertices.min(axis=0)
    label = np.arange(len(points))
    changed = distance > 0.0
    while changed:
        before = label
        for shift in product((0.0, 0.5), repeat=3):
            _, cell = _unique_rows(np.floor(points / (2.0 * distance) + np.array(shift)))
            lowest = np.full(len(points), len(points))
            np.minimum.at(lowest, cell, label)
            label = lowest[cell]
        changed = bool((label != before).any())
    again = without_repeats(surface.vertices, label[surface.faces])
    return Surface(
        again.vertices, again.faces, surface.degenerate + again.degenerate, surface.duplicate + again.duplicate
    )


def without_repeats(vertices: Array, faces: Indices) -> Surface:
    """Drop faces with a repeated corner and all but the first of faces with the same corners."""
    a, b, c = faces.T
    proper = faces[(a != b) & (b != c) & (c != a)]
    first, _ = _unique_rows(np.sort(proper, axis=1)) if len(proper) else (np.empty(0, dtype=np.int64), None)
    kept = proper[np.sort(first)]
    used, compact = np.unique(kept, return_inverse=True)
    return Surface(vertices[used], compact.reshape(-1, 3), len(faces) - len(proper), len(proper) - len(kept))


def edges_of(faces: Indices) -> Edges:
    """How the faces (F, 3), at least one, meet."""
    directed = faces[:, ((0, 1), (1, 2), (2, 0))].reshape(-1, 2)
    low, high = directed.min(axis=1), directed.max(axis=1)
    _, index, inverse, count = np.unique(
        low * (int(high.max()) + 1) + high, return_index=True, return_inverse=True, return_counts=True
    )
    balance = np.bincount(inverse, weights=np.where(directed[:, 0] == low, 1.0, -1.0))
    return Edges(
        open=directed[index[count == 1]],
        non_manifold=int((count > 2).sum()),
        watertight=bool((count == 2).all()),
        winding_consistent=not balance[count == 2].any(),
        closed=not balance.any(),
    )


def boundaries_of(vertices: Array, open_edges: Indices) -> tuple[Boundary, ...]:
    """The boundaries (longest first) that the edges (n, 2) of one face form."""
    found = [_boundary(vertices, path, closed) for path, closed in _paths(open_edges.tolist())]
    return tuple(sorted(found, key=lambda boundary: (-boundary.length, boundary.centre.tolist())))


def _paths(open_edges: list[list[int]]) -> Iterator[tuple[list[int], bool]]:
    """Split a graph's edges into simple loops, and paths where odd vertices leave none.

    A walk that comes back to a vertex it has passed gives off the loop in between, so that holes which touch in one
    vertex come out apart.
    """
    neighbours: dict[int, set[int]] = {}
    for a, b in open_edges:
        neighbours.setdefault(a, set()).add(b)
        neighbours.setdefault(b, set()).add(a)
    # Paths end at odd vertices: starting there leaves loops only for the rest.
    for start in sorted(neighbours, key=lambda vertex: (len(neighbours[vertex]) % 2 == 0, vertex)):
        while neighbours[start]:
            path, place = [start], {start: 0}
            while following := neighbours[path[-1]]:
                here, there = path[-1], min(following)
                following.discard(there)
                neighbours[there].discard(here)
                if there in place:
                    loop = path[place[there] :]
                    yield loop, True
                    for vertex in loop[1:]:
                        del place[vertex]
                    del path[place[there] + 1 :]
                else:
                    place[there] = len(path)
                    path.append(there)
            if len(path) > 1:
                yield path, False


def _boundary(vertices: Array, path: list[int], closed: bool) -> Boundary:
    points = vertices[path]
    following = np.roll(points, -1, axis=0) if closed else points[1:]
    starts = points if closed else points[:-1]
    lengths = np.linalg.norm(following - starts, axis=1)
    length = float(lengths.sum())
    centre = lengths @ (starts + following) / 2.0 / length
    points.setflags(write=False)
    centre.setflags(write=False)
    return Boundary(points, closed, length, centre)
