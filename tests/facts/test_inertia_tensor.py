"""Inertia tensors: validity, rounding of typed digits, solids in closed form, equivalent bodies."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from urdfcheck.facts.inertials.engine_floors import is_refused_by_mujoco
from urdfcheck.facts.inertials.equivalent_solids import (
    compute_equivalent_density,
    fit_equivalent_box,
    fit_equivalent_cylinder,
)
from urdfcheck.facts.inertials.inertia_tensor import (
    Solid,
    TensorRounding,
    build_inertia_tensor,
    check_inertia_validity,
    combine_solids,
    compute_mass_covariance,
    compute_principal_frame,
    compute_principal_moments,
    compute_solid_inertia,
    compute_triangle_excess,
    list_inertia_components,
    make_box_solid,
    make_capsule_solid,
    make_cylinder_solid,
    make_sphere_solid,
    measure_tensor_rounding,
    transform_solid,
)
from urdfcheck.facts.motion.kinematics import rpy_to_matrix

pytestmark = pytest.mark.slow

size = st.floats(0.01, 3.0)
angle = st.floats(-3.0, 3.0)
mass = st.floats(0.01, 100.0)

# A small robot car drawn at 1000 kg/m³: a box with bosses, and a disk with a marker boss.
CAR_MASS, CAR = (
    0.497309733552923,
    (
        0.000379491084127215,
        -2.59493525107028e-19,
        -3.57796209039485e-06,
        0.00138864533975945,
        -4.48378120593819e-21,
        0.00169173411179082,
    ),
)
WHEEL_MASS, WHEEL = (
    0.0282994666235368,
    (
        6.59828205801096e-06,
        -3.54146284907832e-09,
        -4.2351647362715e-22,
        1.27373747424717e-05,
        7.11375326795604e-23,
        6.61215628796161e-06,
    ),
)


# --- validity --------------------------------------------------------------------------------------------------------


@given(size, size, size, angle, angle, angle, mass)
def test_solids_are_valid_in_any_orientation(
    a: float, b: float, c: float, roll: float, pitch: float, yaw: float, m: float
) -> None:
    turned = transform_solid(make_box_solid((a, b, c)), rpy_to_matrix((roll, pitch, yaw)), (0, 0, 0))
    report = check_inertia_validity(compute_solid_inertia(turned, m))
    assert report.finite
    assert report.positive_definite
    assert report.triangle_inequality
    expected = sorted(m / 12 * np.array((b * b + c * c, a * a + c * c, a * a + b * b)))
    assert_allclose(report.moments, expected, rtol=1e-9)


def test_excess_is_one_for_a_sphere_and_zero_for_a_plate() -> None:
    assert compute_triangle_excess(compute_solid_inertia(make_sphere_solid(0.3), 2.0)) == pytest.approx(1.0)
    assert compute_triangle_excess(compute_solid_inertia(make_box_solid((1, 2, 0)), 2.0)) == pytest.approx(
        0.0, abs=1e-15
    )


def test_the_triangle_inequality_is_one_of_principal_moments() -> None:
    # The diagonal alone satisfies it.
    report = check_inertia_validity(build_inertia_tensor((1.0, 0.9, 0.0, 1.0, 0.0, 1.0)))
    assert report.positive_definite
    assert not report.triangle_inequality
    assert report.excess == pytest.approx((0.1 + 1.0 - 1.9) / 1.9)


@pytest.mark.parametrize(
    ("diagonal", "definite", "triangle"),
    [
        ((0, 1, 1), False, True),
        ((-1, 1, 1), False, False),
        ((0, 0, 0), False, True),
        ((1, 1, 2 + 1e-8), True, False),
        ((1, 1, 2 + 1e-10), True, True),
    ],
)
def test_borderline_tensors(diagonal: tuple[float, ...], definite: bool, triangle: bool) -> None:
    report = check_inertia_validity(np.diag(diagonal))
    assert (report.positive_definite, report.triangle_inequality) == (definite, triangle)


@given(st.floats(-18.0, -10.0), st.floats(0.0, 3.0), angle, angle, angle)
def test_what_is_too_small_for_mujoco_is_so_in_any_orientation(
    decade: float, larger: float, roll: float, pitch: float, yaw: float
) -> None:
    smallest = 10.0**decade
    assume(abs(decade + 14.0) > 0.01)
    turn = np.array(rpy_to_matrix((roll, pitch, yaw)))
    tensor = turn @ np.diag((smallest, smallest * 10.0**larger, smallest * 10.0**larger)) @ turn.T
    assert is_refused_by_mujoco(list_inertia_components(tensor)) == (decade < -14.0)


def test_mujoco_accepts_a_tensor_of_zeros() -> None:
    assert not is_refused_by_mujoco((0.0,) * 6)


def test_a_tensor_that_is_not_finite_has_no_moments() -> None:
    report = check_inertia_validity(build_inertia_tensor((1, 0, 0, math.nan, 0, 1)))
    assert (report.finite, report.positive_definite, report.triangle_inequality) == (False, False, False)
    with pytest.raises(ValueError, match="not finite"):
        compute_principal_moments(build_inertia_tensor((1, 0, 0, math.inf, 0, 1)))


def test_principal_axes_are_a_rotation_that_diagonalises() -> None:
    inertia = build_inertia_tensor((1.0, 0.1, -0.2, 1.5, 0.3, 2.0))
    moments, axes = compute_principal_moments(inertia)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert_allclose(axes @ np.diag(moments) @ axes.T, inertia, atol=1e-14)
    assert sorted(moments) == list(moments)


@given(st.sampled_from([(0.1, 0.2, 0.3), (0.2, 0.2, 0.3), (0.1, 0.3, 0.3), (0.2, 0.2, 0.2)]), angle, angle, angle)
def test_the_principal_frame_is_one_and_the_same_for_tensors_that_differ_by_rounding(
    sides: tuple[float, float, float], roll: float, pitch: float, yaw: float
) -> None:
    inertia = compute_solid_inertia(
        transform_solid(make_box_solid(sides), rpy_to_matrix((roll, pitch, yaw)), (0, 0, 0)), 2.0
    )
    moments, axes = compute_principal_frame(inertia)
    assert_allclose(axes @ np.diag(moments) @ axes.T, inertia, atol=1e-9)
    assert_allclose(axes.T @ axes, np.eye(3), atol=1e-9)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    assume((np.abs(np.abs(axes) - 0.1) > 1e-6).all())  # where a component begins to count
    noise = np.array([[0, 1, 0], [1, 0, -1], [0, -1, 1]]) * 1e-16
    assert_allclose(compute_principal_frame(inertia + noise)[1], axes, atol=1e-6)


# --- digits ----------------------------------------------------------------------------------------------------------


def rounding(six: str) -> TensorRounding:
    return measure_tensor_rounding(six.split())


def test_a_violation_in_the_last_digit_is_explained_by_rounding() -> None:
    found = rounding("0.00123 0 0 0.00045 0 0.00169")
    assert found.excess < 0.0
    assert found.explained_by_rounding
    assert found.typed_digits == 3


def test_a_violation_of_many_digits_is_not() -> None:
    assert not rounding("0.00123000 0 0 0.00045000 0 0.00169000").explained_by_rounding


def test_a_number_beside_longer_ones_has_as_many_digits() -> None:
    # A placeholder beside computed moments; programs leave out zeros at the end.
    assert not rounding("0.3333333333333333 0 0 1.0 0 0.3333333333333333").explained_by_rounding
    assert not rounding("0.00123456 0 0 0.00045678 0 0.0017").explained_by_rounding
    # With as many decimals in each, small moments are short.
    assert rounding("0.000002 0 0 0.000001 0.000001 0.000002").explained_by_rounding


def test_a_valid_tensor_needs_no_explanation() -> None:
    assert not rounding("0.01 0 0 0.01 0 0.01").explained_by_rounding


def test_products_have_digits_too() -> None:
    # Principal moments 0.5, 1.5 and 2.1 up to the digits of the product.
    assert rounding("1.0 0.5 0 1.0 0 2.1").explained_by_rounding
    assert not rounding("1.000 0.500 0 1.000 0 2.100").explained_by_rounding


@given(size, size, st.floats(1e-3, 1.0), angle, angle, st.integers(2, 6))
def test_rounding_a_real_plate_is_always_explained(
    a: float, b: float, m: float, roll: float, pitch: float, digits: int
) -> None:
    plate = transform_solid(make_box_solid((a, b, 1e-4)), rpy_to_matrix((roll, pitch, 0.3)), (0, 0, 0))
    i = compute_solid_inertia(plate, m)
    texts = [f"{v:.{digits - 1}e}" for v in (i[0, 0], i[0, 1], i[0, 2], i[1, 1], i[1, 2], i[2, 2])]
    found = measure_tensor_rounding(texts)
    assert found.explained_by_rounding or found.excess >= -1e-9


@given(size, size, st.floats(1e-3, 1.0), angle, angle)
def test_the_suggested_digits_keep_a_flat_plate_valid(a: float, b: float, m: float, roll: float, pitch: float) -> None:
    i = compute_solid_inertia(
        transform_solid(make_box_solid((a, b, 0)), rpy_to_matrix((roll, pitch, 0.3)), (0, 0, 0)), m
    )
    six = (i[0, 0], i[0, 1], i[0, 2], i[1, 1], i[1, 2], i[2, 2])
    digits = measure_tensor_rounding([repr(float(v)) for v in six]).digits
    place = math.floor(math.log10(max(i.diagonal()))) - digits + 1
    rounded = [round(float(v), -place) for v in six]
    assert compute_triangle_excess(build_inertia_tensor(rounded)) > -1e-9


@pytest.mark.parametrize("text", ["abc", "nan", ""])
def test_digits_of_no_number_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match="is no"):
        measure_tensor_rounding([text, "0", "0", "1", "0", "1"])


# --- solids ----------------------------------------------------------------------------------------------------------


def test_textbook_moments() -> None:
    assert_allclose(compute_solid_inertia(make_box_solid((1, 2, 3)), 12.0), np.diag((13.0, 10.0, 5.0)))
    assert_allclose(compute_solid_inertia(make_sphere_solid(0.5), 10.0), np.eye(3))
    assert_allclose(compute_solid_inertia(make_cylinder_solid(1.0, 2.0), 12.0), np.diag((7.0, 7.0, 6.0)))


def test_a_capsule_is_between_its_tube_and_the_sphere_it_shrinks_to() -> None:
    assert_allclose(make_capsule_solid(0.3, 0.0).covariance, make_sphere_solid(0.3).covariance)
    assert make_capsule_solid(0.3, 0.0).volume == pytest.approx(make_sphere_solid(0.3).volume)
    long = make_capsule_solid(0.01, 100.0)
    assert_allclose(long.covariance, make_cylinder_solid(0.01, 100.0).covariance, rtol=1e-3)


def test_a_capsule_is_a_tube_and_two_half_spheres() -> None:
    r, length, n = 0.3, 0.8, 200
    ticks = (np.arange(n) + 0.5) / n * 2 - 1
    x, z = r * ticks, (length / 2 + r) * ticks
    height, width = np.meshgrid(z, x)
    # Slices across x: the section at (x, z) is as wide in y as the circle leaves.
    beyond = np.maximum(np.abs(height) - length / 2, 0.0)
    weight = np.sqrt(np.maximum(r * r - width**2 - beyond**2, 0.0))
    solid = make_capsule_solid(r, length)
    assert (weight * height**2).sum() / weight.sum() == pytest.approx(solid.covariance[2, 2], rel=1e-3)
    assert (weight * width**2).sum() / weight.sum() == pytest.approx(solid.covariance[0, 0], rel=1e-3)


def test_two_half_boxes_make_a_box() -> None:
    half = make_box_solid((1, 1, 1))
    left, right = transform_solid(half, np.eye(3), (-0.5, 0, 2)), transform_solid(half, np.eye(3), (0.5, 0, 2))
    whole = combine_solids([left, right])
    assert whole.volume == pytest.approx(2.0)
    assert_allclose(whole.com, (0, 0, 2))
    assert_allclose(whole.covariance, make_box_solid((2, 1, 1)).covariance)


def test_nothing_cannot_be_combined() -> None:
    with pytest.raises(ValueError, match="without volume"):
        combine_solids([])


@given(size, size, size, mass)
def test_covariance_is_the_inverse_of_inertia(a: float, b: float, c: float, m: float) -> None:
    solid = make_box_solid((a, b, c))
    assert_allclose(compute_mass_covariance(compute_solid_inertia(solid, m), m), solid.covariance, atol=1e-12)


# --- equivalent bodies -----------------------------------------------------------------------------------------------


def list_moments(inertia: np.ndarray) -> list[float]:
    moments: list[float] = compute_principal_moments(inertia)[0].tolist()
    return moments


@given(size, size, size, angle, mass)
def test_the_equivalent_box_of_a_box_is_the_box(a: float, b: float, c: float, yaw: float, m: float) -> None:
    turned = transform_solid(make_box_solid((a, b, c)), rpy_to_matrix((0.4, -0.2, yaw)), (0, 0, 0))
    edges = fit_equivalent_box(m, list_moments(compute_solid_inertia(turned, m)))
    assert_allclose(edges, sorted((a, b, c), reverse=True), rtol=1e-4)


@given(size, size, mass)
def test_the_equivalent_cylinder_of_a_cylinder_is_the_cylinder(r: float, length: float, m: float) -> None:
    assume(abs(length / r - math.sqrt(3)) > 0.1)  # about as round as a sphere: its axis is anybody's guess
    axis, radius, height = fit_equivalent_cylinder(
        m, list_moments(compute_solid_inertia(make_cylinder_solid(r, length), m))
    )
    assert axis == (2 if length < math.sqrt(3) * r else 0)
    assert (radius, height) == (pytest.approx(r, rel=1e-4), pytest.approx(length, rel=1e-3, abs=1e-4))


def test_a_brick_has_no_equivalent_cylinder_and_an_impossible_body_no_box() -> None:
    brick = fit_equivalent_cylinder(1.0, list_moments(compute_solid_inertia(make_box_solid((1, 2, 3)), 1.0)))
    assert brick[0] is None
    assert math.isnan(brick[1])
    assert compute_equivalent_density(1.0, (1.0, 1.0, 3.0)).box is None


def test_a_default_density_shows_without_meshes() -> None:
    body, wheel = (
        compute_equivalent_density(CAR_MASS, list_moments(build_inertia_tensor(CAR))),
        compute_equivalent_density(WHEEL_MASS, list_moments(build_inertia_tensor(WHEEL))),
    )
    assert body.box == pytest.approx(1000.0, rel=3e-3)
    assert wheel.cylinder == pytest.approx(999.2, abs=0.05)
    assert fit_equivalent_cylinder(WHEEL_MASS, list_moments(build_inertia_tensor(WHEEL)))[1:] == pytest.approx(
        (0.030003, 0.010015), abs=1e-6
    )


def test_solids_of_the_same_shape_and_another_density_have_that_density() -> None:
    solid: Solid = make_cylinder_solid(0.1, 0.05)
    assert compute_equivalent_density(
        2700 * solid.volume, list_moments(compute_solid_inertia(solid, 2700 * solid.volume))
    ).cylinder == pytest.approx(2700)
