"""The distributions of ROS that a repository says it is for."""

from __future__ import annotations

import re
from pathlib import Path

from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.project_folders import find_project_folder
from urdfcheck.system.files import read_regular

_README_NAMES = ("README.md", "readme.md", "Readme.md", "README.rst", "README.txt", "README")
_BEFORE_NOETIC = re.compile(r"\b(?:groovy|hydro|indigo|jade|kinetic|lunar|melodic)\b", re.IGNORECASE)
_SINCE_NOETIC = re.compile(r"\b(?:noetic|ROS ?2|foxy|galactic|humble|jazzy|kilted|rolling)\b", re.IGNORECASE)
_LARGEST = 1_000_000


def is_only_before_noetic(finder: PackageFinder) -> bool:
    """Whether a README of the project, around the start of a finder or of its packages, names ROS before Noetic, and none
    anything later."""
    project = find_project_folder(finder.start)
    packages = (folder for folder in finder.list_packages().values() if folder.is_relative_to(project))
    folders = dict.fromkeys([*finder.list_parent_folders(), *packages])
    text = "\n".join(_read_readme(folder, finder) for folder in folders)
    return _BEFORE_NOETIC.search(text) is not None and _SINCE_NOETIC.search(text) is None


def _read_readme(folder: Path, finder: PackageFinder) -> str:
    for path in (folder / name for name in _README_NAMES):
        try:
            if finder.can_open(path):
                return read_regular(path, _LARGEST).decode("utf-8", "replace")
        except OSError:
            continue
    return ""
