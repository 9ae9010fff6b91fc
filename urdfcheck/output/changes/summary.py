"""A comparison in one line, in plain words: what titles and summaries of all formats say."""

from __future__ import annotations

from urdfcheck.core.model_diff import COSMETIC, IDENTICAL, UNKNOWN, Diff, MechanismEffect
from urdfcheck.core.text import format_count

# What the categories are called, where that is not their name.
LABELS = {"kinematic": "motion", "dynamic": "dynamics", "extension": "other"}
_COLLIDING, _FALLING = "links collide now", "the robot falls over now"
_HARM = {"pair-collides": _COLLIDING, "rest-collides": _COLLIDING, "falls": _FALLING}
# What is said about a statement that names a part by the name that it had.
OLD_NAME = "old-name"


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


def get_harm(effect: MechanismEffect) -> str:
    """Return what harm an effect does; empty where it does none. Neighbours often overlap on purpose, and simulators let them."""
    return "" if effect.words.get("relation") == "neighbours" else _HARM.get(effect.id, "")


def list_harm(diff: Diff) -> list[str]:
    """Return the harm that a change does: collisions, falls and statements left behind; of models that change alike, once."""
    found = {
        (harm, text)
        for model in diff.models
        if model.mechanism is not None
        for effect, text in zip(model.mechanism.effects, model.effects, strict=True)
        if (harm := get_harm(effect))
    }
    pairs = sum(harm == _COLLIDING for harm, _ in found)
    stale = sum(change.id == OLD_NAME for change in diff.seams)
    return [
        *([format_count(pairs, "pair of links collides now", "pairs of links collide now")] if pairs else []),
        *([_FALLING] if any(harm == _FALLING for harm, _ in found) else []),
        *([format_count(stale, "statement uses an old name", "statements use old names")] if stale else []),
    ]


def count_findings(diff: Diff) -> str:
    """Return how many findings are new, gone and unchanged, and of how many that is not known."""
    found = diff.findings
    unchecked = f", {found.unchecked} unknown (the model is not checked now)" if found.unchecked else ""
    return f"findings: {len(found.new)} new, {len(found.gone)} gone, {found.unchanged} unchanged{unchecked}"
