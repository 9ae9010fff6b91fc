"""Polygons as triangles, and rows of numbers of text formats, a few thousand at a time: memory holds what the file gives and
little else."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.mesh.decode_limits import MeshError, ensure_size_limits
from urdfcheck.facts.mesh.formats.number_text import BadTokenError, TokenizedText

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from urdfcheck.facts.arrays import Array, Indices

# Numbers worked on at a time: their temporaries stay in the processor's cache.
CHUNK = 16384
# No mesh has as many vertices.
_MOST = 2**31 - 1


def triangulate_fans(counts: Indices, read_corners: Callable[[Indices, int], Indices]) -> Indices:
    """Return polygons as triangles (F, 3), in 32 bits, around their first corners, in order; those of fewer than 3 corners have
    none.

    :param counts: (n,), how many corners each polygon has: no more than the file holds.
    :param read_corners: reads the corners (m, k) of the polygons (m,) that have k.
    :raises MeshError: for more triangles than the limit.
    """
    if (counts == 3).all():  # as in most files, of whatever size
        return _read_triangles(len(counts), read_corners)
    sizes = np.maximum(counts, 2) - 2
    total = int(sizes.sum(dtype=np.int64))
    ensure_size_limits(total)
    triangles: Indices = np.empty((total, 3), dtype=np.int32)
    begins = np.cumsum(sizes) - sizes
    by_count = np.argsort(counts, kind="stable")
    for count, begin, times in zip(*np.unique(counts[by_count], return_index=True, return_counts=True), strict=True):
        if count < 3:
            continue
        fan = np.stack((np.zeros(count - 2, dtype=np.int64), np.arange(1, count - 1), np.arange(2, count)), axis=1)
        step = max(1, CHUNK // int(count))
        for at in range(begin, begin + times, step):
            polygons = by_count[at : min(at + step, begin + times)]
            corners = narrow_indices(read_corners(polygons, int(count)))
            triangles[begins[polygons][:, None] + np.arange(count - 2)] = corners[:, fan]
    return triangles


def _read_triangles(count: int, read_corners: Callable[[Indices, int], Indices]) -> Indices:
    ensure_size_limits(count)
    triangles: Indices = np.empty((count, 3), dtype=np.int32)
    for at in range(0, count, CHUNK):
        polygons = np.arange(at, min(at + CHUNK, count))
        triangles[at : at + CHUNK] = narrow_indices(read_corners(polygons, 3))
    return triangles


def narrow_indices(indices: NDArray[np.integer]) -> Indices:
    """Return indices in 32 bits; one that does not fit becomes one that no mesh has."""
    narrow: Indices = np.empty(indices.shape, dtype=np.int32)
    for at in range(0, len(indices), CHUNK):
        part = slice(at, at + CHUNK)
        narrow[part] = np.clip(indices[part].astype(np.int64, copy=False), -_MOST, _MOST)
    return narrow


def parse_rows(text: TokenizedText, first: Indices, width: int, name: str) -> Array:
    """Parse the numbers (n, width) of rows that begin at the tokens ``first`` (n,).

    :raises MeshError: see `parse_numbers`.
    """
    rows = np.empty((len(first), width))
    for at in range(0, len(first), CHUNK):
        rows[at : at + CHUNK] = parse_numbers(text, first[at : at + CHUNK, None] + np.arange(width), name)
    return rows


def parse_numbers(text: TokenizedText, tokens: Indices, name: str) -> Array:
    """Parse numbers, in the shape of ``tokens``.

    :raises MeshError: with the line of a token that is not a number, or the last one if the text ends too early.
    """
    with _locate_bad_tokens(text, tokens, name):
        return text.parse_numbers(tokens)


def parse_indices(text: TokenizedText, tokens: Indices, name: str) -> Indices:
    """Parse whole numbers, in the shape of ``tokens``.

    :raises MeshError: see `parse_numbers`.
    """
    with _locate_bad_tokens(text, tokens, name):
        return text.parse_indices(tokens)


def triangulate_text_fans(text: TokenizedText, first: Indices, counts: Indices, name: str) -> Indices:
    """Return polygons as triangles, see `triangulate_fans`; ``first`` (n,): the token of each polygon's first corner."""

    def read_corners(polygons: Indices, count: int) -> Indices:
        return parse_indices(text, first[polygons][:, None] + np.arange(count), name)

    return triangulate_fans(counts, read_corners)


@contextmanager
def _locate_bad_tokens(text: TokenizedText, tokens: Indices, name: str) -> Iterator[None]:
    if tokens.size and tokens.max() >= len(text):
        raise make_bad_line_error(text, len(text) - 1, name)
    try:
        yield
    except BadTokenError as bad:
        raise make_bad_line_error(text, bad.index, name) from None


def make_bad_line_error(text: TokenizedText, token: int, name: str) -> MeshError:
    number, line = text.locate_token(token)
    return MeshError("malformed", f"is not valid {name}: line {number} is {line!r}")
