"""What is offered as an edit: numbers that leave the link without a finding, and like parts alike."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import arm_on_base, box, collision, find, joint, link, mesh, robot, visual
from castings import (
    CASTING,
    PLASTIC,
    Block,
    drawn_boxes,
    format_inertial,
    geometry,
    open_widely,
    pieces,
    uniform,
    write_stl,
)

from urdfcheck.core import Finding
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia, make_box_solid

POUND, INCH = 0.45359237, 0.0254
EDGES = ((0.1, 0.08, 0.3), (0.12, 0.1, 0.25), (0.09, 0.11, 0.2), (0.07, 0.06, 0.15))


def count_edits(finding: Finding) -> int:
    assert finding.fix is not None
    return len(finding.fix.edits)


@pytest.mark.parametrize(("z", "edits"), [(0.005, 1), (-0.005, 0)])
def test_a_sign_is_edited_if_no_other_sign_is_wrong_then(tmp_path: Path, z: float, edits: int) -> None:
    """A COM that is turned by half a turn about x has two wrong signs, one of a small number."""
    part: tuple[Block, ...] = (((0.1, 0.15, 0.12), (0.0, 0.135, 0.005)),)
    numbers = replace(uniform(geometry(part).solid), com=np.array((0.0, -0.135, z)))
    (finding,) = find(tmp_path, arm_on_base(format_inertial(numbers), drawn_boxes(part)), "INR009")
    assert finding.cause is not None
    assert finding.cause.id == "one_sign"
    assert count_edits(finding) == edits


def make_chain_in_pounds(first: float, *more: str) -> str:
    """Links in pounds and inches; the COM of the first one is at this height (m), and the part's at 0.12."""
    parts = [link("base")]
    for i, edges in enumerate(EDGES):
        mass, com = 2700.0 * float(np.prod(edges)), np.array((0.0, 0.0, 0.12 if i else first))
        tensor = compute_solid_inertia(make_box_solid(edges), mass) / (POUND * INCH**2)
        shape = visual(box(" ".join(map(str, edges))), xyz="0 0 0.12")
        parts += [
            joint(f"j{i}", f"l{i - 1}" if i else "base", f"l{i}", kind="continuous", xyz="0.1 0.2 0.4"),
            link(f"l{i}", format_inertial(DeclaredInertial(mass / POUND, com, tensor)), shape),
        ]
    return robot(*parts, *more)


@pytest.mark.parametrize(("first", "edits"), [(0.12, 16), (0.0, 0)])
def test_a_unit_is_edited_in_all_links_or_in_none(tmp_path: Path, first: float, edits: int) -> None:
    """Pounds and inches in all links, of which the first also lacks its COM: no mass inside it has the tensor then."""
    (finding,) = find(tmp_path, make_chain_in_pounds(first), "INR009")
    assert finding.message_id == "habit"
    assert count_edits(finding) == edits


def test_links_whose_meshes_are_open_may_have_the_mistake_of_their_file(tmp_path: Path) -> None:
    write_stl(tmp_path / "open.stl", CASTING)
    lines = (tmp_path / "open.stl").read_text().split("endfacet\n")
    (tmp_path / "open.stl").write_text("solid part\n" + "endfacet\n".join(lines[1:]))
    shapes = visual(mesh("open.stl")) + collision(box("0.2 0.15 0.1"))
    hand = link("hand", format_inertial(uniform(geometry(CASTING).solid)), shapes)
    text = make_chain_in_pounds(0.12, hand, joint("j", "l0", "hand", kind="continuous"))
    (finding,) = (f for f in find(tmp_path, text, "INR009") if f.message_id == "habit")
    assert finding.message.endswith(". 1 other link has an open visual mesh, which does not show it")
    assert finding.fix is not None
    assert "each of the" not in finding.fix.title


@pytest.mark.parametrize(("factors", "edits"), [((1.0, 1.0, 1.0), 6), ((0.3, 0.7, 0.4), 0)])
def test_one_side_is_edited_if_it_is_known_what_is_wrong_with_the_other(
    tmp_path: Path, factors: tuple[float, ...], edits: int
) -> None:
    """The left arm lacks the parallel-axis term; the right one is a little longer."""
    longer: tuple[Block, ...] = (((0.3, 0.06, 0.04), (0.03, 0.02, 0.05)), *CASTING[1:])
    lacking = sum(compute_solid_inertia(piece, PLASTIC * piece.volume) for piece in pieces(CASTING))
    left, right = uniform(geometry(CASTING).solid), uniform(geometry(longer).solid)
    left = replace(left, tensor=lacking)
    right = replace(right, tensor=right.tensor if edits else np.diag(right.tensor.diagonal() * factors))
    parts = []
    for name, numbers, blocks, y in (("l_arm", left, CASTING, 0.5), ("r_arm", right, longer, -0.5)):
        parts += [
            joint(f"{name}_joint", "base", name, kind="continuous", xyz=f"0 {y} 0"),
            link(name, format_inertial(numbers), drawn_boxes(blocks)),
        ]
    causes = {f.subjects: f for f in find(tmp_path, robot(link("base"), *parts), "INR009") if f.cause is not None}
    (finding,) = causes.values()
    assert finding.cause is not None
    assert finding.cause.id == "steiner_missing"
    assert count_edits(finding) == edits


@pytest.mark.parametrize(("sign", "advised"), [(1.0, False), (-1.0, True), (0.0, False), (5.0, False)])
def test_products_that_fit_keep_their_signs(tmp_path: Path, sign: float, advised: bool) -> None:
    """The COM is on the wrong side in x; the products with x are those of the drawn part, the opposite, zero, or those of a part
    that is not uniform."""
    blocks = [(size, np.add(place, (0.2, 0.0, 0.0))) for size, place in CASTING]
    true = uniform(geometry(blocks).solid)
    signs = np.ones((3, 3))
    signs[0, 1:] = signs[1:, 0] = sign
    numbers = replace(true, com=true.com * (-1.0, 1.0, 1.0), tensor=true.tensor * signs)
    (finding,) = find(tmp_path, arm_on_base(format_inertial(numbers), drawn_boxes(blocks)), "INR006")
    assert finding.message_id == "sign"
    assert finding.fix is not None
    assert ("flip the signs of ixy and ixz" in finding.fix.title) == advised


def test_the_products_of_a_hull_do_not_show_signs(tmp_path: Path) -> None:
    """The mesh lacks facets, so that the products of the part are not known."""
    blocks = [(size, np.add(place, (0.2, 0.0, 0.0))) for size, place in CASTING]
    write_stl(tmp_path / "part.stl", blocks)
    open_widely(tmp_path / "part.stl")
    true = uniform(geometry(blocks).solid)
    numbers = replace(true, com=true.com * (-1.0, 1.0, 1.0))
    numbers.tensor[0, 1:] *= -1.0
    numbers.tensor[1:, 0] *= -1.0
    (finding,) = find(tmp_path, arm_on_base(format_inertial(numbers), visual(mesh("part.stl"))), "INR006")
    assert finding.message_id == "sign"
    assert finding.fix is not None
    assert "signs" not in finding.fix.title


@pytest.mark.parametrize(("count", "named"), [(3, True), (2, False)])
def test_coms_in_the_frame_of_the_root_are_one_mistake(tmp_path: Path, count: int, named: bool) -> None:
    """Of three links the COMs are where the parts are in the root's frame, or of two; the last one is turned."""
    parts = [link("base")]
    for i, edges in enumerate(EDGES[:3]):
        tensor = compute_solid_inertia(make_box_solid(edges), 2.0)
        rpy, com = ("1.5707963 0 0", (0.3, 0.4, 0.9)) if i == 2 else ("", (0.1 * (i + 1), 0.0, 0.4 * (i + 1)))
        place = (0.0, 0.0, 0.0) if i >= count else com
        numbers = DeclaredInertial(2.0, np.array(place), tensor)
        above, xyz = (f"l{i - 1}", "0.1 0 0.4") if i < 2 else ("l1", "0.1 0.4 0.1")
        parts += [
            joint(f"j{i}", above if i else "base", f"l{i}", kind="continuous", xyz=xyz, rpy=rpy),
            link(f"l{i}", format_inertial(numbers), visual(box(" ".join(map(str, edges))))),
        ]
    found = find(tmp_path, robot(*parts), "INR006")
    assert {f.cause.id for f in found if f.cause is not None} == ({"root"} if named else set())
