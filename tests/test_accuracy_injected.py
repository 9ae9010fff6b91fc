"""Defects made in a robot are found and named, harmless edits change nothing (benchmarks/accuracy takes published robots)."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import arm_on_base, box, inertial, limit, visual
from cart import make_cart

sys.path.append(str(Path(__file__).parent.parent / "benchmarks" / "accuracy"))

from harmless import try_edits
from injected import KINDS, plan_tasks, run_injections
from injections import tensor_of
from real import inertial_slips, joint_slips
from real.changes import Part, ReadRobot, read_robot
from real.evidence import find_inertial_evidence, find_reversal_evidence, find_zero_evidence
from real.harmless_edits import EDITS
from real.injection import Case, inject
from real.kinds import Broken, Kind
from real.robots import RealRobot, check_robot
from real.tables import build_tables, describe_cases
from real.verdicts import find_new, judge, list_keys

from urdfcheck.core import Severity

pytestmark = [pytest.mark.slow, pytest.mark.long]

ACCURACY = Path(__file__).parent.parent / "benchmarks" / "accuracy"

# What shows in the numbers of one link with a mesh, and what is typed.
PLAIN = (
    "tensor_unit",
    "mass_unit",
    "moment_sign",
    "six_equal",
    "limits_swapped",
    "axis_zero",
    "child_typo",
    "mesh_typo",
)


@pytest.fixture(scope="module", name="robot")
def make_robot(tmp_path_factory: pytest.TempPathFactory) -> RealRobot:
    """The cart with limits and a mimic joint, its meshes in a folder."""
    folder = tmp_path_factory.mktemp("cart")
    (folder / "meshes").mkdir()
    root = make_cart(folder / "meshes")
    for mesh in root.iter("mesh"):
        mesh.set("filename", f"meshes/{mesh.get('filename')}")
    for name in ("left_shoulder", "right_shoulder"):
        joint = root.find(f"joint[@name='{name}']")
        assert joint is not None
        joint.remove(joint.find("limit") or joint[-1])
        joint.append(ET.fromstring(limit(-0.5, 1.5, 5, 2)))
    path = folder / "cart.urdf"
    path.write_text(ET.tostring(root, encoding="unicode"), encoding="utf-8")
    return RealRobot(name="cart", entry=path, package_roots=(folder,), links=9)


@pytest.fixture(scope="module", name="read")
def read_cart(robot: RealRobot) -> ReadRobot:
    read = read_robot(robot)
    assert read is not None
    return read


def find_kind(name: str) -> Kind:
    return next(kind for kind in KINDS if kind.name == name)


def find_part(read: ReadRobot, link: str) -> Part:
    return next(part for part in read.parts if part.link.name == link)


@pytest.fixture(scope="module", name="cases")
def inject_plain(robot: RealRobot) -> list[Case]:
    return inject(robot, [find_kind(name) for name in PLAIN], len(PLAIN), (1, 0))


def test_plain_defects_are_found_and_named(cases: list[Case]) -> None:
    assert {case.kind for case in cases} == set(PLAIN)
    with_meshes = [case for case in cases if case.has_meshes]
    assert not list(describe_cases(with_meshes))
    assert all(case.evidence and case.verdict.found for case in with_meshes)


def test_inertials_are_broken_without_meshes_too(cases: list[Case]) -> None:
    bare = {case.kind for case in cases if not case.has_meshes}
    assert bare == {kind.name for kind in map(find_kind, PLAIN) if kind.family in ("inertial", "joint")}
    impossible = [case for case in cases if "impossible" in case.evidence and not case.has_meshes]
    assert {case.kind for case in impossible} == {"moment_sign", "six_equal"}
    assert all(case.verdict.found for case in impossible)


def test_the_command_makes_the_same_defects_in_any_number_of_processes(robot: RealRobot, tmp_path: Path) -> None:
    entry = {"id": "cart", "entry": "cart/cart.urdf", "package_roots": ["cart"], "xacro_args": {}, "expands": True}
    shutil.copytree(robot.entry.parent, tmp_path / "cart")
    (tmp_path / "corpus.json").write_text(json.dumps([entry]), encoding="utf-8")
    words = [
        sys.executable,
        str(ACCURACY / "injected.py"),
        "--quick",
        "--kinds",
        "limits_swapped,tensor_unit",
        "--jobs",
    ]
    env = os.environ | {"URDFCHECK_CORPUS": str(tmp_path)}
    kinds = [index for index, kind in enumerate(KINDS) if kind.name.endswith(("limits_swapped", "tensor_unit"))]
    cases, _ = run_injections([robot], kinds, seed=1, count=150, jobs=1, limit=60.0)
    printed = subprocess.run(
        [*words, "2"], env=env, capture_output=True, text=True, check=True, encoding="utf-8"
    ).stdout
    assert {case.kind for case in cases} == {"limits_swapped", "tensor_unit", "all: tensor_unit"}
    assert read_rows(printed) == read_rows(build_tables(cases, KINDS))


def read_rows(text: str) -> list[str]:
    """The rows of tables."""
    return [line for line in text.splitlines() if line.startswith("|")]


def test_no_robot_is_begun_after_the_time_limit(robot: RealRobot) -> None:
    assert run_injections([robot], [0], seed=1, count=2, jobs=1, limit=-1.0) == ([], 0)


def test_kinds_are_spread_over_the_robots(robot: RealRobot) -> None:
    tasks = plan_tasks([robot] * 20, range(len(KINDS)), 1, 1000)
    assert len(tasks) == 20
    assert {len(kinds) for _, _, kinds, _ in tasks} == {len(KINDS)}
    assert len({kinds[0] for _, _, kinds, _ in tasks}) > 10


@pytest.mark.parametrize("kind", [k for k in KINDS if not k.habit], ids=lambda kind: kind.name)
def test_a_defect_changes_what_it_says(read: ReadRobot, kind: Kind) -> None:
    """Every kind can be made somewhere in the cart, but for those that need what it lacks; the rest of the text stays."""
    if kind.name in ("mimic_typo", "mimic_multiplier"):
        pytest.skip("the cart has no mimic joint")
    if kind.name in ("collision_shifted", "collision_size"):
        pytest.skip("the cart has no collision shapes")
    if kind.name == "joint_rpy_degrees":
        pytest.skip("the joints of the cart are not rotated")
    text = read.source.files[read.source.name].text
    made = []
    for part in read.parts:
        if kind.family == "inertial" and part.numbers is None:
            continue
        found = kind.make(part, np.random.default_rng(1))
        if found is not None:
            made.append(found.changes if isinstance(found, Broken) else found)
    assert made
    for changes in made:
        (changed,) = read.apply(changes).values()
        assert changed != text
        ET.fromstring(changed)
        kept = sum(change.span.end - change.span.start for change in changes)
        assert len(changed) - sum(len(change.text) for change in changes) == len(text) - kept


def test_units_are_what_their_names_say(read: ReadRobot) -> None:
    assert inertial_slips.TENSOR_UNITS["lb·in²"] == pytest.approx(3417.17, rel=1e-5)
    assert inertial_slips.MASS_UNITS["lb"] == pytest.approx(2.20462, rel=1e-5)
    part = find_part(read, "tool")
    assert part.numbers is not None
    made = inertial_slips.about_origin(part, np.random.default_rng(1))
    assert made is not None
    again = read_robot(read.robot, read.apply(made))
    assert again is not None
    new = find_part(again, "tool").numbers
    assert new is not None
    shift = tensor_of(new.six) - tensor_of(part.numbers.six)
    assert np.trace(shift) == pytest.approx(2 * part.numbers.mass * part.numbers.com @ part.numbers.com, rel=1e-6)


def test_a_right_repair_is_told_from_a_wrong_one(read: ReadRobot) -> None:
    kind, part = find_kind("products_sign"), find_part(read, "left_arm")
    made = kind.make(part, np.random.default_rng(1))
    assert isinstance(made, list)
    texts = read.apply(made)
    said = list_keys(check_robot(read.robot))
    new = find_new(said, check_robot(read.robot, texts))
    verdict = judge(kind, "", part.subjects, read, texts, new)
    assert (verdict.found, verdict.named, verdict.wrong, verdict.edit) == (True, True, False, "right")
    # The same findings about another mistake: the cause is a wrong one, the repair brings back what was there.
    other = judge(find_kind("com_moved"), "", part.subjects, read, texts, new)
    assert (other.named, other.wrong) == (False, True)
    elsewhere = judge(kind, "", {"link[tool]"}, read, texts, new)
    assert (elsewhere.found, elsewhere.other) == (False, True)


def test_nothing_is_new_in_a_sound_robot(read: ReadRobot) -> None:
    run = check_robot(read.robot)
    assert find_new(list_keys(run), run) == []


def test_what_shows_a_broken_joint_depends_on_others(read: ReadRobot) -> None:
    part = find_part(read, "left_arm")
    assert part.joint is not None
    shared = {"joint[right_shoulder]"}
    assert find_zero_evidence(part, "effort") == {"twin"}
    assert not find_zero_evidence(part, "effort", shared) & {"twin"}
    # The range is not symmetric: that of the other side contradicts a reversed axis.
    assert find_reversal_evidence(part) == {"twin"}
    assert not find_reversal_evidence(part, shared)


def test_evidence_is_what_the_file_shows(read: ReadRobot) -> None:
    part = find_part(read, "left_arm")
    assert part.numbers is not None

    def find(make: object, *, with_meshes: bool) -> set[str]:
        assert callable(make)
        changes = make(part, np.random.default_rng(4))
        again = read_robot(read.robot, read.apply(changes.changes if isinstance(changes, Broken) else changes))
        assert again is not None
        new = find_part(again, "left_arm").numbers
        assert new is not None
        return find_inertial_evidence(part, new, with_meshes=with_meshes)

    assert find(inertial_slips.moment_sign, with_meshes=False) >= {"impossible", "twin"}
    assert "mesh" in find(inertial_slips.tensor_power, with_meshes=True)
    assert "mesh" not in find(inertial_slips.tensor_power, with_meshes=False)
    assert find(inertial_slips.density_tenfold, with_meshes=False) == {"twin"}
    assert "reach" in find(inertial_slips.all_units, with_meshes=False)
    # The mirror image of a COM is at the same distance: only the mesh shows which it is.
    assert find(inertial_slips.com_mirrored, with_meshes=False) == set()


def test_what_the_same_text_changes_and_light_parts_show_nothing(read: ReadRobot) -> None:
    part = find_part(read, "left_arm")
    assert part.numbers is not None
    heavy = replace(part.numbers, mass=part.numbers.mass * 10)
    assert find_inertial_evidence(part, heavy, with_meshes=False) == {"twin"}
    assert find_inertial_evidence(part, heavy, with_meshes=False, shared={"link[right_arm]"}) == set()
    # Without meshes the frames of equal parts may be anywhere: the COM's distance is no evidence.
    moved = replace(part.numbers, com=part.numbers.com + 0.01)
    assert "twin" not in find_inertial_evidence(part, moved, with_meshes=False)
    assert "twin" in find_inertial_evidence(part, moved, with_meshes=True)


def test_a_cause_that_was_named_before_is_not_new(robot: RealRobot, read: ReadRobot) -> None:
    part = find_part(read, "left_arm")
    broken = find_kind("tensor_unit").make(part, np.random.default_rng(4))
    assert broken is not None
    changes = broken.changes if isinstance(broken, Broken) else broken
    run = check_robot(robot, read.apply(changes))
    keys = {key: severity for key, severity in list_keys(run).items() if key[2]}
    assert keys
    elsewhere = {(code, "another", cause, subject): severity for (code, _, cause, subject), severity in keys.items()}
    for before in (elsewhere, dict.fromkeys(elsewhere, Severity.INFO)):  # said less severely, it is no new cause either
        assert not [finding for finding, _ in find_new(before, run) if finding.cause is not None]
    assert [finding for finding, _ in find_new({}, run) if finding.cause is not None]


@pytest.mark.parametrize("com", ["0 0 0", "0.1 0 0"])
def test_a_com_that_was_zero_before_is_no_wrong_cause(tmp_path: Path, com: str) -> None:
    """A mass a thousand times too small makes the tensor exceed the part; with its mass only the COM is missing."""
    cause = "com_missing"
    shape = visual(box("0.2 0.1 0.06"), xyz="0.1 0 0")
    reads = {}
    for name, place in (("sound", com), ("broken", "0 0 0")):
        arm = inertial(1, ixx=1.133e-3, iyy=3.633e-3, izz=4.167e-3, com=place) + shape
        (tmp_path / f"{name}.urdf").write_text(arm_on_base(arm), encoding="utf-8")
        reads[name] = read_robot(RealRobot(name=name, entry=tmp_path / f"{name}.urdf", links=2))
    sound, broken = reads["sound"], reads["broken"]
    assert sound is not None
    assert broken is not None
    new = [one for one in find_new({}, check_robot(broken.robot)) if one[0].cause and one[0].cause.id == cause]
    assert new
    verdict = judge(find_kind("mass_unit"), "", {"link[arm]"}, sound, {}, new)
    assert verdict.wrong == (com != "0 0 0")


@pytest.mark.parametrize(("axis", "factors", "shows"), [
    ((1, 0, 0), (1.0, 1.0, 1.0), False),
    ((0, 0, 1), (1.0, 1.0, 1.0), True),
    ((1, 0, 0), (3.5, 3.5, 3.5), True),
])  # fmt: skip
def test_a_rod_that_swings_does_not_show_its_moment_about_its_length(
    tmp_path: Path, axis: tuple[int, ...], factors: tuple[float, ...], shows: bool
) -> None:
    """0.36 kg, 0.1 m by 10 mm: 3e-4, 3e-4 and 6e-6 kg m²; then three times 3e-4, and more."""
    arm = inertial(0.36, ixx=3.03e-4, iyy=3.03e-4, izz=6e-6) + visual(box("0.01 0.01 0.1"))
    text = arm_on_base(arm, axis=" ".join(map(str, axis)))
    (tmp_path / "r.urdf").write_text(text, encoding="utf-8")
    read = read_robot(RealRobot(name="r", entry=tmp_path / "r.urdf", package_roots=(tmp_path,), links=2))
    assert read is not None
    part = find_part(read, "arm")
    assert part.numbers is not None
    new = replace(part.numbers, six=3.03e-4 * np.array((factors[0], 0, 0, factors[1], 0, factors[2])))
    assert ("mesh" in find_inertial_evidence(part, new, with_meshes=True)) == shows


def test_tables_count_what_the_cases_say(cases: list[Case]) -> None:
    tables = build_tables(cases, KINDS)
    found = [case for case in cases if case.verdict.found]
    assert f"| named of found | 100.0 % of {len(found)} | >= 90 % |" in tables
    assert "| `tensor_unit` | 1 | 1 | 100 % (1) | 0 of 0 | 100 % (1) | 0 |" in tables


def test_harmless_edits_change_nothing(robot: RealRobot) -> None:
    trials = try_edits(robot, EDITS, (1, 0))
    assert [trial.edit for trial in trials] == list(EDITS)
    assert all(trial.is_made for trial in trials)
    assert [trial.new for trial in trials if trial.new] == []


def test_an_edit_that_breaks_the_robot_is_seen(robot: RealRobot, monkeypatch: pytest.MonkeyPatch) -> None:
    def swap(root: ET.Element, rng: np.random.Generator) -> ET.Element:
        inertia = root.find("link[@name='tool']/inertial/inertia")
        assert inertia is not None
        inertia.set("izz", "-1")
        return root

    monkeypatch.setitem(EDITS, "a sign", (swap, ()))  # type: ignore[arg-type]
    (trial,) = try_edits(robot, ["a sign"], (1, 0))
    assert any("INR004" in text for text in trial.new)


def test_kinds_have_names_of_their_own() -> None:
    names = [kind.name for kind in (*inertial_slips.KINDS, *joint_slips.KINDS)]
    assert len(names) == len(set(names))
    assert all(
        kind.is_nameless or kind.says or kind.codes or kind.name.endswith("unit") or "units" in kind.name
        for kind in KINDS
    )
