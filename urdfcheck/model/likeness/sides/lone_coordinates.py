"""Joints of which one coordinate of the origin is not that of the other side, while all other numbers are, as typed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.core.text import split_name_words
from urdfcheck.model.likeness.mirror_pairs import PLACE, list_named_pairs
from urdfcheck.model.likeness.origin_slips import OriginSlip, is_taken_back
from urdfcheck.model.likeness.side_names import remove_places
from urdfcheck.model.parts import Joint
from urdfcheck.model.robot import Model

# Coordinates (m) that were typed alike, apart from the noise of a CAD program.
_SAME = 1e-4
# A smaller coordinate (m) has a sign by rounding; a smaller difference is one between two exports.
_LEAST, _LEAST_OFF = 2e-3, 5e-3
# So many other pairs are mirror images. One is enough where the decimal point slipped: to this share, three typed digits.
_WITNESSES, _ROUNDED = 2, 0.005
_POWERS = (10.0, 100.0, 1000.0)
# So few digits two numbers share by chance (chosen).
_ROUND_DIGITS = 2
# So many joints of one kind hang on one link; more are an array.
_FEWEST, _MOST = 4, 16


@dataclass(frozen=True, slots=True, eq=False)
class _Pair:
    """Two joints on both sides."""

    one: Joint
    other: Joint
    lone: int | None
    """The only coordinate that differs; None where none does."""
    across: int | None
    """The only coordinate with opposite signs."""
    is_shown: bool
    """Whether a coordinate that is not zero agrees."""


def iter_lone_coordinates(model: Model) -> Iterator[OriginSlip]:
    """Yield joints of which one coordinate of the origin, as typed, is not that of the mirror image of another joint.

    Their other coordinates are, to a tenth of a millimetre, and so are all coordinates of other pairs.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    reported: set[str] = set()
    for pair in (*_find_in_named_pairs(model), *_find_on_one_link(model), *_find_slipped_points(model)):
        names = {pair.one.name, pair.other.name}
        if not names & reported and _moves_axis(model, pair) and not is_taken_back(model, pair.other, pair.one):
            reported |= names
            yield _make_slip(pair)


def _find_in_named_pairs(model: Model) -> Iterator[_Pair]:
    """Yield the only pair of left and right joints in the robot that differ, if that is in one coordinate."""
    before = model.tree.parent_joint
    both = dict.fromkeys(list_named_pairs(model))
    pairs = []
    for names in both:
        one, other = (before.get(name) for name in names)
        if one is None or other is None or one.type != other.type:
            continue
        if one.parent != other.parent and (one.parent, other.parent) not in both:
            continue
        pair = _compare(one, other)
        if not one.is_movable:  # sensors, covers and frames are where there is room for them
            if pair is not None and pair.lone is not None and _is_mirrored_but_for_a_point(pair):
                pairs.append(pair)
            continue
        if pair is None:
            return  # the sides are arranged otherwise
        pairs.append(pair)
    odd = [pair for pair in pairs if pair.lone is not None]
    if len(odd) != 1 or not odd[0].is_shown:
        return
    (only,) = odd
    if _is_mirrored_but_for_a_point(only):
        yield only
        return
    is_on_one_link = only.one.parent == only.other.parent
    if is_on_one_link and only.across is None:
        return
    witnesses = [pair for pair in pairs if pair is not only and pair.is_shown]
    like = [pair for pair in witnesses if pair.one.parent == pair.other.parent == only.one.parent]
    is_centred = any(p.across == only.across for p in like)
    if is_on_one_link and only.lone == only.across and not (is_centred or _is_slipped_point(only)):
        return  # the frame of the link may be beside its middle
    if len(witnesses) >= (1 if _is_slipped_point(only) else _WITNESSES) or is_centred:
        yield only


def _is_slipped_point(pair: _Pair) -> bool:
    """Whether the coordinate that differs is a power of ten times the other one."""
    assert pair.lone is not None
    small, large = sorted(abs((joint.origin.xyz or (0.0, 0.0, 0.0))[pair.lone]) for joint in (pair.one, pair.other))
    return any(abs(large - power * small) <= _ROUNDED * large for power in _POWERS)


def _is_mirrored_but_for_a_point(pair: _Pair) -> bool:
    """Whether two joints on one link are mirror images apart from the decimal point of one coordinate.

    A part that is exactly ten times as far to one side as its counterpart to the other is hardly meant: that needs no other pair.
    Nor does one that is as far to its side, and ten times as far ahead; where all other coordinates are zero, digits that are
    not round show that the two are one number.
    """
    if pair.lone is None or pair.one.parent != pair.other.parent:
        return False
    first, second = ((joint.origin.xyz or (0.0, 0.0, 0.0))[pair.lone] for joint in (pair.one, pair.other))
    small, large = sorted((abs(first), abs(second)))
    is_shown = pair.is_shown or (first * second < 0 and float(f"{small:.{_ROUND_DIGITS - 1}e}") != small)
    is_mirrored = first * second < 0 or pair.across is not None
    return is_shown and is_mirrored and any(abs(large - power * small) <= 1e-9 * large for power in _POWERS)


def _find_on_one_link(model: Model) -> Iterator[_Pair]:
    """Yield the two joints on a link that are not each other's mirror image, unlike all others of their kind."""
    groups: dict[object, list[Joint]] = {}
    for name in model.tree.order[1:]:
        joint = model.tree.parent_joint[name]
        words = tuple(word for word in remove_places(joint.name) if not word.isdigit())
        if joint.is_movable and joint.mimic is None:
            groups.setdefault((joint.parent, joint.type, words), []).append(joint)
    for group in groups.values():
        if not _FEWEST <= len(group) <= _MOST or len(group) % 2:
            continue
        splits = [pair for across in range(3) if (pair := _match_images(group, across)) is not None]
        if len(splits) == 1:
            yield splits[0]


def _find_slipped_points(model: Model) -> Iterator[_Pair]:
    """Yield the only two like joints on one link that are mirror images apart from one decimal point, at both ends or sides."""
    groups: dict[object, list[Joint]] = {}
    for name in model.tree.order[1:]:
        joint = model.tree.parent_joint[name]
        words = remove_places(joint.name)
        if joint.mimic is None and len(words) < len(split_name_words(joint.name)):
            groups.setdefault((joint.parent, joint.type, words), []).append(joint)
    for group in groups.values():
        pair = _compare(*group) if len(group) == 2 else None
        if pair is not None and _is_mirrored_but_for_a_point(pair):
            yield pair


def _match_images(group: Sequence[Joint], across: int) -> _Pair | None:
    """Return the only two joints of a group that differ in one coordinate from mirror images across a plane of coordinates, where
    all others are each other's mirror images; None otherwise."""
    compared = [
        pair
        for one, other in combinations(group, 2)
        if (pair := _compare(one, other)) is not None and pair.across == across
    ]
    paired = {joint.name for pair in compared if pair.lone is None for joint in (pair.one, pair.other)}
    rest = [joint for joint in group if joint.name not in paired]
    if len(rest) != 2 or not paired:
        return None
    return next((pair for pair in compared if pair.lone is not None and [pair.one, pair.other] == rest), None)


def _compare(one: Joint, other: Joint) -> _Pair | None:
    """Compare the origins of two joints; None where more than one coordinate differs."""
    if one.origin.xyz is None or other.origin.xyz is None:
        return None
    places = np.array((one.origin.xyz, other.origin.xyz))
    same = np.abs(np.abs(places[0]) - np.abs(places[1])) <= _SAME
    differ = np.flatnonzero(~same).tolist()
    if len(differ) > 1 or (differ and abs(np.abs(places[0]) - np.abs(places[1]))[differ[0]] < _LEAST_OFF):
        return None
    opposite = np.flatnonzero(same & (places[0] * places[1] < 0) & (np.abs(places[0]) > _LEAST)).tolist()
    return _Pair(
        one=one,
        other=other,
        lone=differ[0] if differ else None,
        across=opposite[0] if len(opposite) == 1 else None,
        is_shown=bool((np.abs(places[0])[same] > _LEAST).any()),
    )


def _moves_axis(model: Model, pair: _Pair) -> bool:
    """Whether the coordinate that differs moves the axis of the joint: where on its axis a frame lies is a choice."""
    slip = _make_slip(pair)
    shift = model.frames[pair.other.parent][:3, :3] @ (np.array(pair.other.origin.xyz) - slip.expected)
    axis = model.axes.get(pair.other.name)
    if axis is None:
        return not pair.other.is_movable
    if _is_mirrored_but_for_a_point(pair) and _carries_alike(model, pair):
        return True
    return float(np.linalg.norm(shift - axis * float(shift @ axis))) > PLACE


def _carries_alike(model: Model, pair: _Pair) -> bool:
    """Whether other joints hang on both, and all are typed alike apart from signs: then none takes back where the frame is."""
    behind = [[joint.origin.xyz for joint in model.tree.child_joints[one.child]] for one in (pair.one, pair.other)]
    if len(behind[0]) != len(behind[1]) or not behind[0] or None in behind[0] + behind[1]:
        return False
    return bool(np.abs(np.abs(np.array(behind[0])) - np.abs(np.array(behind[1]))).max() <= _SAME)


def _make_slip(pair: _Pair) -> OriginSlip:
    assert pair.lone is not None
    places = [np.array(joint.origin.xyz) for joint in (pair.one, pair.other)]
    expected = []
    for own, twin in (places, places[::-1]):
        wanted = own.copy()
        keeps_sign = pair.across is None and abs(own[pair.lone]) > _LEAST
        wanted[pair.lone] = np.copysign(twin[pair.lone], own[pair.lone] if keeps_sign else twin[pair.lone])
        expected.append(wanted)
    if not _is_mirrored_but_for_a_point(pair):
        return OriginSlip(
            joint=pair.other, twin=pair.one, kind="coordinate", expected=expected[1], twin_expected=expected[0]
        )
    if abs(places[0][pair.lone]) > abs(places[1][pair.lone]):  # the farther one
        return OriginSlip(
            joint=pair.one, twin=pair.other, kind="decimal", expected=expected[0], twin_expected=expected[1]
        )
    return OriginSlip(joint=pair.other, twin=pair.one, kind="decimal", expected=expected[1], twin_expected=expected[0])
