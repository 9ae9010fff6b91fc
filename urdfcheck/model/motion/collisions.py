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

from urdfcheck.core import Location, Unavailable
from urdfcheck.core.text import listed
from urdfcheck.facts.motion.collision import ROUNDING, Colliders, Geometry, Placed, all_pairs, least_distance, swept
from urdfcheck.facts.motion.kinematics import motions
from urdfcheck.model.meshes import MEASURING
from urdfcheck.model.motion import poses
from urdfcheck.model.motion.poses import Poses
from urdfcheck.model.parts import Joint, Link, Shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.bounds import UPRIGHT
from urdfcheck.system.array_cache import origin_of, version_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
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
class Pair:
    """Two links with collision geometry.

    ``links``: their names, the first one nearer to the root (tree order). ``relation``: ``fixed``, both belong to one rigid
    body; ``adjacent``, one body hangs on the other by ``joint``, or by several joints with no collision geometry between
    them, of which it is the last (a ball joint written as three hinges); ``far``, all others.

    ``by_default``: whether they meet at the neutral pose. ``contact``: how they meet there, None where they do not or the
    relation is ``fixed``. ``complete``: no shape of either link had to be left out (see `Collisions.left_out`); otherwise
    they may meet where nothing was found.
    """

    links: tuple[str, str]
    relation: Relation
    joint: str | None
    by_default: bool
    contact: Contact | None
    complete: bool
    _place: int
    _collisions: Collisions

    @property
    def hits(self) -> NDArray[np.bool_]:
        """Whether they meet in each of the sampled configurations of `Collisions.poses` (N,), of which the first is the
        neutral one; faces in one plane may count.

        Those of the far pairs that overlap at the neutral pose are looked for together, when one of them is asked for; when
        any other is, those of all pairs are.
        """
        return self._collisions.hits_of(self._place)

    @property
    def share_of_range(self) -> float:
        """Of neighbours that overlap at the neutral pose: in which part of `Collisions.positions` they meet."""
        return self._collisions.share_of_range(self._place)

    @property
    def never_proven(self) -> bool:
        """Whether spheres about their shapes, swept along the chain of joints over the joints' ranges, do not reach each
        other: they cannot meet in any configuration. Or they are one body, and do not meet."""
        return self.complete and bool(self._collisions.never[self._place])

    @property
    def count(self) -> int:
        """In how many of the sampled configurations they meet."""
        return int(self.hits.sum())

    @property
    def share(self) -> float:
        """The part of the sampled configurations in which they meet."""
        return self.count / len(self.hits)

    @property
    def always(self) -> bool:
        """Whether they meet in every sampled configuration."""
        return bool(self.hits.all())

    @property
    def never_seen(self) -> bool:
        """Whether they meet in no sampled configuration; `never_proven` says whether that is a proof."""
        return not self.hits.any()

    @property
    def first(self) -> int | None:
        """The first sampled configuration in which they meet."""
        return int(self.hits.argmax()) if self.hits.any() else None


@dataclass(frozen=True, slots=True, eq=False)
class Reach:
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
class Collisions:
    """The self-collisions of a robot.

    ``bench``: what they are computed with; ``entry``: where results are kept; ``at_rest``: what `_at_rest` found.
    """

    bench: Bench
    entry: MutableMapping[str, Arrays]
    at_rest: Arrays

    @property
    def samples(self) -> int:
        """N, the number of configurations that are looked at."""
        return max(1, self.bench.model.samples)

    @cached_property
    def poses(self) -> Poses:
        """The N configurations, the first of them neutral."""
        return poses.sampled(self.bench.model, self.samples)

    @cached_property
    def positions(self) -> Poses:
        """Fewer configurations (N/5, J), which are spread evenly over the range of each joint (a Latin hypercube, McKay,
        Beckman and Conover, 1979): enough for neighbours, which a single joint usually moves."""
        return _spread(self.bench.model, max(1, self.samples // 5))

    @cached_property
    def left_out(self) -> tuple[Shape, ...]:
        """Collision shapes that could not be placed (a mesh that cannot be read, a malformed number, a kind of geometry that
        is not known)."""
        return tuple(shape for _, shape in self.bench.missing)

    @cached_property
    def pairs(self) -> tuple[Pair, ...]:
        """All pairs of links with collision geometry that could be read, in tree order."""
        bench, arrays = self.bench, self.at_rest
        contacts = {k: _contact(bench, arrays, i) for i, k in enumerate(arrays["contacts"].tolist())}
        met, partial = set(arrays["met"].tolist()), {name for name, _ in bench.missing}
        names = [link.name for link in bench.links]
        return tuple(
            Pair(
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

    def hits_of(self, place: int) -> NDArray[np.bool_]:
        """Whether the pair at this place meets in each configuration (N,), see `Pair.hits`."""
        row = np.flatnonzero(self._far == place)
        hits: NDArray[np.bool_] = self._hits_far[row[0]] if len(row) else self._hits[place]
        return hits

    @cached_property
    def never(self) -> NDArray[np.bool_]:
        """For each pair, whether it is proven that they meet in no configuration (K,), see `Pair.never_proven`."""
        try:
            known: NDArray[np.bool_] = self.entry["never"]["proven"]
            return known
        except KeyError:
            proven = _proven_apart(self.bench)
            proven[self._fixed] = True
            proven[self.at_rest["met"]] = False
            self.entry["never"] = {"proven": proven}
            return proven

    @cached_property
    def _fixed(self) -> NDArray[np.bool_]:
        return np.array([relation == "fixed" for relation, _ in self.bench.relations], dtype=bool)

    def share_of_range(self, place: int) -> float:
        """The part of the positions in which the neighbours at this place meet, see `Pair.share_of_range`."""
        (row,) = np.flatnonzero(self._overlapping("adjacent") == place)
        return float(self._hits_neighbours[row].mean())

    def _overlapping(self, relation: Relation) -> NDArray[np.int64]:
        """The places of the pairs of this relation that overlap at the neutral pose."""
        places: NDArray[np.int64] = self.at_rest["contacts"][self.at_rest["depth"] > 0]
        wanted: NDArray[np.int64] = places[[self.bench.relations[k][0] == relation for k in places.tolist()]]
        return wanted

    @cached_property
    def _hits_neighbours(self) -> NDArray[np.bool_]:
        return self._kept("neighbours", self._overlapping("adjacent"), lambda: self.positions)

    @cached_property
    def _far(self) -> NDArray[np.int64]:
        return self._overlapping("far")

    @cached_property
    def _hits_far(self) -> NDArray[np.bool_]:
        return self._kept("far", self._far, lambda: self.poses)

    @cached_property
    def _hits(self) -> NDArray[np.bool_]:
        """(K, N)."""
        _ = self.poses  # too many joints are told before anything is computed
        found = np.zeros((len(self._fixed), self.samples), dtype=bool)
        found[self.at_rest["met"][self._fixed[self.at_rest["met"]]]] = True
        others = ~self._fixed & ~self.never
        others[self._far] = False
        found[others] = self._kept("others", np.flatnonzero(others), lambda: self.poses)
        found[self._far] = self._hits_far
        return found

    def _kept(self, name: str, places: NDArray[np.int64], looked_at: Callable[[], Poses]) -> NDArray[np.bool_]:
        """Whether the pairs at these places meet in each of some configurations, looked up or computed."""
        if not len(places):
            return np.zeros((0, self.samples), dtype=bool)
        name = f"{name}-{self.samples}"
        try:
            arrays = self.entry[name]
        except KeyError:
            in_all = looked_at()
            parts = [
                self.bench.colliders.hits(
                    self.bench.placements(Poses(in_all.joints, in_all.values[start : start + _AT_ONCE])),
                    self.bench.pairs[places],
                )
                for start in range(0, len(in_all.values), _AT_ONCE)
            ]
            hits = np.concatenate(parts, axis=1)
            met = np.flatnonzero(hits.any(axis=1))
            arrays = self.entry[name] = {
                "met": met,
                "hits": np.packbits(hits[met], axis=1),
                "count": np.array(hits.shape[1]),
            }
        count = int(arrays["count"])
        found = np.zeros((len(places), count), dtype=bool)
        found[arrays["met"]] = np.unpackbits(arrays["hits"], axis=1, count=count)
        return found


def build(model: Model) -> Collisions:
    """Compare all pairs of links at the neutral pose, or recall the result of an earlier run.

    :raises Unavailable: when coal is not installed, or when the tree, an origin or an axis is broken.
    """
    bench = Bench.of(model)
    entry = model.cache.entry("collision", bench.key())
    try:
        arrays = entry["rest"]
    except KeyError:
        arrays = entry["rest"] = _at_rest(bench)
    return Collisions(bench, entry, arrays)


def ensure_all_read(collisions: Collisions) -> None:
    """:raises Unavailable: when shapes had to be left out, so that a rule that looked at the others is no clean result."""
    if collisions.left_out:
        names = list(dict.fromkeys(shape.element.subject.split("]")[0] + "]" for shape in collisions.left_out))
        raise Unavailable(f"collision shapes could not be read and were left out: {listed(names)}")


def geometry_of(shape: Shape) -> Location:
    """Where the geometry of a shape is typed: the name of its mesh, or the primitive."""
    return shape.mesh.location if shape.mesh is not None else (shape.shape or shape.element).location


@dataclass(frozen=True, eq=False)
class Bench:
    """A robot's collision shapes, ready to be compared.

    ``links`` with shapes in tree order, ``shapes`` that can be placed and the places of the ``owners`` of each, shapes that
    are ``missing`` with the names of their links, ``pairs`` (K, 2) of links by their place, and the ``relations`` of each
    pair with the joint between adjacent ones.
    """

    model: Model
    links: tuple[Link, ...]
    shapes: tuple[Shape, ...]
    owners: tuple[int, ...]
    missing: tuple[tuple[str, Shape], ...]
    pairs: NDArray[np.int64]
    relations: tuple[tuple[Relation, str | None], ...]

    @classmethod
    def of(cls, model: Model) -> Bench:
        """:raises Unavailable: when the tree is broken, or there are more pairs of shapes than are compared."""
        links: list[Link] = []
        shapes: list[Shape] = []
        owners: list[int] = []
        missing = [(link.name, s) for link in model.links for s in link.collisions if not _is_usable(model, s)]
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
            raise Unavailable(f"{compared:,} pairs of shapes may collide, and {MOST_COMPARED:,} are compared at most")
        pairs = all_pairs(len(links))
        relations = tuple(_relations(model, links, pairs))
        return cls(model, tuple(links), tuple(shapes), tuple(owners), tuple(missing), pairs, relations)

    @cached_property
    def colliders(self) -> Colliders:
        """:raises Unavailable: when coal is not installed."""
        known: dict[str, Geometry] = {}
        placed = []
        for shape, owner in zip(self.shapes, self.owners, strict=True):
            content, pose = self._content(shape), shape.origin.matrix
            assert pose is not None
            if content not in known:
                known[content] = _geometry(self.model, shape)
            placed.append(Placed(known[content], owner, pose))
        return _colliders(placed)

    @cached_property
    def lying(self) -> tuple[str | None, ...]:
        """COLLADA's ``<up_axis>`` of each shape's mesh where it is not z, as the file declares it or leaves it at the default."""
        facts = [self.model.meshes.facts_of(shape) for shape in self.shapes]
        return tuple(None if f is None or f.up_axis not in UPRIGHT else f.up_axis for f in facts)

    @cached_property
    def upright(self) -> Colliders:
        """The shapes with every mesh turned so that its up axis is z.

        :raises Unavailable: when coal is not installed.
        """
        placed = []
        for one, shape, up in zip(self.colliders.placed, self.shapes, self.lying, strict=True):
            if up is not None:
                facts, scale = self.model.meshes.facts_of(shape), self.model.drawn_scale(shape)
                assert facts is not None
                vertices = facts.vertices @ UPRIGHT[up].T * np.array(scale)
                one = replace(one, geometry=replace(one.geometry, vertices=vertices))
            placed.append(one)
        return _colliders(placed)

    @cached_property
    def rest_frames(self) -> Mapping[str, Array]:
        """Placement (1, 4, 4) of every link at the neutral pose.

        :raises Unavailable: when an origin or an axis is broken.
        """
        return poses.frames(self.model, poses.neutral(self.model))

    @cached_property
    def at_rest(self) -> Array:
        """Placement (L, 4, 4) of the links with shapes at the neutral pose.

        :raises Unavailable: when an origin or an axis is broken.
        """
        return np.array([self.rest_frames[link.name][0] for link in self.links]).reshape(-1, 4, 4)

    @cached_property
    def spheres(self) -> tuple[Array, Array]:
        """Centres (L, 3) and radii (L,) of spheres about the links at the neutral pose, in root coordinates."""
        own = [self.colliders.spheres[i] for i in range(len(self.links))]
        centres = np.array([centre for centre, _ in own]).reshape(-1, 3)
        placed = np.einsum("lij,lj->li", self.at_rest[:, :3, :3], centres) + self.at_rest[:, :3, 3]
        return placed, np.array([radius for _, radius in own])

    @cached_property
    def above(self) -> tuple[frozenset[str], ...]:
        """The names of the joints between the root and each link."""
        return tuple(frozenset(joint.name for joint in self.model.tree.path(link.name)) for link in self.links)

    def key(self) -> str:
        """A digest of all that decides about collisions: shapes, placements, joints, and the code that compares them."""
        words = [version_of(*_COMPARING, library=origin_of("coal"))]
        words += [link.name for link in self.links]
        for shape, owner in zip(self.shapes, self.owners, strict=True):
            pose = shape.origin.matrix
            words.append(f"{owner} {self._content(shape)} {None if pose is None else pose.tolist()}")
        for name in self.model.tree.order[1:]:
            joint = self.model.tree.parent_joint[name]
            placed = joint.origin.matrix
            mimic = None if joint.mimic is None else [(a.name, a.value) for a in joint.mimic.attributes.values()]
            words.append(
                f"{joint.parent} {name} {joint.name} {joint.type} {None if placed is None else placed.tolist()} "
                f"{joint.axis} {poses.limits(joint)} {mimic}"
            )
        return hashlib.sha256("\0".join(words).encode()).hexdigest()

    def placements(self, looked_at: Poses) -> Array:
        """Placement (N, L, 4, 4) of the links with shapes in root coordinates.

        :raises Unavailable: when an origin or an axis is broken.
        """
        found = poses.frames(self.model, looked_at)
        placed = [found[link.name] for link in self.links]
        return np.stack(placed, axis=1) if placed else np.zeros((len(looked_at.values), 0, 4, 4))

    def _content(self, shape: Shape) -> str:
        """What a shape is made of, wherever it is."""
        use = self.model.meshes.by_shape.get(id(shape))
        file = None if use is None or use.resource.path is None else self.model.meshes.key(use.resource.path)
        return f"{shape.kind} {self.model.drawn_scale(shape) if shape.kind == 'mesh' else shape.size} {file}"


def _colliders(placed: Sequence[Placed]) -> Colliders:
    try:
        return Colliders(placed)
    except ImportError:
        raise Unavailable("coal is not installed (there are no wheels of it for this platform)") from None


# Configurations whose placements are held at once.
_AT_ONCE = 500
# Pairs of shapes of different links, 2,000 links with one each. Published robots have up to 6,209.
MOST_COMPARED = 2_000_000
# The modules that decide about a result.
_COMPARING = (
    *MEASURING,
    "urdfcheck.facts.motion.collision",
    "urdfcheck.facts.motion.kinematics",
    "urdfcheck.model.shapes",
    "urdfcheck.model.motion.collisions",
    "urdfcheck.model.motion.poses",
    "urdfcheck.model.tree",
    "urdfcheck.model.ground.up_axis",
)


def _is_usable(model: Model, shape: Shape) -> bool:
    """Whether it is known where a shape is and what it looks like."""
    size = model.drawn_scale(shape) if shape.kind == "mesh" else shape.size
    if size is None or shape.origin.matrix is None or shape.kind is None:
        return False
    return all(size) if shape.kind == "mesh" else min(size) > 0


def _geometry(model: Model, shape: Shape) -> Geometry:
    if shape.kind != "mesh":
        return Geometry(shape.kind or "", shape.size or ())
    facts, scale = model.meshes.facts_of(shape), model.drawn_scale(shape)
    assert facts is not None
    assert scale is not None
    return Geometry("mesh", (), facts.vertices * np.array(scale), facts.faces, facts.closed)


def _relations(model: Model, links: Sequence[Link], pairs: NDArray[np.int64]) -> Iterator[tuple[Relation, str | None]]:
    """How the bodies of each pair of links are joined, and by which joint adjacent ones."""
    # A shape that cannot be read still makes its body a solid one.
    solid = frozenset(
        model.tree.body(link.name)[0] for link in model.links if any(shape.kind for shape in link.collisions)
    )
    heads = [model.tree.body(link.name)[0] for link in links]
    parents = {head: _solid_parent(model, head, solid) for head in heads}
    for a, b in pairs.tolist():
        if heads[a] == heads[b]:
            yield "fixed", None
        elif heads[a] == parents[heads[b]]:
            yield "adjacent", model.tree.parent_joint[heads[b]].name
        elif heads[b] == parents[heads[a]]:
            yield "adjacent", model.tree.parent_joint[heads[a]].name
        else:
            yield "far", None


def _solid_parent(model: Model, head: str, solid: frozenset[str]) -> str | None:
    """The nearest body towards the root that has collision geometry; bodies are named by their first links."""
    while head in model.tree.parent_joint:
        head = model.tree.body(model.tree.parent_joint[head].parent)[0]
        if head in solid:
            return head
    return None


def _at_rest(bench: Bench) -> Arrays:
    """What is looked at for every model: the pairs that have ``met`` at the neutral pose; and of those of them that are not
    ``fixed`` (``contacts``) the shapes, depth, normal, point and size."""
    met = np.flatnonzero(bench.colliders.hits(bench.at_rest[None], bench.pairs)[:, 0])
    contacts, ways = [], []
    for k in met.tolist():
        relation, _ = bench.relations[k]
        if relation == "fixed":
            continue
        way = bench.colliders.separation(bench.at_rest, *bench.pairs[k].tolist(), measured=relation == "far")
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


def _spread(model: Model, count: int) -> Poses:
    """``count`` configurations in which each joint that follows none takes values spread evenly over its range, in an order
    of its own."""
    drawn = poses.sampled(model, count + 1)
    ranks = np.argsort(np.argsort(drawn.values[1:], axis=0, kind="stable"), axis=0, kind="stable")
    low, high = np.array([poses.limits(joint) for joint in drawn.joints]).reshape(-1, 2).T
    return poses.following(Poses(drawn.joints, low + (ranks + 0.5) / count * (high - low)))


def _contact(bench: Bench, arrays: Arrays, i: int) -> Contact:
    a, b = arrays["shapes"][i].tolist()
    depth = float(arrays["depth"][i])
    point, normal = (tuple(arrays[name][i].tolist()) for name in ("point", "normal"))
    return Contact((bench.shapes[a], bench.shapes[b]), depth, point, normal, float(arrays["size"][i]), depth == 0.0)


# -- one joint moved alone ----------------------------------------------------------------------------------------------

# Values of a joint that are looked at over its range: every 5.6° of a whole turn.
STEPS = 64
# Halvings of a step, to 1e-3 of the range.
_HALVINGS = 4


def reaches(model: Model) -> tuple[Reach, ...]:
    """What each joint runs into when it moves alone, with its followers: at most one entry per joint and direction.

    Links of adjacent bodies count where they meet from some value on up to the limit: meshes of a bearing that graze each
    other here and there do not, nor do shapes that touch at rest. A collision that lasts less than a step may be missed.

    :raises Unavailable: when coal is not installed, when the tree, an origin or an axis is broken, or when more joints move
        than motion is computed for.
    """
    found = model.collisions
    rest = poses.neutral(model)
    poses.ensure_few(rest.joints)
    try:
        table = found.entry["reach"]["table"]
    except KeyError:
        table = _reaches(found, rest)
        found.entry["reach"] = {"table": table}
    made = []
    for i, k, value, limit in table.tolist():
        pair = found.pairs[int(k)]
        made.append(Reach(rest.joints[int(i)], value, limit, pair.links, pair.relation))
    return tuple(made)


def _width(joint: Joint) -> float:
    lower, upper = poses.limits(joint)
    return upper - lower


def _reaches(found: Collisions, rest: Poses) -> Array:
    """Rows (R, 4): the joint's place, the pair's, the value where they begin to meet, the limit in that direction."""
    bench = found.bench
    below, led = _below_each(bench, rest.joints), _led(rest.joints)
    apart = np.array([not p.by_default and p.relation != "fixed" for p in found.pairs], dtype=bool)
    close = np.array([p.relation == "adjacent" for p in found.pairs], dtype=bool)
    joints, pairs, limits, free, value = [], [], [], [], []
    for i, joint in enumerate(rest.joints):
        if joint.mimic is not None or not _width(joint) > 0:
            continue
        start = float(rest.values[0, i])
        candidates = np.flatnonzero(apart & _affected(bench, below[[i, *led[i]]]))
        if not led[i] and len(candidates):
            candidates = candidates[_in_reach(bench, joint, below[i], start, candidates)]
        if not len(candidates):
            continue
        move = (
            partial(_alone_placed, bench, rest, i) if led[i] else partial(_carried_along, bench, joint, below[i], start)
        )
        neighbours = candidates[close[candidates]]
        candidates = np.setdiff1d(candidates, neighbours[_touching(bench, joint, start, move, neighbours)])
        for limit in poses.limits(joint):
            way = _way(rest, i, limit)
            frames = move(way)
            met = _first_met(bench, frames[1:], candidates, close[candidates])
            if met is not None:
                joints.append(i)
                pairs.append(met[0])
                limits.append(way[-1])
                free.append(way[met[1]])
                value.append(way[met[1] + 1])
    low, high = np.array(free), np.array(value)
    for _ in range(_HALVINGS if joints else 0):
        middle = (low + high) / 2
        frames = bench.placements(_alone(rest, np.array(joints), middle))
        met_there = bench.colliders.hits_each(frames, bench.pairs[pairs])
        low, high = np.where(met_there, low, middle), np.where(met_there, middle, high)
    return np.column_stack((joints, pairs, high, limits)).reshape(-1, 4)


def _touching(
    bench: Bench, joint: Joint, start: float, move: Callable[[Array], Array], pairs: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Whether the shapes of some pairs touch at rest (n,): they meet as soon as one joint turns, whichever way."""
    lower, upper = poses.limits(joint)
    least = _width(joint) / STEPS / 2**_HALVINGS
    if not lower <= start - least < start + least <= upper:
        return np.zeros(len(pairs), dtype=bool)
    back, forth = (
        np.repeat(frame[None], len(pairs), axis=0) for frame in move(np.array([start - least, start + least]))
    )
    either: NDArray[np.bool_] = bench.colliders.hits_each(back, bench.pairs[pairs])
    return either & bench.colliders.hits_each(forth, bench.pairs[pairs])


def _alone_placed(bench: Bench, rest: Poses, joint: int, values: Array) -> Array:
    """Placements (N, L, 4, 4) of the links where one joint stands at some values (N,), with what follows it."""
    return bench.placements(_alone(rest, np.full(len(values), joint), values))


def _carried_along(bench: Bench, joint: Joint, below: NDArray[np.bool_], start: float, values: Array) -> Array:
    """Placements (N, L, 4, 4) of the links where one joint, which nothing follows and on which those ``below`` (L,) hang,
    stands at some values (N,) and not at ``start``."""
    frame = bench.rest_frames[joint.child][0]
    motion = motions(_axis(joint), values - start, rotates=joint.type != "prismatic")
    placed = np.repeat(bench.at_rest[None], len(values), axis=0)
    placed[:, below] = (frame @ motion @ np.linalg.inv(frame))[:, None] @ bench.at_rest[below]
    return placed


def _in_reach(
    bench: Bench, joint: Joint, below: NDArray[np.bool_], start: float, pairs: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Whether spheres about the links of some pairs come to meet (n,) where one joint, which nothing follows and on which
    those ``below`` (L,) hang, is moved alone from its value ``start`` at rest."""
    frame = bench.rest_frames[joint.child][0]
    centres, radii = bench.spheres
    first, second = bench.pairs[pairs].T
    moving, staying = np.where(below[first], first, second), np.where(below[first], second, first)
    lower, upper = (limit - start for limit in poses.limits(joint))
    gap = least_distance(
        centres[moving] - frame[:3, 3],
        centres[staying] - frame[:3, 3],
        frame[:3, :3] @ _axis(joint),
        lower,
        upper,
        rotates=joint.type != "prismatic",
    )
    reached: NDArray[np.bool_] = gap <= (radii[moving] + radii[staying]) * (1 + ROUNDING)
    return reached


def _axis(joint: Joint) -> Array:
    axis = np.array(joint.axis)
    unit: Array = axis / np.linalg.norm(axis)
    return unit


def _way(rest: Poses, joint: int, limit: float) -> Array:
    """The values of a joint from rest to its limit, both included."""
    start = float(rest.values[0, joint])
    return np.linspace(start, limit, 1 + math.ceil(STEPS * abs(limit - start) / _width(rest.joints[joint])))


def _first_met(
    bench: Bench, frames: Array, pairs: NDArray[np.int64], close: NDArray[np.bool_]
) -> tuple[int, int] | None:
    """The first of some pairs that meet on a way, and in which of its configurations; None when none does.

    Pairs that are ``close`` have to meet from there on up to the end of the way: they are followed from its end inwards,
    the others from its beginning up to where one of them meets.
    """
    if not len(frames):
        return None
    near = bench.colliders.near(frames, bench.pairs[pairs])
    rows: dict[tuple[int, int], list[int]] = {}
    for row, key in enumerate(zip(near.pose.tolist(), near.pair.tolist(), strict=True)):
        rows.setdefault(key, []).append(row)
    found: list[tuple[int, int]] = []
    for k in np.flatnonzero(close).tolist():
        first = len(frames)
        while first and any(near.meets(row) for row in rows.get((first - 1, k), ())):
            first -= 1
        if first < len(frames):
            found.append((first, k))
    for n, k in sorted(rows):
        if not close[k] and any(near.meets(row) for row in rows[n, k]):
            found.append((n, k))
            break
    if not found:
        return None
    at, k = min(found)
    return int(pairs[k]), at


def _alone(rest: Poses, joints: NDArray[np.int64], values: Array) -> Poses:
    """The neutral pose n times, each with one of its joints (n,), and what follows it, at a value (n,)."""
    everything = np.repeat(rest.values, len(values), axis=0)
    everything[np.arange(len(values)), joints] = values
    return poses.following(Poses(rest.joints, everything))


def _below_each(bench: Bench, joints: Sequence[Joint]) -> NDArray[np.bool_]:
    """Whether each of the links hangs on each joint (J, L)."""
    below = [[joint.name in names for names in bench.above] for joint in joints]
    return np.array(below, dtype=bool).reshape(len(joints), len(bench.links))


def _affected(bench: Bench, below: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The pairs (K,) whose links some joints that move together move against each other, ``below`` (n, L) as for each."""
    affected = np.zeros(len(bench.pairs), dtype=bool)
    for links in below:
        affected |= links[bench.pairs[:, 0]] != links[bench.pairs[:, 1]]
    return affected


def _led(joints: Sequence[Joint]) -> list[list[int]]:
    """The places of the followers of each joint."""
    led: list[list[int]] = [[] for _ in joints]
    for follower, joint in enumerate(joints):
        leader = _leader(joint, joints)
        if leader is not None:
            led[leader].append(follower)
    return led


def _leader(joint: Joint, joints: Sequence[Joint]) -> int | None:
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


def _proven_apart(bench: Bench) -> NDArray[np.bool_]:
    """For each pair, whether spheres about the shapes of the two links, swept over the ranges of all joints between them and
    the same link, do not reach each other there, for some link (K,).

    Every sphere is carried from its own link to every other, first towards the root, then outwards.
    """
    model, tree = bench.model, bench.model.tree
    count = len(bench.links)
    ranges = _ranges(model)
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
            carried, grown = _carried(joint, ranges, centres[name][inside], radii[name][inside])
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
        centres[name][outside], radii[name][outside] = _carried(
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


def _carried(
    joint: Joint, ranges: Mapping[str, tuple[float, float]], centres: Array, radii: Array, *, inwards: bool = False
) -> tuple[Array, Array]:
    """Spheres swept over a joint's range; ``inwards``: those of the parent's side as the child sees them."""
    if joint.type == "fixed":
        return centres, radii
    if joint.name not in ranges:  # floating, planar
        return centres, np.full(len(radii), np.inf)
    lower, upper = ranges[joint.name]
    return swept(
        centres,
        radii,
        _axis(joint),
        -upper if inwards else lower,
        -lower if inwards else upper,
        rotates=joint.type != "prismatic",
    )


def _ranges(model: Model) -> Mapping[str, tuple[float, float]]:
    """The values that each joint can take: a whole turn or endless where its limits are none, or make no sense."""
    joints = poses.neutral(model).joints
    bounds = []
    for joint in joints:
        lower, upper = poses.limits(joint)
        if joint.type != "continuous" and (joint.limit_value("lower"), joint.limit_value("upper")) != (lower, upper):
            wide = _ENDLESS if joint.type == "prismatic" else poses.TURN
            lower, upper = -wide, wide
        bounds.append((lower, upper))
    ends = poses.following(Poses(joints, np.array(bounds).reshape(-1, 2).T)).values
    return {j.name: (float(ends[:, i].min()), float(ends[:, i].max())) for i, j in enumerate(joints)}
