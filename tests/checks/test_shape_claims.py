"""Sentences about sides, places and sizes that say no more than what differs."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import box, collision, cylinder, find, inertial, joint, limit, link, robot, sphere, visual

from urdfcheck.core import Finding


def find_limits(folder: Path, left: str, right: str) -> Finding:
    """Return what is found of two arms that swing about the line between their shoulders."""
    parts = [link("torso", visual(box("0.2 0.3 0.5")))]
    for side, y, text in (("left", 0.2, left), ("right", -0.2, right)):
        parts.append(link(f"{side}_arm", visual(box("0.05 0.04 0.3"), xyz="0 0 -0.15")))
        parts.append(
            joint(f"{side}_j", "torso", f"{side}_arm", text, kind="revolute", xyz=f"0 {y} 0.2", axis="0 1 0"),
        )
    (finding,) = find(folder, robot(*parts), "SYM004")
    return finding


def test_other_efforts_do_not_negate_symmetric_ranges(tmp_path: Path) -> None:
    finding = find_limits(tmp_path, limit(-1, 1, effort=40), limit(-1, 1, effort=20))
    assert finding.message_id == "limits_pair"
    assert "without efforts" in finding.consequences["moveit"]


def test_the_limits_of_a_follower_are_not_those_of_the_driver(tmp_path: Path) -> None:
    """A joint without effort is not driven: an exporter left it some play at both ends."""
    sides = limit(0, 0.7, effort=1000), limit(-0.14, 0.84, effort=0)
    with pytest.raises(ValueError, match="not enough values"):
        find_limits(tmp_path, *sides)


def test_other_velocities_slow_one_side(tmp_path: Path) -> None:
    finding = find_limits(tmp_path, limit(-1, 1, velocity=4), limit(-1, 1, velocity=2))
    assert "slower" in finding.consequences["moveit"]


def test_a_negated_range_is_what_the_other_side_cannot_mirror(tmp_path: Path) -> None:
    finding = find_limits(tmp_path, limit(0, 0.5), limit(-0.5, 0))
    assert finding.message_id == "limits_negated"
    assert "cannot mirror" in finding.consequences["moveit"]


@pytest.mark.parametrize(("drawn", "collides"), [(0.3, 0.03), (0.03, 0.3)])
def test_contacts_with_a_shape_of_another_size_may_be_inside_of_what_is_drawn(
    tmp_path: Path, drawn: float, collides: float
) -> None:
    shapes = visual(box(f"{drawn} {drawn} {drawn}")) + collision(box(f"{collides} {collides} {collides}"))
    turns = joint("j", "base", "arm", kind="continuous")
    (finding,) = find(tmp_path, robot(link("base"), link("arm", inertial(1, 0.01), shapes), turns), "GEO003")
    assert "nothing is visible" not in finding.consequences["gazebo"]
    assert "elsewhere" not in finding.consequences["moveit"]
    assert finding.cause is not None
    assert "mesh" not in finding.cause.text


def test_a_mass_too_great_for_its_size_may_be_that_of_parts_that_are_not_drawn(tmp_path: Path) -> None:
    turns = joint("j", "base", "arm", kind="continuous")
    small = visual(box("0.01 0.01 0.02"))
    computed = inertial(0.5, ixx=0.5 * 5e-4 / 12, iyy=0.5 * 5e-4 / 12, izz=0.5 * 2e-4 / 12)
    (drawn,) = find(tmp_path, robot(link("base"), link("arm", computed, small), turns), "INR010")
    (other,) = find(tmp_path, robot(link("base"), link("arm", inertial(0.5, 1e-7), small), turns), "INR010")
    assert drawn.fix is not None
    assert other.fix is not None
    assert "if the mass is right, correct the size of what is drawn" in drawn.fix.title
    assert other.fix.title.endswith("or draw the parts that are missing")


def test_an_arm_that_is_bolted_to_the_world_does_not_lean(tmp_path: Path) -> None:
    turns = joint("j", "base", "arm", kind="continuous", axis="0 0 1")
    bolted = joint("w", "world", "base")
    arm = link("arm", inertial(1, 0.01, com="1 0 0"), visual(box("0.1 0.1 0.1")))
    (finding,) = find(tmp_path, robot(link("world"), bolted, link("base"), arm, turns), "INR006")
    assert "not fixed to the world may lean" in finding.consequences["gazebo"]
    assert finding.fix is not None
    assert "<origin> of what is drawn" in finding.fix.title


@pytest.mark.parametrize(("friction", "count"), [(0, 1), (40, 0)])
def test_friction_holds_what_the_drive_cannot(tmp_path: Path, friction: float, count: int) -> None:
    arm = link("arm", inertial(4, 0.1, com="0 0 0.3"), visual(box("0.05 0.05 0.6"), xyz="0 0 0.3"))
    rubs = f'<dynamics damping="1" friction="{friction}"/>'
    turns = joint("j", "base", "arm", limit(-1, 1, effort=3), rubs, kind="revolute", axis="0 1 0")
    assert len(find(tmp_path, robot(link("base", inertial(5, 0.1)), arm, turns), "DYN002")) == count


def make_cart(*parts: str) -> str:
    """Return a cart on two driven wheels that reach 80 mm below its root."""
    body = [link("base", inertial(20, 0.3, com="0.05 0 0"), collision(box("0.4 0.2 0.1")))]
    for side, y in (("left", 0.15), ("right", -0.15)):
        tyre = collision(cylinder(0.08, 0.03), rpy="1.5707963 0 0")
        body.append(link(f"{side}_wheel", inertial(1, 0.002), tyre))
        body.append(
            joint(f"{side}_wheel_joint", "base", f"{side}_wheel", kind="continuous", xyz=f"0.1 {y} 0", axis="0 1 0")
        )
    return robot(*body, *parts)


@pytest.mark.parametrize(("axis", "count"), [("0 0 1", 0), ("1 0 0", 1)])
def test_a_sprung_caster_does_not_tilt_the_robot(tmp_path: Path, axis: str, count: int) -> None:
    slide = joint("spring", "base", "mount", limit(-0.02, 0.05), kind="prismatic", xyz="-0.15 0 -0.07", axis=axis)
    caster = joint("c", "mount", "caster")
    ball = link("caster", collision(sphere(0.03)))
    text = make_cart(link("mount", inertial(0.1, 0.001)), slide, ball, caster)
    assert len(find(tmp_path, text, "DYN006")) == count


@pytest.mark.parametrize(("axis", "count"), [("0 0 1", 0), ("0 1 0", 1)])
def test_the_ground_lifts_a_fork_that_slides_up(tmp_path: Path, axis: str, count: int) -> None:
    caster = joint("c", "base", "caster", xyz="-0.15 0 -0.05")
    ball = link("caster", collision(sphere(0.03)))
    lifts = joint("lift", "base", "fork", limit(0, 0.05), kind="prismatic", xyz="0 0 -0.05", axis=axis)
    fork = link("fork", inertial(0.1, 0.001), collision(box("0.02 0.02 0.1")))
    assert len(find(tmp_path, make_cart(ball, caster, fork, lifts), "DYN006")) == count
