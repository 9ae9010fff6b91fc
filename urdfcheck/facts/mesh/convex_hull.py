"""Convex hulls of points: exact of some, and of many from as few of them as leave no other far outside.

How far a point is outside is measured by the gauge of the hull about a centre inside it: the factor by which the hull must grow
about the centre to reach the point, 1 on its surface. The gauge is the greatest of linear functions, one for each face of the
hull, and therefore convex: between directions for which it is known it is at most what is interpolated linearly. That settles
most points at once. The rest is compared with every face.
"""

from __future__ import annotations

from itertools import combinations, product
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.mesh.moments import compute_mesh_moments
from urdfcheck.system.qhull import load_qhull

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.spatial import ConvexHull

    from urdfcheck.facts.arrays import Array, Indices, Mat3, Vec3

    Floats = NDArray[np.float32]

# More points than the largest of 1,355 meshes of published robots has. To take them all costs half a second if each is on the
# hull, and no longer pays.
MOST_EXACT = 50_000
# How much larger the hull of many points may be than that of the chosen ones. The least margin of a rule is 2 %.
MOST_EXCESS = 1e-3
# Squares along an edge of the cube onto which points are seen from the centre: to choose the outermost point in each, and to
# interpolate the gauge. A finer grid leaves fewer points to compare with every face, and takes longer itself.
_CHOOSING, _BOUNDING = 32, 64
# Rounds in which the farthest point outside of each face is added. A few are enough; what is left after these is added whole.
_ROUNDS = 20
# About so many of the points are enough to find the middle, the spread, and the first corners of the hull.
_SAMPLE = 50_000
# What a volume may be too large by.
_ROUNDING = 1e-6
# Items processed at a time: their temporaries stay in the processor's cache. More products at once are shared among threads by
# OpenBLAS outside of workers, where these take longer to wait for each other than to multiply.
_CHUNK, _MOST_PRODUCTS = 16384, 1 << 17


@dataclass(frozen=True, slots=True, eq=False)
class MeshHull:
    """A convex hull; for a flat or straight mesh its bounding box, with the volume 0."""

    vertices: Array
    """(K, 3), the corners."""
    faces: Indices
    """(F, 3), triangles that face outwards."""
    volume: float
    area: float
    excess: float = 0.0
    """The hull of all points is within this one, grown by this share of its size about a point inside. 0 where it is exact; the
    bounding box always is."""


@dataclass(frozen=True, slots=True, eq=False)
class _CentredPoints:
    """Points as seen from a centre among them, in coordinates in which they spread equally far in all directions."""

    centre: Vec3
    to_points: Mat3
    """``point - centre = to_points @ ray``."""
    rays: Floats
    """(3, n)"""
    side: NDArray[np.int8]
    """(n,), see `_project`; so are the next two."""
    places: Floats
    """(2, n)"""
    height: Floats
    """(n,)"""


def _load_hulls() -> ModuleType:
    """Load what computes hulls: a module with ``ConvexHull`` and ``QhullError``.

    :raises ImportError: when neither scipy nor Manifold is installed.
    """
    try:
        return load_qhull()
    except ImportError:
        from urdfcheck.system import manifold_hull

        return manifold_hull


def compute_convex_hull(points: NDArray[np.floating]) -> MeshHull:
    """Compute the convex hull of ``points`` (n, 3); of more than `MOST_EXACT`, within `MOST_EXCESS`.

    :raises ImportError: when neither scipy nor Manifold is installed.
    """
    qhull = _load_hulls()
    try:
        bounded = _bound_hull(points) if len(points) > MOST_EXACT else None
        hull = bounded or qhull.ConvexHull(points)
    except (qhull.QhullError, ValueError):
        return _make_flat_hull(np.asarray(points, dtype=np.float64))
    corners = hull.points
    number = np.zeros(len(corners), dtype=np.int64)
    number[hull.vertices] = np.arange(len(hull.vertices))
    faces = number[hull.simplices]
    vertices: Array = corners[hull.vertices]
    a, b, c = (vertices[column] for column in faces.T)
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0.0
    faces[inward] = faces[inward][:, ::-1]
    excess = 0.0 if bounded is None else MOST_EXCESS
    return MeshHull(vertices, faces, volume=float(hull.volume), area=float(hull.area), excess=excess)


def compute_least_volume(points: Array) -> float:
    """Compute a volume that the convex hull of ``points`` (n, 3) has at least: that of the largest tetrahedron between the points
    that are outermost along the axes. NaN where a point is not finite.

    Most questions about a large volume are settled by it, in a hundredth of the time.
    """
    # numpy's unique would load its module for masked arrays.
    outermost = points[sorted({*points.argmin(axis=0).tolist(), *points.argmax(axis=0).tolist()})]
    corners = np.array(list(combinations(outermost, 4))).reshape(-1, 4, 3)
    edges = corners[:, 1:] - corners[:, :1]
    volumes = np.abs(np.linalg.det(edges)) / 6.0
    return float(volumes.max(initial=0.0)) * (1.0 - _ROUNDING)


def _make_flat_hull(points: Array) -> MeshHull:
    corners = np.array(list(product(*zip(points.min(axis=0), points.max(axis=0), strict=True))))
    quads = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    faces = np.array([(a, b, c) for a, b, c, _ in quads] + [(a, c, d) for a, _, c, d in quads])
    area = float(compute_mesh_moments(corners, faces).area)
    return MeshHull(vertices=corners, faces=faces, volume=0.0, area=area)


def _bound_hull(points: NDArray[np.floating]) -> ConvexHull | None:
    """Compute the hull of so many of the points (n, 3) that none is outside by more than `MOST_EXCESS`; None where they are in a
    plane, and where their mean is not inside.

    The first are the outermost in many directions. Of the points outside, the farthest from each face follow, as in quickhull
    (Barber, Dobkin and Huhdanpaa, *The quickhull algorithm for convex hulls*, 1996), until there are none.
    """
    qhull = _load_hulls()
    seen = _centre_points(points)
    if seen is None:
        return None
    longest = float(np.linalg.norm([np.abs(column).max() for column in seen.rays]))  # or somewhat more
    extremes = [place for column in points.T for place in (column.argmin(), column.argmax())]
    chosen = np.concatenate((_select_outermost(seen), extremes))
    left = np.zeros(0, dtype=np.int64)
    for turn in range(_ROUNDS):
        chosen = np.array(sorted({*chosen.tolist()}))  # numpy's unique would load its module for masked arrays
        hull = qhull.ConvexHull(points[chosen])
        of_face = seen.side[chosen[hull.simplices]]
        chosen = chosen[hull.vertices]
        slopes = _compute_slopes(hull.equations, seen)
        if slopes is None:
            return None
        # What single precision makes of a product of a slope and a ray, and of the interpolation.
        rounding = 16.0 * float(np.finfo(np.float32).eps) * longest * float(np.linalg.norm(slopes, axis=1).max())
        limit = 1.0 + MOST_EXCESS - rounding
        if turn == 0:
            grid = _make_grid(np.linspace(-1.0, 1.0, _BOUNDING + 1))
            of_point = np.repeat(np.arange(6), len(grid) // 6)
            left = _find_doubtful(seen, _measure_gauge(grid, of_point, slopes, of_face)[0], limit)
        gauge, face = _measure_gauge(seen.rays[:, left].T, seen.side[left], slopes, of_face)
        is_outside = gauge > limit
        left, gauge, face = left[is_outside], gauge[is_outside], face[is_outside]
        if not len(left):
            return hull
        farthest, order = np.full(len(slopes), -1), np.argsort(gauge)
        farthest[face[order]] = left[order]  # the last to write, which is the farthest, stays
        chosen = np.concatenate((chosen, farthest[farthest >= 0]))
    return qhull.ConvexHull(points[np.concatenate((chosen, left))])


def _centre_points(points: NDArray[np.floating]) -> _CentredPoints | None:
    """Take the points (n, 3) relative to their mean. None if they are in a plane, or too far apart for their squares."""
    some = points[:: max(1, len(points) // _SAMPLE)].astype(np.float64)
    centre = some.mean(axis=0)
    with np.errstate(all="ignore"):
        covariance = np.einsum("ni,nj->ij", some - centre, some - centre) / len(some)
    if not np.isfinite(covariance).all():
        return None
    variances, axes = np.linalg.eigh(covariance)
    if not variances[0] > 1e-12 * variances[2]:
        return None
    spreads = np.sqrt(variances)
    rays, side = np.empty((3, len(points)), dtype=np.float32), np.empty(len(points), dtype=np.int8)
    places, height = np.empty_like(rays[:2]), np.empty_like(rays[0])
    turn = (axes / spreads).T
    for start in range(0, len(points), _CHUNK):
        chunk = slice(start, start + _CHUNK)
        rays[:, chunk] = turn @ np.subtract(points[chunk].T, centre[:, None], order="C")
        side[chunk], places[:, chunk], height[chunk] = _project(rays[:, chunk])
    return _CentredPoints(centre, axes * spreads, rays, side, places, height)


def _compute_slopes(planes: Array, seen: _CentredPoints) -> Floats | None:
    """Compute the linear functions (F, 3) of rays whose greatest is the gauge, from the ``planes`` (F, 4) of a hull's faces. None
    if the centre is not inside."""
    heights = -(planes[:, :3] @ seen.centre + planes[:, 3])
    if not heights.min() > 0.0:
        return None
    slopes: Floats = (planes[:, :3] @ seen.to_points / heights[:, None]).astype(np.float32)
    return slopes


def _measure_gauge(
    rays: NDArray[Any], side: NDArray[Any], slopes: Floats, of_face: NDArray[Any]
) -> tuple[Floats, Indices]:
    """Measure the gauge (n,) of rays (n, 3), and say on which face it is.

    ``side``: on which side of the cube each ray is seen, and ``of_face`` (F, 3): where the corners of each face are. A face whose
    corners are seen on one side is seen there as a whole: it is left out on the others.
    """
    gauge, face = np.empty(len(rays), dtype=np.float32), np.empty(len(rays), dtype=np.int64)
    is_on_one = (of_face == of_face[:, :1]).all(axis=1)
    for number in range(6):
        some, seen = np.flatnonzero(side == number), np.flatnonzero(~is_on_one | (of_face[:, 0] == number))
        gauge[some], places = _find_greatest(rays[some], slopes[seen])
        face[some] = seen[places]
    return gauge, face


def _find_greatest(rays: NDArray[Any], slopes: Floats) -> tuple[Floats, Indices]:
    """Find the greatest product (n,) of each ray (n, 3) and a slope (F, 3), and which slope that is."""
    greatest, place = np.empty(len(rays), dtype=np.float32), np.empty(len(rays), dtype=np.int64)
    rows = max(1, _MOST_PRODUCTS // max(1, len(slopes)))
    products, across = np.empty((rows, len(slopes)), dtype=np.float32), np.ascontiguousarray(slopes.T)
    for start in range(0, len(rays), rows):
        some = np.matmul(rays[start : start + rows], across, out=products[: min(rows, len(rays) - start)])
        place[start : start + rows] = some.argmax(axis=1)
        greatest[start : start + rows] = some[np.arange(len(some)), place[start : start + rows]]
    return greatest, place


def _find_doubtful(seen: _CentredPoints, gauge: Floats, limit: float) -> Indices:
    """Find the rays whose gauge may be above the limit: where what is interpolated between the three corners of a grid is, on
    whose points it is ``gauge``."""
    count = _BOUNDING + 1
    doubtful = []
    for start in range(0, len(seen.side), _CHUNK):
        chunk = slice(start, start + _CHUNK)
        places = seen.places[:, chunk] * np.float32(_BOUNDING)
        square = np.minimum(places.astype(np.int32), _BOUNDING - 1)
        across, along = places - square
        corner = (seen.side[chunk] * np.intp(count) + square[0]) * count + square[1]
        # Each square is cut along its diagonal from the lowest to the highest corner.
        lowest, highest = np.take(gauge, corner), np.take(gauge, corner + (count + 1))
        third = np.take(gauge, corner + np.where(across > along, count, 1))
        far, near = np.maximum(across, along), np.minimum(across, along)
        bound = seen.height[chunk] * (lowest + (third - lowest) * far + (highest - third) * near)
        doubtful.append(start + np.flatnonzero(bound > limit))
    return np.concatenate(doubtful)


def _select_outermost(seen: _CentredPoints) -> Indices:
    """Find the ray that reaches farthest in the direction of each square of a grid."""
    middles = _make_grid((np.arange(_CHOOSING) + 0.5) / _CHOOSING * 2.0 - 1.0)
    middles /= np.linalg.norm(middles, axis=1)[:, None]
    columns = np.ascontiguousarray(middles.T)
    squares, reach = np.empty(len(seen.side), dtype=np.int32), np.empty(len(seen.side), dtype=np.float32)
    for start in range(0, len(squares), _CHUNK):
        chunk = slice(start, start + _CHUNK)
        across, along = np.minimum((seen.places[:, chunk] * np.float32(_CHOOSING)).astype(np.intp), _CHOOSING - 1)
        square = (seen.side[chunk] * np.intp(_CHOOSING) + across) * _CHOOSING + along
        squares[chunk] = square
        reach[chunk] = sum(
            ray * np.take(column, square) for ray, column in zip(seen.rays[:, chunk], columns, strict=True)
        )
    farthest = np.full(len(middles), -np.inf, dtype=np.float32)
    np.maximum.at(farthest, squares, reach)
    outermost = np.full(len(middles), -1)
    at_reach = np.flatnonzero(reach == np.take(farthest, squares))
    outermost[squares[at_reach]] = at_reach
    return outermost[outermost >= 0]


def _project(rays: Floats) -> tuple[Indices, Floats, Floats]:
    """Project rays (3, n) onto a cube of edge 2 about the centre: return the number (n,) of its side, the places (2, n) on that,
    from 0 to 1, and how many times as far the rays reach (n,)."""
    x, y, z = rays
    along_x, along_y, along_z = np.abs(rays)
    height = np.maximum(np.maximum(along_x, along_y), along_z)
    is_x, is_y = along_x == height, along_y == height
    reach = np.where(is_x, x, np.where(is_y, y, z))
    places = np.stack((np.where(is_x, y, np.where(is_y, z, x)), np.where(is_x, z, np.where(is_y, x, y))))
    np.maximum(height, np.finfo(np.float32).tiny, out=height)
    places /= height
    places += np.float32(1.0)
    places *= np.float32(0.5)
    return np.where(is_x, 0, np.where(is_y, 2, 4)) + (reach < 0.0), places, height


def _make_grid(places: Array) -> Floats:
    """Make the points (6 k k, 3) of a grid on the cube, in the order of `_project`; ``places`` (k,) along edges, from -1 to 1."""
    sides = np.empty((6, len(places), len(places), 3), dtype=np.float32)
    for side in range(6):
        axis = side // 2
        sides[side, :, :, axis] = (1.0, -1.0)[side % 2]
        sides[side, :, :, (axis + 1) % 3] = places[:, None]
        sides[side, :, :, (axis + 2) % 3] = places[None, :]
    return sides.reshape(-1, 3)
