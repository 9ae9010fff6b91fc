"""The comparison of two versions for other programs: the object of ``diff.schema.json``."""

from __future__ import annotations

import json
from typing import Any

from urdfcheck.core import Span
from urdfcheck.core.model_diff import (
    ChangeCause,
    CollisionDiff,
    Diff,
    MechanismChange,
    MechanismDiff,
    MechanismEffect,
    ModelDiff,
    SeamChange,
)
from urdfcheck.output.shared.escaping import escape_for_json
from urdfcheck.output.shared.json_objects import build_finding_object, to_json_value

SCHEMA = "urdfcheck-diff/1"


def render(diff: Diff) -> str:
    """Render JSON, indented by two spaces, with a newline at the end."""
    document = {
        "schema": SCHEMA,
        "version": diff.version,
        "before": diff.before,
        "after": diff.after,
        "verdict": diff.verdict,
        "models": [_build_model(model) for model in diff.models],
        "seams": list(map(_build_seam, diff.seams)),
        "findings": {
            "new": [build_finding_object(finding) for finding in diff.findings.new],
            "gone": [build_finding_object(finding) for finding in diff.findings.gone],
            "unchanged": diff.findings.unchanged,
            "unchecked": diff.findings.unchecked,
        },
        "failures": list(diff.failures),
        "notes": list(diff.notes),
    }
    return escape_for_json(json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False) + "\n")


def _build_model(model: ModelDiff) -> dict[str, Any]:
    found = model.mechanism
    return {
        "before": model.before or None,
        "after": model.after or None,
        "matched_by": model.matched_by,
        "verdict": model.verdict,
        "headline": model.headline,
        "problem": model.problem or None,
        "changes": [] if found is None else list(map(_build_change, found.changes, model.texts)),
        "notes": [] if found is None else list(map(_build_change, found.notes, model.notes)),
        "idle_edits": [{"file": file, "line": line, "text": text} for file, line, text in model.idle_edits],
        "causes": [] if found is None else list(map(_build_cause, found.causes)),
        "effects": [] if found is None else list(map(_build_effect, found.effects, model.effects)),
        "collisions": None if found is None or found.collisions is None else _build_collisions(found.collisions),
        "motion": None if found is None else _build_motion(found),
        "dynamics": None if found is None else _build_dynamics(found),
    }


def _build_change(change: MechanismChange, text: str) -> dict[str, Any]:
    return {
        "category": change.category,
        "id": change.id,
        "subject": change.subject,
        "new_name": change.new_name or None,
        "text": text,
        "numbers": to_json_value(change.numbers),
        "words": to_json_value(change.words),
        "before": _build_place(change.before.start),
        "after": _build_place(change.after.start),
    }


def _build_seam(change: SeamChange) -> dict[str, Any]:
    return {
        "kind": change.kind,
        "id": change.id,
        "subject": change.subject,
        "text": change.text,
        "before": _build_place(change.before),
        "after": _build_place(change.after),
    }


def _build_effect(effect: MechanismEffect, text: str) -> dict[str, Any]:
    return {
        "kind": effect.kind,
        "id": effect.id,
        "subject": effect.subject,
        "other": effect.other or None,
        "text": text,
        "numbers": to_json_value(effect.numbers),
        "words": to_json_value(effect.words),
        "configuration": to_json_value(effect.configuration),
    }


def _build_collisions(found: CollisionDiff) -> dict[str, Any]:
    return {"samples": found.samples, "pairs": found.pairs, "unread": list(found.unread)}


def _build_place(span: Span | None) -> dict[str, Any] | None:
    return None if span is None else {"file": span.file, "line": span.line, "column": span.col}


def _build_cause(cause: ChangeCause) -> dict[str, Any]:
    before, after = (
        [{"file": file, "line": line, "text": text} for file, line, text in lines]
        for lines in (cause.before, cause.after)
    )
    return {"before": before, "after": after, "changes": list(cause.changes), "edited": cause.is_edited}


def _build_motion(found: MechanismDiff) -> dict[str, Any]:
    return {
        "samples": found.samples,
        "shifts": [
            {
                "link": shift.link,
                "branch": shift.branch,
                "distance": to_json_value(shift.distance),
                "angle": to_json_value(shift.angle),
                "configuration": to_json_value(shift.configuration),
            }
            for shift in found.shifts
        ],
    }


def _build_dynamics(found: MechanismDiff) -> dict[str, Any]:
    return {
        "mass": {"before": to_json_value(found.mass[0]), "after": to_json_value(found.mass[1])},
        "com_shift": to_json_value(found.com_shift),
        "torques": [
            {
                "joint": torque.joint,
                "before": to_json_value(torque.before),
                "after": to_json_value(torque.after),
                "effort": to_json_value(torque.effort),
                "unit": torque.unit,
                "main_link": torque.main_link or None,
            }
            for torque in found.torques
        ],
    }
