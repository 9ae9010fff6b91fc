"""Collisions of rigid shapes with coal, and a proof of their absence with spheres.

Bounding spheres and boxes of all pairs in all configurations are compared at once in numpy; coal sees what is left.
Meshes collide as surfaces, as MoveIt and Gazebo collide them: one that lies wholly inside another does not meet it.
Convex meshes and primitives are solid.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from urdfcheck.facts.arrays import Array, Bools, Indices


# Lengths that differ by less than this fraction of the smaller of two shapes are one: single precision of a mesh file
# (6e-8), coordinates written with six digits (5e-7 each), their sums along a chain, and the 1e-6 to which coal's GJK works.
ROUNDING = 1e-5
# What coal computes distances and depths to, in its own unit of length.
_TOLERANCE = 1e-6
# A convex mesh with more triangles is treated as any other: there the test for convexity costs more than it saves.
LARGEST_CONVEX = 2000
# Comparisons of spheres that are made at once, to keep memory flat: 24 bytes each.
BATCH_SIZE = 500_000
# What coal prepares for a pair of shapes is kept for so many of them.
_MOST_FUNCTIONS = 20_000
# Directions in which a way out is looked for, besides the axes, in the frame of either shape. Any direction is within 23° of
# one of them, which lengthens a way by 9 % at most where faces are flat.
DIRECTIONS = 40
# Contacts of triangles among which one is looked for that is no mere touch.
_PIERCING_CONTACTS = 20
# Contacts of triangles that are looked at to tell where two meshes meet.
MOST_CONTACTS = 2000


@dataclass(frozen=True, slots=True, eq=False)
class CollisionGeometry:
    """A shape in its own frame. ``kind``: box | cylinder | sphere | capsule | mesh; ``size`` in metres as URDF gives it (box
    x y z; cylinder, capsule radius length; sphere radius; empty for a mesh); ``vertices`` (V, 3) in metres and ``faces``
    (F, 3) of a mesh, which is ``closed`` or not."""

    kind: str
    size: tuple[float, ...] = ()
    vertices: Array | None = None
    faces: Indices | None = None
    closed: bool = False

    @property
    def corners(self) -> Array:
        """Points (n, 3) on the shape, or of a box about it, between which it lies."""
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
    pose: Array


@dataclass(frozen=True, slots=True, eq=False)
class Separation:
    """A way out of an overlap: the second shape, moved by ``depth`` (m) along ``normal`` (3,), no longer meets the first.

    Both shapes convex: the penetration depth (EPA, to 1e-6 of the robot's size). Else the shortest of the ways that were
    tried, which is the penetration depth or longer: directions are spread evenly, and each way is followed until the shapes lie
    on two sides of a plane. 0 where a way of `ROUNDING` of the smaller shape is enough.
    ``point`` (3,): the middle of the region where the surfaces meet. ``shapes``: places of the two among the colliders';
    ``size`` (m): diameter of the sphere about the smaller one.
    """

    shapes: tuple[int, int]
    depth: float
    normal: Array
    point: Array
    size: float


class Colliders:
    """Shapes on bodies, ready to be moved and compared.

    :raises ImportError: when coal is not installed.
    """

    def __init__(self, placed: Sequence[PlacedGeometry]) -> None:
        import coal

        self._coal = coal
        self.placed = tuple(placed)
        boxes = [_compute_bounding_box(p.geometry) for p in self.placed]
        self._middle = np.array([middle for middle, _, _ in boxes]).reshape(-1, 3)
        self._half = np.array([half for _, half, _ in boxes]).reshape(-1, 3)
        self._radius = np.array([radius for _, _, radius in boxes])
        self._pose = np.array([p.pose for p in self.placed]).reshape(-1, 4, 4)
        self._owner = np.array([p.owner for p in self.placed], dtype=np.int64)
        self._count = np.bincount(self._owner)
        # coal's tolerances are absolute: it gets lengths of about 1, divided by a power of two and hence exactly.
        self._unit = 2.0 ** round(math.log2(float(np.max(self._radius, initial=0.0)) or 1.0))
        self._geometries: dict[int, Any] = {}
        self._functions: dict[tuple[int, int], Any] = {}
        self._request = coal.CollisionRequest()
        # Without contacts coal 3.0.3 overlooks some shapes that lie deep in others, with their axes in line.
        self._request.enable_contact = True
        self._result = coal.CollisionResult()

    @cached_property
    def spheres(self) -> dict[int, tuple[Array, float]]:
        """Centre (3,) and radius (m) of a sphere about all shapes of each body that has some, in the body's frame."""
        found: dict[int, tuple[Array, float]] = {}
        for owner in dict.fromkeys(self._owner.tolist()):
            own = self._owner == owner
            pose, radii = self._pose[own], self._radius[own]
            centres = np.einsum("sij,sj->si", pose[:, :3, :3], self._middle[own]) + pose[:, :3, 3]
            low, high = (centres - radii[:, None]).min(axis=0), (centres + radii[:, None]).max(axis=0)
            middle = (low + high) / 2
            reach = np.linalg.norm(centres - middle, axis=1) + radii
            found[owner] = (middle, float(reach.max()))
        return found

    def detect_collisions(self, frames: Array, pairs: Indices) -> Bools:
        """Whether bodies meet (K, N).

        Faces in one plane count as met where neither shape's box lies on one side of it, to within `ROUNDING`.
        ``frames`` (N, B, 4, 4): placements of the bodies in one common frame; ``pairs`` (K, 2) of bodies that have shapes.
        """
        found = np.zeros((len(pairs), len(frames)), dtype=bool)
        if not len(pairs):
            return found
        step = max(1, BATCH_SIZE // len(pairs))
        for start in range(0, len(frames), step):
            part = slice(start, start + step)
            near = self.find_candidate_pairs(frames[part], pairs)
            for row, (k, n) in enumerate(zip(near.pair.tolist(), near.pose.tolist(), strict=True)):
                if not found[k, start + n] and near.has_collision(row):
                    found[k, start + n] = True
        return found

    def detect_collisions_per_pair(self, frames: Array, pairs: Indices) -> Bools:
        """Whether each pair of bodies meets in its own configuration (K,): ``frames`` (K, B, 4, 4), ``pairs`` (K, 2)."""
        own = np.arange(len(pairs))
        near = self._filter_shape_pairs(frames, pairs, own, own)
        found = np.zeros(len(pairs), dtype=bool)
        for row, k in enumerate(near.pair.tolist()):
            if not found[k]:
                found[k] = near.has_collision(row)
        return found

    def find_candidate_pairs(self, frames: Array, pairs: Indices) -> CandidatePairs:
        """What spheres and boxes cannot tell apart, arguments as for `detect_collisions`."""
        bodies, place = np.unique(pairs, return_inverse=True)
        first, second = place.reshape(-1, 2).T
        middles = np.array([self.spheres[b][0] for b in bodies.tolist()]).reshape(-1, 3)
        radii = np.array([self.spheres[b][1] for b in bodies.tolist()])
        own = frames[:, bodies]
        at = np.einsum("nbij,bj->bni", own[..., :3, :3], middles) + np.swapaxes(own[..., :3, 3], 0, 1)
        near = []
        step = max(1, BATCH_SIZE // max(1, len(frames)))
        for start in range(0, max(1, len(pairs)), step):
            one, other = first[start : start + step], second[start : start + step]
            apart = at[one] - at[other]
            touch = ((radii[one] + radii[other]) ** 2)[:, None] >= np.einsum("kni,kni->kn", apart, apart)
            pair, pose = np.nonzero(touch)
            near.append((pair + start, pose))
        pair, pose = (np.concatenate(found) for found in zip(*near, strict=True))
        return self._filter_shape_pairs(frames, pairs, pair, pose)

    def _filter_shape_pairs(self, frames: Array, pairs: Indices, pair: Indices, pose: Indices) -> CandidatePairs:
        """The shapes of some pairs, each in one configuration, that spheres and boxes about them cannot tell apart."""
        shapes = np.flatnonzero(np.isin(self._owner, pairs[pair]))
        column = np.zeros(len(self.placed), dtype=np.int64)
        column[shapes] = np.arange(len(shapes))
        placed = frames[:, self._owner[shapes]] @ self._pose[shapes]
        turns, at = placed[..., :3, :3], placed[..., :3, 3]
        centres = np.einsum("nsij,sj->nsi", turns, self._middle[shapes]) + at
        found = []
        for part in self._split_into_batches(pairs[pair]):
            k, n, one, other = self._expand_shape_pairs(pairs, pair[part], pose[part])
            apart = centres[n, column[other]] - centres[n, column[one]]
            kept = np.einsum("mi,mi->m", apart, apart) <= (self._radius[one] + self._radius[other]) ** 2
            k, n, one, other, apart = k[kept], n[kept], one[kept], other[kept], apart[kept]
            kept = detect_box_overlap(
                turns[n, column[one]],
                self._half[one],
                turns[n, column[other]],
                self._half[other],
                apart,
                self._compute_rounding(one, other),
            )
            found.append((k[kept], n[kept], one[kept], other[kept]))
        k, n, one, other = (np.concatenate(rows) for rows in zip(*found, strict=True))
        return CandidatePairs(self, k, n, one, other, column[one], column[other], turns, at)

    def _split_into_batches(self, pairs: Indices) -> list[slice]:
        """Runs of pairs of bodies whose shapes make few pairs."""
        one, other = self._count[pairs].T
        part = np.cumsum(one * other) // BATCH_SIZE
        starts = [0, *(np.flatnonzero(np.diff(part)) + 1).tolist()]
        return [slice(start, end) for start, end in zip(starts, [*starts[1:], len(pairs)], strict=True)]

    def _expand_shape_pairs(self, pairs: Indices, pair: Indices, pose: Indices) -> tuple[Any, ...]:
        """Pairs of bodies as pairs of shapes: the pair's place, the configuration, the two shapes."""
        order = np.argsort(self._owner, kind="stable")
        count = self._count
        first = np.cumsum(count) - count
        one, other = pairs[pair].T
        many = count[one] * count[other]
        item = np.repeat(np.arange(len(pair)), many)
        within = np.arange(len(item)) - np.repeat(np.cumsum(many) - many, many)
        shape, mate = np.divmod(within, count[other][item])
        return pair[item], pose[item], order[first[one][item] + shape], order[first[other][item] + mate]

    def _has_collision(self, one: int, at_one: Any, other: int, at_other: Any) -> bool:
        key = (one, other)
        if key not in self._functions:
            if len(self._functions) >= _MOST_FUNCTIONS:
                self._functions.clear()
            self._functions[key] = self._coal.ComputeCollision(
                self._get_coal_geometry(one), self._get_coal_geometry(other)
            )
        self._result.clear()
        return bool(self._functions[key](at_one, at_other, self._request, self._result))

    def find_deepest_overlap(
        self, frames: Array, one: int, other: int, *, with_depth: bool = True
    ) -> Separation | None:
        """The deepest overlap of the shapes of two bodies, ``frames`` (B, 4, 4) as for `detect_collisions`; None where none meet.

        Not ``measured``: only whether they overlap is of interest, and in which shapes. A depth that need not be known to
        tell which shapes overlap most is infinite then.
        """
        found: Separation | None = None
        mates = product(np.flatnonzero(self._owner == one).tolist(), np.flatnonzero(self._owner == other).tolist())
        placed = [(a, self._compute_shape_pose(frames, a), b, self._compute_shape_pose(frames, b)) for a, b in mates]
        meeting = [
            (a, at_a, b, at_b)
            for a, at_a, b, at_b in placed
            if np.linalg.norm(self._compute_shape_centre(a, at_a) - self._compute_shape_centre(b, at_b))
            <= self._radius[a] + self._radius[b]
            and self._has_collision(a, self._to_coal_transform(at_a), b, self._to_coal_transform(at_b))
        ]
        for a, at_a, b, at_b in meeting:
            way = self._compute_separation(a, at_a, b, at_b, with_depth=with_depth or len(meeting) > 1)
            if way is not None and (found is None or way.depth > found.depth):
                found = way
        return found

    def _compute_shape_pose(self, frames: Array, shape: int) -> Array:
        at: Array = frames[self._owner[shape]] @ self._pose[shape]
        return at

    def _compute_shape_centre(self, shape: int, at: Array) -> Array:
        centre: Array = at[:3, :3] @ self._middle[shape] + at[:3, 3]
        return centre

    def _compute_separation(
        self, one: int, at_one: Array, other: int, at_other: Array, *, with_depth: bool
    ) -> Separation | None:
        """How to free the second of two shapes; None where they do not meet."""
        coal = self._coal
        request, result = coal.CollisionRequest(), coal.CollisionResult()
        solid = not (self._is_surface(one) or self._is_surface(other))
        request.num_max_contacts = 1 if solid else MOST_CONTACTS if with_depth else _PIERCING_CONTACTS
        coal.collide(
            self._get_coal_geometry(one),
            self._to_coal_transform(at_one),
            self._get_coal_geometry(other),
            self._to_coal_transform(at_other),
            request,
            result,
        )
        contacts = [result.getContact(i) for i in range(result.numContacts())]
        if not contacts:
            return None
        size, rounding = (
            2 * float(min(self._radius[one], self._radius[other])),
            float(self._compute_rounding(one, other)),
        )
        point = np.mean([c.pos for c in contacts], axis=0) * self._unit
        if not np.isfinite(point).all():
            point = (at_one[:3, 3] + at_other[:3, 3]) / 2
        if solid:
            depth, normal = -contacts[0].penetration_depth * self._unit, np.array(contacts[0].normal)
            # Where EPA fails, it says so with a depth of 1e308 along no direction.
            if np.isfinite(normal).all() and depth <= 2 * (self._radius[one] + self._radius[other]):
                return Separation((one, other), depth if depth > rounding else 0.0, normal, point, size)
        if not with_depth and self._has_piercing_triangles(one, at_one, other, at_other, contacts, rounding):
            return Separation((one, other), math.inf, np.zeros(3), point, size)

        def is_free(shift: Array) -> bool:
            moved = at_other.copy()
            moved[:3, 3] += shift
            return not self._has_collision(one, self._to_coal_transform(at_one), other, self._to_coal_transform(moved))

        depth, normal = find_separating_translation(
            self.placed[one].geometry.corners @ at_one[:3, :3].T + at_one[:3, 3],
            self.placed[other].geometry.corners @ at_other[:3, :3].T + at_other[:3, 3],
            np.concatenate([sample_sphere_directions(DIRECTIONS) @ at[:3, :3].T for at in (at_one, at_other)]),
            is_free,
            rounding,
            with_depth=with_depth,
        )
        return Separation((one, other), depth, normal, point, size)

    def _has_piercing_triangles(
        self, one: int, at_one: Array, other: int, at_other: Array, contacts: Sequence[Any], rounding: float
    ) -> bool:
        """Whether triangles that meet cross each other so far that no shift by ``rounding`` parts them."""
        if not (self._is_surface(one) and self._is_surface(other)):
            return False
        met = []
        for shape, at, faces in ((one, at_one, [c.b1 for c in contacts]), (other, at_other, [c.b2 for c in contacts])):
            geometry = self.placed[shape].geometry
            assert geometry.vertices is not None
            assert geometry.faces is not None
            met.append(geometry.vertices[geometry.faces[faces]] @ at[:3, :3].T + at[:3, 3])
        mine, its = met
        return bool((find_piercing_edges(mine, its, rounding) | find_piercing_edges(its, mine, rounding)).any())

    def _compute_rounding(self, one: Any, other: Any) -> Array:
        """The overlap (m) that is none, for one or several pairs of shapes."""
        smaller = np.minimum(self._radius[one], self._radius[other])
        least: Array = np.maximum(ROUNDING * 2 * smaller, 2 * _TOLERANCE * self._unit)
        return least

    def _to_coal_transform(self, matrix: Array) -> Any:
        return self._coal.Transform3s(np.ascontiguousarray(matrix[:3, :3]), matrix[:3, 3] / self._unit)

    def _is_surface(self, shape: int) -> bool:
        return isinstance(self._get_coal_geometry(shape), self._coal.BVHModelBase)

    def _get_coal_geometry(self, shape: int) -> Any:
        """coal's geometry of a shape, one for all that share a `CollisionGeometry`."""
        geometry = self.placed[shape].geometry
        if id(geometry) not in self._geometries:
            self._geometries[id(geometry)] = self._build_coal_geometry(geometry)
        return self._geometries[id(geometry)]

    def _build_coal_geometry(self, geometry: CollisionGeometry) -> Any:
        coal, size = self._coal, [s / self._unit for s in geometry.size]
        if geometry.vertices is None or geometry.faces is None:
            made = {"box": coal.Box, "sphere": coal.Sphere, "cylinder": coal.Cylinder, "capsule": coal.Capsule}
            return made[geometry.kind](*size)
        vertices = np.ascontiguousarray(geometry.vertices / self._unit)
        if geometry.closed and is_convex(geometry.vertices, geometry.faces):
            points, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
            points.extend(list(vertices))
            triangles.extend([coal.Triangle(*face) for face in geometry.faces.tolist()])
            return coal.Convex(points, triangles)
        tree = coal.BVHModelOBB()
        tree.beginModel(len(geometry.faces), len(vertices))
        tree.addVertices(vertices)
        tree.addTriangles(np.ascontiguousarray(geometry.faces, dtype=np.int64))
        tree.endModel()
        return tree


class CandidatePairs:
    """Shapes ``one`` (M,) and ``other`` (M,) that may meet, of pair ``pair`` (M,) in configuration ``pose`` (M,)."""

    def __init__(
        self,
        colliders: Colliders,
        pair: Indices,
        pose: Indices,
        one: Indices,
        other: Indices,
        first: Indices,
        second: Indices,
        turns: Array,
        at: Array,
    ) -> None:
        """``first``, ``second`` (M,): the columns of the shapes in ``turns`` (N, S, 3, 3) and ``at`` (N, S, 3), m."""
        self.pair, self.pose, self.one, self.other = pair, pose, one, other
        self._colliders = colliders
        self._first, self._second = first, second
        self._turns, self._at = turns, at / colliders._unit
        self._made: dict[tuple[int, int], Any] = {}

    def has_collision(self, row: int) -> bool:
        """Whether the two do, as coal sees it."""
        n = int(self.pose[row])
        at_one, at_other = (
            self._get_coal_transform(n, int(self._first[row])),
            self._get_coal_transform(n, int(self._second[row])),
        )
        return self._colliders._has_collision(int(self.one[row]), at_one, int(self.other[row]), at_other)

    def _get_coal_transform(self, configuration: int, column: int) -> Any:
        key = (configuration, column)
        if key not in self._made:
            self._made[key] = self._colliders._coal.Transform3s(self._turns[key], self._at[key])
        return self._made[key]


def detect_box_overlap(
    turn_a: Array, half_a: Array, turn_b: Array, half_b: Array, centre_offsets: Array, slack: ArrayLike = 0.0
) -> Bools:
    """Whether oriented boxes (M of each) overlap by more than ``slack`` (M,), as far as their six face normals tell; ``turn``
    (M, 3, 3) from box to world, ``half`` (M, 3) edges, ``apart`` (M, 3) from the centres of a to those of b.

    A separating axis test (Gottschalk, Lin, Manocha, *OBBTree*, 1996) without the nine products of edges: these reject
    less than 1 % of what is left, and coal tests them.
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

    False for a flat mesh, which has no inside, and for more than `LARGEST_CONVEX` faces. The largest faces come first, which
    settles most meshes that are not convex.
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
    """For triangles (n, 3, 3) whether an edge of the first passes through the second (n,), and would after any shift by less
    than ``margin``."""
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
    is_free: Callable[[Array], bool],
    rounding: float,
    *,
    with_depth: bool = True,
) -> tuple[float, Array]:
    """How far (m) and where to the second of two shapes that meet must be moved to be free, along one of ``directions`` (D, 3).

    ``one``, ``other`` (n, 3): points between which the shapes lie; ``free``: whether the second is after a shift (3,).
    A way counts when it leads on to where a plane separates the two, not into a hollow. Depth 0 when ``rounding`` is enough;
    infinite where it is not and need not be ``measured``.
    """
    clear = (one @ directions.T).max(axis=0) - (other @ directions.T).min(axis=0)
    order = np.argsort(clear, kind="stable")
    clear, directions = clear[order], directions[order]

    def can_exit(depth: float, i: int) -> bool:
        return all(is_free((depth + part * (clear[i] - depth)) * directions[i]) for part in (0.0, 0.25, 0.5, 0.75))

    best, normal = float(clear[0]), directions[0]
    # Faces in one plane come apart along any way with a share of their normal.
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


def sample_sphere_directions(count: int) -> Array:
    """The six directions of the axes and ``count`` more unit vectors (n, 3), spread evenly (a Fibonacci lattice)."""
    place = np.arange(count) + 0.5
    height = 1.0 - 2.0 * place / count
    angle = math.pi * (3.0 - math.sqrt(5.0)) * place
    across = np.sqrt(1.0 - height**2)
    spread = np.column_stack((across * np.cos(angle), across * np.sin(angle), height))
    return np.concatenate((np.eye(3), -np.eye(3), spread))


def compute_swept_spheres(
    centres: Array, radii: Array, axis: Array, lower: float, upper: float, *, rotates: bool
) -> tuple[Array, Array]:
    """Spheres that contain spheres (n) in all places to which a joint brings them, its values from ``lower`` to ``upper``.

    ``axis`` (3,): unit vector through the origin of the frame in which ``centres`` (n, 3) are given; ``radii`` (n,).
    """
    middle, half = (lower + upper) / 2, (upper - lower) / 2
    if not rotates:
        return centres + middle * axis, radii + half
    foot = (centres @ axis)[:, None] * axis
    arm = centres - foot
    distance = np.linalg.norm(arm, axis=1)
    if half >= math.pi / 2:
        return foot, radii + distance
    turned = arm * math.cos(middle) + np.cross(axis, arm) * math.sin(middle)
    return foot + math.cos(half) * turned, radii + distance * math.sin(half)


def compute_least_distance(
    centres: Array, others: Array, axis: Array, lower: ArrayLike, upper: ArrayLike, *, rotates: bool
) -> Array:
    """How near (n,) points that a joint moves come to points that stay, its motion from ``lower`` to ``upper``.

    ``axis`` (3,): unit vector through the origin of the frame in which ``centres`` and ``others`` (n, 3) are given.
    """
    apart = others - centres
    if not rotates:
        along = np.clip(apart @ axis, lower, upper)
        gap: Array = np.linalg.norm(apart - along[:, None] * axis, axis=1)
        return gap
    arm, goal = (points - (points @ axis)[:, None] * axis for points in (centres, others))
    radius, distance = np.linalg.norm(arm, axis=1), np.linalg.norm(goal, axis=1)
    turn = np.arctan2(np.cross(arm, goal) @ axis, np.einsum("ni,ni->n", arm, goal))
    passed = np.floor((upper - turn) / (2 * math.pi)) >= np.ceil((lower - turn) / (2 * math.pi))
    cosine = np.where(passed, 1.0, np.maximum(np.cos(turn - lower), np.cos(turn - upper)))
    squared = (apart @ axis) ** 2 + radius**2 + distance**2 - 2 * radius * distance * cosine
    near: Array = np.sqrt(np.maximum(squared, 0.0))
    return near


def list_all_pairs(count: int) -> Indices:
    """All pairs (K, 2) of ``count`` things, the lower first."""
    return np.column_stack(np.triu_indices(count, 1))


def _compute_bounding_box(geometry: CollisionGeometry) -> tuple[Array, Array, float]:
    """A box about a shape in its own frame: centre (3,), half edges (3,); and the shape's radius about the centre."""
    corners = geometry.corners
    low, high = corners.min(axis=0), corners.max(axis=0)
    middle = (low + high) / 2
    radius = float(np.linalg.norm(corners - middle, axis=1).max())
    if geometry.kind == "sphere":
        radius = geometry.size[0]
    elif geometry.kind == "capsule":
        radius = geometry.size[1] / 2 + geometry.size[0]
    elif geometry.kind == "cylinder":
        radius = math.hypot(geometry.size[0], geometry.size[1] / 2)
    return middle, (high - low) / 2, radius
