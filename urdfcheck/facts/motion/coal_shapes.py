"""Shapes as coal has them: built once for contacts (`collision`) and for distances (`gaps`)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Indices


def build_coal_primitive(coal: Any, kind: str, size: Sequence[float]) -> Any:
    """Return coal's box, sphere, cylinder or capsule; ``size`` as in `CollisionGeometry`, in any unit."""
    primitives = {"box": coal.Box, "sphere": coal.Sphere, "cylinder": coal.Cylinder, "capsule": coal.Capsule}
    return primitives[kind](*size)


def fill_coal_tree(tree: Any, vertices: Array, faces: Indices) -> Any:
    """Fill one of coal's empty trees of boxes with triangles (F, 3) of vertices (V, 3), and return it."""
    tree.beginModel(len(faces), len(vertices))
    tree.addVertices(np.ascontiguousarray(vertices))
    tree.addTriangles(np.ascontiguousarray(faces, dtype=np.int64))
    tree.endModel()
    return tree
