"""Import the libraries of Newton's importer, from the environment that is named for it, before this process is confined."""

from __future__ import annotations

import importlib
import sys

from urdfcheck.simulators.newton import find_library_folder

if (_folder := find_library_folder()) is not None:
    sys.path.insert(0, _folder)
for _name in ("urdf_usd_converter", "usdex.core", "pxr.UsdPhysics"):
    importlib.import_module(_name)
