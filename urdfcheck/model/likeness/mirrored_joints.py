"""The joints of both sides of a pair, compared in root coordinates: limits, place and axis."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.likeness.mirror import mirror_range
from urdfcheck.model.likeness.mirror_pairs import MirrorPair, list_alike_links_elsewhere
from urdfcheck.model.parts import Joint
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# This many like joints elsewhere that agree with one side, and none with the other, decide which one is wrong.
VOTES = 2
# Angles that 1.57 for π/2 leaves add up to 0.2°; beyond 10° the joint is arranged otherwise.
STRAIGHT, ARRANGED = math.radians(0.25), math.radians(10)
# What exporters leave of a zero in an axis is less (chosen): rounding noise of 1e-16 is usual.
_NOISE = 1e-9
# A tilt that the next joints take back is reported from here on.
_SLIGHT_TILT = math.radians(1)
# A joint is out of place beyond a careful hand measurement, and arranged otherwise beyond this share of the sides' distance.
PLACE, APART = 1e-3, 0.25
# A millimetre of a robot of three metres; in a larger one, or one in another unit, as small a share of its size.
_PLACE_SHARE = 3e-4
# Coordinates (m) that were typed alike.
_EXACT = 1e-9
# Axes are each other's negative within this, in each coordinate.
_NEGATIVE = 2e-3
# A range of one side is that of the other in degrees to within this share: three typed digits.
_IN_DEGREES = 0.01
# Limits that were typed alike agree to within the digits of a conversion.
_DIGITS = 1e-6
# Ranges of two sides are about the same within this share of them (chosen).
_NEARLY = 0.05
# From so many pairs of twins on, limits of which most differ in digits were measured on the machine.
_MEASURED_PAIRS = 4
# A joint that is out of place by a turn of its parent is as far from the parent's axis as its twin, to the digits (m) of a CAD
# program; or, where both have the same coordinates in their parents, to this share of its displacement.
_TURNED_EXACTLY, _TURNED_SHARE = 5e-6, 0.05
TURNING = frozenset({"revolute", "continuous"})
# Pairs that must agree about the plane before a joint can be out of its place.
WITNESSES = 2


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MismatchedLimit:
    """A joint whose ``<limit>`` is not what that of its twin says it should be."""

    pair: MirrorPair
    joint: Joint
    twin: Joint
    expected: Mapping[str, float]
    """What it should be, by attribute."""
    copied: bool
    """Whether it has the twin's range as it is."""
    agreeing_joints: tuple[str, ...]
    """Joints elsewhere that have the twin's limits, when enough do and none has this joint's."""
    is_axis_negated: bool
    """Whether it has about the twin's range as it is, and as its axis the negative of the twin's: one of the two is too much."""
    is_about_normal: bool
    """Whether both axes are along the normal of the mirror plane, and the limits are those of the twin with their signs changed:
    they would fit axes in the plane."""

    @property
    def max_difference(self) -> float:
        """The greatest difference: of the range relative to its length, of effort and velocity to the greater one."""
        found = {name: value for name in self.expected if (value := self.joint.get_limit_value(name)) is not None}
        bounds = [*_get_bounds(self.joint), *_get_bounds(self.twin)]
        length = max(bounds[1] - bounds[0], bounds[3] - bounds[2])
        return max(
            abs(value - self.expected[name])
            / (length if name in {"lower", "upper"} else max(value, self.expected[name]))
            for name, value in found.items()
        )


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MisplacedJoint:
    """A joint that is not where, or not directed as, the mirror image of its twin is."""

    joint: Joint
    twin: Joint
    distance: float
    """Metres from there; 0 where only the direction is wrong."""
    angle: float
    """Radians between its axis and the image; 0 where the place is wrong."""
    turned: bool
    """Whether its frame is turned, and not the axis in it."""
    places: tuple[Array, Array]
    """(3,) each: where the first and the second joint would be in their parents' frames if the other one is right."""
    carries_mirrored: bool
    """Whether what both joints carry is in mirrored places already, so that it must not move with them."""


def find_pair_joints(model: Model, pair: MirrorPair) -> tuple[Joint, Joint] | None:
    """Return the joints that move the two links, when both are of one type and neither follows another joint."""
    one, other = (model.tree.parent_joint.get(name) for name in (pair.one, pair.other))
    if one is None or other is None or one.type != other.type or not one.has_axis:
        return None
    if one.mimic is not None or other.mimic is not None or not {one.name, other.name} <= model.axes.keys():
        return None
    return one, other


def find_leading_link(model: Model, pair: MirrorPair) -> str | None:
    """Return the link of a pair whose joint that of the other link follows (``<mimic>``): one drive moves both."""
    one, other = (model.tree.parent_joint.get(name) for name in (pair.one, pair.other))
    for leader, joint in ((one, other), (other, one)):
        mimic = None if joint is None else joint.mimic
        if leader is not None and mimic is not None and mimic.get("joint") == leader.name:
            return leader.child
    return None


def find_spin_axis(model: Model, pair: MirrorPair, link: str) -> Array | None:
    """Return the unit axis (3,), in the frame of a ``link`` of the pair, about which its joint turns without limits, as the other
    link's does: which angle is zero is then of no consequence. None where either is held or limited."""
    joints = find_pair_joints(model, pair)
    if joints is None or joints[0].type != "continuous":
        return None
    axis: Array = model.frames[link][:3, :3].T @ model.axes[model.tree.parent_joint[link].name]
    return axis


def are_moved_apart(model: Model, pair: MirrorPair) -> bool:
    """Whether a joint moves one link of a pair without the other: otherwise both are parts of one body.

    :raises FactUnavailableError: when the tree is broken.
    """
    one, other = (
        {joint.name for joint in model.tree.find_path_to(name) if joint.is_movable} for name in (pair.one, pair.other)
    )
    return one != other


def find_mismatched_limit(
    model: Model, pair: MirrorPair, known_pairs: Sequence[MirrorPair], threshold: float
) -> MismatchedLimit | None:
    """Find the joint of a pair whose limits are not those of the other's mirror image; the second where nothing decides."""
    joints = find_pair_joints(model, pair)
    if joints is None or joints[0].limit is None or joints[1].limit is None:
        return None
    if len({joint.get_limit_value("effort") == 0.0 for joint in joints}) > 1:
        return None  # one is driven, and the other one follows it
    if not _compute_expected_limit(model, pair, known_pairs, joints=joints, threshold=threshold):
        return None
    like = [_list_agreeing_joints(model, pair, joint) for joint in joints]
    first_is_wrong = not like[0] and len(like[1]) >= VOTES
    decided = first_is_wrong or (not like[1] and len(like[0]) >= VOTES)
    twin, joint = joints[::-1] if first_is_wrong else joints
    expected = _compute_expected_limit(model, pair, known_pairs, joints=(twin, joint), threshold=threshold)
    is_range = bool({"lower", "upper"} & expected.keys())
    copied = is_range and _get_bounds(twin) == _get_bounds(joint)
    # A symmetric range is its own negative.
    negated = is_range and _is_negated(_get_bounds(twin), _get_bounds(joint))
    return MismatchedLimit(
        pair=pair,
        joint=joint,
        twin=twin,
        expected=expected,
        copied=copied,
        is_axis_negated=is_range and _is_nearly_copied(twin, joint) and _has_negated_axis(model, joints),
        agreeing_joints=like[first_is_wrong] if decided else (),
        is_about_normal=negated and _is_about_normal(model, pair, twin),
    )


def _is_nearly_copied(one: Joint, other: Joint) -> bool:
    """Whether two ranges are the same apart from what sides of one robot differ in."""
    (a, b), (c, d) = _get_bounds(one), _get_bounds(other)
    return max(abs(a - c), abs(b - d)) <= _NEARLY * max(b - a, d - c)


def _is_about_normal(model: Model, pair: MirrorPair, joint: Joint) -> bool:
    """Whether a joint turns about the normal of a pair's mirror plane."""
    across = abs(float(pair.plane.normal @ model.axes[joint.name]))
    return joint.type == "revolute" and across > math.cos(STRAIGHT)


def _is_negated(one: tuple[float, float], other: tuple[float, float]) -> bool:
    """Whether one range is the other with its signs changed, digit for digit."""
    return max(abs(one[0] + other[1]), abs(one[1] + other[0])) <= _DIGITS * (one[1] - one[0])


def are_limits_measured(model: Model, pairs: Sequence[MirrorPair]) -> bool:
    """Whether the ranges of most twins differ in their digits: each joint's limits were measured, not designed.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    alike = differ = 0
    for pair in pairs:
        joints = find_pair_joints(model, pair)
        if joints is None or not all(a < b for a, b in map(_get_bounds, joints)):
            continue
        if _compute_expected_range(model, pair, pairs, joints=joints, threshold=_DIGITS):
            differ += 1
        elif pair.drawn_as in {"mirrored", "both"}:
            alike += 1
    return differ >= _MEASURED_PAIRS and differ > alike


def group_by_chain(mismatches: Iterable[MismatchedLimit]) -> list[list[MismatchedLimit]]:
    """Group wrong limits by chain: those of joints that hang on each other."""
    chains: list[list[MismatchedLimit]] = []
    for mismatch in mismatches:
        chain = next((other for other in chains if mismatch.pair.is_attached_to(other[0].pair)), None)
        if chain is None:
            chains.append([mismatch])
        else:
            chain.append(mismatch)
    return chains


def is_shifted(model: Model, chain: Sequence[MismatchedLimit], threshold: float) -> bool:
    """Whether most joints of one side have the limits of the joint before their twin."""

    def count_agreeing(ones: Iterable[tuple[Joint, Joint]]) -> int:
        earlier = [(joint, _find_previous_joint(model, twin)) for joint, twin in ones]
        return sum(b is not None and _has_same_limits(a, b, threshold) for a, b in earlier)

    both = [(one.joint, one.twin) for one in chain]
    return max(count_agreeing(both), count_agreeing((twin, joint) for joint, twin in both)) > len(chain) / 2


def find_misplaced_joint(model: Model, pair: MirrorPair, known_pairs: Sequence[MirrorPair]) -> MisplacedJoint | None:
    """Find the second joint of a pair where it is out of the place, or the direction, of the mirror image.

    All joints before it have to be in theirs.
    """
    joints = find_pair_joints(model, pair)
    if joints is None or pair.agreeing_pairs < WITNESSES or not pair.is_named:
        return None
    if pair.drawn_as == "copied" or (pair.drawn_as == "neither" and not pair.is_alike):
        return None
    one, other = joints
    if _is_at_one_place(joints) and not _is_renamed(pair, joints):
        return None
    image, axis = pair.plane.linear @ model.axes[one.name], model.axes[other.name]
    angle = math.atan2(float(np.linalg.norm(np.cross(image, axis))), abs(float(image @ axis)))
    carries_mirrored = are_children_mirrored(model, pair, known_pairs)
    if pair.uses_shift or pair.drawn_as is None or carries_mirrored:
        distance = measure_axis_offset(model, pair)
    else:
        distance = float(np.linalg.norm(pair.shift))
    if _is_typed_mirrored(model, pair, joints):
        distance = 0.0
    sides = float(np.linalg.norm(model.frames[pair.one][:3, 3] - model.frames[pair.other][:3, 3]))
    places = np.array([frame[:3, 3] for frame in model.frames.values()])
    least = max(PLACE, _PLACE_SHARE * float(np.linalg.norm(np.ptp(places, axis=0))))
    displaced_by = distance if least < distance < APART * sides else 0.0
    if displaced_by and (
        _is_turned_with_parent(model, pair, joints, distance=displaced_by)
        or _is_mirrored_in_parents(joints, known_pairs, least)
    ):
        return None
    is_slip = STRAIGHT < angle < ARRANGED or (angle > ARRANGED and _is_renamed(pair, joints))
    if is_slip and angle < _SLIGHT_TILT and _is_turn_taken_back(pair, known_pairs):
        is_slip = False
    if is_slip and _is_turned_by_swivel(model, other, image):
        is_slip = False
    tilted_by = angle if distance <= PLACE and is_slip else 0.0
    above = (p for p in known_pairs if p is not pair and pair.is_attached_to(p))
    if not (displaced_by or tilted_by) or not all(_is_mirrored_in_pose(p) for p in above):
        return None
    return MisplacedJoint(
        joint=other,
        twin=one,
        distance=displaced_by,
        angle=tilted_by,
        turned=not _is_axis_aligned(pair.linear),
        places=(
            _compute_image_place(model, pair, joint=one, source=pair.other),
            _compute_image_place(model, pair, joint=other, source=pair.one),
        ),
        carries_mirrored=carries_mirrored,
    )


def _is_turned_with_parent(model: Model, pair: MirrorPair, joints: tuple[Joint, Joint], *, distance: float) -> bool:
    """Whether the second joint of a pair is where it should be apart from a turn about the axis of the joint before it: then the
    zero of that joint differs, and the place in the part may be right. ``distance``: of the two places, m."""
    before = [one for one in model.tree.find_path_to(joints[1].parent) if one.is_movable]
    if not before or before[-1].type not in TURNING or before[-1].name not in model.axes:
        return False
    axis, center = model.axes[before[-1].name], model.frames[before[-1].child][:3, 3]
    image = pair.plane.reflect_points(model.frames[pair.one][:3, 3])
    arms = [place - center for place in (model.frames[pair.other][:3, 3], image)]
    along = [float(arm @ axis) for arm in arms]
    radii = [float(np.linalg.norm(arm - part * axis)) for arm, part in zip(arms, along, strict=True)]
    slack = _TURNED_SHARE * distance if _is_typed_alike(joints) else _TURNED_EXACTLY
    return math.hypot(along[0] - along[1], radii[0] - radii[1]) < slack


def _is_turned_by_swivel(model: Model, joint: Joint, image: Array) -> bool:
    """Whether a joint's axis is turned away from where it should be about a swivel before it that turns without limits, as that
    of a caster: which of its angles is zero is then of no consequence. ``image``: the unit axis (3,) as it should be."""
    before = [one for one in model.tree.find_path_to(joint.parent) if one.is_movable]
    if not before or before[-1].type != "continuous" or before[-1].name not in model.axes:
        return False
    swivel = model.axes[before[-1].name]
    along = [abs(float(axis @ swivel)) for axis in (image, model.axes[joint.name])]
    return abs(along[0] - along[1]) < math.sin(STRAIGHT)


def _is_mirrored_in_parents(joints: tuple[Joint, Joint], known_pairs: Sequence[MirrorPair], least: float) -> bool:
    """Whether the places are mirror images, to ``least`` m, in the frames of two parents of which one is rotated as little as
    3.14 for π leaves: at the end of a lever that is a distance, but the mistake is in the angle."""
    one, other = (joint.origin.xyz for joint in joints)
    parents = tuple(joint.parent for joint in joints)
    above = next((p for p in known_pairs if parents in {(p.one, p.other), (p.other, p.one)}), None)
    if one is None or other is None or above is None:
        return False
    if parents != (above.one, above.other):
        one, other = other, one
    straight = np.rint(above.linear)
    # The norm of the difference of two rotations is √8 times the sine of half their angle.
    angle = 2 * math.asin(min(1.0, float(np.linalg.norm(above.linear - straight)) / math.sqrt(8)))
    return angle < STRAIGHT and float(np.linalg.norm(straight @ one + above.shift - other)) < least


def _is_typed_alike(joints: tuple[Joint, Joint]) -> bool:
    """Whether both origins have the same coordinates apart from signs: then the joints are in one place of their parents."""
    one, other = (joint.origin.xyz for joint in joints)
    return one is not None and other is not None and bool(np.abs(np.abs(one) - np.abs(other)).max() < _EXACT)


def measure_axis_offset(model: Model, pair: MirrorPair) -> float:
    """Measure how far (m) the joints of a pair are from mirror images, where the second one turns without the part along its
    axis: where on its axis a joint's frame lies is a choice.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    shift, joint = model.frames[pair.other][:3, :3] @ pair.shift, model.tree.parent_joint.get(pair.other)
    if joint is not None and joint.type in TURNING and joint.name in model.axes:
        axis = model.axes[joint.name]
        shift = shift - axis * float(shift @ axis)
    return float(np.linalg.norm(shift))


def are_children_mirrored(model: Model, pair: MirrorPair, known_pairs: Sequence[MirrorPair]) -> bool:
    """Whether the next pairs behind a pair are mirror images in place: they take back any offset of the pair's own frames.

    Frames in which nothing is drawn move with the part, and count only if there are no others.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    below = [known for known in known_pairs if known is not pair and known.is_attached_to(pair)]
    nearest = _list_nearest(below)
    # An offset along parallel axes is a choice in each of them, but only a frame that is in place takes it back.
    in_place = any(one.is_in_place for one in below)
    drawn = [one for one in nearest if one.drawn_as is not None] or nearest
    return in_place and all(measure_axis_offset(model, one) <= PLACE for one in drawn)


def are_parents_mirrored(joints: tuple[Joint, Joint], known_pairs: Sequence[MirrorPair]) -> bool:
    """Whether the links on which two joints hang are drawn as mirror images: then the joints' places on them are, too."""
    parents = {joint.parent for joint in joints}
    return any(known.drawn_as == "mirrored" and {known.one, known.other} == parents for known in known_pairs)


def _has_negated_axis(model: Model, joints: tuple[Joint, Joint]) -> bool:
    """Whether the axes are each other's negative, as typed and in root coordinates. Those of two modules are typed alike."""
    typed = [np.array(joint.axis or (1.0, 0.0, 0.0)) for joint in joints]
    in_root = [model.axes[joint.name] for joint in joints]
    return all(bool(np.abs(one + other).max() < _NEGATIVE) for one, other in (typed, in_root))


def _is_turn_taken_back(pair: MirrorPair, known_pairs: Sequence[MirrorPair]) -> bool:
    """Whether the frames of a pair are rotated relative to each other, and the next pairs behind it turn back.

    Two angles that were typed to fit each other, as those of a CAD assembly, are not a slip.
    """
    below = [known for known in known_pairs if known is not pair and known.is_attached_to(pair)]
    nearest = _list_nearest(below)
    is_back = all(_is_axis_aligned(one.linear) and one.is_in_place for one in nearest)
    return bool(nearest) and is_back and not _is_axis_aligned(pair.linear)


def _list_nearest(below: Sequence[MirrorPair]) -> list[MirrorPair]:
    """Return those of some pairs that hang on no other of them."""
    return [one for one in below if not any(one is not other and one.is_attached_to(other) for other in below)]


def _is_renamed(pair: MirrorPair, joints: tuple[Joint, Joint]) -> bool:
    """Whether the frames are mirror images apart from the choice of axes, and both axes are along coordinates of them, but not
    along the same one."""
    if joints[0].type == "continuous" or not _is_axis_aligned(pair.linear):
        return False
    one, other = (np.array(joint.axis or (1.0, 0.0, 0.0)) for joint in joints)
    single = all(int(np.count_nonzero(np.abs(axis) > _NOISE)) == 1 for axis in (one, other))
    return single and int(np.abs(pair.linear @ one).argmax()) != int(np.abs(other).argmax())


def _compute_expected_limit(
    model: Model,
    pair: MirrorPair,
    known_pairs: Sequence[MirrorPair],
    *,
    joints: tuple[Joint, Joint],
    threshold: float,
) -> dict[str, float]:
    """Compute the attributes that the second joint's limit should have if the first is right, but does not."""
    one, other = joints
    expected = _compute_expected_range(model, pair, known_pairs, joints=joints, threshold=threshold)
    for name in ("effort", "velocity"):
        a, b = one.get_limit_value(name), other.get_limit_value(name)
        if a is not None and b is not None and min(a, b) > 0 and abs(a - b) > threshold * max(a, b):
            expected[name] = a
    return expected


def _compute_expected_range(
    model: Model,
    pair: MirrorPair,
    known_pairs: Sequence[MirrorPair],
    *,
    joints: tuple[Joint, Joint],
    threshold: float,
) -> dict[str, float]:
    """Compute the limits that the second joint should have but does not.

    Empty where the drawings do not show that sides and zeros are mirrored.
    """
    one, other = joints
    (a, b), (c, d) = _get_bounds(one), _get_bounds(other)
    if one.type not in {"revolute", "prismatic"} or pair.drawn_as in {"neither", "copied"} or not (a < b and c < d):
        return {}
    if one.type == "revolute" and _are_in_two_units((a, b), (c, d)):
        return {}  # JNT006 reports the one in degrees
    along = float((pair.plane.linear @ model.axes[one.name]) @ model.axes[other.name])
    lower, upper = mirror_range(a, b, along, rotates=one.type == "revolute")
    slack = threshold * max(b - a, d - c)
    # Zeros that are half a turn apart on both sides give ranges a whole turn apart: the same poses.
    whole_turns = math.tau * round((c - lower) / math.tau) if one.type == "revolute" else 0.0
    differs = all(max(abs(lower + turn - c), abs(upper + turn - d)) > slack for turn in (0.0, whole_turns))
    if abs(along) < math.cos(ARRANGED) or not differs:
        return {}
    below = [p for p in known_pairs if p.is_attached_to(pair)]
    is_negated = _has_negated_axis(model, joints)
    # One range and opposite axes: of the poses behind the joint, the next one is enough to show that zeros are mirrored.
    shown = (pair, *_list_nearest([p for p in below if p is not pair])) if is_negated and (a, b) == (c, d) else below
    if pair.drawn_as is None and not all(p.is_in_place and _is_axis_aligned(p.linear) for p in shown):
        return {}  # the zero of one side may be another angle
    drawn = {p.drawn_as for p in below}
    is_module = ("mirrored" not in drawn or "copied" in drawn) and not is_negated
    if is_module and max(abs(a - c), abs(b - d)) <= slack:
        return {}
    pairs = (("lower", lower, c), ("upper", upper, d))
    return {name: expected for name, expected, value in pairs if abs(expected - value) > slack}


def _are_in_two_units(one: tuple[float, float], other: tuple[float, float]) -> bool:
    """Whether one range is the other in degrees, and is of more than a turn in radians."""
    small, large = sorted((one[1] - one[0], other[1] - other[0]))
    return large > math.tau and math.isclose(large, math.degrees(small), rel_tol=_IN_DEGREES)


def _get_bounds(joint: Joint) -> tuple[float, float]:
    """Return the lower and the upper limit, NaN where there is none."""
    lower, upper = joint.get_limit_value("lower"), joint.get_limit_value("upper")
    return math.nan if lower is None else lower, math.nan if upper is None else upper


def _list_agreeing_joints(model: Model, pair: MirrorPair, joint: Joint) -> tuple[str, ...]:
    """Return the joints outside the pair that carry parts like the pair's and have a joint's limits, digit for digit, mirrored or
    not."""
    others = [
        model.tree.parent_joint[name]
        for name in list_alike_links_elsewhere(model, pair)
        if name in model.tree.parent_joint
    ]
    return tuple(other.name for other in others if other.type == joint.type and _has_same_limits(other, joint, _DIGITS))


def _has_same_limits(one: Joint, other: Joint, threshold: float) -> bool:
    """Whether two joints have the same range, or the negated one, effort and velocity; False where one has none."""
    (a, b), (c, d) = _get_bounds(one), _get_bounds(other)
    slack = threshold * max(b - a, d - c)
    rest = [(one.get_limit_value(name), other.get_limit_value(name)) for name in ("effort", "velocity")]
    same = all(p is not None and q is not None and math.isclose(p, q, rel_tol=threshold) for p, q in rest)
    if one.type == "continuous":
        return same
    return same and min(max(abs(a - c), abs(b - d)), max(abs(a + d), abs(b + c))) <= slack


def _find_previous_joint(model: Model, joint: Joint) -> Joint | None:
    """Return the moving joint before another."""
    path = [j for j in model.tree.find_path_to(joint.child) if j.is_movable]
    return path[-2] if len(path) > 1 else None


def _is_mirrored_in_pose(pair: MirrorPair) -> bool:
    """Whether place and frames of two links are mirrored."""
    turned = pair.drawn_as not in {"mirrored", "both"} and not _is_axis_aligned(pair.linear)
    return pair.is_in_place and not turned


def _is_axis_aligned(linear: Array) -> bool:
    """Whether the frames of both sides differ by quarter turns and mirrors only: a choice of axes."""
    return bool(np.abs(np.rint(linear) - linear).max() < 2e-3)


def _compute_image_place(model: Model, pair: MirrorPair, *, joint: Joint, source: str) -> Array:
    """Compute where the mirror image of a link's frame lies in the frame of a joint's parent."""
    parent = model.frames[joint.parent]
    place: Array = parent[:3, :3].T @ (pair.plane.reflect_points(model.frames[source][:3, 3]) - parent[:3, 3])
    return place


def _is_typed_mirrored(model: Model, pair: MirrorPair, joints: tuple[Joint, Joint]) -> bool:
    """Whether both origins are mirror images, to the digit, in the coordinate plane of their parent that is the pair's plane: a
    plane that was fitted to more joints, or in a frame rotated by 1.57 for π/2, says less."""
    one, other = (joint.origin.xyz for joint in joints)
    if one is None or other is None or joints[0].parent != joints[1].parent:
        return False
    normal = model.frames[joints[0].parent][:3, :3].T @ pair.plane.normal
    axis = int(np.abs(normal).argmax())
    signs = 1.0 - 2.0 * (np.arange(3) == axis)
    return abs(float(normal[axis])) > math.cos(STRAIGHT) and bool(np.abs(signs * one - other).max() < _EXACT)


def _is_at_one_place(joints: tuple[Joint, Joint]) -> bool:
    """Whether both joints have one origin in the frames of two parents, as in copies of one part."""
    one, other = (joint.origin.matrix for joint in joints)
    same = one is not None and other is not None and float(np.abs(one - other).max()) < 1e-6
    return same and joints[0].parent != joints[1].parent
