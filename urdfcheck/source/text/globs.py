"""Patterns for paths, in time that grows with their length and no faster: they may be a stranger's."""

from __future__ import annotations

import os
from collections.abc import Iterable
from fnmatch import fnmatchcase
from pathlib import Path


def split_relative_path(path: Path, root: Path) -> tuple[str, ...] | None:
    """The names of the folders from ``root`` to a file, and its own; None where it is not below. A file counts by where it
    really is."""
    try:
        names = Path(os.path.relpath(os.path.realpath(path), os.path.realpath(root))).parts
    except ValueError:  # another drive, or a NUL
        return None
    return None if names[:1] == ("..",) else names


def match_any_pattern(patterns: Iterable[str], names: tuple[str, ...] | None) -> bool:
    """Whether one of the patterns means a file, or a folder that it lies in. ``*`` and ``?`` stand for anything in one name,
    ``**`` for any number of folders; a pattern without a slash means that name in every folder."""
    return names is not None and any(_match_pattern(pattern, names) for pattern in patterns)


def _match_pattern(pattern: str, names: tuple[str, ...]) -> bool:
    wanted = [part for part in pattern.split("/") if part not in {"", "."}]
    if not wanted:
        return False
    if "/" not in pattern.rstrip("/"):
        wanted = ["**", *wanted]

    def expand_states(states: Iterable[int]) -> set[int]:
        found: set[int] = set()
        for state in states:
            found.add(state)
            while state < len(wanted) and wanted[state] == "**":
                state += 1
                found.add(state)
        return found

    # How much of the pattern the names so far can have used up: each number once, however many ways lead to it.
    states = expand_states({0})
    for name in names:
        if len(wanted) in states:
            return True
        states = expand_states(
            state if wanted[state] == "**" else state + 1
            for state in states
            if wanted[state] == "**" or fnmatchcase(name, wanted[state])
        )
    return len(wanted) in states
