"""The classes of `urdfcheck.core.records` behave as those of Python's own decorator."""

from __future__ import annotations

import copy
import dataclasses
import pickle
import random
import subprocess
import sys
import weakref
from collections.abc import Callable, Mapping
from dataclasses import field
from typing import Any, ClassVar

import pytest

from urdfcheck.core import records
from urdfcheck.core.records import dataclass


class Plain:
    """Has a docstring."""

    a: int
    b: str = "two"
    c: list[int] = field(default_factory=list)
    d: float = field(default=0.5, compare=False, repr=False)
    e: ClassVar[int] = 5


class Derived:
    f: int = field(default=1, kw_only=True)
    g: tuple[int, ...] = field(default=(), init=False)
    h: list[int] = field(default_factory=lambda: [1], init=False)
    i: int = field(default=3, hash=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "b", self.b + "!")


class Own:
    a: int

    def __repr__(self) -> str:
        return "own"

    def __eq__(self, other: object) -> bool:
        return True

    def __hash__(self) -> int:
        return 7


class Empty:
    pass


OPTIONS = [
    {},
    {"slots": True},
    {"frozen": True},
    {"frozen": True, "slots": True},
    {"frozen": True, "slots": True, "kw_only": True},
    {"frozen": True, "slots": True, "eq": False},
    {"slots": True, "repr": False},
    {"frozen": True, "order": True},
]
CALLS: list[tuple[tuple[Any, ...], dict[str, Any]]] = [
    ((), {}),
    ((1,), {}),
    ((1, "x"), {}),
    ((1, "x", [3]), {"d": 2.0}),
    ((), {"a": 1, "f": 4}),
    ((1, "x", [3], 2.0, 9), {"f": 2}),
    ((1,), {"a": 2}),
    ((1,), {"unknown": 2}),
    ((1, 2, 3, 4, 5, 6, 7), {}),
]


def make(decorate: Callable[..., Any], body: type, options: Mapping[str, bool], base: type = object) -> type[Any]:
    """A class like ``body``, with the decorator."""
    known = {k: copy.copy(v) for k, v in body.__dict__.items() if k not in ("__dict__", "__weakref__")}
    made: type[Any] = decorate(**options)(type(body.__name__, (base,), known))
    return made


def describe(work: Callable[[], object]) -> object:
    try:
        return work()
    except Exception as error:
        return type(error).__name__, str(error).replace("_dataclass_self", "self")


def observe(decorate: Callable[..., Any], options: Mapping[str, bool]) -> list[object]:
    """What can be seen of classes and objects."""
    plain = make(decorate, Plain, options)
    classes = [
        plain,
        make(decorate, Derived, options, plain),
        make(decorate, Own, options),
        make(decorate, Empty, options),
    ]
    seen: list[object] = []
    for kind in classes:
        seen.append([(f.name, f.type, f.init, f.compare, f.kw_only) for f in dataclasses.fields(kind)])
        seen.append((getattr(kind, "__match_args__", None), kind.__doc__ if kind is plain else "", kind.__name__))
        seen.append([name for name in ("__slots__", "__hash__") if kind.__dict__.get(name, 1) is None])
        objects: list[Any] = []
        for values, named in CALLS:
            made = describe(lambda kind=kind, values=values, named=named: kind(*values, **named))  # type: ignore[misc]
            seen.append(made if isinstance(made, tuple) else "made")
            objects += [] if isinstance(made, tuple) else [made]
        for one in objects:
            eq = options.get("eq", True) or kind is classes[2]
            seen.append(repr(one) if options.get("repr", True) or kind is classes[2] else "")
            seen.append([one == other for other in objects] if eq else one == one)
            seen.append(describe(lambda one=one: hash(one)) if eq else "")  # type: ignore[misc]
            # Python's own fails in its super() for a name that is no field of a frozen class with slots.
            names = [f.name for f in dataclasses.fields(kind)][:1]
            for name in names if options.get("frozen") and options.get("slots") else (*names, "new"):
                seen.append(describe(lambda one=one, name=name: setattr(one, name, 1)))  # type: ignore[misc]
            seen.append(
                describe(lambda one=one, names=names: delattr(one, names[0]) if options.get("frozen") else None)
            )  # type: ignore[misc]
            seen.append(describe(lambda one=one: dataclasses.asdict(one)))  # type: ignore[misc]
            other = describe(lambda one=one: dataclasses.replace(one, a=8))  # type: ignore[misc]
            seen.append(other if isinstance(other, tuple) else dataclasses.astuple(other))  # type: ignore[call-overload]
            twin = copy.copy(one)
            seen.append([getattr(twin, f.name) for f in dataclasses.fields(kind)])
    return seen


@pytest.mark.parametrize("few", [0, 50])
@pytest.mark.parametrize("options", OPTIONS, ids=str)
def test_the_classes_behave_alike(options: dict[str, bool], few: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(records, "_FEW", few)
    assert observe(dataclass, options) == observe(dataclasses.dataclass, options)


@dataclass(frozen=True, slots=True)
class Kept:
    """Of a module, so that it can be pickled."""

    a: int
    b: Any = None


def test_pickles_and_recursion() -> None:
    kept = Kept(1, {"x": (Kept(2),)})
    for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1):
        assert pickle.loads(pickle.dumps(kept, protocol)) == kept
    kept.b["self"] = kept
    assert "..." in repr(kept)
    assert copy.deepcopy(kept).a == 1


def test_random_values_are_equal_where_their_fields_are() -> None:
    ours = make(dataclass, Plain, {"frozen": True, "slots": True})
    theirs = make(dataclasses.dataclass, Plain, {"frozen": True, "slots": True})
    choose = random.Random(4)
    values = [(choose.randrange(3), choose.choice("xy"), (choose.randrange(2),), choose.random()) for _ in range(60)]
    assert [[ours(*a) == ours(*b) for a in values] for b in values] == [
        [theirs(*a) == theirs(*b) for a in values] for b in values
    ]
    assert [hash(ours(*a)) for a in values] == [hash(theirs(*a)) for a in values]
    assert ours(1) != theirs(1)


def test_no_method_is_compiled_for_a_few_objects() -> None:
    compiled: list[type] = []
    compile_init = records._compile_init

    def count(made: type, **options: bool) -> Callable[..., None]:
        compiled.append(made)
        return compile_init(made, **options)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(records, "_compile_init", count)
        kind = make(dataclass, Plain, {"slots": True})
        assert {kind(1).a for _ in range(records._FEW)} == {1}
        assert not compiled
        assert {kind(1).a for _ in range(3)} == {1}
    assert compiled == [kind]


def test_every_class_of_the_package_is_made_so() -> None:
    """One that is not costs half a millisecond of each start."""
    script = (
        "import dataclasses; make = dataclasses._process_class; slow = []\n"
        "def note(cls, init, *rest, **options):\n"
        "    if init and cls.__module__.startswith('urdfcheck'): slow.append(cls.__name__)\n"
        "    return make(cls, init, *rest, **options)\n"
        "dataclasses._process_class = note\n"
        "import urdfcheck.cli.commands.check, urdfcheck.run.unit_audit, urdfcheck.run.pipeline\n"
        "print(slow)"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "['Span']"  # which has an order


def test_objects_without_slots_can_be_referred_to_weakly() -> None:
    one = make(dataclass, Plain, {"frozen": True})(1)
    assert weakref.ref(one)() is one
