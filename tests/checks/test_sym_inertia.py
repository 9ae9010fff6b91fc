"""SYM003: which link differs from its copies, in which numbers, and when nothing is said."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from builders import box, collision, find, inertial, joint, link, mesh, robot, visual

from urdfcheck.core import Finding, Severity
from urdfcheck.facts.motion.kinematics import matrix_to_rpy, rpy_to_matrix
from urdfcheck.model import Model
from urdfcheck.model.likeness.identical_parts import estimate_from_copies, part_copies
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.system.array_cache import ArrayCache

pytestmark = pytest.mark.slow

MASS = 0.4321
# A part without any symmetry: corners of a tetrahedron in m.
LUMP = [(0, 0, 0), (0.1, 0, 0), (0.01, 0.06, 0), (0.02, 0.01, 0.03)]
# Of the lump at uniform density.
COM = np.mean(LUMP, axis=0)
_CORNERS = np.array(LUMP) - COM
_SPREAD = MASS / 20.0 * _CORNERS.T @ _CORNERS
TENSOR = np.trace(_SPREAD) * np.eye(3) - _SPREAD
PLACES = {
    "fl": "0.2 0.1 0",
    "rl": "-0.2 0.1 0",
    "rr": "-0.2 -0.1 0",
    "fr": "0.2 -0.1 0",
    "mid": "0 0.3 0",
    "top": "0 0 0.3",
    "one": "0 0.1 0.02",
    "two": "0 -0.1 0",
}


def write_mesh(folder: Path, name: str = "lump.stl") -> None:
    faces = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
    lines = ["solid lump"]
    for face in faces:
        lines += [
            "facet normal 0 0 0",
            "outer loop",
            *("vertex {} {} {}".format(*LUMP[i]) for i in face),
            "endloop",
            "endfacet",
        ]
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text("\n".join([*lines, "endsolid lump"]), encoding="utf-8")


def make_lump_inertial(mass: float = MASS, com: object = COM, tensor: np.ndarray = TENSOR, rpy: str = "0 0 0") -> str:
    values = (f"{value:.9g}" for value in tensor[np.triu_indices(3)].tolist())
    terms = dict(zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), values, strict=True))
    place = " ".join(f"{v:.9g}" for v in com)  # type: ignore[attr-defined]
    return inertial(f"{mass:.9g}", com=place, rpy=rpy, **terms)


def drawn(xyz: str = "0 0 0", rpy: str = "0 0 0", scale: str = "1 1 1") -> str:
    return f'<visual><origin xyz="{xyz}" rpy="{rpy}"/><geometry><mesh filename="lump.stl" scale="{scale}"/></geometry></visual>'


def make_parts_on_base(*names: str, kind: str = "continuous", **links: str) -> str:
    """Return parts on a base; each one draws the lump and has its inertial, unless ``links`` has other text for it."""
    parts = [link("base")]
    for name in names:
        parts.append(link(f"{name}_part", links.get(name, drawn() + make_lump_inertial())))
        axis = "" if kind == "fixed" else "0 0 1"
        parts.append(joint(name, "base", f"{name}_part", kind=kind, xyz=PLACES[name], axis=axis))
    return robot(*parts)


FOUR = ("fl", "rl", "rr", "fr")
UNNAMED = ("rl", "mid", "top")


def find_odd_inertia(folder: Path, text: str, name: str = "robot.urdf") -> list[Finding]:
    write_mesh(folder)
    return find(folder, text, "SYM003", name=name)


@pytest.mark.parametrize(("place", "count"), [("0 0.02 0", 0), ("0 0 0", 1)])
def test_a_com_of_the_link_s_own_mesh_is_not_odd(tmp_path: Path, place: str, count: int) -> None:
    """Four links draw one file; the collision mesh of one is in another place, and its COM was computed there."""
    centre = np.mean(LUMP, axis=0)
    own = drawn() + collision(mesh("lump.stl"), xyz=place) + make_lump_inertial(com=centre + np.array((0, 0.02, 0)))
    links = {name: drawn() + make_lump_inertial(com=centre) for name in FOUR}
    assert len(find_odd_inertia(tmp_path, make_parts_on_base(*FOUR, **links | {"rr": own}))) == count


@pytest.mark.parametrize("height", [0.0005, 0.0015, 0.03])
def test_a_com_with_the_numbers_of_the_others_stays_where_the_drawing_is_apart(tmp_path: Path, height: float) -> None:
    """The mass is another one; its author saw the mesh, and typed the tensor and the COM of the others."""
    odd = drawn(f"0 0 {height}") + make_lump_inertial(0.8 * MASS)
    (finding,) = find_odd_inertia(tmp_path, make_parts_on_base(*FOUR, rr=odd))
    assert "mass" in finding.message
    assert "COM" not in finding.message
    assert finding.fix is not None
    assert len(finding.fix.edits) == 1


@pytest.mark.parametrize(
    ("com", "place", "rpy"), [((0, 0, 0), "0.004 0.002 0", "0.1 0 0"), (COM, "0.004 0.002 0", "0 0 0")]
)
def test_only_the_mass_is_odd_where_all_have_one_com(tmp_path: Path, com: object, place: str, rpy: str) -> None:
    write_mesh(tmp_path)
    links = {name: drawn() + make_lump_inertial(com=com) for name in FOUR}
    links["fr"] = drawn(place, rpy) + make_lump_inertial(0.8 * MASS, com=com, tensor=0.8 * TENSOR)
    (finding,) = find_odd_inertia(tmp_path, make_parts_on_base(*FOUR, **links))
    assert "mass" in finding.message
    assert "COM" not in finding.message


def test_inertials_that_agree_are_not_told_apart_by_a_drawing(tmp_path: Path) -> None:
    """A COM of 0 0 0, and a tensor that no turn changes, say nothing about where the mesh is, or how it is turned."""
    typed = make_lump_inertial(com=(0.0, 0.0, 0.0), tensor=np.eye(3) * 5e-5)
    odd = drawn("0 0 0.01", "0 0 1.57") + typed
    text = make_parts_on_base(*FOUR, **dict.fromkeys(FOUR, drawn() + typed) | {"rr": odd})
    assert not find_odd_inertia(tmp_path, text)
    assert "twin" not in [finding.message_id for finding in find(tmp_path, text, "INR009")]


def repaired(folder: Path, text: str) -> list[Finding]:
    """What is left when the only finding's edits are applied."""
    (finding,) = find_odd_inertia(folder, text)
    assert finding.fix is not None
    assert finding.fix.edits
    for edit in sorted(finding.fix.edits, key=lambda e: -e.span.start):
        text = text[: edit.span.start] + edit.replacement + text[edit.span.end :]
    return find_odd_inertia(folder, text)


def turned(rpy: tuple[float, float, float], move: tuple[float, float, float], mass: float = MASS) -> str:
    """The same part with its link's frame elsewhere."""
    turn = rpy_to_matrix(rpy)
    angles = " ".join(f"{a:.12g}" for a in matrix_to_rpy(turn))
    shape = drawn(" ".join(map(str, move)), angles)
    return shape + make_lump_inertial(mass, turn @ COM + move, turn @ TENSOR @ turn.T)


@pytest.mark.parametrize(
    ("collides", "shift", "kinds"), [("0 0 0", 1e-4, []), ("-25 0 0", 1e-4, ["inertial"]), ("-25 0 0", 1e-12, [])]
)
def test_a_com_of_the_collision_mesh_is_right_where_the_visual_one_is_out_of_place(
    tmp_path: Path, collides: str, shift: float, kinds: list[str]
) -> None:
    """A side whose mesh is drawn 25 m away has no COM there."""
    parts = [link("base")]
    for side, y, place in (("left", 0.1, "-25 0 0"), ("right", -0.1, "0 0 0")):
        meshes = drawn(place) + collision(mesh("lump.stl"), xyz=collides if side == "left" else "0 0 0")
        com = COM + np.array((0.0 if side == "left" else shift, 0.0, 0.0))
        parts += [link(f"{side}_part", meshes + make_lump_inertial(com=[float(f"{v:.15g}") for v in com]))]
        parts.append(joint(side, "base", f"{side}_part", kind="continuous", xyz=f"0 {y} 0", axis="0 0 1"))
    write_mesh(tmp_path)
    assert [finding.message_id for finding in find(tmp_path, robot(*parts), "SYM004")] == kinds


def test_copies_that_agree_are_fine(tmp_path: Path) -> None:
    assert not find_odd_inertia(tmp_path, make_parts_on_base(*FOUR))


@pytest.mark.parametrize("names", [FOUR, UNNAMED])
@pytest.mark.parametrize(
    ("wrong", "told", "place"),
    [
        (make_lump_inertial(mass=1.1 * MASS), "mass 0.4753 kg instead of 0.4321 kg (× 1.1)", "inertial/mass@value"),
        (
            make_lump_inertial(com=COM * (1, -1, 1)),
            "(32.5, -17.5, 7.5) mm instead of (32.5, 17.5, 7.5) mm, 35 mm off",
            "inertial/origin@xyz",
        ),
        (
            make_lump_inertial(tensor=TENSOR * (2 * np.eye(3) - 1)),
            "ixy -3.187e-05 instead of 3.187e-05, ixz -8.102e-06",
            "inertial/inertia",
        ),
        (make_lump_inertial(tensor=TENSOR[[1, 0, 2]][:, [1, 0, 2]]), "other principal axes", "inertial/inertia"),
        (make_lump_inertial(tensor=TENSOR * 1.5), "principal moments", "inertial/inertia"),
    ],
)
def test_the_odd_one_is_named_with_what_differs_and_repaired(
    tmp_path: Path, names: tuple[str, ...], wrong: str, told: str, place: str
) -> None:
    text = make_parts_on_base(*names, rl=drawn() + wrong)
    (finding,) = find_odd_inertia(tmp_path, text)
    assert (finding.message_id, finding.severity) == ("odd", Severity.WARNING)
    assert finding.location.subject == f"link[rl_part]/{place}"
    assert told in finding.message
    assert not repaired(tmp_path, text)


@pytest.mark.parametrize("names", [FOUR, UNNAMED])
@pytest.mark.parametrize("mass", [1.1 * MASS, MASS])
def test_the_drawing_tells_that_the_others_are_wrong(tmp_path: Path, names: tuple[str, ...], mass: float) -> None:
    """The others have the numbers of a larger part."""
    larger = make_lump_inertial(mass, com=1.2 * COM, tensor=1.6 * TENSOR)
    links = {name: drawn() + larger for name in names if name != "rl"}
    (finding,) = find_odd_inertia(tmp_path, make_parts_on_base(*names, **links))
    assert (finding.message_id, finding.severity) == ("others", Severity.WARNING)
    assert not finding.location.subject.startswith("link[rl_part]")
    assert "only rl_part has its COM and tensor" in finding.message
    assert finding.fix is not None
    assert not finding.fix.edits


def test_nothing_is_edited_where_no_inertial_is_that_of_the_drawn_part(tmp_path: Path) -> None:
    tensor = np.diag((2e-4, 3e-4, 4e-4))
    links = {name: drawn() + make_lump_inertial(tensor=tensor) for name in FOUR}
    links["rl"] = drawn() + make_lump_inertial(1.1 * MASS, tensor=tensor)
    (finding,) = find_odd_inertia(tmp_path, make_parts_on_base(*FOUR, **links))
    assert finding.message_id == "unknown"
    assert finding.location.subject.startswith("link[rl_part]")
    assert finding.fix is not None
    assert not finding.fix.edits


def test_numbers_that_are_far_from_the_drawn_part_are_not_copied(tmp_path: Path) -> None:
    links = {name: drawn() + make_lump_inertial(tensor=300.0 * TENSOR) for name in FOUR}
    links["rl"] = drawn() + make_lump_inertial(tensor=np.diag((0.8, 0.9, 1.1)) * 300.0 * TENSOR.max())
    (finding,) = find_odd_inertia(tmp_path, make_parts_on_base(*FOUR, **links))
    assert finding.message_id == "unknown"
    assert finding.fix is not None
    assert not finding.fix.edits
    assert finding.fix.title.startswith("compute the inertials of all from the part: those of ")


def test_mirrored_inertials_of_one_drawing_may_both_be_right(tmp_path: Path) -> None:
    """The frames are at other heights, so that the links are no pair of SYM004."""
    mirror = np.diag((1, -1, 1))
    image = make_lump_inertial(com=COM * (1, -1, 1) + (0, 0, 0.02), tensor=mirror @ TENSOR @ mirror)
    text = make_parts_on_base("one", "two", two=drawn() + image)
    (finding,) = find_odd_inertia(tmp_path / "a", text)
    assert (finding.message_id, finding.severity) == ("mirrored", Severity.INFO)
    assert finding.location.subject == "link[one_part]/visual"
    assert finding.fix is not None
    assert not finding.fix.edits
    (finding,) = find_odd_inertia(tmp_path / "b", text.replace("0 0.1 0.02", "0 0.1 0.03"))
    assert finding.message_id != "mirrored"


def test_frames_and_names_do_not_matter(tmp_path: Path) -> None:
    elsewhere = {"fl": turned((0.3, -1.0, 2.0), (0.01, 0.02, 0.03)), "fr": turned((0, 1.5708, 0), (0, 0, 0.1))}
    assert not find_odd_inertia(tmp_path / "a", make_parts_on_base(*FOUR, **elsewhere))
    elsewhere["rr"] = turned((3.0, 0.2, -0.4), (-0.1, 0, 0), mass=0.5)
    text = make_parts_on_base(*FOUR, **elsewhere)
    (finding,) = find_odd_inertia(tmp_path / "b", text)
    assert "mass 0.5 kg instead of 0.4321 kg" in finding.message
    assert not repaired(tmp_path / "b", text)


def test_the_tensor_stays_in_the_axes_that_its_author_chose(tmp_path: Path) -> None:
    turn = rpy_to_matrix((0.5, 0, 0))
    own = make_lump_inertial(tensor=turn.T @ TENSOR @ turn, rpy="0.5 0 0")
    assert not find_odd_inertia(tmp_path / "a", make_parts_on_base(*FOUR, rr=drawn() + own))
    wrong = drawn() + make_lump_inertial(tensor=2 * turn.T @ TENSOR @ turn, rpy="0.5 0 0")
    (finding,) = find_odd_inertia(tmp_path / "b", make_parts_on_base(*FOUR, rr=wrong))
    assert finding.fix is not None
    assert "rpy" not in finding.fix.title
    assert not repaired(tmp_path / "b", make_parts_on_base(*FOUR, rr=wrong))


def test_a_part_that_a_negative_scale_mirrors_has_a_mirrored_inertial(tmp_path: Path) -> None:
    flip = np.diag((1.0, -1.0, 1.0))
    right = drawn(scale="1 -1 1") + make_lump_inertial(com=flip @ COM, tensor=flip @ TENSOR @ flip)
    copied = drawn(scale="1 -1 1") + make_lump_inertial()
    assert not find_odd_inertia(tmp_path / "a", make_parts_on_base(*UNNAMED, mid=right))
    (finding,) = find_odd_inertia(tmp_path / "b", make_parts_on_base(*UNNAMED, mid=copied))
    assert finding.location.subject == "link[mid_part]/inertial"
    assert not repaired(tmp_path / "b", make_parts_on_base(*UNNAMED, mid=copied))


def test_small_differences_are_an_info_and_typed_digits_none(tmp_path: Path) -> None:
    (finding,) = find_odd_inertia(
        tmp_path / "a", make_parts_on_base(*FOUR, rr=drawn() + make_lump_inertial(mass=1.03 * MASS))
    )
    assert finding.severity is Severity.INFO
    assert not find_odd_inertia(
        tmp_path / "b", make_parts_on_base(*FOUR, rr=drawn() + make_lump_inertial(mass=1.007 * MASS))
    )
    coarse = {name: drawn() + make_lump_inertial().replace('mass value="0.4321"', 'mass value="0.43"') for name in FOUR}
    coarse["rr"] = coarse["rr"].replace('mass value="0.43"', 'mass value="0.4256"')
    assert not find_odd_inertia(tmp_path / "c", make_parts_on_base(*FOUR, **coarse))


def test_two_kinds_of_parts_have_no_odd_one(tmp_path: Path) -> None:
    heavy = drawn() + make_lump_inertial(mass=0.6)
    assert not find_odd_inertia(tmp_path / "a", make_parts_on_base(*FOUR, fl=heavy, fr=heavy))
    assert not find_odd_inertia(
        tmp_path / "b", make_parts_on_base(*UNNAMED, mid=heavy, top=drawn() + make_lump_inertial(mass=0.8))
    )


@pytest.mark.parametrize(
    ("kind", "height", "message"),
    [
        ("fixed", "0", "drawing"),
        ("fixed", "0.02", "drawing"),
        ("fixed", "0.04", "pair"),  # beside each other
        ("continuous", "0", "drawing"),
        ("continuous", "0.02", "pair"),  # they may move apart
    ],
)
def test_two_drawings_of_one_part_that_overlap_may_be_the_mistake(
    tmp_path: Path, kind: str, height: str, message: str
) -> None:
    """The lump is 30 mm high."""
    text = make_parts_on_base("mid", "top", kind=kind, top=drawn() + make_lump_inertial(mass=1.5 * MASS))
    (finding,) = find_odd_inertia(tmp_path, text.replace(PLACES["top"], f"0 0.3 {height}"))
    assert (finding.message_id, finding.location.subject.endswith("/visual")) == (message, message == "drawing")
    assert finding.fix is None or ("write" in finding.fix.title) == (message == "pair")


def test_a_pair_is_named_as_a_pair(tmp_path: Path) -> None:
    (finding,) = find_odd_inertia(
        tmp_path, make_parts_on_base("mid", "top", mid=drawn() + make_lump_inertial(mass=0.5))
    )
    assert (finding.message_id, finding.severity) == ("pair", Severity.INFO)
    assert finding.fix is not None
    assert not finding.fix.edits
    assert 'if mid_part is right, write mass value="0.5" in top_part' in finding.fix.title


@pytest.mark.parametrize(
    ("factor", "severity"), [(0.11, Severity.INFO), (0.1, Severity.WARNING), (10, Severity.WARNING)]
)
def test_of_a_pair_one_ten_times_as_heavy_is_a_slip(tmp_path: Path, factor: float, severity: Severity) -> None:
    text = make_parts_on_base("fl", "rl", fl=drawn() + make_lump_inertial(mass=factor * MASS, tensor=factor * TENSOR))
    (finding,) = find_odd_inertia(tmp_path, text)
    assert (finding.message_id, finding.severity) == ("pair", severity)


@pytest.mark.parametrize(
    ("factor", "mass", "severity"),
    [(10, MASS, Severity.WARNING), (8, MASS, Severity.INFO), (10, 1.5 * MASS, Severity.INFO)],
)
def test_of_a_pair_one_with_ten_times_the_moments_is_a_slip_if_it_is_as_heavy(
    tmp_path: Path, factor: float, mass: float, severity: Severity
) -> None:
    tensor = np.diag((2e-4, 3e-4, 4e-4))  # of another shape: the drawing does not show which of the two is wrong
    one, other = make_lump_inertial(tensor=tensor), make_lump_inertial(mass, tensor=factor * tensor)
    text = make_parts_on_base("rl", "mid", rl=drawn() + one, mid=drawn() + other)
    (finding,) = find_odd_inertia(tmp_path, text)
    assert finding.severity == severity


def test_of_a_pair_the_one_that_does_not_fit_the_drawn_part_is_wrong(tmp_path: Path) -> None:
    corners = np.array(LUMP)
    com = corners.mean(axis=0)
    centred = corners - com
    covariance = centred.T @ centred / 20  # of a uniform tetrahedron
    fitting = 0.4 * (np.trace(covariance) * np.eye(3) - covariance)
    right, wrong = make_lump_inertial(0.4, com, fitting), make_lump_inertial(0.4, com * (1, -1, 1), fitting)
    (finding,) = find_odd_inertia(tmp_path, make_parts_on_base("mid", "top", mid=drawn() + wrong, top=drawn() + right))
    assert (finding.message_id, finding.location.subject) == ("odd", "link[mid_part]/inertial/origin@xyz")
    assert "top_part has the inertial of the part that both draw" in finding.message


def test_points_and_impossible_bodies_are_not_compared(tmp_path: Path) -> None:
    for i, tensor in enumerate((0 * TENSOR, -TENSOR)):
        odd = drawn() + make_lump_inertial(0.9, COM, tensor)
        assert not find_odd_inertia(tmp_path / f"{i}a", make_parts_on_base("mid", "top", mid=odd))
        assert not find_odd_inertia(tmp_path / f"{i}b", make_parts_on_base(*UNNAMED, **dict.fromkeys(UNNAMED, odd)))


def test_left_and_right_are_another_rules_matter(tmp_path: Path) -> None:
    text = (
        make_parts_on_base("fl", "fr", fr=drawn() + make_lump_inertial(mass=0.5))
        .replace("fl_part", "left_part")
        .replace("fr_part", "right_part")
    )
    assert not find_odd_inertia(tmp_path, text)


def test_joints_of_another_type_and_casters_are_no_copies(tmp_path: Path) -> None:
    heavy = drawn() + make_lump_inertial(mass=0.6)
    text = make_parts_on_base(*UNNAMED, mid=heavy)
    assert find_odd_inertia(tmp_path / "a", text)
    assert not find_odd_inertia(tmp_path / "b", text.replace('"mid" type="continuous"', '"mid" type="fixed"'))
    assert not find_odd_inertia(tmp_path / "c", text.replace("mid_part", "caster_part"))


CYLINDER = '<visual><geometry><cylinder radius="0.05" length="0.02"/></geometry></visual>'
ROUND = np.diag((2.0e-4, 2.0e-4, 3.0e-4))


def wheels(kind: str = "continuous", names: tuple[str, ...] = FOUR, **links: str) -> str:
    usual = {name: CYLINDER + make_lump_inertial(MASS, (0, 0, 0.002), ROUND) for name in names}
    return make_parts_on_base(*names, kind=kind, **(usual | links))


def test_primitives_are_copies_where_four_hang_on_moving_joints(tmp_path: Path) -> None:
    heavy = CYLINDER + make_lump_inertial(1.25 * MASS, (0, 0, 0.002), ROUND * 1.25)
    assert not find_odd_inertia(tmp_path / "a", wheels())
    (finding,) = find_odd_inertia(tmp_path / "b", wheels(rr=heavy))
    assert finding.location.subject == "link[rr_part]/inertial/mass@value"
    assert not find_odd_inertia(tmp_path / "c", wheels("fixed", rr=heavy))
    assert not find_odd_inertia(tmp_path / "d", wheels(names=UNNAMED, mid=heavy))


def test_what_a_symmetry_of_the_part_explains_is_no_difference(tmp_path: Path) -> None:
    flipped = CYLINDER + make_lump_inertial(MASS, (0, 0, -0.002), ROUND)
    assert not find_odd_inertia(tmp_path / "a", wheels(rr=flipped))
    spoke = np.array([(2.0e-4, 1e-5, 0), (1e-5, 2.1e-4, 0), (0, 0, 3.0e-4)])
    turn = rpy_to_matrix((0, 0, 1.234))
    like = {name: CYLINDER + make_lump_inertial(MASS, (0.003, 0.001, 0.002), spoke) for name in FOUR}
    like["rr"] = CYLINDER + make_lump_inertial(0.4, turn @ (0.003, 0.001, 0.002), turn @ spoke @ turn.T)
    assert not find_odd_inertia(tmp_path / "b", wheels(**like))
    like["rr"] = CYLINDER + make_lump_inertial(MASS, (0.009, 0.003, 0.002), spoke)
    assert find_odd_inertia(tmp_path / "c", wheels(**like))


def test_the_numbers_that_are_written_are_those_of_a_copy(tmp_path: Path) -> None:
    """The odd one is the mirror image of the others but for its COM: what symmetry makes of their numbers is in no link."""
    tensor = np.array([(3.61234e-4, 0, 0), (0, 4.95678e-4, 1.23456e-5), (0, 1.23456e-5, 5.84567e-4)])
    flipped = np.array([(3.61234e-4, 0, 0), (0, 4.95678e-4, -1.23456e-5), (0, -1.23456e-5, 5.84567e-4)])
    box = '<visual><origin xyz="0 0.0003 0"/><geometry><box size="0.1 0.08 0.06"/></geometry></visual>'
    like = {name: box + make_lump_inertial(MASS, (0.00112, 0.00053, 0.00217), tensor) for name in FOUR}
    like["rr"] = box + make_lump_inertial(MASS, (0.00112, -0.00931, 0.00217), flipped)
    (finding,) = find_odd_inertia(tmp_path, make_parts_on_base(*FOUR, **like))
    assert finding.fix is not None
    new = " ".join(edit.replacement for edit in finding.fix.edits).split()
    assert [float(number) for number in new] == [0.00112, 0.00053, 0.00217, 1.23456e-05]
    # Drawn elsewhere, no link has the numbers that it should have.
    moved = like["rr"].replace('<origin xyz="0 0.0003 0"/>', '<origin xyz="0 0.0013 0"/>')
    (finding,) = find_odd_inertia(tmp_path / "b", make_parts_on_base(*FOUR, **(like | {"rr": moved})))
    assert not (finding.fix and finding.fix.edits)


@pytest.mark.parametrize("typed", ["${m}", "${1.0*m}"])
def test_a_line_that_a_macro_shares_is_not_edited(tmp_path: Path, typed: str) -> None:
    """A number that its calls hand on is: each has its own."""
    body = drawn() + make_lump_inertial().replace('mass value="0.4321"', f'mass value="{typed}"')
    macro = re.sub(
        r'<link name="(\w+)_part">.*?</link>', r'<xacro:part name="\1" m="0.4321"/>', make_parts_on_base(*FOUR)
    )
    head = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:macro name="part" params="name m">'
    text = macro.replace('<robot name="r">', f'{head}<link name="${{name}}_part">{body}</link></xacro:macro>')
    (finding,) = find_odd_inertia(
        tmp_path, text.replace('name="rr" m="0.4321"', 'name="rr" m="0.5"'), "robot.urdf.xacro"
    )
    assert finding.fix is not None
    if typed == "${m}":
        assert [(edit.expected, edit.replacement) for edit in finding.fix.edits] == [("0.5", "0.4321")]
        return
    assert finding.message_id == "computed"
    assert not finding.fix.edits
    assert finding.fix.title.startswith('give rr_part mass value="0.4321"')


def test_a_twin_is_what_the_copies_agree_on_in_the_links_own_frame(tmp_path: Path) -> None:
    write_mesh(tmp_path)
    path = tmp_path / "robot.urdf"
    odd = turned((0.3, -1.0, 2.0), (0.01, 0.02, 0.03), mass=0.5)
    path.write_text(make_parts_on_base(*FOUR, rr=odd), encoding="utf-8")
    source = load_source(path, {}, PackageFinder(tmp_path))
    assert source.root is not None
    model = Model(source=source, robot=source.root, tier="full", cache=ArrayCache())
    ((group),) = part_copies(model)
    assert [copy.link.name for copy in group] == ["fl_part", "rl_part", "rr_part", "fr_part"]
    wanted = estimate_from_copies(model)["rr_part"].expected
    turn = rpy_to_matrix((0.3, -1.0, 2.0))
    assert wanted.mass == pytest.approx(MASS)
    assert wanted.com == pytest.approx(turn @ COM + (0.01, 0.02, 0.03))
    assert wanted.inertia == pytest.approx(turn @ TENSOR @ turn.T)
    assert [link.name for link in estimate_from_copies(model)["fl_part"].by] == ["rl_part", "fr_part"]
    assert "base" not in estimate_from_copies(model)


def test_no_copy_is_blamed_that_has_the_numbers_of_another(tmp_path: Path) -> None:
    """The collision shapes, which stand for an open mesh, are symmetric in some of the links only."""
    write_mesh(tmp_path)
    path = tmp_path / "lump.stl"
    path.write_text(path.read_text().rpartition("facet normal")[0] + "endsolid lump")
    body = inertial(0.4321, com="0 0 0.01", ixx=3e-5, ixy=0, ixz=1e-5, iyy=7e-5, iyz=0, izz=8e-5)
    block, beside = collision(box("0.1 0.1 0.1")), collision(box("0.03 0.02 0.04"), xyz="0.05 0.03 0.04")
    parts = [link("base")]
    for name, rpy, extra in (
        ("fl", "0 0 0", ""),
        ("rl", "0 0 0", ""),
        ("fr", f"0 0 {np.pi}", ""),
        ("rr", f"0 0 {np.pi}", beside),
    ):
        parts.append(link(f"{name}_part", body, visual(mesh("lump.stl"), rpy=rpy), block, extra))
        parts.append(joint(f"{name}_joint", "base", f"{name}_part", kind="continuous", xyz=PLACES[name], axis="0 1 0"))
    assert [f.message_id for f in find(tmp_path, robot(*parts), "SYM003")] == []


def make_hidden_arm(side: str, com: str, *, length: float = 0.2, numbers: tuple[float, float] = (1.5, 0.006)) -> str:
    """A link whose visual mesh cannot be read, and that collides as a cylinder."""
    mass, moment = numbers
    shapes = visual(mesh("missing.stl")) + collision(
        f'<cylinder radius="0.03" length="{length}"/>', xyz=f"0 0 {-length / 2}"
    )
    left = 1 if side == "left" else -1
    return link(f"{side}_arm", inertial(mass, moment, com=com, izz=moment / 2), shapes) + joint(
        f"{side}_joint", "base", f"{side}_arm", kind="revolute", xyz=f"0 {0.1 * left} 0.3", axis="0 1 0"
    )


@pytest.mark.parametrize(
    ("com", "length", "found"),
    [
        ("0.01 -0.002 -0.08", 0.2, False),
        ("0.01 0.002 -0.08", 0.2, False),  # mirrored or not: no drawing says
        ("0.01 -0.002 -0.03", 0.2, True),
        ("0.01 -0.002 -0.03", 0.25, False),  # another part
    ],
)
def test_coms_of_one_part_that_only_collides_are_as_far_from_both_frames(
    tmp_path: Path, com: str, length: float, found: bool
) -> None:
    text = robot(
        link("base"), make_hidden_arm("left", "0.01 0.002 -0.08"), make_hidden_arm("right", com, length=length)
    )
    findings = [finding for finding in find(tmp_path, text, "SYM004") if finding.message_id == "moments"]
    assert bool(findings) == found
    assert all("COMs" in finding.message for finding in findings)


@pytest.mark.parametrize(("pairs", "severity"), [(5, Severity.WARNING), (2, Severity.INFO)])
def test_sides_that_are_alike_but_for_one_pair_are_made_of_one_part_each(
    tmp_path: Path, pairs: int, severity: Severity
) -> None:
    parts = [link("base")]
    for number in range(pairs):
        for left in (1, -1):
            side = "left" if left > 0 else "right"
            is_odd = number == 0 and left < 0
            mass, moment = (0.2, 0.0004) if is_odd else (1.5 + number, 0.006)
            parts += [
                link(f"{side}_part_{number}", inertial(mass, moment, izz=moment / 2)),
                joint(
                    f"{side}_{number}",
                    "base",
                    f"{side}_part_{number}",
                    kind="continuous",
                    xyz=f"{number} {0.1 * left} 0",
                ),
            ]
    findings = [f for f in find(tmp_path, robot(*parts), "SYM004") if f.message_id == "moments"]
    assert [finding.severity for finding in findings] == [severity]


def test_links_with_the_numbers_of_their_own_collision_shapes_are_right(tmp_path: Path) -> None:
    """All draw one part, and one of them collides with another."""
    links = {}
    for name in FOUR:
        size, com = (0.12, 0.08, 0.05) if name != "rl" else (0.1, 0.07, 0.04), (0.03, 0.02, 0.01)
        moments = [MASS / 12 * (sum(s * s for s in size) - s * s) for s in size]
        own = make_lump_inertial(com=list(com), tensor=np.diag(moments))
        collides = collision(box(" ".join(map(str, size))), xyz=" ".join(map(str, com)))
        links[name] = drawn() + collides + own
    assert not [f for f in find_odd_inertia(tmp_path, make_parts_on_base(*FOUR, **links)) if f.message_id == "others"]


@pytest.mark.parametrize(
    ("iyy", "severity"), [("0.0010", Severity.INFO), ("0.0011", Severity.WARNING), ("0.00105", Severity.WARNING)]
)
def test_a_unit_of_the_last_decimal_is_no_difference_of_two_parts(tmp_path: Path, iyy: str, severity: Severity) -> None:
    parts = [link("base", inertial(), visual(box("0.4 0.2 0.1")))]
    for side, y, moment in (("left", 0.2, "0.0009"), ("right", -0.2, iyy)):
        for limb, x in (("arm", 0.1), ("leg", -0.1)):
            numbers = inertial(0.5, ixx=0.0005, iyy=moment if limb == "arm" else "0.0009", izz=0.0010)
            parts.append(link(f"{side}_{limb}", numbers, visual(box("0.1 0.04 0.02"))))
            parts.append(joint(f"{side}_{limb}_joint", "base", f"{side}_{limb}", kind="continuous", xyz=f"{x} {y} 0"))
    (finding,) = find(tmp_path, robot(*parts), "SYM004")
    assert finding.severity is severity


@pytest.mark.parametrize(("size", "count"), [("0.02 0.02 0.26", 0), ("0.04 0.04 0.26", 1)])
def test_a_com_in_the_box_with_which_a_link_collides_is_right_where_the_same_box_is_drawn_elsewhere(
    tmp_path: Path, size: str, count: int
) -> None:
    """GEO005 reports the box that is drawn in another place; one of another size may be around more than the part."""
    parts = [link("base", inertial(), visual(box("0.4 0.2 0.1")))]
    for side, y, com, place in (("left", 0.2, 0.02, 0.001), ("right", -0.2, -0.02, -0.02)):
        for limb, x in (("arm", 0.1), ("leg", -0.1)):
            at = f"0 {com} 0.1"
            drawn = visual(box("0.02 0.02 0.26"), xyz=f"0 {place if limb == 'arm' else com} 0.1")
            own = inertial(0.15, 8e-4, com=at, izz=1e-5)
            parts.append(link(f"{side}_{limb}", own, drawn, collision(box(size), xyz=at)))
            parts.append(joint(f"{side}_{limb}_joint", "base", f"{side}_{limb}", kind="continuous", xyz=f"{x} {y} 0"))
    assert len(find(tmp_path, robot(*parts), "SYM004")) == count
