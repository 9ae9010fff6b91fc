"""Inertia tensors: validity, the effect of typed digits, solids with closed-form moments.

Inertia tensors are (3, 3) in kg m² about the COM, with URDF's signs (``Ixy = -∫ xy dm``). A body's shape is described
by its covariance, the mean of ``(x - com)(x - com)ᵀ``, which needs no density: ``I = m (tr(C) 1 - C)``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import Decimal, InvalidOperation
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.small_matrices import compute_excess

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from urdfcheck.facts.arrays import Array


# Rounding of an eigenvalue solver, relative to the largest eigenvalue: a moment below it is zero.
_EIGEN_ROUNDING = 8 * float(np.finfo(float).eps)


# The places of the six components in the matrix.
_UPPER = np.triu_indices(3)


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """A body of uniform density: ``volume`` (m³), ``com`` (3,) in m, ``covariance`` (3, 3) in m² about the COM."""

    volume: float
    com: Array
    covariance: Array


@dataclass(frozen=True, slots=True, kw_only=True)
class InertiaValidity:
    """Whether a body can have an inertia tensor."""

    finite: bool
    """Whether all six numbers are finite."""
    moments: tuple[float, float, float]
    """Principal moments, ascending (kg m²); NaN unless ``finite``."""
    positive_definite: bool
    excess: float
    """See `compute_triangle_excess`."""
    triangle_inequality: bool
    """Whether ``I1 + I2 >= I3``, with a slack of ``rel_tol I3``; true of the zero tensor of a point mass."""


@dataclass(frozen=True, slots=True)
class TensorRounding:
    """Whether the digits of a typed tensor explain that it is impossible."""

    excess: float
    """`compute_triangle_excess` of the tensor as typed."""
    explained_by_rounding: bool
    """Whether the typed tensor violates the triangle inequality, and one that rounds to the same digits satisfies it."""
    typed_digits: int
    """Significant digits of the largest typed moment."""
    digits: int
    """Significant digits that this moment needs for rounding not to matter."""


def build_inertia_tensor(components: Sequence[float]) -> Array:
    """Build the (3, 3) tensor of URDF's ``ixx ixy ixz iyy iyz izz``."""
    ixx, ixy, ixz, iyy, iyz, izz = components
    return np.array(((ixx, ixy, ixz), (ixy, iyy, iyz), (ixz, iyz, izz)), dtype=float)


def list_inertia_components(inertia: Array) -> list[float]:
    """List URDF's ``ixx ixy ixz iyy iyz izz`` of a (3, 3) tensor: the inverse of `build_inertia_tensor`."""
    components: list[float] = inertia[_UPPER].tolist()
    return components


def compute_principal_moments(inertia: ArrayLike) -> tuple[Array, Array]:
    """Compute the principal moments (3,), ascending, and the principal axes (3, 3) as the columns of a rotation matrix.

    :raises ValueError: when the tensor is not finite.
    """
    moments, axes = _diagonalize(np.asarray(inertia, dtype=float).tobytes())
    return moments.copy(), axes.copy()


@lru_cache(maxsize=1024)
def _diagonalize(inertia: bytes) -> tuple[Array, Array]:
    """Do the same for the bytes of a tensor: many rules ask about each."""
    matrix = np.frombuffer(inertia).reshape(3, 3)
    if not np.isfinite(matrix).all():
        raise ValueError("the inertia tensor is not finite")
    moments, axes = np.linalg.eigh(matrix)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] *= -1.0
    return moments, axes


def compute_principal_frame(inertia: ArrayLike, rel_tol: float = 1e-9) -> tuple[Array, Array]:
    """Compute the `compute_principal_moments` with axes that do not depend on the machine.

    Where moments are equal to within ``rel_tol`` of the largest, one of their axes is as near as possible to an axis of the
    tensor. Any other axis points along its first component that is not small.

    :raises ValueError: when the tensor is not finite.
    """
    moments, axes = compute_principal_moments(inertia)
    slack = rel_tol * float(np.abs(moments).max())
    low, high = moments[1] - moments[0] > slack, moments[2] - moments[1] > slack
    if not low and not high:
        return moments, np.eye(3)
    # The axis of a moment that no other equals, and the next one in cyclic order.
    place = 0 if low else 2
    first, second = _orient_axis(axes[:, place]), _orient_axis(axes[:, (place + 1) % 3])
    if not (low and high):
        nearest = np.eye(3)[int(np.abs(first.round(6)).argmin())]
        second = nearest - (nearest @ first) * first
        second /= np.linalg.norm(second)
    axes = np.column_stack((first, second, np.cross(first, second)))
    return moments, np.roll(axes, place, axis=1)


def _orient_axis(axis: Array) -> Array:
    """Return ``axis`` (3,) or its opposite, so that its first component that is not small is positive."""
    oriented: Array = axis * np.sign(axis[int((np.abs(axis) > 0.1).argmax())])
    return oriented


def compute_triangle_excess(inertia: ArrayLike) -> float:
    """Compute what `compute_excess` does of the moments of a tensor."""
    return compute_excess(compute_principal_moments(inertia)[0].tolist())


def check_inertia_validity(inertia: ArrayLike, rel_tol: float = 1e-9) -> InertiaValidity:
    """Check whether a tensor is finite, is positive definite, and satisfies the triangle inequality to within ``rel_tol``."""
    if not np.isfinite(np.asarray(inertia, dtype=float)).all():
        return InertiaValidity(
            finite=False,
            moments=(math.nan,) * 3,
            positive_definite=False,
            excess=math.nan,
            triangle_inequality=False,
        )
    moments, _ = compute_principal_moments(inertia)
    first, second, third = moments.tolist()
    return InertiaValidity(
        finite=True,
        moments=(first, second, third),
        positive_definite=third > 0.0 and first > _EIGEN_ROUNDING * third,
        excess=compute_excess((first, second, third)),
        triangle_inequality=first + second - third >= -rel_tol * abs(third),
    )


def measure_tensor_rounding(texts: Sequence[str], rel_tol: float = 1e-9) -> TensorRounding:
    """Measure whether rounding explains a violated triangle inequality, and with how many digits it would not.

    ``texts``: ``ixx ixy ixz iyy iyz izz`` as typed. Each means any number within half a unit of its last place; products of
    zero are exact, and a moment of zero was rounded as coarsely as the others. ``digits`` of the result: significant digits with
    which rounding costs at most ``rel_tol`` of the largest moment.

    :raises ValueError: when a text is not a finite number.
    """
    values = [_parse_decimal(text) for text in texts]
    typed = [float(value) for value in values]
    half = list_half_units(texts)
    half = [max(half) if i in (0, 3, 5) and not h else h for i, h in enumerate(half)]
    report = check_inertia_validity(build_inertia_tensor(typed), rel_tol)
    largest = max(abs(values[i]) for i in (0, 3, 5))
    # The slack I1 + I2 - I3 changes by at most 1 for each moment and 2 for both places of a product.
    place = math.floor(float(largest.log10()) + math.log10(rel_tol / 4.5)) if largest else 0
    return TensorRounding(
        excess=report.excess,
        explained_by_rounding=not report.triangle_inequality
        and _can_be_valid_within(np.array(typed), np.array(half), rel_tol),
        typed_digits=largest.adjusted() - _find_last_decimal_place(largest) + 1 if largest else 0,
        digits=min(17, largest.adjusted() - place + 1) if largest else 0,
    )


def list_half_units(texts: Sequence[str]) -> list[float]:
    """List half a unit of the last place of each number as typed, the most that it differs from the number that was rounded;
    zeros are exact.

    Programs write all numbers with as many decimals, or with as many significant digits, and leave out zeros at the end:
    a 1 beside 0.33333333 was not rounded to one digit.

    :raises ValueError: when a text is not a finite number.
    """
    values = [_parse_decimal(text) for text in texts]
    places = [_find_last_decimal_place(v) for v in values if v]
    finest = min(places, default=0)
    significant = max((v.adjusted() - _find_last_decimal_place(v) for v in values if v), default=0)
    return [
        float(f"5e{min(_find_last_decimal_place(v), max(finest, v.adjusted() - significant)) - 1}") if v else 0.0
        for v in values
    ]


def _can_be_valid_within(typed: Array, half: Array, rel_tol: float) -> bool:
    """Whether six numbers within ``half`` of ``typed``, one by one, make a tensor with the triangle inequality.

    The inequality is ``tr(I) - 2 uᵀ I u >= 0`` for every direction u, and each of these is linear in the tensor. Linear
    programming finds the tensor with the greatest slack in the directions seen so far, the directions of its two larger
    moments join them, and so on (Kelley, *The cutting-plane method for solving convex programs*, 1960) until the
    tensor is valid or the directions seen so far rule all tensors out.

    :raises ImportError: when scipy is not installed and one direction does not decide.
    """
    unit = float(half.max())
    rows: list[Array] = []
    nearby = typed
    while unit > 0.0 and len(rows) < 100:
        moments, axes = compute_principal_moments(build_inertia_tensor(nearby.tolist()))
        tolerance = rel_tol * abs(float(moments[2]))
        if moments[0] + moments[1] - moments[2] >= -tolerance:
            return True
        for x, y, z in axes.T[1:]:
            rows.append(np.array((1 - 2 * x * x, -4 * x * y, -4 * x * z, 1 - 2 * y * y, -4 * y * z, 1 - 2 * z * z)))
        # One direction may rule all out by itself, and the solver takes longer to load than everything else here.
        if any(float(row @ typed + np.abs(row) @ half) < -tolerance for row in rows[-2:]):
            return False
        from scipy.optimize import linprog

        # In units of the coarsest rounding, whatever the size of the body: the solver's tolerances are absolute.
        lhs = np.column_stack((-np.array(rows) * half / unit, np.ones(len(rows))))
        best = linprog(
            (*(0.0,) * 6, -1.0), lhs, np.array(rows) @ typed / unit, bounds=[(-1.0, 1.0)] * 6 + [(None, None)]
        )
        if best.status != 0 or best.x[6] * unit < -tolerance:
            return False
        nearby = typed + half * best.x[:6]
    return False


def compute_solid_inertia(solid: Solid, mass: float) -> Array:
    """Compute the inertia tensor (3, 3) in kg m² about the COM of a uniform solid of this mass (kg), in the solid's axes."""
    return compute_covariance_inertia(solid.covariance, mass)


def compute_covariance_inertia(covariance: ArrayLike, mass: float) -> Array:
    """Compute the inertia tensor (3, 3) in kg m² of a mass (kg) with this covariance (3, 3) in m², about its COM."""
    second = np.asarray(covariance, dtype=float)
    result: Array = mass * (np.trace(second) * np.eye(3) - second)
    return result


def compute_parallel_axis_term(mass: float, lever: ArrayLike) -> Array:
    """Compute what the parallel-axis theorem adds to an inertia tensor (3, 3) in kg m² about a point that is ``lever`` (3,) in m
    away from the COM."""
    arm = np.asarray(lever, dtype=float)
    term: Array = mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return term


def compute_mass_covariance(inertia: ArrayLike, mass: float) -> Array:
    """Compute the covariance (3, 3) in m² of a body's mass: the inverse of `compute_covariance_inertia`."""
    specific = np.asarray(inertia, dtype=float) / mass
    result: Array = 0.5 * np.trace(specific) * np.eye(3) - specific
    return result


def make_box_solid(size: Sequence[float]) -> Solid:
    """Make a box of edge lengths ``size`` (m) about its centre."""
    edges = np.asarray(size, dtype=float)
    return Solid(float(edges.prod()), np.zeros(3), np.diag(edges**2 / 12.0))


def make_cylinder_solid(radius: float, length: float) -> Solid:
    """Make a cylinder along z about its centre (m)."""
    across = radius**2 / 4.0
    return Solid(math.pi * radius**2 * length, np.zeros(3), np.diag((across, across, length**2 / 12.0)))


def make_sphere_solid(radius: float) -> Solid:
    """Make a sphere about its centre (m)."""
    return Solid(4.0 / 3.0 * math.pi * radius**3, np.zeros(3), np.eye(3) * radius**2 / 5.0)


def make_capsule_solid(radius: float, length: float) -> Solid:
    """Make a capsule along z about its centre (m): a cylinder of this length with a half sphere on either end."""
    tube, caps = make_cylinder_solid(radius, length), make_sphere_solid(radius)
    volume = tube.volume + caps.volume
    across = (tube.volume * tube.covariance[0, 0] + caps.volume * caps.covariance[0, 0]) / volume
    # The half spheres' centroids are 3/8 r outside the tube's ends: shift their own second moment r²/5 by length/2.
    ends = radius**2 / 5.0 + 3.0 / 8.0 * radius * length + length**2 / 4.0
    along = (tube.volume * tube.covariance[2, 2] + caps.volume * ends) / volume
    return Solid(volume, np.zeros(3), np.diag((across, across, along)))


def transform_solid(solid: Solid, rotation: ArrayLike, translation: ArrayLike) -> Solid:
    """Return the solid in its parent's frame: ``x -> rotation x + translation``."""
    turn = np.asarray(rotation, dtype=float)
    com = turn @ solid.com + np.asarray(translation, dtype=float)
    return Solid(solid.volume, com, turn @ solid.covariance @ turn.T)


def combine_solids(solids: Sequence[Solid]) -> Solid:
    """Combine solids that do not overlap and share one density and frame (parallel-axis theorem).

    :raises ValueError: when their volume is not positive.
    """
    volume = sum(solid.volume for solid in solids)
    if not volume > 0.0:
        raise ValueError("solids without volume have no centre of mass")
    com = np.sum([solid.volume * solid.com for solid in solids], axis=0) / volume
    about_com = [solid.covariance + np.outer(solid.com - com, solid.com - com) for solid in solids]
    moment = np.sum([solid.volume * c for solid, c in zip(solids, about_com, strict=True)], axis=0)
    return Solid(volume, com, moment / volume)


def _parse_decimal(text: str) -> Decimal:
    try:
        value = Decimal(text.strip())
    except InvalidOperation:
        raise ValueError(f"{text!r} is not a number") from None
    if not value.is_finite():
        raise ValueError(f"{text!r} is not finite")
    return value if float(value) else Decimal(0)  # programs read a number too small for a double as zero


def _find_last_decimal_place(value: Decimal) -> int:
    """Return the power of ten of a finite number's last typed digit."""
    return int(value.as_tuple().exponent)
