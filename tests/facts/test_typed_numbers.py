"""Which typed numbers are constants with digits missing, and which are left alone."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from urdfcheck.facts.likeness.typed_numbers import (
    find_constant,
    find_near_miss,
    flag_noise_products,
    is_noise_angle,
    is_noise_length,
)

CONSTANTS = {
    "pi": math.pi,
    "pi/2": math.pi / 2,
    "3*pi/2": 3 * math.pi / 2,
    "2*pi": 2 * math.pi,
    "pi/3": math.pi / 3,
    "2*pi/3": 2 * math.pi / 3,
    "pi/4": math.pi / 4,
    "3*pi/4": 3 * math.pi / 4,
    "pi/6": math.pi / 6,
    "5*pi/6": 5 * math.pi / 6,
    "pi/8": math.pi / 8,
    "pi/12": math.pi / 12,
}


@pytest.mark.parametrize(
    ("text", "constant"),
    [
        ("3.14", "pi"),
        ("3.1416", "pi"),
        ("3.14159", "pi"),
        ("3.1415", "pi"),
        ("3.1415926", "pi"),
        ("-3.1416", "-pi"),
        ("1.57", "pi/2"),
        ("+1.5708", "pi/2"),
        (" -1.5708 ", "-pi/2"),
        ("1.5707", "pi/2"),
        ("1.570000", "pi/2"),
        ("1.5708e0", "pi/2"),
        ("15708e-4", "pi/2"),
        ("1.57075", "pi/2"),
        ("4.71", "3*pi/2"),
        ("6.2832", "2*pi"),
        ("0.785", "pi/4"),
        ("0.7854", "pi/4"),
        ("-2.356", "-3*pi/4"),
        ("1.047", "pi/3"),
        ("0.524", "pi/6"),
        ("0.3927", "pi/8"),
        ("0.2618", "pi/12"),
    ],
)
def test_shortened_constants_are_named_with_their_sign(text: str, constant: str) -> None:
    found = find_near_miss(text)
    assert found is not None
    assert found.constant == constant
    assert found.expression == f"${{{constant}}}"
    assert found.exact == math.copysign(CONSTANTS[constant.lstrip("-")], float(text))
    assert found.difference == float(text) - found.exact


@pytest.mark.parametrize(
    "text",
    [
        *(
            "0",
            "0.0",
            "-0",
            "1.0",
            "3",
            "3.1",
            "1.5",
            "1.6",
            "0.25",
            "0.52",
            "0.79",
            "0.78",
            "0.27931",
            "0.26",
            "0.393",
        ),
        *("3.15", "1.58", "1.56", "4.72", "6.3", "0.787", "1.05", "2.1", "2.35", "0.0314", "31.416", "-0.75239"),
        *("nan", "inf", "", "abc", "1e400", "1e-400", "${pi}", "1,57"),
    ],
)
def test_ordinary_numbers_and_other_text_are_left_alone(text: str) -> None:
    assert find_near_miss(text) is None


@pytest.mark.parametrize("name", CONSTANTS)
@pytest.mark.parametrize("spell", [repr, "{:.15g}".format, "{:.12g}".format, "{:.10g}".format])
def test_full_digits_are_exact_and_no_near_miss(name: str, spell: object) -> None:
    text = spell(CONSTANTS[name])  # type: ignore[operator]
    assert find_near_miss(text) is None
    assert find_constant(float(text)) == name
    assert find_constant(-float(text)) == name


@pytest.mark.parametrize("angle", [3.1416, 1.57, 0.785, 0.0, 1.0, math.inf, math.nan])
def test_shortened_and_other_numbers_are_not_exact(angle: float) -> None:
    assert find_constant(angle) is None


@given(st.sampled_from(sorted(CONSTANTS)), st.integers(4, 7), st.booleans())
def test_rounding_to_four_decimals_or_more_is_recognised(name: str, decimals: int, negative: bool) -> None:
    text = f"{CONSTANTS[name]:.{decimals}f}"
    found = find_near_miss("-" + text if negative else text)

    assert found is not None
    assert found.constant == ("-" if negative else "") + name
    assert abs(found.difference) <= 0.5 * 10.0**-decimals + 1e-15
    assert found.decimals <= decimals


@given(st.floats(-7, 7))
def test_what_is_found_is_close_to_what_it_is_said_to_be(value: float) -> None:
    found = find_near_miss(f"{value:.3f}")
    # 6.280 is 2 pi truncated to the two decimals that it has.
    assert found is None or abs(found.difference) < max(2e-3, 10.0**-found.decimals)


@pytest.mark.parametrize(
    ("value", "noise"), [(0.0, False), (-1e-18, True), (9e-10, True), (2e-9, False), (1e-5, False)]
)
def test_noise_is_what_lies_below_a_nanometre_or_nanoradian(value: float, noise: bool) -> None:
    assert is_noise_length(value) is noise
    assert is_noise_angle(value) is noise


def test_products_of_inertia_are_noise_relative_to_the_largest_moment() -> None:
    assert flag_noise_products((-4.2e-22, 0.0, -3.5e-9), 1.27e-5) == (True, False, False)
