"""What the expressions of a xacro became, and where the numbers in them were typed, as text."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Span
from urdfcheck.export.index.source_index import ComputedText, ComputedUse, SourceIndex, ValueSource


def describe_computed(index: SourceIndex, words: str) -> str:
    """Return a block for each text with an expression whose place, text or element contains ``words``; all without any."""
    blocks = [block for text in index.texts if (block := _describe_text(text, words))]
    if blocks:
        return "\n".join(blocks)
    if not index.is_expanded:
        return f"{index.model} could not be expanded: check it"
    return f"no expression of {index.model} matches {words!r}" if words else f"{index.model} has no expressions"


def _describe_text(text: ComputedText, words: str) -> str:
    where = _place(text.span)
    uses = [use for use in text.uses if words in where or words in text.text or words in use.subject]
    return "\n".join([f"{where} {text.text}", *(line for use in uses for line in _iter_use(use))]) if uses else ""


def _iter_use(use: ComputedUse) -> Iterator[str]:
    yield f"  = {use.value} in {use.subject}"
    for source in use.sources:
        yield f"    {_describe_source(source)}"


def _describe_source(source: ValueSource) -> str:
    value = f" = {source.value}" if source.value else ""
    where = f" at {_place(source.span)}" if source.span is not None else ""
    return f"{source.kind} {source.name}: {source.text or 'unknown'}{value}{where}"


def _place(span: Span) -> str:
    return f"{span.file}:{span.line}"
