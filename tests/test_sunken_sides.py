"""JNT021's third evidence about a range: limits that drive a part into the ones that hold it."""

from __future__ import annotations

from pathlib import Path

import pytest
import trimesh
from conftest import check_text

from urdfcheck.core import Severity
from urdfcheck.model.motion.axes import sunken
from urdfcheck.model.motion.axes.contradicted import find_contradicted_axes
from urdfcheck.model.robot import Model
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.system.array_cache import ArrayCache

_MESH = '<visual><origin xyz="{}"/><geometry><mesh filename="{}.stl"/></geometry></visual>'
BLOCK, LEVER = _MESH.format("0 0 0", "block"), _MESH.format("0.1 0 0", "lever")


def write_hinge(axis: str, *, limits: tuple[float, float] = (0, 1.5), name: str = "hinge", y: float = 0.0) -> str:
    """A lever that lies on a block, and its hinge at the block's edge: towards a positive angle about y it would sink."""
    lower, upper = limits
    return (
        f'<joint name="{name}" type="revolute"><origin xyz="-0.1 {y} 0.11"/><parent link="block"/>'
        f'<child link="{name}_lever"/><axis xyz="{axis}"/>'
        f'<limit lower="{lower}" upper="{upper}" effort="1" velocity="1"/></joint>'
        f'<link name="{name}_lever">{LEVER}</link>'
    )


def write_meshes(folder: Path) -> None:
    trimesh.creation.box((0.2, 0.6, 0.2)).export(folder / "block.stl")
    trimesh.creation.box((0.2, 0.1, 0.02)).export(folder / "lever.stl")


def read_model(folder: Path, *hinges: str, block: str = BLOCK, cache: ArrayCache | None = None) -> Model:
    write_meshes(folder)
    path = folder / "press.urdf"
    path.write_text(f'<robot name="press"><link name="block">{block}</link>{"".join(hinges)}</robot>', encoding="utf-8")
    source = load_source(path, {}, PackageFinder(path, {}, []))
    assert source.root is not None
    return Model(source=source, robot=source.root, cache=cache or ArrayCache())


def test_the_share_of_the_surface_inside_is_measured_on_both_sides(tmp_path: Path) -> None:
    (found,) = find_contradicted_axes(read_model(tmp_path, write_hinge("0 1 0"))).sunken
    assert (found.joint, found.declared) == ("hinge", 1.5)
    assert found.shares[0] > 0.7
    assert found.shares[1] < 0.06


@pytest.mark.parametrize(
    ("axis", "limits"),
    [
        ("0 -1 0", (0, 1.5)),
        ("0 1 0", (-1.5, 0)),
        # Both sides are as long, or both are as full.
        ("0 1 0", (-1.5, 1.5)),
        ("0 0 1", (0, 1.5)),
    ],
)
def test_limits_that_fit_are_not_reported(axis: str, limits: tuple[float, float], tmp_path: Path) -> None:
    assert find_contradicted_axes(read_model(tmp_path, write_hinge(axis, limits=limits))).sunken == ()


@pytest.mark.parametrize(("limit", "into"), [("-1", ["block"]), ("0.2", None)], ids=["zero allowed", "zero outside"])
def test_parts_before_the_parent_count_where_all_between_may_be_at_zero(
    limit: str, into: list[str] | None, tmp_path: Path
) -> None:
    """A small post turns on the block and holds the lever, which sinks into the block."""
    post = (
        '<joint name="turn" type="revolute"><origin xyz="-0.1 0 0.11"/><parent link="block"/><child link="post"/>'
        f'<axis xyz="0 0 1"/><limit lower="{limit}" upper="1" effort="1" velocity="1"/></joint>'
        f'<link name="post">{_MESH.format("0 0 0.1", "lever")}</link>'
    )
    hinge = write_hinge("0 1 0").replace('<origin xyz="-0.1 0.0 0.11"/><parent link="block"/>', '<parent link="post"/>')
    assert hinge != write_hinge("0 1 0")
    found = find_contradicted_axes(read_model(tmp_path, post, hinge)).sunken
    assert [list(one.into) for one in found if one.joint == "hinge"] == ([] if into is None else [into])


def test_primitives_and_heavy_meshes_are_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    box = '<visual><geometry><box size="0.2 0.6 0.2"/></geometry></visual>'
    assert find_contradicted_axes(read_model(tmp_path, write_hinge("0 1 0"), block=box)).sunken == ()
    monkeypatch.setattr(sunken, "_MOST_FACES", 11)
    assert find_contradicted_axes(read_model(tmp_path, write_hinge("0 1 0"))).sunken == ()


def test_the_result_is_the_same_from_the_cache(tmp_path: Path) -> None:
    cache = ArrayCache(tmp_path / "cache")
    (first,), (second,) = (
        find_contradicted_axes(read_model(tmp_path, write_hinge("0 1 0"), cache=cache)).sunken for _ in range(2)
    )
    assert first.into == ("block",)
    assert (first.joint, first.declared, first.shares, first.into) == (
        second.joint,
        second.declared,
        second.shares,
        second.into,
    )


@pytest.mark.parametrize(
    ("hinges", "reported"),
    [
        ((write_hinge("0 1 0"),), True),
        # Several joints: that is how the robot is drawn.
        ((write_hinge("0 1 0"), write_hinge("0 1 0", name="other", y=0.2, limits=(0, 1.4))), False),
        # Its twin on the other side has the same axis and limits, and nothing in its way.
        (
            (
                write_hinge("0 1 0", name="left", y=0.2),
                write_hinge("0 1 0", name="right", y=-0.2).replace(LEVER, _MESH.format("-0.1 0 0", "lever")),
            ),
            False,
        ),
    ],
)
def test_one_joint_without_a_free_twin_is_reported(hinges: tuple[str, ...], reported: bool, tmp_path: Path) -> None:
    write_meshes(tmp_path)
    text = f'<robot name="press"><link name="block">{BLOCK}</link>{"".join(hinges)}</robot>'
    findings = check_text(tmp_path, text, codes={"JNT021"}).findings
    assert [(f.message_id, f.severity) for f in findings] == ([("sunken", Severity.WARNING)] if reported else [])
    assert all(f.fix is not None and f.fix.title.endswith("(0 -1 0), or write the limits -1.5 to 0") for f in findings)


@pytest.mark.parametrize(("height", "reported"), [("0.11", True), ("0.06", False)])
def test_a_part_that_is_inside_on_both_sides_is_out_of_place(tmp_path: Path, height: str, reported: bool) -> None:
    hinge = write_hinge("0 1 0").replace("-0.1 0.0 0.11", f"-0.1 0 {height}")
    write_meshes(tmp_path)
    text = f'<robot name="press"><link name="block">{BLOCK}</link>{hinge}</robot>'
    (found,) = find_contradicted_axes(read_model(tmp_path, hinge)).sunken
    assert (found.shares[1] < 0.2) == reported
    assert bool(check_text(tmp_path, text, codes={"JNT021"}).findings) == reported
