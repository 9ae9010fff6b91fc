"""Comments that suppress findings of the next element: ``<!-- urdfcheck:ignore[INR003] reason -->``.

xacro deletes comments before a macro, so they are read from the text as typed. In yaml, Python and CMake files such a
comment begins with ``#`` and covers its own line, or the next line if it is alone on its own.
"""

from __future__ import annotations

import re
from bisect import bisect_left
from collections.abc import Iterator

from urdfcheck.core import NEWLINE, Span
from urdfcheck.core.records import dataclass
from urdfcheck.source.text.xml import SourceFile, XmlError, parse_xml

MARK = "urdfcheck:"
_IGNORE = re.compile(r"ignore\s*\[([^\]]*)\]\s*(.*)", re.DOTALL)
_HASH = re.compile(r"#[ \t]*(urdfcheck:[^\r\n]*)")


@dataclass(frozen=True, slots=True, kw_only=True)
class IgnoreComment:
    """One suppression comment."""

    span: Span
    selectors: tuple[str, ...]
    """The codes, prefixes, names and tags in brackets; empty if the comment cannot be parsed."""
    reason: str
    start: int
    """Offset at which the covered text begins."""
    end: int


def find_ignore_comments(file: SourceFile) -> list[IgnoreComment]:
    """Return the comments of a file, in order; none if the file cannot be parsed, which another rule reports."""
    if MARK not in file.text:
        return []
    if not file.text.lstrip("\ufeff \t\r\n").startswith("<"):
        return list(_iter_hash_comments(file))
    # Parsed again, because launch files and manifests are not kept as trees; such comments are rare.
    again = SourceFile(file.path, file.name, text=file.text, encoding=file.encoding)
    try:
        root = parse_xml(again)
    except XmlError:
        return []
    elements = [(e.span.start, e) for e in root.walk() if e.span is not None]
    starts = [start for start, _ in elements]
    ends: dict[int, int] = {}
    open_since: list[tuple[int, int]] = []  # depth and index of the elements that are still open
    depths = {id(root): 0}
    for index, (start, element) in enumerate(elements):
        depth = 0 if element.parent is None else depths[id(element.parent)] + 1
        depths[id(element)] = depth
        while open_since and open_since[-1][0] >= depth:
            ends[open_since.pop()[1]] = start
        open_since.append((depth, index))
    comments = []
    for comment in again.comments:
        text = comment.text.strip()
        if text.startswith(MARK):
            index = bisect_left(starts, comment.span.end)
            start = starts[index] if index < len(starts) else comment.span.end
            end = ends.get(index, len(file.text)) if index < len(starts) else start
            comments.append(_parse_ignore_comment(text, comment.span, start=start, end=end))
    return comments


def _iter_hash_comments(file: SourceFile) -> Iterator[IgnoreComment]:
    for match in _HASH.finditer(file.text):
        span = file.make_span(*match.span())
        line = span.start - span.col + 1
        newline = NEWLINE.search(file.text, match.end())
        end = len(file.text) if newline is None else newline.end()
        if not file.text[line : match.start()].strip():  # the comment is alone on its line
            newline = NEWLINE.search(file.text, end)
            line, end = end, len(file.text) if newline is None else newline.end()
        yield _parse_ignore_comment(match.group(1).strip(), span, start=line, end=end)


def _parse_ignore_comment(text: str, span: Span, *, start: int, end: int) -> IgnoreComment:
    match = _IGNORE.match(text.removeprefix(MARK).strip())
    if match is None:
        return IgnoreComment(span=span, selectors=(), reason="", start=start, end=end)
    words = tuple(word.strip() for word in match.group(1).split(",") if word.strip())
    return IgnoreComment(span=span, selectors=words, reason=" ".join(match.group(2).split()), start=start, end=end)
