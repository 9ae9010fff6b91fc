"""Mirror planes, and how two parts are related by one: as mirror images, or as copies of each other.

The mirror image of a body is described in the axes of its twin by an improper rotation ``linear`` (3, 3) and a ``shift``
(3,): ``x -> linear x + shift``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.inertia_tensor import compute_mass_covariance
from urdfcheck.facts.median import compute_median
from urdfcheck.facts.motion.kinematics import compute_joint_motions
from urdfcheck.facts.sphere_directions import spread_directions_and_axes

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from urdfcheck.facts.arrays import Array, Mat3, Vec3


# The numbers of an inertial besides its mass: the COM, and the inertia in URDF's order.
NUMBERS = ("x", "y", "z", "ixx", "ixy", "ixz", "iyy", "iyz", "izz")
# Numbers of three digits agree to within the first share of them; below the second, of the greatest, they are noise.
_TYPED, _NOISE = 5e-3, 1e-6
# Directions in which the reach of two hulls is compared: about 12° apart.
_DIRECTIONS = 256
# Pairs of points that a plane carries onto each other, of all pairs, for it to be a mirror plane of them.
_MIRRORED_SHARE = 0.6
# This many pairs do not agree on a plane along the axes by chance.
_MIN_PAIRS = 2
# Points (m) that were typed as mirror images are mirrored to within the rounding of sums.
_EXACT = 1e-6
# A plane that leans by less (cosine of 10°) from one of the preferred ones has to mirror two places: one pair that is a few
# millimetres off spans a leaning plane by itself, and what hangs on it agrees.
_LEANS_LESS, _MIN_PLACES = 0.985, 2
# Pairs whose own direction and midpoint are tried, to limit the time.
_MAX_TRIED_PAIRS = 64


@dataclass(frozen=True, slots=True, eq=False)
class MirrorPlane:
    """The points x with ``normal · x = offset`` (m); the normal (3,) is a unit vector."""

    normal: Vec3
    offset: float

    @property
    def linear(self) -> Mat3:
        """(3, 3), the reflection of directions, ``1 - 2 n nᵀ``."""
        reflection: Array = np.eye(3) - 2.0 * np.outer(self.normal, self.normal)
        return reflection

    def reflect_points(self, points: ArrayLike) -> Array:
        """Return the mirror images of points (..., 3)."""
        place = np.asarray(points, dtype=float)
        mirrored: Array = place @ self.linear + 2.0 * self.offset * self.normal
        return mirrored

    def relate_frames(self, one: ArrayLike, other: ArrayLike) -> tuple[Mat3, Vec3]:
        """Compute ``linear`` (3, 3) and ``shift`` (3,), which map coordinates in frame ``one`` (4, 4) to those of the mirror
        image in frame ``other`` (4, 4)."""
        first, second = np.asarray(one, dtype=float), np.asarray(other, dtype=float)
        linear = second[:3, :3].T @ self.linear @ first[:3, :3]
        shift = second[:3, :3].T @ (self.reflect_points(first[:3, 3]) - second[:3, 3])
        return linear, shift


@dataclass(frozen=True, eq=False)
class PartOutline:
    """The shape of a part, in its own frame (m)."""

    centroid: Vec3
    """Of the surface."""
    covariance: Mat3
    """Of the surface."""
    points: Array
    """(K, 3), with the convex hull of the part."""

    @property
    def radius(self) -> float:
        """Root mean square distance (m) of the surface from its centroid."""
        return float(np.sqrt(max(0.0, np.trace(self.covariance))))

    @cached_property
    def reach(self) -> Array:
        """Reach (n,) in m from the origin of the frame in each direction of `spread_directions_and_axes`."""
        farthest: Array = (self.points @ spread_directions_and_axes(_DIRECTIONS).T).max(axis=0)
        return farthest


def find_mirror_plane(
    ones: ArrayLike, others: ArrayLike, normals: Sequence[Vec3], *, tolerance: float
) -> tuple[MirrorPlane, int] | None:
    """Find the plane that mirrors most of the points ``ones`` (n, 3) onto ``others`` (n, 3), and how many.

    Its normal is one of ``normals``, in the order of preference, or else the main direction of the differences, or that of one
    of them; its offset is the median of the midpoints, or that of one of them. A pair counts if its points are apart and the
    image is within ``tolerance`` (m); of planes with equally many, the first with the most exact images is taken: a body that is
    rotated by 1.57 for π/2 is symmetric in its own axes only. None if fewer than 60 % of the pairs that are apart agree, or,
    with one of ``normals``, fewer than two: one misplaced joint moves all its descendants. A plane that leans from one of
    ``normals`` by less than 10° and mirrors one place only gives way to the latter.
    """
    first, second = np.asarray(ones, dtype=float), np.asarray(others, dtype=float)
    apart = np.linalg.norm(second - first, axis=1) > tolerance
    if not apart.any():
        return None
    first, second = first[apart], second[apart]
    differences, middles = second - first, (first + second) / 2.0
    main = np.linalg.svd(differences)[2][0]
    along = (main, *(differences / np.linalg.norm(differences, axis=1)[:, None])[:_MAX_TRIED_PAIRS])
    upwards = [direction * np.sign(direction[np.abs(direction).argmax()]) for direction in along]
    for directions, least in (
        (normals, _MIRRORED_SHARE * len(first)),
        (normals, _MIN_PAIRS),
        (upwards, _MIRRORED_SHARE * len(first)),
    ):
        best: tuple[MirrorPlane, int] | None = None
        most = (0, 0)
        for normal in directions:
            separated = np.abs(differences @ normal) > tolerance
            heights = (middles @ normal)[separated]
            for offset in dict.fromkeys((compute_median(heights), *heights[:_MAX_TRIED_PAIRS])) if len(heights) else ():
                plane = MirrorPlane(normal, float(offset))
                errors = np.linalg.norm(plane.reflect_points(first) - second, axis=1)
                count, exact = (int(((errors <= limit) & separated).sum()) for limit in (tolerance, _EXACT))
                if count >= least and (count, exact) > most:
                    best, most = (plane, count), (count, exact)
        if best is not None:
            return (
                best if directions is normals else _straighten_plane(best, first, second, normals, tolerance=tolerance)
            )
    return None


def _straighten_plane(
    found: tuple[MirrorPlane, int], first: Array, second: Array, normals: Sequence[Vec3], *, tolerance: float
) -> tuple[MirrorPlane, int]:
    """Return the plane across one of ``normals`` instead of one that leans from it and mirrors one place only."""
    plane, _ = found
    normal = next((n for n in normals if _LEANS_LESS < abs(float(n @ plane.normal)) < 1.0), None)
    if normal is None:
        return found
    mirrored = np.linalg.norm(plane.reflect_points(first) - second, axis=1) <= tolerance
    places = {tuple(np.round(pair / tolerance)) for pair in np.hstack((first, second))[mirrored]}
    if len(places) >= _MIN_PLACES:
        return found
    heights = (first + second)[mirrored] @ normal / 2.0
    straight = MirrorPlane(normal, compute_median(heights))
    errors = np.linalg.norm(straight.reflect_points(first) - second, axis=1)
    return straight, int((errors <= tolerance).sum())


def measure_outline_mismatch(
    one: PartOutline, other: PartOutline, *, linear: ArrayLike, shift: ArrayLike, limit: float = math.inf
) -> float:
    """Measure how far ``one`` under ``x -> linear x + shift`` is from ``other``, relative to the size of the latter.

    The greatest of the differences of the centroids, of the hulls' reach in any direction (both over the root mean square
    radius), and half that of the covariances (over their trace). Infinite for a part without extent. From ``limit`` on it may be
    less than that, but not below the limit: to compare the hulls takes most of the time.
    """
    turn, move = np.asarray(linear, dtype=float), np.asarray(shift, dtype=float)
    size = other.radius
    if not size > 0.0:
        return math.inf
    centroid = float(np.linalg.norm(turn @ one.centroid + move - other.centroid)) / size
    spread = float(np.linalg.norm(turn @ one.covariance @ turn.T - other.covariance)) / (2.0 * size**2)
    least = max(centroid, spread)
    if least >= limit:
        return least
    directions = spread_directions_and_axes(_DIRECTIONS)
    # A point x reaches d·(T x + t) = (Tᵀ d)·x + d·t.
    reach = (one.points @ (directions @ turn).T).max(axis=0) + directions @ move - other.reach
    return max(least, float(np.abs(reach).max()) / size)


@dataclass(frozen=True, slots=True)
class InertialDeviation:
    """How far one inertial is from another in the same axes; all without a unit."""

    mass: float
    """Relative difference of the masses."""
    com_offset: float
    """Distance of the COMs over the radius of gyration."""
    spread: float
    """Difference of the mass covariances over twice their trace, so that it is a share of a length."""

    @property
    def worst(self) -> float:
        return max(self.mass, self.com_offset, self.spread)


def measure_deviation(actual: DeclaredInertial, expected: DeclaredInertial) -> InertialDeviation:
    """Measure how far ``actual`` is from ``expected``; infinite for a point mass."""
    size = float(np.trace(expected.inertia)) / (2.0 * expected.mass)
    if not size > 0.0:
        return InertialDeviation(mass=math.inf, com_offset=math.inf, spread=math.inf)
    spread = compute_mass_covariance(actual.inertia, actual.mass) - compute_mass_covariance(
        expected.inertia, expected.mass
    )
    return InertialDeviation(
        mass=abs(actual.mass - expected.mass) / max(actual.mass, expected.mass),
        com_offset=float(np.linalg.norm(actual.com - expected.com)) / math.sqrt(size),
        spread=float(np.linalg.norm(spread)) / (2.0 * size),
    )


def are_alike_when_spun(one: DeclaredInertial, other: DeclaredInertial, axis: ArrayLike, threshold: float) -> bool:
    """Whether two inertials are one part at two angles about a unit ``axis`` (3,) through the origin that holds both COMs.

    ``threshold``: as a share of a mass, or of a length relative to the radius of gyration.
    """
    along = np.asarray(axis, dtype=float)
    size = math.sqrt(max(0.0, float(np.trace(other.inertia))) / (2.0 * other.mass))
    if any(float(np.linalg.norm(np.cross(along, part.com))) > threshold * size for part in (one, other)):
        return False
    across = np.linalg.svd(along[None, :])[2][1:]
    across[1] *= math.copysign(1.0, float(np.cross(*across) @ along))
    angles = []
    for part in (one, other):
        (p, q), (_, r) = across @ part.inertia @ across.T
        angles.append(math.atan2(2.0 * q, p - r) / 2.0)
    # Principal axes have no sense: half a turn more gives the same ones.
    turns = angles[0] - angles[1] + np.array((0.0, math.pi))
    return any(
        measure_deviation(one, DeclaredInertial(other.mass, other.com, turn @ other.inertia @ turn.T)).worst
        <= threshold
        for turn in compute_joint_motions(along, turns, rotates=True)[:, :3, :3]
    )


def measure_principal_deviation(actual: DeclaredInertial, expected: DeclaredInertial) -> InertialDeviation:
    """Compare two inertials independently of their axes, by mass and principal covariances. ``com_offset`` is 0."""
    size = float(np.trace(expected.inertia)) / (2.0 * expected.mass)
    if not size > 0.0:
        return InertialDeviation(mass=math.inf, com_offset=0.0, spread=math.inf)
    variances = [
        np.linalg.eigvalsh(compute_mass_covariance(numbers.inertia, numbers.mass)) for numbers in (actual, expected)
    ]
    mass = abs(actual.mass - expected.mass) / max(actual.mass, expected.mass)
    spread = float(np.linalg.norm(variances[0] - variances[1])) / (2.0 * size)
    return InertialDeviation(mass=mass, com_offset=0.0, spread=spread)


def find_wrong_signs(actual: DeclaredInertial, expected: DeclaredInertial, rel_tol: float) -> tuple[str, ...]:
    """Find the coordinates of the COM (``x``) and products of inertia (``ixy``) that are right except for their signs, if nothing
    else is wrong; empty otherwise. ``rel_tol``: how closely numbers agree, relative to the radius of gyration and the trace. If
    one of them is wrong, so are smaller ones that are each other's negative to within their digits."""
    size = math.sqrt(float(np.trace(expected.inertia)) / (2.0 * expected.mass))
    unit = np.array([size] * 3 + [expected.mass * size**2] * 6)
    typed, wanted = (np.concatenate((n.com, n.inertia[np.triu_indices(3)])) / unit for n in (actual, expected))
    wrong = np.abs(typed - wanted) > rel_tol
    signed = np.abs(typed + wanted) <= rel_tol
    if not (wrong <= signed).all():
        return ()
    if wrong.any():
        wrong |= (np.abs(typed + wanted) <= _TYPED * np.abs(wanted)) & (np.abs(wanted) > _NOISE)
    return tuple(name for name, is_wrong in zip(NUMBERS, wrong, strict=True) if is_wrong)


def mirror_range(lower: float, upper: float, along: float, *, rotates: bool) -> tuple[float, float]:
    """Return the limits of the mirror image of a joint. ``along``: scalar product of the image of its axis and the other axis.

    An axis of rotation is a pseudovector: the image of a turn by q about a is one by -q about a's image. That of a slide is not.
    """
    same = (along < 0.0) if rotates else (along > 0.0)
    return (lower, upper) if same else (-upper + 0.0, -lower + 0.0)
