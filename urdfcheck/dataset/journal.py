"""The resume file of an audit of many models: each result as soon as it is finished, so that the next run continues there.

The file begins with a header line that holds the settings of the audit. The entries follow in the order in which they were
finished: a line of JSON (key, the files that the result depends on, length and checksum of the text) and the text itself on
the next line. The file only grows, so an abort can damage no more than the last entry.

A journal is trusted only where it was written: one that came with a dataset could claim that all models are fine. The header
contains the inode, which cannot be known before the file exists.
"""

from __future__ import annotations

import contextlib
import json
import os
import stat
import zlib
from collections.abc import Iterator, Mapping
from collections.abc import Set as AbstractSet
from functools import lru_cache
from io import BufferedReader, BufferedWriter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from urdfcheck.core.errors import UrdfcheckError
from urdfcheck.system.files import Stamp, read_stamp

if TYPE_CHECKING:
    from typing_extensions import Self

NAME = "journal"
_FIRST = b'{"urdfcheck audit": 1, '
_PLACE = "inode"
# Prefix of files that are written aside and then replace another file.
TEMPORARY = ".urdfcheck-"
# In bytes. The file may have come with a dataset; settings take some kB, and at most 100 for each folder that is named.
_LONGEST_HEADER = 16 * 1024**2
# The stamps of this many files are cached, because models share files.
_REMEMBERED = 10_000


class Journal:
    """The entries of a folder by key. Only one process at a time may open it."""

    def __init__(
        self, folder: Path, settings: Mapping[str, Any], wanted: AbstractSet[str], *, restart: bool = False
    ) -> None:
        """Open or begin the journal of a folder. Entries of keys that are not ``wanted``, or whose files have changed, are
        ignored; ``restart`` ignores all.

        :raises UrdfcheckError: if the folder holds something else, was begun under other settings, is in use, or cannot be
            written.
        """
        self._folder = folder
        self._settings = settings
        self._places: dict[str, tuple[int, int, int]] = {}
        self._superseded = False
        with translate_os_errors(folder):
            self._descriptor = _open_journal(folder)
        try:
            with translate_os_errors(folder):
                _lock_journal(self._descriptor, folder)
                self._end = self._scan(wanted, restart)
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        os.close(self._descriptor)

    def __contains__(self, key: str) -> bool:
        return key in self._places

    def read_text(self, key: str) -> bytes:
        """Read the text of an entry.

        :raises KeyError: if the key has none.
        """
        _, start, length = self._places[key]
        with open(self._descriptor, "rb", closefd=False) as file:
            file.seek(start)
            return file.read(length)

    def add(self, key: str, text: bytes, reads: Mapping[str, Stamp]) -> None:
        """Append an entry: a line of text, and the stamps of the files that it depends on.

        :raises UrdfcheckError: if it cannot be written; the other entries remain.
        """
        head = json.dumps({"key": key, "bytes": len(text), "sum": zlib.crc32(text), "reads": reads}).encode() + b"\n"
        with translate_os_errors(self._folder):
            self._append(head + text + b"\n")
        self._superseded = self._superseded or key in self._places
        self._places[key] = self._end, self._end + len(head), len(text)
        self._end += len(head) + len(text) + 1

    def trim(self) -> None:
        """Rewrite the file without superseded entries. Without space for that it stays as it is."""
        if not self._superseded:
            return
        temporary = self._folder / f"{TEMPORARY}{NAME}"
        with contextlib.suppress(OSError):
            try:
                with open_new_file(temporary) as out, open(self._descriptor, "rb", closefd=False) as file:
                    out.write(_encode_header(self._settings, out.fileno()))
                    for place, start, length in sorted(self._places.values()):
                        file.seek(place)
                        out.write(file.read(start + length + 1 - place))
                os.replace(temporary, self._folder / NAME)
            finally:
                temporary.unlink(missing_ok=True)

    def _scan(self, wanted: AbstractSet[str], restart: bool) -> int:
        """Read all entries and cut off an incomplete one; return the offset of the next entry."""
        expected = _encode_header(self._settings, self._descriptor)
        with open(self._descriptor, "rb", closefd=False) as file:
            file.seek(0)
            header = file.readline(_LONGEST_HEADER)
            if restart or (not header.endswith(b"\n") and len(header) < _LONGEST_HEADER):
                os.ftruncate(self._descriptor, 0)
                self._end = 0
                self._append(expected)
                return len(expected)
            if header != expected:
                raise UrdfcheckError(_explain_other_settings(self._folder, header, expected))
            end = len(header)
            are_unchanged = _Freshness()
            while (entry := _read_entry(file)) is not None:
                head, text = entry
                start = end + len(head)
                facts = json.loads(head)
                useful = facts["key"] in wanted and are_unchanged(facts["reads"])
                self._superseded = self._superseded or facts["key"] in self._places or not useful
                self._places.pop(facts["key"], None)
                if useful:
                    self._places[facts["key"]] = end, start, len(text)
                end = start + len(text) + 1
        os.ftruncate(self._descriptor, end)
        return end

    def _append(self, data: bytes) -> None:
        """Append all of the data, or nothing."""
        os.lseek(self._descriptor, self._end, os.SEEK_SET)
        rest = memoryview(data)
        try:
            while rest:
                rest = rest[os.write(self._descriptor, rest) :]
        except OSError:
            os.ftruncate(self._descriptor, self._end)
            raise


class _Freshness:
    """Compares files with their recorded stamps."""

    def __init__(self) -> None:
        self._stamp = lru_cache(_REMEMBERED)(read_stamp)

    def __call__(self, reads: Mapping[str, object]) -> bool:
        """Whether all files are unchanged; False if none of them existed, because then the entry may depend on anything."""
        return any(reads.values()) and all(self._read_stamp(path) == known for path, known in reads.items())

    def _read_stamp(self, path: str) -> object:
        stamp = self._stamp(path)
        return None if stamp is None else list(stamp)


@contextlib.contextmanager
def translate_os_errors(folder: Path) -> Iterator[None]:
    """Turn an OSError about the files of a folder into a UrdfcheckError."""
    try:
        yield
    except OSError as error:
        raise UrdfcheckError(f"cannot write {folder}: {error.strerror or error}") from None


def open_new_file(path: Path) -> BufferedWriter:
    """Open a new file for writing; a link of that name is removed, not followed."""
    path.unlink(missing_ok=True)
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
    return os.fdopen(os.open(path, flags, 0o666), "wb")


def _open_journal(folder: Path) -> int:
    """Open the journal of a folder; begin one in an empty folder."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / NAME
    flags = os.O_RDWR
    for name in ("O_NOFOLLOW", "O_NONBLOCK", "O_CLOEXEC", "O_BINARY"):  # a pipe of that name would be waited for
        flags |= getattr(os, name, 0)
    try:
        descriptor = os.open(path, flags)
    except FileNotFoundError:
        if any(not name.startswith(TEMPORARY) for name in os.listdir(folder)):
            raise UrdfcheckError(
                f"{folder} holds something other than an audit: name an empty or new folder (-o)"
            ) from None
        return os.open(path, flags | os.O_CREAT | os.O_EXCL, 0o666)
    begins = os.read(descriptor, len(_FIRST)) if stat.S_ISREG(os.fstat(descriptor).st_mode) else None
    if begins is None or not _FIRST.startswith(begins):
        os.close(descriptor)
        raise UrdfcheckError(f"{path} is not the journal of an audit: name another folder (-o)")
    return descriptor


def _lock_journal(descriptor: int, folder: Path) -> None:
    try:
        import fcntl
    except ImportError:  # Windows has no such lock
        return
    try:
        # Workers do not inherit this lock, and they may outlive a killed audit. Closing any descriptor of the file releases it.
        fcntl.lockf(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        raise UrdfcheckError(f"another audit is running in {folder}") from None
    except OSError:  # the file system has no locks
        return


def _read_entry(file: BufferedReader) -> tuple[bytes, bytes] | None:
    """Read the next entry; None if there is no complete one."""
    head = file.readline()
    try:
        facts = json.loads(head)
        text = file.read(facts["bytes"] + 1)
        complete = len(text) == facts["bytes"] + 1 and zlib.crc32(text[:-1]) == facts["sum"]
        complete = complete and isinstance(facts["key"], str) and isinstance(facts["reads"], dict)
    except (ValueError, KeyError, TypeError):
        return None
    return (head, text[:-1]) if complete else None


def _encode_header(settings: Mapping[str, Any], descriptor: int) -> bytes:
    here = {**settings, _PLACE: os.fstat(descriptor).st_ino}
    return _FIRST + json.dumps(here, sort_keys=True).encode()[1:] + b"\n"


def _explain_other_settings(folder: Path, known: bytes, now: bytes) -> str:
    after = json.loads(now)
    try:
        before = json.loads(known)
    except (ValueError, RecursionError):
        before = after
    # Other names than ours are a stranger's.
    names = [name for name in sorted(after) if before.get(name) != after[name]]
    if names == [_PLACE]:
        return f"what is in {folder} was not written there but copied: --restart forgets it, -o names another folder"
    what = ", ".join(name for name in names if name != _PLACE) or "of another kind"
    return f"what is in {folder} was found under other settings ({what}): --restart forgets it, -o names another folder"
