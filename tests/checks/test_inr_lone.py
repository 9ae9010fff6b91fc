"""What is said of one link's unit, decimal point or COM, alone and beside the links of its file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import arm_on_base, box, collision, find, joint, link, mesh, robot, visual
from castings import CASTING, drawn_boxes, format_inertial, geometry, steiner, triangles, uniform

from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.diagnosis import diagnose_inertial
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia, make_box_solid

TRUE = uniform(geometry(CASTING).solid)
# Edges in m of parts that differ, and their masses in kg.
EDGES = ((0.1, 0.08, 0.3), (0.12, 0.1, 0.25), (0.09, 0.11, 0.2), (0.07, 0.06, 0.15), (0.08, 0.05, 0.12))
MASSES = (3.1, 4.2, 2.7, 1.3, 0.8)
PLACE = np.array((0.0, 0.0, 0.05))


def make_part(i: int) -> DeclaredInertial:
    return DeclaredInertial(MASSES[i], PLACE, compute_solid_inertia(make_box_solid(EDGES[i]), MASSES[i]))


def make_chain(numbers: list[DeclaredInertial]) -> str:
    parts = [link("base")]
    for i, one in enumerate(numbers):
        edges = EDGES[i % len(EDGES)]
        parts += [
            joint(f"j{i}", f"l{i - 1}" if i else "base", f"l{i}", kind="continuous", xyz="0.1 0.2 0.4"),
            link(f"l{i}", format_inertial(one, 8), visual(box(" ".join(map(str, edges))), xyz="0 0 0.05")),
        ]
    return robot(*parts)


@pytest.mark.parametrize(
    ("com", "cause", "detail"),
    [
        ((0.0, 0.0, 0.6), "decimal_point", "com z 0.1"),
        ((0.0, 0.0, 6.0), "decimal_point", "com z 0.01"),
        ((0.0, 0.0, 60.0), "com_unit", "mm"),
        ((4.0, 0.0, 6.0), "com_unit", "cm"),
    ],
)
def test_one_coordinate_in_centimetres_is_a_decimal_point(
    com: tuple[float, float, float], cause: str, detail: str
) -> None:
    """Both lead to the same number, and no program writes one link of a file in centimetres."""
    place = (0.04 if com[0] else 0.0, 0.0, 0.06)
    part = geometry([((0.06, 0.02, 0.02), place)])
    found = diagnose_inertial(replace(uniform(part.solid), com=np.array(com)), part)
    assert found is not None
    assert (found.cause, found.detail) == (cause, detail)


@pytest.mark.parametrize(("density", "is_edited"), [(1.0, True), (1.284, False)])
def test_a_decimal_point_of_a_moment_is_edited_where_the_rest_fits(
    tmp_path: Path, density: float, is_edited: bool
) -> None:
    """Second moments 1.284 times the uniform part's leave a mismatch of 0.43, which one factor in twenty leaves by chance."""
    slipped = replace(TRUE, tensor=density * TRUE.tensor * np.where(np.eye(3)[2] * np.eye(3), 0.1, 1.0))
    text = arm_on_base(format_inertial(slipped, 8), drawn_boxes(CASTING))
    (finding,) = find(tmp_path, text, {"INR003", "INR009"})
    assert finding.cause is not None
    assert "izz 10" in finding.message + finding.cause.text
    assert finding.fix is not None
    assert bool(finding.fix.edits) == is_edited


@pytest.mark.parametrize("lone", [(1e3, 1.0), (1.0 / 0.0254**2, 1.0 / 0.0254)])
def test_the_unit_of_a_file_is_reported_once(tmp_path: Path, lone: tuple[float, float]) -> None:
    """Tensors in g·m², four of which have the axes of another frame, and one is exactly the drawn part's, or is that with its COM
    in inches."""
    numbers = []
    for i in range(5):
        part = make_part(i)
        turned = np.roll(np.diag(part.tensor), 1) * (1.3, 0.9, 1.1)
        moved = replace(part, com=part.com + 0.02, tensor=1e3 * np.diag(turned))
        numbers.append(replace(part, tensor=lone[0] * part.tensor, com=lone[1] * part.com) if i == 2 else moved)
    (finding,) = find(tmp_path, make_chain(numbers), {"INR005", "INR009"})
    assert (finding.code, finding.message_id, len(finding.subjects)) == ("INR005", "unit", 5)
    assert finding.data["explains"] == ["INR009 link[l2]"]


@pytest.mark.parametrize(("last", "messages"), [(1e-5, set()), (2e-5, {"mass", "named"})])
def test_a_mass_lighter_than_air_shows_no_unit_of_the_tensors(tmp_path: Path, last: float, messages: set[str]) -> None:
    """Tensors that are those of the parts in plastic: they fit kg·cm² at masses of 0.01 g too. One mass for all is INR015's."""
    parts = [replace(make_part(i), mass=1e-5 if i else last) for i in range(5)]
    found = find(tmp_path, make_chain(parts), {"INR005", "INR009"})
    assert {finding.message_id for finding in found} == messages
    assert not any("cm²" in finding.message for finding in found)


@pytest.mark.parametrize(("mass", "found"), [(1e-5, False), (1e-2, True)])
def test_one_round_mass_of_a_heavier_robot_does_not_hide_the_tensors(tmp_path: Path, mass: float, found: bool) -> None:
    """Each part is larger than foam of this mass, and has the tensor that it has in plastic."""
    numbers = [replace(make_part(i), mass=mass) for i in range(5)]
    assert bool(find(tmp_path, make_chain(numbers), {"INR005", "INR009"})) == found


@pytest.mark.parametrize("is_habit", [True, False])
def test_a_com_of_zero_is_compared_with_those_of_the_file(tmp_path: Path, is_habit: bool) -> None:
    numbers = []
    for i in range(5):
        part = make_part(i)
        about_origin = part.tensor + steiner(part.mass, PLACE)
        numbers.append(replace(part, com=np.zeros(3), tensor=about_origin) if is_habit else part)
    exceeding = 1.01234 * np.array(((0.08, 0.02, 0.01), (0.02, 0.09, 0.012), (0.01, 0.012, 0.1)))
    numbers.append(DeclaredInertial(MASSES[0], np.zeros(3), exceeding))
    (finding,) = (f for f in find(tmp_path, make_chain(numbers), {"INR005", "INR009"}) if f.code == "INR005")
    said = ". Its COM is 0 0 0, like those of 5 other links whose COM was left at zero (INR009)" in finding.message
    assert said == is_habit


@pytest.mark.parametrize("is_one_density", [True, False])
def test_tensors_of_one_density_are_one_finding(tmp_path: Path, is_one_density: bool) -> None:
    """Weighed masses beside tensors of a hundred times 1000 kg/m³: alone, each link fits another mass or decimal point."""
    numbers = []
    for i, edges in enumerate(EDGES):
        solid = make_box_solid(edges)
        density = 1e5 if is_one_density else 1e5 * 1.3**i
        tensor = compute_solid_inertia(solid, density * solid.volume)
        numbers.append(DeclaredInertial((900 + 130 * i) * solid.volume, PLACE, tensor))
    found = find(tmp_path, make_chain(numbers), "INR009")
    assert any(f.message_id == "density" for f in found) == is_one_density
    if is_one_density:
        (finding,) = found
        assert "at 100,000 kg/m³, 100 times those at 1,000 kg/m³, but" in finding.message
        assert "100,000 kg/m³" in finding.message
        assert finding.cause is None
        assert finding.fix is not None
        assert not finding.fix.edits


@pytest.mark.parametrize("moved", [0.0, 0.3])
def test_a_collision_shape_that_is_elsewhere_is_no_missing_com(tmp_path: Path, moved: float) -> None:
    """The visual mesh is open, so that the collision box is compared; in the second case it is beside the drawn part."""
    tensor = compute_solid_inertia(make_box_solid((0.2, 0.1, 0.06)), 1.0)
    numbers = DeclaredInertial(1.0, np.zeros(3), 1.3 * tensor)
    faces = [line for k, line in enumerate(write_box((0.2, 0.1, 0.06)).split("endfacet\n")) if k]
    shapes = visual(mesh("open.stl"), xyz=f"{0.3 - moved} 0 0") + collision(box("0.2 0.1 0.06"), xyz="0.3 0 0")
    files = {
        "robot.urdf": arm_on_base(format_inertial(numbers, 8), shapes),
        "open.stl": "solid o\n" + "endfacet\n".join(faces),
    }
    causes = [f.cause.id for f in find(tmp_path, files, {"INR009"}) if f.cause is not None]
    assert causes == ([] if moved else ["com_missing"])


def write_box(size: tuple[float, float, float]) -> str:
    corners, faces = triangles([(size, (0.0, 0.0, 0.0))])
    lines = []
    for face in faces.tolist():
        points = "".join("vertex {:.9g} {:.9g} {:.9g}\n".format(*corners[i]) for i in face)
        lines.append(f"facet normal 0 0 0\nouter loop\n{points}endloop\nendfacet\n")
    return "".join(lines) + "endsolid o\n"


@pytest.mark.parametrize(("density", "said"), [(1006.0, "at 1,000 kg/m³, but"), (2712.0, "at 2,710 kg/m³, but")])
def test_facets_do_not_change_the_density_that_programs_assume(tmp_path: Path, density: float, said: str) -> None:
    numbers = []
    for i, edges in enumerate(EDGES):
        solid = make_box_solid(edges)
        tensor = compute_solid_inertia(solid, density * solid.volume)
        numbers.append(DeclaredInertial((9000 + 800 * i) * solid.volume, PLACE, tensor))
    assert [said in f.message for f in find(tmp_path, make_chain(numbers), "INR009")] == [True]


# -- units of mass that only a density shows ----------------------------------------------------------------------------

BEAD = make_box_solid((0.01, 0.01, 0.01))


def make_bead(mass: float) -> DeclaredInertial:
    """A cube of a centimetre with its tensor in kg·mm², or with mass and tensor in g and g·mm²."""
    return DeclaredInertial(mass, np.zeros(3), 0.93e6 * compute_solid_inertia(BEAD, mass))


@pytest.mark.parametrize(("mass", "detail"), [(0.005, "kg·mm²"), (0.1, "g and g·mm² or kg·mm²"), (1.0, "g and g·mm²")])
def test_units_that_lead_to_the_same_numbers_are_named_once(mass: float, detail: str) -> None:
    """A COM of zero is the same in millimetres."""
    found = diagnose_inertial(make_bead(mass), geometry([((0.01, 0.01, 0.01), (0.0, 0.0, 0.0))]))
    assert found is not None
    assert found.detail == detail


@pytest.mark.parametrize(
    ("role", "heaviest", "message", "why"),
    [
        (collision, 2.0, "cause", "kg·mm² or g and g·mm²"),
        (collision, 0.5, "named", "g and g·mm²"),  # of all masses it alone is that of no such part
        (visual, 2.0, "named", "g and g·mm²"),  # so dense is no material
    ],
)
def test_the_density_of_a_collision_shape_shows_no_unit_of_the_mass(
    tmp_path: Path, role: Callable[[str], str], heaviest: float, message: str, why: str
) -> None:
    """The masses of the file are in kilograms, and the tensor fits one of its units as well."""
    arm = DeclaredInertial(heaviest, np.zeros(3), 1e4 * compute_solid_inertia(BEAD, heaviest))
    text = robot(
        link("base", format_inertial(arm, 8)),
        joint("j", "base", "hand", kind="continuous", xyz="0.1 0 0"),
        link("hand", format_inertial(make_bead(1.0), 8), role(box("0.01 0.01 0.01"))),
    )
    (finding,) = find(tmp_path, text, "INR009")
    assert (finding.message_id, f"({why}?)" in finding.headline) == (message, True)
    assert bool(finding.fix and finding.fix.edits) == (message != "cause")


def test_a_unit_of_most_links_is_that_of_a_collision_shape_too(tmp_path: Path) -> None:
    numbers = [replace(make_part(i), tensor=1e6 * make_part(i).tensor) for i in range(5)]
    hand = link("hand", format_inertial(make_bead(0.5), 8), collision(box("0.01 0.01 0.01")))
    more = joint("h", "l4", "hand", kind="continuous", xyz="0.1 0 0") + hand
    (finding,) = find(tmp_path, make_chain(numbers).replace("</robot>", f"{more}</robot>"), "INR009")
    assert finding.message.startswith("6 of 6 links fit one mistake (unit of the tensor: kg·mm²)")


def test_what_most_links_are_compared_with_is_named(tmp_path: Path) -> None:
    """An open mesh has only the tensor of its hull."""
    files = {}
    numbers = [replace(make_part(i), tensor=1.3e6 * make_part(i).tensor) for i in range(5)]
    text = make_chain(numbers)
    for i, edges in enumerate(EDGES):
        faces = [line for k, line in enumerate(write_box(edges).split("endfacet\n")) if k]
        files[f"{i}.stl"] = "solid o\n" + "endfacet\n".join(faces)
        text = text.replace(box(" ".join(map(str, edges))), mesh(f"{i}.stl"))
    (finding,) = find(tmp_path, files | {"robot.urdf": text}, "INR009")
    assert "the median tensor is 30 % off that of the convex hull of the open mesh instead of" in finding.message
