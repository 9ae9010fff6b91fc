"""Rotations in URDF's conventions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from urdfcheck.facts.motion.kinematics import (
    compute_axis_angle,
    matrix_to_rpy,
    quaternion_to_matrix,
    rpy_to_matrix,
)

angle = st.floats(-math.pi, math.pi)
quarter = math.pi / 2


def rotation_about(axis: np.ndarray, turn: float) -> np.ndarray:
    """Rodrigues' formula, as an independent reference."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(turn) * cross + (1 - math.cos(turn)) * cross @ cross


def test_rpy_turns_about_fixed_axes_roll_first() -> None:
    # Roll brings y to z, yaw leaves z alone.
    assert_allclose(rpy_to_matrix((quarter, 0, quarter)) @ (0, 1, 0), (0, 0, 1), atol=1e-15)
    # Pitch brings x down.
    assert_allclose(rpy_to_matrix((0, quarter, 0)) @ (1, 0, 0), (0, 0, -1), atol=1e-15)


@given(angle, angle, angle)
def test_rpy_is_the_product_of_three_rotations(roll: float, pitch: float, yaw: float) -> None:
    x, y, z = np.eye(3)
    expected = rotation_about(z, yaw) @ rotation_about(y, pitch) @ rotation_about(x, roll)
    assert_allclose(rpy_to_matrix((roll, pitch, yaw)), expected, atol=1e-14)


@given(angle, st.one_of(angle, st.sampled_from((quarter, -quarter))), angle)
def test_rpy_of_a_matrix_gives_the_matrix_back(roll: float, pitch: float, yaw: float) -> None:
    matrix = rpy_to_matrix((roll, pitch, yaw))
    back = matrix_to_rpy(matrix)
    assert abs(back[1]) <= quarter
    assert_allclose(rpy_to_matrix(back), matrix, atol=3e-8)


def test_rpy_at_the_gimbal_has_no_roll() -> None:
    roll, pitch, yaw = matrix_to_rpy(rpy_to_matrix((0.4, quarter, 1.0)))
    assert roll == 0.0
    assert pitch == pytest.approx(quarter)
    assert yaw == pytest.approx(0.6)


def test_quaternions_are_x_y_z_w_of_any_length() -> None:
    half = math.sin(quarter / 2)
    expected = rpy_to_matrix((0, 0, quarter))
    assert_allclose(quaternion_to_matrix((0, 0, half, half)), expected, atol=1e-15)
    assert_allclose(quaternion_to_matrix((0, 0, 7 * half, 7 * half)), expected, atol=1e-15)


@pytest.mark.parametrize("xyzw", [(0, 0, 0, 0), (0, 0, math.nan, 1), (math.inf, 0, 0, 0)])
def test_a_quaternion_without_direction_is_refused(xyzw: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="not a rotation"):
        quaternion_to_matrix(xyzw)


@given(
    st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-1, 1)).filter(lambda v: math.hypot(*v) > 0.1),
    st.one_of(
        st.floats(0, math.pi),
        st.floats(1e-12, 1e-6),
        st.floats(1e-12, 1e-6).map(lambda gap: math.pi - gap),
    ),
)
def test_logarithm_finds_axis_and_angle_even_near_zero_and_half_a_turn(
    axis: tuple[float, float, float], turn: float
) -> None:
    unit = np.array(axis) / math.hypot(*axis)
    found, size = compute_axis_angle(rotation_about(unit, turn))
    assert size == pytest.approx(turn, abs=1e-14, rel=1e-9)
    assert_allclose(rotation_about(found, size), rotation_about(unit, turn), atol=1e-13)
    if 1e-9 < turn < math.pi - 1e-9:
        assert_allclose(found, unit, atol=1e-6)


def test_no_rotation_has_angle_zero() -> None:
    axis, size = compute_axis_angle(np.eye(3))
    assert size == 0.0
    assert np.linalg.norm(axis) == 1.0


@pytest.mark.parametrize("axis", np.eye(3))
def test_half_turns_about_the_axes(axis: np.ndarray) -> None:
    found, size = compute_axis_angle(rotation_about(axis, math.pi))
    assert size == pytest.approx(math.pi)
    assert_allclose(abs(found), axis, atol=1e-15)
