"""One mistake that leads from the numbers of a part to those of its twin, wherever the frames of both are.

Compared is what neither another frame nor a mirror changes: the mass, the principal moments, and, where the mistake changes it,
the distance of the COM from the link's frame.
"""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.inertial_fit import InertialBatch, build_twin_reference, is_body, is_computable
from urdfcheck.facts.inertials.mistakes.mistake import Mistake, Suspect, make_mistake
from urdfcheck.facts.inertials.mistakes.mixing_mistakes import list_explanations
from urdfcheck.facts.inertials.mistakes.wrong_formulas import measure_decimal
from urdfcheck.facts.inertials.ranking import get_mistake_family

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Bools, Mat3
    from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial

# What three typed digits leave of equal numbers.
_EQUAL = 0.005
# What two exports of one part leave of the digits of a coordinate.
_SAME_DIGITS = 0.05
# Twins of published robots that differ by less do so for other reasons; a sign or a swap of slots explains that by chance.
_UNLIKE = 1.2
# A COM nearer to the frame than this part of the radius of gyration is zero and noise: a power of ten of it shows nothing.
_NEAR_FRAME = 0.1
# Half a unit of the last decimal, and what other axes add; and how much of a moment is lost at least.
_HALF, _LOST = 0.51, 1.05
# Beside a number, a unit of the last decimal that is less than this share of it is only its rounding (chosen).
_LITTLE = 0.2
# Masses that were computed once differ by less.
_ONE_NUMBER = 1e-6
# Nobody types more significant digits, and other axes change the ones behind them.
_TYPED_DIGITS = 12
# A mistake that is rarer than another by this many nats is not the one (e² = 7 : 1).
_RARER = 2.0


@dataclass(frozen=True, slots=True)
class TwinSlip:
    """The one mistake without which two sides agree."""

    mistake: Mistake
    is_first: bool
    """Whether the first side has it, rather than the second."""
    is_either: bool
    """Whether either may have it: a decimal point is as easily moved to the left as to the right."""


def find_slip_between_twins(first: DeclaredInertial, second: DeclaredInertial) -> TwinSlip | None:
    """Find the one mistake without which two sides agree, on the side on which it is the likelier one."""
    for is_first, coarse, fine in ((True, first, second), (False, second, first)):
        if (rounded := find_rounding(coarse, fine)) is not None:
            return TwinSlip(rounded, is_first=is_first, is_either=False)
    of_first, of_second = find_twin_slip(first, second), find_twin_slip(second, first)
    if _measure_ratio(first, second) <= 1.0 + _EQUAL:
        # Of two COMs the farther one has the mistake.
        is_first = bool(np.linalg.norm(first.com) > np.linalg.norm(second.com))
        far, near = (of_first, of_second) if is_first else (of_second, of_first)
        mistake = far or near
        if mistake is None:
            return None
        return TwinSlip(mistake, is_first=is_first, is_either=mistake.id == "decimal_point")
    if of_second is None:
        return None if of_first is None else TwinSlip(of_first, is_first=True, is_either=False)
    if of_first is None:
        return TwinSlip(of_second, is_first=False, is_either=False)
    if math.isclose(of_first.log_prior, of_second.log_prior):
        is_decimal = of_first.id == of_second.id == "decimal_point"
        return TwinSlip(of_second, is_first=False, is_either=True) if is_decimal else None
    is_first = of_first.log_prior > of_second.log_prior
    return TwinSlip(of_first if is_first else of_second, is_first=is_first, is_either=False)


def find_rounding(coarse: DeclaredInertial, fine: DeclaredInertial) -> Mistake | None:
    """Find whether the six numbers of a tensor are those of another, apart from signs, rounded to so few decimals that its
    smallest moment has one digit left."""
    unit = _measure_lost_decimal(coarse, fine)
    off = float(np.abs(np.abs(coarse.tensor) - np.abs(fine.tensor)).max())
    if unit is None or off > _HALF * unit or abs(coarse.mass - fine.mass) > _EQUAL * fine.mass:
        return None
    return make_mistake("rounded", f"{max(0, -round(math.log10(unit)))} decimals")


def find_principal_rounding(coarse: DeclaredInertial, fine: DeclaredInertial) -> Mistake | None:
    """Find what `find_rounding` does, of tensors in any two frames: the masses are one number, and the principal moments are as
    near as rounding six numbers leaves them."""
    unit = _measure_lost_decimal(coarse, fine)
    one, other = (np.linalg.eigvalsh(numbers.tensor) for numbers in (coarse, fine))
    # Half a unit in each of nine components is at most three times that in the norm, which bounds how far a moment moves; of
    # three moments it is as much in their sum.
    off = max(float(np.abs(one - other).max()), abs(float(one.sum() - other.sum())))
    if unit is None or off > 3.0 * _HALF * unit or not math.isclose(coarse.mass, fine.mass, rel_tol=_ONE_NUMBER):
        return None
    return make_mistake("rounded", f"{max(0, -round(math.log10(unit)))} decimals")


def differ_by_last_digits(one: DeclaredInertial, other: DeclaredInertial) -> bool:
    """Whether the six numbers of two tensors have one last decimal, and differ, apart from signs, by one unit of it at most,
    which is little beside the largest: one part, whose numbers were rounded twice."""
    unit, same = (measure_decimal(_drop_noise(numbers.tensor)) for numbers in (one, other))
    largest, off = float(np.abs(one.tensor).max()), float(np.abs(np.abs(one.tensor) - np.abs(other.tensor)).max())
    return unit is not None and unit == same and off <= 2.0 * _HALF * unit < _LITTLE * largest


def _measure_lost_decimal(coarse: DeclaredInertial, fine: DeclaredInertial) -> float | None:
    """Measure the last decimal place of the tensor ``coarse``, where its smallest moment has one digit, ``fine`` has more
    decimals, and a moment or the mass differs; None otherwise."""
    if not (is_computable(coarse) and is_body(fine)):
        return None
    unit, finer = (measure_decimal(_drop_noise(one.tensor)) for one in (coarse, fine))
    if unit is None or (finer is not None and finer >= unit):
        return None
    least = float(coarse.tensor.diagonal().min())
    return unit if float(f"{least:.0e}") == least and _measure_ratio(coarse, fine) >= _LOST else None


def _drop_noise(tensor: Mat3) -> Mat3:
    """Return a tensor without what a change of axes adds to its typed digits."""
    digits = _TYPED_DIGITS - 1 - math.floor(math.log10(max(float(np.abs(tensor).max()), sys.float_info.min)))
    return np.round(tensor, digits)


def find_twin_slip(wrong: DeclaredInertial, right: DeclaredInertial) -> Mistake | None:
    """Find the one common mistake in ``wrong`` without which it has the mass, the principal moments and, if the mistake changes
    it, the distance of the COM of ``right``; None where none does, several unlike ones do, or the two agree.

    Only mistakes that keep the part's own numbers count: nothing is taken from the twin.
    """
    if not (is_computable(wrong) and is_body(right)):
        return None
    mistakes, numbers = list_explanations(Suspect(wrong, build_twin_reference(right), None))
    fits, is_near = _agree_in_size(numbers, right), _agree_in_distance(numbers, right)
    is_moved = np.linalg.norm(numbers.com - wrong.com, axis=1) > 0.0
    if fits[0]:  # only the COM can be wrong
        if is_near[0] or float(np.linalg.norm(right.com)) <= _NEAR_FRAME * _measure_size(right):
            return None
        # One coordinate more or less explains many distances; a power of ten of all of them does not, nor does one that leaves
        # the coordinates of the other, apart from signs.
        is_scaled = np.linalg.norm(np.cross(numbers.com, wrong.com), axis=1) < 1e-9 * float(wrong.com @ wrong.com)
        # What was moved has the digits of the other: a coordinate near zero is near that of the other at any power of ten.
        off, size = np.abs(np.abs(numbers.com) - np.abs(right.com)), float(np.linalg.norm(right.com))
        changed = np.abs(np.abs(numbers.com) - np.abs(wrong.com)) > 0.0
        is_same = (off <= np.where(changed, _SAME_DIGITS * np.abs(right.com), _EQUAL * size)).all(axis=1)
        fits &= is_moved & is_near & (is_scaled | is_same)
    elif _measure_ratio(wrong, right) < _UNLIKE:
        return None
    else:
        fits &= ~is_moved | is_near
    own = [m.borrowed == (0, 0) and m.source_body is None and m.factor == 1.0 for m in mistakes]
    found = [
        m for m, is_fit, is_own in zip(mistakes, fits, own, strict=True) if is_fit and is_own and m.id != "other_mass"
    ]
    best = max(found, key=lambda mistake: mistake.log_prior, default=None)
    if best is None:
        return None
    rivals = [m for m in found if m.log_prior > best.log_prior - _RARER]
    return best if len({get_mistake_family(m) for m in rivals}) == 1 else None


def _agree_in_size(numbers: InertialBatch, right: DeclaredInertial) -> Bools:
    """Whether (N,) masses and principal moments are those of ``right``."""
    moments, wanted = np.linalg.eigvalsh(numbers.tensor), np.linalg.eigvalsh(right.tensor)
    same: Bools = (np.abs(moments - wanted) <= _EQUAL * wanted[-1]).all(axis=1)
    same &= np.abs(moments[:, 0] - wanted[0]) <= 2.0 * _EQUAL * abs(wanted[0])
    same &= np.abs(numbers.mass - right.mass) <= _EQUAL * right.mass
    return same


def _agree_in_distance(numbers: InertialBatch, right: DeclaredInertial) -> Bools:
    """Whether (N,) the COMs are as far from the link's frame as that of ``right``."""
    distance = float(np.linalg.norm(right.com))
    tolerance = _EQUAL * max(distance, _NEAR_FRAME * _measure_size(right))
    near: Bools = np.abs(np.linalg.norm(numbers.com, axis=1) - distance) <= tolerance
    return near


def _measure_ratio(wrong: DeclaredInertial, right: DeclaredInertial) -> float:
    """Measure the largest ratio of masses or of principal moments, at least 1; infinite where a moment is not positive."""
    one, other = ((numbers.mass, *np.linalg.eigvalsh(numbers.tensor)) for numbers in (wrong, right))
    pairs = [(float(a), float(b)) for a, b in zip(one, other, strict=True)]
    return max(max(a / b, b / a) if a > 0.0 and b > 0.0 else math.inf for a, b in pairs)


def _measure_size(numbers: DeclaredInertial) -> float:
    """Measure the radius of gyration (m)."""
    return float(np.sqrt(max(0.0, float(np.trace(numbers.tensor))) / (2.0 * numbers.mass)))
