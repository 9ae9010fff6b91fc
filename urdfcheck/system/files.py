"""Read untrusted files: regular ones only, of bounded size, and without blocking.

A pipe never ends, opening a device may have effects, and a file can grow or be replaced between two system calls: an open
file is examined again, and never more is read than the limit allows.
"""

from __future__ import annotations

import errno
import os
import stat
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from io import BytesIO
from pathlib import Path

from urdfcheck.system.observing.questions import SETTLED_NS, compute_sha256, is_observing, note_content

# Type checkers take it for typing's, whose import takes a fifth of the time of --help.
TYPE_CHECKING = False

if TYPE_CHECKING:
    from typing import Any, BinaryIO, TypeVar

    Content = TypeVar("Content")

# The largest of 366 XML files of published robots has 211 kB.
MAX_TEXT = 64 * 1024**2
# A binary STL of eight million triangles; the largest mesh file of a hundred published robots has 2.8 MB.
MAX_MESH = 384 * 1024**2
# Bytes read at a time from a file that is longer than its status says, such as those of /proc.
_PIECE = 1024**2

# Bytes that a folder of some 500 files takes in most file systems; and of how many such folders something is remembered.
_LARGE_FOLDER, _MOST_FOLDERS = 16_384, 8

# Size in bytes and time of the last change in ns; None for a file that was looked for and does not exist.
Stamp = tuple[int, int] | None


class _Overlay:
    """Contents that replace those of files, by real path."""

    def __init__(self, texts: Mapping[str, bytes], *, is_trial: bool) -> None:
        self.texts = texts
        self.is_trial = is_trial
        # Of the files that exist; None if one does not.
        self.numbers = frozenset(map(_identify, texts))


_record: ContextVar[dict[str, Stamp] | None] = ContextVar("record", default=None)
_overlay: ContextVar[_Overlay | None] = ContextVar("overlay", default=None)
_FLAGS = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0) | getattr(os, "O_BINARY", 0)


class FileTooLargeError(OSError):
    """A file has at least ``found`` bytes, more than ``limit``; ``message`` states both."""

    def __init__(self, limit: int, found: int) -> None:
        self.message = f"the file has {found:,} bytes, more than {limit:,}"
        super().__init__(errno.EFBIG, self.message)
        self.limit = limit
        self.found = found


@contextmanager
def record_reads() -> Iterator[dict[str, Stamp]]:
    """Record the files that are read or looked for inside the context: the first stamp of each by its absolute path."""
    stamps: dict[str, Stamp] = {}
    token = _record.set(stamps)
    try:
        yield stamps
    finally:
        _record.reset(token)


@contextmanager
def overlay_files(texts: Mapping[str, bytes], *, is_trial: bool = False) -> Iterator[None]:
    """Read files of these real paths as if they held these bytes: the model after an edit.

    Inside another such context the other files keep the contents that it gives them. ``is_trial``: the contents were made of
    those of the files, which were read before; the outcome depends on nothing but them.
    """
    outer = _overlay.get()
    texts = texts if outer is None else {**outer.texts, **texts}
    token = _overlay.set(_Overlay(texts, is_trial=is_trial) if texts else None)
    try:
        yield
    finally:
        _overlay.reset(token)


def note_lookup(path: Path, status: os.stat_result | None = None) -> None:
    """Record that the outcome depends on the file at a path; ``status`` saves a system call where it is known.

    A watch and a journal use it. All that an outcome depends on is in `urdfcheck.system.observing.observations`.
    """
    record = _record.get()
    if record is not None:
        record.setdefault(os.path.abspath(path), read_stamp(path) if status is None else _make_stamp(status))


def read_stamp(path: str | Path) -> Stamp:
    """Return what identifies the version of a file; None where there is no file."""
    try:
        return _make_stamp(os.stat(path))
    except (OSError, ValueError):
        return None


def _make_stamp(status: os.stat_result) -> Stamp:
    return status.st_size, status.st_mtime_ns


def read_regular(path: Path, limit: int = MAX_TEXT) -> bytes:
    """Read the bytes of a regular file.

    :raises FileTooLargeError: when it has more than ``limit`` of them.
    :raises OSError: for anything but a regular file, and when it cannot be read.
    """
    return _read_whole(path, limit, with_digest=is_observing())[0]


def read_text_or_nothing(path: Path, limit: int = MAX_TEXT) -> str:
    """Return the text of a file that is searched and not parsed; empty if it cannot be read or has more than ``limit`` bytes."""
    try:
        return read_regular(path, limit).decode("utf-8", "replace")
    except OSError:
        return ""


def read_with_digest(path: Path, limit: int) -> tuple[bytes, str]:
    """Do the same as `read_regular`, and return the SHA-256 of the bytes, in hex, too."""
    return _read_whole(path, limit, with_digest=True)


def read_pieces_with_digest(
    path: Path, limit: int, read: Callable[[BinaryIO, int, Callable[[Any], object]], Content | None]
) -> tuple[Content, str] | None:
    """Return what ``read`` makes of a regular file, and the SHA-256 of its bytes, in hex.

    ``read`` gets the open file, its size, and a function to which it passes each piece. None when it returns None, and for a
    file of more than ``limit`` bytes.

    :raises OSError: as `read_regular`.
    """
    import hashlib

    digest = hashlib.sha256()
    with _open_regular(path) as (file, size, status):
        _note_content(path, status)
        found = read(file, size, digest.update) if size <= limit else None
    if found is None:
        return None
    _note_content(path, status, digest.hexdigest())
    return found, digest.hexdigest()


def _read_whole(path: Path, limit: int, *, with_digest: bool) -> tuple[bytes, str]:
    with _open_regular(path) as (file, size, status):
        _note_content(path, status)
        if size > limit:
            raise FileTooLargeError(limit, size)
        data = file.read(size + 1)
        while len(data) > size and (more := file.read(_PIECE)):
            data += more
            if len(data) > limit:
                break
    if len(data) > limit:
        raise FileTooLargeError(limit, len(data))
    if not with_digest:
        return data, ""
    digest = compute_sha256(data)
    _note_content(path, status, digest)
    return data, digest


def read_start(path: Path, count: int, *, follows_link: bool = True) -> bytes:
    """Read the first ``count`` bytes of a regular file, or all of a shorter one.

    ``follows_link``: False where a worker could have put a link in its place.

    :raises OSError: for anything but a regular file, and when it cannot be read.
    """
    with _open_regular(path, follows_link=follows_link) as (file, _, status):
        _note_content(path, status)
        return file.read(count)


def _note_content(path: Path, status: os.stat_result | None, digest: str = "") -> None:
    overlay = _overlay.get()
    if status is None and overlay is not None and overlay.is_trial:
        return
    note_content(path, status, digest)


@contextmanager
def _open_regular(path: Path, *, follows_link: bool = True) -> Iterator[tuple[BinaryIO, int, os.stat_result | None]]:
    """Open a regular file; yields it with its size and its status, which is None where another content is given for it."""
    data = _get_overlaid(path)
    if data is not None and not os.path.exists(path):  # it is only given
        note_lookup(path)
        yield BytesIO(data), len(data), None
        return
    try:
        _ensure_regular(os.stat(path, follow_symlinks=follows_link), path)
        descriptor = os.open(path, _FLAGS if follows_link else _FLAGS | getattr(os, "O_NOFOLLOW", 0))
    except ValueError:  # a NUL, or a character that the file system's encoding lacks
        raise OSError(errno.EINVAL, "Is not a valid file name", str(path)) from None
    except OSError:
        note_lookup(path)  # a missing file may be created later
        raise
    with os.fdopen(descriptor, "rb") as file:
        status = os.fstat(descriptor)
        _ensure_regular(status, path)
        note_lookup(path, status)
        if data is None:
            yield file, status.st_size, status
        else:
            yield BytesIO(data), len(data), None


def is_known_file(path: Path) -> bool:
    """Whether there is a regular file at a path, or a content is given for it (`overlay_files`)."""
    return path.is_file() or (_get_overlaid(path) is not None and not os.path.lexists(path))


def _get_overlaid(path: Path) -> bytes | None:
    """Return the content that replaces the file's, if any."""
    overlay = _overlay.get()
    # Nearly all files are told apart by their numbers; to find the real path takes ten times as long.
    if overlay is None or _identify(path) not in overlay.numbers:
        return None
    try:
        return overlay.texts.get(os.path.realpath(path))
    except (OSError, ValueError):  # no name of a file
        return None


def _identify(path: str | Path) -> tuple[int, int] | None:
    """Return the numbers of a file's device and of the file on it; None where there is no file."""
    try:
        status = os.stat(path)
    except (OSError, ValueError):
        return None
    return status.st_dev, status.st_ino


def remember_large_folders(read: Callable[[str], Content]) -> Callable[[str | Path], Content]:
    """Decorate a function that reads the names in a folder: what it returns for a large one is used until the folder changes.

    Each of 10,000 models in one folder asks for all its names. What observes must see each question, so it is asked again then.
    """
    known: dict[str, tuple[tuple[int, ...], Content]] = {}

    def read_or_remember(folder: str | Path) -> Content:
        place = os.fspath(folder)
        stamp = None if is_observing() or not os.path.isabs(place) else _stamp_large_folder(place)
        if stamp is None:
            return read(place)
        if place not in known or known[place][0] != stamp:
            known[place] = stamp, read(place)
            while len(known) > _MOST_FOLDERS:
                del known[next(iter(known))]
        return known[place][1]

    return read_or_remember


def _stamp_large_folder(folder: str) -> tuple[int, ...] | None:
    """Return what changes with the names in a folder; None for a small one, and for one that changed just now."""
    try:
        status = os.stat(folder)
    except (OSError, ValueError):
        return None
    settled = time.time_ns() - max(status.st_mtime_ns, status.st_ctime_ns) > SETTLED_NS
    stamp = status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns, status.st_ctime_ns
    return stamp if settled and status.st_size >= _LARGE_FOLDER else None


def walk(root: Path) -> Iterator[tuple[str, list[str], list[str]]]:
    """Yield each folder at and below ``root`` with the names of its folders and of its other entries, like ``os.walk``.

    The caller may remove folders from the list to skip them; links are not followed. ``os.walk`` itself recurses, and an
    untrusted tree may be deeper than Python's stack.
    """
    below = [str(root)]
    while below:
        folder = below.pop()
        try:
            with os.scandir(folder) as listed:
                entries = sorted(listed, key=lambda entry: entry.name)
        except OSError:
            continue
        inner = {entry.name: entry for entry in entries if _is_folder(entry)}
        folders = list(inner)
        yield folder, folders, [entry.name for entry in entries if entry.name not in inner]
        below += [inner[name].path for name in reversed(folders) if not inner[name].is_symlink()]


def _is_folder(entry: os.DirEntry[str]) -> bool:
    try:
        return entry.is_dir()
    except OSError:  # a link in a circle
        return False


def is_inside(real: str, folder: str) -> bool:
    """Whether a real path is this real folder, or lies in it."""
    return real == folder or real.startswith(folder.rstrip(os.sep) + os.sep)


def _ensure_regular(status: os.stat_result, path: Path) -> None:
    if stat.S_ISDIR(status.st_mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if not stat.S_ISREG(status.st_mode):
        raise OSError(errno.EINVAL, "Is not a regular file", str(path))
