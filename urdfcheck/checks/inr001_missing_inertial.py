"""INR001 reports moving bodies without an `<inertial>`."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.model import Link, Model
from urdfcheck.model.rigid_bodies import RigidLinkGroup, list_rigid_bodies

# What MuJoCo does with a body that has no mass, and what Pinocchio and Drake do where it has to hold something, or nothing.
INFERS = "replaces what is missing by mass and inertia of the collision geometry at 1000 kg/m³"
REFUSES = "refuses to compile: mass and inertia of moving bodies must be larger than mjMINVAL"
LIGHT = "loads it without mass"
NAN = "computes NaN accelerations: a joint moves what has no mass (Drake stops with an error)"


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    moving = [body for body in list_rigid_bodies(model) if body.is_movable]
    if not moving:
        return
    if all(link.inertial is None for link in model.links):
        name = model.robot.attributes.get("name")
        at = model.location if name is None else name.location
        solid = all(_has_collision(model, body) for body in moving)
        told = {"mujoco": INFERS if solid else REFUSES}
        yield rule.finding(
            "kinematic", at=at, severity=Severity.INFO, consequences=told, robot=model.name, links=len(model.links)
        )
        return
    if "bullet" in model.targets:
        yield from _check_assumed_masses(rule, moving, model)
    for body in moving:
        links = [model.link_by_name[name] for name in body.links]
        if any(link.inertial is not None for link in links):
            continue
        head = links[0]
        behind, heavy = _inspect_subtree(model, body)
        message = "missing" if any(link.visuals or link.collisions for link in links) else "frame"
        yield rule.finding(
            message,
            at=head,
            consequences={
                "mujoco": INFERS if _has_collision(model, body) else REFUSES,
                **dict.fromkeys(("pinocchio", "drake"), LIGHT if heavy else NAN),
            },
            link=head.name,
            joint=model.tree.parent_joint[head.name].name,
            behind=behind,
        )


def _check_assumed_masses(rule: Rule, moving: list[RigidLinkGroup], model: Model) -> Iterator[Finding]:
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
            links=join_names(link.name for link in frames),
            count="one link" if len(frames) == 1 else f"{len(frames)} links",
            added=len(frames),
        )


def _has_collision(model: Model, body: RigidLinkGroup) -> bool:
    """Whether the body has geometry that MuJoCo takes: it leaves out what is only drawn."""
    return any(model.link_by_name[name].collisions for name in body.links)


def _inspect_subtree(model: Model, body: RigidLinkGroup) -> tuple[int, bool]:
    """How many links hang on the body's first link, and whether any of them has a mass."""
    queue, count, heavy = [body.links[0]], -1, False
    while queue:
        count += 1
        inertial = model.link_by_name[queue[-1]].inertial
        heavy = heavy or (inertial is not None and bool(inertial.mass))
        queue.extend(joint.child for joint in model.tree.child_joints[queue.pop()])
    return count, heavy
