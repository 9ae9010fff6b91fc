"""The formulas of three principal moments, compared with those of a box and of a cylinder."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import permutations

from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.formulas.polynomials import Monomial, Polynomial, divide_by_common_factor

# `0.083` for 1/12.
_REL_TOL = 0.01
AXES = "xyz"


@dataclass(frozen=True, slots=True, kw_only=True)
class WrongFormula:
    """A formula that does not belong to the two others."""

    indices: tuple[int, ...]
    """Of ixx, iyy and izz: which one it is, or each that it may be."""
    solid: str
    """box | cylinder: what the other two are of."""
    expected: Mapping[str, float]
    """The sum of squares that it should be: coefficients by name, in multiples of ``unit``."""
    unit: float
    """The coefficient of one square in the others: 1/12 where the mass is a name."""
    factor: Monomial
    """What all terms have in common: the mass."""


def find_wrong_formula(polynomials: Sequence[Polynomial]) -> WrongFormula | None:
    """Find the formula among those of ixx, iyy and izz that does not belong to the other two.

    The moments of a box with edges a, b, c are m (b² + c²)/12 and so on, those of a cylinder m (3r² + h²)/12 twice and m r²/2
    (any textbook). None if the three belong together, or no two of them are those of one box or cylinder.
    """
    if not all(polynomials):
        return None
    divided, factor = divide_by_common_factor(polynomials)
    squares = [_read_squares(polynomial) for polynomial in divided]
    for solid, find in (("box", _find_in_box), ("cylinder", _find_in_cylinder)):
        found = find(squares)
        if found is not None:
            indices, expected, unit = found
            return WrongFormula(indices=indices, solid=solid, expected=expected, unit=unit, factor=factor)
    return None


def write_formula(wrong: WrongFormula) -> str:
    """Write the expected formula as xacro has it: ``m*(3*r*r + h*h)/12``."""
    mass = "*".join(name for name, power in sorted(wrong.factor) for _ in range(power))
    least = min(wrong.expected.values())
    terms = [
        f"{'' if value == least else f'{value / least:g}*'}{name}*{name}" for name, value in wrong.expected.items()
    ]
    squares = terms[0] if len(terms) == 1 else f"({' + '.join(terms)})"
    factor = wrong.unit * least
    divisor = round(1.0 / factor)
    if mass and divisor and _is_like(factor, 1.0 / divisor):
        return f"{mass}*{squares}/{divisor}"
    return "*".join(filter(None, (f"{factor:.6g}", mass, squares)))


# Squares with their coefficients; None for anything else than a sum of squares.
_Squares = Mapping[str, float]
_Found = tuple[tuple[int, ...], _Squares, float]


def _read_squares(polynomial: Polynomial) -> _Squares | None:
    squares = {}
    for term, value in polynomial.items():
        powers = dict(term)
        if len(powers) != 1 or set(powers.values()) != {2} or not value > 0.0:
            return None
        squares[next(iter(powers))] = value
    return squares


def _find_in_box(moments: Sequence[_Squares | None]) -> _Found | None:
    """Find the one that is not of the box of the others: all three are sums of two of the squares of three edges."""
    known = [moment for moment in moments if moment is not None and len(moment) == 2]
    names = sorted({name for moment in known for name in moment})
    # With two names the box may be square, and the author knows which way.
    if len(known) != len(AXES) or len(names) != len(AXES):
        return None
    unit = next(iter(known[0].values()))
    candidates = []
    for edges in permutations(names):
        box = [dict.fromkeys((edge for edge in edges if edge != own), 1.0) for own in edges]
        wrong = [i for i in range(len(AXES)) if not _is_same(known[i], box[i], unit)]
        if not wrong:
            return None
        if len(wrong) == 1 and (wrong[0], box[wrong[0]]) not in candidates:
            candidates.append((wrong[0], box[wrong[0]]))
    named = [candidate for candidate in candidates if _is_named_after_axes(names, *candidate)]
    chosen = named or candidates
    return (tuple(index for index, _ in chosen), chosen[0][1], unit) if chosen else None


def _is_named_after_axes(names: Iterable[str], index: int, expected: _Squares) -> bool:
    """Whether the edges end in x, y and z, and a moment should have the two of the other axes."""
    ends = {name[-1].lower(): name for name in names}
    return set(ends) == set(AXES) and set(expected) == {ends[axis] for axis in AXES if axis != AXES[index]}


def _find_in_cylinder(moments: Sequence[_Squares | None]) -> _Found | None:
    """Find the one that is not of the cylinder of the others: the first of the form 3r² + h² says which."""
    shape = next((shape for moment in moments if (shape := _read_cylinder(moment)) is not None), None)
    if shape is None:
        return None
    radius, length, unit = shape
    across, along = {radius: 3.0, length: 1.0}, {radius: 6.0}
    is_across = [_is_same(moment, across, unit) for moment in moments]
    is_along = [_is_same(moment, along, unit) for moment in moments]
    match sum(is_across), sum(is_along):
        case 2, 0:
            return (is_across.index(False),), along, unit
        case 3, 0:
            return tuple(range(len(AXES))), along, unit
        case 1, 1:
            return (next(i for i in range(len(AXES)) if not is_across[i] and not is_along[i]),), across, unit
        case 1, 2:
            return tuple(i for i in range(len(AXES)) if is_along[i]), across, unit
    return None


def _read_cylinder(moment: _Squares | None) -> tuple[str, str, float] | None:
    """Return radius, length and the coefficient of the length's square in ``3r² + h²``; None for another sum."""
    if moment is None or len(moment) != 2:
        return None
    (length, unit), (radius, larger) = sorted(moment.items(), key=lambda item: item[1])
    return (radius, length, unit) if _is_like(larger, 3 * unit) else None


def _is_same(moment: _Squares | None, expected: _Squares, unit: float) -> bool:
    """Whether a sum of squares is the expected one, whose coefficients are in this unit."""
    return (
        moment is not None
        and moment.keys() == expected.keys()
        and all(_is_like(moment[name], expected[name] * unit) for name in expected)
    )


def _is_like(value: float, expected: float) -> bool:
    return math.isclose(value, expected, rel_tol=_REL_TOL)
