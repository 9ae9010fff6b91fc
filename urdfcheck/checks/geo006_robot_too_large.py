"""GEO006 reports robots of the size of buildings, whose lengths are in another unit than metres."""

from __future__ import annotations

import math
from collections.abc import Iterator

from urdfcheck.core import FactUnavailableError, Finding, Located, Rule
from urdfcheck.core.records import dataclass
from urdfcheck.model import Joint, Model
from urdfcheck.model.gazebo import is_held_still

# The units in which a robot is drawn, in metres, and the distances (m) that their robots have.
_UNITS = {"millimetres": 0.001, "centimetres": 0.01, "inches": 0.0254}
_SMALLEST, _LARGEST = 0.05, 10.0
# One origin is another mistake than a file in another unit if all others together are shorter than this share of it.
_ALONE = 0.1
# What follows from the size: parts lighter than air, and motors too weak for such levers.
_CONSEQUENCES = ("INR010 *", "DYN002 *")


@dataclass(frozen=True, slots=True, eq=False)
class _Reach:
    """A link and the part that carries it."""

    distance: float
    """m"""
    link: str
    joints: tuple[Joint, ...]
    """From the first that can move to the link."""


def check(model: Model, rule: Rule, *, largest: float) -> Iterator[Finding]:
    farthest = _find_farthest_link(model)
    if farthest is None or farthest.distance <= largest or is_held_still(model.robot):
        return
    lengths = {joint: _measure_offset(joint) for joint in farthest.joints}
    longest = max(farthest.joints, key=lengths.__getitem__)
    rest = sum(lengths.values()) - lengths[longest]
    is_alone = 0.0 < rest < _ALONE * lengths[longest]
    yield rule.finding(
        "one" if is_alone else "far",
        at=_locate_offset(longest),
        robot=model.name,
        joint=longest.name,
        parent=longest.parent,
        link=farthest.link,
        base=farthest.joints[0].parent,
        distance=farthest.distance,
        length=lengths[longest],
        rest=rest,
        readings=_describe_readings(lengths[longest] if is_alone else farthest.distance),
        explains=[] if is_alone else list(_CONSEQUENCES),
    )


def _find_farthest_link(model: Model) -> _Reach | None:
    """Find the link that is farthest from the parent of the first joint that moves it, all joints at zero."""
    try:
        placements = model.placements
    except FactUnavailableError:
        return None
    reaches = []
    for name, placement in placements.items():
        path = model.tree.find_path_to(name)
        first = next((i for i, joint in enumerate(path) if joint.is_movable and joint.type != "floating"), None)
        if first is not None:
            base = placements[path[first].parent]
            reaches.append(_Reach(math.dist(placement.place, base.place), name, tuple(path[first:])))
    return max(reaches, key=lambda reach: reach.distance, default=None)


def _locate_offset(joint: Joint) -> Located:
    origin = joint.origin.element
    return joint.element if origin is None else origin.attributes.get("xyz", origin)


def _measure_offset(joint: Joint) -> float:
    placement = joint.origin.placement
    return 0.0 if placement is None else math.hypot(*placement.place)


def _describe_readings(distance: float) -> str:
    """Say what a distance would be in the units that give the robot the size of one."""
    readings = [
        f"{distance * unit:.2g} m in {name}"
        for name, unit in _UNITS.items()
        if _SMALLEST <= distance * unit <= _LARGEST
    ]
    return f"It would be {' or '.join(readings)}" if readings else "No unit that robots are drawn in makes it one"
