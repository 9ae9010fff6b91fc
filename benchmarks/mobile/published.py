"""Published robots of the folders that ``URDFCHECK_CORPUS`` names, expanded."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree as ET

from made import MobileRobot
from real.robots import RealRobot, list_robots

from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder

# Id of the robot: the joints of two driven wheels, the casters and the link of the chassis.
_PLACES: dict[str, tuple[str, str, tuple[str, ...], str]] = {
    "husky/husky:husky": ("front_left_wheel", "front_right_wheel", (), "base_link"),
    "dingo-cpr/dingo:dingo-d": ("left_wheel", "right_wheel", ("rear_caster",), "chassis_link"),
    "ROBOTIS-GIT/turtlebot3:turtlebot3_burger": (
        "wheel_left_joint",
        "wheel_right_joint",
        ("caster_back_link",),
        "base_link",
    ),
    "joshnewans/articubot_one:robot": ("left_wheel_joint", "right_wheel_joint", ("caster_wheel",), "chassis"),
    "ridgeback/ridgeback:ridgeback": ("rear_left_wheel", "rear_right_wheel", (), "chassis_link"),
    "Daniella1/urdf_files_dataset:pioneer3at": (
        "p3at_front_left_wheel_joint",
        "p3at_front_right_wheel_joint",
        (),
        "base_link",
    ),
    "ros/urdf_tutorial:07-physics": ("left_front_wheel_joint", "right_front_wheel_joint", (), "base_link"),
    "linorobot/linorobot2:mecanum": ("front_left_wheel_joint", "front_right_wheel_joint", (), "base_link"),
    "Ekumen-OS/andino:andino": ("left_wheel_joint", "right_wheel_joint", ("caster_wheel_link",), "base_link"),
    "Ausaurus/ranger_1s_urdf:2wv3": (
        "left_wheel_joint",
        "right_wheel_joint",
        ("ball_link_fl", "ball_link_fr", "ball_link_bl", "ball_link_br"),
        "base_link",
    ),
}


def list_published() -> Iterator[tuple[RealRobot, MobileRobot]]:
    """Yield the robots that are there, each with its expanded text."""
    for robot in list_robots():
        places = _PLACES.get(robot.name)
        if places is None:
            continue
        left, right, casters, base = places
        yield (
            robot,
            MobileRobot(name=robot.name, root=_expand(robot), left=left, right=right, casters=casters, base=base),
        )


def _expand(robot: RealRobot) -> ET.Element:
    finder = PackageFinder(robot.entry.resolve(), {}, [Path(root).resolve() for root in robot.package_roots])
    source = load_source(robot.entry.resolve(), dict(robot.arguments), finder)
    text = robot.entry.read_text(encoding="utf-8") if source.document is None else source.document.toxml()
    return ET.fromstring(text)
