"""Findings counted by rule, and tables in plain text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import field

from urdfcheck.core import Applicability, Finding, Severity
from urdfcheck.core.records import dataclass


@dataclass(slots=True, kw_only=True)
class RuleSeverityCount:
    """The findings of one rule and severity, counted."""

    code: str
    name: str
    severity: Severity
    findings: int = 0
    models: set[str] = field(default_factory=set)
    """Ids of the models that show a finding."""
    fixable: int = 0
    """Number of findings that urdfcheck can repair, with or without --unsafe-fixes."""


def count_by_rule(findings: Iterable[Finding]) -> list[RuleSeverityCount]:
    """Count the findings by rule and severity, the worst and then the most common first."""
    counts: dict[tuple[str, Severity], RuleSeverityCount] = {}
    for finding in findings:
        key = finding.code, finding.severity
        new_count = RuleSeverityCount(code=finding.code, name=finding.name, severity=finding.severity)
        count = counts.setdefault(key, new_count)
        count.findings += 1
        count.models.update(finding.subjects_by_model)
        count.fixable += (
            finding.fix is not None and bool(finding.fix.edits) and finding.fix.applicability != Applicability.DISPLAY
        )
    return sorted(counts.values(), key=lambda c: (-c.severity, -c.findings, -len(c.models), c.code))


def format_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """Yield the lines of a table whose columns fit their cells: words to the left, numbers to the right."""
    widths = [max(len(row[column]) for row in (head, *rows)) for column in range(len(head))]
    numbers = [all(row[column].replace(",", "").isdigit() for row in rows) for column in range(len(head))]
    for row in (head, *rows):
        cells = zip(row, widths, numbers, strict=True)
        yield "  ".join(cell.rjust(width) if number else cell.ljust(width) for cell, width, number in cells)
