"""How a rigid body stands on a plane: where it touches, and whether it tips over."""

from __future__ import annotations

import math
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from urdfcheck.facts.arrays import Array, Bools, Indices, Vec3


# An invisible tilt, 0.5°: what it brings to the ground counts as touching (a wheel 2 mm high, 0.25 m from the COM).
SLACK = math.radians(0.5)
# Rounding, as a fraction of the body's size: points this little above the lowest one are as low.
_ROUNDING = 1e-5
# The sole of a scanned or simplified foot is uneven: that of TALOS rises by up to 1 mm over 170 mm. What the slack brings down as
# the foot tilts about its lowest points touches with them, up to this fraction of the body's size (chosen: 1.8 mm for TALOS), so
# that the flanks of wheels do not where one link has several. A round foot is steeper than the slack next to its lowest point.
_SOLE_RISE = 1e-3
# Every turn onto another edge lowers the COM, so that no edge occurs twice; a smooth body of many corners has many edges.
_MAX_TURNS = 500


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class GroundSupport:
    """A body on a plane."""

    touching: Indices
    """(n,), indices of the points that touch."""
    polygon: Array
    """(k, 3), corners of the support polygon, anticlockwise from above."""
    margin: float
    """Distance from the COM's plumb line to the nearest edge (m), negative outside."""
    nearest: Vec3
    """The point of that edge nearest to the plumb line."""
    outwards: Vec3
    """Unit vector across that edge, in the plane."""
    height: float
    """Of the COM above the plane (m)."""

    @property
    def tip_angle(self) -> float:
        """Angle (rad) by which the plane can be tilted before the body tips over; negative if it tips over on level ground."""
        return math.atan2(self.margin, self.height)


@dataclass(frozen=True, slots=True, eq=False)
class TipOver:
    """How a body that is released on a plane comes to rest."""

    tilt: float
    """Angle from upright (rad); infinite if it does not come to rest."""
    last_contact: int | None
    """Index of the point that touches last; None if it rests as it was placed."""
    up: Vec3
    """Unit vector (3,) across the plane at the end, in the body's coordinates."""


def compute_ground_support(
    points: ArrayLike, *, parts: ArrayLike, com: ArrayLike, up: ArrayLike = (0.0, 0.0, 1.0), slack: float = SLACK
) -> GroundSupport:
    """Compute how a body of corners ``points`` (n, 3), placed upright, touches a plane across ``up`` (unit vector).

    The body consists of rigid parts; ``parts`` (n,) is the number of each point's part, from 0. A part touches with its lowest
    points if they are the lowest of all, or a tilt by ``slack`` (rad) about the COM's plumb line makes them so, and with those
    that a tilt by ``slack`` about the nearest of its lowest points makes as low: the sole of a foot.
    """
    corners, centre, vertical = (np.asarray(a, dtype=float) for a in (points, com, up))
    owners = np.asarray(parts)
    across = _build_plane_axes(vertical)
    flat, origin = corners @ across.T, centre @ across.T
    heights = corners @ vertical
    heights = heights - heights.min()
    lowest = np.full(int(owners.max()) + 1, np.inf)
    np.minimum.at(lowest, owners, heights)
    reach = np.linalg.norm(flat - origin, axis=1)
    size, slope = float(np.ptp(corners, axis=0).max()), math.tan(slack)
    rises = heights - lowest[owners]
    is_near_ground = heights <= np.maximum(slope * reach, _ROUNDING * size)
    near = np.flatnonzero(is_near_ground & (rises <= _SOLE_RISE * size))
    touching = near[_is_on_sole(flat[near], rises[near], owners[near], rounding=_ROUNDING * size, slope=slope)]
    order = _compute_planar_hull(flat[touching])
    outline = flat[touching][order]
    margin, nearest, outwards = _compute_support_margin(outline, origin)
    ground = float((corners @ vertical).min())
    return GroundSupport(
        touching=touching,
        polygon=corners[touching][order],
        margin=margin,
        nearest=nearest @ across + ground * vertical,
        outwards=outwards @ across,
        height=float(centre @ vertical) - ground,
    )


def _is_on_sole(flat: Array, rises: Array, owners: Indices, *, rounding: float, slope: float) -> Bools:
    """Return which points ``flat`` (n, 2) a tilt by ``slope`` about the nearest of their part's lowest points makes as low.

    ``rises`` (n,): how far they are above these."""
    is_touching: Bools = rises <= rounding
    is_lowest = is_touching.copy()
    for part in sorted(set(owners[~is_lowest].tolist())):
        others = np.flatnonzero((owners == part) & ~is_lowest)
        pivots = flat[(owners == part) & is_lowest]
        if not len(pivots):
            continue
        distances = np.full(len(others), np.inf)
        for pivot in pivots:  # one at a time: a mesh may have thousands of each
            np.minimum(distances, np.linalg.norm(flat[others] - pivot, axis=1), out=distances)
        is_touching[others] = rises[others] <= slope * distances
    return is_touching


def simulate_tipping(
    points: ArrayLike, parts: ArrayLike, com: ArrayLike, limit: float = math.pi / 2, *, slack: float = SLACK
) -> TipOver:
    """Simulate how a body as in `compute_ground_support` is placed upright (z up) and rolls from edge to edge until it rests.

    It rests where its tip angle is not more negative than ``slack`` (rad), by default the accuracy of typed numbers. Beyond
    ``limit`` (rad) the simulation stops, with an infinite ``tilt``.
    """
    corners, centre = np.asarray(points, dtype=float), np.asarray(com, dtype=float)
    up = np.array((0.0, 0.0, 1.0))
    touched = None
    for _ in range(_MAX_TURNS):
        now = compute_ground_support(corners, parts=parts, com=centre, up=up, slack=slack)
        tilt = math.atan2(float(np.linalg.norm(up[:2])), float(up[2]))
        if tilt > limit:
            break
        if now.tip_angle >= -slack:
            return TipOver(tilt, touched, up)
        from_edge = corners - now.nearest
        ahead, height = from_edge @ now.outwards, np.maximum(from_edge @ up, 0.0)
        angles = np.where(np.hypot(ahead, height) > 1e-9 * np.abs(from_edge).max(), np.arctan2(height, ahead), math.inf)
        touched = int(angles.argmin())
        angle = float(angles[touched])
        if not angle < math.pi:
            break
        up = math.cos(angle) * up - math.sin(angle) * now.outwards
    return TipOver(math.inf, touched, up)


def compute_rocking_gaps(contacts: ArrayLike) -> Array | None:
    """Compute how high (n,) each contact (n, 3) hangs above the plane on which the others stand, z up.

    Of the planes through three contacts with none below, the one where the highest contact hangs least. None if all contacts
    are on one line.
    """
    places = np.asarray(contacts, dtype=float)
    size = float(np.ptp(places, axis=0).max())
    best: Array | None = None
    for three in combinations(range(len(places)), 3):
        a, b, c = places[list(three)]
        normal = np.cross(b - a, c - a)
        if abs(normal[2]) <= 1e-3 * size**2:
            continue
        gaps = (places - a) @ normal / normal[2]
        gaps[list(three)] = 0.0
        if gaps.min() >= -1e-9 * size and (best is None or gaps.max() < best.max()):
            best = gaps
    return best


def _build_plane_axes(up: Array) -> Array:
    """Return two unit vectors (2, 3) that make a right-handed frame with ``up``."""
    first = np.cross(up, np.eye(3)[int(np.abs(up).argmin())])
    first /= np.linalg.norm(first)
    return np.array((first, np.cross(up, first)))


def _compute_planar_hull(flat: Array) -> list[int]:
    """Compute the corners of the convex hull of ``flat`` (n, 2), anticlockwise (Andrew, *Another efficient algorithm for convex
    hulls in two dimensions*, 1979)."""
    # Corners that differ only by rounding count as one: the turns between them are noise.
    grain = max(1e-9 * float(np.ptp(flat, axis=0).max()), 1e-300)
    flat = np.round(flat / grain)  # as they are sorted, or the chain would turn back at corners that change places
    _, distinct = np.unique(flat, axis=0, return_index=True)
    order = [int(i) for i in distinct]

    def build_half_hull(places: list[int]) -> list[int]:
        chain: list[int] = []
        for place in places:
            while len(chain) > 1 and _compute_turn(flat[chain[-2]], flat[chain[-1]], flat[place]) <= 0.0:
                chain.pop()
            chain.append(place)
        return chain

    lower, upper = build_half_hull(order), build_half_hull(order[::-1])
    return lower[:-1] + upper[:-1] or order[:1]


def _compute_turn(a: Array, b: Array, c: Array) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))


def _compute_support_margin(outline: Array, place: Array) -> tuple[float, Array, Array]:
    """Compute the distance from ``place`` (2,) to the nearest edge of a convex polygon, negative outside, the nearest point, and
    the unit vector from there away from the polygon."""
    starts, ends = outline, np.roll(outline, -1, axis=0)
    along = ends - starts
    squared = np.maximum((along**2).sum(axis=1), 1e-300)
    part = np.clip(((place - starts) * along).sum(axis=1) / squared, 0.0, 1.0)
    nearest = starts + part[:, None] * along
    distances = np.linalg.norm(nearest - place, axis=1)
    edge = int(distances.argmin())
    distance, foot = float(distances[edge]), nearest[edge]
    inside = len(outline) > 2 and all(_compute_turn(a, b, place) >= 0.0 for a, b in zip(starts, ends, strict=True))
    # On the edge itself the way out is across it.
    x, y = along[edge].tolist()
    length = math.hypot(x, y)
    normal = np.array((y / length, -x / length)) if length > 0.0 else np.array((1.0, 0.0))
    outwards = normal if inside or distance == 0.0 else (place - foot) / distance
    return (distance if inside else -distance), foot, outwards
