"""INR009: causes that explain too little, or that rest on what proves nothing, are not named."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from builders import arm_on_base, box, collision, find, inertial, joint, limit, link, robot, visual

from urdfcheck.core import Finding
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.diagnosis import Diagnosis, diagnose_inertial
from urdfcheck.model import Model
from urdfcheck.model.inertials.diagnosis.weak_causes import drop_causes_of_bounds, drop_weak_causes
from urdfcheck.model.likeness.declared_inertials import read_declared_inertial
from urdfcheck.model.shapes.visual_solid import measure_link_geometry
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder


def find_causes(folder: Path, *arm: str) -> list[Finding]:
    return find(folder, arm_on_base(*arm), {"INR005", "INR009"})


def test_a_tensor_that_only_lost_digits_is_not_about_the_origin(tmp_path: Path) -> None:
    shape = visual(box("0.0089 0.02784 0.0275"), xyz="0.00407 0 0")
    rounded = inertial(0.022, com="0.00407 0 0", ixx=3e-6, iyy=2e-6, izz=2e-6)
    assert not find_causes(tmp_path, rounded, shape)


def test_a_tensor_of_a_part_lighter_than_foam_is_in_no_other_unit(tmp_path: Path) -> None:
    shape = visual(box("0.18 0.17 0.089"))
    numbers = inertial("1e-9", ixx=0.0064, iyy=0.00804, izz=0.01075)
    assert all(finding.cause is None for finding in find_causes(tmp_path, numbers, shape))


def test_a_mistake_that_leaves_most_of_the_difference_is_not_named(tmp_path: Path) -> None:
    shape = visual(box("0.6 0.269 0.17"), xyz="0 0 0.05")
    numbers = inertial(25, com="0 0 0.05", ixx=0.2109604, iyy=0.5502083, izz=0.7575208)
    assert all(finding.cause is None for finding in find_causes(tmp_path, numbers, shape))


def test_collision_shapes_are_not_the_pieces_that_a_program_added(tmp_path: Path) -> None:
    pieces = [("0.04 0.04 0.2", "0 0 0.1"), ("0.04 0.2 0.04", "0 0.1 0.2")]
    numbers = inertial(1.28, com="0 0.05 0.15", ixx=0.004437, iyy=0.002389, izz=0.002389)
    drawn = [visual(box(size), xyz=xyz) for size, xyz in pieces]
    (finding,) = find_causes(tmp_path, numbers, *drawn)
    assert finding.cause is not None
    assert finding.cause.id == "steiner_missing"
    colliding = [collision(box(size), xyz=xyz) for size, xyz in pieces]
    assert all(finding.cause is None for finding in find_causes(tmp_path, numbers, *colliding))


def test_no_com_is_proposed_where_the_part_is_drawn_far_from_its_joint(tmp_path: Path) -> None:
    def find_missing(place: str) -> list[Finding]:
        arm = inertial(1, ixx=4.1e-4, iyy=0.0034, izz=0.0034), visual(box("0.2 0.05 0.05"), xyz=place)
        return find(tmp_path, arm_on_base(*arm), "INR009")

    (near,) = find_missing("0.1 0 0.2")
    assert (near.message_id, "xyz=" in (near.fix.title if near.fix else "")) == ("com_missing", True)
    (far,) = find_missing("1.7 1.3 0.1")
    assert (far.message_id, far.cause) == ("elsewhere", None)
    assert far.fix is not None
    assert "xyz=" not in far.fix.title


@pytest.mark.parametrize(("size", "found"), [("100 20 20", False), ("0.3 0.1 0.1", True)])
def test_a_drawing_in_another_unit_than_the_collision_is_no_measure(tmp_path: Path, size: str, found: bool) -> None:
    arm = inertial(2, ixx=1e-6, iyy=2e-6, izz=2e-6), visual(box(size)), collision(box("0.1 0.02 0.02"))
    assert bool(find(tmp_path, arm_on_base(*arm), "INR009")) == found


@pytest.mark.parametrize(("root", "found"), [("world", False), ("trolley", True)])
def test_a_base_on_the_world_needs_no_inertia_of_its_own(tmp_path: Path, root: str, found: bool) -> None:
    shape = visual(box("0.3 0.1 0.1"))
    text = robot(
        link(root),
        joint("mount", root, "base", kind="fixed" if root == "world" else "continuous"),
        link("base", inertial(2, ixx=1e-6, iyy=2e-6, izz=2e-6), shape),
        joint("elbow", "base", "arm", limit(-1, 1), kind="revolute", xyz="0.3 0 0"),
        link("arm", inertial(2, ixx=0.0033, iyy=0.0167, izz=0.0167), shape),
    )
    assert bool(find(tmp_path, text, "INR009")) == found


def diagnose(folder: Path, text: str) -> tuple[Model, dict[str, DeclaredInertial], dict[str, Diagnosis]]:
    """Return a robot's model, its inertials, and what what they draw alone says of them."""
    path = folder / "robot.urdf"
    path.write_text(text, encoding="utf-8")
    source = load_source(path, {}, PackageFinder(folder, {}, []))
    assert source.root is not None
    model = Model(source=source, robot=source.root)
    numbers, found = {}, {}
    for one in model.links:
        declared = read_declared_inertial(one)
        verdict = None if declared is None else diagnose_inertial(declared, measure_link_geometry(model, one))
        if declared is not None and verdict is not None:
            numbers[one.name], found[one.name] = declared, verdict
    return model, numbers, found


@pytest.mark.parametrize(("shape", "kept"), [(collision, False), (visual, True)])
def test_a_box_that_only_bounds_a_part_shows_no_unit(tmp_path: Path, shape: Callable[[str], str], kept: bool) -> None:
    """A frame with a battery: its COM is not that of the box around it, and its tensor is smaller."""
    frame = inertial(8.1, com="0.0093 0 -0.0206", ixx=0.0584, iyy=0.0379, izz=0.0334)
    model, numbers, found = diagnose(tmp_path, arm_on_base(frame, shape(box("0.152 0.3 0.32"))))
    pounds = replace(numbers["arm"], mass=0.4536 * numbers["arm"].mass)
    found["arm"] = replace(
        found["arm"], sound=False, cause="mass_unit", detail="lb", mended=pounds, mended_com_mismatch=0.3, unique=False
    )
    verdict = drop_causes_of_bounds(model, numbers, found)["arm"]
    assert (verdict.cause == "mass_unit") is kept


@pytest.mark.parametrize(("factor", "left", "kept"), [(500, 1.31, False), (1, 1.31, True), (500, 1.05, True)])
def test_a_unit_of_one_link_leaves_the_part_or_stands_out(
    tmp_path: Path, factor: float, left: float, kept: bool
) -> None:
    """Two links draw a cube: one of them has a tensor in lb·in², but for what is ``left``, the other ``factor`` times its own."""
    cube, moment, unit = visual(box("0.1 0.1 0.1")), 0.001 / 0.6, 3417.0
    text = robot(
        link("base", inertial(1.0, factor * moment, com="0.001 0 0"), cube),
        joint("j", "base", "arm", kind="continuous"),
        link("arm", inertial(1.1, 1.1 * moment * unit * left), cube),
    )
    model, numbers, found = diagnose(tmp_path, text)
    mended = replace(numbers["arm"], tensor=numbers["arm"].tensor / unit)
    found["arm"] = replace(
        found["arm"], sound=False, cause="inertia_unit", detail="lb·in²", mended=mended, unique=False
    )
    verdict = drop_weak_causes(model, numbers, found)["arm"]
    assert (verdict.cause == "inertia_unit") is kept
