"""How far the ends of a robot's chains come from where these begin to move."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from urdfcheck.core.records import dataclass
from urdfcheck.core.scene import Scene, SceneJoint
from urdfcheck.facts.motion.kinematics import compute_joint_motions

_ROTARY, _SLIDING = frozenset({"revolute", "continuous"}), "prismatic"
# Positions that are tried at random, then values of one joint after the other from the best of them, in so many rounds.
_TRIED, _VALUES, _ROUNDS = 500, 25, 3
# Chains that are measured, those of the most joints first.
_MOST_CHAINS = 12


@dataclass(frozen=True, slots=True, kw_only=True)
class ChainReach:
    """How far a link comes from the frame of the first joint that moves it."""

    tip: str
    first_joint: str
    found: float
    """The greatest distance that was found in m: a position of the joints brings the link there."""
    limit: float
    """The sum of all lengths in m: no position brings it farther."""


def measure_reaches(scene: Scene) -> list[ChainReach]:
    """Return the reach of each chain with two joints or more whose limits are known, the longest first."""
    chains = sorted(_iter_chains(scene), key=len, reverse=True)[:_MOST_CHAINS]
    joints = {joint.name: joint for joint in scene.joints}
    found = (_measure_chain(chain, joints) for chain in chains)
    return sorted((reach for reach in found if reach is not None), key=lambda reach: -reach.found)


def _iter_chains(scene: Scene) -> Iterator[list[SceneJoint]]:
    """Yield for each link at an end the joints above it, from the first that has limits to move in."""
    above = {joint.child: joint for joint in scene.joints}
    parents = {joint.parent for joint in scene.joints}
    for link in (link for link in scene.links if link.name not in parents):
        chain: list[SceneJoint] = []
        name = link.name
        while name in above:
            joint = above[name]
            if joint in chain or joint.type in {"floating", "planar"}:
                break
            chain.insert(0, joint)
            name = joint.parent
        while chain and chain[0].type == "fixed":
            del chain[0]
        if sum(joint.type != "fixed" for joint in chain) > 1:
            yield chain


def _measure_chain(chain: Sequence[SceneJoint], joints: Mapping[str, SceneJoint]) -> ChainReach | None:
    """Return the reach of a chain; None where it is not known how far its joints move."""
    ranges: dict[str, tuple[float, float]] = {}
    limit = 0.0
    for place, joint in enumerate(chain):
        master = joints.get(joint.mimic[0]) if joint.mimic is not None else joint
        if len(joint.pose) != 16 or master is None or (joint.mimic is not None and master.mimic is not None):
            return None
        if place:
            limit += math.hypot(*np.reshape(joint.pose, (4, 4))[:3, 3])
        if joint.type == "fixed":
            continue
        range_ = _find_range(master)
        if range_ is None or joint.turn is None or joint.type not in {*_ROTARY, _SLIDING}:
            return None
        ranges[master.name] = range_
        if joint.type == _SLIDING:
            limit += float(np.abs(_follow(joint, np.array(range_))).max())
    return ChainReach(
        tip=chain[-1].child, first_joint=chain[0].name, found=_search_farthest(chain, ranges), limit=limit
    )


def _find_range(joint: SceneJoint) -> tuple[float, float] | None:
    if joint.type == "continuous":
        return -math.pi, math.pi
    if joint.lower is None or joint.upper is None or not -math.inf < joint.lower <= joint.upper < math.inf:
        return None
    return joint.lower, joint.upper


def _follow(joint: SceneJoint, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the positions of a joint where the one that it mimics, or itself, has these."""
    return values if joint.mimic is None else joint.mimic[1] * values + joint.mimic[2]


def _search_farthest(chain: Sequence[SceneJoint], ranges: Mapping[str, tuple[float, float]]) -> float:
    random = np.random.default_rng(0)
    tried = {name: random.uniform(*range_, _TRIED) for name, range_ in ranges.items()}
    distances = _measure_distances(chain, tried)
    best = {name: float(values[distances.argmax()]) for name, values in tried.items()}
    farthest = float(distances.max())
    for name in [*ranges] * _ROUNDS:
        values = np.linspace(*ranges[name], _VALUES)
        line = {other: values if other == name else np.full(_VALUES, value) for other, value in best.items()}
        distances = _measure_distances(chain, line)
        if distances.max() > farthest:
            farthest, best[name] = float(distances.max()), float(values[distances.argmax()])
    return farthest


def _measure_distances(
    chain: Sequence[SceneJoint], positions: Mapping[str, NDArray[np.float64]]
) -> NDArray[np.float64]:
    """Return the distances (N,) of the end from the first joint's frame in m, with the joints at these positions (N,) each."""
    count = len(next(iter(positions.values())))
    reached = np.tile(np.eye(4), (count, 1, 1))
    for place, joint in enumerate(chain):
        if place:
            reached = reached @ np.reshape(joint.pose, (4, 4))
        if joint.turn is not None and joint.type != "fixed":
            values = _follow(joint, positions[joint.name if joint.mimic is None else joint.mimic[0]])
            reached = reached @ compute_joint_motions(joint.turn, values, rotates=joint.type in _ROTARY)
    distances: NDArray[np.float64] = np.linalg.norm(reached[:, :3, 3], axis=1)
    return distances
