"""DYN006 reports robots whose wheels and casters do not stand on one level ground, or whose body touches it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from urdfcheck.core import Finding, Located, Location, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.ground.rest_pose import RestPose, find_rest_pose
from urdfcheck.model.repairs.origin_edits import locate_origin_attribute

# Angles (rad) of an rpy this near to a quarter turn do not lean.
_QUARTER = 0.001


def check(model: Model, rule: Rule, *, spread: float, least: float, lean: float) -> Iterator[Finding]:
    pose = find_rest_pose(model, spread, least)
    if pose is None:
        return
    hanging = [wheel for wheel in pose.driven if pose.heights[wheel.joint.child] > pose.tolerance]
    data: dict[str, Any] = {
        "supports": join_names(_list_supports(pose)),
        "tilt": math.degrees(pose.tilt),
        "reason": _describe_reason(pose),
        "repair": _describe_repair(pose),
    }
    if hanging:
        gaps = [pose.heights[wheel.joint.child] for wheel in hanging]
        yield rule.finding(
            "unloaded",
            at=_locate_cause(model, pose),
            related=[locate_origin_attribute(wheel.joint, "xyz") for wheel in hanging],
            wheels=join_names(wheel.joint.child for wheel in hanging),
            gap=max(gaps) * 1e3,
            **data,
        )
    elif math.degrees(pose.tilt) > lean:
        yield rule.finding("leans", at=_locate_cause(model, pose), root=model.tree.root, **data)
    yield from _check_body(model, rule, pose, data)


def _check_body(model: Model, rule: Rule, pose: RestPose, data: dict[str, Any]) -> Iterator[Finding]:
    """Report the part that reaches farthest below the ground on which wheels and casters stand, if it collides."""
    carriers = {*(wheel.joint.child for wheel in pose.driven), *pose.casters}
    deep = {
        name: -height
        for name, height in pose.heights.items()
        if name not in carriers and -height > pose.tolerance and model.link_by_name[name].collisions
    }
    if deep:
        link = max(deep, key=lambda name: deep[name])
        at: Located = model.link_by_name[link].collisions[0].element
        yield rule.finding("touches", at=at, link=link, depth=deep[link] * 1e3, **data)


def _list_supports(pose: RestPose) -> list[str]:
    carriers = dict.fromkeys((*(wheel.joint.child for wheel in pose.driven), *pose.casters))
    return [name for name in carriers if pose.heights[name] <= pose.tolerance]


def _find_odd_casters(pose: RestPose) -> dict[str, float]:
    """Find the casters that end at another height than the wheels, the one that is farthest below or above first.

    Parts of a caster that hang above its wheel are not meant: only the lowest count, unless all are too high.
    """
    lowest = {name: drop for name, drop in pose.drops.items() if drop > pose.tolerance}
    if lowest:
        return dict(sorted(lowest.items(), key=lambda item: -item[1]))
    nearest = max(pose.drops.values(), default=0.0)
    if nearest < -pose.tolerance:
        return {name: drop for name, drop in pose.drops.items() if drop > nearest - pose.tolerance}
    return {}


def _describe_reason(pose: RestPose) -> str:
    odd = _find_odd_casters(pose)
    if odd:
        drop = next(iter(odd.values()))
        verb = "end" if len(odd) > 1 else "ends"
        side = "below" if drop > 0 else "above"
        return f"{join_names(odd)} {verb} {abs(drop) * 1e3:.3g} mm {side} the lowest points of the driven wheels"
    return "the lowest points of wheels and casters are on one plane that is inclined in the root's frame"


def _describe_repair(pose: RestPose) -> str:
    odd = _find_odd_casters(pose)
    if odd:
        drop = next(iter(odd.values()))
        return f"move {join_names(odd)} {'up' if drop > 0 else 'down'} by {abs(drop) * 1e3:.3g} mm, or the wheels the other way"
    return "correct the rpy of the joint that inclines the body with all its wheels"


def _locate_cause(model: Model, pose: RestPose) -> Location:
    """Return where the origin is typed that puts the odd caster at its height, or that inclines the body."""
    for name in _find_odd_casters(pose):
        joint = model.tree.parent_joint.get(name)
        if joint is not None:
            return locate_origin_attribute(joint, "xyz")
    for joint in model.tree.find_path_to(pose.driven[0].joint.child):
        rpy = joint.origin.rpy or (0.0, 0.0, 0.0)
        if any(abs(math.remainder(angle, math.pi / 2)) > _QUARTER for angle in rpy[:2]):
            return locate_origin_attribute(joint, "rpy")
    return locate_origin_attribute(pose.driven[0].joint, "xyz")
