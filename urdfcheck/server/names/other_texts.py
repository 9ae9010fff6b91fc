"""Where files that no robot is known to use have a name as a word: a renaming leaves them as they are, and says so."""

from __future__ import annotations

import os
import re
from collections.abc import Container, Iterator, Mapping
from pathlib import Path

from urdfcheck.export.index.source_index import DoubtfulName
from urdfcheck.source.package.file_kinds import SRDF_SUFFIXES, YAML_SUFFIXES
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.package.package_folders import BUILD_FOLDERS, list_subfolders
from urdfcheck.source.project_folders import find_project_folder
from urdfcheck.source.reach import FileReach
from urdfcheck.source.text.xml import SourceFile, XmlError

_SUFFIXES = (*SRDF_SUFFIXES, *YAML_SUFFIXES, ".rviz")
_MOST_FOLDERS = 500
_DOUBT = "the file may be about another robot"


def list_other_texts(names: Mapping[tuple[str, str], str], path: Path, known: Container[str]) -> list[DoubtfulName]:
    """Return the first place of each name in each such file, those in files that are called like the model first.

    ``names``: by kind and old name; ``path``: the file in which one renames; ``known``: real paths of the files that need not be
    read.
    """
    reach = FileReach.from_paths([path], [])
    found = [
        text
        for file in _iter_files(find_project_folder(path))
        if os.path.realpath(file) not in known and reach.can_open(file)
        for text in _find_names(file, names)
    ]
    stem = path.name.partition(".")[0]
    return sorted(found, key=lambda text: (not _is_called_like(text, stem), text.span.file))


def _is_called_like(text: DoubtfulName, stem: str) -> bool:
    return any(
        part.partition(".")[0] and stem.startswith(part.partition(".")[0]) for part in Path(text.span.file).parts
    )


def _iter_files(folder: Path) -> Iterator[Path]:
    waiting, left = [folder], _MOST_FOLDERS
    while waiting and left:
        here, left = waiting.pop(), left - 1
        try:
            names = sorted(os.listdir(here))
        except OSError:
            continue
        yield from (here / name for name in names if name.lower().endswith(_SUFFIXES) and not name.startswith("."))
        waiting += [
            inner for inner in list_subfolders(here) if inner.name not in BUILD_FOLDERS and not inner.is_symlink()
        ]


def _find_names(path: Path, names: Mapping[tuple[str, str], str]) -> Iterator[DoubtfulName]:
    """Yield the first place of each name, as far as no comment of yaml is before it in its line."""
    try:
        file = SourceFile.read(path, format_path(path), declares=False)
    except (OSError, XmlError):
        return
    for kind, name in names:
        match = re.search(rf"^[^#\n]*?(?<![\w./$-])({re.escape(name)})(?![\w.-])", file.text, re.MULTILINE)
        if match is not None:
            yield DoubtfulName(kind, name, file.make_span(match.start(1), match.end(1)), _DOUBT)
