"""Names that do not exist, and those that may have been meant."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable

_DIGITS = re.compile(r"\d")


def nearest(name: str, known: Iterable[str], likeness: float = 0.75) -> str | None:
    """The known name that is spelled most like ``name``, None when none is (1 is equal, 0.75 shares most letters).

    A name that differs in its digits only is another part of the same kind, not another spelling.
    """
    letters = _DIGITS.sub("", name)
    candidates = sorted(other for other in set(known) - {""} if _DIGITS.sub("", other) != letters)
    close = difflib.get_close_matches(name, candidates, n=1, cutoff=likeness)
    return close[0] if close else None


def hint(name: str, known: Iterable[str]) -> str:
    """`` (did you mean 'x'?)`` for the end of a message, or nothing."""
    close = nearest(name, known)
    return f" (did you mean {close!r}?)" if close else ""


def listed(names: Iterable[str], most: int = 6) -> str:
    """``a, b, c and 4 more``."""
    names = list(names)
    shown = ", ".join(names[:most])
    return f"{shown} and {len(names) - most} more" if len(names) > most else shown
