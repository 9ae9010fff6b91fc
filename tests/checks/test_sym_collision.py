"""SYM007: collision primitives of equal parts, and what is another part."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import box, collision, cylinder, find, inertial, joint, limit, link, mesh, robot, sphere, visual

from urdfcheck.core import Confidence, Finding, Severity

# Three distinct moments and a COM on no plane show how the frame lies.
TENSOR = {"ixx": 0.02, "iyy": 0.03, "izz": 0.012}
NAMES = ("FL_thigh", "FR_thigh", "RL_thigh", "RR_thigh")
THIGH = collision(box("0.25 0.028 0.04"), xyz="-0.03 0.01 -0.2", rpy="0 1.57 0")


def make_part(name: str, *shapes: str, mass: float = 2.4, side: float = 0.02) -> str:
    """Return a thigh with its hip; ``side`` is the y of its COM."""
    part = link(name, inertial(mass, com=f"0.01 {side} -0.03", **TENSOR), *shapes)
    return part + joint(f"{name}_joint", "trunk", name, limit(-1, 1), kind="revolute", axis="0 1 0")


def find_odd(folder: Path, *parts: str, **more: object) -> list[Finding]:
    return find(folder, robot(link("trunk"), *parts), "SYM007", **more)


def make_limbs(*odd: str, names: tuple[str, ...] = NAMES, like: str = THIGH) -> list[str]:
    """Return limbs, of which the first has the shapes ``odd``."""
    return [make_part(name, *(odd if i == 0 else (like,)), side=0.02 * (-1) ** i) for i, name in enumerate(names)]


def test_the_odd_thigh_of_four_is_named_with_its_size_and_that_of_the_others(tmp_path: Path) -> None:
    own = collision(box("0.32 0.0445 0.054"), xyz="-0.025 0 -0.16", rpy="0 1.57 0")
    (finding,) = find_odd(tmp_path, *make_limbs(own))
    assert (finding.message_id, finding.severity, finding.confidence) == ("size", Severity.WARNING, Confidence.STRONG)
    assert finding.subjects == ("link[FL_thigh]/collision/geometry/box",)
    assert "a box of 0.32 × 0.0445 × 0.054 m" in finding.message
    assert "a box of 0.25 × 0.028 × 0.04 m" in finding.message
    assert "FR_thigh, RL_thigh, RR_thigh collide" in finding.message
    assert finding.headline == "FL_thigh: collision is 0.32 × 0.0445 × 0.054 m, unlike 3 equal parts"


@pytest.mark.parametrize(("drawn", "message"), [("0.33 0.05 0.06", "outvoted"), ("0.26 0.03 0.04", "size")])
def test_the_drawing_may_contradict_the_majority(tmp_path: Path, drawn: str, message: str) -> None:
    shapes = [collision(box("0.32 0.0445 0.054")), *(collision(box("0.25 0.028 0.04")) for _ in range(3))]
    parts = [make_part(name, visual(box(drawn)), shape) for name, shape in zip(NAMES, shapes, strict=True)]
    (finding,) = find_odd(tmp_path, *parts)
    assert finding.message_id == message
    assert ("so the others may be the wrong ones" in finding.message) == (message == "outvoted")


@pytest.mark.parametrize("place", range(4))
def test_each_of_four_can_be_the_odd_one(tmp_path: Path, place: int) -> None:
    parts = [make_part(n, collision(sphere(0.05 if i != place else 0.06))) for i, n in enumerate(NAMES)]
    (finding,) = find_odd(tmp_path, *parts)
    assert finding.data["link"] == NAMES[place]


@pytest.mark.parametrize(
    ("own", "message"),
    [
        (THIGH, None),
        (collision(box("0.251 0.028 0.04"), xyz="-0.03 0.01 -0.2", rpy="0 1.57 0"), None),  # within 2 %
        (collision(box("0.25 0.028 0.04"), xyz="-0.03 -0.01 -0.2", rpy="0 1.57 0"), None),  # the mirror image
        (collision(box("0.04 0.028 0.25"), xyz="-0.03 0.01 -0.2"), None),  # the same box with other axes
        (collision(box("0.25 0.028 0.04"), xyz="-0.03 0.01 -0.2"), "place"),  # not turned
        (collision(box("0.25 0.028 0.04"), xyz="-0.03 0.01 -0.25", rpy="0 1.57 0"), "place"),
        (collision(cylinder(0.02, 0.25), xyz="-0.03 0.01 -0.2"), "size"),
        (THIGH + collision(sphere(0.02)), "size"),
        (collision(mesh("thigh.stl")), None),
        ("", None),
    ],
)
def test_what_is_another_shape(tmp_path: Path, own: str, message: str | None) -> None:
    assert [f.message_id for f in find_odd(tmp_path, *make_limbs(own))] == ([message] if message else [])


def test_a_frame_that_is_rotated_is_no_other_place(tmp_path: Path) -> None:
    own = link(
        "FL_thigh",
        inertial(2.4, com="-0.03 0.02 0.01", ixx=0.012, iyy=0.03, izz=0.02),
        collision(box("0.25 0.028 0.04"), xyz="-0.2 0.01 -0.03"),
    )
    hip = joint("FL_thigh_joint", "trunk", "FL_thigh", limit(-1, 1), kind="revolute", axis="0 1 0")
    assert not find_odd(tmp_path, own + hip, *make_limbs(THIGH)[1:])


@pytest.mark.parametrize(
    "other",
    [
        make_part("FL_thigh", collision(sphere(0.1)), mass=2.5),
        make_part("FL_calf", collision(sphere(0.1))),
        make_part("FL_thigh", visual(sphere(0.1)), collision(sphere(0.1))),
        make_part("FL_thigh", visual(mesh("thigh_8in.stl")), collision(sphere(0.1))),
        make_part("FL_thigh", collision(sphere(0.1))).replace("revolute", "prismatic"),
    ],
)
def test_another_part_may_have_another_shape(tmp_path: Path, other: str) -> None:
    assert not find_odd(tmp_path, other, *make_limbs(THIGH)[1:])


@pytest.mark.parametrize(
    ("name", "file", "count"),
    [
        ("counter_middle", "counter_middle.dae", 0),
        ("counter_middle", "counter_left.dae", 1),  # the same mesh
        ("counter_middle_left", "counter_middle.dae", 1),
    ],
)
@pytest.mark.parametrize("sides", [("left", "right"), ("left",)])
def test_what_is_between_two_sides_may_be_another_part(
    tmp_path: Path, name: str, file: str, count: int, sides: tuple[str, ...]
) -> None:
    parts = [make_part(f"counter_{s}", visual(mesh(f"counter_{s}.dae")), collision(box("1 1 1"))) for s in sides]
    odd = make_part(name, visual(mesh(file)), collision(box("1 3 1")))
    assert len(find_odd(tmp_path, odd, *parts)) == count


def test_two_against_two_show_nothing(tmp_path: Path) -> None:
    own, other = collision(sphere(0.1)), collision(sphere(0.2))
    parts = [make_part(name, own if i < 2 else other) for i, name in enumerate(NAMES)]
    assert not find_odd(tmp_path, *parts)


@pytest.mark.parametrize(("names", "count"), [(("left_hip", "right_hip"), 1), (("hip_1", "hip_2"), 0)])
def test_two_sides_are_an_info(tmp_path: Path, names: tuple[str, ...], count: int) -> None:
    found = find_odd(tmp_path, *make_limbs(collision(sphere(0.1)), names=names))
    assert [(f.message_id, f.severity, f.confidence) for f in found] == [
        ("pair", Severity.INFO, Confidence.HEURISTIC)
    ] * count
    assert not find_odd(tmp_path / "alike", *make_limbs(THIGH, names=names))
