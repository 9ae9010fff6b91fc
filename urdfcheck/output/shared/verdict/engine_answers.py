"""What the engines that are targets did here, in words that the formats share."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import EngineAnswer, Run, Verdict
from urdfcheck.core.text import join_names
from urdfcheck.output.shared.wording import PROGRAM_NAMES

# Models that are named together, and reasons of an engine.
_MOST_NAMED, _MOST_REASONS = 3, 2


def describe_answers(run: Run) -> Iterator[str]:
    """Yield a sentence without its full stop for each engine and what it did: ``MuJoCo 4.0.0 loaded it here``."""
    groups: dict[tuple[str, str, str], list[str]] = {}
    for answer in run.answers:
        program = PROGRAM_NAMES.get(answer.engine, answer.engine)
        groups.setdefault((program, answer.version, _describe_outcome(answer)), []).append(answer.model)
    for (program, version, outcome), models in groups.items():
        where = "it" if len(run.models) == 1 else join_names(models, _MOST_NAMED)
        yield f"{program} {version}".rstrip() + f" {outcome}".replace("{it}", where)


def list_answers(run: Run, model: str) -> dict[str, EngineAnswer]:
    """List by engine the answers about a model, of those that were asked."""
    return {a.engine: a for a in run.answers if a.model == model and a.verdict is not None}


def _describe_outcome(answer: EngineAnswer) -> str:
    reasons = "; ".join(answer.reasons[:_MOST_REASONS])
    if answer.verdict is None:
        why = "" if answer.version else ", because it is not installed"
        return f"was not asked{why}: {reasons}"
    if answer.verdict is Verdict.REFUSES:
        return f"refused {{it}} here: {reasons}"
    return "loaded {it} here" + (f": {reasons}" if reasons else "")
