"""XAC016 reports that the model depends on the environment: on variables not read, and on those that change the model."""

from __future__ import annotations

import shlex
from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import format_count, join_names
from urdfcheck.source.load import Source
from urdfcheck.source.text.problems import Problem
from urdfcheck.source.text.xml import Element
from urdfcheck.source.xacro.usage import iter_elements_by_tag

# What only the programs of one version of ROS read.
_EXTENSIONS = frozenset({"gazebo", "ros2_control", "transmission"})


def check(source: Source, rule: Rule) -> Iterator[Finding]:
    yield from _check_ignored(source, rule)
    decisions = source.find_problems("environment-decides")
    if decisions and not all(_chooses_extensions(source, p) for p in decisions):
        # This import loads the expansion, and few models need it.
        from urdfcheck.source.other_environments import get_variable

        names = sorted({str(p.data["variable"]) for p in decisions})
        first, *others = dict.fromkeys(p.location for p in decisions)
        told = [f"{name} is {get_variable(source, name) or 'not set'}" for name in names]
        yield rule.finding("decides", at=first, related=others[:9], variables=names, listed=join_names(told))
    places = source.find_problems("place-decides")
    if places:
        first, *others = dict.fromkeys(p.location for p in places)
        yield rule.finding("place", at=first, related=others[:9], severity=Severity.ERROR)
    orders = source.find_problems("order-decides")
    if orders:
        from urdfcheck.source.other_environments import depends_on_set_order  # likewise

        first, *others = dict.fromkeys(p.location for p in orders)
        if depends_on_set_order(source):
            yield rule.finding("random", at=first, related=others[:9], severity=Severity.ERROR)
        else:
            yield rule.finding("order", at=first, related=others[:9])


def _chooses_extensions(source: Source, problem: Problem) -> bool:
    """Whether the version of ROS chooses in a condition only what the programs of that version read: plugins and interfaces.

    Links and joints are the same in all versions, and that the others differ is meant.
    """
    span = problem.location.span
    if problem.data["variable"] != "ROS_VERSION" or span is None:
        return False
    for tag in ("xacro:if", "xacro:unless"):
        for condition in iter_elements_by_tag(source.trees, tag):
            value = condition.attributes.get("value")
            if (
                value is not None
                and value.span is not None
                and (value.span.file, value.span.start) == (span.file, span.start)
            ):
                return _is_extension(condition) or all(map(_is_extension, condition.children))
    return False


def _is_extension(element: Element) -> bool:
    outer: Element | None = element
    while outer is not None:
        if outer.tag in _EXTENSIONS:
            return True
        outer = outer.parent
    return False


def _check_ignored(source: Source, rule: Rule) -> Iterator[Finding]:
    problems = source.find_problems("environment-ignored")
    if not problems:
        return
    names = sorted({str(p.data["variable"]) for p in problems})
    first, *others = dict.fromkeys(p.location.span for p in problems)
    place = {p.location.span: p.location for p in reversed(problems)}
    yield rule.finding(
        "ignored",
        at=place[first],
        related=[place[span] for span in others],
        variables=names,
        amount=format_count(len(names), "environment variable"),
        was="was" if len(names) == 1 else "were",
        listed=join_names(names, 5),
        options=" ".join(f"--env {shlex.quote(name)}" for name in names[:5]) + (" …" if len(names) > 5 else ""),
    )
