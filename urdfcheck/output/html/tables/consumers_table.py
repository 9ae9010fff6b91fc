"""What each program will do with a model, as a table."""

from __future__ import annotations

from collections.abc import Collection, Iterable

from urdfcheck.core import Finding, Verdict
from urdfcheck.output.html.glyphs import render_glyph
from urdfcheck.output.html.html_text import NO_VALUE, escape_html
from urdfcheck.output.html.tables.html_table import render_table
from urdfcheck.output.shared.wording import PROGRAM_NAMES
from urdfcheck.policy.consumers import ConsumerOutcome, predict_outcomes

VERDICT_TEXTS = {
    Verdict.LOADS: ("ok", "loads it as typed"),
    Verdict.IGNORES: ("warning", "loads it changed: ignores a part"),
    Verdict.REPLACES: ("warning", "loads it changed: replaces values"),
    Verdict.SWAPS: ("warning", "loads it changed: swaps values"),
    Verdict.NAN: ("warning", "loads it and computes NaN"),
    Verdict.DROPS: ("error", "loads it changed: drops a part"),
    Verdict.REFUSES: ("error", "refuses it"),
}


def render_consumers_table(findings: Iterable[Finding], rules: Collection[str]) -> str:
    """Render a row for each program; codes of the given rules are links to their pages."""
    head = '<tr><th scope="col">Program</th><th scope="col">What it does</th><th scope="col">Because of</th></tr>'
    rows = (_render_consumer_row(name, outcome, rules) for name, outcome in predict_outcomes(findings).items())
    return render_table("What becomes of the model, as far as these findings tell", head, rows)


def _render_consumer_row(name: str, outcome: ConsumerOutcome, rules: Collection[str]) -> str:
    kind, verdict = VERDICT_TEXTS[outcome.verdict]
    codes = ", ".join(
        f'<a href="#rule-{code}"><code>{code}</code></a>' if code in rules else f"<code>{escape_html(code)}</code>"
        for code in outcome.codes
    )
    return (
        f'<tr><th scope="row">{escape_html(PROGRAM_NAMES.get(name, name))}</th>'
        f'<td class="{kind}">{render_glyph(kind)} {verdict}</td><td>{codes or NO_VALUE}</td></tr>'
    )
