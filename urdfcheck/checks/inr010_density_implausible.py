"""INR010 reports links denser than any material, and bodies lighter than air."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.records import dataclass
from urdfcheck.facts.inertials.certainty import EXACT
from urdfcheck.facts.inertials.equivalent_solids import fit_equivalent_box
from urdfcheck.facts.inertials.hull_bounds import measure_extent
from urdfcheck.facts.inertials.materials import DENSEST, describe_density, guess_mass_unit, is_part_density
from urdfcheck.facts.inertials.placeholders import describe_unknown_mass, is_round
from urdfcheck.facts.mesh.convex_hull import compute_convex_hull
from urdfcheck.model import Link, Model
from urdfcheck.model.inertials.diagnosis.slipped_masses import SlippedMass, find_slipped_mass
from urdfcheck.model.inertials.habits.minor_findings import set_lost_aside
from urdfcheck.model.inertials.habits.stated_purposes import has_stated_purpose
from urdfcheck.model.inertials.inertia_diagnosis import inertial_diagnoses
from urdfcheck.model.inertials.inertial_hull import NEGLIGIBLE_SHARE, EnclosedInertial, enclosed_inertials
from urdfcheck.model.motion.fixed_base import is_ballast
from urdfcheck.model.parts import has_drawn_shape
from urdfcheck.model.rigid_bodies import RigidLinkGroup, compute_body_mass, has_one_round_mass, list_whole_bodies
from urdfcheck.model.shapes.bounds import compute_bounding_box
from urdfcheck.model.shapes.corners import collect_body_corners
from urdfcheck.model.shapes.visual_solid import (
    has_unit_ambiguity,
    measure_link_geometry,
    measure_links_volume,
    measure_role_geometry,
)
from urdfcheck.model.wheel_names import WHEEL_NAME

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# The length of the part that mass and tensor describe, to that of the drawing which stands for it.
_TOKEN = 2.0
# A mass that is a thousand times too large is in grams rather than a slip.
_GRAMS = 3
# What is larger (m, chosen) and never moves is a floor or a wall.
_ROOM = 2.0
# The volume in cubic metres to that of a mesh in millimetres that is loaded without a scale.
_MILLIMETRES = 1e9
_MILLIMETRE_MESH = "give the mesh the scale of its unit: drawn a thousandth as large, it fits the mass"
# A mass of so few significant digits was chosen, not computed.
_TYPED_DIGITS = 2


@dataclass(frozen=True, slots=True)
class _PaddedHull:
    """The convex hull of the drawn geometry, enlarged on all sides."""

    volume: float
    """m³"""
    area: float
    """m², not enlarged"""

    @classmethod
    def from_points(cls, points: Array, margin: float) -> _PaddedHull:
        """Compute the hull of ``points`` (K, 3) in m, enlarged by ``margin`` of its size."""
        with np.errstate(all="ignore"):  # other rules report impossible numbers
            hull = compute_convex_hull(points)
        return cls(hull.volume + hull.area * margin * measure_extent(points), hull.area)


def check(model: Model, rule: Rule, *, margin: float, least: float, thinnest: float) -> Iterator[Finding]:
    yield from set_lost_aside(model, rule, _check(model, rule, margin=margin, least=least, thinnest=thinnest))


def _check(model: Model, rule: Rule, *, margin: float, least: float, thinnest: float) -> Iterator[Finding]:
    dense = [
        found
        for part in enclosed_inertials(model)
        if has_drawn_shape(part.link) and part.mass_share >= NEGLIGIBLE_SHARE
        if (found := _find_excess_density(model, part, margin=margin)) is not None
    ]
    # The masses of one file have one unit.
    is_one_unit = len({found.slip.get("unit") for found in dense if found.slip["cause"] != "decimal"}) < 2
    is_of_wheels = bool(dense) and all(_is_weighted_wheel(model, found) for found in dense)
    for found in dense:
        yield _build_dense_finding(model, rule, found, is_one_unit=is_one_unit, is_wheel=is_of_wheels)
    for body in list_whole_bodies(model):
        yield from _check_too_light(model, rule, body, least=least, thinnest=thinnest)


@dataclass(frozen=True, slots=True, eq=False)
class _ExcessDensity:
    """A link that is denser in its body's hull, which holds all of its mass, than any material."""

    part: EnclosedInertial
    volume: float
    """m³, at most."""
    slip: Mapping[str, Any]
    """The data of the mistake in the mass that explains it; its cause is None where none does."""


def _find_excess_density(model: Model, part: EnclosedInertial, *, margin: float) -> _ExcessDensity | None:
    filled = measure_links_volume(model, (part.link,))
    if filled is not None and part.mass <= DENSEST * filled:
        return None
    slipped = find_slipped_mass(model, part.link)
    # A slip that the tensor shows, too, needs no bound on what is not drawn.
    volume = (slipped.volume if slipped is not None else _measure_own_volume(model, part)) or max(
        _PaddedHull.from_points(points, margin).volume for points in part.readings
    )
    if not 0.0 < DENSEST * volume < part.mass:
        return None
    slip = _describe_slip(part.mass, slipped) or _guess_mass_unit(
        part.mass, (filled or volume) if len(part.readings) == 1 else 0.0
    )
    # A mass that was typed to keep a stand in its place is a choice, unless a slip explains it.
    is_typed = float(f"{part.mass:.{_TYPED_DIGITS}g}") == part.mass
    if slip["cause"] is None and is_typed and is_ballast(model, model.pieces.list_body_links(part.link.name)):
        return None
    if slip["cause"] is None and (_is_token_drawing(model, part) or has_stated_purpose(model, part.link)):
        return None
    return _ExcessDensity(part, volume, slip)


def _is_weighted_wheel(model: Model, found: _ExcessDensity) -> bool:
    """Whether a link is a wheel with a mass that was typed, and no more than the heaviest other body has: then it may be to keep
    the vehicle from drifting."""
    name, mass = found.part.link.name, found.part.mass
    joint = model.pieces.parent_joint.get(model.pieces.list_body_links(name)[0])
    if joint is None or joint.type != "continuous" or not WHEEL_NAME.search(f"{joint.name} {name}"):
        return False
    bodies = [b for b in list_whole_bodies(model) if not any(map(WHEEL_NAME.search, b.links))]
    heaviest = max((compute_body_mass(model, body.links) or 0.0 for body in bodies), default=0.0)
    is_typed = float(f"{mass:.{_TYPED_DIGITS}g}") == mass
    return found.slip["cause"] is None and is_typed and mass <= heaviest


def _build_dense_finding(
    model: Model, rule: Rule, found: _ExcessDensity, *, is_one_unit: bool, is_wheel: bool
) -> Finding:
    part, slip = found.part, found.slip
    if slip["cause"] == "unit" and not is_one_unit:
        slip = {"cause": None}
    return rule.finding(
        "wheel" if is_wheel else "dense",
        severity=Severity.INFO if is_wheel else None,
        at=model.mass_by_name[part.link.name].attribute,
        link=part.link.name,
        mass=part.mass,
        volume=float(f"{found.volume * 1e6:.3g}"),
        around=part.geometry_phrase,
        density=describe_density(part.mass / found.volume),
        repair=f"correct the mass: the inertia tensor is that of about {slip['slipped']} kg"
        if slip["cause"] == "decimal"
        else _describe_repair(
            [part.link],
            part.mass,
            is_in_unit=slip["cause"] == "unit",
            is_drawn=_measure_own_volume(model, part) is not None,
        ),
        **slip,
    )


def _describe_repair(
    links: Sequence[Link], mass: float, *, is_in_unit: bool, is_drawn: bool = False, is_light: bool = False
) -> str:
    """Describe what to correct: the scale of a mesh may be wrong, and a primitive has none.

    ``is_drawn``: COM and tensor are those of what is drawn, at this mass, so that the mass or all lengths are wrong.
    """
    unknown = describe_unknown_mass(mass)
    if unknown:
        return unknown
    has_mesh = _has_mesh(links)
    first = "write the mass in kilograms" if is_in_unit else "correct the mass"
    if is_drawn and not is_in_unit:
        drawn = "the scale of the mesh" if has_mesh else "the size of what is drawn"
        return (
            f"{first}, and scale the inertia tensor with it: COM and tensor are those of the drawn part at this mass; "
            f"if the mass is right, correct {drawn}, and the tensor with it"
        )
    size = "give the mesh the scale of its unit" if has_mesh else "correct the size of what is drawn"
    if is_light:  # the drawing is more often wrong than a mass that is all right for a smaller part
        return f"{first}, or {size}" if is_in_unit else f"{size} if it is drawn too large; otherwise {first}"
    # Parts that are not drawn explain a mass that is too great, not one that is too small.
    return f"{first}, or {size}" if is_in_unit else f"{first}, {size}, or draw the parts that are missing"


def _has_mesh(links: Sequence[Link]) -> bool:
    return any(shape.kind == "mesh" for link in links for shape in (*link.visuals, *link.collisions))


def _is_token_drawing(model: Model, part: EnclosedInertial) -> bool:
    """Whether typed primitives only stand for a part: mass and tensor agree on one of an ordinary density that is much larger.

    A mesh may have the wrong scale, and a wrong mass does not agree with the tensor of the part.
    """
    tensor = model.tensor_by_name.get(part.link.name)
    if tensor is None or any(shape.kind == "mesh" for shape in part.link.visuals):
        return False
    drawn = compute_bounding_box(model, [(shape, np.eye(4)) for shape in part.link.visuals])
    edges = fit_equivalent_box(part.mass, tensor.moments)
    if drawn is None or not min(edges) > 0.0 or not is_part_density(part.mass / math.prod(edges)):
        return False
    return max(edges) > _TOKEN * float(np.linalg.norm(drawn[1] - drawn[0]))


def _measure_own_volume(model: Model, part: EnclosedInertial) -> float | None:
    """Measure what the link draws (m³) if COM and tensor are those of that body at uniform density: then all of the mass is
    there. Twice the density of any material is not one of a drawing that is too thin. None where a closed collision shape gives
    the mass a usual density: what is drawn is then only the skin of the part."""
    judged, drawn = inertial_diagnoses(model).get(part.link.name), measure_link_geometry(model, part.link)
    if judged is None or drawn is None or not drawn.closed or has_unit_ambiguity(model, (part.link.name,)):
        return None
    colliding = measure_role_geometry(model, part.link, "collision")
    if colliding is not None and colliding.closed and is_part_density(part.mass / colliding.solid.volume):
        return None
    is_own = judged.diagnosis.sound and max(judged.diagnosis.tensor_mismatch, judged.diagnosis.com_mismatch) < EXACT
    return drawn.solid.volume if is_own and part.mass > 2.0 * DENSEST * drawn.solid.volume > 0.0 else None


def _describe_slip(mass: float, slipped: SlippedMass | None) -> dict[str, Any]:
    """Return the data of the decimal point that explains the density; empty without one."""
    if slipped is None:
        return {}
    plausible = f"the density is {describe_density(slipped.density)}"
    if slipped.power == _GRAMS and not is_round(mass):
        return {"cause": "unit", "unit": "grams", "plausible": plausible}
    return {
        "cause": "decimal",
        # A round mass may be one in grams, or a slip.
        "factor": f"{10.0**-slipped.power:g} times what is written"
        + (", as if in grams" if slipped.power == _GRAMS else ""),
        "slipped": f"{slipped.mass:.4g}",
        "plausible": plausible,
    }


def _hangs_in_the_air(model: Model, body: RigidLinkGroup) -> bool:
    """Whether a body without joints that move has its gravity turned off: a program places it, and a token mass will do."""
    if any(joint.is_movable for joint in model.joints):
        return False
    from urdfcheck.model.motion.joint_loads import find_weightless_links  # few bodies get here

    return not find_weightless_links(model).isdisjoint(body.links)


def _check_too_light(
    model: Model, rule: Rule, body: RigidLinkGroup, *, least: float, thinnest: float
) -> Iterator[Finding]:
    """Report a body that is lighter than air as a whole, because how its links share the mass is arbitrary.

    Links without a mass do not count: a table that an arm is bolted to says nothing about the arm.
    """
    weighed = {declared.link.name for declared in model.masses if declared.mass > 0.0}
    links = [model.link_by_name[name] for name in body.links if name in weighed]
    mass, volume = compute_body_mass(model, body.links), measure_links_volume(model, links)
    if mass is None or volume is None or not 0.0 < mass < least * volume or has_unit_ambiguity(model, body.links):
        return
    points = collect_body_corners(model, [link.name for link in links])
    area = 0.0 if points is None else _PaddedHull.from_points(points, 0.0).area
    if not mass < thinnest * area < math.inf:
        return
    if body.is_movable and describe_unknown_mass(mass):
        return  # INR012
    if points is not None and _is_room(model, measure_extent(points), density=mass / volume):
        return
    heaviest = max((model.mass_by_name[link.name] for link in links), key=lambda declared: declared.mass)
    slip = _guess_mass_unit(mass, volume)
    yield rule.finding(
        "light",
        at=heaviest.attribute,
        # INR007 reports one round mass of all links: no other repair would be right.
        severity=Severity.INFO if has_one_round_mass(model) or _hangs_in_the_air(model, body) else None,
        link=heaviest.link.name,
        mass=mass,
        volume=float(f"{volume * 1e6:.3g}"),
        sheet=float(f"{mass / area * 1e3:.2g}"),
        around="" if len(links) == 1 else " (with the links fixed to it that have a mass)",
        density=describe_density(mass / volume),
        repair=_MILLIMETRE_MESH
        if _has_mesh(links) and slip["cause"] is None and is_part_density(mass / volume * _MILLIMETRES)
        else _describe_repair(links, heaviest.mass, is_in_unit=slip["cause"] == "unit", is_light=True),
        **slip,
    )


def _is_room(model: Model, extent: float, *, density: float) -> bool:
    """Whether nothing moves in a model as large as a room (``extent`` in m), and its ``density`` (kg/m³) is not one of a mesh in
    millimetres."""
    is_moved = any(joint.is_movable for joint in model.joints)
    return not is_moved and extent > _ROOM and not is_part_density(density * _MILLIMETRES)


def _guess_mass_unit(mass: float, volume: float) -> dict[str, Any]:
    """Return the data of the unit that explains the density, unless the mass is a round number (INR007)."""
    unit = None if is_round(mass) or not volume else guess_mass_unit(mass / volume)
    if unit is None:
        return {"cause": None}
    drawn = float(f"{volume * 1e6:.3g}")
    return {
        "cause": "unit",
        "unit": unit[0],
        "plausible": f"the {drawn:g} cm³ that are drawn have {describe_density(unit[1])}",
    }
