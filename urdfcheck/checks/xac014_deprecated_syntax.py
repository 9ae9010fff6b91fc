"""XAC014 reports options and function names that xacro has deprecated."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

from urdfcheck.core import Applicability, Edit, Finding, Location, Rule
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.source.load import Source
from urdfcheck.source.ros.srdf import SETUP_FILE

if TYPE_CHECKING:
    from urdfcheck.source.launch.launch_file import Launch

_DIRECT = re.compile(r"^Using (\w+)\(\) directly is deprecated\. Use (\w+)\.")
# What MoveIt's Setup Assistant writes beside the model.
_GENERATED = ".ros2_control.xacro"
_IN_ORDER = re.compile(r"(?<!\S)(--inorder|-i)(\s+|$)")


def check(subject: Source | LaunchContext, rule: Rule) -> Iterator[Finding]:
    if isinstance(subject, LaunchContext):
        yield from _check_options(subject.launch, rule)
    else:
        yield from _check_functions(subject, rule)


def _check_functions(source: Source, rule: Rule) -> Iterator[Finding]:
    """Report the deprecated functions about which xacro warns."""
    for problem in source.find_problems("xacro-warning"):
        match = _DIRECT.match(problem.message)
        if match:
            message = "generated" if _is_of_setup_assistant(source, problem.location) else "function"
            yield rule.finding(message, at=problem.location, function=match.group(1), namespace=match.group(2))


def _is_of_setup_assistant(source: Source, place: Location) -> bool:
    """Whether MoveIt's Setup Assistant wrote the file: it notes what it did in the package and writes the file again."""
    file = None if place.span is None else source.files.get(place.span.file)
    if file is None or not file.path.name.endswith(_GENERATED):
        return False
    package = source.finder.find_package_of(file.path.absolute())
    if package is None:
        return False
    setup = package.path / SETUP_FILE
    return source.finder.can_open(setup) and setup.is_file()


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
