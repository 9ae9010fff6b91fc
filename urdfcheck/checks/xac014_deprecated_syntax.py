"""XAC014: the xacro command is called without options that mean nothing any more."""

from __future__ import annotations

import re
from collections.abc import Iterator

from urdfcheck.core import Applicability, Edit, Finding, Location, Rule
from urdfcheck.source.launch import Launch

_IN_ORDER = re.compile(r"(?<!\S)(--inorder|-i)(\s+|$)")


def check(launch: Launch, rule: Rule) -> Iterator[Finding]:
    for description in launch.descriptions:
        at, span = description.at, description.at.span
        if span is None or span.file not in launch.files or "xacro" not in "".join(description.words[:1]):
            continue
        file = launch.files[span.file]
        for match in _IN_ORDER.finditer(at.typed):
            start = span.start + match.start()
            option = file.span(start, start + len(match.group(1)))
            removed = file.span(start, start + len(match.group(0)))
            yield rule.finding(
                "inorder",
                at=Location(at.location.subject, option, at.location.via),
                edits=[Edit(removed, match.group(0), "")],
                applicability=Applicability.SAFE,
                option=match.group(1),
            )
