"""Which controller configurations belong to a model, and what its description offers to controllers."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from urdfcheck.core import Located
from urdfcheck.core.records import dataclass
from urdfcheck.model.fact import fact
from urdfcheck.model.motion.semantic_descriptions import semantic_descriptions
from urdfcheck.model.robot import Model
from urdfcheck.source.package.file_kinds import CONFIG_FOLDERS
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.ros.controllers import (
    ControllerConfig,
    find_bringup_configs,
    list_yaml_files,
    read_controller_config,
)
from urdfcheck.source.ros.srdf import is_about_model, list_srdf_folders
from urdfcheck.source.text.tokens import find_content_span
from urdfcheck.source.text.xml import COMMENT, Element

if TYPE_CHECKING:
    from urdfcheck.source.launch.launch_file import Launch

_CONTROL_PLUGIN = re.compile(r"ros2?_control")
_GAZEBO_CLASSIC = re.compile(r"gazebo_ros2_control/")
_PID = "_pid"
_PREFIX = re.compile(r"^\$(?:\{[^}]*\}|\([^)]*\))")
_FIND = re.compile(r"\$\((?:find|find-pkg-share)\s+([^\s()]+)\s*\)")


@dataclass(frozen=True, slots=True, eq=False)
class AssociatedConfiguration:
    """A controller configuration and what makes it the model's."""

    configuration: ControllerConfig
    named_at: Located | None
    """Where the model, or a launch file that loads the model, names it; None where it lies beside the model and most of its
    joints are the model's.
    """


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ParameterFile:
    """The ``<parameters>`` of a control plugin in the model."""

    element: Element
    text: str
    """The path as it is written, expanded."""
    path: Path | None
    """The file; None where it is not known which."""
    missing: bool = False
    """Whether the package that it names has no such file."""
    literal: bool = False
    """Whether the author typed the path as it is, without an expression."""


@fact
def find_controller_configs(model: Model) -> tuple[AssociatedConfiguration, ...]:
    """Find the controller configurations of a model.

    Those that it names; and those that fit it in its package, in its MoveIt configuration and in packages that bring it up.
    """
    finder, configs = model.source.finder, dict[str, AssociatedConfiguration]()
    for parameters in list_parameter_files(model):
        if parameters.path is not None:
            _add_configuration(configs, parameters.path, finder, named_at=parameters.element)
    known = frozenset(model.joint_by_name)
    package = model.package
    srdfs = [srdf for srdf in semantic_descriptions(model) if is_about_model(srdf, model.source)]
    folders = [] if package is None else [package.path / folder for folder in CONFIG_FOLDERS]
    for path in (*list_yaml_files([*folders, *list_srdf_folders(srdfs)]), *find_bringup_configs(model.source)):
        if os.path.realpath(path) not in configs:
            _add_configuration(configs, path, finder, named_at=None, known=known)
    return tuple(configs.values())


def find_launched_configs(launch: Launch, model: Model) -> tuple[AssociatedConfiguration, ...]:
    """Find the configurations that a launch file loads beside its one robot and that fit the robot."""
    configs: dict[str, AssociatedConfiguration] = {}
    if launch.root is None or len({description.path for description in launch.descriptions}) != 1:
        return ()
    for element in launch.root.walk():
        name = {"rosparam": "file", "param": "from"}.get(element.tag, "")
        attribute = element.attributes.get(name)
        path = None if attribute is None else _resolve_launch_path(attribute.value, launch)
        if attribute is not None and path is not None:
            _add_configuration(configs, path, launch.finder, named_at=attribute, known=frozenset(model.joint_by_name))
    return tuple(configs.values())


def _add_configuration(
    configs: dict[str, AssociatedConfiguration],
    path: Path,
    finder: PackageFinder,
    *,
    named_at: Located | None,
    known: frozenset[str] | None = None,
) -> None:
    """Read a configuration; where ``known`` is given, at least half of the joints it names must be among these."""
    configuration = read_controller_config(path, finder)
    if configuration is None:
        return
    names = configuration.joint_names
    if not names and named_at is None:
        return  # only gpios, whose names do not show the robot
    if known is None or 2 * len(names & known) >= len(names):
        configs[os.path.realpath(path)] = AssociatedConfiguration(configuration, named_at)


def list_parameter_files(model: Model) -> Iterator[ParameterFile]:
    """Yield what the control plugins of the model name as their parameters."""
    for block in model.robot.find_children("gazebo"):
        for plugin in block.find_children("plugin"):
            if not _CONTROL_PLUGIN.search(plugin.get("filename")):
                continue
            for element in plugin.find_children("parameters"):
                text = element.text.strip()
                if text:
                    yield _resolve_parameter_file(model, element, text)


def _resolve_parameter_file(model: Model, element: Element, text: str) -> ParameterFile:
    source = model.source
    literal = find_content_span(element, source.files) is not None
    path = Path(text)
    package = source.package
    if not path.is_absolute():
        return ParameterFile(element=element, text=text, path=None, literal=literal)
    if literal:
        # A path on the author's machine: a file of the model's own package is known all the same.
        tail = None if package is None else text.rpartition(f"/{package.name}/")[2]
        inside = None if package is None or tail is None or tail == text else package.path / tail
        known = inside if inside is not None and source.finder.can_open(inside) and os.path.isfile(inside) else None
        return ParameterFile(element=element, text=text, path=known, literal=True)
    if not source.finder.can_open(path):
        return ParameterFile(element=element, text=text, path=None)
    path = source.finder.find_source(path)
    exists = os.path.isfile(path)  # pathlib raises for a name that is too long
    return ParameterFile(element=element, text=text, path=path if exists else None, missing=not exists)


def _resolve_launch_path(text: str, launch: Launch) -> Path | None:
    """Resolve a path in a launch file; None where its arguments decide."""
    match = _FIND.match(text.strip())
    folder = None if match is None else launch.finder.find(match.group(1))
    rest = "" if match is None else text.strip()[match.end() :]
    if folder is None or "$" in rest or "\0" in rest:
        return None
    path = launch.finder.find_source(folder / rest.lstrip("/"))
    return path if launch.finder.can_open(path) and os.path.isfile(path) else None


# -- what the description offers ----------------------------------------------------------------------------------------


def collect_command_interfaces(model: Model) -> dict[str, set[str]] | None:
    """Collect the command interfaces of each joint in the model's ``<ros2_control>`` blocks; None where it has no such block."""
    return collect_interfaces(model, "command", ("joint", "gpio"))


def can_offer_with_other_arguments(model: Model, joint: str, interface: str) -> bool:
    """Whether other arguments of the model may give a joint this command interface.

    An argument is its interface's name, a condition leaves out what is typed in the joint's block, or a file that the model can
    include has a block with the joint and the interface that this expansion leaves out.
    """
    typed = re.compile(rf"""<command_interface\s[^<>]*?name\s*=\s*["']{re.escape(interface)}({_PID})?["']""")
    blocks = model.robot.find_children("ros2_control")
    for component in (one for block in blocks for one in block.find_children("joint") if one.get("name") == joint):
        names = [e.attributes["name"] for e in component.find_children("command_interface") if "name" in e.attributes]
        if any(definition.kind == "argument" for name in names for definition in name.collect_definitions()):
            return True
        file = None if component.span is None else model.source.files.get(component.span.file)
        if file is not None and component.span is not None:
            inside = COMMENT.sub("", file.text[component.span.end :]).partition("</joint")[0]
            if typed.search(inside):
                return True
    return interface in _collect_left_out_interfaces(model, joint)


def _collect_left_out_interfaces(model: Model, joint: str) -> set[str]:
    """Collect the command interfaces of a joint in the ``<ros2_control>`` blocks that no argument of this expansion brings in.

    A prefix that an expression makes may be any.
    """
    from urdfcheck.source.xacro.argument_values import read_included_trees  # loaded only if an interface is missing

    used = {e.span for block in model.robot.find_children("ros2_control") for e in block.find_children("joint")}
    blocks = (e for tree, _ in read_included_trees(model.source.path, model.source.finder) for e in tree.walk())
    typed = (e for block in blocks if block.tag == "ros2_control" for e in block.walk() if e.tag == "joint")
    fitting = (e for e in typed if e.span not in used and _may_be_named(e.get("name").strip(), joint))
    names = {inner.get("name") for e in fitting for inner in e.walk() if inner.tag == "command_interface"}
    return names | {name.removesuffix(_PID) for name in names}


def _may_be_named(typed: str, name: str) -> bool:
    rest = _PREFIX.sub("", typed)
    return typed == name or (rest not in {"", typed} and name.endswith(rest))


@fact
def collect_controlled_joints(model: Model) -> frozenset[str]:
    """Collect the joints that transmissions and blocks of ros2_control name, with whichever interfaces."""
    blocks = [block for tag in ("transmission", "ros2_control") for block in model.robot.find_children(tag)]
    return frozenset(joint.get("name").strip() for block in blocks for joint in block.find_children("joint"))


def collect_interfaces(model: Model, role: str, tags: Iterable[str]) -> dict[str, set[str]] | None:
    """Collect the interfaces of the components with these tags, by name, in the ``<ros2_control>`` blocks.

    ``role``: ``command`` or ``state``. None where the model has no such block.
    """
    blocks = model.robot.find_children("ros2_control")
    if not blocks:
        return None
    offered: dict[str, set[str]] = {}
    pairs = ((block, one) for block in blocks for tag in tags for one in block.find_children(tag))
    for control, component in pairs:
        names = {element.get("name") for element in component.find_children(f"{role}_interface")}
        if _is_of_gazebo_classic(control):
            names = {name.removesuffix(_PID) for name in names}
        offered.setdefault(component.get("name"), set()).update(names)
    return offered


def _is_of_gazebo_classic(block: Element) -> bool:
    """Whether the hardware of a ``<ros2_control>`` block is that of gazebo_ros2_control.

    It exports `position_pid` as `position`, and `velocity_pid` as `velocity`: the suffix only says how it follows them.
    """
    return any(element.tag == "plugin" and _GAZEBO_CLASSIC.match(element.text.strip()) for element in block.walk())
