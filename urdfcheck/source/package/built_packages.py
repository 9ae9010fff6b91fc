"""Packages as a build tool sees them: which ones it leaves out, and which have the name of another one."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from itertools import takewhile
from pathlib import Path

from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.package.package_folders import BUILD_FOLDERS, IGNORE_MARKS
from urdfcheck.source.project_folders import is_shared_by_all, list_shared_folders
from urdfcheck.system.files import read_regular

# Folders that colcon and catkin do not search.
_SKIPPED = BUILD_FOLDERS | {"build_isolated", "devel", "devel_isolated", "install_isolated", "node_modules"}
# A numbered part of a book or a course.
_SERIES = re.compile(
    r"(?<![a-z])(?:chapter|ch|day|exercise|lab|lecture|lesson|part|section|session|step|tutorial|unit|week)[ _-]?\d",
    re.IGNORECASE,
)
_GIT_FOLDER = re.compile(r"gitdir:\s*([^\0\n]+?)[/\\]worktrees[/\\]")


def is_out_of_build(folder: Path, finder: PackageFinder | None) -> bool:
    """Whether a package of the repository is inside another one, or a mark at it or above it says that it is not built.

    ``folder``: the package's.
    """
    if _is_inside_another(folder, finder):
        return True
    top = None if finder is None else finder.find_repository()
    folder, around = folder.absolute(), takewhile(lambda outer: outer != top, folder.absolute().parents)
    levels = [folder] if top is None else [folder, *around]
    return any(os.path.lexists(level / mark) for level in levels for mark in IGNORE_MARKS)


def select_rivals(own: Path, folders: Sequence[Path]) -> list[Path]:
    """Return those of the folders with a package's name that are other packages for a build tool that sees both.

    Not among them: the same folder by another path, what was built or installed, what a build tool passes over or never sees
    (it does not look for packages in a package), and the same package in other work trees of its repository.
    """
    found: dict[str, Path] = {}
    for folder in folders:
        real = os.path.realpath(folder)
        if real != os.path.realpath(own) and real not in found and _is_rival(own, folder):
            found[real] = folder
    return list(found.values())


def are_of_series(folders: Sequence[Path]) -> bool:
    """Whether folders are the same one in the numbered parts of a book or a course (`chapter_2/arm`, `chapter_3/arm`), which
    are built one at a time."""
    absolute = [folder.absolute() for folder in folders]
    common = Path(os.path.commonpath(absolute))
    parts = [folder.relative_to(common).parts for folder in absolute]
    return all(map(_has_series_number, parts)) and len({re.sub(r"\d+", "", "/".join(names)) for names in parts}) == 1


def are_in_one_workspace(folders: Sequence[Path]) -> bool:
    """Whether packages are beside each other or below one folder ``src``; others may be copies that are built alone."""
    absolute = [folder.absolute() for folder in folders]
    return len({folder.parent for folder in absolute}) == 1 or "src" in Path(os.path.commonpath(absolute)).parts


def _is_inside_another(folder: Path, finder: PackageFinder | None) -> bool:
    """Whether a package is in the folder of another one of the repository: build tools and rosdep do not look there.

    A manifest at the top of the repository does not count: its other packages are probably copied from there, each by itself.
    """
    if finder is None:
        return False
    top, shared = finder.find_repository(), list_shared_folders()
    around = takewhile(lambda outer: outer != top and not is_shared_by_all(outer, shared), folder.absolute().parents)
    manifests = (outer / "package.xml" for outer in around)
    return any(finder.can_open(manifest) and manifest.is_file() for manifest in manifests)


def _has_series_number(parts: Sequence[str]) -> bool:
    return bool(parts) and _SERIES.search(parts[0]) is not None


def _is_rival(own: Path, other: Path) -> bool:
    common = Path(os.path.commonpath([own, other]))
    if common not in (own, other) and any(map(_has_manifest, (common, *common.parents))):
        return False
    for folder in (own, other):
        between = [folder, *folder.parents][: len(folder.relative_to(common).parts)]
        copied = folder.parent.name == "share"  # PREFIX/share/NAME
        ignored = any(os.path.lexists(level / mark) for level in between for mark in IGNORE_MARKS)
        inside = any(_has_manifest(level) for level in between[1:] if level != common)
        if copied or ignored or inside or any(level.name in _SKIPPED for level in between):
            return False
    place = _find_place_in_repository(own)
    return place is None or place != _find_place_in_repository(other)


def _has_manifest(folder: Path) -> bool:
    return os.path.lexists(folder / "package.xml")


def _find_place_in_repository(folder: Path) -> tuple[str, str] | None:
    """Return the repository that a folder is checked out from, and its path there; None outside one."""
    top = next((level for level in (folder, *folder.parents) if os.path.lexists(level / ".git")), None)
    if top is None:
        return None
    mark = top / ".git"
    try:
        match = None if mark.is_dir() else _GIT_FOLDER.match(read_regular(mark, 10_000).decode("utf-8", "replace"))
    except OSError:
        match = None
    shared = mark if match is None else top / match.group(1)
    return os.path.realpath(shared), os.path.relpath(folder, top)
