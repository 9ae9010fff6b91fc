"""What really varies between blocks that were typed one by one, number by number: the parameters of their macro."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from urdfcheck.facts.likeness.typed_numbers import find_near_miss
from urdfcheck.source.text.values import parse_number

# Angles closer than this are one angle: 1.57 is off by 8e-4.
_LIKE = 1e-3
# Of three blocks, two against one are no majority.
_MAJORITY = 4


@dataclass(frozen=True, slots=True)
class NumberColumn:
    """One number of an attribute, over all blocks. ``leads``: it is a coordinate of a place, and tells blocks apart by itself."""

    name: str
    words: tuple[str, ...]
    is_coordinate: bool
    is_angle: bool


@dataclass(frozen=True, slots=True)
class Variation:
    """``parameters``: the columns that need one, with the first block's word. ``derived``: name and xacro expression of
    columns that follow from a parameter. ``lone``: columns in which one block alone differs, its place, and the others' word."""

    parameters: tuple[NumberColumn, ...]
    derived: tuple[tuple[str, str], ...]
    outliers: tuple[tuple[NumberColumn, int, str], ...]


def classify_columns(columns: Sequence[NumberColumn]) -> Variation:
    """What of some columns has to be a parameter of the blocks' macro, in the order given."""
    parameters: list[NumberColumn] = []
    followers: list[NumberColumn] = []
    lone: list[tuple[NumberColumn, int, str]] = []
    for column in columns:
        classes = _group_equal_blocks(column)
        if len(classes) == 1:
            continue
        single = _find_single_exception(column, classes)
        if single is not None:
            lone.append((column, single, next(column.words[c[0]] for c in classes if single not in c)))
        elif column.is_coordinate or not _is_split_in_groups(classes):
            parameters.append(column)
        else:
            followers.append(column)
    derived = []
    for column in followers:
        expression = next((e for p in parameters if (e := _derive_expression(p, column)) is not None), None)
        if expression is None:
            parameters.append(column)
        else:
            derived.append((column.name, expression))
    return Variation(tuple(parameters), tuple(derived), tuple(lone))


def _group_equal_blocks(column: NumberColumn) -> list[list[int]]:
    """The blocks that have one value, as their places."""
    classes: list[list[int]] = []
    for place, word in enumerate(column.words):
        known = next((c for c in classes if _is_equal(column, column.words[c[0]], word)), None)
        if known is None:
            classes.append([place])
        else:
            known.append(place)
    return classes


def _is_equal(column: NumberColumn, one: str, other: str) -> bool:
    a, b = parse_number(one), parse_number(other)
    if a is None or b is None:
        return one == other
    return math.isclose(a, b, rel_tol=1e-6, abs_tol=_LIKE if column.is_angle else 1e-12)


def _find_single_exception(column: NumberColumn, classes: Sequence[Sequence[int]]) -> int | None:
    """The block whose number differs from that of all others; a mirrored one is no exception but the other side."""
    if len(classes) != 2 or len(column.words) < _MAJORITY:
        return None
    few, many = sorted(classes, key=len)
    a, b = parse_number(column.words[few[0]]), parse_number(column.words[many[0]])
    if len(few) != 1 or a is None or b is None or math.isclose(a, -b, rel_tol=1e-3):
        return None
    return few[0]


def _is_split_in_groups(classes: Sequence[Sequence[int]]) -> bool:
    """Two groups of at least two blocks: that a parameter splits the blocks alike is then no coincidence."""
    return len(classes) == 2 and all(len(c) > 1 for c in classes)


def _derive_expression(parameter: NumberColumn, column: NumberColumn) -> str | None:
    """``${0 if y > 0 else pi}`` where the sign of a parameter decides which of two values a column has."""
    values = [parse_number(word) for word in parameter.words]
    above, below = ([i for i, v in enumerate(values) if v is not None and v * sign > 0] for sign in (1, -1))
    if len(above) + len(below) != len(values) or sorted(map(sorted, _group_equal_blocks(column))) != sorted(
        [above, below]
    ):
        return None
    one, other = (_format_expression([column.words[i] for i in places]) for places in (above, below))
    return f"${{{one} if {parameter.name} > 0 else {other}}}"


def _format_expression(words: Sequence[str]) -> str:
    """One value as an expression writes it: a fraction of π by name where one block rounds it."""
    near = next((miss for word in words if (miss := find_near_miss(word)) is not None), None)
    return min(words, key=len) if near is None else near.expression.removeprefix("${").removesuffix("}")
