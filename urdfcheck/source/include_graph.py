"""Which files include which: who uses a file, and whether a file is a part of others."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from pathlib import Path


class IncludeGraph:
    """The includes below a folder. Files that include each other in a circle form one component.

    Everything is computed once for all files, in time that is linear in the number of includes.
    """

    def __init__(self, includes: Mapping[Path, AbstractSet[Path]]) -> None:
        self._includes = includes
        self._component = _find_components(includes)
        self._includers: list[set[int]] = [set() for _ in range(1 + max(self._component.values(), default=-1))]
        for path, inner in includes.items():
            number = self._component[path]
            for other in inner:
                if self._component[other] != number:
                    self._includers[self._component[other]].add(number)

    def is_included(self, path: Path) -> bool:
        """Whether a file outside its circle includes this one: in a circle every file is a model."""
        return bool(self._includers[self._component[path]]) if path in self._component else False

    def make_user_table(self, models: Sequence[Path]) -> UserTable:
        """Return which of these models include which files."""
        # Components are numbered from the included to the including: those that include one have higher numbers.
        users = [0] * len(self._includers)
        for index, model in enumerate(models):
            if model in self._component:
                users[self._component[model]] |= 1 << index
        for number in reversed(range(len(users))):
            for includer in self._includers[number]:
                users[number] |= users[includer]
        return UserTable(self._component, users)


class UserTable:
    """The models that include each file, directly or through others, and each model itself: a bit for each model."""

    def __init__(self, component: Mapping[Path, int], users: Sequence[int]) -> None:
        self._component = component
        self._users = users

    def find_users(self, files: Iterable[Path]) -> int:
        """Return the models that any of these files belongs to, as bits."""
        found = 0
        for number in {self._component[file] for file in files if file in self._component}:
            found |= self._users[number]
        return found


def iter_bits(bits: int) -> Iterator[int]:
    """Yield the places of the bits that are set, lowest first."""
    while bits:
        lowest = bits & -bits
        yield lowest.bit_length() - 1
        bits ^= lowest


def _find_components(includes: Mapping[Path, AbstractSet[Path]]) -> dict[Path, int]:
    """Return the strongly connected component of each file; an included file has a lower number than one that includes it.

    R. Tarjan, *Depth-first search and linear graph algorithms*, SIAM J. Comput. 1 (1972), without calls for each level.
    """
    order: dict[Path, int] = {}
    lowest: dict[Path, int] = {}
    component: dict[Path, int] = {}
    open_files: list[Path] = []
    count = 0
    for start in includes:
        if start in order:
            continue
        stack = [(start, iter(includes[start]))]
        order[start] = lowest[start] = len(order)
        open_files.append(start)
        while stack:
            path, rest = stack[-1]
            inner = next(rest, None)
            if inner is None:
                stack.pop()
                if stack:
                    around = stack[-1][0]
                    lowest[around] = min(lowest[around], lowest[path])
                if lowest[path] == order[path]:
                    while True:
                        member = open_files.pop()
                        component[member] = count
                        if member == path:
                            break
                    count += 1
            elif inner not in order:
                order[inner] = lowest[inner] = len(order)
                open_files.append(inner)
                stack.append((inner, iter(includes.get(inner, ()))))
            elif inner not in component:
                lowest[path] = min(lowest[path], order[inner])
    return component
