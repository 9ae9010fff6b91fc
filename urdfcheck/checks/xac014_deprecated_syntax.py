"""XAC014: no option and no function name that xacro has left behind."""

from __future__ import annotations

import re
from collections.abc import Iterator

from urdfcheck.core import Applicability, Edit, Finding, Location, Rule
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.source.launch.launch_file import Launch
from urdfcheck.source.load import Source

_DIRECT = re.compile(r"^Using (\w+)\(\) directly is deprecated\. Use (\w+)\.")
_IN_ORDER = re.compile(r"(?<!\S)(--inorder|-i)(\s+|$)")


def check(subject: Source | LaunchContext, rule: Rule) -> Iterator[Finding]:
    if isinstance(subject, LaunchContext):
        yield from _check_options(subject.launch, rule)
    else:
        yield from _check_functions(subject, rule)


def _check_functions(source: Source, rule: Rule) -> Iterator[Finding]:
    """What xacro itself says of a function each time that it is called."""
    for problem in source.find_problems("xacro-warning"):
        said = _DIRECT.match(problem.message)
        if said:
            yield rule.finding("function", at=problem.location, function=said.group(1), namespace=said.group(2))


def _check_options(launch: Launch, rule: Rule) -> Iterator[Finding]:
    for description in launch.descriptions:
        at, span = description.at, description.at.span
        if span is None or span.file not in launch.files or "xacro" not in "".join(description.words[:1]):
            continue
        file = launch.files[span.file]
        for match in _IN_ORDER.finditer(at.typed):
            start = span.start + match.start()
            option = file.make_span(start, start + len(match.group(1)))
            removed = file.make_span(start, start + len(match.group(0)))
            yield rule.finding(
                "inorder",
                at=Location(at.location.subject, option, at.location.via),
                edits=[Edit(removed, match.group(0), "")],
                applicability=Applicability.SAFE,
                option=match.group(1),
            )
