"""JNT021's evidence: which line the parts are round about, on which side of zero there is room, and the same from the cache."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

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
    mismatches, _ = find_contradicted_axes(make_model(tmp_path, place_tubes("0 0 0.1"), joint, place_tubes("0 0 0")))
    (found,) = mismatches
    assert (found.joint, found.kind) == ("j", "beside")
    assert found.vector == pytest.approx((-0.012, 0, 0), abs=1e-6)
    assert found.radius == found.hub == pytest.approx(0.03, rel=0.03)


@pytest.mark.parametrize(("distance", "found"), [(0.012, True), (0.03, False)])
def test_a_screw_hole_far_from_the_axis_is_not_its_bearing(tmp_path: Path, distance: float, found: bool) -> None:
    """A pin with a radius of 5 mm: the one hole of its size is 2.4 or 6 radii away."""
    joint = f'<origin xyz="{distance} 0 0.1"/><axis xyz="0 0 1"/>'
    small = [place_tubes(place).replace('stl"', 'stl" scale="0.1667 0.1667 0.4"') for place in ("0 0 0.1", "0 0 0")]
    mismatches, _ = find_contradicted_axes(make_model(tmp_path, small[0], joint, small[1]))
    assert [m.kind for m in mismatches] == (["beside"] if found else [])


@pytest.mark.parametrize(
    ("base", "why"),
    [
        (("0 0 0.1", "0.024 0 0.1"), "two bores may be meant"),
        (("0.012 0 0.1", "0 0 0.1"), "one is on the axis"),
        (("0.06 0 0.1",), "it is too far away to be meant"),
        (("0.0125 0 0.1",), "it is half a millimetre off"),
    ],
)
def test_nothing_is_found_where_the_bore_is_not_the_only_one(tmp_path: Path, base: tuple[str, ...], why: str) -> None:
    joint = '<origin xyz="0.012 0 0.1"/><axis xyz="0 0 1"/>'
    mismatches, _ = find_contradicted_axes(make_model(tmp_path, place_tubes(*base), joint, place_tubes("0 0 0")))
    assert not mismatches, why


@pytest.mark.parametrize("sign", [1, -1])
def test_only_the_blocked_side_is_reported(tmp_path: Path, sign: int) -> None:
    stops = place_tubes("-0.1 0 0.02", "-0.1 0 0", "-0.09 0 -0.04", "-0.06 0 -0.07")
    arm = place_tubes("0 0 -0.1", "0 0 -0.08")
    _, blocked = find_contradicted_axes(make_model(tmp_path, stops, f'<axis xyz="0 {sign} 0"/>', arm))
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
    (one,), (other,) = first[0], second[0]
    assert one.vector == pytest.approx(other.vector)
    assert (one.joint, one.kind, one.amount, one.radius, one.hub) == (
        other.joint, other.kind, other.amount, other.radius, other.hub,
    )  # fmt: skip
    assert first[1] == second[1] == ()
