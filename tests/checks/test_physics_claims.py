"""Sentences about masses, inertias and shapes that take notice of what the file says elsewhere."""

from __future__ import annotations

from pathlib import Path

from builders import box, collision, cylinder, find, inertial, joint, link, robot, sphere, visual

TURNS = joint("j", "base", "arm", kind="continuous")
BASE = link("base", inertial(1, 0.01))


def set_options(options: str) -> str:
    return f"<mujoco><compiler {options}/></mujoco>"


def test_balanced_moments_are_not_refused_by_mujoco(tmp_path: Path) -> None:
    parts = (BASE, link("arm", inertial(1, 0.01, izz=0.05)), TURNS)
    (plain,) = find(tmp_path, robot(*parts), "INR003")
    (balanced,) = find(tmp_path, robot(set_options('balanceinertia="true"'), *parts), "INR003")
    assert plain.consequences["mujoco"].startswith("refuses")
    assert balanced.consequences["mujoco"].startswith("replaces")


def test_mujoco_draws_the_visuals_that_it_is_told_to_keep(tmp_path: Path) -> None:
    parts = (BASE, link("arm", inertial(1, 0.01), visual(box("0.1 0.1 0.1"))), TURNS)
    (plain,) = find(tmp_path, robot(*parts), "GEO002")
    (kept,) = find(tmp_path, robot(set_options('discardvisual="false"'), *parts), "GEO002")
    assert "invisible" in plain.consequences["mujoco"]
    assert "invisible" not in kept.consequences["mujoco"]


def test_a_round_number_from_a_formula_is_not_typed(tmp_path: Path) -> None:
    long = visual(box("0.4 0.05 0.05")) + collision(box("0.4 0.05 0.05"))
    computed = inertial(1, "${0.4*r**2}")
    text = '<xacro:property name="r" value="0.05"/>'
    parts = (link("base", inertial(10, 0.3, iyy=0.4, izz=0.5)), TURNS)
    assert find(tmp_path, robot(link("arm", inertial(1, 0.001), long), *parts), "INR007")
    assert not find(tmp_path, robot(text, link("arm", computed, long), *parts, xacro=True), "INR007")


def test_a_ship_may_weigh_more_than_other_robots(tmp_path: Path) -> None:
    hull = visual(box("36 9 6")) + collision(box("36 9 6"))
    small = visual(box("3 1 1")) + collision(box("3 1 1"))
    boom = link("arm", inertial(4000, 3000))
    assert not find(tmp_path, robot(link("base", inertial(570000, 5e6), hull), boom, TURNS), "INR015")
    assert find(tmp_path, robot(link("base", inertial(570000, 5e6), small), boom, TURNS), "INR015")


def test_the_axis_of_a_cylinder_is_not_sought_in_a_ball(tmp_path: Path) -> None:
    lengths = '<xacro:property name="r" value="0.05"/><xacro:property name="h" value="0.1"/>'
    formula = inertial(1, "${(3*r**2+h**2)/12}")
    for shape, count in ((sphere(0.05), 0), (cylinder(0.05, 0.1), 1)):
        model = robot(lengths, BASE, link("arm", formula, visual(shape)), TURNS, xacro=True)
        assert len(find(tmp_path, model, "INR020")) == count
