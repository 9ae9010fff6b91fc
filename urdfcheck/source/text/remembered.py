"""What is found in files as typed, remembered: a check asks for it several times, and after an edit the next one reads the other
files again. Who gets it must not change it."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from functools import wraps
from typing import Any, TypeVar

from urdfcheck.source.text.xml import Element

T = TypeVar("T")
# Characters of all texts of which something is remembered.
_MOST_CHARACTERS = 2_000_000
_kept: OrderedDict[tuple[Callable[..., Any], str, tuple[Hashable, ...]], Any] = OrderedDict()
_characters = 0


def tree_fact(compute: Callable[[Element], T]) -> Callable[[Element], T]:
    """Compute a fact once for the tree of a file, as long as there is the tree: expansions share those of unchanged files."""

    @wraps(compute)
    def get(tree: Element) -> T:
        if tree.facts is None:
            tree.facts = {}
        if compute not in tree.facts:
            tree.facts[compute] = compute(tree)
        found: T = tree.facts[compute]
        return found

    return get


def text_fact(compute: Callable[..., T]) -> Callable[..., T]:
    """Compute a fact once for a text and the other arguments, as long as the text is among those that were asked for last."""

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
