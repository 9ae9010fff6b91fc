"""Verdicts on inertials are kept between runs as long as nothing they depend on changes; edits say what their author would."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import find, joint, link, robot
from castings import (
    CASTING,
    MISTAKES,
    Block,
    DeclaredInertial,
    drawn_boxes,
    format_inertial,
    geometry,
    uniform,
    write_stl,
)

from urdfcheck.facts.inertials.diagnosis import diagnose_inertial
from urdfcheck.model import Model
from urdfcheck.model.inertials.diagnosis import link_diagnosis
from urdfcheck.model.inertials.inertia_diagnosis import inertial_diagnoses
from urdfcheck.model.inertials.proposals.drawn_inertials import propose_from_geometry
from urdfcheck.model.repairs.inertial_edits import build_inertial_repair
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder
from urdfcheck.system.array_cache import ArrayCache

DRAWN = geometry(CASTING)
TRUE = uniform(DRAWN.solid)
WRONG = {id: mistake(TRUE, DRAWN) for id, _, mistake in MISTAKES}
MESH = '<visual><geometry><mesh filename="part.stl"/></geometry></visual>'


def make_star(*links: str, fixed: str = "") -> str:
    """Return links that each hang on the base by a joint of their own."""
    names = [link.split('"')[1] for link in links]
    joints = (joint(f"to_{name}", "base", name, kind="continuous", xyz=f"0 {i} 0") for i, name in enumerate(names))
    return robot(link("base"), *links, *joints, fixed)


def make_link(name: str, numbers: DeclaredInertial | None, drawn: str = MESH) -> str:
    return link(name, "" if numbers is None else format_inertial(numbers), drawn)


def model(folder: Path, text: str, cache: ArrayCache | None = None, tier: str = "full") -> Model:
    folder.mkdir(exist_ok=True)
    if not (folder / "part.stl").exists():
        write_stl(folder / "part.stl", CASTING)
    path = folder / "robot.urdf"
    path.write_text(text)
    source = load_source(path, {}, PackageFinder(path))
    return Model(source=source, robot=source.root, cache=cache or ArrayCache(), tier=tier)


# -- what is judged again -----------------------------------------------------------------------------------------------


@pytest.fixture
def judged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., tuple[dict[str, str | None], int]]:
    """The cause found in each link of a robot, and how many times a diagnosis was made for it."""
    calls = 0

    def counted(*arguments: object, **options: object) -> object:
        nonlocal calls
        calls += 1
        return diagnose_inertial(*arguments, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(link_diagnosis, "diagnose_inertial", counted)

    def judge(text: str, tier: str = "full") -> tuple[dict[str, str | None], int]:
        nonlocal calls
        calls = 0
        found = inertial_diagnoses(model(tmp_path, text, ArrayCache(tmp_path / "cache"), tier))
        return {name: one.diagnosis.cause for name, one in found.items()}, calls

    return judge


Judge = Callable[..., tuple[dict[str, str | None], int]]
ARM, LEG = make_link("arm", WRONG["com_missing"]), make_link("leg", WRONG["about_origin"], drawn_boxes(CASTING))


def test_an_unchanged_robot_is_not_judged_again(judged: Judge) -> None:
    first, calls = judged(make_star(ARM, LEG))
    assert first == {"arm": "com_missing", "leg": "about_origin"}
    assert calls >= 2
    assert judged(make_star(ARM, LEG)) == (first, 0)


def test_a_check_without_meshes_keeps_its_own_verdicts(judged: Judge) -> None:
    first, _ = judged(make_star(ARM, LEG))
    without_meshes, calls = judged(make_star(ARM, LEG), tier="source")
    assert without_meshes == {"leg": "about_origin"}
    assert calls >= 1
    for tier, found in (("full", first), ("source", without_meshes)):
        assert judged(make_star(ARM, LEG), tier=tier) == (found, 0)


def test_a_verdict_that_was_kept_is_the_one_that_was_made(tmp_path: Path) -> None:
    cache = ArrayCache(tmp_path / "cache")
    found = [inertial_diagnoses(model(tmp_path, make_star(ARM, LEG), cache)) for _ in range(2)]
    for name, before in found[0].items():
        first, again = before.diagnosis, found[1][name].diagnosis
        assert again is not first
        assert first.mended is not None
        assert again.mended is not None
        assert again.mended.inertia.tolist() == first.mended.inertia.tolist()
        for part in ("cause", "detail", "tensor_mismatch", "margin", "unique", "ruled_out", "judged_by", "at_fault"):
            assert getattr(again, part) == getattr(first, part)


def test_a_changed_number_is_judged_and_the_other_link_is_not(judged: Judge) -> None:
    judged(make_star(ARM, LEG))
    causes, calls = judged(make_star(ARM, make_link("leg", WRONG["products_sign"], drawn_boxes(CASTING))))
    assert causes == {"arm": "com_missing", "leg": "products_sign"}
    alone = judged(make_star(make_link("leg", WRONG["steiner_twice"], drawn_boxes(CASTING))))[1]
    assert calls == alone


def test_another_content_of_the_mesh_is_judged(judged: Judge, tmp_path: Path) -> None:
    text = make_star(make_link("arm", TRUE))
    assert judged(text)[0] == {"arm": None}
    write_stl(tmp_path / "part.stl", [((a / 100, b / 100, c / 100), np.array(at) / 100) for (a, b, c), at in CASTING])
    assert judged(text)[0] == {"arm": "mesh_scale"}


def test_a_cover_that_moves_is_judged(judged: Judge) -> None:
    whole, hole = ((0.2, 0.1, 0.04), (0.0, 0.0, 0.0)), ((0.16, 0.06, 0.04), (0.0, 0.0, 0.0))
    frame = [((0.2, 0.02, 0.04), (0.0, y, 0.0)) for y in (-0.04, 0.04)]
    frame += [((0.02, 0.06, 0.04), (x, 0.0, 0.0)) for x in (-0.09, 0.09)]
    arm = make_link("arm", uniform(geometry([whole]).solid), drawn_boxes(frame))
    screws = (
        make_link("cover", None, drawn_boxes([hole]))
        + '<joint name="screws" type="fixed"><parent link="arm"/><child link="cover"/><origin xyz="{} 0 0"/></joint>'
    )
    assert judged(make_star(arm, fixed=screws.format(0))) == ({"arm": None}, 2)  # by itself, and with its cover
    assert judged(make_star(arm, fixed=screws.format(0)))[1] == 0
    # Either the frame alone or frame and cover are meant, and neither has these numbers: nothing is said.
    assert judged(make_star(arm, fixed=screws.format(0.5))) == ({}, 2)


@pytest.mark.parametrize("damage", [b"", b"not an archive", None], ids=["empty", "rubbish", "other content"])
def test_a_damaged_cache_is_harmless(judged: Judge, tmp_path: Path, damage: bytes | None) -> None:
    first, calls = judged(make_star(ARM))
    (entry,) = (tmp_path / "cache" / "diagnosis").rglob("*.npz")
    if damage is None:
        for content in (b"[]", b"{}", b'{"whole": 1}', b"\xff", b'{"whole": "", "links": 3, "verdicts": []}'):
            parts = ArrayCache(tmp_path / "cache").entry("diagnosis", "".join(entry.parent.parts[-2:]))
            parts["links"] = {"text": np.frombuffer(content, dtype=np.uint8)}
            assert judged(make_star(ARM)) == (first, calls)
    else:
        entry.write_bytes(damage)
        assert judged(make_star(ARM)) == (first, calls)


# -- what an edit says --------------------------------------------------------------------------------------------------

SIX = 'ixx="2" ixy="{}" ixz="0" iyy="2" iyz="0" izz="2"'


@pytest.mark.parametrize(
    ("typed", "wanted", "written"),
    [
        ("-0.00005200000", 0.000052, "0.00005200000"),
        ("-0.00005200000", -0.052, "-0.05200000"),
        ("5.20e-5", -5.2e-5, "-5.20e-5"),
        ("-6.3778E-05", 6.3778e-5, "6.3778E-05"),
        ("1.50E-05", 1.5e-4, "1.50E-04"),
        ("+1.50E+02", -1.5, "-1.50E+00"),
        ("1.5e1", -0.15, "-1.5e-1"),
        ("5.20e-15", -5.2e-15, "-5.20e-15"),
        ("+0.5", -0.05, "-0.05"),
        ("1500", 1.5, "1.500"),
        ("0.3", 0.30001, "0.30001"),
        ("0.3", 1.0 / 3.0, "0.333333"),
        ("0.7", 0.0, "0"),
        ("0", 0.25, "0.25"),
    ],
)
def test_digits_stay_where_only_the_sign_or_a_power_of_ten_changes(
    tmp_path: Path, typed: str, wanted: float, written: str
) -> None:
    text = f'<link name="a"><inertial><mass value="1"/><inertia {SIX.format(typed)}/></inertial></link>'
    given = model(tmp_path, make_star(text)).link_by_name["a"].inertial
    assert given is not None
    # The moments are larger, so that a body can have the tensor, but as small, or the change would be none.
    tensor = 10.0 * (abs(wanted) or 1.0) * np.eye(3)
    tensor[0, 1] = tensor[1, 0] = wanted
    edits = [
        edit
        for edit in build_inertial_repair(given, DeclaredInertial(1.0, np.zeros(3), tensor)).edits
        if edit.expected == typed
    ]
    assert [edit.replacement for edit in edits] == [written]


def test_nothing_is_written_where_nothing_changes(tmp_path: Path) -> None:
    given = model(tmp_path, make_star(make_link("arm", TRUE))).link_by_name["arm"].inertial
    assert given is not None
    assert build_inertial_repair(given, TRUE).text == ""
    assert build_inertial_repair(given, TRUE).edits == ()


@pytest.mark.parametrize("name", ["ixy", "izz"])
def test_a_missing_number_is_told_and_nothing_edited(tmp_path: Path, name: str) -> None:
    text = re.sub(f' {name}="[^"]*"', "", make_link("arm", TRUE))
    given = model(tmp_path, make_star(text)).link_by_name["arm"].inertial
    assert given is not None
    change = build_inertial_repair(given, TRUE)
    assert f'{name}="' in change.text
    assert change.edits == ()


def test_the_inertia_of_the_drawn_part_keeps_the_axes_of_the_inertial(tmp_path: Path) -> None:
    text = make_link("arm", WRONG["com_unit"]).replace('rpy="0 0 0"', 'rpy="0 0 1.5707963267948966"')
    one = model(tmp_path, make_star(text))
    change = propose_from_geometry(one, one.link_by_name["arm"])
    assert change is not None
    written = dict(re.findall(r'(\w+)="([^"]*)"', change.text))
    assert "rpy" not in written
    assert "mass" not in written
    assert float(written["ixx"]) == pytest.approx(TRUE.tensor[1, 1], rel=1e-5)
    assert float(written["ixz"]) == pytest.approx(TRUE.tensor[1, 2], rel=1e-4)


def test_noise_of_the_mesh_is_no_number_to_write(tmp_path: Path) -> None:
    box = [((0.3, 0.2, 0.1), (0.1, 1e-10, 0.0))]
    folder = tmp_path / "noise"
    folder.mkdir()
    write_stl(folder / "part.stl", box)
    odd = replace(uniform(geometry([((0.1, 0.1, 0.1), (0.0, 0.3, 0.0))]).solid), com=np.zeros(3))
    one = model(folder, make_star(make_link("arm", odd)))
    change = propose_from_geometry(one, one.link_by_name["arm"])
    assert change is not None
    assert 'xyz="0.1 0 0"' in change.text
    assert "e-" not in change.text


@pytest.mark.parametrize("inertial", ["", "<inertial/>", '<inertial><mass value="0"/></inertial>'])
def test_without_a_mass_the_drawn_part_has_no_inertia(tmp_path: Path, inertial: str) -> None:
    one = model(tmp_path, make_star(f'<link name="arm">{inertial}{MESH}</link>'))
    assert propose_from_geometry(one, one.link_by_name["arm"]) is None
    assert inertial_diagnoses(one) == {}


# -- a mistake of the whole file ----------------------------------------------------------------------------------------

# Five parts that differ, each with two fifths of its mass in a motor.
STRETCHED = ((1.0, 1.0), (1.3, 0.8), (0.7, 1.2), (1.1, 0.6), (0.9, 1.5))
PARTS = [[((a * f, b * g, c), (x * f, y * g, z)) for (a, b, c), (x, y, z) in CASTING] for f, g in STRETCHED]


def add_motor(blocks: Sequence[Block], place: Sequence[float]) -> DeclaredInertial:
    """The numbers of a part with two fifths of its mass in a point."""
    whole, at = uniform(geometry(blocks).solid), np.array(place)
    com = 0.6 * whole.com + 0.4 * at
    tensor = 0.6 * whole.tensor
    for share, offset in ((0.6, whole.com - com), (0.4, at - com)):
        tensor = tensor + share * whole.mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))
    return DeclaredInertial(whole.mass, com, tensor)


def make_arm(mistake: str, wrong: int) -> str:
    """A robot of five parts, of which the first ``wrong`` have a mistake."""
    undo = {id: make for id, _, make in MISTAKES}[mistake]
    numbers = [add_motor(blocks, blocks[i % 3][1]) for i, blocks in enumerate(PARTS)]
    given = [undo(one, geometry(PARTS[i])) if i < wrong else one for i, one in enumerate(numbers)]
    return make_star(*(make_link(f"part_{i}", given[i], drawn_boxes(PARTS[i])) for i in range(5)))


def test_what_no_link_shows_alone_is_named_where_all_links_have_it(judged: Judge, tmp_path: Path) -> None:
    alone = [judged(make_arm("about_origin", wrong=1))[0]["part_0"]]
    assert alone == [None]
    assert set(judged(make_arm("about_origin", wrong=5))[0].values()) == {"about_origin"}
    assert judged(make_arm("about_origin", wrong=5))[1] == 0
    found = find(tmp_path, make_arm("about_origin", wrong=5), "INR009")
    # Undone, the motors are still there: no link by itself proves its new numbers.
    assert [(f.message_id, len(f.subjects), len(f.fix.edits)) for f in found if f.fix] == [("habit", 5, 0)]


def test_a_sound_file_stays_sound_beside_one_wrong_link(judged: Judge) -> None:
    for mistake in ("about_origin", "products_sign", "inertia_unit"):
        causes = judged(make_arm(mistake, wrong=1))[0]
        assert {causes[f"part_{i}"] for i in range(1, 5)} == {None}
