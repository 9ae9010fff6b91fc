"""Meshes in few bytes, for reports: corners on a grid, sorted so that neighbours are near, differences in planes of bytes.

The result is meant to be deflated, to 4 to 6 bytes per triangle with base64. All integers are little-endian. For each of
x, y, z: the differences between consecutive corners, first all low bytes, then all high bytes. For each corner of the triangles
(of the first one the difference from that of the previous triangle, of the others that from the first): the same, with two
bytes or three (see `needs_wide_indices`). For each edge of a hole: its two ends as six numbers of two bytes. Negative
differences are interleaved with the positive ones (0, -1, 1, -2, …).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from urdfcheck.facts.arrays import Array, Indices, Vec3


BITS = 14
STEPS = (1 << BITS) - 1
# Differences between the indices of more corners need a third byte.
_NARROW = 1 << 15
# Grids for meshes that are too fine: cells along the diagonal, and the factor by which they grow.
_FINEST, _COARSER = 500.0, 1.25


class PackedMesh(NamedTuple):
    """A mesh in few bytes."""

    data: bytes
    n_vertices: int
    n_faces: int
    n_hole_edges: int
    low: Vec3
    """Lower bounds of the grid, in units of the mesh."""
    high: Vec3
    """Upper bounds of the grid, in units of the mesh."""


def needs_wide_indices(n_vertices: int) -> bool:
    """Whether indices of this many corners take three bytes."""
    return n_vertices > _NARROW


def pack_mesh(vertices: Array, faces: Indices, edges: Array, *, max_faces: int) -> PackedMesh:
    """Pack a mesh of ``vertices`` (V, 3) and ``faces`` (F, 3), with the ends (n, 2, 3) of the edges of its holes.

    Corners without a triangle are dropped, those that coincide on the grid are merged, triangles without area are dropped.
    More triangles than ``max_faces`` are reduced by merging the corners of one cell into their mean.
    """
    used, number = np.unique(faces, return_inverse=True)
    vertices, faces = _simplify_mesh(vertices[used], number.reshape(faces.shape), max_faces)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    codes, number = np.unique(_encode_morton(_snap_to_grid(vertices, low, high)), return_inverse=True)
    faces = _sort_faces(number.reshape(-1)[faces])
    points = _decode_morton(codes)
    planes = [_encode_byte_planes(np.diff(column, prepend=0), 2) for column in points.T]
    a, b, c = faces.T
    size = 3 if needs_wide_indices(len(points)) else 2
    planes += [_encode_byte_planes(column, size) for column in (np.diff(a, prepend=0), b - a, c - a)]
    ends = _snap_to_grid(edges.reshape(-1, 3), low, high).astype("<u2")
    return PackedMesh(
        data=b"".join((*planes, ends.tobytes())),
        n_vertices=len(points),
        n_faces=len(faces),
        n_hole_edges=len(edges),
        low=low,
        high=high,
    )


def unpack_mesh(packed: PackedMesh) -> tuple[Array, Indices, Array]:
    """Return the corners (V, 3), triangles (F, 3) and the ends of the edges of holes (n, 2, 3): the inverse of `pack_mesh`."""
    data = np.frombuffer(packed.data, dtype=np.uint8)
    size = 3 if needs_wide_indices(packed.n_vertices) else 2
    columns, at = [], 0
    for count, width in ((packed.n_vertices, 2),) * 3 + ((packed.n_faces, size),) * 3:
        columns.append(_decode_byte_planes(data[at : at + count * width].reshape(width, count)))
        at += count * width
    scale = (packed.high - packed.low) / STEPS
    points = packed.low + scale * np.cumsum(columns[:3], axis=1).T
    first = np.cumsum(columns[3])
    faces = np.column_stack((first, first + columns[4], first + columns[5]))
    ends = data[at:].view("<u2").reshape(-1, 2, 3)
    return points, faces, packed.low + scale * ends


def _snap_to_grid(points: Array, low: Array, high: Array) -> Indices:
    extent = high - low
    steps = np.divide(STEPS, extent, out=np.zeros(3), where=extent > 0.0)
    return np.clip(np.rint((points - low) * steps), 0, STEPS).astype(np.int64)


def _encode_morton(grid: Indices) -> Indices:
    """Return the Morton code of each point (n, 3): points that are near each other mostly have near codes."""
    code = np.zeros(len(grid), dtype=np.int64)
    for axis, column in enumerate(grid.T):
        code |= _spread_bits(column) << axis
    return code


# Masks that hold groups of 16, 8, 4, 2 and 1 bits with twice as many zeros between them, and how far each step moves them.
_MASKS = (
    (16, 0xFF0000FF0000FF),
    (8, 0xF00F00F00F00F00F),
    (4, 0x30C30C30C30C30C3),
    (2, 0x9249249249249249),
)


def _spread_bits(values: Indices) -> Indices:
    """Insert two zeros between each two bits."""
    spread = values.astype(np.uint64)
    for shift, mask in _MASKS:
        spread = (spread | (spread << np.uint64(shift))) & np.uint64(mask)
    return spread.astype(np.int64)


def _decode_morton(codes: Indices) -> Indices:
    """Return the points (n, 3) of Morton codes: the inverse of `_encode_morton`."""
    points = np.zeros((len(codes), 3), dtype=np.int64)
    for axis in range(3):
        for bit in range(BITS):
            points[:, axis] |= ((codes >> (3 * bit + axis)) & 1) << bit
    return points


def _sort_faces(faces: Indices) -> Indices:
    """Drop triangles that repeat a corner, rotate each to begin with its lowest corner, and sort them by it."""
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    first = faces.argmin(axis=1)
    turned = np.take_along_axis(faces, (first[:, None] + np.arange(3)) % 3, axis=1)
    return turned[np.lexsort(turned.T[::-1])]


def _encode_byte_planes(differences: Indices, size: int) -> bytes:
    zigzag = ((differences << 1) ^ (differences >> 63)).astype("<u4")
    planes: bytes = zigzag.view(np.uint8).reshape(-1, 4)[:, :size].T.tobytes()
    return planes


def _decode_byte_planes(planes: NDArray[np.uint8]) -> Indices:
    zigzag = sum(plane.astype(np.int64) << (8 * place) for place, plane in enumerate(planes))
    return np.asarray((zigzag >> 1) ^ -(zigzag & 1), dtype=np.int64)


def _simplify_mesh(vertices: Array, faces: Indices, most: int) -> tuple[Array, Indices]:
    low = vertices.min(axis=0)
    diagonal = float(np.linalg.norm(np.ptp(vertices, axis=0)))
    cells = _FINEST
    thin = vertices, faces
    # Without a diagonal all corners are one point, and no triangle is left.
    while len(thin[1]) > most and cells > 1.0 and diagonal > 0.0:
        keys = np.floor((vertices - low) * (cells / diagonal)).astype(np.int64)
        _, number = np.unique(_encode_morton(keys), return_inverse=True)
        number = number.reshape(-1)
        count = np.bincount(number)
        merged = np.column_stack([np.bincount(number, weights=column) / count for column in vertices.T])
        thin = merged, np.unique(_sort_faces(number[faces]), axis=0)
        cells /= _COARSER
    return thin
