"""Qhull without the rest of scipy, which takes ten times as long to load."""

from __future__ import annotations

import importlib
import sys
from importlib.machinery import PathFinder
from importlib.util import module_from_spec
from pathlib import Path
from types import ModuleType

# In the order in which the second needs the first.
_COMPILED = ("scipy.linalg.cython_lapack", "scipy.spatial._qhull")


def load_qhull() -> ModuleType:
    """Load the module of scipy that has ``ConvexHull`` and ``QhullError``.

    ``scipy.spatial`` imports sparse matrices, LAPACK, special functions and k-d trees: 0.28 s of processor time where Qhull
    takes 0.02 (scipy 1.17). Its compiled modules are therefore loaded without their packages, under their own names: if scipy's
    packages are imported later, they find them. Where scipy is built in another way, it is imported as a whole.
    """
    if "scipy.spatial" not in sys.modules:
        try:
            for name in _COMPILED:
                _load_without_package(name)
            return sys.modules[_COMPILED[-1]]
        except Exception:  # whatever a module raises that is not made to be loaded like this
            pass
    return importlib.import_module("scipy.spatial")


def _load_without_package(name: str) -> None:
    """Load a module by itself.

    :raises ImportError: when there is no such file.
    """
    if name in sys.modules:
        return
    root, *folders, _ = name.split(".")
    home = Path(str(importlib.import_module(root).__file__)).parent
    spec = PathFinder.find_spec(name, [str(home.joinpath(*folders))])
    if spec is None or spec.loader is None:
        raise ImportError(f"no module {name}", name=name)
    module = module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
