"""A value that a macro hands on is repaired where it was typed, if nothing else reads it."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import make_request

from urdfcheck.fix.fixer import FixResult, compute_fixes
from urdfcheck.rules import select_rules
from urdfcheck.run.pipeline import IN_THIS_PROCESS

XACRO = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">\n{}\n</robot>\n'
PART = (
    '<xacro:macro name="part" params="name i">\n<link name="${name}"><inertial><mass value="1"/>\n'
    '<inertia ixx="${i.xx}" ixy="${i.xy}" ixz="${i.xz}" iyy="${i.yy}" iyz="${i.yz}" izz="${i.zz}"/></inertial></link>\n'
    "</xacro:macro>\n"
    '<xacro:property name="all" value="${xacro.load_yaml(\'parts.yaml\')}"/>\n'
)
LEFT = '<xacro:part name="left" i="${all[\'left\']}"/>\n'
RIGHT = LEFT.replace("left", "right", 1).replace("['left']", "['right']")
YAML = "left:\n  xx: 0.001\n  xy: 0.001\n  xz: 0.001 # all alike\n  yy: 0.001\n  yz: 0.001\n  zz: 0.001\n"
ARM = (
    '<xacro:macro name="arm" params="parent child top">\n'
    '<joint name="hinge" type="revolute"><parent link="${parent}"/><child link="${child}"/><axis xyz="0 0 1"/>\n'
    '<limit lower="-1" upper="${top}" effort="1" velocity="1"/><dynamics damping="${top}"/></joint></xacro:macro>\n'
    '<link name="base_link"/><link name="lever"/>\n'
)


def fix(folder: Path, body: str, codes: str, **files: str) -> tuple[FixResult, dict[str, str]]:
    """The result, and the texts of the changed files by name."""
    (folder / "r.urdf.xacro").write_text(XACRO.format(body))
    for name, text in files.items():
        (folder / f"{name}.yaml").write_text(text)
    request = make_request(folder / "r.urdf.xacro", root=folder, codes=select_rules(codes.split()), tier="source")
    found = compute_fixes(request, IN_THIS_PROCESS, include_unsafe=True)
    return found, {Path(path).name: after.decode() for path, (_, after) in found.changes.items()}


def test_a_number_of_a_yaml_file(tmp_path: Path) -> None:
    found, changed = fix(tmp_path, PART + LEFT, "INR003", parts=YAML)
    assert [finding.code for finding in found.fixed] == ["INR003"]
    zeros = YAML.replace("xy: 0.001", "xy: 0").replace("xz: 0.001", "xz: 0").replace("yz: 0.001", "yz: 0")
    assert changed == {"parts.yaml": zeros}
    assert found.outcome.findings == ()


def test_a_number_of_two_links_with_the_same_mistake(tmp_path: Path) -> None:
    found, changed = fix(tmp_path, PART + LEFT + LEFT.replace('"left"', '"right"'), "INR003", parts=YAML)
    assert changed["parts.yaml"].count(" 0\n") == 2  # and one before a comment
    assert found.outcome.findings == ()


@pytest.mark.parametrize(
    "other",
    [
        "<link name=\"stop\"><visual><geometry><sphere radius=\"${all['left']['xy']}\"/></geometry></visual></link>",
        "<xacro:if value=\"${all['left']['xy'] > 0}\"><link name=\"stop\"/></xacro:if>",
        "<gazebo reference=\"left\"><mu1>${all['left']['xy']}</mu1></gazebo>",
        '<xacro:property name="doubled" value="${2*all[\'left\'][\'xy\']}"/><link name="stop"><visual><geometry>'
        '<sphere radius="${doubled}"/></geometry></visual></link>',
    ],
    ids=["an attribute", "a condition", "a text", "a property"],
)
def test_a_number_that_something_else_reads_is_advice(tmp_path: Path, other: str) -> None:
    found, changed = fix(tmp_path, PART + LEFT + other, "INR003", parts=YAML)
    assert changed == {}
    (finding,) = found.outcome.findings
    assert finding.fix is not None
    assert str(finding.fix.applicability) == "display"
    assert 'write ixy="0" ixz="0" iyz="0"' in finding.fix.title


def test_a_number_of_which_a_macro_makes_a_right_one_too_is_advice(tmp_path: Path) -> None:
    macro = (
        '<xacro:macro name="part" params="name d"><link name="${name}"><inertial><mass value="1"/>'
        '<inertia ixx="${d}" ixy="0.001" ixz="0.001" iyy="${d}" iyz="0.001" izz="${d}"/></inertial></link></xacro:macro>'
    )
    left, right = '<xacro:part name="left" d="0.001"/>', '<xacro:part name="right" d="0.01"/>'
    _, changed = fix(tmp_path, macro + left, "INR003")
    assert changed == {"r.urdf.xacro": XACRO.format(macro.replace('"0.001"', '"0"') + left)}
    found, changed = fix(tmp_path, macro + left + right, "INR003")
    assert changed == {}
    (finding,) = found.outcome.findings
    assert finding.fix is not None
    assert finding.fix.title.endswith("; not in right, which is made of the same text")


def test_a_name_that_a_call_hands_over(tmp_path: Path) -> None:
    call = '<xacro:arm parent="base_lnk" child="lever" top="1"/>'
    _, changed = fix(tmp_path, ARM + call, "KIN002")
    assert changed == {"r.urdf.xacro": XACRO.format(ARM + call.replace("lnk", "link"))}


def test_a_name_that_also_names_the_joint_is_advice(tmp_path: Path) -> None:
    arm = ARM.replace('name="hinge"', 'name="${parent}"')
    found, changed = fix(tmp_path, arm + '<xacro:arm parent="base_lnk" child="lever" top="1"/>', "KIN002")
    assert changed == {}
    assert [finding.code for finding in found.outcome.findings] == ["KIN002"]


def test_limits_of_a_call_are_swapped(tmp_path: Path) -> None:
    arm = (
        ARM.replace('lower="-1"', 'lower="${low}"')
        .replace("child top", "child low top")
        .replace('<dynamics damping="${top}"/>', "")
    )
    call = '<xacro:arm parent="base_link" child="lever" low="2" top="-1.50"/>'
    _, changed = fix(tmp_path, arm + call, "JNT005")
    assert changed == {
        "r.urdf.xacro": XACRO.format(arm + call.replace("-1.50", "@").replace("2", "-1.50").replace("@", "2"))
    }


def test_a_limit_that_is_the_damping_too_is_advice(tmp_path: Path) -> None:
    found, changed = fix(tmp_path, ARM + '<xacro:arm parent="base_link" child="lever" top="-1.5"/>', "JNT005 JNT011")
    assert changed == {}
    assert {finding.code for finding in found.outcome.findings} == {"JNT005", "JNT011"}


def test_a_property_is_repaired_and_keeps_its_notation(tmp_path: Path) -> None:
    body = (
        '<xacro:property name="damping" value=" -1.50e-3"/>\n<link name="a"/><link name="b"/>'
        '<joint name="j" type="continuous"><parent link="a"/><child link="b"/><dynamics damping="${damping}"/></joint>'
    )
    _, changed = fix(tmp_path, body, "JNT011")
    assert changed == {"r.urdf.xacro": XACRO.format(body.replace("-1.50e-3", "1.50e-3"))}


def test_a_default_of_a_macro_and_a_computed_value_are_advice(tmp_path: Path) -> None:
    joint = '<joint name="j" type="continuous"><parent link="a"/><child link="b"/><dynamics damping="{}"/></joint>'
    links = '<link name="a"/><link name="b"/>'
    macro = f'<xacro:macro name="m" params="d:=-1">{joint.format("${d}")}</xacro:macro><xacro:m/>'
    computed = '<xacro:property name="d" value="1"/>' + joint.format("${-d}")
    for body in (links + macro, links + computed):
        found, changed = fix(tmp_path, body, "JNT011")
        assert changed == {}
        assert [finding.code for finding in found.outcome.findings] == ["JNT011"]
