"""What GitHub and VS Code read of ``--format concise``: their patterns, applied to what the command prints."""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path
from typing import Any

import pytest
from conftest import REPOSITORY, command

from urdfcheck.cli import main

INTEGRATIONS = REPOSITORY / "integrations"
GITHUB = json.loads((INTEGRATIONS / "github/urdfcheck-matcher.json").read_text(encoding="utf-8"))["problemMatcher"]
TASKS = json.loads((INTEGRATIONS / "vscode/tasks.json").read_text(encoding="utf-8"))["tasks"]
SETTINGS = json.loads((INTEGRATIONS / "vscode/settings.json").read_text(encoding="utf-8"))
VS_CODE = [{**matcher, "pattern": [matcher["pattern"]]} for matcher in TASKS[0]["problemMatcher"]]
# What the two know; a matcher with another word matches and shows nothing.
SEVERITIES = {"github": {"error", "warning", "notice"}, "vscode": {"error", "warning", "info"}}
MATCHERS = {"github": GITHUB, "vscode": VS_CODE}
GROUPS = ("file", "line", "column", "severity", "code", "message")


# It cannot be expanded without its argument.
NEEDY = """<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="side"/><link name="$(arg side)_hand"/>
</robot>
"""


def read_line(line: str, matchers: list[dict[str, Any]]) -> list[dict[str, str]]:
    """Return what each matcher that matches a line reads in it."""
    found = []
    for matcher in matchers:
        (pattern,) = matcher["pattern"]
        if (match := re.search(pattern["regexp"], line)) is not None:
            read = {name: match[pattern[name]] for name in GROUPS if name in pattern}
            found.append({"severity": matcher.get("severity", ""), **read})
    return found


LINES = [
    ("a/b.urdf:3:14: error INR003 No body: 15.8 % short", "a/b.urdf 3 14 error INR003"),
    ("a b.urdf:3:14: warning INR003 x:1:2: error XML001 y", "a b.urdf 3 14 warning INR003"),
    ("a.urdf:3:14: info INR003 x", "a.urdf 3 14 info INR003"),
    ("pkg/package.xml: error PKG001 x:1:2: y", "pkg/package.xml - - error PKG001"),
    ("pkg/package.xml: info PKG001 it is (not checked: here)", "pkg/package.xml - - info PKG001"),
    ("a.xacro: not checked: it needs arguments: name (try urdfcheck a.xacro)", "a.xacro - - error -"),
    ("not checked: 2 macro files", None),
    ("✔ no errors", None),
]


@pytest.mark.parametrize("service", MATCHERS)
@pytest.mark.parametrize(("line", "expected"), LINES)
def test_each_kind_of_line_is_read_by_one_pattern(service: str, line: str, expected: str | None) -> None:
    found = read_line(line, MATCHERS[service])
    assert len(found) == (expected is not None)
    for read in found:
        assert read["severity"] in SEVERITIES[service]
        severity = {"notice": "info"}.get(read["severity"], read["severity"])
        told = [read.get("file", "-"), read.get("line", "-"), read.get("column", "-"), severity, read.get("code", "-")]
        assert " ".join(told) == expected
        assert line.endswith(read["message"])


@pytest.mark.parametrize("service", MATCHERS)
def test_all_that_a_run_prints_is_read(
    service: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(REPOSITORY / "fixtures/car-3", tmp_path / "car-3")
    (tmp_path / "arm.urdf.xacro").write_text(NEEDY)
    monkeypatch.chdir(tmp_path)
    # As the task calls it.
    assert main([*TASKS[0]["args"], "--tier", "source"]) == 1
    lines = capsys.readouterr().out.splitlines()
    read = [read_line(line, MATCHERS[service]) for line in lines]
    assert [line for line, found in zip(lines, read, strict=True) if len(found) != 1] == []
    assert {found[0]["severity"] for found in read} == SEVERITIES[service]
    assert all(Path(found[0]["file"]).is_file() for found in read)
    assert any("not checked" in line for line in lines)


def test_what_urdfcheck_could_not_read_is_an_annotation_without_a_file(tmp_path: Path) -> None:
    (line,) = command("check", "missing.urdf", "--format", "concise", cwd=tmp_path).stdout.splitlines()
    assert read_line(line, GITHUB) == [{"severity": "error", "message": "not finished: missing.urdf: does not exist"}]


def test_matchers_have_names_of_their_own_and_groups_that_exist() -> None:
    assert len({matcher["owner"] for matcher in GITHUB}) == len(GITHUB)
    for matcher in (*GITHUB, *VS_CODE):
        (pattern,) = matcher["pattern"]
        groups = [pattern[name] for name in GROUPS if name in pattern]
        assert groups == list(range(1, re.compile(pattern["regexp"]).groups + 1))
        assert ("severity" in matcher) != ("severity" in pattern)


def test_the_second_task_writes_the_schema_that_the_settings_name(tmp_path: Path) -> None:
    words, _, file = TASKS[1]["command"].partition(" > ")
    done = command(*words.split()[1:])
    assert json.loads(done.stdout)["title"]
    ((pattern, schema),) = SETTINGS["evenBetterToml.schema.associations"].items()
    assert schema == f"./{file}"
    assert re.search(pattern, (tmp_path / "urdfcheck.toml").as_posix())
