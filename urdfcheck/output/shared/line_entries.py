"""Findings as the formats list them that show a line of text with its findings: one entry for each rule and line."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping

from urdfcheck.core import Finding, Rule
from urdfcheck.core.findings import iter_occurrences
from urdfcheck.core.merging import join_occurrences


def list_line_entries(findings: Iterable[Finding], rules: Mapping[str, Rule]) -> list[Finding]:
    """Return an entry for each place of each finding: editors and reviews of changed lines need each of them.

    Several entries of a rule on one line are one, with the severity of the worst.
    """
    return join_on_lines(iter_occurrences(findings), rules)


def join_on_lines(findings: Iterable[Finding], rules: Mapping[str, Rule]) -> list[Finding]:
    """Join the findings of one rule that begin on one line; those that are known stay apart from those that count."""
    groups: dict[Hashable, list[Finding]] = {}
    for number, finding in enumerate(findings):
        span = finding.location.span
        place: Hashable = number if span is None else (finding.code, span.file, span.line, finding.suppressed)
        groups.setdefault(place, []).append(finding)
    return [group[0] if len(group) == 1 else join_occurrences(group, rules) for group in groups.values()]
