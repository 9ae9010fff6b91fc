"""INR001: what a joint moves has a mass."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.model import Model
from urdfcheck.model.body import Body, bodies


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    moving = [body for body in bodies(model) if body.moves]
    if not moving:
        return
    if all(link.inertial is None for link in model.links):
        name = model.robot.attributes.get("name")
        at = model.location if name is None else name.location
        yield rule.finding("kinematic", at=at, severity=Severity.INFO, robot=model.name, links=len(model.links))
        return
    for body in moving:
        links = [model.link_by_name[name] for name in body.links]
        if any(link.inertial is not None for link in links):
            continue
        head = links[0]
        drawn = any(link.visuals or link.collisions for link in links)
        yield rule.finding(
            "missing" if drawn else "frame",
            at=head,
            link=head.name,
            joint=model.tree.parent_joint[head.name].name,
            behind=_behind(model, body),
        )


def _behind(model: Model, body: Body) -> int:
    """How many links hang on the body's first link."""
    queue, count = [body.links[0]], -1
    while queue:
        count += 1
        queue.extend(joint.child for joint in model.tree.child_joints[queue.pop()])
    return count
