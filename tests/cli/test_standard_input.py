"""``urdfcheck -``: a model on standard input, checked as if it lay where its name says."""

from __future__ import annotations

import io
import json
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import command

from urdfcheck import cli
from urdfcheck.cli import standard_input
from urdfcheck.output import FORMATS

pytestmark = pytest.mark.slow

Check = Callable[..., subprocess.CompletedProcess[str]]
SOUND = '<robot name="r"><link name="base"/></robot>'
TWICE = '<robot name="r"><link name="base"/><link name="base"/></robot>'
XMLNS = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


class Input(io.TextIOWrapper):
    """Standard input with this content."""

    def __init__(self, content: bytes) -> None:
        super().__init__(io.BytesIO(content))


@pytest.fixture
def check(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Check:
    """The command with a text on standard input, in a package."""
    (tmp_path / "package.xml").write_text("<package><name>arm</name></package>")
    (tmp_path / "urdf").mkdir()
    (tmp_path / "urdf/part.xacro").write_text(
        f'<robot {XMLNS}><xacro:macro name="m"><link name="part"/></xacro:macro></robot>'
    )

    def check(text: str | bytes, *words: str) -> subprocess.CompletedProcess[str]:
        monkeypatch.setattr(sys, "stdin", Input(text.encode() if isinstance(text, str) else text))
        return command("-", *words, cwd=tmp_path)

    return check


def test_a_model_comes_through_a_pipe(check: Check, tmp_path: Path) -> None:
    assert check(SOUND).returncode == cli.OK
    done = check(TWICE, "--tier", "source")
    assert done.returncode == cli.FINDINGS
    assert re.search(r"^✖ KIN001 duplicate link name: .*\n  --> stdin\.urdf:1:48\b", done.stdout, re.MULTILINE)
    assert check(TWICE, "--fail-on", "never", "--tier", "source").returncode == cli.OK
    assert sorted(path.name for path in tmp_path.iterdir()) == ["package.xml", "urdf"], "nothing is written"


@pytest.mark.usefixtures("one_process")
def test_a_xacro_is_expanded_with_its_arguments(check: Check) -> None:
    text = f'<robot name="r" {XMLNS}><xacro:arg name="n" default="1"/><link name="l${{1 + $(arg n)}}"/></robot>'
    done = check(text, "--format", "json", "--arg", "n:=4", "--tier", "source")
    (model,) = json.loads(done.stdout)["models"]
    assert (model["path"], model["links"], model["args"]) == ("stdin.urdf.xacro", 1, {"n": "4"})


@pytest.mark.usefixtures("one_process")
def test_its_name_decides_what_it_finds(check: Check, tmp_path: Path) -> None:
    """Includes, packages and the configuration of the folder; not what lies at the name, if anything does."""
    (tmp_path / "urdf/urdfcheck.toml").write_text('ignore = ["NAM003"]\n[severity]\nKIN001 = "info"\n')
    text = (
        f'<robot name="r" {XMLNS}><xacro:include filename="part.xacro"/><xacro:include filename="$(find arm)/urdf/part.xacro"/>'
        "<xacro:m/><xacro:m/></robot>"
    )
    for saved in (False, True):
        if saved:
            (tmp_path / "urdf/robot.urdf.xacro").write_text(SOUND)
        done = check(text, "--stdin-filename", "urdf/robot.urdf.xacro", "--format", "json", "--select", "KIN001")
        report = json.loads(done.stdout)
        assert [(m["path"], m["links"]) for m in report["models"]] == [("urdf/robot.urdf.xacro", 2)]
        assert [(f["code"], f["severity"]) for f in report["findings"]] == [("KIN001", "info")]
    assert (tmp_path / "urdf/robot.urdf.xacro").read_text() == SOUND


@pytest.mark.usefixtures("one_process")
@pytest.mark.parametrize("output_format", FORMATS)
def test_every_format_reports_it(check: Check, output_format: str, tmp_path: Path) -> None:
    done = check(
        TWICE, "--format", output_format, "-o", f"{output_format}=out.txt", "--stdin-filename", "urdf/new.urdf"
    )
    assert done.returncode == cli.FINDINGS, done.stderr
    assert "KIN001" in done.stdout
    assert "new.urdf" in done.stdout
    assert (tmp_path / "out.txt").stat().st_size


@pytest.mark.parametrize(
    ("text", "words", "says"),
    [
        (SOUND, ["--fix"], "--fix works on files"),
        (SOUND, ["--diff"], "--diff works on files"),
        (SOUND, ["--watch"], "--watch works on files"),
        (SOUND, ["urdf"], "is checked alone"),
        (SOUND, ["--stdin-filename", "urdf"], "name a file"),
        (SOUND, ["--stdin-filename", ""], "name a file"),
        (SOUND, ["-o", "html=new.urdf", "--stdin-filename", "new.urdf"], "that is the file of a model"),
        ("", [], "standard input is empty"),
        (" \n", [], "standard input is empty"),
    ],
    ids=str,
)
def test_what_cannot_be_done_is_said(check: Check, text: str, words: list[str], says: str) -> None:
    done = check(text, *words)
    assert (done.returncode, says in done.stderr, done.stdout) == (cli.FAILED, True, "")


def test_it_has_the_limit_of_a_file(check: Check, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(standard_input, "MAX_TEXT", 100)
    assert check(SOUND.ljust(100)).returncode == cli.OK
    done = check(SOUND.ljust(101))
    assert (done.returncode, "more than 100 bytes" in done.stderr) == (cli.FAILED, True)


def test_bytes_that_are_no_text_are_a_finding(check: Check) -> None:
    done = check(b"\x00\xff\xfe<robot", "--stdin-filename", "urdf/x.urdf")
    assert done.returncode == cli.FINDINGS
    assert "urdf/x.urdf" in done.stdout
    assert "XML001" in done.stdout


def test_a_name_without_standard_input_is_told(tmp_path: Path) -> None:
    done = command(".", "--stdin-filename", "x.urdf", cwd=tmp_path)
    assert (done.returncode, "add - as the path" in done.stderr) == (cli.FAILED, True)


def test_a_name_out_of_reach_reads_nothing_there(check: Check, tmp_path: Path) -> None:
    """The name decides what is in reach, as a path does; it does not bring a file into reach that includes name."""
    (tmp_path.parent / "secret.xacro").write_text(f'<robot {XMLNS}><link name="s3cr3t"/></robot>')
    text = f'<robot name="r" {XMLNS}><xacro:include filename="../../secret.xacro"/><link name="base"/></robot>'
    done = check(text, "--stdin-filename", "urdf/robot.urdf.xacro", "--format", "json")
    assert "s3cr3t" not in done.stdout
    assert "PKG012" in done.stdout
