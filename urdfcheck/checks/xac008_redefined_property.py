"""XAC008 reports properties that are redefined before anything reads their first value."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from urdfcheck.core import Finding, Location, Rule, Span
from urdfcheck.model import Model
from urdfcheck.source.load import select_own_trees
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Element
from urdfcheck.source.xacro.usage import iter_elements_by_tag

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


def _is_conditional(element: Element) -> bool:
    around: Element | None = element
    while around is not None:
        if around.tag in _CONDITIONS:
            return True
        around = around.parent
    return False


def _is_equal_value(one: str, other: str) -> bool:
    a, b = parse_number(one), parse_number(other)
    return one.split() == other.split() if a is None or b is None else math.isclose(a, b, rel_tol=1e-12)


def _get_line_number(location: Location) -> int:
    return 0 if location.span is None else location.span.line
