"""Marks on a mesh that a report draws for a finding: coordinates in metres in the mesh's frame, rounded, and few enough."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

from typing import TYPE_CHECKING, Any

import numpy as np

from urdfcheck.model.meshes import MeshUse
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.solids import compute_drawn_scale

# Points, lines or triangles of one mesh: a screen shows no more, and a finding stays below 50 kB.
MAX_DRAWN = 256
DIGITS = 6


def sample_for_drawing(model: Model, use: MeshUse, places: Array, most: int = MAX_DRAWN) -> list[Any]:
    """Return at most ``most`` of ``places`` in file units, evenly picked, as nested lists in metres as RViz draws the mesh.

    ``places`` are points (n, 3), lines (n, 2, 3) or triangles (n, 3, 3).
    """
    scale = np.array(compute_drawn_scale(model, use.shape) or (1.0, 1.0, 1.0))
    picked = places[:: max(1, -(-len(places) // most))] * scale
    rounded: list[Any] = np.reshape([round_significant(v) for v in picked.ravel()], picked.shape).tolist()
    return rounded


def round_significant(value: float, digits: int = DIGITS) -> float:
    """Round to ``digits`` significant digits, and drop the sign of a zero."""
    return float(f"{value:.{digits}g}") + 0.0
