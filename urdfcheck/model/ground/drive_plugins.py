"""The drive plugins of Gazebo in a model: their wheels, sizes, and the friction that the model gives wheels."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

from urdfcheck.core.records import dataclass
from urdfcheck.source.text.values import parse_number

if TYPE_CHECKING:
    from urdfcheck.model.robot import Model
    from urdfcheck.source.text.xml import Element

_PLUGIN = re.compile(r"diff[-_]?drive|skid[-_]?steer", re.IGNORECASE)
# The elements of gz-sim, of gazebo_ros of ROS 2 and of gazebo_ros of ROS 1.
_LEFT = ("left_joint", "leftJoint", "leftFrontJoint", "leftRearJoint")
_RIGHT = ("right_joint", "rightJoint", "rightFrontJoint", "rightRearJoint")
_SEPARATION = ("wheel_separation", "wheelSeparation")
# What each is divided by to be a radius.
_RADIUS = {"wheel_radius": 1.0, "wheelRadius": 1.0, "wheel_diameter": 2.0, "wheelDiameter": 2.0}
_NEW_PLUGIN = re.compile(r"^(?:lib)?(?:gz|ignition)-", re.IGNORECASE)
_ODOMETRY_SOURCES = ("odometrySource", "odometry_source")
_TORQUE = ("max_wheel_torque", "torque", "wheelTorque")
_KEYS = ("mu1", "mu2")


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class DrivePlugin:
    """A plugin that drives the wheels of two sides."""

    element: Element
    left: tuple[Element, ...]
    """Elements with the name of a joint each."""
    right: tuple[Element, ...]
    radii: tuple[tuple[Element, float], ...]
    """The one radius or diameter, with its part of a radius; nothing where it has one for each of several pairs."""
    separations: tuple[Element, ...]

    @property
    def integrates_wheels(self) -> bool:
        """Whether its odometry is computed from the wheels' angles: Classic's plugins publish the true pose unless told to."""
        if _NEW_PLUGIN.search(self.element.get("filename")):
            return True
        sources = [e for tag in _ODOMETRY_SOURCES for e in self.element.find_children(tag)]
        return any(source.text.strip().lower() in {"encoder", "0", "false"} for source in sources)

    @property
    def torque(self) -> float | None:
        """The most that it turns a wheel with, in N·m; None if it is not typed as one number."""
        typed = [element for tag in _TORQUE for element in self.element.find_children(tag)]
        return parse_number(typed[0].text.strip()) if len(typed) == 1 else None

    @property
    def swaps_sides(self) -> bool:
        """Whether gazebo_ros of ROS 1 takes left for right to turn: in its legacy mode, which is the default."""
        if not any(side.tag.endswith("Joint") for side in self.left):
            return False
        legacy = self.element.find_child("legacyMode")
        return legacy is None or legacy.text.strip() not in {"false", "0"}


def list_drive_plugins(model: Model) -> Iterator[DrivePlugin]:
    """Yield the plugins of differential drives and skid steers."""
    for block in model.robot.find_children("gazebo"):
        for plugin in block.find_children("plugin"):
            if _PLUGIN.search(plugin.get("filename")):
                radii = [(e, divisor) for tag, divisor in _RADIUS.items() for e in plugin.find_children(tag)]
                yield DrivePlugin(
                    element=plugin,
                    left=_list_named(plugin, _LEFT),
                    right=_list_named(plugin, _RIGHT),
                    radii=tuple(radii) if len(radii) == 1 else (),
                    separations=tuple(e for tag in _SEPARATION for e in plugin.find_children(tag)),
                )


def _list_named(plugin: Element, tags: tuple[str, ...]) -> tuple[Element, ...]:
    return tuple(element for tag in tags for element in plugin.find_children(tag) if element.text.strip())


def read_friction(block: Element) -> tuple[float, float] | None:
    """Read mu1 and mu2 of a ``<gazebo>``; None where one is absent, so that the default of 1 counts, or is not a number."""
    values = []
    for key in _KEYS:
        element = block.find_child(key)
        value = None if element is None else parse_number(element.get("value") or element.text.strip())
        if value is None:
            return None
        values.append(value)
    return values[0], values[1]
