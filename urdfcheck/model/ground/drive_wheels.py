"""The wheels that a differential drive names, measured on the model."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from urdfcheck.core.records import dataclass
from urdfcheck.facts.likeness.revolution import measure_outline
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.corners import collect_shape_corners
from urdfcheck.model.shapes.mesh_sizes import is_usable_shape
from urdfcheck.source.ros.controllers import Controller
from urdfcheck.source.text.yaml.values import YamlValue

_MECANUM = tuple(f"{end}_{side}_wheel_command_joint_name" for end in ("front", "rear") for side in ("left", "right"))
_TRICYCLE = ("traction_joint_name",)
# Wheels are on two sides if they are so far apart (m); an axis is across the line between them within this cosine.
_APART, _ACROSS = 0.01, 0.1
# What is farther from the axis than this share of the reach of a wheel is its tread: sidewalls need not be alike on both sides.
_TREAD = 0.98


def list_drive_wheels(controller: Controller) -> tuple[list[YamlValue], list[YamlValue]]:
    """Return the wheel joints that a differential drive names on its left and on its right."""
    kinds = ("left_wheel", "left_wheel_names"), ("right_wheel", "right_wheel_names")
    left, right = ([j for name in kind if (j := controller.parameters.get(name)) is not None] for kind in kinds)
    return [j for value in left for j in value.items or (value,)], [
        j for value in right for j in value.items or (value,)
    ]


@dataclass(frozen=True, slots=True, eq=False)
class DriveSizes:
    """The sizes that a controller of a mecanum drive or a tricycle types, with those of the model."""

    joints: tuple[str, ...]
    sizes: tuple[tuple[str, YamlValue, list[float]], ...]
    """Keys, each with the typed value and what it may be in the model (m)."""


def measure_drive_sizes(model: Model, controller: Controller) -> DriveSizes | None:
    """Measure the sizes of a mecanum drive or a tricycle; None where a joint is not the model's.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    names = _MECANUM if "Mecanum" in controller.type else _TRICYCLE
    values = [controller.parameters.get(name) for name in names]
    joints = tuple(value.text for value in values if value is not None)
    if len(joints) < len(names) or not all(joint in model.joint_by_name for joint in joints):
        return None
    measured: dict[str, list[float]] = {}
    if names is _MECANUM:
        front_left, front_right, rear_left, _ = joints
        measured["kinematics.wheels_radius"] = measure_wheel_radii(model, front_left)
        across = measure_wheel_separations(model, front_left, front_right)
        along = abs(float(_measure_offset(model, front_left, rear_left)))
        # Half of the distance of the axles and half of the track.
        measured["kinematics.sum_of_robot_center_projection_on_X_Y_axis"] = [(size + along) / 2 for size in across]
    else:
        measured["wheel_radius"] = measure_wheel_radii(model, joints[0])
    typed = ((key, _find_dotted(controller.parameters, key), sizes) for key, sizes in measured.items())
    return DriveSizes(joints, tuple((key, value, sizes) for key, value, sizes in typed if value is not None))


def _find_dotted(parameters: YamlValue, key: str) -> YamlValue | None:
    """Find ``a.b`` typed as one key, or as ``b`` in the mapping ``a``."""
    first, _, rest = key.partition(".")
    group = parameters.get(first) if rest else None
    return parameters.get(key) or (group.get(rest) if group is not None and group.is_mapping else None)


def _measure_offset(model: Model, one: str, other: str) -> float:
    """Measure how far (m) two wheels are apart across their axis."""
    import numpy as np

    apart = _locate_joint(model, one) - _locate_joint(model, other)
    return float(np.linalg.norm(apart - (apart @ model.axes[one]) * model.axes[one]))


def measure_wheel_radii(model: Model, joint: str) -> list[float]:
    """Measure the radii (m) about a joint's axis of its child and of what is fixed to that: a tyre may be a separate link.

    The largest link first: of what it collides as, then of what it draws, where these are round and known, the usual reach, then
    the farthest.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    axis = model.axes.get(joint)
    if axis is None:
        return []
    center = _locate_joint(model, joint)
    radii = [
        [
            radius
            for placed in _place_link_points(model, link)
            if (outline := measure_outline(placed, axis, center)).is_round()
            for radius in (outline.usual_radius, outline.radius)
        ]
        for link in model.pieces.list_body_links(model.joint_by_name[joint].child)
    ]
    return [radius for some in sorted(radii, key=lambda some: -max(some, default=0.0)) for radius in some]


def measure_wheel_separations(model: Model, left: str, right: str) -> list[float]:
    """Measure the distances (m) along their common axis between two wheels.

    Those of the middles of the treads that they collide as and draw, where these are known, come first, then that of the joints:
    a joint may be at the inner face of its wheel. None where the axes are not parallel or a mesh could not be read.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    axes = model.axes
    if left not in axes or right not in axes or abs(float(axes[left] @ axes[right])) < 0.99:
        return []
    if any(_has_unread_mesh(model, model.joint_by_name[name].child) for name in (left, right)):
        return []
    axis = axes[left]
    joints = abs(float((_locate_joint(model, left) - _locate_joint(model, right)) @ axis))
    one, other = _compute_wheel_middles(model, left, axis), _compute_wheel_middles(model, right, axis)
    return [*(abs(a - b) for a, b in zip(one, other, strict=False)), joints]


def find_other_size(value: float, sizes: Sequence[float], *, rel_tol: float) -> float | None:
    """Return the first of the ``sizes`` (m) that the model shows if a typed ``value`` is none of them; None if it is one."""
    if value <= 0 or not sizes or min(sizes) <= 0 or any(abs(value - size) <= rel_tol * size for size in sizes):
        return None
    return sizes[0]


def are_wheels_sideways(model: Model, left: Sequence[str], right: Sequence[str]) -> bool:
    """Whether all wheels turn about axes across the line from the left ones to the right ones: they cannot turn the robot.

    The line is that between the joints, and that between what the wheels collide as or draw: both must show it.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    import numpy as np

    if not {*left, *right} <= model.axes.keys():
        return False
    axes = np.array([model.axes[name] for name in (*left, *right)])
    places = [[[_locate_joint(model, name), *_locate_middles(model, name)] for name in side] for side in (left, right)]
    lines = [
        np.mean([place[k] for place in places[0]], axis=0) - np.mean([place[k] for place in places[1]], axis=0)
        for k in range(min(len(place) for side in places for place in side))
    ]
    return all(
        np.linalg.norm(line) > _APART and np.abs(axes @ line).max() < _ACROSS * np.linalg.norm(line) for line in lines
    )


def turn_with_axes(model: Model, joints: Sequence[str]) -> bool:
    """Whether what one of these wheels collides as or draws is round about its joint's axis: not about another axis.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    return any(
        measure_outline(points, model.axes[name], _locate_joint(model, name)).is_round()
        for name in joints
        for points in _place_link_points(model, model.joint_by_name[name].child)
    )


def _locate_middles(model: Model, joint: str) -> list[Array]:
    """Return the middles (3,) of what a wheel collides as and of what it draws, in root coordinates."""
    placed = _place_link_points(model, model.joint_by_name[joint].child)
    return [(points.min(axis=0) + points.max(axis=0)) / 2 for points in placed]


def _compute_wheel_middles(model: Model, joint: str, axis: Array) -> list[float]:
    """Return where the middles of the treads are along the ``axis`` (m): of what a wheel collides as, and of what it draws.

    A stub of the axle touches no ground and does not move the middle.
    """
    import numpy as np

    placed, centre = _place_link_points(model, model.joint_by_name[joint].child), _locate_joint(model, joint)
    middles = []
    for points in placed:
        along = points @ axis
        offsets = points - centre
        distances = np.linalg.norm(offsets - np.outer(offsets @ axis, axis), axis=1)
        tread = along[distances >= _TREAD * distances.max()]
        middles.append(float(tread.min() + tread.max()) / 2)
    return middles


def _has_unread_mesh(model: Model, name: str) -> bool:
    link = model.link_by_name[name]
    return any(s.kind == "mesh" and not is_usable_shape(model, s) for s in (*link.collisions, *link.visuals))


def _place_link_points(model: Model, name: str) -> Iterator[Array]:
    """Yield points in root coordinates on what a link collides as, and on what it draws."""
    link, frame = model.link_by_name[name], model.frames[name]
    for shapes in (link.collisions, link.visuals):
        points = collect_shape_corners(model, shapes)
        if points is not None and len(points):
            yield points @ frame[:3, :3].T + frame[:3, 3]


def _locate_joint(model: Model, joint: str) -> Array:
    """Return where a joint is (3,), in root coordinates."""
    origin: Array = model.frames[model.joint_by_name[joint].child][:3, 3]
    return origin
