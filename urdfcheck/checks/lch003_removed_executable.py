"""LCH003: the executables that a launch file starts still exist."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from urdfcheck.core import Edit, Finding, Rule
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.source.launch.launch_file import get_executable
from urdfcheck.source.text.tokens import locate_text
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Attribute, Element


@dataclass(frozen=True, slots=True)
class _Successor:
    """What is started instead. ``drop_in``: it reads the same arguments."""

    package: str
    executable: str
    since: str
    drop_in: bool = True


_SUCCESSORS = {
    "ros1": {
        ("robot_state_publisher", "state_publisher"): _Successor(
            "robot_state_publisher", "robot_state_publisher", "ROS Noetic (deprecated since 2012)"
        ),
        ("xacro", "xacro.py"): _Successor("xacro", "xacro", "ROS Noetic"),
        ("gazebo", "spawn_model"): _Successor("gazebo_ros", "spawn_model", "ROS Hydro"),
    },
    "ros2": {
        ("robot_state_publisher", "state_publisher"): _Successor(
            "robot_state_publisher", "robot_state_publisher", "ROS 2"
        ),
        ("gazebo_ros", "spawn_model"): _Successor(
            "ros_gz_sim", "create", "ROS 2 (spawn_entity.py with Gazebo Classic)", drop_in=False
        ),
        ("tf", "static_transform_publisher"): _Successor("tf2_ros", "static_transform_publisher", "ROS 2"),
        ("rviz", "rviz"): _Successor("rviz2", "rviz2", "ROS 2"),
        ("xacro", "xacro.py"): _Successor("xacro", "xacro", "ROS 2"),
        ("controller_manager", "spawner.py"): _Successor("controller_manager", "spawner", "ROS 2 Humble"),
        ("controller_manager", "unspawner.py"): _Successor("controller_manager", "unspawner", "ROS 2 Humble"),
    },
}


def check(context: LaunchContext, rule: Rule) -> Iterator[Finding]:
    launch = context.launch
    successors = _SUCCESSORS.get(launch.dialect, {})
    for node in launch.nodes:
        attribute = node.attributes.get("type") or node.attributes.get("exec")
        successor = successors.get((node.get("pkg"), get_executable(node)))
        if successor is not None and attribute is not None:
            yield rule.finding(
                "removed",
                at=attribute,
                edits=_propose_edits(node, attribute, successor) if successor.drop_in and not _has_period(node) else [],
                old=f"{node.get('pkg')}/{attribute.value}",
                new=f"{successor.package}/{successor.executable}",
                since=successor.since,
            )
    for description in launch.descriptions:
        script = description.words[0] if description.words and not description.is_from_include else ""
        successor = successors.get(("xacro", script.rpartition("/")[2]))
        if successor is not None:
            at = locate_text(description.at, "xacro.py", launch.files)
            edits = [] if at.span is None else [Edit(at.span, "xacro.py", "xacro")]
            yield rule.finding(
                "removed", at=at, edits=edits, old="xacro/xacro.py", new="xacro/xacro", since=successor.since
            )


def _has_period(node: Element) -> bool:
    """Whether a static transform ends in the period of tf: tf2_ros would take nine words for a quaternion."""
    words = node.get("args").split()
    return node.get("pkg") == "tf" and len(words) in {9, 10} and parse_number(words[-1]) is not None


def _propose_edits(node: Element, attribute: Attribute, successor: _Successor) -> list[Edit]:
    wanted = ((node.attributes["pkg"], successor.package), (attribute, successor.executable))
    changed = [(a, value) for a, value in wanted if a.value != value]
    if any(a.span is None or not a.literal for a, _ in changed):
        return []
    return [Edit(a.span, a.typed, value) for a, value in changed if a.span is not None]
