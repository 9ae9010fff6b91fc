"""urdfcheck repair: the copy is better by its own check, and the model is what it was."""

from __future__ import annotations

import hashlib
import json
import os
import re
from pathlib import Path

import numpy as np
import pytest
import trimesh
from builders import inertial, joint, link, robot
from conftest import command, make_request
from output.documents import read

from urdfcheck.core import UrdfcheckError
from urdfcheck.facts.mesh.measure import measure_mesh
from urdfcheck.fix.repair import plan_inertials
from urdfcheck.fix.repair import repair_model as repair_module
from urdfcheck.fix.repair.copy_sources import CopiedModel
from urdfcheck.fix.repair.mesh_writing import bake_collada, decimate
from urdfcheck.fix.repair.plan_collisions import plan_collisions
from urdfcheck.fix.repair.steps import RepairOptions, RepairStep
from urdfcheck.model import Model
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder

pytestmark = [pytest.mark.slow, pytest.mark.long]

XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
IMPOSSIBLE = inertial(2, ixx=1, iyy=1, izz=9)
COLLADA = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit name="millimeter" meter="0.001"/><up_axis>Y_UP</up_axis></asset>
  <library_geometries><geometry id="g"><mesh>
    <source id="p"><float_array id="a" count="12">0 0 0 100 0 0 0 200 0 0 0 300</float_array>
      <technique_common><accessor source="#a" count="4" stride="3">
        <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
      </accessor></technique_common></source>
    <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
    <triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="s">
    <node><translate>0 0 50</translate><instance_geometry url="#g"/></node>
  </visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
"""
URDF_XACRO = f"""<robot name="cart" {XACRO}>
  <xacro:macro name="wheel" params="name y">
    <link name="${{name}}_wheel">
      {inertial(12.5, ixx=0.135, iyy=0.25, izz=0.135)}
      <visual><geometry><mesh filename="package://cart/meshes/wheel.stl"/></geometry></visual>
      <collision name="tyre">
        <!-- kept -->
        <geometry><mesh filename="package://cart/meshes/${{'wheel'}}.stl"/></geometry>
      </collision>
    </link>
    <joint name="${{name}}" type="continuous">
      <parent link="base"/><child link="${{name}}_wheel"/><origin xyz="0 ${{y}} 0"/><axis xyz="0 1 0"/>
    </joint>
  </xacro:macro>
  <link name="base">
    {IMPOSSIBLE}
    <visual><geometry><mesh filename="package://cart/meshes/body.dae"/></geometry></visual>
    <collision><origin xyz="0 0 0.1"/><geometry><mesh filename="package://cart/meshes/frame.stl"/></geometry></collision>
  </link>
  <xacro:wheel name="left" y="1"/>
  <xacro:wheel name="right" y="-1"/>
</robot>
"""


def make_frame() -> trimesh.Trimesh:
    """An L of two boxes that is closed: a profile pulled along z."""
    corners = [(0, 0), (0.4, 0), (0.4, 0.05), (0.05, 0.05), (0.05, 0.4), (0, 0.4)]
    top = [(x, y, 0.1) for x, y in corners]
    bottom = [(x, y, 0.0) for x, y in corners]
    caps = [(0, 1, 2), (0, 2, 3), (0, 3, 5), (3, 4, 5)]
    around = [(i, (i + 1) % 6) for i in range(6)]
    sides = [face for i, j in around for face in ((i, j, j + 6), (i, j + 6, i + 6))]
    faces = [*sides, *[tuple(c + 6 for c in cap) for cap in caps], *[cap[::-1] for cap in caps]]
    mesh = trimesh.Trimesh(np.array(bottom + top), faces)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(0.1 * (0.4 * 0.05 + 0.35 * 0.05))
    return mesh


def write_package(folder: Path) -> Path:
    package = folder / "src" / "cart"
    (package / "meshes").mkdir(parents=True)
    (package / "urdf").mkdir()
    (package / "package.xml").write_text("<package format='3'><name>cart</name></package>")
    wheel = trimesh.creation.cylinder(radius=0.2, height=0.1, sections=64)
    wheel.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, (1, 0, 0)))
    wheel.export(package / "meshes" / "wheel.stl")
    make_frame().export(package / "meshes" / "frame.stl")
    (package / "meshes" / "body.dae").write_text(COLLADA)
    (package / "meshes" / "paint.png").write_bytes(b"image")
    (package / "unread.dat").write_text("not read")
    model = package / "urdf" / "cart.urdf.xacro"
    model.write_text(URDF_XACRO)
    return model


def digest(folder: Path) -> dict[str, str]:
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def repair(model: Path, out: Path, *words: str) -> tuple[int, dict[str, object]]:
    done = command("repair", str(model), "-o", str(out), "--format", "json", "--isolated", "--no-cache", *words)
    assert done.returncode in {0, 1}, done.stderr
    return done.returncode, json.loads(done.stdout)


def list_steps(document: dict, stage: str) -> dict[str, dict]:
    return {step["subject"]: step for step in document["steps"] if step["stage"] == stage}


@pytest.fixture(scope="module")
def cart(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict, dict[str, str]]:
    """A repaired package: its folder, the document, and what the model was before."""
    folder = tmp_path_factory.mktemp("cart")
    model = write_package(folder)
    before = digest(folder / "src")
    _, document = repair(model, folder / "out", "--report", f"html={folder / 'report.html'}")
    return folder, document, before


def test_the_model_is_not_changed_and_copied_as_far_as_it_is_read(cart: tuple[Path, dict, dict[str, str]]) -> None:
    folder, document, before = cart
    assert digest(folder / "src") == before
    copied = digest(folder / "out")
    assert set(copied) == {name for name in before if name != "cart/unread.dat"}
    assert document["files"] == len(copied)
    assert copied["cart/meshes/wheel.stl"] == before["cart/meshes/wheel.stl"]


def test_collisions_become_primitives_where_these_fit(cart: tuple[Path, dict, dict[str, str]]) -> None:
    folder, document, _ = cart
    steps = list_steps(document, "collision")
    assert steps["left_wheel"]["done"]
    assert steps["right_wheel"]["done"]
    assert steps["left_wheel"]["after"]["volume"] == pytest.approx(np.pi * 0.2**2 * 0.1, rel=1e-3)
    assert not steps["base"]["done"]
    assert "convex hull is" in steps["base"]["text"]
    text = (folder / "out" / "cart" / "urdf" / "cart.urdf.xacro").read_text()
    macro = text[: text.index('<link name="base">')]
    assert '<cylinder radius="0.2" length="0.1"/>' in macro
    assert re.search(r'<collision name="tyre">\s*<!-- kept -->\s*<origin rpy="-?1.57079633 0 0"/><geometry><cyl', macro)
    assert "${name}_wheel" in macro  # xacro stays xacro
    assert text.count("<mesh") == URDF_XACRO.count("<mesh") - 1


def test_an_impossible_inertia_is_computed_from_the_closed_geometry(cart: tuple[Path, dict, dict[str, str]]) -> None:
    folder, document, _ = cart
    assert list(list_steps(document, "inertia")) == ["base"]
    text = (folder / "out" / "cart" / "urdf" / "cart.urdf.xacro").read_text()
    base = text[text.index('<link name="base">') :]
    moments = [float(re.search(rf'{name}="([^"]*)"', base)[1]) for name in ("ixx", "iyy", "izz")]
    # The tetrahedron with the legs 0.1, 0.2 and 0.3 m: its second moment along a leg is 3/80 of its square.
    squares = 2 * 3 / 80 * np.array([0.1, 0.2, 0.3]) ** 2
    assert moments == pytest.approx(
        [squares[1] + squares[2], squares[0] + squares[2], squares[0] + squares[1]], rel=1e-4
    )
    assert "INR003" in document["before"]["codes"]
    assert "INR003" not in document["after"]["codes"]
    assert document["after"]["summary"]["error"] < document["before"]["summary"]["error"]


def test_collada_is_written_in_metres(cart: tuple[Path, dict, dict[str, str]]) -> None:
    folder, document, _ = cart
    assert [step["done"] for step in document["steps"] if step["stage"] == "meshes"] == [True]
    baked = measure_mesh((folder / "out" / "cart" / "meshes" / "body.dae").read_bytes(), "dae", {})
    assert (baked.unit, baked.up_axis) == (1.0, "Z_UP")
    assert baked.bounds == pytest.approx(np.array([[0, 0, 0.05], [0.1, 0.2, 0.35]]))


def test_the_report_shows_the_model_before_and_after(cart: tuple[Path, dict, dict[str, str]]) -> None:
    folder, document, _ = cart
    page = read((folder / "report.html").read_text(encoding="utf-8"))
    assert f"{len(document['steps'])} left as it was" not in page.text
    for step in document["steps"]:
        assert step["text"] in page.text
    assert "Findings that are gone" in page.text
    assert "New findings" not in page.text
    assert "link base COM moves by" in page.text


def test_y_up_can_be_put_upright() -> None:
    upright = bake_collada(COLLADA.encode(), unit=0.001, up_axis="Y_UP", upright=True)
    assert upright is not None
    assert measure_mesh(upright, "dae", {}).bounds == pytest.approx(
        np.array([[0, -0.35, 0], [0.1, -0.05, 0.2]]), abs=1e-6
    )
    assert bake_collada(b"<COLLADA>", unit=0.001, up_axis="Y_UP", upright=True) is None
    assert bake_collada(b"<COLLADA><asset/></COLLADA>", unit=0.001, up_axis="Y_UP", upright=True) is None


def test_entities_of_a_collada_file_are_not_resolved(tmp_path: Path) -> None:
    secret = tmp_path / "secret"
    secret.write_text("SECRET")
    hostile = COLLADA.replace("<COLLADA", f'<!DOCTYPE x [<!ENTITY e SYSTEM "{secret.as_uri()}">]><COLLADA', 1)
    hostile = hostile.replace("<translate>0 0 50", "<translate>&e;0 0 50")
    baked = bake_collada(hostile.encode(), unit=0.001, up_axis="Z_UP", upright=False)
    assert baked is None or b"SECRET" not in baked


def test_a_concave_part_becomes_convex_parts(tmp_path: Path) -> None:
    pytest.importorskip("coacd")
    model = write_package(tmp_path)
    _, document = repair(model, tmp_path / "out", "--collision", "convex", "--inertia", "none", "--meshes", "none")
    step = list_steps(document, "collision")["base"]
    assert step["done"], step
    assert step["after"]["shapes"] >= 2
    assert step["after"]["volume"] == pytest.approx(make_frame().volume, rel=0.1)
    parts = [Path(os.getcwd(), name) for name in step["files"]]
    assert all(trimesh.load(part).is_convex for part in parts)
    text = (tmp_path / "out" / "cart" / "urdf" / "cart.urdf.xacro").read_text()
    assert text.count("frame_convex_") == len(parts)
    assert text.count('<origin xyz="0 0 0.1"/>') == len(parts)


def test_a_heavy_mesh_is_decimated_and_its_macro_stays(tmp_path: Path) -> None:
    pytest.importorskip("fast_simplification")
    model = write_package(tmp_path)
    ball = trimesh.creation.icosphere(subdivisions=6, radius=0.2)
    ball.export(model.parent.parent / "meshes" / "wheel.stl")
    _, document = repair(model, tmp_path / "out", "--collision", "decimate", "--triangles", "500", "--inertia", "none")
    assert list_steps(document, "collision")["left_wheel"]["after"]["triangles"] <= 500
    small = trimesh.load(tmp_path / "out" / "cart" / "meshes" / "wheel_collision.stl")
    assert len(small.faces) <= 500
    assert small.extents == pytest.approx([0.4, 0.4, 0.4], rel=0.02)
    assert "MSH009" in document["before"]["codes"]
    assert "MSH009" not in document["after"]["codes"]
    assert "${'wheel'}_collision.stl" in (tmp_path / "out" / "cart" / "urdf" / "cart.urdf.xacro").read_text()


def test_what_is_left_when_half_of_the_time_is_over_stays_as_it_is(tmp_path: Path) -> None:
    path = write_package(tmp_path)
    source = load_source(path, {}, PackageFinder(path, {}, [tmp_path]))
    assert source.root is not None
    steps = list(
        plan_collisions(Model(source=source, robot=source.root), RepairOptions(collision="convex"), seconds=1e-9)
    )
    assert {step.subject for step in steps} >= {"base", "left_wheel"}
    assert all("the others took half of the time" in step.text and not step.is_done for step in steps)


def test_far_from_the_origin_a_mesh_keeps_its_shape() -> None:
    pytest.importorskip("fast_simplification")
    ball = trimesh.creation.icosphere(subdivisions=4, radius=0.01)
    points, faces = decimate(ball.vertices + np.array((1000, 0, 0)), ball.faces, 200)
    assert len(faces) <= 200
    assert np.ptp(points, axis=0) == pytest.approx([0.02, 0.02, 0.02], rel=0.05)


def test_without_a_library_the_command_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    model = write_package(tmp_path)
    monkeypatch.setitem(__import__("sys").modules, "coacd", None)
    monkeypatch.setitem(__import__("sys").modules, "fast_simplification", None)
    done = command("repair", str(model), "-o", str(tmp_path / "out"), "--collision", "convex", "--isolated")
    assert done.returncode == 2
    assert "pip install 'urdfcheck[repair]'" in done.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.smoke
def test_a_stated_density_gives_the_mass_and_links_without_an_inertial_get_one(tmp_path: Path) -> None:
    model = tmp_path / "model" / "r.urdf"
    model.parent.mkdir()
    block = '<visual><geometry><box size="0.1 0.1 0.1"/></geometry></visual>'
    arm = joint("j", "base", "arm", kind="continuous", axis="0 0 1", xyz="0 0 1")
    model.write_text(
        robot(
            link("base", inertial(1, 0.002), block),
            link("arm", block),
            '<link name="tip"/>',
            arm,
            joint("k", "arm", "tip"),
        )
    )
    _, document = repair(model, tmp_path / "out", "--density", "2700", "--inertia", "all")
    steps = list_steps(document, "inertia")
    assert steps["arm"]["after"]["mass"] == pytest.approx(2.7)
    assert steps["base"]["after"]["mass"] == pytest.approx(2.7)
    assert not steps["tip"]["done"]
    text = (tmp_path / "out" / "r.urdf").read_text()
    assert text.count('<mass value="2.7"/>') == 2
    assert text.count('ixx="0.0045"') == 2


@pytest.mark.parametrize(
    ("densest", "says"), [(1e6, "withdrawn: with it the model has INR"), (None, "would have 2e+05 kg/m³")]
)
def test_what_makes_the_model_worse_is_withdrawn(
    densest: float | None, says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nothing is as dense as this: no such inertial is computed, and if it were, INR010 would report it."""
    if densest is not None:
        monkeypatch.setattr(plan_inertials, "_DENSEST", densest)
    model = tmp_path / "model" / "r.urdf"
    model.parent.mkdir()
    block = '<visual><geometry><box size="0.1 0.1 0.1"/></geometry></visual>'
    arm = joint("j", "base", "arm", kind="continuous", axis="0 0 1", xyz="0 0 1")
    model.write_text(robot(link("base", block, inertial(2.7, 0.0045)), link("arm", block, inertial(2.7, 0.0045)), arm))
    _, document = repair(model, tmp_path / "out", "--density", "200000", "--inertia", "all")
    assert not any(step["done"] for step in document["steps"])
    assert all(says in step["text"] for step in document["steps"]), document["steps"]
    assert all(step["withdrawn"] == (densest is not None) for step in document["steps"])
    assert document["after"] == document["before"]
    assert (tmp_path / "out" / "r.urdf").read_text() == model.read_text()


def test_a_package_without_a_manifest_is_found_by_its_folder(tmp_path: Path) -> None:
    model = tmp_path / "all" / "arm" / "urdf" / "r.urdf"
    model.parent.mkdir(parents=True)
    (model.parent.parent / "meshes").mkdir()
    trimesh.creation.box((0.3, 0.2, 0.1)).export(model.parent.parent / "meshes" / "arm.stl")
    shape = '<collision><geometry><mesh filename="package://arm/meshes/arm.stl"/></geometry></collision>'
    model.write_text(robot(link("base", shape)))
    _, document = repair(model, tmp_path / "out", "--package-path", str(tmp_path / "all"))
    assert list_steps(document, "collision")["base"]["done"]
    assert set(digest(tmp_path / "out")) == {"arm/urdf/r.urdf", "arm/meshes/arm.stl"}


@pytest.mark.parametrize("size", [2000, 300])
def test_a_mesh_in_millimetres_gets_its_scale_where_no_other_unit_fits(size: int, tmp_path: Path) -> None:
    """0.3 m or 3 m both fit a robot of 0.5 m: then its mesh is left as it is, and no box of 300 m hides the mistake."""
    model = tmp_path / "model" / "r.urdf"
    model.parent.mkdir()
    trimesh.creation.box((size, 200, 100)).export(model.parent / "arm.stl")
    shape = "<geometry><mesh filename='arm.stl'/></geometry>"
    arm = link("arm", inertial(6, ixx=0.025, iyy=2, izz=2), f"<visual>{shape}</visual><collision>{shape}</collision>")
    hinge = joint("j", "base", "arm", kind="continuous", axis="0 0 1", xyz="0 0 0.5")
    model.write_text(robot(link("base"), arm, hinge))
    _, document = repair(model, tmp_path / "out")
    assert "MSH008" in document["before"]["codes"]
    text = (tmp_path / "out" / "r.urdf").read_text()
    if size == 300:
        assert text == model.read_text()
        assert "scale of its mesh is wrong" in list_steps(document, "collision")["arm"]["text"]
    else:
        assert "MSH008" not in document["after"]["codes"], document["steps"]
        assert text.count('scale="0.001 0.001 0.001"') == 1
        assert '<box size="2 0.2 0.1"/>' in text


# -- where it may write -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("out", "says"),
    [
        ("full", "it is not empty"),
        ("src/cart", "the model is there"),
        ("src/cart/repaired", "the model is there"),
        ("src", "the model is there"),
        ("file", "it is a file"),
        ("file/below", "cannot write"),
    ],
)
def test_only_a_new_or_empty_folder_is_written_to(out: str, says: str, tmp_path: Path) -> None:
    model = write_package(tmp_path)
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine").write_text("mine")
    (tmp_path / "file").write_text("mine")
    before = digest(tmp_path)
    done = command("repair", str(model), "-o", str(tmp_path / out), "--isolated")
    assert done.returncode == 2
    assert says in done.stderr
    assert digest(tmp_path) == before


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_is_read_only_is_an_error(tmp_path: Path) -> None:
    model = write_package(tmp_path)
    (tmp_path / "shut").mkdir(mode=0o500)
    done = command("repair", str(model), "-o", str(tmp_path / "shut" / "out"), "--isolated")
    assert done.returncode == 2
    assert "cannot write" in done.stderr


def test_a_model_whose_files_are_read_only_is_repaired_in_the_copy(tmp_path: Path) -> None:
    model = write_package(tmp_path)
    for path in (tmp_path / "src").rglob("*.*"):
        path.chmod(0o444)
    _, document = repair(model, tmp_path / "out")
    assert "INR003" not in document["after"]["codes"]


def test_a_step_of_a_worker_writes_nothing_outside_the_copy(tmp_path: Path) -> None:
    copy, outside = tmp_path / "out", tmp_path / "outside"
    copy.mkdir()
    copied = CopiedModel(model=copy / "r.urdf", folder=copy, files=1, packages={})
    (copy / "link").symlink_to(outside)
    for name in (outside, copy / ".." / "outside", copy / "link"):
        step = RepairStep(stage="meshes", subject="", text="", files={str(copy / "a"): b"a", str(name): b"x"})
        with pytest.raises(UrdfcheckError, match="outside the copy"):
            repair_module._write_steps(make_request(copy), copied, [step])
        assert not outside.exists()
        assert not (copy / "a").exists()  # and what was written is taken back


# -- meshes that are no bodies --------------------------------------------------------------------------------------------


def write_bad_meshes(folder: Path) -> dict[str, str]:
    """Meshes by the name of their link, with a word of what is said about them; an empty one for nothing."""
    flat = trimesh.Trimesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    flat.export(folder / "flat.stl")
    fin = trimesh.creation.box((0.1, 0.1, 0.1))
    fin = trimesh.util.concatenate(
        fin, trimesh.Trimesh([(0.05, 0.05, 0.05), (0.05, 0.05, -0.05), (0.3, 0.3, 0)], [(0, 1, 2)])
    )
    fin.export(folder / "fin.stl")
    (folder / "empty.stl").write_bytes(b"")
    (folder / "cut.stl").write_bytes(b"\0" * 80 + (2**31).to_bytes(4, "little") + b"\0" * 50)
    return {"flat": "flat", "fin": "kept", "empty": "", "cut": "", "missing": ""}


@pytest.mark.parametrize("way", ["primitives", "convex", "decimate"])
def test_meshes_that_are_no_bodies_are_left_as_they_are(way: str, tmp_path: Path) -> None:
    if way != "primitives":
        pytest.importorskip("coacd")
    folder = tmp_path / "model"
    folder.mkdir()
    words = write_bad_meshes(folder)
    links = [link(name, f'<collision><geometry><mesh filename="{name}.stl"/></geometry></collision>') for name in words]
    (folder / "r.urdf").write_text(robot(*links, *(joint(f"j_{n}", "flat", n) for n in words if n != "flat")))
    code, document = repair(folder / "r.urdf", tmp_path / "out", "--collision", way)
    assert code == 1  # the missing mesh is still missing
    steps = list_steps(document, "collision")
    assert set(steps) <= {"flat", "fin"}
    assert not steps["flat"]["done"]
    assert "missing.stl" in (tmp_path / "out" / "r.urdf").read_text()


def test_what_cannot_be_read_is_not_copied(tmp_path: Path) -> None:
    model = tmp_path / "model" / "r.urdf"
    model.parent.mkdir()
    model.write_text('<robot name="r"><link name="a">')
    done = command("repair", str(model), "-o", str(tmp_path / "out"), "--isolated")
    assert done.returncode == 2
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (("--density", "0"), "--density 0"),
        (("--density", "nan"), "--density nan"),
        (("--triangles", "3"), "at least 4"),
        (("--max-excess", "-1"), "--max-excess -1"),
        (("--report", "html=pages/"), "--report html=pages/: a comparison is one page"),
        (
            ("--report", "json=report.json"),
            "--report json=report.json: write FORMAT=FILE with one of the formats html, png",
        ),
    ],
)
def test_options_that_make_no_sense_are_refused(words: tuple[str, ...], says: str, tmp_path: Path) -> None:
    done = command("repair", str(tmp_path), "-o", str(tmp_path / "out"), *words)
    assert done.returncode == 2
    assert not (tmp_path / "out").exists()
    assert says in done.stderr
