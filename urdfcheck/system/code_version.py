"""Which code computes what is kept: a result is reused only by the code that computed it."""

from __future__ import annotations

import json
import os
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from urdfcheck.system.cache_folder import read_checked, write_checked
from urdfcheck.system.installation import compute_installation_stamp
from urdfcheck.system.observing.questions import compute_sha256

_PACKAGE = Path(__file__).parent.parent
# The digests of all modules that an earlier process read, by the parts of their names, in order.
_recalled: dict[tuple[str, ...], str] = {}


def compute_code_version(*modules: str, library: str | None = None) -> str:
    """Return a digest of the source of modules and packages (``urdfcheck.facts.mesh``) and of the origin of a library that they
    call (`find_library_origin`)."""
    digests = (digest for name in modules for digest in _digest_module(name))
    return compute_sha256("\0".join((*digests, library or "")).encode())[:16]


def recall_digests(folder: Path) -> None:
    """Read the digests of all modules as an earlier process of this installation computed them, or compute and keep them.

    To read the sources takes ten times as long. ``folder``: that of the cache.
    """
    if _recalled:
        return
    place = folder / "code" / compute_installation_stamp()
    data = read_checked(place)
    if data is None:
        files = sorted(_PACKAGE.rglob("*.py"))
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
    spec = find_spec(module)
    if spec is None or not spec.origin:
        raise ModuleNotFoundError(module)
    file = Path(spec.origin)
    return [file] if spec.submodule_search_locations is None else sorted(file.parent.rglob("*.py"))


@cache
def find_library_origin(library: str) -> str | None:
    """Return where and when a library was installed, without importing it; None when it is not installed."""
    spec = find_spec(library)
    if spec is None or not spec.origin:
        return None
    return f"{spec.origin} {os.stat(spec.origin).st_mtime_ns}"
