"""Green means checked: what could not be read, expanded or finished fails the run with its cause, however it was found."""

from __future__ import annotations

import errno
import json
import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import check, command, make_request

import urdfcheck
from urdfcheck.cli import FAILED, FINDINGS, NOTHING, OK, compute_exit_code, main
from urdfcheck.core import Finding, Run, Severity
from urdfcheck.output import text
from urdfcheck.policy.config_resolver import ConfigResolver
from urdfcheck.policy.limits import ResourceLimits
from urdfcheck.run import pipeline
from urdfcheck.run.jobs import AuditSettings, Unit, UnitReport
from urdfcheck.source.xacro import expansion_state

pytestmark = pytest.mark.slow

XACRO = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{}<link name="base"/></robot>'
NEEDY = XACRO.format('<link name="$(arg side)_hand"/>')
SOUND = '<robot name="r"><link name="base"/></robot>'
DECLARED = '<package format="3"><name>arm</name><depend>hand_description</depend></package>'
# Kinds of models that cannot be checked, by the code of the cause: the files of a package, of which robot.* is the model.
CASES = {
    "XAC010": {"robot.urdf.xacro": NEEDY},
    "XAC001": {"robot.urdf.xacro": XACRO.format('<xacro:property name="a" value="${b}"/><link name="${a}"/>')},
    "PKG001": {
        "robot.urdf.xacro": XACRO.format('<xacro:include filename="$(find hand_description)/hand.xacro"/>'),
        "package.xml": DECLARED,
    },
    "XML001": {"robot.urdf": SOUND.replace("</robot>", "</robt>")},
    "XML002": {"robot.urdf": '<sdf version="1.9"><model name="r"><link name="base"/></model></sdf>'},
    "XAC011": {"robot.urdf.xacro": XACRO.format("<link name=\"${open('/etc/hostname')}\"/>")},
    "XAC013": {"robot.urdf.xacro": XACRO.format('<xacro:include filename="robot.urdf.xacro"/>')},
}
# An error says that the file is wrong. A package that package.xml declares is missing only here.
SEVERITIES = {code: Severity.INFO if code == "PKG001" else Severity.ERROR for code in CASES}


def write(folder: Path, files: dict[str, str]) -> Path:
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content, encoding="utf-8")
    return folder


def find_causes(outcome: Run) -> list[Finding]:
    return [finding for finding in outcome.active_findings if finding.blocks_check]


# -- the cause ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("code", CASES)
@pytest.mark.parametrize("is_named", [True, False], ids=["named", "found"])
def test_a_model_without_a_robot_fails_the_run_with_its_cause_however_it_was_found(
    code: str, is_named: bool, tmp_path: Path
) -> None:
    write(tmp_path, CASES[code])
    (model,) = tmp_path.glob("robot.*")
    outcome = check(model if is_named else tmp_path)
    assert [(f.code, f.severity) for f in find_causes(outcome)] == [(code, SEVERITIES[code])]
    (info,) = outcome.unchecked_models
    assert info.not_checked is not None
    assert info.not_checked.reason == find_causes(outcome)[0].message
    assert compute_exit_code(outcome, "error") == FINDINGS


@pytest.mark.parametrize("code", CASES)
@pytest.mark.parametrize("settings", [{"codes": {"INR003"}}, {"tier": "source"}, {"severities": {}}])
def test_no_setting_of_the_rules_makes_it_green(code: str, settings: dict[str, object], tmp_path: Path) -> None:
    if "severities" in settings:
        settings = {"severities": {code: "info"}}
    outcome = check(write(tmp_path, CASES[code]), **settings)  # type: ignore[arg-type]
    assert [(f.code, f.severity) for f in find_causes(outcome)] == [(code, SEVERITIES[code])]
    assert compute_exit_code(outcome, "error") == FINDINGS


@pytest.mark.parametrize("code", CASES)
def test_what_is_accepted_is_a_warning(code: str, tmp_path: Path) -> None:
    outcome = check(write(tmp_path, CASES[code]), unchecked=Severity.WARNING)
    assert [(f.code, f.severity) for f in find_causes(outcome)] == [(code, min(SEVERITIES[code], Severity.WARNING))]
    assert compute_exit_code(outcome, "error") == OK
    assert compute_exit_code(outcome, "warning") == FINDINGS
    assert "(accepted)" in text.render(outcome).splitlines()[-1]


def test_rules_that_are_not_selected_say_only_why_there_is_no_model(tmp_path: Path) -> None:
    """XAC006 is an info about the same file: nobody asked for it."""
    old = NEEDY.replace("www.ros.org/wiki/xacro", "ros.org/wiki/xacro")
    write(tmp_path, {"robot.urdf.xacro": old})
    assert {f.code for f in check(tmp_path).findings} == {"XAC006", "XAC010"}
    assert {f.code for f in check(tmp_path, codes={"INR003"}).findings} == {"XAC010"}
    write(tmp_path, {"robot.urdf.xacro": old.replace("$(arg side)_", "")})
    assert not check(tmp_path, codes={"INR003"}).findings


def test_a_comment_neither_hides_the_cause_nor_is_reported_as_needless(tmp_path: Path) -> None:
    marked = NEEDY.replace("<link name=", "<!-- urdfcheck: ignore[XAC010] we know --><link name=", 1)
    outcome = check(write(tmp_path, {"robot.urdf.xacro": marked}))
    assert [f.code for f in outcome.active_findings] == ["XAC010"]


def test_what_stands_in_place_of_the_cause_is_the_cause(tmp_path: Path) -> None:
    """XAC007 hides XAC010: the argument is declared, without the prefix."""
    outcome = check(
        write(tmp_path, {"robot.urdf.xacro": NEEDY.replace("<link", '<arg name="side" default="l"/><link', 1)}),
        severities={"XAC007": "info"},
    )
    assert [(f.code, f.severity) for f in find_causes(outcome)] == [("XAC007", Severity.ERROR)]


def test_the_remedy_is_a_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write(tmp_path, CASES["XAC010"])
    write(tmp_path / "arm", CASES["PKG001"])
    shown = text.render(check(Path(".")))
    assert "\n  urdfcheck robot.urdf.xacro --arg side:=…\n" in shown
    assert "\n  urdfcheck arm/robot.urdf.xacro --package hand_description=FOLDER\n" in shown
    write(tmp_path, {"hand/hand.xacro": XACRO.format("")})
    helped = check(Path("arm/robot.urdf.xacro"), packages={"hand_description": tmp_path / "hand"})
    assert not helped.unchecked_models
    assert not check(Path("robot.urdf.xacro"), arguments={"side": "left"}).unchecked_models


@pytest.mark.usefixtures("one_process")
def test_the_command_repeats_the_options_without_which_another_cause_comes_first(tmp_path: Path) -> None:
    body = '<xacro:include filename="$(find hand)/hand.xacro"/><xacro:include filename="$(find tool)/tool.xacro"/>'
    write(tmp_path / "arm", {"arm.urdf.xacro": XACRO.format(body)})
    write(tmp_path / "my hand", {"hand.xacro": XACRO.format('<link name="$(arg side)"/>')})
    shown = command("arm.urdf.xacro", "--package", "hand=../my hand", "--arg", "side:=l", cwd=tmp_path / "arm").stdout
    helps = "urdfcheck arm.urdf.xacro --arg side:=l --package 'hand=../my hand' --package tool=FOLDER"
    assert f"\n  {helps}\n" in shown
    write(tmp_path / "tool", {"tool.xacro": XACRO.format("")})
    words = shlex.split(helps.replace("FOLDER", "../tool"))[1:]
    assert "not checked" not in command(*words, cwd=tmp_path / "arm").stdout


@pytest.mark.parametrize(
    ("body", "remedy"),
    [
        ('<link name="$(env ARM_SIDE)"/>', "--env ARM_SIDE"),
        (
            '<xacro:property name="p" value="${xacro.load_yaml(\'/etc/hostname\')}"/><link name="${p}"/>',
            "--allow-read DIR",
        ),
        ("<link name=\"${xacro.load_yaml('none.yaml')}\"/>", ""),
    ],
)
@pytest.mark.usefixtures("one_process")
def test_each_cause_names_the_option_that_helps(body: str, remedy: str, tmp_path: Path) -> None:
    (info,) = pipeline.run(make_request(write(tmp_path, {"robot.urdf.xacro": XACRO.format(body)}))).unchecked_models
    assert info.not_checked is not None
    assert info.not_checked.remedy == remedy


# -- stopped, killed, crashed ------------------------------------------------------------------------------------------

ENDLESS = XACRO.format(
    "".join(f'<xacro:macro name="m{i}"><xacro:m{i + 1}/><xacro:m{i + 1}/></xacro:macro>' for i in range(40))
    + '<xacro:macro name="m40"/><xacro:m0/>'
)


@pytest.mark.long
@pytest.mark.parametrize(("accepted", "code"), [(False, FINDINGS), (True, OK)])
def test_a_model_that_was_stopped_is_not_checked(
    accepted: bool, code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # However fast the machine is, time runs out before the model would be too large.
    monkeypatch.setattr(expansion_state, "MAX_NODES", sys.maxsize)
    write(tmp_path, {"robot.urdf.xacro": ENDLESS, "sound.urdf": SOUND})
    outcome = pipeline.run(
        make_request(
            tmp_path,
            codes={"INR003"},
            limits=ResourceLimits(seconds=2),
            unchecked=Severity.WARNING if accepted else Severity.ERROR,
        )
    )
    assert [f.code for f in find_causes(outcome)] == ["URC906"]
    (info,) = outcome.unchecked_models
    assert info.not_checked is not None
    assert (info.not_checked.remedy, info.not_checked.accepted) == ("--timeout SECONDS", accepted)
    assert compute_exit_code(outcome, "error") == code


def die(unit: Unit, settings: AuditSettings) -> UnitReport:
    os._exit(3)


def hang(unit: Unit, settings: AuditSettings) -> UnitReport:
    import time

    time.sleep(60)
    raise AssertionError


@pytest.mark.parametrize(("end", "code"), [(die, FAILED), (hang, FINDINGS)])
def test_a_worker_that_dies_or_is_killed_leaves_an_unchecked_model(
    end: Callable[[Unit, AuditSettings], UnitReport], code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path, {"sound.urdf": SOUND})
    monkeypatch.setattr(pipeline, "_audit_in_worker", end)
    monkeypatch.setattr("urdfcheck.run.pipeline.sandbox.PATIENCE", 0.5)
    outcome = pipeline.run(make_request(tmp_path, limits=ResourceLimits(seconds=0.5)))
    assert [info.not_checked is not None for info in outcome.unchecked_models] == [True]
    assert compute_exit_code(outcome, "error") == code


def test_a_model_of_which_no_rule_says_why_it_was_not_read_is_our_failure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("urdfcheck.run.unit_audit.load_check", lambda rule: lambda *_, **__: ())
    outcome = check(write(tmp_path, CASES["XAC010"]))
    assert outcome.failures == ("robot.urdf.xacro could not be read, and no rule says why",)
    assert compute_exit_code(outcome, "never") == FAILED


# -- what cannot be read -----------------------------------------------------------------------------------------------


def deny(monkeypatch: pytest.MonkeyPatch, *names: str) -> None:
    """Let the system refuse to read what has these names, as it does for anybody but root after chmod 000."""
    access, open_file, scan = os.access, os.open, os.scandir

    def is_denied(path: object) -> bool:
        return isinstance(path, (str, os.PathLike)) and os.path.basename(os.fspath(path)) in names

    def refuse(path: object) -> OSError:
        return PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))

    def guarded_open(path, *rest, **more):  # type: ignore[no-untyped-def]
        if is_denied(path):
            raise refuse(path)
        return open_file(path, *rest, **more)

    def guarded_scan(path="."):  # type: ignore[no-untyped-def]
        if is_denied(path):
            raise refuse(path)
        return scan(path)

    def guarded_access(path, mode, **more):  # type: ignore[no-untyped-def]
        return not (mode & os.R_OK and is_denied(path)) and access(path, mode, **more)

    monkeypatch.setattr(os, "access", guarded_access)
    monkeypatch.setattr(os, "open", guarded_open)
    monkeypatch.setattr(os, "scandir", guarded_scan)


@pytest.mark.parametrize("name", ["secret", "secret.urdf", "secret.urdf.xacro", "secret.launch", "secret.launch.py"])
def test_a_folder_or_file_that_cannot_be_read_is_a_failure(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path, {"sound.urdf": SOUND, f"{name}/robot.urdf" if name == "secret" else name: SOUND})
    monkeypatch.chdir(tmp_path)
    deny(monkeypatch, name)
    outcome = check(Path("."))
    assert outcome.failures == (f"{name}: cannot be read: Permission denied",)
    assert [info.id for info in outcome.models] == ["sound.urdf"], "the others are checked"
    assert compute_exit_code(outcome, "never") == FAILED
    assert f"\nnot checked: {name}: cannot be read: Permission denied\n" in text.render(outcome)


@pytest.mark.usefixtures("one_process")
def test_what_is_excluded_or_ignored_need_not_be_readable(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path, {"sound.urdf": SOUND, "third_party/secret/r.urdf": SOUND, "build/r.urdf": SOUND})
    write(tmp_path, {"urdfcheck.toml": 'exclude = ["third_party/**"]\n', "secret.txt": ""})
    deny(monkeypatch, "secret", "build", "secret.txt")
    done = command(".", "--select", "INR003", cwd=tmp_path)
    assert done.returncode == OK, done.stdout + done.stderr
    (tmp_path / "urdfcheck.toml").unlink()
    assert command(".", "--select", "INR003", cwd=tmp_path).returncode == FAILED


@pytest.mark.parametrize("name", ["secret.urdf", "secret.urdf.xacro", "secret.launch"])
def test_a_named_file_that_cannot_be_read_is_a_failure(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path, {name: SOUND})
    monkeypatch.chdir(tmp_path)
    deny(monkeypatch, name)
    outcome = check(Path(name))
    assert outcome.failures == (f"{name}: cannot be read: Permission denied",)
    assert compute_exit_code(outcome, "never") == FAILED


@pytest.mark.parametrize("named", [".", "secret", "shut/r.urdf", "secret.urdf"])
def test_what_the_system_really_refuses_is_a_failure(named: str, tmp_path: Path) -> None:
    """Without a mock: root gives up the right to read everything."""
    write(tmp_path, {"secret/r.urdf": SOUND, "shut/r.urdf": SOUND, "secret.urdf": SOUND, "sound.urdf": SOUND})
    unprivileged: list[str] = []
    if os.geteuid() == 0:
        rights = "-dac_override,-dac_read_search"
        if shutil.which("setpriv") is None:
            pytest.skip("root cannot give up its rights without setpriv")
        unprivileged = ["setpriv", f"--bounding-set={rights}", f"--inh-caps={rights}"]
    try:
        for name, mode in (("secret", 0), ("shut", 0o644), ("secret.urdf", 0)):
            (tmp_path / name).chmod(mode)
        words = [*unprivileged, sys.executable, "-I", "-m", "urdfcheck", named, "--select", "INR003"]
        done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True)
    finally:
        for name in ("secret", "shut", "secret.urdf"):
            (tmp_path / name).chmod(0o755)
    assert done.returncode == FAILED
    wanted = ["secret", "secret.urdf", "shut"] if named == "." else [named]
    told = [line.partition(": cannot be read: Permission denied")[0] for line in done.stdout.splitlines()]
    assert sorted(line.removeprefix("not checked: ") for line in told if line.startswith("not checked:")) == wanted
    assert f"\n⊘ not finished: {len(wanted)} failure" in done.stdout
    assert not done.stderr


def test_a_folder_that_lies_too_deep_to_be_read_hides_no_model(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A path of more than 4,096 characters: the system refuses it, whoever asks."""
    for level in range(25):
        (tmp_path if not level else Path(".")).joinpath("d" * 200).mkdir()
        monkeypatch.chdir(tmp_path / ("d" * 200) if not level else "d" * 200)
    Path("robot.urdf").write_text(SOUND)
    monkeypatch.chdir(tmp_path)
    outcome = check(tmp_path)
    assert len(outcome.failures) == 1
    assert "cannot be read: File name too long" in outcome.failures[0]
    assert compute_exit_code(outcome, "never") == FAILED


# -- macro files -------------------------------------------------------------------------------------------------------

MACRO = (
    '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:macro name="{}"><link name="{}"/></xacro:macro></robot>'
)


@pytest.mark.usefixtures("one_process")
def test_macro_files_that_no_checked_model_reads_are_counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    used = XACRO.format('<xacro:include filename="a.xacro"/><xacro:a/>')
    write(tmp_path, {"m.urdf.xacro": used, "a.xacro": MACRO.format("a", "a"), "b.xacro": MACRO.format("b", "b")})
    outcome = check(Path("."), codes={"INR003"})
    assert outcome.unused_macro_files == ("b.xacro",)
    assert compute_exit_code(outcome, "error") == OK, "nobody asked for them to be used"
    assert "✔" not in text.render(outcome)
    # The model that reads a.xacro cannot be checked any more: so nothing of a.xacro is.
    write(tmp_path, {"m.urdf.xacro": used.replace("<xacro:a/>", "<xacro:a/><xacro:c/>")})
    assert check(Path(".")).unused_macro_files == ("a.xacro", "b.xacro")
    write(tmp_path, {"urdfcheck.toml": 'exclude = ["b.xacro"]\n'})
    found = json.loads(command(".", "--format", "json", "--select", "INR003", cwd=tmp_path).stdout)
    assert found["unused_macro_files"] == ["a.xacro"]
    assert check(Path("m.urdf.xacro")).unused_macro_files == (), "only folders are searched for them"


def test_a_macro_file_that_the_semantic_description_of_a_checked_model_reads_is_checked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    srdf = '<robot name="{}" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:include filename="a.xacro"/></robot>'
    write(tmp_path, {"robot.urdf": SOUND, "robot.srdf.xacro": srdf.format("r"), "a.xacro": MACRO.format("a", "a")})
    assert check(Path("."), codes={"SRD001"}).unused_macro_files == ()
    write(tmp_path, {"robot.srdf.xacro": srdf.format("another")})
    assert check(Path("."), codes={"SRD001"}).unused_macro_files == ("a.xacro",)


# -- every command -----------------------------------------------------------------------------------------------------


@pytest.mark.usefixtures("one_process")
@pytest.mark.parametrize(
    "words",
    [
        ["."],
        [".", "--allow-empty"],
        [".", "--select", "INR003"],
        [".", "--ignore", "XAC"],
        [".", "--tier", "source"],
        [".", "--all-args"],
        [".", "--fix"],
        [".", "--diff"],
        [".", "--statistics"],
        [".", "--isolated"],
        ["robot.urdf.xacro"],
        ["audit", ".", "-o", "kept", "--restart"],
        ["baseline", "write"],
    ],
    ids=" ".join,
)
def test_no_command_ends_with_0_unless_it_is_accepted(words: list[str], tmp_path: Path) -> None:
    write(tmp_path, {**CASES["XAC010"], "sound.urdf": SOUND, "urdfcheck.toml": 'unchecked = ["old/**"]\n'})
    done = command(*words, cwd=tmp_path)
    assert done.returncode == FINDINGS, done.stdout + done.stderr
    assert "not checked" in done.stdout + done.stderr
    accepted = command(*words, "--unchecked", "warning", cwd=tmp_path)
    assert accepted.returncode == OK, accepted.stdout + accepted.stderr
    assert "not checked" in accepted.stdout + accepted.stderr


@pytest.mark.usefixtures("one_process")
@pytest.mark.parametrize("name", ["srdf", "engines"])
def test_a_command_about_one_model_fails_without_it(name: str, tmp_path: Path) -> None:
    write(tmp_path, CASES["XAC010"])
    assert command(name, "robot.urdf.xacro", cwd=tmp_path).returncode == FAILED


@pytest.mark.usefixtures("one_process")
def test_from_python(tmp_path: Path) -> None:
    write(tmp_path, CASES["XAC010"])
    run = urdfcheck.check(tmp_path, select="INR003", jobs=1, cache=False)
    assert [(f.code, str(f.severity)) for f in run.findings] == [("XAC010", "error")]
    assert [m.not_checked.remedy for m in run.unchecked_models if m.not_checked] == ["--arg side:=…"]
    run = urdfcheck.check(tmp_path, unchecked="warning", jobs=1, cache=False)
    assert [str(f.severity) for f in run.findings] == ["warning"]
    with pytest.raises(urdfcheck.UrdfcheckError, match="unchecked never: one of error, warning"):
        urdfcheck.check(tmp_path, unchecked="never")


@pytest.mark.usefixtures("one_process")
@pytest.mark.parametrize("name", ["srdf", "engines", "drop"])
def test_a_command_for_one_model_accepts_that_it_is_not_checked(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It says why all the same; without ``unchecked`` there is nothing that it could write, and it fails."""
    if name == "drop":
        pytest.importorskip("mujoco")
    path = str(write(tmp_path, CASES["XAC010"]) / "robot.urdf.xacro")
    assert main([name, path]) == FAILED
    capsys.readouterr()
    assert main([name, path, "--unchecked", "warning"]) == OK
    said = capsys.readouterr().err
    assert "robot.urdf.xacro" in said
    assert "(accepted)" in said
    write(tmp_path, {"urdfcheck.toml": 'unchecked = ["robot.*"]\n'})
    assert main([name, path]) == OK
    assert main([name, path, "--isolated"]) == FAILED


@pytest.mark.usefixtures("one_process")
def test_an_empty_folder_is_accepted_by_every_command_that_takes_folders(tmp_path: Path) -> None:
    (tmp_path / "docs").mkdir()
    pytest.importorskip("mujoco")
    assert main(["drop", str(tmp_path)]) == NOTHING
    assert main(["drop", str(tmp_path), "--allow-empty"]) == OK


def test_what_is_called_a_model_and_is_no_file_could_not_be_read(tmp_path: Path) -> None:
    """Nobody knows what comes out of a pipe, or what a link means elsewhere."""
    write(tmp_path, {"robot.urdf": SOUND, "notes/readme": "x"})
    os.mkfifo(tmp_path / "pipe.urdf")
    os.symlink("nowhere", tmp_path / "dangling.xacro")
    os.symlink("circle.urdf", tmp_path / "circle.urdf")
    os.symlink("nowhere", tmp_path / "notes" / "other.txt")
    os.symlink("nowhere", tmp_path / ".#robot.urdf")  # as Emacs locks a file
    outcome = check(tmp_path)
    told = {failure.partition(": ")[0].rpartition("/")[2]: failure for failure in outcome.failures}
    assert set(told) == {"pipe.urdf", "dangling.xacro", "circle.urdf"}
    assert "neither a file nor a folder" in told["pipe.urdf"]
    assert "leads nowhere" in told["dangling.xacro"]
    assert [info.status for info in outcome.models] == ["checked"]
    assert compute_exit_code(outcome, "error") == FAILED
    write(tmp_path, {"urdfcheck.toml": 'exclude = ["pipe.*", "dangling.*", "circle.*"]\n'})
    assert not check(tmp_path, config_resolver=ConfigResolver()).failures
