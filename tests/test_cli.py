"""The command as other programs see it: exit codes, what goes where, and errors for a person."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from urdfcheck import cli

SOUND = '<robot name="r"><link name="base"/></robot>'
BROKEN = (
    '<robot name="r"><link name="a"><inertial><mass value="1"/>'
    '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="9"/></inertial></link></robot>'
)


def urdfcheck(*words: str, cwd: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """The real command in a process of its own."""
    return subprocess.run(
        [sys.executable, "-m", "urdfcheck", *words],
        cwd=cwd,
        capture_output=True,
        text=True,
        encoding="utf-8",
        env={**os.environ, **environment},
    )


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "sound.urdf").write_text(SOUND)
    (tmp_path / "broken.urdf").write_text(BROKEN)
    return tmp_path


def test_clean_is_0(folder: Path) -> None:
    assert urdfcheck("sound.urdf", cwd=folder).returncode == cli.OK


def test_a_finding_at_or_above_fail_on_is_1(folder: Path) -> None:
    assert urdfcheck("broken.urdf", cwd=folder).returncode == cli.FINDINGS
    assert urdfcheck("broken.urdf", "--fail-on", "never", cwd=folder).returncode == cli.OK
    assert urdfcheck("broken.urdf", "--ignore", "ALL", cwd=folder).returncode == cli.OK


def test_fail_on_info_counts_every_finding(folder: Path) -> None:
    (folder / "noted.urdf").write_text(SOUND.replace('"base"/>', '"base"><visual><material name=""/></visual></link>'))
    select = ("--select", "XML012")
    assert urdfcheck("noted.urdf", *select, cwd=folder).returncode == cli.OK
    assert urdfcheck("noted.urdf", *select, "--fail-on", "info", cwd=folder).returncode == cli.FINDINGS


def test_nothing_to_check_is_3_unless_allowed(tmp_path: Path) -> None:
    assert urdfcheck(".", cwd=tmp_path).returncode == cli.NOTHING
    assert urdfcheck(".", "--allow-empty", cwd=tmp_path).returncode == cli.OK


def test_a_path_that_does_not_exist_is_2_and_the_others_are_still_checked(folder: Path) -> None:
    done = urdfcheck("missing.urdf", "broken.urdf", cwd=folder)
    assert done.returncode == cli.FAILED
    assert "missing.urdf: does not exist" in done.stdout
    assert "INR003" in done.stdout


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ([], "name at least one model"),
        (["x.urdf", "--select", "INR999"], "no rule, prefix, name or tag is called 'INR999'"),
        (["x.urdf", "--select", "triangle-inequalty"], "did you mean triangle-inequality?"),
        (["x.urdf", "--arg", "side=left"], "write NAME:=VALUE"),
        (["x.urdf", "--package", "p=/nowhere/at/all"], "is no folder"),
        (["x.urdf", "--target", "gazbo"], "did you mean 'gazebo'?"),
        (["x.urdf", "--jobs", "0"], "at least 1"),
        (["x.urdf", "-o", "report.html"], "write FORMAT=FILE"),
        (["lsp"], "does not exist yet"),
        (["rule", "XYZ000"], "no rule"),
    ],
)
def test_a_wrong_command_line_is_2_and_says_what_to_write(words: list[str], says: str, tmp_path: Path) -> None:
    done = urdfcheck(*words, cwd=tmp_path)
    assert done.returncode == cli.FAILED
    assert says in done.stderr
    assert "Traceback" not in done.stderr


def test_a_report_that_cannot_be_written_is_2(folder: Path) -> None:
    done = urdfcheck("sound.urdf", "-o", "html=sound.urdf/report.html", cwd=folder)
    assert done.returncode == cli.FAILED
    assert "cannot write" in done.stderr


def test_several_outputs_at_once(folder: Path) -> None:
    done = urdfcheck(
        "broken.urdf", "--format", "json", "-o", "text=out/report.txt", "-o", "html=out/r.html", cwd=folder
    )
    assert json.loads(done.stdout)["findings"]
    assert "INR003 triangle-inequality" in (folder / "out" / "report.txt").read_text(encoding="utf-8")
    assert (folder / "out" / "r.html").read_text(encoding="utf-8").lower().startswith("<!doctype html>")
    assert not list((folder / "out").glob(".*")), "no half-written file stays behind"


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


def test_fingerprints_do_not_depend_on_the_working_directory(folder: Path) -> None:
    (folder / "urdfcheck.toml").write_text("")
    (folder / "sub").mkdir()

    def prints(path: str, cwd: Path) -> list[str]:
        found = json.loads(urdfcheck(path, "--format", "json", cwd=cwd).stdout)["findings"]
        return [p for f in found for p in f["fingerprints"]]

    assert prints("broken.urdf", folder) == prints("../broken.urdf", folder / "sub") != []


def test_rule_lists_and_explains() -> None:
    listed = urdfcheck("rule", cwd=Path())
    assert "INR003  error    proof      triangle-inequality" in listed.stdout
    explained = urdfcheck("rule", "triangle-inequality", cwd=Path())
    assert explained.stdout.startswith("# INR003 triangle-inequality")
    assert explained.returncode == cli.OK


def test_a_name_from_the_file_cannot_act_on_the_terminal(folder: Path) -> None:
    evil = BROKEN.replace('name="a"', 'name="&#x9b;31m&#x202e;evil"')
    (folder / "evil.urdf").write_text(evil)
    out = urdfcheck("evil.urdf", cwd=folder).stdout
    assert "\x9b" not in out
    assert "\u202e" not in out
    assert "\\x9b31m\\u202eevil" in out


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
            ('[severity]\nINR003 = "bad"\n', "urdfcheck.toml:2: 'bad' is no severity"),
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


def test_a_report_to_what_is_no_file_goes_into_it(tmp_path: Path) -> None:
    """As root a rename would put a file in the place of the device."""
    import os
    import threading

    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    (tmp_path / "r.urdf").write_text('<robot name="r"><link name="l"/></robot>')
    read: list[str] = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_text()), daemon=True)
    reader.start()
    assert cli.main([str(tmp_path / "r.urdf"), "-o", f"json={pipe}"]) == cli.OK
    reader.join(timeout=10)
    assert read
    assert '"urdfcheck/1"' in read[0]
    assert pipe.is_fifo()
