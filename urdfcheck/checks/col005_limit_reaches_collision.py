"""COL005 reports joints that, moved alone, drive one link into another."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import format_count, join_names
from urdfcheck.model import Model
from urdfcheck.model.motion.collisions.self_collisions import ensure_all_shapes_read, self_collisions
from urdfcheck.model.motion.collisions.single_joint import JointCollision, find_joint_collisions

# Collisions in the message; the finding's data has all.
_MOST_NAMED = 3
# Where collisions begin is known to a thousandth of a joint's range.
_SYMMETRIC = 0.01
# Nearer to the limit, the shapes are as inexact: rad, and a part of the way from zero.
_LEAST_ANGLE = 0.1
_LEAST_SLIDE = 0.05


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    everything = find_joint_collisions(model)
    by_message: dict[str, list[JointCollision]] = {"reached": [], "pose": [], "limbs": []}
    for reach in everything:
        by_message[_classify_collision(model, reach)].append(reach)
    for message, reached in by_message.items():
        if not reached:
            continue
        joints_by_name = {reach.joint.name: reach.joint for reach in reached}
        first, *others = (
            joint.location if joint.limit is None else joint.limit.location for joint in joints_by_name.values()
        )
        yield rule.finding(
            message,
            at=first,
            related=others,
            reaches=join_names(map(_format_reached_collision, reached), _MOST_NAMED),
            first=reached[0].joint.name,
            where=_format_places(reached),
            more=f" (+{format_count(len(joints_by_name) - 1, 'joint')})" if len(joints_by_name) > 1 else "",
            collisions=list(map(_list_reached_collision, reached)),
        )
    ensure_all_shapes_read(self_collisions(model))


def _classify_collision(model: Model, reach: JointCollision) -> str:
    if _meets_another_limb(model, reach):
        return "limbs"
    return "reached" if _is_wrong_limit(model, reach) else "pose"


def _is_wrong_limit(model: Model, reach: JointCollision) -> bool:
    """Whether the joint can never get to its limit: nothing else moves one link against the other, and the limit is not near."""
    joint = reach.joint
    if joint.type == "continuous":
        return False
    margin = _LEAST_SLIDE * abs(reach.limit) if joint.type == "prismatic" else _LEAST_ANGLE
    paths = [set(model.tree.find_path_to(name)) for name in reach.links]
    between = {other for other in paths[0] ^ paths[1] if other.is_movable}
    return abs(reach.limit - reach.value) > margin and all(
        other is joint or (other.mimic is not None and other.mimic.get("joint") == joint.name) for other in between
    )


def _meets_another_limb(model: Model, reach: JointCollision) -> bool:
    """Whether the other link has its own joints, like the next leg, and not only with what carries both."""
    paths = [model.tree.find_path_to(name) for name in reach.links]
    return all(any(joint.is_movable for joint in path if joint not in other) for path, other in (paths, paths[::-1]))


def _format_places(reached: Sequence[JointCollision]) -> str:
    """Say where the first of the joints collides, or collides first if it does on both sides of rest: ``±1.9 rad``."""
    joint = reached[0].joint
    values = [reach.value for reach in reached if reach.joint is joint]
    is_symmetric = len(values) == 2 and math.isclose(values[0], -values[1], rel_tol=_SYMMETRIC)
    nearest = min(values, key=abs)
    return f"{f'±{abs(nearest):.3g}' if is_symmetric else f'{nearest:.3g}'} {joint.position_unit}"


def _list_reached_collision(reach: JointCollision) -> dict[str, Any]:
    limit = None if reach.joint.type == "continuous" else reach.limit
    return {"joint": reach.joint.name, "value": reach.value, "limit": limit, "links": list(reach.links)}


def _format_reached_collision(reach: JointCollision) -> str:
    limit = "continuous" if reach.joint.type == "continuous" else f"limit {reach.limit:.4g}"
    place = f"{reach.joint.name} at {reach.value:.4g} {reach.joint.position_unit}"
    return f"{place} ({limit}; {reach.links[0]} and {reach.links[1]})"
