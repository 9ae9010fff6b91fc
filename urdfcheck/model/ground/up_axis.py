"""COLLADA meshes whose up axis is not z, and that lie on their sides because programs ignore `<up_axis>`.

Many such meshes were made with z up and only declare otherwise, so that the declaration proves nothing. A robot is mirrored in
the plane between its left and its right: meshes that lie on their sides break this, and standing upright they restore it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.model.motion.collisions import CollisionSetup, SelfCollisions, self_collisions
from urdfcheck.model.parts import Shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.bounds import compute_bounding_box

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Indices


# Two boxes are mirror images where their corners differ by less than this fraction of the robot's diagonal: 5 mm of 1 m, for
# typed digits and details of one side. It only counts on which side of a comparison a mesh falls, drawn or upright.
_ALIKE = 0.005


@dataclass(frozen=True, slots=True, eq=False)
class LyingMeshes:
    """Collision ``shapes`` with meshes that lie on their sides: ``drawn`` of them have a mirror image in the robot as RViz and
    MoveIt draw it, and ``upright`` once all are turned. ``freed``: the pairs of links that meet at the neutral pose and do
    not when they are turned."""

    shapes: tuple[Shape, ...]
    mirrored_as_drawn: int
    mirrored_upright: int
    freed_pairs: frozenset[tuple[str, str]]


def find_lying_meshes(model: Model) -> LyingMeshes | None:
    """The meshes that lie on their sides; None where turning them does not make the robot more alike on both sides, or frees
    no pair.

    :raises Unavailable: when the collisions are not known.
    """
    found = self_collisions(model)
    shapes = tuple(s for s, up in zip(found.setup.shapes, found.setup.non_z_up, strict=True) if up is not None)
    if not shapes:
        return None
    try:
        arrays = found.cache_entry["upright"]
    except KeyError:
        arrays = found.cache_entry["upright"] = {
            "mirrored": _count_mirrored_meshes(found.setup),
            "freed": _find_freed_pairs(found),
        }
    drawn, upright = arrays["mirrored"].tolist()
    freed = frozenset(found.pairs[k].links for k in arrays["freed"].tolist())
    return LyingMeshes(shapes, drawn, upright, freed) if upright > drawn and freed else None


def _find_freed_pairs(found: SelfCollisions) -> Indices:
    """The places of the pairs that meet at the neutral pose and do not with the meshes upright."""
    bench, met = found.setup, found.rest_results["met"]
    still = bench.turned_upright.detect_collisions(bench.rest_placements[None], bench.pairs[met])[:, 0]
    freed: Indices = met[~still]
    return freed


def _count_mirrored_meshes(bench: CollisionSetup) -> Indices:
    """How many of the meshes in question have a mirror image in the plane y = 0 of the root link (x ahead, y to the left),
    themselves among them, as drawn and upright."""
    counts = []
    for upright in (False, True):
        placed = [
            (shape, bench.rest_placements[owner]) for shape, owner in zip(bench.shapes, bench.owners, strict=True)
        ]
        boxes = np.array([compute_bounding_box(bench.model, [one], apply_up_axis=upright) for one in placed])
        flipped = boxes.copy()
        flipped[:, :, 1] = -boxes[:, ::-1, 1]
        size = float(np.linalg.norm(boxes[:, 1].max(axis=0) - boxes[:, 0].min(axis=0)))
        mine = np.array([up is not None for up in bench.non_z_up])
        apart = np.abs(flipped[mine, None] - boxes[None]).max(axis=(2, 3)).min(axis=1)
        counts.append(int((apart <= _ALIKE * size).sum()))
    return np.array(counts)
