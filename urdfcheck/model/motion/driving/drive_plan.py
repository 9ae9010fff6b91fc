"""The differential drive of a robot: which wheels it has on either side, and what computes with which sizes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from urdfcheck.core import Located
from urdfcheck.core.records import dataclass
from urdfcheck.model.ground.drive_plugins import DrivePlugin, list_drive_plugins
from urdfcheck.model.ground.drive_wheels import list_drive_wheels
from urdfcheck.model.ground.wheel_pair import find_lone_wheel_pair
from urdfcheck.model.likeness.sibling_robots import PackageNames
from urdfcheck.model.motion.controllers import find_controller_configs
from urdfcheck.model.robot import Model
from urdfcheck.source.text.values import parse_number

if TYPE_CHECKING:
    from urdfcheck.source.ros.controllers import Controller

_LEFT_NAME, _RIGHT_NAME = ("left", "Left", "LEFT"), ("right", "Right", "RIGHT")


@dataclass(frozen=True, slots=True, kw_only=True)
class TypedSize:
    """A size that a controller or a plugin computes with."""

    key: str
    value: float
    """As typed, in m."""
    size: float
    """The radius or separation that it means (m)."""
    at: Located


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class DrivePlan:
    """Which joints drive the robot, and how they are commanded."""

    source: str
    """What says so, to be written in a sentence."""
    left: tuple[str, ...]
    right: tuple[str, ...]
    signs: tuple[float, float] = (1.0, 1.0)
    """The sign of the velocity that drives the left and the right wheels ahead: a negative radius multiplier reverses a side."""
    frame: str
    """The link whose x axis is ahead."""
    radius: TypedSize | None = None
    separation: TypedSize | None = None
    knows_ahead: bool = False
    """Whether the direction of +x is ahead by what commands the wheels, and not only by convention."""
    knows_sides: bool = False
    """Whether what commands the wheels turns the robot to the left by the wheels on the right."""


def find_drive_plan(model: Model) -> DrivePlan | None:
    """Find the differential drive: of a controller, of a plugin of Gazebo, or of a lone pair of wheels.

    :raises FactUnavailableError: when the tree is broken or an origin is malformed.
    """
    plans = (*_iter_controller_plans(model), *_iter_plugin_plans(model))
    if plans:
        return plans[0]
    pair = find_lone_wheel_pair(model)
    if pair is None:
        return None
    left, right = pair.left.joint.name, pair.right.joint.name
    if not pair.is_named:
        # Nothing says which sign drives a wheel ahead, as outward axes are usual, too: both roll the same way.
        signs = tuple(math.copysign(1.0, float(wheel.axis @ pair.lateral)) for wheel in (pair.left, pair.right))
        return DrivePlan(
            source="the symmetry of two wheels",
            left=(left,),
            right=(right,),
            signs=(signs[0], signs[1]),
            frame=model.tree.root,
        )
    if any(word in left for word in _RIGHT_NAME) or any(word in right for word in _LEFT_NAME):
        left, right = right, left
    return DrivePlan(source="the wheels' names", left=(left,), right=(right,), frame=model.tree.root)


def _iter_controller_plans(model: Model) -> Iterator[DrivePlan]:
    configs = find_controller_configs(model)
    elsewhere = PackageNames(model) if configs else None
    for config in configs:
        for controller in config.configuration.controllers:
            if not controller.type.startswith("diff_drive_controller/"):
                continue
            left, right = ([name.text for name in side] for side in list_drive_wheels(controller))
            names = (*left, *right)
            others = elsewhere if config.named_at is None else None
            if not _are_wheels(model, left, right) or (
                others is not None and any(others.can_others_have("joint", name) for name in names)
            ):
                continue
            factors = [
                1.0 if value is None else value.number or 1.0
                for key in ("left_wheel_radius_multiplier", "right_wheel_radius_multiplier")
                for value in (controller.parameters.get(key),)
            ]
            calibrated = any(abs(factor) != 1.0 for factor in factors)
            yield DrivePlan(
                source=f"controller {controller.name!r}",
                left=tuple(left),
                right=tuple(right),
                signs=(1.0 if factors[0] > 0 else -1.0, 1.0 if factors[1] > 0 else -1.0),
                frame=_choose_frame(model, _read_text(controller, "base_frame_id")),
                radius=None if calibrated else _read_size(controller, "wheel_radius"),
                separation=None
                if calibrated or controller.parameters.get("wheel_separation_multiplier") is not None
                else _read_size(controller, "wheel_separation"),
                knows_ahead=True,
                knows_sides=True,
            )


def _iter_plugin_plans(model: Model) -> Iterator[DrivePlan]:
    for plugin in list_drive_plugins(model):
        left, right = ([e.text.strip() for e in side] for side in (plugin.left, plugin.right))
        if _are_wheels(model, left, right):
            frames = [
                e.text.strip()
                for tag in ("robot_base_frame", "robotBaseFrame")
                for e in plugin.element.find_children(tag)
            ]
            yield DrivePlan(
                source=f"plugin {plugin.element.get('filename')!r}",
                left=tuple(left),
                right=tuple(right),
                frame=_choose_frame(model, frames[0] if frames else ""),
                radius=_read_plugin_radius(plugin),
                separation=_read_plugin_separation(plugin),
                knows_ahead=True,
                knows_sides=not plugin.swaps_sides,
            )


def _are_wheels(model: Model, left: Sequence[str], right: Sequence[str]) -> bool:
    joints = [model.joint_by_name.get(name) for name in (*left, *right)]
    return (
        bool(left and right)
        and len(set(joints)) == len(joints)
        and all(
            joint is not None and joint.type in {"continuous", "revolute"} and joint.name in model.axes
            for joint in joints
        )
    )


def _choose_frame(model: Model, name: str) -> str:
    """Return the link of this name if it is rigid with the root, or else the root."""
    root = model.tree.root
    return name if name in model.tree.list_body_links(root) else root


def _read_text(controller: Controller, key: str) -> str:
    value = controller.parameters.get(key)
    return "" if value is None else value.text


def _read_size(controller: Controller, key: str) -> TypedSize | None:
    value = controller.parameters.get(key)
    number = None if value is None else value.number
    if value is None or number is None or number <= 0:
        return None
    return TypedSize(key=key, value=number, size=number, at=value)


def _read_plugin_radius(plugin: DrivePlugin) -> TypedSize | None:
    for element, divisor in plugin.radii:
        number = parse_number(element.text.strip())
        if number is not None and number > 0:
            return TypedSize(key=element.tag, value=number, size=number / divisor, at=element)
    return None


def _read_plugin_separation(plugin: DrivePlugin) -> TypedSize | None:
    if len(plugin.separations) != 1:
        return None
    (element,) = plugin.separations
    number = parse_number(element.text.strip())
    if number is None or number <= 0:
        return None
    return TypedSize(key=element.tag, value=number, size=number, at=element)
