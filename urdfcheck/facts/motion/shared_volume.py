"""Whether two closed meshes share volume, or only touch."""

from __future__ import annotations

import numpy as np

from urdfcheck.facts.arrays import Array, Indices

# Lines across the common box, along each axis, in one direction. They are off the middle of their cells, because the edges of
# symmetrical parts are on it.
_LINES = 32
_OFF_MIDDLE = (0.4142, 0.5772)


def do_share_volume(one: Array, other: Array, least: float) -> bool:
    """Whether lines through the box that two closed surfaces (F, 3, 3) have in common are inside both on more than ``least`` (m).

    The ends of each line's pieces are exact. Between the lines, volume may be missed that is narrow in two directions; the
    surfaces around it pierce each other.
    """
    boxes = [(triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))) for triangles in (one, other)]
    low, high = np.maximum(boxes[0][0], boxes[1][0]), np.minimum(boxes[0][1], boxes[1][1])
    if (high - low <= least).any():
        return False
    for along in range(3):
        across = [(along + 1) % 3, (along + 2) % 3]
        rows, columns = (
            low[axis] + (np.arange(_LINES) + off) / _LINES * (high - low)[axis]
            for axis, off in zip(across, _OFF_MIDDLE, strict=True)
        )
        crossings = [_list_crossings(triangles[:, :, [*across, along]], rows, columns) for triangles in (one, other)]
        if _measure_common_piece(*crossings) > least:
            return True
    return False


def _list_crossings(triangles: Array, rows: Array, columns: Array) -> tuple[Indices, Array, Indices]:
    """List where lines along the third axis cross triangles (F, 3, 3): line, height, and 1 where it enters or -1 where it
    leaves."""
    flat = triangles[:, :, :2]
    first, last = (
        np.stack([np.searchsorted(lines, end[:, axis]) for axis, lines in enumerate((rows, columns))])
        for end in (flat.min(axis=1), flat.max(axis=1))
    )
    height, width = last - first
    counts = height * width
    triangle = np.repeat(np.arange(len(triangles)), counts)
    index = np.arange(len(triangle)) - np.repeat(np.cumsum(counts) - counts, counts)
    row, column = first[0][triangle] + index // width[triangle], first[1][triangle] + index % width[triangle]
    ends = flat[triangle] - np.stack((rows[row], columns[column]), axis=1)[:, None]
    # Twice the areas of the triangles between the line and the side opposite each corner.
    parts = np.stack([_cross(ends[:, (i + 1) % 3], ends[:, (i + 2) % 3]) for i in range(3)], axis=1)
    hit = ((parts > 0).all(axis=1)) | ((parts < 0).all(axis=1))
    parts, triangle = parts[hit], triangle[hit]
    heights = np.einsum("ni,ni->n", parts, triangles[triangle, :, 2]) / parts.sum(axis=1)
    return (row * len(columns) + column)[hit], heights, np.where(parts[:, 0] > 0, -1, 1)


def _cross(one: Array, other: Array) -> Array:
    product: Array = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    return product


def _measure_common_piece(one: tuple[Indices, Array, Indices], other: tuple[Indices, Array, Indices]) -> float:
    """Measure the longest piece (m) between two crossings that is inside both surfaces."""
    line, height = (np.concatenate((a, b)) for a, b in zip(one[:2], other[:2], strict=True))
    turns = np.zeros((len(line), 2), dtype=np.int64)
    turns[: len(one[2]), 0], turns[len(one[2]) :, 1] = one[2], other[2]
    order = np.lexsort((height, line))
    line, height = line[order], height[order]
    # A line ends as far outside as it began.
    inside = (np.cumsum(turns[order], axis=0) != 0).all(axis=1)[:-1] & (line[1:] == line[:-1])
    return float(np.diff(height)[inside].max(initial=0.0))
