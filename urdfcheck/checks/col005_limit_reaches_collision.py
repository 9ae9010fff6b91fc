"""COL005 reports joints that, moved alone, drive one link into another."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Location, Rule
from urdfcheck.core.text import join_names
from urdfcheck.model import Joint, Model
from urdfcheck.model.motion.collisions import (
    JointCollision,
    ensure_all_shapes_read,
    find_joint_collisions,
    self_collisions,
)


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    found = find_joint_collisions(model)
    if found:
        joints = list({reach.joint.name: reach.joint for reach in found}.values())
        yield rule.finding(
            "reached",
            at=_locate(joints[0]),
            related=[_locate(joint) for joint in joints[1:]],
            reaches=join_names(map(_format_reached_collision, found)),
        )
    ensure_all_shapes_read(self_collisions(model))


def _format_reached_collision(reach: JointCollision) -> str:
    unit = "m" if reach.joint.type == "prismatic" else "rad"
    limit = "turns freely" if reach.joint.type == "continuous" else f"limit {reach.limit:.4g}"
    return f"{reach.joint.name} at {reach.value:.4g} {unit} ({limit}; {reach.links[0]} and {reach.links[1]})"


def _locate(joint: Joint) -> Location:
    return joint.location if joint.limit is None else joint.limit.location
