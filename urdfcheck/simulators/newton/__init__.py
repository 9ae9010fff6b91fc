"""The importer of Newton (``urdf-usd-converter``), which converts URDF to USD.

It needs libraries that urdfcheck does not: ``URDFCHECK_NEWTON`` names the virtual environment that has it, which must be of the
same Python. Without the variable it is looked for in urdfcheck's own environment.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from urdfcheck.simulators.outcome import EngineInput, LoadedRobot
from urdfcheck.simulators.usd.environment import find_version

ENVIRONMENT_VARIABLE = "URDFCHECK_NEWTON"
INSTALL = (
    f"python{sys.version_info.major}.{sys.version_info.minor} -m venv NEWTON && NEWTON/bin/pip install urdf-usd-converter, "
    f"and {ENVIRONMENT_VARIABLE}=NEWTON"
)
# Imports those of that environment.
LIBRARIES = ("urdfcheck.simulators.newton.libraries",)


def get_version() -> str | None:
    """Return the installed version."""
    return find_version(ENVIRONMENT_VARIABLE, "urdf-usd-converter")


def load(robot: EngineInput, path: str) -> LoadedRobot:
    """Load the converted model. Names that USD does not allow are replaced; what is displayed keeps them."""
    import urdf_usd_converter

    from urdfcheck.simulators.usd.diagnostics import print_warnings
    from urdfcheck.simulators.usd.stage import read_robot

    tempfile.tempdir = str(Path(path).parent)  # this process may write nowhere else
    with print_warnings():
        asset = urdf_usd_converter.Converter(layer_structure=False).convert(path, str(Path(path).with_name("usd")))
    if not asset:
        raise RuntimeError("the conversion failed")
    return read_robot(asset.path, robot)
