"""KIN007 reports robots without links."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import format_count
from urdfcheck.model import Model
from urdfcheck.model.link_graph import KinematicGraph

# What is missing in joints that join nothing, such as those of a list of actuators that a program of its own reads.
_OF_JOINTS = ("XML005 *", "KIN009 *", "JNT004 *", "JNT007 *")


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    KinematicGraph.from_model(model)  # raises if the xacro is not expanded: its links are still to come
    if model.joints and not model.links and not any(joint.parent or joint.child for joint in model.joints):
        yield rule.finding(
            "joints",
            at=model,
            severity=Severity.WARNING,
            robot=model.name,
            count=format_count(len(model.joints), "joint"),
            explains=list(_OF_JOINTS),
        )
    elif not model.links:
        yield rule.finding(
            "none", at=model, robot=model.name, repair=_describe_repair(model), explains=list(_OF_JOINTS)
        )


def _describe_repair(model: Model) -> str:
    """Say how the robot gets links: those of a xacro file may be in a macro that it does not call, or under a condition."""
    if model.source.is_xacro:
        return "call the macro that makes the robot, or check the conditions and arguments around its links"
    return "add a link" if model.robot.children else "write the robot, or delete the file"
