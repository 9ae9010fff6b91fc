"""Placeholder inertia tensors: the round numbers typed only to make a program accept the file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from urdfcheck.facts.inertials.materials import DENSEST_PART, LIGHTEST

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array
    from urdfcheck.facts.inertials.inertia_tensor import Solid

# First digits of placeholders: the steps of a 1-2-5 series.
_ROUND = (1.0, 2.0, 5.0)
# Nobody computes a multiple of the identity of so few digits, except for a ball or a cube.
_FEW_DIGITS = 2
# The radius of gyration below which a tensor describes a point mass (see `urdfcheck.model.rigid_bodies.POINT_RADIUS`).
_POINT = 1e-6
# A round mass (kg) up to this is a placeholder too.
_NO_MASS = 1e-6
# What onshape-to-robot writes for a part without a material (kg).
ONSHAPE_UNKNOWN = 1e-9


def describe_placeholder(mass: float, components: Sequence[float]) -> str | None:
    """Describe why a tensor (``components``: ``ixx ixy ixz iyy iyz izz`` in kg m², of a body of ``mass`` in kg) looks typed
    rather than computed; None if it does not.

    A placeholder is a multiple of the identity whose factor has one or two digits, or a diagonal of powers of ten. A sphere or a
    cube can have the former, so the caller compares it with what is drawn. Point masses (radius of gyration up to 1e-6 m) do
    not count.
    """
    ixx, ixy, ixz, iyy, iyz, izz = components
    moments = (ixx, iyy, izz)
    if any((ixy, ixz, iyz)) or not all(math.isfinite(m) and m > 0.0 for m in (mass, *moments)):
        return None
    if max(moments) <= mass * _POINT**2:
        return None
    if ixx == iyy == izz and float(f"{ixx:.{_FEW_DIGITS - 1}e}") == ixx:
        return f"{ixx:g} × identity"
    if all(_extract_significand(m) == 1.0 for m in moments):
        return f"powers of ten ({ixx:g}, {iyy:g}, {izz:g})"
    return None


def is_round(value: float) -> bool:
    """Whether a positive number has 1, 2 or 5 as its only significant digit."""
    return _extract_significand(value) in _ROUND


def describe_unknown_mass(mass: float) -> str:
    """Say what to do about the ``mass`` (kg) that a program or a person writes where it is unknown; empty for any other mass."""
    if not _stands_for_none(mass):
        return ""
    shown = f"{mass:g}".replace("e-0", "e-")
    writer = ": onshape-to-robot writes it for parts without a material" if mass == ONSHAPE_UNKNOWN else ""
    return f"write the mass of the part ({shown} stands for none{writer})"


def is_unknown_mass(mass: float, tensor: Array, solid: Solid, *, is_of_all: bool = False) -> bool:
    """Whether a ``mass`` (kg) is a placeholder that does not show what the ``tensor`` (3, 3) in kg m² should be, which is one
    that the drawn ``solid`` can have at its real mass. ``is_of_all``: one round number is the mass of every link of a
    robot below a gram; where no material makes the solid so light, it stands for none too."""
    if not _stands_for_none(mass) and not (is_of_all and mass < LIGHTEST * solid.volume):
        return False
    from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia  # loads numpy

    heaviest = compute_solid_inertia(solid, DENSEST_PART * solid.volume)
    return bool(tensor.trace() <= heaviest.trace())


def _stands_for_none(mass: float) -> bool:
    return 0.0 < mass <= _NO_MASS and is_round(mass)


def _extract_significand(value: float) -> float:
    """Return the significand of a positive number, from 1 to 10, with float noise rounded off."""
    digits, _, _ = f"{value:.9e}".partition("e")
    return float(digits)
