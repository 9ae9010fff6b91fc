"""Links whose shapes are placed at the COM: exporters write meshes whose origin is the COM, and give both one ``<origin>``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.inertials.hull_bounds import measure_extent
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia
from urdfcheck.model.fact import fact
from urdfcheck.model.likeness.declared_inertials import read_declared_inertial
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import measure_link_geometry

if TYPE_CHECKING:
    from urdfcheck.model.parts import Link

# Places of two elements are one if they agree to this length (m); a COM at the link's origin says nothing.
_SAME_PLACE = 1e-9
# A mesh whose origin is its COM has it there to within this share of its size.
_CENTRED = 0.05
# So many links show that a file draws its parts at their COMs.
_FEWEST = 3
# The most digits of a number that is typed.
_TYPED_DIGITS = 4
# A tensor is that of the mesh to within this share (Frobenius norms).
_SAME_TENSOR = 0.02


def has_shapes_at_com(link: Link) -> bool:
    """Whether all visual meshes of a link are placed where its COM is, which is not the link's origin."""
    xyz = None if link.inertial is None else link.inertial.origin.xyz
    if xyz is None or not np.abs(xyz).max() > _SAME_PLACE or not link.visuals:
        return False
    places = [shape.origin.xyz for shape in link.visuals if shape.kind == "mesh"]
    return len(places) == len(link.visuals) and all(
        place is not None and float(np.abs(np.subtract(place, xyz)).max()) <= _SAME_PLACE for place in places
    )


@fact
def list_parts_at_com(model: Model) -> tuple[str, ...]:
    """List the links, by name, whose meshes are placed at a COM that a program computed, unless a mesh was read that has its own
    COM elsewhere."""
    return tuple(
        link.name
        for link in model.links
        if has_shapes_at_com(link) and _has_computed_com(link) and _is_centred(model, link) is not False
    )


def describe_other_frame(model: Model, link: Link) -> str:
    """Say what shows that the mesh of a link, which is placed at the COM, has its origin elsewhere by mistake: other links of the
    file, or the tensor, which is the mesh's. Empty where nothing does."""
    if not has_shapes_at_com(link) or _is_centred(model, link) is not False:
        return ""
    others = len(list_parts_at_com(model))
    if others >= _FEWEST and _has_computed_com(link):
        return f"as in {others} other links"
    return "and mass and tensor are those of its mesh at uniform density" if _has_tensor_of_mesh(model, link) else ""


def _has_computed_com(link: Link) -> bool:
    """Whether a coordinate of the COM has so many digits that nobody typed it, or copied it from the shapes by hand."""
    xyz = () if link.inertial is None else link.inertial.origin.xyz or ()
    return any(float(f"{value:.{_TYPED_DIGITS - 1}e}") != value for value in xyz)


def _is_centred(model: Model, link: Link) -> bool | None:
    """Whether what a link draws has its COM at the declared one; None where it was not read."""
    drawn, declared = measure_link_geometry(model, link), read_declared_inertial(link)
    if drawn is None or declared is None:
        return None
    return float(np.linalg.norm(drawn.solid.com - declared.com)) <= _CENTRED * measure_extent(drawn.points)


def _has_tensor_of_mesh(model: Model, link: Link) -> bool:
    drawn, declared = measure_link_geometry(model, link), read_declared_inertial(link)
    if drawn is None or declared is None or not drawn.closed:
        return False
    uniform = compute_solid_inertia(drawn.solid, declared.mass)
    return float(np.linalg.norm(declared.inertia - uniform)) <= _SAME_TENSOR * float(np.linalg.norm(uniform))
