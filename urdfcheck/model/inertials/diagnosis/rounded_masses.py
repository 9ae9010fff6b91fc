"""Tensors in another unit beside masses of one or two digits: the ratio of the two is not that of the unit to the last digit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.inertials.certainty import EXACT, PROPORTIONAL
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia, list_half_units
from urdfcheck.facts.inertials.inertial_fit import measure_inertial_mismatch
from urdfcheck.model.inertials.habits.tensor_units import TENSOR_UNITS
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_link_geometry

if TYPE_CHECKING:
    from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
    from urdfcheck.facts.inertials.diagnosis import Diagnosis

# A digit that is off by more, as in 0.001, says too little of the mass.
_COARSEST = 0.15
# What tessellation and the digits of the tensor leave, as a share of the mass.
_SLACK = 0.005


def name_units_of_rounded_masses(
    model: Model, numbers: Mapping[str, DeclaredInertial], found: Mapping[str, Diagnosis]
) -> dict[str, Diagnosis]:
    """Return the verdicts, with the cause ``inertia_unit`` in place of another mass, or of none, where the mass that a tensor
    fits in that unit rounds to the typed one."""
    named = dict(found)
    for name, one in found.items():
        if (
            one.sound
            or one.judged_by != "mesh"
            or one.cause not in {None, "other_mass"}
            or not one.com_mismatch < EXACT
        ):
            continue
        drawn, declared = measure_link_geometry(model, model.link_by_name[name]), numbers[name]
        if drawn is None or not drawn.closed:
            continue
        times = float(np.trace(declared.inertia) / np.trace(compute_solid_inertia(drawn.solid, declared.mass)))
        unit = _find_unit(declared.mass, times)
        if unit is None:
            continue
        scaled = replace(declared, tensor=declared.tensor / times)
        if measure_inertial_mismatch(scaled, drawn.solid.com, drawn.solid.covariance)[0] > PROPORTIONAL:
            continue
        mended = replace(declared, tensor=declared.tensor * TENSOR_UNITS[unit])
        ruled_out = tuple(cause for cause in one.ruled_out if cause not in {"inertia_unit", "units"})
        verdict = replace(one, ruled_out=ruled_out).name_cause("inertia_unit", mended, drawn.solid, unique=False)
        named[name] = replace(verdict, detail=unit)
    return named


def _find_unit(mass: float, times: float) -> str | None:
    """Return the unit in which a tensor, ``times`` as large as that of a uniform part of this ``mass`` (kg), belongs to a mass
    that rounds to it; None where there is none."""
    within = min(_COARSEST, list_half_units([repr(mass).removesuffix(".0")])[0] / mass + _SLACK)
    fitting = [name for name, factor in TENSOR_UNITS.items() if abs(times * factor - 1.0) <= within]
    return fitting[0] if fitting else None
