"""What the range sensors of Gazebo see of their own robot at rest."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from urdfcheck.core.records import dataclass
from urdfcheck.model.gazebo import PLUGIN_FRAME_TAGS, GazeboSensor, list_sensors
from urdfcheck.model.parts import Joint, Shape
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.mesh_sizes import is_usable_shape
from urdfcheck.model.shapes.solids import compute_drawn_scale
from urdfcheck.model.tree import Tree
from urdfcheck.model.wheel_names import WHEEL_NAME
from urdfcheck.source.text.values import parse_number, parse_numbers
from urdfcheck.source.text.xml import Element

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

# Rays in a turn, and layers of a scan, that are followed at most.
_MOST_AZIMUTHS, _MOST_LAYERS = 720, 16
# Rays in the plane of a face end at it or pass it by the last digit of a number. What they meet only there, and not this far (m)
# above and below too, is not certain.
_BESIDE = 1e-4
# An angle (rad) beyond those of a mount that is aligned: chosen.
_TURNED = 0.1
# The upward part of the mean direction of rays that go to the ground: 45° or more below the horizon (chosen).
_DOWN = -0.7
# Types of sensors whose rays are rendered, so that they see visuals, and the one whose rays are collided with shapes.
RENDERED, COLLIDED = frozenset({"gpu_ray", "gpu_lidar", "lidar"}), "ray"


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class SeenShape:
    """A shape at which rays of a sensor end."""

    shape: Shape
    link: str
    holds_sensor: bool
    """Whether the sensor is inside it, so that rays end at its far side."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ScanTurn:
    """The turn between a sensor's rays and the link in whose frame its messages say that they are."""

    frame: str
    angle: float
    """rad"""
    straight_share: float
    """Which part of the rays would end at the robot without the turn."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class SelfScan:
    """What a sensor sees of its robot."""

    sensor: GazeboSensor
    least: float
    """The shortest range that it reports (m)."""
    azimuths: Array
    """The directions of the rays that were followed (A,), in rad."""
    distances: Array
    """Where each ray meets a shape (E, A), in m, inf for none."""
    seen: tuple[SeenShape, ...]
    """The shapes that rays meet first."""
    turned: ScanTurn | None = None
    """How the sensor's own pose turns the rays against the frame of its messages, if it does."""
    looks_down: bool = False
    """Whether its rays go to the ground, on average: it is to see a cliff."""

    @property
    def layers(self) -> int:
        return len(self.distances)

    @property
    def share(self) -> float:
        """Which part of the rays ends at the robot."""
        return float(np.isfinite(self.distances).mean())

    @property
    def nearest(self) -> float:
        return float(self.distances.min())

    @property
    def farthest(self) -> float:
        """The distance (m) of the farthest place that a ray meets; only for a scan that meets one."""
        return float(self.distances[np.isfinite(self.distances)].max())

    def describe_sectors(self) -> list[str]:
        """Name the sectors in which rays end at the robot, in whole degrees: one ray between two does not part them."""
        blocked = np.isfinite(self.distances).any(axis=0)
        edges = np.flatnonzero(np.diff(np.concatenate(([False], blocked, [False])).astype(int)))
        degrees = np.degrees(self.azimuths).round().astype(int).tolist()
        sectors: list[tuple[int, int]] = []
        for first, last in ((degrees[a], degrees[b - 1]) for a, b in edges.reshape(-1, 2).tolist()):
            sectors = (
                [*sectors[:-1], (sectors[-1][0], last)]
                if sectors and sectors[-1][1] >= first
                else [*sectors, (first, last)]
            )
        return [f"{first}° to {last}°" for first, last in sectors]


def scan_robot(model: Model) -> Iterator[SelfScan]:
    """Yield what each range sensor sees of the links that do not move against it, of wheels, and of what carries these.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    for sensor in list_sensors(model):
        if sensor.reference in model.link_by_name and (sensor.type in RENDERED or sensor.type == COLLIDED):
            scan = _scan_with(model, sensor)
            if scan is not None:
                yield scan


def _scan_with(model: Model, sensor: GazeboSensor) -> SelfScan | None:
    from urdfcheck.facts.motion.kinematics import build_origin_transform

    rays = sensor.element.find_child("ray") or sensor.element.find_child("lidar")
    pose = sensor.element.find_child("pose")
    offset = [0.0] * 6 if pose is None else parse_numbers(pose.text, 6)
    scan, limits = (None, None) if rays is None else (rays.find_child("scan"), rays.find_child("range"))
    if scan is None or limits is None or offset is None or (pose is not None and pose.attributes):
        return None
    least, most = _read_number(limits, "min"), _read_number(limits, "max")
    azimuths = _read_angles(scan.find_child("horizontal"), _MOST_AZIMUTHS)
    elevations = _read_angles(scan.find_child("vertical"), _MOST_LAYERS)
    if least is None or most is None or azimuths is None or elevations is None or sensor.reference not in model.frames:
        return None
    place = model.frames[sensor.reference] @ build_origin_transform(offset[:3], offset[3:])
    seen = replace(
        _scan_beside(model, sensor, place, azimuths=azimuths, elevations=elevations, limits=(least, most)),
        looks_down=_look_down(place, azimuths, elevations),
    )
    frame = _find_frame_link(model, sensor)
    if frame is None or not seen.seen or not any(offset[3:]):
        return seen
    straight = place.copy()
    straight[:3, :3] = model.frames[frame][:3, :3]
    angle = math.acos(max(-1.0, min(1.0, (float(np.trace(place[:3, :3].T @ straight[:3, :3])) - 1.0) / 2.0)))
    if angle < _TURNED:
        return seen
    other = _scan_beside(model, sensor, straight, azimuths=azimuths, elevations=elevations, limits=(least, most))
    return replace(seen, turned=ScanTurn(frame=frame, angle=angle, straight_share=other.share))


def _look_down(place: Array, azimuths: Array, elevations: Array) -> bool:
    """Whether rays go to the ground on average. ``place``: the pose (4, 4) of their sensor in root coordinates."""
    from urdfcheck.facts.motion.ray_casting import make_scan_directions

    mean = make_scan_directions(azimuths, elevations).reshape(-1, 3).mean(axis=0)
    return float(place[2, :3] @ mean) < _DOWN


def _find_frame_link(model: Model, sensor: GazeboSensor) -> str | None:
    """Find the link that a sensor or its plugin names as the frame of its messages."""
    names = [element.text.strip().lstrip("/") for element in sensor.element.walk() if element.tag in PLUGIN_FRAME_TAGS]
    return names[0] if len(set(names)) == 1 and names[0] in model.frames else None


def _scan_beside(
    model: Model,
    sensor: GazeboSensor,
    place: Array,
    *,
    azimuths: Array,
    elevations: Array,
    limits: tuple[float, float],
) -> SelfScan:
    """Follow the rays of a sensor as typed, and a little above and below; the scan that sees least counts."""
    from urdfcheck.facts.motion.kinematics import build_origin_transform

    scans = []
    for height in (0.0, _BESIDE, -_BESIDE):
        raised = place @ build_origin_transform([0.0, 0.0, height], [0.0] * 3)
        found = _scan_from(model, sensor, raised, azimuths=azimuths, elevations=elevations, limits=limits)
        scans.append(found)
        if not found.seen:
            break
    return min(scans, key=lambda scan: scan.share)


def _scan_from(
    model: Model,
    sensor: GazeboSensor,
    place: Array,
    *,
    azimuths: Array,
    elevations: Array,
    limits: tuple[float, float],
) -> SelfScan:
    """Follow the rays of a sensor. ``place``: its pose (4, 4) in root coordinates; ``limits``: of the range, m."""
    role = "visual" if sensor.type in RENDERED else "collision"
    least, most = limits
    distances = np.full((len(elevations), len(azimuths)), np.inf)
    first = np.full(distances.shape, -1)
    shapes = list(_iter_shapes(model, sensor.reference, role))
    to_sensor, holding = np.linalg.inv(place), set()
    for index, (shape, link) in enumerate(shapes):
        frame = to_sensor @ model.frames[link]
        if shape.kind == "mesh":
            entries = _measure_mesh_entries(model, shape, frame, azimuths, elevations, least)
        else:
            low, high = _cross_primitive(shape, frame, azimuths, elevations)
            entries = np.where(low < high, low, np.inf)
            if role == "collision":
                # ODE lets a ray that begins inside a primitive end at its far side.
                entries = np.where((low < least) & (least < high), high, entries)
                if (low < 0.0).all() and (high > 0.0).all():
                    holding.add(index)
        entries[(entries < least) | (entries > most) | (entries <= 0.0)] = np.inf
        nearer = entries < distances
        distances[nearer], first[nearer] = entries[nearer], index
    seen = tuple(
        SeenShape(shape=shapes[i][0], link=shapes[i][1], holds_sensor=i in holding)
        for i in np.unique(first[first >= 0]).tolist()
    )
    return SelfScan(sensor=sensor, least=least, azimuths=azimuths, distances=distances, seen=seen)


def _iter_shapes(model: Model, link: str, role: str) -> Iterator[tuple[Shape, str]]:
    """Yield the usable shapes that stay where they are, seen from a link: those of its body, of wheels, and of their carriers."""
    tree = model.tree
    body = tree.list_body_links(link)
    carriers = {
        before.name
        for joint in model.joints
        if joint.type == "continuous" and WHEEL_NAME.search(f"{joint.name} {joint.child}")
        for before in tree.find_path_to(joint.parent)
    }
    mounts = [joint for name in body for joint in tree.child_joints.get(name, ()) if joint.is_movable]
    hanging = [inner for joint in mounts for inner in _list_seen_links(tree, joint, carries=joint.name in carriers)]
    for name in (*body, *hanging):
        owner = model.link_by_name[name]
        for shape in owner.visuals if role == "visual" else owner.collisions:
            if is_usable_shape(model, shape):
                yield shape, name


def _list_seen_links(tree: Tree, joint: Joint, *, carries: bool) -> list[str]:
    """List the links behind a joint that are where they are when the robot drives.

    All behind a rocker, a bogie or a steering knuckle, which ``carries`` wheels; else only what turns about a continuous joint.
    """
    if not carries:
        return list(tree.list_body_links(joint.child)) if joint.type == "continuous" else []
    found = [joint.child]
    for name in found:
        found += [below.child for below in tree.child_joints.get(name, ())]
    return found


def _measure_mesh_entries(
    model: Model, shape: Shape, frame: Array, azimuths: Array, elevations: Array, least: float
) -> Array:
    from urdfcheck.facts.motion.ray_casting import measure_mesh_entries

    placed = _place_shape(shape, frame)
    facts, scale = model.meshes.get_facts(shape), compute_drawn_scale(model, shape)
    assert facts is not None
    assert scale is not None
    vertices = facts.vertices * np.array(scale) @ placed[:3, :3].T + placed[:3, 3]
    faces = facts.faces if math.prod(scale) > 0 else facts.faces[:, ::-1]
    return measure_mesh_entries(vertices, faces, azimuths, elevations, least)


def _cross_primitive(shape: Shape, frame: Array, azimuths: Array, elevations: Array) -> tuple[Array, Array]:
    """Return where rays enter and leave a shape (E, A), in m."""
    from urdfcheck.facts.motion.ray_casting import cross_primitive, make_scan_directions

    assert shape.size is not None  # see is_usable_shape
    placed = _place_shape(shape, frame)
    turn, origin = placed[:3, :3], placed[:3, 3]
    directions = make_scan_directions(azimuths, elevations)
    low, high = cross_primitive(shape.kind or "", shape.size, -turn.T @ origin, directions.reshape(-1, 3) @ turn)
    return low.reshape(directions.shape[:2]), high.reshape(directions.shape[:2])


def _place_shape(shape: Shape, frame: Array) -> Array:
    assert shape.origin.matrix is not None  # see is_usable_shape
    placed: Array = frame @ shape.origin.matrix
    return placed


def _read_angles(element: Element | None, most: int) -> Array | None:
    """Read the angles (rad) of a ``<horizontal>`` or ``<vertical>``, at most so many; 0 alone without the element.

    Rising: a scan from a greater angle to a smaller one has the same rays.
    """
    if element is None:
        return np.zeros(1)
    samples, low, high = (_read_number(element, name) for name in ("samples", "min_angle", "max_angle"))
    if samples is None or low is None or high is None or samples < 1 or not abs(low) + abs(high) < 20:
        return None
    return np.array([low]) if low == high else np.linspace(min(low, high), max(low, high), int(min(samples, most)))


def _read_number(element: Element, tag: str) -> float | None:
    child = element.find_child(tag)
    return None if child is None else parse_number(child.text.strip())
