"""Which links of a robot collide with each other: at rest, over the joints' ranges, and when one joint moves alone."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

from urdfcheck.cache import version_of
from urdfcheck.core import Location, Unavailable
from urdfcheck.facts.collision import ROUNDING, Colliders, Geometry, Placed, all_pairs, swept
from urdfcheck.model import poses
from urdfcheck.model.body import bodies
from urdfcheck.model.meshes import MEASURING
from urdfcheck.model.model import Model
from urdfcheck.model.names import listed
from urdfcheck.model.parts import Joint, Link, Shape
from urdfcheck.model.poses import Poses

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]
    Arrays = Mapping[str, NDArray[np.generic]]

Relation = Literal["fixed", "adjacent", "far"]


@dataclass(frozen=True, slots=True, eq=False)
class Contact:
    """How two links meet at the neutral pose.

    ``shapes``: the two ``<collision>`` elements that overlap most, in the order of the pair's links. ``depth`` (m): moving
    the second shape by so much along ``normal`` (3,) frees it from the first; the shortest such way of those that were
    tried (see `urdfcheck.facts.collision`), hence the penetration depth or a little more. ``point`` (3,): the middle of
    the region where their surfaces meet. Point and normal in root coordinates.

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

    ``hits`` (N,): whether they meet in each of the sampled configurations of `Collisions.poses`, of which the first is the
    neutral one; faces in one plane may count. ``contact``: how they meet at the neutral pose, None where they do not or the
    relation is ``fixed``. ``never_proven``: spheres about their shapes, swept along the chain of joints over the joints'
    ranges, do not reach each other: they cannot meet in any configuration. ``complete``: no shape of either link had to be
    left out (see `Collisions.left_out`); otherwise they may meet where nothing was found.
    """

    links: tuple[str, str]
    relation: Relation
    joint: str | None
    hits: NDArray[np.bool_]
    contact: Contact | None
    never_proven: bool
    complete: bool

    @property
    def count(self) -> int:
        """In how many of the sampled configurations they meet."""
        return int(self.hits.sum())

    @property
    def share(self) -> float:
        """The part of the sampled configurations in which they meet."""
        return self.count / len(self.hits)

    @property
    def by_default(self) -> bool:
        """Whether they meet at the neutral pose."""
        return bool(self.hits[0])

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


@dataclass(frozen=True, slots=True, eq=False)
class Collisions:
    """The self-collisions of a robot.

    ``bodies``: the links that fixed joints make one, the nearest to the root first. ``poses``: the N configurations that
    were looked at, the first of them neutral. ``pairs``: all pairs of links with collision geometry that could be read, in
    tree order. ``left_out``: collision shapes that could not be placed (a mesh that cannot be read, a malformed number, a
    kind of geometry that is not known). ``bench``: what they were computed with.
    """

    bodies: tuple[tuple[str, ...], ...]
    poses: Poses
    pairs: tuple[Pair, ...]
    left_out: tuple[Shape, ...]
    bench: Bench


def build(model: Model) -> Collisions:
    """Compare all pairs of links in ``model.samples`` configurations, or recall the result of an earlier run.

    :raises Unavailable: when coal is not installed, or when the tree, an origin or an axis is broken.
    """
    bench = Bench.of(model)
    looked_at = poses.sampled(model, model.samples)
    entry = model.cache.entry("collision", bench.key(f"{model.samples}"))
    try:
        arrays = entry["sampled"]
    except KeyError:
        arrays = entry["sampled"] = _sampled(bench, looked_at)
    hits = np.zeros((len(bench.pairs), len(looked_at.values)), dtype=bool)
    hits[arrays["met"]] = np.unpackbits(arrays["hits"], axis=1, count=hits.shape[1])
    contacts = {int(k): i for i, k in enumerate(arrays["contacts"])}
    usable = set(map(id, bench.shapes))
    missing = [(link.name, s) for link in model.links for s in link.collisions if id(s) not in usable]
    partial = {name for name, _ in missing}
    pairs = []
    for k, (a, b) in enumerate(bench.pairs.tolist()):
        links = bench.links[a].name, bench.links[b].name
        relation, joint = bench.relations[k]
        contact = _contact(bench, arrays, contacts[k]) if k in contacts else None
        complete = not partial & set(links)
        pairs.append(Pair(links, relation, joint, hits[k], contact, bool(arrays["never"][k]) and complete, complete))
    left_out = tuple(shape for _, shape in missing)
    return Collisions(tuple(b.links for b in bodies(model)), looked_at, tuple(pairs), left_out, bench)


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

    ``links`` with shapes in tree order, ``shapes`` that can be placed, ``pairs`` (K, 2) of links by their place, and the
    ``relations`` of each pair with the joint between adjacent ones.
    """

    model: Model
    links: tuple[Link, ...]
    shapes: tuple[Shape, ...]
    owners: tuple[int, ...]
    pairs: NDArray[np.int64]
    relations: tuple[tuple[Relation, str | None], ...]

    @classmethod
    def of(cls, model: Model) -> Bench:
        """:raises Unavailable: when the tree is broken."""
        links: list[Link] = []
        shapes: list[Shape] = []
        owners: list[int] = []
        for name in model.tree.order:
            link = model.link_by_name[name]
            usable = [shape for shape in link.collisions if _is_usable(model, shape)]
            if usable:
                shapes += usable
                owners += [len(links)] * len(usable)
                links.append(link)
        pairs = all_pairs(len(links))
        relations = tuple(_relations(model, links, pairs))
        return cls(model, tuple(links), tuple(shapes), tuple(owners), pairs, relations)

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
        try:
            return Colliders(placed)
        except ImportError:
            raise Unavailable("coal is not installed (there are no wheels of it for this platform)") from None

    def key(self, *more: str) -> str:
        """A digest of all that decides about collisions: shapes, placements, joints, and the code that compares them."""
        words = [version_of(*_COMPARING), *more]
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


# Configurations whose placements are held at once.
_AT_ONCE = 500
# The modules that decide about a result.
_COMPARING = (
    *MEASURING,
    "urdfcheck.facts.collision",
    "urdfcheck.facts.kinematics",
    "urdfcheck.model.collisions",
    "urdfcheck.model.poses",
    "urdfcheck.model.tree",
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


def _sampled(bench: Bench, looked_at: Poses) -> Arrays:
    """What `build` keeps: ``never`` (K,); ``met``, the pairs that meet, and their packed ``hits``; and of those that meet
    at the neutral pose and are not ``fixed`` the place, shapes, depth, normal, point and size."""
    rest = bench.placements(Poses(looked_at.joints, looked_at.values[:1]))
    fixed = np.array([relation == "fixed" for relation, _ in bench.relations], dtype=bool)
    never = _proven_apart(bench) & ~fixed
    hits = np.zeros((len(bench.pairs), len(looked_at.values)), dtype=bool)
    hits[fixed] = bench.colliders.hits(rest, bench.pairs[fixed])
    moving = np.flatnonzero(~fixed & ~never)
    for start in range(0, hits.shape[1], _AT_ONCE):
        part = slice(start, start + _AT_ONCE)
        frames = bench.placements(Poses(looked_at.joints, looked_at.values[part]))
        hits[moving, part] = bench.colliders.hits(frames, bench.pairs[moving])
    met = np.flatnonzero(hits.any(axis=1))
    contacts, ways = [], []
    for k in np.flatnonzero(hits[:, 0] & ~fixed).tolist():
        way = bench.colliders.separation(rest[0], *bench.pairs[k].tolist())
        if way is not None:
            contacts.append(k)
            ways.append(way)
    return {
        "never": never | (fixed & ~hits[:, 0]),
        "met": met,
        "hits": np.packbits(hits[met], axis=1),
        "contacts": np.array(contacts, dtype=np.int64),
        "shapes": np.array([way.shapes for way in ways], dtype=np.int64).reshape(-1, 2),
        "depth": np.array([way.depth for way in ways]),
        "normal": np.array([way.normal for way in ways]).reshape(-1, 3),
        "point": np.array([way.point for way in ways]).reshape(-1, 3),
        "size": np.array([way.size for way in ways]),
    }


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
    other here and there do not. A collision that lasts less than a step may be missed.

    :raises Unavailable: when coal is not installed, or when the tree, an origin or an axis is broken.
    """
    found = model.collisions
    bench, rest = found.bench, poses.neutral(model)
    moved = [i for i, joint in enumerate(rest.joints) if joint.mimic is None and _width(joint) > 0]
    entry = model.cache.entry("collision", bench.key("reach"))
    try:
        table = entry["reach"]["table"]
    except KeyError:
        table = _reaches(found, rest, moved)
        entry["reach"] = {"table": table}
    made = []
    for i, k, value, limit in table.tolist():
        pair = found.pairs[int(k)]
        made.append(Reach(rest.joints[int(i)], value, limit, pair.links, pair.relation))
    return tuple(made)


def _width(joint: Joint) -> float:
    lower, upper = poses.limits(joint)
    return upper - lower


def _reaches(found: Collisions, rest: Poses, moved: Sequence[int]) -> Array:
    """Rows (R, 4): the joint's place, the pair's, the value where they begin to meet, the limit in that direction."""
    bench = found.bench
    affected = _affected(bench, rest.joints)
    apart = np.array(
        [not p.by_default and not p.never_proven and p.relation != "fixed" for p in found.pairs], dtype=bool
    )
    close = np.array([p.relation == "adjacent" for p in found.pairs], dtype=bool)
    joints, pairs, limits, free, value = [], [], [], [], []
    for i in moved:
        candidates = np.flatnonzero(apart & affected[i])
        ways = [_way(rest, i, limit) for limit in poses.limits(rest.joints[i])]
        frames = bench.placements(_alone(rest, np.full(sum(map(len, ways)), i), np.concatenate(ways)))
        for way, part in zip(ways, (frames[: len(ways[0])], frames[len(ways[0]) :]), strict=True):
            met = _first_met(bench, part[1:], candidates, close[candidates])
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
        met_there = [bench.colliders.hits(frames[[r]], bench.pairs[[k]])[0, 0] for r, k in enumerate(pairs)]
        low, high = np.where(met_there, low, middle), np.where(met_there, middle, high)
    return np.column_stack((joints, pairs, high, limits)).reshape(-1, 4)


def _way(rest: Poses, joint: int, limit: float) -> Array:
    """The values of a joint from rest to its limit, both included."""
    start = float(rest.values[0, joint])
    return np.linspace(start, limit, 1 + math.ceil(STEPS * abs(limit - start) / _width(rest.joints[joint])))


def _first_met(
    bench: Bench, frames: Array, pairs: NDArray[np.int64], close: NDArray[np.bool_]
) -> tuple[int, int] | None:
    """The first of some pairs that meet on a way, and in which of its configurations; None when none does.

    Pairs that are ``close`` have to meet from there on up to the end of the way."""
    if not len(frames) or not len(pairs):
        return None
    kept = ~close
    kept[close] = bench.colliders.hits(frames[-1:], bench.pairs[pairs[close]])[:, 0]
    pairs, close = pairs[kept], close[kept]
    met = bench.colliders.hits(frames, bench.pairs[pairs])
    met[close] = np.logical_and.accumulate(met[close, ::-1], axis=1)[:, ::-1]
    if not met.any():
        return None
    at = int(met.any(axis=0).argmax())
    return int(pairs[met[:, at].argmax()]), at


def _alone(rest: Poses, joints: NDArray[np.int64], values: Array) -> Poses:
    """The neutral pose n times, each with one of its joints (n,), and what follows it, at a value (n,)."""
    everything = np.repeat(rest.values, len(values), axis=0)
    everything[np.arange(len(values)), joints] = values
    return poses.following(Poses(rest.joints, everything))


def _affected(bench: Bench, joints: Sequence[Joint]) -> NDArray[np.bool_]:
    """For each joint, the pairs (J, K) whose links it moves against each other, by itself or by its followers."""
    tree = bench.model.tree
    above = [{joint.name for joint in tree.path(link.name)} for link in bench.links]
    below = np.array([[joint.name in names for names in above] for joint in joints]).reshape(len(joints), len(above))
    between = below[:, bench.pairs[:, 0]] != below[:, bench.pairs[:, 1]]
    affected: NDArray[np.bool_] = between.copy()
    for follower, joint in enumerate(joints):
        leader = _leader(joint, joints)
        if leader is not None:
            affected[leader] |= between[follower]
    return affected


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
    axis = np.array(joint.axis)
    lower, upper = ranges[joint.name]
    return swept(
        centres,
        radii,
        axis / np.linalg.norm(axis),
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
