"""Kinematics only: models for display and motion planning are checked without masses, inertias and forces."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from builders import box, inertial, joint, limit, link, robot, visual
from conftest import command

from urdfcheck.rules import load_rules

pytestmark = pytest.mark.usefixtures("one_process")

# INR002: a mass of 0 that a joint moves; JNT007: of its messages one is about an effort, another is not; NAM: a name.
ROBOT = robot(
    link("base", inertial(2, 0.1)),
    link("arm", inertial(0, 0.1)),
    link("hand", inertial(1, 0.1)),
    joint("j", "base", "arm", '<limit lower="-1" upper="1" effort="-2" velocity="1"/>', kind="revolute"),
    joint("k", "arm", "hand", '<limit lower="-1" upper="1"/>', kind="revolute"),
)
ALL = {("INR002", "inertia_without_mass"), ("JNT007", "effort-negative"), ("JNT007", "missing")}
KINEMATIC = {("JNT007", "missing")}


def list_found(folder: Path, *options: str) -> set[tuple[str, str]]:
    done = command("r.urdf", "--tier", "source", "--format", "json", *options, cwd=folder)
    return {(f["code"], f["message_id"]) for f in json.loads(done.stdout)["findings"]} & ALL


@pytest.mark.parametrize(
    ("text", "options", "found"),
    [
        ("", (), ALL),
        ("kinematics-only = true", (), KINEMATIC),
        ('[[paths]]\nmatch = ["r.urdf"]\nkinematics-only = true', (), KINEMATIC),
        ('kinematics-only = true\n[[paths]]\nmatch = ["r.urdf"]\nkinematics-only = false', (), ALL),
        ('kinematics-only = true\ntarget = ["moveit", "rviz"]', (), KINEMATIC),
        ('kinematics-only = true\ntarget = ["moveit", "gazebo"]', (), ALL),
        ("kinematics-only = true", ("--target", "mujoco"), ALL),
        ("kinematics-only = true", ("--select", "INR,JNT007"), ALL),
    ],
)
def test_masses_and_forces_are_left_out(
    tmp_path: Path, text: str, options: tuple[str, ...], found: set[tuple[str, str]]
) -> None:
    (tmp_path / "r.urdf").write_text(ROBOT)
    (tmp_path / "urdfcheck.toml").write_text(text)
    assert list_found(tmp_path, *options) == found


def test_the_configuration_is_shown(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(ROBOT)
    (tmp_path / "urdfcheck.toml").write_text("kinematics-only = true")
    shown = command("config", "r.urdf", cwd=tmp_path).stdout
    assert next(line for line in shown.splitlines() if "kinematics-only" in line).split()[1] == "true"


def test_every_rule_of_inertias_is_left_out() -> None:
    rules = load_rules()
    assert all(rule.dynamics == set(rule.messages) for code, rule in rules.items() if code.startswith("INR"))


STATIC = "<gazebo><static>true</static></gazebo>"
SCENERY = (
    link("ground", inertial(1, 1, com="0 500 0"), visual(box("100 100 2"))),
    link("wall", inertial(1, 1), visual(box("100 2 2"))),
    joint("j", "ground", "wall", limit(0, 0, effort=0, velocity=0), kind="revolute", xyz="0 100 0"),
)
UNMOVED = {"INR006", "JNT005", "GEO006"}


@pytest.mark.parametrize(("static", "codes"), [("", UNMOVED), (STATIC, set())])
def test_what_gazebo_holds_still_needs_no_masses_and_limits(tmp_path: Path, static: str, codes: set[str]) -> None:
    (tmp_path / "r.urdf").write_text(robot(*SCENERY, static))
    found = json.loads(command("r.urdf", "--format", "json", cwd=tmp_path).stdout)["findings"]
    assert {f["code"] for f in found} & (UNMOVED | {"JNT007"}) == codes


PLACEHOLDERS = (link("body", inertial(1e-4, 1e-4), visual(box("1 1 1"))), link("tag", inertial(1e-4, 1e-4)))
MOVED_BY_A_PLUGIN = '<gazebo reference="tag"><kinematic>{}</kinematic></gazebo>'


@pytest.mark.parametrize(
    ("kind", "flag", "name", "is_reported"),
    [
        ("fixed", "false", "tag", True),
        ("fixed", " true ", "tag", False),
        ("fixed", "true", "teg", True),
        ("continuous", "true", "tag", True),
    ],
)
def test_what_is_kinematic_in_gazebo_needs_no_masses(
    tmp_path: Path, kind: str, flag: str, name: str, is_reported: bool
) -> None:
    block = MOVED_BY_A_PLUGIN.format(flag).replace('"tag"', f'"{name}"')
    (tmp_path / "r.urdf").write_text(robot(*PLACEHOLDERS, joint("j", "body", "tag", kind=kind), block))
    done = command("r.urdf", "--format", "json", cwd=tmp_path).stdout
    assert ("INR015" in {f["code"] for f in json.loads(done)["findings"]}) is is_reported


@pytest.mark.parametrize("posed", [MOVED_BY_A_PLUGIN.format("true"), "<gazebo><static>true</static></gazebo>"])
@pytest.mark.parametrize(("target", "is_reported"), [("gazebo", False), ("mujoco", True)])
def test_another_simulator_moves_what_gazebo_poses(tmp_path: Path, posed: str, target: str, is_reported: bool) -> None:
    (tmp_path / "r.urdf").write_text(robot(*PLACEHOLDERS, joint("j", "body", "tag", kind="fixed"), posed))
    done = command("r.urdf", "--format", "json", "--target", target, cwd=tmp_path).stdout
    assert ("INR015" in {f["code"] for f in json.loads(done)["findings"]}) is is_reported


def test_a_part_that_gazebo_drops_is_reported_in_scenery_too(tmp_path: Path) -> None:
    (tmp_path / "r.urdf").write_text(ROBOT.replace("</robot>", STATIC + "</robot>"))
    assert ("INR002", "inertia_without_mass") in list_found(tmp_path)
