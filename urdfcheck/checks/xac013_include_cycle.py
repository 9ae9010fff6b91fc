"""XAC013 reports files that include themselves, directly or through others."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Location, Rule
from urdfcheck.source.load import Source


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    for problem in source.find_problems("include-cycle"):
        # `via` goes round once: its last include leads back to the file with the first include of the cycle.
        first, via = problem.location.span, problem.location.via
        cycle = via[via.index(first) :] if first in via else via
        if not cycle:
            continue
        *before, closing = cycle
        files = list(dict.fromkeys(span.file for span in cycle))
        yield rule.finding(
            "circle" if len(files) > 1 else "itself",
            at=Location(problem.location.subject, closing, via[:-1]),
            related=[Location(problem.location.subject, span) for span in before],
            file=files[0],
            files=files,
            listed=" → ".join((*files, files[0])),
        )
