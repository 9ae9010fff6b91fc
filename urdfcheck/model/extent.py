"""How far down a robot reaches: the lowest point of its shapes at the neutral pose."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from urdfcheck.core import Unavailable
from urdfcheck.model.model import Model
from urdfcheck.model.parts import Shape

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def lowest_point(model: Model, frame: str) -> tuple[float, str] | None:
    """The lowest z (m) in the axes of link ``frame``, all joints at zero, and the link that reaches it.

    Collision shapes count where a link has them, what it draws otherwise. None when the place of a shape is not known:
    a broken tree, an unread mesh, or a COLLADA mesh whose declared unit consumers treat differently.
    """
    import numpy as np

    try:
        frames = model.frames
    except Unavailable:
        return None
    if frame not in frames:
        return None
    to_frame = np.linalg.inv(frames[frame])
    found: list[tuple[float, str]] = []
    for link in model.links:
        for shape in link.collisions or link.visuals:
            bottom = _bottom(model, shape, to_frame @ frames[link.name])
            if bottom is None:
                return None
            found.append((bottom, link.name))
    return min(found, default=None)


def _bottom(model: Model, shape: Shape, link_pose: NDArray[np.float64]) -> float | None:
    import numpy as np

    pose, size = shape.origin.matrix, shape.size
    if pose is None or size is None:
        return None
    placed = link_pose @ pose
    up, height = placed[2, :3], float(placed[2, 3])
    if shape.kind == "mesh":
        facts = model.meshes.facts_of(shape)
        if facts is None or facts.unit not in {None, 1.0}:
            return None
        return height + float((facts.vertices * np.array(size) @ up).min())
    if shape.kind == "box":
        return height - float(np.abs(up) @ np.array(size)) / 2
    if shape.kind == "sphere":
        return height - size[0]
    radius, length = size
    tilt = radius if shape.kind == "capsule" else radius * math.sqrt(max(0.0, 1.0 - float(up[2]) ** 2))
    return height - abs(float(up[2])) * length / 2 - tilt
