"""Changes of a plain URDF that leave the robot what it is: other frames, another root, other units, other names, another order.

Each takes the ``<robot>`` element and gives a new one. Every link, visual, collision, inertial and joint of it must have an
``<origin>`` with xyz and rpy where URDF allows one, every moving joint an ``<axis>``.
"""

from __future__ import annotations

import copy
import random
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from urdfcheck.facts.motion.kinematics import build_origin_transform, matrix_to_rpy

Array = NDArray[np.float64]
Robot = ET.Element
Transformation = Callable[[Robot], Robot]

# Attributes with numbers that a change of notation may write in another way.
NUMERIC = frozenset({"xyz", "rpy", "size", "radius", "length", "value", "lower", "upper", "effort", "velocity"}) | {
    "ixx", "ixy", "ixz", "iyy", "iyz", "izz",
}  # fmt: skip
XACRO = "http://www.ros.org/wiki/xacro"
ET.register_namespace("xacro", XACRO)
_PLACED = frozenset({"inertial", "visual", "collision"})
_TENSOR = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def rotated_link(robot: Robot, link: str, rotation: Array) -> Robot:
    """The axes of a link's frame turned by ``rotation`` (3, 3), given in the old frame; nothing moves."""
    placement = np.eye(4)
    placement[:3, :3] = rotation
    return moved_link(robot, link, placement)


def moved_link(robot: Robot, link: str, placement: Array) -> Robot:
    """A link's frame at ``placement`` (4, 4), given in the old frame; nothing moves if that is on the joint's axis."""
    changed = copy.deepcopy(robot)
    _move_frame(changed, link, placement)
    return changed


def rotated_inertial(robot: Robot, link: str, rotation: Array) -> Robot:
    """The axes of a link's inertial frame turned by ``rotation`` (3, 3), given in the old one; the tensor goes with them."""
    changed = copy.deepcopy(robot)
    inertial = _find(_find(changed, f"link[@name='{link}']"), "inertial")
    origin, inertia = _find(inertial, "origin"), _find(inertial, "inertia")
    placement = _placement(origin)
    placement[:3, :3] = placement[:3, :3] @ rotation
    _place(origin, placement)
    _write_tensor(inertia, rotation.T @ _tensor(inertia) @ rotation)
    return changed


def rerooted(robot: Robot, root: str) -> Robot:
    """The tree hung up at another link. The joints between it and the old root are reversed: what was the parent's frame
    moves to the joint, and the axis changes its sign, so that positions keep theirs."""
    changed = copy.deepcopy(robot)
    parent = {_name(joint, "child"): joint for joint in changed.findall("joint")}
    path = []
    link = root
    while link in parent:
        path.append(parent[link])
        link = _name(parent[link], "parent")
    for joint in reversed(path):
        _move_frame(changed, _name(joint, "parent"), _placement(_find(joint, "origin")))
        before, after = _find(joint, "parent"), _find(joint, "child")
        old, new = before.get("link", ""), after.get("link", "")
        before.set("link", new)
        after.set("link", old)
        axis = joint.find("axis")
        if axis is not None:
            axis.set("xyz", _text(-_numbers(axis, "xyz")))
    return changed


def scaled(robot: Robot, length: float, mass: float) -> Robot:
    """Other units of length and mass: coordinates and sizes times ``length``, masses times ``mass``."""
    changed = copy.deepcopy(robot)
    for element in changed.iter():
        for name in {"xyz", "size", "radius", "length", "scale"} & set(element.attrib):
            if element.tag != "axis":
                element.set(name, _text(_numbers(element, name) * length))
        if element.tag == "mesh" and "scale" not in element.attrib:
            element.set("scale", _text(np.full(3, length)))
        if element.tag == "mass":
            element.set("value", _text(_numbers(element, "value") * mass))
        if element.tag == "inertia":
            _write_tensor(element, _tensor(element) * mass * length**2)
    for joint in changed.findall("joint[@type='prismatic']"):
        for limit in joint.findall("limit"):
            for name in ("lower", "upper", "velocity"):
                limit.set(name, _text(_numbers(limit, name) * length))
    return changed


def renamed(robot: Robot) -> Robot:
    """Links and joints with names that say nothing."""
    changed = copy.deepcopy(robot)
    links = {link.get("name", ""): f"part{i}" for i, link in enumerate(changed.findall("link"))}
    for link in changed.findall("link"):
        link.set("name", links[link.get("name", "")])
    for i, joint in enumerate(changed.findall("joint")):
        joint.set("name", f"connection{i}")
        for end in ("parent", "child"):
            _find(joint, end).set("link", links[_name(joint, end)])
    return changed


def reordered(robot: Robot, seed: int = 1) -> Robot:
    """Links, joints and all else of the robot in another order, and what is in each link."""
    order = random.Random(seed)
    changed = copy.deepcopy(robot)
    for element in (changed, *changed.findall("link")):
        # Shapes of one kind keep their order: the first of them is the one that has no number in a subject.
        tags = [child.tag for child in element] if element is not changed else []
        children = list(element)
        order.shuffle(children)
        # Of two blocks that set one value, simulators take the one or the other by their order.
        blocks = iter([child for child in element if child.tag == "gazebo"])
        children = [next(blocks) if child.tag == "gazebo" else child for child in children]
        if tags:
            children.sort(key=lambda child: [*dict.fromkeys(tags)][::-1].index(child.tag))
        element[:] = children
    return changed


def written_longer(robot: Robot) -> Robot:
    """Numbers of four digits or more with three zeros behind them; how precise shorter ones are depends on their digits."""
    changed = copy.deepcopy(robot)
    for element in changed.iter():
        for name in NUMERIC & set(element.attrib):
            element.set(name, " ".join(map(_lengthen, element.attrib[name].split())))
    return changed


def _lengthen(word: str) -> str:
    digits, mark, exponent = word.lower().partition("e")
    is_precise = "." in digits and sum(map(str.isdigit, digits.lstrip("-+0."))) >= 4
    return f"{digits}000{mark}{exponent}" if is_precise else word


def with_properties(robot: Robot) -> Robot:
    """A xacro whose numbers are properties, each of which has one value."""
    changed = copy.deepcopy(robot)
    names: dict[str, str] = {}
    for element in changed.iter():
        for name in NUMERIC & set(element.attrib):
            words = element.attrib[name].split()
            if all(map(_is_number, words)):
                places = [names.setdefault(word, f"value_{len(names)}") for word in words]
                element.set(name, " ".join(f"${{{place}}}" for place in places))
    for value, name in reversed(names.items()):
        changed.insert(0, ET.Element(f"{{{XACRO}}}property", {"name": name, "value": value}))
    return changed


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def with_defaults(robot: Robot) -> Robot:
    """Origins and axes that are left out, and angles and coordinates, as what they are then."""
    changed = copy.deepcopy(robot)
    places = [*changed.findall("joint"), *(p for link in changed.findall("link") for p in link if p.tag in _PLACED)]
    for place in places:
        origin = place.find("origin")
        if origin is None:
            origin = ET.Element("origin")
            place.insert(0, origin)
        for name in ("xyz", "rpy"):
            if name not in origin.attrib and "quat_xyzw" not in origin.attrib:
                origin.set(name, "0 0 0")
        if place.tag == "joint" and place.get("type") not in ("fixed", "floating") and place.find("axis") is None:
            ET.SubElement(place, "axis", {"xyz": "1 0 0"})
    return changed


def each_link(change: Callable[[Robot, str, Array], Robot], rotation: Array) -> Transformation:
    """The same change of every link."""

    def apply(robot: Robot) -> Robot:
        for link in robot.findall("link"):
            robot = change(robot, link.get("name", ""), rotation)
        return robot

    return apply


def _move_frame(robot: Robot, link: str, placement: Array) -> None:
    """Move a link's frame, in place, to ``placement`` (4, 4) in the old one; a translation must leave its parent joint's
    axis where it is."""
    inverse = np.linalg.inv(placement)
    for origin in _origins_on(robot, link):
        _place(origin, inverse @ _placement(origin))
    for joint in robot.findall("joint"):
        if _name(joint, "child") == link:
            origin, axis = _find(joint, "origin"), joint.find("axis")
            _place(origin, _placement(origin) @ placement)
            if axis is not None:
                axis.set("xyz", _text(inverse[:3, :3] @ _numbers(axis, "xyz")))


def _origins_on(robot: Robot, link: str) -> Iterator[ET.Element]:
    """The origins that are given in a link's frame."""
    yield from _find(robot, f"link[@name='{link}']").iter("origin")
    for joint in robot.findall("joint"):
        if _name(joint, "parent") == link:
            yield _find(joint, "origin")


def _find(element: ET.Element, path: str) -> ET.Element:
    found = element.find(path)
    assert found is not None, path
    return found


def _name(joint: ET.Element, end: str) -> str:
    return _find(joint, end).get("link", "")


def _numbers(element: ET.Element, name: str) -> Array:
    return np.array([float(word) for word in element.attrib[name].split()])


def _text(values: Sequence[float] | Array) -> str:
    return " ".join(repr(float(value)) for value in np.atleast_1d(values))


def _placement(origin: ET.Element) -> Array:
    return build_origin_transform(_numbers(origin, "xyz").tolist(), _numbers(origin, "rpy").tolist())


def _place(origin: ET.Element, placement: Array) -> None:
    origin.set("xyz", _text(placement[:3, 3]))
    origin.set("rpy", _text(matrix_to_rpy(placement[:3, :3])))


def _tensor(inertia: ET.Element) -> Array:
    xx, xy, xz, yy, yz, zz = (float(inertia.attrib[name]) for name in _TENSOR)
    return np.array(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)))


def _write_tensor(inertia: ET.Element, tensor: Array) -> None:
    entries = [tensor[i, j] for i in range(3) for j in range(i, 3)]
    for name, value in zip(_TENSOR, entries, strict=True):
        inertia.set(name, repr(float(value)))
