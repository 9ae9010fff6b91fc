"""Inertials that were computed from another shape than the drawn one, or at another mass than the written one."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import arm_on_base, box, collision, cylinder, find, inertial, mesh, visual
from castings import CASTING, drawn_boxes, format_inertial, geometry, open_widely, uniform, write_stl

from urdfcheck.facts.inertials.diagnosis import diagnose_inertial
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia, make_cylinder_solid

# A hub and its axle are drawn; the wheel collides as the cylinder of its tyre.
HUB = visual(cylinder(0.2, 0.28)) + visual(cylinder(0.1, 0.45))
WHEEL = (0.3175, 0.3025)
TYRE = collision(cylinder(*WHEEL))
MASS = 16.8


def make_wheel(factor: float, tyre: str) -> str:
    xx, yy, zz = (factor * np.diag(compute_solid_inertia(make_cylinder_solid(*WHEEL), MASS))).tolist()
    return arm_on_base(inertial(MASS, ixx=xx, iyy=yy, izz=zz), HUB, tyre)


@pytest.mark.parametrize(
    ("factor", "tyre", "found"),
    [
        (1.0, TYRE, False),
        (1.015, TYRE, False),
        (1.15, TYRE, True),
        (1.0, "", True),
        (1.0, collision(cylinder(*WHEEL), xyz="0 0.1 0"), True),
    ],
)
def test_the_tensor_of_the_collision_shape_is_right(tmp_path: Path, factor: float, tyre: str, found: bool) -> None:
    assert bool(find(tmp_path, make_wheel(factor, tyre), {"INR009"})) == found


def test_a_collision_shape_rotated_like_the_tensor_has_the_same_mistake(tmp_path: Path) -> None:
    # The plate lies in the plane of x and y; tensor and collision shape are those of an upright one.
    moments = (8.0 / 12.0 * (0.2**2 + 0.4**2), 8.0 / 12.0 * (0.1**2 + 0.4**2), 8.0 / 12.0 * (0.1**2 + 0.2**2))
    numbers = inertial(8, ixx=moments[0], iyy=moments[1], izz=moments[2])
    text = arm_on_base(numbers, visual(box("0.4 0.2 0.1")), collision(box("0.1 0.2 0.4")))
    (finding,) = find(tmp_path, text, {"INR009"})
    assert finding.cause is not None
    assert finding.cause.id == "axes_permuted"


def test_what_is_drawn_may_be_turned_and_not_the_tensor(tmp_path: Path) -> None:
    # No exchange of axes gives exactly the numbers of this plate.
    moments = (8.0 / 12.0 * (0.2**2 + 0.4**2), 8.16 / 12.0 * (0.1**2 + 0.4**2), 8.16 / 12.0 * (0.1**2 + 0.2**2))
    numbers = inertial(8, ixx=moments[0], iyy=moments[1], izz=moments[2])
    (finding,) = find(tmp_path, arm_on_base(numbers, visual(box("0.4 0.2 0.1"))), {"INR009"})
    assert finding.message_id == "named"
    assert finding.fix is not None
    assert finding.fix.title.endswith("or correct the <origin> of the shapes if RViz shows them out of place")


@pytest.mark.parametrize(("density", "cause"), [(1000.0, "other_mass"), (1003.0, "other_mass"), (2700.0, "mass_unit")])
def test_a_pound_is_no_cause_at_the_default_density(density: float, cause: str) -> None:
    drawn = geometry(CASTING)
    true = uniform(drawn.solid, density * drawn.solid.volume)
    found = diagnose_inertial(replace(true, mass=true.mass / 0.4525), drawn)
    assert found is not None
    assert found.cause == cause


def test_a_tensor_at_the_default_density_is_scaled_and_the_mass_kept(tmp_path: Path) -> None:
    drawn = geometry(CASTING)
    true = uniform(drawn.solid, 1000.0 * drawn.solid.volume)
    later = replace(true, mass=2.21 * true.mass)
    (finding,) = find(tmp_path, arm_on_base(format_inertial(later), drawn_boxes(CASTING)), {"INR009"})
    assert f"other mass: {true.mass:.3g} kg at 1000 kg/m³" in finding.message
    assert finding.fix is not None
    assert finding.fix.edits == ()
    written = re.search(r'ixx="([^"]*)"', finding.fix.title)
    assert written is not None
    assert float(written[1]) == pytest.approx(2.21 * true.tensor[0, 0], rel=1e-3)
    assert "value=" not in finding.fix.title


@pytest.mark.parametrize(("aside", "written"), [(0.0, True), (0.3, False)])
def test_the_tensor_of_a_hull_about_another_point_is_not_proposed(tmp_path: Path, aside: float, written: bool) -> None:
    write_stl(tmp_path / "part.stl", CASTING)
    open_widely(tmp_path / "part.stl")
    hull = geometry(CASTING).hull
    assert hull is not None
    true = uniform(hull, 0.6)
    vast = replace(true, com=true.com + np.array((aside, 0.0, 0.0)), tensor=np.diag((0.06, 0.08, 0.09)))
    (finding,) = find(tmp_path, arm_on_base(format_inertial(vast), visual(mesh("part.stl"))), {"INR005"})
    assert finding.fix is not None
    assert ("convex hull of the open mesh" in finding.fix.title) == written


@pytest.mark.parametrize("is_open", [True, False])
def test_the_hull_of_an_open_mesh_is_named_where_its_com_is_given(tmp_path: Path, is_open: bool) -> None:
    """A COM was left at zero: that of the hull is not that of the part, and moments beside it would be those of the hull."""
    write_stl(tmp_path / "part.stl", CASTING)
    if is_open:
        open_widely(tmp_path / "part.stl")
    drawn = geometry(CASTING)
    solid = drawn.hull if is_open else drawn.solid
    assert solid is not None
    numbers = replace(uniform(solid, 0.6), com=np.zeros(3), tensor=1.5 * uniform(solid, 0.6).tensor)
    (finding,) = find(tmp_path, arm_on_base(format_inertial(numbers), visual(mesh("part.stl"))), {"INR009"})
    assert finding.message_id == "com_missing"
    assert ("compared with the convex hull of the open mesh" in finding.message.lower()) == is_open
    assert ("moments" in finding.message) != is_open
    assert finding.fix is not None
    assert not (is_open and "the drawn part alone has" in finding.fix.title)
