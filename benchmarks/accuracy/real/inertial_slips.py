"""Mistakes in the ten numbers of an inertial. The first line of each function says what is done."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from injections import INCH, POUND, Array, Numbers, Rng, rotation_of, six_of, steiner, tensor_of

from real.changes import Change, Part
from real.kinds import Broken, Kind, Make

# What one kg m² and one metre are in other units, and the words for them.
TENSOR_UNITS = {
    "kg·mm²": 1e6, "g·mm²": 1e9, "kg·cm²": 1e4, "g·cm²": 1e7, "g·m²": 1e3, "lb·in²": 1 / (POUND * INCH**2),
}  # fmt: skip
MASS_UNITS = {"g": 1e3, "lb": 1 / POUND}
COM_UNITS = {"mm": 1e3, "cm": 1e2, "inches": 1 / INCH}
_PRODUCTS, _MOMENTS = [1, 2, 4], [0, 3, 5]
# Products below this share of the largest moment are none: a repair that has them right or wrong is right.
_NO_PRODUCT = 0.005
_SIGN_OF_PRODUCTS = np.array((1.0, -1.0, -1.0, 1.0, -1.0, 1.0))


def tensor_unit(part: Part, rng: Rng) -> Broken | None:
    """The tensor in kg mm², g mm², kg cm², g cm², g m² or lb in²."""
    unit = str(rng.choice(list(TENSOR_UNITS)))
    return _named(part, lambda n: replace(n, six=n.six * TENSOR_UNITS[unit]), rf"(?<![a-z]){unit}")


def mass_unit(part: Part, rng: Rng) -> Broken | None:
    """The mass in grams or pounds."""
    unit = str(rng.choice(list(MASS_UNITS)))
    words = r"\b(in g\b|grams)|in g:|unit of the mass: g\b" if unit == "g" else r"\b(lb|pounds)\b"
    words += rf"|with a mass of {_numbers(part).mass:.3g} kg"  # or the true mass
    return _named(part, lambda n: replace(n, mass=n.mass * MASS_UNITS[unit]), words)


def com_unit(part: Part, rng: Rng) -> Broken | None:
    """The COM in millimetres, centimetres or inches."""
    unit = str(rng.choice(list(COM_UNITS)))
    words = rf"\b(in {unit}|COM .*\b{unit})\b"
    com = np.abs(_numbers(part).com)
    if unit == "cm" and np.sum(com > 0.01 * com.max()) == 1:
        words += r"|com [xyz] 0\.01 times"  # the same number, with its decimal point two places off
    return _named(part, lambda n: replace(n, com=n.com * COM_UNITS[unit]), words)


def all_units(part: Part, rng: Rng) -> Broken | None:
    """Mass, COM and tensor in g and mm, or COM and tensor in kg and mm."""
    mass = float(rng.choice((1.0, 1e3)))
    # Of grams and millimetres each is true by itself: a total mass shows the grams only.
    words = (r"(?<!k)g·mm²|\bgrams\b" if mass > 1 else r"kg·mm²") + r"|COM .*\bmm\b|in mm\b"
    return _named(part, lambda n: replace(n, mass=n.mass * mass, com=n.com * 1e3, six=n.six * mass * 1e6), words)


def about_origin(part: Part, rng: Rng) -> list[Change] | None:
    """The tensor about the link's origin instead of the COM."""
    return _changed(part, lambda n: replace(n, six=_about_origin(n)))


def positive_notation(part: Part, rng: Rng) -> Broken | None:
    """The tensor about the link's origin, with products of the other sign: a print-out of SolidWorks."""
    six = _about_origin(_numbers(part))
    # Without products the two mistakes are one.
    has_products = np.abs(six[_PRODUCTS]).max() > _NO_PRODUCT * np.abs(six[_MOMENTS]).max()
    words = "" if has_products else f"{_POSITIVE}|{_ORIGIN}"
    return _named(part, lambda n: replace(n, six=six * _SIGN_OF_PRODUCTS), words)


def products_sign(part: Part, rng: Rng) -> list[Change] | None:
    """All three products with the other sign."""
    return _changed(part, lambda n: replace(n, six=n.six * _SIGN_OF_PRODUCTS))


def one_product_sign(part: Part, rng: Rng) -> list[Change] | None:
    """One product with the other sign, the largest."""
    return _changed(part, lambda n: replace(n, six=n.six * _one(6, _largest(n.six, _PRODUCTS), -1)))


def moment_sign(part: Part, rng: Rng) -> list[Change] | None:
    """A minus sign before a moment."""
    return _changed(part, lambda n: replace(n, six=n.six * _one(6, int(rng.choice(_MOMENTS)), -1)))


def one_decimal(part: Part, rng: Rng) -> list[Change] | None:
    """The decimal point of one moment one or two places off."""
    factor = 10.0 ** rng.choice((-2, -1, 1, 2))
    return _changed(part, lambda n: replace(n, six=n.six * _one(6, int(rng.choice(_MOMENTS)), factor)))


def com_decimal(part: Part, rng: Rng) -> list[Change] | None:
    """The decimal point of one coordinate of the COM one or two places off."""
    factor = 10.0 ** rng.choice((1, 2))
    return _changed(part, lambda n: replace(n, com=n.com * _one(3, _largest(n.com, [0, 1, 2]), factor)))


def com_tenfold(part: Part, rng: Rng) -> list[Change] | None:
    """All of the COM ten times too large."""
    return _changed(part, lambda n: replace(n, com=n.com * 10))


def tensor_power(part: Part, rng: Rng) -> list[Change] | None:
    """The whole tensor 10 or 100 times too large or too small."""
    factor = 10.0 ** rng.choice((-2, -1, 1, 2))
    return _changed(part, lambda n: replace(n, six=n.six * factor))


def mass_tenfold(part: Part, rng: Rng) -> list[Change] | None:
    """The mass ten times too large or too small, the tensor right."""
    factor = 10.0 ** rng.choice((-1, 1))
    return _changed(part, lambda n: replace(n, mass=n.mass * factor))


def density_tenfold(part: Part, rng: Rng) -> list[Change] | None:
    """Mass and tensor ten times too large."""
    return _changed(part, lambda n: replace(n, mass=n.mass * 10, six=n.six * 10))


def six_equal(part: Part, rng: Rng) -> list[Change] | None:
    """All six numbers equal: the products filled in like the moments."""
    value = 10.0 ** round(np.log10(np.abs(np.diag(tensor_of(_numbers(part).six))).max() or 1.0))
    return _changed(part, lambda n: replace(n, six=np.full(6, value)))


def slots_swapped(part: Part, rng: Rng) -> list[Change] | None:
    """Two of the six numbers in each other's place: a moment and the product beside it, or two moments."""
    first, second = ((3, 5), (0, 3), (0, 5), (1, 3), (4, 5))[rng.integers(5)]
    return _changed(part, lambda n: replace(n, six=_swapped(n.six, first, second)))


def slots_shifted(part: Part, rng: Rng) -> list[Change] | None:
    """The numbers in the order Ixx Iyy Izz Ixy Ixz Iyz."""
    return _changed(part, lambda n: replace(n, six=n.six[[0, 3, 5, 1, 2, 4]]))


def axes_permuted(part: Part, rng: Rng) -> list[Change] | None:
    """The tensor in axes that are named in another order."""
    order = ([1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0])[rng.integers(5)]
    return _changed(part, lambda n: replace(n, six=six_of(tensor_of(n.six)[np.ix_(order, order)])))


def com_moved(part: Part, rng: Rng) -> list[Change] | None:
    """The COM somewhere else, by one to three radii of gyration."""
    n = _numbers(part)
    away = rng.normal(size=3)
    size = np.sqrt(max(np.trace(tensor_of(n.six)), 0) / (2 * n.mass)) * rng.uniform(1, 3)
    return _changed(part, lambda n: replace(n, com=n.com + away / np.linalg.norm(away) * size))


def com_mirrored(part: Part, rng: Rng) -> list[Change] | None:
    """The largest coordinate of the COM with the other sign."""
    return _changed(part, lambda n: replace(n, com=n.com * _one(3, _largest(n.com, [0, 1, 2]), -1)))


def com_missing(part: Part, rng: Rng) -> list[Change] | None:
    """The COM 0 0 0."""
    return _changed(part, lambda n: replace(n, com=np.zeros(3)))


def copied(part: Part, rng: Rng) -> list[Change] | None:
    """All numbers of another link."""
    others = [p.numbers for p in part.owner.parts if p is not part and p.numbers is not None]
    if not others:
        return None
    other = others[rng.integers(len(others))]
    return _changed(part, lambda n: replace(n, mass=other.mass, com=other.com, six=other.six))


def placeholder(part: Part, rng: Rng) -> list[Change] | None:
    """1, 0.1, 0.01 or 0.001 on the diagonal, the products zero."""
    value = float(rng.choice((1.0, 0.1, 0.01, 0.001)))
    if np.array_equal(np.round(_numbers(part).six / value), (1, 0, 0, 1, 0, 1)):
        return None  # nothing tells it from the true numbers, rounded
    return _changed(part, lambda n: replace(n, six=value * np.array((1.0, 0, 0, 1, 0, 1))))


def rounded(part: Part, rng: Rng) -> list[Change] | None:
    """The six numbers rounded to so many decimals that the smallest moment has one digit."""
    n = _numbers(part)
    least = np.abs(n.six[_MOMENTS]).min()
    if least <= 0:
        return None
    decimals = int(np.ceil(-np.log10(least)))
    return _changed(part, lambda n: replace(n, six=np.round(n.six, decimals)))


def _numbers(part: Part) -> Numbers:
    assert part.numbers is not None
    return part.numbers


def _changed(part: Part, change: object) -> list[Change] | None:
    old = part.numbers
    assert callable(change)
    return None if old is None else part.write(change(old))


def _named(part: Part, change: object, says: str) -> Broken | None:
    changes = _changed(part, change)
    return None if changes is None else Broken(changes, says)


def _about_origin(n: Numbers) -> Array:
    """The six numbers about the link's origin, in the axes of the inertial frame."""
    lever = rotation_of(n.rpy).T @ n.com
    return six_of(tensor_of(n.six) + n.mass * steiner(lever))


def _one(length: int, index: int, value: float) -> Array:
    factors = np.ones(length)
    factors[index] = value
    return factors


def _largest(values: Array, among: list[int]) -> int:
    return max(among, key=lambda index: abs(values[index]))


def _swapped(six: Array, first: int, second: int) -> Array:
    changed = six.copy()
    changed[[first, second]] = six[[second, first]]
    return changed


def _kind(make: Make, says: str = "", *codes: str, nameless: bool = False, habit: bool = False) -> Kind:
    lossy = make in (six_equal, com_moved, com_missing, copied, placeholder, rounded)
    itself = make in (moment_sign, six_equal)
    return Kind(
        make, "inertial", says, frozenset(codes), is_nameless=nameless, is_lossy=lossy, shows_itself=itself, habit=habit
    )


_DECIMAL = r"decimal|ten times|10 times|100 times|\b10\b|\b100\b"
_PRODUCTS_SIGN = (
    r"products of inertia (have|with) the (wrong|other) sign|signs? of (all |its )?(three )?products|products.*\bsign"
)
_ORIGIN = r"about the link's origin|about the origin|output coordinate system"
_POSITIVE = r"positive|output coordinate system|origin, with products of the other sign"
_SLOTS = r"changed places|two of the six|moved by one slot|order (Ixx|of)|other axes|axes are|round about|swap"

KINDS = (
    _kind(tensor_unit),
    _kind(mass_unit),
    _kind(com_unit),
    _kind(all_units),
    _kind(about_origin, _ORIGIN),
    _kind(positive_notation, _POSITIVE),
    _kind(products_sign, _PRODUCTS_SIGN),
    _kind(one_product_sign, r"wrong sign|the other sign|\bsigns?\b"),
    _kind(moment_sign, r"\bsign\b|negative moment"),
    _kind(one_decimal, _DECIMAL),
    _kind(com_decimal, _DECIMAL),
    _kind(com_tenfold, _DECIMAL),
    _kind(tensor_power, _DECIMAL + r"|g·m²|kg·cm²|times"),
    _kind(mass_tenfold, _DECIMAL + r"|with a mass of|\bmass\b.*\b(times|changed)"),
    _kind(density_tenfold, r"dens|times (as|too) (heavy|dense)|ten times|10 times|decimal"),
    _kind(six_equal, r"filled in like the moments|all six|six (equal|numbers are)|same number"),
    _kind(slots_swapped, _SLOTS),
    _kind(slots_shifted, r"order Ixx|Ixx Iyy Izz|fullinertia|changed places|slot"),
    _kind(axes_permuted, _SLOTS + r"|axes"),
    _kind(com_moved, nameless=True),
    _kind(com_mirrored, r"\bsign|mirror|other side"),
    _kind(com_missing, r"at the link's origin|never filled|not .*filled in"),
    _kind(copied, r"cop(y|ied)|same (tensor|inertia|numbers)|share", "INR008"),
    _kind(placeholder, r"placeholder|typed rather than computed", "INR007"),
    _kind(rounded, r"digits|rounded|rounding|decimals"),
    _kind(tensor_unit, habit=True),
    _kind(all_units, habit=True),
    _kind(mass_unit, habit=True),
    _kind(com_unit, habit=True),
    _kind(about_origin, _ORIGIN, habit=True),
    _kind(positive_notation, _POSITIVE, habit=True),
    _kind(products_sign, _PRODUCTS_SIGN, habit=True),
    _kind(density_tenfold, r"dens|times (as|too) (heavy|dense)|ten times|10 times|decimal", habit=True),
    _kind(tensor_power, _DECIMAL + r"|g·m²|kg·cm²|times", habit=True),
)
