"""A robot that is meant to stand by itself, upright on level ground with all joints at zero."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.facts.motion.contact import GroundSupport, TipOver, compute_ground_support, simulate_tipping
from urdfcheck.model.ground.support_polygon import (
    LEG,
    LinkMass,
    collect_robot_corners,
    is_free_standing,
    list_link_masses,
)
from urdfcheck.model.ground.wheels import rolling_wheels
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Indices, Vec3

# Tilt (degrees) at which a robot still counts as standing, unless a rule says otherwise.
REST = 5.0
# Beyond this tilt it lies on its side.
_FALLEN = math.radians(60)
# On two wheels or two feet, a controller keeps it upright.
_FEWEST_BODIES = 3


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Stance:
    """A robot that stands, in root coordinates (m)."""

    points: Array
    """(n, 3) whose convex hull is that of the robot."""
    owners: Indices
    """(n,) the place of each point's link in the tree's order."""
    weights: tuple[LinkMass, ...]
    com: Vec3
    supports: tuple[str, ...]
    """The links that touch the ground, or do when the robot is tilted a little."""
    now: GroundSupport
    """Upright, with the supports that touch."""

    def measure_rest_tilt(self, com: Vec3) -> TipOver:
        """Simulate how the robot, with its centre of mass at ``com``, tips until it rests or lies on its side."""
        return simulate_tipping(self.points, self.owners, com, limit=_FALLEN)


def find_stance(model: Model, rest: float = REST) -> Stance | None:
    """Find how a robot stands; None for one that is not meant to stand by itself, or whose base has no mass.

    :param rest: tilt in degrees by which links may be lifted that carry it.
    :raises FactUnavailableError: when the tree is broken, or a shape, a mass or an origin is not known.
    """
    wheels = {wheel.joint.child: wheel for wheel in rolling_wheels(model)}
    if not is_free_standing(model):
        return None
    weights = list_link_masses(model)
    base = model.tree.list_body_links(model.tree.root)
    if not any(weight.link.name in base for weight in weights):
        return None  # these are not the masses of a robot
    points, owners = collect_robot_corners(model, wheels)
    if not len(points):
        return None
    com = np.average([w.com for w in weights], axis=0, weights=[w.mass for w in weights])
    supports = _find_ground_links(model, points, owners, com, math.radians(rest))
    if not _is_standing(model, supports, wheels):
        return None
    now = compute_ground_support(points, parts=owners, com=com)
    return Stance(points=points, owners=owners, weights=weights, com=com, supports=tuple(supports), now=now)


def _find_ground_links(model: Model, points: Array, owners: Indices, com: Vec3, rest: float) -> list[str]:
    """Return the links that touch the ground, or do when the robot is tilted by ``rest`` (rad)."""
    heights = points[:, 2] - points[:, 2].min()
    reach = np.linalg.norm(points[:, :2] - com[:2], axis=1)
    down = sorted(set(owners[heights <= math.tan(rest) * reach].tolist()))  # np.unique would load numpy.ma
    return [model.tree.order[i] for i in down]


def _is_standing(model: Model, supports: Sequence[str], wheels: Collection[str]) -> bool:
    """Whether the robot is meant to stand by itself: on three bodies, wheels among them, or on three legs."""
    if len({model.tree.list_body_links(name)[0] for name in supports}) < _FEWEST_BODIES:
        return False
    if wheels:  # most of them touch, unless the root's z does not point up
        return 2 * sum(name in wheels for name in supports) > len(wheels)
    return all(_is_leg(model, name) for name in supports)


def _is_leg(model: Model, name: str) -> bool:
    path = [joint for joint in model.tree.find_path_to(name) if joint.is_movable]
    return len(path) > 1 and any(LEG.search(f"{joint.name} {joint.child}") for joint in path)
