"""The summary of an audit for a terminal: rules, worst models, and what could not be checked, a line each."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from urdfcheck.core import Rule
from urdfcheck.output.shared.audit.unit_lines import AuditSummary, UnitRow
from urdfcheck.output.shared.escaping import escape_for_log, escape_one_line
from urdfcheck.output.shared.rule_statistics import format_table
from urdfcheck.output.shared.verdict.not_checked import GLYPH
from urdfcheck.output.shared.wording import SEVERITY_ORDER, describe_suppressed

# Worst models shown; the index page shows all.
MOST_WORST = 10


def render_audit_summary(summary: AuditSummary, rules: Mapping[str, Rule]) -> str:
    """Render the summary as text, with a newline at the end."""
    return "".join(f"{escape_for_log(line).rstrip()}\n" for line in _iter_lines(summary, rules))


def _iter_lines(summary: AuditSummary, rules: Mapping[str, Rule]) -> Iterator[str]:
    if summary.rules:
        yield from format_table(
            ("rule", "", "severity", "findings", "models"),
            [
                (code, rules[code].name, str(count.severity), f"{count.findings:,}", f"{count.units:,}")
                for code, count in summary.rank_rules()
            ],
        )
        yield ""
    if summary.worst:
        yield from format_table(
            ("worst models", "errors", "warnings", "mostly"),
            [_format_worst_row(row) for row in summary.worst[:MOST_WORST]],
        )
        yield ""
    for row in summary.unchecked:
        yield f"{GLYPH} not checked ({row.status}): {escape_one_line(row.id)}"
        if row.command:
            yield f"  {escape_one_line(row.command)}"
    rest = sum(n for status, n in summary.statuses.items() if status != "checked") - len(summary.unchecked)
    if rest > 0:
        yield f"and {rest:,} more not checked"
    for failure in summary.failures:
        yield f"not checked: {escape_one_line(failure)}"
    if (more := summary.failure_count - len(summary.failures)) > 0:
        yield f"and {more:,} more {'failure' if more == 1 else 'failures'}"
    yield _format_totals(summary)


def _format_worst_row(row: UnitRow) -> tuple[str, ...]:
    errors, warnings, _ = row.counts
    return escape_one_line(row.id), f"{errors:,}", f"{warnings:,}", ", ".join(code for code, _, _ in row.codes[:3])


def _format_totals(summary: AuditSummary) -> str:
    counts = ", ".join(_format_count(summary.counts[severity], str(severity)) for severity in SEVERITY_ORDER)
    unchecked = summary.kinds["model"] - summary.statuses["checked"]
    macros = len(summary.unused_macro_files)
    lost = [f"{unchecked:,} of {_format_count(summary.kinds['model'], 'model')}"] if unchecked else []
    lost += [_format_count(macros, "macro file")] if macros else []
    first = f"{GLYPH} {' and '.join(lost)} not checked; " if lost else ""
    beside = [
        _format_count(summary.kinds[kind], word) for kind, word in (("launch", "launch file"), ("package", "package"))
    ]
    also = "".join(f", {text}" for text in beside if not text.startswith("0 "))
    with_errors = (
        f"; errors in {_format_count(summary.models_with_errors, 'model')}" if summary.models_with_errors else ""
    )
    hidden = describe_suppressed(summary.suppressed)
    return f"{first}{counts} in {_format_count(summary.kinds['model'], 'model')}{also}{with_errors}{hidden}"


def _format_count(count: int, word: str) -> str:
    return f"{count:,} {word}" + ("" if count == 1 or word == "info" else "s")
