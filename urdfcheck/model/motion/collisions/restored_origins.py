"""Overlaps at the neutral pose that are gone once a collision shape is where the link draws it."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace
from itertools import groupby

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.motion.kinematics import build_transform
from urdfcheck.model.motion.collisions.self_collisions import CollisionPair, SelfCollisions
from urdfcheck.model.motion.collisions.setup import make_colliders
from urdfcheck.model.shapes.displaced_collisions import DisplacedCollision, list_displaced_collisions


@dataclass(frozen=True, slots=True, eq=False)
class RestoredOrigin:
    """The displaced collision shapes of a link, and what moving them onto the visuals does."""

    shapes: tuple[DisplacedCollision, ...]
    freed: tuple[CollisionPair, ...]
    """The overlapping pairs that do not meet then."""


def find_restored_origins(collisions: SelfCollisions, overlaps: Collection[CollisionPair]) -> list[RestoredOrigin]:
    """Find the links whose displaced collision shapes explain some overlaps.

    Only those count where moving the shapes makes no other pair meet.

    :param overlaps: pairs that overlap at the neutral pose.
    """
    model = collisions.setup.model
    shapes = {id(shape) for pair in overlaps if pair.contact is not None for shape in pair.contact.shapes}
    restored = []
    for _, group in groupby(list_displaced_collisions(model), key=lambda displaced: displaced.link.name):
        displaced = tuple(group)
        if shapes.isdisjoint(id(one.collision.shape) for one in displaced):
            continue
        suspects = [pair for pair in overlaps if displaced[0].link.name in pair.links]
        freed = _find_freed_pairs(collisions, displaced, suspects)
        if freed:
            restored.append(RestoredOrigin(displaced, freed))
    return restored


def _find_freed_pairs(
    collisions: SelfCollisions, displaced: Sequence[DisplacedCollision], suspects: Sequence[CollisionPair]
) -> tuple[CollisionPair, ...]:
    """Return the pairs that do not meet with the collision shapes of a link moved; none if others meet that did not before."""
    setup = collisions.setup
    poses = {id(one.collision.shape): build_transform(one.visual.placement) for one in displaced}
    name = displaced[0].link.name
    placed = [
        replace(collider, pose=poses.get(id(shape), collider.pose))
        for collider, shape in zip(setup.colliders.placed, setup.shapes, strict=True)
    ]
    concerned = [(k, pair) for k, pair in enumerate(collisions.pairs) if name in pair.links and pair.relation == "far"]
    indices = np.array([k for k, _ in concerned], dtype=np.int64)
    met = make_colliders(placed).detect_collisions(setup.rest_placements[None], setup.pairs[indices])[:, 0].tolist()
    if any(meets and not pair.meets_at_neutral for (_, pair), meets in zip(concerned, met, strict=True)):
        return ()
    free = {pair.links for (_, pair), meets in zip(concerned, met, strict=True) if not meets}
    return tuple(pair for pair in suspects if pair.links in free)
