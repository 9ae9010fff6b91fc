"""The wheels that a differential drive names, measured on the model."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from urdfcheck.facts.arrays import Array

from collections.abc import Iterator
from typing import TYPE_CHECKING

from urdfcheck.facts.likeness.revolution import measure_outline
from urdfcheck.model.robot import Model
from urdfcheck.model.shapes.corners import collect_shape_corners
from urdfcheck.source.ros.controllers import Controller
from urdfcheck.source.text.yaml.values import YamlValue


def list_drive_wheels(controller: Controller) -> tuple[list[YamlValue], list[YamlValue]]:
    """Return the wheel joints that a differential drive names on its left and on its right."""
    kinds = ("left_wheel", "left_wheel_names"), ("right_wheel", "right_wheel_names")
    left, right = ([j for name in kind if (j := controller.parameters.get(name)) is not None] for kind in kinds)
    return [j for value in left for j in value.items or (value,)], [
        j for value in right for j in value.items or (value,)
    ]


def measure_wheel_radii(model: Model, joint: str) -> list[float]:
    """Measure the radii (m) of a joint's child about the joint's axis.

    Of what it collides as and of what it draws, where these are round and known.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    axis = model.axes.get(joint)
    if axis is None:
        return []
    link = model.link_by_name[model.joint_by_name[joint].child]
    return [
        float(outline.radius)
        for placed in _place_link_points(model, link.name)
        if (outline := measure_outline(placed, axis, _locate_joint(model, joint))).is_round()
    ]


def measure_wheel_separations(model: Model, left: str, right: str) -> list[float]:
    """Measure the distances (m) along their common axis between two wheels.

    The distance of the joints comes first, then those of the middles of what is known of the wheels; none where the axes
    are not parallel.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    axes = model.axes
    if left not in axes or right not in axes or abs(float(axes[left] @ axes[right])) < 0.99:
        return []
    axis = axes[left]
    separations = [abs(float((_locate_joint(model, left) - _locate_joint(model, right)) @ axis))]
    one, other = _compute_wheel_middles(model, left, axis), _compute_wheel_middles(model, right, axis)
    return [*separations, *(abs(a - b) for a, b in zip(one, other, strict=False))]


def _compute_wheel_middles(model: Model, joint: str, axis: Array) -> list[float]:
    placed = _place_link_points(model, model.joint_by_name[joint].child)
    return [float(along.min() + along.max()) / 2 for points in placed for along in (points @ axis,)]


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
