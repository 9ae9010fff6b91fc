"""A robot that drives on a plane in MuJoCo: its wheels rotate by given angles, and everything else slides.

A ball or a caster modelled as fixed slides on its friction, which URDF does not have; with MuJoCo's default of 1 it would decide
where the robot goes. So nothing but the driven wheels has friction.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.motion.simulation import SAMPLING_INTERVAL, Mechanism, Simulation

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# rad/s: the frequency of a driven wheel that carries its share of the robot. As stiff as held joints, it shakes the body.
_STIFFNESS = 50.0
# Rotational inertia that a wheel gets at least, as a share of that of the robot's mass at its radius: a motor that is as stiff as
# the robot needs shakes a light wheel.
_INERTIA_SHARE = 0.1
# Tangential against normal stiffness of a contact: with MuJoCo's 1 a wheel creeps by some per cent.
_STIFFER = 20.0


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class DriveTrace:
    """The outcome of a drive; (N, …) are samples, the first when the wheels begin to rotate."""

    poses: Array
    """(N, 4, 4), of the root."""
    centres: Array
    """(N, W, 3), of the origins of the wheels' bodies."""
    angles: Array
    """(N, W), of the wheels' joints (rad)."""
    loads: Array
    """(W,), mean normal force (N) on each wheel."""


class DrivingSimulation(Simulation):
    """A mechanism in MuJoCo whose ``wheels`` are driven; they are hinges, given with their friction against the plane.

    ``radius``: of the largest wheel, in m.

    :raises ImportError: when MuJoCo is not installed.
    :raises SimulationRefusedError: when MuJoCo rejects it.
    """

    def __init__(self, mechanism: Mechanism, ground: float, wheels: Mapping[int, float], radius: float) -> None:
        self._wheels = dict(wheels)
        self._radius = radius
        mass = sum(body.mass for body in mechanism.bodies)
        self._share = mass * radius**2 / len(self._wheels)
        super().__init__(_equip_with_motors(mechanism, self._wheels), ground)

    def drive(self, angles: Sequence[float], *, rest: float, step: float, acceleration: float) -> DriveTrace | None:
        """Let the robot settle, rotate each wheel by its angle, and let it settle again; None where the simulation diverges.

        :param angles: rad, one for each wheel.
        :param rest: s, before and after.
        :param step: s.
        :param acceleration: m/s², of a wheel that does not slip.
        :raises SimulationRefusedError: when MuJoCo cannot continue, for lack of memory.
        """
        mujoco, model, data = self._mujoco, self._model, self._data
        off = mujoco.mjtDisableBit
        model.opt.timestep = step
        model.opt.integrator = int(mujoco.mjtIntegrator.mjINT_IMPLICITFAST)
        model.opt.disableflags = int(off.mjDSBL_AUTORESET | off.mjDSBL_EULERDAMP)
        self._reset_state()
        self._stiffen_wheels()
        motors = [int(model.actuator(f"m{wheel}").id) for wheel in self._wheels]
        begin = np.array(data.ctrl[motors])
        chunk = max(1, round(SAMPLING_INTERVAL / step))
        interval = chunk * step
        # The angle a/2 (1 - cos(πt/T)) has the greatest acceleration aπ²/(2T²).
        longest = math.pi * math.sqrt(max(map(abs, angles)) * self._radius / (2 * acceleration))
        moving, waiting = max(1, math.ceil(longest / interval)), max(1, round(rest / interval))
        poses, centres, turned = [], [], []
        loads = np.zeros(len(self.mechanism.geoms))
        for i in range(-waiting, moving + waiting + 1):
            if i >= 0:
                poses.append(self._get_root_pose())
                centres.append(np.array([data.body(f"b{wheel}").xpos for wheel in self._wheels]))
                turned.append([data.qpos[self._find_joint_address(wheel)] for wheel in self._wheels])
                loads += self._compute_contact_loads()
            part = min(max(i + 1, 0), moving) / moving
            data.ctrl[motors] = begin + np.array(angles) * (1 - math.cos(math.pi * part)) / 2
            self._step_model(chunk)
            if self._has_diverged() or not (np.isfinite(data.qpos).all() and np.isfinite(data.qvel).all()):
                return None
        on_wheel = [
            [place for place, geom in enumerate(self.mechanism.geoms) if geom.body == wheel] for wheel in self._wheels
        ]
        return DriveTrace(
            poses=np.array(poses),
            centres=np.array(centres),
            angles=np.array(turned),
            loads=np.array([loads[places].sum() for places in on_wheel]) / len(poses),
        )

    def _adjust_spec(self, spec: Any) -> None:
        spec.option.cone = self._mujoco.mjtCone.mjCONE_ELLIPTIC
        spec.option.impratio = _STIFFER
        for wheel in self._wheels:
            spec.joint(f"j{wheel}").armature = _INERTIA_SHARE * self._share
        for place, geom in enumerate(self.mechanism.geoms):
            shape = spec.geom(f"g{place}")
            shape.priority = 1  # otherwise the greater friction, that of the plane, counts
            friction = self._wheels.get(geom.body)
            if friction:
                shape.friction = [friction, 0.0, 0.0]
            else:
                shape.condim = 1

    def _stiffen_wheels(self) -> None:
        """Make the motors of the wheels hold the robot, not the wheel alone."""
        stiffness = self._share * _STIFFNESS**2
        for wheel in self._wheels:
            motor = int(self._model.actuator(f"m{wheel}").id)
            self._model.actuator_gainprm[motor, 0] = stiffness
            self._model.actuator_biasprm[motor, :3] = 0.0, -stiffness, -2.0 * stiffness / _STIFFNESS


def _equip_with_motors(mechanism: Mechanism, wheels: Mapping[int, float]) -> Mechanism:
    """Give the wheels motors without a limit and without losses; other joints that turn without limits are free."""
    bodies = []
    for place, body in enumerate(mechanism.bodies):
        joint = body.joint
        if place in wheels:
            joint = replace(joint, effort=math.inf, damping=0.0, friction=0.0)
        elif joint.kind == "hinge" and joint.range is None:
            joint = replace(joint, effort=None)
        bodies.append(replace(body, joint=joint))
    return replace(mechanism, bodies=tuple(bodies))
