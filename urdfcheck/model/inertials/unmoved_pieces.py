"""Links of a file whose bodies were added without the parallel-axis term, also where the mesh is one piece."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from urdfcheck.facts.inertials.unmoved_pieces import find_unmoved_pieces
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_link_geometry

if TYPE_CHECKING:
    from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
    from urdfcheck.facts.inertials.diagnosis import Diagnosis


def join_unmoved_pieces(
    model: Model, numbers: Mapping[str, DeclaredInertial], diagnoses: Mapping[str, Diagnosis]
) -> dict[str, Diagnosis]:
    """Return the verdicts, with the cause ``steiner_missing`` where a link lacks the term of two bodies and another link of the
    file shows by its pieces that the program which wrote it leaves the term out; by name, like the ``numbers``."""
    joined = dict(diagnoses)
    if not any(one.cause == "steiner_missing" and one.judged_by == "mesh" for one in diagnoses.values()):
        return joined
    for name, one in diagnoses.items():
        if one.unique or one.judged_by != "mesh" or one.cause == "steiner_missing":
            continue
        drawn = measure_link_geometry(model, model.link_by_name[name])
        found = find_unmoved_pieces(one, numbers[name], drawn.solid) if drawn is not None and drawn.closed else None
        if found is not None and (one.cause is None or found.mended_tensor_mismatch < one.mended_tensor_mismatch):
            joined[name] = found
    return joined
