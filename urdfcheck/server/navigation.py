"""Go to the definition of a name, and find all places at which it is used: across includes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from lsprotocol import types

from urdfcheck.core import Span
from urdfcheck.export.index.source_index import ComputedText, NamePlace
from urdfcheck.server.documents import DocumentStore, OpenDocument, find_word
from urdfcheck.server.index_store import IndexedModel, IndexStore, locate_present


def find_definitions(
    indexes: IndexStore, documents: DocumentStore, document: OpenDocument, offset: int
) -> list[types.Location]:
    """Return where the name at an offset is defined; for an expression without names, what it was computed from."""
    found: list[types.Location] = []
    for view in indexes.view(document):
        names = view.find_names(offset)
        spans = [span for name in names for span in _iter_definitions(view.model, name)]
        if not names:
            key = "".join(find_word(document.text, offset))
            spans = [*_iter_source_places(view.find_texts(offset), key)]
        found += _locate_all(spans, view.model, documents)
    return _drop_repeated(found)


def _iter_source_places(texts: Iterable[ComputedText], key: str) -> Iterator[Span]:
    """Yield the places of the keys of this name that texts were computed from, or else of their nearest sources."""
    for text in texts:
        for use in text.uses:
            named = [source for source in use.sources if source.kind == "yaml" and source.name.endswith(key)]
            yield from (source.span for source in named or use.sources[:1] if source.span is not None)


def find_references(
    indexes: IndexStore, documents: DocumentStore, document: OpenDocument, offset: int, *, with_definitions: bool
) -> list[types.Location]:
    """Return where the name at an offset is used, in all models that know it."""
    wanted: set[tuple[str, str, Span | None]] = {
        (name.kind, name.name, definition)
        for view in indexes.view(document)
        for name in view.find_names(offset)
        for definition in _iter_definitions(view.model, name)
    }
    wanted |= {(n.kind, n.name, None) for view in indexes.view(document) for n in view.find_names(offset)}
    found: list[types.Location] = []
    for model in indexes.models.values():
        spans = [
            place.span
            for place in model.index.names
            if (place.kind, place.name, None) in wanted
            and (with_definitions or not place.is_definition)
            and _means_one_of(place, wanted)
        ]
        found += _locate_all(spans, model, documents)
    return _drop_repeated(found)


def _means_one_of(place: NamePlace, wanted: set[tuple[str, str, Span | None]]) -> bool:
    """Whether a place means one of the definitions, as far as it is known what it means."""
    meant = (place.span,) if place.is_definition else place.targets
    return not meant or any((place.kind, place.name, span) in wanted for span in meant)


def _iter_definitions(model: IndexedModel, name: NamePlace) -> Iterator[Span]:
    if name.is_definition:
        yield name.span
    if name.targets:
        yield from name.targets
        return
    for place in model.index.names:
        if place.is_definition and (place.kind, place.name) == (name.kind, name.name) and not name.is_definition:
            yield place.span


def _locate_all(spans: Iterable[Span], model: IndexedModel, documents: DocumentStore) -> Iterator[types.Location]:
    for span in spans:
        place = locate_present(span, model, documents)
        positions = documents.find_text(span.file)
        if place is not None and positions is not None:
            yield types.Location(documents.find_uri(span.file), positions.make_range(*place))
        elif place is not None:
            yield documents.locate(span)


def _drop_repeated(found: Iterable[types.Location]) -> list[types.Location]:
    places = {(place.uri, str(place.range)): place for place in found}
    return list(places.values())
