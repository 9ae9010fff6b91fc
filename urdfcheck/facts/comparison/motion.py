"""Both versions moved alike: how far each link is from where it was, and what gravity asks of each joint."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from urdfcheck.core.drop_test import GRAVITY
from urdfcheck.core.mechanism import MechanismJoint
from urdfcheck.core.model_diff import JointTorque, LinkShift
from urdfcheck.facts.arrays import Array
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
# Shares by which a torque must change to be reported.
_LEAST_TORQUE_CHANGE = 1e-3
# Of links that move equally far, up to this share, the one at the end of a branch is named.
_TIE = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class JointSamples:
    """Positions (N,) of the joints of both versions, by their names in each; row 0 is zero, as far as the limits allow it."""

    before: Mapping[str, Array]
    after: Mapping[str, Array]
    count: int


def sample_joints(pair: PlacedPair) -> JointSamples:
    """Sample joint positions that both versions allow, the same for matched joints; followers follow in either version."""
    joints = [(pair.before.joints[old], pair.after.joints[new]) for old, new in pair.match.joints.items()]
    joints = [both for both in joints if any(map(_is_free, both))]
    ranges = np.array([_choose_range(both) for both in joints]).reshape(-1, 2)
    links = max(len(pair.before.links), len(pair.after.links))
    count = min(SAMPLES, max(10, MOST_POSES // links - 2 * len(joints)))
    middle = np.clip(0.0, ranges[:, 0], ranges[:, 1])
    ends = np.repeat(middle[None], 2 * len(joints), axis=0)
    for place in range(len(joints)):
        ends[2 * place : 2 * place + 2, place] = ranges[place]
    drawn = np.random.default_rng(_SEED).uniform(ranges[:, 0], ranges[:, 1], (count, len(joints)))
    values = np.concatenate((middle[None], ends[: MOST_POSES // links], drawn))
    before, after = (
        {both[side].name: values[:, place] for place, both in enumerate(joints) if _is_free(both[side])}
        for side in (0, 1)
    )
    total = len(values)
    return JointSamples(_complete(pair.before, before, total), _complete(pair.after, after, total), total)


def _is_free(joint: MechanismJoint) -> bool:
    return joint.type in ONE_DOF and joint.mimic is None


def _choose_range(joints: tuple[MechanismJoint, MechanismJoint]) -> tuple[float, float]:
    ranges = [_get_range(joint) for joint in joints if joint.type in ONE_DOF]
    low, high = max(low for low, _ in ranges), min(high for _, high in ranges)
    return (low, high) if low <= high else ranges[0]


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
    for depth, name in enumerate(pair.before.order):
        new = pair.match.links.get(name)
        if new is None:
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
        is_constant = float(np.ptp(distances)) <= LENGTH_TOLERANCE
        shift = LinkShift(
            link=name,
            distance=float(distances[worst]),
            angle=float(angles.max()),
            configuration={} if is_constant else _describe_configuration(pair, samples, name, worst),
        )
        found.append((shift.distance, not pair.before.joints_below[name], depth, shift))
    farthest = max((distance for distance, _, _, _ in found), default=0.0)
    found.sort(key=lambda entry: (entry[0] < farthest * (1.0 - _TIE), not entry[1], -entry[0], -entry[2]))
    return [shift for _, _, _, shift in found]


def _describe_configuration(pair: PlacedPair, samples: JointSamples, link: str, row: int) -> dict[str, float]:
    """Return the positions of the joints that carry a link."""
    positions: dict[str, float] = {}
    joint = pair.before.joint_above.get(link)
    while joint is not None:
        if joint.name in samples.before:
            positions[joint.name] = float(samples.before[joint.name][row])
        joint = pair.before.joint_above.get(joint.parent)
    return dict(reversed(positions.items()))


# -- gravity -----------------------------------------------------------------------------------------------------------


def compare_torques(pair: PlacedPair, before: Mapping[str, Array], after: Mapping[str, Array]) -> Iterator[JointTorque]:
    """Yield the joints whose worst gravity torque differs."""
    olds, news = _compute_worst_torques(pair.before, before), _compute_worst_torques(pair.after, after)
    for old, new in pair.match.joints.items():
        if old not in olds or new not in news:
            continue
        first, second = olds[old], news[new]
        if abs(second - first) <= max(_LEAST_TORQUE_CHANGE * max(first, second), 1e-6):
            continue
        joint = pair.after.joints[new]
        yield JointTorque(
            joint=old,
            before=first,
            after=second,
            effort=joint.effort,
            unit="N" if joint.type == "prismatic" else "N·m",
        )


def _compute_worst_torques(home: HomePose, displacements: Mapping[str, Array]) -> dict[str, float]:
    """Return the largest torque (N·m) or force (N) that each joint holds against gravity, along z of the root."""
    count = len(next(iter(displacements.values())))
    up = home.frames[home.mechanism.root][:3, 2]
    masses = {name: link.mass or 0.0 for name, link in home.links.items()}
    moments: dict[str, Array] = {}
    for name, link in home.links.items():
        place = np.ones(4)
        place[:3] = home.frames[name][:3, :3] @ np.array(link.com or (0.0, 0.0, 0.0)) + home.frames[name][:3, 3]
        moments[name] = masses[name] * (displacements[name] @ place)[:, :3]
    worst: dict[str, float] = {}
    for name in reversed(home.order):
        joint = home.joint_above.get(name)
        if joint is None:
            continue
        screw = locate_screw(home, joint)
        if joint.type in ONE_DOF and screw is not None:
            motion = displacements[joint.parent]
            direction = motion[:, :3, :3] @ screw.direction
            point = motion[:, :3, :3] @ screw.point + motion[:, :3, 3]
            if joint.type == "prismatic":
                held = masses[name] * GRAVITY * (direction @ up)
            else:
                lever = moments[name] - masses[name] * point
                held = GRAVITY * np.einsum("ni,ni->n", np.cross(lever, np.broadcast_to(up, (count, 3))), direction)
            worst[joint.name] = float(np.abs(held).max())
        moments[joint.parent] = moments[joint.parent] + moments[name]
        masses[joint.parent] += masses[name]
    return worst
