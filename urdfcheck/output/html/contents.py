"""A model's errors and warnings in a line each: the way to their cards."""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.core import Severity
from urdfcheck.output.html.glyphs import glyph
from urdfcheck.output.html.groups import active, by_file
from urdfcheck.output.html.text import base_name, esc, gist
from urdfcheck.output.shared.anchors import Card

MOST_LINES = 12


def contents_html(cards: Sequence[Card], own: str) -> str:
    """Links in the order of the cards; nothing where there is but one card, which follows at once."""
    ordered = [
        card
        for severity in (Severity.ERROR, Severity.WARNING)
        for group in by_file(active(cards, severity), own)
        for card in group.cards
    ]
    if len(ordered) < 2:
        return ""
    lines = [_line(card) for card in ordered]
    # A fold that hides a line or two costs more than it saves.
    if len(lines) <= MOST_LINES + 2:
        return _list(lines)
    rest = len(lines) - MOST_LINES
    return f"{_list(lines[:MOST_LINES])}<details><summary>{rest} more</summary>{_list(lines[MOST_LINES:])}</details>"


def _list(lines: Sequence[str]) -> str:
    return f'<ul class="contents" aria-label="Errors and warnings">{"".join(lines)}</ul>'


def _line(card: Card) -> str:
    finding = card.finding
    span = finding.location.span
    place = "" if span is None else f" <small><code>{esc(base_name(span.file))}:{span.line}</code></small>"
    return (
        f'<li class="{finding.severity}"><a href="#{card.ids[0]}">{glyph(finding.severity)}'
        f'<span class="sr"> {finding.severity} </span> <span class="rule-code">{esc(finding.code)}</span> '
        f'<span class="gist">{esc(gist(finding.message))}{place}</span></a></li>'
    )
