"""Joints: where the JNT rules begin and end, and what their repairs write."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from builders import find, inertial, joint, limit, link, robot
from conftest import check_text

from urdfcheck.core import Applicability, Severity


def make_joint(inner: str = "", kind: str = "revolute", name: str = "j", child: str = "b") -> str:
    return joint(name, "a", child, inner, kind=kind)


def make_three_links(*joints: str, links: str = "") -> str:
    """Return a robot of the links a, b and c, further links and joints."""
    return robot(link("a"), link("b"), link("c"), links, *joints)


LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'


@pytest.mark.parametrize(("axis", "zero"), [("0 0 0", True), ("0 0 1e-17", True), ("0 0 1e-6", False)])
def test_an_axis_of_export_noise_is_zero(tmp_path: Path, axis: str, zero: bool) -> None:
    assert bool(find(tmp_path, make_three_links(make_joint(f'<axis xyz="{axis}"/>{LIMIT}')), "JNT001")) == zero


@pytest.mark.parametrize("kind", ["fixed", "floating"])
def test_joints_without_an_axis_may_have_a_zero_one(tmp_path: Path, kind: str) -> None:
    assert not find(tmp_path, make_three_links(make_joint('<axis xyz="0 0 0"/>', kind)), "JNT001")


@pytest.mark.parametrize(
    ("axis", "severity"),
    [
        ("0.70710678 0.70710678 0", None),
        ("0.7071 0.7071 0", Severity.INFO),
        ("0.70 0.70 0", Severity.WARNING),
        ("0 2 0", Severity.WARNING),
    ],
)
def test_an_axis_typed_with_few_digits_is_told_apart_from_a_scaled_one(
    tmp_path: Path, axis: str, severity: Severity | None
) -> None:
    findings = find(tmp_path, make_three_links(make_joint(f'<axis xyz="{axis}"/>{LIMIT}')), "JNT002")
    assert [f.severity for f in findings] == ([] if severity is None else [severity])


@pytest.mark.parametrize(
    ("program", "severity"), [("rviz2", Severity.INFO), ("pybullet", Severity.WARNING), (None, Severity.WARNING)]
)
def test_an_axis_that_is_not_of_unit_length_matters_to_bullet(
    tmp_path: Path, program: str | None, severity: Severity
) -> None:
    if program is not None:
        (tmp_path / "package.xml").write_text('<package format="3"><name>arm</name></package>')
        (tmp_path / "show.launch.py").write_text(f"run('{program}', 'robot.urdf')")
    (finding,) = find(tmp_path, make_three_links(make_joint(f'<axis xyz="1 1 0"/>{LIMIT}')), "JNT002")
    assert finding.severity == severity


def test_the_normalised_axis_is_written_where_the_axis_is_literal(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_three_links(make_joint(f'<axis xyz="0 3 -4"/>{LIMIT}')), "JNT002")
    assert finding.fix is not None
    (edit,) = finding.fix.edits
    assert [float(w) for w in edit.replacement.split()] == pytest.approx([0, 0.6, -0.8])
    assert math.hypot(*map(float, edit.replacement.split())) == pytest.approx(1, abs=1e-15)


def test_a_computed_axis_gets_advice_only(tmp_path: Path) -> None:
    text = make_three_links(make_joint(f'<axis xyz="${{1 + 1}} 0 0"/>{LIMIT}'))
    (finding,) = find(tmp_path, text, "JNT002", name="robot.xacro")
    assert finding.fix is not None
    assert not finding.fix.edits


def test_one_of_lower_and_upper_is_enough(tmp_path: Path) -> None:
    assert not find(tmp_path, make_three_links(make_joint('<limit lower="-1" effort="1" velocity="1"/>')), "JNT004")


@pytest.mark.parametrize("second", ['<limit lower="-1" upper="1" effort="1" velocity="1"/>', '<limit effort="2"/>'])
def test_a_range_in_another_limit_of_the_joint_is_not_missing(tmp_path: Path, second: str) -> None:
    """The first `<limit>` is what is left over then, and not short of a range: XML006 says so."""
    text = make_three_links(make_joint('<limit effort="1" velocity="1"/>' + second))
    codes = [finding.code for finding in find(tmp_path, text, {"JNT004", "XML006"})]
    assert sorted(codes) == (["XML006"] if "lower" in second else ["JNT004", "XML006"])


def test_continuous_joints_need_no_limit(tmp_path: Path) -> None:
    assert not find(tmp_path, make_three_links(make_joint(kind="continuous")), "JNT004")


def test_limits_absent_altogether_are_not_reported_as_equal(tmp_path: Path) -> None:
    assert not find(tmp_path, make_three_links(make_joint('<limit effort="1" velocity="1"/>')), "JNT005")


def test_a_lower_limit_above_the_default_upper_one_is_inverted(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_three_links(make_joint('<limit lower="1" effort="1" velocity="1"/>')), "JNT005")
    assert (finding.message_id, finding.severity) == ("inverted", Severity.ERROR)
    assert finding.fix is not None
    assert not finding.fix.edits, "there is no second value to exchange it with"


@pytest.mark.parametrize(
    ("limits", "other", "repair", "edited"),
    [
        ('lower="2" upper="1"', "", "swap the two: lower 1, upper 2; or lower -2 if its minus sign is missing", False),
        (
            'lower="-1" upper="-2"',
            "",
            "swap the two: lower -2, upper -1; or upper 2 if its minus sign is too much",
            False,
        ),
        ('lower="-1" upper="-2"', 'lower="1" upper="2"', "swap the two: lower -2, upper -1", True),
        ('lower="1" upper="-2"', "", "swap the two: lower -2, upper 1", True),
        (
            'lower="0" upper="-2"',
            "",
            "swap the two: lower -2, upper 0; or upper 2 if its minus sign is too much",
            False,
        ),
        ('lower="2" upper="0"', "", "swap the two: lower 0, upper 2; or lower -2 if its minus sign is missing", False),
    ],
)
def test_limits_of_one_sign_may_lack_a_minus_sign(
    tmp_path: Path, limits: str, other: str, repair: str, edited: bool
) -> None:
    first, second = (f'<limit {typed} effort="1" velocity="1"/>' for typed in (limits, other))
    text = make_three_links(make_joint(first), make_joint(second, name="k", child="c"))
    (finding,) = [f for f in find(tmp_path, text, "JNT005") if f.message_id == "inverted"]
    assert finding.fix is not None
    assert (finding.fix.title, bool(finding.fix.edits)) == (repair, edited)


@pytest.mark.parametrize(
    ("mimic", "edits"),
    [
        ('<mimic joint="j" multiplier="-1"/>', [("1", "-1")]),
        ('<mimic joint="j"/>', [("1", "0"), ("0", "1")]),
        ('<mimic joint="j" offset="2"/>', [("1", "2"), ("0", "3")]),
    ],
)
def test_a_follower_needs_the_range_to_which_its_leader_moves_it(
    tmp_path: Path, mimic: str, edits: list[tuple[str, str]]
) -> None:
    leader = make_joint('<limit lower="0" upper="1" effort="1" velocity="1"/>')
    inverted = '<limit lower="1" upper="0" effort="1" velocity="1"/>'
    text = make_three_links(leader, make_joint(inverted + mimic, name="k", child="c"))
    (finding,) = find(tmp_path, text, "JNT005")
    assert finding.fix is not None
    assert [(e.expected, e.replacement) for e in finding.fix.edits] == edits
    assert finding.consequences["moveit"].startswith("loads it")


@pytest.mark.parametrize(
    ("angle", "edited"), [("7", False), ("6.9", False), ("62.5", False), ("95", False), ("30", True)]
)
def test_an_angle_that_no_one_chooses_in_degrees_may_be_in_radians(tmp_path: Path, angle: str, edited: bool) -> None:
    origin = f'<origin rpy="0 0 {angle}"/>'
    (finding,) = find(tmp_path, make_three_links(make_joint(origin + LIMIT)), "JNT012")
    assert finding.fix is not None
    assert bool(finding.fix.edits) == edited


def test_a_rotor_of_type_revolute_is_fast(tmp_path: Path) -> None:
    rotor = '<limit lower="-1e16" upper="1e16" effort="1" velocity="450"/>'
    assert not find(tmp_path, make_three_links(make_joint(rotor)), "JNT006")
    assert find(tmp_path, make_three_links(make_joint(rotor.replace("1e16", "3.14"))), "JNT006")


def test_inverted_limits_are_exchanged_as_typed(tmp_path: Path) -> None:
    (finding,) = find(
        tmp_path,
        make_three_links(make_joint('<limit lower="1.570" upper="-0.5" effort="1" velocity="1"/>')),
        "JNT005",
    )
    assert finding.fix is not None
    assert [(e.expected, e.replacement) for e in finding.fix.edits] == [("1.570", "-0.5"), ("-0.5", "1.570")]


def test_joints_locked_alike_are_one_finding_with_every_subject(tmp_path: Path) -> None:
    locked = '<limit lower="0" upper="0" effort="1" velocity="1"/>'
    (finding,) = find(tmp_path, make_three_links(make_joint(locked), make_joint(locked, name="k", child="c")), "JNT005")
    assert finding.severity == Severity.WARNING
    assert finding.subjects == ("joint[j]/limit", "joint[k]/limit")
    assert finding.headline == "2 joints have limits 0 to 0: j, k"


@pytest.mark.parametrize(("named", "kept"), [("b", True), ("c", False)])
def test_a_locked_joint_may_keep_a_link_for_a_plugin(tmp_path: Path, named: str, kept: bool) -> None:
    plugin = f'<gazebo><plugin name="p" filename="libimu.so"><linkName>{named}</linkName></plugin></gazebo>'
    text = make_three_links(make_joint('<limit lower="0" upper="0" effort="1" velocity="1"/>'), plugin)
    (finding,) = find(tmp_path, text, "JNT005")
    assert finding.fix is not None
    assert ('<gazebo reference="j"><preserveFixedJoint>true' in finding.fix.title) is kept


def test_a_link_that_the_file_keeps_already_needs_no_second_element(tmp_path: Path) -> None:
    plugin = '<gazebo><plugin name="p" filename="libimu.so"><linkName>b</linkName></plugin></gazebo>'
    keep = '<gazebo reference="j"><disableFixedJointLumping>true</disableFixedJointLumping></gazebo>'
    text = make_three_links(make_joint('<limit lower="0" upper="0" effort="1" velocity="1"/>'), plugin, keep)
    (finding,) = find(tmp_path, text, "JNT005")
    assert finding.severity == Severity.INFO
    assert finding.fix is not None
    assert finding.fix.title.endswith("or make the joint fixed")


def test_a_hinge_without_a_motor_beside_others_has_no_data_sheet(tmp_path: Path) -> None:
    limit = '<limit lower="-1" upper="1" effort="10" velocity="100000"/>'
    joints = make_joint(limit), make_joint(limit, name="k", child="c")
    motor = (
        '<ros2_control name="s" type="system"><joint name="k"><command_interface name="effort"/></joint></ros2_control>'
    )
    (finding,) = find(tmp_path, make_three_links(*joints, motor), "JNT007")
    assert finding.subjects == ("joint[k]/limit@velocity",)
    (finding,) = find(tmp_path, make_three_links(*joints), "JNT007")
    assert len(finding.subjects) == 2


@pytest.mark.parametrize("code", ["JNT005", "JNT007"])
def test_a_limit_that_a_macro_makes_twice_is_one_place(tmp_path: Path, code: str) -> None:
    made = make_joint('<limit lower="0" upper="0" effort="0" velocity="1"/>', name="${n}", child="${c}")
    text = make_three_links(
        f'<xacro:macro name="m" params="n c">{made}</xacro:macro><xacro:m n="j" c="b"/><xacro:m n="k" c="c"/>'
    ).replace("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ')
    (finding,) = find(tmp_path, text, code, name="robot.xacro")
    assert len(finding.subjects) == 2
    assert not finding.related


def test_missing_effort_is_an_error_on_any_joint_with_a_limit(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_three_links(make_joint('<limit lower="0" upper="1"/>', "fixed")), "JNT007")
    assert (finding.message_id, finding.severity) == ("missing", Severity.ERROR)
    assert "effort and velocity" in finding.message


def test_zero_effort_of_all_joints_is_one_finding(tmp_path: Path) -> None:
    idle = '<limit lower="0" upper="1" effort="0" velocity="1"/>'
    (finding,) = find(tmp_path, make_three_links(make_joint(idle), make_joint(idle, name="k", child="c")), "JNT007")
    assert (finding.message_id, finding.severity) == ("effort-unused", Severity.INFO)
    assert finding.subjects == ("joint[j]/limit@effort", "joint[k]/limit@effort")


def transmit(interface: str, joint: str = "j") -> str:
    inside = f'<joint name="{joint}"><hardwareInterface>hardware_interface/{interface}</hardwareInterface></joint>'
    return f'<transmission name="t">{inside}</transmission>'


def control(plugin: str) -> str:
    inside = '<joint name="j"><command_interface name="position"/></joint>'
    return f'<ros2_control name="c"><hardware><plugin>{plugin}</plugin></hardware>{inside}</ros2_control>'


@pytest.mark.parametrize("text", [transmit("PositionJointInterface"), control("mock_components/GenericSystem")])
def test_zero_effort_of_a_motor_that_no_simulator_makes_is_an_info(tmp_path: Path, text: str) -> None:
    idle = make_joint('<limit lower="0" upper="1" effort="0" velocity="1"/>')
    (finding,) = find(tmp_path, make_three_links(idle, text), "JNT007")
    assert (finding.message_id, finding.severity) == ("effort-unused", Severity.INFO)


@pytest.mark.parametrize(("named", "message"), [("jk", "effort-unused"), ("j", "both-zero")])
def test_rotors_that_a_plugin_turns_need_no_limits(tmp_path: Path, named: str, message: str) -> None:
    idle = '<limit lower="0" upper="1" effort="0" velocity="0"/>'
    plugins = "".join(
        f'<gazebo><plugin name="p" filename="libmotor.so"><jointName>{name}</jointName></plugin></gazebo>'
        for name in named
    )
    # A joint of range zero keeps Gazebo from merging the link of a sensor.
    sensor = make_joint(idle.replace('upper="1"', 'upper="0"'), name="i", child="d")
    rotors = make_joint(idle), make_joint(idle, name="k", child="c")
    findings = find(tmp_path, make_three_links(*rotors, sensor, plugins, links=link("d")), "JNT007")
    (finding,) = (f for f in findings if f.data["joints"] == "j, k")
    assert finding.message_id == message


@pytest.mark.parametrize(
    ("name", "body", "message"),
    [("j", "", "effort-unused"), ("j", inertial(), "both-zero"), ("rotor_0_joint", inertial(), "effort-unused")],
)
def test_frames_without_bodies_and_rotors_need_no_limits(tmp_path: Path, name: str, body: str, message: str) -> None:
    idle = limit(-1, 1, effort=0, velocity=0)
    joints = joint(name, "a", "b", idle, kind="revolute"), joint(name + "1", "b", "c", idle, kind="revolute")
    text = robot(link("a"), link("b", body), link("c"), *joints)
    assert [f.message_id for f in find(tmp_path, text, "JNT007") if "effort" in f.message] == [message]


def test_a_rocker_without_effort_and_velocity_has_no_motor(tmp_path: Path) -> None:
    rocker = make_joint('<limit lower="-1" upper="1" effort="0" velocity="0"/>')
    driven = make_joint(LIMIT, name="k", child="c")
    (finding,) = find(tmp_path, make_three_links(rocker, driven), "JNT007")
    assert (finding.message_id, finding.severity) == ("effort-unused", Severity.INFO)


@pytest.mark.parametrize(
    ("names", "message"),
    [(("waist", "arm", "spring", "elbow"), "effort-unused"), (("j1", "j2", "j3", "j4"), "effort-odd")],
    ids=["a spring in the tool of an arm", "a SCARA"],
)
def test_a_slide_is_like_the_hinges_of_an_arm_if_it_is_numbered_with_them(
    tmp_path: Path, names: tuple[str, ...], message: str
) -> None:
    text = '<robot name="r"><link name="base"/>'
    for name in names:
        kind, effort = ("prismatic", 0) if name == names[2] else ("revolute", 9)
        limit = f'<limit lower="0" upper="1" effort="{effort}" velocity="1"/>'
        text += f'<link name="{name}_link"/>' + joint(name, "base", f"{name}_link", limit, kind=kind, axis="0 1 0")
    (finding,) = find(tmp_path, text + "</robot>", "JNT007")
    assert finding.message_id == message


@pytest.mark.parametrize(
    ("efforts", "found"),
    [
        ({"left_knee": 40, "right_knee": 0}, "effort-odd"),
        ({"left_knee": 0, "right_knee": 0, "hip": 40}, "effort-unused"),
        ({"joint_1": 40, "joint_2": 0, "joint_3": 20}, "effort-odd"),
        ({"waist": 40, "shoulder": 30, "elbow": 20, "wrist": 0}, "effort-odd"),
        ({"shoulder": 30, "elbow": 20, "rocker": 0}, "effort-unused"),
    ],
)
def test_zero_effort_of_one_of_several_like_joints_is_a_warning(
    tmp_path: Path, efforts: dict[str, int], found: str
) -> None:
    text = '<robot name="r"><link name="base"/>'
    for name, effort in efforts.items():
        limit = f'<limit lower="0" upper="1" effort="{effort}" velocity="1"/>'
        text += f'<link name="{name}_link"/>' + joint(
            name, "base", f"{name}_link", limit, kind="revolute", axis="0 1 0"
        )
    (finding,) = find(tmp_path, text + "</robot>", "JNT007")
    assert finding.message_id == found
    assert finding.severity == (Severity.WARNING if found == "effort-odd" else Severity.INFO)


@pytest.mark.parametrize(
    ("speeds", "severity"), [("", Severity.WARNING), ("true", Severity.INFO), ("false", Severity.WARNING)]
)
def test_moveit_may_have_the_speed_that_the_model_lacks(tmp_path: Path, speeds: str, severity: Severity) -> None:
    texts = [f'<limit lower="0" upper="1" effort="5" velocity="{velocity}"/>' for velocity in (0, 3)]
    entry = f"joint_limits:\n  j:\n    has_velocity_limits: {speeds}\n    max_velocity: 0.5\n"
    files = {
        "r.urdf": make_three_links(make_joint(texts[0]), make_joint(texts[1], name="k", child="c")),
        "r.srdf": '<robot name="r"><group name="g"><joint name="j"/></group></robot>',
        "joint_limits.yaml": entry if speeds else "",
    }
    (tmp_path / ".git").mkdir()
    (finding,) = find(tmp_path, files, "JNT007", name="r.urdf")
    assert (finding.message_id, finding.severity) == ("velocity-zero", severity)


def test_the_motors_of_a_file_that_is_left_aside_are_a_note(tmp_path: Path) -> None:
    motor = (
        '<transmission name="t"><joint name="j"><hardwareInterface>hardware_interface/EffortJointInterface'
        "</hardwareInterface></joint></transmission>"
    )
    limit_of_zero = '<limit lower="0" upper="1" effort="0" velocity="3"/>'
    text = make_three_links(make_joint(limit_of_zero), links=motor)
    for named, severity in (("r.urdf", Severity.WARNING), ("new.urdf", Severity.INFO)):
        files = {
            "package.xml": "<package><name>p</name></package>",
            "r.urdf": text,
            "new.urdf": text,
            "launch/show.launch": f'<launch><param name="robot_description" textfile="$(find p)/{named}"/></launch>',
        }
        (finding,) = find(tmp_path / named, files, "JNT007", name="r.urdf")
        assert (finding.message_id, finding.severity) == ("effort-zero", severity)


def test_a_zero_velocity_counts_although_no_joint_has_an_effort(tmp_path: Path) -> None:
    texts = [f'<limit lower="0" upper="1" effort="0" velocity="{velocity}"/>' for velocity in (0, 3)]
    findings = find(
        tmp_path, make_three_links(make_joint(texts[0]), make_joint(texts[1], name="k", child="c")), "JNT007"
    )
    assert ("velocity-zero", Severity.WARNING, ("joint[j]/limit@velocity",)) in [
        (f.message_id, f.severity, f.subjects) for f in findings
    ]


@pytest.mark.parametrize(
    ("more", "srdf", "severity"),
    [
        ("", "", Severity.WARNING),  # no drive is known: any program may move it
        (transmit("PositionJointInterface"), "", Severity.WARNING),
        (transmit("PositionJointInterface", joint="k"), "", Severity.INFO),
        ('<gazebo><plugin name="p" filename="p.so"><joint>j</joint></plugin></gazebo>', "", Severity.WARNING),
        ("", '<group name="g"><joint name="j"/></group>', Severity.WARNING),
        ("", '<group name="g"><joint name="k"/></group>', Severity.INFO),
    ],
)
def test_a_zero_velocity_that_nothing_known_reads_is_an_info(
    tmp_path: Path, more: str, srdf: str, severity: Severity
) -> None:
    texts = [f'<limit lower="0" upper="1" effort="5" velocity="{velocity}"/>' for velocity in (0, 3)]
    joints = (make_joint(texts[0]), make_joint(texts[1], name="k", child="c"))
    files = {"r.urdf": make_three_links(*joints, links=more), "r.srdf": f'<robot name="r">{srdf}</robot>'}
    (tmp_path / ".git").mkdir()
    (finding,) = find(tmp_path, files, "JNT007", name="r.urdf")
    assert (finding.message_id, finding.severity) == ("velocity-zero", severity)


@pytest.mark.parametrize(
    ("effort", "alone", "beside"),
    [
        (
            0,
            " but an effort limit",
            ': taken literally, no motion is allowed; 1 other joint has velocity="0" and effort="0" (k)',
        ),
        (4, "", ": taken literally, no motion is allowed"),
    ],
)
def test_joints_without_both_are_counted_beside_those_without_a_velocity(
    tmp_path: Path, effort: int, alone: str, beside: str
) -> None:
    texts = [f'<limit lower="0" upper="1" effort="{e}" velocity="{v}"/>' for e, v in ((4, 0), (effort, 0), (4, 3))]
    joints = [make_joint(text, name=name, child=child) for text, name, child in zip(texts, "jkl", "bcd", strict=True)]
    text = f'<robot name="r">{"".join(map(link, "abcd"))}{"".join(joints)}</robot>'
    (finding,) = [f for f in find(tmp_path, text, "JNT007") if f.message_id == "velocity-zero"]
    assert f"velocity limit 0{alone}: j" in finding.headline
    assert finding.message.endswith(beside)


@pytest.mark.parametrize("control", [transmit("EffortJointInterface"), control("gz_ros2_control/GazeboSimSystem")])
def test_zero_effort_of_a_motor_is_a_warning(tmp_path: Path, control: str) -> None:
    idle = make_joint('<limit lower="0" upper="1" effort="0" velocity="1"/>')
    passive = idle.replace('name="j"', 'name="k"').replace('"b"', '"c"')
    findings = find(tmp_path, make_three_links(idle, passive, control), "JNT007")
    assert [(f.message_id, f.severity, f.subjects) for f in findings] == [
        ("effort-zero", Severity.WARNING, ("joint[j]/limit@effort",)),
        ("effort-unused", Severity.INFO, ("joint[k]/limit@effort",)),
    ]


def test_a_motor_without_effort_and_speed_is_one_finding(tmp_path: Path) -> None:
    idle = make_joint('<limit lower="0" upper="1" effort="0" velocity="0"/>')
    (finding,) = find(tmp_path, make_three_links(idle, transmit("EffortJointInterface")), "JNT007")
    assert (finding.message_id, finding.severity) == ("effort-zero", Severity.WARNING)
    assert 'effort="0" and velocity="0"' in finding.message
    assert finding.fix is not None
    assert "speed" in finding.fix.title


@pytest.mark.parametrize(("targets", "severity"), [(("gazebo",), Severity.WARNING), (("moveit",), Severity.INFO)])
def test_zero_effort_matters_to_gazebo(tmp_path: Path, targets: tuple[str, ...], severity: Severity) -> None:
    idle = make_joint('<limit lower="0" upper="1" effort="0" velocity="1"/>')
    (finding,) = check_text(tmp_path, make_three_links(idle), codes={"JNT007"}, targets=targets).findings
    assert finding.severity == severity


@pytest.mark.parametrize(
    ("limit", "kind", "found"),
    [
        ('lower="0" upper="0" effort="0" velocity="0"', "revolute", ["JNT005 equal"]),
        ('lower="-1" upper="1" effort="0" velocity="0"', "revolute", ["JNT007 effort-unused"]),
        ('effort="0" velocity="0"', "continuous", ["JNT007 effort-unused"]),
        ('lower="0" upper="0" effort="0" velocity="0"', "continuous", ["JNT007 effort-unused"]),
        ('lower="0" upper="0" effort="1" velocity="0"', "revolute", ["JNT005 equal"]),
        ('lower="-1" upper="1" effort="1e7" velocity="1"', "revolute", ["JNT007 effort-absurd"]),
        ('lower="-1" upper="1" effort="99999" velocity="9999"', "revolute", []),
        ('effort="1" velocity="1e16"', "continuous", ["JNT007 velocity-absurd"]),
        ('effort="1e7" velocity="1e16"', "continuous", ["JNT007 both-absurd"]),
    ],
)
def test_an_empty_limit_is_one_defect(tmp_path: Path, limit: str, kind: str, found: list[str]) -> None:
    run = check_text(tmp_path, make_three_links(make_joint(f"<limit {limit}/>", kind)), codes={"JNT005", "JNT007"})
    assert sorted(f"{f.code} {f.message_id}" for f in run.findings) == found
    idle = {"effort-unused", "velocity-zero", "velocity-absurd"}
    assert all((f.severity == Severity.INFO) == (f.message_id in idle) for f in run.findings)
    if found == ["JNT005 equal"]:
        assert run.findings[0].message.endswith(". Effort and velocity are 0 too") == ('effort="0"' in limit)


@pytest.mark.parametrize(
    ("reach", "interface", "message"),
    [
        ("100000", "state_interface", "endless"),
        ("3.14", "state_interface", "velocity-absurd"),
        ("100000", "command_interface", "velocity-absurd"),
    ],
)
def test_a_joint_that_turns_freely_needs_no_data_sheet(
    tmp_path: Path, reach: str, interface: str, message: str
) -> None:
    swing = make_joint(f'<limit lower="-{reach}" upper="{reach}" effort="10" velocity="100000"/>')
    control = (
        f'<ros2_control name="s" type="system"><joint name="j"><{interface} name="position"/></joint></ros2_control>'
    )
    (finding,) = find(tmp_path, make_three_links(swing, control), "JNT007")
    assert finding.message_id == message


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("", False),
        ('<inertial><mass value="1"/></inertial>', True),
        ('<visual><geometry><sphere radius="1"/></geometry></visual>', True),
    ],
)
def test_a_joint_that_moves_nothing_has_no_drive(tmp_path: Path, content: str, told: bool) -> None:
    """As in a model of the KUKA LWR whose stiffness is the position of a joint with an empty link."""
    arm = '<link name="b"><inertial><mass value="1"/></inertial></link>'
    real = make_joint('<limit lower="-1" upper="1" effort="9" velocity="2"/>')
    stiffness = make_joint('<limit lower="0" upper="5000" effort="9" velocity="20000"/>', name="k", child="c")
    text = f'<robot name="r"><link name="a"/>{arm}<link name="c">{content}</link>{real}{stiffness}</robot>'
    found = find(tmp_path, text, "JNT007")
    assert [f.message_id for f in found] == (["velocity-absurd"] if told else [])


def test_placeholders_of_one_limit_are_one_finding(tmp_path: Path) -> None:
    big = "1.7976931348623157e308"
    limit = f'<limit lower="-{big}" upper="{big}" effort="{big}" velocity="{big}"/>'
    (finding,) = find(tmp_path, make_three_links(make_joint(limit)), {"JNT007", "JNT008"})
    assert (finding.message_id, finding.severity) == ("both-absurd", Severity.WARNING)
    assert (finding.data["effort"], finding.data["velocity"]) == (float(big), float(big))
    (wide,) = find(tmp_path, make_three_links(make_joint(limit.replace(f'velocity="{big}"', 'velocity="1"'))), "JNT008")
    assert math.isfinite(wide.data["turns"])
    other = '<limit lower="-10" upper="10" effort="1e7" velocity="1"/>'
    text = make_three_links(make_joint(limit), make_joint(other, name="k", child="c"))
    found = find(tmp_path, text, {"JNT007", "JNT008"})
    assert {f"{f.message_id} {f.subjects[0]}" for f in found} == {
        "both-absurd joint[j]/limit@effort",
        "effort-absurd joint[k]/limit@effort",
        "wide joint[k]/limit",
    }


def test_an_empty_limit_is_reported_whatever_is_beside_it_and_selected(tmp_path: Path) -> None:
    empty, locked = (f'<limit lower="0" upper="0" effort="{e}" velocity="{e}"/>' for e in (0, 1))
    text = make_three_links(make_joint(empty), make_joint(locked, name="k", child="c"))
    both = find(tmp_path, text, {"JNT005", "JNT007"})
    assert [(f.code, f.data.get("hides")) for f in both] == [("JNT005", ["JNT007"]), ("JNT005", None)]
    told = {own.subjects: "Effort and velocity are 0 too" in own.message for own in both}
    assert told == {("joint[j]/limit",): True, ("joint[k]/limit",): False}
    (alone,) = find(tmp_path, text, "JNT007")
    assert (alone.message_id, alone.subjects) == ("effort-unused", ("joint[j]/limit@effort",))


@pytest.mark.parametrize(
    ("mimic", "words"), [("", "2 joints have"), ('<mimic joint="j"/>', "; so does 1 joint that mimics another")]
)
def test_the_count_of_absurd_limits_says_which_joints_it_leaves_out(tmp_path: Path, mimic: str, words: str) -> None:
    limit = '<limit lower="-1" upper="1" effort="1" velocity="1e6"/>'
    joints = make_joint(limit), make_joint(limit + mimic, name="k", child="c")
    (finding,) = find(tmp_path, make_three_links(*joints), "JNT007")
    assert finding.message_id == "velocity-absurd"
    assert words in finding.message


def test_the_only_driven_joint_may_be_a_rocker(tmp_path: Path) -> None:
    rocker = make_joint('<limit lower="-1" upper="1" effort="0" velocity="0"/>')
    follower = make_joint(
        '<limit lower="-1" upper="1" effort="0" velocity="0"/><mimic joint="j"/>', name="k", child="c"
    )
    (finding,) = find(tmp_path, make_three_links(rocker, follower), "JNT007")
    assert (finding.message_id, finding.severity) == ("effort-unused", Severity.INFO)


@pytest.mark.parametrize(
    ("name", "inner", "message"),
    [
        ("left_wheel", '<limit effort="1" velocity="1"/>', "wheel"),
        ("left_wheel", "", "wheel-missing"),
        ("wheel_steering", '<limit effort="1" velocity="1"/>', "locked"),
        ("shoulder", '<limit effort="1" velocity="1"/>', "locked"),
    ],
)
def test_a_wheel_without_a_range_is_made_continuous(tmp_path: Path, name: str, inner: str, message: str) -> None:
    (finding,) = find(tmp_path, make_three_links(make_joint(inner, name=name)), "JNT004")
    assert finding.message_id == message
    assert finding.fix is not None
    assert finding.fix.title.startswith('write type="continuous"') == (name == "left_wheel")


def test_a_followers_effort_may_be_zero(tmp_path: Path) -> None:
    follower = '<limit lower="0" upper="1" effort="0" velocity="1"/><mimic joint="k"/>'
    assert not find(tmp_path, make_three_links(make_joint(follower), make_joint(LIMIT, name="k", child="c")), "JNT007")


def follows(leader: str, rest: str = "", limit: str = LIMIT) -> str:
    return f'{limit}<mimic joint="{leader}" {rest}/>'


@pytest.mark.parametrize("effort", [0, 1])
def test_alike_joints_of_one_macro_are_locked_on_purpose(tmp_path: Path, effort: int) -> None:
    """An exporter with an empty dialog writes a limit for each joint."""
    limit_text = f'<limit lower="0" upper="0" effort="{effort}" velocity="0"/>'
    macro = f'<xacro:macro name="shock" params="n">{make_joint(limit_text, name="j_${n}", child="${n}")}</xacro:macro>'
    drive = '<gazebo><plugin name="p" filename="libgazebo_ros_planar_move.so"><topic>cmd</topic></plugin></gazebo>'
    calls = '<xacro:shock n="b"/><xacro:shock n="c"/>'
    text = robot(*map(link, "abc"), macro, calls, drive, xacro=True)
    (finding,) = find(tmp_path, text, "JNT005", name="robot.urdf.xacro")
    assert finding.severity == Severity.INFO


def test_a_joint_that_follows_itself(tmp_path: Path) -> None:
    assert [f.message_id for f in find(tmp_path, make_three_links(make_joint(follows("j"))), "JNT009")] == ["itself"]


def test_a_cycle_is_reported_once(tmp_path: Path) -> None:
    (finding,) = find(
        tmp_path,
        make_three_links(make_joint(follows("k")), make_joint(follows("j"), name="k", child="c")),
        "JNT009",
    )
    assert finding.message_id == "cycle"
    assert "j → k → j" in finding.message


def test_a_joint_that_follows_into_a_cycle_is_not_part_of_it(tmp_path: Path) -> None:
    text = make_three_links(make_joint(follows("j")), make_joint(follows("j"), name="k", child="c"))
    assert [f.subjects for f in find(tmp_path, text, "JNT009")] == [("joint[j]/mimic@joint",)]


def test_following_a_fixed_joint(tmp_path: Path) -> None:
    text = make_three_links(make_joint(follows("k")), make_joint(kind="fixed", name="k", child="c"))
    assert [f.message_id for f in find(tmp_path, text, "JNT009")] == ["fixed"]


@pytest.mark.parametrize(("kind", "drake"), [("fixed", "ignores"), ("revolute", "refuses")])
def test_a_fixed_joint_with_a_mimic_is_an_info(tmp_path: Path, kind: str, drake: str) -> None:
    text = make_three_links(
        make_joint(follows("k"), kind="fixed"), make_joint(follows("j"), kind=kind, name="k", child="c")
    )
    first, *others = find(tmp_path, text, "JNT009")
    assert (first.message_id, first.severity) == ("idle", Severity.INFO)
    assert first.consequences["drake"].startswith(drake)
    assert [f.message_id for f in others] == ["idle" if kind == "fixed" else "fixed"]  # and no cycle


def test_a_leader_that_follows_reaches_what_its_leader_gives_it(tmp_path: Path) -> None:
    """Its own limits are wider than the half that it moves in."""
    names = "abcd"
    limits = {"b": (0, 1.57), "c": (-1.57, 1.57), "d": (-1.57, 0)}
    follow = {"c": '<mimic joint="j_b" multiplier="-1"/>', "d": '<mimic joint="j_c"/>'}
    joints = [
        make_joint(
            f'<limit lower="{low}" upper="{high}" effort="1" velocity="1"/>{follow.get(n, "")}', name=f"j_{n}", child=n
        )
        for n, (low, high) in limits.items()
    ]
    assert not find(tmp_path, robot(*map(link, names), *joints), "JNT009")


def test_a_fixed_joint_that_mimics_itself_is_idle(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_three_links(make_joint(follows("j"), kind="fixed")), "JNT009")
    assert (finding.message_id, finding.severity) == ("idle", Severity.INFO)


@pytest.mark.parametrize(
    ("own", "repair"),
    [
        (
            'lower="0" upper="1"',
            'write multiplier="1", with which it stays within, or set the limits of j to -1 … 0 rad',
        ),
        ('lower="0" upper="0.5"', "set the limits of j to -1 … 0 rad, narrow those of k"),
    ],
)
def test_a_sign_too_much_is_named_where_the_other_sign_fits(tmp_path: Path, own: str, repair: str) -> None:
    ends = (f'<limit {span} effort="1" velocity="1"/>' for span in (own, 'lower="0" upper="1"'))
    follower, leader = next(ends) + '<mimic joint="k" multiplier="-1"/>', next(ends)
    text = make_three_links(make_joint(follower), make_joint(leader, name="k", child="c"))
    (finding,) = find(tmp_path, text, "JNT009")
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


@pytest.mark.parametrize(
    ("axis", "place", "repair"),
    [
        ("0 1 0", "0 -0.02 0", "set the limits of j to -1 … 0 m: the two are beside each other"),
        ("0 -1 0", "0 -0.02 0", 'write multiplier="1"'),
        ("0 1 0", "0 0.02 0.1", 'write multiplier="1"'),
    ],
)
def test_fingers_that_slide_apart_have_the_right_sign(tmp_path: Path, axis: str, place: str, repair: str) -> None:
    span = '<limit lower="0" upper="1" effort="1" velocity="1"/>'
    follower = joint("j", "a", "b", span, '<mimic joint="k" multiplier="-1"/>', kind="prismatic", xyz=place, axis=axis)
    leader = joint("k", "a", "c", span, kind="prismatic", xyz="0 0.02 0", axis="0 1 0")
    (finding,) = find(tmp_path, make_three_links(follower, leader), "JNT009")
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


def test_the_limits_of_the_first_leader_are_to_be_narrowed(tmp_path: Path) -> None:
    text = make_three_links(
        make_joint(follows("k", 'multiplier="2"')),
        make_joint(follows("m"), name="k", child="c"),
        make_joint(LIMIT, name="m", child="d"),
        links=link("d"),
    )
    (finding,) = find(tmp_path, text, "JNT009")
    assert finding.fix is not None
    assert finding.fix.title == "set the limits of j to -2 … 2 rad, narrow those of m, or correct multiplier and offset"


@pytest.mark.parametrize(
    ("multiplier", "found"),
    [
        ("1", []),
        ("-1", []),
        ("1.0009", []),
        ("1.01", [("slight", Severity.INFO)]),
        ("1.09", [("slight", Severity.INFO)]),
        ("1.11", [("range", Severity.WARNING)]),
    ],
)
def test_a_follower_stays_within_its_limits(tmp_path: Path, multiplier: str, found: list[tuple[str, Severity]]) -> None:
    text = make_three_links(
        make_joint(follows("k", f'multiplier="{multiplier}"')), make_joint(LIMIT, name="k", child="c")
    )
    findings = find(tmp_path, text, "JNT009")
    assert [(f.message_id, f.severity) for f in findings] == found


def origin(rpy: str, xyz: str = "0 0 0") -> str:
    return f'<origin xyz="{xyz}" rpy="{rpy}"/>{LIMIT}'


@pytest.mark.parametrize("rpy", ["0 0 3.14159", "-3.1416 0 0", "0 1.57 0", "0 0 0.785", "1.0472 0 0", "0 0 1.57075"])
def test_near_misses(tmp_path: Path, rpy: str) -> None:
    assert len(find(tmp_path, make_three_links(make_joint(origin(rpy))), "JNT013")) == 1


@pytest.mark.parametrize("rpy", ["0 0 3.141592653589793", "0 0 1.570796", "0.79 0 0", "0 0 3", "0.25 0.52 0.3"])
def test_full_digits_and_ordinary_angles_are_no_near_misses(tmp_path: Path, rpy: str) -> None:
    assert not find(tmp_path, make_three_links(make_joint(origin(rpy))), "JNT013")


def test_two_constants_in_one_attribute_are_two_findings_and_each_edits_its_word(tmp_path: Path) -> None:
    findings = find(tmp_path, make_three_links(make_joint(origin("1.57 0 -3.14"))), "JNT013")
    edits = [e for f in findings if f.fix is not None for e in f.fix.edits]
    assert [(e.expected, float(e.replacement)) for e in edits] == [("1.57", math.pi / 2), ("-3.14", -math.pi)]


def test_how_far_an_angle_is_off_is_written_without_an_exponent(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_three_links(make_joint(origin("1.57 0 0"))), "JNT013")
    assert finding.headline == "1.57 means π/2 and is off by 0.0008 rad"


def test_the_headline_of_several_constants_spells_them(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_three_links(make_joint(origin("1.5708 0 3.1416"))), "JNT013")
    assert finding.message_id == "several"
    assert finding.headline == "2 rounded fractions of π: 1.5708, 3.1416"


def test_in_xacro_the_constant_is_written_as_an_expression_and_expressions_are_left_alone(tmp_path: Path) -> None:
    (finding,) = find(
        tmp_path, make_three_links(make_joint(origin("${2 * 1.57} 0 -1.5708"))), "JNT013", name="robot.xacro"
    )
    assert finding.fix is not None
    assert [(e.expected, e.replacement) for e in finding.fix.edits] == [("-1.5708", "${-pi/2}")]


def test_a_sibling_with_all_digits_is_named(tmp_path: Path) -> None:
    text = make_three_links(
        make_joint(origin("0 0 3.1416")), make_joint(origin("0 0 -3.14159265358979"), name="k", child="c")
    )
    (finding,) = find(tmp_path, text, "JNT013")
    assert finding.message_id == "mixed"
    assert finding.headline == "π is written in 2 ways: 3.1416, 3.14159265358979"
    assert "joint k" in finding.message
    assert len(finding.related) == 1


def test_all_spellings_of_a_constant_are_one_finding_at_the_coarsest(tmp_path: Path) -> None:
    text = make_three_links(
        make_joint(origin("1.5708 0 -1.5708")), make_joint(origin("-1.57 0 1.570796"), name="k", child="c")
    )
    (finding,) = find(tmp_path, text, "JNT013")
    assert (finding.message_id, finding.location.subject) == ("mixed", "joint[k]/origin@rpy")
    assert "`1.57` (joint k, off by 0.8 mm/m), `1.5708` (2 times, off by 3.7 µm/m)" in finding.message
    assert finding.fix is not None
    assert [(e.expected, float(e.replacement)) for e in finding.fix.edits] == [
        ("-1.57", -math.pi / 2),
        ("1.5708", math.pi / 2),
        ("-1.5708", -math.pi / 2),
    ]


def test_what_is_hardly_off_is_one_finding_for_the_robot(tmp_path: Path) -> None:
    text = make_three_links(
        make_joint(origin("1.5708 0 -3.1416")), make_joint(origin("-1.5708 0 0.7854"), name="k", child="c")
    )
    (finding,) = find(tmp_path, text, "JNT013")
    assert (finding.message_id, finding.subjects) == ("several", ("joint[j]/origin@rpy", "joint[k]/origin@rpy"))
    assert finding.message.startswith("4 angles ")
    assert finding.fix is not None
    assert [e.expected for e in finding.fix.edits] == ["1.5708", "-1.5708", "-3.1416", "0.7854"]


def test_an_expression_is_a_spelling_with_all_digits(tmp_path: Path) -> None:
    text = make_three_links(make_joint(origin("1.5708 0 0")), make_joint(origin("${-pi/2} 0 0"), name="k", child="c"))
    (finding,) = find(tmp_path, text, "JNT013", name="robot.xacro")
    assert finding.message_id == "mixed"
    assert "`${-pi/2}` (joint k, exact)" in finding.message


def test_zeros_at_the_end_are_no_other_spelling(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_three_links(make_joint(origin("1.570 0 -1.57"))), "JNT013")
    assert finding.message_id == "rounded"
    assert "typed 2 times" in finding.message


def test_a_constant_with_all_digits_alone_is_no_finding(tmp_path: Path) -> None:
    text = make_three_links(
        make_joint(origin("1.5707963268 0 0")),
        make_joint(origin("1.5707963267948966 0 0"), name="k", child="c"),
    )
    assert not find(tmp_path, text, "JNT013")


def drawn(rpy: str) -> str:
    return f'<link name="d"><visual><origin rpy="{rpy}"/><geometry><box size="1 1 1"/></geometry></visual></link>'


CARRIED = joint("k", "b", "c", LIMIT, kind="revolute")


@pytest.mark.parametrize(
    ("text", "severity"),
    [
        (make_three_links(make_joint(origin("1.57 1.57 -1.57")), CARRIED), Severity.WARNING),
        (make_three_links(make_joint("<origin rpy='1.57 1.57 -1.57'/>", "fixed"), CARRIED), Severity.WARNING),
        (make_three_links(make_joint(origin("1.57 0 -1.57")), CARRIED), Severity.INFO),
        (make_three_links(make_joint(origin("1.5707 1.5707 -1.5707")), CARRIED), Severity.INFO),
        (make_three_links(make_joint(origin("1.57 1.57 -1.57")), CARRIED.replace("revolute", "fixed")), Severity.INFO),
        (make_three_links(make_joint(origin("1.57 0 0"))), Severity.INFO),
        (make_three_links(links=drawn("1.57 0 0")), Severity.INFO),
        (make_three_links(make_joint(origin("1.5708 0 0")), links=drawn("1.57 0 0")), Severity.INFO),
    ],
)
def test_a_tenth_of_a_millimetre_per_metre_matters_to_planners_where_moving_joints_are_carried(
    tmp_path: Path, text: str, severity: Severity
) -> None:
    before = link("z") + joint("y", "z", "a", LIMIT, kind="revolute")
    text = text.replace("</robot>", f"{before}</robot>")
    (finding,) = find(tmp_path, text, "JNT013", targets=("moveit",))
    assert finding.severity == severity
    (finding,) = find(tmp_path, text, "JNT013")
    assert finding.severity == Severity.INFO


@pytest.mark.parametrize(("x", "noise"), [("1e-17", True), ("-9e-10", True), ("1e-6", False), ("0", False)])
def test_noise_is_below_a_nanometre(tmp_path: Path, x: str, noise: bool) -> None:
    assert bool(find(tmp_path, make_three_links(make_joint(origin("0 0 0", f"{x} 0 0"))), "JNT014")) == noise


def test_all_noise_of_a_file_is_one_finding_and_is_replaced_by_zeros(tmp_path: Path) -> None:
    shape = '<visual><origin xyz="1e-18 0.1 -2E-20" rpy="1e-16 0 0"/><geometry><sphere radius="1"/></geometry></visual>'
    (finding,) = find(
        tmp_path,
        make_three_links(make_joint(origin("0 0 3e-14")), links=f'<link name="d">{shape}</link>'),
        "JNT014",
    )
    assert finding.fix is not None
    assert [e.expected for e in finding.fix.edits] == ["1e-18", "-2E-20", "1e-16", "3e-14"]
    assert {e.replacement for e in finding.fix.edits} == {"0"}
    assert "(at most `3e-14` rad), in the origins and axes of d, j" in finding.message


@pytest.mark.parametrize(("axis", "noise"), [("6e-17 1 0", 1), ("1e-8 1 0", 0), ("0 1e-17 0", 0), ("0 1 0", 0)])
def test_an_axis_that_is_noise_beside_its_length(tmp_path: Path, axis: str, noise: int) -> None:
    assert len(find(tmp_path, make_three_links(make_joint(f'<axis xyz="{axis}"/>{LIMIT}')), "JNT014")) == noise


def test_what_an_expression_leaves_of_zero_was_not_typed(tmp_path: Path) -> None:
    assert not find(
        tmp_path, make_three_links(make_joint(origin("0 0 0", "${cos(pi/2)} 0 0"))), "JNT014", name="robot.xacro"
    )


@pytest.mark.parametrize(
    ("rpy", "shifted"),
    [
        ("0 -0.75239 0", True),
        ("3.141592653589793 0.75239 3.141592653589793", True),
        ("0 -0.752 0", False),
        ("0 0.78540 0", False),
        ("0 0.39270 0", False),
        ("0 1.5708 0", False),
        ("0.1 0.75239 0", False),
        ("0 0 0", False),
    ],
)
def test_a_shifted_zero_is_a_turn_about_the_axis_that_nobody_would_choose(
    tmp_path: Path, rpy: str, shifted: bool
) -> None:
    assert bool(find(tmp_path, make_three_links(make_joint(origin(rpy) + '<axis xyz="0 1 0"/>')), "JNT016")) == shifted


def test_the_shift_is_signed_about_the_axis(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_three_links(make_joint(origin("0 -0.75239 0") + '<axis xyz="0 -1 0"/>')), "JNT016")
    assert finding.data["degrees"] == pytest.approx(43.1088, abs=1e-4)


def test_a_joint_that_cannot_turn_has_no_zero(tmp_path: Path) -> None:
    locked = '<limit lower="0" upper="0" effort="1" velocity="1"/>'
    text = make_three_links(make_joint(f'<origin rpy="0 -0.75239 0"/><axis xyz="0 1 0"/>{locked}'))
    assert not find(tmp_path, text, "JNT016")


def turning(child: str, more: str = "") -> str:
    """A joint without limits whose zero is shifted, and what it turns about y."""
    axle = make_joint('<origin rpy="0 -0.75239 0"/><axis xyz="0 1 0"/>', "continuous")
    return f'<robot name="r"><link name="a"/><link name="b">{child}</link>{axle}{more}</robot>'


def weight(com: str, six: str) -> str:
    xx, yy, zz = six.split()
    return (
        f'<inertial><origin xyz="{com}"/><mass value="1"/>'
        f'<inertia ixx="{xx}" ixy="0" ixz="0" iyy="{yy}" iyz="0" izz="{zz}"/></inertial>'
    )


ROUND = '<visual><origin rpy="1.57079632679 0 0"/><geometry><cylinder radius="0.1" length="0.02"/></geometry></visual>'
LONG = '<visual><geometry><box size="0.2 0.02 0.1"/></geometry></visual>'


@pytest.mark.parametrize(
    ("child", "shows"),
    [
        ("", False),
        (ROUND, False),
        (LONG, True),
        (weight("0 0.3 0", "3 5 3"), False),
        (weight("0 0.3 0", "3 5 4"), True),
        (weight("0.1 0 0", "3 5 3"), False),  # 0.1 m is little beside a radius of gyration of 2.2 m
        (weight("1 0 0", "3 5 3"), True),
        (ROUND + weight("0.05 0 0", "0.003 0.005 0.003"), True),
    ],
)
def test_the_zero_of_an_endless_joint_matters_where_its_child_is_not_round(
    tmp_path: Path, child: str, shows: bool
) -> None:
    assert bool(find(tmp_path, turning(child), "JNT016")) == shows


def test_the_zero_of_an_endless_joint_matters_where_it_carries_another(tmp_path: Path) -> None:
    next_one = '<link name="c"/><joint name="k" type="continuous"><parent link="b"/><child link="c"/></joint>'
    assert find(tmp_path, turning(ROUND, next_one), "JNT016")


def test_a_turn_about_a_slider_is_no_shift(tmp_path: Path) -> None:
    text = make_three_links(make_joint(origin("0 -0.75239 0") + '<axis xyz="0 1 0"/>', "prismatic"))
    assert not find(tmp_path, text, "JNT016")


def turns(limit: str, name: str = "j", child: str = "b", kind: str = "revolute") -> str:
    return make_joint(f'<axis xyz="0 0 1"/><limit {limit}/>', kind, name, child)


@pytest.mark.parametrize(
    ("lower", "upper", "degrees"),
    [
        ("-90", "90", True),
        ("0", "135", True),
        ("-12.5", "90", True),
        ("-132.31", "132.31", True),
        ("-62.83", "62.83", False),  # ten turns
        ("-99", "99", False),
        ("-12", "12", False),
        ("-6.2832", "6.2832", False),
        ("-10", "10", False),
        ("-100", "100", False),
        ("-1000", "1000", False),
        ("-31.4", "31.4", False),
        ("-31.41593", "31.41593", False),
        ("0", "31.3980872", True),
        ("-139.801702", "0", True),
        ("-7", "7", False),
        ("0", "2000", False),
        ("-1e16", "1e16", False),
        ("0", "0", False),
    ],
)
def test_a_range_in_degrees_is_told_from_placeholders(tmp_path: Path, lower: str, upper: str, degrees: bool) -> None:
    text = make_three_links(turns(f'lower="{lower}" upper="{upper}" effort="1" velocity="1"'))
    assert bool(find(tmp_path, text, "JNT006")) == degrees


def test_one_range_in_degrees_tells_the_unit_of_the_others(tmp_path: Path) -> None:
    text = make_three_links(
        turns('lower="-170" upper="170" effort="1" velocity="1"'),
        turns('lower="0" upper="100" effort="1" velocity="1"', "k", "c"),
    )
    (finding,) = find(tmp_path, text, "JNT006")
    assert finding.subjects == ("joint[j]/limit@lower", "joint[j]/limit@upper", "joint[k]/limit@upper")
    assert finding.fix is not None
    assert [float(edit.replacement) for edit in finding.fix.edits] == pytest.approx(
        [math.radians(v) for v in (-170, 170, 100)]
    )


@pytest.mark.parametrize(
    ("end", "other", "degrees"), [("15", "2.094", False), ("15", "2", True), ("45", "2.094", True)]
)
def test_a_few_turns_may_be_meant_in_a_robot_with_radians(tmp_path: Path, end: str, other: str, degrees: bool) -> None:
    text = make_three_links(
        turns(f'lower="-{end}.0" upper="{end}.0" effort="1" velocity="1"'),
        turns(f'lower="0" upper="{other}" effort="1" velocity="1"', "k", "c"),
    )
    assert bool(find(tmp_path, text, "JNT006")) == degrees


def test_in_a_xacro_the_repair_of_degrees_stays_readable(tmp_path: Path) -> None:
    text = make_three_links(turns('lower="-90" upper="${180 / 2}" effort="1" velocity="1"'))
    (finding,) = find(tmp_path, text, "JNT006", name="robot.xacro")
    assert finding.fix is not None
    assert [edit.replacement for edit in finding.fix.edits] == ["${radians(-90)}"]


@pytest.mark.parametrize(
    ("other", "messages"),
    [("-2.97 2.97", ["point"]), ("-1 1", ["point"]), ("-170 170", ["range"]), ("-94.5 4.69", ["range"])],
)
def test_a_lost_decimal_point_is_not_converted(tmp_path: Path, other: str, messages: list[str]) -> None:
    """Unless another joint shows that the file is in degrees."""
    ranges = [limits.split() for limits in ("-94 4.69", other)]
    joints = [
        make_joint(f'<limit lower="{low}" upper="{up}" effort="1" velocity="1"/>', name=name, child=name)
        for name, (low, up) in zip("bc", ranges, strict=True)
    ]
    found = find(tmp_path, make_three_links(*joints), "JNT006")
    assert [finding.message_id for finding in found] == messages
    if messages == ["point"]:
        (finding,) = found
        assert not (finding.fix.edits if finding.fix else ())
        assert (finding.data["pointed"], finding.data["far"]) == (-0.94, -94)


@pytest.mark.parametrize(
    ("speeds", "kind", "degrees"),
    [
        (["180", "180"], "revolute", True),
        (["175", "260"], "revolute", True),
        (["175", "175"], "revolute", False),
        (["100", "100"], "revolute", False),
        (["17.4532", "9"], "revolute", False),
        (["180", "270"], "continuous", False),
    ],
)
def test_a_speed_in_degrees_needs_a_quarter_of_a_turn_or_two_values(
    tmp_path: Path, speeds: list[str], kind: str, degrees: bool
) -> None:
    limit = 'lower="-1" upper="1" effort="1" velocity="{}"'
    text = make_three_links(turns(limit.format(speeds[0]), kind=kind), turns(limit.format(speeds[1]), "k", "c", kind))
    assert bool(find(tmp_path, text, "JNT006")) == degrees


def test_a_range_in_degrees_is_not_told_again_as_too_wide(tmp_path: Path) -> None:
    text = make_three_links(turns('lower="-180" upper="180" effort="1" velocity="1"'))
    run = check_text(tmp_path, text, codes={"JNT006", "JNT008"})
    assert [f.code for f in run.findings] == ["JNT006"]


@pytest.mark.parametrize(
    ("kind", "lower", "upper", "message"),
    [
        ("continuous", "-3", "3", "continuous"),
        ("continuous", "0", "0", None),
        ("continuous", "-1e16", "1e16", None),
        ("fixed", "-1", "1", "fixed"),
        ("fixed", "0", "0", None),
        ("revolute", "-9.42477796077", "9.42477796077", None),
        ("revolute", "-10", "10", "wide"),
        ("prismatic", "-100", "100", None),
    ],
)
def test_limits_that_are_never_reached(tmp_path: Path, kind: str, lower: str, upper: str, message: str | None) -> None:
    text = make_three_links(turns(f'lower="{lower}" upper="{upper}" effort="1" velocity="1"', kind=kind))
    assert [f.message_id for f in find(tmp_path, text, "JNT008")] == ([message] if message else [])


@pytest.mark.parametrize(
    ("lower", "upper", "kinds", "severity"),
    [
        ("-1", "1.5", "ccc", Severity.WARNING),
        ("-1", "1.5", "cccrr", Severity.WARNING),
        ("-1", "1.5", "cccrrr", Severity.INFO),  # not most
        ("-1", "1.5", "cc", Severity.INFO),  # the steering of a car
        ("-3.14", "3.14", "cccc", Severity.INFO),  # wheels of an exporter
    ],
)
def test_most_joints_of_a_limb_turn_through_their_stops(
    tmp_path: Path, lower: str, upper: str, kinds: str, severity: Severity
) -> None:
    limit = f'<limit lower="{lower}" upper="{upper}" effort="1" velocity="1"/>'
    types = {"c": "continuous", "r": "revolute"}
    links = "".join(f'<link name="l{i}"/>' for i in range(len(kinds)))
    joints = [make_joint(limit, types[kind], f"j{i}", f"l{i}") for i, kind in enumerate(kinds)]
    (finding,) = find(tmp_path, make_three_links(*joints, links=links), "JNT008")
    assert finding.severity == severity
    assert finding.fix is not None
    assert finding.fix.title.startswith("make" if severity == Severity.WARNING else "delete")


def test_wheels_have_no_stops_whatever_their_limits(tmp_path: Path) -> None:
    """Four wheels and two hinges of a car, all with the limits of one exporter."""
    names = (
        "left_rear_wheel",
        "right_rear_wheel",
        "left_front_wheel",
        "right_front_wheel",
        "left_hinge",
        "right_hinge",
    )
    limit = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
    joints = [joint(f"{name}_joint", "b", name, limit, kind="continuous") for name in names]
    (finding,) = find(tmp_path, robot(link("b"), *map(link, names), *joints), "JNT008")
    assert finding.severity is Severity.INFO
    assert finding.fix is not None
    assert finding.fix.title.startswith("delete lower and upper")


def test_the_wheels_of_a_mobile_arm_are_not_joints_of_its_limb(tmp_path: Path) -> None:
    """Three of seven joints have stops: all those of the arm. The limits of a wheel stay a note."""
    limit = '<limit lower="{}" upper="{}" effort="1" velocity="1"/>'
    parents = ("b", "l0", "l1", "b", "b", "b", "b")
    limits = [("-1", "1.5")] * 3 + [("-3.14", "3.14")] + [("0", "0")] * 3
    joints = [
        joint(f"j{i}", parent, f"l{i}", limit.format(*ends), kind="continuous")
        for i, (parent, ends) in enumerate(zip(parents, limits, strict=True))
    ]
    text = robot(link("b"), *(link(f"l{i}") for i in range(len(parents))), *joints)
    found = {f.severity: f.location.subject for f in find(tmp_path, text, "JNT008")}
    assert {severity: subject.partition("]")[0] for severity, subject in found.items()} == {
        Severity.WARNING: "joint[j0",
        Severity.INFO: "joint[j3",
    }


@pytest.mark.parametrize(
    ("angle", "degrees"),
    [
        ("90", True),
        ("-45", True),
        ("22.5", True),
        ("6.2831853", False),
        ("6.2", False),
        ("7.85", False),
        ("-9.42478", False),
        ("1e6", False),
        ("6.3167", False),
        ("10.3132", True),
        ("6.35", True),
    ],
)
def test_an_angle_beyond_a_turn_is_degrees_unless_it_is_a_sum(tmp_path: Path, angle: str, degrees: bool) -> None:
    text = make_three_links(make_joint(f'<origin rpy="0 {angle} 0"/>', "fixed"))
    assert bool(find(tmp_path, text, "JNT012")) == degrees


@pytest.mark.parametrize(
    ("angle", "message"),
    [("300", "tried"), ("95", "tried"), ("150", "degrees"), ("270", "degrees"), ("45", "degrees")],
)
def test_degrees_are_not_meant_where_the_radians_are_nearly_square_or_diagonal(
    tmp_path: Path, angle: str, message: str
) -> None:
    (finding,) = find(tmp_path, make_three_links(make_joint(f'<origin rpy="{angle} 0 0"/>', "fixed")), "JNT012")
    assert finding.message_id == message
    assert finding.fix is not None
    assert bool(finding.fix.edits) is (message == "degrees")


def test_all_angles_of_an_origin_are_in_the_same_unit(tmp_path: Path) -> None:
    text = make_three_links(
        make_joint('<origin rpy="0 90 -5"/>', "fixed"), make_joint('<origin rpy="0 1 0"/>', "fixed", "k", "c")
    )
    (finding,) = find(tmp_path, text, "JNT012")
    assert finding.subjects == ("joint[j]/origin@rpy",)
    assert finding.fix is not None
    assert [(e.expected, float(e.replacement)) for e in finding.fix.edits] == [
        ("90", math.radians(90)),
        ("-5", math.radians(-5)),
    ]


def test_an_origin_that_a_macro_makes_twice_is_mended_once(tmp_path: Path) -> None:
    made = make_joint('<origin rpy="0 90 0"/>', "fixed", "${n}", "${c}")
    text = make_three_links(
        f'<xacro:macro name="m" params="n c">{made}</xacro:macro><xacro:m n="j" c="b"/><xacro:m n="k" c="c"/>'
    ).replace("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ')
    (finding,) = find(tmp_path, text, "JNT012", name="robot.xacro")
    assert finding.subjects == ("joint[j]/origin@rpy", "joint[k]/origin@rpy")
    assert finding.fix is not None
    assert [edit.replacement for edit in finding.fix.edits] == ["${radians(90)}"]


@pytest.mark.parametrize(
    ("soft", "kind", "messages"),
    [
        ('soft_lower_limit="-0.9" soft_upper_limit="0.9" k_velocity="1"', "revolute", []),
        ('soft_lower_limit="-1.0000001" soft_upper_limit="1" k_velocity="1"', "revolute", []),
        ('soft_lower_limit="-1.1" soft_upper_limit="0.9" k_velocity="1"', "revolute", ["outside"]),
        ('soft_lower_limit="-1.1" soft_upper_limit="1.1" k_velocity="1"', "revolute", ["off"]),
        ('soft_lower="-0.9" soft_upper="0.9" k_velocity="1"', "revolute", []),  # XML004
        ('soft_lower_limit="0.5" k_velocity="1"', "revolute", ["locked"]),
        ('soft_lower_limit="2" soft_upper_limit="3" k_velocity="1"', "revolute", ["locked"]),
        ('k_velocity="1"', "prismatic", ["absent"]),
        ('k_velocity="1"', "continuous", []),
        ('soft_lower_limit="-0.9" soft_upper_limit="0.9"', "revolute", ["gain"]),
        ('soft_lower_limit="-0.9" soft_upper_limit="0.9" k_vel="1"', "revolute", ["gain"]),
        ('soft_lower_limit="-0.9" soft_upper_limit="0.9" k_velocty="1"', "revolute", []),  # XML004
        ('soft_lower_limit="a" soft_upper_limit="0.9" k_velocity="1"', "revolute", []),  # XML007
    ],
)
def test_soft_limits(tmp_path: Path, soft: str, kind: str, messages: list[str]) -> None:
    text = make_three_links(make_joint(f"{LIMIT}<safety_controller {soft}/>", kind))
    assert [f.message_id for f in find(tmp_path, text, "JNT010")] == messages


def test_soft_limits_that_are_switched_off_are_one_note(tmp_path: Path) -> None:
    safety = '<safety_controller soft_lower_limit="-9" soft_upper_limit="9" k_velocity="1"/>'
    joints = make_joint(LIMIT + safety), make_joint(LIMIT + safety, name="k", child="c")
    (finding,) = find(tmp_path, make_three_links(*joints), "JNT010")
    assert (finding.severity, len(finding.subjects)) == (Severity.INFO, 2)


def test_a_soft_limit_outside_is_pulled_in_on_its_side(tmp_path: Path) -> None:
    safety = '<safety_controller soft_lower_limit="-3" soft_upper_limit="0.9" k_velocity="1"/>'
    (finding,) = find(tmp_path, make_three_links(make_joint(LIMIT + safety)), "JNT010")
    assert finding.fix is not None
    assert [(e.expected, e.replacement) for e in finding.fix.edits] == [("-3", "-1")]


def test_all_joints_without_an_axis_are_one_finding(tmp_path: Path) -> None:
    text = make_three_links(
        make_joint(kind="continuous"),
        make_joint(LIMIT, "prismatic", "k", "c"),
        make_joint(kind="fixed", name="l"),
    )
    (finding,) = find(tmp_path, text, "JNT003")
    assert finding.subjects == ("joint[j]", "joint[k]")


@pytest.mark.parametrize(
    ("dynamics", "kind", "messages"),
    [
        ('damping="-0.1" friction="-2"', "continuous", ["damping", "friction"]),
        ('damping="0" friction="-0.0"', "continuous", []),
        ('damping="-0.1"', "fixed", []),
    ],
)
def test_negative_dynamics(tmp_path: Path, dynamics: str, kind: str, messages: list[str]) -> None:
    findings = find(tmp_path, make_three_links(make_joint(f"<dynamics {dynamics}/>", kind)), "JNT011")
    assert [f.message_id for f in findings] == messages
    assert all(f.fix is not None and f.fix.edits[0].replacement == f.fix.edits[0].expected[1:] for f in findings)


def test_a_damping_of_minus_one_may_stand_for_none(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_three_links(make_joint('<dynamics damping="-1"/>', "continuous")), "JNT011")
    assert finding.fix is not None
    assert finding.fix.title.startswith("write 0 if -1 stands for none")
    assert not finding.fix.edits


@pytest.mark.parametrize(
    ("edge", "kind", "outside"),
    [
        ('rising="1"', "revolute", False),
        ('falling="-1.01"', "revolute", True),
        ('rising="9"', "continuous", False),
        ('rising="0" falling="2"', "prismatic", True),
    ],
)
def test_a_calibration_edge_lies_within_the_limits(tmp_path: Path, edge: str, kind: str, outside: bool) -> None:
    text = make_three_links(make_joint(f"{LIMIT}<calibration {edge}/>", kind))
    assert bool(find(tmp_path, text, "JNT017")) == outside


def test_residue_of_an_export_is_set_to_zero_without_asking(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_three_links(make_joint('<origin xyz="1e-18 0 1"/>', "fixed")), "JNT014")
    assert finding.fix is not None
    assert finding.fix.applicability is Applicability.SAFE


@pytest.mark.parametrize(
    "attributes", ['lower="-1" upper="1" efort="1" velocity="1"', 'lwer="-1" effort="1" velocity="1"']
)
def test_a_misspelt_limit_is_not_told_again_as_a_missing_one(tmp_path: Path, attributes: str) -> None:
    run = check_text(
        tmp_path,
        make_three_links(make_joint(f"<limit {attributes}/>")),
        codes={"JNT004", "JNT007", "XML004", "XML005"},
    )
    assert [f.code for f in run.findings] == ["XML004"]


def test_one_slip_in_the_names_of_soft_limits_is_one_finding(tmp_path: Path) -> None:
    safety = '<safety_controller soft_lower="-0.9" soft_upper="0.9" k_velocity="1"/>'
    joints = make_joint(LIMIT + safety), make_joint(LIMIT + safety, name="k", child="c")
    (finding,) = check_text(tmp_path, make_three_links(*joints), codes={"JNT010", "XML004"}).findings
    assert finding.code == "XML004"
    assert "`soft_lower`, `soft_upper`" in finding.message
    assert finding.fix is not None
    assert {(e.expected, e.replacement) for e in finding.fix.edits} == {
        ("soft_lower", "soft_lower_limit"),
        ("soft_upper", "soft_upper_limit"),
    }


def test_placeholders_beside_degrees_are_not_rewritten(tmp_path: Path) -> None:
    joints = [
        make_joint(f'<limit lower="-{size}" upper="{size}" effort="1" velocity="1"/>', name=name, child=child)
        for name, child, size in (("j", "b", "170"), ("k", "c", "10"))
    ]
    (finding,) = find(tmp_path, make_three_links(*joints), "JNT006")
    assert finding.subjects == ("joint[j]/limit@lower", "joint[j]/limit@upper")


def test_limits_in_child_elements_refuse_the_file_or_lock_the_joint(tmp_path: Path) -> None:
    typed = "<lower>-1</lower><upper>0.5</upper>"
    (bare,) = find(tmp_path, make_three_links(make_joint(f"<limit>{typed}<effort>3</effort></limit>")), "JNT004")
    assert bare.message_id == "children"
    assert "refuses the file" in bare.consequences["pinocchio"]
    assert bare.fix is not None
    assert 'lower="-1" upper="0.5"' in bare.fix.title
    (full,) = find(tmp_path, make_three_links(make_joint(f'<limit effort="1" velocity="1">{typed}</limit>')), "JNT004")
    assert "cannot move" in full.message
    assert "refuses" not in full.consequences["urdfdom"]
    (empty,) = find(tmp_path, make_three_links(make_joint('<limit effort="1"/>')), "JNT004")
    assert "no range" not in empty.headline
    assert "lacks velocity" in empty.consequences["urdfdom"]
