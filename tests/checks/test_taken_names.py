"""A name that a sibling entry has is not the one that is meant, and what a missing prefix leaves out is told once."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from builders import joint, link, robot
from conftest import check, check_text

from urdfcheck.core import Applicability, Edit, Finding, Fix, Location, Severity, Span
from urdfcheck.core.merging import merge_alike, merge_same_text
from urdfcheck.rules import load_rules

CART = (
    link("base") + "".join(link(side) for side in ("left", "right")),
    joint("left_wheel", "base", "left", kind="continuous", axis="0 1 0"),
    joint("right_wheel", "base", "right", kind="continuous", axis="0 1 0"),
)
SPARE = link("spare") + joint("rear_wheels", "base", "spare", kind="continuous", axis="0 1 0")


def write(root: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text, encoding="utf-8")
    return root


def only(findings: tuple[Finding, ...]) -> Finding:
    (finding,) = findings
    return finding


def find_in_yaml(folder: Path, joints: str, other: str) -> Finding:
    manifest = '<package format="3"><name>cart</name></package>'
    yaml = (
        f"drive:\n  type: effort_controllers/JointGroupEffortController\n  joints: [{joints}]\n"
        f"turn:\n  type: effort_controllers/JointGroupEffortController\n  joints: [{other}]\n"
    )
    files = {"package.xml": manifest, "urdf/cart.urdf": robot(*CART, name="cart"), "config/c.yaml": yaml}
    return only(check(write(folder, files), codes={"CTL004"}).findings)


@pytest.mark.parametrize(("other", "suggested"), [("left_wheel", False), ("right_wheel", True)])
def test_a_joint_of_another_controller_is_not_meant(tmp_path: Path, other: str, suggested: bool) -> None:
    finding = find_in_yaml(tmp_path / "cart", "left_wheell, right_wheel", other)
    assert ("did you mean" in finding.message) == suggested


def name_joints(*names: str) -> str:
    joints = "".join(f'<joint name="{name}"><command_interface name="velocity"/></joint>' for name in names)
    return f'<ros2_control name="s" type="system">{joints}</ros2_control>'


@pytest.mark.parametrize(
    ("names", "message"), [(("left_whel",), "ros2_control"), (("left_whel", "left_wheel"), "strange")]
)
def test_a_joint_that_the_block_names_itself_is_not_meant(tmp_path: Path, names: tuple[str, ...], message: str) -> None:
    finding = only(check_text(tmp_path, robot(*CART, name_joints(*names)), codes={"CTL001"}).findings)
    assert finding.message_id.endswith(message)


@pytest.mark.parametrize(("right", "near"), [("left_wheel", False), ("rear_wheel", True)])
def test_the_other_wheel_of_a_drive_is_not_meant(tmp_path: Path, right: str, near: bool) -> None:
    plugin = f"<left_joint>left_weel</left_joint><right_joint>{right}</right_joint>"
    block = f'<gazebo><plugin filename="libgazebo_ros_diff_drive.so" name="d">{plugin}</plugin></gazebo>'
    text = robot(*CART, SPARE, block)
    found = [f for f in check_text(tmp_path, text, codes={"CTL007"}).findings if "left_weel" in f.message]
    assert ("did you mean 'left_wheel'" in only(tuple(found)).message) == near


def test_a_parameter_that_the_call_has_is_not_meant(tmp_path: Path) -> None:
    macro = '<xacro:macro name="wheel" params="mass"/><xacro:wheel mass="1" mas="2"/>'
    finding = only(check_text(tmp_path, robot(macro, xacro=True), "r.xacro", codes={"XAC001"}).findings)
    assert "'mas'" in finding.message or "mas" in finding.message
    assert "did you mean" not in finding.message


@pytest.mark.parametrize(("driven", "severity"), [(True, Severity.INFO), (False, Severity.ERROR)])
def test_a_wheel_that_a_drive_plugin_turns_needs_no_transmission(
    tmp_path: Path, driven: bool, severity: Severity
) -> None:
    wheels = "<left_joint>left_wheel</left_joint><right_joint>right_wheel</right_joint>" if driven else ""
    blocks = (
        '<gazebo><plugin filename="libgazebo_ros_control.so" name="c"/></gazebo>'
        f'<gazebo><plugin filename="libgazebo_ros_diff_drive.so" name="d">{wheels}</plugin></gazebo>'
        '<transmission name="t"><type>transmission_interface/SimpleTransmission</type><joint name="left_wheel"/></transmission>'
    )
    assert only(check_text(tmp_path, robot(*CART, blocks), codes={"CTL003"}).findings).severity is severity


BLOCK = '<xacro:macro name="block" params="name"><link name="${name}_link"/></xacro:macro>'


@pytest.mark.parametrize(("parent", "codes"), [("arm_link", ["XAC007"]), ("other_link", ["KIN002", "XAC007"])])
def test_a_link_that_a_call_without_prefix_would_make_is_told_once(
    tmp_path: Path, parent: str, codes: list[str]
) -> None:
    text = robot(BLOCK, link("hand"), '<block name="arm"/>', joint("j", parent, "hand"), xacro=True)
    found = check_text(tmp_path, text, "r.xacro", codes={"KIN002", "XAC007"}).findings
    assert sorted(f.code for f in found) == codes


def test_a_call_may_be_of_any_macro_of_its_name(tmp_path: Path) -> None:
    again = BLOCK.replace("${name}", "${title}").replace('params="name"', 'params="title size"')
    text = robot(BLOCK, again, link("hand"), '<block name="arm"/>', xacro=True)
    assert only(check_text(tmp_path, text, "r.xacro", codes={"XAC007"}).findings).code == "XAC007"


@pytest.mark.parametrize(("there", "suggested"), [("urdf/r.urdf", True), ("urdf/q.urdf", False)])
def test_a_launch_file_means_a_package_that_has_the_model(tmp_path: Path, there: str, suggested: bool) -> None:
    command = '<param name="robot_description" textfile="$(find cart_desciption)/urdf/r.urdf"/>'
    files = {
        ".git/HEAD": "",
        "cart_description/package.xml": "<package><name>cart_description</name></package>",
        f"cart_description/{there}": robot(link("base")),
        "run/package.xml": "<package><name>run</name></package>",
        "run/launch/a.launch": f"<launch>{command}</launch>",
    }
    finding = only(check(write(tmp_path, files) / "run/launch/a.launch", codes={"LCH001"}).findings)
    assert ("cart_description" in finding.message) == suggested


def test_all_packages_that_are_not_found_are_told(tmp_path: Path) -> None:
    names = ("cart_control", "cart_hardware", "cart_nav")
    includes = "".join(f'<include file="$(find {name})/launch/a.launch"/>' for name in names)
    files = {
        ".git/HEAD": "",
        "cart/package.xml": "<package><name>cart</name></package>",
        "cart/launch/b.launch": f"<launch>{includes}</launch>",
    }
    finding = only(check(write(tmp_path, files) / "cart", codes={"PKG007"}).findings)
    assert finding.message_id == "unknown-several"
    assert all(name in finding.message for name in names)


def test_several_claims_about_one_element_stay_apart() -> None:
    place = Location("package", Span("package.xml", 1, 1, 1, 2, 0, 1))
    finding = load_rules()["PKG006"].finding("short", at=place, name="x")
    other = replace(finding, message="another", subjects=("package[b]",))
    assert [f.message for f in merge_same_text([finding, other, finding])] == [finding.message, "another"]


def test_a_text_whose_elements_want_other_numbers_has_no_edit_and_says_so() -> None:
    """One line of a macro is the left and the right link: the number of one is wrong in the other."""
    place = Location("link[left]", Span("arm.xacro", 1, 1, 1, 2, 0, 1))
    finding = load_rules()["PKG006"].finding("short", at=place, name="x")

    def repair(side: str, number: str, *, edited: bool = True) -> Finding:
        edits = (Edit(place.span, "0", number),) if edited and place.span else ()
        applicability = Applicability.UNSAFE if edits else Applicability.DISPLAY
        return replace(finding, subjects=(f"link[{side}]",), fix=Fix(f"write y {number}", applicability, edits))

    (merged,) = merge_same_text([repair("left", "0.06"), repair("right", "-0.06")])
    assert merged.fix == Fix("write y 0.06; right: write y -0.06")
    (merged,) = merge_same_text([repair(side, str(n), edited=False) for n, side in enumerate(("a", "b", "c"))])
    assert merged.fix == Fix("write y 0; each of the others has its own repair")
    elsewhere = Location("link[d]", Span("arm.xacro", 2, 1, 2, 2, 10, 11))
    more = replace(repair("d", "4", edited=False), location=elsewhere)
    (joined,) = merge_alike([merged, more], load_rules(), lambda finding: finding.code)
    assert joined.fix == merged.fix  # said once
    (merged,) = merge_same_text([repair("left", "0.06"), repair("right", "0.06")])
    assert merged.fix == repair("left", "0.06").fix
