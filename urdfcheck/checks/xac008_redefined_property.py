"""XAC008 reports properties that are redefined before anything reads their first value."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from urdfcheck.core import Finding, Location, Rule, Span
from urdfcheck.model import Model
from urdfcheck.source.load import select_own_trees
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Element
from urdfcheck.source.xacro.usage import find_expression_names, iter_elements_by_tag

# With so many digits, a rounded value is the same for a robot.
_MANY_DIGITS = 5
_CONDITIONS = frozenset({"xacro:if", "xacro:unless"})


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    source = model.source
    problems = source.find_problems("property-lost")
    if not problems:
        return
    own_trees = select_own_trees(source)
    definitions = {
        a.span: e
        for e in iter_elements_by_tag(source.trees, "xacro:property")
        for a in (e.attributes.get("value"),)
        if a is not None
    }
    tags = {e.span: e for tree in source.trees.values() for e in tree.walk() if e.tag.startswith("xacro:")}
    findings: dict[tuple[str, frozenset[Span | None]], Finding] = {}
    for problem in problems:
        first, second = problem.data["lost"], problem.location
        before, after = definitions.get(first.span), definitions.get(second.span)
        if before is None or after is None or _is_intentional(before, after, second=second, tags=tags):
            continue
        files = first.file, second.file
        message = _choose_message(first, second, files)
        if message is None or not own_trees.keys() & set(files):
            continue
        # The author of both files can see that the definition without effect is wrong.
        at, other = (first, second) if message == "included" else (second, first)
        # Files that are included several times replace each other's value in turn: that is one clash.
        key = problem.data["name"], frozenset({first.span, second.span})
        if key in findings and message != "clash":
            continue
        findings[key] = rule.finding(
            message,
            at=Location(after.subject, at.span, at.via),
            related=[Location(after.subject, other.span, other.via)],
            name=problem.data["name"],
            first=before.get("value"),
            second=after.get("value"),
            where=f"line {_get_line_number(first)} of {files[0]}",
            file=files[1],
            repair=_describe_repair(source.trees[files[1]], before=before, after=after),
            lines=f"{_get_line_number(first)} or {_get_line_number(second)}",
        )
    yield from findings.values()


def _is_intentional(before: Element, after: Element, *, second: Location, tags: Mapping[Span | None, Element]) -> bool:
    """Whether the second value is equal, conditional, for another scope, or in a file with a computed name."""
    if (
        "scope" in before.attributes
        or "scope" in after.attributes
        or _is_equal_value(before.get("value"), after.get("value"))
    ):
        return True
    calls = [tags[span] for span in second.via if span in tags]
    is_computed = any("$" in call.get("filename").replace("$(find ", "") for call in calls)
    return is_computed or any(_is_conditional(element) for element in (after, *calls))


def _choose_message(first: Location, second: Location, files: tuple[str, str]) -> str | None:
    """Return how the first value is lost, or None if a file overrides the default of a file that it includes."""
    if files[0] == files[1]:
        return "twice"
    if files[0] in {span.file for span in second.via}:
        return "included"
    return None if files[1] in {span.file for span in first.via} else "clash"


def _describe_repair(included: Element, *, before: Element, after: Element) -> str:
    """Say how the value that precedes an include can count in the included file."""
    name = after.get("name")
    default = f'`<xacro:property name="{name}" default="{after.get("value")}"/>`'
    if name in _collect_names_read_at_once(included):
        # Set after the include, it would come too late.
        meant = f"if {before.get('value')} is meant in the included file, make its value a default: {default}"
        return f"delete this line, which changes nothing; {meant}"
    return f"set it after the include, or make the value in the included file a default: {default}"


def _collect_names_read_at_once(tree: Element) -> set[str]:
    """Return the names that a file reads where it is included: outside its macros, also by way of its properties."""
    read: set[str] = set()
    properties: dict[str, set[str]] = {}
    inside = [tree]
    while inside:
        element = inside.pop()
        texts = (element.text, *(attribute.value for attribute in element.attributes.values()))
        names = set().union(*map(find_expression_names, texts))
        if element.tag == "xacro:property":
            properties.setdefault(element.get("name"), set()).update(names)
            continue
        if element.tag != "xacro:macro":
            read |= names
            inside += element.children
    waiting = list(read)
    while waiting:
        further = properties.get(waiting.pop(), set()) - read
        read |= further
        waiting += further
    return read


def _is_conditional(element: Element) -> bool:
    around: Element | None = element
    while around is not None:
        if around.tag in _CONDITIONS:
            return True
        around = around.parent
    return False


def _is_equal_value(one: str, other: str) -> bool:
    a, b = parse_number(one), parse_number(other)
    if a is None or b is None:
        return one.split() == other.split()
    return math.isclose(a, b, rel_tol=1e-12) or _is_rounded(one, a, b) or _is_rounded(other, b, a)


def _is_rounded(text: str, value: float, other: float) -> bool:
    """Whether a value as typed is another one, rounded: 3.14159 of a pi with more digits."""
    digits = text.strip().lower().partition("e")[0].lstrip("+-0.").replace(".", "")
    return len(digits) >= _MANY_DIGITS and f"{other:.{len(digits)}g}" == f"{value:.{len(digits)}g}"


def _get_line_number(location: Location) -> int:
    return 0 if location.span is None else location.span.line
