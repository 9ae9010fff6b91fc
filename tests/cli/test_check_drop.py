"""What MuJoCo makes of a robot as a part of ``urdfcheck check --target mujoco``. Skipped where MuJoCo is not installed."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import jsonschema
import pytest
from builders import inertial, joint, link, robot
from conftest import check_text, command

from urdfcheck.core import Finding, Run, Severity, Verdict
from urdfcheck.core.run import EngineAnswer
from urdfcheck.model.motion import simulated_drop
from urdfcheck.output.json import render as render_json
from urdfcheck.output.shared.verdict.engine_answers import describe_answers
from urdfcheck.simulators import target_answers

pytestmark = pytest.mark.slow
mujoco = pytest.importorskip("mujoco")

SCHEMA = json.loads((files("urdfcheck.output") / "report.schema.json").read_text(encoding="utf-8"))
ROUND = (
    '<collision><origin rpy="1.5707963 0 0"/><geometry><cylinder radius="0.05" length="0.02"/></geometry></collision>'
)
BALL = '<collision><origin xyz="{x} 0 0.01"/><geometry><sphere radius="0.01"/></geometry></collision>'
BODY = '<collision><origin xyz="0 0 0.1"/><geometry><box size="0.3 0.2 0.08"/></geometry></collision>'
MISSING = '<collision><geometry><mesh filename="package://absent/part.stl"/></geometry></collision>'


def make_cart(axle: float = 0.05, *, skid: str = "", wheel: str = ROUND) -> str:
    """Two wheels with their axle at this height (m), and casters before and behind them; ``skid``: a shape of the body instead of
    the second."""
    wheels = [
        part
        for side, y in (("left", 0.15), ("right", -0.15))
        for part in (
            link(f"{side}_wheel", inertial(0.3, 4e-4), wheel),
            joint(f"{side}_joint", "base_link", f"{side}_wheel", kind="continuous", xyz=f"0 {y} {axle}", axis="0 1 0"),
        )
    ]
    return robot(
        link("base_link", inertial(3, 0.03, com="0.03 0 0.1"), BODY, skid),
        *wheels,
        link("caster", BALL.format(x="0")),
        joint("caster_joint", "base_link", "caster", xyz="0.1 0 0"),
        *(
            []
            if skid
            else [link("rear_caster", BALL.format(x="0")), joint("rear", "base_link", "rear_caster", xyz="-0.1 0 0")]
        ),
    )


def check_for_mujoco(folder: Path, model: str, **settings: object) -> Run:
    run = check_text(folder, model, **{"targets": ("mujoco",), **settings})
    assert not run.failures, run.failures
    return run


def list_simulated(run: Run) -> list[Finding]:
    return [finding for finding in run.findings if finding.code in {"DYN005", "DYN007"}]


def describe_fall(run: Run) -> str:
    """What the line about MuJoCo says, if it loaded the model."""
    (info,) = run.models
    answer = EngineAnswer(model=info.id, engine="mujoco", version="4", verdict=Verdict.LOADS, reasons=())
    (sentence,) = describe_answers(replace(run, answers=(answer,)))
    return sentence.removeprefix("MuJoCo 4 loaded it here; ")


def test_a_sound_robot_is_dropped_and_driven(tmp_path: Path) -> None:
    run = check_for_mujoco(tmp_path, make_cart())
    (drop,) = run.drops
    assert not list_simulated(run)
    assert drop.held.settled is not None
    assert drop.drive is not None
    assert drop.curves == (), "the time steps are the command's"
    assert describe_fall(run) == "dropped with its joints held, it comes to rest"
    jsonschema.validate(json.loads(render_json(run)), SCHEMA)


def test_what_another_rule_explains_is_part_of_its_finding(tmp_path: Path) -> None:
    run = check_for_mujoco(tmp_path, make_cart(0.06))
    assert not list_simulated(run)
    (uneven,) = [f for f in run.findings if (f.code, f.message_id) == ("DYN006", "unloaded")]
    assert uneven.consequences["mujoco"].startswith(
        "simulated it here: dropped, left_wheel, right_wheel bear no weight"
    )
    assert uneven.data["hides"] == ["DYN005"]
    alone = check_for_mujoco(tmp_path, make_cart(0.06), codes={"DYN005"})
    assert [finding.message_id for finding in alone.findings] == ["unloaded"]
    # A note does not stand for a warning.
    noted = check_for_mujoco(tmp_path, make_cart(0.06), severities={"DYN006": "info"})
    assert [finding.message_id for finding in list_simulated(noted)] == ["unloaded"]


@pytest.mark.parametrize(
    "settings",
    [{"targets": ("drake",)}, {"tier": "mesh"}, {"codes": {"INR003"}}, {"simulate": False}],
    ids=lambda settings: next(iter(settings)),
)
def test_nothing_is_dropped_that_nobody_asks_for(settings: dict[str, object], tmp_path: Path) -> None:
    assert not check_for_mujoco(tmp_path, make_cart(0.06), **settings).drops


def test_without_mujoco_nothing_is_dropped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("urdfcheck.run.unit_audit.find_library_origin", lambda _: None)
    run = check_for_mujoco(tmp_path, make_cart())
    assert not run.drops
    assert {skip.reason for skip in run.skipped if skip.code == "DYN005"} == {
        "needs a simulator: --target mujoco, or urdfcheck drop"
    }


# -- what is missing ---------------------------------------------------------------------------------------------------


def test_a_robot_falls_on_the_shapes_that_are_left(tmp_path: Path) -> None:
    run = check_for_mujoco(tmp_path, make_cart(0.06, wheel=MISSING))
    (drop,) = run.drops
    assert drop.unread == ("left_wheel", "right_wheel")
    assert {touching.link for touching in drop.held.touching} == {"caster", "rear_caster"}
    assert drop.undriven == "a shape of link 'left_wheel' could not be measured"
    assert not list_simulated(run), "it stands on what it should not, and nothing is known of that"
    assert describe_fall(run).endswith("(without the shapes of left_wheel, right_wheel, which could not be measured)")


def test_a_robot_of_which_no_shape_is_left_is_not_dropped(tmp_path: Path) -> None:
    run = check_for_mujoco(tmp_path, robot(link("box", inertial(1, 1e-2), MISSING)))
    assert not run.drops
    told = "it was not dropped: no collision shape of the robot could be read, so nothing could touch the ground"
    assert describe_fall(run) == told


def test_a_robot_with_very_many_joints_is_left_to_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(simulated_drop, "MOST_JOINTS", 1)
    run = check_for_mujoco(tmp_path, make_cart())
    assert (
        describe_fall(run) == "it was not dropped: 2 joints move, and a check drops robots with up to 1: urdfcheck drop"
    )
    assert check_text(tmp_path, make_cart(), codes={"DYN005"}, drop=True).drops


# -- what is no defect -------------------------------------------------------------------------------------------------


def test_a_skid_that_is_drawn_with_the_body_may_bear_weight(tmp_path: Path) -> None:
    """All wheels and the caster bear weight too; a body that is 5 mm lower lifts the wheels."""
    level = BALL.format(x="-0.1")
    run = check_for_mujoco(tmp_path, make_cart(skid=level), codes={"DYN005"})
    assert "base_link" in {touching.link for touching in run.drops[0].held.touching}
    assert not run.findings
    low = make_cart(skid=level.replace(" 0.01", " 0.005"))
    assert [finding.message_id for finding in check_for_mujoco(tmp_path, low, codes={"DYN005"}).findings] == ["touches"]


def test_an_explosion_that_only_the_test_causes_is_a_note(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (sound,) = check_for_mujoco(tmp_path, make_cart()).drops
    burst = replace(sound.free, burst=1.0, speed=None, gain=None, tilt=None, settled=None)
    severities = []
    stiff = replace(burst, held=True)
    for free, finer, held in (
        (burst, sound.free, sound.held),
        (sound.free, None, stiff),
        (burst, burst, sound.held),
        (burst, sound.free, stiff),
    ):
        test = replace(sound, free=free, held=held, finer=finer)
        monkeypatch.setattr(simulated_drop, "run_drop_test", lambda _, test=test: test)
        (finding,) = check_for_mujoco(tmp_path, make_cart(), codes={"DYN005"}).findings
        severities.append(finding.severity)
    assert severities == [Severity.INFO, Severity.INFO, Severity.WARNING, Severity.WARNING]


def test_wheels_that_hang_by_a_hair_are_loaded(tmp_path: Path) -> None:
    """Which of four supports bear weight is a matter of rounding below half a millimetre."""
    assert not check_for_mujoco(tmp_path, make_cart(0.0503), codes={"DYN005"}).findings
    assert check_for_mujoco(tmp_path, make_cart(0.0517), codes={"DYN005"}).findings


def test_rollers_are_parts_of_their_wheels(tmp_path: Path) -> None:
    model = make_cart()
    for side in ("left", "right"):
        roller = link(f"{side}_roller", inertial(0.01, 1e-6), BALL.format(x="0").replace(" 0.01", " -0.045"))
        turns = joint(f"{side}_turn", f"{side}_wheel", f"{side}_roller", kind="continuous", axis="1 0 0")
        model = model.replace("</robot>", f"{roller}{turns}</robot>")
    run = check_for_mujoco(tmp_path, model, codes={"DYN005"})
    assert {"left_roller", "right_roller"} & {touching.link for touching in run.drops[0].free.touching}
    assert not run.findings


GAZEBO = (
    '<gazebo><plugin filename="gz-sim-diff-drive-system" name="gz::sim::systems::DiffDrive">'
    "<left_joint>left_joint</left_joint><right_joint>right_joint</right_joint>"
    "<wheel_separation>0.3</wheel_separation><wheel_radius>0.05</wheel_radius></plugin></gazebo></robot>"
)


def test_where_a_plugin_sends_the_robot_concerns_gazebo(tmp_path: Path) -> None:
    backwards = make_cart().replace('xyz="0 1 0"', 'xyz="0 -1 0"').replace("</robot>", GAZEBO)
    for targets, severity in ((("mujoco",), Severity.INFO), (("mujoco", "gazebo"), Severity.WARNING)):
        (finding,) = check_for_mujoco(tmp_path, backwards, codes={"DYN007"}, targets=targets).findings
        assert (finding.message_id, finding.severity) == ("backwards", severity)


def test_opposed_wheels_that_nothing_commands_are_a_note(tmp_path: Path) -> None:
    opposed = make_cart().replace('xyz="0 1 0"', 'xyz="0 -1 0"', 1)
    (finding,) = check_for_mujoco(tmp_path, opposed, codes={"DYN007"}).findings
    assert (finding.message_id, finding.severity) == ("spins", Severity.INFO)
    (told,) = check_for_mujoco(tmp_path, opposed, codes={"DYN007", "SYM005"}).findings
    assert (told.code, told.severity) == ("SYM005", Severity.INFO)
    assert told.consequences["mujoco"].startswith("simulated it here: driven ahead, the robot spins")


def test_a_caster_that_sinks_into_soft_ground_is_no_lean(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The robot leans by 4°, but what it rests on is level in its own frame."""
    (sound,) = check_for_mujoco(tmp_path, make_cart()).drops
    sunk = replace(sound.held, tilt=0.07)
    raised = tuple(replace(t, lowest=t.lowest + 0.07 * t.place[0]) for t in sunk.touching)
    for held, found in ((sunk, []), (replace(sunk, touching=raised), ["leans"])):
        test = replace(sound, held=held)
        monkeypatch.setattr(simulated_drop, "run_drop_test", lambda _, test=test: test)
        run = check_for_mujoco(tmp_path, make_cart(), codes={"DYN005"})
        assert [finding.message_id for finding in run.findings] == found


def test_wheels_with_grip_that_lose_rotation_all_alike_creep(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (sound,) = check_for_mujoco(tmp_path, make_cart()).drops
    assert sound.drive is not None
    wheels = tuple(replace(wheel, travelled=0.85 * wheel.rolled) for wheel in sound.drive.wheels)
    forward = replace(sound.drive.forward, ahead=0.85 * sound.drive.forward.ahead)
    creeping = replace(sound, drive=replace(sound.drive, wheels=wheels, forward=forward))
    one = replace(sound, drive=replace(sound.drive, wheels=(wheels[0], sound.drive.wheels[1]), forward=forward))
    smooth = '<gazebo reference="{}_wheel"><mu1>0.05</mu1><mu2>0.05</mu2></gazebo>'
    slippery = make_cart().replace("</robot>", f"{smooth.format('left')}{smooth.format('right')}</robot>")
    for test, model, found in (
        (creeping, make_cart(), []),
        (one, make_cart(), ["slips"]),
        (creeping, slippery, ["slips"]),
    ):
        monkeypatch.setattr(simulated_drop, "run_drop_test", lambda _, test=test: test)
        run = check_for_mujoco(tmp_path, model, codes={"DYN007"})
        assert [finding.message_id for finding in run.findings] == found


# -- processes and caches ----------------------------------------------------------------------------------------------


def test_a_crash_of_the_simulator_takes_nothing_else_with_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("urdfcheck.facts.motion.simulation.Simulation.run", lambda *_, **__: os._exit(7))
    path = tmp_path / "cart.urdf"
    path.write_text(make_cart(0.06), encoding="utf-8")
    done = command(str(path), "--target", "mujoco", "--no-cache")
    told = " ".join(done.stdout.split())
    assert "DYN006" in told
    assert "it was not dropped: the process in which MuJoCo simulated the model died (exit code 7)" in told
    assert done.returncode == 0, "a warning"


def test_an_unchanged_model_is_not_simulated_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "cart.urdf"
    path.write_text(make_cart(0.06), encoding="utf-8")
    os.utime(path, (1e9, 1e9))
    cache = {"URDFCHECK_CACHE_DIR": str(tmp_path / "cache")}
    first = command(str(path), "--target", "mujoco", "--format", "json", **cache)

    def fail(*_: object, **__: object) -> None:
        raise AssertionError("it is asked again")

    monkeypatch.setattr("urdfcheck.facts.motion.simulation.Simulation.run", fail)
    monkeypatch.setattr(target_answers, "iter_outcomes", fail)
    again = command(str(path), "--target", "mujoco", "--format", "json", **cache)
    # Another format of the same run needs the model's report and the engine's answer, and no run as a whole.
    monkeypatch.setattr("urdfcheck.cli.unchanged_runs.UnchangedRuns.recall", lambda _: None)
    apart = command(str(path), "--target", "mujoco", "--format", "json", **cache)
    documents = [json.loads(done.stdout) for done in (first, again, apart)]
    for document in documents:
        del document["seconds"]
        for model in document["models"]:
            del model["seconds"]
    assert documents[0] == documents[1] == documents[2]
    assert documents[0]["answers"][0]["verdict"] == "loads"


def test_an_engine_that_was_stopped_is_asked_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "r.urdf"
    path.write_text(robot(link("base", inertial(1, 1e-2))), encoding="utf-8")
    os.utime(path, (1e9, 1e9))
    words = (str(path), "--target", "mujoco", "--select", "XML015", "--format", "json")
    cache = {"URDFCHECK_CACHE_DIR": str(tmp_path / "cache")}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("urdfcheck.simulators.mujoco.load", lambda *_: os._exit(7))
        crashed = json.loads(command(*words, **cache).stdout)
    assert crashed["answers"][0]["reasons"] == ["ends its process"]
    assert json.loads(command(*words, **cache).stdout)["answers"][0]["verdict"] == "loads"
