"""The rules of a run and the checks that could not run, as tables."""

from __future__ import annotations

from urdfcheck.core import Rule, Run
from urdfcheck.core.text import join_names
from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.html.rule_markdown import render_inline
from urdfcheck.output.html.tables.html_table import render_table
from urdfcheck.output.shared.wording import format_count

MOST_MODELS = 4


def render_skipped_table(run: Run) -> str:
    """Render a row per check and reason; ``run.skipped`` must not be empty."""
    models: dict[tuple[str, str], list[str]] = {}
    for skip in run.skipped:
        models.setdefault((skip.code, skip.reason), []).append(skip.model)
    rows = []
    for (code, reason), names in sorted(models.items()):
        rule = run.rules.get(code)
        name = "" if rule is None else f" {escape_html(rule.name)}"
        rows.append(
            f'<tr><th scope="row"><code>{escape_html(code)}</code>{name}</th><td>{escape_html(reason)}</td>'
            f"<td>{escape_html(join_names(list(dict.fromkeys(names)), MOST_MODELS))}</td></tr>"
        )
    head = '<tr><th scope="col">Check</th><th scope="col">Why it could not run</th><th scope="col">Models</th></tr>'
    return render_table("Checks that could not run", head, rows)


def render_rules_table(run: Run) -> str:
    """Render a row for every rule of the run, with or without findings."""
    fired: dict[str, int] = {}
    for finding in run.findings:
        fired[finding.code] = fired.get(finding.code, 0) + 1
    skipped: dict[str, int] = {}
    for skip in run.skipped:
        skipped[skip.code] = skipped.get(skip.code, 0) + 1
    rows = (
        _render_rule_row(rule, fired.get(code, 0), skipped.get(code, 0)) for code, rule in sorted(run.rules.items())
    )
    head = '<tr><th scope="col">Rule</th><th scope="col">What it checks</th><th scope="col">Outcome</th></tr>'
    return render_table("Rules of this run", head, rows)


def _render_rule_row(rule: Rule, fired: int, skipped: int) -> str:
    name = f"<code>{escape_html(rule.code)}</code> {escape_html(rule.name)}"
    if fired:
        name = f'<a href="#rule-{escape_html(rule.code)}">{name}</a>'
    counts = [format_count(fired, "finding")] if fired else []
    counts += [f"skipped {format_count(skipped, 'time')}"] if skipped else []
    outcome = ", ".join(counts) or "no finding"
    return f'<tr><th scope="row">{name}</th><td>{render_inline(rule.summary)}</td><td>{outcome}</td></tr>'
