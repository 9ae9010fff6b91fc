"""Numbers as typed: constants with missing digits, and noise in place of zero."""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import Decimal, InvalidOperation

from urdfcheck.core.records import dataclass

# A deviation of 1e-9 rad displaces a point one metre away by one nanometre, and the coordinates of published robots
# leave a gap between 1e-7 (noise) and 1e-5 (intended): below 1e-9 a number is exact, or zero.
EXACT = 1e-9

# Sloppy but unmistakable spellings of the two commonest constants, such as 1.57075, lie within this relative distance.
_SLOPPY = 6e-5

# Constant -> its value, the least number of decimals that distinguishes it from an ordinary number, and whether `_SLOPPY`
# applies. 0.52 or 0.79 may be intended; 0.524 or 0.785 may not.
_CONSTANTS: tuple[tuple[str, float, int, bool], ...] = (
    ("pi", math.pi, 2, True),
    ("pi/2", math.pi / 2, 2, True),
    ("3*pi/2", 3 * math.pi / 2, 2, False),
    ("2*pi", 2 * math.pi, 2, False),
    ("pi/3", math.pi / 3, 3, False),
    ("2*pi/3", 2 * math.pi / 3, 3, False),
    ("pi/4", math.pi / 4, 3, False),
    ("3*pi/4", 3 * math.pi / 4, 3, False),
    ("pi/6", math.pi / 6, 3, False),
    ("5*pi/6", 5 * math.pi / 6, 3, False),
    ("pi/8", math.pi / 8, 4, False),
    ("pi/12", math.pi / 12, 4, False),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class NearMiss:
    """A literal that means a fraction of π and has lost digits."""

    constant: str
    """With the literal's sign, such as ``-pi/2``."""
    exact: float
    """The value of the constant (rad), with the literal's sign."""
    difference: float
    """Typed minus exact (rad)."""
    expression: str
    """The constant in xacro."""
    decimals: int
    """Typed decimals without trailing zeros."""


def find_near_miss(text: str) -> NearMiss | None:
    """Find the constant that the literal ``text`` spells rounded or truncated; None if there is none.

    None also for spellings within 1e-9: they have all the digits that matter.
    """
    typed = _parse_decimal(text)
    if typed is None or not typed:
        return None
    size = abs(typed)
    decimals = _count_decimals(typed)
    for name, value, least, sloppy in _CONSTANTS:
        if abs(float(size) - value) <= EXACT or decimals < least:
            continue
        if _is_shortened(size, value, decimals) or (sloppy and abs(float(size) - value) < _SLOPPY * value):
            sign = "-" if typed < 0 else ""
            exact = math.copysign(value, typed)
            return NearMiss(
                constant=sign + name,
                exact=exact,
                difference=float(typed) - exact,
                expression=f"${{{sign}{name}}}",
                decimals=decimals,
            )
    return None


def find_constant(angle: float) -> str | None:
    """Find the constant of `find_near_miss`, without its sign, that ``angle`` (rad) equals to within 1e-9; None if none."""
    return next((name for name, value, _, _ in _CONSTANTS if abs(abs(angle) - value) <= EXACT), None)


def is_noise_length(metres: float) -> bool:
    """Whether a length other than zero is below a nanometre: arithmetic residue of a CAD export, not a dimension."""
    return 0.0 < abs(metres) < EXACT


def is_noise_angle(radians: float) -> bool:
    """Whether an angle other than zero is below a nanoradian: arithmetic residue of a CAD export, not an angle."""
    return 0.0 < abs(radians) < EXACT


def flag_noise_products(products: Sequence[float], largest_moment: float) -> tuple[bool, ...]:
    """Flag products of inertia that are residue: not zero, and below 1e-9 of the largest principal moment.

    Such a product turns the principal axes by less than the relative error of any typed moment.
    """
    return tuple(0.0 < abs(product) < 1e-9 * largest_moment for product in products)


def _parse_decimal(text: str) -> Decimal | None:
    try:
        value = Decimal(text.strip())
    except InvalidOperation:
        return None
    # Exponents outside float's range would make the decimals below astronomically many.
    return value if value.is_finite() and abs(value.adjusted()) < 300 else None


def _count_decimals(value: Decimal) -> int:
    """Count the decimals of a number without trailing zeros, so that ``1.570000`` counts as ``1.57``."""
    return max(0, -int(value.normalize().as_tuple().exponent))


def _is_shortened(size: Decimal, value: float, decimals: int) -> bool:
    """Whether ``size`` is ``value`` rounded or truncated to its own number of decimals."""
    unit = Decimal(1).scaleb(-decimals)
    difference = size - Decimal(value)
    return -unit < difference <= unit / 2
