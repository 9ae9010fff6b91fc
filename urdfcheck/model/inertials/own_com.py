"""COMs that are those of a mesh of their link, whatever other links say."""

from __future__ import annotations

import numpy as np

from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.hull_bounds import measure_extent
from urdfcheck.model.parts import Link
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_role_geometry

# A COM so near to a mesh's, as a share of its size, is that of the mesh (chosen: the rounding of numbers and facets), and another
# that is so many times farther is not.
_SAME_COM, _FARTHER = 1e-3, 3.0


def has_com_of_own_mesh(model: Model, link: Link, actual: DeclaredInertial, expected: DeclaredInertial) -> bool:
    """Whether the ``actual`` COM of a link is that of its visual or of its collision mesh, which the ``expected`` one is not: the
    part has another frame there, or the drawing of another link was copied."""
    for role, shapes in (("visual", link.visuals), ("collision", link.collisions)):
        if any(shape.mesh_filename is None for shape in shapes):
            continue  # a box around a part says nothing about its COM
        drawn = measure_role_geometry(model, link, role)
        if drawn is None or not drawn.closed:
            continue
        own, other = (float(np.linalg.norm(numbers.com - drawn.solid.com)) for numbers in (actual, expected))
        if own <= _SAME_COM * measure_extent(drawn.points) and other > _FARTHER * own:
            return True
    return False
