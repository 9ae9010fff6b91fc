"""A robot is the same robot in other frames, from another root, in other units and under other names, and so are its defects.

A car with two arms and a tool, whose parts are lumpy convex meshes with the inertials that these have, gets one defect at a
time. Whatever is done to its description, the rule finds that defect and no other, for the same cause.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from cart import NAMES, make_cart
from conftest import check
from transforms import (
    Robot,
    Transformation,
    each_link,
    renamed,
    reordered,
    rerooted,
    rotated_inertial,
    rotated_link,
    scaled,
    with_properties,
    written_longer,
)

from urdfcheck.facts.motion.kinematics import rpy_to_matrix
from urdfcheck.rules import load_rules

pytestmark = pytest.mark.slow

ASKEW = rpy_to_matrix((0.4, -0.7, 1.1))
QUARTER = rpy_to_matrix((0.0, 0.0, np.pi / 2))

TRANSFORMATIONS: dict[str, Transformation] = {
    "as it is": lambda robot: robot,
    "frame of the tool turned": lambda robot: rotated_link(robot, "tool", ASKEW),
    "frames of all links turned": each_link(rotated_link, QUARTER),
    "inertial frames turned": each_link(rotated_inertial, ASKEW),
    "hung up at the tool": lambda robot: rerooted(robot, "tool"),
    "longer and lighter": lambda robot: scaled(robot, 1.7, 0.6),
    "smaller": lambda robot: scaled(robot, 0.4, 0.1),
    "renamed": renamed,
    "in another order": reordered,
    "with more digits": written_longer,
    "with properties": with_properties,
}


@pytest.fixture(name="robot")
def make_robot(tmp_path: Path) -> Robot:
    return make_cart(tmp_path)


def find_inertial(robot: Robot, link: str) -> ET.Element:
    found = robot.find(f"link[@name='{link}']/inertial")
    assert found is not None
    return found


def times(robot: Robot, link: str, factor: float, *names: str) -> None:
    """Multiply the mass (``value``) or numbers of the tensor."""
    for element in find_inertial(robot, link):
        for name in set(names) & set(element.attrib):
            element.set(name, repr(float(element.attrib[name]) * factor))


def no_such_plate(robot: Robot) -> None:
    times(robot, "tool", 9.0, "izz")


def negative(robot: Robot) -> None:
    times(robot, "tool", -1.0, "iyy")


def too_large(robot: Robot) -> None:
    times(robot, "tool", 12.0, *NAMES)


def square_millimetres(robot: Robot) -> None:
    times(robot, "tool", 1e6, *NAMES)


def com_at_the_origin(robot: Robot) -> None:
    origin = find_inertial(robot, "tool").find("origin")
    assert origin is not None
    origin.set("xyz", "0 0 0")


def turned_wheel(robot: Robot) -> None:
    origin = robot.find("joint[@name='axle_1']/origin")
    assert origin is not None
    origin.set("rpy", "0 -0.75239 0")


def heavy_wheel(robot: Robot) -> None:
    times(robot, "wheel_2", 1.3, "value", *NAMES)


def copied_arm(robot: Robot) -> None:
    left, right = find_inertial(robot, "left_arm"), find_inertial(robot, "right_arm")
    for here, there in zip(right, left, strict=True):
        here.attrib.update(there.attrib)


def com_in_the_air(robot: Robot) -> None:
    origin = find_inertial(robot, "tool").find("origin")
    assert origin is not None
    origin.set("xyz", "0 0 0.3")


Defect = Callable[[Robot], None]
DEFECTS: list[tuple[str, Defect]] = [
    ("INR003", no_such_plate),
    ("INR004", negative),
    ("INR005", too_large),
    ("INR006", com_in_the_air),
    ("INR009", square_millimetres),
    ("INR009", com_at_the_origin),
    ("SYM001", turned_wheel),
    ("SYM003", heavy_wheel),
    ("SYM004", copied_arm),
]


# A minus sign, a decimal point; an angle at which a part was exported.
TYPED = frozenset({"INR003", "INR004", "SYM001"})


def verdict(folder: Path, robot: Robot, code: str) -> list[tuple[str, str | None]]:
    """What is found, by severity and cause, unless that is how the numbers were typed: it goes with their axes and notation."""
    path = folder / "robot.urdf.xacro"
    path.write_text(ET.tostring(robot, encoding="unicode"))
    run = check(path, codes={code})
    assert not run.failures
    return [(str(f.severity), f.cause.id if f.cause and code not in TYPED else None) for f in run.findings]


@pytest.mark.parametrize(("code", "defect"), DEFECTS, ids=lambda v: v if isinstance(v, str) else v.__name__)
def test_a_defect_stays_what_it_is(tmp_path: Path, robot: Robot, code: str, defect: Defect) -> None:
    if code not in load_rules():
        pytest.skip("not a rule yet")
    defect(robot)
    verdicts = {name: verdict(tmp_path, change(robot), code) for name, change in TRANSFORMATIONS.items()}
    assert len(verdicts["as it is"]) == 1
    assert verdicts == dict.fromkeys(TRANSFORMATIONS, verdicts["as it is"])


@pytest.mark.parametrize("transformation", TRANSFORMATIONS)
def test_a_sound_robot_stays_sound(tmp_path: Path, robot: Robot, transformation: str) -> None:
    path = tmp_path / "robot.urdf.xacro"
    path.write_text(ET.tostring(TRANSFORMATIONS[transformation](robot), encoding="unicode"))
    codes = {code for code, _ in DEFECTS} & set(load_rules())
    assert not [f.message for f in check(path, codes=codes).findings]
