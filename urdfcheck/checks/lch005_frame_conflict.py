"""LCH005 reports static transforms of a launch file that contradict the frames of the model."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from typing import Any

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import find_nearest_name, format_length
from urdfcheck.model import Model
from urdfcheck.model.ground.drive_plugins import list_drive_plugins
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.model.motion.fixed_base import list_bolted_links
from urdfcheck.model.parts import Joint
from urdfcheck.model.shapes.extent import find_lowest_point
from urdfcheck.source.launch.around.naming_files import any_file_names, is_started_in_project
from urdfcheck.source.launch.launch_file import Launch
from urdfcheck.source.launch.node_graph import build_launch_scene
from urdfcheck.source.launch.static_transforms import StaticTransform
from urdfcheck.source.package.finder import format_path
from urdfcheck.source.text.xml import COMMENT
from urdfcheck.system.files import read_text_or_nothing

# Numbers that were rounded differ by less: degrees and metres.
_SAME_ANGLE, _SAME_PLACE = 0.5, 1e-3
# The transform that the SolidWorks exporter writes into its gazebo.launch, whatever the robot is, and the name of its node.
_EXPORTED, _EXPORTED_NODE = ("base_link", "base_footprint", (0.0,) * 3, (0.0,) * 3), "tf_footprint_base"
# What else is not a use of its frame: the line itself in another launch file of the exporter, and a comment.
_NO_USE = re.compile(r"base_link\s+base_footprint\b|<!--.*?(?:-->|\Z)", re.DOTALL)
# The model that a launch file hands to Gazebo as a file, and what of a model may publish odometry.
_SPAWNED = re.compile(r"(?<![\w-])-file\s+\$\(find\s+([\w.-]+)\s*\)/([^\s$\"'<>]+\.(?:urdf|xacro))\b", re.IGNORECASE)
_ODOMETRY = re.compile(r"odom|drive|footprint", re.IGNORECASE)
# The files that name frames.
_NAMING = (".launch", ".xml", ".py", ".yaml", ".yml", ".urdf", ".xacro", ".rviz", ".cpp", ".lua", ".sdf", ".gazebo")
# A larger model is not read.
_LARGEST = 500_000


def check(context: LaunchContext, rule: Rule, *, height_tol: float, likeness: float) -> Iterator[Finding]:
    launch = context.launch
    if launch.is_left_over:  # nothing starts it
        return
    published = _is_published(launch, context.model) if context.model is not None and launch.transforms else False
    model = None if published is False else context.model
    where = "" if published else " if another launch file starts the publisher"
    placed = {t.child: t.parent for t in launch.transforms}
    for transform in launch.transforms:
        if model is not None and transform.child in model.link_by_name:
            yield from _check_model_link(rule, transform, model, placed, where=where)
        elif _is_footprint(transform, model):
            yield from _check_footprint(rule, launch, transform, model, height_tol=height_tol)
        elif model is not None and transform.parent not in placed:
            yield from _check_unknown_parent(rule, transform, model, likeness=likeness)


def _is_published(launch: Launch, model: Model) -> bool | None:
    """Whether a robot_state_publisher of the launch file gets the model; None if it starts none: another one may."""
    scene = build_launch_scene(launch)
    publishers = [n for n in scene.nodes if n.program.partition("/")[0] == "robot_state_publisher" and not n.off]
    parameters = {port for node in publishers for port in node.reads}
    read = {p.origin for p in scene.parameters if p.port in parameters}
    return format_path(model.source.path) in read if publishers else None


def _check_model_link(
    rule: Rule, transform: StaticTransform, model: Model, placed: Mapping[str, str], *, where: str
) -> Iterator[Finding]:
    """Report a transform to a link of the model, which only a root below the world needs.

    ``placed``: the parents that the launch file gives frames; ``where``: the condition of a repair.
    """
    joint = next((j for j in model.joints if j.child == transform.child), None)
    data: dict[str, Any] = {"parent": transform.parent, "child": transform.child}
    if joint is not None:
        repeats = joint.parent == transform.parent
        yield rule.finding(
            "repeated" if repeats else "second-parent",
            at=transform.at,
            related=[joint],
            joint=joint.name,
            where=where,
            other=joint.parent,
            root=_describe_root(model, transform, placed),
            apart=_describe_difference(transform, joint) if repeats else "",
            **data,
        )
    elif transform.child in _list_links_above(model, transform.parent):
        yield rule.finding("loop", at=transform.at, **data)


def _list_links_above(model: Model, link: str) -> set[str]:
    """Return the links that joints lead from to this one."""
    parents = {joint.child: joint.parent for joint in model.joints}
    above: set[str] = set()
    while link in parents and parents[link] not in above:
        link = parents[link]
        above.add(link)
    return above


def _describe_difference(transform: StaticTransform, joint: Joint) -> str:
    """Return `` 60° and 0.12 m apart`` where a static transform and a fixed joint place a frame differently; else nothing."""
    from urdfcheck.facts.motion.kinematics import build_origin_transform, compute_axis_angle, quaternion_to_matrix

    pose = joint.origin.matrix
    if pose is None or transform.xyz is None or joint.type != "fixed":
        return ""
    placed = build_origin_transform(transform.xyz, transform.rpy or (0.0, 0.0, 0.0))
    if transform.quaternion is not None:
        placed[:3, :3] = quaternion_to_matrix(transform.quaternion)
    angle = math.degrees(abs(compute_axis_angle(pose[:3, :3].T @ placed[:3, :3])[1]))
    distance = math.dist(pose[:3, 3], placed[:3, 3])
    parts = [f"{angle:.3g}°"] * (angle > _SAME_ANGLE) + [format_length(distance)] * (distance > _SAME_PLACE)
    return f" ({' and '.join(parts)} apart)" if parts else ""


def _describe_root(model: Model, transform: StaticTransform, placed: Mapping[str, str]) -> str:
    """Return the repair for a transform from a frame outside the robot, which may be meant to place the whole robot.

    Empty where the root would then have two parents, or be below itself.
    """
    children = {joint.child for joint in model.joints}
    roots = [name for name in model.link_by_name if name not in children]
    above = {transform.parent}
    while (frame := next((placed[f] for f in above if f in placed and placed[f] not in above), None)) is not None:
        above.add(frame)
    if not above.isdisjoint(model.link_by_name) or len(roots) != 1 or roots[0] in placed:
        return ""
    return (
        f"; or write the root {roots[0]} for {transform.child} if the node is to place the robot in {transform.parent}"
    )


def _is_footprint(transform: StaticTransform, model: Model | None) -> bool:
    """Whether the transform places the footprint below the link that should be its child."""
    if "footprint" not in transform.child or "footprint" in transform.parent:
        return False
    return transform.parent == "base_link" if model is None else transform.parent in model.link_by_name


def _check_footprint(
    rule: Rule, launch: Launch, transform: StaticTransform, model: Model | None, *, height_tol: float
) -> Iterator[Finding]:
    exported = (transform.parent, transform.child, transform.xyz, transform.rpy) == _EXPORTED
    # Others write the same numbers by hand.
    cause = "solidworks-exporter" if exported and transform.node.get("name").strip() == _EXPORTED_NODE else None
    # A drive plugin publishes odom → base_footprint unless it is told another frame.
    drives = model is not None and any(True for _ in list_drive_plugins(model))
    is_foreign = exported and model is None and _lacks_frames(launch, transform)
    if is_foreign or (exported and not drives and not _is_frame_used(launch, transform.child)):
        # What the exporter writes, and nothing starts, is a left-over as a whole.
        is_idle = cause is not None and not is_started_in_project(launch)
        unused = "footprint-idle" if is_idle else "footprint-unused"
        yield rule.finding(
            "footprint-foreign" if is_foreign else unused,
            at=transform.at,
            cause=cause,
            severity=Severity.INFO,
            parent=transform.parent,
            child=transform.child,
        )
        return
    common: dict[str, Any] = {
        "at": transform.at,
        "cause": cause,
        # Without the model nothing shows that the robot drives, and the exporter does not ask.
        "severity": Severity.INFO if (exported if model is None else list_bolted_links(model)) else None,
        "parent": transform.parent,
        "child": transform.child,
    }
    above = None if model is None else next((j for j in model.joints if j.child == transform.parent), None)
    if model is None or above is not None:
        yield rule.finding("footprint", repair=_describe_deletion(transform, above), **common)
        return
    lowest = None if transform.xyz is None else find_lowest_point(model, transform.parent)
    if lowest is None or transform.xyz is None or abs(lowest[0] - transform.xyz[2]) <= height_tol:
        repair = _describe_new_root(transform, place="", otherwise="the transform is right")
        yield rule.finding("footprint", repair=repair, **common)
        return
    ground, link = lowest
    yield rule.finding(
        "footprint-height",
        height=transform.xyz[2],
        ground=ground,
        off=abs(ground - transform.xyz[2]),
        link=link,
        repair=_describe_new_root(
            transform, place=f' at xyz="0 0 {-ground:.3f}"', otherwise=f"write z = {ground:.3f} in the transform"
        ),
        **common,
    )


def _lacks_frames(launch: Launch, transform: StaticTransform) -> bool:
    """Whether the only model that the launch file hands to Gazebo as a file has neither frame, and publishes no odometry."""
    places = {place.groups() for file in launch.files.values() for place in _SPAWNED.finditer(file.text)}
    if len(places) != 1:
        return False
    package, inside = places.pop()
    folder = launch.finder.find(package)
    path = None if folder is None else folder / inside
    if path is None or not launch.finder.can_open(path) or not path.is_file():
        return False
    text = COMMENT.sub("", read_text_or_nothing(path, _LARGEST))
    has_parts = "<link" in text and "<xacro:" not in text
    is_named = any(f'"{name}"' in text or f"'{name}'" in text for name in (transform.parent, transform.child))
    return has_parts and not is_named and _ODOMETRY.search(text) is None


def _is_frame_used(launch: Launch, frame: str) -> bool:
    """Whether a file of the project names the frame apart from the exporter's line, as far as that is known."""
    return any_file_names(launch, _NAMING, lambda _, text: frame in _NO_USE.sub("", text))


def _describe_new_root(transform: StaticTransform, *, place: str, otherwise: str) -> str:
    """Return the repair for each frame that odometry may publish: the launch file does not show which one it is."""
    child, parent = transform.child, transform.parent
    root = f"make {child} the root link of the model with a fixed joint to {parent}{place}, and delete the node"
    return f"if odometry publishes odom → {child}, {root}; if it publishes odom → {parent}, {otherwise}"


def _describe_deletion(transform: StaticTransform, above: Joint | None) -> str:
    """Return the repair where a new root of the model would be wrong, or may be: it could have the frame already."""
    if above is not None:
        return f"delete the node: joint {above.name} already makes {above.parent} the parent of {transform.parent}"
    return (
        f"delete the node; a robot that needs {transform.child} has it as the root link of its model, with a fixed joint to "
        f"{transform.parent}"
    )


def _check_unknown_parent(
    rule: Rule, transform: StaticTransform, model: Model, *, likeness: float
) -> Iterator[Finding]:
    """Report a parent that differs from a link by a letter or two; any other unknown parent may come from a driver."""
    near = find_nearest_name(transform.parent, model.link_by_name, likeness)
    if transform.parent not in model.link_by_name and near is not None:
        yield rule.finding("unknown-frame", at=transform.at, parent=transform.parent, child=transform.child, near=near)
