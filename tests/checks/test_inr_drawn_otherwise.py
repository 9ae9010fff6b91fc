"""INR009: where the drawing may be what is wrong, no number is taken from it."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
from builders import box, collision, find, inertial, joint, link, mesh, robot, visual
from castings import geometry, write_stl

from urdfcheck.core import Finding, Severity
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia, make_box_solid

SIZE = (0.4, 0.2, 0.1)


def make_pair(folder: Path, *, rpy: str) -> list[Finding]:
    """Check two links with one tensor, of which one draws a part with these axes."""
    xx, yy, zz = np.diag(compute_solid_inertia(make_box_solid(SIZE), 8.0)).tolist()
    numbers = inertial(8, ixx=xx, iyy=yy, izz=zz)
    parts = [
        link("base"),
        link("one", numbers, visual(box("0.4 0.2 0.1"))),
        joint("to_one", "base", "one", kind="continuous"),
        link("other", numbers, visual(box("0.4 0.2 0.1"), rpy=rpy)),
        joint("to_other", "base", "other", kind="continuous", xyz="0 1 0"),
    ]
    return find(folder, robot(*parts), {"INR009"})


def test_a_shape_may_be_rotated_where_another_link_draws_the_axes_of_the_tensor(tmp_path: Path) -> None:
    (finding,) = make_pair(tmp_path, rpy="0 1.5707963 0")
    assert finding.message_id == "rotated"
    assert "one has the same mass and tensor" in finding.message
    assert finding.fix is not None
    assert not finding.fix.edits


def test_a_collision_shape_that_is_unlike_an_open_mesh_gives_no_com(tmp_path: Path) -> None:
    write_stl(tmp_path / "part.stl", [((0.7, 0.6, 0.4), (0.0, 0.0, 0.16))])
    text = (tmp_path / "part.stl").read_bytes()
    count = int.from_bytes(text[80:84], "little") - 1
    (tmp_path / "part.stl").write_bytes(text[:80] + count.to_bytes(4, "little") + text[84 : 84 + 50 * count])
    own = np.diag(compute_solid_inertia(geometry([((0.266, 0.266, 0.094), (0.0, 0.0, 0.0))]).solid, 1.4)).tolist()
    numbers = inertial(1.4, ixx=own[0], iyy=own[1], izz=own[2])
    shapes = (visual(mesh("part.stl")), collision(box("0.266 0.266 0.094"), xyz="-0.064 0 0.047"))
    arm = robot(link("base"), link("arm", numbers, *shapes), joint("j", "base", "arm", kind="continuous"))
    (finding,) = find(tmp_path, arm, {"INR009"})
    assert finding.message_id == "unlike"
    assert finding.fix is not None
    assert "0.064" not in finding.message + finding.fix.title


@pytest.mark.parametrize(("mass", "found"), [("0.1", False), ("50", True)])
def test_one_mass_from_which_the_inertias_are_computed_was_chosen(tmp_path: Path, mass: str, found: bool) -> None:
    parts = [f'<xacro:property name="m" value="{mass}"/>', link("base")]
    for index, size in enumerate((0.03, 0.04, 0.05, 0.06)):
        name, moment = f"l{index}", f"${{m/6*s{index}*s{index}}}"
        numbers = inertial("${m}", ixx=moment, iyy=moment, izz=moment)
        parts += [
            f'<xacro:property name="s{index}" value="{size}"/>',
            link(name, numbers, visual(box(f"{size} {size} {size}"))),
            joint(f"to_{name}", "base", name, kind="continuous"),
        ]
    text = robot(*parts, xacro=True)
    findings = find(tmp_path, text, {"INR007"}, name="robot.urdf.xacro")
    assert ([finding.message_id for finding in findings] == ["mass"]) == found


@pytest.mark.parametrize(("size", "ratio"), [(0.1, None), (0.3, 27)])
def test_sizes_of_links_with_one_mass_are_measured_in_one_way(tmp_path: Path, size: float, ratio: float | None) -> None:
    """A bracket of two plates is as large as the box of an open mesh by their hulls, and a fiftieth by volume."""
    write_stl(tmp_path / "bracket.stl", [((0.1, 0.1, 0.001), (0.0, 0.0, z)) for z in (-0.0495, 0.0495)])
    write_stl(tmp_path / "case.stl", [((size, size, size), (0.0, 0.0, 0.0))])
    text = (tmp_path / "case.stl").read_bytes()
    count = int.from_bytes(text[80:84], "little") - 1
    (tmp_path / "case.stl").write_bytes(text[:80] + count.to_bytes(4, "little") + text[84 : 84 + 50 * count])
    parts = [link("base")]
    for index, name in enumerate(("bracket", "bracket", "bracket", "bracket", "case")):
        shapes = (
            visual(mesh(f"{name}.stl")),
            collision(box(f"{size} {size} {size}") if name == "case" else mesh(f"{name}.stl")),
        )
        parts += [link(f"l{index}", inertial(1), *shapes), joint(f"j{index}", "base", f"l{index}", kind="continuous")]
    found = [one for one in find(tmp_path, robot(*parts), {"INR007"}) if one.message_id == "mass"]
    assert [one.data["ratio"] for one in found] == ([] if ratio is None else [ratio])
    assert all(one.message.endswith("l4 is 27 times as large as l0, by their convex hulls") for one in found)


PUBLISHER = "<launch><node pkg='robot_state_publisher' args='{}'/></launch>"


@pytest.mark.parametrize(
    ("files", "severities"),
    [
        ({}, "warning warning"),
        ({"launch/show.launch": PUBLISHER.format("arm.urdf")}, "info info"),
        (
            {"launch/show.launch": PUBLISHER.format("arm.urdf"), "launch/sim.launch": "gazebo_ros arm.urdf"},
            "warning warning",
        ),
        (
            {"launch/show.launch": PUBLISHER.format("all.xacro"), "all.xacro": "<xacro:include filename='arm.urdf'/>"},
            "info info",
        ),
        (
            {
                "launch/show.launch": PUBLISHER.format("all.xacro"),
                "all.xacro": "<xacro:include filename='arm.urdf'/><gazebo/>",
            },
            "warning warning",
        ),
        ({"launch/plan.launch": "<launch>moveit arm.urdf</launch>"}, "warning info"),
        ({"launch/plan.launch": "<launch>moveit arm.urdf kdl_kinematics_plugin</launch>"}, "warning info"),
        ({"launch/plan.launch": "<launch>moveit arm.urdf pinocchio</launch>"}, "warning warning"),
    ],
)
def test_placeholders_are_notes_where_nothing_reads_a_mass(
    tmp_path: Path, files: dict[str, str], severities: str
) -> None:
    names = [f"l{index}" for index in range(5)]
    numbers = inertial(1, ixx=1, iyy=1, izz=1)
    parts = [
        link(n, numbers, visual(box(f"{s} {s} {s}"))) for n, s in zip(names, (0.1, 0.2, 0.1, 0.3, 0.1), strict=True)
    ]
    joints = [joint(f"to_{n}", before, n, kind="continuous") for before, n in itertools.pairwise(names)]
    for name, text in {"package.xml": "<package><name>arm</name></package>", **files}.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    findings = find(tmp_path, robot(*parts, *joints), {"INR007"}, name="arm.urdf")
    found = {finding.message_id: finding.severity.name.lower() for finding in findings}
    assert [found["placeholder"], found["mass"]] == severities.split()


@pytest.mark.parametrize(
    ("launch", "severity"), [("<launch>moveit arm.urdf</launch>", 1), (PUBLISHER.format("arm.urdf"), 0)]
)
def test_a_body_without_mass_is_a_note_where_a_model_is_only_displayed(
    tmp_path: Path, launch: str, severity: int
) -> None:
    zero = inertial(1, ixx=0, iyy=0, izz=0)
    parts = [link("base", inertial(1)), *(link(n) + joint(f"to_{n}", "base", n, kind="continuous") for n in ("a",))]
    parts += [link("b", zero), joint("to_b", "base", "b", kind="continuous")]
    (tmp_path / "package.xml").write_text("<package><name>arm</name></package>")
    (tmp_path / "show.launch").write_text(launch)
    findings = find(tmp_path, robot(*parts), {"INR001", "INR004"}, name="arm.urdf")
    assert {finding.code for finding in findings} == {"INR001", "INR004"}
    assert {finding.severity for finding in findings} == {[Severity.INFO, Severity.WARNING][severity]}
