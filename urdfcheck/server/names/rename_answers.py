"""What an editor shows and does to change a name: which text that is, and the edits."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from lsprotocol import types

from urdfcheck.core import Edit
from urdfcheck.core.text import join_names
from urdfcheck.export.index.source_index import DoubtfulName
from urdfcheck.server.documents import DocumentStore, OpenDocument, TextPositions, make_workspace_edit
from urdfcheck.server.index_store import IndexStore
from urdfcheck.server.names.new_names import RENAMED_KINDS
from urdfcheck.server.names.rename_plan import NOTHING_HERE, RenameRefusedError, find_renamed_part


def prepare_rename(
    document: OpenDocument, offset: int, indexes: IndexStore, documents: DocumentStore
) -> types.PrepareRenamePlaceholder:
    """Return the text at an offset that can be renamed: a name, or the literal part of one that is built from an expression.

    :raises RenameRefusedError: if there is none.
    """
    for view in indexes.view(document):
        for name in view.find_names(offset):
            place = view.find_offsets(name.span)
            if place is None or name.kind not in RENAMED_KINDS:
                continue
            part = find_renamed_part(document.text[slice(*place)], offset - place[0])
            if part is not None:
                start, end = place[0] + part[0], place[0] + part[1]
                positions = TextPositions(document.text, documents.encoding)
                return types.PrepareRenamePlaceholder(positions.make_range(start, end), document.text[start:end])
    raise RenameRefusedError(NOTHING_HERE)


def make_rename_edit(edits: Iterable[Edit], documents: DocumentStore) -> types.WorkspaceEdit:
    """Return the edits of a renaming for the editor.

    :raises RenameRefusedError: if a text has changed since they were computed.
    """
    made = []
    for edit in edits:
        positions = documents.find_text(edit.span.file)
        start, end = edit.span.start, edit.span.end
        if positions is None or positions.text[start:end] != edit.expected:
            raise RenameRefusedError(f"{edit.span.file} was changed meanwhile: try again.")
        made.append((edit.span.file, types.TextEdit(positions.make_range(start, end), edit.replacement)))
    return make_workspace_edit(made, documents)


def describe_doubtful_names(texts: Sequence[DoubtfulName]) -> Iterator[str]:
    """Yield a sentence about the texts that a renaming leaves as they are, if there are any."""
    if texts:
        shown = (f"`{t.name}` in {Path(t.span.file).name}:{t.span.line} ({t.doubt})" for t in texts)
        yield f"Not renamed: {join_names(shown)}."


def describe_untried_models(models: Sequence[str]) -> Iterator[str]:
    """Yield a sentence about the models in which a renaming could not be tried, if there are any."""
    if models:
        yield f"Not tried, as it cannot be expanded now: {join_names(models)}."
