"""How MoveIt treats a robot's self-collisions: which pairs of links its Setup Assistant disables, and why."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, Literal

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.model.motion import poses
from urdfcheck.model.motion.collisions.self_collisions import CollisionPair, SelfCollisions, self_collisions
from urdfcheck.model.motion.planning_limits import collect_listed_joints
from urdfcheck.model.motion.poses import JointConfigurations
from urdfcheck.model.robot import Model
from urdfcheck.source.ros.srdf import Srdf

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Bools

Reason = Literal["Adjacent", "Default", "Always", "Never"]

# Setup Assistant: a pair that collides in more than this share of 200 random states is always in collision
# (compute_default_collisions.cpp, min_collision_fraction).
ALWAYS_SHARE = 0.95
# Collision checkers disagree about faces in one plane (m): FCL, MoveIt's default one, finds no collision there.
TOUCHING = 1e-6
# Of the configurations in which two links meet, how many are measured (chosen).
_MOST_MEASURED = 5


@dataclass(frozen=True, slots=True, eq=False)
class SetupAssistantPair:
    """A pair of links and what Setup Assistant does about it."""

    pair: CollisionPair
    reason: Reason | None
    """Why it disables the pair; None where it does not."""
    meets_at_default: bool
    """Whether the two meet in MoveIt's default state."""

    @property
    def is_always_for_moveit(self) -> bool:
        """Whether they collide so often that Setup Assistant calls it always."""
        return self.pair.hit_share > ALWAYS_SHARE


def classify_link_pairs(model: Model) -> tuple[SetupAssistantPair, ...]:
    """Classify every pair of links with collision geometry as MoveIt's Setup Assistant would.

    :raises FactUnavailableError: when the collisions are not known.
    """
    adjacent = find_adjacent_links(model)
    pairs = zip(self_collisions(model).pairs, _find_default_hits(model).tolist(), strict=True)
    return tuple(
        SetupAssistantPair(pair, _choose_reason(pair, adjacent=frozenset(pair.links) in adjacent, at_default=met), met)
        for pair, met in pairs
    )


def compute_default_state(model: Model) -> JointConfigurations:
    """Compute the one configuration in which MoveIt begins.

    Every joint is at zero, or in the middle of a range without zero (getVariableDefaultPositions of its joint models);
    followers are where ``<mimic>`` puts them.

    :raises FactUnavailableError: when the tree is broken.
    """
    joints = poses.make_neutral_configuration(model).joints
    bounds = [poses.get_sampling_range(joint) for joint in joints]
    values = [0.0 if lower <= 0.0 <= upper else (lower + upper) / 2 for lower, upper in bounds]
    return poses.apply_mimics(JointConfigurations(joints, np.array(values).reshape(1, -1)))


def find_overlapping_hit(model: Model, pair: CollisionPair) -> int | None:
    """Find a sampled configuration in which two links overlap, and do not merely touch; None if they do not in most of those that
    are measured: coal's depth of faces in one plane is wrong now and then.

    :raises FactUnavailableError: when the collisions are not known.
    """
    collisions = self_collisions(model)
    hits = np.flatnonzero(pair.hits)[:_MOST_MEASURED].tolist()
    overlapping: list[int] = []
    for hit in hits:
        state = JointConfigurations(collisions.poses.joints, collisions.poses.values[hit][None])
        if _measure_depth(collisions, state, pair) > TOUCHING:
            overlapping.append(hit)
        if 2 * len(overlapping) > len(hits):
            return overlapping[0]
    return None


def measure_default_depth(model: Model, pair: CollisionPair) -> float:
    """Measure how deep (m) two links that meet in MoveIt's default state overlap there; 0 where they just touch.

    :raises FactUnavailableError: when the collisions are not known.
    """
    return _measure_depth(self_collisions(model), compute_default_state(model), pair)


def _measure_depth(collisions: SelfCollisions, state: JointConfigurations, pair: CollisionPair) -> float:
    """Measure how deep (m) two links overlap in the one configuration of a ``state``."""
    setup = collisions.setup
    index = {link.name: i for i, link in enumerate(setup.links)}
    overlap = setup.colliders.find_deepest_overlap(
        setup.compute_placements(state)[0], *(index[name] for name in pair.links)
    )
    return 0.0 if overlap is None else overlap.depth


def do_surfaces_meet_at_default(model: Model, pair: CollisionPair) -> bool:
    """Whether the surfaces of two links that meet in MoveIt's default state meet there: to FCL, MoveIt's default checker, a mesh
    is its triangles, and what lies wholly inside it is free.

    :raises FactUnavailableError: when the collisions are not known.
    """
    setup = self_collisions(model).setup
    index = {link.name: i for i, link in enumerate(setup.links)}
    placements = setup.compute_placements(compute_default_state(model))[0]
    return setup.colliders.do_surfaces_meet(placements, *(index[name] for name in pair.links))


def _find_default_hits(model: Model) -> Bools:
    """Return whether each pair meets in MoveIt's default state (K,)."""
    state, collisions = compute_default_state(model), self_collisions(model)
    if np.array_equal(state.values, poses.make_neutral_configuration(model).values):
        return np.array([pair.meets_at_neutral for pair in collisions.pairs], dtype=bool)
    setup = collisions.setup
    try:
        known: Bools = collisions.cache_entry["default"]["hits"]
        return known
    except KeyError:
        hits = setup.colliders.detect_collisions(setup.compute_placements(state), setup.pairs)[:, 0]
        collisions.cache_entry["default"] = {"hits": hits}
        return hits


def _choose_reason(pair: CollisionPair, *, adjacent: bool, at_default: bool) -> Reason | None:
    """Return the first reason that applies, in Setup Assistant's order.

    A pair with a shape that had to be left out is never called "Never".
    """
    if adjacent:
        return "Adjacent"
    if at_default:
        return "Default"
    if pair.hit_share > ALWAYS_SHARE:
        return "Always"
    return "Never" if pair.is_never_in_collision and pair.is_complete else None


def find_adjacent_links(model: Model) -> frozenset[frozenset[str]]:
    """Return the pairs of links with collision geometry that are adjacent for MoveIt.

    A joint of any type connects them, or joints with only links without such geometry in between.

    :raises FactUnavailableError: when the tree is broken.
    """
    solid = {link.name for link in model.links if any(shape.kind for shape in link.collisions)}
    adjacent: set[frozenset[str]] = set()
    # Connected links without geometry are one socket, named after the topmost; the links that plug into it are adjacent.
    socket: dict[str, str] = {}
    plugged: dict[str, list[str]] = {}
    for name in model.tree.order:
        joint = model.tree.parent_joint.get(name)
        parent = None if joint is None else joint.parent
        if name in solid and parent in solid:
            adjacent.add(frozenset((name, parent)))
        elif name in solid and parent is not None:
            plugged[socket[parent]].append(name)
        elif name not in solid and parent in socket:
            socket[name] = socket[parent]
        elif name not in solid:
            socket[name] = name
            plugged[name] = [] if parent is None else [parent]
    return frozenset(adjacent.union(*(map(frozenset, combinations(links, 2)) for links in plugged.values())))


def find_moved_links(model: Model, srdf: Srdf) -> frozenset[str]:
    """Return the links that a planning group of the semantic description moves; all links where it has no group.

    MoveIt checks a group's states only for collisions of these with each other and with the rest.

    :raises FactUnavailableError: when the tree is broken.
    """
    groups = srdf.root.find_children("group")
    if not groups:
        return frozenset(model.link_by_name)
    joints = {name for group in groups for name in collect_listed_joints(model, srdf, group)}
    moved: set[str] = set()
    for name in model.tree.order:
        joint = model.tree.parent_joint.get(name)
        if joint is not None and (joint.parent in moved or (joint.is_movable and joint.name in joints)):
            moved.add(name)
    return frozenset(moved)
