"""Pedantic: nothing is on request, and what the pages lower to an info is a warning."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from builders import inertial, joint, link, robot
from conftest import check, command

import urdfcheck
from urdfcheck.core import Severity
from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.policy.config import TARGETS
from urdfcheck.policy.consumers import apply_severity_policy
from urdfcheck.rules import describe_pedantic, load_page, load_rules

pytestmark = pytest.mark.usefixtures("one_process")

# JNT007: a joint without effort and without a motor, which is lowered and on request; KIN008 is on request.
ROBOT = robot(
    link("base", inertial(2, 0.1)),
    link("arm", inertial(1, 0.1)),
    joint("j", "base", "arm", '<limit lower="-1" upper="1" effort="0" velocity="1"/>', kind="revolute"),
)
QUIET: dict[str, str] = {}
STRICT = {"JNT007": "warning", "KIN008": "info"}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "r.urdf").write_text(ROBOT)
    return tmp_path


def list_severities(folder: Path, *options: str) -> dict[str, str]:
    done = command("r.urdf", "--tier", "source", "--format", "json", *options, cwd=folder)
    findings = json.loads(done.stdout)["findings"]
    return {f["code"]: f["severity"] for f in findings if f["code"] in STRICT}


@pytest.mark.parametrize(
    ("options", "severities"),
    [
        ([], QUIET),
        (["--pedantic"], STRICT),
        (["--pedantic", "--select", "JNT"], {"JNT007": "warning"}),
        (["--pedantic", "--ignore", "JNT"], {"KIN008": "info"}),
        (["-v"], {"JNT007": "info", "KIN008": "info"}),  # more lines, no other verdict
    ],
)
def test_the_command_line_is_pedantic(folder: Path, options: list[str], severities: dict[str, str]) -> None:
    assert list_severities(folder, *options) == severities


@pytest.mark.parametrize(
    ("text", "severities"),
    [
        ("pedantic = true", STRICT),
        ("pedantic = false", QUIET),
        ('pedantic = true\nseverity = { JNT007 = "info" }', {"JNT007": "info", "KIN008": "info"}),
        ('[[paths]]\nmatch = ["r.urdf"]\npedantic = true', STRICT),
        ('pedantic = true\n[[paths]]\nmatch = ["r.urdf"]\npedantic = false', QUIET),
    ],
)
def test_the_configuration_is_pedantic(folder: Path, text: str, severities: dict[str, str]) -> None:
    (folder / "urdfcheck.toml").write_text(text)
    assert list_severities(folder) == severities


def test_a_pedantic_command_wins(folder: Path) -> None:
    (folder / "urdfcheck.toml").write_text("pedantic = false")
    assert list_severities(folder, "--pedantic") == STRICT
    assert "pedantic         true" in command("config", "--pedantic", "r.urdf", cwd=folder).stdout


def test_a_gate_counts_pedantic_warnings(folder: Path) -> None:
    options = ("r.urdf", "--tier", "source", "--fail-on", "warning")
    assert command(*options, cwd=folder).returncode == 0
    assert command(*options, "--pedantic", cwd=folder).returncode == 1


def test_python_is_pedantic_on_request(folder: Path) -> None:
    found = {f.code: str(f.severity) for f in urdfcheck.check(folder / "r.urdf", tier="source", pedantic=True).findings}
    assert found.items() >= STRICT.items()


def test_only_notes_that_the_page_names_are_raised(folder: Path) -> None:
    (finding,) = check(folder / "r.urdf", codes={"JNT007"}).findings
    rule = load_rules()["JNT007"]
    for message, severity, expected in (
        (finding.message_id, Severity.INFO, Severity.WARNING),
        (finding.message_id, Severity.ERROR, Severity.ERROR),
        ("missing", Severity.INFO, Severity.INFO),
    ):
        changed = replace(finding, message_id=message, severity=severity)
        raised = apply_severity_policy(changed, rule, targets=(), severities={}, is_pedantic=True)
        assert raised.severity is expected


@pytest.mark.parametrize("rule", [r for r in load_rules().values() if r.pedantic], ids=lambda rule: rule.code)
def test_pages_name_targets(rule: urdfcheck.Rule) -> None:
    assert {target for targets in rule.pedantic.values() for target in targets} <= set(TARGETS)
    assert "are warnings with --pedantic" in describe_pedantic(rule)


def test_a_page_names_messages_that_exist(tmp_path: Path) -> None:
    page = load_rules()["MSH010"].page.replace("[pedantic]\nmirrored", "[pedantic]\nmirored")
    (tmp_path / "MSH010-negative-scale.md").write_text(page)
    with pytest.raises(UrdfcheckError, match="no message 'mirored'"):
        load_page(tmp_path / "MSH010-negative-scale.md")
