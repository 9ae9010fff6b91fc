"""INR010 reports links denser than any material, and bodies lighter than air."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Finding, Located, Rule
from urdfcheck.facts.inertials.hull_bounds import measure_extent
from urdfcheck.facts.inertials.materials import DENSEST, describe_density, guess_mass_unit
from urdfcheck.facts.inertials.placeholders import is_round
from urdfcheck.facts.mesh.measure import compute_convex_hull
from urdfcheck.model import Link, Model
from urdfcheck.model.inertials.inertial_hull import NEGLIGIBLE_SHARE, EnclosedInertial, enclosed_inertials
from urdfcheck.model.rigid_bodies import RigidLinkGroup, compute_body_mass, list_rigid_bodies
from urdfcheck.model.shapes.visual_solid import (
    collect_body_corners,
    has_drawn_shape,
    has_unit_ambiguity,
    measure_links_volume,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class _PaddedHull:
    """Volume (m³) and area (m²) of the convex hull of what is drawn, ``margin`` of its size larger on all sides."""

    volume: float
    area: float

    @classmethod
    def from_points(cls, points: NDArray[np.float64], margin: float) -> _PaddedHull:
        with np.errstate(all="ignore"):  # numbers of no robot are for other rules
            hull = compute_convex_hull(points)
        return cls(hull.volume + hull.area * margin * measure_extent(points), hull.area)


def check(model: Model, rule: Rule, *, margin: float, least: float, thinnest: float) -> Iterator[Finding]:
    for part in enclosed_inertials(model):
        if has_drawn_shape(part.link) and part.mass_share >= NEGLIGIBLE_SHARE:
            yield from _check_too_dense(model, rule, part, margin)
    for body in list_rigid_bodies(model):
        yield from _check_too_light(model, rule, body, least, thinnest)


def _check_too_dense(model: Model, rule: Rule, part: EnclosedInertial, margin: float) -> Iterator[Finding]:
    """All of a link's mass lies in the hull of its body: a density beyond any material's is a proof, whatever is hollow."""
    filled = measure_links_volume(model, (part.link,))
    if filled is not None and part.mass <= DENSEST * filled:
        return
    volume = max(_PaddedHull.from_points(points, margin).volume for points in part.readings)
    if not 0.0 < DENSEST * volume < part.mass:
        return
    yield rule.finding(
        "dense",
        at=part.inertial.mass_attribute or part.inertial,
        link=part.link.name,
        mass=part.mass,
        volume=float(f"{volume * 1e6:.3g}"),
        around=part.geometry_phrase,
        density=describe_density(part.mass / volume),
        **_guess_mass_unit(part.mass, (filled or volume) if len(part.readings) == 1 else 0.0),
    )


def _check_too_light(
    model: Model, rule: Rule, body: RigidLinkGroup, least: float, thinnest: float
) -> Iterator[Finding]:
    """The mass of a whole body, which fixed joints share out as one likes."""
    links = [model.link_by_name[name] for name in body.links]
    mass, volume = compute_body_mass(model, body.links), measure_links_volume(model, links)
    if mass is None or volume is None or not 0.0 < mass < least * volume or has_unit_ambiguity(model, body.links):
        return
    points = collect_body_corners(model, body.links)
    area = 0.0 if points is None else _PaddedHull.from_points(points, 0.0).area
    if not mass < thinnest * area < math.inf:
        return
    heaviest = max(links, key=lambda link: (link.inertial and link.inertial.mass) or 0.0)
    yield rule.finding(
        "light",
        at=_locate_mass(heaviest),
        link=heaviest.name,
        mass=mass,
        volume=float(f"{volume * 1e6:.3g}"),
        sheet=float(f"{mass / area * 1e3:.2g}"),
        around="" if len(links) == 1 else ", with the links fixed to it,",
        density=describe_density(mass / volume),
        **_guess_mass_unit(mass, volume),
    )


def _guess_mass_unit(mass: float, volume: float) -> dict[str, Any]:
    """The unit that explains the density; a round mass was typed, whatever its unit (INR007)."""
    unit = None if is_round(mass) or not volume else guess_mass_unit(mass / volume)
    if unit is None:
        return {"cause": None}
    return {"cause": "unit", "unit": unit[0], "plausible": describe_density(unit[1])}


def _locate_mass(link: Link) -> Located:
    assert link.inertial is not None
    return link.inertial.mass_attribute or link.inertial
