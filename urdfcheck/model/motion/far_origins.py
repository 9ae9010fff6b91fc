"""Joints whose origins put their child far away from everything else: a unit of length or a decimal point was lost."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from urdfcheck.core import FactUnavailableError
from urdfcheck.core.records import dataclass
from urdfcheck.facts.small_matrices import subtract
from urdfcheck.model.inertials.reach import LEAST_JOINTS
from urdfcheck.model.parts import Joint, is_dummy_shape
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# Shorter origins (m) are zero.
_ZERO = 1e-6
# Parts that are apart by less than this share of the origin's length are where the origin puts them for a reason.
_OPEN = 0.5
# Without shapes: a part that reached so much of the way would have its COM there.
_NO_SHAFT = 0.75
# Names of a frame on the ground right below a robot.
_FOOTPRINT = re.compile(r"(?i)foot_?print")
# What hangs on an empty root without such a name may be so far away (m).
_SCENE_SIZE = 20.0
# Names of the root of a scene, on which robots and cameras stand wherever they are.
SCENE = re.compile(r"(?i)(^|_)(world|map|odom|earth|origin|ground|scene|utm|room|environment|floor|station)(_|$)")


@dataclass(frozen=True, slots=True, kw_only=True)
class FarThresholds:
    """From where on an origin cannot be meant."""

    drawn: float
    """Times the longest other origin, where the parts on both sides are known to be apart."""
    undrawn: float
    """The same, where they are not known."""
    least: float
    """Metres, of a joint that moves."""
    least_fixed: float
    """Metres, of a fixed joint, and of several joints at once."""
    apart: float
    """Times the sizes of the parts on both sides that the space between them is, where no other joint says how large the
    robot is."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class FarOrigin:
    """A joint whose origin is too long, all lengths in m."""

    joint: Joint
    length: float
    others: float | None
    """The longest origin of the other joints; None where it was judged by what is drawn alone."""
    gap: float | None
    """The space between what both sides draw; None where one of them draws nothing, or a shape is not known."""
    sizes: float
    """The sizes of what both sides draw, together."""
    _boxes: tuple[Array, Array] | None
    _turn: Array

    def measure_gap(self, place: Sequence[float]) -> float | None:
        """Measure the space between what both sides draw with the origin at another place (3,) in m; None where it is not
        known."""
        if self._boxes is None or self.joint.origin.xyz is None:
            return None
        parent, child = self._boxes
        return _measure_box_gap(parent, child + self._turn @ subtract(place, self.joint.origin.xyz))


@dataclass(frozen=True, slots=True, eq=False)
class _Side:
    """What a part of the tree places."""

    points: Array
    """(N, 3) in root coordinates: the corners of its shapes and its COMs."""
    is_drawn: bool
    """Whether it has shapes, and all of them are known."""
    is_empty: bool
    """Whether it has neither shapes nor masses."""

    @property
    def box(self) -> Array:
        import numpy as np

        return np.array((self.points.min(axis=0), self.points.max(axis=0)))


def find_far_origins(model: Model, limits: FarThresholds) -> list[FarOrigin]:
    """Find the joints whose origins are far longer than all others, or than all that both sides draw, in the order of the tree.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    lengths = measure_origin_lengths(model)
    suspects, others = _split_lengths(lengths, limits.drawn)
    if suspects:
        found = _confirm_by_others(model, lengths, suspects, others, limits)
        if found:
            return found
    huge = {name for name, length in lengths.items() if length >= 2 * limits.least_fixed}
    return _confirm_by_parts(model, lengths, huge, limits.apart) if huge else []


def measure_origin_lengths(model: Model) -> dict[str, float]:
    """Measure the distance of each joint of the tree from its parent's frame (m), by joint name in the order of the tree.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    lengths = {}
    for name in model.tree.order[1:]:
        joint = model.tree.parent_joint[name]
        placement = joint.origin.placement
        if placement is None:
            raise FactUnavailableError(f"the origin of joint {joint.name} is malformed (XML007)")
        lengths[joint.name] = math.hypot(*placement.place)
    return lengths


def _split_lengths(lengths: Mapping[str, float], times: float) -> tuple[set[str], float]:
    """Return the joints that are so many times longer than all others, and the longest of these others (m).

    None unless the others are as many as these, and enough to say how large the robot is.
    """
    ordered = sorted(((length, name) for name, length in lengths.items() if length > _ZERO), reverse=True)
    for count in range(1, len(ordered)):
        if len(ordered) - count < max(LEAST_JOINTS, count):
            break
        if ordered[count - 1][0] > times * ordered[count][0]:
            return {name for _, name in ordered[:count]}, ordered[count][0]
    return set(), 0.0


def _confirm_by_others(
    model: Model, lengths: Mapping[str, float], suspects: Collection[str], others: float, limits: FarThresholds
) -> list[FarOrigin]:
    sides = _cut_tree(model, suspects)
    found = []
    spared = [others]
    for joint in _iter_joints(model, suspects):
        length, parent, child = lengths[joint.name], sides[joint.parent], sides[joint.child]
        least = limits.least if joint.is_movable and len(suspects) == 1 else limits.least_fixed
        if length > limits.undrawn * others and parent.is_drawn and child.is_drawn:
            least = limits.least
        if parent.is_empty and not _FOOTPRINT.search(joint.parent):
            # Frames of a scene are where they are: robots, cameras, the frames of a map.
            least = math.inf if SCENE.search(joint.parent) else _SCENE_SIZE
        if length < least:
            if not parent.is_empty:
                spared.append(length)
            continue
        if child.is_empty and _has_suspects_below(model, joint.child, suspects):
            continue  # the next origin may lead back
        far = _measure(model, joint, length, parent, child, others=others)
        between = 0.0
        if len(parent.points) and len(child.points):
            between = _measure_box_gap(parent.box, child.box)
            if between < _OPEN * length:
                spared.append(length)
                continue
        # The COM of a long shaft, which may have short joints only, is in its middle. No shaft between joints is that long.
        is_shaft = not joint.is_movable or length < limits.least_fixed
        if is_shaft and not (len(parent.points) and len(child.points)) and _is_amid_joints(model, joint, lengths):
            is_shaft = False  # nor is any in an arm, of whose parts nothing says that one is a shaft
        if far.gap is None and is_shaft and length <= limits.undrawn * others and between < _NO_SHAFT * length:
            spared.append(length)
            continue
        found.append(far)
    # Long origins that are meant say how long those of this robot are.
    return [replace(far, others=max(spared)) for far in found if far.length > limits.drawn * max(spared)]


def _is_amid_joints(model: Model, joint: Joint, lengths: Mapping[str, float]) -> bool:
    """Whether a joint that moves is one of a chain: one that moves hangs on it, and there are enough others that are apart to say
    how long its parts are."""
    others = [one for one in model.joints if one.is_movable and one is not joint and lengths.get(one.name, 0.0) > _ZERO]
    carries = any(joint in model.tree.find_path_to(one.parent) for one in others)
    return joint.is_movable and carries and len(others) >= LEAST_JOINTS


def _confirm_by_parts(
    model: Model, lengths: Mapping[str, float], huge: Collection[str], apart: float
) -> list[FarOrigin]:
    sides = _cut_tree(model, huge)
    found = [
        _measure(model, joint, lengths[joint.name], sides[joint.parent], sides[joint.child], others=None)
        for joint in _iter_joints(model, huge)
        if not SCENE.search(joint.parent)
    ]
    return [far for far in found if far.gap is not None and far.gap > max(apart * far.sizes, _OPEN * far.length)]


def _measure(
    model: Model, joint: Joint, length: float, parent: _Side, child: _Side, *, others: float | None
) -> FarOrigin:
    boxes = (parent.box, child.box) if parent.is_drawn and child.is_drawn else None
    return FarOrigin(
        joint=joint,
        length=length,
        others=others,
        gap=None if boxes is None else _measure_box_gap(*boxes),
        sizes=0.0 if boxes is None else sum(math.dist(low, high) for low, high in boxes),
        _boxes=boxes,
        _turn=model.frames[joint.parent][:3, :3],
    )


def _iter_joints(model: Model, names: Collection[str]) -> Iterable[Joint]:
    joints = (model.tree.parent_joint[link] for link in model.tree.order[1:])
    return (joint for joint in joints if joint.name in names)


def _has_suspects_below(model: Model, link: str, suspects: Collection[str]) -> bool:
    """Whether a suspected joint hangs on a link, or on one behind it without another between."""
    return any(
        joint.name in suspects or _has_suspects_below(model, joint.child, suspects)
        for joint in model.tree.child_joints[link]
    )


def _cut_tree(model: Model, suspects: Collection[str]) -> dict[str, _Side]:
    """Cut the tree at the suspected joints; return by link what the part that it is in places."""
    heads: dict[str, str] = {}
    for name in model.tree.order:
        joint = model.tree.parent_joint.get(name)
        heads[name] = name if joint is None or joint.name in suspects else heads[joint.parent]
    members: dict[str, list[str]] = {}
    for name, head in heads.items():
        members.setdefault(head, []).append(name)
    sides = {head: _collect_side(model, names) for head, names in members.items()}
    return {name: sides[head] for name, head in heads.items()}


def _collect_side(model: Model, names: Iterable[str]) -> _Side:
    import numpy as np

    from urdfcheck.model.shapes.corners import compute_shape_corners

    parts: list[Array] = []
    unknown = has_shapes = has_mass = False
    for name in names:
        link, frame = model.link_by_name[name], model.frames[name]
        local: list[Array] = []
        for shape in (*link.visuals, *link.collisions):
            if is_dummy_shape(shape):
                continue
            has_shapes = True
            # Programs that ignore COLLADA's unit see another size: the space between has to be there for both.
            known = [c for u in (True, False) if (c := compute_shape_corners(model, shape, apply_unit=u)) is not None]
            unknown |= not known
            local += known
        if link.inertial is not None:
            has_mass = True
            if link.inertial.origin.xyz is not None:
                local.append(np.array(link.inertial.origin.xyz)[None])
        parts += [points @ frame[:3, :3].T + frame[:3, 3] for points in local]
    return _Side(
        points=np.concatenate(parts) if parts else np.zeros((0, 3)),
        is_drawn=has_shapes and not unknown,
        is_empty=not has_shapes and not has_mass,
    )


def _measure_box_gap(one: Array, other: Array) -> float:
    """Measure the space between two boxes (2, 3): least and greatest corner."""
    return math.hypot(*(max(0.0, *between) for between in zip(one[0] - other[1], other[0] - one[1], strict=True)))
