"""The launch files that pass an argument to another one in their project: roslaunch refuses an include that passes one which the
file does not declare."""

from __future__ import annotations

import itertools
import re
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

from urdfcheck.source.launch.launch_file import Launch
from urdfcheck.source.launch.passed_arguments import iter_launch_files
from urdfcheck.source.launch.substitutions import may_become
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.project_folders import find_project_folder
from urdfcheck.source.text.xml import COMMENT
from urdfcheck.system.files import read_text_or_nothing

# So many launch files of a project are read, and so much of each.
_MOST_LAUNCHES, _MOST_BYTES = 1_000, 500_000
_INCLUDE = re.compile(r"<include\b([^<>]*[^/<>])>((?:(?!<include\b).)*?)</include>", re.DOTALL)
_FILE = re.compile(r"\bfile\s*=\s*[\"'](?:\$\(find\s+([^\s()$]+)\s*\))?(?:[^\"'<>]*/)?([^\"'<>/]+)[\"']")
_PASSED = re.compile(r"<arg\b[^<>]*?\bname\s*=\s*[\"']([^\"'<>]+)[\"']")


def find_passing_files(launch: Launch, argument: str) -> list[Path]:
    """Return the XML launch files of the project whose includes pass an argument to a launch file, by its name, which may be
    computed there."""
    passing = _read_includes(find_project_folder(launch.path), launch.finder)
    own, package = launch.path.name, "" if launch.package is None else launch.package.name
    return [
        path
        for path, includes in passing.items()
        if any(
            argument in names and may_become(typed, own) and _may_be_package(named, package, launch.finder)
            for named, typed, names in includes
        )
    ]


def _may_be_package(named: str, own: str, finder: PackageFinder) -> bool:
    """Whether an include may mean the package of a file: by its name, without one, or by an old name, which is of no package."""
    return not named or not own or named == own or finder.find(named) is None


@lru_cache(maxsize=1)  # a run asks for each launch file of a project
def _read_includes(folder: Path, finder: PackageFinder) -> Mapping[Path, list[tuple[str, str, frozenset[str]]]]:
    """Return for each launch file the package, where it is typed, and the file that its includes name, and what they pass."""
    found: dict[Path, list[tuple[str, str, frozenset[str]]]] = {}
    files = (path for path in iter_launch_files(folder, finder) if path.suffix != ".py")
    for path in itertools.islice(files, _MOST_LAUNCHES):
        text = COMMENT.sub("", read_text_or_nothing(path, _MOST_BYTES))
        for attributes, inside in _INCLUDE.findall(text):
            file = _FILE.search(attributes)
            if file is not None:
                found.setdefault(path, []).append((file[1] or "", file[2], frozenset(_PASSED.findall(inside))))
    return found
