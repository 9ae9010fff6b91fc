"""What a convex hull in place of an open mesh does not show, and open meshes that are measured like closed ones."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from builders import arm_on_base, box, find, joint, link, mesh, robot, sphere, visual
from castings import CASTING, format_inertial, geometry, open_widely, triangles, uniform, write_stl
from numpy.typing import NDArray

from urdfcheck.core import Severity
from urdfcheck.facts.mesh.measure import measure_mesh, restore_mesh_facts

EMPTY = (
    '<xacro:macro name="{}"><inertial><mass value="0.0001"/>'
    '<inertia ixx="0.0001" ixy="0" ixz="0" iyy="0.0001" iyz="0" izz="0.0001"/></inertial></xacro:macro>'
)


def drop_facet(path: Path) -> None:
    text = path.read_text(encoding="ascii")
    path.write_text(text[: text.rindex("facet normal")] + "endsolid part\n", encoding="ascii")


def test_a_small_hole_of_a_mesh_is_filled(tmp_path: Path) -> None:
    """A facet of the post is missing, which is flat: the mesh is that of the casting."""
    write_stl(tmp_path / "part.stl", CASTING)
    drop_facet(tmp_path / "part.stl")
    facts = measure_mesh((tmp_path / "part.stl").read_bytes(), "stl")
    assert not facts.closed
    assert facts.filled_moments is not None
    solid = geometry(CASTING).solid
    assert facts.filled_moments.volume == pytest.approx(solid.volume)
    assert np.allclose(facts.filled_moments.com, solid.com)
    assert np.allclose(facts.filled_moments.covariance, solid.covariance)


@pytest.mark.parametrize("damage", [drop_facet, open_widely])
def test_what_fills_the_holes_is_kept(tmp_path: Path, damage: Callable[[Path], None]) -> None:
    write_stl(tmp_path / "part.stl", CASTING)
    damage(tmp_path / "part.stl")
    parts: dict[str, Mapping[str, NDArray[Any]]] = {}
    first = measure_mesh((tmp_path / "part.stl").read_bytes(), "stl", parts).filled_moments
    del parts["surface"]  # of which it would be computed again
    again = restore_mesh_facts(parts)
    assert again is not None
    assert (again.filled_moments is None) == (first is None)
    for name in ("volume", "com", "covariance", "flat_faces"):
        assert first is None or np.array_equal(getattr(again.filled_moments, name), getattr(first, name))


def test_a_hole_that_may_change_the_volume_is_not_filled(tmp_path: Path) -> None:
    write_stl(tmp_path / "part.stl", CASTING)
    open_widely(tmp_path / "part.stl")
    facts = measure_mesh((tmp_path / "part.stl").read_bytes(), "stl")
    assert facts.filled_moments is None


def test_sheets_that_are_small_and_far_apart_are_not_solids() -> None:
    """Each of two squares, 2 m apart, has 50 times its own width to the middle of the mesh; filled, neither has a volume."""
    square = ((0.0, 0.0), (0.01, 0.0), (0.01, 0.01), (0.0, 0.01))
    facets = [[(x, *square[i]) for i in corners] for x in (-1.0, 1.0) for corners in ((0, 1, 2), (0, 2, 3))]
    facets[:2] = [facet[::-1] for facet in facets[:2]]
    loops = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join(f"vertex {x} {y} {z}\n" for x, y, z in facet)
        + "endloop\nendfacet\n"
        for facet in facets
    )
    facts = measure_mesh(f"solid part\n{loops}endsolid part\n".encode(), "stl")
    assert facts.open_edges == 8
    assert facts.filled_moments is None


def test_a_fin_on_a_mesh_is_filled_like_a_hole(tmp_path: Path) -> None:
    """A small facet stands on an edge of the mesh, which three facets have: it bounds nothing."""
    corners, faces = triangles(CASTING)
    a, b = corners[faces[0][0]], corners[faces[0][1]]
    fin = [a, b, (a + b) / 2 + np.array((-0.002, 0.0, 0.002))]
    write_stl(tmp_path / "part.stl", CASTING)
    text = (tmp_path / "part.stl").read_text(encoding="ascii")
    lines = "".join(f"vertex {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in fin)
    facet = f"facet normal 0 0 0\nouter loop\n{lines}endloop\nendfacet\nendsolid"
    facts = measure_mesh(text.replace("endsolid", facet).encode(), "stl")
    assert (facts.closed, facts.non_manifold_edges) == (False, 1)
    assert facts.filled_moments is not None
    assert facts.filled_moments.volume == pytest.approx(geometry(CASTING).solid.volume, rel=1e-3)


def test_an_inertial_of_a_mesh_with_a_small_hole_is_right(tmp_path: Path) -> None:
    """The hull of the mesh has twice the moments, and its COM elsewhere."""
    write_stl(tmp_path / "part.stl", CASTING)
    drop_facet(tmp_path / "part.stl")
    numbers = uniform(geometry(CASTING).solid)
    assert not find(tmp_path, arm_on_base(format_inertial(numbers), visual(mesh("part.stl"))), "INR009", pedantic=True)
    (finding,) = find(
        tmp_path,
        arm_on_base(format_inertial(replace(numbers, com=np.zeros(3))), visual(mesh("part.stl"))),
        "INR009",
    )
    assert "convex hull" not in finding.message


@pytest.mark.parametrize("closed", [True, False])
def test_coms_of_hulls_are_for_comparison(tmp_path: Path, closed: bool) -> None:
    """All COMs were left at zero. The first link draws an open mesh; the part itself is the example, if one is known."""
    parts = [link("base")]
    for i, scale in enumerate((1.0, 0.8, 1.3, 0.7, 1.1, 0.9, 1.2)):
        blocks = [(np.array(size) * scale, np.array(place) * scale + 0.05) for size, place in CASTING]
        write_stl(tmp_path / f"part{i}.stl", blocks)
        drawn = geometry(blocks)
        is_open = not (closed and i)
        if is_open:
            open_widely(tmp_path / f"part{i}.stl")
        solid = drawn.hull if is_open else drawn.solid
        assert solid is not None
        parts += [
            joint(f"j{i}", f"l{i - 1}" if i else "base", f"l{i}", kind="continuous", xyz="0.1 0.2 0.4"),
            link(f"l{i}", format_inertial(replace(uniform(solid), com=np.zeros(3))), visual(mesh(f"part{i}.stl"))),
        ]
    (finding,) = (one for one in find(tmp_path, robot(*parts), "INR009") if one.message_id == "habit")
    assert finding.fix is not None
    title = finding.fix.title
    assert ("; l1: write " in title) == closed
    assert ("; for comparison: l0 " in title and "(the convex hull of the open mesh)" in title) != closed
    assert "l0: write" not in title


@pytest.mark.parametrize("is_open", [True, False])
def test_signs_of_products_are_not_shown_by_hulls_alone(tmp_path: Path, is_open: bool) -> None:
    parts = [link("base")]
    for i, scale in enumerate((1.0, 0.8, 1.3, 0.7, 1.1, 0.9, 1.2)):
        blocks = [(np.array(size) * scale, np.array(place) * scale) for size, place in CASTING]
        write_stl(tmp_path / f"part{i}.stl", blocks)
        if is_open:
            open_widely(tmp_path / f"part{i}.stl")
        solid = geometry(blocks).hull if is_open else geometry(blocks).solid
        assert solid is not None
        true = uniform(solid)
        flipped = replace(true, tensor=2.0 * np.diag(np.diag(true.tensor)) - true.tensor)
        parts += [
            joint(f"j{i}", f"l{i - 1}" if i else "base", f"l{i}", kind="continuous", xyz="0.1 0.2 0.4"),
            link(f"l{i}", format_inertial(flipped), visual(mesh(f"part{i}.stl"))),
        ]
    causes = {f.cause and f.cause.id for f in find(tmp_path, robot(*parts), "INR009", pedantic=True)}
    assert ("products_sign" in causes) != is_open


def test_a_drawing_that_cannot_hold_the_mass_is_a_part_of_the_body(tmp_path: Path) -> None:
    """A frame of rods: its hull could hold the mass, and the rods themselves would be denser than lead."""
    rods = [((0.1, 0.004, 0.004), (0.0, y, 0.0)) for y in (-0.02, 0.02)]
    write_stl(tmp_path / "rods.stl", rods)
    for mass, severity in ((0.05, Severity.INFO), (0.03, Severity.WARNING)):
        numbers = (
            f'<inertial><mass value="{mass}"/><inertia ixx="{1e-3 * mass}" ixy="0" ixz="0"'
            f' iyy="{2.3e-3 * mass}" iyz="0" izz="{3.1e-3 * mass}"/></inertial>'
        )
        found = find(tmp_path, arm_on_base(numbers, visual(mesh("rods.stl"))), "INR005", pedantic=True)
        assert [finding.severity for finding in found] == [severity]


@pytest.mark.parametrize(("com", "written"), [("0 0 -1.9", False), ("0 0 -1.8", True)])
def test_of_a_body_that_links_share_no_share_is_proposed(tmp_path: Path, com: str, written: bool) -> None:
    tensor = '<inertia ixx="{}" ixy="0" ixz="0" iyy="{}" iyz="0" izz="0.001"/></inertial>'
    start = '<inertial><origin xyz="{}"/><mass value="5"/>'
    text = robot(
        link("base"),
        joint("jx", "base", "cable_x", kind="continuous", axis="1 0 0", xyz="0 0 3"),
        link("cable_x", start.format(com), tensor.format(35, 36)),
        joint("jy", "cable_x", "cable_y", kind="continuous", axis="0 1 0"),
        link("cable_y", start.format("0 0 -1.9"), tensor.format(1, 58), visual(box("0.1 0.1 3"), xyz="0 0 -1.9")),
    )
    found = {f.subjects[0].partition("]")[0]: f for f in find(tmp_path, text, "INR003")}
    finding = found["link[cable_y"]
    assert finding.fix is not None
    assert ("the drawn part at this mass" in finding.fix.title) == written


def test_a_tensor_of_another_mass_is_not_called_typed(tmp_path: Path) -> None:
    tensor = '<inertia ixx="{0}" ixy="0" ixz="0" iyy="{0}" iyz="0" izz="{0}"/></inertial>'
    for moment, written in (
        ("9.6e-06", "that of 0.06 kg with the shape of arm"),
        ("1e-05", "typed rather than computed"),
    ):
        numbers = '<inertial><mass value="5"/>' + tensor.format(moment)
        (finding,) = find(tmp_path, arm_on_base(numbers, visual(sphere(0.02))), "INR007")
        assert f" kg·m², {written}: 5 kg" in finding.message


@pytest.mark.parametrize(
    ("name", "severity"), [("empty_inertial", Severity.WARNING), ("default_inertial", Severity.ERROR)]
)
def test_a_macro_that_is_called_empty_is_no_error(tmp_path: Path, name: str, severity: Severity) -> None:
    arm = f"<xacro:{name}/>" + visual(sphere(0.01))
    text = robot(
        EMPTY.format(name),
        link("base"),
        *(part for i in (1, 2) for part in (link(f"l{i}", arm), joint(f"j{i}", "base", f"l{i}", kind="continuous"))),
        xacro=True,
    )
    (finding,) = find(tmp_path, text, "INR007", name="r.urdf.xacro")
    assert finding.severity is severity
