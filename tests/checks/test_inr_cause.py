"""INR009, and the repairs of INR003 and INR004: which finding a mistake becomes, what it says, and that its edit mends it."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import arm_on_base, box, cylinder, find, inertial, joint, link, robot, visual
from castings import (
    CASTING,
    MISTAKES,
    Mistake,
    drawn_boxes,
    edited,
    format_inertial,
    geometry,
    principal,
    slots,
    uniform,
    with_slots,
    write_stl,
)

from urdfcheck.core import Finding, Severity
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.mistakes.mistake import HYPOTHESES
from urdfcheck.facts.motion.kinematics import rpy_to_matrix
from urdfcheck.rules import load_rules

pytestmark = pytest.mark.slow

CODES = {"INR003", "INR004", "INR007", "INR008", "INR009", "MSH008"}
DRAWN = geometry(CASTING)
TRUE = uniform(DRAWN.solid)
BY_ID = {id: mistake for id, _, mistake in MISTAKES}
MESH = '<visual><geometry><mesh filename="part.stl"/></geometry></visual>'
BOXES = drawn_boxes(CASTING)
# Their numbers are those of no body; the cause then stands with the rules that say so.
IMPOSSIBLE = {
    "steiner_twice": "INR004",
    "slots_swapped": "INR003",
    "slots_shifted": "INR004",
    "diagonal_first": "INR004",
    "row_major": "INR004",
    "decimal_point": "INR003",
}
# Nothing in the inertial is wrong, or what is true is not known from it.
WITHOUT_EDIT = {"mesh_scale", "one_piece"}
EDITED = [(id, mistake) for id, _, mistake in MISTAKES if id not in WITHOUT_EDIT]


def make_drawn_arm(numbers: str, drawn: str = BOXES) -> str:
    """Return a robot whose arm has an inertial and draws something."""
    return arm_on_base(numbers, drawn)


def drawn_by(folder: Path, cause: str) -> str:
    """The part: as boxes, or as one mesh where that is what the mistake is about."""
    if cause not in {"shell", "convex_hull", "mesh_scale"}:
        return BOXES
    folder.mkdir(exist_ok=True)
    write_stl(folder / "part.stl", CASTING)
    return MESH


def wrong(cause: str) -> DeclaredInertial:
    return BY_ID[cause](TRUE, DRAWN)


def find_clear_messages(folder: Path, text: str, codes: set[str] = CODES, name: str = "robot.urdf") -> list[Finding]:
    """Return the findings; each of their messages and titles must be fit to print."""
    findings = find(folder, text, codes, name=name)
    for finding in findings:
        assert not re.search(r"\b(nan|inf|None)\b|…|\{|  ", f"{finding.message} {finding.fix and finding.fix.title}")
    return findings


def one(folder: Path, text: str, name: str = "robot.urdf") -> Finding:
    (finding,) = find_clear_messages(folder, text, name=name)
    return finding


# -- the finding --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("cause", "detail", "mistake"), MISTAKES, ids=[id for id, _, _ in MISTAKES])
def test_each_mistake_is_one_finding(tmp_path: Path, cause: str, detail: str, mistake: Mistake) -> None:
    finding = one(tmp_path, make_drawn_arm(format_inertial(mistake(TRUE, DRAWN)), drawn_by(tmp_path, cause)))
    assert finding.code == IMPOSSIBLE.get(cause, "INR009")
    if finding.code == "INR009":
        assert finding.cause is not None
        assert finding.cause.id == cause
        assert detail in finding.cause.text
        mild = cause in {"shell", "bounding_box", "convex_hull", "one_piece"}
        vast = cause in {"inertia_unit", "units"}  # thousands of times too large: not a matter of degree
        assert finding.severity == (Severity.INFO if mild else Severity.ERROR if vast else Severity.WARNING)
        assert "…" not in finding.headline
        assert not re.search(r"\(\W*\)", finding.headline)


# Another edit would be as good, or the numbers come from the mesh.
UNDECIDED = {"com_missing", "other_mass", "shell", "bounding_box", "convex_hull"}


@pytest.mark.parametrize(("cause", "mistake"), EDITED, ids=[id for id, _ in EDITED])
@pytest.mark.parametrize("name", ["robot.urdf", "robot.urdf.xacro"])
def test_the_edit_mends_it(tmp_path: Path, cause: str, mistake: Mistake, name: str) -> None:
    text = make_drawn_arm(format_inertial(mistake(TRUE, DRAWN)), drawn_by(tmp_path, cause))
    if name.endswith("xacro"):
        text = text.replace("<robot", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"')
    finding = one(tmp_path, text, name)
    assert finding.fix is not None
    if cause in UNDECIDED:
        assert str(finding.fix.applicability) == "display"
        assert re.search(r"(write|has) \w+=\"", finding.fix.title)
        return
    assert str(finding.fix.applicability) == "unsafe"
    mended = edited(text, finding.fix.edits)
    assert find_clear_messages(tmp_path, mended, name=name) == []
    assert format_inertial(TRUE, 5).split("<mass")[0].split('"')[1].split() == [
        f"{float(word):.5g}" for word in re.findall(r'<origin xyz="([^"]*)"', mended)[0].split()
    ]


WHEEL = '<visual><geometry><cylinder radius="0.033" length="0.026"/></geometry></visual>'


def test_the_formula_of_another_solid_is_certain(tmp_path: Path) -> None:
    moment = 0.4 * 0.6 * 0.033**2
    six = f'ixx="{moment!r}" ixy="0" ixz="0" iyy="{moment!r}" iyz="0" izz="{moment!r}"'
    finding = one(tmp_path, make_drawn_arm(f'<inertial><mass value="0.6"/><inertia {six}/></inertial>', WHEEL))
    assert finding.code == "INR009"
    assert finding.message_id == "exact"
    assert finding.cause is not None
    assert finding.cause.id == "wrong_formula"
    assert "a sphere of this radius" in finding.cause.text
    assert finding.fix is not None
    values = [float(edit.replacement) for edit in finding.fix.edits]
    across, along = 0.6 * (3 * 0.033**2 + 0.026**2) / 12, 0.6 * 0.033**2 / 2
    assert values == pytest.approx([across, across, along], rel=1e-4)


def test_a_formula_says_nothing_about_the_centre_of_mass(tmp_path: Path) -> None:
    moment = 0.4 * 0.6 * 0.033**2
    six = f'ixx="{moment!r}" ixy="0" ixz="0" iyy="{moment!r}" iyz="0" izz="{moment!r}"'
    numbers = f'<inertial><origin xyz="0 0 0.01"/><mass value="0.6"/><inertia {six}/></inertial>'
    finding = one(tmp_path, make_drawn_arm(numbers, WHEEL))
    assert finding.cause is not None
    assert finding.cause.id == "wrong_formula"
    assert "the COM is 10 mm off" in finding.message
    assert finding.message.partition("undone")[2].startswith(
        " (formula of another solid: a sphere of this radius), the tensor agrees, and the COM stays 10 mm off;"
    )
    assert finding.fix is not None
    assert not any("0.01" in edit.expected for edit in finding.fix.edits)


def test_a_rounded_tensor_is_an_info_with_the_number_of_decimals(tmp_path: Path) -> None:
    numbers = (
        '<inertial><mass value="0.3"/><inertia ixx="1e-4" ixy="0" ixz="0" iyy="1e-4" iyz="0" izz="2e-4"/></inertial>'
    )
    drawn = '<visual><geometry><box size="0.0355 0.0717 0.0287"/></geometry></visual>'
    finding = one(tmp_path, make_drawn_arm(numbers, drawn))
    assert finding.severity is Severity.INFO
    assert finding.cause is not None
    assert finding.cause.id == "rounded"
    assert "rounded to 4 decimals" in finding.cause.text


@pytest.mark.parametrize("moment", ["0.000001", "1e-6"])
def test_one_small_number_for_all_moments_was_typed_and_not_rounded(tmp_path: Path, moment: str) -> None:
    numbers = inertial(0.01, ixx=moment, iyy=moment, izz=moment)
    drawn = '<visual><geometry><box size="0.03 0.03 0.03"/></geometry></visual>'
    assert not find(tmp_path, make_drawn_arm(numbers, drawn), "INR009")


def test_one_of_several_typed_multiples_of_the_identity_was_not_rounded(tmp_path: Path) -> None:
    drawn = '<visual><geometry><box size="0.03 0.03 0.03"/></geometry></visual>'
    other = f'<link name="other">{inertial(0.06, ixx="0.00001", iyy="0.00001", izz="0.00001")}</link>' + joint(
        "k", "arm", "other", kind="fixed"
    )
    text = make_drawn_arm(inertial(0.01, ixx="0.000001", iyy="0.000001", izz="0.000001"), drawn)
    assert find(tmp_path, text.replace("</robot>", f"{other}</robot>"), "INR009") == []


def test_the_page_explains_every_cause() -> None:
    of_files = {"mesh_frame"}  # a mistake beside the numbers
    assert set(load_rules()["INR009"].causes) == {*HYPOTHESES, *of_files}


@pytest.mark.parametrize(
    ("cause", "message"), [("products_sign", "exact"), ("inertia_unit", "named"), ("mesh_scale", "mesh_scale")]
)
def test_how_certain_a_cause_is_the_message_tells(tmp_path: Path, cause: str, message: str) -> None:
    # A tensor that is 10⁴ too large may as well be that of a mass that is so much too small.
    finding = one(tmp_path, make_drawn_arm(format_inertial(wrong(cause)), drawn_by(tmp_path, cause)))
    assert finding.message_id == message


@pytest.mark.parametrize(
    ("cause", "claim"),
    [
        ("products_sign", "wrong inertia (products have flipped signs)"),
        ("inertia_unit", "inertia 10,000× too large (kg·cm², not kg·m²?)"),
        ("com_unit", "COM 84.1 m off (mm, not m)"),
    ],
)
def test_the_headline_names_the_number_and_the_cause(tmp_path: Path, cause: str, claim: str) -> None:
    finding = one(tmp_path, make_drawn_arm(format_inertial(wrong(cause))))
    assert finding.headline == f"arm: {claim}"


def test_a_mesh_tells_as_much_as_boxes(tmp_path: Path) -> None:
    write_stl(tmp_path / "part.stl", CASTING)
    finding = one(tmp_path, make_drawn_arm(format_inertial(wrong("products_sign")), MESH))
    assert (finding.code, finding.message_id) == ("INR009", "exact")
    assert finding.cause is not None
    assert finding.cause.id == "products_sign"


def test_nor_is_there_a_finding_for_the_numbers_of_the_part(tmp_path: Path) -> None:
    for i, numbers in enumerate((TRUE, principal(TRUE))):
        assert find_clear_messages(tmp_path / str(i), make_drawn_arm(format_inertial(numbers))) == []


@pytest.mark.parametrize(
    ("cause", "place"),
    [
        ("mass_unit", "mass@value"),
        ("com_unit", "origin@xyz"),
        ("com_missing", "origin@xyz"),
        ("products_sign", "inertia"),
    ],
)
def test_it_stands_at_the_text_that_must_change(tmp_path: Path, cause: str, place: str) -> None:
    assert one(tmp_path, make_drawn_arm(format_inertial(wrong(cause)))).location.subject.endswith(place)


# -- its edits ----------------------------------------------------------------------------------------------------------


def replacements(finding: Finding) -> list[tuple[str, str]]:
    assert finding.fix is not None
    return [(edit.expected, edit.replacement) for edit in finding.fix.edits]


def test_where_only_signs_change_the_digits_stay(tmp_path: Path) -> None:
    text = (
        make_drawn_arm(format_inertial(wrong("products_sign")))
        .replace('"-0.0024804"', '"-0.00248040000"')
        .replace("0.0012051", "1.2051e-3")
    )
    assert replacements(one(tmp_path, text)) == [
        ("-0.00248040000", "0.00248040000"),
        ("1.2051e-3", "-1.2051e-3"),
        ("-0.00045586667", "0.00045586667"),
    ]


def test_where_only_powers_of_ten_change_the_digits_stay(tmp_path: Path) -> None:
    text = make_drawn_arm(format_inertial(wrong("com_unit"))).replace("22.5 ", "22.500 ")
    assert replacements(one(tmp_path, text)) == [("22.500 48.888889 64.722222", "0.022500 0.048888889 0.064722222")]


def test_where_numbers_changed_places_they_keep_their_digits(tmp_path: Path) -> None:
    six = [f"{value:.8g}" for value in slots(TRUE)]
    assert replacements(one(tmp_path, make_drawn_arm(format_inertial(wrong("slots_swapped"))))) == [
        (six[5], six[0]),
        (six[0], six[5]),
    ]


@pytest.mark.parametrize("cause", ["products_sign", "decimal_point"])
def test_computed_numbers_are_told_and_not_edited(tmp_path: Path, cause: str) -> None:
    text = make_drawn_arm(format_inertial(wrong(cause))).replace(
        "<robot", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"'
    )
    text = re.sub(r'(ixy|izz)="([^"]*)"', r'\1="${\2}"', text)
    finding = one(tmp_path, text, "robot.urdf.xacro")
    assert finding.fix is not None
    assert not finding.fix.edits
    name = "ixy" if cause == "products_sign" else "izz"
    assert f'{name}="{slots(TRUE)[1 if name == "ixy" else 5]:.8g}"' in finding.fix.title


@pytest.mark.parametrize("missing", [r"<origin [^>]*/>", r' xyz="[^"]*"'], ids=["the element", "the attribute"])
def test_a_missing_com_is_told_and_not_edited(tmp_path: Path, missing: str) -> None:
    text = re.sub(missing, "", make_drawn_arm(format_inertial(wrong("com_missing"))), count=1)
    finding = one(tmp_path, text)
    assert finding.cause is not None
    assert finding.cause.id == "com_missing"
    assert finding.fix is not None
    assert not finding.fix.edits
    assert 'xyz="0.0225 0.0488889 0.0647222"' in finding.fix.title


@pytest.mark.parametrize("turned", [False, True])
def test_what_a_macro_writes_is_edited_when_it_is_wrong_for_all(tmp_path: Path, turned: bool) -> None:
    """Of a part that stands in its frame once as it is and once turned, with the same numbers, only one is wrong."""
    other = CASTING if not turned else [((y, x, z), (-b, a, c)) for (x, y, z), (a, b, c) in CASTING]
    numbers = TRUE if turned else wrong("products_sign")
    text = (
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="base"/>'
        f'<xacro:macro name="numbers">{format_inertial(numbers)}</xacro:macro>'
        f'<link name="one"><xacro:numbers/>{BOXES}</link><link name="two"><xacro:numbers/>{drawn_boxes(other)}</link>'
        '<joint name="a" type="continuous"><parent link="base"/><child link="one"/><origin xyz="0 1 0"/></joint>'
        '<joint name="b" type="continuous"><parent link="base"/><child link="two"/><origin xyz="0 -1 0"/></joint></robot>'
    )
    findings = find_clear_messages(tmp_path, text, {"INR009"}, "robot.urdf.xacro")
    assert [f.cause and f.cause.id for f in findings] == ["quarter_turn" if turned else "products_sign"]
    (finding,) = findings
    assert finding.fix is not None
    assert bool(finding.fix.edits) == (not turned)


# -- repairs of what no body can be -------------------------------------------------------------------------------------


def test_an_impossible_tensor_tells_the_one_edit_that_mends_it(tmp_path: Path) -> None:
    finding = one(tmp_path, make_drawn_arm(format_inertial(wrong("decimal_point"))))
    assert (finding.code, finding.severity) == ("INR003", Severity.ERROR)
    assert "makes the tensor that of the drawn part, and no other single edit does" in finding.message
    assert replacements(finding) == [("0.00087832333", "0.0087832333")]


@pytest.mark.parametrize(("moments", "code"), [((0.002, 0.003, 0.009), "INR003"), ((0.009, 0.003, -0.004), "INR004")])
def test_without_such_an_edit_the_drawn_part_s_tensor_is_told(
    tmp_path: Path, moments: tuple[float, float, float], code: str
) -> None:
    xx, yy, zz = moments
    text = make_drawn_arm(format_inertial(with_slots(replace(TRUE, com=TRUE.com * 0.9), (xx, 0, 0, yy, 0, zz))))
    finding = one(tmp_path, text)
    assert finding.code == code
    assert "single edit" not in finding.message
    assert finding.fix is not None
    assert "(the drawn part at this mass and uniform density)" in finding.fix.title
    assert "xyz" not in finding.fix.title  # the COM is the author's
    assert finding.fix.edits == ()


def test_nothing_is_offered_where_nothing_is_drawn(tmp_path: Path) -> None:
    finding = one(tmp_path, make_drawn_arm(format_inertial(wrong("decimal_point")), ""))
    assert finding.code == "INR003"
    assert finding.fix is not None
    assert not finding.fix.edits
    assert finding.fix.title.startswith("compute the inertia tensor again")


# -- what decides, and what does not ------------------------------------------------------------------------------------


def fixed(name: str, content: str, xyz: str = "0 0 0") -> str:
    """Another link, fixed to the arm, for the end of the robot."""
    return (
        f'<link name="{name}">{content}</link><joint name="{name}_screws" type="fixed"><parent link="arm"/>'
        f'<child link="{name}"/><origin xyz="{xyz}"/></joint></robot>'
    )


def test_a_cover_without_mass_belongs_to_the_part(tmp_path: Path) -> None:
    """The arm draws a frame, and a link of its own what fills it: together they have the numbers of a block."""
    block, hole = ((0.2, 0.1, 0.04), (0.0, 0.0, 0.0)), ((0.16, 0.06, 0.04), (0.0, 0.0, 0.0))
    frame = [((0.2, 0.02, 0.04), (0.0, y, 0.0)) for y in (-0.04, 0.04)]
    frame += [((0.02, 0.06, 0.04), (x, 0.0, 0.0)) for x in (-0.09, 0.09)]
    alone = make_drawn_arm(format_inertial(uniform(geometry([block]).solid)), drawn_boxes(frame))
    assert find_clear_messages(tmp_path / "alone", alone, {"INR009"})
    covered = alone.replace("</robot>", fixed("cover", drawn_boxes([hole])))
    assert find_clear_messages(tmp_path / "covered", covered, {"INR009"}) == []
    hinged = covered.replace('type="fixed"', 'type="continuous"')
    assert find_clear_messages(tmp_path / "hinged", hinged, {"INR009"})


@pytest.mark.parametrize(("mass", "severity"), [(30.0, Severity.INFO), (3.0, Severity.WARNING)])
def test_a_light_part_of_a_body_is_worth_an_info(tmp_path: Path, mass: float, severity: Severity) -> None:
    heavy = geometry([((0.3, 0.2, 0.1), (0.0, 0.0, 0.0))]).solid
    whole = fixed("motor", format_inertial(uniform(heavy, mass)) + drawn_boxes([((0.3, 0.2, 0.1), (0, 0, 0))]))
    finding = one(tmp_path, make_drawn_arm(format_inertial(wrong("products_sign"))).replace("</robot>", whole))
    assert finding.severity == severity


def block(size: tuple[float, ...], com: tuple[float, ...], rpy: tuple[float, ...]) -> DeclaredInertial:
    """The arm's mass as a block, anywhere."""
    turn = rpy_to_matrix(rpy)
    tensor = turn @ uniform(geometry([(size, (0, 0, 0))]).solid, TRUE.mass).tensor @ turn.T
    return DeclaredInertial(TRUE.mass, np.array(com), tensor)


def odd(name: str) -> str:
    """A link with the inertia of something else: a possible body inside what is drawn, and no common mistake of it."""
    numbers = block((0.121, 0.06, 0.121), (0.03, 0.08, 0.08), (0.6, 0.0, -0.9))
    return f'<link name="{name}">{format_inertial(numbers)}{BOXES}</link>'


def test_links_in_doubt_are_one_info(tmp_path: Path) -> None:
    links = "".join(odd(f"arm{i}") for i in range(3))
    joints = "".join(
        f'<joint name="j{i}" type="continuous"><parent link="base"/><child link="arm{i}"/><origin xyz="0 {i} 0"/></joint>'
        for i in range(3)
    )
    (finding,) = find_clear_messages(
        tmp_path, f'<robot name="r"><link name="base"/>{links}{joints}</robot>', {"INR009"}
    )
    assert (finding.message_id, finding.severity, str(finding.confidence)) == ("doubtful", Severity.INFO, "heuristic")
    assert finding.message.startswith("arm0, arm1, arm2: the inertial is far from")
    assert len(finding.related) == 2


def test_a_mass_in_one_plane_of_a_thick_part_is_an_info(tmp_path: Path) -> None:
    numbers = block((1e-4, 0.175, 0.055), (-0.02, 0.07, 0.05), (0.2, -0.1, 0.5))
    (finding,) = find_clear_messages(tmp_path, make_drawn_arm(format_inertial(numbers, 12)), {"INR009"})
    assert (finding.message_id, finding.severity) == ("disagrees", Severity.INFO)
    assert re.search(r"and \d+ more$", finding.data["ruled_out"])


def test_a_mesh_in_the_wrong_unit_is_not_mended_in_the_inertial(tmp_path: Path) -> None:
    part = make_drawn_arm(format_inertial(TRUE), MESH.replace("/></geom", ' scale="1000 1000 1000"/></geom'))
    write_stl(tmp_path / "part.stl", CASTING)
    (finding,) = find_clear_messages(tmp_path, part, {"INR009"})
    assert finding.message_id == "mesh_scale"
    assert finding.cause is not None
    assert finding.cause.text.startswith("The numbers fit a part 0.001 times as large as drawn")
    assert finding.fix is not None
    assert 'scale="1 1 1"' in finding.fix.title  # 1000 as written, by 0.001
    assert not finding.fix.edits


COLLADA = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="u" meter="UNIT"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="COUNT">NUMBERS</float_array>
<technique_common><accessor source="#a" count="POINTS" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/>
</vertices><triangles count="FACES"><input semantic="VERTEX" source="#v" offset="0"/><p>INDICES</p></triangles></mesh></geometry>
</library_geometries><library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>"""


def collada(unit: float) -> str:
    from castings import triangles

    corners, faces = triangles(CASTING)
    values = {
        "UNIT": repr(unit),
        "COUNT": str(corners.size),
        "NUMBERS": " ".join(f"{v:.9g}" for v in corners.ravel()),
        "POINTS": str(len(corners)),
        "FACES": str(len(faces)),
        "INDICES": " ".join(map(str, faces.ravel())),
    }
    return re.sub("|".join(values), lambda match: values[match.group()], COLLADA)


@pytest.mark.parametrize("unit", [1.0, 0.001])
def test_a_mesh_that_programs_read_in_two_sizes_accuses_nobody(tmp_path: Path, unit: float) -> None:
    """The numbers fit it where COLLADA's unit is passed over."""
    pytest.importorskip("collada")
    (tmp_path / "part.dae").write_text(collada(unit))
    dae = MESH.replace("stl", "dae")
    assert find_clear_messages(tmp_path, make_drawn_arm(format_inertial(TRUE), dae), {"INR009"}) == []
    # Of numbers that fit neither the cause differs from one reading to the other, unless there is but one.
    findings = find_clear_messages(tmp_path, make_drawn_arm(format_inertial(wrong("products_sign")), dae), {"INR009"})
    assert [f.cause and f.cause.id for f in findings] == (["products_sign"] if unit == 1.0 else [])


# -- twins --------------------------------------------------------------------------------------------------------------


def two_arms(left: DeclaredInertial, right: DeclaredInertial) -> str:
    """Arms on both sides; ``right`` is given in the left one's frame."""
    mirrored = [((x, y, z), (a, -b, c)) for (x, y, z), (a, b, c) in CASTING]
    flip = np.diag((1.0, -1.0, 1.0))
    right = DeclaredInertial(right.mass, flip @ right.com, flip @ right.tensor @ flip)
    return (
        f'<robot name="r"><link name="base"/><link name="left_arm">{format_inertial(left)}{BOXES}</link>'
        f'<link name="right_arm">{format_inertial(right)}{drawn_boxes(mirrored)}</link>'
        '<joint name="left" type="continuous"><parent link="base"/><child link="left_arm"/><origin xyz="0 0.3 0"/></joint>'
        '<joint name="right" type="continuous"><parent link="base"/><child link="right_arm"/><origin xyz="0 -0.3 0"/></joint>'
        "</robot>"
    )


def test_a_mass_that_lost_a_decimal_does_not_make_its_link_too_light_to_matter(tmp_path: Path) -> None:
    light = DeclaredInertial(TRUE.mass / 10, TRUE.com, TRUE.tensor)
    load = f'<inertial><mass value="{4 * TRUE.mass}"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
    loads = "".join(
        f'<link name="{side}_load">{load}</link>'
        f'<joint name="{side}_clamp" type="fixed"><parent link="{side}_arm"/><child link="{side}_load"/></joint>'
        for side in ("left", "right")
    )
    text = two_arms(light, TRUE).replace("</robot>", f"{loads}</robot>")
    (finding,) = find_clear_messages(tmp_path, text, {"INR009"})
    assert (finding.severity, finding.cause and finding.cause.id) == (Severity.WARNING, "decimal_point")


# A part with a motor in its post: its mesh alone would not tell a wrong sign.
_MOTOR = np.array((0.11, 0.01, 0.15))
_COM = 0.8 * TRUE.com + 0.2 * _MOTOR
_SECOND = 0.8 * (DRAWN.solid.covariance + np.outer(TRUE.com - _COM, TRUE.com - _COM)) + 0.2 * np.outer(
    _MOTOR - _COM, _MOTOR - _COM
)
HEAVY = DeclaredInertial(TRUE.mass, _COM, TRUE.mass * (np.trace(_SECOND) * np.eye(3) - _SECOND))


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_twin_tells_which_side_is_wrong_and_the_edit_makes_them_equal(tmp_path: Path, side: str) -> None:
    slip = with_slots(HEAVY, [slots(HEAVY)[i] for i in (3, 1, 2, 0, 4, 5)])  # ixx and iyy: a possible body
    text = two_arms(slip, HEAVY) if side == "left" else two_arms(HEAVY, slip)
    (finding,) = find_clear_messages(tmp_path, text)
    assert (finding.code, finding.message_id) == ("INR009", "twin")
    assert finding.location.subject.startswith(f"link[{side}_arm]")
    assert finding.cause is not None
    assert finding.cause.text == "It fits if two of the six numbers changed places: ixx and iyy."
    assert [place.subject for place in finding.related] == [f"link[{'right' if side == 'left' else 'left'}_arm]"]
    assert finding.fix is not None
    assert find_clear_messages(tmp_path / "mended", edited(text, finding.fix.edits)) == []


@pytest.mark.parametrize("scale", [1.0, 40.0])
def test_a_decimal_point_is_edited_if_the_twin_is_sound(tmp_path: Path, scale: float) -> None:
    """Tensors that are 40 times too large on both sides do not say which of the masses is right."""
    both = replace(HEAVY, tensor=scale * HEAVY.tensor)
    found = find(tmp_path, two_arms(both, replace(both, mass=both.mass / 10)), {"INR009"})
    slips = [f for f in found if f.cause is not None and f.cause.id == "decimal_point"]
    assert len(slips) == 1
    assert slips[0].fix is not None
    assert bool(slips[0].fix.edits) == (scale == 1.0)


@pytest.mark.parametrize(("off", "is_edited"), [(0.0, True), (0.4, False)])
def test_a_sign_of_a_com_is_edited_if_the_twins_is_in_the_part(tmp_path: Path, off: float, is_edited: bool) -> None:
    """Where the COM of the twin is beside the part, neither side is right."""
    other = replace(HEAVY, com=HEAVY.com + np.array((off, 0.0, 0.0)))
    found = find(tmp_path, two_arms(replace(other, com=other.com * (-1.0, 1.0, 1.0)), other), {"INR009"})
    edits = [len(f.fix.edits) for f in found if f.fix is not None and f.cause is not None and f.cause.id == "one_sign"]
    assert bool(sum(edits)) == is_edited


def test_a_twin_mends_an_impossible_tensor(tmp_path: Path) -> None:
    text = two_arms(BY_ID["products_sign"](HEAVY, DRAWN), HEAVY)
    (finding,) = find_clear_messages(tmp_path, text)
    assert finding.code == "INR003"
    assert "makes the tensor that of its twin right_arm, and no other single edit does" in finding.message
    assert finding.fix is not None
    assert find_clear_messages(tmp_path / "mended", edited(text, finding.fix.edits)) == []


def test_two_equal_arms_with_a_motor_are_sound(tmp_path: Path) -> None:
    assert find_clear_messages(tmp_path, two_arms(HEAVY, HEAVY)) == []


# -- robustness ---------------------------------------------------------------------------------------------------------


def test_a_malformed_origin_elsewhere_does_not_hide_an_impossible_tensor(tmp_path: Path) -> None:
    text = make_drawn_arm(format_inertial(wrong("decimal_point"))).replace(
        "</robot>", fixed("cover", BOXES, xyz="zero 0 0")
    )
    (finding,) = find_clear_messages(tmp_path, text, {"INR003"})
    assert finding.code == "INR003"


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("mass", ["0", "-1", "1e-40", "1e40", "nan", "one"])
@pytest.mark.parametrize("value", ["0", "-1", "1e-45", "1e40", "1e60", "inf"])
def test_odd_numbers_give_no_traceback(tmp_path: Path, mass: str, value: str) -> None:
    six = " ".join(f'{name}="{value}"' for name in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"))
    find_clear_messages(tmp_path, make_drawn_arm(f'<inertial><mass value="{mass}"/><inertia {six}/></inertial>'))


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "blocks",
    [[((0.3, 0.2, 0.0), (0, 0, 0))], [((0.3, 0.2, 1e-7), (0, 0, 0))], []],
    ids=["flat", "film", "one triangle"],
)
def test_odd_meshes_give_no_traceback(tmp_path: Path, blocks: list) -> None:  # type: ignore[type-arg]
    if blocks:
        write_stl(tmp_path / "part.stl", blocks)
    else:
        triangle = "outer loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop"
        (tmp_path / "part.stl").write_text(f"solid part\nfacet normal 0 0 1\n{triangle}\nendfacet\nendsolid part\n")
    for cause in ("products_sign", "decimal_point", "com_missing"):
        find_clear_messages(tmp_path, make_drawn_arm(format_inertial(wrong(cause)), MESH))


# -- how strongly a cause is stated -----------------------------------------------------------------------------------


def test_a_com_ten_times_too_far_is_not_in_inches(tmp_path: Path) -> None:
    # An inch is nearer to a tenth than to a metre, and leaves the COM off by more than the part is wide.
    finding = one(tmp_path, make_drawn_arm(format_inertial(replace(TRUE, com=10 * TRUE.com))))
    assert finding.cause is not None
    assert finding.cause.id == "decimal_point"
    assert "com 0.1 times" in finding.cause.text
    text = make_drawn_arm(format_inertial(replace(TRUE, com=10 * TRUE.com)))
    assert finding.fix is not None
    assert find_clear_messages(tmp_path, edited(text, finding.fix.edits)) == []


@pytest.mark.parametrize("factor", [10.0, 0.1, 0.01])
def test_a_com_at_the_wrong_decimal_point_is_undone(tmp_path: Path, factor: float) -> None:
    declared = replace(TRUE, com=factor * TRUE.com)
    if np.linalg.norm(DRAWN.solid.com * (1 - factor)) < 0.5 * np.sqrt(np.trace(DRAWN.solid.covariance)):
        pytest.skip("the COM is hardly moved")
    finding = one(tmp_path, make_drawn_arm(format_inertial(declared)))
    assert finding.cause is not None
    assert finding.cause.id in {"decimal_point", "com_unit"}


def test_links_of_one_model_that_fit_different_units_are_left_alone(tmp_path: Path) -> None:
    inches, centimetres = (replace(TRUE, com=TRUE.com / unit) for unit in (0.0254, 0.01))
    text = arm_on_base(format_inertial(inches), BOXES, base=format_inertial(centimetres) + BOXES)
    findings = [f for f in find_clear_messages(tmp_path, text) if f.code == "INR009"]
    assert [f.message_id for f in findings] == ["disputed", "disputed"]
    for finding in findings:
        assert finding.fix is not None
        assert not finding.fix.edits
        assert "base cm, arm inches" in finding.message
    (alone,) = find_clear_messages(tmp_path, make_drawn_arm(format_inertial(inches)))
    assert alone.fix is not None
    assert alone.fix.edits
    assert "(unit of the COM: inches)" in alone.message


def test_no_unit_is_named_that_fits_some_links_and_not_the_others(tmp_path: Path) -> None:
    """One COM fits inches, one centimetres or inches, and one, 2 m away, no unit: so inches are no cause."""
    block = [((0.2, 0.1, 0.06), (0.02, 0.01, 0.0))]
    part = uniform(geometry(block).solid)
    places = [part.com / 0.0254, part.com / 0.015, part.com + np.array((1.3, -0.9, 1.2))]
    parts = [link("base")]
    for i, place in enumerate(places):
        shape = drawn_boxes(block)
        parts += [joint(f"j{i}", "base", f"l{i}"), link(f"l{i}", format_inertial(replace(part, com=place)), shape)]
    messages = {f.message_id for f in find(tmp_path, robot(*parts), CODES)}
    assert "disputed" not in messages


def test_another_mass_is_claimed_only_for_one_ratio_of_all_moments(tmp_path: Path) -> None:
    tripled = replace(TRUE, tensor=3 * TRUE.tensor)
    finding = one(tmp_path / "a", make_drawn_arm(format_inertial(tripled)))
    assert finding.cause is not None
    assert finding.cause.id == "other_mass"
    moments, axes = np.linalg.eigh(TRUE.tensor)
    uneven = replace(TRUE, tensor=(axes * (moments * (2.92, 3.0, 3.08))) @ axes.T)
    (tmp_path / "b").mkdir()
    for other in find_clear_messages(tmp_path / "b", make_drawn_arm(format_inertial(uneven))):
        assert other.cause is None or other.cause.id != "other_mass"


def test_the_message_says_how_near_the_numbers_are_without_the_mistake(tmp_path: Path) -> None:
    exact = one(tmp_path / "a", make_drawn_arm(format_inertial(wrong("inertia_unit"))))
    assert "With one mistake undone (unit of the tensor: kg·cm²), the two agree to within 1 %" in exact.message
    lumped = replace(TRUE, com=TRUE.com + 0.2 * np.sqrt(np.trace(DRAWN.solid.covariance) / 3))
    (tmp_path / "b").mkdir()
    near = one(tmp_path / "b", make_drawn_arm(format_inertial(BY_ID["inertia_unit"](lumped, DRAWN))))
    assert "exactly" not in near.message
    assert "With one mistake undone (unit of the tensor: kg·cm²), the tensor agrees" in near.message


def test_signs_change_the_axes_and_not_the_principal_moments(tmp_path: Path) -> None:
    (tmp_path / "b").mkdir()
    exact = one(tmp_path / "a", make_drawn_arm(format_inertial(wrong("products_sign"))))
    assert "the inertia tensor is about other axes" in exact.message
    assert "principal moments" not in exact.message
    larger = replace(TRUE, tensor=1.12 * TRUE.tensor)
    near = one(tmp_path / "b", make_drawn_arm(format_inertial(BY_ID["products_sign"](larger, DRAWN))))
    assert "the inertia tensor is about other axes" in near.message
    assert re.search(r"the tensor is 12 % off instead of \d\d %;", near.message)


@pytest.mark.parametrize(("mass", "is_like"), [("12.906", True), ("11", False)])
def test_an_impossible_tensor_gets_the_number_of_a_link_like_it(tmp_path: Path, mass: str, is_like: bool) -> None:
    shape, others = visual(cylinder(0.1, 1)), {"iyy": "1.679", "izz": "0.651"}
    text = robot(
        link("upper", inertial("12.906", ixx="1", **others), shape),
        link("lower", inertial(mass, ixx="1.679", **others), shape),
        joint("elbow", "upper", "lower", kind="continuous", xyz="0 0 1"),
    )
    (finding,) = find(tmp_path, text, "INR003")
    assert finding.fix is not None
    assert finding.fix.title.startswith('write ixx="1.679" as in lower') == is_like
    assert ("lost decimal point" in finding.fix.title) != is_like
    assert not finding.fix.edits


@pytest.mark.parametrize(
    ("as_formula", "z", "causes"),
    [(False, 0.3437, {"steiner_twice"}), (False, 0.34, set()), (True, 0.34, set())],
)
def test_a_formula_of_another_box_is_no_mistake_of_a_cad_program(
    tmp_path: Path, as_formula: bool, z: float, causes: set[str]
) -> None:
    """A box of 0.2 × 0.2 × 0.4 m around z = 0.05, with moments near those less the parallel-axis term: those of a shorter box."""
    lengths = {"x": 0.2, "y": 0.2, "z": z}
    moments = {"ixx": ("y", "z"), "iyy": ("x", "z"), "izz": ("x", "y")}
    typed = {
        name: f"${{3*({a}*{a} + {b}*{b})/12}}" if as_formula else f"{3 * (lengths[a] ** 2 + lengths[b] ** 2) / 12:.6g}"
        for name, (a, b) in moments.items()
    }
    names = "".join(f'<xacro:property name="{name}" value="{length}"/>' for name, length in lengths.items())
    tensor = " ".join(f'{name}="{value}"' for name, value in {**typed, "ixy": 0, "ixz": 0, "iyz": 0}.items())
    part = f'<inertial><origin xyz="0 0 0.05"/><mass value="3"/><inertia {tensor}/></inertial>'
    drawn = visual(box("0.2 0.2 0.4"), xyz="0 0 0.05")
    text = robot(
        names, link("base"), link("arm", part, drawn), joint("j", "base", "arm", kind="continuous"), xacro=True
    )
    found = find(tmp_path, text, "INR009", name="robot.urdf.xacro")
    assert {finding.cause.id for finding in found if finding.cause is not None} == causes
