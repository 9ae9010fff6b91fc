"""Edits of attributes that are typed literally, and advice in words where a value is computed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from urdfcheck.core import Edit, Location
from urdfcheck.core.text import join_names
from urdfcheck.model.repairs.origin_edits import describe_definitions
from urdfcheck.source.text.tokens import find_content_span
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Attribute, Element, SourceFile


@dataclass(frozen=True, slots=True)
class AttributeChange:
    """An attribute and its new text."""

    attribute: Attribute | None
    """None if the element lacks it."""
    name: str
    text: str

    def __str__(self) -> str:
        # A mass is in the attribute `value` of its element.
        return f'{"mass value" if self.name == "mass" else self.name}="{self.text}"'


def edit_literal(attribute: Attribute | None, text: str) -> list[Edit]:
    """Return the edit that writes ``text`` in an attribute; nothing unless its value is typed literally."""
    if attribute is None or not attribute.literal or attribute.span is None:
        return []
    return [Edit(attribute.span, attribute.typed, text)]


def edit_literals(texts: Iterable[tuple[Attribute | None, str]]) -> list[Edit]:
    """Return the edits that write a text in each attribute; nothing unless all values are typed literally."""
    edits = []
    for attribute, text in texts:
        edit = edit_literal(attribute, text)
        if not edit:
            return []
        edits += edit
    return edits


def swap_literals(one: Attribute | None, other: Attribute | None) -> list[Edit]:
    """Return the edits that exchange two values; nothing unless both are typed literally."""
    return [] if one is None or other is None else edit_literals(((one, other.typed), (other, one.typed)))


def edit_content(element: Element, text: str, files: Mapping[str, SourceFile]) -> list[Edit]:
    """Return the edit that writes ``text`` as the content of an element; nothing unless its content is typed literally."""
    span = find_content_span(element, files)
    return [] if span is None else [Edit(span, element.text.strip(), text)]


def locate_content(element: Element, files: Mapping[str, SourceFile]) -> Location:
    """Locate the content of an element if it is typed literally, otherwise the element."""
    span = find_content_span(element, files)
    return element.location if span is None else Location(element.subject, span, element.via)


def make_attribute_edits(changes: Iterable[AttributeChange]) -> list[Edit]:
    """Return the edits that make all changes; nothing unless all values are typed literally."""
    return edit_literals((change.attribute, change.text) for change in changes)


def describe_remedy(changes: Sequence[AttributeChange], name: str, twin: str, *, shared: bool) -> str:
    """Return the instruction that gives the element ``name`` these numbers.

    :param shared: whether the same text makes its ``twin``, whose numbers are right, so that no number can be written for
        one of them alone. A macro parameter of 1 and -1 repairs numbers that differ only in sign.
    """
    computed = [(c, c.attribute) for c in changes if c.attribute is not None and not c.attribute.literal]
    definitions = {d.span: d for _, attribute in computed for d in attribute.collect_definitions()}
    numbers = " ".join(map(str, changes))
    if definitions:
        where = join_names(describe_definitions(list(definitions.values())))
        if len(computed) > 1 or len(changes) > 1:
            return f"give {name} {numbers}, computed from {where}"
        change, attribute = computed[0]
        return f"make `{attribute.typed}` give `{change.text}` for {name}: it is computed from {where}"
    if not shared:
        return f"write {numbers} in {name}"
    reflected = [_reflect_numbers(change) for change in changes]
    if None in reflected:
        return f"give the macro that makes both a parameter for them, so that {name} gets {numbers}"
    written = " ".join(f'{change.name}="{text}"' for change, text in zip(changes, reflected, strict=True))
    return f"give the macro a parameter such as `reflect`, 1 for {twin} and -1 for {name}, and write {written} in it"


def _reflect_numbers(change: AttributeChange) -> str | None:
    """Return the typed numbers, times ``reflect`` where the sign changes, or None if more than a sign changes."""
    typed = [] if change.attribute is None else change.attribute.value.split()
    wanted = change.text.split()
    if len(typed) != len(wanted):
        return None
    words = []
    for old, new in zip(typed, wanted, strict=True):
        before, after = parse_number(old), parse_number(new)
        if before is None or after is None or not math.isclose(abs(before), abs(after), rel_tol=1e-6, abs_tol=1e-15):
            return None
        words.append(f"${{reflect*{old}}}" if before * after < 0 else old)
    return " ".join(words)
