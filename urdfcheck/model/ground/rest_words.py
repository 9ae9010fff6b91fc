"""Why a robot does not stand level on its wheels and casters, in words, and where that is typed."""

from __future__ import annotations

import math
from collections.abc import Mapping

from urdfcheck.core import Location
from urdfcheck.core.text import join_names
from urdfcheck.model.ground.rest_pose import RestPose
from urdfcheck.model.repairs.origin_edits import locate_origin_attribute
from urdfcheck.model.robot import Model

# Angles (rad) of an rpy this near to a quarter turn do not lean.
_QUARTER = 0.001
# Smaller inclinations (rad) are not worth a word.
_INCLINED = 0.01


def find_odd_casters(pose: RestPose) -> dict[str, float]:
    """Find the casters that end at another height than the wheels, the one that is farthest below or above first.

    Parts of a caster that hang above its wheel are not meant: only the lowest count, unless all are too high. Then those
    at the height of the one on which the robot leans are meant, whichever hangs lower.
    """
    lowest = {name: drop for name, drop in pose.drops.items() if drop > pose.tolerance}
    if lowest:
        return dict(sorted(lowest.items(), key=lambda item: -item[1]))
    nearest = max(pose.drops.values(), default=0.0)
    if nearest < -pose.tolerance:
        borne = (drop for name, drop in pose.drops.items() if pose.heights[name] <= pose.tolerance)
        level = max(borne, default=nearest)
        return {name: drop for name, drop in pose.drops.items() if abs(drop - level) < pose.tolerance}
    return {}


def describe_uneven_reason(pose: RestPose) -> str:
    """Say in words why a robot that leans or has wheels in the air does so; nothing where it does not."""
    odd = find_odd_casters(pose)
    if odd:
        drop = next(iter(odd.values()))
        verb = "end" if len(odd) > 1 else "ends"
        side = "below" if drop > 0 else "above"
        if _are_several_drops(pose, odd):
            return f"{_join_drops(odd)} {verb} {side} the lowest points of the driven wheels"
        return f"{join_names(odd)} {verb} {abs(drop) * 1e3:.3g} mm {side} the lowest points of the driven wheels"
    if pose.tilt > _INCLINED:
        return "the lowest points of wheels and casters are on one plane that is inclined in the root's frame"
    return ""


def _are_several_drops(pose: RestPose, odd: Mapping[str, float]) -> bool:
    """Whether casters end at different heights, so that no one distance levels them."""
    return max(odd.values()) - min(odd.values()) > pose.tolerance


def _join_drops(odd: Mapping[str, float]) -> str:
    return join_names(f"{name} ({abs(drop) * 1e3:.3g} mm)" for name, drop in odd.items())


def describe_level_repair(pose: RestPose) -> str:
    """Say in words what makes it stand level."""
    odd = find_odd_casters(pose)
    if odd:
        drop = next(iter(odd.values()))
        if _are_several_drops(pose, odd):
            return f"move each {'up' if drop > 0 else 'down'} by its distance: {_join_drops(odd)}"
        return f"move {join_names(odd)} {'up' if drop > 0 else 'down'} by {abs(drop) * 1e3:.3g} mm, or the wheels the other way"
    if pose.tilt > _INCLINED:
        return "correct the rpy of the joint that inclines the body with all its wheels, or the heights of the wheels"
    return "give wheels and casters lowest points of one height"


def locate_uneven_cause(model: Model, pose: RestPose) -> Location:
    """Return where the origin is typed that puts the odd caster at its height, or that inclines the body."""
    for name in find_odd_casters(pose):
        joint = model.tree.parent_joint.get(name)
        if joint is not None:
            return locate_origin_attribute(joint, "xyz")
    for joint in model.tree.find_path_to(pose.driven[0].joint.child):
        rpy = joint.origin.rpy or (0.0, 0.0, 0.0)
        if any(abs(math.remainder(angle, math.pi / 2)) > _QUARTER for angle in rpy[:2]):
            return locate_origin_attribute(joint, "rpy")
    return locate_origin_attribute(pose.driven[0].joint, "xyz")
