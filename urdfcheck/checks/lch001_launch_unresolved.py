"""LCH001: what a launch file loads as robot_description exists."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from pathlib import Path

from urdfcheck.core import Confidence, Finding, Location, Rule, Severity
from urdfcheck.core.text import hint
from urdfcheck.source.launch.launch_file import Description, Include, Launch, Obstacle, declared, is_included
from urdfcheck.source.launch.python_launch_file import PythonLaunch
from urdfcheck.source.package.finder import PackageFinder, display_name
from urdfcheck.source.text.tokens import part_of
from urdfcheck.source.text.xml import Element

# How much of a command a message shows.
_SHOWN = 80


def check(launch: Launch, rule: Rule) -> Iterator[Finding]:
    if launch.python is not None:
        yield from _python(launch.python, launch.finder, rule)
    for description in launch.descriptions:
        if description.unresolved is not None:
            at = part_of(description.at, description.file, launch.files)
            yield from _unresolved(launch, description, description.unresolved, at, rule)
    for include in launch.broken:
        yield from _broken(launch, include, rule)


def _broken(launch: Launch, include: Include, rule: Rule) -> Iterator[Finding]:
    """An include that leads nowhere."""
    at, name = include.at, include.obstacle.name
    if include.obstacle.kind == "file":
        yield rule.finding("include-file", at=at, path=name, near=_near_file(name, launch.finder))
    elif include.obstacle.kind == "circle":
        yield rule.finding("include-circle", at=at, path=name)
    else:
        names = [argument.get("name") for argument in declared(_root(at.owner))]
        if name not in names:  # one without a default is handed over at launch
            yield rule.finding("include-argument", at=at, file=at.value, argument=name, near=hint(name, names))


def _unresolved(
    launch: Launch, description: Description, obstacle: Obstacle, at: Location, rule: Rule
) -> Iterator[Finding]:
    path = _file_of(description, launch)
    if obstacle.kind == "package":
        package = launch.finder.package_of(path.absolute())
        if package is None or obstacle.name not in package.dependencies:
            near = _or(launch.finder.near(obstacle.name))
            yield rule.finding("package", at=at, file=description.file, package=obstacle.name, near=near)
        else:
            yield _unknown(rule, at, f"package {obstacle.name!r} is not on this machine")
    elif obstacle.kind == "argument":
        names = [argument.get("name") for argument in declared(_root(description.at.owner))]
        if obstacle.name not in names:
            near = hint(obstacle.name, names)
            yield rule.finding("argument", at=at, file=description.file, argument=obstacle.name, near=near)
        elif not is_included(path):  # one without a default is handed over at launch, or by that other file
            yield _unknown(rule, at, f"argument {obstacle.name!r} has no default")
    elif obstacle.kind == "file":
        yield rule.finding("file", at=at, path=obstacle.name, near=_near_file(obstacle.name, launch.finder))
    elif obstacle.kind == "circle":
        yield rule.finding("circle", at=at, file=description.file)
    else:
        typed = textwrap.shorten(description.file, _SHOWN, placeholder=" …")
        yield _unknown(rule, at, f"`{typed}` is computed then")


def _unknown(rule: Rule, at: Location, reason: str) -> Finding:
    return rule.finding("unknown", at=at, severity=Severity.INFO, reason=reason)


def _python(python: PythonLaunch, finder: PackageFinder, rule: Rule) -> Iterator[Finding]:
    if python.broken is not None:
        yield rule.finding("syntax", at=python.broken.location, severity=Severity.WARNING, error=python.broken.message)
    lost = [*(("named", named) for named in python.missing), *(("include-file", named) for named in python.includes)]
    for message, named in lost:
        path = display_name(Path(named.path))
        yield rule.finding(
            message,
            at=named.location,
            severity=Severity.WARNING,
            confidence=Confidence.STRONG,
            path=path,
            near=_near_file(path, finder),
        )
    for named in python.unknown:
        yield rule.finding("unfound", at=named.location, severity=Severity.INFO, path=named.path)
    if python.loads is not None and not (python.models or python.missing or python.unknown):
        yield _unknown(rule, python.loads, "the file names no model that is found")


def _file_of(description: Description, launch: Launch) -> Path:
    """The launch file, included or not, that a description stands in."""
    span = description.at.span
    file = None if span is None else launch.files.get(span.file)
    return launch.path if file is None else file.path


def _root(element: Element) -> Element:
    while element.parent is not None:
        element = element.parent
    return element


def _or(names: list[str]) -> str:
    return f" (did you mean {' or '.join(map(repr, names))}?)" if names else ""


def _near_file(path: str, finder: PackageFinder) -> str:
    folder = Path(path).parent
    if not finder.allows(folder / "any"):  # what lies there is nobody's to know
        return ""
    try:
        names = [entry.name for entry in folder.iterdir() if entry.is_file()]
    except OSError:
        return f"; the folder {folder.as_posix()} is not there either"
    return hint(Path(path).name, names)
