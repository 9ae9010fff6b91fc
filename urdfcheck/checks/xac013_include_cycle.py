"""XAC013 reports files that include themselves, directly or through others."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Location, Rule
from urdfcheck.source.load import Source


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    for problem in source.find_problems("include-cycle"):
        # The way goes once round: the last include leads to where the first of the circle stands.
        first, way = problem.location.span, problem.location.via
        circle = way[way.index(first) :] if first in way else way
        if not circle:
            continue
        *before, closing = circle
        files = list(dict.fromkeys(span.file for span in circle))
        yield rule.finding(
            "circle" if len(files) > 1 else "itself",
            at=Location(problem.location.subject, closing, way[: len(way) - 1]),
            related=[Location(problem.location.subject, span) for span in before],
            file=files[0],
            files=files,
            listed=" → ".join((*files, files[0])),
        )
