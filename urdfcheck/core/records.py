"""`dataclass`, which makes a class in a tenth of the time that Python's own takes.

That one compiles up to seven methods for each class while its module is imported: 0.2 to 0.6 ms. A check of one model loads
290 classes. Here the methods are closures, and only ``__init__`` is compiled, once a class has made a few objects. The functions
of `dataclasses` take these classes for their own.
"""

from __future__ import annotations

import dataclasses
import operator
from collections.abc import Callable
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:

    def dataclass(cls: type | None = None, /, **options: bool) -> Any:
        """Do what ``dataclasses.dataclass`` does with the same options; classes with an order are left to it."""
        make_class = dataclasses.dataclass if options.get("order") else _make_class

        def make(plain: type) -> type:
            return make_class(plain, **options)

        return make if cls is None else make(cls)


def _make_class(plain: type, *, eq: bool = True, frozen: bool = False, slots: bool = False, **options: bool) -> type:
    """Let `dataclasses` read the fields, and add the methods that ``plain`` does not define itself."""
    own = {name for name in plain.__dict__ if name != "__hash__" or plain.__dict__[name] is not None}
    if not plain.__doc__:
        plain.__doc__ = plain.__name__  # in place of a signature, which takes long
    is_shown = options.pop("repr", True)
    made: type[Any] = dataclasses.dataclass(plain, init=False, repr=False, eq=False, slots=slots, **options)
    fields = dataclasses.fields(made)
    methods: dict[str, Any] = {"__init__": _make_init(made, frozen=frozen, slots=slots)}
    if is_shown:
        methods["__repr__"] = _describe
    if eq:
        methods["__eq__"] = _make_eq(_make_reader([field.name for field in fields if field.compare]))
        hashed = [field.name for field in fields if (field.compare if field.hash is None else field.hash)]
        methods["__hash__"] = _make_hash(_make_reader(hashed)) if frozen else None
    if frozen:
        names = frozenset(field.name for field in fields)
        methods |= {"__setattr__": _make_setattr(made, names), "__delattr__": _make_delattr(made, names)}
        if slots:  # pickle would set the attributes one by one
            ordered = tuple(field.name for field in fields)
            methods |= {"__getstate__": _make_getstate(ordered), "__setstate__": _make_setstate(ordered)}
    for name, method in methods.items():
        if name not in own:
            setattr(made, name, method)
    return made


# -- methods -----------------------------------------------------------------------------------------------------------


# To compile ``__init__`` takes as long as so many objects without: most classes of a run make fewer.
_FEW = 50


def _make_init(made: type[Any], *, frozen: bool, slots: bool) -> Callable[..., None]:
    fields: tuple[dataclasses.Field[Any], ...] = ()
    positional: list[str] = []
    count = 0

    def initialize(self: Any, *values: Any, **named: Any) -> None:
        nonlocal fields, positional, count
        count += 1
        if count == 1:
            fields = dataclasses.fields(made)
            positional = [field.name for field in fields if field.init and not field.kw_only]
        given = {**dict(zip(positional, values, strict=False)), **named}
        is_plain = count <= _FEW and len(given) == len(values) + len(named)
        if is_plain and _set_fields(self, fields, given, frozen=frozen, slots=slots):
            if hasattr(made, "__post_init__"):
                self.__post_init__()
            return
        init = _compile_init(made, frozen=frozen, slots=slots)  # which also explains wrong arguments
        type.__setattr__(made, "__init__", init)
        init(self, *values, **named)

    return initialize


def _set_fields(
    self: Any, fields: tuple[dataclasses.Field[Any], ...], given: dict[str, Any], *, frozen: bool, slots: bool
) -> bool:
    """Set the fields of a new object; return whether the arguments ``given`` are those of its class."""
    set_field = object.__setattr__ if frozen else setattr
    for field in fields:
        if field.init and field.name in given:
            value = given.pop(field.name)
        elif field.default_factory is not dataclasses.MISSING:
            value = field.default_factory()
        elif field.default is not dataclasses.MISSING and (field.init or slots):
            value = field.default
        elif field.init:
            return False
        else:
            continue  # it is set elsewhere, or the class has its value
        set_field(self, field.name, value)
    return not given


def _compile_init(made: type[Any], *, frozen: bool, slots: bool) -> Callable[..., None]:
    """Compile the method that sets the fields of a new object."""
    # As in `dataclasses`, the names of fields cannot collide with these.
    known: dict[str, Any] = {"_dataclass_missing": dataclasses.MISSING, "_dataclass_set": object.__setattr__}
    positional: list[str] = []
    named: list[str] = []
    body: list[str] = []
    for number, field in enumerate(dataclasses.fields(made)):
        has_factory = field.default_factory is not dataclasses.MISSING
        has_default = field.default is not dataclasses.MISSING
        value, default = field.name, f"_dataclass_default_{number}"
        if has_factory:
            known[default] = field.default_factory
            value = f"{default}() if {value} is _dataclass_missing else {value}" if field.init else f"{default}()"
        elif has_default:
            known[default] = field.default
            value = value if field.init else default
        if field.init:
            given = "=_dataclass_missing" if has_factory else f"={default}" if has_default else ""
            (named if field.kw_only else positional).append(field.name + given)
        elif not has_factory and not (has_default and slots):
            continue  # it is set elsewhere, or the class has its value
        body.append(
            f"_dataclass_set(_dataclass_self, {field.name!r}, {value})"
            if frozen
            else f"_dataclass_self.{field.name} = {value}"
        )
    if hasattr(made, "__post_init__"):
        body.append("_dataclass_self.__post_init__()")
    parameters = ", ".join(["_dataclass_self", *positional, *(["*", *named] if named else [])])
    text = f"def __init__({parameters}):\n " + "\n ".join(body or ["pass"])
    made_here: dict[str, Any] = {}
    exec(text, known, made_here)
    init: Callable[..., None] = made_here["__init__"]
    init.__qualname__, init.__module__ = f"{made.__qualname__}.__init__", made.__module__
    return init


def _make_reader(names: list[str]) -> Callable[[Any], Any]:
    """Return a function that reads these attributes."""
    return operator.attrgetter(*names) if names else lambda _: ()


def _make_eq(read: Callable[[Any], Any]) -> Callable[[Any, object], Any]:
    def is_equal(self: Any, other: object) -> Any:
        return read(self) == read(other) if other.__class__ is self.__class__ else NotImplemented

    return is_equal


def _make_hash(read: Callable[[Any], Any]) -> Callable[[Any], int]:
    def compute_hash(self: Any) -> int:
        return hash(read(self))

    return compute_hash


def _make_setattr(made: type[Any], names: frozenset[str]) -> Callable[[Any, str, Any], None]:
    def refuse_change(self: Any, name: str, value: Any) -> None:
        if type(self) is made or name in names:
            raise dataclasses.FrozenInstanceError(f"cannot assign to field {name!r}")
        super(made, self).__setattr__(name, value)

    return refuse_change


def _make_delattr(made: type[Any], names: frozenset[str]) -> Callable[[Any, str], None]:
    def refuse_deletion(self: Any, name: str) -> None:
        if type(self) is made or name in names:
            raise dataclasses.FrozenInstanceError(f"cannot delete field {name!r}")
        super(made, self).__delattr__(name)

    return refuse_deletion


@recursive_repr()
def _describe(self: Any) -> str:
    values = (f"{f.name}={getattr(self, f.name)!r}" for f in dataclasses.fields(self) if f.repr)
    return f"{type(self).__qualname__}({', '.join(values)})"


def _make_getstate(names: tuple[str, ...]) -> Callable[[Any], list[Any]]:
    def list_values(self: Any) -> list[Any]:
        return [getattr(self, name) for name in names]

    return list_values


def _make_setstate(names: tuple[str, ...]) -> Callable[[Any, list[Any]], None]:
    def set_values(self: Any, values: list[Any]) -> None:
        for name, value in zip(names, values, strict=False):
            object.__setattr__(self, name, value)

    return set_values
