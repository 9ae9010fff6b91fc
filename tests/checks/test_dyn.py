"""What a robot has to hold and to move: where the DYN rules begin and end, and when they are silent."""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from builders import find, inertial, joint, link, robot
from conftest import FIXTURES, check, check_text

from urdfcheck.core import Severity
from urdfcheck.facts.motion import dynamics
from urdfcheck.model import Model
from urdfcheck.model.motion.joint_loads import find_overloads, find_supported_joints, summarize_mass_matrix
from urdfcheck.model.motion.poses import sample_configurations
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.system.array_cache import ArrayCache

pytest.importorskip("pinocchio")
G = 9.81


def make_body(name: str, mass: float = 1.0, com: str = "0 0 0", inertia: float = 1e-3) -> str:
    """Return a link with a mass and three equal moments of inertia."""
    return link(name, inertial(mass, inertia, com=com))


def make_driven_joint(
    name: str,
    parent: str,
    child: str,
    kind: str = "revolute",
    axis: str = "0 1 0",
    origin: str = "",
    limit: str = 'lower="-1.6" upper="1.6" effort="1000"',
    inner: str = "",
) -> str:
    """Return a joint with a motor; ``origin`` and ``limit`` are the attributes of these elements."""
    parts = (f"<origin {origin}/>", f'<limit {limit} velocity="1"/>', inner)
    return joint(name, parent, child, *parts, kind=kind, axis=axis)


def make_robot_on_base(*parts: str) -> str:
    return robot(link("base"), *parts)


def model_of(folder: Path, text: str) -> Model:
    path = folder / "robot.urdf"
    path.write_text(text, encoding="utf-8")
    source = load_source(path, {}, PackageFinder(path))
    assert source.root is not None
    return Model(source=source, robot=source.root)


# -- DYN002: effort below gravity --------------------------------------------------------------------------------

ARM = make_body("arm", 2.0, "0 0 0.5")
NEEDED = 2.0 * G * 0.5


def make_pendulum(
    effort: float, inner: str = "", *parts: str, base: str = "", range: str = 'lower="-1.6" upper="1.6"'
) -> str:
    shoulder = make_driven_joint(
        "shoulder", "base", "arm", origin=base, limit=f'{range} effort="{effort}"', inner=inner
    )
    return make_robot_on_base(ARM, shoulder, *parts)


def test_the_worst_pose_of_a_pendulum_and_the_value_that_passes(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_pendulum(5), "DYN002")
    assert finding.severity is Severity.WARNING
    assert finding.location.subject == "joint[shoulder]/limit@effort"
    assert finding.data["torque"] == pytest.approx(NEEDED)
    assert abs(finding.data["pose"]["shoulder"]) == pytest.approx(math.pi / 2)
    assert finding.data["passes"] == pytest.approx(NEEDED, abs=0.011)
    assert not find(tmp_path, make_pendulum(finding.data["passes"]), "DYN002")


@pytest.mark.parametrize(("effort", "message"), [(0.1, "weak"), (0.09, "far")])
def test_a_hundred_times_too_much_is_a_matter_of_the_masses(tmp_path: Path, effort: float, message: str) -> None:
    (finding,) = find(tmp_path, make_pendulum(effort), "DYN002")
    assert finding.message_id == message
    assert finding.fix is not None
    assert finding.fix.title.startswith("check the masses") == (message == "far")


def test_only_poses_within_the_limits_count(tmp_path: Path) -> None:
    assert not find(tmp_path, make_pendulum(5, range='lower="-0.5" upper="0.5"'), "DYN002")
    assert find(tmp_path, make_pendulum(4.2, range='lower="-0.5" upper="0.5"'), "DYN002")


@pytest.mark.parametrize(
    ("names", "kind", "severity"),
    [
        (("rotor1", "rotor2"), "continuous", Severity.INFO),
        (("left_propeller", "right_propeller"), "continuous", Severity.INFO),
        (("rotor1", "finger"), "continuous", Severity.WARNING),
        (("rotor1", "rotor2"), "revolute", Severity.WARNING),
    ],
)
def test_propellers_may_hold_the_arm_that_carries_them(
    tmp_path: Path, names: tuple[str, ...], kind: str, severity: Severity
) -> None:
    arm = make_driven_joint("shoulder", "base", "arm", limit='lower="-1.6" upper="1.6" effort="1"')
    parts = [make_body(name, 0.01) + make_driven_joint(name, "arm", name, kind=kind) for name in names]
    text = make_robot_on_base(arm, make_body("arm", com="1 0 0"), *parts)
    (finding,) = find(tmp_path, text, "DYN002")
    assert (finding.message_id, finding.severity) == ("weak", severity)


@pytest.mark.parametrize(("base", "holds"), [("0 0 1", True), ("0 0 -2.5", True), ("1.5707963 0 0", False)])
def test_turning_the_base_about_the_vertical_changes_nothing(tmp_path: Path, base: str, holds: bool) -> None:
    """Laid down by roll, the shoulder's axis is vertical and carries nothing."""
    assert bool(find(tmp_path, make_pendulum(5, base=f'rpy="{base}"'), "DYN002")) == holds


def test_a_pose_that_is_hardly_ever_taken_is_mentioned_only(tmp_path: Path) -> None:
    angles = sample_configurations(model_of(tmp_path, make_pendulum(5)), 200).values[:, 0]
    second, first = sorted(NEEDED * abs(math.sin(angle)) for angle in angles)[-2:]
    text = make_pendulum((first + second) / 2)
    (finding,) = find(tmp_path, text, "DYN002")
    assert finding.severity is Severity.INFO
    assert finding.data["count"] == 1
    (finding,) = find(tmp_path, text, "DYN002", options={"DYN002": {"rare": 0.005}})
    assert finding.severity is Severity.WARNING


@pytest.mark.parametrize(("last", "found"), [(1.0, False), (1.1, True)])
def test_one_round_mass_of_all_links_is_no_load(tmp_path: Path, last: float, found: bool) -> None:
    limit, parts, parent = 'lower="-1.6" upper="1.6" effort="5"', [], "base"
    for name, mass in (("a", 1.0), ("b", 1.0), ("c", 1.0), ("d", last)):
        parts.append(make_body(name, mass, "0 0 0.5"))
        parts.append(make_driven_joint(f"j{name}", parent, name, "revolute" if name == "a" else "fixed", limit=limit))
        parent = name
    assert bool(find(tmp_path, make_robot_on_base(*parts), "DYN002")) == found


@pytest.mark.parametrize(("tensor", "found"), [(1e-3, False), (2e-3, True)])
def test_placeholders_are_no_load_whatever_tool_is_behind_them(tmp_path: Path, tensor: float, found: bool) -> None:
    """The last links of an arm of placeholders carry a tool of its own masses."""
    limit, parts, parent = 'lower="-1.6" upper="1.6" effort="5"', [], "base"
    masses = {"a": (1.0, 1e-3), "b": (1.0, 1e-3), "c": (1.0, 1e-3), "d": (1.0, tensor), "tool": (0.7, 1e-3)}
    for name, (mass, inertia) in masses.items():
        parts.append(make_body(name, mass, "0 0 0.6", inertia))
        parts.append(make_driven_joint(f"j{name}", parent, name, "revolute" if name == "d" else "fixed", limit=limit))
        parent = name
    assert bool(find(tmp_path, make_robot_on_base(*parts), "DYN002")) == found


@pytest.mark.parametrize(("base", "found"), [("fixed", ["first", "second"]), ("floating", ["second"])])
def test_a_robot_that_floats_lifts_its_lighter_side(tmp_path: Path, base: str, found: list[str]) -> None:
    """A chain of three equal parts behind the head: nothing holds the head while the first joint lifts two of them."""
    limit, parts, parent = 'lower="-1.6" upper="1.6" effort="1"', [], "head"
    for name, mass in (("first", 1.1), ("second", 1.0)):
        parts.append(make_body(f"{name}_part", mass, "0 0 0.25"))
        parts.append(make_driven_joint(name, parent, f"{name}_part", origin='xyz="0 0 0.5"', limit=limit))
        parent = f"{name}_part"
    text = robot(link("world"), make_body("head", 1.0), joint("float", "world", "head", kind=base), *parts)
    (finding,) = find(tmp_path, text, "DYN002")
    assert sorted(finding.data["joints"]) == found


def test_joints_with_one_limit_are_one_finding(tmp_path: Path) -> None:
    limit = 'lower="-1.6" upper="1.6" effort="5"'
    legs = [
        part
        for name, mass in (("a", 2.0), ("b", 3.0), ("c", 0.1))
        for part in (make_body(name, mass, "0 0 0.5"), make_driven_joint(f"j{name}", "base", name, limit=limit))
    ]
    (finding,) = find(tmp_path, make_robot_on_base(*legs), "DYN002")
    assert finding.subjects == ("joint[jb]/limit@effort", "joint[ja]/limit@effort")
    assert "ja (9.81 N·m)" in finding.message
    assert set(finding.data["joints"]) == {"ja", "jb"}
    # Their branches do not act on each other, so the pose names the one joint only.
    assert set(finding.data["pose"]) == {"jb"}


def test_a_slide_is_compared_in_newton(tmp_path: Path) -> None:
    lift = make_driven_joint("lift", "base", "arm", "prismatic", "0 0 1", limit='lower="0" upper="1" effort="10"')
    (finding,) = find(tmp_path, make_robot_on_base(ARM, lift), "DYN002")
    assert "19.6 N against gravity" in finding.message


def test_the_leader_of_a_gripper_holds_both_fingers(tmp_path: Path) -> None:
    fingers = [make_body(side, 1.0, "0 0 0.1") for side in ("left", "right")]
    mimic = '<mimic joint="left_joint" multiplier="-2"/>'

    def gripper(effort: float, inner: str) -> str:
        limit = f'lower="-1.6" upper="1.6" effort="{effort}"'
        leader = make_driven_joint("left_joint", "base", "left", limit=limit)
        return make_robot_on_base(*fingers, leader, make_driven_joint("right_joint", "base", "right", inner=inner))

    assert not find(tmp_path, gripper(1.1, ""), "DYN002")
    # The right finger turns twice as far: its torque counts twice.
    (finding,) = find(tmp_path, gripper(1.1, mimic), "DYN002")
    assert finding.subjects == ("joint[left_joint]/limit@effort",)
    pose = finding.data["pose"]
    assert pose["right_joint"] == pytest.approx(-2 * pose["left_joint"])
    torque = G * 0.1 * abs(math.sin(pose["left_joint"]) - 2 * math.sin(pose["right_joint"]))
    assert finding.data["torque"] == pytest.approx(torque)


def test_effort_zero_and_followers_are_not_compared(tmp_path: Path) -> None:
    assert not find(tmp_path, make_pendulum(0), "DYN002")
    follower = make_driven_joint(
        "b", "base", "other", limit='lower="-1" upper="1" effort="0.1"', inner='<mimic joint="shoulder"/>'
    )
    assert not find(tmp_path, make_pendulum(1000, "", make_body("other", 1.0, "0 0 0.5"), follower), "DYN002")


@pytest.mark.parametrize(
    "part",
    [
        '<gazebo reference="arm"><turnGravityOff>true</turnGravityOff></gazebo>',
        '<gazebo reference="arm"><gravity>false</gravity></gazebo>',
        '<gazebo reference="shoulder"><springStiffness>10</springStiffness></gazebo>',
        '<gazebo><joint name="loop" type="revolute"><parent>base</parent><child>arm</child></joint></gazebo>',
        '<gazebo><plugin filename="gz-sim-buoyancy-system" name="gz::sim::systems::Buoyancy"/></gazebo>',
        make_body("front_wheel") + make_driven_joint("roll", "arm", "front_wheel", "continuous"),
    ],
    ids=["gravity off", "no gravity", "spring", "loop", "afloat", "wheel"],
)
def test_a_load_that_the_tree_does_not_tell(tmp_path: Path, part: str) -> None:
    assert find(tmp_path / "alone", make_pendulum(5), "DYN002")
    assert not find(tmp_path / "helped", make_pendulum(5, "", part), "DYN002")


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("main_ROV_frame", "afloat"),
        ("bluerov2_frame", "afloat"),
        ("thruster_2", "afloat"),
        ("leftThruster", "afloat"),
        ("UUV", "afloat"),
        ("bravo7_no_ee", "afloat"),
        ("Bravo_5", "afloat"),
        ("bravo", "weak"),
        ("rover", "weak"),
        ("drive_proven", "weak"),
        ("thrust", "weak"),
    ],
)
def test_a_name_puts_the_robot_under_water(tmp_path: Path, name: str, message: str) -> None:
    floats = link(name) + joint("mount", "base", name)
    (finding,) = find(tmp_path / "a", make_pendulum(NEEDED / 1.9, "", floats), "DYN002")
    assert (finding.message_id, finding.severity is Severity.INFO) == (message, message == "afloat")
    (much,) = find(tmp_path / "b", make_pendulum(NEEDED / 2.1, "", floats), "DYN002")
    assert (much.message_id, much.severity) == ("weak", Severity.WARNING)


@pytest.mark.parametrize(
    ("comment", "reach", "message"),
    [("8.5Nm, 2 rad/s", 1, "documented"), ("8.5 rpm", 1, "weak"), ("18.5 Nm", 1, "weak"), ("8.5 Nm", 3, "documented")],
)
def test_a_limit_that_a_comment_repeats_is_a_note(tmp_path: Path, comment: str, reach: float, message: str) -> None:
    text = make_pendulum(8.5, f"<!-- {comment} -->", range=f'lower="-{reach * 1.5}" upper="{reach * 1.5}"')
    (finding,) = find(tmp_path, text, "DYN002")
    assert (finding.message_id, finding.severity is Severity.INFO) == (message, message == "documented")


def test_a_limit_that_a_comment_repeats_is_too_small_for_most_poses(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_pendulum(1, "<!-- 1 Nm -->"), "DYN002")
    assert (finding.message_id, finding.severity) == ("weak", Severity.WARNING)


@pytest.mark.parametrize(
    ("efforts", "message"),
    [
        ((0.01, 0.01, 0.01), "placeholder"),
        ((0.01, 0.01), "far"),  # too few joints to tell
        ((0.02, 0.02, 0.02), "far"),  # a number that may be a drive's
        ((0.01, 0.01, 3.0), "far"),
    ],
)
def test_one_power_of_ten_at_all_joints_is_a_placeholder(
    tmp_path: Path, efforts: tuple[float, ...], message: str
) -> None:
    others = [
        make_body(f"f{i}", 1e-6)
        + make_driven_joint(f"j{i}", "base", f"f{i}", limit=f'lower="-1" upper="1" effort="{effort}"')
        for i, effort in enumerate(efforts[1:])
    ]
    (finding,) = find(tmp_path, make_pendulum(efforts[0], "", *others), "DYN002")
    assert finding.message_id == message
    assert finding.fix is not None
    assert ("masses" in finding.fix.title) == (message == "far")


def test_impossible_masses_say_nothing_of_a_placeholder(tmp_path: Path) -> None:
    others = [
        make_body(f"f{i}", 1e-6)
        + make_driven_joint(f"j{i}", "base", f"f{i}", limit='lower="-1" upper="1" effort="0.01"')
        for i in range(2)
    ]
    head, arm, rest = make_pendulum(0.01, "", *others).partition('<link name="arm">')
    drawn = '<visual><origin xyz="0 0 0.5"/><geometry><box size="0.01 0.01 0.01"/></geometry></visual></link>'
    (finding,) = find(tmp_path, head + arm + rest.replace("</link>", drawn, 1), "DYN002")
    assert finding.message_id == "far"
    assert finding.fix is not None
    assert finding.fix.title.startswith("check the masses")


@pytest.mark.parametrize(("size", "severity"), [("0.01 0.01 0.01", Severity.INFO), ("0.1 0.1 1", Severity.WARNING)])
def test_a_limit_that_impossible_masses_exceed_is_a_note(tmp_path: Path, size: str, severity: Severity) -> None:
    head, arm, rest = make_pendulum(1, "").partition('<link name="arm">')
    drawn = f'<visual><origin xyz="0 0 0.5"/><geometry><box size="{size}"/></geometry></visual></link>'
    (finding,) = find(tmp_path, head + arm + rest.replace("</link>", drawn, 1), "DYN002")
    assert (finding.message_id, finding.severity) == ("weak", severity)


def test_an_exporters_effort_is_one_finding_at_any_load(tmp_path: Path) -> None:
    lift = '<limit lower="0" upper="1" effort="1" velocity="1"/>'
    slide = (
        '<joint name="slide" type="prismatic"><parent link="base"/><child link="tray"/><axis xyz="0 0 1"/>'
        + lift
        + "</joint>"
    )
    idle = make_driven_joint("idle", "base", "light", limit='lower="-1" upper="1" effort="1"')
    others = make_body("tray", 1.0) + slide + make_body("light", 1e-6) + idle
    (finding,) = find(tmp_path / "a", make_pendulum(1, "", others), "DYN002")
    assert (finding.message_id, len(finding.subjects)) == ("placeholder", 2)
    assert {"slide", "shoulder"} == set(finding.data["joints"])
    assert " N)" in finding.message or " N·m)" in finding.message
    # A limit of 10 may be that of three equal drives.
    ten = find(tmp_path / "b", make_pendulum(1, "", others).replace('effort="1"', 'effort="9"'), "DYN002")
    assert {f.message_id for f in ten} == {"weak"}


@pytest.mark.parametrize(
    ("box", "message"),
    [("0.1 0.1 1", "write the largest"), ("0.01 0.01 0.01", "check the masses"), ("", "check the masses")],
)
def test_masses_are_to_blame_only_where_the_drawing_does_not_explain_them(
    tmp_path: Path, box: str, message: str
) -> None:
    drawn = (
        f'<visual><origin xyz="0 0 0.5"/><geometry><box size="{box}"/></geometry></visual></link>' if box else "</link>"
    )
    text = make_pendulum(0.01)
    head, arm, rest = text.partition('<link name="arm">')
    (finding,) = find(tmp_path, head + arm + rest.replace("</link>", drawn, 1), "DYN002")
    assert finding.message_id == "far"
    assert finding.fix is not None
    assert finding.fix.title.startswith(message)


@pytest.mark.parametrize(("place", "found"), [("0 0 0.5", True), ("0 0 -0.5", False)])
def test_a_com_outside_its_part_shows_no_torque(tmp_path: Path, place: str, found: bool) -> None:
    """The COM is at z = 0.5: in the drawn part, or half a metre above it."""
    drawn = f'<visual><origin xyz="{place}"/><geometry><box size="0.1 0.1 1"/></geometry></visual></link>'
    head, arm, rest = make_pendulum(5).partition('<link name="arm">')
    assert bool(find(tmp_path, head + arm + rest.replace("</link>", drawn, 1), "DYN002")) is found


def test_gravity_that_is_not_turned_off_counts(tmp_path: Path) -> None:
    off = '<gazebo reference="arm"><turnGravityOff>false</turnGravityOff></gazebo>'
    assert find(tmp_path, make_pendulum(5, "", off), "DYN002")


def test_a_loop_leaves_the_joints_before_it_alone(tmp_path: Path) -> None:
    loop = '<gazebo><joint name="loop" type="revolute"><parent>left</parent><child>right</child></joint></gazebo>'
    fingers = [
        part
        for side in ("left", "right")
        for part in (
            make_body(side, 1.0, "0 0 0.1"),
            make_driven_joint(f"{side}_joint", "arm", side, limit='effort="0.1" upper="1"'),
        )
    ]
    model = model_of(tmp_path, make_pendulum(5, "", *fingers, loop))
    assert find_supported_joints(model) == {"left_joint", "right_joint"}
    assert [load.joint.name for load in find_overloads(model)] == ["shoulder"]


def test_a_negative_mass_is_another_rules_matter(tmp_path: Path) -> None:
    run = check_text(tmp_path, make_pendulum(5).replace('value="2.0"', 'value="-2.0"'), codes={"DYN002"})
    assert [(s.code, "INR002" in s.reason) for s in run.skipped] == [("DYN002", True)]


# -- DYN001: ill-conditioned mass matrix -------------------------------------------------------------------------


def dummy(name: str, inertia: float, parent: str = "base") -> str:
    """A body of the moment ``inertia`` between two joints on one axis, the second of which carries 0.1 kg m²."""
    return (
        make_body(name, 1e-3, inertia=inertia)
        + make_driven_joint(f"{name}_1", parent, name, axis="0 0 1")
        + make_body(f"{name}_load", inertia=0.1)
        + make_driven_joint(f"{name}_2", name, f"{name}_load", axis="0 0 1")
    )


@pytest.mark.parametrize(("inertia", "light"), [(1e-6, True), (1e-3, False)])
def test_a_dummy_link_between_two_joints_on_one_axis(tmp_path: Path, inertia: float, light: bool) -> None:
    findings = find(tmp_path, make_robot_on_base(dummy("d", inertia)), "DYN001")
    assert [f.location.subject for f in findings] == (["link[d]/inertial"] if light else [])
    for finding in findings:
        assert finding.data["own"] == pytest.approx(inertia)
        assert finding.data["moved"] == pytest.approx(0.1, rel=1e-3)
        assert finding.data["number"] == pytest.approx(4e5, rel=1e-2)


@pytest.mark.parametrize(("size", "found"), [("0.5 0.5 0.5", ["DYN001"]), ("0.01 0.01 0.01", ["INR005"])])
def test_nothing_is_light_beside_an_impossible_tensor(tmp_path: Path, size: str, found: list[str]) -> None:
    text = make_robot_on_base(dummy("d", 1e-6))
    head, load, rest = text.partition('<link name="d_load">')
    drawn = f'<visual><geometry><box size="{size}"/></geometry></visual></link>'
    findings = find(tmp_path, head + load + rest.replace("</link>", drawn, 1), {"DYN001", "INR005"})
    assert [finding.code for finding in findings] == found


def test_the_limit_is_an_option(tmp_path: Path) -> None:
    assert not find(tmp_path, make_robot_on_base(dummy("d", 1e-6)), "DYN001", options={"DYN001": {"limit": 1e6}})


def test_the_same_dummy_on_two_arms_is_found(tmp_path: Path) -> None:
    torso = make_body("torso", 10.0, inertia=0.5) + make_driven_joint("waist", "base", "torso", axis="1 0 0")
    arms = [dummy(side, 1e-6, "torso") for side in ("left", "right")]
    assert len(find(tmp_path, make_robot_on_base(torso, *arms), "DYN001")) == 1


def test_a_long_chain_of_equal_links_is_no_defect(tmp_path: Path) -> None:
    parts = [
        make_body(f"l{i}", 1.0, "0.05 0 0")
        + make_driven_joint(f"j{i}", f"l{i - 1}" if i else "base", f"l{i}", origin='xyz="0.1 0 0"')
        for i in range(12)
    ]
    model = model_of(tmp_path, make_robot_on_base(*parts))
    found_mobility = summarize_mass_matrix(model)
    assert found_mobility is not None
    assert found_mobility.condition_number > 1e3
    assert found_mobility.light_joint is None


@pytest.mark.parametrize(
    ("inertial", "reason"),
    [("", "INR001"), (make_body("x", 0.0, inertia=0.0), "INR002"), (make_body("x", 1.0, inertia=0.0), "INR004")],
)
def test_bodies_without_mass_or_inertia_are_other_rules_matter(tmp_path: Path, inertial: str, reason: str) -> None:
    text = make_robot_on_base(inertial.replace('"x"', '"d"') or '<link name="d"/>', make_driven_joint("j", "base", "d"))
    run = check_text(tmp_path, text, codes={"DYN001"})
    assert not run.findings
    assert [reason in skip.reason for skip in run.skipped] == [True]


def test_a_robot_that_does_not_move_has_no_mass_matrix(tmp_path: Path) -> None:
    run = check_text(tmp_path, make_robot_on_base(), codes={"DYN001", "DYN002", "DYN003"})
    assert not run.findings
    assert not run.skipped


# -- DYN003: stiff joint -----------------------------------------------------------------------------------------


def damped(damping: float, *parts: str, inertia: float = 1e-4) -> str:
    inner = f'<dynamics damping="{damping}"/>'
    return make_robot_on_base(
        make_body("finger", 0.1, inertia=inertia), make_driven_joint("j", "base", "finger", inner=inner), *parts
    )


@pytest.mark.parametrize(("damping", "stiff"), [(0.299, False), (0.301, True)])
def test_damping_beyond_three_times_the_inertia_per_step(tmp_path: Path, damping: float, stiff: bool) -> None:
    findings = find(tmp_path, damped(damping), "DYN003")
    assert [f.location.subject for f in findings] == (["joint[j]/dynamics@damping"] if stiff else [])
    for finding in findings:
        assert finding.data["stable_step"] == pytest.approx(2e-4 / damping)
        assert finding.data["robot_step"] == pytest.approx(2e-4 / damping)
        assert finding.data["most"] == pytest.approx(0.2)


def test_the_time_step_is_an_option(tmp_path: Path) -> None:
    assert not find(tmp_path, damped(0.301), "DYN003", options={"DYN003": {"time_step": 5e-4}})
    assert find(tmp_path, damped(0.299), "DYN003", options={"DYN003": {"time_step": 2e-3}})


@pytest.mark.parametrize(("said", "stiff"), [("true", False), ("1", False), ("0", True), ("false", True)])
def test_a_joint_that_gazebo_is_to_integrate_implicitly(tmp_path: Path, said: str, stiff: bool) -> None:
    part = f'<gazebo reference="j"><implicitSpringDamper> {said} </implicitSpringDamper></gazebo>'
    assert bool(find(tmp_path, damped(1, part), "DYN003")) == stiff


def test_the_inertia_is_that_with_the_other_joints_free(tmp_path: Path) -> None:
    """On a light body that turns freely, the same finger gets out of its damper's way."""
    inner = '<dynamics damping="0.16"/>'
    hand = make_body("hand", 0.1, inertia=1e-4) + make_driven_joint("wrist", "base", "hand")
    finger = make_body("finger", 0.1, inertia=1e-4) + make_driven_joint("j", "hand", "finger", inner=inner)
    (finding,) = find(tmp_path, make_robot_on_base(hand, finger), "DYN003")
    assert finding.data["inertia"] == pytest.approx(0.5e-4)


def test_several_dampers_are_unstable_earlier_than_each(tmp_path: Path) -> None:
    inner = '<dynamics damping="0.6"/>'
    hand = make_body("hand", 0.1, inertia=1e-4) + make_driven_joint("wrist", "base", "hand", inner=inner)
    finger = make_body("finger", 0.1, inertia=1e-4) + make_driven_joint("j", "hand", "finger", inner=inner)
    (finding,) = find(tmp_path, make_robot_on_base(hand, finger), "DYN003")
    assert finding.subjects == ("joint[j]/dynamics@damping", "joint[wrist]/dynamics@damping")
    # M^-1 D = 6000/s · [[1, -1], [-1, 2]]: its largest eigenvalue is (3 + √5)/2 times that.
    assert finding.data["robot_step"] == pytest.approx(2 / (6000 * (3 + math.sqrt(5)) / 2))
    assert finding.data["robot_step"] < finding.data["stable_step"]


def test_dampers_that_gazebo_integrates_implicitly_do_not_count(tmp_path: Path) -> None:
    inner = '<dynamics damping="0.3"/>'
    hand = make_body("hand", 0.1, inertia=1e-4) + make_driven_joint("wrist", "base", "hand", inner=inner)
    finger = make_body("finger", 0.1, inertia=1e-4) + make_driven_joint("j", "hand", "finger", inner=inner)
    calm = '<gazebo reference="wrist"><implicitSpringDamper>1</implicitSpringDamper></gazebo>'
    (finding,) = find(tmp_path, make_robot_on_base(hand, finger, calm), "DYN003")
    assert finding.subjects == ("joint[j]/dynamics@damping",)
    assert finding.data["robot_step"] == pytest.approx(finding.data["stable_step"])


def test_the_pose_in_which_least_inertia_is_felt_counts(tmp_path: Path) -> None:
    """A point mass on a free elbow adds m L² sin² q to what the shoulder feels: nothing where the arm is straight."""
    upper = make_body("upper", 1.0, inertia=0.1) + make_driven_joint("shoulder", "base", "upper")
    fore = make_body("fore", 2.0, "0 0 0.3", 1e-6) + make_driven_joint("elbow", "upper", "fore", origin='xyz="0 0 0.5"')
    felt = summarize_mass_matrix(model_of(tmp_path, make_robot_on_base(upper, fore)))
    assert felt is not None
    assert felt.effective_inertias["shoulder"] == pytest.approx(0.1, rel=1e-3)


def test_a_light_link_is_reported_once(tmp_path: Path) -> None:
    text = make_robot_on_base(dummy("d", 1e-6)).replace("</joint>", '<dynamics damping="0.1"/></joint>')
    run = check_text(tmp_path, text, codes={"DYN001", "DYN003"})
    assert [f.code for f in run.findings] == ["DYN001"]


# -- all ---------------------------------------------------------------------------------------------------------


def test_without_pinocchio_the_rules_are_skipped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pinocchio", None)
    inner = '<dynamics damping="9"/>'
    run = check_text(tmp_path, make_pendulum(5, inner), codes={"DYN001", "DYN002", "DYN003"})
    assert [s.code for s in run.skipped] == ["DYN001", "DYN002", "DYN003"]
    assert all("not installed" in s.reason for s in run.skipped)


@pytest.mark.parametrize("kind", ["floating", "planar"])
def test_a_base_that_floats_is_held_and_counts_as_inertia(tmp_path: Path, kind: str) -> None:
    free = f'<joint name="free" type="{kind}"><parent link="base"/><child link="body"/><axis xyz="0 0 1"/></joint>'
    shoulder = make_driven_joint("shoulder", "body", "arm", limit='lower="-1.6" upper="1.6" effort="5"')
    model = model_of(tmp_path, make_robot_on_base(make_body("body", 1.0, inertia=0.1), free, ARM, shoulder))
    (overload,) = find_overloads(model)
    assert overload.torque == pytest.approx(NEEDED)
    felt = summarize_mass_matrix(model)
    assert felt is not None
    # A body that gives way lets the arm turn more easily than a fixed one.
    own = 1e-3 + 2.0 * 0.5**2
    assert felt.effective_inertias["shoulder"] < own * (1 - 1e-3)


def test_results_are_kept_until_the_model_changes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    cache = ArrayCache(tmp_path / "cache")
    first = replace(model_of(tmp_path, make_pendulum(5)), cache=cache)
    before = find_overloads(first), summarize_mass_matrix(first)
    again = replace(model_of(tmp_path, make_pendulum(5)), cache=cache)
    other = replace(model_of(tmp_path, make_pendulum(6)), cache=cache)

    def fail(*_: object) -> None:
        raise AssertionError("computed")

    monkeypatch.setattr(dynamics, "locate_joint_coordinates", fail)
    ((load,), felt) = find_overloads(again), summarize_mass_matrix(again)
    assert (load.torque, load.joint_values, load.count) == (
        before[0][0].torque,
        before[0][0].joint_values,
        before[0][0].count,
    )
    assert felt is not None
    assert before[1] is not None
    assert felt.effective_inertias == before[1].effective_inertias
    with pytest.raises(AssertionError, match="computed"):
        find_overloads(other)


@pytest.mark.parametrize("name", ["car-3", "car-3-fixed"])
def test_the_fixtures_hold_what_they_carry(name: str) -> None:
    run = check(FIXTURES / name, codes={"DYN001", "DYN002", "DYN003"})
    assert not run.failures
    assert not run.findings
    assert not run.skipped
