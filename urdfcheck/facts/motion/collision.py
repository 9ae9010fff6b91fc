"""Collisions of rigid shapes with coal.

numpy compares the bounding spheres and boxes of all pairs in all configurations in one step; coal tests the rest.
Meshes collide as surfaces, as in MoveIt and Gazebo: one that lies wholly inside another does not meet it.
Convex meshes and primitives are solid.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.motion.coal_shapes import build_coal_primitive, fill_coal_tree
from urdfcheck.facts.motion.collision_geometry import (
    DIRECTIONS,
    ROUNDING,
    CollisionGeometry,
    PlacedGeometry,
    compute_shape_box,
    detect_box_overlap,
    find_piercing_edges,
    find_separating_translation,
    is_convex,
)
from urdfcheck.facts.motion.shared_volume import do_share_volume
from urdfcheck.facts.sphere_directions import spread_directions_and_axes

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Bools, Indices, Mat4, Vec3

# coal's tolerances are absolute, 1e-6: its unit of length is about the radius of the smaller shape of a pair. It is a power
# of 2, which scales lengths exactly, and of 2 to this power, so that a mesh has few trees.
_UNIT_STEP = 3
# Comparisons of spheres in one batch, to keep memory flat: 24 bytes each.
_BATCH_SIZE = 500_000
# What coal prepares for a pair of shapes is kept for this many pairs.
_MOST_FUNCTIONS = 20_000
# coal counts the neighbours of a corner of a convex mesh in one byte, and refuses more: the middle of a disc of many sides.
_MOST_NEIGHBOURS = 254
# Contacts of triangles among which one is searched for that is not a mere touch.
_PIERCING_CONTACTS = 20
# Contacts of triangles from which the middle of the overlap of two meshes is computed.
_MOST_CONTACTS = 2000
# Meshes touch if what they share is thinner than this part of the smaller one: in a part of 0.1 m as much as an origin of four
# decimals is off.
_THIN = 5e-4


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Separation:
    """A way out of an overlap: the second shape, moved by ``depth`` along ``normal``, no longer meets the first.

    If both shapes are convex, the depth is the penetration depth (EPA, to 1e-6 of the robot's size). Otherwise it is the
    shortest of the ways that were tried, which is the penetration depth or longer: directions are spread evenly, and each way
    is followed until a plane separates the shapes. It is 0 where a shift by `ROUNDING` of the smaller shape is enough.
    """

    shapes: tuple[int, int]
    """Indices of the two shapes among those of the `Colliders`."""
    depth: float
    """In m; infinite where it was not needed."""
    normal: Vec3
    """Unit vector."""
    point: Vec3
    """The middle of the region where the surfaces meet (m)."""
    size: float
    """Diameter of the sphere about the smaller shape (m)."""


class Colliders:
    """Shapes on bodies that can be moved and tested for collisions.

    :raises ImportError: when coal is not installed.
    """

    def __init__(self, placed: Sequence[PlacedGeometry]) -> None:
        import coal

        self._coal = coal
        self.placed = tuple(placed)
        boxes = [compute_shape_box(p.geometry) for p in self.placed]
        self._middle = np.array([middle for middle, _, _ in boxes]).reshape(-1, 3)
        self._half = np.array([half for _, half, _ in boxes]).reshape(-1, 3)
        self._radius = np.array([radius for _, _, radius in boxes])
        self._pose = np.array([p.pose for p in self.placed]).reshape(-1, 4, 4)
        self._owner = np.array([p.owner for p in self.placed], dtype=np.int64)
        self._count = np.bincount(self._owner)
        known = np.where(self._radius > 0, self._radius, 1.0)
        self._units = 2.0 ** (_UNIT_STEP * np.round(np.log2(known) / _UNIT_STEP))
        self._functions: dict[tuple[int, int], Any] = {}
        self._request = coal.CollisionRequest()
        # Without contacts coal 3.0.3 misses some shapes that lie deep in others, with their axes in line.
        self._request.enable_contact = True
        self._result = coal.CollisionResult()

    @cached_property
    def spheres(self) -> dict[int, tuple[Vec3, float]]:
        """Centre (3,) and radius (m) of a sphere about all shapes of each body that has shapes, in the body's frame."""
        spheres: dict[int, tuple[Vec3, float]] = {}
        for owner in dict.fromkeys(self._owner.tolist()):
            shapes = self._owner == owner
            pose, radii = self._pose[shapes], self._radius[shapes]
            centres = np.einsum("sij,sj->si", pose[:, :3, :3], self._middle[shapes]) + pose[:, :3, 3]
            low, high = (centres - radii[:, None]).min(axis=0), (centres + radii[:, None]).max(axis=0)
            middle = (low + high) / 2
            reach = np.linalg.norm(centres - middle, axis=1) + radii
            spheres[owner] = (middle, float(reach.max()))
        return spheres

    def detect_collisions(self, frames: Array, pairs: Indices) -> Bools:
        """Return which pairs of bodies meet in which configurations (K, N).

        Faces in one plane count as meeting unless one shape's box lies on one side of it, to within `ROUNDING`.
        ``frames`` (N, B, 4, 4): placements of the bodies in one common frame; ``pairs`` (K, 2) of bodies that have shapes.
        """
        collides = np.zeros((len(pairs), len(frames)), dtype=bool)
        if not len(pairs):
            return collides
        step = max(1, _BATCH_SIZE // len(pairs))
        for start in range(0, len(frames), step):
            part = slice(start, start + step)
            near = self.find_candidate_pairs(frames[part], pairs)
            for row, (k, n) in enumerate(zip(near.pair.tolist(), near.pose.tolist(), strict=True)):
                if not collides[k, start + n] and near.has_collision(row):
                    collides[k, start + n] = True
        return collides

    def detect_collisions_per_pair(self, frames: Array, pairs: Indices) -> Bools:
        """Return which pairs of bodies meet, each in its own configuration (K,): ``frames`` (K, B, 4, 4), ``pairs`` (K, 2)."""
        each = np.arange(len(pairs))
        near = self._filter_shape_pairs(frames, pairs, pair=each, pose=each)
        collides = np.zeros(len(pairs), dtype=bool)
        for row, k in enumerate(near.pair.tolist()):
            if not collides[k]:
                collides[k] = near.has_collision(row)
        return collides

    def find_candidate_pairs(self, frames: Array, pairs: Indices) -> CandidatePairs:
        """Return the pairs of shapes that spheres and boxes cannot separate; arguments as for `detect_collisions`."""
        bodies, place = np.unique(pairs, return_inverse=True)
        first, second = place.reshape(-1, 2).T
        middles = np.array([self.spheres[b][0] for b in bodies.tolist()]).reshape(-1, 3)
        radii = np.array([self.spheres[b][1] for b in bodies.tolist()])
        placed = frames[:, bodies]
        at = np.einsum("nbij,bj->bni", placed[..., :3, :3], middles) + np.swapaxes(placed[..., :3, 3], 0, 1)
        near = []
        step = max(1, _BATCH_SIZE // max(1, len(frames)))
        for start in range(0, max(1, len(pairs)), step):
            one, other = first[start : start + step], second[start : start + step]
            apart = at[one] - at[other]
            touch = ((radii[one] + radii[other]) ** 2)[:, None] >= np.einsum("kni,kni->kn", apart, apart)
            pair, pose = np.nonzero(touch)
            near.append((pair + start, pose))
        pair, pose = (np.concatenate(rows) for rows in zip(*near, strict=True))
        return self._filter_shape_pairs(frames, pairs, pair=pair, pose=pose)

    def _filter_shape_pairs(self, frames: Array, pairs: Indices, *, pair: Indices, pose: Indices) -> CandidatePairs:
        """Return the shapes of pairs ``pair`` (M,), each in configuration ``pose`` (M,), that spheres and boxes about them cannot
        separate."""
        shapes = np.flatnonzero(np.isin(self._owner, pairs[pair]))
        column = np.zeros(len(self.placed), dtype=np.int64)
        column[shapes] = np.arange(len(shapes))
        placed = frames[:, self._owner[shapes]] @ self._pose[shapes]
        turns, at = placed[..., :3, :3], placed[..., :3, 3]
        centres = np.einsum("nsij,sj->nsi", turns, self._middle[shapes]) + at
        batches = []
        for part in self._split_into_batches(pairs[pair]):
            k, n, one, other = self._expand_shape_pairs(pairs, pair[part], pose[part])
            apart = centres[n, column[other]] - centres[n, column[one]]
            near = np.einsum("mi,mi->m", apart, apart) <= (self._radius[one] + self._radius[other]) ** 2
            k, n, one, other, apart = k[near], n[near], one[near], other[near], apart[near]
            near = detect_box_overlap(
                turn_a=turns[n, column[one]],
                half_a=self._half[one],
                turn_b=turns[n, column[other]],
                half_b=self._half[other],
                centre_offsets=apart,
                slack=self._compute_rounding(one, other),
            )
            batches.append((k[near], n[near], one[near], other[near]))
        k, n, one, other = (np.concatenate(rows) for rows in zip(*batches, strict=True))
        return CandidatePairs(
            self,
            pair=k,
            pose=n,
            one=one,
            other=other,
            one_column=column[one],
            other_column=column[other],
            turns=turns,
            at=at,
        )

    def _split_into_batches(self, pairs: Indices) -> list[slice]:
        """Return runs of pairs of bodies whose shapes make no more than `_BATCH_SIZE` pairs or so."""
        one, other = self._count[pairs].T
        part = np.cumsum(one * other) // _BATCH_SIZE
        starts = [0, *(np.flatnonzero(np.diff(part)) + 1).tolist()]
        return [slice(start, end) for start, end in zip(starts, [*starts[1:], len(pairs)], strict=True)]

    def _expand_shape_pairs(self, pairs: Indices, pair: Indices, pose: Indices) -> tuple[Any, ...]:
        """Expand pairs of bodies into pairs of shapes: the pair's index, the configuration, the two shapes."""
        order = np.argsort(self._owner, kind="stable")
        count = self._count
        first = np.cumsum(count) - count
        one, other = pairs[pair].T
        many = count[one] * count[other]
        item = np.repeat(np.arange(len(pair)), many)
        within = np.arange(len(item)) - np.repeat(np.cumsum(many) - many, many)
        shape, mate = np.divmod(within, count[other][item])
        return pair[item], pose[item], order[first[one][item] + shape], order[first[other][item] + mate]

    def _has_collision(self, one: int, other: int, *, at_one: Any, at_other: Any) -> bool:
        """Whether two shapes meet, as coal computes it; ``at_one``, ``at_other``: coal's transforms."""
        key = (one, other)
        if key not in self._functions:
            if len(self._functions) >= _MOST_FUNCTIONS:
                self._functions.clear()
            unit = self._get_unit(one, other)
            self._functions[key] = self._coal.ComputeCollision(
                self._get_coal_geometry(one, unit), self._get_coal_geometry(other, unit)
            )
        self._result.clear()
        return bool(self._functions[key](at_one, at_other, self._request, self._result))

    def _has_collision_at(self, one: int, other: int, *, at_one: Mat4, at_other: Mat4) -> bool:
        """Whether two shapes that are placed in one frame meet, as coal computes it."""
        ends = (_to_coal_transform(self._coal, at, self._get_unit(one, other)) for at in (at_one, at_other))
        return self._has_collision(one, other, at_one=next(ends), at_other=next(ends))

    def find_deepest_overlap(
        self, frames: Array, one: int, other: int, *, with_depth: bool = True
    ) -> Separation | None:
        """Find the deepest overlap of the shapes of two bodies; None if none meet. ``frames`` (B, 4, 4): see `detect_collisions`.

        With ``with_depth``, closed meshes that share no volume have a depth of 0. Without it only whether shapes meet matters,
        and which; a depth that is not needed to find which of them overlap most is infinite then.
        """
        deepest: Separation | None = None
        mates = product(np.flatnonzero(self._owner == one).tolist(), np.flatnonzero(self._owner == other).tolist())
        placed = [(a, self._compute_shape_pose(frames, a), b, self._compute_shape_pose(frames, b)) for a, b in mates]
        meeting = [
            (a, at_a, b, at_b)
            for a, at_a, b, at_b in placed
            if np.linalg.norm(self._compute_shape_centre(a, at_a) - self._compute_shape_centre(b, at_b))
            <= self._radius[a] + self._radius[b]
            and self._has_collision_at(a, b, at_one=at_a, at_other=at_b)
        ]
        for a, at_a, b, at_b in meeting:
            way = self._compute_separation(a, b, at_one=at_a, at_other=at_b, with_depth=with_depth or len(meeting) > 1)
            if way is not None and with_depth and self._do_only_touch(a, b, at_one=at_a, at_other=at_b):
                way = replace(way, depth=0.0)
            if way is not None and (deepest is None or way.depth > deepest.depth):
                deepest = way
        return deepest

    def do_surfaces_meet(self, frames: Array, one: int, other: int) -> bool:
        """Whether shapes of two bodies meet otherwise than by lying wholly inside a convex mesh, whose surface they do not reach.

        A convex mesh is solid here. To MoveIt's FCL it is triangles, with nothing between them.
        """
        mates = product(np.flatnonzero(self._owner == one).tolist(), np.flatnonzero(self._owner == other).tolist())
        for a, b in mates:
            at_a, at_b = self._compute_shape_pose(frames, a), self._compute_shape_pose(frames, b)
            is_hidden = self._is_inside_mesh(a, b, at_one=at_a, at_other=at_b) or self._is_inside_mesh(
                b, a, at_one=at_b, at_other=at_a
            )
            if not is_hidden and self._has_collision_at(a, b, at_one=at_a, at_other=at_b):
                return True
        return False

    def _is_inside_mesh(self, one: int, other: int, *, at_one: Mat4, at_other: Mat4) -> bool:
        """Whether the first of two shapes is wholly inside the second, a convex mesh."""
        mesh = self.placed[other].geometry
        if mesh.vertices is None or mesh.faces is None or self._is_surface(other):
            return False
        to_mesh = np.linalg.inv(at_other) @ at_one
        corners = self.placed[one].geometry.corners @ to_mesh[:3, :3].T + to_mesh[:3, 3]
        a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
        normals = np.cross(b - a, c - a)
        level = np.einsum("ij,ij->i", normals, a)
        inwards = np.sign(normals @ mesh.vertices.mean(axis=0) - level)
        return bool((((corners @ normals.T) - level) * inwards > 0.0).all(where=inwards != 0.0))

    def count_contacts(self, frames: Array, one: int, other: int, most: int) -> int:
        """Count coal's contacts of two bodies, up to ``most`` for each two shapes; of meshes, the triangles that cross.

        ``frames`` (B, 4, 4): see `detect_collisions`.
        """
        mates = product(np.flatnonzero(self._owner == one).tolist(), np.flatnonzero(self._owner == other).tolist())
        count = 0
        for a, b in mates:
            at_a, at_b = self._compute_shape_pose(frames, a), self._compute_shape_pose(frames, b)
            apart = np.linalg.norm(self._compute_shape_centre(a, at_a) - self._compute_shape_centre(b, at_b))
            if apart <= self._radius[a] + self._radius[b]:
                count += len(self._list_contacts(a, b, at_one=at_a, at_other=at_b, most=most))
        return count

    def _compute_shape_pose(self, frames: Array, shape: int) -> Array:
        at: Array = frames[self._owner[shape]] @ self._pose[shape]
        return at

    def _compute_shape_centre(self, shape: int, at: Array) -> Array:
        centre: Array = at[:3, :3] @ self._middle[shape] + at[:3, 3]
        return centre

    def _compute_separation(
        self, one: int, other: int, *, at_one: Mat4, at_other: Mat4, with_depth: bool
    ) -> Separation | None:
        """Compute how to free the second of two shapes; None if they do not meet."""
        solid = not (self._is_surface(one) or self._is_surface(other))
        most = 1 if solid else _MOST_CONTACTS if with_depth else _PIERCING_CONTACTS
        contacts = self._list_contacts(one, other, at_one=at_one, at_other=at_other, most=most)
        if not contacts:
            return None
        rounding = float(self._compute_rounding(one, other))
        unit = self._get_unit(one, other)
        point = np.mean([c.pos for c in contacts], axis=0) * unit
        if not np.isfinite(point).all():
            point = (at_one[:3, 3] + at_other[:3, 3]) / 2

        def separate_by(depth: float, normal: Vec3) -> Separation:
            size = 2 * float(min(self._radius[one], self._radius[other]))
            return Separation(shapes=(one, other), depth=depth, normal=normal, point=point, size=size)

        if solid:
            depth, normal = -contacts[0].penetration_depth * unit, np.array(contacts[0].normal)
            # Where EPA fails, it reports a depth of 1e308 and a normal that is not finite.
            if np.isfinite(normal).all() and depth <= 2 * (self._radius[one] + self._radius[other]):
                return separate_by(depth if depth > rounding else 0.0, normal)
        if not with_depth and self._has_piercing_triangles(
            one, other, at_one=at_one, at_other=at_other, contacts=contacts, rounding=rounding
        ):
            return separate_by(math.inf, np.zeros(3))

        def is_free(shift: Vec3) -> bool:
            moved = at_other.copy()
            moved[:3, 3] += shift
            return not self._has_collision_at(one, other, at_one=at_one, at_other=moved)

        depth, normal = find_separating_translation(
            self.placed[one].geometry.corners @ at_one[:3, :3].T + at_one[:3, 3],
            self.placed[other].geometry.corners @ at_other[:3, :3].T + at_other[:3, 3],
            np.concatenate([spread_directions_and_axes(DIRECTIONS) @ at[:3, :3].T for at in (at_one, at_other)]),
            is_free=is_free,
            rounding=rounding,
            with_depth=with_depth,
        )
        return separate_by(depth, normal)

    def _do_only_touch(self, one: int, other: int, *, at_one: Mat4, at_other: Mat4) -> bool:
        """Whether two closed meshes that meet share no volume: where they interlock, no short way leads out."""
        if not all(self._is_surface(shape) and self.placed[shape].geometry.closed for shape in (one, other)):
            return False
        contacts = self._list_contacts(one, other, at_one=at_one, at_other=at_other, most=_MOST_CONTACTS)
        thin = _THIN * 2 * float(min(self._radius[one], self._radius[other]))
        if self._has_piercing_triangles(one, other, at_one=at_one, at_other=at_other, contacts=contacts, rounding=thin):
            return False
        return not do_share_volume(self._place_triangles(one, at_one), self._place_triangles(other, at_other), thin)

    def _place_triangles(self, shape: int, at: Mat4, chosen: Any = slice(None)) -> Array:
        """Return triangles (F, 3, 3) of a mesh where it is placed, those of the ``chosen`` faces."""
        geometry = self.placed[shape].geometry
        assert geometry.vertices is not None  # a surface is made of a mesh
        assert geometry.faces is not None
        triangles: Array = geometry.vertices[geometry.faces[chosen]] @ at[:3, :3].T + at[:3, 3]
        return triangles

    def _list_contacts(self, one: int, other: int, *, at_one: Mat4, at_other: Mat4, most: int) -> list[Any]:
        """List up to ``most`` of coal's contacts of two shapes."""
        request, result = self._coal.CollisionRequest(), self._coal.CollisionResult()
        request.num_max_contacts = most
        unit = self._get_unit(one, other)
        self._coal.collide(
            self._get_coal_geometry(one, unit),
            _to_coal_transform(self._coal, at_one, unit),
            self._get_coal_geometry(other, unit),
            _to_coal_transform(self._coal, at_other, unit),
            request,
            result,
        )
        return [result.getContact(i) for i in range(result.numContacts())]

    def _has_piercing_triangles(
        self, one: int, other: int, *, at_one: Mat4, at_other: Mat4, contacts: Sequence[Any], rounding: float
    ) -> bool:
        """Whether triangles that meet pierce each other so far that no shift by ``rounding`` (m) separates them."""
        if not (self._is_surface(one) and self._is_surface(other)):
            return False
        mine = self._place_triangles(one, at_one, [c.b1 for c in contacts])
        theirs = self._place_triangles(other, at_other, [c.b2 for c in contacts])
        pierces = find_piercing_edges(mine, theirs, rounding) | find_piercing_edges(theirs, mine, rounding)
        return bool(pierces.any())

    def _compute_rounding(self, one: Any, other: Any) -> Array:
        """Return the overlap (m) that counts as none, for one or several pairs of shapes."""
        smaller: Array = np.minimum(self._radius[one], self._radius[other])
        return ROUNDING * 2 * smaller

    def _get_unit(self, one: int, other: int) -> float:
        """Return coal's unit of length (m) for a pair of shapes."""
        return float(min(self._units[one], self._units[other]))

    def _is_surface(self, shape: int) -> bool:
        return isinstance(self._get_coal_geometry(shape, float(self._units[shape])), self._coal.BVHModelBase)

    def _get_coal_geometry(self, shape: int, unit: float) -> Any:
        """Return coal's geometry of a shape in ``unit`` (m), the same for all that share a `CollisionGeometry`."""
        geometry = self.placed[shape].geometry
        if unit not in geometry.coal_shapes:
            geometry.coal_shapes[unit] = self._build_coal_geometry(geometry, unit)
        return geometry.coal_shapes[unit]

    def _build_coal_geometry(self, geometry: CollisionGeometry, unit: float) -> Any:
        coal, size = self._coal, [s / unit for s in geometry.size]
        if geometry.vertices is None or geometry.faces is None:
            return build_coal_primitive(coal, geometry.kind, size)
        vertices = np.ascontiguousarray(geometry.vertices / unit)
        # Around each corner of a closed mesh there are as many triangles as neighbours.
        has_few_neighbours = np.bincount(geometry.faces.ravel()).max(initial=0) <= _MOST_NEIGHBOURS
        if geometry.closed and has_few_neighbours and is_convex(geometry.vertices, geometry.faces):
            points, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
            points.extend(list(vertices))
            triangles.extend([coal.Triangle(*face) for face in geometry.faces.tolist()])
            return coal.Convex(points, triangles)
        return fill_coal_tree(coal.BVHModelOBB(), vertices, geometry.faces)


class CandidatePairs:
    """Shapes ``one`` (M,) and ``other`` (M,) that may meet, of pair ``pair`` (M,) in configuration ``pose`` (M,)."""

    def __init__(
        self,
        colliders: Colliders,
        *,
        pair: Indices,
        pose: Indices,
        one: Indices,
        other: Indices,
        one_column: Indices,
        other_column: Indices,
        turns: Array,
        at: Array,
    ) -> None:
        """``one_column``, ``other_column`` (M,): the columns of the shapes in ``turns`` (N, S, 3, 3) and ``at`` (N, S, 3), m."""
        self.pair, self.pose, self.one, self.other = pair, pose, one, other
        self._colliders = colliders
        self._one_column, self._other_column = one_column, other_column
        self._turns, self._at = turns, at
        self._transforms: dict[tuple[int, int, float], Any] = {}

    def has_collision(self, row: int) -> bool:
        """Whether the two shapes meet, as coal computes it."""
        n, one, other = int(self.pose[row]), int(self.one[row]), int(self.other[row])
        unit = self._colliders._get_unit(one, other)
        return self._colliders._has_collision(
            one,
            other,
            at_one=self._get_coal_transform(n, int(self._one_column[row]), unit),
            at_other=self._get_coal_transform(n, int(self._other_column[row]), unit),
        )

    def _get_coal_transform(self, configuration: int, column: int, unit: float) -> Any:
        key = (configuration, column, unit)
        if key not in self._transforms:
            at = self._at[configuration, column] / unit
            self._transforms[key] = self._colliders._coal.Transform3s(self._turns[configuration, column], at)
        return self._transforms[key]


def _to_coal_transform(coal: Any, matrix: Mat4, unit: float) -> Any:
    """Return coal's transform of a placement whose lengths are in m, in ``unit`` (m)."""
    return coal.Transform3s(np.ascontiguousarray(matrix[:3, :3]), matrix[:3, 3] / unit)


def list_all_pairs(count: int) -> Indices:
    """List all pairs (K, 2) of ``count`` indices, the lower first."""
    return np.column_stack(np.triu_indices(count, 1))
