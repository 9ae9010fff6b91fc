"""JNT022: mimic joints that a simulator does not couple."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import find, joint, limit, link, robot

MIMIC = '<mimic joint="left" multiplier="-1"/>'
FINGERS = (
    link("palm"),
    link("one"),
    joint("left", "palm", "one", limit(0, 1), kind="revolute", axis="0 0 1"),
    link("two"),
    joint("right", "palm", "two", limit(-1, 0), MIMIC, kind="revolute", axis="0 0 1"),
)
GAZEBO = '<gazebo><plugin filename="gz-sim-pose-publisher-system" name="gz::sim::systems::PosePublisher"/></gazebo>'


def test_gazebo_is_named_by_the_file_or_by_the_target(tmp_path: Path) -> None:
    assert find(tmp_path, robot(*FINGERS), "JNT022") == []
    assert [f.message_id for f in find(tmp_path, robot(*FINGERS, GAZEBO), "JNT022")] == ["gazebo"]
    assert [f.message_id for f in find(tmp_path, robot(*FINGERS), "JNT022", targets=("gazebo",))] == ["gazebo"]
    assert find(tmp_path, robot(*FINGERS, GAZEBO), "JNT022", targets=("moveit",)) == []


@pytest.mark.parametrize(
    "other",
    [
        '<ros2_control name="a" type="system"><joint name="right"/></ros2_control>',
        '<transmission name="a"><joint name="right"/></transmission>',
        '<gazebo><plugin filename="libroboticsgroup_gazebo_mimic_joint_plugin.so" name="m"/></gazebo>',
        '<gazebo><plugin filename="differential" name="d"><b>right</b></plugin></gazebo>',
    ],
)
def test_what_moves_the_follower_otherwise(tmp_path: Path, other: str) -> None:
    assert find(tmp_path, robot(*FINGERS, GAZEBO, other), "JNT022") == []


def test_isaac_needs_limits_of_the_follower(tmp_path: Path) -> None:
    assert find(tmp_path, robot(*FINGERS), "JNT022", targets=("isaac",)) == []
    endless = (
        robot(*FINGERS)
        .replace(limit(-1, 0) + MIMIC, MIMIC)
        .replace('"right" type="revolute"', '"right" type="continuous"')
    )
    assert [f.message_id for f in find(tmp_path, endless, "JNT022", targets=("isaac",))] == ["isaac"]
