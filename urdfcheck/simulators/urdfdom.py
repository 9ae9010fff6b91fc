"""urdfdom, the parser of ROS, as far as Pinocchio shows what it read; RViz, MoveIt and KDL read models with it."""

from __future__ import annotations

from urdfcheck.simulators.outcome import Loaded, Robot
from urdfcheck.simulators.pinocchio import INSTALL as INSTALL
from urdfcheck.simulators.pinocchio import LIBRARIES as LIBRARIES
from urdfcheck.simulators.pinocchio import joints, masses
from urdfcheck.simulators.pinocchio import version as version

# What Pinocchio raises when urdfdom gave it no model; whatever else it raises is its own.
_NO_MODEL = "does not contain a valid URDF model"


def load(robot: Robot, path: str) -> Loaded:
    """Links and joints only: what is computed with them is not urdfdom's doing."""
    import pinocchio as pin

    try:
        model = pin.buildModelFromUrdf(path)
    except ValueError as error:
        if _NO_MODEL in str(error):
            raise
        return Loaded({}, (), {})
    return Loaded(links=masses(model), joints=joints(model), limits={})
