"""urdfdom, the parser of ROS that RViz, MoveIt and KDL use, as far as Pinocchio shows what it read."""

from __future__ import annotations

from urdfcheck.simulators.outcome import EngineInput, LoadedRobot
from urdfcheck.simulators.pinocchio import INSTALL as INSTALL
from urdfcheck.simulators.pinocchio import LIBRARIES as LIBRARIES
from urdfcheck.simulators.pinocchio import get_version as get_version
from urdfcheck.simulators.pinocchio import list_joints, list_masses

# Pinocchio's message when urdfdom rejects the model; its other errors are its own.
_NO_MODEL = "does not contain a valid URDF model"


def load(_robot: EngineInput, path: str) -> LoadedRobot:
    """Load links and joints only, because urdfdom computes nothing."""
    import pinocchio as pin

    try:
        model = pin.buildModelFromUrdf(path)
    except ValueError as error:
        if _NO_MODEL in str(error):
            raise
        return LoadedRobot(links={}, joints=(), limits={})
    return LoadedRobot(links=list_masses(model), joints=list_joints(model), limits={})
