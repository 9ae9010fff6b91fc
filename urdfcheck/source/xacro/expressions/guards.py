"""What an expression of a xacro file may do with values: nothing that leaves xacro's language, and nothing without bounds.

The code that :mod:`urdfcheck.source.xacro.expressions.compile_expression` makes calls a guard for each operation. Before the
operation is computed, the guard checks that it is known to be harmless for these values, and how large its result would be.
Every function that an expression can reach is a :class:`GuardedFunction`, wherever it is called from (``map``,
``sorted(key=…)``).
"""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from itertools import chain, repeat
from string import Formatter
from types import CodeType
from typing import Any

from urdfcheck.source.xacro.expressions.compile_expression import ExpressionRefusedError
from urdfcheck.source.xacro.expressions.language import (
    DEEP_METHODS,
    FORBIDDEN_FUNCTIONS,
    FORMAT_FIELD,
    METHODS,
    NAMESPACE_METHODS,
    PATH_FUNCTIONS,
    PATH_METHODS,
    TEXT_FUNCTIONS,
    TEXT_MAKERS,
)
from urdfcheck.source.xacro.expressions.result_sizes import (
    ARGUMENT_CHECKS,
    MAX_CHARACTERS,
    MAX_DEPTH,
    MAX_ITEMS,
    ensure_bits,
    make_too_long_error,
    parse_width,
)
from urdfcheck.source.xacro.expressions.varying_values import (
    ensure_comparable,
    ensure_hash,
    ensure_identity,
    ensure_order,
    ensure_order_inside,
    ensure_text,
    has_random_order,
    is_orderless,
    make_varying_error,
    sort_items,
)

# Far above the need of robots, far below what harms: in a hundred robots the maximum is 35,000.
MAX_STEPS = 2_000_000
# How many characters of text count as one step.
_CHARACTERS_PER_STEP = 4
# Characters of a text that is not handed to xacro where there is nothing to evaluate in it.
_LONGEST_PLAIN = 4096

_VIEWS: tuple[type, ...] = (type({}.keys()), type({}.values()), type({}.items()))
_CONTAINERS = (dict, list, tuple, set, frozenset, *_VIEWS)
_NUMBERS = frozenset({bool, int, float, complex})
# Types that hold nothing: most of what is weighed, so they are told apart before all others.
_LEAVES = _NUMBERS | {str, bytes, type(None)}
_PLAIN = (str, int, float, complex, list, tuple, dict, set, frozenset, range, slice, type(None), *_VIEWS)


class GuardedFunction:
    """A function that expressions may call; its guard checks the arguments first, and may refuse them."""

    __slots__ = ("_check", "_guards", "_name", "_shallow", "function")

    def __init__(
        self,
        guards: Guards,
        function: Callable[..., Any],
        check: Callable[..., None] | None,
        *,
        name: str = "",
        shallow: bool = False,
    ) -> None:
        self.function = function
        self._guards = guards
        self._check = check
        self._name = name
        self._shallow = shallow

    def __call__(self, /, *args: Any, **kwargs: Any) -> Any:
        args = self._guards.check_call(self._name, args, kwargs)
        if not self._shallow:
            args = tuple(map(self._guards.guard_argument, args))
            kwargs = {name: self._guards.guard_argument(value) for name, value in kwargs.items()}
        if self._check is not None:
            args = tuple(list(a) if hasattr(type(a), "__next__") else a for a in args)
            self._check(*args, **kwargs)
        result = self.function(*args, **kwargs)
        if self._name in TEXT_MAKERS:
            owner = getattr(self.function, "__self__", None)
            self._guards.note_lost_place((owner, *args, *kwargs.values()), result)
        return result

    def __repr__(self) -> str:
        """Refuse every way of making a text of it: with an address in it, and with other names than plain xacro's."""
        raise make_varying_error("the text of a function contains an address, which differs in each process")

    def __eq__(self, _other: object) -> bool:
        raise make_varying_error("it compares a function, which is equal only to itself")

    def __hash__(self) -> int:
        raise make_varying_error("the hash of a function differs in each process")


class _EvaluationGlobals(dict[str, Any]):
    """The globals of one evaluation: the symbols of the file, and the guards under names that no expression can spell."""

    __slots__ = ("guards", "symbols")

    def __init__(self, guards: Mapping[str, Any], symbols: Mapping[str, Any]) -> None:
        super().__init__(__builtins__={})
        self.guards = guards
        self.symbols = symbols

    def __getitem__(self, name: str) -> Any:
        return self.guards[name] if name[0] == "@" else self.symbols[name]


class Guards:
    """The guards of one expansion, which share one count of steps."""

    def __init__(
        self,
        namespace: type,
        *,
        places: set[str] | None = None,
        notify: Callable[[str], None] = lambda _kind: None,
        set_order: str = "",
    ) -> None:
        """Start the count. ``namespace``: xacro's class of name tables, the only type of value that is not Python's own.

        ``places``: the folders that the file has asked for so far; ``notify`` is called with the kind of problem
        where an expression looks into one (place-decides), or goes through a set whose order is random (order-decides);
        ``set_order``: see `sort_items`.
        """
        self.steps = MAX_STEPS
        self._places = set() if places is None else places
        self._notify = notify
        self._set_order = set_order
        self._namespace = namespace
        self._own_tables: set[int] = set()
        self._named: dict[str, Callable[..., Any]] = {
            "@add": self._add,
            "@multiply": self._multiply,
            "@power": self._raise_power,
            "@shift": self._shift,
            "@modulo": self._apply_modulo,
            "@subtract": self._guard_set_operator(operator.sub),
            "@either": self._guard_set_operator(operator.or_),
            "@both": self._guard_set_operator(operator.and_),
            "@differ": self._guard_set_operator(operator.xor),
            "@attribute": self._get_attribute,
            "@item": self._get_item,
            "@slice": slice,
            "@call": self._call_function,
            "@measured": self._guard_member,
            "@compared": self._guard_compared,
            "@comparable": self._guard_comparable,
            "@identical": self._guard_identical,
            "@iterable": self._iter_counted,
            "@unpacked": self._iter_measured,
            "@mapping": self._guard_mapping,
        }

    def evaluate(self, code: CodeType, symbols: Mapping[str, Any]) -> Any:
        """Return the value of a compiled expression. ``symbols`` raises KeyError for an unknown name.

        :raises ExpressionRefusedError: if a guard stops it.
        """
        value = eval(code, _EvaluationGlobals(self._named, symbols))
        self.measure(value)
        return value

    def evaluate_again(self, code: CodeType, symbols: Mapping[str, Any], set_order: str) -> Any:
        """Return the value of an expression that was evaluated, for another order of sets. It is not counted and not notified."""
        kept = self.steps, self._notify, self._set_order
        self._notify, self._set_order = _ignore, set_order
        try:
            return eval(code, _EvaluationGlobals(self._named, symbols))
        finally:
            self.steps, self._notify, self._set_order = kept

    # -- what differs from process to process, and from place to place -------------------------------------------

    def make_text(self, value: Any) -> str:
        """Return the text of a value.

        :raises ExpressionRefusedError: if it is another in each process.
        """
        if type(value) is not str:
            self._ensure_text(value)
        return str(value)

    def _ensure_text(self, value: Any) -> None:
        self.measure(value)  # it has an end
        ensure_text(value, self._is_table)

    def check_call(self, name: str, args: tuple[Any, ...], kwargs: dict[str, Any]) -> tuple[Any, ...]:
        """Return the arguments of a function or method, the items of a set in a fixed order where it matters.

        :raises ExpressionRefusedError: if the value would be another in each process.
        """
        for value in (*args, *kwargs.values()):
            self._ensure_foreign_table(value)
            if name in TEXT_FUNCTIONS:
                self._ensure_text(value)
            elif name == "hash":
                self.measure(value)
                ensure_hash(value)
            if name not in PATH_FUNCTIONS:
                self._note_decision(value)
        return args if is_orderless(name, kwargs) else tuple(map(self._order_items, args))

    def _order_items(self, value: Any) -> Any:
        """Return a set whose order is random as a list in a fixed order, and note that; return anything else as it is."""
        if not has_random_order(value):
            return value
        self.measure(value)
        self._notify("order-decides")
        return sort_items(value, self._set_order)

    def _note_decision(self, value: Any) -> None:
        """Note that an expression looks into a text that holds the place of a file, instead of only writing it."""
        if self._places and self._find_places(value):
            self._notify("place-decides")

    def note_lost_place(self, parts: tuple[Any, ...], result: Any) -> None:
        """Note that a text was made of a place of a file, and does not hold it whole: it can only serve to look into it."""
        if self._places and isinstance(result, str) and any(place not in result for place in self._find_places(parts)):
            self._notify("place-decides")

    def _find_places(self, value: Any) -> set[str]:
        """Return the folders that the file asked for and that are in the texts of a value, at any depth."""
        found: set[str] = set()
        stack, seen = [value], set()
        while stack:
            value = stack.pop()
            if isinstance(value, str):
                found.update(place for place in self._places if place in value)
            elif isinstance(value, _CONTAINERS) and not self._is_table(value) and id(value) not in seen:
                seen.add(id(value))
                stack.extend(_iter_items(value))
        return found

    def _is_table(self, value: Any) -> bool:
        return isinstance(value, self._namespace)

    def _ensure_foreign_table(self, value: Any) -> None:
        """Refuse the tables ``python``, ``math`` and ``xacro`` as values: their content is that of a version."""
        if id(value) in self._own_tables:
            raise make_varying_error(
                "it reads a table of Python's or xacro's functions, which differs between versions"
            )

    def _guard_member(self, value: Any) -> Any:
        """Return an operand of ``in`` or a key, after checking it."""
        self._ensure_foreign_table(value)
        self._note_decision(value)
        return self.guard_argument(value)

    def _guard_compared(self, value: Any) -> Any:
        ensure_comparable(value)
        return self._guard_member(value)

    def _guard_comparable(self, value: Any) -> Any:
        """Guard what is compared with a word, which is equal to no path."""
        ensure_comparable(value)
        self._ensure_foreign_table(value)
        return self.guard_argument(value)

    def _guard_identical(self, left: Any, right: Any) -> Any:
        ensure_identity((left, right))
        return left is right

    # -- limits ------------------------------------------------------------------------------------------------

    def charge(self, steps: int) -> None:
        """Count steps of this expansion.

        :raises ExpressionRefusedError: beyond :data:`MAX_STEPS`.
        """
        self.steps -= steps
        if self.steps < 0:
            raise ExpressionRefusedError(
                "too_large", f"the model's expressions take more than {MAX_STEPS:,} steps together"
            )

    def charge_text(self, text: str) -> None:
        """Count the steps that a text takes."""
        self.charge(len(text) // _CHARACTERS_PER_STEP)

    def is_plain(self, text: Any) -> bool:
        """Whether a text is its own value, as most are, and within the limits, towards which it counts."""
        if type(text) is not str or "$" in text or len(text) > min(_LONGEST_PLAIN, self.steps):
            return False
        self.steps -= len(text) // _CHARACTERS_PER_STEP
        return True

    def measure(self, value: Any) -> int:
        """Return a lower bound for the number of characters of the written value.

        :raises ExpressionRefusedError: if it is too large to be written, compared or hashed.
        """
        if type(value) in _NUMBERS or value is None:
            return 24 if type(value) is not int else 2 + value.bit_length() // 3
        if type(value) is str:
            if len(value) > MAX_CHARACTERS:
                raise make_too_long_error(MAX_CHARACTERS, "characters")
            self.charge_text(value)
            return len(value) + 2
        return self._measure_deep(value)

    def _measure_deep(self, value: Any) -> int:
        size = 0
        stack = [(value, 0)]
        while stack:
            value, depth = stack.pop()
            kind = type(value)
            holds = kind not in _LEAVES and isinstance(value, _CONTAINERS) and not isinstance(value, self._namespace)
            if kind in _NUMBERS:
                size += 8 if kind is not int else 2 + value.bit_length() // 3
            elif isinstance(value, str):
                size += len(value) + 2
            elif isinstance(value, bytes):  # each byte may be written as \x00
                size += 4 * len(value) + 3
            elif holds or isinstance(value, range):
                size += 2 * len(value) + 2
            elif callable(value) and not isinstance(value, GuardedFunction):
                raise ExpressionRefusedError("unsafe", f"a {type(value).__name__} is not part of xacro's language")
            else:
                size += 8
            if size > MAX_CHARACTERS:
                raise make_too_long_error(MAX_CHARACTERS, "characters")
            if holds:
                if depth == MAX_DEPTH:
                    raise ExpressionRefusedError("too_large", f"its value is nested more than {MAX_DEPTH} deep")
                stack.extend(zip(_iter_items(value), repeat(depth + 1)))
        self.charge(size // _CHARACTERS_PER_STEP)
        return size

    def guard_argument(self, value: Any) -> Any:
        """Return a value that was measured before a function visits its content; of an iterator, each item as it comes."""
        if hasattr(type(value), "__next__"):
            return self._guard_items(value)
        self.measure(value)
        return value

    def _guard_items(self, iterator: Iterator[Any]) -> Iterator[Any]:
        for item in iterator:
            self.charge(1)
            self.measure(item)
            yield item

    def _ensure_result_size(self, count: int, limit: int, what: str) -> None:
        """Refuse a result of too many items or characters."""
        if count > limit:
            raise make_too_long_error(limit, what)
        self.charge(max(count, 0) // (_CHARACTERS_PER_STEP if limit == MAX_CHARACTERS else 1))

    # -- operators ---------------------------------------------------------------------------------------------

    def _add(self, left: Any, right: Any) -> Any:
        if isinstance(left, str) and isinstance(right, str):
            self._ensure_result_size(len(left) + len(right), MAX_CHARACTERS, "characters")
        elif isinstance(left, (list, tuple)) and isinstance(right, (list, tuple)):
            self._ensure_result_size(len(left) + len(right), MAX_ITEMS, "items")
        return left + right

    def _multiply(self, left: Any, right: Any) -> Any:
        if isinstance(left, int) and isinstance(right, int):
            ensure_bits(left.bit_length() + right.bit_length() if left and right else 0)
        for sequence, times in ((left, right), (right, left)):
            if isinstance(sequence, (str, bytes, list, tuple)) and isinstance(times, int):
                text = isinstance(sequence, (str, bytes))
                limit, what = (MAX_CHARACTERS, "characters") if text else (MAX_ITEMS, "items")
                self._ensure_result_size(len(sequence) * times, limit, what)
        return left * right

    def _raise_power(self, base: Any, exponent: Any) -> Any:
        if isinstance(base, int) and isinstance(exponent, int) and abs(base) > 1 and exponent > 0:
            ensure_bits((base.bit_length() - 1) * exponent + 1)
        return base**exponent

    def _shift(self, value: Any, by: Any) -> Any:
        if isinstance(value, int) and isinstance(by, int) and value and by > 0:
            ensure_bits(value.bit_length() + by)
        return value << by

    def _apply_modulo(self, left: Any, right: Any) -> Any:
        if isinstance(left, str):
            self._ensure_text(right)
            self._ensure_template(left, right)
        elif isinstance(left, bytes):  # a yaml value that is tagged !!binary
            raise ExpressionRefusedError("method", "it uses a % format of bytes")
        result = left % right
        self.note_lost_place((left, right), result)
        return result

    def _guard_set_operator(self, operate: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
        def apply_measured(left: Any, right: Any) -> Any:
            if type(left) not in _NUMBERS:
                self.measure(left)
                self.measure(right)
                self._note_decision((left, right))
            return operate(left, right)

        return apply_measured

    def _ensure_template(self, template: str, values: Any) -> None:
        """Refuse ``template % values`` if the result is large or its size unknown."""
        widest, fields, at = 0, 0, template.find("%")
        while at >= 0:
            field = FORMAT_FIELD.match(template, at)
            if field is None:
                if at + 1 < len(template):
                    raise ExpressionRefusedError("method", "it uses a % format with a key that contains parentheses")
                break  # incomplete: Python reports it
            for width in field.groups():
                if width == "*":
                    raise ExpressionRefusedError("method", "it uses a % format whose width is computed")
                widest = max(widest, parse_width(width))
            fields += 1
            at = template.find("%", field.end())
        self._ensure_result_size(
            len(template) + fields * (widest + 400 + self.measure(values)), MAX_CHARACTERS, "characters"
        )

    # -- access ------------------------------------------------------------------------------------------------

    def _get_attribute(self, value: Any, name: str) -> Any:
        if isinstance(value, self._namespace):
            if name in NAMESPACE_METHODS:
                self._ensure_foreign_table(value)
                return GuardedFunction(self, getattr(value, name), None)
            if name != "depth" and (hasattr(type(value), name) or name in vars(value)):
                raise _make_attribute_error(name)
            return getattr(value, name)
        if isinstance(value, GuardedFunction):
            return self._get_unbound_method(value.function, name)
        for kind, names in METHODS.items():
            if isinstance(value, kind):
                if name in names:
                    found = getattr(value, name)
                    return self._guard_method(value, name, found) if callable(found) else found
                if not hasattr(kind if kind is dict else value, name):
                    return getattr(value, name)  # a key of a yaml mapping, or Python's error for a missing attribute
                raise ExpressionRefusedError(
                    "method", f"the attribute .{name} of a {kind.__name__} is not one that robots use"
                )
        if isinstance(value, _PLAIN) and not hasattr(type(value), name):
            return getattr(value, name)
        raise _make_attribute_error(name)

    def _guard_method(self, owner: Any, name: str, method: Callable[..., Any]) -> GuardedFunction:
        if name in DEEP_METHODS and not isinstance(owner, str):
            self.measure(owner)
        if name == "pop":
            ensure_order(owner)
        if name not in PATH_METHODS:
            self._note_decision(owner)
        check: Callable[..., None] | None = None
        if isinstance(owner, str):
            self.charge(len(owner) // _CHARACTERS_PER_STEP)
            check = getattr(self, f"_text_{name}", None)
            check = None if check is None else partial(check, owner)
        elif isinstance(owner, (list, set, dict)):
            check = partial(self._ensure_room, owner)
        return GuardedFunction(self, method, check, name=name)

    def _get_unbound_method(self, kind: Any, name: str) -> Any:
        """Return a method such as ``str.lower``, to be called with a text."""
        if kind is dict and name == "fromkeys":
            return GuardedFunction(self, dict.fromkeys, None, name="fromkeys")
        names = METHODS.get(kind, frozenset()) if isinstance(kind, type) else frozenset()
        if name not in names:
            raise _make_attribute_error(name)

        def call_on_owner(owner: Any, /, *args: Any, **kwargs: Any) -> Any:
            if not isinstance(owner, kind):
                raise TypeError(f"{kind.__name__}.{name} is called with a {type(owner).__name__}")
            return self._call_function(self._get_attribute(owner, name), *args, **kwargs)

        return GuardedFunction(self, call_on_owner, None, name=name)

    def _get_item(self, value: Any, key: Any) -> Any:
        if isinstance(value, (str, list, tuple, dict, range)):
            if isinstance(key, tuple):
                self.measure(key)
            if isinstance(value, str):
                self._note_decision(value)
            self._note_decision(key)
            found = value[key]
            if isinstance(key, slice):
                self._ensure_result_size(len(found), MAX_CHARACTERS if isinstance(value, str) else MAX_ITEMS, "items")
            return found
        if hasattr(type(value), "__getitem__"):
            raise ExpressionRefusedError(
                "unsafe", f"an item of a {type(value).__name__} is not part of xacro's language"
            )
        return operator.getitem(value, key)

    def _call_function(self, function: Any, /, *args: Any, **kwargs: Any) -> Any:
        if not isinstance(function, GuardedFunction) and callable(function):
            raise ExpressionRefusedError(
                "unsafe", f"a call of a {type(function).__name__} is not part of xacro's language"
            )
        self.charge(1)
        return function(*args, **kwargs)

    def _iter_counted(self, value: Any) -> Iterator[Any]:
        self._ensure_foreign_table(value)
        if isinstance(value, str):
            self._note_decision(value)
        iterator = iter(self._order_items(value))

        def iter_counting() -> Iterator[Any]:
            for item in iterator:
                self.charge(1)
                yield item

        return iter_counting()

    def _iter_measured(self, value: Any) -> Iterator[Any]:
        for item in self._iter_counted(value):
            self.measure(item)
            ensure_order_inside(item)
            yield item

    def _guard_mapping(self, value: Any) -> Any:
        self._ensure_foreign_table(value)
        self.measure(value)
        return value

    # -- methods of text and lists -----------------------------------------------------------------------------

    def _ensure_room(self, owner: Any, *args: Any, **_: Any) -> None:
        """Refuse to put more into a list, set or dictionary than it may hold."""
        more = sum(len(a) for a in args if isinstance(a, (str, list, tuple, dict, set, frozenset, range)))
        if len(owner) + more > MAX_ITEMS:
            raise make_too_long_error(MAX_ITEMS, "items")

    def _text_replace(self, text: str, old: Any = None, new: Any = None, *_: Any, **__: Any) -> None:
        if isinstance(old, str) and isinstance(new, str):
            times = text.count(old)
            self._ensure_result_size(len(text) + times * max(len(new) - len(old), 0), MAX_CHARACTERS, "characters")

    def _text_ljust(self, _text: str, width: Any = 0, *_: Any) -> None:
        if isinstance(width, int):
            self._ensure_result_size(width, MAX_CHARACTERS, "characters")

    _text_rjust = _text_center = _text_zfill = _text_ljust

    def _text_strip(self, text: str, characters: Any = None, *_: Any) -> None:
        if isinstance(characters, str):  # each character of the text is compared with these
            self.charge(len(text) * len(characters) // 10_000)

    _text_lstrip = _text_rstrip = _text_strip

    def _text_expandtabs(self, text: str, tabsize: Any = 8) -> None:
        if isinstance(tabsize, int):
            self._ensure_result_size(len(text) + text.count("\t") * max(tabsize, 0), MAX_CHARACTERS, "characters")

    def _text_join(self, text: str, items: Any = (), *_: Any) -> None:
        parts = [len(p) for p in _iter_items(items) if isinstance(p, str)] if isinstance(items, _CONTAINERS) else []
        self._ensure_result_size(sum(parts) + len(text) * len(parts), MAX_CHARACTERS, "characters")

    def _text_format(self, text: str, /, *args: Any, **kwargs: Any) -> None:
        widest, fields = 0, 0
        for _, name, form, _ in Formatter().parse(text):
            if name is None:
                continue
            if "." in name or "[" in name:
                raise ExpressionRefusedError(
                    "unsafe", f"the field {{{name}}} of a format reads an attribute or an item"
                )
            if form and "{" in form:
                raise ExpressionRefusedError("method", "it uses a .format whose width is computed")
            widest = max([widest, *map(parse_width, re.findall(r"\d+", form or ""))])
            fields += 1
        largest = max([0, *map(self.measure, (*args, *kwargs.values()))])
        self._ensure_result_size(len(text) + fields * (widest + 400 + largest), MAX_CHARACTERS, "characters")

    # -- functions ---------------------------------------------------------------------------------------------

    def guard_function(self, name: str, function: Callable[..., Any]) -> GuardedFunction:
        """Return a function of xacro's language with the guard for its name."""
        if name in {"isinstance", "issubclass"}:
            return GuardedFunction(self, _accept_guarded_types(function), None, name=name, shallow=True)
        shallow = name in {"len", "bool", "arg", "env", "optenv", "find", "dirname"}
        check = self._ensure_sum if name == "sum" else ARGUMENT_CHECKS.get(name)
        return GuardedFunction(self, function, check, name=name, shallow=shallow)

    def _ensure_sum(self, items: Any = (), start: Any = 0, **_: Any) -> None:
        if isinstance(start, (list, tuple)) and isinstance(items, Iterable):  # copied again for each item
            items = [item for item in items if isinstance(item, (list, tuple))]
            count = len(start) + sum(map(len, items))
            self._ensure_result_size(count, MAX_ITEMS, "items")
            self.charge(count * len(items))

    def guard_symbols(self, symbols: dict[str, Any]) -> None:
        """Put a guard around each function of xacro's global symbols and of the namespaces among them."""
        for name, table in {**symbols, "": symbols}.items():
            if isinstance(table, dict):
                if name:
                    self._own_tables.add(id(table))
                for key, function in table.items():
                    if name == "python" and key in FORBIDDEN_FUNCTIONS:
                        dict.__setitem__(table, key, self.make_forbidden_function(f"python.{key}"))
                    elif callable(function):
                        dict.__setitem__(table, key, self.guard_function(key, function))

    def make_forbidden_function(self, name: str) -> GuardedFunction:
        """Return a substitute for a function that leads out of the language; it refuses every call."""

        def refuse(*_: Any, **__: Any) -> None:
            raise ExpressionRefusedError("unsafe", f"{name} is not part of xacro's language")

        refuse.__name__ = name
        return GuardedFunction(self, refuse, None, shallow=True)


def _ignore(_kind: str) -> None:
    pass


def _iter_items(container: Any) -> Iterator[Any]:
    """Yield the content of a container without the wrappers of yaml values, which record each read."""
    if isinstance(container, dict):
        return chain(dict.keys(container), dict.values(container))
    return list.__iter__(container) if isinstance(container, list) else iter(container)


def _make_attribute_error(name: str) -> ExpressionRefusedError:
    return ExpressionRefusedError("unsafe", f"the attribute .{name} is not part of xacro's language")


def _accept_guarded_types(function: Callable[..., bool]) -> Callable[..., bool]:
    """Return ``isinstance`` or ``issubclass`` for types that are functions of the language: ``list``, ``str`` and the like."""

    def unwrap_types(kind: Any) -> Any:
        if type(kind) is tuple:
            return tuple(map(unwrap_types, kind))
        return kind.function if isinstance(kind, GuardedFunction) else kind

    def call_unwrapped(value: Any, kind: Any, /) -> bool:
        return function(unwrap_types(value), unwrap_types(kind))

    return call_unwrapped
