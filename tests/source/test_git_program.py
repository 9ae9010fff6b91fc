"""Which git lists the ignored files of a folder, and how long it may take."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from urdfcheck.source.discover import discover_targets
from urdfcheck.system import git
from urdfcheck.system.programs import find_program

URDF = '<robot name="r"><link name="base"/></robot>'

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="a script in the place of git, and pipes with names")


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A repository that ignores one of its two models."""
    (tmp_path / "out").mkdir()
    for name in ("a.urdf", "out/b.urdf"):
        (tmp_path / name).write_text(URDF)
    (tmp_path / ".gitignore").write_text("out/\n")
    subprocess.run(["git", "init", "-q"], cwd=tmp_path, check=True)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def list_models(folder: Path) -> list[str]:
    plan = discover_targets([folder], {}, packages={}, package_paths=[])
    return sorted(target.path.name for target in plan.models)


@pytest.mark.parametrize("path", ["", ".", "bin", "{folder}/bin", "{folder}/../link"])
def test_git_of_the_checked_folder_is_not_started(workspace: Path, monkeypatch: pytest.MonkeyPatch, path: str) -> None:
    (workspace / "bin").mkdir()
    (workspace.parent / "link").symlink_to(workspace / "bin")
    for folder in (workspace, workspace / "bin"):
        (folder / "git").write_text(f"#!/bin/sh\ntouch '{workspace}/started'\n")
        (folder / "git").chmod(0o755)
    monkeypatch.setenv("PATH", path.format(folder=workspace) + os.pathsep + os.environ["PATH"])
    for folder in (Path(), workspace):
        assert list_models(folder) == ["a.urdf"], "what git ignores is skipped all the same"
    assert not (workspace / "started").exists()
    found = find_program("git", outside=[workspace])
    assert found is not None
    assert os.path.isabs(found)


def test_without_git_nothing_is_ignored(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", os.pathsep)
    assert find_program("git", outside=[]) is None
    assert list_models(Path()) == ["a.urdf", "b.urdf"]


def test_git_waits_a_short_time_for_a_pipe(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    os.mkfifo(workspace / "pipe")
    subprocess.run(["git", "config", "core.excludesFile", str(workspace / "pipe")], check=True)
    assert git._LISTING_PATIENCE <= 5
    monkeypatch.setattr(git, "_LISTING_PATIENCE", 0.2)
    assert list_models(Path()) == ["a.urdf", "b.urdf"]
