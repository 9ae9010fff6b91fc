"""Corners of shapes: points whose convex hull is that of what a link draws or collides with."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

from collections.abc import Iterable
from functools import cache
from itertools import product

import numpy as np

from urdfcheck.model.parts import Link, Shape, is_dummy_shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.bounds import get_up_axis_rotation
from urdfcheck.model.shapes.mesh_sizes import get_mesh_scale

# Corners on the circle that stands for a round shape.
ROUND_CORNERS = 64
_CUBE = np.array(list(product((-0.5, 0.5), repeat=3)))


def collect_rigid_corners(model: Model, link: Link, *, apply_unit: bool = True) -> Array | None:
    """Collect corners (K, 3) whose convex hull holds a link and the links fixed to it, in the link's frame.

    The hull holds all that they draw or collide with. None when there is nothing, or a shape is not known. ``apply_unit``:
    whether COLLADA's ``<unit>`` is followed.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    points = collect_body_corners(model, model.pieces.list_body_links(link.name), apply_unit=apply_unit)
    if points is None:
        return None
    to_link = np.linalg.inv(model.piece_frames[link.name])
    in_link: Array = points @ to_link[:3, :3].T + to_link[:3, 3]
    return in_link


def collect_body_corners(
    model: Model, links: Iterable[str], *, apply_unit: bool = True, apply_up_axis: bool = False
) -> Array | None:
    """Collect the corners of the links of one body in the root link's frame, like `collect_rigid_corners`."""
    parts = []
    for name in links:
        link, frame = model.link_by_name[name], model.piece_frames[name]
        for shape in (*link.visuals, *link.collisions):
            if is_dummy_shape(shape):
                continue
            points = compute_shape_corners(model, shape, apply_unit=apply_unit, apply_up_axis=apply_up_axis)
            if points is None:
                return None
            parts.append(points @ frame[:3, :3].T + frame[:3, 3])
    return np.concatenate(parts) if parts else None


def compute_shape_corners(
    model: Model, shape: Shape, *, apply_unit: bool = True, apply_up_axis: bool = False, circumscribed: bool = True
) -> Array | None:
    """Compute corners (K, 3), in the link's frame, whose convex hull is that of a shape, or holds a round one closely.

    Without ``circumscribed`` the corners of a round shape lie on it. None when the shape is not known.
    """
    size, pose = shape.size, shape.origin.matrix
    if size is None or pose is None or shape.kind is None:
        return None
    if shape.kind == "mesh":
        facts, scale = model.meshes.get_facts(shape), get_mesh_scale(model, shape, apply_unit)
        if facts is None or scale is None:
            return None
        local = facts.hull.vertices @ get_up_axis_rotation(facts, apply_up_axis).T * scale
    elif min(size) <= 0:
        return None
    elif shape.kind == "box":
        local = _CUBE * size
    elif shape.kind == "sphere":
        local = _make_sphere(circumscribed) * size[0]
    else:
        radius, length = size
        end = (_make_sphere(circumscribed) if shape.kind == "capsule" else _make_circle(circumscribed)) * radius
        half = np.array((0, 0, length / 2))
        local = np.concatenate((end - half, end + half))
    points: Array = local @ pose[:3, :3].T + pose[:3, 3]
    return points


def has_known_shapes(model: Model, link: Link) -> bool:
    """Whether the size of every shape of a link is known, also where it has none: a mesh that is missing, or that was not read,
    may reach anywhere."""
    return all(compute_shape_corners(model, shape) is not None for shape in (*link.visuals, *link.collisions))


@cache
def _make_circle(circumscribed: bool) -> Array:
    """Make the unit circle about z (k, 3): a polygon with its corners on it, or one around it, which need not be as fine."""
    corners = 32 if circumscribed else ROUND_CORNERS
    angles = np.arange(corners) * 2 * np.pi / corners
    radius = 1 / np.cos(np.pi / corners) if circumscribed else 1.0
    return np.column_stack((np.cos(angles), np.sin(angles), np.zeros(corners))) * radius


@cache
def _make_sphere(circumscribed: bool) -> Array:
    """Make the unit sphere (k, 3) from its parallels, poles and equator among them."""
    circle = _make_circle(circumscribed)
    radius = float(np.linalg.norm(circle[0]))
    parallels = np.linspace(-np.pi / 2, np.pi / 2, len(circle) // 2 + 1)
    # Polygons around it both ways, along the parallels and along the meridians.
    return np.concatenate([radius * (circle * np.cos(a) + (0, 0, np.sin(a))) for a in parallels])


def collect_shape_corners(model: Model, shapes: Iterable[Shape]) -> Array | None:
    """Collect points (n, 3) on some shapes, in their link's frame, whose hull is that of the shapes.

    None when a shape is not known.
    """
    parts = [compute_shape_corners(model, shape, circumscribed=False) for shape in shapes]
    known = [part for part in parts if part is not None]
    if len(known) != len(parts):
        return None
    return np.concatenate(known) if known else np.zeros((0, 3))
