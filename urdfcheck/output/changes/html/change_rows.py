"""The rows of the page: what changes, by kind, and what follows from it."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import groupby

from urdfcheck.core.model_diff import ChangeCause, Diff, LinkShift, MechanismChange, MechanismDiff
from urdfcheck.core.text import format_angle, format_configuration, format_count, format_length
from urdfcheck.output.changes.causes import strip_revision
from urdfcheck.output.changes.html.compared_models import ComparedModel
from urdfcheck.output.changes.summary import get_label
from urdfcheck.output.changes.text import describe_torque
from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.shared.wording import get_base_name

# Rows of one kind that are not folded. A fold that hides two saves no space.
MOST_ROWS, FEWEST_FOLDED = 12, 3
_PART = re.compile(r"(link|joint)\[([^\]]*)\]", re.DOTALL)
_BUTTON = '<button type="button" class="in-3d" title="Show in 3D" aria-label="Show in 3D" hidden>3D</button>'
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
        groups.append(_render_kind(get_label(category), rows))
    count = f'<span class="count">{len(entries)}</span>'
    return f'<section class="changes" id="{model.id}-changes"><h3>What changes {count}</h3>{"".join(groups)}</section>'


def _render_place(diff: Diff, cause: ChangeCause, anchor: str) -> str:
    """Render a link to a cause: the first of its lines, in the second version if that has any."""
    lines, version = (cause.after, diff.after) if cause.after else (cause.before, diff.before)
    file, line, _ = lines[0]
    place = f"{get_base_name(strip_revision(file, version))}:{line}"
    return f'<a class="why" href="#{anchor}"><code>{escape_html(place)}</code></a>'


def _render_change(model: ComparedModel, number: int, change: MechanismChange, place: str) -> str:
    what = _emphasize_part(change, model.difference.texts[number])
    return _render_row(f"{model.id}-c{number}", what, place, is_shown=bool(_PART.search(change.subject)))


def _emphasize_part(change: MechanismChange, text: str) -> str:
    """Render the sentence about a change, which begins with the part, with the part's name in bold."""
    match = _PART.fullmatch(change.subject)
    start = change.subject if match is None else f"{match[1]} {match[2]}"
    if not text.startswith(f"{start} "):
        return escape_html(text)
    kind = "" if match is None else f"{match[1]} "
    return f"{kind}<b>{escape_html(start[len(kind) :])}</b>{escape_html(text[len(start) :])}"


def _render_row(entry_id: str, what: str, more: str = "", *, is_shown: bool = True, button: str = _BUTTON) -> str:
    ways = f'<span class="ways">{more}{button if is_shown else ""}</span>'
    return f'<li class="entry" id="{entry_id}" tabindex="-1"><span class="what">{what}</span>{ways}</li>'


def _render_kind(label: str, rows: Sequence[str]) -> str:
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


# -- what follows ------------------------------------------------------------------------------------------------------


def render_consequences(model: ComparedModel) -> str:
    """Render how far links move, what gravity asks of joints, and the mass of the whole; nothing where none of it changes."""
    found = model.found
    if found is None:
        return ""
    motion = [_render_shift(model, number, shift) for number, shift in enumerate(found.shifts)]
    gravity = [
        _render_row(f"{model.id}-t{number}", escape_html(describe_torque(torque)))
        for number, torque in enumerate(found.torques)
    ]
    whole = [f'<li class="fact"><span class="what">{text}</span></li>' for text in _iter_totals(found)]
    groups = [
        _render_kind(label, rows)
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
        return _render_row(f"{model.id}-s{number}", f"{what}, in every configuration")
    worst = f"{what}; worst at {escape_html(format_configuration(shift.configuration))}"
    button = (
        '<button type="button" class="in-3d" title="Move the joints to where it is worst" hidden>Show worst</button>'
    )
    return _render_row(f"{model.id}-s{number}", worst, button=button)


def _iter_totals(found: MechanismDiff) -> Iterator[str]:
    before, after = found.mass
    if abs(after - before) > _LEAST_SHARE * max(before, after):
        share = f" ({(after - before) / before * 100:+.2g} %)" if before else ""
        yield f"mass {before:.4g} → {after:.4g} kg{share}"
    if found.com_shift > _LEAST_LENGTH:
        yield f"COM moves by {format_length(found.com_shift, micrometres=True)}, all joints at zero"
