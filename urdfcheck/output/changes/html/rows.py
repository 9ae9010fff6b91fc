"""Rows of the page: a sentence about parts of the robot, and the ways to see them."""

from __future__ import annotations

import re
from collections.abc import Sequence

from urdfcheck.output.html.html_text import escape_html

# Rows of one kind that are not folded. A fold that hides two saves no space.
MOST_ROWS, FEWEST_FOLDED = 12, 3
BUTTON = '<button type="button" class="in-3d" title="Show in 3D" aria-label="Show in 3D" hidden>3D</button>'
WORST_BUTTON = (
    '<button type="button" class="in-3d" title="Move the joints to where it is worst" hidden>Show worst</button>'
)
_PART = re.compile(r"(link|joint)\[([^\]]*)\]", re.DOTALL)


def is_about_parts(subject: str) -> bool:
    """Whether a subject names links or joints, which the 3D view can show."""
    return _PART.search(subject) is not None


def emphasize_parts(text: str, *subjects: str) -> str:
    """Render a sentence that names the subjects in this order, their names in bold."""
    rendered = ""
    for subject in filter(None, subjects):
        match = _PART.fullmatch(subject)
        kind, name = ("", subject) if match is None else (f"{match[1]} ", match[2])
        start, named, rest = text.partition(f"{kind}{name} ")
        if named:
            rendered += f"{escape_html(start)}{kind}<b>{escape_html(name)}</b> "
            text = rest
    return rendered + escape_html(text)


def render_row(entry_id: str, what: str, more: str = "", *, is_shown: bool = True, button: str = BUTTON) -> str:
    """Render a row that can be chosen; ``more`` comes before the button, which ``is_shown`` leaves out."""
    ways = f'<span class="ways">{more}{button if is_shown else ""}</span>'
    return f'<li class="entry" id="{entry_id}" tabindex="-1"><span class="what">{what}</span>{ways}</li>'


def render_fact(what: str, more: str = "") -> str:
    """Render a row that leads to no part of the robot."""
    ways = f'<span class="ways">{more}</span>' if more else ""
    return f'<li class="fact"><span class="what">{what}</span>{ways}</li>'


def render_kind(label: str, rows: Sequence[str]) -> str:
    """Render the rows of one kind, those beyond the first folded."""
    listed = len(rows) if len(rows) < MOST_ROWS + FEWEST_FOLDED else MOST_ROWS
    rest = rows[listed:]
    folded = (
        f'<details class="rest"><summary>{len(rest)} more</summary><ul class="rows">{"".join(rest)}</ul></details>'
        if rest
        else ""
    )
    listing = f'<div><ul class="rows">{"".join(rows[:listed])}</ul>{folded}</div>'
    return f'<div class="sort"><h4>{escape_html(label)}</h4>{listing}</div>'
