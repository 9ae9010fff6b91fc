"""Names that do not exist, and those that may have been meant."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable

# How alike a name is to one that it is a slip of. `leftThumbMotorRoll` may mean `leftThumbRoll`, which is worth a question;
# they are 0.84 alike, and of parts of one robot many are.
SLIP_LIKENESS = 0.85
_DIGITS = re.compile(r"\d")
_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+|[^\W\d_A-Za-z]+")


def find_nearest_name(name: str, known: Iterable[str], likeness: float = 0.75) -> str | None:
    """The known name that is spelled most like ``name``, None when none is (1 is equal, 0.75 shares most letters).

    A name that differs in its digits only is another part of the same kind, not another spelling.
    """
    letters = _DIGITS.sub("", name)
    candidates = sorted(other for other in set(known) - {""} if _DIGITS.sub("", other) != letters)
    close = difflib.get_close_matches(name, candidates, n=1, cutoff=likeness)
    return close[0] if close else None


def find_only_near_name(name: str, known: Iterable[str], likeness: float = 0.75) -> str | None:
    """The known name that is spelled like ``name`` where it is the only one: what an edit may write."""
    near = find_nearest_name(name, known, likeness)
    return None if near is None or find_nearest_name(name, set(known) - {near}, likeness) else near


def format_name_hint(name: str, known: Iterable[str]) -> str:
    """`` (did you mean 'x'?)`` for the end of a message, or nothing."""
    close = find_nearest_name(name, known)
    return f" (did you mean {close!r}?)" if close else ""


def join_names(names: Iterable[str], most: int = 6) -> str:
    """Join names as in ``a, b, c and 4 more``."""
    names = list(names)
    shown = ", ".join(names[:most])
    return f"{shown} and {len(names) - most} more" if len(names) > most else shown


def split_name_words(name: str) -> list[str]:
    """``LShoulder_pitch2`` as L, Shoulder, pitch, 2: camel case, digits and punctuation part them."""
    return _WORD.findall(name)
