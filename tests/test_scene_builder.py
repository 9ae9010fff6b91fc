"""The scene of a model, and the numbers that the robot in 3D is drawn from: equal to what numpy says of the same file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from conftest import FIXTURES, check, check_text, command
from output.runs import finding, make_joint, make_link, scene

from urdfcheck.core import Location, Run
from urdfcheck.core.scene import Scene, SceneOverlap
from urdfcheck.facts.mesh.codec import PackedMesh, unpack_mesh
from urdfcheck.facts.motion.kinematics import rpy_to_matrix
from urdfcheck.output.html.report_parts import collect_report_parts
from urdfcheck.output.html.viewer.scene_data import build_scene_data
from urdfcheck.output.shared.anchors import build_finding_cards

ARM = """<robot name="arm">
  <material name="blue"><color rgba="0 0 1 1"/></material>
  <link name="base">
    <visual><geometry><box size="0.1 0.1 0.1"/></geometry><material name="blue"/></visual>
    <collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision>
  </link>
  <link name="rod">
    <inertial>
      <origin xyz="0.1 0 0" rpy="0.3 -0.4 0.5"/><mass value="2"/>
      <inertia ixx="0.02" ixy="0.001" ixz="0" iyy="0.03" iyz="-0.002" izz="0.04"/>
    </inertial>
  </link>
  <link name="tip"><inertial><mass value="1"/><inertia ixx="1.0" ixy="0" ixz="0" iyy="1.0" iyz="0" izz="3.0"/></inertial></link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="rod"/><origin xyz="0 0 0.1" rpy="0 0.2 0"/><axis xyz="0 3 4"/>
    <limit lower="0.5" upper="2" effort="10" velocity="1"/><dynamics damping="0.1"/>
  </joint>
  <joint name="wrist" type="continuous">
    <parent link="rod"/><child link="tip"/><axis xyz="0 0 1"/><mimic joint="shoulder" multiplier="-2" offset="0.1"/>
  </joint>
</robot>"""


@pytest.fixture(name="arm", scope="module")
def check_arm(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return check_text(tmp_path_factory.mktemp("arm"), ARM, scene=True)


@pytest.fixture(scope="module")
def car() -> Run:
    return check(FIXTURES / "car-3" / "urdf" / "car-3.urdf", scene=True)


def data_of(run: Run) -> tuple[dict, bytes]:
    return build_scene_data(
        [(p.id, p.title, p.scene, p.cards) for p in collect_report_parts(run) if p.scene is not None]
    )


def test_the_equivalent_box_has_the_inertia_of_the_link_with_its_rotated_frame(arm):
    (model,) = data_of(arm)[0]["models"]
    rod = model["links"][1]
    at = np.array(rod["inertia"]["at"]).reshape(4, 4)
    a, b, c = rod["inertia"]["box"]
    turn = at[:3, :3]
    of_box = rod["mass"] / 12 * np.diag((b * b + c * c, a * a + c * c, a * a + b * b))
    typed = np.array([[0.02, 0.001, 0.0], [0.001, 0.03, -0.002], [0.0, -0.002, 0.04]])
    frame = rpy_to_matrix((0.3, -0.4, 0.5))
    assert turn @ of_box @ turn.T == pytest.approx(frame @ typed @ frame.T, rel=1e-5)
    assert np.linalg.det(turn) == pytest.approx(1.0, abs=1e-6)
    assert at[:3, 3] == pytest.approx((0.1, 0.0, 0.0))
    # The ellipsoid of the same mass and moments: I1 = m (y² + z²) / 5.
    x, y, z = rod["inertia"]["ellipsoid"]
    moments = rod["mass"] / 5 * np.array((y * y + z * z, z * z + x * x, x * x + y * y))
    assert moments == pytest.approx(rod["inertia"]["principal"], rel=1e-5)


def test_an_impossible_inertia_says_why_and_has_no_box(arm):
    (model,) = data_of(arm)[0]["models"]
    tip = model["links"][2]["inertia"]
    assert "1 + 1 < 3" in tip["impossible"]
    assert "box" not in tip


def test_joints_start_within_their_limits_and_followers_know_their_leader(arm):
    (model,) = data_of(arm)[0]["models"]
    shoulder, wrist = model["joints"]
    assert (shoulder["lower"], shoulder["upper"], shoulder["start"]) == (0.5, 2, 0.5)
    assert shoulder["axis"] == pytest.approx((0.0, 0.6, 0.8))
    assert np.array(shoulder["at"]).reshape(4, 4)[:3, :3] == pytest.approx(rpy_to_matrix((0, 0.2, 0)), abs=1e-6)
    assert (wrist["mimic"], wrist["lower"]) == ({"joint": "shoulder", "multiplier": -2, "offset": 0.1}, None)


def test_colours_come_from_the_robots_own_materials(arm):
    (model,) = data_of(arm)[0]["models"]
    assert model["links"][0]["visual"][0]["color"] == [0, 0, 1, 1]
    assert model["links"][0]["collision"][0]["color"] is None


def test_a_broken_tree_still_has_its_links(tmp_path):
    run = check_text(tmp_path, '<robot name="r"><link name="a"/><link name="b"/></robot>', scene=True)
    (model,) = data_of(run)[0]["models"]
    assert [(link["name"], link["at"]) for link in model["links"]] == [("a", None), ("b", None)]


def test_what_is_too_large_for_a_graphics_card_is_not_drawn(car):
    shown = replace(car.scenes[0].links[0].shapes[0], kind="mesh", file=0)
    boxes = [replace(shown, kind="box", file=None, size=(size, 1.0, 1.0)) for size in (2.0, 1e10)]
    meshes = [replace(shown, size=(size, 1.0, 1.0)) for size in (1.0, 1e12)]
    links = (replace(car.scenes[0].links[0], shapes=(*boxes, *meshes)),)
    data, _ = data_of(replace(car, scenes=(replace(car.scenes[0], links=links),)))
    drawn = [shape for shape in data["models"][0]["links"][0]["visual"] if shape.get("box") or "mesh" in shape]
    assert [shape.get("box") or shape["scale"] for shape in drawn] == [[2, 1, 1], [1, 1, 1]]


def test_the_meshes_of_the_page_are_those_of_the_files(car):
    data, geometry = data_of(car)
    (scene,) = car.scenes
    assert len(data["meshes"]) == len({mesh.digest for mesh in scene.meshes}) > 1
    by_name = {mesh.name: mesh.drawings[0] for mesh in scene.meshes}
    base = next(d for name, d in by_name.items() if name.endswith("base_link.STL"))
    entry = next(m for m in data["meshes"] if geometry[m["offset"] :].startswith(base.data))
    points, faces, _ = unpack_mesh(
        PackedMesh(
            data=base.data,
            n_vertices=entry["vertices"],
            n_faces=entry["faces"],
            n_hole_edges=entry["holes"],
            low=np.array(entry["low"]),
            high=np.array(entry["high"]),
        )
    )
    file = trimesh.load(FIXTURES / "car-3" / "meshes" / "base_link.STL")
    assert trimesh.Trimesh(points, faces).area == pytest.approx(file.area, rel=1e-3)
    assert np.ptp(points, axis=0) == pytest.approx(file.extents, rel=1e-5)


def test_a_mesh_that_is_another_one_moved_and_scaled_is_drawn_where_it_is(tmp_path):
    box = trimesh.creation.box((0.1, 0.2, 0.3))
    box.export(tmp_path / "near.stl")
    box.apply_scale(2.0).apply_translation((0.0, 0.0, 5.0)).export(tmp_path / "far.stl")
    shapes = "".join(
        f'<visual><geometry><mesh filename="{name}.stl"/></geometry></visual>' for name in ("near", "far", "near")
    )
    data, _ = data_of(check_text(tmp_path, f'<robot name="r"><link name="a">{shapes}</link></robot>', scene=True))
    (link,) = data["models"][0]["links"]
    near, far, again = (data["meshes"][shape["mesh"]] for shape in link["visual"])
    assert near is again
    assert (near["low"], near["high"]) == ([-0.05, -0.1, -0.15], [0.05, 0.1, 0.15])
    assert far["low"] == pytest.approx([-0.1, -0.2, 4.7])
    assert far["high"] == pytest.approx([0.1, 0.2, 5.3])
    # The same numbers on two grids: they are in the page once.
    assert near["offset"] == far["offset"]


def test_the_repair_of_the_odd_wheel_is_shown_where_it_puts_the_frame(car):
    (model,) = data_of(car)[0]["models"]
    (finding,) = (f for f in model["findings"] if f["code"] == "SYM001")
    (after,) = finding["preview"]
    before = next(j for j in model["joints"] if j["name"] == "wheel_1_to_base_link")
    assert after["joint"] == "wheel_1_to_base_link"
    assert np.array(after["at"]).reshape(4, 4)[:3, :3] == pytest.approx(np.eye(3))
    assert np.array(before["at"])[[3, 7, 11]] == pytest.approx(np.array(after["at"])[[3, 7, 11]])
    assert "preview" in finding["layers"]


def test_four_wheels_stand_on_the_ground_round_the_centre_of_mass(car):
    scene: Scene = car.scenes[0]
    assert scene.ground is not None
    assert {link for link, _ in scene.ground.contacts} == {f"wheel_{i}" for i in range(1, 5)}
    corners = np.array(scene.ground.support)[:, :2]
    assert (corners.min(axis=0) < scene.ground.com[:2]).all()
    assert (corners.max(axis=0) > scene.ground.com[:2]).all()


def test_overlaps_name_the_finding_about_them(tmp_path: Path):
    def link(name: str, size: float) -> str:
        return (
            f'<link name="{name}"><collision><geometry><box size="{size} {size} {size}"/></geometry></collision></link>'
        )

    limit = '<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/>'
    text = f"""<robot name="r">{link("a", 1)}{link("b", 0.1)}{link("c", 1)}
      <joint name="ab" type="revolute"><parent link="a"/><child link="b"/><origin xyz="2 0 0"/>{limit}</joint>
      <joint name="bc" type="revolute"><parent link="b"/><child link="c"/><origin xyz="-1.1 0 0"/>{limit}</joint>
    </robot>"""
    run = check_text(tmp_path, text, scene=True)
    (model,) = data_of(run)[0]["models"]
    (overlap,) = model["overlaps"]
    assert (overlap["a"], overlap["b"], overlap["depth"]) == ("a", "c", pytest.approx(0.1, rel=0.01))
    (finding,) = (f for f in model["findings"] if f["code"] == "COL001")
    assert overlap["finding"] == finding["id"]


def test_the_rims_of_holes_are_drawn(tmp_path: Path):
    box = trimesh.creation.box((1.0, 1.0, 1.0))
    box.update_faces(np.arange(len(box.faces)) != 0)
    box.export(tmp_path / "open.stl")
    mesh = '<visual><geometry><mesh filename="open.stl"/></geometry></visual>'
    run = check_text(tmp_path, f'<robot name="r"><link name="a">{mesh}</link></robot>', scene=True)
    data, geometry = data_of(run)
    (entry,) = data["meshes"]
    _, _, holes = unpack_mesh(
        PackedMesh(
            data=geometry,
            n_vertices=entry["vertices"],
            n_faces=entry["faces"],
            n_hole_edges=entry["holes"],
            low=np.array(entry["low"]),
            high=np.array(entry["high"]),
        )
    )
    # One triangle is missing: two edges of a square, and the diagonal.
    assert sorted(np.linalg.norm(holes[:, 1] - holes[:, 0], axis=1)) == pytest.approx([1.0, 1.0, 2**0.5], rel=1e-3)


# -- colours of other files ----------------------------------------------------------------------------------------------

PAINTED = """<robot name="painted"><link name="a">
  <visual><geometry><mesh filename="meshes/box.obj"/></geometry></visual>
  <visual><geometry><mesh filename="other/box.obj"/></geometry></visual>
</link></robot>"""


def paint(folder: Path, library: str | None, name: str = "box.mtl") -> None:
    """Write a box whose faces have the material of a library."""
    folder.mkdir(parents=True, exist_ok=True)
    box = trimesh.creation.box((1, 1, 1)).export(file_type="obj", include_color=False)
    first, rest = box[: box.index("f ")], box[box.index("f ") :]
    (folder / "box.obj").write_text(f"mtllib {name}\n{first}usemtl paint\n{rest}")
    if library is not None:
        (folder / "box.mtl").write_text(f"newmtl paint\n{library}\n")


def list_colors(run: Run) -> list[tuple[float, ...] | None]:
    return [drawing.color for mesh in run.scenes[0].meshes for drawing in mesh.drawings]


def test_obj_is_drawn_in_the_colours_of_its_library(tmp_path):
    paint(tmp_path / "meshes", "Kd 0 0.03 0.35\nd 0.5")
    paint(tmp_path / "other", "Kd 1 0 0")
    assert list_colors(check_text(tmp_path, PAINTED, scene=True)) == [(0.0, 0.03, 0.35, 0.5), (1.0, 0.0, 0.0, 1.0)]
    (tmp_path / "other" / "box.mtl").unlink()
    assert list_colors(check_text(tmp_path, PAINTED, scene=True)) == [(0.0, 0.03, 0.35, 0.5), None]


@pytest.mark.parametrize(
    "name", ["../../box.mtl", "/etc/box.mtl", "file:///etc/box.mtl", "~/box.mtl", "package://p/box.mtl"]
)
def test_a_library_out_of_reach_is_not_opened(tmp_path, monkeypatch, name):
    paint(tmp_path, "Kd 1 0 0")
    model = tmp_path / "a" / "robot"
    paint(model / "meshes", None, name)
    paint(model / "other", None, name)
    read = []
    monkeypatch.setattr("urdfcheck.model.mesh_colors.read_text_or_nothing", lambda path, _: read.append(path) or "")
    assert list_colors(check_text(model, PAINTED, scene=True)) == [None, None]
    assert not [path for path in read if not Path(path).resolve().is_relative_to(model)]


def test_a_large_library_is_not_read(tmp_path, monkeypatch):
    for folder in ("meshes", "other"):
        paint(tmp_path / folder, "Kd 1 0 0")
    monkeypatch.setattr("urdfcheck.model.mesh_colors.MAX_LIBRARY", 10)
    assert list_colors(check_text(tmp_path, PAINTED, scene=True)) == [None, None]


def test_a_changed_library_changes_the_picture_of_a_kept_report(tmp_path):
    paint(tmp_path / "meshes", "Kd 1 0 0")
    paint(tmp_path / "other", "Kd 1 0 0")
    (tmp_path / "painted.urdf").write_text(PAINTED)
    pages = []
    for color in ("1 0 0", "0 0.25 0", "0 0.25 0"):
        (tmp_path / "other" / "box.mtl").write_text(f"newmtl paint\nKd {color}\n")
        command("check", "painted.urdf", "--fail-on", "never", "-o", "html=page.html", cwd=tmp_path)
        pages.append((tmp_path / "page.html").read_text())
    assert ['"color":[0,0.25,0,1]' in page or '"color":[0.0,0.25,0.0,1.0]' in page for page in pages] == [
        False,
        True,
        True,
    ]


def show(*links: str, **changes: Any) -> dict[str, Any]:
    """What the view is given of one finding about a robot of these links."""
    joints = (make_joint("axle", links[0], links[-1]),)
    robot = scene(root=links[0], links=tuple(map(make_link, links)), joints=joints, frames=())
    subjects = changes["subjects"]
    plain = {"location": Location(subjects[0], None), "related": (), "fix": None}
    found = finding(**plain | changes)
    data, _ = build_scene_data([("m1", "robot", robot, build_finding_cards([found]))])
    return data["models"][0]["findings"][0]


def at(*subjects: str) -> tuple[Location, ...]:
    return tuple(Location(subject, None) for subject in subjects)


def test_both_links_of_a_pair_are_shown_and_the_right_twin_is_beside_the_wrong_one():
    pair = show(
        *("base", "left", "right"),
        code="SYM004",
        subjects=("link[right]/inertial/inertia",),
        related=at("link[left]/inertial/inertia"),
        data={"between": ["link[left]", "link[right]"], "twin": "left"},
    )
    assert (pair["links"], "beside" in pair) == (["right", "left"], False)
    odd = show(
        *("base", "left", "right"), code="SYM004", subjects=("link[right]/inertial/inertia",), data={"twin": "left"}
    )
    assert (odd["links"], odd["beside"]) == (["right"], {"links": ["left"], "joints": []})


def test_all_links_with_one_defect_are_shown():
    places = at("link[b]/collision/geometry/mesh@filename", "link[c]/visual/geometry/mesh@filename")
    found = show("a", "b", "c", code="PKG001", subjects=("link[a]/visual/geometry/mesh@filename",), related=places)
    assert (found["links"], "beside" in found) == (["a", "b", "c"], False)


def test_siblings_that_are_right_have_no_defect():
    found = show("base", "wheel", code="SYM001", subjects=("joint[odd]/origin",), related=at("joint[axle]/origin"))
    assert (found["joints"], found["beside"]) == (["odd"], {"links": [], "joints": ["axle"]})


@pytest.mark.parametrize(
    ("code", "subject", "layers"),
    [
        ("SYM004", "link[a]/inertial/origin@xyz", ["visual", "com", "box"]),
        ("SYM007", "link[a]/collision/geometry/mesh@filename", ["visual", "collision"]),
        ("SYM001", "joint[axle]/origin@rpy", ["visual", "axes", "frames"]),
        ("COL001", "link[a]/collision/geometry/box", ["visual", "collision", "overlaps"]),
        ("MSH002", "link[a]/visual/geometry/mesh@filename", ["visual", "holes"]),
        ("KIN005", "link[a]", ["visual", "frames"]),
    ],
)
def test_the_part_of_a_link_chooses_the_layers(code: str, subject: str, layers: list[str]):
    assert show("a", "b", code=code, subjects=(subject,))["layers"] == layers


def test_a_transform_is_shown_at_the_link_that_it_places_and_not_at_one_that_its_message_names():
    found = show(
        *("base", "wheel"),
        code="LCH005",
        subjects=("node[tf]@args",),
        data={"link": "wheel", "parent": "base", "child": "base_footprint"},
    )
    assert (found["links"], found["layers"]) == (["base"], ["visual", "frames"])


def test_a_finding_is_shown_in_the_pose_in_which_it_was_measured():
    subjects = ("joint[axle]/limit@effort",)
    assert show("a", "b", code="DYN002", subjects=subjects, data={"pose": {"axle": 0.25, "gone": 1.0}})["pose"] == {
        "axle": 0.25
    }
    assert "pose" not in show("a", "b", code="COL001", subjects=subjects, data={"pose": "all joints at zero"})


def test_a_finding_has_each_overlap_that_it_lists():
    pairs = [("a", "b"), ("a", "c"), ("b", "c")]
    overlaps = tuple(SceneOverlap(pair, (0.0, 0.0, 0.0), 0.1) for pair in pairs)
    robot = scene(root="a", links=tuple(map(make_link, "abc")), joints=(), frames=(), overlaps=overlaps)
    found = finding(
        code="COL001",
        location=Location("link[a]/collision/geometry/box", None),
        subjects=("link[a]/collision/geometry/box",),
        related=at("link[b]/collision/geometry/box", "link[c]/collision/geometry/sphere"),
        data={"link": "a", "other": "b"},
    )
    data, _ = build_scene_data([("m1", "robot", robot, build_finding_cards([found]))])
    (model,) = data["models"]
    assert [overlap["finding"] is not None for overlap in model["overlaps"]] == [True, True, False]
    assert model["findings"][0]["links"] == ["a", "b", "c"]


def test_a_pair_that_an_srdf_hides_is_shown_where_it_collides():
    data = {"first": "a", "second": "b", "pose": {"axle": 0.5}}
    found = show("a", "b", "c", code="COL003", subjects=("disable_collisions[1]",), data=data)
    assert (found["links"], found["pose"]) == (["a", "b"], {"axle": 0.5})


def write_slab(folder: Path, unit: float) -> Path:
    """A slab of 0.1 x 0.2 x 0.4 m, 0.5 m above its frame, in a COLLADA file of this unit."""
    slab = trimesh.creation.box((0.1 / unit, 0.2 / unit, 0.4 / unit))
    slab.apply_translation((0.0, 0.0, 0.5 / unit))
    text = trimesh.exchange.dae.export_collada(slab).decode()
    path = folder / "slab.dae"
    path.write_text(text.replace("<up_axis>Y_UP", f'<unit name="u" meter="{unit}"/><up_axis>Z_UP'))
    return path


@pytest.mark.parametrize("unit", [0.001, 0.0254, 1.0])
def test_the_solid_of_a_link_has_the_unit_of_its_mesh(tmp_path, unit):
    write_slab(tmp_path, unit)
    typed = """<robot name="r"><link name="a">
      <inertial><origin xyz="0 0 1"/><mass value="8"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
      <visual><geometry><mesh filename="slab.dae" scale="2 1 1"/></geometry></visual></link></robot>"""
    (scene,) = check_text(tmp_path, typed, scene=True).scenes
    (link,) = scene.links
    assert link.density == pytest.approx(8 / (0.2 * 0.2 * 0.4), rel=1e-5)
    assert link.drawn_com == pytest.approx((0.0, 0.0, 0.5), abs=1e-6)
    moments = [8 / 12 * (0.2**2 + 0.2**2), 8 / 12 * (0.2**2 + 0.4**2), 8 / 12 * (0.2**2 + 0.4**2)]
    assert link.drawn_moments == pytest.approx(moments, rel=1e-5)


def test_meshes_that_are_not_drawn_are_named(tmp_path, car):
    (tmp_path / "empty.stl").write_bytes(b"")
    trimesh.creation.box((0.1, 0.2, 0.3)).export(tmp_path / "box.stl")
    shapes = "".join(
        f'<visual><geometry><mesh filename="{n}.stl"/></geometry></visual>' for n in ("empty", "gone", "box")
    )
    data, _ = data_of(check_text(tmp_path, f'<robot name="r"><link name="a">{shapes}</link></robot>', scene=True))
    said = "2 of 3 mesh files are missing or were not read, and not drawn: empty.stl, gone.stl"
    assert data["models"][0]["undrawn"] == said
    assert not data_of(car)[0]["models"][0]["undrawn"]


def test_links_have_the_place_where_limits_and_mimics_put_them(arm, car):
    (scene,) = arm.scenes
    rod, tip = (np.array(link.start).reshape(4, 4) for link in scene.links[1:])
    shoulder, wrist = scene.joints
    expected = np.array(shoulder.pose).reshape(4, 4) @ move(shoulder.turn, 0.5)
    assert rod == pytest.approx(expected)
    assert tip == pytest.approx(expected @ np.array(wrist.pose).reshape(4, 4) @ move((0, 0, 1), -2 * 0.5 + 0.1))
    assert {link.start for link in car.scenes[0].links} == {None}, "all of its joints are at zero"


def move(axis: tuple[float, ...], angle: float) -> np.ndarray:
    return trimesh.transformations.rotation_matrix(angle, axis)


@pytest.mark.parametrize(("x", "stands"), [(0.0, True), (0.099, True), (0.101, True), (0.12, False)])
def test_the_ground_layer_and_the_rule_agree_on_what_stands(tmp_path, x, stands):
    """The COM is 0.5 m high above four feet, 0.1 m from their edge."""
    feet = "".join(
        f"""<link name="leg_{n}"><visual><geometry><box size="0.02 0.02 0.02"/></geometry></visual></link>
        <link name="hip_{n}"/>
        <joint name="hip_joint_{n}" type="revolute"><parent link="base"/><child link="hip_{n}"/>
        <origin xyz="{0.09 * a} {0.09 * b} -0.49"/><axis xyz="0 1 0"/>
        <limit lower="-1" upper="1" effort="9" velocity="9"/></joint>
        <joint name="knee_joint_{n}" type="revolute"><parent link="hip_{n}"/><child link="leg_{n}"/><axis xyz="0 1 0"/>
        <limit lower="-1" upper="1" effort="9" velocity="9"/></joint>"""
        for n, (a, b) in enumerate([(1, 1), (1, -1), (-1, 1), (-1, -1)])
    )
    typed = f"""<robot name="r"><link name="base"><inertial><origin xyz="{x} 0 0"/><mass value="5"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
      <visual><geometry><box size="0.2 0.2 0.1"/></geometry></visual></link>{feet}</robot>"""
    run = check_text(tmp_path, typed, scene=True, codes={"DYN004"})
    assert run.scenes[0].ground.stands is stands
    tips = [f for f in (*run.findings, *run.unrequested) if f.message_id == "tips"]
    assert bool(tips) is not stands
