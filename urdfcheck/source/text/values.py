"""Reading numbers of URDF attributes exactly as strictly as the reference parser does."""

from __future__ import annotations

import math
import re
from functools import lru_cache

from urdfcheck.source.text.xml import Attribute, Element

# The numbers that urdfdom's locale-independent conversion accepts; Python's float() accepts more (1_000, infinity, nan).
DECIMAL = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)

# No robot has lengths, masses or inertias beyond this, and a product of five of them (a volume times a squared length) is
# still within the range of a double; so is a product of five inverses.
MAX_MAGNITUDE = 1e50


@lru_cache(maxsize=1 << 16)
def parse_number(text: str) -> float | None:
    """Return a finite number as URDF spells it, else None. Cached: every rule reads the same few thousand."""
    stripped = text.strip()
    if not DECIMAL.fullmatch(stripped):
        return None
    value = float(stripped)
    return value if math.isfinite(value) else None


def is_computable(value: float) -> bool:
    """Whether products and quotients of such numbers stay within the range of a double."""
    return value == 0 or 1 / MAX_MAGNITUDE <= abs(value) <= MAX_MAGNITUDE


def parse_numbers(text: str, count: int) -> tuple[float, ...] | None:
    """Return exactly ``count`` finite numbers separated by white space, else None."""
    values = [parse_number(word) for word in text.split()]
    if len(values) != count or any(v is None for v in values):
        return None
    return tuple(v for v in values if v is not None)


def has_unskipped_blank(text: str, count: int) -> bool:
    """Whether urdfdom stops at white space: any after one number; of several, a tab or line break after one or between spaces.

    It splits several at spaces, and skips white space before a number only.
    """
    if count == 1:
        return text != text.rstrip()
    return any(not part.strip() or part != part.rstrip() or len(part.split()) > 1 for part in text.split(" ") if part)


def read_attribute_number(element: Element | None, name: str) -> float | None:
    """Return the number of an attribute; None if the element, the attribute or a number is missing."""
    attribute = element.attributes.get(name) if element is not None else None
    return None if attribute is None else parse_number(attribute.value)


def read_attribute_numbers(
    element: Element | None, name: str, count: int, default: tuple[float, ...]
) -> tuple[float, ...] | None:
    """Return the numbers of an attribute; ``default`` if it is absent, None if it is malformed."""
    attribute: Attribute | None = element.attributes.get(name) if element is not None else None
    return default if attribute is None else parse_numbers(attribute.value, count)
