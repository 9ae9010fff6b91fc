"""Positions in the units of other programs: a span counts code points, they count the code units of an encoding.

All count lines and columns from 1, and the end is the first column after the text. A byte order mark is not part of the text,
neither here nor there.
"""

from __future__ import annotations

from collections.abc import Mapping

from urdfcheck.core import Span
from urdfcheck.core.records import dataclass


@dataclass(frozen=True, slots=True)
class Region:
    """A piece of text: lines and columns from 1, the end exclusive."""

    line: int
    column: int
    end_line: int
    end_column: int


def to_utf16_region(span: Span, sources: Mapping[str, str]) -> Region:
    """Convert columns to UTF-16 code units, as in JavaScript: SARIF, GitHub, GitLab, editors."""
    return _convert_span(span, sources, encoding="utf-16-le", unit_size=2)


def to_utf8_region(span: Span, sources: Mapping[str, str]) -> Region:
    """Convert columns to bytes of UTF-8, whatever the encoding of the file: rdjson."""
    return _convert_span(span, sources, encoding="utf-8", unit_size=1)


def _convert_span(span: Span, sources: Mapping[str, str], *, encoding: str, unit_size: int) -> Region:
    text = sources.get(span.file, "")

    def convert_column(offset: int, col: int) -> int:
        # Where the text is missing or too short, a code point counts as one unit.
        before = text[max(0, offset - (col - 1)) : offset]
        return col - len(before) + len(before.encode(encoding, "surrogatepass")) // unit_size

    return Region(
        line=span.line,
        column=convert_column(span.start, span.col),
        end_line=span.end_line,
        end_column=convert_column(span.end, span.end_col),
    )
