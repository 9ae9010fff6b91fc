"""The ground and the buildings of a simulated world, which nothing moves."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from urdfcheck.model.fact import fact
from urdfcheck.model.rigid_bodies import list_whole_bodies
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.bounds import compute_bounding_box

# The diagonal in m above which a model without moving joints is no object that a robot handles.
_SCENERY = 10.0
# With parts of a room by name, above this one (chosen).
_ROOM, _ROOM_NAME = (
    2.0,
    re.compile(r"(?:^|[^a-z])(?:floor|wall|ceiling|room|building|corridor|stair|ramp)s?(?![a-z])", re.IGNORECASE),
)


@fact
def scenery_links(model: Model) -> frozenset[str]:
    """The links of a model without joints that move which are the ground or a building: no inertia of theirs has an effect."""
    return frozenset() if any(joint.is_movable for joint in model.joints) else frozenset(_iter_scenery_links(model))


def _iter_scenery_links(model: Model) -> Iterator[str]:
    for body in list_whole_bodies(model):
        links = [model.link_by_name[name] for name in body.links]
        placed = [(shape, model.piece_frames[k.name]) for k in links for shape in (*k.visuals, *k.collisions)]
        # The mesh of one may not have been read.
        boxes = [box for one in placed if (box := compute_bounding_box(model, [one])) is not None]
        least = _ROOM if any(map(_ROOM_NAME.search, body.links)) else _SCENERY
        if boxes and float(np.linalg.norm(np.max(boxes, axis=0)[1] - np.min(boxes, axis=0)[0])) > least:
            yield from body.links
