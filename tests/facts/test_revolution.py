"""The axis that a body goes round, and how round it is."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from urdfcheck.facts.inertials.inertia_tensor import make_box_solid, make_cylinder_solid, make_sphere_solid
from urdfcheck.facts.likeness.revolution import find_revolution_axis, measure_line_angle, measure_outline
from urdfcheck.facts.motion.kinematics import rpy_to_matrix

Array = NDArray[np.float64]
RANDOM = np.random.default_rng(15)


def disc(corners: int, radius: float = 0.05, width: float = 0.02) -> Array:
    """A prism along z."""
    angles = np.arange(corners) * math.tau / corners
    rim = np.column_stack((np.cos(angles) * radius, np.sin(angles) * radius, np.zeros(corners)))
    return np.concatenate((rim + np.array((0, 0, width / 2)), rim - np.array((0, 0, width / 2))))


@pytest.mark.parametrize(("radius", "length"), [(0.05, 0.02), (0.05, 0.3), (0.02, 0.02)])
def test_the_axis_of_a_cylinder_however_it_is_turned(radius: float, length: float) -> None:
    for _ in range(10):
        turn = rpy_to_matrix(RANDOM.uniform(-3, 3, 3).tolist())
        axis = find_revolution_axis(turn @ make_cylinder_solid(radius, length).covariance @ turn.T)
        assert axis is not None
        assert measure_line_angle(axis, turn[:, 2]) < 1e-6


@pytest.mark.parametrize(
    "covariance",
    [
        make_sphere_solid(0.1).covariance,
        # Of a cylinder whose length is √3 times its radius all moments are equal.
        make_cylinder_solid(0.1, 0.1 * math.sqrt(3)).covariance,
        make_box_solid((0.1, 0.2, 0.3)).covariance,
        np.zeros((3, 3)),
    ],
    ids=["sphere", "isotropic", "box", "point"],
)
def test_bodies_without_an_axis(covariance: Array) -> None:
    assert find_revolution_axis(covariance) is None


def test_moments_that_differ_by_a_twentieth_are_the_limit() -> None:
    assert find_revolution_axis(np.diag((1.0, 0.951, 0.3))) is not None
    assert find_revolution_axis(np.diag((1.0, 0.949, 0.3))) is None
    assert find_revolution_axis(np.diag((1.0, 1.0, 0.89))) is not None
    assert find_revolution_axis(np.diag((1.0, 1.0, 0.91))) is None


def test_an_outline_is_found_wherever_it_is() -> None:
    for _ in range(10):
        turn, place = rpy_to_matrix(RANDOM.uniform(-3, 3, 3).tolist()), RANDOM.uniform(-1, 1, 3)
        found = measure_outline(disc(64) @ turn.T + place, turn[:, 2])
        assert found.centre == pytest.approx(place, abs=1e-4)
        assert found.radius == pytest.approx(0.05, rel=2e-3)
        assert found.width == pytest.approx(0.02)
        assert found.is_round()


@pytest.mark.parametrize(("corners", "is_round"), [(4, False), (6, False), (10, True), (12, True)])
def test_a_polygon_of_ten_corners_is_round(corners: int, is_round: bool) -> None:
    assert measure_outline(disc(corners), (0, 0, 1)).is_round() is is_round


def test_about_another_line_a_disc_is_not_round() -> None:
    assert not measure_outline(disc(64), (1, 0, 0)).is_round()
    assert not measure_outline(disc(64), (0, 0, 1), centre=(0.01, 0, 0)).is_round()
    assert measure_outline(disc(64) + np.array((0.01, 0, 0)), (0, 0, 1), centre=(0.01, 0, 5)).is_round()


def test_lines_have_no_direction() -> None:
    assert measure_line_angle((0, 0, 2), (0, 0, -3)) == 0.0
    assert measure_line_angle((1, 0, 0), (-1, 1, 0)) == pytest.approx(math.pi / 4)


@pytest.mark.parametrize("corners", [10, 16, 17, 64])
def test_the_usual_radius_is_that_of_the_corners_and_no_bump_changes_it(corners: int) -> None:
    bump = np.array(((0.0, 0.0517, 0.0),))
    found = measure_outline(np.concatenate((disc(corners), bump)), (0, 0, 1), (0, 0, 0))
    assert found.usual_radius == pytest.approx(0.05)
    assert found.radius == pytest.approx(0.0517)
    assert measure_outline(np.zeros((3, 3)), (0, 0, 1)).usual_radius == 0.0
