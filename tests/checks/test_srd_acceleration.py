"""SRD005: acceleration limits that MoveIt 2 needs."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import find, robot
from conftest import check

from urdfcheck.core import Finding, Severity

ROS_2 = '<package format="3"><name>arm</name><version>1.0.0</version><buildtool_depend>ament_cmake</buildtool_depend></package>'
ROS_1 = ROS_2.replace("ament_cmake", "catkin")


def joint(name: str, parent: str, child: str, more: str = "", kind: str = "continuous") -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}<axis xyz="0 1 0"/>{more}</joint>'


ARM = (
    "".join(f'<link name="{name}"/>' for name in ("base", "upper", "fore", "tool", "jaw"))
    + joint("shoulder", "base", "upper")
    + joint("elbow", "upper", "fore")
    + joint("mount", "fore", "tool", kind="fixed")
    + joint("grip", "tool", "jaw", '<mimic joint="elbow"/>')
)
GROUP = '<group name="arm"><chain base_link="base" tip_link="tool"/></group>'


def limit(name: str, flag: str = "true", value: str = "2.0") -> str:
    return f"  {name}:\n    has_acceleration_limits: {flag}\n    max_acceleration: {value}\n"


def find_limits(folder: Path, limits: str, srdf: str = GROUP, manifest: str = ROS_2, **more: str) -> list[Finding]:
    files = {
        "package.xml": manifest,
        "urdf/arm.urdf": robot(ARM, name="arm"),
        "config/arm.srdf": robot(srdf, name="arm"),
        "config/joint_limits.yaml": f"joint_limits:\n{limits}",
        **{f"config/{name}.yaml": text for name, text in more.items()},
    }
    return find(folder / "arm", files, "SRD005", name="urdf/arm.urdf")


GOOD = limit("shoulder") + limit("elbow")


@pytest.mark.parametrize(
    ("limits", "joints"),
    [
        (GOOD, ""),
        (limit("shoulder") + limit("elbow", "false"), "elbow"),
        (limit("shoulder", "false", "0.0") + limit("elbow", "false", "0.0"), "shoulder, elbow"),
        (limit("shoulder") + "  elbow:\n    has_velocity_limits: true\n    max_velocity: 1.0\n", "elbow"),
        (limit("shoulder") + "  elbow:\n    max_acceleration: 1.0\n", "elbow"),
        (limit("shoulder"), "elbow"),
        (limit("other") + limit("third") + limit("shoulder", "false"), ""),  # another robot's
    ],
)
def test_joints_of_groups_need_a_limit(tmp_path: Path, limits: str, joints: str) -> None:
    findings = find_limits(tmp_path, limits)
    assert [f.data["joints"] for f in findings] == [joints] * bool(joints)
    assert all(f.severity is Severity.WARNING for f in findings)


def test_only_ros_2_and_planned_joints(tmp_path: Path) -> None:
    some = limit("shoulder") + limit("elbow", "false")
    assert not find_limits(tmp_path / "ros1", some, manifest=ROS_1)
    passive = find_limits(tmp_path / "passive", some, srdf=GROUP + '<passive_joint name="elbow"/>')
    assert not passive
    group = '<group name="arm"><joint name="shoulder"/></group>'
    assert not find_limits(tmp_path / "group", some, srdf=group)


def test_the_pipeline_of_the_configuration_decides(tmp_path: Path) -> None:
    some = limit("shoulder") + limit("elbow", "false")
    timed = "response_adapters:\n  - default_planning_response_adapters/AddTimeOptimalParameterization\n"
    assert find_limits(tmp_path / "a", some, ompl_planning=timed)
    assert not find_limits(tmp_path / "b", some, ompl_planning="planning_plugin: ompl_interface/OMPLPlanner\n")


def test_names_without_the_prefix_of_the_robot(tmp_path: Path) -> None:
    arm = ARM.replace('joint="elbow"', 'joint="a_elbow"')
    for name in ("shoulder", "elbow"):
        arm = arm.replace(f'<joint name="{name}"', f'<joint name="a_{name}"')
    files = {
        "package.xml": ROS_2,
        "urdf/arm.urdf": robot(arm, name="arm"),
        "config/arm.srdf": robot(GROUP, name="arm"),
        "config/joint_limits.yaml": f"joint_limits:\n{GOOD}",
    }
    (finding,) = find(tmp_path / "arm", files, "SRD005", name="urdf/arm.urdf")
    assert (finding.message_id, finding.data["prefix"]) == ("prefix", "a_")
    # A file beside it that names the joints is the robot's: the other one is of another robot.
    files["config/dual_joint_limits.yaml"] = f"joint_limits:\n{limit('a_shoulder')}{limit('a_elbow')}"
    assert not find(tmp_path / "dual", files, "SRD005", name="urdf/arm.urdf")


def test_another_target_makes_it_a_note(tmp_path: Path) -> None:
    assert find_limits(tmp_path, limit("shoulder"))
    run = check(tmp_path / "arm" / "urdf" / "arm.urdf", codes={"SRD005"}, targets=("mujoco",))
    assert [f.severity for f in run.findings] == [Severity.INFO]
