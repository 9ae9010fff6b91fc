"""The report for other programs: the object of ``report.schema.json``."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from typing import Any

from urdfcheck.core import Finding, Fix, ModelInfo, Run, Severity, SkippedCheck, Span
from urdfcheck.output.shared.drops import build_drop_test_object
from urdfcheck.output.shared.inert import escape_for_json
from urdfcheck.policy.consumers import predict_outcomes

SCHEMA = "urdfcheck/1"
_NO_ARGUMENTS: Mapping[str, str] = {}
_SUBJECT = re.compile(r"^(?P<kind>[^/\[@]+)\[(?P<name>.*?)\](?=[/@]|$)", re.DOTALL)


def render(run: Run) -> str:
    """Two-space indented JSON with a newline at the end. Only ``seconds`` differs between equal runs."""
    report = {
        "schema": SCHEMA,
        "version": run.versions["urdfcheck"],
        "targets": list(run.targets),
        "models": [build_model_object(info) for info in run.models],
        "consumers": {info.id: _build_consumer_outcomes(run, info) for info in run.models if info.status == "checked"},
        "findings": [build_finding_object(finding, run.find_variant_arguments(finding)) for finding in run.findings],
        "skipped": [build_skip_object(skip) for skip in run.skipped],
        **({"drops": [to_json_value(build_drop_test_object(drop)) for drop in run.drops]} if run.drops else {}),
        "failures": list(run.failures),
        "partial": run.partial,
        "summary": {
            **{str(s): run.count_findings(s) for s in (Severity.ERROR, Severity.WARNING, Severity.INFO)},
            "suppressed": sum(run.suppressed_counts.values()),
        },
        "seconds": round(run.seconds, 3),
    }
    return escape_for_json(json.dumps(report, indent=2, ensure_ascii=False, allow_nan=False) + "\n")


def build_model_object(info: ModelInfo) -> dict[str, Any]:
    """A model as the schema describes it."""
    return {
        "path": info.path,
        "robot": info.robot,
        "args": dict(info.args),
        "links": info.links,
        "joints": info.joints,
        "mass": info.mass,
        "status": info.status,
        "id": info.id,
        "seconds": info.seconds,
    }


def _build_consumer_outcomes(run: Run, info: ModelInfo) -> dict[str, Any]:
    found = predict_outcomes(f for f in run.findings if f.model == info.id)
    return {name: {"verdict": str(o.verdict), "codes": list(o.codes)} for name, o in found.items()}


def build_skip_object(skip: SkippedCheck) -> dict[str, Any]:
    """A skipped check as the schema describes it."""
    return {"code": skip.code, "model": skip.model, "reason": skip.reason}


def build_finding_object(finding: Finding, arguments: Mapping[str, str] = _NO_ARGUMENTS) -> dict[str, Any]:
    """A finding as the schema describes it. ``arguments``: those that it takes to see it."""
    location = None
    if finding.location.span is not None:
        location = {**_build_start(finding.location.span), **_build_end(finding.location.span)}
    return {
        "code": finding.code,
        "name": finding.name,
        "severity": str(finding.severity),
        "confidence": str(finding.confidence),
        "message_id": finding.message_id,
        "message": finding.message,
        "model": finding.model,
        "arguments": dict(arguments),
        "variants": list(finding.variants),
        "fingerprints": list(finding.fingerprints),
        "subjects": [build_subject_object(s) for s in finding.subjects],
        "location": location,
        "via": [_build_start(span) for span in finding.location.via],
        "related": [
            {"subject": r.subject, "location": _build_start(r.span)} for r in finding.related if r.span is not None
        ],
        "cause": None if finding.cause is None else {"id": finding.cause.id, "text": finding.cause.text},
        "consequences": dict(finding.consequences),
        "data": to_json_value(finding.data),
        "fix": None if finding.fix is None else _build_fix(finding.fix),
        "suppressed": None
        if finding.suppressed is None
        else {"kind": finding.suppressed.kind, "reason": finding.suppressed.reason},
    }


def build_subject_object(subject: str) -> dict[str, str]:
    """What a subject names, as the schema describes it."""
    match = _SUBJECT.match(subject)
    kind, name = (match["kind"], match["name"]) if match else (subject.split("/")[0].split("@")[0], "")
    return {"kind": kind, "name": name, "path": subject}


def _build_start(span: Span) -> dict[str, Any]:
    return {"file": span.file, "line": span.line, "column": span.col}


def _build_end(span: Span) -> dict[str, int]:
    return {"end_line": span.end_line, "end_column": span.end_col}


def _build_fix(fix: Fix) -> dict[str, Any]:
    return {
        "title": fix.title,
        "applicability": str(fix.applicability),
        "edits": [
            {**_build_start(e.span), **_build_end(e.span), "old": e.expected, "new": e.replacement} for e in fix.edits
        ],
    }


def to_json_value(value: Any) -> Any:
    """Numbers that JSON cannot hold become null; everything that is no JSON value becomes its text."""
    if isinstance(value, Mapping):
        return {str(k): to_json_value(v) for k, v in value.items()}
    if isinstance(value, (list, tuple, set, frozenset)):
        return [to_json_value(v) for v in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if value is None or isinstance(value, (bool, int, str)):
        return value
    return str(value)
