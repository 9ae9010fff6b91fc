"""Which finding, link or joint of the report a place in a text is about, and how many findings a document's robots have."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

from lsprotocol import types

from urdfcheck.export.index.source_index import LINK, RobotPart
from urdfcheck.output.shared.anchors import build_finding_cards
from urdfcheck.server.diagnostics import ShownFinding
from urdfcheck.server.documents import DocumentStore, OpenDocument, TextPositions
from urdfcheck.server.index_store import IndexStore, IndexView


def find_selection(
    document: OpenDocument,
    position: types.Position,
    shown: Iterable[ShownFinding],
    indexes: IndexStore,
    documents: DocumentStore,
) -> dict[str, str]:
    """Return ``finding`` (the id of its card in the report), and ``link`` or ``joint``, as far as a place is about any.

    ``shown``: the findings of the document."""
    selection = {}
    found = _select_finding(shown, position)
    if found is not None:
        selection["finding"] = get_card_id(found)
    offset = TextPositions(document.text, documents.encoding).find_offset(position)
    part = next((part for view in indexes.view(document) if (part := _find_part(view, offset)) is not None), None)
    return selection if part is None else {**selection, part.kind: part.name}


def get_card_id(found: ShownFinding) -> str:
    """Return the id of the element that a finding has in a report."""
    (card,) = build_finding_cards([found.finding])
    return card.anchors[0]


def _select_finding(shown: Iterable[ShownFinding], position: types.Position) -> ShownFinding | None:
    """Return the worst finding at a position, else of its line."""
    at_line = [found for found in shown if found.range.start.line <= position.line <= found.range.end.line]
    here = [found for found in at_line if found.range.start <= position <= found.range.end]
    return max(here or at_line, key=lambda found: found.finding.severity, default=None)


def _find_part(view: IndexView, offset: int) -> RobotPart | None:
    """Return the link or joint that is named at an offset, else the one with the shortest text around it."""
    named = {(place.kind, place.name) for place in view.find_names(offset)}
    parts = view.model.index.parts
    by_name = next((part for part in parts if (part.kind, part.name) in named), None)
    if by_name is not None:
        return by_name
    around = [(length, part) for part in parts if (length := _measure_text_around(part, view, offset)) is not None]
    # A call of a macro brings in the joint too that holds the link.
    return min(around, key=lambda pair: (pair[0], pair[1].kind != LINK), default=(0, None))[1]


def _measure_text_around(part: RobotPart, view: IndexView, offset: int) -> int | None:
    """Return the length of the shortest text that brought a part in and has an offset in it; None if none has."""
    lengths = (place.end - place.start for place in part.places if view.covers(place, offset))
    return min(lengths, default=None)


def count_findings(
    document: OpenDocument, shown: Mapping[str, Iterable[ShownFinding]], indexes: IndexStore
) -> Counter[str]:
    """Count what is shown of the robots that a document is a part of, and in the document itself: error, warning, info.

    ``shown``: by the address of the file."""
    robots = {view.model.index.model for view in indexes.view(document)}
    return Counter(
        str(found.finding.severity)
        for uri, findings in shown.items()
        for found in findings
        if uri == document.uri or not robots.isdisjoint(found.finding.subjects_by_model)
    )
