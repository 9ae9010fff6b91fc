"""LCH003 reports executables in a launch file that its generation of ROS has removed."""

from __future__ import annotations

from collections.abc import Iterator

from urdfcheck.core import Edit, Finding, Rule, Severity
from urdfcheck.core.records import dataclass
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.model.repairs.edits import edit_literals
from urdfcheck.source.launch.launch_file import Launch
from urdfcheck.source.launch.static_transforms import get_executable
from urdfcheck.source.ros.distributions import is_only_before
from urdfcheck.source.text.tokens import locate_text
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Attribute, Element


@dataclass(frozen=True, slots=True)
class _Successor:
    """The executable that replaces a removed one."""

    package: str
    executable: str
    since: str
    """The release that removed the old one."""
    effect: tuple[str, str]
    """The program that misses the old one, and what it does without."""
    arguments: str = ""
    """What a repair adds where it reads other arguments."""
    note: str = ""
    """What a repair adds about the releases that only have the old name."""

    @property
    def drop_in(self) -> bool:
        """Whether it reads the same arguments."""
        return not self.arguments


_OLD_SPAWNER = ", unless the robot stays on ROS 2 Foxy, which has only the old name"
_NO_FRAMES = ("rviz", "shows no robot, because nothing publishes its frames")
_NO_COMMAND = "refuses the launch file and starts nothing, because the command fails"
_NO_ROBOT = ("gazebo", "starts the world without the robot")
_SUCCESSORS = {
    "ros1": {
        ("robot_state_publisher", "state_publisher"): _Successor(
            "robot_state_publisher", "robot_state_publisher", "ROS Noetic (deprecated since 2012)", _NO_FRAMES
        ),
        ("xacro", "xacro.py"): _Successor("xacro", "xacro", "ROS Noetic", ("roslaunch", _NO_COMMAND)),
        ("gazebo", "spawn_model"): _Successor("gazebo_ros", "spawn_model", "ROS Hydro", _NO_ROBOT),
    },
    "ros2": {
        ("robot_state_publisher", "state_publisher"): _Successor(
            "robot_state_publisher", "robot_state_publisher", "ROS 2", _NO_FRAMES
        ),
        ("gazebo_ros", "spawn_model"): _Successor(
            "ros_gz_sim",
            "create",
            "ROS 2 (spawn_entity.py with Gazebo Classic)",
            _NO_ROBOT,
            arguments=" with its own arguments (`-topic robot_description -name …`), or gazebo_ros/spawn_entity.py with those of "
            "Gazebo Classic (`-topic robot_description -entity …`)",
        ),
        ("tf", "static_transform_publisher"): _Successor(
            "tf2_ros", "static_transform_publisher", "ROS 2", ("rviz", "misses the frame that the node would publish")
        ),
        ("rviz", "rviz"): _Successor("rviz2", "rviz2", "ROS 2", ("rviz", "fails to start")),
        ("xacro", "xacro.py"): _Successor("xacro", "xacro", "ROS 2", ("ros2_launch", _NO_COMMAND)),
        ("controller_manager", "spawner.py"): _Successor(
            "controller_manager",
            "spawner",
            "ROS 2 Humble",
            ("ros2_control", "runs without the controllers that the node would start"),
            note=_OLD_SPAWNER,
        ),
        ("controller_manager", "unspawner.py"): _Successor(
            "controller_manager",
            "unspawner",
            "ROS 2 Humble",
            ("ros2_control", "keeps the controllers running that the node would stop"),
            note=_OLD_SPAWNER,
        ),
    },
}


def check(context: LaunchContext, rule: Rule) -> Iterator[Finding]:
    launch = context.launch
    if launch.is_left_over:  # another name does not make it start
        return
    successors = _SUCCESSORS.get(launch.dialect, {})
    for node in launch.nodes:
        attribute = node.attributes.get("type") or node.attributes.get("exec")
        successor = successors.get((node.get("pkg"), get_executable(node)))
        if successor is not None and attribute is not None:
            yield rule.finding(
                "removed",
                at=attribute,
                edits=_propose_edits(node, attribute, successor) if successor.drop_in and not _has_period(node) else [],
                severity=_grade(successor, launch),
                consequences=dict([successor.effect]),
                old=f"{node.get('pkg')}/{attribute.value}",
                new=f"{successor.package}/{successor.executable}",
                since=successor.since,
                also="; delete the period, the last number of args"
                if _has_period(node)
                else successor.arguments or successor.note,
            )
    for description in launch.descriptions:
        script = description.words[0] if description.words and not description.is_from_include else ""
        successor = successors.get(("xacro", script.rpartition("/")[2]))
        is_own = script.startswith("/") and not script.startswith("/opt/ros/")  # a copy of xacro keeps what it has
        if successor is not None and not is_own:
            at = locate_text(description.at, "xacro.py", launch.files)
            edits = [] if at.span is None else [Edit(at.span, "xacro.py", "xacro")]
            yield rule.finding(
                "removed",
                at=at,
                edits=edits,
                severity=_grade(successor, launch),
                consequences=dict([successor.effect]),
                old="xacro/xacro.py",
                new="xacro/xacro",
                since=successor.since,
                also="",
            )


def _grade(successor: _Successor, launch: Launch) -> Severity | None:
    """Return the severity where it is not the usual one: an info if the project stays on releases that still have the old one.

    The robot starts there as it is: the line matters when it moves.
    """
    is_of_noetic = successor.since.startswith("ROS Noetic")
    return Severity.INFO if is_of_noetic and is_only_before("noetic", launch.finder) else None


def _has_period(node: Element) -> bool:
    """Whether a static transform ends in the period of tf, with which tf2_ros would misread nine words as a quaternion."""
    words = node.get("args").split()
    return node.get("pkg") == "tf" and len(words) in {9, 10} and parse_number(words[-1]) is not None


def _propose_edits(node: Element, attribute: Attribute, successor: _Successor) -> list[Edit]:
    wanted = ((node.attributes["pkg"], successor.package), (attribute, successor.executable))
    return edit_literals((part, text) for part, text in wanted if part.value != text)
