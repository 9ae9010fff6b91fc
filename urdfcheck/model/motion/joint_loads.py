"""What the joints have to hold and to move, over sampled configurations of the robot with its root fixed upright."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.facts.motion import dynamics
from urdfcheck.model.motion.pinocchio_model import write_without_geometry
from urdfcheck.model.motion.poses import JointConfigurations, apply_mimics, get_sampling_range, sample_configurations
from urdfcheck.model.parts import Joint
from urdfcheck.model.rigid_bodies import compute_body_mass, compute_body_tensor, list_rigid_bodies
from urdfcheck.model.robot import Model
from urdfcheck.source.text.values import read_attribute_number
from urdfcheck.system.array_cache import origin_of, version_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from urdfcheck.facts.arrays import Array, Bools
    from urdfcheck.system.array_cache import Arrays


# Eigenvalues of all mass matrices would cost more than everything else, and a median settles soon.
_MATRIX_SAMPLES = 32
# Tops are climbed from so many of the worst samples: from twelve, five robots got none that is higher.
_CLIMB_STARTS = 3
# A top is climbed for so many joints, times all joints that are moved for it: for all of a robot with 101, the most in
# published ones, and of one with 250 for the worst 42. What was sampled is told of the others.
_MOST_CLIMBED = 10_500
# Configurations whose mass matrices are held at once.
_BATCH_SIZE = 500
# A single link is to blame for a condition number that a hundredth more inertia behind its joint makes ten times smaller.
_RELIEF = 10.0
# Links of one mass on different branches are one part that was used several times.
_ALIKE = 1e-3
_ROLLING = re.compile(r"wheel|tyre|cast[eo]r", re.IGNORECASE)
_AFLOAT = re.compile(r"buoyan|hydrodynam|underwater", re.IGNORECASE)
_CODE_MODULES = (
    "urdfcheck.facts.motion.dynamics",
    "urdfcheck.facts.motion.kinematics",
    "urdfcheck.model.motion.joint_loads",
    "urdfcheck.model.motion.poses",
)


@dataclass(frozen=True, slots=True, eq=False)
class Overload:
    """A joint that holds more than its effort limit in some configuration.

    ``torque`` (N·m or N, positive): the most that was found, at ``pose``, the values (rad or m) of the joints that it
    depends on; ``count``: in how many of the sampled configurations the limit is too small.
    """

    joint: Joint
    torque: float
    joint_values: Mapping[str, float]
    count: int


@dataclass(frozen=True, slots=True, eq=False)
class MassMatrixSummary:
    """How easily the joints move.

    ``number``: the median condition number of the scaled mass matrix. ``light``: the joint behind which too little
    inertia is the cause of it, None where there is no single one; it moves ``moved`` kg m² (kg) in the median
    configuration, of which ``own`` are its own body's.

    ``felt``: the least inertia that each joint feels in any configuration while the others move freely. ``rate`` (1/s): the
    fastest decay of velocities under the damping of all joints that are integrated explicitly, in the configuration in
    which one joint's own decay is the fastest.
    """

    condition_number: float
    light_joint: Joint | None
    own_inertia: float
    moved_inertia: float
    effective_inertias: Mapping[str, float]
    decay_rate: float


def find_overloads(model: Model) -> tuple[Overload, ...]:
    """The driven joints that cannot hold the robot against gravity wherever their limits allow, root fixed and upright.

    The torque on a follower counts for its leader, times the multiplier. Joints that are :func:`find_supported_joints` are left out.

    :raises Unavailable: when Pinocchio has no model, or a mass is negative.
    """
    for link in model.links:
        if link.inertial is not None and (link.inertial.mass or 0.0) < 0:
            raise FactUnavailableError(f"the mass of link {link.name!r} is negative (INR002)")
    poses = sample_configurations(model, model.samples)
    if not poses.joints:
        return ()
    found = _recall_or_compute(model, "statics", lambda: _compute_statics(model, poses))
    moved = _compute_joint_coupling(poses)

    def select_joint_values(place: int, values: Array) -> dict[str, float]:
        near = _find_involved_joints(model, poses, moved, place)
        return {joint.name: float(v) for joint, v, n in zip(poses.joints, values, near, strict=True) if n}

    where = zip(found["joint"], found["torque"], found["values"], found["count"], strict=True)
    return tuple(
        Overload(poses.joints[i], float(torque), select_joint_values(i, values), int(count))
        for i, torque, values, count in where
    )


def summarize_mass_matrix(model: Model) -> MassMatrixSummary | None:
    """How the joint-space inertia is spread, with every joint free, followers too; None where no joint moves.

    :raises Unavailable: when Pinocchio has no model, or a body that moves has no mass or no inertia.
    """
    poses = sample_configurations(model, model.samples)
    if not poses.joints:
        return None
    _ensure_inertias(model)
    found = _recall_or_compute(model, "mobility", lambda: _measure_mass_matrix(model, poses))
    number, light, own, moved, rate = found["summary"].tolist()
    return MassMatrixSummary(
        number,
        None if light < 0 else poses.joints[int(light)],
        own,
        moved,
        {joint.name: float(value) for joint, value in zip(poses.joints, found["felt"], strict=True)},
        rate,
    )


def read_damping(joint: Joint) -> float:
    """Viscous damping in N·m·s/rad or N·s/m; 0 where none is given."""
    return max(read_attribute_number(joint.element.find_child("dynamics"), "damping") or 0.0, 0.0)


def list_implicit_joints(model: Model) -> frozenset[str]:
    """The joints for which the file asks Gazebo to integrate the damping implicitly."""
    return frozenset(_find_gazebo_references(model, {"implicitSpringDamper", "cfmDamping"}, {"true", "1"}))


def find_supported_joints(model: Model) -> frozenset[str]:
    """The joints whose load the tree does not tell, because something else than their motor takes a part of it.

    The robot is afloat, something behind them stands on the ground, has its gravity turned off or belongs to a loop that
    Gazebo closes, or a spring turns them.
    """
    tree = model.tree
    plugins = [plugin for gazebo in model.robot.find_children("gazebo") for plugin in gazebo.find_children("plugin")]
    if any(_AFLOAT.search(plugin.get("filename") + plugin.get("name")) for plugin in plugins):
        return frozenset(joint.name for joint in model.joints)
    on_the_ground = {name for name in tree.order if _ROLLING.search(name)}
    weightless = _find_gazebo_references(model, {"turnGravityOff"}, {"true", "1"}) | _find_gazebo_references(
        model, {"gravity"}, {"false", "0"}
    )
    found = {joint.name for name in (on_the_ground | weightless) & set(tree.order) for joint in tree.find_path_to(name)}
    for loop in (joint for gazebo in model.robot.find_children("gazebo") for joint in gazebo.find_children("joint")):
        ends = [element.text.strip() for tag in ("parent", "child") if (element := loop.find_child(tag)) is not None]
        paths = [{joint.name for joint in tree.find_path_to(name)} for name in ends if name in tree.order]
        found |= paths[0] ^ paths[1] if len(paths) == 2 else set().union(*paths)
    return frozenset(
        found | {g.get("reference") for g in model.robot.find_children("gazebo") if g.find_child("springStiffness")}
    )


def _find_gazebo_references(model: Model, tags: set[str], answers: set[str]) -> set[str]:
    """The links and joints to which a ``<gazebo reference>`` gives one of these tags with one of these words."""
    return {
        gazebo.get("reference")
        for gazebo in model.robot.find_children("gazebo")
        for child in gazebo.children
        if child.tag in tags and child.text.strip().lower() in answers
    }


def _recall_or_compute(model: Model, group: str, compute: Callable[[], Arrays]) -> Arrays:
    """The arrays of a group, from the cache where the same model was looked at in the same way."""
    asked = (" ".join(sorted(names)) for names in (find_supported_joints(model), list_implicit_joints(model)))
    parts = (
        version_of(*_CODE_MODULES, library=origin_of("pinocchio")),
        write_without_geometry(model.robot),
        str(model.samples),
        *asked,
    )
    entry = model.cache.entry("dynamics", hashlib.sha256("\0".join(parts).encode()).hexdigest())
    if group not in entry:
        entry[group] = compute()
    return entry[group]


def _get_pinocchio_model(model: Model) -> Any:
    built = model.dynamics
    if built.model is None:
        raise FactUnavailableError(f"{built.refused_by} refuses the model (XML014)")
    return built.model


def _compute_statics(model: Model, poses: JointConfigurations) -> Arrays:
    """Of each joint that holds more than its effort: ``joint`` (K,) its place in ``poses``, ``torque`` (K,), ``values``
    (K, J) where, and ``count`` (K,) of configurations."""
    built = _get_pinocchio_model(model)
    data = built.createData()
    places = dynamics.locate_joint_coordinates(built, [joint.name for joint in poses.joints])
    moved = _compute_joint_coupling(poses)

    def compute_torques(of: int | slice, values: Array) -> Array:
        every = dynamics.compute_gravity_torques(built, data, dynamics.build_configurations(places, values))
        held: Array = every[:, places.velocity] @ moved[:, of]
        return held

    size = np.abs(compute_torques(slice(None), poses.values))
    excused = find_supported_joints(model)
    efforts = np.array([_get_effort_limit(joint) for joint in poses.joints])
    efforts[moved.T @ [joint.name in excused for joint in poses.joints] != 0] = np.inf
    count = (size > efforts).sum(axis=0)
    ranges = np.array([get_sampling_range(joint) for joint in poses.joints])
    over = np.flatnonzero(count)
    most = size[:, over].max(axis=0, initial=0.0)
    climbed = over[np.argsort(-most / efforts[over], kind="stable")[: _MOST_CLIMBED // max(1, len(poses.joints))]]
    loads = []
    for i in over:
        if i not in climbed:
            worst = int(size[:, i].argmax())
            loads.append(dynamics.JointLoad(float(size[worst, i]), poses.values[worst]))
            continue
        near = _find_involved_joints(model, poses, moved, int(i))
        tried = np.flatnonzero(moved[near].any(axis=0)).tolist()
        starts = poses.values[np.argsort(-size[:, i], kind="stable")[:_CLIMB_STARTS]]
        tops = [
            dynamics.find_largest_load(
                partial(compute_torques, int(i)), start, ranges=ranges, coupling=moved, joints=tried
            )
            for start in starts
        ]
        loads.append(max(tops, key=lambda top: top.torque))
    values = np.array([load.values for load in loads]).reshape(-1, len(poses.joints))
    return {
        "joint": over,
        "torque": np.array([load.torque for load in loads]),
        "values": values,
        "count": count[over],
    }


def _measure_mass_matrix(model: Model, poses: JointConfigurations) -> Arrays:
    """``summary`` (5,): number, place of the light joint in ``poses`` or -1, own, moved, rate; ``felt`` (J,)."""
    built = _get_pinocchio_model(model)
    data = built.createData()
    places = dynamics.locate_joint_coordinates(built, [joint.name for joint in poses.joints])
    columns = places.velocity
    q = dynamics.build_configurations(places, poses.values)
    matrices = dynamics.compute_mass_matrices(built, data, q[:_MATRIX_SAMPLES])
    felt = np.concatenate(
        [
            dynamics.compute_effective_inertias(
                dynamics.compute_inverse_mass_matrices(built, data, q[start : start + _BATCH_SIZE])
            )
            for start in range(0, len(q), _BATCH_SIZE)
        ]
    )[:, columns]
    worst = dynamics.measure_conditioning(matrices)
    light, own, moved = -1, 0.0, 0.0
    for i in _find_limiting_joints(model, poses.joints, matrices, columns, worst):
        mine = dynamics.compute_own_inertia(built, poses.joints[i].name, q[worst.index])
        all_of_it = float(matrices[worst.index, columns[i], columns[i]])
        if mine < all_of_it * dynamics.ADDED_INERTIA_SHARE:
            light, own, moved = i, mine, all_of_it
            break
    dampings = np.zeros(built.nv)
    asked = list_implicit_joints(model)
    dampings[columns] = [0.0 if joint.name in asked else read_damping(joint) for joint in poses.joints]
    fastest = int((dampings[columns] / felt).max(axis=1).argmax())
    (inverse,) = dynamics.compute_inverse_mass_matrices(built, data, q[[fastest]])
    rate = dynamics.compute_damping_rate(inverse, dampings) if dampings.any() else 0.0
    summary = np.array([worst.number, light, own, moved, rate])
    return {"summary": summary, "felt": felt.min(axis=0)}


def _find_limiting_joints(
    model: Model, joints: Sequence[Joint], matrices: Array, columns: NDArray[np.intp], worst: dynamics.Conditioning
) -> Iterator[int]:
    """The joints behind which more inertia would mend the condition number by itself, or with their twins."""
    if (
        worst.number * dynamics.ADDED_INERTIA_SHARE < 1
    ):  # no body is that light: two joints alone would make it 4 / SHARE
        return
    for i in np.argsort(-np.abs(worst.direction[columns]), kind="stable")[:3].tolist():
        alike = columns[[i, *_find_equal_mass_joints(model, joints, i)]]
        if dynamics.measure_relieved_conditioning(matrices, alike.tolist()) * _RELIEF < worst.number:
            yield i


def _find_equal_mass_joints(model: Model, joints: Sequence[Joint], place: int) -> list[int]:
    """The joints on other branches that move a body of the same mass."""
    masses = [compute_body_mass(model, model.tree.list_body_links(joint.child)) or 0.0 for joint in joints]
    chain = _collect_chain_names(model, joints[place])
    return [
        k
        for k, joint in enumerate(joints)
        if joint.name not in chain and abs(masses[k] - masses[place]) <= _ALIKE * masses[place]
    ]


def _collect_chain_names(model: Model, joint: Joint) -> frozenset[str]:
    """The names of a joint, of those before it and of those behind it."""
    tree = model.tree
    behind = [joint]
    for other in behind:
        behind.extend(tree.child_joints[other.child])
    return frozenset(other.name for other in (*tree.find_path_to(joint.parent), *behind))


def _find_involved_joints(model: Model, poses: JointConfigurations, moved: Array, place: int) -> Bools:
    """(J,): which joints decide what a joint holds, with all that follow it."""
    names = [joint.name for joint in poses.joints]
    chains = [_collect_chain_names(model, poses.joints[k]) for k in np.flatnonzero(moved[:, place])]
    return np.array([any(name in chain for chain in chains) for name in names])


def _compute_joint_coupling(poses: JointConfigurations) -> Array:
    """(J, J): column i is how all joints move with joint i; empty for a follower, which moves with its leader."""
    count = len(poses.joints)
    still, single = (
        apply_mimics(JointConfigurations(poses.joints, v)).values for v in (np.zeros((1, count)), np.eye(count))
    )
    shares: Array = (single - still).T
    return shares


def _get_effort_limit(joint: Joint) -> float:
    """The effort limit of a driven joint; infinite where there is none to compare with (JNT007 reports zero)."""
    effort = joint.get_limit_value("effort")
    return effort if joint.is_driven and effort is not None and effort > 0 else np.inf


def _ensure_inertias(model: Model) -> None:
    """:raises Unavailable: when a body that moves has no mass, or its tensor is not that of a body."""
    for body in list_rigid_bodies(model):
        if not body.is_movable:
            continue
        mass = compute_body_mass(model, body.links)
        if mass is None or mass <= 0:
            raise FactUnavailableError(f"link {body.links[0]!r} is moved by a joint and has no mass (INR001, INR002)")
        tensor = compute_body_tensor(model, body.links)
        moments = None if tensor is None else np.linalg.eigvalsh(tensor)
        if moments is None or not moments[0] > 1e-9 * moments[2]:
            raise FactUnavailableError(
                f"the inertia tensor of link {body.links[0]!r} is that of no solid body (INR004)"
            )
