"""The joint whose child touches nothing, while the parts at all other joints of the robot touch."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.core.records import dataclass
from urdfcheck.facts.motion.collision_geometry import PlacedGeometry, compute_shape_box
from urdfcheck.facts.motion.gaps import Gaps, is_within, sample_vertices
from urdfcheck.model.motion import poses
from urdfcheck.model.motion.axes.bodies import DrawnBodies
from urdfcheck.model.parts import Joint
from urdfcheck.model.robot import Model
from urdfcheck.system.installation import describe_left_out

if TYPE_CHECKING:
    from collections.abc import Sequence

    from urdfcheck.facts.arrays import Array

# Robots with more triangles, or with more such joints, are not compared.
_MOST_FACES, _MOST_JOINTS = 1_000_000, 80
# Parts touch if the space between them is at most this share of the smaller one's diagonal.
_TOUCHING = 0.075
# A part is apart from this share of its own diagonal on, if so many other joints hold parts that touch; with fewer from the
# other share on.
_APART, _OTHERS, _FAR_APART = 0.15, 2, 0.35
# Shares of the range at which a slide may touch.
_POSITIONS = (0.0, 0.25, 0.5, 0.75, 1.0)
_MOVING = frozenset({"revolute", "continuous", "prismatic"})


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ApartPart:
    """A joint whose child touches nothing, with all joints at zero."""

    joint: str
    nearest: str
    """The body that is nearest to what the joint moves."""
    gap: float
    """The space between (m)."""
    size: float
    """The diagonal of the child (m)."""
    others: int
    """The other joints that hold parts, all of which touch."""


def find_apart_part(bodies: DrawnBodies) -> ApartPart | None:
    """Find the only joint that moves and whose child is apart from its parent and from everything else; None if several are.

    :raises FactUnavailableError: when coal is not installed, the tree is broken, or an origin or an axis is malformed.
    """
    model = bodies.model
    joints = [
        joint
        for joint in (model.tree.parent_joint[name] for name in model.tree.order[1:])
        if joint.type in _MOVING and joint.name in model.axes and _is_compared(bodies, joint)
    ]
    if not 2 <= len(joints) <= _MOST_JOINTS or bodies.count_faces() > _MOST_FACES:
        return None
    distances = _Distances(bodies)
    found: Joint | None = None
    for joint in joints:
        if not distances.is_touching(joint.child, bodies.get_parent(joint), _TOUCHING):
            if found is not None:
                return None
            found = joint
    if found is None:
        return None
    size = distances.measure_size(found.child)
    least = (_APART if len(joints) > _OTHERS else _FAR_APART) * size
    gap, nearest = distances.measure_to_rest(found)
    # What is not known may be what it touches. A part that no one draws in a robot that is drawn need not be one: a wheel between
    # the wheels, for a controller.
    if gap < least or not all(map(bodies.is_complete, model.tree.order)) or _is_only_collision(bodies, found.child):
        return None
    # A slide may leave its guide at zero; a bearing holds its part in every position.
    if found.type == "prismatic" and any(
        distances.measure_to_rest(found, value)[0] < least for value in _list_positions(found)
    ):
        return None
    return ApartPart(joint=found.name, nearest=nearest, gap=gap, size=size, others=len(joints) - 1)


def do_collisions_touch(model: Model, found: ApartPart) -> bool:
    """Whether what child and parent collide with touches, unlike what they draw: the drawing leaves out something, or is hollow.

    What draws only, as a sensor, is compared as it is drawn: within the box of a vehicle it is inside the vehicle.
    """
    bodies = DrawnBodies(model, ("collisions", "visuals"))
    joint = model.joint_by_name[found.joint]
    heads = joint.child, bodies.get_parent(joint)
    return all(head in bodies.shapes for head in heads) and _Distances(bodies).is_touching(*heads, _TOUCHING)


def _is_compared(bodies: DrawnBodies, joint: Joint) -> bool:
    """Whether it is known what child and parent draw."""
    if any(map(bodies.is_undrawn, (joint.parent, joint.child))):
        return False
    heads = joint.child, bodies.get_parent(joint)
    return all(head in bodies.shapes and bodies.is_complete(head) for head in heads)


def _is_only_collision(bodies: DrawnBodies, head: str) -> bool:
    """Whether a body is not drawn, and others are."""
    drawn = {name for name, shapes in bodies.shapes.items() if any(one.shape.role == "visual" for one in shapes)}
    return bool(drawn) and head not in drawn


def _list_positions(joint: Joint) -> list[float]:
    lower, upper = poses.get_sampling_range(joint)
    return [lower + share * (upper - lower) for share in _POSITIONS]


class _Distances:
    """Distances between the bodies of a robot."""

    def __init__(self, bodies: DrawnBodies) -> None:
        self._bodies = bodies
        self._points: dict[str, Array | None] = {}
        self._boxes: dict[str, tuple[Array, Array]] = {}
        self._spheres: dict[int, tuple[Array, float]] = {}
        self._gaps: Gaps | None = None

    def is_touching(self, one: str, other: str, share: float) -> bool:
        """Whether two bodies are nearer than a share of the smaller one's diagonal."""
        reach = share * self.measure_size(one, other)
        points = [self._sample(head) for head in (one, other)]
        # Vertices show most contacts, without coal.
        if points[0] is not None and points[1] is not None and is_within(points[0], points[1], reach):
            return True
        return self._measure(self._bodies.placed[one], self._bodies.placed[other], reach) <= reach

    def measure_size(self, *heads: str) -> float:
        """Measure the diagonal (m) of the box around the smaller one of some bodies."""
        return min(float(np.linalg.norm(high - low)) for low, high in map(self._get_box, heads))

    def measure_to_rest(self, joint: Joint, value: float = 0.0) -> tuple[float, str]:
        """Measure the space (m) between all that a joint moves and the rest, and name the nearest body of the rest."""
        motion = self._compute_motion(joint, value)
        below = self._bodies.list_below(joint)
        moved = [
            PlacedGeometry(one.geometry, one.owner, motion @ one.pose)
            for head in below
            for one in self._bodies.placed[head]
        ]
        best = np.inf, ""
        parent = self._bodies.get_parent(joint)
        rest = [head for head in self._bodies.placed if head not in below]
        for head in sorted(rest, key=lambda head: head != parent):
            gap = self._measure(moved, self._bodies.placed[head], best[0])
            if gap < best[0]:
                best = gap, head
        return best

    def _compute_motion(self, joint: Joint, value: float) -> Array:
        from urdfcheck.facts.motion.kinematics import compute_joint_motions

        frame = self._bodies.model.frames[joint.child]
        motions = compute_joint_motions(
            poses.normalize_axis(joint), np.array([value]), rotates=joint.type != "prismatic"
        )
        motion: Array = frame @ motions[0] @ np.linalg.inv(frame)
        return motion

    def _measure(self, ones: Sequence[PlacedGeometry], others: Sequence[PlacedGeometry], least: float) -> float:
        """Measure the least distance (m) between two sets of shapes; any larger one where it is more than ``least``."""
        best = np.inf
        for one in ones:
            for other in others:
                apart = self._bound_gap(one, other)
                if apart <= min(best, least):
                    best = min(best, self._meter.measure(one, other))
                else:
                    best = min(best, max(apart, least * (1 + 1e-9)))
        return float(best)

    @property
    def _meter(self) -> Gaps:
        if self._gaps is None:
            try:
                self._gaps = Gaps()
            except ImportError as error:
                raise FactUnavailableError(describe_left_out(error) or str(error)) from None
        return self._gaps

    def _sample(self, head: str) -> Array | None:
        if head not in self._points:
            some = [points for one in self._bodies.placed[head] if (points := sample_vertices(one)) is not None]
            self._points[head] = np.concatenate(some) if some else None
        return self._points[head]

    def _get_box(self, head: str) -> tuple[Array, Array]:
        """Return the least and the greatest corner (3,) of the box around a body."""
        if head not in self._boxes:
            corners = np.concatenate(
                [one.geometry.corners @ one.pose[:3, :3].T + one.pose[:3, 3] for one in self._bodies.placed[head]]
            )
            self._boxes[head] = corners.min(axis=0), corners.max(axis=0)
        return self._boxes[head]

    def _bound_gap(self, one: PlacedGeometry, other: PlacedGeometry) -> float:
        """Return a distance (m) that two shapes have at least: that of the spheres around them."""
        ends = []
        for placed in (one, other):
            key = id(placed.geometry)  # the bodies keep it
            if key not in self._spheres:
                middle, _, radius = compute_shape_box(placed.geometry)
                self._spheres[key] = middle, radius
            middle, radius = self._spheres[key]
            ends.append((placed.pose[:3, :3] @ middle + placed.pose[:3, 3], radius))
        return float(np.linalg.norm(ends[0][0] - ends[1][0])) - ends[0][1] - ends[1][1]
