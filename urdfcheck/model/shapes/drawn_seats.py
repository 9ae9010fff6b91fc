"""Where a link draws the seat of a joint that it holds: a fork, a hub, a motor."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.mesh_sizes import get_mesh_scale

if TYPE_CHECKING:
    from collections.abc import Sequence

    from urdfcheck.facts.arrays import Array
    from urdfcheck.model.parts import Joint

# Gaps are the same within this share of the distance between the two places.
_SAME = 0.2


def has_drawn_seat(model: Model, joint: Joint, others: Sequence[Joint], off: Array) -> bool:
    """Whether a joint is as near to what its parent draws as each of the others is, and would not be if it were moved back by
    ``off`` (3,), in m and root coordinates: then the parent was drawn with the joint in its place.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    places = [(one.parent, model.frames[one.child][:3, 3]) for one in (joint, *others)]
    measured = [_measure_gap(model, *place) for place in (*places, (joint.parent, places[0][1] - off))]
    gaps = [gap for gap in measured if gap is not None]
    if len(gaps) < len(measured):
        return False
    *typed, moved = gaps
    usual, same = float(np.median(typed[1:])), _SAME * float(np.linalg.norm(off))
    return all(abs(gap - usual) <= same for gap in typed) and abs(moved - usual) > same


def _measure_gap(model: Model, name: str, place: Array) -> float | None:
    """Measure how near (m) the vertices of the meshes that a link draws are to a place (3,) in root coordinates; None without
    any."""
    link, frame = model.link_by_name[name], model.frames[name]
    here = frame[:3, :3].T @ (place - frame[:3, 3])
    gaps = []
    for shape in link.visuals:
        facts, scale, pose = model.meshes.get_facts(shape), get_mesh_scale(model, shape, True), shape.origin.matrix
        if facts is not None and scale is not None and pose is not None and len(facts.vertices):
            vertices = facts.vertices * scale @ pose[:3, :3].T + pose[:3, 3]
            gaps.append(float(np.sqrt(((vertices - here) ** 2).sum(axis=1).min())))
    return min(gaps, default=None)
