"""How a robot on wheels came to rest in a simulator, against how it should stand and roll."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from urdfcheck.core.records import dataclass
from urdfcheck.core.text import join_names
from urdfcheck.model.ground.rest_pose import carries_rollers, find_rest_pose, is_caster_joint
from urdfcheck.model.ground.rest_words import describe_uneven_reason
from urdfcheck.model.ground.wheels import Wheel, is_suspended, list_casters, rolling_wheels
from urdfcheck.model.robot import Model

if TYPE_CHECKING:
    from urdfcheck.core.drop_test import DropTest, ReleaseResult
    from urdfcheck.facts.arrays import Array

# A wheel that bears less than this share of an equal part of the weight bears nothing.
_NOTHING = 0.01
# As DYN006.
_SPREAD, _LEAST = 0.02, 5e-4
_FEWEST_CARRIERS = 3
# Contacts whose extent across is this part of that along are on one line.
_FLAT = 1e-3
# A COM this part of the radius off the axle makes a wheel roll.
_OFF_AXLE = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class StandingDefect:
    """What is wrong with how a robot on wheels stands."""

    kind: str
    """unloaded, touches, leans or rolls."""
    link: str
    """The link that shows it."""
    data: dict[str, Any]


def find_standing_defect(model: Model, test: DropTest, *, lean: float) -> StandingDefect | None:
    """Find the worst of what a drop shows of a robot on wheels; None where it is sound, or no robot on rigid wheels.

    :param lean: degrees that it may lean.
    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    wheels = [wheel for wheel in rolling_wheels(model) if not is_caster_joint(wheel.joint)]
    names = [wheel.joint.child for wheel in rolling_wheels(model)]
    if (
        len(wheels) < 2
        or test.fixed
        or any(is_suspended(model, name) or carries_rollers(model, name) for name in names)
    ):
        return None
    release = test.held if test.held.settled is not None else test.free
    if release.burst is None and not release.has_tipped:
        return next(_iter_defects(model, test, release, wheels, lean), None)
    return None


def list_supports(model: Model) -> list[str]:
    """List the wheels and casters, and the joints on the way to them, as subjects: what decides how the robot stands.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    links = dict.fromkeys((*(wheel.joint.child for wheel in rolling_wheels(model)), *list_casters(model)))
    joints = dict.fromkeys(joint.name for link in links for joint in model.tree.find_path_to(link))
    return [*(f"link[{link}]" for link in links), *(f"joint[{joint}]" for joint in joints)]


def _iter_defects(
    model: Model, test: DropTest, release: ReleaseResult, wheels: list[Wheel], lean: float
) -> Iterator[StandingDefect]:
    if not release.touching:
        return
    loads = {touching.link: touching.load for touching in release.touching}
    bodies = {wheel.joint.child: model.tree.list_body_links(wheel.joint.child) for wheel in wheels}
    ground = _fit_ground(release)
    gaps = _measure_gaps(model, ground)
    tolerance = max(_SPREAD * min(wheel.radius for wheel in wheels), _LEAST)
    # Of more than three supports on one plane it is a matter of rounding which bear weight.
    idle = [
        name
        for name, links in bodies.items()
        if sum(loads.get(link, 0.0) for link in links) < _NOTHING * test.weight / len(wheels)
        and gaps.get(name, math.inf) > tolerance
    ]
    reason = _describe_reason(model, wheels)
    data = {"reason": f"; {reason}" if reason else "", "on": join_names(loads), "weight": test.weight}
    casters = list_casters(model)
    rolling = {link for wheel in rolling_wheels(model) for link in model.tree.list_body_links(wheel.joint.child)}
    others = {name: load for name, load in loads.items() if name not in rolling and name not in casters}
    carries = len(wheels) + len(casters) >= _FEWEST_CARRIERS
    heavy = max(others, key=lambda name: others[name], default="")
    # A ball or a skid may be drawn with the body: it is no lower where it lifts nothing.
    hangs = idle or (casters and all(gaps.get(name, math.inf) > tolerance for name in casters))
    if carries and hangs and heavy and others[heavy] > _NOTHING * test.weight:
        yield StandingDefect("touches", heavy, {"load": others[heavy], **data})
    if release.settled is not None and idle:
        verb = "bears" if len(idle) == 1 else "bear"
        yield StandingDefect("unloaded", idle[0], {"wheels": join_names(idle), "bear": verb, **data})
    # A light caster sinks into MuJoCo's soft ground: only what the places of the contacts explain is a lean of the robot.
    tilt = math.degrees(min(release.tilt or 0.0, ground.lean))
    if carries and release.settled is not None and tilt > lean:
        yield StandingDefect("leans", model.tree.root, {"tilt": tilt, **data})
    free = test.free
    # The parts of a caster that is a chain of joints may spin while the robot stays where it is.
    moves = free.moving in rolling or free.moving in model.tree.list_body_links(model.tree.root)
    if carries and moves and free.burst is None and free.settled is None and free.rolls and not free.has_tipped:
        cause = _describe_heavy_side(model)
        yield StandingDefect("rolls", model.tree.root, {**data, "speed": 1e3 * (free.speed or 0.0), "reason": cause})


@dataclass(frozen=True, slots=True, eq=False)
class _Ground:
    """The plane on which a robot rests, in the root's frame; level where one or two contacts do not decide."""

    middle: Array
    """(3,), in m."""
    slope: Array
    """(2,), rise along x and y."""
    lean: float
    """Angle (rad) to the root's xy plane; infinite where the contacts do not decide it."""


def _fit_ground(release: ReleaseResult) -> _Ground:
    import numpy as np

    places = np.array([(*touching.place[:2], touching.lowest) for touching in release.touching])
    middle = places.mean(axis=0)
    slope, _, rank, _ = np.linalg.lstsq(places[:, :2] - middle[:2], places[:, 2] - middle[2], rcond=_FLAT)
    return _Ground(middle, slope, math.atan(float(np.linalg.norm(slope))) if rank > 1 else math.inf)


def _measure_gaps(model: Model, ground: _Ground) -> dict[str, float]:
    """Measure how far (m) the lowest point of each link is above the ground."""
    from urdfcheck.model.ground.support_polygon import collect_robot_corners

    points, owners = collect_robot_corners(model, {wheel.joint.child: wheel for wheel in rolling_wheels(model)})
    above = points[:, 2] - ground.middle[2] - (points[:, :2] - ground.middle[:2]) @ ground.slope
    return {model.tree.order[index]: float(above[owners == index].min()) for index in sorted(set(owners.tolist()))}


def _describe_heavy_side(model: Model) -> str:
    """Describe the wheel whose COM is the farthest off its axle: it rolls until that is at the bottom."""
    import numpy as np

    off: dict[str, float] = {}
    for wheel in rolling_wheels(model):
        inertial = model.link_by_name[wheel.joint.child].inertial
        if inertial is not None and inertial.origin.xyz is not None and wheel.joint.axis is not None:
            axis = np.array(wheel.joint.axis) / np.linalg.norm(wheel.joint.axis)
            com = np.array(inertial.origin.xyz)
            off[wheel.joint.child] = float(np.linalg.norm(com - (com @ axis) * axis)) / wheel.radius
    name = max(off, key=lambda one: off[one], default="")
    if not name or off[name] < _OFF_AXLE:
        return ""
    return f"; the COM of {name} is {off[name]:.0%} of its radius off the axle"


def _describe_reason(model: Model, wheels: list[Wheel]) -> str:
    pose = find_rest_pose(model, _SPREAD, _LEAST)
    if pose is not None:
        return describe_uneven_reason(pose)
    heights = {wheel.joint.child: 1e3 * float(wheel.contact[2]) for wheel in wheels}
    low = min(heights.values())
    return "lowest points of the wheels: " + ", ".join(
        f"{name} {height - low:.3g} mm" for name, height in heights.items()
    )
