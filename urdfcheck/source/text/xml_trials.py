"""Repairs of broken XML that are tried: what still breaks at the same place is not proposed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any
from xml.parsers import expat

# Each way is parsed as a whole. A larger file than any robot's is not parsed again.
_LARGEST = 5_000_000


class _DocumentTypeError(Exception):
    """A document type begins, which is not read."""


def choose_working_repairs(text: str, at: int, ways: Sequence[tuple[str, str]]) -> list[str]:
    """Return the words of the repairs with which a text parses; if there are none, of those with which more of it parses.

    :param at: where the text as it is breaks.
    :param ways: the words of each repair, and the text with it.
    """
    if len(text) > _LARGEST:
        return [words for words, _ in ways]
    # What is behind the mistake is the same in all texts.
    left = [(words, len(split_where_it_breaks(edited)[1])) for words, edited in ways]
    whole = [words for words, count in left if count == 0]
    return whole or [words for words, count in left if count < len(text) - at]


def split_where_it_breaks(text: str) -> tuple[str, str]:
    """Return what parses of a text and the rest, which is empty if all does. A rest that begins at the end is a line break."""
    data = text.encode("utf-8", "surrogatepass")
    parser = expat.ParserCreate(encoding="utf-8")
    parser.StartDoctypeDeclHandler = _refuse_doctype
    try:
        parser.Parse(data, True)
    except expat.ExpatError:
        at = max(parser.ErrorByteIndex, 0)
    except _DocumentTypeError:
        at = parser.CurrentByteIndex
    else:
        return text, ""
    return data[:at].decode("utf-8", "replace"), data[at:].decode("utf-8", "replace") or "\n"


def _refuse_doctype(*_: Any) -> None:
    raise _DocumentTypeError
