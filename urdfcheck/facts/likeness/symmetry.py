"""Sibling frames that follow one symmetry, and the one among them that breaks it.

On 281 groups of two to twelve like joints in 63 published robots it raises one false alarm, which the joints' parents explain.
Of the errors injected into them (offsets of 2° to 85°, also beyond quarter turns, and tilts of 0.2° to 40°; 6,993 trials) it
names 68 % in groups of four, 75 % of six, 17 % of eight and all of twelve, and shows a pair with the odd frame in it, or one of
three, in 92 % of groups of two, 60 % of three, 7 % of four, 50 % of eight and all of ten: the symmetry of hands and arms relates
each joint to one other only. It never names a wrong member, not even where two are wrong. It reports nothing where it cannot
decide, or for turns by 90° and 180°, which are choices of frame.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import combinations, permutations, product
from typing import TYPE_CHECKING, Literal

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.motion.kinematics import compute_axis_angle

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from urdfcheck.facts.arrays import Array, Mat3


# Frames follow a pattern to within the error of rpy typed with three digits (1.57 is off by 8e-4 rad).
_FRAME_TOLERANCE = 2e-3
# Predictions made through different siblings and operations add up their typing errors.
_PREDICTION_TOLERANCE = 1e-2
# Beyond half way to the next axis, another choice of axes explains a joint axis better than a tilt does.
_MAX_TILT = math.pi / 4
# The choices of axes: the signed permutations (48, 3, 3).
_AXIS_CHOICES = np.array(
    [np.diag(signs)[list(order)] for order in permutations(range(3)) for signs in product((1.0, -1.0), repeat=3)]
)
# More joints are an array rather than a robot's limbs, and trying them takes long (the third power of their number).
_MAX_MEMBERS = 32
# How the names of operations that turn begin.
_ROTATION = "rotation"
# Positions match within 0.2 mm, a careful hand measurement, or half a percent of the pattern's size.
_PLACE_ABSOLUTE, _PLACE_RELATIVE = 2e-4, 5e-3


@dataclass(frozen=True, slots=True, kw_only=True)
class OddFrame:
    """The one frame of a group that breaks the orientation pattern of the others."""

    index: int
    """In the group."""
    kind: Literal["zero_offset", "axis_tilt"]
    """``zero_offset`` if it is rotated about its own joint axis, which only moves the joint's zero; ``axis_tilt`` if its axis has
    another direction."""
    angle: float
    """Turn from the pattern (rad): signed about the joint axis for ``zero_offset``, otherwise the tilt of the joint axis."""
    axis: tuple[float, float, float]
    """Unit axis of that turn in the common frame."""
    expected_frame: Mat3
    """Orientation by the pattern, in the common frame."""
    bad_pairs: int
    """Number of pairs that contradict the pattern."""
    good_pairs: int
    """Number of pairs that follow the pattern."""
    agreement: float
    """Fraction of predictions that give ``expected_frame``."""
    pattern: str
    """In words."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SuspectFrames:
    """Members of a group that do not fit together, where the frames alone do not prove which one is wrong."""

    members: tuple[int, ...]
    """The two of a pair whose frames are not related as its positions are, or the one of three that differs from both others."""
    kind: Literal["zero_offset", "axis_tilt"]
    """See `OddFrame`."""
    angles: tuple[float, ...]
    """Turn of each member if the others are right (rad), as in `OddFrame`."""
    expected_frames: tuple[Mat3, ...]
    """Orientation of each member if the others are right, in the common frame."""
    linear: Mat3
    """Relates the positions."""
    pattern: str
    """Relation of the positions in words."""


@dataclass(frozen=True, slots=True)
class LinkSignature:
    """What like links have in common, regardless of their names. Mirrored parts are alike."""

    mass: float
    """kg."""
    moments: tuple[float, ...]
    """Principal moments of inertia (kg m²), ascending; empty if unknown."""
    surface_moments: tuple[float, ...]
    """Principal second moments of the mesh's surface (m²), ascending; empty if unknown."""


@dataclass(frozen=True, slots=True)
class _SymmetryOperation:
    """A symmetry of the positions: a ``linear`` part (3, 3), and the pairs (source, target) it maps on each other."""

    name: str
    linear: Array
    pairs: tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True)
class _FrameRelation:
    """How an operation turns the frame of ``source`` against that of ``target``; ``good`` if that is the signed
    permutation ``snapped``, one of the 48 by which frames differ that are the same except for the choice of axes."""

    source: int
    target: int
    snapped: Array
    good: bool

    @property
    def members(self) -> frozenset[int]:
        return frozenset((self.source, self.target))

    @property
    def is_pure(self) -> bool:
        """Whether the operation maps the frames onto each other unchanged, apart from what is wrong with one of them."""
        return bool((self.snapped == np.eye(3)).all())


@dataclass(frozen=True, slots=True)
class _FramePrediction:
    """Where the operation ``name`` puts the odd frame; ``pure`` if it maps frames onto each other unchanged."""

    name: str
    pure: bool
    frame: Array


def build_link_signature(mass: float, moments: Sequence[float], surface_moments: Sequence[float] = ()) -> LinkSignature:
    """Build a link's signature; the order of the moments does not matter."""
    return LinkSignature(mass, tuple(sorted(moments)), tuple(sorted(surface_moments)))


def group_by_signature(signatures: Sequence[LinkSignature]) -> list[list[int]]:
    """Group the indices of like signatures, groups and members in ascending order; every index is in exactly one group.

    Alike means masses within 0.5 % and moments within 5 %: three and two digits, without the boundary that rounding would put
    between 0.9999 and 1.0001. Likeness is transitive.
    """
    groups: list[list[int]] = []
    for index, one in enumerate(signatures):
        alike = [group for group in groups if any(_has_like_signature(one, signatures[other]) for other in group)]
        groups = [group for group in groups if group not in alike]
        groups.append(sorted([index, *(member for group in alike for member in group)]))
    return sorted(groups)


def find_odd_frame(positions: ArrayLike, frames: ArrayLike, axes: ArrayLike) -> OddFrame | None:
    """Find the one member of a group of matching joints whose frame breaks the pattern of the others.

    ``positions`` (n, 3) in metres and ``frames`` (n, 3, 3) rotations, both in one common frame, about whose axes symmetries are
    searched for; ``axes`` (n, 3) joint axes, each in its own joint frame. None if there is no such member, or it is uncertain:
    below three members or above 32, if the positions have no symmetry that relates the frames of the others, if fewer than two
    of them determine where the odd frame should be, or if several members are possible.
    """
    place, turn = np.asarray(positions, dtype=float), np.asarray(frames, dtype=float)
    if not 3 <= len(place) <= _MAX_MEMBERS or not (np.isfinite(place).all() and np.isfinite(turn).all()):
        return None
    related = [(op, _relate_all_pairs(op, turn)) for op in _find_operations(place)]
    axis = np.asarray(axes, dtype=float)
    blamed = [_blame_member(index, related, turn=turn, axis=axis[index]) for index in range(len(place))]
    odd = [one for one in blamed if one is not None]
    return odd[0] if len(odd) == 1 else None


def find_suspect_frames(positions: ArrayLike, frames: ArrayLike, axes: ArrayLike) -> SuspectFrames | None:
    """Find the pair of a group, or the one of three, that does not fit, where it is uncertain which one is wrong.

    Arguments as for `find_odd_frame`. None if all fit, or if more than one pair does not.
    """
    place, turn, axis = (np.asarray(a, dtype=float) for a in (positions, frames, axes))
    if not 2 <= len(place) <= _MAX_MEMBERS or not (np.isfinite(place).all() and np.isfinite(turn).all()):
        return None
    every = [
        (op, _relate_all_pairs(op, turn))
        for op in (_find_operations(place) if len(place) > 2 else _find_pair_operations(place))
    ]
    # In a group of more than three, an operation that maps no frame onto another is not a symmetry of the group,
    related = [(op, group) for op, group in every if len(place) <= 3 or any(r.good for r in group)]
    good = {r.members for _, group in related for r in group if r.good}
    bad = {r.members for _, group in related for r in group} - good
    suspects = frozenset().union(*bad) - frozenset().union(*good)
    if not (len(place) == 3 and len(suspects) == 1) and not (len(suspects) == 2 and bad == {suspects}):
        return None
    # unless it maps none because both suspects are wrong.
    whole = [group for _, group in every if len(frozenset().union(*(r.members for r in group))) == len(place) > 3]
    if any(all(not r.good and r.members & suspects for r in group) for group in whole):
        return None
    ways = [
        (len(place) == 2 and _reverses_axis(op, turn=turn, axes=axis), all(r.is_pure for r in group), way)
        for op, group in related
        if (way := _suspect_members(sorted(suspects), op, group, turn=turn, axes=axis)) is not None
    ]
    best = min((_rank_suspects(way) for *_, way in ways), default=None)
    nearest = [one for one in ways if _rank_suspects(one[-1]) == best]
    if all(reverses for reverses, *_ in nearest):
        return None
    # Of rotations that say the same, the one that turns one frame into the other is how the joints are related.
    alike = [way for _, is_pure, way in nearest if is_pure and way.pattern.startswith(_ROTATION)]
    first = nearest[0][-1]
    return alike[0] if alike and first.pattern.startswith(_ROTATION) else first


def _rank_suspects(way: SuspectFrames) -> tuple[bool, float]:
    """Return what is less for a better explanation; to a microradian: rounding must not decide between ways that say the same."""
    return way.kind == "axis_tilt", round(max(map(abs, way.angles)), 6)


def is_axis_renaming(rotation: Array) -> bool:
    """Whether an orthogonal matrix only renames axes: one of the 48 signed permutations, to what 1.57 leaves of π/2."""
    snapped = np.rint(rotation)
    one_each = bool((np.abs(snapped).sum(axis=0) == 1).all() and (np.abs(snapped).sum(axis=1) == 1).all())
    return one_each and measure_rotation_angle(snapped, rotation) < _FRAME_TOLERANCE


def measure_rotation_angle(one: Array, other: Array) -> float:
    """Measure the angle (rad) of the rotation from one orthogonal matrix to another: ``|A - B| = 2 sqrt(2) sin(angle / 2)``."""
    return 2.0 * math.asin(min(1.0, float(np.linalg.norm(one - other)) / math.sqrt(8.0)))


def _has_like_signature(one: LinkSignature, other: LinkSignature) -> bool:
    return (
        math.isclose(one.mass, other.mass, rel_tol=5e-3)
        and _has_close_moments(one.moments, other.moments)
        and _has_close_moments(one.surface_moments, other.surface_moments)
    )


def _has_close_moments(one: Sequence[float], other: Sequence[float]) -> bool:
    # A moment far below the largest is rounding: the long moments of a thin rod do not determine the third.
    floor = 1e-3 * max(map(abs, (*one, *other)), default=0.0)
    return len(one) == len(other) and all(
        math.isclose(a, b, rel_tol=5e-2, abs_tol=floor) for a, b in zip(one, other, strict=True)
    )


def _find_operations(place: Array) -> list[_SymmetryOperation]:
    """Find mirrors and rotations about the common axes through the centroid, and shifts that occur at least twice."""
    tolerance = max(_PLACE_ABSOLUTE, _PLACE_RELATIVE * float(np.linalg.norm(np.ptp(place, axis=0))))
    centred = place - place.mean(axis=0)
    found = []
    for name, linear in _list_point_operations():
        distance = np.linalg.norm(centred[None, :, :] - (centred @ linear.T)[:, None, :], axis=2)
        image = distance.argmin(axis=1)
        if distance.min(axis=1).max() <= tolerance and len(set(image.tolist())) == len(place):
            pairs = tuple((i, k) for i, k in enumerate(image.tolist()) if i != k)
            found.append(_SymmetryOperation(name, linear, pairs))
    return found + _find_shifts(place, tolerance)


def _list_point_operations() -> list[tuple[str, Array]]:
    named = []
    for axis, letter in enumerate("xyz"):
        mirror = np.eye(3)
        mirror[axis, axis] = -1.0
        named.append((f"mirror {letter}", mirror))
    for axis, letter in enumerate("xyz"):
        j, k = (axis + 1) % 3, (axis + 2) % 3
        for order in (2, 3, 4, 5, 6, 8):
            angle = 2.0 * math.pi / order
            turn = np.eye(3)
            turn[j, j] = turn[k, k] = math.cos(angle)
            turn[k, j] = math.sin(angle)
            turn[j, k] = -turn[k, j]
            named.append((f"{_ROTATION} by {360 // order}° about {letter}", turn))
    return named


def _find_shifts(place: Array, tolerance: float) -> list[_SymmetryOperation]:
    pairs = np.array(list(combinations(range(len(place)), 2)))
    shifts = place[pairs[:, 1]] - place[pairs[:, 0]]
    # A shift and its reverse are one operation: the first coordinate that is not small is made positive.
    leading = np.take_along_axis(shifts, (np.abs(shifts) > tolerance).argmax(axis=1)[:, None], axis=1)[:, 0]
    pairs[leading < 0] = pairs[leading < 0][:, ::-1]
    shifts[leading < 0] *= -1.0
    found = []
    while len(pairs):
        like = np.linalg.norm(shifts - shifts[0], axis=1) <= tolerance
        if like.sum() >= 2 and np.linalg.norm(shifts[0]) > tolerance:
            along = "".join(letter for letter, part in zip("xyz", shifts[0], strict=True) if abs(part) > tolerance)
            found.append(
                _SymmetryOperation(f"translation along {along}", np.eye(3), tuple(map(tuple, pairs[like].tolist())))
            )
        pairs, shifts = pairs[~like], shifts[~like]
    return found


def _find_pair_operations(place: Array) -> list[_SymmetryOperation]:
    """Find what maps one of two positions onto the other: mirrors and half turns about the common axes, and the shift.

    Along all three axes a shift relates any two positions, which shows nothing.
    """
    size = float(np.linalg.norm(np.ptp(place, axis=0)))
    apart = np.abs(place[1] - place[0]) > max(_PLACE_ABSOLUTE, _PLACE_RELATIVE * size)
    along = "".join(letter for letter, far in zip("xyz", apart, strict=True) if far)
    shift = [_SymmetryOperation(f"translation along {along}", np.eye(3), ((0, 1),))] if 0 < len(along) < 3 else []
    return [op for op in _find_operations(place) if op.pairs] + shift


def _reverses_axis(operation: _SymmetryOperation, *, turn: Array, axes: Array) -> bool:
    """Whether a shift or rotation maps the axis of the first of two joints to the reverse of the second's.

    Then one joint is not a copy of the other, whatever the angle between their frames. In a mirror image the sense of rotation
    is a choice.
    """
    one, other = (turn[index] @ axes[index] for index in (0, 1))
    return bool(np.linalg.det(operation.linear) > 0.0) and float((operation.linear @ one) @ other) < 0.0


def _relate_all_pairs(operation: _SymmetryOperation, turn: Array) -> list[_FrameRelation]:
    return [_relate_pair(operation, source=source, target=target, turn=turn) for source, target in operation.pairs]


def _relate_pair(operation: _SymmetryOperation, *, source: int, target: int, turn: Array) -> _FrameRelation:
    relative = turn[target].T @ operation.linear @ turn[source]
    return _FrameRelation(source, target, snapped=np.rint(relative), good=is_axis_renaming(relative))


def _blame_member(
    index: int, related: Sequence[tuple[_SymmetryOperation, Sequence[_FrameRelation]]], *, turn: Array, axis: Array
) -> OddFrame | None:
    """Find what is wrong with a member if nothing else is: the others follow a symmetry in which all take part.

    An operation under which others do not fit either is not a symmetry of the frames, and is not evidence about this one.
    """
    clean = [(op, group) for op, group in related if _is_followed(r for r in group if index not in r.members)]
    good = {r.members for _, group in clean for r in group if r.good}
    bad = {r.members for _, group in clean for r in group} - good
    fitting = frozenset().union(*good)
    if len(bad) < 2 or index in fitting or len(fitting) < len(turn) - 1:
        return None
    predictions = [
        prediction for op, group in clean for prediction in _predict_frames(index, op, group=group, turn=turn)
    ]
    expected, supporting = _find_majority_frame(predictions)
    agreement = len(supporting) / max(1, len(predictions))
    if agreement <= 0.5:
        return None
    deviation = _classify_deviation(expected, turn[index], axis)
    if deviation is None:
        return None
    kind, angle, about = deviation
    return OddFrame(
        index=index,
        kind=kind,
        angle=angle,
        axis=about,
        expected_frame=expected,
        bad_pairs=len(bad),
        good_pairs=len(good),
        agreement=agreement,
        pattern=_describe_operations(supporting),
    )


def _is_followed(relations: Iterable[_FrameRelation]) -> bool:
    verdicts = [r.good for r in relations]
    return bool(verdicts) and all(verdicts)


def _suspect_members(
    suspects: Sequence[int],
    operation: _SymmetryOperation,
    group: Sequence[_FrameRelation],
    *,
    turn: Array,
    axes: Array,
) -> SuspectFrames | None:
    """Compare the suspects' frames with those that an operation makes of their partners'."""
    sides = []
    for index in suspects:
        frames = [(False, p.frame) for p in _predict_frames(index, operation, group=group, turn=turn)]
        if not frames:
            frames = [
                c for r in group if index in r.members for c in _list_axis_choices(operation, r, index=index, turn=turn)
            ]
        ways = []
        for place, (renamed, frame) in enumerate(frames):
            deviation = _classify_deviation(frame, turn[index], axes[index])
            if deviation is not None:
                kind, angle, _ = deviation
                # Half turns about the axis do not show in its tilt: of equal ones the nearest frame is meant.
                whole = measure_rotation_angle(frame, turn[index])
                ways.append((kind == "axis_tilt", renamed, round(abs(angle), 6), whole, place, kind, angle))
        if not ways:
            return None
        *_, best, kind, angle = min(ways)
        sides.append((kind, angle, frames[best][1]))
    if len({kind for kind, _, _ in sides}) != 1:
        return None
    kinds, angles, expected = zip(*sides, strict=True)
    return SuspectFrames(
        members=tuple(suspects),
        kind=kinds[0],
        angles=angles,
        expected_frames=expected,
        linear=operation.linear,
        pattern=operation.name,
    )


def _list_axis_choices(
    operation: _SymmetryOperation, relation: _FrameRelation, *, index: int, turn: Array
) -> list[tuple[bool, Array]]:
    """List the frames of ``index`` that the partner's frame allows, and whether its axes are renamed."""
    linear, partner = operation.linear, relation.source
    if relation.source == index:
        linear, partner = linear.T, relation.target
    carried = linear @ turn[partner]
    handed = float(np.linalg.det(linear))
    return [
        (bool(np.count_nonzero(np.diag(c)) < 3), carried @ c) for c in _AXIS_CHOICES if np.linalg.det(c) * handed > 0.0
    ]


def _predict_frames(
    index: int, operation: _SymmetryOperation, *, group: Sequence[_FrameRelation], turn: Array
) -> list[_FramePrediction]:
    """Predict the frame of ``index`` from an operation, if its good pairs agree on how it turns frames."""
    agreed = [r.snapped for r in group if r.good and index not in (r.source, r.target)]
    if not agreed or any((other != agreed[0]).any() for other in agreed):
        return []
    known, linear = agreed[0], operation.linear
    pure = bool((known == np.eye(3)).all())
    onto = [linear @ turn[r.source] @ known.T for r in group if r.target == index]
    back = [linear.T @ turn[r.target] @ known for r in group if r.source == index]
    return [_FramePrediction(operation.name, pure, frame) for frame in (*onto, *back)]


def _find_majority_frame(predictions: Sequence[_FramePrediction]) -> tuple[Array, list[_FramePrediction]]:
    """Find the frame that most predictions agree on, the closest to them all, and those that agree."""
    best: list[_FramePrediction] = []
    frame, least = np.eye(3), math.inf
    for one in predictions:
        angles = [measure_rotation_angle(one.frame, other.frame) for other in predictions]
        agreeing = [other for other, angle in zip(predictions, angles, strict=True) if angle < _PREDICTION_TOLERANCE]
        total = sum(angle for angle in angles if angle < _PREDICTION_TOLERANCE)
        if (len(agreeing), -total) > (len(best), -least):
            best, frame, least = agreeing, one.frame, total
    return frame, best


def _classify_deviation(
    expected: Array, actual: Array, axis: Array
) -> tuple[Literal["zero_offset", "axis_tilt"], float, tuple[float, float, float]] | None:
    length = float(np.linalg.norm(axis))
    if not 0.0 < length < math.inf:
        return None
    wanted, found = expected @ axis / length, actual @ axis / length
    cross = np.cross(wanted, found)
    tilt = math.atan2(float(np.linalg.norm(cross)), float(wanted @ found))
    turn_axis, turn = compute_axis_angle(expected.T @ actual)
    if turn < _FRAME_TOLERANCE:
        return None
    if tilt < _FRAME_TOLERANCE:
        return "zero_offset", math.copysign(turn, float(turn_axis @ axis)), _to_xyz(found)
    if tilt > _MAX_TILT:
        return None
    return "axis_tilt", tilt, _to_xyz(cross / np.linalg.norm(cross))


def _to_xyz(vector: Array) -> tuple[float, float, float]:
    x, y, z = vector.tolist()
    return x, y, z


def _describe_operations(supporting: Sequence[_FramePrediction]) -> str:
    """Name the operations that map the frames onto each other unchanged; else the one that most predictions rest on."""
    pure = list(dict.fromkeys(p.name for p in supporting if p.pure))
    if pure:
        return " and ".join(pure)
    names = [p.name for p in supporting]
    return max(names, key=names.count)
