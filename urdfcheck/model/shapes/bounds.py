"""Boxes around shapes: what links draw, or collide with, measured along the axes of one frame."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.mesh.topology import compute_bounds
from urdfcheck.model.parts import Shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.mesh_sizes import get_mesh_scale
from urdfcheck.model.shapes.primitive_boxes import compute_half_extents

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array
    from urdfcheck.facts.mesh.measure import MeshFacts


# More than rounding leaves of a quarter turn's zeros, and less than anybody measures.
_STRAIGHT = 1e-9
# The rotations that turn COLLADA's frames to z up, which some programs apply and others do not.
Z_UP_ROTATIONS = {
    "Y_UP": np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
    "X_UP": np.array([[0, -1.0, 0], [0, 0, -1], [1, 0, 0]]),
}


def compute_bounding_box(
    model: Model, shapes: Iterable[tuple[Shape, Array]], *, apply_unit: bool = True, apply_up_axis: bool = False
) -> Array | None:
    """Compute the least and the greatest corner (2, 3), in m, of the box around some shapes.

    Each shape comes with the 4x4 placement of its link. ``apply_unit`` and ``apply_up_axis``: whether COLLADA's ``<unit>``
    and ``<up_axis>`` are followed. None when there is no shape, or when one is malformed or its mesh could not be read.
    """
    boxes = [
        _compute_shape_box(model, shape, frame, apply_unit=apply_unit, apply_up_axis=apply_up_axis)
        for shape, frame in shapes
    ]
    known = [box for box in boxes if box is not None]
    if not known or len(known) != len(boxes):
        return None
    return np.array((np.min([low for low, _ in known], axis=0), np.max([high for _, high in known], axis=0)))


def _compute_shape_box(
    model: Model, shape: Shape, frame: Array, *, apply_unit: bool, apply_up_axis: bool
) -> tuple[Array, Array] | None:
    pose, size = shape.origin.matrix, shape.size
    if pose is None or size is None or shape.kind is None:
        return None
    placed = frame @ pose
    turn, place = placed[:3, :3], placed[:3, 3]
    if shape.kind == "mesh":
        facts = model.meshes.get_facts(shape)
        scale = get_mesh_scale(model, shape, apply_unit)
        if facts is None or scale is None:
            return None
        turned = get_up_axis_rotation(facts, apply_up_axis)
        return _compute_mesh_box(facts, turn @ np.diag(scale) @ turned, place)
    reach = np.array(compute_half_extents(shape.kind, [abs(part) for part in size], turn.tolist()))
    return place - reach, place + reach


def _compute_mesh_box(facts: MeshFacts, linear: Array, place: Array) -> tuple[Array, Array]:
    sizes = np.abs(linear)
    maps_axes_to_axes = (np.count_nonzero(sizes > _STRAIGHT * sizes.max(), axis=1) <= 1).all()
    if maps_axes_to_axes:
        low, high = facts.bounds
        middle, half = linear @ (low + high) / 2 + place, sizes @ (high - low) / 2
        return middle - half, middle + half
    low, high = compute_bounds(facts.vertices @ linear.T)
    return low + place, high + place


def get_up_axis_rotation(facts: MeshFacts, apply_up_axis: bool) -> Array:
    """Return the rotation that puts a mesh upright (a permutation of its axes), the identity without ``apply_up_axis``."""
    return Z_UP_ROTATIONS.get(facts.up_axis or "", np.eye(3)) if apply_up_axis else np.eye(3)
