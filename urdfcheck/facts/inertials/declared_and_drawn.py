"""The two sides of every comparison: what an ``<inertial>`` declares, and what the link draws."""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Mat3, Vec3
    from urdfcheck.facts.inertials.inertia_tensor import Solid


@dataclass(frozen=True, slots=True, eq=False)
class DeclaredInertial:
    """The numbers of an ``<inertial>``."""

    mass: float
    """kg."""
    com: Vec3
    """In m, in the link's frame."""
    tensor: Mat3
    """Inertia in kg m² about the COM, in the axes of the inertial frame."""
    rotation: Mat3 = field(default_factory=lambda: np.eye(3))
    """Turns the axes of the inertial frame into those of the link."""

    @property
    def inertia(self) -> Mat3:
        """(3, 3) in kg m² about the COM in the link's axes."""
        turned: Mat3 = self.rotation @ self.tensor @ self.rotation.T
        return turned


@dataclass(frozen=True, slots=True, eq=False)
class Primitive:
    """A box, cylinder, sphere or capsule."""

    kind: str
    """``box`` | ``cylinder`` | ``sphere`` | ``capsule``."""
    size: tuple[float, ...]
    """In m: edges; radius and length; or the radius."""
    rotation: Mat3
    """Turns its axes into those of the link; a cylinder's is z."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class VisualGeometry:
    """The shapes that a link draws, in its frame (m), as bodies of uniform density."""

    solid: Solid
    """Filled; exact if ``closed``, otherwise open meshes are replaced by their convex hulls."""
    closed: bool
    """Whether all meshes are closed."""
    points: Array
    """(K, 3), with the same convex hull as the geometry."""
    hull: Solid | None = None
    """The convex hull, filled."""
    shell: Solid | None = None
    """The surface as a thin shell; its ``volume`` is the area."""
    box: Solid | None = None
    """The bounding box, filled."""
    pieces: tuple[Solid, ...] = ()
    """The solids of the separate shapes."""
    primitive: Primitive | None = None
    """The only shape, where it is not a mesh."""
