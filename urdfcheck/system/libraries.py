"""Import our own xacro and Pinocchio rather than those of a sourced ROS shell.

ROS puts its packages first through PYTHONPATH: its xacro is older and lacks the functions that are traced here, and its
pinocchio is built for another Python. The folders of this installation are therefore moved to the front.
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
    """List the site-packages folders of the Python environment that urdfcheck runs in."""
    paths = sysconfig.get_paths()
    return tuple(dict.fromkeys(os.path.realpath(paths[key]) for key in ("purelib", "platlib")))


def prefer_own_folders() -> None:
    """Move the environment's own folders (and those that their .pth files added) in front of PYTHONPATH's, and remove the
    working directory: its files are checked and never imported."""
    own = list_own_folders()
    # `python -m urdfcheck` puts the working directory first: a rich.py of the checked repository would be imported.
    sys.path[:] = [p for p in sys.path if p not in {"", os.getcwd()}]
    inside = [p for p in sys.path if _is_below(p, own)]
    if os.environ.get("PYTHONPATH"):
        sys.path[:] = [*inside, *(p for p in sys.path if p not in inside)]


def find_foreign_libraries() -> dict[str, str]:
    """Find the libraries that Python would import from outside its own environment, with the path of each."""
    return dict(_find_foreign_libraries(tuple(sys.path)))


@functools.cache
def _find_foreign_libraries(_python_path: tuple[str, ...]) -> dict[str, str]:
    own = list_own_folders()
    origins: dict[str, str] = {}
    for name in TRACED:
        try:
            spec = importlib.util.find_spec(name)
        except (ImportError, ValueError):
            continue
        if spec is not None and spec.origin and not _is_below(spec.origin, own):
            origins[name] = spec.origin
    return origins


def _is_below(path: str, folders: tuple[str, ...]) -> bool:
    real = os.path.realpath(path)
    return any(real == folder or real.startswith(folder + os.sep) for folder in folders)
