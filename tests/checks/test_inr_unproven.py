"""Inertials: no cause, number or edit that the numbers do not prove."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from builders import arm_on_base, box, cylinder, find, inertial, joint, link, mesh, robot, sphere, visual

from urdfcheck.core import Finding, Severity
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial, VisualGeometry
from urdfcheck.facts.inertials.diagnosis import diagnose_inertial
from urdfcheck.facts.inertials.inertia_tensor import make_cylinder_solid
from urdfcheck.facts.inertials.mistakes.file_habits import Habit
from urdfcheck.facts.mesh.topology import label_bodies, label_components

ROD = visual(cylinder(0.025, 0.43))
MACRO = (
    '<xacro:macro name="tensor" params="m x y z"><inertia ixx="${m*(y*y+z*z)/12}" ixy="0" ixz="0" '
    'iyy="${m*(x*x+z*z)/12}" iyz="0" izz="${m*(x*x+y*y)/12}"/></xacro:macro>'
)


def one(folder: Path, text: str | dict[str, str], codes: str | set[str], name: str = "robot.urdf") -> Finding:
    (finding,) = find(folder, text, codes, name=name)
    return finding


def write_box(size: tuple[float, float, float], place: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> str:
    """Return a box as an ASCII STL."""
    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]) - 0.5
    points = corners * size + place
    quads = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    faces = [(a, *pair) for a, b, c, d in quads for pair in ((b, c), (c, d))]
    lines = [
        "facet normal 0 0 0\nouter loop\n"
        + "".join("vertex {:.9g} {:.9g} {:.9g}\n".format(*points[i]) for i in face)
        + "endloop\nendfacet"
        for face in faces
    ]
    return "\n".join(("solid box", *lines, "endsolid box"))


# -- rounding, formulas and masses --------------------------------------------------------------------------------------


def test_the_part_s_own_numbers_with_one_digit_are_no_other_mass(tmp_path: Path) -> None:
    # 0.0545 and 0.00109; in one ratio to 0.05 and 0.001.
    assert find(tmp_path, arm_on_base(inertial(3.5, ixx=0.05, iyy=0.05, izz=0.001), ROD), {"INR009"}) == []


def test_the_part_s_own_numbers_with_two_decimals_are_no_other_formula(tmp_path: Path) -> None:
    # 0.1209 and 0.0056: a thin-walled tube has 0.0112.
    text = arm_on_base(inertial(7, ixx=0.12, iyy=0.12, izz=0.01), visual(cylinder(0.04, 0.45)))
    finding = one(tmp_path, text, "INR009")
    assert finding.cause is not None
    assert finding.cause.id == "rounded"


@pytest.mark.parametrize(("others", "is_named"), [((), True), ((0.02, 0.3, 0.11), False)])
def test_no_unit_is_named_for_a_placeholder_of_parts_of_all_sizes(
    tmp_path: Path, others: tuple[float, ...], is_named: bool
) -> None:
    """At 5 kg the right moments of a ball of 5 cm are 0.005."""
    parts = [link("base")]
    for i, radius in enumerate((0.05, *others)):
        parts += [link(f"part{i}", inertial(5, 5), visual(sphere(radius)))]
        parts += [joint(f"j{i}", "base", f"part{i}", kind="continuous", xyz=f"{i} 0 0", axis="0 0 1")]
    causes = [f.cause.id for f in find(tmp_path, robot(*parts), {"INR009"}) if f.cause is not None]
    assert causes == (["inertia_unit"] if is_named else [])


def test_a_multiple_of_the_identity_with_three_decimals_was_not_rounded(tmp_path: Path) -> None:
    drawn = visual(box("0.12 0.12 0.05"))  # 0.0007, 0.0007 and 0.0012 at 0.5 kg
    assert [f.cause for f in find(tmp_path, arm_on_base(inertial(0.5, 0.001), drawn), {"INR009"}) if f.cause] == []


def test_a_cylinder_of_twice_the_size_is_no_other_mass(tmp_path: Path) -> None:
    xx, zz = (1.0 * (3 * 0.2**2 + 0.1**2) / 12, 0.5 * 0.2**2)
    text = arm_on_base(inertial(1, ixx=xx, iyy=xx, izz=zz), visual(cylinder(0.1, 0.05)))
    assert "of a cylinder of twice the size" in one(tmp_path, text, "INR009").message.replace("solid: a", "of a")


@pytest.mark.parametrize(("mass", "cause"), [("${m}", "other_mass"), ("1", "decimal_point")])
def test_no_decimal_point_slips_in_an_expression(tmp_path: Path, mass: str, cause: str) -> None:
    numbers = [value if mass == "1" else f"${{{value}*m}}" for value in ("0.02", "0.013", "0.0116667")]
    tensor = dict(zip(("ixx", "iyy", "izz"), numbers, strict=True))
    text = robot(
        '<xacro:property name="m" value="1"/>',
        link("base"),
        link("arm", inertial("0.1", **tensor), visual(box("0.2291288 0.3 0.3872983"))),
        joint("j", "base", "arm", kind="continuous"),
        xacro=True,
    )
    # Moments of a box at 1 kg: 0.02, 0.016875 and 0.011875.
    xx, yy, zz = ((0.09 + 0.15) / 12, (0.0525 + 0.15) / 12, (0.0525 + 0.09) / 12)
    for typed, right in zip(("0.02", "0.013", "0.0116667"), (xx, yy, zz), strict=True):
        text = text.replace(typed, f"{right:.9f}")
    finding = one(tmp_path, text, "INR009", "robot.urdf.xacro")
    assert finding.cause is not None
    assert finding.cause.id == cause


@pytest.mark.parametrize(("across", "cause"), [(0.08, None), (0.0802, "decimal_point")])
def test_guesses_of_one_digit_have_no_decimal_point(across: float, cause: str | None) -> None:
    """Ten times the numbers of a drawing that fits them to a quarter, in a file of which another link fits so too."""
    radius, length = 0.026, 0.23
    rod = VisualGeometry(
        solid=make_cylinder_solid(radius, length),
        closed=True,
        points=np.array([(x, y, z) for x in (-radius, radius) for y in (-radius, radius) for z in (-0.115, 0.115)]),
    )
    guess = DeclaredInertial(2.2, np.zeros(3), np.diag((across, across, 0.008)))
    found = diagnose_inertial(guess, rod, habit=Habit("decimal_point", "tensor 0.1", 0.8))
    assert found is not None
    assert found.cause == cause


# -- causes that leave the numbers far off ------------------------------------------------------------------------------


def test_a_turn_that_leaves_com_and_tensor_far_off_is_no_cause(tmp_path: Path) -> None:
    size = (0.058, 0.03, 0.066)
    xx, yy, zz = (0.2 * (sum(s * s for s in size) - size[i] ** 2) / 12 for i in range(3))
    drawn = visual(box("0.0819 0.0366 0.0389"), xyz="0 0.01006 0")
    text = arm_on_base(inertial(0.2, ixx=xx, iyy=yy, izz=zz, com="0 0.01 0.03"), drawn)
    assert [f.message_id for f in find(tmp_path, text, {"INR009"}) if f.cause] == []


def test_a_tilt_of_a_tenth_of_a_degree_is_no_other_axes(tmp_path: Path) -> None:
    drawn = visual(box("0.3 0.01 0.01"), xyz="0.2 0 0")
    long, thin = 1.0 * (0.3**2 + 0.01**2) / 12, 1.0 * (2 * 0.01**2) / 12
    text = arm_on_base(inertial(1, ixx=thin, ixy=2e-5, iyy=long, izz=long), drawn)
    finding = one(tmp_path, text, "INR009")
    assert finding.message_id == "com_missing"
    assert "other axes" not in finding.message


def test_a_unit_that_fits_one_link_only_is_not_named(tmp_path: Path) -> None:
    def arm(name: str, com: str) -> str:
        moments = {"ixx": 0.0013, "iyy": 0.0073, "izz": 0.0068}
        return link(name, inertial(1, **moments, com=com), visual(box("0.28 0.05 0.1"), xyz="0.08 0.01 0.02"))

    far = {"a": "3.14961 0.393701 0.787402", "b": "1.1 -2 0.3", "c": "-0.2 1.3 1.4", "d": "0.3 1.4 -2"}
    text = robot(
        link("base"),
        *(arm(name, com) for name, com in far.items()),
        *(joint(f"j{name}", "base", name, kind="continuous") for name in far),
    )
    assert find(tmp_path, text, {"INR009"}) == []
    assert len(find(tmp_path, text, {"INR006", "INR009"})) == len(far)


# -- numbers for one of many links --------------------------------------------------------------------------------------


def test_numbers_for_one_call_of_a_macro_are_not_for_its_line(tmp_path: Path) -> None:
    def arm(name: str, call: str) -> str:
        return link(name, f'<inertial><mass value="1"/>\n{call}</inertial>', visual(box("0.3 0.2 0.1")))

    text = robot(
        MACRO,
        link("base"),
        arm("right", '<xacro:tensor m="1" x="0.3" y="0.2" z="0.1"/>'),
        arm("wrong", '<xacro:tensor m="1" x="0.6" y="0.4" z="0.2"/>'),
        joint("j1", "base", "right", kind="continuous"),
        joint("j2", "base", "wrong", kind="continuous"),
        xacro=True,
    )
    finding = one(tmp_path, text, "INR009", "robot.urdf.xacro")
    assert finding.fix is not None
    assert "as the result of the call at robot.urdf.xacro:3" in finding.fix.title


def test_numbers_of_one_link_in_a_yaml_file_are_written_there(tmp_path: Path) -> None:
    rows = {"right": "0.00417, 0.00833, 0.0108", "wrong": "0.0123, 0.0254, 0.156"}
    lines = [f"{name}: {{xx: {x}, yy: {y}, zz: {z}}}" for name, row in rows.items() for x, y, z in [row.split(", ")]]
    (tmp_path / "numbers.yaml").write_text("\n".join(lines) + "\n")
    tensor = "".join(f" {axis}=\"${{all[name]['{axis[1:]}']}}\"" for axis in ("ixx", "iyy", "izz"))
    macro = (
        '<xacro:macro name="arm" params="name"><link name="${name}"><inertial><mass value="1"/>'
        f'<inertia{tensor} ixy="0" ixz="0" iyz="0"/></inertial>{visual(box("0.3 0.2 0.1"))}</link>'
        f"{joint('j${name}', 'base', '${name}', kind='continuous')}</xacro:macro>"
    )
    load = '<xacro:property name="all" value="${xacro.load_yaml(\'numbers.yaml\')}"/>'
    text = robot(load, macro, link("base"), *(f'<xacro:arm name="{name}"/>' for name in rows), xacro=True)
    finding = one(tmp_path, text, "INR003", "robot.urdf.xacro")
    assert finding.fix is not None
    assert " in numbers.yaml:2" in finding.fix.title
    assert "as the result of the call" not in finding.fix.title


def test_a_com_for_one_call_of_a_macro_is_not_for_the_other_side(tmp_path: Path) -> None:
    arm = (
        '<xacro:macro name="arm" params="side y">'
        + link(
            "${side}",
            inertial(1, ixx=0.01, iyy=4, izz=0.001, com="0.3 0 0"),
            visual(box("0.1 0.1 0.1"), xyz="0 ${y} 0"),
        )
        + joint("j${side}", "base", "${side}", kind="continuous")
        + '</xacro:macro>\n<xacro:arm side="left" y="0.2"/>\n<xacro:arm side="right" y="-0.2"/>'
    )
    finding = one(tmp_path, robot(link("base"), arm, xacro=True), "INR003", "robot.urdf.xacro")
    assert finding.fix is not None
    assert 'xyz="0 0.2 0"' in finding.fix.title
    assert "as the result of the call at robot.urdf.xacro:2" in finding.fix.title


def test_numbers_are_not_written_in_place_of_a_formula(tmp_path: Path) -> None:
    call = '<inertial><mass value="1"/>\n<xacro:tensor m="1" x="0.2" y="0.1" z="0.3"/></inertial>'
    text = robot(MACRO, link("arm", call, visual(box("0.3 0.2 0.1"))), xacro=True)
    finding = one(tmp_path, text, "INR009", "robot.urdf.xacro")
    assert finding.fix is not None
    assert finding.fix.title.endswith("as the result of the formula")


def test_the_com_of_a_base_that_is_bolted_down_is_not_reported(tmp_path: Path) -> None:
    part, drawn = inertial(1, ixx=0.0042, iyy=0.0083, izz=0.0108), visual(box("0.3 0.2 0.1"), xyz="0.3 0 0")

    def arm(root: str) -> str:
        return robot(
            link(root),
            link("foot", part, drawn),
            link("arm", inertial(1, 0.01), visual(box("0.2 0.2 0.2"))),
            joint("j0", root, "foot", kind="floating" if root == "map_frame" else "fixed"),
            joint("j1", "foot", "arm", kind="continuous"),
        )

    assert one(tmp_path, arm("map_frame"), "INR009").severity == Severity.WARNING
    assert not find(tmp_path, arm("world"), "INR009")


@pytest.mark.parametrize("ground", ["", link("ground") + joint("free", "ground", "base", kind="floating")])
@pytest.mark.parametrize(("carried", "found"), [(1.0, True), (10.0, False)])
def test_a_com_at_the_origin_on_a_base_counts_for_all_that_the_base_carries(
    tmp_path: Path, carried: float, found: bool, ground: str
) -> None:
    anchor = inertial(1, ixx=1.5e-4, iyy=1.5e-4, izz=1.5e-4), visual(box("0.03 0.03 0.03"), xyz="0 0 0.015")
    text = robot(
        link("base", inertial(9, ixx=0.1, iyy=0.1, izz=0.15), visual(box("0.26 0.26 0.26"))),
        link("anchor", *anchor),
        link("torso", inertial(carried, 0.1)),
        joint("bolts", "base", "anchor", xyz="0.1 0 0.2"),
        joint("turns", "base", "torso", kind="continuous"),
        ground,
    )
    assert bool(find(tmp_path, text, "INR009")) == found


@pytest.mark.parametrize("declared", ["", link("world") + link("apart")])
@pytest.mark.parametrize(
    ("world", "wheel", "found"), [("world", "arm", False), ("stand", "arm", True), ("world", "wheel", True)]
)
def test_a_root_on_a_world_of_a_robot_in_pieces_is_bolted(
    tmp_path: Path, world: str, wheel: str, found: bool, declared: str
) -> None:
    """Where the file does not declare it, Drake has a body of this name. A base with wheels rolls in other programs."""
    part, drawn = inertial(1, ixx=0.0042, iyy=0.0083, izz=0.0108), visual(box("0.3 0.2 0.1"), xyz="0.3 0 0")
    text = robot(
        link("foot", part, drawn),
        link(wheel, inertial(1, 0.01), visual(box("0.2 0.2 0.2"))),
        joint("weld", world, "foot"),
        joint("turns", "foot", wheel, kind="continuous"),
        declared,
    )
    assert bool(find(tmp_path, text, "INR009")) == found


@pytest.mark.parametrize("world", ["world", ""])
@pytest.mark.parametrize(("com", "severity"), [("-33 0.6 16", Severity.WARNING), ("-0.33 0.006 0.16", Severity.INFO)])
def test_a_named_cause_of_a_bolted_base_counts_beyond_the_robot(
    tmp_path: Path, com: str, severity: Severity, world: str
) -> None:
    names = ("upper", "lower", "hand")
    arm = [link(name, inertial(1, 0.003), visual(box("0.1 0.1 0.3"))) for name in names]
    before = ("foot", "upper", "lower")
    joints = [
        joint(name, parent, name, kind="continuous", xyz="0 0 0.3", axis="0 1 0")
        for parent, name in zip(before, names, strict=True)
    ]
    drawn = visual(box("0.12 0.1 0.08"), xyz="-0.038 0.0006 0.019")
    foot = link("foot", inertial(1, com=com, ixx=0.0016, iyy=0.0021, izz=0.0025), drawn)
    declared = [link(world)] if world else []
    text = robot(*declared, foot, *arm, joint("w", "world", "foot"), *joints)
    assert one(tmp_path, text, "INR009").severity == severity


@pytest.mark.parametrize(
    ("root", "kind", "severity"),
    [("world", "fixed", Severity.INFO), ("mount", "floating", Severity.WARNING)],
)
def test_the_com_of_a_stand_that_is_not_drawn_moves_nothing(
    tmp_path: Path, root: str, kind: str, severity: Severity
) -> None:
    text = robot(
        link(root),
        link("foot", inertial(1, 0.05, com="0 0 -0.4"), visual(box("0.2 0.2 0.02"))),
        link("arm", inertial(1, 0.01), visual(box("0.2 0.2 0.2"))),
        joint("j0", root, "foot", kind=kind),
        joint("j1", "foot", "arm", kind="continuous"),
    )
    assert one(tmp_path, text, "INR006").severity == severity


# -- moments of zero, placeholders --------------------------------------------------------------------------------------


def test_a_drawn_ball_gets_the_moment_of_a_ball(tmp_path: Path) -> None:
    moment = 0.4 * 2 * 0.1**2
    text = arm_on_base(inertial(2, ixx=moment, iyy=moment, izz=0), visual(sphere(0.1)))
    finding = one(tmp_path, text, "INR004")
    assert finding.fix is not None
    assert 'izz="0.008"' in finding.fix.title
    assert "bar" not in finding.fix.title


@pytest.mark.parametrize(("size", "cause"), [("0.01 0.01 0.024", None), ("0.1 0.1 0.2", "placeholder")])
def test_numbers_that_a_program_rounded_are_no_placeholders(tmp_path: Path, size: str, cause: str | None) -> None:
    arms = [
        link(f"arm{i}", inertial(mass, ixx="1e-06", iyy="1e-06", izz=0), visual(box(size)))
        for i, mass in enumerate((0.0171, 0.0174, 0.0177))
    ]
    text = robot(link("base"), *arms, *(joint(f"j{i}", "base", f"arm{i}", kind="continuous") for i in range(3)))
    (finding, *_) = find(tmp_path, text, {"INR004"})
    assert (None if finding.cause is None else finding.cause.id) == cause


def test_all_links_with_a_placeholder_count_and_one_that_moves_is_the_example(tmp_path: Path) -> None:
    part, drawn = inertial(1, 0.001), visual(cylinder(0.1, 1))
    text = robot(
        link("world"),
        link("foot", part, visual(cylinder(0.14, 1))),
        link("lower", part, drawn),
        link("upper", part, drawn),
        joint("j0", "world", "foot"),
        joint("j1", "foot", "lower", kind="continuous"),
        joint("j2", "lower", "upper", kind="continuous"),
    )
    finding = next(f for f in find(tmp_path, text, {"INR007"}) if f.message_id != "mass")
    assert finding.message.startswith("foot, lower, upper: ")
    assert "1 kg with the shape of lower" in finding.message


def test_links_that_hardly_matter_have_the_placeholder_too(tmp_path: Path) -> None:
    part, drawn = inertial(1, 0.001), visual(cylinder(0.1, 1))
    heavy = inertial(30, ixx=2.6, iyy=2.6, izz=0.15)
    text = robot(
        link("base"),
        link("lower", part, drawn),
        link("upper", heavy, drawn),
        link("cover", part, visual(cylinder(0.1, 1))),
        joint("j1", "base", "lower", kind="continuous"),
        joint("j2", "lower", "upper", kind="continuous"),
        joint("j3", "upper", "cover"),
    )
    finding = one(tmp_path, text, "INR007")
    assert finding.message.startswith("lower: ")
    assert finding.message.endswith(". One more link has the same numbers")


# -- drawings that are not the part -------------------------------------------------------------------------------------


@pytest.mark.parametrize("is_whole", [True, False])
def test_links_that_draw_one_thing_in_one_place_are_not_judged_by_it(tmp_path: Path, is_whole: bool) -> None:
    """As where each part is exported with the whole robot: three meshes, each in the frame of its link."""
    names, step = ("a", "b", "c"), 0.1
    files = {
        f"{name}.stl": write_box((0.5, 0.3, 0.2), (0.25 - step * i if is_whole else 0.0, 0.0, 0.0))
        for i, name in enumerate(names)
    }
    links = [link(name, inertial(1, ixx=1e-4, iyy=1.3e-4, izz=1.1e-4), visual(mesh(f"{name}.stl"))) for name in names]
    joints = [joint(f"j{b}", a, b, kind="continuous", xyz=f"{step} 0 0") for a, b in (("a", "b"), ("b", "c"))]
    assert bool(find(tmp_path, {**files, "robot.urdf": robot(*links, *joints)}, {"INR009"})) != is_whole


@pytest.mark.parametrize(("scale", "is_told"), [("1 1 1", True), ("10 10 10", False)])
def test_a_mesh_lighter_than_any_material_gives_no_numbers(tmp_path: Path, scale: str, is_told: bool) -> None:
    text = arm_on_base(inertial(0.5, ixx=0.07, iyy=0.07, izz=0), visual(mesh("arm.stl", scale)))
    files = {"robot.urdf": text, "arm.stl": write_box((0.1, 0.1, 0.05))}
    finding = one(tmp_path, files, "INR004")
    assert finding.fix is not None
    assert ("the drawn part" in finding.fix.title) == is_told


def test_bodies_that_touch_in_a_corner_or_an_edge_are_apart() -> None:
    """Two tetrahedra with a common edge, which four faces share; of an open one nothing is known but what hangs together."""
    faces = np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2), (0, 1, 4), (0, 5, 1), (1, 5, 4), (0, 4, 5)])
    assert label_components(faces, 6).max() == 0
    labels = label_bodies(faces, 6)
    assert [len(set(labels[:4].tolist())), len(set(labels[4:].tolist())), int(labels.max())] == [1, 1, 1]
    assert label_bodies(faces[:7], 6).max() == 0
