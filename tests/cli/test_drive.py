"""The drive test of ``urdfcheck drop``, on robots that are made. Skipped where MuJoCo is not installed."""

from __future__ import annotations

import json
import math
from importlib.resources import files
from pathlib import Path

import jsonschema
import pytest
from builders import inertial, joint, robot
from conftest import check_text

from urdfcheck.cli import main
from urdfcheck.core import Run
from urdfcheck.core.drive_test import DriveTest
from urdfcheck.output.json import render as render_json
from urdfcheck.output.shared.drop_test.wording import describe_drop_setup

pytestmark = pytest.mark.slow

SCHEMA = json.loads((files("urdfcheck.output") / "report.schema.json").read_text(encoding="utf-8"))
BODY = '<collision><origin xyz="0 0 0.1"/><geometry><box size="0.3 0.2 0.08"/></geometry></collision>'
ROUND = '<cylinder radius="0.05" length="0.02"/>'
WHEEL = f'<collision><origin rpy="1.5707963 0 0"/><geometry>{ROUND}</geometry></collision>'
BALL = '<link name="caster"><collision><geometry><sphere radius="0.01"/></geometry></collision></link>'
RIGHT = joint("right_wheel_joint", "base_link", "right_wheel", kind="continuous", xyz="0 -0.15 0.05", axis="0 1 0")
CART = robot(
    f'<link name="base_link">{inertial(3, 0.03, com="0.03 0 0.1")}{BODY}</link>',
    f'<link name="left_wheel">{inertial(0.3, 4e-4)}{WHEEL}</link>',
    f'<link name="right_wheel">{inertial(0.3, 4e-4)}{WHEEL}</link>',
    joint("left_wheel_joint", "base_link", "left_wheel", kind="continuous", xyz="0 0.15 0.05", axis="0 1 0"),
    RIGHT,
    joint("caster_joint", "base_link", "caster", kind="fixed", xyz="0.1 0 0.01"),
    BALL,
)
PLUGIN = (
    '<gazebo><plugin filename="libgazebo_ros_diff_drive.so" name="d">'
    "<leftJoint>right_wheel_joint</leftJoint><rightJoint>left_wheel_joint</rightJoint>{mode}"
    "<wheelSeparation>0.3</wheelSeparation><wheelDiameter>0.1</wheelDiameter></plugin></gazebo></robot>"
)
NEUTRAL = CART.replace("left_wheel", "wheel_1").replace("right_wheel", "wheel_2")
REVERSED = CART.replace('xyz="0 1 0"', 'xyz="0 -1 0"')


def drive(folder: Path, model: str) -> Run:
    """The run of a drop and a drive of this text."""
    pytest.importorskip("mujoco")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("urdfcheck.core.drop_test.STEPS", (4e-3, 8e-3))
        run = check_text(folder, model, codes={"DYN005", "DYN007"}, drop=True)
    assert not run.failures, run.failures
    return run


def get_drive(run: Run) -> DriveTest:
    (drop,) = run.drops
    assert drop.drive is not None, drop.undriven
    return drop.drive


def test_a_sound_robot_drives_as_far_as_its_wheels_roll(tmp_path: Path) -> None:
    run = drive(tmp_path, CART)
    assert not run.findings
    found = get_drive(run)
    assert found.forward.ahead == pytest.approx(math.pi * 0.05, rel=0.01)
    assert (found.forward.aside, found.forward.turned) == (pytest.approx(0, abs=1e-4), pytest.approx(0, abs=1e-3))
    assert found.turning.turned == pytest.approx(2 * math.pi * 0.05 / 0.3, rel=0.02)
    assert found.separation == pytest.approx(0.3)
    weights = [wheel.load for wheel in found.wheels]
    assert weights[0] == pytest.approx(weights[1], rel=0.01)
    assert 0 < sum(weights) < 3.6 * 9.81
    assert max(wheel.slip for wheel in found.wheels) < 0.01


@pytest.mark.usefixtures("one_process")
def test_every_format_shows_the_drive(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = drive(tmp_path, CART)
    report = json.loads(render_json(run))
    jsonschema.validate(report, SCHEMA)
    shown = report["drops"][0]["drive"]
    assert shown["forward"]["ahead"] == pytest.approx(0.157, abs=1e-3)
    assert shown["expected_turn"] == pytest.approx(1.047, rel=0.01)
    assert report["drops"][0]["undriven"] == ""
    path = tmp_path / "cart.urdf"
    path.write_text(REVERSED.replace("</robot>", PLUGIN.format(mode="")), encoding="utf-8")
    written = tmp_path / "cart.html"
    assert main(["drop", str(path), "--no-cache", "--fail-on", "warning", "-o", f"html={written}"]) == 1
    page = written.read_text(encoding="utf-8")
    assert "Driven: half a turn of the wheels" in page
    assert "<code>left_wheel_joint</code>" in page
    told = " ".join(capsys.readouterr().out.split())
    assert "driven: half a turn of the wheels" in told
    assert "typed: wheel radius 0.05 m, separation 0.3 m" in told
    assert "DYN007 driven ahead, the robot goes backwards" in told


def test_driven_wheels_above_the_ground_bear_no_weight(tmp_path: Path) -> None:
    place = joint("rear_joint", "base_link", "rear_caster", kind="fixed", xyz="-0.1 0 0.01")
    rear = BALL.replace("caster", "rear_caster") + place
    run = drive(tmp_path, CART.replace('15 0.05"', '15 0.06"').replace("</robot>", f"{rear}</robot>"))
    assert "dropped, left_wheel, right_wheel bear no weight" in [finding.headline for finding in run.findings]


def test_without_a_controller_no_direction_is_wrong(tmp_path: Path) -> None:
    """Which side is ahead is a convention then: the robot goes backwards, and nothing is reported."""
    run = drive(tmp_path, REVERSED)
    assert get_drive(run).forward.ahead == pytest.approx(-math.pi * 0.05, rel=0.01)
    assert not run.findings


def test_symmetry_shows_the_wheels_whose_names_have_no_side(tmp_path: Path) -> None:
    """Either axis may point outwards: both wheels roll the same way."""
    run = drive(tmp_path, NEUTRAL.replace('-0.15 0.05"/><axis xyz="0 1 0"', '-0.15 0.05"/><axis xyz="0 -1 0"'))
    found = get_drive(run)
    assert (found.source, found.left) == ("the symmetry of two wheels", ("wheel_1_joint",))
    assert found.forward.ahead == pytest.approx(math.pi * 0.05, rel=0.01)
    assert not run.findings


@pytest.mark.parametrize(("mode", "found"), [("", []), ("<legacyMode>false</legacyMode>", ["swapped"])])
def test_the_legacy_mode_takes_left_for_right(mode: str, found: list[str], tmp_path: Path) -> None:
    run = drive(tmp_path, CART.replace("</robot>", PLUGIN.format(mode=mode)))
    assert [finding.message_id for finding in run.findings] == found


@pytest.mark.parametrize(
    ("multiplier", "found"),
    [("", ["spins"]), ("    right_wheel_radius_multiplier: -1.0\n", [])],
    ids=["plain", "negated"],
)
def test_a_negative_multiplier_reverses_a_side(multiplier: str, found: list[str], tmp_path: Path) -> None:
    (tmp_path / "package.xml").write_text('<package format="3"><name>p</name></package>')
    (tmp_path / "config").mkdir()
    (tmp_path / "config" / "c.yaml").write_text(
        "controller_manager:\n  ros__parameters:\n    base:\n      type: diff_drive_controller/DiffDriveController\n"
        "base:\n  ros__parameters:\n    left_wheel_names: [left_wheel_joint]\n    right_wheel_names: [right_wheel_joint]\n"
        f"    wheel_radius: 0.05\n    wheel_separation: 0.3\n{multiplier}"
    )
    run = drive(tmp_path, CART.replace(RIGHT, RIGHT.replace("0 1 0", "0 -1 0")))
    assert get_drive(run).source == "controller 'base'"
    assert [finding.message_id for finding in run.findings] == found


def test_a_wheel_of_coarse_triangles_rolls_as_a_disc(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    trimesh.creation.cylinder(radius=0.05, height=0.02, sections=12).export(tmp_path / "wheel.stl")
    mesh = '<mesh filename="wheel.stl"/>'
    run = drive(tmp_path, CART.replace(ROUND, mesh))
    assert not run.findings
    assert get_drive(run).forward.ahead == pytest.approx(math.pi * 0.05, rel=0.02)


@pytest.mark.parametrize(
    ("model", "why"),
    [
        (NEUTRAL.replace("wheel_1", "idler"), "neither a controller, nor a plugin"),
        (CART.replace('0.1 0 0.01"', '-0.1 0 0.01"'), "it does not stand"),
        (
            CART.replace(
                WHEEL, WHEEL.replace(ROUND, '<box size="0.1 0.1 0.02"/>') + WHEEL.replace("collision", "visual")
            ),
            "collides as a box",
        ),
    ],
    ids=["names", "falls", "box"],
)
def test_why_a_robot_is_not_driven(model: str, why: str, tmp_path: Path) -> None:
    run = drive(tmp_path, model)
    (drop,) = run.drops
    assert drop.drive is None
    assert why in drop.undriven
    assert any(line.startswith("not driven: ") for line in describe_drop_setup(drop))
    assert not [finding for finding in run.findings if finding.code == "DYN007"]
