"""How well inertials fit a reference: the part that a link draws, or the numbers of the link's twin.

A part of uniform density has the COM and the second moments of its mesh. A part with a motor or a battery inside differs from
them, but not without limit: a mixture of distributions, from CAD parts of one material to parts with most of their mass in
lumps, gives the likelihood of each mismatch.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial, VisualGeometry
from urdfcheck.facts.inertials.inertia_tensor import compute_mass_covariance
from urdfcheck.facts.sphere_directions import spread_directions

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from urdfcheck.facts.arrays import Array, Bools, Indices, Mat3, Vec3

# How real parts differ from their uniform solid: weight, spread of the log-Euclidean mismatch of the second moments (6
# degrees of freedom) and of the COM (3) in radii of gyration. CAD parts of one material; parts with 5 to 60 % of their mass in
# lumps; and anything (1 in 50). These mixtures, the priors of the mistakes and the thresholds of the diagnosis were chosen on
# the parts that benchmarks/accuracy keeps for tuning, and are judged on others.
CLOSED_MIXTURE = (
    (0.25, 0.003, 0.003),
    (0.15, 0.02, 0.015),
    (0.20, 0.15, 0.12),
    (0.24, 0.35, 0.30),
    (0.14, 0.70, 0.55),
    (0.02, 1.6, 1.3),
)
# Nothing is exact in comparison with the convex hull of an open mesh.
OPEN_MIXTURE = ((0.25, 0.10, 0.08), (0.30, 0.30, 0.25), (0.25, 0.45, 0.40), (0.16, 0.80, 0.60), (0.04, 1.6, 1.3))
# How equal parts differ: typed digits, another revision, anything.
TWIN_MIXTURE = ((0.70, 0.002, 0.002), (0.20, 0.05, 0.05), (0.10, 1.2, 1.0))
# How a tensor that was computed from the geometry differs from it: typed digits, tessellation. Weight and spread.
_COMPUTED_MIXTURE = ((0.7, 0.003), (0.3, 0.03))

# Densities are log-normal about this (kg/m³), with heavy tails.
TYPICAL_DENSITY = 1500.0
LOG_SQRT_2PI = 0.5 * math.log(2.0 * math.pi)

# What typed digits and simplified meshes leave: a tenth of a bound.
SLACK = 0.1
# Ratios of second moments below this belong to a flat part.
_FLAT = 1e-4
# One in twenty links has something heavy that is not drawn.
_NOT_DRAWN = 3.0
# Logarithm of the width of the range in which a degree of freedom that is taken from the reference could have been.
_TYPICAL = 0.3
# No robot has SI numbers above this, or sizes and masses below its inverse.
_LARGEST = 1e30
_DIRECTIONS = 96
# Points that are projected at a time: the heights stay in the processor's cache, which takes a thirtieth of the time.
_CHUNK = 4096


@dataclass(frozen=True, eq=False, kw_only=True)
class Reference:
    """The body that numbers are compared with."""

    com: Vec3
    """In m, in the link's frame."""
    covariance: Mat3
    """Second moments of the mass in m² about the COM."""
    size: float
    """A volume (m³) or, of a twin, a mass (kg)."""
    mixture: Sequence[tuple[float, float, float]]
    """How sound parts differ from the reference: weight, spread of the tensor's and of the COM's mismatch."""
    points: Array | None = None
    """(K, 3): nothing of the part is outside their convex hull; None where the geometry is unknown."""
    twin: DeclaredInertial | None = None
    """The twin's numbers in this link's frame, if these are the reference."""

    @cached_property
    def whitening(self) -> Mat3:
        return compute_whitening(self.covariance)


@dataclass(frozen=True, slots=True, eq=False)
class InertialBatch:
    """Inertials as arrays."""

    mass: Array
    """(N,)"""
    com: Array
    """(N, 3)"""
    tensor: Array
    """(N, 3, 3)"""
    rotation: Array
    """(N, 3, 3)"""

    @classmethod
    def from_inertials(cls, declared: Sequence[DeclaredInertial]) -> InertialBatch:
        return cls(
            mass=np.array([d.mass for d in declared], dtype=float),
            com=np.array([d.com for d in declared], dtype=float).reshape(-1, 3),
            tensor=np.array([d.tensor for d in declared], dtype=float).reshape(-1, 3, 3),
            rotation=np.array([d.rotation for d in declared], dtype=float).reshape(-1, 3, 3),
        )

    def __getitem__(self, i: int) -> DeclaredInertial:
        return DeclaredInertial(
            mass=float(self.mass[i]), com=self.com[i], tensor=self.tensor[i], rotation=self.rotation[i]
        )

    def take_rows(self, order: NDArray[np.intp]) -> InertialBatch:
        return InertialBatch(
            mass=self.mass[order], com=self.com[order], tensor=self.tensor[order], rotation=self.rotation[order]
        )

    def concatenate_with(self, other: InertialBatch) -> InertialBatch:
        return InertialBatch(
            mass=np.concatenate((self.mass, other.mass)),
            com=np.concatenate((self.com, other.com)),
            tensor=np.concatenate((self.tensor, other.tensor)),
            rotation=np.concatenate((self.rotation, other.rotation)),
        )

    @property
    def inertia(self) -> Array:
        """(N, 3, 3) about the COM in the link's axes."""
        turned: Array = self.rotation @ self.tensor @ self.rotation.transpose(0, 2, 1)
        return turned

    def find_equal_rows(self, i: int) -> Bools:
        """Return which rows (N,) equal row ``i`` to within 1 %: of the mass, of the greatest entry of the tensor, and of the
        COM's distance from the origin or the radius of gyration."""
        inertia = self.inertia
        radius = math.sqrt(abs(float(np.trace(inertia[i])) / (2.0 * self.mass[i])))
        reach = max(float(np.abs(self.com[i]).max()), radius)
        equal: Bools = (
            (np.abs(self.mass - self.mass[i]) <= 0.01 * self.mass[i])
            & (np.abs(inertia - inertia[i]).max(axis=(1, 2)) <= 0.01 * np.abs(inertia[i]).max())
            & (np.abs(self.com - self.com[i]).max(axis=1) <= 0.01 * reach)
        )
        return equal


@dataclass(frozen=True, slots=True, eq=False)
class InertialFit:
    """How far the inertials of a batch are from a reference."""

    tensor_mismatch: Array
    """(N,), see `measure_inertial_mismatch`; infinite for a tensor that no body has."""
    com_mismatch: Array
    """(N,), in radii of gyration."""
    log_size: Array
    """(N,), logarithm of the mass over the reference's size: of a density (kg/m³), or of a ratio of masses."""
    inside: Bools
    """(N,), whether a mass inside the drawn geometry can have the numbers."""

    def take_rows(self, order: NDArray[np.intp]) -> InertialFit:
        return InertialFit(
            tensor_mismatch=self.tensor_mismatch[order],
            com_mismatch=self.com_mismatch[order],
            log_size=self.log_size[order],
            inside=self.inside[order],
        )


def build_geometry_reference(geometry: VisualGeometry) -> Reference:
    return Reference(
        com=geometry.solid.com,
        covariance=geometry.solid.covariance,
        size=geometry.solid.volume,
        mixture=CLOSED_MIXTURE if geometry.closed else OPEN_MIXTURE,
        points=_select_outermost_points(geometry.points),
    )


def build_twin_reference(twin: DeclaredInertial) -> Reference:
    return Reference(
        com=twin.com,
        covariance=compute_mass_covariance(twin.inertia, twin.mass),
        size=twin.mass,
        mixture=TWIN_MIXTURE,
        twin=twin,
    )


def is_body(numbers: DeclaredInertial) -> bool:
    """Whether a solid body can have such numbers, so that others can be compared with them."""
    if not is_computable(numbers):
        return False
    covariance = compute_mass_covariance(numbers.inertia, numbers.mass)
    variances = np.linalg.eigvalsh(covariance)
    return bool(variances[0] > -1e-6 * variances[-1]) and has_computable_size(numbers.com, covariance)


def is_computable(numbers: DeclaredInertial) -> bool:
    """Whether there is a mass, and nothing that is computed from the numbers overflows."""
    largest = np.abs(np.concatenate((numbers.com, numbers.tensor.ravel()))).max()  # NaN if there is one
    return bool(1.0 / _LARGEST <= numbers.mass <= _LARGEST and largest <= _LARGEST)


def has_computable_size(com: Vec3, covariance: Mat3) -> bool:
    """Whether other second moments can be expressed as multiples of these."""
    variance, reach = float(np.trace(covariance)), float(np.abs(com).max())
    return 1.0 / _LARGEST <= variance <= _LARGEST and reach <= _LARGEST


def measure_inertial_mismatch(declared: DeclaredInertial, com: Vec3, covariance: Mat3) -> tuple[float, float]:
    """Measure how far an inertial is from a reference: the log-Euclidean distance of the second moments, ``|log W C W|`` with
    ``W`` the inverse root of the reference's ``covariance`` (3, 3), and the distance of the COMs in its radii of gyration,
    ``|W (c - com)|``.

    Infinite for a tensor that no body has.
    """
    white = compute_whitening(covariance)
    ratios = np.linalg.eigvalsh(white @ compute_mass_covariance(declared.inertia, declared.mass) @ white)
    com_mismatch = float(np.linalg.norm(white @ (declared.com - com)))
    if not _is_possible_spread(ratios):
        return math.inf, com_mismatch
    return float(np.linalg.norm(np.log(np.maximum(ratios, _FLAT)))), com_mismatch


def compute_whitening(covariance: Mat3) -> Mat3:
    """Return the (3, 3) that turns a covariance into the identity, no direction shorter than 2 % of the longest."""
    variances, axes = np.linalg.eigh(covariance)
    floored = np.maximum(variances, 4e-4 * variances[-1])
    white: Mat3 = (axes / np.sqrt(floored)) @ axes.T
    return white


def compute_min_moment_ratio(declared: DeclaredInertial, reference: Reference) -> float:
    """Compute the smallest ratio of a second moment about the COM to the reference's; negative for an impossible tensor."""
    white = reference.whitening
    return float(np.linalg.eigvalsh(white @ compute_mass_covariance(declared.inertia, declared.mass) @ white)[0])


def _is_possible_spread(ratios: NDArray[np.floating[Any]]) -> Bools:
    """Whether second moments (..., 3), ascending and relative to a reference's, are those of a mass: one that rounding makes a
    little negative belongs to a flat part; no part has -0.1 of the reference's."""
    spread: Bools = ratios[..., 0] > -SLACK * np.maximum(1.0, ratios[..., 2])
    return spread


def measure_fit(reference: Reference, numbers: InertialBatch, factor: Array) -> InertialFit:
    """Measure how far the ``numbers`` are from a reference that is enlarged ``factor`` (N,) times."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        specific = numbers.inertia / numbers.mass[:, None, None]
        covariance = 0.5 * np.trace(specific, axis1=1, axis2=2)[:, None, None] * np.eye(3) - specific
        covariance = covariance / (factor**2)[:, None, None]
        com = numbers.com / factor[:, None]
        white = reference.whitening
        usable = np.isfinite(covariance).all(axis=(1, 2)) & (numbers.mass > 0)
        covariance[~usable] = np.eye(3)
        ratios = np.linalg.eigvalsh(white @ covariance @ white)
        usable &= _is_possible_spread(ratios)
        floored = np.maximum(ratios, _FLAT)
        tensor_mismatch = np.where(usable, np.linalg.norm(np.log(floored), axis=1), np.inf)
        com_mismatch = np.linalg.norm((com - reference.com) @ white, axis=1)
        log_size = np.log(numbers.mass / (reference.size * factor ** (0 if reference.twin is not None else 3)))
    inside = usable.copy()
    if reference.points is not None:
        variances, axes = np.linalg.eigh(covariance[usable])
        inside[usable] = _can_hold_mass(reference.points, com=com[usable], variances=variances, axes=axes)
    return InertialFit(tensor_mismatch=tensor_mismatch, com_mismatch=com_mismatch, log_size=log_size, inside=inside)


def _can_hold_mass(points: Array, *, com: Array, variances: Array, axes: Array) -> Bools:
    """Whether (N,) a mass within the convex hull of ``points`` (K, 3) can have the ``com`` (N, 3) and the ``variances``
    (N, 3) along ``axes`` (N, 3, 3): along each, ``(max - c)(c - min)`` is the most (Bhatia and Davis, *A better bound on the
    variance*, 2000)."""
    along = (points @ axes.transpose(1, 0, 2).reshape(3, -1)).reshape(len(points), -1, 3)  # one product of matrices
    center = np.einsum("nj,njd->nd", com, axes)
    high, low = along.max(axis=0) - center, along.min(axis=0) - center
    slack = SLACK * (high - low)
    bound = (1.0 + SLACK) * (high + slack) * (slack - low)
    inside: Bools = ((high > -slack) & (low < slack) & (variances <= bound)).all(axis=1)
    return inside


def compute_log_likelihood(
    reference: Reference, fit: InertialFit, *, borrowed: Array | Indices, is_other_body: Bools
) -> Array:
    """Compute the logarithm (N,) of how likely a part of this shape has such numbers.

    ``borrowed`` (N, 2): degrees of freedom of the tensor and of the COM that were taken from the reference to undo a mistake.
    They prove nothing and count as typical (`_TYPICAL` each), whatever their value. ``is_other_body`` (N,): the mismatch is
    that from another body, whose numbers were taken for the part's.
    """
    free_tensor, free_com = 6 - borrowed[:, 0], 3 - borrowed[:, 1]
    with np.errstate(invalid="ignore", over="ignore"):
        tensor_squared, com_squared = fit.tensor_mismatch**2, fit.com_mismatch**2
        terms = [
            (
                math.log(weight),
                _compute_log_normal(tensor_squared, free_tensor, tensor_spread),
                _compute_log_normal(com_squared, free_com, com_spread),
            )
            for weight, tensor_spread, com_spread in reference.mixture
        ]
    of_part = np.logaddexp.reduce([log_weight + tensor + com for log_weight, tensor, com in terms], axis=0)
    # The tensor of another body is independent of the COM beside it. It was computed, not measured: it either agrees with that
    # body to its digits and the tessellation, or is not its tensor.
    computed = np.logaddexp.reduce(
        [
            math.log(w) - free_tensor * (math.log(spread) + LOG_SQRT_2PI) - tensor_squared / (2 * spread * spread)
            for w, spread in _COMPUTED_MIXTURE
        ],
        axis=0,
    )
    of_other_body = computed + np.logaddexp.reduce([log_weight + com for log_weight, _, com in terms], axis=0)
    # Only the broadest component explains what cannot be inside the drawn geometry: something is not drawn.
    log_weight, widest_tensor, widest_com = terms[-1]
    of_undrawn = log_weight + widest_tensor + widest_com - _NOT_DRAWN
    scores = np.where(fit.inside, np.where(is_other_body, of_other_body, of_part), of_undrawn)
    scores = scores - _TYPICAL * (borrowed[:, 0] + borrowed[:, 1])
    return np.where(np.isfinite(fit.tensor_mismatch), scores + _compute_log_size_likelihood(reference, fit), -np.inf)


def _compute_log_normal(squared: Array, degrees: Array | Indices, spread: float) -> Array:
    """Compute the logarithm of the density of a normal distribution of ``degrees`` dimensions at a ``squared`` distance."""
    density: Array = -degrees * (math.log(spread) + LOG_SQRT_2PI) - squared / (2 * spread * spread)
    return density


def _compute_log_size_likelihood(reference: Reference, fit: InertialFit) -> Array:
    """Compute the logarithm (N,) of how likely the mass is: 19 of 20 twins agree to 0.1 %, the others to a factor of e³;
    densities are log-normal about `TYPICAL_DENSITY` with heavy tails (Student's t with 8 degrees of freedom)."""
    if reference.twin is not None:
        squared = fit.log_size**2
        same = math.log(0.95) - np.log(1e-3) - squared / 2e-6
        other: Array = np.logaddexp(same, math.log(0.05) - np.log(3.0) - squared / 18.0)
        return other
    z = (fit.log_size - math.log(TYPICAL_DENSITY)) / 0.9
    likelihood: Array = -4.5 * np.log1p(z * z / 8.0)
    return likelihood


def _select_outermost_points(points: Array) -> Array:
    """Return the outermost of the points in evenly spread directions: their hull lies just inside."""
    if len(points) <= _DIRECTIONS:
        return points
    directions = spread_directions(_DIRECTIONS)
    rows, farthest, places = np.arange(_DIRECTIONS), np.full(_DIRECTIONS, -np.inf), np.zeros(_DIRECTIONS, dtype=int)
    for start in range(0, len(points), _CHUNK):
        heights = directions @ points[start : start + _CHUNK].T
        highest = heights.argmax(axis=1)
        is_farther = heights[rows, highest] > farthest
        farthest[is_farther] = heights[rows, highest][is_farther]
        places[is_farther] = start + highest[is_farther]
    outermost: Array = points[sorted(set(places.tolist()))]  # numpy's unique would load its module for masked arrays
    return outermost
