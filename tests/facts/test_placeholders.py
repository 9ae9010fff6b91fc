"""Tensors that were typed and not computed."""

from __future__ import annotations

import pytest

from urdfcheck.facts.inertials.placeholders import describe_placeholder, is_round


@pytest.mark.parametrize(
    ("mass", "moments", "what"),
    [
        (1, (1, 1, 1), "1 × identity"),
        (0.05, (0.001, 0.001, 0.001), "0.001 × identity"),
        (3, (0.2, 0.2, 0.2), "0.2 × identity"),
        (0.1, (5e-05, 5e-05, 5e-05), "5e-05 × identity"),
        (0.001, (1e-4, 1e-6, 1e-4), "powers of ten (0.0001, 1e-06, 0.0001)"),
        (1, (0.3, 0.3, 0.3), "0.3 × identity"),
        (1, (0.0015, 0.0015, 0.0015), "0.0015 × identity"),
        (1, (0.111, 0.111, 0.111), None),
        (1, (0.1, 0.1, 0.2), None),
        (1, (0, 0, 0), None),
        (1, (-1, -1, -1), None),
        (1, (1e-13, 1e-13, 1e-13), None),  # a point
        (0, (1, 1, 1), None),
        (float("nan"), (1, 1, 1), None),
        (1, (1e-3 * (1 + 1e-15), 1e-3, 1e-3), "powers of ten (0.001, 0.001, 0.001)"),
    ],
)
def test_round_diagonals(mass: float, moments: tuple[float, float, float], what: str | None) -> None:
    x, y, z = moments
    assert describe_placeholder(mass, (x, 0, 0, y, 0, z)) == what


def test_a_product_of_inertia_was_computed() -> None:
    assert describe_placeholder(1, (1, 1e-9, 0, 1, 0, 1)) is None


@pytest.mark.parametrize(
    ("value", "round_"), [(1, True), (0.05, True), (200, True), (0.1 + 0.2 - 0.1, True), (3, False), (1.5, False)]
)
def test_round_numbers_have_one_digit(value: float, round_: bool) -> None:
    assert is_round(value) == round_
