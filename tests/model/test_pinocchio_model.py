"""Independent oracles: our kinematics against yourdfpy's and Pinocchio's."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from builders import inertial, joint, limit, link, robot
from conftest import FIXTURES
from hypothesis import given
from hypothesis import strategies as st
from real_robots import assert_frames_of_pinocchio

from urdfcheck.model import Model
from urdfcheck.model.motion import pinocchio_model as pinocchio_model_module
from urdfcheck.model.motion.pinocchio_model import parser_verdict, write_without_geometry
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.source.text.values import MAX_MAGNITUDE, is_computable
from urdfcheck.system.array_cache import ArrayCache


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


number = st.one_of(st.just(0.0), st.floats(-MAX_MAGNITUDE, MAX_MAGNITUDE), st.floats(-10, 10)).filter(is_computable)
numbers = st.lists(number, min_size=13, max_size=13)


def model_with_inertials(folder: Path, values: list[float], *, kind: str = "revolute", upper: float = 1) -> Model:
    mass, x, y, z, roll, pitch, yaw, *tensor = values
    terms = dict(zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), tensor, strict=True))
    declared = inertial(mass, com=f"{x} {y} {z}", rpy=f"{roll} {pitch} {yaw}", **terms)
    text = robot(link("base", declared), link("arm", declared), joint("j", "base", "arm", limit(0, upper), kind=kind))
    (folder / "r.urdf").write_text(text, encoding="utf-8")
    source = load_source(folder / "r.urdf", {}, PackageFinder(folder))
    assert source.root is not None
    return Model(source=source, robot=source.root, cache=ArrayCache(folder / "cache"))


@given(numbers, st.sampled_from(["continuous", "prismatic", "fixed", "floating", "planar", "revolute"]))
def test_parsers_report_nothing_about_the_size_of_inertial_numbers(values: list[float], kind: str) -> None:
    """That is why a verdict is kept for all models that differ in such numbers only."""
    pytest.importorskip("pinocchio")
    with TemporaryDirectory() as folder:
        models = [
            model_with_inertials(Path(folder, str(turn)), other, kind=kind)
            for turn, other in enumerate((values, [0.0] * 13))
            if not Path(folder, str(turn)).mkdir()
        ]
        first, second = map(parser_verdict, models)
    assert first == second


def test_a_known_verdict_needs_no_pinocchio(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a changed mass, as long as it is a number; any other change is asked about."""
    pytest.importorskip("pinocchio")
    asked = []
    load = pinocchio_model_module.pinocchio_model
    monkeypatch.setattr(pinocchio_model_module, "pinocchio_model", lambda model: asked.append(model) or load(model))

    def judge(mass: float, upper: float) -> tuple[str | None, int]:
        verdict = parser_verdict(model_with_inertials(tmp_path, [mass, *[0.1] * 12], upper=upper))
        return verdict.refused_by, len(asked)

    assert judge(1.0, 2.0) == (None, 1)
    assert judge(3.5, 2.0) == (None, 1)
    assert judge(3.5, 2.5) == (None, 2)
    assert judge(3.5, -2.0)[1] == 3
