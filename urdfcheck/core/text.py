"""Names, counts, numbers and lengths as messages write them, and the name that a misspelt one may mean."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Collection, Iterable, Mapping

# A name this much like another is a slip of it. `leftThumbMotorRoll` may mean `leftThumbRoll`, which is worth a question, but
# their likeness is 0.84, as between many parts of one robot.
SLIP_LIKENESS = 0.85
# What stands in a proposed command in place of a value that nobody but the user knows.
TO_FILL_IN = "…"
# How a repair names the numbers that its edits write.
COMPUTED_NUMBERS = "the computed numbers"
_SIDES = frozenset({"l", "left", "r", "right"})
# From so many times on, a share is told as a factor.
_MANY_TIMES = 10
_DIGITS = re.compile(r"\d")
_LONG_DECIMAL = re.compile(r"(?<![\w.])-?\d+\.\d{8,}(?:[eE][+-]?\d+)?(?![\w.…])")
# Names that are looked at for a spelling, and the share of letters that two spellings of one word have in common: `lite` and
# `light` 0.67, `whl` and `wheel` 0.75; of other words, `camera` and `camera optical` 0.63.
_MOST_ALIKE = 5
# Few slips change the first letter: `laser` is not `base` (0.67).
_SAME_WORD, _SAME_BUT_FIRST_LETTER = 0.65, 0.8
_KINDS = frozenset({"joint", "link"})
# Words that say which of several parts of one kind is meant.
_PLACES = frozenset({
    *("left", "right", "front", "rear", "back", "middle", "mid", "center", "centre", "top", "bottom", "upper", "lower"),
    *("inner", "outer", "inside", "outside", "proximal", "distal", "medial", "lateral", "x", "y", "z"),
    *("fl", "fr", "rl", "rr", "bl", "br", "lf", "rf", "lh", "rh", "hl", "hr", "lr", "lb", "rb"),
})  # fmt: skip
_SAME_PLACE = {"l": "left", "r": "right", "back": "rear", "mid": "middle", "centre": "center"}
_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+|[^\W\d_A-Za-z]+")


def find_nearest_name(name: str, known: Iterable[str], likeness: float = 0.75) -> str | None:
    """Return the known name that is spelled most like ``name``, or None (likeness 1 is equal, 0.75 shares most letters).

    A name that differs only in its digits is another part of the same kind, not another spelling; one with other sides is a
    part elsewhere: ``r_gripper_palm`` is not ``r_gripper_l_finger``. Nor is a name with another word a spelling:
    ``front_left_calf`` is not ``front_left_foot``, however many letters they share. Nor is one at another place, or at a place
    that the other does not name: ``front_right_caster`` is neither ``rear_right_caster`` nor ``right_caster``. A name that lacks
    a word of several others names none of them: ``right_wheel`` beside ``front_right_wheel`` and ``rear_right_wheel``. However
    short, ``left_hip`` is ``left_hip_joint``.
    """
    known, sides = list(known), _find_sides(name)
    same = [other for other in known if other != name and _is_same_but_kind(name, other)]
    if len(same) == 1:
        return same[0]
    same_side = (o for o in known if not sides or _find_sides(o) in (set(), sides))
    spellings = [o for o in _list_similar_names(name, same_side, likeness) if not _has_other_word(name, o)]
    is_one_of_several = len(spellings) > 1 and all(_count_words(name) < _count_words(other) for other in spellings[:2])
    return spellings[0] if spellings and not is_one_of_several else None


def _is_same_but_kind(name: str, other: str) -> bool:
    """Whether one of two names has the words of the other, and perhaps one that says what is named."""
    ours, theirs = _count_words(name), _count_words(other)
    only_ours, only_theirs = set(ours - theirs), set(theirs - ours)
    return not (only_ours and only_theirs) and only_ours | only_theirs <= _KINDS


def _list_similar_names(name: str, known: Iterable[str], likeness: float) -> list[str]:
    """List the names with most letters in common, on whatever side, the most similar first."""
    letters = _DIGITS.sub("", name)
    candidates = sorted(other for other in set(known) - {""} if _DIGITS.sub("", other) != letters)
    import difflib  # few names are misspelt

    return difflib.get_close_matches(name, candidates, n=_MOST_ALIKE, cutoff=likeness)


def _has_other_word(name: str, other: str) -> bool:
    """Whether a name has words that the other one lacks, and these are places, or not spellings of what only the other has."""
    import difflib

    ours, theirs = _count_words(name), _count_words(other)
    words, other_words = list((ours - theirs).elements()), list((theirs - ours).elements())
    places, other_places = _count_places(words), _count_places(other_words)
    # A number that only one of them has may be a version of a file.
    is_elsewhere = any(not place.isdigit() for place in places - other_places) and not other_words
    if is_elsewhere or (places - other_places and other_places - places):
        return True
    only_ours, only_theirs = "".join(words), "".join(other_words)
    if not only_ours or not only_theirs:
        return False
    least = _SAME_WORD if only_ours[0] == only_theirs[0] else _SAME_BUT_FIRST_LETTER
    return difflib.SequenceMatcher(None, only_ours, only_theirs).ratio() < least


def _count_words(name: str) -> Counter[str]:
    """Count the words of a name, those that are places in one spelling: ``l`` is ``left``."""
    words = map(str.lower, split_name_words(name))
    return Counter(_SAME_PLACE.get(word, word) for word in words)


def _count_places(words: Iterable[str]) -> Counter[str]:
    """Count the words that are places: a number too says which of several parts is meant."""
    return Counter(
        word.lstrip("0") or "0" if word.isdigit() else word for word in words if word in _PLACES or word.isdigit()
    )


def _find_sides(name: str) -> set[str]:
    """Return the sides that a name has as words of their own: ``l`` for left, ``r`` for right."""
    return {word[0] for word in map(str.lower, split_name_words(name)) if word in _SIDES}


def find_only_near_name(name: str, known: Iterable[str], likeness: float = 0.75) -> str | None:
    """Return the known name that is spelled like ``name`` if it is the only one: an edit may write it.

    One that has a word more or less was not mistyped: ``arm_wrist_link`` is a link that was renamed, or another one.
    """
    near = find_nearest_name(name, known, likeness)
    if near is None or _list_similar_names(name, set(known) - {near}, likeness):
        return None
    ours, theirs = _count_words(name), _count_words(near)
    is_slip = bool(ours - theirs) == bool(theirs - ours) or _is_same_but_kind(name, near)
    return near if is_slip else None


def format_name_hint(name: str, known: Iterable[str]) -> str:
    """Return `` (did you mean 'x'?)`` for the end of a message, or nothing."""
    close = find_nearest_name(name, known)
    return f" (did you mean {close!r}?)" if close else ""


def compile_names(names: Iterable[str]) -> re.Pattern[str]:
    """Compile a pattern of these names, each as a whole word: ``arm.urdf`` is not in ``left_arm.urdf`` or ``arm.urdf.xacro``."""
    return re.compile(rf"(?<![\w.-])(?:{'|'.join(map(re.escape, names))})(?![\w.-])")


def join_names(names: Iterable[str], most: int = 6) -> str:
    """Return ``a, b, c and 4 more``."""
    names = list(names)
    shown = ", ".join(names[:most])
    return f"{shown} and {len(names) - most} more" if len(names) > most else shown


def spell_breaks(name: str) -> str:
    """Return a name with its tabs and line breaks spelled ``\\t`` and ``\\n``: shown as they are, they look like blanks."""
    return name.replace("\t", r"\t").replace("\n", r"\n").replace("\r", r"\r")


def split_name_words(name: str) -> list[str]:
    """Split ``LShoulder_pitch2`` into L, Shoulder, pitch, 2: at camel case, digits and punctuation."""
    return _WORD.findall(name)


def format_count(count: int, one: str, many: str | None = None) -> str:
    """Return ``1 joint has`` or ``3 joints have``; ``many`` is ``one`` with an s by default."""
    return f"1 {one}" if count == 1 else f"{count} {one + 's' if many is None else many}"


def format_repetition(count: int) -> str:
    """Return `` (3 times)`` for the end of a message, or nothing for a single occurrence."""
    return "" if count == 1 else f" ({count} times)"


def join_numbers(values: Iterable[float], *, digits: int = 6, separator: str = ", ") -> str:
    """Return ``0.25, 0.25, 0.5``: numbers of so many significant digits."""
    return separator.join(f"{value:.{digits}g}" for value in values)


def format_point(values: Iterable[float], *, decimals: int) -> str:
    """Return ``0.1 0 -0.25``: coordinates to so many decimals, without a minus sign before zero."""
    return " ".join(f"{round(float(value), decimals) + 0.0:g}" for value in values)


def format_box_size(edges: Iterable[float], *, digits: int = 3) -> str:
    """Return ``0.4 × 0.3 × 0.1 m``."""
    return f"{join_numbers(edges, digits=digits, separator=' × ')} m"


def format_length(metres: float, *, digits: int = 3, micrometres: bool = False) -> str:
    """Return ``1.2 m`` or ``35 mm``; with ``micrometres``, ``40 µm`` below a millimetre."""
    if metres >= 1.0:
        return f"{metres:.{digits}g} m"
    if metres * 1e3 >= 1.0 or not micrometres:
        return f"{metres * 1e3:.{digits}g} mm"
    return f"{metres * 1e6:.{digits}g} µm"


def format_large_count(count: int, one: str) -> str:
    """Return ``1 edge`` or ``12,345 edges``."""
    return f"{count:,} {one if count == 1 else one + 's'}"


def truncate_text(text: str, most: int) -> str:
    """Return a text, or its beginning and ``...`` if it has more than ``most`` characters."""
    return text if len(text) <= most else text[: most - 3] + "..."


def round_decimals(text: str) -> str:
    """Return a text in which numbers have at most ten significant digits: 0.32 for 0.32000000000000006."""
    return _LONG_DECIMAL.sub(lambda number: f"{float(number[0]):.10g}", text)


def format_choices(values: Collection[str], most: int = 6) -> str:
    """Return ``; known values: a, b and 2 more``; empty without values."""
    return f"; known value{'' if len(values) == 1 else 's'}: {join_names(values, most)}" if values else ""


def format_argument_option(name: str, value: str | None = None) -> str:
    """Return ``--arg name:=value`` quoted for a shell, as names and values are a stranger's; ``…`` is to be filled in."""
    import shlex

    return f"--arg {shlex.quote(name)}:={TO_FILL_IN}" if value is None else f"--arg {shlex.quote(f'{name}:={value}')}"


def format_percent(share: float) -> str:
    """Return ``4.9 %`` of 0.049, and ``167 %`` without an exponent."""
    percent = share * 100
    return f"{percent:.2g} %" if abs(percent) < 99.5 else f"{percent:,.0f} %"


def format_share(before: float, after: float) -> str:
    """Return `` (+4.9 %)``, or `` (12 times)`` of what grows much; nothing where there is no share."""
    if not before:
        return ""
    ratio = after / before
    if ratio >= _MANY_TIMES:
        return f" ({ratio:.3g} times)" if ratio < 999.5 else f" ({ratio:,.0f} times)"
    share = (after - before) / abs(before)
    return f" ({'+' if share > 0.0 else ''}{format_percent(share)})"


def format_angle(radians: float) -> str:
    """Return an angle in degrees."""
    return f"{math.degrees(radians):.3g}°"


def format_configuration(positions: Mapping[str, float], most: int = 4) -> str:
    """Return the joint positions that are not zero, in the order of the chain."""
    moved = [f"{name} {value:.3g}" for name, value in positions.items() if abs(value) > 1e-9]
    return join_names(moved, most) or "zero"
