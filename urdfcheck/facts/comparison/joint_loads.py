"""What each joint carries in both versions: what it holds against gravity, and the inertia that it accelerates.

Of a difference, the link is named that makes most of it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from urdfcheck.core.drop_test import GRAVITY
from urdfcheck.core.mechanism import MechanismJoint, MechanismLink
from urdfcheck.core.model_diff import JointTorque, MechanismEffect
from urdfcheck.facts.arrays import Array, Mat4
from urdfcheck.facts.comparison.alignment import PlacedPair, build_tensor
from urdfcheck.facts.comparison.home_pose import HomePose, locate_screw
from urdfcheck.facts.comparison.joints import ONE_DOF, ROTATING
from urdfcheck.facts.comparison.motion import JointSamples

# Shares by which a torque or an inertia must change to be reported.
_LEAST_CHANGE = 1e-3
# The least share of a difference that one link makes, if it is named: of two that are alike each makes half.
_MAIN_SHARE = 0.6

# What a link adds to the load of a joint that carries it, in one configuration: version, displacements, joint, link, row.
_Contribution = Callable[[HomePose, Mapping[str, Array], MechanismJoint, str, int], float]


def _find_main_link(
    pair: PlacedPair,
    moved: tuple[Mapping[str, Array], Mapping[str, Array]],
    joints: tuple[str, str],
    row: int,
    compute: _Contribution,
) -> str:
    """Return the link that makes most of the difference of a joint's load, as the first version names it, or as the
    second where it is new; empty where none does."""
    old, new = (
        {name: compute(home, displaced, home.joints[joint], name, row) for name in _list_links_below(home, joint)}
        for home, displaced, joint in zip((pair.before, pair.after), moved, joints, strict=True)
    )
    differences = {name: new.pop(pair.match.links.get(name, ""), 0.0) - value for name, value in old.items()} | new
    total = sum(differences.values())
    name = max(differences, key=lambda link: differences[link] * np.sign(total))
    return name if differences[name] * np.sign(total) >= _MAIN_SHARE * abs(total) > 0.0 else ""


def _list_links_below(home: HomePose, joint: str) -> list[str]:
    """Return the links that a joint carries."""
    links = [home.joints[joint].child]
    for link in links:
        links += [lower.child for lower in home.joints_below[link]]
    return links


# -- gravity -----------------------------------------------------------------------------------------------------------


def compare_torques(pair: PlacedPair, before: Mapping[str, Array], after: Mapping[str, Array]) -> Iterator[JointTorque]:
    """Yield the joints whose worst gravity torque differs.

    ``before``, ``after``: displacements of the links, see `compute_displacements`.
    """
    olds, news = _compute_held_loads(pair.before, before), _compute_held_loads(pair.after, after)
    for old, new in pair.match.joints.items():
        if old not in olds or new not in news:
            continue
        rows = int(np.argmax(np.abs(olds[old]))), int(np.argmax(np.abs(news[new])))
        first, second = float(np.abs(olds[old][rows[0]])), float(np.abs(news[new][rows[1]]))
        if abs(second - first) <= max(_LEAST_CHANGE * max(first, second), 1e-6):
            continue
        joint = pair.after.joints[new]
        yield JointTorque(
            joint=old,
            before=first,
            after=second,
            effort=joint.effort,
            unit="N" if joint.type == "prismatic" else "N·m",
            main_link=_find_main_link(
                pair, (before, after), (old, new), rows[second > first], _compute_held_contribution
            ),
        )


def _compute_held_loads(home: HomePose, displacements: Mapping[str, Array]) -> dict[str, Array]:
    """Compute the torque (N,) in N·m, or force in N, by which each joint holds what it carries against gravity, along z of the
    root."""
    masses = {name: link.mass or 0.0 for name, link in home.links.items()}
    moments = {name: _compute_mass_moments(home, name, displacements[name]) for name in home.links}
    held: dict[str, Array] = {}
    for name in reversed(home.order):
        joint = home.joint_above.get(name)
        if joint is None:
            continue
        if joint.type in ONE_DOF and joint.axis:
            held[joint.name] = _project_weight(home, joint, displacements[joint.parent], masses[name], moments[name])
        moments[joint.parent] = moments[joint.parent] + moments[name]
        masses[joint.parent] += masses[name]
    return held


def _compute_held_contribution(
    home: HomePose, displacements: Mapping[str, Array], joint: MechanismJoint, link: str, row: int
) -> float:
    here = slice(row, row + 1)
    moments = _compute_mass_moments(home, link, displacements[link][here])
    held = _project_weight(home, joint, displacements[joint.parent][here], home.links[link].mass or 0.0, moments)
    return float(held[0])


def _compute_mass_moments(home: HomePose, name: str, displaced: Array) -> Array:
    """Return mass times place (N, 3) of the COM of a link that is displaced (N, 4, 4)."""
    link, place = home.links[name], np.ones(4)
    place[:3] = home.frames[name][:3, :3] @ np.array(link.com or (0.0, 0.0, 0.0)) + home.frames[name][:3, 3]
    moments: Array = (link.mass or 0.0) * (displaced @ place)[:, :3]
    return moments


def _project_weight(home: HomePose, joint: MechanismJoint, above: Array, mass: float, moments: Array) -> Array:
    """Return the load (N,) of a joint whose parent is displaced by ``above`` (N, 4, 4), from what hangs on it."""
    screw = locate_screw(home, joint)
    if screw is None:
        return np.zeros(len(above))
    up = home.frames[home.mechanism.root][:3, 2]
    direction = above[:, :3, :3] @ screw.direction
    if joint.type == "prismatic":
        forces: Array = mass * GRAVITY * (direction @ up)
        return forces
    lever = moments - mass * (above[:, :3, :3] @ screw.point + above[:, :3, 3])
    torques: Array = GRAVITY * np.einsum("ni,ni->n", np.cross(lever, np.broadcast_to(up, lever.shape)), direction)
    return torques


# -- inertia -----------------------------------------------------------------------------------------------------------


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
            words={
                "unit": "kg m²" if joint.type in ROTATING else "kg",
                "main_link": _find_main_link(pair, (before, after), (old, new), row, _compute_inertia_contribution),
            },
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
    moments = {name: _compute_second_moments(home, name, displacements[name]) for name in home.links}
    found: dict[str, Array] = {}
    for name in reversed(home.order):
        joint = home.joint_above.get(name)
        if joint is None:
            continue
        if joint.type in ONE_DOF and joint.axis:
            found[joint.name] = _project_moment(home, joint, displacements[joint.parent], moments[name])
        moments[joint.parent] = moments[joint.parent] + moments[name]
    return found


def _compute_inertia_contribution(
    home: HomePose, displacements: Mapping[str, Array], joint: MechanismJoint, link: str, row: int
) -> float:
    here = slice(row, row + 1)
    moments = _compute_second_moments(home, link, displacements[link][here])
    return float(_project_moment(home, joint, displacements[joint.parent][here], moments)[0])


def _compute_second_moments(home: HomePose, name: str, displaced: Array) -> Array:
    """Return the second moment of mass (N, 4, 4) of a link that is displaced (N, 4, 4)."""
    moment = _compute_second_moment(home.links[name], home.frames[name])
    moments: Array = displaced @ moment @ np.swapaxes(displaced, -1, -2)
    return moments


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
