"""The odd one out among sibling frames: found where it is certain, never guessed."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from urdfcheck.facts.likeness.symmetry import (
    OddFrame,
    build_link_signature,
    find_odd_frame,
    find_suspect_frames,
    group_by_signature,
)
from urdfcheck.facts.motion.kinematics import rpy_to_matrix

pytestmark = pytest.mark.slow

# Four wheels of a car as typed in its joints: xyz, rpy, axis. The right ones face the other way round, so that their
# axes agree with the left ones' in the base; one π has five digits. The first is turned about its own axis.
CAR_XYZ = [(0.07, 0.052, 0), (-0.07, 0.052, 0), (0.07, -0.052, 0), (-0.07, -0.052, 0)]
CAR_RPY = [(0, -0.75239, 0), (0, 0, 0), (0, 0, 3.1416), (0, 0, 3.14159265358979)]
CAR_AXES = [(0, 1, 0), (0, 1, 0), (0, -1, 0), (0, -1, 0)]
REPAIRED = [(0, 0, 0), *CAR_RPY[1:]]

# Legs of a quadruped: hips splayed by 20°, mirrored left to right and front to back as a designer would type them.
LEG_XYZ = [(0.3, 0.1, 0), (0.3, -0.1, 0), (-0.3, 0.1, 0), (-0.3, -0.1, 0)]
LEG_RPY = [(0, 0, 0.349), (0, 0, -0.349), (0, 0, -0.349), (0, 0, 0.349)]
LEG_AXES = [(0, 1, 0)] * 4

angle = st.floats(-math.pi, math.pi)
# Along the axes, or clearly not: a symmetry that is a fraction of a degree off decides nothing.
pose = st.one_of(
    st.sampled_from((0.0, math.pi / 2, math.pi, -math.pi / 2)),
    angle.filter(lambda a: abs((a + math.pi / 4) % (math.pi / 2) - math.pi / 4) > 0.05),
)
offset = st.floats(-1.0, 1.0)


def frames(rpy: object) -> np.ndarray:
    return np.array([rpy_to_matrix(one) for one in rpy])  # type: ignore[attr-defined]


def get_odd_frame(xyz: object, turns: object, axes: object) -> OddFrame:
    odd = find_odd_frame(xyz, turns, axes)  # type: ignore[arg-type]
    assert odd is not None
    return odd


def ring(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Siblings on a circle, each looking outwards."""
    angles = 2 * math.pi * np.arange(count) / count
    places = np.column_stack((np.cos(angles), np.sin(angles), np.zeros(count)))
    return places, frames([(0, 0, a) for a in angles])


# --- the car ---------------------------------------------------------------------------------------------------------


def test_the_wheel_that_was_turned_by_hand_is_found() -> None:
    odd = get_odd_frame(CAR_XYZ, frames(CAR_RPY), CAR_AXES)
    assert odd.index == 0
    assert odd.kind == "zero_offset"
    assert odd.angle == pytest.approx(-0.75239)
    assert math.degrees(odd.angle) == pytest.approx(-43.109, abs=5e-4)
    assert odd.axis == pytest.approx((0, 1, 0))
    assert_allclose(odd.expected_frame, np.eye(3), atol=1e-5)
    assert (odd.bad_pairs, odd.good_pairs) == (3, 3)
    assert odd.agreement > 0.9
    assert odd.pattern == "rotation by 180° about z and translation along x"


def test_nothing_is_found_once_it_is_turned_back() -> None:
    assert find_odd_frame(CAR_XYZ, frames(REPAIRED), CAR_AXES) is None


@pytest.mark.parametrize("yaw", [(0, 0, 0, 0), (0, 0, math.pi, math.pi), (0, math.pi, math.pi, 0)])
def test_frames_that_differ_by_a_choice_of_axes_are_no_pattern_to_break(yaw: tuple[float, ...]) -> None:
    assert find_odd_frame(CAR_XYZ, frames([(0, 0, y) for y in yaw]), CAR_AXES) is None


@pytest.mark.parametrize("quarters", [1, 2, 3])
def test_quarter_turns_are_a_choice_of_axes(quarters: int) -> None:
    turned = [(0, quarters * math.pi / 2, 0), *REPAIRED[1:]]
    assert find_odd_frame(CAR_XYZ, frames(turned), CAR_AXES) is None


@settings(max_examples=60)
@given(
    order=st.permutations(range(4)),
    rpy=st.tuples(pose, pose, pose),
    move=st.tuples(offset, offset, offset),
    scale=st.floats(0.5, 20.0),
    odd=st.booleans(),
)
def test_the_verdict_depends_on_neither_order_nor_pose_nor_size(
    order: list[int], rpy: tuple[float, ...], move: tuple[float, ...], scale: float, odd: bool
) -> None:
    base = rpy_to_matrix(rpy)
    places = scale * np.array(CAR_XYZ)[order] @ base.T + move
    turns = base @ frames(CAR_RPY if odd else REPAIRED)[order]
    verdict = find_odd_frame(places, turns, np.array(CAR_AXES)[order])
    if not odd:
        assert verdict is None
        return
    assert verdict is not None
    assert order[verdict.index] == 0
    assert verdict.kind == "zero_offset"
    assert verdict.angle == pytest.approx(-0.75239, abs=1e-5)
    assert_allclose(verdict.axis, base @ (0, 1, 0), atol=1e-5)
    assert_allclose(verdict.expected_frame, base, atol=1e-5)


@pytest.mark.parametrize("across", range(3))
@pytest.mark.parametrize("rpy", [(0, -0.75239, 0), (0.02, 0, 0.03)])
def test_a_mirrored_robot_has_the_same_odd_one(across: int, rpy: tuple[float, float, float]) -> None:
    turns = frames([rpy, *CAR_RPY[1:]])
    usual = get_odd_frame(CAR_XYZ, turns, CAR_AXES)
    mirror = np.eye(3)
    mirror[across, across] = -1.0
    image = get_odd_frame(CAR_XYZ @ mirror, mirror @ turns @ mirror, CAR_AXES @ mirror)
    assert (image.index, image.kind) == (usual.index, usual.kind)
    assert abs(image.angle) == pytest.approx(abs(usual.angle))
    assert_allclose(image.expected_frame, mirror @ usual.expected_frame @ mirror, atol=1e-9)


@settings(max_examples=60)
@given(st.integers(0, 3), st.floats(math.radians(2), math.radians(88)), st.booleans())
def test_an_offset_of_any_wheel_has_its_sign_about_that_wheels_axis(index: int, size: float, back: bool) -> None:
    turn = -size if back else size
    turns = frames(REPAIRED)
    axis = np.array(CAR_AXES[index], dtype=float)
    turns[index] = turns[index] @ rpy_to_matrix((0, turn * axis[1], 0))
    odd = get_odd_frame(CAR_XYZ, turns, CAR_AXES)
    assert (odd.index, odd.kind) == (index, "zero_offset")
    assert odd.angle == pytest.approx(turn, abs=1e-4)


@settings(max_examples=60)
@given(st.integers(0, 3), st.floats(math.radians(0.3), math.radians(40)), angle)
def test_a_tilted_wheel_is_told_from_a_turned_one(index: int, tilt: float, about: float) -> None:
    turns = frames(REPAIRED)
    across = rpy_to_matrix((0, about, 0)) @ rpy_to_matrix((tilt, 0, 0)) @ rpy_to_matrix((0, -about, 0))
    turns[index] = turns[index] @ across
    odd = get_odd_frame(CAR_XYZ, turns, CAR_AXES)
    assert (odd.index, odd.kind) == (index, "axis_tilt")
    assert odd.angle == pytest.approx(tilt, abs=1e-4)
    assert odd.axis @ (turns[index] @ CAR_AXES[index]) == pytest.approx(0.0, abs=1e-9)


# --- other patterns --------------------------------------------------------------------------------------------------


def test_splayed_legs_follow_their_mirrors() -> None:
    assert find_odd_frame(LEG_XYZ, frames(LEG_RPY), LEG_AXES) is None
    turned = [*LEG_RPY[:2], (0, 0, -0.249), LEG_RPY[3]]
    odd = get_odd_frame(LEG_XYZ, frames(turned), LEG_AXES)
    assert (odd.index, odd.kind) == (2, "axis_tilt")
    assert odd.angle == pytest.approx(0.1, abs=1e-6)
    assert_allclose(odd.expected_frame, rpy_to_matrix(LEG_RPY[2]), atol=1e-6)


@pytest.mark.parametrize("count", [3, 4, 5, 6, 8])
def test_siblings_on_a_ring_follow_its_rotation(count: int) -> None:
    places, turns = ring(count)
    assert find_odd_frame(places, turns, [(0, 0, 1)] * count) is None


@settings(max_examples=60)
@given(st.sampled_from((3, 4, 5, 6, 8)), st.data(), st.tuples(offset, offset, offset))
def test_on_a_ring_the_right_one_is_named_or_none(
    count: int, data: st.DataObject, rpy: tuple[float, float, float]
) -> None:
    places, turns = ring(count)
    index = data.draw(st.integers(0, count - 1))
    turns[index] = turns[index] @ rpy_to_matrix(rpy)
    odd = find_odd_frame(places, turns, [(0, 0, 1)] * count)
    assert odd is None or odd.index == index


@pytest.mark.parametrize("count", [3, 5, 6, 8])
def test_on_a_ring_one_that_is_turned_is_named(count: int) -> None:
    places, turns = ring(count)
    turns[1] = turns[1] @ rpy_to_matrix((0, 0, 0.4))
    odd = get_odd_frame(places, turns, [(0, 0, 1)] * count)
    assert (odd.index, odd.kind, odd.angle) == (1, "zero_offset", pytest.approx(0.4))


def test_rows_that_differ_among_themselves_do_not_hide_the_symmetry_of_left_and_right() -> None:
    # Eight hips, splayed differently from front to back: no shift carries one frame onto the next.
    places = [(x, y, 0) for x in (0.3, 0.1, -0.1, -0.3) for y in (0.1, -0.1)]
    turns = frames([(0, 0, s * a) for a in (0.5, 0.2, -0.2, -0.5) for s in (1, -1)])
    assert find_odd_frame(places, turns, [(0, 1, 0)] * 8) is None
    turns[3] = turns[3] @ rpy_to_matrix((0, 0.3, 0))
    odd = get_odd_frame(places, turns, [(0, 1, 0)] * 8)
    assert (odd.index, odd.kind, odd.angle) == (3, "zero_offset", pytest.approx(0.3))


def test_a_row_follows_its_shift() -> None:
    places = [(0.1 * i, 0, 0) for i in range(4)]
    turns = frames([(0, 0, 0), (0, 0.3, 0), (0, 0, 0), (0, 0, 0)])
    odd = get_odd_frame(places, turns, [(0, 1, 0)] * 4)
    assert (odd.index, odd.kind, odd.angle) == (1, "zero_offset", pytest.approx(0.3))
    assert "translation along x" in odd.pattern


# --- where it abstains -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [0, 1, 2])
def test_of_up_to_two_nobody_can_say_which_one_is_wrong(count: int) -> None:
    places, turns = ring(count) if count else (np.empty((0, 3)), np.empty((0, 3, 3)))
    turns[:1] = turns[:1] @ rpy_to_matrix((0, 0, 0.4))
    assert find_odd_frame(places, turns, [(0, 0, 1)] * count) is None


def test_a_row_of_three_is_not_enough() -> None:
    turns = frames([(0, 0.3, 0), (0, 0, 0), (0, 0, 0)])
    assert find_odd_frame([(0.1 * i, 0, 0) for i in range(3)], turns, [(0, 1, 0)] * 3) is None


def test_an_axis_that_points_nearer_to_another_choice_of_axes_is_no_tilt() -> None:
    # The third frame is turned by 180°, which the first would have to follow; it is 40° from not following.
    turns = frames([(0, 0, 0.7), (0, 0, 0), (math.pi, 0, 0), (0, 0, 0)])
    assert find_odd_frame(CAR_XYZ, turns, [(0, 1, 0)] * 4) is None


def test_two_against_two_have_no_culprit() -> None:
    turns = frames([(0, 0.4, 0), (0, 0.4, 0), (0, 0, 0), (0, 0, 0)])
    assert find_odd_frame(CAR_XYZ, turns, CAR_AXES) is None


def test_positions_without_symmetry_have_no_pattern() -> None:
    places = [(0, 0, 0), (1, 0.1, 0), (0.2, 1.3, 0.1), (2.2, 1.9, 0.7)]
    assert find_odd_frame(places, frames(CAR_RPY), CAR_AXES) is None


def test_typing_errors_below_the_tolerance_are_not_an_odd_one() -> None:
    turns = frames([(0, 0.0008, 0), (0, 0, 0), (0, 0, 3.14), (0, 0, 3.1416)])
    assert find_odd_frame(CAR_XYZ, turns, CAR_AXES) is None


def test_numbers_that_are_no_geometry_have_no_pattern() -> None:
    assert find_odd_frame(np.full((4, 3), np.nan), frames(CAR_RPY), CAR_AXES) is None
    assert find_odd_frame(CAR_XYZ, frames(CAR_RPY), np.zeros((4, 3))) is None
    assert find_odd_frame(np.zeros((4, 3)), frames(CAR_RPY), CAR_AXES) is None


# --- suspects --------------------------------------------------------------------------------------------------------

PAIR_XYZ = [(0, 0.1, 0), (0, -0.1, 0)]


@pytest.mark.parametrize("yaw", [0, math.pi])
@pytest.mark.parametrize("odd", [0, 1])
def test_a_pair_is_shown_as_a_pair(yaw: float, odd: int) -> None:
    rpy = [[0.0, 0.0, 0.0], [0.0, 0.0, yaw]]
    axes = [(0, 1, 0), (0, -1 if yaw else 1, 0)]
    assert find_suspect_frames(PAIR_XYZ, frames(rpy), axes) is None
    rpy[odd][1] = -0.75239
    pair = find_suspect_frames(PAIR_XYZ, frames(rpy), axes)
    assert pair is not None
    assert (pair.members, pair.kind) == ((0, 1), "zero_offset")
    assert [abs(a) for a in pair.angles] == pytest.approx([0.75239, 0.75239])
    restored = frames([(0, 0, 0), (0, 0, yaw)])[odd]
    assert_allclose(pair.expected_frames[odd], restored, atol=1e-9)


@pytest.mark.parametrize(
    "rpy", [[(0, 0.4, 0), (0, 0.4, 0)], [(0.2, 0, 0), (-0.2, 0, 0)], [(0, 0, 0), (0, math.pi / 2, 0)]]
)
def test_mirror_images_repetitions_and_quarter_turns_are_no_suspects(rpy: list[tuple[float, float, float]]) -> None:
    assert find_suspect_frames(PAIR_XYZ, frames(rpy), [(0, 1, 0)] * 2) is None


def test_a_shift_along_all_axes_is_no_pattern_of_two() -> None:
    rpy, axes = [(0, 0.4, 0), (0, 0.8, 0)], [(0, 1, 0)] * 2
    assert find_suspect_frames([(0.08, 0.1, 0.03), (0.085, -0.1, 0.03)], frames(rpy), axes) is not None
    assert find_suspect_frames([(0.08, 0.1, 0.03), (0.085, -0.1, -0.03)], frames(rpy), axes) is None


@pytest.mark.parametrize(("second_axis", "is_pair"), [(1, True), (-1, False)])
def test_a_joint_that_turns_the_other_way_is_no_shifted_copy(second_axis: int, is_pair: bool) -> None:
    """Fingers that lean towards each other, 5 mm beside the places of mirror images."""
    places, rpy = [(0.095, 0.038, -0.1), (0.1, 0.038, 0.072)], [(0, -0.42, 0), (0, 0.32, 0)]
    pair = find_suspect_frames(places, frames(rpy), [(0, 1, 0), (0, second_axis, 0)])
    assert (pair is not None) == is_pair


def test_hands_of_many_fingers_show_the_pair_that_differs() -> None:
    heights = [0.30, 0.33, 0.35, 0.31]
    places = [(0.02 * i**2, side * 0.4, z) for i, z in enumerate(heights) for side in (1, -1)]
    turns = frames([(side * 0.1 * i, 0, 0) for i in range(4) for side in (1, -1)])
    assert find_suspect_frames(places, turns, [(0, 1, 0)] * 8) is None
    turns[4] = turns[4] @ rpy_to_matrix((0, 0.3, 0))
    pair = find_suspect_frames(places, turns, [(0, 1, 0)] * 8)
    assert pair is not None
    assert (pair.members, pair.kind, pair.pattern) == ((4, 5), "zero_offset", "mirror y")
    turns[2] = turns[2] @ rpy_to_matrix((0, 0.2, 0))
    assert find_suspect_frames(places, turns, [(0, 1, 0)] * 8) is None


@pytest.mark.parametrize("odd", [0, 1, 2])
def test_of_a_row_of_three_the_one_that_differs_from_both_others_is_shown(odd: int) -> None:
    places = [(0.1 * i, 0, 0) for i in range(3)]
    turns = frames([(0, 0.3 * (i == odd), 0) for i in range(3)])
    one = find_suspect_frames(places, turns, [(0, 1, 0)] * 3)
    assert one is not None
    assert (one.members, one.kind) == ((odd,), "zero_offset")
    assert one.angles == pytest.approx((0.3,))


def test_the_half_turn_that_relates_two_frames_is_named() -> None:
    """Places that differ in z alone are mapped by half turns about x and about y."""
    places = [(0.0, 0.0, 0.03), (0.0, 0.0, 0.01)]
    turns = frames([(3.1367, 1.5708, 0), (3.14159, -1.5708, 0)])
    pair = find_suspect_frames(places, turns, [(0, 0, -1)] * 2)
    assert pair is not None
    assert (pair.kind, pair.pattern) == ("axis_tilt", "rotation by 180° about y")


def test_three_of_which_none_fits_have_no_suspect() -> None:
    places = [(0.1 * i, 0, 0) for i in range(3)]
    assert find_suspect_frames(places, frames([(0, 0, 0), (0, 0.3, 0), (0, 0.7, 0)]), [(0, 1, 0)] * 3) is None


# --- grouping --------------------------------------------------------------------------------------------------------


def test_like_links_are_grouped_across_rounding_boundaries_and_whatever_the_order_of_their_moments() -> None:
    signatures = [
        build_link_signature(0.99996, (1.0e-3, 2.0e-3, 2.5e-3)),
        build_link_signature(2.0, (1.0e-3, 2.0e-3, 2.5e-3)),
        build_link_signature(1.00004, (2.5e-3, 1.01e-3, 2.0e-3)),
        build_link_signature(1.0, (1.0e-3, 2.0e-3, 3.5e-3)),
        build_link_signature(1.0, (1.0e-3, 2.0e-3, 2.5e-3), (0.1, 0.2, 0.3)),
    ]
    assert group_by_signature(signatures) == [[0, 2], [1], [3], [4]]
    assert len(set(signatures)) == 5


def test_rounding_residue_in_a_small_moment_does_not_part_links() -> None:
    rods = [build_link_signature(1.0, (1e-12, 0.1, 0.1)), build_link_signature(1.0, (-3e-12, 0.1, 0.1))]
    assert group_by_signature(rods) == [[0, 1]]


def test_massless_links_are_alike() -> None:
    assert group_by_signature([build_link_signature(0.0, (0, 0, 0)), build_link_signature(0.0, (0, 0, 0))]) == [[0, 1]]


@given(st.permutations([1.0, 1.004, 1.008, 2.0, 2.005, 3.0]))
def test_groups_do_not_depend_on_order(masses: list[float]) -> None:
    groups = group_by_signature([build_link_signature(m, (1, 1, 1)) for m in masses])
    assert sorted(sorted(masses[i] for i in g) for g in groups) == [[1.0, 1.004, 1.008], [2.0, 2.005], [3.0]]
