"""Whether what two links draw meets where their collision shapes do."""

from __future__ import annotations

import numpy as np

from urdfcheck.facts.motion.collision_geometry import PlacedGeometry
from urdfcheck.model.motion import poses
from urdfcheck.model.motion.collisions.self_collisions import CollisionPair, SelfCollisions
from urdfcheck.model.motion.collisions.setup import make_colliders, make_geometry
from urdfcheck.model.motion.poses import JointConfigurations
from urdfcheck.model.parts import is_dummy_shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.mesh_sizes import is_usable_shape


def is_drawn_apart(collisions: SelfCollisions, pair: CollisionPair, *, at_rest: bool = False) -> bool:
    """Whether the visuals of two links, and of all that is fixed to them, are apart in each sampled configuration in which the
    collision shapes meet, or ``at_rest``.

    False where either draws nothing, or a visual is not known.

    :raises FactUnavailableError: when coal is not installed, or an origin or an axis is broken.
    """
    model = collisions.setup.model
    placed = [_place_visuals(model, name, owner) for owner, name in enumerate(pair.links)]
    if not all(placed):
        return False
    sampled = collisions.poses
    met = JointConfigurations(sampled.joints, sampled.values[:1] if at_rest else sampled.values[pair.hits])
    frames = poses.compute_frames(model, met)
    placements = np.stack([frames[name] for name in pair.links], axis=1)
    colliders = make_colliders([visual for visuals in placed for visual in visuals])
    return not colliders.detect_collisions(placements, np.array([[0, 1]])).any()


def _place_visuals(model: Model, name: str, owner: int) -> list[PlacedGeometry]:
    """Place what the rigid body of a link draws in the link's frame; nothing if a shape is not known."""
    home = np.linalg.inv(model.frames[name])
    placed = []
    for other in model.tree.list_body_links(name):
        for shape in model.link_by_name[other].visuals:
            if is_dummy_shape(shape):
                continue
            pose = shape.origin.matrix
            if pose is None or not is_usable_shape(model, shape):
                return []
            placed.append(PlacedGeometry(make_geometry(model, shape), owner, home @ model.frames[other] @ pose))
    return placed
