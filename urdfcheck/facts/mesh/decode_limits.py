"""The reasons why a mesh file gives no triangles, and the limits of its size."""

from __future__ import annotations

# A triangle of a closed binary STL took 140 bytes of memory on its way from the file to its topology and hull: this many fit
# into 3 GB. Loose ones took up to 730: the memory limit stops most of those. MuJoCo loads 200,000 from an STL file; the
# largest mesh file of a hundred published robots has 2.8 MB.
MOST_TRIANGLES = 8_000_000
# Without a limit, a scene of a few kilobytes can place its geometry a billion times.
MOST_PLACED = 100_000
# Levels of nodes of a scene; exporters nest them ten deep.
MOST_NESTED = 256
# The words of a flaw of COLLADA: accessors that count the numbers of their array.
NOT_VECTORS = "numbers instead of"


class MeshError(Exception):
    """A mesh file that gives no triangles. The message completes the sentence "the mesh …".

    ``reason_id``: empty | lfs-pointer | html | text | unsupported | truncated | wrong-size | external-buffer | missing-buffer |
    shifted | line-ends | random | no-count | malformed | incomplete | entities | encoding | archive | no-triangles | too-large |
    refused; no-facets: a whole STL file of none.
    ``assimp``: what Assimp does with the file, ``loads`` or ``refuses``; empty if it was not asked.
    """

    def __init__(self, reason_id: str, message: str, assimp: str = "") -> None:
        super().__init__(message)
        self.reason_id = reason_id
        self.message = message
        self.assimp = assimp

    def __reduce__(self) -> tuple[type[MeshError], tuple[str, str, str]]:
        return MeshError, (self.reason_id, self.message, self.assimp)


def ensure_size_limits(triangles: float, placements: float = 0) -> None:
    """Reject what would take too much memory, before any is allocated.

    :raises MeshError: for more than `MOST_TRIANGLES` triangles or `MOST_PLACED` placements.
    """
    if placements > MOST_PLACED:
        raise MeshError("too-large", f"places its geometry {placements:,.0f} times, more than {MOST_PLACED:,}")
    if triangles > MOST_TRIANGLES:
        raise MeshError("too-large", f"has {triangles:,.0f} triangles, more than {MOST_TRIANGLES:,}")
