"""INR019: the mass that a tensor is computed from, and the one beside it."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import check_text

from urdfcheck.core import Finding
from urdfcheck.run.shared_findings import merge_kinds

MACRO = """
<xacro:macro name="ball_inertia" params="{name} r:=0.1">
  <inertia ixx="${{0.4*{name}*r*r}}" ixy="0" ixz="0" iyy="${{0.4*{name}*r*r}}" iyz="0" izz="${{0.4*{name}*r*r}}"/>
</xacro:macro>
"""


def find(folder: Path, body: str, name: str = "m") -> list[Finding]:
    text = f'<robot name="r" xmlns:xacro="http://ros.org/wiki/xacro">{MACRO.format(name=name)}<link name="base"/>{body}</robot>'
    return list(check_text(folder, text, "robot.urdf.xacro", codes={"INR019"}).findings)


def ball(mass: str, given: str, *, link: str = "ball", name: str = "m") -> str:
    return (
        f'<link name="{link}"><inertial><mass value="{mass}"/><xacro:ball_inertia {name}="{given}"/></inertial></link>'
        f'<joint name="{link}_joint" type="fixed"><parent link="base"/><child link="{link}"/></joint>'
    )


@pytest.mark.parametrize("name", ["m", "mass", "m3", "ball_mass", "ballMass", "mass_left"])
def test_another_mass_than_the_one_beside_it_is_reported(tmp_path: Path, name: str) -> None:
    (finding,) = find(tmp_path, ball("0.2", "0.05", name=name), name)
    assert finding.headline == "ball: inertia computed with 0.05 kg, but mass 0.2 kg"
    assert finding.data["factor"] == 0.25
    assert [place.subject for place in finding.related] == [f"parameter[{name}]"]
    assert finding.fix is not None
    assert finding.fix.title == f"write the mass once: correct {name} in the call of the macro, or the <mass>"


@pytest.mark.parametrize(
    ("mass", "given", "name"),
    [
        ("0.2", "0.2", "m"),
        ("2.4", "2.404", "m"),  # rounded
        ("0.2", "0.05", "k"),  # not named as a mass
        ("0.2", "0.05", "mass_ixx"),  # a moment
        ("${2*whole}", "${whole}", "m"),  # the link's mass is computed from it: a part of the link
        ("${whole}", "${whole*0.5}", "m"),
    ],
)
def test_one_mass_is_not_reported(tmp_path: Path, mass: str, given: str, name: str) -> None:
    whole = '<xacro:property name="whole" value="3"/>'
    assert not find(tmp_path, whole + ball(mass, given, name=name), name)


def test_links_with_one_forgotten_property_are_one_finding(tmp_path: Path) -> None:
    wheels = '<xacro:property name="wheel_mass" value="0.05"/>' + "".join(
        ball("0.2", "${wheel_mass}", link=link) for link in ("left", "right")
    )
    (finding,) = merge_kinds(find(tmp_path, wheels))
    assert [subject.partition("/")[0] for subject in finding.subjects] == ["link[left]", "link[right]"]
    assert finding.fix is not None
    assert finding.fix.title.endswith(
        "correct wheel_mass or the <mass>, and use wheel_mass for both if it is meant for this part"
    )


@pytest.mark.parametrize(
    ("moment", "found"),
    [
        ("0.4*m*r*r", True),
        ("0.2*2*length_m*length_m/5", False),  # a length in metres
        ("0.4*density_of_mass*length_m*length_m*length_m*length_m*length_m", False),
        ("m*(r*r + 0.01)/12", True),
        ("m*m*r", False),  # no moment of inertia
    ],
)
def test_a_mass_multiplies_each_moment(tmp_path: Path, moment: str, found: bool) -> None:
    values = {"m": 0.05, "r": 0.1, "length_m": 0.3, "density_of_mass": 900}
    body = "".join(f'<xacro:property name="{name}" value="{value}"/>' for name, value in values.items())
    moments = " ".join(f'{name}="${{{moment}}}"' for name in ("ixx", "iyy", "izz"))
    text = (
        f'{body}<link name="ball"><inertial><mass value="0.2"/><inertia {moments} ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="j" type="fixed"><parent link="base"/><child link="ball"/></joint>'
    )
    assert bool(find(tmp_path, text)) == found


def test_a_tensor_of_several_masses_shows_no_mistake(tmp_path: Path) -> None:
    text = (
        '<xacro:property name="m1" value="1"/><xacro:property name="m2" value="2"/><link name="two"><inertial><mass value="3.1"/>'
        '<inertia ixx="${m1+m2}" ixy="0" ixz="0" iyy="${m1+m2}" iyz="0" izz="${m1+m2}"/></inertial></link>'
        '<joint name="j" type="fixed"><parent link="base"/><child link="two"/></joint>'
    )
    assert not find(tmp_path, text)
