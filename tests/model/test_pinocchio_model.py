"""Independent oracles: our kinematics against yourdfpy's and Pinocchio's."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import FIXTURES
from real_robots import assert_frames_of_pinocchio

from urdfcheck.model import Model
from urdfcheck.model.motion.pinocchio_model import write_without_geometry
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder


def model_of(path: Path, arguments: dict[str, str] | None = None, roots: tuple[Path, ...] = ()) -> Model | None:
    source = load_source(path, arguments or {}, PackageFinder(path.absolute(), paths=roots))
    return None if source.root is None or source.root.tag != "robot" else Model(source=source, robot=source.root)


def same_frames_as_yourdfpy(model: Model, folder: Path) -> int:
    yourdfpy = pytest.importorskip("yourdfpy")
    path = folder / "model.urdf"
    path.write_text(write_without_geometry(model), encoding="utf-8")
    other = yourdfpy.URDF.load(str(path), load_meshes=False, build_scene_graph=True, load_collision_meshes=False)
    other.update_cfg(np.zeros(other.num_dofs))
    for name, placed in model.frames.items():
        theirs = other.get_transform(name, model.tree.root)
        np.testing.assert_allclose(placed, theirs, atol=1e-9, err_msg=name)
    return len(model.frames)


@pytest.mark.parametrize(
    "path",
    ["car-3/urdf/car-3.urdf", "car-3/robot_description/urdf/car_body.urdf.xacro", "car-3-fixed/urdf/car_3.urdf.xacro"],
)
def test_frames_of_the_fixtures(path: str, tmp_path: Path) -> None:
    model = model_of(FIXTURES / path)
    assert model is not None
    assert same_frames_as_yourdfpy(model, tmp_path) >= 5
    pytest.importorskip("pinocchio")
    assert assert_frames_of_pinocchio(model) >= 5


def test_all_wheels_of_car_3_turn_about_plus_y() -> None:
    """Two axes are written −y in frames turned by π: in base coordinates all four are +y."""
    model = model_of(FIXTURES / "car-3/urdf/car-3.urdf")
    assert model is not None
    for axis in model.axes.values():
        np.testing.assert_allclose(axis, [0, 1, 0], atol=1e-5)
