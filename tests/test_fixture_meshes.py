"""The meshes of fixtures/car-3 are the solids that the inertials in its URDF were computed from."""

from __future__ import annotations

import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest
import trimesh

FIXTURES = Path(__file__).parents[1] / "fixtures"
CAR = FIXTURES / "car-3"
DENSITY = 1000.0  # kg/m3: the author assigned no material, so the CAD program used its default
TOLERANCE = 1e-6  # relative; binary STL keeps 6e-8 of each coordinate, which is 2e-7 of a moment of inertia

Array = npt.NDArray[np.float64]
LINKS = {link.get("name", ""): link for link in ET.parse(CAR / "urdf" / "car-3.urdf").getroot().iter("link")}


def typed(link: ET.Element) -> tuple[float, Array, Array]:
    """Mass, COM (3,) and inertia tensor (3, 3) of a link; as in the tensor, Ixy is -integral of x y dm."""
    origin, mass, inertia = (link.find(f"inertial/{tag}") for tag in ("origin", "mass", "inertia"))
    assert origin is not None
    assert mass is not None
    assert inertia is not None
    assert origin.get("rpy") == "0 0 0"  # link frame, inertial frame and mesh frame are parallel
    i = {key: float(value) for key, value in inertia.items()}
    tensor = [[i["ixx"], i["ixy"], i["ixz"]], [i["ixy"], i["iyy"], i["iyz"]], [i["ixz"], i["iyz"], i["izz"]]]
    return float(mass.get("value", "")), np.array(origin.get("xyz", "").split(), dtype=float), np.array(tensor)


def load(link_name: str) -> trimesh.Trimesh:
    mesh = trimesh.load_mesh(CAR / "meshes" / f"{link_name}.STL")
    assert isinstance(mesh, trimesh.Trimesh)
    mesh.density = DENSITY
    return mesh


def test_the_car_has_one_mesh_per_link() -> None:
    assert list(LINKS) == ["base_link", "wheel_1", "wheel_2", "wheel_3", "wheel_4"]
    assert sorted(LINKS) == sorted(path.stem for path in (CAR / "meshes").iterdir())


@pytest.mark.parametrize("link_name", LINKS)
def test_each_mesh_is_one_closed_solid(link_name: str) -> None:
    mesh = load(link_name)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.body_count == 1
    assert mesh.euler_number == 2  # no handle, no internal wall
    assert mesh.volume > 0  # normals point outwards


@pytest.mark.parametrize("link_name", LINKS)
def test_each_mesh_reproduces_the_inertial_typed_for_its_link(link_name: str) -> None:
    mesh = load(link_name)
    mass, com, tensor = typed(LINKS[link_name])
    size = float(np.max(mesh.extents))
    largest_moment = float(np.max(np.linalg.eigvalsh(tensor)))

    assert abs(mesh.mass - mass) < TOLERANCE * mass
    assert np.max(np.abs(mesh.center_mass - com)) < TOLERANCE * size
    assert np.max(np.abs(mesh.moment_inertia - tensor)) < TOLERANCE * largest_moment


@pytest.mark.parametrize("link_name", [name for name in LINKS if name.startswith("wheel")])
def test_the_marker_gives_the_product_of_inertia_its_sign(link_name: str) -> None:
    """Its boss at +x, +y makes the integral of x y dm positive, so a correct Ixy is negative, and by this much."""
    _, _, tensor = typed(LINKS[link_name])
    assert tensor[0, 1] < 0
    assert load(link_name).moment_inertia[0, 1] == pytest.approx(tensor[0, 1], rel=1e-5)


def test_the_four_wheels_are_the_same_file() -> None:
    assert len({(CAR / "meshes" / f"wheel_{n}.STL").read_bytes() for n in (1, 2, 3, 4)}) == 1


def test_the_script_reproduces_the_committed_meshes() -> None:
    run = subprocess.run(
        [sys.executable, FIXTURES / "make_car3_meshes.py", "--check"], capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stdout + run.stderr
