"""What the joints have to hold and to move, over sampled configurations of the robot with its root fixed upright."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.core.records import dataclass
from urdfcheck.facts.motion import dynamics
from urdfcheck.model.motion.buoyancy import has_buoyancy_plugin
from urdfcheck.model.motion.pinocchio_model import pinocchio_model, write_without_geometry
from urdfcheck.model.motion.poses import JointConfigurations, apply_mimics, get_sampling_range, sample_configurations
from urdfcheck.model.parts import Joint
from urdfcheck.model.rigid_bodies import compute_body_mass, compute_body_tensor, list_rigid_bodies
from urdfcheck.model.robot import Model
from urdfcheck.source.text.values import read_attribute_number
from urdfcheck.system.installation import compute_code_version, find_library_origin

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from urdfcheck.facts.arrays import Array, Bools
    from urdfcheck.system.array_cache import Arrays


# Eigenvalues of all mass matrices would cost more than everything else, and a median settles soon.
_MATRIX_SAMPLES = 32
# A maximum is climbed to from this many of the worst samples: from twelve, no maximum of five robots was higher.
_CLIMB_STARTS = 3
# Maxima are climbed to for this many joints, times all joints that are moved for it: for all of a robot with 101, the most in
# published ones, and for the worst 42 of one with 250. Of the others the largest sample is reported.
_MOST_CLIMBED = 10_500
# Configurations whose mass matrices are in memory together.
_BATCH_SIZE = 500
# A link is the cause of a condition number that a hundredth more inertia behind its joint makes ten times smaller.
_RELIEF = 10.0
# Links whose masses differ by less than this share, on different branches, are one part that was used several times.
_ALIKE = 1e-3
_ROLLING = re.compile(r"wheel|tyre|cast[eo]r", re.IGNORECASE)
_CODE_MODULES = (
    "urdfcheck.facts.motion.dynamics",
    "urdfcheck.facts.motion.kinematics",
    "urdfcheck.model.motion.joint_loads",
    "urdfcheck.model.motion.poses",
)


@dataclass(frozen=True, slots=True, eq=False)
class Overload:
    """A joint that holds more than its effort limit in some configuration."""

    joint: Joint
    torque: float
    """The most that was computed, N·m or N, positive."""
    joint_values: Mapping[str, float]
    """Where: the values (rad or m) of the joints that it depends on, by name."""
    count: int
    """The number of sampled configurations in which the limit is too small."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MassMatrixSummary:
    """How easily the joints move."""

    condition_number: float
    """The median condition number of the scaled mass matrix."""
    light_joint: Joint | None
    """The joint behind which too little inertia causes it; None where there is no single one."""
    own_inertia: float
    """What the light joint's own body has of ``moved_inertia``."""
    moved_inertia: float
    """What the light joint moves in the median configuration, kg m² (kg)."""
    effective_inertias: Mapping[str, float]
    """The least inertia that each joint feels in any configuration while the others move freely."""
    decay_rate: float
    """1/s. The fastest decay of velocities under the damping of all joints that are integrated explicitly, in the
    configuration in which one joint's own decay is the fastest.
    """


def find_overloads(model: Model) -> tuple[Overload, ...]:
    """Find the driven joints that cannot hold the robot against gravity wherever their limits allow.

    Its root is fixed and upright. The torque on a follower counts for its leader, times the multiplier. The joints of
    :func:`find_supported_joints` are left out.

    :raises FactUnavailableError: when Pinocchio has no model, or a mass is negative.
    """
    for link in model.links:
        if link.inertial is not None and (link.inertial.mass or 0.0) < 0:
            raise FactUnavailableError(f"the mass of link {link.name!r} is negative (INR002)")
    poses = sample_configurations(model, model.samples)
    if not poses.joints:
        return ()
    arrays = _recall_or_compute(model, "statics", lambda: _compute_statics(model, poses))
    coupling = _compute_joint_coupling(poses)

    def select_joint_values(index: int, values: Array) -> dict[str, float]:
        involved = _find_involved_joints(model, poses, coupling=coupling, index=index)
        return {j.name: float(v) for j, v, counts in zip(poses.joints, values, involved, strict=True) if counts}

    rows = zip(arrays["joint"], arrays["torque"], arrays["values"], arrays["count"], strict=True)
    return tuple(
        Overload(
            joint=poses.joints[i],
            torque=float(torque),
            joint_values=select_joint_values(i, values),
            count=int(count),
        )
        for i, torque, values, count in rows
    )


def summarize_mass_matrix(model: Model) -> MassMatrixSummary | None:
    """Summarize how the joint-space inertia is spread, with every joint free, followers too; None where no joint moves.

    :raises FactUnavailableError: when Pinocchio has no model, or a body that moves has no mass or no inertia.
    """
    poses = sample_configurations(model, model.samples)
    if not poses.joints:
        return None
    _ensure_inertias(model)
    arrays = _recall_or_compute(model, "mobility", lambda: _measure_mass_matrix(model, poses))
    number, light, own, moved, rate = arrays["summary"].tolist()
    return MassMatrixSummary(
        condition_number=number,
        light_joint=None if light < 0 else poses.joints[int(light)],
        own_inertia=own,
        moved_inertia=moved,
        effective_inertias={j.name: float(value) for j, value in zip(poses.joints, arrays["felt"], strict=True)},
        decay_rate=rate,
    )


def list_carried_links(model: Model, joint: Joint) -> list[str]:
    """List the names of the links behind a joint, its child first.

    :raises FactUnavailableError: when the links are not one tree.
    """
    carried = [joint.child]
    for name in carried:
        carried.extend(behind.child for behind in model.tree.child_joints[name])
    return carried


def read_damping(joint: Joint) -> float:
    """Read the viscous damping in N·m·s/rad or N·s/m; 0 where none is given."""
    return max(read_attribute_number(joint.element.find_child("dynamics"), "damping") or 0.0, 0.0)


def list_implicit_joints(model: Model) -> frozenset[str]:
    """Return the joints for which the file asks Gazebo to integrate the damping implicitly."""
    return frozenset(_find_gazebo_references(model, {"implicitSpringDamper", "cfmDamping"}, {"true", "1"}))


def find_supported_joints(model: Model) -> frozenset[str]:
    """Return the joints whose load the tree does not show, because something other than their motor takes a part of it.

    The robot is afloat; or something behind the joint is on the ground, has its gravity turned off or belongs to a loop
    that Gazebo closes; or a spring turns the joint.
    """
    tree = model.tree
    if has_buoyancy_plugin(model):
        return frozenset(joint.name for joint in model.joints)
    on_the_ground = {name for name in tree.order if _ROLLING.search(name)}
    supported = {
        joint.name
        for name in (on_the_ground | find_weightless_links(model)) & set(tree.order)
        for joint in tree.find_path_to(name)
    }
    for loop in (joint for gazebo in model.robot.find_children("gazebo") for joint in gazebo.find_children("joint")):
        ends = [element.text.strip() for tag in ("parent", "child") if (element := loop.find_child(tag)) is not None]
        paths = [{joint.name for joint in tree.find_path_to(name)} for name in ends if name in tree.order]
        supported |= paths[0] ^ paths[1] if len(paths) == 2 else set().union(*paths)
    return frozenset(
        supported | {g.get("reference") for g in model.robot.find_children("gazebo") if g.find_child("springStiffness")}
    )


def find_weightless_links(model: Model) -> set[str]:
    """Return the links whose gravity the file turns off in Gazebo."""
    off = _find_gazebo_references(model, {"turnGravityOff"}, {"true", "1"})
    return off | _find_gazebo_references(model, {"gravity"}, {"false", "0"})


def _find_gazebo_references(model: Model, tags: set[str], answers: set[str]) -> set[str]:
    """Return the links and joints to which a ``<gazebo reference>`` gives one of these tags with one of these words."""
    return {
        gazebo.get("reference")
        for gazebo in model.robot.find_children("gazebo")
        for child in gazebo.children
        if child.tag in tags and child.text.strip().lower() in answers
    }


def _recall_or_compute(model: Model, group: str, compute: Callable[[], Arrays]) -> Arrays:
    """Return the arrays of a group, from the cache where it holds them for the same model and settings."""
    excepted = (" ".join(sorted(names)) for names in (find_supported_joints(model), list_implicit_joints(model)))
    parts = (
        compute_code_version(*_CODE_MODULES, library=find_library_origin("pinocchio")),
        write_without_geometry(model),
        str(model.samples),
        *excepted,
    )
    entry = model.cache.entry("dynamics", hashlib.sha256("\0".join(parts).encode()).hexdigest())
    if group not in entry:
        entry[group] = compute()
    return entry[group]


def _get_pinocchio_model(model: Model) -> Any:
    built = pinocchio_model(model)
    if built.model is None:
        raise FactUnavailableError(f"{built.refused_by} refuses the model (XML014)")
    return built.model


def _compute_statics(model: Model, poses: JointConfigurations) -> Arrays:
    """Compute the joints that hold more than their effort.

    ``joint`` (K,) their indices in ``poses``, ``torque`` (K,), ``values`` (K, J) where, and ``count`` (K,) of configurations.
    """
    built = _get_pinocchio_model(model)
    data = built.createData()
    places = dynamics.locate_joint_coordinates(built, [joint.name for joint in poses.joints])
    coupling = _compute_joint_coupling(poses)

    def compute_torques(of: int | slice, values: Array) -> Array:
        every = dynamics.compute_gravity_torques(built, data, dynamics.build_configurations(places, values))
        torques: Array = every[:, places.velocity] @ coupling[:, of]
        return torques

    size = np.abs(compute_torques(slice(None), poses.values))
    supported = find_supported_joints(model)
    efforts = np.array([_get_effort_limit(joint) for joint in poses.joints])
    efforts[coupling.T @ [joint.name in supported for joint in poses.joints] != 0] = np.inf
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
        involved = _find_involved_joints(model, poses, coupling=coupling, index=int(i))
        tried = np.flatnonzero(coupling[involved].any(axis=0)).tolist()
        starts = poses.values[np.argsort(-size[:, i], kind="stable")[:_CLIMB_STARTS]]
        compute = partial(compute_torques, int(i))
        tops = [
            dynamics.find_largest_load(compute, start=start, ranges=ranges, coupling=coupling, joints=tried)
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
    """Measure the mass matrices.

    ``summary`` (5,): condition number, index of the light joint in ``poses`` or -1, its own and its moved inertia, decay rate;
    ``felt`` (J,): the effective inertias.
    """
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
    for i in _list_suspected_joints(columns, worst):
        own_inertia = dynamics.compute_own_inertia(built, poses.joints[i].name, q[worst.index])
        moved_inertia = float(matrices[worst.index, columns[i], columns[i]])
        is_light = own_inertia < moved_inertia * dynamics.ADDED_INERTIA_SHARE
        if not is_light:
            continue
        # This question takes ten times as long as all else.
        alike = [poses.joints[k].name for k in (i, *_find_equal_mass_joints(model, poses.joints, i))]
        more = dict.fromkeys(alike, dynamics.ADDED_INERTIA_SHARE * moved_inertia)
        relieved = matrices + dynamics.compute_added_matrices(built, q[: len(matrices)], more)
        if dynamics.measure_conditioning(relieved).number * _RELIEF < worst.number:
            light, own, moved = i, own_inertia, moved_inertia
            break
    dampings = np.zeros(built.nv)
    implicit = list_implicit_joints(model)
    dampings[columns] = [0.0 if joint.name in implicit else read_damping(joint) for joint in poses.joints]
    fastest = int((dampings[columns] / felt).max(axis=1).argmax())
    (inverse,) = dynamics.compute_inverse_mass_matrices(built, data, q[[fastest]])
    rate = dynamics.compute_damping_rate(inverse, dampings) if dampings.any() else 0.0
    summary = np.array([worst.number, light, own, moved, rate])
    return {"summary": summary, "felt": felt.min(axis=0)}


def _list_suspected_joints(columns: NDArray[np.intp], worst: dynamics.Conditioning) -> list[int]:
    """List the joints that move most in the direction of least inertia; none where the condition number is too small for a
    light body to be its cause."""
    # With a body as light as that, two joints alone would make the number 4 / SHARE.
    if worst.number * dynamics.ADDED_INERTIA_SHARE < 1:
        return []
    suspected: list[int] = np.argsort(-np.abs(worst.direction[columns]), kind="stable")[:3].tolist()
    return suspected


def _find_equal_mass_joints(model: Model, joints: Sequence[Joint], index: int) -> list[int]:
    """Return the joints on other branches that move a body of the same mass."""
    masses = [compute_body_mass(model, model.tree.list_body_links(joint.child)) or 0.0 for joint in joints]
    chain = _collect_chain_names(model, joints[index])
    return [
        k
        for k, joint in enumerate(joints)
        if joint.name not in chain and abs(masses[k] - masses[index]) <= _ALIKE * masses[index]
    ]


def _collect_chain_names(model: Model, joint: Joint) -> frozenset[str]:
    """Return the names of a joint, of those before it and of those behind it."""
    tree = model.tree
    behind = [joint]
    for other in behind:
        behind.extend(tree.child_joints[other.child])
    return frozenset(other.name for other in (*tree.find_path_to(joint.parent), *behind))


def _find_involved_joints(model: Model, poses: JointConfigurations, *, coupling: Array, index: int) -> Bools:
    """Return (J,) which joints decide what a joint holds, with all that follow it."""
    names = [joint.name for joint in poses.joints]
    chains = [_collect_chain_names(model, poses.joints[k]) for k in np.flatnonzero(coupling[:, index])]
    return np.array([any(name in chain for chain in chains) for name in names])


def _compute_joint_coupling(poses: JointConfigurations) -> Array:
    """Compute (J, J): column i is how all joints move with joint i; empty for a follower, which moves with its leader."""
    count = len(poses.joints)
    still, single = (
        apply_mimics(JointConfigurations(poses.joints, v)).values for v in (np.zeros((1, count)), np.eye(count))
    )
    shares: Array = (single - still).T
    return shares


def _get_effort_limit(joint: Joint) -> float:
    """Return the effort limit of a driven joint; infinite where there is none to compare with (JNT007 reports zero)."""
    effort = joint.get_limit_value("effort")
    return effort if joint.is_driven and effort is not None and effort > 0 else np.inf


def _ensure_inertias(model: Model) -> None:
    """Refuse bodies that move and have no proper inertia.

    :raises FactUnavailableError: when a body that moves has no mass, or its tensor is not that of a body.
    """
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
                f"the inertia tensor of link {body.links[0]!r} is impossible for a solid body (INR004)"
            )
