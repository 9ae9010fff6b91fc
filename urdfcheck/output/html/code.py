"""Source text in the report: code frames with the offending span marked, and repairs as a unified diff."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from difflib import SequenceMatcher
from itertools import groupby

from urdfcheck.core import NEWLINE, Edit, Span
from urdfcheck.output.frames import FrameLine, frame, lines_of
from urdfcheck.output.html.text import esc

# A file in one line must neither flood the report nor hide the span: this much of it is shown on each side.
MARGIN = 160
LONGEST = 2 * MARGIN + 80
# Enough to read XML by: comments, tags, attribute names, attribute values. Other text passes as it is. A name is tried at its
# first letter only: to try it at each would take the square of its length.
_TOKEN = re.compile(
    r"(?P<c><!--.*?(?:-->|$))|(?P<e></?[A-Za-z_][\w:.-]*|/?>)|(?P<a>(?<![\w:.-])[\w:.-]+(?=\s*=\s*[\"']))"
    r"|(?:(?<==)|(?<== ))(?P<s>\"[^\"<]*\"|'[^'<]*')"
)

Token = tuple[int, int, str]


def place(span: Span) -> str:
    return f"{span.file}:{span.line}:{span.col}"


def code_frame(sources: Mapping[str, str], span: Span, context: int = 2) -> str:
    """The lines around ``span`` as ``<pre>``, the span in ``<mark>``; nothing when the text is not at hand."""
    lines = frame(sources.get(span.file, ""), span, context)
    shown = [line.number for line in lines if line.marked is not None]
    if not shown:
        return ""
    hidden = span.end_line - shown[-1]
    if hidden > 0:
        lines = [line for line in lines if line.number <= shown[-1]]
    lines = _dedented(lines)
    comment = _starts_in_comment(lines)
    rows = []
    for line in lines:
        tokens, comment = _tokens(line.text, comment)
        rows.append(_row(line, tokens))
    if hidden > 0:
        rows.append(f'<span class="l"><span class="n">… </span>to line {span.end_line}\n</span>')
    return f'<pre class="code">{"".join(rows)}</pre>'


def _dedented(lines: Sequence[FrameLine]) -> list[FrameLine]:
    """Without the indentation that all lines share: a deeply nested element has its text at the left too."""
    indents = [line.text[: len(line.text) - len(line.text.lstrip())] for line in lines if line.text.strip()]
    # What the first and the last in alphabetical order share, all others share.
    first, last = min(indents, default=""), max(indents, default="")
    cut = next((i for i, (a, b) in enumerate(zip(first, last, strict=False)) if a != b), min(len(first), len(last)))
    return [
        FrameLine(
            line.number, line.text[cut:], line.marked and (max(0, line.marked[0] - cut), max(0, line.marked[1] - cut))
        )
        for line in lines
    ]


def _row(line: FrameLine, tokens: Sequence[Token]) -> str:
    start, end = line.marked or (0, 0)
    low, high = 0, len(line.text)
    if high > LONGEST:
        low, high = max(0, start - MARGIN), min(high, max(start, min(end, start + MARGIN)) + MARGIN)
    before, after = "…" if low else "", "…" if high < len(line.text) else ""
    if line.marked is None:
        body = _painted(line.text, low, high, tokens)
    else:
        first, last = min(start, high), min(end, high)
        covered = _painted(line.text, first, last, tokens)
        mark = f"<mark>{covered}</mark>" if covered else '<mark class="point"></mark>'
        body = _painted(line.text, low, first, tokens) + mark + _painted(line.text, last, high, tokens)
    kind = "l hit" if line.marked is not None else "l"
    return f'<span class="{kind}"><span class="n">{line.number} </span>{before}{body}{after}\n</span>'


def _painted(text: str, low: int, high: int, tokens: Sequence[Token]) -> str:
    pieces, at = [], low
    for start, end, kind in tokens:
        start, end = max(start, low), min(end, high)
        if start >= end:
            continue
        pieces.append(f'{esc(text[at:start])}<span class="{kind}">{esc(text[start:end])}</span>')
        at = end
    return "".join(pieces) + esc(text[at:high])


def _tokens(text: str, comment: bool) -> tuple[list[Token], bool]:
    """What to colour in a line (comments, tags, attribute names, values), and whether a comment stays open."""
    begin = 0
    found: list[Token] = []
    if comment:
        closed = text.find("-->")
        if closed < 0:
            return [(0, len(text), "c")], True
        begin = closed + 3
        found.append((0, begin, "c"))
    found += [(m.start(), m.end(), m.lastgroup or "") for m in _TOKEN.finditer(text, begin)]
    is_open = bool(found) and found[-1][2] == "c" and not text[: found[-1][1]].endswith("-->")
    return found, is_open


def _starts_in_comment(lines: Sequence[FrameLine]) -> bool:
    text = "\n".join(line.text for line in lines)
    closed = text.find("-->")
    return closed >= 0 and "<!--" not in text[:closed]


# -- repairs -----------------------------------------------------------------------------------------------------------


def diff(sources: Mapping[str, str], edits: Sequence[Edit]) -> str:
    """The edits as a unified diff that ``patch`` takes, in ``<pre>``; bare old and new text where the source is missing."""
    ordered = sorted(edits, key=lambda e: (e.span.file, e.span.start, e.span.end))
    rows: list[str] = []
    for file, group in groupby(ordered, key=lambda e: e.span.file):
        edits_here = list(group)
        text = sources.get(file)
        if text is None or any(_is_elsewhere(text, e) for e in edits_here):
            rows += [_diff_row("head", f"{place(e.span)}") + _bare(e) for e in edits_here]
        else:
            rows += [_diff_row("head", f"--- {file}"), _diff_row("head", f"+++ {file}"), *_hunks(text, edits_here)]
    return f'<pre class="diff">{"".join(rows)}</pre>'


def _is_elsewhere(text: str, edit: Edit) -> bool:
    """Whether an edit's text has changed meanwhile, or stands in a line that nobody can compare by eye."""
    typed = text[edit.span.start : edit.span.end]
    touched = lines_of(text)[edit.span.line - 1 : edit.span.end_line]
    return typed != edit.expected or any(len(line) > LONGEST for line in touched)


def _bare(edit: Edit) -> str:
    old, new = NEWLINE.split(edit.expected), NEWLINE.split(edit.replacement)
    return "".join(_diff_row("del", f"-{o}") for o in old) + "".join(_diff_row("ins", f"+{n}") for n in new)


def _hunks(text: str, edits: Sequence[Edit]) -> list[str]:
    """One hunk for the edits of neighbouring lines, with a line of context; ``edits`` are sorted and of one file."""
    rows: list[str] = []
    lines = lines_of(text)
    shift = 0
    for group in _neighbours(edits):
        first, last = group[0].span.line, max(e.span.end_line for e in group)
        before, after = lines[max(0, first - 2) : first - 1], lines[last : last + 1]
        start = group[0].span.start - (group[0].span.col - 1)
        old = [*before, *lines[first - 1 : last], *after]
        new = NEWLINE.split(_patched(text, start, group) + lines[last - 1][group[-1].span.end_col - 1 :])
        new = [*before, *new, *after]
        top = first - len(before)
        rows.append(_diff_row("at", f"@@ -{top},{len(old)} +{top + shift},{len(new)} @@"))
        for tag, i, j, k, m in SequenceMatcher(None, old, new, autojunk=False).get_opcodes():
            if tag == "equal":
                rows += [_diff_row("same", f" {line}") for line in old[i:j]]
            else:
                rows += [_diff_row("del", f"-{line}") for line in old[i:j]]
                rows += [_diff_row("ins", f"+{line}") for line in new[k:m]]
        shift += len(new) - len(old)
    return rows


def _neighbours(edits: Sequence[Edit]) -> list[list[Edit]]:
    groups: list[list[Edit]] = []
    for edit in edits:
        if groups and edit.span.line <= max(e.span.end_line for e in groups[-1]) + 2:
            groups[-1].append(edit)
        else:
            groups.append([edit])
    return groups


def _patched(text: str, start: int, edits: Sequence[Edit]) -> str:
    pieces, at = [], start
    for edit in edits:
        pieces += [text[at : edit.span.start], edit.replacement]
        at = edit.span.end
    return "".join(pieces)


def _diff_row(kind: str, text: str) -> str:
    return f'<span class="{kind}">{esc(text)}\n</span>'
