"""A comparison in one line, in plain words: what titles and summaries of all formats say."""

from __future__ import annotations

from urdfcheck.core.model_diff import COSMETIC, IDENTICAL, UNKNOWN, Diff
from urdfcheck.core.text import format_count

# What the categories are called, where that is not their name.
LABELS = {"kinematic": "motion", "dynamic": "dynamics", "extension": "other"}


def get_label(category: str) -> str:
    """Return what readers call a category of changes."""
    return LABELS.get(category, category)


def describe_verdict(diff: Diff) -> str:
    """Return the verdict on all models in plain words: the headline of the only one, or how many change."""
    if not diff.models:
        return "not compared" if diff.failures else "identical: no robot uses a file that differs"
    if len(diff.models) == 1:
        return diff.models[0].headline
    unknown = sum(model.verdict == UNKNOWN for model in diff.models)
    changed = sum(model.verdict not in {UNKNOWN, COSMETIC, IDENTICAL} for model in diff.models)
    lost = f"; {unknown} cannot be compared" if unknown else ""
    if not changed:
        return f"no robot changes, of {len(diff.models)}{lost}"
    return f"{format_count(changed, 'robot changes', 'robots change')}, of {len(diff.models)}{lost}"


def count_findings(diff: Diff) -> str:
    """Return how many findings are new, gone and unchanged."""
    found = diff.findings
    return f"findings: {len(found.new)} new, {len(found.gone)} gone, {found.unchanged} unchanged"
