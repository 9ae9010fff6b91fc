"""XAC011: expressions stay inside xacro's language."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.source.load import Source


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    for problem in source.problems_of("unsafe-expression"):
        yield rule.finding("unsafe", at=problem.location, related=problem.related, reason=problem.message)
