"""JNT018: which parts are in the air, which slip is named, and when nothing is said."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest
from builders import box, find, joint, limit, link, robot, visual
from transforms import each_link, rerooted, rotated_link, scaled

from urdfcheck.core import Finding, Severity

PLACES = {
    "front_left": "0.2 0.18 0",
    "front_right": "0.2 -0.18 0.01",
    "rear": "-0.2 0.18 0",
    "lift": "0 0 0.1",
    "pan": "0 0 0.07",
}
PARTS = {
    "body": "0.6 0.3 0.1",
    "front_left": "0.1 0.06 0.1",
    "front_right": "0.1 0.06 0.1",
    "rear": "0.1 0.06 0.1",
    "lift": "0.04 0.04 0.1",
    "pan": "0.1 0.1 0.04",
}


def make_rover(
    *extra: str,
    kind: str = "continuous",
    undrawn: Sequence[str] = (),
    places: Mapping[str, str] | None = None,
    **xyz: str,
) -> str:
    placed = {**PLACES, **(places or {}), **xyz}
    links = [link(name, "" if name in undrawn else visual(box(size))) for name, size in PARTS.items()]
    joints = []
    for name, place in placed.items():
        limits = limit(0, 0.4) if kind == "prismatic" and name == "lift" else ""
        moves = kind if name == "lift" else "continuous"
        axis = "" if moves == "fixed" else "0 0 -1" if name in {"lift", "pan"} else "0 1 0"
        parent = "lift" if name == "pan" else "body"
        joints.append(joint(f"{name}_joint", parent, name, limits, kind=moves, xyz=place, axis=axis))
    text: str = robot(*links, *joints, *extra)
    return text


def parse(text: str) -> ET.Element:
    """Return the robot with an origin and its numbers everywhere, as `transforms` wants it."""
    element = ET.fromstring(text)
    for place in (*element.iter("visual"), *element.iter("joint")):
        origin = place.find("origin")
        origin = ET.SubElement(place, "origin") if origin is None else origin
        for name in ("xyz", "rpy"):
            origin.attrib.setdefault(name, "0 0 0")
    return element


def find_loose(tmp_path: Path, text: str) -> list[Finding]:
    return [finding for finding in find(tmp_path, text, "JNT018") if finding.message_id == "loose"]


@pytest.mark.parametrize(
    ("name", "typed", "says"),
    [
        ("rear", "-0.2 1.8 0", "the decimal point of y is one place further left: -0.2 0.18 0."),
        ("front_left", "2 0.18 0", "the decimal point of x is one place further left: 0.2 0.18 0."),
    ],
)
def test_the_only_slip_that_closes_the_space_is_named(tmp_path: Path, name: str, typed: str, says: str) -> None:
    (finding,) = find_loose(tmp_path, make_rover(places={name: typed}))
    assert finding.location.subject == f"joint[{name}_joint]/origin@xyz"
    assert finding.fix is None or not finding.fix.edits
    assert finding.cause is not None
    assert finding.cause.text == f"The parts touch if {says}"


def test_a_wrong_sign_is_named(tmp_path: Path) -> None:
    high = {"front_left": "0.2 0.18 0.5", "front_right": "0.2 -0.18 0.5", "rear": "-0.2 0.18 0.5"}
    body = visual(box(PARTS["body"]))

    def make_high(lift: str) -> str:
        return make_rover(lift=lift, places=high).replace(body, visual(box(PARTS["body"]), xyz="0 0 0.5"))

    assert not find_loose(tmp_path, make_high("0 0 0.6"))
    (tmp_path / "wrong").mkdir()
    (finding,) = find_loose(tmp_path / "wrong", make_high("0 0 -0.6"))
    assert finding.cause is not None
    assert finding.cause.text == "The parts touch if z has the other sign: 0 0 0.6."


def test_no_slip_is_named_that_puts_the_part_deep_into_another(tmp_path: Path) -> None:
    (finding,) = find_loose(tmp_path, make_rover(rear="-0.1 0.3 0"))
    assert finding.cause is None


def test_no_slip_is_named_where_two_close_the_space(tmp_path: Path) -> None:
    (finding,) = find_loose(tmp_path, make_rover(front_right="0.2 -0.18 2.5"))
    assert finding.cause is None


def test_a_space_that_nothing_explains_has_to_be_large(tmp_path: Path) -> None:
    (finding,) = find_loose(tmp_path, make_rover(rear="-0.9 0.9 0.7"))
    assert finding.cause is None
    assert finding.data["others"] == 4
    assert not find_loose(tmp_path, make_rover(rear="-0.22 0.21 0"))


def test_a_fixed_part_may_be_anywhere(tmp_path: Path) -> None:
    assert not find_loose(tmp_path, make_rover(kind="fixed", lift="0 0 1", undrawn=("pan",)))


def test_a_part_that_touches_at_another_position_is_fine(tmp_path: Path) -> None:
    assert find_loose(tmp_path, make_rover(lift="0 0 0.8"))
    assert not find_loose(tmp_path, make_rover(kind="prismatic", lift="0 0 0.4"))


def test_robots_that_draw_their_parts_apart_are_fine(tmp_path: Path) -> None:
    assert not find_loose(tmp_path, make_rover(rear="-0.2 1.8 0", front_left="0.2 1.8 0"))
    loose = make_rover(rear="-0.2 1.8 0")
    assert find_loose(tmp_path, loose)
    (tmp_path / "few").mkdir()
    assert not find_loose(tmp_path / "few", make_rover(rear="-0.2 1.8 0", undrawn=("pan",)))


def test_an_unreadable_mesh_may_be_what_it_touches(tmp_path: Path) -> None:
    mesh = joint("mesh_joint", "body", "frame") + link("frame", visual('<mesh filename="frame.stl"/>'))
    assert not find_loose(tmp_path, make_rover(mesh, rear="-0.2 1.8 0"))


@pytest.mark.parametrize("seed", range(3))
def test_sound_robots_are_fine_however_they_are_written(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    rotation, upper = np.linalg.qr(rng.normal(size=(3, 3)))
    rotation = rotation @ np.diag(np.sign(np.diag(upper)))
    rotation *= np.sign(np.linalg.det(rotation))
    sound = parse(make_rover())
    written = [
        rerooted(sound, "pan"),
        rerooted(sound, "rear"),
        scaled(sound, float(10 ** rng.uniform(-1.5, 1.5)), 1.0),
        each_link(rotated_link, rotation)(sound),
        rotated_link(rerooted(sound, "lift"), "lift", rotation),
    ]
    for index, text in enumerate(ET.tostring(one, encoding="unicode") for one in written):
        (tmp_path / str(index)).mkdir()
        assert not find_loose(tmp_path / str(index), text)


@pytest.mark.parametrize("length", [0.1, 1.0, 5.0])
def test_the_size_of_the_robot_does_not_matter(tmp_path: Path, length: float) -> None:
    text = ET.tostring(scaled(parse(make_rover(rear="-0.2 1.8 0")), length, 1.0), encoding="unicode")
    (finding,) = find(tmp_path, text, "JNT018")
    assert finding.location.subject == "joint[rear_joint]/origin@xyz"


@pytest.mark.parametrize(
    ("launch", "severity"), [("rviz2", Severity.INFO), ("ros_gz_sim", Severity.WARNING), (None, Severity.WARNING)]
)
def test_a_loose_part_of_what_is_only_drawn_is_worth_knowing(
    tmp_path: Path, launch: str | None, severity: Severity
) -> None:
    if launch is not None:
        (tmp_path / "package.xml").write_text('<package format="3"><name>rover</name></package>')
        (tmp_path / "show.launch.py").write_text(f"run('{launch}', 'robot.urdf')")
    (finding,) = find_loose(tmp_path, make_rover(places={"front_left": "0.2 1.8 0"}))
    assert finding.severity == severity
    assert (set(finding.consequences) == {"rviz"}) == (severity == Severity.INFO)
