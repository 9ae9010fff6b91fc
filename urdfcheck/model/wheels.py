"""The wheels that carry a robot."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.model.model import Model
from urdfcheck.model.parts import Joint, Link, Shape

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

# A wheel's axis is level to within its camber, and parallel axes are parallel to within its toe: 6°.
LEVEL = 0.1
NAMED = re.compile(r"wheel|tyre|tire", re.IGNORECASE)
# Wheels that turn freely or in another sense, or do not stand on the ground.
OTHER = re.compile(r"caster|castor|roller|steer|swivel|fly_?wheel|reaction|momentum|spare", re.IGNORECASE)


@dataclass(frozen=True, slots=True, eq=False)
class Wheel:
    """``centre`` (3,) and unit ``axis`` (3,) in root coordinates; ``radius`` in m, the farthest drawn point from the
    axis; ``bottom``: height of the lowest drawn point in root coordinates."""

    joint: Joint
    centre: Array
    axis: Array
    radius: float
    bottom: float


def wheels(model: Model) -> tuple[Wheel, ...]:
    """The wheels on which the robot stands, when all joints are at zero and z is up.

    A wheel is the child of a continuous joint with a level axis, that no joint steers; it is drawn round about that
    axis, and is called one or is as low as anything of the robot. Wheels that do not reach down to the others' ground
    are left out.

    :raises Unavailable: when the tree is broken or an origin is malformed.
    """
    found = [wheel for joint in model.joints if (wheel := _wheel(model, joint)) is not None]
    if not found:
        return ()
    named = [w for w in found if NAMED.search(w.joint.name) or NAMED.search(w.joint.child)]
    if len(named) < len(found):
        ground = min(_lowest(model, link) for link in model.links)
        named = [w for w in found if w in named or w.bottom - ground < 0.1 * w.radius]
    ground = min((w.bottom for w in named), default=0.0)
    return tuple(w for w in named if w.bottom - ground < 0.2 * w.radius)


def _wheel(model: Model, joint: Joint) -> Wheel | None:
    axis = model.axes.get(joint.name)
    words = f"{joint.name} {joint.child}"
    if joint.type != "continuous" or axis is None or abs(axis[2]) > LEVEL or OTHER.search(words):
        return None
    if any(_steers(model, other, axis) for other in model.tree.path(joint.child) if other is not joint):
        return None
    frame = model.frames[joint.child]
    points = _points(model, model.link_by_name[joint.child])
    if not len(points):
        return None
    local = points @ frame[:3, :3].T
    along = local @ axis
    radial = np.linalg.norm(local - along[:, None] * axis, axis=1)
    radius = float(radial.max())
    if not _round(local, axis, radius) or np.ptp(along) > 4 * radius:
        return None
    return Wheel(joint, frame[:3, 3], axis, radius, float(local[:, 2].min() + frame[2, 3]))


def _steers(model: Model, joint: Joint, axis: Array) -> bool:
    """Whether a joint before the wheel turns the wheel's axis."""
    if not joint.moves or joint.type == "prismatic":
        return False
    own = model.axes.get(joint.name)
    return own is None or abs(float(own @ axis)) < 1 - LEVEL


def _round(local: Array, axis: Array, radius: float) -> bool:
    """Whether points reach out equally far from the axis in all directions: its support in 16 directions."""
    across = np.cross(axis, (0.0, 0.0, 1.0))
    across /= np.linalg.norm(across)
    up = np.cross(across, axis)
    angles = np.arange(16) * math.tau / 16
    directions = np.cos(angles)[:, None] * across + np.sin(angles)[:, None] * up
    reach = (local @ directions.T).max(axis=0)
    return bool(reach.min() > 0.95 * radius)


def _lowest(model: Model, link: Link) -> float:
    frame = model.frames[link.name]
    points = _points(model, link)
    return float((points @ frame[2, :3]).min() + frame[2, 3]) if len(points) else math.inf


def _points(model: Model, link: Link) -> Array:
    """Points (n, 3) on what a link draws and collides with, in its frame; none for a shape that is not known."""
    parts = [points for shape in (*link.visuals, *link.collisions) for points in _shape_points(model, shape)]
    return np.concatenate(parts) if parts else np.zeros((0, 3))


def _shape_points(model: Model, shape: Shape) -> Iterator[Array]:
    size, pose = shape.size, shape.origin.matrix
    if size is None or pose is None or shape.kind is None:
        return
    if shape.kind == "mesh":
        facts = model.meshes.facts_of(shape)
        if facts is None:
            return
        points = facts.vertices * np.array(size)
    elif shape.kind == "box":
        points = np.array(list(product((-0.5, 0.5), repeat=3))) * np.array(size)
    elif shape.kind == "sphere":
        points = _sphere() * size[0]
    else:
        reach = np.array((0, 0, size[1] / 2))
        points = np.concatenate((_circle() * size[0] + reach, _circle() * size[0] - reach))
    yield points @ pose[:3, :3].T + pose[:3, 3]


@cache
def _circle() -> Array:
    """64 points of the unit circle about z."""
    angles = np.arange(64) * math.tau / 64
    return np.column_stack((np.cos(angles), np.sin(angles), np.zeros(64)))


@cache
def _sphere() -> Array:
    """Points of the unit sphere: its equator, and 32 meridians."""
    circle = _circle()
    angles = np.arange(32) * math.tau / 64
    meridians = [
        np.column_stack((circle[:, 0] * math.cos(a), circle[:, 0] * math.sin(a), circle[:, 1])) for a in angles
    ]
    return np.concatenate((circle, *meridians))
