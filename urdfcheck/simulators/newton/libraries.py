"""Import the libraries of Newton's importer, from the environment that is named for it, before this process is confined."""

from __future__ import annotations

from urdfcheck.simulators.newton import ENVIRONMENT_VARIABLE
from urdfcheck.simulators.usd.environment import import_libraries

import_libraries(ENVIRONMENT_VARIABLE, ("urdf_usd_converter", "usdex.core", "pxr.UsdPhysics"))
