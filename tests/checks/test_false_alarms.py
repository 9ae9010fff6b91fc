"""What was once said of a published robot and was not true, made small: each case is quiet, and beside it one that is not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from builders import arm_on_base, find
from castings import Block, format_inertial, geometry, pieces, triangles, uniform, write_stl

from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.inertia_tensor import Solid, combine_solids

CODES = {"INR003", "INR004", "INR005", "INR006", "INR007", "INR008", "INR009", "INR010", "MSH008"}


def make_arm(numbers: DeclaredInertial | str, *drawn: str) -> str:
    """Return a robot whose arm has an inertial and draws something."""
    return arm_on_base(numbers if isinstance(numbers, str) else format_inertial(numbers), *drawn)


def mesh(name: str, role: str = "visual") -> str:
    return f'<{role}><geometry><mesh filename="{name}"/></geometry></{role}>'


def told(folder: Path, text: str) -> list[str]:
    return [f.code for f in find(folder, text, CODES)]


# -- meshes that declare another up axis (iCub, whose meshes RViz lays on their sides) -------------------------------------

# A shank that hangs down from its joint: 0.3 m along −z, in a file whose y points up.
SHANK: tuple[Block, ...] = (((0.06, 0.05, 0.3), (0.0, 0.0, -0.15)),)
LIES = np.array(((1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, -1.0, 0.0)))


def write_dae(path: Path, blocks: tuple[Block, ...], up: str) -> None:
    """The blocks as COLLADA; with y up as a modeller writes what stands upright there."""
    corners, faces = triangles(blocks)
    if up == "Y_UP":
        corners = corners @ LIES.T
    points, corner_indices = " ".join(f"{x:.9g}" for x in corners.ravel()), " ".join(map(str, faces.ravel()))
    path.write_text(
        f"""<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/><up_axis>{up}</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="a" count="{corners.size}">{points}</float_array>
<technique_common><accessor source="#a" count="{len(corners)}" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="{len(faces)}"><input semantic="VERTEX" source="#v" offset="0"/><p>{corner_indices}</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="c"><node><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#c"/></scene>
</COLLADA>"""
    )


def test_a_mesh_may_stand_upright_where_rviz_lays_it_down(tmp_path: Path) -> None:
    write_dae(tmp_path / "shank.dae", SHANK, "Y_UP")
    assert told(tmp_path, make_arm(uniform(combine_solids(pieces(SHANK)), 2.0), mesh("shank.dae"))) == []


def test_what_no_reading_of_the_up_axis_explains_is_told(tmp_path: Path) -> None:
    write_dae(tmp_path / "shank.dae", SHANK, "Y_UP")
    above = uniform(combine_solids(pieces((((0.06, 0.05, 0.3), (0.5, 0.0, 0.0)),))), 2.0)
    assert told(tmp_path, make_arm(above, mesh("shank.dae"))) == ["INR006"]


def test_another_mesh_of_the_link_settles_which_way_is_up(tmp_path: Path) -> None:
    write_dae(tmp_path / "shank.dae", SHANK, "Y_UP")
    lying: tuple[Block, ...] = (((0.06, 0.3, 0.05), (0.0, -0.15, 0.0)),)
    write_stl(tmp_path / "shank.stl", lying)
    content = make_arm(uniform(combine_solids(pieces(SHANK)), 2.0), mesh("shank.dae"), mesh("shank.stl", "collision"))
    assert told(tmp_path, content) != []


# -- bodies of a mesh that face inwards (Dingo-D, whose axle was subtracted from its chassis) -------------------------------

# A frame of thin walls, and an axle between them.
WALLS: tuple[Block, ...] = (
    ((0.5, 0.01, 0.1), (0.0, 0.2, 0.05)),
    ((0.5, 0.01, 0.1), (0.0, -0.2, 0.05)),
    ((0.01, 0.39, 0.1), (0.245, 0.0, 0.05)),
)
AXLE: Block = ((0.05, 0.36, 0.05), (0.1, 0.0, 0.05))


def write_mixed(path: Path, outwards: tuple[Block, ...], inwards: Block) -> None:
    """A text STL of blocks, the last of which faces inwards."""
    write_stl(path, (*outwards, inwards))
    lines = path.read_text().splitlines()
    for start in range(1 + 7 * 12 * len(outwards), len(lines) - 1, 7):
        lines[start + 3], lines[start + 4] = lines[start + 4], lines[start + 3]
    path.write_text("\n".join([*lines, ""]))


def solid_of(outwards: tuple[Block, ...], hollow: Block) -> Solid:
    """The blocks without the hollow one."""
    filled = combine_solids(pieces(outwards))
    (missing,) = pieces((hollow,))
    volume = filled.volume - missing.volume
    com = (filled.volume * filled.com - missing.volume * missing.com) / volume
    second = sum(
        sign * part.volume * (part.covariance + np.outer(part.com, part.com))
        for sign, part in ((1.0, filled), (-1.0, missing))
    )
    return Solid(volume, com, second / volume - np.outer(com, com))


def test_a_body_that_faces_inwards_is_not_subtracted(tmp_path: Path) -> None:
    write_mixed(tmp_path / "frame.stl", WALLS, AXLE)
    (filled,) = pieces((((0.5, 0.41, 0.1), (0.0, 0.0, 0.05)),))
    whole = uniform(filled, 10.0)
    collides = '<collision><origin xyz="0 0 0.05"/><geometry><box size="0.5 0.41 0.1"/></geometry></collision>'
    content = make_arm(DeclaredInertial(10.0, np.zeros(3), whole.tensor, whole.rotation), mesh("frame.stl"), collides)
    (finding,) = find(tmp_path, content, CODES)
    assert finding.cause is not None
    assert finding.cause.id == "com_missing"
    assert finding.data["edit"] == 'xyz="0 0 0.05"'


def test_a_hollow_is_still_a_hollow(tmp_path: Path) -> None:
    housing: tuple[Block, ...] = (((0.3, 0.2, 0.2), (0.0, 0.0, 0.1)),)
    cavity: Block = ((0.2, 0.16, 0.16), (0.045, 0.0, 0.1))
    write_mixed(tmp_path / "housing.stl", housing, cavity)
    true = uniform(solid_of(housing, cavity), 3.0)
    assert told(tmp_path, make_arm(true, mesh("housing.stl"))) == []
    (finding,) = find(
        tmp_path,
        make_arm(DeclaredInertial(3.0, true.com, true.tensor / 1000.0, true.rotation), mesh("housing.stl")),
        CODES,
    )
    assert finding.data["mismatch"]["mended_tensor"] == pytest.approx(0.0, abs=1e-3)


def test_a_filled_part_with_another_mass_is_in_no_other_unit(tmp_path: Path) -> None:
    housing: tuple[Block, ...] = (((1.0, 0.6, 0.3), (0.0, 0.0, 0.1)),)
    cavity: Block = ((0.96, 0.56, 0.26), (0.0, 0.0, 0.1))
    write_mixed(tmp_path / "housing.stl", housing, cavity)
    filled = uniform(combine_solids(pieces(housing)), 1404.0)
    typed_over = DeclaredInertial(1.1, filled.com, filled.tensor, filled.rotation)
    causes = {
        f.cause.id for f in find(tmp_path, make_arm(typed_over, mesh("housing.stl")), CODES) if f.cause is not None
    }
    assert not causes & {"inertia_unit", "units"}


# -- digits (Pelican, whose tensor is the drawn part's to one digit) --------------------------------------------------------


@pytest.mark.parametrize(
    ("typed", "codes"),
    [
        (
            ("0.01", "0.01", "0.02"),
            [],
        ),  # 0.009, 0.0094 and 0.0168 to one digit, and the tensor of a plate without thickness
        (("0.010", "0.010", "0.020"), ["INR009"]),  # to two digits they would be 0.0090, 0.0094, 0.017
    ],
)
def test_a_tensor_may_be_the_drawn_ones_to_the_digits_that_were_typed(
    tmp_path: Path, typed: tuple[str, str, str], codes: list[str]
) -> None:
    xx, yy, zz = typed
    numbers = (
        f'<inertial><mass value="1"/><inertia ixx="{xx}" ixy="0" ixz="0" iyy="{yy}" iyz="0" izz="{zz}"/></inertial>'
    )
    drawn = '<visual><geometry><box size="0.32 0.313 0.098"/></geometry></visual>'
    assert told(tmp_path, make_arm(numbers, drawn)) == codes


# -- a mass that was typed over (Ranger 1S, whose next version has the mass that the tensors are of) ------------------------

PART: tuple[Block, ...] = (((0.2, 0.06, 0.04), (0.03, 0.02, 0.05)), ((0.05, 0.16, 0.03), (-0.045, 0.13, 0.055)))


def test_a_tensor_of_another_mass_does_not_say_which_is_wrong(tmp_path: Path) -> None:
    write_stl(tmp_path / "part.stl", PART)
    heavy, typed = uniform(geometry(PART).solid, 6.0), 1.37
    text = make_arm(DeclaredInertial(typed, heavy.com, heavy.tensor, heavy.rotation), mesh("part.stl"))
    (finding,) = find(tmp_path, text, CODES)
    assert finding.cause is not None
    assert finding.cause.id == "other_mass"
    assert "Write that mass only if" in finding.cause.text
    assert "no other single edit" not in finding.message
    assert finding.fix is not None
    assert finding.fix.edits == ()
    assert finding.fix.title.startswith('write ixx="')
    assert told(tmp_path, text.replace('mass value="1.37"', 'mass value="6"')) == []


# -- what was copied is wrong once (the Allegro hands, whose three fingers are one) ------------------------------------------


def test_copied_links_that_are_wrong_alike_are_one_finding(tmp_path: Path) -> None:
    wrong = '<inertial><mass value="1"/><inertia ixx="{}" ixy="0" ixz="0" iyy="1" iyz="0" izz="{}"/></inertial>'
    fingers = "".join(f'<link name="f{i}">{wrong.format(1, 3)}</link>' for i in range(3))
    thumb = f'<link name="thumb">{wrong.format(1, 4)}</link>'
    joints = "".join(
        f'<joint name="j_{name}" type="continuous"><parent link="palm"/><child link="{name}"/></joint>'
        for name in ("f0", "f1", "f2", "thumb")
    )
    alike, other = find(tmp_path, f'<robot name="r"><link name="palm"/>{fingers}{thumb}{joints}</robot>', CODES)
    assert alike.subjects == tuple(f"link[f{i}]/inertial/inertia" for i in range(3))
    assert alike.message.startswith("f0, f1, f2: principal moments 1, 1, 3 kg·m² ")
    assert other.subjects == ("link[thumb]/inertial/inertia",)


@pytest.mark.parametrize(("numbers", "told_of"), [((1.0, 1.0), [2]), ((1.0, 3.0), [1, 1])])
def test_parts_with_one_mistake_and_one_measure_are_one_finding(
    tmp_path: Path, numbers: tuple[float, float], told_of: list[int]
) -> None:
    """Two wheels of one shape, the inertia of each some times too large."""
    block: tuple[Block, ...] = (((0.1, 0.2, 0.3), (0.0, 0.0, 0.0)),)
    write_stl(tmp_path / "wheel.stl", block)
    wheels = "".join(
        f'<link name="w{i}">{format_inertial(uniform(combine_solids(pieces(block)), 1.0))}{mesh("wheel.stl")}</link>'.replace(
            'mass value="1"', f'mass value="{0.01 * factor}"'
        )
        + f'<joint name="j{i}" type="continuous"><parent link="base"/><child link="w{i}"/></joint>'
        for i, factor in enumerate(numbers)
    )
    findings = find(tmp_path, f'<robot name="r"><link name="base"/>{wheels}</robot>', CODES)
    assert [len(f.subjects) for f in findings] == told_of
