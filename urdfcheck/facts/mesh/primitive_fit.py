"""The smallest box, cylinder, sphere or capsule around points."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Mat4

# A box along the axes of the mesh is preferred to one that is rotated and not smaller by more than this share.
_STRAIGHT_SHARE = 0.03
# A coordinate of a centre below this share of the size is what a mesh leaves of a zero.
_NOISE = 1e-4


@dataclass(frozen=True, slots=True, eq=False)
class FittedPrimitive:
    """A primitive that encloses points."""

    kind: str
    """box | cylinder | sphere | capsule."""
    size: tuple[float, ...]
    """As `urdfcheck.model.parts.Shape.size`: box x y z; cylinder, capsule radius length; sphere radius."""
    pose: Mat4
    """(4, 4) from the primitive's frame to that of the points."""
    volume: float


def fit_primitives(points: Array) -> tuple[FittedPrimitive, ...]:
    """Fit a primitive of each kind to ``points`` (N, 3), the smallest first. Each encloses all points, to rounding.

    The axes that are tried for cylinder and capsule are those of the frame and of the smallest box.

    :raises ValueError: when the points span no volume.
    :raises ImportError: when scipy is not installed.
    """
    points = np.asarray(points, dtype=float)
    low, high = points.min(axis=0), points.max(axis=0)
    if len(points) < 4 or not np.isfinite(points).all() or not (high - low > 0.0).all():
        raise ValueError("points in a plane have no volume")
    box = _fit_box(points)
    found = [box, _fit_sphere(points)]
    for make in (_fit_cylinder, _fit_capsule):
        found.append(min((make(points, axis) for axis in _iter_axes(box)), key=lambda fit: fit.volume))
    return tuple(sorted(found, key=lambda fit: fit.volume))


def _iter_axes(box: FittedPrimitive) -> Iterator[Array]:
    yield from np.eye(3)
    turn = box.pose[:3, :3]
    if not np.allclose(turn, np.eye(3)):
        yield from turn.T


def _fit_box(points: Array) -> FittedPrimitive:
    import trimesh

    low, high = points.min(axis=0), points.max(axis=0)
    size, pose = high - low, np.eye(4)
    pose[:3, 3] = (low + high) / 2
    try:
        to_box, turned = trimesh.bounds.oriented_bounds(points, ordered=False)
    except ImportError:
        raise
    except Exception:  # qhull, where the points are nearly flat
        to_box, turned = None, size
    if to_box is not None and turned.prod() < (1.0 - _STRAIGHT_SHARE) * size.prod():
        size, pose = np.asarray(turned), np.linalg.inv(to_box)
    return _make_fit("box", tuple(size.tolist()), pose, float(np.prod(size)))


def _fit_sphere(points: Array) -> FittedPrimitive:
    centre, radius = _enclose(points)
    pose = np.eye(4)
    pose[:3, 3] = centre
    return _make_fit("sphere", (radius,), pose, 4.0 / 3.0 * math.pi * radius**3)


def _fit_cylinder(points: Array, axis: Array) -> FittedPrimitive:
    local, turn = _look_along(points, axis)
    centre, radius = _enclose(local[:, :2])
    low, high = local[:, 2].min(), local[:, 2].max()
    pose = _place(turn, (*centre, (low + high) / 2))
    return _make_fit("cylinder", (radius, float(high - low)), pose, math.pi * radius**2 * float(high - low))


def _fit_capsule(points: Array, axis: Array) -> FittedPrimitive:
    local, turn = _look_along(points, axis)
    centre, radius = _enclose(local[:, :2])
    across = np.square(local[:, :2] - centre).sum(axis=1)
    cap = np.sqrt(np.maximum(0.0, radius**2 - across))
    top, bottom = float((local[:, 2] - cap).max()), float((local[:, 2] + cap).min())
    length = max(0.0, top - bottom)
    pose = _place(turn, (*centre, (top + bottom) / 2))
    if top < bottom:  # half spheres that overlap: the points need a larger one
        reach = float(np.linalg.norm(local - (*centre, (top + bottom) / 2), axis=1).max())
        radius = max(radius, reach)
    return _make_fit("capsule", (radius, length), pose, math.pi * radius**2 * (length + 4.0 / 3.0 * radius))


def _enclose(points: Array) -> tuple[Array, float]:
    """Return centre and radius of the smallest circle or sphere around points, or of a slightly larger one."""
    import trimesh

    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    radius = float(np.linalg.norm(points - middle, axis=1).max())
    try:
        centre = np.asarray(trimesh.nsphere.minimum_nsphere(points)[0], dtype=float)
    except ImportError:
        raise
    except Exception:  # qhull, where the points are nearly flat
        return middle, radius
    smaller = float(np.linalg.norm(points - centre, axis=1).max())
    # A centre that is only rounding better stays that of the box.
    return (centre, smaller) if smaller < (1.0 - 1e-4) * radius else (middle, radius)


def _look_along(points: Array, axis: Array) -> tuple[Array, Array]:
    """Return the points in a frame with ``axis`` as z, and the rotation (3, 3) of that frame."""
    # About y and x these are single rotations, which a person reads at once.
    start = np.array((1.0, 0.0, 0.0) if abs(axis[0]) < 0.9 else (0.0, 0.0, -1.0))
    x = start - start @ axis * axis
    x = x / np.linalg.norm(x)
    turn = np.column_stack((x, np.cross(axis, x), axis))
    return points @ turn, turn


def _place(turn: Array, centre: tuple[float, ...]) -> Mat4:
    pose = np.eye(4)
    pose[:3, :3] = turn
    pose[:3, 3] = turn @ np.array(centre)
    return pose


def _make_fit(kind: str, size: tuple[float, ...], pose: Mat4, volume: float) -> FittedPrimitive:
    """Make a fit; what a mesh leaves of zeros in its centre is zero."""
    rounded = pose.copy()
    noise = _NOISE * max(size)
    rounded[:3, 3] = np.where(np.abs(pose[:3, 3]) > noise, pose[:3, 3], 0.0)
    return FittedPrimitive(kind, size, rounded, volume)
