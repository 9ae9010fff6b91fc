"""The memo of a model: a fact is computed once, its failure as well, and never an iterator."""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from typing import Any

import pytest

from urdfcheck.core import FactUnavailableError
from urdfcheck.model.fact import fact


class Remembering:
    def __init__(self) -> None:
        self.memo: dict[Hashable, Any] = {}
        self.computed: list[object] = []


@fact
def double(model: Remembering, number: int = 1, *, offset: int = 0) -> int:
    """Twice a number."""
    model.computed.append((number, offset))
    return 2 * number + offset


@fact
def missing(model: Remembering) -> int:
    model.computed.append("missing")
    raise FactUnavailableError("the tree is broken")


@fact
def numbers(model: Remembering) -> Iterator[int]:
    return iter((1,))


def test_a_fact_is_computed_once_for_each_set_of_arguments() -> None:
    model = Remembering()
    assert [double(model, 2), double(model, 2), double(model, 3), double(model, 2, offset=1)] == [4, 4, 6, 5]
    assert model.computed == [(2, 0), (3, 0), (2, 1)]


def test_two_models_share_nothing() -> None:
    one, other = Remembering(), Remembering()
    double(one)
    double(other)
    assert one.computed == other.computed == [(1, 0)]


def test_a_fact_that_is_not_available_is_not_computed_again() -> None:
    model = Remembering()
    for _ in range(3):
        with pytest.raises(FactUnavailableError, match="the tree is broken"):
            missing(model)
    assert model.computed == ["missing"]


def test_an_iterator_is_refused_because_its_second_reader_would_find_nothing() -> None:
    with pytest.raises(TypeError, match="numbers is an iterator"):
        numbers(Remembering())


def test_a_generator_is_refused_before_it_is_called() -> None:
    def yielded(model: Remembering) -> Iterator[int]:
        yield 1

    with pytest.raises(TypeError, match="yielded is a generator"):
        fact(yielded)


def test_a_fact_keeps_its_name_and_docstring() -> None:
    assert (double.__name__, double.__doc__) == ("double", "Twice a number.")
