"""GZB004 reports sensors of an unknown type, and frames, collisions and topics that are missing or used twice."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from collections.abc import Set as AbstractSet
from difflib import SequenceMatcher

from urdfcheck.core import FactUnavailableError, Finding, Location, Rule, Severity, Span
from urdfcheck.core.records import dataclass
from urdfcheck.core.text import (
    compile_names,
    find_nearest_name,
    find_only_near_name,
    format_name_hint,
    join_names,
    split_name_words,
)
from urdfcheck.model import Model
from urdfcheck.model.fixed_joint_lumping import (
    FixedJointReduction,
    find_preserved_names,
    names_fixed_part,
    reduce_fixed_joints,
)
from urdfcheck.model.gazebo import (
    CAMERA_TYPE,
    OPTICAL_FRAME_TAG,
    PLUGIN_FRAME_TAGS,
    GazeboSensor,
    is_for_new_gazebo,
    list_sensors,
)
from urdfcheck.model.repairs.edits import edit_content, edit_literal, locate_content
from urdfcheck.model.use.gazebo_starts import is_only_for_classic, is_unread, loads_system_plugin, names_successor
from urdfcheck.model.use.project_texts import list_publishing_texts
from urdfcheck.source.package.build_files import is_only_of_ros2
from urdfcheck.source.text.tokens import read_typed_content
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import Element

# The types in Sensor::Load of sdformat 12 to 15, and those that only Gazebo Classic has.
_TYPES = frozenset({
    "none", "air_pressure", "air_speed", "altimeter", "boundingbox", "boundingbox_camera", "camera", "contact", "custom",
    "depth", "depth_camera", "force_torque", "gps", "gpu_lidar", "gpu_ray", "imu", "lidar", "logical_camera", "magnetometer",
    "multicamera", "navsat", "ray", "rfid", "rfidtag", "rgbd", "rgbd_camera", "segmentation", "segmentation_camera", "sonar",
    "thermal", "thermal_camera", "wide_angle_camera", "wideanglecamera", "wireless_receiver", "wireless_transmitter",
})  # fmt: skip
_RENDERED = re.compile(r"camera|depth|rgbd|thermal|segmentation|boundingbox|gpu_")
_FRAMES = PLUGIN_FRAME_TAGS | {OPTICAL_FRAME_TAG}
_NEW_GAZEBO_FRAMES = frozenset({"gz_frame_id", "ignition_frame_id"})
# Frames that other programs publish.
_EXTERNAL_FRAMES = frozenset({"world", "map", "odom", "earth", "ground_plane"})
# An optical frame is inside its camera, at most this far from the frame of it (m). Chosen: the lenses of a depth camera are 15 mm
# apart, and the cameras of a rig 60 mm.
_BESIDE = 0.03
# Each unknown frame is compared with all links; more links than this were generated and not typed.
_MOST_COMPARED = 1_000
# Of two names without the words "link" and "frame".
_STEM_LIKENESS = 0.75
# Names of collisions that a message lists.
_MOST_NAMED = 4
_SHARED_NAME = "make the SDF name of each link's collision a parameter of the macro"
# What stands for "no topic given": SDFormat's default is written out where a model was converted or copied from its description.
_NO_TOPIC = frozenset({"", "__default_topic__"})


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class _UnknownCollision:
    """A collision that a contact sensor names but that no SDF shape has as its name."""

    sensor: GazeboSensor
    element: Element
    name: str
    body: str
    """The sensor's link in SDF."""
    candidates: tuple[str, ...]
    """The first few names of the shapes of the sensor's own link in SDF."""


# The plugins of ROS for Gazebo Classic that read `<frameName>` for ROS 1 and only `<frame_name>` for ROS 2.
_RENAMED_FRAME = re.compile(r"(?:lib)?gazebo_ros_(?:imu_sensor|ray_sensor|camera|gps_sensor)(?:\.so)?")
# Gazebo Classic does not compare the names of sensors.
_IN_CLASSIC = "loads them all under one name and one topic"
_MIXED = f"{_IN_CLASSIC}: the plugins read this topic and mix the data"
# The plugins that read the topic of their sensor; others read the sensor itself.
_READS_TOPIC = re.compile(r"laser|ray_sensor")


def check(model: Model, rule: Rule) -> Iterator[Finding]:
    sensors = list_sensors(model)
    folded = {name.lower(): name for name in model.link_by_name}
    taken = {sensor.reference for sensor in sensors}
    for sensor in sensors:
        yield from _check_type(model, sensor, rule)
        yield from _check_update_rate(sensor, rule)
        yield from _check_frames(model, rule, sensor, folded=folded, taken=taken)
    if is_for_new_gazebo(model):
        for sensor in sensors:
            yield from _check_cpu_lidar(sensor, rule)
    yield from _check_duplicate_topics(_drop_repeated(sensors), rule)
    try:
        reduction = reduce_fixed_joints(model)
    except FactUnavailableError:
        return
    yield from _check_duplicate_names(model, sensors, reduction, rule)
    unknowns = list(_iter_unknown_collisions(sensors, reduction))
    for unknown in unknowns:
        if _is_meant_to_be_kept(model, unknown.sensor.reference, reduction):
            continue  # GZB001 and GZB003 report the block that does not keep the link
        element, names, files = unknown.element, unknown.candidates, model.source.files
        other = _find_other_link(model, unknown)
        bare = _find_bare_link(model, unknown)
        is_shared = len({u.sensor.reference for u in unknowns if u.element.span == element.span}) > 1
        yield rule.finding(
            "collision",
            at=locate_content(element, files),
            severity=Severity.INFO if is_unread(model, unknown.sensor) else None,
            edits=edit_content(element, names[0], files)
            if len(names) == 1 and other is None and bare is None and not is_shared
            else (),
            sensor=unknown.sensor.name,
            collision=unknown.name,
            body=unknown.body,
            repair=_SHARED_NAME if is_shared else _describe_collision_repair(unknown, other, bare),
        )


def _check_type(model: Model, sensor: GazeboSensor, rule: Rule) -> Iterator[Finding]:
    typed = sensor.element.attributes.get("type")
    if typed is None or sensor.type in _TYPES:
        return
    meant = find_only_near_name(sensor.type, _TYPES)
    near = format_name_hint(sensor.type, _TYPES)
    # Classic makes sensors of the types that plugins register with it.
    is_own = (
        not near and any(element.tag == "plugin" for element in sensor.element.walk()) and not is_for_new_gazebo(model)
    )
    if is_own and loads_system_plugin(model):
        return
    yield rule.finding(
        "own-type" if is_own else "type",
        at=typed,
        severity=Severity.INFO if is_own else None,
        edits=() if meant is None else edit_literal(typed, meant),
        sensor=sensor.name,
        type=sensor.type,
        near=near,
    )


def _check_update_rate(sensor: GazeboSensor, rule: Rule) -> Iterator[Finding]:
    """Report a camera or lidar that renders a picture in every time step."""
    rate = sensor.element.find_child("update_rate")
    if _RENDERED.search(sensor.type) and (rate is None or parse_number(rate.text.strip()) == 0.0):
        at = sensor.element if rate is None else rate
        wanted = _find_plugin_rate(sensor)
        repair = (
            "add <update_rate>30</update_rate>, or the rate of the real sensor"
            if wanted is None
            else f"add <update_rate>{wanted}</update_rate>, the rate at which its plugin publishes"
        )
        yield rule.finding("rate", at=at, severity=Severity.INFO, sensor=sensor.name, type=sensor.type, repair=repair)


def _find_plugin_rate(sensor: GazeboSensor) -> str | None:
    """Return the rate of a sensor's plugin, which leaves out pictures that were rendered."""
    plugins = [child for child in sensor.element.children if child.tag == "plugin"]
    texts = [e.text.strip() for plugin in plugins for e in plugin.children if e.tag in {"updateRate", "update_rate"}]
    return next((text for text in texts if (parse_number(text) or 0.0) > 0.0), None)


def _check_frames(
    model: Model, rule: Rule, sensor: GazeboSensor, *, folded: Mapping[str, str], taken: AbstractSet[str]
) -> Iterator[Finding]:
    """Report frames that are not links; ``folded`` has the links' names by their lower case, ``taken`` those with sensors."""
    own = [child for child in sensor.element.children if child.tag in _NEW_GAZEBO_FRAMES]
    # The frame of a sensor of the new Gazebo counts; plugins inside are those of Classic.
    for element in own if own and is_for_new_gazebo(model) else sensor.element.walk():
        frame = element.text.strip().lstrip("/")
        if not _names_frame(element) or not frame or frame in _EXTERNAL_FRAMES or frame in model.link_by_name:
            continue
        if any(mark in frame for mark in ("/", "::", "$")):  # of another robot or namespace
            continue
        if _is_published(model, frame) or _may_get_prefix(model, frame):
            continue
        respelled = folded.get(frame.lower())
        meant = respelled or _find_optical_frame(sensor, model) or _guess_frame(frame, sensor, model, taken=taken)
        if meant is None and sensor.reference not in model.link_by_name and sensor.reference not in model.joint_by_name:
            continue  # a block for a part that the robot lacks is ignored, so no data has the frame: GZB001 reports it
        if meant is None and _is_published(model, frame, in_project=True):
            continue
        if _is_ignored_frame(model, element):
            yield rule.finding(
                "frame-ignored",
                at=locate_content(element, model.source.files),
                severity=Severity.INFO,
                sensor=sensor.name,
                frame=frame,
                repair="delete it, or write a link in <frame_name>" + ("" if meant is None else f", such as {meant}"),
            )
            continue
        yield rule.finding(
            "frame" if meant is not None else "frame-elsewhere",
            at=locate_content(element, model.source.files),
            severity=Severity.WARNING if meant is not None else Severity.INFO,
            edits=() if respelled is None else edit_content(element, respelled, model.source.files),
            sensor=sensor.name,
            frame=frame,
            meant=meant or "",
            repair="" if meant is None else _describe_frame_repair(element, frame, meant, model),
        )


def _names_frame(element: Element) -> bool:
    """Whether something reads an element as the name of a frame: in the settings of an IMU or a lidar nothing does."""
    inside = "" if element.parent is None else element.parent.tag
    return element.tag in _FRAMES and (inside in {"sensor", "plugin"} or element.tag == OPTICAL_FRAME_TAG)


def _may_get_prefix(model: Model, frame: str) -> bool:
    """Whether a link has the frame's name behind a slash: ROS drops a slash at the start, and the plugins of ROS 1 put the
    robot's tf_prefix before the frame."""
    if f"/{frame}" in model.link_by_name:
        return True
    package = model.source.package
    is_of_ros2 = (package is not None and is_only_of_ros2(package.root)) or is_for_new_gazebo(model)
    return not is_of_ros2 and any(name.endswith(f"/{frame}") for name in model.link_by_name)


def _is_ignored_frame(model: Model, element: Element) -> bool:
    """Whether an element names a frame for ROS 1, in a plugin of ROS 2."""
    package, plugin = model.source.package, element.parent
    if element.tag != "frameName" or package is None or plugin is None or plugin.tag != "plugin":
        return False
    return is_only_of_ros2(package.root) and _RENAMED_FRAME.fullmatch(plugin.get("filename").strip()) is not None


def _describe_frame_repair(element: Element, frame: str, meant: str, model: Model) -> str:
    """Say what to write for a frame; for one that xacro computes, in the terms of its expression."""
    typed = read_typed_content(element, model.source.files)
    if "$" not in typed:
        is_same_part = _strip_kind_words(meant) == _strip_kind_words(frame)
        return f"write {meant}" if is_same_part else f"write {meant}, unless a program publishes {frame}"
    return f"write {typed}{meant.removeprefix(frame)}" if meant.startswith(frame) else f"make {typed} give {meant}"


def _is_published(model: Model, frame: str, *, in_project: bool = False) -> bool:
    """Whether a launch file of the model's package, or of one that depends on it, or of any one, publishes a frame."""
    return any(map(compile_names((frame,)).search, list_publishing_texts(model, in_project=in_project)))


def _find_optical_frame(sensor: GazeboSensor, model: Model) -> str | None:
    """Return the only optical frame on a camera's link or below it: pictures are stamped with that (REP 103). Not one that is
    elsewhere: a camera without a pose is where its link is."""
    if not CAMERA_TYPE.search(sensor.type) or sensor.reference not in model.link_by_name:
        return None
    try:
        children = model.tree.child_joints
    except FactUnavailableError:
        return None
    waiting, found = [sensor.reference], []
    while waiting:
        link = waiting.pop()
        found += [link] if "optical" in link.lower() else []
        waiting += [joint.child for joint in children.get(link, ()) if joint.type == "fixed"]
    if len(found) != 1 or sensor.element.find_child("pose") is not None:
        return found[0] if len(found) == 1 else None
    try:
        places = [model.frames[name][:3, 3] for name in (sensor.reference, found[0])]
    except FactUnavailableError:
        return None  # where it is, is not known
    return found[0] if math.dist(*places) < _BESIDE else None


def _guess_frame(frame: str, sensor: GazeboSensor, model: Model, *, taken: AbstractSet[str]) -> str | None:
    """Return the link that an unknown frame may mean: the sensor's own if only the words "link" and "frame" differ.

    Not one that has another sensor (``taken``): the IMU of a camera is not at the robot's ``imu_link``.
    """
    if sensor.reference in model.link_by_name and _strip_kind_words(frame) == _strip_kind_words(sensor.reference):
        return sensor.reference
    if CAMERA_TYPE.search(sensor.type):
        return None  # a picture needs an optical frame, whatever the names are like
    if len(model.link_by_name) > _MOST_COMPARED:
        return None
    free = (name for name in model.link_by_name if name == sensor.reference or name not in taken)
    return find_nearest_name(frame, (name for name in free if _names_like_part(frame, name)))


def _names_like_part(one: str, other: str) -> bool:
    """Whether two names may mean one part: not `us_1_link` and `wrist_1_link`, which are alike only in `1_link`."""
    words, others = _strip_kind_words(one), _strip_kind_words(other)
    if not words or not others:
        return False
    is_part = set(words) <= set(others) or set(others) <= set(words)
    return is_part or SequenceMatcher(None, "".join(words), "".join(others)).ratio() >= _STEM_LIKENESS


def _strip_kind_words(name: str) -> list[str]:
    return [word.lower() for word in split_name_words(name) if word.lower() not in {"link", "frame"}]


def _check_cpu_lidar(sensor: GazeboSensor, rule: Rule) -> Iterator[Finding]:
    typed = sensor.element.attributes.get("type")
    if typed is not None and sensor.type in {"ray", "lidar"}:
        edits = edit_literal(typed, "gpu_lidar")
        yield rule.finding("cpu-lidar", at=typed, edits=edits, sensor=sensor.name, type=sensor.type)


def _drop_repeated(sensors: list[GazeboSensor]) -> list[GazeboSensor]:
    """Leave out all but the first of the sensors of one place and name: a file is included more than once."""
    return list({(sensor.element.span, sensor.name): sensor for sensor in reversed(sensors)}.values())[::-1]


def _check_duplicate_topics(sensors: list[GazeboSensor], rule: Rule) -> Iterator[Finding]:
    """Report sensors of one type that publish under one name."""
    alike: dict[tuple[str, str], list[Element]] = {}
    for sensor in sensors:
        topic = sensor.element.find_child("topic")
        if topic is not None and topic.text.strip().lstrip("/") not in _NO_TOPIC:
            alike.setdefault((sensor.type, topic.text.strip().lstrip("/")), []).append(topic)
    for (kind, name), elements in alike.items():
        if len(elements) > 1:
            names = join_names(topic_of.parent.get("name") for topic_of in elements if topic_of.parent is not None)
            yield rule.finding("topic", at=elements[1], related=elements[:1], names=names, topic=name, type=kind)


def _check_duplicate_names(
    model: Model, sensors: list[GazeboSensor], reduction: FixedJointReduction, rule: Rule
) -> Iterator[Finding]:
    """Report sensors with one name in one link of SDF, of which the new Gazebo drops all but the first."""
    groups: dict[tuple[str, str], list[GazeboSensor]] = {}
    for sensor in sensors:
        if sensor.name and sensor.reference in reduction.body_by_link:
            groups.setdefault((reduction.body_by_link[sensor.reference], sensor.name), []).append(sensor)
    for (body, name), alike in groups.items():
        if len(alike) > 1:
            links = dict.fromkeys(sensor.reference for sensor in alike)
            first, second = (sensor.element for sensor in alike[:2])
            include = _find_include(second, model) if first.span == second.span else None
            # What the successor cannot load is of a robot for Classic, whatever starts it.
            is_new = is_for_new_gazebo(model) or names_successor(model)
            is_classic = is_only_for_classic(model)
            is_mixed = any(_has_plugin(sensor, _READS_TOPIC) for sensor in alike)
            dropped = "the second is dropped" if len(alike) == 2 else "all but the first are dropped"
            yield rule.finding(
                # Where nothing reads the topic that they share, they work.
                "shared" if is_classic and not is_mixed else "twice",
                severity=Severity.INFO if is_classic and not is_mixed else None,
                consequences={"gazebo": _MIXED if is_mixed else _IN_CLASSIC} if is_classic else None,
                at=second.attributes["name"] if include is None else Location(second.subject, include),
                related=[first.attributes["name"]],
                name=name,
                body=body,
                count=len(alike),
                merged=f" (from {join_names(links)}, which Gazebo merges)" if len(links) > 1 else "",
                included="" if include is None else ", because their file is included more than once",
                rest="they share one topic" if is_classic else dropped if is_new else f"in the new Gazebo {dropped}",
                repair=_describe_renaming(alike, include),
            )


def _has_plugin(sensor: GazeboSensor, library: re.Pattern[str]) -> bool:
    return any(library.search(plugin.get("filename")) for plugin in sensor.element.find_children("plugin"))


def _find_include(element: Element, model: Model) -> Span | None:
    """Return the include that brought an element in itself, not by a macro."""
    place = element.via[-1] if element.via else None
    file = None if place is None else model.source.files.get(place.file)
    is_include = place is not None and file is not None and file.text.startswith("<xacro:include", place.start)
    return place if is_include else None


def _describe_renaming(alike: Sequence[GazeboSensor], include: Span | None) -> str:
    if include is not None:
        return "delete one of the includes"
    first, second = (sensor.element for sensor in alike[:2])
    if len(alike) == 2 and alike[0].reference == alike[1].reference and _is_copy(first, second):
        return "delete one of the two: they are equal"
    if first.span == second.span and second.via:
        return "use a parameter of the macro in the name, so that it differs in each call"
    return "give each sensor its own name"


def _is_copy(one: Element, other: Element) -> bool:
    """Whether two elements say the same."""
    texts = [
        [
            (e.tag, e.text.split(), {name: attribute.value for name, attribute in e.attributes.items()})
            for e in root.walk()
        ]
        for root in (one, other)
    ]
    return texts[0] == texts[1]


def _is_meant_to_be_kept(model: Model, link: str, reduction: FixedJointReduction) -> bool:
    """Whether a block asks to keep a merged link, under a name that is not that of its fixed joint."""
    body = reduction.body_by_link.get(link)
    wrong = [name for name in find_preserved_names(model) if name not in model.joint_by_name]
    while wrong and link != body:
        joint = model.tree.parent_joint[link]
        if any(names_fixed_part(name, joint) for name in wrong):
            return True
        link = joint.parent
    return False


def _describe_collision_repair(unknown: _UnknownCollision, other: str | None, bare: str | None) -> str:
    if bare is not None:
        return f"give {bare} a <collision>: it has none, and Gazebo would give one of it a name such as {unknown.name}"
    if other is not None:
        return f"move the sensor into the block of {other}, and write the SDF name of its collision there"
    if len(unknown.candidates) > 1:
        listed = join_names(unknown.candidates, _MOST_NAMED)
        return f"write the SDF name of each collision of this link that is to be watched, each in its <collision>: {listed}"
    if unknown.candidates:
        return f"write the SDF name of this link's collision: {unknown.candidates[0]}"
    return f"give {unknown.sensor.reference} a collision, or move the sensor to the link that has it"


def _find_bare_link(model: Model, unknown: _UnknownCollision) -> str | None:
    """Find the link without collisions that is in the name of a merged one: ``base_fixed_joint_lump__LINK_collision``."""
    begin, found, rest = unknown.name.partition("_fixed_joint_lump__")
    link = model.link_by_name.get(rest.partition("_collision")[0])
    return link.name if begin == unknown.body and found and link is not None and not link.collisions else None


def _find_other_link(model: Model, unknown: _UnknownCollision) -> str | None:
    """Find the link, not the sensor's own, that the name of a collision mentions: the sensor may be meant for it."""
    if unknown.sensor.reference in unknown.name:
        return None
    mentioned = [name for name in model.link_by_name if name != unknown.sensor.reference and name in unknown.name]
    return max(mentioned, key=len, default=None)


def _iter_unknown_collisions(
    sensors: list[GazeboSensor], reduction: FixedJointReduction
) -> Iterator[_UnknownCollision]:
    names = {(shape.body, shape.name) for shape in reduction.collisions}
    names_by_link: dict[str, tuple[str, ...]] = {}
    for shape in reduction.collisions:
        names_by_link[shape.link] = (*names_by_link.get(shape.link, ()), shape.name)
    for sensor in sensors:
        body = reduction.body_by_link.get(sensor.reference)
        contact = sensor.element.find_child("contact")
        if body is None or contact is None or sensor.type != "contact":
            continue
        for element in contact.find_children("collision"):
            name = element.text.strip().rpartition("::")[2]  # without the names of models and links before it
            if name and (body, name) not in names:
                yield _UnknownCollision(
                    sensor=sensor,
                    element=element,
                    name=name,
                    body=body,
                    candidates=names_by_link.get(sensor.reference, ()),
                )
