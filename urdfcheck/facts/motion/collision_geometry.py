"""Shapes that collide, and what can be said about their overlaps without coal.

`detect_box_overlap` rejects most pairs, `find_piercing_edges` and `find_separating_translation` judge those that meet.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import field
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.mesh.topology import compute_bounds

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from urdfcheck.facts.arrays import Array, Bools, Indices, Mat4, Vec3

# Lengths that differ by less than this fraction of the smaller of two shapes are equal: single precision of a mesh file
# (6e-8), coordinates written with six digits (5e-7 each), their sums along a chain, and the 1e-6 to which coal's GJK works.
ROUNDING = 1e-5
# A convex mesh with more triangles is treated as any other: there the test for convexity costs more than it saves.
LARGEST_CONVEX = 2000
# Directions in which a way out is searched for, besides the axes, in the frame of either shape. Any direction is within 23° of
# one of them, which lengthens a way by 9 % at most where faces are flat.
DIRECTIONS = 40


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class CollisionGeometry:
    """A shape in its own frame."""

    kind: str
    """box, cylinder, sphere, capsule or mesh."""
    size: tuple[float, ...] = ()
    """In metres, as in URDF: x y z of a box; radius and length of a cylinder or capsule; radius of a sphere; empty for a mesh."""
    vertices: Array | None = None
    """(V, 3) of a mesh, in metres."""
    faces: Indices | None = None
    """(F, 3) of a mesh."""
    closed: bool = False
    """Whether a mesh is closed."""
    coal_shapes: dict[float, Any] = field(default_factory=dict, init=False, repr=False)
    """What coal made of it for `collision`, by the unit of length (m): trees of large meshes take as long as many queries."""

    @property
    def corners(self) -> Array:
        """Points (n, 3) on the shape, or of a box about it, whose convex hull contains it."""
        if self.vertices is not None:
            return self.vertices
        if self.kind == "box":
            half = [edge / 2 for edge in self.size]
        else:
            radius = self.size[0]
            along = {"sphere": radius, "cylinder": self.size[-1] / 2, "capsule": self.size[-1] / 2 + radius}[self.kind]
            half = [radius, radius, along]
        corners: Array = np.array(list(product((-1.0, 1.0), repeat=3))) * half
        return corners


@dataclass(frozen=True, slots=True, eq=False)
class PlacedGeometry:
    """A ``geometry`` at ``pose`` (4, 4) in the frame of body ``owner``."""

    geometry: CollisionGeometry
    owner: int
    pose: Mat4


def compute_shape_box(geometry: CollisionGeometry) -> tuple[Vec3, Vec3, float]:
    """Return a box about a shape in its own frame: centre (3,), half edges (3,); and the shape's radius about the centre (m)."""
    corners = geometry.corners
    low, high = compute_bounds(corners)
    middle = (low + high) / 2
    away = corners - middle
    radius = math.sqrt(float(np.einsum("ij,ij->i", away, away).max()))
    if geometry.kind == "sphere":
        radius = geometry.size[0]
    elif geometry.kind == "capsule":
        radius = geometry.size[1] / 2 + geometry.size[0]
    elif geometry.kind == "cylinder":
        radius = math.hypot(geometry.size[0], geometry.size[1] / 2)
    return middle, (high - low) / 2, radius


def detect_box_overlap(
    *, turn_a: Array, half_a: Array, turn_b: Array, half_b: Array, centre_offsets: Array, slack: ArrayLike = 0.0
) -> Bools:
    """Whether oriented boxes (M of each) overlap by more than ``slack`` (M,) along all of their six face normals; ``turn``
    (M, 3, 3) from box to world, ``half`` (M, 3) edges, ``centre_offsets`` (M, 3) from the centres of a to those of b.

    A separating axis test (Gottschalk, Lin, Manocha, *OBBTree*, 1996) without the nine products of edges: these reject
    less than 1 % of the rest, and coal tests them.
    """
    across = np.einsum("mji,mjk->mik", turn_a, turn_b)
    reach = np.abs(across)
    between = np.einsum("mji,mj->mi", turn_a, centre_offsets)
    least = np.asarray(slack)[..., None]
    on_a = np.abs(between) + least <= half_a + np.einsum("mij,mj->mi", reach, half_b)
    on_b = np.abs(np.einsum("mij,mi->mj", across, between)) + least <= half_b + np.einsum("mij,mi->mj", reach, half_a)
    overlap: Bools = on_a.all(axis=1) & on_b.all(axis=1)
    return overlap


def is_convex(vertices: Array, faces: Indices) -> bool:
    """Whether no vertex lies outside the plane of a face, to within `ROUNDING` of the mesh's diagonal; the mesh is closed.

    False for a flat mesh, which has no inside, and for more than `LARGEST_CONVEX` faces. The largest faces come first: they
    reject most meshes that are not convex.
    """
    if len(faces) > LARGEST_CONVEX:
        return False
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    areas = np.linalg.norm(normals, axis=1)
    order = np.argsort(-areas, kind="stable")
    order = order[areas[order] > 0]
    slack = ROUNDING * float(np.linalg.norm(np.ptp(vertices, axis=0)))
    for part in np.array_split(order, max(1, len(order) // 64)):
        unit = normals[part] / areas[part, None]
        heights = vertices @ unit.T - np.einsum("ij,ij->i", unit, a[part])
        above, below = heights.max(axis=0), -heights.min(axis=0)
        # Either way round: the mesh may be inside out.
        if (np.minimum(above, below) > slack).any() or (np.maximum(above, below) <= slack).any():
            return False
    return len(order) > 0


def find_piercing_edges(edged: Array, pierced: Array, margin: float) -> Bools:
    """Whether (n,) an edge of the first of two triangles (n, 3, 3) passes through the second, and would after any shift by less
    than ``margin`` (m)."""
    a, b, c = (pierced[:, i] for i in range(3))
    normal = np.cross(b - a, c - a)
    area = np.linalg.norm(normal, axis=1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        normal = normal / area
        found = np.zeros(len(edged), dtype=bool)
        for i in range(3):
            start, end = edged[:, i], edged[:, (i + 1) % 3]
            above, below = (np.einsum("ni,ni->n", p - a, normal) for p in (start, end))
            crosses = (above * below < 0) & (np.minimum(np.abs(above), np.abs(below)) > margin)
            hit = start + ((above / (above - below))[:, None]) * (end - start)
            # A shift moves the point where a slanting edge passes by more than the shift.
            slack = margin * np.linalg.norm(end - start, axis=1) / np.abs(above - below)
            for p, q in ((a, b), (b, c), (c, a)):
                along = q - p
                inwards = np.cross(normal, along) / np.linalg.norm(along, axis=1, keepdims=True)
                crosses &= np.einsum("ni,ni->n", hit - p, inwards) > slack
            found |= crosses
    return found


def find_separating_translation(
    one: Array,
    other: Array,
    directions: Array,
    *,
    is_free: Callable[[Vec3], bool],
    rounding: float,
    with_depth: bool = True,
) -> tuple[float, Vec3]:
    """Find how far (m) and in which of the ``directions`` (D, 3) the second of two shapes that meet must be moved to be free.

    ``one``, ``other`` (n, 3): points whose convex hulls contain the shapes; ``is_free``: whether the second shape is free after
    a shift (3,). A way counts only if it ends where a plane separates the two, not in a hollow. Depth 0 if a shift by
    ``rounding`` (m) is enough; infinite if it is not and the depth is not needed (``with_depth``).
    """
    clear = (one @ directions.T).max(axis=0) - (other @ directions.T).min(axis=0)
    order = np.argsort(clear, kind="stable")
    clear, directions = clear[order], directions[order]

    def can_exit(depth: float, i: int) -> bool:
        return all(is_free((depth + part * (clear[i] - depth)) * directions[i]) for part in (0.0, 0.25, 0.5, 0.75))

    best, normal = float(clear[0]), directions[0]
    # Faces in one plane separate along any direction that has a component along their normal.
    for i in range(DIRECTIONS):
        if clear[i] <= rounding or can_exit(rounding, i):
            return 0.0, directions[i]
    if not with_depth:
        return math.inf, normal
    for i in range(len(directions)):
        high = min(best * 0.98, float(clear[i]))
        if not can_exit(high, i):
            continue
        low = rounding
        while high - low > max(0.02 * high, rounding):
            middle = (low + high) / 2
            low, high = (low, middle) if can_exit(middle, i) else (middle, high)
        best, normal = high, directions[i]
    return best, normal
