"""How far the COM that was typed is from that of what the link draws."""

from __future__ import annotations

import numpy as np

from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.hull_bounds import measure_extent
from urdfcheck.model.parts import Link
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_link_geometry, measure_role_geometry

# A COM is that of a shell within this part of its radius of gyration.
_SAME_COM = 0.05
# A tensor is about another point where the COM is half a radius of gyration away.
_APART = 0.5
# A COM so near to a mesh's, as a share of its size, is that of the mesh (chosen: the rounding of numbers and facets), and another
# that is so many times farther is not.
_OF_MESH, _FARTHER = 1e-3, 3.0


def has_com_apart(model: Model, link: Link) -> bool:
    """Whether the COM is so far from that of what the link draws that the drawn part's tensor is about another point."""
    drawn, matrix = measure_link_geometry(model, link), None if link.inertial is None else link.inertial.origin.matrix
    if drawn is None or matrix is None:
        return False
    size = float(np.sqrt(np.trace(drawn.solid.covariance)))
    distance = float(np.linalg.norm(matrix[:3, 3] - drawn.solid.com))
    return distance > _APART * size


def has_com_of_shell(model: Model, link: Link) -> bool:
    """Whether the COM, which is not that of what the link draws as a solid, is that of its thin, hollow shell."""
    drawn, matrix = measure_link_geometry(model, link), None if link.inertial is None else link.inertial.origin.matrix
    if drawn is None or drawn.shell is None or matrix is None:
        return False
    size = float(np.sqrt(np.trace(drawn.shell.covariance)))
    far, near = (float(np.linalg.norm(matrix[:3, 3] - one.com)) for one in (drawn.solid, drawn.shell))
    return near < _SAME_COM * size < far


def has_com_of_own_mesh(model: Model, link: Link, actual: DeclaredInertial, expected: DeclaredInertial) -> bool:
    """Whether the ``actual`` COM of a link is that of its visual or of its collision mesh, which the ``expected`` one is not: the
    part has another frame there, or the drawing of another link was copied."""
    for role, shapes in (("visual", link.visuals), ("collision", link.collisions)):
        if any(shape.mesh_filename is None for shape in shapes) and not _is_drawn_as_it_collides(link):
            continue  # a box around a part says nothing about its COM
        drawn = measure_role_geometry(model, link, role)
        if drawn is None or not drawn.closed:
            continue
        own, other = (float(np.linalg.norm(numbers.com - drawn.solid.com)) for numbers in (actual, expected))
        if own <= _OF_MESH * measure_extent(drawn.points) and other > _FARTHER * own:
            return True
    return False


def _is_drawn_as_it_collides(link: Link) -> bool:
    """Whether a link draws the shapes with which it collides, wherever: then they are the part."""
    drawn, colliding = ([(shape.kind, shape.size) for shape in shapes] for shapes in (link.visuals, link.collisions))
    return bool(drawn) and drawn == colliding
