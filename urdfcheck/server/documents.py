"""The texts of an editor: positions in the editor's units, and where a place of an earlier text is now."""

from __future__ import annotations

import difflib
import os
import re
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import field
from pathlib import Path

from lsprotocol import types
from pygls import uris

from urdfcheck.core import NEWLINE, Span
from urdfcheck.core.records import dataclass
from urdfcheck.source.reach import FileReach
from urdfcheck.source.text.xml import SourceFile, XmlError

UTF_8, UTF_16 = types.PositionEncodingKind.Utf8, types.PositionEncodingKind.Utf16
_DECLARATION = re.compile(r"""\ufeff?<\?xml[^>]*?\sencoding\s*=\s*["']([\w.-]+)["']""")
# The texts of files that are not open and that positions were asked for, which are kept.
_MOST_FILES = 64


class TextPositions:
    """Converts offsets (code points) in a text to the editor's positions and back.

    A line ends where LSP says, at ``\\n``, ``\\r\\n`` or ``\\r``: ``str.splitlines`` would also break at form feeds.
    """

    def __init__(self, text: str, encoding: types.PositionEncodingKind | str = UTF_16) -> None:
        self.text = text
        self.encoding = encoding
        self.starts = [0, *(match.end() for match in NEWLINE.finditer(text))]
        self.is_ascii = text.isascii()

    def find_position(self, offset: int) -> types.Position:
        """Return the position of an offset; of one beyond the text, its end."""
        offset = min(max(offset, 0), len(self.text))
        line = bisect_right(self.starts, offset) - 1
        before = self.text[self.starts[line] : offset]
        return types.Position(line, len(before) if self.is_ascii else _count_units(before, self.encoding))

    def find_offset(self, position: types.Position) -> int:
        """Return the offset of a position; of one beyond its line, the line's end, as LSP says."""
        if position.line >= len(self.starts):
            return len(self.text)
        start = self.starts[position.line]
        end = self.starts[position.line + 1] if position.line + 1 < len(self.starts) else len(self.text)
        line = self.text[start:end].rstrip("\r\n")
        if self.is_ascii:
            return start + min(position.character, len(line))
        units = 0
        for index, character in enumerate(line):
            if units >= position.character:
                return start + index
            units += _count_units(character, self.encoding)
        return start + len(line)

    def make_range(self, start: int, end: int) -> types.Range:
        """Return the range between two offsets."""
        return types.Range(self.find_position(start), self.find_position(end))

    def make_line_range(self, span: Span) -> types.Range:
        """Return the range of a span by its lines and columns: for a text that may not be the one of the span."""
        offsets = [
            min(self.starts[line - 1] + col - 1, len(self.text)) if line <= len(self.starts) else len(self.text)
            for line, col in ((span.line, span.col), (span.end_line, span.end_col))
        ]
        return self.make_range(*offsets)


def _count_units(text: str, encoding: types.PositionEncodingKind | str) -> int:
    if encoding == UTF_16:
        return len(text) + sum(character > "\uffff" for character in text)
    return len(text.encode("utf-8", "surrogatepass")) if encoding == UTF_8 else len(text)


def find_word(text: str, offset: int) -> tuple[str, str]:
    """Return the parts of the word around an offset before it and behind it."""
    start = end = offset
    while start > 0 and (text[start - 1].isalnum() or text[start - 1] == "_"):
        start -= 1
    while end < len(text) and (text[end].isalnum() or text[end] == "_"):
        end += 1
    return text[start:offset], text[offset:end]


class TextShift:
    """Where the places of an old text are in a new one: unchanged before the first difference, moved after the last."""

    def __init__(self, old: str, new: str) -> None:
        self.is_identity = old == new
        self.first = _count_common(old, new)
        most = min(len(old), len(new)) - self.first
        self.last = len(old) - _count_common(old[len(old) - most :][::-1], new[len(new) - most :][::-1])
        self.moved_by = len(new) - len(old)

    def move(self, start: int, end: int) -> tuple[int, int] | None:
        """Return where a place is; None where it was edited, or the text right beside it."""
        if self.is_identity or end < self.first:
            return start, end
        return (start + self.moved_by, end + self.moved_by) if start > self.last else None


def _count_common(one: str, other: str) -> int:
    """Return how many characters two texts begin with in common: by halving, which compares pieces at once."""
    low, high = 0, min(len(one), len(other))
    while low < high:
        middle = (low + high + 1) // 2
        if one[low:middle] == other[low:middle]:
            low = middle
        else:
            high = middle - 1
    return low


@dataclass(slots=True)
class OpenDocument:
    """A document that an editor has open."""

    uri: str
    path: str
    """Absolute."""
    text: str
    version: int | None
    real: str = field(init=False)
    """Real path."""

    def __post_init__(self) -> None:
        self.real = os.path.realpath(self.path)

    def encode(self) -> bytes:
        """Return the text as the bytes of a file, in the encoding that it declares."""
        declared = _DECLARATION.match(self.text)
        try:
            return self.text.encode("utf-8" if declared is None else declared[1])
        except (LookupError, UnicodeEncodeError):
            return self.text.encode("utf-8", "surrogatepass")


class DocumentStore:
    """The open documents, and the texts of other files that answers point into."""

    def __init__(self, folders: Iterable[Path] = ()) -> None:
        """``folders``: those that the command line names, whose files may be read."""
        self.encoding: types.PositionEncodingKind | str = UTF_16
        self.has_versioned_edits = False
        self.can_create_files = False
        self.by_uri: dict[str, OpenDocument] = {}
        self.sources: Mapping[str, str] = {}
        """Real path → text of the files with findings, as they were checked."""
        self._folders = tuple(folders)
        self._files: dict[str, tuple[tuple[int, int] | None, TextPositions]] = {}

    def open(self, uri: str, text: str, version: int | None) -> OpenDocument | None:
        """Note that a document was opened or changed; return it, or None for an address that is not a file's."""
        path = uris.to_fs_path(uri) if uri.startswith("file:") else None
        if path is None:
            return None
        # Most editors keep the byte order mark to themselves; offsets are counted behind it.
        text = text.removeprefix("\ufeff")
        document = self.by_uri[uri] = OpenDocument(uri, os.path.abspath(path), text, version)
        return document

    def close(self, uri: str) -> OpenDocument | None:
        """Forget a document."""
        return self.by_uri.pop(uri, None)

    def find_open(self, name: str) -> OpenDocument | None:
        """Return the open document of a file, by its name in findings or its path."""
        real = os.path.realpath(name)
        return next((document for document in self.by_uri.values() if document.real == real), None)

    def find_uri(self, name: str) -> str:
        """Return the address of a file: the editor's own, if it is open."""
        document = self.find_open(name)
        return uris.from_fs_path(os.path.abspath(name)) or "" if document is None else document.uri

    def find_text(self, name: str) -> TextPositions | None:
        """Return the present text of a file: the editor's, or that on the disk; None if it cannot or must not be read."""
        document = self.find_open(name)
        if document is not None:
            return TextPositions(document.text, self.encoding)
        real = os.path.realpath(name)
        if real in self.sources:
            return self._keep(real, None, self.sources[real])
        try:
            status = os.stat(real)
            stamp = status.st_size, status.st_mtime_ns
            known = self._files.get(real)
            if known is not None and known[0] == stamp:
                return known[1]
            can_open = self.find_reach().can_open(Path(real))
            return self._keep(real, stamp, SourceFile.read(Path(real), name).text) if can_open else None
        except (OSError, XmlError):
            return None

    def find_reach(self) -> FileReach:
        """Return which files may be read: those of the projects of the open documents, and of the folders that were named."""
        return FileReach.from_paths([Path(document.path) for document in self.by_uri.values()], self._folders)

    def _keep(self, real: str, stamp: tuple[int, int] | None, text: str) -> TextPositions:
        known = self._files.get(real)
        if known is not None and known[0] == stamp and known[1].text is text:
            return known[1]
        while len(self._files) >= _MOST_FILES:
            del self._files[next(iter(self._files))]
        self._files[real] = stamp, TextPositions(text, self.encoding)
        return self._files[real][1]

    def locate(self, span: Span) -> types.Location:
        """Return the place of a span in the present text of its file; of a text that is not known, by its code points."""
        positions = self.find_text(span.file)
        if positions is not None:
            return types.Location(self.find_uri(span.file), positions.make_line_range(span))
        start, end = (
            types.Position(line - 1, col - 1) for line, col in ((span.line, span.col), (span.end_line, span.end_col))
        )
        return types.Location(self.find_uri(span.file), types.Range(start, end))


def make_workspace_edit(edits: Iterable[tuple[str, types.TextEdit]], documents: DocumentStore) -> types.WorkspaceEdit:
    """Return the edits of some files, for the versions that are open where the editor can compare them."""
    by_file: dict[str, list[types.TextEdit]] = {}
    for name, edit in edits:
        by_file.setdefault(name, []).append(edit)
    if not documents.has_versioned_edits:
        return types.WorkspaceEdit(changes={documents.find_uri(name): made for name, made in by_file.items()})
    changes: list[types.TextDocumentEdit | types.CreateFile | types.RenameFile | types.DeleteFile] = []
    for name, made in by_file.items():
        document = documents.find_open(name)
        version = None if document is None else document.version
        identifier = types.OptionalVersionedTextDocumentIdentifier(documents.find_uri(name), version)
        changes.append(types.TextDocumentEdit(identifier, [*made]))
    return types.WorkspaceEdit(document_changes=changes)


def iter_differences(positions: TextPositions, new: str) -> Iterator[types.TextEdit]:
    """Yield the edits, line by line, that make another text of one."""
    old_lines, new_lines = positions.text.splitlines(keepends=True), new.splitlines(keepends=True)
    starts = [0]
    for line in old_lines:
        starts.append(starts[-1] + len(line))
    matcher = difflib.SequenceMatcher(None, old_lines, new_lines, autojunk=False)
    for kind, first, last, new_first, new_last in matcher.get_opcodes():
        if kind != "equal":
            range_ = positions.make_range(starts[first], starts[last])
            yield types.TextEdit(range_, "".join(new_lines[new_first:new_last]))
