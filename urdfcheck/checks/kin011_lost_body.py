"""KIN011 reports links of which a target makes no body: frames that it merges, and an empty root."""

from __future__ import annotations

import re
from collections.abc import Iterator

from urdfcheck.core import FactUnavailableError, Finding, Rule, Severity
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.gazebo import list_sensors
from urdfcheck.model.parts import GROUND_NAMES, Joint, Link
from urdfcheck.source.text.engine_reactions import has_mujoco_option

# Words in the names of frames that programs look up: those of sensors and tools.
_USED = re.compile(
    r"(?:^|_)(?:camera|optical|imu|lidar|laser|radar|gps|sensor|sonar|tool\d*|tcp|tip|ee|eef|sole|flange)(?:_|$)|end_?effector",
    re.IGNORECASE,
)


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    if "isaac" not in model.targets and "mujoco" not in model.targets:
        return
    try:
        used = _list_used_links(model)
    except FactUnavailableError:
        return
    if "mujoco" in model.targets and used and not has_mujoco_option(model.robot, "fusestatic", "false"):
        yield _build_finding(model, rule, "mujoco", used)
    if "isaac" in model.targets:
        empty = [link for link in used if _is_empty(link)]
        if empty:
            yield _build_finding(model, rule, "isaac", empty)
        yield from _check_root(model, rule)


def _list_used_links(model: Model) -> list[Link]:
    """Return the links on fixed joints that have a sensor of Gazebo, or the name of a sensor or tool."""
    sensed = {sensor.reference for sensor in list_sensors(model)}
    fixed = {name for name, joint in model.tree.parent_joint.items() if joint.type == "fixed"}
    return [link for link in model.links if link.name in fixed and (link.name in sensed or _USED.search(link.name))]


def _is_empty(link: Link) -> bool:
    """Whether a link has no mass, no moments of inertia and no shape."""
    inertial = link.inertial
    numbers = () if inertial is None else (inertial.mass, *(inertial.inertia_components or ()))
    return not link.visuals and not link.collisions and not any(numbers)


def _build_finding(model: Model, rule: Rule, message: str, links: list[Link]) -> Finding:
    first = links[0]
    return rule.finding(
        message,
        at=first.element.attributes["name"],
        related=[link.element.attributes["name"] for link in links[1:]],
        severity=Severity.INFO,
        links=join_names(link.name for link in links),
        body=model.tree.list_body_links(first.name)[0],
        link=first.name,
    )


def _check_root(model: Model, rule: Rule) -> Iterator[Finding]:
    """Report an empty root: each body on it is attached to the world by itself, which is meant if the root is the ground."""
    root = model.link_by_name[model.tree.root]
    joints = list(_iter_joints_of_bodies(model, root.name)) if _is_empty(root) else []
    if not joints:
        return
    joints.sort(key=lambda joint: joint.type != "fixed")  # a free base begins at a fixed one
    names = [joint.child for joint in joints]
    is_apart = len(joints) > 1 and root.name not in GROUND_NAMES
    if not is_apart and joints[0].type != "fixed":
        return
    yield rule.finding(
        "apart" if is_apart else "root",
        at=root.element.attributes["name"],
        related=joints,
        severity=None if is_apart else Severity.INFO,
        root=root.name,
        first=names[0],
        bodies=join_names(names),
        others=join_names(names[1:]),
        freed=f"Only {names[0]} gets" if joints[0].type == "fixed" else "None of them gets",
    )


def _iter_joints_of_bodies(model: Model, empty: str) -> Iterator[Joint]:
    """Yield the joints from an empty link, and from empty links fixed to it, to links that become bodies."""
    for joint in model.tree.child_joints[empty]:
        child = model.link_by_name[joint.child]
        if not _is_empty(child):
            yield joint
        elif joint.type == "fixed":
            yield from _iter_joints_of_bodies(model, child.name)
