"""Names that differ in nothing but the side: ``left_wheel`` and ``right_wheel``, ``LF_hip`` and ``RF_hip``."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from collections.abc import Set as AbstractSet
from itertools import combinations

from urdfcheck.core.text import split_name_words

# Words of a name: camel case, digits and punctuation separate them.
_WORDS = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+|[^A-Za-z\d]+")
_SIDES = re.compile(r"left|right", re.IGNORECASE)
_OTHER: Mapping[str, str] = {"left": "right", "right": "left", "l": "r", "r": "l"}
# A name with more words than this that could mean a side does not mean one.
_MOST = 4


# What a word of a name says of the place of a part that there is several times: sides, ends, and both in one.
_SIDE_WORDS = frozenset(
    {
        *("left", "right", "l", "r"),
        *(a + b for side in "lr" for end in "frbhm" for a, b in ((side, end), (end, side))),
    }
)
_PLACES = _SIDE_WORDS | {"front", "rear", "back", "hind", "middle", "f", "b", "h", "m"}


def remove_places(name: str) -> tuple[str, ...]:
    """Return the words of a name in lower case without those for its place: ``FL_thigh`` and ``RearRightThigh`` are one thigh.

    All words where no other is left.
    """
    words = tuple(word.lower() for word in split_name_words(name))
    return tuple(word for word in words if word not in _PLACES) or words


def names_side(name: str) -> bool:
    """Whether a word of a name says left or right, alone or with an end."""
    return any(word.lower() in _SIDE_WORDS for word in split_name_words(name))


def pair_by_name(names: Iterable[str]) -> Iterator[tuple[str, str]]:
    """Yield names that differ in nothing but the side, each pair once, in the order of the names.

    Where no such name is known, one that differs in what separates its words counts too: ``steerFL`` and ``steer_FR``.
    """
    all_names = list(names)
    index = {name: i for i, name in enumerate(all_names)}
    words = {word for name in all_names for word in _WORDS.findall(name)}
    others = {name: tuple(dict.fromkeys(_list_other_side_names(name, words))) for name in all_names}
    known = {name: [other for other in others[name] if other in index] for name in all_names}
    spelled: dict[tuple[str, ...], list[str]] = {}
    for name in all_names:
        if not known[name]:
            spelled.setdefault(_list_spelled_words(name), []).append(name)
    for name in all_names:
        if not known[name]:
            alike = (spelled.get(_list_spelled_words(other), []) for other in others[name])
            known[name] = [found[0] for found in alike if len(found) == 1]
        yield from ((name, other) for other in known[name] if index[other] > index[name])


def _list_spelled_words(name: str) -> tuple[str, ...]:
    """Return the words of a name without what separates them."""
    return tuple(word for word in _WORDS.findall(name) if word.isalnum())


def _list_other_side_names(name: str, known: AbstractSet[str]) -> Iterator[str]:
    """Yield what a name may be on the other side: every choice of its words for a side, each replaced by a ``known`` one."""
    words = _WORDS.findall(name)
    others = [[other for other in _list_other_side_words(word) if other in known] for word in words]
    places = [i for i, options in enumerate(others) if options]
    if len(places) > 2 * _MOST:
        return
    for count in range(1, min(len(places), _MOST) + 1):
        for chosen in combinations(places, count):
            choices = [""]
            for i, word in enumerate(words):
                options = others[i] if i in chosen else [word]
                choices = [before + option for before in choices for option in options]
            yield from choices


def _list_other_side_words(word: str) -> Iterator[str]:
    """Yield a word for the other side: ``left``, ``l``, ``lf``, ``fl``, ``larm``. The other name decides whether it means one."""
    if _SIDES.search(word):
        yield _SIDES.sub(lambda match: _match_case(_OTHER[match.group().lower()], match.group()), word)
        return
    for place in dict.fromkeys((0, len(word) - 1)):
        other = _OTHER.get(word[place].lower())
        if other is not None:
            yield word[:place] + _match_case(other, word[place]) + word[place + 1 :]


def _match_case(word: str, like: str) -> str:
    """Return the word in capitals, or with a capital, like the other."""
    if like.isupper():
        return word.upper()
    return word.capitalize() if like[0].isupper() else word
