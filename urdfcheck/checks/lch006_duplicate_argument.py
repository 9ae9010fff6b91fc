"""LCH006 reports launch arguments that are declared twice in one scope."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.source.text.tokens import build_removal_edits
from urdfcheck.source.text.xml import Element

_SCOPES = frozenset({"launch", "group", "include"})


def check(context: LaunchContext, rule: Rule) -> Iterator[Finding]:
    launch = context.launch
    # `.launch.xml` is the ending of ROS 2, even if nothing in the file shows its dialect.
    ros1 = launch.dialect == "ros1" and not launch.name.endswith(".xml")
    for first, second in _iter_repeated_arguments(launch.root, ros1) if launch.root is not None else ():
        equal = _get_value(first) == _get_value(second)
        in_include = second.parent is not None and second.parent.tag == "include"
        message = "ros1" if ros1 else "handed" if in_include else "ros2"
        yield rule.finding(
            message,
            at=second,
            severity=Severity.ERROR if ros1 else Severity.WARNING,
            related=[first],
            edits=build_removal_edits(second, launch.files) if equal else (),
            argument=first.get("name"),
            line=0 if first.span is None else first.span.line,
            values="with the same value" if equal else f"as {_format_value(first)} and as {_format_value(second)}",
            which="the second" if equal else "one of them",
        )


def _iter_repeated_arguments(
    scope: Element, ros1: bool, enclosing_scopes: tuple[dict[str, Element], ...] = ()
) -> Iterator[tuple[Element, Element]]:
    """Iterate over the first and each further declaration of an argument in one scope.

    Arguments under a condition are left out: they may be alternatives.

    :param enclosing_scopes: the declarations so far around a group, which ROS 1 shares with it; arguments of an include are a
        scope of their own.
    """
    own: dict[str, Element] = {}
    enclosing_scopes = (*enclosing_scopes, own) if ros1 and scope.tag == "group" else (own,)
    for element in scope.children:
        if "if" in element.attributes or "unless" in element.attributes:
            continue
        name = element.get("name")
        if element.tag == "arg" and name:
            first = next((names[name] for names in enclosing_scopes if name in names), None)
            if first is not None:
                yield first, element
            own.setdefault(name, element)
        elif element.tag in _SCOPES:
            yield from _iter_repeated_arguments(element, ros1, enclosing_scopes)


def _get_value(argument: Element) -> tuple[str, str]:
    return argument.get("value"), argument.get("default")


def _format_value(argument: Element) -> str:
    value = argument.get("value") or argument.get("default")
    return f"`{value}`" if value else "nothing"
