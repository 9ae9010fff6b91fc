"""Links that draw one and the same thing in one place, such as the whole robot, or one primitive in place of many parts: then the
drawing is not that of each link."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.facts.inertials.inertia_tensor import (
    Solid,
    compute_principal_moments,
    compute_solid_inertia,
    transform_solid,
)
from urdfcheck.model.fact import fact
from urdfcheck.model.parts import DeclaredTensor, Link, is_dummy_shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_role_geometry

if TYPE_CHECKING:
    from collections.abc import Iterable

# So many rigid bodies cannot be in one place; two may be the halves of a joint that are drawn alike.
_FEWEST_BODIES = 3
# What digits of origins and of a mesh file leave, as a share of the size.
_SAME = 1e-3
# Two drawings overlap if the boxes around them do by this share of their length along each axis.
_OVERLAP = 0.1
# A primitive stands for the parts of a robot where so many links draw it with inertials of so many bodies, of which the heaviest
# is so many times the lightest; these are far from the primitive's own where a moment is off by more than this share (chosen).
_MANY_LINKS, _MANY_BODIES, _HEAVIER, _OWN = 8, 4, 3.0, 0.25


@fact
def find_repeated_drawings(model: Model) -> frozenset[str]:
    """Find the links whose visual meshes, with all joints at zero, are one body in one place, where these links are at least
    `_FEWEST_BODIES` rigid bodies. Empty where the frames of the links are not known."""
    groups: dict[int, list[Link]] = {}
    for link in model.links:
        shapes = [shape for shape in link.visuals if not is_dummy_shape(shape)]
        facts = model.meshes.get_facts(shapes[0]) if len(shapes) == 1 else None
        if facts is not None:
            groups.setdefault(facts.n_triangles, []).append(link)
    found: set[str] = set()
    for links in groups.values():
        if len(links) >= _FEWEST_BODIES:
            try:
                found.update(_list_coincident(model, links))
            except FactUnavailableError:  # a broken tree, or an origin that is malformed
                return frozenset()
    return frozenset(found)


@fact
def find_stand_in_drawings(model: Model) -> frozenset[str]:
    """Find the links that draw one and the same primitive in place of their parts, as where all meshes are commented out: one
    size and place, with the inertials of many bodies, none of which is that of the primitive."""
    groups: dict[object, list[DeclaredTensor]] = {}
    for tensor in model.tensors:
        shapes = tensor.link.visuals
        if len(shapes) != 1 or shapes[0].kind == "mesh" or is_dummy_shape(shapes[0]) or not tensor.inertial.mass:
            continue
        origin = shapes[0].origin
        place = tuple(origin.xyz or (0.0, 0.0, 0.0)), tuple(origin.rpy or (0.0, 0.0, 0.0))
        groups.setdefault((shapes[0].kind, shapes[0].size, place), []).append(tensor)
    found: set[str] = set()
    for group in groups.values():
        masses = [tensor.inertial.mass or 0.0 for tensor in group]
        if len(group) < _MANY_LINKS or not max(masses) >= _HEAVIER * min(masses) > 0.0:
            continue
        bodies = {f"{mass:.3g} {sum(one.moments):.3g}" for mass, one in zip(masses, group, strict=True)}
        if len(bodies) >= _MANY_BODIES and not any(_has_moments_of_drawing(model, tensor) for tensor in group):
            found.update(tensor.link.name for tensor in group)
    return frozenset(found)


def _has_moments_of_drawing(model: Model, tensor: DeclaredTensor) -> bool:
    """Whether the principal moments of a link are those of what it draws, at its mass."""
    drawn = measure_role_geometry(model, tensor.link, "visual")
    if drawn is None:
        return False
    own = compute_principal_moments(compute_solid_inertia(drawn.solid, tensor.inertial.mass or 0.0))[0]
    return bool((np.abs(np.array(tensor.moments) - own) <= _OWN * own).all())


def list_links_drawn_there(model: Model, link: Link) -> list[Link]:
    """List the other links that draw the same thing as a link in the same place, with all joints at zero.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    return [other for other in model.links if other is not link and are_drawn_in_one_place(model, link, other)]


def are_drawn_in_one_place(model: Model, one: Link, other: Link) -> bool:
    """Whether two links draw the same thing in one place, with all joints at zero.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    first, second = _place_drawing(model, one), _place_drawing(model, other)
    return first is not None and second is not None and _is_same(first, second)


def do_drawings_overlap(model: Model, one: Link, other: Link) -> bool:
    """Whether two links draw the same thing in one place, or are one rigid body and draw it so near that boxes around the two,
    in the axes of either link, overlap.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    if are_drawn_in_one_place(model, one, other):
        return True
    if other.name not in model.pieces.list_body_links(one.name):
        return False
    axes = np.hstack([model.frames[link.name][:3, :3] for link in (one, other)])
    extents = []
    for link in (one, other):
        drawn, frame = measure_role_geometry(model, link, "visual"), model.frames[link.name]
        if drawn is None:
            return False
        along = (drawn.points @ frame[:3, :3].T + frame[:3, 3]) @ axes
        extents.append((along.min(axis=0), along.max(axis=0)))
    (first_low, first_high), (second_low, second_high) = extents
    overlap = np.minimum(first_high, second_high) - np.maximum(first_low, second_low)
    length = np.minimum(first_high - first_low, second_high - second_low)
    return bool((overlap > _OVERLAP * length).all())


def _list_coincident(model: Model, links: Sequence[Link]) -> Iterable[str]:
    """List the links of the largest group in one place, if they are enough bodies."""
    placed = [(link.name, solid) for link in links if (solid := _place_drawing(model, link)) is not None]
    groups = [[name for name, other in placed if _is_same(solid, other)] for _, solid in placed]
    largest = max(groups, key=len, default=[])
    bodies = {model.pieces.list_body_links(name)[0] for name in largest}
    return largest if len(bodies) >= _FEWEST_BODIES else ()


@fact
def _place_drawing(model: Model, link: Link) -> Solid | None:
    drawn = measure_role_geometry(model, link, "visual")
    if drawn is None:
        return None
    frame = model.frames[link.name]
    return transform_solid(drawn.solid, frame[:3, :3], frame[:3, 3])


def _is_same(one: Solid, other: Solid) -> bool:
    size = float(np.trace(one.covariance)) ** 0.5
    return (
        abs(one.volume - other.volume) <= _SAME * one.volume
        and float(np.linalg.norm(one.com - other.com)) <= _SAME * size
        and float(np.linalg.norm(one.covariance - other.covariance)) <= _SAME * size**2
    )
