"""The launch files around a model that load it, and where they name its arguments."""

from __future__ import annotations

import contextlib
import itertools
import os
import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from pathlib import Path

from urdfcheck.core import Span
from urdfcheck.source.launch.launch_file import Launch, load_launch
from urdfcheck.source.launch.passed_arguments import (
    ASSIGNMENT,
    MOST_LAUNCHES,
    XacroCallReader,
    iter_launch_files,
    make_reader,
)
from urdfcheck.source.launch.python_launch_file import MAX_PYTHON
from urdfcheck.source.launch.python_names import NamedText, read_named_texts
from urdfcheck.source.package.finder import PackageFinder, has_dependency_entry
from urdfcheck.source.package.package_folders import drop_comments
from urdfcheck.source.project_folders import find_project_folder
from urdfcheck.system.files import read_regular

_PUBLISHER = "static_transform_publisher"
# The name of a yaml file, or what is typed of it behind an expression.
_YAML_NAME = re.compile(rb"(?<![\w.-])[\w.-]*\.ya?ml\b", re.ASCII)


def find_model_launches(model: Path, finder: PackageFinder) -> tuple[Launch, ...]:
    """Load the XML launch files that load a model: those of its package, and of the packages around that depend on it."""
    real = os.path.realpath(model)
    launches = (
        load_launch(path, finder)
        for path, data in _iter_launches_around(model, finder)
        if path.suffix != ".py" and b"robot_description" in data
    )
    return tuple(launch for launch in launches if any(_iter_loading(launch, real)))


def find_argument_names(model: Path, finder: PackageFinder, launches: Iterable[Launch]) -> Iterator[tuple[str, Span]]:
    """Yield the names of arguments that are passed to a model, each with its place: ``prefix`` of ``prefix:=left``.

    ``launches``: the XML launch files that load the model. Python launch files are searched around it.
    """
    real = os.path.realpath(model)
    for launch in launches:
        for at in _iter_loading(launch, real):
            for match in ASSIGNMENT.finditer(launch.files[at.file].text, at.start, at.end):
                yield match[1], launch.files[at.file].make_span(*match.span(1))
    for path, data in _iter_launches_around(model, finder):
        reader = make_reader(path, data, finder) if path.suffix == ".py" and b"xacro" in data else None
        if reader is not None:
            with contextlib.suppress(ValueError, RecursionError, MemoryError):  # nested too deeply
                yield from XacroCallReader(reader).read_names(real)


def find_named_texts(model: Path, finder: PackageFinder, names: Mapping[str, Collection[str]]) -> Iterator[NamedText]:
    """Yield the texts of the Python launch files around a model that are or may be names of its parts.

    ``names``: those of its links and joints, by kind.
    """
    real = os.path.realpath(model)
    spellings = [name.encode("utf-8", "surrogatepass") for known in names.values() for name in known]
    for path, data in _iter_launches_around(model, finder):
        is_asked = path.suffix == ".py" and any(spelling in data for spelling in spellings)
        reader = make_reader(path, data, finder) if is_asked else None
        if reader is not None:
            with contextlib.suppress(ValueError, RecursionError, MemoryError):  # nested too deeply
                yield from read_named_texts(reader, names, real)


def iter_publishing_texts(model: Path, finder: PackageFinder, *, in_project: bool) -> Iterator[str]:
    """Yield the texts, without comments, of the launch files around a model that start a static_transform_publisher.

    ``in_project``: those of the whole project, which may be for another robot.
    """
    for _, data in (
        _read_launches([find_project_folder(model.absolute())], finder)
        if in_project
        else _iter_launches_around(model, finder)
    ):
        if _PUBLISHER.encode() in data and _PUBLISHER in (text := drop_comments(data.decode("utf-8", "replace"))):
            yield text


def may_load_yaml(model: Path, finder: PackageFinder, name: str) -> bool:
    """Whether a launch file around a model names a yaml file, in full or by the end of its name, or starts MoveIt, which finds
    its files itself."""
    return any(
        b"moveit" in data.lower() or any(name.endswith(end.decode()) for end in _YAML_NAME.findall(data))
        for _, data in _iter_launches_around(model, finder)
    )


def may_run_xacro(model: Path, finder: PackageFinder) -> bool:
    """Whether a launch file around a model names it and xacro."""
    name = model.name.encode("utf-8", "surrogatepass")
    return any(name in data and b"xacro" in data for _, data in _iter_launches_around(model, finder))


def _iter_loading(launch: Launch, model: str) -> Iterator[Span]:
    """Yield the places of the commands and files with which a launch file loads a model, given by its real path."""
    for description in launch.descriptions:
        span = description.at.span
        is_model = description.path is not None and os.path.realpath(description.path) == model
        if is_model and span is not None and span.file in launch.files:
            yield span


def _iter_launches_around(model: Path, finder: PackageFinder) -> Iterator[tuple[Path, bytes]]:
    """Yield the launch files of the model's package and of those that depend on it, with what is in them."""
    package = finder.find_package_of(model.absolute())
    if package is None:
        return
    others = finder.list_workspace_packages().values()
    folders = [f for f in others if f != package.path and has_dependency_entry(f, package.name) and finder.can_open(f)]
    yield from _read_launches([package.path, *folders], finder)


def _read_launches(folders: Iterable[Path], finder: PackageFinder) -> Iterator[tuple[Path, bytes]]:
    files = (path for folder in folders for path in iter_launch_files(folder, finder))
    for path in itertools.islice(files, MOST_LAUNCHES):
        with contextlib.suppress(OSError):
            yield path, read_regular(path, MAX_PYTHON)
