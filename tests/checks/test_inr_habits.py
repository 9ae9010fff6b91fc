"""Mistakes of a whole file that show in its impossible tensors: rotors, units, and tensors about the root frame."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from string import Formatter

import numpy as np
import pytest
from builders import arm_on_base, box, find, inertial, joint, link, robot, visual
from castings import CASTING, drawn_boxes, edited, format_inertial, geometry, steiner, uniform

from urdfcheck.core import Finding, Severity
from urdfcheck.facts.inertials.certainty import has_coarse_products
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.inertia_tensor import compute_solid_inertia, make_box_solid
from urdfcheck.model.inertials.diagnosis_words import collect_cause_data, compare_sizes
from urdfcheck.rules import load_rules

# Edges in m of parts that differ, and the axes of their joints.
EDGES = ((0.1, 0.08, 0.3), (0.12, 0.1, 0.25), (0.09, 0.11, 0.2), (0.07, 0.06, 0.15), (0.08, 0.05, 0.12))
AXES = ("1 0 0", "0 1 0", "0 0 1", "1 0 0", "0 1 0")
MASSES = (3.1, 4.2, 2.7, 1.3, 0.8)


def make_chain(numbers: list[DeclaredInertial], axes: tuple[str, ...] = AXES, *, drawn: bool = True) -> str:
    parts = [link("base")]
    for i, (one, axis) in enumerate(zip(numbers, axes, strict=True)):
        shape = visual(box(" ".join(map(str, EDGES[i]))), xyz="0 0 0.05") if drawn else ""
        parent = f"l{i - 1}" if i else "base"
        parts += [
            joint(f"j{i}", parent, f"l{i}", kind="continuous", axis=axis, xyz="0.1 0.2 0.4"),
            link(f"l{i}", format_inertial(one, 6), shape),
        ]
    return robot(*parts)


def make_part(i: int) -> DeclaredInertial:
    tensor = compute_solid_inertia(make_box_solid(EDGES[i]), MASSES[i])
    return DeclaredInertial(MASSES[i], np.array((0.0, 0.0, 0.05)), tensor)


def add_rotor(i: int, rotor: float, axis: str) -> DeclaredInertial:
    part, about = make_part(i), np.array([float(word) for word in axis.split()])
    return DeclaredInertial(part.mass, part.com, part.tensor + rotor * np.outer(about, about))


ROTORS = (1.0, 0.4, 0.18, 0.18, 0.05)


@pytest.mark.parametrize("drawn", [True, False])
def test_rotors_that_were_added_to_their_links_are_one_finding(tmp_path: Path, drawn: bool) -> None:
    numbers = [add_rotor(i, rotor, axis) for i, (rotor, axis) in enumerate(zip(ROTORS, AXES, strict=True))]
    (finding,) = find(tmp_path, make_chain(numbers, drawn=drawn), {"INR003", "INR005", "INR009"})
    assert (finding.code, finding.message_id, finding.severity) == ("INR003", "rotor", Severity.ERROR)
    assert finding.cause is not None
    assert finding.cause.id == "rotor"
    assert "l0, l1, l2, l3, l4" in finding.message or len(finding.subjects) == 5
    assert finding.fix is not None
    assert not finding.fix.edits
    assert "decimal" not in finding.fix.title


@pytest.mark.parametrize(
    ("about", "axes"),
    [
        (("0 0 1", "1 0 0", "0 1 0", "0 0 1", "1 0 0"), AXES),  # about other axes than the joints'
        (
            ("0 0 1",) * 5,
            ("0 0 1",) * 5,
        ),  # all joints about one axis of their links: the entry may be wrong for any reason
    ],
)
def test_moments_about_other_axes_are_no_rotors(tmp_path: Path, about: tuple[str, ...], axes: tuple[str, ...]) -> None:
    numbers = [add_rotor(i, rotor, axis) for i, (rotor, axis) in enumerate(zip(ROTORS, about, strict=True))]
    found = find(tmp_path, make_chain(numbers, axes), "INR003")
    assert found
    assert "rotor" not in {finding.message_id for finding in found}


@pytest.mark.parametrize(("second", "is_rotor"), [(0.0012, True), (0.0013, False)])
def test_one_number_added_to_the_moments_about_the_axes_of_all_joints_is_a_rotor(
    tmp_path: Path, second: float, is_rotor: bool
) -> None:
    """All joints have one axis, and copies leave two tensors: what both have more about that axis is the same number."""
    moments = [(0.0001, 0.0001, 0.0011), (0.0002, 0.0002, second)]
    numbers = [DeclaredInertial(0.2, np.array((0.0, 0.0, 0.05)), np.diag(moments[i % 2])) for i in range(5)]
    found = find(tmp_path, make_chain(numbers, ("0 0 1",) * 5, drawn=False), "INR003")
    assert found
    assert all((finding.message_id == "rotor") == is_rotor for finding in found)


def slip_izz(count: int) -> list[DeclaredInertial]:
    """One joint axis, so that nothing else explains the numbers."""
    return [
        DeclaredInertial(part.mass, part.com, part.tensor * np.diag((1.0, 1.0, 100.0)))
        if i < count
        else DeclaredInertial(part.mass, part.com, part.tensor)
        for i, part in ((i, make_part(i)) for i in range(5))
    ]


@pytest.mark.parametrize(("count", "named"), [(1, True), (2, True), (3, False), (5, False)])
def test_a_decimal_point_slips_in_one_or_two_links_only(tmp_path: Path, count: int, named: bool) -> None:
    found = find(tmp_path, make_chain(slip_izz(count), ("0 0 1",) * 5), "INR003")
    assert found
    assert all((finding.cause is not None and finding.cause.id == "decimal") == named for finding in found)


def test_all_tensors_in_another_unit_are_no_decimal_point_and_one_finding(tmp_path: Path) -> None:
    """Tensors in g·m² with the axes of another frame, one of which breaks the triangle inequality."""
    numbers = []
    for i in range(5):
        part = make_part(i)
        turned = np.roll(np.diag(part.tensor), 1) * (1.3, 0.9, 1.1)
        numbers.append(DeclaredInertial(part.mass, part.com + 0.02, 1e3 * np.diag(turned)))
    broken = numbers[4].tensor * np.diag((1.0, 1.0, 0.1))
    numbers[4] = DeclaredInertial(numbers[4].mass, numbers[4].com, broken)
    found = {finding.code: finding for finding in find(tmp_path, make_chain(numbers), {"INR003", "INR005"})}
    assert set(found) == {"INR003", "INR005"}
    assert "in g·m², 4 of 5 tensors of the file fit what their links draw" in found["INR003"].message
    assert found["INR003"].cause is None
    finding = found["INR005"]
    assert (finding.message_id, finding.severity) == ("unit", Severity.ERROR)
    assert finding.headline == "5 links: inertia far too large (file in g·m², not kg·m²?)"
    assert finding.fix is not None
    assert finding.fix.title.startswith("divide every tensor of the file by 1,000")
    assert not finding.fix.edits


def find_exceeding(folder: Path, numbers: list[DeclaredInertial]) -> list[Finding]:
    return find(folder, make_chain(numbers), "INR005")


def test_tensors_about_the_root_frame(tmp_path: Path) -> None:
    numbers, place = [], np.zeros(3)
    for i in range(5):
        part = make_part(i)
        place = place + np.array((0.1, 0.2, 0.4))
        tensor = part.tensor + steiner(part.mass, place + part.com)
        numbers.append(DeclaredInertial(part.mass, part.com, tensor))
    found = find_exceeding(tmp_path, numbers)
    assert found
    for finding in found:
        assert "5 links the tensor is the drawn part's about the origin of base, the root link" in finding.message
    half = [*numbers[:2], *(make_part(i) for i in range(2, 5))]
    for finding in find_exceeding(tmp_path / "few", half):
        assert "root" not in finding.message


def test_a_unit_of_one_link_is_not_named_where_another_link_is_in_kg_m2(tmp_path: Path) -> None:
    numbers = DeclaredInertial(20.0, np.array((0.0, 0.0, -0.4)), 1e6 * np.diag((0.2, 0.5, 0.3)))
    alone = arm_on_base(format_inertial(numbers), visual(box("0.4 0.3 1.5")))
    other = link("other", format_inertial(make_part(0), 6), visual(box("0.1 0.08 0.3"), xyz="0 0 0.05"))
    beside = arm_on_base(
        format_inertial(numbers),
        visual(box("0.4 0.3 1.5")),
        more=other + joint("k", "base", "other", kind="continuous", xyz="3 0 0"),
    )
    (finding,) = find(tmp_path / "alone", alone, "INR005")
    assert finding.message.endswith("The same numbers fit the drawn part in kg·mm²")
    (finding,) = find(tmp_path / "beside", beside, "INR005")
    assert "kg·mm²" not in finding.message


def test_a_com_that_was_left_at_zero_is_said_in_words(tmp_path: Path) -> None:
    tensor = compute_solid_inertia(make_box_solid((0.05, 0.05, 0.4)), 1.0)
    xx, yy, zz = (f"{value:.8g}" for value in np.diag(tensor))
    text = arm_on_base(inertial(1.0, ixx=xx, iyy=yy, izz=zz, com="0 0 0"), visual(box("0.05 0.05 0.4"), xyz="0 0 0.3"))
    (finding,) = find(tmp_path, text, {"INR005"})
    assert finding.message.endswith("Mass and tensor are the drawn part's: only the COM is missing")
    assert finding.fix is not None
    assert 'write xyz="0 0 0.3"' in finding.fix.title


# -- one link ------------------------------------------------------------------------------------------------------------

MIRROR = np.diag((1.0, -1.0, 1.0))
DRAWN = geometry(CASTING)
TRUE = uniform(DRAWN.solid)


def find_disagreeing(folder: Path, numbers: DeclaredInertial, digits: int = 8) -> list[Finding]:
    return find(folder, arm_on_base(format_inertial(numbers, digits), drawn_boxes(CASTING)), "INR009")


def test_a_tensor_that_was_not_mirrored_keeps_its_com(tmp_path: Path) -> None:
    numbers = replace(TRUE, tensor=MIRROR @ TRUE.tensor @ MIRROR)
    (finding,) = find_disagreeing(tmp_path, numbers)
    assert finding.cause is not None
    assert finding.cause.id == "unmirrored"
    assert finding.headline == "arm: wrong inertia (not mirrored)"
    assert finding.fix is not None
    assert finding.fix.edits
    assert "xyz" not in finding.fix.title
    text = arm_on_base(format_inertial(numbers), drawn_boxes(CASTING))
    assert not find(tmp_path / "repaired", edited(text, finding.fix.edits), "INR009")


@pytest.mark.parametrize(("place", "count"), [("0 0 0", 0), ("0 0 1", 1)])
def test_numbers_are_not_blamed_for_a_part_that_is_drawn_twice_in_one_place(
    tmp_path: Path, place: str, count: int
) -> None:
    """The numbers of the right arm are the mirror image of what it draws, which is the left arm."""
    mirrored = replace(TRUE, com=MIRROR @ TRUE.com, tensor=MIRROR @ TRUE.tensor @ MIRROR)
    arms = [
        link(f"{name}_arm", format_inertial(numbers), drawn_boxes(CASTING))
        + joint(f"{name}_joint", "base", f"{name}_arm", kind="fixed", xyz=at)
        for name, numbers, at in (("left", TRUE, "0 0 0"), ("right", mirrored, place))
    ]
    assert len(find(tmp_path, robot(link("base"), *arms), "INR009")) == count


def test_products_of_the_other_sign_are_no_mirror_image_where_one_of_them_is_small(tmp_path: Path) -> None:
    """A mirror image explains the two large products as well; that it was copied without its COM is rarer."""
    flat = (((0.2, 0.06, 0.04), (0.03, 0.01, 0.0)), ((0.04, 0.05, 0.12), (0.12, 0.016, 0.08)))
    declared = [[2.082e-3, 1.088e-4, 1.517e-3], [1.088e-4, 5.668e-3, 9.756e-5], [1.517e-3, 9.756e-5, 4.167e-3]]
    com = np.array((0.0625, 0.0129, 0.0251))  # 3 mm off the drawn part's
    numbers = replace(uniform(geometry(flat).solid), tensor=np.array(declared), com=com)
    (finding,) = find(tmp_path, arm_on_base(format_inertial(numbers, 8), drawn_boxes(flat)), "INR009")
    assert finding.cause is not None
    assert finding.cause.id == "products_sign"


def test_a_cause_stays_in_a_headline_that_has_no_room_for_the_factor(tmp_path: Path) -> None:
    numbers = replace(TRUE, tensor=TRUE.tensor + steiner(TRUE.mass, TRUE.com))
    headlines = {}
    for name in ("arm", "left_forearm_link"):
        text = arm_on_base(format_inertial(numbers, 8), drawn_boxes(CASTING)).replace('"arm"', f'"{name}"')
        (finding,) = find(tmp_path / name, text, "INR009")
        headlines[name] = finding.headline
    assert headlines == {
        "arm": "arm: inertia up to 2.9× too large (about the origin, not the COM)",
        "left_forearm_link": "left_forearm_link: wrong inertia (about the origin, not the COM)",
    }


def test_a_com_and_tensor_that_were_not_mirrored_are_both_written(tmp_path: Path) -> None:
    numbers = replace(TRUE, com=MIRROR @ TRUE.com, tensor=MIRROR @ TRUE.tensor @ MIRROR)
    (finding,) = find_disagreeing(tmp_path, numbers)
    assert finding.headline == "arm: wrong COM and inertia (not mirrored)"


def test_a_tensor_that_is_wrong_in_another_way_is_not_said_to_fit_the_mirror_image(tmp_path: Path) -> None:
    bar = (((0.02, 0.06, 0.025), (0.0, -0.01, -0.03)), ((0.02, 0.02, 0.02), (0.0, -0.035, -0.045)))
    part, upright = uniform(geometry(bar).solid), np.diag((1.0, 1.0, -1.0))
    smaller = np.diag(np.sqrt((0.5, 1.0, 0.41)))
    tensor = smaller @ upright @ part.tensor @ upright @ smaller
    numbers = replace(part, com=upright @ part.com, tensor=tensor)
    findings = find(tmp_path, arm_on_base(format_inertial(numbers, 10), drawn_boxes(bar)), "INR009")
    assert [finding.headline for finding in findings] == ["arm: suspect COM (not mirrored?)"]
    (finding,) = findings
    assert finding.cause is not None
    assert finding.cause.text.endswith("The tensor fits neither.")
    assert finding.fix is not None
    assert not finding.fix.edits
    assert finding.fix.title.startswith("compute the inertial again")


def test_products_of_one_digit_that_are_next_to_nothing_have_no_sign() -> None:
    """The thinnest direction of a plate shows products of 0.7 % of the largest moment."""
    plate = geometry((((0.3, 0.3, 0.02), (0.0, 0.0, 0.0)), ((0.02, 0.02, 0.1), (0.1, 0.1, 0.04))))
    part = uniform(plate.solid)
    unit = float(part.tensor.diagonal().max())
    for digits, share in ((0, 0.007), (3, 0.007123)):
        products = share * unit * np.array([[0.0, 1.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 0.0]])
        products = np.vectorize(lambda value, digits=digits: float(f"{value:.{digits}e}"))(products)
        declared = replace(part, tensor=np.diag(part.tensor.diagonal()) + products)
        assert has_coarse_products(declared) == (digits == 0)


@pytest.mark.parametrize("signs", [1.0, -1.0])
def test_a_com_that_was_never_filled_in_beside_tensors_about_the_origin(tmp_path: Path, signs: float) -> None:
    other_signs = np.where(np.eye(3, dtype=bool), 1.0, signs)
    numbers = []
    for i in range(5):
        part = make_part(i)
        place = np.array((0.0, 0.0, 0.05))
        tensor = (part.tensor + steiner(part.mass, place)) * other_signs
        numbers.append(DeclaredInertial(part.mass, np.zeros(3), tensor))
    (finding,) = find(tmp_path, make_chain(numbers), {"INR009", "INR005"})
    assert finding.message_id == "habit"
    assert finding.headline == "5 of 5 links: wrong COM and inertia (COM left at zero)"
    assert "COM left at zero: tensor about the link's origin" in finding.message


@pytest.mark.parametrize(("masses", "is_placeholder"), [((0.3, 0.5, 2.0), True), ((0.3, 0.3, 0.3), False)])
def test_one_tensor_of_a_line_for_links_of_all_masses_is_a_placeholder(
    tmp_path: Path, masses: tuple[float, ...], is_placeholder: bool
) -> None:
    parts = [link("base")]
    for i, mass in enumerate(masses):
        parts += [
            joint(f"j{i}", "base", f"l{i}", kind="continuous", xyz=f"0 0 {i}"),
            link(f"l{i}", inertial(mass, ixx="1.0", iyy="1.0", izz="0.0")),
        ]
    found = find(tmp_path, robot(*parts), "INR004")
    assert found
    for finding in found:
        assert finding.message_id == "line"
        assert finding.fix is not None
        assert ("third moment" in finding.fix.title) != is_placeholder
        assert ("3 links of 0.3 to 2 kg have these numbers (1, 1, 0)" in finding.message) == is_placeholder


@pytest.mark.parametrize(
    ("moments", "words"),
    [
        ((0.2, 1.0, 0.8), "one moment 5× too small"),
        ((0.2, 1.0, 0.25), "inertia up to 5× too small"),
        ((0.2, 0.2, 1.0), "two moments 5× too small"),
    ],
)
def test_moments_that_are_wrong_alike_are_counted(moments: tuple[float, ...], words: str) -> None:
    wrong, right = np.sort(np.array(moments)), np.ones(3)
    assert compare_sizes(wrong, right, "{inertia} {factor}× too {size}", digits=2) == words


@pytest.mark.parametrize(
    ("rpy", "words"), [("0 0 0", "up to 5.01 times too small"), ("0.5 0.6 0.7", "up to 4.24 times too small")]
)
def test_moments_are_compared_axis_by_axis_where_the_axes_agree(tmp_path: Path, rpy: str, words: str) -> None:
    """The drawn moments are 2.604, 8.854, 10.42: that about z is five times too small, and the smallest one by a quarter."""
    numbers = inertial(100.0, rpy=rpy, ixx=2.09, iyy=4.16, izz=2.08)
    (finding,) = find(tmp_path, arm_on_base(numbers, visual(box("1 0.5 0.25"))), "INR009")
    assert words in finding.message


def test_the_sentence_of_each_cause_can_be_said_of_most_links_of_a_file() -> None:
    """A file in which all links are turned alike is told by the same sentence as one link."""
    for cause, sentence in load_rules()["INR009"].causes.items():
        needed = {name for _, name, _, _ in Formatter().parse(sentence) if name}
        assert needed <= collect_cause_data(cause, "x").keys(), cause


def test_one_tensor_that_links_of_several_masses_have_shows_no_unit_of_the_file(tmp_path: Path) -> None:
    """It is that of the first part in lb·ft², and the others are about as large."""
    sizes, masses = (
        ((0.2, 0.15, 0.1), (0.21, 0.14, 0.1), (0.19, 0.15, 0.11), (0.2, 0.16, 0.09)),
        (0.36, 0.34, 0.33, 0.32),
    )
    x, y, z = sizes[0]
    moments = [
        f"{masses[0] / 12 * sum_of_squares / 0.0421401:.6g}"
        for sum_of_squares in (y * y + z * z, x * x + z * z, x * x + y * y)
    ]
    parts = [link("base")]
    for i, (size, mass) in enumerate(zip(sizes, masses, strict=True)):
        typed = inertial(mass, ixx=moments[0], iyy=moments[1], izz=moments[2])
        parts.append(link(f"l{i}", typed, visual(box(" ".join(map(str, size))))))
        parent = f"l{i - 1}" if i else "base"
        parts.append(joint(f"j{i}", parent, f"l{i}", kind="continuous", axis="0 0 1", xyz="0.1 0 0"))
    assert "habit" not in {finding.message_id for finding in find(tmp_path, robot(*parts), "INR009")}


@pytest.mark.parametrize(("other", "is_named"), [("0 -0.33 0", False), ("0 -0.0225 0", True)])
def test_a_row_of_coms_in_another_frame_has_no_lost_point(tmp_path: Path, other: str, is_named: bool) -> None:
    """The COM of one part is ten times as far as it should be; that of its copy, which is rotated, is somewhere else."""
    parts = [link("base")]
    for i, (com, (x, y, z)) in enumerate((("0 -0.225 0", (0.03, 0.06, 0.07)), (other, (0.07, 0.06, 0.03)))):
        moments = {"ixx": 0.03 * (y * y + z * z), "iyy": 0.03 * (x * x + z * z), "izz": 0.03 * (x * x + y * y)}
        typed = inertial(0.36, com=com, **{name: f"{value:.6g}" for name, value in moments.items()})
        parts.append(link(f"servo{i}", typed, visual(box(f"{x} {y} {z}"), xyz="0 -0.0225 0")))
        parts.append(joint(f"j{i}", "base", f"servo{i}", kind="continuous", axis="0 0 1", xyz=f"{i} 0 0"))
    found = find(tmp_path, robot(*parts), {"INR006", "INR009"})
    causes = {finding.cause and finding.cause.id for finding in found if "servo0" in finding.message}
    assert ("decimal_point" in causes) is is_named


@pytest.mark.parametrize(("others", "is_named"), [("0.6 -0.5 -0.9", False), ("0 0.01 0.02", True)])
def test_a_lost_point_is_not_named_where_most_coms_are_in_another_frame(
    tmp_path: Path, others: str, is_named: bool
) -> None:
    """The COMs of an arm are in another frame: the first happens to be ten times as far as it should be."""
    parts = [link("base")]
    for i, com in enumerate(("0 0.1 0.2", others, others)):
        x, y, z, mass = 0.04, 0.06 + 0.01 * i, 0.1, 1.2 - 0.3 * i
        moments = {"ixx": y * y + z * z, "iyy": x * x + z * z, "izz": x * x + y * y}
        typed = inertial(mass, com=com, **{name: f"{mass / 12 * value:.6g}" for name, value in moments.items()})
        parts.append(link(f"l{i}", typed, visual(box(f"{x} {y} {z}"), xyz="0 0.01 0.02")))
        parent = f"l{i - 1}" if i else "base"
        parts.append(joint(f"j{i}", parent, f"l{i}", kind="continuous", axis="0 0 1", xyz="0 0.6 0"))
    found = find(tmp_path, robot(*parts), {"INR006", "INR009"})
    causes = {finding.cause and finding.cause.id for finding in found if "l0" in finding.message}
    assert ("decimal_point" in causes) is is_named
