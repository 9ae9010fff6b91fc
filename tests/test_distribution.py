"""What is released: the wheel has what it needs and runs without the checkout; the changelog has notes for a tag."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import venv
import zipfile
from collections.abc import Iterable, Iterator
from importlib.metadata import distribution
from pathlib import Path

import pytest
import tomli
from conftest import REPOSITORY

from urdfcheck.version import __version__

sys.path.insert(0, str(REPOSITORY / "tools"))
try:
    import check_distribution
    import check_image
    import print_release_notes
finally:
    sys.path.pop(0)

pytestmark = [pytest.mark.slow, pytest.mark.long]

CHANGELOG = """# Changelog

## 0.3.0 - not released yet

Later.

## 0.2.0 - 2027-01-31

### Added

- A rule.

## 0.1.0 - 2026-12-01
"""


def build_wheel(sources: Path, folder: Path) -> Path:
    command = [sys.executable, "-m", "hatchling", "build", "--target", "wheel", "--directory", str(folder)]
    subprocess.run(command, cwd=sources, check=True, capture_output=True)
    (path,) = folder.glob("*.whl")
    return path


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_wheel(REPOSITORY, tmp_path_factory.mktemp("dist"))


@pytest.fixture(scope="module")
def core(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel of urdfcheck-core."""
    return build_wheel(REPOSITORY / check_distribution.CORE, tmp_path_factory.mktemp("core"))


def test_the_wheel_has_what_it_needs_and_nothing_else(wheel: Path, tmp_path: Path) -> None:
    assert check_distribution.list_faults_of_wheel(wheel) == []
    poor = tmp_path / "poor.whl"
    with zipfile.ZipFile(wheel) as archive, zipfile.ZipFile(poor, "w") as copy:
        for name in archive.namelist():
            if not name.endswith("/py.typed"):
                copy.writestr(name, archive.read(name))
        copy.writestr("tests/secret.urdf", "<robot/>")
    assert check_distribution.list_faults_of_wheel(poor) == [
        "poor.whl lacks urdfcheck/py.typed",
        "poor.whl holds tests/secret.urdf",
    ]


def test_the_wheel_audits_car_3_without_the_checkout(wheel: Path, tmp_path: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(tmp_path / "installed")
    environment = {**os.environ, "PYTHONPATH": str(tmp_path / "installed"), "XDG_CACHE_HOME": str(tmp_path / "cache")}
    where = "import urdfcheck; print(urdfcheck.__file__)"
    found = subprocess.run([sys.executable, "-c", where], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert Path(found.stdout.strip()).is_relative_to(tmp_path / "installed")
    command = [sys.executable, "-m", "urdfcheck"]
    assert check_distribution.list_faults_of_command(command, __version__, tmp_path, environment) == []


def test_an_image_is_tried_as_the_caller_and_by_default_not_as_root(tmp_path: Path) -> None:
    """With a program in place of Docker, which runs the command of this checkout."""
    engine, said, folder = tmp_path / "engine", tmp_path / "said", tmp_path / "folder"
    folder.mkdir()
    engine.write_text(f"""#!/bin/sh
echo "$*" >> "{said}"
if [ "$4" = id ]; then echo 0; exit; fi
shift 8 # run --rm --user=… --volume … --workdir … TAG
exec "{sys.executable}" -m urdfcheck "$@"
""")
    engine.chmod(0o755)
    faults = check_image.list_faults_of_image(str(engine), "tag", check_image.read_version(), folder)
    assert faults == ["the image runs as user '0'"]
    asked, *calls = said.read_text().splitlines()
    assert asked == "run --rm --entrypoint id tag -u"
    user = f"--user={os.getuid()}:{os.getgid()}"
    assert all(call.startswith(f"run --rm {user} --volume {folder}:{folder} --workdir {folder} tag ") for call in calls)


def list_files(wheel: Path) -> set[str]:
    with zipfile.ZipFile(wheel) as archive:
        return {name for name in archive.namelist() if ".dist-info/" not in name}


def test_both_wheels_hold_the_same_code(wheel: Path, core: Path) -> None:
    assert list_files(core) == list_files(wheel)
    assert check_distribution.list_faults_of_wheel(core) == []


def read_project(folder: Path) -> dict[str, object]:
    return tomli.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))["project"]


@pytest.mark.smoke
def test_the_light_distribution_needs_a_part_of_what_the_full_one_needs() -> None:
    full, light = (read_project(folder) for folder in (REPOSITORY, REPOSITORY / check_distribution.CORE))
    assert set(light["dependencies"]) - set(full["dependencies"]) == {"manifold3d>=3"}
    assert light["optional-dependencies"].items() <= full["optional-dependencies"].items()
    assert light["entry-points"] == full["entry-points"]
    assert full["scripts"].items() <= light["scripts"].items()
    assert all(light[key] == full[key] for key in ("requires-python", "license", "authors"))
    texts = [(folder / "LICENSE").read_bytes() for folder in (REPOSITORY, REPOSITORY / check_distribution.CORE)]
    assert texts[0] == texts[1]


def iter_needed(names: Iterable[str], seen: set[str]) -> Iterator[str]:
    """Yield the distributions with these requirements that are installed, and all that they need."""
    for requirement in names:
        name, _, marker = requirement.partition(";")
        name = re.split(r"[^\w.-]", name.strip())[0]
        if name.lower() not in seen and "extra ==" not in marker and "win32" not in marker:
            seen.add(name.lower())
            yield name
            yield from iter_needed(distribution(name).requires or (), seen)


def link_file(file: Path, place: Path) -> None:
    place.parent.mkdir(parents=True, exist_ok=True)
    try:
        place.hardlink_to(file)
    except OSError:  # another file system
        shutil.copy2(file, place)


def test_the_light_wheel_audits_car_3_with_nothing_but_what_it_names(core: Path, tmp_path: Path) -> None:
    """The libraries are those of this environment, linked into another one that has no more."""
    venv.create(tmp_path / "environment", with_pip=False)
    (site,) = (tmp_path / "environment").rglob("site-packages")
    for name in iter_needed(read_project(REPOSITORY / check_distribution.CORE)["dependencies"], set()):
        for file in distribution(name).files or ():
            if file.parts[0] != ".." and "__pycache__" not in file.parts:
                link_file(Path(str(file.locate())), site / file)
    with zipfile.ZipFile(core) as archive:
        archive.extractall(site)
    programs = tmp_path / "environment" / ("Scripts" if os.name == "nt" else "bin")
    command = [str(programs / "python"), "-I", "-m", "urdfcheck"]
    environment = {**os.environ, "URDFCHECK_CACHE_DIR": str(tmp_path / "cache")}
    absent = subprocess.run([command[0], "-I", "-c", "import scipy"], env=environment, capture_output=True, text=True)
    assert "No module named 'scipy'" in absent.stderr
    assert check_distribution.list_faults_of_core(command, tmp_path, environment) == []
    asked = subprocess.run([*command, "server"], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert "pip install 'urdfcheck-core[server]'" in asked.stderr


@pytest.mark.smoke
def test_the_notes_of_a_release_are_its_section_of_the_changelog() -> None:
    assert print_release_notes.find_notes(CHANGELOG, "0.2.0") == "### Added\n\n- A rule.\n"


@pytest.mark.smoke
@pytest.mark.parametrize(("version", "why"), [("0.3.0", "no date"), ("0.4.0", "no section"), ("0.2", "no section")])
def test_a_version_without_dated_notes_is_no_release(version: str, why: str) -> None:
    with pytest.raises(ValueError, match=why):
        print_release_notes.find_notes(CHANGELOG, version)
