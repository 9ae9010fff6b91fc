"""Pinocchio, which reads URDF through urdfdom, the parser of ROS."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as distribution
from typing import Any

from urdfcheck.simulators.engine_input import compute_dynamics
from urdfcheck.simulators.outcome import EngineInput, LoadedRobot

INSTALL = "pip install urdfcheck, in place of urdfcheck-core; there are no wheels of pin for Windows"
LIBRARIES = ("pinocchio",)


def get_version() -> str | None:
    """Return the installed version."""
    try:
        return distribution("pin")
    except PackageNotFoundError:
        return None


def load(robot: EngineInput, path: str) -> LoadedRobot:
    """Load the model and its geometry as ``RobotWrapper.BuildFromURDF`` does."""
    import pinocchio as pin

    model = pin.buildModelFromUrdf(path)
    shapes = pin.buildGeomFromUrdf(model, path, pin.GeometryType.COLLISION)
    pin.buildGeomFromUrdf(model, path, pin.GeometryType.VISUAL)
    limits = {}
    for name in robot.joints:
        joint = model.joints[model.getJointId(name)] if model.existJointName(name) else None
        if joint is not None and joint.nq == 1:
            place = joint.idx_q
            limits[name] = float(model.lowerPositionLimit[place]), float(model.upperPositionLimit[place])
    return LoadedRobot(
        links=list_masses(model),
        joints=list_joints(model),
        limits=limits,
        shapes=shapes.ngeoms,
        motion=compute_dynamics(model, robot),
    )


def list_masses(model: Any) -> dict[str, float]:
    """List the masses of links in a ``pinocchio.Model``; the mass of links that fixed joints join counts for the first."""
    import pinocchio as pin

    bodies = [frame for frame in model.frames if frame.type == pin.FrameType.BODY]
    first = {frame.parentJoint: frame.name for frame in reversed(bodies)}
    return {
        frame.name: float(model.inertias[frame.parentJoint].mass) if first[frame.parentJoint] == frame.name else 0.0
        for frame in bodies
    }


def list_joints(model: Any) -> tuple[str, ...]:
    """List the joints of a ``pinocchio.Model``, including fixed ones."""
    import pinocchio as pin

    return tuple(f.name for f in model.frames if f.type in (pin.FrameType.JOINT, pin.FrameType.FIXED_JOINT))
