"""Sentences about sides, places and sizes that say no more than what differs."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import box, collision, find, inertial, joint, limit, link, robot, visual

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
