"""Edits after which a robot is what it was, and the plain text of a robot to make them in."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from xml.etree import ElementTree as ET

import numpy as np
from injections import Array, Rng
from transforms import (
    Robot,
    reordered,
    rerooted,
    rotated_inertial,
    with_defaults,
    with_properties,
    written_longer,
)

from urdfcheck.source.text.xml import Element

# A tensor of fewer digits than this is only as good as they say: turned and written in full it would claim more.
_DIGITS = 4
_TENSOR = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")

# What renamed links and joints begin with.
RENAMED = "unit_"

Edit = Callable[[Robot, Rng], "Robot | None"]


def build_plain_robot(root: Element) -> Robot:
    """Build the plain tree of an expanded robot, with all origins and axes written down."""
    return with_defaults(_build_tree(root))


def _build_tree(element: Element) -> ET.Element:
    # The namespace of xacro is declared where it is used.
    attributes = {name: a.value for name, a in element.attributes.items() if name != "xmlns:xacro"}
    tree = ET.Element(element.tag, attributes)
    tree.text = element.text
    tree.extend(_build_tree(child) for child in element.children)
    return tree


def write_robot(robot: Robot) -> str:
    """Return the text of a robot."""
    return ET.tostring(robot, encoding="unicode")


def turn_inertial_frames(robot: Robot, rng: Rng) -> Robot | None:
    """The axes of each inertial turned at random, the tensor with them."""
    for link in [link for link in robot.findall("link") if _is_precise(link)]:
        robot = rotated_inertial(robot, link.get("name", ""), _rotation(rng))
    return robot


def hang_up(robot: Robot, rng: Rng) -> Robot | None:
    """The tree hung up at another link, where every link between the two has a mass and no joint on the way is mimicked."""
    joints = robot.findall("joint")
    parents = {_end(joint, "child"): joint for joint in joints}
    heavy = {
        link.get("name")
        for link in robot.findall("link")
        if float((_find(link, "inertial/mass")).get("value", "0")) > 0
    }
    mimicked = {mimic.get("joint") for joint in joints for mimic in joint.findall("mimic")}
    leaves = [
        str(name) for name in heavy if name in parents and name not in {_end(joint, "parent") for joint in joints}
    ]
    rng.shuffle(leaves)
    for leaf in sorted(leaves, key=len):
        path, link = [], leaf
        while link in parents:
            path.append(parents[link])
            link = _end(parents[link], "parent")
        usable = all(
            j.get("type") in ("revolute", "continuous", "prismatic", "fixed") and j.find("mimic") is None for j in path
        )
        all_heavy = {leaf, *(_end(joint, "parent") for joint in path)} <= heavy
        if usable and all_heavy and not {joint.get("name") for joint in path} & mimicked:
            return rerooted(robot, leaf)
    return None


def shuffle(robot: Robot, rng: Rng) -> Robot | None:
    """Elements in another order."""
    return reordered(robot, int(rng.integers(1 << 30)))


def write_longer(robot: Robot, rng: Rng) -> Robot | None:
    """Numbers with more digits."""
    return written_longer(robot)


def rename(robot: Robot, rng: Rng) -> Robot | None:
    """Links and joints with another name, wherever the file names them."""
    names = {e.get("name", "") for tag in ("link", "joint") for e in robot.findall(tag)} - {"world"}
    text = write_robot(robot)
    changed = ET.fromstring(text)
    for element in changed.iter():
        for name, value in element.attrib.items():
            if value in names and element is not changed and element.tag not in ("material", "visual", "collision"):
                element.set(name, f"{RENAMED}{value}")
        if element.text is not None and element.text.strip() in names:
            element.text = f"{RENAMED}{element.text.strip()}"
    return changed


def name_numbers(robot: Robot, rng: Rng) -> Robot | None:
    """Numbers as properties of a xacro."""
    return with_properties(robot)


def _is_precise(link: ET.Element) -> bool:
    inertia = link.find("inertial/inertia")
    if inertia is None:
        return False
    words = [inertia.get(name, "0") for name in _TENSOR]
    try:
        numbers = [abs(float(word)) for word in words]
    except ValueError:
        return False
    if not all(map(math.isfinite, numbers)) or max(numbers) <= 0:
        return False
    least = min(numbers[0], numbers[3], numbers[5])
    return all(
        _count_digits(word) >= _DIGITS for word, number in zip(words, numbers, strict=True) if number >= least > 0
    )


def _count_digits(word: str) -> int:
    return sum(map(str.isdigit, word.lower().partition("e")[0].lstrip("-+0.")))


def _rotation(rng: Rng) -> Array:
    found = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return found * np.sign(np.linalg.det(found))


def _find(element: ET.Element, path: str) -> ET.Element:
    found = element.find(path)
    return ET.Element("none") if found is None else found


def _end(joint: ET.Element, end: str) -> str:
    return _find(joint, end).get("link", "")


# Rules about other files, which name links and joints too.
_ELSEWHERE = ("SRD", "CTL", "LCH", "COL003", "GZB", "XAC")

# Each edit, and the rules that may say something new after it.
EDITS: Mapping[str, tuple[Edit, tuple[str, ...]]] = {
    "inertial frames turned": (turn_inertial_frames, ()),
    # Another root: a base that is moved by a joint, and joints that carry the rest of the robot instead of the tool.
    "hung up at another link": (hang_up, ("NAM", "KIN008", "INR001", "DYN", *_ELSEWHERE)),
    # A material is defined before it is used.
    "elements in another order": (shuffle, ("XML011",)),
    "more digits": (write_longer, ()),
    "renamed": (rename, _ELSEWHERE),
    "numbers as properties": (name_numbers, ()),
}
