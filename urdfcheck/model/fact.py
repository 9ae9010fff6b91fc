"""The one memo: a fact of a model is a function, computed when it is first called and remembered on the model."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
from functools import wraps
from inspect import isgeneratorfunction
from typing import Any, Concatenate, ParamSpec, Protocol, TypeVar

from urdfcheck.core.errors import FactUnavailableError


class Remembering(Protocol):
    """An object that holds a memo: a model."""

    @property
    def memo(self) -> dict[Hashable, Any]: ...


M = TypeVar("M", bound=Remembering)
P = ParamSpec("P")
T = TypeVar("T")


def fact(compute: Callable[Concatenate[M, P], T]) -> Callable[Concatenate[M, P], T]:
    """Compute a fact once per model, and per set of (hashable) arguments after the model.

    A `FactUnavailableError` is also remembered and raised again: every link asks for the tree of a model, which may have
    none.

    :raises TypeError: when the function returns an iterator.
    """

    if isgeneratorfunction(compute):
        raise TypeError(f"the fact {compute.__name__} is a generator; return a tuple")

    @wraps(compute)
    def get(model: M, /, *args: P.args, **kwargs: P.kwargs) -> T:
        key = (compute, args, tuple(kwargs.items()))
        memo = model.memo
        if key not in memo:
            try:
                value = compute(model, *args, **kwargs)
                if isinstance(value, Iterator):  # the second reader would find it exhausted
                    raise TypeError(f"the fact {compute.__name__} is an iterator; return a tuple")
                memo[key] = value
            except FactUnavailableError as reason:
                memo[key] = reason
        known = memo[key]
        if isinstance(known, FactUnavailableError):
            raise known.with_traceback(None)
        result: T = known
        return result

    return get
