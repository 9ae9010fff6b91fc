"""Where the numbers and names of a finding were typed: a macro only hands on what a yaml file or a call gives it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from urdfcheck.core import Finding, Location, Span
from urdfcheck.source.text.handed_values import find_typed_value, read_numbers
from urdfcheck.source.text.xml import Attribute, Element

# The rules about elements as they are written.
_MARKUP = "XML"


def locate_typed_values(findings: Sequence[Finding], root: Element | None, texts: Mapping[str, str]) -> list[Finding]:
    """Move findings about numbers or names that a macro hands on, ``${mass}``, to the yaml value or the argument that has them.

    The text of the macro becomes the last step that brought the number in (``via``), so that a comment there still suppresses the
    finding. A finding stays where the macro computes a number or types one itself, or where it is not plain which of several
    texts became the number.

    :param root: the expanded model.
    :param texts: files by name.
    """
    if root is None:
        return list(findings)
    handed = {
        finding.location.span
        for finding in findings
        if finding.location.via and "${" in _get_text(finding.location.span, texts)
    }
    makers = _index_by_subject(root, handed) if handed else {}
    return [_move(finding, makers.get(finding.location.subject, ())) for finding in findings]


def _index_by_subject(root: Element, spans: Iterable[Span | None]) -> dict[str, tuple[Attribute, ...]]:
    """Return for the elements and attributes with these texts the attributes that hold their numbers, by subject."""
    wanted = set(spans)
    found: dict[str, tuple[Attribute, ...]] = {}
    for element in root.walk():
        if element.span in wanted:
            found.setdefault(element.subject, tuple(element.attributes.values()))
        for attribute in element.attributes.values():
            if attribute.span in wanted:
                found.setdefault(attribute.location.subject, (attribute,))
    return found


def _move(finding: Finding, attributes: Sequence[Attribute]) -> Finding:
    here = finding.location
    # A finding about an element that has a name is about the element; one about the name itself is about the name.
    places = _find_typed_places(attributes, may_be_name="@" in here.subject)
    if here.span is None or not places or _is_about_markup(finding):
        return finding
    first, last = places[0], places[-1]
    # The values of a block are a line each; between others there is text that has nothing to do with it.
    is_block = last.line - first.line < len(places)
    span = replace(first, end=last.end, end_line=last.end_line, end_col=last.end_col) if is_block else first
    return replace(
        finding,
        location=Location(here.subject, span, (*here.via, here.span)),
        related=tuple(place for place in finding.related if place.span != span),
    )


def _is_about_markup(finding: Finding) -> bool:
    """Whether an element itself is wrong, whatever its values are: it is typed in the macro, and no value of a call brings it."""
    return finding.code.startswith(_MARKUP) and "@" not in finding.location.subject


def _find_typed_places(attributes: Sequence[Attribute], *, may_be_name: bool) -> list[Span]:
    """Return the places of the values of these attributes, in one file and in its order; none if one of them is elsewhere, or is
    no number and may not be a name."""
    places: dict[Span, None] = {}
    for attribute in attributes:
        if attribute.literal and set(attribute.value.split()) <= {"0", "0.0"}:
            continue
        place = None if attribute.literal else _find_typed_place(attribute, may_be_name=may_be_name)
        if place is None:
            return []
        places[place] = None
    return sorted(places) if len({place.file for place in places}) == 1 else []


def _find_typed_place(attribute: Attribute, *, may_be_name: bool) -> Span | None:
    """Return the place of the text that a reference stands for, if it is this number or name."""
    typed = find_typed_value(attribute) if may_be_name or read_numbers(attribute.value) is not None else None
    return None if typed is None else typed.span


def _get_text(span: Span | None, texts: Mapping[str, str]) -> str:
    return "" if span is None else texts.get(span.file, "")[span.start : span.end]
