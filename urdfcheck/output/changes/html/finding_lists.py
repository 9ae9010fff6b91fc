"""The findings that a change brings and those that it takes away."""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.core import Rule, Run
from urdfcheck.core.model_diff import Diff
from urdfcheck.output.html.sections.finding_card import render_card
from urdfcheck.output.shared.anchors import FindingCard


def render_findings(diff: Diff, section_id: str, new: Sequence[FindingCard], gone: Sequence[FindingCard]) -> str:
    """Render the cards of new findings and of those that are gone, the worst first; nothing without any."""
    if diff.runs is None or not (new or gone):
        return ""
    groups = "".join(
        _render_group(run, word, cards)
        for run, word, cards in ((diff.runs[1], "New findings", new), (diff.runs[0], "Findings that are gone", gone))
        if cards
    )
    return f'<section class="findings" id="{section_id}-findings">{groups}</section>'


def _render_group(run: Run, title: str, cards: Sequence[FindingCard]) -> str:
    ordered = sorted(cards, key=lambda card: -card.finding.severity)
    files = {info.id: info.path for info in run.models}
    listed = "".join(render_card(run, card, model_file=files.get(card.finding.model, "")) for card in ordered)
    count = f'<span class="count">{len(cards)}</span>'
    return f'<section class="group"><h3>{title} {count}</h3><div class="cards">{listed}</div></section>'


def list_rules(diff: Diff) -> list[Rule]:
    """List the rules behind the findings that came or went, by code."""
    if diff.runs is None:
        return []
    rules = {**diff.runs[0].rules, **diff.runs[1].rules}
    codes = sorted({finding.code for finding in (*diff.findings.new, *diff.findings.gone)})
    return [rules[code] for code in codes if code in rules]
