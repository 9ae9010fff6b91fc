"""LCH007 reports lines that exporters copy into launch files and that no longer do anything."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from urdfcheck.core import Finding, Rule
from urdfcheck.model.launch_context import LaunchContext
from urdfcheck.source.launch.around.naming_files import is_started_in_project
from urdfcheck.source.launch.launch_file import Launch
from urdfcheck.source.launch.static_transforms import get_executable
from urdfcheck.source.ros.distributions import is_only_before
from urdfcheck.source.text.tokens import build_removal_edits
from urdfcheck.source.text.xml import Element


def check(context: LaunchContext, rule: Rule) -> Iterator[Finding]:
    launch = context.launch
    # One that nothing starts is a left-over as a whole.
    if launch.root is None or launch.is_left_over or launch.is_in_documents:
        return
    # The SolidWorks exporter writes another node of this name beside the one that is left over.
    is_exported = any(e.tag == "node" and e.get("name") == "tf_footprint_base" for e in launch.root.walk())
    # An included file may start it, one in a package that is not here hardly: those of Gazebo do not.
    roots = [launch.root, *(scope.root for scope in launch.scopes.values())]
    started = {e.get("pkg") for root in roots for e in root.walk() if e.tag == "node"}
    publishes = "joint_state_publisher" in started
    sliders = (
        "the launch file starts joint_state_publisher_gui, which has the sliders"
        if "joint_state_publisher_gui" in started
        else "start joint_state_publisher_gui if you want sliders"
    )
    for element in launch.root.walk():
        message = _classify_leftover(element)
        if message == "use-gui" and (
            not publishes or _is_off(launch, element) or is_only_before("noetic", launch.finder)
        ):
            continue
        if message is not None:
            data: dict[str, Any] = {"sliders": sliders} if message == "use-gui" else {}
            is_made = message == "calibration" and is_exported
            yield rule.finding(
                "calibration-idle" if is_made and not is_started_in_project(launch) else message,
                at=element,
                cause="solidworks-exporter" if is_made else None,
                edits=build_removal_edits(element, launch.files),
                name=element.get("name"),
                **data,
            )


def _is_off(launch: Launch, param: Element) -> bool:
    """Whether the default of a parameter is false: then no window is wanted, and none comes."""
    typed = param.get("value")
    value = typed if launch.scope is None else launch.scope.resolver.resolve_value(typed)[0]
    return value is not None and value.strip().lower() in {"false", "0"}


def _classify_leftover(element: Element) -> str | None:
    if element.tag == "node" and get_executable(element) == "rostopic":
        words = element.get("args").split()
        return "calibration" if words[:2] in (["pub", "/calibrated"], ["pub", "calibrated"]) else None
    if element.tag == "param" and element.get("name").rpartition("/")[2] == "use_gui":
        return "use-gui"
    if element.tag == "arg" and element.get("name") == "headless" and element.parent is not None:
        file = element.parent.get("file")
        world = element.parent.tag == "include" and "gazebo_ros" in file and file.endswith("_world.launch")
        return "headless" if world else None
    return None
