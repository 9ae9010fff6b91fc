"""Contents that Git LFS keeps outside the objects: the repository has pointers to them."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterable
from pathlib import Path

from urdfcheck.system.files import MAX_MESH, read_regular

_POINTER = re.compile(
    rb"version https://git-lfs\.github\.com/spec/.*?^oid sha256:([0-9a-f]{64})$", re.DOTALL | re.MULTILINE
)
_LARGEST_POINTER = 1024


def find_pointer_digest(data: bytes) -> str | None:
    """Return the SHA-256 of the content that a pointer stands for; None for any other file."""
    match = _POINTER.match(data) if len(data) <= _LARGEST_POINTER else None
    return None if match is None else match[1].decode()


def find_content(digest: str, folder: Path, others: Iterable[Path]) -> bytes | None:
    """Return a content from the folder of Git LFS, or from one of some files that may be it; None where none is.

    Nothing is fetched, and only bytes of this digest are returned: whatever a link leads to, the repository knew them.
    """
    for place in (folder / digest[:2] / digest[2:4] / digest, *others):
        try:
            data = read_regular(place, MAX_MESH)
        except (OSError, ValueError):
            continue
        if hashlib.sha256(data).hexdigest() == digest:
            return data
    return None
