"""How far a robot reaches as its joints and shapes say, without any mesh: no mass of it is many times farther away."""

from __future__ import annotations

import math

from urdfcheck.core import FactUnavailableError
from urdfcheck.facts.small_matrices import Vector
from urdfcheck.model.fact import fact
from urdfcheck.model.parts import Joint, Shape
from urdfcheck.model.robot import Model
from urdfcheck.model.tree import Tree

# Fewer joints that are apart do not say how large a robot is: a mast may stand on a small base.
LEAST_JOINTS = 3
# Meshes that cannot be read make no robot so many times longer than its joints (chosen).
_LONGEST_MESH = 10.0


@fact
def measure_reach(model: Model, *, with_shapes: bool, with_unread: bool = True) -> float | None:
    """Measure the length (m) of the robot stretched out: the longest path along its joints' origins and the travel of prismatic
    joints, ``with_shapes`` from a shape that is known to another one, ``with_unread`` also from the origins of the others.

    None where too few joints are apart to say so. No two points that the file places are farther apart in any configuration, but
    meshes that cannot be read reach farther than their own origins.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    return _measure_longest_path(model, model.tree, with_shapes=with_shapes, with_unread=with_unread)


def _measure_longest_path(model: Model, tree: Tree, *, with_shapes: bool, with_unread: bool = True) -> float | None:
    farthest: dict[str, float] = {}  # from each link's frame, downwards
    longest, apart = 0.0, 0
    for name in reversed(tree.order):
        apart += sum(_measure_joint(joint) > 0.0 for joint in tree.child_joints[name])
        ends = [_measure_shapes(model, name, with_unread=with_unread) if with_shapes else 0.0]
        ends += [_measure_joint(joint) + farthest[joint.child] for joint in tree.child_joints[name]]
        ends.sort(reverse=True)
        farthest[name] = ends[0]
        longest = max(longest, sum(ends[:2]))
    return longest if apart >= LEAST_JOINTS else None


def is_beyond_reach(model: Model, distance: float) -> bool:
    """Whether a distance (m) is longer than the robot, or than the longest of its pieces: no stand is so large."""
    try:
        reach = measure_reach(model, with_shapes=True)
    except FactUnavailableError:
        reach = _measure_longest_path(model, model.pieces, with_shapes=True)
    return reach is not None and distance > reach * (1.0 if is_all_known(model) else _LONGEST_MESH)


@fact
def is_all_known(model: Model) -> bool:
    """Whether the size of every shape is known: a mesh that is missing, or that cannot be read, may reach anywhere."""
    from urdfcheck.model.shapes.corners import has_known_shapes  # loads numpy

    return all(has_known_shapes(model, link) for link in model.links)


def has_placed_frame(model: Model, link: str) -> bool:
    """Whether a joint of the link's rigid body is away from its parent's frame: otherwise all frames may be in one place, as in
    an export in the coordinates of an assembly, and parts and COMs are away from them.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    tree = model.tree
    body = tree.list_body_links(link)
    joints = [joint for name in body for joint in tree.child_joints[name]]
    before = tree.parent_joint.get(body[0])
    return any(any(_read_place(joint)) for joint in (*joints, *([before] if before else [])))


def measure_own_size(model: Model, link: str) -> float:
    """Measure the distance (m) from a link's frame to the farthest thing that the file places on its rigid body: a joint, a link
    fixed to it, a shape.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    tree, placements = model.tree, model.placements
    size = 0.0
    for name in tree.list_body_links(link):
        distance = math.dist(placements[link].place, placements[name].place)
        size = max(size, distance + _measure_shapes(model, name))
        for joint in tree.child_joints[name]:
            size = max(size, distance + _measure_joint(joint))
    return size


def _measure_joint(joint: Joint) -> float:
    """Measure how far a joint can take its child's frame from its parent's (m)."""
    travel = 0.0
    if joint.type == "prismatic":
        limits = [joint.get_limit_value(side) or 0.0 for side in ("lower", "upper")]
        travel = max(map(abs, limits))
    return math.hypot(*_read_place(joint)) + travel


def _read_place(joint: Joint) -> Vector:
    """Return the origin of a joint, in m."""
    placement = joint.origin.placement
    if placement is None:
        raise FactUnavailableError(f"the origin of joint {joint.name} is malformed (XML007)")
    return placement.place


def _measure_shapes(model: Model, name: str, *, with_unread: bool = True) -> float:
    """Measure how far the shapes of a link reach from its frame (m): those that cannot be read to their own origin at least."""
    link = model.link_by_name[name]
    farthest = 0.0
    for shape in (*link.visuals, *link.collisions):
        reach, placement = _measure_shape(model, shape), shape.origin.placement
        if reach is None and placement is not None and with_unread:
            reach = math.hypot(*placement.place)
        farthest = max(farthest, reach or 0.0)
    return farthest


def _measure_shape(model: Model, shape: Shape) -> float | None:
    """Measure how far a shape reaches from its link's frame (m); None where it is not known."""
    if shape.kind == "mesh" and model.meshes.get_facts(shape) is None:
        return None
    import numpy as np

    from urdfcheck.model.shapes.corners import compute_shape_corners

    # A program that ignores COLLADA's unit sees another size: the larger one counts.
    known = [c for unit in (True, False) if (c := compute_shape_corners(model, shape, apply_unit=unit)) is not None]
    return max((float(np.linalg.norm(c, axis=1).max(initial=0.0)) for c in known), default=None)
