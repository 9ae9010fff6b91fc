"""Controller configurations: the joints that a yaml file of ros_control, ros2_control or MoveIt's controller managers names.

The forms: ``name: {ros__parameters: {joints: […]}}`` with the types under ``controller_manager`` (ROS 2),
``name: {type: package/Class, joints: […]}`` (ROS 1), and ``FollowJointTrajectory`` or ``GripperCommand`` entries with their
``joints`` (MoveIt, of both).
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache
from pathlib import Path

from urdfcheck.core.records import dataclass
from urdfcheck.source.load import Source
from urdfcheck.source.package.file_kinds import CONFIG_FOLDERS, is_launch
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.ros.srdf import has_dependency
from urdfcheck.source.ros.yaml_files import read_yaml_text
from urdfcheck.source.text.xml import SourceFile
from urdfcheck.source.text.yaml.values import YamlReadError, YamlValue
from urdfcheck.system.files import read_regular

# The parameters of the controllers of ros_controllers and ros2_controllers that name joints.
JOINT_PARAMETERS = (
    *("joints", "joint", "command_joints", "dof_names"),
    *("left_wheel", "right_wheel", "left_wheel_names", "right_wheel_names"),
    *("front_wheels_names", "rear_wheels_names", "traction_joints_names", "steering_joints_names"),
    *("traction_joint_name", "steering_joint_name"),
    *(f"{end}_{side}_wheel_command_joint_name" for end in ("front", "rear") for side in ("left", "right")),
)
MAX_FILES = 100
_LARGEST_LAUNCH = 1_000_000
# Characters of a yaml file whose controllers are kept.
_LONGEST_KEPT = 20_000
_ACTIONS = frozenset({"FollowJointTrajectory", "GripperCommand"})
# Other nodes also have parameters of these names.
_CONTROLLER_NAME = re.compile(r"controller(?!_manager)|broadcaster")
_GPIO_CONTROLLER = "gpio_controllers/GpioCommandController"
# A mapping with its key and where it is, as `_walk_mappings` yields them.
_Node = tuple[YamlValue | None, YamlValue, str]
# Placeholders that are filled in when the file is loaded.
_TEMPLATE = re.compile(r"[$<>{}%]")


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Controller:
    """One controller."""

    name: str
    type: str
    """Empty if the file does not name it."""
    dialect: str
    """ros1 | ros2 | moveit."""
    key: YamlValue
    """The name as typed."""
    parameters: YamlValue
    joints: tuple[YamlValue, ...]
    """The names of joints in the parameters."""

    @property
    def claimed_interfaces(self) -> tuple[str, ...]:
        """The interfaces of each joint that the controller claims; empty if unknown."""
        package, _, kind = self.type.partition("/")
        if kind in {"JointTrajectoryController", "ForwardCommandController", "MultiInterfaceForwardCommandController"}:
            if kind == "JointTrajectoryController" and package == "joint_trajectory_controller":
                return _list_texts(self.parameters.get("command_interfaces"))
            if package == "forward_command_controller":
                return _list_texts(self.parameters.get("interface_name"))
        if package == "diff_drive_controller":
            return ("velocity",)
        interfaces = {
            "position_controllers": "position",
            "velocity_controllers": "velocity",
            "effort_controllers": "effort",
        }
        return (interfaces[package],) if package in interfaces else ()

    @property
    def ignores_joints(self) -> bool:
        """Whether it ignores its list of joints: a broadcaster without a list of interfaces publishes all joints."""
        return self.type.startswith("joint_state_broadcaster/") and not _list_texts(self.parameters.get("interfaces"))

    @property
    def commanded_joints(self) -> tuple[YamlValue, ...]:
        """The joints that it commands: those of ``command_joints`` if it has them."""
        commanded = self.parameters.get("command_joints")
        return self.joints if commanded is None else tuple(_list_joint_names(commanded))


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class GpioClaim:
    """An interface that a ``gpio_controllers/GpioCommandController`` claims."""

    controller: str
    role: str
    """command | state."""
    component: YamlValue
    """The name of the ``<gpio>``."""
    interface: YamlValue


@dataclass(frozen=True, eq=False)
class ControllerConfig:
    """A file with its controllers."""

    path: Path
    controllers: tuple[Controller, ...]
    """Those that name joints."""
    gpio_claims: tuple[GpioClaim, ...] = ()

    @property
    def joint_names(self) -> frozenset[str]:
        """The joints that it names."""
        return frozenset(joint.text for controller in self.controllers for joint in controller.joints)


def list_yaml_files(folders: Iterable[Path]) -> list[Path]:
    """Return the yaml files directly in these folders."""
    return [
        path for folder in dict.fromkeys(folders) for path in _list_folder(folder) if path.suffix in {".yaml", ".yml"}
    ]


def find_bringup_configs(source: Source) -> Iterator[Path]:
    """Yield the yaml files of packages that depend on the model's and load them: a launch file contains both names."""
    package = source.package
    if package is None:
        return
    for name, folder in sorted(source.finder.list_workspace_packages().items()):
        if folder == package.path:
            continue
        files = list_yaml_files(folder / inner for inner in CONFIG_FOLDERS)
        if files and has_dependency(folder, package.name):
            source.finder.find(name)  # then it counts as found, and its files are in reach
            texts = [text for text in _read_launch_texts(folder / "launch", source.finder) if package.name in text]
            yield from (path for path in files if any(path.name in text for text in texts))


def _read_launch_texts(folder: Path, finder: PackageFinder) -> Iterator[str]:
    for path in _list_folder(folder):
        if is_launch(path) and finder.can_open(path):
            try:
                yield read_regular(path, _LARGEST_LAUNCH).decode("utf-8", "replace")
            except OSError:
                continue


def _list_folder(folder: Path) -> list[Path]:
    try:
        return [folder / name for name in sorted(os.listdir(folder))[:MAX_FILES]]
    except OSError:
        return []


def read_controller_config(path: Path, finder: PackageFinder) -> ControllerConfig | None:
    """Read the controllers in a file; None if it has none, may not be opened, or is a template that is filled in later."""
    try:
        source = read_yaml_text(path, finder)
        if source is None:
            return None
        parse = _parse_known_config if len(source.text) <= _LONGEST_KEPT else _parse_config
        return parse(path, source.name, source.text)
    except YamlReadError:
        return None


def _parse_config(path: Path, name: str, text: str) -> ControllerConfig | None:
    """Parse the text of a file whose name in findings is ``name``.

    :raises YamlReadError: if it is not yaml.
    """
    # PyYAML takes a start 12 ms, and most robots have none.
    from urdfcheck.source.text.yaml.reader import parse_located_yaml

    root = parse_located_yaml(SourceFile(path, name, text))
    if root is None:
        return None
    nodes = list(_walk_mappings(root))
    types = _collect_types(nodes)
    config = ControllerConfig(path, tuple(_parse_controllers(nodes, types)), tuple(_parse_gpio_claims(nodes, types)))
    names = config.joint_names.union(claim.component.text for claim in config.gpio_claims)
    return config if names and not any(map(_TEMPLATE.search, names)) else None


# The models of a workspace read the same files, of which few have controllers.
_parse_known_config = lru_cache(maxsize=512)(_parse_config)


def _collect_types(nodes: Iterable[_Node]) -> dict[str, str]:
    """Return the types of the controllers of ROS 2 by their names, as the controller manager has them."""
    return {
        key.text: typed.text
        for name, mapping, inside in nodes
        if inside == "ros2" and name is not None and "controller_manager" in name.text
        for key, value in mapping.entries
        if (typed := value.get("type")) is not None
    }


def _parse_gpio_claims(nodes: Iterable[_Node], types: Mapping[str, str]) -> Iterator[GpioClaim]:
    for name, mapping, inside in nodes:
        last = "" if name is None else name.text.rpartition("/")[2]
        if inside != "ros2" or types.get(last) != _GPIO_CONTROLLER:
            continue
        for role in ("command", "state"):
            claimed = mapping.get(f"{role}_interfaces")
            for component, listed in () if claimed is None else claimed.entries:
                for interface in _list_gpio_interfaces(listed):
                    yield GpioClaim(controller=last, role=role, component=component, interface=interface)


def _list_gpio_interfaces(listed: YamlValue) -> Iterator[YamlValue]:
    """Yield the names below a gpio: a list, or one under ``interfaces``, which an older release wanted inside a list."""
    for item in listed.items or (listed,):
        inner = item.get("interfaces") if item.is_mapping else item
        yield from () if inner is None else (name for name in (inner.items or (inner,)) if name.text.strip())


def _parse_controllers(nodes: Iterable[_Node], types: Mapping[str, str]) -> Iterator[Controller]:
    for name, mapping, inside in nodes:
        typed = mapping.get("type")
        kind = "" if typed is None else typed.text
        joints = tuple(joint for parameter in JOINT_PARAMETERS for joint in _list_joint_names(mapping.get(parameter)))
        if inside == "ros2" and name is not None:
            last = name.text.rpartition("/")[2]
            if joints and (last in types or _CONTROLLER_NAME.search(last)):
                yield Controller(
                    name=last, type=types.get(last, ""), dialect="ros2", key=name, parameters=mapping, joints=joints
                )
        elif kind in _ACTIONS and joints:
            key = mapping.get("name") or name
            if key is not None:
                yield Controller(name=key.text, type=kind, dialect="moveit", key=key, parameters=mapping, joints=joints)
        elif inside == "" and "/" in kind and joints and name is not None:
            yield Controller(name=name.text, type=kind, dialect="ros1", key=name, parameters=mapping, joints=joints)


def _walk_mappings(root: YamlValue) -> Iterator[_Node]:
    """Yield every mapping with its key, and ``ros2`` for the parameters of a ROS 2 node, ``inner`` for mappings in these."""
    stack: list[_Node] = [(None, root, "")]
    while stack:
        name, mapping, inside = stack.pop()
        yield name, mapping, inside
        below: list[_Node] = []
        # The parser of ROS 2 reads each of several blocks for one node.
        repeated = [] if inside else filter(_has_ros2_parameters, mapping.overridden_entries)
        for key, value in (*repeated, *mapping.entries):
            if key.text == "ros__parameters":
                below.append((name, value, "ros2"))
            elif value.is_mapping:
                below.append((key, value, "inner" if inside else ""))
            else:  # controller_list
                below += [(None, item, "inner" if inside else "") for item in value.items if item.is_mapping]
        stack += reversed(below)


def _has_ros2_parameters(entry: tuple[YamlValue, YamlValue]) -> bool:
    span = entry[1].span
    return "ros__parameters" in entry[1].source.text[span.start : span.end]


def _list_joint_names(value: YamlValue | None) -> list[YamlValue]:
    """Return a name or those of a list; one of a chained controller (``pid/left_wheel``) is not a joint."""
    if value is None:
        return []
    return [name for name in (value.items or (value,)) if name.text.strip() and "/" not in name.text]


def _list_texts(value: YamlValue | None) -> tuple[str, ...]:
    return () if value is None else tuple(item.text for item in (value.items or (value,)) if item.text)
