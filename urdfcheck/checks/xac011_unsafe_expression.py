"""XAC011 reports expressions that leave xacro's language."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.source.load import Source, locate_expression


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    for problem in source.find_problems("unsafe-expression"):
        expression = str(problem.data["expression"])
        at = locate_expression(source, problem, expression)
        users = [] if at is problem.location else [problem.location]
        users += [problem.data["reader"]] if "reader" in problem.data else []
        yield rule.finding(
            str(problem.data["refusal"]),
            at=at,
            related=[*users, *(r for r in problem.related if r.span != at.span)],
            expression=expression,
            reason=problem.message,
        )
