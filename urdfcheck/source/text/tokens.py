"""The words inside an attribute's value, each with the span at which it was typed."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from urdfcheck.core import Edit, Location, Span
from urdfcheck.core.records import dataclass
from urdfcheck.source.text.xml import Attribute, Element, SourceFile

# A substitution that contains blanks, ``$(find pkg)`` or ``${2 * pi}``, belongs to one word.
_WORD = re.compile(r"(?:\$\{[^$}]*(?:\$(?!\{)[^$}]*)*\}|\$\([^()]*(?:\([^()]*\)[^()]*)*\)|\S)+")

# The most blanks that are searched between the name of an attribute and its value.
_BLANKS = 100
_END_TAG = re.compile(r"\s*</")


@dataclass(frozen=True, slots=True, eq=False)
class Token:
    """One word of ``attribute`` as typed."""

    text: str
    span: Span
    attribute: Attribute

    @property
    def location(self) -> Location:
        whole = self.attribute.location
        return Location(whole.subject, self.span, whole.via)

    def build_edit(self, replacement: str) -> Edit:
        return Edit(self.span, self.text, replacement)


def tokenize_attribute(attribute: Attribute | None, files: Mapping[str, SourceFile]) -> tuple[Token, ...]:
    """Return the words of an attribute; none if it was not typed anywhere. ``files``: those of its source."""
    if attribute is None or attribute.span is None or attribute.span.file not in files:
        return ()
    file, start = files[attribute.span.file], attribute.span.start
    return tuple(
        Token(m.group(0), file.make_span(start + m.start(), start + m.end()), attribute)
        for m in _WORD.finditer(attribute.typed)
    )


def locate_text(attribute: Attribute, text: str, files: Mapping[str, SourceFile]) -> Location:
    """Return the place of ``text`` inside an attribute; the whole attribute if it does not contain the text."""
    at = attribute.typed.find(text) if text else -1
    span = attribute.span
    if at < 0 or span is None or span.file not in files:
        return attribute.location
    whole = attribute.location
    return Location(whole.subject, files[span.file].make_span(span.start + at, span.start + at + len(text)), whole.via)


def build_removal_edits(element: Element, files: Mapping[str, SourceFile]) -> tuple[Edit, ...]:
    """Return the edit that deletes an element without content, and its line if nothing else is on it."""
    span = element.span
    if span is None or span.file not in files:
        return ()
    file = files[span.file]
    if not file.text.endswith("/>", span.start, span.end):
        return ()
    start, end = span.start, span.end
    before = file.text.rfind("\n", 0, start) + 1
    after = file.text.find("\n", end)
    if after >= 0 and not file.text[before:start].strip() and not file.text[end:after].strip():
        start, end = before, after + 1
    return (Edit(file.make_span(start, end), file.text[start:end], ""),)


def build_replacement_edits(attributes: Iterable[Attribute], text: str) -> tuple[Edit, ...]:
    """Return edits that write ``text`` in each of these attributes, each place once; none if one of them is not literal."""
    edits = []
    for attribute in attributes:
        if not attribute.literal or attribute.span is None:
            return ()
        edits.append(Edit(attribute.span, attribute.typed, text))
    return tuple(dict.fromkeys(edits))


def build_rename_edits(elements: Iterable[Element], tag: str, files: Mapping[str, SourceFile]) -> tuple[Edit, ...]:
    """Return edits that give elements another tag, in the end tags too; none if one of them is not typed with its tag."""
    edits: dict[Edit, None] = {}
    for element in elements:
        file = None if element.span is None else files.get(element.span.file)
        if element.span is None or file is None or not file.text.startswith(f"<{element.tag}", element.span.start):
            return ()
        places = [element.span.start + 1]
        if not file.text.endswith("/>", element.span.start, element.span.end):
            end = _find_end_tag(element.tag, file.text, element.span.end)
            if end is None:
                return ()
            places.append(end + 2)
        for start in places:
            edits[Edit(file.make_span(start, start + len(element.tag)), element.tag, tag)] = None
    return tuple(edits)


def _find_end_tag(tag: str, text: str, start: int) -> int | None:
    """Return the offset of the end tag of an element whose content begins at ``start``."""
    name = re.escape(tag)
    pattern = rf"""<!--.*?-->|<!\[CDATA\[.*?\]\]>|<\?.*?\?>|<(/?){name}(?=[\s/>])(?:"[^"]*"|'[^']*'|[^"'>])*>"""
    depth = 1
    for match in re.compile(pattern, re.DOTALL).finditer(text, start):
        if match.group(1) is None or match.group().endswith("/>"):
            continue
        depth += -1 if match.group(1) else 1
        if not depth:
            return match.start()
    return None


def find_element_span(element: Element, files: Mapping[str, SourceFile]) -> Span | None:
    """Return the place of a whole element, its end tag included; None if it was not typed with its tag."""
    span = element.span
    file = None if span is None else files.get(span.file)
    if span is None or file is None or not file.text.startswith(f"<{element.tag}", span.start):
        return None
    if file.text.endswith("/>", span.start, span.end):
        return span
    end = _find_end_tag(element.tag, file.text, span.end)
    return None if end is None else file.make_span(span.start, file.text.index(">", end) + 1)


def find_name_span(attribute: Attribute, files: Mapping[str, SourceFile]) -> Span | None:
    """Return the place of an attribute's name; None if the text before its value is not that name."""
    span = attribute.span
    if span is None or span.file not in files:
        return None
    file = files[span.file]
    # Before the value come the quotation mark, blanks, the equals sign and more blanks.
    begin = max(0, span.start - len(attribute.name) - _BLANKS)
    end = begin + len(file.text[begin : span.start - 1].rstrip().removesuffix("=").rstrip())
    start = end - len(attribute.name)
    return file.make_span(start, end) if file.text[start:end] == attribute.name else None


def find_content_span(element: Element, files: Mapping[str, SourceFile]) -> Span | None:
    """Return the place of an element's text, without the blanks around it.

    None if the file has something else there: an expression, an entity, a comment, other elements.
    """
    span, wanted = element.span, element.text.strip()
    if span is None or span.file not in files or not wanted:
        return None
    file = files[span.file]
    text = file.text[span.end : span.end + len(element.text)]
    start = span.end + len(text) - len(text.lstrip())
    end = start + len(wanted)
    return file.make_span(start, end) if file.text[start:end] == wanted and _END_TAG.match(file.text, end) else None


def read_typed_content(element: Element, files: Mapping[str, SourceFile]) -> str:
    """Return the text of an element as its file has it, up to the next tag; empty if the file is not known."""
    span = element.span
    return "" if span is None or span.file not in files else files[span.file].text[span.end :].partition("<")[0].strip()
