"""Hulls: distance of a place from them, and what spread a mass inside them can have."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.optimize import nnls

from urdfcheck.facts.inertials.hull_bounds import (
    compute_spread_ratios,
    has_excess_moment,
    measure_extent,
    measure_hull_distance,
)
from urdfcheck.facts.motion.kinematics import rpy_to_matrix

pytestmark = pytest.mark.slow

CUBE = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
seed = st.integers(0, 10**6)


@pytest.mark.parametrize(
    ("place", "distance"),
    [
        ((0, 0, 0), 0),
        ((1, 1, 1), 0),
        ((0.99, -0.99, 0.5), 0),
        ((3, 0, 0), 2),
        ((0.3, -0.2, 1.5), 0.5),
        ((2, 2, 0), 2**0.5),
        ((2, 2, 2), 3**0.5),
    ],
)
def test_distance_from_a_cube(place: tuple[float, ...], distance: float) -> None:
    assert_allclose(measure_hull_distance(CUBE, place), distance, atol=1e-6)


def test_distance_from_a_plate_a_rod_and_a_point() -> None:
    plate = CUBE[CUBE[:, 2] > 0]
    assert measure_hull_distance(plate, (0.2, 0.1, 1)) == 0
    assert_allclose(measure_hull_distance(plate, (0.2, 0.1, 0)), 1)
    assert_allclose(measure_hull_distance([(0, 0, 0), (1, 0, 0), (0.5, 0, 0)], (0.7, 3, 4)), 5)
    assert_allclose(measure_hull_distance([(1, 2, 2)], (0, 0, 0)), 3)


@given(seed, st.floats(-7.0, 7.0))
def test_distance_is_that_of_the_best_separating_plane(number: int, exponent: float) -> None:
    random = np.random.default_rng(number)
    scale = 10.0**exponent
    points = random.normal(size=(random.integers(4, 80), 3)) * random.uniform(0.01, 3, 3) * scale
    place = random.normal(size=3) * 2 * scale
    # The same as non-negative least squares, with a heavy row that makes the weights sum up to one.
    heavy = 1e6
    rows = np.vstack(((points - place).T / scale, np.full(len(points), heavy)))
    weights, _ = nnls(rows, np.array((0, 0, 0, heavy)))
    distance = float(np.linalg.norm(weights @ (points - place)))
    assert_allclose(measure_hull_distance(points, place), distance, atol=2e-4 * scale)


def test_a_uniform_body_keeps_within_the_bound_and_two_points_reach_it() -> None:
    ratios, _ = compute_spread_ratios(CUBE, (0, 0, 0), np.eye(3) / 3)
    assert_allclose(ratios, 1 / 3)
    dumbbell, _ = compute_spread_ratios(CUBE, (0.5, 0, 0), np.diag((0.75, 0, 0)))
    assert_allclose(dumbbell.max(), 1.0)


@given(seed)
def test_no_distribution_of_mass_over_the_points_exceeds_the_bound(number: int) -> None:
    random = np.random.default_rng(number)
    points = random.normal(size=(random.integers(2, 30), 3))
    weights = random.dirichlet(np.full(len(points), 0.2))
    com = weights @ points
    covariance = (weights[:, None] * (points - com)).T @ (points - com)
    ratios, _ = compute_spread_ratios(points, com, covariance, margin=1e-4)
    assert ratios.max() <= 1 + 1e-6
    assert measure_hull_distance(points, com) <= 1e-5 * measure_extent(points) + 1e-12


def test_a_centre_of_mass_beside_the_points_leaves_no_spread_unless_within_the_margin() -> None:
    ratios, axes = compute_spread_ratios(CUBE, (1.05, 0, 0), np.diag((0.1, 0.2, 0.3)))
    assert ratios[np.argmax(np.abs(axes[0]))] == np.inf
    padded, _ = compute_spread_ratios(CUBE, (1.05, 0, 0), np.diag((0.1, 0.2, 0.3)), margin=0.1)
    assert_allclose(padded.max(), 0.1 / (2.15 * 0.05))


@given(seed, st.floats(0.001, 1000))
def test_turning_and_scaling_change_nothing(number: int, scale: float) -> None:
    random = np.random.default_rng(number)
    points, com = random.normal(size=(20, 3)), random.normal(size=3)
    spread = np.diag(random.uniform(0.1, 2, 3))
    turn, shift = rpy_to_matrix(random.uniform(-3, 3, 3)), random.normal(size=3)
    moved, moved_com = scale * (points @ turn.T + shift), scale * (turn @ com + shift)
    assert_allclose(
        measure_hull_distance(moved, moved_com), scale * measure_hull_distance(points, com), atol=1e-4 * scale
    )
    assert_allclose(measure_extent(moved), scale * measure_extent(points))
    before, _ = compute_spread_ratios(points, com, spread, margin=0.1)
    after, _ = compute_spread_ratios(moved, moved_com, scale**2 * turn @ spread @ turn.T, margin=0.1 * scale)
    assert_allclose(np.sort(after), np.sort(before), rtol=1e-6)


def test_equal_variances_are_bounded_along_the_axes_of_the_hull() -> None:
    plate = CUBE * (8.0, 8.0, 1.0)
    # A disc's tensor turned a quarter about y: rounding mixes the directions y and z, of which z is across the plate.
    turn = rpy_to_matrix((np.pi / 4, 0, 0))
    spread = turn @ np.diag((2.0, 40.0, 40.0 + 1e-9)) @ turn.T
    ratios, _ = compute_spread_ratios(plate, (0, 0, 0), spread)
    assert_allclose(np.sort(ratios), (2 / 64, 40 / 64, 40))
    assert has_excess_moment(plate, (0, 0, 0), spread)


def test_no_moment_is_more_than_that_of_all_mass_at_the_farthest_point() -> None:
    rod = CUBE * (8.0, 0.1, 0.1) @ rpy_to_matrix((0, 0, np.pi / 4)).T
    # Along x and y alone the rod reaches so far, but not along both at once.
    assert has_excess_moment(rod, (0, 0, 0), np.diag((32.5, 32.0, 0.001)))
    assert not has_excess_moment(rod, (0, 0, 0), np.diag((31.5, 30.0, 0.001)))
