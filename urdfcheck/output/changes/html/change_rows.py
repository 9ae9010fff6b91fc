"""The rows of the page: what changes, by kind, and what follows from it."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby

from urdfcheck.core.model_diff import ChangeCause, Diff, LinkShift, MechanismChange, MechanismDiff
from urdfcheck.core.text import format_angle, format_configuration, format_count, format_length
from urdfcheck.output.changes.causes import strip_revision
from urdfcheck.output.changes.html.compared_models import ComparedModel
from urdfcheck.output.changes.html.rows import WORST_BUTTON, emphasize_parts, is_about_parts, render_kind, render_row
from urdfcheck.output.changes.summary import get_label
from urdfcheck.output.changes.text import describe_torque
from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.shared.wording import get_base_name

# As `urdfcheck diff` itself compares: m, and share.
_LEAST_LENGTH, _LEAST_SHARE = 2e-5, 1e-5


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


# -- what follows ------------------------------------------------------------------------------------------------------


def render_consequences(model: ComparedModel) -> str:
    """Render how far links move, what gravity asks of joints, and the mass of the whole; nothing where none of it changes."""
    found = model.found
    if found is None:
        return ""
    motion = [_render_shift(model, number, shift) for number, shift in enumerate(found.shifts)]
    gravity = [
        render_row(f"{model.id}-t{number}", escape_html(describe_torque(torque)))
        for number, torque in enumerate(found.torques)
    ]
    whole = [f'<li class="fact"><span class="what">{text}</span></li>' for text in _iter_totals(found)]
    groups = [
        render_kind(label, rows)
        for label, rows in (("position", motion), ("gravity", gravity), ("whole robot", whole))
        if rows
    ]
    if not groups:
        return ""
    sampled = (
        f'<p class="facts">Compared at the same joint positions, in {format_count(found.samples, "configuration")}.</p>'
        if motion and found.samples
        else ""
    )
    return f'<section class="follows" id="{model.id}-follows"><h3>What follows</h3>{"".join(groups)}{sampled}</section>'


def _render_shift(model: ComparedModel, number: int, shift: LinkShift) -> str:
    """Render how far a link moves; where that depends on the joints, the button shows where it is most."""
    limit = "up to " if shift.configuration else ""
    parts = []
    if shift.distance > _LEAST_LENGTH:
        parts.append(f"moves by {limit}{format_length(shift.distance, micrometres=True)}")
    if shift.angle > _LEAST_LENGTH:
        parts.append(f"rotates by {limit}{format_angle(shift.angle)}")
    what = f"link <b>{escape_html(shift.link)}</b> {' and '.join(parts)}"
    if not shift.configuration:
        return render_row(f"{model.id}-s{number}", f"{what}, in every configuration")
    worst = f"{what}; worst at {escape_html(format_configuration(shift.configuration))}"
    return render_row(f"{model.id}-s{number}", worst, button=WORST_BUTTON)


def _iter_totals(found: MechanismDiff) -> Iterator[str]:
    before, after = found.mass
    if abs(after - before) > _LEAST_SHARE * max(before, after):
        share = f" ({(after - before) / before * 100:+.2g} %)" if before else ""
        yield f"mass {before:.4g} → {after:.4g} kg{share}"
    if found.com_shift > _LEAST_LENGTH:
        yield f"COM moves by {format_length(found.com_shift, micrometres=True)}, all joints at zero"
