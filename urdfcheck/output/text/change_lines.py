"""What a repair changes in the source, a line before and after for each line of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rich.text import Text

from urdfcheck.core import Finding
from urdfcheck.output.shared.diffs import LineChange, Piece, fit_change
from urdfcheck.output.shared.escaping import escape_invisible, escape_one_line
from urdfcheck.output.text.lines import wrap_text

_STYLES = {"-": "red", "+": "green"}


def iter_change_lines(finding: Finding, changes: Sequence[LineChange], *, indent: int, width: int) -> Iterator[Text]:
    """Yield the changed lines below a label of ``indent`` columns, with the number of each line; long ones are wrapped."""
    span = finding.location.span
    for change in changes:
        is_elsewhere = span is None or change.file != span.file
        place = f"{escape_one_line(change.file)}:{change.line}" if is_elsewhere else f"{change.line}"
        if is_elsewhere:
            yield Text.assemble(" " * indent, (place, "dim"))
        lead = "" if is_elsewhere else place
        for sign, pieces in zip("-+", fit_change(change, width - indent - 2), strict=True):
            if not pieces:
                continue
            head = Text.assemble((lead.rjust(indent - 1) + " ", "dim"), (f"{sign} ", _STYLES[sign]))
            line = Text.assemble(*(_format_piece(piece, _STYLES[sign]) for piece in pieces))
            yield from wrap_text(line, width, head)


def _format_piece(piece: Piece, style: str) -> tuple[str, str]:
    text, is_changed = piece
    return escape_invisible(text.replace("\t", " ")), style if is_changed else "dim"
