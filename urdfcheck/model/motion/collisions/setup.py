"""A robot's collision shapes, ready to be compared, and how the links that own them are related."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.core.records import dataclass
from urdfcheck.facts.motion.collision import Colliders, list_all_pairs
from urdfcheck.facts.motion.collision_geometry import CollisionGeometry, PlacedGeometry
from urdfcheck.model.fact import fact
from urdfcheck.model.meshes import MEASURING_MODULES
from urdfcheck.model.motion import poses
from urdfcheck.model.motion.poses import JointConfigurations
from urdfcheck.model.parts import Joint, Link, Shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.bounds import Z_UP_ROTATIONS
from urdfcheck.model.shapes.mesh_sizes import is_usable_shape
from urdfcheck.model.shapes.solids import compute_drawn_scale
from urdfcheck.system.installation import compute_code_version, describe_left_out, find_library_origin

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Indices

Relation = Literal["fixed", "adjacent", "far"]

# Pairs of shapes of different links; 2,000 links with one shape each reach it. Published robots have up to 6,209.
MOST_COMPARED = 2_000_000
# The modules and packages that decide a cached result.
_CODE_MODULES = (
    *MEASURING_MODULES,
    "urdfcheck.facts.motion.collision",
    "urdfcheck.facts.motion.collision_geometry",
    "urdfcheck.facts.motion.shared_volume",
    "urdfcheck.facts.motion.swept_spheres",
    "urdfcheck.facts.motion.kinematics",
    "urdfcheck.model.shapes",
    "urdfcheck.model.motion.collisions",
    "urdfcheck.model.motion.moveit_pairs",
    "urdfcheck.model.motion.poses",
    "urdfcheck.model.tree",
)


@dataclass(frozen=True, eq=False, kw_only=True)
class CollisionSetup:
    """A robot's collision shapes, ready to be compared."""

    model: Model
    links: tuple[Link, ...]
    """The links that have usable shapes, in tree order."""
    shapes: tuple[Shape, ...]
    """The shapes that can be placed, grouped by link."""
    owners: tuple[int, ...]
    """The index in ``links`` of each shape's link."""
    unusable_shapes: tuple[tuple[str, Shape], ...]
    """The shapes that had to be left out, each with the name of its link."""
    pairs: Indices
    """All pairs of links (K, 2), as indices in ``links``."""
    relations: tuple[tuple[Relation, str | None], ...]
    """How the two links of each pair are related, with the joint between adjacent ones; see `CollisionPair`."""

    @classmethod
    def from_model(cls, model: Model) -> CollisionSetup:
        """Collect the shapes and relate their links.

        :raises FactUnavailableError: when the tree is broken, or there are more pairs of shapes than are compared.
        """
        links: list[Link] = []
        shapes: list[Shape] = []
        owners: list[int] = []
        unusable = [(link.name, s) for link in model.links for s in link.collisions if not is_usable_shape(model, s)]
        left_out = {id(shape) for _, shape in unusable}
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
        return cls(
            model=model,
            links=tuple(links),
            shapes=tuple(shapes),
            owners=tuple(owners),
            unusable_shapes=tuple(unusable),
            pairs=pairs,
            relations=tuple(_classify_pairs(model, links, pairs)),
        )

    @cached_property
    def colliders(self) -> Colliders:
        """The shapes in coal.

        :raises FactUnavailableError: when coal is not installed.
        """
        geometries: dict[str, CollisionGeometry] = {}
        placed = []
        for shape, owner in zip(self.shapes, self.owners, strict=True):
            content, pose = self._describe_content(shape), shape.origin.matrix
            assert pose is not None  # see is_usable_shape
            if content not in geometries:
                geometries[content] = make_geometry(self.model, shape)
            placed.append(PlacedGeometry(geometries[content], owner, pose))
        return make_colliders(placed)

    @cached_property
    def non_z_up(self) -> tuple[str | None, ...]:
        """COLLADA's ``<up_axis>`` of each shape's mesh where it is not z, declared or by default."""
        facts = [self.model.meshes.get_facts(shape) for shape in self.shapes]
        return tuple(None if f is None or f.up_axis not in Z_UP_ROTATIONS else f.up_axis for f in facts)

    @cached_property
    def turned_upright(self) -> Colliders:
        """The shapes with every mesh turned so that its up axis is z.

        :raises FactUnavailableError: when coal is not installed.
        """
        placed = []
        for collider, shape, up_axis in zip(self.colliders.placed, self.shapes, self.non_z_up, strict=True):
            if up_axis is None:
                placed.append(collider)
                continue
            facts, scale = self.model.meshes.get_facts(shape), compute_drawn_scale(self.model, shape)
            assert facts is not None  # non_z_up is None without them
            vertices = facts.vertices @ Z_UP_ROTATIONS[up_axis].T * np.array(scale)
            placed.append(replace(collider, geometry=replace(collider.geometry, vertices=vertices)))
        return make_colliders(placed)

    @cached_property
    def rest_frames(self) -> Mapping[str, Array]:
        """Placement (1, 4, 4) of every link at the neutral pose.

        :raises FactUnavailableError: when an origin or an axis is broken.
        """
        return poses.compute_frames(self.model, poses.make_neutral_configuration(self.model))

    @cached_property
    def rest_placements(self) -> Array:
        """Placement (L, 4, 4) of the links with shapes at the neutral pose.

        :raises FactUnavailableError: when an origin or an axis is broken.
        """
        return np.array([self.rest_frames[link.name][0] for link in self.links]).reshape(-1, 4, 4)

    @cached_property
    def spheres(self) -> tuple[Array, Array]:
        """Centres (L, 3) and radii (L,) of spheres around the links at the neutral pose, in root coordinates."""
        in_link = [self.colliders.spheres[i] for i in range(len(self.links))]
        centres = np.array([centre for centre, _ in in_link]).reshape(-1, 3)
        placed = np.einsum("lij,lj->li", self.rest_placements[:, :3, :3], centres) + self.rest_placements[:, :3, 3]
        return placed, np.array([radius for _, radius in in_link])

    @cached_property
    def joints_above(self) -> tuple[frozenset[str], ...]:
        """The names of the joints between the root and each link."""
        return tuple(frozenset(joint.name for joint in self.model.tree.find_path_to(link.name)) for link in self.links)

    def compute_key(self) -> str:
        """Return a digest of all that decides collisions: shapes, placements, joints, and the code that compares them."""
        words = [compute_code_version(*_CODE_MODULES, library=find_library_origin("coal"))]
        words += [link.name for link in self.links]
        for shape, owner in zip(self.shapes, self.owners, strict=True):
            pose = shape.origin.matrix
            words.append(f"{owner} {self._describe_content(shape)} {None if pose is None else pose.tolist()}")
        words += [describe_joint(self.model.tree.parent_joint[name]) for name in self.model.tree.order[1:]]
        return hashlib.sha256("\0".join(words).encode()).hexdigest()

    def compute_placements(self, configurations: JointConfigurations) -> Array:
        """Compute the placement (N, L, 4, 4) of the links with shapes in root coordinates.

        :raises FactUnavailableError: when an origin or an axis is broken.
        """
        frames = poses.compute_frames(self.model, configurations)
        placed = [frames[link.name] for link in self.links]
        return np.stack(placed, axis=1) if placed else np.zeros((len(configurations.values), 0, 4, 4))

    def _describe_content(self, shape: Shape) -> str:
        """Return a text that is equal for equal shapes, wherever they are placed."""
        use = self.model.meshes.by_shape.get(id(shape))
        file = (
            None
            if use is None or use.resource.path is None
            else self.model.meshes.compute_content_key(use.resource.path)
        )
        return f"{shape.kind} {compute_drawn_scale(self.model, shape) if shape.kind == 'mesh' else shape.size} {file}"


def describe_joint(joint: Joint) -> str:
    """Return everything about a joint that decides where its child is, in any configuration."""
    pose = joint.origin.matrix
    mimic = None if joint.mimic is None else [(a.name, a.value) for a in joint.mimic.attributes.values()]
    return (
        f"{joint.parent} {joint.child} {joint.name} {joint.type} {None if pose is None else pose.tolist()} "
        f"{joint.axis} {poses.get_sampling_range(joint)} {mimic}"
    )


def make_colliders(placed: Sequence[PlacedGeometry]) -> Colliders:
    """Hand shapes to coal.

    :raises FactUnavailableError: when coal is not installed.
    """
    try:
        return Colliders(placed)
    except ImportError as error:
        raise FactUnavailableError(describe_left_out(error) or str(error)) from None


def make_geometry(model: Model, shape: Shape) -> CollisionGeometry:
    """Return the geometry of a usable shape, with its scale; of a mesh one for all shapes of that scale."""
    if shape.kind != "mesh":
        return CollisionGeometry(kind=shape.kind or "", size=shape.size or ())
    path = model.meshes.by_shape[id(shape)].resource.path
    scale = compute_drawn_scale(model, shape)
    assert path is not None  # see is_usable_shape
    assert scale is not None
    return _make_mesh_geometry(model, path, scale)


@fact
def _make_mesh_geometry(model: Model, path: Path, scale: tuple[float, float, float]) -> CollisionGeometry:
    facts = model.meshes.facts[path]
    return CollisionGeometry(
        kind="mesh", size=(), vertices=facts.vertices * np.array(scale), faces=facts.faces, closed=facts.closed
    )


def _classify_pairs(model: Model, links: Sequence[Link], pairs: Indices) -> Iterator[tuple[Relation, str | None]]:
    """Yield how the bodies of each pair of links are related, with the joint between adjacent ones."""
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
    """Return the nearest body towards the root that has collision geometry; a body has the name of its first link."""
    while head in model.tree.parent_joint:
        head = model.tree.list_body_links(model.tree.parent_joint[head].parent)[0]
        if head in solid:
            return head
    return None
