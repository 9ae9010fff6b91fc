"""How far two triangulated surfaces are from each other, at points spread over both."""

from __future__ import annotations

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.arrays import Array, Indices

# Points on one surface, and triangles above which a surface is not sampled.
_MOST_POINTS, _MOST_FACES = 20_000, 200_000
# Triangles near a point of which one is the nearest, and points that are examined at once.
_NEAREST, _BATCH = 12, 500
# The finest division of an edge.
_FINEST = 200


@dataclass(frozen=True, slots=True)
class SurfaceDistance:
    """How far two surfaces are from each other; lengths in m."""

    gone: float
    """The farthest that a point of the first is from the second."""
    come: float
    """The farthest that a point of the second is from the first."""
    error: float
    """No point of either surface is farther than this from one that was examined."""


@dataclass(frozen=True, slots=True, eq=False)
class _SampledSurface:
    """A surface with points on it."""

    triangles: Array
    """(F, 3, 3), corners."""
    points: Array
    """(P, 3)."""
    owners: Indices
    """(P,), the triangle of each point."""
    spacing: float
    """No point of the surface is farther from the next sample."""


def measure_surface_distance(
    vertices_a: Array, faces_a: Indices, vertices_b: Array, faces_b: Indices
) -> SurfaceDistance | None:
    """Measure how far two surfaces are from each other, both ways; None for one that is empty or has too many triangles.

    ``vertices`` (V, 3), in one frame, and ``faces`` (F, 3).
    """
    if not min(len(faces_a), len(faces_b)) > 0 or max(len(faces_a), len(faces_b)) > _MOST_FACES:
        return None
    one, other = _sample_surface(vertices_a[faces_a]), _sample_surface(vertices_b[faces_b])
    return SurfaceDistance(
        gone=_find_farthest(one, other), come=_find_farthest(other, one), error=max(one.spacing, other.spacing)
    )


def _sample_surface(triangles: Array) -> _SampledSurface:
    """Divide each triangle into equal ones, the larger the more, and take their middles."""
    edges = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=2).max(axis=1)
    step = float(edges.max())
    counts = _count_divisions(edges, step)
    while step > 0.0 and counts.max() < _FINEST:
        finer = _count_divisions(edges, step / 1.25)
        if int(finer @ finer) > _MOST_POINTS:
            break
        step, counts = step / 1.25, finer
    middles = triangles.mean(axis=1)
    reach = np.linalg.norm(triangles - middles[:, None], axis=2).max(axis=1) / counts
    points, owners = [], []
    for count in np.unique(counts).tolist():
        chosen = np.flatnonzero(counts == count)
        shares = _list_middles(count)
        points.append(np.einsum("pc,fcx->fpx", shares, triangles[chosen]).reshape(-1, 3))
        owners.append(np.repeat(chosen, len(shares)))
    return _SampledSurface(triangles, np.concatenate(points), np.concatenate(owners), float(reach.max()))


def _count_divisions(edges: Array, step: float) -> Indices:
    """Return into how many parts the edges (F,) of triangles are divided, so that none is longer than ``step``."""
    counts: Indices = np.clip(np.ceil(edges / max(step, 1e-300)), 1, _FINEST).astype(np.int64)
    return counts


def _list_middles(count: int) -> Array:
    """Return the barycentric coordinates (count², 3) of the middles of the equal parts of a triangle."""
    upright = [(i + 1 / 3, j + 1 / 3) for i in range(count) for j in range(count - i)]
    turned = [(i + 2 / 3, j + 2 / 3) for i in range(count) for j in range(count - 1 - i)]
    first, second = np.array(upright + turned).T / count
    return np.column_stack((first, second, 1.0 - first - second))


def _find_farthest(one: _SampledSurface, other: _SampledSurface) -> float:
    """Return the farthest that a sample or a corner of a surface is from the other surface.

    The distance to a sample of the other surface is never less than that to the surface: points that are nearer to one than the
    farthest that was found need no closer look.
    """
    from scipy.spatial import cKDTree  # loaded only where it is used

    points = np.concatenate((one.points, np.unique(one.triangles.reshape(-1, 3), axis=0)))
    tree = cKDTree(other.points)
    bounds, _ = tree.query(points)
    order = np.argsort(-bounds)
    farthest = 0.0
    for start in range(0, len(order), _BATCH):
        batch = order[start : start + _BATCH]
        if bounds[batch[0]] <= farthest:
            break
        _, near = tree.query(points[batch], k=min(_NEAREST, len(other.points)))
        candidates = other.triangles[other.owners[np.asarray(near).reshape(len(batch), -1)]]
        distances = _measure_to_triangles(points[batch], candidates)
        farthest = max(farthest, float(np.minimum(distances, bounds[batch]).max()))
    return farthest


def _measure_to_triangles(points: Array, triangles: Array) -> Array:
    """Return the distance (N,) of points (N, 3) to the nearest of some triangles each (N, K, 3, 3)."""
    corners = np.moveaxis(triangles, 2, 0)
    place = points[:, None]
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    length = np.linalg.norm(normal, axis=-1)
    inside = length > 0.0
    nearest = np.full(length.shape, np.inf)
    for first, second in ((0, 1), (1, 2), (2, 0)):
        start, edge = corners[first], corners[second] - corners[first]
        along = np.einsum("nkx,nkx->nk", place - start, edge) / np.maximum(np.einsum("nkx,nkx->nk", edge, edge), 1e-300)
        foot = start + np.clip(along, 0.0, 1.0)[..., None] * edge
        nearest = np.minimum(nearest, np.linalg.norm(place - foot, axis=-1))
        inside &= np.einsum("nkx,nkx->nk", np.cross(edge, place - start), normal) >= 0.0
    height = np.abs(np.einsum("nkx,nkx->nk", place - corners[0], normal)) / np.maximum(length, 1e-300)
    found: Array = np.where(inside, height, nearest).min(axis=1)
    return found
