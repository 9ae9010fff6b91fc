"""The command as other programs see it: exit codes, what goes where, and errors for a person."""

from __future__ import annotations

import io
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import command as urdfcheck

from urdfcheck import cli
from urdfcheck.cli import terminal
from urdfcheck.rule_pages import abridge_page, list_pages

pytestmark = pytest.mark.slow

SOUND = '<robot name="r"><link name="base"/></robot>'
BROKEN = (
    '<robot name="r"><link name="a"><inertial><mass value="1"/>'
    '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="9"/></inertial></link></robot>'
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "sound.urdf").write_text(SOUND)
    (tmp_path / "broken.urdf").write_text(BROKEN)
    return tmp_path


def test_clean_is_0(folder: Path) -> None:
    assert urdfcheck("sound.urdf", cwd=folder).returncode == cli.OK


@pytest.mark.usefixtures("one_process")
def test_a_finding_at_or_above_fail_on_is_1(folder: Path) -> None:
    assert urdfcheck("broken.urdf", cwd=folder).returncode == cli.FINDINGS
    assert urdfcheck("broken.urdf", "--fail-on", "never", cwd=folder).returncode == cli.OK
    assert urdfcheck("broken.urdf", "--ignore", "ALL", cwd=folder).returncode == cli.OK


@pytest.mark.usefixtures("one_process")
def test_fail_on_info_counts_every_finding(folder: Path) -> None:
    (folder / "noted.urdf").write_text(SOUND.replace('"base"/>', '"base"><visual><material name=""/></visual></link>'))
    select = ("--select", "XML012")
    assert urdfcheck("noted.urdf", *select, cwd=folder).returncode == cli.OK
    assert urdfcheck("noted.urdf", *select, "--fail-on", "info", cwd=folder).returncode == cli.FINDINGS


@pytest.mark.usefixtures("one_process")
def test_nothing_to_check_is_3_unless_allowed(tmp_path: Path) -> None:
    assert urdfcheck(".", cwd=tmp_path).returncode == cli.NOTHING
    assert urdfcheck(".", "--allow-empty", cwd=tmp_path).returncode == cli.OK


def test_a_path_that_does_not_exist_is_2_and_the_others_are_still_checked(folder: Path) -> None:
    done = urdfcheck("missing.urdf", "broken.urdf", cwd=folder)
    assert done.returncode == cli.FAILED
    assert "missing.urdf: does not exist" in done.stdout
    assert "INR003" in done.stdout


@pytest.mark.usefixtures("one_process")
@pytest.mark.parametrize(
    ("typed", "says"),
    [
        ("urdf/robt.urdf.xacro", "does not exist (did you mean 'urdf/robot.urdf.xacro'?)"),
        ("urfd/robot.urdf.xacro", "does not exist (did you mean 'urdf/robot.urdf.xacro'?)"),
        ("urdf/Robot.urdf.xacro", "does not exist (did you mean 'urdf/robot.urdf.xacro'?)"),
        ("urdf/a.urdf", "does not exist"),
        ("urdf/link.urdf", "does not exist"),
        ("nowhere/robot.urdf.xacro", "does not exist"),
        ("load_base:=false", "does not exist; write `--arg load_base:=false` for an argument of xacro"),
        ("name:=a b", "does not exist; write `--arg 'name:=a b'` for an argument of xacro"),
    ],
)
def test_what_a_path_that_does_not_exist_was_meant_for(tmp_path: Path, typed: str, says: str) -> None:
    (tmp_path / "urdf").mkdir()
    for name in ("robot.urdf.xacro", "b.urdf"):
        (tmp_path / "urdf" / name).write_text(SOUND)
    (tmp_path / "urdf" / "link.urdf").symlink_to("nothing.urdf")
    done = urdfcheck(typed, cwd=tmp_path)
    assert done.returncode == cli.FAILED
    assert f"not checked: {typed}: {says} ⊘" in " ".join(done.stdout.split())


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ([], "name at least one model"),
        (["x.urdf", "--select", "INR999"], "'INR999' names no rule; did you mean INR0"),
        (["x.urdf", "--select", "triangle-inequalty"], "did you mean triangle-inequality?"),
        (["x.urdf", "--arg", "side=left"], "write NAME:=VALUE"),
        (["x.urdf", "--package", "p"], "write NAME=DIR"),
        (["x.urdf", "--package", "p=/nowhere/at/all"], "is not a folder"),
        (["x.urdf", "--package", "p=FOLDER"], "write the folder of package p in its place"),
        (["x.urdf", "--arg", "side:=…"], "replace … by the value of side"),
        (["x.urdf", "--target", "gazbo"], "did you mean 'gazebo'?"),
        (["x.urdf", "--jobs", "0"], "at least 1"),
        (["x.urdf", "-o", "report.html"], "write FORMAT=FILE"),
        (["x.urdf", "--statistics", "--format", "json"], "write -o json=FILE"),
        (["x.urdf", "--watch", "--fix"], "leave out --fix"),
        (["x.urdf", "-q", "-v"], "not allowed with"),
        (["x.urdf", "--format", "sarf"], "did you mean sarif?"),
        (["x.urdf", "--fail-on", "warnings"], "did you mean warning?"),
        (["x.urdf", "--fial-on", "warning"], "did you mean --fail-on instead of --fial-on?"),
        (["lsp"], "did you mean urdfcheck server?"),
        (["rule", "XYZ000"], "no rule"),
    ],
)
@pytest.mark.usefixtures("one_process")
def test_a_wrong_command_line_is_2_and_says_what_to_write(words: list[str], says: str, tmp_path: Path) -> None:
    done = urdfcheck(*words, cwd=tmp_path)
    assert done.returncode == cli.FAILED
    assert says in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    "words", [["--format", "sarf"], ["--format", "it's"], ["--fail-on", "never ever"], ["--fial-on", "warning"]]
)
@pytest.mark.usefixtures("one_process")
def test_a_wrong_value_needs_no_usage(words: list[str], tmp_path: Path) -> None:
    assert urdfcheck("x.urdf", *words, cwd=tmp_path).stderr.count("\n") == 1


@pytest.mark.usefixtures("one_process")
def test_a_report_that_cannot_be_written_is_2(folder: Path) -> None:
    done = urdfcheck("sound.urdf", "-o", "html=sound.urdf/report.html", "-o", "text=report.txt", cwd=folder)
    assert done.returncode == cli.FAILED
    assert "cannot write" in done.stderr
    assert (folder / "report.txt").is_file(), "it keeps no other report from being written"


@pytest.mark.usefixtures("one_process")
def test_several_outputs_at_once(folder: Path) -> None:
    done = urdfcheck(
        "broken.urdf", "--format", "json", "-o", "text=out/report.txt", "-o", "html=out/r.html", cwd=folder
    )
    assert json.loads(done.stdout)["findings"]
    assert ": inertia breaks the triangle inequality (" in (folder / "out" / "report.txt").read_text(encoding="utf-8")
    assert (folder / "out" / "r.html").read_text(encoding="utf-8").lower().startswith("<!doctype html>")
    assert not list((folder / "out").glob(".*")), "no half-written file stays behind"


@pytest.mark.usefixtures("one_process")
def test_colours_only_where_asked_or_on_a_terminal(folder: Path) -> None:
    assert "\x1b[" not in urdfcheck("broken.urdf", cwd=folder).stdout
    assert "\x1b[" in urdfcheck("broken.urdf", "--color", "always", cwd=folder, TERM="xterm-256color").stdout


def test_output_is_the_same_for_any_number_of_jobs(folder: Path) -> None:
    def report(jobs: str) -> object:
        found = json.loads(urdfcheck(".", "--format", "json", "--jobs", jobs, cwd=folder).stdout)
        found.pop("seconds")
        for model in found["models"]:
            model.pop("seconds")
        return found

    assert report("1") == report("4")


@pytest.mark.usefixtures("one_process")
def test_fingerprints_do_not_depend_on_the_working_directory(folder: Path) -> None:
    (folder / "urdfcheck.toml").write_text("")
    (folder / "sub").mkdir()

    def prints(path: str, cwd: Path) -> list[str]:
        found = json.loads(urdfcheck(path, "--format", "json", cwd=cwd).stdout)["findings"]
        return [p for f in found for p in f["fingerprints"]]

    assert prints("broken.urdf", folder) == prints("../broken.urdf", folder / "sub") != []


@pytest.mark.usefixtures("one_process")
def test_statistics_and_quiet_say_less_and_end_alike(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def told(option: str) -> str:
        assert cli.main([str(folder / "broken.urdf"), "--tier=source", option]) == cli.FINDINGS
        return capsys.readouterr().out

    table, brief = told("--statistics"), told("--quiet")
    assert re.search(r"^INR003 +triangle-inequality +error +1 +1 +0$", table, re.MULTILINE)
    assert "skipped" not in table + brief
    assert re.search(r"^\S*broken\.urdf:1:\d+: error INR003 ", brief, re.MULTILINE)
    assert table.splitlines()[-1].partition(" · 1 model")[0] == brief.splitlines()[-1].partition(" · 1 model")[0]


@pytest.mark.parametrize("encoding", ["utf-8", "ascii"])
@pytest.mark.parametrize("columns", [100, 40])
def test_a_progress_bar_fits_its_line_and_leaves_no_trace(
    monkeypatch: pytest.MonkeyPatch, encoding: str, columns: int
) -> None:
    class Terminal(io.TextIOWrapper):
        def isatty(self) -> bool:
            return True

        def fileno(self) -> int:
            return 2

    seen = io.BytesIO()
    monkeypatch.setattr(sys, "stderr", Terminal(seen, encoding=encoding, write_through=True))
    monkeypatch.setattr(os, "get_terminal_size", lambda _: os.terminal_size((columns, 24)))
    monkeypatch.setattr(terminal, "PROGRESS_FROM", 0.0)
    monkeypatch.delenv("CI", raising=False)
    monkeypatch.setenv("TERM", "xterm")
    show = terminal.make_progress_printer()
    assert show is not None
    show(1, 3)
    show(3, 3)
    line, end = seen.getvalue().decode(encoding).split("\r")[1:]
    assert "1 of 3 checked" in line
    assert len(line) - len("\x1b[K") < columns
    assert end == "\x1b[K"
    for name, value in (("CI", "true"), ("TERM", "dumb")):
        with monkeypatch.context() as patch:
            patch.setenv(name, value)
            assert terminal.make_progress_printer() is None


class TestCompletion:
    @pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
    def test_a_shell_can_read_its_script(self, shell: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        if shutil.which(shell) is None:
            pytest.skip(f"{shell} is not installed")
        assert cli.main(["completion", shell]) == cli.OK
        script = tmp_path / "script"
        script.write_text(capsys.readouterr().out, encoding="utf-8")
        assert subprocess.run([shell, "-n", script]).returncode == 0
        script.write_text(script.read_text(encoding="utf-8") + "\nif (", encoding="utf-8")
        assert subprocess.run([shell, "-n", script], stderr=subprocess.DEVNULL).returncode != 0

    @pytest.mark.skipif(shutil.which("bash") is None, reason="bash is not installed")
    def test_bash_completes_commands_options_values_and_paths(
        self, tmp_path: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        cli.main(["completion", "bash"])
        for name in ("car 3.urdf", "notes.txt"):
            (tmp_path / name).touch()
        (tmp_path / "folder").mkdir()
        asked = {
            ("c",): ["check", "cache", "config", "completion", "car 3.urdf"],
            ("car.urdf", "--stat"): ["--statistics"],
            ("car.urdf", "--tier", ""): ["source", "mesh", "full"],
            ("car.urdf", "--tier", "=", "f"): ["full"],
            (".", "--select", "INR00"): [f"INR00{i}" for i in range(1, 10)],
            (".", "--target", "mu"): ["mujoco"],
            (".", "-o", "js"): ["json="],
            (".", "-o", "json", "=", "no"): ["notes.txt"],
            ("rule", "triangle"): ["triangle-inequality"],
            ("baseline", ""): ["write", "check", "prune"],
            ("check", "--package-path", ""): ["folder"],
            (".", "--", "--f"): [],
        }
        calls = [f"t urdfcheck {' '.join(map(shlex.quote, words))}" for words in asked]
        ask = 't() { COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _urdfcheck; printf "%s|" "${COMPREPLY[@]}"; echo; }'
        completion = capsys.readouterr().out
        script = "\n".join((completion, ask, *calls))
        told = subprocess.run(
            ["bash", "-c", script], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        ).stdout
        # Of a file's name bash quotes the =, and then completes no path behind it.
        called = "compopt() { echo $2; }; COMP_WORDS=(urdfcheck -o js); COMP_CWORD=2; _urdfcheck"
        options = subprocess.run(
            ["bash", "-c", f"{completion}\n{called}"], cwd=tmp_path, capture_output=True, text=True
        )
        assert options.stdout.split() == ["nospace"]
        assert dict(zip(asked, ([w for w in line.split("|") if w] for line in told.splitlines()), strict=True)) == asked


def test_a_crash_is_not_taken_for_findings() -> None:
    crash = "from urdfcheck import cli, __main__ as m; cli.main = lambda **_: 1 / 0; raise SystemExit(m.main())"
    ended = subprocess.run([sys.executable, "-c", crash], capture_output=True, text=True, check=False)
    assert ended.returncode == cli.FAILED
    assert "ZeroDivisionError" in ended.stderr
    assert "bug of urdfcheck" in ended.stderr


def test_rule_lists_and_explains() -> None:
    listed = urdfcheck("rule", cwd=Path())
    assert "INR003  error    proof      triangle-inequality" in listed.stdout
    explained = urdfcheck("rule", "triangle-inequality", cwd=Path())
    assert explained.stdout.startswith("# INR003 triangle-inequality")
    assert explained.returncode == cli.OK
    assert "urdfcheck rule INR003 --full" in explained.stdout
    whole = urdfcheck("rule", "INR003", "--full", cwd=Path()).stdout
    assert len(whole.splitlines()) > len(explained.stdout.splitlines())
    assert "## References" in whole


@pytest.mark.parametrize("page", list_pages(), ids=lambda page: page.name[:6])
def test_a_short_page_is_the_beginning_of_each_section(page: Path) -> None:
    short, whole = abridge_page(page.read_text(encoding="utf-8")), page.read_text(encoding="utf-8")
    headings = [line for line in short.splitlines() if line.startswith("## ")]
    assert headings == [line for line in whole.splitlines() if line in headings]
    assert {"## What it checks", "## Why it matters", "## How to fix"} <= set(headings)
    assert short.count("```") % 2 == 0
    assert not re.search(r":\n\n(## |The whole page)", short), "it ends before what it announces"
    assert len(short.splitlines()) < 90  # two screens (chosen)


@pytest.mark.usefixtures("one_process")
def test_a_name_from_the_file_cannot_act_on_the_terminal(folder: Path) -> None:
    evil = BROKEN.replace('name="a"', 'name="&#x9b;31m&#x202e;evil"')
    (folder / "evil.urdf").write_text(evil)
    out = urdfcheck("evil.urdf", cwd=folder).stdout
    assert "\x9b" not in out
    assert "\u202e" not in out
    assert "\\x9b31m\\u202eevil" in out


@pytest.mark.usefixtures("one_process")
class TestConfiguration:
    def test_found_upwards_and_obeyed(self, folder: Path) -> None:
        (folder / "pyproject.toml").write_text('[tool.urdfcheck]\nignore = ["INR003"]\n')
        assert urdfcheck("broken.urdf", cwd=folder).returncode == cli.OK

    def test_command_line_wins(self, folder: Path) -> None:
        (folder / "urdfcheck.toml").write_text('fail-on = "never"\n')
        assert urdfcheck("broken.urdf", cwd=folder).returncode == cli.OK
        assert urdfcheck("broken.urdf", "--fail-on", "error", cwd=folder).returncode == cli.FINDINGS

    def test_a_gate_for_strangers_ignores_their_configuration(self, folder: Path) -> None:
        for text in (
            'ignore = ["ALL"]\n',
            '[severity]\nALL = "info"\n',
            "[options.INR003]\nrel_tol = 10.0\n",
            "x = \n",
        ):
            (folder / "urdfcheck.toml").write_text(text)
            assert urdfcheck("broken.urdf", "--isolated", cwd=folder).returncode == cli.FINDINGS

    @pytest.mark.parametrize(
        "text",
        [f"a = {'9' * 5000}", f"a = {'[' * 5000}", f"{'a.' * 5000}a = 1", "#" * 5 * 1024**2, "tool = 1\nb = ="],
        ids=["digits", "depth", "parts", "size", "toml"],
    )
    def test_a_hostile_file_is_an_error(self, folder: Path, text: str) -> None:
        (folder / "urdfcheck.toml").write_text(text)
        done = urdfcheck("broken.urdf", cwd=folder)
        assert done.returncode == cli.FAILED
        assert done.stderr.startswith("urdfcheck: urdfcheck.toml: ")
        assert "Traceback" not in done.stderr

    def test_a_link_leads_to_no_file_of_somebody_else(self, folder: Path) -> None:
        (folder.parent / "secret.toml").write_text("password_of_bob = 1\n")
        (folder / "urdfcheck.toml").symlink_to(folder.parent / "secret.toml")
        done = urdfcheck("broken.urdf", cwd=folder)
        assert done.returncode == cli.FAILED
        assert "bob" not in done.stderr

    def test_a_tool_that_is_no_table_is_none_of_ours(self, folder: Path) -> None:
        (folder / "pyproject.toml").write_text("tool = 1\n")
        assert urdfcheck("broken.urdf", cwd=folder).returncode == cli.FINDINGS

    def test_severity_and_options_of_a_rule(self, folder: Path) -> None:
        (folder / "urdfcheck.toml").write_text('[severity]\nINR003 = "info"\n')
        assert urdfcheck("broken.urdf", cwd=folder).returncode == cli.OK
        (folder / "urdfcheck.toml").write_text("[options.INR003]\nrel_tol = 10.0\n")
        assert "INR003" not in urdfcheck("broken.urdf", cwd=folder).stdout

    @pytest.mark.parametrize(
        ("text", "says"),
        [
            ('selct = ["INR"]\n', "urdfcheck.toml:1: unknown key 'selct'; did you mean 'select'?"),
            ('\nselect = "INR"\n', "urdfcheck.toml:2: select must be a list of strings"),
            ('fail-on = "fatal"\n', "fail-on must be one of error, warning, info, never"),
            ('[severity]\nINR003 = "bad"\n', "urdfcheck.toml:2: 'bad' is not a severity"),
            (
                "[options.INR003]\nreltol = 1\n",
                "urdfcheck.toml:2: INR003 has no option 'reltol'; did you mean 'rel_tol'?",
            ),
            ('[options.INR003]\nrel_tol = "big"\n', "rel_tol must be a number"),
            ("select = [\n", "urdfcheck.toml: "),
        ],
    )
    def test_a_mistake_is_2_with_the_line(self, folder: Path, text: str, says: str) -> None:
        (folder / "urdfcheck.toml").write_text(text)
        done = urdfcheck("sound.urdf", cwd=folder)
        assert done.returncode == cli.FAILED
        assert says in done.stderr


@pytest.mark.usefixtures("one_process")
def test_a_report_to_what_is_no_file_goes_into_it(tmp_path: Path) -> None:
    """As root a rename would put a file in the place of the device."""
    import os
    import threading

    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    (tmp_path / "checked").mkdir()
    (tmp_path / "checked/r.urdf").write_text('<robot name="r"><link name="l"/></robot>')
    read: list[str] = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_text()), daemon=True)
    reader.start()
    assert cli.main([str(tmp_path / "checked/r.urdf"), "-o", f"json={pipe}"]) == cli.OK
    reader.join(timeout=10)
    assert read
    assert '"urdfcheck/1"' in read[0]
    assert pipe.is_fifo()


@pytest.mark.usefixtures("one_process")
def test_an_argument_that_no_model_declares_is_told(tmp_path: Path) -> None:
    xacro = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{}<link name="base"/></robot>'
    (tmp_path / "a.urdf.xacro").write_text(xacro.format('<xacro:arg name="length" default="1"/>'))
    (tmp_path / "b.urdf.xacro").write_text(xacro.format(""))
    quick = (".", "--tier", "source")
    done = urdfcheck(*quick, "--arg", "lenght:=2", "--arg", "other:=1", cwd=tmp_path)
    assert done.returncode == cli.OK
    assert done.stderr == (
        "urdfcheck: --arg lenght: no model that was checked declares this argument; did you mean length?\n"
        "urdfcheck: --arg other: no model that was checked declares this argument\n"
    )
    assert urdfcheck(*quick, "--arg", "length:=2", cwd=tmp_path).stderr == "", "one declares it"
    (tmp_path / "b.urdf.xacro").write_text(xacro.format("${1 +}"))
    told = "urdfcheck: --arg lenght: not declared in what was read before the expansion stopped; did you mean length?\n"
    assert urdfcheck(*quick, "--arg", "lenght:=2", cwd=tmp_path).stderr == told
    (tmp_path / "b.urdf.xacro").write_text("<robot")
    assert urdfcheck(*quick, "--arg", "lenght:=2", cwd=tmp_path).stderr == "", "what b declares is unknown"
    (tmp_path / "b.urdf.xacro").write_text(xacro.format('<link name="$(arg side)"/>'))
    assert urdfcheck(*quick, "--arg", "side:=left", cwd=tmp_path).stderr == "", "it is read without a declaration"


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["chekc", "sound.urdf"], "did you mean urdfcheck check?"),
        (["rules"], "did you mean urdfcheck rule?"),
        (["explain", "INR003"], "did you mean urdfcheck rule CODE?"),
        (["basline", "write"], "did you mean urdfcheck baseline?"),
        (["sound.urdf", "--ignroe", "INR003"], "did you mean --ignore instead of --ignroe?"),
        (["sound.urdf", "--fail-no=error"], "did you mean --fail-on instead of --fail-no?"),
        (["srdf", "sound.urdf", "--throrough"], "did you mean --thorough instead of --throrough?"),
    ],
    ids=str,
)
def test_a_misspelt_command_or_option_is_a_question(folder: Path, words: list[str], says: str) -> None:
    done = urdfcheck(*words, cwd=folder)
    assert (done.returncode, done.stdout) == (cli.FAILED, "")
    assert says in done.stderr


@pytest.mark.usefixtures("one_process")
def test_a_path_is_no_misspelt_command(folder: Path) -> None:
    for name in ("rules", "chekc"):
        (folder / name).mkdir()
        shutil.copy(folder / "sound.urdf", folder / name)
        assert urdfcheck(name, cwd=folder).returncode == cli.OK
    for missing in ("wheels", "rules.urdf", "engine/x"):
        done = urdfcheck(missing, cwd=folder)
        assert f"not checked: {missing}: does not exist" in done.stdout, "it resembles no command, or is a path"


@pytest.mark.usefixtures("one_process")
def test_a_cache_that_cannot_be_read_is_told_once_and_not_used(folder: Path) -> None:
    (folder / "file").write_text("")
    for words in ((".",), ("srdf", "broken.urdf"), ("audit", ".", "-o", "out")):
        done = urdfcheck(*words, cwd=folder, URDFCHECK_CACHE_DIR=str(folder / "file"))
        assert done.stderr.count("is not used as a cache: Not a directory") == 1
        assert "cannot write" not in done.stderr
    assert "INR003" in urdfcheck(".", cwd=folder, URDFCHECK_CACHE_DIR=str(folder / "file")).stdout


def test_a_cache_without_permission_is_told(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As root every folder can be read: the refusal is made here."""
    refused = folder / "cache/urdfcheck-results"
    list_folder = os.scandir

    def refuse(path: object = ".") -> object:
        if path in {refused, str(refused)}:
            raise PermissionError(13, "Permission denied")
        return list_folder(path)  # type: ignore[call-overload]

    monkeypatch.setattr(os, "scandir", refuse)
    done = urdfcheck("broken.urdf", cwd=folder, URDFCHECK_CACHE_DIR=str(folder / "cache"))
    assert done.stderr == f"urdfcheck: {refused} is not used as a cache: Permission denied\n"
    assert done.returncode == cli.FINDINGS


def test_every_command_takes_the_options_of_the_table() -> None:

    from urdfcheck.cli import options

    for option, commands, _ in options._OPTIONS:
        for command in options._ALL:
            parser = cli.load_command(command).build_parser()
            known = option in parser._option_string_actions
            assert known or command not in commands, f"{command} {option}"
    assert {name for _, commands, _ in options._OPTIONS for name in commands} == set(options._ALL)


@pytest.mark.parametrize("command", ["srdf", "engines", "drop"])
@pytest.mark.usefixtures("one_process")
def test_what_is_wrong_with_an_option_is_told_by_every_command(folder: Path, command: str) -> None:
    assert "--jobs 0: at least 1" in urdfcheck(command, "sound.urdf", "--jobs", "0", cwd=folder).stderr
    if command != "srdf":
        done = urdfcheck(command, "sound.urdf", "--target", "gazbo", cwd=folder)
        assert "did you mean 'gazebo'?" in done.stderr


@pytest.mark.usefixtures("one_process")
def test_a_diff_needs_no_right_to_write(folder: Path) -> None:
    """It only shows; --fix says that it cannot."""
    axis = '<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="continuous"><parent link="a"/><child link="b"/>'
    file = folder / "axis.urdf"
    file.write_text(axis + '<axis xyz="0 0 2"/></joint></robot>')
    words = ("axis.urdf", "--unsafe-fixes", "--select", "JNT002")
    shown = urdfcheck(*words, "--diff", cwd=folder)
    assert 'xyz="0 0 1"' in shown.stdout
    file.chmod(0o444)
    assert urdfcheck(*words, "--diff", cwd=folder).stdout == shown.stdout
    done = urdfcheck(*words, "--fix", cwd=folder)
    assert "it is read-only" in done.stderr
    assert 'xyz="0 0 2"' in file.read_text()
