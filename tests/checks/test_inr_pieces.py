"""Parts whose bodies were added without the parallel-axis term: the mistake of a program, so that all links have it."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import box, find, joint, link, mesh, robot, visual
from castings import CASTING, MISTAKES, Block, drawn_boxes, edited, format_inertial, geometry, uniform, write_stl

from urdfcheck.core import Finding
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.inertia_tensor import (
    combine_solids,
    compute_solid_inertia,
    make_box_solid,
    transform_solid,
)
from urdfcheck.facts.motion.kinematics import rpy_to_matrix

# The arms of an L of 30 mm width and 50 mm depth (m), as two blocks that touch.
LONG, HIGH, WIDE, DEEP = 0.2, 0.15, 0.03, 0.05
ELBOW: tuple[Block, ...] = (
    ((LONG, WIDE, DEEP), (LONG / 2, WIDE / 2, 0.0)),
    ((WIDE, HIGH - WIDE, DEEP), (WIDE / 2, (HIGH + WIDE) / 2, 0.0)),
)
DRAWN = geometry(CASTING)
ADDED = {name: make for name, _, make in MISTAKES}["steiner_missing"]


def write_elbow() -> str:
    """Return the L as one closed mesh, which no search for bodies takes apart."""
    outline = [(WIDE, WIDE), (WIDE, HIGH), (0.0, HIGH), (0.0, 0.0), (LONG, 0.0), (LONG, WIDE)]
    low, high = ([(x, y, z) for x, y in outline] for z in (-DEEP / 2, DEEP / 2))
    faces = []
    for i in range(1, 5):
        faces += [(high[0], high[i], high[i + 1]), (low[0], low[i + 1], low[i])]
    for i in range(6):
        j = (i + 1) % 6
        faces += [(low[i], low[j], high[j]), (low[i], high[j], high[i])]
    lines = [
        "facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in face)
        + "endloop\nendfacet" for face in faces
    ]  # fmt: skip
    return "\n".join(("solid elbow", *lines, "endsolid elbow"))


def make_robot(arm: DeclaredInertial, elbow: DeclaredInertial, place: str = "") -> dict[str, str]:
    text = robot(
        link("arm", format_inertial(arm, 8), drawn_boxes(CASTING)),
        joint("j", "arm", "elbow", kind="continuous", xyz="0.3 0 0"),
        link("elbow", format_inertial(elbow, 8), visual(mesh("elbow.stl"), xyz=place)),
    )
    return {"robot.urdf": text, "elbow.stl": write_elbow()}


def add_without_term() -> DeclaredInertial:
    return ADDED(uniform(geometry(ELBOW).solid), geometry(ELBOW))


def test_a_mesh_of_one_piece_has_the_mistake_of_its_file(tmp_path: Path) -> None:
    files = make_robot(ADDED(uniform(DRAWN.solid), DRAWN), add_without_term())
    (finding,) = find(tmp_path, files, "INR009")
    assert finding.headline == "2 of 2 links: wrong inertia (no parallel-axis term)"
    assert [subject.partition("/")[0] for subject in finding.subjects] == ["link[arm]", "link[elbow]"]
    assert finding.fix is not None
    repaired = edited(files["robot.urdf"], finding.fix.edits)
    assert not find(tmp_path / "repaired", {**files, "robot.urdf": repaired}, {"INR003", "INR005", "INR009"})


def test_like_pieces_with_the_com_of_all_were_added_and_are_not_one_of_them(tmp_path: Path) -> None:
    """Two plates side by side, added without the term, have the tensor of one plate with the mass of both."""
    plates: tuple[Block, ...] = tuple(((0.043, 0.0057, 0.003), (0.0075, side, 0.0)) for side in (0.0055, -0.0055))
    numbers = ADDED(uniform(geometry(plates).solid), geometry(plates))
    (finding,) = find(tmp_path, robot(link("plates", format_inertial(numbers, 8), drawn_boxes(plates))), "INR009")
    assert finding.cause is not None
    assert finding.cause.id == "steiner_missing"


def test_the_missing_term_of_one_mesh_proves_nothing_by_itself(tmp_path: Path) -> None:
    assert not find(tmp_path, make_robot(uniform(DRAWN.solid), add_without_term()), "INR009")


def test_the_mistake_of_the_file_goes_before_another_that_fits_half(tmp_path: Path) -> None:
    numbers, (first, second) = add_without_term(), (np.array(centre) for _, centre in ELBOW)
    whole = uniform(geometry(ELBOW).solid)
    missing = float(np.trace(whole.tensor - numbers.tensor)) / 2.0 / numbers.mass
    line = (second - first) / float(np.linalg.norm(second - first))
    place = 0.9 * missing**0.5 * line - whole.com  # as if the parallel-axis term had been subtracted once more
    files = make_robot(
        ADDED(uniform(DRAWN.solid), DRAWN), replace(numbers, com=whole.com + place), " ".join(map(repr, place.tolist()))
    )
    (finding,) = find(tmp_path, files, "INR009")
    assert finding.headline == "2 of 2 links: wrong inertia (no parallel-axis term)"


@pytest.mark.parametrize(
    "stretch",
    [(1.0, 1.0, 1.1), (1.1, 1.0, 1.0)],
    ids=["another depth, too", "another length"],
)
def test_another_difference_is_no_missing_term(tmp_path: Path, stretch: tuple[float, ...]) -> None:
    other = add_without_term()
    scaled = replace(other, tensor=np.diag(stretch) @ other.tensor @ np.diag(stretch))
    (finding,) = find(tmp_path, make_robot(ADDED(uniform(DRAWN.solid), DRAWN), scaled), "INR009")
    assert [subject.partition("/")[0] for subject in finding.subjects] == ["link[arm]"]


def test_an_inertial_in_the_frame_of_the_mesh_is_named_and_brought_to_the_link(tmp_path: Path) -> None:
    numbers = format_inertial(uniform(geometry(ELBOW).solid))

    def find_elbow(place: str) -> list[Finding]:
        text = robot(
            link("base"),
            joint("j", "base", "elbow", kind="continuous"),
            link("elbow", numbers, visual(mesh("elbow.stl"), xyz=place, rpy="0 0 1.5707963267948966")),
        )
        return find(tmp_path, {"robot.urdf": text, "elbow.stl": write_elbow()}, {"INR006", "INR009"})

    (finding,) = find_elbow("0 0 -0.18")
    assert finding.cause is not None
    assert (finding.code, finding.cause.id) == ("INR009", "mesh_frame")
    assert finding.fix is not None
    assert not finding.fix.edits
    assert "-0.18" in finding.fix.title


def test_half_a_turn_of_the_mesh_is_not_called_mirrored(tmp_path: Path) -> None:
    numbers = format_inertial(uniform(DRAWN.solid))
    text = robot(
        link("base"),
        joint("j", "base", "part", kind="continuous"),
        link("part", numbers, visual(mesh("part.stl"), rpy="3.14 0 0")),
    )
    write_stl(tmp_path / "part.stl", CASTING)
    (finding,) = find(tmp_path, text, "INR009")
    assert finding.cause is not None
    assert finding.cause.id == "mesh_frame"
    x, y, z = DRAWN.solid.com
    assert finding.fix is not None
    written = re.search('xyz="(.*?)"', finding.fix.title)
    assert written is not None
    assert np.allclose([float(one) for one in written[1].split()], (x, -y, -z), atol=2e-3 * abs(z) + 2e-3 * abs(y))


@pytest.mark.parametrize("is_of_mesh", [True, False])
def test_a_tensor_that_does_not_fit_in_the_frame_of_the_mesh_is_left_as_it_is(tmp_path: Path, is_of_mesh: bool) -> None:
    numbers = uniform(geometry(ELBOW).solid)
    if not is_of_mesh:
        numbers = replace(numbers, tensor=np.trace(numbers.tensor) * np.diag([0.31, 0.33, 0.36]))
    text = robot(
        link("base"),
        joint("j", "base", "elbow", kind="continuous"),
        link(
            "elbow",
            format_inertial(numbers),
            visual(mesh("elbow.stl"), xyz="0 0 -0.18", rpy="0 0 1.5707963267948966"),
        ),
    )
    (finding,) = find(tmp_path, {"robot.urdf": text, "elbow.stl": write_elbow()}, {"INR009"})
    assert finding.cause is not None
    assert finding.cause.id == "mesh_frame"
    assert finding.fix is not None
    assert ("ixx=" in finding.fix.title) == is_of_mesh


def make_tilted_link(name: str, scale: float) -> str:
    """Return a link of two boxes in no one's axes, whose tensors were added about their own COMs, with CAD's signs."""
    rpy = (0.03, 0.05, 0.05)
    solids = [
        transform_solid(make_box_solid(tuple(scale * e for e in size)), rpy_to_matrix(rpy), scale * np.array(place))
        for size, place in CASTING
    ]
    whole = combine_solids(solids)
    added = sum(compute_solid_inertia(solid, 2700 * solid.volume) for solid in solids)
    tensor = 2.0 * np.diag(np.diag(added)) - added
    numbers = DeclaredInertial(2700 * whole.volume, whole.com, tensor)
    drawn = [
        visual(
            box(" ".join(str(scale * e) for e in size)),
            xyz=" ".join(str(scale * e) for e in place),
            rpy=" ".join(map(str, rpy)),
        )
        for size, place in CASTING
    ]
    return link(name, format_inertial(numbers, 8), *drawn)


def test_the_signs_of_the_products_are_mended_before_the_term_is_added(tmp_path: Path) -> None:
    upper, lower = make_tilted_link("upper", 1.0), make_tilted_link("lower", 1.3)
    text = robot(upper, joint("j", "upper", "lower", kind="continuous", xyz="0.3 0 0"), lower)
    (finding,) = find(tmp_path, text, "INR009")
    assert "the other signs" in finding.message
    assert finding.fix is not None
    repaired = edited(text, finding.fix.edits)
    assert not find(tmp_path / "repaired", repaired, {"INR003", "INR005", "INR009"})


def test_a_copy_of_such_a_part_has_the_mistake_too_unless_its_com_is_wrong(tmp_path: Path) -> None:
    added = ADDED(uniform(DRAWN.solid), DRAWN)
    files = make_robot(added, add_without_term())
    copies = [
        joint("k", "arm", "near", kind="continuous", xyz="-0.5 0 0"),
        link("near", format_inertial(added, 8), drawn_boxes(CASTING)),
        joint("l", "arm", "shifted", kind="continuous", xyz="0 0 0.7"),
        link("shifted", format_inertial(replace(added, com=added.com + 0.04), 8), drawn_boxes(CASTING)),
    ]
    files["robot.urdf"] = files["robot.urdf"].replace("</robot>", "".join(copies) + "</robot>")
    (finding,) = (one for one in find(tmp_path, files, "INR009") if one.message_id == "habit")
    named = {subject.partition("/")[0] for subject in finding.subjects}
    assert named == {"link[arm]", "link[elbow]", "link[near]"}


def test_the_link_that_a_habit_spoils_most_is_named(tmp_path: Path) -> None:
    """Bars side by side, of which those of one link are far apart."""
    parts = [link("base")]
    for i, (length, apart) in enumerate(((0.3, 0.026), (0.33, 0.027), (0.36, 0.028), (0.4, 0.25))):
        bars = tuple(((length, 0.05, edge), (0.01, y, 0.02)) for y, edge in ((apart, 0.05), (-apart, 0.04)))
        shape = geometry(bars)
        numbers = ADDED(uniform(shape.solid), shape)
        place = joint(f"j{i}", "base", f"l{i}", kind="continuous", xyz=f"0 0 {i}")
        parts += [place, link(f"l{i}", format_inertial(numbers, 8), drawn_boxes(bars))]
    (finding,) = (one for one in find(tmp_path, robot(*parts), "INR009") if one.message_id == "habit")
    assert " % (l3: " in finding.message


@pytest.mark.parametrize("com", [0.0, 0.02])
def test_more_pieces_than_the_mesh_shows_get_the_drawn_tensor(tmp_path: Path, com: float) -> None:
    """The fin is two pieces in the CAD program, and one in the drawing."""
    (edges, (x, y, z)) = CASTING[1]
    half = (edges[0], edges[1] / 2, edges[2])
    finer = geometry((CASTING[0], (half, (x, y - edges[1] / 4, z)), (half, (x, y + edges[1] / 4, z)), CASTING[2]))
    true = uniform(DRAWN.solid)
    numbers = replace(ADDED(true, finer), com=true.com + com)
    text = robot(
        link("base"),
        joint("j", "base", "arm", kind="continuous"),
        link("arm", format_inertial(numbers, 8), drawn_boxes(CASTING)),
    )
    (finding,) = find(tmp_path, text, "INR009")
    assert finding.cause is not None
    assert finding.cause.id == "steiner_missing"
    assert finding.fix is not None
    # A COM elsewhere shows that the pieces have other densities than the drawing: no number of theirs is known.
    assert bool(finding.fix.edits) == (com == 0.0)
    assert finding.fix.title.startswith("compute the inertial again") == (com != 0.0)
    if com == 0.0:
        written = float(edited(text, finding.fix.edits).partition('ixx="')[2].partition('"')[0])
        assert abs(written / true.tensor[0, 0] - 1.0) < 1e-3
