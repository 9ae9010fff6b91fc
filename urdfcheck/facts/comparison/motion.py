"""Both versions moved alike: how far each link is from where it was."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from urdfcheck.core.mechanism import MechanismJoint
from urdfcheck.core.model_diff import LinkShift
from urdfcheck.core.records import dataclass
from urdfcheck.facts.arrays import Array, Bools
from urdfcheck.facts.comparison.alignment import PlacedPair
from urdfcheck.facts.comparison.home_pose import ANGLE_TOLERANCE, LENGTH_TOLERANCE, HomePose, locate_screw
from urdfcheck.facts.comparison.joints import ONE_DOF
from urdfcheck.facts.motion.kinematics import compute_joint_motions

# Joint configurations beside those in which one joint is at an end; fewer for robots of thousands of links, whose poses would
# take gigabytes.
SAMPLES, MOST_POSES = 200, 200_000
_SEED = 20
# Half the range (rad, m) in which a joint without limits is moved.
_HALF_TURN, _HALF_TRAVEL = np.pi, 0.5
# Of links that move equally far, up to this share, the one at the end of a branch is named.
_TIE = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class JointSamples:
    """Positions (N,) of the joints of both versions, by their names in each; row 0 is zero, as far as the limits allow it."""

    before: Mapping[str, Array]
    after: Mapping[str, Array]
    count: int


@dataclass(frozen=True, slots=True, eq=False)
class LimitSamples:
    """Positions within the limits of either version."""

    joints: JointSamples
    is_allowed_before: Bools
    """(N,), whether they are within the limits of the first version."""
    is_allowed_after: Bools
    """(N,), whether they are within the limits of the second version."""
    ranged: frozenset[str]
    """The joints that have other limits, as the first version names them."""


# A joint in both versions.
_Joints = tuple[MechanismJoint, MechanismJoint]


def sample_joints(pair: PlacedPair) -> JointSamples:
    """Sample joint positions that both versions allow, the same for matched joints; followers follow in either version."""
    joints = _list_free_joints(pair)
    ranges = np.array([_choose_range(both) for both in joints]).reshape(-1, 2)
    return _build_samples(pair, joints, _draw_positions(pair, ranges))


def sample_limits(pair: PlacedPair) -> LimitSamples:
    """Sample what both versions allow, like `sample_joints`, and then as much of what either allows."""
    joints = _list_free_joints(pair)
    ranges = np.array([_list_ranges(both) for both in joints]).reshape(-1, 2, 2)
    values = _draw_positions(pair, np.array([_choose_range(both) for both in joints]).reshape(-1, 2))
    differs = np.abs(ranges[:, 0] - ranges[:, 1]).max(axis=1, initial=0.0) > ANGLE_TOLERANCE
    if differs.any():
        either = np.column_stack((ranges[:, :, 0].min(axis=1), ranges[:, :, 1].max(axis=1)))
        values = np.concatenate((values, _draw_positions(pair, either)))
    ranged = frozenset(one.name for (one, _), other in zip(joints, differs.tolist(), strict=True) if other)
    samples = _build_samples(pair, joints, values)
    return LimitSamples(samples, _are_within(values, ranges[:, 0]), _are_within(values, ranges[:, 1]), ranged)


def _are_within(values: Array, ranges: Array) -> Bools:
    """Return which positions (N, J) are within ranges (J, 2), to the tolerance."""
    is_inside = (values >= ranges[:, 0] - ANGLE_TOLERANCE) & (values <= ranges[:, 1] + ANGLE_TOLERANCE)
    return np.asarray(is_inside.all(axis=1))


def _list_free_joints(pair: PlacedPair) -> list[_Joints]:
    joints = [(pair.before.joints[old], pair.after.joints[new]) for old, new in pair.match.joints.items()]
    return [both for both in joints if any(map(_is_free, both))]


def _draw_positions(pair: PlacedPair, ranges: Array) -> Array:
    """Return positions (N, J) within ``ranges`` (J, 2): zero as far as that is possible, each end alone, then drawn ones."""
    links = max(len(pair.before.links), len(pair.after.links))
    joints = range(len(ranges))
    if not joints:
        return np.zeros((1, 0))  # there is one configuration
    count = min(SAMPLES, max(10, MOST_POSES // links - 2 * len(joints)))
    middle = np.clip(0.0, ranges[:, 0], ranges[:, 1])
    ends = np.repeat(middle[None], 2 * len(joints), axis=0)
    for place in range(len(joints)):
        ends[2 * place : 2 * place + 2, place] = ranges[place]
    drawn = np.random.default_rng(_SEED).uniform(ranges[:, 0], ranges[:, 1], (count, len(joints)))
    return np.concatenate((middle[None], ends[: MOST_POSES // links], drawn))


def _build_samples(pair: PlacedPair, joints: Sequence[_Joints], values: Array) -> JointSamples:
    """Return the positions (N,) of all joints of both versions at ``values`` (N, J) of those that both have."""
    before, after = (
        {both[side].name: values[:, place] for place, both in enumerate(joints) if _is_free(both[side])}
        for side in (0, 1)
    )
    total = len(values)
    return JointSamples(_complete(pair.before, before, total), _complete(pair.after, after, total), total)


def _is_free(joint: MechanismJoint) -> bool:
    return joint.type in ONE_DOF and joint.mimic is None


def _choose_range(joints: _Joints) -> tuple[float, float]:
    ranges = [_get_range(joint) for joint in joints if joint.type in ONE_DOF]
    low, high = max(low for low, _ in ranges), min(high for _, high in ranges)
    return (low, high) if low <= high else ranges[0]


def _list_ranges(joints: _Joints) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the range in either version; where it does not move in one, that of the other."""
    one, two = joints
    return _get_range(one if one.type in ONE_DOF else two), _get_range(two if two.type in ONE_DOF else one)


def _get_range(joint: MechanismJoint) -> tuple[float, float]:
    half = _HALF_TRAVEL if joint.type == "prismatic" else _HALF_TURN
    low, high = joint.lower, joint.upper
    if low is None or high is None or low > high:
        return -half, half
    return low, high


def _complete(home: HomePose, given: Mapping[str, Array], count: int) -> dict[str, Array]:
    """Return the positions of all joints: followers follow, the others are at zero or at the limit next to it."""
    values = dict(given)
    for joint in home.joints.values():
        if joint.type in ONE_DOF and joint.mimic is None:
            values.setdefault(joint.name, np.full(count, float(np.clip(0.0, *_get_range(joint)))))
    for joint in home.joints.values():
        if joint.type not in ONE_DOF or joint.mimic is None:
            continue
        factor, offset, leader, seen = 1.0, 0.0, joint, {joint.name}
        while leader.mimic is not None and leader.mimic[0] in home.joints and leader.mimic[0] not in seen:
            name, multiplier, added = leader.mimic
            offset, factor = offset + factor * added, factor * multiplier
            leader = home.joints[name]
            seen.add(name)
        source = values.get(leader.name) if leader.mimic is None else None
        values[joint.name] = np.zeros(count) if source is None else factor * source + offset
    return values


def compute_displacements(home: HomePose, values: Mapping[str, Array], count: int) -> dict[str, Array]:
    """Compute how each link is displaced (N, 4, 4) from where it is with all joints at zero, in the anchor's frame.

    The link that is the anchor does not stay: all links move relative to the root.
    """
    moved = {home.mechanism.root: np.broadcast_to(np.eye(4), (count, 4, 4))}
    for name in home.order:
        joint = home.joint_above.get(name)
        if joint is None:
            continue
        screw = locate_screw(home, joint)
        if joint.type not in ONE_DOF or screw is None:
            moved[name] = moved[joint.parent]
            continue
        motions = compute_joint_motions(screw.direction, values[joint.name], rotates=joint.type != "prismatic")
        if joint.type != "prismatic":
            motions[:, :3, 3] = screw.point - motions[:, :3, :3] @ screw.point
        moved[name] = moved[joint.parent] @ motions
    return moved


def measure_shifts(
    pair: PlacedPair, samples: JointSamples, before: Mapping[str, Array], after: Mapping[str, Array]
) -> list[LinkShift]:
    """Return the links that are elsewhere in some configuration, the one that moves farthest first."""
    found: list[tuple[float, bool, int, LinkShift]] = []
    branches: dict[str, str] = {}  # of the links that move, and of those that are gone between them
    for depth, name in enumerate(pair.before.order):
        joint = pair.before.joint_above.get(name)
        above = None if joint is None else branches.get(joint.parent)
        new = pair.match.links.get(name)
        if new is None:
            if above is not None:
                branches[name] = above
            continue
        first = before[name] @ pair.before.frames[name]
        second = after[new] @ pair.maps[name] @ pair.before.frames[name]
        distances = np.linalg.norm(second[:, :3, 3] - first[:, :3, 3], axis=1)
        turns = np.einsum("nij,nij->n", second[:, :3, :3], first[:, :3, :3])  # the trace of the rotation between them
        apart = np.linalg.norm(second[:, :3, :3] - first[:, :3, :3], axis=(1, 2))
        # Precise near 0 too, where the arc cosine of the trace is not: |R1 - R2| = 2 sqrt(2) sin(angle / 2).
        angles = np.where(turns > 0.0, 2.0 * np.arcsin(np.clip(apart / np.sqrt(8.0), 0.0, 1.0)), 0.0)
        angles = np.where(turns > 0.0, angles, np.arccos(np.clip((turns - 1.0) / 2.0, -1.0, 1.0)))
        worst = int(np.argmax(distances))
        if distances[worst] <= LENGTH_TOLERANCE and float(angles.max()) <= ANGLE_TOLERANCE:
            continue
        branches[name] = name if above is None else above
        is_constant = float(np.ptp(distances)) <= LENGTH_TOLERANCE
        shift = LinkShift(
            link=name,
            distance=float(distances[worst]),
            angle=float(angles.max()),
            configuration={} if is_constant else describe_positions(pair.before, samples.before, name, worst),
            branch=branches[name],
        )
        found.append((shift.distance, not pair.before.joints_below[name], depth, shift))
    farthest = max((distance for distance, _, _, _ in found), default=0.0)
    found.sort(key=lambda entry: (entry[0] < farthest * (1.0 - _TIE), not entry[1], -entry[0], -entry[2]))
    return [shift for _, _, _, shift in found]


def describe_positions(home: HomePose, values: Mapping[str, Array], link: str, row: int) -> dict[str, float]:
    """Return the positions of the joints that carry a link in one configuration, from the root outwards."""
    positions: dict[str, float] = {}
    joint = home.joint_above.get(link)
    while joint is not None:
        if joint.name in values:
            positions[joint.name] = float(values[joint.name][row])
        joint = home.joint_above.get(joint.parent)
    return dict(reversed(positions.items()))
