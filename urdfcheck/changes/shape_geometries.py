"""Reads the geometry of shapes, mesh files included, while two models are compared."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from urdfcheck.core.mechanism import MechanismShape
from urdfcheck.facts.motion.collision_geometry import CollisionGeometry
from urdfcheck.model.meshes import recall_mesh
from urdfcheck.system.array_cache import ArrayCache

# How many numbers make up the size of a primitive.
_DIMENSIONS = {"box": 3, "cylinder": 2, "capsule": 2, "sphere": 1}


class ShapeGeometries:
    """Geometries by shape, each file read once."""

    def __init__(self, cache: ArrayCache) -> None:
        self._cache = cache
        self._known: dict[tuple[object, ...], CollisionGeometry | None] = {}

    def read(self, shape: MechanismShape) -> CollisionGeometry | None:
        """Return the geometry of a shape; None where its sizes are wrong, or its file is no longer the one that was checked."""
        key = (shape.kind, shape.size, shape.digest)
        if key not in self._known:
            self._known[key] = self._read_mesh(shape) if shape.kind == "mesh" else _make_primitive(shape)
        return self._known[key]

    def _read_mesh(self, shape: MechanismShape) -> CollisionGeometry | None:
        if not shape.file or not shape.digest or len(shape.size) != 3 or not all(map(math.isfinite, shape.size)):
            return None
        facts = recall_mesh(Path(shape.file), shape.digest, self._cache)
        if facts is None:
            return None
        vertices = facts.vertices * np.array(shape.size)
        return CollisionGeometry(kind="mesh", vertices=vertices, faces=facts.faces, closed=bool(facts.closed))


def _make_primitive(shape: MechanismShape) -> CollisionGeometry | None:
    is_sound = len(shape.size) == _DIMENSIONS.get(shape.kind) and all(0 < value < math.inf for value in shape.size)
    return CollisionGeometry(kind=shape.kind, size=shape.size) if is_sound else None
