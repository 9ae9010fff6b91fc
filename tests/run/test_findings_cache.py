"""Findings of an earlier run are given again, and only while nothing that they depend on has changed."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
import trimesh
from conftest import check

from urdfcheck.core import Finding, Rule, Run
from urdfcheck.output.json import render
from urdfcheck.rules import Check, load_check, load_rules
from urdfcheck.run.findings_cache import is_cacheable

ROBOT = """<robot name="r">
  <link name="part">
    <inertial>
      <mass value="1"/>
      <inertia ixx="{ixx}" ixy="0" ixz="0" iyy="0.1133" iyz="0" izz="0.1333"/>
    </inertial>
    <visual><geometry><mesh filename="part.stl"/></geometry></visual>
  </link>
</robot>
"""


@pytest.fixture(name="robot")
def write_robot(tmp_path: Path) -> Path:
    path = tmp_path / "r.urdf"
    path.write_text(ROBOT.format(ixx="0.0333"), encoding="utf-8")
    trimesh.creation.box((0.04, 0.02, 0.01)).export(tmp_path / "part.stl")
    return path


@pytest.fixture(autouse=True)
def _without_whole_reports(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is kept of a rule is used where something else in the report has changed."""
    monkeypatch.setattr("urdfcheck.run.pipeline.enable_replay", lambda settings: settings)


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The codes of the rules that were really asked."""
    asked: list[str] = []
    original = load_check

    def check_of(rule: Rule) -> Check:
        run = original(rule)

        def asking(subject: object, rule: Rule, **options: object) -> list[Finding]:
            asked.append(rule.code)
            return list(run(subject, rule, **options))

        return asking

    monkeypatch.setattr("urdfcheck.run.unit_audit.load_check", check_of)
    return asked


def outcome(path: Path, **request: object) -> Run:
    found = check(path, cache=path.parent / "kept", **request)
    assert found.failures == ()
    return replace(found, seconds=0.0, models=tuple(replace(m, seconds=0.0) for m in found.models))


def test_the_second_run_finds_the_same_without_looking(robot: Path, calls: list[str]) -> None:
    first = outcome(robot)
    assert {"INR009", "INR005"} & {f.code for f in first.findings}
    calls.clear()
    second = outcome(robot)
    assert json.loads(render(second)) == json.loads(render(first))
    assert not {code for code in calls if is_cacheable(load_rules()[code])}
    assert "INR003" in calls  # rules that read the source alone are quicker than what is kept


def test_without_a_folder_nothing_is_kept(robot: Path, calls: list[str]) -> None:
    for _ in range(2):
        calls.clear()
        check(robot)
        assert "INR009" in calls


def test_a_changed_number_a_mesh_a_target_or_an_option_is_looked_at(robot: Path, calls: list[str]) -> None:
    def looked() -> bool:
        calls.clear()
        outcome(robot, **settings)
        return "INR009" in calls

    settings: dict[str, object] = {}
    assert looked()
    assert not looked()
    robot.write_text(ROBOT.format(ixx="0.0334"), encoding="utf-8")
    assert looked()
    trimesh.creation.box((0.04, 0.02, 0.02)).export(robot.parent / "part.stl")
    assert looked()
    settings = {"options": {"INR009": {"far": 2.5}}}
    assert looked()
    settings = {"targets": ("gazebo",)}
    assert looked()
    assert not looked()


def test_a_mesh_that_comes_or_goes_is_noticed(robot: Path) -> None:
    part = robot.parent / "part.stl"
    data = part.read_bytes()
    assert any(f.code == "INR009" or f.code == "INR005" for f in outcome(robot).findings)
    part.unlink()
    assert {f.code for f in outcome(robot).findings} & {"PKG002"}
    part.write_bytes(data)
    assert any(f.code == "INR009" or f.code == "INR005" for f in outcome(robot).findings)


def test_an_element_that_a_value_of_yaml_moves_is_looked_at_anew(robot: Path, calls: list[str]) -> None:
    """The same text and the same tags in the same order: only what is in what differs."""
    inertial = ROBOT[ROBOT.index("    <inertial>") : ROBOT.index("    <visual>")].format(ixx="0.0333")
    path = robot.with_suffix(".urdf.xacro")
    path.write_text(
        f"""<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:property name="y" value="${{xacro.load_yaml('y.yaml')}}"/>
  <link name="part">
    <visual><geometry><mesh filename="part.stl"/></geometry></visual>
    <xacro:if value="${{y.inside}}">{inertial}</xacro:if>
  </link>
  <xacro:unless value="${{y.inside}}">{inertial}</xacro:unless>
</robot>""",
        encoding="utf-8",
    )
    (robot.parent / "y.yaml").write_text("inside: true\n")
    outcome(path)
    (robot.parent / "y.yaml").write_text("inside: false\n")
    calls.clear()
    outcome(path)
    assert "INR009" in calls


def test_a_moved_line_moves_its_finding(robot: Path) -> None:
    before = next(f for f in outcome(robot).findings if f.code.startswith("INR"))
    robot.write_text("<!-- one more line -->\n" + robot.read_text(encoding="utf-8"), encoding="utf-8")
    after = next(f for f in outcome(robot).findings if f.code.startswith("INR"))
    assert before.location.span is not None
    assert after.location.span is not None
    assert after.location.span.line == before.location.span.line + 1


def test_a_damaged_entry_is_found_anew(robot: Path, calls: list[str]) -> None:
    first = outcome(robot)
    for entry in (robot.parent / "kept").rglob("all.npz"):
        entry.write_bytes(b"no archive")
    calls.clear()
    assert outcome(robot).findings == first.findings
    assert "INR009" in calls
