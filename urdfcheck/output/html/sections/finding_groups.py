"""The findings of one model, a card each, the worst first: errors and warnings, then notes, then those that are known."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from urdfcheck.core import Run, Severity
from urdfcheck.output.html.file_groups import select_active_cards
from urdfcheck.output.html.glyphs import render_glyph
from urdfcheck.output.html.html_text import escape_html, list_acceptors
from urdfcheck.output.html.sections.finding_card import render_card
from urdfcheck.output.shared.anchors import FindingCard

# Errors and warnings of a model in the list itself; the rest is folded. A fold that hides two saves no space.
MOST_LISTED, FEWEST_FOLDED = 20, 3


def render_problems(
    run: Run,
    cards: Sequence[FindingCard],
    *,
    model_file: str,
    is_checked: bool,
    is_lost: bool = False,
    set_aside: str = "",
) -> str:
    """Render errors and warnings: where to start, and what then. ``model_file``: the model's own file.

    ``is_lost``: whether a program refuses the model or drops a part of it all the same; ``set_aside``: why errors and warnings
    are not listed, if they are not.
    """
    problems = select_active_cards(cards, Severity.ERROR, Severity.WARNING)
    if set_aside and not problems and is_checked:
        return f'<p class="clean info">{render_glyph("info")} Errors and warnings are not listed: {escape_html(set_aside)}.</p>'
    if not problems:
        sentence = "No errors and no warnings." if select_active_cards(cards, Severity.INFO) else "No findings."
        # Of a model that was not checked its own line says why.
        kind = "info" if is_lost else "ok"
        return f'<p class="clean {kind}">{render_glyph(kind)} {sentence}</p>' if is_checked else ""
    first = render_card(run, problems[0], model_file=model_file, is_first=True)
    start = f'<section class="group"><h3>Start here</h3><div class="cards">{first}</div></section>'
    if len(problems) == 1:
        return start
    number = len(problems) if len(problems) < MOST_LISTED + FEWEST_FOLDED else MOST_LISTED
    listed = _render_cards(run, problems[1:number], model_file)
    if rest := problems[number:]:
        listed += _render_fold("rest", f"{len(rest)} more", _render_cards(run, rest, model_file))
    count = f'<span class="count">{len(problems) - 1}</span>'
    return f'{start}<section class="group"><h3>Then {count}</h3>{listed}</section>'


def render_notes(run: Run, cards: Sequence[FindingCard], *, model_file: str, id_prefix: str) -> str:
    """Render the notes and the suppressed findings, folded; empty if there is neither. ``id_prefix``: of the notes' id."""
    parts = []
    if notes := select_active_cards(cards, Severity.INFO):
        title = f'<h3>{render_glyph("info")} Notes <span class="count">{len(notes)}</span></h3>'
        body = f'<div id="{id_prefix}-info">{_render_cards(run, notes, model_file)}</div>'
        parts.append(_render_fold("notes info", title, body))
    suppressed = [c for c in cards if c.finding.suppressed is not None]
    if suppressed:
        kinds = Counter(c.finding.suppressed.kind for c in suppressed if c.finding.suppressed is not None)
        title = f"{len(suppressed)} known: {list_acceptors(kinds)}"
        parts.append(_render_fold("suppressed", title, _render_cards(run, suppressed, model_file)))
    return "\n".join(parts)


def _render_fold(css_class: str, title: str, body: str) -> str:
    return f'<details class="fold {css_class}"><summary>{title}</summary>{body}</details>'


def _render_cards(run: Run, cards: Sequence[FindingCard], model_file: str) -> str:
    return f'<div class="cards">{"".join(render_card(run, card, model_file=model_file) for card in cards)}</div>'
