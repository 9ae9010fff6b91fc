"""The one pair of left and right joints whose frames are rotated relative to each other, while those of no other pair are."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.likeness.symmetry import is_axis_renaming, measure_rotation_angle
from urdfcheck.model.likeness.mirror_pairs import MirrorPair
from urdfcheck.model.likeness.mirrored_joints import TURNING
from urdfcheck.model.likeness.odd_limbs import is_slip_of_angle, places_something
from urdfcheck.model.likeness.origin_slips import find_carrying_joints
from urdfcheck.model.likeness.shape_comparison import ALIKE
from urdfcheck.model.parts import Joint
from urdfcheck.model.repairs.rpy_text import find_nearest_rpy, has_round_angles
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# So many other pairs have frames that are mirror images apart from the choice of axes; one is enough if only one side has round
# angles.
_WITNESSES = 2
# Smaller turns (rad) are those of two exports.
_LEAST = math.radians(1)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LoneTurn:
    """A joint that is rotated relative to the mirror image of its twin, in the same place."""

    joint: Joint
    twin: Joint
    angle: float
    """Radians."""
    expected: Sequence[float]
    """The rpy of ``joint`` if ``twin`` is right."""
    twin_expected: Sequence[float]
    """The rpy of ``twin`` if ``joint`` is right."""
    is_decided: bool
    """Whether only ``twin`` has round angles."""


def iter_lone_turns(model: Model, pairs: Sequence[MirrorPair]) -> Iterator[LoneTurn]:
    """Yield the pair of left and right joints whose frames are rotated relative to each other, if it is the only one.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    named = [pair for pair in pairs if pair.is_named]
    alike = [pair for pair in named if is_axis_renaming(pair.linear)]
    turned = [pair for pair in named if measure_rotation_angle(np.rint(pair.linear), pair.linear) > _LEAST]
    first = next((pair for pair in turned if all(other.is_attached_to(pair) for other in turned)), None)
    if first is None or any(other.is_attached_to(first) for other in alike):
        return  # it is the way of this robot, or the next joints turn back
    found = _find_turn(model, first, pairs)
    if found is not None and len(alike) >= (1 if found.is_decided else _WITNESSES):
        yield found


def _find_turn(model: Model, pair: MirrorPair, known_pairs: Sequence[MirrorPair]) -> LoneTurn | None:
    joints = find_carrying_joints(model, pair)
    if joints is None or not pair.is_in_place or not all(places_something(model, joint) for joint in joints):
        return None
    parents = {joint.parent for joint in joints}
    if len(parents) == 2 and not any({known.one, known.other} == parents for known in known_pairs):
        return None
    is_drawn_mirrored = pair.mirror_mismatch is not None and pair.mirror_mismatch < ALIKE
    if is_drawn_mirrored or pair.is_alike is False:
        return None  # the frame is a choice, or the parts are not twins
    choice = np.rint(pair.linear)
    away = choice.T @ pair.linear
    if not is_axis_renaming(choice) or not is_slip_of_angle(away, least=_LEAST) or _is_of_zero(joints[0], away):
        return None
    one, other = joints
    mirror, frames = pair.plane.linear, model.frames
    # What is left of the turn in the frame of each parent.
    needed = (
        _find_rpy(frames[one.parent][:3, :3].T @ mirror @ frames[other.child][:3, :3] @ choice, one),
        _find_rpy(frames[other.parent][:3, :3].T @ mirror @ frames[one.child][:3, :3] @ choice.T, other),
    )
    are_round = [has_round_angles(joint.origin.rpy or (0.0, 0.0, 0.0)) for joint in joints]
    wrong = 0 if are_round == [False, True] else 1
    return LoneTurn(
        joint=joints[wrong],
        twin=joints[1 - wrong],
        angle=measure_rotation_angle(choice, pair.linear),
        expected=needed[wrong],
        twin_expected=needed[1 - wrong],
        is_decided=are_round[0] != are_round[1],
    )


def _find_rpy(rotation: Array, joint: Joint) -> list[float]:
    return find_nearest_rpy(rotation, joint.origin.rpy)


def _is_of_zero(joint: Joint, away: Array) -> bool:
    """Whether a rotation (3, 3) is about the axis of a hinge: another zero, which SYM001 compares with all like joints."""
    axis = np.array(joint.axis or (1.0, 0.0, 0.0))
    return joint.type in TURNING and bool(np.linalg.norm(away @ axis - axis) < math.sin(_LEAST) * np.linalg.norm(axis))
