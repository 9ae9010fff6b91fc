"""The importer of Newton as an engine: how its environment is found, and what it does where it is installed."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from builders import inertial, joint, limit, robot

from urdfcheck.simulators import newton

NAMED = os.environ.get(newton.ENVIRONMENT_VARIABLE)


def make_environment(folder: Path, version: str) -> Path:
    """Make an environment in which this version of the importer is installed, as far as its metadata says."""
    inside = (
        Path("Lib") if sys.platform == "win32" else Path("lib", f"python{sys.version_info[0]}.{sys.version_info[1]}")
    )
    distribution = folder / inside / "site-packages" / f"urdf_usd_converter-{version}.dist-info"
    distribution.mkdir(parents=True)
    (distribution / "METADATA").write_text(f"Metadata-Version: 2.1\nName: urdf-usd-converter\nVersion: {version}\n")
    return distribution.parent


def test_the_variable_names_its_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    libraries = make_environment(tmp_path, "9.8.7")
    monkeypatch.setenv(newton.ENVIRONMENT_VARIABLE, str(tmp_path))
    assert newton.find_library_folder() == str(libraries)
    assert newton.get_version() == "9.8.7"


@pytest.mark.parametrize("named", ["", "relative", "/nowhere/at/all"])
def test_without_an_environment_it_is_not_installed(named: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(newton.ENVIRONMENT_VARIABLE, named)
    monkeypatch.setattr(sys, "path", [])
    assert newton.find_library_folder() is None
    assert newton.get_version() is None


def test_an_environment_of_another_python_does_not_count(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    make_environment(tmp_path, "1.0")
    (tmp_path / "lib").rename(tmp_path / "lib_of_another")
    monkeypatch.setenv(newton.ENVIRONMENT_VARIABLE, str(tmp_path))
    assert newton.find_library_folder() is None


@pytest.mark.slow
@pytest.mark.skipif(not NAMED, reason=f"{newton.ENVIRONMENT_VARIABLE} names no environment with the importer")
def test_it_keeps_numbers_and_replaces_names(tmp_path: Path) -> None:
    path = tmp_path / "r.urdf"
    shape = '<collision><geometry><box size="1 1 1"/></geometry></collision>'
    path.write_text(
        robot(
            f'<link name="base/link">{inertial(1, 1e-2)}{shape}</link>',
            f'<link name="arm-1">{inertial(2, 1e-2)}{shape}</link>',
            '<link name="frame"/>',
            f'<link name="slider">{inertial(0.5, 1e-2)}</link>',
            joint("j", "base/link", "arm-1", limit(-1, 2, 1, 1), kind="revolute"),
            joint("f", "arm-1", "frame", kind="fixed"),
            joint("p", "frame", "slider", limit(-0.5, 0.25, 1, 1), kind="prismatic"),
        )
    )
    # What an engine prints is read from its process, of which pytest redirects the output.
    words = (sys.executable, "-m", "urdfcheck", "engines", str(path), "--format", "json", "--no-cache")
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    found = json.loads(done.stdout)["engines"]["newton"]
    assert (found["verdict"], found["reasons"]) == ("loads", [])
    assert found["links"] == ["arm-1", "base/link", "slider"]
    assert found["mass"] == pytest.approx(3.5)
    assert [text.partition(":")[0] for text in found["messages"]] == ["replaces names that USD does not allow"]
