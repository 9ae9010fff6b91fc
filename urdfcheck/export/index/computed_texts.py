"""What the expressions of a xacro file became, and what they were computed from."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from urdfcheck.core import Span
from urdfcheck.core.text import truncate_text
from urdfcheck.export.index.source_index import ComputedText, ComputedUse, ValueSource, YamlKey
from urdfcheck.source.load import Source
from urdfcheck.source.text.xml import Attribute, Definition, Element, SourceFile, flatten_definitions

# Of a macro that is called a hundred times, and of a value that a whole file goes into.
_MOST_USES, _MOST_SOURCES, _LONGEST = 8, 12, 200
# The function that reads a yaml file, whatever module it is called by.
_YAML = "load_yaml"


def list_computed_texts(source: Source) -> tuple[ComputedText, ...]:
    """Return the texts with expressions of a model, in the order in which the robot reads them."""
    texts: dict[Span, str] = {}
    uses: dict[Span, dict[str, ComputedUse]] = {}

    def add(span: Span, text: str, value: str, subject: str, reads: Iterable[Definition]) -> None:
        texts.setdefault(span, text)
        known = uses.setdefault(span, {})
        if value not in known and len(known) < _MOST_USES:
            known[value] = ComputedUse(value=_shorten(value), subject=subject, sources=_list_sources(reads))

    seen: set[int] = set()
    for element in () if source.root is None else source.root.walk():
        content = _find_content(element, source.files)
        if content is not None:  # what it was computed from is known of attributes only
            typed = source.files[content.file].text[content.start : content.end]
            add(content, typed, element.text.strip(), element.subject, ())
        for attribute in element.attributes.values():
            if attribute.span is not None and "$" in attribute.typed:
                add(attribute.span, attribute.typed, attribute.value, _name_subject(attribute), attribute.reads)
            for definition in flatten_definitions(attribute.reads):
                if id(definition) in seen:
                    continue
                seen.add(id(definition))
                if definition.span is not None and "$" in definition.text and definition.value:
                    subject = f"{definition.kind}[{definition.name}]"
                    add(definition.span, definition.text, definition.value, subject, definition.reads)
    return tuple(ComputedText(span=span, text=texts[span], uses=tuple(known.values())) for span, known in uses.items())


def list_yaml_keys(source: Source) -> tuple[YamlKey, ...]:
    """Return the values of yaml files that the expressions of a model read, in the order in which the robot reads them."""
    if source.root is None or not any(_YAML in file.text for file in source.files.values()):
        return ()
    names: dict[Span, str] = {}
    readers: dict[Span, dict[Span, None]] = {}
    subjects: dict[Span, dict[str, None]] = {}
    for element in source.root.walk():
        for attribute in element.attributes.values():
            places = [(attribute.span, attribute.reads)]
            places += [(definition.span, definition.reads) for definition in flatten_definitions(attribute.reads)]
            for place, reads in places:
                for key in (read for read in reads if read.kind == "yaml" and read.span is not None):
                    assert key.span is not None
                    names[key.span] = key.name
                    readers.setdefault(key.span, {}).update({} if place is None else {place: None})
                    subjects.setdefault(key.span, {})[_name_subject(attribute)] = None
    return tuple(
        YamlKey(name=name, span=span, readers=tuple(readers[span]), subjects=tuple(subjects[span]))
        for span, name in names.items()
    )


def _find_content(element: Element, files: Mapping[str, SourceFile]) -> Span | None:
    """Return the place of the text of an element where it has an expression and nothing else is in the element."""
    span = element.span
    if span is None or span.file not in files or not element.text.strip():
        return None
    file = files[span.file]
    end = file.text.find("<", span.end)
    text = file.text[span.end : end]
    if "$" not in text or not file.text.startswith("</", end):
        return None
    start = span.end + len(text) - len(text.lstrip())
    return file.make_span(start, start + len(text.strip()))


def _name_subject(attribute: Attribute) -> str:
    return f"{attribute.owner.subject}@{attribute.name}"


def _list_sources(reads: Iterable[Definition]) -> tuple[ValueSource, ...]:
    return tuple(
        ValueSource(
            kind=definition.kind,
            name=definition.name,
            text=_shorten(definition.text),
            value="" if definition.value == definition.text else _shorten(definition.value),
            span=definition.span,
        )
        for definition in flatten_definitions(reads)[:_MOST_SOURCES]
    )


def _shorten(text: str) -> str:
    return truncate_text(" ".join(text.split()), _LONGEST)
