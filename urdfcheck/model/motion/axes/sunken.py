"""Joints whose limits drive the child's surface into the part that holds it, while the same limits the other way round do not."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.mesh.winding import are_inside
from urdfcheck.facts.motion.kinematics import compute_joint_motions
from urdfcheck.model.motion import poses
from urdfcheck.model.motion.axes.bodies import DrawnBodies
from urdfcheck.model.motion.axes.sweeps import get_open_sides
from urdfcheck.model.parts import Joint

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# Positions on either side, and the one that is tried first.
_STEPS, _FIRST = 6, 4
# Points on the child's surface, of which every fourth is tried first.
_POINTS, _FEW = 100, 4
# The share of them that is inside the parent is larger by so much. Of 302 one-sided joints of published robots, none differs by
# more than 0.033, and with the axis reversed 54 do by more than this.
_LEAST_DIFFERENCE = 0.1
# Parents with more triangles are left out.
_MOST_FACES = 150_000
# Steps of a sequence that spreads points evenly over a square (Roberts, 2018).
_SPREAD = (0.7548776662466927, 0.5698402909980532)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class SunkenSide:
    """A joint that drives its child into its parent on the side that its limits open, and not on the other."""

    joint: str
    declared: float
    """The far end of the declared range (rad)."""
    shares: tuple[float, float]
    """The part of the child's surface that is inside the parent, on average: on the declared side and on the other."""


def find_sunken_sides(bodies: DrawnBodies) -> list[SunkenSide]:
    """Find the revolute joints with one-sided limits that drive the child into the parent's meshes.

    :raises FactUnavailableError: when the tree is broken, or an origin or an axis is malformed.
    """
    model = bodies.model
    if len(bodies.shapes) < 2:
        return []
    joints = (model.tree.parent_joint[name] for name in model.tree.order[1:])
    sides = [(joint, found) for joint in joints if (found := get_open_sides(joint)) is not None]
    compared = [_compare_sides(bodies, joint, side) for joint, side in sides if joint.name in model.axes]
    return [sunken for sunken in compared if sunken is not None]


def _compare_sides(bodies: DrawnBodies, joint: Joint, sides: tuple[float, float]) -> SunkenSide | None:
    """Compare where the declared range leaves the mirrored one and its far end (rad) with the same on the other side."""
    parent, child = (_list_surfaces(bodies, head) for head in (bodies.get_parent(joint), joint.child))
    if not parent or not child or sum(map(len, parent)) > _MOST_FACES:
        return None
    points = _spread_points(np.concatenate(child))
    values = np.linspace(sides[0], sides[1], _STEPS + 1)[1:]
    # Most joints end here, after a few points in one position on either side.
    if _compare_shares(bodies, joint, values[[_FIRST]], _LEAST_DIFFERENCE / 2, points[::_FEW], parent) is None:
        return None
    shares = _compare_shares(bodies, joint, values, _LEAST_DIFFERENCE, points, parent)
    return None if shares is None else SunkenSide(joint=joint.name, declared=float(values[-1]), shares=shares)


def _compare_shares(
    bodies: DrawnBodies, joint: Joint, values: Array, least: float, points: Array, parent: Sequence[Array]
) -> tuple[float, float] | None:
    """Measure both shares of `SunkenSide`; None where they do not differ by ``least``."""
    declared = _measure_share(bodies, joint, values, points=points, parent=parent)
    if declared < least:
        return None
    other = _measure_share(bodies, joint, -values, points=points, parent=parent)
    return (declared, other) if declared - other >= least else None


def _list_surfaces(bodies: DrawnBodies, head: str) -> list[Array]:
    """List the triangles (F, 3, 3) of each mesh of a body, in root coordinates with all joints at zero."""
    found = []
    for one in bodies.placed.get(head, ()):
        vertices, faces = one.geometry.vertices, one.geometry.faces
        if vertices is not None and faces is not None and len(faces):
            found.append((vertices @ one.pose[:3, :3].T + one.pose[:3, 3])[faces])
    return found


def _spread_points(triangles: Array) -> Array:
    """Return points (N, 3) that are spread over a surface: as many on each part as it has area."""
    areas = np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1)
    total = np.cumsum(areas)
    numbers = np.arange(_POINTS) + 0.5
    owners = np.minimum(np.searchsorted(total, numbers / _POINTS * total[-1]), len(triangles) - 1)
    one, other = (numbers * step % 1.0 for step in _SPREAD)
    folded = one + other > 1.0  # beyond the diagonal of the square
    one, other = np.where(folded, 1.0 - one, one), np.where(folded, 1.0 - other, other)
    weights = np.column_stack((1.0 - one - other, one, other))
    points: Array = np.einsum("nc,ncx->nx", weights, triangles[owners])
    return points


def _measure_share(
    bodies: DrawnBodies, joint: Joint, values: Array, *, points: Array, parent: Sequence[Array]
) -> float:
    """Measure which part of the child's points is inside the parent's meshes, on average over some values of the joint (N,)."""
    frame = bodies.model.frames[joint.child]
    motions = compute_joint_motions(poses.normalize_axis(joint), values, rotates=True)
    moves = frame @ motions @ np.linalg.inv(frame)
    moved = np.einsum("nij,pj->npi", moves[:, :3, :3], points) + moves[:, None, :3, 3]
    placed = moved.reshape(-1, 3)
    inside = np.logical_or.reduce([are_inside(surface, placed) for surface in parent])
    return float(inside.mean())
