"""What was edited and changes nothing of a robot: folded, unless nothing else was edited."""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.output.changes.html.compared_models import ComparedModel
from urdfcheck.output.changes.html.rows import FEWEST_FOLDED, MOST_ROWS
from urdfcheck.output.changes.text import describe_idle_edits
from urdfcheck.output.html.glyphs import render_glyph
from urdfcheck.output.html.html_text import escape_html


def render_notes(model: ComparedModel) -> str:
    """Render what differs in the description and not in the robot."""
    notes = [escape_html(note) for note in model.difference.notes]
    return _render_fold(model, "notes", "Other descriptions of the same", len(notes), notes)


def render_idle_edits(model: ComparedModel) -> str:
    """Render the edited lines that the robot has nothing of."""
    edits = model.difference.idle_edits
    if not edits:
        return ""
    lines = [
        f"<code>{escape_html(f'{file}:{line}')}</code> <code>{escape_html(text)}</code>" for file, line, text in edits
    ]
    listed = lines if len(lines) < MOST_ROWS + FEWEST_FOLDED else [*lines[:MOST_ROWS], f"{len(lines) - MOST_ROWS} more"]
    items = [escape_html(describe_idle_edits(model.difference)), *listed]
    return _render_fold(model, "idle", "Edited lines that make no part of this robot", len(edits), items)


def _render_fold(model: ComparedModel, name: str, title: str, count: int, items: Sequence[str]) -> str:
    """Render a list of HTML; nothing without items."""
    if not items:
        return ""
    is_all = model.found is not None and not model.found.changes
    heading = f'{render_glyph("info")} {title} <span class="count">{count}</span>'
    listed = "".join(f"<li>{item}</li>" for item in items)
    return (
        f'<details class="fold notes info"{" open" if is_all else ""}><summary><h3>{heading}</h3></summary>'
        f'<div id="{model.id}-{name}"><ul class="plain">{listed}</ul></div></details>'
    )
