"""Why a declared inertia is not that of the drawn part: every common mistake is undone, and the result is compared.

Each hypothesis turns the declared numbers into those without one mistake. Its score is the logarithm of how often the mistake
is made, plus that of how likely the corrected numbers are for a part of this shape. A cause is named only if its score beats
every other explanation, "no mistake" among them, by a margin.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import permutations
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.file_habits import HABITS, Evidence, Habit
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial, VisualGeometry
from urdfcheck.facts.inertials.inertia_tensor import compute_mass_covariance
from urdfcheck.facts.inertials.inertial_fit import (
    CLOSED_MIXTURE,
    OPEN_MIXTURE,
    TWIN_MIXTURE,
    TYPICAL_DENSITY,
    InertialBatch,
    InertialFit,
    Reference,
    build_geometry_reference,
    build_twin_reference,
    compute_log_likelihood,
    compute_min_moment_ratio,
    has_computable_size,
    is_body,
    is_computable,
    measure_fit,
    measure_inertial_mismatch,
)
from urdfcheck.facts.inertials.mistakes import EFFECT, Mistake, Suspect
from urdfcheck.facts.inertials.mixing_mistakes import list_explanations

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Bools, Vec3

# A cause is named when it beats every other explanation by this many nats (e⁵ = 150 : 1).
MARGIN = 5.0
# Numbers that agree with exact geometry to within tessellation and five digits.
EXACT = 0.06
# A tensor is that of another mass where its three second moments have one ratio to the reference's, to within 2 %.
PROPORTIONAL = 0.02
# Beyond this a part would need most of its mass in one place: COM a radius of gyration away, or second moments five times less.
FAR = 1.6
# A COM or a tensor this near the reference's belongs to a part of uniform density: then the other has to agree as well.
UNIFORM = 0.01
# Undoing a mistake has to leave a part that is no farther from its uniform solid than lumps of 60 % make it.
NEAR = 1.5
# What scales the COM alone, by an inch or a centimetre, has to leave it nearer than that.
COM_NEAR = 1.2
# A decimal point of the whole COM is no unit in use: it has to fit as a uniform part's does.
COM_FITS = 0.3
# Equal parts differ by less: 2 % in a moment.
TWIN_LIKE = 0.02
# One of two parts is wrong when its numbers are this many nats less likely for its mesh.
SIDE_MARGIN = 5.0
# A tensor of other moments than a sphere's, by this share of the largest, identifies the mass it was computed for.
_NOT_A_SPHERE = 0.05
# Logarithm of how much rarer the mistake of another program is in a file with a habit: 1 in 20.
_SECOND_HABIT = -3.0
# Mistakes of the axes, which the COM may have in another way than the tensor.
_OF_AXES = frozenset({"quarter_turn", "axes_permuted"})
# A coordinate that is less than a third of a radius of gyration from zero says nothing about the number that it was.
_NEAR_ZERO = 0.3

# Mistakes in one number: a cause is named only if it is certain which number.
_PRECISE = frozenset({"decimal_point", "one_sign", "slots_swapped", "slots_shifted", "one_piece"})
# Mistakes that are told together where it is not certain which of them was made, by the one that both have in common.
_FAMILIES = {"inertia_unit": "units", "positive_notation": "about_origin"}
# What a convex hull in place of an open mesh can show: powers of ten, places far outside, another order of the numbers.
_COARSE = frozenset(
    {"inertia_unit", "mass_unit", "com_unit", "units", "mesh_scale", "com_missing", "diagonal_first", "row_major"}
)
# Units of mass and inertia: undoing them scales the tensor of one unit of mass.
_UNITS = frozenset({"inertia_unit", "mass_unit", "units"})
# Units that differ are told apart by the size alone: it shows one only if all moments of the part have one ratio, to 5 %.
_ONE_RATIO = 0.1
# A tensor so many times that of the part is wrong whatever is inside. Where a unit is wrong by the square of it, it no longer
# counts what is left of the mismatch, nor whether the COM is that of a uniform part.
VAST = 1e3
# Mistakes that only scale a COM.
_SCALED = frozenset({"com_unit", "decimal_point"})
# Mistakes that lost the part's own numbers, or are not in them, so that undoing them does not lead to those of its twin.
_LOSSY = frozenset(
    {
        *("shell", "bounding_box", "convex_hull", "one_piece", "steiner_missing"),
        *("row_major", "com_missing", "rpy_missing", "mesh_scale", "rounded", "wrong_formula"),
    }
)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Diagnosis:
    """The verdict on one inertial."""

    sound: bool
    """Whether the numbers need no explanation."""
    cause: str | None
    """Id of the one mistake that explains the numbers; None if none is certain."""
    detail: str
    """The parameter of the cause, such as a unit."""
    mended: DeclaredInertial | None
    """The numbers with the mistake undone; None if the cause or its parameter is uncertain."""
    tensor_mismatch: float
    """How far the inertia is from the reference's, see `measure_inertial_mismatch`."""
    com_mismatch: float
    """How far the COM is from the reference's, in radii of gyration."""
    mended_tensor_mismatch: float
    """`tensor_mismatch` with the mistake undone."""
    mended_com_mismatch: float
    """`com_mismatch` with the mistake undone."""
    min_moment_ratio: float
    """The smallest ratio of a second moment to the reference's."""
    margin: float
    """By how much the best explanation beats every other (nats)."""
    unique: bool
    """Whether of all single mistakes only the cause leaves numbers that agree with the reference to within what digits and
    tessellation leave."""
    ruled_out: tuple[str, ...]
    """Ids of the mistakes that were undone and do not explain the numbers, likeliest first."""
    fits_geometry: bool
    """Whether a mass inside the drawn geometry can have the declared numbers."""
    judged_by: str
    """The reference that decides, ``mesh`` or ``twin``."""
    at_fault: bool
    """Whether this part, rather than its twin, is wrong."""
    com_order: str = ""
    """The link's coordinates that the COM has as x y z, such as ``y x -z``, where a mistake of the axes explains the tensor and
    another one the COM."""
    evidence: Evidence | None = None
    """How well the mistakes of a whole file explain the numbers; None where they need no explanation."""


@dataclass(frozen=True, eq=False, kw_only=True)
class _Ranking:
    """Every explanation, the best first."""

    mistakes: tuple[Mistake, ...]
    scores: Array
    """(N,), descending."""
    fit: InertialFit
    """How far the numbers without each mistake are from the reference."""
    numbers: InertialBatch
    """The numbers without each mistake."""

    @property
    def best(self) -> Mistake:
        return self.mistakes[0]

    @cached_property
    def no_mistake(self) -> int:
        """Index of the explanation that nothing is wrong."""
        return next(i for i, mistake in enumerate(self.mistakes) if mistake.id == "none")

    @cached_property
    def leads(self) -> Array:
        """(N,), by how much the best score beats each; zero if every score is that of the impossible."""
        return self.scores[0] - self.scores if math.isfinite(self.scores[0]) else np.zeros(len(self.scores))

    @cached_property
    def is_same_correction(self) -> Bools:
        """(N,), whether undoing the mistake leads to the same numbers and scale as undoing the best."""
        same: Bools = self.numbers.find_equal_rows(0) & [m.factor == self.best.factor for m in self.mistakes]
        return same

    @cached_property
    def margin(self) -> float:
        """Lead over the best explanation of another family that leads to other numbers; infinite if there is none."""
        family = _get_mistake_family(self.best)
        rivals = zip(self.mistakes, self.is_same_correction, self.leads, strict=True)
        leads = (float(lead) for mistake, same, lead in rivals if not same and _get_mistake_family(mistake) != family)
        return next(leads, math.inf)

    @cached_property
    def contenders(self) -> list[Mistake]:
        """The best explanation, and those within the margin that lead to other numbers: a mistake may be certain while its
        parameter is not, such as which axes were swapped, or which of two units."""
        within = np.flatnonzero((self.leads <= MARGIN) & ~self.is_same_correction).tolist()
        return [self.mistakes[i] for i in (0, *within)]


def diagnose_inertial(
    declared: DeclaredInertial,
    geometry: VisualGeometry | None,
    twin: DeclaredInertial | None = None,
    *,
    trusted: bool = False,
    habit: Habit | None = None,
) -> Diagnosis | None:
    """Find what is wrong with an inertial, judged by what the link draws and by its ``twin``: the numbers that a mirrored or
    equal part says it should have, in this link's frame. ``trusted``: several such parts agree, so that the twin is right.
    ``habit``: the mistake that most links of the file have.

    Return None when there is nothing to compare: no geometry with a volume, and no twin that is a possible body; or when the
    numbers are too large or too small to compute with.
    """
    if not is_computable(declared):
        return None
    twin = twin if twin is not None and is_body(twin) else None
    if geometry is not None and not has_computable_size(geometry.solid.com, geometry.solid.covariance):
        geometry = None
    if twin is None:
        return None if geometry is None else _diagnose_by_mesh(declared, geometry, habit)
    by_twin = replace(_diagnose_against(declared, build_twin_reference(twin), geometry), judged_by="twin")
    if geometry is None:
        return replace(by_twin, at_fault=trusted, evidence=None)
    if by_twin.sound or by_twin.cause is None:
        by_mesh = _diagnose_by_mesh(declared, geometry, habit)
        # What else explains the numbers by themselves has to lead to the twin's: if not, the two just differ.
        if by_twin.sound or by_mesh.cause in _LOSSY or _agrees_with_twin(by_mesh.mended, twin):
            return by_mesh
        if by_mesh.cause not in {None, "unmirrored"} and _has_cause(twin, geometry, by_mesh):
            return by_mesh
        if habit is not None and by_mesh.cause == habit.id:  # the twin has it too, and they differ in something else
            return by_mesh
        by_twin = replace(by_twin, evidence=by_mesh.evidence)
    better = by_twin.cause is not None and _is_better_fit(twin, declared, geometry)
    # Several parts may be wrong in the same way, and only this one may have the numbers of its geometry.
    return replace(by_twin, at_fault=better or (trusted and not _is_better_fit(declared, twin, geometry)))


def measure_evidence(declared: DeclaredInertial, geometry: VisualGeometry | None) -> Evidence | None:
    """Measure how well the mistakes of a whole file explain the numbers of a link, whether or not they need an explanation; None
    where `diagnose_inertial` returns None."""
    if geometry is None or not is_computable(declared):
        return None
    if not has_computable_size(geometry.solid.com, geometry.solid.covariance):
        return None
    ranking = _rank_explanations(Suspect(declared, build_geometry_reference(geometry), geometry))
    return _collect_evidence(ranking)


def _diagnose_by_mesh(declared: DeclaredInertial, geometry: VisualGeometry, habit: Habit | None) -> Diagnosis:
    return _diagnose_against(declared, build_geometry_reference(geometry), geometry, habit)


def _agrees_with_twin(mended: DeclaredInertial | None, twin: DeclaredInertial) -> bool:
    if mended is None:
        return False
    covariance = compute_mass_covariance(twin.inertia, twin.mass)
    return max(measure_inertial_mismatch(mended, twin.com, covariance)) < EXACT


def _has_cause(twin: DeclaredInertial, geometry: VisualGeometry, found: Diagnosis) -> bool:
    """Whether the twin has the same mistake, judged by the drawing: both were exported alike, and differ in something else."""
    of_twin = _diagnose_against(twin, build_geometry_reference(geometry), geometry)
    return (of_twin.cause, of_twin.detail) == (found.cause, found.detail)


def _is_better_fit(one: DeclaredInertial, other: DeclaredInertial, geometry: VisualGeometry) -> bool:
    """Whether a part of this geometry has the numbers ``one`` much more likely than ``other``."""
    reference = build_geometry_reference(geometry)
    fit = measure_fit(reference, InertialBatch.from_inertials([one, other]), np.ones(2))
    scores = compute_log_likelihood(reference, fit, borrowed=np.zeros((2, 2)), is_other_body=np.zeros(2, dtype=bool))
    return bool(scores[0] - scores[1] > SIDE_MARGIN)


def _diagnose_against(
    declared: DeclaredInertial, reference: Reference, geometry: VisualGeometry | None, habit: Habit | None = None
) -> Diagnosis:
    if (sound := _accept_close_match(declared, reference)) is not None:
        return sound
    ranking = _rank_explanations(Suspect(declared, reference, geometry), habit)
    named = _can_be_named(declared, reference, ranking, habit)
    none, best = ranking.no_mistake, 0
    fit = ranking.fit
    tensor_mismatch, com_mismatch = float(fit.tensor_mismatch[none]), float(fit.com_mismatch[none])
    fits_geometry = bool(fit.inside[none])
    certain = named and len(ranking.contenders) == 1
    mended, com_order = (ranking.numbers[best], "") if certain else (None, "")
    mended_com_mismatch = float(fit.com_mismatch[best]) if named else com_mismatch
    if mended is not None and ranking.best.id in _OF_AXES and fit.tensor_mismatch[best] < EXACT < mended_com_mismatch:
        com, order = _reorder_com(declared, reference)
        if com_order := order:
            mended = replace(mended, com=com)
            mended_com_mismatch = float(np.linalg.norm(reference.whitening @ (com - reference.com)))
    return Diagnosis(
        sound=not named and fits_geometry and _is_unremarkable(reference, tensor_mismatch, com_mismatch),
        cause=_name_cause(ranking.contenders) if named else None,
        detail=" or ".join(dict.fromkeys(m.detail for m in ranking.contenders if m.detail)) if named else "",
        mended=mended,
        tensor_mismatch=tensor_mismatch,
        com_mismatch=com_mismatch,
        mended_tensor_mismatch=float(fit.tensor_mismatch[best]) if named else tensor_mismatch,
        mended_com_mismatch=mended_com_mismatch,
        min_moment_ratio=compute_min_moment_ratio(declared, reference),
        margin=ranking.margin,
        unique=certain and not com_order and _is_only_exact_explanation(ranking),
        com_order=com_order,
        ruled_out=_list_ruled_out(ranking, named=named),
        fits_geometry=fits_geometry,
        judged_by="mesh",
        at_fault=True,
        evidence=_collect_evidence(ranking) if habit is None else None,
    )


def _reorder_com(declared: DeclaredInertial, reference: Reference) -> tuple[Vec3, str]:
    """Return the COM with its coordinates in another order or with other signs, and the order in words, where these are the
    reference's to within `UNIFORM`; otherwise the COM as it is, and nothing."""
    com = declared.com
    for order in permutations(range(3)):
        signs = np.where(reference.com * com[list(order)] < 0.0, -1.0, 1.0)
        reordered = signs * com[list(order)]
        if float(np.linalg.norm(reference.whitening @ (reordered - reference.com))) < UNIFORM:
            return reordered, " ".join(
                f"{'-' if sign < 0 else ''}{'xyz'[i]}" for i, sign in zip(order, signs, strict=True)
            )
    return com, ""


def _collect_evidence(ranking: _Ranking) -> Evidence:
    """Collect what a ranking without a habit says about `HABITS`, each mistake of several forms by its likeliest."""
    likelihoods: dict[tuple[str, str], float] = {}
    priors: dict[tuple[str, str], float] = {}
    alternative = -math.inf
    for mistake, score in zip(ranking.mistakes, ranking.scores.tolist(), strict=True):
        if mistake.id not in HABITS:
            alternative = max(alternative, score)
        elif math.isfinite(score):
            key = mistake.id, mistake.detail
            likelihoods.setdefault(key, score - mistake.log_prior)
            priors.setdefault(key, mistake.log_prior)
    sound = float(ranking.scores[ranking.no_mistake])
    return Evidence(likelihoods=likelihoods, priors=priors, sound=sound, alternative=alternative)


def _accept_close_match(declared: DeclaredInertial, reference: Reference) -> Diagnosis | None:
    """Return the verdict on numbers that fit the reference so well that no mistake need be searched for; most do."""
    fit = measure_fit(reference, InertialBatch.from_inertials([declared]), np.ones(1))
    tensor_mismatch, com_mismatch = float(fit.tensor_mismatch[0]), float(fit.com_mismatch[0])
    log_size = float(fit.log_size[0])
    if reference.twin is not None:
        near = TWIN_MIXTURE[0][1] * 3.0
        usual = abs(log_size) < near
    else:
        near = CLOSED_MIXTURE[0][1] * 10.0
        usual = abs(log_size - math.log(TYPICAL_DENSITY)) < math.log(10.0)
    if not (fit.inside[0] and usual and max(tensor_mismatch, com_mismatch) < near):
        return None
    return Diagnosis(
        sound=True,
        cause=None,
        detail="",
        mended=None,
        tensor_mismatch=tensor_mismatch,
        com_mismatch=com_mismatch,
        mended_tensor_mismatch=tensor_mismatch,
        mended_com_mismatch=com_mismatch,
        min_moment_ratio=1.0,
        margin=math.inf,
        unique=False,
        ruled_out=(),
        fits_geometry=True,
        judged_by="mesh",
        at_fault=True,
    )


def _rank_explanations(suspect: Suspect, habit: Habit | None = None) -> _Ranking:
    declared, reference = suspect.declared, suspect.reference
    mistakes, numbers = list_explanations(suspect)
    if habit is not None:
        mistakes = [_weigh_by_habit(mistake, habit) for mistake in mistakes]
    fit = measure_fit(reference, numbers, np.array([mistake.factor for mistake in mistakes]))
    for i, mistake in enumerate(mistakes):
        if mistake.id == "wrong_formula":  # its numbers were compared digit by digit, and it says nothing about the COM
            fit.tensor_mismatch[i], fit.com_mismatch[i] = 0.0, fit.com_mismatch[0]
        elif mistake.source_body is not None:
            body = mistake.source_body
            tensor_mismatch, com_mismatch = measure_inertial_mismatch(declared, body.com, body.covariance)
            fit.tensor_mismatch[i] = tensor_mismatch
            # The COM may be that of the part nevertheless.
            fit.com_mismatch[i] = min(com_mismatch, float(fit.com_mismatch[0]))
    scores = compute_log_likelihood(
        reference,
        fit,
        borrowed=np.array([mistake.borrowed for mistake in mistakes]),
        is_other_body=np.array([mistake.source_body is not None for mistake in mistakes]),
    )
    scores += [mistake.log_prior for mistake in mistakes]
    scores[_is_meaningless_scaling(declared, reference, mistakes=mistakes, com=numbers.com)] = -np.inf
    scores[fit.com_mismatch >= [_get_com_tolerance(mistake) for mistake in mistakes]] = -np.inf
    order = np.argsort(-scores, kind="stable")
    return _Ranking(
        mistakes=tuple(mistakes[i] for i in order),
        scores=scores[order],
        fit=fit.take_rows(order),
        numbers=numbers.take_rows(order),
    )


def _weigh_by_habit(mistake: Mistake, habit: Habit) -> Mistake:
    """Return a mistake as frequent as it is in a file with a habit: one program exported it, so that others' are rare."""
    if (mistake.id, mistake.detail) == (habit.id, habit.detail):
        return replace(mistake, log_prior=habit.log_share)
    rarer = _SECOND_HABIT if mistake.id in HABITS else 0.0
    return replace(mistake, log_prior=mistake.log_prior + habit.log_rest + rarer)


def _get_com_tolerance(mistake: Mistake) -> float:
    """Return how far (radii of gyration) the COM may be from the reference's when the mistake is undone.

    Where the COM, or one of its coordinates, is multiplied and nothing else, by so little that many a COM outside the part gets
    near by chance, it has to agree: an inch, a centimetre, and closer still for a decimal point. Of millimetres one in a
    thousand does in each direction.
    """
    if mistake.id == "com_unit" and mistake.detail != "mm":
        return COM_NEAR
    if mistake.id == "decimal_point" and mistake.detail.startswith("com "):
        return COM_FITS
    return math.inf


def _is_whole_com(mistake: Mistake) -> bool:
    """Whether a lost decimal point is that of all three coordinates: ``com 0.1``, not ``com x 0.1``."""
    return mistake.detail.startswith("com ") and mistake.detail.count(" ") == 1


def _is_meaningless_scaling(
    declared: DeclaredInertial, reference: Reference, *, mistakes: Sequence[Mistake], com: Array
) -> Bools:
    """Whether (N,) a mistake scales a coordinate of the COM to next to zero: divided by ten or a thousand it would be there
    whatever it had been. ``com`` (N, 3): without each mistake."""
    shrunk = np.abs(com) < 0.5 * np.abs(declared.com)
    is_near_zero = np.linalg.norm(np.where(shrunk, com, 0.0) @ reference.whitening, axis=1) < _NEAR_ZERO
    scales_com = np.array([mistake.id in _SCALED for mistake in mistakes])
    meaningless: Bools = shrunk.any(axis=1) & is_near_zero & scales_com
    return meaningless


def _can_be_named(
    declared: DeclaredInertial, reference: Reference, ranking: _Ranking, habit: Habit | None = None
) -> bool:
    """Whether the best explanation is certain, convincing, and has an effect; of a ``habit`` a small one counts."""
    if ranking.is_same_correction[ranking.no_mistake] or not ranking.margin > MARGIN:
        return False
    if ranking.best.id in _PRECISE and len({_name_changed_number(mistake) for mistake in ranking.contenders}) > 1:
        return False
    if ranking.best.id in _UNITS and not _shows_unit(declared, reference, ranking):
        return False
    least = TWIN_LIKE if reference.twin is not None else EFFECT
    if habit is not None and ranking.best.id == habit.id:
        least = min(least, EXACT)
    return (
        _is_convincing(ranking, reference, is_habit=habit is not None and ranking.best.id == habit.id)
        and _measure_effect(declared, ranking.numbers[0], ranking.best.factor) > least
    )


def _shows_unit(declared: DeclaredInertial, reference: Reference, ranking: _Ranking) -> bool:
    """Whether the numbers are those of the part in another unit: not one number in place of three moments, which no unit makes
    of a part that is not round, and not a size that several units explain where the moments have no common ratio."""
    tensor = declared.tensor
    is_identity = bool((tensor == tensor[0, 0] * np.eye(3)).all())
    if is_identity and float(ranking.fit.tensor_mismatch[0]) > EFFECT:
        return False
    contenders = np.flatnonzero((ranking.leads <= MARGIN) & [m.id in _UNITS for m in ranking.mistakes])
    sizes = np.trace(ranking.numbers.tensor[contenders], axis1=1, axis2=2) / ranking.numbers.mass[contenders]
    if sizes.max() < (1.0 + _ONE_RATIO) * sizes.min():
        return True
    white = reference.whitening
    ratios = np.linalg.eigvalsh(white @ compute_mass_covariance(declared.inertia, declared.mass) @ white)
    return bool(ratios[0] > 0.0 and ratios[-1] < (1.0 + _ONE_RATIO) * ratios[0])


def _is_convincing(ranking: _Ranking, reference: Reference, *, is_habit: bool = False) -> bool:
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
        equal = tensor_mismatch < PROPORTIONAL and com_mismatch < EXACT
        return equal and bool(moments[-1] - moments[0] > _NOT_A_SPHERE * moments[-1])
    if twin is not None:  # the reference is not a uniform solid, but the numbers as they should be
        return worst < EXACT
    if best.id == "decimal_point" and best.detail.startswith(("mass ", "tensor ")):
        return worst < EFFECT  # a ratio of mass and tensor near ten may be a changed mass or a motor
    sizes = np.trace(ranking.numbers.tensor[[none, 0]], axis1=1, axis2=2) / ranking.numbers.mass[[none, 0]]
    is_vast = best.id in _UNITS and sizes[0] >= VAST**2 * sizes[1]
    if best.borrowed == (0, 0) and not is_vast:
        # A part with the COM (or the tensor) of its uniform solid has uniform density: the other has to agree as well.
        if float(fit.com_mismatch[none]) < UNIFORM and tensor_mismatch > 2 * EFFECT:
            return False
        if float(fit.tensor_mismatch[none]) < UNIFORM and com_mismatch > 2 * EFFECT:
            return False
    if reference.mixture is OPEN_MIXTURE and best.id not in _COARSE and not is_habit:
        return False
    one_number = best.id == "decimal_point" and not _is_whole_com(best)
    return worst < (FAR if is_habit or is_vast else NEAR / 2 if one_number else NEAR)


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


def _name_cause(contenders: Sequence[Mistake]) -> str:
    """Return the id of the mistake, or its family where contenders have several ids."""
    best = contenders[0]
    return best.id if len({mistake.id for mistake in contenders}) == 1 else _get_mistake_family(best)


def _get_mistake_family(mistake: Mistake) -> str:
    """Return what mistakes that differ only in their parameter have in common."""
    return _FAMILIES.get(mistake.id, mistake.id)


def _name_changed_number(mistake: Mistake) -> str:
    """Return which number a mistake in one number is about. The last word is the power of ten, which counts for a coordinate of
    the COM: one that is next to zero after any of them need not have lost a decimal point. Mass and tensor count as one: only
    their ratio shows."""
    has_power = mistake.id == "decimal_point" and not mistake.detail.startswith("com")
    name = mistake.detail.rpartition(" ")[0] if has_power else mistake.detail
    return "mass or tensor" if name in {"mass", "tensor"} else name


def _is_unremarkable(reference: Reference, tensor_mismatch: float, com_mismatch: float) -> bool:
    """Whether a part may well differ this much from its reference."""
    limit = TWIN_LIKE if reference.twin is not None else FAR
    return tensor_mismatch < limit and com_mismatch < limit


def _is_only_exact_explanation(ranking: _Ranking) -> bool:
    """Whether the best explanation agrees with the reference to within `EXACT`, and no other does that leads to other numbers
    and borrows none from the reference."""
    agrees = (ranking.fit.tensor_mismatch < EXACT) & (ranking.fit.com_mismatch < EXACT)
    others = np.flatnonzero(agrees & ~ranking.is_same_correction).tolist()
    return bool(agrees[0]) and not any(ranking.mistakes[i].borrowed == (0, 0) for i in others)


def _list_ruled_out(ranking: _Ranking, *, named: bool) -> tuple[str, ...]:
    """List the ids of the mistakes that do not explain the numbers, likeliest first."""
    family = _get_mistake_family(ranking.best)
    explaining = {"none"}
    if named:
        explaining |= {mistake.id for mistake in ranking.mistakes if _get_mistake_family(mistake) == family}
    return tuple(dict.fromkeys(mistake.id for mistake in ranking.mistakes if mistake.id not in explaining))
