"""The folder in which results are kept between runs, and how files are written there. Standard library only."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Callable
from pathlib import Path

from urdfcheck.system.observing.questions import compute_sha256

FOLDER_VARIABLE = "URDFCHECK_CACHE_DIR"
# Everything is kept in a subfolder of this name, because the folder that the user names may hold other files.
NAME = "urdfcheck-results"
# Seconds within which a file counts as used at once: a run reads a hundred.
_SAME_USE = 3600.0


def find_default_folder() -> Path | None:
    """Return the folder that ``URDFCHECK_CACHE_DIR`` names, or the platform's cache folder; None where there is none."""
    if folder := os.environ.get(FOLDER_VARIABLE):
        return Path(os.path.expanduser(folder)).absolute() / NAME
    from platformdirs import user_cache_path

    try:
        return user_cache_path("urdfcheck", appauthor=False) / NAME
    except RuntimeError:  # a user without a home, as in some containers
        return None


def explain_unusable_folder(folder: Path) -> str | None:
    """Return why a folder cannot be read as a cache; None where it can, and where it is not there and cannot be made."""
    with contextlib.suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
    try:
        os.scandir(folder).close()
    except FileNotFoundError:
        return None
    except OSError as error:
        return error.strerror or str(error)
    return None


def write_atomically(path: Path, data: bytes) -> None:
    """Write a file atomically, even if other processes write the same one."""
    create_atomically(path, lambda temporary: temporary.write_bytes(data))


def create_atomically(path: Path, write: Callable[[Path], object]) -> None:
    """Do the same with what ``write`` writes to the path that it is given."""
    temporary = path.with_name(f".{os.urandom(8).hex()}-{path.name}")
    try:
        try:
            write(temporary)
        except FileNotFoundError:
            path.parent.mkdir(parents=True, exist_ok=True)
            write(temporary)
        os.replace(temporary, path)
    except OSError:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)


def note_use(path: Path) -> None:
    """Note that a file was used now, for :meth:`urdfcheck.system.array_cache.ArrayCache.trim`."""
    if time.time() - path.stat().st_mtime > _SAME_USE:
        os.utime(path)


def write_checked(path: Path, data: bytes) -> None:
    """Write a file as :func:`write_atomically` does, with a digest by which :func:`read_checked` finds damage."""
    write_atomically(path, compute_sha256(data).encode() + data)


def read_checked(path: Path) -> bytes | None:
    """Return what :func:`write_checked` wrote; None where there is nothing, or it is damaged."""
    try:
        data = path.read_bytes()
    except OSError:
        return None
    return data[64:] if data[:64] == compute_sha256(data[64:]).encode() else None
