"""Joints whose limits drive the child into the parts that hold it, while the same limits the other way round do not."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.motion.kinematics import compute_joint_motions
from urdfcheck.model.motion import poses
from urdfcheck.model.motion.axes.bodies import DrawnBodies
from urdfcheck.model.motion.collisions.setup import make_colliders
from urdfcheck.model.parts import Joint

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array
    from urdfcheck.facts.motion.collision import Colliders

# Robots with more triangles are not swept.
_MOST_FACES = 600_000
# Limits are one-sided if their middle is so far from zero, as a share of the range, and one side is longer by this angle (rad).
_LEAST_SHARE, _LEAST_EXCESS = 0.125, 0.3
# Positions on either side.
_STEPS = 6
# The one that is tried first.
_FIRST = [4]
# Contacts that are counted at most, for each two shapes; and at first.
_MOST_CONTACTS, _FEW_CONTACTS = 500, 150
# Parts run into each other if triangles cross at so many places on average, and so many times as often as on the other side.
_LEAST_CONTACTS, _RATIO = 45.0, 3.0
# A part runs into another one beyond the joint at so many of the positions on one side, and at none on the other; and triangles
# cross at so many places in one of them: less is a touch.
_LEAST_HITS, _LEAST_CROSSINGS = 2, 15


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class BlockedSide:
    """A joint that is blocked on the side that its limits open, and free on the other."""

    joint: str
    by_parent: bool
    """Whether the child runs into the part that holds it."""
    by_others: str
    """The body above the parent that a part behind the joint runs into; empty if none."""
    declared: float
    """The far end of the declared range (rad)."""
    contacts: tuple[float, float]
    """Where triangles of child and parent cross, on average: on the declared side and on the other."""
    hits: int
    """Positions of `_STEPS` at which a part above the parent is met."""


def find_blocked_sides(bodies: DrawnBodies) -> list[BlockedSide]:
    """Find the revolute joints with one-sided limits that fit the other side.

    :raises FactUnavailableError: when coal is not installed, the tree is broken, or an origin or an axis is malformed.
    """
    model = bodies.model
    sides = {
        joint: found
        for joint in (model.tree.parent_joint[name] for name in model.tree.order[1:])
        if (found := get_open_sides(joint)) is not None
    }
    if not sides or len(bodies.shapes) < 2 or bodies.count_faces() > _MOST_FACES:
        return []
    sweep = Sweep(bodies)
    compared = [sweep.compare_sides(joint, side) for joint, side in sides.items()]
    return [blocked for blocked in compared if blocked is not None]


def get_open_sides(joint: Joint) -> tuple[float, float] | None:
    """Return where the declared range leaves the mirrored one, and its far end (rad, with their sign).

    None for a joint without one-sided limits around zero.
    """
    if joint.type != "revolute" or joint.limit is None or joint.mimic is not None or joint.axis is None:
        return None
    lower, upper = joint.get_limit_value("lower"), joint.get_limit_value("upper")
    if lower is None or upper is None or not lower <= 0.0 <= upper or not lower < upper:
        return None
    near, far = sorted((-lower, upper))
    if far - near < max(2 * _LEAST_SHARE * (upper - lower), _LEAST_EXCESS) or near > math.pi or not any(joint.axis):
        return None
    sign = 1.0 if upper == far else -1.0
    return sign * near, sign * min(far, poses.TURN)


class Sweep:
    """The bodies in coal."""

    def __init__(self, bodies: DrawnBodies) -> None:
        self._bodies = bodies
        self._heads = list(bodies.shapes)
        self._number = {head: number for number, head in enumerate(self._heads)}
        placed = [one for shapes in bodies.placed.values() for one in shapes]
        self._colliders: Colliders = make_colliders(placed)
        # Shapes are placed in root coordinates: at rest, no body moves.
        self._rest = np.repeat(np.eye(4)[None], len(self._heads), axis=0)

    def compare_sides(self, joint: Joint, sides: tuple[float, float]) -> BlockedSide | None:
        """Compare what a joint meets on the side that its limits open and on the other.

        :param sides: where the declared range leaves the mirrored one, and its far end (rad).
        """
        below = self._bodies.list_below(joint)
        parent = self._bodies.get_parent(joint)
        if not below or joint.name not in self._bodies.model.axes:
            return None
        values = np.linspace(sides[0], sides[1], _STEPS + 1)[1:]
        # Most joints end here, after one position on either side.
        first, hit, _ = self._measure(joint, values[_FIRST], parent=parent, below=below, most=_FEW_CONTACTS)
        if not hit:
            if first < _LEAST_CONTACTS / 2:
                return None
            other, _, _ = self._measure(joint, -values[_FIRST], parent=parent, below=below, most=_FEW_CONTACTS)
            if other > first / 2:
                return None
        contacts, hits, met = self._measure(joint, values, parent=parent, below=below)
        into_parent, into_others = contacts >= _LEAST_CONTACTS, len(hits) >= _LEAST_HITS
        if not (into_parent or into_others):
            return None
        back, back_hits, _ = self._measure(joint, -values, parent=parent, below=below)
        by_parent = into_parent and contacts >= _RATIO * max(back, _LEAST_CONTACTS / _RATIO)
        by_others = into_others and not back_hits
        denied = (back >= _LEAST_CONTACTS and back >= _RATIO * contacts) or (back_hits and not hits)
        if denied or not (by_parent or by_others):
            return None
        return BlockedSide(
            joint=joint.name,
            by_parent=by_parent,
            by_others=met if by_others else "",
            declared=float(values[-1]),
            contacts=(contacts, back),
            hits=len(hits) if by_others else 0,
        )

    def _measure(
        self, joint: Joint, values: Array, *, parent: str, below: list[str], most: int = _MOST_CONTACTS
    ) -> tuple[float, set[int], str]:
        """Count the contacts of child and parent, on average over some positions; and list the positions in which a part that
        the joint moves meets one above the parent (or a part behind the child meets the parent), with the first such part."""
        frames = self._place(joint, values, below)
        contacts = 0.0
        if parent in self._number and joint.child in self._number:
            pair = self._number[parent], self._number[joint.child]
            contacts = float(np.mean([self._colliders.count_contacts(one, *pair, most) for one in frames]))
        above = self._bodies.list_above(joint)
        pairs = [(a, b) for a in above for b in below]
        pairs += [(parent, b) for b in below if b != joint.child and parent in self._number]
        if not pairs:
            return contacts, set(), ""
        numbers = np.array([[self._number[a], self._number[b]] for a, b in pairs])
        at_rest = self._colliders.detect_collisions(self._rest[None], numbers)[:, 0]
        found = self._colliders.detect_collisions(frames, numbers[~at_rest])
        tested = [pair for pair, met in zip(pairs, at_rest, strict=True) if not met]
        hits: set[int] = set()
        first = ""
        for (a, b), row in zip(tested, found, strict=True):
            steps = np.flatnonzero(row)
            if len(steps) and self._crosses(frames[steps], self._number[a], self._number[b]):
                hits.update(steps.tolist())
                first = first or a
        return contacts, hits, first

    def _crosses(self, frames: Array, one: int, other: int) -> bool:
        """Whether two bodies do more than touch in one of the placements."""
        return any(
            self._colliders.count_contacts(frame, one, other, _LEAST_CROSSINGS) >= _LEAST_CROSSINGS for frame in frames
        )

    def _place(self, joint: Joint, values: Array, below: list[str]) -> Array:
        """Place the bodies (N, B, 4, 4) where the joint alone is at some values (N,)."""
        frame = self._bodies.model.frames[joint.child]
        motions = compute_joint_motions(poses.normalize_axis(joint), values, rotates=True)
        frames = np.repeat(self._rest[None], len(values), axis=0)
        frames[:, [self._number[head] for head in below]] = (frame @ motions @ np.linalg.inv(frame))[:, None]
        return frames
