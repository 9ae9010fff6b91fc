"""LCH001: what a launch file loads as robot_description exists."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from urdfcheck.core import Finding, Rule
from urdfcheck.model.names import hint
from urdfcheck.source.launch import Launch
from urdfcheck.source.words import part_of


def check(launch: Launch, rule: Rule) -> Iterator[Finding]:
    for description in launch.descriptions:
        obstacle = description.unresolved
        if obstacle is None:
            continue
        at = part_of(description.at, description.file, launch.files)
        if obstacle.kind == "package":
            declared = launch.package.dependencies if launch.package is not None else frozenset()
            if obstacle.name not in declared:  # a declared one is merely not installed here: PKG001
                near = _or(launch.finder.near(obstacle.name))
                yield rule.finding("package", at=at, file=description.file, package=obstacle.name, near=near)
        elif obstacle.kind == "argument":
            names = [argument.get("name") for argument in launch.arguments]
            if obstacle.name not in names:  # one without a default is handed over at launch
                near = hint(obstacle.name, names)
                yield rule.finding("argument", at=at, file=description.file, argument=obstacle.name, near=near)
        elif obstacle.kind == "file":
            yield rule.finding("file", at=at, path=obstacle.name, near=_near_file(obstacle.name))
        elif obstacle.kind == "circle":
            yield rule.finding("circle", at=at, file=description.file)


def _or(names: list[str]) -> str:
    return f" (did you mean {' or '.join(map(repr, names))}?)" if names else ""


def _near_file(path: str) -> str:
    folder = Path(path).parent
    try:
        names = [entry.name for entry in folder.iterdir() if entry.is_file()]
    except OSError:
        return f"; the folder {folder.as_posix()} is not there either"
    return hint(Path(path).name, names)
