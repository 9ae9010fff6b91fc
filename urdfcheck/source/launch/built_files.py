"""Files that a launch file or a model names and that no checkout has, because a build or a program makes them."""

from __future__ import annotations

import re
from pathlib import Path

from urdfcheck.source.package.package_folders import iter_package_texts
from urdfcheck.source.reach import FileReach
from urdfcheck.source.text.globs import match_any_pattern, split_relative_path
from urdfcheck.system.files import read_text_or_nothing, walk

# Limit on the patterns of one .gitignore that are read.
MAX_PATTERNS = 1_000
# What a build calls that makes a file out of another.
_MAKES_FILES = re.compile(r"xacro_add_|add_custom_|execute_process|configure_file|subprocess|os\.system|process_file")

# What a script or a build writes with xacro: `xacro ${robot}.urdf.xacro > ${robot}.urdf`, `OUTPUT ${CMAKE_BINARY_DIR}/arm.urdf`.
_WRITTEN = re.compile(
    r"""xacro\b[^\n]{0,300}?(?:>|\s-o|--output)[\s=]*["']?(?P<written>[^\s"'|;&()<>]+)|\bOUTPUT\s+["']?(?P<output>[^\s"'()]+)"""
)
_XACRO_ADDED = re.compile(r"xacro_add_\w+\s*\(([^()]*)\)")
# What the names of templates end with: those of CMake, and those of empy, which catkin expands.
_TEMPLATES = (".in", ".em")
# What the shell, CMake or Python puts into a name.
_FILLED_IN = re.compile(r"\$?\{[^{}]*\}|\$\w+|%s")


def find_maker(path: Path, package: Path, reach: FileReach) -> Path | None:
    """Return the script or build file of a package that writes a missing model with xacro, under its name or a computed one.

    A name that is computed whole may be any: then the package has a xacro file of the missing one's name.
    """
    stem = path.name.partition(".")[0]
    for file, text in iter_package_texts(package, reach.can_open):
        if file.name != "CMakeLists.txt" and file.suffix not in {".sh", ".py"}:
            continue
        names = {Path(name).name for match in _WRITTEN.finditer(text) for name in match.groups() if name}
        patterns = {name: ".*".join(map(re.escape, _FILLED_IN.split(name))) for name in names if name}
        written = [name for name, pattern in patterns.items() if re.fullmatch(pattern, path.name)]
        is_added = any(f"{path.name}.xacro" in added for added in _XACRO_ADDED.findall(text))
        if is_added or any(_FILLED_IN.sub("", name).partition(".")[0] for name in written):
            return file
        if written and _has_xacro_file(stem, package):
            return file
    return None


def _has_xacro_file(stem: str, package: Path) -> bool:
    return any(
        name.endswith(".xacro") and name.partition(".")[0] == stem for _, _, files in walk(package) for name in files
    )


def may_be_built(path: Path, package: Path, suffixes: tuple[str, ...]) -> bool:
    """Whether a package's build or a program of its own may make or install a missing file.

    It may if the build mentions the name, if git ignores it, or if the package has a template of it, or a file of that name with
    other suffixes and a build that makes files.
    """
    reach = FileReach.from_paths([package], [])
    places = [package / name for name in ("CMakeLists.txt", "setup.py")]
    builds = [read_text_or_nothing(place) for place in places if reach.can_open(place)]
    if any(path.name in text for text in builds) or is_git_ignored(path, reach):
        return True
    makes_files = any(map(_MAKES_FILES.search, builds))
    stem = path.name.partition(".")[0]
    for _, names, files in walk(package):
        names[:] = [n for n in names if not n.startswith(".")]
        alike = [file for file in files if any(suffix in file.lower() for suffix in suffixes)]
        if f"{path.name}.in" in alike or (makes_files and any(file.partition(".")[0] == stem for file in alike)):
            return True
    return False


def find_template(path: Path, package: Path) -> Path | None:
    """Return the file of a package of which a build makes a missing one: ``car.launch.in`` of ``car.launch``."""
    for here, names, files in walk(package):
        names[:] = [n for n in names if not n.startswith(".")]
        for ending in _TEMPLATES:
            if path.name + ending in files:
                return Path(here, path.name + ending)
    return None


def is_git_ignored(path: Path, reach: FileReach) -> bool:
    """Whether a ``.gitignore`` around a file names it: then it is made, and no checkout has it."""
    ignored = False
    # A hidden file is never in reach; this one is, unless it is a link to elsewhere.
    folders = [f for f in path.parents if reach.can_open(f) and not (f / ".gitignore").is_symlink()]
    for folder in reversed(folders):  # the last pattern that fits decides, in the innermost file
        names = split_relative_path(path, folder)
        for line in read_text_or_nothing(folder / ".gitignore").splitlines()[:MAX_PATTERNS]:
            pattern = line.strip().removeprefix("!")
            if pattern and not pattern.startswith("#") and match_any_pattern([pattern], names):
                ignored = not line.strip().startswith("!")
    return ignored
