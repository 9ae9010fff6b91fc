"""sdformat, Gazebo's parser, through the function that the command ``gz sdf --check`` calls."""

from __future__ import annotations

import ctypes
import os
import re
from collections.abc import Iterator

from printed import capture_lines

# Libraries of Gazebo 11 to the newest.
NAMES = [f"lib{vendor}sdformat{number}.so.{number}" for number in range(20, 8, -1) for vendor in ("", "gz-")]
_COLOUR = re.compile(r"\x1b\[[\d;]*m")
_LINE = re.compile(r"(Error|Warning)\b(?: Code \d+: Msg)?:?\s*(?:\[\w+\.\w+:\d+\]:?)?\s*", re.IGNORECASE)


def _load_library() -> ctypes.CDLL:
    for name in NAMES:
        try:
            return ctypes.CDLL(name)
        except OSError:
            continue
    raise OSError("no libsdformat")


LIBRARY = _load_library()


def ask(file: str) -> Iterator[tuple[str, str, str, str]]:
    """Yield its errors and warnings, and that it refuses the file."""
    with capture_lines() as lines:
        failed = LIBRARY.cmdCheck(os.fsencode(file)) != 0
    for line in (_COLOUR.sub("", line) for line in lines):
        named = _LINE.match(line)
        if named:
            yield named[1].lower(), "line", "", line[named.end() :] or line
    if failed:
        yield "error", "refused", "", "the check fails"
