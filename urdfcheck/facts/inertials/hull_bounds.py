"""Bounds that the convex hull of drawn geometry sets for any mass inside it, whatever its density."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from urdfcheck.facts.arrays import Array


# Steps of Wolfe's algorithm; in three dimensions it needs about ten.
_STEPS = 100
# Variances that agree to this share have no axes of their own: a rotation in five digits mixes them at will.
_EQUAL = 1e-3


def measure_extent(points: ArrayLike) -> float:
    """Measure the size of ``points`` (K, 3): the diameter of the least sphere about their mean that contains them.

    Unlike that of a bounding box it is the same in every frame.
    """
    corners = np.asarray(points, dtype=float)
    return 2.0 * float(np.linalg.norm(corners - corners.mean(axis=0), axis=1).max())


def measure_hull_distance(points: ArrayLike, point: ArrayLike, rel_tol: float = 1e-6) -> float:
    """Measure the distance from ``point`` (3,) to the convex hull of ``points`` (K, 3); 0 when it is inside.

    Exact to ``rel_tol`` of the farthest point's distance. The nearest point of the hull is found as the one of a corner, an
    edge, a triangle or a tetrahedron of its points, which are exchanged until none is nearer (Wolfe, *Finding the nearest point
    in a polytope*, 1976).
    """
    corners = np.asarray(points, dtype=float) - np.asarray(point, dtype=float)
    squares = np.einsum("ij,ij->i", corners, corners)
    tolerance = rel_tol * float(squares.max()) ** 0.5
    chosen = [int(squares.argmin())]
    weights = np.ones(1)
    nearest = corners[chosen[0]]
    for _ in range(_STEPS):
        distance = float(np.linalg.norm(nearest))
        if distance <= tolerance:
            return 0.0
        along = corners @ nearest
        farther = int(along.argmin())
        # The plane through the nearest point, across its direction, has every corner behind it, or nearly so.
        if distance - float(along[farther]) / distance <= tolerance or farther in chosen:
            return distance
        chosen.append(farther)
        weights = np.append(weights, 0.0)
        while True:
            best = _solve_nearest_weights(corners[chosen])
            if (best > 0.0).all():
                weights = best
                break
            # Move towards the best as far as all weights stay positive, and drop the corner whose weight reaches zero.
            falling = best <= 0.0
            steps = np.full(len(best), np.inf)
            steps[falling] = weights[falling] / np.maximum(weights[falling] - best[falling], 1e-300)
            first = int(steps.argmin())
            weights = np.delete(weights + steps[first] * (best - weights), first)
            del chosen[first]
        nearest = weights @ corners[chosen]
    return float(np.linalg.norm(nearest))


def _solve_nearest_weights(corners: Array) -> Array:
    """Compute the weights (n,), of sum 1, of the point nearest to the origin in the flat through ``corners`` (n, 3)."""
    first = corners[0]
    weights = np.linalg.lstsq((corners[1:] - first).T, -first, rcond=None)[0]
    return np.concatenate(((1.0 - weights.sum(),), weights))


def compute_spread_ratios(
    points: ArrayLike, com: ArrayLike, covariance: ArrayLike, margin: float = 0.0
) -> tuple[Array, Array]:
    """Compute how much farther a mass spreads than it can inside the hull of ``points`` (K, 3), and along which directions.

    Ratios (3,) of the variance along each principal axis of ``covariance`` (3, 3), the mean of ``(x - com)(x - com)ᵀ``, to the
    greatest of any distribution with this ``com`` (3,) within the hull: ``(max - c)(c - min)`` (Bhatia and Davis, *A
    better bound on the variance*, 2000). Above 1 no mass inside has it; infinite where the COM is not between the points.
    The hull may be ``margin`` (m) larger on all sides. The directions are the columns of the (3, 3) array. Where variances are
    equal, any directions between theirs are principal: those of the hull then count if they say more.
    """
    spread = np.asarray(covariance, dtype=float)
    corners = np.asarray(points, dtype=float) - np.asarray(com, dtype=float)
    variances, axes = np.linalg.eigh(spread)
    ratios = _divide_by_bounds(corners, variances, axes, margin)
    turned = _align_equal_axes(corners, variances, axes)
    if turned is not None:
        other = _divide_by_bounds(corners, np.einsum("ij,ik,kj->j", turned, spread, turned), turned, margin)
        if other.max() > ratios.max():
            return other, turned
    return ratios, axes


def _divide_by_bounds(corners: Array, variances: Array, axes: Array, margin: float) -> Array:
    """Compute the ratios (3,) of ``variances`` (3,) along the columns of ``axes`` (3, 3) to their bounds about the origin inside
    the hull of ``corners`` (K, 3)."""
    along = corners @ axes
    above, below = along.max(axis=0) + margin, margin - along.min(axis=0)
    bound = np.maximum(above, 0.0) * np.maximum(below, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios: Array = np.where(bound > 0.0, variances / bound, np.where(variances > 0.0, np.inf, 0.0))
    return ratios


def _align_equal_axes(corners: Array, variances: Array, axes: Array) -> Array | None:
    """Turn principal ``axes`` (3, 3) of equal ``variances`` (3,, ascending) among themselves to the principal axes of ``corners``
    (K, 3); None where all variances differ."""
    apart = np.flatnonzero(np.diff(variances) > _EQUAL * abs(variances[-1])) + 1
    groups = np.split(np.arange(3), apart)
    if len(groups) == 3:
        return None
    centred = corners - corners.mean(axis=0)
    turned: Array = axes.copy()
    for group in groups:
        if len(group) > 1:
            flat = centred @ axes[:, group]
            turned[:, group] = axes[:, group] @ np.linalg.eigh(flat.T @ flat)[1]
    return turned


def is_possible_elsewhere(points: ArrayLike, covariance: ArrayLike, ratio: float = 1.0, margin: float = 0.0) -> bool:
    """Whether a mass inside the hull of ``points`` (K, 3) may have a ``covariance`` (3, 3, m²) about another COM, as far as its
    principal axes say: no variance along them is more than ``ratio`` times half the extent squared (Popoviciu's bound), the hull
    being ``margin`` (m) larger on all sides. Where variances are equal, the principal axes of the hull count, too."""
    spread, corners = np.asarray(covariance, dtype=float), np.asarray(points, dtype=float)
    variances, axes = np.linalg.eigh(spread)
    turned = _align_equal_axes(corners, variances, axes)
    for directions in (axes, axes if turned is None else turned):
        half = 0.5 * np.ptp(corners @ directions, axis=0) + margin
        if not (np.einsum("ij,ik,kj->j", directions, spread, directions) <= ratio * half * half).all():
            return False
    return True


def has_excess_moment(points: ArrayLike, com: ArrayLike, covariance: ArrayLike, margin: float = 0.0) -> bool:
    """Whether a principal moment is greater than that of any mass inside the hull of ``points`` (K, 3) with this ``com`` (3,): a
    moment is the sum of two variances, each of which may be too great beside one that is too small, and no mass is farther from
    the moment's axis than the farthest point. The arguments are those of `compute_spread_ratios`."""
    ratios, axes = compute_spread_ratios(points, com, covariance, margin)
    variances = np.einsum("ij,ik,kj->j", axes, np.asarray(covariance, dtype=float), axes)
    if not np.isfinite(ratios).all() or not (ratios > 0.0).all():
        return True
    bounds = variances / ratios
    squares = ((np.asarray(points, dtype=float) - np.asarray(com, dtype=float)) @ axes) ** 2
    farthest = np.sqrt((squares.sum(axis=1, keepdims=True) - squares).max(axis=0)) + margin
    return bool((variances.sum() - variances > np.minimum(bounds.sum() - bounds, farthest**2)).any())
