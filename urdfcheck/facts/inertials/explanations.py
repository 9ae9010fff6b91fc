"""Every explanation of an inertial: the mistakes that may have been made, and the numbers without each."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.inertials.inertial_fit import InertialBatch
from urdfcheck.facts.inertials.mistakes import COMPONENT_INDICES, Mistake, Suspect
from urdfcheck.facts.inertials.mixing_mistakes import MIXING_MISTAKES
from urdfcheck.facts.inertials.multiplying_mistakes import MULTIPLYING_MISTAKES

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# The component at each of the nine places of the matrix, row by row.
_TO_MATRIX = (0, 1, 2, 1, 3, 4, 2, 4, 5)


def list_explanations(suspect: Suspect) -> tuple[list[Mistake], InertialBatch]:
    """List every mistake, "none" first, and the numbers without it."""
    declared = suspect.declared
    multiplying, mass, com, components = _stack_multipliers()
    typed = np.array([declared.tensor[place] for place in COMPONENT_INDICES])
    multiplied = InertialBatch(
        mass=mass * declared.mass,
        com=com * declared.com,
        tensor=(components @ typed)[:, _TO_MATRIX].reshape(-1, 3, 3),
        rotation=np.broadcast_to(declared.rotation, (len(multiplying), 3, 3)),
    )
    others = [corrected for undo in MIXING_MISTAKES for corrected in undo(suspect)]
    mistakes = [*multiplying, *(mistake for mistake, _ in others)]
    return mistakes, multiplied.concatenate_with(InertialBatch.from_inertials([numbers for _, numbers in others]))


@cache
def _stack_multipliers() -> tuple[tuple[Mistake, ...], Array, Array, Array]:
    """Return the multiplying mistakes, and what the mass (N,), the COM (N, 3) and the components (N, 6, 6) are multiplied by."""
    pairs = [pair for undo in MULTIPLYING_MISTAKES for pair in undo()]
    return (
        tuple(mistake for mistake, _ in pairs),
        np.array([multiplier.mass for _, multiplier in pairs]),
        np.array([multiplier.com for _, multiplier in pairs]),
        np.array([multiplier.components for _, multiplier in pairs]),
    )
