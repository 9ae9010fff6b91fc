"""The one pair of left and right joints whose axes or angles differ as typed, while those of all other pairs agree."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.model.likeness.mirror_pairs import list_named_pairs
from urdfcheck.model.likeness.mirrored_joints import TURNING
from urdfcheck.model.likeness.odd_limbs import places_something
from urdfcheck.model.likeness.origin_slips import is_taken_back
from urdfcheck.model.likeness.shape_comparison import is_alike
from urdfcheck.model.parts import Joint
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# So many other pairs agree (chosen).
_WITNESSES = 3
# So many other pairs of joints agree about their places, and so far off (m) is one that does not: a calibration is
# less, and a part that is farther off is arranged otherwise. All three are chosen.
_FIXED_WITNESSES, _LEAST_OFF, _MOST_OFF = 4, 2e-3, 0.05
# Components of unit axes, coordinates (m) and angles (rad) that were typed alike, apart from the noise of a CAD program.
_SAME = {"axis": 2e-3, "xyz": 1e-3, "rpy": 2e-3}
# A smaller angle (rad) is one between two exports; a multiple of the step, to within this, is an arrangement. All
# three are chosen.
_LEAST, _STEP, _ROUND = math.radians(1), math.radians(15), math.radians(0.06)
# Cosine: axes along other lines.
_APART = 0.99


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LoneAttribute:
    """Two joints on both sides of which one attribute differs in more than signs."""

    joint: Joint
    twin: Joint
    attribute: Literal["axis", "rpy", "xyz"]
    witnesses: int
    """How many other pairs agree."""


def iter_lone_attributes(model: Model) -> Iterator[LoneAttribute]:
    """Yield the only pair of left and right joints whose axes, angles or fixed places differ in more than signs.

    Their places, and what their links draw, are typed alike on both sides: no other choice of frames explains it.

    :raises FactUnavailableError: when the tree is broken.
    """
    pairs = _list_pairs(model)
    attributes: tuple[Literal["axis", "rpy"], ...] = ("axis", "rpy")
    for attribute in attributes:
        odd = [pair for pair in pairs if not _agree(pair, attribute)]
        if len(odd) != 1 or not _is_slip(model, odd[0], attribute):
            continue
        one, other = odd[0]
        is_across = attribute == "axis" and one.parent == other.parent and _is_across(odd[0])
        if len(pairs) > (1 if is_across else _WITNESSES):
            yield LoneAttribute(joint=other, twin=one, attribute=attribute, witnesses=len(pairs) - 1)
    yield from _find_lone_moving_place(model)
    yield from _find_lone_bolted(model)


def _find_lone_bolted(model: Model) -> Iterator[LoneAttribute]:
    """Yield the only two fixed joints of two limbs whose places, or angles, differ in more than signs, as typed.

    Sensors and covers of one body are where there is room for them.
    """
    all_pairs = _list_joints_of_pairs(model)
    pairs = [
        pair
        for pair in all_pairs
        if pair[0].type == "fixed"
        and (pair[0].parent != pair[1].parent or any(_hangs_on(known, pair) for known in all_pairs))
        and all(places_something(model, joint) for joint in pair)
    ]
    attributes: tuple[Literal["xyz", "rpy"], ...] = ("xyz", "rpy")
    for attribute in attributes if len(pairs) > _FIXED_WITNESSES else ():
        odd = [pair for pair in pairs if not _agree(pair, attribute)]
        if len(odd) != 1 or is_alike(model, odd[0][0].child, odd[0][1].child) is False:
            continue
        one, other = odd[0]
        if _is_slip(model, odd[0], "rpy") if attribute == "rpy" else _is_displaced(model, odd[0], all_pairs):
            yield LoneAttribute(joint=other, twin=one, attribute=attribute, witnesses=len(pairs) - 1)


def _find_lone_moving_place(model: Model) -> Iterator[LoneAttribute]:
    """Yield the only two joints that move, or that are fixed between those of two limbs, whose places differ in more than signs,
    as typed."""
    pairs = [pair for pair in _list_joints_of_pairs(model) if pair[0].has_axis or _is_in_limb(model, pair)]
    odd = [pair for pair in pairs if not _agree(pair, "xyz")]
    if len(odd) != 1 or len(pairs) <= _FIXED_WITNESSES or is_alike(model, odd[0][0].child, odd[0][1].child) is False:
        return
    one, other = odd[0]
    if _may_be_off_centre(odd[0], pairs):
        return
    if _agree(odd[0], "axis") and _is_displaced(model, odd[0], pairs) and not is_taken_back(model, other, one):
        yield LoneAttribute(joint=other, twin=one, attribute="xyz", witnesses=len(pairs) - 1)


def _may_be_off_centre(pair: tuple[Joint, Joint], pairs: Sequence[tuple[Joint, Joint]]) -> bool:
    """Whether two joints on one link differ only in the coordinate in which they are opposite: the frame of the link may be
    beside its middle. Another pair on the link that is opposite there, and agrees, shows that it is not."""
    one, other = pair
    first, second = (np.array(joint.origin.xyz or (0.0, 0.0, 0.0)) for joint in pair)
    differs = np.abs(np.abs(first) - np.abs(second)) > _SAME["xyz"]
    if one.parent != other.parent or differs.sum() != 1 or not first @ np.where(differs, second, 0.0) < 0.0:
        return False
    return not any(
        known is not pair
        and known[0].parent == known[1].parent == one.parent
        and float(np.array(known[0].origin.xyz or (0.0, 0.0, 0.0)) @ np.where(differs, known[1].origin.xyz, 0.0)) < 0.0
        for known in pairs
        if known[1].origin.xyz is not None
    )


def _is_in_limb(model: Model, pair: tuple[Joint, Joint]) -> bool:
    """Whether two fixed joints hang on the links of two limbs, and other joints move behind both: no sensor or cover is there."""
    ways = [
        [one for one in model.joints if one.is_movable and joint in model.tree.find_path_to(one.parent)]
        for joint in pair
    ]
    return pair[0].parent != pair[1].parent and all(ways)


def _is_displaced(model: Model, pair: tuple[Joint, Joint], all_pairs: Sequence[tuple[Joint, Joint]]) -> bool:
    """Whether the places of two joints differ by as much as a slip does, across their axes, and nothing else does."""
    first, second = (_read(joint, "xyz") for joint in pair)
    turn, axis = pair[0].origin.matrix, pair[0].axis
    if first is None or second is None or turn is None:
        return False
    off = first - second
    if pair[0].has_axis and axis is not None and any(axis):
        line = np.abs(turn[:3, :3] @ np.array(axis)) / np.linalg.norm(axis)
        off = off * (1.0 - line)  # where on its axis a frame is, is a choice
    is_same_otherwise = _agree(pair, "rpy") and _is_drawn_alike(model, pair)
    behind = [known for known in all_pairs if _hangs_on(known, pair)]
    distance = float(np.linalg.norm(off))
    return _LEAST_OFF < distance < _MOST_OFF and is_same_otherwise and all(_agree(k, "xyz") for k in behind)


def _hangs_on(pair: tuple[Joint, Joint], above: tuple[Joint, Joint]) -> bool:
    """Whether the joints of a pair hang on the links of another one."""
    return {joint.parent for joint in pair} == {joint.child for joint in above}


def _is_across(pair: tuple[Joint, Joint]) -> bool:
    """Whether two axes are along two coordinates of frames that are typed alike: on one link one other pair is enough then."""
    axes = [_read(joint, "axis") for joint in pair]
    return all(axis is not None and float(axis.max()) > 1 - _SAME["axis"] for axis in axes)


def _list_pairs(model: Model) -> list[tuple[Joint, Joint]]:
    """List the left and right joints that move, of one type, on one link or on two that are a pair."""
    return [pair for pair in _list_joints_of_pairs(model) if pair[0].has_axis]


def _list_joints_of_pairs(model: Model) -> list[tuple[Joint, Joint]]:
    """List the left and right joints of one type, on one link or on two that are a pair."""
    both = dict.fromkeys(list_named_pairs(model))
    joints = [tuple(model.tree.parent_joint.get(name) for name in names) for names in both]
    return [
        (one, other)
        for one, other in joints
        if one is not None
        and other is not None
        and one.type == other.type
        and (one.parent == other.parent or (one.parent, other.parent) in both)
    ]


def _agree(pair: Sequence[Joint], attribute: str) -> bool:
    """Whether an attribute of two joints is the same apart from signs; False where one is malformed."""
    one, other = (_read(joint, attribute) for joint in pair)
    if one is None or other is None:
        return False
    off = np.abs(one - other)
    return bool((off if attribute != "rpy" else np.minimum(off, math.pi - off)).max() <= _SAME[attribute])


def _read(joint: Joint, attribute: str) -> Array | None:
    if attribute == "axis":
        axis = None if joint.axis is None else np.abs(joint.axis)
        return axis / np.linalg.norm(axis) if axis is not None and axis.any() else None
    values = joint.origin.xyz if attribute == "xyz" else joint.origin.rpy
    if values is None:
        return None
    return np.abs(values) if attribute == "xyz" else _fold_angles(values)


def _fold_angles(rpy: Sequence[float]) -> Array:
    """Return angles (rad) without signs and half turns: an angle that is half a turn away is another choice of axes."""
    folded: Array = np.abs(np.remainder(np.add(rpy, math.pi / 2), math.pi) - math.pi / 2)
    return folded


def _is_slip(model: Model, pair: tuple[Joint, Joint], attribute: str) -> bool:
    """Whether nothing else is typed otherwise on one side, so that the attribute cannot be a choice of frames."""
    first, second = (_read(joint, attribute) for joint in pair)
    if first is None or second is None or not _agree(pair, "xyz") or not _is_drawn_alike(model, pair):
        return False
    before = model.tree.parent_joint
    behind = [(before.get(one), before.get(other)) for one, other in list_named_pairs(model)]
    if any(
        not _agree((one, other), "xyz")
        for one, other in behind
        if one is not None and other is not None and {one.parent, other.parent} == {joint.child for joint in pair}
    ):
        return False
    if attribute == "axis":
        return _agree(pair, "rpy") and float(first @ second) < _APART
    off = np.abs(first - second)
    angle = float(off.max())
    is_one = int((off > _SAME["rpy"]).sum()) == 1 and angle > _LEAST
    is_arranged = abs(angle - round(angle / _STEP) * _STEP) <= _ROUND
    is_one_axis = not pair[0].has_axis or _agree(pair, "axis")
    return is_one and not is_arranged and is_one_axis and not _is_of_zero(pair)


def _is_of_zero(pair: tuple[Joint, Joint]) -> bool:
    """Whether the frames are rotated about the axis of a hinge: another zero."""
    one, other = pair
    first, second = one.origin.matrix, other.origin.matrix
    if one.type not in TURNING or first is None or second is None or one.axis is None or other.axis is None:
        return False
    off = np.abs(first[:3, :3] @ np.array(one.axis)) - np.abs(second[:3, :3] @ np.array(other.axis))
    return bool(np.abs(off).max() <= math.sin(_LEAST) * np.linalg.norm(one.axis))


def _is_drawn_alike(model: Model, pair: tuple[Joint, Joint]) -> bool:
    """Whether the shapes of both links are as many, with the same angles apart from signs and half turns."""
    shapes = [model.link_by_name[joint.child].visuals for joint in pair]
    return len(shapes[0]) == len(shapes[1]) and all(
        one.origin.rpy is not None
        and other.origin.rpy is not None
        and bool(np.abs(_fold_angles(one.origin.rpy) - _fold_angles(other.origin.rpy)).max() <= _SAME["rpy"])
        for one, other in zip(*shapes, strict=True)
    )
