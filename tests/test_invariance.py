"""A robot is the same robot in other frames, from another root, in other units and under other names, and so are its defects.

A car with two arms and a tool, whose parts are lumpy convex meshes with the inertials that these have, gets one defect at a
time. Whatever is done to its description, the rule finds that defect and no other, for the same cause.
"""

from __future__ import annotations

import struct
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from builders import joint, limit
from conftest import check
from numpy.typing import NDArray
from transforms import Robot, Transformation, each_link, renamed, rerooted, rotated_inertial, rotated_link, scaled

from urdfcheck.facts.inertials.inertia_tensor import Solid, compute_solid_inertia, make_box_solid, make_cylinder_solid
from urdfcheck.facts.mesh.moments import compute_mesh_moments
from urdfcheck.facts.motion.kinematics import rpy_to_matrix
from urdfcheck.rules import load_rules

pytestmark = pytest.mark.slow

Array = NDArray[np.float64]

DENSITY = 1300.0
NAMES = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
MIRROR = np.diag((1.0, -1.0, 1.0))
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
}


def lump(seed: int, size: tuple[float, float, float]) -> tuple[Array, NDArray[np.intp]]:
    """Corners and outward triangles of a convex part without any symmetry, about as large as ``size`` (m)."""
    from scipy.spatial import ConvexHull

    corners = np.random.default_rng(seed).uniform(-0.5, 0.5, (14, 3)) * size + np.array(size) * 0.2
    hull = ConvexHull(corners)
    outward = np.cross(
        corners[hull.simplices[:, 1]] - corners[hull.simplices[:, 0]],
        corners[hull.simplices[:, 2]] - corners[hull.simplices[:, 0]],
    )
    flip = np.einsum("ij,ij->i", outward, hull.equations[:, :3]) < 0
    faces = hull.simplices.astype(np.intp)
    faces[flip] = faces[flip][:, ::-1]
    return corners, faces


def write_stl(path: Path, corners: Array, faces: NDArray[np.intp]) -> None:
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *corners[face].ravel().tolist(), 0) for face in faces)
    path.write_bytes(bytes(80) + struct.pack("<I", len(faces)) + body)


def part(name: str, solid: Solid, geometry: str, rpy: str = "0 0 0", density: float = DENSITY) -> str:
    """A link with a shape and the inertial that it has."""
    mass = float(density * solid.volume)
    turn = rpy_to_matrix([float(word) for word in rpy.split()])
    tensor = turn @ compute_solid_inertia(solid, mass) @ turn.T
    six = " ".join(
        f'{n}="{float(tensor[i, j])!r}"' for n, (i, j) in zip(NAMES, zip(*np.triu_indices(3), strict=True), strict=True)
    )
    com = " ".join(repr(float(v)) for v in turn @ solid.com)
    return (
        f'<link name="{name}"><inertial><origin xyz="{com}" rpy="0 0 0"/><mass value="{mass!r}"/><inertia {six}/></inertial>'
        f'<visual><origin xyz="0 0 0" rpy="{rpy}"/><geometry>{geometry}</geometry></visual></link>'
    )


def lumpy(folder: Path, name: str, seed: int, size: tuple[float, float, float], mirror: bool = False) -> str:
    corners, faces = lump(seed, size)
    if mirror:
        corners, faces = corners @ MIRROR, faces[:, ::-1]
    write_stl(folder / f"{name}.stl", corners, faces)
    found = compute_mesh_moments(corners, faces)
    return part(name, Solid(found.volume, found.com, found.covariance), f'<mesh filename="{name}.stl"/>')


def make_joint_on_base(name: str, child: str, xyz: str, axis: str, kind: str = "continuous", rpy: str = "0 0 0") -> str:
    limits = limit(-1, 1, 5, 2) if kind == "revolute" else ""
    return joint(name, "base", child, limits, kind=kind, xyz=xyz, rpy=rpy, axis=axis)


@pytest.fixture(name="robot")
def make_cart(tmp_path: Path) -> Robot:
    wheel = '<cylinder radius="0.05" length="0.02"/>'
    parts = [part("base", make_box_solid((0.5, 0.25, 0.08)), '<box size="0.5 0.25 0.08"/>', density=500.0)]
    for number, (x, y) in enumerate(((0.2, 0.15), (-0.2, 0.15), (0.2, -0.15), (-0.2, -0.15)), 1):
        parts.append(part(f"wheel_{number}", make_cylinder_solid(0.05, 0.02), wheel, rpy=f"{np.pi / 2!r} 0 0"))
        parts.append(make_joint_on_base(f"axle_{number}", f"wheel_{number}", f"{x} {y} -0.03", "0 1 0"))
    for side, y in (("left", 0.1), ("right", -0.1)):
        parts.append(lumpy(tmp_path, f"{side}_arm", 3, (0.06, 0.05, 0.2), mirror=side == "right"))
        parts.append(make_joint_on_base(f"{side}_shoulder", f"{side}_arm", f"0.1 {y} 0.06", "0 1 0", "revolute"))
    parts.append(lumpy(tmp_path, "tool", 5, (0.12, 0.07, 0.05)))
    parts.append(make_joint_on_base("flange", "tool", "-0.15 0.02 0.07", "0 0 1", "revolute"))
    return ET.fromstring(f'<robot name="cart">{"".join(parts)}</robot>')


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


def verdict(folder: Path, robot: Robot, code: str) -> list[tuple[str, str | None]]:
    """What is found, by severity and cause. A cause of INR004 is how the numbers were typed: it goes with their axes."""
    path = folder / "robot.urdf"
    path.write_text(ET.tostring(robot, encoding="unicode"))
    run = check(path, codes={code})
    assert not run.failures
    return [(str(f.severity), f.cause.id if f.cause and code != "INR004" else None) for f in run.findings]


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
    path = tmp_path / "robot.urdf"
    path.write_text(ET.tostring(TRANSFORMATIONS[transformation](robot), encoding="unicode"))
    codes = {code for code, _ in DEFECTS} & set(load_rules())
    assert not [f.message for f in check(path, codes=codes).findings]
