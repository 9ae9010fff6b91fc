"""What really varies between blocks that were typed one by one, number by number: the parameters of their macro."""

from __future__ import annotations

import math
from collections.abc import Sequence

from urdfcheck.core.records import dataclass
from urdfcheck.facts.likeness.typed_numbers import find_near_miss
from urdfcheck.source.text.values import parse_number

# Angles closer than this are one angle: 1.57 is off by 8e-4.
_LIKE = 1e-3
# With three blocks, two against one are not a majority.
_MAJORITY = 4


@dataclass(frozen=True, slots=True)
class NumberColumn:
    """One number of an attribute, over all blocks."""

    name: str
    words: tuple[str, ...]
    """Its text in each block."""
    is_coordinate: bool
    """Whether it is a coordinate of a place, which distinguishes blocks by itself."""
    is_angle: bool


@dataclass(frozen=True, slots=True)
class Variation:
    """What varies between blocks."""

    parameters: tuple[NumberColumn, ...]
    """The columns that need a parameter."""
    derived: tuple[tuple[str, str], ...]
    """Name and xacro expression of columns that follow from a parameter."""
    outliers: tuple[tuple[NumberColumn, int, str], ...]
    """Columns in which one block alone differs, its index, and the others' word."""


def classify_columns(columns: Sequence[NumberColumn]) -> Variation:
    """Sort columns into parameters of the blocks' macro, derived numbers and single exceptions, in the order given."""
    parameters: list[NumberColumn] = []
    followers: list[NumberColumn] = []
    outliers: list[tuple[NumberColumn, int, str]] = []
    for column in columns:
        classes = _group_equal_blocks(column)
        if len(classes) == 1:
            continue
        exception = _find_single_exception(column, classes)
        if exception is not None:
            outliers.append((column, exception, next(column.words[c[0]] for c in classes if exception not in c)))
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
    return Variation(tuple(parameters), tuple(derived), tuple(outliers))


def _group_equal_blocks(column: NumberColumn) -> list[list[int]]:
    """Group the blocks that have one value, by their indices."""
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
    """Return the block whose number differs from that of all others; a mirrored one is the other side, and not an exception."""
    if len(classes) != 2 or len(column.words) < _MAJORITY:
        return None
    few, many = sorted(classes, key=len)
    a, b = parse_number(column.words[few[0]]), parse_number(column.words[many[0]])
    if len(few) != 1 or a is None or b is None or math.isclose(a, -b, rel_tol=1e-3):
        return None
    return few[0]


def _is_split_in_groups(classes: Sequence[Sequence[int]]) -> bool:
    """Whether there are two groups of at least two blocks: a parameter that splits them alike is then no coincidence."""
    return len(classes) == 2 and all(len(c) > 1 for c in classes)


def _derive_expression(parameter: NumberColumn, column: NumberColumn) -> str | None:
    """Derive ``${0 if y > 0 else pi}`` where the sign of a parameter decides which of two values a column has."""
    values = [parse_number(word) for word in parameter.words]
    above, below = ([i for i, v in enumerate(values) if v is not None and v * sign > 0] for sign in (1, -1))
    if len(above) + len(below) != len(values) or sorted(map(sorted, _group_equal_blocks(column))) != sorted(
        [above, below]
    ):
        return None
    one, other = (_format_expression([column.words[i] for i in places]) for places in (above, below))
    return f"${{{one} if {parameter.name} > 0 else {other}}}"


def _format_expression(words: Sequence[str]) -> str:
    """Write one value as an expression does: a fraction of π by name where one block rounds it."""
    near = next((miss for word in words if (miss := find_near_miss(word)) is not None), None)
    return min(words, key=len) if near is None else near.expression.removeprefix("${").removesuffix("}")
