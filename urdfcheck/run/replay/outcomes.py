"""The outcome of a whole run: where nothing changed, nothing is planned, audited or put together again."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from urdfcheck.core import Rule, Run, SkippedCheck
from urdfcheck.run.replay.entries import Replays, is_repeatable, keep_result, make_key
from urdfcheck.source.project_folders import list_shared_folders
from urdfcheck.system.observing.observations import Observations


def make_outcome_key(options: Mapping[str, object]) -> str:
    """Return the key of a run with these options of the command."""
    return make_key(options, list_shared_folders())


def keep_outcome(folder: Path, key: str, outcome: Run, fail_on: str, observations: Observations) -> None:
    """Keep the outcome of a run, if the same run would give it again. ``fail_on``: what the configuration says."""
    may_differ = outcome.partial or any(answer.stopped for answer in outcome.answers)
    if may_differ or outcome.scenes or not is_repeatable(outcome.findings, outcome.failures):
        return
    # Of the other rules no report says more than their number, or it reads their pages; nor of those that the tier leaves out.
    skipped = (skip.code for skip in outcome.skipped if not skip.reason.startswith(SkippedCheck.TIER_REASON))
    named = {*(finding.code for finding in outcome.findings), *skipped}
    rules = {code: rule if code in named else None for code, rule in outcome.rules.items()}
    keep_result(folder, key, (replace(outcome, rules={}), rules, fail_on), observations)


def recall_outcome(folder: Path, key: str) -> tuple[Run, str] | None:
    """Return the outcome of an earlier run with the least severity that fails it; None where something may differ."""
    start = time.perf_counter()
    found = Replays(folder).recall(key)
    if found is None:
        return None
    outcome, rules, fail_on = found[0]
    seconds = time.perf_counter() - start if outcome.seconds else 0.0
    return replace(outcome, rules=_RulesOnDemand(rules), seconds=seconds), fail_on


class _RulesOnDemand(Mapping[str, Rule]):
    """Rules by code; the pages are read when one is asked for that is not at hand (None)."""

    def __init__(self, rules: Mapping[str, Rule | None]) -> None:
        self._rules = rules

    def __getitem__(self, code: str) -> Rule:
        rule = self._rules[code]
        if rule is not None:
            return rule
        from urdfcheck.rules import load_rules

        return load_rules()[code]

    def __iter__(self) -> Iterator[str]:
        return iter(self._rules)

    def __len__(self) -> int:
        return len(self._rules)

    def __contains__(self, code: object) -> bool:
        return code in self._rules
