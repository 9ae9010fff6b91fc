"""The importer of Newton (``urdf-usd-converter``), which converts URDF to USD.

It needs libraries that urdfcheck does not: ``URDFCHECK_NEWTON`` names the virtual environment that has it, which must be of the
same Python. Without the variable it is looked for in urdfcheck's own environment.
"""

from __future__ import annotations

import math
import os
import sys
import tempfile
from collections.abc import Iterator
from importlib.metadata import Distribution, PackageNotFoundError
from pathlib import Path
from typing import Any

from urdfcheck.simulators.outcome import EngineInput, LoadedRobot, Range

ENVIRONMENT_VARIABLE = "URDFCHECK_NEWTON"
INSTALL = (
    f"python{sys.version_info.major}.{sys.version_info.minor} -m venv NEWTON && NEWTON/bin/pip install urdf-usd-converter, "
    f"and {ENVIRONMENT_VARIABLE}=NEWTON"
)
# Imports those of that environment.
LIBRARIES = ("urdfcheck.simulators.newton.libraries",)
# Names that are printed of those that it replaces.
_MOST_NAMES = 3


def find_library_folder() -> str | None:
    """Return the folder of libraries of the environment that the variable names; None without one of this Python."""
    named = os.environ.get(ENVIRONMENT_VARIABLE, "")
    if not os.path.isabs(named):
        return None
    version = f"python{sys.version_info.major}.{sys.version_info.minor}"
    inside = ("Lib",) if sys.platform == "win32" else ("lib", version)
    folder = os.path.join(named, *inside, "site-packages")
    return folder if os.path.isdir(folder) else None


def get_version() -> str | None:
    """Return the installed version."""
    folder = find_library_folder()
    where = sys.path if folder is None else [folder]
    try:
        return next(iter(Distribution.discover(name="urdf-usd-converter", path=where))).version
    except (PackageNotFoundError, StopIteration):
        return None


def load(robot: EngineInput, path: str) -> LoadedRobot:
    """Load the converted model. Names that USD does not allow are replaced; what is displayed keeps them."""
    import urdf_usd_converter
    import usdex.core
    from pxr import Usd, UsdPhysics

    tempfile.tempdir = str(Path(path).parent)  # this process may write nowhere else
    usdex.core.activateDiagnosticsDelegate()
    # Its warnings name files of this machine.
    usdex.core.setDiagnosticsLevel(usdex.core.DiagnosticsLevel.eError)
    asset = urdf_usd_converter.Converter(layer_structure=False).convert(path, str(Path(path).with_name("usd")))
    if not asset:
        raise RuntimeError("the conversion failed")
    stage = Usd.Stage.Open(asset.path)
    prims = list(Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies()))
    bodies = [prim for prim in prims if prim.HasAPI(UsdPhysics.RigidBodyAPI)]
    joints = {_read_name(prim): prim for prim in prims if prim.IsA(UsdPhysics.Joint)}
    _print_renamed([*bodies, *joints.values()])
    return LoadedRobot(
        links={_read_name(prim): float(UsdPhysics.MassAPI(prim).GetMassAttr().Get() or 0.0) for prim in bodies},
        joints=tuple(joints),
        limits={name: _read_limits(joints[name]) for name in robot.joints if name in joints},
        shapes=sum(prim.HasAPI(UsdPhysics.CollisionAPI) for prim in prims),
    )


def _read_name(prim: Any) -> str:
    name: str = prim.GetDisplayName() or prim.GetName()
    return name


def _print_renamed(prims: list[Any]) -> None:
    """Print which names were replaced, as what the engine says."""
    renamed = list(_iter_renamed(prims))
    if renamed:
        more = f" and {len(renamed) - _MOST_NAMES} more" if len(renamed) > _MOST_NAMES else ""
        print(f"replaces names that USD does not allow: {', '.join(renamed[:_MOST_NAMES])}{more}")


def _iter_renamed(prims: list[Any]) -> Iterator[str]:
    for prim in prims:
        if _read_name(prim) != prim.GetName():
            yield f"{_read_name(prim)} by {prim.GetName()}"


def _read_limits(prim: Any) -> Range | None:
    """Read the limits of a joint in rad or m; USD has degrees, and infinity where there is none."""
    from pxr import UsdPhysics

    if prim.IsA(UsdPhysics.RevoluteJoint):
        joint, unit = UsdPhysics.RevoluteJoint(prim), math.radians(1.0)
    elif prim.IsA(UsdPhysics.PrismaticJoint):
        joint, unit = UsdPhysics.PrismaticJoint(prim), 1.0
    else:
        return None
    lower, upper = joint.GetLowerLimitAttr().Get(), joint.GetUpperLimitAttr().Get()
    return None if lower is None or upper is None else (float(lower) * unit, float(upper) * unit)
