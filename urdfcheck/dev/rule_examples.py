"""The examples under Bad and Good on the page of a rule, as files that can be checked."""

from __future__ import annotations

import re

_FENCE = re.compile(r"^```(\w+)(?: file=(\S+))?[ ]*\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_SUFFIX = {"urdf": ".urdf", "xacro": ".urdf.xacro", "launch": ".launch"}

Files = tuple[tuple[str, str], ...]


def _find_section(page: str, heading: str) -> str:
    """Return the text of a page below a heading of the second level, up to the next one; empty without that heading."""
    match = re.search(rf"^## {heading}\n(.*?)(?=^## |\Z)", page, re.MULTILINE | re.DOTALL)
    return match.group(1) if match else ""


def list_examples(page: str, heading: str) -> list[Files]:
    """Return the files of each example below a heading, as pairs of path and text.

    Each fenced block is one robot. Fences with ``file=`` form one tree of files; a line ``---`` between two fences
    begins the next tree.
    """
    found: list[Files] = []
    for part in re.split(r"^---$", _find_section(page, heading), flags=re.MULTILINE):
        tree: list[tuple[str, str]] = []
        for language, name, text in _FENCE.findall(part):
            if name:
                tree.append((name, text))
            elif language in _SUFFIX:
                xacro = language == "urdf" and "xmlns:xacro" in text
                found.append((("robot" + (".urdf.xacro" if xacro else _SUFFIX[language]), text),))
        if tree:
            found.append(tuple(tree))
    return found
