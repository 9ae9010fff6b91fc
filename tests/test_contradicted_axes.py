"""JNT021's evidence: which line the parts are round about, on which side of zero there is room, which of them touches
nothing, and the same from the cache."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from conftest import check

from urdfcheck.model.motion.axes.apart import do_collisions_touch
from urdfcheck.model.motion.axes.contradicted import find_contradicted_axes
from urdfcheck.model.robot import Model
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.system.array_cache import ArrayCache

_TUBE = '<visual><origin xyz="{}"/><geometry><mesh filename="tube.stl"/></geometry></visual>'
_LIMIT = '<limit lower="-0.1" upper="2" effort="1" velocity="1"/>'


def make_model(folder: Path, base: str, joint: str, arm: str, cache: ArrayCache | None = None) -> Model:
    """A model of two links whose shapes are places of a tube without ends, 30 mm in radius and 40 mm long along z."""
    mesh = trimesh.creation.cylinder(radius=0.03, height=0.04, sections=16)
    mesh.update_faces(np.abs(mesh.face_normals[:, 2]) < 0.5)
    mesh.export(folder / "tube.stl")
    text = (
        f'<robot name="r"><link name="base">{base}</link><link name="arm">{arm}</link>'
        f'<joint name="j" type="revolute"><parent link="base"/><child link="arm"/>{joint}{_LIMIT}</joint></robot>'
    )
    path = folder / "r.urdf"
    path.write_text(text, encoding="utf-8")
    source = load_source(path, {}, PackageFinder(path, {}, []))
    assert source.root is not None
    return Model(source=source, robot=source.root, cache=cache or ArrayCache())


def place_tubes(*places: str) -> str:
    return "".join(_TUBE.format(place) for place in places)


def test_bore_beside_the_axis_is_measured(tmp_path: Path) -> None:
    joint = '<origin xyz="0.012 0 0.1" rpy="0 0 0.5"/><axis xyz="0 0 1"/>'
    model = make_model(tmp_path, place_tubes("0 0 0.1"), joint, place_tubes("0 0 0"))
    mismatches = find_contradicted_axes(model).bearings
    (found,) = mismatches
    assert (found.joint, found.kind) == ("j", "beside")
    assert found.vector == pytest.approx((-0.012, 0, 0), abs=1e-6)
    assert found.radius == found.hub == pytest.approx(0.03, rel=0.03)


@pytest.mark.parametrize(("bore", "found"), [("-0.2 0 0.1", True), ("-0.212 0 0.1", False), ("-0.2 0.012 0.1", True)])
def test_a_mesh_that_is_shifted_at_two_joints_is_not_the_fault_of_one(tmp_path: Path, bore: str, found: bool) -> None:
    """The second joint is at x = -0.2 and moves a part that draws nothing."""
    second = (
        '<origin xyz="0.012 0 0.1"/><axis xyz="0 0 1"/><limit lower="-0.1" upper="2" effort="1" velocity="1"/></joint>'
        '<link name="rod"/><joint name="k" type="revolute"><parent link="base"/><child link="rod"/>'
        '<origin xyz="-0.2 0 0.1"/><axis xyz="0 0 1"/>'
    )
    model = make_model(tmp_path, place_tubes("0 0 0.1", bore), second, place_tubes("0 0 0"))
    assert [m.joint for m in find_contradicted_axes(model).bearings] == (["j"] if found else [])


@pytest.mark.parametrize(("place", "reported"), [("0.012 -0.2 0.1", False), ("0.012 -0.21 0.1", True)])
def test_an_origin_like_that_of_the_other_side_has_not_slipped(tmp_path: Path, place: str, reported: bool) -> None:
    """The second joint is on the other side and moves a part that draws nothing."""
    second = (
        f'<origin xyz="0.012 0.2 0.1"/><axis xyz="0 0 1"/>{_LIMIT}</joint><link name="rod"/>'
        f'<joint name="k" type="revolute"><parent link="base"/><child link="rod"/><origin xyz="{place}"/><axis xyz="0 0 1"/>'
    )
    model = make_model(tmp_path, place_tubes("0 0.2 0.1"), second, place_tubes("0 0 0"))
    assert [m.kind for m in find_contradicted_axes(model).bearings] == ["beside"]
    assert bool(check(tmp_path / "r.urdf", codes={"JNT021"}).findings) is reported


@pytest.mark.parametrize(("distance", "found"), [(0.012, True), (0.03, False)])
def test_a_screw_hole_far_from_the_axis_is_not_its_bearing(tmp_path: Path, distance: float, found: bool) -> None:
    """A pin with a radius of 5 mm: the one hole of its size is 2.4 or 6 radii away."""
    joint = f'<origin xyz="{distance} 0 0.1"/><axis xyz="0 0 1"/>'
    small = [place_tubes(place).replace('stl"', 'stl" scale="0.1667 0.1667 0.4"') for place in ("0 0 0.1", "0 0 0")]
    mismatches = find_contradicted_axes(make_model(tmp_path, small[0], joint, small[1])).bearings
    assert [m.kind for m in mismatches] == (["beside"] if found else [])


@pytest.mark.parametrize(
    ("base", "why"),
    [
        (("0 0 0.1", "0.024 0 0.1"), "two bores may be meant"),
        (("0.012 0 0.1", "0 0 0.1"), "one is on the axis"),
        (("0 0 0.1", "0.0139 0 0.1"), "one is two millimetres off the axis"),
        (("0.06 0 0.1",), "it is too far away to be meant"),
        (("0.0125 0 0.1",), "it is half a millimetre off"),
    ],
)
def test_nothing_is_found_where_the_bore_is_not_the_only_one(tmp_path: Path, base: tuple[str, ...], why: str) -> None:
    joint = '<origin xyz="0.012 0 0.1"/><axis xyz="0 0 1"/>'
    model = make_model(tmp_path, place_tubes(*base), joint, place_tubes("0 0 0"))
    mismatches = find_contradicted_axes(model).bearings
    assert not mismatches, why


@pytest.mark.parametrize(("place", "found"), [("0 0 0.1", False), ("0.1 0 0.1", True)])
def test_a_bearing_whose_facets_are_uneven_is_one(tmp_path: Path, place: str, found: bool) -> None:
    """A spindle from a ring of 20 corners to one of 28, and a strut through the origin that leans by 11°."""
    rings = [
        (0.03 * np.cos(angle), 0.03 * np.sin(angle), height)
        for count, height in ((20, -0.02), (28, 0.02))
        for angle in 2 * np.pi * np.arange(count) / count
    ]
    trimesh.Trimesh(rings).convex_hull.export(tmp_path / "spindle.stl")
    strut = place_tubes("0 0 0.1").replace('0.1"/>', '0.1" rpy="0.2 0 0"/>')
    spindle = place_tubes(place).replace("tube", "spindle")
    joint = '<origin xyz="0 0 0.1"/><axis xyz="0 0 1"/>'
    model = make_model(tmp_path, strut + spindle, joint, place_tubes("0 0 0"))
    assert [m.kind for m in find_contradicted_axes(model).bearings] == (["tilted"] if found else [])


@pytest.mark.parametrize(("axis", "found"), [("0 0 1", False), ("0 1 0", True)])
def test_a_part_of_a_wrist_is_round_about_the_axis_of_the_joint_behind_it(
    tmp_path: Path, axis: str, found: bool
) -> None:
    """Both parts are tubes along z about the origin of a joint that pitches; the roll joint is 0.2 m farther along z."""
    roll = (
        '<axis xyz="1 0 0"/><limit lower="-0.1" upper="2" effort="1" velocity="1"/></joint>'
        '<link name="tool"/><joint name="k" type="revolute"><parent link="arm"/><child link="tool"/>'
        f'<origin xyz="0 0 0.2"/><axis xyz="{axis}"/>'
    )
    model = make_model(tmp_path, place_tubes("0 0 -0.05"), roll, place_tubes("0 0 0.05"))
    assert [m.kind for m in find_contradicted_axes(model).bearings] == (["across"] if found else [])


@pytest.mark.parametrize("sign", [1, -1])
def test_only_the_blocked_side_is_reported(tmp_path: Path, sign: int) -> None:
    stops = place_tubes("-0.1 0 0.02", "-0.1 0 0", "-0.09 0 -0.04", "-0.06 0 -0.07")
    arm = place_tubes("0 0 -0.1", "0 0 -0.08")
    blocked = find_contradicted_axes(make_model(tmp_path, stops, f'<axis xyz="0 {sign} 0"/>', arm)).sides
    assert [one.joint for one in blocked] == (["j"] if sign > 0 else [])
    if blocked:
        assert blocked[0].by_parent
        assert blocked[0].declared == 2.0
        assert blocked[0].contacts[0] > 3 * blocked[0].contacts[1]


def test_result_is_the_same_from_the_cache(tmp_path: Path) -> None:
    cache = ArrayCache(tmp_path / "cache")
    joint = '<origin xyz="0.012 0 0.1"/><axis xyz="0 0 1"/>'
    first, second = (
        find_contradicted_axes(make_model(tmp_path, place_tubes("0 0 0.1"), joint, place_tubes("0 0 0"), cache))
        for _ in range(2)
    )
    assert list((tmp_path / "cache").rglob("axes"))
    (one,), (other,) = first.bearings, second.bearings
    assert one.vector == pytest.approx(other.vector)
    assert (one.joint, one.kind, one.amount, one.radius, one.hub) == (
        other.joint, other.kind, other.amount, other.radius, other.hub,
    )  # fmt: skip
    assert first.sides == second.sides == ()


_BLOCK = '<{role}>{origin}<geometry><box size="{size}"/></geometry></{role}>'


def make_chain(folder: Path, *parts: str, kind: str = "revolute", cache: ArrayCache | None = None) -> Model:
    """A chain of links, each 0.2 m above the one before."""
    links = "".join(f'<link name="l{number}">{part}</link>' for number, part in enumerate(parts))
    joints = "".join(
        f'<joint name="j{n}" type="{kind}"><origin xyz="0 0 0.2"/><parent link="l{n - 1}"/><child link="l{n}"/>'
        '<axis xyz="0 0 1"/><limit lower="-0.1" upper="0.1" effort="1" velocity="1"/></joint>'
        for n in range(1, len(parts))
    )
    path = folder / "r.urdf"
    path.write_text(f'<robot name="r">{links}{joints}</robot>', encoding="utf-8")
    source = load_source(path, {}, PackageFinder(path, {}, []))
    assert source.root is not None
    return Model(source=source, robot=source.root, cache=cache or ArrayCache())


def make_block(x: float = 0.0, size: str = "0.05 0.05 0.2", role: str = "visual") -> str:
    return _BLOCK.format(role=role, origin=f'<origin xyz="{x} 0 0.1"/>', size=size)


def test_the_only_part_that_touches_nothing_is_found(tmp_path: Path) -> None:
    cache = ArrayCache(tmp_path / "cache")
    for _ in range(2):
        model = make_chain(tmp_path, *[make_block()] * 3, make_block(0.12), cache=cache)
        found = find_contradicted_axes(model).apart
        assert found is not None
        assert (found.joint, found.nearest, found.others) == ("j3", "l2", 2)
        assert found.gap == pytest.approx(0.07)
        assert found.size == pytest.approx(np.hypot(0.2, np.hypot(0.05, 0.05)))


def test_a_mesh_that_touches_nothing_is_found(tmp_path: Path) -> None:
    """The box around the part meets that around the one before: the meshes alone show that they are apart."""
    ring = trimesh.creation.annulus(r_min=0.2, r_max=0.21, height=0.02)
    ring.export(tmp_path / "ring.stl")
    part = '<visual><origin xyz="{} 0 0"/><geometry><mesh filename="ring.stl"/></geometry></visual>'
    small = '<visual><origin xyz="0 0 -0.58"/><geometry><sphere radius="0.1"/></geometry></visual>'
    rings = [part.format(0.0).replace(' 0"/>', f' {z}"/>') for z in (0.0, -0.19, -0.38)]
    assert find_contradicted_axes(make_chain(tmp_path, *rings)).apart is None
    found = find_contradicted_axes(make_chain(tmp_path, *rings, small)).apart
    assert found is not None
    assert found.joint == "j3"
    assert found.gap == pytest.approx(0.1, abs=0.02)


@pytest.mark.parametrize(
    ("parts", "kind", "why"),
    [
        ([make_block()] * 4, "revolute", "all touch"),
        ([make_block(), make_block(), make_block(0.09), make_block(0.18)], "revolute", "two are apart"),
        ([make_block(), make_block(), make_block(0.07)], "revolute", "one other joint says little"),
        ([make_block(), make_block(), make_block(), make_block(0.07)], "revolute", "the space is small"),
        (
            [make_block(), make_block(), "<inertial><mass value='1'/></inertial>", make_block(0.12)],
            "revolute", "a part is not drawn",
        ),
        (
            ['<visual><geometry><mesh filename="lost.stl"/></geometry></visual>', *[make_block()] * 3, make_block(0.12)],
            "revolute", "it may touch the part that is not known",
        ),
        (
            [make_block(), make_block(), make_block() + make_block(0, "0.5 0.1 0.2", "collision"),
             make_block(0.12) + make_block(0.12, role="collision")],
            "revolute", "the collisions touch",
        ),
        (
            [make_block(), make_block(), make_block() + make_block(0, "0.5 0.5 0.5", "collision"), make_block(0.12)],
            "revolute", "it is inside what the other collides with",
        ),
        ([*[make_block()] * 3, make_block(0.12, role="collision")], "revolute", "it is not drawn"),
    ],
)  # fmt: skip
def test_nothing_is_reported_where_the_space_may_be_meant(
    tmp_path: Path, parts: list[str], kind: str, why: str
) -> None:
    model = make_chain(tmp_path, *parts, kind=kind)
    found = find_contradicted_axes(model).apart
    assert found is None or do_collisions_touch(model, found), why


@pytest.mark.parametrize(("reach", "is_apart"), [(0.1, False), (0.01, True)])
def test_a_slide_that_touches_elsewhere_in_its_range_is_meant(tmp_path: Path, reach: float, is_apart: bool) -> None:
    """The last part hovers 0.1 m above the one before."""
    text = make_block().replace("0 0 0.1", "0 0 0.2")
    model = make_chain(tmp_path, make_block(), make_block(), make_block(), text, kind="prismatic")
    path = tmp_path / "r.urdf"
    changed = path.read_text(encoding="utf-8").replace('0.1" effort', f'{reach}" effort')
    path.write_text(changed.replace('lower="-0.1"', f'lower="-{reach}"'), encoding="utf-8")
    source = load_source(path, {}, PackageFinder(path, {}, []))
    assert source.root is not None
    model = Model(source=source, robot=source.root, cache=ArrayCache())
    assert (find_contradicted_axes(model).apart is not None) == is_apart
