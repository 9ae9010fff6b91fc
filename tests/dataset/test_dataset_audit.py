"""The audit of many models: nothing is lost, nothing is done twice, and the outcome is the same however it came about."""

from __future__ import annotations

import gc
import json
import os
import random
import re
import signal
import subprocess
import sys
import threading
import time
import tracemalloc
from collections.abc import Generator, Iterator, Sequence
from importlib.resources import files
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from conftest import REPOSITORY, check, make_request
from referencing import Registry, Resource

from urdfcheck.cli import FAILED, FINDINGS, NOTHING, OK, main
from urdfcheck.core import Finding, Severity
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.dataset.audit import AuditOutcome, audit_dataset
from urdfcheck.output.shared.audit import unit_lines
from urdfcheck.policy.limits import ResourceLimits
from urdfcheck.rules import load_check, load_rules
from urdfcheck.run import pipeline
from urdfcheck.run.jobs import AuditSettings, Unit, UnitReport
from urdfcheck.run.unit_audit import audit_unit
from urdfcheck.system import sandbox
from urdfcheck.system.process_pool import Worker

pytestmark = [pytest.mark.slow, pytest.mark.long]

INERTIA = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="{}"/></inertial>'
XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'

posix = pytest.mark.skipif(sys.platform == "win32", reason="signals and forks are those of POSIX")


@pytest.fixture(autouse=True)
def _no_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")


def robots(folder: Path, count: int) -> Path:
    """Small robots; every third has an inertia that no body has."""
    folder.mkdir(parents=True, exist_ok=True)
    for i in range(count):
        inertia = INERTIA.format(9 if i % 3 == 0 else 1)
        (folder / f"{i:03}.urdf").write_text(f'<robot name="r{i}"><link name="base">{inertia}</link></robot>')
    return folder


class Audit:
    """Audits a folder in this process, and remembers which units were asked for."""

    def __init__(self, models: Path, folder: Path, **request: Any) -> None:
        self.models = models
        self.folder = folder
        self.request = request
        self.stop_after: int | None = None

    def __call__(self, *, restart: bool = False, **request: Any) -> list[str]:
        asked: list[str] = []

        def stream(units: Sequence[Unit], settings: AuditSettings) -> Generator[tuple[int, UnitReport], None, None]:
            for place, unit in enumerate(units):
                if len(asked) == self.stop_after:
                    raise KeyboardInterrupt
                asked.append(Path(unit.path).name)
                yield place, audit_unit(unit, settings)

        wanted = {"tier": "source", **self.request, **request}
        work = make_request(self.models, **wanted)
        self.outcome = audit_dataset(work, self.folder, stream, restart=restart)
        return asked

    @property
    def lines(self) -> list[Any]:
        return [json.loads(line) for line in (self.folder / "audit.jsonl").read_text().splitlines()]

    @property
    def bytes(self) -> tuple[bytes, bytes]:
        return (self.folder / "audit.jsonl").read_bytes(), (self.folder / "index.html").read_bytes()


@pytest.fixture
def audit(tmp_path: Path) -> Audit:
    return Audit(robots(tmp_path / "models", 6), tmp_path / "out")


# -- what is written ---------------------------------------------------------------------------------------------------


def mixed(folder: Path) -> Path:
    """Something of every kind: a sound robot, a broken file, a xacro that makes no robot, a launch file, a package."""
    (folder / "launch").mkdir(parents=True)
    (folder / "package.xml").write_text("<package format='3'><name>mixed</name><version>1</version></package>")
    (folder / "launch" / "show.launch").write_text("<launch><node pkg='nowhere' type='x' name='x'/></launch>")
    (folder / "broken.urdf").write_text("<robot name='r'><link")
    (folder / "empty.xacro").write_text(f"<robot {XACRO}><xacro:if value='false'><link name='a'/></xacro:if></robot>")
    (folder / "robot.urdf").write_text(f"<robot name='r'><link name='a'>{INERTIA.format(9)}</link></robot>")
    return folder


def test_every_line_keeps_to_the_schema(tmp_path: Path) -> None:
    output = files("urdfcheck.output")
    report, schema = (json.loads((output / f"{n}.schema.json").read_text()) for n in ("report", "audit"))
    registry = Registry().with_resource("report.schema.json", Resource.from_contents(report))
    validator = jsonschema.Draft202012Validator(schema, registry=registry)
    audit = Audit(mixed(tmp_path / "mixed"), tmp_path / "out")
    audit()
    for line in audit.lines:
        validator.validate(line)
    kinds = {line["unit"]["kind"] for line in audit.lines}
    assert kinds == {"model", "launch", "package", "run"}
    with pytest.raises(jsonschema.ValidationError):
        validator.validate({**audit.lines[0], "findings": [{"code": "INR003"}]})


def test_the_lines_hold_what_a_report_of_all_together_holds(tmp_path: Path) -> None:
    from urdfcheck.output.json import render

    audit = Audit(mixed(tmp_path / "mixed"), tmp_path / "out")
    audit()
    report = json.loads(render(pipeline.strip_volatile_values(check(audit.models, tier="source"))))
    alone = {code for code, rule in load_rules().items() if rule.scopes == ("run",)}
    found = [finding for line in audit.lines for finding in line["findings"]]
    assert sorted(map(json.dumps, found)) == sorted(json.dumps(f) for f in report["findings"] if f["code"] not in alone)
    assert [line["model"] for line in audit.lines if line["model"]] == report["models"]
    assert "XAC015" in {skip["code"] for skip in audit.lines[-1]["skipped"]}


def test_garbage_is_collected_while_many_models_are_read(tmp_path: Path) -> None:
    """The command has it collected rarely, which at its start saves time."""
    before = gc.get_threshold()
    gc.set_threshold(200_000, 30, 30)
    try:
        assert (
            main(["audit", str(robots(tmp_path / "robots", 1)), "-o", str(tmp_path / "out"), "--tier", "source"])
            != FAILED
        )
        assert gc.get_threshold() == (10_000, 10, 10)
    finally:
        gc.set_threshold(*before)


def test_names_of_strangers_are_data_in_every_file(tmp_path: Path) -> None:
    models = tmp_path / "models"
    models.mkdir()
    name = "<script>alert(1)</script>\u202e\x1b[31m"
    text = f'<robot name="&lt;img src=x onerror=alert(1)&gt;"><link name="a">{INERTIA.format(9)}</link></robot>'
    (models / f"{name.replace('/', '_')}.urdf").write_text(text)
    audit = Audit(models, tmp_path / "out")
    audit()
    found, page = (data.decode() for data in audit.bytes)
    assert len(found.splitlines()) == 2
    for text in (found, page):
        assert not re.search("[\u202e\x1b]", text)
    assert page.count("<script>") == 1
    assert "<img" not in page


@posix
@pytest.mark.parametrize("jobs", [1, 2, 4])
def test_the_outcome_does_not_depend_on_the_number_of_jobs(audit: Audit, tmp_path: Path, jobs: int) -> None:
    audit()
    there = tmp_path / f"out{jobs}"
    request = make_request(audit.models, tier="source", jobs=jobs)
    audit_dataset(request, there, lambda units, settings: pipeline.stream_reports(units, settings, jobs=jobs))
    assert ((there / "audit.jsonl").read_bytes(), (there / "index.html").read_bytes()) == audit.bytes


# -- going on ----------------------------------------------------------------------------------------------------------


@pytest.mark.smoke
def test_a_second_run_does_nothing_and_writes_the_same(audit: Audit) -> None:
    assert len(audit()) == 6
    before = audit.bytes
    assert audit() == []
    assert (audit.outcome.checked, audit.outcome.unchanged) == (0, 6)
    assert audit.bytes == before


def test_after_an_interrupt_the_next_run_does_the_rest(audit: Audit, tmp_path: Path) -> None:
    undisturbed = Audit(audit.models, tmp_path / "undisturbed")
    undisturbed()
    audit.stop_after = 2
    with pytest.raises(
        UrdfcheckError, match=r"results of 2 of 6 .* kept in .*; run the same command again to continue"
    ):
        audit()
    with pytest.raises(UrdfcheckError, match="4 of 6"):
        audit()
    audit.stop_after = None
    assert audit() == ["004.urdf", "005.urdf"]
    assert audit.bytes == undisturbed.bytes


@pytest.mark.smoke
def test_what_changed_is_checked_again(audit: Audit) -> None:
    audit()
    (audit.models / "002.urdf").write_text(f'<robot name="r"><link name="base">{INERTIA.format(9)}</link></robot>')
    (audit.models / "004.urdf").unlink()
    (audit.models / "007.urdf").write_text('<robot name="new"><link name="base"/></robot>')
    assert audit() == ["002.urdf", "007.urdf"]
    assert [line["unit"]["id"] for line in audit.lines] == [*(f"{n:03}.urdf" for n in (0, 1, 2, 3, 5, 7)), ""]
    assert "INR003" in {finding["code"] for finding in audit.lines[2]["findings"]}
    assert audit() == []


def box() -> bytes:
    trimesh = pytest.importorskip("trimesh")
    return bytes(trimesh.creation.box((0.1, 0.1, 0.4)).export(file_type="stl"))


@pytest.mark.parametrize("changed", ["parts.xacro", "size.yaml", "box.stl", "missing.stl"])
def test_a_model_rests_on_all_its_files(tmp_path: Path, changed: str) -> None:
    """Included, loaded and named files count, also one that was missing and a mesh whose measurements are cached."""
    models = tmp_path / "models"
    models.mkdir()
    (models / "box.stl").write_bytes(box())
    (models / "size.yaml").write_text("radius: 0.1")
    (models / "parts.xacro").write_text(f"<robot {XACRO}><xacro:macro name='part' params=''/></robot>")
    mesh = "".join(
        f"<visual><geometry><mesh filename='{name}.stl'/></geometry></visual>" for name in ("box", "missing")
    )
    (models / "robot.urdf.xacro").write_text(
        f"<robot name='r' {XACRO}><xacro:include filename='parts.xacro'/><xacro:part/>"
        "<xacro:property name='y' value=\"${xacro.load_yaml('size.yaml')}\"/><link name='a'>"
        f"<visual><geometry><sphere radius=\"${{y['radius']}}\"/></geometry></visual>{mesh}</link></robot>"
    )
    (models / "other.urdf").write_text("<robot name='o'><link name='base'/></robot>")
    audit = Audit(models, tmp_path / "out", tier="mesh", codes=["MSH001", "PKG002"], cache=tmp_path / "cache")
    assert sorted(audit()) == ["other.urdf", "robot.urdf.xacro"]
    audit(restart=True)  # with what is cached
    assert audit() == []
    with open(models / changed, "ab") as file:
        file.write(b" ")
    assert audit() == ["robot.urdf.xacro"]


def test_a_package_that_came_is_noticed(tmp_path: Path) -> None:
    models = tmp_path / "models"
    models.mkdir()
    (models / "robot.urdf").write_text(
        "<robot name='r'><link name='a'><visual><geometry><mesh filename='package://parts/box.stl'/></geometry></visual>"
        "</link></robot>"
    )
    audit = Audit(models, tmp_path / "out")
    audit()
    (models / "other.txt").write_text("")  # nothing that it asks for
    assert audit() == []
    (models / "parts").mkdir()
    assert audit() == ["robot.urdf"]


def test_of_many_packages_a_model_rests_on_its_own(tmp_path: Path) -> None:
    models = tmp_path / "models"
    for name in ("one", "two"):
        (models / name).mkdir(parents=True)
        (models / name / "package.xml").write_text(f"<package><name>{name}</name></package>")
        shape = f"<geometry><mesh filename='package://{name}/box.stl'/></geometry>"
        (models / name / f"{name}.urdf").write_text(
            f"<robot name='r'><link name='a'><visual>{shape}</visual></link></robot>"
        )
    audit = Audit(models, tmp_path / "out")
    assert sorted(audit()) == ["one", "one.urdf", "two", "two.urdf"]
    (models / "two" / "package.xml").write_text("<package format='3'><name>two</name></package>")
    assert sorted(audit()) == ["two", "two.urdf"]


def test_a_torn_entry_is_done_again_and_no_other(audit: Audit) -> None:
    audit()
    expected, journal = audit.bytes, audit.folder / "journal"
    whole = journal.read_bytes()
    last = whole[: whole.rindex(b'\n{"key"') + 1]
    for cut in (1, 2, 200, len(whole) - len(last) - 1):
        journal.write_bytes(whole[:-cut])
        assert audit() == ["005.urdf"]
        assert audit.bytes == expected
    journal.write_bytes(last + bytes(len(whole) - len(last)))  # blocks that a power cut left empty
    assert audit() == ["005.urdf"]
    journal.write_bytes(whole.replace(b'"robot": "r5"', b'"robot": "rX"'))
    assert audit() == ["005.urdf"]
    assert audit.bytes == expected


def test_a_torn_first_line_begins_anew(audit: Audit) -> None:
    audit()
    journal = audit.folder / "journal"
    journal.write_bytes(journal.read_bytes()[:30])
    assert len(audit()) == 6


def test_a_journal_that_came_with_the_dataset_is_not_believed(audit: Audit) -> None:
    """It could say that all is well."""
    audit()
    (audit.models / "000.urdf").unlink()
    audit()  # the journal is written anew
    assert audit() == []
    journal = audit.folder / "journal"
    copy = journal.with_name("copy")
    copy.write_bytes(journal.read_bytes())
    copy.replace(journal)
    with pytest.raises(UrdfcheckError, match="was not written there but copied: --restart"):
        audit()
    assert len(audit(restart=True)) == 5


@pytest.mark.parametrize(
    "more",
    ['"rules": ' + "[" * 100_000 + "\n", '"\x1b[31m": 1}\n', '"rules": 1}\n'],
    ids=["nested", "unknown", "other"],
)
def test_a_first_line_of_a_stranger_is_data(audit: Audit, more: str) -> None:
    audit.folder.mkdir()
    (audit.folder / "journal").write_text('{"urdfcheck audit": 1, ' + more)
    with pytest.raises(UrdfcheckError, match=r"found under other settings \((of another kind|.*rules.*)\)") as refused:
        audit()
    assert "\x1b" not in str(refused.value)


def test_a_first_line_without_an_end_is_not_read_whole(audit: Audit) -> None:
    """A file with a hole of a gigabyte is a few bytes of an archive."""
    audit.folder.mkdir()
    with (audit.folder / "journal").open("wb") as file:
        file.write(b'{"urdfcheck audit": 1, ')
        file.truncate(1024**3)
    tracemalloc.start()
    try:
        with pytest.raises(UrdfcheckError, match="found under other settings"):
            audit()
        assert tracemalloc.get_traced_memory()[1] < 128 * 1024**2
    finally:
        tracemalloc.stop()
    assert len(audit(restart=True)) == 6


def test_an_entry_that_rests_on_no_file_is_not_believed(audit: Audit) -> None:
    audit()
    journal = audit.folder / "journal"
    for nothing in (b"{}", b"[1]", b'{"x": 1}'):
        journal.write_bytes(re.sub(rb'"reads": \{.*?\}', b'"reads": ' + nothing, journal.read_bytes()))
        assert len(audit()) == 6


KILLED = """
import os, sys, time
from pathlib import Path
from urdfcheck.dataset.audit import audit_dataset
from urdfcheck.policy.policy import Policy
from urdfcheck.rules import load_rules
from urdfcheck.run.unit_audit import audit_unit
from urdfcheck.run.jobs import AuditSettings, Request, Unit

def stream(units, settings):
    for place, unit in enumerate(units):
        yield place, audit_unit(unit, settings)
        os.write(log, (unit.id + "\\n").encode())  # it is kept now
        time.sleep(0.01)

policy = Policy(codes=frozenset(load_rules()), tier="source")
models, folder, log = Path(sys.argv[1]), Path(sys.argv[2]), os.open(sys.argv[3], os.O_WRONLY | os.O_APPEND | os.O_CREAT)
audit_unit(Unit(kind="model", path=str(next(models.iterdir())), id=""), AuditSettings(policy=policy))
print("ready", flush=True)
audit_dataset(Request(paths=(models,), root=models, policy=policy), folder, stream)
"""


@posix
def test_killed_again_and_again_it_ends_with_the_same_and_does_nothing_twice(tmp_path: Path) -> None:
    audit = Audit(robots(tmp_path / "models", 40), tmp_path / "undisturbed")
    audit()
    log, folder = tmp_path / "log", tmp_path / "out"
    chance = random.Random(7)
    for until_killed in (*(chance.uniform(0.05, 0.4) for _ in range(4)), None):
        process = subprocess.Popen(
            [sys.executable, "-c", KILLED, str(audit.models), str(folder), str(log)], stdout=subprocess.PIPE
        )
        assert process.stdout is not None
        process.stdout.readline()
        if until_killed is not None:
            time.sleep(until_killed)
            process.kill()
        process.communicate()
    assert process.returncode == 0
    done = log.read_text().split()
    assert len(done) == len(set(done))
    audit.folder, before = folder, audit.bytes
    assert audit.bytes == before


@posix
def test_a_folder_has_one_audit_at_a_time(audit: Audit) -> None:
    """Also while workers live that were started by a killed one."""
    second = [
        sys.executable,
        "-m",
        "urdfcheck",
        "audit",
        str(audit.models),
        "-o",
        str(audit.folder),
        "--tier",
        "source",
    ]
    said: list[str] = []
    workers = []

    def stream(units: Sequence[Unit], settings: AuditSettings) -> Generator[tuple[int, UnitReport], None, None]:
        workers.append(Worker.start())
        done = subprocess.run(second, capture_output=True, text=True, cwd=REPOSITORY)
        said.append(done.stderr)
        for place, unit in enumerate(units):
            yield place, audit_unit(unit, settings)

    request = make_request(audit.models, tier="source")
    audit_dataset(request, audit.folder, stream)
    assert said == [f"urdfcheck: another audit is running in {audit.folder}\n"]
    done = subprocess.run([*second, "--restart"], capture_output=True, text=True, cwd=REPOSITORY)
    assert (done.returncode, done.stderr) == (FINDINGS, "")
    workers[0].end()


# -- the folder --------------------------------------------------------------------------------------------------------


def test_other_settings_are_refused_by_name_and_restart_takes_them(audit: Audit) -> None:
    audit()
    with pytest.raises(UrdfcheckError, match=r"under other settings \(--tier\): --restart forgets it"):
        audit(tier="mesh")
    with pytest.raises(UrdfcheckError, match=r"\(--target, rules\)"):
        audit(targets=("mujoco",), codes=["INR003"])
    assert audit() == []
    assert len(audit(targets=("mujoco",), restart=True)) == 6
    assert audit(targets=("mujoco",), jobs=7) == []


def test_the_environment_that_a_model_may_read_is_a_setting(audit: Audit, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROBOT", "secret-1")
    audit(environment=("ROBOT",))
    assert b"secret-1" not in (audit.folder / "journal").read_bytes()
    assert audit(environment=("ROBOT",)) == []
    monkeypatch.setenv("ROBOT", "secret-2")
    with pytest.raises(UrdfcheckError, match=r"\(environment\)"):
        audit(environment=("ROBOT",))


@pytest.mark.parametrize("name", ["notes.txt", "journal"])
def test_a_folder_of_something_else_is_refused_and_left_alone(audit: Audit, name: str) -> None:
    audit.folder.mkdir()
    (audit.folder / name).write_text("mine")
    for restart in (False, True):
        with pytest.raises(UrdfcheckError, match=r"name (an empty or new|another) folder"):
            audit(restart=restart)
    assert {path.name: path.read_text() for path in audit.folder.iterdir()} == {name: "mine"}


def test_a_file_of_somebody_else_in_our_folder_stays(audit: Audit) -> None:
    audit()
    (audit.folder / "notes.txt").write_text("mine")
    audit(restart=True)
    assert (audit.folder / "notes.txt").read_text() == "mine"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes here")
def test_a_pipe_in_the_place_of_the_journal_is_not_waited_for(audit: Audit) -> None:
    audit.folder.mkdir()
    os.mkfifo(audit.folder / "journal")
    writer = os.open(audit.folder / "journal", os.O_RDWR | os.O_NONBLOCK)
    # Whoever waits gets something that is no journal after a while, so that the test ends.
    timer = threading.Timer(5.0, lambda: os.write(writer, b"waited\n"))
    timer.start()
    try:
        with pytest.raises(UrdfcheckError, match="not the journal of an audit"):
            audit()
        assert timer.is_alive()
    finally:
        timer.cancel()
        os.close(writer)


def test_links_in_a_folder_of_a_stranger_lead_nowhere(audit: Audit, tmp_path: Path) -> None:
    audit.folder.mkdir()
    target = tmp_path / "target"
    target.write_text("")
    try:
        (audit.folder / "journal").symlink_to(target)
    except OSError:
        pytest.skip("no symbolic links here")
    with pytest.raises(UrdfcheckError, match="cannot write"):
        audit()
    (audit.folder / "journal").unlink()
    names = ("audit.jsonl", "index.html", "journal")
    for name in names:
        (audit.folder / f".urdfcheck-{name}").symlink_to(target)
    audit()
    (audit.models / "001.urdf").unlink()
    audit()  # the journal is written anew
    assert target.read_text() == ""
    assert sorted(path.name for path in audit.folder.iterdir()) == sorted(names)


@pytest.mark.skipif(sys.platform != "linux" or os.geteuid() != 0, reason="only root makes a small disk")
def test_a_full_disk_is_said_and_what_was_finished_is_kept(audit: Audit) -> None:
    robots(audit.models, 30)
    audit.folder.mkdir()
    mounted = ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", str(audit.folder)]
    if subprocess.run(mounted, capture_output=True).returncode:
        pytest.skip("no disk can be mounted here")
    try:
        with pytest.raises(UrdfcheckError, match=r"cannot write .*: No space left on device"):
            audit()
        assert sorted(path.name for path in audit.folder.iterdir()) == ["journal"]
        subprocess.run(["mount", "-o", "remount,size=4m", str(audit.folder)], check=True)
        assert 0 < len(audit()) < 30
        assert len(audit.lines) == 31
    finally:
        subprocess.run(["umount", str(audit.folder)], check=True)


# -- what goes wrong ---------------------------------------------------------------------------------------------------


@posix
def test_a_model_that_takes_too_long_is_stopped_and_the_others_go_on(
    audit: Audit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = load_check

    workers = tmp_path / "workers"

    def slow(subject: Any, rule: Any, **options: Any) -> Iterator[Finding]:
        with workers.open("a") as file:
            print(subject.name, os.getpid(), file=file)
        while subject.name == "r1":
            time.sleep(0.01)
        yield from real(rule)(subject, rule, **options)

    monkeypatch.setattr(sandbox, "confine", lambda *_: None)  # or the slow check could not write
    monkeypatch.setattr(
        "urdfcheck.run.unit_audit.load_check", lambda rule: slow if rule.code == "INR003" else real(rule)
    )
    limits = ResourceLimits(seconds=2.0)
    request = make_request(audit.models, tier="source", limits=limits)

    def outcome() -> AuditOutcome:
        return audit_dataset(
            request, audit.folder, lambda units, settings: pipeline.stream_reports(units, settings, jobs=1)
        )

    assert outcome().summary.statuses == {"checked": 5, "stopped": 1}
    assert [f["code"] for f in audit.lines[1]["findings"]][-1:] == ["URC906"]
    used = [line.split() for line in workers.read_text().splitlines()]
    stopped = dict(used)["r1"]  # in the middle of something that is half done now
    assert [name for name, worker in used if worker == stopped][-1] == "r1"
    assert len({worker for _, worker in used}) == 2
    assert outcome().checked == 0  # it would take as long again


AUDIT = pipeline._audit_in_worker


def die_on_3(unit: Unit, settings: AuditSettings) -> UnitReport:
    if unit.path.endswith("003.urdf"):
        os.kill(os.getpid(), signal.SIGKILL)
    return AUDIT(unit, settings)


@posix
def test_a_worker_that_dies_is_a_failure_and_its_model_tried_again(
    audit: Audit, monkeypatch: pytest.MonkeyPatch
) -> None:
    request = make_request(audit.models, tier="source")
    with monkeypatch.context() as patch:
        patch.setattr(pipeline, "_audit_in_worker", die_on_3)
        found = audit_dataset(
            request, audit.folder, lambda units, settings: pipeline.stream_reports(units, settings, jobs=2)
        ).summary
    assert found.failure_count == 1
    assert "003.urdf" in found.failures[0]
    assert audit() == ["003.urdf"]
    assert audit.outcome.summary.failure_count == 0


# -- the command -------------------------------------------------------------------------------------------------------


def test_the_command_counts_and_says_what_it_did(
    audit: Audit, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(audit.models.parent)
    command = ["audit", "models", "--tier", "source", "--select", "INR003,XML001"]
    assert main([*command, "--fail-on", "warning"]) == FINDINGS
    said = capsys.readouterr()
    assert said.err == ""
    assert re.search(r"^INR003  triangle-inequality  error +2 +2$", said.out, re.MULTILINE)
    assert re.search(r"^models/000.urdf +1 +0  INR003$", said.out, re.MULTILINE)
    assert (
        "2 errors, 0 warnings, 0 info in 6 models; errors in 2 models\n6 checked; urdfcheck-audit/audit.jsonl"
        in said.out
    )
    (audit.models / "001.urdf").write_text("<robot name='r'><link")
    assert main([*command, "--fail-on", "never"]) == OK
    said = capsys.readouterr()
    assert "⊘ not checked (failed): models/001.urdf\n" in said.out
    assert "⊘ 1 of 6 models not checked; 3 errors, " in said.out
    assert "in 6 models; errors in 3 models\n5 unchanged, 1 checked; " in said.out


def test_nothing_to_check_and_a_wrong_path_make_no_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "models").mkdir()
    command = ["audit", str(tmp_path / "models"), "-o", str(tmp_path / "out")]
    assert main(command) == NOTHING
    assert main([*command, "--allow-empty"]) == OK
    assert main(["audit", str(tmp_path / "wrong"), *command[2:]]) == FAILED
    assert "does not exist" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_wrong_path_beside_a_right_one_is_a_failure(audit: Audit, capsys: pytest.CaptureFixture[str]) -> None:
    where = ["-o", str(audit.folder), "--tier", "source", "--fail-on", "never"]
    assert main(["audit", str(audit.models), str(audit.models / "wrong.urdf"), *where]) == FAILED
    assert "wrong.urdf: does not exist" in capsys.readouterr().out


@pytest.mark.parametrize("backend", ["dask", "local=here", "slurm=x", "dask="])
def test_a_backend_that_is_none_is_refused(backend: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["audit", ".", "--backend", backend]) == FAILED
    assert "write local, dask=ADDRESS, ray or ray=ADDRESS" in capsys.readouterr().err


@posix
def test_an_interrupt_says_how_to_go_on(tmp_path: Path) -> None:
    """And leaves no process."""
    models = robots(tmp_path / "models", 150)
    process = subprocess.Popen(
        [sys.executable, "-m", "urdfcheck", "audit", str(models), "-o", str(tmp_path / "out"), "--jobs", "2"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=REPOSITORY,
        start_new_session=True,
    )
    journal = tmp_path / "out" / "journal"
    while process.poll() is None and not (journal.exists() and journal.read_bytes().count(b'\n{"key"') > 3):
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGINT)
    out, said = process.communicate(timeout=20)
    assert process.returncode == FAILED
    assert re.fullmatch(
        r"urdfcheck: interrupted: results of \d+ of 150 models and files are kept in .*; run the same command again "
        "to continue\n",
        said,
    )
    assert out == ""
    for _ in range(50):
        try:
            os.killpg(process.pid, 0)
        except ProcessLookupError:
            return
        time.sleep(0.1)
    pytest.fail("a process is left")


# -- the summary -------------------------------------------------------------------------------------------------------


def test_a_summary_holds_no_more_rows_than_it_shows() -> None:
    def row(number: int) -> unit_lines.UnitRow:
        codes = (("INR003", Severity.ERROR, number % 7), ("KIN008", Severity.INFO, 1))
        counts = (number % 7, 0, 1)
        return unit_lines.UnitRow(
            kind="model",
            id=f"{number}",
            path="",
            status="failed",
            links=1,
            counts=counts,
            codes=codes,
            failures=("it broke",),
        )

    summary = unit_lines.AuditSummary.from_rows(map(row, range(1000)))
    assert len(summary.worst) == len(summary.failures) == len(summary.unchecked) == unit_lines.MOST_NAMED
    assert {worst.counts[0] for worst in summary.worst} == {6}
    assert (summary.unit_count, summary.failure_count, summary.statuses["failed"]) == (1000, 1000, 1000)
    assert summary.counts[Severity.ERROR] == sum(n % 7 for n in range(1000))
    assert summary.rank_rules()[0][0] == "INR003"


def test_what_is_known_is_known_to_an_audit_and_one_of_its_settings(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    text = '<robot name="r"><link name="a"><inertial><mass value="-1"/></inertial></link></robot>'
    (tmp_path / "r.urdf").write_text(text)
    (tmp_path / "urdfcheck.toml").write_text("")
    monkeypatch.chdir(tmp_path)
    words = ["audit", "r.urdf", "-o", str(tmp_path / "out"), "--tier", "source", "--jobs", "1"]
    assert main(words) == FINDINGS
    assert main(["baseline", "write", "r.urdf", "--tier", "source"]) == OK
    capsys.readouterr()
    assert main(words) == OK
    assert re.search(
        r"^0 errors, 0 warnings, 0 info in 1 model; not shown: \d in the baseline$", capsys.readouterr().out, re.M
    )
    (tmp_path / "urdfcheck.toml").write_text('[[suppress]]\ncodes = ["INR"]\nreason = "a dummy"\n')
    capsys.readouterr()
    assert main(words) == FAILED
    assert "other settings (suppress)" in capsys.readouterr().err


def test_macro_files_and_parts_are_told_as_a_check_tells_them(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A part that may be a robot is a model that was not checked; what a model takes of a part is no model."""
    from urdfcheck.output.json import render

    folder = tmp_path / "cars"
    folder.mkdir()
    never = '<xacro:if value="false"><xacro:include filename="decoy.xacro"/></xacro:if>'
    macro = '<xacro:macro name="m"><link name="x"/></xacro:macro>'
    to_part = '<joint name="j" type="fixed"><parent link="base"/><child link="part"/></joint>'
    files = {
        "car.urdf.xacro": f'<robot name="car" {XACRO}><link name="base"/>{never}<xacro:include filename="part.xacro"/>'
        f'{to_part}<xacro:include filename="used.xacro"/></robot>',
        "decoy.xacro": f'<robot {XACRO}><link name="decoy"/></robot>',
        "part.xacro": f'<robot {XACRO}><link name="part"/></robot>',
        "used.xacro": f"<robot {XACRO}>{macro}</robot>",
        "unused.xacro": f"<robot {XACRO}>{macro}</robot>",
    }
    for name, text in files.items():
        (folder / name).write_text(text)
    audit = Audit(folder, tmp_path / "out")
    for _ in range(2):  # the second time all of it is known
        audit()
        report = json.loads(render(pipeline.strip_volatile_values(check(folder, tier="source"))))
        lines = [line["model"] for line in audit.lines if line["model"]]
        assert [(m["path"], m["status"]) for m in lines] == [(m["path"], m["status"]) for m in report["models"]]
        assert [m["status"] for m in lines] == ["checked", "failed"]
        assert audit.lines[-1]["unused_macro_files"] == report["unused_macro_files"]
        assert audit.outcome.summary.worst_severity is not None
    assert "unused.xacro" in audit.bytes[1].decode()
    assert main(["audit", str(folder), "-o", str(tmp_path / "more"), "--tier", "source"]) == FINDINGS
    assert "⊘ 1 of 2 models and 1 macro file not checked; " in capsys.readouterr().out
