"""Names as the drawings show them: how wide they are, and what of a long one is shown."""

from __future__ import annotations

import unicodedata

# The names are set in a monospaced face at 12 px, whose advance is 0.6 em in all common ones (DejaVu 0.602).
ADVANCE = 7.3
SMALL = 6.7  # the same at 11 px
LONGEST_NAME = 36


def count_columns(text: str) -> int:
    return sum(2 if unicodedata.east_asian_width(c) in "WF" else 1 for c in text)


def shorten_name(name: str) -> str:
    """A name that fits: the middle goes, because robots tell their links apart at both ends."""
    half = LONGEST_NAME // 2
    return name if len(name) <= LONGEST_NAME else f"{name[: half - 1]}…{name[-half:]}"
