"""What is known of the models in an editor: of each the index of its last text of which one could be made."""

from __future__ import annotations

import functools
import os
import re
from collections.abc import Iterable, Iterator, Mapping

from urdfcheck.core import Span
from urdfcheck.core.records import dataclass
from urdfcheck.export.index.source_index import ComputedText, NamePlace, SourceIndex, YamlKey
from urdfcheck.server.check_messages import CheckAnswer
from urdfcheck.server.documents import DocumentStore, OpenDocument, TextShift

# Names of files in findings are relative to the working directory, which stays.
find_real_path = functools.lru_cache(maxsize=4096)(os.path.realpath)

# What the text from a yaml key to its value does not have.
_BETWEEN_KEYS = re.compile(r"[\n,{}\[\]]")


@dataclass(frozen=True, slots=True, eq=False)
class IndexedModel:
    """The index of a model, and the texts of the open documents that it was made of, by real path."""

    index: SourceIndex
    texts: Mapping[str, str]

    def find_shift(self, document: OpenDocument) -> TextShift | None:
        """Return where the places of the index are in a document now; None for a document that it is not about."""
        if not any(find_real_path(name) == document.real for name in self.index.files):
            return None
        return TextShift(self.texts.get(document.real, document.text), document.text)


@dataclass(frozen=True, slots=True, eq=False)
class IndexView:
    """An index as seen from one document."""

    model: IndexedModel
    document: OpenDocument
    shift: TextShift

    def find_offsets(self, span: Span | None) -> tuple[int, int] | None:
        """Return the place of a span in the present text; None where it is in another file or was edited."""
        if span is None or find_real_path(span.file) != self.document.real:
            return None
        return self.shift.move(span.start, span.end)

    def covers(self, span: Span | None, offset: int) -> bool:
        """Whether an offset of the present text is in a span, or right behind it."""
        place = self.find_offsets(span)
        return place is not None and place[0] <= offset <= place[1]

    def find_names(self, offset: int) -> list[NamePlace]:
        """Return the names at an offset: those with the shortest text around it."""
        return _select_shortest(place for place in self.model.index.names if self.covers(place.span, offset))

    def find_yaml_key(self, offset: int) -> YamlKey | None:
        """Return the value of a yaml file that an offset is in, or whose key it is in."""
        for key in self.model.index.yaml_keys:
            place = self.find_offsets(key.span)
            if place is None or offset > place[1]:
                continue
            if place[0] <= offset or not _BETWEEN_KEYS.search(self.document.text, offset, place[0]):
                return key
        return None

    def find_texts(self, offset: int) -> list[ComputedText]:
        """Return the texts with expressions around an offset."""
        return [text for text in self.model.index.texts if self.covers(text.span, offset)]


def _select_shortest(places: Iterable[NamePlace]) -> list[NamePlace]:
    found = list(places)
    shortest = min((place.span.end - place.span.start for place in found), default=0)
    return [place for place in found if place.span.end - place.span.start == shortest]


class IndexStore:
    """The indexes of all models that were checked last."""

    def __init__(self) -> None:
        self.models: dict[tuple[str, str], IndexedModel] = {}

    def take_answer(self, answer: CheckAnswer, texts: Mapping[str, str]) -> None:
        """Take the indexes of an answer. That of a text that no longer expands does not replace that of one that did."""
        taken: dict[tuple[str, str], IndexedModel] = {}
        for project in answer.projects:
            for index in project.indexes:
                key = project.folder, index.model
                old = self.models.get(key)
                is_worse = old is not None and (
                    (old.index.is_expanded and not index.is_expanded) or (old.index.names and not index.names)
                )
                taken[key] = old if old is not None and is_worse else IndexedModel(index, texts)
        self.models = taken

    def view(self, document: OpenDocument) -> Iterator[IndexView]:
        """Yield the indexes of the models that a document is a part of."""
        for model in self.models.values():
            shift = model.find_shift(document)
            if shift is not None:
                yield IndexView(model, document, shift)


def locate_present(span: Span, model: IndexedModel, documents: DocumentStore) -> tuple[int, int] | None:
    """Return the offsets of a span in the present text of its file; None where that was edited."""
    document = documents.find_open(span.file)
    if document is None or document.real not in model.texts:
        return span.start, span.end
    return TextShift(model.texts[document.real], document.text).move(span.start, span.end)
