"""Proof that two links never meet: spheres around their shapes, swept over the joints' ranges."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Bools

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.facts.motion.collision_geometry import ROUNDING
from urdfcheck.facts.motion.swept_spheres import compute_swept_spheres
from urdfcheck.model.motion import poses
from urdfcheck.model.motion.collisions.setup import CollisionSetup
from urdfcheck.model.motion.poses import JointConfigurations
from urdfcheck.model.parts import Joint
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Bools

# "Without limit" where numbers are multiplied; m or rad.
_ENDLESS = 1e9


def prove_apart(setup: CollisionSetup) -> Bools:
    """Return for each pair (K,) whether the swept spheres of its two links stay apart, as some link of the robot sees them.

    Every sphere is carried from its own link to every other, first towards the root, then outwards, and grows at each joint
    by what the joint's range can do.

    :raises FactUnavailableError: when an origin is malformed.
    """
    tree = setup.model.tree
    centres, radii = _sweep_to_all_links(setup)
    first, second = setup.pairs[:, 0], setup.pairs[:, 1]
    proven = np.zeros(len(setup.pairs), dtype=bool)
    for name in tree.order:
        if name != tree.root and tree.parent_joint[name].type == "fixed":  # as its parent sees it
            continue
        distance = np.linalg.norm(centres[name][first] - centres[name][second], axis=1)
        proven |= distance > (radii[name][first] + radii[name][second]) * (1.0 + ROUNDING)
    return proven


def _sweep_to_all_links(setup: CollisionSetup) -> tuple[Mapping[str, Array], Mapping[str, Array]]:
    """Return the spheres of all links with shapes as each link sees them: centres (L, 3) in its frame, and radii (L,)."""
    tree, count = setup.model.tree, len(setup.links)
    ranges = _compute_joint_ranges(setup.model)
    index = {link.name: i for i, link in enumerate(setup.links)}
    centres = {name: np.zeros((count, 3)) for name in tree.order}
    radii = {name: np.full(count, np.inf) for name in tree.order}
    below = {name: np.zeros(count, dtype=bool) for name in tree.order}
    for name in reversed(tree.order):
        if name in index:
            i = index[name]
            centres[name][i], radii[name][i] = setup.colliders.spheres[i]
            below[name][i] = True
        if name != tree.root:
            joint, inside = tree.parent_joint[name], below[name]
            pose = _get_origin_matrix(joint)
            carried, grown = _sweep_spheres(joint, ranges, centres[name][inside], radii=radii[name][inside])
            centres[joint.parent][inside] = carried @ pose[:3, :3].T + pose[:3, 3]
            radii[joint.parent][inside] = grown
            below[joint.parent] |= inside
    for name in tree.order[1:]:
        joint, outside = tree.parent_joint[name], ~below[name]
        pose = _get_origin_matrix(joint)
        local = (centres[joint.parent][outside] - pose[:3, 3]) @ pose[:3, :3]
        centres[name][outside], radii[name][outside] = _sweep_spheres(
            joint, ranges, local, radii=radii[joint.parent][outside], inwards=True
        )
    return centres, radii


def _get_origin_matrix(joint: Joint) -> Array:
    matrix = joint.origin.matrix
    if matrix is None:
        raise FactUnavailableError(f"the origin of joint {joint.name!r} is malformed")
    return matrix


def _sweep_spheres(
    joint: Joint, ranges: Mapping[str, tuple[float, float]], centres: Array, *, radii: Array, inwards: bool = False
) -> tuple[Array, Array]:
    """Sweep spheres over a joint's range; ``inwards``: those on the parent's side, as the child sees them."""
    if joint.type == "fixed":
        return centres, radii
    if joint.name not in ranges:  # floating, planar
        return centres, np.full(len(radii), np.inf)
    lower, upper = ranges[joint.name]
    return compute_swept_spheres(
        centres=centres,
        radii=radii,
        axis=poses.normalize_axis(joint),
        lower=-upper if inwards else lower,
        upper=-lower if inwards else upper,
        rotates=joint.type != "prismatic",
    )


def _compute_joint_ranges(model: Model) -> Mapping[str, tuple[float, float]]:
    """Return the values that each joint can take: a whole turn, or endless, where it has no limits or senseless ones."""
    joints = poses.make_neutral_configuration(model).joints
    bounds = []
    for joint in joints:
        lower, upper = poses.get_sampling_range(joint)
        typed = joint.get_limit_value("lower"), joint.get_limit_value("upper")
        if joint.type != "continuous" and typed != (lower, upper):
            wide = _ENDLESS if joint.type == "prismatic" else poses.TURN
            lower, upper = -wide, wide
        bounds.append((lower, upper))
    ends = poses.apply_mimics(JointConfigurations(joints, np.array(bounds).reshape(-1, 2).T)).values
    return {j.name: (float(ends[:, i].min()), float(ends[:, i].max())) for i, j in enumerate(joints)}
