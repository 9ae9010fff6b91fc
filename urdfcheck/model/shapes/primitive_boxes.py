"""Boxes around primitives, as plain numbers: where they meet, nothing else need be computed."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product

from urdfcheck.core.records import dataclass
from urdfcheck.facts.small_matrices import Placement, Vector
from urdfcheck.model.parts import Shape, is_dummy_shape
from urdfcheck.model.robot import Model

# m
_ROUNDING = 1e-9


@dataclass(frozen=True, slots=True)
class PrimitiveBox:
    """The least and the greatest corner (m)."""

    low: Vector
    high: Vector

    def meets(self, other: PrimitiveBox) -> bool:
        """Whether there is no space between two boxes but what rounding leaves."""
        return all(a <= b + _ROUNDING for a, b in zip((*self.low, *other.low), (*other.high, *self.high), strict=True))


def has_only_touching_primitives(model: Model) -> bool:
    """Whether primitives of the two links of each joint that separates drawn parts have boxes that meet.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    tree = model.tree
    drawn = {name: _list_boxes(model, name) for name in tree.order}
    below = {name: len(boxes) for name, boxes in drawn.items()}
    for name in reversed(tree.order[1:]):
        below[tree.parent_joint[name].parent] += below[name]
    separating = [tree.parent_joint[name] for name in tree.order[1:] if 0 < below[name] < below[tree.root]]
    return all(
        any(one is not None and other is not None and one.meets(other) for one, other in pairs)
        for pairs in (product(drawn[joint.parent], drawn[joint.child]) for joint in separating)
    )


def _list_boxes(model: Model, name: str) -> list[PrimitiveBox | None]:
    """List the boxes of the shapes of a link; None for one that is not known."""
    link, frame = model.link_by_name[name], model.placements[name]
    shapes = (shape for shape in (*link.visuals, *link.collisions) if not is_dummy_shape(shape))
    return [compute_primitive_box(shape, frame) for shape in shapes]


def compute_primitive_box(shape: Shape, frame: Placement) -> PrimitiveBox | None:
    """Compute the box around a primitive in the frame in which its link is placed; None for a mesh or where it is malformed."""
    origin, size, kind = shape.origin.placement, shape.size, shape.kind
    if origin is None or size is None or kind is None or kind == "mesh" or min(size) <= 0:
        return None
    placed = frame.carry(origin)
    (x, y, z), (a, b, c) = placed.place, compute_half_extents(kind, size, placed.rotation)
    return PrimitiveBox((x - a, y - b, z - c), (x + a, y + b, z + c))


def compute_half_extents(kind: str, size: Sequence[float], turn: Sequence[Sequence[float]]) -> Vector:
    """Compute half the extents (m) of a primitive along the axes of the frame in which it is rotated by ``turn`` (3, 3)."""
    if kind == "sphere":
        return size[0], size[0], size[0]
    if kind == "box":
        x, y, z = (sum(abs(part) * edge for part, edge in zip(row, size, strict=True)) / 2.0 for row in turn)
        return x, y, z
    radius, length = size
    x, y, z = (
        abs(along) * length / 2.0 + radius * (math.sqrt(max(0.0, 1.0 - along * along)) if kind == "cylinder" else 1.0)
        for _, _, along in turn
    )
    return x, y, z
