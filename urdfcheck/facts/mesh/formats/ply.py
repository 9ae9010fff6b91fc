"""PLY, as text and binary: vertices and faces. All other elements and properties are ignored.

Greg Turk, *The PLY Polygon File Format*, 1994; the names of types that have a number come from later libraries.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Protocol

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.mesh.decode_limits import MeshError
from urdfcheck.facts.mesh.formats.number_text import TokenizedText
from urdfcheck.facts.mesh.formats.polygons import (
    CHUNK,
    make_bad_line_error,
    parse_indices,
    parse_numbers,
    triangulate_fans,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from urdfcheck.facts.arrays import Bools, Indices

    # Where a property's values begin in each row, and how many each row has.
    Place = tuple[Indices, Indices]

_BOM = b"\xef\xbb\xbf"
# The largest header that is read, in bytes.
_LONGEST_HEADER = 64 * 1024
_LINE = re.compile(rb"([^\r\n]*)(\r\n|\n|\r)")
_NUMBERS = {
    "char": "i1",
    "uchar": "u1",
    "short": "i2",
    "ushort": "u2",
    "int": "i4",
    "uint": "u4",
    "float": "f4",
    "int8": "i1",
    "uint8": "u1",
    "int16": "i2",
    "uint16": "u2",
    "int32": "i4",
    "uint32": "u4",
    "float32": "f4",
    "double": "f8",
    "float64": "f8",
    "float16": "f2",
    "int64": "i8",
    "uint64": "u8",
}
# Lengths of lists, read without a sign: no list is shorter than none.
_LENGTHS = {name: f"u{kind[1]}" for name, kind in _NUMBERS.items() if kind[0] in "iu" and kind[1] != "8"}
_BYTE_ORDERS = {b"ascii": "", b"binary_little_endian": "<", b"binary_big_endian": ">"}
_INDEX_NAMES = ("vertex_indices", "vertex_index")
# Bytes at each of which a row is tried, where lists have different lengths.
_BLOCK = 1 << 16


@dataclass(frozen=True, slots=True)
class _PlyProperty:
    name: str
    kind: str
    """As numpy writes it, without the byte order."""
    length: str | None
    """The type of the length of a list; None if it is one number."""


@dataclass(frozen=True, slots=True)
class _PlyElement:
    name: str
    count: int
    properties: list[_PlyProperty]


class _PlyBody(Protocol):
    """What follows the header. Places are indices of bytes, or of tokens in a text."""

    def find_rows(self, element: _PlyElement) -> Indices:
        """Find the rows (n,) of the next element: where each begins, or the number of its line in a text.

        :raises MeshError: when there are fewer.
        """

    def find_values(self, element: _PlyElement, rows: Indices) -> dict[str, Place]:
        """Find the values of each property in some rows.

        :raises MeshError: when a line of a text has fewer.
        """

    def read_values(self, places: Indices, kind: str) -> NDArray[np.number]:
        """Read numbers, in the shape of ``places``."""

    def read_list(self, first: Indices, count: int, kind: str) -> Indices:
        """Read ``count`` whole numbers (n, count) from each of the places (n,)."""

    def refuse_rest(self) -> None:
        """Reject a file that goes on behind the last row, where other readers reject it.

        :raises MeshError: see above.
        """


def read_ply(data: bytes) -> tuple[NDArray[np.floating], Indices]:
    """Read the vertices (V, 3), float32 if they are stored so, and the faces (F, 3); polygons become fans.

    :raises MeshError: when it is not a PLY file, or shorter or, if binary, longer than its header declares.
    """
    order, elements, start = _parse_header(data)
    present, least = len(data) - start, sum(_count_least_bytes(element) for element in elements)
    if least > present:
        claims = _join_counts(elements)
        raise MeshError("truncated", f"is truncated: it declares {claims}, but has {present:,} bytes of them")
    body: _PlyBody = _BinaryBody(data, start, order) if order else _TextBody(data, start, elements)
    vertices: NDArray[np.floating] = np.empty((0, 3))
    faces: Indices = np.empty((0, 3), dtype=np.int32)
    for element in elements:
        rows = body.find_rows(element)
        if element.name == "vertex":
            vertices = _read_vertices(body, element, rows)
        elif element.name == "face" and element.count:
            faces = _read_faces(body, element, rows)
    body.refuse_rest()
    if not len(faces) and any(element.name == "tristrips" and element.count for element in elements):
        raise MeshError("unsupported", "keeps its triangles in strips (tristrips), which is not supported")
    return vertices, faces


def _parse_header(data: bytes) -> tuple[str, list[_PlyElement], int]:
    """Return the byte order, empty for a text, the elements, and where the header ends."""
    order: str | None = None
    elements: dict[str, _PlyElement] = {}
    for number, (line, end) in enumerate(_iter_header_lines(data), 1):
        match line.split():
            case [] if number > 1:
                continue
            case words if number == 1:
                if [word.lower() for word in words] != [b"ply"]:
                    raise MeshError("malformed", "does not begin like a ply file")
            case [b"end_header"]:
                if order is None:
                    raise MeshError("malformed", "cannot be read as ply: its header does not name a format")
                return order, list(elements.values()), end
            case [b"format", kind, *_] if kind in _BYTE_ORDERS:
                order = _BYTE_ORDERS[kind]
            case [b"element", name, count] if count.isdigit() and len(count) < 40 and _get_name(name) not in elements:
                elements[_get_name(name)] = _PlyElement(_get_name(name), int(count), [])
            case [b"property", *words] if elements and (found := _parse_property(words)) is not None:
                properties = next(reversed(elements.values())).properties
                if any(known.name == found.name for known in properties):
                    raise MeshError("malformed", f"cannot be read as ply: line {number} repeats a property")
                properties.append(found)
            case [b"format" | b"element" | b"property", *_]:
                shown = line.decode(errors="replace").strip()[:80]
                raise MeshError("malformed", f"cannot be read as ply: line {number} is {shown!r}")
    raise MeshError("malformed", "cannot be read as ply: its header does not end")


def _iter_header_lines(data: bytes) -> Iterator[tuple[bytes, int]]:
    """Yield the first lines and where each ends. A binary body may begin with the byte of a line feed: that belongs to a line
    only where the first one ends with it."""
    header = data[:_LONGEST_HEADER]
    first = _LINE.match(header)
    at, mark = 0, b"\r" if first is not None and first[2] == b"\r" else b"\n"
    while (end := header.find(mark, at)) >= 0:
        yield header[at:end].removeprefix(_BOM if at == 0 else b""), end + 1
        at = end + 1


def _get_name(word: bytes) -> str:
    return word.decode(errors="replace")


def _parse_property(words: list[bytes]) -> _PlyProperty | None:
    match [_get_name(word) for word in words]:
        case [kind, name] if kind in _NUMBERS:
            return _PlyProperty(name, _NUMBERS[kind], None)
        case ["list", length, kind, name] if length in _LENGTHS and kind in _NUMBERS:
            return _PlyProperty(name, _NUMBERS[kind], _LENGTHS[length])
    return None


def _count_least_bytes(element: _PlyElement) -> int:
    """Count the bytes that an element takes at least, in a text or not: one for each number."""
    return element.count * len(element.properties)


def _join_counts(elements: list[_PlyElement]) -> str:
    """Say how many rows of each element a file declares."""
    plurals = {"vertex": "vertices", "face": "faces"}
    names = (e.name if e.count == 1 else plurals.get(e.name, f"rows of {e.name}") for e in elements)
    return " and ".join(f"{e.count:,} {name[:30]}" for e, name in zip(elements, names, strict=True))


def _iter_chunks(rows: Indices) -> Iterator[tuple[slice, Indices]]:
    """Yield a few rows at a time, and which these are."""
    for at in range(0, len(rows), CHUNK):
        part = slice(at, min(at + CHUNK, len(rows)))
        yield part, rows[part].astype(np.int64)


def _read_vertices(body: _PlyBody, element: _PlyElement, rows: Indices) -> NDArray[np.floating]:
    kinds = {p.name: p.kind for p in reversed(element.properties) if p.length is None}
    if missing := [axis for axis in "xyz" if axis not in kinds]:
        raise MeshError("malformed", f"cannot be read as ply: its vertices have no {' and no '.join(missing)}")
    single = all(kinds[axis] == "f4" for axis in "xyz") and isinstance(body, _BinaryBody)
    vertices: NDArray[np.floating] = np.empty((len(rows), 3), dtype=np.float32 if single else np.float64)
    for part, chunk in _iter_chunks(rows):
        found = body.find_values(element, chunk)
        for column, axis in enumerate("xyz"):
            vertices[part, column] = body.read_values(found[axis][0], kinds[axis])
    return vertices


def _read_faces(body: _PlyBody, element: _PlyElement, rows: Indices) -> Indices:
    lists = {p.name: p for p in element.properties if p.length is not None and p.kind[0] in "iu"}
    chosen = next((lists[name] for name in _INDEX_NAMES if name in lists), None)
    if chosen is None and len(lists) == 1:
        (chosen,) = lists.values()
    if chosen is None:
        raise MeshError("malformed", "cannot be read as ply: its faces have no list of their vertices (vertex_indices)")
    name, kind = chosen.name, chosen.kind
    first, counts = np.empty_like(rows), np.empty_like(rows)
    for part, chunk in _iter_chunks(rows):
        first[part], counts[part] = body.find_values(element, chunk)[name]
    return triangulate_fans(counts, lambda polygons, count: body.read_list(first[polygons], count, kind))


class _BinaryBody:
    """Numbers in a file, at any byte."""

    def __init__(self, data: bytes, start: int, order: str) -> None:
        self._data = data
        self._at = start
        self._order = order
        # Of all places; a file that has more is not read.
        self._width = np.int32 if len(data) < 2**31 - 1 else np.int64

    def find_rows(self, element: _PlyElement) -> Indices:
        rows = self._find_regular_rows(element)
        return self._find_irregular_rows(element) if rows is None else rows

    def refuse_rest(self) -> None:
        if rest := self._data[self._at :].strip():
            raise MeshError("wrong-size", f"has {len(rest):,} more bytes than its header declares")

    def _find_regular_rows(self, element: _PlyElement) -> Indices | None:
        """Find rows that all have the size of the first one; None if there are others."""
        if not element.count or not element.properties:
            return np.empty(0, dtype=self._width)
        size = int(self._find_ends(element, np.array([self._at]))[0]) - self._at
        if self._at + element.count * size > len(self._data):
            return None
        rows: Indices = np.arange(element.count, dtype=self._width)
        rows *= size
        rows += self._at
        if any(p.length for p in element.properties):
            for _, chunk in _iter_chunks(rows):
                if (self._find_ends(element, chunk) != chunk + size).any():
                    return None
        self._at += element.count * size
        return rows

    def _find_irregular_rows(self, element: _PlyElement) -> Indices:
        """Find rows one after another."""
        found, known, at, size = [], 0, self._at, len(self._data)
        while known < element.count:
            begin = at
            ends = self._find_ends(element, np.arange(begin, min(begin + _BLOCK, size))).tolist()
            rows: list[int] = []
            while at - begin < len(ends) and known + len(rows) < element.count:
                rows.append(at)
                at = ends[at - begin]
            known += len(rows)
            found.append(np.array(rows, dtype=self._width))
            if at > size or (at == size and known < element.count):
                whole = known - (at > size)
                raise MeshError(
                    "truncated",
                    f"is truncated: it declares {_join_counts([element])} but has {whole:,}",
                )
        self._at = at
        return np.concatenate(found)

    def find_values(self, element: _PlyElement, rows: Indices) -> dict[str, Place]:
        return self._walk(element, rows)[0]

    def _find_ends(self, element: _PlyElement, rows: Indices) -> Indices:
        """Find where rows end: at any place behind the file if they do not fit into it."""
        return self._walk(element, rows)[1]

    def _walk(self, element: _PlyElement, rows: Indices) -> tuple[dict[str, Place], Indices]:
        found: dict[str, Place] = {}
        at, beyond = rows, len(self._data) + 1
        for p in element.properties:
            first, counts, size = at, np.ones_like(at), np.dtype(p.kind).itemsize
            if p.length is not None:
                width = np.dtype(p.length).itemsize
                # What is read in place of a length behind the end does not count: its row ends there too.
                counts = self.read_values(np.minimum(at, len(self._data) - width), p.length).astype(np.int64)
                first = at + width
            at = np.minimum(first + counts * size, beyond)
            found.setdefault(p.name, (first, counts))
        return found, at

    def read_values(self, places: Indices, kind: str) -> NDArray[np.number]:
        number = np.dtype(self._order + kind)
        everywhere: NDArray[np.number] = np.ndarray(
            (len(self._data) - number.itemsize + 1,), number, self._data, strides=(1,)
        )
        return everywhere[places]

    def read_list(self, first: Indices, count: int, kind: str) -> Indices:
        steps = np.arange(count) * np.dtype(kind).itemsize
        return self.read_values(first[:, None] + steps, kind).astype(np.int64)


class _TextBody:
    """Numbers in a text; each row is a line."""

    def __init__(self, data: bytes, start: int, elements: list[_PlyElement]) -> None:
        """:raises MeshError: when there are fewer lines than the elements have rows."""
        self._text = TokenizedText(data)
        lines = self._text.find_line_starts()
        lines = lines[np.searchsorted(lines, self._text.count_tokens_before(start)) :]
        self._starts, self._ends = lines, np.append(lines[1:], np.array(len(self._text), dtype=lines.dtype))
        self._known = 0
        filled = [element for element in elements if element.properties]
        declared = sum(element.count for element in filled)
        if len(lines) < declared:
            claims = _join_counts(filled)
            raise MeshError(
                "truncated", f"is truncated: it declares {claims}, {declared:,} lines, and has {len(lines):,}"
            )

    def find_rows(self, element: _PlyElement) -> Indices:
        first = self._known
        self._known += element.count if element.properties else 0
        return np.arange(first, self._known)

    def find_values(self, element: _PlyElement, rows: Indices) -> dict[str, Place]:
        found: dict[str, Place] = {}
        at, ends = self._starts[rows].astype(np.int64), self._ends[rows]
        for p in element.properties:
            first, counts = at, np.ones_like(at)
            if p.length is not None:
                self._refuse_bad_lines(rows, at >= ends)
                counts = parse_indices(self._text, at, "ply")
                self._refuse_bad_lines(rows, (counts < 0) | (counts >= ends - at))
                first = at + 1
            at = first + counts
            found.setdefault(p.name, (first, counts))
        self._refuse_bad_lines(rows, at > ends)
        return found

    def _refuse_bad_lines(self, rows: Indices, are_bad: Bools) -> None:
        for row in np.flatnonzero(are_bad)[:1]:
            raise make_bad_line_error(self._text, self._starts[rows[row]], "ply")

    def read_values(self, places: Indices, kind: str) -> NDArray[np.number]:  # noqa: ARG002
        return parse_numbers(self._text, places, "ply")

    def read_list(self, first: Indices, count: int, kind: str) -> Indices:  # noqa: ARG002
        return parse_indices(self._text, first[:, None] + np.arange(count), "ply")

    def refuse_rest(self) -> None:
        """Other readers take no notice of more lines."""
