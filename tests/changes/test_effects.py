"""What follows from a planted change is reported with its size, and the way back the other way round."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest
import trimesh
from builders import box, cylinder, inertial, joint, link, robot, visual
from versions import ARM, compare, compare_texts

import urdfcheck
from urdfcheck.changes.gate import make_gate
from urdfcheck.core.model_diff import Diff, MechanismDiff, MechanismEffect, ModelDiff
from urdfcheck.export.mechanism_builder import build_mechanism
from urdfcheck.facts.comparison.home_pose import compute_home_pose
from urdfcheck.facts.comparison.joint_loads import compute_joint_inertias
from urdfcheck.facts.comparison.motion import compute_displacements
from urdfcheck.facts.motion.dynamics import build_configurations, compute_mass_matrices, locate_joint_coordinates
from urdfcheck.model import Model
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder


@dataclass(frozen=True, kw_only=True)
class Planted:
    """An edit, and the only effect of its kind that must be reported."""

    old: str
    new: str
    id: str
    back: str
    """The id of the effect of the edit back."""
    parts: tuple[str, str]
    numbers: Mapping[str, float]
    text: str
    arm: str = ARM
    count: int = -1
    """How often it is replaced; -1: everywhere."""
    configuration: Mapping[str, float] = field(default_factory=dict)


LEFT = '<origin xyz="0.06 0.04 0" rpy="0 0 0"/>'
FINGER = '<geometry><box size="0.04 0.01 0.02"/></geometry>'
# The left finger is 90 mm wide, and meets the other one where the hand is half closed.
WIDE = ARM.replace(FINGER, FINGER.replace("0.01", "0.09"), 2)

COLLISIONS: Mapping[str, Planted] = {
    "a wider range": Planted(
        old='lower="-0.03" upper="0.01"',
        new='lower="-0.036" upper="0.01"',
        id="pair-collides",
        back="pair-clears",
        parts=("link[left]", "link[right]"),
        numbers={"depth": 0.002, "at_rest": 0.0},
        text="link left and link right collide now (in ",
        configuration={"grip": -0.036, "grip_mirror": 0.036},
    ),
    "a wider shape": Planted(
        old=FINGER,
        new=FINGER.replace("0.01", "0.09"),
        count=2,
        id="pair-collides",
        back="pair-clears",
        parts=("link[left]", "link[right]"),
        numbers={"depth": 0.02, "gap": 0.01, "at_rest": 0.0},
        text=" configurations, by 20 mm at grip -0.03, grip_mirror 0.03, 10 mm apart before)",
        configuration={"grip": -0.03, "grip_mirror": 0.03},
    ),
    "a part moved at rest": Planted(
        arm=WIDE,
        old=LEFT,
        new=LEFT.replace("0.04", "0.005"),
        id="rest-collides",
        back="rest-clears",
        parts=("link[left]", "link[right]"),
        numbers={"depth": 0.005, "gap": 0.03, "at_rest": 1.0},
        text="link left and link right collide at rest now (by 5 mm, 30 mm apart before)",
    ),
}


def get_mechanism(found: ModelDiff) -> MechanismDiff:
    assert found.mechanism is not None
    return found.mechanism


def get_only(found: MechanismDiff, kind: str) -> MechanismEffect:
    (effect,) = [effect for effect in found.effects if effect.kind == kind]
    return effect


@pytest.mark.parametrize("planted", COLLISIONS.values(), ids=COLLISIONS)
def test_a_pair_that_collides_is_reported_alone(tmp_path: Path, planted: Planted) -> None:
    changed = planted.arm.replace(planted.old, planted.new, planted.count)
    found = compare_texts(tmp_path / "there", planted.arm, changed)
    back = compare_texts(tmp_path / "back", changed, planted.arm)
    effect, mirrored = get_only(get_mechanism(found), "collision"), get_only(get_mechanism(back), "collision")
    assert (effect.id, mirrored.id) == (planted.id, planted.back)
    assert (effect.subject, effect.other) == (mirrored.subject, mirrored.other) == planted.parts
    assert {name: effect.numbers.get(name) for name in planted.numbers} == pytest.approx(planted.numbers, abs=1e-6)
    assert effect.numbers == pytest.approx(mirrored.numbers)
    assert effect.configuration == pytest.approx(mirrored.configuration)
    assert effect.configuration == pytest.approx(planted.configuration)
    assert planted.text in found.effects[get_mechanism(found).effects.index(effect)]


def test_pairs_that_an_edit_cannot_bring_together_are_not_compared(tmp_path: Path) -> None:
    """The fingers move along with the hand; of the pairs with what the hand hangs on none collides."""
    changed = ARM.replace('<origin xyz="0.3 0 0" rpy="0 0 0"/>', '<origin xyz="0.301 0 0" rpy="0 0 0"/>')
    collisions = get_mechanism(compare_texts(tmp_path, ARM, changed)).collisions
    assert collisions is not None
    # Three parts behind the joint, four before it.
    assert (collisions.pairs, collisions.effects) == (12, ())


def test_links_that_collide_now_fail_a_run_that_asks_for_collisions(tmp_path: Path) -> None:
    planted = COLLISIONS["a wider range"]
    models = [ARM, ARM.replace(planted.old, planted.new)]
    gate = make_gate(["collision"], None, None)
    for before, after, reasons in ((*models, 1), (*reversed(models), 0)):
        diff = Diff(before="a", after="b", models=(compare_texts(tmp_path, before, after),))
        assert len(gate.list_reasons(diff)) == reasons


def test_a_mass_compares_no_collisions(tmp_path: Path) -> None:
    changed = ARM.replace('<mass value="0.6"/>', '<mass value="0.7"/>')
    assert get_mechanism(compare_texts(tmp_path, ARM, changed)).collisions is None


def test_a_new_part_collides_with_what_it_does_not_hang_on(tmp_path: Path) -> None:
    """It overlaps the hand, on which it hangs, and a finger."""
    lamp = (
        '<link name="lamp"><collision><geometry><sphere radius="0.03"/></geometry></collision></link>'
        '<joint name="lamp_turn" type="continuous"><parent link="hand"/><child link="lamp"/>'
        '<origin xyz="0.06 0.04 0"/><axis xyz="0 0 1"/></joint></robot>'
    )
    found = get_mechanism(compare_texts(tmp_path, ARM, ARM.replace("</robot>", lamp)))
    at_rest = [effect for effect in found.effects if effect.numbers["at_rest"]]
    assert [{effect.subject, effect.other} for effect in at_rest] == [{"link[left]", "link[lamp]"}]


# -- inertias ----------------------------------------------------------------------------------------------------------


def test_the_inertia_of_a_joint_is_reported_where_it_changes_most(tmp_path: Path) -> None:
    """A heavier hand changes what every joint that carries it accelerates, the wrist most of all, which carries little else."""
    old, new = 'ixx="0.0006"', 'ixx="0.0012"'
    there = compare_texts(tmp_path / "there", ARM, ARM.replace(old, new))
    back = compare_texts(tmp_path / "back", ARM.replace(old, new), ARM)
    wrist, *others = [effect for effect in get_mechanism(there).effects if effect.kind == "inertia"]
    assert wrist.subject == "joint[wrist]"
    assert wrist.numbers["after"] - wrist.numbers["before"] == pytest.approx(0.0006)
    assert {effect.subject for effect in others} <= {"joint[elbow]", "joint[pan]"}
    mirrored = get_mechanism(back).effects[0]
    assert (mirrored.numbers["before"], mirrored.numbers["after"]) == pytest.approx(
        (wrist.numbers["after"], wrist.numbers["before"])
    )
    assert mirrored.configuration == pytest.approx(wrist.configuration)
    assert there.effects[0].startswith("joint wrist accelerates ")


def test_inertias_are_those_of_pinocchio(tmp_path: Path) -> None:
    """The diagonal of the mass matrix of a chain, fixed links, a slide and a follower included."""
    pinocchio = pytest.importorskip("pinocchio")
    (tmp_path / "arm.urdf").write_text(ARM, encoding="utf-8")
    source = load_source(tmp_path / "arm.urdf", {}, PackageFinder(tmp_path))
    assert source.root is not None
    home = compute_home_pose(build_mechanism(Model(source=source, robot=source.root, tier="source"), "arm"))
    model = pinocchio.buildModelFromXML(ARM)
    rng = np.random.default_rng(5)
    values = {name: rng.uniform(-1.0, 1.0, 4) for name in ("pan", "elbow", "wrist", "grip", "grip_mirror")}
    found = compute_joint_inertias(home, compute_displacements(home, values, 4))
    coordinates = locate_joint_coordinates(model, list(values))
    q = build_configurations(coordinates, np.array(list(values.values())).T)
    matrices = compute_mass_matrices(model, model.createData(), q)
    for name, place in zip(values, coordinates.velocity, strict=True):
        assert found[name] == pytest.approx(matrices[:, place, place], rel=1e-9)


def test_a_friction_changes_no_inertia(tmp_path: Path) -> None:
    changed = ARM.replace('damping="0.5"', 'damping="0.8"')
    assert get_mechanism(compare_texts(tmp_path, ARM, changed)).effects == ()


# -- stability ---------------------------------------------------------------------------------------------------------


def make_cart(load: float, mass: float = 5.0) -> str:
    """Return a cart of 7 kg on four wheels at x = ±0.15 m, y = ±0.2 m, that carries ``mass`` (kg) at x = ``load``."""
    axle = '<origin rpy="1.5708 0 0"/>'
    wheel = f"<visual>{axle}<geometry>{cylinder(0.05, 0.02)}</geometry></visual>"
    wheels = [
        part
        for name, place in (("fl", "0.15 0.2"), ("fr", "0.15 -0.2"), ("rl", "-0.15 0.2"), ("rr", "-0.15 -0.2"))
        for part in (
            link(f"{name}_wheel", inertial(0.5, 0.001), wheel),
            joint(f"{name}_wheel_turn", "base", f"{name}_wheel", kind="continuous", xyz=f"{place} 0.05", axis="0 1 0"),
        )
    ]
    return robot(
        link("base", inertial(5, 0.1, com="0 0 0.1"), visual(box("0.3 0.3 0.04"), xyz="0 0 0.1")),
        *wheels,
        link("load", inertial(mass, 0.1)),
        joint("load_mount", "base", "load", kind="fixed", xyz=f"{load} 0 0.3"),
    )


def test_the_margin_of_a_robot_that_stands_is_compared(tmp_path: Path) -> None:
    there = compare_texts(tmp_path / "there", make_cart(0.0), make_cart(0.12))
    effect = get_only(get_mechanism(there), "stability")
    # 5 of 12 kg move by 0.12 m; the wheels touch 0.15 m ahead.
    assert (effect.id, effect.numbers["margin_before"]) == ("support-margin", pytest.approx(0.15, abs=1e-4))
    assert effect.numbers["margin_after"] == pytest.approx(0.10, abs=1e-4)
    assert "the COM is 150 mm within → 100 mm within the supports; the robot tips over at " in there.effects[-1]
    back = get_only(get_mechanism(compare_texts(tmp_path / "back", make_cart(0.12), make_cart(0.0))), "stability")
    assert (back.numbers["tip_before"], back.numbers["tip_after"]) == pytest.approx(
        (effect.numbers["tip_after"], effect.numbers["tip_before"])
    )


def test_a_robot_that_falls_over_now_is_reported_as_such(tmp_path: Path) -> None:
    there = compare_texts(tmp_path / "there", make_cart(0.0), make_cart(0.6))
    assert get_only(get_mechanism(there), "stability").id == "falls"
    assert "the robot falls over now: its COM is 100 mm outside its supports" in there.effects
    back = compare_texts(tmp_path / "back", make_cart(0.6), make_cart(0.0))
    assert get_only(get_mechanism(back), "stability").id == "stands"


def test_a_mass_that_moves_no_com_changes_no_margin(tmp_path: Path) -> None:
    there = get_mechanism(compare_texts(tmp_path / "there", make_cart(0.0), make_cart(0.0, mass=5.001)))
    assert [effect.kind for effect in there.effects] == []


# -- meshes ------------------------------------------------------------------------------------------------------------

MESHED = ARM.replace('<box size="0.06 0.1 0.04"/>', '<mesh filename="meshes/hand.stl"/>')


def write_versions(folder: Path, before: trimesh.Trimesh, after: trimesh.Trimesh) -> tuple[Path, Path]:
    """Write the arm twice, with a mesh for its hand."""
    paths = folder / "old" / "arm.urdf", folder / "new" / "arm.urdf"
    for path, mesh in zip(paths, (before, after), strict=True):
        (path.parent / "meshes").mkdir(parents=True)
        path.write_text(MESHED, encoding="utf-8")
        mesh.export(path.parent / "meshes" / "hand.stl")
    return paths


def make_hand(knob: float = 0.0) -> trimesh.Trimesh:
    """Return a box, with a knob of this length on its far side."""
    box = trimesh.creation.box((0.06, 0.1, 0.04))
    if not knob:
        return box
    middle = trimesh.transformations.translation_matrix((0.03 + knob / 2, 0.0, 0.0))
    return trimesh.util.concatenate([box, trimesh.creation.box((knob, 0.01, 0.01), transform=middle)])


def test_the_surface_of_a_replaced_mesh_is_measured_both_ways(tmp_path: Path) -> None:
    paths = write_versions(tmp_path, make_hand(), make_hand(0.05))
    (model,) = compare(*paths).models
    drawn, collides = get_mechanism(model).changes[-1], get_mechanism(model).changes[0]
    for change in (drawn, collides):
        assert (change.id, change.subject) == ("mesh-changed", "link[hand]")
        assert change.numbers["surface_come"] == pytest.approx(0.05, abs=1e-6)
        assert change.numbers["surface_gone"] == pytest.approx(0.0, abs=1e-6)
        assert 0.0 < change.numbers["surface_error"] < 0.005
    assert "the new surface up to 50 mm from the old one (± " in model.texts[0]
    (back,) = compare(*reversed(paths)).models
    assert get_mechanism(back).changes[0].numbers["surface_gone"] == pytest.approx(0.05, abs=1e-6)
    (quick,) = compare(*paths, tier="source").models
    assert get_mechanism(quick).changes == ()  # no mesh is read


def test_other_triangles_of_one_surface_are_recognised(tmp_path: Path) -> None:
    (model,) = compare(*write_versions(tmp_path, make_hand(), make_hand().subdivide())).models
    assert "the same surface (at points " in model.texts[0]


@pytest.mark.slow
def test_workers_read_the_meshes_that_they_compare(tmp_path: Path) -> None:
    """A knob of 100 mm meets the fingers' boxes, which begin 40 mm before the hand's face; workers may open nothing else."""
    paths = write_versions(tmp_path, make_hand(), make_hand(0.1))
    (model,) = urdfcheck.diff(*paths, select="INR003", cache=False).models
    found = get_mechanism(model)
    assert found.changes[0].numbers["surface_come"] == pytest.approx(0.1, abs=1e-6)
    assert found.collisions is not None
    assert found.collisions.unread == ()
    assert found.collisions.pairs > 0
