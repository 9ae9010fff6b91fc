"""Positions as other programs count them: a span counts code points, they count the units of an encoding.

All count lines from 1 and columns from 1, and name the first column behind the text as its end. A byte order mark is no part of
a source's text, here as there.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from urdfcheck.core import Span


@dataclass(frozen=True, slots=True)
class Region:
    """A piece of text: lines and columns from 1, the end exclusive."""

    line: int
    column: int
    end_line: int
    end_column: int


def to_utf16_region(span: Span, sources: Mapping[str, str]) -> Region:
    """Columns in UTF-16 code units, as JavaScript counts: SARIF, GitHub, GitLab, editors."""
    return _convert_span(span, sources, "utf-16-le", 2)


def to_utf8_region(span: Span, sources: Mapping[str, str]) -> Region:
    """Columns in bytes of UTF-8, whatever encoding the file itself has: rdjson."""
    return _convert_span(span, sources, "utf-8", 1)


def _convert_span(span: Span, sources: Mapping[str, str], encoding: str, unit_size: int) -> Region:
    text = sources.get(span.file, "")

    def convert_column(offset: int, col: int) -> int:
        # Where the text is not at hand, or ends before, a code point counts as one unit.
        before = text[max(0, offset - (col - 1)) : offset]
        return col - len(before) + len(before.encode(encoding, "surrogatepass")) // unit_size

    return Region(
        span.line, convert_column(span.start, span.col), span.end_line, convert_column(span.end, span.end_col)
    )
