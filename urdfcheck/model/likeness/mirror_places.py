"""Joints that are not where, or not directed as, the other side or the other limbs put them: what to say, and the edit."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import Edit, Location
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import format_point, join_names, split_name_words
from urdfcheck.model.likeness.mirror_pairs import PLACE, MirrorPair
from urdfcheck.model.likeness.mirrored_joints import TURNING, MisplacedJoint, find_misplaced_joint
from urdfcheck.model.likeness.odd_limbs import OddNumbers, iter_odd_numbers
from urdfcheck.model.likeness.origin_slips import (
    OddSign,
    OriginSlip,
    find_origin_slips,
    iter_coincident_twins,
    iter_diagonal_twins,
    iter_odd_signs,
)
from urdfcheck.model.likeness.sides.lone_attributes import LoneAttribute, iter_lone_attributes
from urdfcheck.model.likeness.sides.lone_coordinates import iter_lone_coordinates
from urdfcheck.model.likeness.sides.lone_turns import LoneTurn, iter_lone_turns
from urdfcheck.model.likeness.sides.measured_joints import are_measured
from urdfcheck.model.likeness.sides.opposed_axes import OpposedAxes, iter_opposed_axes
from urdfcheck.model.likeness.sides.settled_places import is_drawn_nearer, is_settled
from urdfcheck.model.likeness.sides.two_pairs import may_be_two_pairs
from urdfcheck.model.parts import Joint
from urdfcheck.model.repairs.edits import change_numbers, describe_remedy, edit_all_numbers
from urdfcheck.model.repairs.origin_edits import locate_origin_attribute
from urdfcheck.model.repairs.rpy_text import format_angle
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# Messages that are about the directions of axes alone.
_OF_AXES = frozenset({"axis", "opposed", "steering", "together", "crosswise", "reversed"})
# Those that are about angles alone.
_OF_ANGLES = frozenset({"turned", "turned_pair"})
# Metres within which two exports of one assembly differ in several coordinates, each by this share of the distance (chosen).
_MINOR, _NOTABLE = 5e-3, 0.2
# Less than both (m, and a share of the distance between the two joints) is nothing that a robot or a controller feels (chosen).
_UNFELT, _UNFELT_SHARE = 2e-3, 4e-3
# A place is off along an axis where it is off by no more than this share in other directions, and an axis is across a line that
# has this share of its length across the axis (chosen).
_SIDEWAYS, _ACROSS = 0.05, 0.95
# Cosine of the angle between axes of one plane: 1°.
_PARALLEL = 1 - 1.5e-4
# Parts whose frames are where their makers say: the lens of a camera, not its middle.
_SENSOR_WORDS = frozenset(
    {
        *(
            "camera",
            "cam",
            "lens",
            "stereo",
            "sensor",
            "imu",
            "lidar",
            "laser",
            "sonar",
            "ultrasound",
            "ultrasonic",
            "radar",
        ),
        *("optical", "depth", "rgb", "infra1", "infra2", "tof", "gps", "antenna", "microphone"),
    }
)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PlaceMistake:
    """A joint in another place or direction than its counterparts show, as a message of SYM004."""

    message: str
    joints: tuple[Joint, ...]
    """The joints that it concerns, each of which has one mistake at most."""
    at: Location
    related: tuple[Location, ...]
    data: Mapping[str, Any]
    edits: tuple[Edit, ...] = ()
    cause: str | None = None
    is_minor: bool = False
    """Whether it is little, and no single number is the mistake: two exports of one assembly differ so."""

    @property
    def is_unmoved(self) -> bool:
        """Whether it is in the axes of joints whose limits leave no room. Not where these are left out: most simulators read no
        limits then."""
        is_of_axes = self.message in _OF_AXES or self.data.get("what") == "axis"
        return is_of_axes and not any(joint.has_room or _lacks_limits(joint) for joint in self.joints)

    @property
    def is_freed_by_mujoco(self) -> bool:
        """Whether MuJoCo moves one of the joints whose limits leave no room: it ignores limits that are equal (JNT005)."""
        return not all(joint.is_held for joint in self.joints if joint.is_movable)


def iter_place_mistakes(model: Model, pairs: Sequence[MirrorPair]) -> Iterator[PlaceMistake]:
    """Yield the mistakes in places and directions of joints, one for each joint: those with the closest evidence first.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    reported: set[str] = set()
    for mistake in _iter_all_mistakes(model, pairs):
        links = {joint.child for joint in mistake.joints}
        if not links & reported and not are_measured(mistake.joints, is_of_angles=mistake.message in _OF_ANGLES):
            reported |= links
            yield mistake


def _lacks_limits(joint: Joint) -> bool:
    """Whether a ``<limit>`` has neither end of the range (JNT004)."""
    return joint.is_movable and joint.limit is not None and joint.limit.attributes.keys().isdisjoint({"lower", "upper"})


def _iter_all_mistakes(model: Model, pairs: Sequence[MirrorPair]) -> Iterator[PlaceMistake]:
    for sign in iter_odd_signs(model):
        yield _describe_odd_sign(model, sign)
    for odd in iter_odd_numbers(model):
        if odd.attribute != "xyz" or not is_settled(model, [odd.joint.child], pairs):
            yield _describe_odd_numbers(model, odd)
    for slip in find_origin_slips(model):
        if not is_settled(model, [slip.joint.child, slip.twin.child], pairs):
            yield _describe_slip(slip)
    for one, other in iter_coincident_twins(model):
        yield _describe_coincidence(one, other)
    for one, other, like in iter_diagonal_twins(model):
        yield _describe_diagonal(one, other, like)
    yield from map(_describe_opposed_axes, iter_opposed_axes(model, pairs))
    yield from map(_describe_lone_turn, iter_lone_turns(model, pairs))
    for pair in pairs:
        off = find_misplaced_joint(model, pair, pairs)
        if off is not None and not (
            off.distance
            and (
                is_settled(model, [pair.one, pair.other], pairs) or is_drawn_nearer(model, pair, distance=off.distance)
            )
        ):
            yield _describe_misplaced_joint(model, off)
    yield from map(_describe_slip, iter_lone_coordinates(model))
    yield from map(_describe_lone_attribute, iter_lone_attributes(model))


def _describe_misplaced_joint(model: Model, off: MisplacedJoint) -> PlaceMistake:
    both = off.joint, off.twin
    data: dict[str, Any] = {"joint": off.joint.name, "twin": off.twin.name, "between": _list_subjects(both)}
    if off.distance:
        at, related = (locate_origin_attribute(joint, "xyz") for joint in both)
        back, there = off.places
        first, second = _describe_move(off.joint, off.twin, there), _describe_move(off.twin, off.joint, back)
        if off.carries_mirrored:
            # What it carries must stay where it is.
            first, second = (f"{move} and move what it carries back by as much" for move in (first, second))
        data |= {"distance": off.distance * 1e3, "first": first, "second": second}
        away = np.abs(np.array(off.joint.origin.xyz or (0.0, 0.0, 0.0)) - there)
        if _is_stacked(model, off, away=np.array(off.joint.origin.xyz or (0.0, 0.0, 0.0)) - there):
            return PlaceMistake(message="stacked", joints=both, at=at, related=(related,), data=data, is_minor=True)
        apart = float(np.linalg.norm(np.subtract(*(model.frames[joint.child][:3, 3] for joint in both))))
        is_of_several = int((away > _NOTABLE * off.distance).sum()) > 1
        is_minor = off.distance < _MINOR and (is_of_several or off.distance < min(_UNFELT, _UNFELT_SHARE * apart))
        return PlaceMistake(message="origin", joints=both, at=at, related=(related,), data=data, is_minor=is_minor)
    at, related = (locate_origin_attribute(joint, "rpy") if off.turned else joint.axis_location for joint in both)
    data["angle"] = math.degrees(off.angle)
    return PlaceMistake(message="axis", joints=both, at=at, related=(related,), data=data)


def _is_stacked(model: Model, off: MisplacedJoint, *, away: Array) -> bool:
    """Whether two hinges on one link are apart along their axes, which are across the line between them, and so are the axes of
    all joints that they carry: then the limbs move in two planes, and may lie one over the other. ``away`` (3,): of the first
    joint, from the other's mirror image."""
    joint, twin = off.joint, off.twin
    matrices = joint.origin.matrix, twin.origin.matrix
    if joint.parent != twin.parent or joint.type not in TURNING or matrices[0] is None or matrices[1] is None:
        return False
    axis = matrices[0][:3, :3] @ np.array(joint.axis or (1.0, 0.0, 0.0))
    axis /= max(float(np.linalg.norm(axis)), 1e-300)
    between = matrices[0][:3, 3] - matrices[1][:3, 3]
    across = between - axis * float(axis @ between)
    is_along = float(np.linalg.norm(away - axis * float(axis @ away))) < _SIDEWAYS * float(np.linalg.norm(away))
    if not all(_carries_parallel_axes(model, one) for one in (joint, twin)):
        return False  # legs and steered wheels stand on the ground
    return is_along and float(np.linalg.norm(across)) > _ACROSS * float(np.linalg.norm(between))


def _carries_parallel_axes(model: Model, joint: Joint) -> bool:
    """Whether a joint carries others that move, and the axes of all of them are parallel to its own."""
    behind = [one for one in model.joints if one.is_movable and joint in model.tree.find_path_to(one.parent)]
    axes = [model.axes[one.name] for one in (joint, *behind) if one.name in model.axes]
    return bool(behind) and all(abs(float(axis @ axes[0])) > _PARALLEL for axis in axes)


def _describe_lone_turn(turn: LoneTurn) -> PlaceMistake:
    both = turn.joint, turn.twin
    at, related = (locate_origin_attribute(joint, "rpy") for joint in both)
    change, other = (
        change_numbers(joint.origin.get_attribute("rpy"), "rpy", " ".join(format_angle(a, xacro=False) for a in angles))
        for joint, angles in ((turn.joint, turn.expected), (turn.twin, turn.twin_expected))
    )
    shared = at.span == related.span
    first, second = (
        describe_remedy([one], here.name, there.name, shared=shared, twin_attributes=[twin.attribute])
        for one, twin, here, there in ((change, other, *both), (other, change, *both[::-1]))
    )
    return PlaceMistake(
        message="turned" if turn.is_decided else "turned_pair",
        joints=both,
        at=at,
        related=(related,),
        edits=tuple(edit_all_numbers([(change.attribute, change.text)])) if turn.is_decided and not shared else (),
        data={
            "joint": turn.joint.name,
            "twin": turn.twin.name,
            "angle": math.degrees(turn.angle),
            "first": first,
            "second": second,
            "between": _list_subjects(both),
        },
    )


def _describe_slip(slip: OriginSlip) -> PlaceMistake:
    joint, twin = slip.joint, slip.twin
    at, related = (locate_origin_attribute(one, "xyz") for one in (joint, twin))
    attribute = joint.origin.get_attribute("xyz")
    data = {
        "joint": joint.name,
        "twin": twin.name,
        "parent": joint.parent,
        "typed": "0 0 0" if attribute is None else attribute.value,
        "expected": format_point(slip.expected, decimals=6),
        "distance": float(np.linalg.norm(np.array(joint.origin.xyz or (0, 0, 0)) - slip.expected)) * 1e3,
        "repair": _describe_repair(slip),
        "between": _list_subjects((joint, twin)),
    }
    cause = None if slip.kind == "coordinate" else slip.kind
    return PlaceMistake(message="slip", joints=(joint, twin), at=at, related=(related,), cause=cause, data=data)


def _describe_repair(slip: OriginSlip) -> str:
    """Say which numbers the two joints have if one of them is correct; not where the two would then coincide."""
    joint, twin = slip.joint, slip.twin
    places = [np.array(one.origin.xyz or (0.0, 0.0, 0.0)) for one in (joint, twin)]
    if joint.parent == twin.parent and float(np.abs(places[1] - slip.expected).max()) <= PLACE:
        axis = "xyz"[int(np.abs(places[0] - slip.expected).argmax())]
        return f"make the two opposite across the middle, and not in {axis}: mirrored as they are, both would be in one place"
    moves = _describe_move(joint, twin, slip.expected), _describe_move(twin, joint, slip.twin_expected)
    return f"if {twin.name} is correct, {moves[0]}; if {joint.name} is correct, {moves[1]}"


def _describe_lone_attribute(lone: LoneAttribute) -> PlaceMistake:
    both, name = (lone.joint, lone.twin), lone.attribute
    at, related = (joint.axis_location if name == "axis" else locate_origin_attribute(joint, name) for joint in both)
    numbers = [
        (joint.axis if name == "axis" else joint.origin.rpy if name == "rpy" else joint.origin.xyz) or (0.0, 0.0, 0.0)
        for joint in both
    ]
    typed, expected = (format_point(three, decimals=6) for three in numbers)
    data = {
        "joint": lone.joint.name,
        "twin": lone.twin.name,
        "what": "axis" if name == "axis" else f"origin's {name}",
        "typed": typed,
        "expected": expected,
        "others": "The other pair agrees" if lone.witnesses == 1 else f"The {lone.witnesses} other pairs agree",
        "between": _list_subjects(both),
    }
    if lone.joint.is_movable and name != "xyz":
        return PlaceMistake(message="lone", joints=both, at=at, related=(related,), data=data)
    off = np.abs(np.abs(numbers[0]) - np.abs(numbers[1]))
    is_place = name == "xyz"
    data["off"] = f"{1e3 * float(np.linalg.norm(off)):.3g} mm" if is_place else f"{math.degrees(off.max()):.3g}°"
    data["rest"] = "angles" if is_place else "places"
    # The two cameras of a stereo pair have one lens each as their origin, both left or both right.
    words = {word.lower() for joint in both for name in (joint.name, joint.child) for word in split_name_words(name)}
    is_of_sensor = is_place and not words.isdisjoint(_SENSOR_WORDS)
    return PlaceMistake(
        message="sensor" if is_of_sensor else "lone_place",
        joints=both,
        at=at,
        related=(related,),
        data=data,
        is_minor=is_of_sensor,
    )


def _describe_odd_sign(model: Model, odd: OddSign) -> PlaceMistake:
    joint, like = odd.joint, odd.others[0]
    places = [one.axis_location if odd.is_axis else locate_origin_attribute(one, "xyz") for one in (joint, *odd.others)]
    attributes = [
        (None if one.axis_element is None else one.axis_element.attributes.get("xyz"))
        if odd.is_axis
        else one.origin.get_attribute("xyz")
        for one in (joint, like)
    ]
    typed, expected = ("" if attribute is None else attribute.value for attribute in attributes)
    is_open = odd.is_axis and may_be_two_pairs(model, joint, odd.others, "axis")
    repair = f"write {expected} in the axis of {joint.name}"
    data = {
        "joint": joint.name,
        "twin": like.name,
        "like": join_names(one.name for one in odd.others),
        "typed": typed,
        "expected": expected,
        "repair": _leave_open(repair, "axis") if is_open else repair,
    }
    edits = edit_all_numbers([(attributes[0], expected)]) if attributes[0] is not None and expected else []
    if is_open:
        edits = []
    return PlaceMistake(
        message="reversed" if odd.is_axis else "sign",
        joints=(joint,),
        at=places[0],
        related=tuple(places[1:]),
        edits=tuple(edits),
        data=data,
    )


def _describe_odd_numbers(model: Model, odd: OddNumbers) -> PlaceMistake:
    joint, is_axis = odd.joint, odd.attribute == "axis"
    places = [
        one.axis_location if is_axis else locate_origin_attribute(one, odd.attribute) for one in (joint, *odd.others)
    ]
    attribute, like = (
        (None if one.axis_element is None else one.axis_element.attributes.get("xyz"))
        if is_axis
        else one.origin.get_attribute(odd.attribute)
        for one in (joint, odd.others[0])
    )
    words = format_point(odd.expected, decimals=6).split() if like is None or odd.kind != "odd" else like.value.split()
    if odd.attribute == "xyz":
        signs = ["-" if value < 0 else "" for value in odd.expected.tolist()]
        words = [sign + word.lstrip("+-") for sign, word in zip(signs, words, strict=True)]
    expected, what = " ".join(words), "axis" if is_axis else f"origin's {odd.attribute}"
    repair, edits = f"write {expected} in the {what} of {joint.name}", list[Edit]()
    if not joint.is_movable:
        # A part is bolted where there is room for it.
        repair = f"if {joint.name} is meant to be placed like the others, {repair}; otherwise say so in a comment"
    elif odd.kind == "odd" and odd.attribute != "xyz" and may_be_two_pairs(model, joint, odd.others, odd.attribute):
        repair = _leave_open(repair, what)
    elif attribute is not None and not _may_be_in_degrees(odd):
        edits = edit_all_numbers([(attribute, expected)])
    data = {
        "joint": joint.name,
        "repair": repair,
        "count": len(odd.others),
        "like": join_names(one.name for one in odd.others),
        "what": what,
        "typed": "1 0 0" if attribute is None and is_axis else "0 0 0" if attribute is None else attribute.value,
        "expected": expected,
    }
    return PlaceMistake(
        message=odd.kind,
        joints=(joint,),
        at=places[0],
        related=tuple(places[1:]),
        edits=tuple(edits),
        data=data,
    )


def _leave_open(repair: str, what: str) -> str:
    """Return the repair of one of four joints that are two mirrored pairs or four of a kind."""
    return f"if the four are meant to have one {what}, {repair}; if they are two mirrored pairs, correct one of the other three"


def _may_be_in_degrees(odd: OddNumbers) -> bool:
    """Whether an angle is beyond a turn: JNT012 knows the unit, and the angles of the others may not be its own."""
    return odd.attribute == "rpy" and max(map(abs, odd.joint.origin.rpy or (0.0,))) > math.tau


def _describe_opposed_axes(found: OpposedAxes) -> PlaceMistake:
    both = found.joint, found.twin
    data = {
        "joint": found.joint.name,
        "twin": found.twin.name,
        "one": found.joint.child,
        "other": found.twin.child,
        "like": join_names(joint.name for joint in found.others),
        "between": _list_subjects(both),
    }
    at, related = (joint.axis_location for joint in both)
    return PlaceMistake(message=found.kind, joints=both, at=at, related=(related,), data=data)


def _describe_coincidence(one: Joint, other: Joint) -> PlaceMistake:
    at, related = (locate_origin_attribute(joint, "xyz") for joint in (one, other))
    attribute = one.origin.get_attribute("xyz")
    data = {
        "joint": one.name,
        "twin": other.name,
        "one": one.child,
        "other": other.child,
        "parent": one.parent,
        "typed": "" if attribute is None else attribute.value,
        "between": _list_subjects((one, other)),
    }
    axes = [np.array(joint.axis or (1.0, 0.0, 0.0)) for joint in (one, other)]
    if one.type == "prismatic" and float(axes[0] @ axes[1]) < 0.0:
        # Neither is a leftover: the two slide apart.
        data["repair"] = (
            "if the two touch at zero, draw each on its own side of that plane; otherwise move their joints apart"
        )
        return PlaceMistake(
            message="coincident", joints=(one, other), at=at, related=(related,), data=data, is_minor=True
        )
    x, y, _ = one.origin.xyz or (0.0, 0.0, 0.0)
    signs = join_names(
        [
            f"{axis} for {sides}"
            for axis, value, sides in (("y", y, "left and right"), ("x", x, "front and rear"))
            if value
        ]
    )
    move = f"flip the sign in which they should differ: {signs}" if signs else "move one of them to its place"
    data["repair"] = f"delete one of the two if it is a leftover; else {move}"
    return PlaceMistake(message="coincident", joints=(one, other), at=at, related=(related,), data=data)


def _describe_diagonal(one: Joint, other: Joint, others: Sequence[Joint]) -> PlaceMistake:
    (at, typed), (related, like) = (
        (locate_origin_attribute(joint, "xyz"), format_point(joint.origin.xyz or (0.0, 0.0, 0.0), decimals=6))
        for joint in (other, one)
    )
    signs = [a * b < 0 for a, b in zip(one.origin.xyz or (), other.origin.xyz or (), strict=True)]
    data = {
        "joint": other.name,
        "twin": one.name,
        "parent": one.parent,
        "typed": typed,
        "like": like,
        "axes": join_names(letter for letter, differs in zip("xyz", signs, strict=True) if differs),
        "others": " and ".join(joint.name for joint in others),
        "between": _list_subjects((one, other)),
    }
    message = "diagonal_turned" if others else "diagonal"
    return PlaceMistake(message=message, joints=(other, one), at=at, related=(related,), data=data)


def _describe_move(joint: Joint, twin: Joint, place: Array) -> str:
    """Return the instruction that moves a joint to another position (3,) in the frame of its parent."""
    text = format_point(place, decimals=6)
    attributes = [one.origin.get_attribute("xyz") for one in (joint, twin)]
    shared = attributes[0] is not None and attributes[1] is not None and attributes[0].span == attributes[1].span
    change = change_numbers(attributes[0], "xyz", text)
    return describe_remedy([change], joint.name, twin.name, shared=shared, twin_attributes=attributes[1:])


def _list_subjects(joints: Sequence[Joint]) -> list[str]:
    """Return the subjects of both sides: a stronger rule that reports either supersedes this one."""
    return [joint.location.subject for joint in joints]
