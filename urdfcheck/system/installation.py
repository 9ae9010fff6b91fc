"""Which urdfcheck this is, with which libraries: results are kept for the same one only."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from urdfcheck.system.observing.questions import compute_sha256

_PACKAGE = Path(__file__).parent.parent
# Libraries that compute what is found. What else is installed or removed changes the folder that it is in.
_LIBRARIES = ("numpy", "scipy", "trimesh", "collada", "pinocchio", "coal", "xacro", "yaml", "mujoco")
_SITES = ("site-packages", "dist-packages")
# What the distribution urdfcheck-core leaves out, as a person calls it; of the first two there are no wheels for Windows.
_LEFT_OUT = {"pinocchio": "Pinocchio", "coal": "coal", "scipy": "scipy", "lxml": "lxml"}
_NOT_ON_WINDOWS = ("pinocchio", "coal")
FULL, CORE = "urdfcheck", "urdfcheck-core"


def find_pages_folder() -> Path:
    """Return the folder of the pages of the rules: in the installed package, or in the source tree beside it."""
    installed = _PACKAGE / "_rules"
    return installed if installed.is_dir() else _PACKAGE.parent / "rules"


def describe_left_out(error: ImportError) -> str | None:
    """Say which library is not installed and why; None for one that every distribution needs."""
    module = (error.name or "").partition(".")[0]
    if module not in _LEFT_OUT:
        return None
    if sys.platform == "win32" and module in _NOT_ON_WINDOWS:
        return f"{_LEFT_OUT[module]} is not installed (it has no wheels for Windows)"
    return f"{_LEFT_OUT[module]} is not installed (it comes with {FULL}, not with {CORE})"


def name_distribution() -> str:
    """Return the name under which urdfcheck was installed, to which an extra can be added."""
    from importlib.metadata import PackageNotFoundError, distribution  # slow to import

    for name in (FULL, CORE):
        try:
            return distribution(name).metadata["Name"]
        except PackageNotFoundError:
            continue
    return FULL


def list_own_files() -> tuple[Path, ...]:
    """Return the folders of urdfcheck's own files, which are never checked."""
    return _PACKAGE, find_pages_folder()


@cache
def compute_installation_stamp() -> str:
    """Return a digest that changes with any file of urdfcheck, with what is installed beside it, and with Python.

    Files count by size and time.
    """
    parts = [sys.version, sys.prefix, str(getattr(os, "geteuid", int)()), *sys.path]
    parts += sorted((*_iter_stamps(_PACKAGE, (".py",)), *_iter_stamps(find_pages_folder(), (".md", ".toml"))))
    for folder in sys.path:
        if os.path.basename(folder) in _SITES:
            parts.append(_stamp(folder))
        parts += (_stamp(os.path.join(folder, library, "__init__.py")) for library in _LIBRARIES)
    return compute_sha256("\0".join(parts).encode("utf-8", "surrogatepass"))


def _iter_stamps(folder: Path, suffixes: tuple[str, ...]) -> Iterator[str]:
    """Yield the stamps of the files below a folder with these suffixes."""
    below = [str(folder)]
    while below:
        with os.scandir(below.pop()) as entries:
            for entry in entries:
                if entry.name.endswith(suffixes):
                    status = entry.stat()
                    yield f"{entry.path} {status.st_size} {status.st_mtime_ns}"
                elif "." not in entry.name and entry.name != "__pycache__" and entry.is_dir():
                    below.append(entry.path)


def _stamp(path: str) -> str:
    """Return size and time of a file or folder; empty where there is none."""
    try:
        status = os.stat(path)
    except OSError:
        return ""
    return f"{path} {status.st_size} {status.st_mtime_ns}"
