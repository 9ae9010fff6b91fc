"""Whether the best explanation of an inertial is certain enough to be named."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.inertials.inertia_tensor import compute_mass_covariance
from urdfcheck.facts.inertials.inertial_fit import OPEN_MIXTURE, Reference, measure_inertial_mismatch
from urdfcheck.facts.inertials.mistakes.mistake import EFFECT, Mistake
from urdfcheck.facts.inertials.ranking import COM_FITS, MARGIN, Ranking, is_whole_com

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Mat3
    from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
    from urdfcheck.facts.inertials.mistakes.file_habits import Habit

# Numbers that agree with exact geometry to within tessellation and five digits.
EXACT = 0.06
# A tensor is that of another mass where its three second moments have one ratio to the reference's, to within 2 %.
PROPORTIONAL = 0.02
# Its COM is the drawn part's own, to within this share of the part's radius of gyration. Of 30,000 random castings with one to
# three lumps inside, 28 have such a tensor and a COM within `EXACT`; 3 of these have such a COM.
_SAME_COM = 0.02
# Beyond this a part would need most of its mass in one place: COM a radius of gyration away, or second moments five times less.
FAR = 1.6
# A COM or a tensor this near the reference's belongs to a part of uniform density: then the other has to agree as well.
UNIFORM = 0.01
# Undoing a mistake has to leave a part that is no farther from its uniform solid than lumps of 60 % make it.
NEAR = 1.5
# Equal parts differ by less: 2 % in a moment.
TWIN_LIKE = 0.02
# A tensor of other moments than a sphere's, by this share of the largest, identifies the mass it was computed for.
_NOT_A_SPHERE = 0.05
# Mistakes in one number: a cause is named only if it is certain which number.
_PRECISE = frozenset({"decimal_point", "one_sign", "slots_swapped", "slots_shifted", "one_piece"})
# What a convex hull in place of an open mesh can show: powers of ten, places far outside, another order of the numbers.
_COARSE = frozenset(
    {"inertia_unit", "mass_unit", "com_unit", "units", "mesh_scale", "com_missing", "diagonal_first", "row_major"}
)
# A tensor about the link's origin, which may exceed what fits into the hull.
_OF_ORIGIN = frozenset({"about_origin", "positive_notation"})
# What most links of a file have in common, and hulls alone may show.
SHOWN_BY_HULLS = _COARSE | _OF_ORIGIN | {"decimal_point"}
# Mistakes of place and direction: undoing one gives the tensor of the part itself, or another mistake is there. A unit changes
# a tensor by powers of ten, which whatever the part holds besides leaves visible.
_OF_PLACE = frozenset({"steiner_missing", "steiner_twice", "quarter_turn", "axes_permuted", "rpy_missing", "rpy_twice"})
# What they may leave, as a mismatch: an ellipsoid of inertia that is a third longer or shorter along one axis. Of 74 links of 718
# published descriptions in which one of them was the best explanation, 11 were left farther off.
PLACED = 0.3
# Units of mass and inertia: undoing them scales the tensor of one unit of mass.
_UNITS = frozenset({"inertia_unit", "mass_unit", "units"})
# Units that differ are told apart by the size alone: it shows one only if all moments of the part have one ratio, to 5 %.
_ONE_RATIO = 0.1
# A unit that changes mass or tensor by less is no more than what a motor does, where more than this is left of the mismatch.
_SMALL_UNIT, _SMALL_UNIT_FITS = 5.0, 0.25
# A tensor so many times that of the part is wrong whatever is inside. Where a unit is wrong by the square of it, it no longer
# counts what is left of the mismatch, nor whether the COM is that of a uniform part.
VAST = 1e3
# Mistakes of signs, which show in the products; below this part of the largest moment and with one digit, these show nothing.
_SIGNS, _NO_PRODUCT = frozenset({"products_sign", "one_sign", "unmirrored"}), 0.02


def can_be_named(
    declared: DeclaredInertial, reference: Reference, ranking: Ranking, habit: Habit | None = None
) -> bool:
    """Whether the best explanation is certain, convincing, and has an effect; of a ``habit`` a small one counts."""
    if ranking.is_same_correction[ranking.no_mistake] or not ranking.margin > MARGIN:
        return False
    if ranking.best.id in _PRECISE and len({_name_changed_number(mistake) for mistake in ranking.contenders}) > 1:
        return False
    is_of_file = habit is not None and habit.is_like(ranking.best.id, ranking.best.detail)
    if not is_of_file and reference.twin is None and _is_doubtful_com_unit(ranking):
        return False
    if ranking.best.id in _UNITS and not _shows_unit(declared, reference, ranking):
        return False
    is_of_products = ranking.best.id in _SIGNS and _changes_only_products(declared, ranking.numbers[0])
    if is_of_products and has_coarse_products(declared):
        return False
    least = TWIN_LIKE if reference.twin is not None else EFFECT
    if is_of_file:
        least = min(least, EXACT)
    return (
        _is_convincing(ranking, reference, is_habit=is_of_file)
        and _measure_effect(declared, ranking.numbers[0], ranking.best.factor) > least
    )


def _changes_only_products(declared: DeclaredInertial, corrected: DeclaredInertial) -> bool:
    """Whether a correction leaves COM and moments as they are."""
    moments = declared.inertia.diagonal(), corrected.inertia.diagonal()
    return bool(np.allclose(declared.com, corrected.com) and np.allclose(*moments, atol=0.0))


def has_coarse_products(declared: DeclaredInertial) -> bool:
    """Whether all products have one digit and are next to nothing: what was rounded away is as large as they are."""
    products = declared.tensor[np.triu_indices(3, 1)]
    is_typed_short = all(float(f"{value:.0e}") == value for value in products.tolist())
    return is_typed_short and float(np.abs(products).max()) < _NO_PRODUCT * float(declared.tensor.diagonal().max())


def _is_doubtful_com_unit(ranking: Ranking) -> bool:
    """Whether the COM of one link would be in inches or centimetres, and is not near the drawn part's in that unit.

    No program writes one link of a file so, and such a factor brings many a COM outside the part somewhat nearer.
    """
    best = ranking.best
    return best.id == "com_unit" and best.detail != "mm" and not float(ranking.fit.com_mismatch[0]) < COM_FITS


def _shows_unit(declared: DeclaredInertial, reference: Reference, ranking: Ranking) -> bool:
    """Whether the numbers are those of the part in another unit: not one number in place of three moments, which no unit makes
    of a part that is not round, and not a size that several units explain where the moments have no common ratio. A unit as small
    as a pound has to leave the part's own numbers, even if the whole file seems to have it: mass that is not drawn changes as
    much."""
    tensor = declared.tensor
    is_identity = bool((tensor == tensor[0, 0] * np.eye(3)).all())
    if is_identity and float(ranking.fit.tensor_mismatch[0]) > EFFECT:
        return False
    if reference.twin is None and _leaves_another_part(ranking, 0):
        return False
    contenders = np.flatnonzero((ranking.leads <= MARGIN) & [m.id in _UNITS for m in ranking.mistakes])
    sizes = np.trace(ranking.numbers.tensor[contenders], axis1=1, axis2=2) / ranking.numbers.mass[contenders]
    if sizes.max() < (1.0 + _ONE_RATIO) * sizes.min():
        return True
    white = reference.whitening
    ratios = np.linalg.eigvalsh(white @ compute_mass_covariance(declared.inertia, declared.mass) @ white)
    return bool(ratios[0] > 0.0 and ratios[-1] < (1.0 + _ONE_RATIO) * ratios[0])


def _leaves_another_part(ranking: Ranking, row: int) -> bool:
    """Whether undoing a unit as small as a pound leaves a tensor that is not the part's: a motor changes as much."""
    if ranking.mistakes[row].id not in _UNITS or not float(ranking.fit.tensor_mismatch[row]) > _SMALL_UNIT_FITS:
        return False
    rows = [ranking.no_mistake, row]
    sizes = np.trace(ranking.numbers.tensor[rows], axis1=1, axis2=2) / ranking.numbers.mass[rows]
    return bool((sizes > 0.0).all()) and abs(math.log(float(sizes[0] / sizes[1]))) < math.log(_SMALL_UNIT)


def _is_convincing(ranking: Ranking, reference: Reference, *, is_habit: bool = False) -> bool:
    """Whether the best explanation leaves numbers that a part of this shape has: being better than the others is not enough.
    What most links of the file have (``is_habit``) an open mesh can show too, and what it leaves has to be unremarkable only."""
    best, fit, none, twin = ranking.best, ranking.fit, ranking.no_mistake, reference.twin
    tensor_mismatch = float(fit.tensor_mismatch[0])
    com_mismatch = float(fit.com_mismatch[0])
    worst = max(tensor_mismatch, com_mismatch)
    if twin is not None and not math.isclose(float(ranking.numbers.mass[0]), twin.mass, rel_tol=TWIN_LIKE):
        return False
    if best.id == "other_mass":  # any tensor fits a sphere of some mass, and a motor changes the size as a mass does
        moments = np.linalg.eigvalsh(ranking.numbers[0].tensor)
        equal = tensor_mismatch < PROPORTIONAL and com_mismatch < _SAME_COM
        return equal and bool(moments[-1] - moments[0] > _NOT_A_SPHERE * moments[-1])
    if twin is not None:  # the reference is not a uniform solid, but the numbers as they should be
        return worst < EXACT
    # A ratio of mass and tensor near ten may be a changed mass or a motor, and numbers of one digit were guessed.
    is_alone = not is_habit or _has_single_digits(ranking.numbers[none].tensor)
    if best.id == "decimal_point" and best.detail.startswith(("mass ", "tensor ")) and is_alone:
        return worst < EFFECT
    sizes = np.trace(ranking.numbers.tensor[[none, 0]], axis1=1, axis2=2) / ranking.numbers.mass[[none, 0]]
    is_vast = best.id in _UNITS and sizes[0] >= VAST**2 * sizes[1]
    if best.borrowed == (0, 0) and not is_vast:
        # A part with the COM (or the tensor) of its uniform solid has uniform density: the other has to agree as well.
        if float(fit.com_mismatch[none]) < UNIFORM and tensor_mismatch > 2 * EFFECT:
            return False
        if float(fit.tensor_mismatch[none]) < UNIFORM and com_mismatch > 2 * EFFECT:
            return False
    if best.id in _OF_PLACE and not is_habit and tensor_mismatch > PLACED:
        return False
    if reference.mixture is OPEN_MIXTURE and best.id not in _COARSE and not is_habit:
        # No mass inside the hull has the tensor as it is, and one has it about the COM, near the hull's own.
        return best.id in _OF_ORIGIN and bool(fit.inside[0] and not fit.inside[none]) and worst < 0.5 * NEAR
    one_number = best.id == "decimal_point" and not is_whole_com(best)
    return worst < (FAR if is_habit or is_vast else NEAR / 2 if one_number else NEAR)


def _has_single_digits(tensor: Mat3) -> bool:
    """Whether all moments of a tensor (3, 3) have one significant digit."""
    return all(float(f"{value:.0e}") == value for value in tensor.diagonal().tolist())


def _measure_effect(declared: DeclaredInertial, mended: DeclaredInertial, factor: float) -> float:
    """Measure how much a mistake changes: the logarithm of the mass, the second moments or the COM; infinite for an impossible
    tensor."""
    covariance = compute_mass_covariance(mended.inertia, mended.mass)
    if not np.isfinite(covariance).all() or not np.linalg.eigvalsh(covariance)[-1] > 0.0:
        return math.inf
    return max(
        *measure_inertial_mismatch(declared, mended.com, covariance),
        abs(math.log(declared.mass / mended.mass * factor)),
    )


def _name_changed_number(mistake: Mistake) -> str:
    """Return which number a mistake in one number is about. The last word is the power of ten, which counts for a coordinate of
    the COM: one that is next to zero after any of them need not have lost a decimal point. Mass and tensor count as one: only
    their ratio shows."""
    has_power = mistake.id == "decimal_point" and not mistake.detail.startswith("com")
    name = mistake.detail.rpartition(" ")[0] if has_power else mistake.detail
    return "mass or tensor" if name in {"mass", "tensor"} else name
