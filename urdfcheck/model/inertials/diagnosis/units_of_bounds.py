"""A unit of the mass that only the density of a collision shape shows: with masses in kilograms, another unit fits, too."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from urdfcheck.model.inertials.habits.tensor_units import TENSOR_UNITS
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import explain_collision_stand_in, measure_link_geometry

if TYPE_CHECKING:
    from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
    from urdfcheck.facts.inertials.diagnosis import Diagnosis

# Units of mass, tensor and COM, and those that explain the last two in the same way.
_IN_KILOGRAMS = {
    "g and g·mm²": "kg·mm²",
    "g and g·mm², mm": "kg and kg·mm², mm",
    "g and g·cm²": "kg·cm²",
    "g and g·cm², cm": "kg and kg·cm², cm",
}


def doubt_units_of_bounds(
    model: Model,
    numbers: Mapping[str, DeclaredInertial],
    found: Mapping[str, Diagnosis],
    habit: tuple[str, str] | None,
) -> dict[str, Diagnosis]:
    """Return the verdicts. Where only the density of a collision shape says that a mass is in grams, and the masses of the file
    are as large, the tensor has the unit of the file's ``habit``, or both readings are named."""
    return {name: _doubt_unit(model, name, numbers, found, habit) for name in found}


def _doubt_unit(
    model: Model,
    name: str,
    numbers: Mapping[str, DeclaredInertial],
    found: Mapping[str, Diagnosis],
    habit: tuple[str, str] | None,
) -> Diagnosis:
    one, link = found[name], model.link_by_name[name]
    units = one.detail.split(" or ")
    if one.cause != "units" or one.judged_by != "mesh" or (one.cause, one.detail) == habit:
        return one
    readings = list(dict.fromkeys(_IN_KILOGRAMS.get(unit, unit) for unit in units))
    drawn = measure_link_geometry(model, link)
    if len(readings) > 1 or readings == units or drawn is None or explain_collision_stand_in(model, link) is None:
        return one
    declared, (reading,) = numbers[name], readings
    others = (
        other.mass for other in model.masses if other.link is not link and not _is_like(found, other.link.name, one)
    )
    if max(others, default=0.0) < declared.mass:
        return one
    if habit == ("inertia_unit", reading):
        mended = replace(declared, tensor=declared.tensor * TENSOR_UNITS[reading])
        return replace(one.name_cause("inertia_unit", mended, drawn.solid, unique=False), detail=reading)
    return replace(one, detail=" or ".join(dict.fromkeys((reading, *units))), mended=None, unique=False)


def _is_like(found: Mapping[str, Diagnosis], name: str, one: Diagnosis) -> bool:
    other = found.get(name)
    return other is not None and (other.cause, other.detail) == (one.cause, one.detail)
