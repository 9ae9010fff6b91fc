"""Libraries that need an environment beside that of urdfcheck, of the same Python; a variable names it."""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Sequence
from importlib.metadata import Distribution


def find_library_folder(variable: str) -> str | None:
    """Return the folder of libraries of the environment that the variable names; None without one of this Python."""
    named = os.environ.get(variable, "")
    if not os.path.isabs(named):
        return None
    version = f"python{sys.version_info.major}.{sys.version_info.minor}"
    inside = ("Lib",) if sys.platform == "win32" else ("lib", version)
    folder = os.path.join(named, *inside, "site-packages")
    return folder if os.path.isdir(folder) else None


def find_version(variable: str, distribution: str) -> str | None:
    """Return the version installed in that environment, or without the variable in urdfcheck's own; None without it."""
    folder = find_library_folder(variable)
    where = sys.path if folder is None else [folder]
    found = next(iter(Distribution.discover(name=distribution, path=where)), None)
    return None if found is None else found.version


def import_libraries(variable: str, names: Sequence[str]) -> None:
    """Import libraries of that environment. Pinocchio, with which the models are compared, remains that of urdfcheck."""
    importlib.import_module("pinocchio")
    if (folder := find_library_folder(variable)) is not None:
        sys.path.insert(0, folder)
    for name in names:
        importlib.import_module(name)
