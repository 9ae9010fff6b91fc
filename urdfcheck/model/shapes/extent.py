"""How far shapes reach: the lowest point of a robot with all joints at zero, and the size of a link."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

import math
from typing import TYPE_CHECKING

from urdfcheck.core import FactUnavailableError
from urdfcheck.model.parts import Link, Shape
from urdfcheck.model.robot import Model


def find_lowest_point(model: Model, frame: str) -> tuple[float, str] | None:
    """Find the lowest z (m) in the axes of link ``frame``, all joints at zero, and the link that reaches it.

    Collision shapes count where a link has them, what it draws otherwise. None when the placement of a shape is not known:
    a broken tree, an unread mesh, or a COLLADA mesh whose declared unit programs treat differently.
    """
    import numpy as np

    try:
        frames = model.frames
    except FactUnavailableError:
        return None
    if frame not in frames:
        return None
    to_frame = np.linalg.inv(frames[frame])
    bottoms: list[tuple[float, str]] = []
    for link in model.links:
        for shape in link.collisions or link.visuals:
            bottom = _compute_shape_bottom(model, shape, to_frame @ frames[link.name])
            if bottom is None:
                return None
            bottoms.append((bottom, link.name))
    return min(bottoms, default=None)


def measure_link_size(model: Model, link: Link) -> tuple[float, float, float] | None:
    """Measure what a link draws along its own x, y and z (m); None when it draws nothing or a shape is not known."""
    import numpy as np

    sizes = []
    for axis in np.eye(3):
        toward = np.eye(4)
        toward[2, :3] = axis
        low = [_compute_shape_bottom(model, shape, toward) for shape in link.visuals]
        high = [_compute_shape_bottom(model, shape, toward * [[1], [1], [-1], [1]]) for shape in link.visuals]
        known = [(a, b) for a, b in zip(low, high, strict=True) if a is not None and b is not None]
        if not known or len(known) != len(low):
            return None
        sizes.append(-min(b for _, b in known) - min(a for a, _ in known))
    return sizes[0], sizes[1], sizes[2]


def _compute_shape_bottom(model: Model, shape: Shape, link_pose: Array) -> float | None:
    """Compute the lowest z (m) of a shape in the frame in which its link is placed; None when it is not known."""
    import numpy as np

    from urdfcheck.model.shapes.mesh_sizes import has_wrong_size

    pose, size = shape.origin.matrix, shape.size
    if pose is None or size is None:
        return None
    placed = link_pose @ pose
    up, height = placed[2, :3], float(placed[2, 3])
    if shape.kind == "mesh":
        facts = model.meshes.get_facts(shape)
        if facts is None or facts.unit not in {None, 1.0} or has_wrong_size(model, shape):
            return None
        return height + float((facts.vertices * np.array(size) @ up).min())
    if shape.kind == "box":
        return height - float(np.abs(up) @ np.array(size)) / 2
    if shape.kind == "sphere":
        return height - size[0]
    radius, length = size
    tilt = radius if shape.kind == "capsule" else radius * math.sqrt(max(0.0, 1.0 - float(up[2]) ** 2))
    return height - abs(float(up[2])) * length / 2 - tilt
