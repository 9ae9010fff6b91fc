"""Mirror planes, and what a mirror does to places, inertials and limits."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.inertia_tensor import (
    combine_solids,
    compute_solid_inertia,
    make_box_solid,
    transform_solid,
)
from urdfcheck.facts.likeness.mirror import (
    MirrorPlane,
    PartOutline,
    find_mirror_plane,
    find_wrong_signs,
    measure_deviation,
    measure_outline_mismatch,
    measure_principal_deviation,
    mirror_range,
)
from urdfcheck.facts.motion.kinematics import build_origin_transform, compute_joint_motions, rpy_to_matrix

LEFT_RIGHT = MirrorPlane(np.array((0.0, 1.0, 0.0)), 0.0)
AXES = tuple(np.eye(3)[[1, 0, 2]])
angle = st.floats(-math.pi, math.pi)
place = st.floats(-1.0, 1.0)

# A bracket: a bar with a foot to one side and a pin upwards, without any symmetry.
PIECES = (
    ((0.3, 0.05, 0.04), (0.15, 0.0, 0.0)),
    ((0.06, 0.1, 0.03), (0.05, 0.06, 0.01)),
    ((0.03, 0.03, 0.12), (0.2, 0.01, 0.06)),
)
BRACKET = combine_solids([transform_solid(make_box_solid(size), np.eye(3), centre) for size, centre in PIECES])
CORNERS = np.array([np.array(c) + 0.5 * np.array(s) * signs for s, c in PIECES for signs in product((-1, 1), repeat=3)])
OUTLINE = PartOutline(BRACKET.com, BRACKET.covariance, CORNERS)
NUMBERS = DeclaredInertial(1.5, BRACKET.com, compute_solid_inertia(BRACKET, 1.5))


def moved(outline: PartOutline, linear: np.ndarray, shift: np.ndarray) -> PartOutline:
    """The outline under ``x -> linear x + shift``."""
    return PartOutline(
        linear @ outline.centroid + shift, linear @ outline.covariance @ linear.T, outline.points @ linear.T + shift
    )


# --- planes ----------------------------------------------------------------------------------------------------------


def test_a_plane_mirrors_points_to_its_other_side() -> None:
    assert_allclose(MirrorPlane(np.array((1.0, 0.0, 0.0)), 0.5).reflect_points([[2.0, 3.0, 4.0]]), [[-1.0, 3.0, 4.0]])


@given(angle, angle, place, place, place)
@settings(max_examples=25)
def test_the_mirror_image_of_a_frame_is_related_to_the_other_frame(
    a: float, b: float, x: float, y: float, z: float
) -> None:
    one, other = build_origin_transform((x, y, z), (a, b, 0.3)), build_origin_transform((z, x, y), (b, 0.2, a))
    linear, shift = LEFT_RIGHT.relate_frames(one, other)
    point = np.array((0.1, -0.2, 0.3))
    image = LEFT_RIGHT.reflect_points(one[:3, :3] @ point + one[:3, 3])
    assert_allclose(other[:3, :3] @ (linear @ point + shift) + other[:3, 3], image, atol=1e-12)
    assert np.linalg.det(linear) == pytest.approx(-1.0)


def test_the_plane_of_most_pairs_is_found_beside_one_that_is_out_of_place() -> None:
    ones = np.array([(0.1, 0.2, 0.3), (0.4, 0.1, 0.0), (-0.2, 0.3, 0.1)])
    others = ones * (1, -1, 1)
    others[2] += (0.0, 0.0, 0.05)
    found = find_mirror_plane(ones, others, AXES, tolerance=1e-3)
    assert found is not None
    plane, count = found
    assert_allclose(plane.normal, (0, 1, 0))
    assert plane.offset == pytest.approx(0.0)
    assert count == 2


def test_what_hangs_on_a_displaced_joint_does_not_outvote_what_is_before_it() -> None:
    ones = np.random.default_rng(3).uniform(0.1, 1, (8, 3))
    others = ones * (1, -1, 1)
    others[2:] += (0.0, 0.0, 0.05)
    found = find_mirror_plane(ones, others, AXES, tolerance=1e-3)
    assert found is not None
    assert_allclose(found[0].normal, (0, 1, 0))
    assert found[1] == 2


def test_a_plane_that_mirrors_exactly_goes_before_one_that_does_nearly() -> None:
    """Of a body that is rotated by 1.57, the pairs are mirrored exactly in its own axes only."""
    turn = rpy_to_matrix((0, 0, 1.57))
    ones = np.array([(0.767, -1.41, 0.3), (0.793, 1.45, 0.3), (0.6, 0.2, 1.0)])
    first, second = ones @ turn.T, (ones * (-1, 1, 1)) @ turn.T
    for normals in ((*AXES, *turn.T), (*turn.T, *AXES)):
        found = find_mirror_plane(first, second, normals, tolerance=7e-3)
        assert found is not None
        assert_allclose(np.abs(found[0].normal), np.abs(turn[:, 0]), atol=1e-12)


def test_an_askew_plane_is_found_by_the_direction_of_the_differences() -> None:
    normal = rpy_to_matrix((0.1, 0.5, 0.7))[:, 1]
    askew = MirrorPlane(normal, 0.3)
    ones = np.random.default_rng(1).uniform(-1, 1, (6, 3))
    found = find_mirror_plane(ones, askew.reflect_points(ones), AXES, tolerance=1e-6)
    assert found is not None
    assert abs(found[0].normal @ normal) == pytest.approx(1.0)
    assert found[1] == 6


def test_sides_that_are_not_mirrored_have_no_plane() -> None:
    ones = np.random.default_rng(2).uniform(-1, 1, (6, 3))
    assert find_mirror_plane(ones, ones @ rpy_to_matrix((0.3, 0.8, 2.0)).T, AXES, tolerance=1e-3) is None
    assert find_mirror_plane(ones, ones, AXES, tolerance=1e-3) is None


# --- drawings --------------------------------------------------------------------------------------------------------


@given(angle, angle, angle)
@settings(max_examples=25)
def test_mirror_images_match_in_any_frames(a: float, b: float, c: float) -> None:
    linear, shift = rpy_to_matrix((a, b, c)) @ np.diag((1, -1, 1)), np.array((0.1, 0.2, -0.3))
    assert measure_outline_mismatch(
        OUTLINE, moved(OUTLINE, linear, shift), linear=linear, shift=shift
    ) == pytest.approx(0.0, abs=1e-12)


def test_a_part_is_not_its_own_mirror_image() -> None:
    for normal in np.eye(3):
        flip = np.eye(3) - 2 * np.outer(normal, normal)
        assert measure_outline_mismatch(OUTLINE, OUTLINE, linear=flip, shift=np.zeros(3)) > 0.1


def test_parts_with_equal_moments_differ_by_what_sticks_out() -> None:
    spike = PartOutline(OUTLINE.centroid, OUTLINE.covariance, np.vstack((OUTLINE.points, (0.6, 0.0, 0.0))))
    assert measure_outline_mismatch(OUTLINE, spike, linear=np.eye(3), shift=np.zeros(3)) > 1.0


def test_a_point_matches_nothing() -> None:
    point = PartOutline(np.zeros(3), np.zeros((3, 3)), np.zeros((1, 3)))
    assert measure_outline_mismatch(OUTLINE, point, linear=np.eye(3), shift=np.zeros(3)) == math.inf


# --- inertials -------------------------------------------------------------------------------------------------------


def test_a_deviation_is_measured_in_radii_of_gyration() -> None:
    radius = math.sqrt(np.trace(BRACKET.covariance))
    aside = DeclaredInertial(1.5, NUMBERS.com + np.array((0.0, 0.1 * radius, 0.0)), NUMBERS.tensor)
    heavy = DeclaredInertial(2.0, NUMBERS.com, NUMBERS.tensor * 2.0 / 1.5)
    assert measure_deviation(aside, NUMBERS).com_offset == pytest.approx(0.1)
    assert measure_deviation(heavy, NUMBERS).mass == pytest.approx(0.25)
    assert measure_deviation(heavy, NUMBERS).spread == pytest.approx(0.0, abs=1e-12)


def test_a_part_that_is_longer_by_a_tenth_spreads_by_a_tenth() -> None:
    rod = DeclaredInertial(1.0, np.zeros(3), np.diag((0.0, 1.0, 1.0)))
    longer = DeclaredInertial(1.0, np.zeros(3), np.diag((0.0, 1.21, 1.21)))
    assert measure_deviation(longer, rod).spread == pytest.approx(0.105)


@given(angle, angle, angle)
@settings(max_examples=25)
def test_principal_deviation_does_not_see_how_a_body_is_turned(a: float, b: float, c: float) -> None:
    turn = rpy_to_matrix((a, b, c)) @ np.diag((1, -1, 1))
    image = DeclaredInertial(1.5, turn @ NUMBERS.com, turn @ NUMBERS.tensor @ turn.T)
    assert measure_principal_deviation(image, NUMBERS).worst == pytest.approx(0.0, abs=1e-12)


def test_a_point_has_no_size_to_compare_with() -> None:
    point = DeclaredInertial(1.0, np.zeros(3), np.zeros((3, 3)))
    assert measure_deviation(NUMBERS, point).worst == math.inf
    assert measure_principal_deviation(NUMBERS, point).worst == math.inf


def test_wrong_signs_are_named_when_nothing_else_is_wrong() -> None:
    flip = np.diag((1.0, -1.0, 1.0))
    image = DeclaredInertial(1.5, flip @ NUMBERS.com, flip @ NUMBERS.tensor @ flip)
    assert find_wrong_signs(NUMBERS, image, 0.005) == ("y", "ixy", "iyz")
    heavier = DeclaredInertial(1.5, image.com * 1.2, image.tensor)
    assert find_wrong_signs(NUMBERS, heavier, 0.005) == ()
    assert find_wrong_signs(image, image, 0.005) == ()


def test_a_small_number_has_the_wrong_sign_where_a_greater_one_has() -> None:
    """All three products of inertia were negated, of which one is below what is told by itself."""
    tensor = np.diag((0.02, 0.03, 0.04)) + np.array(((0, 4e-3, 3e-3), (4e-3, 0, 2e-6), (3e-3, 2e-6, 0)))
    plain, negated = (DeclaredInertial(1.5, np.zeros(3), t) for t in (tensor, 2 * np.diag(np.diag(tensor)) - tensor))
    assert find_wrong_signs(negated, plain, 0.005) == ("ixy", "ixz", "iyz")
    tiny = tensor * np.where(np.isin(tensor, (4e-3, 3e-3)), 0.0, 1.0)
    assert (
        find_wrong_signs(
            DeclaredInertial(1.5, np.zeros(3), 2 * np.diag(np.diag(tiny)) - tiny),
            DeclaredInertial(1.5, np.zeros(3), tiny),
            0.005,
        )
        == ()
    )


# --- limits ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("rotates", [True, False])
@pytest.mark.parametrize("turned_over", [True, False])
@pytest.mark.parametrize("direction", [(1, 0, 0), (0, 1, 0), (0.6, 0.8, 0)])
def test_the_mirrored_range_reaches_the_mirrored_poses(
    rotates: bool, turned_over: bool, direction: tuple[float, ...]
) -> None:
    """At its limits, the second joint puts a point where the mirror puts the first joint's."""
    axis = np.array(direction)
    other = LEFT_RIGHT.linear @ axis * (-1 if turned_over else 1)
    lower, upper = mirror_range(-0.3, 1.1, float((LEFT_RIGHT.linear @ axis) @ other), rotates=rotates)
    point = np.array((0.2, 0.3, 0.5, 1.0))
    reached = [motion @ point for motion in compute_joint_motions(axis, (-0.3, 1.1), rotates=rotates)]
    mirrored = [
        motion @ (point * (1, -1, 1, 1)) for motion in compute_joint_motions(other, (lower, upper), rotates=rotates)
    ]
    wanted = sorted((p * (1, -1, 1, 1)).tolist() for p in reached)
    assert_allclose(sorted(p.tolist() for p in mirrored), wanted, atol=1e-12)


def test_a_limit_saves_only_what_is_not_below_it() -> None:
    random = np.random.default_rng(3)
    clouds = [random.normal(size=(30, 3)) * (1.0, 2.0, 3.0) for _ in range(2)]
    one, other = (PartOutline(c.mean(axis=0), np.cov(c.T), c) for c in clouds)
    for turn in (np.eye(3), np.diag([1.0, -1.0, -1.0]), np.eye(3)[[1, 2, 0]]):
        exact = measure_outline_mismatch(one, other, linear=turn, shift=np.zeros(3))
        for limit in (0.0, exact / 2.0, exact * 2.0):
            limited = measure_outline_mismatch(one, other, linear=turn, shift=np.zeros(3), limit=limit)
            assert limited == exact or limit <= limited <= exact


def test_a_pair_that_is_out_of_its_place_spans_no_leaning_plane() -> None:
    """Front axles that are 1.6 mm apart lengthwise, each with its wheel, do not turn the middle plane of a car."""
    ones = np.array([(0.54838, 0.24619, 0.002), (0.0, 0.252, -0.0025), (0.54838, 0.24619, 0.002)])
    others = ones * (1, -1, 1) + np.array([(0.00161, 0, 0), (0, 0, 0), (0.00161, 0, 0)])
    found = find_mirror_plane(ones, others, AXES, tolerance=1.5e-3)
    assert found is not None
    assert_allclose(found[0].normal, (0, 1, 0))
    assert found[1] == 1
