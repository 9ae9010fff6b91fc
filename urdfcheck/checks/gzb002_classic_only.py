"""GZB002 reports materials, plugins and hardware that only Gazebo Classic has."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import format_count, join_names
from urdfcheck.model import Model
from urdfcheck.model.simulation_use import has_successor_branch, starts_classic
from urdfcheck.source.package.build_files import read_build_type
from urdfcheck.source.text.xml import Attribute, Element

# Libraries of gazebo_ros_pkgs, gazebo_ros2_control, gazebo_ros_control and hector_gazebo: all are built for Classic.
_CLASSIC = re.compile(r"^(?:lib)?(gazebo_ros\w*|hector_gazebo_ros\w*)(?:\.so)?$")
_SENSOR_SYSTEM = "the <sensor> alone, with gz-sim-sensors-system to render it and ros_gz_bridge for its topics"
_REPLACEMENTS = {
    "gazebo_ros_control": "gz_ros2_control (ROS 2, filename gz_ros2_control-system; gazebo_ros2_control for Classic under ROS 2)",
    "gazebo_ros2_control": "gz_ros2_control: filename gz_ros2_control-system, name {name}, without <robot_sim_type>, and "
    "the hardware gz_ros2_control/GazeboSimSystem in <ros2_control>",
    "gazebo_ros_diff_drive": "gz-sim-diff-drive-system, or a diff_drive_controller under gz_ros2_control",
    "gazebo_ros_skid_steer_drive": "gz-sim-diff-drive-system with two <left_joint> and two <right_joint>",
    "gazebo_ros_planar_move": "gz-sim-velocity-control-system",
    "gazebo_ros_force_based_move": "gz-sim-velocity-control-system",
    "gazebo_ros_ackermann_drive": "gz-sim-ackermann-steering-system",
    "gazebo_ros_joint_state_publisher": "gz-sim-joint-state-publisher-system",
    "gazebo_ros_joint_pose_trajectory": "gz-sim-joint-trajectory-controller-system",
    "gazebo_ros_p3d": "gz-sim-odometry-publisher-system",
    "gazebo_ros_f3d": "gz-sim-forcetorque-system",
    "gazebo_ros_ft_sensor": "gz-sim-forcetorque-system",
    "gazebo_ros_bumper": "gz-sim-contact-system with a contact sensor",
    "gazebo_ros_force": "gz-sim-apply-link-wrench-system",
    "gazebo_ros_wheel_slip": "gz-sim-wheel-slip-system",
    "gazebo_ros_vacuum_gripper": "gz-sim-detachable-joint-system",
    "gazebo_ros_imu": "gz-sim-imu-system with an imu sensor",
    "gazebo_ros_imu_sensor": "gz-sim-imu-system with an imu sensor",
    "hector_gazebo_ros_imu": "gz-sim-imu-system with an imu sensor",
    "gazebo_ros_gps_sensor": "gz-sim-navsat-system with a navsat sensor",
    "hector_gazebo_ros_gps": "gz-sim-navsat-system with a navsat sensor",
    "hector_gazebo_ros_magnetic": "gz-sim-magnetometer-system with a magnetometer sensor",
    "hector_gazebo_ros_sonar": _SENSOR_SYSTEM,
}
# The successor of this plugin reads the same parameters. Its names alone do not move a robot: the hardware plugin of the
# <ros2_control> block, possibly in another file, and elements such as <robot_sim_type> belong to it.
_SUCCEEDED = "gazebo_ros2_control"
_ROS1_CONTROL = "gazebo_ros_control"
_CONTROL = {"filename": "gz_ros2_control-system", "name": "gz_ros2_control::GazeboSimROS2ControlPlugin"}
# The library of a system in a replacement, and the beginnings of its names in other releases.
_SYSTEM = re.compile(r"gz[\w-]*-system")
_RELEASES = re.compile(r"^(?:ignition-gazebo|gz-sim)\d*-|^ign_")
# Packages of Gazebo Classic, and the beginnings of the names of those of its successor.
_CLASSIC_PACKAGES = frozenset({
    "gazebo_dev", "gazebo_plugins", "gazebo_ros", "gazebo_ros_control", "gazebo_ros_pkgs", "gazebo_ros2_control",
})  # fmt: skip
_NEW_PACKAGES = ("gz_", "ign_", "ros_gz", "ros_ign")
# gz-sim makes no sensor of these types (SdfEntityCreator: "not supported yet").
_CPU_LIDARS = frozenset({"ray", "lidar"})
_SENSORS = re.compile(r"camera|kinect|laser|ray|range|prosilica|velodyne")


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    gazebo = [e for extension in model.robot.find_children("gazebo") for e in extension.walk()]
    materials = [e for e in gazebo if e.text.strip().startswith("Gazebo/") and e.span is not None]
    if materials:
        yield _build_material_finding(rule, materials)
    plugins: dict[str, list[Attribute]] = {}
    for element in gazebo:
        filename = element.attributes.get("filename")
        match = _CLASSIC.match(filename.value.strip()) if element.tag == "plugin" and filename is not None else None
        if match and filename is not None and not has_successor_branch(model, element):
            plugins.setdefault(match.group(1), []).append(filename)
    hardware = _list_hardware_plugins(model)
    if plugins:
        is_migrated = (_SUCCEEDED in plugins or _is_for_ros2(model)) and not _is_for_classic(model, plugins)
        # The hardware of gazebo_ros2_control is part of the same migration.
        related = [plugin for _, plugin in hardware] if _SUCCEEDED in plugins else []
        replacement = _describe_replacements(plugins, _list_new_systems(gazebo))
        severity = None if is_migrated else Severity.INFO
        yield _build_plugin_finding(rule, plugins, related=related, severity=severity, replacement=replacement)
    if _SUCCEEDED not in plugins:
        for control, plugin in hardware:
            yield rule.finding(
                "hardware",
                at=plugin,
                severity=Severity.INFO if _is_for_classic(model, plugins) else None,
                plugin=plugin.text.strip(),
                control=control.get("name"),
            )


def _is_for_ros2(model: Model) -> bool:
    """Whether the package or the model itself is for ROS 2, where Gazebo Classic has no successor in use but gz sim."""
    if model.robot.find_child("ros2_control") is not None:
        return True
    package = model.package
    if package is None or package.root is None:
        return False
    return read_build_type(package.root).startswith("ament_") or package.depends_on_ament


def _is_for_classic(model: Model, libraries: Collection[str]) -> bool:
    """Whether the package depends on Gazebo Classic or starts it, and not its successor: the plugins are the right ones.

    What a robot of ROS 2 starts cannot load the library of ROS 1.
    """
    needed = frozenset() if model.package is None else model.package.dependencies
    if any(name.startswith(_NEW_PACKAGES) for name in needed):
        return False
    return not needed.isdisjoint(_CLASSIC_PACKAGES) or (_ROS1_CONTROL not in libraries and starts_classic(model))


def _build_material_finding(rule: Rule, elements: list[Element]) -> Finding:
    places = list({element.span: element for element in elements}.values())
    finding = rule.finding(
        "material",
        at=places[0],
        related=places[1:],
        severity=Severity.INFO,
        which=format_count(len(elements), "material uses a Gazebo Classic name", "materials use Gazebo Classic names"),
        names=join_names(dict.fromkeys(element.text.strip() for element in elements)),
        short_names=join_names(dict.fromkeys(element.text.strip().removeprefix("Gazebo/") for element in elements)),
    )
    return replace(finding, subjects=tuple(dict.fromkeys(element.subject for element in elements)))


def _build_plugin_finding(
    rule: Rule,
    plugins: Mapping[str, list[Attribute]],
    *,
    related: Iterable[Element],
    severity: Severity | None,
    replacement: str,
) -> Finding:
    """Report all libraries together: the robot was written for Classic."""
    places = list({use.span: use for uses in plugins.values() for use in uses}.values())
    finding = rule.finding(
        "plugin",
        at=places[0],
        related=[*places[1:], *related],
        severity=severity,
        which=format_count(len(places), "plugin is", "plugins are"),
        names=join_names(plugins, 3),
        libraries=join_names((uses[0].value.strip() for uses in plugins.values()), 3),
        replacement=replacement,
    )
    return replace(finding, subjects=tuple(dict.fromkeys(place.location.subject for place in places)))


def _list_new_systems(gazebo: Iterable[Element]) -> dict[str, Element]:
    """Return the plugins of the robot by the names of their libraries in the new Gazebo, whatever release they are for."""
    systems: dict[str, Element] = {}
    for plugin in (e for e in gazebo if e.tag == "plugin"):
        name = plugin.get("filename").strip().removeprefix("lib").removesuffix(".so")
        systems.setdefault(_RELEASES.sub(lambda old: "gz_" if old[0] == "ign_" else "gz-sim-", name), plugin)
    return systems


def _describe_replacements(plugins: Mapping[str, Sequence[Attribute]], present: Mapping[str, Element]) -> str:
    """Return ``replace a, b by X; c by Y; delete d: Z is loaded in FILE:LINE``; ``present``: the systems that are loaded."""
    unknown = "a gz-sim system that does the same (none has this name)"
    libraries_by_replacement: dict[str, list[str]] = {}
    deleted: list[str] = []
    for library, uses in plugins.items():
        replacement = _REPLACEMENTS.get(library) or (_SENSOR_SYSTEM if _SENSORS.search(library) else unknown)
        system = None if replacement is _SENSOR_SYSTEM else _SYSTEM.search(replacement.format_map(_CONTROL))
        loaded = None if system is None else present.get(system[0])
        if system is not None and loaded is not None and loaded.span is not None:
            place = f"{loaded.span.file}:{loaded.span.line}"
            deleted.append(f"delete {library}: {system[0]} is loaded already ({place})")
            continue
        if replacement is _SENSOR_SYSTEM and any(map(_is_on_cpu_lidar, uses)):
            replacement = _SENSOR_SYSTEM.replace("alone", 'alone, its type="ray" changed to "gpu_lidar"')
        libraries_by_replacement.setdefault(replacement.format_map(_CONTROL), []).append(library)
    replaced = [f"{', '.join(names)} by {how}" for how, names in libraries_by_replacement.items()]
    return "; ".join([*deleted, *(["replace " + "; ".join(replaced)] if replaced else [])])


def _is_on_cpu_lidar(filename: Attribute) -> bool:
    """Whether a plugin is in a lidar's ``<sensor>`` that is computed without a graphics card."""
    sensor = filename.owner.parent
    return sensor is not None and sensor.tag == "sensor" and sensor.get("type").strip() in _CPU_LIDARS


def _list_hardware_plugins(model: Model) -> list[tuple[Element, Element]]:
    """List the hardware plugins of Gazebo Classic, each after its ``<ros2_control>``."""
    return [
        (control, plugin)
        for control in model.robot.find_children("ros2_control")
        for plugin in control.walk()
        if plugin.tag == "plugin" and plugin.text.strip().startswith("gazebo_ros2_control/")
        if not has_successor_branch(model, plugin)
    ]
