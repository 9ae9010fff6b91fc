"""The one of four and more like limbs whose joint has another axis, origin or angle than the others have."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.motion.kinematics import matrix_to_rpy, rpy_to_matrix
from urdfcheck.model.likeness.origin_slips import is_of_other_kind, is_taken_back
from urdfcheck.model.likeness.shape_comparison import is_alike
from urdfcheck.model.likeness.side_names import remove_places
from urdfcheck.model.parts import Joint
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# Of so many limbs three agree.
_MOST_OF = 4
# Numbers agree within this share of a length, three typed digits, and within 1 mm; angles within what 1.57 leaves of π/2.
_SAME, _NEAR, _ANGLE = 0.005, 1e-3, 2e-3
# A turn is a slip from here on, and an arrangement where it is a multiple of 15° to within 0.06°.
_LEAST_TURN, _STEP, _ROUND = math.radians(0.5), math.radians(15), math.radians(0.06)
# Ranges of like joints agree within this share.
_RANGE = 0.05
# Joints around a middle are as far from it to within this share, and evenly spaced to within this angle (rad); three make a ring.
_ROUND_RING, _EVEN, _LEAST_RING = 0.01, math.radians(1), 3
# An axis of a ring is odd beyond this angle (rad): fingers may be set at slightly different ones (chosen).
_OFF_RING = math.radians(2)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class OddNumbers:
    """A joint of which one attribute differs from that of all joints like it, which is the same for them."""

    joint: Joint
    others: tuple[Joint, ...]
    attribute: Literal["axis", "xyz", "rpy"]
    expected: Array
    """(3,) What the others have, with the signs of this joint's side."""
    kind: Literal["odd", "spoke", "ring"] = "odd"
    """``spoke``: all hang at one place of one link, and one angle differs from joint to joint. ``ring``: they are spaced evenly
    around a middle, and the axes of the others are rotated about it as their places are."""


def iter_odd_numbers(model: Model) -> Iterator[OddNumbers]:
    """Yield joints of which one attribute is unlike that of three and more like joints, those nearest to the root first.

    Names of joints or of their links differ in places (``FL_knee``, ``HR_knee``), or on one parent in numbers also. Everything
    else that is typed of the origins and axes agrees, apart from the signs of the sides. Nothing else explains an odd one: legs
    that bend the other way come in pairs.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    groups: dict[object, list[Joint]] = {}
    for name in model.tree.order[1:]:
        joint = model.tree.parent_joint[name]
        if joint.mimic is not None or joint.origin.xyz is None or joint.origin.rpy is None:
            continue
        # Exporters number joints, whatever they carry: then the names of the links say what is alike.
        for of_link, words in enumerate((remove_places(joint.name), remove_places(name))):
            groups.setdefault((joint.type, of_link, words), []).append(joint)
            stripped = tuple(word for word in words if not word.isdigit())
            if stripped != words:
                groups.setdefault((joint.type, of_link, stripped, joint.parent), []).append(joint)
    # Some models have joints only.
    is_bare = not any(link.visuals or link.collisions or link.inertial is not None for link in model.links)
    for group in {tuple(joint.name for joint in group): group for group in groups.values()}.values():
        if len(group) >= _MOST_OF and (
            group[0].is_movable or is_bare or all(places_something(model, j) for j in group)
        ):
            yield from _find_odd_numbers(model, group)
            yield from _find_odd_spoke(model, group)
        if group[0].has_axis:
            yield from _find_odd_in_ring(model, group)


def places_something(model: Model, joint: Joint) -> bool:
    """Whether a link behind a joint has a shape or a mass: a fixed frame that carries nothing may be anywhere."""
    link = model.link_by_name[joint.child]
    own = bool(link.visuals or link.collisions or link.inertial is not None)
    return own or any(places_something(model, below) for below in model.tree.child_joints[joint.child])


def _find_odd_numbers(model: Model, group: Sequence[Joint]) -> Iterator[OddNumbers]:
    places = np.array([joint.origin.xyz for joint in group], dtype=float)
    turns = np.array([matrix[:3, :3] for joint in group if (matrix := joint.origin.matrix) is not None])
    axes = np.array([joint.axis or (0.0, 0.0, 0.0) for joint in group], dtype=float)
    if len(turns) != len(group):
        return
    odd_place, odd_turn = _find_odd_place(places), _find_odd_turn(turns)
    odd_axis = _find_odd_vector(axes) if group[0].has_axis else None
    # Axes of two sides have two signs: then the odd line is that of the odd one.
    odd_line = _find_odd_vector(np.abs(axes)) if odd_axis is None else None
    odd = [index for index in (odd_place, odd_turn, odd_axis, odd_line) if index is not None]
    rest = (np.abs(places), turns.reshape(len(group), 9), np.abs(axes))
    # A joint with two attributes of its own is arranged otherwise.
    single = {index for index in odd if odd.count(index) == 1}
    if not odd or not all(_agree(values, odd) for values in rest):
        return
    found: tuple[tuple[int | None, Literal["axis", "xyz", "rpy"]], ...] = (
        (odd_place, "xyz"), (odd_turn, "rpy"), (odd_axis, "axis"),
    )  # fmt: skip
    for index, attribute in found:
        if index is None or index not in single:
            continue
        like = next(i for i in range(len(group)) if i not in odd)
        others = tuple(other for i, other in enumerate(group) if i != index)
        if is_of_other_kind(group[index], others) or is_alike(model, group[index].child, group[like].child) is False:
            continue
        if _is_named_otherwise(group[index], others):
            continue
        if attribute == "xyz" and is_taken_back(model, group[index], group[like]):
            continue
        if attribute == "xyz" and not _is_sign_slip(places, index, like):
            expected = _restore_signs(places, index)
        elif attribute == "rpy" and is_slip_of_angle(turns[like].T @ turns[index]):
            expected = np.array(matrix_to_rpy(turns[like]))
        elif attribute == "axis" and _is_odd_axis(model, group, index, places):
            expected = axes[like]
        else:
            continue
        yield OddNumbers(joint=group[index], others=others, attribute=attribute, expected=expected)


def _is_named_otherwise(joint: Joint, others: Sequence[Joint]) -> bool:
    """Whether a joint carries another thing than the others, by the names of the links: exporters number joints."""
    kinds = {_strip_numbers(other.child) for other in others}
    return len(kinds) == 1 and _strip_numbers(joint.child) not in kinds


def _strip_numbers(name: str) -> tuple[str, ...]:
    return tuple(word for word in remove_places(name) if not word.isdigit())


def _find_odd_spoke(model: Model, group: Sequence[Joint]) -> Iterator[OddNumbers]:
    """Yield the joint that is beside the point where all others of a hub are, or is rotated about another axis than they are.

    Arms that a multicopter has around its middle differ in their yaw only.
    """
    if len({joint.parent for joint in group}) > 1:
        return
    places, angles = (
        np.array([getattr(joint.origin, name) for joint in group], dtype=float) for name in ("xyz", "rpy")
    )
    spread = np.ptp(angles, axis=0) > _ANGLE
    index = _find_odd_vector(places)
    if (
        index is not None
        and int(spread.sum()) == 1
        and float(np.linalg.norm(places[index] - places[index - 1])) > _NEAR
    ):
        if not is_taken_back(model, group[index], group[index - 1]):
            yield _make_odd_spoke(group, index, "xyz", places[index - 1])
        return
    if np.ptp(places, axis=0).max() > _NEAR:
        return
    for index in range(len(group)):
        others = np.delete(angles, index, axis=0)
        free = np.ptp(others, axis=0) > _ANGLE
        needed = np.where(free, angles[index], others[0])
        away = rpy_to_matrix(needed).T @ rpy_to_matrix(angles[index])
        if int(free.sum()) == 1 and is_slip_of_angle(away):
            yield _make_odd_spoke(group, index, "rpy", needed)


def _make_odd_spoke(
    group: Sequence[Joint], index: int, attribute: Literal["xyz", "rpy"], expected: Array
) -> OddNumbers:
    others = (*group[:index], *group[index + 1 :])
    return OddNumbers(joint=group[index], others=others, attribute=attribute, expected=expected, kind="spoke")


def _find_odd_in_ring(model: Model, group: Sequence[Joint]) -> Iterator[OddNumbers]:
    """Yield the joint of a ring whose axis is not rotated about its middle as those of the others are: fingers of a gripper,
    wheels of a base that drives to all sides."""
    frames = [joint.origin.matrix for joint in group]
    if len(group) < _LEAST_RING or len({joint.parent for joint in group}) > 1 or any(frame is None for frame in frames):
        return
    known = np.array(frames)
    bases = _build_ring_frames(known[:, :3, 3])
    axes = np.array([joint.axis or (0.0, 0.0, 0.0) for joint in group])
    if bases is None or not axes.any(axis=1).all():
        return
    axes = axes / np.linalg.norm(axes, axis=1)[:, None]
    # Each axis outwards, around and along the normal of the ring.
    inner = np.einsum("nji,njk,nk->ni", bases, known[:, :3, :3], axes)
    index = _find_odd_vector(inner)
    if index is None or float(abs(inner[index] @ inner[index - 1])) > math.cos(_OFF_RING):
        return
    others = (*group[:index], *group[index + 1 :])
    if is_of_other_kind(group[index], others) or is_alike(model, group[index].child, group[index - 1].child) is False:
        return
    expected = known[index, :3, :3].T @ bases[index] @ inner[index - 1]
    yield OddNumbers(joint=group[index], others=others, attribute="axis", expected=expected, kind="ring")


def _build_ring_frames(places: Array) -> Array | None:
    """Build the axes (n, 3, 3) outwards, around and along the normal at each of some places (n, 3) that are spaced evenly around
    their middle; None where they are not."""
    spokes = places - places.mean(axis=0)
    lengths = np.linalg.norm(spokes, axis=1)
    if float(lengths.min()) <= _NEAR or float(np.ptp(lengths)) > _ROUND_RING * float(lengths.max()):
        return None
    normal = np.linalg.svd(spokes)[2][2]
    normal = normal * (1.0 if float(normal[int(np.abs(normal).argmax())]) > 0 else -1.0)
    if float(np.abs(spokes @ normal).max()) > _ROUND_RING * float(lengths.max()):
        return None
    outwards = spokes / lengths[:, None]
    around = np.cross(normal, outwards)
    turns = np.sort(np.arctan2(outwards @ around[0], outwards @ outwards[0]))
    gaps = np.diff(np.append(turns, turns[0] + math.tau))
    if float(np.abs(gaps - math.tau / len(places)).max()) > _EVEN:
        return None
    return np.stack((outwards, around, np.broadcast_to(normal, outwards.shape)), axis=2)


def _agree(values: Array, odd: Sequence[int]) -> bool:
    """Whether all rows but some agree, two at least."""
    others = np.delete(values, odd, axis=0)
    return len(others) >= _MOST_OF - 2 and bool(
        np.abs(others - others[0]).max() <= max(_SAME * float(np.linalg.norm(others[0])), 1e-9)
    )


def _find_odd_vector(values: Array) -> int | None:
    """Return the only row (3,) that differs from the others, which are the same."""
    for index in range(len(values)):
        if _agree(values, [index]):
            like = values[index - 1]
            off = float(np.abs(values[index] - like).max())
            return index if off > max(_SAME * float(np.linalg.norm(like)), 1e-9) else None
    return None


def _find_odd_place(places: Array) -> int | None:
    """Return the only place (3,) whose distances along the axes differ from those of the others."""
    index = _find_odd_vector(np.abs(places))
    if index is None or np.linalg.norm(places[index - 1]) < _NEAR:
        return None
    return index if np.abs(np.abs(places[index]) - np.abs(places[index - 1])).max() > _NEAR else None


def _find_odd_turn(turns: Array) -> int | None:
    """Return the only rotation (3, 3) that differs from the others."""
    for index in range(len(turns)):
        others = np.delete(turns, index, axis=0)
        if np.abs(others - others[0]).max() <= _ANGLE:
            return index if np.abs(turns[index] - others[0]).max() > _ANGLE else None
    return None


def _is_sign_slip(places: Array, index: int, like: int) -> bool:
    """Whether a place differs in signs only."""
    return bool(np.abs(np.abs(places[index]) - np.abs(places[like])).max() <= _NEAR)


def _restore_signs(places: Array, index: int) -> Array:
    """Return what the others have, with the sign that all of them share, or else with that of the odd one."""
    others = np.delete(places, index, axis=0)
    signs = np.where(np.abs(np.sign(others).sum(axis=0)) == len(others), np.sign(others[0]), np.sign(places[index]))
    restored: Array = np.abs(others[0]) * signs
    return restored


def is_slip_of_angle(away: Array, *, least: float = _LEAST_TURN) -> bool:
    """Whether a rotation (3, 3) against the others is by an angle, greater than ``least`` (rad), that nobody chooses."""
    angle = math.acos(min(1.0, max(-1.0, (float(np.trace(away)) - 1.0) / 2.0)))
    return angle > least and abs(angle - round(angle / _STEP) * _STEP) > _ROUND


def _is_odd_axis(model: Model, group: Sequence[Joint], index: int, places: Array) -> bool:
    """Whether an axis cannot be meant: along another line than the parallel axes of the others, or reversed in a joint that is
    the same otherwise."""
    odd, like = group[index], group[index - 1]
    if odd.type == "continuous" or any(joint.name not in model.axes for joint in group):
        return False  # the axes of wheels have rules of their own
    lines = [model.axes[joint.name] for joint in group]
    along = [abs(float(lines[index - 1] @ line)) for line in lines]
    if all(share > 1 - _ANGLE for i, share in enumerate(along) if i != index) and along[index] < 0.99:
        return True
    is_same = bool(np.abs(places[index] - places[index - 1]).max() <= _NEAR)
    return is_same and _has_like_range(odd, like)


def _has_like_range(one: Joint, other: Joint) -> bool:
    """Whether two joints have the same range: one that is reversed has the negated range."""
    ranges = [(joint.get_limit_value("lower"), joint.get_limit_value("upper")) for joint in (one, other)]
    (a, b), (c, d) = ranges
    if a is None or b is None or c is None or d is None:
        return False
    return max(abs(a - c), abs(b - d)) <= _RANGE * max(b - a, d - c)
