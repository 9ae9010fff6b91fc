"""Links that draw one and the same thing in one place, such as the whole robot: then the drawing is not that of the link."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.facts.inertials.inertia_tensor import Solid, transform_solid
from urdfcheck.model.fact import fact
from urdfcheck.model.parts import Link
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.bounds import is_dummy_shape
from urdfcheck.model.shapes.visual_solid import measure_role_geometry

if TYPE_CHECKING:
    from collections.abc import Iterable

# So many rigid bodies cannot be in one place; two may be the halves of a joint that are drawn alike.
_FEWEST_BODIES = 3
# What digits of origins and of a mesh file leave, as a share of the size.
_SAME = 1e-3


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


def _list_coincident(model: Model, links: Sequence[Link]) -> Iterable[str]:
    """List the links of the largest group in one place, if they are enough bodies."""
    placed = [(link.name, solid) for link in links if (solid := _place_drawing(model, link)) is not None]
    groups = [[name for name, other in placed if _is_same(solid, other)] for _, solid in placed]
    largest = max(groups, key=len, default=[])
    bodies = {model.pieces.list_body_links(name)[0] for name in largest}
    return largest if len(bodies) >= _FEWEST_BODIES else ()


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
