"""Modules of the working directory that Python may have run before the first line of urdfcheck.

Python takes modules from the working directory for ``python -m``, and for an empty or relative entry of ``PYTHONPATH``, which a
ROS shell often leaves there. What is checked may be a stranger's: nothing can be undone then, but it can be said.
"""

from __future__ import annotations

import importlib.machinery
import os
import sys
from collections.abc import Iterable

from urdfcheck.system.files import is_inside

# Names that Python or an environment's .pth files import at their start, and our own.
_EARLY = frozenset({"sitecustomize", "usercustomize", "_virtualenv", "_distutils_hack", "urdfcheck"})


def find_planted_modules(folders: Iterable[str], checked: Iterable[str | os.PathLike[str]]) -> list[str]:
    """Return the files in some folders that Python may have run instead of its own modules.

    ``checked``: the folders whose files are checked. A folder that has nothing to do with one of them is the user's own.
    """
    found: list[str] = []
    real_checked = [os.path.realpath(folder) for folder in checked]
    for folder in folders:
        real = os.path.realpath(folder)
        if not any(is_inside(real, path) or is_inside(path, real) for path in real_checked):
            continue
        ours = os.path.realpath(os.path.dirname(os.path.dirname(os.path.dirname(__file__)))) == real
        found += [name for name in _list_modules(real) if not (ours and name == "urdfcheck")]
    return sorted(set(found))


def _list_modules(folder: str) -> list[str]:
    """Return the files and packages of a folder that Python would take for one of its own early modules."""
    try:
        names = os.listdir(folder)
    except OSError:
        return []
    suffixes = importlib.machinery.all_suffixes()
    found = []
    for name in names:
        module = name.partition(".")[0]
        if module not in _EARLY and module not in sys.stdlib_module_names and module not in sys.modules:
            continue
        is_package = any(os.path.isfile(os.path.join(folder, name, f"__init__{suffix}")) for suffix in suffixes)
        if name[len(module) :] in suffixes or is_package:
            found.append(name)
    return found
