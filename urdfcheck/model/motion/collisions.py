"""Which links of a robot collide with each other: at rest, over the joints' ranges, and when one joint moves alone."""

from __future__ import annotations

import hashlib
import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, MutableMapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from urdfcheck.core import FactUnavailableError, Location
from urdfcheck.core.text import join_names
from urdfcheck.facts.motion.collision import Colliders, list_all_pairs
from urdfcheck.facts.motion.collision_geometry import ROUNDING, CollisionGeometry, PlacedGeometry
from urdfcheck.facts.motion.kinematics import compute_joint_motions
from urdfcheck.facts.motion.swept_spheres import compute_least_distance, compute_swept_spheres
from urdfcheck.model.meshes import MEASURING_MODULES
from urdfcheck.model.motion import poses
from urdfcheck.model.motion.poses import JointConfigurations
from urdfcheck.model.parts import Joint, Link, Shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.bounds import Z_UP_ROTATIONS
from urdfcheck.system.array_cache import origin_of, version_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from urdfcheck.facts.arrays import Array, Bools, Indices

    Arrays = Mapping[str, NDArray[Any]]

Relation = Literal["fixed", "adjacent", "far"]


@dataclass(frozen=True, slots=True, eq=False)
class Contact:
    """How two links meet at the neutral pose.

    ``shapes``: the two ``<collision>`` elements that overlap most, in the order of the pair's links. ``depth`` (m): moving
    the second shape by so much along ``normal`` (3,) frees it from the first; the shortest such way of those that were
    tried (see `urdfcheck.facts.motion.collision`), hence the penetration depth or a little more. ``point`` (3,): the middle of
    the region where their surfaces meet. Point and normal in root coordinates. Of neighbours, which are expected to overlap,
    the depth is infinite where nothing but whether they overlap was looked at, and the point is one of that region.

    ``size`` (m): the diameter of a sphere about the smaller shape. ``touching``: the depth, then 0, is within what typed
    digits and single precision explain: faces in one plane.
    """

    shapes: tuple[Shape, Shape]
    depth: float
    point: tuple[float, float, float]
    normal: tuple[float, float, float]
    size: float
    touching: bool


@dataclass(frozen=True, slots=True, eq=False)
class CollisionPair:
    """Two links with collision geometry.

    ``links``: their names, the first one nearer to the root (tree order). ``relation``: ``fixed``, both belong to one rigid
    body; ``adjacent``, one body hangs on the other by ``joint``, or by several joints with no collision geometry between
    them, of which it is the last (a ball joint written as three hinges); ``far``, all others.

    ``by_default``: whether they meet at the neutral pose. ``contact``: how they meet there, None where they do not or the
    relation is ``fixed``. ``complete``: no shape of either link had to be left out (see `Collisions.skipped_shapes`); otherwise
    they may meet where nothing was found.
    """

    links: tuple[str, str]
    relation: Relation
    joint: str | None
    meets_at_neutral: bool
    contact: Contact | None
    is_complete: bool
    _index: int
    _collisions: SelfCollisions

    @property
    def hits(self) -> Bools:
        """Whether they meet in each of the sampled configurations of `Collisions.poses` (N,), of which the first is the
        neutral one; faces in one plane may count.

        Those of the far pairs that overlap at the neutral pose are looked for together, when one of them is asked for; when
        any other is, those of all pairs are.
        """
        return self._collisions.get_hits(self._index)

    @property
    def range_share(self) -> float:
        """Of neighbours that overlap at the neutral pose: in which part of `Collisions.spread_poses` they meet."""
        return self._collisions.compute_range_share(self._index)

    @property
    def is_proven_apart(self) -> bool:
        """Whether spheres about their shapes, swept along the chain of joints over the joints' ranges, do not reach each
        other: they cannot meet in any configuration. Or they are one body, and do not meet."""
        return self.is_complete and bool(self._collisions.proven_apart[self._index])

    @property
    def hit_count(self) -> int:
        """In how many of the sampled configurations they meet."""
        return int(self.hits.sum())

    @property
    def hit_share(self) -> float:
        """The part of the sampled configurations in which they meet."""
        return self.hit_count / len(self.hits)

    @property
    def is_always_in_collision(self) -> bool:
        """Whether they meet in every sampled configuration."""
        return bool(self.hits.all())

    @property
    def is_never_in_collision(self) -> bool:
        """Whether they meet in no sampled configuration; `is_proven_apart` says whether that is a proof."""
        return not self.hits.any()

    @property
    def first_hit(self) -> int | None:
        """The first sampled configuration in which they meet."""
        return int(self.hits.argmax()) if self.hits.any() else None


@dataclass(frozen=True, slots=True, eq=False)
class JointCollision:
    """A joint that, moved alone from the neutral pose, drives a link into another one that it did not meet there.

    ``value`` (rad or m): where the collision begins, to 1e-3 of the joint's range; ``limit``: how far the joint goes in
    that direction. ``links``: the two that meet first, in tree order. ``relation`` and ``shapes`` as of a pair's `Contact`.
    """

    joint: Joint
    value: float
    limit: float
    links: tuple[str, str]
    relation: Relation


@dataclass(frozen=True, eq=False)
class SelfCollisions:
    """The self-collisions of a robot.

    ``bench``: what they are computed with; ``entry``: where results are kept; ``at_rest``: what `_compare_at_rest` found.
    """

    setup: CollisionSetup
    cache_entry: MutableMapping[str, Arrays]
    rest_results: Arrays

    @property
    def sample_count(self) -> int:
        """N, the number of configurations that are looked at."""
        return max(1, self.setup.model.samples)

    @cached_property
    def poses(self) -> JointConfigurations:
        """The N configurations, the first of them neutral."""
        return poses.sample_configurations(self.setup.model, self.sample_count)

    @cached_property
    def spread_poses(self) -> JointConfigurations:
        """Fewer configurations (N/5, J), which are spread evenly over the range of each joint (a Latin hypercube, McKay,
        Beckman and Conover, 1979): enough for neighbours, which a single joint usually moves."""
        return _sample_evenly(self.setup.model, max(1, self.sample_count // 5))

    @cached_property
    def skipped_shapes(self) -> tuple[Shape, ...]:
        """Collision shapes that could not be placed (a mesh that cannot be read, a malformed number, a kind of geometry that
        is not known)."""
        return tuple(shape for _, shape in self.setup.unusable_shapes)

    @cached_property
    def pairs(self) -> tuple[CollisionPair, ...]:
        """All pairs of links with collision geometry that could be read, in tree order."""
        bench, arrays = self.setup, self.rest_results
        contacts = {k: _read_contact(bench, arrays, i) for i, k in enumerate(arrays["contacts"].tolist())}
        met, partial = set(arrays["met"].tolist()), {name for name, _ in bench.unusable_shapes}
        names = [link.name for link in bench.links]
        return tuple(
            CollisionPair(
                (names[a], names[b]),
                *relation,
                k in met,
                contacts.get(k),
                names[a] not in partial and names[b] not in partial,
                k,
                self,
            )
            for k, ((a, b), relation) in enumerate(zip(bench.pairs.tolist(), bench.relations, strict=True))
        )

    def get_hits(self, pair_index: int) -> Bools:
        """Whether the pair at this place meets in each configuration (N,), see `Pair.detect_collisions`."""
        row = np.flatnonzero(self._far_overlaps == pair_index)
        hits: Bools = self._far_hits[row[0]] if len(row) else self._all_hits[pair_index]
        return hits

    @cached_property
    def proven_apart(self) -> Bools:
        """For each pair, whether it is proven that they meet in no configuration (K,), see `Pair.is_proven_apart`."""
        try:
            known: Bools = self.cache_entry["never"]["proven"]
            return known
        except KeyError:
            proven = _prove_apart(self.setup)
            proven[self._fixed_mask] = True
            proven[self.rest_results["met"]] = False
            self.cache_entry["never"] = {"proven": proven}
            return proven

    @cached_property
    def _fixed_mask(self) -> Bools:
        return np.array([relation == "fixed" for relation, _ in self.setup.relations], dtype=bool)

    def compute_range_share(self, pair_index: int) -> float:
        """The part of the positions in which the neighbours at this place meet, see `Pair.share_of_range`."""
        (row,) = np.flatnonzero(self._find_overlapping_pairs("adjacent") == pair_index)
        return float(self._neighbour_hits[row].mean())

    def _find_overlapping_pairs(self, relation: Relation) -> Indices:
        """The places of the pairs of this relation that overlap at the neutral pose."""
        places: Indices = self.rest_results["contacts"][self.rest_results["depth"] > 0]
        wanted: Indices = places[[self.setup.relations[k][0] == relation for k in places.tolist()]]
        return wanted

    @cached_property
    def _neighbour_hits(self) -> Bools:
        return self._recall_or_compute_hits(
            "neighbours", self._find_overlapping_pairs("adjacent"), lambda: self.spread_poses
        )

    @cached_property
    def _far_overlaps(self) -> Indices:
        return self._find_overlapping_pairs("far")

    @cached_property
    def _far_hits(self) -> Bools:
        return self._recall_or_compute_hits("far", self._far_overlaps, lambda: self.poses)

    @cached_property
    def _all_hits(self) -> Bools:
        """(K, N)."""
        _ = self.poses  # too many joints are told before anything is computed
        found = np.zeros((len(self._fixed_mask), self.sample_count), dtype=bool)
        found[self.rest_results["met"][self._fixed_mask[self.rest_results["met"]]]] = True
        others = ~self._fixed_mask & ~self.proven_apart
        others[self._far_overlaps] = False
        found[others] = self._recall_or_compute_hits("others", np.flatnonzero(others), lambda: self.poses)
        found[self._far_overlaps] = self._far_hits
        return found

    def _recall_or_compute_hits(
        self, name: str, places: Indices, looked_at: Callable[[], JointConfigurations]
    ) -> Bools:
        """Whether the pairs at these places meet in each of some configurations, looked up or computed."""
        if not len(places):
            return np.zeros((0, self.sample_count), dtype=bool)
        name = f"{name}-{self.sample_count}"
        try:
            arrays = self.cache_entry[name]
        except KeyError:
            in_all = looked_at()
            parts = [
                self.setup.colliders.detect_collisions(
                    self.setup.compute_placements(
                        JointConfigurations(in_all.joints, in_all.values[start : start + _BATCH_SIZE])
                    ),
                    self.setup.pairs[places],
                )
                for start in range(0, len(in_all.values), _BATCH_SIZE)
            ]
            hits = np.concatenate(parts, axis=1)
            met = np.flatnonzero(hits.any(axis=1))
            arrays = self.cache_entry[name] = {
                "met": met,
                "hits": np.packbits(hits[met], axis=1),
                "count": np.array(hits.shape[1]),
            }
        count = int(arrays["count"])
        found = np.zeros((len(places), count), dtype=bool)
        found[arrays["met"]] = np.unpackbits(arrays["hits"], axis=1, count=count)
        return found


def self_collisions(model: Model) -> SelfCollisions:
    """Compare all pairs of links at the neutral pose, or recall the result of an earlier run.

    :raises Unavailable: when coal is not installed, or when the tree, an origin or an axis is broken.
    """
    bench = CollisionSetup.from_model(model)
    entry = model.cache.entry("collision", bench.compute_key())
    try:
        arrays = entry["rest"]
    except KeyError:
        arrays = entry["rest"] = _compare_at_rest(bench)
    return SelfCollisions(bench, entry, arrays)


def ensure_all_shapes_read(collisions: SelfCollisions) -> None:
    """:raises Unavailable: when shapes had to be left out, so that a rule that looked at the others is no clean result."""
    if collisions.skipped_shapes:
        names = list(dict.fromkeys(shape.element.subject.split("]")[0] + "]" for shape in collisions.skipped_shapes))
        raise FactUnavailableError(f"collision shapes could not be read and were left out: {join_names(names)}")


def locate_geometry(shape: Shape) -> Location:
    """Where the geometry of a shape is typed: the name of its mesh, or the primitive."""
    return (
        shape.mesh_filename.location
        if shape.mesh_filename is not None
        else (shape.geometry_element or shape.element).location
    )


@dataclass(frozen=True, eq=False)
class CollisionSetup:
    """A robot's collision shapes, ready to be compared.

    ``links`` with shapes in tree order, ``shapes`` that can be placed and the places of the ``owners`` of each, shapes that
    are ``missing`` with the names of their links, ``pairs`` (K, 2) of links by their place, and the ``relations`` of each
    pair with the joint between adjacent ones.
    """

    model: Model
    links: tuple[Link, ...]
    shapes: tuple[Shape, ...]
    owners: tuple[int, ...]
    unusable_shapes: tuple[tuple[str, Shape], ...]
    pairs: Indices
    relations: tuple[tuple[Relation, str | None], ...]

    @classmethod
    def from_model(cls, model: Model) -> CollisionSetup:
        """:raises Unavailable: when the tree is broken, or there are more pairs of shapes than are compared."""
        links: list[Link] = []
        shapes: list[Shape] = []
        owners: list[int] = []
        missing = [(link.name, s) for link in model.links for s in link.collisions if not _is_usable_shape(model, s)]
        left_out = {id(shape) for _, shape in missing}
        for name in model.tree.order:
            link = model.link_by_name[name]
            usable = [shape for shape in link.collisions if id(shape) not in left_out]
            if usable:
                shapes += usable
                owners += [len(links)] * len(usable)
                links.append(link)
        compared = (len(shapes) ** 2 - sum(count**2 for count in Counter(owners).values())) // 2
        if compared > MOST_COMPARED:
            raise FactUnavailableError(
                f"{compared:,} pairs of shapes may collide, and {MOST_COMPARED:,} are compared at most"
            )
        pairs = list_all_pairs(len(links))
        relations = tuple(_classify_pairs(model, links, pairs))
        return cls(model, tuple(links), tuple(shapes), tuple(owners), tuple(missing), pairs, relations)

    @cached_property
    def colliders(self) -> Colliders:
        """:raises Unavailable: when coal is not installed."""
        known: dict[str, CollisionGeometry] = {}
        placed = []
        for shape, owner in zip(self.shapes, self.owners, strict=True):
            content, pose = self._describe_content(shape), shape.origin.matrix
            assert pose is not None
            if content not in known:
                known[content] = _make_geometry(self.model, shape)
            placed.append(PlacedGeometry(known[content], owner, pose))
        return _make_colliders(placed)

    @cached_property
    def non_z_up(self) -> tuple[str | None, ...]:
        """COLLADA's ``<up_axis>`` of each shape's mesh where it is not z, as the file declares it or leaves it at the default."""
        facts = [self.model.meshes.get_facts(shape) for shape in self.shapes]
        return tuple(None if f is None or f.up_axis not in Z_UP_ROTATIONS else f.up_axis for f in facts)

    @cached_property
    def turned_upright(self) -> Colliders:
        """The shapes with every mesh turned so that its up axis is z.

        :raises Unavailable: when coal is not installed.
        """
        placed = []
        for one, shape, up in zip(self.colliders.placed, self.shapes, self.non_z_up, strict=True):
            if up is not None:
                facts, scale = self.model.meshes.get_facts(shape), self.model.compute_drawn_scale(shape)
                assert facts is not None
                vertices = facts.vertices @ Z_UP_ROTATIONS[up].T * np.array(scale)
                one = replace(one, geometry=replace(one.geometry, vertices=vertices))
            placed.append(one)
        return _make_colliders(placed)

    @cached_property
    def rest_frames(self) -> Mapping[str, Array]:
        """Placement (1, 4, 4) of every link at the neutral pose.

        :raises Unavailable: when an origin or an axis is broken.
        """
        return poses.compute_frames(self.model, poses.make_neutral_configuration(self.model))

    @cached_property
    def rest_placements(self) -> Array:
        """Placement (L, 4, 4) of the links with shapes at the neutral pose.

        :raises Unavailable: when an origin or an axis is broken.
        """
        return np.array([self.rest_frames[link.name][0] for link in self.links]).reshape(-1, 4, 4)

    @cached_property
    def spheres(self) -> tuple[Array, Array]:
        """Centres (L, 3) and radii (L,) of spheres about the links at the neutral pose, in root coordinates."""
        own = [self.colliders.spheres[i] for i in range(len(self.links))]
        centres = np.array([centre for centre, _ in own]).reshape(-1, 3)
        placed = np.einsum("lij,lj->li", self.rest_placements[:, :3, :3], centres) + self.rest_placements[:, :3, 3]
        return placed, np.array([radius for _, radius in own])

    @cached_property
    def joints_above(self) -> tuple[frozenset[str], ...]:
        """The names of the joints between the root and each link."""
        return tuple(frozenset(joint.name for joint in self.model.tree.find_path_to(link.name)) for link in self.links)

    def compute_key(self) -> str:
        """A digest of all that decides about collisions: shapes, placements, joints, and the code that compares them."""
        words = [version_of(*_CODE_MODULES, library=origin_of("coal"))]
        words += [link.name for link in self.links]
        for shape, owner in zip(self.shapes, self.owners, strict=True):
            pose = shape.origin.matrix
            words.append(f"{owner} {self._describe_content(shape)} {None if pose is None else pose.tolist()}")
        for name in self.model.tree.order[1:]:
            joint = self.model.tree.parent_joint[name]
            placed = joint.origin.matrix
            mimic = None if joint.mimic is None else [(a.name, a.value) for a in joint.mimic.attributes.values()]
            words.append(
                f"{joint.parent} {name} {joint.name} {joint.type} {None if placed is None else placed.tolist()} "
                f"{joint.axis} {poses.get_sampling_range(joint)} {mimic}"
            )
        return hashlib.sha256("\0".join(words).encode()).hexdigest()

    def compute_placements(self, configurations: JointConfigurations) -> Array:
        """Placement (N, L, 4, 4) of the links with shapes in root coordinates.

        :raises Unavailable: when an origin or an axis is broken.
        """
        found = poses.compute_frames(self.model, configurations)
        placed = [found[link.name] for link in self.links]
        return np.stack(placed, axis=1) if placed else np.zeros((len(configurations.values), 0, 4, 4))

    def _describe_content(self, shape: Shape) -> str:
        """What a shape is made of, wherever it is."""
        use = self.model.meshes.by_shape.get(id(shape))
        file = (
            None
            if use is None or use.resource.path is None
            else self.model.meshes.compute_content_key(use.resource.path)
        )
        return f"{shape.kind} {self.model.compute_drawn_scale(shape) if shape.kind == 'mesh' else shape.size} {file}"


def _make_colliders(placed: Sequence[PlacedGeometry]) -> Colliders:
    try:
        return Colliders(placed)
    except ImportError:
        raise FactUnavailableError("coal is not installed (there are no wheels of it for this platform)") from None


# Configurations whose placements are held at once.
_BATCH_SIZE = 500
# Pairs of shapes of different links, 2,000 links with one each. Published robots have up to 6,209.
MOST_COMPARED = 2_000_000
# The modules that decide about a result.
_CODE_MODULES = (
    *MEASURING_MODULES,
    "urdfcheck.facts.motion.collision",
    "urdfcheck.facts.motion.collision_geometry",
    "urdfcheck.facts.motion.kinematics",
    "urdfcheck.facts.motion.swept_spheres",
    "urdfcheck.model.shapes",
    "urdfcheck.model.motion.collisions",
    "urdfcheck.model.motion.poses",
    "urdfcheck.model.tree",
    "urdfcheck.model.ground.up_axis",
)


def _is_usable_shape(model: Model, shape: Shape) -> bool:
    """Whether it is known where a shape is and what it looks like."""
    size = model.compute_drawn_scale(shape) if shape.kind == "mesh" else shape.size
    if size is None or shape.origin.matrix is None or shape.kind is None:
        return False
    return all(size) if shape.kind == "mesh" else min(size) > 0


def _make_geometry(model: Model, shape: Shape) -> CollisionGeometry:
    if shape.kind != "mesh":
        return CollisionGeometry(kind=shape.kind or "", size=shape.size or ())
    facts, scale = model.meshes.get_facts(shape), model.compute_drawn_scale(shape)
    assert facts is not None
    assert scale is not None
    vertices = facts.vertices * np.array(scale)
    return CollisionGeometry(kind="mesh", vertices=vertices, faces=facts.faces, closed=facts.closed)


def _classify_pairs(model: Model, links: Sequence[Link], pairs: Indices) -> Iterator[tuple[Relation, str | None]]:
    """How the bodies of each pair of links are joined, and by which joint adjacent ones."""
    # A shape that cannot be read still makes its body a solid one.
    solid = frozenset(
        model.tree.list_body_links(link.name)[0] for link in model.links if any(shape.kind for shape in link.collisions)
    )
    heads = [model.tree.list_body_links(link.name)[0] for link in links]
    parents = {head: _find_solid_parent(model, head, solid) for head in heads}
    for a, b in pairs.tolist():
        if heads[a] == heads[b]:
            yield "fixed", None
        elif heads[a] == parents[heads[b]]:
            yield "adjacent", model.tree.parent_joint[heads[b]].name
        elif heads[b] == parents[heads[a]]:
            yield "adjacent", model.tree.parent_joint[heads[a]].name
        else:
            yield "far", None


def _find_solid_parent(model: Model, head: str, solid: frozenset[str]) -> str | None:
    """The nearest body towards the root that has collision geometry; bodies are named by their first links."""
    while head in model.tree.parent_joint:
        head = model.tree.list_body_links(model.tree.parent_joint[head].parent)[0]
        if head in solid:
            return head
    return None


def _compare_at_rest(bench: CollisionSetup) -> Arrays:
    """What is looked at for every model: the pairs that have ``met`` at the neutral pose; and of those of them that are not
    ``fixed`` (``contacts``) the shapes, depth, normal, point and size."""
    met = np.flatnonzero(bench.colliders.detect_collisions(bench.rest_placements[None], bench.pairs)[:, 0])
    contacts, ways = [], []
    for k in met.tolist():
        relation, _ = bench.relations[k]
        if relation == "fixed":
            continue
        way = bench.colliders.find_deepest_overlap(
            bench.rest_placements, *bench.pairs[k].tolist(), with_depth=relation == "far"
        )
        if way is not None:
            contacts.append(k)
            ways.append(way)
    return {
        "met": met,
        "contacts": np.array(contacts, dtype=np.int64),
        "shapes": np.array([way.shapes for way in ways], dtype=np.int64).reshape(-1, 2),
        "depth": np.array([way.depth for way in ways]),
        "normal": np.array([way.normal for way in ways]).reshape(-1, 3),
        "point": np.array([way.point for way in ways]).reshape(-1, 3),
        "size": np.array([way.size for way in ways]),
    }


def _sample_evenly(model: Model, count: int) -> JointConfigurations:
    """``count`` configurations in which each joint that follows none takes values spread evenly over its range, in an order
    of its own."""
    drawn = poses.sample_configurations(model, count + 1)
    ranks = np.argsort(np.argsort(drawn.values[1:], axis=0, kind="stable"), axis=0, kind="stable")
    low, high = np.array([poses.get_sampling_range(joint) for joint in drawn.joints]).reshape(-1, 2).T
    return poses.apply_mimics(JointConfigurations(drawn.joints, low + (ranks + 0.5) / count * (high - low)))


def _read_contact(bench: CollisionSetup, arrays: Arrays, i: int) -> Contact:
    a, b = arrays["shapes"][i].tolist()
    depth = float(arrays["depth"][i])
    point, normal = (tuple(arrays[name][i].tolist()) for name in ("point", "normal"))
    return Contact((bench.shapes[a], bench.shapes[b]), depth, point, normal, float(arrays["size"][i]), depth == 0.0)


# -- one joint moved alone ----------------------------------------------------------------------------------------------

# Values of a joint that are looked at over its range: every 5.6° of a whole turn.
STEPS = 64
# Halvings of a step, to 1e-3 of the range.
_HALVINGS = 4


def find_joint_collisions(model: Model) -> tuple[JointCollision, ...]:
    """What each joint runs into when it moves alone, with its followers: at most one entry per joint and direction.

    Links of adjacent bodies count where they meet from some value on up to the limit: meshes of a bearing that graze each
    other here and there do not, nor do shapes that touch at rest. A collision that lasts less than a step may be missed.

    :raises Unavailable: when coal is not installed, when the tree, an origin or an axis is broken, or when more joints move
        than motion is computed for.
    """
    found = model.collisions
    rest = poses.make_neutral_configuration(model)
    poses.ensure_few_joints(rest.joints)
    try:
        table = found.cache_entry["reach"]["table"]
    except KeyError:
        table = _search_joint_collisions(found, rest)
        found.cache_entry["reach"] = {"table": table}
    made = []
    for i, k, value, limit in table.tolist():
        pair = found.pairs[int(k)]
        made.append(JointCollision(rest.joints[int(i)], value, limit, pair.links, pair.relation))
    return tuple(made)


def _compute_range_width(joint: Joint) -> float:
    lower, upper = poses.get_sampling_range(joint)
    return upper - lower


def _search_joint_collisions(found: SelfCollisions, rest: JointConfigurations) -> Array:
    """Rows (R, 4): the joint's place, the pair's, the value where they begin to meet, the limit in that direction."""
    bench = found.setup
    below, led = _compute_links_below(bench, rest.joints), _list_followers(rest.joints)
    apart = np.array([not p.meets_at_neutral and p.relation != "fixed" for p in found.pairs], dtype=bool)
    close = np.array([p.relation == "adjacent" for p in found.pairs], dtype=bool)
    joints, pairs, limits, free, value = [], [], [], [], []
    for i, joint in enumerate(rest.joints):
        if joint.mimic is not None or not _compute_range_width(joint) > 0:
            continue
        start = float(rest.values[0, i])
        candidates = np.flatnonzero(apart & _find_affected_pairs(bench, below[[i, *led[i]]]))
        if not led[i] and len(candidates):
            candidates = candidates[_find_reachable_pairs(bench, joint, below[i], start, candidates)]
        if not len(candidates):
            continue
        move = (
            partial(_place_joint_alone, bench, rest, i)
            if led[i]
            else partial(_move_links_below, bench, joint, below[i], start)
        )
        neighbours = candidates[close[candidates]]
        candidates = np.setdiff1d(candidates, neighbours[_find_touching_pairs(bench, joint, start, move, neighbours)])
        for limit in poses.get_sampling_range(joint):
            way = _sample_way_to_limit(rest, i, limit)
            frames = move(way)
            met = _find_first_collision(bench, frames[1:], candidates, close[candidates])
            if met is not None:
                joints.append(i)
                pairs.append(met[0])
                limits.append(way[-1])
                free.append(way[met[1]])
                value.append(way[met[1] + 1])
    low, high = np.array(free), np.array(value)
    for _ in range(_HALVINGS if joints else 0):
        middle = (low + high) / 2
        frames = bench.compute_placements(_set_joints_alone(rest, np.array(joints), middle))
        met_there = bench.colliders.detect_collisions_per_pair(frames, bench.pairs[pairs])
        low, high = np.where(met_there, low, middle), np.where(met_there, middle, high)
    return np.column_stack((joints, pairs, high, limits)).reshape(-1, 4)


def _find_touching_pairs(
    bench: CollisionSetup, joint: Joint, start: float, move: Callable[[Array], Array], pairs: Indices
) -> Bools:
    """Whether the shapes of some pairs touch at rest (n,): they meet as soon as one joint turns, whichever way."""
    lower, upper = poses.get_sampling_range(joint)
    least = _compute_range_width(joint) / STEPS / 2**_HALVINGS
    if not lower <= start - least < start + least <= upper:
        return np.zeros(len(pairs), dtype=bool)
    back, forth = (
        np.repeat(frame[None], len(pairs), axis=0) for frame in move(np.array([start - least, start + least]))
    )
    either: Bools = bench.colliders.detect_collisions_per_pair(back, bench.pairs[pairs])
    return either & bench.colliders.detect_collisions_per_pair(forth, bench.pairs[pairs])


def _place_joint_alone(bench: CollisionSetup, rest: JointConfigurations, joint: int, values: Array) -> Array:
    """Placements (N, L, 4, 4) of the links where one joint stands at some values (N,), with what follows it."""
    return bench.compute_placements(_set_joints_alone(rest, np.full(len(values), joint), values))


def _move_links_below(bench: CollisionSetup, joint: Joint, below: Bools, start: float, values: Array) -> Array:
    """Placements (N, L, 4, 4) of the links where one joint, which nothing follows and on which those ``below`` (L,) hang,
    stands at some values (N,) and not at ``start``."""
    frame = bench.rest_frames[joint.child][0]
    motion = compute_joint_motions(_normalize_axis(joint), values - start, rotates=joint.type != "prismatic")
    placed = np.repeat(bench.rest_placements[None], len(values), axis=0)
    placed[:, below] = (frame @ motion @ np.linalg.inv(frame))[:, None] @ bench.rest_placements[below]
    return placed


def _find_reachable_pairs(bench: CollisionSetup, joint: Joint, below: Bools, start: float, pairs: Indices) -> Bools:
    """Whether spheres about the links of some pairs come to meet (n,) where one joint, which nothing follows and on which
    those ``below`` (L,) hang, is moved alone from its value ``start`` at rest."""
    frame = bench.rest_frames[joint.child][0]
    centres, radii = bench.spheres
    first, second = bench.pairs[pairs].T
    moving, staying = np.where(below[first], first, second), np.where(below[first], second, first)
    lower, upper = (limit - start for limit in poses.get_sampling_range(joint))
    gap = compute_least_distance(
        centres[moving] - frame[:3, 3],
        centres[staying] - frame[:3, 3],
        frame[:3, :3] @ _normalize_axis(joint),
        lower=lower,
        upper=upper,
        rotates=joint.type != "prismatic",
    )
    reached: Bools = gap <= (radii[moving] + radii[staying]) * (1 + ROUNDING)
    return reached


def _normalize_axis(joint: Joint) -> Array:
    axis = np.array(joint.axis)
    unit: Array = axis / np.linalg.norm(axis)
    return unit


def _sample_way_to_limit(rest: JointConfigurations, joint: int, limit: float) -> Array:
    """The values of a joint from rest to its limit, both included."""
    start = float(rest.values[0, joint])
    return np.linspace(
        start, limit, 1 + math.ceil(STEPS * abs(limit - start) / _compute_range_width(rest.joints[joint]))
    )


def _find_first_collision(bench: CollisionSetup, frames: Array, pairs: Indices, close: Bools) -> tuple[int, int] | None:
    """The first of some pairs that meet on a way, and in which of its configurations; None when none does.

    Pairs that are ``close`` have to meet from there on up to the end of the way: they are followed from its end inwards,
    the others from its beginning up to where one of them meets.
    """
    if not len(frames):
        return None
    near = bench.colliders.find_candidate_pairs(frames, bench.pairs[pairs])
    rows: dict[tuple[int, int], list[int]] = {}
    for row, key in enumerate(zip(near.pose.tolist(), near.pair.tolist(), strict=True)):
        rows.setdefault(key, []).append(row)
    found: list[tuple[int, int]] = []
    for k in np.flatnonzero(close).tolist():
        first = len(frames)
        while first and any(near.has_collision(row) for row in rows.get((first - 1, k), ())):
            first -= 1
        if first < len(frames):
            found.append((first, k))
    for n, k in sorted(rows):
        if not close[k] and any(near.has_collision(row) for row in rows[n, k]):
            found.append((n, k))
            break
    if not found:
        return None
    at, k = min(found)
    return int(pairs[k]), at


def _set_joints_alone(rest: JointConfigurations, joints: Indices, values: Array) -> JointConfigurations:
    """The neutral pose n times, each with one of its joints (n,), and what follows it, at a value (n,)."""
    everything = np.repeat(rest.values, len(values), axis=0)
    everything[np.arange(len(values)), joints] = values
    return poses.apply_mimics(JointConfigurations(rest.joints, everything))


def _compute_links_below(bench: CollisionSetup, joints: Sequence[Joint]) -> Bools:
    """Whether each of the links hangs on each joint (J, L)."""
    below = [[joint.name in names for names in bench.joints_above] for joint in joints]
    return np.array(below, dtype=bool).reshape(len(joints), len(bench.links))


def _find_affected_pairs(bench: CollisionSetup, below: Bools) -> Bools:
    """The pairs (K,) whose links some joints that move together move against each other, ``below`` (n, L) as for each."""
    affected = np.zeros(len(bench.pairs), dtype=bool)
    for links in below:
        affected |= links[bench.pairs[:, 0]] != links[bench.pairs[:, 1]]
    return affected


def _list_followers(joints: Sequence[Joint]) -> list[list[int]]:
    """The places of the followers of each joint."""
    led: list[list[int]] = [[] for _ in joints]
    for follower, joint in enumerate(joints):
        leader = _find_leader(joint, joints)
        if leader is not None:
            led[leader].append(follower)
    return led


def _find_leader(joint: Joint, joints: Sequence[Joint]) -> int | None:
    """The place of the joint that a follower follows in the end, None for one that follows nothing known."""
    by_name = {j.name: i for i, j in enumerate(joints)}
    if joint.mimic is None:
        return None
    for _ in joints:
        place = by_name.get(joint.mimic.get("joint")) if joint.mimic is not None else None
        if place is None:
            return None
        joint = joints[place]
        if joint.mimic is None:
            return place
    return None


# -- proof that two links never meet -----------------------------------------------------------------------------------

# Stands for "without limit" where numbers are multiplied; m or rad.
_ENDLESS = 1e9


def _prove_apart(bench: CollisionSetup) -> Bools:
    """For each pair, whether spheres about the shapes of the two links, swept over the ranges of all joints between them and
    the same link, do not reach each other there, for some link (K,).

    Every sphere is carried from its own link to every other, first towards the root, then outwards.
    """
    model, tree = bench.model, bench.model.tree
    count = len(bench.links)
    ranges = _compute_joint_ranges(model)
    own = {link.name: i for i, link in enumerate(bench.links)}
    centres = {name: np.zeros((count, 3)) for name in tree.order}
    radii = {name: np.full(count, np.inf) for name in tree.order}
    below = {name: np.zeros(count, dtype=bool) for name in tree.order}
    for name in reversed(tree.order):
        if name in own:
            i = own[name]
            centres[name][i], radii[name][i] = bench.colliders.spheres[i]
            below[name][i] = True
        if name != tree.root:
            joint, inside = tree.parent_joint[name], below[name]
            carried, grown = _sweep_spheres(joint, ranges, centres[name][inside], radii[name][inside])
            placed = joint.origin.matrix
            assert placed is not None
            centres[joint.parent][inside] = carried @ placed[:3, :3].T + placed[:3, 3]
            radii[joint.parent][inside] = grown
            below[joint.parent] |= inside
    for name in tree.order[1:]:
        joint, outside = tree.parent_joint[name], ~below[name]
        placed = joint.origin.matrix
        assert placed is not None
        local = (centres[joint.parent][outside] - placed[:3, 3]) @ placed[:3, :3]
        centres[name][outside], radii[name][outside] = _sweep_spheres(
            joint, ranges, local, radii[joint.parent][outside], inwards=True
        )
    first, second = bench.pairs[:, 0], bench.pairs[:, 1]
    proven = np.zeros(len(bench.pairs), dtype=bool)
    for name in tree.order:
        if name != tree.root and tree.parent_joint[name].type == "fixed":  # as its parent sees it
            continue
        distance = np.linalg.norm(centres[name][first] - centres[name][second], axis=1)
        proven |= distance > (radii[name][first] + radii[name][second]) * (1.0 + ROUNDING)
    return proven


def _sweep_spheres(
    joint: Joint, ranges: Mapping[str, tuple[float, float]], centres: Array, radii: Array, *, inwards: bool = False
) -> tuple[Array, Array]:
    """Spheres swept over a joint's range; ``inwards``: those of the parent's side as the child sees them."""
    if joint.type == "fixed":
        return centres, radii
    if joint.name not in ranges:  # floating, planar
        return centres, np.full(len(radii), np.inf)
    lower, upper = ranges[joint.name]
    return compute_swept_spheres(
        centres,
        radii,
        _normalize_axis(joint),
        lower=-upper if inwards else lower,
        upper=-lower if inwards else upper,
        rotates=joint.type != "prismatic",
    )


def _compute_joint_ranges(model: Model) -> Mapping[str, tuple[float, float]]:
    """The values that each joint can take: a whole turn or endless where its limits are none, or make no sense."""
    joints = poses.make_neutral_configuration(model).joints
    bounds = []
    for joint in joints:
        lower, upper = poses.get_sampling_range(joint)
        if joint.type != "continuous" and (joint.get_limit_value("lower"), joint.get_limit_value("upper")) != (
            lower,
            upper,
        ):
            wide = _ENDLESS if joint.type == "prismatic" else poses.TURN
            lower, upper = -wide, wide
        bounds.append((lower, upper))
    ends = poses.apply_mimics(JointConfigurations(joints, np.array(bounds).reshape(-1, 2).T)).values
    return {j.name: (float(ends[:, i].min()), float(ends[:, i].max())) for i, j in enumerate(joints)}
