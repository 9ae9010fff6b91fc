"""Go to the definition of a name, and find all places at which it is used: across includes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from lsprotocol import types

from urdfcheck.core import Span
from urdfcheck.export.index.source_index import ComputedText, NamePlace
from urdfcheck.server.documents import DocumentStore, OpenDocument, find_word
from urdfcheck.server.index_store import IndexedModel, IndexStore, locate_present
from urdfcheck.server.names.name_groups import find_same_names


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
    """Return where the name at an offset is used, in all models that know it; of a yaml key, the texts that read its value."""
    views = list(indexes.view(document))
    seeds = [name for view in views for name in view.find_names(offset)]
    models = list(indexes.models.values())
    found: list[types.Location] = []
    for view in views if not seeds else ():
        key = view.find_yaml_key(offset)
        if key is not None:
            spans = (*((key.span,) if with_definitions else ()), *key.readers)
            found += _locate_all(spans, view.model, documents)
    for number, place in find_same_names([model.index for model in models], seeds):
        if with_definitions or not place.is_definition:
            found += _locate_all([place.span], models[number], documents)
    return _drop_repeated(found)


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
