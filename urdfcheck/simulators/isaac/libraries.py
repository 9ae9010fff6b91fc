"""Import the libraries of Isaac Sim's importer, from the environment that is named for it, before this process is confined."""

from __future__ import annotations

from urdfcheck.simulators.isaac import ENVIRONMENT_VARIABLE
from urdfcheck.simulators.usd.environment import import_libraries

import_libraries(
    ENVIRONMENT_VARIABLE, ("isaacsim.asset.importer.urdf", "urdf_usd_converter", "usdex.core", "pxr.UsdPhysics")
)
