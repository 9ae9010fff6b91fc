"""JNT019 and JNT020: where joints start, and limits that are the same everywhere."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import find, inertial, joint, limit, link, robot
from conftest import check

from urdfcheck.core import Finding, Severity

ARM = (
    '<robot name="arm"><link name="base"/><link name="arm"><inertial><origin xyz="0.2 0 0"/><mass value="1"/>'
    '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link><link name="end"/>'
    '<joint name="j" type="{kind}"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>'
    '<limit {limit} effort="10" velocity="2"/>{inner}</joint>'
    '<joint name="k" type="continuous"><parent link="arm"/><child link="end"/><axis xyz="0 0 1"/></joint>{more}</robot>'
)


CONTROLLED = '<gazebo><plugin name="control" filename="libgazebo_ros_control.so"/></gazebo>'


def find_zero(folder: Path, limit: str, kind: str = "revolute", inner: str = "", more: str = "") -> list[Finding]:
    return find(folder, ARM.format(limit=limit, kind=kind, inner=inner, more=more), "JNT019")


@pytest.mark.parametrize(
    ("limit", "message", "at"),
    [
        ('lower="0.5" upper="2"', "outside", "lower"),
        ('lower="-2" upper="-0.5"', "outside", "upper"),
        ('lower="0.01" upper="2"', None, ""),  # within the slack
        ('lower="0.0475" upper="1.6"', "near", "lower"),
        ('lower="-3.07" upper="-0.0698"', "near", "upper"),
        ('lower="0.11" upper="1.6"', "outside", "lower"),
        ('lower="0" upper="2"', "on-limit", "lower"),
        ('lower="-2" upper="0"', "on-limit", "upper"),
        ('upper="2"', "on-limit", ""),
        ('lower="-1" upper="2"', None, ""),
        ('lower="2" upper="0.5"', None, ""),  # JNT005
        ("", None, ""),
    ],
)
def test_zero_and_the_range(tmp_path: Path, limit: str, message: str | None, at: str) -> None:
    findings = find_zero(tmp_path, limit)
    assert [f.message_id for f in findings] == [message] * (message is not None)
    assert all(f.location.subject.endswith(f"@{at}" if at else "limit") for f in findings)


@pytest.mark.parametrize(
    ("limit", "message"),
    [
        ('lower="0.002" upper="0.031"', "near"),
        ('lower="0.006" upper="0.031"', "outside"),
        ('lower="0.002" upper="0.006"', "outside"),
    ],
)
def test_fingers_that_never_quite_close_are_near(tmp_path: Path, limit: str, message: str) -> None:
    (finding,) = find_zero(tmp_path, limit, kind="prismatic")
    assert finding.message_id == message


def test_where_it_is_not_zero_that_counts(tmp_path: Path) -> None:
    out = 'lower="0.5" upper="2"'
    assert not find_zero(tmp_path / "a", out, kind="continuous")
    assert not find_zero(tmp_path / "b", out, inner='<mimic joint="k"/>')
    start = (
        '<ros2_control name="c" type="system"><hardware><plugin>mock_components/GenericSystem</plugin></hardware>'
        '<joint name="{}"><state_interface name="position">'
        '<param name="initial_value">1.0</param></state_interface></joint></ros2_control>'
    )
    assert not find_zero(tmp_path / "c", out, more=start.format("j"))
    (finding,) = find_zero(tmp_path / "d", out, more=start.format("other"))
    assert finding.severity is Severity.WARNING


def test_a_note_unless_it_is_for_a_simulator(tmp_path: Path) -> None:
    (note,) = find_zero(tmp_path, 'lower="0.5" upper="2"')
    (warning,) = find_zero(tmp_path, 'lower="0.5" upper="2"', more=CONTROLLED)
    assert (note.severity, warning.severity) == (Severity.INFO, Severity.WARNING)
    hardware = "<ros2_control name='c' type='system'><hardware><plugin>{}</plugin></hardware></ros2_control>"
    plain = (
        '<transmission name="t"/>',
        "<gazebo><material>Gazebo/Red</material></gazebo>",
        hardware.format("motors/Motors"),
    )
    for more in plain:
        assert find_zero(tmp_path, 'lower="0.5" upper="2"', more=more)[0].severity is Severity.INFO
    (simulated,) = find_zero(tmp_path, 'lower="0.5" upper="2"', more=hardware.format("gz_ros2_control/GazeboSimSystem"))
    assert simulated.severity is Severity.WARNING
    (small,) = find_zero(tmp_path, 'lower="0.12" upper="4.5"', more=CONTROLLED)
    assert (small.message_id, small.severity) == ("outside", Severity.INFO)
    (near,) = find_zero(tmp_path, 'lower="0.07" upper="0.5"', more=CONTROLLED)
    assert (near.message_id, near.severity) == ("near", Severity.INFO)
    plugin = (
        '<gazebo><plugin name="p" filename="p.so"><initialConfiguration>0.7</initialConfiguration></plugin></gazebo>'
    )
    (placed,) = find_zero(tmp_path, 'lower="0.5" upper="2"', more=plugin)
    assert (placed.message_id, placed.severity) == ("meant", Severity.INFO)
    path = tmp_path / "arm.urdf"
    path.write_text(ARM.format(limit='lower="0.5" upper="2"', kind="revolute", inner="", more=""), encoding="utf-8")
    severities = {t: check(path, codes={"JNT019"}, targets=(t,)).findings[0].severity for t in ("mujoco", "rviz")}
    assert severities == {"mujoco": Severity.WARNING, "rviz": Severity.INFO}


@pytest.mark.parametrize(
    ("names", "severity"),
    [
        (("FL_knee", "FR_knee", "RL_knee", "RR_knee"), Severity.INFO),
        (("FL_knee", "FR_knee", "RL_knee", "RR_hip"), Severity.WARNING),
        (("left_knee", "right_knee"), Severity.INFO),
        (("LeftKneePitch", "RightKneePitch", "LeftFootPitch", "RightFootPitch"), Severity.INFO),
        (("left_knee", "right_elbow"), Severity.WARNING),
        (("left_elbow", "right_elbow"), Severity.WARNING),
    ],
)
def test_legs_bend_one_way_only(tmp_path: Path, names: tuple[str, ...], severity: Severity) -> None:
    parts = [
        part
        for name in names
        for part in (
            link(f"{name}_link", inertial()),
            joint(name, "base", f"{name}_link", limit(-2.5, -0.5), kind="revolute", axis="0 1 0"),
        )
    ]
    (finding,) = find(tmp_path, robot(link("base"), *parts, CONTROLLED), "JNT019")
    assert finding.severity is severity


def test_a_start_that_a_launch_file_passes(tmp_path: Path) -> None:
    out = {"limit": 'lower="0.5" upper="2"', "more": CONTROLLED}
    (warning,) = find_zero(tmp_path, **out)
    (tmp_path / "spawn.launch").write_text(
        '<launch><node pkg="gazebo_ros" args="-J j 1.0"/></launch>', encoding="utf-8"
    )
    (placed,) = find_zero(tmp_path, **out)
    assert (warning.message_id, placed.message_id) == ("outside", "meant")


def test_mujoco_pushes_the_joint_into_its_range() -> None:
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(
        ARM.format(limit='lower="0.5" upper="2"', kind="revolute", inner="", more="")
        .replace('<link name="end"/>', "")
        .split('<joint name="k"')[0]
        + "</robot>"
    )
    data = mujoco.MjData(model)
    fastest = 0.0
    for _ in range(100):
        mujoco.mj_step(model, data)
        fastest = max(fastest, abs(float(data.qvel[0])))
    assert 9 < fastest < 10  # the page's number


def chain(limits: list[str]) -> str:
    links = "".join(f'<link name="l{i}"/>' for i in range(len(limits) + 1))
    joints = "".join(
        f'<joint name="j{i}" type="revolute"><parent link="l{i}"/><child link="l{i + 1}"/><axis xyz="0 0 1"/>'
        f'<limit lower="-1" upper="1" {text}/></joint>'
        for i, text in enumerate(limits)
    )
    return f'<robot name="r">{links}{joints}</robot>'


@pytest.mark.parametrize(
    ("limits", "is_reported"),
    [
        (['effort="100" velocity="1"'] * 4, True),
        (['effort="2000" velocity="0.5"'] * 6, True),
        (['effort="100" velocity="1"'] * 3, False),
        (['effort="2.8" velocity="5.2"'] * 6, False),
        (['effort="100" velocity="1"'] * 5 + ['effort="50" velocity="1"'], False),
        (['effort="0" velocity="0"'] * 5, False),
    ],
)
def test_the_same_round_limits(tmp_path: Path, limits: list[str], is_reported: bool) -> None:
    assert len(find(tmp_path, chain(limits), "JNT020")) == is_reported


@pytest.mark.parametrize(("manifest", "message"), [("setup.py", "meant"), ("README.md", "outside")])
def test_programs_of_a_python_project_start_the_joints(tmp_path: Path, manifest: str, message: str) -> None:
    (tmp_path / manifest).write_text("", encoding="utf-8")
    text = ARM.format(limit='lower="0.5" upper="2"', kind="revolute", inner="", more=CONTROLLED)
    path = tmp_path / "envs" / "arm.urdf"
    path.parent.mkdir()
    path.write_text(text, encoding="utf-8")
    (finding,) = check(tmp_path, codes={"JNT019"}).findings
    assert finding.message_id == message


@pytest.mark.parametrize(
    ("start", "more", "is_reported"),
    [("1.2", "", False), ("3", "", True), ("", "", True), ("1.2", CONTROLLED, True)],
    ids=["within", "outside", "none", "simulated"],
)
def test_a_state_of_the_srdf_gives_the_start(tmp_path: Path, start: str, more: str, is_reported: bool) -> None:
    state = f'<group_state name="home" group="g"><joint name="j" value="{start}"/></group_state>' if start else ""
    (tmp_path / "arm.srdf").write_text(f'<robot name="arm"><group name="g"><joint name="j"/></group>{state}</robot>')
    assert bool(find_zero(tmp_path, 'lower="0.5" upper="2"', more=more)) == is_reported
