"""Source text in the report: code frames with the offending span marked, and repairs as a unified diff."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from urdfcheck.core import Edit, Span
from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.shared.code_frames import FrameLine, extract_code_frame
from urdfcheck.output.shared.diffs import iter_diff_lines

# Characters shown on each side of the span: a file in one line must neither flood the report nor hide the span.
MARGIN = 160
LONGEST = 2 * MARGIN + 80
# Comments, tags, attribute names and attribute values of XML; other text stays as it is. A name is tried at its first letter
# only: trying it at each letter would take time quadratic in its length.
_TOKEN = re.compile(
    r"(?P<c><!--.*?(?:-->|$))|(?P<e></?[A-Za-z_][\w:.-]*|/?>)|(?P<a>(?<![\w:.-])[\w:.-]+(?=\s*=\s*[\"']))"
    r"|(?:(?<==)|(?<== ))(?P<s>\"[^\"<]*\"|'[^'<]*')"
)

Token = tuple[int, int, str]


def render_code_frame(sources: Mapping[str, str], span: Span, context: int = 2) -> str:
    """Render the lines around ``span`` as ``<pre>``, the span in ``<mark>``; nothing if the text is missing."""
    lines = extract_code_frame(sources.get(span.file, ""), span, context)
    shown = [line.number for line in lines if line.marked is not None]
    if not shown:
        return ""
    hidden = span.end_line - shown[-1]
    if hidden > 0:
        lines = [line for line in lines if line.number <= shown[-1]]
    lines = _dedent_lines(lines)
    comment = _is_inside_comment(lines)
    rows = []
    for line in lines:
        tokens, comment = _tokenize_line(line.text, comment)
        rows.append(_render_line(line, tokens))
    if hidden > 0:
        rows.append(f'<span class="l"><span class="n">… </span>to line {span.end_line}\n</span>')
    return f'<pre class="code">{"".join(rows)}</pre>'


def _dedent_lines(lines: Sequence[FrameLine]) -> list[FrameLine]:
    """Remove the indentation that all lines share, so that a deeply nested element begins at the left."""
    indents = [line.text[: len(line.text) - len(line.text.lstrip())] for line in lines if line.text.strip()]
    # The prefix that the first and the last share in alphabetical order is the prefix that all share.
    first, last = min(indents, default=""), max(indents, default="")
    cut = next((i for i, (a, b) in enumerate(zip(first, last, strict=False)) if a != b), min(len(first), len(last)))
    dedented = []
    for line in lines:
        marked = line.marked and (max(0, line.marked[0] - cut), max(0, line.marked[1] - cut))
        dedented.append(FrameLine(line.number, line.text[cut:], marked))
    return dedented


def _render_line(line: FrameLine, tokens: Sequence[Token]) -> str:
    start, end = line.marked or (0, 0)
    low, high = 0, len(line.text)
    if high > LONGEST:
        low, high = max(0, start - MARGIN), min(high, max(start, min(end, start + MARGIN)) + MARGIN)
    before, after = "…" if low else "", "…" if high < len(line.text) else ""
    if line.marked is None:
        body = _render_highlighted(line.text, (low, high), tokens)
    else:
        first, last = min(start, high), min(end, high)
        covered = _render_highlighted(line.text, (first, last), tokens)
        mark = f"<mark>{covered}</mark>" if covered else '<mark class="point"></mark>'
        body = (
            _render_highlighted(line.text, (low, first), tokens)
            + mark
            + _render_highlighted(line.text, (last, high), tokens)
        )
    kind = "l hit" if line.marked is not None else "l"
    return f'<span class="{kind}"><span class="n">{line.number} </span>{before}{body}{after}\n</span>'


def _render_highlighted(text: str, visible: tuple[int, int], tokens: Sequence[Token]) -> str:
    """Render the visible range of a line with its tokens coloured."""
    low, high = visible
    pieces, done = [], low
    for token_start, token_end, kind in tokens:
        start, end = max(token_start, low), min(token_end, high)
        if start >= end:
            continue
        pieces.append(f'{escape_html(text[done:start])}<span class="{kind}">{escape_html(text[start:end])}</span>')
        done = end
    return "".join(pieces) + escape_html(text[done:high])


def _tokenize_line(text: str, in_comment: bool) -> tuple[list[Token], bool]:
    """Find what to colour in a line (comments, tags, attribute names, values), and whether a comment stays open."""
    begin = 0
    tokens: list[Token] = []
    if in_comment:
        closed = text.find("-->")
        if closed < 0:
            return [(0, len(text), "c")], True
        begin = closed + 3
        tokens.append((0, begin, "c"))
    tokens += [(m.start(), m.end(), m.lastgroup or "") for m in _TOKEN.finditer(text, begin)]
    is_open = bool(tokens) and tokens[-1][2] == "c" and not text[: tokens[-1][1]].endswith("-->")
    return tokens, is_open


def _is_inside_comment(lines: Sequence[FrameLine]) -> bool:
    text = "\n".join(line.text for line in lines)
    closed = text.find("-->")
    return closed >= 0 and "<!--" not in text[:closed]


# -- repairs -----------------------------------------------------------------------------------------------------------


def render_diff(sources: Mapping[str, str], edits: Sequence[Edit]) -> str:
    """Render the edits as a unified diff in ``<pre>``."""
    shown = "".join(
        f'<span class="{kind}">{escape_html(text)}\n</span>' for kind, text in iter_diff_lines(sources, edits)
    )
    return f'<pre class="diff">{shown}</pre>'
