"""INR020: formulas of moments that are not those of one solid."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import cylinder, visual
from conftest import check_text
from hypothesis import given
from hypothesis import strategies as st

from urdfcheck.core import Finding
from urdfcheck.facts.inertials.formulas.moments import find_wrong_formula
from urdfcheck.facts.inertials.formulas.polynomials import parse_polynomial

BOX = ("m*(y*y+z*z)/12", "m*(x*x+z*z)/12", "m*(x*x+y*y)/12")
ROD = ("m*(3*r*r+h*h)/12", "m*(3*r*r+h*h)/12", "m*r*r/2")


def find(folder: Path, *moments: str, drawn: tuple[str, str] = ("", "")) -> list[Finding]:
    """``drawn``: the visuals of the two links."""
    ixx, iyy, izz = (f"${{{moment}}}" for moment in moments)
    text = f"""<robot name="r" xmlns:xacro="http://ros.org/wiki/xacro"><link name="base"/>
<xacro:macro name="part_inertia" params="m:=2 x:=0.3 y:=0.2 z:=0.1 r:=0.1 h:=0.4 w:=0.1 d:=0.2">
  <inertia ixx="{ixx}" ixy="0" ixz="0" iyy="{iyy}" iyz="0" izz="{izz}"/>
</xacro:macro>
<link name="a"><inertial><mass value="2"/><xacro:part_inertia/></inertial>{drawn[0]}</link>
<link name="b"><inertial><mass value="2"/><xacro:part_inertia/></inertial>{drawn[1]}</link>
<joint name="ja" type="fixed"><parent link="base"/><child link="a"/></joint>
<joint name="jb" type="fixed"><parent link="base"/><child link="b"/></joint></robot>"""
    return list(check_text(folder, text, "robot.urdf.xacro", codes={"INR020"}).findings)


@pytest.mark.parametrize(
    ("moments", "name", "expected"),
    [
        ((BOX[0], BOX[1], BOX[1]), "izz", "m*(x*x + y*y)/12"),
        ((BOX[1], BOX[1], BOX[2]), "ixx", "m*(y*y + z*z)/12"),
        (("m/12.0*(y**2+z**2)", "m/12*(x**2+z**2)", "0.0833*m*(x**2+z**2)"), "izz", "m*(x*x + y*y)/12"),
        ((ROD[0], ROD[1], "m*r*r/12"), "izz", "m*r*r/2"),
        ((ROD[0], ROD[1], "m*r/2"), "izz", "m*r*r/2"),
        ((ROD[0], ROD[2], "(m/12)*(r*r+h*h)"), "izz", "m*(3*r*r + h*h)/12"),
        ((ROD[0], "m*pow(r,2)/4", ROD[0]), "iyy", "m*r*r/2"),
    ],
)
def test_the_formula_that_does_not_belong_to_the_others_is_corrected(
    tmp_path: Path, moments: tuple[str, ...], name: str, expected: str
) -> None:
    (finding,) = find(tmp_path, *moments)
    assert (finding.message_id, finding.data["name"]) == ("one", name)
    assert [subject.partition("/")[0] for subject in finding.subjects] == ["link[a]", "link[b]"]
    assert finding.fix is not None
    assert [edit.replacement for edit in finding.fix.edits] == [f"${{{expected}}}"]


@pytest.mark.parametrize(
    ("moments", "message"),
    [
        ((ROD[0], ROD[0], ROD[0]), "all"),
        ((ROD[2], ROD[2], ROD[0]), "two"),
        (("m*(h*h+d*d)/12", "m*(w*w+h*h)/12", "m*(w*w+h*h)/12"), "two"),  # the names do not say which
    ],
)
def test_where_the_others_do_not_decide_nothing_is_edited(
    tmp_path: Path, moments: tuple[str, ...], message: str
) -> None:
    (finding,) = find(tmp_path, *moments)
    assert finding.message_id == message
    assert finding.fix is not None
    assert not finding.fix.edits


ABOUT_Y = visual(cylinder(0.1, 0.4), rpy="1.5708 0 0")
ABOUT_Z = visual(cylinder(0.1, 0.4))


@pytest.mark.parametrize(
    ("moments", "name", "expected"),
    [((ROD[2], ROD[2], ROD[0]), "ixx", "m*(3*r*r + h*h)/12"), ((ROD[0], ROD[0], ROD[0]), "iyy", "m*r*r/2")],
)
def test_the_axis_of_the_drawn_cylinder_decides(
    tmp_path: Path, moments: tuple[str, ...], name: str, expected: str
) -> None:
    (finding,) = find(tmp_path, *moments, drawn=(ABOUT_Y, ABOUT_Y))
    assert (finding.message_id, finding.data["name"], finding.data["expected"]) == ("one", name, expected)
    assert "drawn about y" in finding.message


@pytest.mark.parametrize("drawn", [(ABOUT_Y, ABOUT_Z), (ABOUT_Y, ""), (ABOUT_Z, ABOUT_Z)])
def test_cylinders_about_different_axes_decide_nothing(tmp_path: Path, drawn: tuple[str, str]) -> None:
    (finding,) = find(tmp_path, ROD[2], ROD[2], ROD[0], drawn=drawn)
    assert finding.message_id == "two"


@pytest.mark.parametrize(
    "moments",
    [
        BOX,
        (BOX[1], BOX[0], BOX[2]),  # the edges have other names for the axes
        ROD,
        (ROD[2], ROD[0], ROD[0]),
        ("m*(3*(r*r+w*w)+h*h)/12", "m*(3*(r*r+w*w)+h*h)/12", "m*(r*r+w*w)/2"),  # a tube
        ("2*m*r*r/5", "2*m*r*r/5", "2*m*r*r/5"),
        ("m*(w*w+h*h)/12", "m*(h*h+w*w)/12", "m*(w*w+w*w)/12"),  # a square bar
        ("m*(w*w+h*h)/12", "m*(w*w+h*h)/12", "m*(w*w+h*h)/12"),
        ("m*(y*y+0.01)/12", "m*(x*x+0.01)/12", "m*(x*x+0.01)/12"),  # numbers for lengths
        ("m*h*h/12", "m*h*h/12", "0.001"),
        ("m", "m", "m"),
        ("r*(3*r*r+h*h)/12 if m > 1 else 1", "m", "m"),
    ],
)
def test_formulas_of_sound_and_other_bodies_are_left_alone(tmp_path: Path, moments: tuple[str, ...]) -> None:
    assert not find(tmp_path, *moments)


@given(st.text(alphabet="mxyzr0123456789.+-*/() ePi_", max_size=60))
def test_any_text_is_a_polynomial_or_none(text: str) -> None:
    """Also `9**9**9`, divisions by zero and numbers out of range."""
    polynomial = parse_polynomial(text)
    if polynomial is not None:
        find_wrong_formula([polynomial] * 3)


@given(st.permutations(range(3)), st.sampled_from([BOX, ROD]), st.floats(0.1, 10))
def test_no_order_of_the_axes_and_no_factor_makes_a_formula_wrong(
    order: list[int], formulas: tuple[str, ...], factor: float
) -> None:
    moments = [parse_polynomial(f"{factor!r}*({formulas[index]})") for index in order]
    assert find_wrong_formula([moment for moment in moments if moment is not None]) is None
