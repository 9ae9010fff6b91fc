"""The folders with a package.xml at and below a folder."""

from __future__ import annotations

import contextlib
import itertools
import os
import re
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

from urdfcheck.source.package.file_kinds import is_model
from urdfcheck.system.files import read_regular, record_reads, remember_large_folders, walk

# How many folders of one folder are looked into.
MAX_SIBLINGS = 2_000
BUILD_FOLDERS = frozenset({"build", "install", "log", "build_isolated", "devel_isolated", "install_isolated"})
# Folders of files that are kept and not used; those of raw data have what an exporter wrote, of which the robot's files are made.
_ASIDE_FOLDERS = frozenset(
    {"archive", "backup", "bak", "not_used", "old", "raw", "raw_data", "raw_export", "raw_exports"}
)
# Folders of what others made: a project uses of it what its own files name. Isaac Gym is a download that projects keep whole.
_FOREIGN_FOLDERS = frozenset(
    {"3rd-party", "3rd_party", "3rdparty", "isaacgym", "third-party", "third_party", "thirdparty", "vendor"}
)
# How longer names of such folders begin: `legacy_launch`, `old_files`.
_ASIDE_WORDS = frozenset({"archived", "backups", "deprecated", "legacy", "obsolete", "old", "unused"})
# What is added to the name of a file that is kept as it was, beside the one that is used.
_KEPT_COPY = re.compile(
    r"(?<=\w)(?:(?: - |[._ -])(?:backup|bak|copy|old|ori|orig|original)(?:[ _]?\d| \(\d+\))?"
    r"| ?\((?:(?:\w+ )?copy|\d+)\))(?=\.)",
    re.IGNORECASE,
)
# Which of these say that it is no longer used, whatever is beside it.
_OLD_STATE = re.compile(r"(?<=\w)[._-](?:backup|bak|old)(?=\.)", re.IGNORECASE)
# Folders of tests, by their names in lower case.
TEST_FOLDERS = frozenset({"test", "tests"})
# Files that tell colcon and catkin to leave out a folder with all below it.
IGNORE_MARKS = frozenset({"AMENT_IGNORE", "CATKIN_IGNORE", "COLCON_IGNORE"})
# Packages that are left out are searched for so many levels below the marked folder.
_LEVELS_LEFT_OUT = 4
# Of a package, so many texts of at most so many bytes are read.
_TEXTS = (".py", ".xml", ".launch", ".txt", ".cmake", ".in", ".dsv", ".sh", ".yaml", ".env", ".sdf", ".world")
_MOST_TEXTS, _LARGEST_TEXT = 300, 300_000
# A comment of XML, which ends with the text if nothing closes it, and a line of Python, CMake, YAML or a shell that is one.
_REMARK = re.compile(r"<!--.*?(?:-->|\Z)|^[ \t]*#[^\n]*", re.DOTALL | re.MULTILINE)
# The manifest of a package; rosbuild's has no name: there the folder's name is the package's.
_MANIFESTS = frozenset({"package.xml", "manifest.xml"})
_ROSBUILD = re.compile(r"<package[\s>]")
_NAME = re.compile(r"<name>\s*([^<\s]+)\s*</name>")
# The folders of each package, by its name.
PackagesByName = Mapping[str, Sequence[Path]]
# The folders in a folder, and whether each is a link.
_Subfolders = list[tuple[str, bool]]
# By folder, the name of the package at it (None without one) and the folders in it: what one search found there.
SearchedFolders = dict[str, tuple[str | None, _Subfolders]]


def is_aside_folder(name: str) -> bool:
    """Whether a folder of this name holds files that are kept and not used, or what others made."""
    name = name.lower()
    return name in _ASIDE_FOLDERS or name in _FOREIGN_FOLDERS or re.split(r"[\W_]", name)[0] in _ASIDE_WORDS


def get_used_name(name: str) -> str:
    """Return the name of the file of which one of this name is an old copy: ``arm.urdf`` of ``arm_ori.urdf``; else empty."""
    used = _KEPT_COPY.sub("", name, count=1)
    return "" if used == name else used


def is_old_state(name: str) -> bool:
    """Whether the name of a file says that another one is used by now: ``arm_old.urdf``."""
    return _OLD_STATE.search(name) is not None


def walk_packages(
    folder: Path,
    depth: int,
    allows: Callable[[Path], bool] = lambda _: True,
    *,
    most: int | None = None,
    searched: SearchedFolders | None = None,
) -> Iterator[tuple[str, Path]]:
    """Yield the packages at a folder and at most ``depth`` levels below it, the outer ones first; none inside another one
    below it.

    ``allows``: whether a link may be followed; ``most``: how many folders are looked into; ``searched``: what walks with the same
    ``allows`` found a moment ago, to which this one adds: those from a folder and from the one around it meet most folders twice.
    """
    searched = {} if searched is None else searched
    waiting = deque([(str(folder), 0)])
    count = 0
    while waiting and (most is None or count < most):
        here, level = waiting.popleft()
        count += 1
        if here not in searched:
            has_manifest, below = _list_folder(here)
            searched[here] = read_manifest_name(Path(here), allows) if has_manifest else None, below
        name, below = searched[here]
        if name:
            yield name, Path(here)
        if level < depth and not (name and level):
            for inner, is_link in below:
                place = os.path.join(here, inner)
                if inner not in BUILD_FOLDERS and (not is_link or allows(Path(place))):
                    waiting.append((place, level + 1))


def list_subfolders(path: Path) -> list[Path]:
    """Return the folders in a folder without hidden ones; none if it cannot be read."""
    return [path / name for name, _ in _list_folder(path)[1]]


def list_folders_called(name: str, root: Path) -> list[Path]:
    """Return the folders of a name below another one, without hidden ones."""
    found: list[Path] = []
    for here, folders, _ in walk(root):
        folders[:] = [folder for folder in folders if not folder.startswith(".")]
        if name in folders:
            found.append(Path(here, name))
    return found


def read_manifest_name(folder: Path, allows: Callable[[Path], bool] = lambda _: True) -> str | None:
    """Return the name in the package.xml of a folder, or the folder's own for a package of rosbuild.

    None where the manifest has none, or is a link that may not be followed.
    """
    text = _read_manifest(folder / "package.xml", allows)
    if text is None:
        return folder.name if is_rosbuild_package(folder, allows) else None
    match = _NAME.search(text)
    return match.group(1) if match else None


def is_rosbuild_package(folder: Path, allows: Callable[[Path], bool] = lambda _: True) -> bool:
    """Whether a folder has the manifest.xml of rosbuild and no package.xml: its name is then that of the package."""
    if os.path.lexists(folder / "package.xml"):
        return False
    return _ROSBUILD.search(_read_manifest(folder / "manifest.xml", allows) or "") is not None


def _read_manifest(manifest: Path, allows: Callable[[Path], bool]) -> str | None:
    """Return the text of a manifest; None if it cannot be read, or is a link that may not be followed."""
    if os.path.islink(manifest) and not allows(manifest):
        return None
    try:
        with record_reads():  # apart: of all packages that are searched, only the one that is found affects the result
            return read_regular(manifest).decode("utf-8", "replace")
    except OSError:
        return None


def find_nearest_folder(folders: Sequence[Path], start: Path) -> Path:
    """Return the folder that shares the most folders with ``start``; of equals, the first."""
    parts = start.parts

    def count_common(folder: Path) -> int:
        return next((n for n, (a, b) in enumerate(zip(folder.parts, parts, strict=False)) if a != b), len(parts))

    return max(folders, key=count_common)


def list_left_out_packages(folder: Path, allows: Callable[[Path], bool]) -> Iterator[tuple[Path, str]]:
    """Yield the packages with models in a marked folder, or the folder if it has models and no package; each with the name of
    the mark.

    ``allows``: whether a link may be followed.
    """
    if os.path.islink(folder) and not allows(folder):
        return
    mark = min((name for name in IGNORE_MARKS if os.path.lexists(folder / name)), default="")
    packages = [path for _, path in walk_packages(folder, _LEVELS_LEFT_OUT, allows, most=MAX_SIBLINGS)]
    for place in packages or [folder]:
        if _has_models(place):
            yield place, mark


def _has_models(folder: Path) -> bool:
    """Whether a file in a folder or below is named like a model; links are not followed."""
    below, left = [folder], MAX_SIBLINGS
    while below and left:
        here, left = below.pop(), left - 1
        try:
            if any(is_model(Path(name)) for name in os.listdir(here)):
                return True
        except OSError:
            continue
        below += [inner for inner in list_subfolders(here) if not inner.is_symlink()]
    return False


def _list_folder(path: str | Path) -> tuple[bool, _Subfolders]:
    """Return whether a folder has a manifest, and its folders without hidden ones; nothing if it cannot be read."""
    try:
        has_manifest, folders, links = _read_folder(path)
    except OSError:
        return False, []
    found = [(name, False) for name in folders]
    found += [(name, True) for name in links if os.path.isdir(os.path.join(path, name))]
    return has_manifest, sorted(found)[:MAX_SIBLINGS]


@remember_large_folders
def _read_folder(path: str) -> tuple[bool, Sequence[str], Sequence[str]]:
    """Read whether a folder has a manifest, and the names of its folders and of its links, without hidden ones."""
    has_manifest, folders, links = False, [], []
    with os.scandir(path) as entries:
        for entry in entries:
            has_manifest |= entry.name in _MANIFESTS
            if entry.name.startswith("."):
                continue
            with contextlib.suppress(OSError):  # what cannot be examined is not a folder, and does not hide the others
                if entry.is_symlink():
                    links.append(entry.name)
                elif entry.is_dir():
                    folders.append(entry.name)
    return has_manifest, folders, links


def read_package_texts(folder: Path, allows: Callable[[Path], bool], *, deep: bool = True) -> Iterator[str]:
    """Yield the texts of a package that say what it is used with: its manifest, build files, launch files,
    scripts, hooks and worlds.

    ``allows``: whether a path may be opened; ``deep``: whether the folders in it are read too.
    """
    for _, text in iter_package_texts(folder, allows, deep=deep):
        yield text


def iter_package_texts(
    folder: Path, allows: Callable[[Path], bool], *, deep: bool = True
) -> Iterator[tuple[Path, str]]:
    """Yield the same texts with the files that they are in."""
    for path in itertools.islice(_iter_texts(folder, deep=deep), _MOST_TEXTS) if allows(folder) else ():
        try:
            if allows(path):
                yield path, read_regular(path, _LARGEST_TEXT).decode("utf-8", "replace")
        except OSError:
            continue


def drop_comments(text: str) -> str:
    """Leave the comments out of such a text: generated manifests mention Gazebo in theirs."""
    return _REMARK.sub("", text)


def _iter_texts(folder: Path, *, deep: bool) -> Iterator[Path]:
    for here, inner, names in walk(folder):
        inner[:] = sorted(name for name in inner if deep and not name.startswith(".") and name not in BUILD_FOLDERS)
        yield from (Path(here, name) for name in sorted(names) if name.endswith(_TEXTS))
