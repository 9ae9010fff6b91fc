"""How far the surfaces of a mesh and of the one that replaces it are from each other."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field

import numpy as np

from urdfcheck.core.mechanism import MechanismShape
from urdfcheck.core.records import dataclass
from urdfcheck.facts.arrays import Array, Mat4
from urdfcheck.facts.comparison.home_pose import invert_pose
from urdfcheck.facts.mesh.surface_distance import measure_surface_distance
from urdfcheck.facts.motion.collision_geometry import CollisionGeometry

# Returns the geometry of a shape; None where it cannot be read.
GeometryReader = Callable[[MechanismShape], CollisionGeometry | None]

# Pairs of surfaces that are measured of one robot.
_MOST_SURFACES = 40


@dataclass(slots=True, eq=False)
class SurfaceComparison:
    """Measures surfaces of meshes, each two once and no more than some."""

    read: GeometryReader | None
    """None: nothing is measured."""
    _known: dict[tuple[object, ...], Mapping[str, float]] = field(default_factory=dict)

    def measure(self, first: MechanismShape, here: Mat4, second: MechanismShape, there: Mat4) -> Mapping[str, float]:
        """Return how far two meshes are from each other, their links' frames being at ``here`` and ``there``.

        ``surface_gone`` (m): the farthest that the first is from the second; ``surface_come``: the second from the first;
        ``surface_error``: by how much they may be larger. Nothing where one is not a mesh, or is not measured, or scipy is not
        installed.
        """
        is_mesh = first.kind == second.kind == "mesh" and first.digest and second.digest and first.pose and second.pose
        if self.read is None or not is_mesh:
            return {}
        apart = invert_pose(here @ _get_pose(first)) @ there @ _get_pose(second)
        key = (first.digest, first.size, second.digest, second.size, np.round(apart, 6).tobytes())
        if key not in self._known and len(self._known) < _MOST_SURFACES:
            self._known[key] = self._measure_anew(first, second, apart)
        return self._known.get(key, {})

    def _measure_anew(self, first: MechanismShape, second: MechanismShape, apart: Mat4) -> Mapping[str, float]:
        assert self.read is not None  # see measure
        one, other = self.read(first), self.read(second)
        if one is None or other is None:
            return {}
        assert one.vertices is not None  # of meshes
        assert one.faces is not None
        assert other.vertices is not None
        assert other.faces is not None
        moved = other.vertices @ apart[:3, :3].T + apart[:3, 3]
        try:
            found = measure_surface_distance(one.vertices, one.faces, moved, other.faces)
        except ImportError:  # urdfcheck-core leaves out scipy
            return {}
        if found is None:
            return {}
        return {"surface_gone": found.gone, "surface_come": found.come, "surface_error": found.error}


def _get_pose(shape: MechanismShape) -> Array:
    return np.array(shape.pose).reshape(4, 4)
