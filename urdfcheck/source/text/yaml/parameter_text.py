"""Texts that ROS 2 reads as yaml, because nothing says that they are texts.

``launch_ros.utilities.evaluate_parameters`` hands the value of a parameter that is made of substitutions to PyYAML's
``yaml.safe_load`` (yaml 1.1) and accepts only a scalar or a list of scalars of one type. PyYAML itself decides here, too.
"""

from __future__ import annotations

import re
from pathlib import Path

from urdfcheck.core.records import dataclass
from urdfcheck.source.text.xml import SourceFile
from urdfcheck.source.text.yaml.values import YamlReadError

# What ends a plain scalar, or may not be in one: PyYAML's scan_plain and the pattern NON_PRINTABLE of its reader, whose
# characters are listed, because the complement of ranges takes 6 ms to compile.
_MARK = re.compile(
    r"(?P<colon>:(?=[\s\0]|\Z))|(?P<tab>\t)|(?P<hash>(?:(?<=\s)|\A)#)|(?P<marker>^(?:---|\.\.\.)(?=\s|\Z))"
    r"|(?P<character>[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x84\x86-\x9f\ud800-\udfff\ufffe\uffff])",
    re.MULTILINE,
)
_NAMES = {
    "colon": "a colon and a blank",
    "tab": "a tab",
    "hash": "a blank and a #",
    "marker": "a line --- or ...",
    "character": "a control character",
}
# The characters around a mark that show it, and those behind its line that PyYAML gets.
_AROUND, _BEHIND = 24, 1000
# A text of no consequence in the place of one without marks.
_PLAIN = "<robot>\n"


@dataclass(frozen=True, slots=True)
class YamlMark:
    """The first mark in a text that yaml does not read as a part of one plain text."""

    offset: int
    what: str
    """The mark in words."""
    excerpt: str
    """The mark with the text around it in its line."""


def find_yaml_mark(text: str) -> YamlMark | None:
    """Return the first mark of yaml in a text that begins as XML does; None where it has none."""
    mark = _MARK.search(text) if text.lstrip().startswith("<") else None
    if mark is None:
        return None
    begin = max(text.rfind("\n", 0, mark.start()) + 1, mark.start() - _AROUND)
    end = text.find("\n", mark.start() + 1)
    end = min(len(text) if end < 0 else end, mark.end() + _AROUND)
    return YamlMark(mark.start(), _NAMES[str(mark.lastgroup)], " ".join(text[begin:end].split()))


def explain_failure(text: str, mark: YamlMark) -> str | None:
    """Return what PyYAML says about a text with a mark; empty where it reads another text, None where it reads this one.

    It gets the line of the mark and what follows: all before it is one plain text, whatever it is.
    """
    from urdfcheck.source.text.yaml.reader import compose_nodes, convert_yaml_errors  # PyYAML: most texts need none

    begin = text.rfind("\n", 0, mark.offset) + 1
    given = (_PLAIN if begin else "") + text[begin : mark.offset + _BEHIND]
    source = SourceFile(Path(), "", given)
    try:
        with convert_yaml_errors(source):
            node = compose_nodes(source)
    except YamlReadError as error:
        return str(error)
    is_same = node is not None and node.tag.endswith(":str") and str(node.value).split() == given.split()
    return None if is_same else ""
