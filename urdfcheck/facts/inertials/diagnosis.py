"""Why a declared inertia is not that of the drawn part: every common mistake is undone, and the result is compared.

Each hypothesis turns the declared numbers into those without one mistake. Its score is the logarithm of how often the mistake
is made, plus that of how likely the corrected numbers are for a part of this shape. A cause is named only if its score beats
every other explanation, "no mistake" among them, by a margin.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import permutations
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.certainty import EXACT, FAR, TWIN_LIKE, UNIFORM, can_be_named
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial, VisualGeometry
from urdfcheck.facts.inertials.inertia_tensor import Solid, compute_covariance_inertia, compute_mass_covariance
from urdfcheck.facts.inertials.inertial_fit import (
    CLOSED_MIXTURE,
    TWIN_MIXTURE,
    TYPICAL_DENSITY,
    InertialBatch,
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
from urdfcheck.facts.inertials.materials import DENSEST
from urdfcheck.facts.inertials.mistakes.file_habits import Evidence, Habit, can_be_habit
from urdfcheck.facts.inertials.mistakes.mistake import Mistake, Suspect
from urdfcheck.facts.inertials.ranking import Ranking, get_mistake_family, rank_explanations

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Vec3

# One of two parts is wrong when its numbers are this many nats less likely for its mesh.
SIDE_MARGIN = 5.0
# The three products of inertia in a tensor.
_PRODUCTS = (np.array((0, 0, 1)), np.array((1, 2, 2)))
# Products of a part, relative to its largest moment, that tessellation does not make; and how much products of one part differ
# in length, and in direction (a cosine), by what is not drawn.
_SHOWN_PRODUCTS, _ALIKE, _OPPOSED = 1e-3, 2.0, 0.95
# Mistakes of the axes, which the COM may have in another way than the tensor.
_OF_AXES = frozenset({"quarter_turn", "axes_permuted"})
# Mistakes that lost the part's own numbers, or are not in them, so that undoing them does not lead to those of its twin.
_LOSSY = frozenset(
    {
        *("shell", "bounding_box", "convex_hull", "one_piece", "steiner_missing", "own_missing"),
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
    tessellation leave; or the numbers show by themselves that they have the mistake of their file."""
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

    def name_cause(self, cause: str, mended: DeclaredInertial, solid: Solid, *, unique: bool) -> Diagnosis:
        """Return the verdict with a mistake without parameters as the cause. ``mended``: the numbers with it undone; ``solid``:
        the drawn part, by which they are judged."""
        tensor_mismatch, com_mismatch = measure_inertial_mismatch(mended, solid.com, solid.covariance)
        return replace(
            self,
            sound=False,
            cause=cause,
            detail="",
            mended=mended,
            mended_tensor_mismatch=tensor_mismatch,
            mended_com_mismatch=com_mismatch,
            unique=unique,
        )


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
        if habit is not None and habit.is_like(by_mesh.cause or "", by_mesh.detail):
            return by_mesh  # the twin has it too, and they differ in something else
        by_twin = replace(by_twin, evidence=by_mesh.evidence)
    better = by_twin.cause is not None and _is_better_fit(twin, declared, geometry)
    # Several parts may be wrong in the same way, and only this one may have the numbers of its geometry.
    return replace(by_twin, at_fault=better or (trusted and not _is_better_fit(declared, twin, geometry)))


def find_close_match(declared: DeclaredInertial, geometry: VisualGeometry, limit: float) -> Diagnosis | None:
    """Diagnose numbers that may be those of a geometry: None unless they are sound and both mismatches are below ``limit``. Where
    one is not, no mistake is searched for."""
    solid = geometry.solid
    if not is_computable(declared) or not has_computable_size(solid.com, solid.covariance):
        return None
    slack = 1.0 + 1e-6  # the same numbers, computed in another order
    if not max(measure_inertial_mismatch(declared, solid.com, solid.covariance)) < slack * limit:
        return None
    found = diagnose_inertial(declared, geometry)
    is_close = found is not None and found.sound and max(found.tensor_mismatch, found.com_mismatch) < limit
    return found if is_close else None


def measure_evidence(declared: DeclaredInertial, geometry: VisualGeometry | None) -> Evidence | None:
    """Measure how well the mistakes of a whole file explain the numbers of a link, whether or not they need an explanation; None
    where `diagnose_inertial` returns None."""
    if geometry is None or not is_computable(declared):
        return None
    if not has_computable_size(geometry.solid.com, geometry.solid.covariance):
        return None
    ranking = rank_explanations(Suspect(declared, build_geometry_reference(geometry), geometry))
    return _collect_evidence(ranking)


def _diagnose_by_mesh(declared: DeclaredInertial, geometry: VisualGeometry, habit: Habit | None) -> Diagnosis:
    reference = build_geometry_reference(geometry)
    found = _diagnose_against(declared, reference, geometry, habit)
    if habit is None or habit.id != "products_sign" or found.cause is not None or not geometry.closed:
        return found
    return _join_flipped_products(found, declared, reference)


def _join_flipped_products(found: Diagnosis, declared: DeclaredInertial, reference: Reference) -> Diagnosis:
    """Return the verdict on a link of a file whose products have flipped signs: its own products may be too small to matter, but
    they show their signs where they are the drawn part's and point the other way."""
    uniform = compute_covariance_inertia(reference.covariance, declared.mass)
    drawn = declared.rotation.T @ uniform @ declared.rotation
    products, expected = declared.tensor[_PRODUCTS], drawn[_PRODUCTS]
    size = float(np.linalg.norm(expected))
    if not size > _SHOWN_PRODUCTS * float(drawn.diagonal().max()):
        return found
    length = float(np.linalg.norm(products))
    if not size / _ALIKE < length < size * _ALIKE or float(products @ expected) > -_OPPOSED * size * length:
        return found
    moments = np.diag(declared.tensor.diagonal())
    mended = replace(declared, tensor=2.0 * moments - declared.tensor)
    tensor_mismatch, com_mismatch = measure_inertial_mismatch(mended, reference.com, reference.covariance)
    return replace(
        found,
        sound=False,
        cause="products_sign",
        detail="",
        mended=mended,
        mended_tensor_mismatch=float(tensor_mismatch),
        mended_com_mismatch=float(com_mismatch),
        unique=True,
    )


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
    """Whether a part of this geometry has the numbers ``one`` much more likely than ``other``. No part is denser than any
    material."""
    if geometry.hull is not None:
        possible = [numbers.mass <= DENSEST * geometry.hull.volume for numbers in (one, other)]
        if possible[0] != possible[1]:
            return possible[0]
    reference = build_geometry_reference(geometry)
    fit = measure_fit(reference, InertialBatch.from_inertials([one, other]), np.ones(2))
    scores = compute_log_likelihood(reference, fit, borrowed=np.zeros((2, 2)), is_other_body=np.zeros(2, dtype=bool))
    return bool(scores[0] - scores[1] > SIDE_MARGIN)


def _diagnose_against(
    declared: DeclaredInertial, reference: Reference, geometry: VisualGeometry | None, habit: Habit | None = None
) -> Diagnosis:
    if (sound := _accept_close_match(declared, reference)) is not None:
        return sound
    ranking = rank_explanations(Suspect(declared, reference, geometry), habit)
    named = can_be_named(declared, reference, ranking, habit)
    contenders = _list_named_mistakes(ranking, habit)
    none, best = ranking.no_mistake, 0
    fit = ranking.fit
    tensor_mismatch, com_mismatch = float(fit.tensor_mismatch[none]), float(fit.com_mismatch[none])
    fits_geometry = bool(fit.inside[none])
    certain = named and len(contenders) == 1
    mended, com_order = (ranking.numbers[best], "") if certain else (None, "")
    mended_com_mismatch = float(fit.com_mismatch[best]) if named else com_mismatch
    if mended is not None and ranking.best.id in _OF_AXES and fit.tensor_mismatch[best] < EXACT < mended_com_mismatch:
        com, order = _reorder_com(declared, reference)
        if com_order := order:
            mended = replace(mended, com=com)
            mended_com_mismatch = float(np.linalg.norm(reference.whitening @ (com - reference.com)))
    return Diagnosis(
        sound=not named and fits_geometry and _is_unremarkable(reference, tensor_mismatch, com_mismatch),
        cause=_name_cause(contenders) if named else None,
        detail=" or ".join(dict.fromkeys(m.detail for m in contenders if m.detail)) if named else "",
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


def _collect_evidence(ranking: Ranking) -> Evidence:
    """Collect what a ranking without a habit says about `HABITS`, each mistake of several forms by its likeliest."""
    likelihoods: dict[tuple[str, str], float] = {}
    priors: dict[tuple[str, str], float] = {}
    alternative = -math.inf
    for mistake, score in zip(ranking.mistakes, ranking.scores.tolist(), strict=True):
        if not can_be_habit(mistake.id, mistake.detail):
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


def _list_named_mistakes(ranking: Ranking, habit: Habit | None) -> list[Mistake]:
    """List the contenders. Centimetres of a COM that has one coordinate are named as the decimal point of that number, which
    leads to the same numbers: no program writes one link of a file in centimetres."""
    best, *others = ranking.contenders
    if (
        best.id == "com_unit"
        and best.detail == "cm"
        and not (habit is not None and habit.is_like(best.id, best.detail))
    ):
        same = np.flatnonzero(ranking.is_same_correction).tolist()
        slips = [ranking.mistakes[i] for i in same if ranking.mistakes[i].id == "decimal_point"]
        best = next(iter(slips), best)
    return [best, *others]


def _name_cause(contenders: Sequence[Mistake]) -> str:
    """Return the id of the mistake, or its family where contenders have several ids."""
    best = contenders[0]
    return best.id if len({mistake.id for mistake in contenders}) == 1 else get_mistake_family(best)


def _is_unremarkable(reference: Reference, tensor_mismatch: float, com_mismatch: float) -> bool:
    """Whether a part may well differ this much from its reference."""
    limit = TWIN_LIKE if reference.twin is not None else FAR
    return tensor_mismatch < limit and com_mismatch < limit


def _is_only_exact_explanation(ranking: Ranking) -> bool:
    """Whether the best explanation agrees with the reference to within `EXACT`, and no other does that leads to other numbers
    and borrows none from the reference."""
    agrees = (ranking.fit.tensor_mismatch < EXACT) & (ranking.fit.com_mismatch < EXACT)
    others = np.flatnonzero(agrees & ~ranking.is_same_correction).tolist()
    return bool(agrees[0]) and not any(ranking.mistakes[i].borrowed == (0, 0) for i in others)


def _list_ruled_out(ranking: Ranking, *, named: bool) -> tuple[str, ...]:
    """List the ids of the mistakes that do not explain the numbers, likeliest first."""
    family = get_mistake_family(ranking.best)
    explaining = {"none"}
    if named:
        explaining |= {mistake.id for mistake in ranking.mistakes if get_mistake_family(mistake) == family}
    return tuple(dict.fromkeys(mistake.id for mistake in ranking.mistakes if mistake.id not in explaining))
