"""XAC016 reports environment variables that the model was expanded without."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import format_count, join_names
from urdfcheck.source.load import Source


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    problems = source.find_problems("environment-ignored")
    if not problems:
        return
    names = sorted({str(p.data["variable"]) for p in problems})
    first, *others = dict.fromkeys(p.location.span for p in problems)
    place = {p.location.span: p.location for p in reversed(problems)}
    yield rule.finding(
        "ignored",
        at=place[first],
        related=[place[span] for span in others],
        variables=names,
        amount=format_count(len(names), "variable"),
        was="was" if len(names) == 1 else "were",
        listed=join_names(names, 5),
        options=" ".join(f"--env {name}" for name in names[:5]) + (" …" if len(names) > 5 else ""),
    )
