"""Bullet, through PyBullet."""

from __future__ import annotations

import math
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as distribution
from typing import Any

from urdfcheck.simulators.outcome import EngineDynamics, EngineInput, LoadedRobot, Vector

INSTALL = "pip install 'urdfcheck[engines]'"
LIBRARIES = ("pybullet",)
# Seconds of the one step that measures an acceleration.
_STEP = 1e-4


def get_version() -> str | None:
    """Return the installed version."""
    try:
        return distribution("pybullet")
    except PackageNotFoundError:
        return None


def load(robot: EngineInput, path: str) -> LoadedRobot:
    """Load with a fixed base and the inertias of the file; without that flag Bullet computes them from the collision shapes."""
    import pybullet

    pybullet.connect(pybullet.DIRECT)
    try:
        pybullet.setGravity(0, 0, -9.81)
        body = pybullet.loadURDF(path, useFixedBase=True, flags=pybullet.URDF_USE_INERTIA_FROM_FILE)
        infos = [pybullet.getJointInfo(body, i) for i in range(pybullet.getNumJoints(body))]
        # Bullet truncates long names.
        names = [pybullet.getBodyInfo(body)[0], *(info[12] for info in infos)]
        known = {_decode_name(info[1]): info for info in infos}
        return LoadedRobot(
            links={_decode_name(name): pybullet.getDynamicsInfo(body, i - 1)[0] for i, name in enumerate(names)},
            joints=tuple(known),
            limits={name: _read_limits(known[name]) for name in robot.joints if name in known},
            shapes=sum(len(pybullet.getCollisionShapeData(body, i - 1)) for i in range(len(names))),
            motion=_compute_dynamics_or_nan(pybullet, body, infos=infos, known=known, robot=robot),
        )
    finally:
        pybullet.disconnect()


def _decode_name(name: bytes) -> str:
    return name.decode("utf-8", "replace")


def _read_limits(info: Any) -> tuple[float, float] | None:
    """Read the limits of a joint; Bullet marks a joint without limits by an inverted range."""
    lower, upper = info[8], info[9]
    return None if (lower, upper) in {(0.0, -1.0), (1.0, -1.0)} else (lower, upper)


def _compute_dynamics_or_nan(
    pybullet: Any, body: int, *, infos: list[Any], known: dict[str, Any], robot: EngineInput
) -> EngineDynamics | None:
    """Compute the dynamics; NaN for a model that Bullet loads but cannot compute."""
    try:
        return _compute_dynamics(pybullet, body, infos=infos, known=known, robot=robot)
    except (SystemError, pybullet.error):
        return EngineDynamics(joints=robot.joints, accelerations=(math.nan,) * len(robot.joints))


def _compute_dynamics(
    pybullet: Any, body: int, *, infos: list[Any], known: dict[str, Any], robot: EngineInput
) -> EngineDynamics | None:
    moving = [info for info in infos if info[2] != pybullet.JOINT_FIXED]
    if {_decode_name(info[1]) for info in moving} != set(robot.joints) or len(moving) != len(robot.joints):
        return None
    if not robot.joints:
        return EngineDynamics()
    # Bullet's vectors are in the order of its state.
    order = sorted(robot.joints, key=lambda name: known[name][3])
    rows = [order.index(name) for name in robot.joints]
    masses, torques = [], []
    for values in robot.samples:
        q = [dict(zip(robot.joints, values, strict=True))[name] for name in order]
        matrix = pybullet.calculateMassMatrix(body, q)
        masses.append(tuple(tuple(matrix[i][j] for j in rows) for i in rows))
        zero = [0.0] * len(q)
        holding = pybullet.calculateInverseDynamics(body, q, zero, zero)
        torques.append(tuple(holding[i] for i in rows))
    return EngineDynamics(
        joints=robot.joints,
        masses=tuple(masses),
        torques=tuple(torques),
        accelerations=_measure_accelerations(pybullet, body, known=known, robot=robot),
    )


def _measure_accelerations(pybullet: Any, body: int, *, known: dict[str, Any], robot: EngineInput) -> Vector:
    """Measure the accelerations by one short step without motors, damping and friction."""
    for index in range(-1, len(known)):
        pybullet.changeDynamics(body, index, linearDamping=0, angularDamping=0, jointDamping=0, lateralFriction=0)
    for name, value in zip(robot.joints, robot.start, strict=True):
        index = known[name][0]
        pybullet.resetJointState(body, index, value)
        pybullet.setJointMotorControl2(body, index, pybullet.VELOCITY_CONTROL, force=0)
    pybullet.setTimeStep(_STEP)
    pybullet.stepSimulation()
    return tuple(pybullet.getJointState(body, known[name][0])[1] / _STEP for name in robot.joints)
