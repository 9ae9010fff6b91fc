"""Findings for reviewdog: its DiagnosticResult, whose columns count bytes of UTF-8 from 1, ends exclusive."""

from __future__ import annotations

import json
from typing import Any

from urdfcheck.core import Edit, Finding, Run, Severity, Span
from urdfcheck.core.merging import list_line_entries
from urdfcheck.output.shared.escaping import escape_for_json, escape_for_markdown
from urdfcheck.output.shared.positions import to_utf8_region
from urdfcheck.output.shared.verdict.finding_details import iter_details
from urdfcheck.output.shared.wording import find_finding_file, sort_worst_first


def render(run: Run) -> str:
    """Render one JSON object. Messages are inert Markdown, because reviewdog turns them into comments."""
    findings = sort_worst_first(list_line_entries(run.active_findings, run.rules))
    worst = Severity.ERROR if run.failures else max((f.severity for f in findings), default=None)
    result = {
        "source": {"name": "urdfcheck"},
        **({} if worst is None else {"severity": _get_severity_name(worst)}),
        "diagnostics": [
            *(_build_failure(run, failure) for failure in run.failures),
            *(_build_diagnostic(run, finding) for finding in findings),
        ],
    }
    return escape_for_json(json.dumps(result, indent=2, ensure_ascii=False) + "\n")


def _get_severity_name(severity: Severity) -> str:
    return severity.name


def _build_failure(run: Run, failure: str) -> dict[str, Any]:
    return {
        "message": f"not checked: {escape_for_markdown(failure)}",
        "location": {"path": run.models[0].path if run.models else "."},
        "severity": "ERROR",
    }


def _build_diagnostic(run: Run, finding: Finding) -> dict[str, Any]:
    span = finding.location.span
    lines = [escape_for_markdown(text) for text in (finding.headline, finding.message)]
    lines += [
        f"{escape_for_markdown(label)}: {escape_for_markdown(text)}" for label, text in iter_details(run, finding)
    ]
    related = [
        {"message": escape_for_markdown(r.subject), "location": _build_location(run, r.span)}
        for r in finding.related
        if r.span
    ]
    suggestions = [] if span is None else _build_suggestions(run, finding, span)
    return {
        "message": "\n".join(lines),
        "location": {"path": find_finding_file(run, finding) or "."} if span is None else _build_location(run, span),
        "severity": _get_severity_name(finding.severity),
        "source": {"name": "urdfcheck"},
        "code": {"value": finding.code},
        **({"suggestions": suggestions} if suggestions else {}),
        **({"related_locations": related} if related else {}),
    }


def _build_location(run: Run, span: Span) -> dict[str, Any]:
    return {"path": span.file, "range": _build_range(run, span)}


def _build_range(run: Run, span: Span) -> dict[str, Any]:
    region = to_utf8_region(span, run.sources)
    return {
        "start": {"line": region.line, "column": region.column},
        "end": {"line": region.end_line, "column": region.end_column},
    }


def _build_suggestions(run: Run, finding: Finding, span: Span) -> list[dict[str, Any]]:
    """Suggest the repair if it is one edit in the lines of the finding.

    Each suggestion is applied alone, and reviewdog accepts only those for the lines that it comments on."""
    edits = () if finding.fix is None else finding.fix.edits
    if len(edits) != 1 or not _is_on_same_lines(edits[0], span):
        return []
    return [{"range": _build_range(run, edits[0].span), "text": edits[0].replacement}]


def _is_on_same_lines(edit: Edit, span: Span) -> bool:
    edited = edit.span
    return (edited.file, edited.line, edited.end_line) == (span.file, span.line, span.end_line)
