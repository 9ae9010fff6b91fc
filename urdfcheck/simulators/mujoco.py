"""MuJoCo."""

from __future__ import annotations

import math
from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as distribution
from typing import Any

from urdfcheck.simulators.outcome import EngineDynamics, EngineInput, LoadedRobot, Vector

INSTALL = "pip install 'urdfcheck[engines]'"
LIBRARIES = ("mujoco",)


def get_version() -> str | None:
    """Return the installed version."""
    try:
        return distribution("mujoco")
    except PackageNotFoundError:
        return None


def load(robot: EngineInput, path: str) -> LoadedRobot:
    """With MuJoCo's own defaults for URDF: visuals are left out, fixed links merged, the root is part of the world."""
    import mujoco

    try:
        model = mujoco.MjModel.from_xml_path(path)
    except ValueError as error:
        reason, _, element = str(error).partition("\n")
        # The second line names the element that is wrong.
        named = f" ({element.strip()})" if element.startswith("Element") else ""
        raise ValueError(f"{reason.removeprefix('Error: ')}{named}") from None
    bodies = [model.body(i) for i in range(model.nbody)]
    known = {model.joint(i).name: model.joint(i) for i in range(model.njnt)}
    return LoadedRobot(
        links={body.name: float(body.mass[0]) for body in bodies},
        joints=tuple(known),
        limits={
            name: tuple(known[name].range.tolist()) if model.jnt_limited[known[name].id] else None
            for name in robot.joints
            if name in known
        },
        shapes=model.ngeom,
        motion=_compute_dynamics(model, known, robot) if set(robot.joints) <= set(known) else None,
    )


def _compute_dynamics(model: Any, known: dict[str, Any], robot: EngineInput) -> EngineDynamics:
    import mujoco
    import numpy as np

    places = [int(known[name].qposadr[0]) for name in robot.joints]
    rows = [int(known[name].dofadr[0]) for name in robot.joints]
    model.opt.gravity[:] = 0, 0, -9.81
    # Contacts, limits and springs are not what is compared.
    off = mujoco.mjtDisableBit
    model.opt.disableflags |= off.mjDSBL_CONSTRAINT | off.mjDSBL_SPRING | off.mjDSBL_DAMPER
    data = mujoco.MjData(model)
    masses, torques = [], []
    falls: Vector = ()
    for values in robot.samples:
        mujoco.mj_resetData(model, data)
        data.qpos[places] = values
        mujoco.mj_forward(model, data)
        columns = np.empty((len(rows), model.nv))
        for row, index in enumerate(rows):
            mujoco.mj_mulM(model, data, columns[row], np.eye(1, model.nv, index)[0])
        masses.append(tuple(map(tuple, columns[:, rows].tolist())))
        torques.append(tuple(data.qfrc_bias[rows].tolist()))
    if model.nv == len(rows):
        mujoco.mj_resetData(model, data)
        data.qpos[places] = robot.start
        mujoco.mj_forward(model, data)
        falls = tuple(data.qacc[rows].tolist())
        # What is no number it resets, with a warning.
        if any(warning.number for warning in data.warning):
            falls = (math.nan,) * len(rows)
    return EngineDynamics(joints=robot.joints, masses=tuple(masses), torques=tuple(torques), accelerations=falls)
