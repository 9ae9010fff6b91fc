"""Masses with a wrong decimal point, which no material has in what is drawn: density and tensor both show the right one."""

from __future__ import annotations

import math

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia
from urdfcheck.facts.inertials.materials import DENSEST, is_part_density
from urdfcheck.model.parts import Link
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import has_unit_ambiguity, measure_link_geometry

# Powers of ten that a mass is too large by.
_POWERS = (1, 2, 3, 4)
# The moments of a part with a hub or a motor in it, to those of its uniform solid.
_LIKE_TENSOR = 2.0


@dataclass(frozen=True, slots=True)
class SlippedMass:
    """A mass without the slip."""

    mass: float
    """kg"""
    power: int
    """The power of ten that what is written is larger by."""
    volume: float
    """m³, that the link draws."""

    @property
    def density(self) -> float:
        """In kg/m³."""
        return self.mass / self.volume


def find_slipped_mass(model: Model, link: Link) -> SlippedMass | None:
    """Find the mass that a link would have with another decimal point, where what it draws would be denser than any material,
    and with it is a part of an ordinary one, whose tensor the link has; None elsewhere."""
    declared, tensor = model.mass_by_name.get(link.name), model.tensor_by_name.get(link.name)
    drawn = measure_link_geometry(model, link)
    if declared is None or tensor is None or drawn is None or not drawn.closed:
        return None
    volume = drawn.solid.volume
    if not 0.0 < DENSEST * volume < declared.mass or has_unit_ambiguity(model, (link.name,)):
        return None
    uniform = np.linalg.eigvalsh(compute_solid_inertia(drawn.solid, 1.0))
    own_mass = np.linalg.eigvalsh(tensor.tensor) / uniform  # what the tensor says that the mass is, three times
    for power in _POWERS:
        mass = declared.mass * 10.0**-power
        fits = np.abs(np.log(np.maximum(own_mass, 1e-300) / mass)).max() < math.log(_LIKE_TENSOR)
        if is_part_density(mass / volume) and fits:
            return SlippedMass(mass, power, volume)
    return None
