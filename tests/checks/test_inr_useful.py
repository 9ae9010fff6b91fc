"""What is said of inertials only where it is of use: rows, whole files, hulls, drawings that stand for something else."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import arm_on_base, box, collision, find, inertial, joint, limit, link, mesh, robot, visual
from castings import CASTING, Block, drawn_boxes, format_inertial, geometry, opened, steiner, uniform, write_stl

from urdfcheck.core import Severity
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.diagnosis import diagnose_inertial
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia, make_box_solid

DRAWN = geometry(CASTING)
TRUE = uniform(DRAWN.solid)
LIMIT = limit(-1, 1)

# -- rows ----------------------------------------------------------------------------------------------------------------


def make_row(
    *numbers: DeclaredInertial, names: str = "wheel_{}", kind: str = "continuous", drawn: tuple[str, ...] = ("",) * 9
) -> str:
    parts = [link("base")]
    for i, one in enumerate(numbers):
        parts += [
            joint(f"j{i}", "base", names.format(i), kind=kind, xyz=f"0 {i} 0"),
            link(names.format(i), format_inertial(one, 6), drawn[i]),
        ]
    return robot(*parts)


POUNDS = replace(TRUE, mass=TRUE.mass / 0.45359237)
AT_ORIGIN = replace(TRUE, tensor=TRUE.tensor + steiner(TRUE.mass, TRUE.com))
HEAVIER = replace(TRUE, mass=1.37 * TRUE.mass)
ROUNDED = replace(TRUE, tensor=np.round(TRUE.tensor, int(np.ceil(-np.log10(TRUE.tensor.diagonal().min())))))


@pytest.mark.parametrize(
    ("odd", "others", "names", "words"),
    [
        (POUNDS, 3, "wheel_{}", "unit of the mass: lb"),
        (AT_ORIGIN, 2, "wheel_{}", "tensor about the origin"),
        (HEAVIER, 3, "wheel_{}", ""),  # no common mistake
        (POUNDS, 1, "wheel_{}", ""),  # which of two is wrong is not known
        (POUNDS, 3, "wheel{}_part_of_one", "unit of the mass: lb"),
        (POUNDS, 3, "{}_3", "unit of the mass: lb"),
        (ROUNDED, 2, "wheel_{}", "rounding"),
    ],
)
def test_of_a_row_that_draws_nothing_one_has_a_mistake(
    tmp_path: Path, odd: DeclaredInertial, others: int, names: str, words: str
) -> None:
    found = find(tmp_path, make_row(odd, *[TRUE] * others, names=names), "SYM003")
    assert [finding.message_id for finding in found] == ["row"] * bool(words)
    if words:
        assert words in found[0].message
        assert found[0].location.subject.startswith(f"link[{names.format(0)}]")
        assert found[0].fix is not None
        assert not found[0].fix.edits


BAR = visual(box("0.2 0.1 0.1"))
OF_BAR = DeclaredInertial(1.0, np.zeros(3), compute_solid_inertia(make_box_solid(np.array((0.2, 0.1, 0.1))), 1.0))
LARGER = replace(OF_BAR, tensor=1e3 * OF_BAR.tensor)


@pytest.mark.parametrize(
    ("first", "odd", "other", "kinds"),
    [
        (BAR, LARGER, OF_BAR, ["row"]),
        (visual(box("0.2 0.1 0.1"), xyz="0 0 0.01"), LARGER, OF_BAR, ["row"]),
        (visual(box("0.2 0.1 0.05")), LARGER, OF_BAR, []),  # another part
        (visual(mesh("rod_0.stl")), LARGER, OF_BAR, []),
        (BAR, OF_BAR, LARGER, []),  # the only one with the inertial of what it draws
    ],
)
def test_a_row_is_of_parts_that_are_drawn_alike(
    tmp_path: Path, first: str, odd: DeclaredInertial, other: DeclaredInertial, kinds: list[str]
) -> None:
    text = make_row(odd, other, other, names="rod_{}", drawn=(first, BAR, BAR))
    assert [finding.message_id for finding in find(tmp_path, text, "SYM003")] == kinds


@pytest.mark.parametrize(("place", "found"), [("0 0 0", False), ("0.3 0 0", True)])
def test_a_frame_at_another_point_of_a_part_leaves_its_com_at_the_origin(
    tmp_path: Path, place: str, found: bool
) -> None:
    away = replace(OF_BAR, com=np.array((0.3, 0.0, 0.0)))
    there, here = visual(box("0.2 0.1 0.1"), xyz="0.3 0 0"), visual(box("0.2 0.1 0.1"), xyz=place)
    text = make_row(OF_BAR, away, away, names="rod_{}", drawn=(here, there, there))
    assert bool(find(tmp_path, text, "SYM003")) == found


@pytest.mark.parametrize(("name", "found"), [("rod_2.stl", True), ("bracket.stl", False)])
def test_meshes_that_are_not_there_are_compared_by_name(tmp_path: Path, name: str, found: bool) -> None:
    drawn = tuple(visual(mesh(file)) for file in ("rod_0.stl", "rod_1.stl", name))
    text = make_row(OF_BAR, OF_BAR, LARGER, names="rod_{}", drawn=drawn)
    assert bool(find(tmp_path, text, "SYM003")) == found


def test_a_row_of_two_kinds_shows_nothing(tmp_path: Path) -> None:
    assert not find(tmp_path, make_row(POUNDS, TRUE, TRUE, HEAVIER), "SYM003")
    (found,) = find(tmp_path, make_row(POUNDS, TRUE, TRUE, TRUE, HEAVIER), "SYM003")
    assert found.location.subject.startswith("link[wheel_0]")


def test_one_of_a_row_has_a_placeholder(tmp_path: Path) -> None:
    typed = replace(TRUE, tensor=0.1 * np.eye(3))
    (found,) = find(tmp_path, make_row(TRUE, typed, TRUE), "SYM003")
    assert found.message_id == "typed"
    assert "0.1 × identity kg·m², typed rather than computed" in found.message
    assert not find(tmp_path, make_row(TRUE, replace(typed, mass=1.02 * TRUE.mass), TRUE), "SYM003")


def test_a_com_beside_that_of_the_part_whose_tensor_is_right_is_wrong(tmp_path: Path) -> None:
    """Both numbers come from one drawing. A tensor that is only near shows nothing."""
    away = 2.0 * np.sqrt(np.diag(DRAWN.solid.covariance)) * (1.0, -0.6, 0.7)
    cover = link("cover", visual(box("1 1 1"))) + joint("lid", "part", "cover")
    for stretch, expected in ((1.0, ["disagrees"]), (1.3, [])):
        moved = replace(TRUE, com=TRUE.com + away, tensor=stretch * TRUE.tensor)
        part = link("part", format_inertial(moved, 9), drawn_boxes(CASTING))
        text = robot(link("base"), joint("j", "base", "part", kind="continuous"), part, cover)
        found = find(tmp_path / f"{stretch}", text, "INR009")
        assert [finding.message_id for finding in found if finding.severity is Severity.WARNING] == expected


# -- a scale of the whole file -------------------------------------------------------------------------------------------


def make_castings(factors: list[float]) -> str:
    """Castings of different sizes; each tensor is multiplied by its factor."""
    parts = [link("base")]
    for i, factor in enumerate(factors):
        blocks = [
            (np.array(size) * (1 + 0.1 * i, 1.0, 1 - 0.03 * i), np.array(place) * (1 + 0.1 * i, 1.0, 1 - 0.03 * i))
            for size, place in CASTING
        ]
        true = uniform(geometry(blocks).solid)
        stretch = np.diag((1.0 + 0.02 * i, 1.0 - 0.015 * i, 1.0))  # a motor here and there
        com = true.com + 0.003 * np.array((1.0, 0.5 * i, -0.5))
        lumped = replace(true, com=com, tensor=factor * stretch @ true.tensor @ stretch)
        parts += [
            joint(f"j{i}", "base", f"l{i}", kind="continuous", xyz=f"0 0 {i}"),
            link(f"l{i}", format_inertial(lumped), drawn_boxes(blocks)),
        ]
    return robot(*parts)


@pytest.mark.parametrize("factor", [0.1, 10.0, 0.01])
def test_tensors_of_a_file_may_all_be_a_power_of_ten_off(tmp_path: Path, factor: float) -> None:
    found = find(tmp_path / "all", make_castings([factor] * 6), {"INR009"})
    assert [(finding.message_id, finding.cause and finding.cause.id) for finding in found] == [
        ("habit", "decimal_point")
    ]
    assert f"tensor {1 / factor:g}" in found[0].message
    few = find(tmp_path / "few", make_castings([factor] * 2 + [1.0] * 6), {"INR009"})
    assert "habit" not in {finding.message_id for finding in few}


# The bounding box has moments that are 1.9 times as large, and more.
L_SHAPE: tuple[Block, ...] = (((0.10, 0.01, 0.01), (0.0, 0.0, 0.0)), ((0.01, 0.01, 0.12), (0.045, 0.0, 0.065)))

# -- one link ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("residual", "cause"), [(0.03, "com_unit"), (0.3, None)])
def test_one_com_in_inches_has_to_fit(residual: float, cause: str | None) -> None:
    """``residual``: how far the COM is from the drawn part's in inches, in radii of gyration."""
    radius = np.sqrt(np.trace(DRAWN.solid.covariance))
    com = TRUE.com + residual * radius * np.array((0.0, 0.0, 1.0))
    found = diagnose_inertial(replace(TRUE, com=com / 0.0254), DRAWN)
    assert found is not None
    assert (found.cause if found.cause == "com_unit" else None) == cause


def test_an_open_mesh_shows_a_tensor_about_the_origin_if_no_mass_inside_has_it() -> None:
    away = [(size, (x, y, z + 0.9)) for size, (x, y, z) in CASTING]
    drawn = opened(geometry(away))
    true = uniform(geometry(away).solid)
    shifted = replace(true, tensor=true.tensor + steiner(true.mass, true.com))
    found, near = diagnose_inertial(shifted, drawn), diagnose_inertial(AT_ORIGIN, opened(DRAWN))
    assert found is not None
    assert near is not None
    assert (found.cause, found.fits_geometry) == ("about_origin", False)
    assert near.cause is None or not near.fits_geometry


def write_open(path: Path) -> None:
    write_stl(path, CASTING)
    text = path.read_text(encoding="ascii")
    path.write_text(text[: text.rindex("facet normal")] + "endsolid part\n", encoding="ascii")


@pytest.mark.parametrize(("factor", "found"), [(0.04, False), (0.002, True)])
def test_a_hull_is_the_most_that_a_part_can_fill(tmp_path: Path, factor: float, found: bool) -> None:
    write_open(tmp_path / "part.stl")
    rod = np.diag(TRUE.tensor.diagonal())
    small = replace(TRUE, tensor=factor * rod)
    text = arm_on_base(format_inertial(small), visual(mesh("part.stl")))
    messages = [
        f.message_id for f in find(tmp_path, text, {"INR009"}) if f.cause is None and f.message_id != "doubtful"
    ]
    assert messages == ["disagrees"] * found


def test_a_formula_of_the_same_size_is_meant_to_be_near(tmp_path: Path) -> None:
    blocks = [((0.10, 0.03, 0.03), (0.0, 0.0, 0.0)), ((0.06, 0.03, 0.03), (0.0, 0.03, 0.0))]
    small = list(L_SHAPE)
    ids = []
    for name, part in (("near", blocks), ("far", small)):
        drawn = geometry(part)
        assert drawn.box is not None
        numbers = DeclaredInertial(0.3, drawn.solid.com, compute_solid_inertia(drawn.box, 0.3))
        (tmp_path / name).mkdir()
        write_stl(tmp_path / name / "part.stl", part)
        found = find(tmp_path / name, arm_on_base(format_inertial(numbers), visual(mesh("part.stl"))), {"INR009"})
        ids += [(f.message_id, f.cause and f.cause.id, f.severity) for f in found]
    assert ids == [("approximation", "bounding_box", Severity.INFO), ("exact", "bounding_box", Severity.INFO)]


# -- drawings that stand for something else --------------------------------------------------------------------------


@pytest.mark.parametrize(("mass", "codes"), [(0.2, ["INR005"]), (0.6, [])])
def test_a_rod_in_the_middle_of_a_leg_is_not_the_leg(tmp_path: Path, mass: float, codes: list[str]) -> None:
    """36 cm³: 5,600 and 16,700 kg/m³. The tensor is that of a leg of 60 mm across."""
    leg = np.diag(compute_solid_inertia(make_box_solid((0.06, 0.06, 0.36)), mass)).tolist()
    numbers = inertial(mass, ixx=leg[0] * 1.01, iyy=leg[1] * 1.02, izz=leg[2] * 1.03)
    found = find(tmp_path, arm_on_base(numbers, visual(box("0.01 0.01 0.36"))), {"INR005", "INR010"})
    assert [finding.code for finding in found] == codes


@pytest.mark.parametrize(("density", "is_own", "dense"), [(5e4, True, True), (4.4e4, True, False), (5e4, False, False)])
def test_a_uniform_part_fills_its_drawing(tmp_path: Path, density: float, is_own: bool, dense: bool) -> None:
    """A bar of 0.3 m by 20 mm: with 2 % of its size on all sides it has 2.2 times its volume."""
    mass = density * 0.3 * 0.02 * 0.02
    xx, yy, zz = (
        np.diag(compute_solid_inertia(make_box_solid((0.02, 0.02, 0.3)), mass)) * (1 if is_own else 0.8)
    ).tolist()
    text = arm_on_base(inertial(mass, ixx=xx, iyy=yy, izz=zz), visual(box("0.02 0.02 0.3")))
    assert [f.message_id for f in find(tmp_path, text, {"INR010"})] == ["dense"] * dense


@pytest.mark.parametrize(("collided", "dense"), [("0.06 0.06 0.3", False), ("0.02 0.02 0.3", True)])
def test_a_skin_is_drawn_where_the_collision_shape_has_the_density(tmp_path: Path, collided: str, dense: bool) -> None:
    """6 kg in 120 cm³, or in 1.08 litres."""
    xx, yy, zz = np.diag(compute_solid_inertia(make_box_solid((0.02, 0.02, 0.3)), 6.0)).tolist()
    shapes = visual(box("0.02 0.02 0.3")), collision(box(collided))
    text = arm_on_base(inertial(6, ixx=xx, iyy=yy, izz=zz), *shapes)
    assert [f.message_id for f in find(tmp_path, text, {"INR010"})] == ["dense"] * dense


def test_frames_without_mass_join_the_list_of_links_without_mass(tmp_path: Path) -> None:
    massless = inertial(0, 0)
    links = [link("base", inertial(1, 0.01)), link("frame", massless)]
    joints = [joint("f", "base", "frame", kind="continuous")]
    assert [f.message_id for f in find(tmp_path / "a", robot(*links, *joints), "INR002")] == ["loose"]
    links.append(link("arm", massless, visual(box("0.1 0.1 0.1"))))
    joints.append(joint("a", "base", "arm", kind="continuous"))
    assert {f.message_id for f in find(tmp_path / "b", robot(*links, *joints), "INR002")} == {"zero"}


@pytest.mark.parametrize(
    ("mass", "count", "more", "severity"),
    [
        (0, 4, "", Severity.WARNING),
        (0, 4, "<gazebo/>", Severity.ERROR),
        (0, 3, "", Severity.ERROR),
        (1, 4, "", Severity.ERROR),
    ],
)
def test_a_drawing_whose_masses_are_all_zero_needs_none(
    tmp_path: Path, mass: float, count: int, more: str, severity: Severity
) -> None:
    """Without simulator; a robot of which one link has a mass is meant to have masses."""
    text = make_weightless(mass, count)
    found = [f for f in find(tmp_path, text.replace("</robot>", f"{more}</robot>"), "INR002") if f.message_id == "zero"]
    assert {finding.severity for finding in found} == {severity}


@pytest.mark.parametrize(("is_packaged", "severity"), [(True, Severity.WARNING), (False, Severity.ERROR)])
def test_nothing_shows_what_a_weightless_robot_is_for_without_a_package(
    tmp_path: Path, is_packaged: bool, severity: Severity
) -> None:
    if is_packaged:
        (tmp_path / "package.xml").write_text("<package format='3'><name>arm</name></package>")
    text = make_weightless(0, 4).replace("</link>", f"{collision(box('0.1 0.1 0.1'))}</link>", 1)
    found = [f for f in find(tmp_path, text, "INR002") if f.message_id == "zero"]
    assert {finding.severity for finding in found} == {severity}


def make_weightless(mass: float, count: int) -> str:
    """A base with joints around it, of which only the base may have a mass."""
    names = ["base", *(f"arm{i}" for i in range(1, count))]
    numbers = [inertial(mass, mass), *[inertial(0, 0)] * (count - 1)]
    links = [link(name, one, visual(box("0.1 0.1 0.1"))) for name, one in zip(names, numbers, strict=True)]
    joints = [joint(f"j{child}", "base", child, kind="continuous") for child in names[1:]]
    return robot(*links, *joints)


@pytest.mark.parametrize(("child", "light"), [(0.004, True), (0.006, False)])
def test_a_shaft_on_a_vehicle_is_a_part(tmp_path: Path, child: float, light: bool) -> None:
    text = arm_on_base(inertial(child, 1e-6), base=inertial(1500, 300))
    assert [f.message_id for f in find(tmp_path, text, "INR011")] == ["light"] * light


# -- signs of the products ------------------------------------------------------------------------------------------------

SIGNS = np.array([[1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]])


# A rod along (3, 2, 1).
ROD = 0.002137 * (14.0 * np.eye(3) - np.outer((3.0, 2.0, 1.0), (3.0, 2.0, 1.0))) + np.diag((1.1e-4, 1.3e-4, 1.2e-4))


@pytest.mark.parametrize("drawn", ["", drawn_boxes(CASTING)])
def test_impossible_products_may_be_those_about_the_origin(tmp_path: Path, drawn: str) -> None:
    """In positive notation, about the origin: with other signs the tensor is possible, and about the COM it is, too."""
    away = replace(TRUE, com=np.array((0.3, 0.3, 0.3)))
    printed = replace(away, tensor=SIGNS * (away.tensor + steiner(away.mass, away.com)))
    (finding,) = find(tmp_path, arm_on_base(format_inertial(printed), drawn), {"INR003", "INR004"})
    assert finding.cause is None or finding.cause.id != "products_sign"
    assert "with the other sign" in finding.message or drawn
    near = replace(TRUE, com=np.zeros(3), tensor=SIGNS * ROD)
    (finding,) = find(tmp_path / "near", arm_on_base(format_inertial(near)), {"INR003", "INR004"})
    assert finding.cause is not None
    assert finding.cause.id == "products_sign"
    assert finding.fix is None or not finding.fix.edits


@pytest.mark.parametrize(
    ("more", "severity"),
    [
        ("", Severity.INFO),
        (
            '<link name="rotor_1"/><joint name="j" type="fixed"><parent link="ball"/><child link="rotor_1"/></joint>',
            None,
        ),
        ('<gazebo><plugin name="p" filename="libbuoyancy.so"/></gazebo>', None),
        ('<link name="drone"/><joint name="j" type="fixed"><parent link="drone"/><child link="ball"/></joint>', None),
    ],
)
def test_a_placeholder_of_one_body_that_touches_nothing_is_an_info(
    tmp_path: Path, more: str, severity: Severity | None
) -> None:
    ball = (
        '<link name="ball"><inertial><mass value="0.13"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
        '{}<visual><geometry><sphere radius="0.1"/></geometry></visual></link>'
    )
    (finding,) = find(tmp_path, f'<robot name="r">{ball.format("")}{more}</robot>', "INR007")
    assert finding.severity == (severity or Severity.ERROR)
    touching = ball.format('<collision><geometry><sphere radius="0.1"/></geometry></collision>')
    (finding,) = find(tmp_path, f'<robot name="r">{touching}{more}</robot>', "INR007")
    assert finding.severity == Severity.ERROR


# -- models that nothing moves, or a program alone ------------------------------------------------------------------------


@pytest.mark.parametrize(("role", "severity"), [("visual", Severity.INFO), ("collision", Severity.WARNING)])
def test_axes_that_are_drawn_need_no_inertia(tmp_path: Path, role: str, severity: Severity) -> None:
    typed = inertial(1, 100)
    shape = visual(box("0.1 0.01 0.01")) + (collision(box("0.1 0.01 0.01")) if role == "collision" else "")
    parts = [link("base"), link("x", typed + shape), link("y", typed + shape)]
    joints = [joint(name, "base", name, kind="fixed", xyz="0.05 0 0") for name in ("x", "y")]
    looks = "<gazebo reference='x'><material>Gazebo/Red</material></gazebo>"
    (finding,) = find(tmp_path, robot(*parts, *joints, looks), "INR007")
    assert min(finding.severity, Severity.WARNING) == severity


@pytest.mark.parametrize(("gravity", "severity"), [("0", Severity.INFO), ("1", Severity.WARNING)])
def test_an_obstacle_that_a_plugin_places_may_be_lighter_than_air(
    tmp_path: Path, gravity: str, severity: Severity
) -> None:
    body = link("obstacle", inertial(0.01, 1e-6) + visual(box("1 1 1")) + collision(box("1 1 1")))
    moved = "<gazebo><plugin name='move' filename='libmove_model.so'/></gazebo>"
    text = robot(body, f"<gazebo reference='obstacle'><gravity>{gravity}</gravity></gazebo>", moved)
    (finding,) = find(tmp_path, text, "INR010")
    assert (finding.message_id, finding.severity) == ("light", severity)


@pytest.mark.parametrize(
    ("shapes", "severity"), [("", Severity.INFO), (collision(box("0.6 0.4 0.3")), Severity.WARNING)]
)
def test_a_body_that_a_program_places_may_have_token_masses(tmp_path: Path, shapes: str, severity: Severity) -> None:
    names = ("base", "holder", "wheel")
    parts = [link(name, inertial(1e-5, 1e-6) + visual(box("0.6 0.4 0.3")) + shapes) for name in names]
    joints = [joint(name, "base", name, kind="fixed", xyz="0 0 0.3") for name in names[1:]]
    (finding,) = find(tmp_path, robot(*parts, *joints), "INR015")
    assert (finding.message_id, finding.severity) == ("placeholder", severity)


def test_stairs_are_scenery(tmp_path: Path) -> None:
    steps = [
        link(f"stair_link_{i}", inertial(0.8, 100) + visual(box("0.6 0.3 0.07"), xyz=f"0 {0.15 * i} {0.07 * i}"))
        for i in range(15)
    ]
    joints = [joint(f"j{i}", f"stair_link_{i}", f"stair_link_{i + 1}", kind="fixed") for i in range(14)]
    text = robot(*steps, *joints).replace("</visual>", f"</visual>{collision(box('0.6 0.3 0.07'))}")
    assert not [*find(tmp_path, text, "INR005"), *find(tmp_path, text, "INR007")]


def test_a_robot_with_two_long_arms_stands_still(tmp_path: Path) -> None:
    """Its body has no COM of its own, which nothing feels; the joints hold the arms."""
    body = link("body", inertial(20, ixx=0.75, iyy=0.75, izz=0.3) + visual(box("0.3 0.3 0.6"), xyz="0 0 0.3"))
    parts = [link("base"), body, joint("stands", "base", "body", kind="fixed")]
    for side, y in (("left", 0.2), ("right", -0.2)):
        parent = "body"
        for index in range(6):
            name = f"{side}_arm_{index}"
            parts.append(link(name, inertial(1, 0.01, com="0 0 0.05") + visual(box("0.06 0.06 0.1"), xyz="0 0 0.05")))
            place = f"0 {y} 0.5" if parent == "body" else "0 0 0.1"
            parts.append(joint(f"{name}_joint", parent, name, LIMIT, kind="revolute", xyz=place, axis="0 1 0"))
            parent = name
    found = find(tmp_path, robot(*parts), "INR009")
    assert not [finding for finding in found if "body" in finding.message and finding.severity > Severity.INFO]


def test_a_drawer_does_not_feel_the_tensor_of_its_walls(tmp_path: Path) -> None:
    """The tensor was typed for parts without a drawing, too, which turn: it is not known that it is wrong there."""
    typed = inertial(0.1, 0.1)
    parts = [link("world"), link("wall", typed + visual(box("0.013 0.3 0.1"))), link("door", typed)]
    joints = [
        joint("slides", "world", "wall", LIMIT, kind="prismatic", axis="0 1 0"),
        joint("turns", "world", "door", LIMIT, kind="revolute", axis="0 0 1"),
    ]
    (finding,) = find(tmp_path, robot(*parts, *joints), "INR007")
    assert (finding.message_id, finding.severity) == ("bolted", Severity.INFO)
    assert "door" not in finding.message
