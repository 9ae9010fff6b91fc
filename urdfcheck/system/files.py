"""Reading the files of strangers: regular ones only, of bounded size, and without waiting for any of them.

A pipe never ends, a device may act on being opened, and a file can grow or be exchanged while it is looked at: what is
opened is looked at once more, and never more is read than may be.
"""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from io import BytesIO
from pathlib import Path
from typing import BinaryIO

# The largest text of 366 XML files of published robots has 211 kB.
MAX_TEXT = 64 * 1024**2
# A binary STL of eight million triangles; the largest mesh file of a hundred published robots has 2.8 MB.
MAX_MESH = 384 * 1024**2
# How much is read at a time of what is longer than its own entry says, as files of /proc are.
_PIECE = 1024**2
# Size and time of the last change, in nanoseconds; None for what was looked for and is not there.
Stamp = tuple[int, int] | None
_record: ContextVar[dict[str, Stamp] | None] = ContextVar("record", default=None)
_overlay: ContextVar[Mapping[str, bytes] | None] = ContextVar("overlay", default=None)
_FLAGS = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0) | getattr(os, "O_BINARY", 0)


class FileTooLargeError(OSError):
    """A file has more bytes than ``limit``; ``found`` is how many, at least, and ``message`` says so."""

    def __init__(self, limit: int, found: int) -> None:
        self.message = f"the file has {found:,} bytes, more than {limit:,}"
        super().__init__(errno.EFBIG, self.message)
        self.limit = limit
        self.found = found


@contextmanager
def record_reads() -> Iterator[dict[str, Stamp]]:
    """The files that are read or looked for inside, by absolute path, each as it was the first time."""
    found: dict[str, Stamp] = {}
    token = _record.set(found)
    try:
        yield found
    finally:
        _record.reset(token)


@contextmanager
def overlay_files(texts: Mapping[str, bytes]) -> Iterator[None]:
    """Inside, files of these real paths read as if they held these bytes: how a model would look after an edit."""
    token = _overlay.set(texts)
    try:
        yield
    finally:
        _overlay.reset(token)


def note_lookup(path: Path, status: os.stat_result | None = None) -> None:
    """Say that what lies at a path (``status``, if that is known) decides about the outcome."""
    record = _record.get()
    if record is not None:
        record.setdefault(os.path.abspath(path), read_stamp(path) if status is None else _make_stamp(status))


def read_stamp(path: str | Path) -> Stamp:
    """What tells whether a file was changed since."""
    try:
        return _make_stamp(os.stat(path))
    except (OSError, ValueError):
        return None


def _make_stamp(status: os.stat_result) -> Stamp:
    return status.st_size, status.st_mtime_ns


def read_regular(path: Path, limit: int = MAX_TEXT) -> bytes:
    """The bytes of a regular file.

    :raises TooLarge: when it has more than ``limit`` of them.
    :raises OSError: for anything that is no regular file, and when it cannot be read.
    """
    with _open_regular(path) as (file, size):
        if size > limit:
            raise FileTooLargeError(limit, size)
        data = file.read(size + 1)
        while len(data) > size and (more := file.read(_PIECE)):
            data += more
            if len(data) > limit:
                break
    if len(data) > limit:
        raise FileTooLargeError(limit, len(data))
    return data


def read_start(path: Path, count: int) -> bytes:
    """The first ``count`` bytes of a regular file, all that it has where they are fewer.

    :raises OSError: for anything that is no regular file, and when it cannot be read.
    """
    with _open_regular(path) as (file, _):
        return file.read(count)


@contextmanager
def _open_regular(path: Path) -> Iterator[tuple[BinaryIO, int]]:
    """A regular file, opened, and its size."""
    try:
        _ensure_regular(os.stat(path), path)
        descriptor = os.open(path, _FLAGS)
    except ValueError:  # a NUL, or what the file system's encoding lacks
        raise OSError(errno.EINVAL, "Is no name of a file", str(path)) from None
    except OSError:
        note_lookup(path)  # what is missing may come
        raise
    with os.fdopen(descriptor, "rb") as file:
        status = os.fstat(descriptor)
        _ensure_regular(status, path)
        note_lookup(path, status)
        overlay = _overlay.get()
        data = overlay.get(os.path.realpath(path)) if overlay else None
        if data is None:
            yield file, status.st_size
        else:
            yield BytesIO(data), len(data)


def walk(root: Path) -> Iterator[tuple[str, list[str], list[str]]]:
    """Each folder at and below ``root`` with the names of the folders and of everything else in it, as os.walk has them from
    the top: which of the folders are looked into may be changed, and links are not followed. os.walk calls itself for each
    level of a stranger's tree."""
    below = [str(root)]
    while below:
        folder = below.pop()
        try:
            names = sorted(os.listdir(folder))
        except OSError:
            continue
        folders = [name for name in names if os.path.isdir(os.path.join(folder, name))]
        inner = set(folders)
        yield folder, folders, [name for name in names if name not in inner]
        below += [place for name in reversed(folders) if not os.path.islink(place := os.path.join(folder, name))]


def _ensure_regular(status: os.stat_result, path: Path) -> None:
    if stat.S_ISDIR(status.st_mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if not stat.S_ISREG(status.st_mode):
        raise OSError(errno.EINVAL, "Is no regular file", str(path))
