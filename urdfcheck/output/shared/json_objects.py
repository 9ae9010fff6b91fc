"""Models, findings, skipped checks and drop tests as the objects of ``report.schema.json``."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

from urdfcheck.core import EngineAnswer, Finding, Fix, ModelInfo, SkippedCheck, Span
from urdfcheck.core.drop_test import SECONDS, STEP, DropTest
from urdfcheck.output.shared.verdict.not_checked import build_command, explain_unchecked, is_accepted

_NO_ARGUMENTS: Mapping[str, str] = {}
_SUBJECT = re.compile(r"^(?P<kind>[^/\[@]+)\[(?P<name>.*?)\](?=[/@]|$)", re.DOTALL)


def build_model_object(info: ModelInfo) -> dict[str, Any]:
    """Build the schema's object of a model."""
    return {
        "path": info.path,
        "robot": info.robot,
        "args": dict(info.args),
        "found_args": dict(info.found_args),
        "links": info.links,
        "joints": info.joints,
        "mass": info.mass,
        "status": info.status,
        "id": info.id,
        "seconds": info.seconds,
        "not_checked": _build_not_checked(info),
    }


def _build_not_checked(info: ModelInfo) -> dict[str, Any] | None:
    if info.status == "checked":
        return None
    return {"reason": explain_unchecked(info), "command": build_command(info) or None, "accepted": is_accepted(info)}


def build_skip_object(skip: SkippedCheck) -> dict[str, Any]:
    """Build the schema's object of a skipped check."""
    return {"code": skip.code, "model": skip.model, "reason": skip.reason}


def build_finding_object(finding: Finding, arguments: Mapping[str, str] = _NO_ARGUMENTS) -> dict[str, Any]:
    """Build the schema's object of a finding. ``arguments``: the xacro arguments with which it appears."""
    return {
        "code": finding.code,
        "name": finding.name,
        "severity": str(finding.severity),
        "confidence": str(finding.confidence),
        "message_id": finding.message_id,
        "headline": finding.headline,
        "message": finding.message,
        "model": finding.model,
        "arguments": dict(arguments),
        "variants": list(finding.variants),
        "models": [_build_share(finding, model, subjects) for model, subjects in finding.variants.items()]
        if len(finding.variants) > 1
        else [],
        "fingerprints": list(finding.fingerprints),
        "subjects": [build_subject_object(s) for s in finding.subjects],
        "location": _build_range(finding.location.span),
        "via": [_build_start(span) for span in finding.location.via],
        "occurrences": [_build_occurrence(own) for own in finding.occurrences],
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


def _build_occurrence(finding: Finding) -> dict[str, Any]:
    """Build the object of one place of a finding."""
    return {
        "subjects": [build_subject_object(s) for s in finding.subjects],
        "message_id": finding.message_id,
        "headline": finding.headline,
        "message": finding.message,
        "location": _build_range(finding.location.span),
        "via": [_build_start(span) for span in finding.location.via],
        "data": to_json_value(finding.data),
        "fix": None if finding.fix is None else _build_fix(finding.fix),
    }


def _build_share(finding: Finding, model: str, subjects: tuple[str, ...]) -> dict[str, Any]:
    """Build the object of one of the models that share a finding."""
    own = replace(finding, model=model, subjects=subjects)
    return {"id": model, "subjects": list(subjects), "fingerprints": list(own.fingerprints)}


def build_subject_object(subject: str) -> dict[str, str]:
    """Build the schema's object of a subject: the kind and name of its element, and its path."""
    match = _SUBJECT.match(subject)
    kind, name = (match["kind"], match["name"]) if match else (subject.split("/")[0].split("@")[0], "")
    return {"kind": kind, "name": name, "path": subject}


def _build_range(span: Span | None) -> dict[str, Any] | None:
    return None if span is None else {**_build_start(span), **_build_end(span)}


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
    """Convert to a JSON value: numbers that JSON cannot hold become null, and other objects become their text."""
    if isinstance(value, Mapping):
        return {str(k): to_json_value(v) for k, v in value.items()}
    if isinstance(value, (list, tuple, set, frozenset)):
        return [to_json_value(v) for v in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if value is None or isinstance(value, (bool, int, str)):
        return value
    return str(value)


def build_answer_object(answer: EngineAnswer) -> dict[str, Any]:
    """Build the schema's object of what an engine did."""
    return {
        "model": answer.model,
        "engine": answer.engine,
        "version": answer.version,
        "verdict": None if answer.verdict is None else str(answer.verdict),
        "reasons": list(answer.reasons),
    }


def build_drop_test_object(drop_test: DropTest) -> dict[str, Any]:
    """Build the schema's object of a drop test."""
    curves = [
        {**asdict(curve), "largest": curve.largest_step, "all_stable": curve.all_stable} for curve in drop_test.curves
    ]
    drive = drop_test.drive and {
        **asdict(drop_test.drive),
        "expected_distance": drop_test.drive.expected_distance,
        "expected_turn": drop_test.drive.expected_turn,
    }
    return {**asdict(drop_test), "seconds": SECONDS, "step": STEP, "curves": curves, "drive": drive}
