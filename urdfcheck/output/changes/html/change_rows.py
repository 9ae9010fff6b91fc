"""What changes: a row for each change, by kind."""

from __future__ import annotations

from itertools import groupby

from urdfcheck.core.model_diff import ChangeCause, Diff, MechanismChange
from urdfcheck.output.changes.causes import strip_revision
from urdfcheck.output.changes.html.compared_models import ComparedModel
from urdfcheck.output.changes.html.rows import emphasize_parts, is_about_parts, render_kind, render_row
from urdfcheck.output.changes.summary import get_label
from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.shared.wording import get_base_name


def render_changes(diff: Diff, model: ComparedModel) -> str:
    """Render what changes, a list for each kind; nothing without changes."""
    found = model.found
    if found is None or not found.changes:
        return ""
    places = {
        index: _render_place(diff, cause, f"{model.id}-k{number}")
        for number, cause in enumerate(found.causes)
        for index in cause.changes
    }
    entries = list(enumerate(found.changes))
    kinds = sorted({change.category: place for place, change in reversed(entries)}.items(), key=lambda kind: kind[1])
    order = [category for category, _ in kinds]
    entries.sort(key=lambda entry: order.index(entry[1].category))
    groups = []
    for category, group in groupby(entries, key=lambda entry: entry[1].category):
        rows = [_render_change(model, number, change, places.get(number, "")) for number, change in group]
        groups.append(render_kind(get_label(category), rows))
    count = f'<span class="count">{len(entries)}</span>'
    return f'<section class="changes" id="{model.id}-changes"><h3>What changes {count}</h3>{"".join(groups)}</section>'


def _render_place(diff: Diff, cause: ChangeCause, anchor: str) -> str:
    """Render a link to a cause: the first of its lines, in the second version if that has any."""
    lines, version = (cause.after, diff.after) if cause.after else (cause.before, diff.before)
    file, line, _ = lines[0]
    place = f"{get_base_name(strip_revision(file, version))}:{line}"
    return f'<a class="why" href="#{anchor}"><code>{escape_html(place)}</code></a>'


def _render_change(model: ComparedModel, number: int, change: MechanismChange, place: str) -> str:
    what = emphasize_parts(model.difference.texts[number], change.subject)
    return render_row(f"{model.id}-c{number}", what, place, is_shown=is_about_parts(change.subject))
