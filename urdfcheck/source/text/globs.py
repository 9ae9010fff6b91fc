"""Patterns for paths, matched in time linear in their length: they may be a stranger's."""

from __future__ import annotations

import os
from collections.abc import Iterable
from fnmatch import fnmatchcase
from pathlib import Path


def split_relative_path(path: Path, root: Path) -> tuple[str, ...] | None:
    """Return the names of the folders from ``root`` to a file, and the file's name; None if it is not below ``root``.

    Links are resolved first, apart from one that leads nowhere: it counts where it lies.
    """
    try:
        real = os.path.realpath(path)
        if os.path.islink(path) and not os.path.exists(real):
            real = os.path.join(os.path.realpath(path.parent), path.name)
        names = Path(os.path.relpath(real, os.path.realpath(root))).parts
    except ValueError:  # another drive, or a NUL
        return None
    return None if names[:1] == ("..",) else names


def match_any_pattern(patterns: Iterable[str], names: tuple[str, ...] | None) -> bool:
    """Whether one of the patterns matches a file or a folder around it.

    ``*`` and ``?`` match within one name, ``**`` any number of folders; a pattern without a slash matches in every folder.
    """
    return names is not None and any(_match_pattern(pattern, names) for pattern in patterns)


def _match_pattern(pattern: str, names: tuple[str, ...]) -> bool:
    wanted = [part for part in pattern.split("/") if part not in {"", "."}]
    if not wanted:
        return False
    if "/" not in pattern.rstrip("/"):
        wanted = ["**", *wanted]

    def expand_states(states: Iterable[int]) -> set[int]:
        """Add the states that skipping a ``**`` leads to."""
        expanded: set[int] = set()
        for state in states:
            end = state
            while end < len(wanted) and wanted[end] == "**":
                end += 1
            expanded.update(range(state, end + 1))
        return expanded

    # How many parts of the pattern the names so far can have used: each number once, however many ways lead to it.
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
