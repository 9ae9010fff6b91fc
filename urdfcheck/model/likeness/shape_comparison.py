"""What the links of a model look like, and which of them look alike."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.inertials.inertia_tensor import compute_principal_moments
from urdfcheck.facts.likeness.mirror import PartOutline
from urdfcheck.model.parts import Link, Shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.bounds import is_dummy_shape
from urdfcheck.model.shapes.corners import compute_shape_corners
from urdfcheck.model.shapes.solids import compute_drawn_scale, measure_shape_solid

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

# Drawn parts are alike to within this share of their radius (tessellations of two sides differ), and certainly different
# beyond the other.
ALIKE, DIFFERENT = 0.03, 0.10


class ShapeComparer:
    """The outlines of a model's links, each made when it is first asked for."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self._outlines: dict[str, PartOutline | None] = {}
        self._moments: dict[str, Array | None] = {}
        self._like: dict[str, tuple[str, ...]] = {}
        self._kinds = {
            name: sorted(str(s.kind) for s in _choose_shapes(link)) for name, link in model.link_by_name.items()
        }

    def get_outline(self, name: str) -> PartOutline | None:
        """What a link draws, in its frame; None when it draws nothing, or a shape is not known."""
        if name not in self._outlines:
            self._outlines[name] = _compute_outline(self._model, self._model.link_by_name[name])
        return self._outlines[name]

    def is_comparable(self, one: str, other: str) -> bool:
        """Whether two links draw shapes of the same kinds."""
        return self._kinds[one] == self._kinds[other]

    def is_alike(self, one: str, other: str) -> bool | None:
        """Whether two links draw parts of one shape, mirrored or not, wherever in their frames; None where that is not known."""
        if not self.is_comparable(one, other):
            return False
        first, second = self._get_principal_moments(one), self._get_principal_moments(other)
        if first is None or second is None:
            return None
        return bool(np.abs(first - second).max() <= 2.0 * ALIKE * second.max())

    def list_alike(self, name: str) -> tuple[str, ...]:
        """The other links that draw parts of this one's shape."""
        if name not in self._like:
            others = (other for other in self._model.link_by_name if other != name)
            self._like[name] = tuple(other for other in others if self.is_alike(name, other))
        return self._like[name]

    def propose_motions(self, one: str, other: str) -> Iterator[tuple[Array, Array]]:
        """How a part may have been copied: with its link's frame, or with the frame of its first shape."""
        yield np.eye(3), np.zeros(3)
        first, second = (_choose_shapes(self._model.link_by_name[name])[0].origin.matrix for name in (one, other))
        if first is not None and second is not None and np.abs(first - second).max() > 1e-9:
            motion = second @ np.linalg.inv(first)
            yield motion[:3, :3], motion[:3, 3]

    def compute_centroid(self, name: str) -> Array | None:
        """The centroid of what a link draws, in root coordinates."""
        outline = self.get_outline(name)
        if outline is None:
            return None
        frame = self._model.frames[name]
        place: Array = frame[:3, :3] @ outline.centroid + frame[:3, 3]
        return place

    def _get_principal_moments(self, name: str) -> Array | None:
        """Principal second moments (m²) of what a link draws."""
        if name not in self._moments:
            outline = self.get_outline(name)
            self._moments[name] = None if outline is None else compute_principal_moments(outline.covariance)[0]
        return self._moments[name]


def _choose_shapes(link: Link) -> tuple[Shape, ...]:
    """What the link shows: its visual shapes, or its collision shapes where it has no others."""
    choices = [tuple(s for s in shapes if not is_dummy_shape(s)) for shapes in (link.visuals, link.collisions)]
    return next((shapes for shapes in choices if shapes), ())


def _compute_outline(model: Model, link: Link) -> PartOutline | None:
    weights: list[float] = []
    centroids: list[Array] = []
    covariances: list[Array] = []
    points: list[Array] = []
    for shape in _choose_shapes(link):
        corners, pose = compute_shape_corners(model, shape), shape.origin.matrix
        if corners is None or pose is None:
            return None
        if shape.kind == "mesh":
            facts, scale = model.meshes.get_facts(shape), compute_drawn_scale(model, shape)
            assert facts is not None
            assert scale is not None
            factors = np.array(scale)
            weight = facts.area * float(np.abs(factors).prod()) ** (2 / 3)
            centre, covariance = factors * facts.surface_centroid, facts.surface_covariance * np.outer(factors, factors)
            turn, place = pose[:3, :3], pose[:3, 3]
            centre, covariance = turn @ centre + place, turn @ covariance @ turn.T
        else:
            solid = measure_shape_solid(model, shape)
            if solid is None:
                return None
            weight, centre, covariance = solid.volume ** (2 / 3), solid.com, solid.covariance
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
