"""The importers of Newton and Isaac Sim as engines: how their environments are found, and what they do where installed."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from builders import inertial, joint, limit, robot

from urdfcheck.simulators import isaac, newton
from urdfcheck.simulators.usd.environment import find_library_folder

DISTRIBUTIONS = {newton: "urdf-usd-converter", isaac: "isaacsim-asset-isolated"}
BOX = "<{0}><geometry><box size='1 2 3'/></geometry></{0}>"


def make_environment(folder: Path, distribution: str, version: str) -> Path:
    """Make an environment in which this version of a distribution is installed, as far as its metadata says."""
    inside = (
        Path("Lib") if sys.platform == "win32" else Path("lib", f"python{sys.version_info[0]}.{sys.version_info[1]}")
    )
    metadata = folder / inside / "site-packages" / f"{distribution.replace('-', '_')}-{version}.dist-info"
    metadata.mkdir(parents=True)
    (metadata / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {distribution}\nVersion: {version}\n")
    return metadata.parent


both = pytest.mark.parametrize("engine", list(DISTRIBUTIONS), ids=lambda engine: engine.__name__.rpartition(".")[2])


@both
def test_the_variable_names_its_environment(
    engine: ModuleType, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    libraries = make_environment(tmp_path, DISTRIBUTIONS[engine], "9.8.7")
    monkeypatch.setenv(engine.ENVIRONMENT_VARIABLE, str(tmp_path))
    assert find_library_folder(engine.ENVIRONMENT_VARIABLE) == str(libraries)
    assert engine.get_version() == "9.8.7"


@both
@pytest.mark.parametrize("named", ["", "relative", "/nowhere/at/all"])
def test_without_an_environment_it_is_not_installed(
    named: str, engine: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(engine.ENVIRONMENT_VARIABLE, named)
    monkeypatch.setattr(sys, "path", [])
    assert find_library_folder(engine.ENVIRONMENT_VARIABLE) is None
    assert engine.get_version() is None


def test_an_environment_of_another_python_does_not_count(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    make_environment(tmp_path, "urdf-usd-converter", "1.0")
    (tmp_path / "lib").rename(tmp_path / "lib_of_another")
    monkeypatch.setenv(newton.ENVIRONMENT_VARIABLE, str(tmp_path))
    assert find_library_folder(newton.ENVIRONMENT_VARIABLE) is None


def ask(engine: ModuleType, path: Path) -> dict[str, Any]:
    """What the command says of an importer; skips the test where its environment is not named.

    What an engine prints is read from its process, of which pytest redirects the output.
    """
    if not os.environ.get(engine.ENVIRONMENT_VARIABLE) or engine.get_version() is None:
        pytest.skip(f"{engine.ENVIRONMENT_VARIABLE} names no environment of this Python with the importer")
    words = (sys.executable, "-m", "urdfcheck", "engines", str(path), "--format", "json", "--no-cache")
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    found: dict[str, Any] = json.loads(done.stdout)["engines"][engine.__name__.rpartition(".")[2]]
    return found


@pytest.mark.slow
@both
def test_it_keeps_numbers_and_replaces_names(engine: ModuleType, tmp_path: Path) -> None:
    path = tmp_path / "r.urdf"
    shape = BOX.format("collision")
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
    found = ask(engine, path)
    assert (found["verdict"], found["reasons"]) == ("loads", [])
    assert found["links"] == ["arm-1", "base/link", "slider"]
    assert found["mass"] == pytest.approx(3.5)
    assert [text.partition(":")[0] for text in found["messages"]] == ["replaces names that USD does not allow"]


@pytest.mark.slow
@both
def test_what_it_places_moves_weighs_and_draws_is_what_was_typed(engine: ModuleType, tmp_path: Path) -> None:
    """An oblique axis, oblique frames and centres, a link without mass, a follower of a follower, and every shape."""
    path = tmp_path / "r.urdf"
    tilted = '<origin xyz="0.3 -0.2 0.1" rpy="0.4 0.5 0.6"/>'
    drawn = "".join(
        f"<visual>{tilted}<geometry>{shape}</geometry></visual>"
        for shape in ('<box size="1 2 3"/>', '<cylinder radius="0.2" length="4"/>', '<sphere radius="1.7"/>')
    )
    heavy = f'<inertial>{tilted}<mass value="2"/><inertia ixx="3" iyy="4" izz="5" ixy="0.5" ixz="0.25" iyz="0.125"/></inertial>'
    oblique = f'{tilted}<axis xyz="0.6 0 0.8"/>'
    follower = '<mimic joint="{}" multiplier="-2" offset="0.1"/>'
    links = [f'<link name="{name}">{heavy}{drawn}</link>' for name in ("base", "a", "b", "c")]
    path.write_text(
        robot(
            *links,
            '<link name="tool"/>',
            joint("to_a", "base", "a", oblique, kind="continuous"),
            joint("to_b", "a", "b", oblique + follower.format("to_a"), kind="continuous"),
            joint("to_tool", "b", "tool", tilted, kind="fixed"),
            joint("to_c", "tool", "c", oblique + follower.format("to_b") + limit(-9, 9, 1, 1), kind="prismatic"),
        )
    )
    found = ask(engine, path)
    assert (found["verdict"], found["reasons"]) == ("loads", [])
    assert found["matrix"] < 1e-6
    assert found["torque"] < 1e-6


@pytest.mark.slow
@both
def test_a_mesh_that_it_cannot_read_is_lost(engine: ModuleType, tmp_path: Path) -> None:
    path = tmp_path / "r.urdf"
    (tmp_path / "text.stl").write_text("no mesh at all")
    mesh = '<{0}><geometry><mesh filename="text.stl"/></geometry></{0}>'
    path.write_text(
        robot(
            f'<link name="base">{inertial(1, 1)}{BOX.format("visual")}{BOX.format("collision")}</link>',
            f'<link name="a">{inertial(1, 1)}{mesh.format("collision")}</link>',
            joint("to_a", "base", "a"),
        )
    )
    found = ask(engine, path)
    assert (found["verdict"], found["reasons"]) == ("drops", ["without 1 of 2 collision shapes"])
    assert any("text.stl" in message for message in found["messages"])
