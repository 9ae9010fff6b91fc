"""The report for other programs: the object of ``report.schema.json``."""

from __future__ import annotations

import json
from typing import Any

from urdfcheck.core import ModelInfo, Run, Severity
from urdfcheck.output.shared.escaping import escape_for_json
from urdfcheck.output.shared.json_objects import (
    build_answer_object,
    build_drop_test_object,
    build_finding_object,
    build_model_object,
    build_skip_object,
    to_json_value,
)
from urdfcheck.policy.consumers import predict_outcomes

SCHEMA = "urdfcheck/1"


def render(run: Run) -> str:
    """Render JSON, indented by two spaces, with a newline at the end. Only ``seconds`` differs between equal runs."""
    report = {
        "schema": SCHEMA,
        "version": run.versions["urdfcheck"],
        "targets": list(run.targets),
        "models": [build_model_object(info) for info in run.models],
        "consumers": {info.id: _build_consumer_outcomes(run, info) for info in run.models if info.status == "checked"},
        "findings": [build_finding_object(finding, run.find_variant_arguments(finding)) for finding in run.findings],
        "skipped": [build_skip_object(skip) for skip in run.skipped],
        "unused_macro_files": list(run.unused_macro_files),
        **({"drops": [to_json_value(build_drop_test_object(drop)) for drop in run.drops]} if run.drops else {}),
        **({"answers": [build_answer_object(answer) for answer in run.answers]} if run.answers else {}),
        "failures": list(run.failures),
        "partial": run.partial,
        "summary": {
            **{str(s): run.count_findings(s) for s in (Severity.ERROR, Severity.WARNING, Severity.INFO)},
            "suppressed": sum(run.suppressed_counts.values()),
            "not_checked": len(run.unchecked_models),
        },
        "seconds": round(run.seconds, 3),
    }
    return escape_for_json(json.dumps(report, indent=2, ensure_ascii=False, allow_nan=False) + "\n")


def _build_consumer_outcomes(run: Run, info: ModelInfo) -> dict[str, Any]:
    by_consumer = predict_outcomes(f for f in (*run.findings, *run.unrequested) if info.id in f.subjects_by_model)
    return {
        name: {
            "verdict": str(o.verdict),
            "codes": list(o.codes),
            **({"unproven": list(o.unproven)} if o.unproven else {}),
        }
        for name, o in by_consumer.items()
    }
