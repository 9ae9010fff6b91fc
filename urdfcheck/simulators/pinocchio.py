"""Pinocchio, which reads URDF through urdfdom, the parser of ROS."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as distribution
from typing import Any

from urdfcheck.simulators.outcome import Loaded, Robot
from urdfcheck.simulators.reading import motion_in

INSTALL = "there are no wheels of pin for this platform"
LIBRARIES = ("pinocchio",)


def version() -> str | None:
    """The installed version."""
    try:
        return distribution("pin")
    except PackageNotFoundError:
        return None


def load(robot: Robot, path: str) -> Loaded:
    """The model and its geometry, as ``RobotWrapper.BuildFromURDF`` loads it."""
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
    return Loaded(
        links=masses(model),
        joints=joints(model),
        limits=limits,
        shapes=shapes.ngeoms,
        motion=motion_in(model, robot),
    )


def masses(model: Any) -> dict[str, float]:
    """What links weigh in a ``pinocchio.Model``: those that fixed joints join all together, told of the first."""
    import pinocchio as pin

    bodies = [frame for frame in model.frames if frame.type == pin.FrameType.BODY]
    first = {frame.parentJoint: frame.name for frame in reversed(bodies)}
    return {
        frame.name: float(model.inertias[frame.parentJoint].mass) if first[frame.parentJoint] == frame.name else 0.0
        for frame in bodies
    }


def joints(model: Any) -> tuple[str, ...]:
    """The joints of a ``pinocchio.Model``, those that do not move among them."""
    import pinocchio as pin

    return tuple(f.name for f in model.frames if f.type in (pin.FrameType.JOINT, pin.FrameType.FIXED_JOINT))
