"""New numbers in the notation of the old ones."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from urdfcheck.model.repairs.number_text import keep_notation, write_number, write_numbers


@pytest.mark.parametrize(
    ("typed", "text", "written"),
    [
        # The sign alone, in every notation.
        ("-6.37789906117123E-09", "0.00000000637789906117123", "6.37789906117123E-09"),
        ("6.4e-09", "-0.0000000064", "-6.4e-09"),
        ("+0.50", "-0.5", "-0.50"),
        ("-.5", "0.5", ".5"),
        ("0.00005200000", "-5.2e-05", "-0.00005200000"),
        # Equal numbers are the author's.
        ("0.50  1e0", "0.5 1.0", "0.50  1e0"),
        # Another number: exponents stay exponents, with their letter, sign and width.
        ("6.4e-09", "0.0000000032", "3.2e-09"),
        ("6.4E-9", "1.25e-08", "1.25E-8"),
        ("6.4E+09", "1.25e+10", "1.25E+10"),
        ("6.4e9", "12500000000", "1.25e10"),
        ("6.4e-09", "0.25", "0.25"),
        # Decimal fractions stay such, with the zeros at their end.
        ("0.0001", "2.5e-05", "0.000025"),
        ("0.50", "0.8", "0.80"),
        ("1.0", "2", "2.0"),
        ("0.00011500000", "0.000123", "0.000123"),
        ("2", "3", "3"),
        ("1", "2.5e-09", "2.5e-09"),
        ("0", "2.5e-05", "2.5e-05"),
        # Blanks stay.
        (" 0   0\t1 ", "0 0 -1", " 0   0\t-1 "),
        # What is not a number, or another number of them, is written as it is.
        ("${pi} 0 0", "1 0 0", "1 0 0"),
        ("0 0", "1 0 0", "1 0 0"),
        ("", "1 0 0", "1 0 0"),
        ("nan", "1", "1"),
    ],
)
def test_the_notation_stays(typed: str, text: str, written: str) -> None:
    assert keep_notation(typed, text) == written


@pytest.mark.parametrize(
    ("typed", "value", "written"),
    [
        ("-6.37789906117123E-09", 6.37789906117123e-09, "6.37789906117123E-09"),
        ("1.2E-03", 1.2e-6, "1.2E-06"),
        ("0.70337", 0.0327298123, "0.0327298"),
        ("7.95654166667e-05", 2.836881234e-05, "2.83688e-05"),
        ("0.5", 0.0, "0"),
        # The rounding error of a computation goes with the old power, and stays where only the sign changes.
        ("3.7500000000000003e-06", 3.75e-05, "3.75e-05"),
        ("0.00021782749999999998", -0.0002178275, "-0.00021782749999999998"),
        ("3.7500000000000003e-05", 3.75e-05, "3.7500000000000003e-05"),
        ("0.123456789012345678", -0.123456789012345678, "-0.123456789012345678"),
        ("", 0.25, "0.25"),
    ],
)
def test_a_number_keeps_its_digits_where_only_sign_or_power_change(typed: str, value: float, written: str) -> None:
    assert write_number(typed, value) == written


def test_a_triple_keeps_what_does_not_change() -> None:
    typed = "-6.37789906117123E-09  0.1000000000000001 0.20"
    assert write_numbers(typed, [-6.377899061e-09, -0.1, 0.2], digits=10) == (
        "-6.37789906117123E-09  -0.1000000000000001 0.20"
    )
    assert write_numbers("0.1 0.25 3", [0.25, 0.1, 3]) == "0.25 0.1 3", "numbers that changed places"


NUMBERS = st.floats(-1e12, 1e12).map(repr) | st.floats(-1, 1).map(lambda v: f"{v:.6e}") | st.integers(-99, 99).map(str)


@given(st.lists(st.tuples(NUMBERS, NUMBERS), min_size=1, max_size=4))
def test_the_value_is_what_was_asked_for(pairs: list[tuple[str, str]]) -> None:
    typed, wanted = (" ".join(words) for words in zip(*pairs, strict=True))
    assert list(map(float, keep_notation(typed, wanted).split())) == list(map(float, wanted.split()))
