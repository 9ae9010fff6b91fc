"""The distributions of ROS that a project says it is for."""

from __future__ import annotations

import fnmatch
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.package.package_folders import drop_comments
from urdfcheck.system.files import read_regular

_README_NAMES = ("README.md", "readme.md", "Readme.md", "README.rst", "README.txt", "README")
# In the order of their release. Everything later is as Noetic here.
_RELEASES = ("groovy", "hydro", "indigo", "jade", "kinetic", "lunar", "melodic", "noetic")
_NAME = rf"({'|'.join(_RELEASES)}|ROS ?2|foxy|galactic|humble|iron|jazzy|kilted|rolling)\b"
_IN_README = re.compile(rf"\b{_NAME.replace('|iron', '')}", re.IGNORECASE)  # "iron" is a word
# What sets ROS up: `FROM osrf/ros:kinetic`, `apt install ros-kinetic-desktop`, `source /opt/ros/kinetic/setup.bash`.
_IN_SCRIPT = re.compile(rf"(?:\bros[-:]|/opt/ros/|\bros_?distro\W{{1,3}}){_NAME}", re.IGNORECASE)
_SCRIPT_NAMES = ("dockerfile*", "*.sh", "*.bash")
_SCRIPT_FOLDERS = frozenset({".devcontainer", ".docker", "docker", "install", "scripts", "setup"})
# CMake notes where the ROS is with which a workspace was built.
_BUILT_WITH = Path("build", "CMakeCache.txt")
# So many scripts of a folder are read.
_MOST_SCRIPTS = 50
_LARGEST = 1_000_000


def is_only_before(release: str, finder: PackageFinder) -> bool:
    """Whether a project names ROS before a release, Noetic or older, and neither this one nor anything later.

    The outermost folder whose scripts set ROS up decides, with its README: what it holds may support more than the project uses.
    Where no script does, the READMEs of the project and of its packages decide together.
    """
    project = finder.find_searched_project(finder.start)
    own = [folder for folder in finder.list_parent_folders() if folder.is_relative_to(project)]
    named: set[str] = set()
    for folder in reversed(own):
        named = set(_find_in_scripts(folder, finder))
        if named:
            named.update(_find_in_readme(folder, finder))
            break
    else:
        packages = (folder for folder in finder.list_packages().values() if folder.is_relative_to(project))
        named.update(name for folder in dict.fromkeys([*own, *packages]) for name in _find_in_readme(folder, finder))
    return bool(named) and named.issubset(_RELEASES[: _RELEASES.index(release)])


def _find_in_scripts(folder: Path, finder: PackageFinder) -> Iterator[str]:
    for path in (*_list_scripts(folder, finder), folder / _BUILT_WITH):
        yield from _find(_IN_SCRIPT, drop_comments(_read(path, finder)))


def _find_in_readme(folder: Path, finder: PackageFinder) -> Iterator[str]:
    return _find(_IN_README, next(filter(None, (_read(folder / name, finder) for name in _README_NAMES)), ""))


def _find(pattern: re.Pattern[str], text: str) -> Iterator[str]:
    return (match[1].lower() for match in pattern.finditer(text))


def _list_scripts(folder: Path, finder: PackageFinder) -> list[Path]:
    """Return the scripts in a folder, and in those in it that are for scripts, that may set ROS up."""
    inner = [path for path in _list(folder, finder) if path.name.lower() in _SCRIPT_FOLDERS]
    files = (path for place in (folder, *inner) for path in _list(place, finder))
    return [path for path in files if any(fnmatch.fnmatch(path.name.lower(), name) for name in _SCRIPT_NAMES)][
        :_MOST_SCRIPTS
    ]


def _list(folder: Path, finder: PackageFinder) -> Iterable[Path]:
    try:
        return sorted(folder.iterdir()) if finder.can_open(folder) and folder.is_dir() else []
    except OSError:
        return []


def _read(path: Path, finder: PackageFinder) -> str:
    try:
        return read_regular(path, _LARGEST).decode("utf-8", "replace") if finder.can_open(path) else ""
    except OSError:
        return ""
