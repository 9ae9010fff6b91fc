"""What a path of the command line that does not exist may have been meant for."""

from __future__ import annotations

import os
import re
from pathlib import Path

from urdfcheck.core.text import format_argument_option

# An argument as xacro and ros2 launch take it.
_ARGUMENT = re.compile(r"(?<!\w)[A-Za-z_]\w*:=")
# How similar a name must be to the one that is meant: two letters of nine may differ.
_LIKENESS = 0.75
# So many names of a folder are compared.
_MOST_NAMES = 2_000


def explain_missing_path(path: Path) -> str:
    """Say that a path does not exist, and what was probably meant: an argument of a xacro file, or a path with a similar name.

    The path is in reach, and so are the folders on the way to what is missing in it.
    """
    text = str(path)
    if _ARGUMENT.match(text):
        name, _, value = text.partition(":=")
        return f"does not exist; write `{format_argument_option(name, value)}` for an argument of xacro"
    meant = _find_similar_path(path)
    return "does not exist" if meant is None else f"does not exist (did you mean {str(meant)!r}?)"


def _find_similar_path(path: Path) -> Path | None:
    """Return the path that exists and whose names are those of another one, or similar to them; None for a link to nothing."""
    here = Path(path.anchor)
    for name in path.parts[1 if path.anchor else 0 :]:
        if not os.path.lexists(here / name):
            similar = _find_similar_name(name, here)
            if similar is None:
                return None
            name = similar  # noqa: PLW2901
        here /= name
    return None if here == path else here


def _find_similar_name(name: str, folder: Path) -> str | None:
    import difflib  # few names are misspelt

    try:
        with os.scandir(folder) as entries:
            names = [entry.name for _, entry in zip(range(_MOST_NAMES), entries, strict=False)]
    except OSError:
        return None
    same = [other for other in sorted(names) if other.lower() == name.lower()]
    # The suffix makes short names look alike: `a.urdf` is not `b.urdf`.
    stem, dot, _ = name.partition(".")
    stems = {other: other.partition(".")[0] for other in sorted(names) if not other.startswith(".")}
    near = difflib.get_close_matches(stem, set(stems.values()), n=1, cutoff=_LIKENESS)
    found = [other for other, own in stems.items() if near and own == near[0] and ("." in other) == bool(dot)]
    return next(iter([*same, *difflib.get_close_matches(name, found, n=1, cutoff=_LIKENESS)]), None)
