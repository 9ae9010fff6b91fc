"""The findings of one model, a card each: errors and warnings, and apart from them information."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from urdfcheck.core import Run, Severity
from urdfcheck.output.html.file_groups import FileGroup, group_cards_by_file, select_active_cards
from urdfcheck.output.html.glyphs import pluralize_severity, render_glyph
from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.html.sections.finding_card import render_card
from urdfcheck.output.shared.anchors import FindingCard

MOST_NOTES = 5
# Up to this many errors and warnings of a model are shown open; of more, only the errors.
MOST_OPEN = 12


def render_problems(
    run: Run, cards: Sequence[FindingCard], *, model_file: str, id_prefix: str, is_checked: bool
) -> str:
    """Render errors and warnings. ``model_file``: the model's own file; ``id_prefix`` makes the ids of the groups unique."""
    parts = []
    groups = [(severity, select_active_cards(cards, severity)) for severity in (Severity.ERROR, Severity.WARNING)]
    few = sum(len(group) for _, group in groups) <= MOST_OPEN
    for severity, group in groups:
        if group:
            body = _render_file_groups(run, group, model_file, is_open=few or severity == Severity.ERROR)
            parts.append(_render_severity_group(severity, body, id_prefix=id_prefix, count=len(group)))
    if not parts:
        sentence = "No errors and no warnings." if select_active_cards(cards, Severity.INFO) else "No findings."
        # Of a model that was not checked its own line says why.
        parts += [f'<p class="clean">{render_glyph("ok")} {sentence}</p>'] if is_checked else []
    return "\n".join(parts)


def render_notes(run: Run, cards: Sequence[FindingCard], *, model_file: str, id_prefix: str) -> str:
    """Render information, folded by file if there is much, and the suppressed findings; empty if there is neither."""
    parts = []
    if group := select_active_cards(cards, Severity.INFO):
        render = _render_file_groups if len(group) <= MOST_NOTES else _render_folded_files
        body = render(run, group, model_file)
        parts.append(_render_severity_group(Severity.INFO, body, id_prefix=id_prefix, count=len(group)))
    suppressed = [c for c in cards if c.finding.suppressed is not None]
    if suppressed:
        parts.append(
            f'<details class="suppressed"><summary>{len(suppressed)} known: {_describe_suppressed(suppressed)}</summary>'
            f"{_render_file_groups(run, suppressed, model_file)}</details>"
        )
    return "\n".join(parts)


def _describe_suppressed(cards: Sequence[FindingCard]) -> str:
    """Say how many findings the source, the configuration and the baseline suppress."""
    kinds = Counter(c.finding.suppressed.kind for c in cards if c.finding.suppressed is not None)
    return ", ".join(f"{kinds[kind]} in the {kind}" for kind in ("source", "configuration", "baseline") if kinds[kind])


def _render_severity_group(severity: Severity, body: str, *, id_prefix: str, count: int) -> str:
    title = f'<span class="count">{count}</span> {pluralize_severity(count, severity)}'
    head = f'<h3 id="{id_prefix}-{severity}">{render_glyph(severity)} <span>{title}</span></h3>'
    return f'<section class="group {severity}">{head}{body}</section>'


def _render_file_groups(run: Run, cards: Sequence[FindingCard], model_file: str, *, is_open: bool = False) -> str:
    groups = group_cards_by_file(cards, model_file)
    is_plain = len(groups) == 1 and groups[0].file in ("", model_file)
    return "\n".join(
        f'<div class="of-file">{"" if is_plain else _render_file_heading(group)}{_render_cards(run, group, is_open)}</div>'
        for group in groups
    )


def _render_folded_files(run: Run, cards: Sequence[FindingCard], model_file: str) -> str:
    return "\n".join(
        f'<details class="fold"><summary>{_render_file_heading(group)} <span class="count">{len(group.cards)}</span></summary>'
        f"{_render_cards(run, group)}</details>"
        for group in group_cards_by_file(cards, model_file)
    )


def _render_file_heading(group: FileGroup) -> str:
    if not group.file:
        return '<h4 class="file">the model as a whole</h4>'
    return f'<h4 class="file">{group.kind} <code>{escape_html(group.file)}</code></h4>'


def _render_cards(run: Run, group: FileGroup, is_open: bool = False) -> str:
    return f'<div class="cards">{"".join(render_card(run, card, is_open) for card in group.cards)}</div>'
