"""JNT015 reports wheels whose joint axis is not their axis of revolution."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Edit, FactUnavailableError, Finding, Location, Rule, Severity
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import format_point, join_names
from urdfcheck.facts.inertials.hull_bounds import compute_spread_ratios, measure_extent
from urdfcheck.facts.inertials.inertia_tensor import check_inertia_validity, compute_mass_covariance
from urdfcheck.facts.likeness.revolution import RoundOutline, find_revolution_axis, measure_line_angle, measure_outline
from urdfcheck.model import Inertial, Joint, Link, Model, Shape
from urdfcheck.model.ground.wheels import LEVEL, Wheel, rolling_wheels
from urdfcheck.model.inertials.inertial_hull import enclosed_inertials
from urdfcheck.model.likeness.mirror_pairs import list_named_pairs
from urdfcheck.model.likeness.shape_comparison import list_alike_links
from urdfcheck.model.repairs.edits import edit_numbers, swap_values
from urdfcheck.model.shapes.corners import collect_shape_corners
from urdfcheck.model.shapes.solids import compute_drawn_scale
from urdfcheck.model.use.display import judge_as_drawing
from urdfcheck.model.use.gazebo_starts import is_steered_in_sdf
from urdfcheck.model.wheel_names import NOT_DRIVEN_NAME, WHEEL_CARRIER_NAME, WHEEL_NAME, is_revolute_wheel
from urdfcheck.source.text.handed_values import find_handed_text
from urdfcheck.source.text.xml import Attribute

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# What steers a wheel, by its name.
_KNUCKLE_NAME = re.compile(r"hinge|steer|knuckle|king_?pin", re.IGNORECASE)
# An axis counts as x, y or z, or as upright, to within a little more than a degree.
_SQUARE = 0.02
# So many wheels around a base show whether axes point outwards.
_RING = 3
# The part of an axis that is upright, beyond which a wheel spins like a top rather than rolls (chosen).
_STEEP = 0.7
# Of a revolute joint (rad), in three digits.
_WHOLE_TURN = 6.28
# kg m²: a wheel of 5 cm and 10 g has 1e-5 more about its axle than across it.
_NEGLIGIBLE_MOMENT = 1e-5
# A ball stands for a wheel that is drawn as a disc if their radii differ by no more than this share: chosen, for a tyre that is
# rounded in one of them.
_BALL = 0.1
# A solid wheel has its largest moment about its axle if it is flatter than √3 radii; none is told apart near that (chosen).
_FLAT, _LONG = 1.5, 2.0
# A variance of at most so many times the greatest one fits, in a hull that is larger by this part of its size (as in INR005).
_FITTING, _MARGIN = 1.1, 0.02


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _AxisEvidence:
    """Evidence of a wheel's own axis."""

    kind: str
    """``visual``, ``collision`` or ``inertia``."""
    axis: Array
    """(3,) in the wheel's frame."""
    location: Location
    is_wheel: bool
    """Whether the part is a wheel whatever its joint does: flat, and near its frame's origin."""
    shape: RoundOutline | None = None
    """The outline of the geometry; None for the inertia."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _SuspectWheel:
    """A wheel and the evidence of its axis."""

    joint: Joint
    link: Link
    axis: Array
    """The joint's unit axis (3,) in the wheel's frame."""
    evidence: Sequence[_AxisEvidence]

    @property
    def names(self) -> dict[str, Any]:
        """The data that all messages about the wheel share."""
        return {"joint": self.joint.name, "wheel": self.joint.child, "axis": _format_axis(self.axis)}


def check(model: Model, rule: Rule, *, limit: float, eccentric: float) -> Iterator[Finding]:
    rolls = {wheel.joint.name for wheel in rolling_wheels(model)}
    known = [j for j in model.joints if j.name in model.axes and (j.name in rolls or _is_named_wheel(j))]
    wheels = [j for j in model.joints if j in known or _is_drawn_like_wheel(model, j, known)]
    upright = [joint for joint in wheels if abs(abs(float(model.axes[joint.name][2])) - 1) < _SQUARE]
    for joint in wheels:
        if len(upright) == 1 and joint is upright[0] and len(wheels) == 3:
            continue  # the steered wheel of a tricycle, with one joint for both
        if joint in upright and is_steered_in_sdf(model, joint.name):
            continue  # the URDF shows how it is steered, and the SDF has a second axis for rolling
        for finding in _check_wheel(model, rule, joint, wheels, limit=math.radians(limit), eccentric=eccentric):
            yield judge_as_drawing(model, finding)


def _is_named_wheel(joint: Joint) -> bool:
    words = f"{joint.name} {joint.child}"
    is_continuous = joint.type == "continuous" and WHEEL_NAME.search(words) and not WHEEL_CARRIER_NAME.search(words)
    return bool(is_continuous) or (is_revolute_wheel(joint) and not _may_steer(joint))


def _is_drawn_like_wheel(model: Model, joint: Joint, wheels: Sequence[Joint]) -> bool:
    """Whether a continuous joint, whatever its name, turns what a wheel on the same link draws, and nothing else."""
    if joint.type != "continuous" or joint.name not in model.axes or model.tree.child_joints.get(joint.child):
        return False
    names = f"{joint.name} {joint.child}"
    beside = {wheel.child for wheel in wheels if wheel.parent == joint.parent}
    if not beside or WHEEL_CARRIER_NAME.search(names) or NOT_DRIVEN_NAME.search(names):
        return False
    return not beside.isdisjoint(list_alike_links(model, joint.child))


def _may_steer(joint: Joint) -> bool:
    """Whether a revolute joint may steer its wheel: not with a whole turn, nor with the limits of an empty form (JNT005)."""
    lower, upper = joint.get_limit_value("lower"), joint.get_limit_value("upper")
    return lower is None or upper is None or 0.0 < abs(upper - lower) < _WHOLE_TURN


def _check_wheel(
    model: Model, rule: Rule, joint: Joint, wheels: Sequence[Joint], *, limit: float, eccentric: float
) -> Iterator[Finding]:
    link = model.link_by_name[joint.child]
    axis = np.array(joint.axis or (1.0, 0.0, 0.0))
    axis = axis / np.linalg.norm(axis)
    wheel = _SuspectWheel(joint=joint, link=link, axis=axis, evidence=_collect_evidence(model, link))
    balls = [shape for shape in link.collisions if _is_ball(shape)]
    if balls and not _is_disc_about(balls, wheel):
        return  # it rolls about any axis, whatever is drawn around it
    against = [witness for witness in wheel.evidence if measure_line_angle(witness.axis, axis) > limit]
    others = [witness.kind for witness in wheel.evidence if witness not in against]
    drawn = [witness for witness in wheel.evidence if witness.shape is not None]
    if against and not others and not (drawn or against)[0].is_wheel:
        return  # a rod, or a part mounted beside its joint
    if drawn and not others and _lies_flat(model, wheel, drawn[0]):
        yield _build_lying_finding(rule, wheel, drawn=drawn, limit=limit)
        return
    if drawn and not others:
        is_either = _may_be_drawn_wrong(model, wheel, drawn[0], wheels)
        yield _build_axis_finding(model, rule, wheel, drawn=drawn[0], limit=limit, is_either=is_either)
        return
    upright = next((witness for witness in against if _stands_across(model, wheel, witness)), None)
    if upright is not None:
        yield _build_upright_finding(model, rule, wheel, drawn=upright, others=others)
        return
    for witness in against:
        yield _build_witness_finding(model, rule, wheel, witness, others=others)
    for witness in drawn:
        if witness.shape is not None and witness not in against:
            part = _measure_offset(witness, axis)
            if part > eccentric:
                alike = [one for one in drawn if _measure_offset(one, axis) > eccentric]
                yield rule.finding(
                    "eccentric",
                    at=witness.location,
                    related=[one.location for one in alike if one is not witness],
                    kind=" and ".join(one.kind for one in alike),
                    are="is" if len(alike) == 1 else "are",
                    offset=part * witness.shape.radius * 1e3,
                    part=part,
                    centre=format_point(witness.shape.centre, decimals=5),
                    effect="the wheel lifts the robot once per turn"
                    if any(one.kind == "collision" for one in alike)
                    else "the wheel is seen to wobble when the joint turns",
                    **wheel.names,
                )
                return


def _stands_across(model: Model, wheel: _SuspectWheel, witness: _AxisEvidence) -> bool:
    """Whether a wheel is drawn upright, but its joint turns it about a vertical axis.

    A collision shape that agrees with such a joint shows nothing: a cylinder that is not rotated is round about z.
    """
    own = model.frames[wheel.link.name][:3, :3] @ witness.axis
    is_vertical = abs(abs(float(model.axes[wheel.joint.name][2])) - 1) < _SQUARE
    return witness.kind == "visual" and witness.is_wheel and is_vertical and abs(float(own[2])) < _SQUARE


def _lies_flat(model: Model, wheel: _SuspectWheel, witness: _AxisEvidence) -> bool:
    """Whether a wheel is drawn round about a vertical axis, but its joint turns it about a horizontal one, as a wheel that rolls:
    a cylinder that is not rotated lies so."""
    own = model.frames[wheel.link.name][:3, :3] @ witness.axis
    is_level = abs(float(model.axes[wheel.joint.name][2])) < _SQUARE
    return witness.is_wheel and is_level and wheel.joint.axis is not None and abs(abs(float(own[2])) - 1) < _SQUARE


def _may_be_drawn_wrong(model: Model, wheel: _SuspectWheel, witness: _AxisEvidence, wheels: Sequence[Joint]) -> bool:
    """Whether a typed axis may be right, and the drawing be the one that was not rotated: no other wheel of the ``wheels`` shows
    that the axle is as it is drawn.

    The axle points to the wheel on the other side; where names show no sides, to some wheel, or outwards as those of all
    others around a base. A joint with a vertical axis turns no wheel that is drawn upright, and a rotation that was forgotten is
    a quarter turn.
    """
    joint = wheel.joint
    frame = model.frames[joint.child]
    axis, own = frame[:3, :3] @ wheel.axis, frame[:3, :3] @ witness.axis
    is_quarter = abs(float(axis @ own)) < LEVEL
    if joint.axis is None or joint.axis_element is None or not is_quarter or abs(float(axis[2])) > _STEEP:
        return False
    sides = {name for names in list_named_pairs(model) if joint.child in names for name in names} - {joint.child}
    others = [other for other in wheels if other is not joint]
    counterparts = [other for other in others if other.child in sides] or others
    ways = [model.frames[other.child][:3, 3] - frame[:3, 3] for other in counterparts]
    lines = [way / length for way in ways if (length := float(np.linalg.norm(way))) > 0.0]
    along_own, along_axis = (any(abs(float(line @ one)) > 1 - LEVEL for line in lines) for one in (own, axis))
    if along_own != along_axis:
        return along_axis
    rolling = [one for one in rolling_wheels(model) if one.joint is not joint]
    return not _find_sign_in_ring(model, joint, own, rolling)


def _measure_offset(witness: _AxisEvidence, axis: Array) -> float:
    """Measure how far the centre of what is drawn is from a unit ``axis`` (3,) through the origin, as a share of its
    radius; 0 for an inertia."""
    if witness.shape is None:
        return 0.0
    centre = witness.shape.centre
    return float(np.linalg.norm(centre - (centre @ axis) * axis)) / witness.shape.radius


def _is_ball(shape: Shape) -> bool:
    """Whether a collision shape is a sphere with its centre at the joint."""
    xyz = shape.origin.xyz
    return shape.kind == "sphere" and xyz is not None and not any(xyz)


def _is_disc_about(balls: Sequence[Shape], wheel: _SuspectWheel) -> bool:
    """Whether a wheel that touches the ground as a ball is drawn as a flat disc of that size, and is not a caster by its name."""
    if NOT_DRIVEN_NAME.search(f"{wheel.joint.name} {wheel.joint.child}"):
        return False
    discs = [one.shape for one in wheel.evidence if one.kind == "visual" and one.is_wheel and one.shape is not None]
    return any(
        disc.width < disc.radius and math.isclose(disc.radius, ball.size[0], rel_tol=_BALL)
        for disc in discs
        for ball in balls
        if ball.size is not None
    )


def _build_witness_finding(
    model: Model, rule: Rule, wheel: _SuspectWheel, witness: _AxisEvidence, *, others: Sequence[str]
) -> Finding:
    """Report evidence that contradicts the joint's axis and the ``others``, if there are any."""
    inertial = None if witness.shape is not None else wheel.link.inertial
    rpy = _find_turning_rpy(model, inertial, wheel, witness, others) if inertial is not None else None
    # A tensor that only its axis makes too large for the wheel is one defect.
    is_cause = inertial is not None and bool(others) and _fits_when_turned(model, wheel, witness.axis)
    solid = _compare_solids(inertial, wheel, witness, others) if inertial is not None else {}
    is_swapped = inertial is not None and bool(others) and not solid
    sharing = [] if rpy is not None or not is_swapped else _list_sharing_links(model, wheel)
    return rule.finding(
        "drawn" if inertial is None else "turned" if rpy else "solid" if solid else "inertia" if others else "unsure",
        at=_locate_handed(rpy, model) if rpy is not None else witness.location,
        severity=Severity.INFO if inertial is not None and _is_negligible(inertial) else None,
        related=[wheel.joint.axis_location],
        edits=edit_numbers(rpy, "0 0 0")
        if rpy is not None
        else _swap_moments(inertial, witness.axis, wheel.axis)
        if inertial is not None and is_swapped and not sharing
        else (),
        repair=_describe_swap(wheel, sharing),
        kind=witness.kind,
        others=" and ".join(others) + (" is" if len(others) == 1 else " are"),
        angle=math.degrees(measure_line_angle(witness.axis, wheel.axis)),
        own=_format_axis(witness.axis),
        # Wheels with the same numbers are merged, and the first one speaks for all.
        explains=[f"INR005 link[{name}]" for name in _list_alike(model, wheel.link)] if is_cause else [],
        **solid,
        **wheel.names,
    )


def _find_turning_rpy(
    model: Model, inertial: Inertial, wheel: _SuspectWheel, witness: _AxisEvidence, others: Sequence[str]
) -> Attribute | None:
    """Return the rotation of an inertial that turns its tensor away from the wheel's axis, which the ``others`` show.

    Not one that a shape of the wheel has too: then the axes are those of the part, and the moments are in the wrong places.
    """
    rpy, pose = inertial.origin.get_attribute("rpy"), inertial.origin.matrix
    if rpy is None or pose is None or not others:
        return None
    shapes = (shape.origin.matrix for shape in (*wheel.link.visuals, *wheel.link.collisions))
    if any(own is not None and np.allclose(own[:3, :3], pose[:3, :3], atol=LEVEL) for own in shapes):
        return None
    is_right = measure_line_angle(pose[:3, :3].T @ witness.axis, wheel.axis) < LEVEL
    is_cause = is_right and measure_line_angle(witness.axis, wheel.axis) >= LEVEL
    return rpy if is_cause and not _suits_other_wheel(model, wheel, pose[:3, :3]) else None


def _suits_other_wheel(model: Model, wheel: _SuspectWheel, rotation: Array) -> bool:
    """Whether another wheel has this ``rotation`` of its inertial (3, 3), and the axis of its joint with it."""
    for joint in model.joints:
        other = model.link_by_name.get(joint.child)
        inertial = None if other is None or joint is wheel.joint else other.inertial
        pose = None if inertial is None else inertial.origin.matrix
        if inertial is None or pose is None or not joint.is_movable or not any(joint.axis or ()):
            continue
        own = _find_inertia_axis(inertial) if np.allclose(pose[:3, :3], rotation, atol=LEVEL) else None
        if own is not None and measure_line_angle(own.axis, np.array(joint.axis)) < LEVEL:
            return True
    return False


def _locate_handed(attribute: Attribute, model: Model) -> Location:
    """Locate what an attribute is given: in the call of a macro that hands it on."""
    handed, own = find_handed_text(attribute, model.source.files), attribute.location
    if handed is None or own.span is None:
        return own
    return Location(own.subject, handed.span, tuple(step for step in (*own.via, own.span) if step != handed.span))


def _list_sharing_links(model: Model, wheel: _SuspectWheel) -> list[str]:
    """List the other links whose moments the same text makes, and of which they are not those of a wheel on this joint's axis."""
    element = None if wheel.link.inertial is None else wheel.link.inertial.tensor_element
    if element is None or element.span is None:
        return []
    axes = {joint.child: np.array(joint.axis or (1.0, 0.0, 0.0)) for joint in model.joints if _is_named_wheel(joint)}
    turned = {name for name, axis in axes.items() if axis.any() and measure_line_angle(axis, wheel.axis) < LEVEL}
    return [
        link.name
        for link in model.links
        if link is not wheel.link
        and link.name not in turned
        and link.inertial is not None
        and link.inertial.tensor_element is not None
        and link.inertial.tensor_element.span == element.span
    ]


def _describe_swap(wheel: _SuspectWheel, sharing: Sequence[str]) -> str:
    """Say how the moments get about the wheel's axis: other links may share the text that makes them."""
    turn, axis = "rotate the `<origin>` of the inertial", _format_axis(wheel.axis)
    if sharing:
        return (
            f"{turn} so that the distinct moment is about {axis}; "
            f"the lines with its moments also give those of {join_names(sharing, 3)}"
        )
    return f"swap the moments of {wheel.joint.child} so that the distinct one is about {axis}, or {turn}"


def _compare_solids(
    inertial: Inertial, wheel: _SuspectWheel, witness: _AxisEvidence, others: Sequence[str]
) -> dict[str, Any]:
    """Describe the moments of a wheel that the ``others`` show as a disc, and that has the inertia of a rod, or the reverse.

    Swapped, they are about the right axis, but remain those of the other solid. Empty where they are the wheel's own.
    """
    drawn = [one.shape for one in wheel.evidence if one.kind in others and one.shape is not None]
    if not drawn or not inertial.mass:
        return {}
    radius, width = drawn[0].radius, drawn[0].width
    if _FLAT * radius < width < _LONG * radius or (width <= _FLAT * radius) == witness.is_wheel:
        return {}
    words = ("a rod along", "a disc about")
    return {
        "own_solid": words[witness.is_wheel],
        "drawn_solid": words[not witness.is_wheel],
        "about": inertial.mass * radius**2 / 2,
        "across": inertial.mass * (3 * radius**2 + width**2) / 12,
    }


def _list_alike(model: Model, link: Link) -> list[str]:
    """List the links with the inertia tensor of this one."""
    own = model.tensor_by_name[link.name].components
    return [declared.link.name for declared in model.tensors if declared.components == own]


def _fits_when_turned(model: Model, wheel: _SuspectWheel, own: Array) -> bool:
    """Whether the mass of a wheel is possible inside its geometry once its ``own`` axis (3,) is that of the joint."""
    try:
        part = next((part for part in enclosed_inertials(model) if part.link is wheel.link), None)
    except FactUnavailableError:
        return False
    if part is None:
        return False
    # Half a turn about the line between the two axes takes one to the other.
    between = own + math.copysign(1.0, float(own @ wheel.axis)) * wheel.axis
    turn = 2.0 * np.outer(between, between) / float(between @ between) - np.eye(3)
    frame = model.piece_frames[wheel.link.name][:3, :3]
    turned = frame @ turn @ frame.T
    covariance = turned @ part.covariance @ turned.T
    return all(
        float(compute_spread_ratios(points, part.com, covariance, _MARGIN * measure_extent(points))[0].max())
        <= _FITTING
        for points in part.readings
    )


def _is_negligible(inertial: Inertial) -> bool:
    """Whether the axis of an inertia tensor makes no difference to a vehicle."""
    if inertial.tensor is None:
        return False
    moments = np.linalg.eigvalsh(inertial.tensor)
    return float(moments[2] - moments[0]) < _NEGLIGIBLE_MOMENT


def _build_axis_finding(
    model: Model, rule: Rule, wheel: _SuspectWheel, *, drawn: _AxisEvidence, limit: float, is_either: bool
) -> Finding:
    """Report a joint axis that all evidence contradicts; ``is_either``: unless the part was drawn without its rotation."""
    joint = wheel.joint
    sign, is_decided = _choose_axis_sign(model, joint, drawn.axis)
    own = drawn.axis * sign
    element = joint.axis_element
    attribute = None if element is None else element.attributes.get("xyz")
    agreeing = [witness.kind for witness in wheel.evidence if measure_line_angle(witness.axis, drawn.axis) <= limit]
    message = "steered" if _is_on_knuckle(model, joint) else "default"
    upward = model.frames[joint.child][2, :3]
    return rule.finding(
        "either" if is_either else message if attribute is None else "axis",
        at=joint.axis_location,
        related=[drawn.location] if is_either else [],
        edits=edit_numbers(attribute, _format_axis(own)) if is_decided and not is_either else [],
        witnesses=" and ".join(agreeing),
        tell="shows" if len(agreeing) == 1 else "show",
        angle=math.degrees(measure_line_angle(drawn.axis, joint.axis or (1.0, 0.0, 0.0))),
        own=_format_axis(own),
        parent=joint.parent,
        up=_format_axis(upward),
        explains=[
            f"SYM004 joint[{name}]" for name in _list_sides(model, joint)
        ],  # that its axis is unlike the other side's
        **wheel.names,
    )


def _is_on_knuckle(model: Model, joint: Joint) -> bool:
    """Whether a wheel hangs on a part that is named as what steers it, and that does not move itself."""
    above = model.tree.parent_joint.get(joint.parent)
    return above is not None and above.type == "fixed" and _KNUCKLE_NAME.search(joint.parent) is not None


def _build_lying_finding(rule: Rule, wheel: _SuspectWheel, *, drawn: Sequence[_AxisEvidence], limit: float) -> Finding:
    """Report a wheel that is drawn lying on its side, on a joint with the axis of a wheel that rolls."""
    alike = [witness for witness in drawn if measure_line_angle(witness.axis, drawn[0].axis) <= limit]
    return rule.finding(
        "lying",
        at=alike[0].location,
        related=[*(one.location for one in alike[1:]), wheel.joint.axis_location],
        kinds=" and ".join(one.kind for one in alike),
        are="is" if len(alike) == 1 else "are",
        angle=math.degrees(measure_line_angle(drawn[0].axis, wheel.axis)),
        own=_format_axis(drawn[0].axis),
        **wheel.names,
    )


def _list_sides(model: Model, joint: Joint) -> list[str]:
    """List a joint and its counterparts on the other side, by name."""
    others = {name for names in list_named_pairs(model) if joint.child in names for name in names}
    return [joint.name, *(model.tree.parent_joint[name].name for name in sorted(others - {joint.child}))]


def _build_upright_finding(
    model: Model, rule: Rule, wheel: _SuspectWheel, *, drawn: _AxisEvidence, others: Sequence[str]
) -> Finding:
    """Report a wheel that is drawn upright on a joint about a vertical axis, about which the ``others`` are round."""
    return rule.finding(
        "upright",
        at=wheel.joint.axis_location,
        related=[drawn.location],
        others=" and ".join(others) + (" is" if len(others) == 1 else " are"),
        turned=" and ".join(others),
        angle=math.degrees(measure_line_angle(drawn.axis, wheel.axis)),
        own=_format_axis(drawn.axis * _choose_axis_sign(model, wheel.joint, drawn.axis)[0]),
        **wheel.names,
    )


def _collect_evidence(model: Model, link: Link) -> list[_AxisEvidence]:
    witnesses = [
        _find_drawn_axis(model, "visual", link.visuals),
        _find_drawn_axis(model, "collision", link.collisions),
        None if link.inertial is None else _find_inertia_axis(link.inertial),
    ]
    return [witness for witness in witnesses if witness is not None]


def _find_drawn_axis(model: Model, kind: str, shapes: Sequence[Shape]) -> _AxisEvidence | None:
    """Return the axis of revolution of the largest shape about which all shapes are round."""
    points = collect_shape_corners(model, shapes)
    if points is None or not len(points):
        return None
    sized = []
    for shape in shapes:
        axis, own = _compute_shape_axis(model, shape), collect_shape_corners(model, [shape])
        if axis is not None and own is not None:
            sized.append((float(np.ptp(own, axis=0).max()), shape, axis))
    for _, shape, axis in sorted(sized, key=lambda one: -one[0]):
        outline = measure_outline(points, axis)
        if outline.is_round():
            near = float(np.linalg.norm(outline.centre)) <= 2 * outline.radius
            return _AxisEvidence(
                kind=kind,
                axis=axis,
                location=shape.location,
                is_wheel=near and outline.width <= 4 * outline.radius,
                shape=outline,
            )
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


def _find_inertia_axis(inertial: Inertial) -> _AxisEvidence | None:
    """Return the axis of revolution of the mass, or None if it has none or a body cannot have its tensor."""
    tensor, mass = inertial.tensor_in_link, inertial.mass
    if tensor is None or mass is None or not mass > 0:
        return None
    report = check_inertia_validity(tensor)
    if not (report.positive_definite and report.triangle_inequality):
        return None
    axis = find_revolution_axis(compute_mass_covariance(tensor, mass))
    if axis is None:
        return None
    # The largest moment of a disc is that about its axis.
    flat = float(axis @ tensor @ axis) > 0.99 * report.moments[2]
    return _AxisEvidence(kind="inertia", axis=axis, location=inertial.location, is_wheel=flat)


def _swap_moments(inertial: Inertial, own: Array, axis: Array) -> list[Edit]:
    """Return the edits that exchange the moments about two axes of the frame, if that repairs the tensor."""
    element, components, pose = inertial.tensor_element, inertial.inertia_components, inertial.origin.matrix
    places = [int(np.abs(one).argmax()) for one in (own, axis)]
    if element is None or components is None or pose is None or not np.array_equal(pose[:3, :3], np.eye(3)):
        return []
    straight = all(1 - abs(float(one[place])) < _SQUARE**2 for one, place in zip((own, axis), places, strict=True))
    if not straight or any(components[i] != 0 for i in (1, 2, 4)):
        return []
    one, other = (element.attributes[("ixx", "iyy", "izz")[place]] for place in places)
    return swap_values(one, other)


def _choose_axis_sign(model: Model, joint: Joint, axis: Array) -> tuple[float, bool]:
    """Return the sign that turns an axis of the joint's child to where those of the other wheels point.

    Also whether these, or the sign of the one number that was typed, decide it.

    Wheels around a base point outwards, or all inwards. Where left and right differ, those on the joint's side count. Without
    such wheels the axis is turned to the robot's left, or along +x or +z if it is nearer to that.
    """
    frame = model.frames[joint.child]
    rotated = frame[:3, :3] @ axis
    others = [w for w in rolling_wheels(model) if w.joint is not joint]
    if ring := _find_sign_in_ring(model, joint, rotated, others):
        return ring, True
    parallel = [w for w in others if measure_line_angle(w.axis, rotated) < LEVEL]
    beside = [w for w in parallel if _is_on_one_side(model, joint, w.joint, rotated, parallel)]
    for group in (parallel, beside):
        signs = {math.copysign(1.0, float(wheel.axis @ rotated)) for wheel in group}
        if len(signs) == 1:
            sign = signs.pop()
            # The wheels of the other side only may point the other way.
            return sign, bool(beside) or len(group) > 1 or _is_typed_with(joint, sign * axis)
    sign = math.copysign(1.0, float(rotated[int(np.abs(rotated).argmax())]))
    return sign, _is_typed_with(joint, sign * axis)


def _find_sign_in_ring(model: Model, joint: Joint, rotated: Array, others: Sequence[Wheel]) -> float | None:
    """Return the sign that turns an axis (3,), in root coordinates, outwards or inwards like those of all other wheels around a
    base; None where they do not stand around one."""
    if len(others) < _RING - 1:
        return None
    places = np.array([model.frames[one.child][:3, 3] for one in (joint, *(wheel.joint for wheel in others))])
    spokes = places - places.mean(axis=0)
    spokes /= np.maximum(np.linalg.norm(spokes, axis=1), 1e-12)[:, None]
    along = [float(spoke @ axis) for spoke, axis in zip(spokes, (rotated, *(w.axis for w in others)), strict=True)]
    signs = {math.copysign(1.0, one) for one in along[1:]}
    if len(signs) > 1 or min(map(abs, along)) < 1 - LEVEL:
        return None
    return signs.pop() * math.copysign(1.0, along[0])


def _is_typed_with(joint: Joint, axis: Array) -> bool:
    """Whether the axis of a joint is along a coordinate, and its one number has the sign of that of another ``axis`` (3,).

    Then the number is in another place only.
    """
    typed = np.array(joint.axis or (0.0, 0.0, 0.0))
    return (
        int(np.count_nonzero(np.abs(typed) > _SQUARE)) == 1
        and float(typed.sum()) * float(axis[int(np.abs(axis).argmax())]) > 0.0
    )


def _is_on_one_side(model: Model, one: Joint, other: Joint, across: Array, wheels: Sequence[Wheel]) -> bool:
    """Whether two of the wheels are on one side of their middle, along a direction (3,) in root coordinates."""
    middle = float(np.mean([model.frames[wheel.joint.child][:3, 3] @ across for wheel in wheels]))
    first, second = (float(model.frames[joint.child][:3, 3] @ across) - middle for joint in (one, other))
    return first * second > 0


def _format_axis(axis: Array) -> str:
    largest = int(np.abs(axis).argmax())
    if 1 - abs(float(axis[largest])) < _SQUARE**2:
        axis = np.sign(axis) * (np.arange(3) == largest)
    return format_point(axis, decimals=6)
