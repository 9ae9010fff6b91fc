"""The packages for ament: the command as the linters of ament are called, and a workspace that colcon builds and tests."""

from __future__ import annotations

import os
import re
import runpy
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree

import pytest
from conftest import REPOSITORY

from urdfcheck.version import __version__

pytestmark = [pytest.mark.slow, pytest.mark.long]

AMENT = REPOSITORY / "integrations/ament"
ARM = REPOSITORY / "fixtures/demos/arm"
# An inertia that no body has.
BROKEN = """<robot name="broken"><link name="base"><inertial><mass value="1"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="9"/></inertial></link></robot>"""


# -- the command -------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def program() -> SimpleNamespace:
    """What the module of the command defines; it is no part of urdfcheck, and leaves nothing beside it."""
    return SimpleNamespace(**runpy.run_path(str(AMENT / "ament_urdfcheck/ament_urdfcheck/main.py")))


@pytest.fixture
def commands(tmp_path: Path) -> Path:
    """A folder with the command urdfcheck, as ``pipx`` makes one."""
    folder = tmp_path / "commands"
    folder.mkdir()
    (folder / "urdfcheck").write_text(f'#!/bin/sh\nexec "{sys.executable}" -I -m urdfcheck "$@"\n')
    (folder / "urdfcheck").chmod(0o755)
    return folder


@pytest.mark.smoke
@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("", "-- ."),
        ("a.urdf b", "-- a.urdf b"),
        ("--xunit-file r.xml", "-o junit=r.xml -- ."),
        ("--xunit-file=r.xml --config c.toml -- a", "--config c.toml -o junit=r.xml -- a"),
        ("--exclude a b/**", "--exclude=a --exclude=b/** -- ."),
        ("--exclude a --exclude b -- c", "--exclude=b -- c"),
        ("--fail-on warning --exclude a -- c", "--fail-on warning --exclude=a -- c"),
        ("c --arg side:=left --tier=mesh", "--arg side:=left --tier=mesh -- c"),
        ("--exclude HERE/a/b ELSEWHERE/c HERE", "--exclude=/a/b --exclude=ELSEWHERE/c --exclude=HERE -- ."),
        ("-- -odd-.urdf", "-- -odd-.urdf"),
    ],
)
def test_the_words_of_ament_become_those_of_urdfcheck(
    program: SimpleNamespace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: str, expected: str
) -> None:
    here, elsewhere = tmp_path / "here", tmp_path / "elsewhere"
    here.mkdir()
    monkeypatch.chdir(here)

    def fill(text: str) -> list[str]:
        return text.replace("HERE", str(here)).replace(f"ELSEW{here}", str(elsewhere)).split()

    options, others = program.parse_words(fill(words))
    assert program.build_command("urdfcheck", options, others) == ["urdfcheck", "check", *fill(expected)]


@pytest.mark.smoke
def test_the_command_writes_xunit_results(
    program: SimpleNamespace, tmp_path: Path, commands: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("a.urdf", "old/b.urdf"):
        (tmp_path / "robots" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "robots" / name).write_text(BROKEN)
    config = tmp_path / "lenient.toml"
    config.write_text('[severity]\nINR003 = "warning"\n')
    monkeypatch.chdir(tmp_path / "robots")
    monkeypatch.setenv("PATH", f"{commands}{os.pathsep}{os.environ['PATH']}")
    result = tmp_path / "results/robots/urdfcheck.xunit.xml"
    words = ["--tier", "source", "--xunit-file", str(result)]
    assert program.main([*words, "--exclude", str(tmp_path / "robots/old")]) == 1
    assert [suite.get("name") for suite in ElementTree.parse(result).iter("testsuite")] == ["a.urdf"]
    assert program.main([*words, "--config", str(config)]) == 0
    assert len(list(ElementTree.parse(result).iter("testsuite"))) == 2


@pytest.mark.smoke
def test_without_urdfcheck_the_command_fails_and_says_so(
    program: SimpleNamespace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    assert program.main([]) == 2
    assert "urdfcheck was not found" in capsys.readouterr().err


@pytest.mark.smoke
def test_the_packages_have_the_version_of_urdfcheck() -> None:
    manifests = sorted(AMENT.glob("*/package.xml"))
    assert [ElementTree.parse(path).findtext("version") for path in manifests] == [__version__, __version__]
    setup = (AMENT / "ament_urdfcheck/setup.py").read_text(encoding="utf-8")
    assert re.findall(r'version="(.*)"', setup) == [__version__]


# -- a workspace, with the real colcon and ament -----------------------------------------------------------------------


def find_python_of_ament() -> str | None:
    """Return a Python that has ament's modules; None where there is none."""

    def has_ament(python: str) -> bool:
        asked = [python, "-c", "import ament_package"]
        return Path(python).exists() and not subprocess.run(asked, capture_output=True).returncode

    pythons = filter(None, ("/usr/bin/python3", shutil.which("python3"), sys.executable))
    return next(filter(has_ament, pythons), None)


def find_reason_to_skip() -> str | None:
    missing = [name for name in ("cmake", "colcon") if shutil.which(name) is None]
    prefixes = ["/usr", *filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep))]
    wanted = ("ament_cmake_core", "ament_cmake_test", "ament_lint_auto")
    missing += [name for name in wanted if not any((Path(p) / "share" / name / "cmake").is_dir() for p in prefixes)]
    return f"NOT INSTALLED: {', '.join(missing)}; the packages for ament are not built" if missing else None


REASON = find_reason_to_skip()
LINTED = """
include(CTest)
if(BUILD_TESTING)
  find_package(ament_lint_auto REQUIRED)
  list(APPEND AMENT_LINT_AUTO_FILE_EXCLUDE "${CMAKE_CURRENT_SOURCE_DIR}/attic")
  set(ament_cmake_urdfcheck_EXCLUDE "third_party")
  set(ament_cmake_urdfcheck_OPTIONS --tier source)
  ament_lint_auto_find_test_dependencies()
  if(TARGETED)
    find_package(ament_cmake_urdfcheck REQUIRED)
    ament_urdfcheck(attic TESTNAME attic CONFIG_FILE attic.toml OPTIONS --fail-on warning)
  endif()
endif()
ament_package()"""
DEPENDS = "<test_depend>ament_lint_auto</test_depend><test_depend>ament_cmake_urdfcheck</test_depend><export>"


class Workspace:
    """A workspace with the two packages, and one of a robot that uses them."""

    def __init__(self, folder: Path, commands: Path) -> None:
        self.folder = folder
        self.robot = folder / "src/arm"
        kept = [p for p in os.environ["PATH"].split(os.pathsep) if not (Path(p) / "activate").exists()]
        self.environment = {**os.environ, "PATH": os.pathsep.join([str(commands), *kept])}
        for name in ("VIRTUAL_ENV", "PYTHONPATH"):
            self.environment.pop(name, None)
        shutil.copytree(AMENT, folder / "src/ament")
        shutil.copytree(ARM, self.robot)
        self._replace("CMakeLists.txt", "\nament_package()", LINTED)
        self._replace("package.xml", "<export>", DEPENDS)
        self._replace("urdf/parts.xacro", "<mass value=", '<mass value="-1" was=')
        for name in ("third_party/a.urdf", "attic/b.urdf"):
            (self.robot / name).parent.mkdir()
            (self.robot / name).write_text(BROKEN)
        (self.robot / "attic.toml").write_text('[severity]\nINR003 = "warning"\n')

    def _replace(self, name: str, old: str, new: str) -> None:
        text = (self.robot / name).read_text(encoding="utf-8")
        assert old in text
        (self.robot / name).write_text(text.replace(old, new), encoding="utf-8")

    def run(self, *words: str, ends_with: Sequence[int] = (0,)) -> subprocess.CompletedProcess[str]:
        done = subprocess.run(words, cwd=self.folder, env=self.environment, capture_output=True, text=True)
        assert done.returncode in ends_with, done.stdout + done.stderr
        return done

    def build(self) -> None:
        self.run("colcon", "build", "--cmake-args", f"-DPython3_EXECUTABLE={find_python_of_ament()}")

    def configure(self, option: str) -> None:
        """Set an option of the robot's package; its tests are made when it is configured."""
        self.run("cmake", f"-D{option}", "build/demo_arm_description")

    def list_failures(self) -> dict[str, set[str]]:
        """Run the tests and return the codes of the failed ones by the file with the results."""
        shutil.rmtree(self.folder / "build/demo_arm_description/test_results", ignore_errors=True)
        self.run("colcon", "test")
        base = ["--test-result-base", "build/demo_arm_description/test_results"]
        listed = self.run("colcon", "test-result", "--verbose", *base, ends_with=(1,))
        found: dict[str, set[str]] = {}
        for line in listed.stdout.splitlines():
            if (head := re.match(r".*/(\w+)\.xunit\.xml: \d+ tests", line)) is not None:
                found[head[1]] = set()
            elif (failed := re.match(r"- urdfcheck\.\S+ ([A-Z]{3}\d{3})", line)) is not None:
                found[next(reversed(found))].add(failed[1])
        return found


@pytest.mark.skipif(REASON is not None, reason=str(REASON))
def test_colcon_test_shows_what_is_wrong_with_a_robot(tmp_path: Path, commands: Path) -> None:
    workspace = Workspace(tmp_path / "a workspace", commands)
    workspace.build()
    # The hook adds the test, without what is excluded; each finding is a failed test for each link.
    assert workspace.list_failures() == {"urdfcheck": {"INR002"}}
    # A second test of what the first leaves out: its own name, paths, configuration and options.
    workspace.configure("TARGETED=ON")
    assert workspace.list_failures() == {"attic": {"INR003"}, "urdfcheck": {"INR002"}}
    # The way in which ament leaves a linter out.
    workspace.configure("AMENT_LINT_AUTO_EXCLUDE=ament_cmake_urdfcheck")
    assert workspace.list_failures() == {"attic": {"INR003"}}
