"""Slips in the origin or the axis of a joint that its twins show: a sign, or a decimal point."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.likeness.mirror import measure_deviation, measure_outline_mismatch
from urdfcheck.model.fact import fact
from urdfcheck.model.likeness.declared_inertials import read_declared_inertial, turn_inertial
from urdfcheck.model.likeness.mirror_pairs import PLACE, MirrorPair, list_named_pairs, mirror_pairs
from urdfcheck.model.likeness.mirrored_joints import (
    WITNESSES,
    are_children_mirrored,
    are_parents_mirrored,
    measure_axis_offset,
)
from urdfcheck.model.likeness.shape_comparison import ALIKE, DIFFERENT, compute_centroid, get_outline, is_alike
from urdfcheck.model.likeness.side_names import remove_places
from urdfcheck.model.parts import Joint
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# Numbers agree within this share of the origin's length, three typed digits, and within a careful hand measurement.
_SAME = 0.005
# A coordinate that is smaller than this share of the origin's length, or than so many metres, has a sign by rounding.
_LEAST_SHARE, _LEAST = 0.05, 2e-3
# Drawings that are so many times nearer to mirror images than the frames of their joints show where the parts are (chosen).
_NEARER = 5.0
# Two parts whose centroids are nearer than this share of their radius are inside each other.
_INSIDE = 0.5
# So many limbs have one joint each before one of them can be the odd one: of three, one may be the middle.
_MOST_OF = 4
_POWERS = (10.0, 100.0, 1000.0)
# Axes of frames are parallel within this (1 - cosine, as an element of the rotation).
_PARALLEL = 2e-3


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class OriginSlip:
    """A joint whose origin is that of its twin's mirror image, apart from one slip."""

    joint: Joint
    twin: Joint
    kind: str
    """``sign``: one coordinate has the other sign. ``decimal``: a coordinate, or all, are a power of ten larger. ``coordinate``:
    one coordinate is another one."""
    expected: Array
    """(3,) in m: the origin of ``joint`` if ``twin`` is right."""
    twin_expected: Array
    """(3,) in m: the origin of ``twin`` if ``joint`` is right."""


@dataclass(frozen=True, slots=True, eq=False)
class OddSign:
    """A joint whose origin or axis differs from those of the other limbs in a sign only."""

    joint: Joint
    others: tuple[Joint, ...]
    is_axis: bool


@fact
def find_origin_slips(model: Model) -> tuple[OriginSlip, ...]:
    """Find the slips in origins of left and right joints whose parents are in their places, those nearest to the root first.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    pairs = mirror_pairs(model)
    found = (_find_slip(model, pair, pairs) or _find_slip_to_other_side(model, pair, pairs) for pair in pairs)
    return tuple(slip for slip in found if slip is not None)


def _find_slip(model: Model, pair: MirrorPair, known_pairs: Sequence[MirrorPair]) -> OriginSlip | None:
    joints = find_carrying_joints(model, pair)
    if joints is None or not pair.is_named:
        return None
    one, other = joints
    places = [np.array(joint.origin.xyz or (0.0, 0.0, 0.0)) for joint in joints]
    is_same = np.abs(places[0] - places[1]).max() <= _LEAST
    # A fixed sensor may be mounted alike on mirrored parts.
    is_next_mirrored = is_same and one.is_movable and _are_next_mirrored(model, pair, known_pairs)
    may_be_same = not one.is_movable or not (are_parents_mirrored(joints, known_pairs) or is_next_mirrored)
    if is_same and one.parent != other.parent and may_be_same:
        return None  # one module on both sides
    images = [_compute_image(model, pair, joint, twin) for joint, twin in ((one, other), (other, one))]
    for index in (1, 0):
        kind = _name_slip(places[index], images[index])
        if kind is None or not _has_witnesses(
            model, pair, known_pairs, 1 if is_same or kind == "decimal" else WITNESSES
        ):
            continue
        may_be_turned = pair.drawn_as != "mirrored" and not is_next_mirrored
        if kind == "sign" and may_be_turned and _is_placed_by_turn(model, pair, joints):
            continue  # a part that is rotated by half a turn may be placed by half a turn as well
        if kind == "sign" and _is_across_own_part(model, joints, index, images[index]):
            continue  # a camera that is mounted on its side has its left and right lens one above the other
        if pair.is_in_place or are_children_mirrored(model, pair, known_pairs):
            continue  # one joint takes back what another one adds: the correction would displace all that follows
        if pair.uses_shift and measure_axis_offset(model, pair) <= PLACE:
            continue  # the frame is at another point of the joint's axis: what it draws is mirrored
        return OriginSlip(
            joint=joints[index],
            twin=joints[1 - index],
            kind=kind,
            expected=images[index],
            twin_expected=images[1 - index],
        )
    return None


def _find_slip_to_other_side(model: Model, pair: MirrorPair, known_pairs: Sequence[MirrorPair]) -> OriginSlip | None:
    """Find the sign that puts a joint in the place of its twin on one link, beside the plane of all limbs but these two."""
    joints = find_carrying_joints(model, pair)
    if joints is None or not pair.is_named or joints[0].parent != joints[1].parent or not joints[0].is_movable:
        return None
    places = [np.array(joint.origin.xyz or (0.0, 0.0, 0.0)) for joint in joints]
    if float(np.abs(places[0] - places[1]).max()) > PLACE:
        return None
    others = [
        known
        for known in known_pairs
        if known.is_named and known.is_in_place and not known.is_attached_to(pair) and not pair.is_attached_to(known)
        and abs(float(known.plane.normal @ pair.plane.normal)) > 1 - _PARALLEL
        and abs(known.plane.offset - pair.plane.offset) > PLACE
    ]  # fmt: skip
    planes = [known.plane for known in others]
    if len(planes) < WITNESSES or any(abs(plane.offset - planes[0].offset) > PLACE for plane in planes):
        return None
    parent = model.frames[joints[0].parent]
    image = planes[0].reflect_points(model.frames[pair.one][:3, 3]) - parent[:3, 3]
    expected: Array = parent[:3, :3].T @ image
    if _name_slip(places[1], expected) != "sign":
        return None
    return OriginSlip(joint=joints[1], twin=joints[0], kind="sign", expected=expected, twin_expected=expected)


def find_carrying_joints(model: Model, pair: MirrorPair) -> tuple[Joint, Joint] | None:
    """Return the joints on which the links of a pair hang; None where their types differ."""
    one, other = (model.tree.parent_joint.get(name) for name in (pair.one, pair.other))
    if one is None or other is None or one.type != other.type:
        return None
    return one, other


def _has_witnesses(model: Model, pair: MirrorPair, known_pairs: Sequence[MirrorPair], least: int) -> bool:
    """Whether so many other pairs with a parallel plane have joints whose origins are mirror images."""
    count = 0
    for known in known_pairs:
        joints = find_carrying_joints(model, known)
        parallel = abs(float(known.plane.normal @ pair.plane.normal)) > 1 - _PARALLEL
        if known is pair or joints is None or not known.is_named or not parallel:
            continue
        place = np.array(joints[1].origin.xyz or (0.0, 0.0, 0.0))
        length = float(np.linalg.norm(place))
        image = _compute_image(model, known, joints[1], joints[0])
        count += length > _LEAST and np.abs(place - image).max() <= min(PLACE, _SAME * length)
    return count >= least


def _are_next_mirrored(model: Model, pair: MirrorPair, known_pairs: Sequence[MirrorPair]) -> bool:
    """Whether the joints next behind a pair, and those before it, are mirror images with other signs than each other's: then no
    module is on both sides."""
    both = {pair.one, pair.other}
    before = model.tree.parent_joint
    next_pairs = [known for known in known_pairs if {before[known.one].parent, before[known.other].parent} == both]
    above = [known for known in known_pairs if {known.one, known.other} == {before[name].parent for name in both}]
    return bool(above) and any(_is_mirrored_by_sign(model, known) for known in next_pairs)


def _is_mirrored_by_sign(model: Model, pair: MirrorPair) -> bool:
    """Whether the origins of a pair's joints are mirror images in their parents, and differ in a sign."""
    joints = find_carrying_joints(model, pair)
    if joints is None or not pair.is_named:
        return False
    places = [np.array(joint.origin.xyz or (0.0, 0.0, 0.0)) for joint in joints]
    is_image = float(np.abs(places[1] - _compute_image(model, pair, joints[1], joints[0])).max()) <= PLACE
    return is_image and float(np.abs(places[0] - places[1]).max()) > _LEAST


def _is_placed_by_turn(model: Model, pair: MirrorPair, joints: tuple[Joint, Joint]) -> bool:
    """Whether the rotation that takes the frame of one link of a pair to that of the other takes its place on its parent there,
    too: the part is rotated to the other side, not mirrored."""
    one, other = (model.frames[name][:3, :3] for name in (pair.one, pair.other))
    arms = [model.frames[joint.parent][:3, :3] @ (joint.origin.xyz or (0.0, 0.0, 0.0)) for joint in joints]
    is_turned = bool(np.abs(one - other).max() > _PARALLEL)
    return is_turned and bool(np.abs(other @ one.T @ arms[0] - arms[1]).max() < PLACE)


def _is_across_own_part(model: Model, joints: tuple[Joint, Joint], index: int, image: Array) -> bool:
    """Whether two joints on one link, both in the robot's middle plane, are mirror images of each other in a frame of their part
    that is rotated in the robot: along y of their link or of what both carry, which is to the left by convention, or, of fixed
    parts, along any coordinate of a link whose axes are not those of the robot. ``image`` (3,): of the other joint, where this
    one (``index``) should be."""
    places = [np.array(joint.origin.xyz or (0.0, 0.0, 0.0)) for joint in joints]
    if joints[0].parent != joints[1].parent or float(np.abs(places[1 - index] - image).max()) > PLACE:
        return False
    frames = [model.frames[name][:3, :3] for name in (joints[0].parent, joints[0].child, joints[1].child)]
    between = frames[0] @ (places[0] - places[1])
    left = [abs(float(frame[:, 1] @ between)) > (1 - _PARALLEL) * float(np.linalg.norm(between)) for frame in frames]
    is_turned = bool(np.abs(frames[0] - model.frames[model.tree.root][:3, :3]).max() > _PARALLEL)
    return left[0] or (left[1] and left[2]) or (is_turned and not joints[0].is_movable)


def _compute_image(model: Model, pair: MirrorPair, joint: Joint, twin: Joint) -> Array:
    """Compute the origin (3,) of a joint in its parent's frame if it is the mirror image of its twin.

    On two parents the images of the parents' places count, so that a child is where it should be on a displaced parent.
    """
    parent = model.frames[joint.parent]
    place = model.frames[twin.child][:3, 3]
    if joint.parent == twin.parent:
        away = pair.plane.reflect_points(place) - parent[:3, 3]
    else:
        away = pair.plane.linear @ (place - model.frames[twin.parent][:3, 3])
    image: Array = parent[:3, :3].T @ away
    return image


def _name_slip(typed: Array, expected: Array) -> str | None:
    """Name the slip that makes ``typed`` (3,) of ``expected``; None if there is no such slip."""
    length = float(np.linalg.norm(expected))
    near = min(PLACE, _SAME * length)
    least = _LEAST_SHARE * length
    off = np.abs(typed - expected) > near
    largest = float(np.abs(expected[off]).max(initial=0.0))
    if int(off.sum()) == 1 and largest > max(least, _LEAST) and abs(typed[off][0] + expected[off][0]) <= near:
        return "sign"
    for power in _POWERS:
        slipped = np.where(off, expected * power, expected)
        if largest > least and power * largest > _LEAST and np.abs(typed - slipped).max() <= power * near:
            return "decimal"
    return None


def iter_coincident_twins(model: Model) -> Iterator[tuple[Joint, Joint]]:
    """Yield wheels and the like in one place, away from the frame of the link on which both hang.

    On continuous joints their links' names differ in places (left, front) or numbers only. The jaws of scissors share a hinge,
    which has limits. What slides or is fixed is a left and a right part.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    tree, frames = model.tree, model.frames
    groups: dict[object, list[Joint]] = {}
    for name in tree.order[1:]:
        joint = tree.parent_joint[name]
        if joint.type == "continuous" and joint.mimic is None and _is_away(joint):
            groups.setdefault((joint.parent, _strip_place(name)), []).append(joint)
    pairs = [pair for group in groups.values() for pair in combinations(group, 2)]
    for one, other in (*pairs, *_list_still_pairs(model)):
        apart = frames[one.child] - frames[other.child]
        if np.abs(apart[:3, 3]).max() < 1e-6 and _is_one_body(model, one.child, other.child):
            yield one, other


def _list_still_pairs(model: Model) -> Iterator[tuple[Joint, Joint]]:
    """List the left and right joints on one link that are fixed, or that slide from where they are at zero.

    Parts whose frames are at one place may be drawn, and have their COMs, on both sides of it: where what they draw is not known,
    their COMs are away from the frames.
    """
    for names in list_named_pairs(model):
        one, other = (model.tree.parent_joint.get(name) for name in names)
        if one is None or other is None or (one.parent, one.type) != (other.parent, other.type) or not _is_away(one):
            continue
        is_known = get_outline(model, one.child) is not None
        bodies = [read_declared_inertial(model.link_by_name[name]) for name in names]
        is_known |= all(body is not None and bool(np.abs(body.com).max() > _LEAST) for body in bodies)
        if is_known and (one.type == "fixed" or (one.type == "prismatic" and all(map(_reaches_zero, (one, other))))):
            yield one, other


def _is_away(joint: Joint) -> bool:
    """Whether a joint is not at the frame of its parent."""
    return joint.origin.xyz is not None and max(map(abs, joint.origin.xyz)) > _LEAST


def _reaches_zero(joint: Joint) -> bool:
    lower, upper = joint.get_limit_value("lower") or 0.0, joint.get_limit_value("upper") or 0.0
    return lower <= 0.0 <= upper


def iter_diagonal_twins(model: Model) -> Iterator[tuple[Joint, Joint, tuple[Joint, ...]]]:
    """Yield left and right joints on one link whose origins differ in the signs of two coordinates, and in nothing else.

    A mirror flips one coordinate, and half a turn flips two and turns the frame: so the frames are parallel, or turned like those
    of another pair which flips one. The joints of that pair come third. Where the drawing is turned or moved in its frame
    instead, both are in place.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    pairs = []
    for names in list_named_pairs(model):
        one, other = (model.tree.parent_joint.get(name) for name in names)
        if one is None or other is None or not one.is_movable or (one.parent, one.type) != (other.parent, other.type):
            continue
        first, second = (np.array(joint.origin.xyz or (0.0, 0.0, 0.0)) for joint in (one, other))
        flipped = (np.abs(first) > _LEAST) & (first * second < 0.0)
        if bool(np.abs(np.abs(first) - np.abs(second)).max() <= PLACE):
            turn = model.frames[one.child][:3, :3].T @ model.frames[other.child][:3, :3]
            pairs.append((one, other, int(flipped.sum()), turn))
    for one, other, count, turn in pairs:
        is_parallel = np.abs(turn - np.eye(3)).max() < _PARALLEL
        shown = () if is_parallel else next((known[:2] for known in pairs if _shows_turn(known, one, turn)), ())
        if count != 2 or not (is_parallel or shown) or _are_drawn_mirrored(model, one, other):
            continue
        if not _are_drawn_half_turned(model, one, other):
            yield one, other, shown


def _are_drawn_mirrored(model: Model, one: Joint, other: Joint) -> bool:
    """Whether what the links of two joints draw is far nearer to mirror images, about a plane through the frame of their parent,
    than the joints are, whose origins differ in the signs of two coordinates: the meshes are placed otherwise in their frames."""
    one_place, other_place = compute_centroid(model, one.child), compute_centroid(model, other.child)
    if one_place is None or other_place is None:
        return False
    parent, first, second = (
        model.frames[one.parent],
        *(np.array(joint.origin.xyz or (0.0, 0.0, 0.0)) for joint in (one, other)),
    )
    near, far = ((place - parent[:3, 3]) @ parent[:3, :3] for place in (one_place, other_place))
    for axis in np.flatnonzero(first * second < 0.0):
        flip = np.ones(3)
        flip[axis] = -1.0
        drawn, off = (float(np.linalg.norm(flip * here - there)) for here, there in ((near, far), (first, second)))
        if _NEARER * drawn <= off:
            return True
    return False


def _are_drawn_half_turned(model: Model, one: Joint, other: Joint) -> bool:
    """Whether the links of two joints, whose origins differ in the signs of two coordinates, draw one part in two poses, half a
    turn apart, and not mirrored in one of the two. Where the drawings are not known, their inertials show it.

    A part that half a turn leaves as it is fits too: two such parts side by side have half a turn between them. So have two
    slides that pass each other, even where a mirror leaves the part as it is.
    """
    frames = one.origin.matrix, other.origin.matrix
    if frames[0] is None or frames[1] is None:
        return False
    signs = np.sign(np.array(one.origin.xyz or (0.0, 0.0, 0.0)) * np.array(other.origin.xyz or (0.0, 0.0, 0.0)))
    flipped = np.flatnonzero(signs < 0.0)
    mismatches = []
    for axes in ([*flipped], [flipped[0]], [flipped[1]], []):
        flip = np.eye(3)
        flip[axes, axes] = -1.0
        mismatches.append(_measure_mismatch(model, one, other, frames[1][:3, :3].T @ flip @ frames[0][:3, :3]))
    turned, *mirrored, same = mismatches
    if turned > ALIKE or ALIKE < same <= DIFFERENT:
        return False
    return min(mirrored) > DIFFERENT or (same <= ALIKE and _pass_each_other(one, other, [*flipped]))


def _pass_each_other(one: Joint, other: Joint, flipped: Sequence[int]) -> bool:
    """Whether two slides move along one of two coordinates of their parent, and are apart in the other."""
    along = set()
    for joint in (one, other):
        frame = joint.origin.matrix
        if joint.type != "prismatic" or joint.axis is None or frame is None:
            return False
        direction = np.abs(frame[:3, :3] @ joint.axis)
        if not direction.max() > (1 - _PARALLEL) * float(np.linalg.norm(direction)):
            return False
        along.add(int(direction.argmax()))
    return len(along) == 1 and along <= set(flipped)


def _measure_mismatch(model: Model, one: Joint, other: Joint, linear: Array) -> float:
    """Measure how far the child of one joint, turned or mirrored in its frame, is from that of the other; infinite where
    that is not known."""
    first, second = (get_outline(model, joint.child) for joint in (one, other))
    if first is not None and second is not None:
        return measure_outline_mismatch(first, second, linear=linear, shift=np.zeros(3))
    numbers = [read_declared_inertial(model.link_by_name[joint.child]) for joint in (one, other)]
    if numbers[0] is None or numbers[1] is None:
        return math.inf
    return measure_deviation(numbers[1], turn_inertial(numbers[0], linear, com=linear @ numbers[0].com)).worst


def _shows_turn(pair: tuple[Joint, Joint, int, Array], joint: Joint, turn: Array) -> bool:
    """Whether a pair of the same limbs on the same link is turned alike, and has one coordinate with another sign."""
    one, _, count, known = pair
    is_like = (one.parent, one.type, _strip_place(one.child)) == (joint.parent, joint.type, _strip_place(joint.child))
    return is_like and count == 1 and bool(np.abs(known - turn).max() < _PARALLEL)


def _strip_place(name: str) -> tuple[str, ...]:
    """Return the words of a name without places and numbers."""
    return tuple(word for word in remove_places(name) if not word.isdigit())


def _is_one_body(model: Model, one: str, other: str) -> bool:
    """Whether two links have one mass and draw one part, one inside the other.

    Where what they draw is not known, their frames and COMs have to be the same, and the places of what they draw.
    """
    bodies = [read_declared_inertial(model.link_by_name[name]) for name in (one, other)]
    masses = [body.mass for body in bodies if body is not None]
    if len(masses) != 2 or abs(masses[0] - masses[1]) > _SAME * abs(masses[0]):
        return False
    first, second = (get_outline(model, name) for name in (one, other))
    if first is None or second is None:
        coms = [np.round(body.com, 6).tolist() for body in bodies if body is not None]
        same = np.allclose(model.frames[one], model.frames[other], rtol=0, atol=1e-6)
        drawn = [[shape.origin.placement for shape in model.link_by_name[name].visuals] for name in (one, other)]
        return first is second and bool(same) and coms[0] == coms[1] and drawn[0] == drawn[1]
    centres = compute_centroid(model, one), compute_centroid(model, other)
    assert centres[0] is not None
    assert centres[1] is not None
    size = float(np.sqrt(np.trace(first.covariance)))
    return bool(is_alike(model, one, other)) and float(np.linalg.norm(centres[0] - centres[1])) < _INSIDE * size


def iter_odd_signs(model: Model) -> Iterator[OddSign]:
    """Yield joints of which one number has another sign than that of three and more joints which are otherwise the same.

    Names differ in places only (``FL_knee``, ``HR_knee``). Limbs that are mirrored have two and two.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    groups: dict[object, list[Joint]] = {}
    for name in model.tree.order[1:]:
        joint = model.tree.parent_joint[name]
        if joint.is_movable and joint.mimic is None:
            words = remove_places(name)
            groups.setdefault((joint.type, words), []).append(joint)
            kind = tuple(word for word in words if not word.isdigit())
            groups.setdefault((joint.type, kind, joint.parent), []).append(joint)
    for group in groups.values():
        if len(group) < _MOST_OF:
            continue
        origins = [np.array(joint.origin.xyz or (0.0, 0.0, 0.0)) for joint in group]
        index = _find_odd(origins)
        # Two and two become three and one by a slip of one of the three: it is then in one place with another.
        is_shared = len({(joint.parent, *np.round(xyz, 6)) for joint, xyz in zip(group, origins, strict=True)}) < len(
            group
        )
        if (
            index is not None
            and not is_shared
            and _name_slip(origins[index], origins[index - 1]) == "sign"
            and not is_taken_back(model, group[index], group[index - 1], by_sign=True)
        ):
            pair = next(
                (p for p in mirror_pairs(model) if p.is_in_place and group[index].child in {p.one, p.other}), None
            )
            others = (*group[:index], *group[index + 1 :])
            if pair is None and not is_of_other_kind(group[index], others):
                yield OddSign(group[index], others, False)
            elif pair is not None:
                yield from _find_unmirrored(model, group, index, pair)
        axes = [np.array(joint.axis or (0.0, 0.0, 0.0)) for joint in group]
        index = _find_odd(axes)
        if index is not None and _is_reversed(model, group, index, axes):
            others = (*group[:index], *group[index + 1 :])
            if not is_of_other_kind(group[index], others):
                yield OddSign(group[index], others, True)


def is_of_other_kind(joint: Joint, others: Sequence[Joint]) -> bool:
    """Whether a joint is another thing than those like it: a text makes several of these and not this one, such as a macro for
    another finger, or it hangs on another kind of link than they do."""
    texts = [other.element.span for other in others]
    if joint.element.span not in texts and len(set(texts)) < len(texts):
        return True
    parents = {_strip_place(other.parent) for other in others}
    return len(parents) == 1 and _strip_place(joint.parent) not in parents


def _find_unmirrored(model: Model, group: Sequence[Joint], index: int, pair: MirrorPair) -> Iterator[OddSign]:
    """Yield the joint that made three and one of two and two: the only one with a parent on the side of the odd one, which is the
    mirror image of its twin in a ``pair``."""
    odd = group[index]

    def is_left(joint: Joint) -> bool:
        return float(pair.plane.normal @ model.frames[joint.parent][:3, 3]) > pair.plane.offset

    beside = [joint for joint in group if joint is not odd and is_left(joint) == is_left(odd)]
    if len(beside) == 1 and len(group) == _MOST_OF:
        turned = np.abs(model.frames[odd.parent][:3, :3] - model.frames[beside[0].parent][:3, :3]).max()
        if turned < _PARALLEL and beside[0].child not in {pair.one, pair.other}:
            yield OddSign(beside[0], (odd,), False)


def is_taken_back(model: Model, odd: Joint, like: Joint, *, by_sign: bool = False) -> bool:
    """Whether an origin that differs from that of another limb moves nothing.

    What the joint carries is where it is on the other limb, or the joint itself takes back what the one before it adds: distances
    along the axes of a common parent agree. Or the frame is elsewhere on its axis, and what it draws is not. ``by_sign``: the
    origins differ in signs, so that these have to agree there.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    behind = [
        _measure_distances(model, joint.parent, [one.child for one in model.tree.child_joints[joint.child]])
        for joint in (odd, like)
    ]
    if by_sign:
        differ = np.abs(np.array(odd.origin.xyz or (0, 0, 0)) - np.array(like.origin.xyz or (0, 0, 0))) > PLACE
        signed = [
            [
                (np.linalg.inv(model.frames[joint.parent]) @ model.frames[one.child])[:3, 3][differ]
                for one in model.tree.child_joints[joint.child]
            ]
            for joint in (odd, like)
        ]
        return _agree(*behind) and bool(np.abs(np.array(signed[0]) - np.array(signed[1])).max(initial=0.0) <= PLACE)
    before = [model.tree.parent_joint.get(joint.parent) for joint in (odd, like)]
    if _agree(*behind) or _is_drawn_in_place(model, odd, like):
        return True
    if before[0] is None or before[1] is None or before[0].parent == odd.parent:
        return False
    place = [
        _measure_distances(model, one.parent, [joint.child])
        for one, joint in zip(before, (odd, like), strict=True)
        if one
    ]
    return _agree(*place)


def _is_drawn_in_place(model: Model, odd: Joint, like: Joint) -> bool:
    """Whether two joints differ along their axes only, where a frame may be anywhere, and what they draw is as far from their
    parents along each axis."""
    if not {odd.name, like.name} <= model.axes.keys():
        return False
    distances, places = [], []
    for joint in (odd, like):
        home = np.linalg.inv(model.frames[joint.parent])
        centroid = compute_centroid(model, joint.child)
        if centroid is None:
            return False
        axis = np.abs(home[:3, :3] @ model.axes[joint.name])
        places.append(np.abs(joint.origin.xyz or (0, 0, 0)) * (1.0 - axis))
        distances.append(np.abs(home[:3, :3] @ centroid + home[:3, 3]))
    return bool(max(np.abs(one - other).max() for one, other in (places, distances)) <= PLACE)


def _measure_distances(model: Model, home: str, names: Sequence[str]) -> Array:
    """Measure the distances (n, 3) of links from another one along its axes."""
    inverse = np.linalg.inv(model.frames[home])
    return np.array([np.abs((inverse @ model.frames[name])[:3, 3]) for name in names]).reshape(-1, 3)


def _agree(one: Array, other: Array) -> bool:
    return bool(len(one)) and len(one) == len(other) and bool(np.abs(one - other).max() <= PLACE)


def _find_odd(values: Sequence[Array]) -> int | None:
    """Return the index of the only one of some vectors (3,) that differs from the others, which are the same."""
    for index, value in enumerate(values):
        others = [other for i, other in enumerate(values) if i != index]
        near = _SAME * float(np.linalg.norm(others[0]))
        if all(np.abs(other - others[0]).max() <= near for other in others):
            return index if np.abs(value - others[0]).max() > near else None
    return None


def _is_reversed(model: Model, group: Sequence[Joint], index: int, axes: Sequence[Array]) -> bool:
    """Whether the axis of one joint is that of the others with the other sign, as typed and in root coordinates, and its limits
    are theirs."""
    odd, like = group[index], group[index - 1]
    if np.abs(axes[index] + axes[index - 1]).max() > _PARALLEL or odd.type == "continuous":
        return False
    if any(odd.get_limit_value(name) != like.get_limit_value(name) for name in ("lower", "upper")):
        return False
    opposite = [
        float(model.axes[odd.name] @ model.axes[joint.name]) < _PARALLEL - 1 for joint in group if joint is not odd
    ]
    if all(opposite):
        return True
    # Frames of two sides that are rotated have axes of two directions: then those with the frame of this one count.
    alike = [
        is_opposite
        for joint, is_opposite in zip((joint for joint in group if joint is not odd), opposite, strict=True)
        if joint.parent == odd.parent and joint.origin.rpy == odd.origin.rpy
    ]
    return bool(alike) and all(alike) and len({joint.parent for joint in group}) == 1
