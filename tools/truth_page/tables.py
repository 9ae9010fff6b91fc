"""Markdown tables, shares, and tables that a README has already."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent.parent


def render_table(head: Sequence[str], rows: Iterable[Sequence[object]], *, text_columns: int = 1) -> str:
    """Return a table: the first columns hold text, the others numbers."""
    rule = "|---" * text_columns + "|---:" * (len(head) - text_columns) + "|"
    first, *lines = (f"| {' | '.join(map(str, row))} |" for row in (head, *rows))
    return "\n".join((first, rule, *lines))


def render_share(part: int, whole: int) -> str:
    """Return a part with what it is a part of: a percentage alone would hide how few were counted."""
    return f"{part} of {whole} ({100 * part / whole:.0f} %)" if whole else "none"


def copy_summary(file: str) -> str:
    """Return the paragraph in bold that sums a file up.

    :raises ValueError: if it has none.
    """
    found = re.search(r"^\*\*(.+?)\*\*$", (REPOSITORY / file).read_text(encoding="utf-8"), re.MULTILINE)
    if found is None:
        raise ValueError(f"{file} has no line in bold")
    return found[1]


def copy_table(file: str, name: str) -> str:
    """Return the table that follows the mark of this name in a README.

    :raises ValueError: if there is no such mark, or no table after it.
    """
    mark = f"<!-- in docs/how-true-is-it.md: {name} -->"
    _, found, after = (REPOSITORY / file).read_text(encoding="utf-8").partition(mark)
    lines = after.lstrip().splitlines() if found else []
    table = lines[: next((i for i, line in enumerate(lines) if not line.startswith("|")), len(lines))]
    if not table:
        raise ValueError(f"{file} has no table after {mark}")
    return "\n".join(table)
