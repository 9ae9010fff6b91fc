"""Which lines differ between the files of two versions, and which of these lines caused which change."""

from __future__ import annotations

import difflib
import os
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence

from urdfcheck.core import NEWLINE, Span
from urdfcheck.core.mechanism import MechanismCondition, RobotMechanism, Trace
from urdfcheck.core.model_diff import ChangeCause, MechanismChange
from urdfcheck.core.records import dataclass

# Lines of one cause that are shown of either version.
MOST_LINES = 6
# Above this number of pairs of lines the comparison of two texts takes common lines for noise, or seconds.
_MOST_PAIRS = 4_000_000
# Characters of a line that are kept.
_MOST_CHARACTERS = 500

_CHOICE = re.compile(r"\$\(arg\b|<xacro:(?:arg|if|unless)\b")

# A line of a file.
Line = tuple[str, int]


@dataclass(frozen=True, slots=True)
class EditedLines:
    """The lines of either version that are not in the other, indentation apart, by file."""

    before: Mapping[str, frozenset[int]]
    after: Mapping[str, frozenset[int]]


@dataclass(frozen=True, slots=True, kw_only=True)
class SideTexts:
    """The texts of one version."""

    texts: Mapping[str, str]
    """By the names that spans call the files."""
    folder: str
    """Where this version is: files of two versions with one path from there are versions of one file."""
    main_file: str
    conditions: Sequence[MechanismCondition] = ()
    """See `RobotMechanism.conditions`."""

    @classmethod
    def of_model(cls, mechanism: RobotMechanism, texts: Mapping[str, str], folder: str) -> SideTexts:
        """Return the texts that a model was made of."""
        return cls(texts=texts, folder=folder, main_file=mechanism.main_file, conditions=mechanism.conditions)


def find_edited_lines(before: SideTexts, after: SideTexts) -> EditedLines:
    """Compare the files of two versions; a file of one version only is edited as a whole."""
    pairs = dict(_pair_files(before, after))
    olds: dict[str, frozenset[int]] = {}
    news: dict[str, frozenset[int]] = {}
    for old, new in pairs.items():
        olds[old], news[new] = _compare_lines(before.texts[old], after.texts[new])
    for texts, paired, found in ((before.texts, set(pairs), olds), (after.texts, set(pairs.values()), news)):
        for name in texts.keys() - paired:
            found[name] = frozenset(range(1, len(NEWLINE.split(texts[name])) + 1))
    return EditedLines(olds, news)


def _pair_files(before: SideTexts, after: SideTexts) -> Iterator[tuple[str, str]]:
    """Yield the files that are two versions of one: the models themselves, equal paths, then names that occur once."""
    olds, news = dict.fromkeys(before.texts), dict.fromkeys(after.texts)
    if before.main_file in olds and after.main_file in news:
        del olds[before.main_file], news[after.main_file]
        yield before.main_file, after.main_file
    for make_key in (_make_relative, lambda name, _: os.path.basename(name)):
        by_key = {make_key(name, after.folder): name for name in news}
        counts = Counter(make_key(name, after.folder) for name in news)
        counts_before = Counter(make_key(name, before.folder) for name in olds)
        for name in list(olds):
            key = make_key(name, before.folder)
            if counts[key] == 1 and counts_before[key] == 1:
                del olds[name], news[by_key[key]]
                yield name, by_key[key]


def _make_relative(name: str, folder: str) -> str:
    try:
        return os.path.relpath(name, folder)
    except ValueError:  # another drive
        return name


def _compare_lines(before: str, after: str) -> tuple[frozenset[int], frozenset[int]]:
    """Return the numbers of the lines of two texts that are not in the other."""
    old, new = ([line.strip() for line in NEWLINE.split(text)] for text in (before, after))
    start = 0
    while start < min(len(old), len(new)) and old[start] == new[start]:
        start += 1
    end = 0
    while end < min(len(old), len(new)) - start and old[-1 - end] == new[-1 - end]:
        end += 1
    first, second = old[start : len(old) - end], new[start : len(new) - end]
    if len(first) * len(second) > _MOST_PAIRS:
        known_old, known_new = set(first), set(second)
        return (
            frozenset(start + 1 + n for n, line in enumerate(first) if line not in known_new),
            frozenset(start + 1 + n for n, line in enumerate(second) if line not in known_old),
        )
    gone: set[int] = set()
    came: set[int] = set()
    for what, a, b, c, d in difflib.SequenceMatcher(None, first, second, autojunk=False).get_opcodes():
        if what != "equal":
            gone.update(range(start + a + 1, start + b + 1))
            came.update(range(start + c + 1, start + d + 1))
    return frozenset(gone), frozenset(came)


def list_idle_edits(
    edited: EditedLines, mechanisms: tuple[RobotMechanism, RobotMechanism], texts: tuple[SideTexts, SideTexts]
) -> tuple[tuple[str, int, str], ...]:
    """Return file, line and text of the edited tags of which a version's robot has nothing, those of the second version first."""
    found: list[tuple[str, int, str]] = []
    for mechanism, lines, side in (
        (mechanisms[1], edited.after, texts[1]),
        (mechanisms[0], edited.before, texts[0]),
    ):
        for name, idle in mechanism.idle_lines.items():
            numbers = [(name, number) for number in sorted(idle & lines.get(name, frozenset()))]
            found += _quote_lines(numbers, side.texts)
    return tuple(found)


def has_edited_choices(edited: EditedLines, before: SideTexts, after: SideTexts) -> bool:
    """Whether an edited line reads an argument or is a condition: with other arguments it may make another robot."""
    return any(
        _CHOICE.search(NEWLINE.split(side.texts[name])[number - 1])
        for side, lines in ((before, edited.before), (after, edited.after))
        for name, numbers in lines.items()
        for number in numbers
    )


def find_causes(
    changes: Sequence[MechanismChange], edited: EditedLines, before: SideTexts, after: SideTexts
) -> tuple[ChangeCause, ...]:
    """Group changes by the lines that caused them, in the order of the changes.

    Of the lines that a value was computed from those count that were edited; where none of those was, the calls that brought it
    in, and then the conditions around both, with the properties and arguments that they read. Where nothing was edited, the value
    is shown where it is typed: a mesh file or an argument changed.
    """
    groups: dict[tuple[tuple[Line, ...], tuple[Line, ...], bool], list[int]] = {}
    for index, change in enumerate(changes):
        sides = ((change.before, edited.before), (change.after, edited.after))
        old, new = (_select_edited(trace.places, lines) for trace, lines in sides)
        if not old and not new:
            old, new = (_select_edited(trace.calls, lines) for trace, lines in sides)
        if not old and not new:
            old, new = (
                _select_edited(_list_conditions(trace, texts.conditions), lines)
                for (trace, lines), texts in zip(sides, (before, after), strict=True)
            )
        is_edited = bool(old or new)
        if not is_edited:
            old, new = (_list_lines(trace.places[:1])[:1] for trace, _ in sides)
        groups.setdefault((tuple(old), tuple(new), is_edited), []).append(index)
    return tuple(
        ChangeCause(
            before=tuple(_quote_lines(old[:MOST_LINES], before.texts)),
            after=tuple(_quote_lines(new[:MOST_LINES], after.texts)),
            changes=tuple(indices),
            is_edited=is_edited,
        )
        for (old, new, is_edited), indices in groups.items()
        if old or new
    )


def _list_conditions(trace: Trace, conditions: Sequence[MechanismCondition]) -> Iterator[Span]:
    """Yield the tags of the conditions in which the places and calls of a trace are typed, and of what these read."""
    for span in (*trace.places, *trace.calls):
        for condition in conditions:
            tag = condition.tag
            if tag.file == span.file and tag.line <= span.line <= condition.end:
                yield from (tag, *condition.definitions)


def _select_edited(spans: Iterable[Span], edited: Mapping[str, frozenset[int]]) -> list[Line]:
    return [line for line in _list_lines(spans) if line[1] in edited.get(line[0], ())]


def _list_lines(spans: Iterable[Span]) -> list[Line]:
    lines = ((span.file, number) for span in spans for number in range(span.line, span.end_line + 1))
    return list(dict.fromkeys(lines))


def _quote_lines(lines: Sequence[Line], texts: Mapping[str, str]) -> Iterator[tuple[str, int, str]]:
    for name, number in lines:
        split = NEWLINE.split(texts.get(name, ""))
        text = split[number - 1].strip() if number <= len(split) else ""
        yield name, number, text[:_MOST_CHARACTERS]
