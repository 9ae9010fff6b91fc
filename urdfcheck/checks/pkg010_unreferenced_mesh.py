"""PKG010 reports mesh files of a package that no text mentions."""

from __future__ import annotations

import fnmatch
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from urdfcheck.core import FactUnavailableError, Finding, Location, Rule
from urdfcheck.core.text import join_names
from urdfcheck.source.package.file_kinds import MESH_SUFFIXES
from urdfcheck.source.package.finder import Package
from urdfcheck.source.package.references import (
    has_unreachable_users,
    iter_file_texts,
    list_other_folders,
    read_package_contents,
)
from urdfcheck.system.observing.questions import note_content

_SUFFIX = re.compile(rf"(?:{'|'.join(map(re.escape, MESH_SUFFIXES))})\b", re.IGNORECASE)
# A path ends at one of these, not at a blank, and has at most so many characters.
_PATH_DELIMITERS = re.compile(r"""["'<>\n]""")
_MAX_PATH_LENGTH = 500
_FILENAME = re.compile(r"""filename\s*=\s*["']([^"'<>\n]*)["']""")
_EXPRESSION = re.compile(r"\$?\{[^{}]*\}|\$\([^()]*\)|%[sd]")
# With more comparisons of patterns and meshes, all meshes count as named.
_MAX_COMPARISONS = 500_000


def check(package: Package, rule: Rule) -> Iterator[Finding]:
    if not package.is_fully_checked:
        return
    contents = read_package_contents(package)
    if not contents.meshes:
        return
    try:
        unnamed = _find_unreferenced_meshes(contents.meshes, package)
    except LookupError:
        raise FactUnavailableError("the packages have too many files to look through") from None
    # Meshes that nothing names at all are there for packages that are not at hand.
    if not contents.complete or not unnamed or len(unnamed) == len(contents.meshes) or has_unreachable_users(package):
        return
    sizes = [_get_file_size(package.path / mesh) for mesh in unnamed]
    root = package.root
    where = None if root is None else root.find_child("name") or root
    yield rule.finding(
        "one" if len(unnamed) == 1 else "several",
        at=Location(f"package[{package.name}]", None if where is None else where.span),
        package=package.name,
        files=[mesh.as_posix() for mesh in unnamed],
        listed=join_names((mesh.as_posix() for mesh in unnamed), 4),
        count=len(unnamed),
        total=len(contents.meshes),
        size=f"{sum(sizes) / 1e6:.1f} MB" if sum(sizes) >= 50_000 else f"{sum(sizes)} bytes",
    )


def _get_file_size(path: Path) -> int:
    if not path.is_file():
        return 0
    status = path.stat()
    note_content(path, status)
    return status.st_size


def _find_unreferenced_meshes(meshes: Iterable[Path], package: Package) -> list[Path]:
    """Return the meshes that no text names and no path with expressions can mean."""
    unnamed = list(meshes)
    for folder in (package.path, *list_other_folders(package)):
        if unnamed:
            unnamed = _filter_unreferenced(unnamed, iter_file_texts(package, folder))
    return unnamed


def _filter_unreferenced(meshes: Sequence[Path], texts: Iterable[str]) -> list[Path]:
    names: set[str] = set()
    patterns: set[str] = set()
    for text in texts:
        for match in _SUFFIX.finditer(text):
            before = text[max(match.start() - _MAX_PATH_LENGTH, 0) : match.start()]
            _add_reference(_PATH_DELIMITERS.split(before)[-1] + match.group(0), names, patterns)
        for path in _FILENAME.findall(text):
            if "$" in path and not path.lower().endswith(MESH_SUFFIXES):  # the suffix may be computed
                _add_reference(path[:_MAX_PATH_LENGTH], names, patterns)
    unnamed = [mesh for mesh in meshes if mesh.name not in names]
    if len(patterns) * len(unnamed) > _MAX_COMPARISONS:
        return []
    return [mesh for mesh in unnamed if not any(fnmatch.fnmatchcase(f"/{mesh.as_posix()}", p) for p in patterns)]


def _add_reference(path: str, names: set[str], patterns: set[str]) -> None:
    """Add the file name of a path to ``names``, or a path with expressions to ``patterns``."""
    plain = _EXPRESSION.sub("*", path.replace("\\", "/"))
    name = plain.rpartition("/")[2]
    if "*" not in name and name.lower() not in MESH_SUFFIXES:
        names |= {name, name.split()[-1]}
        return
    # The pattern begins at the folder in the package, without the scheme, the package and `..`.
    _, _, inside = plain.rpartition("://")
    parts = [part for part in inside.split("/") if part not in {"", ".", ".."}]
    folders = parts[1:-1] if "://" in plain or plain.startswith("*") else parts[:-1]
    last = parts[-1] if parts else "*"
    last = last if "*" in last else f"*{last}"
    if last.strip("*") or folders:
        patterns.add("*/" + "/".join((*folders, last)))
