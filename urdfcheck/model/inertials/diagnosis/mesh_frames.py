"""Inertials that are in the frame of the mesh: the origin of the ``<visual>`` was changed, or added, without them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.facts.inertials.certainty import PLACED
from urdfcheck.facts.inertials.hull_bounds import measure_extent
from urdfcheck.facts.inertials.inertial_fit import measure_inertial_mismatch
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.visual_solid import explain_collision_stand_in, measure_link_geometry

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array
    from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
    from urdfcheck.facts.inertials.diagnosis import Diagnosis
    from urdfcheck.facts.inertials.inertia_tensor import Solid
    from urdfcheck.model.parts import Link

# A COM that was computed from the mesh is there to within this share of the part's size, and so many times farther off before.
_SAME_PLACE, _FARTHER = 0.005, 20.0
# Collision shapes show a COM less exactly than the mesh.
_MUCH_FARTHER = 5.0
# Mistakes of the COM that fit some COM by chance; the COM of another part, of which nothing is known, included.
_OF_COM = frozenset({None, "com_unit", "decimal_point"})
# Mistakes of place and direction that look like half a turn of a mesh: they flip one coordinate, or permute them.
_OF_DIRECTION = frozenset({"unmirrored", "axes_permuted", "quarter_turn", "rpy_missing", "rpy_twice"})


def name_mesh_frames(
    model: Model, numbers: Mapping[str, DeclaredInertial], found: Mapping[str, Diagnosis]
) -> dict[str, Diagnosis]:
    """Return the verdicts with the cause ``mesh_frame`` where the origin of what a link draws brings the COM of its inertial to
    that of the drawn part."""
    return {
        name: _find_in_mesh_frame(model, model.link_by_name[name], numbers[name], one) for name, one in found.items()
    }


def _find_in_mesh_frame(model: Model, link: Link, declared: DeclaredInertial, diagnosis: Diagnosis) -> Diagnosis:
    is_sign = diagnosis.cause == "one_sign" and diagnosis.detail.startswith("com ")
    is_of_com = diagnosis.cause in _OF_COM | _OF_DIRECTION or is_sign
    if diagnosis.sound or not is_of_com or diagnosis.judged_by != "mesh" or not declared.com.any():
        return diagnosis
    pose = _get_common_origin(link)
    drawn = None if pose is None else measure_link_geometry(model, link)
    if pose is None or drawn is None or not drawn.closed:
        return diagnosis
    stand_in = explain_collision_stand_in(model, link)
    if stand_in == "unread" and is_sign:
        return _turn_to_collision(declared, diagnosis, pose=pose, solid=drawn.solid)
    if stand_in is not None or is_sign:
        return diagnosis
    turn, solid = pose[:3, :3], drawn.solid
    moved = replace(declared, com=turn @ declared.com + pose[:3, 3])
    tensor = declared.rotation.T @ turn @ declared.inertia @ turn.T @ declared.rotation
    # A tensor that does not become the part's in those axes was not in the mesh's frame.
    turned = replace(moved, tensor=tensor)
    as_typed, in_mesh = (measure_inertial_mismatch(one, solid.com, solid.covariance)[0] for one in (moved, turned))
    moved = turned if in_mesh < min(as_typed, PLACED) else moved
    left, before = (float(np.linalg.norm(one.com - solid.com)) for one in (moved, declared))
    if left > _SAME_PLACE * measure_extent(drawn.points) or before < _FARTHER * left:
        return diagnosis
    # Half a turn of a part with a plane of symmetry looks mirrored: the origin in the file shows which of the two it is.
    if diagnosis.cause in _OF_DIRECTION and (moved is not turned or in_mesh > PLACED):
        return diagnosis
    ruled_out = tuple(cause for cause in diagnosis.ruled_out if cause not in _OF_COM)
    return replace(diagnosis, ruled_out=ruled_out).name_cause("mesh_frame", moved, solid, unique=False)


def _turn_to_collision(declared: DeclaredInertial, diagnosis: Diagnosis, *, pose: Array, solid: Solid) -> Diagnosis:
    """Return the verdict with the cause ``mesh_frame`` where the COM of a link whose mesh cannot be read comes nearer to that of
    its collision shapes with the origin of the ``<visual>`` than with one sign flipped: half a turn flips two."""
    moved = replace(declared, com=pose[:3, :3] @ declared.com + pose[:3, 3])
    left, before = (float(np.linalg.norm(one.com - solid.com)) for one in (moved, declared))
    flipped = left if diagnosis.mended is None else float(np.linalg.norm(diagnosis.mended.com - solid.com))
    if left >= flipped or before < _MUCH_FARTHER * left:
        return diagnosis
    return diagnosis.name_cause("mesh_frame", moved, solid, unique=False)


def _get_common_origin(link: Link) -> Array | None:
    """Return the origin (4, 4) that all visual meshes of a link have; None where they have several, or none."""
    poses = [shape.origin.matrix for shape in link.visuals]
    if not poses or any(shape.kind != "mesh" for shape in link.visuals) or any(pose is None for pose in poses):
        return None
    first = poses[0]
    same = all(pose is not None and first is not None and np.abs(pose - first).max() < 1e-9 for pose in poses)
    return first if same and first is not None and np.abs(first - np.eye(4)).max() > 1e-9 else None
