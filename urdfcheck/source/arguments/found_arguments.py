"""Expanding a xacro whose arguments are not all given: launch files that start it say what it is used with."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from urdfcheck.core.records import dataclass
from urdfcheck.source.arguments.usual_environment import choose_variable, find_unset_variable
from urdfcheck.source.arguments.written_commands import find_written_arguments
from urdfcheck.source.launch.passed_arguments import BESIDE, PassedArgument, find_passed_arguments, may_pass_argument
from urdfcheck.source.package.finder import PackageFinder, format_path
from urdfcheck.source.text.problems import IN_EXPRESSION, MISSING_FILE, Problem, find_lacking
from urdfcheck.source.xacro.expand import Expansion, expand_xacro
from urdfcheck.source.xacro.usage import ARGUMENT, find_conditions, list_condition_arguments

# How many arguments are found one after the other: the robot with most of them has 79, nearly all with defaults.
MOST_FOUND = 64


@dataclass(frozen=True, slots=True, eq=False)
class FoundExpansion:
    """An expansion with the arguments that it took."""

    expansion: Expansion
    arguments: Mapping[str, str]
    found: Mapping[str, PassedArgument]
    """Those of the arguments that were not given, by name."""
    assumed: frozenset[str] = frozenset()
    """Those of the arguments that stand for variables of ROS which are not set here."""


def expand_with_found_arguments(
    path: Path,
    arguments: Mapping[str, str],
    finder: PackageFinder,
    *,
    environment: frozenset[str],
    launches: Sequence[Path] = (),
) -> FoundExpansion:
    """Expand a xacro. An argument without which there is no model gets the value that a launch file passes.

    This is one that is read and has no value, one whose default leads to a file that does not exist, or one with whose default
    nothing defines a property or macro that the file needs. A variable of ROS that
    is not set here gets a usual value: every shell of ROS sets it. ``launches``: the launch files that are checked with the
    model, which count first.
    """

    def expand_with(given: Mapping[str, str]) -> FoundExpansion:
        return _expand_with_passed_arguments(path, given, finder, environment=environment, launches=launches)

    result, assumed = expand_with(arguments), dict[str, str]()
    name = find_unset_variable(result.expansion.problems)
    while name is not None and name not in {*arguments, *assumed}:
        package = finder.find_package_of(path.absolute())
        assumed[name] = choose_variable(name, {**arguments, **assumed}, package)
        result = expand_with({**arguments, **assumed})
        name = find_unset_variable(result.expansion.problems)
    return replace(result, assumed=frozenset(assumed))


def _expand_with_passed_arguments(
    path: Path,
    arguments: Mapping[str, str],
    finder: PackageFinder,
    *,
    environment: frozenset[str],
    launches: Sequence[Path],
) -> FoundExpansion:
    def expand(values: Mapping[str, str]) -> Expansion:
        return expand_xacro(path, values, finder, extra_environment=environment)

    plain = FoundExpansion(expand(arguments), arguments, {})
    if not _list_wanted_arguments(plain.expansion):
        return plain
    # What launch files pass comes before the commands in other files.
    passed = {**find_written_arguments(path, finder), **find_passed_arguments(path, finder, launches)}
    result = _add_passed_arguments(plain, passed, expand)
    if result.expansion.root is None and any(argument.rank >= BESIDE for argument in result.found.values()):
        # What another model is started with makes no model of this one: nothing is to be said of it.
        own = {name: argument for name, argument in passed.items() if argument.rank < BESIDE}
        result = _add_passed_arguments(plain, own, expand)
    if result.expansion.root is not None:
        return result
    early = _find_early_defaults(path, plain.expansion)
    # A launch file that passes none fails. If none is known, whoever starts the model passes a value.
    own = {name: a for name, a in early.items() if all(may_pass_argument(launch, name) for launch in launches)}
    complete = _add_passed_arguments(result, own, expand)
    # What stops it with these defaults is what has to be mended or given: a value for them alone would not do.
    return complete if complete.expansion.root is not None or complete.found != result.found else result


def _find_early_defaults(path: Path, expansion: Expansion) -> dict[str, PassedArgument]:
    """Return the defaults of the arguments that attributes of ``<robot>`` read: xacro evaluates these before any default."""
    root = expansion.trees.get(format_path(path))
    if root is None:
        return {}
    read = {name for attribute in root.attributes.values() for name in ARGUMENT.findall(attribute.value)}
    return {
        name: PassedArgument(name=name, value=default, location=element.location, rank=0)
        for element in reversed(root.find_children("xacro:arg"))  # of several defaults, xacro takes the first
        if (name := element.get("name")) in read and (default := element.get("default")) and "$" not in default
    }


def _add_passed_arguments(
    plain: FoundExpansion, passed: Mapping[str, PassedArgument], expand: Callable[[Mapping[str, str]], Expansion]
) -> FoundExpansion:
    """Expand again with what launch files pass, as long as an argument is wanted and this helps."""
    expansion, arguments = plain.expansion, plain.arguments
    found = dict(plain.found)
    for _ in range(MOST_FOUND):
        names = _list_wanted_arguments(expansion)
        new = {name: passed[name] for name in names if name in passed and name not in {**arguments, **found}}
        if not new:
            break
        values = {name: argument.value for name, argument in {**found, **new}.items()}
        further = expand({**arguments, **values})
        if further.root is None and _has_same_failure(expansion, further):
            break
        expansion, found = further, {**found, **new}
    values = {name: argument.value for name, argument in found.items()}
    return FoundExpansion(expansion, {**arguments, **values}, found)


def _list_wanted_arguments(expansion: Expansion) -> list[str]:
    """Return the arguments that have no value, of which a path to a missing file was made, or on which it depends whether what is
    missing is defined."""
    names: list[str] = []
    for problem in expansion.problems:
        if problem.kind == "argument-missing":
            names.append(str(problem.data["argument"]))
        elif problem.kind == "expansion-failed" and _is_about_missing_file(problem):
            subjects = (place.subject for place in problem.related)
            names += [subject[len("argument[") : -1] for subject in subjects if subject.startswith("argument[")]
        elif problem.kind == "expansion-failed":
            names += _list_deciding_arguments(expansion, problem)
    return names


def _list_deciding_arguments(expansion: Expansion, problem: Problem) -> list[str]:
    """Return the arguments of the conditions under which the property or macro is defined that the expansion did not find."""
    kind, name = find_lacking(problem) or ("", "")
    if kind not in {"property", "macro"}:
        return []
    conditions = find_conditions(expansion.trees, name, problem.location.span, f"xacro:{kind}")
    return list(list_condition_arguments(expansion.trees, conditions))


def _is_about_missing_file(problem: Problem) -> bool:
    return MISSING_FILE.search(problem.message.split(IN_EXPRESSION)[0]) is not None


def _has_same_failure(first: Expansion, second: Expansion) -> bool:
    failures = [
        {(p.kind, p.message) for p in expansion.problems if p.kind in {"argument-missing", "expansion-failed"}}
        for expansion in (first, second)
    ]
    return failures[0] == failures[1]
