"""Numbers of an inertial for which a comment gives a reason, and repairs that say what is known of the mistake only."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import box, collision, cylinder, find, inertial, joint, limit, link, mesh, robot, visual
from castings import CASTING, geometry, uniform, write_stl
from conftest import check_text

from urdfcheck.core import Severity

STABLE = "<!-- to stabilize the simulation -->"


def make_chain(second: str, *, base: str = "", third: str = "") -> str:
    parts = [
        link("base", base or inertial(1, 0.01)),
        link("part", second),
        joint("j", "base", "part", kind="continuous"),
    ]
    if third:
        parts += [link("hand", third), joint("k", "part", "hand", kind="continuous")]
    return robot(*parts)


def say(inertial_text: str, comment: str, *, before: bool = False) -> str:
    return comment + inertial_text if before else inertial_text.replace("</inertial>", f"{comment}</inertial>")


@pytest.mark.parametrize("before", [False, True])
@pytest.mark.parametrize(
    ("comment", "message"),
    [
        (STABLE, "chosen"),
        ("<!-- MUST be non zero or the link is pruned -->", "chosen"),
        ("<!-- avoids jitter -->", "chosen"),
        ("<!-- The following are not reliable values, and should not be used for modeling -->", "chosen"),
        ("<!-- unreliable, from a supplier -->", "chosen"),
        ("<!-- reliable values of the data sheet -->", "placeholder"),
        ("<!-- dummy values -->", "placeholder"),
        ("<!-- needed for Gazebo -->", "placeholder"),
        ("", "placeholder"),
    ],
)
def test_a_placeholder_with_a_reason_was_chosen(tmp_path: Path, comment: str, message: str, before: bool) -> None:
    part = say(inertial(0.014, 0.001), comment, before=before) + visual(box("0.03 0.03 0.03"))
    (finding,) = find(tmp_path, make_chain(part), "INR007")
    assert finding.message_id == message
    assert (finding.severity is Severity.INFO) == (message == "chosen")


@pytest.mark.parametrize(
    ("comment", "message"),
    [
        ("<!-- Dummy link as place holder for the thruster frame -->", "chosen"),
        ("<!-- link of the thruster -->", "placeholder"),
        ("<!-- dummy values -->", "placeholder"),
    ],
)
def test_a_link_that_is_called_a_dummy_link_has_chosen_numbers(tmp_path: Path, comment: str, message: str) -> None:
    text = make_chain(inertial(0.014, 0.001) + visual(box("0.03 0.03 0.03")))
    (finding,) = find(tmp_path, text.replace('<link name="part">', f'{comment}<link name="part">'), "INR007")
    assert finding.message_id == message


@pytest.mark.parametrize(
    ("room", "moment", "expected"),
    [
        (0, 1.7e-12, ("held", Severity.INFO)),
        (0, 1e-16, ("point", Severity.INFO)),  # MuJoCo refuses it
        (1, 1.7e-12, ("point", Severity.WARNING)),
    ],
)
def test_a_point_on_a_joint_without_room_marks_a_place(
    tmp_path: Path, room: float, moment: float, expected: tuple[str, Severity]
) -> None:
    parts = [link("base", inertial(10, 0.5)), link("optical", inertial(0.001, moment))]
    parts.append(joint("j", "base", "optical", limit(0, room, effort=0, velocity=0), kind="revolute"))
    (finding,) = find(tmp_path, robot(*parts), "INR012")
    assert (finding.message_id, finding.severity) == expected


@pytest.mark.parametrize(("name", "found"), [("floor", False), ("wallet", True)])
def test_a_room_is_scenery(tmp_path: Path, name: str, found: bool) -> None:
    drawn = inertial(2000, 1) + visual(box("4 4 0.01"))
    text = robot(link(name, drawn), link("side", drawn), joint("j", name, "side", kind="fixed"))
    assert bool(find(tmp_path, text, "INR007")) == found


@pytest.mark.parametrize(("comment", "severity"), [(STABLE, Severity.INFO), ("", Severity.WARNING)])
def test_a_vast_spread_with_a_reason_is_an_info(tmp_path: Path, comment: str, severity: Severity) -> None:
    parts = [link("base", say(inertial(28.5, 1000, izz="4.14"), comment))]
    for i, place in enumerate(("0.5 0 0", "-0.5 0 0", "0 0.3 0")):
        parts += [link(f"l{i}", inertial(0.1, 0.001)), joint(f"j{i}", "base", f"l{i}", kind="continuous", xyz=place)]
    (finding,) = find(tmp_path, robot(*parts), "INR018")
    assert (finding.message_id, finding.severity) == ("spread", severity)


def test_a_comment_of_another_link_gives_no_reason(tmp_path: Path) -> None:
    part = inertial(0.014, 0.001) + visual(box("0.03 0.03 0.03"))
    (finding,) = find(tmp_path, make_chain(part, base=say(inertial(1, 0.01), STABLE)), "INR007")
    assert finding.message_id == "placeholder"


@pytest.mark.parametrize(
    ("comment", "found"), [("<!-- mass hack, fixes the drift of the odometry -->", False), ("", True)]
)
def test_a_mass_with_a_reason_may_be_too_great(tmp_path: Path, comment: str, found: bool) -> None:
    wheel = say(inertial(10.035, 0.0123, iyy="0.0234"), comment) + visual(box("0.05 0.04 0.04"))
    assert bool(find(tmp_path, make_chain(wheel), "INR010")) == found


@pytest.mark.parametrize(("comment", "found"), [("<!-- Null inertial element -->", False), ("", True)])
def test_a_carrier_with_a_reason_may_be_light(tmp_path: Path, comment: str, found: bool) -> None:
    text = make_chain(say(inertial(0.001, 1e-6), comment, before=True), third=inertial(2.9, 0.01))
    assert bool(find(tmp_path, text, "INR011")) == found


def test_a_mesh_in_millimetres_is_what_is_wrong_of_a_light_link(tmp_path: Path) -> None:
    write_stl(tmp_path / "part.stl", CASTING)
    numbers = uniform(geometry(CASTING).solid)
    drawn = visual(mesh("part.stl", scale="1000 1000 1000"))
    found = find(tmp_path, make_chain(inertial(numbers.mass, 0.001) + drawn), "INR010")
    assert [finding.message_id for finding in found] == ["light"]
    assert found[0].fix is not None
    assert found[0].fix.title.startswith("give the mesh the scale of its unit: drawn a thousandth as large")


TURTLEBOT = {"ixx": "2.2124416e-03", "iyy": "2.1193702e-03", "izz": "2.0064271e-03"}


@pytest.mark.parametrize(
    ("izz", "drawn", "message"),
    [
        ("2.0064271e-03", box("0.3 0.2 0.1"), "published"),
        ("2.0e-03", box("0.3 0.2 0.1"), ""),
        ("2.0064271e-03", box("0.15 0.17 0.17"), ""),
    ],
)
def test_the_numbers_of_a_published_part_are_known(tmp_path: Path, izz: str, drawn: str, message: str) -> None:
    text = make_chain(inertial("8.2573504e-01", **TURTLEBOT | {"izz": izz}) + visual(drawn))
    found = find(tmp_path, text, "INR009")
    assert [finding.message_id for finding in found if finding.message_id == "published"] == [message] * bool(message)
    assert all("the base of TurtleBot3 Burger" in finding.headline for finding in found if message)


WHEEL = """<robot name="r" xmlns:xacro="http://ros.org/wiki/xacro"><link name="base"/>
{above}<xacro:macro name="other"><link/></xacro:macro>
<xacro:macro name="wheel_inertial" params="m r h"><inertial><mass value="${{m}}"/>
<inertia ixx="${{m*(3*r*r+h*h)/12}}" ixy="0" ixz="0" iyy="${{m*(3*r*r+h*h)/12}}" iyz="0" izz="${{m*r/2}}"/>{below}
</inertial></xacro:macro>
<link name="wheel"><xacro:wheel_inertial m="2" r="0.1" h="0.02"/>
<visual><geometry><cylinder radius="0.1" length="0.02"/></geometry></visual></link>
<joint name="j" type="continuous"><parent link="base"/><child link="wheel"/><axis xyz="0 0 1"/></joint></robot>"""
EXPLODES = "<!-- izz should have r squared, but this makes the robot\n  explode -->"


@pytest.mark.parametrize(
    ("above", "below", "expected"),
    [
        ("", EXPLODES, "chosen"),
        ("", "<!-- izz should have r squared -->", "one"),
        ("<!-- Macros of inertias. Gazebo cannot handle the realistic values. -->", "", "chosen"),
        ("<!-- Gazebo cannot handle the realistic values. -->", "", "one"),  # of that macro
        ("<!-- Macros of inertias for Gazebo. -->", "", "one"),
    ],
)
def test_a_formula_with_a_reason_was_chosen(tmp_path: Path, above: str, below: str, expected: str) -> None:
    """But no reason makes a tensor possible."""
    text = WHEEL.format(above=above, below=below)
    findings = check_text(tmp_path, text, "r.urdf.xacro", codes={"INR003", "INR020"}).findings
    found = {finding.code: finding for finding in findings}
    assert found["INR020"].message_id == expected
    assert (found["INR020"].severity is Severity.INFO) == (expected == "chosen")
    assert (found["INR003"].message_id, found["INR003"].severity) == ("violated", Severity.ERROR)


def test_a_wrong_formula_of_a_light_part_is_one_finding(tmp_path: Path) -> None:
    moments = (("ixx", "y*y+z*z"), ("iyy", "x*x+z*z"), ("izz", "x*x+z*z"))
    tensor = " ".join(f'{name}="${{m*({formula})/12}}"' for name, formula in moments)
    text = f"""<robot name="r" xmlns:xacro="http://ros.org/wiki/xacro">
<link name="base"><inertial><mass value="10"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
<xacro:macro name="box_inertial" params="m x y z"><inertial><mass value="${{m}}"/>
<inertia {tensor} ixy="0" ixz="0" iyz="0"/></inertial></xacro:macro>
<link name="camera"><xacro:box_inertial m="0.001" x="0.025" y="0.09" z="0.025"/></link>
<joint name="j" type="fixed"><parent link="base"/><child link="camera"/></joint></robot>"""
    findings = check_text(tmp_path, text, "r.urdf.xacro", codes={"INR003", "INR020"}).findings
    assert [finding.code for finding in findings] == ["INR020"]


CAD = ("-0.00015557711", "-0.0003643398", "-0.0067306301")
NONE = ("0", "0", "0")


@pytest.mark.parametrize(
    ("products", "place", "factor", "severity"),
    [
        (CAD, 0.3, 1, Severity.INFO),
        (NONE, 0.3, 1, Severity.WARNING),  # perhaps computed from another shape
        (("-0.0001", "-0.0003", "-0.006"), 0.3, 1, Severity.WARNING),
        (CAD, 0.3, 20, Severity.WARNING),  # too much for what is not drawn
        (NONE, 0.401, 0.4, Severity.INFO),  # the cylinder begins 1.6 mm above the COM
        (NONE, 0.425, 0.4, Severity.WARNING),  # 26 mm: the COM may be wrong
    ],
)
def test_a_drawing_simpler_than_the_part_of_cad_is_a_note(
    tmp_path: Path, products: tuple[str, str, str], place: float, factor: float, severity: Severity
) -> None:
    moments = [f"{factor * value:.8g}" for value in (0.24731453, 0.2306736, 0.029585235)]
    names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    tensor = " ".join(f'{name}="{value}"' for name, value in zip(names, (*moments, *products), strict=True))
    numbers = f'<origin xyz="-0.00051024 0.00474429 0.27441632"/><mass value="5.7271652"/><inertia {tensor}/>'
    drawn = visual(cylinder(0.06, 0.25), xyz=f"0 0 {place}")
    (finding,) = find(tmp_path, make_chain(f"<inertial>{numbers}</inertial>{drawn}"), "INR005")
    assert finding.severity is severity


@pytest.mark.parametrize(
    ("factor", "value", "message"),
    [
        ("rotor_velocity_slowdown_sim", 10, "chosen"),
        ("inertia_scaling", 10, "chosen"),
        ("inertia_scaling", 1, "exceeds"),
        ("radius_scaling", 10, "exceeds"),
        ("inertia_scaling", 10000, "exceeds"),  # an error
    ],
)
def test_a_tensor_that_is_scaled_for_a_simulation_was_chosen(
    tmp_path: Path, factor: str, value: float, message: str
) -> None:
    moments = [f"${{0.005*{n}*{10 / value if value == 1 else 1}*{factor}}}" for n in (0.00002, 0.0065, 0.0066)]
    tensor = "".join(f' {name}="{moment}"' for name, moment in zip(("ixx", "iyy", "izz"), moments, strict=True))
    part = f'<inertial><mass value="0.005"/><inertia{tensor} ixy="0" ixz="0" iyz="0"/></inertial>'
    scale = f'<xacro:property name="{factor}" value="{value}"/>'
    text = make_chain(part + visual(box("0.28 0.015 0.003"))).replace("<link", f"{scale}<link", 1)
    text = text.replace("<robot", '<robot xmlns:xacro="http://ros.org/wiki/xacro"', 1)
    (finding,) = find(tmp_path, text, "INR005", name="r.urdf.xacro")
    assert finding.message_id == message


@pytest.mark.parametrize("by_argument", [False, True])
def test_zeros_of_an_argument_are_no_rounding(tmp_path: Path, by_argument: bool) -> None:
    moment = "$(arg J1)" if by_argument else "0.0"
    part = f'<inertial><mass value="0.1"/><inertia ixx="1e-6" iyy="{moment}" izz="{moment}" ixy="0" ixz="0" iyz="0"/></inertial>'
    text = make_chain(part).replace("<link", '<xacro:arg name="J1" default="0.0"/><link', 1)
    text = text.replace("<robot", '<robot xmlns:xacro="http://ros.org/wiki/xacro"', 1)
    (finding,) = find(tmp_path, text, "INR003", name="r.urdf.xacro")
    assert finding.fix is not None
    assert (finding.cause is None) == by_argument
    assert ("iyy, izz are 0, as if never filled in (argument J1)" in finding.message) == by_argument
    assert ("or give argument J1 another value than 0" in finding.fix.title) == by_argument


CAMERA = '<gazebo reference="camera"><sensor name="s" type="camera"><plugin name="c" filename="libcamera.so"/></sensor></gazebo>'


PUSHED = CAMERA + '<gazebo><plugin name="m" filename="libmove.so"/></gazebo>'


@pytest.mark.parametrize(
    ("more", "moment", "kind", "expected"),
    [
        (CAMERA, 3, "fixed", ("stand", Severity.INFO)),
        (CAMERA, 100, "fixed", ("placeholder", Severity.WARNING)),  # a body so heavy to turn behaves oddly anywhere
        (CAMERA, 3, "continuous", ("placeholder", Severity.WARNING)),
        (PUSHED, 3, "fixed", ("placeholder", Severity.WARNING)),
        ("", 3, "fixed", ("placeholder", Severity.WARNING)),
    ],
)
def test_the_stand_of_sensors_needs_no_inertia(
    tmp_path: Path, more: str, moment: float, kind: str, expected: tuple[str, Severity]
) -> None:
    stand = link("camera", inertial(10, moment), *(f(box("0.5 0.5 0.1")) for f in (visual, collision)))
    text = robot(link("base_footprint"), stand, joint("j", "base_footprint", "camera", kind=kind), more)
    (finding,) = find(tmp_path, text, "INR007")
    assert (finding.message_id, finding.severity) == expected


@pytest.mark.parametrize(
    ("more", "severity"), [(CAMERA, Severity.INFO), (PUSHED, Severity.WARNING), ("", Severity.WARNING)]
)
def test_a_camera_alone_may_have_a_token_mass(tmp_path: Path, more: str, severity: Severity) -> None:
    text = robot(link("camera", inertial(1e-5, 1e-6), visual(box("0.1 0.1 0.1"))), more)
    (finding,) = find(tmp_path, text, "INR015")
    assert finding.severity is severity


@pytest.mark.parametrize(("added", "severity"), [("", Severity.INFO), ('<link name="arm"/>', Severity.WARNING)])
def test_a_file_that_only_includes_a_camera_does_not_move_it(tmp_path: Path, added: str, severity: Severity) -> None:
    camera = robot(link("camera", inertial(1e-5, 1e-6), visual(box("0.1 0.1 0.1"))), CAMERA, xacro=True)
    (tmp_path / "package.xml").write_text('<package format="3"><name>p</name></package>', encoding="utf-8")
    user = f'<xacro:include filename="$(find other_name)/camera.urdf.xacro"/>{added}<gazebo><static>false</static></gazebo>'
    (tmp_path / "user.urdf.xacro").write_text(robot(user, xacro=True), encoding="utf-8")
    findings = check_text(tmp_path, camera, "camera.urdf.xacro", codes={"INR015"}).findings
    assert [one.severity for one in findings if one.code == "INR015"] == [severity]
