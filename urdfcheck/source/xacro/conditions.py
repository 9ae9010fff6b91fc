"""Properties that are only defined under a condition, and the arguments that such conditions depend on."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from urdfcheck.core import Span
from urdfcheck.source.text.xml import Element
from urdfcheck.source.xacro.expressions import find_names
from urdfcheck.source.xacro.usage import ARGUMENT, EXPRESSION, iter_elements_by_tag

_CONDITIONS = {"xacro:if": "if", "xacro:unless": "unless"}


@dataclass(frozen=True, slots=True, eq=False)
class Condition:
    """The ``<xacro:if>`` or ``<xacro:unless>`` nearest around a definition."""

    element: Element

    def __str__(self) -> str:
        return f"{_CONDITIONS[self.element.tag]} `{self.element.get('value').strip()}`"


def find_conditions(trees: Mapping[str, Element], name: str, place: Span | None) -> tuple[Condition, ...]:
    """Return the conditions under which a property is defined; empty if one of its definitions has none.

    :param place: where the property is missing; what is defined around it or after it has another cause.
    """
    found: dict[str, Condition] = {}
    for definition in iter_elements_by_tag(trees, "xacro:property"):
        if definition.get("name") != name or "remove" in definition.attributes:
            continue
        element = _find_condition_element(definition)
        if element is None or _ends_after(element, place):
            return ()
        condition = Condition(element)
        found.setdefault(str(condition), condition)
    return tuple(found.values())


def list_condition_arguments(trees: Mapping[str, Element], conditions: Iterable[Condition]) -> tuple[str, ...]:
    """Return the arguments that conditions read, themselves or by way of properties, in the order in which they are met."""
    found: dict[str, None] = {}
    texts, seen = [condition.element.get("value") for condition in conditions], set[str]()
    while texts:
        text = texts.pop(0)
        found.update(dict.fromkeys(ARGUMENT.findall(text)))
        for name in _iter_names(text):
            if name not in seen:
                seen.add(name)
                definitions = (e for e in iter_elements_by_tag(trees, "xacro:property") if e.get("name") == name)
                texts += [definition.get("value") for definition in definitions]
    return tuple(found)


def _iter_names(text: str) -> Iterator[str]:
    for match in EXPRESSION.finditer(text):
        yield from sorted(find_names(match[1] or match[2]))


def _find_condition_element(definition: Element) -> Element | None:
    """Return the condition nearest around a definition, in the same macro."""
    element = definition.parent
    while element is not None and element.tag != "xacro:macro":
        if element.tag in _CONDITIONS:
            return element
        element = element.parent
    return None


def _ends_after(element: Element, place: Span | None) -> bool:
    """Whether an element holds a place or follows it: then the condition is not why nothing is defined there."""
    lines = [child.span.line for child in element.walk() if child.span is not None]
    if place is None or element.span is None or not lines:
        return True
    return element.span.file == place.file and place.line <= max(lines)
