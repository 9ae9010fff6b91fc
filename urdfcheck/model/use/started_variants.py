"""What a xacro is with the arguments that it is started with, where these are not those that it was expanded with.

Launch files in Python and MoveIt's settings say so only in part: the model itself is expanded with its defaults.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from functools import cached_property, lru_cache
from itertools import islice
from pathlib import Path

from urdfcheck.core.records import dataclass
from urdfcheck.core.text import compile_names
from urdfcheck.source.launch.passed_arguments import BESIDE, MOST_LAUNCHES, iter_launch_files, read_passed_arguments
from urdfcheck.source.launch.python_launch_file import MAX_PYTHON
from urdfcheck.source.load import Source
from urdfcheck.source.package.finder import has_dependency_entry
from urdfcheck.source.ros.srdf import read_setup_arguments
from urdfcheck.source.xacro.usage import iter_elements_by_tag
from urdfcheck.system.files import read_text_or_nothing

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
    def names(self) -> Mapping[str, frozenset[str]] | None:
        """The names of the links and of the joints, by kind; None if it cannot be expanded."""
        from urdfcheck.source.xacro.expand import expand_xacro

        source = self.source
        given = {**source.arguments, **self.arguments}
        root = expand_xacro(source.path, given, source.finder, extra_environment=source.environment).root
        if root is None:
            return None
        return {kind: frozenset(e.get("name") for e in root.find_children(kind)) for kind in ("link", "joint")}


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


def is_started_with_defaults(source: Source) -> bool:
    """Whether a launch file names the model and passes it nothing, or nothing that its defaults are not."""
    return any(not changed for _, changed in _list_changes(source))


@lru_cache(maxsize=1)
def _list_changes(source: Source) -> tuple[tuple[Path, Mapping[str, str]], ...]:
    """Return the files that start a model, each with those arguments that are neither the model's nor its defaults."""
    if not source.is_xacro or source.package is None:
        return ()
    now: dict[str, str] = {}
    for declared in iter_elements_by_tag(source.trees, "xacro:arg"):  # of several defaults, xacro takes the first
        if "default" in declared.attributes:
            now.setdefault(declared.get("name"), declared.get("default"))
    now |= source.arguments
    return tuple(
        (starter, {name: value for name, value in passed.items() if name in now and value != now[name]})
        for starter, passed in _iter_argument_sets(source)
    )


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
