"""Positions in the units of an editor, and places in a text that was edited."""

from __future__ import annotations

import random

import pytest
from lsprotocol import types

from urdfcheck.server.documents import DocumentStore, TextPositions, TextShift, find_word

ENCODINGS = {
    types.PositionEncodingKind.Utf8: "utf-8",
    types.PositionEncodingKind.Utf16: "utf-16-le",
    types.PositionEncodingKind.Utf32: "utf-32-le",
}
UNITS = {"utf-8": 1, "utf-16-le": 2, "utf-32-le": 4}


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_offsets_and_positions_are_inverse(encoding: types.PositionEncodingKind) -> None:
    text = "a\r\né🤖b\rc\n\u2028x\n"
    positions = TextPositions(text, encoding)
    codec = ENCODINGS[encoding]
    lines = ["a\r\n", "é🤖b\r", "c\n", "\u2028x\n", ""]
    for offset in (0, 1, 3, 4, 5, 6, 7, 8, 9, 10, 11, len(text)):
        at = positions.find_position(offset)
        before = text[:offset]
        start = len("".join(lines[: at.line]))
        assert start <= offset <= start + len(lines[at.line])
        assert at.character == len(before[start:].encode(codec)) // UNITS[codec]
        assert positions.find_offset(at) == offset


def test_a_position_beyond_the_text_is_its_nearest() -> None:
    positions = TextPositions("ab\r\ncd")
    assert positions.find_offset(types.Position(0, 99)) == 2
    assert positions.find_offset(types.Position(9, 9)) == 6
    assert positions.find_position(99) == types.Position(1, 2)


def test_places_move_with_the_text_around_them() -> None:
    """Any single edit: what is moved reads the same, and what was edited is not moved."""
    chance = random.Random(1)
    for _ in range(300):
        old = "".join(chance.choice("ab🤖\n") for _ in range(chance.randrange(30)))
        first = chance.randrange(len(old) + 1)
        last = min(len(old), first + chance.randrange(4))
        new = old[:first] + "".join(chance.choice("abc") for _ in range(chance.randrange(4))) + old[last:]
        shift = TextShift(old, new)
        for start in range(len(old)):
            for end in range(start, min(len(old), start + 3)):
                moved = shift.move(start, end)
                if moved is not None:
                    assert new[slice(*moved)] == old[start:end]
                    assert moved[0] - start in {0, len(new) - len(old)}
                elif old == new:
                    pytest.fail("nothing was edited")


def test_the_text_beside_an_edit_counts_as_edited() -> None:
    """0.1 that becomes 0.12 is another number."""
    assert TextShift('value="0.1"', 'value="0.12"').move(7, 10) is None
    assert TextShift('value="0.1" ', 'value="0.1"  ').move(7, 10) == (7, 10)


@pytest.mark.parametrize(
    ("text", "data"),
    [
        ("<robot/>é", "<robot/>é".encode()),
        ('<?xml version="1.0" encoding="latin-1"?>é', '<?xml version="1.0" encoding="latin-1"?>é'.encode("latin-1")),
        ('<?xml version="1.0" encoding="ascii"?>é', '<?xml version="1.0" encoding="ascii"?>é'.encode()),
        ('<?xml version="1.0" encoding="nonsense"?>é', '<?xml version="1.0" encoding="nonsense"?>é'.encode()),
    ],
)
def test_a_text_is_encoded_as_it_declares(text: str, data: bytes) -> None:
    document = DocumentStore().open("file:///tmp/r.urdf", text, 1)
    assert document is not None
    assert document.encode() == data


def test_a_document_without_a_file_is_left_alone() -> None:
    assert DocumentStore().open("untitled:Untitled-1", "<robot/>", 1) is None


def test_the_word_around_an_offset() -> None:
    assert find_word("a ${mass_2}", 6) == ("ma", "ss_2")
    assert find_word("", 0) == ("", "")
