"""SYM004: the drawings say how the inertials of a pair are related, not the numbers that agree best."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import box, find, inertial, joint, limit, link, robot, visual

from urdfcheck.core import Finding, Severity


def find_pair(
    folder: Path, drawn: tuple[tuple[str, str], ...], left: str, right: str, *, codes: str | set[str] = "SYM004"
) -> list[Finding]:
    """Check two arms that draw boxes (size, place), those of the right one mirrored in y."""
    parts = []
    for side, sign, numbers in (("left", 1.0, left), ("right", -1.0, right)):
        shapes = []
        for size, xyz in drawn:
            x, y, z = map(float, xyz.split())
            shapes.append(visual(box(size), xyz=f"{x} {sign * y} {z}"))
        parts += [
            link(f"{side}_arm", numbers, *shapes),
            joint(f"{side}_elbow", "torso", f"{side}_arm", limit(-1, 1), axis="0 1 0", xyz=f"0 {sign * 0.2} 0.3"),
        ]
    return find(folder, robot(link("torso"), *parts), codes)


FLAT = (("0.2 0.05 0.05", "0.1 0 0"), ("0.06 0.006 0.05", "0.05 0.026 0"))
ROUND = (("0.05 0.05 0.2", "0 0 -0.1"), ("0.06 0.006 0.05", "0.01 0.026 0"))


def test_products_that_were_not_mirrored_are_named_where_the_coms_are_mirrored_as_drawn(tmp_path: Path) -> None:
    sides = [
        inertial(1.2, com=com, ixx=0.00051, iyy=0.0042, izz=0.0043, ixy=0.00025)
        for com in ("0.098 0.002 0", "0.098 -0.002 0")
    ]
    (finding,) = find_pair(tmp_path, FLAT, *sides)
    assert "ixy 0.00025 instead of -0.00025" in finding.message
    assert "COM" not in finding.message


def find_turned(folder: Path, x: float) -> list[Finding]:
    sides = [
        inertial(1.2, com=com, ixx=0.0043, iyy=0.0042, izz=0.00051, ixy=0.00001)
        for com in (f"{x} 0.0002 -0.1", f"{-x} -0.0002 -0.1")
    ]
    return find_pair(folder, ROUND, *sides)


def test_half_a_turn_about_an_axis_may_be_right_where_the_drawing_is_mirrored(tmp_path: Path) -> None:
    (finding,) = find_turned(tmp_path, 0.005)
    assert finding.cause is not None
    assert (finding.cause.id, finding.severity) == ("half_turn", Severity.WARNING)
    assert "about z" in finding.cause.text
    assert finding.fix is not None
    assert "write" not in finding.fix.title


def test_half_a_turn_that_moves_the_com_by_less_than_a_millimetre_is_silent(tmp_path: Path) -> None:
    assert not find_turned(tmp_path, 0.0004)


def test_a_com_outside_its_drawing_that_the_other_side_repairs_is_reported_once(tmp_path: Path) -> None:
    sides = [inertial(1.2, com="0.05 0.08 0", ixx=0.0007, iyy=0.0011, izz=0.0012)] * 2
    drawn = (("0.1 0.06 0.05", "0.05 0.08 0"), ("0.02 0.06 0.03", "0.02 0.09 0.01"))
    findings = find_pair(tmp_path, drawn, *sides, codes={"SYM004", "INR006"})
    assert [(finding.code, finding.message_id) for finding in findings] == [("SYM004", "inertial")]
    assert "e-1" not in findings[0].message


def make_hips(*, place: str, rpy: str, knee: str) -> str:
    """Two legs; the right hip's roll joint is off, and its knee may turn back."""
    parts = ['<link name="base"/>']
    for side, y, at, turn, back in (("left", 0.1, "0.055 0.07 0", "0 0 0", "0 0 0"), ("right", -0.1, place, rpy, knee)):
        for part, mass in (("hip", 1.1), ("thigh", 2.2), ("shank", 1.7)):
            parts.append(
                f'<link name="{side}_{part}"><inertial><origin xyz="0 0 -0.1"/><mass value="{mass}"/>'
                '<inertia ixx="0.02" ixy="0" ixz="0" iyy="0.021" iyz="0" izz="0.003"/></inertial></link>'
            )
        for name, parent, child, xyz, angles, axis in (
            ("pitch", "base", f"{side}_hip", f"0 {y} 0", "0 0 0", "0 1 0"),
            ("roll", f"{side}_hip", f"{side}_thigh", at, turn, "1 0 0"),
            ("knee", f"{side}_thigh", f"{side}_shank", "0 0 -0.3", back, "0 1 0"),
        ):
            parts.append(
                f'<joint name="{side}_{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
                f'<origin xyz="{xyz}" rpy="{angles}"/><axis xyz="{axis}"/>'
                '<limit lower="-1" upper="1" effort="9" velocity="2"/></joint>'
            )
    return f'<robot name="legs">{"".join(parts)}</robot>'


@pytest.mark.parametrize(
    ("place", "knee", "said"),
    [
        ("0.055 -0.07 0", "0 0 0", "tilt"),
        ("0.0549931 -0.07 0.000872784", "0 0 0", "together"),
        ("0.055 -0.07 0", "0 0.0158737 0", "together"),
        ("0.055 -0.07 0", "0 0.0358737 0", "tilt"),
    ],
)
def test_a_frame_that_is_turned_with_its_part_is_not_set_straight_alone(
    tmp_path: Path, place: str, knee: str, said: str
) -> None:
    text = make_hips(place=place, rpy="0 -0.0158773 0", knee=knee)
    (finding,) = [one for one in find(tmp_path, text, "SYM001") if "right_roll" in one.location.subject]
    assert finding.message_id == said
    assert finding.fix is not None
    assert bool(finding.fix.edits) == (said == "tilt")
