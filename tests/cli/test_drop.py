"""``urdfcheck drop``: the robot set on the ground in a simulator and let go. Skipped where MuJoCo is not installed."""

from __future__ import annotations

import importlib.util
import json
import math
from importlib.resources import files
from itertools import pairwise
from pathlib import Path

import jsonschema
import pytest
from builders import inertial, joint, limit, robot
from conftest import FIXTURES, REPOSITORY, check, check_text

from urdfcheck.cli import main
from urdfcheck.core import Run
from urdfcheck.core.drop_test import STEPS, DropTest
from urdfcheck.output import html, text
from urdfcheck.output.json import render as render_json
from urdfcheck.output.shared.drop_test.wording import describe_drop_setup

pytestmark = pytest.mark.slow

CAR_3 = FIXTURES / "car-3" / "urdf" / "car-3.urdf"
SCHEMA = json.loads((files("urdfcheck.output") / "report.schema.json").read_text(encoding="utf-8"))
BOX = '<collision><geometry><box size="0.2 0.2 0.1"/></geometry></collision>'


def make_driven_joint(name: str, parent: str, child: str, xyz: str, axis: str, more: str = "") -> str:
    """Return a revolute joint that a motor can hold."""
    return joint(name, parent, child, limit(-3, 3, 100, 9), more, kind="revolute", xyz=xyz, axis=axis)


def cart(mass: float, moment: float) -> str:
    """A box on four wheels of this mass and inertia."""
    parts = [f'<link name="base">{inertial(5, 0.02)}{BOX}</link>']
    wheel = (
        '<collision><origin rpy="1.5708 0 0"/><geometry><cylinder radius="0.1" length="0.02"/></geometry></collision>'
    )
    for k, (x, y) in enumerate(((0.1, 0.12), (0.1, -0.12), (-0.1, 0.12), (-0.1, -0.12))):
        parts.append(f'<link name="wheel_{k}">{inertial(mass, moment)}{wheel}</link>')
        parts.append(
            make_driven_joint(f"axle_{k}", "base", f"wheel_{k}", f"{x} {y} 0", "0 1 0").replace(
                "revolute", "continuous"
            )
        )
    return robot(*parts)


def chain(links: int, light: float, tip: float) -> str:
    """An arm of light links with a heavy tip, on a foot."""
    parts = [f'<link name="l0">{inertial(2, 5e-3, com="0 0 0.05")}{BOX}</link>']
    axes = ("0 0 1", "0 1 0", "0 1 0", "0 1 0", "1 0 0", "0 1 0")
    shape = '<collision><origin xyz="0 0 0.05"/><geometry><box size="0.04 0.04 0.1"/></geometry></collision>'
    for k in range(1, links + 1):
        mass = tip if k == links else light
        parts.append(f'<link name="l{k}">{inertial(mass, mass * 1e-3, com="0 0 0.05")}{shape}</link>')
        bent = f'0 0 0.1" rpy="{axes[k - 1].replace("1", "0.3")}'
        parts.append(make_driven_joint(f"j{k}", f"l{k - 1}", f"l{k}", bent, axes[k - 1]).replace('"100"', '"5"'))
    return robot(*parts)


def dropped(folder: Path, model: str, steps: tuple[float, ...] = (4e-3, 8e-3)) -> Run:
    """The run of a drop test of this text; other ``steps`` than those that take long."""
    pytest.importorskip("mujoco")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("urdfcheck.core.drop_test.STEPS", steps)
        run = check_text(folder, model, codes={"DYN005"}, drop=True)
    assert not run.failures, run.failures
    return run


def outcome(folder: Path, model: str) -> DropTest:
    run = dropped(folder, model)
    assert not run.skipped, run.skipped
    (found,) = run.drops
    return found


def messages(run: Run) -> list[str]:
    return [finding.message_id for finding in run.findings]


@pytest.fixture(scope="module")
def car_3() -> Run:
    pytest.importorskip("mujoco")
    return check(CAR_3, codes={"DYN005"}, drop=True)


# -- robots ------------------------------------------------------------------------------------------------------------


def test_car_3_stands_on_its_four_wheels(car_3: Run) -> None:
    (found,) = car_3.drops
    assert not car_3.findings
    assert not car_3.skipped
    assert found.ground == pytest.approx(-0.030, abs=1e-5)
    for release in (found.free, found.held):
        assert [touching.link for touching in release.touching] == ["wheel_1", "wheel_2", "wheel_3", "wheel_4"]
        assert release.settled is not None
        assert release.tilt == pytest.approx(0, abs=1e-3)
        for touching in release.touching:
            assert touching.lowest == pytest.approx(-0.030, abs=1e-4)
            assert touching.place[2] == pytest.approx(-0.030, abs=1e-4)
            assert touching.load == pytest.approx(found.mass * 9.81 / 4, rel=0.03)
    (curve,) = found.curves
    assert curve.all_stable


def test_a_table_settles(tmp_path: Path) -> None:
    legs = []
    for k, (x, y) in enumerate(((0.4, 0.25), (0.4, -0.25), (-0.4, 0.25), (-0.4, -0.25))):
        shape = '<collision><origin xyz="0 0 -0.35"/><geometry><cylinder radius="0.02" length="0.7"/></geometry></collision>'
        legs += [f'<link name="leg_{k}">{inertial(1, 0.04, com="0 0 -0.35")}{shape}</link>']
        legs += [make_driven_joint(f"j{k}", "top", f"leg_{k}", f"{x} {y} 0", "0 1 0")]
    run = dropped(tmp_path, robot(f'<link name="top">{inertial(10, 0.5)}{BOX}</link>', *legs))
    (found,) = run.drops
    assert not run.findings
    assert found.held.settled is not None
    assert found.held.tilt == pytest.approx(0, abs=1e-3)
    assert {touching.link for touching in found.held.touching} == {"leg_0", "leg_1", "leg_2", "leg_3"}
    assert found.ground == pytest.approx(-0.7)


@pytest.mark.parametrize("mass", [0.01, 1.0, 1000.0])
def test_a_ball_sinks_in_as_deep_as_the_contact_is_soft(mass: float, tmp_path: Path) -> None:
    ball = '<collision><geometry><sphere radius="0.05"/></geometry></collision>'
    found = outcome(tmp_path, robot(f'<link name="ball">{inertial(mass, mass * 1e-3)}{ball}</link>'))
    assert found.free.depth == pytest.approx(found.soft, rel=0.1)
    assert sum(touching.load for touching in found.free.touching) == pytest.approx(9.81 * mass, rel=1e-3)


def test_what_stands_on_an_edge_falls_and_is_not_called_restless(tmp_path: Path) -> None:
    edge = '<collision><origin rpy="0.7 0 0"/><geometry><box size="0.1 0.1 0.1"/></geometry></collision>'
    run = dropped(tmp_path, robot(f'<link name="box">{inertial(1, 2e-3)}{edge}</link>'))
    (found,) = run.drops
    assert not run.findings
    assert found.free.has_tipped
    assert found.free.tilt == pytest.approx(0.7, abs=0.02)


def test_a_mass_in_grams_at_the_end_of_an_arm_explodes(tmp_path: Path) -> None:
    run = dropped(tmp_path, chain(6, 0.02, 10_000))
    assert messages(run) == ["explodes"]
    (found,) = run.drops
    assert found.held.burst is not None
    assert found.held.speed is None
    assert not dropped(tmp_path, chain(6, 0.2, 0.1)).findings


def test_wheels_of_next_to_no_mass_tremble(tmp_path: Path) -> None:
    assert messages(dropped(tmp_path, cart(1e-7, 4e-12))) == ["restless"]
    assert not dropped(tmp_path, cart(0.1, 5e-4)).findings


def test_the_robot_is_held_by_its_motors_as_far_as_they_can(tmp_path: Path) -> None:
    arm = robot(
        f'<link name="world">{BOX}</link><link name="arm">{inertial(1, 1e-3, com="0.2 0 0")}</link>',
        make_driven_joint("shoulder", "world", "arm", "0 0 1", "0 1 0"),
    )
    strong = outcome(tmp_path, arm)
    assert strong.fixed == "its root is world"
    assert strong.held.settled == 0
    assert strong.held.sag == pytest.approx(0, abs=1e-6)
    assert strong.free.settled is None, "without torques it swings"
    weak = dropped(tmp_path, arm.replace('effort="100"', 'effort="1"'))  # of 1.96 N·m
    assert weak.drops[0].held.sagging == "shoulder"
    assert weak.drops[0].held.sag is not None
    assert weak.drops[0].held.sag > 0.2
    assert not weak.findings
    unknown = outcome(tmp_path, arm.replace('effort="100"', 'effort="0"'))
    assert unknown.unlimited == ("shoulder",)
    assert unknown.held.sag == pytest.approx(0, abs=1e-6)


def test_a_follower_follows(tmp_path: Path) -> None:
    finger = (
        '<origin rpy="0 0 0"/><mass value="0.1"/><inertia ixx="1e-4" ixy="0" ixz="0" iyy="1e-4" iyz="0" izz="1e-4"/>'
    )
    arm = robot(
        f'<link name="world">{BOX}</link><link name="a">{inertial(0.1, 1e-4, com="0.1 0 0")}</link>',
        f'<link name="b"><inertial>{finger}</inertial></link>',
        make_driven_joint("first", "world", "a", "0 0 2", "0 1 0"),
        make_driven_joint("second", "world", "b", "0 1 2", "0 1 0", '<mimic joint="first" multiplier="2"/>'),
    )
    from urdfcheck.facts.motion.simulation import Simulation

    pytest.importorskip("mujoco")
    one = standing_of(tmp_path, arm)
    motion = Simulation(one.mechanism, one.ground).run(0.2, 1e-3, hold_joints=False)
    assert motion.joint_offsets[0] > 0.1
    assert motion.joint_offsets[1] == pytest.approx(2 * motion.joint_offsets[0], rel=0.02)


def test_a_root_without_mass_is_bolted_down(tmp_path: Path) -> None:
    arm = f'<link name="base"/><link name="arm">{inertial(1, 1e-2)}{BOX}</link>' + make_driven_joint(
        "j", "base", "arm", "0 0 1", "0 1 0"
    )
    assert outcome(tmp_path, robot(arm)).fixed == "its root base has no mass"


PLAIN = f'<link name="{{}}">{inertial(1, 1e-2)}</link>'


def make_limb(*names: str) -> str:
    """The links after the first, each on a joint of the link before."""
    pairs = list(pairwise(names))
    return "".join(PLAIN.format(child) for _, child in pairs) + "".join(
        make_driven_joint(f"{child}_joint", parent, child, "0 0 0.1", "0 1 0") for parent, child in pairs
    )


ROOT = f'<link name="base">{inertial(1, 1e-2)}{BOX}</link>'


@pytest.mark.parametrize(
    ("parts", "why"),
    [
        (make_limb("base", "a", "b"), "all that moves is one limb on base, without wheels or legs"),
        (make_limb("base", "a"), ""),
        (make_limb("base", "thigh", "shank"), ""),
        (make_limb("base", "a", "left_wheel"), ""),
        (make_limb("base", "a", "base_footprint"), ""),
        (make_limb("base", "a", "gripper_prop"), "all that moves is one limb on base, without wheels or legs"),
        (make_limb("base", "thumb") + make_limb("base", "l", "finger_1"), "all that moves on base are arms or fingers"),
        (make_limb("base", "larm") + make_limb("base", "rarm"), "all that moves on base are arms or fingers"),
        (make_limb("base", "alarm") + make_limb("base", "armature"), ""),
        (make_limb("base", "thumb") + make_limb("base", "lid"), ""),
        (make_limb("base", "a", "b").replace("revolute", "floating"), ""),
    ],
)
def test_arms_and_hands_are_bolted_down(parts: str, why: str, tmp_path: Path) -> None:
    from urdfcheck.model.motion.fixed_base import explain_fixed_base

    assert explain_fixed_base(make_model(tmp_path, robot(ROOT, parts))) == why


def test_fingers_on_a_palm_need_no_names(tmp_path: Path) -> None:
    hand = robot(ROOT, make_limb("base", "link_0"), make_limb("base", "link_4")).replace('"base"', '"palm_link"')
    assert outcome(tmp_path, hand).fixed == "all that moves on palm_link are arms or fingers"


@pytest.mark.parametrize(("kind", "why"), [("fixed", "the SRDF fixes base to the world"), ("planar", "")])
def test_the_semantic_description_decides(kind: str, why: str, tmp_path: Path) -> None:
    from urdfcheck.model.motion.fixed_base import explain_fixed_base

    (tmp_path / "robot.srdf").write_text(
        f'<robot name="r"><virtual_joint name="v" type="{kind}" parent_frame="world" child_link="base"/></robot>'
    )
    (tmp_path / "package.xml").write_text('<package format="3"><name>p</name></package>')
    model = make_model(tmp_path, robot(ROOT, make_limb("base", "a", "b")))
    assert explain_fixed_base(model) == why


@pytest.mark.usefixtures("one_process")
def test_the_command_decides(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("mujoco")
    path = tmp_path / "r.urdf"
    path.write_text(robot(ROOT, make_limb("base", "a", "b")), encoding="utf-8")
    told = []
    for base in ("auto", "fixed", "free"):
        assert main(["drop", str(path), "--no-cache", "--base", base]) == 0
        told.append(capsys.readouterr().out)
    assert "root fixed (all that moves is one limb on base" in " ".join(told[0].split())
    assert "root fixed (as asked)" in told[1]
    assert "root free" in told[2]


def test_a_bolted_robot_needs_no_shape_that_can_be_read(tmp_path: Path) -> None:
    broken = ROOT.replace("0.2 0.2 0.1", "0 1 1")
    found = outcome(tmp_path, robot(broken, make_limb("base", "a", "b")))
    assert (found.unread, found.shapes) == (("base",), 0)
    assert found.size == pytest.approx(0.2, rel=1e-3)
    told = " ".join(describe_drop_setup(found))
    assert "no ground: no shape could touch it without the shapes that could not be measured: base" in told
    assert outcome(tmp_path, robot(ROOT.replace(BOX, ""), make_limb("base", "a", "b"))).unread == ()
    shapes = robot(ROOT, make_limb("base", "a", "b").replace("</link>", BOX.replace("0.2 0.2", "0 0") + "</link>", 1))
    found = outcome(tmp_path, shapes)
    assert (found.unread, found.shapes, found.ground) == (("a",), 1, pytest.approx(-0.05))


def test_what_is_drawn_touches_where_nothing_collides(tmp_path: Path) -> None:
    shape = '<visual><geometry><box size="0.2 0.2 0.1"/></geometry></visual>'
    found = outcome(tmp_path, robot(f'<link name="box">{inertial(1, 1e-3)}{shape}</link>'))
    assert found.drawn
    assert found.ground == pytest.approx(-0.05)


LOOSE = f'<link name="b">{inertial(1, 1e-3)}</link>' + make_driven_joint("j", "a", "b", "0 0 1", "0 1 0").replace(
    "revolute", "floating"
)
SOUND = f'<link name="a">{inertial(1, 1e-3)}{BOX}</link>'


@pytest.mark.parametrize("kind", ["floating", "planar"])
def test_what_no_motor_holds_need_not_come_to_rest(kind: str, tmp_path: Path) -> None:
    run = dropped(tmp_path, robot(SOUND, LOOSE.replace("floating", kind)))
    assert not run.findings
    assert not run.skipped


@pytest.mark.parametrize(
    ("model", "why"),
    [
        (
            robot(SOUND, '<link name="b"/>', make_driven_joint("j", "a", "b", "0 0 0", "0 1 0")),
            "'b' moves and has no mass",
        ),
        (robot(SOUND.replace('"0.001"', '"0"')), "no inertia (INR004)"),
        (robot(SOUND.replace(BOX, "")), "no shape that could touch the ground"),
        (robot(f'<link name="world">{BOX}</link>'), "nothing of the robot can move"),
        (robot(SOUND.replace("0.2 0.2 0.1", "0 1 1")), "no collision shape of the robot could be read"),
        (robot(SOUND.replace('"1"', '"-1"')), "negative (INR002)"),
        (robot(SOUND.replace('"1"', '"one"')), "is not known (XML005, XML007)"),
        (robot(SOUND, LOOSE.replace("floating", "welded")), "is not known (KIN009)"),
        (robot(SOUND, LOOSE.replace("floating", "planar").replace('"0 1 0"', '"0 0 0"')), "zero or malformed"),
        (robot(SOUND.replace('izz="0.001"', 'izz="1"')), "MuJoCo refuses the model: inertia must satisfy A + B >= C"),
    ],
)
def test_why_a_robot_cannot_be_dropped(model: str, why: str, tmp_path: Path) -> None:
    run = dropped(tmp_path, model)
    assert not run.drops
    assert [why in skip.reason for skip in run.skipped] == [True], run.skipped


def standing_of(folder: Path, model: str):  # type: ignore[no-untyped-def]
    from urdfcheck.model.motion.mechanism import build_standing_robot

    return build_standing_robot(make_model(folder, model))


def make_model(folder: Path, model: str):  # type: ignore[no-untyped-def]
    from urdfcheck.model import Model
    from urdfcheck.source.load import load_source
    from urdfcheck.source.package.finder import PackageFinder

    path = folder / "robot.urdf"
    path.write_text(model, encoding="utf-8")
    source = load_source(path, {}, PackageFinder(folder, {}, []))
    assert source.root is not None
    return Model(source=source, robot=source.root)


# -- physics -----------------------------------------------------------------------------------------------------------


def pendulum(damping: float = 0.0):  # type: ignore[no-untyped-def]
    """1 kg, 0.3 m below its hinge, let go at 1 rad."""
    np = pytest.importorskip("numpy")
    pytest.importorskip("mujoco")
    from urdfcheck.facts.motion.simulation import Mechanism, RigidBody, SimulatedJoint, Simulation

    pose = np.eye(4)
    pose[2, 3] = 1.0
    hinge = SimulatedJoint(kind="hinge", axis=np.array((0.0, 1.0, 0.0)), damping=damping, start_value=1.0)
    com, inertia = np.array((0.0, 0.0, -0.3)), 1e-3 * np.eye(3)
    body = RigidBody(parent=-1, pose=pose, joint=hinge, mass=1.0, com=com, inertia=inertia)
    return Simulation(Mechanism((body,), (), (), grounded=True), 0.0)


def test_a_pendulum_without_friction_keeps_its_energy() -> None:
    """To the first order of the step: half the step, half the error."""
    errors = []
    for step in (2e-3, 1e-3, 5e-4):
        motion = pendulum().run(2.0, step, hold_joints=False)
        errors.append(abs(motion.energy - motion.energy[0]).max() / (9.81 * 0.3))
    assert errors[1] < 2e-3
    assert errors[0] / errors[1] == pytest.approx(2, rel=0.05)
    assert errors[1] / errors[2] == pytest.approx(2, rel=0.05)


def test_a_pendulum_swings_with_its_period() -> None:
    """From 1 rad: 2π √(I / mgl) · (1 + 1/16 + 11/3072 + …); its kinetic energy peaks twice in each."""
    period = 2 * math.pi * math.sqrt((1e-3 + 0.09) / (9.81 * 0.3)) * 1.0663
    motion = pendulum().run(2.0, 1e-3, hold_joints=False)
    slow = [
        i for i in range(1, len(motion.speed) - 1) if motion.speed[i] <= min(motion.speed[i - 1], motion.speed[i + 1])
    ]
    halves = [motion.time[b] - motion.time[a] for a, b in pairwise(slow)]
    assert sum(halves) / len(halves) == pytest.approx(period / 2, rel=0.02)


def test_damping_that_is_taken_before_the_step_is_stable_up_to_twice_the_time_constant() -> None:
    """As DYN003 says: 2 I / d, whatever the simulator."""
    limit = 2 * (1e-3 + 0.09) / 10.0
    motion = pendulum(10.0).run(5.0, 0.95 * limit, hold_joints=False, implicit_damping=False)
    assert motion.burst_time is None
    assert motion.energy.max() <= motion.energy[0] + 1e-9
    beyond = pendulum(10.0).run(5.0, 1.1 * limit, hold_joints=False, implicit_damping=False)
    assert beyond.burst_time is not None or beyond.energy.max() > 2 * abs(beyond.energy[0])
    assert pendulum(10.0).run(5.0, 1.1 * limit, hold_joints=False).burst_time is None


def test_a_tiny_inertia_behind_a_damped_joint_explodes_where_damping_is_explicit(tmp_path: Path) -> None:
    damped = '<dynamics damping="1"/>'
    arm = robot(
        f'<link name="base">{inertial(5, 0.05)}{BOX}</link><link name="tip">{inertial(1e-3, 1e-7, com="0.01 0 0")}</link>',
        make_driven_joint("j", "base", "tip", "0 0 0.3", "0 1 0", damped),
    )
    ((implicit, explicit),) = (found.curves for found in dropped(tmp_path, arm, STEPS[:4]).drops)
    assert implicit.all_stable
    assert explicit.largest_step is None
    assert explicit.speeds[0] is None


# -- the command -------------------------------------------------------------------------------------------------------


def test_the_command_tells_and_writes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("mujoco")
    report = tmp_path / "car.html"
    assert main(["drop", str(CAR_3), "--no-cache", "-o", f"html={report}"]) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "ground at z = -0.0300 m, the lowest point of its collision geometry" in told
    assert told.count("-0.0300 0.08") == 4
    assert "largest stable step 64 ms or more" in told
    assert "SYM001" not in told, "only what the drop test has to say"
    page = report.read_text(encoding="utf-8")
    assert page.count("<h3>Drop test</h3>") == 1
    assert "SYM001" in page, "the whole report"


@pytest.mark.usefixtures("one_process")
def test_a_finding_of_it_can_fail_a_gate(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("mujoco")
    page = (REPOSITORY / "rules" / "DYN005-drops-badly.md").read_text(encoding="utf-8")
    path = tmp_path / "table.urdf"
    path.write_text(page.partition("```urdf\n")[2].partition("```")[0], encoding="utf-8")
    assert main(["drop", str(path), "--no-cache", "--fail-on", "warning"]) == 1
    assert "▲ DYN005 dropped with no torques, " in capsys.readouterr().out


def test_without_mujoco_it_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert main(["drop", str(CAR_3)]) == 2
    assert "pip install 'urdfcheck[engines]'" in capsys.readouterr().err


@pytest.mark.usefixtures("one_process")
def test_what_cannot_be_dropped_is_an_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("mujoco")
    path = tmp_path / "r.urdf"
    path.write_text(robot(f'<link name="a">{inertial(1, 0)}{BOX}</link>'), encoding="utf-8")
    assert main(["drop", str(path), "--no-cache"]) == 2
    assert "moves and has no inertia (INR004)" in capsys.readouterr().err


def test_a_check_tells_that_it_needs_the_command() -> None:
    run = check(CAR_3, codes={"DYN005"})
    assert [(skip.code, skip.reason) for skip in run.skipped] == [
        ("DYN005", "needs a simulator: --target mujoco, or urdfcheck drop")
    ]


# -- the reports -------------------------------------------------------------------------------------------------------


def test_the_json_keeps_to_the_schema(car_3: Run) -> None:
    report = json.loads(render_json(car_3))
    jsonschema.validate(report, SCHEMA)
    (found,) = report["drops"]
    assert found["held"]["touching"][0]["link"] == "wheel_1"
    assert len(found["curves"][0]["steps"]) == len(found["curves"][0]["speeds"])


def test_a_burst_is_no_number_in_any_report(tmp_path: Path) -> None:
    run = dropped(tmp_path, chain(6, 0.02, 10_000))
    report = render_json(run)
    jsonschema.validate(json.loads(report), SCHEMA)
    assert json.loads(report)["drops"][0]["held"]["speed"] is None
    assert "explodes after" in text.render(run)
    assert "nan" not in text.render(run) + html.render(run)


def test_names_of_a_file_are_harmless_in_the_page(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    name = "&lt;script&gt;alert(1)&lt;/script&gt;"
    box = f'<link name="{name}">{inertial(1, 1e-3)}{BOX}</link>'
    run = check_text(tmp_path, robot(box), codes={"DYN005"}, drop=True, scene=True)
    page = html.render(run)
    assert "<script>alert" not in page
    assert "alert(1)" in page
