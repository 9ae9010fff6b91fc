"""Which urdfcheck this is, with which libraries: results are kept for the same one only."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from urdfcheck.system.cache_folder import read_checked, write_checked
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


# -- which code computes what is kept ------------------------------------------------------------------------------------

# The packages that compute what is kept, a quarter of all modules.
_COMPUTING = ("facts", "model")
# The digests of their modules that an earlier process read, by the parts of their names, in order.
_recalled: dict[tuple[str, ...], str] = {}


def compute_code_version(*modules: str, library: str | None = None) -> str:
    """Return a digest of the source of modules and packages (``urdfcheck.facts.mesh``) and of the origin of a library that they
    call (`find_library_origin`)."""
    digests = (digest for name in modules for digest in _digest_module(name))
    return compute_sha256("\0".join((*digests, library or "")).encode())[:16]


def recall_digests(folder: Path) -> None:
    """Read the digests of the modules that compute what is kept as an earlier process of this installation found them, or find
    and keep them.

    To read the sources takes ten times as long. ``folder``: that of the cache.
    """
    if _recalled:
        return
    import json  # not where a run is told again

    place = folder / "code" / compute_installation_stamp()
    data = read_checked(place)
    if data is None:
        files = sorted(file for part in _COMPUTING for file in (_PACKAGE / part).rglob("*.py"))
        data = json.dumps([[*_name_parts(file), compute_sha256(file.read_bytes())] for file in files]).encode()
        write_checked(place, data)
    _recalled.update((tuple(parts), digest) for *parts, digest in json.loads(data))


def _name_parts(file: Path) -> tuple[str, ...]:
    return (_PACKAGE.name, *file.relative_to(_PACKAGE).with_suffix("").parts)


@cache
def _digest_module(module: str) -> tuple[str, ...]:
    """Return the digest of the file of a module, or those of all files of a package, in the order of their paths."""
    parts = tuple(module.split("."))
    known = tuple(digest for name, digest in _recalled.items() if name[: len(parts)] == parts)
    return known or tuple(compute_sha256(path.read_bytes()) for path in _list_sources(module))


def _list_sources(module: str) -> list[Path]:
    """List the file of a module, or all files of a package."""
    from importlib.util import find_spec

    spec = find_spec(module)
    if spec is None or not spec.origin:
        raise ModuleNotFoundError(module)
    file = Path(spec.origin)
    return [file] if spec.submodule_search_locations is None else sorted(file.parent.rglob("*.py"))


@cache
def find_library_origin(library: str) -> str | None:
    """Return where and when a library was installed, without importing it; None when it is not installed."""
    from importlib.util import find_spec

    spec = find_spec(library)
    if spec is None or not spec.origin:
        return None
    return f"{spec.origin} {os.stat(spec.origin).st_mtime_ns}"
