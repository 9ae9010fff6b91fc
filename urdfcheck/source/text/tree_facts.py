"""What is computed from the tree of a file as typed, remembered on the tree: the check of a robot asks for it several times, and
after an edit the next check meets the trees of the other files again."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import TypeVar

from urdfcheck.source.text.xml import Element

T = TypeVar("T")


def tree_fact(compute: Callable[[Element], T]) -> Callable[[Element], T]:
    """Compute a fact once per tree. Who gets it must not change it."""

    @wraps(compute)
    def get(tree: Element) -> T:
        if tree.facts is None:
            tree.facts = {}
        if compute not in tree.facts:
            tree.facts[compute] = compute(tree)
        found: T = tree.facts[compute]
        return found

    return get
