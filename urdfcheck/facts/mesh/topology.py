"""Triangles as a surface: merged corners, edges, and boundaries.

Corners, faces and the edges of open surfaces are grouped by vectorised hashing: every item writes its index into a slot of a
table and reads back which item was first; those that find an unequal one try another table. That takes a few passes over memory,
where sorting indices takes twenty. The edges of a closed surface need no indices: they are sorted as plain numbers, in less time.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial, reduce
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core.records import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from urdfcheck.facts.arrays import Array, Bools, Indices, Vec3


# Odd multipliers without structure: digits of the golden ratio, of pi and of e.
_MIX = tuple(np.uint64(factor) for factor in (0x9E3779B97F4A7C15, 0x243F6A8885A308D3, 0xB7E151628AED2A6B))
# Tables that are tried before the rest is sorted. Usually nothing is left after three or four.
_ROUNDS = 8
# Grids that are half a cell apart.
_SHIFTS = tuple(np.array(shift) for shift in product((0.0, 0.5), repeat=3))
# Rims of more points are holes, whatever their shape.
_MOST_RIM_POINTS = 500
# Items processed at a time: their temporaries stay in the processor's cache.
_CHUNK = 16384
# Of each of three corners in a number of 64 bits: enough for four million triangles.
_CORNER_BITS = 21


@dataclass(frozen=True, slots=True, eq=False)
class Boundary:
    """A run of edges that belong to one triangle only."""

    points: Array
    """(k, 3); the first is not repeated at the end of a closed one."""
    closed: bool
    """Whether it is the rim of a hole."""
    length: float
    centre: Vec3
    """Of the line."""


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Triangles over vertices, all of which are used."""

    vertices: NDArray[np.floating]
    """(V, 3), float32 or float64."""
    faces: Indices
    """(F, 3)"""
    collapsed: int = 0
    """Number of triangles that were dropped for a repeated corner."""
    repeated: int = 0
    """Number of triangles that were dropped for having the corners of an earlier one."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Edges:
    """How faces meet."""

    open: Indices
    """(n, 2), vertices of each edge that belongs to one face, in the direction of that face."""
    non_manifold: Indices
    """(n, 2), vertices of edges of three or more faces."""
    flipped: Indices
    """(n, 2), vertices of edges along which both faces have the same direction."""
    watertight: bool
    """See `urdfcheck.facts.mesh.measure.MeshFacts`."""
    winding_consistent: bool
    """See `urdfcheck.facts.mesh.measure.MeshFacts`."""
    closed: bool
    """See `urdfcheck.facts.mesh.measure.MeshFacts`."""
    distinct_faces: bool = False
    """Whether it is known that no two faces have the same corners."""


def compute_bounds(points: NDArray[np.floating]) -> Array:
    """Compute the lowest and highest coordinates (2, 3), by columns: numpy takes twenty times as long for the whole array."""
    return np.array([[float(column.min()) for column in points.T], [float(column.max()) for column in points.T]])


def weld_exact(points: NDArray[Any], faces: Indices | None) -> Surface:
    """Merge equal ``points`` (n, 3), float32 or float64; without ``faces`` each three in turn are a triangle.

    Vertices stay in the order in which they first occur; those that no face uses are dropped.
    """
    if faces is not None:
        points, faces = _drop_unused_points(points, faces)
    # A corner of a closed mesh is stored about six times, where each triangle stores its own.
    first = _find_first_equal_rows(points, len(points) // 4 if faces is None else 4 * len(points))
    indices = np.arange(len(first), dtype=first.dtype)
    firsts = np.flatnonzero(first == indices)
    number = indices  # its memory: of the others it is not read
    number[firsts] = np.arange(len(firsts), dtype=first.dtype)
    for chunk in _iter_chunks(len(first)):
        first[chunk] = np.take(number, first[chunk])
    corners = first.reshape(-1, 3) if faces is None else np.take(first, faces)
    return drop_collapsed_faces(Surface(np.take(points, firsts, axis=0) + points.dtype.type(0), corners))  # -0 is 0


def _find_first_equal_rows(rows: NDArray[Any], slots: int) -> Indices:
    """Find the index of the first row that equals each row of ``rows`` (n, 3), any numbers of 4 or 8 bytes.

    Rows are distinguished by a hash; if two unequal rows share it, all are sorted instead. ``slots``: about the table's size.
    """
    keys = _hash_rows(rows)
    bits = max(4, slots.bit_length())
    first = _find_first_equal_keys(keys, partial(_take_high_bits, bits=bits), 1 << bits)
    are_equal = (np.array_equal(np.take(rows, first[chunk], axis=0), rows[chunk]) for chunk in _iter_chunks(len(rows)))
    return first if all(are_equal) else _find_equal_rows_by_sorting(rows)


def _iter_chunks(count: int) -> Iterator[slice]:
    """Yield slices of ``count`` items, few at a time."""
    return (slice(start, min(start + _CHUNK, count)) for start in range(0, count, _CHUNK))


def _get_index_type(count: int) -> Any:
    return np.int32 if count < 2**31 else np.int64  # half the memory


def _hash_rows(rows: NDArray[Any]) -> NDArray[np.uint64]:
    keys = np.empty(len(rows), dtype=np.uint64)
    for part in _iter_chunks(len(rows)):
        # -0 is 0
        chunk = np.add(rows[part], 0, dtype=rows.dtype, order="C").view(np.uint32 if rows.itemsize == 4 else np.uint64)
        key = keys[part]
        if chunk.itemsize == 8:  # a product keeps the low bits of its factors, and round numbers have theirs high up
            chunk = chunk ^ (chunk >> np.uint64(32))
        np.multiply(chunk[:, 0], _MIX[0], out=key)
        key += chunk[:, 1] * _MIX[1]
        key += chunk[:, 2] * _MIX[2]
        key ^= key >> np.uint64(32)
        key *= _MIX[0]
    return keys


def _take_high_bits(keys: NDArray[np.uint64], bits: int) -> Indices:
    """Return the slots of hashes in a table of ``2 ** bits``."""
    slots: Indices = (keys >> np.uint64(64 - bits)).view(np.int64)
    return slots


def _find_first_equal_keys(
    keys: NDArray[np.uint64], find_slots: Callable[[NDArray[np.uint64]], Indices], size: int
) -> Indices:
    """Find the index of the first of ``keys`` (n,) that equals each one. ``find_slots`` returns a slot below ``size`` for each of
    some keys, one for equal keys."""
    first = _find_first_in_slots(keys, find_slots, size)
    left = _find_other_keys(keys, first)
    rest = np.take(keys, left)
    del keys  # where the caller has not kept them, what comes next takes no more than they did
    for turn in range(_ROUNDS):
        if not len(left):
            return first
        bits = (2 * len(left)).bit_length()
        same = _find_first_in_slots(rest, partial(_mix_to_slots, bits=bits, turn=turn), 1 << bits)
        first[left] = np.take(left, same)
        are_others = np.take(rest, same) != rest
        left, rest = left[are_others], rest[are_others]
    _, where, group = np.unique(rest, return_index=True, return_inverse=True)
    first[left] = left[where[group]]
    return first


def _find_other_keys(keys: NDArray[np.uint64], first: Indices) -> Indices:
    """Find the indices of those that differ from the one that was found for them."""
    kind, chunks = _get_index_type(len(keys)), _iter_chunks(len(keys))
    return np.concatenate([(c.start + np.flatnonzero(np.take(keys, first[c]) != keys[c])).astype(kind) for c in chunks])


def _mix_to_slots(keys: NDArray[np.uint64], bits: int, turn: int) -> Indices:
    """Return other slots of hashes in a table of ``2 ** bits`` at each turn."""
    return _take_high_bits(keys * _MIX[turn % 3], bits)


def _find_first_in_slots(
    keys: NDArray[np.uint64], find_slots: Callable[[NDArray[np.uint64]], Indices], size: int
) -> Indices:
    """Find the lowest index of a key that has the same slot as each one."""
    kind = _get_index_type(len(keys))
    table, first = np.empty(size, dtype=kind), np.empty(len(keys), dtype=kind)
    for chunk in reversed([*_iter_chunks(len(keys))]):
        indices = np.arange(chunk.start, chunk.stop, dtype=kind)
        table[find_slots(keys[chunk])[::-1]] = indices[::-1]  # the last to write, which is the first in order, stays
    for chunk in _iter_chunks(len(keys)):
        first[chunk] = np.take(table, find_slots(keys[chunk]))
    return first


def _find_equal_rows_by_sorting(rows: NDArray[Any]) -> Indices:
    order = np.lexsort(rows.T)
    ranked = rows[order]
    starts = np.flatnonzero(np.concatenate(((True,), (ranked[1:] != ranked[:-1]).any(axis=1))))
    first = np.empty(len(rows), dtype=np.int64)
    first[order] = np.repeat(order[starts], np.diff(starts, append=len(rows)))
    return first


def _drop_unused_points(points: NDArray[Any], faces: Indices) -> tuple[NDArray[Any], Indices]:
    """Drop the points that no face uses."""
    used = np.zeros(len(points), dtype=bool)
    used[faces] = True
    if used.all():
        return points, faces
    return points[used], (np.cumsum(used) - 1)[faces]


def drop_collapsed_faces(surface: Surface) -> Surface:
    """Drop the faces that have a repeated corner."""
    a, b, c = surface.faces.T
    collapsed = (a == b) | (b == c) | (c == a)
    count = int(collapsed.sum())
    if not count:
        return surface
    vertices, faces = _drop_unused_points(surface.vertices, surface.faces[~collapsed])
    return Surface(vertices, faces, collapsed=surface.collapsed + count, repeated=surface.repeated)


def drop_repeated_faces(surface: Surface) -> Surface:
    """Drop the faces that have the corners of an earlier one, in either order, except those of fins (`find_fin_faces`)."""
    again = find_repeated_faces(surface.faces)
    if again.any():
        again &= ~find_fin_faces(surface.faces, len(surface.vertices))
    if not again.any():
        return surface
    count = surface.repeated + int(again.sum())
    return Surface(surface.vertices, surface.faces[~again], collapsed=surface.collapsed, repeated=count)


def find_fin_faces(faces: Indices, n_vertices: int) -> Bools:
    """Return which of the faces (F, 3) belong to a fin: a sheet, both of whose sides are stored, that stands on a surface.

    Its two sides cancel each other: with both, the surface is as closed as without any, and with one it is open. A fin is a
    group of such pairs that hang together, and of whose edges at least one has further faces, each as many in either direction.
    A sheet that stands on nothing is none, and neither are two sides of which a third face needs just one to be closed.
    """
    group = _find_first_equal_rows(np.sort(faces, axis=1), 4 * len(faces))
    count = np.bincount(group, minlength=len(faces))[group]
    # Three corners have one cyclic order or the other.
    turned = np.take_along_axis(faces, (faces.argmin(axis=1)[:, None] + np.arange(3)) % 3, axis=1)
    sign = np.where(turned[:, 1] < turned[:, 2], 1, -1)
    paired = (count == 2) & (np.bincount(group, weights=sign, minlength=len(faces))[group] == 0)
    if not paired.any() or paired.all():
        return np.zeros(len(faces), dtype=bool)
    keys, backward = _build_half_edges(faces), _find_backward_half_edges(faces)
    of_pair = np.tile(paired, 3)
    edges, inverse = np.unique(keys, return_inverse=True)
    direction = np.where(of_pair, 0.0, np.where(backward, -1.0, 1.0))
    uneven = np.bincount(inverse, weights=direction, minlength=len(edges)) != 0
    stands = np.bincount(inverse, weights=np.where(of_pair, 0.0, 1.0), minlength=len(edges)) > 0
    piece = label_components(faces[paired], n_vertices)
    corner = np.tile(piece, 3)  # of each half edge of a pair, in the order of `keys`
    mine = inverse[of_pair]
    pieces = int(piece.max()) + 1
    good = (np.bincount(corner, weights=uneven[mine], minlength=pieces) == 0) & (
        np.bincount(corner, weights=stands[mine], minlength=pieces) > 0
    )
    fins = np.zeros(len(faces), dtype=bool)
    fins[paired] = good[piece]
    return fins


def find_repeated_faces(faces: Indices) -> Bools:
    """Return which of the faces (F, 3) have the corners of an earlier one, in either order."""
    again: Bools = _find_first_equal_rows(np.sort(faces, axis=1), 4 * len(faces)) != np.arange(len(faces))
    return again


def find_face_origins(points: NDArray[Any], faces: Indices, surface: Surface) -> Indices:
    """Find which of the triangles ``faces`` (F, 3) over ``points`` each face of the surface made of them was; F for a face with a
    moved corner."""
    count, total = len(surface.vertices), len(faces)
    number = _find_first_equal_rows(
        np.concatenate((surface.vertices, points.astype(np.float64))), 4 * (count + len(points))
    )
    corners = np.concatenate((np.take(number[count:], faces), surface.faces))
    first = _find_first_equal_rows(np.sort(corners, axis=1), 4 * len(corners))[total:]
    return np.minimum(first, total)


def find_points_near_rim(surface: Surface, rim: Indices, distance: float) -> Indices:
    """Find the indices of all vertices within ``distance`` of one of the open edges ``rim`` (n, 2), and of few others.

    Two points within half a cell of each other along every axis share a cell in one of eight grids, each shifted by half a
    cell along some of the axes: no pair is missed because a cell's border is between its points.
    """
    points = _scale_to_cells(surface.vertices, distance)
    some, near = np.unique(rim), np.zeros(len(points), dtype=bool)
    for shift in _SHIFTS:
        near |= _match_cells(np.floor(points + shift), some)
    return np.flatnonzero(near)


def weld_near(surface: Surface, candidates: Indices, distance: float) -> Surface | None:
    """Merge those of the ``candidates`` that are within ``distance`` of each other, or in one cell of twice that size (see
    `find_points_near_rim`). None if there is nothing to merge."""
    points = _scale_to_cells(surface.vertices[candidates], distance)
    label, changed = np.arange(len(points)), True
    while changed:
        before = label
        for shift in _SHIFTS:
            cell = _find_first_equal_rows(np.floor(points + shift), 4 * len(points))
            lowest = np.full(len(points), len(points))
            np.minimum.at(lowest, cell, label)
            label = lowest[cell]
        changed = bool((label != before).any())
    if (label == np.arange(len(points))).all():
        return None
    whole = np.arange(len(surface.vertices))
    whole[candidates] = candidates[label]
    vertices, faces = _drop_unused_points(surface.vertices, whole[surface.faces])
    return drop_collapsed_faces(Surface(vertices, faces, collapsed=surface.collapsed, repeated=surface.repeated))


def _scale_to_cells(points: NDArray[np.floating], distance: float) -> Array:
    """Return coordinates from the lowest corner, in cells of twice the distance."""
    cells: Array = (points - compute_bounds(points)[0]) / (2.0 * distance)  # in double precision
    return cells


def _match_cells(cells: NDArray[Any], some: Indices) -> Bools:
    """Return which rows of ``cells`` (n, 3) may equal one of ``some`` of them: all that do, and few others."""
    keys = _hash_rows(cells)
    bits = max(16, (16 * len(some)).bit_length())
    slot = (keys >> np.uint64(64 - bits)).view(np.int64)
    taken = np.zeros(1 << bits, dtype=bool)
    taken[slot[some]] = True
    matches: Bools = np.take(taken, slot)
    return matches


def classify_edges(faces: Indices, n_vertices: int) -> Edges:
    """Classify the edges where the faces (F, 3), at least one, meet."""
    if n_vertices <= 1 << _CORNER_BITS:
        keys = _sort_half_edges(faces, has_faces=False)
        if keys is not None:
            none = np.empty((0, 2), dtype=np.int64)
            return Edges(
                open=none,
                non_manifold=none,
                flipped=none,
                watertight=True,
                winding_consistent=True,
                closed=True,
                distinct_faces=not _has_equal_faces(keys),
            )
    first = _find_first_equal_keys(_build_half_edges(faces), _spread_edges, n_vertices << 2)
    count, backward = np.bincount(first).astype(first.dtype), _find_backward_half_edges(faces)
    balance = count - 2 * np.bincount(first[backward], minlength=len(count)).astype(first.dtype)

    def find_ends(chosen: Bools) -> Indices:
        row, face = np.divmod(np.flatnonzero(chosen), len(faces))
        return np.sort(np.stack((faces[face, row], faces[face, (row + 1) % 3]), axis=1).astype(np.int64), axis=1)

    single, double = count == 1, count == 2
    ends = find_ends(single)
    return Edges(
        open=np.where((balance[single] < 0)[:, None], ends[:, ::-1], ends),
        non_manifold=find_ends(count > 2),
        flipped=find_ends(double & (balance != 0)),
        watertight=bool((double | (count == 0)).all()),
        winding_consistent=not balance[double].any(),
        closed=not balance.any(),
    )


def _build_half_edges(faces: Indices) -> NDArray[np.uint64]:
    """Return each face's three edges (all first ones, all second, all third) as ``low << 32 | high``."""
    keys = np.empty((3, len(faces)), dtype=np.uint64)
    for chunk in _iter_chunks(len(faces)):
        corners = np.ascontiguousarray(faces[chunk].T).astype(np.uint64)
        for row in range(3):
            a, b = corners[row], corners[(row + 1) % 3]
            np.left_shift(np.minimum(a, b), np.uint64(32), out=keys[row, chunk])
            keys[row, chunk] |= np.maximum(a, b)
    return keys.reshape(-1)


def _find_backward_half_edges(faces: Indices) -> Bools:
    """Find which half edges, in the order of `_build_half_edges`, go from their higher vertex to the lower."""
    backward: Bools = np.concatenate([faces[:, row] > faces[:, (row + 1) % 3] for row in range(3)])
    return backward


def _spread_edges(keys: NDArray[np.uint64]) -> Indices:
    """Return a slot for each edge that is near those of its neighbours, for locality of memory."""
    slots = keys >> np.uint64(32)
    slots <<= np.uint64(2)
    slots |= (keys * _MIX[0]) >> np.uint64(62)
    return np.asarray(slots.view(np.int64))


def _has_equal_faces(keys: NDArray[np.uint64]) -> bool:
    """Whether the faces of some pair of half edges, as of `_sort_half_edges`, have all three corners in common."""
    return any(
        (keys[2 * chunk.start : 2 * chunk.stop : 2] ^ keys[2 * chunk.start + 1 : 2 * chunk.stop : 2]).min() == 1
        for chunk in _iter_chunks(len(keys) // 2)
    )


def _find_neighbours(faces: Indices, n_vertices: int) -> Indices | None:
    """Find the two faces (E, 2) of each edge; None as of `_sort_half_edges`, and for more than it can tell apart."""
    if max(n_vertices, len(faces)) > 1 << _CORNER_BITS:
        return None
    keys = _sort_half_edges(faces, has_faces=True)
    if keys is None:
        return None
    keys >>= np.uint64(1)
    keys &= np.uint64((1 << _CORNER_BITS) - 1)
    return keys.reshape(-1, 2).astype(np.int32)


def _sort_half_edges(faces: Indices, *, has_faces: bool) -> NDArray[np.uint64] | None:
    """Return the sorted half edges of the faces (F, 3), each a number of 64 bits: the edge, the third corner of the face (or with
    ``has_faces`` the number of the face) and the direction. None unless every edge has two, with opposite directions.

    NumPy 2 sorts these with vector instructions, in less time than a table at random places takes.
    """
    rows, more_backward = np.empty((3, len(faces)), dtype=np.uint64), 0
    for chunk in _iter_chunks(len(faces)):
        corners = np.ascontiguousarray(faces[chunk].T, dtype=np.uint64)
        for row in range(3):
            a, b, third = corners[row], corners[(row + 1) % 3], corners[(row + 2) % 3]
            key = np.minimum(a, b) << _CORNER_BITS
            key |= np.maximum(a, b)
            key <<= _CORNER_BITS
            key |= np.arange(chunk.start, chunk.stop, dtype=np.uint64) if has_faces else third
            key <<= 1
            is_backward = a > b
            more_backward += 2 * np.count_nonzero(is_backward) - len(is_backward)
            np.bitwise_or(key, is_backward, out=rows[row, chunk])
    if more_backward:
        return None
    keys = rows.reshape(-1)
    keys.sort()
    edge = np.uint64(2 << _CORNER_BITS)  # at least this is between half edges of two edges
    for chunk in _iter_chunks(len(keys) // 2):  # new memory for all of them would take as long as what is computed
        first, second, following = (keys[2 * chunk.start + shift : 2 * chunk.stop + shift : 2] for shift in range(3))
        within, between = first ^ second, second[: len(following)] ^ following
        if within.max() >= edge or between.min(initial=edge) < edge or not (within & np.uint64(1)).all():
            return None
    return keys


def count_component_faces(faces: Indices, n_vertices: int) -> Indices:
    """Count the faces of each piece that is connected by vertices, largest first."""
    counts = np.bincount(np.take(_find_lowest_connected(faces, n_vertices), faces[:, 0]))
    sizes: Indices = np.sort(counts[counts > 0])[::-1]
    return sizes


def label_components(faces: Indices, n_vertices: int) -> Indices:
    """Number the pieces that are connected by vertices, from 0, and return that of each face."""
    return _number_labels(np.take(_find_lowest_connected(faces, n_vertices), faces[:, 0]))


def _number_labels(lowest: Indices) -> Indices:
    """Number the lowest items of pieces from 0."""
    is_lowest = np.zeros(int(lowest.max(initial=-1)) + 1, dtype=bool)
    is_lowest[lowest] = True
    labels: Indices = np.take(np.cumsum(is_lowest) - 1, lowest)
    return labels


def _find_lowest_connected(groups: Indices, count: int) -> Indices:
    """Find the lowest of ``count`` items that is connected with each one: ``groups`` (n, k) are k items that are connected.

    Each item is led to the lowest of its groups, and that to its own, until it is the lowest (Shiloach and Vishkin, *An
    O(log n) parallel connectivity algorithm*, 1982). What is then still apart goes on with the lowest ones.
    """
    lowest = np.arange(count, dtype=groups.dtype)
    columns = [*np.ascontiguousarray(groups.T)]  # numpy takes ten times as long for what is along rows of three
    while len(columns[0]):
        aim = reduce(np.minimum, columns)
        for column in columns:
            np.minimum.at(lowest, column, aim)
        while not np.array_equal(following := np.take(lowest, lowest), lowest):
            lowest = following
        columns = [np.take(lowest, column) for column in columns]
        are_apart = reduce(np.logical_or, [column != columns[0] for column in columns[1:]])
        columns = [column[are_apart] for column in columns]
    return lowest


def label_bodies(faces: Indices, n_vertices: int) -> Indices:
    """Number the closed bodies of a closed surface, from 0, and return that of each face: bodies of an assembly that only touch
    have corners in common, and are connected where two faces share an edge. Where a piece of these is open, the pieces are those
    of `label_components`."""
    neighbours = _find_neighbours(faces, n_vertices)
    if neighbours is not None:
        return _number_labels(_find_lowest_connected(neighbours, len(faces)))
    edge = _find_first_equal_keys(_build_half_edges(faces), _spread_edges, n_vertices << 2)
    backward = _find_backward_half_edges(faces)
    of_two = np.take(np.bincount(edge), edge) == 2
    second = np.flatnonzero(of_two & (edge != np.arange(len(edge))))
    first = np.take(edge, second)
    lowest = _find_lowest_connected(np.stack((first, second), axis=1) % len(faces), len(faces))
    pieces, labels = np.unique(lowest, return_inverse=True)
    # Of each edge of a piece there are as many half edges in either direction.
    others = np.flatnonzero(~of_two)
    sides, of_piece = np.unique(
        edge[others].astype(np.int64) * len(pieces) + labels[others % len(faces)], return_inverse=True
    )
    uneven = np.bincount(of_piece, weights=np.where(backward[others], -1.0, 1.0), minlength=len(sides))
    if uneven.any() or (np.take(backward, first) == np.take(backward, second)).any():
        return label_components(faces, n_vertices)
    return labels.astype(np.int64)


def find_unpaired_edges(faces: Indices, edges: Edges) -> Indices:
    """Find the edges (n, 2) that faces have more often in one direction than in the other, in that direction, as often as they
    have it more often. They are the boundary of the surface: as many begin in each vertex as end there."""
    odd = np.unique(np.concatenate([edges.open, edges.non_manifold, edges.flipped]))
    half_edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    half_edges = half_edges[np.isin(half_edges, odd).all(axis=1)]
    ordered = np.sort(half_edges, axis=1)
    unique, which = np.unique(ordered, axis=0, return_inverse=True)
    signs = np.where(half_edges[:, 0] == ordered[:, 0], 1, -1)
    surplus = np.rint(np.bincount(which.ravel(), weights=signs, minlength=len(unique))).astype(np.int64)
    directed = np.where(surplus[:, None] > 0, unique, unique[:, ::-1])
    unpaired: Indices = np.repeat(directed, np.abs(surplus), axis=0)
    return unpaired


def find_boundaries(vertices: Array, open_edges: Indices) -> tuple[Boundary, ...]:
    """Find the boundaries (longest first) that the edges (n, 2) of one face form."""
    boundaries = [_build_boundary(vertices, path, closed) for path, closed in _iter_boundary_paths(open_edges.tolist())]
    return tuple(sorted(boundaries, key=lambda boundary: (-boundary.length, boundary.centre.tolist())))


def _iter_boundary_paths(open_edges: list[list[int]]) -> Iterator[tuple[list[int], bool]]:
    """Split a graph's edges into simple loops, and into paths where odd vertices prevent loops.

    A walk that returns to a vertex yields the loop in between, so that holes that touch in one vertex are separate.
    """
    neighbours: dict[int, set[int]] = {}
    for a, b in open_edges:
        neighbours.setdefault(a, set()).add(b)
        neighbours.setdefault(b, set()).add(a)
    # Paths end at odd vertices: starting there leaves only loops.
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


def measure_gap_width(points: Array) -> float:
    """Measure how wide a hole with the rim ``points`` (k, 3) is: the largest distance of a point from the line between the two
    that are farthest apart. For a rim of very many points, an upper bound."""
    if len(points) > _MOST_RIM_POINTS:
        return float(np.linalg.norm(np.ptp(points, axis=0)))
    apart = np.linalg.norm(points[:, None] - points[None, :], axis=2)
    start, end = np.unravel_index(int(apart.argmax()), apart.shape)
    chord = points[end] - points[start]
    length = float(np.linalg.norm(chord))
    if not length > 0.0:
        return 0.0
    return float(np.linalg.norm(np.cross(points - points[start], chord / length), axis=1).max())


def _build_boundary(vertices: Array, path: list[int], closed: bool) -> Boundary:
    points = vertices[path]
    following = np.roll(points, -1, axis=0) if closed else points[1:]
    starts = points if closed else points[:-1]
    lengths = np.linalg.norm(following - starts, axis=1)
    length = float(lengths.sum())
    centre = lengths @ (starts + following) / 2.0 / length if length > 0.0 else points.mean(axis=0)
    points.setflags(write=False)
    centre.setflags(write=False)
    return Boundary(points, closed=closed, length=length, centre=centre)
