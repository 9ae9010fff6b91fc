"""What findings about inertials claim: other axes, placeholders, small products, and whose shape is meant."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import arm_on_base, box, collision, cylinder, find, inertial, joint, link, mesh, robot, sphere, visual
from castings import CASTING, Block, drawn_boxes, format_inertial, geometry, uniform

from urdfcheck.core import Severity
from urdfcheck.core.headlines import fill_joint_headline
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia, make_box_solid
from urdfcheck.facts.motion.kinematics import rpy_to_matrix

PLATE = (0.4, 0.2, 0.1)
PLATE_BLOCKS = [(PLATE, (0.0, 0.0, 0.0))]


def make_plate(rpy: tuple[float, float, float], factor: float = 1.0) -> str:
    """Return a plate whose tensor is about axes turned by ``rpy``, with its largest moment multiplied."""
    turn = rpy_to_matrix(rpy)
    moments = np.diag(compute_solid_inertia(make_box_solid(PLATE), 8.0)) * (1.0, 1.0, factor)
    numbers = DeclaredInertial(8.0, np.zeros(3), turn @ np.diag(moments) @ turn.T)
    return arm_on_base(format_inertial(numbers), visual(box("0.4 0.2 0.1")))


def make_chain(*bodies: tuple[DeclaredInertial, list[Block]]) -> str:
    parts = [link("base")]
    for i, (numbers, blocks) in enumerate(bodies):
        parts += [
            joint(f"j{i}", "base", f"l{i}", kind="continuous"),
            link(f"l{i}", format_inertial(numbers), drawn_boxes(blocks)),
        ]
    return robot(*parts)


def flip_products(numbers: DeclaredInertial) -> DeclaredInertial:
    return replace(numbers, tensor=2.0 * np.diag(np.diag(numbers.tensor)) - numbers.tensor)


# -- right moments, other axes -----------------------------------------------------------------------------------------


def test_right_moments_about_other_axes_are_no_wider_spread(tmp_path: Path) -> None:
    found = find(tmp_path, make_plate((1.2, -0.4, 0.3)), {"INR005", "INR009"})
    assert [(finding.code, finding.message_id) for finding in found] == [("INR009", "axes")]
    (finding,) = found
    assert finding.headline == "arm: right moments of inertia, about other axes"
    assert finding.fix is not None
    assert finding.fix.edits == ()
    assert 'ixx="0.03333"' in finding.fix.title


@pytest.mark.parametrize(("rpy", "factor"), [((1.2, -0.4, 0.3), 1.04), ((0.05, 0.0, 0.0), 1.0)])
def test_other_moments_or_nearly_the_same_axes_are_not(
    tmp_path: Path, rpy: tuple[float, float, float], factor: float
) -> None:
    assert "axes" not in {finding.message_id for finding in find(tmp_path, make_plate(rpy, factor), {"INR009"})}


# -- signs of a whole file ---------------------------------------------------------------------------------------------


def make_signs(*, slight: bool) -> str:
    """Return three castings whose products have flipped signs, and a plate with a small lump, whose products hardly matter."""
    bodies = []
    for size in (1.0, 1.7, 2.6):
        blocks = [(np.array(edges) * size, np.array(place) * size) for edges, place in CASTING]
        bodies.append((flip_products(uniform(geometry(blocks).solid)), blocks))
    plate = [((0.4, 0.3, 0.1), (0.0, 0.0, 0.0)), ((0.04, 0.05, 0.08), (0.15, 0.1, 0.09))]
    true = uniform(geometry(plate).solid)
    return make_chain(*bodies, (flip_products(true) if slight else true, plate))


@pytest.mark.parametrize("slight", [True, False])
def test_small_products_join_the_flipped_signs_of_their_file(tmp_path: Path, slight: bool) -> None:
    found = find(tmp_path, make_signs(slight=slight), {"INR009"})
    assert {finding.cause and finding.cause.id for finding in found} == {"products_sign"}
    named = {subject.partition("]")[0] for finding in found for subject in finding.subjects}
    assert ("link[l3" in named) == slight
    if slight:
        (finding,) = found
        assert finding.headline == "4 of 4 links: wrong inertia (products have flipped signs)"
        assert "% off the drawn part's instead of" in finding.message
        assert finding.fix is not None
        assert len({edit.span for edit in finding.fix.edits}) >= 10


# -- placeholders ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("moment", "size", "severity"),
    [
        ("9", "0.1 0.1 0.1", Severity.ERROR),
        ("0.1", "0.1 0.1 0.1", Severity.WARNING),
        (
            "1e-9",
            "0.1 0.1 0.1",
            Severity.WARNING,
        ),  # an undrawn part cannot be the reason, and neither is the simulation lost
        ("9", "0.01 0.01 0.01", Severity.WARNING),  # denser than any material: the drawing is a placeholder
    ],
)
def test_a_placeholder_a_thousand_times_too_large_is_an_error(
    tmp_path: Path, moment: str, size: str, severity: Severity
) -> None:
    text = arm_on_base(inertial(0.9, moment), visual(box(size)))
    (finding,) = find(tmp_path, text, {"INR005", "INR007", "INR008", "INR009"})
    assert (finding.code, finding.severity) == ("INR007", severity)


PACKAGE = '<package format="3"><name>p</name><version>1.0.0</version>{}</package>'
START = '<launch><node pkg="p" exec="drive" args="robot.urdf"/></launch>'


@pytest.mark.parametrize(
    ("more", "files", "severity"),
    [
        ("", {"package.xml": PACKAGE.format("")}, Severity.WARNING),
        ("", {}, Severity.ERROR),  # a file alone may be for any program
        ("", {"package.xml": PACKAGE.format("<depend>gazebo_ros</depend>")}, Severity.ERROR),
        ("", {"package.xml": PACKAGE.format(""), "launch/start.launch": START}, Severity.WARNING),
        (collision(box("0.1 0.1 0.1")), {"package.xml": PACKAGE.format("")}, Severity.WARNING),
        ("<!--<inertial><mass value='0.9'/></inertial>-->", {}, Severity.WARNING),
    ],
)
def test_a_placeholder_of_a_model_that_nothing_simulates_or_that_replaced_other_numbers_is_no_error(
    tmp_path: Path, more: str, files: dict[str, str], severity: Severity
) -> None:
    text = arm_on_base(inertial(0.9, "9"), visual(box("0.1 0.1 0.1")) + more)
    (finding,) = find(tmp_path, {"urdf/robot.urdf": text, **files}, "INR007", name="urdf/robot.urdf")
    assert finding.severity == severity
    assert finding.fix is not None
    assert finding.fix.title.startswith("put back the <inertial> that a comment holds") == ("<!--" in more)


def make_foot(moment: str) -> str:
    shank = inertial(0.6, ixx="0.006", iyy="0.006", izz="0.0001")
    return robot(
        link("thigh", inertial(1, "0.01")),
        joint("knee", "thigh", "shank"),
        link("shank", shank),
        joint("ankle", "shank", "foot", kind="fixed", xyz="0 0 -0.31"),
        link("foot", inertial(0.06, moment), collision(sphere(0.03))),
    )


def test_a_placeholder_that_its_body_does_not_feel_is_no_thinner_part(tmp_path: Path) -> None:
    assert find(tmp_path, make_foot("1e-12"), {"INR005", "INR007", "INR008", "INR009"}) == []


def test_a_light_sensor_on_a_heavy_body_is_no_error(tmp_path: Path) -> None:
    text = robot(
        link("world_base"),
        joint("drive", "world_base", "body", kind="continuous", axis="0 0 1"),
        link("body", inertial(1, ixx="0.0031", iyy="0.0029", izz="0.0041"), visual(box("0.15 0.15 0.12"))),
        joint("screws", "body", "sensor", kind="fixed"),
        link("sensor", inertial(1e-4, "0.001"), visual(box("0.01 0.01 0.01"))),
    )
    (finding,) = find(tmp_path, text, {"INR007"})
    assert finding.data["factor"] > 1000
    assert finding.severity == Severity.WARNING


@pytest.mark.parametrize(("mass", "edits"), [(0.83, True), (0.00083, False), (25.3, False)])
def test_a_mesh_of_no_ordinary_density_gives_no_edit(tmp_path: Path, mass: float, edits: bool) -> None:
    text = arm_on_base(inertial(mass, "5"), visual(box("0.1 0.11 0.12")))
    (finding,) = find(tmp_path, text, {"INR007"})
    assert finding.fix is not None
    assert bool(finding.fix.edits) == edits


# -- whose shape it is -------------------------------------------------------------------------------------------------


def make_thigh(numbers: str, drawn: str = "") -> str:
    return arm_on_base(numbers, drawn, collision(box("0.08 0.07 0.25"), xyz="0 0 -0.1"))


@pytest.mark.parametrize("drawn", ["", mesh("gone.stl")])
def test_a_collision_shape_is_called_one(tmp_path: Path, drawn: str) -> None:
    numbers = inertial(1, ixx="0.0056", iyy="0.0057", izz="0.0009")
    (finding,) = find(tmp_path, make_thigh(numbers, drawn and visual(drawn)), {"INR009"})
    assert finding.message_id == "com_missing"
    assert finding.headline == "arm: COM is at the link's origin, 100 mm from the shape's"
    assert "Compared with the collision shape" in finding.message
    assert finding.fix is not None
    # What an unread mesh hides may be another part than the collision shape.
    assert ("the collision shape alone has" in finding.fix.title) == (not drawn)
    assert "drawn part" not in finding.message


@pytest.mark.parametrize(("drawn", "found"), [("", 1), (mesh("gone.stl"), 0)])
def test_a_box_that_stands_for_an_unread_mesh_has_no_shape_to_compare(tmp_path: Path, drawn: str, found: int) -> None:
    numbers = inertial(1, ixx="0.0000013", iyy="0.000051", izz="0.000052", com="0 0 -0.1")
    assert len(find(tmp_path, make_thigh(numbers, drawn and visual(drawn)), {"INR009"})) == found


# -- what is small -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("offset", "severity"), [(0.004, Severity.INFO), (0.02, Severity.WARNING)])
def test_a_slight_correction_is_an_info(tmp_path: Path, offset: float, severity: Severity) -> None:
    size = (0.03, 0.004, 0.004)
    xx, yy, zz = np.diag(compute_solid_inertia(make_box_solid(size), 0.01)).tolist()
    text = arm_on_base(inertial(0.01, ixx=xx, iyy=yy, izz=zz), visual(box("0.03 0.004 0.004"), xyz=f"0 {offset} 0"))
    (finding,) = find(tmp_path, text, {"INR009"})
    assert (finding.message_id, finding.severity) == ("com_missing", severity)


def test_a_pound_has_to_leave_the_part(tmp_path: Path) -> None:
    blocks = [((0.3, 0.2, 0.1), (0.0, 0.0, 0.0))]
    true = uniform(geometry(blocks).solid)
    other = replace(true, tensor=true.tensor * (0.55, 0.3, 0.4), mass=true.mass)
    found = find(tmp_path, make_chain((other, blocks)), {"INR009"})
    assert [finding.cause and finding.cause.id for finding in found if finding.cause] == []


def make_units(factor: float) -> str:
    """Return a plate in g·m², with moments that are a little off, and two sound parts."""
    plate = [((0.4, 0.2, 0.1), (0.0, 0.0, 0.0))]
    true = uniform(geometry(plate).solid)
    sound = [((0.3, 0.1, 0.05), (0.0, 0.0, 0.0))]
    numbers = replace(true, tensor=1000.0 * true.tensor * np.array((factor, 1.0, 2.0 - factor)))
    return make_chain((numbers, plate), (uniform(geometry(sound).solid), sound))


@pytest.mark.parametrize(("factor", "edited"), [(1.0, True), (0.98, False)])
def test_a_unit_of_one_link_is_edited_only_where_it_is_exact(tmp_path: Path, factor: float, edited: bool) -> None:
    (finding,) = find(tmp_path, make_units(factor), {"INR009"})
    assert finding.cause is not None
    assert finding.cause.id == "inertia_unit"
    assert finding.fix is not None
    assert bool(finding.fix.edits) == edited


def make_edited_masses(numbers: DeclaredInertial, times: tuple[float, ...]) -> str:
    """Return a plate with these ``numbers``, and parts whose tensors are those of so many times their masses."""
    bodies = [(numbers, PLATE_BLOCKS)]
    for count, factor in enumerate(times):
        part = [((0.3 + 0.1 * count, 0.12, 0.05), (0.0, 0.0, 0.0))]
        true = uniform(geometry(part).solid)
        bodies.append((replace(true, tensor=factor * true.tensor), part))
    return make_chain(*bodies)


@pytest.mark.parametrize(
    ("times", "off", "cause"),
    [
        ((), (0.97, 1.04, 1.04), "inertia_unit"),
        ((2.7,), (0.97, 1.04, 1.04), "inertia_unit"),
        ((2.7, 5.9), (0.97, 1.04, 1.04), "other_mass"),
        ((2.7, 5.9), (1.0, 1.0, 1.0), "inertia_unit"),
    ],
)
def test_a_unit_that_nearly_fits_one_link_is_no_cause_where_the_masses_of_others_were_edited(
    tmp_path: Path, times: tuple[float, ...], off: tuple[float, ...], cause: str
) -> None:
    true = uniform(geometry(PLATE_BLOCKS).solid)
    text = make_edited_masses(replace(true, tensor=1000.0 * true.tensor * off), times)
    found = {finding.subjects[0]: finding.cause and finding.cause.id for finding in find(tmp_path, text, {"INR009"})}
    assert found["link[l0]/inertial/inertia"] == cause


@pytest.mark.parametrize(("times", "is_named"), [((), True), ((2.7, 5.9), False)])
def test_nor_does_a_tensor_that_fits_the_part_roughly_have_it(
    tmp_path: Path, times: tuple[float, ...], is_named: bool
) -> None:
    true = uniform(geometry(PLATE_BLOCKS).solid)
    text = make_edited_masses(replace(true, tensor=1e4 * true.tensor * (1.9, 0.7, 0.8)), times)
    (finding,) = (one for one in find(tmp_path, text, {"INR005"}) if "l0" in one.message)
    assert ("kg·cm²" in finding.message) == is_named


def test_a_headline_of_several_links_keeps_the_cause_and_drops_a_number() -> None:
    data = [
        {"link": name, "why": why, "share": share} for name, why, share in (("a", "z y x", 4.2), ("b", "x z y", 7.5))
    ]
    names = [["a"], ["b"]]
    assert (
        fill_joint_headline("{link}: wrong inertia ({why})", data, names, "links")
        == "a: wrong inertia (z y x) (+1 more)"
    )
    assert fill_joint_headline("{link}: wrong ({share:g} %)", data, names, "links") == "a, b: wrong"


@pytest.mark.parametrize(
    ("times", "cause"),
    [
        (1095.0, "inertia_unit"),
        (1044.0, "inertia_unit"),
        (1300.0, "other_mass"),  # 1.3 kg is no 1 kg
        (730.0, "other_mass"),
    ],
)
def test_a_mass_of_one_digit_hides_no_unit(tmp_path: Path, times: float, cause: str) -> None:
    """The author rounded 1.1 kg to 1 kg, and left the tensor of 1.1 kg in g·m²."""
    solid = geometry(CASTING).solid
    numbers = uniform(solid, 1.0)
    text = make_chain((replace(numbers, tensor=times * numbers.tensor), list(CASTING)))
    (finding,) = find(tmp_path, text, {"INR005", "INR009"})
    assert finding.cause is not None
    assert (finding.code, finding.cause.id) == ("INR009", cause)


@pytest.mark.parametrize(
    ("mass", "times", "is_named"),
    [
        (8.0968940262146127, 0.897, False),  # both numbers are of one export: two materials
        (8.0968940262146127, 0.7, True),
        (8.1, 0.8, True),
    ],
)
def test_numbers_of_one_export_have_no_other_mass(tmp_path: Path, mass: float, times: float, is_named: bool) -> None:
    numbers = uniform(geometry(CASTING).solid, mass)
    part = format_inertial(replace(numbers, tensor=times * numbers.tensor), 16)
    found = find(tmp_path, arm_on_base(part, drawn_boxes(CASTING)), {"INR009"})
    assert [finding.cause and finding.cause.id for finding in found] == ["other_mass"] * is_named


@pytest.mark.parametrize(
    ("comment", "is_named"),
    [
        ('<mass value="{older}"/>', True),
        ("was <mass value='{older}' />, too heavy for Gazebo", True),
        ('<mass value="{other}"/>', False),
        # An older inertial, which was replaced as a whole.
        ('<mass value="{older}"/> <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>', False),
    ],
)
def test_a_mass_in_a_comment_is_the_one_of_the_tensor(tmp_path: Path, comment: str, is_named: bool) -> None:
    """1/24 of the mass is near the factor between kg·m² and lb·ft²: by the numbers alone, a unit fits as well."""
    true = uniform(geometry(PLATE_BLOCKS).solid)
    text = make_chain((replace(true, mass=true.mass / 23.99), PLATE_BLOCKS))
    comment = comment.format(older=f"{true.mass:.9g}", other=f"{7.0 * true.mass:.9g}")
    (finding,) = find(tmp_path, text.replace("<mass", f"<!-- {comment} --><mass", 1), {"INR009"})
    assert finding.cause is not None
    assert ("as a comment says" in finding.cause.text) == is_named
    assert finding.fix is not None
    assert finding.fix.title.endswith("if the part weighs that much") == is_named
    assert not (is_named and finding.fix.edits), "the file does not show which of the two is right"


@pytest.mark.parametrize("rpy", ["1.5707963267948966 0 0", ""])
def test_a_rotated_frame_around_the_tensor_of_a_wheel_is_named_beside_its_axes(tmp_path: Path, rpy: str) -> None:
    """The other way to exchange y and z is an ``rpy`` that the tensor was not computed for."""
    across, along = 0.06 * (3 * 0.05**2 + 0.02**2) / 12, 0.06 * 0.05**2 / 2
    iyy, izz = (across, along) if rpy else (along, across)
    text = arm_on_base(inertial(0.06, rpy=rpy, ixx=across, iyy=iyy, izz=izz), visual(cylinder(0.05, 0.02)))
    (finding,) = find(tmp_path, text, {"INR009"})
    assert finding.fix is not None
    assert ('rpy="0 0 0"' in finding.fix.title) == bool(rpy)
    assert ("no other single edit brings them so near" in finding.message) == (not rpy)
