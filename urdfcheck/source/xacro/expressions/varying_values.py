"""Values of expressions that are others in each process, or in another program than xacro: no model may depend on them.

The text of a function or an iterator holds an address and the name of its code, the hash of a text is random, and so is the
order of a set of texts. A model that reads them is another one each time, or one that is only sound while it is checked.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

from urdfcheck.source.xacro.expressions.compile_expression import ExpressionRefusedError

NUMBERS = frozenset({bool, int, float, complex})
_VIEWS: tuple[type, ...] = (type({}.keys()), type({}.values()), type({}.items()))
# Orders of a set beside the sorted one: enough of them to give each item of a small set another place.
SET_ORDERS = ("reversed", "turned")
_SETS = (set, frozenset)
_COLLECTIONS: tuple[Any, ...] = (tuple, *_SETS, *_VIEWS)
_FIXED = (str, bytes, int, float, complex, range, type(None), type(...))
# Functions for which neither the order of a set nor the text of a value matters.
_ORDERLESS = frozenset(
    {"len", "bool", "isinstance", "issubclass", "all", "any", "set", "frozenset", "min", "max", "sorted"}
)
_ORDERLESS_METHODS = frozenset(
    {"difference", "intersection", "isdisjoint", "issubset", "issuperset", "symmetric_difference", "union"}
    | {"difference_update", "intersection_update", "symmetric_difference_update"}
)


def make_varying_error(reason: str) -> ExpressionRefusedError:
    return ExpressionRefusedError("varies", reason)


def is_orderless(name: str, arguments: dict[str, Any]) -> bool:
    """Whether a function or method gives the same for any order of a set. A ``key`` lets the order decide between equals."""
    return (name in _ORDERLESS or name in _ORDERLESS_METHODS) and "key" not in arguments


def has_random_order(value: Any) -> bool:
    """Whether the order of a value's items is that of random hashes: a set of several items that are not numbers."""
    return isinstance(value, _SETS) and len(value) > 1 and any(type(item) not in NUMBERS for item in value)


def ensure_order(value: Any) -> None:
    """Refuse to go through a set in an order that is random."""
    if has_random_order(value):
        raise make_varying_error("the order of the items of a set differs in each process")


def sort_items(value: Any, order: str = "") -> list[Any]:
    """Return the items of a set in an order that is the same in each process: sorted, or another one (`SET_ORDERS`)."""
    items = sorted(value, key=lambda item: (type(item).__name__, repr(item)))
    if order == "turned":
        return items[1:] + items[:1]
    return items[::-1] if order == "reversed" else items


def ensure_order_inside(value: Any) -> None:
    """Refuse to take a value apart into several names if a set in it has a random order. ``value`` does not hold itself."""
    stack = [value]
    while stack:
        value = stack.pop()
        ensure_order(value)
        if isinstance(value, (list, tuple)):
            stack.extend(list.__iter__(value) if isinstance(value, list) else value)


def ensure_text(value: Any, is_table: Callable[[Any], bool]) -> None:
    """Refuse a value whose text is another in each process.

    :param value: not a container of itself.
    :param is_table: whether a value is one of xacro's tables of names, which hold functions.
    """
    stack = [value]
    while stack:
        value = stack.pop()
        if is_table(value):
            raise make_varying_error("the text of a table of names contains addresses")
        if isinstance(value, dict):
            stack += [*dict.keys(value), *dict.values(value)]
        elif isinstance(value, list):
            stack.extend(list.__iter__(value))  # without the wrappers of yaml values, which record each read
        elif isinstance(value, _COLLECTIONS):
            ensure_order(value)
            stack.extend(value)
        elif isinstance(value, slice):
            stack += [value.start, value.stop, value.step]
        elif not isinstance(value, _FIXED):
            what = "a function" if callable(value) else f"a value of the type {type(value).__name__}"
            raise make_varying_error(f"the text of {what} contains an address, which differs in each process")


def ensure_hash(value: Any) -> None:
    """Refuse the hash of anything but a number."""
    if type(value) not in NUMBERS:
        raise make_varying_error("the hash of anything but a number differs in each process")


def ensure_comparable(value: Any) -> None:
    """Refuse what is compared by its place in memory: a function or an iterator."""
    if callable(value) or hasattr(type(value), "__next__"):
        raise make_varying_error("it compares a function or an iterator, which is equal only to itself")


def ensure_identity(values: Iterable[Any]) -> None:
    """Refuse ``is`` between values other than None, True and False: whether two equal ones are one object is not fixed."""
    if not any(value is None or value is True or value is False for value in values):
        raise make_varying_error("it compares values with `is`, which for equal values is not defined")
