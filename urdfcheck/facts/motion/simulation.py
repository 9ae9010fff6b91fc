"""A mechanism that is released on a plane, by MuJoCo: what moves, what touches, and how its energy changes.

MuJoCo steps rigid bodies in joint coordinates; contacts and limits are soft constraints (Todorov, *Convex and
analytically-invertible dynamics with contacts and constraints in MuJoCo*, 2014). Bodies touch the plane only, not each other.
z points up, against gravity.
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core.drop_test import GRAVITY
from urdfcheck.core.records import dataclass

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from urdfcheck.facts.arrays import Array, Mat3, Mat4, Vec3

# s between two samples of a moving mechanism: a fall of half a millimetre.
SAMPLING_INTERVAL = 0.01
# s at the end over which speeds and loads are averaged.
AVERAGING_WINDOW = 0.25
# rad/s: the frequency of a held joint. At a step of 1 ms it takes 31 steps to swing once, far below the 2/step at which an
# explicit spring becomes unstable, and a leg that carries thirty times its own inertia stays straight.
STIFFNESS = 200.0
# MuJoCo's default for contacts and limits: time constant (s), damping ratio, and impedance where they just touch.
SOFTNESS, DAMPING_RATIO, IMPEDANCE = 0.02, 1.0, 0.9


class SimulationRefusedError(Exception):
    """MuJoCo rejects the mechanism; its reason, and the ``element`` that it names (b3: the body at index 3)."""

    def __init__(self, reason: str, element: str) -> None:
        super().__init__(reason)
        self.element = element


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Geom:
    """A shape of a body."""

    body: int
    """Index of the body; -1 for the ground that everything is fixed to."""
    kind: str
    """box, cylinder, sphere, capsule or hull."""
    size: tuple[float, ...]
    """In m, as in URDF."""
    pose: Mat4
    """In the body's frame."""
    points: Array | None = None
    """(K, 3) of a hull."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class SimulatedJoint:
    """How a body moves against its parent."""

    kind: str
    """hinge, slide, floating or planar."""
    axis: Vec3
    """Unit vector."""
    range: tuple[float, float] | None = None
    """rad or m; None without limits."""
    damping: float = 0.0
    """Viscous, N·m·s/rad or N·s/m."""
    friction: float = 0.0
    """Coulomb, N·m or N."""
    start_value: float = 0.0
    """Value at which the joint is released, rad or m."""
    effort: float | None = None
    """What the joint can hold, N·m or N; infinite without a limit; None if it is not driven."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class RigidBody:
    """A rigid body that a joint connects to another, or to the ground."""

    parent: int
    """Index of the other body; -1 for the ground."""
    pose: Mat4
    """In the parent's frame with the joint at 0."""
    joint: SimulatedJoint
    mass: float
    """kg."""
    com: Vec3
    """In m, in the body's frame."""
    inertia: Mat3
    """In kg m² about the COM, in the body's frame."""


@dataclass(frozen=True, slots=True, eq=False)
class Follower:
    """The joint of body ``body`` follows that of body ``leader``: ``multiplier`` times its value, plus ``offset``."""

    body: int
    leader: int
    multiplier: float
    offset: float


@dataclass(frozen=True, slots=True, eq=False)
class Mechanism:
    """Bodies, each after its parent; the first one carries the root's frame unless it is the ground itself (``grounded``)."""

    bodies: Sequence[RigidBody]
    geoms: Sequence[Geom]
    followers: Sequence[Follower]
    grounded: bool


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MotionTrace:
    """The outcome of a simulation, or of the time until it diverged."""

    time: Array
    """(N,), s."""
    energy: Array
    """(N,), J, kinetic and potential."""
    speed: Array
    """(N,), m/s, of the fastest body: the root mean square over its mass."""
    burst_time: float | None
    """When the simulation diverged (s); None if it did not."""
    fastest_body: int
    """The fastest body of all times."""
    last_fastest_body: int
    """The fastest body within the last `AVERAGING_WINDOW`."""
    root_pose: Mat4
    """The root's frame at the end."""
    tilt: float
    """Angle of the root's z axis from that at the beginning (rad); NaN if the simulation diverged."""
    touching: Sequence[PlaneContact]
    """The contacts with the plane at the end."""
    saturated: Sequence[int]
    """Bodies whose joints need all their effort at the end."""
    joint_offsets: Array
    """How far each body's joint is from where it was released (rad or m); 0 for other than one degree of freedom."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PlaneContact:
    """A geom on the plane."""

    geom: int
    """Index of the geom."""
    points: int
    """Number of contact points."""
    place: Vec3
    """Middle of the contact points on the geom's surface (m), in the root's frame."""
    lowest: float
    """Least z of the contact points (m), in the root's frame."""
    depth: float
    """Of the deepest below the plane (m)."""
    load: float
    """Normal force on all (N), averaged over the last `AVERAGING_WINDOW`."""


def compute_rest_depth(gravity: float = GRAVITY) -> float:
    """Compute how deep (m) a body at rest is in the plane, with MuJoCo's default softness.

    A constraint's acceleration is ``(1 - d) a0 + d (-b v - k r)`` (MuJoCo's documentation, *Computation*), zero at rest, where
    a0 = -g is the acceleration without it and ``k = 1 / (d_max² t² ζ²)``: ``r = (1 - d)/d · g · (d_max t ζ)²``, 0.39 mm for
    any mass.
    """
    return (1 - IMPEDANCE) / IMPEDANCE * gravity * (0.95 * SOFTNESS * DAMPING_RATIO) ** 2


def compute_lowest_height(geom: Geom, pose: Array) -> float:
    """Compute the least z (m) of a geom whose body is at ``pose`` (4, 4)."""
    placed = pose @ geom.pose
    up, height = placed[2, :3], float(placed[2, 3])
    if geom.points is not None:
        return height + float((geom.points @ up).min())
    if geom.kind == "box":
        return height - float(np.abs(up) @ np.array(geom.size)) / 2
    if geom.kind == "sphere":
        return height - geom.size[0]
    radius, length = geom.size
    across = radius if geom.kind == "capsule" else radius * math.sqrt(max(0.0, 1.0 - float(up[2]) ** 2))
    return height - abs(float(up[2])) * length / 2 - across


class Simulation:
    """A mechanism in MuJoCo, with a plane below it at the height ``ground`` (m) in the root's frame when it is released.

    :raises ImportError: when MuJoCo is not installed.
    :raises SimulationRefusedError: when MuJoCo rejects it.
    """

    def __init__(self, mechanism: Mechanism, ground: float) -> None:
        self.mechanism = mechanism
        self._mujoco = _import_mujoco()
        try:
            spec = _build_spec(self._mujoco, mechanism, ground)
            self._adjust_spec(spec)
            self._model = spec.compile()
        except (ValueError, RuntimeError, self._mujoco.FatalError) as error:
            reason, _, element = str(error).partition("\n")
            raise SimulationRefusedError(reason.removeprefix("Error: "), element) from None
        self._data = self._mujoco.MjData(self._model)
        self._reset_state()
        self._set_motor_gains()

    @cached_property
    def weight(self) -> float:
        """Weight of all bodies in N."""
        return GRAVITY * sum(body.mass for body in self.mechanism.bodies)

    @property
    def version(self) -> str:
        """Version of MuJoCo."""
        version: str = self._mujoco.__version__
        return version

    def run(self, seconds: float, step: float, *, hold_joints: bool, implicit_damping: bool = True) -> MotionTrace:
        """Release the mechanism and simulate it for so many ``seconds`` with this time ``step`` (s).

        ``hold_joints``: with torques that hold the joints where they are; without torques otherwise. ``implicit_damping``:
        whether damping is computed from the velocity after a step (MuJoCo, Drake) or before it (Bullet).

        :raises SimulationRefusedError: when MuJoCo cannot continue, for lack of memory.
        """
        mujoco, model, data = self._mujoco, self._model, self._data
        off, kinds = mujoco.mjtDisableBit, mujoco.mjtIntegrator
        model.opt.timestep = step
        model.opt.integrator = int(kinds.mjINT_IMPLICITFAST if implicit_damping else kinds.mjINT_EULER)
        # Otherwise MuJoCo resets the state when a simulation diverges.
        model.opt.disableflags = int(off.mjDSBL_AUTORESET | off.mjDSBL_EULERDAMP)
        if not hold_joints:
            model.opt.disableflags |= int(off.mjDSBL_ACTUATION)
        self._reset_state()
        begin = self._get_root_pose()
        chunk = max(1, round(SAMPLING_INTERVAL / step))
        count = max(1, round(seconds / (chunk * step)))
        time, energy, speed = np.zeros(count + 1), np.zeros(count + 1), np.zeros(count + 1)
        energy[0] = data.energy.sum()
        loads = np.zeros(len(self.mechanism.geoms))
        burst, fastest, moving, window = None, 0, 0, min(count, max(1, round(AVERAGING_WINDOW / (chunk * step))))
        for i in range(1, count + 1):
            self._step_model(chunk)
            speeds = np.full(1, np.nan)
            if np.isfinite(data.qpos).all() and np.isfinite(data.qvel).all():
                mujoco.mj_forward(model, data)
                speeds = self._compute_body_speeds()
            time[i], energy[i], speed[i] = data.time, data.energy.sum(), speeds.max()
            if self._has_diverged() or not math.isfinite(energy[i] + speed[i]):
                burst = float(data.time)
                time, energy, speed = time[: i + 1], energy[: i + 1], speed[: i + 1]
                break
            if speed[i] >= speed[:i].max():
                fastest = int(speeds.argmax())
            if i > count - window:
                loads += self._compute_contact_loads() / window
                if speed[i] >= speed[count - window + 1 : i + 1].max():
                    moving = int(speeds.argmax())
        root = self._get_root_pose()
        return MotionTrace(
            time=time,
            energy=energy,
            speed=speed,
            burst_time=burst,
            fastest_body=fastest,
            last_fastest_body=moving,
            root_pose=root,
            tilt=math.acos(max(-1.0, min(1.0, float(begin[:3, 2] @ root[:3, 2])))) if burst is None else math.nan,
            touching=[] if burst is not None else self._collect_plane_contacts(loads, root),
            saturated=[] if burst is not None or not hold_joints else self._list_saturated_bodies(),
            joint_offsets=self._measure_joint_offsets(),
        )

    def _step_model(self, count: int) -> None:
        try:
            self._mujoco.mj_step(self._model, self._data, count)
        except self._mujoco.FatalError as error:
            raise SimulationRefusedError(str(error).partition("\n")[0], "") from None

    # -- before -------------------------------------------------------------------------------------------------------

    def _adjust_spec(self, spec: Any) -> None:
        """Change what is compiled; a subclass may."""

    def _reset_state(self) -> None:
        mujoco, model, data = self._mujoco, self._model, self._data
        mujoco.mj_resetData(model, data)
        for place, body in enumerate(self.mechanism.bodies):
            if body.joint.kind in {"hinge", "slide"}:
                data.qpos[self._find_joint_address(place)] = body.joint.start_value
        for motor in range(model.nu):
            data.ctrl[motor] = data.qpos[model.jnt_qposadr[model.actuator_trnid[motor, 0]]]
        mujoco.mj_forward(model, data)

    def _set_motor_gains(self) -> None:
        """Set the gains of the motors: critically damped springs, and the torque of gravity at the beginning."""
        model, data = self._model, self._data
        if not model.nu:
            return
        inertia = np.zeros((model.nv, model.nv))
        self._mujoco.mj_fullM(model, data, inertia)
        effective = 1.0 / np.maximum(np.diag(np.linalg.inv(inertia)), 1e-300)
        for motor in range(model.nu):
            joint = model.actuator_trnid[motor, 0]
            place = model.jnt_dofadr[joint]
            stiffness = float(effective[place]) * STIFFNESS**2
            model.actuator_gainprm[motor, 0] = stiffness
            gravity = float(data.qfrc_bias[place])
            model.actuator_biasprm[motor, :3] = gravity, -stiffness, -2.0 * stiffness / STIFFNESS

    # -- after --------------------------------------------------------------------------------------------------------

    def _find_joint_address(self, place: int) -> int:
        return int(self._model.joint(f"j{place}").qposadr[0])

    def _get_root_pose(self) -> Array:
        frame = np.eye(4)
        if not self.mechanism.grounded:
            root = self._data.body("b0")
            frame[:3, :3], frame[:3, 3] = np.array(root.xmat).reshape(3, 3), root.xpos
        return frame

    def _has_diverged(self) -> bool:
        warning = self._mujoco.mjtWarning
        kinds = (warning.mjWARN_BADQPOS, warning.mjWARN_BADQVEL, warning.mjWARN_BADQACC)
        return any(self._data.warning[int(kind)].number for kind in kinds)

    def _compute_body_speeds(self) -> Array:
        """Compute the root mean square speed (m/s) of the mass of each body."""
        model, data = self._model, self._data
        own = self._body_ids
        turn, move = data.cvel[own, :3], data.cvel[own, 3:]
        lever = data.xipos[own] - data.subtree_com[model.body_rootid[own]]
        (wx, wy, wz), (x, y, z) = turn.T, lever.T
        # The cross product written out: for a few bodies, np.cross takes half of the time of a step.
        move = move + np.stack((wy * z - wz * y, wz * x - wx * z, wx * y - wy * x), axis=1)
        along = np.einsum("bij,bi->bj", data.ximat[own].reshape(-1, 3, 3), turn)
        square = (move**2).sum(axis=1) + (model.body_inertia[own] * along**2).sum(axis=1) / model.body_mass[own]
        speeds: Array = np.sqrt(square)
        return speeds

    def _compute_contact_loads(self) -> Array:
        """Compute the normal force (N) on each geom."""
        loads = np.zeros(len(self.mechanism.geoms))
        force = np.zeros(6)
        for i in range(self._data.ncon):
            self._mujoco.mj_contactForce(self._model, self._data, i, force)
            loads[self._find_contact_geom(i)] += force[0]
        return loads

    def _collect_plane_contacts(self, loads: Array, root: Array) -> list[PlaneContact]:
        rows_of: dict[int, list[int]] = {}
        for i in range(self._data.ncon):
            rows_of.setdefault(self._find_contact_geom(i), []).append(i)
        contacts = []
        for geom, rows in sorted(rows_of.items()):
            places, depths = self._data.contact.pos[rows].copy(), self._data.contact.dist[rows]
            places[:, 2] += depths / 2  # from the middle between the surfaces to the geom's own
            local = (places - root[:3, 3]) @ root[:3, :3]
            contact = PlaneContact(
                geom=geom,
                points=len(rows),
                place=local.mean(axis=0),
                lowest=float(local[:, 2].min()),
                depth=max(0.0, -float(depths.min())),
                load=float(loads[geom]),
            )
            contacts.append(contact)
        return contacts

    def _find_contact_geom(self, contact: int) -> int:
        return self._geoms[int(self._data.contact.geom[contact].max())]

    @cached_property
    def _geoms(self) -> dict[int, int]:
        return {self._model.geom(f"g{i}").id: i for i in range(len(self.mechanism.geoms))}

    @cached_property
    def _body_ids(self) -> NDArray[np.intp]:
        return np.array([self._model.body(f"b{i}").id for i in range(len(self.mechanism.bodies))], dtype=np.intp)

    def _list_saturated_bodies(self) -> list[int]:
        model, data = self._model, self._data
        limits = model.actuator_forcerange[:, 1]
        full = model.actuator_forcelimited.astype(bool) & (np.abs(data.actuator_force) >= limits * (1 - 1e-9))
        return [int(model.actuator(int(i)).name[1:]) for i in np.flatnonzero(full)]

    def _measure_joint_offsets(self) -> Array:
        offsets = np.zeros(len(self.mechanism.bodies))
        for place, body in enumerate(self.mechanism.bodies):
            if body.joint.kind in {"hinge", "slide"}:
                offsets[place] = self._data.qpos[self._find_joint_address(place)] - body.joint.start_value
        return offsets


def _import_mujoco() -> Any:
    # Otherwise MuJoCo starts a program that searches for a display.
    os.environ["MUJOCO_GL"] = "disable"
    import mujoco

    mujoco.set_mju_user_warning(lambda _: None)  # otherwise it writes a file into the working directory
    return mujoco


def _build_spec(mujoco: Any, mechanism: Mechanism, ground: float) -> Any:
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.compiler.usethread = False
    spec.compiler.inertiafromgeom = mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE
    spec.option.gravity = [0.0, 0.0, -GRAVITY]
    spec.option.enableflags = int(mujoco.mjtEnableBit.mjENBL_ENERGY)
    plane = spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[1, 1, 1], pos=[0, 0, ground])
    plane.contype, plane.conaffinity = 1, 0
    bodies = [spec.worldbody]
    for place, body in enumerate(mechanism.bodies):
        position, quaternion = _split_pose(mujoco, body.pose)
        added = bodies[body.parent + 1].add_body(name=f"b{place}", pos=position, quat=quaternion)
        added.mass, added.ipos, added.explicitinertial = body.mass, body.com, True
        i = body.inertia
        added.fullinertia = [i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]]
        is_follower = any(follower.body == place for follower in mechanism.followers)
        _add_joints(mujoco, added, place=place, body=body, is_follower=is_follower)
        bodies.append(added)
        _add_motor(mujoco, spec, place=place, joint=body.joint)
    for place, geom in enumerate(mechanism.geoms):
        _add_geom(mujoco, spec, bodies[geom.body + 1], place=place, geom=geom)
    for follower in mechanism.followers:
        equal = spec.add_equality(type=mujoco.mjtEq.mjEQ_JOINT, objtype=mujoco.mjtObj.mjOBJ_JOINT)
        equal.name1, equal.name2 = f"j{follower.body}", f"j{follower.leader}"
        equal.data[:5] = follower.offset, follower.multiplier, 0.0, 0.0, 0.0
    return spec


def _add_joints(mujoco: Any, mj_body: Any, *, place: int, body: RigidBody, is_follower: bool) -> None:
    kinds, joint = mujoco.mjtJoint, body.joint
    if joint.kind == "floating" and body.parent < 0:
        mj_body.add_freejoint(name=f"j{place}")
    elif joint.kind == "floating":
        for axis in np.eye(3):
            mj_body.add_joint(type=kinds.mjJNT_SLIDE, axis=axis)
        mj_body.add_joint(name=f"j{place}", type=kinds.mjJNT_BALL)
    elif joint.kind == "planar":  # along both directions across its axis, and about it
        first = np.cross(joint.axis, np.eye(3)[int(np.abs(joint.axis).argmin())])
        for axis in (first, np.cross(joint.axis, first)):
            mj_body.add_joint(type=kinds.mjJNT_SLIDE, axis=axis)
        mj_body.add_joint(name=f"j{place}", type=kinds.mjJNT_HINGE, axis=joint.axis)
    else:
        kind = kinds.mjJNT_HINGE if joint.kind == "hinge" else kinds.mjJNT_SLIDE
        mj_joint = mj_body.add_joint(name=f"j{place}", type=kind, axis=joint.axis, frictionloss=joint.friction)
        mj_joint.damping = [joint.damping, 0.0, 0.0]
        mj_joint.limited = int(joint.range is not None and not is_follower)
        mj_joint.range = joint.range or (0.0, 0.0)


def _add_motor(mujoco: Any, spec: Any, *, place: int, joint: SimulatedJoint) -> None:
    if joint.effort is None:
        return
    motor = spec.add_actuator(name=f"m{place}", target=f"j{place}", trntype=mujoco.mjtTrn.mjTRN_JOINT)
    motor.biastype = mujoco.mjtBias.mjBIAS_AFFINE
    motor.forcelimited = int(math.isfinite(joint.effort))
    if math.isfinite(joint.effort):
        motor.forcerange = [-joint.effort, joint.effort]


def _add_geom(mujoco: Any, spec: Any, mj_body: Any, *, place: int, geom: Geom) -> None:
    kinds = mujoco.mjtGeom
    position, quaternion = _split_pose(mujoco, geom.pose)
    mj_geom = mj_body.add_geom(name=f"g{place}", pos=position, quat=quaternion, mass=0.0, contype=0, conaffinity=1)
    if geom.points is not None:
        points, mesh = geom.points, spec.add_mesh(name=f"s{place}", inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX)
        mesh.uservert = points.ravel()
        mj_geom.type, mj_geom.meshname = kinds.mjGEOM_MESH, f"s{place}"
    elif geom.kind == "box":
        mj_geom.type, mj_geom.size = kinds.mjGEOM_BOX, [edge / 2 for edge in geom.size]
    elif geom.kind == "sphere":
        mj_geom.type, mj_geom.size = kinds.mjGEOM_SPHERE, [geom.size[0], 0.0, 0.0]
    else:
        mj_geom.type = kinds.mjGEOM_CYLINDER if geom.kind == "cylinder" else kinds.mjGEOM_CAPSULE
        mj_geom.size = [geom.size[0], geom.size[1] / 2, 0.0]


def _split_pose(mujoco: Any, pose: Array) -> tuple[Array, Array]:
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(pose[:3, :3]).ravel())
    return pose[:3, 3], quaternion
