"""How links meet at the neutral pose."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.model.motion.collisions.setup import CollisionSetup
from urdfcheck.model.parts import Shape

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Arrays = Mapping[str, NDArray[Any]]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Contact:
    """How two links meet at the neutral pose; vectors in root coordinates."""

    shapes: tuple[Shape, Shape]
    """The two ``<collision>`` elements that overlap most, in the order of the pair's links."""
    depth: float
    """Metres. Moving the second shape by this much along ``normal`` frees it from the first; the shortest of the directions
    that were tried (see `urdfcheck.facts.motion.collision`), hence the penetration depth or slightly more. Infinite for
    neighbours, which are expected to overlap, where only the fact of the overlap was computed."""
    point: tuple[float, float, float]
    """The middle of the region where the surfaces meet; for an infinite ``depth``, some point of that region."""
    normal: tuple[float, float, float]
    size: float
    """Metres: the diameter of a sphere around the smaller shape."""
    touching: bool
    """Whether typed digits and single precision explain the overlap (faces in one plane); ``depth`` is then 0."""


def compare_at_rest(setup: CollisionSetup) -> Arrays:
    """Compare all pairs at the neutral pose.

    ``met`` holds the indices of the pairs that meet, ``contacts`` (C,) those of them that are not ``fixed``; ``shapes`` (C, 2),
    ``depth`` (C,), ``normal`` (C, 3), ``point`` (C, 3) and ``size`` (C,) describe these, see `Contact`.
    """
    met = np.zeros(0, dtype=np.int64)
    if len(setup.pairs):  # one link alone needs neither coal nor its geometry
        met = np.flatnonzero(setup.colliders.detect_collisions(setup.rest_placements[None], setup.pairs)[:, 0])
    contacts, overlaps = [], []
    for index in met.tolist():
        relation, _ = setup.relations[index]
        if relation == "fixed":
            continue
        overlap = setup.colliders.find_deepest_overlap(
            setup.rest_placements, *setup.pairs[index].tolist(), with_depth=relation == "far"
        )
        if overlap is not None:
            contacts.append(index)
            overlaps.append(overlap)
    return {
        "met": met,
        "contacts": np.array(contacts, dtype=np.int64),
        "shapes": np.array([overlap.shapes for overlap in overlaps], dtype=np.int64).reshape(-1, 2),
        "depth": np.array([overlap.depth for overlap in overlaps]),
        "normal": np.array([overlap.normal for overlap in overlaps]).reshape(-1, 3),
        "point": np.array([overlap.point for overlap in overlaps]).reshape(-1, 3),
        "size": np.array([overlap.size for overlap in overlaps]),
    }


def read_contact(setup: CollisionSetup, arrays: Arrays, row: int) -> Contact:
    """Return one contact of the arrays that `compare_at_rest` returned."""
    first, second = arrays["shapes"][row].tolist()
    depth = float(arrays["depth"][row])
    point, normal = (tuple(arrays[name][row].tolist()) for name in ("point", "normal"))
    return Contact(
        shapes=(setup.shapes[first], setup.shapes[second]),
        depth=depth,
        point=point,
        normal=normal,
        size=float(arrays["size"][row]),
        touching=depth == 0.0,
    )
