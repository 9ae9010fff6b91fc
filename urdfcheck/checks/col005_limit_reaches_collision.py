"""COL005: no joint, moved alone, drives a link into another."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Location, Rule
from urdfcheck.core.text import listed
from urdfcheck.model import Joint, Model
from urdfcheck.model.motion.collisions import Reach, ensure_all_read, reaches


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    found = reaches(model)
    if found:
        joints = list({reach.joint.name: reach.joint for reach in found}.values())
        yield rule.finding(
            "reached",
            at=_place(joints[0]),
            related=[_place(joint) for joint in joints[1:]],
            reaches=listed(map(_words, found)),
        )
    ensure_all_read(model.collisions)


def _words(reach: Reach) -> str:
    unit = "m" if reach.joint.type == "prismatic" else "rad"
    limit = "turns freely" if reach.joint.type == "continuous" else f"limit {reach.limit:.4g}"
    return f"{reach.joint.name} at {reach.value:.4g} {unit} ({limit}; {reach.links[0]} and {reach.links[1]})"


def _place(joint: Joint) -> Location:
    return joint.location if joint.limit is None else joint.limit.location
