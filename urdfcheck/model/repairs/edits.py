"""Edits of attributes where their values are typed, and advice in words where a value is computed.

A macro may hand on a value that a yaml file, a property or a call gives it: then the edit is there. Whether other attributes
read the same text is checked when all findings of a model are known (`urdfcheck.policy.fix_safety`).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from urdfcheck.core import Edit, Location, Span
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import join_names
from urdfcheck.model.repairs.number_text import keep_notation
from urdfcheck.model.repairs.origin_edits import describe_definitions
from urdfcheck.source.text.handed_values import find_typed_value
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
        # The blanks that align columns in a file are noise in a sentence.
        return f'{"mass value" if self.name == "mass" else self.name}="{" ".join(self.text.split())}"'


def change_numbers(attribute: Attribute | None, name: str, text: str) -> AttributeChange:
    """Return the change that writes numbers in an attribute, in the notation of those that are typed there."""
    return AttributeChange(
        attribute, name, text if attribute is None else keep_notation(read_typed_text(attribute), text)
    )


def edit_literal(attribute: Attribute | None, text: str) -> list[Edit]:
    """Return the edit that writes ``text`` in an attribute; nothing unless its value is typed literally."""
    if attribute is None or not attribute.literal or attribute.span is None:
        return []
    return [Edit(attribute.span, attribute.typed, text)]


def edit_literals(texts: Iterable[tuple[Attribute | None, str]]) -> list[Edit]:
    """Return the edits that write a text in each attribute; nothing unless all values are typed literally."""
    return _join_all(edit_literal(attribute, text) for attribute, text in texts)


def read_typed_text(attribute: Attribute) -> str:
    """Return the text that `edit_value` replaces; the value where there is none."""
    typed = find_typed_value(attribute)
    return attribute.value if typed is None else typed.text


def locate_text(attribute: Attribute) -> Span | None:
    """Return the place of the text that `edit_value` replaces; that of the attribute where its value is computed."""
    typed = find_typed_value(attribute)
    return attribute.span if typed is None else typed.span


def edit_value(attribute: Attribute | None, text: str) -> list[Edit]:
    """Return the edit that gives an attribute the value ``text`` where its value is typed; nothing where it is computed.

    That is in the attribute, or in the yaml file, the property or the call that hands it on.
    """
    typed = None if attribute is None else find_typed_value(attribute)
    return [] if typed is None else [Edit(typed.span, typed.text, text)]


def edit_values(texts: Iterable[tuple[Attribute | None, str]]) -> list[Edit]:
    """Return the edits that give each attribute a value, where it is typed; nothing where one of them is computed."""
    return _join_all(edit_value(attribute, text) for attribute, text in texts)


def edit_numbers(attribute: Attribute | None, text: str) -> list[Edit]:
    """Return the edit that gives an attribute these numbers, in the notation of those that are typed; nothing where they are
    computed."""
    return [] if attribute is None else edit_value(attribute, keep_notation(read_typed_text(attribute), text))


def edit_all_numbers(texts: Iterable[tuple[Attribute | None, str]]) -> list[Edit]:
    """Return the edits that give each attribute numbers, in its notation; nothing where one of the values is computed."""
    return _join_all(edit_numbers(attribute, text) for attribute, text in texts)


def swap_values(one: Attribute | None, other: Attribute | None) -> list[Edit]:
    """Return the edits that exchange two values; nothing where one of them is computed."""
    if one is None or other is None:
        return []
    return edit_values(((one, read_typed_text(other)), (other, read_typed_text(one))))


def _join_all(edits: Iterable[list[Edit]]) -> list[Edit]:
    """Return all edits that change something, each once: a macro makes several parts of one text; nothing where one of the
    changes has no edit."""
    each = list(edits)
    changing = (edit for some in each for edit in some if edit.expected != edit.replacement)
    return list(dict.fromkeys(changing)) if all(each) else []


def edit_content(element: Element, text: str, files: Mapping[str, SourceFile]) -> list[Edit]:
    """Return the edit that writes ``text`` as the content of an element; nothing unless its content is typed literally."""
    span = find_content_span(element, files)
    return [] if span is None else [Edit(span, element.text.strip(), text)]


def locate_content(element: Element, files: Mapping[str, SourceFile]) -> Location:
    """Locate the content of an element if it is typed literally, otherwise the element."""
    span = find_content_span(element, files)
    return element.location if span is None else Location(element.subject, span, element.via)


def make_attribute_edits(changes: Iterable[AttributeChange]) -> list[Edit]:
    """Return the edits that make all changes; nothing where one of the values is computed."""
    return edit_values((change.attribute, change.text) for change in changes)


def describe_remedy(
    changes: Sequence[AttributeChange],
    name: str,
    twin: str,
    *,
    shared: bool,
    twin_attributes: Sequence[Attribute | None] = (),
) -> str:
    """Return the instruction that gives the element ``name`` these numbers.

    :param shared: whether the same text makes its ``twin``, whose numbers are right, so that no number can be written for
        one of them alone. A macro parameter of 1 and -1 repairs numbers that differ only in sign.
    :param twin_attributes: those of its ``twin``. A property that both read is right for one of them: it stays, and the line of
        the other one gets its own numbers.
    """
    computed = [(c, c.attribute) for c in changes if c.attribute is not None and not c.attribute.literal]
    definitions = {d.span: d for _, attribute in computed for d in attribute.collect_definitions()}
    numbers = " ".join(map(str, changes))
    if computed and all(_is_read_apart(attribute, twin_attributes) for _, attribute in computed):
        typed = join_names(dict.fromkeys(f"`{attribute.typed}`" for _, attribute in computed))
        return f"write {numbers} in {name} in place of {typed}, which {twin} reads too"
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


def _is_read_apart(attribute: Attribute, others: Iterable[Attribute | None]) -> bool:
    """Whether one of some other attributes, which is typed elsewhere, hands on the same text as an attribute."""
    typed = find_typed_value(attribute)
    return typed is not None and any(
        other is not None and other.span != attribute.span and locate_text(other) == typed.span for other in others
    )


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
