"""A recording of a terminal as an SVG that moves by itself: commands are typed, and what they printed appears line by line.

It has no script and loads nothing, and stops at its last picture, which is also there alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from xml.sax.saxutils import escape, quoteattr

from rich.color import ColorType
from rich.style import Style
from rich.text import Text

# Pixels of a character and a line, of the space around them, and of the bar above them.
_COLUMN, _ROW, _MARGIN, _BAR = 8.0, 18, 16, 34
# Seconds for a typed character, a printed line, and before what a command prints.
_PER_CHARACTER, _PER_LINE, _PAUSE = 0.035, 0.06, 0.5
_FONT = "ui-monospace, 'SF Mono', 'Cascadia Mono', 'JetBrains Mono', Menlo, Consolas, 'DejaVu Sans Mono', monospace"

_MOTION = (
    "g { animation: show 1ms both; } @keyframes show { from { opacity: 0; } }\n"
    "@media print, (prefers-reduced-motion: reduce) { g { animation: none; } }"
)


@dataclass(frozen=True, slots=True)
class Recorded:
    """A command, and what it printed, with its control sequences for colours."""

    command: str
    output: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Palette:
    """Colours of a terminal, as CSS writes them."""

    background: str
    bar: str
    text: str
    dim: str
    colors: tuple[str, ...]
    """The eight of ANSI: black, red, green, yellow, blue, magenta, cyan, white."""


# Those of the report and the site, in the dark and in the light.
DARK = Palette(
    background="#0f1317",
    bar="#1a1f25",
    text="#e3e7ec",
    dim="#a2adb9",
    colors=("#a2adb9", "#ff938a", "#7bd29b", "#f0b95c", "#8dbdf5", "#d3a6ef", "#86d0d8", "#e3e7ec"),
)
LIGHT = Palette(
    background="#f7f8fa",
    bar="#e6e9ee",
    text="#1b232c",
    dim="#55606d",
    colors=("#55606d", "#b3241c", "#1b6b3a", "#855100", "#1d5fa8", "#7a3a9a", "#0f6670", "#1b232c"),
)


def render_recording(
    recorded: Sequence[Recorded], palette: Palette, columns: int, title: str, *, is_still: bool = False
) -> str:
    """Return the SVG of what was typed and printed, for a terminal with a number of columns.

    :param is_still: its last picture only. Browsers do not tell an SVG in a page that its reader asked for less motion.
    """
    elements: list[str] = []
    row, seconds = 0, 0.5
    for step in recorded:
        elements += _render_command(step.command, row, seconds, palette)
        seconds += len(step.command) * _PER_CHARACTER + _PAUSE
        row += 1
        for line in step.output.rstrip("\n").split("\n"):
            elements += _render_line(line, row, seconds, palette)
            seconds += _PER_LINE
            row += 1
        row += 1
        seconds += _PAUSE * 2
    width, height = columns * _COLUMN + 2 * _MARGIN, (row - 1) * _ROW + _BAR + 2 * _MARGIN
    dots = "".join(f'<circle cx="{20 + 18 * n}" cy="{_BAR / 2:g}" r="5" fill="{palette.dim}"/>' for n in range(3))
    return "\n".join(
        (
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}" height="{height:g}" '
            f'viewBox="0 0 {width:g} {height:g}" role="img" aria-label={quoteattr(title)}>',
            f"<title>{escape(title)}</title>",
            f"<style>text {{ font: 13px {_FONT}; white-space: pre; fill: {palette.text}; }}",
            f".b {{ font-weight: 700; }} {'' if is_still else _MOTION}</style>",
            f'<rect width="{width:g}" height="{height:g}" rx="10" fill="{palette.background}"/>',
            f'<path d="M0 {_BAR}V10a10 10 0 0 1 10-10h{width - 20:g}a10 10 0 0 1 10 10v{_BAR - 10}z" fill="{palette.bar}"/>',
            dots,
            *elements,
            "</svg>",
            "",
        )
    )


def _render_command(command: str, row: int, seconds: float, palette: Palette) -> Iterator[str]:
    """The prompt, and after it character by character what is typed."""
    yield _render_group([_render_text("$", 0, row, palette.dim)], seconds - 0.4)
    for number, character in enumerate(command):
        if character != " ":
            typed = _render_text(character, 2 + number, row, palette.text, is_bold=True)
            yield _render_group([typed], seconds + number * _PER_CHARACTER)


def _render_line(line: str, row: int, seconds: float, palette: Palette) -> Iterator[str]:
    """A printed line, its words in their colours."""
    text = Text.from_ansi(line)
    pieces = [
        _render_text(piece, column, row, _choose_color(style, palette), is_bold=bool(style.bold))
        for piece, column, style in _split_by_style(text)
    ]
    if pieces:
        yield _render_group(pieces, seconds)


def _split_by_style(text: Text) -> Iterator[tuple[str, int, Style]]:
    """Yield the pieces of a line that look alike, without the blanks around them, with their first columns."""
    styles = [Style.null()] * len(text.plain)
    for span in text.spans:
        for place in range(span.start, min(span.end, len(styles))):
            styles[place] = styles[place] + (span.style if isinstance(span.style, Style) else Style.parse(span.style))
    start = 0
    for end in range(1, len(styles) + 1):
        if end < len(styles) and styles[end] == styles[start]:
            continue
        piece = text.plain[start:end]
        if piece.strip():
            yield piece.strip(), start + len(piece) - len(piece.lstrip()), styles[start]
        start = end


def _choose_color(style: Style, palette: Palette) -> str:
    if style.color is not None and style.color.type is ColorType.STANDARD and style.color.number is not None:
        return palette.colors[style.color.number % 8]
    return palette.dim if style.dim else palette.text


def _render_text(text: str, column: int, row: int, color: str, *, is_bold: bool = False) -> str:
    """A piece of a line, as wide as its columns whatever the font is."""
    x, y = _MARGIN + column * _COLUMN, _BAR + _MARGIN + (row + 0.75) * _ROW
    bold = ' class="b"' if is_bold else ""
    return (
        f'<text{bold} x="{x:g}" y="{y:g}" style="fill:{color}" textLength="{len(text) * _COLUMN:g}" '
        f'lengthAdjust="spacingAndGlyphs">{escape(text)}</text>'
    )


def _render_group(pieces: Iterable[str], seconds: float) -> str:
    return f'<g style="animation-delay:{seconds:.2f}s">{"".join(pieces)}</g>'
