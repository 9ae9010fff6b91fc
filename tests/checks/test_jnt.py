"""Joints: where the JNT rules begin and end, and what their repairs write."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from conftest import check_text

from urdfcheck.core import Finding, Severity


def joint(inner: str = "", kind: str = "revolute", name: str = "j", child: str = "b") -> str:
    return f'<joint name="{name}" type="{kind}"><parent link="a"/><child link="{child}"/>{inner}</joint>'


def robot(*joints: str, links: str = "") -> str:
    return f'<robot name="r"><link name="a"/><link name="b"/><link name="c"/>{links}{"".join(joints)}</robot>'


def found(folder: Path, text: str, code: str, name: str = "robot.urdf") -> tuple[Finding, ...]:
    run = check_text(folder, text, name, codes={code})
    assert not run.failures
    return run.findings


LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'


@pytest.mark.parametrize(("axis", "zero"), [("0 0 0", True), ("0 0 1e-17", True), ("0 0 1e-6", False)])
def test_an_axis_of_export_noise_is_zero(tmp_path: Path, axis: str, zero: bool) -> None:
    assert bool(found(tmp_path, robot(joint(f'<axis xyz="{axis}"/>{LIMIT}')), "JNT001")) == zero


@pytest.mark.parametrize("kind", ["fixed", "floating"])
def test_joints_without_an_axis_may_have_a_zero_one(tmp_path: Path, kind: str) -> None:
    assert not found(tmp_path, robot(joint('<axis xyz="0 0 0"/>', kind)), "JNT001")


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
    findings = found(tmp_path, robot(joint(f'<axis xyz="{axis}"/>{LIMIT}')), "JNT002")
    assert [f.severity for f in findings] == ([] if severity is None else [severity])


def test_the_normalised_axis_is_written_where_the_axis_is_literal(tmp_path: Path) -> None:
    (finding,) = found(tmp_path, robot(joint(f'<axis xyz="0 3 -4"/>{LIMIT}')), "JNT002")
    assert finding.fix is not None
    (edit,) = finding.fix.edits
    assert [float(w) for w in edit.replacement.split()] == pytest.approx([0, 0.6, -0.8])
    assert math.hypot(*map(float, edit.replacement.split())) == pytest.approx(1, abs=1e-15)


def test_a_computed_axis_gets_advice_only(tmp_path: Path) -> None:
    text = robot(joint(f'<axis xyz="${{1 + 1}} 0 0"/>{LIMIT}'))
    (finding,) = found(tmp_path, text, "JNT002", "robot.xacro")
    assert finding.fix is not None
    assert not finding.fix.edits


def test_one_of_lower_and_upper_is_enough(tmp_path: Path) -> None:
    assert not found(tmp_path, robot(joint('<limit lower="-1" effort="1" velocity="1"/>')), "JNT004")


def test_continuous_joints_need_no_limit(tmp_path: Path) -> None:
    assert not found(tmp_path, robot(joint(kind="continuous")), "JNT004")


def test_limits_absent_altogether_are_not_reported_as_equal(tmp_path: Path) -> None:
    assert not found(tmp_path, robot(joint('<limit effort="1" velocity="1"/>')), "JNT005")


def test_a_lower_limit_above_the_default_upper_one_is_inverted(tmp_path: Path) -> None:
    (finding,) = found(tmp_path, robot(joint('<limit lower="1" effort="1" velocity="1"/>')), "JNT005")
    assert (finding.message_id, finding.severity) == ("inverted", Severity.ERROR)
    assert finding.fix is not None
    assert not finding.fix.edits, "there is no second value to exchange it with"


def test_inverted_limits_are_exchanged_as_typed(tmp_path: Path) -> None:
    (finding,) = found(tmp_path, robot(joint('<limit lower="1.570" upper="-0.5" effort="1" velocity="1"/>')), "JNT005")
    assert finding.fix is not None
    assert [(e.expected, e.replacement) for e in finding.fix.edits] == [("1.570", "-0.5"), ("-0.5", "1.570")]


def test_joints_locked_alike_are_one_finding_with_every_subject(tmp_path: Path) -> None:
    locked = '<limit lower="0" upper="0" effort="1" velocity="1"/>'
    (finding,) = found(tmp_path, robot(joint(locked), joint(locked, name="k", child="c")), "JNT005")
    assert finding.severity == Severity.WARNING
    assert finding.subjects == ("joint[j]/limit", "joint[k]/limit")


@pytest.mark.parametrize("code", ["JNT005", "JNT007"])
def test_a_limit_that_a_macro_makes_twice_is_one_place(tmp_path: Path, code: str) -> None:
    made = joint('<limit lower="0" upper="0" effort="0" velocity="1"/>', name="${n}", child="${c}")
    text = robot(
        f'<xacro:macro name="m" params="n c">{made}</xacro:macro><xacro:m n="j" c="b"/><xacro:m n="k" c="c"/>'
    ).replace("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ')
    (finding,) = found(tmp_path, text, code, "robot.xacro")
    assert len(finding.subjects) == 2
    assert not finding.related


def test_missing_effort_is_an_error_on_any_joint_with_a_limit(tmp_path: Path) -> None:
    (finding,) = found(tmp_path, robot(joint('<limit lower="0" upper="1"/>', "fixed")), "JNT007")
    assert (finding.message_id, finding.severity) == ("missing", Severity.ERROR)
    assert "effort and velocity" in finding.message


def test_zero_effort_of_all_joints_is_one_finding(tmp_path: Path) -> None:
    idle = '<limit lower="0" upper="1" effort="0" velocity="1"/>'
    (finding,) = found(tmp_path, robot(joint(idle), joint(idle, name="k", child="c")), "JNT007")
    assert finding.severity == Severity.WARNING
    assert finding.subjects == ("joint[j]/limit@effort", "joint[k]/limit@effort")


def test_a_followers_effort_may_be_zero(tmp_path: Path) -> None:
    follower = '<limit lower="0" upper="1" effort="0" velocity="1"/><mimic joint="k"/>'
    assert not found(tmp_path, robot(joint(follower), joint(LIMIT, name="k", child="c")), "JNT007")


def follows(leader: str, rest: str = "", limit: str = LIMIT) -> str:
    return f'{limit}<mimic joint="{leader}" {rest}/>'


def test_a_joint_that_follows_itself(tmp_path: Path) -> None:
    assert [f.message_id for f in found(tmp_path, robot(joint(follows("j"))), "JNT009")] == ["itself"]


def test_a_cycle_is_reported_once(tmp_path: Path) -> None:
    (finding,) = found(tmp_path, robot(joint(follows("k")), joint(follows("j"), name="k", child="c")), "JNT009")
    assert finding.message_id == "cycle"
    assert "j → k → j" in finding.message


def test_a_joint_that_follows_into_a_cycle_is_not_part_of_it(tmp_path: Path) -> None:
    text = robot(joint(follows("j")), joint(follows("j"), name="k", child="c"))
    assert [f.subjects for f in found(tmp_path, text, "JNT009")] == [("joint[j]/mimic@joint",)]


def test_following_a_fixed_joint(tmp_path: Path) -> None:
    text = robot(joint(follows("k")), joint(kind="fixed", name="k", child="c"))
    assert [f.message_id for f in found(tmp_path, text, "JNT009")] == ["fixed"]


@pytest.mark.parametrize(("multiplier", "leaves"), [("1", False), ("-1", False), ("1.0009", False), ("1.01", True)])
def test_a_follower_stays_within_its_limits(tmp_path: Path, multiplier: str, leaves: bool) -> None:
    text = robot(joint(follows("k", f'multiplier="{multiplier}"')), joint(LIMIT, name="k", child="c"))
    findings = found(tmp_path, text, "JNT009")
    assert bool(findings) == leaves
    assert all(f.severity == Severity.WARNING for f in findings)


def origin(rpy: str, xyz: str = "0 0 0") -> str:
    return f'<origin xyz="{xyz}" rpy="{rpy}"/>{LIMIT}'


@pytest.mark.parametrize("rpy", ["0 0 3.14159", "-3.1416 0 0", "0 1.57 0", "0 0 0.785", "1.0472 0 0", "0 0 1.57075"])
def test_near_misses(tmp_path: Path, rpy: str) -> None:
    assert len(found(tmp_path, robot(joint(origin(rpy))), "JNT013")) == 1


@pytest.mark.parametrize("rpy", ["0 0 3.141592653589793", "0 0 1.570796", "0.79 0 0", "0 0 3", "0.25 0.52 0.3"])
def test_full_digits_and_ordinary_angles_are_no_near_misses(tmp_path: Path, rpy: str) -> None:
    assert not found(tmp_path, robot(joint(origin(rpy))), "JNT013")


def test_two_constants_in_one_attribute_are_two_findings_and_each_edits_its_word(tmp_path: Path) -> None:
    findings = found(tmp_path, robot(joint(origin("1.57 0 -3.14"))), "JNT013")
    edits = [e for f in findings if f.fix is not None for e in f.fix.edits]
    assert [(e.expected, float(e.replacement)) for e in edits] == [("1.57", math.pi / 2), ("-3.14", -math.pi)]


def test_in_xacro_the_constant_is_written_as_an_expression_and_expressions_are_left_alone(tmp_path: Path) -> None:
    (finding,) = found(tmp_path, robot(joint(origin("${2 * 1.57} 0 -1.5708"))), "JNT013", "robot.xacro")
    assert finding.fix is not None
    assert [(e.expected, e.replacement) for e in finding.fix.edits] == [("-1.5708", "${-pi/2}")]


def test_a_sibling_with_all_digits_is_named(tmp_path: Path) -> None:
    text = robot(joint(origin("0 0 3.1416")), joint(origin("0 0 -3.14159265358979"), name="k", child="c"))
    (finding,) = found(tmp_path, text, "JNT013")
    assert finding.message_id == "mixed"
    assert "joint k" in finding.message
    assert len(finding.related) == 1


def test_all_spellings_of_a_constant_are_one_finding_at_the_coarsest(tmp_path: Path) -> None:
    text = robot(joint(origin("1.5708 0 -1.5708")), joint(origin("-1.57 0 1.570796"), name="k", child="c"))
    (finding,) = found(tmp_path, text, "JNT013")
    assert (finding.message_id, finding.location.subject) == ("mixed", "joint[k]/origin@rpy")
    assert "`1.57` (joint k, off by 0.8 mm/m), `1.5708` (2 times, off by 3.7 µm/m)" in finding.message
    assert finding.fix is not None
    assert [(e.expected, float(e.replacement)) for e in finding.fix.edits] == [
        ("-1.57", -math.pi / 2),
        ("1.5708", math.pi / 2),
        ("-1.5708", -math.pi / 2),
    ]


def test_an_expression_is_a_spelling_with_all_digits(tmp_path: Path) -> None:
    text = robot(joint(origin("1.5708 0 0")), joint(origin("${-pi/2} 0 0"), name="k", child="c"))
    (finding,) = found(tmp_path, text, "JNT013", "robot.xacro")
    assert finding.message_id == "mixed"
    assert "`${-pi/2}` (joint k, exact)" in finding.message


def test_zeros_at_the_end_are_no_other_spelling(tmp_path: Path) -> None:
    (finding,) = found(tmp_path, robot(joint(origin("1.570 0 -1.57"))), "JNT013")
    assert finding.message_id == "rounded"
    assert "typed 2 times" in finding.message


def test_a_constant_with_all_digits_alone_is_no_finding(tmp_path: Path) -> None:
    text = robot(joint(origin("1.5707963268 0 0")), joint(origin("1.5707963267948966 0 0"), name="k", child="c"))
    assert not found(tmp_path, text, "JNT013")


def drawn(rpy: str) -> str:
    return f'<link name="d"><visual><origin rpy="{rpy}"/><geometry><box size="1 1 1"/></geometry></visual></link>'


@pytest.mark.parametrize(
    ("text", "severity"),
    [
        (robot(joint(origin("1.57 0 0"))), Severity.WARNING),
        (robot(joint(origin("1.5707 0 0"))), Severity.INFO),
        (robot(links=drawn("1.57 0 0")), Severity.INFO),
        (robot(joint(origin("1.5708 0 0")), links=drawn("1.57 0 0")), Severity.INFO),
    ],
)
def test_a_tenth_of_a_millimetre_per_metre_matters_where_a_link_is_placed(
    tmp_path: Path, text: str, severity: Severity
) -> None:
    (finding,) = found(tmp_path, text, "JNT013")
    assert finding.severity == severity


@pytest.mark.parametrize(("x", "noise"), [("1e-17", True), ("-9e-10", True), ("1e-6", False), ("0", False)])
def test_noise_is_below_a_nanometre(tmp_path: Path, x: str, noise: bool) -> None:
    assert bool(found(tmp_path, robot(joint(origin("0 0 0", f"{x} 0 0"))), "JNT014")) == noise


def test_all_noise_of_a_file_is_one_finding_and_is_replaced_by_zeros(tmp_path: Path) -> None:
    shape = '<visual><origin xyz="1e-18 0.1 -2E-20" rpy="1e-16 0 0"/><geometry><sphere radius="1"/></geometry></visual>'
    (finding,) = found(tmp_path, robot(joint(origin("0 0 3e-14")), links=f'<link name="d">{shape}</link>'), "JNT014")
    assert finding.fix is not None
    assert [e.expected for e in finding.fix.edits] == ["1e-18", "-2E-20", "1e-16", "3e-14"]
    assert {e.replacement for e in finding.fix.edits} == {"0"}
    assert "at most `3e-14` (rad), in the origins and axes of d, j" in finding.message


@pytest.mark.parametrize(("axis", "noise"), [("6e-17 1 0", 1), ("1e-8 1 0", 0), ("0 1e-17 0", 0), ("0 1 0", 0)])
def test_an_axis_that_is_noise_beside_its_length(tmp_path: Path, axis: str, noise: int) -> None:
    assert len(found(tmp_path, robot(joint(f'<axis xyz="{axis}"/>{LIMIT}')), "JNT014")) == noise


def test_what_an_expression_leaves_of_zero_was_not_typed(tmp_path: Path) -> None:
    assert not found(tmp_path, robot(joint(origin("0 0 0", "${cos(pi/2)} 0 0"))), "JNT014", "robot.xacro")


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
    assert bool(found(tmp_path, robot(joint(origin(rpy) + '<axis xyz="0 1 0"/>')), "JNT016")) == shifted


def test_the_shift_is_signed_about_the_axis(tmp_path: Path) -> None:
    (finding,) = found(tmp_path, robot(joint(origin("0 -0.75239 0") + '<axis xyz="0 -1 0"/>')), "JNT016")
    assert finding.data["degrees"] == pytest.approx(43.1088, abs=1e-4)


def test_a_joint_that_cannot_turn_has_no_zero(tmp_path: Path) -> None:
    locked = '<limit lower="0" upper="0" effort="1" velocity="1"/>'
    text = robot(joint(f'<origin rpy="0 -0.75239 0"/><axis xyz="0 1 0"/>{locked}'))
    assert not found(tmp_path, text, "JNT016")


def turning(child: str, more: str = "") -> str:
    """A joint without limits whose zero is shifted, and what it turns about y."""
    axle = joint('<origin rpy="0 -0.75239 0"/><axis xyz="0 1 0"/>', "continuous")
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
    assert bool(found(tmp_path, turning(child), "JNT016")) == shows


def test_the_zero_of_an_endless_joint_matters_where_it_carries_another(tmp_path: Path) -> None:
    next_one = '<link name="c"/><joint name="k" type="continuous"><parent link="b"/><child link="c"/></joint>'
    assert found(tmp_path, turning(ROUND, next_one), "JNT016")


def test_a_turn_about_a_slider_is_no_shift(tmp_path: Path) -> None:
    text = robot(joint(origin("0 -0.75239 0") + '<axis xyz="0 1 0"/>', "prismatic"))
    assert not found(tmp_path, text, "JNT016")
