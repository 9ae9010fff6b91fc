"""The lines that caused the changes, as both versions have them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

from urdfcheck.core import Span
from urdfcheck.core.model_diff import ChangeCause, Diff
from urdfcheck.core.text import format_count
from urdfcheck.output.changes.html.compared_models import ComparedModel
from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.html.sections.code_listing import render_code_frame
from urdfcheck.output.shared.code_frames import split_lines

# Causes that are not folded.
MOST_CAUSES, FEWEST_FOLDED = 20, 3
# Lines around those that changed.
_CONTEXT = 2

_ATTRIBUTE = re.compile(r"""(?<![\w:.-])[\w:.-]+\s*=\s*(?:"[^"]*"|'[^']*')""")
_BETWEEN_WORDS = frozenset(" \t\"'<>=")

# File, line and text.
QuotedLine = tuple[str, int, str]


def render_causes(diff: Diff, model: ComparedModel) -> str:
    """Render each cause: both code frames, and links to the changes that it has; nothing without causes."""
    found = model.found
    if found is None or not found.causes:
        return ""
    sources: tuple[Mapping[str, str], Mapping[str, str]] = ({}, {})
    if diff.runs is not None:
        sources = (diff.runs[0].sources, diff.runs[1].sources)
    causes = [_render_cause(model, number, cause, sources) for number, cause in enumerate(found.causes)]
    listed = len(causes) if len(causes) < MOST_CAUSES + FEWEST_FOLDED else MOST_CAUSES
    rest = causes[listed:]
    folded = f"<details><summary>{len(rest)} more</summary>{''.join(rest)}</details>" if rest else ""
    count = f'<span class="count">{len(causes)}</span>'
    return (
        f'<section class="causes" id="{model.id}-causes"><h3>The lines that caused it {count}</h3>'
        f"{''.join(causes[:listed])}{folded}</section>"
    )


def _render_cause(
    model: ComparedModel, number: int, cause: ChangeCause, sources: tuple[Mapping[str, str], Mapping[str, str]]
) -> str:
    marks = _find_differences(cause) if cause.is_edited else {}
    sides = [
        _render_side(kind, word, lines, texts, marks)
        for kind, word, lines, texts in (
            ("error", "before", cause.before, sources[0]),
            ("ok", "after", cause.after, sources[1]),
        )
    ]
    links = [
        f'<a href="#{model.id}-c{index}">{escape_html(model.difference.texts[index])}</a>' for index in cause.changes
    ]
    head = f"<h4>{links[0]}</h4>" if len(links) == 1 else f"<h4>{format_count(len(links), 'change')}</h4>"
    items = "".join(f"<li>{link}</li>" for link in links) if len(links) > 1 else ""
    note = "" if cause.is_edited else '<p class="facts">The value is typed here; this line was not edited.</p>'
    return (
        f'<article class="cause" id="{model.id}-k{number}" tabindex="-1">{head}<ul class="changed">{items}</ul>{note}'
        f'<div class="sides">{"".join(sides)}</div></article>'
    )


def _render_side(
    kind: str,
    word: str,
    lines: Sequence[QuotedLine],
    sources: Mapping[str, str],
    marks: Mapping[QuotedLine, tuple[int, int]],
) -> str:
    """Render the lines of one version, a figure for those that follow one another."""
    if not lines:
        return f'<p class="absent">{word}: no such line</p>'
    return "".join(
        f'<figure class="frame {kind}"><figcaption><b>{word}</b> <code class="place" title="{place}">{place}</code></figcaption>'
        f"{_render_lines(group, sources, marks)}</figure>"
        for group in _iter_runs(lines)
        if (place := escape_html(f"{group[0][0]}:{group[0][1]}"))
    )


def _iter_runs(lines: Sequence[QuotedLine]) -> Iterator[list[QuotedLine]]:
    """Yield the lines that follow one another in a file."""
    run: list[QuotedLine] = []
    for line in lines:
        if run and (line[0], line[1]) != (run[-1][0], run[-1][1] + 1):
            yield run
            run = []
        run.append(line)
    if run:
        yield run


def _render_lines(
    group: Sequence[QuotedLine], sources: Mapping[str, str], marks: Mapping[QuotedLine, tuple[int, int]]
) -> str:
    """Render lines with those around them; without the text of the file only themselves."""
    file, first, quoted = group[0]
    last = group[-1][1]
    texts = split_lines(sources.get(file, ""))
    if last <= len(texts):
        start, end = len(texts[first - 1]) - len(texts[first - 1].lstrip()), len(texts[last - 1].rstrip())
        # The quotation has no indentation.
        if len(group) == 1 and group[0] in marks and texts[first - 1].strip().startswith(quoted):
            low, high = marks[group[0]]
            start, end = start + low, start + high
        span = Span(file, first, start + 1, last, end + 1, 0, 0)
        if frame := render_code_frame(sources, span, _CONTEXT):
            return frame
    rows = (
        f'<span class="l hit"><span class="n">{number} </span>{escape_html(text)}\n</span>' for _, number, text in group
    )
    return f'<pre class="code">{"".join(rows)}</pre>'


def _find_differences(cause: ChangeCause) -> dict[QuotedLine, tuple[int, int]]:
    """Return, for a line that was edited into another, the range of each that the other does not have, in whole words."""
    if len(cause.before) != 1 or len(cause.after) != 1:
        return {}
    (old,), (new,) = cause.before, cause.after
    shortest = min(len(old[2]), len(new[2]))
    start = next((i for i in range(shortest) if old[2][i] != new[2][i]), shortest)
    rest = shortest - start
    end = next((i for i in range(rest) if old[2][-1 - i] != new[2][-1 - i]), rest)
    return {line: _widen_range(line[2], start, len(line[2]) - end) for line in (old, new)}


def _widen_range(text: str, start: int, end: int) -> tuple[int, int]:
    """Return a range that ends between words, or between attributes where it is about more than one."""
    attributes = [match.span() for match in _ATTRIBUTE.finditer(text)]
    touched = [span for span in attributes if span[0] < end and start < span[1]]
    if any(sign in text[start:end] for sign in "=\"'") and touched:
        return min(start, touched[0][0]), max(end, touched[-1][1])
    while start > 0 and text[start - 1] not in _BETWEEN_WORDS:
        start -= 1
    while end < len(text) and text[end] not in _BETWEEN_WORDS:
        end += 1
    return start, end
