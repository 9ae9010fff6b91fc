"""NAM004 reports frames with a standard name that are not where the standard puts them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace

from urdfcheck.core import Finding, Rule
from urdfcheck.core.text import join_names, join_numbers
from urdfcheck.facts.small_matrices import (
    IDENTITY,
    Matrix,
    Vector,
    list_entries,
    measure_rotation,
    multiply,
    multiply_inner,
    rotate,
    transpose,
)
from urdfcheck.model import Joint, Model
from urdfcheck.model.gazebo import CAMERA_TYPE, FRAME_TAGS, GazeboSensor, list_sensors
from urdfcheck.model.repairs.origin_edits import locate_origin_attribute
from urdfcheck.source.text.values import parse_number
from urdfcheck.source.text.xml import COMMENT

# Frames allowed above base_link: the fixed world, frames that localisation moves, and the footprint (REP 105, REP 120).
_ABOVE_BASE = frozenset({"world", "map", "earth", "odom", "base_footprint"})
# x to the right, y down, z forward, seen from a camera link with x forward and z up (REP 103).
_OPTICAL: Matrix = ((0.0, 0.0, 1.0), (-1.0, 0.0, 0.0), (0.0, -1.0, 0.0))
_FORWARD: Vector = (1.0, 0.0, 0.0)
# The sensors of Gazebo that make clouds of points.
_CLOUD_TYPE = re.compile(r"^(?:depth_camera|rgbd(?:_camera)?)$")
# Frames of inertial sensors in cameras, which drivers give the word too: no picture is in them.
_INERTIAL = re.compile(r"(?:^|_)(?:accel|gyro|imu)(?:_|$)", re.IGNORECASE)
_SENSOR_BLOCK = re.compile(r"""<gazebo\s+reference\s*=\s*["']([^"'<>]+)["']\s*>(.*?)</gazebo\s*>""", re.DOTALL)
_SENSOR = re.compile(r"<sensor\s([^<>]*)>")
_ATTRIBUTE = re.compile(r"""(?<!\w)(\w+)\s*=\s*["']([^"'<>]*)["']""")
# Words that a camera link and its optical frame add to the camera's name.
_FRAME_SUFFIX = re.compile(r"_?(?:optical|frame|link|joint|parent)(?=_|$)")


def check(model: Model, rule: Rule, *, angle_tol: float) -> Iterator[Finding]:
    tree = model.tree
    base = tree.parent_joint.get("base_link")
    above = {joint.parent for joint in tree.find_path_to("base_link")}
    if base is not None and not above <= _ABOVE_BASE and not _is_dummy_root(model, base):
        yield rule.finding("base", at=base, parent=base.parent, root=tree.root)
    footprint = tree.parent_joint.get("base_footprint")
    if footprint is not None and any(joint.parent == "base_link" for joint in tree.find_path_to("base_footprint")):
        yield rule.finding("footprint", at=footprint, parent=footprint.parent)
    tool = tree.parent_joint.get("tool0")
    if tool is not None and tool.parent == "flange":
        yield from _check_tool_frame(model, tool, rule, angle_tol)
    yield from _check_optical_frames(model, rule, angle_tol)


def _is_dummy_root(model: Model, joint: Joint) -> bool:
    """Whether a fixed joint hangs on an empty root: KDL wants one above a link with inertia."""
    root = model.link_by_name[joint.parent].element
    is_empty = not any(root.find_child(tag) for tag in ("inertial", "visual", "collision"))
    return (
        is_empty
        and joint.type == "fixed"
        and joint.parent == model.tree.root
        and not model.tree.child_joints[joint.parent][1:]
    )


def _check_tool_frame(model: Model, joint: Joint, rule: Rule, tol: float) -> Iterator[Finding]:
    """Compare tool0 with the standard: z points away from the robot, along the x axis of the flange.

    The axis of the last moving joint points there too, and shows which of the two frames is wrong.
    """
    placement = joint.origin.placement
    if placement is None or joint.type != "fixed":
        return
    forward = _get_column(placement.rotation, 2)
    off = _measure_angle(forward, _FORWARD)
    if off <= tol:
        return
    last, axis = _find_last_axis(model, joint.parent)
    message = "tool_or_flange"
    if last is not None and _is_parallel(axis, _FORWARD, tol):
        message = "tool"
    elif last is not None and _is_parallel(axis, forward, tol):
        message = "flange"
        off = min(_measure_angle(way, _FORWARD) for way in (axis, _reverse(axis)))
    before = model.tree.parent_joint.get(joint.parent)
    if message == "flange" and before is not None:
        at, related = locate_origin_attribute(before, "rpy"), [locate_origin_attribute(joint, "rpy")]
    else:
        at, related = locate_origin_attribute(joint, "rpy"), []
    yield rule.finding(
        message,
        at=at,
        related=related,
        off=off,
        last="" if last is None else last.name,
        mount="" if before is None else before.name,
        joint=joint.name,
    )


def _find_last_axis(model: Model, link: str) -> tuple[Joint | None, Vector]:
    """Find the last moving joint before a link, and its axis in the link's frame."""
    rotation = IDENTITY
    for joint in reversed(model.tree.find_path_to(link)):
        if joint.is_movable:
            axis = joint.axis or (0.0, 0.0, 0.0)
            length = math.hypot(*axis)
            if not joint.has_axis or not length > 0.0:
                break
            return joint, rotate(transpose(rotation), [part / length for part in axis])
        if joint.origin.placement is None:
            break
        rotation = multiply(joint.origin.placement.rotation, rotation)
    return None, (0.0, 0.0, 0.0)


def _get_column(matrix: Matrix, index: int) -> Vector:
    return transpose(matrix)[index]


def _reverse(vector: Vector) -> Vector:
    x, y, z = vector
    return -x, -y, -z


def _is_parallel(one: Vector, other: Vector, tol: float) -> bool:
    return min(_measure_angle(one, other), _measure_angle(_reverse(one), other)) <= tol


def _measure_angle(one: Vector, other: Vector) -> float:
    """Return the angle (rad) between two unit vectors."""
    return math.acos(max(-1.0, min(1.0, multiply_inner(one, other))))


def _check_optical_frames(model: Model, rule: Rule, tol: float) -> Iterator[Finding]:
    """Report all optical frames with one wrong rotation together: they come from one habit."""
    posed = {s.reference for s in list_sensors(model) if CAMERA_TYPE.search(s.type) and _has_rotated_pose(s)}
    stamped = _collect_cloud_frames(model)
    wrong: dict[tuple[int, ...], tuple[Matrix, list[Joint]]] = {}
    for joint in model.joints:
        placement = joint.origin.placement
        if joint.type != "fixed" or placement is None or not _is_optical_frame(joint.child, joint.parent):
            continue
        if joint.parent in posed or joint.child in posed:
            continue  # the camera looks elsewhere than along the x axis of its link, and so may the frame
        rotation = placement.rotation
        if joint.child in stamped and measure_rotation(rotation) <= tol:
            continue
        if measure_rotation(multiply(rotation, transpose(_OPTICAL))) > tol and not _is_optical_in_root(
            model, joint, tol
        ):
            key = tuple(round(entry * 1e3) for entry in list_entries(rotation))
            wrong.setdefault(key, (rotation, []))[1].append(joint)
    for rotation, joints in wrong.values():
        places = [locate_origin_attribute(joint, "rpy") for joint in joints]
        names = list(dict.fromkeys(joint.child for joint in joints))
        finding = rule.finding(
            "optical-unturned" if measure_rotation(rotation) <= tol else "optical",
            at=places[0],
            related=places[1:],
            names=join_names(names, 3),
            parents=join_names(dict.fromkeys(joint.parent for joint in joints), 3),
            frame="frame" if len(names) == 1 else "frames",
            verb="has" if len(names) == 1 else "have",
            looks="looks" if len(names) == 1 else "look",
            look=_describe_direction(_get_column(rotation, 2)),
            top=_describe_direction(_reverse(_get_column(rotation, 1))),
            first=_describe_sensor_move(model, joints),
            typed=join_numbers(joints[0].origin.rpy or (), separator=" "),
        )
        yield replace(finding, subjects=tuple(place.subject for place in places))


def _collect_cloud_frames(model: Model) -> set[str]:
    """Return the frames with which Gazebo stamps clouds of points: their x is forward, so a turned frame would turn them."""
    cameras = (sensor.element for sensor in list_sensors(model) if _CLOUD_TYPE.search(sensor.type))
    return {child.text.strip() for camera in cameras for child in camera.children if child.tag in FRAME_TAGS}


def _has_rotated_pose(sensor: GazeboSensor) -> bool:
    """Whether a sensor's ``<pose>`` rotates it in its link."""
    pose = sensor.element.find_child("pose")
    angles = [] if pose is None else pose.text.split()[3:6]
    return any(parse_number(angle) != 0 for angle in angles)


def _is_optical_in_root(model: Model, joint: Joint, tol: float) -> bool:
    """Whether a frame looks level with the top of its picture up, because the camera link is rotated against the root."""
    parent, frame = model.placements[joint.parent].rotation, model.placements[joint.child].rotation
    return measure_rotation(parent) > tol and frame[2][1] < -math.cos(tol)


def _describe_sensor_move(model: Model, joints: Sequence[Joint]) -> str:
    """Return what must be done before the frame is rotated: Gazebo looks along the x axis of the link that a camera is on."""
    cameras = {sensor.reference: sensor.name for sensor in list_sensors(model) if CAMERA_TYPE.search(sensor.type)}
    # Blocks that only other arguments bring in are read as typed.
    for file in model.source.files.values() if model.source.is_xacro else ():
        for reference, sensors in _SENSOR_BLOCK.findall(COMMENT.sub("", file.text)):
            for tag in _SENSOR.findall(sensors):
                typed = dict(_ATTRIBUTE.findall(tag))
                if CAMERA_TYPE.search(typed.get("type", "")):
                    cameras.setdefault(reference, typed.get("name", ""))
    for joint in joints:
        if joint.child in cameras:
            return (
                f"attach sensor {cameras[joint.child]} to {joint.parent}, along whose x axis Gazebo looks, "
                f"and keep {joint.child} as the frame of its data; then "
            )
    return ""


def _is_optical_frame(child: str, parent: str) -> bool:
    """Whether the child is, by its name, the optical frame of the camera that the parent is."""
    if "optical" not in child.lower() or "optical" in parent.lower() or _INERTIAL.search(child):
        return False
    return _FRAME_SUFFIX.sub("", child.lower()) == _FRAME_SUFFIX.sub("", parent.lower())


def _describe_direction(vector: Vector) -> str:
    """Return the main direction of a unit vector in a camera link (x forward, y left, z up)."""
    axis = max(range(3), key=lambda i: abs(vector[i]))
    names = (("back", "forward"), ("right", "left"), ("down", "up"))
    return names[axis][vector[axis] > 0]
