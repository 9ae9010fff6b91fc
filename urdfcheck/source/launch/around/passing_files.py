"""The launch files that pass an argument to another one in their project: roslaunch refuses an include that passes one which the
file does not declare, unless the include passes all that its file has."""

from __future__ import annotations

import itertools
import os
import re
from collections.abc import Iterator, Mapping
from functools import lru_cache
from pathlib import Path

from urdfcheck.core import Span
from urdfcheck.core.records import dataclass
from urdfcheck.source.launch.launch_file import DescriptionSource, Launch, LaunchScope, load_launch
from urdfcheck.source.launch.model_launches import find_model_launches
from urdfcheck.source.launch.passed_arguments import iter_launch_files
from urdfcheck.source.launch.substitutions import may_become
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.project_folders import find_project_folder
from urdfcheck.source.text.xml import COMMENT
from urdfcheck.system.files import read_text_or_nothing

# So many launch files of a project are read, and so much of each.
_MOST_LAUNCHES, _MOST_BYTES = 1_000, 500_000
_INCLUDE = re.compile(r"<include\b([^<>]*[^/<>])>((?:(?!<include\b).)*?)</include>", re.DOTALL)
_EMPTY_INCLUDE = re.compile(r"<include\b([^<>]*)/>()")
_FILE = re.compile(r"\bfile\s*=\s*[\"'](?:\$\(find(?:-pkg-share)?\s+([^\s()$]+)\s*\))?(?:[^\"'<>]*/)?([^\"'<>/]+)[\"']")
_PASSED = re.compile(r"<(?:arg|let)\b[^<>]*?\bname\s*=\s*[\"']([^\"'<>]+)[\"']")
_PASSES_ALL = re.compile(r"\bpass_all_args\s*=\s*[\"'](?:true|1)[\"']", re.IGNORECASE)
# The texts of a program.
_QUOTED = re.compile(r"[\"']([^\"'\n]+)[\"']")
# What rostest starts is a launch file too.
_TEST = ".test"


@dataclass(frozen=True, slots=True)
class _Include:
    """An include of a launch file in XML."""

    package: str
    """The package of the file, where it is typed."""
    file: str
    passed: frozenset[str]
    passes_all: bool
    """Whether it also passes what the file around it has."""


@dataclass(frozen=True, slots=True)
class _Including:
    """A launch file that includes others."""

    includes: tuple[_Include, ...]
    names: frozenset[str]
    """Its own arguments; of a program, all its texts."""


def find_passing_files(launch: Launch, argument: str) -> list[Path]:
    """Return the XML launch files of the project whose includes pass an argument to a launch file, by its name, which may be
    computed there."""
    including = _read_includes(find_project_folder(launch.path), launch.finder)
    return [path for path, file in including.items() if any(argument in i.passed for i in _list_includes(file, launch))]


def is_off_by_default(place: Span, finder: PackageFinder) -> bool:
    """Whether the defaults of a launch file of ROS 1 switch off the element at this place, and so does each launch file of the
    project that passes it an argument."""
    scopes = _list_scopes(Path(place.file), finder)
    return bool(scopes) and all(_is_off(scope, place) for scope in scopes)


@lru_cache(maxsize=1)  # asked for each package that a launch file names
def _list_scopes(path: Path, finder: PackageFinder) -> tuple[LaunchScope, ...]:
    """List what a launch file of ROS 1 is with its defaults, first, and as each launch file of the project includes it that
    passes it an argument; nothing for another file."""
    launch = load_launch(path, finder)
    if launch.scope is None or launch.dialect != "ros1":
        return ()
    own = os.path.realpath(launch.path)
    callers = {path for argument in launch.arguments for path in find_passing_files(launch, argument.get("name"))}
    scopes = (scope for path in callers for scope in load_launch(path, finder).scopes.values())
    return (launch.scope, *(scope for scope in scopes if os.path.realpath(scope.resolver.path) == own))


def _is_off(scope: LaunchScope, place: Span) -> bool:
    around = (
        element
        for element in scope.root.walk()
        for attribute in element.attributes.values()
        if attribute.span is not None and attribute.span.start <= place.start < attribute.span.end
    )
    element = next(around, None)
    return element is not None and not scope.resolver.is_active(element)


def find_overriding_launch(model: Path, argument: str, value: str, finder: PackageFinder) -> Path | None:
    """Return a launch file with which a model has another value of an argument than this one, that another launch file gives it:
    one whose include passes it in place of a default; or for an empty default any that starts the model with a value."""
    real = os.path.realpath(model)
    started: list[tuple[Launch, DescriptionSource]] = [
        (launch, description)
        for launch in find_model_launches(model, finder)
        for description in launch.descriptions
        if description.path is not None and os.path.realpath(description.path) == real
    ]
    giving = [(launch, d.words) for launch, d in started if d.arguments.get(argument) == value]
    handed = re.compile(rf"{re.escape(argument)}:=[\"']?\$\((?:arg|var)\s+([^\s()]+)\s*\)[\"']?")
    names = [(launch, match[1]) for launch, words in giving for word in words if (match := handed.fullmatch(word))]
    passing = (path for launch, name in names for path in find_passing_files(launch, name))
    others = (launch.path for launch, description in started if description.arguments.get(argument))
    return next(passing, None) or (next(others, None) if giving and not value else None)


def find_inheriting_files(launch: Launch, argument: str) -> list[Path]:
    """Return the launch files of the project with which a launch file has an argument that it need not declare: they pass all of
    theirs, as those of ROS 2 always do."""
    including = _read_includes(find_project_folder(launch.path), launch.finder)
    is_ros2 = launch.dialect == "ros2"
    found: list[Path] = []
    for path, file in including.items():
        if path.suffix == ".py":
            is_passing = is_ros2 and {argument, launch.path.name} <= file.names
        else:
            includes = list(_list_includes(file, launch))
            is_passing = argument in file.names and any(is_ros2 or include.passes_all for include in includes)
        if is_passing:
            found.append(path)
    return found


def _list_includes(file: _Including, launch: Launch) -> Iterator[_Include]:
    """Yield the includes of a file that may mean a launch file."""
    own, package = launch.path.name, "" if launch.package is None else launch.package.name
    for include in file.includes:
        if may_become(include.file, own) and _may_be_package(include.package, package, launch.finder):
            yield include


def _may_be_package(named: str, own: str, finder: PackageFinder) -> bool:
    """Whether an include may mean the package of a file: by its name, without one, or by an old name, which is of no package."""
    return not named or not own or named == own or finder.find(named) is None


@lru_cache(maxsize=1)  # a run asks for each launch file of a project
def _read_includes(folder: Path, finder: PackageFinder) -> Mapping[Path, _Including]:
    """Return for each launch file what its includes name and pass."""
    found: dict[Path, _Including] = {}
    files = iter_launch_files(folder, finder, with_unnamed=True, also=(_TEST,))
    for path in itertools.islice(files, _MOST_LAUNCHES):
        text = read_text_or_nothing(path, _MOST_BYTES)
        if path.suffix == ".py":
            # The name of a file may be typed behind its folder.
            words = (word for typed in _QUOTED.findall(text) for word in (typed, typed.rpartition("/")[2]))
            found[path] = _Including((), frozenset(words))
            continue
        text = COMMENT.sub("", text)
        includes: list[_Include] = []
        for attributes, inside in (*_INCLUDE.findall(text), *_EMPTY_INCLUDE.findall(text)):
            file = _FILE.search(attributes)
            if file is not None:
                passed, passes_all = frozenset(_PASSED.findall(inside)), _PASSES_ALL.search(attributes) is not None
                includes.append(_Include(file[1] or "", file[2], passed, passes_all))
        if includes:
            found[path] = _Including(tuple(includes), frozenset(_PASSED.findall(text)))
    return found
