"""What is wrong with a binary STL file whose size does not fit its number of triangles, as far as its bytes show."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.mesh.decode_limits import MeshError
from urdfcheck.facts.mesh.formats.binary_stl import FACET, HEADER

if TYPE_CHECKING:
    from numpy.typing import NDArray

# Facets at the end of a file that are looked at, and the share of them that are plausible where they are read in their places.
# Read a byte beside their places, few are.
_LOOKED_AT, _MOST = 50, 0.9
# Lengths of normals are rounded; coordinates of other exponents are no lengths of a part.
_UNIT_SLACK, _LEAST, _LARGEST = 0.05, 1e-20, 1e9
# Bits of information in a byte: 8 in what is encrypted or compressed, 5 to 7.3 in the meshes of robots.
_RANDOM_BITS, _LEAST_MEASURED = 7.9, 4096


def make_size_error(data: bytes, declared: int) -> MeshError:
    """Return the error about a file that has not the bytes of the triangles that it declares."""
    expected, present = HEADER + declared * FACET.itemsize, (len(data) - HEADER) // FACET.itemsize
    lost, claims = expected - len(data), f"declares {declared:,} triangles ({expected:,} bytes)"
    plausible = _find_plausible_facets(data, HEADER)
    is_whole = _is_mostly_true(plausible[-_LOOKED_AT:])
    place = _find_gap(data, lost, plausible) if 0 < lost < FACET.itemsize else None
    if place is not None:
        reason = "shifted" if b"\r\n" in data[HEADER:] else "line-ends"
        gap = "1 byte is" if lost == 1 else f"{lost} bytes are"
        return MeshError(reason, f"{claims} but has {len(data):,}: {gap} missing inside, at about triangle {place:,}")
    if lost > 0 and is_whole:
        return MeshError("truncated", f"is truncated: it {claims} but has {present:,} ({len(data):,} bytes)")
    if not is_whole and _count_bits(data[HEADER + (len(data) - HEADER) // 2 :]) >= _RANDOM_BITS:
        return MeshError("random", f"{claims} but has {len(data):,} bytes, which look encrypted or compressed")
    if lost > 0:
        return MeshError(
            "wrong-size", f"{claims} but has {len(data):,} bytes, of which the last do not look like triangles"
        )
    more = f"{claims} but has {-lost:,} more bytes, room for {present:,} triangles"
    return MeshError("no-count" if declared == 0 and is_whole else "wrong-size", more)


def _find_gap(data: bytes, lost: int, plausible: NDArray[np.bool_]) -> int | None:
    """Return the number of the triangle in which bytes are missing: all before it are in their places, all behind too early."""
    early = _find_plausible_facets(data, HEADER - lost)
    scores = np.concatenate([[0], np.cumsum(plausible)])
    behind = np.concatenate([np.cumsum(early[::-1])[::-1], [0]])[1 : len(scores) + 1]
    at = int(np.argmax(scores[: len(behind)] + behind))
    is_gap = scores[at] + behind[at] > plausible.sum() and behind[at] > 0
    return at + 1 if is_gap and _is_mostly_true(plausible[:at]) and _is_mostly_true(early[at + 1 :]) else None


def _find_plausible_facets(data: bytes, start: int) -> NDArray[np.bool_]:
    """Return for each whole facet from a place whether its numbers are those of a facet."""
    facets = np.frombuffer(data, FACET, count=(len(data) - start) // FACET.itemsize, offset=start)
    with np.errstate(all="ignore"):  # bytes beside their places are any numbers
        lengths = np.linalg.norm(facets["normal"].astype(float), axis=1)
        sizes = np.abs(facets["corners"].astype(float)).reshape(-1, 9)
        is_normal = (np.abs(lengths - 1.0) < _UNIT_SLACK) | (lengths == 0.0)
        is_length = (sizes == 0.0) | ((sizes > _LEAST) & (sizes < _LARGEST))
    found: NDArray[np.bool_] = is_normal & is_length.all(axis=1)
    return found


def _is_mostly_true(plausible: NDArray[np.bool_]) -> bool:
    return not len(plausible) or float(plausible.mean()) >= _MOST


def _count_bits(data: bytes) -> float:
    """Count the bits of information in a byte (Shannon), 0 for few bytes."""
    if len(data) < _LEAST_MEASURED:
        return 0.0
    shares = np.bincount(np.frombuffer(data, np.uint8), minlength=256) / len(data)
    shares = shares[shares > 0]
    return float(-(shares * np.log2(shares)).sum())
