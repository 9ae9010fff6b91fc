"""INR005 reports inertia tensors that need mass outside the drawn geometry."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.merging import build_group_finding, merge_identical
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import format_length, join_names
from urdfcheck.facts.inertials.certainty import VAST
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.hull_bounds import (
    compute_spread_ratios,
    has_excess_moment,
    is_possible_elsewhere,
    measure_extent,
    measure_hull_distance,
)
from urdfcheck.facts.inertials.inertia_tensor import (
    check_inertia_validity,
    compute_mass_covariance,
    compute_parallel_axis_term,
    compute_solid_inertia,
    list_half_units,
)
from urdfcheck.facts.inertials.materials import DENSEST_PART, LIGHTEST, describe_density, is_part_density
from urdfcheck.facts.inertials.placeholders import describe_placeholder
from urdfcheck.facts.mesh.convex_hull import compute_convex_hull
from urdfcheck.model import DeclaredTensor, Link, Model
from urdfcheck.model.inertials.habits.minor_findings import set_chosen_aside, set_lost_aside
from urdfcheck.model.inertials.habits.root_tensors import find_root_tensors
from urdfcheck.model.inertials.habits.simplified_drawings import is_simplified
from urdfcheck.model.inertials.habits.stated_purposes import is_called_negligible
from urdfcheck.model.inertials.habits.tensor_units import TENSOR_UNITS, TensorUnit, find_tensor_unit, is_unit_possible
from urdfcheck.model.inertials.inertia_diagnosis import inertial_diagnoses
from urdfcheck.model.inertials.inertial_effects import has_unknown_mass
from urdfcheck.model.inertials.inertial_hull import (
    NEGLIGIBLE_SHARE,
    EnclosedInertial,
    enclosed_inertials,
    has_negligible_moment,
    is_carried,
    is_stand_in,
)
from urdfcheck.model.inertials.proposals.com_places import has_com_apart
from urdfcheck.model.inertials.proposals.drawn_inertials import (
    compute_drawn_tensor,
    describe_drawn_inertial,
    draws_part,
    format_comparison,
    lacks_only_com,
)
from urdfcheck.model.inertials.proposals.like_links import has_com_of_twin
from urdfcheck.model.inertials.proposals.mistake_names import describe_mistake
from urdfcheck.model.inertials.proposals.undone_mistakes import LARGEST_SOUND_MISMATCH, has_mistake, propose_undo
from urdfcheck.model.inertials.shared_mistakes import has_edited_masses, list_habitual_links
from urdfcheck.model.motion.fixed_base import list_unturned_links
from urdfcheck.model.parts import TENSOR_NAMES, has_drawn_shape
from urdfcheck.model.repairs.inertial_edits import InertialRepair, build_inertial_repair
from urdfcheck.model.shapes.visual_solid import measure_link_geometry
from urdfcheck.model.use.display import is_made_for_display
from urdfcheck.model.use.scenery import scenery_links

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# A part has a tensor like that of its uniform solid, and each principal moment, within these factors.
_UNIT_RANGE, _MOMENT_RANGE = 10.0, 30.0
# A part that is not drawn may be larger than what it is fixed to, but not ten times: variances, (10)².
_OTHER_PART = 100.0
# Tensors that were taken about the link's origin.
_ABOUT_ORIGIN = frozenset({"about_origin", "positive_notation"})
# Moments that are all possible show little where the spread that the three need is not this much (as a length) beyond the bound:
# of thirteen such findings that were judged, seven of the eight above it were useful, and one of the five below it.
_BARELY_UNEVEN = 1.6
# A mark of a gram or less may have any tensor that a program accepts, but not that of a body a hundred times as long as what is
# drawn, where it changes how its body turns (chosen; of the published ones one reaches 34 times).
_OF_SPECK = 1e4
# A spread that is greater than the bound by less than this factor is that of a rule of thumb (chosen).
_BARELY = 1.1
# A part is larger than the simple drawing that stands for it by less than this factor: 1.5 to 3.7 in the published cases,
# 15 or more where a tensor on such a drawing was wrong.
_BEYOND_SIMPLIFIED = 5.0
# Moments of another shape are so many times farther below the drawn part's than others.
_OWN_FACTORS = 1.25
# Moments that were computed from a shape are its own to within this share.
_TYPED = 5e-3
# A tensor is the drawn part's at another mass to within this share: chosen; 0.04 in the case that led to it.
_OWN = 0.05
# What a body has to weigh less than, over its volume (kg/m³) and over its surface (kg/m²), for INR010 to report it.
_AIR, _TISSUE = 1.0, 0.02
_LONE_FRAME = "write the mass and tensor of a small part if the link is only a frame, or "
_LACKS_COM = ". Mass and tensor are the drawn part's: only the COM is missing"


@dataclass(frozen=True, slots=True, eq=False)
class _Advice:
    """What the report says about the repair of one link."""

    repair: InertialRepair | None = None
    remedy: str = ""
    """How the advice begins, with the comma behind it: the numbers to write where a mistake is known."""
    comparison: str = ""
    """How the advice ends where none is: the drawn part's numbers. They are not a repair: mass or drawing may be wrong."""
    explained: str = ""
    """The end of the message, about the cause."""


def check(model: Model, rule: Rule, *, ratio: float, margin: float) -> Iterator[Finding]:
    findings = set_chosen_aside(model, rule, _check(model, rule, ratio=ratio, margin=margin), by_scaled=True)
    yield from set_lost_aside(model, rule, findings)


def _check(model: Model, rule: Rule, *, ratio: float, margin: float) -> Iterator[Finding]:
    # Wheels with one inertia are one finding.
    findings = _check_each_link(model, rule, ratio=ratio, margin=margin)
    yield from merge_identical(rule, findings, "link", varying=("remedy", "comparison"))


def _check_each_link(model: Model, rule: Rule, *, ratio: float, margin: float) -> Iterator[Finding]:
    unit = find_tensor_unit(model)
    in_unit: list[tuple[DeclaredTensor, bool]] = []
    for part in [] if is_made_for_display(model) else enclosed_inertials(model):
        is_speck = has_negligible_moment(part.mass, part.moment_share)
        if is_speck and part.moment_share < NEGLIGIBLE_SHARE:
            continue
        declared = model.tensor_by_name[part.link.name]
        # If programs disagree about the size (MSH008) or the up axis of a mesh, the excess must be there in all readings.
        excess, typed, spread, slack = min(
            _compute_excess(part, declared, points, ratio=ratio, margin=margin) for points in part.readings
        )
        if not (ratio if part.has_own_geometry else _OTHER_PART) < excess < np.inf or (is_speck and excess < _OF_SPECK):
            continue
        if (excess < VAST and is_stand_in(part)) or part.link.name in scenery_links(model):
            continue
        if has_unknown_mass(model, part.link, part.mass, declared.tensor) or is_called_negligible(model, part.link):
            continue
        # The COM is then as likely to be wrong as the tensor.
        is_elsewhere = any(
            _fits_elsewhere(part, declared, points, ratio=ratio, margin=margin) for points in part.readings
        )
        is_vast = excess >= VAST and part.has_own_geometry and not is_elsewhere and not is_speck
        if unit is not None and not _has_other_unit(model, part.link.name, unit.name):
            in_unit.append((declared, is_vast))
            continue
        if excess >= VAST and not is_speck and (mass := _find_own_mass(model, part)) is not None:
            yield _build_mass_finding(model, rule, part, mass)
            continue
        if _has_token_mass(model, part, declared):
            continue  # INR010 reports the mass
        advice = _advise(model, part, declared, ratio=ratio, excess=excess)
        is_uneven = _is_smaller_than_drawn(model, declared)
        is_uneven |= not is_elsewhere and not any(
            has_excess_moment(points, part.com, part.covariance, margin * measure_extent(points))
            for points in part.readings
        )
        if is_uneven and advice.repair is None and (odd := _describe_odd_moment(model, declared)):
            advice = _Advice(remedy=f"{odd}, or ", explained=advice.explained)
        is_unturned = part.link.name in list_unturned_links(model)
        is_minor = (is_unturned and excess < VAST) or is_carried(model, part.link)
        is_minor |= _lacks_only_drawing(model, part, advice, excess)
        is_minor |= excess**0.5 < (_BARELY_UNEVEN if is_uneven else _BARELY)
        yield rule.finding(
            "uneven" if is_uneven else "com" if is_elsewhere and _fits_another_com(part, margin) else "exceeds",
            at=declared.element,
            severity=Severity.INFO
            if is_minor
            else Severity.ERROR
            if is_vast and not (is_unturned or _slides_in_part(model, part.link))
            else None,
            edits=() if advice.repair is None else advice.repair.edits,
            remedy=advice.remedy,
            comparison=advice.comparison,
            explained=advice.explained,
            link=part.link.name,
            ratio=float(f"{typed:.3g}"),
            wider=float(f"{typed**0.5:.3g}"),
            mass=part.mass,
            spread=float(f"{spread:.3g}"),
            most=float(f"{spread / typed**0.5:.3g}"),
            around=part.geometry_phrase,
            slack=format_length(slack),
            undrawn="" if excess >= VAST else ", or draw the parts that are missing",
        )
    if unit is not None and in_unit:
        yield _build_unit_finding(model, rule, unit, [*in_unit, *_list_others_in_unit(model, unit.name, in_unit)])


def _slides_in_part(model: Model, link: Link) -> bool:
    """Whether a file that another includes only slides a link on its root: what carries it may stand still."""
    pieces = model.pieces
    path = pieces.find_path_to(link.name)
    return model.source.is_part and bool(path) and all(joint.type in {"fixed", "prismatic"} for joint in path)


def _lacks_only_drawing(model: Model, part: EnclosedInertial, advice: _Advice, excess: float) -> bool:
    """Whether nothing but the drawing is known to be wrong: it stands for less than the part, whose numbers are from CAD, or
    which would be denser than lead."""
    is_unexplained = not advice.remedy and not advice.explained
    is_less = is_simplified(model, part) or _is_too_dense(model, part)
    return excess**0.5 < _BEYOND_SIMPLIFIED and is_unexplained and is_less


def _is_too_dense(model: Model, part: EnclosedInertial) -> bool:
    """Whether a link draws a solid too small for its mass, whatever ordinary material it is of."""
    drawn = measure_link_geometry(model, part.link)
    return drawn is not None and drawn.closed and part.mass > DENSEST_PART * drawn.solid.volume


def _has_other_unit(model: Model, link: str, unit: str) -> bool:
    """Whether INR009 reports the unit of a link's tensor: another one than the file's ``unit``, or that of all links."""
    judged = inertial_diagnoses(model).get(link)
    if judged is None or judged.diagnosis.cause != "inertia_unit":
        return False
    return judged.is_habit or judged.diagnosis.detail != unit


def _list_others_in_unit(
    model: Model, unit: str, links: Sequence[tuple[DeclaredTensor, bool]]
) -> Iterator[tuple[DeclaredTensor, bool]]:
    """Iterate over links with the file's ``unit`` beside the ``links`` that have it: those of which only one shape was read."""
    known = {declared.link.name for declared, _ in links}
    for name, judged in inertial_diagnoses(model).items():
        is_in_unit = judged.diagnosis.cause == "inertia_unit" and not _has_other_unit(model, name, unit)
        if name not in known and is_in_unit and not judged.diagnosis.fits_geometry:
            yield model.tensor_by_name[name], False


def _build_unit_finding(
    model: Model, rule: Rule, unit: TensorUnit, links: Sequence[tuple[DeclaredTensor, bool]]
) -> Finding:
    """Report together the ``links`` of a file whose tensors are in another unit, each with whether no undrawn part makes up for
    its tensor. It explains what INR009 reports of one of them alone."""
    alone = [declared.link for declared, _ in links if _has_lone_unit(model, declared.link)]
    places = [declared.element for declared, _ in links]
    return build_group_finding(
        rule,
        "unit",
        places,
        severity=Severity.ERROR if any(is_vast for _, is_vast in links) else None,
        links=join_names(declared.link.name for declared, _ in links),
        first=links[0][0].link.name,
        count=len(links),
        unit=unit.name,
        evidence=unit.evidence.capitalize(),
        remedy=unit.remedy,
        explains=[f"INR009 link[{link.name}]" for link in alone],
    )


def _has_lone_unit(model: Model, link: Link) -> bool:
    """Whether INR009 reports the unit of a link's tensor, or those of mass, tensor and COM together that fit no other link."""
    judged = inertial_diagnoses(model).get(link.name)
    cause = None if judged is None else judged.diagnosis.cause
    return cause == "inertia_unit" or (cause == "units" and judged is not None and not judged.is_habit)


def _advise(model: Model, part: EnclosedInertial, declared: DeclaredTensor, *, ratio: float, excess: float) -> _Advice:
    """Say what is known of the repair: the numbers of one mistake undone, or only those of the drawn part to compare with."""
    diagnosed = inertial_diagnoses(model).get(part.link.name)
    is_explained = (
        diagnosed is not None
        and diagnosed.diagnosis.at_fault
        and diagnosed.diagnosis.mended_tensor_mismatch < LARGEST_SOUND_MISMATCH
    )
    if diagnosed is not None and is_explained and (undo := propose_undo(model, part.link)) is not None:
        if diagnosed.diagnosis.cause == "com_missing" and lacks_only_com(model, part.link):
            return _Advice(undo, f"write {undo.words}, or ", explained=_LACKS_COM)
        mistake = describe_mistake(diagnosed.diagnosis.cause or "", diagnosed.diagnosis.detail)
        explained = f". It fits one mistake: {mistake}"
        return _Advice(undo, f"write {undo.words} if that is the mistake, or ", explained=explained)
    is_known = (
        has_drawn_shape(part.link) and part.is_drawn and len(part.readings) == 1 and not _is_too_dense(model, part)
    )
    is_com_wrong = has_com_apart(model, part.link) and not has_com_of_twin(model, part.link)
    drawn = describe_drawn_inertial(model, part.link, with_com=is_com_wrong) if is_known else ""
    unknown = _Advice(remedy=_LONE_FRAME if _is_lone_frame(part) else "", comparison=format_comparison(drawn))
    known = _Advice(remedy=f"write {drawn}, or ") if drawn and draws_part(model, part.link) else unknown
    if (like_others := _advise_undo_of_others(model, part, declared, ratio=ratio)) is not None:
        return like_others
    if part.link.name in (about_root := find_root_tensors(model)):
        root = f"the origin of {model.tree.root}, the root link"
        explained = f". Of {len(about_root)} links the tensor is the drawn part's about {root}, not about the COM"
        return replace(known, explained=explained)
    if excess >= VAST and (unit := _guess_unit(model, part, ratio)) is not None:
        name, factor = unit
        tensor = [
            f'{axis}="{factor * value:.6g}"' for axis, value in zip(TENSOR_NAMES, declared.components, strict=True)
        ]
        fits = f". The same numbers fit the drawn part in {name}"
        return _Advice(remedy=f"write {' '.join(tensor)} if they are in {name}, or ", explained=fits)
    if is_known and lacks_only_com(model, part.link):
        return replace(known, explained=_LACKS_COM)
    return replace(unknown, explained=_describe_missing_com(model, part.link))


def _find_own_mass(model: Model, part: EnclosedInertial) -> float | None:
    """Return the mass (kg) at which a tensor is the drawn part's, if it gives a usual density and the typed one does not; None
    elsewhere."""
    drawn, tensor = measure_link_geometry(model, part.link), model.tensor_by_name[part.link.name].tensor
    if drawn is None or not drawn.closed or len(part.readings) > 1 or not part.mass < LIGHTEST * drawn.solid.volume:
        return None
    unit = np.linalg.eigvalsh(compute_solid_inertia(drawn.solid, 1.0))
    moments = np.linalg.eigvalsh(tensor)
    mass = float(moments.sum() / unit.sum())
    fits = float(np.abs(moments - mass * unit).max()) <= _OWN * float(moments.max())
    return mass if fits and is_part_density(mass / drawn.solid.volume) else None


def _has_token_mass(model: Model, part: EnclosedInertial, declared: DeclaredTensor) -> bool:
    """Whether a link by itself is lighter than air, and than a skin of tissue paper, and its tensor is one that the drawn part
    can have at its real mass: then the tensor shows nothing, and that of so light a part would be worse."""
    drawn = measure_link_geometry(model, part.link)
    if drawn is None or not drawn.closed or len(part.readings) > 1 or not part.is_single_link:
        return False
    if not part.mass < min(_AIR * drawn.solid.volume, _TISSUE * compute_convex_hull(part.readings[0]).area):
        return False
    heaviest = compute_solid_inertia(drawn.solid, DENSEST_PART * drawn.solid.volume)
    return bool(declared.tensor.trace() <= heaviest.trace())


def _build_mass_finding(model: Model, rule: Rule, part: EnclosedInertial, mass: float) -> Finding:
    """Report a mass beside a tensor that is the drawn part's at another ``mass`` (kg)."""
    inertial, drawn = model.tensor_by_name[part.link.name].inertial, measure_link_geometry(model, part.link)
    volume = 0.0 if drawn is None else drawn.solid.volume
    return rule.finding(
        "mass",
        at=inertial.mass_attribute or inertial.element,
        severity=Severity.ERROR,
        link=part.link.name,
        mass=part.mass,
        other=mass,
        density=describe_density(part.mass / volume),
        ratio=mass / part.mass,
    )


def _is_smaller_than_drawn(model: Model, declared: DeclaredTensor) -> bool:
    """Whether every moment is less than that of the drawn part at this mass, by factors that differ: only a difference of them
    is too great. Factors that agree are those of the part, about the wrong COM."""
    drawn, mass = measure_link_geometry(model, declared.link), declared.inertial.mass
    if drawn is None or mass is None:
        return False
    uniform = np.linalg.eigvalsh(compute_solid_inertia(drawn.solid, mass))
    if not uniform[0] > 0.0:
        return False
    ratios = np.linalg.eigvalsh(declared.tensor) / uniform
    return bool(ratios.max() < 1.0 and ratios.max() > _OWN_FACTORS * ratios.min())


def _describe_odd_moment(model: Model, declared: DeclaredTensor) -> str:
    """Say which moment is not that of the shape that a link draws, or collides with, where the two others are; else nothing."""
    own = compute_drawn_tensor(model, declared)
    if own is None:
        return ""
    wanted, typed = own.diagonal(), declared.tensor.diagonal()
    off = np.flatnonzero(np.abs(typed - wanted) > _TYPED * wanted)
    if len(off) != 1:
        return ""
    name = ("ixx", "iyy", "izz")[int(off[0])]
    return f'write {name}="{wanted[off[0]]:.4g}", as the shape has: the other moments are its own'


def _is_lone_frame(part: EnclosedInertial) -> bool:
    """Whether a link draws nothing, and what it is fixed to has most of the mass: it may be a frame that needs no inertial."""
    return part.is_drawn and not has_drawn_shape(part.link) and not part.is_single_link and part.mass_share != 1.0


def _advise_undo_of_others(
    model: Model, part: EnclosedInertial, declared: DeclaredTensor, *, ratio: float
) -> _Advice | None:
    """Return the advice where other links have their tensors about the link's origin, and without this
    mistake the tensor is possible inside the geometry; None elsewhere."""
    causes = {
        name: judged.diagnosis.cause
        for name, judged in inertial_diagnoses(model).items()
        if judged.diagnosis.at_fault and judged.diagnosis.cause in _ABOUT_ORIGIN and name != part.link.name
    }
    inertial, matrix = declared.inertial, declared.inertial.origin.matrix
    if len(set(causes.values())) != 1 or matrix is None:
        return None
    tensor, rotation = declared.tensor, matrix[:3, :3]
    if "positive_notation" in causes.values():
        tensor = 2.0 * np.diag(tensor.diagonal()) - tensor
    undone = tensor - compute_parallel_axis_term(part.mass, rotation.T @ matrix[:3, 3])
    validity = check_inertia_validity(undone)
    if not (validity.positive_definite and validity.triangle_inequality):
        return None
    covariance = rotation @ compute_mass_covariance(undone, part.mass) @ rotation.T
    if any(compute_spread_ratios(p, part.com, covariance, margin=0.0)[0].max() > ratio for p in part.readings):
        return None
    numbers = DeclaredInertial(mass=part.mass, com=matrix[:3, 3], tensor=undone, rotation=rotation)
    what, names = describe_mistake(next(iter(causes.values())) or "", ""), join_names(causes)
    return _Advice(
        remedy=f"write {build_inertial_repair(inertial, numbers).text} if it has the mistake of {names} (INR009), or ",
        explained=f". It is possible without the mistake of {names}: {what}",
    )


def _describe_missing_com(model: Model, link: Link) -> str:
    """Return the end of the message about a COM of zero in a file whose COMs were left at zero; empty in any other file."""
    habitual = list_habitual_links(model)
    xyz = None if link.inertial is None else link.inertial.origin.xyz
    if xyz is None or any(xyz) or not habitual or not has_mistake(model, habitual[0], "com_missing"):
        return ""
    return f". Its COM is 0 0 0, like those of {len(habitual)} other links whose COM was left at zero (INR009)"


def _guess_unit(model: Model, part: EnclosedInertial, ratio: float) -> tuple[str, float] | None:
    """Return the one unit in which the author's own tensor is possible inside the geometry, with moments like those of a uniform
    part; None where none is, or several are, or another link of the file does not have it, for a placeholder, for the tensor of
    another mass, and for a unit that no program writes."""
    declared = model.tensor_by_name[part.link.name]
    if describe_placeholder(part.mass, declared.components) is not None or has_edited_masses(model):
        return None
    fitting = [(name, factor) for name, factor in TENSOR_UNITS.items() if _fits_unit(model, part, factor, ratio)]
    is_one = len(fitting) == 1 and fitting[0][0] != "g·m²" and is_unit_possible(model, fitting[0][1])
    return fitting[0] if is_one else None


def _fits_unit(model: Model, part: EnclosedInertial, factor: float, ratio: float) -> bool:
    """Whether a tensor in a unit of ``factor`` kg·m² is possible inside the geometry, and each moment like that of a uniform
    part."""
    drawn, declared = measure_link_geometry(model, part.link), model.tensor_by_name[part.link.name]
    if drawn is None:
        return False
    uniform = np.linalg.eigvalsh(compute_solid_inertia(drawn.solid, part.mass))
    if not uniform[0] > 0.0:
        return False
    moments = factor * np.linalg.eigvalsh(declared.tensor)
    size, sizes = float(moments.sum() / uniform.sum()), moments / uniform
    if not (
        1.0 / _UNIT_RANGE < size < _UNIT_RANGE and 1.0 / _MOMENT_RANGE < sizes.min() <= sizes.max() < _MOMENT_RANGE
    ):
        return False
    return all(
        compute_spread_ratios(points, part.com, factor * part.covariance, margin=0.0)[0].max() <= ratio
        for points in part.readings
    )


def _compute_excess(
    part: EnclosedInertial, declared: DeclaredTensor, points: Array, *, ratio: float, margin: float
) -> tuple[float, float, float, float]:
    """Return the worst ratio of the inertial's variance along an axis to the greatest possible one, without what rounding may
    have added to it; that of what is typed, and the root (m) of its variance; and by how much (m) the geometry was enlarged on
    all sides.

    If the centre of mass is outside, the geometry is enlarged until it is inside.
    """
    slack = margin * measure_extent(points)
    covariance = part.covariance - _estimate_rounding(part, declared) * np.eye(3)
    ratios, axes = compute_spread_ratios(points, part.com, covariance, margin=slack)
    if ratios.max() > ratio and (distance := measure_hull_distance(points, part.com)) > 0.0:
        slack += distance
        ratios, axes = compute_spread_ratios(points, part.com, covariance, margin=slack)
    excess = float(ratios.max())
    if excess > ratio:
        covariance = part.covariance
        ratios, axes = compute_spread_ratios(points, part.com, covariance, margin=slack)
    worst = int(ratios.argmax())
    variance = float(axes[:, worst] @ covariance @ axes[:, worst])
    return excess, float(ratios[worst]), max(0.0, variance) ** 0.5, slack


def _fits_elsewhere(
    part: EnclosedInertial, declared: DeclaredTensor, points: Array, *, ratio: float, margin: float
) -> bool:
    """Whether the tensor is possible inside the geometry about another COM than the one that was typed."""
    covariance = part.covariance - _estimate_rounding(part, declared) * np.eye(3)
    return is_possible_elsewhere(points, covariance, ratio, margin * measure_extent(points))


def _fits_another_com(part: EnclosedInertial, margin: float) -> bool:
    """Whether the typed numbers are possible about another COM as they stand, without what a report of an excess leaves to
    rounding and tolerance."""
    return any(
        is_possible_elsewhere(points, part.covariance, margin=margin * measure_extent(points))
        for points in part.readings
    )


def _estimate_rounding(part: EnclosedInertial, declared: DeclaredTensor) -> float:
    """Return the largest change of a variance (m²) by rounding the tensor to the typed digits; a placeholder is not rounded."""
    if describe_placeholder(part.mass, declared.components) is not None:
        return 0.0
    xx, xy, xz, yy, yz, zz = list_half_units(declared.texts)
    products = 2.0 * (xy * xy + xz * xz + yz * yz)
    return float(0.5 * (xx + yy + zz) + np.sqrt(xx * xx + yy * yy + zz * zz + products)) / part.mass
