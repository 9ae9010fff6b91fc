"""Code frames: the lines around a span, with the part of each line that the span covers; and text made safe to show."""

from __future__ import annotations

import unicodedata
from dataclasses import dataclass
from functools import lru_cache

from urdfcheck.core import NEWLINE, Span

# A span over many lines (an element) shows its first lines only.
MAX_LINES = 6


@dataclass(frozen=True, slots=True)
class FrameLine:
    """A source line; ``marked`` is the half-open range of its characters inside the span, None outside."""

    number: int
    text: str
    marked: tuple[int, int] | None


def frame(source: str, span: Span, context: int = 1) -> list[FrameLine]:
    """The lines of ``span`` and ``context`` lines around it. Empty when the span lies outside of the text."""
    lines = _lines(source)
    if not 1 <= span.line <= len(lines):
        return []
    last = min(span.end_line, span.line + MAX_LINES - 1, len(lines))
    found = []
    for number in range(max(1, span.line - context), min(len(lines), last + context) + 1):
        text = lines[number - 1]
        marked = None
        if span.line <= number <= last:
            start = span.col - 1 if number == span.line else len(text) - len(text.lstrip())
            end = span.end_col - 1 if number == span.end_line else len(text.rstrip())
            # An empty span (an empty value, an end of file) still needs something to point at.
            marked = (start, max(end, start + 1))
        found.append(FrameLine(number, text, marked))
    return found


@lru_cache(maxsize=16)
def _lines(source: str) -> tuple[str, ...]:
    """Split once for all findings in a file."""
    return tuple(NEWLINE.split(source))


def visible(text: str) -> str:
    """``text`` with control and direction-changing characters spelled out: a name from a file must not act."""
    return text if text.isprintable() else "".join(_spelled(c) for c in text)


def _spelled(character: str) -> str:
    if character in "\n\t" or unicodedata.category(character) not in {"Cc", "Cf", "Cs", "Co", "Zl", "Zp"}:
        return character
    return f"\\x{ord(character):02x}" if ord(character) < 0x100 else f"\\u{ord(character):04x}"
