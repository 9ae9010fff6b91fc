"""COLLADA meshes that lie on their sides, because their up axis is not z and programs ignore ``<up_axis>``.

Many such meshes were made with z up and only declare another axis, so the declaration proves nothing. A robot's left mirrors its
right: meshes that lie on their sides break this symmetry, and turning them upright restores it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.model.motion.collisions.self_collisions import SelfCollisions, self_collisions
from urdfcheck.model.motion.collisions.setup import CollisionSetup
from urdfcheck.model.parts import Shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.bounds import compute_bounding_box

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Indices

# Two boxes are mirror images where their corners differ by less than this fraction of the robot's diagonal: 5 mm of 1 m, for
# typed digits and details of one side. It only decides on which side of a comparison a mesh falls, drawn or upright.
_ALIKE = 0.005


@dataclass(frozen=True, slots=True, eq=False)
class LyingMeshes:
    """Collision shapes with meshes that lie on their sides."""

    shapes: tuple[Shape, ...]
    mirrored_as_drawn: int
    """The number of them that have a mirror image in the robot as RViz and MoveIt draw it."""
    mirrored_upright: int
    """The same once all are turned upright."""
    freed_pairs: frozenset[tuple[str, str]]
    """The pairs of links that meet at the neutral pose, and do not once the meshes are turned."""


def find_lying_meshes(model: Model) -> LyingMeshes | None:
    """Find the meshes that lie on their sides; None where turning them makes the robot no more symmetric, or frees no pair.

    :raises FactUnavailableError: when the collisions are not known.
    """
    collisions = self_collisions(model)
    setup = collisions.setup
    shapes = tuple(s for s, up_axis in zip(setup.shapes, setup.non_z_up, strict=True) if up_axis is not None)
    if not shapes:
        return None
    try:
        arrays = collisions.cache_entry["upright"]
    except KeyError:
        arrays = collisions.cache_entry["upright"] = {
            "mirrored": _count_mirrored_meshes(setup),
            "freed": _find_freed_pairs(collisions),
        }
    drawn, upright = arrays["mirrored"].tolist()
    freed = frozenset(collisions.pairs[k].links for k in arrays["freed"].tolist())
    return LyingMeshes(shapes, drawn, upright, freed_pairs=freed) if upright > drawn and freed else None


def _find_freed_pairs(collisions: SelfCollisions) -> Indices:
    """Return the indices of the pairs that meet at the neutral pose, and do not with the meshes upright."""
    setup, met = collisions.setup, collisions.rest_results["met"]
    still_met = setup.turned_upright.detect_collisions(setup.rest_placements[None], setup.pairs[met])[:, 0]
    freed: Indices = met[~still_met]
    return freed


def _count_mirrored_meshes(setup: CollisionSetup) -> Indices:
    """Count the meshes in question with a mirror image (themselves included), as drawn and upright.

    The mirror is the plane y = 0 of the root link (x ahead, y to the left).
    """
    counts = []
    for upright in (False, True):
        placed = [
            (shape, setup.rest_placements[owner]) for shape, owner in zip(setup.shapes, setup.owners, strict=True)
        ]
        boxes = np.array([compute_bounding_box(setup.model, [one], apply_up_axis=upright) for one in placed])
        flipped = boxes.copy()
        flipped[:, :, 1] = -boxes[:, ::-1, 1]
        size = float(np.linalg.norm(boxes[:, 1].max(axis=0) - boxes[:, 0].min(axis=0)))
        in_question = np.array([up_axis is not None for up_axis in setup.non_z_up])
        distance = np.abs(flipped[in_question, None] - boxes[None]).max(axis=(2, 3)).min(axis=1)
        counts.append(int((distance <= _ALIKE * size).sum()))
    return np.array(counts)
