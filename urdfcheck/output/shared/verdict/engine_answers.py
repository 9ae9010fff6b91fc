"""What the engines that are targets did here, in words that the formats share."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from urdfcheck.core import EngineAnswer, Run, Verdict
from urdfcheck.core.text import join_names
from urdfcheck.output.shared.wording import PROGRAM_NAMES
from urdfcheck.policy.consumers import SIMULATOR

if TYPE_CHECKING:
    from urdfcheck.core.drop_test import DropTest

# Models that are named together, and reasons of an engine.
_MOST_NAMED, _MOST_REASONS = 3, 2


def describe_answers(run: Run) -> Iterator[str]:
    """Yield a sentence without its full stop for each engine and what it did.

    One is ``MuJoCo 4.0.0 loaded it here; dropped with its joints held, it comes to rest``.
    """
    if not run.answers:
        return
    falls = {drop.model: _describe_fall(drop) for drop in run.drops}
    kept = {
        skip.model: f"it was not dropped: {skip.reason}"
        for skip in run.skipped
        if skip.code in run.rules and "simulator" in run.rules[skip.code].needs
    }
    groups: dict[tuple[str, str, str], list[str]] = {}
    for answer in run.answers:
        program = PROGRAM_NAMES.get(answer.engine, answer.engine)
        outcome = _describe_outcome(answer)
        fall = falls.get(answer.model) or kept.get(answer.model)
        if answer.engine == SIMULATOR and answer.verdict not in {None, Verdict.REFUSES} and fall:
            outcome = f"{outcome}; {fall}"
        groups.setdefault((program, answer.version, outcome), []).append(answer.model)
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


def _describe_fall(drop: DropTest) -> str:
    """Describe in a clause how a robot ended whose joints are held."""
    release = drop.later or drop.held
    how = "bolted down" if drop.fixed else "dropped"
    if release.burst is not None:
        end = "explodes"
    elif release.has_tipped:
        end = "tips over"
    else:
        end = "still moves" if release.settled is None else "comes to rest"
    names = join_names(drop.unread, _MOST_NAMED)
    missing = f" (without the shapes of {names}, which could not be measured)" if drop.unread else ""
    return f"{how} with its joints held, it {end}{missing}"
