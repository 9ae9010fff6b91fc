"""What findings about inertials must not claim: hulls that are no part, units of a few links, and agreement by construction."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import arm_on_base, box, collision, cylinder, find, inertial, joint, link, mesh, robot, visual
from castings import CASTING, drawn_boxes, format_inertial, geometry, pieces, steiner, uniform, write_stl

from urdfcheck.core import Severity
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.inertia_tensor import Solid, combine_solids, compute_solid_inertia, make_box_solid

# Three bars side by side, whose centres are not in one line.
BARS = (
    ((0.080, 0.010, 0.011), (0.0, 0.0, 0.0)),
    ((0.070, 0.012, 0.010), (0.004, 0.013, 0.001)),
    ((0.060, 0.011, 0.012), (-0.003, 0.004, 0.014)),
)


def add_points(solids: tuple[Solid, ...], mass: float) -> DeclaredInertial:
    """Return the numbers of solids whose own tensors were left out."""
    whole = combine_solids(solids)
    tensor = sum(
        (steiner(mass * one.volume / whole.volume, one.com - whole.com) for one in solids),
        np.zeros((3, 3)),
    )
    return DeclaredInertial(mass, whole.com, tensor)


# -- pieces that count as points ---------------------------------------------------------------------------------------


def test_tensors_of_pieces_that_were_left_out_are_named(tmp_path: Path) -> None:
    write_stl(tmp_path / "bars.stl", BARS)
    numbers = add_points(pieces(BARS), 0.02)
    text = arm_on_base(format_inertial(numbers, 10), visual(mesh("bars.stl")))
    found = find(tmp_path, text, {"INR003", "INR009"})
    assert [(finding.code, finding.cause and finding.cause.id) for finding in found] == [("INR009", "own_missing")]
    (finding,) = found
    assert "parallel-axis terms of its bodies, to within 5 %" in finding.message
    own = compute_solid_inertia(combine_solids(pieces(BARS)), 0.02)
    assert finding.fix is not None
    written = {edit.replacement for edit in finding.fix.edits}
    assert f"{own[0, 0]:.6g}" in {f"{float(text):.6g}" for text in written}


def test_rounding_does_not_hide_that_pieces_are_points(tmp_path: Path) -> None:
    # Three points: the smallest moments add up to the largest, and the typed digits break the inequality.
    flat = tuple(((a, b, 0.01), (x, y, 0.0)) for (a, b, _), (x, y, _) in BARS)
    write_stl(tmp_path / "bars.stl", flat)
    numbers = add_points(pieces(flat), 0.02)
    excess = replace(numbers, tensor=numbers.tensor + np.diag((0.0, 0.0, 4e-6 * numbers.tensor[2, 2])))
    links = [link("base")]
    for name in ("one", "other"):
        links += [
            joint(f"j_{name}", "base", name, kind="continuous", xyz="0 0 1" if name == "one" else "0 1 0"),
            link(name, format_inertial(excess, 5), visual(mesh("bars.stl"))),
        ]
    found = find(tmp_path, robot(*links), {"INR003", "INR009"})
    assert [(finding.code, finding.message_id) for finding in found] == [("INR009", "habit")]
    assert found[0].headline == "2 of 2 links: wrong inertia (own tensors of the pieces left out)"


def test_a_small_tensor_that_is_not_that_of_points_is_another_matter(tmp_path: Path) -> None:
    write_stl(tmp_path / "bars.stl", BARS)
    numbers = add_points(pieces(BARS), 0.02)
    other = replace(numbers, tensor=numbers.tensor * (1.0 + 0.2 * np.eye(3)))
    found = find(tmp_path, arm_on_base(format_inertial(other, 10), visual(mesh("bars.stl"))), {"INR009"})
    assert not any(finding.cause is not None and finding.cause.id == "own_missing" for finding in found)


# -- hulls ---------------------------------------------------------------------------------------------------------------


def write_stray(path: Path) -> None:
    """A casting with a pin far away, one of whose facets is missing."""
    write_stl(path, [*CASTING, ((0.005, 0.005, 0.005), (-2.0, 0.0, 9.0))])
    text = path.read_text(encoding="ascii")
    path.write_text(text[: text.rindex("facet normal")] + "endsolid part\n", encoding="ascii")


@pytest.mark.parametrize("factor", [1.0, 0.2])
def test_a_hull_around_a_stray_piece_is_not_the_part(tmp_path: Path, factor: float) -> None:
    write_stray(tmp_path / "stray.stl")
    numbers = uniform(geometry(CASTING).solid)
    wrong = replace(numbers, tensor=factor * numbers.tensor)
    text = arm_on_base(format_inertial(wrong), visual(mesh("stray.stl")))
    assert not find(tmp_path, text, {"INR009"}, pedantic=True)


def test_a_stray_piece_is_no_matter_of_scale(tmp_path: Path) -> None:
    write_stray(tmp_path / "stray.stl")
    shape = collision(box("0.25 0.25 0.2"), xyz="0.03 0.08 0.08")
    (finding,) = find(tmp_path, arm_on_base("", visual(mesh("stray.stl")) + shape), {"GEO003"})
    assert (finding.message_id, finding.data["role"], finding.data["triangles"]) == ("stray", "visual", 11)
    assert finding.data["distance"] == pytest.approx(9.2, abs=0.1)


def test_a_mesh_in_millimetres_has_no_stray_piece(tmp_path: Path) -> None:
    write_stl(tmp_path / "part.stl", CASTING)
    shown = visual(mesh("part.stl", "1000 1000 1000")) + collision(mesh("part.stl"))
    (finding,) = find(tmp_path, arm_on_base("", shown), {"GEO003"})
    assert finding.message_id == "size"


# -- units ---------------------------------------------------------------------------------------------------------------


def make_plates(factors: list[float]) -> str:
    """Plates of different sizes, each with its own mass in another unit."""
    parts = [link("base")]
    for i, factor in enumerate(factors):
        size = (0.3 + 0.02 * i, 0.2 - 0.005 * i, 0.1 + 0.01 * i)
        tensor = compute_solid_inertia(make_box_solid(size), 4.0 + i)
        edges = " ".join(f"{edge:g}" for edge in size)
        parts += [
            joint(f"j{i}", "base", f"l{i}", kind="continuous", xyz=f"0 0 {i}"),
            link(
                f"l{i}",
                format_inertial(DeclaredInertial(4.0 + i, np.zeros(3), tensor * factor)),
                visual(box(edges)),
            ),
        ]
    return robot(*parts)


def test_a_unit_is_that_of_most_links_or_of_none(tmp_path: Path) -> None:
    most = find(tmp_path / "most", make_plates([1e4] * 7 + [1.0]), {"INR009"})
    few = find(tmp_path / "few", make_plates([1e4] * 3 + [1.0] * 7), {"INR009"})
    assert [finding.message_id for finding in most] == ["habit"]
    assert "habit" not in {finding.message_id for finding in few}


def test_a_large_tensor_is_offered_in_the_one_unit_in_which_it_is_possible(tmp_path: Path) -> None:
    """The COM is far from the drawn part's, so that its uniform tensor says little."""
    numbers = DeclaredInertial(20.0, np.array((0.0, 0.0, -0.4)), 1e6 * np.diag((0.2, 0.5, 0.3)))
    text = arm_on_base(format_inertial(numbers), visual(box("0.4 0.3 1.5")))
    (finding,) = find(tmp_path, text, {"INR005"})
    assert finding.message.endswith("The same numbers fit the drawn part in kg·mm²")
    assert finding.fix is not None
    assert 'write ixx="0.2" ixy="0" ixz="0" iyy="0.5" iyz="0" izz="0.3" if they are in kg·mm²' in finding.fix.title
    assert finding.fix.edits == ()


def test_an_impossible_tensor_of_another_size_is_not_made_possible(tmp_path: Path) -> None:
    text = arm_on_base(inertial(0.009, ixx="1e-4", iyy="0.02", izz="0.0206"), visual(box("0.06 0.04 0.003")))
    (finding,) = find(tmp_path, text, {"INR003", "INR005"})
    assert finding.code == "INR003"
    assert "5,200 times the drawn part's, and at least 110 times what its size allows" in finding.message
    assert finding.fix is not None
    assert "nearest possible tensor" not in finding.fix.title
    assert "(the drawn part at this mass and uniform density)" in finding.fix.title


def test_a_moment_of_the_drawn_part_shows_that_the_others_are_its_own_too(tmp_path: Path) -> None:
    """A wheel whose transverse moments were typed as 0.025/12: the nearest possible tensor would be that of a disc."""
    wheel = inertial(1, ixx="0.00208", iyy="0.00208", izz="0.005")
    (finding,) = find(tmp_path, arm_on_base(wheel, visual(cylinder(0.1, 0.05))), {"INR003"})
    assert finding.fix is not None
    assert 'write ixx="0.002708" iyy="0.002708" (the drawn part' in finding.fix.title


def test_the_moment_of_a_thin_rod_about_its_axis_is_small_and_not_zero(tmp_path: Path) -> None:
    text = arm_on_base(inertial(10, ixx="1e2", iyy="1e4", izz="1.03e4"), visual(box("0.03 0.03 1.5")))
    (finding,) = find(tmp_path, text, {"INR003"})
    assert finding.fix is not None
    assert 'iyy="1.876"' in finding.fix.title
    assert 'izz="0.0015"' in finding.fix.title


def test_a_drawing_that_no_material_fills_is_no_model(tmp_path: Path) -> None:
    text = arm_on_base(inertial(100, ixx="1e3", iyy="1e5", izz="1.03e5"), visual(box("0.03 0.03 1.5")))
    (finding,) = find(tmp_path, text, {"INR003"})
    assert finding.fix is not None
    assert "ixx" not in finding.fix.title


@pytest.mark.parametrize(("com", "start"), [("0 0 1", "compute"), ("0 0 0", "write"), ("0 0 0.01", "write")])
def test_a_primitive_far_from_the_com_that_was_typed_marks_the_link(tmp_path: Path, com: str, start: str) -> None:
    """The weight of a pendulum is at its end, and not where the bar is drawn: the bar's numbers are only to compare with."""
    text = arm_on_base(inertial(10, com=com, ixx="0", iyy="10", izz="0.083"), visual(box("0.1 0.1 1")))
    (finding,) = find(tmp_path, text, {"INR003"})
    assert finding.fix is not None
    assert finding.fix.title.startswith(start)
    assert ("; for comparison: " in finding.fix.title) == (start == "compute")


@pytest.mark.parametrize(
    ("numbers", "is_shown"),
    [({"ixy": "0.01", "ixz": "0.1", "iyz": "0.01", "izz": "0.1"}, False), ({"izz": "0.3"}, True)],
)
def test_numbers_of_one_digit_with_products_have_no_nearest_tensor(
    tmp_path: Path, numbers: dict[str, str], is_shown: bool
) -> None:
    """A product as large as the moments is not rounded but wrong, and nothing shows which number is right."""
    text = arm_on_base(inertial("30", "0.1", **numbers))
    (finding,) = find(tmp_path, text, {"INR003"})
    assert finding.fix is not None
    assert ("the nearest possible" in finding.fix.title) == is_shown


def test_an_impossible_tensor_beyond_the_drawn_size_gets_no_nearest_one(tmp_path: Path) -> None:
    """A scanner of 0.2 kg whose moments are those of something ten times as wide; the body that it is fixed to hides that."""
    scanner = inertial(0.2, ixx="0.0528", iyy="0.0202", izz="0.0235")
    text = arm_on_base(scanner, visual(box("0.085 0.1 0.07")), base=inertial(50, 5), kind="fixed")
    (finding,) = find(tmp_path, text, "INR003")
    assert finding.message_id == "fused"
    assert "times the drawn part's" in finding.message
    assert finding.fix is not None
    assert "nearest possible tensor" not in finding.fix.title


@pytest.mark.parametrize(("scale", "message_id"), [(1e9, "oversized"), (1.0, "rounded")])
def test_more_digits_do_not_repair_a_tensor_of_another_size(tmp_path: Path, scale: float, message_id: str) -> None:
    """A thin rod whose tensor was rounded to four digits."""
    moments = {name: f"{scale * value:.4g}" for name, value in (("ixx", 2e-9), ("iyy", 7.503e-5), ("izz", 7.504e-5))}
    text = arm_on_base(inertial(0.01, **moments), visual(box("0.3 0.003 0.001")))
    (finding,) = find(tmp_path, text, "INR003")
    is_oversized = message_id == "oversized"
    assert (finding.message_id, finding.severity) == (
        message_id,
        Severity.ERROR if is_oversized else Severity.WARNING,
    )
    assert finding.fix is not None
    assert ("significant digits" in finding.fix.title) != is_oversized


@pytest.mark.parametrize(("radius", "is_rounded"), [("0.05", False), ("0.02", True)])
def test_moments_of_zero_are_rounded_only_where_the_drawn_part_has_small_ones(
    tmp_path: Path, radius: str, is_rounded: bool
) -> None:
    """A cylinder of 1 kg has 0.0015 kg·m² across, which does not round to 0 beside 0.001; a smaller one has 0.0009."""
    text = arm_on_base(inertial(1, ixx="0", iyy="0.001", izz="0"), visual(cylinder(radius, "0.1")))
    (finding,) = find(tmp_path, text, "INR003")
    assert (finding.cause is not None) == is_rounded
    assert finding.fix is not None
    assert ('ixx="0.001458" iyy="0.001458" izz="0.00125"' in finding.fix.title) != is_rounded
    assert ("ixx, izz are 0, as if never filled in" in finding.message) != is_rounded


def test_a_tensor_that_exceeds_is_undone_like_those_of_other_links(tmp_path: Path) -> None:
    """A shin whose numbers fit no drawing exactly, in a file whose thighs have their tensors about the link's origin."""
    true = uniform(geometry(CASTING).solid)
    thigh = replace(true, tensor=true.tensor + steiner(true.mass, true.com))
    box_tensor = compute_solid_inertia(make_box_solid((0.03, 0.03, 0.24)), 0.13)
    shin = DeclaredInertial(0.13, np.array((0.009, 0.007, -0.13)), 1.3 * box_tensor)
    shin = replace(shin, tensor=shin.tensor + steiner(shin.mass, shin.com))
    calf = link("shin", format_inertial(shin), visual(box("0.03 0.03 0.24"), xyz="0 0 -0.12"))
    text = arm_on_base(
        format_inertial(thigh), drawn_boxes(CASTING), more=calf + joint("knee", "arm", "shin", kind="continuous")
    )
    (finding,) = (f for f in find(tmp_path, text, {"INR005", "INR009"}) if "shin" in f.message)
    assert finding.code == "INR005"
    assert "possible without the mistake of arm: tensor about the origin" in finding.message
    assert finding.fix is not None
    assert not finding.fix.edits
    assert f'ixx="{1.3 * box_tensor[0, 0]:.5g}' in finding.fix.title


@pytest.mark.parametrize("is_com_of_shell", [True, False])
def test_a_hollow_part_with_the_com_of_its_shell_needs_no_repair(tmp_path: Path, is_com_of_shell: bool) -> None:
    blocks = (((0.08, 0.08, 0.08), (0.0, 0.0, 0.0)), ((0.01, 0.08, 0.12), (0.0, 0.0, 0.1)))
    write_stl(tmp_path / "hand.stl", blocks)
    drawn = geometry(blocks)
    assert drawn.shell is not None
    com = drawn.shell.com if is_com_of_shell else drawn.solid.com
    numbers = DeclaredInertial(2.0, com, compute_solid_inertia(drawn.shell, 2.0))
    (finding,) = find(tmp_path, arm_on_base(format_inertial(numbers), visual(mesh("hand.stl"))), "INR009")
    assert finding.cause is not None
    assert finding.cause.id == "shell"
    assert (finding.message_id == "hollow") == is_com_of_shell
    assert finding.fix is not None
    assert finding.fix.title.startswith("nothing if the part is hollow") == is_com_of_shell


# -- what disagrees, and what stays so -----------------------------------------------------------------------------------


def test_a_com_that_disagrees_is_what_the_finding_says(tmp_path: Path) -> None:
    blocks = (((0.06, 0.06, 0.006), (0.0, 0.0, 0.0)), ((0.008, 0.008, 0.04), (0.0, 0.0, 0.023)))
    largest = float(compute_solid_inertia(combine_solids(pieces(blocks)), 0.14)[2, 2])
    flat = np.diag((0.5005 * largest, 0.5005 * largest, largest))  # next to no mass above or below the middle
    numbers = DeclaredInertial(0.14, np.array((0.002, 0.001, 0.018)), flat)
    (finding,) = find(tmp_path, arm_on_base(format_inertial(numbers), drawn_boxes(blocks)), {"INR009"})
    assert (finding.message_id, finding.severity) == ("disagrees", Severity.INFO)
    assert finding.headline == "arm: COM 15.7 mm from that of the drawn part"
    assert finding.fix is not None
    assert 'for comparison: xyz="0 0 0.002437"' in finding.fix.title


@pytest.mark.parametrize(("factor", "severity"), [(0.02, Severity.INFO), (0.005, Severity.WARNING)])
def test_moments_a_hundred_times_too_small_are_a_warning(tmp_path: Path, factor: float, severity: Severity) -> None:
    own = uniform(geometry(CASTING).solid)
    slanted = own.tensor * factor + np.diag((0.3 * factor * own.tensor[0, 0], 0.0, 0.0))
    numbers = replace(own, com=own.com + np.array((0.013, -0.011, 0.007)), tensor=slanted)
    found = find(tmp_path, arm_on_base(format_inertial(numbers), drawn_boxes(CASTING)), {"INR009"})
    assert [(finding.message_id, finding.severity) for finding in found] == [("disagrees", severity)]
    assert (severity == Severity.WARNING) == found[0].headline.endswith("× too small")


@pytest.mark.parametrize(("off", "hint"), [(0.0, True), (0.02, False)])
def test_what_is_far_too_small_about_the_right_com_may_lack_the_term_of_several_bodies(
    tmp_path: Path, off: float, hint: bool
) -> None:
    cubes = [((0.04, 0.05, 0.06), (0.0, 0.0, sign * 0.2)) for sign in (-1, 1)]
    write_stl(tmp_path / "part.stl", cubes)
    own = uniform(geometry(cubes).solid)
    alone = compute_solid_inertia(make_box_solid((0.04, 0.05, 0.06)), own.mass) * np.diag((1.6, 1.1, 1.3))
    numbers = replace(own, com=own.com + np.array((off, 0.0, 0.0)), tensor=alone)
    (finding,) = find(tmp_path, arm_on_base(format_inertial(numbers), visual(mesh("part.stl"))), {"INR009"})
    assert finding.message_id == "disagrees"
    assert ("parallel-axis" in finding.message) == hint


@pytest.mark.parametrize(("mass", "found"), [(2.0, True), (0.5, False)])
def test_a_drawing_that_no_material_is_light_enough_for_says_nothing(tmp_path: Path, mass: float, found: bool) -> None:
    solid = geometry([((0.4, 0.4, 0.5), (0.0, 0.0, 0.0))]).solid
    own = uniform(solid, mass)
    small = own.tensor * 0.004 * np.diag((1.0, 1.2, 1.3))
    numbers = replace(own, com=np.array((0.09, -0.06, 0.05)), tensor=small)
    assert bool(find(tmp_path, arm_on_base(format_inertial(numbers), visual(box("0.4 0.4 0.5"))), {"INR009"})) == found


@pytest.mark.parametrize(
    ("size", "severity"), [((0.22, 0.12, 0.034), Severity.INFO), ((0.23, 0.12, 0.034), Severity.WARNING)]
)
def test_the_box_around_the_main_shape_is_an_approximation(
    tmp_path: Path, size: tuple[float, ...], severity: Severity
) -> None:
    """A tray with two frames below it, whose inertial is that of the box around the tray."""
    tray = [((0.22, 0.12, 0.006), (0.0, 0.0, -0.014))]
    tray += [((0.004, 0.12, 0.028), (sign * 0.108, 0.0, 0.003)) for sign in (-1, 1)]
    write_stl(tmp_path / "tray.stl", tray)
    numbers = DeclaredInertial(5.5, np.zeros(3), compute_solid_inertia(make_box_solid(size), 5.5))
    frames = [visual(box("0.13 0.03 0.01"), xyz=f"0 {y} -0.035") for y in (0.033, 0.01)]
    text = arm_on_base(format_inertial(numbers), visual(mesh("tray.stl")), *frames)
    found = find(tmp_path, text, {"INR009"})
    assert [(finding.message_id, finding.severity) for finding in found] == [("com_missing", severity)]


@pytest.mark.parametrize(("mass", "found"), [(1e-9, False), (2e-3, True)])
def test_the_mass_of_a_part_without_material_shows_no_unit_of_the_tensor(
    tmp_path: Path, mass: float, found: bool
) -> None:
    """The tensor of a kilogram, as a CAD program writes it whose mass was left out."""
    true = compute_solid_inertia(make_box_solid((0.2, 0.15, 0.1)), 1.0)
    text = arm_on_base(format_inertial(DeclaredInertial(mass, np.zeros(3), true)), visual(box("0.2 0.15 0.1")))
    assert bool(find(tmp_path, text, {"INR005", "INR009"})) == found


@pytest.mark.parametrize(("mass", "base", "found"), [(1e-3, 2, False), (1e-3, 0.2, True), (3e-3, 5, True)])
def test_where_the_com_of_a_mark_is_makes_no_difference(tmp_path: Path, mass: float, base: float, found: bool) -> None:
    size = (0.06, 0.04, 0.02)
    numbers = DeclaredInertial(mass, np.zeros(3), compute_solid_inertia(make_box_solid(size), mass))
    drawn = visual(box("0.06 0.04 0.02"), xyz="0.05 0 0")
    text = arm_on_base(format_inertial(numbers), drawn, base=inertial(base, ixx=0.1, iyy=0.11, izz=0.12))
    assert [one.message_id for one in find(tmp_path, text, {"INR009"})] == ["com_missing"] * found


def test_a_hull_says_nothing_about_the_com(tmp_path: Path) -> None:
    drawn = geometry(CASTING)
    assert drawn.hull is not None
    write_stl(tmp_path / "part.stl", CASTING)
    hull = uniform(drawn.hull, 0.6)
    numbers = replace(hull, com=drawn.solid.com + np.array((0.0, 0.012, 0.0)))
    (finding,) = find(tmp_path, arm_on_base(format_inertial(numbers), visual(mesh("part.stl"))), {"INR009"})
    assert finding.cause is not None
    assert finding.cause.id == "convex_hull"
    assert "the COM is 12 mm off" in finding.message
    assert " 0 mm off" not in finding.message


def test_a_bar_that_moves_with_a_tip_is_refused_by_mujoco(tmp_path: Path) -> None:
    bar = inertial(0.03, ixx="1e-5", iyy="1e-5", izz="0")
    tip = link("tip", inertial(0.01, 1e-6)) + joint("tip_joint", "arm", "tip", xyz="0 0 0.1")
    (finding,) = find(tmp_path, arm_on_base(bar, more=tip), {"INR004"})
    assert (finding.message_id, finding.severity) == ("line_fixed", Severity.WARNING)
    assert finding.headline == "arm: zero moment of inertia; MuJoCo refuses it"
