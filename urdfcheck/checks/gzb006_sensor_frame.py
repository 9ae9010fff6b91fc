"""GZB006 reports sensors of the new Gazebo that name no frame: their data has one that the robot lacks."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from urdfcheck.core import FactUnavailableError, Finding, Rule, Severity
from urdfcheck.core.merging import build_group_finding
from urdfcheck.core.text import join_names
from urdfcheck.model import Model
from urdfcheck.model.fixed_joint_lumping import reduce_fixed_joints
from urdfcheck.model.gazebo import (
    CAMERA_TYPE,
    FRAME_TAGS,
    OPTICAL_FRAME_TAG,
    GazeboSensor,
    is_for_new_gazebo,
    list_sensors,
)
from urdfcheck.system.files import read_regular, walk

_FRAMES = FRAME_TAGS | {OPTICAL_FRAME_TAG}
# The sensors whose data programs place by its frame.
_PLACED = re.compile(r"camera|depth|rgbd|thermal|segmentation|lidar|ray|imu|sonar")
# The new Gazebo makes no sensor of these, so nothing is stamped: GZB004 reports them.
_CPU_LIDARS = frozenset({"ray", "lidar"})
_BRIDGES = ("ros_gz", "ros_ign")
# A bridge may write a frame of its own into what it hands to ROS, beside the topic (ros_gz_bridge since Kilted).
_BRIDGED_FRAME = re.compile(r"""frame_id["']?\s*[:=]\s*["']?/?([\w/.-]+)""")
# What a bridge says that hands topics to ROS: the type of each, or that it is one for pictures.
_BRIDGED = re.compile(r"\b(?:gz|ignition)\.msgs\b|\bimage_bridge\b")
# Data of a camera that is more than pictures: programs place it by its frame.
_PLACED_BY_FRAME = re.compile(r"camera_?info|point_?cloud|\bpoints\b", re.IGNORECASE)
_PICTURES = "still shows the pictures; its Camera display, depth clouds and image_proc need the frame"
_NO_DATA = "gets no data: no bridge of the package hands it on"
# The name that a launch file gives the robot in Gazebo.
_SPAWNED_NAME = re.compile(r"(?<![\w-])-name[\"']?[\s,]+[\"']?([\w-]+)")
_TEXTS = (".py", ".xml", ".launch", ".yaml", ".yml")
# Files of the package that are searched for the frame: a transform or a node may supply it.
_MOST_FILES, _LARGEST = 200, 200_000


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    if not is_for_new_gazebo(model):
        return
    broadcast = _collect_broadcast_names(model)
    without = [sensor for sensor in list_sensors(model) if _lacks_frame(sensor) and sensor.name not in broadcast]
    texts = list(_read_texts(model)) if without else []
    if not _speaks_ros(model, texts):
        return
    bodies = _find_bodies(model)
    without = [
        sensor
        for sensor in without
        if not any(_names_frame(text, sensor, bodies) or _bridges_frame(text, sensor, model) for text in texts)
    ]
    bridging = [text for text in texts if _BRIDGED.search(text)]
    carried = [sensor for sensor in without if not bridging or _list_carrying(sensor, bridging)]
    placed = [sensor for sensor in carried if not bridging or _is_placed(sensor, _list_carrying(sensor, bridging))]
    is_note, without = not placed, placed or without
    if without:
        first = without[0]
        yield build_group_finding(
            rule,
            "absent",
            [sensor.element for sensor in without],
            severity=Severity.INFO if is_note else None,
            consequences={"rviz": _PICTURES if carried else _NO_DATA} if is_note else None,
            sensors=join_names(f"{sensor.name} ({sensor.type})" for sensor in without),
            count=len(without),
            noun="sensor" if len(without) == 1 else "sensors",
            verb="names" if len(without) == 1 else "name",
            example=f"{_find_spawned_name(texts) or model.name}/{bodies.get(first.reference, first.reference)}/{first.name}",
            repair=_describe_repair({sensor.name: _choose_frame(model, sensor, bodies) for sensor in without}),
        )


def _list_carrying(sensor: GazeboSensor, bridging: Iterable[str]) -> list[str]:
    """List the texts about bridges that name a sensor, or the end of its topic: what is before that may be computed."""
    topic = sensor.element.find_child("topic")
    ends = {sensor.name, "" if topic is None else topic.text.strip().rpartition("/")[2]} - {""}
    named = [re.compile(rf"(?<!\w){re.escape(end)}(?!\w)") for end in ends]
    return [text for text in bridging if any(pattern.search(text) for pattern in named)]


def _is_placed(sensor: GazeboSensor, carrying: Iterable[str]) -> bool:
    """Whether programs place the data that these bridges hand on by its frame: not the pictures of a camera alone."""
    return any(sensor.type != "camera" or _PLACED_BY_FRAME.search(text) for text in carrying)


def _find_spawned_name(texts: Iterable[str]) -> str:
    """Return the name under which launch files spawn the robot, if they give it one."""
    names = {match.group(1) for text in texts for match in _SPAWNED_NAME.finditer(text)}
    return names.pop() if len(names) == 1 else ""


def _describe_repair(frames: Mapping[str, str]) -> str:
    """Say which frame each sensor is to name."""
    if len(set(frames.values())) == 1:
        return f"`<gz_frame_id>{next(iter(frames.values()))}</gz_frame_id>` into {'the sensor' if len(frames) == 1 else 'each'}"
    places = join_names((f"{frame} into {sensor}" for sensor, frame in frames.items()), 4)
    return f"`<gz_frame_id>…</gz_frame_id>` into each: {places}"


def _choose_frame(model: Model, sensor: GazeboSensor, bodies: Mapping[str, str]) -> str:
    """Return the link that a sensor is to name: of a camera the optical frame that is fixed behind its link, if there is one."""
    body = bodies.get(sensor.reference)
    optical = [
        name
        for name in model.link_by_name
        if "optical" in name.lower()
        and bodies.get(name, "") == body
        and any(joint.parent == sensor.reference for joint in model.tree.find_path_to(name))
    ]
    return optical[0] if CAMERA_TYPE.search(sensor.type) and len(optical) == 1 else sensor.reference


def _collect_broadcast_names(model: Model) -> frozenset[str]:
    """Return the sensors that ros2_control reads: its broadcasters name the frame."""
    blocks = model.robot.find_children("ros2_control")
    return frozenset(sensor.get("name") for block in blocks for sensor in block.find_children("sensor"))


def _speaks_ros(model: Model, texts: Iterable[str]) -> bool:
    """Whether ROS gets the data: by a plugin, a dependency of the package, or a bridge that it starts. Others need no frame."""
    plugins = [e for block in model.robot.find_children("gazebo") for e in block.walk() if e.tag == "plugin"]
    needed = frozenset() if model.package is None else model.package.dependencies
    return (
        any("ros" in plugin.get("filename").lower() for plugin in plugins)
        or any(name.startswith(_BRIDGES) for name in needed)
        or any(name in text for text in texts for name in _BRIDGES)
    )


def _lacks_frame(sensor: GazeboSensor) -> bool:
    if sensor.type in _CPU_LIDARS:
        return False
    if any(element.tag == "plugin" for element in sensor.element.walk()):
        return False  # the plugin publishes the data
    named = any(element.tag in _FRAMES and element.text.strip() for element in sensor.element.walk())
    return _PLACED.search(sensor.type) is not None and not named


def _find_bodies(model: Model) -> Mapping[str, str]:
    """Return the link that Gazebo merges each link into, which is the middle of the frame; nothing where the tree is broken."""
    try:
        return reduce_fixed_joints(model).body_by_link
    except FactUnavailableError:
        return {}


def _names_frame(text: str, sensor: GazeboSensor, bodies: Mapping[str, str]) -> bool:
    """Whether a file names the frame that the data has, ``ROBOT/LINK/SENSOR``, or builds it."""
    links = (sensor.reference, bodies.get(sensor.reference, sensor.reference))
    return sensor.name != "" and (any(f"{link}/{sensor.name}" in text for link in links) or f"::{sensor.name}" in text)


def _bridges_frame(text: str, sensor: GazeboSensor, model: Model) -> bool:
    """Whether a file names the sensor's topic, and a link of the robot as the frame of what a bridge hands on."""
    topic = sensor.element.find_child("topic")
    name = "" if topic is None else topic.text.strip().strip("/")
    if not name or not re.search(rf"(?<![\w/])/?{re.escape(name)}(?![\w/])", text):
        return False
    return any(match.group(1) in model.link_by_name for match in _BRIDGED_FRAME.finditer(text))


def _read_texts(model: Model) -> Iterator[str]:
    """Yield the launch files and settings of the model's package."""
    package, finder = model.package, model.source.finder
    if package is None or not finder.can_open(package.path):
        return
    files = (
        Path(folder, name)
        for top in ("launch", "config", "params")
        for folder, _, names in walk(package.path / top)
        for name in sorted(names)
        if name.endswith(_TEXTS)
    )
    for path in itertools.islice(files, _MOST_FILES):
        try:
            if finder.can_open(path):
                yield read_regular(path, _LARGEST).decode("utf-8", "replace")
        except OSError:
            continue
