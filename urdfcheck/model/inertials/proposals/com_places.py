"""How far the COM that was typed is from that of what the link draws."""

from __future__ import annotations

import numpy as np

from urdfcheck.model.parts import Link
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_link_geometry

# A COM is that of a shell within this part of its radius of gyration.
_SAME_COM = 0.05
# A tensor is about another point where the COM is half a radius of gyration away.
_APART = 0.5


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
