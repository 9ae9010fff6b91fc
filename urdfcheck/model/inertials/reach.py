"""How far a robot reaches as its joints and shapes say, without any mesh: no mass of it is many times farther away."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.model.fact import fact
from urdfcheck.model.parts import Joint
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.corners import compute_shape_corners

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


# Fewer joints that are apart do not say how large a robot is: a mast may stand on a small base.
LEAST_JOINTS = 3


@fact
def measure_reach(model: Model, *, with_shapes: bool) -> float | None:
    """Measure the length (m) of the robot stretched out: the longest path along its joints' origins and the travel of prismatic
    joints, ``with_shapes`` from a shape that is known to another one; None where too few joints are apart to say so.

    No two points that the file places are farther apart in any configuration, shapes that cannot be read aside.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    tree = model.tree
    farthest: dict[str, float] = {}  # from each link's frame, downwards
    longest, apart = 0.0, 0
    for name in reversed(tree.order):
        apart += sum(_measure_joint(joint) > 0.0 for joint in tree.child_joints[name])
        ends = [_measure_shapes(model, name) if with_shapes else 0.0]
        ends += [_measure_joint(joint) + farthest[joint.child] for joint in tree.child_joints[name]]
        ends.sort(reverse=True)
        farthest[name] = ends[0]
        longest = max(longest, sum(ends[:2]))
    return longest if apart >= LEAST_JOINTS else None


def is_beyond_reach(model: Model, distance: float) -> bool:
    """Whether a distance (m) is longer than the robot: no stand is so large."""
    reach = measure_reach(model, with_shapes=True)
    return reach is not None and distance > reach


def measure_own_size(model: Model, link: str) -> float:
    """Measure the distance (m) from a link's frame to the farthest thing that the file places on its rigid body: a joint, a link
    fixed to it, a shape.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    tree, frames = model.tree, model.frames
    here = np.linalg.inv(frames[link])
    size = 0.0
    for name in tree.list_body_links(link):
        place = here @ frames[name]
        distance = float(np.linalg.norm(place[:3, 3]))
        size = max(size, distance + _measure_shapes(model, name))
        for joint in tree.child_joints[name]:
            size = max(size, distance + _measure_joint(joint))
    return size


def _measure_joint(joint: Joint) -> float:
    """Measure how far a joint can take its child's frame from its parent's (m)."""
    matrix = joint.origin.matrix
    if matrix is None:
        raise FactUnavailableError(f"the origin of joint {joint.name} is malformed (XML007)")
    travel = 0.0
    if joint.type == "prismatic":
        limits = [joint.get_limit_value(side) or 0.0 for side in ("lower", "upper")]
        travel = max(map(abs, limits))
    return float(np.linalg.norm(matrix[:3, 3])) + travel


def _measure_shapes(model: Model, name: str) -> float:
    """Measure how far the shapes of a link that can be read reach from its frame (m)."""
    link = model.link_by_name[name]
    corners: list[Array] = []
    for shape in (*link.visuals, *link.collisions):
        # A program that ignores COLLADA's unit sees another size: the larger one counts.
        corners += [
            c for unit in (True, False) if (c := compute_shape_corners(model, shape, apply_unit=unit)) is not None
        ]
    return max((float(np.linalg.norm(c, axis=1).max(initial=0.0)) for c in corners), default=0.0)
