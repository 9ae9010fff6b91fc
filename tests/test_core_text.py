"""How messages write counts, numbers and lengths."""

from __future__ import annotations

import pytest

from urdfcheck.core.text import (
    find_nearest_name,
    find_only_near_name,
    format_box_size,
    format_count,
    format_large_count,
    format_length,
    format_point,
    format_repetition,
    format_share,
    join_numbers,
    round_decimals,
    truncate_text,
)


@pytest.mark.parametrize(
    ("metres", "shown", "fine"),
    [(1.5, "1.5 m", "1.5 m"), (0.0351, "35.1 mm", "35.1 mm"), (4e-5, "0.04 mm", "40 µm"), (0.0, "0 mm", "0 µm")],
)
def test_lengths_have_the_unit_of_their_size(metres: float, shown: str, fine: str) -> None:
    assert (format_length(metres), format_length(metres, micrometres=True)) == (shown, fine)


def test_lengths_have_as_many_digits_as_asked_for() -> None:
    assert format_length(1.23456, digits=4) == "1.235 m"


def test_a_text_has_no_digits_that_come_from_the_computation() -> None:
    typed = "0.32000000000000006 -1.5707963267948966 1e-3 0.5 arm_0.12345678901 3.141592653589793e-05 0.123456789…"
    assert round_decimals(typed) == "0.32 -1.570796327 1e-3 0.5 arm_0.12345678901 3.141592654e-05 0.123456789…"


def test_a_count_agrees_with_its_noun_and_verb() -> None:
    assert (format_count(1, "file"), format_count(2, "file")) == ("1 file", "2 files")
    assert (format_count(1, "joint has", "joints have"), format_count(3, "joint has", "joints have")) == (
        "1 joint has",
        "3 joints have",
    )


def test_one_occurrence_is_not_a_repetition() -> None:
    assert (format_repetition(1), format_repetition(3)) == ("", " (3 times)")


def test_numbers_have_significant_digits() -> None:
    assert join_numbers([0.123456, 2.0], digits=3) == "0.123, 2"
    assert format_box_size([0.4, 0.25]) == "0.4 × 0.25 m"


def test_coordinates_have_decimals_and_no_negative_zero() -> None:
    assert format_point([-1e-9, 0.1234, -1.0], decimals=3) == "0 0.123 -1"


def test_a_large_count_has_separators() -> None:
    assert (format_large_count(1, "edge"), format_large_count(12345, "edge")) == ("1 edge", "12,345 edges")


def test_only_a_long_text_is_truncated() -> None:
    assert (truncate_text("12345678", 8), truncate_text("123456789", 8)) == ("12345678", "12345...")


@pytest.mark.parametrize(
    ("name", "known", "near"),
    [
        ("r_gripper_l_parallel_link", "r_gripper_palm_link", None),
        ("r_gripper_l_parallel_link", "r_gripper_l_parallel_root_link", "r_gripper_l_parallel_root_link"),
        ("r_wheel", "l_wheel", None),
        ("left_weel", "left_wheel", "left_wheel"),
        ("left_weel", "leftwheel", "leftwheel"),
        ("lfet_wheel", "left_wheel", "left_wheel"),
        ("caster_front_right_link", "caster_right_link", None),
        ("caster_front_right_link", "caster_rear_right_link", None),
        ("fornt_right_wheel", "front_right_wheel", "front_right_wheel"),
        ("l_hip_pitch", "left_hip_picth", "left_hip_picth"),
        ("jiont_1", "joint_2", None),
        ("jiont_1", "joint_01", "joint_01"),
        ("upper_arm_link", "arm_link", None),
        ("arm_0", "arm", "arm"),
        ("arm_1", "arm", "arm"),
        ("3d_mini_drive.launch", "mini_drive.launch", "mini_drive.launch"),
    ],
)
def test_a_part_of_another_side_is_not_another_spelling(name: str, known: str, near: str | None) -> None:
    assert find_nearest_name(name, [known]) == near


@pytest.mark.parametrize(
    ("name", "known", "near"),
    [
        ("base_joint", "eg_joint", None),
        ("front_left_calf", "front_left_foot", None),
        ("laser_link", "base_link", None),
        ("lite_grey", "light_grey", "light_grey"),
        ("front_left_wheel_joint", "front_left_steering_joint", None),
        ("iiwa14_limits.xacro", "iiwa14.xacro", "iiwa14.xacro"),
        ("wheel_left_link", "left_wheel_link", "left_wheel_link"),
        ("leftThumbMotorRoll", "leftThumbRoll", "leftThumbRoll"),
    ],
)
def test_a_name_with_another_word_is_not_another_spelling(name: str, known: str, near: str | None) -> None:
    assert find_nearest_name(name, [known], likeness=0.6) == near


def test_a_name_that_lacks_a_word_of_several_names_none_of_them() -> None:
    assert find_nearest_name("right_wheel", ["front_right_wheel", "back_right_wheel"]) is None
    assert find_nearest_name("right_wheel", ["front_right_wheel", "front_left_wheel"]) == "front_right_wheel"
    assert find_nearest_name("rigth_wheel", ["right_wheel", "back_right_wheel"]) == "right_wheel"


@pytest.mark.parametrize(
    ("name", "near"),
    [
        ("left_hip", "left_hip_joint"),
        ("leftHipJoint", "left_hip_joint"),
        ("hip", None),
        ("joint1", None),
        ("arm1", None),
    ],
)
def test_a_short_name_without_its_kind_is_another_spelling(name: str, near: str | None) -> None:
    assert find_nearest_name(name, ["left_hip_joint", "left_ankle_joint", "right_hip_joint", "link1", "arm_2"]) == near


def test_a_name_is_edited_only_if_no_name_of_either_side_is_near() -> None:
    known = ["r_forearm_link", "left_forearm_link"]
    assert find_nearest_name("l_forearm_link", known) == "left_forearm_link"
    assert find_only_near_name("l_forearm_link", known) is None


def test_a_name_with_a_word_more_or_less_is_a_question_and_no_slip() -> None:
    assert find_nearest_name("arm_wrist_mount_link", ["arm_wrist_link"]) == "arm_wrist_link"
    assert find_only_near_name("arm_wrist_mount_link", ["arm_wrist_link"]) is None
    assert find_only_near_name("arm_wirst_link", ["arm_wrist_link"]) == "arm_wrist_link"
    assert find_only_near_name("arm_wrist", ["arm_wrist_link"]) == "arm_wrist_link"


@pytest.mark.parametrize(
    ("before", "after", "expected"),
    [
        (100.0, 104.94, " (+4.9 %)"),
        (4.0, 3.0, " (-25 %)"),
        (0.6, 1.6, " (+167 %)"),
        (0.05, 0.5, " (10 times)"),
        (1.0, 1e6, " (1,000,000 times)"),
        (0.0, 2.0, ""),
    ],
)
def test_a_share_has_no_exponent(before: float, after: float, expected: str) -> None:
    assert format_share(before, after) == expected
