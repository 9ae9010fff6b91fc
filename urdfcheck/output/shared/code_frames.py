"""Code frames: the lines around a span, with the part of each line that the span covers."""

from __future__ import annotations

from functools import lru_cache

from urdfcheck.core import NEWLINE, Span
from urdfcheck.core.records import dataclass

# A span over many lines (an element) shows its first lines only.
MOST_LINES = 6
# Characters of a line kept on each side of the marked range: a file in one line would be copied for each of its findings.
KEPT_CHARACTERS = 1000


@dataclass(frozen=True, slots=True)
class FrameLine:
    """A source line; ``marked`` is the half-open range of its characters inside the span, None outside."""

    number: int
    text: str
    marked: tuple[int, int] | None


def extract_code_frame(source: str, span: Span, context: int = 1, most_lines: int = MOST_LINES) -> list[FrameLine]:
    """Return the lines of ``span``, at most ``most_lines``, and ``context`` lines around it.

    None where the span lies outside the text, or that is not there.
    """
    lines = split_lines(source)
    if not source or not 1 <= span.line <= len(lines):
        return []
    last = min(span.end_line, span.line + most_lines - 1, len(lines))
    frame = []
    for number in range(max(1, span.line - context), min(len(lines), last + context) + 1):
        text = lines[number - 1]
        marked = None
        if span.line <= number <= last:
            start = span.col - 1 if number == span.line else len(text) - len(text.lstrip())
            end = span.end_col - 1 if number == span.end_line else len(text.rstrip())
            # An empty span (an empty value, an end of file) still needs something to point at.
            marked = (start, max(end, start + 1))
        frame.append(_crop_line(FrameLine(number, text, marked)))
    return frame


def _crop_line(line: FrameLine) -> FrameLine:
    if len(line.text) <= 2 * KEPT_CHARACTERS:
        return line
    start, end = line.marked or (0, 0)
    low, high = max(0, start - KEPT_CHARACTERS), min(end, start + KEPT_CHARACTERS) + KEPT_CHARACTERS
    return FrameLine(line.number, line.text[low:high], line.marked and (start - low, min(end, high) - low))


@lru_cache(maxsize=16)
def split_lines(source: str) -> tuple[str, ...]:
    """Split a text into lines, once for all findings in a file."""
    return tuple(NEWLINE.split(source))
