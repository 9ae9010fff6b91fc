"""An arm with a gripper, edits that leave it the robot that it is, and edits that do not."""

from __future__ import annotations

import copy
import xml.etree.ElementTree as ET
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from conftest import make_request
from transforms import (
    XACRO,
    Robot,
    moved_link,
    reordered,
    rotated_inertial,
    rotated_link,
    with_properties,
    written_longer,
)

from urdfcheck.changes.compare_versions import compare_versions
from urdfcheck.core.model_diff import Diff, ModelDiff
from urdfcheck.facts.motion.kinematics import rpy_to_matrix
from urdfcheck.run.pipeline import IN_THIS_PROCESS

ZERO = '<origin xyz="0 0 0" rpy="0 0 0"/>'
ASKEW = rpy_to_matrix((0.4, -0.7, 1.1))


def _link(name: str, mass: float, com: str, moments: tuple[float, float, float], *shapes: str) -> str:
    ixx, iyy, izz = moments
    return f"""
  <link name="{name}">
    <inertial>
      <origin xyz="{com}" rpy="0 0 0"/>
      <mass value="{mass}"/>
      <inertia ixx="{ixx}" ixy="0" ixz="0" iyy="{iyy}" iyz="0" izz="{izz}"/>
    </inertial>
    {"".join(shapes)}
  </link>"""


def _shape(role: str, geometry: str, origin: str = ZERO) -> str:
    return f"""
    <{role}>
      {origin}
      <geometry>{geometry}</geometry>
    </{role}>"""


def _both(geometry: str, origin: str = ZERO) -> str:
    return _shape("visual", geometry, origin) + _shape("collision", geometry, origin)


def _joint(name: str, kind: str, parent: str, child: str, origin: str, *more: str) -> str:
    return f"""
  <joint name="{name}" type="{kind}">
    <parent link="{parent}"/>
    <child link="{child}"/>
    {origin}
    {"".join(more)}
  </joint>"""


ARM = "".join(
    (
        '<robot name="arm">',
        _link("base", 4.0, "0 0 0.05", (0.02, 0.02, 0.03), _both('<box size="0.2 0.2 0.1"/>')),
        _link(
            "upper", 2.0, "0 0 0.2", (0.03, 0.03, 0.004),
            _both('<box size="0.08 0.06 0.4"/>', '<origin xyz="0 0 0.2" rpy="0 0 0"/>'),
        ),
        _link(
            "fore", 1.5, "0.15 0 0", (0.002, 0.012, 0.013),
            _both('<box size="0.3 0.05 0.06"/>', '<origin xyz="0.15 0 0" rpy="0 0 0"/>'),
        ),
        _link("camera", 0.2, "0.01 0 0", (0.0001, 0.0002, 0.0003), _both('<box size="0.03 0.09 0.02"/>')),
        _link("hand", 0.6, "0.03 0 0", (0.0006, 0.0007, 0.0008), _both('<box size="0.06 0.1 0.04"/>')),
        _link("left", 0.05, "0.02 0 0", (1e-5, 2e-5, 2.5e-5), _both('<box size="0.04 0.01 0.02"/>')),
        _link("right", 0.05, "0.02 0 0", (1e-5, 2e-5, 2.5e-5), _both('<box size="0.04 0.01 0.02"/>')),
        '\n  <link name="tool0"/>',
        _joint(
            "pan", "revolute", "base", "upper", '<origin xyz="0 0 0.1" rpy="0 0 0"/>', '<axis xyz="0 0 1"/>',
            '<limit lower="-2.5" upper="2.5" effort="60" velocity="2"/>',
        ),
        _joint(
            "elbow", "revolute", "upper", "fore", '<origin xyz="0 0 0.4" rpy="0 0 0.2"/>', '<axis xyz="0 1 0"/>',
            '<limit lower="-1.8" upper="1.8" effort="40" velocity="2"/>', '<dynamics damping="0.5" friction="0.1"/>',
        ),
        _joint("camera_mount", "fixed", "fore", "camera", '<origin xyz="0.1 0 0.05" rpy="0.1 0.2 0.3"/>'),
        _joint(
            "wrist", "continuous", "fore", "hand", '<origin xyz="0.3 0 0" rpy="0 0 0"/>', '<axis xyz="1 0 0"/>',
            '<limit effort="10" velocity="3"/>',
        ),
        _joint(
            "grip", "prismatic", "hand", "left", '<origin xyz="0.06 0.04 0" rpy="0 0 0"/>', '<axis xyz="0 1 0"/>',
            '<limit lower="-0.03" upper="0.01" effort="20" velocity="0.1"/>',
        ),
        _joint(
            "grip_mirror", "prismatic", "hand", "right", '<origin xyz="0.06 -0.04 0" rpy="0 0 0"/>',
            '<axis xyz="0 1 0"/>', '<limit lower="-0.01" upper="0.03" effort="20" velocity="0.1"/>',
            '<mimic joint="grip" multiplier="-1" offset="0"/>',
        ),
        _joint("tool", "fixed", "hand", "tool0", '<origin xyz="0.1 0 0" rpy="0 0 0"/>'),
        """
  <gazebo reference="hand">
    <mu1>0.8</mu1>
  </gazebo>
</robot>
""",
    )
)  # fmt: skip


def compare(before: Path, after: Path, **settings: object) -> Diff:
    """Compare two paths in this process, with a few quick rules."""
    codes = settings.pop("codes", {"INR003", "INR004", "XML001", "KIN001"})
    first, second = (make_request(path, codes=codes, **settings) for path in (before, after))  # type: ignore[arg-type]
    return compare_versions(first, second, IN_THIS_PROCESS)


def compare_texts(folder: Path, before: str, after: str, name: str = "arm.urdf", **settings: object) -> ModelDiff:
    """Compare two texts of one file and return the difference of the model."""
    paths = [folder / side / name for side in ("old", "new")]
    for path, text in zip(paths, (before, after), strict=True):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    diff = compare(*paths, **settings)
    assert diff.failures == ()
    (model,) = diff.models
    return model


# -- edits that leave the robot what it is -----------------------------------------------------------------------------


def find(robot: Robot, path: str) -> ET.Element:
    """Return the element at a path, which must exist."""
    found = robot.find(path)
    assert found is not None, path
    return found


def list_origins(robot: Robot) -> list[tuple[ET.Element, ET.Element]]:
    """Return the origins that place something, each with what it places; other formats have elements of this name too."""
    placed = [*robot.findall("joint"), *(part for link in robot.findall("link") for part in link)]
    return [
        (part, origin)
        for part in placed
        if part.tag in {"joint", "inertial", "visual", "collision"} and (origin := part.find("origin")) is not None
    ]


def commented(robot: Robot) -> Robot:
    """Comments everywhere."""
    changed = copy.deepcopy(robot)
    for element in list(changed.iter()):
        element.insert(0, ET.Comment(" a remark "))
    return changed


def with_other_angles(robot: Robot) -> Robot:
    """Every rotation in other angles: π more of roll and yaw, and the supplement of the pitch."""
    changed = copy.deepcopy(robot)
    for _, origin in list_origins(changed):
        roll, pitch, yaw = (float(word) for word in origin.get("rpy", "0 0 0").split())
        origin.set("rpy", f"{roll + np.pi!r} {np.pi - pitch!r} {yaw + np.pi!r}")
    return changed


def with_six_digits(robot: Robot) -> Robot:
    """Angles in fewer digits, as far as nobody can measure the difference."""
    changed = copy.deepcopy(robot)
    for element in changed.iter():
        for name in {"xyz", "rpy"} & set(element.attrib):
            element.set(name, " ".join(f"{float(word):.6g}" for word in element.attrib[name].split()))
    return changed


def with_longer_axes(robot: Robot) -> Robot:
    """Axes that are no unit vectors."""
    changed = copy.deepcopy(robot)
    for axis in changed.iter("axis"):
        axis.set("xyz", " ".join(repr(2.0 * float(word)) for word in axis.attrib["xyz"].split()))
    return changed


def with_defaults_left_out(robot: Robot) -> Robot:
    """Origins at zero and their angles at zero are not written."""
    changed = copy.deepcopy(robot)
    for parent, origin in list_origins(changed):
        if not any(float(word) for word in origin.get("rpy", "0").split()):
            origin.attrib.pop("rpy", None)
        if not origin.attrib.keys() & {"rpy", "quat_xyzw"} and not any(map(float, origin.get("xyz", "0").split())):
            parent.remove(origin)
    return changed


def with_split_link(robot: Robot) -> Robot:
    """The shapes and half of the mass of the last link with both go to a link of their own, fixed to it."""
    changed = copy.deepcopy(robot)
    link = next(
        e
        for e in reversed(changed.findall("link"))
        if e.find("inertial/mass") is not None and e.find("visual") is not None
    )
    part = ET.Element("link", {"name": "split_part"})
    inertial = copy.deepcopy(find(link, "inertial"))
    for half in (find(link, "inertial"), inertial):
        mass, inertia = find(half, "mass"), find(half, "inertia")
        mass.set("value", repr(float(mass.attrib["value"]) / 2))
        for name, value in inertia.attrib.items():
            inertia.set(name, repr(float(value) / 2))
    part.append(inertial)
    for shape in [*link.findall("visual"), *link.findall("collision")]:
        link.remove(shape)
        part.append(shape)
    joint = ET.fromstring(
        '<joint name="split_joint" type="fixed"><origin xyz="0 0 0" rpy="0 0 0"/>'
        f'<parent link="{link.get("name")}"/><child link="split_part"/></joint>'
    )
    changed.extend((part, joint))
    return changed


def with_extra_frame(robot: Robot) -> Robot:
    """A frame between a fixed link and its parent."""
    changed = copy.deepcopy(robot)
    joint = next((j for j in changed.findall("joint") if j.get("type") == "fixed"), None)
    if joint is None:
        return changed
    parent, origin = find(joint, "parent"), joint.find("origin")
    changed.append(ET.Element("link", {"name": "between"}))
    mount = ET.fromstring(
        f'<joint name="between_joint" type="fixed"><parent link="{parent.get("link")}"/><child link="between"/></joint>'
    )
    if origin is not None:
        mount.append(copy.deepcopy(origin))
        joint.remove(origin)
    parent.set("link", "between")
    changed.append(mount)
    return changed


def with_moved_frames(robot: Robot) -> Robot:
    """Frames of links moved along the axes on which they hang; masses, shapes and children stay, and so do frames at the ends."""
    used = {*_list_inner_links(robot), *(find(joint, "parent").get("link", "") for joint in robot.findall("joint"))}
    for joint in robot.findall("joint"):
        axis = joint.find("axis")
        if axis is None or joint.get("type") not in {"revolute", "continuous"}:
            continue
        if find(joint, "child").get("link", "") not in used:
            continue
        direction = np.array([float(word) for word in axis.attrib["xyz"].split()])
        placement = np.eye(4)
        placement[:3, 3] = 0.037 * direction / np.linalg.norm(direction)
        robot = moved_link(robot, find(joint, "child").get("link", ""), placement)
    return robot


def with_turned_frames(robot: Robot) -> Robot:
    """Frames of links that hang on joints, turned; whatever is given in them stays, and so do the frames at the ends."""
    for link in _list_inner_links(robot):
        robot = rotated_link(robot, link, ASKEW)
    return robot


def with_turned_inertials(robot: Robot) -> Robot:
    """Inertial frames turned, their tensors with them."""
    for link in robot.findall("link"):
        if link.find("inertial") is not None:
            robot = rotated_inertial(robot, link.get("name", ""), ASKEW)
    return robot


def _has_contents(link: ET.Element) -> bool:
    mass = link.find("inertial/mass")
    return any(link.findall(tag) for tag in ("visual", "collision")) or (
        mass is not None and float(mass.get("value", "0")) > 0.0
    )


def _list_inner_links(robot: Robot) -> list[str]:
    """Return the links with mass or shapes that are not the root: a bare frame is what others use."""
    children = {
        find(joint, "child").get("link", "")
        for joint in robot.findall("joint")
        if joint.get("type") not in {"floating", "planar"}  # whose positions are given in the frame of the joint
    }
    return [
        name for link in robot.findall("link") if (name := link.get("name", "")) in children and _has_contents(link)
    ]


def as_macro(robot: Robot) -> Robot:
    """The links come from one macro, called once for each."""
    changed = copy.deepcopy(robot)
    links = changed.findall("link")
    for number, link in enumerate(links):
        macro = ET.Element(f"{{{XACRO}}}macro", {"name": f"part_{number}", "params": "name"})
        place = list(changed).index(link)
        changed.remove(link)
        call = ET.Element(f"{{{XACRO}}}part_{number}", {"name": link.get("name", "")})
        link.set("name", "${name}")
        macro.append(link)
        changed.insert(place, call)
        changed.insert(place, macro)
    return changed


PRESERVING: Mapping[str, Callable[[Robot], Robot]] = {
    "written anew": copy.deepcopy,
    "commented": commented,
    "in another order": reordered,
    "with more digits": written_longer,
    "with fewer digits": with_six_digits,
    "in other angles": with_other_angles,
    "with longer axes": with_longer_axes,
    "without defaults": with_defaults_left_out,
    "inertial frames turned": with_turned_inertials,
    "frames turned and compensated": with_turned_frames,
    "frames moved along their axes": with_moved_frames,
    "with properties": with_properties,
    "with macros": as_macro,
    "a link split": with_split_link,
    "a frame in between": with_extra_frame,
}


def write_robot(robot: Robot) -> str:
    """Return the text of a robot, each element on a line of its own."""
    shown = copy.deepcopy(robot)
    ET.indent(shown)
    return ET.tostring(shown, encoding="unicode") + "\n"
