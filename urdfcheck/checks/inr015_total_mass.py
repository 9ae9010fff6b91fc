"""INR015 reports robots whose total mass is implausible, impossible for their size, or not what they weigh."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

from urdfcheck.core import FactUnavailableError, Finding, Rule, Severity
from urdfcheck.core.text import format_length, join_names
from urdfcheck.facts.inertials.materials import is_part_density
from urdfcheck.facts.inertials.placeholders import ONSHAPE_UNKNOWN, is_round
from urdfcheck.model import Model
from urdfcheck.model.parts import has_drawn_shape
from urdfcheck.model.rigid_bodies import compute_body_mass, has_one_round_mass, list_whole_bodies
from urdfcheck.model.use.display import is_made_for_display, is_never_weighed

# Osmium, the densest material at room pressure (kg/m³).
DENSEST = 22_590.0
_WATER = 1000.0
_MOST_LISTED = 3
# One link has an impossible mass, not all, if the others have less than this share of what is possible.
_OTHERS = 0.1
# So many links with one mass of so many digits are no copies of one part, which a robot has beside others: one of 718 published
# descriptions has such masses, each that of the assembly.
_FEWEST_LINKS, _MANY_DIGITS = 4, 6
# In one unit the heaviest link of a robot weighs up to so many times what the lightest does (chosen).
_SPAN = 1e5
# A density is 1 kg/m³ within this share, which rounding of masses leaves.
_UNIT_DENSITY = 0.01
_IN_KILOGRAMS, _CORRECTED = "write the robot's masses in kilograms", "correct the robot's masses"
# Kilograms per tonne, and per gram.
_TONNE = 1000.0
_FACTORS = {"tonnes": _TONNE, "grams": 1e-3}
_HELD_DOWN = "if its weight is to hold the robot down, fix it to the world instead; otherwise correct its mass"


def check(
    model: Model, rule: Rule, *, least: float, most: float, unseen: float, total_mass: float, rel_tol: float
) -> Iterator[Finding]:
    masses = [declared.mass for declared in model.masses if declared.mass > 0]
    total = sum(masses)
    if total_mass > 0 and abs(total - total_mass) > rel_tol * total_mass:
        yield _compare_with_scale(model, rule, total, total_mass)
        return
    if not masses:
        return
    edge, is_seen = _measure_extent(model, unseen, enough=(total / DENSEST) ** (1 / 3))
    # A mesh that was not read may be larger than what is seen of the robot, but not in a robot of a hundred tonnes.
    if total > DENSEST * edge**3 and (is_seen or total > most):
        yield _build_density_finding(model, rule, total=total, edge=edge)
    elif total < least and has_one_round_mass(model):
        if not (_has_frames_only(model) or is_made_for_display(model)):
            yield _build_placeholder_finding(model, rule, masses[0])
    elif _is_one_mass(model, masses):
        yield _build_same_finding(model, rule, total=total)
    elif total < least and (measured := _count_unit_densities(model)):
        yield rule.finding(
            "volumes", at=model.name_location, robot=model.name, total=total, links=len(masses), measured=measured
        )
    elif (total > most and not _is_light_for_its_size(model, total)) or (
        total < least and _has_most_masses(model) and not _is_small_object(model)
    ):
        # In tonnes too, a robot weighs a gram or more.
        light = _name_unit(model, masses, "tonnes") if _TONNE * total >= least else None
        message, cause = ("light", light) if total < least else ("heavy", _name_unit(model, masses, "grams"))
        yield rule.finding(
            message,
            at=model.name_location,
            severity=Severity.INFO if (_is_unmoved if total < least else is_never_weighed)(model) else None,
            cause=cause,
            repair=_IN_KILOGRAMS if cause else _CORRECTED,
            robot=model.name,
            total=total,
            links=len(masses),
            least=least,
            explains=_list_same_mass(model),
        )


def _list_same_mass(model: Model) -> list[str]:
    """List what INR010 reports of the one link that has all of the mass: it is the same number."""
    links = [one.link.location.subject for one in model.masses if one.mass > 0]
    return [f"INR010 {subject}" for subject in links] if len(links) == 1 else []


def _is_unmoved(model: Model) -> bool:
    """Whether a model only carries sensors, or has no joint that moves and is only displayed: a token mass will do for it."""
    from urdfcheck.model.motion.fixed_base import is_sensor_stand  # loads numpy

    return is_sensor_stand(model) or (not any(joint.is_movable for joint in model.joints) and is_never_weighed(model))


def _is_small_object(model: Model) -> bool:
    """Whether no joint of a model moves and each of its masses is that of a part of its volume: a nut weighs a gram."""
    if any(joint.is_movable for joint in model.joints):
        return False
    from urdfcheck.model.shapes.visual_solid import measure_links_volume  # most masses need no volume

    measured = [(one.mass, measure_links_volume(model, (one.link,))) for one in model.masses if one.mass > 0]
    return all(volume and is_part_density(mass / volume) for mass, volume in measured)


def _has_frames_only(model: Model) -> bool:
    """Whether a model draws nothing and no joint of it moves: the frames of a fragment, whose masses are tokens."""
    return not any(map(has_drawn_shape, model.links)) and not any(joint.is_movable for joint in model.joints)


def _is_one_mass(model: Model, masses: Sequence[float]) -> bool:
    """Whether all links have one mass, to the last of many digits, though they draw different meshes."""
    drawn = {
        tuple(shape.mesh_filename.value for shape in one.link.visuals if shape.mesh_filename is not None)
        for one in model.masses
    }
    digits = len(f"{masses[0]:.15g}".partition("e")[0].replace(".", "").strip("0"))
    return (
        len(masses) >= _FEWEST_LINKS and len(set(masses)) == 1 and digits >= _MANY_DIGITS and len(drawn) == len(masses)
    )


def _count_unit_densities(model: Model) -> int:
    """Count the links of known volume, if all weigh 1 kg/m³ and not all are one part: the exporter was given no density."""
    from urdfcheck.model.inertials.mesh_density import compute_mesh_density  # most masses need no volume

    measured = [
        (one.mass, density)
        for one in model.masses
        if one.mass > 0 and (density := compute_mesh_density(model, one)) is not None
    ]
    is_unit = all(abs(density - 1.0) <= _UNIT_DENSITY for _, density in measured)
    return len(measured) if is_unit and len({f"{mass:.3g}" for mass, _ in measured}) > 1 else 0


def _name_unit(model: Model, masses: Sequence[float], unit: str) -> str | None:
    """Return the unit as the cause, or None where all masses are round, which a CAD program does not write, too different to be
    those of one robot in one unit, or, in that unit, of parts of no usual density."""
    if all(map(is_round, masses)) or max(masses) > _SPAN * min(masses):
        return None
    from urdfcheck.facts.median import compute_median
    from urdfcheck.model.inertials.mesh_density import compute_mesh_density

    measured = (compute_mesh_density(model, one) for one in model.masses if one.mass > 0)
    known = [density for density in measured if density is not None]
    return unit if not known or is_part_density(_FACTORS[unit] * compute_median(known)) else None


def _is_light_for_its_size(model: Model, total: float) -> bool:
    """Whether a cube around all that is drawn weighs more if filled with water: a ship, an excavator or a building."""
    edge, is_seen = _measure_extent(model, 1.0, enough=math.inf)
    return is_seen and total <= _WATER * edge**3


def _has_most_masses(model: Model) -> bool:
    """Whether the sum is that of the robot: at least half of the bodies that move have a mass (INR001 reports the others)."""
    moving = [body for body in list_whole_bodies(model) if body.is_movable]
    return 2 * sum(bool(compute_body_mass(model, body.links)) for body in moving) >= len(moving)


def _build_density_finding(model: Model, rule: Rule, *, total: float, edge: float) -> Finding:
    """Build the finding about a ``total`` mass (kg) that no cube of this ``edge`` (m) has: of one link, or of all together."""
    declared = [one for one in model.masses if one.mass > 0]
    heaviest, most = max(declared, key=lambda one: one.mass), DENSEST * edge**3
    is_one = len(declared) > 1 and heaviest.mass > most and total - heaviest.mass < _OTHERS * most
    cause = None
    # In grams too, no robot is denser than any material.
    if not is_one and _FACTORS["grams"] * total <= most:
        cause = _name_unit(model, [one.mass for one in declared], "grams")
    is_weight = is_one and is_round(heaviest.mass) and heaviest.link.name in _list_base_links(model)
    of_one = _HELD_DOWN if is_weight else f"correct the mass of {heaviest.link.name}"
    of_all = _IN_KILOGRAMS if cause else _CORRECTED
    size = format_length(edge)
    return rule.finding(
        "dense_link" if is_one else "dense",
        at=heaviest.attribute if is_one else model.name_location,
        cause=cause,
        repair=of_one
        if is_one
        else f"if the robot is {size} large, {of_all}; otherwise correct its lengths, such as the scale of meshes",
        severity=Severity.INFO if is_never_weighed(model) else Severity.WARNING if is_weight else Severity.ERROR,
        robot=model.name,
        link=heaviest.link.name,
        mass=heaviest.mass,
        others=total - heaviest.mass,
        total=total,
        links=len(declared),
        edge=edge,
        most=most,
    )


def _list_base_links(model: Model) -> Sequence[str]:
    """List the links of the root's body; none where there is not one root."""
    try:
        return model.tree.list_body_links(model.tree.root)
    except FactUnavailableError:
        return ()


def _build_same_finding(model: Model, rule: Rule, *, total: float) -> Finding:
    """Build the finding about one mass in all links; each of them is a subject."""
    places = [one.attribute for one in model.masses if one.mass > 0]
    finding = rule.finding(
        "same",
        at=places[0],
        related=places[1:],
        robot=model.name,
        mass=next(one.mass for one in model.masses if one.mass > 0),
        links=len(places),
        total=total,
    )
    return replace(finding, subjects=tuple(place.location.subject for place in places))


def _build_placeholder_finding(model: Model, rule: Rule, mass: float) -> Finding:
    """Build the finding about one round number in place of every ``mass`` (kg). It explains what is reported of the links."""
    from urdfcheck.model.motion.fixed_base import is_untouched  # loads numpy

    declared = [one for one in model.masses if one.mass > 0]
    links = [one.link.location.subject for one in declared]
    explained = [f"{code} {subject}" for code in ("INR007", "INR010", "INR012") for subject in links]
    return rule.finding(
        "placeholder",
        at=model.name_location,
        severity=Severity.INFO if is_untouched(model) else None,
        related=[one.attribute for one in declared[:_MOST_LISTED]],
        robot=model.name,
        mass=mass,
        links=len(declared),
        writer=". onshape-to-robot writes 1e-9 for parts without a material" if mass == ONSHAPE_UNKNOWN else "",
        explains=[*explained, f"INR007 {model.location.subject}"],
    )


def _compare_with_scale(model: Model, rule: Rule, total: float, expected: float) -> Finding:
    """Build the finding about a sum that is not what the robot weighs."""
    heaviest = sorted((d for d in model.masses if d.mass > 0), key=lambda declared: -declared.mass)
    return rule.finding(
        "measured",
        at=model.name_location,
        related=[declared.attribute for declared in heaviest[:_MOST_LISTED]],
        robot=model.name,
        total=total,
        expected=expected,
        off=total / expected - 1,
        links=len(heaviest),
        heaviest=join_names([f"{d.link.name} {d.mass:.3g} kg" for d in heaviest[:_MOST_LISTED]]) or "none has a mass",
    )


def _measure_extent(model: Model, unseen: float, *, enough: float) -> tuple[float, bool]:
    """Return the longest edge (m) of the box around the robot's frames and shapes, joints at zero, and whether it is certain.

    If a mesh was not read, the edge is ``unseen`` times that of the others; inf if nothing shows a size, or if the frames alone
    are ``enough`` (m) apart and the shapes make no difference.
    """
    try:
        places = [placement.place for placement in model.placements.values()]
    except FactUnavailableError:
        return math.inf, False
    apart = max(max(along) - min(along) for along in zip(*places, strict=True))
    if min(unseen, 1.0) * apart >= enough:
        return math.inf, False
    import numpy as np

    from urdfcheck.model.shapes.bounds import compute_bounding_box

    frames = model.frames
    placed = [(s, frames[link.name]) for link in model.links for s in (*link.visuals, *link.collisions)]
    boxes = [compute_bounding_box(model, [item]) for item in placed]
    known = [box for box in boxes if box is not None]
    corners = np.concatenate([*known, places])
    extent = float(np.ptp(corners, axis=0).max())
    if not placed or not 0.0 < extent < math.inf:
        return math.inf, False
    is_seen = len(known) == len(boxes)
    return extent if is_seen else unseen * extent, is_seen
