"""Findings for GitLab's widget on merge requests: a Code Quality report in the format of Code Climate."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from urdfcheck.core import Confidence, Finding, Rule, Run, Severity, Verdict
from urdfcheck.core.merging import list_line_entries
from urdfcheck.output.shared.escaping import escape_for_json, escape_for_markdown
from urdfcheck.output.shared.verdict.finding_details import iter_details
from urdfcheck.output.shared.wording import find_finding_file, sort_worst_first
from urdfcheck.policy.consumers import get_verdict


def render(run: Run) -> str:
    """Render a JSON array, the worst first."""
    issues = [*_iter_failure_issues(run), *_iter_finding_issues(run)]
    return escape_for_json(json.dumps(issues, indent=2, ensure_ascii=False) + "\n")


def _iter_failure_issues(run: Run) -> Iterator[dict[str, Any]]:
    """Report failures of urdfcheck itself at the first model: they belong to no line, and the report must not look clean."""
    path = run.models[0].path if run.models else "."
    for number, failure in enumerate(run.failures, 1):
        yield {
            "type": "issue",
            "check_name": "urdfcheck",
            "description": f"not checked: {failure}",
            "categories": ["Bug Risk"],
            "severity": "blocker",
            "fingerprint": f"failure-{number}",
            "location": {"path": path, "lines": {"begin": 1}},
        }


def _iter_finding_issues(run: Run) -> Iterator[dict[str, Any]]:
    counts: dict[str, int] = {}
    for finding in sort_worst_first(list_line_entries(run.active_findings, run.rules)):
        fingerprint = next(iter(finding.fingerprints), finding.code)
        number = counts[fingerprint] = counts.get(fingerprint, 0) + 1
        span = finding.location.span
        lines = {"begin": 1} if span is None else {"begin": span.line, "end": span.end_line}
        path = (find_finding_file(run, finding) or ".") if span is None else span.file
        yield {
            "type": "issue",
            "check_name": finding.code,
            "description": f"{finding.headline} [{finding.name}]",
            "content": {"body": _format_issue_body(run, finding)},
            "categories": ["Bug Risk"],
            "severity": _classify_severity(run, finding),
            # From the second finding of one fingerprint on there is a number, so that none hides another.
            "fingerprint": fingerprint if number == 1 else f"{fingerprint}-{number}",
            "location": {"path": path, "lines": lines},
        }


def _classify_severity(run: Run, finding: Finding) -> str:
    """Return GitLab's severity: a blocker if urdfdom or a target refuses the model; a heuristic warning is minor."""
    if finding.severity == Severity.ERROR:
        readers = run.targets or ("urdfdom",)
        refused = any(get_verdict(finding.consequences, reader) == Verdict.REFUSES for reader in readers)
        return "blocker" if refused else "critical"
    if finding.severity == Severity.WARNING:
        return "minor" if finding.confidence == Confidence.HEURISTIC else "major"
    return "info"


def _format_issue_body(run: Run, finding: Finding) -> str:
    """Format the message and the details of a finding and the summary of its rule as Markdown."""
    details = [
        f"**{escape_for_markdown(label)}:** {escape_for_markdown(text)}" for label, text in iter_details(run, finding)
    ]
    return "\n\n".join(
        [escape_for_markdown(finding.message), *details, *_format_rule_help(run.rules.get(finding.code))]
    )


def _format_rule_help(rule: Rule | None) -> list[str]:
    return [] if rule is None else [f"**{rule.code} {rule.name}:** {rule.summary}"]
