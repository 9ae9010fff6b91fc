"""What was edited and changes nothing of a robot: folded, unless nothing else was edited."""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.core.model_diff import Diff
from urdfcheck.output.changes.causes import strip_revision
from urdfcheck.output.changes.html.compared_models import ComparedModel
from urdfcheck.output.changes.html.rows import FEWEST_FOLDED, MOST_ROWS
from urdfcheck.output.html.glyphs import render_glyph
from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.shared.wording import get_base_name


def render_notes(model: ComparedModel) -> str:
    """Render what differs in the description and not in the robot."""
    notes = [escape_html(note) for note in model.difference.notes]
    return _render_fold(model, "notes", "Other descriptions of the same", len(notes), notes)


def render_idle_edits(diff: Diff, model: ComparedModel) -> str:
    """Render the edited lines that the robot has nothing of."""
    edits = model.difference.idle_edits
    if not edits:
        return ""
    lines = [f"{_render_place(diff, file, line)} <code>{escape_html(text)}</code>" for file, line, text in edits]
    listed = lines if len(lines) < MOST_ROWS + FEWEST_FOLDED else [*lines[:MOST_ROWS], f"{len(lines) - MOST_ROWS} more"]
    hint = '<p class="facts"><code>--all-args</code> compares the robot with other arguments, which may use them.</p>'
    return _render_fold(model, "idle", "Edited lines that make no part of this robot", len(edits), listed, hint)


def _render_place(diff: Diff, file: str, line: int) -> str:
    """Render where a line is: the file without its folders, which the title has."""
    short = get_base_name(strip_revision(strip_revision(file, diff.after), diff.before))
    return f'<code class="soft" title="{escape_html(f"{file}:{line}")}">{escape_html(f"{short}:{line}")}</code>'


def _render_fold(model: ComparedModel, name: str, title: str, count: int, items: Sequence[str], hint: str = "") -> str:
    """Render a list of HTML, with a hint below; nothing without items."""
    if not items:
        return ""
    is_all = model.found is not None and not model.found.changes
    heading = f'{render_glyph("info")} {title} <span class="count">{count}</span>'
    listed = "".join(f"<li>{item}</li>" for item in items)
    return (
        f'<details class="fold notes info"{" open" if is_all else ""}><summary><h3>{heading}</h3></summary>'
        f'<div id="{model.id}-{name}"><ul class="plain">{listed}</ul>{hint}</div></details>'
    )
