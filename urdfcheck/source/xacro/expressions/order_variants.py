"""Values that depend on the order in which an expression goes through a set, and whether the robot can depend on them.

That order is random. A value that it decides is computed for other orders too, and so is what is computed from it, as long as it
stays in properties and parameters. Most often a condition ends that: ``'thumb' in fingers`` is the same for any order of
``fingers``, and then so is the robot. Where the value goes anywhere else, or is computed by more than a plain expression, this
does not tell: the whole model has to be expanded with other orders.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from typing import Any

from urdfcheck.source.xacro.expressions.varying_values import SET_ORDERS, has_random_order

# The value for each of `SET_ORDERS`.
_Variants = tuple[Any, ...]
_SCALARS = frozenset({str, int, float, bool, type(None)})
_CONTAINERS = frozenset({list, tuple, set, frozenset})
# An expression of these has no effect, so it can be computed again.
_PURE_NODES = (
    *(ast.Expression, ast.Name, ast.expr_context, ast.Constant, ast.List, ast.Tuple, ast.Set, ast.Subscript),
    *(ast.BoolOp, ast.boolop, ast.UnaryOp, ast.unaryop, ast.BinOp, ast.operator, ast.Compare, ast.cmpop, ast.IfExp),
    *(ast.ListComp, ast.SetComp, ast.comprehension, ast.Call, ast.Attribute),
)
_PURE_FUNCTIONS = frozenset({"list", "set", "tuple", "frozenset", "sorted", "len", "any", "all", "bool", "isinstance"})
_PURE_METHODS = frozenset({"lower", "upper", "strip", "split", "join", "startswith", "endswith"})


class OrderVariants:
    """Follows the values of one expansion that depend on the order of a set."""

    def __init__(self) -> None:
        self.is_undecided = False
        """Whether another order may make another robot, as far as was followed."""
        # For each expression in progress, whether an order decides something in it.
        self._open: list[bool] = []
        # The last value that differs, until a property or parameter takes it; and whether one ever did, which is rare.
        self._pending: tuple[Any, _Variants] | None = None
        self._was_taken = False

    def begin_expression(self) -> None:
        """Note that an expression is evaluated now."""
        self.note_other_use()
        self._open.append(False)

    def end_expression(self) -> bool:
        """Note the end of the last expression that began; return whether an order decides something in it."""
        self.note_other_use()
        return self._open.pop()

    def compare_orders(self, expression: str, value: Any, recompute: Callable[[str], Any]) -> None:
        """Find the values of an expression for other orders, which ``recompute`` computes."""
        if not self.is_undecided:
            self._pending = self._compare(expression, value, recompute)

    def _compare(self, expression: str, value: Any, recompute: Callable[[str], Any]) -> tuple[Any, _Variants] | None:
        """Return the value with those for other orders; None where all are the same, or not known."""
        try:
            variants = tuple(map(recompute, SET_ORDERS)) if _is_pure(expression) else None
        except Exception:  # whatever it is, it ends the expansion in that order
            variants = None
        if variants is None or not all(map(is_plain, (value, *variants))):
            self.is_undecided = True
            return None
        return (value, variants) if any(_describe(other) != _describe(value) for other in variants) else None

    def note_order(self) -> None:
        """Note that the expression in progress goes through a set whose order is random."""
        if self._open:
            self._open[-1] = True
        else:
            self.is_undecided = True

    def note_other_use(self) -> None:
        """Note that no property takes the last value: it went to where it is not followed."""
        self.is_undecided = self.is_undecided or self._pending is not None
        self._pending = None

    def note_definition(self, table: Any, name: str, value: Any, convert: Callable[[Any], Any]) -> None:
        """Note that a property or parameter has a new value. ``convert``: what a table makes of a text that it gets."""
        if self._was_taken:
            _get_variants(table).pop(name, None)
        if self._pending is not None and is_plain(value) and _describe(convert(self._pending[0])) == _describe(value):
            _get_variants(table)[name] = tuple(map(convert, self._pending[1]))
            self._pending = None
            self._was_taken = True

    def note_read(self, table: Any, name: str, value: Any) -> None:
        """Note that a property or parameter is read."""
        variants = _get_variants(table).get(name) if self._was_taken else None
        if variants is None:
            return
        if self._open:
            self._open[-1] = True
        else:  # a parameter of a macro takes it over: ``fingers:=^``
            self.note_other_use()
            self._pending = value, variants


class VariantNames(Mapping[str, Any]):
    """The names that an expression can read, with their values for another order of sets. Reading one has no effect."""

    def __init__(self, table: Any, order: str) -> None:
        self.table = table
        self.place = SET_ORDERS.index(order)

    def __getitem__(self, name: str) -> Any:
        table = self.table
        while hasattr(table, "unevaluated"):  # up to xacro's own functions, which no file defines
            if dict.__contains__(table, name):
                return self._get_value(table, name)
            table = table.parent
        return table[name]

    def _get_value(self, table: Any, name: str) -> Any:
        """Return a value of a table.

        :raises ValueError: if to read it here would change it.
        """
        variants = _get_variants(table).get(name)
        value = dict.__getitem__(table, name) if variants is None else variants[self.place]
        if name in table.unevaluated or not is_plain(value):
            raise ValueError(name)
        return value

    def __iter__(self) -> Iterator[str]:
        return iter(self.table)

    def __len__(self) -> int:
        return len(self.table)


def _get_variants(table: Any) -> dict[str, _Variants]:
    """Return the variants of the values in one of xacro's tables."""
    variants: dict[str, _Variants] = table.__dict__.setdefault("_urdfcheck_variants", {})
    return variants


def is_plain(value: Any) -> bool:
    """Whether a value consists of texts, numbers and containers of Python: nothing in it changes by being read."""
    return type(value) in _SCALARS or (type(value) in _CONTAINERS and all(map(is_plain, value)))


def _describe(value: Any) -> str:
    """Return a text that two plain values share if no expression tells them apart."""
    if type(value) not in _CONTAINERS:
        return repr(value)
    items = list(map(_describe, value))
    if has_random_order(value):
        items.sort()
    return f"{type(value).__name__}({', '.join(items)})"


@lru_cache(maxsize=1024)
def _is_pure(expression: str) -> bool:
    """Whether an expression has no effect, whatever its names mean."""
    tree = ast.parse(expression.strip(), mode="eval")
    called = {id(node.func): node.func for node in ast.walk(tree) if isinstance(node, ast.Call)}
    attributes = [node for node in ast.walk(tree) if isinstance(node, ast.Attribute)]
    return (
        all(isinstance(node, _PURE_NODES) for node in ast.walk(tree))
        and all(map(_is_pure_function, called.values()))
        and all(id(node) in called for node in attributes)
    )


def _is_pure_function(function: ast.expr) -> bool:
    if isinstance(function, ast.Name):
        return function.id in _PURE_FUNCTIONS
    if not isinstance(function, ast.Attribute):
        return False
    is_of_python = isinstance(function.value, ast.Name) and function.value.id == "python"
    return function.attr in (_PURE_FUNCTIONS if is_of_python else _PURE_METHODS)
