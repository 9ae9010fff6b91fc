"""A table of contents: a model's errors and warnings in a line each, with links to their cards."""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.core import Severity
from urdfcheck.output.html.file_groups import group_cards_by_file, select_active_cards
from urdfcheck.output.html.glyphs import render_glyph
from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.shared.anchors import FindingCard
from urdfcheck.output.shared.wording import get_base_name

MOST_LINES = 12


def render_contents(cards: Sequence[FindingCard], model_file: str) -> str:
    """Render links in the order of the cards; nothing for a single card, which follows immediately."""
    ordered = [
        card
        for severity in (Severity.ERROR, Severity.WARNING)
        for group in group_cards_by_file(select_active_cards(cards, severity), model_file)
        for card in group.cards
    ]
    if len(ordered) < 2:
        return ""
    lines = [_render_link_line(card) for card in ordered]
    # A fold that hides only two lines saves no space.
    if len(lines) <= MOST_LINES + 2:
        return _render_link_list(lines)
    shown, rest = lines[:MOST_LINES], lines[MOST_LINES:]
    folded = f"<details><summary>{len(rest)} more</summary>{_render_link_list(rest)}</details>"
    return f"{_render_link_list(shown)}{folded}"


def _render_link_list(lines: Sequence[str]) -> str:
    return f'<ul class="contents" aria-label="Errors and warnings">{"".join(lines)}</ul>'


def _render_link_line(card: FindingCard) -> str:
    finding = card.finding
    span = finding.location.span
    place = "" if span is None else f" <small><code>{escape_html(get_base_name(span.file))}:{span.line}</code></small>"
    return (
        f'<li class="{finding.severity}"><a href="#{card.anchors[0]}">{render_glyph(finding.severity)}'
        f'<span class="sr"> {finding.severity} </span> <span class="rule-code">{escape_html(finding.code)}</span> '
        f'<span class="gist">{escape_html(finding.headline)}{place}</span></a></li>'
    )
