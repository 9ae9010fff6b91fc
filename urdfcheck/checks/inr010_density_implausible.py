"""INR010: no link is denser than any material, and none lighter than air."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Finding, Located, Rule
from urdfcheck.facts.inertials.hull_bounds import reach
from urdfcheck.facts.inertials.materials import DENSEST, in_words, mass_unit
from urdfcheck.facts.inertials.placeholders import is_round
from urdfcheck.facts.mesh.measure import hull_of
from urdfcheck.model import Link, Model
from urdfcheck.model.inertials.inertial_hull import LITTLE, Enclosed
from urdfcheck.model.rigid_bodies import Body, bodies, body_mass
from urdfcheck.model.shapes.visual_solid import body_points, draws, follows_unit, volume_of

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class _Hull:
    """Volume (m³) and area (m²) of the convex hull of what is drawn, ``margin`` of its size larger on all sides."""

    volume: float
    area: float

    @classmethod
    def of(cls, points: NDArray[np.float64], margin: float) -> _Hull:
        with np.errstate(all="ignore"):  # numbers of no robot are for other rules
            hull = hull_of(points)
        return cls(hull.volume + hull.area * margin * reach(points), hull.area)


def check(model: Model, rule: Rule, *, margin: float, least: float, thinnest: float) -> Iterator[Finding]:
    for part in model.enclosed:
        if draws(part.link) and part.mass_share >= LITTLE:
            yield from _dense(model, rule, part, margin)
    for body in bodies(model):
        yield from _light(model, rule, body, least, thinnest)


def _dense(model: Model, rule: Rule, part: Enclosed, margin: float) -> Iterator[Finding]:
    """All of a link's mass lies in the hull of its body: a density beyond any material's is a proof, whatever is hollow."""
    filled = volume_of(model, (part.link,))
    if filled is not None and part.mass <= DENSEST * filled:
        return
    volume = max(_Hull.of(points, margin).volume for points in part.readings)
    if not 0.0 < DENSEST * volume < part.mass:
        return
    yield rule.finding(
        "dense",
        at=part.inertial.mass_attribute or part.inertial,
        link=part.link.name,
        mass=part.mass,
        volume=float(f"{volume * 1e6:.3g}"),
        around=part.around,
        density=in_words(part.mass / volume),
        **_unit(part.mass, (filled or volume) if len(part.readings) == 1 else 0.0),
    )


def _light(model: Model, rule: Rule, body: Body, least: float, thinnest: float) -> Iterator[Finding]:
    """The mass of a whole body, which fixed joints share out as one likes."""
    links = [model.link_by_name[name] for name in body.links]
    mass, volume = body_mass(model, body.links), volume_of(model, links)
    if mass is None or volume is None or not 0.0 < mass < least * volume or follows_unit(model, body.links):
        return
    points = body_points(model, body.links)
    area = 0.0 if points is None else _Hull.of(points, 0.0).area
    if not mass < thinnest * area < math.inf:
        return
    heaviest = max(links, key=lambda link: (link.inertial and link.inertial.mass) or 0.0)
    yield rule.finding(
        "light",
        at=_mass_of(heaviest),
        link=heaviest.name,
        mass=mass,
        volume=float(f"{volume * 1e6:.3g}"),
        sheet=float(f"{mass / area * 1e3:.2g}"),
        around="" if len(links) == 1 else ", with the links fixed to it,",
        density=in_words(mass / volume),
        **_unit(mass, volume),
    )


def _unit(mass: float, volume: float) -> dict[str, Any]:
    """The unit that explains the density; a round mass was typed, whatever its unit (INR007)."""
    unit = None if is_round(mass) or not volume else mass_unit(mass / volume)
    if unit is None:
        return {"cause": None}
    return {"cause": "unit", "unit": unit[0], "plausible": in_words(unit[1])}


def _mass_of(link: Link) -> Located:
    assert link.inertial is not None
    return link.inertial.mass_attribute or link.inertial
