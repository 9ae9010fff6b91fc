"""Pinocchio as an oracle of statics and dynamics."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np


def make_configuration(model: Any, values: Mapping[str, float]) -> np.ndarray:
    """Pinocchio's coordinates with these joints at ``values``, rad or m; the others are neutral."""
    import pinocchio

    q = np.array(pinocchio.neutral(model))
    for name, value in values.items():
        joint = model.joints[model.getJointId(name)]
        q[joint.idx_q : joint.idx_q + joint.nq] = value if joint.nq == 1 else (math.cos(value), math.sin(value))
    return q


def list_places(model: Any, names: list[str]) -> list[int]:
    """The rows of these joints in its mass matrix."""
    return [model.joints[model.getJointId(name)].idx_v for name in names]
