"""The end of the report: the rules that fired, explained; what could not be checked; how the report was made."""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.core import Rule, Run
from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.html.rule_markdown import render_markdown
from urdfcheck.output.html.tables.checks_tables import render_rules_table, render_skipped_table
from urdfcheck.output.shared.rule_page import SHOWN_SECTIONS, find_rule_address, split_sections
from urdfcheck.output.shared.wording import format_count


def list_fired_rules(run: Run) -> list[Rule]:
    """List the rules behind the findings that have a page, by code."""
    return [run.rules[code] for code in sorted({f.code for f in run.findings}) if code in run.rules]


def render_appendix(run: Run) -> str:
    """Render the fired rules, the skipped checks, all checks, and how the report was made."""
    parts = []
    if fired := list_fired_rules(run):
        parts.append(render_rule_pages(fired))
    parts.append(_render_skipped_checks(run))
    parts.append(
        f'<section id="checks"><h2>Checks</h2><details class="screen"><summary>All {format_count(len(run.rules), "rule")} '
        f"and what they found</summary>{render_rules_table(run)}</details></section>"
    )
    parts.append(_render_about(run))
    return "\n".join(parts)


def render_rule_pages(rules: Sequence[Rule]) -> str:
    """Render what rules check, why, and how to fix it, each folded."""
    pages = "\n".join(map(_render_rule_page, rules))
    return f'<section id="rules" class="rules"><h2>The rules behind the findings</h2>{pages}</section>'


def _render_rule_page(rule: Rule) -> str:
    texts = split_sections(rule.page)
    shown = "".join(
        f"<h4>{title}</h4>{render_markdown(texts[title])}" for title in SHOWN_SECTIONS if texts.get(title, "").strip()
    )
    code, address = escape_html(rule.code), find_rule_address(rule.code)
    link = f' · <a href="{escape_html(address)}">page of {code}</a>' if address else ""
    return (
        f'<details class="rule screen"><summary><h3><span class="rule-code">{code}</span> {escape_html(rule.name)}</h3></summary>'
        # A browser opens a fold whose content is the target of a link, but not a fold that is itself the target.
        f'<div id="rule-{code}"><p class="facts">{rule.severity} · {rule.confidence} · since {escape_html(rule.since)}{link}</p>'
        f"{shown}</div></details>"
    )


def _render_skipped_checks(run: Run) -> str:
    if not run.skipped and run.unchecked_models:
        text = "<p>All checks ran on the checked models.</p>"
    elif not run.skipped:
        text = "<p>All checks ran on every model.</p>"
    else:
        count = len({(s.code, s.reason) for s in run.skipped})
        text = f"<details><summary>{format_count(count, 'check')} could not run</summary>{render_skipped_table(run)}</details>"
    return f'<section id="skipped"><h2>Skipped checks</h2>{text}</section>'


def _render_about(run: Run) -> str:
    versions = "".join(
        f"<div><dt>{escape_html(k)}</dt><dd>{escape_html(v)}</dd></div>" for k, v in run.versions.items()
    )
    # A reproducible report has no duration.
    took = f' in <span class="seconds">{run.seconds:.1f} s</span>' if run.seconds else ""
    return (
        '<section id="about"><h2>How this report was made</h2>'
        f"<p>urdfcheck read {format_count(len(run.models), 'model')}{took}. "
        "It ran nothing of the robot's own code, and this file loads nothing from anywhere.</p>"
        f'<dl class="facts">{versions}</dl></section>'
    )
