"""Binary STL: of each triangle of 50 bytes only the corners are kept, while the file is read."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.mesh.decode_limits import MOST_TRIANGLES

if TYPE_CHECKING:
    from numpy.typing import NDArray

HEADER = 84
FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
# Triangles that are read at a time: their bytes stay in the processor's cache.
_PIECE = 5000
# The first bytes that are kept: they tell what a file is.
_START = 512


@dataclass(slots=True, eq=False)
class BinaryStl:
    """The content of a file."""

    start: bytes
    """Its first bytes."""
    _corners: NDArray[np.float32] | None

    def take_corners(self) -> NDArray[np.float32]:
        """Return the corners (3 F, 3), three for each triangle, once: their memory is free as soon as they are merged."""
        corners, self._corners = self._corners, None
        assert corners is not None
        return corners


def count_facets(start: bytes, size: int) -> int | None:
    """Return how many triangles a binary STL file of ``size`` bytes has; None for any other file. ``start``: its header.

    The size decides, not the first word: CAD systems write binary files whose header begins with "solid".
    """
    declared = int.from_bytes(start[80:HEADER], "little")
    return declared if size >= HEADER and size == HEADER + declared * FACET.itemsize else None


def read_binary_stl(file: Any, size: int, use: Callable[[Any], object] = lambda _: None) -> BinaryStl | None:
    """Read an open file of ``size`` bytes, and pass all of them to ``use``, a few at a time: to get new memory for them takes
    longer than to read them.

    None for any other file, for one of more triangles than the limit, and for one that changes meanwhile.
    """
    start = file.read(HEADER)
    count = count_facets(start, size)
    if count is None or count > MOST_TRIANGLES:
        return None
    use(start)
    corners, buffer = np.empty((count, 3, 3), dtype=np.float32), memoryview(bytearray(_PIECE * FACET.itemsize))
    for done in range(0, count, _PIECE):
        piece = buffer[: (count - done) * FACET.itemsize]
        if file.readinto(piece) != len(piece):
            return None
        use(piece)
        corners[done : done + _PIECE] = np.frombuffer(piece, dtype=FACET)["corners"]
        if not done:
            start += bytes(piece[: _START - HEADER])
    return None if file.read(1) else BinaryStl(start, corners.reshape(-1, 3))
