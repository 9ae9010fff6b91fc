"""The robot on the ground, upright, all joints at zero: where it can touch, and where its mass is."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core import FactUnavailableError
from urdfcheck.core.records import dataclass
from urdfcheck.facts.motion.contact import GroundSupport
from urdfcheck.model.ground.wheels import Wheel, rolling_wheels
from urdfcheck.model.parts import GROUND_NAMES, Link, Shape, is_dummy_shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.corners import collect_shape_corners
from urdfcheck.model.wheel_names import CASTER_NAME

if TYPE_CHECKING:
    from collections.abc import Mapping

    from urdfcheck.facts.arrays import Array, Indices


LEG = re.compile(r"leg|foot|feet|hip|knee|ankle|thigh|calf|shank|tibia|toe", re.IGNORECASE)


@dataclass(frozen=True, slots=True, eq=False)
class LinkMass:
    """What a link weighs."""

    link: Link
    mass: float
    """kg"""
    com: Array
    """(3,), in root coordinates."""


def is_free_standing(model: Model) -> bool:
    """Whether the robot has wheels or legs and is not fixed to the ground.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    return model.tree.root not in GROUND_NAMES and bool(
        rolling_wheels(model) or any(LEG.search(link.name) for link in model.links)
    )


def list_link_masses(model: Model) -> tuple[LinkMass, ...]:
    """Return the links that have mass.

    :raises FactUnavailableError: when the tree is broken, or a mass or an origin is malformed or negative.
    """
    masses = []
    for link in model.links:
        inertial = link.inertial
        if inertial is None:
            continue
        pose = inertial.origin.matrix
        if inertial.mass is None or pose is None or inertial.mass < 0:
            raise FactUnavailableError(f"the mass or the COM of link {link.name!r} is not known")
        if inertial.mass > 0:
            masses.append(LinkMass(link, inertial.mass, (model.frames[link.name] @ pose)[:3, 3]))
    return tuple(masses)


def collect_robot_corners(model: Model, wheels: Mapping[str, Wheel]) -> tuple[Array, Indices]:
    """Collect points (n, 3) whose hull is that of the robot, and the index (n,) of each point's link in the tree's order.

    In root coordinates. Collision shapes count where a link has them, what it draws otherwise; a dummy shape does not, unless
    it is a caster, or one of several with which a link collides: such are the points on which a foot stands. ``wheels`` by link
    add the two lowest points of their treads, between which the corners of a mesh may hang in the air.

    :raises FactUnavailableError: when the tree is broken, or a shape is not known.
    """
    parts: list[Array] = []
    owners: list[int] = []
    for index, name in enumerate(model.tree.order):
        frame = model.frames[name]
        link = model.link_by_name[name]
        points = collect_shape_corners(model, _list_solid_shapes(link))
        if points is None:
            raise FactUnavailableError(f"a shape of link {name!r} is not known")
        placed = points @ frame[:3, :3].T + frame[:3, 3]
        wheel = wheels.get(name)
        if wheel is not None:
            side = wheel.width / 2 * wheel.axis
            placed = np.concatenate((placed, [wheel.contact - side, wheel.contact + side]))
        parts.append(placed)
        owners += [index] * len(placed)
    return np.concatenate(parts), np.array(owners, dtype=np.int64)


def _list_solid_shapes(link: Link) -> list[Shape]:
    """List the shapes with which a link may touch the ground."""
    shapes = list(link.collisions or link.visuals)
    if CASTER_NAME.search(link.name) or sum(map(is_dummy_shape, link.collisions)) > 1:
        return shapes
    return [shape for shape in shapes if not is_dummy_shape(shape)]


def compute_contact_points(model: Model, points: Array, owners: Indices, support: GroundSupport) -> dict[str, Array]:
    """Compute the middle (3,) of the points with which each link touches the ground, in root coordinates.

    ``points`` and ``owners`` as of `collect_robot_corners`.
    """
    touching, links = points[support.touching], owners[support.touching]
    return {model.tree.order[i]: touching[links == i].mean(axis=0) for i in sorted(set(links.tolist()))}
