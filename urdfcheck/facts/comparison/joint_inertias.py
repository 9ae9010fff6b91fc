"""What each joint has to accelerate: the diagonal of the joint-space inertia matrix, in both versions."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from urdfcheck.core.mechanism import MechanismJoint, MechanismLink
from urdfcheck.core.model_diff import MechanismEffect
from urdfcheck.facts.arrays import Array, Mat4
from urdfcheck.facts.comparison.alignment import PlacedPair, build_tensor
from urdfcheck.facts.comparison.home_pose import HomePose, locate_screw
from urdfcheck.facts.comparison.joints import ONE_DOF, ROTATING
from urdfcheck.facts.comparison.motion import JointSamples

# Shares by which an inertia must change to be reported.
_LEAST_CHANGE = 1e-3


def compare_joint_inertias(
    pair: PlacedPair, samples: JointSamples, before: Mapping[str, Array], after: Mapping[str, Array]
) -> list[MechanismEffect]:
    """Return the joints that accelerate another inertia, alone, in some configuration; the largest share first.

    ``before``, ``after``: displacements of the links, see `compute_displacements`. The inertia of joint i is the element (i, i)
    of the mass matrix, without the rotor of its motor, which URDF does not describe.
    """
    olds, news = compute_joint_inertias(pair.before, before), compute_joint_inertias(pair.after, after)
    found = []
    for old, new in pair.match.joints.items():
        if old not in olds or new not in news:
            continue
        first, second = olds[old], news[new]
        share = np.abs(second - first) / np.maximum(np.maximum(first, second), 1e-300)
        row = int(np.argmax(share))
        if share[row] <= _LEAST_CHANGE:
            continue
        joint = pair.after.joints[new]
        is_constant = (
            float(np.ptp(first)) <= _LEAST_CHANGE * first[row] and float(np.ptp(second)) <= _LEAST_CHANGE * second[row]
        )
        effect = MechanismEffect(
            kind="inertia",
            id="joint-inertia",
            subject=f"joint[{old}]",
            numbers={"before": float(first[row]), "after": float(second[row]), "samples": float(samples.count)},
            words={"unit": "kg m²" if joint.type in ROTATING else "kg"},
            configuration={} if is_constant else _list_positions_below(pair.before, samples.before, old, row),
        )
        found.append((float(share[row]), effect))
    return [effect for _, effect in sorted(found, key=lambda entry: -entry[0])]


def _list_positions_below(home: HomePose, values: Mapping[str, Array], joint: str, row: int) -> dict[str, float]:
    """Return the positions of the joints that a joint carries."""
    positions: dict[str, float] = {}
    waiting = [home.joints[joint].child]
    while waiting:
        link = waiting.pop()
        for lower in home.joints_below[link]:
            positions |= {name: float(v[row]) for name, v in ((lower.name, values.get(lower.name)),) if v is not None}
            waiting.append(lower.child)
    return positions


def compute_joint_inertias(home: HomePose, displacements: Mapping[str, Array]) -> dict[str, Array]:
    """Compute the inertia (N,) that each joint accelerates, kg m² or kg, if the others keep still.

    By second moments of mass: ``∫ p pᵀ dm`` over homogeneous points p is moved by a transform T as ``T S Tᵀ``, and bodies add up.
    """
    moments = {
        name: displacements[name] @ _compute_second_moment(link, home.frames[name]) @ _transpose(displacements[name])
        for name, link in home.links.items()
    }
    found: dict[str, Array] = {}
    for name in reversed(home.order):
        joint = home.joint_above.get(name)
        if joint is None:
            continue
        if joint.type in ONE_DOF and joint.axis:
            found[joint.name] = _project_moment(home, joint, displacements[joint.parent], moments[name])
        moments[joint.parent] = moments[joint.parent] + moments[name]
    return found


def _transpose(matrices: Array) -> Array:
    return np.swapaxes(matrices, -1, -2)


def _compute_second_moment(link: MechanismLink, frame: Mat4) -> Mat4:
    """Return the second moment of mass of a link with its frame at ``frame``; what is not known of it counts as zero."""
    moment = np.zeros((4, 4))
    if not link.mass:
        return moment
    com = np.append(frame[:3, :3] @ np.array(link.com or (0.0, 0.0, 0.0)) + frame[:3, 3], 1.0)
    if link.tensor:
        tensor = build_tensor(link, frame)
        moment[:3, :3] = 0.5 * np.trace(tensor) * np.eye(3) - tensor
    moment += link.mass * np.outer(com, com)
    return moment


def _project_moment(home: HomePose, joint: MechanismJoint, above: Array, moments: Array) -> Array:
    """Return the inertia (N,) about or along the axis of a joint whose parent is displaced by ``above`` (N, 4, 4)."""
    mass = moments[:, 3, 3]
    screw = locate_screw(home, joint)
    if screw is None or joint.type == "prismatic":
        return mass
    direction = above[:, :3, :3] @ screw.direction
    point = above[:, :3, :3] @ screw.point + above[:, :3, 3]
    first = moments[:, :3, 3]
    about = (
        moments[:, :3, :3]
        - np.einsum("ni,nj->nij", first, point)
        - np.einsum("ni,nj->nij", point, first)
        + mass[:, None, None] * np.einsum("ni,nj->nij", point, point)
    )
    along = np.einsum("ni,nij,nj->n", direction, about, direction)
    inertias: Array = np.trace(about, axis1=1, axis2=2) - along
    return inertias
