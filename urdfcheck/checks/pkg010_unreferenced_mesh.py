"""PKG010 reports mesh files of a package that nothing names."""

from __future__ import annotations

import fnmatch
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from urdfcheck.core import FactUnavailableError, Finding, Location, Rule
from urdfcheck.core.text import join_names
from urdfcheck.source.package.finder import Package
from urdfcheck.source.package.references import (
    MESH_SUFFIXES,
    has_unreachable_users,
    iter_file_texts,
    list_other_folders,
    read_package_contents,
)

_SUFFIX = re.compile(rf"(?:{'|'.join(map(re.escape, MESH_SUFFIXES))})\b", re.IGNORECASE)
# What stands around a path, in which there may be blanks, and how long it may be.
_PATH_DELIMITERS = re.compile(r"""["'<>\n]""")
_MAX_PATH_LENGTH = 500
_FILENAME = re.compile(r"""filename\s*=\s*["']([^"'<>\n]*)["']""")
_EXPRESSION = re.compile(r"\$?\{[^{}]*\}|\$\([^()]*\)|%[sd]")
# How often a pattern is compared with a mesh; what would need more may name them all.
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
    # Where nothing names any of them, they are there for packages that are not at hand.
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
        listed=join_names([mesh.as_posix() for mesh in unnamed], 4),
        count=len(unnamed),
        total=len(contents.meshes),
        size=f"{sum(sizes) / 1e6:.1f} MB" if sum(sizes) >= 50_000 else f"{sum(sizes)} bytes",
    )


def _get_file_size(path: Path) -> int:
    return path.stat().st_size if path.is_file() else 0


def _find_unreferenced_meshes(meshes: Iterable[Path], package: Package) -> list[Path]:
    """The meshes whose name stands in no text, and that no path with expressions in it can mean."""
    left = list(meshes)
    for folder in (package.path, *list_other_folders(package)):
        if left:
            left = _filter_unreferenced(left, iter_file_texts(package, folder))
    return left


def _filter_unreferenced(meshes: Sequence[Path], texts: Iterable[str]) -> list[Path]:
    names: set[str] = set()
    patterns: set[str] = set()
    for text in texts:
        for match in _SUFFIX.finditer(text):
            before = text[max(match.start() - _MAX_PATH_LENGTH, 0) : match.start()]
            _add_reference(_PATH_DELIMITERS.split(before)[-1] + match.group(0), names, patterns)
        for path in _FILENAME.findall(text):
            if "$" in path and not path.lower().endswith(MESH_SUFFIXES):  # the suffix is only computed
                _add_reference(path[:_MAX_PATH_LENGTH], names, patterns)
    left = [mesh for mesh in meshes if mesh.name not in names]
    if len(patterns) * len(left) > _MAX_COMPARISONS:
        return []
    return [mesh for mesh in left if not any(fnmatch.fnmatchcase(f"/{mesh.as_posix()}", p) for p in patterns)]


def _add_reference(path: str, names: set[str], patterns: set[str]) -> None:
    """Note what a path means: the name of a file, or where expressions stand in it all that fit."""
    plain = _EXPRESSION.sub("*", path.replace("\\", "/"))
    name = plain.rpartition("/")[2]
    if "*" not in name and name.lower() not in MESH_SUFFIXES:
        names |= {name, name.split()[-1]}
        return
    # What stands before the folder in the package (a scheme, the package, `..`) is no part of the pattern.
    _, _, inside = plain.rpartition("://")
    parts = [part for part in inside.split("/") if part not in {"", ".", ".."}]
    folders = parts[1:-1] if "://" in plain or plain.startswith("*") else parts[:-1]
    last = parts[-1] if parts else "*"
    last = last if "*" in last else f"*{last}"
    if last.strip("*") or folders:
        patterns.add("*/" + "/".join((*folders, last)))
