"""The data flow between the nodes of a launch file, as far as well-known programs have documented inputs and outputs.

The sources are the documentation and code of each program: robot_state_publisher, joint_state_publisher, tf2_ros,
RViz, gazebo_ros and ros_gz (``spawn_model``, ``spawn_entity.py``, ``create``, ``parameter_bridge``), controller_manager, MoveIt.
No edge is drawn for any other program.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from urdfcheck.core.records import dataclass
from urdfcheck.core.scene import SceneLaunch, SceneNode, SceneParameter, ScenePort
from urdfcheck.source.launch.launch_file import Launch
from urdfcheck.source.launch.nodes_python import read_python_actions
from urdfcheck.source.launch.nodes_xml import (
    MOST_NAMES,
    LaunchAction,
    LaunchContents,
    read_launch_actions,
    resolve_name,
    shorten_line,
)
from urdfcheck.source.launch.static_transforms import parse_transform_arguments
from urdfcheck.source.package.finder import PackageFinder, format_path
from urdfcheck.system.files import read_regular

_MAX_CONFIG = 1024**2
_DISPLAY = re.compile(r"Class: rviz(?:_default_plugins)?/RobotModel\b")
_FIELD = {
    "ros1": re.compile(r"Robot Description: (\S+)"),
    "ros2": re.compile(r"Description Topic:[^-]*?\bValue: (\S+)"),
}


@dataclass(frozen=True, slots=True)
class _ProgramInfo:
    """What a program is for, and its inputs and outputs."""

    purpose: str
    reads: tuple[str, ...] = ()
    """``kind name`` each, the names as the program uses them; callers write a service, and the program reads it."""
    writes: tuple[str, ...] = ()
    facts: tuple[tuple[str, str], ...] = ()
    """Labels and texts from its arguments."""


_TF = ("topic /tf", "topic /tf_static")
_STATES = _ProgramInfo("makes tf from the joint positions", ("parameter robot_description", "topic joint_states"), _TF)
_SLIDERS = _ProgramInfo("publishes joint positions", ("parameter robot_description",), ("topic joint_states",))
_GAZEBO = _ProgramInfo(
    "Gazebo Classic", ("service /gazebo/spawn_urdf_model", "service /gazebo/spawn_sdf_model", "service /spawn_entity")
)
_GZ_SIM = _ProgramInfo("Gazebo Sim", ("service create (Gazebo transport)",))
_MOVE_GROUP = _ProgramInfo("MoveIt", ("parameter robot_description", "topic joint_states", *_TF))
_LOCALIZATION = _ProgramInfo("computes where the robot is", _TF, ("topic /tf",))

# By dialect, then by package and executable.
_PROGRAMS: Mapping[str, Mapping[tuple[str, str], _ProgramInfo]] = {
    "ros1": {
        ("robot_state_publisher", "robot_state_publisher"): _STATES,
        ("robot_state_publisher", "state_publisher"): _STATES,
        ("joint_state_publisher", "joint_state_publisher"): _SLIDERS,
        ("joint_state_publisher_gui", "joint_state_publisher_gui"): _SLIDERS,
        **{("gazebo_ros", name): _GAZEBO for name in ("gazebo", "gzserver", "debug")},
        ("moveit_ros_move_group", "move_group"): _MOVE_GROUP,
        ("robot_localization", "ekf_localization_node"): _LOCALIZATION,
        ("amcl", "amcl"): _LOCALIZATION,
    },
    "ros2": {
        ("robot_state_publisher", "robot_state_publisher"): _ProgramInfo(
            _STATES.purpose, _STATES.reads, ("topic robot_description", *_TF)
        ),
        ("joint_state_publisher", "joint_state_publisher"): _ProgramInfo(
            _SLIDERS.purpose, ("topic robot_description",), _SLIDERS.writes
        ),
        ("joint_state_publisher_gui", "joint_state_publisher_gui"): _ProgramInfo(
            _SLIDERS.purpose, ("topic robot_description",), _SLIDERS.writes
        ),
        **{("gazebo_ros", name): _GAZEBO for name in ("gazebo", "gzserver")},
        ("moveit_ros_move_group", "move_group"): _MOVE_GROUP,
        ("robot_localization", "ekf_node"): _LOCALIZATION,
        ("nav2_amcl", "amcl"): _LOCALIZATION,
    },
}
# Launch files of other packages that start a simulator.
_SIMULATORS = (
    (re.compile(r"gazebo_ros/(?:\w+_world\.launch|(?:gazebo|gzserver)\.launch\.py)"), _GAZEBO),
    (re.compile(r"ros_(?:gz_sim|ign_gazebo)/(?:gz_sim|ign_gazebo|gz_server)\.launch\.py"), _GZ_SIM),
)
_BRIDGES = frozenset({("ros_gz_bridge", "parameter_bridge"), ("ros_ign_bridge", "parameter_bridge")})


def build_launch_scene(launch: Launch) -> SceneLaunch:
    """Return the nodes that a launch file starts and the data flow between them, as plain values."""
    dialect = launch.dialect
    contents = read_python_actions(launch) if dialect == "python" else read_launch_actions(launch)
    family = "ros1" if dialect == "ros1" else "ros2"
    nodes = tuple(_build_scene_node(node, family, contents=contents, finder=launch.finder) for node in contents.nodes)
    return SceneLaunch(
        file=format_path(launch.path),
        dialect=dialect,
        nodes=nodes,
        parameters=contents.parameters,
        notes=contents.notes,
    )


def _build_scene_node(node: LaunchAction, family: str, *, contents: LaunchContents, finder: PackageFinder) -> SceneNode:
    program = _describe_program(node, family, finder)
    facts = [("arguments", node.typed)] if node.typed else []
    facts += [("remapped", f"{before} to {after}") for before, after in node.remaps]
    facts += node.parameters.items()
    return SceneNode(
        kind=node.kind,
        name=node.full_name if node.kind == "node" and (node.name or node.program) else "",
        program=f"{node.package}/{node.program}" if node.package else node.program,
        purpose=program.purpose,
        reads=_build_ports(program.reads, node, contents.parameters),
        writes=_build_ports(program.writes, node, contents.parameters),
        condition=node.condition,
        off=node.off,
        facts=(*program.facts, *facts),
        spans=node.spans,
    )


def _build_ports(
    names: Sequence[str], node: LaunchAction, parameters: Sequence[SceneParameter]
) -> tuple[ScenePort, ...]:
    full = node.full_name
    remaps = {resolve_name(before, node.namespace, full): after for before, after in node.remaps}
    ports = []
    for kind, name in (text.split(" ", 1) for text in names):
        if kind == "file" or "(" in name:
            ports.append(ScenePort(kind, shorten_line(name)))
            continue
        wanted = resolve_name(name, node.namespace, full)
        wanted = resolve_name(remaps.get(wanted, wanted), node.namespace, full)
        ports.append(_find_parameter_port(wanted, full, parameters) if kind == "parameter" else ScenePort(kind, wanted))
    return tuple(dict.fromkeys(ports))


def _find_parameter_port(wanted: str, node: str, parameters: Sequence[SceneParameter]) -> ScenePort:
    """Return the parameter that a node gets: its own, else the nearest one in the namespaces around it.

    If the launch file sets none, the one that the node would need.
    """
    name = wanted.rpartition("/")[2]
    around = [node[: m.start()] for m in re.finditer("/", node)][::-1]
    candidates = [f"{node} {name}", f"{node}/{name}", wanted, *(f"{namespace}/{name}" for namespace in around)]
    known = {p.port.name for p in parameters}
    return ScenePort("parameter", next((c for c in candidates if c in known), wanted))


def _describe_program(node: LaunchAction, family: str, finder: PackageFinder) -> _ProgramInfo:
    """Return the known purpose, inputs and outputs of a program with its arguments."""
    program, words = (node.package, node.program), node.words
    if node.kind == "launch file":
        path = "/".join(program)
        return next((known for pattern, known in _SIMULATORS if pattern.fullmatch(path)), _ProgramInfo(""))
    if node.kind == "process":
        simulators = {"gazebo": _GAZEBO, "gzserver": _GAZEBO, "gz": _GZ_SIM, "ign": _GZ_SIM}
        return simulators.get(node.program, _ProgramInfo(""))
    known = _PROGRAMS[family].get(program)
    if known is not None:
        return _apply_model_file(known, words) if known.writes == _SLIDERS.writes else known
    if node.program == "static_transform_publisher" and node.package in {"tf", "tf2_ros"}:
        placed = parse_transform_arguments(words)
        frames = () if placed is None else (("transform", shorten_line(f"{placed[0]} to {placed[1]}")),)
        return _ProgramInfo(
            "places a frame",
            writes=("topic /tf" if node.package == "tf" else "topic /tf_static",),
            facts=frames,
        )
    if program in {("rviz", "rviz"), ("rviz2", "rviz2")}:
        display = _read_display_source(words, family, finder)
        return _ProgramInfo(
            "RViz" if display else "RViz, with no RobotModel display in a configuration that is here", (*_TF, *display)
        )
    if program in _BRIDGES:
        return _describe_bridge(words)
    if node.package == "controller_manager":
        return _describe_control_node(node, family)
    if program == ("rostopic", "rostopic") and len(words) > 1 and words[0] in {"pub", "echo"}:
        topic = (f"topic {words[1]}",)
        return (
            _ProgramInfo("publishes a message", (), topic)
            if words[0] == "pub"
            else _ProgramInfo("prints messages", topic)
        )
    return _describe_spawner(program, words) or _ProgramInfo("")


def _apply_model_file(known: _ProgramInfo, words: Sequence[str]) -> _ProgramInfo:
    """Replace the topic by the model file that joint_state_publisher of ROS 2 is given."""
    file = next((w for w in words if w.endswith((".urdf", ".xml"))), None)
    return known if file is None else _ProgramInfo(known.purpose, (f"file {_format_typed_path(file)}",), known.writes)


def _format_typed_path(typed: str) -> str:
    """Return a path as it is displayed; as typed if a part of it is unknown."""
    return typed if "$(" in typed or not Path(typed).is_absolute() else format_path(Path(typed))


def _get_option(words: Sequence[str], *names: str) -> str:
    """Return the word after an option; empty if another option follows."""
    for word, following in itertools.pairwise(words):
        if word in names and not following.startswith("-"):
            return following
    return ""


def _describe_spawner(program: tuple[str, str], words: Sequence[str]) -> _ProgramInfo | None:
    services = {
        ("gazebo_ros", "spawn_model"): "/gazebo/spawn_sdf_model" if "-sdf" in words else "/gazebo/spawn_urdf_model",
        ("gazebo", "spawn_model"): "/gazebo/spawn_urdf_model",
        ("gazebo_ros", "spawn_entity.py"): "/spawn_entity",
        ("ros_gz_sim", "create"): "create (Gazebo transport)",
        ("ros_ign_gazebo", "create"): "create (Gazebo transport)",
    }
    if program not in services:
        return None
    reads = []
    for kind in ("topic", "param", "file"):
        value = _get_option(words, f"-{kind}", f"--{kind}")
        if value:
            reads.append(
                f"file {_format_typed_path(value)}"
                if kind == "file"
                else f"{kind.replace('param', 'parameter')} {value}"
            )
    name = shorten_line(_get_option(words, "-model", "-entity", "-name"))
    facts = (("robot's name", name),) if name else ()
    return _ProgramInfo(
        "puts the robot into the simulation",
        reads=tuple(reads),
        writes=(f"service {services[program]}",),
        facts=facts,
    )


def _describe_control_node(node: LaunchAction, family: str) -> _ProgramInfo:
    words = node.words
    manager = _get_option(words, "-c", "--controller-manager", "--namespace") or "controller_manager"
    service = f"service {manager.rstrip('/')}/load_controller"
    if node.program == "ros2_control_node":
        private = any(before == "~/robot_description" for before, _ in node.remaps)
        topic = "topic ~/robot_description" if private else "topic robot_description"
        return _ProgramInfo("runs the controllers", (topic, service))
    if node.program in {"spawner", "spawner.py", "controller_manager", "unspawner"}:
        names = [w for w in words if not w.startswith("-") and w not in {manager, "load", "start", "spawn", "stop"}]
        facts = (("controllers", shorten_line(" ".join(names))),) if names and family == "ros1" else ()
        return _ProgramInfo("starts controllers", writes=(service,), facts=facts)
    return _ProgramInfo("")


def _describe_bridge(words: Sequence[str]) -> _ProgramInfo:
    """Read the topics: ``/topic@ros_type@gz_type`` is bidirectional, ``[`` is Gazebo to ROS, ``]`` is ROS to Gazebo."""
    reads, writes = [], []
    for word in words[:MOST_NAMES]:
        topic, at, types = word.partition("@")
        if not at or word.startswith("-"):
            continue
        if "[" not in types:
            reads.append(f"topic {topic}")
        if "]" not in types:
            writes.append(f"topic {topic}")
    return _ProgramInfo("carries topics between ROS and Gazebo", tuple(reads), tuple(writes))


def _read_display_source(words: Sequence[str], family: str, finder: PackageFinder) -> tuple[str, ...]:
    """Return where the RobotModel display of RViz's configuration takes the robot from; nothing without such a display."""
    path = Path(_get_option(words, "-d", "--display-config"))
    try:
        if not path.is_absolute() or not finder.can_open(path):
            return ()
        text = read_regular(path, _MAX_CONFIG).decode("utf-8", "replace")
    except OSError:
        return ()
    display = _DISPLAY.search(text)
    if display is None:
        return ()
    # The fields up to the next display are sorted by name.
    settings = text[display.end() :].partition("Class: ")[0]
    field = _FIELD[family].search(settings)
    name = field[1].strip("\"'") if field else "robot_description"
    return (f"{'parameter' if family == 'ros1' else 'topic'} {name}",) if name else ()
