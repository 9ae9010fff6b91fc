"""GZB002: materials and plugins that only Gazebo Classic understands."""

from __future__ import annotations

import re
from collections.abc import Iterator

from urdfcheck.core import Finding, Rule
from urdfcheck.model import Model
from urdfcheck.model.names import listed
from urdfcheck.source.xml import Attribute, Element

# Libraries of gazebo_ros_pkgs, gazebo_ros2_control, gazebo_ros_control and hector_gazebo: all are built for Classic.
_CLASSIC = re.compile(r"^(?:lib)?(gazebo_ros\w*|hector_gazebo_ros\w*)(?:\.so)?$")
_SYSTEMS = "the sensor itself: gz-sim-sensors-system renders it and ros_gz_bridge brings it to ROS"
_REPLACEMENTS = {
    "gazebo_ros_control": "gz_ros2_control (ROS 2): filename gz_ros2_control-system",
    "gazebo_ros2_control": "gz_ros2_control: filename gz_ros2_control-system, "
    "name gz_ros2_control::GazeboSimROS2ControlPlugin",
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
    "hector_gazebo_ros_sonar": _SYSTEMS,
}
_SENSORS = re.compile(r"camera|kinect|laser|ray|range|prosilica|velodyne")


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    gazebo = [e for extension in model.robot.all("gazebo") for e in extension.walk()]
    materials: dict[str, list[Element]] = {}
    for element in gazebo:
        if element.text.strip().startswith("Gazebo/") and element.span is not None:
            materials.setdefault(element.span.file, []).append(element)
    for group in materials.values():
        yield _materials(rule, group)
    plugins: dict[str, list[Attribute]] = {}
    for element in gazebo:
        filename = element.attributes.get("filename")
        match = _CLASSIC.match(filename.value.strip()) if element.tag == "plugin" and filename is not None else None
        if match and filename is not None:
            plugins.setdefault(match.group(1), []).append(filename)
    for library, uses in plugins.items():
        yield _plugin(rule, library, uses)
    yield from _hardware(model, rule)


def _materials(rule: Rule, elements: list[Element]) -> Finding:
    places = list({element.span: element for element in elements}.values())
    return rule.finding(
        "material",
        at=places[0],
        related=places[1:],
        which="1 material has a name" if len(elements) == 1 else f"{len(elements)} materials have names",
        names=listed(dict.fromkeys(element.text.strip() for element in elements)),
    )


def _plugin(rule: Rule, library: str, uses: list[Attribute]) -> Finding:
    places = list({use.span: use for use in uses}.values())
    return rule.finding(
        "plugin",
        at=places[0],
        related=places[1:],
        library=uses[0].value.strip(),
        times="" if len(uses) == 1 else f" (used {len(uses)} times)",
        replacement=_replacement(library),
    )


def _replacement(library: str) -> str:
    known = _REPLACEMENTS.get(library)
    if known is not None:
        return known
    return _SYSTEMS if _SENSORS.search(library) else "a gz-sim system that does the same; there is none of that name"


def _hardware(model: Model, rule: Rule) -> Iterator[Finding]:
    for control in model.robot.all("ros2_control"):
        for plugin in (e for e in control.walk() if e.tag == "plugin"):
            if plugin.text.strip().startswith("gazebo_ros2_control/"):
                yield rule.finding("hardware", at=plugin, plugin=plugin.text.strip(), control=control.get("name"))
