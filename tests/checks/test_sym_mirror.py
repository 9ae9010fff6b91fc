"""SYM004, the mirror mismatch: a small humanoid without any symmetry but that of left and right, one defect at a time."""

from __future__ import annotations

import copy
import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from builders import find, joint
from conftest import check_text
from transforms import Robot, Transformation, each_link, moved_link, rerooted, rotated_inertial, rotated_link, scaled

from urdfcheck.core import Finding, Severity
from urdfcheck.facts.inertials.declared_and_drawn import DeclaredInertial
from urdfcheck.facts.inertials.inertia_tensor import (
    combine_solids,
    compute_solid_inertia,
    make_box_solid,
    transform_solid,
)
from urdfcheck.facts.likeness.mirror import measure_deviation
from urdfcheck.facts.motion.kinematics import build_origin_transform, rpy_to_matrix
from urdfcheck.model import Model
from urdfcheck.model.inertials.inertial_differences import describe_differences
from urdfcheck.model.inertials.mirrored_inertials import compare_sides, find_cause, find_side_slip
from urdfcheck.model.likeness.declared_inertials import estimate_from_twin, read_declared_inertial
from urdfcheck.model.likeness.mirror_pairs import MirrorPair, mirror_pairs
from urdfcheck.model.likeness.side_names import pair_by_name
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder

pytestmark = pytest.mark.slow

SIX = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
DENSITY = 900.0
ASKEW = rpy_to_matrix((0.4, -0.7, 1.1))
Pieces = Sequence[tuple[tuple[float, float, float], tuple[float, float, float]]]

# The left side: boxes (size, centre), the joint's origin, its axis and limits, from the torso outwards.
PARTS: dict[str, tuple[Pieces, tuple[float, float, float], tuple[int, int, int], tuple[float, float]]] = {
    "shoulder": (
        (((0.08, 0.06, 0.08), (0.01, 0.03, 0.0)), ((0.04, 0.05, 0.03), (0.05, 0.05, 0.03))),
        (0.0, 0.2, 0.3),
        (1, 0, 0),
        (-0.3, 1.8),
    ),
    "arm": (
        (((0.05, 0.05, 0.3), (0.0, 0.0, -0.15)), ((0.06, 0.08, 0.06), (0.03, 0.06, -0.05))),
        (0.02, 0.07, 0.0),
        (0, 1, 0),
        (-1.0, 2.0),
    ),
    "hand": (
        (((0.03, 0.08, 0.1), (0.0, 0.0, -0.05)), ((0.02, 0.03, 0.06), (0.02, -0.05, -0.04))),
        (0.0, 0.01, -0.32),
        (0, 0, 1),
        (-0.5, 1.2),
    ),
}


def make_box_link(name: str, pieces: Pieces) -> ET.Element:
    """A link of boxes with the inertial that they have."""
    solid = combine_solids([transform_solid(make_box_solid(size), np.eye(3), centre) for size, centre in pieces])
    mass = DENSITY * solid.volume
    element = ET.Element("link", name=name)
    inertial = ET.SubElement(element, "inertial")
    ET.SubElement(inertial, "origin", xyz=" ".join(map(str, solid.com.tolist())), rpy="0 0 0")
    ET.SubElement(inertial, "mass", value=repr(mass))
    six = compute_solid_inertia(solid, mass)[np.triu_indices(3)].tolist()
    ET.SubElement(inertial, "inertia", dict(zip(SIX, map(repr, six), strict=True)))
    for size, centre in pieces:
        visual = ET.SubElement(element, "visual")
        ET.SubElement(visual, "origin", xyz=" ".join(map(str, centre)), rpy="0 0 0")
        ET.SubElement(ET.SubElement(visual, "geometry"), "box", size=" ".join(map(str, size)))
    return element


def make_motor_joint(
    name: str, parent: str, child: str, xyz: Sequence[float], axis: Sequence[int], limits: Sequence[float]
) -> ET.Element:
    element = ET.Element("joint", name=name, type="revolute")
    ET.SubElement(element, "parent", link=parent)
    ET.SubElement(element, "child", link=child)
    ET.SubElement(element, "origin", xyz=" ".join(map(str, xyz)), rpy="0 0 0")
    ET.SubElement(element, "axis", xyz=" ".join(map(str, axis)))
    ET.SubElement(element, "limit", lower=str(limits[0]), upper=str(limits[1]), effort="40", velocity="2")
    ET.SubElement(element, "dynamics", damping="0.1", friction="0.02")
    return element


def flipped(place: Sequence[float]) -> tuple[float, float, float]:
    return place[0], -place[1], place[2]


def humanoid(left: str = "left_{}", right: str = "right_{}") -> Robot:
    """A torso that turns on a pelvis, with two arms of three joints each."""
    robot = ET.Element("robot", name="humanoid")
    robot.append(make_box_link("pelvis", [((0.2, 0.3, 0.1), (0.0, 0.0, 0.0))]))
    robot.append(make_box_link("torso", [((0.2, 0.3, 0.4), (0.01, 0.0, 0.2))]))
    robot.append(make_motor_joint("waist", "pelvis", "torso", (0, 0, 0.1), (0, 0, 1), (-1, 1)))
    for side, mirrored in ((left, False), (right, True)):
        parent = "torso"
        for part, (pieces, xyz, axis, (lower, upper)) in PARTS.items():
            name = side.format(part)
            if mirrored:
                pieces, xyz = [(size, flipped(centre)) for size, centre in pieces], flipped(xyz)
                lower, upper = (lower, upper) if axis == (0, 1, 0) else (-upper, -lower)
            robot.append(make_box_link(name, pieces))
            robot.append(make_motor_joint(f"{name}_joint", parent, name, xyz, axis, (lower, upper)))
            parent = name
    return robot


def with_(robot: Robot, path: str, **attributes: str) -> Robot:
    """The robot with other attributes of one element."""
    changed = copy.deepcopy(robot)
    element = changed.find(path)
    assert element is not None, path
    element.attrib.update(attributes)
    return changed


def without(robot: Robot, path: str, tag: str) -> Robot:
    """The robot without some children of one element."""
    changed = copy.deepcopy(robot)
    element = changed.find(path)
    assert element is not None
    for child in element.findall(tag):
        element.remove(child)
    return changed


def numbers(robot: Robot, path: str, *names: str) -> dict[str, str]:
    """The attributes of an element, with the other sign where they are named."""
    element = robot.find(path)
    assert element is not None
    return {name: repr(-float(value)) if name in names else value for name, value in element.attrib.items()}


def find_mirror_defects(folder: Path, robot: Robot) -> list[Finding]:
    """Return what this rule finds, and the one that knows the mistakes of one link: one of them reports a defect."""
    return find(folder, ET.tostring(robot, encoding="unicode"), {"SYM004", "INR009"})


def one(folder: Path, robot: Robot) -> Finding:
    (finding,) = find_mirror_defects(folder, robot)
    return finding


def pairs_of(folder: Path, robot: Robot) -> dict[str, MirrorPair]:
    """The pairs by their first link."""
    return {pair.one: pair for pair in mirror_pairs(model_of(folder, robot))}


def model_of(folder: Path, robot: Robot) -> Model:
    folder.mkdir(exist_ok=True)
    path = folder / "robot.urdf"
    path.write_text(ET.tostring(robot, encoding="unicode"), encoding="utf-8")
    source = load_source(path, {}, PackageFinder(folder, {}, []))
    assert source.root is not None
    return Model(source=source, robot=source.root)


@pytest.mark.parametrize("kind", ["revolute", "fixed"])
@pytest.mark.parametrize(("x", "found"), [(-0.767, False), (-0.757, True)])
def test_origins_that_are_mirrored_to_the_digit_are_in_place(tmp_path: Path, x: float, found: bool, kind: str) -> None:
    """The chassis is rotated by 1.57, and its long body tilts the plane of the root by a millimetre."""
    robot = ET.Element("robot", name="car")
    robot.append(make_box_link("base", [((0.1, 0.1, 0.1), (0, 0, 0))]))
    robot.append(make_box_link("chassis", [((1.5, 4.0, 0.5), (0, 0, 0.5))]))
    robot.append(make_motor_joint("base_chassis", "base", "chassis", (1.45, 0, 0), (0, 0, 1), (-1, 1)))
    robot[-1].set("type", kind)
    mount = robot[-1].find("origin")
    assert mount is not None
    mount.set("rpy", "0 0 1.57")
    places = {"front_left": (0.767, -1.41), "front_right": (x, -1.41), "rear_left": (0.793, 1.45)}
    places |= {"rear_right": (-0.793, 1.45), "lamp_left": (0.6, -1.9), "lamp_right": (-0.6, -1.9)}
    for name, (across, along) in places.items():
        robot.append(make_box_link(name, [((0.2, 0.6, 0.6), (0, 0, 0))]))
        robot.append(make_motor_joint(f"{name}_joint", "chassis", name, (across, along, 0.3), (1, 0, 0), (-1, 1)))
    findings = [f for f in find_mirror_defects(tmp_path, robot) if f.message_id in {"origin", "slip"}]
    assert bool(findings) is found
    assert all("front_right" in f.message for f in findings)
    if not found:
        normal = pairs_of(tmp_path, robot)["front_left"].plane.normal
        assert abs(float(normal[1])) == pytest.approx(np.sin(1.57), abs=1e-9)


# -- one defect at a time ----------------------------------------------------------------------------------------------

ROBOT = humanoid()
RIGHT = "link[@name='right_arm']/inertial"
LEFT = "link[@name='left_arm']/inertial"


def heavier(robot: Robot, link_name: str, factor: float) -> Robot:
    """The robot with a link of the same shape and another density."""
    path = f"link[@name='{link_name}']/inertial"
    six = {name: repr(factor * float(value)) for name, value in numbers(robot, f"{path}/inertia").items()}
    mass = float(numbers(robot, f"{path}/mass")["value"])
    return with_(with_(robot, f"{path}/mass", value=repr(factor * mass)), f"{path}/inertia", **six)


def com_copied(robot: Robot) -> Robot:
    return with_(robot, f"{RIGHT}/origin", xyz=numbers(robot, f"{LEFT}/origin")["xyz"])


def inertia_copied(robot: Robot) -> Robot:
    return with_(robot, f"{RIGHT}/inertia", **numbers(robot, f"{LEFT}/inertia"))


DEFECTS: dict[str, Callable[[Robot], Robot]] = {
    "mass": lambda r: heavier(r, "right_arm", 1.06),
    "centre of mass copied": com_copied,
    "inertia copied": inertia_copied,
    "inertial copied": lambda r: com_copied(inertia_copied(r)),
    "limits copied": lambda r: with_(r, "joint[@name='right_hand_joint']/limit", lower="-0.5", upper="1.2"),
    "limit": lambda r: with_(r, "joint[@name='right_arm_joint']/limit", lower="-0.5"),
    "axis turned over": lambda r: with_(r, "joint[@name='right_arm_joint']/axis", xyz="0 -1 0"),
    "axis and another end": lambda r: with_(
        with_(r, "joint[@name='right_arm_joint']/axis", xyz="0 -1 0"),
        "joint[@name='right_arm_joint']/limit",
        upper="1.95",
    ),
    "effort": lambda r: with_(r, "joint[@name='right_arm_joint']/limit", effort="4"),
    "damping": lambda r: with_(r, "joint[@name='right_arm_joint']/dynamics", damping="0.2"),
    "origin": lambda r: with_(r, "joint[@name='right_hand_joint']/origin", xyz="0.005 -0.01 -0.32"),
    "axis": lambda r: with_(r, "joint[@name='right_hand_joint']/axis", xyz="0.02 0 1"),
    "frame": lambda r: with_(r, "joint[@name='right_hand_joint']/origin", rpy="0.02 0 0"),
}
# What is told of each: message, cause and subject.
TOLD = {
    "mass": ("pair", None, "link[right_arm]/inertial/mass@value"),
    "centre of mass copied": ("inertial", "copied", "link[right_arm]/inertial/origin@xyz"),
    "inertia copied": ("inertial", "copied", "link[right_arm]/inertial/inertia"),
    "inertial copied": ("inertial", "copied", "link[right_arm]/inertial"),
    "limits copied": ("limits_pair", "limits_copied", "joint[right_hand_joint]/limit"),
    "limit": ("limits_pair", None, "joint[right_arm_joint]/limit"),
    "axis turned over": ("limits_pair", "axis_negated", "joint[right_arm_joint]/limit"),
    "axis and another end": ("limits_pair", "axis_negated", "joint[right_arm_joint]/limit"),
    "effort": ("limits_pair", None, "joint[right_arm_joint]/limit"),
    "damping": ("dynamics", None, "joint[right_arm_joint]/dynamics"),
    "origin": ("origin", None, "joint[right_hand_joint]/origin@xyz"),
    "axis": ("axis", None, "joint[right_hand_joint]/axis@xyz"),
    "frame": ("turned", None, "joint[right_hand_joint]/origin@rpy"),
}


def told(finding: Finding) -> tuple[str, str | None, str]:
    return finding.message_id, finding.cause and finding.cause.id, finding.location.subject


@pytest.mark.parametrize(
    ("away", "severity"),
    [
        ((0.003, 0, 0), Severity.WARNING),
        ((0.0018, 0, 0), Severity.INFO),  # the hands are 0.5 m apart
        ((0.003, 0.002, 0), Severity.INFO),
        ((0.006, 0.004, 0), Severity.WARNING),
    ],
)
def test_a_place_that_is_a_little_off_in_two_coordinates_is_of_another_export(
    tmp_path: Path, away: tuple[float, float, float], severity: Severity
) -> None:
    xyz = " ".join(f"{a + b:g}" for a, b in zip((0, -0.01, -0.32), away, strict=True))
    finding = one(tmp_path, with_(copy.deepcopy(ROBOT), "joint[@name='right_hand_joint']/origin", xyz=xyz))
    assert (finding.message_id, finding.severity) == ("origin", severity)


@pytest.mark.parametrize(
    ("ranges", "severity"),
    [
        (("0 0", "0 0"), Severity.INFO),
        (("-0.001 0.001", "-0.001 0.001"), Severity.INFO),
        (("-1 1", "-1 1"), Severity.WARNING),
    ],
)
def test_the_axes_of_joints_without_room_are_a_note(
    tmp_path: Path, ranges: tuple[str, str], severity: Severity
) -> None:
    robot = with_(copy.deepcopy(ROBOT), "joint[@name='right_hand_joint']/axis", xyz="0.02 0 1")
    for side, span in zip(("left", "right"), ranges, strict=True):
        lower, upper = span.split()
        robot = with_(robot, f"joint[@name='{side}_hand_joint']/limit", lower=lower, upper=upper)
    finding = one(tmp_path, robot)
    assert (finding.message_id, finding.severity) == ("axis", severity)
    assert ("no room" in finding.consequences["pinocchio"]) == (severity is Severity.INFO)


@pytest.mark.parametrize(
    ("span", "targets", "severity", "effect"),
    [
        ("0", (), Severity.INFO, "ignores equal limits: the joints turn about these axes"),
        ("0", ("mujoco",), Severity.WARNING, "ignores equal limits: the joints turn about these axes"),
        ("0.001", ("mujoco",), Severity.INFO, "loads it: the limits leave the joints no room"),
        (None, (), Severity.WARNING, None),
    ],
    ids=["equal", "equal in MuJoCo", "close", "left out"],
)
def test_joints_turn_where_a_program_ignores_their_limits(
    tmp_path: Path, span: str | None, targets: tuple[str, ...], severity: Severity, effect: str | None
) -> None:
    robot = with_(copy.deepcopy(ROBOT), "joint[@name='right_hand_joint']/axis", xyz="0.02 0 1")
    for limit in (robot.find(f"joint[@name='{side}_hand_joint']/limit") for side in ("left", "right")):
        assert limit is not None
        for name, value in (("lower", f"-{span}"), ("upper", span)):
            if span is None or value is None:
                limit.attrib.pop(name)
            else:
                limit.set(name, value)
    (finding,) = find(tmp_path, ET.tostring(robot, encoding="unicode"), "SYM004", targets=targets)
    assert (finding.message_id, finding.severity) == ("axis", severity)
    assert finding.consequences.get("mujoco") == effect


@pytest.mark.parametrize(("span", "severity"), [(0, Severity.INFO), (1, Severity.WARNING)])
def test_the_effort_of_joints_without_room_is_a_note(tmp_path: Path, span: float, severity: Severity) -> None:
    robot = with_(copy.deepcopy(ROBOT), "joint[@name='right_hand_joint']/limit", effort="4")
    for side in ("left", "right"):
        robot = with_(robot, f"joint[@name='{side}_hand_joint']/limit", lower=str(-span), upper=str(span))
    finding = one(tmp_path, robot)
    assert (finding.message_id, finding.severity) == ("limits_pair", severity)


@pytest.mark.parametrize(
    ("velocities", "severity"),
    [(("1000", "100"), Severity.INFO), (("17453", "3"), Severity.INFO), (("10", "1"), Severity.WARNING)],
)
def test_velocities_that_no_joint_reaches_are_placeholders(
    tmp_path: Path, velocities: tuple[str, str], severity: Severity
) -> None:
    unlike = ROBOT
    for side, velocity in zip(("left", "right"), velocities, strict=True):
        unlike = with_(unlike, f"joint[@name='{side}_arm_joint']/limit", velocity=velocity)
    finding = one(tmp_path, unlike)
    assert (finding.message_id, finding.severity) == ("limits_pair", severity)


def test_a_mirrored_robot_is_fine(tmp_path: Path) -> None:
    assert not find_mirror_defects(tmp_path, ROBOT)


@pytest.mark.parametrize("defect", DEFECTS)
def test_each_defect_is_found_where_it_is(tmp_path: Path, defect: str) -> None:
    finding = one(tmp_path, DEFECTS[defect](ROBOT))
    assert told(finding) == TOLD[defect]
    assert finding.code == "SYM004"
    assert finding.severity == Severity.WARNING


def test_the_drawing_shows_which_com_was_copied_where_masses_differ_too(tmp_path: Path) -> None:
    """Nothing shows which mass is right: neither is written, and no numbers are offered for the side whose COM is right."""
    mass = float(numbers(ROBOT, f"{RIGHT}/mass")["value"])
    finding = one(tmp_path, with_(com_copied(inertia_copied(ROBOT)), f"{RIGHT}/mass", value=repr(1.05 * mass)))
    assert told(finding) == ("inertial", "copied", "link[right_arm]/inertial")
    assert finding.fix is not None
    assert finding.fix.edits
    assert "in right_arm" in finding.fix.title
    assert "left_arm" not in finding.fix.title
    assert "mass" not in finding.fix.title


@pytest.mark.parametrize("name", ["ixy", "ixx"])
def test_a_mistake_that_one_link_explains_is_told_once(tmp_path: Path, name: str) -> None:
    """The sign of a product, a lost decimal point: which rule tells depends on what else it could be."""
    wrong = {**numbers(ROBOT, f"{RIGHT}/inertia", "ixy", "ixz", "iyz")}
    if name == "ixx":
        wrong = {key: repr(1e-3 * float(value)) for key, value in numbers(ROBOT, f"{RIGHT}/inertia").items()}
    assert one(tmp_path, with_(ROBOT, f"{RIGHT}/inertia", **wrong)).location.subject.startswith("link[right_arm]")


@pytest.mark.parametrize(("factor", "severity"), [(1.04, Severity.INFO), (1.06, Severity.WARNING)])
def test_small_differences_are_worth_knowing(tmp_path: Path, factor: float, severity: Severity) -> None:
    assert one(tmp_path, heavier(ROBOT, "right_arm", factor)).severity == severity


def test_the_last_digits_are_not_told(tmp_path: Path) -> None:
    assert not find_mirror_defects(tmp_path, heavier(ROBOT, "right_arm", 1.009))


TRANSFORMATIONS: dict[str, Transformation] = {
    "frame of one arm turned": lambda robot: rotated_link(robot, "left_arm", ASKEW),
    "frames of all links turned": each_link(rotated_link, ASKEW),
    "inertial frames turned": each_link(rotated_inertial, ASKEW),
    "hung up at the torso": lambda robot: rerooted(robot, "torso"),
    "larger": lambda robot: scaled(robot, 2.0, 8.0),
}


@pytest.mark.parametrize("change", TRANSFORMATIONS)
def test_a_mirrored_robot_is_fine_in_other_frames(tmp_path: Path, change: str) -> None:
    assert not find_mirror_defects(tmp_path, TRANSFORMATIONS[change](ROBOT))


@pytest.mark.parametrize("defect", ["mass", "inertial copied", "limits copied", "limit", "origin"])
@pytest.mark.parametrize("change", TRANSFORMATIONS)
def test_a_defect_is_one_in_other_frames(tmp_path: Path, change: str, defect: str) -> None:
    """Whether numbers were copied is a question of the text: a frame that is turned alone may hide it."""
    _, cause, subject = told(one(tmp_path, TRANSFORMATIONS[change](DEFECTS[defect](ROBOT))))
    _, expected_cause, expected_subject = TOLD[defect]
    assert subject.split("/")[0] == expected_subject.split("/")[0]
    assert cause == expected_cause or change == "frame of one arm turned"


def test_the_robot_in_a_mirror_has_the_same_defects(tmp_path: Path) -> None:
    mirrored = humanoid("right_{}", "left_{}")
    assert not find_mirror_defects(tmp_path / "fine", mirrored)
    assert told(one(tmp_path, com_copied(mirrored))) == TOLD["centre of mass copied"]


# -- pairs -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ("left_{}", "right_{}"),
        ("{}_l", "{}_r"),
        ("L{}", "R{}"),
        ("{}Left", "{}Right"),
        ("FL_{}", "FR_{}"),
        ("{}_RL", "{}_RR"),
        ("lf.{}", "rf.{}"),
        ("l{}_link", "r{}_link"),
        ("leftmost{}", "rightmost{}"),
        ("l_{}_l", "r_{}_r"),
    ],
)
def test_sides_are_told_by_name(tmp_path: Path, left: str, right: str) -> None:
    found_pairs = pairs_of(tmp_path, humanoid(left, right))
    assert {p.one: p.other for p in found_pairs.values()} == {left.format(p): right.format(p) for p in PARTS}
    assert all(p.is_named and p.drawn_as == "mirrored" for p in found_pairs.values())


def test_where_names_say_nothing_places_and_drawings_do(tmp_path: Path) -> None:
    robot = humanoid("{}_1", "{}_2")
    found_pairs = pairs_of(tmp_path, robot)
    assert {p.one: p.other for p in found_pairs.values()} == {f"{part}_1": f"{part}_2" for part in PARTS}
    assert not any(p.is_named for p in found_pairs.values())


def test_a_pair_that_nothing_names_may_be_meant_to_differ(tmp_path: Path) -> None:
    finding = one(tmp_path, heavier(humanoid("{}_1", "{}_2"), "arm_2", 1.2))
    assert (finding.message_id, finding.severity) == ("pair", Severity.INFO)


def test_the_headline_says_that_the_inertials_of_mirrored_parts_are_not(tmp_path: Path) -> None:
    assert one(tmp_path, DEFECTS["mass"](ROBOT)).headline == "left_arm and right_arm: inertials not mirrored"


def test_the_axes_of_an_arm_may_be_called_l_and_r(tmp_path: Path) -> None:
    robot = ET.Element("robot", name="arm")
    for i, name in enumerate(("base", "link_l", "link_r")):
        robot.append(make_box_link(name, PARTS["arm"][0]))
        if i:
            robot.append(
                make_motor_joint(f"joint_{i}", ("base", "link_l")[i - 1], name, (0, 0.1, 0.2), (0, 1, 0), (-1, i))
            )
    assert not pairs_of(tmp_path, robot)


def test_the_fingers_of_either_hand_have_a_plane_of_their_own(tmp_path: Path) -> None:
    robot = copy.deepcopy(ROBOT)
    finger: Pieces = (((0.01, 0.02, 0.05), (0.0, 0.01, -0.025)),)
    for hand in ("left_hand", "right_hand"):
        for name, y in (("left_finger", 0.03), ("right_finger", -0.03)):
            pieces = finger if y > 0 else [(size, flipped(centre)) for size, centre in finger]
            robot.append(make_box_link(f"{hand}_{name}", pieces))
            robot.append(
                make_motor_joint(f"{hand}_{name}_joint", hand, f"{hand}_{name}", (0, y, -0.1), (1, 0, 0), (-0.5, 0.5))
            )
    planes = {
        p.one: p.plane.offset for p in mirror_pairs(model_of(tmp_path, robot)) if "finger" in p.one and "hand" in p.one
    }
    assert planes["left_hand_left_finger"] == pytest.approx(0.28) or planes["left_hand_left_finger"] == pytest.approx(
        0.0
    )
    offsets = {round(p.plane.offset, 6) for p in mirror_pairs(model_of(tmp_path, robot))}
    assert offsets == {-0.28, 0.0, 0.28}


def test_the_twin_says_what_a_link_should_declare(tmp_path: Path) -> None:
    model = model_of(tmp_path, ROBOT)
    for name in ("left_arm", "right_hand"):
        own, twin = (
            read_declared_inertial(model.link_by_name[name]),
            estimate_from_twin(model, model.link_by_name[name]),
        )
        assert own is not None
        assert twin is not None
        np.testing.assert_allclose(twin.com, own.com, atol=1e-12)
        np.testing.assert_allclose(twin.inertia, own.inertia, atol=1e-12)
    assert estimate_from_twin(model, model.link_by_name["torso"]) is None


# -- which side --------------------------------------------------------------------------------------------------------


def test_the_fix_writes_the_mirrored_numbers(tmp_path: Path) -> None:
    finding = one(tmp_path, com_copied(ROBOT))
    assert finding.fix is not None
    (edit,) = finding.fix.edits
    assert [float(v) for v in edit.replacement.split()] == pytest.approx(
        [float(v) for v in numbers(ROBOT, f"{RIGHT}/origin")["xyz"].split()], rel=1e-9
    )


def test_the_fix_is_written_in_the_wrong_links_own_inertial_frame(tmp_path: Path) -> None:
    turned = rotated_inertial(DEFECTS["inertial copied"](ROBOT), "right_arm", ASKEW)
    finding = one(tmp_path, turned)
    assert finding.fix is not None
    mended = turned
    for edit, path in zip(finding.fix.edits, ["origin", *["inertia"] * (len(finding.fix.edits) - 1)], strict=True):
        element = mended.find(f"{RIGHT}/{path}")
        assert element is not None
        (name,) = (key for key, value in element.attrib.items() if value == edit.expected)
        mended = with_(mended, f"{RIGHT}/{path}", **{name: edit.replacement})
    assert not find_mirror_defects(tmp_path / "mended", mended)


MACRO = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
<link name="torso"/>
<xacro:macro name="arm" params="side reflect">
<link name="${{side}}_arm">{inertial}{visuals}</link>
<joint name="${{side}}_shoulder" type="revolute"><parent link="torso"/><child link="${{side}}_arm"/>
<origin xyz="0 ${{reflect * 0.2}} 0.3"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="9" velocity="2"/></joint>
</xacro:macro>
<xacro:arm side="left" reflect="1"/>
<xacro:arm side="right" reflect="-1"/>
</robot>
"""


def test_a_macro_that_forgets_to_reflect_is_not_edited(tmp_path: Path) -> None:
    """Its one line makes both sides: a number in it would be wrong on the other."""
    arm = make_box_link("arm", PARTS["arm"][0])
    inertial = ET.tostring(arm.findall("inertial")[0], encoding="unicode")
    visuals = "".join(ET.tostring(visual, encoding="unicode") for visual in arm.findall("visual"))
    text = MACRO.format(inertial=inertial, visuals=visuals.replace("0.03 0.06 -0.05", "0.03 ${reflect * 0.06} -0.05"))
    (finding,) = check_text(tmp_path, text, "robot.urdf.xacro", codes={"SYM004", "INR009"}).findings
    assert finding.cause is not None
    assert finding.cause.id == "copied"
    assert finding.fix is not None
    assert not finding.fix.edits
    assert "a parameter such as `reflect`, 1 for left_arm and -1 for right_arm" in finding.fix.title
    assert re.search(r'xyz="[0-9.]+ \$\{reflect\*[0-9.]+\} -?[0-9.]+"', finding.fix.title)
    assert re.search(r'iyz="\$\{reflect\*-?[0-9.e-]+\}"', finding.fix.title)


@pytest.mark.parametrize("has_products", [True, False])
def test_a_block_that_a_call_hands_to_the_macro_belongs_to_one_side(tmp_path: Path, has_products: bool) -> None:
    """One macro makes both inertials, and each call has its own COM: that is the line to change."""
    arm = make_box_link("arm", PARTS["arm"][0])
    inertial, origin = arm.findall("inertial")[0], arm.findall("inertial/origin")[0]
    visuals = "".join(ET.tostring(visual, encoding="unicode") for visual in arm.findall("visual"))
    inertial.remove(origin)
    if not has_products:
        inertial.findall("inertia")[0].attrib.update(ixy="0", ixz="0", iyz="0")
    body = ET.tostring(inertial, encoding="unicode").replace("<inertial>", '<inertial><xacro:insert_block name="com"/>')
    macro = f'<xacro:macro name="weigh" params="*com">{body}</xacro:macro>'
    call = f"<xacro:weigh>{ET.tostring(origin, encoding='unicode')}</xacro:weigh>"
    links = [
        f'<link name="{side}_arm">{call}{visuals.replace("0.03 0.06", f"0.03 {y}")}</link><joint name="{side}_shoulder" '
        f'type="revolute"><parent link="torso"/><child link="{side}_arm"/><origin xyz="0 {place} 0.3"/><axis xyz="0 1 0"/>'
        '<limit lower="-1" upper="1" effort="9" velocity="2"/></joint>'
        for side, y, place in (("left", "0.06", 0.2), ("right", "-0.06", -0.2))
    ]
    text = f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="torso"/>{macro}{"".join(links)}</robot>'
    (finding,) = check_text(tmp_path, text, "robot.urdf.xacro", codes={"SYM004", "INR009"}).findings
    assert finding.fix is not None
    if has_products:
        assert not finding.fix.edits
        assert re.match(r'write xyz="[^$"]+" in right_arm and give the macro a parameter', finding.fix.title)
    else:
        assert len(finding.fix.edits) == 1
        assert "macro" not in finding.fix.title


def test_a_side_whose_macro_computes_its_numbers_leads_to_their_definitions(tmp_path: Path) -> None:
    arm = make_box_link("arm", PARTS["arm"][0])
    inertial = ET.tostring(arm.findall("inertial")[0], encoding="unicode")
    y = re.search(r'xyz="\S+ (\S+)', inertial)
    assert y is not None
    visuals = "".join(ET.tostring(visual, encoding="unicode") for visual in arm.findall("visual"))
    text = MACRO.format(
        inertial=inertial.replace(f" {y[1]} ", " ${offset} ", 1),
        visuals=visuals.replace("0.03 0.06 -0.05", "0.03 ${reflect * 0.06} -0.05"),
    ).replace("<xacro:macro", f'<xacro:property name="offset" value="{y[1]}"/><xacro:macro', 1)
    (finding,) = check_text(tmp_path, text, "robot.urdf.xacro", codes={"SYM004", "INR009"}).findings
    assert finding.fix is not None
    assert "computed from property offset (line" in finding.fix.title
    assert not finding.fix.edits


def test_nothing_is_edited_where_nothing_says_which_side_is_wrong(tmp_path: Path) -> None:
    finding = one(tmp_path, DEFECTS["mass"](ROBOT))
    assert finding.fix is not None
    assert not finding.fix.edits
    assert finding.fix.title.startswith("if left_arm is right, write ")
    assert " in right_arm; if right_arm is, write " in finding.fix.title
    assert finding.fix.title.endswith(" in left_arm")


def quadruped() -> Robot:
    """A body with four equal hips, left and right mirrored."""
    robot = ET.Element("robot", name="quadruped")
    robot.append(make_box_link("body", [((0.5, 0.2, 0.1), (0.0, 0.0, 0.0))]))
    pieces, _, _, limits = PARTS["arm"]
    for name, x, side in (("FL", 0.2, 1), ("FR", 0.2, -1), ("RL", -0.2, 1), ("RR", -0.2, -1)):
        robot.append(make_box_link(f"{name}_hip", pieces if side > 0 else [(s, flipped(c)) for s, c in pieces]))
        robot.append(make_motor_joint(f"{name}_joint", "body", f"{name}_hip", (x, 0.15 * side, 0), (0, 1, 0), limits))
    return robot


def test_the_hind_legs_decide_about_the_front_legs(tmp_path: Path) -> None:
    finding = one(tmp_path, heavier(quadruped(), "FL_hip", 1.3))
    assert (finding.message_id, finding.location.subject) == ("like", "link[FL_hip]/inertial/mass@value")
    assert "RL_hip, RR_hip" in finding.message
    limited = one(tmp_path, with_(quadruped(), "joint[@name='FL_joint']/limit", upper="1.0"))
    assert (limited.message_id, limited.location.subject) == ("limits", "joint[FL_joint]/limit")
    assert limited.fix is not None
    assert [(e.expected, e.replacement) for e in limited.fix.edits] == [("1.0", "2.0")]


def wider(robot: Robot, link_name: str, *factors: float) -> Robot:
    """The robot with other moments of inertia of a link: so many times the right ones."""
    path = f"link[@name='{link_name}']/inertial/inertia"
    six = numbers(robot, path)
    return with_(
        robot, path, **{n: repr(f * float(six[n])) for n, f in zip(("ixx", "iyy", "izz"), factors, strict=True)}
    )


def test_numbers_that_are_far_from_every_drawn_part_are_not_copied(tmp_path: Path) -> None:
    """The hind legs have the tensor of one front leg, which is hundreds of times that of any of them."""
    robot = quadruped()
    for name in ("FR_hip", "RL_hip", "RR_hip"):
        robot = wider(robot, name, 900, 700, 1800)
    (finding,) = find(tmp_path, ET.tostring(wider(robot, "FL_hip", 460, 460, 460), encoding="unicode"), "SYM004")
    assert finding.message_id == "both"
    assert finding.fix is not None
    assert not finding.fix.edits
    assert finding.fix.title == "compute both inertials from the parts: neither is near that of what is drawn"


def test_a_leg_with_the_inertia_of_what_it_draws_is_right_whatever_the_others_have(tmp_path: Path) -> None:
    robot = quadruped()
    for name in ("FR_hip", "RL_hip", "RR_hip"):
        robot = wider(robot, name, 900, 700, 1800)
    (finding,) = find(tmp_path, ET.tostring(robot, encoding="unicode"), "SYM004")
    assert (finding.message_id, finding.location.subject) == ("inertial", "link[FR_hip]/inertial/inertia")
    assert "The drawing of FR_hip fits the inertial of FL_hip much better" in finding.message


def test_a_symmetric_part_may_be_on_the_other_side_after_half_a_turn(tmp_path: Path) -> None:
    """Of a box the drawing is its own image by a mirror and by any half turn."""
    robot = quadruped()
    for name, side in (("FL_hip", 1), ("FR_hip", -1)):
        fresh = make_box_link(name, [((0.06, 0.05, 0.2), (0.0, 0.0, -0.1))])
        place = fresh.find("inertial/origin")
        assert place is not None
        place.set("xyz", f"{0.002 * side} 0 -0.1")
        old = robot.find(f"link[@name='{name}']")
        assert old is not None
        robot.remove(old)
        robot.append(fresh)
    assert not find(tmp_path, ET.tostring(robot, encoding="unicode"), "SYM004")


def test_one_tensor_for_two_masses_has_the_same_axes() -> None:
    one = DeclaredInertial(1.0, np.zeros(3), np.diag((0.0129, 0.0129, 0.0004)))
    other = replace(one, mass=0.4)
    words = list(describe_differences(one, other, measure_deviation(one, other), 0.01))
    assert words == ["mass 1 kg instead of 0.4 kg (× 2.5)"]


def test_limbs_that_agree_roughly_decide_nothing(tmp_path: Path) -> None:
    """Votes need the same digits."""
    robot = with_(quadruped(), "joint[@name='FL_joint']/limit", upper="1.0")
    for name, upper in (("RL", "2.002"), ("RR", "1.998")):
        robot = with_(robot, f"joint[@name='{name}_joint']/limit", upper=upper)
    finding = one(tmp_path, robot)
    assert finding.message_id == "limits_pair"
    assert finding.fix is not None
    assert not finding.fix.edits


@pytest.mark.parametrize(("upper", "found"), [("2.06", False), ("2.3", True)])
def test_measured_limits_differ_by_little(tmp_path: Path, upper: str, found: bool) -> None:
    """Six legs whose ranges all differ in their digits."""
    robot = ET.Element("robot", name="hexapod")
    robot.append(make_box_link("body", [((1.2, 0.2, 0.1), (0.0, 0.0, 0.0))]))
    pieces = PARTS["arm"][0]
    uppers = ["2.0013", "1.9987", "2.0101", "1.9961", "2.0067", "1.9932", "1.9899", "2.0021", upper, "1.9991"]
    for index, measured in enumerate(uppers):
        side = -1 if index % 2 else 1
        name = f"{'RL'[side > 0]}{index // 2}_hip"
        robot.append(make_box_link(name, pieces if side > 0 else [(s, flipped(c)) for s, c in pieces]))
        place = (0.2 * (index // 2) - 0.4, 0.15 * side, 0)
        robot.append(make_motor_joint(f"{name}_joint", "body", name, place, (0, 1, 0), (-1.0, float(measured))))
    assert bool(find_mirror_defects(tmp_path, robot)) is found


@pytest.mark.parametrize("own", [True, False])
def test_parts_that_differ_as_they_are_drawn_have_other_inertials(tmp_path: Path, own: bool) -> None:
    """The hands are of one shape, one a little longer and thicker. Each has the inertial of what it draws, or one of them not."""
    robot = without(ROBOT, ".", "none")
    pieces = [(tuple(1.03 * v for v in size), centre) for size, centre in PARTS["hand"][0]]
    larger = make_box_link("right_hand", [(s, flipped(c)) for s, c in pieces])  # type: ignore[misc]
    hand = robot.find("link[@name='right_hand']")
    assert hand is not None
    hand[:] = larger[:]
    found = find_mirror_defects(tmp_path, robot if own else heavier(robot, "right_hand", 1.2))
    assert ("moments" in {finding.message_id for finding in found}) is not own


@pytest.mark.parametrize(("offset", "found"), [(0.002, False), (0.004, True)])
def test_coms_that_are_off_their_own_drawings_alike_are_right(tmp_path: Path, offset: float, found: bool) -> None:
    """The right hand is drawn a millimetre further, and both COMs are two off their drawing: what is not drawn is heavy."""
    robot = copy.deepcopy(ROBOT)
    old = robot.find("link[@name='right_hand']")
    assert old is not None
    robot.remove(old)
    moved = [(size, (x + 0.001, -y, z)) for size, (x, y, z) in PARTS["hand"][0]]
    robot.append(make_box_link("right_hand", moved))
    for side, added in (("left", 0.002), ("right", offset)):
        origin = robot.find(f"link[@name='{side}_hand']/inertial/origin")
        assert origin is not None
        x, y, z = (float(word) for word in origin.attrib["xyz"].split())
        origin.set("xyz", f"{x + added} {y} {z}")
    assert bool([f for f in find_mirror_defects(tmp_path, robot) if f.code == "SYM004"]) is found


def test_limits_that_slipped_by_one_joint_are_one_finding(tmp_path: Path) -> None:
    robot = copy.deepcopy(ROBOT)
    limits = [robot.find(f"joint[@name='right_{part}_joint']/limit") for part in PARTS]
    before = [dict(limit.attrib) for limit in limits if limit is not None]
    for limit, values in zip(limits, [{"lower": "-0.1", "upper": "0.4"}, *before[:-1]], strict=True):
        assert limit is not None
        limit.attrib.update(values)
    finding = one(tmp_path, robot)
    assert told(finding) == ("chain", "shifted", "joint[right_shoulder_joint]/limit")
    assert finding.subjects == tuple(f"joint[right_{part}_joint]/limit" for part in PARTS)
    assert finding.data["count"] == 3


# -- what is left alone ------------------------------------------------------------------------------------------------


def copied(part: str) -> Robot:
    """The robot with the left part used on the right as well, as drawn and as declared."""
    robot = copy.deepcopy(ROBOT)
    old = robot.find(f"link[@name='right_{part}']")
    assert old is not None
    robot.remove(old)
    robot.append(make_box_link(f"right_{part}", PARTS[part][0]))
    return robot


def test_one_part_used_on_both_sides_has_one_inertial(tmp_path: Path) -> None:
    robot = copied("hand")
    assert pairs_of(tmp_path, robot)["left_hand"].drawn_as == "copied"
    assert not find_mirror_defects(tmp_path, robot)


def test_one_part_on_both_sides_is_not_mirrored(tmp_path: Path) -> None:
    robot = copied("hand")
    path = "link[@name='right_hand']/inertial"
    for tag in ("origin", "inertia"):
        robot = with_(robot, f"{path}/{tag}", **numbers(ROBOT, f"{path}/{tag}"))
    finding = one(tmp_path, robot)
    assert finding.cause is not None
    assert finding.cause.id == "mirrored"


def test_one_module_on_both_sides_may_have_one_range(tmp_path: Path) -> None:
    robot = with_(copied("hand"), "joint[@name='right_hand_joint']/limit", lower="-0.5", upper="1.2")
    assert not find_mirror_defects(tmp_path, robot)


@pytest.mark.parametrize(
    ("axis", "yaw", "found"), [("0 1 0", "0", False), ("0 1 0", "3.141592653589793", False), ("0 -1 0", "0", True)]
)
def test_one_module_has_one_axis(tmp_path: Path, axis: str, yaw: str, found: bool) -> None:
    """A symmetric tool with one range may be the same on both sides, also turned round, unless its axis was negated."""
    robot = copy.deepcopy(ROBOT)
    for side, y in (("left", 0.05), ("right", -0.05)):
        robot.append(make_box_link(f"{side}_tool", [((0.06, 0.04, 0.02), (0.0, 0.0, 0.0))]))
        robot.append(
            make_motor_joint(f"{side}_tool_joint", f"{side}_hand", f"{side}_tool", (0, y, -0.1), (0, 1, 0), (-0.1, 1.5))
        )
    robot = with_(robot, "joint[@name='right_tool_joint']/axis", xyz=axis)
    robot = with_(robot, "joint[@name='right_tool_joint']/origin", rpy=f"0 0 {yaw}")
    findings = find_mirror_defects(tmp_path, robot)
    assert [told(f) for f in findings] == [("limits_pair", "axis_negated", "joint[right_tool_joint]/limit")] * found
    for finding in findings:
        assert finding.fix is not None
        assert "reverse the axis of right_tool_joint, or " in finding.fix.title
        assert not finding.fix.edits


@pytest.mark.parametrize(
    ("copied_part", "kind", "found"), [("", "revolute", True), ("", "fixed", False), ("arm", "revolute", False)]
)
def test_one_origin_on_mirrored_parts_is_a_lost_sign(tmp_path: Path, copied_part: str, kind: str, found: bool) -> None:
    """On two parts of one module it is meant, and so it may be of a fixed sensor."""
    robot = copied(copied_part) if copied_part else copy.deepcopy(ROBOT)
    for side in ("left", "right"):
        joint = robot.find(f"joint[@name='{side}_hand_joint']")
        assert joint is not None
        joint.set("type", kind)
        robot = with_(robot, f"joint[@name='{side}_hand_joint']/origin", xyz="0 0.04 -0.32")
    slips = [f for f in find_mirror_defects(tmp_path, robot) if f.message_id in {"slip", "origin"}]
    assert [told(f) for f in slips] == [("slip", "sign", "joint[right_hand_joint]/origin@xyz")] * found


def test_no_repair_puts_two_parts_into_one_place(tmp_path: Path) -> None:
    """The sign of the side is in the wrong coordinate: mirrored, each would be where the other one is."""
    robot = copy.deepcopy(ROBOT)
    for side, x in (("left", 0.1), ("right", -0.1)):
        robot.append(make_box_link(f"{side}_sensor", [((0.03, 0.02, 0.01), (0.0, 0.0, 0.0))]))
        robot.append(
            make_motor_joint(f"{side}_sensor_joint", "torso", f"{side}_sensor", (x, 0, 0.4), (0, 0, 1), (-1, 1))
        )
    (slip,) = (f for f in find_mirror_defects(tmp_path, robot) if f.message_id == "slip")
    assert slip.fix is not None
    assert slip.fix.title.startswith("make the two opposite across the middle, and not in x: ")


def test_a_part_that_is_turned_round_for_the_other_side_turns_its_inertial(tmp_path: Path) -> None:
    """A symmetric part may be mirrored or turned: its centre of mass, off the middle of what is drawn, tells which."""
    robot = copy.deepcopy(ROBOT)
    for side, yaw, com in (("left", "0", "0.01 0.004 0"), ("right", "3.141592653589793", "-0.01 -0.004 0")):
        box = make_box_link(f"{side}_tool", [((0.06, 0.04, 0.02), (0.0, 0.0, 0.0))])
        robot.append(box)
        y = 0.05 if side == "left" else -0.05
        robot.append(
            make_motor_joint(f"{side}_tool_joint", f"{side}_hand", f"{side}_tool", (0, y, -0.1), (0, 1, 0), (-1, 1))
        )
        robot = with_(robot, f"link[@name='{side}_tool']/visual/origin", rpy=f"0 0 {yaw}")
        robot = with_(robot, f"link[@name='{side}_tool']/inertial/origin", xyz=com)
    assert pairs_of(tmp_path, robot)["left_tool"].drawn_as == "both"
    assert not [f for f in find_mirror_defects(tmp_path, robot) if f.code == "SYM004"]


@pytest.mark.parametrize(
    ("paths", "subject"),
    [
        ("link[@name='{}_hand']/inertial/origin", "link[right_hand]/inertial/origin@xyz"),
        ("joint[@name='{}_hand_joint']/origin", "joint[right_hand_joint]/origin@xyz"),
    ],
)
@pytest.mark.parametrize("is_shared", [True, False])
def test_a_property_that_both_sides_read_stays(tmp_path: Path, paths: str, subject: str, is_shared: bool) -> None:
    """It is right for the left side: what is wrong is the line of the right one. A property of its own is wrong itself."""
    left = ROBOT.find(paths.format("left"))
    assert left is not None
    place = left.get("xyz", "") if "link" in paths else "0 0.04 -0.32"
    robot = with_(ROBOT, paths.format("left"), xyz="${place}" if is_shared else place)
    robot = with_(robot, paths.format("right"), xyz="${place}")
    xacro = "{http://www.ros.org/wiki/xacro}"
    macro = ET.Element(f"{xacro}macro", name="all", params="")
    macro.extend(robot)
    whole = ET.Element("robot", name="r")
    whole.extend((ET.Element(f"{xacro}property", name="place", value=place), macro, ET.Element(f"{xacro}all")))
    text = ET.tostring(whole, encoding="unicode").replace("><", ">\n<")
    (finding,) = find(tmp_path, text, "SYM004", name="robot.urdf.xacro")
    assert finding.location.subject == subject
    assert finding.location.span is not None
    line = text.splitlines()[finding.location.span.line - 1]
    assert ("property" in line) != is_shared
    assert finding.fix is not None
    own = 'write xyz="' in finding.fix.title and "in place of `${place}`, which left_hand" in finding.fix.title
    assert own == is_shared


@pytest.mark.parametrize("factor", [0.8, 0.3])
def test_one_part_in_frames_that_are_alike_has_one_com_whatever_it_weighs(tmp_path: Path, factor: float) -> None:
    """A mirror would fit the drawing, too; the numbers are those of a copy, and only the masses differ."""
    robot = copy.deepcopy(ROBOT)
    for side, y in (("left", 0.05), ("right", -0.05)):
        robot.append(make_box_link(f"{side}_tool", [((0.06, 0.04, 0.02), (0.0, 0.0, 0.0))]))
        robot.append(
            make_motor_joint(f"{side}_tool_joint", f"{side}_hand", f"{side}_tool", (0, y, -0.1), (0, 1, 0), (-1, 1))
        )
        robot = with_(robot, f"link[@name='{side}_tool']/inertial/origin", xyz="0.01 0.004 0.001")
        robot = with_(robot, f"link[@name='{side}_tool']/inertial/inertia", ixy="-1e-6")
    mass = robot.find("link[@name='right_tool']/inertial/mass")
    assert mass is not None
    robot = with_(
        robot, "link[@name='right_tool']/inertial/mass", value=f"{factor * float(mass.get('value', '0')):.5g}"
    )
    (finding,) = (f for f in find_mirror_defects(tmp_path, robot) if f.code == "SYM004")
    assert finding.location.subject == "link[right_tool]/inertial/mass@value"
    assert "COM" not in finding.message
    assert "ixy" not in finding.message
    assert finding.message.endswith("The file does not show which mass is wrong")
    assert finding.fix is not None
    assert "write mass value=" in finding.fix.title
    assert "write xyz" not in finding.fix.title


def test_sides_that_are_drawn_differently_are_meant_to_differ(tmp_path: Path) -> None:
    pieces = [*PARTS["hand"][0], ((0.1, 0.1, 0.1), (0.0, 0.0, -0.15))]
    robot = copy.deepcopy(ROBOT)
    old = robot.find("link[@name='right_hand']")
    assert old is not None
    robot.remove(old)
    robot.append(make_box_link("right_hand", pieces))
    assert not find_mirror_defects(tmp_path, robot)


def test_limbs_whose_zero_is_not_mirrored_have_other_limits(tmp_path: Path) -> None:
    robot = with_(ROBOT, "joint[@name='right_shoulder_joint']/origin", rpy="0.6 0 0")
    robot = with_(robot, "joint[@name='right_shoulder_joint']/limit", lower="-2.4", upper="-0.3")
    assert not find_mirror_defects(tmp_path, robot)


@pytest.mark.parametrize(("turns", "found"), [(0, True), (-1, False), (1, True)])
def test_ranges_that_are_a_whole_turn_apart_are_one_range(tmp_path: Path, turns: int, found: bool) -> None:
    """The left joint turns in 1.6 … 3.7; the mirror image is -3.7 … -1.6, or 2.583 … 4.683 from a zero on the other half turn."""
    robot = with_(ROBOT, "joint[@name='left_hand_joint']/limit", lower="1.6", upper="3.7")
    bounds = {"lower": f"{-3.7 - turns * math.tau:.6g}", "upper": f"{-1.6 - turns * math.tau:.6g}"}
    if found:
        bounds["upper"] = f"{float(bounds['upper']) + 0.3:.6g}"
    robot = with_(robot, "joint[@name='right_hand_joint']/limit", **bounds)
    assert bool(find_mirror_defects(tmp_path, robot)) == found


def test_a_shifted_zero_does_not_displace_what_hangs_on_the_joint(tmp_path: Path) -> None:
    assert not find_mirror_defects(tmp_path, with_(ROBOT, "joint[@name='right_arm_joint']/origin", rpy="0 0.1 0"))


def test_joints_that_follow_another_are_not_compared(tmp_path: Path) -> None:
    robot = with_(ROBOT, "joint[@name='right_hand_joint']/limit", effort="1")
    follower = robot.find("joint[@name='right_hand_joint']")
    assert follower is not None
    ET.SubElement(follower, "mimic", joint="left_hand_joint", multiplier="-1")
    assert not find_mirror_defects(tmp_path, robot)


def follow(robot: Robot, follower: str, leader: str) -> Robot:
    """Let one joint mimic another."""
    robot = copy.deepcopy(robot)
    joint = robot.find(f"joint[@name='{follower}']")
    assert joint is not None
    ET.SubElement(joint, "mimic", joint=leader)
    return robot


@pytest.mark.parametrize("drawn", [True, False])
@pytest.mark.parametrize(("follower", "leader", "found"), [("left", "right", False), ("right", "left", True)])
def test_the_drive_of_two_joints_may_be_booked_on_the_side_that_leads(
    tmp_path: Path, follower: str, leader: str, found: bool, drawn: bool
) -> None:
    robot = heavier(ROBOT if drawn else strip_drawings(ROBOT), "right_hand", 1.5)
    robot = follow(robot, f"{follower}_hand_joint", f"{leader}_hand_joint")
    assert bool(find_mirror_defects(tmp_path, robot)) == found


def test_a_joint_with_two_limits_is_left_to_another_rule(tmp_path: Path) -> None:
    robot = with_(copy.deepcopy(ROBOT), "joint[@name='right_hand_joint']/limit", effort="1")
    assert one(tmp_path / "one", robot).message_id == "limits_pair"
    joint = robot.find("joint[@name='right_hand_joint']")
    assert joint is not None
    ET.SubElement(joint, "limit", lower="-1", upper="1", effort="30", velocity="3")
    assert not find_mirror_defects(tmp_path / "two", robot)


def test_a_placeholder_beside_a_computed_tensor_is_the_wrong_one(tmp_path: Path) -> None:
    six = dict(zip(SIX, ("0.001", "0", "0", "0.001", "0", "0.001"), strict=True))
    finding = one(tmp_path, with_(ROBOT, f"{RIGHT}/inertia", **six))
    assert (finding.code, finding.message_id, finding.cause and finding.cause.id) == ("SYM004", "typed", "placeholder")
    assert finding.location.subject.startswith("link[right_arm]")
    # Where both were typed, the rule about one link reports both.
    both = with_(with_(ROBOT, f"{RIGHT}/inertia", **six), f"{LEFT}/inertia", **six)
    assert not [f for f in find_mirror_defects(tmp_path, both) if f.code == "SYM004" and f.message_id == "typed"]


def test_without_drawings_only_what_mirror_and_copy_have_in_common_counts(tmp_path: Path) -> None:
    robot = ROBOT
    for side in ("left", "right"):
        for part in PARTS:
            robot = without(robot, f"link[@name='{side}_{part}']", "visual")
    assert not find_mirror_defects(tmp_path / "copied", com_copied(inertia_copied(robot)))
    finding = one(tmp_path, heavier(robot, "right_arm", 1.5))
    assert told(finding) == ("moments", None, "link[right_arm]/inertial/mass@value")


def test_sides_that_are_not_drawn_may_be_two_parts(tmp_path: Path) -> None:
    """Masses and radii of gyration differ: a note, and nothing at all where only one side carries a suction pad."""
    robot = scale_inertial(strip_drawings(ROBOT), "link[@name='right_hand']/inertial", mass=1.3, tensor=1.9)
    finding = one(tmp_path / "a", robot)
    assert (finding.message_id, finding.severity) == ("moments", Severity.INFO)
    assert finding.fix is not None
    assert "mirrored numbers" not in finding.fix.title
    same_mass = scale_inertial(strip_drawings(ROBOT), "link[@name='right_hand']/inertial", tensor=1.9)
    assert one(tmp_path / "b", same_mass).severity is Severity.WARNING
    ET.SubElement(robot, "link", name="pad")
    pad = ET.SubElement(robot, "joint", name="pad_joint", type="fixed")
    ET.SubElement(pad, "parent", link="right_hand")
    ET.SubElement(pad, "child", link="pad")
    assert not find_mirror_defects(tmp_path / "c", robot)


def make_turned_hands(*, turned: bool) -> Robot:
    """Hands whose piece inside is 6 mm above the middle of the left one. The right one is its mirror image, or ``turned`` by half
    a turn about x; its inertial is turned in both cases."""
    pieces: Pieces = [((0.03, 0.02, 0.006), (0.02, 0.01, 0.006)), ((0.1, 0.06, 0.04), (0.0, 0.02, 0.0))]
    half_turn = [(size, (x, -y, -z)) for size, (x, y, z) in pieces]
    right = half_turn if turned else [(size, flipped(centre)) for size, centre in pieces]
    robot = copy.deepcopy(ROBOT)
    for side, drawn in (("left", pieces), ("right", right)):
        hand = robot.find(f"link[@name='{side}_hand']")
        assert hand is not None
        hand[:] = make_box_link("hand", drawn)[:]
    six = numbers(robot, "link[@name='left_hand']/inertial/inertia", "ixy", "ixz")
    robot = with_(robot, "link[@name='right_hand']/inertial/inertia", **six)
    for side, place in (("left", "0.003 0.02 0.002"), ("right", "0.003 -0.02 -0.002")):
        robot = with_(robot, f"link[@name='{side}_hand']/inertial/origin", xyz=place)
    return robot


def test_a_part_that_is_nearly_its_own_mirror_image_may_be_turned_round(tmp_path: Path) -> None:
    """The drawings decide: they fit a mirror to within tessellation, and a half turn exactly."""
    assert not find_mirror_defects(tmp_path / "turned", make_turned_hands(turned=True))
    pair = pairs_of(tmp_path / "turned", make_turned_hands(turned=True))["left_hand"]
    assert pair.mirror_mismatch is not None
    assert pair.copy_mismatch is not None
    assert 0.01 < pair.mirror_mismatch < 0.03
    assert pair.copy_mismatch < 1e-9
    mirrored = make_turned_hands(turned=False)
    assert pairs_of(tmp_path / "mirrored", mirrored)["left_hand"].drawn_as == "mirrored"
    assert one(tmp_path / "mirrored", mirrored).code == "SYM004"


@pytest.mark.parametrize(("y", "count"), [(0.002, 0), (0.006, 1)])
def test_a_part_may_be_mirrored_in_its_own_axes(tmp_path: Path, y: float, count: int) -> None:
    """The mesh of the right hand is that of the left one with a scale of -1 in z; both are their own images in y."""
    robot = copy.deepcopy(ROBOT)
    for side, z in (("left", 0.006), ("right", -0.006)):
        hand = robot.find(f"link[@name='{side}_hand']")
        assert hand is not None
        hand[:] = make_box_link("hand", [((0.03, 0.02, 0.006), (0.02, 0.0, z)), ((0.1, 0.06, 0.04), (0.0, 0.0, 0.0))])[
            :
        ]
    for side, place in (("left", "0.003 0.002 0.002"), ("right", f"0.003 {y} -0.002")):
        robot = with_(robot, f"link[@name='{side}_hand']/inertial/origin", xyz=place)
    assert len(find_mirror_defects(tmp_path, robot)) == count


def test_signs_are_those_of_a_mirror_only_in_mirrored_frames(tmp_path: Path) -> None:
    wrong = numbers(ROBOT, f"{RIGHT}/inertia", "iyz")
    robot = with_(ROBOT, f"{RIGHT}/inertia", **wrong)
    pair = pairs_of(tmp_path, robot)["left_arm"]
    both = compare_sides(model_of(tmp_path, robot), pair)
    assert both is not None
    assert find_cause(pair, both[1], 0.01) == "signs"
    assert find_cause(replace(pair, linear=pair.linear @ ASKEW), both[1], 0.01) is None


def strip_drawings(robot: Robot) -> Robot:
    """The robot whose arms draw nothing."""
    for side in ("left", "right"):
        for part in PARTS:
            robot = without(robot, f"link[@name='{side}_{part}']", "visual")
    return robot


def scale_inertial(robot: Robot, path: str, *, mass: float = 1.0, tensor: float = 1.0) -> Robot:
    value = float(numbers(robot, f"{path}/mass")["value"])
    six = {name: repr(tensor * float(value)) for name, value in numbers(robot, f"{path}/inertia").items()}
    return with_(with_(robot, f"{path}/mass", value=repr(mass * value)), f"{path}/inertia", **six)


@pytest.mark.parametrize(
    ("mass", "tensor", "cause", "words"),
    [
        (1.0, 1e7, "unit", "10,000,000 times that of its twin, in all moments. It fits if it was written in g·cm²"),
        (1e3, 1.0, "mass_unit", "if the mass of right_arm was written in g"),
        (1e3, 1e9, "slip", "g and g·mm²"),
        (10.0, 1.0, "decimal", "a power of ten"),
        (10.0, 10.0, "decimal", "a power of ten"),
    ],
)
def test_without_drawings_one_mistake_that_leads_to_the_twin_is_named(
    tmp_path: Path, mass: float, tensor: float, cause: str, words: str
) -> None:
    finding = one(tmp_path, scale_inertial(strip_drawings(ROBOT), RIGHT, mass=mass, tensor=tensor))
    assert finding.message_id == "moments"
    assert finding.cause is not None
    assert finding.cause.id == cause
    assert words in finding.cause.text
    assert finding.severity is Severity.WARNING


@pytest.mark.parametrize(
    ("mass", "tensor", "mistake"),
    [(2.2046226, 1.0, "mass_unit"), (10.0, 10.0, "decimal_point"), (1.0, 1e6, "inertia_unit")],
)
def test_the_mistake_of_a_drawn_side_is_found_by_its_twin(
    tmp_path: Path, mass: float, tensor: float, mistake: str
) -> None:
    robot = scale_inertial(ROBOT, RIGHT, mass=mass, tensor=tensor)
    both = compare_sides(model_of(tmp_path, robot), pairs_of(tmp_path, robot)["left_arm"])
    assert both is not None
    slip = find_side_slip(both, 0.01)
    assert slip is not None
    assert slip.mistake.id == mistake
    # What the mistake leaves as it is has to agree.
    moved = with_(robot, f"{RIGHT}/origin", xyz="0.1 0.1 0.1")
    both = compare_sides(model_of(tmp_path, moved), pairs_of(tmp_path, moved)["left_arm"])
    assert both is not None
    assert find_side_slip(both, 0.01) is None


def test_a_coordinate_of_a_com_that_lost_its_decimal_point_is_named(tmp_path: Path) -> None:
    element = ROBOT.find(f"{RIGHT}/origin")
    assert element is not None
    x, y, z = element.attrib["xyz"].split()
    robot = with_(ROBOT, f"{RIGHT}/origin", xyz=f"{10 * float(x)!r} {y} {z}")
    pair = pairs_of(tmp_path, robot)["left_arm"]
    both = compare_sides(model_of(tmp_path, robot), pair)
    assert both is not None
    assert find_cause(pair, both[1], 0.01) == "decimal"


def test_names_that_spell_one_word_apart_are_a_pair_where_no_other_is() -> None:
    assert list(pair_by_name(["steerFL", "steer_FR", "steer_BL", "steer_BR"])) == [
        ("steerFL", "steer_FR"),
        ("steer_BL", "steer_BR"),
    ]
    assert list(pair_by_name(["l_arm", "r_arm", "larm"])) == [("l_arm", "r_arm")]


@pytest.mark.parametrize(("side", "drawn"), [(LEFT, True), (RIGHT, True), (LEFT, False), (RIGHT, False)])
def test_a_side_that_was_rounded_is_named(tmp_path: Path, side: str, drawn: bool) -> None:
    base = ROBOT if drawn else strip_drawings(ROBOT)
    six = {name: float(value) for name, value in numbers(base, f"{side}/inertia").items()}
    factor = 1.6e-3 / min(six[name] for name in ("ixx", "iyy", "izz"))  # 0.002 is left of the smallest moment
    for path in (LEFT, RIGHT):
        base = scale_inertial(base, path, mass=factor, tensor=factor)
    rounded = {name: f"{factor * value:.3f}" for name, value in six.items()}
    finding = one(tmp_path, with_(base, f"{side}/inertia", **rounded))
    assert finding.cause is not None
    name = side.partition("'")[2].partition("'")[0]
    if drawn:
        assert (finding.message_id, finding.cause.id) == ("pair", "rounded")
    else:
        assert finding.cause.text == f"The two agree if one mistake in {name} is undone: rounding: 3 decimals."
    assert finding.severity is Severity.WARNING


def test_rounding_is_a_slip_however_little_it_changes(tmp_path: Path) -> None:
    """As where nothing is drawn: less than the 5 % from which a difference without a cause is a warning."""
    base = ROBOT
    six = {name: float(value) for name, value in numbers(base, f"{LEFT}/inertia").items()}
    factor = 1.87e-3 / min(six[name] for name in ("ixx", "iyy", "izz"))
    for path in (LEFT, RIGHT):
        base = scale_inertial(base, path, mass=factor, tensor=factor)
    finding = one(
        tmp_path, with_(base, f"{LEFT}/inertia", **{name: f"{factor * value:.3f}" for name, value in six.items()})
    )
    assert finding.data["share"] < 0.05
    assert finding.severity is Severity.WARNING


@pytest.mark.parametrize("side", [LEFT, RIGHT])
def test_a_com_that_only_one_side_has_is_missing_on_the_other(tmp_path: Path, side: str) -> None:
    robot = strip_drawings(ROBOT)
    assert not find(tmp_path, ET.tostring(robot, encoding="unicode"), "SYM004")
    finding = one(tmp_path, with_(robot, f"{side}/origin", xyz="0 0 0"))
    assert finding.cause is not None
    assert (finding.message_id, finding.cause.id, finding.severity) == ("moments", "com_missing", Severity.WARNING)
    assert finding.location.subject.startswith(f"link[{side.partition(chr(39))[2].partition(chr(39))[0]}]")


@pytest.mark.parametrize(("kind", "severity"), [("continuous", Severity.WARNING), ("prismatic", Severity.INFO)])
def test_typed_tensors_of_two_fingers_that_are_a_power_of_ten_apart_have_no_cause(
    tmp_path: Path, kind: str, severity: Severity
) -> None:
    """INR009 names none of numbers that were made up, so that it explains nothing either. Where nothing turns them, the tensors
    change nothing."""
    shape = '<visual><geometry><box size="0.03 0.01 0.01"/></geometry></visual>'
    fingers = "".join(
        f'<link name="{side}_finger"><inertial><mass value="1"/><inertia ixx="{typed}" ixy="0" ixz="0" iyy="{typed}" iyz="0" '
        f'izz="{typed}"/></inertial>{shape}</link>'
        f"{joint(f'{side}_joint', 'palm', f'{side}_finger', kind=kind, xyz=f'0 {y} 0', axis=f'0 {y} 0')}"
        for side, y, typed in (("left", 0.02, 0.01), ("right", -0.02, 1))
    )
    finding = one(tmp_path, ET.fromstring(f'<robot name="r"><link name="palm"/>{fingers}</robot>'))
    assert (finding.message_id, finding.cause, finding.severity) == ("both", None, severity)
    assert finding.consequences["pinocchio"].startswith("loads it") == (kind == "prismatic")


def test_marks_that_are_where_there_is_room_do_not_hide_the_plane_of_the_wheels(tmp_path: Path) -> None:
    tensor = '<inertia ixx="0.00082" ixy="0" ixz="0" iyy="0.00147" iyz="0" izz="0.00082"/>'
    sides = "".join(
        f'<link name="{side}_wheel"><inertial><mass value="{mass}"/>{tensor}</inertial></link><link name="{side}_mark"/>'
        f"{joint(f'{side}_wheel_joint', 'base', f'{side}_wheel', kind='continuous', xyz=f'0 {y} 0', axis='0 1 0')}"
        f"{joint(f'{side}_mark_joint', 'base', f'{side}_mark', kind='fixed', xyz=f'{x} {0.8 * y} 0.2')}"
        for side, y, x, mass in (("left", 0.17, 0.001, 0.5), ("right", -0.17, 0.005, 0.5 / 0.45359237))
    )
    finding = one(tmp_path, ET.fromstring(f'<robot name="r"><link name="base"/>{sides}</robot>'))
    assert finding.cause is not None
    assert (finding.message_id, finding.cause.id) == ("moments", "mass_unit")


def test_a_tensor_about_the_origin_is_named_on_the_side_that_has_it(tmp_path: Path) -> None:
    robot = strip_drawings(ROBOT)
    six = {name: float(value) for name, value in numbers(robot, f"{LEFT}/inertia").items()}
    element = robot.find(f"{LEFT}/origin")
    assert element is not None
    com = np.array([float(word) for word in element.attrib["xyz"].split()])
    mass = float(numbers(robot, f"{LEFT}/mass")["value"])
    shift = mass * (com @ com * np.eye(3) - np.outer(com, com))
    for (i, j), name in zip(((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)), SIX, strict=True):
        six[name] += float(shift[i, j])
    finding = one(tmp_path, with_(robot, f"{LEFT}/inertia", **{name: repr(value) for name, value in six.items()}))
    assert told(finding)[1] == "slip"
    assert finding.location.subject.startswith("link[left_arm]")
    assert finding.cause is not None
    assert "one mistake in left_arm is undone: tensor about the origin" in finding.cause.text


@pytest.mark.parametrize("is_in_place", [True, False])
def test_numbers_of_another_part_are_recognized(tmp_path: Path, is_in_place: bool) -> None:
    robot = strip_drawings(ROBOT)
    if not is_in_place:
        robot = moved_link(robot, "right_arm", build_origin_transform((0.004, 0.0, 0.002), (0.0, 0.0, 0.0)))
    upper = "link[@name='left_shoulder']/inertial"
    mass, six = numbers(robot, f"{upper}/mass"), numbers(robot, f"{upper}/inertia")
    found = find_mirror_defects(tmp_path, with_(with_(robot, f"{RIGHT}/mass", **mass), f"{RIGHT}/inertia", **six))
    (finding,) = (f for f in found if f.message_id == "moments")
    assert told(finding)[1] == "other_part"
    assert finding.cause is not None
    assert finding.cause.text.startswith("right_arm has the same numbers as left_shoulder")


def test_one_side_only_is_no_pair(tmp_path: Path) -> None:
    robot = copy.deepcopy(ROBOT)
    robot.append(make_box_link("left_camera", PARTS["hand"][0]))
    robot.append(make_motor_joint("left_camera_joint", "torso", "left_camera", (0.1, 0.02, 0.4), (0, 0, 1), (-1, 1)))
    assert not find_mirror_defects(tmp_path, robot)


# -- repairs ----------------------------------------------------------------------------------------------------------


def test_the_edit_of_a_sign_leaves_the_digits_of_the_other_numbers(tmp_path: Path) -> None:
    wrong = with_(ROBOT, f"{RIGHT}/inertia", **numbers(ROBOT, f"{RIGHT}/inertia", "iyz"))
    rounded = {name: f"{float(value):.5g}" for name, value in numbers(wrong, f"{RIGHT}/inertia").items()}
    finding = one(tmp_path, with_(wrong, f"{RIGHT}/inertia", **rounded))
    assert finding.fix is not None
    (edit,) = finding.fix.edits
    assert edit.expected == rounded["iyz"]
    assert edit.replacement.lstrip("-") == rounded["iyz"].lstrip("-")


@pytest.mark.parametrize(("y", "side"), [(0.0266, "right"), (-0.0266, "left"), (0.003, None)])
def test_the_com_that_is_on_the_other_side_of_the_drawn_part_is_wrong(
    tmp_path: Path, y: float, side: str | None
) -> None:
    """Both COMs are ``y`` (m) from the middle, which nothing in one link explains: the drawn ones are 17 mm out on each side."""
    robot = ROBOT
    for path in (LEFT, RIGHT):
        x, _, z = numbers(ROBOT, f"{path}/origin")["xyz"].split()
        robot = with_(robot, f"{path}/origin", xyz=f"{x} {y} {z}")
    finding = one(tmp_path, robot)
    assert (finding.message_id == "inertial") is (side is not None)
    if side is not None:
        assert finding.location.subject == f"link[{side}_arm]/inertial/origin@xyz"
        assert finding.fix is not None
        (edit,) = finding.fix.edits
        assert float(edit.replacement.split()[1]) == pytest.approx(-y)


def test_the_numbers_of_a_twin_whose_com_is_outside_its_part_are_not_copied(tmp_path: Path) -> None:
    """The left inertial was copied to the right one, unmirrored, after the sign of z had been lost."""
    x, y, z = numbers(ROBOT, f"{LEFT}/origin")["xyz"].split()
    lost = f"{x} {y} {-float(z)}"
    robot = with_(with_(ROBOT, f"{LEFT}/origin", xyz=lost), f"{RIGHT}/origin", xyz=lost)
    robot = with_(robot, f"{RIGHT}/inertia", **numbers(ROBOT, f"{LEFT}/inertia"))
    finding = one(tmp_path, robot)
    assert finding.message_id == "inertial"
    assert finding.fix is not None
    assert not finding.fix.edits
    assert "repair the COM of left_arm first" in finding.fix.title


@pytest.mark.parametrize("cad_signs", [False, True])
def test_a_tensor_that_contradicts_the_twins_drawing_is_not_copied(tmp_path: Path, cad_signs: bool) -> None:
    """The right inertial is the left one, unmirrored: with the signs of CAD programs, two of its products are correct."""
    flipped_names = ("ixy", "ixz", "iyz") if cad_signs else ()
    robot = with_(ROBOT, f"{LEFT}/inertia", **numbers(ROBOT, f"{LEFT}/inertia", *flipped_names))
    robot = com_copied(inertia_copied(robot))
    (finding,) = find(tmp_path, ET.tostring(robot, encoding="unicode"), "SYM004")
    assert finding.message_id == "inertial"
    assert finding.fix is not None
    assert [edit.expected for edit in finding.fix.edits if " " in edit.expected] == [
        numbers(robot, f"{RIGHT}/origin")["xyz"]
    ]
    assert (len(finding.fix.edits) == 1) is cad_signs
    assert ("inertia tensors of both from the CAD model" in finding.fix.title) is cad_signs
    assert ("ixy" in finding.message) is not cad_signs
    assert ("fits the COM of" in finding.message) is cad_signs


def test_no_side_gets_a_tensor_that_contradicts_the_drawing(tmp_path: Path) -> None:
    """All products of both have the signs of CAD programs, and the moments differ by 20 %."""
    robot = ROBOT
    for path in (LEFT, RIGHT):
        robot = with_(robot, f"{path}/inertia", **numbers(ROBOT, f"{path}/inertia", "ixy", "ixz", "iyz"))
    six = numbers(robot, f"{RIGHT}/inertia")
    robot = with_(robot, f"{RIGHT}/inertia", **{name: repr(1.2 * float(value)) for name, value in six.items()})
    (finding,) = find(tmp_path, ET.tostring(robot, encoding="unicode"), "SYM004")
    assert finding.message_id == "pair"
    assert finding.fix is not None
    assert not finding.fix.edits
    assert finding.fix.title == (
        "take the inertia tensors of both from the CAD model: neither has products of inertia with the signs of its drawing"
    )


@pytest.mark.parametrize("across", [0.002, 0.4])
def test_coms_that_are_outside_both_drawings_are_left_to_another_rule(tmp_path: Path, across: float) -> None:
    far = with_(ROBOT, f"{RIGHT}/origin", xyz=f"0.3 {across} 0.1")
    far = with_(far, f"{LEFT}/origin", xyz=f"0.3 {across} 0.1")
    text = ET.tostring(far, encoding="unicode")
    assert {f.code for f in find(tmp_path, text, {"SYM004", "INR006"})} == {"INR006"}


# -- offsets that take each other back --------------------------------------------------------------------------------


def move_frame(robot: Robot, part: str, offset: float, turn: float = 0.0, *, with_drawing: bool = False) -> Robot:
    """The robot with the frame of a part moved along its joint's axis, and turned about it; nothing else moves, but what the
    part draws if that goes with the frame."""
    joint = robot.find(f"joint[@name='{part}_joint']")
    assert joint is not None
    axis = np.array([float(value) for value in numbers(joint, "axis")["xyz"].split()])
    placement = build_origin_transform((offset * axis).tolist(), (0.0, 0.0, 0.0))
    placement[:3, :3] = rotate_about(axis, turn)
    changed = moved_link(robot, part, placement)
    if with_drawing:
        for one, like in zip(
            *(r.findall(f"link[@name='{part}']/visual/origin") for r in (changed, robot)), strict=True
        ):
            one.attrib.update(like.attrib)
    return changed


def rotate_about(axis: np.ndarray, angle: float) -> np.ndarray:
    """The rotation (3, 3) about a unit vector."""
    cross = np.cross(axis, np.eye(3)).T
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)


@pytest.mark.parametrize("part", [f"right_{part}" for part in PARTS])
@pytest.mark.parametrize(("offset", "turn"), [(0.006, 0.0), (-0.052, 0.0), (0.0, 0.3), (0.0, -0.02), (0.03, 0.7)])
def test_a_frame_at_another_point_of_its_axis_is_a_choice(
    tmp_path: Path, part: str, offset: float, turn: float
) -> None:
    robot = move_frame(ROBOT, part, offset, turn)
    text = ET.tostring(robot, encoding="unicode")
    assert not find(tmp_path, text, {"SYM001", "SYM002", "SYM004", "INR009"})


@pytest.mark.parametrize("part", ["right_shoulder", "right_arm"])
@pytest.mark.parametrize("offset", [0.006, -0.02])
def test_an_offset_along_the_axis_that_the_next_joint_takes_back_moves_nothing(
    tmp_path: Path, part: str, offset: float
) -> None:
    text = ET.tostring(move_frame(ROBOT, part, offset, with_drawing=True), encoding="unicode")
    found = find(tmp_path, text, {"SYM001", "SYM002", "SYM004"})
    assert not {finding.message_id for finding in found} & {"origin", "slip", "axis"}


@pytest.mark.parametrize(("turn", "found"), [(0.0087, False), (0.03, True)])
def test_a_slight_tilt_that_the_next_joint_takes_back_is_typed(tmp_path: Path, turn: float, found: bool) -> None:
    """The axis of the arm, y, is tilted about x; the hand is where it should be, and turned as it should be."""
    placement = build_origin_transform((0.0, 0.0, 0.0), (turn, 0.0, 0.0))
    robot = with_(moved_link(ROBOT, "right_arm", placement), "joint[@name='right_arm_joint']/axis", xyz="0 1 0")
    taken_back = find(tmp_path / "a", ET.tostring(robot, encoding="unicode"), "SYM004")
    assert ("axis" in {finding.message_id for finding in taken_back}) is found
    tilted = with_(ROBOT, "joint[@name='right_arm_joint']/origin", rpy=f"{turn} 0 0")
    alone = find(tmp_path / "b", ET.tostring(tilted, encoding="unicode"), {"SYM001", "SYM004"})
    assert {finding.message_id for finding in alone} & {"turned", "pair_tilt", "tilt", "origin"}


@pytest.mark.parametrize("marked", [False, True])
def test_a_joint_beside_its_place_takes_along_nothing_that_is_in_place(tmp_path: Path, marked: bool) -> None:
    """The axis of an arm is 5 mm off, but the hand is where it should be. A frame that is fixed to the arm moves with it."""
    robot = with_(ROBOT, "joint[@name='right_arm_joint']/origin", xyz="0.025 -0.07 0")
    for side in ("left", "right") if marked else ():
        robot.append(ET.fromstring(f'<link name="{side}_tip"/>'))
        robot.append(
            ET.fromstring(
                f'<joint name="{side}_tip_joint" type="fixed"><parent link="{side}_arm"/><child link="{side}_tip"/>'
                '<origin xyz="0 0 -0.1"/></joint>'
            )
        )
    robot = with_(robot, "joint[@name='right_hand_joint']/origin", xyz="-0.005 -0.01 -0.32")
    finding = one(tmp_path, robot)
    assert finding.message_id == "origin"
    assert finding.fix is not None
    assert 'write xyz="0.02 -0.07 0" in right_arm_joint and move what it carries back by as much' in finding.fix.title


@pytest.mark.parametrize(("place", "found"), [((-0.00416, -0.319973), False), ((-0.00416, -0.32), True)])
def test_a_joint_that_is_turned_about_the_axis_before_it_is_in_place(
    tmp_path: Path, place: tuple[float, float], found: bool
) -> None:
    """The hand is 4.2 mm from the mirror image: turned by 0.013 rad about the arm's axis, or moved across it."""
    robot = with_(ROBOT, "joint[@name='right_hand_joint']/origin", xyz=f"{place[0]} -0.01 {place[1]}")
    findings = find(tmp_path, ET.tostring(robot, encoding="unicode"), "SYM004")
    assert ("origin" in {finding.message_id for finding in findings}) is found


def test_a_part_that_is_rotated_with_its_frame_has_another_zero(tmp_path: Path) -> None:
    """Unlike a frame that is rotated alone."""
    robot = with_(ROBOT, "joint[@name='right_shoulder_joint']/origin", rpy="0.3 0 0")
    found = find(tmp_path, ET.tostring(robot, encoding="unicode"), {"SYM001"})
    assert [finding.message_id for finding in found] == ["pair"]


def test_coms_that_are_both_elsewhere_are_no_models_of_each_other(tmp_path: Path) -> None:
    """Palms with one COM typed for both hands, inside the torso and far from the palms."""
    robot = copy.deepcopy(ROBOT)
    for side, y in (("left", 0.03), ("right", -0.03)):
        robot.append(
            make_box_link(
                f"{side}_palm", [((0.04, 0.03, 0.05), (0.01, y, -0.02)), ((0.02, 0.03, 0.02), (0.03, 1.8 * y, 0.02))]
            )
        )
        robot.append(
            make_motor_joint(f"{side}_palm_joint", "torso", f"{side}_palm", (0, 0.6 * y, 0.1), (1, 0, 0), (0, 0))
        )
        robot[-1].set("type", "fixed")
        robot = with_(robot, f"link[@name='{side}_palm']/inertial/origin", xyz="0.01 0.12 0.2")
    finding = next(f for f in find_mirror_defects(tmp_path, robot) if "palm" in f.message and f.code == "SYM004")
    assert finding.message_id == "both"
    assert finding.fix is not None
    assert "neither is near" in finding.fix.title
