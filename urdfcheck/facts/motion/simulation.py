"""A mechanism that is let go on a plane, by MuJoCo: what moves, what touches, and what becomes of its energy.

MuJoCo steps rigid bodies in joint coordinates; contacts and limits are soft constraints (Todorov, *Convex and
analytically-invertible dynamics with contacts and constraints in MuJoCo*, 2014). Bodies touch the plane only, not each other.
z points up, gravity is 9.81 m/s².
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from urdfcheck.facts.arrays import Array


GRAVITY = 9.81
# s between two looks at a moving mechanism: a fall of half a millimetre.
SAMPLING_INTERVAL = 0.01
# s at the end over which speeds and loads are taken.
AVERAGING_WINDOW = 0.25
# rad/s: the frequency of a held joint. At a step of 1 ms it takes 31 steps to swing once, far below the 2/step at which an
# explicit spring becomes unstable, and a leg that carries thirty times its own inertia still stands straight.
STIFFNESS = 200.0
# MuJoCo's default for contacts and limits: time constant (s), damping ratio, and impedance where they just touch.
SOFTNESS, DAMPING_RATIO, IMPEDANCE = 0.02, 1.0, 0.9


class SimulationRefusedError(Exception):
    """MuJoCo does not take the mechanism; its reason, and the ``element`` that it names (b3: the body in place 3)."""

    def __init__(self, reason: str, element: str) -> None:
        super().__init__(reason)
        self.element = element


@dataclass(frozen=True, slots=True, eq=False)
class Geom:
    """A shape of body ``body`` (-1: of the ground that everything is fixed to) at ``pose`` (4, 4) in its frame. ``kind``: box |
    cylinder | sphere | capsule | hull; ``size`` in m as URDF gives it; ``points`` (K, 3) of a hull."""

    body: int
    kind: str
    size: tuple[float, ...]
    pose: Array
    points: Array | None = None


@dataclass(frozen=True, slots=True, eq=False)
class SimulatedJoint:
    """How a body moves against its parent. ``kind``: hinge | slide | floating | planar; ``axis`` (3,) a unit vector;
    ``range`` (rad or m), None without limits; viscous ``damping`` and Coulomb ``friction`` in N·m(·s/rad) or N(·s/m);
    ``value`` (rad or m): where it is let go; ``effort`` (N·m or N): with which it can be held, infinite without limit, None when
    it is not driven at all."""

    kind: str
    axis: Array
    range: tuple[float, float] | None = None
    damping: float = 0.0
    friction: float = 0.0
    start_value: float = 0.0
    effort: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class RigidBody:
    """A rigid body that hangs on body ``parent`` (-1: the ground) by ``hinge``, at ``pose`` (4, 4) in the parent's frame where
    the joint is at 0. ``mass`` in kg, ``com`` (3,) in m and ``inertia`` (3, 3) in kg m² about it, in its own frame."""

    parent: int
    pose: Array
    joint: SimulatedJoint
    mass: float
    com: Array
    inertia: Array


@dataclass(frozen=True, slots=True, eq=False)
class Follower:
    """The joint of body ``body`` is at ``multiplier`` times that of body ``leader`` plus ``offset``."""

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


@dataclass(frozen=True, slots=True, eq=False)
class MotionTrace:
    """What came of two seconds, or of the time until something burst.

    ``time`` (s), ``energy`` (J, kinetic and potential), ``speed`` (m/s) (N,): that of the fastest body, the root mean square
    over its mass. ``burst``: when (s) the simulator gave up, None if it did not. ``fastest``: the fastest body of all,
    ``moving``: that of the last quarter of a second.

    ``root`` (4, 4): the root's frame at the end; ``tilt`` (rad): of its z axis against that at the beginning; NaN if it burst.
    ``touching``: what touches the plane at the end. ``saturated``: bodies whose joints are held with all their effort then;
    ``off``: how far (rad or m) each body's joint is from where it was let go (0 where it has not one degree of freedom).
    """

    time: Array
    energy: Array
    speed: Array
    burst_time: float | None
    fastest_body: int
    last_fastest_body: int
    root_pose: Array
    tilt: float
    touching: Sequence[PlaneContact]
    saturated: Sequence[int]
    joint_offsets: Array


@dataclass(frozen=True, slots=True, eq=False)
class PlaneContact:
    """A geom on the plane. ``points``: of how many contacts; ``place`` (3,): their middle on the geom's surface, in the root's
    frame, and ``lowest`` the least z of them there; ``depth`` (m): the deepest below the plane; ``load`` (N): the normal force
    on all, averaged over the last quarter of a second."""

    geom: int
    points: int
    place: Array
    lowest: float
    depth: float
    load: float


def compute_rest_depth(gravity: float = GRAVITY) -> float:
    """How deep (m) MuJoCo lets a body at rest into the plane, with the default softness.

    A constraint's acceleration is ``(1 - d) a0 + d (-b v - k r)`` (MuJoCo's documentation, *Computation*), zero at rest, where
    a0 = -g is what would be without it and ``k = 1 / (d_max² t² ζ²)``: ``r = (1 - d)/d · g · (d_max t ζ)²``, 0.39 mm whatever
    the mass.
    """
    return (1 - IMPEDANCE) / IMPEDANCE * gravity * (0.95 * SOFTNESS * DAMPING_RATIO) ** 2


def compute_lowest_height(geom: Geom, pose: Array) -> float:
    """The least z (m) of a geom whose body is at ``pose`` (4, 4)."""
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
    """A mechanism in MuJoCo, with a plane below it at the height ``ground`` (m) in the root's frame as it is let go.

    :raises ImportError: when MuJoCo is not installed.
    :raises Refused: when MuJoCo does not take it.
    """

    def __init__(self, mechanism: Mechanism, ground: float) -> None:
        self.mechanism = mechanism
        self._mujoco = _import_mujoco()
        try:
            self._model = _build_spec(self._mujoco, mechanism, ground).compile()
        except (ValueError, RuntimeError, self._mujoco.FatalError) as error:
            reason, _, element = str(error).partition("\n")
            raise SimulationRefusedError(reason.removeprefix("Error: "), element) from None
        self._data = self._mujoco.MjData(self._model)
        self._reset_state()
        self._set_motor_gains()

    @cached_property
    def weight(self) -> float:
        """N."""
        return GRAVITY * sum(body.mass for body in self.mechanism.bodies)

    @property
    def version(self) -> str:
        """MuJoCo's."""
        version: str = self._mujoco.__version__
        return version

    def run(self, seconds: float, step: float, *, hold_joints: bool, implicit_damping: bool = True) -> MotionTrace:
        """Let go; ``held``: with torques that hold the joints where they are, else with none. ``implicit``: whether damping is
        computed from the velocity after a step (MuJoCo, Drake) or before it (Bullet).

        :raises Refused: when MuJoCo cannot go on, for want of memory.
        """
        mujoco, model, data = self._mujoco, self._model, self._data
        off, kinds = mujoco.mjtDisableBit, mujoco.mjtIntegrator
        model.opt.timestep = step
        model.opt.integrator = int(kinds.mjINT_IMPLICITFAST if implicit_damping else kinds.mjINT_EULER)
        # It would put back to the beginning what bursts.
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
            time,
            energy,
            speed,
            burst,
            fastest,
            moving,
            root,
            math.acos(max(-1.0, min(1.0, float(begin[:3, 2] @ root[:3, 2])))) if burst is None else math.nan,
            [] if burst is not None else self._collect_plane_contacts(loads, root),
            [] if burst is not None or not hold_joints else self._list_saturated_bodies(),
            self._measure_joint_offsets(),
        )

    def _step_model(self, count: int) -> None:
        try:
            self._mujoco.mj_step(self._model, self._data, count)
        except self._mujoco.FatalError as error:
            raise SimulationRefusedError(str(error).partition("\n")[0], "") from None

    # -- before -------------------------------------------------------------------------------------------------------

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
        """Set the gains of the motors: critically damped springs, and the torque of gravity where they begin."""
        model, data = self._model, self._data
        if not model.nu:
            return
        inertia = np.zeros((model.nv, model.nv))
        self._mujoco.mj_fullM(model, data, inertia)
        felt = 1.0 / np.maximum(np.diag(np.linalg.inv(inertia)), 1e-300)
        for motor in range(model.nu):
            joint = model.actuator_trnid[motor, 0]
            place = model.jnt_dofadr[joint]
            stiffness = float(felt[place]) * STIFFNESS**2
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
        """The root mean square speed (m/s) of the mass of each body."""
        model, data = self._model, self._data
        own = self._body_ids
        turn, move = data.cvel[own, :3], data.cvel[own, 3:]
        lever = data.xipos[own] - data.subtree_com[model.body_rootid[own]]
        move = move + np.cross(turn, lever)
        along = np.einsum("bij,bi->bj", data.ximat[own].reshape(-1, 3, 3), turn)
        square = (move**2).sum(axis=1) + (model.body_inertia[own] * along**2).sum(axis=1) / model.body_mass[own]
        speeds: Array = np.sqrt(square)
        return speeds

    def _compute_contact_loads(self) -> Array:
        """The normal force (N) on each geom."""
        found = np.zeros(len(self.mechanism.geoms))
        force = np.zeros(6)
        for i in range(self._data.ncon):
            self._mujoco.mj_contactForce(self._model, self._data, i, force)
            found[self._find_contact_geom(i)] += force[0]
        return found

    def _collect_plane_contacts(self, loads: Array, root: Array) -> list[PlaneContact]:
        contacts: dict[int, list[int]] = {}
        for i in range(self._data.ncon):
            contacts.setdefault(self._find_contact_geom(i), []).append(i)
        found = []
        for geom, rows in sorted(contacts.items()):
            places, depths = self._data.contact.pos[rows].copy(), self._data.contact.dist[rows]
            places[:, 2] += depths / 2  # from the middle between the surfaces to the geom's own
            local = (places - root[:3, 3]) @ root[:3, :3]
            depth = max(0.0, -float(depths.min()))
            found.append(
                PlaneContact(geom, len(rows), local.mean(axis=0), float(local[:, 2].min()), depth, float(loads[geom]))
            )
        return found

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
        found = np.zeros(len(self.mechanism.bodies))
        for place, body in enumerate(self.mechanism.bodies):
            if body.joint.kind in {"hinge", "slide"}:
                found[place] = self._data.qpos[self._find_joint_address(place)] - body.joint.start_value
        return found


def _import_mujoco() -> Any:
    # It would look for a screen, with a program of its own, to draw on.
    os.environ["MUJOCO_GL"] = "disable"
    import mujoco

    mujoco.set_mju_user_warning(lambda _: None)  # else it writes a file into the working directory
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
    made = [spec.worldbody]
    for place, body in enumerate(mechanism.bodies):
        position, quaternion = _split_pose(mujoco, body.pose)
        one = made[body.parent + 1].add_body(name=f"b{place}", pos=position, quat=quaternion)
        one.mass, one.ipos, one.explicitinertial = body.mass, body.com, True
        i = body.inertia
        one.fullinertia = [i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]]
        _add_joints(mujoco, one, place, body, {follower.body for follower in mechanism.followers})
        made.append(one)
        _add_motor(mujoco, spec, place, body.joint)
    for place, geom in enumerate(mechanism.geoms):
        _add_geom(mujoco, spec, made[geom.body + 1], place, geom)
    for follower in mechanism.followers:
        equal = spec.add_equality(type=mujoco.mjtEq.mjEQ_JOINT, objtype=mujoco.mjtObj.mjOBJ_JOINT)
        equal.name1, equal.name2 = f"j{follower.body}", f"j{follower.leader}"
        equal.data[:5] = follower.offset, follower.multiplier, 0.0, 0.0, 0.0
    return spec


def _add_joints(mujoco: Any, body: Any, place: int, own: RigidBody, followers: set[int]) -> None:
    kinds, hinge = mujoco.mjtJoint, own.joint
    if hinge.kind == "floating" and own.parent < 0:
        body.add_freejoint(name=f"j{place}")
    elif hinge.kind == "floating":
        for axis in np.eye(3):
            body.add_joint(type=kinds.mjJNT_SLIDE, axis=axis)
        body.add_joint(name=f"j{place}", type=kinds.mjJNT_BALL)
    elif hinge.kind == "planar":  # along both directions across its axis, and about it
        first = np.cross(hinge.axis, np.eye(3)[int(np.abs(hinge.axis).argmin())])
        for axis in (first, np.cross(hinge.axis, first)):
            body.add_joint(type=kinds.mjJNT_SLIDE, axis=axis)
        body.add_joint(name=f"j{place}", type=kinds.mjJNT_HINGE, axis=hinge.axis)
    else:
        kind = kinds.mjJNT_HINGE if hinge.kind == "hinge" else kinds.mjJNT_SLIDE
        joint = body.add_joint(name=f"j{place}", type=kind, axis=hinge.axis, frictionloss=hinge.friction)
        joint.damping = [hinge.damping, 0.0, 0.0]
        joint.limited = int(hinge.range is not None and place not in followers)
        joint.range = hinge.range or (0.0, 0.0)


def _add_motor(mujoco: Any, spec: Any, place: int, hinge: SimulatedJoint) -> None:
    if hinge.effort is None:
        return
    motor = spec.add_actuator(name=f"m{place}", target=f"j{place}", trntype=mujoco.mjtTrn.mjTRN_JOINT)
    motor.biastype = mujoco.mjtBias.mjBIAS_AFFINE
    motor.forcelimited = int(math.isfinite(hinge.effort))
    if math.isfinite(hinge.effort):
        motor.forcerange = [-hinge.effort, hinge.effort]


def _add_geom(mujoco: Any, spec: Any, body: Any, place: int, geom: Geom) -> None:
    kinds = mujoco.mjtGeom
    position, quaternion = _split_pose(mujoco, geom.pose)
    made = body.add_geom(name=f"g{place}", pos=position, quat=quaternion, mass=0.0, contype=0, conaffinity=1)
    if geom.points is not None:
        points, mesh = geom.points, spec.add_mesh(name=f"s{place}", inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX)
        mesh.uservert = points.ravel()
        made.type, made.meshname = kinds.mjGEOM_MESH, f"s{place}"
    elif geom.kind == "box":
        made.type, made.size = kinds.mjGEOM_BOX, [edge / 2 for edge in geom.size]
    elif geom.kind == "sphere":
        made.type, made.size = kinds.mjGEOM_SPHERE, [geom.size[0], 0.0, 0.0]
    else:
        made.type = kinds.mjGEOM_CYLINDER if geom.kind == "cylinder" else kinds.mjGEOM_CAPSULE
        made.size = [geom.size[0], geom.size[1] / 2, 0.0]


def _split_pose(mujoco: Any, pose: Array) -> tuple[Array, Array]:
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(pose[:3, :3]).ravel())
    return pose[:3, 3], quaternion
