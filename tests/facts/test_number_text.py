"""Numbers of text formats are those that ``float`` reads."""

from __future__ import annotations

import math
import tracemalloc

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from urdfcheck.facts.mesh.decode import decode_mesh
from urdfcheck.facts.mesh.formats import number_text
from urdfcheck.facts.mesh.formats.number_text import BadTokenError, TokenizedText


def read(*tokens: str) -> list[float]:
    return TokenizedText(" ".join(tokens).encode()).parse_numbers(np.arange(len(tokens))).tolist()


@given(st.integers(-(10**15) + 1, 10**15 - 1), st.integers(0, 15), st.integers(-6, 6), st.sampled_from("eE"))
def test_up_to_fifteen_digits_are_rounded_as_float_does(digits: int, places: int, power: int, mark: str) -> None:
    plain = f"{abs(digits):0{places + 1}d}"
    number = "-" * (digits < 0) + plain[: len(plain) - places] + "." + plain[len(plain) - places :]
    assert read(number, f"{number}{mark}{power:+03d}") == [float(number), float(f"{number}e{power}")]


@given(st.floats(allow_nan=False, allow_infinity=False), st.sampled_from(("r", ".17g", ".17e", ".9f", ".6e", "g")))
def test_any_other_is_right_to_two_units_in_the_last_place(value: float, style: str) -> None:
    text = repr(value) if style == "r" else format(value, style)
    expected = float(text)
    (found,) = read(text)
    assert abs(found - expected) <= 2 * math.ulp(expected)


@pytest.mark.parametrize(
    "token",
    ["5", "+5", "-0.0", "5.", ".5", "-.5e1", "1e5", "1E-300", "1e+010", "4.9e-324", "9" * 30, "inf", "-Infinity"],
)
def test_every_usual_and_unusual_way_to_write_a_number(token: str) -> None:
    assert read("1", token, "2.5") == [1.0, float(token), 2.5]


@pytest.mark.parametrize(
    "token", ["1.2.3", "1e", "e5", "--1", "1-2", "abc", "1,5", ".", "-", "1e5.0", "0x10", "1e+", "1/2", "½"]
)
def test_what_is_no_number_is_named(token: str) -> None:
    text = TokenizedText(f"1.0\n 2 {token} 3\n".encode())
    with pytest.raises(BadTokenError) as bad:
        text.parse_numbers(np.arange(4))
    assert text.locate_token(bad.value.index) == (2, f"2 {token} 3")


def test_whole_numbers_end_at_a_slash() -> None:
    text = TokenizedText(b"12/3/4 -7//2 1234567890123 +5")
    assert text.parse_indices(np.arange(4)).tolist() == [12, -7, 1234567890123, 5]
    for bad in (b"1.5", b"/2", b"12x", b"-"):
        with pytest.raises(BadTokenError):
            TokenizedText(b"1 " + bad).parse_indices(np.arange(2))


def test_lines_and_words() -> None:
    text = TokenizedText(b"\r\n  v 1 2\r\nVN 3\n\n\nf 4")
    assert text.find_line_starts().tolist() == [0, 3, 5]
    assert text.match_word(b"vn").tolist() == [False, False, False, True, False, False, False]
    assert text.match_word(b"v").tolist() == [True, *[False] * 6]


@pytest.mark.parametrize("block", [1, 2, 7, 1000])
def test_positions_do_not_depend_on_the_blocks(monkeypatch: pytest.MonkeyPatch, block: int) -> None:
    data = b"v 1.5 -2.25 3.e2\n\n  f 1/2 2//3\t3 \nlong_word_here 0.125"
    whole = TokenizedText(data)
    monkeypatch.setattr(number_text, "_BLOCK", block)
    text = TokenizedText(data)
    assert text.starts.tolist() == whole.starts.tolist()
    assert [text.get_token(index) for index in range(len(text))] == data.split()
    assert text.parse_numbers(np.array([1, 2, 3])).tolist() == [1.5, -2.25, 300.0]
    assert text.parse_indices(np.array([5, 6, 7])).tolist() == [1, 2, 3]


def test_words_are_found_among_some_tokens() -> None:
    text = TokenizedText(b"v 1 2 3\nf v v V\n")
    lines = text.find_line_starts()
    assert text.match_word(b"v", lines).tolist() == [True, False]
    assert np.flatnonzero(text.match_word(b"v")).tolist() == [0, 5, 6, 7]


@pytest.mark.parametrize("kind", ["obj", "off"])
def test_memory_is_a_small_multiple_of_the_file(kind: str) -> None:
    mesh = trimesh.creation.icosphere(subdivisions=6)
    data = mesh.export(file_type=kind).encode()
    decode_mesh(data, kind)
    tracemalloc.start()
    decoded = decode_mesh(data, kind)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert decoded.n_triangles == len(mesh.faces)
    assert peak < 5.5 * len(data)
