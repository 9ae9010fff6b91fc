"""What a xacro is with the arguments that it is started with, where these are not those that it was expanded with.

Launch files in Python and MoveIt's settings say so only in part: the model itself is expanded with its defaults.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from functools import cached_property, lru_cache
from itertools import islice
from pathlib import Path
from typing import Any

from urdfcheck.core.records import dataclass
from urdfcheck.core.text import compile_names, join_names
from urdfcheck.source.arguments.written_commands import list_arguments_of_commands
from urdfcheck.source.launch.passed_arguments import (
    BESIDE,
    MOST_LAUNCHES,
    iter_launch_files,
    leaves_argument_out,
    may_pass_argument,
    read_passed_arguments,
)
from urdfcheck.source.launch.python_launch_file import MAX_PYTHON
from urdfcheck.source.load import Source
from urdfcheck.source.package.finder import format_path, has_dependency_entry
from urdfcheck.source.ros.srdf import read_setup_arguments
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Element
from urdfcheck.source.xacro.usage import iter_elements_by_tag, read_argument_defaults
from urdfcheck.system.files import read_text_or_nothing

# What launch files that start Gazebo name: its packages and programs.
_GAZEBO = re.compile(r"gazebo|\b(?:ros_)?(?:gz|ign)_|\b(?:gz|ign) sim", re.IGNORECASE)
# How far behind the name of an argument its default is typed, at most (characters, chosen).
_REACH = 200
_QUOTED_NUMBER = re.compile(r"[\"']\s*([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*[\"']")
# Limit on the sets of arguments that one model is expanded with again.
_MOST_VARIANTS = 6


@dataclass(frozen=True, eq=False)
class StartedVariant:
    """A model with the arguments that a file starts it with."""

    source: Source
    arguments: Mapping[str, str]
    """Those that change something: they are neither the model's nor its defaults."""
    starter: Path
    """The launch file, or the file of MoveIt's settings."""

    @property
    def contradicts_model(self) -> bool:
        """Whether the model was expanded with another value of one of the arguments, and not only with its default."""
        return not self.source.arguments.keys().isdisjoint(self.arguments)

    def split(self) -> Iterator[StartedVariant]:
        """Yield the model with each of the arguments alone."""
        for name, value in self.arguments.items():
            yield StartedVariant(source=self.source, arguments={name: value}, starter=self.starter)

    @cached_property
    def root(self) -> Element | None:
        """The robot; None if it cannot be expanded."""
        from urdfcheck.source.xacro.expand import expand_xacro

        source = self.source
        given = {**source.arguments, **self.arguments}
        return expand_xacro(source.path, given, source.finder, extra_environment=source.environment).root

    @cached_property
    def names(self) -> Mapping[str, frozenset[str]] | None:
        """The names of the links and of the joints, by kind; None if it cannot be expanded."""
        if self.root is None:
            return None
        return {kind: frozenset(self.list_names(kind)) for kind in ("link", "joint")}

    @property
    def shown(self) -> dict[str, Any]:
        """What a finding shows: its arguments, the defaults that repair it, and the file that passes them."""
        return {
            "arguments": join_names([f"{name}:={value}" for name, value in self.arguments.items()], 3),
            "defaults": " and ".join(f"{name} the default `{value}`" for name, value in self.arguments.items()),
            "file": format_path(self.starter),
        }

    def list_names(self, kind: str) -> list[str]:
        """List the names of its links or joints; empty if it cannot be expanded."""
        return [] if self.root is None else [e.get("name") for e in self.root.find_children(kind)]

    def list_roots(self) -> list[str]:
        """List the links that are the child of no joint; empty if it cannot be expanded."""
        joints = [] if self.root is None else self.root.find_children("joint")
        children = {child.get("link") for joint in joints for child in joint.find_children("child")}
        return [name for name in self.list_names("link") if name not in children]

    def list_declarations(self) -> list[Element]:
        """List the declarations of its arguments, one for each."""
        declared = {e.get("name"): e for e in iter_elements_by_tag(self.source.trees, "xacro:arg")}
        return [declared[name] for name in self.arguments if name in declared]


def find_needed_variant(source: Source, is_right: Callable[[StartedVariant], bool]) -> StartedVariant | None:
    """Return what a model must be started with to be right, if every file that starts it passes such values.

    Then only the defaults of its arguments are wrong. It is the first argument that is enough, or all that the first file passes.
    """
    variants = [variant for variant in list_started_variants(source) if not variant.contradicts_model]
    if not variants or not all(map(is_right, variants)) or is_started_with_defaults(source):
        return None
    return next(filter(is_right, variants[0].split()), variants[0])


@lru_cache(maxsize=1)
def list_started_variants(source: Source) -> tuple[StartedVariant, ...]:
    """Return the variants of a model that files of its package start, and those of packages that depend on it.

    These are launch files, and MoveIt's settings, which ``MoveItConfigsBuilder`` reads.
    """
    found: dict[frozenset[tuple[str, str]], StartedVariant] = {}
    for starter, changed in _list_changes(source):
        if changed and len(found) < _MOST_VARIANTS:
            variant = StartedVariant(source=source, arguments=changed, starter=starter)
            found.setdefault(frozenset(changed.items()), variant)
    return tuple(found.values())


def list_replacing_variants(source: Source) -> tuple[StartedVariant, ...]:
    """Return the variants of a model that no file and no command starts with its defaults alone; nothing where one does, or where
    there may be more variants than are tried."""
    variants = list_started_variants(source)
    if not 0 < len(variants) < _MOST_VARIANTS or any(variant.contradicts_model for variant in variants):
        return ()
    if is_started_with_defaults(source):
        return ()
    defaults = read_argument_defaults(source.trees)
    given = [(name, value) for variant in variants for name, value in variant.arguments.items()]
    if any(parse_number(defaults.get(name, "")) is not None and parse_number(value) is None for name, value in given):
        return ()  # `false` may be the same as 0
    commands = list_arguments_of_commands(source.path, source.finder)
    return () if any(passed.isdisjoint(name for name, _ in given) for passed in commands) else variants


def is_started_with_defaults(source: Source) -> bool:
    """Whether a launch file names the model and passes it nothing, or nothing that its defaults are not, in one of its commands.

    One that gives a value to an argument which others pass to the model may hand it to a launch file that it includes.
    """
    changes = _list_changes(source)
    names = {name for _, changed in changes for name in changed}
    real = os.path.realpath(source.path)

    def replaces(starter: Path, passed: Mapping[str, str], changed: Mapping[str, str], name: str) -> bool:
        is_other = name in changed or (name not in passed and may_pass_argument(starter, name))
        return is_other and not leaves_argument_out(starter, name, real, source.finder)

    sets = _list_argument_sets(source) if changes else ()
    return any(
        not any(replaces(starter, passed, changed, name) for name in names)
        for (starter, changed), (_, passed) in zip(changes, sets, strict=True)
    )


def find_passing_starter(source: Source, names: Collection[str]) -> Path | None:
    """Return the first launch file that starts a model and gives one of these arguments a value, known or computed.

    None if no file does, or if one that mentions Gazebo starts the model without.
    """
    first: Path | None = None
    for starter, passed in _list_argument_sets(source):
        if any(name in passed or may_pass_argument(starter, name) for name in names):
            first = first or starter
        elif _GAZEBO.search(read_text_or_nothing(starter, MAX_PYTHON)):
            return None
    return first


def find_replaced_defaults(source: Source, names: Collection[str]) -> dict[str, Path]:
    """Return those of a model's arguments whose default is a number that no file which starts the model leaves as it is.

    Each with the first of these files: what it passes is another number, or is computed at launch.
    """
    defaults = {
        name: number
        for name, text in read_argument_defaults(source.trees).items()
        if (number := parse_number(text)) is not None
    }
    wanted = [name for name in sorted(names) if name in defaults and name not in source.arguments]
    sets = _list_argument_sets(source) if wanted else ()
    real = os.path.realpath(source.path)

    def replaces(starter: Path, passed: Mapping[str, str], name: str) -> bool:
        if name in passed:  # `false` may be the same as 0
            number = parse_number(passed[name])
            is_other = number is not None and number != defaults[name]
        else:
            is_other = may_pass_argument(starter, name)
        return is_other and not leaves_argument_out(starter, name, real, source.finder)

    replaced = [name for name in wanted if sets and all(replaces(starter, passed, name) for starter, passed in sets)]
    if not replaced:
        return {}
    commands = list_arguments_of_commands(source.path, source.finder)
    texts = list(_iter_texts_around([starter for starter, _ in sets], source))
    return {
        name: sets[0][0]
        for name in replaced
        if all(name in passed for passed in commands) and not any(_gives(text, name, defaults[name]) for text in texts)
    }


def _iter_texts_around(starters: Sequence[Path], source: Source) -> Iterator[str]:
    """Yield the texts of the launch files of a project that start a model, or include what does."""
    names = compile_names({starter.name for starter in starters})
    project = source.finder.find_project_above(source.path.absolute())
    folder = project if project is not None and source.finder.can_open(project) else source.path.parent
    for launch in islice(iter_launch_files(folder, source.finder, with_unnamed=True), MOST_LAUNCHES):
        text = read_text_or_nothing(launch, MAX_PYTHON)
        if launch in starters or names.search(text):
            yield text


def _gives(text: str, name: str, number: float) -> bool:
    """Whether a launch file types a number right behind the name of an argument: as its default or the value that it passes."""
    behind = re.compile(rf"[\"']{re.escape(name)}[\"']([^<>]{{0,{_REACH}}})")
    typed = (word for match in behind.finditer(text) for word in _QUOTED_NUMBER.findall(match[1]))
    return any(parse_number(word) == number for word in typed)


@lru_cache(maxsize=1)
def _list_changes(source: Source) -> tuple[tuple[Path, Mapping[str, str]], ...]:
    """Return the files that start a model, each with those arguments that are neither the model's nor its defaults."""
    if not source.is_xacro or source.package is None:
        return ()
    now = {**read_argument_defaults(source.trees), **source.arguments}
    return tuple(
        (starter, {name: value for name, value in passed.items() if name in now and value != now[name]})
        for starter, passed in _list_argument_sets(source)
    )


@lru_cache(maxsize=1)  # several rules ask, and each launch file is parsed
def _list_argument_sets(source: Source) -> tuple[tuple[Path, Mapping[str, str]], ...]:
    """List the files that start a model, each with the arguments that it passes."""
    return tuple(_iter_argument_sets(source))


def _iter_argument_sets(source: Source) -> Iterator[tuple[Path, Mapping[str, str]]]:
    """Yield the files that start a model, each with the arguments that it passes."""
    package, finder = source.package, source.finder
    if package is None:
        return
    others = (folder for folder in finder.list_workspace_packages().values() if folder != package.path)
    dependents = [f for f in others if has_dependency_entry(f, package.name) and finder.can_open(f)]
    real = os.path.realpath(source.path)
    for folder in (package.path, *dependents):
        setup = read_setup_arguments(folder, source)
        if setup is not None:
            yield setup
    launches = (
        path for folder in (package.path, *dependents) for path in iter_launch_files(folder, finder, with_unnamed=True)
    )
    own = compile_names((source.path.name,))
    for launch in islice(launches, MOST_LAUNCHES):
        passed = {a.name: a.value for a in read_passed_arguments(launch, real, finder) if a.rank < BESIDE}
        if passed or own.search(read_text_or_nothing(launch, MAX_PYTHON)):
            yield launch, passed
