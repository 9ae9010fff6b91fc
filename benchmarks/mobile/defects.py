"""Twenty defects of mobile robots, each as a change of a sound one."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from copy import deepcopy
from dataclasses import dataclass, replace
from xml.etree import ElementTree as ET

from made import MobileRobot

from urdfcheck.facts.motion.kinematics import matrix_to_rpy, rpy_to_matrix

Files = dict[str, str | bytes]


@dataclass(frozen=True, slots=True)
class Defect:
    """A defect: how it is made, and which rules name it."""

    name: str
    plant: Callable[[MobileRobot], MobileRobot | None]
    """Returns the broken robot; None where the robot has no such part."""
    codes: frozenset[str]
    """Findings of these rules name the defect or its direct effect on how the robot stands and drives."""


class _Draft:
    """A copy of a robot that may be changed."""

    def __init__(self, robot: MobileRobot) -> None:
        self.robot = robot
        self.root = deepcopy(robot.root)
        self.files: Files = dict(robot.files)

    def finish(self) -> MobileRobot:
        return replace(self.robot, root=self.root, files=self.files)

    def joint(self, name: str) -> ET.Element:
        return next(joint for joint in self.root.findall("joint") if joint.get("name") == name)

    def link(self, name: str) -> ET.Element:
        return next(link for link in self.root.findall("link") if link.get("name") == name)

    def wheels(self) -> Iterator[ET.Element]:
        """Yield the links of the driven wheels."""
        for name in list_driven(self.robot):
            yield self.link(_child(self.joint(name)))

    def radius(self) -> float:
        """Return the radius (m) of the driven wheels."""
        for role in ("collision", "visual"):
            for shape in self.link(_child(self.joint(self.robot.left))).findall(f"{role}/geometry/*"):
                if shape.get("radius"):
                    return float(shape.get("radius", ""))
        return 0.05

    def caster_joints(self) -> list[ET.Element]:
        return [joint for joint in self.root.findall("joint") if _child(joint) in self.robot.casters]


def list_driven(robot: MobileRobot) -> list[str]:
    """List the joints of the driven wheels: those like the two that are named."""
    words = [
        re.compile(re.sub(r"front|middle|rear|back|left|right|\d", ".*", name)) for name in (robot.left, robot.right)
    ]
    found = [
        joint.get("name", "")
        for joint in robot.root.findall("joint")
        if joint.get("type") == "continuous" and any(word.fullmatch(joint.get("name", "")) for word in words)
    ]
    return [name for name in found if not re.search("cast[eo]r", name)]


def _child(joint: ET.Element) -> str:
    child = joint.find("child")
    return "" if child is None else child.get("link", "")


def _origin(element: ET.Element) -> ET.Element:
    found = element.find("origin")
    if found is None:
        found = ET.SubElement(element, "origin")
    return found


def _numbers(element: ET.Element, key: str) -> list[float]:
    return [float(word) for word in element.get(key, "0 0 0").split()]


def _shift(element: ET.Element, by: tuple[float, float, float]) -> None:
    origin = _origin(element)
    moved = [a + b for a, b in zip(_numbers(origin, "xyz"), by, strict=True)]
    origin.set("xyz", " ".join(f"{value:.6g}" for value in moved))


def _shift_wheel(along: str, share: float) -> Callable[[MobileRobot], MobileRobot]:
    def plant(robot: MobileRobot) -> MobileRobot:
        draft = _Draft(robot)
        joint = draft.joint(robot.left)
        far = share * draft.radius()
        outwards = 1.0 if _numbers(_origin(joint), "xyz")[1] >= 0 else -1.0
        _shift(joint, tuple(far * (outwards if axis == "y" else 1.0) * (axis == along) for axis in "xyz"))  # type: ignore[arg-type]
        return draft.finish()

    return plant


def _tilt(robot: MobileRobot) -> MobileRobot:
    draft = _Draft(robot)
    _rotate(draft.joint(robot.left), 0.1, 0)
    return draft.finish()


def _rotate(joint: ET.Element, angle: float, about: int) -> None:
    """Rotate a joint's frame about an axis of its parent's."""
    origin = _origin(joint)
    turn = [0.0, 0.0, 0.0]
    turn[about] = angle
    rpy = matrix_to_rpy(rpy_to_matrix(turn) @ rpy_to_matrix(_numbers(origin, "rpy")))
    origin.set("rpy", " ".join(f"{value:.9g}" for value in rpy))


def _scale_collisions(factor: float) -> Callable[[MobileRobot], MobileRobot | None]:
    def plant(robot: MobileRobot) -> MobileRobot | None:
        draft = _Draft(robot)
        shapes = [shape for link in draft.wheels() for shape in link.findall("collision/geometry/*")]
        return draft.finish() if sum(_scale(shape, factor) for shape in shapes) else None

    return plant


def _scale(shape: ET.Element, factor: float) -> bool:
    if shape.tag not in {"cylinder", "sphere"}:
        return False
    shape.set("radius", f"{factor * float(shape.get('radius', '')):.6g}")
    return True


def _shrink_wheel(robot: MobileRobot) -> MobileRobot | None:
    draft = _Draft(robot)
    link = draft.link(_child(draft.joint(robot.left)))
    shapes = [shape for role in ("visual", "collision") for shape in link.findall(f"{role}/geometry/*")]
    if not all(shape.tag in {"cylinder", "sphere"} for shape in shapes):
        return None
    for shape in shapes:
        _scale(shape, 0.85)
    return draft.finish()


def _offset_shape(robot: MobileRobot) -> MobileRobot:
    draft = _Draft(robot)
    link = draft.link(_child(draft.joint(robot.left)))
    for role in ("visual", "collision"):
        for element in link.findall(role):
            _shift(element, (0.15 * draft.radius(), 0.0, 0.0))
    return draft.finish()


def _shift_casters(share: float) -> Callable[[MobileRobot], MobileRobot | None]:
    def plant(robot: MobileRobot) -> MobileRobot | None:
        draft = _Draft(robot)
        for joint in draft.caster_joints():
            _shift(joint, (0.0, 0.0, share * draft.radius()))
        return draft.finish() if robot.casters else None

    return plant


def _lift_driven(robot: MobileRobot) -> MobileRobot | None:
    draft = _Draft(robot)
    for name in list_driven(robot):
        _shift(draft.joint(name), (0.0, 0.0, 0.15 * draft.radius()))
    return draft.finish() if robot.casters else None


def _reverse_axis(robot: MobileRobot) -> MobileRobot:
    draft = _Draft(robot)
    axis = draft.joint(robot.left).find("axis")
    assert axis is not None
    axis.set("xyz", " ".join(f"{-value:g}" for value in _numbers(axis, "xyz")))
    return draft.finish()


def _scale_drive(key: str, factor: float) -> Callable[[MobileRobot], MobileRobot | None]:
    """Scale a parameter of the controller's yaml, or of a plugin of the model."""
    pattern = re.compile(rf"((?:\w*\.)?\b(?:{key})\w*: *)([\d.]+)")

    def plant(robot: MobileRobot) -> MobileRobot | None:
        draft = _Draft(robot)
        changed = False
        for path, text in robot.files.items():
            if path.endswith(".yaml") and isinstance(text, str):
                new = pattern.sub(lambda m: f"{m[1]}{float(m[2]) * factor:.6g}", text)
                changed |= new != text
                draft.files[path] = new
        for element in draft.root.findall("gazebo/plugin/*"):
            if re.fullmatch(key, element.tag):
                element.text = f"{float(element.text or '') * factor:.6g}"
                changed = True
        return draft.finish() if changed else None

    return plant


def _set_contact(key: str, value: float, *, casters: bool) -> Callable[[MobileRobot], MobileRobot | None]:
    def plant(robot: MobileRobot) -> MobileRobot | None:
        draft = _Draft(robot)
        names = set(robot.casters) if casters else {_child(draft.joint(name)) for name in list_driven(robot)}
        for name in sorted(names):
            for old in [b for b in draft.root.findall("gazebo") if b.get("reference") == name]:
                draft.root.remove(old)
            block = ET.SubElement(draft.root, "gazebo", {"reference": name})
            contact = {"mu1": 1.0, "mu2": 1.0, "kp": 1e6, "kd": 100.0, "minDepth": 0.001} | {key: value}
            if key == "mu1":
                contact["mu2"] = value
            for tag, number in contact.items():
                ET.SubElement(block, tag).text = f"{number:g}"
        return draft.finish() if names else None

    return plant


def _lower_chassis(robot: MobileRobot) -> MobileRobot | None:
    draft = _Draft(robot)
    link = draft.link(robot.base)
    for element in link.findall("collision"):
        _shift(element, (0.0, 0.0, -2.2 * draft.radius()))
    return draft.finish() if link.find("collision") is not None else None


def _shift_com(robot: MobileRobot) -> MobileRobot | None:
    draft = _Draft(robot)
    inertial = draft.link(robot.base).find("inertial")
    if inertial is None:
        return None
    _shift(inertial, (12 * draft.radius(), 0.0, 0.0))
    return draft.finish()


def _lean_base(robot: MobileRobot) -> MobileRobot | None:
    draft = _Draft(robot)
    joints = [joint for joint in draft.root.findall("joint") if _child(joint) == robot.base]
    for joint in joints:
        _rotate(joint, 0.05, 1)
    return draft.finish() if joints else None


DEFECTS = (
    Defect(
        "a wheel too high by 0.2 radii", _shift_wheel("z", 0.2), frozenset({"SYM002", "SYM006", "SYM008", "DYN006"})
    ),
    Defect("a wheel tilted by 0.1 rad", _tilt, frozenset({"SYM001", "SYM008", "SYM004"})),
    Defect("a wheel ahead by half a radius", _shift_wheel("x", 0.5), frozenset({"SYM002", "SYM008", "SYM004"})),
    Defect("a wheel outside by 0.4 radii", _shift_wheel("y", 0.4), frozenset({"SYM002", "SYM008", "SYM004"})),
    Defect("collision of wheels 3 × as large", _scale_collisions(3.0), frozenset({"GEO003", "GEO006"})),
    Defect("collision of wheels 1.2 × as large", _scale_collisions(1.2), frozenset({"GEO003", "GEO006"})),
    Defect("a smaller wheel", _shrink_wheel, frozenset({"SYM006", "SYM008"})),
    Defect("a wheel beside its axle", _offset_shape, frozenset({"JNT015"})),
    Defect("casters below the wheels", _shift_casters(-0.3), frozenset({"DYN006"})),
    Defect("casters above the wheels", _shift_casters(0.45), frozenset({"DYN006", "DYN004"})),
    Defect("driven wheels above the ground", _lift_driven, frozenset({"DYN006"})),
    Defect("an axis reversed", _reverse_axis, frozenset({"SYM005"})),
    Defect(
        "separation of the drive 20 % off",
        _scale_drive(r"wheel_separation|sum_of_robot_center_projection_on_X_Y_axis", 1.2),
        frozenset({"CTL004", "CTL007"}),
    ),
    Defect(
        "diameter for radius in the drive",
        _scale_drive(r"wheel_radius|wheels_radius", 2.0),
        frozenset({"CTL004", "CTL007"}),
    ),
    Defect("driven wheels without friction", _set_contact("mu1", 0.0, casters=False), frozenset({"GZB008"})),
    Defect("casters with friction", _set_contact("mu1", 1.0, casters=True), frozenset({"GZB008"})),
    Defect("kp of 1e13", _set_contact("kp", 1e13, casters=False), frozenset({"GZB008"})),
    Defect("the chassis on the ground", _lower_chassis, frozenset({"DYN006", "GEO003"})),
    Defect("COM outside the wheels", _shift_com, frozenset({"DYN004", "INR006", "INR009"})),
    Defect("the base leans by 0.05 rad", _lean_base, frozenset({"DYN006"})),
)
