"""A sourced ROS shell: PYTHONPATH holds another xacro, and ours is taken all the same."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import check_text

from urdfcheck.system import libraries

pytestmark = pytest.mark.slow


@pytest.fixture
def ros(tmp_path: Path) -> Path:
    """A PYTHONPATH folder with a xacro and a pinocchio that cannot even be imported."""
    for name in ("xacro", "pinocchio"):
        (tmp_path / "ros" / name).mkdir(parents=True)
        (tmp_path / "ros" / name / "__init__.py").write_text("raise ImportError('the ROS one')\n")
    return tmp_path / "ros"


def test_the_own_xacro_is_preferred(ros: Path, tmp_path: Path) -> None:
    model = tmp_path / "r.urdf.xacro"
    model.write_text('<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="${1 + 1}_link"/></robot>')
    done = subprocess.run(
        [sys.executable, "-m", "urdfcheck", str(model), "--fail-on", "never"],
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": str(ros)},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "1 model" in done.stdout
    assert "URC907" not in done.stdout


def test_a_foreign_library_that_cannot_be_avoided_is_URC907(
    ros: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(libraries, "find_foreign_libraries", lambda: {"xacro": str(ros / "xacro/__init__.py")})
    outcome = check_text(tmp_path, '<robot name="r"><link name="a"/></robot>', codes={"URC907", "XML001"})
    assert [f.code for f in outcome.findings] == ["URC907"]
    assert str(ros) in outcome.findings[0].message


def test_what_lies_outside_of_the_environment_is_foreign(ros: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert libraries.find_foreign_libraries() == {}
    for name in ("xacro", "pinocchio"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.syspath_prepend(str(ros))
    assert set(libraries.find_foreign_libraries()) == {"xacro", "pinocchio"}


@pytest.mark.parametrize(("command", "models"), [("console script", 1), ("python -m", 3)])
def test_nothing_of_the_checked_folder_is_imported(command: str, models: int, tmp_path: Path) -> None:
    """A repository under check may hold a struct.py or a rich.py of its own."""
    for name in ("struct", "rich", "numpy", "xacro", "json", "urdfcheck_plugin"):
        (tmp_path / f"{name}.py").write_text("import pathlib; pathlib.Path('RAN').write_text(__name__)\n")
    for number in range(models):
        (tmp_path / f"r{number}.urdf").write_text('<robot name="r"><link name="base"/></robot>')
    script = Path(sys.executable).with_name("urdfcheck")
    start = [str(script)] if command == "console script" else [sys.executable, "-m", "urdfcheck"]
    done = subprocess.run([*start, ".", "--jobs", "2"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert not (tmp_path / "RAN").exists(), (tmp_path / "RAN").read_text()
