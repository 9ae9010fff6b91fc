"""Collision shapes that are not where the link draws the same shape."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import permutations, product
from typing import TYPE_CHECKING

from urdfcheck.core import Edit, Located
from urdfcheck.core.records import dataclass
from urdfcheck.facts.small_matrices import IDENTITY, Matrix, Placement, measure_rotation, multiply, transpose
from urdfcheck.model.parts import Link, Shape, is_dummy_shape
from urdfcheck.model.repairs.edits import edit_all_numbers
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.solids import compute_drawn_scale

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array
    from urdfcheck.facts.mesh.measure import MeshFacts

# The differences that count unless a configuration says otherwise (m, rad); the page of GEO005 has the reasons.
MIN_DISTANCE, MIN_ANGLE = 1e-4, 2e-3
# In which two outlines are compared.
_DIRECTIONS = 256
# A mesh is round about an axis if its reach there varies by at most this share: that of a circle drawn with 16 edges.
_ROUND = 0.02
# In which it is measured.
_AROUND = 72
# What rounding leaves (m, rad).
_NO_DISTANCE, _NO_ANGLE = 1e-9, 1e-6
# The orders of three axes that a rotation brings about without a mirror.
_EVEN_ORDERS = {(0, 1, 2), (1, 2, 0), (2, 0, 1)}


@dataclass(frozen=True, slots=True, eq=False)
class PlacedShape:
    """A visual or collision, and its pose."""

    shape: Shape
    what: str
    """The name of its mesh, or its kind: ``wheel.stl``, ``box``."""
    placement: Placement
    """In the link's frame."""

    @property
    def place(self) -> Located:
        return self.shape if self.shape.origin.element is None else self.shape.origin.element

    def measure_difference(self, other: PlacedShape) -> tuple[float, float]:
        """Return the distance (m) and the angle of rotation (rad) between two equal shapes.

        The angle is the least one: a cylinder rotated about its axis is the same cylinder.
        """
        if self.placement == other.placement:
            return 0.0, 0.0
        moved = math.dist(self.placement.place, other.placement.place)
        return moved, _measure_angle(self.shape, self.measure_turn(other))

    def measure_turn(self, other: PlacedShape) -> Matrix:
        """Return the rotation from this shape to another."""
        return multiply(transpose(self.placement.rotation), other.placement.rotation)


@dataclass(frozen=True, slots=True, eq=False)
class DisplacedCollision:
    """A collision shape and the visual of the same shape that it should lie on."""

    link: Link
    visual: PlacedShape
    collision: PlacedShape
    moved: float
    """m"""
    turned: float
    """rad"""
    counts: tuple[int, int]
    """How many visuals and collisions of the link have the shape."""

    @property
    def has_angles_as_position(self) -> bool:
        """Whether the collision's xyz is the visual's rpy, which is not the collision's."""
        visual, collision = self.visual.shape.origin, self.collision.shape.origin
        return (
            collision.xyz is not None
            and any(collision.xyz)
            and collision.xyz == visual.rpy
            and collision.xyz != visual.xyz
            and collision.rpy != visual.rpy
        )

    @property
    def has_angles_beyond_turns(self) -> bool:
        """Whether an angle of either origin is more than a turn, as one in degrees."""
        angles = [angle for shape in (self.visual, self.collision) for angle in shape.shape.origin.rpy or ()]
        return any(abs(angle) > math.tau for angle in angles)

    def describe_gap(self, *, with_angle: bool = True) -> str:
        """Return how far the collision is from the visual: ``0.0867 m and 90°``."""
        parts = [f"{self.moved:.3g} m"] if self.moved > _NO_DISTANCE else []
        parts += [f"{math.degrees(self.turned):.3g}°"] if with_angle and self.turned > _NO_ANGLE else []
        return " and ".join(parts)

    def propose_edits(self) -> list[Edit]:
        """Return the edits that give the collision the visual's origin, if both are typed as numbers."""
        wrong = []
        for name in ("xyz", "rpy"):
            source = self.visual.shape.origin.get_attribute(name)
            target = self.collision.shape.origin.get_attribute(name)
            wanted = "0 0 0" if source is None else source.typed
            if target is None and wanted.split() == ["0", "0", "0"]:
                continue
            if target is not None and target.value.split() == wanted.split():
                continue
            if source is not None and not source.literal:
                return []
            wrong.append((target, wanted))
        return edit_all_numbers(wrong)


def list_displaced_collisions(
    model: Model, *, distance: float = MIN_DISTANCE, angle: float = MIN_ANGLE
) -> Iterator[DisplacedCollision]:
    """Yield the collision shapes that are further than ``distance`` (m) or ``angle`` (rad) from each visual of the same shape.

    A part that is used several times has several places, in any order. A mesh that a rotation maps onto itself is in place.
    """

    def is_same_pose(one: PlacedShape, other: PlacedShape) -> bool:
        moved, turned = one.measure_difference(other)
        if moved <= distance and turned <= angle:
            return True
        return turned > angle and _covers(model, one, other, distance, in_place=moved <= distance)

    for link in model.links:
        for visuals, collisions in _group_by_shape(model, link):
            free = [v for v in visuals if not any(is_same_pose(v, c) for c in collisions)]
            for collision in collisions:
                if free and not any(is_same_pose(v, collision) for v in visuals):
                    visual = min(free, key=collision.measure_difference)
                    gap = visual.measure_difference(collision)
                    yield DisplacedCollision(link, visual, collision, *gap, (len(visuals), len(collisions)))


def _group_by_shape(model: Model, link: Link) -> Iterator[tuple[list[PlacedShape], list[PlacedShape]]]:
    """Yield the visuals and the collisions of a link that are one shape in one size and have a known pose."""
    if not link.visuals or not link.collisions:
        return
    groups: dict[object, tuple[list[Shape], list[Shape]]] = {}
    for shape in (*link.visuals, *link.collisions):
        use, kind, size = model.meshes.by_shape.get(id(shape)), shape.kind, shape.size
        if size is None or (kind == "mesh" and use is None) or is_dummy_shape(shape):
            continue
        what = kind if use is None else use.resource.path or use.filename.value
        groups.setdefault((what, size), ([], []))[shape.role == "collision"].append(shape)
    for group in groups.values():
        if all(group):
            visuals, collisions = ([*_place_shapes(model, shapes)] for shapes in group)
            yield visuals, collisions


def _place_shapes(model: Model, shapes: Sequence[Shape]) -> Iterator[PlacedShape]:
    for shape in shapes:
        use, placement = model.meshes.by_shape.get(id(shape)), shape.origin.placement
        if placement is not None:
            yield PlacedShape(shape, (shape.kind or "") if use is None else use.name, placement)


def _covers(model: Model, one: PlacedShape, other: PlacedShape, distance: float, *, in_place: bool) -> bool:
    """Whether a mesh takes the same room in two places, to within ``distance`` (m): hull and surface are symmetric under the
    rotation. False where the mesh was not read.

    ``in_place``: it is only rotated; a mesh that is round about the axis of the rotation, apart from the edges of its outline,
    then takes the same room.
    """
    facts, scale = model.meshes.get_facts(one.shape), compute_drawn_scale(model, one.shape)
    if facts is None or scale is None:
        return False
    import numpy as np

    from urdfcheck.facts.sphere_directions import spread_directions_and_axes

    factors = np.array(scale)
    turns = [np.array(placed.placement.rotation) for placed in (one, other)]
    places = [np.array(placed.placement.place) for placed in (one, other)]
    if in_place:
        distance = max(distance, _measure_edges(facts, factors, turns))
    covariance = facts.surface_covariance * np.outer(factors, factors)
    centroid, centroid_2 = (
        turn @ (factors * facts.surface_centroid) + place for turn, place in zip(turns, places, strict=True)
    )
    spread, spread_2 = (turn @ covariance @ turn.T for turn in turns)
    size = float(np.sqrt(max(0.0, np.trace(spread))))
    # A surface that moves by the distance everywhere changes its moments by twice that times its extent.
    if np.linalg.norm(centroid - centroid_2) > distance or np.abs(spread - spread_2).max() > 2.0 * distance * size:
        return False
    directions = spread_directions_and_axes(_DIRECTIONS)
    reach, reach_2 = (
        facts.compute_reach((directions @ turn) * factors) + directions @ place
        for turn, place in zip(turns, places, strict=True)
    )
    return bool(np.abs(reach - reach_2).max() <= distance)


def _measure_edges(facts: MeshFacts, factors: Array, turns: Sequence[Array]) -> float:
    """Return how far the outline of a mesh that is round about the axis between two rotations may be from a circle (m).

    0 for a mesh that is not round.
    """
    import numpy as np

    axis = np.linalg.svd(turns[1] @ turns[0].T - np.eye(3))[2][-1]
    across = np.linalg.svd(axis[np.newaxis])[2][1:]
    angles = np.linspace(0.0, math.tau, _AROUND, endpoint=False)
    around = np.stack([np.cos(angles), np.sin(angles)], axis=1) @ across @ turns[0]
    reach = facts.compute_reach(around * factors) - around @ (factors * facts.surface_centroid)
    allowed = _ROUND * float(reach.max())
    return allowed if reach.max() - reach.min() <= allowed else 0.0


def _measure_angle(shape: Shape, turn: Matrix) -> float:
    """Return the least angle (rad) of a rotation of a shape, by which it becomes different."""
    if shape.kind == "sphere":
        return 0.0
    if shape.kind in {"cylinder", "capsule"}:
        return math.asin(min(1.0, math.hypot(turn[0][2], turn[1][2])))
    if shape.kind != "box":
        return measure_rotation(turn)
    return min(measure_rotation(multiply(turn, symmetry)) for symmetry in _generate_box_symmetries(shape.size or ()))


def _generate_box_symmetries(size: tuple[float, ...]) -> Iterator[Matrix]:
    """Yield the rotations by quarter and half turns that map a box onto itself."""
    for order in permutations(range(3)):
        if all(math.isclose(size[a], size[b], rel_tol=1e-9) for a, b in enumerate(order)):
            for signs in product((1.0, -1.0), repeat=3):
                if (math.prod(signs) > 0) == (order in _EVEN_ORDERS):  # else it is a mirror image
                    rows = zip(signs, (IDENTITY[axis] for axis in order), strict=True)
                    first, second, third = ((sign * x, sign * y, sign * z) for sign, (x, y, z) in rows)
                    yield first, second, third
