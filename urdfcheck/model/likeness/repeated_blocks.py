"""What really varies between blocks that were typed one by one, number by number: the parameters of their macro."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from urdfcheck.facts.likeness.typed_numbers import near_miss
from urdfcheck.source.text.values import number

# Angles closer than this are one angle: 1.57 is off by 8e-4.
_LIKE = 1e-3
# Of three blocks, two against one are no majority.
_MAJORITY = 4


@dataclass(frozen=True, slots=True)
class Column:
    """One number of an attribute, over all blocks. ``leads``: it is a coordinate of a place, and tells blocks apart by itself."""

    name: str
    words: tuple[str, ...]
    leads: bool
    angle: bool


@dataclass(frozen=True, slots=True)
class Variation:
    """``parameters``: the columns that need one, with the first block's word. ``derived``: name and xacro expression of
    columns that follow from a parameter. ``lone``: columns in which one block alone differs, its place, and the others' word."""

    parameters: tuple[Column, ...]
    derived: tuple[tuple[str, str], ...]
    lone: tuple[tuple[Column, int, str], ...]


def variation(columns: Sequence[Column]) -> Variation:
    """What of some columns has to be a parameter of the blocks' macro, in the order given."""
    parameters: list[Column] = []
    followers: list[Column] = []
    lone: list[tuple[Column, int, str]] = []
    for column in columns:
        classes = _classes(column)
        if len(classes) == 1:
            continue
        single = _single(column, classes)
        if single is not None:
            lone.append((column, single, next(column.words[c[0]] for c in classes if single not in c)))
        elif column.leads or not _halves(classes):
            parameters.append(column)
        else:
            followers.append(column)
    derived = []
    for column in followers:
        expression = next((e for p in parameters if (e := _from(p, column)) is not None), None)
        if expression is None:
            parameters.append(column)
        else:
            derived.append((column.name, expression))
    return Variation(tuple(parameters), tuple(derived), tuple(lone))


def _classes(column: Column) -> list[list[int]]:
    """The blocks that have one value, as their places."""
    classes: list[list[int]] = []
    for place, word in enumerate(column.words):
        known = next((c for c in classes if _equal(column, column.words[c[0]], word)), None)
        if known is None:
            classes.append([place])
        else:
            known.append(place)
    return classes


def _equal(column: Column, one: str, other: str) -> bool:
    a, b = number(one), number(other)
    if a is None or b is None:
        return one == other
    return math.isclose(a, b, rel_tol=1e-6, abs_tol=_LIKE if column.angle else 1e-12)


def _single(column: Column, classes: Sequence[Sequence[int]]) -> int | None:
    """The block whose number differs from that of all others; a mirrored one is no exception but the other side."""
    if len(classes) != 2 or len(column.words) < _MAJORITY:
        return None
    few, many = sorted(classes, key=len)
    a, b = number(column.words[few[0]]), number(column.words[many[0]])
    if len(few) != 1 or a is None or b is None or math.isclose(a, -b, rel_tol=1e-3):
        return None
    return few[0]


def _halves(classes: Sequence[Sequence[int]]) -> bool:
    """Two groups of at least two blocks: that a parameter splits the blocks alike is then no coincidence."""
    return len(classes) == 2 and all(len(c) > 1 for c in classes)


def _from(parameter: Column, column: Column) -> str | None:
    """``${0 if y > 0 else pi}`` where the sign of a parameter decides which of two values a column has."""
    values = [number(word) for word in parameter.words]
    above, below = ([i for i, v in enumerate(values) if v is not None and v * sign > 0] for sign in (1, -1))
    if len(above) + len(below) != len(values) or sorted(map(sorted, _classes(column))) != sorted([above, below]):
        return None
    one, other = (_written([column.words[i] for i in places]) for places in (above, below))
    return f"${{{one} if {parameter.name} > 0 else {other}}}"


def _written(words: Sequence[str]) -> str:
    """One value as an expression writes it: a fraction of π by name where one block rounds it."""
    near = next((miss for word in words if (miss := near_miss(word)) is not None), None)
    return min(words, key=len) if near is None else near.expression.removeprefix("${").removesuffix("}")
