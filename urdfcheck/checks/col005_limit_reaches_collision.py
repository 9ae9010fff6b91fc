"""COL005 reports joints that, moved alone, drive one link into another."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.motion.collisions.self_collisions import ensure_all_shapes_read, self_collisions
from urdfcheck.model.motion.collisions.single_joint import JointCollision, find_joint_collisions

# Collisions in the message; the finding's data has all.
_MOST_NAMED = 3


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    reached = find_joint_collisions(model)
    if reached:
        joints = list({reach.joint.name: reach.joint for reach in reached}.values())
        first, *others = (joint.location if joint.limit is None else joint.limit.location for joint in joints)
        yield rule.finding(
            "reached",
            at=first,
            related=others,
            reaches=join_names(map(_format_reached_collision, reached), _MOST_NAMED),
            collisions=list(map(_list_reached_collision, reached)),
        )
    ensure_all_shapes_read(self_collisions(model))


def _list_reached_collision(reach: JointCollision) -> dict[str, Any]:
    limit = None if reach.joint.type == "continuous" else reach.limit
    return {"joint": reach.joint.name, "value": reach.value, "limit": limit, "links": list(reach.links)}


def _format_reached_collision(reach: JointCollision) -> str:
    limit = "continuous" if reach.joint.type == "continuous" else f"limit {reach.limit:.4g}"
    place = f"{reach.joint.name} at {reach.value:.4g} {reach.joint.position_unit}"
    return f"{place} ({limit}; {reach.links[0]} and {reach.links[1]})"
