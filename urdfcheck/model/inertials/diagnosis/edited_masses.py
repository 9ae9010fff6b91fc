"""Masses that were edited after the export: the tensors are still those of the masses that the CAD program had."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.inertials.certainty import PROPORTIONAL
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia
from urdfcheck.facts.inertials.inertial_fit import measure_inertial_mismatch
from urdfcheck.facts.inertials.mistakes.mixing_mistakes import is_default_density
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_link_geometry

if TYPE_CHECKING:
    from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
    from urdfcheck.facts.inertials.diagnosis import Diagnosis

# So many different links fit another mass, unless that of one gives its part the density of a CAD program without a material.
_FEWEST = 2
# Copies of a part agree in so many digits.
_DIGITS = 3


def shows_edited_masses(model: Model, numbers: Mapping[str, DeclaredInertial], found: Mapping[str, Diagnosis]) -> bool:
    """Whether the masses of a file were edited and not its tensors, by what was ``found`` about its links.

    Then a tensor of any size is that of some mass, and one that fits a unit does so by chance.
    """
    keys = set()
    for name, diagnosis in found.items():
        if diagnosis.cause != "other_mass" or diagnosis.judged_by != "mesh" or diagnosis.mended is None:
            continue
        declared = numbers[name]
        times = float(np.trace(declared.tensor) / np.trace(diagnosis.mended.tensor))
        if is_default_density(measure_link_geometry(model, model.link_by_name[name]), declared.mass * times):
            return True
        moments = np.linalg.eigvalsh(declared.tensor)
        keys.add(tuple(f"{value:.{_DIGITS}g}" for value in (declared.mass, *moments)))
    return len(keys) >= _FEWEST


def name_edited_masses(
    model: Model, numbers: Mapping[str, DeclaredInertial], found: Mapping[str, Diagnosis]
) -> dict[str, Diagnosis]:
    """Return the verdicts with the cause ``other_mass`` in place of a unit that nearly fits a link's tensor, where the masses of
    the file were edited."""
    units = [
        name
        for name, one in found.items()
        if one.cause == "inertia_unit" and one.judged_by == "mesh" and one.mended_tensor_mismatch > PROPORTIONAL
    ]
    if not units or not shows_edited_masses(model, numbers, found):
        return dict(found)
    named = dict(found)
    for name in units:
        drawn, declared = measure_link_geometry(model, model.link_by_name[name]), numbers[name]
        if drawn is None:
            continue
        uniform = compute_solid_inertia(drawn.solid, declared.mass)
        times = float(np.trace(declared.inertia) / np.trace(uniform))
        mended = replace(declared, tensor=declared.tensor / times)
        named[name] = replace(
            found[name],
            cause="other_mass",
            detail=f"{float(f'{declared.mass * times:.3g}'):,g} kg",
            mended=mended,
            mended_tensor_mismatch=measure_inertial_mismatch(mended, drawn.solid.com, drawn.solid.covariance)[0],
            ruled_out=tuple(cause for cause in found[name].ruled_out if cause != "other_mass"),
            unique=False,
        )
    return named
