"""Tensors of two bodies that were added without the parallel-axis term, where the mesh does not show the bodies one by one."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.inertials.certainty import UNIFORM
from urdfcheck.facts.inertials.inertia_tensor import compute_covariance_inertia, compute_mass_covariance
from urdfcheck.facts.inertials.inertial_fit import has_computable_size, is_computable, measure_inertial_mismatch
from urdfcheck.facts.inertials.mistakes.mistake import EFFECT

if TYPE_CHECKING:
    from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
    from urdfcheck.facts.inertials.diagnosis import Diagnosis
    from urdfcheck.facts.inertials.inertia_tensor import Solid

# The variances across the line of the two bodies are the drawn part's to within this share of themselves.
_AGREE = 0.01


def find_unmoved_pieces(found: Diagnosis, declared: DeclaredInertial, solid: Solid) -> Diagnosis | None:
    """Return the verdict on a tensor that lacks the parallel-axis term of two bodies; None where that is not shown.

    The term of two bodies is ``m₁ m₂ / m · d²`` along the line ``d`` between their COMs, and nothing across it: so the second
    moments are those of the ``solid`` in every direction across that line, and less along it. Nothing but that line is taken
    from the drawing, so it proves something only in a file in which another link has the mistake.
    """
    if not is_computable(declared) or not has_computable_size(solid.com, solid.covariance):
        return None
    if measure_inertial_mismatch(declared, solid.com, solid.covariance)[1] > UNIFORM:
        return None
    own = compute_mass_covariance(declared.inertia, declared.mass)
    missing, axes = np.linalg.eigh(solid.covariance - own)
    drawn = np.einsum("ij,ik,kj->j", axes, solid.covariance, axes)  # the variance along each axis
    is_alike = bool((np.abs(missing[:2]) < _AGREE * drawn[:2]).all())
    if not is_alike or not EFFECT * drawn[2] < missing[2] < drawn[2]:
        return None
    line = axes[:, 2]
    inertia = compute_covariance_inertia(own + missing[2] * np.outer(line, line), declared.mass)
    mended = replace(declared, tensor=declared.rotation.T @ inertia @ declared.rotation)
    return found.name_cause("steiner_missing", mended, solid, unique=True)
