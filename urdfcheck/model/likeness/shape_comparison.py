"""What the links of a model look like, and which of them look alike."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.inertials.inertia_tensor import compute_principal_moments
from urdfcheck.facts.likeness.mirror import PartOutline
from urdfcheck.model.fact import fact
from urdfcheck.model.parts import Link, Shape, is_dummy_shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.corners import compute_shape_corners
from urdfcheck.model.shapes.solids import compute_drawn_scale, measure_shape_solid

# Drawn parts are alike to within this share of their radius (tessellations of two sides differ), and certainly different
# beyond the other.
ALIKE, DIFFERENT = 0.03, 0.10


@fact
def get_outline(model: Model, name: str) -> PartOutline | None:
    """Return what a link draws, in its frame; None when it draws nothing, or a shape is not known."""
    return _compute_outline(model, model.link_by_name[name])


def is_comparable(model: Model, one: str, other: str) -> bool:
    """Whether two links draw shapes of the same kinds."""
    kinds = _map_shape_kinds(model)
    return kinds[one] == kinds[other]


def is_alike(model: Model, one: str, other: str) -> bool | None:
    """Whether two links draw parts of one shape, mirrored or not, wherever in their frames; None where that is not known."""
    if not is_comparable(model, one, other):
        return False
    first, second = _compute_outline_moments(model, one), _compute_outline_moments(model, other)
    if first is None or second is None:
        return None
    return bool(np.abs(first - second).max() <= 2.0 * ALIKE * second.max())


@fact
def list_alike_links(model: Model, name: str) -> tuple[str, ...]:
    """Return the other links that draw parts of a link's shape, see `is_alike`."""
    kinds = _map_shape_kinds(model)
    candidates = (other for other, kind in kinds.items() if other != name and kind == kinds[name])
    return tuple(other for other in candidates if is_alike(model, name, other))


def propose_motions(model: Model, one: str, other: str) -> Iterator[tuple[Array, Array]]:
    """Yield the rotation (3, 3) and translation (3,) of each way to copy a part: with its link's frame, or its first shape's."""
    yield np.eye(3), np.zeros(3)
    first, second = (_choose_shapes(model.link_by_name[name])[0].origin.matrix for name in (one, other))
    if first is not None and second is not None and np.abs(first - second).max() > 1e-9:
        motion = second @ np.linalg.inv(first)
        yield motion[:3, :3], motion[:3, 3]


def compute_centroid(model: Model, name: str) -> Array | None:
    """Compute the centroid (3,) of what a link draws, in root coordinates; None as for `get_outline`."""
    outline = get_outline(model, name)
    if outline is None:
        return None
    frame = model.frames[name]
    centroid: Array = frame[:3, :3] @ outline.centroid + frame[:3, 3]
    return centroid


@fact
def _map_shape_kinds(model: Model) -> Mapping[str, list[str]]:
    """Return the sorted kinds of the shapes that each link draws, by its name."""
    return {name: sorted(str(s.kind) for s in _choose_shapes(link)) for name, link in model.link_by_name.items()}


@fact
def _compute_outline_moments(model: Model, name: str) -> Array | None:
    """Return the principal second moments (3,) in m² of what a link draws."""
    outline = get_outline(model, name)
    return None if outline is None else compute_principal_moments(outline.covariance)[0]


def _choose_shapes(link: Link) -> tuple[Shape, ...]:
    """Return what the link shows: its visual shapes, or its collision shapes where it has no others."""
    choices = [tuple(s for s in shapes if not is_dummy_shape(s)) for shapes in (link.visuals, link.collisions)]
    return next((shapes for shapes in choices if shapes), ())


def _compute_outline(model: Model, link: Link) -> PartOutline | None:
    weights: list[float] = []
    centroids: list[Array] = []
    covariances: list[Array] = []
    points: list[Array] = []
    for shape in _choose_shapes(link):
        corners, surface = compute_shape_corners(model, shape), _measure_surface(model, shape)
        if corners is None or surface is None:
            return None
        weight, centre, covariance = surface
        if not weight > 0.0:
            return None
        weights.append(weight)
        centroids.append(centre)
        covariances.append(covariance)
        points.append(corners)
    if not weights:
        return None
    share = np.array(weights) / sum(weights)
    centroid = share @ np.array(centroids)
    offsets = np.array(centroids) - centroid
    spread = np.einsum("i,ijk->jk", share, np.array(covariances)) + np.einsum("i,ij,ik->jk", share, offsets, offsets)
    return PartOutline(centroid, spread, np.concatenate(points))


def _measure_surface(model: Model, shape: Shape) -> tuple[float, Array, Array] | None:
    """Return the weight (m²), centroid (3,) and second moments (3, 3) of a shape's surface, in its link's frame.

    Of a primitive those of its volume, which serve as well where all links that are compared draw it as a primitive.
    """
    if shape.kind != "mesh":
        solid = measure_shape_solid(model, shape)
        return None if solid is None else (solid.volume ** (2 / 3), solid.com, solid.covariance)
    facts, scale, pose = model.meshes.get_facts(shape), compute_drawn_scale(model, shape), shape.origin.matrix
    if facts is None or scale is None or pose is None:
        return None
    factors = np.array(scale)
    weight = facts.area * float(np.abs(factors).prod()) ** (2 / 3)
    centre, covariance = factors * facts.surface_centroid, facts.surface_covariance * np.outer(factors, factors)
    turn, place = pose[:3, :3], pose[:3, 3]
    return weight, turn @ centre + place, turn @ covariance @ turn.T
