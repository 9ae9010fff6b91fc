"""XAC016 reports that the model depends on the environment: on variables not read, and on those that change the model."""

from __future__ import annotations

import shlex
from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import format_count, join_names
from urdfcheck.source.load import Source


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    yield from _check_ignored(source, rule)
    decisions = source.find_problems("environment-decides")
    if decisions:
        # This import loads the expansion, and few models need it.
        from urdfcheck.source.other_environments import get_variable

        names = sorted({str(p.data["variable"]) for p in decisions})
        first, *others = dict.fromkeys(p.location for p in decisions)
        told = [f"{name} is {get_variable(source, name) or 'not set'}" for name in names]
        yield rule.finding("decides", at=first, related=others[:9], variables=names, listed=join_names(told))
    places = source.find_problems("place-decides")
    if places:
        first, *others = dict.fromkeys(p.location for p in places)
        yield rule.finding("place", at=first, related=others[:9], severity=Severity.ERROR)
    orders = source.find_problems("order-decides")
    if orders:
        from urdfcheck.source.other_environments import depends_on_set_order  # likewise

        first, *others = dict.fromkeys(p.location for p in orders)
        if depends_on_set_order(source):
            yield rule.finding("random", at=first, related=others[:9], severity=Severity.ERROR)
        else:
            yield rule.finding("order", at=first, related=others[:9])


def _check_ignored(source: Source, rule: Rule) -> Iterator[Finding]:
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
        amount=format_count(len(names), "environment variable"),
        was="was" if len(names) == 1 else "were",
        listed=join_names(names, 5),
        options=" ".join(f"--env {shlex.quote(name)}" for name in names[:5]) + (" …" if len(names) > 5 else ""),
    )
