"""The tables of the HTML report: what was measured, told from what is unknown."""

from __future__ import annotations

import re

import pytest
from output.documents import Document, read
from output.runs import IDENTITY, finding, make_inertia, make_joint, make_link, rule, scene

from urdfcheck.core.scene import Scene, SceneInertia, SceneMesh, SceneShape
from urdfcheck.output.html.tables.consumers_table import render_consumers_table
from urdfcheck.output.html.tables.joints_table import render_joints_table
from urdfcheck.output.html.tables.meshes_table import render_meshes_table
from urdfcheck.output.html.tables.physics_table import render_physics_table

TURNED = (0.0, -1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)


def rows(markup: str) -> list[list[str]]:
    """The text of each cell of the body and the foot."""
    body = markup[markup.index("<tbody>") :]
    return [[read(cell).text for cell in re.findall(r"<t[hd].*?</t[hd]>", row)] for row in body.split("<tr>")[1:]]


def physics(**changes: object) -> list[str]:
    return rows(render_physics_table(scene(links=(make_link("wheel", **changes),)), {}))[0]


def document(markup: str) -> Document:
    found = read(markup)
    assert all("scope" in attributes for attributes in found.all("th"))
    assert len(found.all("caption")) == len(found.all("table")) == 1
    return found


# -- physics -----------------------------------------------------------------------------------------------------------


def test_physics_tells_the_file_and_how_far_it_is_from_the_solid() -> None:
    row = physics(drawn_moments=(6.6e-6, 3.35e-6, 1.27e-5), drawn_com=(0.0001, 0.0, -0.0105))
    assert row == [
        *("wheel", "0.0283", "1", "2", "1", "", "2.000", "1\u202f000"),
        *("0.100", "0", "−12.500", "6.60", "6.70", "12.70", "×10⁻⁶"),
    ]


@pytest.mark.parametrize(("drawn", "verdict"), [(1.3e-6, " far off"), (1.4e-6, ""), (3.2e-5, ""), (3.4e-5, " far off")])
def test_moments_are_far_off_by_a_factor_of_five(drawn: float, verdict: str) -> None:
    assert physics(drawn_moments=(drawn, 6.7e-6, 1.27e-5))[5] == verdict


def test_unknown_is_not_zero() -> None:
    assert physics(inertial=None) == ["wheel", "no inertial"]
    bare = physics(inertial=SceneInertia(), density=None, drawn_com=(), drawn_moments=())
    assert set(bare[1:]) == {"—", ""}
    flat = physics(drawn_moments=(0.0, 1e-6, 1e-6))
    assert flat[2:6] == ["—", "—", "—", ""], "nothing is a multiple of nothing"


def test_the_whole_robot_has_a_mass_and_a_place() -> None:
    body = make_inertia(mass=1.0, com=(0.1, 0.0, 0.0))
    links = (
        make_link("a", inertial=body),
        make_link("b", inertial=body, world=TURNED),
        make_link("frame", inertial=None),
    )
    assert rows(render_physics_table(scene(links=links), {}))[-1][1:6] == ["2", "", "550.000", "50.000", "0"]


def test_the_whole_robot_has_the_place_that_it_has_as_it_is_drawn() -> None:
    body = make_inertia(mass=1.0, com=(0.1, 0.0, 0.0))
    links = (make_link("a", inertial=body), make_link("b", inertial=body, start=TURNED))
    follower = make_joint("j", "a", "b", mimic=("i", 1.0, 0.5))
    *_, (name, _, _, *place, _) = rows(render_physics_table(scene(links=links, joints=(follower,)), {}))
    assert place == ["550.000", "50.000", "0"]
    assert name == "All togetherbase frame, as drawn: joints at zero, followers where <mimic> puts them"


@pytest.mark.parametrize("changes", [{"world": None}, {"inertial": make_inertia(com=())}])
def test_the_whole_robot_has_no_place_where_a_link_has_none(changes: dict[str, object]) -> None:
    links = (make_link("a", inertial=make_inertia(mass=1.0)), make_link("b", **changes))
    assert rows(render_physics_table(scene(links=links), {}))[-1][1:6] == ["1.028", "", "—", "—", "—"]
    assert "All together" not in render_physics_table(scene(links=(make_link("a", inertial=None),)), {})


# -- meshes ------------------------------------------------------------------------------------------------------------


def shape(
    role: str, mesh: int | None = None, kind: str = "mesh", size: tuple[float, ...] = (1.0, 1.0, 1.0)
) -> SceneShape:
    return SceneShape(role=role, kind=kind, size=size, pose=IDENTITY, mesh="" if mesh is None else "a.stl", file=mesh)


def used(*links: tuple[SceneShape, ...], meshes: tuple[SceneMesh, ...] = ()) -> Scene:
    return scene(links=tuple(make_link(f"l{i}", shapes=shapes) for i, shapes in enumerate(links)), meshes=meshes)


def mesh(name: str, **changes: object) -> SceneMesh:
    facts = {"digest": name, "format": "stl", "bytes": 1284, "triangles": 12, "extents": (10.0, 20.0, 30.0)}
    return SceneMesh(name=name, **{"watertight": True, **facts, **changes})  # type: ignore[arg-type]


def test_a_mesh_tells_who_uses_it_and_how_large() -> None:
    both = (shape("visual", 0, size=(0.001,) * 3), shape("collision", 0, size=(0.001,) * 3))
    mirrored = (shape("visual", 0, size=(0.001, -0.001, 0.001)),)
    found = rows(render_meshes_table(used(both, both, mirrored, meshes=(mesh("m/arm.stl"),))))
    assert found[0] == [
        *("m/arm.stl", "l0, l1 visual and collisionl2 visual", "stl", "12", " yes", "0"),
        *("0.0010.001 × −0.001 × 0.001", "0.01 × 0.02 × 0.03", "1\u202f284"),
    ]
    assert found[1] == ["1 file", "", "1\u202f284"]


def test_copies_and_unreadable_files_are_told() -> None:
    meshes = (
        mesh("m/a.stl", watertight=False, open_edges=7),
        mesh("m/b.stl", digest="m/a.stl"),
        SceneMesh(name="m/c.dae", problem="no XML", bytes=3),
    )
    table = render_meshes_table(used(tuple(shape("visual", i) for i in range(3)), meshes=meshes))
    assert "files in m/" in document(table).text
    assert [(r[0], *r[3:6]) for r in rows(table)[:3]] == [
        ("a.stl", "12", "no", "7"),
        ("b.stlsame content as a.stl", "12", " yes", "0"),
        ("c.daeno XML", "—", "—", "—"),
    ]


def test_other_shapes_follow_with_their_outer_size() -> None:
    shapes = (
        shape("collision", kind="cylinder", size=(0.1, 0.5)),
        shape("collision", kind="capsule", size=(0.1, 0.5)),
        shape("visual", kind="sphere", size=(0.1,)),
        shape("visual", kind="box", size=(1.0, 2.0, 3.0)),
        SceneShape(role="visual", kind="mesh", size=(1.0, 1.0, 1.0), pose=IDENTITY, mesh="package://gone/a.stl"),
        SceneShape(role="visual", kind="mesh", size=(1.0, 1.0, 1.0), pose=IDENTITY, mesh="package://gone/b.stl"),
        SceneShape(role="visual", kind="", size=(), pose=()),
        shape("visual", 0),
    )
    found = rows(render_meshes_table(used(shapes, meshes=(mesh("a.stl"),))))
    assert [(r[0], r[2], r[7]) for r in found[:-1]] == [
        ("a.stl", "stl", "10 × 20 × 30"),
        ("cylinder", "primitive", "0.2 × 0.2 × 0.5"),
        ("capsule", "primitive", "0.2 × 0.2 × 0.7"),
        ("sphere", "primitive", "0.2 × 0.2 × 0.2"),
        ("box", "primitive", "1 × 2 × 3"),
        ("package://gone/a.stl", "not found", "—"),
        ("package://gone/b.stl", "not found", "—"),
        ("no shape", "—", "—"),
    ]
    assert render_meshes_table(used(())) == "<p>No link has a shape.</p>"


# -- joints ------------------------------------------------------------------------------------------------------------


def test_limits_are_told_in_degrees_or_millimetres() -> None:
    joints = (
        make_joint("axle", "base", "wheel"),
        make_joint("lift", "base", "fork", type="prismatic", lower=0.0, upper=0.25),
    )
    found = rows(render_joints_table(scene(joints=joints), {}))
    assert [row[5] for row in found] == ["−1.571 … 1.571 rad (−90° … 90°)", "0 … 250.000 mm"]


def test_joints_have_a_column_for_what_one_of_them_has() -> None:
    plain, drive = make_joint("a", "base", "wheel"), make_joint("b", "base", "w2", effort=3.0, mimic=("a", -1.0, 0.5))
    assert "Effort" not in render_joints_table(scene(joints=(plain,)), {})
    table = render_joints_table(scene(joints=(plain, drive)), {})
    assert [row[6:] for row in rows(table)] == [["—", "—"], ["−1 × a + 0.5", "3"]]
    assert "Damping" not in table


def test_numbers_of_both_kinds_of_joints_have_their_units() -> None:
    turning = make_joint("a", "base", "wheel", effort=3.0, velocity=2.0)
    sliding = make_joint("b", "base", "w2", type="prismatic", effort=40.0)
    table = render_joints_table(scene(joints=(turning, sliding)), {})
    assert [row[6:] for row in rows(table)] == [["3 N·m", "2"], ["40 N", "—"]]
    assert "Effort</th>" in table
    assert "Velocity<br><small>rad/s</small>" in table
    assert "Effort<br><small>N</small>" in render_joints_table(scene(joints=(sliding,)), {})


def test_axes_are_those_of_the_joint_frame() -> None:
    table = render_joints_table(scene(joints=(make_joint("a", "base", "wheel", turn=(0.0, 0.6, 0.8)),)), {})
    assert rows(table)[0][4] == "0, 0.6, 0.8"
    assert "Axis<br><small>joint frame</small>" in table


def test_joints_that_are_not_drawn_at_zero_are_named() -> None:
    joints = (
        make_joint("knee", "base", "wheel", lower=0.2, start=0.2),
        make_joint("hip", "base", "w2"),
        make_joint("toe", "base", "w3", start=0.1, mimic=("knee", 1.0, 0.0)),
    )
    assert (
        "Zero is outside the limits of knee: drawn at the limit next to it."
        in read(render_joints_table(scene(joints=joints), {})).text
    )
    assert "at the limit" not in render_joints_table(scene(joints=joints[1:]), {})


def test_names_can_be_found_by_the_pages_script() -> None:
    name = "<b>"
    tables = render_physics_table(scene(links=(make_link(name),)), {}) + render_meshes_table(
        used((shape("visual", kind="box"),))
    )
    tables += render_joints_table(scene(joints=(make_joint(name, "base", name, mimic=("m", 1.0, 0.0)),)), {})
    found = read(tables)
    assert [a["data-link"] for _, a in found.tags if "data-link" in a] == [name, "l0", "base", name]
    assert [a["data-joint"] for _, a in found.tags if "data-joint" in a] == [name, "m"]


# -- programs ----------------------------------------------------------------------------------------------------------


def test_what_becomes_of_a_launch_stands_beside_what_becomes_of_the_model() -> None:
    """The model itself loads in Gazebo, and the launch file starts no robot there."""
    launch = rule("LCH002", "spawn-arguments", scopes=("launch",))
    broken = finding(code="LCH002", consequences={"gazebo": "starts the world without the robot"})
    rules = {"INR003": rule(), "LCH002": launch}
    told = {row[0]: row[1:] for row in rows(render_consumers_table([finding(), broken], rules))}
    assert told["Gazebo"][0].endswith("loads it as typed")
    assert re.search(r"starts the world without the robot \(\s*LCH002\s*\)", told["Gazebo"][2])
    assert told["RViz"][2] == "—"


def test_without_findings_of_launch_files_there_is_no_word_of_them() -> None:
    assert {len(row) for row in rows(render_consumers_table([finding()], {"INR003": rule()}))} == {3}
