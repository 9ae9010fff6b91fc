"""Joints whose origins leave their child in the air: it touches nothing, while the parts at all other joints touch."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.model.fact import fact
from urdfcheck.model.motion import poses
from urdfcheck.model.motion.far_origins import SCENE, measure_origin_lengths
from urdfcheck.model.parts import Joint, is_dummy_shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.corners import compute_shape_corners

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Bools

# Parts touch if the space between their boxes is at most this share of the smaller side: no joint that moves exceeds it in
# 161 published robots, apart from those that draw a part of their links only.
TOUCHING = 0.075
# So many other joints have to separate drawn parts, and at most this share of them may be loose too.
_LEAST_OTHERS, _MOST_LOOSE = 4, 0.1
# Robots with more shapes are not compared: a table of all pairs would take memory.
_MOST_SHAPES = 800
# Positions of a joint, between its limits, at which the part may touch.
_POSITIONS = 9
# Shorter coordinates (m) are zero.
_ZERO = 1e-4
# What undoes a slip of one coordinate; the likely ones first.
_LIKELY = {"sign": -1.0, "left": 0.1}
_UNLIKELY = {"left2": 0.01, "left3": 0.001}
# The way back leads through the space for this share of its length at least: a part that goes deep into others was not there.
_FREE = {"sign": 0.75, "swap": 0.75, "left": 0.5, "left2": 0.5, "left3": 0.5}
# An origin whose decimal point slipped is so many times longer than all others.
_LONGER = 1.5


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class OriginChange:
    """A change of an origin that undoes one slip."""

    joint: Joint
    kind: str
    """``sign``, ``swap`` (of two coordinates); ``left``, ``left2``, ``left3``: the decimal point so many places further left."""
    axes: tuple[int, ...]
    """The coordinates that change."""
    xyz: tuple[float, ...]
    """(3,) in m, afterwards."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LoosePart:
    """A part of the tree that touches nothing."""

    joint: Joint
    """The first joint towards it that moves."""
    gap: float
    """The space between the boxes around its shapes and those around all other ones (m)."""
    size: float
    """The diagonal of the box around it, or around everything else if that is smaller (m)."""
    others: int
    """How many other joints separate drawn parts."""
    change: OriginChange | None
    """The only likely change of one origin after which it touches; None where there are several, or none."""

    @property
    def share(self) -> float:
        """The space in sizes of the smaller side."""
        return self.gap / self.size


@dataclass(frozen=True, slots=True, eq=False)
class _Boxes:
    """The boxes around the drawn shapes of a model, all joints at zero."""

    owners: tuple[str, ...]
    low: Array
    """(S, 3) in root coordinates (m)."""
    high: Array

    def measure_gap(self, inside: Bools, shift: Array | float = 0.0) -> float:
        """Measure the least space (m) between the boxes ``inside`` (S,), moved by ``shift`` (3,), and all others."""
        return _measure_gap(self.low[inside] + shift, self.high[inside] + shift, self.low[~inside], self.high[~inside])

    def measure_size(self, inside: Bools) -> float:
        """Measure the diagonal (m) of the box around the smaller side."""
        return min(
            float(np.linalg.norm(self.high[side].max(axis=0) - self.low[side].min(axis=0)))
            for side in (inside, ~inside)
        )


@fact
def find_loose_part(model: Model, least: float) -> LoosePart | None:
    """Find the only part behind a joint that moves and whose space to everything else is at least ``least`` sizes of the
    smaller side.

    None where several parts are loose, or what is drawn does not show that parts of this robot touch: a shape is not known, or
    fewer than four other joints separate drawn parts.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    if len(model.joints) <= _LEAST_OTHERS:
        return None
    boxes = _collect_boxes(model)
    if boxes is None:
        return None
    splits = _group_joints(model, boxes)
    if len(splits) <= _LEAST_OTHERS:
        return None
    spaces = {key: _measure_space(boxes, key) for key, joints in splits.items() if not _is_touching(boxes, joints[-1])}
    loose = [key for key, (gap, size) in spaces.items() if gap > TOUCHING * size]
    parts = [key for key in loose if spaces[key][0] >= least * spaces[key][1] and _is_part(model, splits[key])]
    if len(parts) != 1 or len(loose) - 1 > _MOST_LOOSE * (len(splits) - 1):
        return None
    inside, joints = _get_mask(parts[0]), splits[parts[0]]
    gap, size = spaces[parts[0]]
    if _touches_elsewhere(model, boxes, joints, inside=inside, reach=TOUCHING * size):
        return None
    return LoosePart(
        joint=next(joint for joint in joints if joint.is_movable),
        gap=gap,
        size=size,
        others=len(splits) - 1,
        change=_find_change(
            model, joints, gap, touches=lambda shift: boxes.measure_gap(inside, shift) <= TOUCHING * size
        ),
    )


def _collect_boxes(model: Model) -> _Boxes | None:
    """Collect the boxes around all shapes; None when one is not known, or there are too few or too many."""
    owners: list[str] = []
    lows: list[Array] = []
    highs: list[Array] = []
    for name in model.tree.order:
        link, frame = model.link_by_name[name], model.frames[name]
        for shape in (*link.visuals, *link.collisions):
            if is_dummy_shape(shape):
                continue
            corners = compute_shape_corners(model, shape)
            if corners is None or len(owners) >= _MOST_SHAPES:
                return None
            placed = corners @ frame[:3, :3].T + frame[:3, 3]
            owners.append(name)
            lows.append(placed.min(axis=0))
            highs.append(placed.max(axis=0))
    if len(owners) <= _LEAST_OTHERS:
        return None
    low, high = np.array(lows), np.array(highs)
    return _Boxes(tuple(owners), low, high) if np.isfinite(low).all() and np.isfinite(high).all() else None


def _group_joints(model: Model, boxes: _Boxes) -> dict[bytes, list[Joint]]:
    """Group the joints by how they divide the shapes, those nearest to the root first in each group.

    A key has a byte for each shape: 1 where it is on the child's side. Joints that divide nothing are left out.
    """
    below = {name: np.array([owner == name for owner in boxes.owners]) for name in model.tree.order}
    for name in reversed(model.tree.order[1:]):
        below[model.tree.parent_joint[name].parent] |= below[name]
    groups: dict[bytes, list[Joint]] = {}
    for name in model.tree.order[1:]:
        if below[name].any() and not below[name].all():
            groups.setdefault(below[name].tobytes(), []).append(model.tree.parent_joint[name])
    return groups


def _get_mask(key: bytes) -> Bools:
    return np.frombuffer(key, dtype=bool)


def _measure_space(boxes: _Boxes, key: bytes) -> tuple[float, float]:
    inside = _get_mask(key)
    return boxes.measure_gap(inside), boxes.measure_size(inside)


def _is_touching(boxes: _Boxes, joint: Joint) -> bool:
    """Whether shapes of the two links of a joint have boxes that meet, as is the rule."""
    one, other = (np.array([owner == name for owner in boxes.owners]) for name in (joint.parent, joint.child))
    if not (one.any() and other.any()):
        return False
    return _measure_gap(boxes.low[one], boxes.high[one], boxes.low[other], boxes.high[other]) == 0.0


def _measure_gap(low: Array, high: Array, other_low: Array, other_high: Array) -> float:
    between = np.maximum(low[:, None] - other_high[None], other_low[None] - high[:, None])
    return float(np.sqrt((np.maximum(0.0, between) ** 2).sum(axis=2).min()))


def _is_part(model: Model, joints: Sequence[Joint]) -> bool:
    """Whether joints hold a part that should touch another: one has a range, none places something in a scene, and no
    program draws the part in another size or turned."""
    if not any(joint.type in {"revolute", "continuous", "prismatic"} for joint in joints):
        return False
    if any(joint.type in {"floating", "planar"} or SCENE.search(joint.parent) for joint in joints):
        return False
    links = [
        name for joint in joints for end in (joint.parent, joint.child) for name in model.tree.list_body_links(end)
    ]
    from urdfcheck.model.shapes.visual_solid import (  # few robots have a loose part
        has_unit_ambiguity,
        has_up_axis_ambiguity,
    )

    return not has_unit_ambiguity(model, links) and not has_up_axis_ambiguity(model, links)


def _touches_elsewhere(model: Model, boxes: _Boxes, joints: Sequence[Joint], *, inside: Bools, reach: float) -> bool:
    """Whether the part ``inside`` touches at another position of one of its joints."""
    names = {name for name, is_inside in zip(boxes.owners, inside, strict=True) if is_inside}
    corners = []
    for name in names:
        link, frame = model.link_by_name[name], model.frames[name]
        for shape in (*link.visuals, *link.collisions):
            points = None if is_dummy_shape(shape) else compute_shape_corners(model, shape)
            if points is not None:
                corners.append(points @ frame[:3, :3].T + frame[:3, 3])
    rest = boxes.low[~inside], boxes.high[~inside]
    for joint in joints:
        if joint.type == "fixed" or joint.name not in model.axes:
            continue
        place, axis = model.frames[joint.child][:3, 3], model.axes[joint.name]
        for value in np.linspace(*poses.get_sampling_range(joint), _POSITIONS):
            moved = [_move(points, joint, place=place, axis=axis, value=float(value)) for points in corners]
            low, high = (np.array([choose(points, axis=0) for points in moved]) for choose in (np.min, np.max))
            if _measure_gap(low, high, *rest) <= reach:
                return True
    return False


def _move(points: Array, joint: Joint, *, place: Array, axis: Array, value: float) -> Array:
    if joint.type == "prismatic":
        return points + value * axis
    away = points - place
    turned: Array = (
        away * np.cos(value)
        + np.cross(axis, away) * np.sin(value)
        + np.outer(away @ axis, axis) * (1.0 - np.cos(value))
    )
    return turned + place


def _find_change(
    model: Model, joints: Sequence[Joint], gap: float, *, touches: Callable[[Array], bool]
) -> OriginChange | None:
    """Find the change after which the part touches; of two decimal places and more only where nothing else does it.

    Any other change after which it touches, however deep the part goes into others, leaves open what happened.
    """
    for list_changes in (_iter_likely_changes, _iter_unlikely_changes):
        found = [
            (change, float(np.linalg.norm(way)))
            for joint in joints
            for change in list_changes(joint)
            for way in (np.array(change.xyz) - np.array(joint.origin.xyz),)
            if touches(model.frames[joint.parent][:3, :3] @ way)
        ]
        if found:
            change, length = found[0]
            is_likely = gap >= _FREE[change.kind] * length and (
                change.kind in {"sign", "swap"} or _is_long(model, change)
            )
            return change if len(found) == 1 and is_likely else None
    return None


def _is_long(model: Model, change: OriginChange) -> bool:
    """Whether the origin is so much longer than all others that its decimal point may have slipped."""
    lengths = measure_origin_lengths(model)
    name = change.joint.name
    return lengths[name] >= _LONGER * max((length for other, length in lengths.items() if other != name), default=0.0)


def _iter_likely_changes(joint: Joint) -> Iterator[OriginChange]:
    yield from _iter_scaled(joint, _LIKELY)
    xyz = joint.origin.xyz
    if xyz is None:
        return
    for one, other in combinations(range(3), 2):
        if abs(xyz[one] - xyz[other]) > _ZERO:
            swapped = list(xyz)
            swapped[one], swapped[other] = xyz[other], xyz[one]
            yield OriginChange(joint=joint, kind="swap", axes=(one, other), xyz=tuple(swapped))


def _iter_unlikely_changes(joint: Joint) -> Iterator[OriginChange]:
    yield from _iter_scaled(joint, _UNLIKELY)


def _iter_scaled(joint: Joint, factors: dict[str, float]) -> Iterator[OriginChange]:
    for axis, coordinate in enumerate(joint.origin.xyz or ()):
        for kind, factor in factors.items():
            if abs(coordinate) > _ZERO:
                changed = list(joint.origin.xyz or ())
                changed[axis] = coordinate * factor
                yield OriginChange(joint=joint, kind=kind, axes=(axis,), xyz=tuple(changed))
