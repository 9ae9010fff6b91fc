"""Causes and repairs of inertials: what is claimed only with proof, and what is said instead."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import arm_on_base, box, collision, cylinder, find, inertial, joint, link, robot, visual
from castings import CASTING, drawn_boxes, format_inertial, geometry, uniform

from urdfcheck.core import Finding, Severity
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.diagnosis import diagnose_inertial
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia, make_box_solid

DRAWN = geometry(CASTING)
TRUE = uniform(DRAWN.solid)
BOXES = drawn_boxes(CASTING)
QUARTER = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def one(folder: Path, text: str, codes: set[str]) -> Finding:
    (finding,) = find(folder, text, codes)
    return finding


def make_arm(numbers: DeclaredInertial) -> str:
    return arm_on_base(format_inertial(numbers), BOXES)


def make_box_inertial(size: tuple[float, float, float], mass: float, factor: float = 1.0, com: str = "") -> str:
    xx, yy, zz = (factor * np.diag(compute_solid_inertia(make_box_solid(size), mass))).tolist()
    return inertial(mass, ixx=xx, iyy=yy, izz=zz, com=com)


# -- causes -------------------------------------------------------------------------------------------------------------


def test_no_unit_makes_three_moments_equal() -> None:
    plate = geometry([((0.4, 0.2, 0.1), (0.0, 0.0, 0.0))])
    tensor = compute_solid_inertia(plate.solid, 8.0)
    proper = DeclaredInertial(8.0, np.zeros(3), 1e4 * tensor)
    equal = replace(proper, tensor=1e4 * float(np.trace(tensor)) / 3 * np.eye(3))
    found, refused = diagnose_inertial(proper, plate), diagnose_inertial(equal, plate)
    assert found is not None
    assert refused is not None
    assert (found.cause, found.detail) == ("inertia_unit", "kg·cm²")
    assert refused.cause is None


def test_tensor_and_com_may_be_rotated_in_two_ways(tmp_path: Path) -> None:
    blocks = [(size, np.array(place) - TRUE.com + (0.012, -0.005, 0.05)) for size, place in CASTING]
    true = uniform(geometry(blocks).solid)
    exchanged = replace(true, tensor=QUARTER.T @ true.tensor @ QUARTER, com=true.com[[1, 0, 2]])
    finding = one(tmp_path, arm_on_base(format_inertial(exchanged), drawn_boxes(blocks)), {"INR009"})
    assert finding.cause is not None
    assert finding.cause.id == "quarter_turn"
    assert "the tensor agrees, and the COM does with its x y z as y x z" in finding.message
    assert finding.fix is not None
    assert finding.fix.edits == ()
    written = re.search(r'xyz="([^"]*)"', finding.fix.title)
    assert written is not None
    assert [float(v) for v in written[1].split()] == pytest.approx(true.com.tolist(), rel=1e-4)


def test_a_com_that_stays_far_off_is_not_written(tmp_path: Path) -> None:
    off = TRUE.com + np.array([0.05, -0.04, 0.03])
    turned = replace(TRUE, tensor=QUARTER @ TRUE.tensor @ QUARTER.T, com=QUARTER @ off)
    for finding in find(tmp_path, make_arm(turned), {"INR009"}):
        assert finding.fix is not None
        assert finding.fix.edits == ()
        assert "xyz" not in finding.fix.title


@pytest.mark.parametrize(("x", "named"), [(0.1, True), (0.204, False)])
def test_a_coordinate_fits_at_another_decimal_point_or_is_not_named(x: float, named: bool) -> None:
    rod = geometry([((0.06, 0.02, 0.02), (0.01, 0.0, 0.0))])
    found = diagnose_inertial(replace(uniform(rod.solid, 0.1), com=np.array([x, 0.0, 0.0])), rod)
    assert found is not None
    assert (found.cause == "decimal_point") == named


def test_the_sign_of_one_coordinate_is_smaller_than_a_mirror() -> None:
    part = geometry([((0.1, 0.06, 0.04), (0.0, 0.0, 0.03))])
    numbers = replace(uniform(part.solid), com=np.array([0.0, 0.0, -0.03]))
    found = diagnose_inertial(numbers, part)
    assert found is not None
    assert (found.cause, found.detail) == ("one_sign", "com z")


# -- headlines and severity ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("size", "words"),
    [
        ((0.03, 0.03, 0.03), "fits a far shorter part"),
        ((0.0018, 0.0018, 0.4), "fits a far thinner part"),
        ((0.008, 0.008, 0.05), "fits a far smaller part"),
        ((0.002, 0.002, 0.02), "inertia 400× too small"),
    ],
)
def test_the_headline_says_how_the_part_differs(tmp_path: Path, size: tuple[float, float, float], words: str) -> None:
    text = arm_on_base(make_box_inertial(size, 0.7), visual(box("0.03 0.03 0.4")))
    assert words in one(tmp_path, text, {"INR009"}).headline


def test_a_tensor_too_large_is_not_that_of_a_thinner_part(tmp_path: Path) -> None:
    text = arm_on_base(inertial(1, ixx=0.01, iyy=0.01, izz=0.02), visual(box("0.2 0.2 0.2")))
    finding = one(tmp_path, text, {"INR009"})
    assert finding.headline == "arm: inertia up to 3× too large"  # the other two are 1.5 times the cube's 0.0067
    assert "the moments of inertia are up to 3 times too large for this mass" in finding.message


@pytest.mark.parametrize(("factor", "severity"), [(30.0, Severity.WARNING), (3e4, Severity.ERROR)])
def test_a_thousand_times_too_large_is_an_error(tmp_path: Path, factor: float, severity: Severity) -> None:
    turned = inertial(0.7, ixx=factor * 1e-3, iyy=factor * 1.7e-4, izz=factor * 1.1e-3)
    finding = one(tmp_path, arm_on_base(turned, visual(box("0.1 0.06 0.04"))), {"INR005"})
    assert finding.severity == severity


def test_what_is_denser_than_any_material_is_not_without_a_cause(tmp_path: Path) -> None:
    drawn = visual(box("0.3 0.03 0.02"))
    lumped = inertial(0.5, ixx=5.4e-5, iyy=5.8e-4, izz=6e-4)
    dense = inertial(50, ixx=5.4e-3, iyy=5.8e-2, izz=6e-2)
    assert [f.message_id for f in find(tmp_path, arm_on_base(lumped, drawn), {"INR009"})] == ["doubtful"]
    assert find(tmp_path, arm_on_base(dense, drawn), {"INR009"}) == []


# -- what stands in for the drawing -------------------------------------------------------------------------------------


def make_servo(mass: float, moment: float, drawn: str = "", base: str = "") -> str:
    """Return a rod with a mass, and a servo fixed to it."""
    return robot(
        link("base", base),
        joint("hip", "base", "rod"),
        link("rod", make_box_inertial((0.01, 0.01, 0.1), 0.04), visual(box("0.01 0.01 0.1"))),
        joint("screws", "rod", "servo", kind="fixed"),
        link("servo", inertial(mass, moment), drawn),
    )


@pytest.mark.parametrize(
    ("moment", "drawn", "found"),
    [("1.03e-5", "", False), ("1.03e-5", visual(box("0.01 0.01 0.01")), True), ("1.03e-1", "", True)],
)
def test_a_mass_is_measured_against_its_own_drawing(tmp_path: Path, moment: str, drawn: str, found: bool) -> None:
    text = make_servo(0.054, 0, drawn).replace('ixx="0"', f'ixx="{moment}"').replace('iyy="0"', f'iyy="{moment}"')
    text = text.replace('izz="0"', f'izz="{moment}"')
    assert bool(find(tmp_path, text, {"INR005"})) == found


def test_a_collision_shape_or_a_hull_is_named_and_never_edited(tmp_path: Path) -> None:
    (tmp_path / "open.stl").write_text(
        "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0.1 0 0\nvertex 0 0.1 0.03\nendloop\nendfacet\n"
        "facet normal 0 1 0\nouter loop\nvertex 0 0 0\nvertex 0.1 0 0\nvertex 0 0.02 0.08\nendloop\nendfacet\nendsolid s\n"
    )
    mesh = visual('<mesh filename="open.stl"/>')
    round_ = inertial(0.37, 0.5)
    for drawn in (mesh, mesh + collision(box("0.1 0.1 0.05"))):
        finding = one(tmp_path, arm_on_base(round_, drawn), {"INR007"})
        assert finding.fix is not None
        assert finding.fix.edits == ()
    corners = ("0 0 0", "0.1 0 0", "0 0.1 0.03", "0 0.02 0.08")
    facets = [
        [corners[i] for i in face] for face in ((0, 1, 3), (0, 3, 2), (1, 2, 3))
    ]  # a tetrahedron without its floor
    text = "".join(
        f"facet normal 0 0 0\nouter loop\n{''.join(f'vertex {at}{chr(10)}' for at in facet)}endloop\nendfacet\n"
        for facet in facets
    )
    (tmp_path / "open.stl").write_text(f"solid s\n{text}endsolid s\n")
    impossible = inertial(0.37, ixx=0.001, iyy=0.001, izz=0.0037)
    hull = one(tmp_path, arm_on_base(impossible, mesh), {"INR003"})
    shape = one(tmp_path, arm_on_base(impossible, mesh + collision(box("0.1 0.1 0.05"))), {"INR003"})
    assert hull.fix is not None
    assert shape.fix is not None
    assert "(the convex hull of the open mesh at this mass and uniform density)" in hull.fix.title
    assert "(the collision shape at this mass and uniform density; the visual mesh is open)" in shape.fix.title
    assert "xyz" not in hull.fix.title + shape.fix.title
    motor = one(tmp_path, arm_on_base(impossible, mesh + collision(box("0.03 0.03 0.03"))), {"INR003"})
    assert motor.fix is not None
    assert "collision shape" not in motor.fix.title


@pytest.mark.parametrize(("place", "is_written"), [("0.0002 0.0236 0.0015", False), ("0 0.0075 0", True)])
@pytest.mark.parametrize(
    ("code", "numbers"),
    [
        ("INR003", {"ixx": 1.486e-6, "iyy": 2e-7, "izz": 8.31e-7}),
        ("INR004", {"ixx": 1.486e-6, "iyy": -2e-7, "izz": 8.31e-7}),
    ],
)
def test_a_collision_shape_of_a_piece_moves_no_com(
    tmp_path: Path, code: str, numbers: dict[str, float], place: str, is_written: bool
) -> None:
    """Nothing is drawn, and what collides is about another COM, or about this one."""
    finger = inertial(0.0113, com="0 0.0073 0", **numbers)
    finding = one(tmp_path, arm_on_base(finger, collision(box("0.012 0.017 0.014"), xyz=place)), {code})
    assert finding.fix is not None
    assert "xyz" not in finding.fix.title
    assert ("for comparison: " in finding.fix.title) != is_written
    assert ("write ixx=" in finding.fix.title) == is_written


# -- numbers that slipped or were copied --------------------------------------------------------------------------------


def test_one_exponent_makes_a_tensor_impossible(tmp_path: Path) -> None:
    drawn = visual(cylinder(0.035, 0.09))
    text = arm_on_base(inertial(0.053, ixx="3.308e-4", iyy="4.65e-5", izz="3.545e-5"), drawn)
    finding = one(tmp_path, text, {"INR003"})
    assert finding.cause is not None
    assert finding.cause.id == "decimal"
    assert finding.fix is not None
    assert 'write ixx="3.308e-5" if its decimal point' in finding.fix.title
    assert finding.fix.edits == ()
    assert finding.headline == "arm: inertia breaks the triangle inequality (by 75.2 %)"


def test_a_slipped_mass_is_named_where_the_tensor_is_that_of_the_right_one(tmp_path: Path) -> None:
    size = (0.066, 0.066, 0.018)
    xx, yy, zz = np.diag(compute_solid_inertia(make_box_solid(size), 0.0949)).tolist()
    fitting = inertial(9.49, ixx=xx, iyy=yy, izz=zz)
    other = inertial(9.49, ixx=100 * xx, iyy=100 * yy, izz=100 * zz)
    drawn = visual(box("0.066 0.066 0.018"))
    finding = one(tmp_path, arm_on_base(fitting, drawn), {"INR010"})
    assert finding.cause is not None
    assert "the mass is 0.0949 kg (0.01 times what is written)" in finding.cause.text
    grams = one(tmp_path, arm_on_base(inertial(94.9, ixx=xx, iyy=yy, izz=zz), drawn), {"INR010"})
    assert grams.cause is not None
    assert "If the number is in grams" in grams.cause.text
    unexplained = one(tmp_path, arm_on_base(other, drawn), {"INR010"})
    assert unexplained.cause is None or unexplained.cause.id != "decimal"


@pytest.mark.parametrize(("mass", "codes"), [(1300, ["INR010"]), (13, [])])
def test_a_slipped_mass_is_named_where_the_hull_has_room_for_it(tmp_path: Path, mass: float, codes: list[str]) -> None:
    """Two plates a metre apart, of 1,300 kg/m³, and a COM that is not theirs."""
    plates = [visual(box("0.5 1 0.01"), xyz=f"0 0 {z}") for z in (-0.5, 0.5)]
    own = [np.diag(compute_solid_inertia(make_box_solid((0.5, 1, 0.01)), 6.5)) for _ in plates]
    xx, yy, zz = (sum(own) + 2 * 6.5 * np.array((0.25, 0.25, 0.0))).tolist()
    text = arm_on_base(inertial(mass, ixx=xx, iyy=yy, izz=zz, com="0.07 0 0" if mass > 100 else ""), *plates)
    found = find(tmp_path, text, {"INR009", "INR010"})
    assert [finding.code for finding in found] == codes
    assert all(finding.fix is not None and "about 13 kg" in finding.fix.title for finding in found)


@pytest.mark.parametrize(
    ("mass", "com", "size", "found"),
    [
        (0.22126, "-0.019666 0.037312 0", "0.06 0.03 0.03", True),
        (0.22127, "-0.019666 0.037312 0", "0.06 0.03 0.03", False),
        (0.22126, "-0.0121 0.0373 0", "0.06 0.03 0.03", False),
        (0.22126, "-0.019666 0.037312 0", "0.101 0.08 0.06", False),
    ],
)
def test_mass_and_com_of_another_part_are_found(tmp_path: Path, mass: float, com: str, size: str, found: bool) -> None:
    elbow = link(
        "elbow", make_box_inertial((0.1, 0.08, 0.06), 0.22126, com="-0.019703 0.037336 0"), visual(box("0.1 0.08 0.06"))
    )
    wrist = link("wrist", make_box_inertial((0.06, 0.03, 0.03), mass, com=com), visual(box(size)))
    text = robot(elbow, wrist, joint("j", "elbow", "wrist"))
    assert [f.message_id for f in find(tmp_path, text, {"INR008"})] == (["mass"] if found else [])


def test_a_placeholder_is_no_copy_and_no_unit(tmp_path: Path) -> None:
    hand = link("hand", inertial(0.007, 0.0015), visual(box("0.032 0.019 0.018")))
    wrist = link("wrist", inertial(0.22, 0.0015), visual(box("0.064 0.034 0.031")))
    found = find(tmp_path, robot(hand, wrist, joint("j", "hand", "wrist")), {"INR007", "INR008", "INR009"})
    assert [finding.code for finding in found] == ["INR007"]


def test_a_twin_in_another_unit_is_named(tmp_path: Path) -> None:
    sides = []
    for name, y, factor in (("left", 0.1, 1.0), ("right", -0.1, 1e9)):
        mesh = visual(f'<mesh filename="{name}.stl"/>')
        thumb = inertial(0.05, ixx=8.6e-5 * factor, iyy=1.64e-4 * factor, izz=2.11e-4 * factor)
        sides += [link(f"{name}_thumb", thumb, mesh), joint(f"{name}_j", "palm", f"{name}_thumb", xyz=f"0 {y} 0")]
    finding = one(tmp_path, robot(link("palm", inertial(1, 0.0113)), *sides), {"SYM004"})
    assert finding.cause is not None
    assert "The tensor of right_thumb is 1,000,000,000 times that of its twin" in finding.cause.text
