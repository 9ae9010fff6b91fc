"""GZB002 reports materials, plugins and hardware that only Gazebo Classic has."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from urdfcheck.core import Finding, Rule, Severity
from urdfcheck.core.text import find_only_near_name, format_count, join_names
from urdfcheck.model import Model
from urdfcheck.model.gazebo import is_for_new_gazebo
from urdfcheck.model.use.display import is_only_displayed
from urdfcheck.model.use.gazebo_starts import has_successor_branch, names_successor, starts_classic
from urdfcheck.source.package.build_files import read_build_type
from urdfcheck.source.text.xml import Attribute, Element
from urdfcheck.source.uses_elsewhere import is_left_output

# Libraries of gazebo_ros_pkgs, gazebo_ros2_control, gazebo_ros_control and hector_gazebo: all are built for Classic.
_CLASSIC = re.compile(r"^(?:lib)?(gazebo_ros\w*|hector_gazebo_ros\w*)(?:\.so)?$")
_SENSOR_SYSTEM = "the <sensor> alone, with gz-sim-sensors-system to render it and ros_gz_bridge for its topics"
_UNKNOWN_SYSTEM = "a gz-sim system that does the same, if there is one"
_REPLACEMENTS = {
    "gazebo_ros_control": "gz_ros2_control (ROS 2, filename gz_ros2_control-system; gazebo_ros2_control for Classic under ROS 2)",
    "gazebo_ros2_control": "gz_ros2_control: filename gz_ros2_control-system, name {name}, without <robot_sim_type>, and "
    "the hardware gz_ros2_control/GazeboSimSystem in <ros2_control>",
    "gazebo_ros_diff_drive": "gz-sim-diff-drive-system, or a diff_drive_controller under gz_ros2_control",
    "gazebo_ros_skid_steer_drive": "gz-sim-diff-drive-system with two <left_joint> and two <right_joint>",
    "gazebo_ros_planar_move": "gz-sim-velocity-control-system",
    "gazebo_ros_force_based_move": "gz-sim-velocity-control-system",
    "gazebo_ros_ackermann_drive": "gz-sim-ackermann-steering-system",
    "gazebo_ros_mecanum_drive": "gz-sim-mecanum-drive-system",
    "gazebo_ros_elevator": "gz-sim-elevator-system",
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
    "gazebo_ros_gps": "gz-sim-navsat-system with a navsat sensor",
    "gazebo_ros_gps_sensor": "gz-sim-navsat-system with a navsat sensor",
    "hector_gazebo_ros_gps": "gz-sim-navsat-system with a navsat sensor",
    "hector_gazebo_ros_magnetic": "gz-sim-magnetometer-system with a magnetometer sensor",
    "hector_gazebo_ros_sonar": _SENSOR_SYSTEM,
}
# The successor of this plugin reads the same parameters. Its names alone do not move a robot: the hardware plugin of the
# <ros2_control> block, possibly in another file, and elements such as <robot_sim_type> belong to it.
_SUCCEEDED = "gazebo_ros2_control"
# Libraries of ROS 1 that no package of ROS 2 builds, not for Classic either.
_ROS1_LIBRARIES = frozenset({
    "gazebo_ros_block_laser", "gazebo_ros_control", "gazebo_ros_depth_camera", "gazebo_ros_f3d", "gazebo_ros_gpu_laser",
    "gazebo_ros_imu", "gazebo_ros_laser", "gazebo_ros_multicamera", "gazebo_ros_openni_kinect", "gazebo_ros_prosilica",
    "gazebo_ros_range", "gazebo_ros_skid_steer_drive", "hector_gazebo_ros_gps", "hector_gazebo_ros_imu",
    "hector_gazebo_ros_magnetic", "hector_gazebo_ros_sonar",
})  # fmt: skip
# What a robot of ROS 2 loads instead of them in Classic.
_CLASSIC_REPLACEMENTS = {
    "gazebo_ros_block_laser": "gazebo_ros_ray_sensor",
    "gazebo_ros_control": "gazebo_ros2_control",
    "gazebo_ros_depth_camera": "gazebo_ros_camera",
    "gazebo_ros_f3d": "gazebo_ros_ft_sensor",
    "gazebo_ros_gpu_laser": "gazebo_ros_ray_sensor",
    "gazebo_ros_imu": "gazebo_ros_imu_sensor",
    "gazebo_ros_laser": "gazebo_ros_ray_sensor",
    "gazebo_ros_multicamera": "gazebo_ros_camera",
    "gazebo_ros_openni_kinect": "gazebo_ros_camera",
    "gazebo_ros_prosilica": "gazebo_ros_camera",
    "gazebo_ros_range": "gazebo_ros_ray_sensor",
    "gazebo_ros_skid_steer_drive": "gazebo_ros_diff_drive",
    "hector_gazebo_ros_gps": "gazebo_ros_gps_sensor",
    "hector_gazebo_ros_imu": "gazebo_ros_imu_sensor",
    "hector_gazebo_ros_sonar": "gazebo_ros_ray_sensor",
}
# A robot needs one of these; there may be several cameras, lidars and other sensors.
_LOADED_ONCE = frozenset({"gazebo_ros2_control", "gazebo_ros_diff_drive"})
_CONTROL = {"filename": "gz_ros2_control-system", "name": "gz_ros2_control::GazeboSimROS2ControlPlugin"}
# The library of a system in a replacement, and the beginnings of its names in other releases.
_SYSTEM = re.compile(r"gz[\w-]*-system")
_RELEASES = re.compile(r"^(?:ignition-gazebo|gz-sim)\d*-|^ign_")
# The beginnings of the names of packages of the new Gazebo.
_NEW_PACKAGES = ("gz_", "ign_", "ros_gz", "ros_ign")
# gz-sim makes no sensor of these types (SdfEntityCreator: "not supported yet").
_CPU_LIDARS = frozenset({"ray", "lidar"})
_SENSORS = re.compile(r"camera|kinect|laser|lidar|ray|range|prosilica|velodyne")


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
        old = [library for library in plugins if library in _ROS1_LIBRARIES] if _is_for_ros2(model) else []
        # The hardware of gazebo_ros2_control is part of the same migration.
        related = [plugin for _, plugin in hardware] if _SUCCEEDED in plugins else []
        replacement = (
            _describe_classic_replacements(old, plugins)
            if not _CLASSIC_REPLACEMENTS.keys().isdisjoint(old) and starts_classic(model)
            else _describe_replacements(plugins, _list_new_systems(gazebo))
        )
        if not old and not _is_for_successor(model):
            replacement = f"nothing for a robot that stays with Classic; to migrate, {replacement}"
        is_missed = (bool(old) and not is_only_displayed(model)) or _is_for_successor(model)
        # What xacro wrote and nothing loads misses no plugin.
        severity = None if is_missed and not is_left_output(model.source) else Severity.INFO
        is_of_ros1 = len(old) == len(plugins) and starts_classic(model)  # Classic is not the matter
        yield _build_plugin_finding(
            rule,
            plugins,
            old,
            related=related,
            severity=severity,
            replacement=replacement,
            made_for="for ROS 1" if is_of_ros1 else "Gazebo Classic",
        )
    if _SUCCEEDED not in plugins:
        for control, plugin in hardware:
            yield rule.finding(
                "hardware",
                at=plugin,
                severity=None if _is_for_successor(model) else Severity.INFO,
                plugin=plugin.text.strip(),
                control=control.get("name"),
            )


def _is_for_ros2(model: Model) -> bool:
    """Whether the package or the model itself is for ROS 2 alone."""
    if model.robot.find_child("ros2_control") is not None:
        return True
    package = model.package
    if package is None or package.root is None:
        return False
    is_for_both = "catkin" in package.dependencies
    return read_build_type(package.root).startswith("ament_") or (package.depends_on_ament and not is_for_both)


def _is_for_successor(model: Model) -> bool:
    """Whether the robot, its package or what starts it uses the new Gazebo, and nothing starts Classic: only there its plugins
    for Classic are missing."""
    if starts_classic(model):
        return False
    needed = frozenset() if model.package is None else model.package.dependencies
    return is_for_new_gazebo(model) or any(name.startswith(_NEW_PACKAGES) for name in needed) or names_successor(model)


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
    old: Sequence[str],
    *,
    related: Iterable[Element],
    severity: Severity | None,
    replacement: str,
    made_for: str,
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
        made_for=made_for,
        libraries=join_names((uses[0].value.strip() for uses in plugins.values()), 3),
        replacement=replacement,
        old=f"; {join_names(old, 3)} {'is' if len(old) == 1 else 'are'} of ROS 1, which a robot of ROS 2 loads in no Gazebo"
        if old
        else "",
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
    libraries_by_replacement: dict[str, list[str]] = {}
    deleted: list[str] = []
    for library, uses in plugins.items():
        replacement = _find_replacement(library)
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


def _describe_classic_replacements(libraries: Iterable[str], present: Mapping[str, Sequence[Attribute]]) -> str:
    """Return ``for Classic in ROS 2, delete a: X is loaded already (PLACE); replace b by Y``, where the robot is started there;
    ``present``: the libraries that are loaded.
    """
    by_replacement: dict[str, list[str]] = {}
    deleted: list[str] = []
    for library in libraries:
        replacement = _CLASSIC_REPLACEMENTS.get(library)
        loaded = present[replacement][0].span if replacement in _LOADED_ONCE and replacement in present else None
        if loaded is not None:
            # A second one manages the same joints again, without the parameters of the first.
            deleted.append(f"delete {library}: {replacement} is loaded already ({loaded.file}:{loaded.line})")
        elif replacement is not None:
            by_replacement.setdefault(replacement, []).append(library)
    replaced = "; ".join(f"{join_names(names)} by {how}" for how, names in by_replacement.items())
    return "for Gazebo Classic in ROS 2, " + "; ".join([*deleted, *([f"replace {replaced}"] if replaced else [])])


def _find_replacement(library: str) -> str:
    """Return what replaces a library; that of a longer or shorter name is a fork of it: ``gazebo_ros_ackerman``."""
    fork = _REPLACEMENTS.get(library) or _REPLACEMENTS.get(find_only_near_name(library, _REPLACEMENTS) or "")
    return fork or (_SENSOR_SYSTEM if _SENSORS.search(library) else _UNKNOWN_SYSTEM)


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
