"""Exact integrals over triangles: of the solid that they bound, and of the thin shell that they form.

The solid is summed over signed tetrahedra (Tonon, *Explicit exact formulas for the 3-D tetrahedron inertia tensor*, 2004),
each between a triangle and a reference point near the mesh, which keeps the digits far from the origin.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.mesh.topology import compute_bounds

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from urdfcheck.facts.arrays import Array, Indices, Mat3, Vec3


# Triangles worked on at a time: their temporaries stay in the processor's cache.
_CHUNK = 8192
# Below this share of its longest edge squared, twice a triangle's area is rounding: its corners lie on one line.
_FLAT = 1e-14


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MeshMoments:
    """Moments of a mesh, in the units of its vertices."""

    volume: float
    """Signed, of the solid; 0 where only rounding is left."""
    com: Vec3
    """Of the solid at uniform density; NaN without volume."""
    covariance: Mat3
    """Of the solid at uniform density, about the COM; NaN without volume."""
    area: float
    """Of the surface."""
    surface_centroid: Vec3
    """Of the surface as a thin shell."""
    surface_covariance: Mat3
    """Of the surface as a thin shell, about its centroid."""
    flat_faces: int
    """Number of triangles without area."""


def compute_mesh_moments(vertices: NDArray[np.floating], faces: Indices) -> MeshMoments:
    """Integrate over the triangles ``faces`` (F, 3), at least one, of ``vertices`` (V, 3), in double precision."""
    low, high = compute_bounds(vertices)
    reference, size = (low + high) / 2.0, float((high - low).max())
    # Per column x, y, z: contiguous, and every step below is one pass over numbers in the cache.
    # NumPy 1 would compute the difference from a single number in the precision of the column.
    x, y, z = (np.subtract(*pair, dtype=np.float64) for pair in zip(vertices.T, reference, strict=True))
    flat = 0
    sums = np.zeros((2, 10))  # volume, area: weight, three first and six second moments
    for start in range(0, len(faces), _CHUNK):
        # Converted once, and not for each of the nine.
        a, b, c = np.ascontiguousarray(faces[start : start + _CHUNK].T, dtype=np.intp)
        ax, ay, az, bx, by, bz, cx, cy, cz = (np.take(column, corner) for corner in (a, b, c) for column in (x, y, z))
        ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        weights = np.empty((2, len(a)))
        weights[0] = ax * nx + ay * ny + az * nz
        square = nx * nx + ny * ny + nz * nz
        np.sqrt(square, out=weights[1])
        # Only the smallest can be flat: no edge is longer than the mesh.
        if weights[1].min() <= _FLAT * 3.0 * size * size:
            wx, wy, wz = ux - vx, uy - vy, uz - vz
            longest = np.maximum(
                np.maximum(ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz), wx * wx + wy * wy + wz * wz
            )
            flat += int((weights[1] <= _FLAT * longest).sum())
        sx, sy, sz = ax + bx + cx, ay + by + cy, az + bz + cz
        features = np.stack(
            (
                np.ones(len(a)), sx, sy, sz,
                ax * ax + bx * bx + cx * cx + sx * sx,
                ax * ay + bx * by + cx * cy + sx * sy,
                ax * az + bx * bz + cx * cz + sx * sz,
                ay * ay + by * by + cy * cy + sy * sy,
                ay * az + by * bz + cy * cz + sy * sz,
                az * az + bz * bz + cz * cz + sz * sz,
            )
        )  # fmt: skip
        sums += weights @ features.T
    volume, area = sums[0, 0] / 6.0, sums[1, 0] / 2.0
    nothing = np.full(3, np.nan), np.full((3, 3), np.nan)
    com, covariance = nothing
    if abs(volume) > 1e-15 * size**3:
        com, covariance = _compute_central_moments(sums[0, 1:4] / 24.0 / volume, sums[0, 4:] / 120.0 / volume)
    else:
        volume = 0.0  # the rest of a sum of volumes that cancel, as of a surface that is stored from both sides
    centroid, shell = np.zeros(3), np.zeros((3, 3))
    if area > 0.0:
        centroid, shell = _compute_central_moments(sums[1, 1:4] / 6.0 / area, sums[1, 4:] / 24.0 / area)
    return MeshMoments(
        volume=float(volume),
        com=com + reference,
        covariance=covariance,
        area=float(area),
        surface_centroid=centroid + reference,
        surface_covariance=shell,
        flat_faces=flat,
    )


def _compute_central_moments(mean: Vec3, second_moments: Array) -> tuple[Vec3, Mat3]:
    xx, xy, xz, yy, yz, zz = second_moments
    return mean, np.array(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))) - np.outer(mean, mean)
