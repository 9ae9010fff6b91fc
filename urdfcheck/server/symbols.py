"""The outline of a document, what can be folded in it, and the values of its expressions beside them."""

from __future__ import annotations

import re
from collections.abc import Iterator

from lsprotocol import types

from urdfcheck.core import Span
from urdfcheck.core.text import round_decimals, truncate_text
from urdfcheck.export.index.source_index import ARGUMENT, LINK, MACRO, PROPERTY, RobotPart
from urdfcheck.server.documents import DocumentStore, OpenDocument, TextPositions
from urdfcheck.server.index_store import IndexStore, IndexView

_KINDS = {
    MACRO: types.SymbolKind.Function,
    PROPERTY: types.SymbolKind.Constant,
    ARGUMENT: types.SymbolKind.Variable,
}
# What is no element, or a tag, whose values hold no "<": a text that is being typed rarely parses.
_MARKUP = re.compile(
    r"""<!--.*?-->|<!\[CDATA\[.*?\]\]>|<\?.*?\?>|<(/?)([^\s<>/"'!?]+)((?:"[^"<]*"|'[^'<]*'|[^<>"'])*)>""", re.DOTALL
)
# The longest value beside an expression.
_LONGEST_HINT = 40


def list_symbols(document: OpenDocument, indexes: IndexStore, documents: DocumentStore) -> list[types.DocumentSymbol]:
    """Return the macros, properties and arguments that a document defines, then the links and joints that it makes.

    Links and joints are below those that they hang on, wherever the text of these is.
    """
    positions = TextPositions(document.text, documents.encoding)
    views = sorted(indexes.view(document), key=lambda view: not view.model.index.is_expanded)
    found: dict[tuple[int, str, int], types.DocumentSymbol] = {}
    for view in views:
        for place in view.model.index.names:
            offsets = view.find_offsets(place.span) if place.is_definition and place.kind in _KINDS else None
            if offsets is not None:
                range_ = positions.make_range(*offsets)
                symbol = types.DocumentSymbol(place.name, _KINDS[place.kind], range_, range_)
                found.setdefault((offsets[0], place.name, offsets[1]), symbol)
    names = [symbol for _, symbol in sorted(found.items(), key=lambda item: item[0])]
    # Of several robots that a file is a part of, the first: two trees of the same links would only be confusing.
    tree = next((parts for view in views if (parts := list(_iter_tree(view, positions)))), [])
    return [*names, *tree]


def _iter_tree(view: IndexView, positions: TextPositions) -> Iterator[types.DocumentSymbol]:
    """Yield the outermost parts of the robot that have a place in the document, each with those below it."""
    around: list[tuple[int, types.DocumentSymbol]] = []
    for part in view.model.index.parts:
        while around and around[-1][0] >= part.depth:
            around.pop()
        symbol = _make_symbol(part, view, positions)
        if symbol is None:
            continue
        if around:
            around[-1][1].children = [*(around[-1][1].children or ()), symbol]
        else:
            yield symbol
        around.append((part.depth, symbol))


def _make_symbol(part: RobotPart, view: IndexView, positions: TextPositions) -> types.DocumentSymbol | None:
    places = [offsets for place in part.places if (offsets := view.find_offsets(place)) is not None]
    if not places:
        return None
    whole = places[0]
    # The start tag, where the whole element is here too.
    inner = next((place for place in places[1:] if whole[0] <= place[0] and place[1] <= whole[1]), whole)
    kind = types.SymbolKind.Class if part.kind == LINK else types.SymbolKind.Interface
    return types.DocumentSymbol(
        part.name or "?", kind, positions.make_range(*whole), positions.make_range(*inner), detail=part.detail
    )


def list_folding_ranges(document: OpenDocument, documents: DocumentStore) -> list[types.FoldingRange] | None:
    """Return the elements and comments of several lines; the line of an end tag stays visible. None where the text is not XML."""
    if not document.text.lstrip("\ufeff \t\r\n").startswith("<"):
        return None
    positions = TextPositions(document.text, documents.encoding)
    folds = []
    for start, end, kind in _iter_folds(document.text):
        first, last = positions.find_position(start).line, positions.find_position(end).line
        if first < last:
            folds.append(types.FoldingRange(first, last, kind=kind))
    return folds


def _iter_folds(text: str) -> Iterator[tuple[int, int, types.FoldingRangeKind | None]]:
    """Yield what can be folded: the first offset and the last; of an element the end of the line before its end tag."""
    around: list[tuple[str, int]] = []
    for match in _MARKUP.finditer(text):
        closing, name, rest = match.groups()
        if name is None:
            if match[0].startswith("<!--"):
                yield match.start(), match.end(), types.FoldingRangeKind.Comment
        elif not closing:
            if not rest.endswith("/"):
                around.append((name, match.start()))
        elif any(name == opened for opened, _ in around):
            while around:
                opened, start = around.pop()
                if opened == name:
                    yield start, max(start, text.rfind("\n", 0, match.start())), None
                    break


def list_inlay_hints(
    document: OpenDocument, range_: types.Range, indexes: IndexStore, documents: DocumentStore
) -> list[types.InlayHint]:
    """Return the values of the expressions in a range, each behind its text; of a macro those of its first calls."""
    positions = TextPositions(document.text, documents.encoding)
    first, last = positions.find_offset(range_.start), positions.find_offset(range_.end)
    values: dict[int, dict[str, None]] = {}
    for view in indexes.view(document):
        for text in view.model.index.texts:
            place = _find_place(view, text.span, first, last)
            if place is not None:
                values.setdefault(place[1], {}).update(dict.fromkeys(round_decimals(use.value) for use in text.uses))
    return [
        types.InlayHint(
            # Behind the quotation mark, if there is one.
            positions.find_position(end + document.text.startswith(('"', "'"), end)),
            f"= {truncate_text(' | '.join(found), _LONGEST_HINT)}",
            padding_left=True,
        )
        for end, found in sorted(values.items())
        if any(found)
    ]


def _find_place(view: IndexView, span: Span, first: int, last: int) -> tuple[int, int] | None:
    place = view.find_offsets(span)
    return place if place is not None and first <= place[1] <= last else None
