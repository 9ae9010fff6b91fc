"""A cache of results between runs: named groups of arrays under a key that covers all that they depend on.

An entry is one npz file per group, written atomically and read without pickle. A file that cannot be read is dropped, and a
folder that cannot be written is not an error: missing results are computed again.
"""

from __future__ import annotations

import contextlib
import os
import re
import struct
import time
import zlib
from collections.abc import Callable, Iterator, Mapping, MutableMapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from urdfcheck.core.records import dataclass
from urdfcheck.system.cache_folder import create_atomically, note_use, write_atomically
from urdfcheck.system.files import MAX_MESH, FileTooLargeError, note_lookup, read_pieces_with_digest, read_with_digest
from urdfcheck.system.observing.questions import SETTLED_NS, compute_sha256, note_content

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Arrays = Mapping[str, NDArray[Any]]
    Entry = MutableMapping[str, Arrays]

# Bytes above which the least recently used entries are dropped.
LARGEST = 2 * 1024**3
_TIDY_EVERY = 3600.0
# The header of a numeric array as numpy writes it.
_HEADER = re.compile(
    rb"\x93NUMPY\x01\x00..\{'descr': '([<|][biuf]\d+)', 'fortran_order': (True|False), 'shape': \(([\d, ]*)\), \} *\n",
    re.DOTALL,
)


@dataclass(frozen=True, slots=True)
class ArrayCache:
    """A folder of entries; without a folder, every entry is an empty dictionary that is not kept."""

    folder: Path | None = None

    def entry(self, kind: str, key: str) -> Entry:
        """Return the groups of arrays of one key, which are read on access and written on assignment."""
        return {} if self.folder is None else _StoredEntry(self.folder / kind / key[:2] / key[2:])

    def compute_digest(
        self,
        path: Path,
        limit: int = MAX_MESH,
        read: Callable[[BinaryIO, int, Callable[[Any], object]], Any] | None = None,
    ) -> tuple[str, Any]:
        """Compute the SHA-256 of a file's content, in hex; also return the content if it was read for that.

        A file whose times, size and inode are known is not read again.

        :param read: see `urdfcheck.system.files.read_pieces_with_digest`; what it returns is the content.

        :raises FileTooLargeError: when it has more than ``limit`` bytes.
        :raises OSError: when it is not a regular file, or cannot be read.
        """
        status = path.stat()
        note_lookup(path, status)
        note_content(path, status)
        if status.st_size > limit:
            raise FileTooLargeError(limit, status.st_size)
        stamp = f"{status.st_size} {status.st_mtime_ns} {status.st_ctime_ns} {status.st_ino}"
        place = (
            None if self.folder is None else self.folder / "files" / compute_sha256(os.fsencode(os.path.realpath(path)))
        )
        if place is not None:
            with contextlib.suppress(OSError, ValueError):
                known, _, digest = place.read_text(encoding="ascii").rpartition(" ")
                if known == stamp and len(digest) == 64:
                    note_content(path, status, digest)
                    return digest, None
        in_pieces = read and read_pieces_with_digest(path, limit, read)
        data, digest = in_pieces or read_with_digest(path, limit)
        if place is not None and time.time_ns() - status.st_mtime_ns > SETTLED_NS:
            write_atomically(place, f"{stamp} {digest}".encode("ascii"))
        return digest, data

    def iter_files(self) -> Iterator[tuple[Path, os.stat_result]]:
        """Yield the files in the folder with their status."""
        if self.folder is not None:
            for parent, _, names in os.walk(self.folder):
                for name in names:
                    with contextlib.suppress(OSError):
                        yield (path := Path(parent, name)), path.stat()

    def tidy(self) -> None:
        """Trim unless that was done within the last hour."""
        if self.folder is None or not os.path.isdir(self.folder):
            return
        marker = self.folder / "trimmed"
        with contextlib.suppress(OSError):
            if time.time() - marker.stat().st_mtime < _TIDY_EVERY:
                return
        self.trim()
        write_atomically(marker, b"")

    def trim(self, largest: int = LARGEST) -> None:
        """Drop the least recently used entries until at most ``largest`` bytes are left."""
        entries: dict[str, tuple[int, int]] = {}  # the time of its last use, and its size
        for path, status in self.iter_files():
            entry = str(path.parent if path.suffix == ".npz" else path)
            used, size = entries.get(entry, (0, 0))
            entries[entry] = max(used, status.st_mtime_ns), size + status.st_size
        total = 0
        for entry in sorted(entries, key=lambda entry: -entries[entry][0]):
            total += entries[entry][1]
            if total > largest:
                _remove_entry(Path(entry))

    def clear(self) -> None:
        """Drop all entries."""
        self.trim(-1)


def _remove_entry(entry: Path) -> None:
    """Delete an entry, which is a file or a folder of files."""
    with contextlib.suppress(OSError):
        if not entry.is_dir():
            entry.unlink()
            return
        for path in entry.glob("*.npz"):
            path.unlink()
        entry.rmdir()


class _StoredEntry(MutableMapping[str, "Arrays"]):
    """An entry on disk, one file per group. Groups that were read or set stay in memory."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._groups: dict[str, Arrays] = {}

    def __getitem__(self, name: str) -> Arrays:
        if name not in self._groups:
            self._groups[name] = self._read_group(name)
        return self._groups[name]

    def __setitem__(self, name: str, arrays: Arrays) -> None:
        self._groups[name] = arrays
        create_atomically(self._get_path(name), partial(_write_npz, arrays))

    def __delitem__(self, name: str) -> None:
        self._groups.pop(name, None)
        self._get_path(name).unlink(missing_ok=True)

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(path.stem for path in self._folder.glob("[!.]*.npz")))

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def _get_path(self, name: str) -> Path:
        return self._folder / f"{name}.npz"

    def _read_group(self, name: str) -> Arrays:
        path = self._get_path(name)
        try:
            arrays = {name: _decode_npy(data) for name, data in _iter_members(path.read_bytes())}
            note_use(path)
        except FileNotFoundError:
            raise KeyError(name) from None
        except Exception:  # a damaged file raises many kinds
            with contextlib.suppress(OSError):
                path.unlink()
            raise KeyError(name) from None
        return arrays


# Of the local header of a member of a zip file: flags, compression, CRC-32, stored and original size, lengths of name and more.
_MEMBER = struct.Struct("<4x2xHH4xIIIHH")
# Of the end of its directory: a sign, the number of members, size and start of the directory.
_END = struct.Struct("<4s6xHII2x")


def _iter_members(data: bytes) -> Iterator[tuple[str, bytes]]:
    """Yield the names and contents of the arrays of an npz file as `_write_npz` writes it; zipfile takes ten times as long for
    small ones.

    :raises ValueError, struct.error, UnicodeDecodeError: for any other content, and for a file that is damaged.
    """
    start, count = 0, 0
    while data.startswith(b"PK\x03\x04", start):
        flags, compression, checksum, stored, size, name_size, more = _MEMBER.unpack_from(data, start)
        name_at = start + _MEMBER.size
        start = name_at + name_size + more + size
        content = data[start - size : start]
        if flags or compression or stored != size or len(content) != size or zlib.crc32(content) != checksum:
            raise ValueError("not written here, or damaged")
        count += 1
        yield data[name_at : name_at + name_size].decode("ascii").removesuffix(".npy"), content
    sign, members, directory_size, directory_start = _END.unpack(data[-_END.size :])
    is_whole = (sign, members, directory_start) == (b"PK\x05\x06", count, start)
    if not is_whole or start + directory_size + _END.size != len(data):
        raise ValueError("the end is missing")


def _write_npz(arrays: Arrays, path: Path) -> None:
    """Write arrays as an npz file, without a copy of their contents; numpy.savez takes four times as long for small ones."""
    import zipfile  # a run that computes nothing new does not need it

    with zipfile.ZipFile(path, "w") as archive:
        for name, array in arrays.items():
            header = f"{{'descr': '{array.dtype.str}', 'fortran_order': False, 'shape': {array.shape}, }}"
            padded = header.ljust(-(len(header) + 11) % 64 + len(header)) + "\n"
            size = len(padded).to_bytes(2, "little")
            with archive.open(f"{name}.npy", "w") as member:
                member.write(b"\x93NUMPY\x01\x00" + size + padded.encode())
                member.write(array.ravel().data)


def _decode_npy(data: bytes) -> NDArray[Any]:
    """Decode an array of an npz file; it is read-only.

    Only headers of the form that `_write_npz` writes are accepted. np.load accepts any and evaluates each as Python, which
    takes most of the time for a small array.

    :raises ValueError: for any other header.
    """
    import numpy as np

    header = _HEADER.match(data)
    if header is None:
        raise ValueError("not written here")
    shape = tuple(int(size) for size in header.group(3).split(b",") if size.strip())
    array: NDArray[Any] = np.frombuffer(data, np.dtype(header.group(1).decode()), offset=header.end())
    return array.reshape(shape, order="F" if header.group(2) == b"True" else "C")
