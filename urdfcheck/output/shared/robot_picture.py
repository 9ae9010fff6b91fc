"""A picture of the robot, drawn from its scene without a browser: front, right and above, on a transparent background."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Indices

import math
import struct
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import replace

from urdfcheck.core.records import dataclass
from urdfcheck.core.scene import Scene, SceneShape

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


# Samples per pixel along each side; pixels and rows of triangles filled in one batch, and in all: a large robot has 5 million
# of them, and 50 million take two seconds.
_SUPERSAMPLING, _AT_ONCE, _MOST = 2, 2_000_000, 50_000_000
# More triangles than any robot has: a scene may draw one shape many times.
_MOST_TRIANGLES = 1_000_000
# No robot is larger (m), and the square of this is still finite.
_LARGEST = 1e60
_DEFAULT_COLOR = (0.67, 0.71, 0.76)
# Directions from the robot, which faces along x, to the eye and the lamp.
_EYE, _LAMP = (1.0, -0.9, 0.75), (0.35, -0.75, 1.0)
# Brightness of a face that the lamp does not reach, and of the outline where one link ends in front of another.
_SHADE, _LINE_BRIGHTNESS = 0.42, 0.45
_CORNERS = 32
# What only one of two versions has: before and after, and the opacity of a shade.
_BEFORE, _AFTER, _PALE = (217, 119, 6), (18, 140, 80), 70
# A link is hidden if less than this share of it is seen; those with fewer samples are dots. Samples of a dash.
_HIDDEN, _FEWEST, _DASH = 0.1, 60, 12
# Corners that are nearer (m) are in the same place, as for `urdfcheck diff` itself.
_SAME_PLACE = 2e-5


def render_scene(scene: Scene, width: int = 1200, height: int = 900) -> bytes:
    """Draw a robot with all joints at zero as a PNG of ``width`` x ``height`` pixels; empty if nothing of it can be drawn."""
    solid = _collect_triangles(scene)
    drawn = None if solid is None else _draw_triangles(solid, _View.around(solid.corners, width, height))
    return b"" if drawn is None else _encode_png(_downsample_pixels(drawn.colours))


def render_versions(
    before: Scene, after: Scene, root_pose: Sequence[float], width: int = 1200, height: int = 900
) -> bytes:
    """Draw two versions of a robot over each other, all joints at zero; empty if either cannot be drawn.

    ``root_pose``: of the first version's root in the frame of the second's, 4x4 row-major.

    The second version is solid. Of the first, what the second does not cover is a pale shade; the outlines that only one of
    them has are orange before and green after, and dashed where other parts of the same version hide all of a link.
    """
    import numpy as np

    old_solid, new_solid = map(_collect_triangles, (before, after))
    if old_solid is None or new_solid is None:
        return b""
    pose = np.array(root_pose).reshape(4, 4)
    placed = replace(old_solid, corners=old_solid.corners @ pose[:3, :3].T + pose[:3, 3])
    view = _View.around(np.concatenate((placed.corners, new_solid.corners)), width, height)
    old, new = _draw_triangles(placed, view), _draw_triangles(new_solid, view)
    if old is None or new is None:
        return b""
    picture = new.colours.copy()
    ghost = (new.colours[..., 3] == 0) & (old.colours[..., 3] > 0)
    picture[ghost] = (*_BEFORE, _PALE)
    for own, other, colour in ((old, new, _BEFORE), (new, old, _AFTER)):
        # A line that is one sample wide would be pale, and a sample beside a line of the other version is that line.
        picture[_widen(own.lines) & ~_widen(other.lines, 2)] = (*colour, 255)
    dashes = np.add.outer(np.arange(view.rows), np.arange(view.columns)) // _DASH % 2 == 0
    for solid, other_solid, drawn, colour in ((placed, new_solid, old, _BEFORE), (new_solid, placed, new, _AFTER)):
        hidden = _draw_hidden_links(solid, other_solid, drawn, view)
        if hidden is not None:
            picture[_widen(hidden.lines) & dashes] = (*colour, 255)
    return _encode_png(_downsample_pixels(np.ascontiguousarray(picture)))


def _draw_hidden_links(solid: _RobotTriangles, other: _RobotTriangles, drawn: _Samples, view: _View) -> _Samples | None:
    """Draw the links of one version that the other does not have in the same place, and that others hide; None without any."""
    import numpy as np

    count = int(solid.links.max()) + 1
    seen = np.bincount(drawn.links[drawn.links >= 0], minlength=count)
    (ax, ay), (bx, by), (cx, cy) = (view.project(solid.corners)[:, corner, :2].T for corner in range(3))
    areas = np.abs((bx - ax) * (cy - ay) - (cx - ax) * (by - ay)) / 2
    # A line of sight meets the front and the back of a body.
    whole = np.bincount(solid.links, areas, minlength=count) / 2
    hidden = (seen < _HIDDEN * whole) & (whole >= _FEWEST)
    places = _group_corners(other)
    for link, corners in _group_corners(solid).items():
        hidden[link] &= not any(
            len(corners) == len(there) and float(np.abs(corners - there).max()) <= _SAME_PLACE
            for there in places.values()
        )
    mask = hidden[solid.links]
    if not mask.any():
        return None
    return _draw_triangles(_RobotTriangles(solid.corners[mask], solid.colours[mask], solid.links[mask]), view)


def _group_corners(solid: _RobotTriangles) -> dict[int, Array]:
    """Return the corners of each link, by its number; the triangles of a link follow one another."""
    import numpy as np

    links, starts = np.unique(solid.links, return_index=True)
    return dict(zip(links.tolist(), np.split(solid.corners, starts[1:]), strict=True))


def _widen(lines: NDArray[np.bool_], samples: int = 1) -> NDArray[np.bool_]:
    """Return lines and what is beside them."""
    wide: NDArray[np.bool_] = lines
    for _ in range(samples):
        near: NDArray[np.bool_] = wide.copy()
        near[1:] |= wide[:-1]
        near[:-1] |= wide[1:]
        near[:, 1:] |= wide[:, :-1]
        near[:, :-1] |= wide[:, 1:]
        wide = near
    return wide


@dataclass(frozen=True, slots=True)
class _RobotTriangles:
    """The triangles of a robot."""

    corners: Array
    """(n, 3, 3) in the base frame, m."""
    colours: Array
    """(n, 3)"""
    links: Indices
    """Number of the link of each."""


@dataclass(frozen=True, slots=True)
class _Samples:
    """A robot as samples, `_SUPERSAMPLING` squared for each pixel."""

    colours: NDArray[np.uint8]
    """(rows, columns, 4)"""
    lines: NDArray[np.bool_]
    """Where a link ends in front of another one or the background."""
    links: NDArray[np.int32]
    """(rows, columns): number of the link, -1 for none."""


@dataclass(frozen=True, slots=True)
class _View:
    """Where the eye is, and how large the picture."""

    axes: Array
    """(3, 3): right, down and away from the eye, as columns."""
    middle: Array
    """(3,) along these axes, m."""
    scale: float
    """Samples per metre."""
    columns: int
    """Samples from left to right."""
    rows: int
    """Samples from top to bottom."""

    @classmethod
    def around(cls, corners: Array, width: int, height: int) -> _View:
        """Return the view in which triangles (n, 3, 3) fill a picture of so many pixels."""
        import numpy as np

        columns, rows = width * _SUPERSAMPLING, height * _SUPERSAMPLING
        towards = np.array(_EYE) / np.linalg.norm(_EYE)
        right = np.cross((0, 0, 1), towards)
        right /= np.linalg.norm(right)
        axes = np.column_stack((right, -np.cross(towards, right), -towards))
        in_view = (corners @ axes).reshape(-1, 3)
        low, high = in_view.min(axis=0), in_view.max(axis=0)
        scale = 0.94 * min(columns / max(high[0] - low[0], 1e-9), rows / max(high[1] - low[1], 1e-9))
        return cls(axes, (low + high) / 2, scale, columns, rows)

    def project(self, corners: Array) -> Array:
        """Project corners (n, 3, 3) to column, row and depth from the eye, in samples."""
        moved: Array = (corners @ self.axes - self.middle) * self.scale
        moved[..., :2] += (self.columns / 2, self.rows / 2)
        return moved


def _collect_triangles(scene: Scene) -> _RobotTriangles | None:
    """Return what is drawn of a robot; None if it has no shape, or too many."""
    import numpy as np

    parts, left = [], _MOST_TRIANGLES
    for part in _iter_triangles(scene):
        parts.append(part)
        left -= len(part[0])
        if left < 0:
            return None
    if not parts:
        return None
    corners = np.concatenate([triangles for triangles, _, _ in parts])
    sizes = [len(triangles) for triangles, _, _ in parts]
    if not len(corners) or not (np.abs(corners) < _LARGEST).all():
        return None
    return _RobotTriangles(
        corners,
        np.repeat([colour for _, colour, _ in parts], sizes, axis=0),
        np.repeat([link for _, _, link in parts], sizes),
    )


def _draw_triangles(solid: _RobotTriangles, view: _View) -> _Samples | None:
    """Draw a robot; None if that would take too long."""
    nearest = _rasterize_triangles(view.project(solid.corners), view.columns, view.rows)
    return None if nearest is None else _colour_samples(solid, nearest)


def _colour_samples(solid: _RobotTriangles, nearest: Indices) -> _Samples:
    import numpy as np

    count = len(solid.corners)
    # Colours by the number of the triangle, then the same darker for outlines, and transparent for number -1 at the end.
    lit = np.column_stack((_shade_triangles(solid.corners, solid.colours) * 255, np.full(count, 255)))
    table = np.concatenate(
        (lit, lit * (_LINE_BRIGHTNESS, _LINE_BRIGHTNESS, _LINE_BRIGHTNESS, 1), np.zeros((1, 4)))
    ).astype(np.uint8)
    link = np.append(solid.links, -1).astype(np.int32)[nearest]
    ends = np.zeros(link.shape, dtype=bool)  # where a link ends in front of another one or the background
    ends[1:] = link[1:] != link[:-1]
    ends[:, 1:] |= link[:, 1:] != link[:, :-1]
    nearest[ends & (nearest >= 0)] += count
    return _Samples(table[nearest], ends, link)


def _downsample_pixels(fine: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Average the samples of each pixel: the colour of those that hit the robot, and the opacity of all."""
    import numpy as np

    samples = np.stack(
        [fine[i::_SUPERSAMPLING, k::_SUPERSAMPLING] for i in range(_SUPERSAMPLING) for k in range(_SUPERSAMPLING)]
    )
    hits = (samples[..., 3] > 0).sum(axis=0, dtype=np.uint16)
    total = samples.sum(axis=0, dtype=np.uint16)
    total[..., :3] //= np.maximum(hits, 1)[..., None]
    total[..., 3] //= _SUPERSAMPLING**2
    pixels: NDArray[np.uint8] = total.astype(np.uint8)
    return pixels


def _iter_triangles(scene: Scene) -> Iterator[tuple[Array, tuple[float, ...], int]]:
    """Yield corners (n, 3, 3) in the base frame (m), colour and number of the link for each shape that is drawn."""
    import numpy as np

    roles = {shape.role for link in scene.links for shape in link.shapes}
    for number, link in enumerate(scene.links):
        if link.world is None:
            continue
        world = np.array(link.world).reshape(4, 4)
        for shape in link.shapes:
            # Collision shapes are drawn only if the robot has no visual shape.
            if len(shape.pose) != 16 or not shape.size or (shape.role != "visual" and "visual" in roles):
                continue
            pose = world @ np.array(shape.pose).reshape(4, 4)
            for corners, colour in _iter_shape_triangles(scene, shape):
                yield corners @ pose[:3, :3].T + pose[:3, 3], (shape.color or colour or _DEFAULT_COLOR)[:3], number


def _iter_shape_triangles(scene: Scene, shape: SceneShape) -> Iterator[tuple[Array, tuple[float, ...] | None]]:
    import numpy as np

    from urdfcheck.facts.mesh.codec import PackedMesh, unpack_mesh

    if shape.file is not None:
        for part in scene.meshes[shape.file].drawings:
            low, high = np.array(part.low), np.array(part.high)
            packed = PackedMesh(
                data=part.data,
                n_vertices=part.vertices,
                n_faces=part.faces,
                n_hole_edges=part.holes,
                low=low,
                high=high,
            )
            points, faces, _ = unpack_mesh(packed)
            yield (points * shape.size)[faces], part.color
    elif shape.kind == "box":
        half_diagonal = math.sqrt(0.5)
        outline = [(0.0, 0.5), (half_diagonal, 0.5), (half_diagonal, -0.5), (0.0, -0.5)]
        yield _revolve_outline(4, outline) * shape.size, None
    elif shape.kind == "cylinder":
        radius, length = shape.size
        outline = [(0, length / 2), (radius, length / 2), (radius, -length / 2), (0, -length / 2)]
        yield _revolve_outline(_CORNERS, outline), None
    elif shape.kind in ("sphere", "capsule"):
        radius, length = shape.size[0], shape.size[1] if shape.kind == "capsule" else 0.0
        turns = [math.pi * k / 16 for k in range(17)]
        lifts = [length / 2 if turn <= math.pi / 2 else -length / 2 for turn in turns]
        outline = [(radius * math.sin(t), radius * math.cos(t) + z) for t, z in zip(turns, lifts, strict=True)]
        yield _revolve_outline(_CORNERS, outline), None


def _revolve_outline(corners: int, outline: list[tuple[float, float]]) -> Array:
    """Return the triangles (n, 3, 3) of an outline of (radius, z), turned about z in ``corners`` steps."""
    import numpy as np

    angles = (np.arange(corners) + 0.5) * 2 * np.pi / corners
    rings = np.array([[(r * np.cos(a), r * np.sin(a), z) for a in angles] for r, z in outline])
    a, b = rings[:-1], rings[1:]
    c, d = np.roll(a, -1, axis=1), np.roll(b, -1, axis=1)
    return np.concatenate((np.stack((a, b, c), axis=2), np.stack((b, d, c), axis=2))).reshape(-1, 3, 3)


def _shade_triangles(corners: Array, colours: Array) -> Array:
    """Compute the colour of each triangle under the lamp, as if it faced the eye: a mesh may be inside out."""
    import numpy as np

    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-30)[:, None]
    normal *= np.where(normal @ _EYE < 0, -1, 1)[:, None]
    light = np.maximum(normal @ (np.array(_LAMP) / np.linalg.norm(_LAMP)), 0)
    lit: Array = (colours * (_SHADE + (1 - _SHADE) * light)[:, None]).clip(0, 1)
    return lit


def _rasterize_triangles(view: Array, columns: int, rows: int) -> Indices | None:
    """Find the triangle nearest to the eye at each pixel (rows, columns), -1 for none; None if it would take too long.

    Each triangle is cut into the rows of pixels that it covers, and each row into the pixels whose middle lies inside.
    """
    import numpy as np

    a, b, c = np.moveaxis(view, 1, 0)
    normal = np.cross(b - a, c - a)
    flat = np.abs(normal[:, 2]) < 1e-9
    # Depth is linear over a triangle.
    slope = -normal[:, :2] / np.where(flat, 1, normal[:, 2])[:, None]
    top, end = (np.ceil(f(view[..., 1], axis=1) - 0.5).astype(np.int64).clip(0, rows) for f in (np.min, np.max))
    heights = np.where(flat, 0, end - top)
    depth_low, depth_high = view[..., 2].min(), view[..., 2].max()
    unit = (2**30 - 1) / max(depth_high - depth_low, 1e-9)
    best = np.full(rows * columns, np.iinfo(np.int64).max)
    covered = np.cumsum(np.where(flat, 0, np.abs(normal[:, 2]) / 2 + heights))
    if covered[-1] > _MOST:
        return None
    groups = np.searchsorted(covered, np.arange(0, covered[-1] + _AT_ONCE, _AT_ONCE))
    for first, last in zip(groups, [*groups[1:], len(view)], strict=True):
        number = np.repeat(np.arange(first, last), heights[first:last])
        row = _number_within_groups(heights[first:last]) + top[number]
        ends = _intersect_scanlines(view[number], row + 0.5)
        left, right = (np.ceil(e - 0.5).astype(np.int64).clip(0, columns) for e in ends)
        widths = np.maximum(right - left, 0)
        column = _number_within_groups(widths) + np.repeat(left, widths)
        row, number = np.repeat(row, widths), np.repeat(number, widths)
        depth = (
            a[number, 2]
            + slope[number, 0] * (column + 0.5 - a[number, 0])
            + slope[number, 1] * (row + 0.5 - a[number, 1])
        )
        key = ((depth - depth_low) * unit).clip(0, 2**30).astype(np.int64) << 32 | number
        np.minimum.at(best, row * columns + column, key)
    none = best == np.iinfo(np.int64).max
    return np.where(none, -1, best & 0xFFFFFFFF).reshape(rows, columns)


def _number_within_groups(counts: Indices) -> Indices:
    """Return 0, 1, … up to each count, one group after the other."""
    import numpy as np

    return np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)


def _intersect_scanlines(corners: Array, y: Array) -> tuple[Array, Array]:
    """Return the x at which the lines at ``y`` enter and leave the triangles; 0 and 0 if they miss."""
    import numpy as np

    left, right = np.full(len(y), np.inf), np.full(len(y), -np.inf)
    for i in range(3):
        (x0, y0), (x1, y1) = corners[:, i, :2].T, corners[:, (i + 1) % 3, :2].T
        crosses = (y0 > y) != (y1 > y)
        x = x0 + (y - y0) * (x1 - x0) / np.where(crosses, y1 - y0, 1)
        left, right = np.where(crosses, np.minimum(left, x), left), np.where(crosses, np.maximum(right, x), right)
    return np.where(left > right, 0, left), np.where(left > right, 0, right)


def _encode_png(pixels: NDArray[np.uint8]) -> bytes:
    """Encode a PNG (ISO/IEC 15948) of red, green, blue and opacity, each row as the differences to the row above."""
    import numpy as np

    height, width, _ = pixels.shape
    lines = np.full((height, 1 + width * 4), 2, dtype=np.uint8)
    lines[:, 1:] = np.diff(pixels.reshape(height, -1), axis=0, prepend=np.zeros((1, width * 4), dtype=np.uint8))

    def make_chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + make_chunk(b"IHDR", head)
        + make_chunk(b"IDAT", zlib.compress(lines.tobytes(), 6))
        + make_chunk(b"IEND", b"")
    )
