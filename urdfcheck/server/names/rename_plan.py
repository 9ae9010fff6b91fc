"""From a place and a new text to the edits that give everything there its new name."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import field
from pathlib import Path

from urdfcheck.core import Edit, Span
from urdfcheck.core.records import dataclass
from urdfcheck.export.index.source_index import ARGUMENT, MACRO, YAML_KEY, DoubtfulName, NamePlace, SourceIndex
from urdfcheck.server.check_messages import RenameWish
from urdfcheck.server.names.name_groups import find_same_names
from urdfcheck.server.names.new_names import (
    RENAMED_KINDS,
    ROBOT_KINDS,
    explain_invalid_name,
    explain_taken_name,
)
from urdfcheck.source.text.tokens import build_rename_edits
from urdfcheck.source.text.xml import SourceFile, XmlError, parse_xml

NOTHING_HERE = "There is no name here that can be renamed."
# A substitution of xacro or of a launch file.
_SUBSTITUTION = re.compile(r"\$\{[^}]*\}|\$\([^()]*(?:\([^()]*\)[^()]*)*\)")


class RenameRefusedError(Exception):
    """A name is not changed; the text is a sentence for the person who asked."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RenamePlan:
    """The edits of a renaming, and what they are meant to change."""

    edits: tuple[Edit, ...]
    names: Mapping[tuple[str, str], str] = field(default_factory=dict)
    """Kind and old name of each part of the robot or key of yaml that gets a new name; empty for the names of xacro."""
    models: frozenset[str] = frozenset()
    """The models in which it does: another may have a part of the same name."""
    arguments: Mapping[str, str] = field(default_factory=dict)
    """Old name of each argument that gets a new one: ids of models that a launch file starts may have it."""
    doubtful: tuple[DoubtfulName, ...] = ()
    """Texts that are left as they are, because they may be something else."""
    untried: tuple[str, ...] = ()
    """The models that could not be expanded before, so that they show nothing; each edit was tried in another."""


def find_renamed_part(typed: str, offset: int) -> tuple[int, int] | None:
    """Return which part of a typed name is renamed at an offset in it: the literal one around; None in a substitution."""
    start = 0
    for match in (*_SUBSTITUTION.finditer(typed), None):
        end = len(typed) if match is None else match.start()
        if start <= offset <= end and start < end:
            return start, end
        start = end if match is None else match.end()
    return None


def plan_rename(wish: RenameWish, indexes: Sequence[SourceIndex], texts: Mapping[str, SourceFile]) -> RenamePlan:
    """Plan a renaming in the models of these indexes. ``texts``: their files, by name.

    :raises RenameRefusedError: if it cannot be done by editing text.
    """
    seeds = _find_seeds(wish, indexes)
    kinds = {seed.kind for seed in seeds}
    if len(kinds) > 1:
        raise RenameRefusedError(f"This text names {' and '.join(f'a {kind}' for kind in sorted(kinds))} at once.")
    (kind,) = kinds
    names = _choose_names(wish, seeds, texts)
    for new in names.values():
        reason = explain_invalid_name(kind, new)
        if reason:
            raise RenameRefusedError(reason)
    found = find_same_names(indexes, seeds)
    affected = [indexes[number] for number in sorted({number for number, _ in found})]
    mappings = {place.scope for _, place in found if place.is_definition}
    for old, new in names.items():
        reason = explain_taken_name(affected, kind, new, mappings) if old != new else ""
        if reason:
            raise RenameRefusedError(reason)
    places = dict.fromkeys(place for _, place in found if not place.is_handed)
    doubtful = tuple(
        dict.fromkeys(
            text for index in affected for text in index.doubtful_names if text.kind == kind and text.name in names
        )
    )
    if kind in ROBOT_KINDS:
        edits = _build_part_edits(places, names, affected, texts)
        edited = {edit.span for edit in edits}
        return RenamePlan(
            edits=edits,
            names={(kind, old): new for old, new in names.items()},
            models=frozenset(index.model for index in affected),
            doubtful=tuple(text for text in doubtful if text.span not in edited),
        )
    (new,) = names.values()
    # A place may be known for what it reads in one model and in another.
    edits = tuple(dict.fromkeys(_iter_xacro_edits(places, new, texts)))
    arguments = {seed.name: new for seed in seeds} if kind == ARGUMENT else {}
    keys = {(kind, old): new for old, new in names.items()} if kind == YAML_KEY else {}
    return RenamePlan(edits=edits, names=keys, arguments=arguments, doubtful=doubtful)


def _find_seeds(wish: RenameWish, indexes: Sequence[SourceIndex]) -> list[NamePlace]:
    """Return the names at the place: those with the shortest text around it."""
    found = [
        place
        for index in indexes
        for place in index.names
        if place.span.start <= wish.offset <= place.span.end and os.path.realpath(place.span.file) == wish.path
    ]
    shortest = min((place.span.end - place.span.start for place in found), default=0)
    seeds = [place for place in found if place.span.end - place.span.start == shortest]
    if not seeds or any(seed.kind not in RENAMED_KINDS for seed in seeds):
        raise RenameRefusedError(NOTHING_HERE)
    return seeds


def _choose_names(wish: RenameWish, seeds: Sequence[NamePlace], texts: Mapping[str, SourceFile]) -> dict[str, str]:
    """Return the new name of each name that a text makes."""
    span = seeds[0].span
    typed = texts[span.file].text[span.start : span.end]
    part = find_renamed_part(typed, wish.offset - span.start)
    if part is None:
        raise RenameRefusedError(f"`{typed}` is computed: rename the text that it is made of.")
    before, after = typed[: part[0]], typed[part[1] :]
    if not before and not after:
        return {seed.name: wish.text for seed in seeds}
    pattern = re.compile(
        f"({_match_substitutions(before)}){re.escape(typed[part[0] : part[1]])}({_match_substitutions(after)})"
    )
    names = {}
    for seed in seeds:
        match = pattern.fullmatch(seed.name)
        if match is None:
            raise RenameRefusedError(f"`{typed}` is not what `{seed.name}` is made of.")
        names[seed.name] = f"{match[1]}{wish.text}{match[2]}"
    return names


def _match_substitutions(typed: str) -> str:
    """Return the pattern of what a text with substitutions becomes."""
    return ".*".join(re.escape(literal) for literal in _SUBSTITUTION.split(typed))


# -- links, joints and materials ---------------------------------------------------------------------------------------


def _build_part_edits(
    places: Iterable[NamePlace],
    names: Mapping[str, str],
    indexes: Sequence[SourceIndex],
    texts: Mapping[str, SourceFile],
) -> tuple[Edit, ...]:
    edits: dict[Span, Edit] = {}
    for place in places:
        edit = _build_part_edit(place, names[place.name], texts)
        if edits.setdefault(place.span, edit) != edit:
            raise RenameRefusedError(f"`{edit.expected}` ({_format_place(place)}) would need two different texts.")
    kinds = {place.kind for place in places}
    for other in (place for index in indexes for place in index.names if place.kind in kinds and not place.is_handed):
        if other.span in edits and other.name not in names:
            name = next(place.name for place in places if place.span == other.span)
            raise RenameRefusedError(
                f"`{name}` is made by `{edits[other.span].expected}` ({_format_place(other)}), which also makes "
                f"`{other.name}`: rename the text there."
            )
    return tuple(edits.values())


def _build_part_edit(place: NamePlace, new: str, texts: Mapping[str, SourceFile]) -> Edit:
    typed = texts[place.span.file].text[place.span.start : place.span.end]
    if typed.strip() == place.name:
        return Edit(place.span, typed, typed.replace(place.name, new))
    replaced = _replace_literal_part(typed, place.name, new)
    if replaced is None:
        raise RenameRefusedError(
            f"`{place.name}` is computed by `{typed}` ({_format_place(place)}), which cannot become `{new}`."
        )
    return Edit(place.span, typed, replaced)


def _replace_literal_part(typed: str, old: str, new: str) -> str | None:
    """Return a text with substitutions that makes a new name instead of the old one; None unless a literal end of it decides."""
    substitutions = list(_SUBSTITUTION.finditer(typed))
    if not substitutions:
        return None
    first, last = typed[: substitutions[0].start()], typed[substitutions[-1].end() :]
    if last and old.endswith(last) and new.startswith(old[: -len(last)]):
        return typed[: substitutions[-1].end()] + new[len(old) - len(last) :]
    if first and old.startswith(first) and new.endswith(old[len(first) :]):
        return new[: len(new) - len(old) + len(first)] + typed[substitutions[0].start() :]
    return None


# -- names of xacro ----------------------------------------------------------------------------------------------------


def _iter_xacro_edits(places: Iterable[NamePlace], new: str, texts: Mapping[str, SourceFile]) -> Iterator[Edit]:
    for place in places:
        file = texts[place.span.file]
        typed = file.text[place.span.start : place.span.end]
        if typed != place.name:
            raise RenameRefusedError(f"`{place.name}` is written as `{typed}` in {_format_place(place)}.")
        yield Edit(place.span, typed, new)
    called = {place.span for place in places if place.kind == MACRO and not place.is_definition}
    for name in {span.file for span in called}:
        yield from _iter_end_tag_edits(texts[name], called, new)


def _iter_end_tag_edits(file: SourceFile, called: Iterable[Span], new: str) -> Iterator[Edit]:
    """Yield the edits of the end tags of the calls at some places."""
    starts = {span.start for span in called if span.file == file.name}
    try:
        root = parse_xml(file)
    except XmlError:
        return
    for element in root.walk():
        prefix = element.tag.rpartition(":")[0] + ":"
        if element.span is None or element.span.start + 1 + len(prefix) not in starts:
            continue
        for edit in build_rename_edits([element], prefix + new, {file.name: file})[1:]:
            start = edit.span.start + len(prefix)
            yield Edit(file.make_span(start, edit.span.end), edit.expected[len(prefix) :], new)


def _format_place(place: NamePlace) -> str:
    return f"{Path(place.span.file).name}:{place.span.line}"
