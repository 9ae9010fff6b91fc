"""GZB005 reports entries of a ros_gz_bridge configuration that cannot be bridged."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

from urdfcheck.core import Finding, Fix, Rule
from urdfcheck.core.text import find_nearest_name, find_only_near_name, format_name_hint, join_names
from urdfcheck.source.package.finder import Package, PackageFinder
from urdfcheck.source.package.package_folders import BUILD_FOLDERS
from urdfcheck.source.ros.yaml_files import read_located_yaml
from urdfcheck.source.text.yaml.values import YamlReadError, YamlValue
from urdfcheck.system.files import read_regular, walk

# ROS type and type of Gazebo Transport, as ros_gz_bridge lists them in its README (rolling, 2026).
_BRIDGED = """
actuator_msgs/Actuators Actuators; builtin_interfaces/Time Time; geometry_msgs/Point Vector3d; geometry_msgs/Pose Pose;
geometry_msgs/PoseArray Pose_V; geometry_msgs/PoseStamped Pose; geometry_msgs/PoseWithCovariance PoseWithCovariance;
geometry_msgs/PoseWithCovarianceStamped PoseWithCovariance; geometry_msgs/Quaternion Quaternion;
geometry_msgs/Transform Pose; geometry_msgs/TransformStamped Pose; geometry_msgs/Twist Twist;
geometry_msgs/TwistStamped Twist; geometry_msgs/TwistWithCovariance TwistWithCovariance;
geometry_msgs/TwistWithCovarianceStamped TwistWithCovariance; geometry_msgs/Vector3 Vector3d; geometry_msgs/Wrench Wrench;
geometry_msgs/WrenchStamped Wrench; gps_msgs/GPSFix NavSat; nav_msgs/Odometry Odometry OdometryWithCovariance;
rcl_interfaces/ParameterValue Any; ros_gz_interfaces/Altimeter Altimeter; ros_gz_interfaces/Contact Contact;
ros_gz_interfaces/Contacts Contacts; ros_gz_interfaces/Dataframe Dataframe; ros_gz_interfaces/Entity Entity;
ros_gz_interfaces/EntityWrench EntityWrench; ros_gz_interfaces/Float32Array Float_V; ros_gz_interfaces/GuiCamera GUICamera;
ros_gz_interfaces/JointWrench JointWrench; ros_gz_interfaces/Light Light; ros_gz_interfaces/ParamVec Param Param_V;
ros_gz_interfaces/SensorNoise SensorNoise; ros_gz_interfaces/StringVec StringMsg_V; ros_gz_interfaces/TrackVisual TrackVisual;
ros_gz_interfaces/VideoRecord VideoRecord; rosgraph_msgs/Clock Clock; sensor_msgs/BatteryState BatteryState;
sensor_msgs/CameraInfo CameraInfo; sensor_msgs/FluidPressure FluidPressure; sensor_msgs/Image Image; sensor_msgs/Imu IMU;
sensor_msgs/JointState Model; sensor_msgs/Joy Joy; sensor_msgs/LaserScan LaserScan; sensor_msgs/MagneticField Magnetometer;
sensor_msgs/NavSatFix NavSat; sensor_msgs/PointCloud2 PointCloudPacked; std_msgs/Bool Boolean; std_msgs/ColorRGBA Color;
std_msgs/Empty Empty; std_msgs/Float32 Float; std_msgs/Float64 Double; std_msgs/Header Header; std_msgs/Int32 Int32;
std_msgs/String StringMsg; std_msgs/UInt32 UInt32; tf2_msgs/TFMessage Pose_V; trajectory_msgs/JointTrajectory JointTrajectory;
vision_msgs/Detection2D AnnotatedAxisAligned2DBox; vision_msgs/Detection2DArray AnnotatedAxisAligned2DBox_V;
vision_msgs/Detection3D AnnotatedOriented3DBox; vision_msgs/Detection3DArray AnnotatedOriented3DBox_V
"""
_PAIRS = {ros.replace("/", "/msg/"): tuple(others) for ros, *others in (entry.split() for entry in _BRIDGED.split(";"))}
_GZ_TYPES = frozenset(name for names in _PAIRS.values() for name in names)
# Nothing in Gazebo publishes it: image_transport makes it from the bridged image.
_COMPRESSED = "sensor_msgs/msg/CompressedImage"
_GZ_PREFIX = re.compile(r"^(?:gz|ignition)(?:\.msgs\.|::msgs::)")
_DIRECTIONS = ("BIDIRECTIONAL", "GZ_TO_ROS", "ROS_TO_GZ")
_KEYS = frozenset({
    "topic_name", "ros_topic_name", "gz_topic_name", "ros_type_name", "gz_type_name", "direction", "publisher_queue",
    "subscriber_queue", "lazy", "publish_optical_frame", "qos_profile", "frame_id",
})  # fmt: skip
# An entry has one of these, or one or both of those.
_ONE_TOPIC, _TWO_TOPICS = frozenset({"topic_name"}), frozenset({"ros_topic_name", "gz_topic_name"})
_TEMPLATE = re.compile(r"[$<>{}%]")
# At most this many bridge configurations are checked in one package, and this many yaml files read to find them.
_MOST_CONFIGS, _MOST_READ = 100, 2_000


def check(package: Package, rule: Rule) -> Iterator[Finding]:
    if package.finder is None:
        return
    for path in _find_bridge_configs(package.path, package.finder):
        try:
            content = read_located_yaml(path, package.finder)
        except YamlReadError:  # the program that loads it reports it
            continue
        entries = () if content is None else content.items
        for entry in entries:
            if entry.get("ros_type_name") is not None or entry.get("gz_type_name") is not None:
                yield from _check_keys(entry, entries, rule)
                yield from _check_entry(entry, entries, rule)


def _find_bridge_configs(folder: Path, finder: PackageFinder) -> list[Path]:
    """Return the yaml files of a package that name types of both sides."""
    configs: list[Path] = []
    read = 0
    for place, names, files in walk(folder):
        names[:] = [name for name in names if not name.startswith(".") and name not in BUILD_FOLDERS]
        for name in files:
            path = Path(place, name)
            if not name.endswith((".yaml", ".yml")) or read >= _MOST_READ or not finder.can_open(path):
                continue
            read += 1
            try:
                text = read_regular(path)
            except OSError:
                continue
            if b"ros_type_name" in text and b"gz_type_name" in text and len(configs) < _MOST_CONFIGS:
                configs.append(path)
    return configs


def _check_keys(entry: YamlValue, entries: Iterable[YamlValue], rule: Rule) -> Iterator[Finding]:
    """Report keys that resemble those of the bridge. Meant is a key that the entry lacks; rather one that other entries have."""
    own = {key.text for key, _ in entry.entries}
    others = {key.text for other in entries for key, _ in other.entries}
    lacking = _KEYS - own - (_TWO_TOPICS if own & _ONE_TOPIC else _ONE_TOPIC if own & _TWO_TOPICS else frozenset())
    for key, _ in entry.entries:
        if key.text in _KEYS or find_nearest_name(key.text, _KEYS) is None:
            continue
        near = find_nearest_name(key.text, lacking & others) or find_nearest_name(key.text, lacking)
        is_only = near is not None and near == find_only_near_name(key.text, lacking)
        yield rule.finding(
            "key",
            at=key,
            edits=key.build_edits(near) if near is not None and is_only else (),
            key=key.text,
            near="" if near is None else f" (did you mean {near!r}?)",
            repair="correct the key, or delete it" if near is None else f"write {near}",
        )


def _check_entry(entry: YamlValue, entries: Iterable[YamlValue], rule: Rule) -> Iterator[Finding]:
    both = entry.get("topic_name"), entry.get("ros_topic_name") or entry.get("gz_topic_name")
    if both[0] is not None and both[1] is not None:
        yield rule.finding("both", at=both[0], other=both[1].key.rpartition(".")[2])
    direction = entry.get("direction")
    if direction is not None and direction.text not in _DIRECTIONS and not _TEMPLATE.search(direction.text):
        meant = find_only_near_name(direction.text.upper(), _DIRECTIONS)
        respelled = direction.text.upper() if direction.text.upper() in _DIRECTIONS else meant
        edits = () if respelled is None else direction.build_edits(respelled)
        yield rule.finding("direction", at=direction, edits=edits, direction=direction.text)
    double = _find_double(entry, entries)
    for finding in _check_types(entry, rule):
        # Corrected, the entry would be a second bridge between the two topics.
        yield finding if double is None else replace(finding, fix=_propose_deletion(double))


def _propose_deletion(double: YamlValue) -> Fix:
    return Fix(f"delete the entry: the one in line {double.span.line} already bridges the two topics")


def _find_double(entry: YamlValue, entries: Iterable[YamlValue]) -> YamlValue | None:
    """Find an entry that works and bridges the topics of another one, in all directions that this asks for."""
    topics, direction = _read_topics(entry), _read_direction(entry)
    return next(
        (
            other
            for other in entries
            if other is not entry
            and topics is not None
            and _read_topics(other) == topics
            and _read_direction(other) in {direction, _DIRECTIONS[0]}
            and _has_bridged_types(other)
        ),
        None,
    )


def _read_topics(entry: YamlValue) -> tuple[str, str] | None:
    """Read the topics of both sides, of which one stands for both where it is alone; None where a template makes them."""
    both = entry.get("topic_name")
    ros, gz = (entry.get(key) if both is None else both for key in ("ros_topic_name", "gz_topic_name"))
    sides = ros or gz, gz or ros
    if sides[0] is None or sides[1] is None or _TEMPLATE.search(sides[0].text + sides[1].text):
        return None
    return sides[0].text.strip("/"), sides[1].text.strip("/")


def _read_direction(entry: YamlValue) -> str:
    direction = entry.get("direction")
    return _DIRECTIONS[0] if direction is None else direction.text


def _has_bridged_types(entry: YamlValue) -> bool:
    ros, gz = entry.get("ros_type_name"), entry.get("gz_type_name")
    if ros is None or gz is None or not _GZ_PREFIX.search(gz.text):
        return False
    return _GZ_PREFIX.sub("", gz.text) in _PAIRS.get(ros.text, ())


def _check_types(entry: YamlValue, rule: Rule) -> Iterator[Finding]:
    ros, gz = entry.get("ros_type_name"), entry.get("gz_type_name")
    if ros is None or gz is None:
        missing = "ros_type_name" if ros is None else "gz_type_name"
        yield rule.finding("missing", at=ros or gz or entry, key=missing)
        return
    if _TEMPLATE.search(ros.text + gz.text):
        return
    kind = _GZ_PREFIX.sub("", gz.text)
    if ros.text == _COMPRESSED:
        yield rule.finding("compressed", at=ros, type=ros.text)
    elif ros.text not in _PAIRS:
        whole = ros.text.replace("/", "/msg/") if "/msg/" not in ros.text else ros.text
        meant = whole if whole in _PAIRS else find_only_near_name(ros.text, _PAIRS)
        if meant is not None:  # a newer release may bridge any other type
            # A name that is alike is only meant if the other side agrees.
            edits = ros.build_edits(meant) if kind in _PAIRS[meant] else ()
            yield rule.finding("ros-type", at=ros, edits=edits, type=ros.text, meant=meant)
    elif kind not in _PAIRS[ros.text]:
        partners = _PAIRS[ros.text]
        nearest = find_nearest_name(kind, _GZ_TYPES)
        # Of two types that exist, either may be the wrong one.
        is_certain = kind not in _GZ_TYPES and len(partners) == 1 and nearest in (None, partners[0])
        edits = gz.build_edits(f"gz.msgs.{partners[0]}") if is_certain else ()
        meant = kind if kind in _GZ_TYPES else nearest
        others = [] if meant in partners else [name for name, names in _PAIRS.items() if meant in names]
        ros_types = join_names(others, 3)
        otherwise = (
            f"; if this Gazebo type is meant, write {ros_types} as the ROS type"
            if meant == kind
            else f"; if gz.msgs.{meant} is meant, write that, and {ros_types} as the ROS type"
        )
        yield rule.finding(
            "pair" if kind in _GZ_TYPES else "gz-type",
            at=gz,
            edits=edits,
            ros=ros.text,
            gz=gz.text,
            partners=" or ".join(f"gz.msgs.{name}" for name in partners),
            near=format_name_hint(kind, _GZ_TYPES),
            otherwise=otherwise if others else "",
        )
    elif kind == gz.text:
        yield rule.finding("prefix", at=gz, edits=gz.build_edits(f"gz.msgs.{kind}"), gz=gz.text)
