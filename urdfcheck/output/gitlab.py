"""Findings for GitLab's widget on merge requests: a Code Quality report, as Code Climate wrote it."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from urdfcheck.core import Confidence, Finding, Rule, Run, Severity, Verdict
from urdfcheck.output.shared.inert import escape_for_json, escape_for_markdown
from urdfcheck.output.shared.wording import find_finding_file, iter_details, sort_worst_first
from urdfcheck.policy.consumers import get_verdict


def render(run: Run) -> str:
    """A JSON array, the worst first."""
    found = [*_iter_failure_issues(run), *_iter_finding_issues(run)]
    return escape_for_json(json.dumps(found, indent=2, ensure_ascii=False) + "\n")


def _iter_failure_issues(run: Run) -> Iterator[dict[str, Any]]:
    """What failed in urdfcheck itself belongs to no line: it is shown at the first model, lest the report look clean."""
    path = run.models[0].path if run.models else "."
    for number, failure in enumerate(run.failures, 1):
        yield {
            "type": "issue",
            "check_name": "urdfcheck",
            "description": f"urdfcheck failed: {failure}",
            "categories": ["Bug Risk"],
            "severity": "blocker",
            "fingerprint": f"failure-{number}",
            "location": {"path": path, "lines": {"begin": 1}},
        }


def _iter_finding_issues(run: Run) -> Iterator[dict[str, Any]]:
    seen: dict[str, int] = {}
    for finding in sort_worst_first(run.active_findings):
        first = next(iter(finding.fingerprints), finding.code)
        seen[first] = seen.get(first, 0) + 1
        at = finding.location.span
        lines = {"begin": 1} if at is None else {"begin": at.line, "end": at.end_line}
        yield {
            "type": "issue",
            "check_name": finding.code,
            "description": f"{finding.message} [{finding.name}]",
            "content": {"body": _format_issue_body(run, finding)},
            "categories": ["Bug Risk"],
            "severity": _classify_severity(run, finding),
            # Of findings with one fingerprint the second has a number, so that none hides another.
            "fingerprint": first if seen[first] == 1 else f"{first}-{seen[first]}",
            "location": {"path": (find_finding_file(run, finding) or ".") if at is None else at.file, "lines": lines},
        }


def _classify_severity(run: Run, finding: Finding) -> str:
    """A blocker where urdfdom or a target has no model at all; a hint weighs less than what is sure."""
    if finding.severity == Severity.ERROR:
        readers = run.targets or ("urdfdom",)
        refused = any(get_verdict(finding.consequences, reader) == Verdict.REFUSES for reader in readers)
        return "blocker" if refused else "critical"
    if finding.severity == Severity.WARNING:
        return "minor" if finding.confidence == Confidence.HEURISTIC else "major"
    return "info"


def _format_issue_body(run: Run, finding: Finding) -> str:
    """Markdown: what else is known of the finding, and what its rule is about."""
    told = [
        f"**{escape_for_markdown(label)}:** {escape_for_markdown(text)}" for label, text in iter_details(run, finding)
    ]
    return "\n\n".join([*told, *_format_rule_help(run.rules.get(finding.code))])


def _format_rule_help(rule: Rule | None) -> list[str]:
    return [] if rule is None else [f"**{rule.code} {rule.name}:** {rule.summary}"]
