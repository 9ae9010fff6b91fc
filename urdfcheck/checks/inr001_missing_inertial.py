"""INR001: what a joint moves has a mass."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.model import Link, Model
from urdfcheck.model.body import Body, bodies
from urdfcheck.model.names import listed

# What a declared target drops, or refuses the whole file for, is an error.
LOST = {"missing": frozenset({"gazebo"}), "frame": frozenset({"gazebo", "mujoco"})}


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    moving = [body for body in bodies(model) if body.moves]
    if not moving:
        return
    if all(link.inertial is None for link in model.links):
        name = model.robot.attributes.get("name")
        at = model.location if name is None else name.location
        yield rule.finding("kinematic", at=at, severity=Severity.INFO, robot=model.name, links=len(model.links))
        return
    if "bullet" in model.targets:
        yield from _assumed(rule, moving, model)
    for body in moving:
        links = [model.link_by_name[name] for name in body.links]
        if any(link.inertial is not None for link in links):
            continue
        head = links[0]
        message = "missing" if any(link.visuals or link.collisions for link in links) else "frame"
        yield rule.finding(
            message,
            at=head,
            severity=Severity.ERROR if LOST[message].intersection(model.targets) else None,
            link=head.name,
            joint=model.tree.parent_joint[head.name].name,
            behind=_behind(model, body),
        )


def _assumed(rule: Rule, moving: list[Body], model: Model) -> Iterator[Finding]:
    """One finding of all links whose mass Bullet adds to a moving body that has a mass of its own."""
    frames: list[Link] = []
    for body in moving:
        links = [model.link_by_name[name] for name in body.links]
        bare = [link for link in links if link.inertial is None]
        if len(bare) < len(links):
            frames += bare
    if frames:
        yield rule.finding(
            "assumed",
            at=frames[0],
            related=frames[1:],
            links=listed(link.name for link in frames),
            count="one link" if len(frames) == 1 else f"{len(frames)} links",
            added=len(frames),
        )


def _behind(model: Model, body: Body) -> int:
    """How many links hang on the body's first link."""
    queue, count = [body.links[0]], -1
    while queue:
        count += 1
        queue.extend(joint.child for joint in model.tree.child_joints[queue.pop()])
    return count
