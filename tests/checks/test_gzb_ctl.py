"""Gazebo blocks and control interfaces."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import check_text

from urdfcheck.core import Finding, Severity

ARM = """<link name="a"/><link name="b"/><link name="c"/>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint>
<joint name="k" type="continuous"><parent link="a"/><child link="c"/></joint>"""


def found(folder: Path, body: str, code: str, arm: str = ARM) -> tuple[Finding, ...]:
    run = check_text(folder, f'<robot name="r">{arm}{body}</robot>', codes={code})
    assert not run.failures
    return run.findings


@pytest.mark.parametrize("reference", ["a", "j"])
def test_links_and_joints_can_be_referred_to(tmp_path: Path, reference: str) -> None:
    assert not found(tmp_path, f'<gazebo reference="{reference}"><mu1>1</mu1></gazebo>', "GZB001")


def test_one_unknown_name_is_one_finding(tmp_path: Path) -> None:
    body = '<gazebo reference="nobody"><mu1>1</mu1></gazebo>\n<gazebo reference="nobody"><mu2>1</mu2></gazebo>'
    (finding,) = found(tmp_path, body, "GZB001")
    assert "mu1, mu2" in finding.message
    assert len(finding.related) == 1


@pytest.mark.parametrize(
    ("filename", "words"),
    [
        ("libgazebo_ros_diff_drive.so", "gz-sim-diff-drive-system"),
        ("libgazebo_ros2_control.so", "gz_ros2_control"),
        ("libgazebo_ros_depth_camera.so", "gz-sim-sensors-system"),
        ("libhector_gazebo_ros_imu.so", "gz-sim-imu-system"),
        ("gz-sim-imu-system", None),
        ("ignition-gazebo-imu-system", None),
        ("libgz_ros2_control-system.so", None),
    ],
)
def test_plugins_of_gazebo_classic_have_a_successor(tmp_path: Path, filename: str, words: str | None) -> None:
    findings = found(tmp_path, f'<gazebo><plugin name="p" filename="{filename}"/></gazebo>', "GZB002")
    assert bool(findings) == (words is not None)
    assert all(f.fix is not None and str(words) in f.fix.title for f in findings)


def test_a_transmission_of_the_pr2_may_name_its_joint_anywhere(tmp_path: Path) -> None:
    body = '<transmission name="t"><rightActuator name="m"/><joint name="joint"/></transmission>'
    (finding,) = found(tmp_path, body, "CTL001")
    assert finding.location.subject == "transmission[t]/joint[joint]@name"


@pytest.mark.parametrize(
    "body",
    [
        '<transmission name="t"><joint name="j"/><joint name="k"/></transmission>',
        '<gazebo><plugin filename="gz-sim-diff-drive-system"><left_joint>j</left_joint>'
        "<right_joint> k </right_joint></plugin></gazebo>",
        '<gazebo><plugin filename="libgazebo_ros_joint.so"><jointName>j, k</jointName></plugin></gazebo>',
    ],
)
def test_any_mention_in_control_counts_as_a_drive(tmp_path: Path, body: str) -> None:
    assert not found(tmp_path, body, "CTL002")


def test_a_gazebo_reference_is_no_drive(tmp_path: Path) -> None:
    body = '<gazebo reference="j"/><gazebo reference="k"/>'
    assert [f.message_id for f in found(tmp_path, body, "CTL002")] == ["none"]


def test_joints_left_out_of_control_are_listed(tmp_path: Path) -> None:
    (finding,) = found(tmp_path, '<transmission name="t"><joint name="j"/></transmission>', "CTL002")
    assert (finding.message_id, finding.location.subject) == ("some", "joint[k]")


def test_a_joint_without_effort_needs_no_drive(tmp_path: Path) -> None:
    arm = ARM.replace('<child link="c"/>', '<child link="c"/><limit effort="0" velocity="1"/>')
    assert not found(tmp_path, '<transmission name="t"><joint name="j"/></transmission>', "CTL002", arm)


FOLLOWER = ARM.replace('<child link="c"/>', '<child link="c"/><mimic joint="j"/>')
COMMAND = '<command_interface name="position"/>'


def control(attributes: str = "", inner: str = COMMAND) -> str:
    return (
        f'<ros2_control name="c" type="system"><joint name="j">{COMMAND}</joint>'
        f'<joint name="k" {attributes}>{inner}</joint></ros2_control>'
    )


def test_a_follower_takes_no_command(tmp_path: Path) -> None:
    (finding,) = found(tmp_path, control(), "CTL002", FOLLOWER)
    assert (finding.message_id, finding.severity) == ("mimic", Severity.WARNING)


@pytest.mark.parametrize("body", [control('mimic="false"'), control(inner='<state_interface name="position"/>')])
def test_a_follower_may_be_measured_or_told_not_to_follow(tmp_path: Path, body: str) -> None:
    assert not found(tmp_path, body, "CTL002", FOLLOWER)


def test_a_fixed_joint_takes_no_command(tmp_path: Path) -> None:
    arm = ARM.replace('"k" type="continuous"', '"k" type="fixed"')
    assert [f.message_id for f in found(tmp_path, control(), "CTL002", arm)] == ["fixed"]
