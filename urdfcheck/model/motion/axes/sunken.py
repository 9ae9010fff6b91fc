"""Joints whose limits drive the child's surface into the parts that hold it, while the same limits the other way round do not."""

from __future__ import annotations

from collections.abc import Mapping
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
    from urdfcheck.facts.arrays import Array, Bools

    # By body: its surfaces, and which points are inside.
    Holders = dict[str, list[Array]]
    Insides = Mapping[str, Bools]

# Positions on either side, and those that are tried first: a part that swings through a thin one is out of it again at the end.
_STEPS, _FIRST = 6, (1, 4)
# Points on the child's surface, of which every fourth is tried first.
_POINTS, _FEW = 100, 4
# The share of them that is inside the parts before the joint is larger by so much. Of 268 one-sided joints of published robots,
# none differs by more than 0.043, and with the axis reversed 66 do by more than this (by the parent alone, 54).
_LEAST_DIFFERENCE = 0.1
# A part before the joint is named if it holds this share of them on average.
_NAMED = 0.01
# Parents with more triangles are left out, as is what comes before them where all together have more.
_MOST_FACES = 150_000
# Steps of a sequence that spreads points evenly over a square (Roberts, 2018).
_SPREAD = (0.7548776662466927, 0.5698402909980532)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class SunkenSide:
    """A joint that drives its child into the parts before it on the side that its limits open, and not on the other."""

    joint: str
    declared: float
    """The far end of the declared range (rad)."""
    shares: tuple[float, float]
    """The part of the child's surface that is inside the parts before it, on average: on the declared side and on the other."""
    into: tuple[str, ...]
    """The bodies that hold this part on the declared side, the one with the largest share first."""


def find_sunken_sides(bodies: DrawnBodies) -> list[SunkenSide]:
    """Find the revolute joints with one-sided limits that drive the child into the meshes of the parent and of what is before it.

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
    holders, child = _list_holders(bodies, joint), _list_surfaces(bodies, joint.child)
    if not holders or not child:
        return None
    points = _spread_points(np.concatenate(child))
    values = np.linspace(sides[0], sides[1], _STEPS + 1)[1:]
    # Most joints end here, after a few points in two positions on either side.
    few = values[list(_FIRST)]
    if _compare_shares(bodies, joint, few, _LEAST_DIFFERENCE / 2, points[::_FEW], holders) is None:
        return None
    found = _compare_shares(bodies, joint, values, _LEAST_DIFFERENCE, points, holders)
    if found is None:
        return None
    declared, other = found
    depths = {head: float(inside.mean()) for head, inside in declared.items()}
    return SunkenSide(
        joint=joint.name,
        declared=float(values[-1]),
        shares=(_measure_share(declared), _measure_share(other)),
        into=tuple(sorted((head for head, depth in depths.items() if depth >= _NAMED), key=lambda head: -depths[head])),
    )


def _compare_shares(
    bodies: DrawnBodies, joint: Joint, values: Array, least: float, points: Array, holders: Holders
) -> tuple[Insides, Insides] | None:
    """Find what is inside on either side; None where the shares do not differ by ``least``."""
    declared = _find_inside(bodies, joint, values, points=points, holders=holders)
    if _measure_share(declared) < least:
        return None
    other = _find_inside(bodies, joint, -values, points=points, holders=holders)
    return (declared, other) if _measure_share(declared) - _measure_share(other) >= least else None


def _measure_share(insides: Insides) -> float:
    """Measure which part of the points is inside any body, on average."""
    return float(np.logical_or.reduce(list(insides.values())).mean())


def _list_holders(bodies: DrawnBodies, joint: Joint) -> Holders:
    """List the surfaces of the body that holds a joint, and of those before it, as far as joints allow the position zero.

    Empty where the first has none that is known, or too many triangles.
    """
    parent = bodies.get_parent(joint)
    holders: Holders = {}
    count = 0
    for head in (parent, *reversed(bodies.list_above(joint))):
        surfaces = _list_surfaces(bodies, head)
        count += sum(map(len, surfaces))
        if count > _MOST_FACES or (head != parent and not _are_at_zero(bodies, head, joint)):
            break
        if surfaces:
            holders[head] = surfaces
    return holders if parent in holders else {}


def _are_at_zero(bodies: DrawnBodies, head: str, joint: Joint) -> bool:
    """Whether all joints between a body and a joint may be at zero."""
    path = bodies.model.tree.find_path_to(joint.parent)
    between = path[len(bodies.model.tree.find_path_to(head)) :]
    spans = [span for one in between if (span := one.position_range) is not None]
    return all(lower <= 0.0 <= upper for lower, upper in spans)


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


def _find_inside(bodies: DrawnBodies, joint: Joint, values: Array, *, points: Array, holders: Holders) -> Insides:
    """Find which of the child's points are inside each body's meshes at some values of the joint (N,)."""
    frame = bodies.model.frames[joint.child]
    motions = compute_joint_motions(poses.normalize_axis(joint), values, rotates=True)
    moves = frame @ motions @ np.linalg.inv(frame)
    moved = np.einsum("nij,pj->npi", moves[:, :3, :3], points) + moves[:, None, :3, 3]
    placed = moved.reshape(-1, 3)
    return {
        head: np.logical_or.reduce([are_inside(surface, placed) for surface in surfaces])
        for head, surfaces in holders.items()
    }
