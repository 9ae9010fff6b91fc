"""Reading numbers of URDF attributes exactly as strictly as the reference parser does."""

from __future__ import annotations

import math
import re
from functools import lru_cache

from urdfcheck.source.text.xml import Attribute, Element

# What urdfdom's locale-independent conversion takes in full; Python's float() takes more (1_000, infinity, nan).
DECIMAL = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)

# Lengths, masses and inertias beyond this are in no robot, and five of them multiplied (a volume times a squared length)
# are still a double; so are five of its inverse.
MAX_MAGNITUDE = 1e50


@lru_cache(maxsize=1 << 16)
def parse_number(text: str) -> float | None:
    """A finite number as URDF spells it, else None. Every rule asks for the same few thousand."""
    stripped = text.strip()
    if not DECIMAL.fullmatch(stripped):
        return None
    value = float(stripped)
    return value if math.isfinite(value) else None


def is_computable(value: float) -> bool:
    """Whether products and quotients of such numbers stay within the range of a double."""
    return value == 0 or 1 / MAX_MAGNITUDE <= abs(value) <= MAX_MAGNITUDE


def parse_numbers(text: str, count: int) -> tuple[float, ...] | None:
    """Exactly ``count`` finite numbers separated by white space, else None."""
    values = [parse_number(word) for word in text.split()]
    if len(values) != count or any(v is None for v in values):
        return None
    return tuple(v for v in values if v is not None)


def read_attribute_number(element: Element | None, name: str) -> float | None:
    """The number of an attribute; None when the element, the attribute or a number is not there."""
    attribute = element.attributes.get(name) if element is not None else None
    return None if attribute is None else parse_number(attribute.value)


def read_attribute_numbers(
    element: Element | None, name: str, count: int, default: tuple[float, ...]
) -> tuple[float, ...] | None:
    """The numbers of an attribute, ``default`` when it is absent, None when it is malformed."""
    attribute: Attribute | None = element.attributes.get(name) if element is not None else None
    return default if attribute is None else parse_numbers(attribute.value, count)
