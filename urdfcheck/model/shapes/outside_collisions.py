"""Collision shapes that are outside all that is drawn."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.model.parts import Link, Shape, is_dummy_shape
from urdfcheck.model.rigid_bodies import list_neighbour_links, list_rigid_bodies
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.bounds import compute_bounding_box

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# A shape smaller than this share of what its link draws is a stand-in, wherever it is.
_TOKEN = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class OutsideCollision:
    """A collision shape that is outside all that its rigid body draws."""

    link: Link
    shape: Shape
    distance: float
    """From the nearest link that is drawn, box to box, in m."""


def list_mesh_readings(model: Model, shapes: Iterable[Shape]) -> list[tuple[bool, bool]]:
    """List how programs read the meshes of some shapes: whether they apply COLLADA's unit, and its up-axis."""
    meshes = [facts for shape in shapes if (facts := model.meshes.get_facts(shape)) is not None]
    units = (True, False) if any(facts.unit not in {None, 1.0} for facts in meshes) else (True,)
    uprights = (False, True) if any(facts.up_axis in {"X_UP", "Y_UP"} for facts in meshes) else (False,)
    return list(product(units, uprights))


def iter_outside_collisions(model: Model, *, gap: float, covered: float) -> Iterator[OutsideCollision]:
    """Yield the collision shapes of drawn links that are outside all that their rigid bodies draw, in the rest pose.

    Not those of which a neighbouring link draws the part, nor those that are alone in their body.

    :param gap: how far they are at least, in lengths of their boxes' diagonals.
    :param covered: a neighbour's box that holds this share of a shape's may be its part.
    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    for body in list_rigid_bodies(model):
        links = [model.link_by_name[name] for name in body.links]
        if sum(len(link.collisions) for link in links) < 2:
            continue
        readings = list_mesh_readings(model, (s for link in links for s in (*link.visuals, *link.collisions)))
        drawn = [_measure_drawn(model, links, reading) for reading in readings]
        if not all(drawn):
            continue
        near = [model.link_by_name[name] for name in list_neighbour_links(model, body)]
        for link in links:
            for shape in link.collisions if link.visuals else ():
                if is_dummy_shape(shape):
                    continue
                boxes = [_measure(model, [shape], link, reading) for reading in readings]
                distances = [
                    _measure_gap(box, known, own=known[link.name], gap=gap)
                    for box, known in zip(boxes, drawn, strict=True)
                ]
                if min(distances) and not _is_drawn_by(model, near, boxes, covered):
                    yield OutsideCollision(link, shape, distances[0])


def _measure(model: Model, shapes: Sequence[Shape], link: Link, reading: tuple[bool, bool]) -> Array | None:
    placed = [(shape, model.frames[link.name]) for shape in shapes]
    return compute_bounding_box(model, placed, apply_unit=reading[0], apply_up_axis=reading[1])


def _measure_drawn(model: Model, links: Iterable[Link], reading: tuple[bool, bool]) -> dict[str, Array]:
    """Measure what links draw, by name, in root coordinates; nothing where something is not known."""
    boxes = {link.name: _measure(model, link.visuals, link, reading) for link in links if link.visuals}
    known = {name: box for name, box in boxes.items() if box is not None}
    return known if len(known) == len(boxes) else {}


def _measure_gap(box: Array | None, drawn: dict[str, Array], *, own: Array, gap: float) -> float:
    """Return how far (m) a shape's box is from the nearest of what is drawn; 0 if that is less than ``gap``."""
    if box is None or not np.isfinite(box).all():
        return 0.0
    size = _measure_diagonal(box)
    distance = min(
        float(np.linalg.norm(np.maximum(0.0, np.maximum(box[0] - b[1], b[0] - box[1])))) for b in drawn.values()
    )
    return distance if distance > gap * size and size > _TOKEN * _measure_diagonal(own) else 0.0


def _is_drawn_by(model: Model, links: Iterable[Link], boxes: Sequence[Array | None], covered: float) -> bool:
    """Whether one of the links draws something where a shape is."""
    drawn = (_measure(model, link.visuals, link, (True, False)) for link in links)
    pairs = ((box, other) for other in drawn for box in boxes)
    return any(box is not None and other is not None and _measure_share(box, other) >= covered for box, other in pairs)


def _measure_share(box: Array, other: Array) -> float:
    """Return the share of a box that is in another."""
    shared = np.maximum(0.0, np.minimum(box[1], other[1]) - np.maximum(box[0], other[0]))
    return float((shared / np.maximum(box[1] - box[0], 1e-12)).prod())


def _measure_diagonal(box: Array) -> float:
    return float(np.linalg.norm(box[1] - box[0]))
