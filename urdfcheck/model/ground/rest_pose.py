"""The robot at rest on level ground: on which wheels and casters, and what hangs in the air or reaches below."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from urdfcheck.core.records import dataclass
from urdfcheck.model.fact import fact
from urdfcheck.model.ground.wheel_pair import find_lone_wheel_pair
from urdfcheck.model.ground.wheel_plane import find_uneven_wheels
from urdfcheck.model.ground.wheels import Wheel, is_on_vertical_slide, is_suspended, list_round_parts, rolling_wheels
from urdfcheck.model.parts import GROUND_NAMES, Joint
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.corners import ROUND_CORNERS
from urdfcheck.model.wheel_names import CASTER_NAME, NOT_DRIVEN_NAME, TRACK_NAME

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array, Indices

# Half a millimetre on a robot of two metres.
_EXACT = 2e-4
# On two it leans until something else touches.
_FEWEST = 3
# A robot that leans by more (rad) lies on something, and DYN004 reports it.
_FALLEN = math.radians(25)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class RestPose:
    """A robot on the wheels and casters that carry it; lengths in m."""

    driven: tuple[Wheel, ...]
    """The wheels that are not casters."""
    casters: tuple[str, ...]
    """The links of casters that have a shape, and of wheels that are not driven."""
    tilt: float
    """Angle (rad) of the root's z axis from the vertical."""
    up: Array
    """Unit vector (3,) to the vertical, in root coordinates."""
    heights: Mapping[str, float]
    """Height of the lowest point of each link with a shape above the ground; what does not carry may be below it."""
    upright: Mapping[str, float]
    """Height of the lowest point of each link with a shape above those of the driven wheels, in the root's frame."""
    drops: Mapping[str, float]
    """How far the lowest point of each caster is below those of the driven wheels, in the root's frame, where these are level."""
    tolerance: float
    """Smaller heights do not count."""


@fact
def find_rest_pose(model: Model, spread: float, least: float) -> RestPose | None:
    """Find how a robot on two or more driven wheels and what else carries it rests, with rigid parts and joints at zero.

    None where that is not decided: a wheel drives a track, which carries the robot, a round part that may be a wheel is as low as
    the wheels, a wheel or a caster is suspended, a wheel carries rollers that turn by themselves, has its
    shape beside its axle, all are hubs of larger parts, wheels of the robot differ among themselves (SYM006, SYM008), or it does
    not stand on wheels and casters alone.

    :param spread: part of the least radius of a driven wheel, and ``least`` (m), below which heights do not count.
    :raises FactUnavailableError: when the tree is broken, or a shape, a mass or an origin is not known.
    """
    wheels = {wheel.joint.child: wheel for wheel in rolling_wheels(model)}
    driven = tuple(wheel for wheel in wheels.values() if not is_caster_joint(wheel.joint))
    if len(driven) < 2 or model.tree.root in GROUND_NAMES or any(is_suspended(model, name) for name in wheels):
        return None
    if any(TRACK_NAME.search(f"{wheel.joint.name} {name}") for name, wheel in wheels.items()):
        return None
    if any(carries_rollers(model, name) for name in wheels):
        return None
    tolerance = max(spread * min(wheel.radius for wheel in driven), least)
    if _may_stand_on_others(model, wheels, tolerance):
        return None
    if _are_uneven(model, tolerance):
        return None

    import numpy as np

    from urdfcheck.facts.motion.contact import simulate_tipping
    from urdfcheck.model.ground.support_polygon import collect_robot_corners, list_link_masses

    masses = list_link_masses(model)
    base = model.tree.list_body_links(model.tree.root)
    if not any(mass.link.name in base for mass in masses):
        return None
    points, owners = collect_robot_corners(model, wheels)
    turned = (name for name, wheel in wheels.items() if wheel not in driven)
    casters = tuple(
        name
        for name in dict.fromkeys((*list_casters(model), *turned))
        if np.any(owners == model.tree.order.index(name))
    )
    if any(is_on_vertical_slide(model, name) for name in casters):
        return None
    carriers = [model.tree.order.index(name) for name in {*wheels, *casters}]
    carrying = np.isin(owners, carriers)
    com = np.average([mass.com for mass in masses], axis=0, weights=[mass.mass for mass in masses])
    if len(carriers) < _FEWEST:
        return None
    ends = [
        simulate_tipping(points[carrying], owners[carrying], place, _FALLEN, slack=_EXACT)
        for place in _list_load_cases(com, driven, tolerance)
    ]
    end = min(ends, key=lambda one: one.tilt)
    if not math.isfinite(end.tilt):
        return None
    heights = _measure_heights(model, points @ end.up, owners)
    ground = min(heights[model.tree.order[index]] for index in carriers)
    upright = _measure_heights(model, points[:, 2], owners)
    if any(abs(upright[wheel.joint.child] - float(wheel.contact[2])) > tolerance for wheel in driven):
        return None
    if all(_stands_on_fixed_part(model, wheel.joint.child, upright, tolerance) for wheel in driven):
        return None
    return RestPose(
        driven=driven,
        casters=casters,
        tilt=end.tilt,
        up=end.up,
        heights={name: height - ground for name, height in heights.items()},
        upright={name: height - min(float(wheel.contact[2]) for wheel in driven) for name, height in upright.items()},
        drops=_measure_drops(driven, {name: upright[name] for name in casters}, tolerance),
        tolerance=tolerance,
    )


def _list_load_cases(com: Array, driven: Sequence[Wheel], tolerance: float) -> list[Array]:
    """List the places (3,) of the COM that are tried: as it is, or on either side of one axle that it is above.

    Balanced on two wheels a robot tips to either side with the first movement. The corners that stand for a round wheel would
    hold a COM that is higher than the axle and above one of their edges, which a wheel does not have: it is tried beyond it.
    """
    import numpy as np

    axle = driven[-1].centre - driven[0].centre
    across = np.cross(axle, (0.0, 0.0, 1.0))
    length = float(np.linalg.norm(across))
    if len(driven) != 2 or not length > 0:
        return [com]
    across /= length
    offset, near = float((com - driven[0].centre) @ across), 2 * tolerance
    reach = near
    if com[2] >= driven[0].centre[2]:
        reach = max(near, 2 * math.tan(math.pi / ROUND_CORNERS) * max(wheel.radius for wheel in driven))
    if abs(offset) > reach:
        return [com]
    sides = (1.0, -1.0) if abs(offset) <= near else (math.copysign(1.0, offset),)
    return [com + side * reach * across for side in sides]


def is_caster_joint(joint: Joint) -> bool:
    """Whether the names of a joint and its child say that it is not driven."""
    names = f"{joint.name} {joint.child}"
    return bool(CASTER_NAME.search(names) or NOT_DRIVEN_NAME.search(names))


def list_casters(model: Model) -> list[str]:
    """List the links whose names, or whose joints' names, say caster."""
    found = []
    for name in model.tree.order:
        joint = model.tree.parent_joint.get(name)
        if CASTER_NAME.search(name) or (joint is not None and CASTER_NAME.search(joint.name)):
            found.append(name)
    return found


def _are_uneven(model: Model, tolerance: float) -> bool:
    """Whether the driven wheels differ among themselves: other rules report that, and the effect with it."""
    pair = find_lone_wheel_pair(model)
    if pair is not None:
        return abs(float(pair.left.contact[2] - pair.right.contact[2])) > tolerance
    return find_uneven_wheels(model, rel_tol=0.01, abs_tol=1e-4) is not None


def _may_stand_on_others(model: Model, wheels: Mapping[str, Wheel], tolerance: float) -> bool:
    """Whether a round part that turns, and is not known to be a wheel, reaches as low as the lowest of the wheels."""
    ground = min(wheel.bottom for wheel in wheels.values()) + tolerance
    return any(part.joint.child not in wheels and part.bottom <= ground for part in list_round_parts(model))


def carries_rollers(model: Model, wheel: str) -> bool:
    """Whether joints turn other parts on a wheel: an omnidirectional one stands on its rollers."""
    behind = (joint for name in model.tree.list_body_links(wheel) for joint in model.tree.child_joints[name])
    return any(joint.type in {"continuous", "revolute"} for joint in behind)


def _stands_on_fixed_part(model: Model, wheel: str, upright: Mapping[str, float], tolerance: float) -> bool:
    """Whether a part that is fixed to a wheel reaches lower: then the wheel is only its hub."""
    return any(upright.get(name, math.inf) < upright[wheel] - tolerance for name in model.tree.list_body_links(wheel))


def _measure_heights(model: Model, heights: Array, owners: Indices) -> dict[str, float]:
    lowest: dict[str, float] = {}
    for index in sorted(set(owners.tolist())):
        lowest[model.tree.order[index]] = float(heights[owners == index].min())
    return lowest


def _measure_drops(driven: tuple[Wheel, ...], casters: Mapping[str, float], tolerance: float) -> dict[str, float]:
    bottoms = [float(wheel.contact[2]) for wheel in driven]
    if max(bottoms) - min(bottoms) > tolerance:
        return {}
    return {name: min(bottoms) - height for name, height in casters.items()}
