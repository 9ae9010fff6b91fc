"""JNT015 reports wheels whose joint axis is not their axis of revolution."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Edit, Finding, Location, Rule
from urdfcheck.facts.inertials.inertia_tensor import check_inertia_validity, compute_mass_covariance
from urdfcheck.facts.likeness.revolution import RoundOutline, find_revolution_axis, measure_line_angle, measure_outline
from urdfcheck.model import Joint, Link, Model
from urdfcheck.model.ground.wheels import WHEEL_NAME, collect_shape_corners, rolling_wheels
from urdfcheck.model.parts import Inertial, Shape
from urdfcheck.model.shapes.solids import compute_drawn_scale

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

# What carries a wheel is called after it and turns about another axis.
_CARRIER = re.compile(
    r"steer|swivel|rotation|holder|fork|mount|bracket|knuckle|arm|leg|rocker|bogie|susp|axle", re.IGNORECASE
)
# An axis that was meant to be x, y or z, and one that is upright, to within a degree and some.
_SQUARE = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class _AxisEvidence:
    """What tells a wheel's own ``axis`` (3,), in its frame: ``kind`` visual, collision or inertia; ``shape`` of what is drawn.

    ``is_wheel``: whether it would be taken for a wheel whatever its joint does, being flat and about its frame's origin."""

    kind: str
    axis: Array
    location: Location
    is_wheel: bool
    shape: RoundOutline | None = None


def check(model: Model, rule: Rule, *, limit: float, eccentric: float) -> Iterator[Finding]:
    rolls = {wheel.joint.name for wheel in rolling_wheels(model)}
    wheels = [j for j in model.joints if j.name in model.axes and (j.name in rolls or _is_named_wheel(j))]
    upright = [joint for joint in wheels if abs(abs(float(model.axes[joint.name][2])) - 1) < _SQUARE]
    for joint in wheels:
        if len(upright) == 1 and joint is upright[0] and len(wheels) == 3:
            continue  # the steered wheel of a tricycle, with one joint for both
        yield from _check_wheel(model, rule, joint, math.radians(limit), eccentric)


def _is_named_wheel(joint: Joint) -> bool:
    words = f"{joint.name} {joint.child}"
    return joint.type == "continuous" and bool(WHEEL_NAME.search(words)) and not _CARRIER.search(words)


def _check_wheel(model: Model, rule: Rule, joint: Joint, limit: float, eccentric: float) -> Iterator[Finding]:
    axis = np.array(joint.axis or (1.0, 0.0, 0.0))
    axis = axis / np.linalg.norm(axis)
    witnesses = _collect_evidence(model, model.link_by_name[joint.child])
    angles = [measure_line_angle(witness.axis, axis) for witness in witnesses]
    against = [w for w, angle in zip(witnesses, angles, strict=True) if angle > limit]
    others = [w.kind for w in witnesses if w not in against]
    drawn = [w for w in witnesses if w.shape is not None]
    data: dict[str, Any] = {"joint": joint.name, "wheel": joint.child, "axis": _format_axis(axis)}
    if against and not others and not (drawn or against)[0].is_wheel:
        return  # a rod, or something that hangs beside its joint
    if drawn and not others:
        yield _build_axis_finding(model, rule, joint, drawn[0], witnesses, limit, data)
        return
    for witness in against:
        inertial = None if witness.shape is not None else model.link_by_name[joint.child].inertial
        yield rule.finding(
            "drawn" if inertial is None else "inertia" if others else "unsure",
            at=witness.location,
            related=[joint.axis_location],
            edits=_propose_edits(inertial, witness.axis, axis) if inertial is not None and others else (),
            kind=witness.kind,
            others=" and ".join(others) + (" is" if len(others) == 1 else " are"),
            angle=math.degrees(measure_line_angle(witness.axis, axis)),
            own=_format_axis(witness.axis),
            **data,
        )
    for witness in drawn:
        assert witness.shape is not None
        centre = witness.shape.centre
        offset = float(np.linalg.norm(centre - (centre @ axis) * axis))
        if witness not in against and offset > eccentric * witness.shape.radius:
            yield rule.finding(
                "eccentric",
                at=witness.location,
                kind=witness.kind,
                offset=offset * 1e3,
                part=offset / witness.shape.radius,
                centre=" ".join(f"{round(float(v), 5) + 0.0:g}" for v in centre),
                **data,
            )
            return


def _build_axis_finding(
    model: Model,
    rule: Rule,
    joint: Joint,
    drawn: _AxisEvidence,
    witnesses: Sequence[_AxisEvidence],
    limit: float,
    data: Any,
) -> Finding:
    """All that is known of the wheel speaks against the joint's axis."""
    own = drawn.axis * _choose_axis_sign(model, joint, drawn.axis)
    element = joint.axis_element
    attribute = None if element is None else element.attributes.get("xyz")
    edits = []
    if attribute is not None and attribute.literal and attribute.span is not None:
        edits.append(Edit(attribute.span, attribute.typed, _format_axis(own)))
    agreeing = [w.kind for w in witnesses if measure_line_angle(w.axis, drawn.axis) <= limit]
    return rule.finding(
        "default" if attribute is None else "axis",
        at=joint.axis_location,
        edits=edits,
        witnesses=" and ".join(agreeing),
        tell="tells" if len(agreeing) == 1 else "tell",
        angle=math.degrees(measure_line_angle(drawn.axis, joint.axis or (1.0, 0.0, 0.0))),
        own=_format_axis(own),
        **data,
    )


def _collect_evidence(model: Model, link: Link) -> list[_AxisEvidence]:
    found = []
    for kind, shapes in (("visual", link.visuals), ("collision", link.collisions)):
        witness = _find_drawn_axis(model, kind, shapes)
        if witness is not None:
            found.append(witness)
    if link.inertial is not None:
        found += _find_inertia_axis(link.inertial)
    return found


def _find_drawn_axis(model: Model, kind: str, shapes: Sequence[Shape]) -> _AxisEvidence | None:
    """The axis of revolution of the largest shape about which all of them are round."""
    points = collect_shape_corners(model, shapes)
    if points is None or not len(points):
        return None
    sized = []
    for shape in shapes:
        axis, own = _compute_shape_axis(model, shape), collect_shape_corners(model, [shape])
        if axis is not None and own is not None:
            sized.append((float(np.ptp(own, axis=0).max()), shape, axis))
    for _, shape, axis in sorted(sized, key=lambda one: -one[0]):
        seen = measure_outline(points, axis)
        if seen.is_round():
            near = float(np.linalg.norm(seen.centre)) <= 2 * seen.radius and seen.width <= 4 * seen.radius
            return _AxisEvidence(kind, axis, shape.location, near, seen)
    return None


def _compute_shape_axis(model: Model, shape: Shape) -> Array | None:
    pose = shape.origin.matrix
    if pose is None or shape.kind in {None, "box", "sphere"}:
        return None
    if shape.kind != "mesh":
        along: Array = pose[:3, 2]
        return along
    facts, scale = model.meshes.get_facts(shape), compute_drawn_scale(model, shape)
    if facts is None or scale is None:
        return None
    axis = find_revolution_axis(facts.surface_covariance * np.outer(scale, scale))
    return None if axis is None else pose[:3, :3] @ axis


def _find_inertia_axis(inertial: Inertial) -> list[_AxisEvidence]:
    """The axis of revolution of the mass, where its tensor is one that a body can have."""
    tensor, mass = inertial.tensor_in_link, inertial.mass
    if tensor is None or mass is None or not mass > 0:
        return []
    report = check_inertia_validity(tensor)
    axis = (
        find_revolution_axis(compute_mass_covariance(tensor, mass))
        if report.positive_definite and report.triangle_inequality
        else None
    )
    if axis is None:
        return []
    # About the axis of a disc the moment is the largest.
    flat = float(axis @ tensor @ axis) > 0.99 * report.moments[2]
    return [_AxisEvidence("inertia", axis, inertial.location, flat)]


def _propose_edits(inertial: Inertial, own: Array, axis: Array) -> list[Edit]:
    """The moments about two axes of the frame exchanged, where no more than that is wrong and both are typed as they stand."""
    element, six, pose = inertial.tensor_element, inertial.inertia_components, inertial.origin.matrix
    places = [int(np.abs(one).argmax()) for one in (own, axis)]
    if element is None or six is None or pose is None or not np.array_equal(pose[:3, :3], np.eye(3)):
        return []
    straight = all(1 - abs(float(one[place])) < _SQUARE**2 for one, place in zip((own, axis), places, strict=True))
    if not straight or any(six[i] != 0 for i in (1, 2, 4)):
        return []
    one, other = (element.attributes[("ixx", "iyy", "izz")[place]] for place in places)
    if not (one.literal and other.literal and one.span is not None and other.span is not None):
        return []
    return [Edit(one.span, one.typed, other.typed), Edit(other.span, other.typed, one.typed)]


def _choose_axis_sign(model: Model, joint: Joint, axis: Array) -> float:
    """The sign that makes an axis of the joint's child point to the robot's left, or along +x or +z when it lies there."""
    rotated = model.frames[joint.child][:3, :3] @ axis
    return math.copysign(1.0, float(rotated[int(np.abs(rotated).argmax())]))


def _format_axis(axis: Array) -> str:
    largest = int(np.abs(axis).argmax())
    if 1 - abs(float(axis[largest])) < _SQUARE**2:
        axis = np.sign(axis) * (np.arange(3) == largest)
    return " ".join(f"{round(float(v), 6) + 0.0:g}" for v in axis)
