"""A sound robot of lumpy parts, each with the inertial that it has."""

from __future__ import annotations

import struct
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
from builders import joint, limit
from numpy.typing import NDArray
from transforms import Robot

from urdfcheck.facts.inertials.inertia_tensor import Solid, compute_solid_inertia, make_box_solid, make_cylinder_solid
from urdfcheck.facts.mesh.moments import compute_mesh_moments
from urdfcheck.facts.motion.kinematics import rpy_to_matrix

Array = NDArray[np.float64]

DENSITY = 1300.0
NAMES = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
MIRROR = np.diag((1.0, -1.0, 1.0))


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


def make_cart(folder: Path) -> Robot:
    """A cart with four wheels, two arms that mirror each other, and a tool; its meshes are written into the folder."""
    wheel = '<cylinder radius="0.05" length="0.02"/>'
    parts = [part("base", make_box_solid((0.5, 0.25, 0.08)), '<box size="0.5 0.25 0.08"/>', density=500.0)]
    for number, (x, y) in enumerate(((0.2, 0.15), (-0.2, 0.15), (0.2, -0.15), (-0.2, -0.15)), 1):
        parts.append(part(f"wheel_{number}", make_cylinder_solid(0.05, 0.02), wheel, rpy=f"{np.pi / 2!r} 0 0"))
        parts.append(make_joint_on_base(f"axle_{number}", f"wheel_{number}", f"{x} {y} -0.03", "0 1 0"))
    for side, y in (("left", 0.1), ("right", -0.1)):
        parts.append(lumpy(folder, f"{side}_arm", 3, (0.06, 0.05, 0.2), mirror=side == "right"))
        parts.append(make_joint_on_base(f"{side}_shoulder", f"{side}_arm", f"0.1 {y} 0.06", "0 1 0", "revolute"))
    parts.append(lumpy(folder, "tool", 5, (0.12, 0.07, 0.05)))
    parts.append(make_joint_on_base("flange", "tool", "-0.15 0.02 0.07", "0 0 1", "revolute"))
    return ET.fromstring(f'<robot name="cart">{"".join(parts)}</robot>')
