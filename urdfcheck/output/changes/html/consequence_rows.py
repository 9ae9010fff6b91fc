"""What follows from the changes: positions, collisions, gravity, inertias, the stance, and the mass of the whole."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core.model_diff import EFFECTS, LinkShift, MechanismDiff, MechanismEffect
from urdfcheck.core.text import format_angle, format_configuration, format_count, format_length, format_share
from urdfcheck.output.changes.html.compared_models import ComparedModel
from urdfcheck.output.changes.html.rows import (
    BUTTON,
    WORST_BUTTON,
    emphasize_parts,
    render_fact,
    render_kind,
    render_row,
)
from urdfcheck.output.changes.text import describe_torque, describe_unread
from urdfcheck.output.html.html_text import escape_html

# As `urdfcheck diff` itself compares: m, and share.
_LEAST_LENGTH, _LEAST_SHARE = 2e-5, 1e-5


def render_consequences(model: ComparedModel) -> str:
    """Render positions, collisions, torques and the like; nothing where none of it changes."""
    found = model.found
    if found is None:
        return ""
    groups = [render_kind(label, rows) for label, rows in _iter_kinds(model, found) if rows]
    if not groups:
        return ""
    facts = "".join(f'<p class="facts">{escape_html(fact)}</p>' for fact in _iter_facts(found))
    return f'<section class="follows" id="{model.id}-follows"><h3>What follows</h3>{"".join(groups)}{facts}</section>'


def has_consequences(found: MechanismDiff) -> bool:
    """Whether something follows from the changes."""
    return bool(found.shifts or found.torques or found.effects) or any(_iter_totals(found))


def _iter_kinds(model: ComparedModel, found: MechanismDiff) -> Iterator[tuple[str, list[str]]]:
    """Yield what the rows of a kind are called, and the rows, some kinds without any."""
    yield "position", [_render_shift(model, number, shift) for number, shift in enumerate(found.shifts)]
    effects = {kind: [(n, effect) for n, effect in enumerate(found.effects) if effect.kind == kind] for kind in EFFECTS}
    yield "collision", [_render_effect(model, *entry) for entry in effects.pop("collision")]
    yield (
        "gravity",
        [
            render_row(f"{model.id}-t{number}", emphasize_parts(describe_torque(torque), f"joint[{torque.joint}]"))
            for number, torque in enumerate(found.torques)
        ],
    )
    for kind, entries in effects.items():
        yield kind, [_render_effect(model, *entry) for entry in entries]
    yield "whole robot", [render_fact(text) for text in _iter_totals(found)]


def _iter_facts(found: MechanismDiff) -> Iterator[str]:
    """Yield in how many configurations was compared, and what could not be."""
    moved = found.samples if found.shifts else 0
    met = 0 if found.collisions is None else found.collisions.samples
    if moved:
        yield f"Compared at the same joint positions, in {format_count(moved, 'configuration')}."
    if met and met != moved:
        yield f"Collisions were compared in {format_count(met, 'configuration')}."
    if unread := describe_unread(found):
        yield f"Collisions {unread}."


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


def _render_effect(model: ComparedModel, number: int, effect: MechanismEffect) -> str:
    what = emphasize_parts(model.difference.effects[number], effect.subject, effect.other)
    return render_row(f"{model.id}-e{number}", what, button=WORST_BUTTON if effect.configuration else BUTTON)


def _iter_totals(found: MechanismDiff) -> Iterator[str]:
    before, after = found.mass
    if abs(after - before) > _LEAST_SHARE * max(before, after):
        yield f"mass {before:.4g} → {after:.4g} kg{format_share(before, after)}"
    if found.com_shift > _LEAST_LENGTH:
        yield f"COM moves by {format_length(found.com_shift, micrometres=True)}, all joints at zero"
