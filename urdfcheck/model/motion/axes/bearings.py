"""Joints beside the bearing that their parts show: the child is round about the axis, the parent about another line."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.likeness.round_surfaces import (
    Ring,
    RoundLine,
    RoundStrips,
    find_round_strips,
    join_strips,
)
from urdfcheck.model.motion.axes.bodies import DrawnBodies
from urdfcheck.model.parts import Joint, Shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.solids import compute_drawn_scale

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# Meshes with more triangles are not searched.
_MOST_FACES = 200_000
# A hub covers so much of a turn: a fillet or a rounded end covers a quarter or a half.
_HUB = 0.4
# A hub fits a bore if neither radius is more than so many times the other: a wall or a bearing is between them.
_FITS = 1.35
# Smaller ones (m) are screws and their holes.
_LEAST_HUB = 4e-3
# A bore that is farther away than its radius has to fit so closely: a part has several.
_FITS_FAR = 1.1
# A bore beside the axis is farther away than this (m): typed digits, a mesh that is a millimetre off; and within this reach:
# beyond it, a part has other bores.
_BESIDE, _REACH = 2e-3, 0.035
# A joint is not beside a bearing that is farther away than so many times the bearing's radius: it is beside a screw hole.
_MOST_RADII = 4.0
# Two axes are one line within this angle (rad) and distance (m).
_SAME_ANGLE, _SAME_PLACE = 0.02, 2e-3
# Corners are on one circle if heights and radii agree to this share of the radius; next to each other they are no farther apart
# than those of a ring of eight (rad).
_CIRCLE, _WIDEST_GAP = 2e-3, math.radians(46.0)
# Two bores are as far beside their axes within this distance (m).
_SAME_OFFSET = 1e-3
# A bore may be that of another joint of other bodies whose origin is so near (m): the second jaw of a gripper.
_NEIGHBOUR = 0.1
# A tilted axis is off by so many degrees: less is a mesh that is drawn askew. One along another coordinate is off by more.
_TILTED = (2.0, 30.0)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class BearingMismatch:
    """A joint whose axis is not that of the bearing of its parts; vectors in root coordinates."""

    joint: str
    kind: str
    """``beside``: the parent's bore is parallel to the axis; ``tilted``: it passes through the origin at a small angle;
    ``across``: both parts are round about a line that is across the axis."""
    amount: float
    """m for ``beside``, else degrees."""
    vector: Array
    """(3,): from the axis to the bore (m), or the direction of the bore."""
    radius: float
    """Of the bore (m)."""
    hub: float
    """Of the child (m)."""


def find_bearing_mismatches(bodies: DrawnBodies) -> list[BearingMismatch]:
    """Find the joints that turn about another line than the bearing that their parts show.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    model, surfaces = bodies.model, _Surfaces(bodies)
    found = []
    for name in model.tree.order[1:]:
        joint = model.tree.parent_joint[name]
        if joint.type not in {"revolute", "continuous"} or joint.name not in model.axes:
            continue
        place, axis = model.frames[joint.child][:3, 3], model.axes[joint.name]
        parent = surfaces.get(bodies.get_parent(joint))
        if parent is None or parent.list_rings_about(place, axis):
            continue
        child = surfaces.get(joint.child)
        if child is None:
            continue
        others = list(_iter_near_axes(model, joint))
        mismatch = compare_bearing(joint.name, place, axis, parent=parent, child=child, others=others)
        if mismatch is None or _shares_offset(bodies, joint, mismatch, parent):
            continue
        if not has_circle_about(surfaces.list_corners(bodies.get_parent(joint)), place, axis, mismatch.hub):
            found.append(mismatch)
    return found


def _shares_offset(bodies: DrawnBodies, joint: Joint, found: BearingMismatch, parent: RoundStrips) -> bool:
    """Whether the parent has its bore at the same place beside another joint too: then the mesh is off, and not one joint."""
    model, axis = bodies.model, bodies.model.axes[joint.name]
    head = bodies.get_parent(joint)
    for name in model.tree.order[1:] if found.kind == "beside" else ():
        other = model.tree.parent_joint[name]
        if other is joint or other.name not in model.axes or bodies.get_parent(other) != head:
            continue
        place, direction = model.frames[other.child][:3, 3], model.axes[other.name]
        is_parallel = _measure_angle(direction, axis) < math.degrees(_SAME_ANGLE)
        if not is_parallel or parent.list_rings_about(place, direction):
            continue
        for line in parent.list_parallel_lines(place, direction, _REACH):
            is_bore = any(ring.coverage >= _HUB and ring.radius >= _LEAST_HUB for ring in line.rings)
            if is_bore and np.linalg.norm(line.point - place - found.vector) < _SAME_OFFSET:
                return True
    return False


def has_circle_about(corners: Array, place: Array, axis: Array, hub: float) -> bool:
    """Whether corners (V, 3) make a circle about a line that fits a hub of this radius (m): a cylinder of uneven facets."""
    away = corners - place
    heights = away @ axis
    across = away - heights[:, None] * axis
    radii = np.linalg.norm(across, axis=1)
    fits = (radii >= max(_LEAST_HUB, hub / _FITS)) & (radii <= hub * _FITS)
    side = np.cross(axis, np.eye(3)[int(np.abs(axis).argmin())])
    angles = np.arctan2(across @ np.cross(axis, side), across @ side)
    cells = np.round(np.stack((heights, radii), axis=1)[fits] / (_CIRCLE * hub)).astype(np.int64)
    circles = np.unique(cells, axis=0, return_inverse=True)[1].ravel()
    for number in range(int(circles.max(initial=-1)) + 1):
        turn = np.sort(angles[fits][circles == number])
        gaps = np.diff(turn, append=turn[0] + math.tau)
        if float(gaps[gaps < _WIDEST_GAP].sum()) >= _HUB * math.tau:
            return True
    return False


class _Surfaces:
    """The round surfaces of bodies, each mesh searched once."""

    def __init__(self, bodies: DrawnBodies) -> None:
        self._bodies = bodies
        self._meshes: dict[tuple[int, tuple[float, ...]], RoundStrips | None] = {}
        self._placed: dict[str, RoundStrips | None] = {}

    def get(self, head: str) -> RoundStrips | None:
        """Return the round surfaces of a body's meshes in root coordinates; None where one is too large, or it has none."""
        if head not in self._placed:
            parts: list[RoundStrips | None] = [
                None if strips is None else strips.place(one.pose)
                for one in self._bodies.shapes.get(head, ())
                if one.shape.kind == "mesh"
                for strips in (self._search(one.shape),)
            ]
            known = [part for part in parts if part is not None]
            self._placed[head] = join_strips(known) if known and len(known) == len(parts) else None
        return self._placed[head]

    def list_corners(self, head: str) -> Array:
        """List the corners (V, 3) of a body's meshes in root coordinates."""
        placed = [one for one in self._bodies.placed[head] if one.geometry.vertices is not None]
        return np.concatenate([one.geometry.corners @ one.pose[:3, :3].T + one.pose[:3, 3] for one in placed])

    def _search(self, shape: Shape) -> RoundStrips | None:
        model = self._bodies.model
        facts, scale = model.meshes.get_facts(shape), compute_drawn_scale(model, shape)
        if facts is None or scale is None or facts.n_triangles > _MOST_FACES:
            return None
        key = (id(facts), scale)
        if key not in self._meshes:
            self._meshes[key] = find_round_strips(facts.vertices * np.array(scale), facts.faces)
        return self._meshes[key]


def compare_bearing(
    joint: str,
    place: Array,
    axis: Array,
    *,
    parent: RoundStrips,
    child: RoundStrips,
    others: Sequence[tuple[Array, Array]],
) -> BearingMismatch | None:
    """Compare a joint at a place (3,) about a unit axis (3,) with the round surfaces on both sides, in root coordinates.

    :param parent: a part that is not round about the axis.
    :param others: places and directions of the axes near it, to which a bore may belong.
    """
    hubs = child.list_rings_about(place, axis)
    if not hubs:
        return _find_across(joint, place, axis, parent=parent, child=child, others=others)
    beside = [
        (float(np.linalg.norm(line.point - place)), line, fit)
        for line in parent.list_parallel_lines(place, axis, _REACH)
        if (fit := _find_fit(line.rings, hubs)) and not _is_axis_of(line, others)
    ]
    if any(amount <= _BESIDE for amount, _, _ in beside):
        return None  # the bearing is there, a little off
    beside = [
        (amount, line, (bore, hub))
        for amount, line, (bore, hub) in beside
        if amount <= bore.radius or max(bore.radius, hub.radius) <= _FITS_FAR * min(bore.radius, hub.radius)
    ]
    if any(distance > _MOST_RADII * max(ring.radius for ring in fit) for distance, _, fit in beside):
        return None
    if beside and all(np.linalg.norm(line.point - beside[0][1].point) < _BESIDE for _, line, _ in beside):
        amount, line, (bore, hub) = beside[0]
        return BearingMismatch(
            joint=joint, kind="beside", amount=amount, vector=line.point - place, radius=bore.radius, hub=hub.radius
        )
    tilted = [
        (angle, line, fit)
        for line in parent.list_lines_through(place)
        if (fit := _find_fit(line.rings, hubs))
        and _TILTED[0] < (angle := _measure_angle(line.direction, axis)) < _TILTED[1]
        and not _is_axis_of(line, others)
    ]
    if tilted and not beside and _are_one(tilted):
        amount, line, (bore, hub) = tilted[0]
        return BearingMismatch(
            joint=joint, kind="tilted", amount=amount, vector=line.direction, radius=bore.radius, hub=hub.radius
        )
    return None


def _are_one(found: Sequence[tuple[float, RoundLine, tuple[Ring, Ring]]]) -> bool:
    """Whether all lines through one point have one direction."""
    first = found[0][1].direction
    return all(_measure_angle(line.direction, first) < math.degrees(_SAME_ANGLE) for _, line, _ in found)


def _find_across(
    joint: str,
    place: Array,
    axis: Array,
    *,
    parent: RoundStrips,
    child: RoundStrips,
    others: Sequence[tuple[Array, Array]],
) -> BearingMismatch | None:
    """Find the only line through the origin, across the axis, about which both parts are round."""
    found = []
    ends = child.list_lines_through(place)
    for line in parent.list_lines_through(place) if ends else ():
        angle = _measure_angle(line.direction, axis)
        if angle < _TILTED[1] or _is_axis_of(line, others):
            continue
        for end in ends:
            fit = _find_fit(line.rings, end.rings)
            if fit and _measure_angle(line.direction, end.direction) < math.degrees(_SAME_ANGLE):
                found.append((angle, line, fit))
    if not found or not _are_one(found):
        return None
    angle, line, (bore, hub) = found[0]
    return BearingMismatch(
        joint=joint, kind="across", amount=angle, vector=line.direction, radius=bore.radius, hub=hub.radius
    )


def _find_fit(bores: Sequence[Ring], hubs: Sequence[Ring]) -> tuple[Ring, Ring] | None:
    """Return the bore and the hub whose radii are nearest to each other, if one fits the other."""
    pairs = [
        (max(bore.radius, hub.radius) / min(bore.radius, hub.radius), bore, hub)
        for bore in bores
        for hub in hubs
        if min(bore.coverage, hub.coverage) >= _HUB and min(bore.radius, hub.radius) >= _LEAST_HUB
    ]
    best = min(pairs, key=lambda pair: pair[0], default=None)
    return None if best is None or best[0] > _FITS else (best[1], best[2])


def _iter_near_axes(model: Model, joint: Joint) -> Iterator[tuple[Array, Array]]:
    """Yield place and direction of the axes of other joints near a joint, and of those that its two bodies turn about: a part
    of a wrist is round about the axis before it, however far away that joint's origin is."""
    place, tree = model.frames[joint.child][:3, 3], model.tree
    bodies = {name for end in (joint.parent, joint.child) for name in tree.list_body_links(end)}
    for other in model.joints:
        if other is joint or other.name not in model.axes or not other.is_movable:
            continue
        at = model.frames[other.child][:3, 3]
        if not bodies.isdisjoint((other.parent, other.child)) or np.linalg.norm(at - place) < _NEIGHBOUR:
            yield at, model.axes[other.name]


def _is_axis_of(line: RoundLine, others: Sequence[tuple[Array, Array]]) -> bool:
    """Whether a line is the axis of another joint."""
    for place, axis in others:
        away = line.point - place
        off = float(np.linalg.norm(away - (away @ axis) * axis))
        if off < _SAME_PLACE and _measure_angle(line.direction, axis) < math.degrees(_SAME_ANGLE):
            return True
    return False


def _measure_angle(one: Array, other: Array) -> float:
    """Measure the angle (degrees, up to 90) between two lines along unit vectors (3,)."""
    return math.degrees(math.atan2(float(np.linalg.norm(np.cross(one, other))), abs(float(one @ other))))
