"""Shapes as solids: volume, COM and second moments of what a link draws or collides with."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from urdfcheck.model.parts import Link, Shape
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from urdfcheck.facts.inertials.inertia_tensor import Solid


def compute_drawn_scale(model: Model, shape: Shape) -> tuple[float, float, float] | None:
    """Return metres per file unit along the mesh's axes, as RViz and Gazebo draw it: the URDF scale times COLLADA's unit.

    None when the shape is not a mesh that could be read, or its scale is malformed.
    """
    facts, scale = model.meshes.get_facts(shape), shape.size
    if facts is None or scale is None or len(scale) != 3:
        return None
    unit = 1.0 if facts.unit is None else facts.unit
    return scale[0] * unit, scale[1] * unit, scale[2] * unit


def measure_link_solid(model: Model, link: Link, role: str = "visual") -> Solid | None:
    """Measure volume, COM and second moments of what a link draws (or collides with), in the link frame, as RViz draws it.

    None when it has no such shape, or one whose volume is not known (an unread or open mesh).
    """
    shapes = link.visuals if role == "visual" else link.collisions
    solids = [measure_shape_solid(model, shape) for shape in shapes]
    known = [s for s in solids if s is not None]
    if not known or len(known) != len(solids):
        return None
    from urdfcheck.facts.inertials.inertia_tensor import combine_solids  # loads numpy

    return combine_solids(known)


def measure_shape_solid(model: Model, shape: Shape) -> Solid | None:
    """Measure one shape, like `measure_link_solid`."""
    facts = model.meshes.get_facts(shape)
    size = shape.size if facts is None else compute_drawn_scale(model, shape)
    if size is None or any(s == 0 for s in size):
        return None
    if shape.kind == "mesh" and (facts is None or not facts.closed or not all(map(math.isfinite, facts.com))):
        return None
    pose = shape.origin.matrix
    if pose is None:
        return None
    turn, place = pose[:3, :3], pose[:3, 3]
    if facts is not None:
        from urdfcheck.facts.mesh.measure import compute_mesh_solid  # not where meshes are unknown

        return compute_mesh_solid(facts, size, rotation=turn, translation=place)
    if any(s < 0 for s in size):
        return None
    from urdfcheck.facts.inertials import inertia_tensor as inertia

    makers = {
        "box": lambda: inertia.make_box_solid(size),
        "cylinder": lambda: inertia.make_cylinder_solid(*size),
        "sphere": lambda: inertia.make_sphere_solid(*size),
        "capsule": lambda: inertia.make_capsule_solid(*size),
    }
    solid = makers[shape.kind or ""]()
    return inertia.transform_solid(solid, turn, place)
