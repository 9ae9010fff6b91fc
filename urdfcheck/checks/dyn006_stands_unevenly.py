"""DYN006 reports robots whose wheels and casters do not stand on one level ground, or whose body touches it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from urdfcheck.core import Finding, Located, Location, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.ground.rest_pose import RestPose, find_rest_pose
from urdfcheck.model.ground.rest_words import (
    describe_level_repair,
    describe_uneven_reason,
    find_odd_casters,
    locate_uneven_cause,
)
from urdfcheck.model.ground.wheels import is_on_vertical_slide
from urdfcheck.model.parts import locate_geometry
from urdfcheck.model.repairs.origin_edits import locate_origin_attribute
from urdfcheck.model.shapes.corners import compute_shape_corners
from urdfcheck.model.shapes.displaced_collisions import DisplacedCollision, list_displaced_collisions

_RAISE = "raise or shorten the collision of {link}, or lower wheels and casters"
_COPY = "copy the <origin> of the <visual> to the <collision>"
_AS_DRAWN = "give the collision of {links} the shape and place of the visual, or move it if the visual is wrong"


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
    drawn_level = _find_casters_level_as_drawn(model, pose)
    place: Located | Location = locate_uneven_cause(model, pose)
    if drawn_level:
        place = locate_geometry(model.link_by_name[drawn_level[0]].collisions[0])
        data["reason"] += ", but not as drawn"
        data["repair"] = _AS_DRAWN.format(links=join_names(drawn_level))
    if hanging and data["supports"]:
        gaps = [pose.heights[wheel.joint.child] for wheel in hanging]
        yield rule.finding(
            "unloaded",
            at=place,
            related=[locate_origin_attribute(wheel.joint, "xyz") for wheel in hanging],
            wheels=join_names(wheel.joint.child for wheel in hanging),
            gap=max(gaps) * 1e3,
            **data,
        )
    elif not hanging and math.degrees(pose.tilt) > lean:
        yield rule.finding("leans", at=place, root=_name_body(model), **data)
    yield from _check_body(model, rule, pose, lean=lean, data=data)


def _name_body(model: Model) -> str:
    """Return the first link of the root's body that has a shape: a root called odom or base_footprint is only a frame."""
    base = model.tree.list_body_links(model.tree.root)
    shaped = (name for name in base if model.link_by_name[name].visuals or model.link_by_name[name].collisions)
    return next(shaped, model.tree.root)


def _find_casters_level_as_drawn(model: Model, pose: RestPose) -> list[str]:
    """List the casters that collide at another height than the wheels, if each of them is drawn at most half as far from it: then
    its collision shape is the cause, and to move the joint would spoil what is drawn."""
    odd = find_odd_casters(pose)
    for name, drop in odd.items():
        link, ends = model.link_by_name[name], []
        if not link.collisions:
            return []
        for shapes in (link.collisions, link.visuals):
            corners = [compute_shape_corners(model, one, circumscribed=False) for one in shapes]
            known = [points for points in corners if points is not None]
            if not corners or len(known) < len(corners):
                return []
            ends.append(min(float((points @ model.frames[name][2, :3]).min()) for points in known))
        # How much lower it is drawn than it collides.
        if abs(drop + ends[0] - ends[1]) > abs(drop) / 2:
            return []
    return list(odd)


def _check_body(model: Model, rule: Rule, pose: RestPose, *, lean: float, data: dict[str, Any]) -> Iterator[Finding]:
    """Report the part that reaches farthest below the ground on which wheels and casters stand, if it collides."""
    carriers = {*(wheel.joint.child for wheel in pose.driven), *pose.casters}
    # Where casters at another height lean the robot, what is above the lowest points of the wheels touches because of them.
    leans = math.degrees(pose.tilt) > lean and find_odd_casters(pose)
    deep = {
        name: -height
        for name, height in pose.heights.items()
        if name not in carriers
        and -height > pose.tolerance
        and not (leans and -pose.upright[name] <= pose.tolerance)
        and model.link_by_name[name].collisions
        # The ground lifts what slides up and down.
        and not is_on_vertical_slide(model, name)
    }
    if deep:
        link = max(deep, key=lambda name: deep[name])
        at: Located = model.link_by_name[link].collisions[0].element
        displaced = _find_displaced(model, pose, link)
        data |= {"reason": "", "repair": _RAISE.format(link=link)}
        if displaced is not None:
            collision, depth = displaced
            at = collision.collision.place
            drawn = "clears the ground" if depth <= pose.tolerance else f"reaches {depth * 1e3:.3g} mm below"
            data["reason"] = (
                f"; the collision is {collision.describe_gap()} off the visual of the same shape, which {drawn}"
            )
            data["repair"] = _COPY
        yield rule.finding("touches", at=at, link=link, depth=deep[link] * 1e3, **data)


def _find_displaced(model: Model, pose: RestPose, link: str) -> tuple[DisplacedCollision, float] | None:
    """Find the lowest collision of a link if it is not where the link draws the same shape, and the depth (m) below the ground at
    which the link ends where it is drawn; None if that is half of the depth or more."""
    drawn = {id(one.collision.shape): one for one in list_displaced_collisions(model) if one.link.name == link}
    lows: list[tuple[float, float, DisplacedCollision | None]] = []
    for shape in model.link_by_name[link].collisions:
        displaced = drawn.get(id(shape))
        ends = []
        for one in (shape, shape if displaced is None else displaced.visual.shape):
            points = compute_shape_corners(model, one, circumscribed=False)
            if points is None:
                return None
            ends.append(float((points @ model.frames[link][:3, :3].T @ pose.up).min()))
        lows.append((ends[0], ends[1], displaced))
    lowest, _, displaced = min(lows, key=lambda low: low[0])
    depth = lowest - pose.heights[link] - min(end for _, end, _ in lows)
    return None if displaced is None or depth >= -pose.heights[link] / 2 else (displaced, depth)


def _list_supports(pose: RestPose) -> list[str]:
    carriers = dict.fromkeys((*(wheel.joint.child for wheel in pose.driven), *pose.casters))
    return [name for name in carriers if pose.heights[name] <= pose.tolerance]
