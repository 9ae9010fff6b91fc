"""What a joint drives into when it moves alone from the neutral pose."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Bools, Indices

import math
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.motion.collision_geometry import ROUNDING
from urdfcheck.facts.motion.kinematics import compute_joint_motions
from urdfcheck.facts.motion.swept_spheres import compute_least_distance
from urdfcheck.model.motion import poses
from urdfcheck.model.motion.collisions.self_collisions import SelfCollisions, self_collisions
from urdfcheck.model.motion.collisions.setup import CollisionSetup, Relation
from urdfcheck.model.motion.poses import JointConfigurations
from urdfcheck.model.parts import Joint
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Bools, Indices

# Values of a joint that are compared over its range: every 5.6° of a whole turn.
STEPS = 64
# Halvings of a step, to 1e-3 of the range.
_HALVINGS = 4


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class JointCollision:
    """A joint that, moved alone from the neutral pose, drives a link into another one that it did not meet there."""

    joint: Joint
    value: float
    """Where the collision begins (rad or m), to 1e-3 of the joint's range."""
    limit: float
    """The joint's limit in that direction."""
    links: tuple[str, str]
    """The two links that meet first, in tree order."""
    relation: Relation
    """As of a `CollisionPair`."""


@dataclass(frozen=True, slots=True, eq=False)
class _JointMove:
    """A joint that moves alone, with its followers, all others at rest."""

    setup: CollisionSetup
    rest: JointConfigurations
    index: int
    """Of the joint, in ``rest.joints``."""
    below: Bools
    """Whether each link (L,) hangs on the joint."""

    @property
    def joint(self) -> Joint:
        return self.rest.joints[self.index]

    @property
    def start(self) -> float:
        """The value at rest."""
        return float(self.rest.values[0, self.index])

    def place_with_followers(self, values: Array) -> Array:
        """Place the links (N, L, 4, 4) where the joint, and what follows it, is at some values (N,)."""
        return self.setup.compute_placements(_set_joints_alone(self.rest, np.full(len(values), self.index), values))

    def place_without_followers(self, values: Array) -> Array:
        """Return the same, faster, for a joint that nothing follows."""
        setup, joint = self.setup, self.joint
        frame = setup.rest_frames[joint.child][0]
        motion = compute_joint_motions(
            poses.normalize_axis(joint), values - self.start, rotates=joint.type != "prismatic"
        )
        placed = np.repeat(setup.rest_placements[None], len(values), axis=0)
        placed[:, self.below] = (frame @ motion @ np.linalg.inv(frame))[:, None] @ setup.rest_placements[self.below]
        return placed

    def mask_reachable(self, pairs: Indices) -> Bools:
        """Return whether spheres around the links of some pairs come to meet (n,); only for a joint that nothing follows."""
        setup, joint, below = self.setup, self.joint, self.below
        frame = setup.rest_frames[joint.child][0]
        centres, radii = setup.spheres
        first, second = setup.pairs[pairs].T
        moving, staying = np.where(below[first], first, second), np.where(below[first], second, first)
        lower, upper = (limit - self.start for limit in poses.get_sampling_range(joint))
        gap = compute_least_distance(
            centres=centres[moving] - frame[:3, 3],
            others=centres[staying] - frame[:3, 3],
            axis=frame[:3, :3] @ poses.normalize_axis(joint),
            lower=lower,
            upper=upper,
            rotates=joint.type != "prismatic",
        )
        reached: Bools = gap <= (radii[moving] + radii[staying]) * (1 + ROUNDING)
        return reached

    def mask_touching(self, place: Callable[[Array], Array], pairs: Indices) -> Bools:
        """Return whether the shapes of some pairs touch at rest (n,): they meet as soon as the joint turns, either way."""
        lower, upper = poses.get_sampling_range(self.joint)
        least = _compute_range_width(self.joint) / STEPS / 2**_HALVINGS
        if not lower <= self.start - least < self.start + least <= upper:
            return np.zeros(len(pairs), dtype=bool)
        back, forth = (
            np.repeat(frame[None], len(pairs), axis=0)
            for frame in place(np.array([self.start - least, self.start + least]))
        )
        colliders, tested = self.setup.colliders, self.setup.pairs[pairs]
        backward: Bools = colliders.detect_collisions_per_pair(back, tested)
        return backward & colliders.detect_collisions_per_pair(forth, tested)

    def sample_way_to(self, limit: float) -> Array:
        """Return the joint's values from rest to a limit, both included."""
        steps = math.ceil(STEPS * abs(limit - self.start) / _compute_range_width(self.joint))
        return np.linspace(self.start, limit, 1 + steps)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _Bracket:
    """A step of a joint in which two links begin to meet."""

    joint_index: int
    pair_index: int
    limit: float
    free: float
    """The value at which they do not meet yet."""
    met: float
    """The value at which they do."""


def find_joint_collisions(model: Model) -> tuple[JointCollision, ...]:
    """Find what each joint drives into when it moves alone, with its followers: at most one entry per joint and direction.

    Links of adjacent bodies count where they meet from some value on up to the limit: meshes of a bearing that graze each
    other here and there do not, nor do shapes that touch at rest. A collision that lasts less than a step may be missed.

    :raises FactUnavailableError: when coal is not installed, when the tree, an origin or an axis is broken, or when more
        joints move than motion is computed for.
    """
    collisions = self_collisions(model)
    rest = poses.make_neutral_configuration(model)
    poses.ensure_few_joints(rest.joints)
    try:
        table = collisions.cache_entry["reach"]["table"]
    except KeyError:
        table = _search_joint_collisions(collisions, rest)
        collisions.cache_entry["reach"] = {"table": table}
    joint_collisions = []
    for joint_index, pair_index, value, limit in table.tolist():
        pair = collisions.pairs[int(pair_index)]
        joint_collisions.append(
            JointCollision(
                joint=rest.joints[int(joint_index)],
                value=value,
                limit=limit,
                links=pair.links,
                relation=pair.relation,
            )
        )
    return tuple(joint_collisions)


def _search_joint_collisions(collisions: SelfCollisions, rest: JointConfigurations) -> Array:
    """Return rows (R, 4): joint index, pair index, value where the two links begin to meet, limit in that direction."""
    brackets = list(_bracket_joint_collisions(collisions, rest))
    met = _bisect_brackets(collisions.setup, rest, brackets)
    columns = [b.joint_index for b in brackets], [b.pair_index for b in brackets], met, [b.limit for b in brackets]
    return np.column_stack(columns).reshape(-1, 4)


def _bracket_joint_collisions(collisions: SelfCollisions, rest: JointConfigurations) -> Iterator[_Bracket]:
    setup = collisions.setup
    below, followers = _compute_links_below(setup, rest.joints), _list_followers(rest.joints)
    apart = np.array([not p.meets_at_neutral and p.relation != "fixed" for p in collisions.pairs], dtype=bool)
    adjacent = np.array([p.relation == "adjacent" for p in collisions.pairs], dtype=bool)
    for index, joint in enumerate(rest.joints):
        if joint.mimic is not None or not _compute_range_width(joint) > 0:
            continue
        move = _JointMove(setup=setup, rest=rest, index=index, below=below[index])
        candidates = np.flatnonzero(apart & _find_affected_pairs(setup, below[[index, *followers[index]]]))
        if not followers[index] and len(candidates):
            candidates = candidates[move.mask_reachable(candidates)]
        if not len(candidates):
            continue
        place = move.place_with_followers if followers[index] else move.place_without_followers
        neighbours = candidates[adjacent[candidates]]
        candidates = np.setdiff1d(candidates, neighbours[move.mask_touching(place, neighbours)])
        for limit in poses.get_sampling_range(joint):
            way = move.sample_way_to(limit)
            first = _find_first_collision(setup, place(way)[1:], pairs=candidates, adjacent=adjacent[candidates])
            if first is not None:
                pair, step = first
                yield _Bracket(joint_index=index, pair_index=pair, limit=way[-1], free=way[step], met=way[step + 1])


def _bisect_brackets(setup: CollisionSetup, rest: JointConfigurations, brackets: Sequence[_Bracket]) -> Array:
    """Return the values (R,) at which the links begin to meet, all brackets halved together."""
    low, high = np.array([b.free for b in brackets]), np.array([b.met for b in brackets])
    joints, pairs = np.array([b.joint_index for b in brackets]), [b.pair_index for b in brackets]
    for _ in range(_HALVINGS if brackets else 0):
        middle = (low + high) / 2
        frames = setup.compute_placements(_set_joints_alone(rest, joints, middle))
        met_there = setup.colliders.detect_collisions_per_pair(frames, setup.pairs[pairs])
        low, high = np.where(met_there, low, middle), np.where(met_there, middle, high)
    return high


def _find_first_collision(
    setup: CollisionSetup, frames: Array, *, pairs: Indices, adjacent: Bools
) -> tuple[int, int] | None:
    """Return the first of some pairs that meet on a way, and in which of its configurations; None when none does.

    ``frames`` (N, L, 4, 4) are the placements along the way. Pairs that are ``adjacent`` have to meet from there on up to the
    end of the way: they are followed from its end inwards, the others from its beginning up to where one of them meets.
    """
    if not len(frames):
        return None
    near = setup.colliders.find_candidate_pairs(frames, setup.pairs[pairs])
    rows: dict[tuple[int, int], list[int]] = {}
    for row, key in enumerate(zip(near.pose.tolist(), near.pair.tolist(), strict=True)):
        rows.setdefault(key, []).append(row)

    def meets(step: int, pair: int) -> bool:
        return any(near.has_collision(row) for row in rows.get((step, pair), ()))

    collisions: list[tuple[int, int]] = []
    for pair in np.flatnonzero(adjacent).tolist():
        first = len(frames)
        while first and meets(first - 1, pair):
            first -= 1
        if first < len(frames):
            collisions.append((first, pair))
    first_far = next(((step, pair) for step, pair in sorted(rows) if not adjacent[pair] and meets(step, pair)), None)
    if first_far is not None:
        collisions.append(first_far)
    if not collisions:
        return None
    step, pair = min(collisions)
    return int(pairs[pair]), step


def _set_joints_alone(rest: JointConfigurations, joints: Indices, values: Array) -> JointConfigurations:
    """Return the neutral pose n times, each with one of its joints (n,), and what follows it, at a value (n,)."""
    all_values = np.repeat(rest.values, len(values), axis=0)
    all_values[np.arange(len(values)), joints] = values
    return poses.apply_mimics(JointConfigurations(rest.joints, all_values))


def _compute_range_width(joint: Joint) -> float:
    lower, upper = poses.get_sampling_range(joint)
    return upper - lower


def _compute_links_below(setup: CollisionSetup, joints: Sequence[Joint]) -> Bools:
    """Return whether each of the links hangs on each joint (J, L)."""
    below = [[joint.name in names for names in setup.joints_above] for joint in joints]
    return np.array(below, dtype=bool).reshape(len(joints), len(setup.links))


def _find_affected_pairs(setup: CollisionSetup, below: Bools) -> Bools:
    """Return the pairs (K,) whose links joints that move together move against each other.

    ``below`` (n, L): whether each link hangs on each of these joints.
    """
    affected = np.zeros(len(setup.pairs), dtype=bool)
    for links in below:
        affected |= links[setup.pairs[:, 0]] != links[setup.pairs[:, 1]]
    return affected


def _list_followers(joints: Sequence[Joint]) -> list[list[int]]:
    """Return the indices of the followers of each joint."""
    followers: list[list[int]] = [[] for _ in joints]
    for index, joint in enumerate(joints):
        leader = _find_leader(joint, joints)
        if leader is not None:
            followers[leader].append(index)
    return followers


def _find_leader(joint: Joint, joints: Sequence[Joint]) -> int | None:
    """Return the index of the joint that a follower follows in the end; None where it follows no known joint."""
    by_name = {j.name: i for i, j in enumerate(joints)}
    for _ in joints:
        if joint.mimic is None:
            return None
        index = by_name.get(joint.mimic.get("joint"))
        if index is None:
            return None
        joint = joints[index]
        if joint.mimic is None:
            return index
    return None
