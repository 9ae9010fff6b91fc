"""The words inside an attribute's value, each with the span at which it was typed."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from urdfcheck.core import Edit, Location, Span
from urdfcheck.source.xml import Attribute, Element, SourceFile

# A substitution with blanks in it, ``$(find pkg)`` or ``${2 * pi}``, belongs to one word.
_WORD = re.compile(r"(?:\$\{[^$}]*(?:\$(?!\{)[^$}]*)*\}|\$\([^()]*(?:\([^()]*\)[^()]*)*\)|\S)+")


@dataclass(frozen=True, slots=True, eq=False)
class Word:
    """One word of ``attribute`` as typed."""

    text: str
    span: Span
    attribute: Attribute

    @property
    def location(self) -> Location:
        whole = self.attribute.location
        return Location(whole.subject, self.span, whole.via)

    def replaced(self, replacement: str) -> Edit:
        return Edit(self.span, self.text, replacement)


def words_of(attribute: Attribute | None, files: Mapping[str, SourceFile]) -> tuple[Word, ...]:
    """The words of an attribute, none where it was not typed anywhere. ``files`` as the source that it belongs to."""
    if attribute is None or attribute.span is None or attribute.span.file not in files:
        return ()
    file, start = files[attribute.span.file], attribute.span.start
    return tuple(
        Word(m.group(0), file.span(start + m.start(), start + m.end()), attribute)
        for m in _WORD.finditer(attribute.typed)
    )


def part_of(attribute: Attribute, text: str, files: Mapping[str, SourceFile]) -> Location:
    """Where ``text`` stands inside an attribute; the whole attribute when it is not found in it."""
    at = attribute.typed.find(text) if text else -1
    span = attribute.span
    if at < 0 or span is None or span.file not in files:
        return attribute.location
    whole = attribute.location
    return Location(whole.subject, files[span.file].span(span.start + at, span.start + at + len(text)), whole.via)


def removal(element: Element, files: Mapping[str, SourceFile]) -> tuple[Edit, ...]:
    """The edit that deletes an element without content, with its line when nothing else stands on it."""
    span = element.span
    if span is None or span.file not in files:
        return ()
    file = files[span.file]
    if not file.text[: span.end].endswith("/>"):
        return ()
    start, end = span.start, span.end
    before = file.text.rfind("\n", 0, start) + 1
    after = file.text.find("\n", end)
    if after >= 0 and not file.text[before:start].strip() and not file.text[end:after].strip():
        start, end = before, after + 1
    return (Edit(file.span(start, end), file.text[start:end], ""),)
