"""Tensors that an expression computes: no decimal point slips in a formula, but its mass may be another than the link's."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.inertials.certainty import PROPORTIONAL
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia
from urdfcheck.model.parts import TENSOR_NAMES, Link
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_link_geometry

if TYPE_CHECKING:
    from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
    from urdfcheck.facts.inertials.diagnosis import Diagnosis

# The moments in URDF's order of the six numbers.
_MOMENTS = (TENSOR_NAMES[0], TENSOR_NAMES[3], TENSOR_NAMES[5])


def name_computed_mass(model: Model, link: Link, declared: DeclaredInertial, found: Diagnosis) -> Diagnosis:
    """Return the verdict with the cause ``other_mass`` in place of a decimal point of the mass or of the whole tensor, where an
    expression computes the tensor and the drawn part has it at another mass."""
    slips = [detail.partition(" ")[0] for detail in found.detail.split(" or ")]
    if found.cause != "decimal_point" or found.judged_by != "mesh" or not set(slips) <= {"mass", "tensor"}:
        return found
    drawn = measure_link_geometry(model, link)
    if drawn is None or not _is_computed(link) or not found.mended_tensor_mismatch < PROPORTIONAL:
        return found
    uniform = compute_solid_inertia(drawn.solid, declared.mass)
    times = float(np.trace(declared.inertia) / np.trace(uniform))
    return replace(
        found,
        cause="other_mass",
        detail=f"{declared.mass * times:.3g} kg",
        mended=replace(declared, tensor=declared.tensor / times),
        ruled_out=tuple(name for name in found.ruled_out if name != "other_mass"),
        unique=False,
    )


def _is_computed(link: Link) -> bool:
    """Whether no moment of a link was typed as a number."""
    element = None if link.inertial is None else link.inertial.tensor_element
    if element is None:
        return False
    moments = [element.attributes.get(name) for name in _MOMENTS]
    return all(moment is not None and not moment.literal for moment in moments)
