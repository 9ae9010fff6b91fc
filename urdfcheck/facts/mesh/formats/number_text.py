"""Numbers of text formats, many at a time.

A token's digits are read eight at a time as one 64-bit word and summed inside it (Lemire, *Quickly parsing eight digits*,
2022), for all tokens together. A number of up to 15 digits and a power of ten up to 22 is rounded as ``float`` rounds it
(Clinger, *How to read floating point numbers accurately*, 1990), others to within two units in the last place; ``float``
itself reads unusual spellings.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from urdfcheck.facts.arrays import Array, Bools, Indices

    Words = NDArray[np.uint64]

_PAD = 24  # allows to read as many bytes before any token's end
_BLOCK = 1 << 20  # bytes looked at at a time
_CHUNK = 16384  # tokens worked on at a time: their temporaries stay in the processor's cache
_TENS = np.array([float(f"1e{power}") for power in range(309)])
_WHOLE_TENS = np.array([10**power for power in range(20)], dtype=np.uint64)
# The last k bytes of a word, which are its highest ones, for k = 0 to 8.
_LAST = np.array([0, *((2**64 - 1) ^ (2 ** (8 * (8 - k)) - 1) for k in range(1, 9))], dtype=np.uint64)
_ZEROS = np.uint64(0x3030303030303030)
_HIGH_BITS = np.uint64(0x8080808080808080)
_PAST_NINE = np.uint64(0x7676767676767676)


def find_places(size: int, find_flags: Callable[[slice], Bools]) -> Indices:
    """Return the indices, of ``size``, at which flags are set that are computed for a slice at a time.

    They are computed twice, to need no memory but the result's, in half the width of numpy's where they fit into it."""
    blocks = [slice(at, min(at + _BLOCK, size)) for at in range(0, size, _BLOCK)]
    ends = np.cumsum([0, *(np.count_nonzero(find_flags(block)) for block in blocks)])
    places: Indices = np.empty(ends[-1], np.int32 if size < 2**31 - _BLOCK else np.int64)
    for block, begin, end in zip(blocks, ends[:-1], ends[1:], strict=True):
        np.add(np.flatnonzero(find_flags(block)), block.start, out=places[begin:end], casting="same_kind")
    return places


class BadTokenError(Exception):
    """A token that should be a number; its index."""

    def __init__(self, index: int) -> None:
        super().__init__(index)
        self.index = index


class TokenizedText:
    """The bytes of a text file and its tokens, which are runs of bytes above the blank. ``starts`` and ``ends`` (n,) are
    positions in ``bytes``, which holds the file between blanks."""

    def __init__(self, data: bytes) -> None:
        self._data = b" " * _PAD + data + b" " * 8
        self.bytes = np.frombuffer(self._data, dtype=np.uint8)
        self._words = np.ndarray((len(self.bytes) - 7,), dtype=np.uint64, buffer=self._data, strides=(1,))

        def find_starts(block: slice) -> Bools:
            blank = self.bytes[block.start : block.stop + 1] <= 32
            starts: Bools = blank[:-1] > blank[1:]
            return starts

        def find_ends(block: slice) -> Bools:
            blank = self.bytes[block.start : block.stop + 1] <= 32
            ends: Bools = blank[:-1] < blank[1:]
            return ends

        self.starts, self.ends = (find_places(len(self.bytes) - 1, find) for find in (find_starts, find_ends))
        self.starts += 1
        self.ends += 1
        self._places: dict[int, Indices] = {}

    def __len__(self) -> int:
        return len(self.starts)

    def find_line_starts(self) -> Indices:
        """Find the index of the first token of each line that has one."""
        index = find_places(len(self.bytes), lambda block: (self.bytes[block] == 10) | (self.bytes[block] == 13))
        for at in range(0, len(index), _CHUNK):
            index[at : at + _CHUNK] = np.searchsorted(self.starts, index[at : at + _CHUNK])
        index = np.insert(index, 0, 0)
        index = index[np.diff(index, prepend=index.dtype.type(-1)) > 0]
        return index[index < len(self)]

    def count_tokens_before(self, position: int) -> int:
        """Count the tokens that begin before a position in the file."""
        return int(np.searchsorted(self.starts, position + _PAD))

    def get_token(self, index: int) -> bytes:
        return self._data[self.starts[index] : self.ends[index]]

    def match_word(self, word: bytes, tokens: Indices | None = None) -> Bools:
        """Return which of the ``tokens`` (n,), or of all, are this word of up to eight lower case letters, in any case."""
        chosen = slice(None) if tokens is None else tokens
        heads = self._heads if tokens is None else self._read_heads(self.starts[tokens])
        mask = np.uint64(2 ** (8 * len(word)) - 1)
        wanted = np.uint64(int.from_bytes(word, "little"))
        matches: Bools = (heads & mask == wanted) & (self.ends[chosen] - self.starts[chosen] == len(word))
        return matches

    @cached_property
    def _heads(self) -> Words:
        return self._read_heads(self.starts)

    def _read_heads(self, starts: Indices) -> Words:
        """Return the first eight bytes of tokens, in lower case."""
        heads: Words = self._words[starts] | np.uint64(0x2020202020202020)
        return heads

    def locate_token(self, index: int) -> tuple[int, str]:
        """Return the number of a token's line, from 1, and the start of its text, for a message."""
        start = int(self.starts[index])
        before = self._data[:start]
        line = (
            before[max(before.rfind(b"\n"), before.rfind(b"\r")) + 1 :] + self._data[start : start + 80].splitlines()[0]
        )
        number = before.replace(b"\r\n", b"\n").replace(b"\r", b"\n").count(b"\n") + 1
        return number, line.decode(errors="replace").strip()[:80]

    def parse_numbers(self, tokens: Indices) -> Array:
        """Return the values of tokens, in the shape of ``tokens``.

        :raises BadTokenError: when one is not a number.
        """
        flat = tokens.ravel()
        values = np.empty(len(flat))
        with np.errstate(over="ignore"):
            for at in range(0, len(flat), _CHUNK):
                values[at : at + _CHUNK] = self._parse_number_chunk(flat[at : at + _CHUNK])
        return values.reshape(tokens.shape)

    def _parse_number_chunk(self, tokens: Indices) -> Array:
        start, end = np.take(self.starts, tokens), np.take(self.ends, tokens)
        lead = np.take(self.bytes, start)
        begin = start + ((lead == 43) | (lead == 45))
        power, stop = self._parse_exponents(begin, end)
        dot = self._find_byte(46, begin, stop)
        whole, fraction = dot - begin, np.maximum(stop - dot - 1, 0)
        high, usual = self._parse_digits(dot, np.minimum(whole, 8))
        digits, good = self._parse_digits(stop, np.minimum(fraction, 8))
        usual &= good & (whole <= 8) & (whole + fraction >= 1)
        if (fraction > 8).any():
            middle, good = self._parse_digits(stop - 8, np.clip(fraction - 8, 0, 8))
            upper, fine = self._parse_digits(stop - 16, np.clip(fraction - 16, 0, 8))
            digits += middle * _WHOLE_TENS[8] + upper * _WHOLE_TENS[16]
            # Nineteen digits fit into the word.
            usual &= good & fine & (fraction <= 24) & (upper < 1000) & ((high == 0) | (whole + fraction <= 19))
        digits += high * np.take(_WHOLE_TENS, fraction, mode="clip")
        power -= fraction
        size = np.abs(power)
        usual &= size < len(_TENS)
        tens = np.take(_TENS, size, mode="clip")
        values: Array = digits.astype(np.float64)
        values = np.where(power < 0, values / tens, values * tens)
        np.negative(values, out=values, where=lead == 45)
        index: int
        for index in np.flatnonzero(~usual).tolist():
            try:
                values[index] = float(self._data[start[index] : end[index]])
            except ValueError:
                raise BadTokenError(int(tokens[index])) from None
        return values

    def parse_indices(self, tokens: Indices) -> Indices:
        """Return the whole numbers with which tokens begin, up to their first slash, in the shape of ``tokens``.

        :raises BadTokenError: when one does not begin with a whole number.
        """
        flat = tokens.ravel()
        values = np.empty(len(flat), dtype=np.int64)
        for at in range(0, len(flat), _CHUNK):
            values[at : at + _CHUNK] = self._parse_index_chunk(flat[at : at + _CHUNK])
        return values.reshape(tokens.shape)

    def _parse_index_chunk(self, tokens: Indices) -> Indices:
        start, end = np.take(self.starts, tokens), np.take(self.ends, tokens)
        lead = np.take(self.bytes, start)
        begin = start + ((lead == 43) | (lead == 45))
        stop = self._find_byte(47, begin, end)
        length = stop - begin
        values, good = self._parse_digits(stop, np.minimum(length, 8))
        good &= (length >= 1) & (length <= 16)
        if (length > 8).any():
            high, fine = self._parse_digits(stop - 8, np.clip(length - 8, 0, 8))
            values += high * _WHOLE_TENS[8]
            good &= fine
        if not good.all():
            raise BadTokenError(int(tokens[np.argmin(good)]))
        indices = values.view(np.int64)
        np.negative(indices, out=indices, where=lead == 45)
        return indices

    def _find_byte(self, byte: int, begin: Indices, end: Indices) -> Indices:
        """Find the first position of a byte in each span, or the span's end."""
        if byte not in self._places:
            self._places[byte] = find_places(len(self.bytes), lambda block: self.bytes[block] == byte)
        places = self._places[byte]
        if not len(places):
            return end
        following = np.take(places, np.searchsorted(places, begin), mode="clip")
        return np.where((following >= begin) & (following < end), following, end)

    def _parse_exponents(self, begin: Indices, end: Indices) -> tuple[Indices, Indices]:
        """Return the power of ten with which each token ends, and where the digits before it stop. Powers have up to three
        digits; longer ones stay in the token, which is then not a number."""
        power, stop = np.zeros(len(end), dtype=np.int64), end.copy()
        for back in (5, 4, 3, 2):
            here = np.flatnonzero((np.take(self.bytes, end - back) | 32 == 101) & (end - back > begin))
            if not len(here):
                continue
            mark = end[here] - back
            sign = np.take(self.bytes, mark + 1)
            length = back - 1 - ((sign == 43) | (sign == 45))
            digits, good = self._parse_digits(end[here], length)
            good &= length > 0
            power[here[good]] = np.where(sign == 45, -1, 1)[good] * digits.view(np.int64)[good]
            stop[here[good]] = mark[good]
        return power, stop

    def _parse_digits(self, end: Indices, count: Indices) -> tuple[Words, Bools]:
        """Return the number that the ``count`` (0 to 8) bytes before ``end`` spell, and whether all of them are digits."""
        word = self._words[end - 8]
        word ^= _ZEROS
        word &= np.take(_LAST, count)
        good = ((word + _PAST_NINE) | word) & _HIGH_BITS == 0
        # Pairs of digits, then fours, then all eight, each at the position of the first of them.
        word = word * np.uint64(10) + (word >> np.uint64(8))
        pairs = np.uint64(0x000000FF000000FF)
        upper = (word & pairs) * np.uint64(100 + (1_000_000 << 32))
        lower = ((word >> np.uint64(16)) & pairs) * np.uint64(1 + (10_000 << 32))
        return (upper + lower) >> np.uint64(32), good
