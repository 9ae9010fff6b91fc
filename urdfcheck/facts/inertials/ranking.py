"""Every explanation of the numbers of an inertial, the best first."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.inertial_fit import (
    InertialBatch,
    InertialFit,
    Reference,
    compute_log_likelihood,
    measure_fit,
    measure_inertial_mismatch,
)
from urdfcheck.facts.inertials.mistakes.file_habits import Habit, can_be_habit
from urdfcheck.facts.inertials.mistakes.mistake import Mistake, Suspect
from urdfcheck.facts.inertials.mistakes.mixing_mistakes import is_default_density, list_explanations

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Bools
    from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial

# A cause is named when it beats every other explanation by this many nats (e⁵ = 150 : 1).
MARGIN = 5.0
# What scales the COM alone, by an inch or a centimetre, has to leave it nearer than that.
COM_NEAR = 1.2
# A decimal point of the whole COM is no unit in use: it has to fit as a uniform part's does.
COM_FITS = 0.3
# Logarithm of how much rarer the mistake of another program is in a file with a habit: 1 in 20.
_SECOND_HABIT = -3.0
# A coordinate that is less than a third of a radius of gyration from zero says nothing about the number that it was.
_NEAR_ZERO = 0.3
# Mistakes that are told together where it is not certain which of them was made, by the one that both have in common.
_FAMILIES = {"inertia_unit": "units", "positive_notation": "about_origin"}
# Mistakes whose numbers were compared one by one already, and that say nothing about the COM.
_COMPARED = frozenset({"wrong_formula", "own_missing"})
# A unit of mass that changes it by less is no cause where the tensor is that of the drawn part at the density that CAD programs
# give a part without a material: then the mass was changed later.
_SMALL_UNIT = 5.0
# Mistakes that only scale a COM.
_SCALED = frozenset({"com_unit", "decimal_point"})


@dataclass(frozen=True, eq=False, kw_only=True)
class Ranking:
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
        return self._find_same_corrections(0)

    @cached_property
    def margin(self) -> float:
        """Lead over the best explanation of another family that leads to other numbers; infinite if there is none."""
        family = get_mistake_family(self.best)
        rivals = zip(self.mistakes, self.is_same_correction, self.leads, strict=True)
        leads = (float(lead) for mistake, same, lead in rivals if not same and get_mistake_family(mistake) != family)
        return next(leads, math.inf)

    @cached_property
    def contenders(self) -> list[Mistake]:
        """The best explanation, and those within the margin that lead to other numbers: a mistake may be certain while its
        parameter is not, such as which axes were swapped, or which of two units."""
        is_left = self.leads <= MARGIN
        found = []
        while is_left.any():
            found.append(int(is_left.argmax()))
            is_left &= ~self._find_same_corrections(found[-1])
            is_left[found[-1]] = False
        return [self.mistakes[i] for i in found or (0,)]

    def _find_same_corrections(self, i: int) -> Bools:
        """Return whether (N,) undoing each mistake leads to the same numbers and scale as undoing mistake ``i``."""
        same: Bools = self.numbers.find_equal_rows(i) & [m.factor == self.mistakes[i].factor for m in self.mistakes]
        return same


def rank_explanations(suspect: Suspect, habit: Habit | None = None) -> Ranking:
    declared, reference = suspect.declared, suspect.reference
    mistakes, numbers = list_explanations(suspect)
    if habit is not None:
        mistakes = [_weigh_by_habit(mistake, habit) for mistake in mistakes]
    fit = measure_fit(reference, numbers, np.array([mistake.factor for mistake in mistakes]))
    for i, mistake in enumerate(mistakes):
        if mistake.id in _COMPARED:
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
    scores[_is_later_mass(suspect, mistakes, numbers)] = -np.inf
    scores[fit.com_mismatch >= [_get_com_tolerance(mistake) for mistake in mistakes]] = -np.inf
    order = np.argsort(-scores, kind="stable")
    return Ranking(
        mistakes=tuple(mistakes[i] for i in order),
        scores=scores[order],
        fit=fit.take_rows(order),
        numbers=numbers.take_rows(order),
    )


def _is_later_mass(suspect: Suspect, mistakes: Sequence[Mistake], numbers: InertialBatch) -> Bools:
    """Whether (N,) a mistake is a small unit of mass, and the drawn part has the default density of CAD programs without it."""
    found = [
        mistake.id == "mass_unit"
        and suspect.declared.mass < _SMALL_UNIT * mass
        and is_default_density(suspect.geometry, mass)
        for mistake, mass in zip(mistakes, numbers.mass.tolist(), strict=True)
    ]
    return np.array(found)


def _weigh_by_habit(mistake: Mistake, habit: Habit) -> Mistake:
    """Return a mistake as frequent as it is in a file with a habit: one program exported it, so that others' are rare."""
    if (mistake.id, mistake.detail) == (habit.id, habit.detail):
        return replace(mistake, log_prior=habit.log_share)
    rarer = _SECOND_HABIT if can_be_habit(mistake.id, mistake.detail) else 0.0
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


def is_whole_com(mistake: Mistake) -> bool:
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


def get_mistake_family(mistake: Mistake) -> str:
    """Return what mistakes that differ only in their parameter have in common."""
    return _FAMILIES.get(mistake.id, mistake.id)
