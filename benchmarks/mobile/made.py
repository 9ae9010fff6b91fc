"""Sound mobile robots that are made: two wheels on balls, two wheels and a caster of meshes, four mecanum wheels, six wheels, and
tracks whose road wheels roll."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from xml.etree import ElementTree as ET

from trimesh import creation

DENSITY = 900.0
DRIVE_YAML = "config/controllers.yaml"


@dataclass(frozen=True, slots=True, kw_only=True)
class MobileRobot:
    """A sound robot, and where its parts are."""

    name: str
    root: ET.Element
    files: Mapping[str, str | bytes] = field(default_factory=dict)
    """By path from the package's folder, without the model itself."""
    left: str
    """The joint of a driven wheel on the left."""
    right: str
    """The joint of its counterpart."""
    casters: tuple[str, ...] = ()
    """Links of the parts that carry the robot and are not driven."""
    base: str = "base_link"
    """The link with the chassis."""


def make_robots() -> tuple[MobileRobot, ...]:
    """Make the five robots."""
    return _make_balls(), _make_caster(), _make_mecanum(), _make_six(), _make_tracks()


def _make_balls() -> MobileRobot:
    body = _Builder("two_wheels_on_balls")
    body.add_base((0.30, 0.24, 0.06), height=0.07)
    for side, y in (("left", 0.14), ("right", -0.14)):
        body.add_wheel(f"{side}_wheel", (0.0, y, 0.05), radius=0.05, width=0.03)
    for end, x in (("front", 0.12), ("rear", -0.12)):
        body.add_ball(f"{end}_caster", (x, 0.0, 0.015), 0.015)
    config = _write_drive("diff_drive_controller/DiffDriveController", {
        "left_wheel_names": '["left_wheel_joint"]', "right_wheel_names": '["right_wheel_joint"]',
        "wheel_separation": "0.28", "wheel_radius": "0.05",
    })  # fmt: skip
    body.add_control(("left_wheel_joint", "right_wheel_joint"))
    body.add_contacts(("left_wheel", "right_wheel"), 1.0)
    body.add_contacts(("front_caster", "rear_caster"), 0.001)
    return body.finish(
        left="left_wheel_joint",
        right="right_wheel_joint",
        casters=("front_caster", "rear_caster"),
        files={DRIVE_YAML: config},
    )


def _make_caster() -> MobileRobot:
    body = _Builder("two_wheels_and_caster")
    body.add_base((0.34, 0.20, 0.08), height=0.09, x=-0.05, mesh=True)
    for side, y in (("left", 0.13), ("right", -0.13)):
        body.add_wheel(f"{side}_wheel", (0.06, y, 0.06), radius=0.06, width=0.025, mesh=True)
    body.add_ball("caster", (-0.16, 0.0, 0.02), 0.02)
    plugin = ET.SubElement(ET.SubElement(body.root, "gazebo"), "plugin")
    plugin.attrib |= {"filename": "gz-sim-diff-drive-system", "name": "gz::sim::systems::DiffDrive"}
    for key, value in (
        ("left_joint", "left_wheel_joint"),
        ("right_joint", "right_wheel_joint"),
        ("wheel_separation", "0.26"),
        ("wheel_radius", "0.06"),
    ):
        ET.SubElement(plugin, key).text = value
    body.add_contacts(("left_wheel", "right_wheel"), 1.0)
    body.add_contacts(("caster",), 0.001)
    return body.finish(left="left_wheel_joint", right="right_wheel_joint", casters=("caster",))


def _make_mecanum() -> MobileRobot:
    body = _Builder("mecanum")
    body.add_base((0.40, 0.26, 0.10), height=0.12)
    names = []
    for end, x in (("front", 0.16), ("rear", -0.16)):
        for side, y in (("left", 0.17), ("right", -0.17)):
            body.add_wheel(f"{end}_{side}_wheel", (x, y, 0.0508), radius=0.0508, width=0.05)
            names.append(f"{end}_{side}_wheel_joint")
    config = _write_drive("mecanum_drive_controller/MecanumDriveController", {
        "front_left_wheel_command_joint_name": names[0], "front_right_wheel_command_joint_name": names[1],
        "rear_left_wheel_command_joint_name": names[2], "rear_right_wheel_command_joint_name": names[3],
        "kinematics.wheels_radius": "0.0508", "kinematics.sum_of_robot_center_projection_on_X_Y_axis": "0.33",
    })  # fmt: skip
    body.add_control(names)
    body.add_contacts([name.removesuffix("_joint") for name in names], 1.0)
    return body.finish(left=names[0], right=names[1], files={DRIVE_YAML: config})


def _make_six() -> MobileRobot:
    body = _Builder("six_wheels")
    body.add_base((0.60, 0.30, 0.12), height=0.15)
    names = []
    for end, x in (("front", 0.24), ("middle", 0.0), ("rear", -0.24)):
        for side, y in (("left", 0.20), ("right", -0.20)):
            body.add_wheel(f"{end}_{side}_wheel", (x, y, 0.09), radius=0.09, width=0.06)
            names.append(f"{end}_{side}_wheel_joint")
    body.add_contacts([name.removesuffix("_joint") for name in names], 1.0)
    return body.finish(left="middle_left_wheel_joint", right="middle_right_wheel_joint")


def _make_tracks() -> MobileRobot:
    body = _Builder("tracks")
    body.add_base((0.50, 0.24, 0.10), height=0.11)
    wheels = []
    for side, y in (("left", 0.18), ("right", -0.18)):
        for i in range(4):
            name = f"{side}_track_wheel_{i + 1}"
            body.add_wheel(name, (0.21 - 0.14 * i, y, 0.06), radius=0.06, width=0.05)
            wheels.append(name)
    config = _write_drive("diff_drive_controller/DiffDriveController", {
        "left_wheel_names": f"[{', '.join(f'{name}_joint' for name in wheels[:4])}]",
        "right_wheel_names": f"[{', '.join(f'{name}_joint' for name in wheels[4:])}]",
        "wheel_separation": "0.36", "wheel_radius": "0.06",
    })  # fmt: skip
    body.add_control([f"{name}_joint" for name in wheels])
    body.add_contacts(wheels, 0.8)
    return body.finish(left="left_track_wheel_2_joint", right="right_track_wheel_2_joint", files={DRIVE_YAML: config})


class _Builder:
    """A robot that is put together: lengths in m, everything of one density."""

    def __init__(self, name: str) -> None:
        self.root = ET.Element("robot", {"name": name})
        self.files: dict[str, str | bytes] = {}
        ET.SubElement(self.root, "link", {"name": "base_footprint"})

    def add_base(self, size: tuple[float, float, float], *, height: float, x: float = 0.0, mesh: bool = False) -> None:
        a, b, c = size
        mass = 300.0 * a * b * c
        moments = (mass * (b * b + c * c) / 12, mass * (a * a + c * c) / 12, mass * (a * a + b * b) / 12)
        self._add_mesh("chassis", creation.box(size), mesh=mesh)
        shape = self._write_mesh("chassis") if mesh else f'<box size="{a} {b} {c}"/>'
        self._add_link("base_link", shape, mass, moments, at=f"{x} 0 0", box=f'<box size="{a} {b} {c}"/>')
        self._add_joint("base_joint", "base_footprint", "base_link", "fixed", (0.0, 0.0, height))
        self.height = height

    def add_wheel(
        self, name: str, place: tuple[float, float, float], *, radius: float, width: float, mesh: bool = False
    ) -> None:
        mass = DENSITY * math.pi * radius**2 * width
        across = mass * (3 * radius**2 + width**2) / 12
        self._add_mesh("wheel", creation.cylinder(radius, width, sections=96), mesh=mesh)
        cylinder = f'<cylinder radius="{radius}" length="{width}"/>'
        shape = self._write_mesh("wheel") if mesh else cylinder
        turn = f"{math.pi / 2!r} 0 0"
        # The tensor is that of the turned solid: its axis along y.
        moments = (across, mass * radius**2 / 2, across)
        self._add_link(name, shape, mass, moments, turn=turn, box=cylinder)
        x, y, z = place
        joint = self._add_joint(f"{name}_joint", "base_link", name, "continuous", (x, y, round(z - self.height, 9)))
        ET.SubElement(joint, "axis", {"xyz": "0 1 0"})

    def add_ball(self, name: str, place: tuple[float, float, float], radius: float) -> None:
        mass = DENSITY * 4 / 3 * math.pi * radius**3
        shape = f'<sphere radius="{radius}"/>'
        self._add_link(name, shape, mass, (0.4 * mass * radius**2,) * 3, box=shape)
        x, y, z = place
        self._add_joint(f"{name}_joint", "base_link", name, "fixed", (x, y, round(z - self.height, 9)))

    def add_control(self, joints: Sequence[str]) -> None:
        block = ET.SubElement(self.root, "ros2_control", {"name": "drive", "type": "system"})
        hardware = ET.SubElement(block, "hardware")
        ET.SubElement(hardware, "plugin").text = "gz_ros2_control/GazeboSimSystem"
        for name in joints:
            joint = ET.SubElement(block, "joint", {"name": name})
            ET.SubElement(joint, "command_interface", {"name": "velocity"})
            for state in ("position", "velocity"):
                ET.SubElement(joint, "state_interface", {"name": state})
        plugin = ET.SubElement(ET.SubElement(self.root, "gazebo"), "plugin")
        plugin.attrib |= {"filename": "gz_ros2_control-system", "name": "gz_ros2_control::GazeboSimROS2ControlPlugin"}
        ET.SubElement(plugin, "parameters").text = f"$(find robot_description)/{DRIVE_YAML}"

    def add_contacts(self, links: Sequence[str], friction: float) -> None:
        for name in links:
            block = ET.SubElement(self.root, "gazebo", {"reference": name})
            for key, value in (("mu1", friction), ("mu2", friction), ("minDepth", 0.001), ("kp", 1e6), ("kd", 100)):
                ET.SubElement(block, key).text = f"{value:g}"

    def finish(
        self, *, left: str, right: str, casters: tuple[str, ...] = (), files: Mapping[str, str] | None = None
    ) -> MobileRobot:
        manifest = (
            '<package format="3"><name>robot_description</name><version>1.0.0</version><description>A robot.</description>'
            '<maintainer email="a@example.org">A</maintainer><license>MIT</license></package>'
        )
        return MobileRobot(
            name=self.root.get("name", ""),
            root=self.root,
            files={"package.xml": manifest, **self.files, **(files or {})},
            left=left,
            right=right,
            casters=casters,
        )

    def _add_mesh(self, name: str, solid: object, *, mesh: bool) -> None:
        if mesh:
            stream = io.BytesIO()
            solid.export(stream, file_type="stl")  # type: ignore[attr-defined]
            self.files[f"meshes/{name}.stl"] = stream.getvalue()

    @staticmethod
    def _write_mesh(name: str) -> str:
        return f'<mesh filename="package://robot_description/meshes/{name}.stl"/>'

    def _add_link(
        self,
        name: str,
        shape: str,
        mass: float,
        moments: tuple[float, ...],
        *,
        at: str = "0 0 0",
        turn: str = "0 0 0",
        box: str,
    ) -> None:
        link = ET.SubElement(self.root, "link", {"name": name})
        inertial = ET.SubElement(link, "inertial")
        ET.SubElement(inertial, "origin", {"xyz": at})
        ET.SubElement(inertial, "mass", {"value": f"{mass:.9g}"})
        tensor = dict.fromkeys(("ixy", "ixz", "iyz"), "0") | {
            key: f"{moment:.9g}" for key, moment in zip(("ixx", "iyy", "izz"), moments, strict=True)
        }
        ET.SubElement(inertial, "inertia", tensor)
        for role, geometry in (("visual", shape), ("collision", box)):
            element = ET.SubElement(link, role)
            ET.SubElement(element, "origin", {"xyz": at, "rpy": turn})
            ET.SubElement(element, "geometry").append(ET.fromstring(geometry))

    def _add_joint(
        self, name: str, parent: str, child: str, kind: str, place: tuple[float, float, float]
    ) -> ET.Element:
        joint = ET.SubElement(self.root, "joint", {"name": name, "type": kind})
        ET.SubElement(joint, "parent", {"link": parent})
        ET.SubElement(joint, "child", {"link": child})
        ET.SubElement(joint, "origin", {"xyz": " ".join(f"{value:g}" for value in place), "rpy": "0 0 0"})
        return joint


def _write_drive(kind: str, parameters: Mapping[str, str]) -> str:
    lines = "\n".join(f"    {key}: {value}" for key, value in parameters.items())
    return (
        "controller_manager:\n  ros__parameters:\n    update_rate: 50\n    drive:\n"
        f"      type: {kind}\ndrive:\n  ros__parameters:\n{lines}\n"
    )
