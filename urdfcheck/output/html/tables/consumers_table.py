"""What each program will do with a model, as a table."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

from urdfcheck.core import Finding, Rule
from urdfcheck.output.html.glyphs import render_glyph
from urdfcheck.output.html.html_text import NO_VALUE, escape_html
from urdfcheck.output.html.program_outcomes import describe_outcome, rate_outcome, select_launch_findings
from urdfcheck.output.html.tables.html_table import render_table
from urdfcheck.output.shared.wording import PROGRAM_NAMES
from urdfcheck.policy.consumers import ConsumerOutcome, predict_outcomes


def render_consumers_table(findings: Iterable[Finding], rules: Mapping[str, Rule]) -> str:
    """Render a row for each program: what it does with the model, and with its launch files where they have findings.

    Codes of the given rules are links to their pages.
    """
    findings = list(findings)
    launched = select_launch_findings(findings, rules)
    columns = ["Program", "What it does", "Because of", *(["When launched"] if launched else [])]
    head = "".join(f'<th scope="col">{column}</th>' for column in columns)
    rows = (
        _render_consumer_row(name, outcome, rules, _render_launch_cell(name, launched, rules))
        for name, outcome in predict_outcomes(findings).items()
    )
    return render_table("What each program does with the model, according to these findings", f"<tr>{head}</tr>", rows)


def _render_consumer_row(name: str, outcome: ConsumerOutcome, rules: Collection[str], launch_cell: str) -> str:
    kind, verdict = rate_outcome(outcome), describe_outcome(outcome)
    codes = ", ".join(_render_code(code, rules) for code in outcome.codes or outcome.unproven)
    return (
        f'<tr><th scope="row">{escape_html(PROGRAM_NAMES.get(name, name))}</th>'
        f'<td class="{kind}">{render_glyph(kind)} {verdict}</td><td>{codes or NO_VALUE}</td>{launch_cell}</tr>'
    )


def _render_launch_cell(name: str, launched: Sequence[Finding], rules: Collection[str]) -> str:
    """Render what the findings about launch files say of a program; empty where there are none for any."""
    if not launched:
        return ""
    told = {
        f'<p class="{finding.severity}">{render_glyph(finding.severity)} {escape_html(finding.consequences[name])} '
        f"({_render_code(finding.code, rules)})</p>"
        for finding in launched
        if name in finding.consequences
    }
    return f"<td>{''.join(sorted(told)) or NO_VALUE}</td>"


def _render_code(code: str, rules: Collection[str]) -> str:
    return f'<a href="#rule-{code}"><code>{code}</code></a>' if code in rules else f"<code>{escape_html(code)}</code>"
