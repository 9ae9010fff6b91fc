"""The places of one name: all that have to be changed together."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from urdfcheck.core import Span
from urdfcheck.export.index.source_index import PARAMETER, YAML_KEY, NamePlace, SourceIndex

# Kind, name, and where it is known: the macro of a property, the declaration of a parameter or a key; None for all others.
_Key = tuple[str, str, Span | None]


def find_same_names(indexes: Sequence[SourceIndex], seeds: Iterable[NamePlace]) -> list[tuple[int, NamePlace]]:
    """Return the places that have the names of some places, each with the number of its index.

    Of other models count only those that share a place with them: the same name in another robot is another name.
    """
    seeds = list(seeds)
    keys = _connect_keys(indexes, {key for seed in seeds for key in _list_keys(seed)})
    candidates = [[place for place in index.names if keys.intersection(_list_keys(place))] for index in indexes]
    spans = {seed.span for seed in seeds}
    joined: set[int] = set()
    while further := [
        number
        for number, places in enumerate(candidates)
        if number not in joined and any(place.span in spans for place in places)
    ]:
        joined.update(further)
        spans.update(place.span for number in further for place in candidates[number])
    return [(number, place) for number in sorted(joined) for place in candidates[number]]


def _list_keys(place: NamePlace) -> list[_Key]:
    if place.kind in {PARAMETER, YAML_KEY}:
        return [(place.kind, place.name, span) for span in ((place.span,) if place.is_definition else place.targets)]
    return [(place.kind, place.name, place.scope)]


def _connect_keys(indexes: Sequence[SourceIndex], wanted: set[_Key]) -> set[_Key]:
    """Return these keys and all that a text connects them with: it may read the property of one macro or of another, and in
    each robot the key of another yaml file."""
    names = {(kind, name) for kind, name, _ in wanted}
    places = [place for index in indexes for place in index.names if (place.kind, place.name) in names]
    defined = {place.span: key for place in places if place.is_definition for key in _list_keys(place)}
    by_text: dict[Span, set[_Key]] = {}
    for place in places:
        meant = (defined[span] for span in place.targets if span in defined)
        by_text.setdefault(place.span, set()).update(_list_keys(place), meant)
    groups = [set(group) for group in {frozenset(group) for group in by_text.values() if len(group) > 1}]
    while touched := [group for group in groups if group & wanted and not group <= wanted]:
        for group in touched:
            wanted = wanted | group
    return wanted
