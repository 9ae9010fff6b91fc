"""INR007 reports placeholder masses and inertia tensors: round numbers that only make a program accept the file."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from urdfcheck.core import Edit, Finding, Rule, Severity, Span
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import join_names
from urdfcheck.facts.inertials.certainty import VAST
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia
from urdfcheck.facts.inertials.materials import DENSEST, LIGHTEST, is_part_density
from urdfcheck.facts.inertials.placeholders import describe_placeholder, is_round, is_unknown_mass
from urdfcheck.model import DeclaredMass, DeclaredTensor, Link, Model
from urdfcheck.model.inertials.habits.minor_findings import are_absorbed, compute_turned_share, is_lost, set_lost_aside
from urdfcheck.model.inertials.habits.stated_purposes import has_stated_purpose, is_called_negligible
from urdfcheck.model.inertials.inertial_hull import compute_body_shares, has_negligible_moment, is_massless_frame
from urdfcheck.model.inertials.proposals.drawn_inertials import is_collision_of_detail, propose_from_geometry
from urdfcheck.model.inertials.typed_tensors import MOMENTS, is_computed_from_lengths
from urdfcheck.model.motion.fixed_base import is_ballast, is_sensor_stand, is_untouched, list_unturned_links
from urdfcheck.model.parts import has_drawn_shape
from urdfcheck.model.rigid_bodies import has_one_round_mass, list_whole_bodies
from urdfcheck.model.shapes.visual_solid import (
    explain_collision_stand_in,
    has_unit_ambiguity,
    measure_link_geometry,
    measure_role_geometry,
)
from urdfcheck.model.stated_reasons import has_commented_child, is_called_empty
from urdfcheck.model.use.display import (
    is_loaded_for_frames,
    is_made_for_display,
    is_never_weighed,
)
from urdfcheck.model.use.gazebo_starts import gives_gazebo_sdf
from urdfcheck.model.use.other_programs import is_weighed_by_bullet
from urdfcheck.model.use.scenery import scenery_links
from urdfcheck.model.use.simulators import has_elements, is_simulated

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# An equal mass is compared with the drawn geometry if at least this many links have it.
_FEWEST = 4
# A tensor that links of this many different masses share belongs to none of them, whatever they look like.
_FEWEST_MASSES = 3
# Cosine: a joint's axis is along a rod where the angle between the two is below 25°.
_ALONG = 0.9
# What only carries sensors stands as firmly with so many times its moments, or one part of these (chosen).
_OF_STAND = 100.0
# What adds less to all that a joint turns does not make it sluggish (chosen).
_LITTLE = 0.25
# A link of at most this mass in kg that nothing is fixed to is the marker of a point. So small a moment in kg m² was chosen for
# it: it keeps an engine stable, and the rotor of the smallest drive has more.
_MARKER_MASS, _MARKER_MOMENT = 1e-3, 1e-5
# Where the number is not found to be that of another mass; numbers are equal to within this share (digits of a float and facets).
_TYPED, _EQUAL = "typed rather than computed", 1e-4
# What Gazebo and MuJoCo do with a moment that is too large, and with one that is too small.
_TOO_LARGE = {"gazebo": "too much inertia makes a joint sluggish", "mujoco": "loads it"}
_TOO_LARGE_BASE = {"gazebo": "too much inertia makes the robot tilt and turn sluggishly", "mujoco": "loads it"}
_COMMENTED = "put back the <inertial> that a comment holds, or "
_UNFELT = {"gazebo": "loads it", "mujoco": "loads it"}
_TOO_SMALL = {
    "gazebo": "too little inertia makes a joint shake or explode",
    "mujoco": "too little inertia makes the simulation unstable at the default time step",
}


class _Misfit(NamedTuple):
    """How far a tensor is from that of a uniform solid with the link's mass and drawn shape."""

    factor: float
    """The largest factor between two of their principal moments; of the two larger ones, if they differ at all."""
    is_axial: bool
    """Whether only the smallest moment differs: that of a rod about its own length."""
    is_felt: bool
    """Whether a joint turns the link about an axis whose moment differs."""
    expected: float
    """That moment of the solid in kg m²."""


@dataclass(frozen=True, slots=True, eq=False)
class _PlaceholderInertial:
    """A tensor that looks typed and not computed."""

    declared: DeclaredTensor
    mass: float
    description: str
    share: float
    """Of the largest moment of the body that the link is part of."""
    misfit: _Misfit | None
    """None if the drawn shape is not known."""

    @property
    def factor(self) -> float:
        return 0.0 if self.misfit is None else self.misfit.factor


def check(
    model: Model, rule: Rule, *, factor: float, estimate: float, fraction: float, spread: float
) -> Iterator[Finding]:
    yield from set_lost_aside(
        model, rule, _check(model, rule, factor=factor, estimate=estimate, fraction=fraction, spread=spread)
    )


def _check(
    model: Model, rule: Rule, *, factor: float, estimate: float, fraction: float, spread: float
) -> Iterator[Finding]:
    groups: dict[tuple[object, object, bool], list[_PlaceholderInertial]] = {}
    for suspect in _iter_placeholders(model, factor):
        span = suspect.declared.inertial.location.span
        is_chosen = has_stated_purpose(model, suspect.declared.link)
        groups.setdefault((suspect.declared.components, span and span.file, is_chosen), []).append(suspect)
    for (_, _, is_chosen), group in groups.items():
        wrong = any(suspect.factor > factor for suspect in group)
        unknown = [suspect for suspect in group if suspect.misfit is None]
        if wrong or _count_masses(unknown) >= _FEWEST_MASSES:
            # If parts of all sizes have one tensor, it nearly fits one of them by chance.
            known = [suspect for suspect in group if suspect.misfit is not None] if wrong else []
            fits_some = any(suspect.factor <= factor for suspect in known)
            alike = _count_masses(group) < _FEWEST_MASSES and (fits_some or not wrong)
            # Of the parts that slide, which are known, those that turn have no tensor of another part.
            alike |= wrong and _count_masses(unknown) < _FEWEST_MASSES and not _turns_any(model, known, factor)
            yield _build_tensor_finding(
                model,
                rule,
                known=known,
                unknown=[] if alike else unknown,
                estimate=estimate,
                is_chosen=is_chosen,
            )
    yield from _check_equal_masses(model, rule, fraction=fraction, spread=spread)


def _turns_any(model: Model, known: Iterable[_PlaceholderInertial], factor: float) -> bool:
    """Whether anything turns one of the links whose tensors are so many times off."""
    unturned = list_unturned_links(model)
    return any(one.factor > factor and one.declared.link.name not in unturned for one in known)


def _count_masses(suspects: Iterable[_PlaceholderInertial]) -> int:
    return len({suspect.mass for suspect in suspects})


def _iter_placeholders(model: Model, factor: float) -> Iterator[_PlaceholderInertial]:
    for body in [] if is_made_for_display(model) else list_whole_bodies(model):
        descriptions = {
            name: what
            for name in body.links
            if (what := _describe_placeholder(model, model.link_by_name[name])) is not None
        }
        if descriptions and (is_ballast(model, body.links) or body.links[0] in scenery_links(model)):
            continue
        shares = compute_body_shares(model, body.links) if descriptions else {}
        for name, description in descriptions.items():
            if name not in shares:
                continue
            declared, mass = model.tensor_by_name[name], model.mass_by_name[name].mass
            share, misfit = shares[name][1], _measure_misfit(model, declared, mass, factor)
            if misfit is not None and len(body.links) == 1 and _is_marker(declared, mass, misfit):
                continue
            # A moment that is too small counts as much as the one that it should be.
            lack = 1.0 if misfit is None else max(1.0, misfit.expected / max(declared.components))
            if not has_negligible_moment(mass, share * lack):
                yield _PlaceholderInertial(declared, mass, description, share, misfit=misfit)


def _is_marker(declared: DeclaredTensor, mass: float, misfit: _Misfit) -> bool:
    """Whether a link by itself marks a point, such as the one where a loop closes, with a tensor that is small and no smaller
    than that of what is drawn."""
    largest = max(declared.components)
    return mass <= _MARKER_MASS and misfit.expected <= largest <= _MARKER_MOMENT


def _describe_placeholder(model: Model, link: Link) -> str | None:
    mass, declared = model.mass_by_name.get(link.name), model.tensor_by_name.get(link.name)
    if mass is None or declared is None or is_massless_frame(link):
        return None
    moments = (attribute for name in MOMENTS if (attribute := declared.element.attributes.get(name)) is not None)
    if any(map(is_computed_from_lengths, moments)):
        return None  # a formula of lengths gave the round number: INR009 compares it with the drawn part
    return describe_placeholder(mass.mass, declared.components)


def _measure_misfit(model: Model, declared: DeclaredTensor, mass: float, allowed: float) -> _Misfit | None:
    """Compare a tensor with the drawn part; if programs disagree about the size of a mesh (MSH008), return the better fit."""
    if not has_drawn_shape(declared.link) or is_collision_of_detail(model, declared.link):
        return None
    units = (True, False) if has_unit_ambiguity(model, (declared.link.name,)) else (True,)
    misfits = []
    for unit in units:
        drawn = measure_link_geometry(model, declared.link, apply_unit=unit)
        if drawn is not None:
            if is_unknown_mass(mass, declared.tensor, drawn.solid):
                return None
            solid = compute_solid_inertia(drawn.solid, mass)
            misfit = _compare_moments(declared.tensor, solid, allowed)
            # One round mass of all links is a separate finding, and does not show what a tensor should be.
            most = DENSEST * drawn.solid.volume / mass if has_one_round_mass(model) else 1.0
            is_possible = np.trace(declared.tensor) < most * np.trace(solid)
            if mass < LIGHTEST * drawn.solid.volume and is_possible and not (misfit and misfit.factor <= allowed):
                # No material is so light: the drawing is too large, or the tensor is right for the real mass.
                return None
            if misfit is not None and misfit.is_axial:
                misfit = misfit._replace(is_felt=_turns_about_length(model, declared.link, solid))
            misfits.append(misfit)
    return min((misfit for misfit in misfits if misfit is not None), default=None)


def _turns_about_length(model: Model, link: Link, solid: Array) -> bool:
    """Whether the joint that moves a link turns it about the axis of the least moment of its ``solid`` (3, 3): a rod that swings
    does not show that moment."""
    body = model.pieces.list_body_links(link.name)
    joint = model.pieces.parent_joint.get(body[0])
    if joint is None or joint.type not in {"revolute", "continuous"} or joint.axis is None:
        return False
    _, axes = np.linalg.eigh(solid)
    along = model.piece_frames[link.name][:3, :3] @ axes[:, 0]
    axis = model.piece_frames[body[0]][:3, :3] @ np.array(joint.axis)
    return bool(abs(float(along @ axis)) > _ALONG * float(np.linalg.norm(axis)) > 0.0)


def _compare_moments(declared: Array, solid: Array, allowed: float) -> _Misfit | None:
    """Compare the principal moments of two tensors (3, 3); None if a factor is not finite."""
    moments, expected = np.linalg.eigvalsh(declared), np.maximum(np.linalg.eigvalsh(solid), 1e-300)
    with np.errstate(over="ignore"):
        factors = np.maximum(moments / expected, expected / moments)
    # A rod that is wrong about its own length only swings as it should.
    is_axial = bool(factors[1:].max() <= allowed)
    worst = 0 if is_axial and factors[0] > allowed else 1 + int(factors[1:].argmax())
    if not np.isfinite(factors).all():
        return None
    return _Misfit(float(factors[worst]), is_axial=is_axial, is_felt=True, expected=float(expected[worst]))


def _build_tensor_finding(
    model: Model,
    rule: Rule,
    *,
    known: Sequence[_PlaceholderInertial],
    unknown: Sequence[_PlaceholderInertial],
    estimate: float,
    is_chosen: bool,
) -> Finding:
    """Report together all links that were given one tensor; ``is_chosen``: a comment beside each, or a name, says why."""
    every = [*known, *unknown]
    # A base that is bolted down, or a cart on it, is no example where a link that turns is one.
    moving = [
        suspect
        for suspect in known
        if suspect.factor > estimate and suspect.declared.link.name not in list_unturned_links(model)
    ]
    worst = max(moving or known, key=_rank_suspect, default=None)
    places = [suspect.declared.element for suspect in every]
    names = [suspect.declared.link.name for suspect in every]
    data: dict[str, Any] = {
        "links": join_names(names),
        "what": every[0].description,
        "written": _TYPED,
        "names": names,
        "others": _describe_others(model, every[0].declared, names),
        "who": f"{names[0]} has" if len(names) == 1 else f"{len(names)} links have",
    }
    if worst is None or worst.misfit is None:
        masses = sorted(suspect.mass for suspect in every)
        between = f"{masses[0]:.3g} to {masses[-1]:.3g} kg"
        severity = Severity.INFO if is_loaded_for_frames(model) else None
        finding = rule.finding("shared", at=places[0], related=places[1:], severity=severity, masses=between, **data)
    else:
        is_less = worst.misfit.expected < max(worst.declared.components)
        moved = {name for body in list_whole_bodies(model) if body.is_movable for name in body.links}
        too_large = _TOO_LARGE_BASE if moved.isdisjoint(names) else _TOO_LARGE
        is_felt = any(suspect.misfit is not None and suspect.misfit.is_felt for suspect in known)
        is_bolted = all(suspect.declared.link.name in list_unturned_links(model) for suspect in every)
        is_estimate = worst.misfit.factor <= estimate
        is_bodiless = is_untouched(model)
        turned = math.inf if unknown else compute_turned_share(model, [suspect.declared.link for suspect in known])
        is_absorbed = not unknown and are_absorbed(model, [suspect.declared.link for suspect in known])
        is_stand = worst.misfit.factor <= _OF_STAND and is_sensor_stand(model)
        kinds = {
            "bolted": is_bolted,
            "chosen": is_chosen,
            "estimate": is_estimate,
            "untouched": is_bodiless,
            "stand": is_stand,
            "absorbed": is_absorbed,
            "little": turned < _LITTLE,
            "placeholder": is_felt,
        }
        message = next((kind for kind, fits in kinds.items() if fits), "rod")
        data["written"] = _describe_origin(model, worst)
        finding = rule.finding(
            message,
            at=places[0],
            related=places[1:],
            edits=_propose_edits(model, every),
            link=worst.declared.link.name,
            worst="" if len(names) == 1 else f"{worst.declared.link.name}: ",
            severity=Severity.INFO if message not in {"placeholder", "rod"} else _judge_severity(model, known),
            mass=worst.mass,
            factor=float(f"{worst.misfit.factor:.2g}"),
            turned=100.0 * turned,
            expected=float(f"{worst.misfit.expected:.2g}"),
            less="less" if is_less else "more",
            size="large" if is_less else "small",
            commented=_COMMENTED if all(_has_commented_inertial(model, suspect) for suspect in every) else "",
            consequences=_UNFELT
            if message in {"untouched", "stand", "absorbed", "little"}
            else too_large
            if is_less
            else _TOO_SMALL,
            **data,
        )
    return replace(finding, subjects=tuple(dict.fromkeys(place.location.subject for place in places)))


def _describe_origin(model: Model, suspect: _PlaceholderInertial) -> str:
    """Say that a tensor is that of what the link draws at another mass, of one or two digits, where it is: it was computed for
    that one, and copied. Else that it was typed."""
    moments, drawn = suspect.declared.components, measure_link_geometry(model, suspect.declared.link)
    if drawn is None or len(set(moments)) > 2:  # zero, and one for all
        return _TYPED
    unit = np.linalg.eigvalsh(compute_solid_inertia(drawn.solid, 1.0))
    mass = max(moments) / float(unit[-1]) if unit[0] > 0.0 else 0.0
    short = float(f"{mass:.1e}")
    if (
        unit[-1] > (1.0 + _EQUAL) * unit[0]
        or abs(mass - short) > _EQUAL * mass
        or not is_part_density(mass / drawn.solid.volume)
    ):
        return _TYPED
    return f"that of {short:g} kg with the shape of {suspect.declared.link.name}"


def _describe_others(model: Model, declared: DeclaredTensor, names: Sequence[str]) -> str:
    """Say how many links besides those of these ``names`` have the numbers of a placeholder: little depends on them there, and a
    repair means them too."""
    others = [
        other for other in model.tensors if other.components == declared.components and other.link.name not in names
    ]
    if not others:
        return ""
    return f". {'One more link has' if len(others) == 1 else f'{len(others)} more links have'} the same numbers"


def _judge_severity(model: Model, known: Sequence[_PlaceholderInertial]) -> Severity | None:
    """Return an error where a tensor is so large that no undrawn part makes up for it and the robot may be simulated, unless it
    replaces one in a comment; an info where only the moment of rods about their own length is off, or the model is only
    displayed; None: as the page says."""
    if is_loaded_for_frames(model) or all(suspect.misfit is None or suspect.misfit.is_axial for suspect in known):
        return Severity.INFO
    bodies: dict[str, list[_PlaceholderInertial]] = {}
    for suspect in known:
        bodies.setdefault(model.pieces.list_body_links(suspect.declared.link.name)[0], []).append(suspect)
    is_vast = any(_is_vast(model, root, suspects) for root, suspects in bodies.items())
    if not is_vast or gives_gazebo_sdf(model):
        return None
    if model.source.package is not None and not is_simulated(model):  # a file in no package may be for any program
        return None
    if all(_has_commented_inertial(model, suspect) for suspect in known):
        return None  # it was put in place of the part's own
    has_shapes = all(suspect.declared.link.collisions for suspect in known)
    return None if has_shapes and not has_elements(model) and is_weighed_by_bullet(model) else Severity.ERROR


def _has_commented_inertial(model: Model, suspect: _PlaceholderInertial) -> bool:
    return has_commented_child(model, suspect.declared.link.element, "inertial")


def _is_vast(model: Model, root: str, suspects: Iterable[_PlaceholderInertial]) -> bool:
    """Whether the body of the link ``root`` would have a thousandth of its inertia with the tensors of the drawn parts, if these
    drawings are those of parts which can weigh as much. What only slides does not count: its joint does not turn it."""
    joint = model.pieces.parent_joint.get(root)
    if joint is not None and joint.type == "prismatic":
        return False
    sized = [suspect for suspect in suspects if _can_size(model, suspect)]
    excess = sum(suspect.share * (1.0 - 1.0 / suspect.factor) for suspect in sized)
    return 1.0 - excess <= 1.0 / VAST and any(
        not is_called_empty(model, suspect.declared.inertial.element) for suspect in sized
    )


def _can_size(model: Model, suspect: _PlaceholderInertial) -> bool:
    """Whether the drawing of a link says how large its tensor is."""
    misfit, drawn = suspect.misfit, measure_link_geometry(model, suspect.declared.link)
    if misfit is None or misfit.is_axial or drawn is None or misfit.expected >= max(suspect.declared.components):
        return False
    return suspect.mass <= DENSEST * drawn.solid.volume


def _rank_suspect(suspect: _PlaceholderInertial) -> tuple[bool, float]:
    return suspect.misfit is not None and not suspect.misfit.is_axial, suspect.factor


def _propose_edits(model: Model, suspects: Sequence[_PlaceholderInertial]) -> tuple[Edit, ...]:
    """Return the edits that write the drawn parts' inertia; nothing unless all are known and no text needs two values.

    Nothing either where the mass is as round: then it is a placeholder too, and it decides the inertia.
    """
    edits: dict[Span, Edit] = {}
    for suspect in suspects:
        drawn = propose_from_geometry(model, suspect.declared.link)
        if drawn is None or not drawn.edits or is_round(suspect.mass):
            return ()
        if any(edits.setdefault(edit.span, edit) != edit for edit in drawn.edits):
            return ()
    return tuple(edits.values())


def _check_equal_masses(model: Model, rule: Rule, *, fraction: float, spread: float) -> Iterator[Finding]:
    """Report one round mass that links of all sizes have."""
    heavy = [declared for declared in model.masses if declared.mass > 0]
    counts = Counter(declared.mass for declared in heavy)
    mass, count = counts.most_common(1)[0] if counts else (None, 0)
    if mass is None or not is_round(mass) or count < max(_FEWEST, fraction * len(heavy)):
        return
    alike = [declared for declared in heavy if declared.mass == mass]
    if all(is_called_negligible(model, declared.link) for declared in alike):
        return
    drawn = [declared.link for declared in alike if has_drawn_shape(declared.link)]
    (first, by), (second, _) = (_measure_volumes(model, drawn, apply_unit=unit) for unit in (True, False))
    readings = [sorted(volumes, key=lambda pair: pair[1]) for volumes in (first, second)]
    # If programs disagree about the size of a mesh (MSH008), the sizes must differ so much in both readings.
    if any(len(r) < _FEWEST or r[-1][1] < spread * r[0][1] for r in readings):
        return
    if _are_inertias_computed(model, alike, mass, volumes=[volume for reading in readings for _, volume in reading]):
        return
    (small, least), *_, (large, most) = readings[0]
    # Of links without weight of their own, all of it is in the others.
    is_weightless = 2 * sum(is_lost(model, declared.link) for declared in alike) > len(alike)
    is_unfelt = is_weightless or _count_bodies(model, alike) == 1 or is_never_weighed(model)
    finding = rule.finding(
        "mass",
        at=alike[0].attribute,
        related=[declared.attribute for declared in alike[1:]],
        severity=Severity.INFO if is_unfelt else None,
        count=count,
        total=len(heavy),
        mass=mass,
        small=small.name,
        large=large.name,
        ratio=float(f"{most / least:.2g}"),
        by=by,
    )
    # The robot is its subject, so that it does not hide other findings about one of the links.
    yield replace(finding, subjects=(model.location.subject,))


def _measure_volumes(model: Model, links: Sequence[Link], *, apply_unit: bool) -> tuple[list[tuple[Link, float]], str]:
    """Measure what links draw (m³), all in one way, and say in which one if it is not the drawn volume."""
    known = [
        (link, geometry)
        for link in links
        if (geometry := measure_link_geometry(model, link, apply_unit=apply_unit)) is not None
    ]
    reasons = {link.name: explain_collision_stand_in(model, link) for link, _ in known}
    is_mixed = len({reason is None for reason in reasons.values()}) > 1
    is_solid = all(geometry.hull is None or geometry.hull.volume == geometry.solid.volume for _, geometry in known)
    if all(geometry.closed for _, geometry in known) and (is_solid or not is_mixed):
        by = ", by their collision shapes" if known and None not in reasons.values() else ""
        return [(link, geometry.solid.volume) for link, geometry in known], by
    # An open mesh has only the volume of its convex hull, and a collision shape is a hull too: the others are compared by theirs.
    hulls = []
    for link, geometry in known:
        open_mesh = reasons[link.name] == "open"
        drawn = measure_role_geometry(model, link, "visual", apply_unit=apply_unit) if open_mesh else None
        hull = (drawn or geometry).hull
        hulls += [] if hull is None else [(link, hull.volume)]
    return hulls, ", by their convex hulls"


def _count_bodies(model: Model, alike: Sequence[DeclaredMass]) -> int:
    """Count the rigid bodies that links belong to: of links that are fixed to each other, only the sum of the masses matters."""
    names = {declared.link.name for declared in alike}
    return sum(not names.isdisjoint(body.links) for body in list_whole_bodies(model)) or len(alike)


def _are_inertias_computed(
    model: Model, alike: Sequence[DeclaredMass], mass: float, *, volumes: Sequence[float]
) -> bool:
    """Whether most tensors of links with one ``mass`` (kg) are computed from it and lengths, and it gives all their ``volumes``
    (m³) densities of materials: then the masses were chosen."""
    tensors = [model.tensor_by_name[one.link.name] for one in alike if one.link.name in model.tensor_by_name]
    computed = sum(all(is_computed_from_lengths(one.element.attributes[name]) for name in MOMENTS) for one in tensors)
    return 2 * computed > len(alike) and all(LIGHTEST <= mass / volume <= DENSEST for volume in volumes)
