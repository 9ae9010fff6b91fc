"""DYN006 reports robots whose wheels and casters do not stand on one level ground, or whose body touches it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from urdfcheck.core import Finding, Located, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.ground.rest_pose import RestPose, find_rest_pose
from urdfcheck.model.ground.rest_words import describe_level_repair, describe_uneven_reason, locate_uneven_cause
from urdfcheck.model.ground.wheels import is_on_vertical_slide
from urdfcheck.model.repairs.origin_edits import locate_origin_attribute


def check(model: Model, rule: Rule, *, spread: float, least: float, lean: float) -> Iterator[Finding]:
    pose = find_rest_pose(model, spread, least)
    if pose is None:
        return
    hanging = [wheel for wheel in pose.driven if pose.heights[wheel.joint.child] > pose.tolerance]
    data: dict[str, Any] = {
        "supports": join_names(_list_supports(pose)),
        "tilt": math.degrees(pose.tilt),
        "reason": f"; {reason}" if (reason := describe_uneven_reason(pose)) else "",
        "repair": describe_level_repair(pose),
    }
    if hanging:
        gaps = [pose.heights[wheel.joint.child] for wheel in hanging]
        yield rule.finding(
            "unloaded",
            at=locate_uneven_cause(model, pose),
            related=[locate_origin_attribute(wheel.joint, "xyz") for wheel in hanging],
            wheels=join_names(wheel.joint.child for wheel in hanging),
            gap=max(gaps) * 1e3,
            **data,
        )
    elif math.degrees(pose.tilt) > lean:
        yield rule.finding("leans", at=locate_uneven_cause(model, pose), root=model.tree.root, **data)
    yield from _check_body(model, rule, pose, data)


def _check_body(model: Model, rule: Rule, pose: RestPose, data: dict[str, Any]) -> Iterator[Finding]:
    """Report the part that reaches farthest below the ground on which wheels and casters stand, if it collides."""
    carriers = {*(wheel.joint.child for wheel in pose.driven), *pose.casters}
    deep = {
        name: -height
        for name, height in pose.heights.items()
        if name not in carriers
        and -height > pose.tolerance
        and model.link_by_name[name].collisions
        # The ground lifts what slides up and down.
        and not is_on_vertical_slide(model, name)
    }
    if deep:
        link = max(deep, key=lambda name: deep[name])
        at: Located = model.link_by_name[link].collisions[0].element
        yield rule.finding("touches", at=at, link=link, depth=deep[link] * 1e3, **data)


def _list_supports(pose: RestPose) -> list[str]:
    carriers = dict.fromkeys((*(wheel.joint.child for wheel in pose.driven), *pose.casters))
    return [name for name in carriers if pose.heights[name] <= pose.tolerance]
