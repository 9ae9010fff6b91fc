"""Findings for reviewdog: its DiagnosticResult, whose columns count bytes of UTF-8 from 1, ends exclusive."""

from __future__ import annotations

import json
from typing import Any

from urdfcheck.core import Edit, Finding, Run, Severity, Span
from urdfcheck.output.shared.inert import for_json, for_markdown
from urdfcheck.output.shared.positions import utf8
from urdfcheck.output.shared.wording import details, own_file, worst_first


def render(run: Run) -> str:
    """One JSON object. Messages are inert Markdown, for reviewdog makes comments of them."""
    found = worst_first(run.active)
    worst = Severity.ERROR if run.failures else max((f.severity for f in found), default=None)
    result = {
        "source": {"name": "urdfcheck"},
        **({} if worst is None else {"severity": _name(worst)}),
        "diagnostics": [*(_failed(run, failure) for failure in run.failures), *(_diagnostic(run, f) for f in found)],
    }
    return for_json(json.dumps(result, indent=2, ensure_ascii=False) + "\n")


def _name(severity: Severity) -> str:
    return severity.name


def _failed(run: Run, failure: str) -> dict[str, Any]:
    return {
        "message": f"urdfcheck failed: {for_markdown(failure)}",
        "location": {"path": run.models[0].path if run.models else "."},
        "severity": "ERROR",
    }


def _diagnostic(run: Run, finding: Finding) -> dict[str, Any]:
    at = finding.location.span
    lines = [for_markdown(finding.message)]
    lines += [f"{for_markdown(label)}: {for_markdown(text)}" for label, text in details(run, finding)]
    related = [
        {"message": for_markdown(r.subject), "location": _location(run, r.span)} for r in finding.related if r.span
    ]
    suggestions = [] if at is None else _suggestions(run, finding, at)
    return {
        "message": "\n".join(lines),
        "location": {"path": own_file(run, finding) or "."} if at is None else _location(run, at),
        "severity": _name(finding.severity),
        "source": {"name": "urdfcheck"},
        "code": {"value": finding.code},
        **({"suggestions": suggestions} if suggestions else {}),
        **({"related_locations": related} if related else {}),
    }


def _location(run: Run, span: Span) -> dict[str, Any]:
    return {"path": span.file, "range": _range(run, span)}


def _range(run: Run, span: Span) -> dict[str, Any]:
    at = utf8(span, run.sources)
    return {
        "start": {"line": at.line, "column": at.column},
        "end": {"line": at.end_line, "column": at.end_column},
    }


def _suggestions(run: Run, finding: Finding, at: Span) -> list[dict[str, Any]]:
    """The repair, where it is one edit in the lines of the finding: each suggestion is applied alone, and reviewdog takes only
    those for the lines that it comments on."""
    edits = () if finding.fix is None else finding.fix.edits
    if len(edits) != 1 or not _same_lines(edits[0], at):
        return []
    return [{"range": _range(run, edits[0].span), "text": edits[0].replacement}]


def _same_lines(edit: Edit, at: Span) -> bool:
    span = edit.span
    return (span.file, span.line, span.end_line) == (at.file, at.line, at.end_line)
