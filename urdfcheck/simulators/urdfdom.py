"""urdfdom, the parser of ROS, as far as Pinocchio shows what it read; RViz, MoveIt and KDL read models with it."""

from __future__ import annotations

from urdfcheck.simulators.outcome import EngineInput, LoadedRobot
from urdfcheck.simulators.pinocchio import INSTALL as INSTALL
from urdfcheck.simulators.pinocchio import LIBRARIES as LIBRARIES
from urdfcheck.simulators.pinocchio import get_version as get_version
from urdfcheck.simulators.pinocchio import list_joints, list_masses

# What Pinocchio raises when urdfdom gave it no model; whatever else it raises is its own.
_NO_MODEL = "does not contain a valid URDF model"


def load(robot: EngineInput, path: str) -> LoadedRobot:
    """Links and joints only: what is computed with them is not urdfdom's doing."""
    import pinocchio as pin

    try:
        model = pin.buildModelFromUrdf(path)
    except ValueError as error:
        if _NO_MODEL in str(error):
            raise
        return LoadedRobot({}, (), {})
    return LoadedRobot(links=list_masses(model), joints=list_joints(model), limits={})
