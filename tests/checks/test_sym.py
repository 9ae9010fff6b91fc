"""Odd ones out: who is blamed, what is proposed, and when nothing is said."""

from __future__ import annotations

from math import cos, pi, sin
from pathlib import Path

import numpy as np
import pytest
from builders import find, inertial, joint, link

from urdfcheck.core import Finding, Severity
from urdfcheck.facts.motion.kinematics import rpy_to_matrix
from urdfcheck.model.repairs.rpy_text import find_nearest_rpy

WHEEL = (
    '<inertial><origin xyz="0 0.002 0.001"/><mass value="0.03"/>'
    '<inertia ixx="6.6e-6" ixy="0" ixz="0" iyy="1.27e-5" iyz="0" izz="6.6e-6"/></inertial>'
)
CORNERS = {
    "front_left": ("0.07 0.05 0", "0 0 0", "0 1 0"),
    "rear_left": ("-0.07 0.05 0", "0 0 0", "0 1 0"),
    "rear_right": ("-0.07 -0.05 0", f"0 0 {pi}", "0 -1 0"),
    "front_right": ("0.07 -0.05 0", f"0 0 {pi}", "0 -1 0"),
}


def make_joint_on_base(
    name: str, child: str, xyz: str, rpy: str, axis: str, kind: str = "continuous", parent: str = "base"
) -> str:
    return joint(name, parent, child, kind=kind, xyz=xyz, rpy=rpy, axis=axis)


def car(kind: str = "continuous", **rpy: str) -> str:
    """Four wheels on the corners of a rectangle, some with another rpy."""
    parts = ['<link name="base"/>']
    for name, (xyz, usual, axis) in CORNERS.items():
        parts.append(f'<link name="{name}_wheel">{WHEEL}</link>')
        parts.append(make_joint_on_base(name, f"{name}_wheel", xyz, rpy.get(name, usual), axis, kind))
    return f'<robot name="car" xmlns:xacro="http://www.ros.org/wiki/xacro">{"".join(parts)}</robot>'


def edits(finding: Finding) -> list[tuple[str, str]]:
    assert finding.fix is not None
    return [(e.expected, e.replacement) for e in finding.fix.edits]


# -- SYM001 ---------------------------------------------------------------------------------------------------------


def test_a_consistent_car_has_no_odd_wheel(tmp_path: Path) -> None:
    assert not find(tmp_path, car(), "SYM001")


@pytest.mark.parametrize("name", CORNERS)
def test_each_wheel_is_named_when_it_is_the_one(tmp_path: Path, name: str) -> None:
    yaw = CORNERS[name][1].split()[2]
    (finding,) = find(tmp_path, car(**{name: f"0 0.3 {yaw}"}), "SYM001")
    assert finding.location.subject == f"joint[{name}]/origin@rpy"
    assert finding.message_id == "zero"
    assert abs(abs(finding.data["angle"]) - 17.19) < 0.01


def test_the_angle_is_signed_about_the_joints_own_axis(tmp_path: Path) -> None:
    (left,) = find(tmp_path / "a", car(front_left="0 0.3 0"), "SYM001")
    (right,) = find(tmp_path / "b", car(front_right=f"0 0.3 {pi}"), "SYM001")
    assert left.data["angle"] == pytest.approx(17.1887, abs=1e-3)
    assert right.data["angle"] == pytest.approx(-17.1887, abs=1e-3)


def test_the_edit_writes_the_angles_of_the_pattern(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, car(front_right="0 0.3 3.1416"), "SYM001")
    assert edits(finding) == [("0 0.3 3.1416", "0 0 3.14159265358979")]


def test_a_xacro_gets_pi_by_name(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, car(front_right="0 0.3 3.1416"), "SYM001", name="robot.urdf.xacro")
    assert edits(finding) == [("0 0.3 3.1416", "0 0 ${pi}")]


def test_a_computed_rpy_is_not_edited(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, car(front_left="0 ${0.1 + 0.2} 0"), "SYM001", name="robot.urdf.xacro")
    assert not edits(finding)


def test_a_wheel_that_is_tilted_has_toe_or_camber(tmp_path: Path) -> None:
    (toe,) = find(tmp_path / "a", car(front_left="0 0 0.05"), "SYM001")
    (camber,) = find(tmp_path / "b", car(front_left="0.05 0 0"), "SYM001")
    assert toe.message_id == camber.message_id == "wheel"
    assert (toe.data["toe"], toe.data["camber"]) == (pytest.approx(2.865, abs=1e-3), pytest.approx(0, abs=1e-9))
    assert (camber.data["toe"], camber.data["camber"]) == (pytest.approx(0, abs=1e-9), pytest.approx(2.865, abs=1e-3))


def test_the_limits_of_a_revolute_joint_turn_with_it(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, car("revolute", front_left="0 0.3 0"), "SYM001")
    assert "the joint's limits" in finding.message


def test_the_distance_of_the_centre_of_mass_from_the_axis_is_told(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, car(front_left="0 0.3 0"), "SYM001")
    assert "1 mm off the axis" in finding.message


@pytest.mark.parametrize("rpy", ["0 0.001 0", f"0 {pi / 2} 0", f"0 {pi} 0"])
def test_typing_errors_and_quarter_turns_are_choices(tmp_path: Path, rpy: str) -> None:
    assert not find(tmp_path, car(front_left=rpy), "SYM001")


@pytest.mark.parametrize(("angle", "found"), [(0.12654, False), (0.0, True)])
def test_an_angle_that_the_com_takes_back_is_a_choice(tmp_path: Path, angle: float, found: bool) -> None:
    """Two fingers whose meshes are not known: the frame of one is rotated, and its COM may be where the mirror puts it."""
    parts = ['<link name="palm"/>']
    for name, y, rpy, turn in (("right", -0.02, "0 0 0", 0.0), ("left", 0.02, "0 0.12654 0", angle)):
        x, z = 0.005 * cos(turn) - 0.018 * sin(turn), 0.005 * sin(turn) + 0.018 * cos(turn)
        terms = {"ixx": 6e-7, "iyy": 6e-7, "izz": 1e-7}
        parts.append(link(name, inertial(0.009, com=f"{x!r} 0 {z!r}", **terms)))
        parts.append(make_joint_on_base(f"{name}_joint", name, f"0 {y} 0.04", rpy, "0 1 0", parent="palm"))
    assert bool(find(tmp_path, f'<robot name="hand">{"".join(parts)}</robot>', "SYM001")) == found


def test_two_odd_wheels_of_four_leave_nobody_to_blame(tmp_path: Path) -> None:
    assert not find(tmp_path, car(front_left="0 0.3 0", rear_right=f"0 0.7 {pi}"), "SYM001")


def test_a_different_wheel_is_no_sibling(tmp_path: Path) -> None:
    text = car(front_left="0 0.3 0").replace('value="0.03"', 'value="0.09"', 1)
    assert not find(tmp_path, text, "SYM001")


def test_children_without_inertial_and_mesh_are_not_compared(tmp_path: Path) -> None:
    assert not find(tmp_path, car(front_left="0 0.3 0").replace(WHEEL, ""), "SYM001")


def test_what_hangs_on_the_odd_joint_is_not_reported_again(tmp_path: Path) -> None:
    more = "".join(
        f'<link name="{name}_hub">{WHEEL}</link>'
        + make_joint_on_base(f"{name}_2", f"{name}_hub", "0 0 0", "0 0 0", "0 1 0", parent=f"{name}_wheel")
        for name in CORNERS
    )
    text = car(front_left="0 0.3 0").replace("</robot>", f"{more}</robot>")
    assert [f.location.subject for f in find(tmp_path, text, "SYM001")] == ["joint[front_left]/origin@rpy"]


def mounted(*, mount: str = "0 0 0", own: str = "0 0 0", sibling: str = "0 0 0") -> str:
    """Four wheels, each on a bracket that a fixed joint carries; one bracket and the wheel on it with another rpy."""
    parts = ['<link name="base"/>']
    for name, (xyz, _, _) in CORNERS.items():
        odd = name == "front_left"
        parts.append(f'<link name="{name}_bracket"/><link name="{name}_wheel">{WHEEL}</link>')
        held = make_joint_on_base(f"{name}_mount", f"{name}_bracket", xyz, mount if odd else sibling, "0 1 0", "fixed")
        parts.append(held.replace('<axis xyz="0 1 0"/>', ""))
        own_rpy = own if odd else "0 0 0"
        parts.append(make_joint_on_base(name, f"{name}_wheel", "0 0 0", own_rpy, "0 1 0", parent=f"{name}_bracket"))
    return f'<robot name="car">{"".join(parts)}</robot>'


def test_the_bracket_is_named_when_it_is_what_stands_askew(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, mounted(mount="0 0.4 0"), "SYM001")
    assert (finding.message_id, finding.location.subject) == ("mount", "joint[front_left_mount]/origin@rpy")
    assert edits(finding) == [("0 0.4 0", "0 0 0")]
    assert {r.subject for r in finding.related} == {
        f"joint[{name}_mount]/origin@rpy" for name in CORNERS if name != "front_left"
    }


def test_the_wheel_is_named_when_the_brackets_are_alike(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, mounted(own="0 0.4 0"), "SYM001")
    assert (finding.message_id, finding.location.subject) == ("zero", "joint[front_left]/origin@rpy")
    assert edits(finding) == [("0 0.4 0", "0 0 0")]


@pytest.mark.parametrize(("mount", "own"), [("0 0.4 0", "0 0.1 0"), ("0 0.2 0", "0 0.2 0")])
def test_where_bracket_and_wheel_are_off_both_are_named_and_nothing_is_edited(
    tmp_path: Path, mount: str, own: str
) -> None:
    (finding,) = find(tmp_path, mounted(mount=mount, own=own), "SYM001")
    assert finding.message_id == "chain"
    assert not edits(finding)
    assert "front_left_mount, front_left" in finding.message
    assert finding.related[0].subject == "joint[front_left_mount]/origin@rpy"


def axle(left: str = "0 0 0", right: str = "0 0 0", mount: str = "0 0 0", kind: str = "revolute") -> str:
    """Two arms that mirror each other, on shoulders of which one may be turned."""
    parts = ['<link name="base"/>']
    for name, xyz, rpy, shoulder in (("left", "0 0.2 0.3", left, mount), ("right", "0 -0.2 0.3", right, "0 0 0")):
        parts.append(f'<link name="{name}_shoulder"/><link name="{name}_arm">{WHEEL}</link>')
        parts.append(make_joint_on_base(f"{name}_mount", f"{name}_shoulder", xyz, shoulder, "0 1 0", "prismatic"))
        parts.append(make_joint_on_base(name, f"{name}_arm", "0 0 -0.1", rpy, "0 1 0", kind, parent=f"{name}_shoulder"))
    return f'<robot name="pair">{"".join(parts)}</robot>'


def test_a_pair_that_mirrors_or_repeats_itself_is_fine(tmp_path: Path) -> None:
    for i, (left, right) in enumerate(
        (("0 0 0", "0 0 0"), ("0 0.4 0", "0 0.4 0"), ("0.3 0 0", "-0.3 0 0"), ("0 1.5708 0", "0 0 0"))
    ):
        assert not find(tmp_path / str(i), axle(left, right), "SYM001")


def test_of_a_pair_the_one_with_an_angle_that_nobody_chooses_is_named(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, axle(right="0 -0.75239 0"), "SYM001")
    assert (finding.message_id, finding.severity) == ("limits", Severity.WARNING)
    assert finding.location.subject == "joint[right]/origin@rpy"
    assert finding.data["angle"] == pytest.approx(-43.109, abs=1e-3)
    assert "its sibling left (mirror y) has round angles, but `0 -0.75239 0` is implausible" in finding.message
    assert edits(finding) == [("0 -0.75239 0", "0 0 0")]


@pytest.mark.parametrize(
    ("angle", "extra", "severity"),
    [
        (0.0194, '<limit lower="-1" upper="1" effort="1" velocity="1"/>', Severity.WARNING),
        (0.0153, '<limit lower="-1" upper="1" effort="1" velocity="1"/>', Severity.INFO),
        (0.0194, '<limit effort="1" velocity="1"/>', Severity.INFO),
        (0.0194, '<limit lower="-1" upper="1" effort="1" velocity="1"/><mimic joint="rear_left"/>', Severity.INFO),
        (0.0394, '<limit lower="-1" upper="1" effort="1" velocity="1"/><mimic joint="rear_left"/>', Severity.WARNING),
        (0.0194, '<limit lower="0" upper="0" effort="1" velocity="1"/>', Severity.INFO),
    ],
)
def test_a_degree_in_a_joint_that_nothing_commands_is_a_note_without_an_edit(
    tmp_path: Path, angle: float, extra: str, severity: Severity
) -> None:
    text = car("revolute", front_left=f"0 {angle} 0")
    place = text.index("</joint>", text.index('<joint name="front_left"'))
    (finding,) = find(tmp_path, text[:place] + extra + text[place:], "SYM001")
    assert (finding.message_id, finding.severity) == ("limits", severity)
    assert bool(edits(finding)) is (severity is Severity.WARNING)


def test_a_part_that_does_not_lie_in_its_frame_as_the_others_do_shows_no_shifted_zero(tmp_path: Path) -> None:
    """Its COM, 5 mm off the axis, is turned by half of what the frame is turned back."""
    part = WHEEL.replace('xyz="0 0.002 0.001"', 'xyz="0.005 0.002 0"')
    turned = WHEEL.replace('xyz="0 0.002 0.001"', 'xyz="0.004943856 0.002 -0.000747191"')
    text = car("revolute", front_left="0 -0.3 0").replace(WHEEL, part)
    (finding,) = find(tmp_path / "a", text, "SYM001")
    assert finding.message_id == "limits"
    assert not find(tmp_path / "b", text.replace(part, turned, 1), "SYM001")


@pytest.mark.parametrize(
    ("angle", "kind", "message"),
    [("0.02", "revolute", "pair_slight"), ("0.04", "revolute", "pair"), ("0.04", "continuous", "pair_slight")],
)
def test_a_pair_that_is_a_degree_apart_or_of_wheels_is_on_request(
    tmp_path: Path, angle: str, kind: str, message: str
) -> None:
    text = axle(f"0 {angle} 0", "0 0 0", kind=kind).replace("_arm", "_wheel")
    (finding,) = find(tmp_path, text, "SYM001")
    assert (finding.message_id, finding.severity) == (message, Severity.INFO)


@pytest.mark.parametrize(
    ("left", "right"), [("0 0.3 0", "0 0 0"), ("0 0.75239 0", "0 0.31234 0"), ("0 0.75239 0", "0 0.2 0")]
)
def test_a_pair_of_which_nobody_can_say_more_is_named_as_a_pair(tmp_path: Path, left: str, right: str) -> None:
    (finding,) = find(tmp_path, axle(left, right), "SYM001")
    assert (finding.message_id, finding.severity) == ("pair", Severity.INFO)
    assert "joints left and right carry like children" in finding.message
    assert not edits(finding)


PIN = WHEEL.replace('xyz="0 0.002 0.001"', 'xyz="0 0.002 0"')


@pytest.mark.parametrize(("part", "is_named"), [(PIN, False), (PIN.replace('izz="6.6e-6"', 'izz="7.1e-6"'), True)])
def test_a_pin_has_no_zero_that_may_differ_from_another_s(tmp_path: Path, part: str, is_named: bool) -> None:
    text = axle("0 0.75239 0", "0 0.31234 0").replace(WHEEL, part)
    assert [f.message_id for f in find(tmp_path, text, "SYM001")] == ["pair"] * is_named


@pytest.mark.parametrize(
    ("name", "part", "severity"),
    [
        ("idler1", PIN, Severity.INFO),
        ("front_left", PIN, Severity.WARNING),
        ("idler1", WHEEL, Severity.WARNING),
    ],
    ids=["a round idler", "a round wheel", "an idler with its COM off the axis"],
)
def test_the_zero_of_a_round_wheel_that_nothing_drives_is_on_request(
    tmp_path: Path, name: str, part: str, severity: Severity
) -> None:
    text = car(front_left="0 0.3 0").replace(WHEEL, part).replace("front_left", name)
    (finding,) = find(tmp_path, text, "SYM001")
    assert (finding.message_id, finding.severity) == ("zero", severity)


def test_the_pair_is_reported_at_the_angle_that_nobody_chooses(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, axle("0 0.2 0", "0 0.75239 0"), "SYM001")
    assert finding.location.subject == "joint[right]/origin@rpy"
    assert [r.subject for r in finding.related] == ["joint[left]/origin@rpy"]


def test_a_pair_with_a_tilt_is_named_as_one(tmp_path: Path) -> None:
    sides = axle("0.05 0 0")
    assert not find(tmp_path / "a", sides, "SYM001")  # left and right are SYM004's
    (finding,) = find(tmp_path / "b", sides.replace("left", "upper").replace("right", "lower"), "SYM001")
    assert (finding.message_id, finding.data["size"]) == ("pair_tilt", pytest.approx(2.865, abs=1e-3))


def test_joints_on_what_stands_askew_are_not_the_ones_that_differ(tmp_path: Path) -> None:
    assert [f.location.subject for f in find(tmp_path / "a", axle(mount="0 0.12345 0"), "SYM001")] == []
    more = axle(mount="0 0.12345 0").replace(
        '<link name="left_shoulder"/>', f'<link name="left_shoulder">{WHEEL}</link>'
    )
    more = more.replace('<link name="right_shoulder"/>', f'<link name="right_shoulder">{WHEEL}</link>')
    assert [f.location.subject for f in find(tmp_path / "b", more, "SYM001")] == ["joint[left_mount]/origin@rpy"]


def test_an_axis_that_takes_back_the_tilt_of_its_frame_is_right(tmp_path: Path) -> None:
    tilt = 0.04123
    for i, (axis, count) in enumerate(((f"0 {cos(tilt)} {-sin(tilt)}", 0), ("0 1 0", 1))):
        text = axle(right=f"{tilt} 0 0", kind="continuous").replace("left", "upper").replace("right", "lower")
        place = text.rindex('<axis xyz="0 1 0"/>')
        text = text[:place] + f'<axis xyz="{axis}"/>' + text[place + len('<axis xyz="0 1 0"/>') :]
        found = find(tmp_path / str(i), text, "SYM001")
        assert len(found) == count
        assert all(f.message_id == "tilt" for f in found)  # an arm has neither toe nor camber


def test_an_odd_frame_whose_joints_behind_are_in_place_is_a_choice(tmp_path: Path) -> None:
    def build(right_hand: str) -> str:
        hands = "".join(
            f'<link name="{side}_hand"/>'
            + make_joint_on_base(f"{side}_wrist", f"{side}_hand", xyz, "0 0 0", "0 1 0", "revolute", f"{side}_arm")
            for side, xyz in (("left", "0 0.1 -0.3"), ("right", right_hand))
        )
        return axle(right="0 -0.75239 0").replace("</robot>", f"{hands}</robot>")

    assert len(find(tmp_path / "turned", build("0 -0.1 -0.3"), "SYM001")) == 1
    back = np.linalg.inv(rpy_to_matrix((0, -0.75239, 0))) @ (0.0, -0.1, -0.3)
    assert not find(tmp_path / "back", build(" ".join(f"{x:.9f}" for x in back)), "SYM001")


def tripod(first: str, *, row: bool = False) -> str:
    """Three legs at 120° or in a row; the first one has another rpy."""
    parts = ['<link name="base"/>']
    for i in range(3):
        xyz = f"{0.1 * i} 0 0" if row else f"{0.1 * cos(2 * pi * i / 3):.6f} {0.1 * sin(2 * pi * i / 3):.6f} 0"
        rpy = "0 0 0" if row else f"0 0 {2 * pi * i / 3:.5f}"
        parts.append(f'<link name="leg_{i}">{WHEEL}</link>')
        parts.append(make_joint_on_base(f"hip_{i}", f"leg_{i}", xyz, first if i == 0 else rpy, "0 1 0", "revolute"))
    return f'<robot name="tripod">{"".join(parts)}</robot>'


def test_of_three_legs_at_120_degrees_the_odd_one_is_named(tmp_path: Path) -> None:
    assert not find(tmp_path / "a", tripod("0 0 0"), "SYM001")
    (finding,) = find(tmp_path / "b", tripod("0 0.3 0"), "SYM001")
    assert (finding.message_id, finding.severity) == ("limits", Severity.WARNING)
    assert "its two siblings (hip_1, hip_2) follow one pattern (rotation by 120° about z)" in finding.message
    assert edits(finding) == [("0 0.3 0", "0 0 0")]


def test_of_three_in_a_row_numbers_have_to_decide(tmp_path: Path) -> None:
    assert not find(tmp_path / "a", tripod("0 0.3 0", row=True), "SYM001")
    (finding,) = find(tmp_path / "b", tripod("0 0.31234 0", row=True), "SYM001")
    assert finding.location.subject == "joint[hip_0]/origin@rpy"
    assert "its siblings hip_1, hip_2 (mirror x) have round angles" in finding.message


@pytest.mark.parametrize(("coxa", "tibia", "found"), [("0 0.03 0", "0 -0.02 0", 0), ("0 0 0", "0 -0.02 0", 1)])
def test_a_joint_is_not_blamed_for_the_one_before_it(tmp_path: Path, coxa: str, tibia: str, found: int) -> None:
    """Behind a coxa that is off, the pattern would turn the tibia farther away from the angle of its siblings."""
    parts = ['<link name="base"/>']
    for name, (xyz, _, _) in CORNERS.items():
        odd = name == "rear_left"
        parts.append(f'<link name="{name}_coxa"/><link name="{name}_tibia">{WHEEL}</link>')
        turns = (coxa, tibia) if odd else ("0 0 0", "0 0 0")
        parts.append(make_joint_on_base(f"{name}_hip", f"{name}_coxa", xyz, turns[0], "0 1 0", "revolute"))
        parts.append(
            make_joint_on_base(
                f"{name}_knee", f"{name}_tibia", "0 0 0", turns[1], "0 1 0", "revolute", parent=f"{name}_coxa"
            )
        )
    assert len(find(tmp_path, f'<robot name="legs">{"".join(parts)}</robot>', "SYM001")) == found


def test_a_base_that_is_turned_in_the_world_changes_nothing(tmp_path: Path) -> None:
    world = '<link name="world"/>' + make_joint_on_base(
        "to_world", "base", "1 2 3", "0.3 -0.8 2", "0 0 1", "fixed", parent="world"
    )
    for i, text in enumerate((car(front_left="0 0.3 0"), axle(right="0 -0.75239 0"), tripod("0 0.3 0"))):
        (usual,) = find(tmp_path / f"{i}a", text, "SYM001")
        (turned,) = find(tmp_path / f"{i}b", text.replace("</robot>", f"{world}</robot>"), "SYM001")
        assert (turned.message_id, turned.location.subject) == (usual.message_id, usual.location.subject)
        assert edits(turned) == edits(usual)
        assert turned.data["angle"] == pytest.approx(usual.data["angle"])


MACRO = """<robot name="car" xmlns:xacro="http://www.ros.org/wiki/xacro">
<link name="base"/>
<xacro:property name="cfg" value="${xacro.load_yaml('w.yaml')}"/>
<xacro:property name="tilt" value="${cfg['pitch']}"/>
<xacro:macro name="wheel" params="n x y p">
<link name="wheel_${n}">WHEEL</link>
<joint name="j_${n}" type="continuous"><parent link="base"/><child link="wheel_${n}"/>
<origin xyz="${x} ${y} 0" rpy="0 ${p} 0"/><axis xyz="0 1 0"/></joint>
</xacro:macro>
<xacro:wheel n="1" x=".2" y=".2" p="${tilt}"/>
<xacro:wheel n="2" x="-.2" y=".2" p="0"/>
<xacro:wheel n="3" x=".2" y="-.2" p="0"/>
<xacro:wheel n="4" x="-.2" y="-.2" p="0"/>
</robot>
""".replace("WHEEL", WHEEL)


def test_what_a_macro_computes_leads_to_the_argument_property_and_yaml_key(tmp_path: Path) -> None:
    (tmp_path / "w.yaml").write_text("pitch: -0.7\n", encoding="utf-8")
    (finding,) = find(tmp_path, MACRO, "SYM001", name="robot.urdf.xacro")
    assert finding.message_id == "computed"
    assert not edits(finding)
    assert [(r.subject, r.span and r.span.line) for r in finding.related] == [
        ("parameter[p]", 10),
        ("property[tilt]", 4),
        ("property[cfg]", 3),
        ("yaml[pitch]", 1),
    ]
    assert finding.fix is not None
    assert "make `0 ${p} 0` give `0 0 0` for joint j_1" in finding.fix.title
    assert "parameter p (line 10 of robot.urdf.xacro), property tilt (line 4" in finding.fix.title


# -- SYM005 ---------------------------------------------------------------------------------------------------------

DISK = '<visual><origin rpy="1.5707963 0 0"/><geometry><cylinder radius="0.05" length="0.02"/></geometry></visual>'


def wheeled(*axes: str, names: str = "wheel", rpy: str = "0 0 0", drawn: str = DISK, z: str = "0") -> str:
    parts = ['<link name="base"/>']
    for i, axis in enumerate(axes):
        parts.append(f'<link name="{names}_{i}">{drawn}</link>')
        parts.append(
            make_joint_on_base(f"{names}_{i}_joint", f"{names}_{i}", f"{i * 0.2} {0.1 - i % 2 * 0.2} {z}", rpy, axis)
        )
    return f'<robot name="car">{"".join(parts)}</robot>'


def test_wheels_that_roll_alike_are_fine(tmp_path: Path) -> None:
    assert not find(tmp_path, wheeled("0 1 0", "0 1 0"), "SYM005")
    assert not find(tmp_path, wheeled("0 -1 0", "0 -1 0"), "SYM005")


def test_front_and_rear_wheels_that_roll_against_each_other_do_not_turn_the_robot(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, wheeled("0 -1 0", "0 -1 0", "0 1 0", "0 1 0"), "SYM005")
    assert finding.message_id == "fighting"
    assert all("spins" not in effect for effect in finding.consequences.values())
    (finding,) = find(tmp_path, wheeled("0 -1 0", "0 1 0", "0 -1 0", "0 1 0"), "SYM005")
    assert finding.message_id == "opposed"


def test_of_two_wheels_either_may_be_meant(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, wheeled("0 -1 0", "0 1 0"), "SYM005")
    assert finding.message_id == "opposed"
    assert finding.location.subject == "joint[wheel_0_joint]/axis@xyz"
    # A controller may negate one side.
    assert edits(finding) == []


def test_of_four_wheels_the_odd_one_is_turned_over(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, wheeled("0 -1 0", "0 -1 0", "0 1 0", "0 -1 0"), "SYM005")
    assert finding.message_id == "minority"
    assert finding.location.subject == "joint[wheel_2_joint]/axis@xyz"
    # Or the two sides are meant to roll oppositely, and the other wheel of its side is wrong.
    assert edits(finding) == []
    assert finding.fix is not None
    assert ", or that of wheel_0_joint if the two sides" in finding.fix.title


def test_of_four_wheels_that_one_plugin_drives_the_odd_one_is_turned_over(tmp_path: Path) -> None:
    text = wheeled("0 -1 0", "0 -1 0", "0 1 0", "0 -1 0")
    plugin = drive(*(f"wheel_{number}_joint" for number in range(4)))
    (finding,) = find(tmp_path, text.replace("</robot>", plugin), "SYM005")
    assert edits(finding) == [("0 1 0", "0 -1 0")]


def drive(*joints: str) -> str:
    named = "".join(f"<left_joint>{joint}</left_joint>" for joint in joints)
    return f'<gazebo><plugin name="d" filename="libgazebo_ros_diff_drive.so">{named}</plugin></gazebo></robot>'


@pytest.mark.parametrize(
    ("driven", "severity"),
    [
        ((), Severity.WARNING),
        (("wheel_0_joint", "wheel_1_joint"), Severity.INFO),
        (("wheel_2_joint",), Severity.WARNING),
    ],
)
def test_a_wheel_that_nothing_drives_with_the_others_turns_freely(
    tmp_path: Path, driven: tuple[str, ...], severity: Severity
) -> None:
    text = wheeled("0 1 0", "0 1 0", "0 -1 0").replace("</robot>", drive(*driven))
    (finding,) = find(tmp_path, text, "SYM005")
    assert (finding.message_id, finding.severity) == ("minority", severity)


def test_casters_steered_and_standing_wheels_are_left_out(tmp_path: Path) -> None:
    assert not find(tmp_path / "a", wheeled("0 -1 0", "0 1 0", names="caster_wheel"), "SYM005")
    assert not find(tmp_path / "b", wheeled("0 0 -1", "0 0 1"), "SYM005")
    steered = wheeled("0 -1 0", "0 1 0").replace('<link name="base"/>', '<link name="root"/><link name="base"/>')
    steered = steered.replace(
        "</robot>", make_joint_on_base("steer", "base", "0 0 0", "0 0 0", "0 0 1", parent="root") + "</robot>"
    )
    assert not find(tmp_path / "c", steered, "SYM005")


def test_wheels_in_several_directions_are_holonomic(tmp_path: Path) -> None:
    ball = '<visual><geometry><sphere radius="0.05"/></geometry></visual>'
    assert not find(tmp_path, wheeled("0 1 0", "1 0 0", "0 -1 0", "-1 0 0", drawn=ball), "SYM005")


def test_a_box_is_no_wheel(tmp_path: Path) -> None:
    box = '<visual><geometry><box size="0.1 0.02 0.1"/></geometry></visual>'
    assert not find(tmp_path, wheeled("0 -1 0", "0 1 0", drawn=box), "SYM005")


def test_two_of_the_authors_angles_stay_where_many_are_one_rotation() -> None:
    typed = (-1.46564e-14, 1.5707963, -1.5483)
    true = rpy_to_matrix((2.793016, 1.5707, 1.222218))
    found = find_nearest_rpy(true, typed)
    assert sum(a != b for a, b in zip(found, typed, strict=True)) == 1
    assert np.abs(rpy_to_matrix(found) - true).max() < 2e-3
    # Elsewhere only one set of angles is the rotation.
    assert find_nearest_rpy(rpy_to_matrix((0.0, 0.0, np.pi / 2)), (0.3, 0.2, 0.1)) == [0.0, 0.0, np.pi / 2]


def test_a_repair_does_not_keep_the_angle_that_is_not_round() -> None:
    """At a pitch of 90° a yaw of -0.0049 would make up for it."""
    wanted = rpy_to_matrix((np.pi - 0.0003, 1.5708, 0.0003))
    assert find_nearest_rpy(wanted, (3.1367, 1.5708, 0.0)) == [pytest.approx(np.pi), 1.5708, 0.0]


def test_half_a_turn_has_the_sign_that_was_typed_and_a_small_angle_stays() -> None:
    assert find_nearest_rpy(rpy_to_matrix((0.0, 0.0, -np.pi)), (0.0, 0.0, 2.9)) == [0.0, 0.0, np.pi]
    assert find_nearest_rpy(rpy_to_matrix((0.0, 0.00088, 0.0)), (0.0, 0.00088, 0.17)) == [0.0, 0.00088, 0.0]


def test_an_angle_in_degrees_is_not_a_tilt_as_well(tmp_path: Path) -> None:
    text = car(front_left="-90 0 0")
    assert find(tmp_path / "degrees", text, "JNT012")
    assert not find(tmp_path / "tilt", text, "SYM001")


def test_of_equal_tilts_the_nearest_frame_is_proposed(tmp_path: Path) -> None:
    """Half a turn about the axis has the same tilt."""
    text = axle(right="0 0.0717150119 0").replace('axis xyz="0 1 0"', 'axis xyz="1 0 0"')
    (finding,) = find(tmp_path, text, "SYM001")
    assert edits(finding) == [("0 0.0717150119 0", "0 0 0")]


def test_a_tilted_frame_keeps_its_choice_of_axes(tmp_path: Path) -> None:
    """The other arm is here by half a turn or by a mirror: both give the joint axis one line."""
    mass = (
        '<inertial><origin xyz="0.1 0 0"/><mass value="0.4"/>'
        '<inertia ixx="1e-4" ixy="0" ixz="0" iyy="1.3e-3" iyz="0" izz="1.2e-3"/></inertial>'
    )
    parts = ['<link name="torso"/>']
    for side, sign, rpy in (("left", "", "0 0 -0.335214882"), ("right", "-", "0 0 0")):
        parts.append(f'<link name="{side}_arm">{mass}</link>')
        place, axis = f"0.1 {sign}0.2 0.3", f"0.9989 {sign}0.014 0.045"
        parts.append(make_joint_on_base(f"{side}_elbow", f"{side}_arm", place, rpy, axis, "revolute", "torso"))
    (finding,) = find(tmp_path, f'<robot name="r">{"".join(parts)}</robot>', "SYM001")
    assert edits(finding) == [("0 0 -0.335214882", "0 0 0")]
