"""The density of links, as mass over the volume of the mesh: what one program exported has few values."""

from __future__ import annotations

from collections.abc import Mapping

from urdfcheck.core.records import dataclass
from urdfcheck.model.parts import DeclaredMass
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.mesh_sizes import is_usable_shape
from urdfcheck.model.shapes.solids import measure_link_solid


@dataclass(frozen=True, slots=True)
class TenfoldDensity:
    """Links of one density, and others of ten times that."""

    low: tuple[DeclaredMass, ...]
    high: tuple[DeclaredMass, ...]
    density: float
    """Of the former, kg/m³."""


def compute_mesh_density(model: Model, declared: DeclaredMass) -> float | None:
    """Return the mass over the volume of the drawn mesh, or else of the collision mesh, in kg/m³; None if it is not known."""
    link = declared.link
    for role, shapes in (("visual", link.visuals), ("collision", link.collisions)):
        if any(shape.kind == "mesh" for shape in shapes) and all(is_usable_shape(model, shape) for shape in shapes):
            solid = measure_link_solid(model, link, role)
            if solid is not None and solid.volume > 0:
                return declared.mass / solid.volume
    return None


def find_tenfold_density(
    densities: Mapping[str, tuple[DeclaredMass, float]], *, tolerance: float, evidence: int
) -> TenfoldDensity | None:
    """Find two groups of links whose densities are equal to within ``tolerance``, and those of one ten times the other's.

    ``densities``: masses with their densities in kg/m³, by link. ``evidence``: how many parts of different mass the two groups
    need together, for copies and mirror images are one piece of evidence.
    """
    best: TenfoldDensity | None = None
    for _, density in densities.values():
        low = _select_near(densities, density, tolerance)
        high = _select_near(densities, 10.0 * density, 2.0 * tolerance)
        is_enough = high and _count_different(low) + _count_different(high) >= evidence
        if is_enough and (best is None or len(low) + len(high) > len(best.low) + len(best.high)):
            best = TenfoldDensity(low, high, density)
    return best


def _select_near(
    densities: Mapping[str, tuple[DeclaredMass, float]], density: float, tolerance: float
) -> tuple[DeclaredMass, ...]:
    return tuple(declared for declared, one in densities.values() if abs(one / density - 1.0) <= tolerance)


def _count_different(masses: tuple[DeclaredMass, ...]) -> int:
    return len({f"{declared.mass:.3g}" for declared in masses})
