"""Mass and inertia: where the rules begin and end."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest
from builders import arm_on_base, box, collision, find, inertial, joint, link, robot, sphere, visual
from conftest import check, check_text

from urdfcheck.core import Finding, Severity, Verdict
from urdfcheck.model import Model
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder

SOUND = inertial()
ZERO = '<inertial><mass value="{}"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>'
SOLID = collision(box("1 1 1"))
BOX = visual(box("1 1 1"))


def make_arm(child: str, kind: str = "continuous", more: str = "", base: str = SOUND) -> str:
    """Return an arm on a base that has a sound inertial."""
    return arm_on_base(child, base=base, kind=kind, axis="0 0 1", more=more)


def fixed(name: str, content: str, parent: str = "arm") -> str:
    return link(name, content) + joint(f"{name}_joint", parent, name)


# -- INR001 ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("files", "message"),
    [
        ({}, "display"),
        ({"launch/show.launch": "<launch><!-- gazebo_ros --></launch>"}, "display"),
        ({"launch/sim.launch": '<launch><include file="$(find gazebo_ros)/launch/x.launch"/></launch>'}, "display"),
        ({"scripts/sim.py": "import pybullet\nbullet.loadURDF('arm.urdf')"}, "kinematic"),
        ({"scripts/sim.py": "import pybullet"}, "display"),
        ({"scripts/sim.py": "import pybullet\nprint('arm.urdf')\nbullet.loadURDF('arm_sim.urdf')"}, "display"),
        ({"scripts/sim.py": "import mujoco\nload('arm.urdf')"}, "kinematic"),
        ({"scripts/sim.py": "import mujoco\nshow('arm.urdf')\nload('scene.xml')"}, "display"),
        ({"package.xml": "<package><name>arm</name><depend>ros_gz</depend></package>"}, "display"),
        ({"../sim/package.xml": "<package><name>sim</name><depend>ros_gz</depend></package>"}, "display"),
        ({"launch/sim.launch": "<launch>gazebo_ros <node args='sim_arm.urdf'/></launch>"}, "display"),
        ({"launch/sim.launch": "<launch>gazebo_ros <node args='arm.urdf'/></launch>"}, "kinematic"),
        ({"launch/sim.launch": "<launch>gazebo_ros <node args='$(find arm)/arm.urdf'/></launch>"}, "kinematic"),
        ({"launch/sim.launch": "<launch>gazebo_ros <node args='$(find arm)/new/arm.urdf'/></launch>"}, "display"),
        (
            {
                "launch/a.launch": "<launch>gazebo_ros <node args='arm.urdf'/></launch>",
                "launch/b.launch": "<launch>gazebo_ros <node pkg='gazebo_ros' args='-file $(find arm)/arm.sdf'/></launch>",
            },
            "display",
        ),
        (
            {
                "launch/a.launch": "<launch>gazebo_ros <node pkg='robot_state_publisher' args='arm.urdf'/></launch>",
                "worlds/a.world": "<sdf><world><include><uri>model://arm</uri></include></world></sdf>",
            },
            "display",
        ),
    ],
)
def test_a_robot_without_inertials_matters_where_it_is_simulated(
    tmp_path: Path, files: dict[str, str], message: str
) -> None:
    package = tmp_path / "src" / "arm"
    files = {"package.xml": "<package><name>arm</name></package>", "arm.urdf": make_arm("")} | files
    for name, text in files.items():
        (package / name).parent.mkdir(parents=True, exist_ok=True)
        (package / name).write_text(text.replace(SOUND, ""))
    run = check(package / "arm.urdf", codes={"INR001"})
    assert [finding.message_id for finding in run.findings] == [message]


@pytest.mark.parametrize(
    ("launch", "severity"),
    [
        ("gazebo_ros arm.urdf", Severity.INFO),
        ("gazebo_ros spawn_model -urdf -param robot_description arm.urdf", Severity.WARNING),
        ("gazebo_ros spawn_model -urdf -param robot_description arm.urdf arm_sim.urdf", Severity.INFO),
    ],
)
def test_a_robot_without_inertials_that_is_spawned_is_a_warning(
    tmp_path: Path, launch: str, severity: Severity
) -> None:
    (tmp_path / "package.xml").write_text("<package><name>arm</name></package>")
    (tmp_path / "sim.launch").write_text(f"<launch>{launch}</launch>")
    (tmp_path / "arm.urdf").write_text(make_arm("").replace(SOUND, ""))
    (finding,) = check(tmp_path / "arm.urdf", codes={"INR001"}).findings
    assert finding.severity == severity


@pytest.mark.parametrize(("joint_name", "found"), [("j", False), ("knee", True)])
def test_a_robot_that_mujoco_simulates_from_a_model_of_its_own_needs_no_inertials(
    tmp_path: Path, joint_name: str, found: bool
) -> None:
    files = {
        "package.xml": "<package><name>arm</name></package>",
        "scripts/sim.py": "import mujoco  # beside arm.urdf\nprint('arm.urdf')",
        "mjcf/arm.xml": f'<mujoco model="arm"><worldbody><body><joint name="{joint_name}"/></body></worldbody></mujoco>',
        "robot.urdf": make_arm("").replace(SOUND, ""),
    }
    assert bool(find(tmp_path, files, "INR001")) == found


def test_a_link_on_a_fixed_joint_needs_no_inertial(tmp_path: Path) -> None:
    assert not find(tmp_path, make_arm("", kind="fixed"), "INR001")
    looped = '<gazebo><joint name="j" type="revolute"><parent>base</parent><child>tip</child></joint></gazebo>'
    assert [bool(find(tmp_path, make_arm("", more=block), "INR001")) for block in ("", looped)] == [True, False]


def test_a_moving_link_needs_none_when_what_is_fixed_to_it_has_one(tmp_path: Path) -> None:
    assert not find(tmp_path, make_arm(BOX, more=fixed("cover", SOUND)), "INR001")


def test_what_hangs_behind_a_link_without_inertial_is_counted(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_arm(SOLID, more=fixed("tool", "") + fixed("tip", "", parent="tool")), "INR001")
    assert finding.message_id == "missing"
    assert finding.consequences["gazebo"].startswith("drops the link and the 2 links behind it")


def test_mujoco_takes_the_inertia_of_what_collides_and_leaves_out_what_is_drawn(tmp_path: Path) -> None:
    (solid,) = find(tmp_path / "a", make_arm(SOLID), "INR001")
    (drawn,) = find(tmp_path / "b", make_arm(BOX), "INR001")
    (bare,) = find(tmp_path / "c", make_arm(""), "INR001")
    assert solid.consequences["mujoco"].startswith("replaces the missing inertial")
    assert drawn.consequences["mujoco"] == bare.consequences["mujoco"]
    assert bare.consequences["mujoco"].startswith("refuses")
    hand = '<joint name="k" type="continuous"><parent link="arm"/><child link="hand"/></joint>'
    both = find(tmp_path / "d", make_arm(SOLID, more=f'<link name="hand">{BOX}</link>{hand}'), "INR001")
    assert ["collision geometry" in finding.consequences["isaac"] for finding in both] == [True, False]


def test_a_joint_that_moves_no_mass_at_all_falls_without_a_number(tmp_path: Path) -> None:
    (leaf,) = find(tmp_path / "a", make_arm(BOX), "INR001")
    hand = '<joint name="k" type="continuous"><parent link="arm"/><child link="hand"/></joint>'
    (carrier,) = find(tmp_path / "b", make_arm(BOX, more=f'<link name="hand">{SOUND}</link>{hand}'), "INR001")
    assert leaf.consequences["pinocchio"].startswith("computes NaN")
    assert carrier.consequences["pinocchio"].startswith("loads it")


def test_a_description_without_any_inertial_is_one_info(tmp_path: Path) -> None:
    (finding,) = find(tmp_path / "a", make_arm(BOX, base=BOX), "INR001")
    assert (finding.message_id, finding.severity) == ("display", Severity.INFO)
    (simulated,) = check_text(tmp_path / "b", make_arm(BOX, base=BOX), codes={"INR001"}, targets=("gazebo",)).findings
    assert (simulated.message_id, simulated.severity) == ("kinematic", Severity.ERROR)


@pytest.mark.parametrize(
    ("arm", "more", "targets", "message"),
    [
        (BOX, "", (), "drawing"),
        (BOX, "", ("rviz",), "drawing"),
        (BOX, "", ("gazebo",), "missing"),
        (BOX, "<gazebo/>", (), "missing"),
        (SOLID, "", (), "missing"),
        ("", "", (), "drawing"),
    ],
)
def test_the_inertial_of_a_root_is_a_dummy_where_nothing_that_moves_has_one_or_collides(
    tmp_path: Path, arm: str, more: str, targets: tuple[str, ...], message: str
) -> None:
    (finding,) = find(tmp_path, make_arm(arm, more=more), "INR001", targets=targets)
    assert (finding.message_id, finding.severity == Severity.INFO) == (message, message == "drawing")


@pytest.mark.parametrize(("arm", "more", "found"), [(BOX, "", False), (BOX, "<gazebo/>", True), ("", "", True)])
@pytest.mark.parametrize("code", ["INR005", "INR007"])
def test_the_inertia_of_a_drawn_root_is_nobodys(tmp_path: Path, arm: str, more: str, found: bool, code: str) -> None:
    """But what moves may be markers, on a body that flies."""
    base = inertial(0.1, 0.01) + BOX.replace("1 1 1", "0.1 0.1 0.1")
    assert bool(find(tmp_path, make_arm(arm, base=base, more=more), code)) == found


def test_a_description_that_cannot_move_needs_no_inertial(tmp_path: Path) -> None:
    assert not find(tmp_path, make_arm("", kind="fixed", base=""), "INR001")


def test_a_link_may_be_meant_to_be_fixed_where_its_joint_has_no_type(tmp_path: Path) -> None:
    assert find(tmp_path / "a", make_arm(BOX), "INR001")
    assert not find(tmp_path / "b", make_arm(BOX, kind=""), "INR001")
    assert not find(tmp_path / "c", make_arm(BOX, kind="screw"), "INR001")


def test_what_a_target_drops_is_an_error(tmp_path: Path) -> None:
    (solid,) = check_text(tmp_path / "a", make_arm(SOLID), codes={"INR001"}, targets=("mujoco",)).findings
    (dropped,) = check_text(tmp_path / "b", make_arm(BOX), codes={"INR001"}, targets=("gazebo",)).findings
    (refused,) = check_text(tmp_path / "c", make_arm(""), codes={"INR001"}, targets=("mujoco",)).findings
    assert [f.severity for f in (solid, dropped, refused)] == [Severity.WARNING, Severity.ERROR, Severity.ERROR]


def test_bullet_assumes_a_mass_for_frames_too(tmp_path: Path) -> None:
    text = make_arm(SOUND, more=fixed("tool", "") + fixed("tip", "", parent="tool") + fixed("marked", ZERO.format(0)))
    assert not find(tmp_path, text, "INR001")
    (finding,) = check_text(tmp_path, text, codes={"INR001", "INR002"}, targets=("bullet",)).findings
    assert finding.message_id == "assumed"
    assert finding.data["links"] == "tool, tip"


@pytest.mark.parametrize(("pad", "found"), [(SOLID, True), (BOX, False), (ZERO.format(0) + SOLID, False)])
def test_mujoco_adds_the_mass_of_what_collides_without_inertial(tmp_path: Path, pad: str, found: bool) -> None:
    findings = find(tmp_path, make_arm(SOUND, more=fixed("pad", pad) + fixed("tip", pad)), "INR001")
    assert [(f.message_id, f.severity) for f in findings] == [("inferred", Severity.INFO)] * found
    assert not found or findings[0].data["links"] == "pad, tip"


def test_what_collides_on_the_base_adds_nothing(tmp_path: Path) -> None:
    assert not find(tmp_path, make_arm(SOUND, more=fixed("plate", SOLID, parent="base")), "INR001")


# -- INR002 ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "message", "severity"),
    [
        (make_arm(inertial("-1")), "negative", Severity.ERROR),
        (make_arm(inertial("0")), "inertia_without_mass", Severity.ERROR),
        (make_arm(ZERO.format(0) + BOX), "zero", Severity.ERROR),
        (make_arm(ZERO.format(0)), "loose", Severity.WARNING),
        (make_arm(ZERO.format(0), kind="fixed"), "helper", Severity.INFO),
        (make_arm(SOUND, base=ZERO.format(0) + BOX), "root", Severity.INFO),
        (make_arm(SOUND, base=inertial("0") + BOX), "base", Severity.WARNING),
        (robot(link("cup", inertial("0"), BOX)), "base", Severity.INFO),
    ],
)
def test_what_a_mass_of_zero_or_less_means(tmp_path: Path, text: str, message: str, severity: Severity) -> None:
    (finding,) = find(tmp_path, text, "INR002")
    assert (finding.message_id, finding.severity) == (message, severity)


@pytest.mark.parametrize(
    ("text", "mujoco", "gazebo"),
    [
        (make_arm(SOUND, base=inertial("0")), "loads", "refuses"),
        (make_arm(SOUND, base=inertial("0"), more=fixed("plate", SOUND, parent="base")), "loads", "loads"),
        (make_arm(inertial("0")), "refuses", "drops"),
        (make_arm(SOUND, more=fixed("tool", inertial("0"))), "ignores", "loads"),
        (make_arm(SOUND, base=inertial("-1")), "loads", "refuses"),
        (make_arm(inertial("-1")), "refuses", "refuses"),
        (make_arm(SOUND, more=fixed("tool", inertial("-2"))), "ignores", "refuses"),
        (make_arm(SOUND, base=ZERO.format(0) + BOX), "loads", None),  # KIN010 says what Gazebo does
    ],
)
def test_what_programs_do_without_mass_depends_on_where_the_link_is(
    tmp_path: Path, text: str, mujoco: str, gazebo: str | None
) -> None:
    (finding,) = find(tmp_path, text, "INR002")
    verdicts = {name: str(Verdict.from_sentence(sentence)) for name, sentence in finding.consequences.items()}
    assert (verdicts["mujoco"], verdicts.get("gazebo")) == (mujoco, gazebo)


def test_the_smallest_positive_mass_is_a_mass(tmp_path: Path) -> None:
    assert not find(tmp_path, make_arm(inertial("1e-300")), "INR002")


def test_a_negative_mass_is_found_although_the_tree_is_broken(tmp_path: Path) -> None:
    text = f'<robot name="r"><link name="a">{inertial("-1")}</link><link name="b">{ZERO.format(0)}</link></robot>'
    assert [f.message_id for f in find(tmp_path, text, "INR002")] == ["negative"]


# -- INR003 ---------------------------------------------------------------------------------------------------------


def test_a_flat_plate_keeps_the_triangle_inequality(tmp_path: Path) -> None:
    assert not find(tmp_path, make_arm(inertial(izz="2")), "INR003")


def test_a_violation_that_the_digits_explain_is_rounding(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_arm(inertial(ixx="0.001234", iyy="0.002345", izz="0.00358")), "INR003")
    assert (finding.message_id, finding.severity) == ("rounded", Severity.WARNING)


@pytest.mark.parametrize(
    ("size", "kind", "message"),
    [
        ("0.08 0.06 0.09", "continuous", "thin"),
        ("0.08 0.06 0.09", "fixed", "thin"),
        ("0.2 5e-5 5e-5", "fixed", "rounded"),
    ],
)
def test_more_digits_do_not_make_a_box_of_a_line_of_points(tmp_path: Path, size: str, kind: str, message: str) -> None:
    """Nothing but the parallel-axis term of a point beside the COM; a wire has such moments."""
    line = inertial(0.3234, ixx="1.9683E-05", ixz="-0.00012644", iyy="0.00083192", izz="0.00081224")
    text = make_arm(line + visual(box(size)), kind=kind, base=inertial(10, ixx=1, iyy=1, izz=1))
    (finding,) = find(tmp_path, text, "INR003")
    assert (finding.message_id, finding.severity) == (message, Severity.WARNING)
    assert ("digits" in finding.fix.title if finding.fix else "") == (message == "rounded")
    assert finding.consequences["gazebo"].startswith("loads it" if kind == "fixed" else "refuses")


@pytest.mark.parametrize(("izz", "message"), [("1.11e-10", "thin"), ("1.4e-10", "rounded")])
def test_a_moment_of_next_to_nothing_was_not_rounded(tmp_path: Path, izz: str, message: str) -> None:
    text = make_arm(inertial("0.07", ixx="1.256e-4", iyy="1.256e-4", iyz="1.1787e-7", izz=izz))
    (finding,) = find(tmp_path, text, "INR003")
    assert (finding.message_id, finding.severity) == (message, Severity.WARNING)
    assert ("ten-millionth" in finding.message) == (message == "thin")


def test_copies_of_a_fixed_part_are_loaded_by_what_merges_them(tmp_path: Path) -> None:
    rounded = inertial("0.0314", ixx="6.5e-05", ixy="5.1e-05", ixz="-1e-06", iyy="5e-05", iyz="1e-06", izz="0.000103")
    text = make_arm(SOUND, more=fixed("left", rounded) + fixed("right", rounded))
    (finding,) = find(tmp_path, text, "INR003")
    assert (finding.message_id, len(finding.subjects)) == ("rounded", 2)
    assert finding.consequences["gazebo"].startswith("loads it")


def test_a_violation_that_the_digits_do_not_explain_is_not(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_arm(inertial(ixx="0.001234000", iyy="0.002345000", izz="0.003580000")), "INR003")
    assert (finding.message_id, finding.severity) == ("violated", Severity.ERROR)


def test_the_residue_of_a_zero_tensor_breaks_no_inequality(tmp_path: Path) -> None:
    assert not find(tmp_path, make_arm(inertial("0.1", ixx="1e-21", iyy="3e-20", izz="9e-20")), "INR003")


def test_digits_that_are_too_few_are_the_cause_of_a_large_violation_too(tmp_path: Path) -> None:
    # 1.4 + 1.4 >= 2.5 rounds to 1, 1 and 3.
    (finding,) = find(tmp_path, make_arm(inertial(ixx="1e-5", iyy="1e-5", izz="3e-5")), "INR003")
    assert (finding.message_id, finding.severity) == ("violated", Severity.ERROR)
    assert finding.cause is not None
    assert finding.cause.id == "digits"


def impossible(mass: str, small: str, large: str) -> str:
    return inertial(mass, ixx=small, iyy=small, izz=large)


@pytest.mark.parametrize(
    ("child", "message", "severity"),
    [
        (impossible("0.1", "0.01", "0.1"), "fused", Severity.ERROR),
        (impossible("0.1", "1", "9"), "violated", Severity.ERROR),
        (impossible("0.0005", "1e-5", "1e-4"), "helper", Severity.WARNING),
        (impossible("0.0005", "0.01", "0.1"), "fused", Severity.ERROR),
        (impossible("0.1", "1e-5", "1e-4"), "fused", Severity.ERROR),
        (impossible("0.1", "0", "1e-5"), "fused", Severity.WARNING),  # 2e-6, 3e-6 and 5e-6 in one decimal less
        (impossible("0.1", "0", "1e-2"), "fused", Severity.ERROR),
    ],
)
def test_an_impossible_link_is_judged_with_what_it_is_fixed_to(
    tmp_path: Path, child: str, message: str, severity: Severity
) -> None:
    (finding,) = find(tmp_path, make_arm(SOUND, more=fixed("cover", child)), "INR003")
    assert (finding.message_id, finding.severity) == (message, severity)


@pytest.mark.parametrize(
    ("part", "readme", "targets", "severity"),
    [
        ("", "", (), Severity.ERROR),
        ("<gazebo/>", "", (), Severity.WARNING),
        ("<gazebo/>", "compile arm.urdf with MuJoCo", (), Severity.ERROR),
        ("<gazebo/><mujoco/>", "", (), Severity.ERROR),
        ("<gazebo/>", "", ("drake",), Severity.ERROR),
        (
            "<gazebo reference='cover_joint'><preserveFixedJoint>true</preserveFixedJoint></gazebo>",
            "",
            (),
            Severity.ERROR,
        ),
    ],
)
def test_an_impossible_link_that_gazebo_alone_reads_and_merges_is_a_warning(
    tmp_path: Path, part: str, readme: str, targets: tuple[str, ...], severity: Severity
) -> None:
    (tmp_path / "README.md").write_text(readme)
    text = make_arm(SOUND, more=fixed("cover", impossible("0.1", "0.01", "0.1")) + part)
    (finding,) = check_text(tmp_path, text, codes={"INR003"}, targets=targets).findings
    assert finding.severity is severity


@pytest.mark.parametrize("code", ["INR003", "INR004"])
@pytest.mark.parametrize("mass", ["0.1", "0.0005"])
@pytest.mark.parametrize("flag", ["preserveFixedJoint", "disableFixedJointLumping"])
def test_gazebo_checks_a_link_alone_whose_fixed_joint_it_keeps(tmp_path: Path, code: str, mass: str, flag: str) -> None:
    wrong = (
        impossible(mass, "1e-5", "1e-4") if code == "INR003" else inertial(mass, ixx="-1e-5", iyy="1e-5", izz="1e-5")
    )
    bracket = fixed("cover", wrong)
    name = re.findall('<joint name="([^"]*)"', bracket)[0]
    for kept, effect in ((name, "refuses the model"), ("other", "loads it")):
        block = f'<gazebo reference="{kept}"><{flag}>true</{flag}></gazebo>'
        (finding,) = find(tmp_path / kept, make_arm(SOUND, more=bracket + block), code)
        assert finding.consequences["gazebo"].startswith(effect)
        # A lighter one changes nothing where it is merged, and an impossible one is for MuJoCo and Drake to refuse.
        is_error = kept == name or (mass == "0.1" and code == "INR004")
        assert finding.severity is (Severity.ERROR if is_error else Severity.WARNING)


def test_a_light_link_with_six_equal_numbers_is_explained(tmp_path: Path) -> None:
    six = " ".join(f'{name}="1e-6"' for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    frame = f'<inertial><mass value="1e-6"/><inertia {six}/></inertial>'
    (finding,) = find(tmp_path, make_arm(SOUND, more=fixed("cover", frame)), "INR003")
    assert finding.message_id == "helper"
    assert finding.cause is not None
    assert finding.cause.id == "products_filled"
    assert "all six numbers are 1e-6" in finding.cause.text


def test_a_light_impossible_link_that_a_joint_moves_is_no_helper(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_arm(impossible("0.0005", "1e-5", "1e-4")), "INR003")
    assert (finding.message_id, finding.severity) == ("violated", Severity.ERROR)


def test_an_impossible_link_is_found_although_the_tree_is_broken(tmp_path: Path) -> None:
    text = f'<robot name="r"><link name="a">{impossible("1", "0.01", "0.1")}</link><link name="b"/></robot>'
    assert [f.message_id for f in find(tmp_path, text, "INR003")] == ["violated"]


def edit_tensor(finding: Finding, text: str) -> list[str]:
    """The six numbers after the finding's edits."""
    assert finding.fix is not None
    for e in sorted(finding.fix.edits, key=lambda e: -e.span.start):
        assert text[e.span.start : e.span.end] == e.expected
        text = text[: e.span.start] + e.replacement + text[e.span.end :]
    return re.findall(r'i[xyz]{2}="([^"]*)"', text)


def test_a_tensor_that_misses_by_little_becomes_the_nearest_about_its_own_com(tmp_path: Path) -> None:
    # The part that is drawn has another COM and another tensor, and both are the author's business.
    text = make_arm(inertial(2, com="0.01 0.02 0.03", ixx="0.200000", iyy="0.400000", izz="0.606000") + BOX)
    (finding,) = find(tmp_path, text, "INR003")
    assert "nearest" in (finding.fix.title if finding.fix else "")
    assert edit_tensor(finding, text)[6:] == ["0.203004", "0", "0", "0.403004", "0", "0.606000"]
    assert "0.01 0.02 0.03" in text


def test_a_small_change_is_no_repair_of_a_tensor_that_is_far_from_the_drawn_part_s(tmp_path: Path) -> None:
    text = make_arm(inertial(2, ixx="1.000000", iyy="2.000000", izz="3.030000") + BOX)
    (finding,) = find(tmp_path, text, "INR003")
    assert finding.fix is not None
    assert "nearest" not in finding.fix.title
    assert 'ixx="0.3333" iyy="0.3333" izz="0.3333" (the drawn part' in finding.fix.title


@pytest.mark.parametrize("value", ["0.001", "1e-6"])
def test_products_that_were_filled_in_like_moments_become_zero(tmp_path: Path, value: str) -> None:
    text = make_arm(six_numbers("0.2", value) + BOX)
    (finding,) = find(tmp_path, text, "INR003")
    assert finding.cause is not None
    assert (finding.cause.id, finding.data["detail"]) == ("products_filled", f"all six numbers are {value}")
    assert edit_tensor(finding, text)[6:] == [value, "0", "0", value, "0", value]


def test_a_number_that_stands_in_two_slots_is_named_and_left(tmp_path: Path) -> None:
    numbers = {"ixx": "0.000637051", "ixy": "0.000484569", "ixz": "0.000424211"}
    text = make_arm(inertial(1, **numbers, iyy="0.000929402", iyz="5.138e-06", izz="0.000484569") + BOX)
    (finding,) = find(tmp_path, text, "INR003")
    assert finding.cause is not None
    assert finding.cause.id == "slot_repeated"
    assert finding.fix is not None
    assert not finding.fix.edits


def test_signs_are_a_guess_where_nothing_is_drawn(tmp_path: Path) -> None:
    numbers = {"ixx": "0.0053694", "ixy": "0.0014185", "ixz": "-0.00092094"}
    text = make_arm(inertial(1, **numbers, iyy="0.0032423", iyz="-0.00169178", izz="0.00501731"))
    (finding,) = find(tmp_path, text, "INR003")
    assert finding.cause is not None
    assert finding.cause.id == "products_sign"
    assert finding.fix is not None
    assert not finding.fix.edits
    assert 'ixy="-0.0014185" ixz="0.00092094" iyz="0.00169178"' in finding.fix.title


def test_moments_of_zero_were_rounded_like_the_others(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_arm(inertial(0.01, ixx="0", iyy="0", izz="1E-06")), "INR003")
    assert finding.cause is not None
    assert finding.cause.id == "digits"


def six_numbers(mass: str, value: str) -> str:
    return inertial(mass, ixx=value, ixy=value, ixz=value, iyy=value, iyz=value, izz=value)


@pytest.mark.parametrize("kind", ["fixed", "floating"])
def test_six_equal_numbers_on_a_light_root_are_found(tmp_path: Path, kind: str) -> None:
    # The two smaller moments are zero but for rounding, to either side.
    text = make_arm(SOUND, base=six_numbers("1e-6", "1e-6"), kind=kind)
    (finding,) = check_text(tmp_path, text, codes={"INR003", "INR004", "INR017"}, targets=("mujoco",)).findings
    assert (finding.code, finding.severity) == ("INR003", Severity.ERROR)


# -- INR004 ---------------------------------------------------------------------------------------------------------


def test_the_minus_sign_of_a_moment_is_removed_when_that_mends_the_tensor(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_arm(inertial(iyy="-1")), "INR004")
    assert finding.cause is not None
    assert finding.cause.id == "sign"
    assert finding.fix is not None
    assert [(e.expected, e.replacement) for e in finding.fix.edits] == [("-1", "1")]


def test_no_edit_when_the_tensor_stays_impossible_without_the_sign(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_arm(inertial(iyy="-9")), "INR004")
    assert finding.fix is not None
    assert not finding.fix.edits


@pytest.mark.parametrize(("ixx", "mujoco"), [("0", "refuses"), ("1e-15", "refuses"), ("1e-13", "loads")])
def test_mujoco_loads_a_line_that_is_a_little_thick(tmp_path: Path, ixx: str, mujoco: str) -> None:
    (finding,) = find(tmp_path, make_arm(inertial(ixx=ixx)), "INR004")
    assert finding.message_id == "line"
    assert finding.consequences["mujoco"].startswith(mujoco)


@pytest.mark.parametrize(("value", "mujoco"), [("0", "loads"), ("1e-20", "refuses")])
def test_mujoco_refuses_the_residue_of_a_zero_tensor(tmp_path: Path, value: str, mujoco: str) -> None:
    text = make_arm(SOUND, more=fixed("tip", inertial("1", ixx=value, iyy=value, izz=value)))
    (finding,) = find(tmp_path, text, "INR004")
    assert finding.message_id == "point_fixed"
    assert finding.consequences["mujoco"].startswith(mujoco)


def test_numbers_in_the_order_of_another_tool_are_recognised(tmp_path: Path) -> None:
    # Ixx Iyy Izz Ixy Ixz Iyz of a bar, in the slots ixx ixy ixz iyy iyz izz.
    (finding,) = find(
        tmp_path, make_arm(inertial(ixx="1", ixy="2", ixz="2.5", iyy="0.1", iyz="0.1", izz="0.1")), "INR004"
    )
    assert finding.cause is not None
    assert finding.cause.id == "diagonal_first"


def test_a_product_at_its_bound_is_a_line_and_beyond_it_impossible(tmp_path: Path) -> None:
    # A rod along x = y: Ixy = -sqrt(Ixx Iyy) exactly.
    (line,) = find(tmp_path / "a", make_arm(inertial(ixy="-1", izz="2")), "INR004")
    (beyond,) = find(
        tmp_path / "b", make_arm(inertial(ixx="1.0000", iyy="1.0000", ixy="-1.0010", izz="2.0000")), "INR004"
    )
    assert (line.message_id, line.severity) == ("line", Severity.WARNING)
    assert (beyond.message_id, beyond.severity) == ("product", Severity.ERROR)


def test_a_point_mass_fixed_to_a_body_is_an_info(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_arm(SOUND, more=fixed("ball", ZERO.format(1))), "INR004")
    assert (finding.message_id, finding.severity) == ("point_fixed", Severity.INFO)


@pytest.mark.parametrize(
    ("more", "message", "words"),
    [
        ("", "point", "so the moving body is a point mass"),
        ("0", "point", "so the moving body is a point mass"),
        ("0.05", "points", "with ball the moving body has no extent about an axis"),
    ],
)
def test_points_that_are_apart_are_no_point(tmp_path: Path, more: str, message: str, words: str) -> None:
    ball = link("ball", ZERO.format(1)) + joint("ball_joint", "arm", "ball", xyz=f"0 {more} 0.02") if more else ""
    arm = ZERO.format(1).replace("<mass", '<origin xyz="0 0 0.02"/><mass')
    found = find(tmp_path, make_arm(arm, more=ball), "INR004")
    assert {finding.message_id for finding in found} == {message}
    assert words in found[0].message


def test_a_frame_without_mass_is_no_point(tmp_path: Path) -> None:
    assert not find(tmp_path, make_arm(SOUND, more=fixed("frame", ZERO.format(0))), "INR004")


def test_an_askew_rod_that_was_rounded_needs_more_digits(tmp_path: Path) -> None:
    # A rod along (1, 1, 1): every product is half of every moment, and the smallest moment 0.
    rod = dict.fromkeys(("ixx", "iyy", "izz"), "0.0667") | dict.fromkeys(("ixy", "ixz", "iyz"), "-0.0334")
    (finding,) = find(tmp_path / "a", make_arm(inertial(**rod)), "INR004")
    assert (finding.message_id, finding.severity) == ("rounded", Severity.WARNING)
    assert finding.data["digits"] > finding.data["typed"] == 3
    exact = {name: text + "000" for name, text in rod.items()}
    (finding,) = find(tmp_path / "b", make_arm(inertial(**exact)), "INR004")
    assert (finding.message_id, finding.severity) == ("products", Severity.ERROR)


@pytest.mark.parametrize(
    ("mass", "size", "message"),
    [("0.0005", "1e-5", "helper"), ("0.1", "1e-5", "negative_sign"), ("0.1", "9", "negative_sign")],
)
def test_a_negative_moment_on_a_helper_link_is_a_warning(tmp_path: Path, mass: str, size: str, message: str) -> None:
    cover = inertial(mass, ixx=size, iyy="-" + size, izz=size)
    (finding,) = find(tmp_path, make_arm(SOUND, more=fixed("cover", cover)), "INR004")
    assert finding.message_id == message
    assert (finding.severity == Severity.WARNING) == (message == "helper")
    assert ("merged with arm" in finding.message) == (mass == "0.1" and size == "1e-5")


@pytest.mark.parametrize(
    ("cover", "drawn", "message"),
    [
        ({"ixx": -8, "iyy": -8, "izz": 0.5}, "", "negative"),
        ({"ixx": -8, "iyy": -8, "izz": 0.5}, visual(box("1.732 1.732 9.644")), "negative_sign"),
        ({"ixx": 8, "iyy": 8, "izz": 0.5}, "", "negative_sign"),  # of the arm
    ],
)
def test_no_sign_is_stray_where_another_link_is_impossible_without_signs(
    tmp_path: Path, cover: dict[str, float], drawn: str, message: str
) -> None:
    """Who subtracts a parallel-axis term does so in all links. The numbers of the drawn part are right but for the sign."""
    odd = inertial(5, ixx=-0.3, iyy=-0.3, izz=-0.7 if cover["ixx"] < 0 else 0.4)
    found = find(tmp_path, make_arm(odd, more=fixed("cover", inertial(1, **cover) + drawn)), "INR004")
    last = next(finding for finding in found if finding.data["link"] == ("cover" if cover["ixx"] < 0 else "arm"))
    assert last.message_id == message
    assert (last.cause is None) == (message == "negative")


# -- INR011 ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("mass", "light"),
    [("1e-6", False), ("2e-6", True), ("0.00099", True), ("0.001", False), ("1", False), ("1e5", False)],
)
def test_a_child_is_light_below_a_thousandth_and_the_root_may_be_bolted_down(
    tmp_path: Path, mass: str, light: bool
) -> None:
    assert [f.message_id for f in find(tmp_path, make_arm(inertial(mass)), "INR011")] == ["light"] * light


@pytest.mark.parametrize(("cover", "messages"), [("", ["uneven"]), (inertial("0.9"), [])])
def test_a_body_that_carries_a_hundred_times_its_mass_counts_with_what_is_fixed_to_it(
    tmp_path: Path, cover: str, messages: list[str]
) -> None:
    tip = f'<link name="tip">{inertial("10.1")}</link>'
    joint = '<joint name="k" type="revolute"><parent link="arm"/><child link="tip"/><axis xyz="1 0 0"/></joint>'
    text = make_arm(inertial("0.1"), more=tip + joint + fixed("cover", cover))
    assert [f.message_id for f in find(tmp_path, text, "INR011")] == messages


@pytest.mark.parametrize(("drawn", "count"), [("", 0), (BOX, 1)])
def test_slides_that_stand_for_a_driving_base_may_be_light(tmp_path: Path, drawn: str, count: int) -> None:
    text = robot(
        link("world"),
        link("slide", inertial(1), drawn),
        link("body", inertial(300), BOX),
        joint("x", "world", "slide", kind="prismatic", axis="1 0 0"),
        joint("turn", "slide", "body", kind="continuous", axis="0 0 1"),
    )
    assert len(find(tmp_path, text, "INR011")) == count


def block(mass: float, size: float) -> str:
    return inertial(str(mass)) + f'<visual><geometry><box size="{size} {size} {size}"/></geometry></visual>'


@pytest.mark.parametrize(
    ("base", "child", "suspects"),
    [(5.2, 4.5e-4, "arm"), (5200.0, 0.45, "base"), (5.2, 4.5e-3, "arm and base")],
)
def test_of_two_masses_the_implausible_one_is_named(tmp_path: Path, base: float, child: float, suspects: str) -> None:
    size = 0.08 if suspects != "arm and base" else 0.02
    (finding,) = find(tmp_path, make_arm(block(child, size), base=block(base, 0.2)), "INR011")
    assert finding.fix is not None
    assert finding.fix.title.startswith(f"check the mass of {suspects} (its unit")


@pytest.mark.parametrize(
    ("mass", "words"), [("1e-9", "1e-9 stands for none: onshape-to-robot"), ("1e-6", "1e-6 stands for none)")]
)
def test_a_mass_that_stands_for_none_is_in_no_wrong_unit(tmp_path: Path, mass: str, words: str) -> None:
    """Of a moving body it is said once, with what programs do."""
    light = inertial(mass) + '<visual><geometry><box size="0.1 0.1 0.1"/></geometry></visual>'
    (finding,) = find(tmp_path, make_arm(light, base=block(5.2, 0.2)), {"INR010", "INR012"})
    assert finding.code == "INR012"
    assert finding.fix is not None
    assert finding.fix.title.startswith(f"write the mass of the part ({words}")


@pytest.mark.parametrize(("other", "unit"), [(11.7, "grams"), (151.3, None)])
def test_the_masses_of_a_file_have_one_unit_and_a_box_no_scale(tmp_path: Path, other: float, unit: str | None) -> None:
    first, second = block(7.778, 0.022), block(other, 0.022)
    found = find(tmp_path, make_arm(first, base=second), "INR010")
    assert {finding.data.get("unit") for finding in found} == {unit}
    assert all("mesh" not in finding.fix.title for finding in found if finding.fix is not None)


# -- INR012 ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (inertial("1e-6"), "mass"),
        (inertial("1.1e-6"), None),
        (inertial("1", ixx="0.9e-8", iyy="0.9e-8", izz="0.9e-8"), "point"),
        (inertial("1", ixx="1.1e-8", iyy="1.1e-8", izz="1.1e-8"), None),
        (inertial("1", ixx="0.9e-6"), "condition"),
        (inertial("1", ixx="1.1e-6"), None),
        (inertial("1", ixx="0", iyy="0", izz="0"), None),
        (inertial("1", ixx="1e-12"), None),
        (inertial("1", ixx="-1"), None),
    ],
)
def test_where_a_moving_body_is_lost(tmp_path: Path, body: str, message: str | None) -> None:
    assert [f.message_id for f in find(tmp_path, make_arm(body), "INR012")] == ([] if message is None else [message])
    assert not find(tmp_path, make_arm(body, kind="fixed"), "INR012")


def test_a_body_is_judged_with_what_is_fixed_to_it(tmp_path: Path) -> None:
    assert not find(tmp_path, make_arm(inertial("1e-9"), more=fixed("cover", SOUND)), "INR012")


@pytest.mark.parametrize(
    ("mass", "radius", "cause"), [("0.001", 0.0005, "other_mass"), ("0.5", 0.05, "factor"), ("5", 0.02, None)]
)
def test_the_drawn_part_says_why_a_tensor_is_that_of_a_point(
    tmp_path: Path, mass: str, radius: float, cause: str | None
) -> None:
    own = 1000.0 * 4 / 3 * math.pi * radius**3 if cause == "other_mass" else float(mass) * 1e-6
    body = inertial(mass, repr(0.4 * own * radius**2)) + visual(sphere(radius))
    (finding,) = find(tmp_path, make_arm(body), "INR012")
    assert (finding.message_id, finding.cause and finding.cause.id) == ("point", cause)
    assert finding.fix is not None
    assert ("multiply the tensor by" in finding.fix.title) == (cause is not None)


# -- INR013 ---------------------------------------------------------------------------------------------------------


def turned(rpy: str, **six: str) -> str:
    return inertial(**six).replace("<inertial>", f'<inertial><origin rpy="{rpy}"/>')


@pytest.mark.parametrize(
    ("body", "count"),
    [
        (turned("0 0 0", ixx="0.5"), 0),
        (turned("0.4 0.3 1.2"), 0),  # a ball looks the same from everywhere
        (turned("1.2 0 0", ixx="0.5"), 0),  # and a disk about its axis
        (turned("0 0 0.001", ixx="0.5"), 0),
        (turned("0 0 0.1", ixx="0.5"), 1),
        (turned("0 0 3.141592653589793", ixx="0.5", ixz="0.1"), 1),
    ],
)
def test_a_rotation_counts_when_it_changes_the_tensor(tmp_path: Path, body: str, count: int) -> None:
    assert len(find(tmp_path, make_arm(body), "INR013")) == count


def test_the_fix_writes_the_same_body_in_the_axes_of_the_link(tmp_path: Path) -> None:
    text = make_arm(turned("0.3 -0.2 1.1", ixx="0.5", iyy="0.7", ixy="0.1", iyz="-0.05"))
    (finding,) = find(tmp_path, text, "INR013")
    assert finding.fix is not None
    for edit in sorted(finding.fix.edits, key=lambda e: -e.span.start):
        assert text[edit.span.start : edit.span.end] == edit.expected
        text = text[: edit.span.start] + edit.replacement + text[edit.span.end :]

    def tensor(source: str) -> list[float]:
        path = tmp_path / "either.urdf"
        path.write_text(source)
        loaded = load_source(path, {}, PackageFinder(tmp_path))
        assert loaded.root is not None
        link = Model(source=loaded, robot=loaded.root).link_by_name["arm"]
        assert link.inertial is not None
        assert link.inertial.tensor_in_link is not None
        return [float(v) for v in link.inertial.tensor_in_link.ravel()]

    before = make_arm(turned("0.3 -0.2 1.1", ixx="0.5", iyy="0.7", ixy="0.1", iyz="-0.05"))
    assert tensor(text) == pytest.approx(tensor(before), abs=1e-13)
    assert not find(tmp_path, text, "INR013")


def test_all_turned_frames_are_one_finding_at_the_worst(tmp_path: Path) -> None:
    text = make_arm(turned("0 0 1.5", ixx="0.5"), base=turned("0 0 0.1", ixx="0.5"))
    (finding,) = find(tmp_path, text, "INR013")
    assert finding.subjects == ("link[arm]/inertial/origin@rpy",)
    assert [place.subject for place in finding.related] == ["link[base]/inertial/origin@rpy"]
    assert finding.fix is not None
    assert finding.fix.title.endswith("the same body, in every program")  # and has the edits of both
    assert {edit.replacement for edit in finding.fix.edits} >= {"0 0 0"}


# -- INR014 ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("product", "noise"), [("9e-10", True), ("-1e-19", True), ("1.1e-9", False), ("0", False)])
def test_noise_is_below_a_billionth_of_the_largest_moment(tmp_path: Path, product: str, noise: bool) -> None:
    assert bool(find(tmp_path, make_arm(inertial(ixy=product)), "INR014")) == noise


def test_all_residues_of_a_robot_are_one_finding_with_one_edit_each(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_arm(inertial(ixy="1e-17", iyz="-2e-18"), base=inertial(ixz="3e-20")), "INR014")
    assert finding.fix is not None
    assert [(e.expected, e.replacement) for e in finding.fix.edits] == [("3e-20", "0"), ("1e-17", "0"), ("-2e-18", "0")]


# -- INR015 ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("masses", "cause"),
    [
        (("0.0009", "0.0002"), None),
        (("0.0009", "0.00005"), "tonnes"),
        (("3e-7", "2e-7"), ""),
        (("99999", "1"), None),
        (("99999", "2"), "grams"),
        (("200000", "50"), ""),  # typed by hand
        (("199999", "0.38"), ""),  # the other link is in kilograms
    ],
)
def test_a_robot_weighs_a_gram_to_a_hundred_tonnes(tmp_path: Path, masses: tuple[str, str], cause: str | None) -> None:
    findings = find(tmp_path, make_arm(inertial(masses[0]), base=inertial(masses[1])), "INR015")
    assert [f.cause.id if f.cause else "" for f in findings] == ([] if cause is None else [cause])


@pytest.mark.parametrize(
    ("mass", "is_jointed", "found"),
    [(0.0008, False, []), (0.0008, True, ["light"]), (0.0000008, False, ["light"]), (0.000008, False, ["light"])],
)
def test_a_small_object_may_weigh_less_than_a_gram(
    tmp_path: Path, mass: float, is_jointed: bool, found: list[str]
) -> None:
    """A plate of 0.1 cm³ is of steel at 0.8 g; it is of no material at 8 mg."""
    nut = link("nut", inertial(mass * 1.01), visual(box("0.01 0.005 0.002")))
    more = (
        (link("bolt", inertial(1e-7)), joint("j", "nut", "bolt", kind="continuous", axis="0 0 1")) if is_jointed else ()
    )
    assert [f.message_id for f in find(tmp_path, robot(nut, *more), "INR015")] == found


def test_frames_of_a_fragment_have_token_masses(tmp_path: Path) -> None:
    text = robot(link("grip", inertial(1e-4, 1e-8)), link("tip", inertial(1e-4, 1e-8)), joint("j", "grip", "tip"))
    assert not find(tmp_path, text, "INR015")


def test_one_placeholder_in_place_of_every_mass_is_one_finding(tmp_path: Path) -> None:
    """Not a model in tonnes, whose leg would weigh milligrams, and not a tensor that is too large for this mass."""
    part = inertial("1e-9", "1e-9") + BOX
    text = make_arm(part, base=part)
    rules = {"INR007", "INR010", "INR012", "INR015", "KIN010"}
    found = {f.code: f for f in check_text(tmp_path, text, codes=rules).findings}
    assert set(found) == {"INR015", "KIN010"}
    assert (found["INR015"].message_id, found["INR015"].cause) == ("placeholder", None)
    assert found["KIN010"].message_id == "tiny"
    assert "weighs only 1e-09 kg" in found["KIN010"].message
    assert not find(tmp_path, text, "INR007")
    (alone,) = find(tmp_path, make_arm(part, base=inertial(1, 1)), "INR012")
    assert alone.cause is None


@pytest.mark.parametrize(("mass", "moment", "found"), [("1e-9", "1e-9", 0), ("1.3e-9", "1e-9", 0), ("1e-9", "900", 1)])
def test_a_tensor_is_not_compared_with_a_placeholder_of_a_mass(
    tmp_path: Path, mass: str, moment: str, found: int
) -> None:
    """Unless no part of this size has the tensor, whatever it weighs. One lighter than air is INR010's."""
    assert len(find(tmp_path, make_arm(inertial(mass, moment) + visual(box("0.1 0.1 0.1"))), "INR005")) == found


@pytest.mark.parametrize(
    ("mass", "shape", "found"),
    [
        ("22591", '<box size="1 0.1 0.1"/>', ["dense"]),
        ("22589", '<box size="1 0.1 0.1"/>', []),
        ("150000", '<box size="9 9 9"/>', []),
        ("2e9", '<box size="9 9 9"/>', ["dense"]),
    ],
)
def test_a_robot_weighs_no_more_than_osmium(tmp_path: Path, mass: str, shape: str, found: list[str]) -> None:
    body = f"{inertial(mass)}<visual><geometry>{shape}</geometry></visual>"
    findings = find(tmp_path, robot(link("base", body)), "INR015")
    assert [f.message_id for f in findings] == found
    assert all(f.severity == (Severity.ERROR if f.message_id == "dense" else Severity.WARNING) for f in findings)


@pytest.mark.parametrize(("others", "named"), [("0.2", "joint_link"), ("9000", None)])
def test_the_one_link_that_is_heavier_than_its_robot_can_be_is_named(
    tmp_path: Path, others: str, named: str | None
) -> None:
    text = robot(
        link("base", inertial(float(others), 0.1), visual(box("0.1 0.1 0.1"))),
        link("joint_link", inertial(30000, 0.1), visual(box("0.1 0.1 0.1"))),
        joint("j", "base", "joint_link", kind="continuous", xyz="0.1 0 0"),
    )
    (finding,) = check_text(tmp_path, text, codes={"INR015"}).findings
    assert finding.message_id == ("dense_link" if named else "dense")
    assert finding.location.subject == (f"link[{named}]/inertial/mass@value" if named else "robot[r]@name")
    assert finding.severity is Severity.ERROR


@pytest.mark.parametrize(("mass", "held"), [(10000.0, True), (10123.4567, False)])
def test_a_round_weight_under_a_robot_may_hold_it_down(tmp_path: Path, mass: float, held: bool) -> None:
    text = robot(
        link("support", inertial(mass, 100), visual(box("0.1 0.1 0.1"))),
        link("arm", inertial(0.2, 0.1), visual(box("0.1 0.1 0.1"))),
        joint("j", "support", "arm", kind="continuous", xyz="0.1 0 0"),
    )
    (finding,) = find(tmp_path, text, "INR015")
    assert finding.severity is (Severity.WARNING if held else Severity.ERROR)
    assert finding.fix is not None
    assert ("fix it to the world" in finding.fix.title) == held


@pytest.mark.parametrize(("mass", "unit"), [("52.83", True), ("528.3", False)])
def test_grams_are_named_only_where_the_robot_could_weigh_as_much_in_them(
    tmp_path: Path, mass: str, unit: bool
) -> None:
    """Otherwise the lengths may be wrong."""
    body = f'{inertial(mass)}<visual><geometry><box size="0.002 0.002 0.002"/></geometry></visual>'
    size = 0.002 if not unit else 0.02
    (finding,) = find(tmp_path, robot(link("base", body.replace("0.002", f"{size:g}"))), "INR015")
    assert finding.fix is not None
    assert ("in kilograms" in finding.fix.title) == unit
    assert "otherwise correct its lengths" in finding.fix.title


def test_a_mesh_that_is_not_there_may_be_larger_than_what_is_seen(tmp_path: Path) -> None:
    mesh = '<visual><geometry><mesh filename="missing.stl"/></geometry></visual>'
    for mass, found in (("90000", []), ("600000", ["heavy"]), ("620000", ["dense"])):
        text = robot(link("base", inertial(mass)), link("arm", mesh), joint("j", "base", "arm", xyz="0 0 1"))
        assert [f.message_id for f in find(tmp_path, text, "INR015")] == found


@pytest.mark.parametrize(("program", "severity"), [("rviz", Severity.INFO), ("gazebo_ros", Severity.ERROR)])
def test_too_large_a_mass_that_nothing_reads_is_an_info(tmp_path: Path, program: str, severity: Severity) -> None:
    text = robot(link("base", inertial(100) + visual(box("0.1 0.1 0.1"))))
    started = f"<node pkg='robot_state_publisher' args='arm.urdf'/><node pkg='{program}' type='{program}'/>"
    (tmp_path / "package.xml").write_text("<package><name>arm</name></package>")
    (tmp_path / "launch").mkdir()
    (tmp_path / "launch/a.launch").write_text(f"<launch>{started}</launch>")
    (finding,) = find(tmp_path, {"urdf/arm.urdf": text}, "INR015", name="urdf/arm.urdf")
    assert (finding.message_id, finding.severity) == ("dense", severity)


def test_a_drawing_has_no_mass_to_be_wrong(tmp_path: Path) -> None:
    assert not find(tmp_path, make_arm(BOX, base=BOX), "INR015")


# -- INR016 ---------------------------------------------------------------------------------------------------------


def disk(radius: float, length: float, density: float) -> str:
    mass = density * 3.141592653589793 * radius**2 * length
    across = repr(mass * (3 * radius**2 + length**2) / 12)
    return inertial(repr(mass), ixx=across, iyy=across, izz=repr(mass * radius**2 / 2))


@pytest.mark.parametrize(
    ("density", "default"), [(1000, True), (1002, True), (1005, False), (7850, True), (2700, False)]
)
def test_two_different_disks_without_a_material(tmp_path: Path, density: float, default: bool) -> None:
    text = make_arm(disk(0.03, 0.01, density), base=disk(0.1, 0.02, density))
    assert bool(find(tmp_path, text, "INR016")) == default
    exported = "<!-- created by SolidWorks to URDF Exporter -->" + text
    assert bool(find(tmp_path, exported, "INR016")) == (default and density != 7850)


def test_the_mass_that_is_a_placeholder_is_that_of_the_parts_without_a_material(tmp_path: Path) -> None:
    light = disk(0.03, 0.01, 1000), disk(0.02, 0.01, 1000), disk(0.04, 0.01, 1000)
    more = "".join(fixed(f"p{i}", part) for i, part in enumerate((*light[1:], disk(0.1, 0.05, 7850))))
    (finding,) = find(tmp_path, make_arm(light[0], base=disk(0.05, 0.01, 1000), more=more), "INR016")
    assert finding.data["count"] == 4
    assert finding.data["mass"] == pytest.approx(0.054 * 3.14159265, rel=1e-6)


def test_two_equal_disks_are_one_piece_of_evidence(tmp_path: Path) -> None:
    assert not find(tmp_path, make_arm(disk(0.03, 0.01, 1000), base=disk(0.03, 0.01, 1000)), "INR016")


def test_a_robot_of_several_materials_has_materials(tmp_path: Path) -> None:
    more = "".join(fixed(f"p{i}", disk(0.05, 0.01 * (i + 1), 2700)) for i in range(4))
    assert not find(tmp_path, make_arm(disk(0.03, 0.01, 1000), base=disk(0.1, 0.02, 1000), more=more), "INR016")


def test_links_drawn_with_primitives_are_computed_and_prove_nothing(tmp_path: Path) -> None:
    assert not find(tmp_path, make_arm(disk(0.03, 0.01, 1000) + BOX, base=disk(0.1, 0.02, 1000) + BOX), "INR016")


@pytest.mark.parametrize("value", ["1e308", "1e60", "1e50", "1e-50", "1e-308", "5e-324"])
@pytest.mark.filterwarnings("error")
def test_numbers_of_no_robot_neither_crash_nor_warn(tmp_path: Path, value: str) -> None:
    inertial = (
        f'<inertial><origin xyz="{value} 0 {value}"/><mass value="{value}"/>'
        f'<inertia ixx="{value}" ixy="0" ixz="{value}" iyy="1" iyz="0" izz="{value}"/></inertial>'
    )
    shapes = "".join(
        f'<visual><origin xyz="0 {value} 0"/><geometry>{shape}</geometry></visual>'
        for shape in (f'<box size="{value} 1 {value}"/>', f'<cylinder radius="{value}" length="{value}"/>')
    )
    links = "".join(f'<link name="wheel_{i}">{inertial}{shapes}</link>' for i in range(4))
    joints = "".join(
        f'<joint name="j{i}" type="continuous"><parent link="wheel_0"/><child link="wheel_{i}"/>'
        f'<origin xyz="{value} {i} 0"/><axis xyz="0 {value} 0"/></joint>'
        for i in (1, 2, 3)
    )
    run = check_text(tmp_path, f'<robot name="r">{links}{joints}</robot>', scene=True)
    assert not run.failures
    assert not [f for f in run.findings if " nan" in f.message or " inf " in f.message]


# -- INR017 ---------------------------------------------------------------------------------------------------------


def tiny(value: str, mass: str = "1e-6") -> str:
    return inertial(mass, ixx=value, iyy=value, izz=value)


def test_all_links_that_are_too_small_for_mujoco_are_one_finding(tmp_path: Path) -> None:
    text = make_arm(SOUND, base=tiny("2e-15"), more=fixed("tip", tiny("1e-15")) + fixed("cap", tiny("1.1e-14")))
    (finding,) = find(tmp_path, text, "INR017")
    assert finding.severity == Severity.WARNING
    assert finding.subjects == ("link[tip]/inertial/inertia", "link[base]/inertial/inertia")
    assert "1 other link (base)" in finding.message


def test_what_mujoco_refuses_is_an_error_where_it_is_a_target(tmp_path: Path) -> None:
    text = make_arm(SOUND, more=fixed("tip", tiny("9e-15")))
    (finding,) = check_text(tmp_path, text, codes={"INR017"}, targets=("mujoco",)).findings
    (other,) = check_text(tmp_path, text, codes={"INR017"}, targets=("drake",)).findings
    assert [finding.severity, other.severity] == [Severity.ERROR, Severity.INFO]


def test_a_whole_moving_body_that_is_next_to_nothing_is_one_finding(tmp_path: Path) -> None:
    (finding,) = check_text(tmp_path, make_arm(tiny("5e-15")), codes={"INR012", "INR017"}).findings
    assert finding.code == "INR012"
    assert finding.consequences["mujoco"].startswith("refuses")


def test_a_copied_tensor_names_all_its_links(tmp_path: Path) -> None:
    inertial = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="9"/></inertial>'
    hand = (
        '<link name="{0}">{1}</link><joint name="to_{0}" type="fixed"><parent link="base"/><child link="{0}"/></joint>'
    )
    one = '<robot name="r"><link name="base"/>' + hand.format("a", inertial)
    for text, named in ((one, "a: "), (one + hand.format("b", inertial), "a, b: ")):
        (tmp_path / "r.urdf").write_text(text + "</robot>")
        (finding,) = check(tmp_path / "r.urdf", codes={"INR003"}).findings
        assert finding.message.startswith(named)


def test_a_frame_behind_a_joint_without_type_may_be_meant_as_fixed(tmp_path: Path) -> None:
    text = make_arm(SOUND, more=fixed("camera", "").replace('type="fixed"', ""))
    assert not [f for f in find(tmp_path, text, "INR001") if f.severity > Severity.INFO]


def test_a_part_without_a_material_gets_a_mass_first(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, make_arm(inertial(1e-9, 0)), "INR004")
    assert finding.fix is not None
    assert finding.fix.title.startswith("write the mass of the part (1e-9 stands for none")
    assert finding.fix.title.endswith(", and the tensor")
