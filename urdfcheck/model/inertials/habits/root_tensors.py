"""Tensors about the origin of the root frame, at the zero pose: what a program reports for a whole assembly."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.facts.inertials.inertia_tensor import compute_parallel_axis_term
from urdfcheck.model.fact import fact
from urdfcheck.model.inertials.habits.measured_tensors import measure_tensors
from urdfcheck.model.robot import Model

# A tensor agrees with the drawn part's about the root where it differs by this share of its norm. The parallel-axis term is so
# many times the part's own tensor there, that no other mistake has the same six numbers. So many links that differ prove it.
_SAME, _LARGE, _FEWEST = 0.02, 5.0, 3
# Where the file has the mistake, so much is left of it by a part's motor; its term is as large as the part's own tensor at least.
_LIKE, _NOTABLE = 0.1, 1.0
# The origin of the link is another point if it is this share of the distance away.
_APART = 0.1


@fact
def find_root_tensors(model: Model) -> Mapping[str, float]:
    """Find the links whose tensor is that of what they draw about the origin of the root frame, in the axes of the link, by name,
    each with the share of its norm by which the two differ; none unless several links prove it."""
    try:
        frames = model.frames
    except FactUnavailableError:
        return {}
    found: dict[str, float] = {}
    proofs = set()
    for one in measure_tensors(model):
        frame = frames[one.link.name]
        lever = frame[:3, :3].T @ (frame[:3, :3] @ one.com + frame[:3, 3])
        term = compute_parallel_axis_term(one.mass, lever)
        off = float(np.linalg.norm(one.inertia - one.uniform - term) / np.linalg.norm(one.inertia))
        size = float(np.linalg.norm(term) / np.linalg.norm(one.uniform))
        if off < _LIKE and size > _NOTABLE:
            found[one.link.name] = off
        if off < _SAME and size > _LARGE and float(np.linalg.norm(lever - one.com)) > _APART * np.linalg.norm(lever):
            proofs.add(one.key)
    return found if len(proofs) >= _FEWEST else {}
