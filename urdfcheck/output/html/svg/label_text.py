"""The width of the names in the drawings, and the shortening of long ones."""

from __future__ import annotations

import unicodedata

# Advance of a character, in px: names have a monospaced face at 12 px, 0.6 em wide in all common ones (DejaVu 0.602).
ADVANCE = 7.3
SMALL = 6.7  # at 11 px
LONGEST_NAME = 36


def count_columns(text: str) -> int:
    """Count the columns of a monospaced text, in which East Asian wide characters take two."""
    return sum(2 if unicodedata.east_asian_width(c) in "WF" else 1 for c in text)


def shorten_name(name: str) -> str:
    """Shorten a name in its middle, because names of links differ at both ends."""
    half = LONGEST_NAME // 2
    return name if len(name) <= LONGEST_NAME else f"{name[: half - 1]}…{name[-half:]}"
