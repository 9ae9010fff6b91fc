"""The box and the cylinder of uniform density that have a body's mass and principal moments."""

from __future__ import annotations

import math
from collections.abc import Sequence

from urdfcheck.core.records import dataclass


@dataclass(frozen=True, slots=True)
class EquivalentDensities:
    """Densities (kg/m³) of the solid box and the solid cylinder that have a body's mass and principal moments; None
    where no such body exists."""

    box: float | None
    cylinder: float | None


def fit_equivalent_box(mass: float, moments: Sequence[float]) -> tuple[float, float, float]:
    """Compute the edge lengths (m), descending, of the solid box with this mass and these principal moments (ascending), along
    their axes. An edge is 0 where the triangle inequality allows none."""
    total = sum(moments)
    a, b, c = (math.sqrt(max(0.0, 6.0 * (total - 2.0 * moment) / mass)) for moment in moments)
    return a, b, c


def fit_equivalent_cylinder(
    mass: float, moments: Sequence[float], rel_tol: float = 0.05
) -> tuple[int | None, float, float]:
    """Compute the axis (index of a moment), radius and length (m) of the solid cylinder with this mass and these principal
    moments (ascending).

    ``(None, nan, nan)`` when no two moments agree within ``rel_tol`` or no length fits. The transverse moments of published
    wheels, with bosses and spokes, differ by less than the default.
    """
    first, second, third = moments
    axis, across = (2, (first + second) / 2.0) if second - first <= third - second else (0, (second + third) / 2.0)
    spread = abs(second - first) if axis == 2 else abs(third - second)
    along = moments[axis]
    radius_squared, length_squared = 2.0 * along / mass, (12.0 * across - 6.0 * along) / mass
    if not (spread <= rel_tol * across and radius_squared > 0.0 and length_squared > 0.0):
        return None, math.nan, math.nan
    return axis, math.sqrt(radius_squared), math.sqrt(length_squared)


def compute_equivalent_density(mass: float, moments: Sequence[float]) -> EquivalentDensities:
    """Compute the densities (kg/m³) of the equivalent solid box and cylinder.

    The one whose shape the body has is close to its true density. Without a mesh, a value within 0.3 % of a CAD system's
    default means that no material was assigned.
    """
    a, b, c = fit_equivalent_box(mass, moments)
    axis, radius, length = fit_equivalent_cylinder(mass, moments)
    return EquivalentDensities(
        box=mass / (a * b * c) if a * b * c > 0.0 else None,
        cylinder=None if axis is None else mass / (math.pi * radius**2 * length),
    )
