"""What is found in the text of a file, remembered by the text: after an edit, a check reads the other files again."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from functools import wraps
from typing import Any, TypeVar

T = TypeVar("T")
# Characters of all texts of which something is remembered.
_MOST_CHARACTERS = 2_000_000
_kept: OrderedDict[tuple[Callable[..., Any], str, tuple[Hashable, ...]], Any] = OrderedDict()
_characters = 0


def text_fact(compute: Callable[..., T]) -> Callable[..., T]:
    """Compute what is in a text once for the text and the other arguments. Who gets it must not change it."""

    @wraps(compute)
    def get(text: str, *others: Hashable) -> T:
        global _characters  # noqa: PLW0603
        key = compute, text, others
        if key in _kept:
            _kept.move_to_end(key)
        else:
            _kept[key] = compute(text, *others)
            _characters += len(text)
            while _characters > _MOST_CHARACTERS and len(_kept) > 1:
                _characters -= len(_kept.popitem(last=False)[0][1])
        found: T = _kept[key]
        return found

    return get
