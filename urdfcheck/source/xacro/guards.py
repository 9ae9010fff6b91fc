"""What an expression of a xacro file may do with values: nothing that leaves xacro's language, nothing without bounds.

:func:`urdfcheck.source.xacro.expressions.compiled` puts a call of a guard in the place of each operation. A guard looks at the
values: which of their methods are known to be harmless, and how large the result would be, before it is computed. Every
function that an expression can reach is a :class:`Function`, wherever it is called from (``map``, ``sorted(key=…)``).
"""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from itertools import chain
from string import Formatter
from types import CodeType
from typing import Any

from urdfcheck.source.xacro.expressions import Refused

# Far above what robots need, far below what hurts: of a hundred robots none takes more than 35,000 steps.
MAX_STEPS = 2_000_000
MAX_ITEMS = 100_000
MAX_CHARACTERS = 1_000_000
MAX_BITS = 10_000
MAX_DEPTH = 100
MAX_WIDTH = 1_000
MAX_SEPARATORS = 100
# What one step stands for in text.
_CHARACTERS_PER_STEP = 4

_VIEWS: tuple[type, ...] = (type({}.keys()), type({}.values()), type({}.items()))
_CONTAINERS = (dict, list, tuple, set, frozenset, *_VIEWS)
_NUMBERS = frozenset({bool, int, float, complex})
_PLAIN = (str, int, float, complex, list, tuple, dict, set, frozenset, range, slice, type(None), *_VIEWS)


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


_OF_NUMBERS = frozenset({"real", "imag", "numerator", "denominator", "conjugate", "is_integer", "bit_length"})
_OF_SETS = _words(
    "copy difference intersection isdisjoint issubset issuperset symmetric_difference union add clear"
    " difference_update discard intersection_update pop remove symmetric_difference_update update"
)
# The methods that stay inside of the language, by the type that has them.
_METHODS: Mapping[type, frozenset[str]] = {
    str: _words(
        "capitalize casefold center count endswith expandtabs find format index isalnum isalpha isascii isdecimal isdigit"
        " isidentifier islower isnumeric isprintable isspace istitle isupper join ljust lower lstrip partition"
        " removeprefix removesuffix replace rfind rindex rjust rpartition rsplit rstrip split splitlines startswith"
        " strip swapcase title upper zfill"
    ),
    list: _words("append clear copy count extend index insert pop remove reverse sort"),
    tuple: frozenset({"count", "index"}),
    dict: _words("clear copy get items keys pop popitem setdefault update values"),
    set: _OF_SETS,
    frozenset: _OF_SETS,
    range: frozenset({"count", "index"}),
    int: _OF_NUMBERS,
    float: _OF_NUMBERS,
    complex: _OF_NUMBERS,
}
# The methods that look into what their object holds, however deep.
_DEEP = frozenset({"count", "index", "remove", "sort", "copy", *_OF_SETS})
# `vars` hands out a class's own dictionary, in which dunder names are plain keys; `type` hands out the classes.
_FORBIDDEN = frozenset({"type", "vars"})
_OF_NAMESPACES = frozenset({"get", "items", "keys", "values"})
_FIELD = re.compile(r"%(?:\([^()]*\))?[-#0 +]*(\*|\d*)(?:\.(\*|\d*))?[hlL]?[^(]", re.DOTALL)


class Function:
    """A function that expressions may call: its guard sees the arguments first, and may refuse them."""

    __slots__ = ("_check", "_guards", "_shallow", "function")

    def __init__(
        self, guards: Guards, function: Callable[..., Any], check: Callable[..., None] | None, *, shallow: bool = False
    ) -> None:
        self.function = function
        self._guards = guards
        self._check = check
        self._shallow = shallow

    def __call__(self, /, *args: Any, **kwargs: Any) -> Any:
        if not self._shallow:
            args = tuple(map(self._guards.taken, args))
            kwargs = {name: self._guards.taken(value) for name, value in kwargs.items()}
        if self._check is not None:
            args = tuple(list(a) if hasattr(type(a), "__next__") else a for a in args)
            self._check(*args, **kwargs)
        return self.function(*args, **kwargs)

    def __repr__(self) -> str:
        return repr(self.function)


class _Names(dict[str, Any]):
    """The globals of one evaluation: the symbols of the file, and the guards under names that nobody can write."""

    __slots__ = ("guards", "symbols")

    def __init__(self, guards: Mapping[str, Any], symbols: Mapping[str, Any]) -> None:
        super().__init__(__builtins__={})
        self.guards = guards
        self.symbols = symbols

    def __getitem__(self, name: str) -> Any:
        return self.guards[name] if name[0] == "@" else self.symbols[name]


class Guards:
    """The guards of one expansion, which share one count of steps."""

    def __init__(self, namespace: type) -> None:
        """``namespace``: xacro's class of name tables, the one type of value that is not Python's own."""
        self.steps = MAX_STEPS
        self._namespace = namespace
        self._named: dict[str, Callable[..., Any]] = {
            "@add": self._add,
            "@multiply": self._multiply,
            "@power": self._power,
            "@shift": self._shift,
            "@modulo": self._modulo,
            "@subtract": self._on_sets(operator.sub),
            "@either": self._on_sets(operator.or_),
            "@both": self._on_sets(operator.and_),
            "@differ": self._on_sets(operator.xor),
            "@attribute": self._attribute,
            "@item": self._item,
            "@slice": slice,
            "@call": self._call,
            "@weighed": self.taken,
            "@iterable": self._iterable,
            "@unpacked": self._unpacked,
            "@mapping": self._mapping,
        }

    def evaluate(self, code: CodeType, symbols: Mapping[str, Any]) -> Any:
        """The value of a compiled expression. ``symbols`` raises KeyError for a name that it does not know.

        :raises Refused: when a guard stops it.
        """
        value = eval(code, _Names(self._named, symbols))
        self.weigh(value)
        return value

    # -- how much ----------------------------------------------------------------------------------------------

    def spend(self, steps: int) -> None:
        """Count steps of this expansion."""
        self.steps -= steps
        if self.steps < 0:
            raise Refused("too_large", f"the model's expressions take more than {MAX_STEPS:,} steps together")

    def weigh(self, value: Any) -> int:
        """How many characters the value has when it is written out, at least.

        :raises Refused: when it is too large to be written, compared or hashed.
        """
        if type(value) in _NUMBERS or value is None:
            return 24 if type(value) is not int else 2 + value.bit_length() // 3
        if type(value) is str:
            if len(value) > MAX_CHARACTERS:
                raise _too_long(MAX_CHARACTERS, "characters")
            self.spend(len(value) // _CHARACTERS_PER_STEP)
            return len(value) + 2
        return self._weigh_deep(value)

    def _weigh_deep(self, value: Any) -> int:
        size = 0
        stack = [(value, 0)]
        while stack:
            value, depth = stack.pop()
            holds = isinstance(value, _CONTAINERS) and not isinstance(value, self._namespace)
            if type(value) in _NUMBERS:
                size += 8 if type(value) is not int else 2 + value.bit_length() // 3
            elif isinstance(value, str):
                size += len(value) + 2
            elif isinstance(value, bytes):  # of which each may be written as \x00
                size += 4 * len(value) + 3
            elif holds or isinstance(value, range):
                size += 2 * len(value) + 2
            elif callable(value) and not isinstance(value, Function):
                raise Refused("unsafe", f"a {type(value).__name__} leads out of xacro's language")
            else:
                size += 8
            if size > MAX_CHARACTERS:
                raise _too_long(MAX_CHARACTERS, "characters")
            if holds:
                if depth == MAX_DEPTH:
                    raise Refused("too_large", f"its value is nested more than {MAX_DEPTH} deep")
                stack.extend((item, depth + 1) for item in _items(value))
        self.spend(size // _CHARACTERS_PER_STEP)
        return size

    def taken(self, value: Any) -> Any:
        """A value that something looks into: weighed, and of an iterator each item when it comes."""
        if hasattr(type(value), "__next__"):
            return self._each(value)
        self.weigh(value)
        return value

    def _each(self, iterator: Iterator[Any]) -> Iterator[Any]:
        for item in iterator:
            self.spend(1)
            self.weigh(item)
            yield item

    def _make(self, count: int, limit: int, what: str) -> None:
        """That a result of this many items or characters may be made."""
        if count > limit:
            raise _too_long(limit, what)
        self.spend(max(count, 0) // (_CHARACTERS_PER_STEP if limit == MAX_CHARACTERS else 1))

    # -- operators ---------------------------------------------------------------------------------------------

    def _add(self, left: Any, right: Any) -> Any:
        if isinstance(left, str) and isinstance(right, str):
            self._make(len(left) + len(right), MAX_CHARACTERS, "characters")
        elif isinstance(left, (list, tuple)) and isinstance(right, (list, tuple)):
            self._make(len(left) + len(right), MAX_ITEMS, "items")
        return left + right

    def _multiply(self, left: Any, right: Any) -> Any:
        if isinstance(left, int) and isinstance(right, int):
            _ensure_bits(left.bit_length() + right.bit_length() if left and right else 0)
        for sequence, times in ((left, right), (right, left)):
            if isinstance(sequence, (str, bytes, list, tuple)) and isinstance(times, int):
                text = isinstance(sequence, (str, bytes))
                limit, what = (MAX_CHARACTERS, "characters") if text else (MAX_ITEMS, "items")
                self._make(len(sequence) * times, limit, what)
        return left * right

    def _power(self, base: Any, exponent: Any) -> Any:
        if isinstance(base, int) and isinstance(exponent, int) and abs(base) > 1 and exponent > 0:
            _ensure_bits((base.bit_length() - 1) * exponent + 1)
        return base**exponent

    def _shift(self, value: Any, by: Any) -> Any:
        if isinstance(value, int) and isinstance(by, int) and value and by > 0:
            _ensure_bits(value.bit_length() + by)
        return value << by

    def _modulo(self, left: Any, right: Any) -> Any:
        if isinstance(left, str):
            self._ensure_template(left, right)
        elif isinstance(left, bytes):  # of a yaml value that is tagged !!binary
            raise Refused("method", "it uses a % format of bytes")
        return left % right

    def _on_sets(self, operate: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
        def guarded(left: Any, right: Any) -> Any:
            if type(left) not in _NUMBERS:
                self.weigh(left)
                self.weigh(right)
            return operate(left, right)

        return guarded

    def _ensure_template(self, template: str, values: Any) -> None:
        """That ``template % values`` stays small."""
        widest, fields, at = 0, 0, template.find("%")
        while at >= 0:
            field = _FIELD.match(template, at)
            if field is None:
                if at + 1 < len(template):
                    raise Refused("method", "it uses a % format with a key that contains parentheses")
                break  # incomplete: Python says so
            for width in field.groups():
                if width == "*":
                    raise Refused("method", "it uses a % format whose width is computed")
                widest = max(widest, _width(width))
            fields += 1
            at = template.find("%", field.end())
        self._make(len(template) + fields * (widest + 400 + self.weigh(values)), MAX_CHARACTERS, "characters")

    # -- access ------------------------------------------------------------------------------------------------

    def _attribute(self, value: Any, name: str) -> Any:
        if isinstance(value, self._namespace):
            if name in _OF_NAMESPACES:
                return Function(self, getattr(value, name), None)
            if name != "depth" and (hasattr(type(value), name) or name in vars(value)):
                raise _leads_out(name)
            return getattr(value, name)
        if isinstance(value, Function):
            return self._method_of_type(value.function, name)
        for kind, names in _METHODS.items():
            if isinstance(value, kind):
                if name in names:
                    found = getattr(value, name)
                    return self._method(value, name, found) if callable(found) else found
                if not hasattr(kind if kind is dict else value, name):
                    return getattr(value, name)  # a key of a yaml mapping, or Python's words for what is missing
                raise Refused("method", f"the attribute .{name} of a {kind.__name__} is none that robots use")
        if isinstance(value, _PLAIN) and not hasattr(type(value), name):
            return getattr(value, name)
        raise _leads_out(name)

    def _method(self, owner: Any, name: str, method: Callable[..., Any]) -> Function:
        if name in _DEEP and not isinstance(owner, str):
            self.weigh(owner)
        check: Callable[..., None] | None = None
        if isinstance(owner, str):
            self.spend(len(owner) // _CHARACTERS_PER_STEP)
            check = getattr(self, f"_text_{name}", None)
            check = None if check is None else partial(check, owner)
        elif isinstance(owner, (list, set, dict)):
            check = partial(self._ensure_room, owner)
        return Function(self, method, check)

    def _method_of_type(self, kind: Any, name: str) -> Any:
        """``str.lower``, to be called with a text."""
        if kind is dict and name == "fromkeys":
            return Function(self, dict.fromkeys, None)
        names = _METHODS.get(kind, frozenset()) if isinstance(kind, type) else frozenset()
        if name not in names:
            raise _leads_out(name)

        def method(owner: Any, /, *args: Any, **kwargs: Any) -> Any:
            if not isinstance(owner, kind):
                raise TypeError(f"{kind.__name__}.{name} is called with a {type(owner).__name__}")
            return self._call(self._attribute(owner, name), *args, **kwargs)

        return Function(self, method, None)

    def _item(self, value: Any, key: Any) -> Any:
        if isinstance(value, (str, list, tuple, dict, range)):
            if isinstance(key, tuple):
                self.weigh(key)
            found = value[key]
            if isinstance(key, slice):
                self._make(len(found), MAX_CHARACTERS if isinstance(value, str) else MAX_ITEMS, "items")
            return found
        if hasattr(type(value), "__getitem__"):
            raise Refused("unsafe", f"an item of a {type(value).__name__} leads out of xacro's language")
        return operator.getitem(value, key)

    def _call(self, function: Any, /, *args: Any, **kwargs: Any) -> Any:
        if not isinstance(function, Function) and callable(function):
            raise Refused("unsafe", f"a call of a {type(function).__name__} leads out of xacro's language")
        self.spend(1)
        return function(*args, **kwargs)

    def _iterable(self, value: Any) -> Iterator[Any]:
        iterator = iter(value)

        def counted() -> Iterator[Any]:
            for item in iterator:
                self.spend(1)
                yield item

        return counted()

    def _unpacked(self, value: Any) -> Iterator[Any]:
        for item in self._iterable(value):
            self.weigh(item)
            yield item

    def _mapping(self, value: Any) -> Any:
        self.weigh(value)
        return value

    # -- methods of text and lists -----------------------------------------------------------------------------

    def _ensure_room(self, owner: Any, *args: Any, **_: Any) -> None:
        """That a list, set or dictionary may take what a method puts into it."""
        more = sum(len(a) for a in args if isinstance(a, (str, list, tuple, dict, set, frozenset, range)))
        if len(owner) + more > MAX_ITEMS:
            raise _too_long(MAX_ITEMS, "items")

    def _text_replace(self, text: str, old: Any = None, new: Any = None, *_: Any, **__: Any) -> None:
        if isinstance(old, str) and isinstance(new, str):
            times = text.count(old)
            self._make(len(text) + times * max(len(new) - len(old), 0), MAX_CHARACTERS, "characters")

    def _text_ljust(self, _text: str, width: Any = 0, *_: Any) -> None:
        if isinstance(width, int):
            self._make(width, MAX_CHARACTERS, "characters")

    _text_rjust = _text_center = _text_zfill = _text_ljust

    def _text_strip(self, text: str, characters: Any = None, *_: Any) -> None:
        if isinstance(characters, str):  # each character of the text is looked for among these
            self.spend(len(text) * len(characters) // 10_000)

    _text_lstrip = _text_rstrip = _text_strip

    def _text_expandtabs(self, text: str, tabsize: Any = 8) -> None:
        if isinstance(tabsize, int):
            self._make(len(text) + text.count("\t") * max(tabsize, 0), MAX_CHARACTERS, "characters")

    def _text_join(self, text: str, items: Any = (), *_: Any) -> None:
        parts = [len(p) for p in _items(items) if isinstance(p, str)] if isinstance(items, _CONTAINERS) else []
        self._make(sum(parts) + len(text) * len(parts), MAX_CHARACTERS, "characters")

    def _text_format(self, text: str, /, *args: Any, **kwargs: Any) -> None:
        widest, fields = 0, 0
        for _, name, form, _ in Formatter().parse(text):
            if name is None:
                continue
            if "." in name or "[" in name:
                raise Refused("unsafe", f"the field {{{name}}} of a format reads an attribute or an item")
            if form and "{" in form:
                raise Refused("method", "it uses a .format whose width is computed")
            widest = max([widest, *map(_width, re.findall(r"\d+", form or ""))])
            fields += 1
        largest = max([0, *map(self.weigh, (*args, *kwargs.values()))])
        self._make(len(text) + fields * (widest + 400 + largest), MAX_CHARACTERS, "characters")

    # -- functions ---------------------------------------------------------------------------------------------

    def function(self, name: str, function: Callable[..., Any]) -> Function:
        """A function of xacro's language, of this name."""
        if name in {"isinstance", "issubclass"}:
            return Function(self, _with_types(function), None, shallow=True)
        shallow = name in {"len", "bool", "arg", "env", "optenv", "find", "dirname"}
        check = self._ensure_sum if name == "sum" else _FUNCTIONS.get(name)
        return Function(self, function, check, shallow=shallow)

    def _ensure_sum(self, items: Any = (), start: Any = 0, **_: Any) -> None:
        if isinstance(start, (list, tuple)) and isinstance(items, Iterable):  # copied once more for each item
            items = [item for item in items if isinstance(item, (list, tuple))]
            count = len(start) + sum(map(len, items))
            self._make(count, MAX_ITEMS, "items")
            self.spend(count * len(items))

    def protect(self, symbols: dict[str, Any]) -> None:
        """Put a guard around each function of xacro's global symbols and of the namespaces among them."""
        for name, table in {**symbols, "": symbols}.items():
            if isinstance(table, dict):
                for key, function in table.items():
                    if name == "python" and key in _FORBIDDEN:
                        dict.__setitem__(table, key, self.refusing(f"python.{key}"))
                    elif callable(function):
                        dict.__setitem__(table, key, self.function(key, function))

    def refusing(self, name: str) -> Function:
        """Stands for a function that leads out of the language, wherever it is called from."""

        def refuse(*_: Any, **__: Any) -> None:
            raise Refused("unsafe", f"{name} leads out of xacro's language")

        refuse.__name__ = name
        return Function(self, refuse, None, shallow=True)


def _items(container: Any) -> Iterator[Any]:
    """What a container holds, past the wrappers of yaml values that tell what is read."""
    if isinstance(container, dict):
        return chain(dict.keys(container), dict.values(container))
    return list.__iter__(container) if isinstance(container, list) else iter(container)


def _too_long(limit: int, what: str) -> Refused:
    return Refused("too_large", f"its value would have more than {limit:,} {what}")


def _leads_out(name: str) -> Refused:
    return Refused("unsafe", f"the attribute .{name} leads out of xacro's language")


def _ensure_bits(bits: float) -> None:
    if bits > MAX_BITS:
        raise Refused("too_large", f"its value would have more than {MAX_BITS * 0.30103:,.0f} digits")


def _width(text: str | None) -> int:
    if text and (len(text) > 9 or int(text) > MAX_WIDTH):
        raise Refused("too_large", f"it pads a value to more than {MAX_WIDTH:,} characters")
    return int(text or 0)


def _with_types(function: Callable[..., bool]) -> Callable[..., bool]:
    """``isinstance`` and ``issubclass`` for types that are functions of the language: ``list``, ``str`` and the like."""

    def unwrapped(kind: Any) -> Any:
        if type(kind) is tuple:
            return tuple(map(unwrapped, kind))
        return kind.function if isinstance(kind, Function) else kind

    def guarded(value: Any, kind: Any, /) -> bool:
        return function(unwrapped(value), unwrapped(kind))

    return guarded


# -- what the arguments of a function must not be: too little and too many of them are left to the function itself ------


def _range(*args: Any, **_: Any) -> None:
    if args and all(isinstance(a, int) for a in args) and len(args) <= 3 and (len(args) < 3 or args[2]):
        start, stop, step = (0, args[0], 1) if len(args) == 1 else (*args, 1)[:3]
        if (stop - start) // step > MAX_ITEMS:
            raise _too_long(MAX_ITEMS, "items")


def _int(value: Any = 0, *_: Any, **__: Any) -> None:
    if isinstance(value, str):
        _ensure_bits(len(value))


def _round(number: Any = 0, ndigits: Any = None, **_: Any) -> None:
    if isinstance(number, int) and isinstance(ndigits, int) and ndigits < 0:
        _ensure_bits(-ndigits / 0.3)


def _factorial(n: Any = 0, *_: Any) -> None:
    if isinstance(n, (int, float)) and n > 1:
        _ensure_bits(n * math.log2(n))


def _comb(n: Any = 0, k: Any = 0, *_: Any) -> None:
    if isinstance(n, int) and isinstance(k, int) and 0 < k < n:
        _ensure_bits(min(k, n - k) * math.log2(n))


def _perm(n: Any = 0, k: Any = None, *_: Any) -> None:
    k = n if k is None else k
    if isinstance(n, int) and isinstance(k, int) and 0 < k <= n:
        _ensure_bits(k * math.log2(n))


def _product(items: Any = (), *_: Any, start: Any = 1) -> None:
    _ensure_bits(sum(i.bit_length() for i in (*items, start) if isinstance(i, int)))


def _multiple(*numbers: Any) -> None:
    _ensure_bits(sum(i.bit_length() for i in numbers if isinstance(i, int)))


def _tokenize(_text: Any = "", sep: Any = "", *_: Any, **__: Any) -> None:
    # The separators are put between [ and ] of a regular expression.
    if isinstance(sep, str) and len(sep) > MAX_SEPARATORS:
        raise Refused("too_large", f"it gives xacro.tokenize more than {MAX_SEPARATORS} separators")
    if isinstance(sep, str) and "]" in sep[1:]:
        raise Refused("unsafe", "the separators of xacro.tokenize contain a regular expression of their own")


_FUNCTIONS: Mapping[str, Callable[..., None]] = {
    "int": _int,
    "range": _range,
    "round": _round,
    "factorial": _factorial,
    "comb": _comb,
    "perm": _perm,
    "prod": _product,
    "lcm": _multiple,
    "tokenize": _tokenize,
}
