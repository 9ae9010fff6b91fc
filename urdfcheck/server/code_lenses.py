"""What an editor shows above a robot, a macro file and each macro: how many robots use it, and what is wrong with it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence

from lsprotocol import types

from urdfcheck.core import Severity
from urdfcheck.core.text import format_count
from urdfcheck.export.index.source_index import JOINT, LINK, MACRO, SourceIndex
from urdfcheck.server.diagnostics import ShownFinding
from urdfcheck.server.documents import DocumentStore, OpenDocument, TextPositions
from urdfcheck.server.index_store import IndexStore, IndexView, find_real_path
from urdfcheck.source.text.xml import COMMENT

_ROOT = re.compile(r"<robot\b")
_END_OF_MACRO = "</xacro:macro"


def list_code_lenses(
    document: OpenDocument,
    indexes: IndexStore,
    documents: DocumentStore,
    shown: Mapping[str, Sequence[ShownFinding]],
) -> list[types.CodeLens]:
    """Return the lenses of a document. ``shown``: the findings of all files, by address."""
    views = list(indexes.view(document))
    robots = [view.model.index for view in views if view.model.index.is_expanded]
    positions = TextPositions(document.text, documents.encoding)
    own = shown.get(document.uri, ())
    lenses = [
        _make_lens(positions, offset, _describe_use(len(users), found))
        for offset, users, found in _iter_macros(views, robots, own, positions)
    ]
    root = _find_root(document.text)
    if root is None or not views:
        return lenses
    robot = next((index for index in robots if _is_of(index, document)), None)
    if robot is not None:
        about = [found for some in shown.values() for found in some if robot.model in found.finding.subjects_by_model]
        parts = [format_count(sum(part.kind == kind for part in robot.parts), kind) for kind in (LINK, JOINT)]
        title = " · ".join((*parts, *_count_findings(about)))
    else:
        title = _describe_use(len(robots), own)
    return [_make_lens(positions, root, title), *lenses]


def _is_of(index: SourceIndex, document: OpenDocument) -> bool:
    """Whether a document is the main file of a robot."""
    return bool(index.files) and find_real_path(index.files[0]) == document.real


def _find_root(text: str) -> int | None:
    """Return the offset of the root tag."""
    bare = COMMENT.sub(lambda comment: " " * len(comment[0]), text)
    match = _ROOT.search(bare)
    return None if match is None else match.start()


def _iter_macros(
    views: Iterable[IndexView], robots: Sequence[SourceIndex], own: Sequence[ShownFinding], positions: TextPositions
) -> Iterator[tuple[int, list[SourceIndex], list[ShownFinding]]]:
    """Yield the offset of each macro that a document defines, the robots that call it, and the findings in it."""
    names = {
        place: definition.name
        for view in views
        for definition in view.model.index.names
        if definition.is_definition and definition.kind == MACRO
        if (place := view.find_offsets(definition.span)) is not None
    }
    called = {index.model: {p.name for p in index.names if p.kind == MACRO and not p.is_definition} for index in robots}
    for (start, _), name in sorted(names.items()):
        users = [index for index in robots if name in called[index.model]]
        end = positions.text.find(_END_OF_MACRO, start)
        range_ = positions.make_range(start, end if end >= 0 else len(positions.text))
        yield start, users, [found for found in own if range_.start <= found.range.start <= range_.end]


def _describe_use(robots: int, found: Iterable[ShownFinding]) -> str:
    used = f"used by {format_count(robots, 'robot')}" if robots else "used by no robot"
    return " · ".join((used, *_count_findings(found)))


def _count_findings(found: Iterable[ShownFinding]) -> Iterator[str]:
    """Yield ``1 error`` and ``2 warnings``."""
    severities = [one.finding.severity for one in found]
    for severity in (Severity.ERROR, Severity.WARNING):
        count = severities.count(severity)
        if count:
            yield format_count(count, severity.name.lower())


def _make_lens(positions: TextPositions, offset: int, title: str) -> types.CodeLens:
    # A lens without a command is only read.
    return types.CodeLens(positions.make_range(offset, offset), types.Command(title, ""))
