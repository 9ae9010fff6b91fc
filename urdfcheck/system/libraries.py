"""Our own xacro and Pinocchio before those of a sourced ROS shell.

ROS puts its packages first through PYTHONPATH: its xacro is an older one without the functions that are traced here, and
its pinocchio is built for another Python. The folders of this installation are therefore put in front again.
"""

from __future__ import annotations

import functools
import importlib.util
import os
import sys
import sysconfig

TRACED = ("xacro", "pinocchio", "coal", "trimesh")


@functools.cache
def list_own_folders() -> tuple[str, ...]:
    """The site-packages folders of the Python environment that urdfcheck runs in."""
    paths = sysconfig.get_paths()
    return tuple(dict.fromkeys(os.path.realpath(paths[key]) for key in ("purelib", "platlib")))


def prefer_own_folders() -> None:
    """Move the environment's own folders (and what their .pth files added) in front of PYTHONPATH's, and forget the
    working directory: what lies there is checked and never imported."""
    own = list_own_folders()
    # `python -m urdfcheck` puts the working directory first: a rich.py of the checked repository would be imported.
    sys.path[:] = [p for p in sys.path if p not in {"", os.getcwd()}]
    first = [p for p in sys.path if _is_below(p, own)]
    if os.environ.get("PYTHONPATH"):
        sys.path[:] = [*first, *(p for p in sys.path if p not in first)]


def find_foreign_libraries() -> dict[str, str]:
    """The libraries that Python would take from outside of its own environment, with the path of each."""
    own = list_own_folders()
    found: dict[str, str] = {}
    for name in TRACED:
        try:
            spec = importlib.util.find_spec(name)
        except (ImportError, ValueError):
            continue
        if spec is not None and spec.origin and not _is_below(spec.origin, own):
            found[name] = spec.origin
    return found


def _is_below(path: str, folders: tuple[str, ...]) -> bool:
    real = os.path.realpath(path)
    return any(real == folder or real.startswith(folder + os.sep) for folder in folders)
