"""The packages and files that a path in a text may lead to: what can be typed next."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path

from urdfcheck.core.records import dataclass
from urdfcheck.source.package.file_kinds import MESH_SUFFIXES, MODEL_SUFFIXES
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.reach import FileReach

_PACKAGE = "package://"
# It reads no such address.
_INCLUDE = "xacro:include"
# A path in a package: what stands before its name, the name, and the path in it as far as it is typed.
_IN_PACKAGE = re.compile(r"(?:package://|(?:file://)?\$\(find\s+)([^()\s/]+)(?:\)/|(?<!\))/)(.*)", re.DOTALL)
_BEGUN_PACKAGE = re.compile(r"(?:package://|.*\$\(find\s+)[^()\s/]*", re.DOTALL)
# What files an attribute names; a path without a package begins beside the file.
_SUFFIXES = {
    "mesh": MESH_SUFFIXES,
    "texture": (".png", ".jpg", ".jpeg", ".tga", ".bmp"),
    _INCLUDE: MODEL_SUFFIXES,
}
_MOST_NAMES = 500


@dataclass(frozen=True, slots=True)
class PathPart:
    """The name of a package, a folder or a file."""

    name: str
    is_folder: bool
    inserted: str


def iter_path_parts(tag: str, attribute: str, typed: str, document: Path, reach: FileReach) -> Iterator[PathPart]:
    """Yield what may follow behind the last separator of a path in an attribute.

    ``typed``: the value before the cursor. Only files of the attribute's kind are listed, and only what may be opened.
    """
    names_file = tag in _SUFFIXES and attribute == "filename"
    if not names_file and _PACKAGE not in typed and "$(find" not in typed:
        return
    finder = PackageFinder(document, reach=reach)
    if _BEGUN_PACKAGE.fullmatch(typed):
        end = "/" if typed.startswith(_PACKAGE) else ")"
        yield from (PathPart(name, True, name + end) for name in sorted(finder.list_packages())[:_MOST_NAMES])
        return
    match = _IN_PACKAGE.fullmatch(typed)
    if match is not None:
        folder = finder.find(match[1])
    else:
        folder = document.parent if names_file and "$" not in typed and "://" not in typed else None
        if names_file and tag != _INCLUDE and _PACKAGE.startswith(typed):
            yield PathPart(_PACKAGE, True, _PACKAGE)
    inner = (typed if match is None else match[2]).rpartition("/")[0]
    if folder is not None and "$" not in inner and not os.path.isabs(inner):
        yield from _iter_entries(folder / inner, _SUFFIXES.get(tag, ()), finder)


def _iter_entries(folder: Path, suffixes: tuple[str, ...], finder: PackageFinder) -> Iterator[PathPart]:
    """Yield the folders and files of a folder; of files those with one of the suffixes, or all where none is given."""
    try:
        names = (
            sorted(name for name in os.listdir(folder) if not name.startswith(".")) if finder.can_open(folder) else []
        )
    except OSError:
        return
    for name in names[:_MOST_NAMES]:
        place = folder / name
        if not finder.can_open(place):
            continue
        if os.path.isdir(place):
            yield PathPart(name, True, f"{name}/")
        elif not suffixes or name.lower().endswith(suffixes):
            yield PathPart(name, False, name)
