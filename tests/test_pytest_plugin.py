"""``pytest --urdfcheck``: models are tests, whose failures read like the command's report."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
import tomli

from urdfcheck.plugins import pytest_plugin

pytestmark = [pytest.mark.slow, pytest.mark.long]

pytest_plugins = "pytester"

BROKEN = """\
<robot name="r">
  <link name="a">
    <inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="9"/></inertial>
  </link>
</robot>
"""
XACRO = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{}</robot>'


@pytest.fixture
def folder(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> pytest.Pytester:
    """A folder with a model of each kind, a file of macros and a test of somebody's own."""
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    for variable in (
        "HOME",
        "USERPROFILE",
    ):  # pytester sets them to the folder, and a home folder is not checked as a whole
        monkeypatch.setenv(variable, str(pytester.path.parent))
    for name, text in {
        "sound.urdf": '<robot name="r"><link name="base"/></robot>',
        "broken.urdf": BROKEN,
        "macros.xacro": XACRO.format('<xacro:macro name="m"><link name="l"/></xacro:macro>'),
        "waiting.xacro": XACRO.format('<link name="$(arg side)"/>'),
        "test_own.py": "def test_own(): pass",
    }.items():
        (pytester.path / name).write_text(text)
    return pytester


def run(folder: pytest.Pytester, *words: str) -> pytest.RunResult:
    # The package is imported already, so pytest cannot rewrite the plugin's assertions, and would warn.
    plugin = ("-p", "urdfcheck.plugins.pytest_plugin", "-W", "ignore::pytest.PytestAssertRewriteWarning")
    return folder.runpytest_inprocess(*plugin, "--urdfcheck-args=--tier=source", *words)


@pytest.mark.smoke
def test_each_model_is_a_test_and_a_failure_reads_like_the_report(folder: pytest.Pytester) -> None:
    done = run(folder, "--urdfcheck", "-ra")
    done.assert_outcomes(passed=2, failed=2)
    done.stdout.fnmatch_lines(
        ["* INR003 *: inertia breaks the triangle inequality (*", "  --> broken.urdf:3:*", "  3 │*", "*│*^^^*"]
    )
    done.stdout.fnmatch_lines(["FAILED broken.urdf::urdfcheck - INR003 *"])
    done.stdout.fnmatch_lines(["FAILED waiting.xacro::urdfcheck - XAC010 *"])
    done.stdout.fnmatch_lines(["  urdfcheck waiting.xacro --arg side:=*"])
    done.stdout.no_fnmatch_line("*pytest_plugin.py*Failed*")


@pytest.mark.parametrize("word", ["--urdfcheck-args=--unchecked=warning", "--urdfcheck-fail-on=never"])
def test_a_model_that_may_stay_unchecked_is_skipped_and_does_not_pass(folder: pytest.Pytester, word: str) -> None:
    done = run(folder, "--urdfcheck", "-ra", word, "waiting.xacro", "sound.urdf")
    done.assert_outcomes(passed=1, skipped=1)
    done.stdout.fnmatch_lines(["SKIPPED*waiting.xacro: not checked: *argument side has no default*--arg NAME:=VALUE*"])


@pytest.mark.skipif(sys.platform == "win32", reason="no such names")
@pytest.mark.parametrize("words", [["-vv"], ["-ra"], ["-ra", "--urdfcheck-fail-on=never"]])
def test_names_of_files_are_data(folder: pytest.Pytester, words: list[str]) -> None:
    for name in ("::error::pwn.urdf", "a\n::error::pwn\x1b[31m\u202e.urdf", "b\n::error::pwn.xacro"):
        (folder.path / name).write_text((folder.path / "waiting.xacro").read_text())
    done = run(folder, "--urdfcheck", *words)
    assert sum(done.parseoutcomes().values()) == 7
    text = done.stdout.str() + done.stderr.str()
    assert not re.search("[\x1b\u202e]|^::", text, re.MULTILINE)
    assert "a\\n\\x3a\\x3aerror\\x3a\\x3apwn\\x1b\\x5b31m" in text


def test_models_are_selected_as_any_test_is(folder: pytest.Pytester) -> None:
    names = ["broken.urdf::urdfcheck", "sound.urdf::urdfcheck", "waiting.xacro::urdfcheck"]
    listed = run(folder, "--urdfcheck", "--collect-only", "-q", "-m", "urdfcheck")
    assert [line for line in listed.outlines if "::" in line] == names
    run(folder, "--urdfcheck", "broken.urdf::urdfcheck", "sound.urdf", "-k", "sound").assert_outcomes(
        passed=1, deselected=1
    )
    run(folder).assert_outcomes(passed=1)


def test_the_configuration_and_the_options_are_obeyed(folder: pytest.Pytester) -> None:
    (folder.path / "urdfcheck.toml").write_text(
        'ignore = ["INR003"]\n[[models]]\npath = "waiting.xacro"\narguments = { side = "left" }\n'
    )
    done = run(folder, "--urdfcheck", "-v")
    done.assert_outcomes(passed=4)
    done.stdout.fnmatch_lines(["waiting.xacro::urdfcheck[[]side:=left[]] PASSED*"])
    (folder.path / "urdfcheck.toml").unlink()
    run(folder, "--urdfcheck", "--urdfcheck-fail-on=never", "broken.urdf").assert_outcomes(passed=1)


@pytest.mark.parametrize(
    ("option", "says"),
    [
        ("--urdfcheck-args=--select=nonesuch", "*'nonesuch' names no rule*"),
        ("--urdfcheck-args=--selct=INR", "*unrecognized arguments: --selct*"),
        ("--urdfcheck-args=--fix", "*--fix has no meaning for tests"),
    ],
)
def test_wrong_options_are_a_wrong_command_line(folder: pytest.Pytester, option: str, says: str) -> None:
    done = run(folder, "--urdfcheck", option)
    assert done.ret == pytest.ExitCode.USAGE_ERROR
    done.stderr.fnmatch_lines([says])


def test_a_process_that_dies_fails_the_tests_that_wait_for_it(
    folder: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = (
        "import os; from urdfcheck.run import pipeline; from urdfcheck.plugins.pytest_service import serve\n"
        "pipeline.stream_reports = lambda *_, **__: os._exit(7)\nserve()"
    )
    monkeypatch.setattr(pytest_plugin, "_PROGRAM", [sys.executable, "-c", program])
    done = run(folder, "--urdfcheck")
    done.assert_outcomes(passed=1, failed=3)
    done.stdout.fnmatch_lines(["urdfcheck failed: its process ended (exit code 7)"])


def test_with_xdist_each_process_checks_its_own(folder: pytest.Pytester) -> None:
    done = run(folder, "--urdfcheck", "-p", "xdist", "-n", "1", "broken.urdf", "sound.urdf")
    done.assert_outcomes(passed=1, failed=1)


def test_who_does_not_ask_pays_nothing() -> None:
    """pytest imports the module for everybody who has urdfcheck installed."""
    project = tomli.loads((Path(__file__).parent.parent / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["entry-points"]["pytest11"] == {"urdfcheck": "urdfcheck.plugins.pytest_plugin"}
    code = "import pytest, sys; before = {*sys.modules}; import urdfcheck.plugins.pytest_plugin; print(*{*sys.modules} - before)"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert {name for name in loaded if name.partition(".")[0] not in sys.stdlib_module_names} == {
        "urdfcheck",
        "urdfcheck.plugins",
        "urdfcheck.version",
        "urdfcheck.plugins.pytest_plugin",
    }
