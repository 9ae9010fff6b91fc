"""What an edit of the source makes of an element, without expanding the model again."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from urdfcheck.core import Edit, Span
from urdfcheck.source.text.xml import Element


def preview_edits(element: Element, edits: Iterable[Edit]) -> Element | None:
    """Return a copy of an element with its children after edits of its values; None where the edits touch none of them."""
    spans: dict[Span | None, str] = {edit.span: edit.replacement for edit in edits}
    return _copy_element(element, spans) if any(_is_touched(e, spans) for e in element.walk()) else None


def _is_touched(element: Element, spans: Mapping[Span | None, str]) -> bool:
    return any(a.literal and a.span in spans for a in element.attributes.values())


def _copy_element(element: Element, spans: Mapping[Span | None, str]) -> Element:
    attributes = {
        name: replace(a, value=spans[a.span]) if a.literal and a.span in spans else a
        for name, a in element.attributes.items()
    }
    children = [_copy_element(child, spans) for child in element.children]
    return replace(element, attributes=attributes, children=children, _label_cache=None)
