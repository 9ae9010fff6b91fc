"""INR006 reports COMs outside the drawn geometry."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import Finding, Located, Rule, Severity
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import format_length
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.hull_bounds import measure_extent, measure_hull_distance
from urdfcheck.facts.inertials.inertia_tensor import Solid, compute_solid_inertia
from urdfcheck.facts.mesh.diameter import measure_diameter
from urdfcheck.model import Link, Model
from urdfcheck.model.inertials.habits.minor_findings import set_lost_aside
from urdfcheck.model.inertials.habits.root_coms import find_root_coms
from urdfcheck.model.inertials.inertial_hull import (
    NEGLIGIBLE_SHARE,
    EnclosedInertial,
    enclosed_inertials,
    is_stand_in,
)
from urdfcheck.model.inertials.mirrored_inertials import find_same_numbers
from urdfcheck.model.inertials.proposals.drawn_inertials import draws_part
from urdfcheck.model.inertials.proposals.inertial_texts import describe_own_call
from urdfcheck.model.inertials.reach import is_beyond_reach
from urdfcheck.model.inertials.shapes_at_com import describe_other_frame
from urdfcheck.model.inertials.shared_mistakes import measure_turn_of_tensor
from urdfcheck.model.motion.fixed_base import list_bolted_links
from urdfcheck.model.parts import has_drawn_shape
from urdfcheck.model.repairs.inertial_edits import InertialRepair, build_inertial_repair
from urdfcheck.model.shapes.visual_solid import has_unit_ambiguity, measure_link_geometry

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Mat3

# A coordinate has the wrong sign if the other sign brings the centre of mass this near to the drawn part's own, relative to the
# part's size; a motor at one end of a link moves it by as much.
_NEAR = 0.1
# Products are those of the drawn part, signs included, if they differ by less than this share of their size; below the other
# share of the largest moment they are none.
_SAME_PRODUCTS, _NO_PRODUCTS = 0.5, 1e-6
# The products of inertia whose signs change with that of a coordinate.
_PRODUCTS = {"x": "ixy and ixz", "y": "ixy and iyz", "z": "ixz and iyz"}
# Two links do not draw the same if their boxes differ by more than this share of the size (chosen).
_UNLIKE = 0.1
# A tensor that is so many times the drawn part's, or such a fraction of it, is that of another body, and so is its COM (chosen).
_OTHER_BODY = 5.0


@dataclass(frozen=True, slots=True)
class _SignRepair:
    """A coordinate whose sign is wrong."""

    axis: str
    repair: InertialRepair
    advice: str
    """What to do about the products of inertia; empty unless the drawn part's are their negatives."""


def check(model: Model, rule: Rule, *, margin: float) -> Iterator[Finding]:
    yield from set_lost_aside(model, rule, _check(model, rule, margin=margin), is_about_com=True)


def _check(model: Model, rule: Rule, *, margin: float) -> Iterator[Finding]:
    for part in enclosed_inertials(model):
        if not has_drawn_shape(part.link):
            continue
        distances = [
            (measure_hull_distance(points, part.com), measure_extent(points), points) for points in part.readings
        ]
        # If programs disagree about the size (MSH008) or the up axis of a mesh, it must be outside in all readings.
        distance, size, points = min(distances, key=lambda one: one[0] / one[1] if one[1] else 0.0)
        if not size or distance <= margin * size or (distance < size and is_stand_in(part)):
            continue
        # A light part that is many sizes away adds to the moments of its body like a heavy one, with the square of the distance.
        if part.mass_share * max(1.0, distance / size) ** 2 < NEGLIGIBLE_SHARE:
            continue
        sign = _find_sign_repair(model, part)
        missing = sign is None and not any(part.inertial.origin.xyz or ())
        is_of_root = part.link.name in find_root_coms(model)
        is_bolted = sign is None and part.link.name in list_bolted_links(model) and not is_beyond_reach(model, distance)
        other_frame = "" if sign is not None or is_bolted else describe_other_frame(model, part.link)
        message = "sign" if sign is not None else "bolted" if is_bolted else "drawn" if other_frame else "outside"
        length = measure_diameter(points)
        copied = "" if sign is not None or missing or is_of_root else _find_copy(model, part.link)
        yield rule.finding(
            message,
            at=_locate_drawing(part) if other_frame else _locate(part),
            severity=Severity.INFO if is_bolted else None,
            cause="sign"
            if sign is not None
            else "missing"
            if missing
            else "root"
            if is_of_root
            else "copied"
            if copied
            else None,
            edits=() if sign is None else sign.repair.edits,
            link=part.link.name,
            distance=float(f"{distance:.3g}"),
            length=format_length(distance),
            size=float(f"{length:.3g}"),
            percent=float(f"{100.0 * distance / length:.2g}"),
            around=part.geometry_phrase,
            axis=None if sign is None else sign.axis,
            edit=None if sign is None else f"{sign.repair.text}{sign.repair.where}",
            advice="" if sign is None else sign.advice,
            evidence=other_frame,
            root=model.tree.root if is_of_root else "",
            copied=copied,
        )


def _find_copy(model: Model, link: Link) -> str:
    """Name a link with the same mass, COM and tensor that does not draw the same in its frame; empty without one, or where the
    numbers are so round that chance makes them equal."""
    com, tensors = None if link.inertial is None else link.inertial.origin.xyz, model.tensor_by_name
    if link.name not in tensors:
        return ""
    same_com = [one.link for one in tensors.values() if one.link is not link and one.inertial.origin.xyz == com]
    source = find_same_numbers(model, link, (other for other in same_com if _draws_otherwise(model, link, other)))
    return "" if source is None else source.name


def _draws_otherwise(model: Model, one: Link, other: Link) -> bool:
    """Whether it is known that two links do not draw the same in their frames."""
    drawn = [measure_link_geometry(model, link) for link in (one, other)]
    boxes = [np.array([d.points.min(axis=0), d.points.max(axis=0)]) for d in drawn if d is not None]
    if len(boxes) < 2:
        return False
    return bool(np.abs(boxes[0] - boxes[1]).max() > _UNLIKE * float(np.ptp(boxes[0], axis=0).max()))


def _find_sign_repair(model: Model, part: EnclosedInertial) -> _SignRepair | None:
    """Return the only coordinate whose other sign puts the centre of mass where the drawn part has its own, or None."""
    drawn, pose, xyz = measure_link_geometry(model, part.link), part.inertial.origin.matrix, part.inertial.origin.xyz
    if drawn is None or pose is None or xyz is None or part.inertial.tensor is None:
        return None
    if has_unit_ambiguity(model, (part.link.name,)) or _has_tensor_of_other_body(part, drawn.solid):
        return None
    repairs = []
    for i, axis in enumerate("xyz"):
        com = np.array(xyz)
        com[i] *= -1.0
        near = float(np.linalg.norm(com - drawn.solid.com)) <= _NEAR * measure_extent(drawn.points)
        if near and measure_hull_distance(drawn.points, com) == 0.0:
            wanted = DeclaredInertial(mass=part.mass, com=com, tensor=part.inertial.tensor, rotation=pose[:3, :3])
            repair = build_inertial_repair(part.inertial, wanted)
            # A tensor about other axes would still be one: the sign of the COM alone makes no sound part.
            is_enough = not measure_turn_of_tensor(wanted, drawn.solid)
            uniform = compute_solid_inertia(drawn.solid, part.mass)
            are_flipped = draws_part(model, part.link) and _has_flipped_products(wanted, uniform, i)
            advice = f", and flip the signs of {_PRODUCTS[axis]}, which are wrong likewise" if are_flipped else ""
            where = describe_own_call(model, part.link, repair)  # the same text is right for other links
            edits = repair.edits if is_enough and not where else ()
            repairs.append(_SignRepair(axis, replace(repair, edits=edits, where=where), advice))
    return repairs[0] if len(repairs) == 1 else None


def _has_tensor_of_other_body(part: EnclosedInertial, solid: Solid) -> bool:
    """Whether no part like the drawn one has the tensor at this mass, so that nothing of the inertial need be the part's. One
    typed number for all three moments is a placeholder, and says nothing of the COM."""
    tensor = part.inertial.tensor
    if tensor is None or float(np.ptp(np.diag(tensor))) == 0.0:
        return False
    times = float(np.trace(tensor) / np.trace(compute_solid_inertia(solid, part.mass)))
    return not 1.0 / _OTHER_BODY <= times <= _OTHER_BODY


def _has_flipped_products(declared: DeclaredInertial, uniform: Mat3, axis: int) -> bool:
    """Whether the products of inertia with an axis are those of the uniform part with their signs changed, and not as they are:
    zero is right for both, and those of a part that is not uniform show nothing."""
    products, expected = (np.delete(tensor[axis], axis) for tensor in (declared.inertia, uniform))
    size = float(np.linalg.norm(products))
    if size <= _NO_PRODUCTS * float(np.abs(declared.inertia).max()):
        return False
    return float(np.linalg.norm(products + expected)) < _SAME_PRODUCTS * size


def _locate_drawing(part: EnclosedInertial) -> Located:
    shape = part.link.visuals[0]
    return shape.origin.get_attribute("xyz") or shape


def _locate(part: EnclosedInertial) -> Located:
    xyz = part.inertial.origin.get_attribute("xyz")
    return part.inertial.element if xyz is None else xyz
