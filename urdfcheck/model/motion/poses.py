"""Configurations of a robot: the neutral one, and samples over the joints' ranges."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.core.records import dataclass
from urdfcheck.facts.motion.kinematics import compute_joint_motions
from urdfcheck.model.parts import Joint
from urdfcheck.model.robot import Model
from urdfcheck.source.text.values import read_attribute_number

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array


ONE_DEGREE_OF_FREEDOM = frozenset({"revolute", "continuous", "prismatic"})
# A revolute joint whose range is wider than a turn to either side passes through every angle within one.
TURN = math.pi
# A range longer than this (m) means "unlimited", and no slide of a robot: such a joint is not moved.
LONGEST_SLIDE = 100.0
# The mass matrices of this many joints over all samples took 1 GiB (measured). Published robots have up to 101.
MOST_MOVING = 250


@dataclass(frozen=True, slots=True, eq=False)
class JointConfigurations:
    """Positions of joints in N configurations."""

    joints: tuple[Joint, ...]
    """The J joints."""
    values: Array
    """(N, J), rad or m."""

    def to_values_by_name(self, index: int) -> dict[str, float]:
        """Return one configuration, by the joint's name."""
        return {joint.name: float(v) for joint, v in zip(self.joints, self.values[index], strict=True)}


def get_sampling_range(joint: Joint) -> tuple[float, float]:
    """Return the range (rad or m) in which a joint is sampled: its limits, or a whole turn where it has none.

    A range that is inverted, malformed, or unlimited for a slide is empty: ``(0, 0)``.
    """
    if joint.type == "continuous":
        return -TURN, TURN
    lower, upper = joint.get_limit_value("lower"), joint.get_limit_value("upper")
    if lower is None or upper is None or not lower <= upper:
        return 0.0, 0.0
    if joint.type == "prismatic":
        return (lower, upper) if upper - lower <= LONGEST_SLIDE else (0.0, 0.0)
    if upper - lower <= 2 * TURN:
        return lower, upper
    return max(lower, -TURN), max(lower, -TURN) + 2 * TURN


def make_neutral_configuration(model: Model) -> JointConfigurations:
    """Make one configuration: every joint at zero, or at the limit nearest to it; followers where ``<mimic>`` puts them.

    :raises FactUnavailableError: when the tree is broken.
    """
    joints = _list_one_dof_joints(model)
    bounds = np.array([get_sampling_range(joint) for joint in joints]).reshape(-1, 2)
    return apply_mimics(JointConfigurations(joints, np.clip(np.zeros(len(joints)), bounds[:, 0], bounds[:, 1])[None]))


def sample_configurations(model: Model, count: int) -> JointConfigurations:
    """Sample ``count`` configurations, the first neutral, the others uniform over the ranges; the same in every run.

    :raises FactUnavailableError: when the tree is broken, or more joints move than motion is computed for.
    """
    neutral = make_neutral_configuration(model)
    ensure_few_joints(neutral.joints)
    bounds = np.array([get_sampling_range(joint) for joint in neutral.joints]).reshape(-1, 2)
    n_others, n_joints = max(count - 1, 0), len(neutral.joints)
    shares = _generate_shares(n_others * n_joints).reshape(n_others, n_joints)
    values = bounds[:, 0] + shares * (bounds[:, 1] - bounds[:, 0])
    return JointConfigurations(
        neutral.joints,
        np.concatenate((neutral.values, apply_mimics(JointConfigurations(neutral.joints, values)).values)),
    )


def ensure_few_joints(joints: Sequence[Joint]) -> None:
    """Refuse more joints than motion is computed for.

    :raises FactUnavailableError: when more joints move.
    """
    if len(joints) > MOST_MOVING:
        raise FactUnavailableError(f"{len(joints):,} joints move, and motion is computed for {MOST_MOVING:,} at most")


def compute_frames(model: Model, configurations: JointConfigurations) -> Mapping[str, Array]:
    """Compute the placement (N, 4, 4) of each link's frame in the root link's frame in each configuration.

    :raises FactUnavailableError: when the tree is broken, or an origin or an axis is malformed.
    """
    column = {joint.name: i for i, joint in enumerate(configurations.joints)}
    count = len(configurations.values)
    frames = {model.tree.root: np.broadcast_to(np.eye(4), (count, 4, 4))}
    for name in model.tree.order[1:]:
        joint = model.tree.parent_joint[name]
        pose = joint.origin.matrix
        if pose is None:
            raise FactUnavailableError(f"the origin of joint {joint.name!r} is malformed")
        if joint.name not in column:
            frames[name] = frames[joint.parent] @ pose
            continue
        axis = np.array(joint.axis if joint.axis is not None else (0.0, 0.0, 0.0))
        norm = float(np.linalg.norm(axis))
        if norm == 0.0:
            raise FactUnavailableError(f"the axis of joint {joint.name!r} is zero or malformed (JNT001, XML007)")
        values = configurations.values[:, column[joint.name]]
        frames[name] = frames[joint.parent] @ (
            pose @ compute_joint_motions(axis / norm, values, rotates=joint.type != "prismatic")
        )
    return frames


def _generate_shares(count: int) -> Array:
    """Generate numbers in [0, 1), the same for ever: SplitMix64 (Steele, Lea and Flood, 2014) of a counter."""
    state = np.arange(1, count + 1, dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    state = (state ^ (state >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    state = (state ^ (state >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    shares: Array = ((state ^ (state >> np.uint64(31))) >> np.uint64(11)).astype(np.float64) * 2.0**-53
    return shares


def _list_one_dof_joints(model: Model) -> tuple[Joint, ...]:
    parents = model.tree.parent_joint
    return tuple(parents[n] for n in model.tree.order[1:] if parents[n].type in ONE_DEGREE_OF_FREEDOM)


def apply_mimics(configurations: JointConfigurations) -> JointConfigurations:
    """Put every follower at ``multiplier * leader + offset``; one that follows no known joint stays where it is."""
    column = {joint.name: i for i, joint in enumerate(configurations.joints)}
    values = configurations.values.copy()
    followers = {joint.name: mimic for joint in configurations.joints if (mimic := joint.mimic) is not None}
    followers_of: dict[str, list[str]] = {}
    for name, mimic in followers.items():
        followers_of.setdefault(mimic.get("joint"), []).append(name)
    done = [name for name in column if name not in followers]
    for leader in done:  # grows by followers, which may be followed; a circle is never reached
        for name in followers_of.get(leader, ()):
            multiplier, offset = (read_attribute_number(followers[name], word) for word in ("multiplier", "offset"))
            factor = 1.0 if multiplier is None else multiplier
            values[:, column[name]] = factor * values[:, column[leader]] + (offset or 0.0)
            done.append(name)
    return JointConfigurations(configurations.joints, values)


def normalize_axis(joint: Joint) -> Array:
    """Return the unit vector (3,) of a joint's axis, in the joint frame."""
    axis = np.array(joint.axis)
    unit: Array = axis / np.linalg.norm(axis)
    return unit
