"""Mutations of text by lines, words and numbers, and of bytes, that know nothing of a format."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from random import Random

from fuzz import nasty

_NUMBER = re.compile(rb"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_WORD = re.compile(rb"[A-Za-z_][A-Za-z_0-9]*")
_STRING = re.compile(rb"'[^'\n]*'|\"[^\"\n]*\"")
_ENCODING = re.compile(rb"encoding\s*=\s*[\"'][^\"']*[\"']")


def utf8(text: str) -> bytes:
    """A text as bytes; what Unicode does not allow stays in it."""
    return text.encode("utf-8", "surrogatepass")


def some(rng: Random) -> int:
    """How many mutations one input gets."""
    return rng.choice((1, 1, 1, 1, 2, 2, 3, 5, 9))


def mutated(data: bytes, rng: Random, others: Sequence[bytes], kinds: Sequence[Callable[..., bytes]]) -> bytes:
    """The bytes after some mutations of these kinds; ``others`` are what may be spliced in."""
    for _ in range(some(rng)):
        data = rng.choice(kinds)(data, rng, others)
    return data


def truncate(data: bytes, rng: Random, _others: Sequence[bytes]) -> bytes:
    return data[: rng.randint(0, len(data))]


def splice(data: bytes, rng: Random, others: Sequence[bytes]) -> bytes:
    other = rng.choice(others)
    return data[: rng.randint(0, len(data))] + other[rng.randint(0, len(other)) :]


def flip(data: bytes, rng: Random, _others: Sequence[bytes]) -> bytes:
    changed = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 8)) if data else 0):
        at = rng.randrange(len(changed))
        changed[at] = rng.choice((changed[at] ^ (1 << rng.randrange(8)), rng.randrange(256), 0, 255))
    return bytes(changed)


def repeat(data: bytes, rng: Random, _others: Sequence[bytes]) -> bytes:
    begin, length = rng.randint(0, len(data)), rng.choice((1, 10, 100, 1000))
    block = data[begin : begin + length]
    return data[:begin] + block * rng.choice((2, 2, 3, 20)) + data[begin + length :]


def remove(data: bytes, rng: Random, _others: Sequence[bytes]) -> bytes:
    begin = rng.randint(0, len(data))
    return data[:begin] + data[begin + rng.choice((1, 2, 4, 50, 300)) :]


def insert(data: bytes, rng: Random, _others: Sequence[bytes]) -> bytes:
    at = rng.randint(0, len(data))
    return data[:at] + utf8(rng.choice((*nasty.TEXTS, *nasty.NAMES))) + data[at:]


def number(data: bytes, rng: Random, _others: Sequence[bytes]) -> bytes:
    """Another number in the place of one."""
    return _instead(_NUMBER, data, rng, utf8(rng.choice(nasty.NUMBERS)))


def word(data: bytes, rng: Random, _others: Sequence[bytes]) -> bytes:
    """A nasty name, or another word of the same text, in the place of a word."""
    words = _WORD.findall(data) or [b""]
    return _instead(_WORD, data, rng, rng.choice((utf8(rng.choice(nasty.NAMES)), rng.choice(words))))


def string(data: bytes, rng: Random, _others: Sequence[bytes]) -> bytes:
    """Other text between quotes."""
    text = rng.choice((rng.choice(nasty.NAMES), rng.choice(nasty.PATHS), rng.choice(nasty.NUMBERS)))
    quote = rng.choice(("'", '"'))
    return _instead(_STRING, data, rng, utf8(f"{quote}{text}{quote}"))


def line(data: bytes, rng: Random, others: Sequence[bytes]) -> bytes:
    """A line dropped, doubled, moved, indented, cut, or taken from another text."""
    lines = data.split(b"\n")
    at, to = rng.randrange(len(lines)), rng.randrange(len(lines))
    kind = rng.randrange(6)
    if kind == 0:
        del lines[at]
    elif kind == 1:
        lines.insert(to, lines[at])
    elif kind == 2:
        lines[at], lines[to] = lines[to], lines[at]
    elif kind == 3:
        lines[at] = rng.choice((b" ", b"\t", b"    ", b"- ", b"#")) + lines[at]
    elif kind == 4:
        lines[at] = lines[at][: rng.randint(0, len(lines[at]))]
    else:
        lines.insert(at, rng.choice(rng.choice(others).split(b"\n")))
    return b"\n".join(lines)


def line_ends(data: bytes, rng: Random, _others: Sequence[bytes]) -> bytes:
    return data.replace(b"\n", rng.choice((b"\r\n", b"\r", b"\n\n", b"\n\r", b" ", b"\x0b", utf8("\u2028"))))


def encoding(data: bytes, rng: Random, _others: Sequence[bytes]) -> bytes:
    """Another declaration of the encoding, another encoding, or a byte order mark."""
    kind = rng.randrange(4)
    if kind == 0:
        name = rng.choice(nasty.ENCODINGS).encode()
        if _ENCODING.search(data):
            return _ENCODING.sub(b'encoding="' + name + b'"', data, count=1)
        return b'<?xml version="1.0" encoding="' + name + b'"?>\n' + re.sub(rb"^\s*<\?xml[^>]*\?>", b"", data)
    if kind == 1:
        marks = (
            b"\xef\xbb\xbf",
            b"\xff\xfe",
            b"\xfe\xff",
            b"\xff\xfe\0\0",
            b"\0\0\xfe\xff",
            b"\xef\xbb",
            b"\n",
            b" ",
            b"\0",
        )
        return rng.choice(marks) + data
    text = data.decode("utf-8", "replace")
    name = rng.choice(
        ("utf-16", "utf-16-le", "utf-16-be", "utf-32", "utf-8-sig", "latin-1", "cp1252", "utf-7", "cp037")
    )
    declared = _ENCODING.sub(b'encoding="' + name.encode() + b'"', data, count=1).decode("utf-8", "replace")
    return (declared if kind == 2 else text).encode(name, "replace")


def _instead(pattern: re.Pattern[bytes], data: bytes, rng: Random, new: bytes) -> bytes:
    found = list(pattern.finditer(data))
    if not found:
        return data + new
    match = rng.choice(found)
    return data[: match.start()] + new + data[match.end() :]


BYTES = (truncate, splice, flip, flip, repeat, remove, insert)
TEXT = (*BYTES, number, number, number, word, line, line, line_ends)
CODE = (*TEXT, string, string, line, word)
XML = (*BYTES, number, word, string, line, line_ends, encoding, encoding)
