"""Findings counted by rule, and tables in plain text."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from urdfcheck.core import Applicability, Finding, Severity


@dataclass(slots=True)
class RuleSeverityCount:
    """What the findings of one rule and severity come to. ``models``: the ids of those that show one; ``fixable``: how many of
    them urdfcheck can repair, with or without --unsafe-fixes."""

    code: str
    name: str
    severity: Severity
    findings: int = 0
    models: set[str] = field(default_factory=set)
    fixable: int = 0


def count_by_rule(findings: Iterable[Finding]) -> list[RuleSeverityCount]:
    """The findings by rule and severity, the worst and then the most common first."""
    counts: dict[tuple[str, Severity], RuleSeverityCount] = {}
    for finding in findings:
        key = finding.code, finding.severity
        count = counts.setdefault(key, RuleSeverityCount(finding.code, finding.name, finding.severity))
        count.findings += 1
        count.models.update(finding.variants or (finding.model,))
        count.fixable += (
            finding.fix is not None and bool(finding.fix.edits) and finding.fix.applicability != Applicability.DISPLAY
        )
    return sorted(counts.values(), key=lambda c: (-c.severity, -c.findings, -len(c.models), c.code))


def format_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """Columns as wide as they must be: words to the left, numbers to the right."""
    widths = [max(len(row[column]) for row in (head, *rows)) for column in range(len(head))]
    numbers = [all(row[column].replace(",", "").isdigit() for row in rows) for column in range(len(head))]
    for row in (head, *rows):
        cells = zip(row, widths, numbers, strict=True)
        yield "  ".join(cell.rjust(width) if number else cell.ljust(width) for cell, width, number in cells)
