"""What the rules say that engines do is what they do: no rule says "refuses" of a model that an engine loads, and none is refused
of which no finding says so.

All examples of the pages, and the robots in the folders that ``URDFCHECK_CORPUS`` names (with a ``corpus.json``, or with
repositories as they come), are loaded once in each engine. Only MuJoCo, Pinocchio and urdfdom are asked, which are quick, about
the Bad examples and robots with small meshes; ``URDFCHECK_ENGINES=1`` asks all that are installed about all of them.
"""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import pytest
from builders import Number, arm_on_base, inertial, joint, link
from conftest import CORPORA, FIXTURES, get_shared_folder, make_once, make_request
from real_robots import TARGETED, check_robots, list_robots, read_input
from test_rules import BAD, GOOD, Case

from urdfcheck import cli
from urdfcheck.core import Finding, Rule, Run, Verdict
from urdfcheck.policy import consumers
from urdfcheck.policy.limits import ResourceLimits
from urdfcheck.rules import load_rules
from urdfcheck.run.jobs import Request
from urdfcheck.run.pipeline import IN_THIS_PROCESS, plan_units, run_audit
from urdfcheck.simulators.comparison import predict_verdict
from urdfcheck.simulators.engine_input import find_root_tag
from urdfcheck.simulators.judgement import judge_outcome, matches_prediction
from urdfcheck.simulators.outcome import EngineDynamics, EngineInput, LoadedRobot, LoadOutcome, TypedRobot
from urdfcheck.simulators.processes import ENGINES, get_install_hint, iter_outcomes, list_versions
from urdfcheck.system.process_pool import FORKS

pytestmark = pytest.mark.slow

# Who is asked otherwise.
QUICK = ("pinocchio", "urdfdom", "mujoco", "yourdfpy")
ALL = bool(os.environ.get("URDFCHECK_ENGINES"))
# Findings that say that a file was not read: what an engine does that reads it nobody knows.
UNREAD = {
    ("PKG004", "unread"),
    ("PKG012", "mesh"),
    ("PKG012", "read"),
    ("URC905", "model"),
    ("XML002", "part"),
    ("XML002", "part-of-failed"),
    ("XML002", "part-of-variant"),
}
# What no finding says of these.
KNOWN = {
    ("XML001-good-1", "drake"): "it has a <group> of its own",
    ("XML003-good-1", "drake"): "it has a <group> of its own",
    (
        '<mass value="',
        "gazebo",
    ): "the root's: without a mass it is dropped with all that hangs on it, as KIN010 says of a root that has none",
    ("MSH009-bad-1", "bullet"): "it does not follow the <instance_node> of COLLADA",
    **{
        (name, importer): reason
        for importer in ("newton", "isaac")
        for name, reason in {
            **dict.fromkeys(
                ("MSH001-good-1", "MSH012-bad-1", "PKG009-good-1"), "its mesh has one triangle, which is not converted"
            ),
            "XAC007-bad-4": "no link is left",
            "XML007-good-2": "it reads both shapes, the second of which has no number",
            "XML005-bad-1": "a joint without a child is one of its mistakes",
        }.items()
    },
    ("XML001-bad-2", "isaac"): "its parser has no UTF-7",
    ("Gepetto/example-robot-data:talos_full_v2", "gazebo"): "the pose of the merged inertial is not finite",
    (
        "Gepetto/example-robot-data:tiago_dual",
        "bullet",
    ): "a finger whose inertia it replaces by zero turns about its own axis",
    ("PR2/pr2_common:pr2", "gazebo"): "joints inside of <gazebo> name a link that the conversion drops",
}
# Bytes: larger meshes take Pinocchio minutes.
LARGEST = math.inf if ALL else 0.1 * 1024**2
# Words that a sentence may not begin with, because the report's table is made from the first one: they hide a verdict.
NEARLY = {
    *("is", "its", "it", "this", "has", "does", "warns", "accepts", "takes", "prints", "crashes"),
    *("rejects", "discards", "removes", "skips", "overwrites", "substitutes"),
    *("refuse", "drop", "ignore", "replace", "swap", "refused", "dropped", "ignored", "replaced", "swapped"),
}


def sentences(table: Mapping[str, object]) -> Iterator[tuple[str, str]]:
    """The consumers and sentences of a page's table."""
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from sentences(value)
        else:
            yield key, str(value)


@pytest.mark.parametrize("rule", list(load_rules().values()), ids=lambda rule: rule.code)
def test_consumers_are_known_and_say_at_once_what_they_do(rule: Rule) -> None:
    for consumer, sentence in sentences(rule.consumers):
        assert consumer in {*consumers.CONSUMERS, *consumers.OTHERS}
        first = sentence.split()[0].rstrip(",:;")
        assert first.lower() not in NEARLY, (
            f"{consumer}: {first} is not one of the words that the report knows: {sentence}"
        )


@dataclass(frozen=True)
class Example:
    """A model, as engines get it, with its findings."""

    name: str
    robot: EngineInput
    findings: tuple[Finding, ...]


def checked(name: str, request: Request) -> Iterator[Example]:
    """The models that a request leads to, with their findings; those that were not read whole are left out."""
    plan, units = plan_units(request, in_process=True)
    models = [unit for unit in units if unit.kind == "model"] if not plan.missing else []
    inputs = {
        unit.id: read_input(Path(unit.path), unit.arguments, unit.packages or request.packages, xacro=unit.is_xacro)
        for unit in models
    }
    if any(is_asked_about(robot) for robot in inputs.values()):
        run = run_audit(request, IN_THIS_PROCESS).outcome
        yield from list_examples(name, run, run.findings, inputs)


def list_examples(
    name: str, run: Run, found: Sequence[Finding], inputs: Mapping[str, EngineInput | None]
) -> Iterator[Example]:
    """The models of a run that engines are asked about, with what was found of each."""
    assert not run.failures, run.failures
    for model in run.models:
        findings = tuple(f for f in found if model.id in f.subjects_by_model)
        robot = inputs.get(model.id)
        if model.status == "needs-arguments" or UNREAD & {(f.code, f.message_id) for f in findings}:
            continue
        if robot is not None and is_asked_about(robot):
            yield Example(name if len(run.models) == 1 else f"{name}:{model.id}", robot, findings)


def is_asked_about(robot: EngineInput | None) -> bool:
    """Whether engines are asked about a robot: its meshes are small."""
    return robot is not None and meshes(robot) <= LARGEST


def ask(path: Path, **settings: object) -> Request:
    """A request with all rules, which must have been asked, for the worst of all findings counts."""
    return make_request(path, targets=TARGETED, **settings)


@pytest.fixture(scope="module")
def examples(tmp_path_factory: pytest.TempPathFactory) -> list[Example]:
    """The models of the pages' examples."""
    return make_once("pages", list_page_examples, tmp_path_factory)


def list_page_examples(folder: Path) -> list[Example]:
    found: list[Example] = []
    with pytest.MonkeyPatch.context() as patch:
        for variable in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH"):
            patch.delenv(variable, raising=False)
        for case in (*BAD, *GOOD) if ALL else BAD:
            if {"model", "file"} & set(load_rules()[case.rule].scopes):
                found += written(case, folder / str(case))
    return found


def written(case: Case, folder: Path) -> Iterator[Example]:
    (folder / ".git").mkdir(parents=True)  # nothing belongs to the example that lies beside it
    for name, text in case.files:
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="")
    target = folder if len(case.files) > 1 else folder / case.files[0][0]
    needs = {"dynamics", "collision"} & set(load_rules()[case.rule].needs)
    yield from checked(str(case), ask(target, tier="full" if needs else "mesh"))


def wrong(engine: str, examples: Sequence[Example], around: Path) -> list[str]:
    """Where an engine does not do what the findings say."""
    done = dict(
        iter_outcomes(
            [(engine, e.robot) for e in examples], around=[str(around)], limits=ResourceLimits(seconds=60), apart=False
        )
    )
    told = []
    for place, example in enumerate(examples):
        judgement = judge_outcome(example.robot, done[place])
        verdict, codes = predict_verdict(engine, example.findings)
        if not matches_prediction(verdict, judgement) and (example.name, engine) not in KNOWN:
            because = ", ".join(codes) or ", ".join(sorted({f.code for f in example.findings})) or "no finding"
            told.append(
                f"{example.name}: {engine} {judgement.verdict} ({'; '.join(judgement.reasons)}), not {verdict} ({because})"
            )
    print("\n".join(told))
    return told


def ensure_asked(engine: str) -> None:
    if list_versions()[engine] is None:
        pytest.skip(f"{engine} is not installed: {get_install_hint(engine)}")
    if not ALL and engine not in QUICK:
        pytest.skip(f"{engine} is asked where URDFCHECK_ENGINES or URDFCHECK_CORPUS is set")


@pytest.mark.long
@pytest.mark.parametrize("engine", ENGINES)
def test_what_pages_say_of_an_engine_is_what_it_does(
    engine: str, examples: list[Example], tmp_path_factory: pytest.TempPathFactory
) -> None:
    ensure_asked(engine)
    assert wrong(engine, examples, get_shared_folder(tmp_path_factory)) == []


def meshes(robot: EngineInput) -> int:
    """The bytes of all mesh files that a model uses."""
    files = {Path(os.fsdecode(name)) for name in re.findall(rb'filename="(/[^"]*)"', robot.document)}
    return sum(file.stat().st_size for file in files if file.is_file())


@pytest.fixture(scope="module", params=CORPORA or [None], ids=lambda folder: folder.name if folder else "no-corpus")
def robots(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Example]]:
    """The real robots of a folder, with or without a ``corpus.json``."""
    folder: Path | None = request.param
    if folder is None:
        pytest.skip("URDFCHECK_CORPUS names no folder")
    known = list_robots(folder) if (folder / "corpus.json").is_file() else []
    unread = {entry["id"] for entry in known if not (entry["expands"] and entry.get("urdf_links"))}
    return folder, [
        example
        for name, robot in check_robots(folder, tmp_path_factory).items()
        if name not in unread
        for example in list_examples(name, robot.run, robot.for_engines, robot.inputs)
    ]


@pytest.mark.parametrize("engine", ENGINES)
def test_real_robots_load_as_their_findings_say(engine: str, robots: tuple[Path, list[Example]]) -> None:
    ensure_asked(engine)
    folder, found = robots
    assert wrong(engine, found, folder) == []


# -- where MuJoCo takes a number for zero -------------------------------------------------------------------------------

SOUND = inertial()
TINY = ("0", "1e-20", "0.9e-15", "0.9e-14", "1.1e-14")


def equal(mass: Number, value: Number) -> str:
    return inertial(mass, ixx=value, ixy=value, ixz=value, iyy=value, iyz=value, izz=value)


def list_light_robots() -> Iterator[tuple[str, str]]:
    """Robots with masses and inertias about what programs take for zero: on a link that moves, on one that is fixed to it, and on
    the root."""
    parts = {f"{mass} kg, {value}": inertial(mass, value) for mass in ("1", "1e-6", "1e-16") for value in TINY}
    parts |= {f"ixx {value}": inertial(1, ixx=value) for value in (*TINY, "-1e-20")}
    parts |= {f"{mass} kg": inertial(mass) for mass in ("0", "-0.5", "-2")}
    parts |= {"six equal numbers": equal("1e-6", "1e-6"), "impossible": inertial("0", izz="9")}
    leg = link("leg", SOUND) + joint("hip", "arm", "leg", "continuous")
    for name, part in parts.items():
        yield f"{name} moves", arm_on_base(part, base=SOUND, axis="0 0 1")
        yield f"{name} is fixed", arm_on_base(SOUND, base=SOUND, more=link("tip", part) + joint("k", "arm", "tip"))
        for kind in ("continuous", "fixed"):
            yield f"{name} is the root, {kind}", arm_on_base(SOUND, base=part, kind=kind, more=leg)


def test_mujoco_refuses_of_light_links_what_the_rules_say(tmp_path: Path) -> None:
    ensure_asked("mujoco")
    found = []
    for number, (name, text) in enumerate(list_light_robots()):
        path = tmp_path / f"{number}.urdf"
        path.write_text(text, encoding="utf-8")
        found += checked(name, ask(path, tier="source", codes={f"INR{i:03}" for i in (1, 2, 3, 4, 12, 17)}))
    assert wrong("mujoco", found, tmp_path) == []


# -- numbers that are missing -------------------------------------------------------------------------------------------

SHAPES = (
    '<box size="1 1 1"/>',
    '<sphere radius="1"/>',
    '<cylinder radius="1" length="1"/>',
    '<capsule radius="1" length="1"/>',
)
PLACE = '<origin xyz="0 0 0" rpy="0 0 0"/>'
NUMBERS = re.compile(r'(?<=")[-+0-9. ]+(?=")')


def write_robot_of_every_number() -> str:
    """A sound robot with every attribute that urdfdom, MuJoCo, Drake or Bullet read as numbers."""
    sound = SOUND.replace("<inertial>", f"<inertial>{PLACE}")
    paint = '<material name="paint"><color rgba="1 1 1 1"/></material>'
    drawn = "".join(f"<visual>{PLACE}<geometry>{shape}</geometry></visual>" for shape in SHAPES)
    drawn = drawn.replace("</visual>", f"{paint}</visual>", 1)
    solid = "".join(f"<collision>{PLACE}<geometry>{shape}</geometry></collision>" for shape in SHAPES)
    limits = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
    more = (
        f'{PLACE}<axis xyz="1 0 0"/>{limits}<dynamics damping="1" friction="1"/><calibration rising="1" falling="1"/>'
        '<safety_controller k_velocity="1" k_position="1" soft_lower_limit="0" soft_upper_limit="0.5"/>'
    )
    return (
        f'<robot name="r">{link("base", SOUND + drawn + solid)}{link("arm", sound)}{link("tip", SOUND)}'
        f'<joint name="j" type="revolute"><parent link="base"/><child link="arm"/>{more}</joint>'
        f'<joint name="k" type="revolute"><parent link="arm"/><child link="tip"/><axis xyz="1 0 0"/>{limits}'
        '<mimic joint="j" multiplier="1" offset="0"/></joint></robot>'
    )


@pytest.mark.long
@pytest.mark.parametrize("engine", QUICK if not ALL else ENGINES)
def test_what_engines_do_with_an_empty_number(engine: str, tmp_path_factory: pytest.TempPathFactory) -> None:
    ensure_asked(engine)
    found = make_once("empty-numbers", list_robots_without_a_number, tmp_path_factory)
    assert len(found) > 40
    assert wrong(engine, found, get_shared_folder(tmp_path_factory)) == []


def list_robots_without_a_number(folder: Path) -> list[Example]:
    """A sound robot, and for each number of it the same robot without this number."""
    text = write_robot_of_every_number()
    found = []
    for number, place in enumerate([None, *NUMBERS.finditer(text)]):
        path = folder / f"{number}.urdf"
        path.write_text(text if place is None else text[: place.start()] + text[place.end() :], encoding="utf-8")
        name = "sound" if place is None else text[text.rindex("<", 0, place.start()) : place.start()]
        found += [replace(e, name=name) for e in checked(name, ask(path, tier="source"))]
    return found


def test_the_command_compares_all_engines(capsys: pytest.CaptureFixture[str]) -> None:
    model = str(FIXTURES / "car-3" / "urdf" / "car-3.urdf")
    code = cli.main(["engines", model, "--format", "json", "--isolated"])
    document = json.loads(capsys.readouterr().out)
    there = {name for name, version in list_versions().items() if version is not None}
    assert set(document["engines"]) == there
    assert set(document["missing"]) == set(ENGINES) - there
    assert document["engines"]["pinocchio"]["mass"] == pytest.approx(0.6105076)
    for name, found in document["engines"].items():
        # NAM001 says that importers to USD replace the robot's name, which is not compared.
        assert found["verdict"] == found["predicted"] or found["because"] == ["NAM001"], name
        assert found["matrix"] is None or found["matrix"] < (1e-6 if name in {"newton", "isaac"} else 1e-9)
    assert code == cli.OK  # Drake refuses STL, as MSH011 says


def test_yourdfpy_places_and_draws_what_was_typed_and_follows_no_follower(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A joint that mimics one that mimics another gets the offset alone."""
    body = link("{0}", f"<visual>{PLACE}<geometry><box size='0.1 0.2 0.3'/></geometry></visual>" + SOUND)
    links = "".join(body.replace("{0}", name) for name in ("base", "a", "b", "c"))
    follower = '<mimic joint="{}" multiplier="-2" offset="0.1"/>'
    first = joint("to_a", "base", "a", kind="continuous")
    second = joint("to_b", "a", "b", follower.format("to_a"), kind="continuous")
    for leader, verdict in (("to_a", "loads"), ("to_b", "replaces")):
        model = tmp_path / f"{leader}.urdf"
        third = joint("to_c", "b", "c", follower.format(leader), kind="continuous")
        model.write_text(f'<robot name="r">{links}{first}{second}{third}</robot>')
        cli.main(["engines", str(model), "--format", "json", "--isolated"])
        found = json.loads(capsys.readouterr().out)["engines"]["yourdfpy"]
        assert found["verdict"] == verdict, found
        assert not found["reasons"] or found["reasons"] == [
            "at random configurations the frame of link c differs in orientation"
        ]


def test_what_cannot_be_read_is_given_to_no_engine(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    model = tmp_path / "r.urdf.xacro"
    model.write_text('<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="${nowhere}"/></robot>')
    assert cli.main(["engines", str(model), "--isolated"]) == cli.FAILED
    assert "urdfcheck check says what is wrong" in capsys.readouterr().err


@pytest.mark.parametrize(
    "text",
    [
        '<mujoco><include file="{}"/></mujoco>',
        '<sdf version="1.9"><include><uri>{}</uri></include></sdf>',
        '<!-- --><mujoco><include file="{}"/></mujoco><!-- --><robot name="r"><link name="a"/></robot>',
        '<?a > <robot?><mujoco><include file="{}"/></mujoco>',
    ],
)
def test_an_engine_is_given_robots_only(text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A model of an engine's own format could name any file."""
    (tmp_path / "other.xml").write_text('<mujoco><worldbody><body name="other"/></worldbody></mujoco>')
    model = tmp_path / "r.urdf"
    model.write_text(text.format(tmp_path / "other.xml"))
    assert cli.main(["engines", str(model), "--isolated"]) == cli.FAILED
    said = capsys.readouterr()
    assert "only readable files with a <robot>" in said.err
    assert not said.out


def test_the_root_is_found_behind_comments_and_declarations() -> None:
    text = b'\xef\xbb\xbf<?xml version="1.0"?>\n<!-- <mujoco/> --><?a <b?>\t<robot name="r"/>'
    assert find_root_tag(text) == b"robot"
    assert (
        find_root_tag(b"<!-- <robot/>") == find_root_tag(b"a <robot/>") == find_root_tag(b"<!DOCTYPE a><robot/>") == b""
    )
    assert find_root_tag(b"<robots/>") == b"robots"


def test_an_engine_that_crashes_says_so_and_takes_nobody_along() -> None:
    ensure_asked("pinocchio")
    robot = EngineInput(document=b'<robot name="r"><link name="a"/></robot>')
    nested = EngineInput(document=b'<robot name="r">' + chain(20_000) + b"</robot>")
    first, second = (
        dict(iter_outcomes([("urdfdom", r)], around=[], limits=ResourceLimits()))[0] for r in (nested, robot)
    )
    assert "crashes" in first.refused
    assert second.loaded is not None


def test_drake_fetches_nothing() -> None:
    """Its map of packages has one on a server, which it would fetch, or say where it could not put it."""
    pytest.importorskip("pydrake")
    mesh = '<visual><geometry><mesh filename="package://drake_models/ycb/meshes/a.obj"/></geometry></visual>'
    robot = EngineInput(document=f'<robot name="r"><link name="a">{mesh}</link></robot>'.encode())
    outcome = dict(iter_outcomes([("drake", robot)], around=[], limits=ResourceLimits()))[0]
    assert "drake_models" in outcome.refused
    assert not re.search("download|cache|Permission", " ".join((outcome.refused, *outcome.messages)))


EngineRun = Callable[[Callable[[Path], object]], tuple[LoadOutcome, ...]]


@pytest.fixture
def taken_over(monkeypatch: pytest.MonkeyPatch) -> EngineRun:
    """EngineRun two engines, the first of which does what a hostile file could make it do in its folder, and dies."""
    if not FORKS:
        pytest.skip("the process that is started anew does not know what is replaced here")

    def run(deed: Callable[[Path], object]) -> tuple[LoadOutcome, ...]:
        import urdfcheck.simulators.pinocchio
        import urdfcheck.simulators.urdfdom

        def load_hostile(_robot: EngineInput, path: str) -> LoadedRobot:
            deed(Path(path).parent)
            os._exit(1)

        def load_well(_robot: EngineInput, path: str) -> LoadedRobot:
            os.write(1, b"well: " + Path(path).read_bytes())
            os._exit(1)

        monkeypatch.setattr(urdfcheck.simulators.pinocchio, "load", load_hostile)
        monkeypatch.setattr(urdfcheck.simulators.urdfdom, "load", load_well)
        for module in (urdfcheck.simulators.pinocchio, urdfcheck.simulators.urdfdom):
            monkeypatch.setattr(module, "LIBRARIES", ())
        robot = EngineInput(document=b"<robot/>")
        jobs = [("pinocchio", robot), ("urdfdom", robot)]
        found = dict(iter_outcomes(jobs, around=[], limits=ResourceLimits(seconds=10.0)))
        return found[0], found[1]

    return run


def test_what_an_engine_puts_in_the_place_of_its_output_is_not_followed(taken_over: EngineRun, tmp_path: Path) -> None:
    """The process that reads it is not confined."""
    (tmp_path / "secret").write_text("token")

    def link(own: Path) -> None:
        (own / "said").unlink()
        (own / "said").symlink_to(tmp_path / "secret")

    first, second = taken_over(link)
    assert first.refused == "ends its process"
    assert first.messages == ()
    assert second.messages == ("well: <robot/>",)


def test_an_engine_changes_nothing_of_the_others(taken_over: EngineRun) -> None:
    def forge(own: Path) -> None:
        (own.parent / "1" / "said").write_text("forged")

    first, second = taken_over(forge)
    assert "Permission denied" in first.refused
    assert second.messages == ("well: <robot/>",)


def test_what_an_engine_writes_is_bounded(taken_over: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("urdfcheck.simulators.processes.LARGEST_FILE", 1)

    def fill(own: Path) -> None:
        (own / "large").write_bytes(bytes(2 * 1024**2))

    first, second = taken_over(fill)
    assert "File too large" in first.refused
    assert second.messages == ("well: <robot/>",)


def chain(levels: int) -> bytes:
    """Links that hang one below the other: urdfdom goes down by calling itself."""
    links = "".join(f'<link name="l{i}"/>' for i in range(levels))
    joints = (
        f'<joint name="j{i}" type="fixed"><parent link="l{i}"/><child link="l{i + 1}"/></joint>'
        for i in range(levels - 1)
    )
    return (links + "".join(joints)).encode()


# -- what was measured, in words --------------------------------------------------------------------------------------

MOTION = EngineDynamics(joints=("j",), masses=(((0.5,),),), torques=((2.0,),), accelerations=(-4.0,))
PLACED = {"arm": (1.0, 0.0, 0.0, 0.5, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0)}
TURNED = {"arm": (0.0, -1.0, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0)}
# As far off as single precision puts it.
NEARBY = {"arm": (*PLACED["arm"][:3], 0.500004, *PLACED["arm"][4:])}
BOX = {"arm": (0.0, 0.0, 0.0, 0.3, 0.4, 1.2)}
TYPED = TypedRobot(
    root="base",
    heads={"base": "base", "arm": "arm"},
    joints=("j",),
    masses={"base": 1.0, "arm": 2.0},
    limits={"j": (-1.0, 1.0)},
    shapes=1,
    motion=MOTION,
    frames=(PLACED,),
    drawn=BOX,
)
LOADED = LoadedRobot(links={"base": 0.0, "arm": 2.0}, joints=("j",), limits={"j": (-1.0, 1.0)}, shapes=1, motion=MOTION)


@pytest.mark.parametrize(
    ("loaded", "verdict", "words"),
    [
        (LOADED, Verdict.LOADS, ""),
        (None, Verdict.REFUSES, "no such file"),
        (replace(LOADED, links={"base": 1.0}), Verdict.DROPS, "without link arm"),
        (replace(LOADED, joints=()), Verdict.LOADS, ""),  # it has no names for joints
        (replace(LOADED, joints=("k",)), Verdict.DROPS, "without joint j"),
        (replace(LOADED, shapes=0), Verdict.DROPS, "without 1 of 1 collision shapes"),
        (replace(LOADED, links={"base": 1.0, "arm": 3.0}), Verdict.REPLACES, "link arm has 3 kg instead of 2 kg"),
        (replace(LOADED, limits={"j": (1.0, -1.0)}), Verdict.SWAPS, "the limits of joint j are exchanged"),
        (replace(LOADED, limits={"j": None}), Verdict.IGNORES, "joint j has no limits"),
        (replace(LOADED, limits={"j": (-1.0, 2.0)}), Verdict.REPLACES, "joint j has the limits -1 and 2"),
        (replace(LOADED, frames=(PLACED,), drawn=BOX), Verdict.LOADS, ""),
        (
            replace(LOADED, frames=({"arm": (*PLACED["arm"][:3], 0.7, *PLACED["arm"][4:])},)),
            Verdict.REPLACES,
            "at random configurations the frame of link arm differs by up to 0.2 m",
        ),
        (
            replace(LOADED, frames=(TURNED,)),
            Verdict.REPLACES,
            "at random configurations the frame of link arm differs in orientation",
        ),
        (replace(LOADED, frames=(NEARBY,)), Verdict.REPLACES, "at random configurations the frame of link arm differs"),
        (replace(LOADED, frames=(NEARBY,), accuracy=1e-5), Verdict.LOADS, ""),
        (replace(LOADED, drawn={}), Verdict.DROPS, "without the visuals of link arm"),
        (
            replace(LOADED, drawn={"arm": (0.0, 0.0, 0.0, 0.6, 0.8, 2.4)}),
            Verdict.REPLACES,
            "link arm is drawn 2.6 m large instead of 1.3 m",
        ),
        (
            replace(LOADED, drawn={"arm": (0.0, 0.0, 0.0, 0.3, 1.2, 0.4)}),
            Verdict.REPLACES,
            "what link arm draws is moved or rotated by up to 0.8 m",
        ),
        (replace(LOADED, motion=replace(MOTION, masses=(((1.0,),),))), Verdict.REPLACES, "the mass matrix differs"),
        (replace(LOADED, motion=replace(MOTION, accelerations=(-2.0,))), Verdict.REPLACES, "the accelerations differ"),
        (
            replace(LOADED, motion=replace(MOTION, accelerations=(math.nan,))),
            Verdict.NAN,
            "the accelerations are not a number",
        ),
    ],
)
def test_what_an_engine_did_is_judged_by_what_was_typed(
    loaded: LoadedRobot | None, verdict: Verdict, words: str
) -> None:
    judgement = judge_outcome(
        EngineInput(document=b"", typed=TYPED, moved_links=("arm",)),
        LoadOutcome("mujoco", loaded=loaded, refused="no such file"),
    )
    assert judgement.verdict is verdict
    assert " ".join(judgement.reasons).startswith(words)


def test_of_what_is_no_tree_the_missing_links_are_seen() -> None:
    assert judge_outcome(
        EngineInput(document=b"", moved_links=("arm", "hand")), LoadOutcome("bullet", loaded=LOADED)
    ).reasons == ("without link hand",)
