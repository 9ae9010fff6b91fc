"""What an engine sees that collides with convex hulls: MuJoCo, with its defaults for URDF."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from urdfcheck.core import FactUnavailableError
from urdfcheck.core.records import dataclass
from urdfcheck.facts.motion.collision import Separation
from urdfcheck.facts.motion.collision_geometry import PlacedGeometry
from urdfcheck.model.motion.collisions.setup import CollisionSetup, make_colliders, make_geometry
from urdfcheck.model.parts import Shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.solids import compute_drawn_scale


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class HullOverlap:
    """Two links whose convex hulls overlap at rest."""

    links: tuple[str, str]
    shapes: tuple[Shape, Shape]
    """The two ``<collision>`` elements that overlap most."""
    depth: float
    """Metres, as in `Contact`."""
    is_at_root: bool
    """Whether they are neighbours that the engine compares because one is part of the world."""
    shapes_meet: bool
    """Whether the shapes overlap as they are typed too."""


def find_hull_overlaps(model: Model, *, least: float) -> list[HullOverlap]:
    """Find the pairs of links that MuJoCo finds in collision at the neutral pose, deeper than ``least`` (m).

    MuJoCo compares no link with its neighbours across a joint, unless the neighbour is fixed to the world, which the root of a
    URDF is (``filterparent`` in its documentation, *Computation: Collision detection*). Pairs that are not neighbours and
    overlap as typed are left out, because every engine finds them.

    :raises FactUnavailableError: when the tree or an origin is broken, a shape could not be read, or coal is not installed.
    """
    setup = CollisionSetup.from_model(model)
    if setup.unusable_shapes:
        raise FactUnavailableError(f"a shape of link {setup.unusable_shapes[0][0]!r} could not be measured")
    if len(setup.links) < 2:
        return []
    hulls = make_colliders(list(_iter_hulls(setup)))
    placements = setup.rest_placements
    world = set(model.tree.list_body_links(model.tree.root))
    found = []
    met = hulls.detect_collisions(placements[None], setup.pairs)[:, 0]
    for index in met.nonzero()[0].tolist():
        relation, _ = setup.relations[index]
        one, other = setup.pairs[index].tolist()
        links = setup.links[one].name, setup.links[other].name
        is_neighbour = _are_neighbours(model, *links)
        is_at_root = is_neighbour and not world.isdisjoint(links)
        if relation == "fixed" or (is_neighbour and not is_at_root):
            continue
        way = hulls.find_deepest_overlap(placements, one, other)
        if way is None or way.depth < least:
            continue
        shapes_meet = _meet_as_typed(setup, one, other)
        if is_at_root or not shapes_meet:
            found.append(_build_overlap(setup, way, links, is_at_root=is_at_root, shapes_meet=shapes_meet))
    return sorted(found, key=lambda overlap: -overlap.depth)


def _are_neighbours(model: Model, one: str, other: str) -> bool:
    """Whether a single joint that moves connects the bodies of two links, whatever collides between them."""
    tree = model.tree
    heads = [tree.list_body_links(name)[0] for name in (one, other)]
    parents = [
        tree.list_body_links(tree.parent_joint[head].parent)[0] if head in tree.parent_joint else None for head in heads
    ]
    return heads[0] == parents[1] or heads[1] == parents[0]


def _iter_hulls(setup: CollisionSetup) -> Iterator[PlacedGeometry]:
    for shape, owner in zip(setup.shapes, setup.owners, strict=True):
        geometry, pose = make_geometry(setup.model, shape), shape.origin.matrix
        assert pose is not None  # see is_usable_shape
        facts, scale = setup.model.meshes.get_facts(shape), compute_drawn_scale(setup.model, shape)
        if facts is not None and scale is not None and facts.hull.volume > 0:
            corners = facts.hull.vertices * scale
            geometry = replace(geometry, vertices=corners, faces=facts.hull.faces, closed=True)
        yield PlacedGeometry(geometry, owner, pose)


def _meet_as_typed(setup: CollisionSetup, one: int, other: int) -> bool:
    way = setup.colliders.find_deepest_overlap(setup.rest_placements, one, other, with_depth=False)
    return way is not None and way.depth > 0


def _build_overlap(
    setup: CollisionSetup, way: Separation, links: tuple[str, str], *, is_at_root: bool, shapes_meet: bool
) -> HullOverlap:
    first, second = way.shapes
    return HullOverlap(
        links=links,
        shapes=(setup.shapes[first], setup.shapes[second]),
        depth=way.depth,
        is_at_root=is_at_root,
        shapes_meet=shapes_meet,
    )
