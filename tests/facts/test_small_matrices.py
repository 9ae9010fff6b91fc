"""Vectors, rotations and tensors as tuples, compared with numpy."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from urdfcheck.facts.inertials.inertia_tensor import compute_parallel_axis_term
from urdfcheck.facts.small_matrices import (
    UNMOVED,
    Placement,
    Vector,
    add_parallel_axis,
    add_tensors,
    compute_excess,
    compute_moments,
    make_rotation,
    make_tensor,
    measure_rotation,
    multiply,
    multiply_inner,
    multiply_outer,
    rotate,
    subtract,
    transpose,
    turn_tensor,
)

number = st.floats(-1.0, 1.0).map(lambda value: 0.0 if abs(value) < 1e-12 else value)
vector = st.tuples(number, number, number)
angles = st.tuples(*[st.floats(-math.pi, math.pi)] * 3)
components = st.tuples(*[number] * 6)
quarter = math.pi / 2


@given(components, st.integers(-40, 40))
def test_moments_are_the_eigenvalues(typed: tuple[float, ...], power: int) -> None:
    tensor = make_tensor([value * 10.0**power for value in typed])
    expected = np.linalg.eigvalsh(tensor)
    assert_allclose(compute_moments(tensor), expected, atol=1e-14 * np.abs(expected).max(), rtol=0)


def test_moments_of_a_diagonal_are_its_entries() -> None:
    assert compute_moments(make_tensor((3.0, 0.0, 0.0, 0.1, 0.0, 0.2))) == (0.1, 0.2, 3.0)
    assert compute_moments(make_tensor([0.0] * 6)) == (0.0, 0.0, 0.0)


def test_numbers_that_are_not_finite_have_no_end_of_sweeps() -> None:
    assert not all(map(math.isfinite, compute_moments(make_tensor((math.inf, 1.0, 0.0, 1.0, 0.0, 1.0)))))


def test_the_excess_is_that_of_the_triangle_inequality() -> None:
    assert compute_excess((1.0, 1.0, 1.0)) == 1.0
    assert compute_excess((1.0, 2.0, 3.0)) == 0.0
    assert math.isnan(compute_excess((-1.0, -1.0, 0.0)))


@given(angles, angles, vector, vector)
def test_products_are_those_of_matrices(rpy: Vector, other_rpy: Vector, one: Vector, other: Vector) -> None:
    a, b = make_rotation(rpy), make_rotation(other_rpy)
    assert_allclose(multiply(a, b), np.array(a) @ np.array(b), atol=1e-15)
    assert_allclose(rotate(a, one), np.array(a) @ one, atol=1e-15)
    assert_allclose(multiply(transpose(a), a), np.eye(3), atol=1e-15)
    assert_allclose(multiply_inner(one, other), np.dot(one, other), atol=1e-15)
    assert_allclose(multiply_outer(one, other), np.cross(one, other), atol=1e-15)
    assert subtract(one, other) == tuple(np.subtract(one, other))


@given(angles, components, vector, st.floats(0.1, 10.0))
def test_tensors_turn_and_move(rpy: Vector, typed: tuple[float, ...], lever: Vector, mass: float) -> None:
    rotation, tensor = make_rotation(rpy), make_tensor(typed)
    turn = np.array(rotation)
    assert_allclose(turn_tensor(rotation, tensor), turn @ np.array(tensor) @ turn.T, atol=1e-14)
    moved = np.array(tensor) + compute_parallel_axis_term(mass, lever)
    assert_allclose(add_parallel_axis(tensor, mass, lever), moved, atol=1e-13)
    assert_allclose(add_tensors([tensor, tensor, tensor]), 3.0 * np.array(tensor), atol=1e-15)


def test_a_rotation_has_its_angle() -> None:
    assert_allclose(measure_rotation(make_rotation((0.0, 0.3, 0.0))), 0.3)
    assert measure_rotation(make_rotation((0.0, 0.0, math.pi))) == math.pi
    assert_allclose(measure_rotation(make_rotation((0.0, 0.0, 1e-9))), 1e-9)


def test_frames_are_placed_by_their_parents() -> None:
    """A base, an arm turned by a quarter and its tip one metre out."""
    base = UNMOVED.carry(Placement(make_rotation((0, 0, 0)), (0.0, 0.0, 1.0)))
    arm = base.carry(Placement(make_rotation((0, 0, quarter)), (1.0, 0.0, 0.0)))
    tip = arm.carry(Placement(make_rotation((0, 0, 0)), (1.0, 0.0, 0.0)))
    assert_allclose([base.place, arm.place, tip.place], [(0, 0, 1), (1, 0, 1), (1, 1, 1)], atol=1e-15)
    assert_allclose(tip.rotation, make_rotation((0, 0, quarter)), atol=1e-15)
    assert_allclose(arm.carry_point((0.0, 2.0, 0.0)), (-1.0, 0.0, 1.0), atol=1e-15)
