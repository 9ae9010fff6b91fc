"""The importer of Isaac Sim (``isaacsim-asset-isolated``), which converts URDF to USD. It needs neither Isaac Sim nor a GPU.

It needs libraries that urdfcheck does not: ``URDFCHECK_ISAAC`` names the virtual environment that has it, which must be of the
same Python; release 6 asks for Python 3.12. Without the variable it is looked for in urdfcheck's own environment.
"""

from __future__ import annotations

import logging
import tempfile
from pathlib import Path

from urdfcheck.simulators.outcome import EngineInput, LoadedRobot
from urdfcheck.simulators.usd.environment import find_version

ENVIRONMENT_VARIABLE = "URDFCHECK_ISAAC"
INSTALL = (
    "with urdfcheck in Python 3.12: python3.12 -m venv ISAAC && ISAAC/bin/pip install isaacsim-asset-isolated, "
    f"and {ENVIRONMENT_VARIABLE}=ISAAC"
)
# Imports those of that environment.
LIBRARIES = ("urdfcheck.simulators.isaac.libraries",)


def get_version() -> str | None:
    """Return the installed version."""
    return find_version(ENVIRONMENT_VARIABLE, "isaacsim-asset-isolated")


def load(robot: EngineInput, path: str) -> LoadedRobot:
    """Load the imported model, with the importer's defaults: fixed joints are not merged.

    The last step, which distributes the same model over several files, is left out.
    """
    from isaacsim.asset.importer.urdf import URDFImporter, URDFImporterConfig

    from urdfcheck.simulators.usd.diagnostics import print_warnings
    from urdfcheck.simulators.usd.stage import read_robot

    tempfile.tempdir = str(Path(path).parent)  # this process may write nowhere else
    logging.disable(logging.WARNING)  # it warns of every joint that a URDF has no stiffness
    config = URDFImporterConfig(urdf_path=path, usd_path=str(Path(path).with_name("usd")), run_asset_transformer=False)
    with print_warnings():
        asset = URDFImporter(config).import_urdf()
    return read_robot(asset, robot)
