"""A robot as a mechanism that a simulator can release on a plane."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.core.records import dataclass
from urdfcheck.facts.arrays import Array
from urdfcheck.facts.motion.simulation import (
    Follower,
    Geom,
    Mechanism,
    RigidBody,
    SimulatedJoint,
    compute_lowest_height,
)
from urdfcheck.model.motion import poses
from urdfcheck.model.motion.fixed_base import explain_fixed_base
from urdfcheck.model.motion.joint_loads import read_damping
from urdfcheck.model.parts import MOVING_TYPES, Joint, Link, Shape, is_dummy_shape
from urdfcheck.model.rigid_bodies import compute_body_inertia, is_point_mass, list_rigid_bodies
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.mesh_sizes import is_usable_shape
from urdfcheck.model.shapes.solids import compute_drawn_scale
from urdfcheck.source.text.values import read_attribute_number

# Published robots have up to a few hundred shapes that may touch the ground.
MOST_SHAPES = 2_000
# A flat mesh becomes a plate that extends this far (m) to either side.
_THIN = 1e-4
# Nothing whose size is known is smaller (m).
_SMALLEST = 1e-3


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class StandingRobot:
    """A robot on a plane at its lowest point, ready to be released in a simulator."""

    mechanism: Mechanism
    heads: tuple[str, ...]
    """The first link of each of its bodies."""
    joints: tuple[Joint | None, ...]
    """The joint on which each body hangs; None for a free root."""
    links: tuple[str, ...]
    """The link of each geom."""
    fixed_reason: str
    """Why the root cannot move; empty if it can."""
    uses_visuals: bool
    """Whether the geoms are what the robot draws, because it has no collision shapes."""
    unread: tuple[str, ...]
    """The links of which a shape could not be read and is left out: what is left may touch the ground elsewhere."""
    ground: float
    """Metres: the lowest point in the root's frame; of the frames of links where there is no geom."""
    size: float
    """Metres: the diagonal of the box around the geoms, or around the frames of links."""


def build_standing_robot(model: Model) -> StandingRobot:
    """Build the robot at its neutral pose (every joint at zero, or at the limit nearest to it).

    Shapes that cannot be read are left out. A robot whose base is fixed needs no ground, unless a body is loose.

    :raises FactUnavailableError: when the tree is broken, a body that moves has no mass or no inertia, nothing is left that could
        touch the ground, or the robot is too large.
    """
    tree = model.tree
    neutral = poses.make_neutral_configuration(model)
    poses.ensure_few_joints(neutral.joints)
    frames = {name: frame[0] for name, frame in poses.compute_frames(model, neutral).items()}
    fixed_reason = explain_fixed_base(model)
    bodies = [body for body in list_rigid_bodies(model) if body.is_movable or not fixed_reason]
    if not bodies or (fixed_reason and not any(body.is_movable for body in bodies)):
        raise FactUnavailableError("nothing of the robot can move")
    heads = tuple(body.links[0] for body in bodies)
    member = {name: index for index, body in enumerate(bodies) for name in body.links}
    joints = tuple(tree.parent_joint.get(head) for head in heads)
    is_held = bool(fixed_reason) and all(joint is None or joint.type != "floating" for joint in joints)
    shapes, unread, uses_visuals = _collect_contact_shapes(model, is_held=is_held)
    geoms = tuple(_make_geom(model, link, shape, member=member, heads=heads) for link, shape in shapes)
    placements = [frames[heads[geom.body]] if geom.body >= 0 else np.eye(4) for geom in geoms]
    low, high = _compute_extent(geoms, placements) if geoms else _compute_frame_extent(frames)
    values = neutral.to_values_by_name(0)
    return StandingRobot(
        mechanism=Mechanism(
            bodies=tuple(_make_body(model, body.links, member=member, heads=heads, values=values) for body in bodies),
            geoms=geoms,
            followers=tuple(_list_followers(joints)),
            grounded=bool(fixed_reason),
        ),
        heads=heads,
        joints=joints,
        links=tuple(link.name for link, _ in shapes),
        fixed_reason=fixed_reason,
        uses_visuals=uses_visuals,
        unread=unread,
        ground=float(low[2]),
        size=float(np.linalg.norm(high - low)),
    )


def _make_body(
    model: Model,
    links: tuple[str, ...],
    *,
    member: Mapping[str, int],
    heads: Sequence[str],
    values: Mapping[str, float],
) -> RigidBody:
    joint = model.tree.parent_joint.get(links[0])
    inertia = compute_body_inertia(model, links)
    if inertia is None or not inertia[0] > 0:
        raise FactUnavailableError(f"link {links[0]!r} moves and has no mass (INR001, INR002)")
    mass, com, tensor = inertia
    if len(links) == 1 and (inertial := model.link_by_name[links[0]].inertial) is not None and is_point_mass(inertial):
        raise FactUnavailableError(f"link {links[0]!r} moves and has no inertia (INR004)")
    frame = model.frames[links[0]]
    turn = frame[:3, :3]
    parent = -1 if joint is None else member.get(joint.parent, -1)
    above = model.frames[heads[parent]] if parent >= 0 else np.eye(4)
    return RigidBody(
        parent=parent,
        pose=np.linalg.inv(above) @ frame,
        joint=_make_simulated_joint(joint, values),
        mass=mass,
        com=turn.T @ (com - frame[:3, 3]),
        inertia=turn.T @ tensor @ turn,
    )


def _make_geom(model: Model, link: Link, shape: Shape, *, member: Mapping[str, int], heads: Sequence[str]) -> Geom:
    body, pose = member.get(link.name, -1), shape.origin.matrix
    assert pose is not None  # see _collect_contact_shapes
    head_frame = model.frames[heads[body]] if body >= 0 else np.eye(4)
    return Geom(
        body=body,
        kind="hull" if shape.kind == "mesh" else shape.kind or "",
        size=shape.size or (),
        pose=np.linalg.inv(head_frame) @ model.frames[link.name] @ pose,
        points=_compute_hull_points(model, shape),
    )


def _make_simulated_joint(joint: Joint | None, values: Mapping[str, float]) -> SimulatedJoint:
    if joint is None or joint.type == "floating":
        return SimulatedJoint(kind="floating", axis=np.array((0.0, 0.0, 1.0)))
    if joint.type not in MOVING_TYPES:
        raise FactUnavailableError(f"the type of joint {joint.name!r} is not known (KIN009)")
    if joint.axis is None or not any(joint.axis):
        raise FactUnavailableError(f"the axis of joint {joint.name!r} is zero or malformed (JNT001, XML007)")
    axis = poses.normalize_axis(joint)
    if joint.type == "planar":
        return SimulatedJoint(kind="planar", axis=axis)
    friction = read_attribute_number(joint.element.find_child("dynamics"), "friction") or 0.0
    return SimulatedJoint(
        kind="slide" if joint.type == "prismatic" else "hinge",
        axis=axis,
        range=_read_joint_range(joint),
        damping=read_damping(joint),
        friction=max(friction, 0.0),
        start_value=values[joint.name],
        effort=_get_holding_effort(joint),
    )


def _read_joint_range(joint: Joint) -> tuple[float, float] | None:
    """Read the limits as typed; None where there are none, or where they are not a range."""
    lower, upper = joint.get_limit_value("lower"), joint.get_limit_value("upper")
    if joint.type == "continuous" or lower is None or upper is None or not lower < upper:
        return None
    return lower, upper


def _get_holding_effort(joint: Joint) -> float | None:
    """Return the effort that holds a joint: its limit, infinite where that is zero (JNT007), None where it is not driven."""
    if not joint.is_driven:
        return None
    effort = joint.get_limit_value("effort")
    return effort if effort is not None and effort > 0 else np.inf


def _list_followers(joints: Sequence[Joint | None]) -> Iterator[Follower]:
    known = [(i, j) for i, j in enumerate(joints) if j is not None and j.type in poses.ONE_DEGREE_OF_FREEDOM]
    indices = {joint.name: index for index, joint in known}
    for index, joint in known:
        leader = None if joint.mimic is None else indices.get(joint.mimic.get("joint"))
        if leader is not None and leader != index:
            multiplier, offset = (read_attribute_number(joint.mimic, word) for word in ("multiplier", "offset"))
            factor = 1.0 if multiplier is None else multiplier
            yield Follower(body=index, leader=leader, multiplier=factor, offset=offset or 0.0)


def _collect_contact_shapes(model: Model, *, is_held: bool) -> tuple[list[tuple[Link, Shape]], tuple[str, ...], bool]:
    """Collect what touches the plane, the links of shapes that are left out, and whether it is what is drawn.

    What is drawn touches where nothing collides. A robot ``is_held`` where nothing of it can fall out of the world.
    """
    links = [model.link_by_name[name] for name in model.tree.order]
    shapes = [(link, shape) for link in links for shape in link.collisions]
    uses_visuals = not shapes
    if uses_visuals:
        shapes = [(link, shape) for link in links for shape in link.visuals if not is_dummy_shape(shape)]
    if not shapes and not is_held:
        raise FactUnavailableError("the robot has no shape that could touch the ground")
    if len(shapes) > MOST_SHAPES:
        raise FactUnavailableError(
            f"{len(shapes):,} shapes may touch the ground, and {MOST_SHAPES:,} are simulated at most"
        )
    usable: list[tuple[Link, Shape]] = []
    unread: dict[str, None] = {}
    for link, shape in shapes:
        if is_usable_shape(model, shape):
            usable.append((link, shape))
        else:
            unread[link.name] = None
    if not usable and not is_held:
        role = shapes[0][1].role
        raise FactUnavailableError(f"no {role} shape of the robot could be read, so nothing could touch the ground")
    return usable, tuple(unread), uses_visuals and bool(usable)


def _compute_hull_points(model: Model, shape: Shape) -> Array | None:
    """Compute the corners (K, 3) of a mesh's convex hull, in m; of a flat one those of a plate."""
    facts, scale = model.meshes.get_facts(shape), compute_drawn_scale(model, shape)
    if facts is None or scale is None:
        return None
    points: Array = facts.hull.vertices * np.array(scale)
    if facts.hull.volume > 0.0:
        return points
    low, high = points.min(axis=0), points.max(axis=0)
    low, high = np.minimum(low, (low + high) / 2 - _THIN), np.maximum(high, (low + high) / 2 + _THIN)
    return np.array(list(product(*zip(low, high, strict=True))))


def _compute_extent(geoms: Sequence[Geom], where: Sequence[Array]) -> tuple[Array, Array]:
    """Compute the least and the greatest corner (m) of the box around the geoms."""
    ends = []
    for toward in (*np.eye(3), *-np.eye(3)):
        turned = np.eye(4)
        turned[2, :3] = toward
        ends.append(min(compute_lowest_height(geom, turned @ at) for geom, at in zip(geoms, where, strict=True)))
    return np.array(ends[:3]), -np.array(ends[3:])


def _compute_frame_extent(frames: Mapping[str, Array]) -> tuple[Array, Array]:
    """Compute the least and the greatest corner (m) of the box around the origins of frames."""
    origins = np.array([frame[:3, 3] for frame in frames.values()])
    low, high = origins.min(axis=0), origins.max(axis=0)
    return low, np.maximum(high, low + _SMALLEST)
