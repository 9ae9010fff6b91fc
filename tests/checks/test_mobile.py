"""Small mobile robots: two wheels and what else carries them, as the pages' examples do not show."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import box, collision, cylinder, find, inertial, joint, link, robot, sphere, visual

from urdfcheck.core import Severity

RULES = {"SYM008", "DYN006", "GEO003"}
TURN = "1.5707963267948966 0 0"
# The links of both wheels: by side, by number, and without a word that says wheel.
NAMES = ("left_wheel", "right_wheel"), ("wheel_1", "wheel_2"), ("rad_a", "rad_b")


def cart(
    *,
    left: str = "0 0.15 0.05",
    left_rpy: str = "",
    casters: tuple[str, ...] = ("0.12 0 0.01", "-0.12 0 0.01"),
    collides: float = 0.05,
    body: str = "0 0 0.1",
    names: tuple[str, str] = ("left_wheel", "right_wheel"),
    axis: str = "0 1 0",
) -> str:
    """Return a robot on two wheels with a radius of 50 mm and balls with one of 10 mm."""
    shape = cylinder(0.05, 0.02), cylinder(collides, 0.02)
    wheel = visual(shape[0], rpy=TURN) + collision(shape[1], rpy=TURN)
    one, other = names
    return robot(
        link("base_link", inertial(3, 0.03, com="0 0 0.1"), collision(box("0.3 0.2 0.08"), xyz=body)),
        link(one, wheel),
        link(other, wheel),
        joint(f"{one}_joint", "base_link", one, kind="continuous", xyz=left, rpy=left_rpy, axis=axis),
        joint(f"{other}_joint", "base_link", other, kind="continuous", xyz="0 -0.15 0.05", axis=axis),
        *(link(f"caster_{i}", collision(sphere(0.01))) for i in range(len(casters))),
        *(joint(f"caster_{i}_joint", "base_link", f"caster_{i}", xyz=xyz) for i, xyz in enumerate(casters)),
    )


@pytest.mark.parametrize("names", NAMES)
def test_a_sound_cart_gives_nothing(tmp_path: Path, names: tuple[str, str]) -> None:
    assert not find(tmp_path, cart(names=names), RULES)


@pytest.mark.parametrize("names", NAMES)
@pytest.mark.parametrize(
    ("left", "rpy", "words"),
    [
        ("0 0.15 0.06", "", "the axle of {} is 10 mm higher"),
        ("-0.02 0.15 0.05", "", "{} is 20 mm behind"),
        ("0 0.17 0.05", "", "{} is 20 mm farther out"),
        ("0 0.15 0.05", "0.09 0 0", "one axis is 5.16° off the mirror image of the other"),
    ],
)
def test_one_wheel_of_a_pair_is_off(tmp_path: Path, left: str, rpy: str, words: str, names: tuple[str, str]) -> None:
    (finding,) = find(tmp_path, cart(left=left, left_rpy=rpy, names=names), RULES)
    assert finding.code == "SYM008"
    assert words.format(names[0]) in finding.message


def test_a_wheel_that_is_named_one_may_be_far_off_level(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, cart(left_rpy="0.2 0 0"), RULES)
    assert "one axis is 11.5° off" in finding.message
    assert not find(tmp_path, cart(left_rpy="0.2 0 0", names=("rad_a", "rad_b")), "SYM008")


def test_the_note_that_two_like_joints_differ_does_not_hide_the_warning(tmp_path: Path) -> None:
    found = find(tmp_path, cart(left_rpy="0.09 0 0", names=("rad_a", "rad_b")), {"SYM001", "SYM008"})
    assert [(finding.code, finding.severity) for finding in found] == [("SYM008", Severity.WARNING)]


def test_parallel_axes_do_not_differ_however_they_are_tilted(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, cart(axis="0.014195 -0.99982 -0.012697"), "SYM008")
    assert (finding.message_id, finding.severity) == ("tilted", Severity.INFO)
    assert "are parallel, and 1.09° off the root's y" in finding.message


def test_wheels_of_two_roles_are_not_compared(tmp_path: Path) -> None:
    assert not find(tmp_path, cart(left="-0.02 0.15 0.05", names=("drive_wheel", "idle_wheel")), "SYM008")


def test_wheels_that_differ_in_two_ways_are_no_pair_without_names(tmp_path: Path) -> None:
    place = "-0.02 0.15 0.06"
    assert not find(tmp_path, cart(left=place, names=("wheel_1", "wheel_2")), "SYM008")
    (finding,) = find(tmp_path, cart(left=place), "SYM008")
    assert "10 mm higher" in finding.message
    assert "20 mm behind" in finding.message


@pytest.mark.parametrize("names", NAMES)
@pytest.mark.parametrize(
    ("casters", "message", "words"),
    [
        (("0.12 0 0.005", "-0.12 0 0.005"), "unloaded", "caster_0, caster_1 end 5 mm below"),
        (("0.12 0 0.03", "-0.12 0 0.03"), "leans", "caster_0, caster_1 end 20 mm above"),
    ],
)
def test_casters_do_not_end_at_the_height_of_the_wheels(
    tmp_path: Path, casters: tuple[str, ...], message: str, words: str, names: tuple[str, str]
) -> None:
    (finding,) = find(tmp_path, cart(casters=casters, names=names), RULES)
    assert (finding.code, finding.message_id) == ("DYN006", message)
    assert words in finding.message
    assert finding.location.subject.startswith("joint[caster_0_joint]")


def test_the_caster_on_which_a_robot_leans_is_named(tmp_path: Path) -> None:
    (finding,) = find(
        tmp_path, cart(casters=("0.12 0 0.025", "-0.12 0 0.03")).replace('xyz="0 0 0.1"', 'xyz="-0.02 0 0.1"'), RULES
    )
    assert "caster_1 ends 20 mm above" in finding.message


def test_casters_at_two_heights_have_two_distances(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, cart(casters=("0.12 0 0.002", "-0.12 0 0.005")), RULES)
    assert "caster_0 (8 mm), caster_1 (5 mm) end below the lowest points" in finding.message
    assert finding.fix is not None
    assert finding.fix.title == "move each up by its distance: caster_0 (8 mm), caster_1 (5 mm)"


def test_a_robot_whose_weight_is_about_above_the_axle_leans_until_its_caster_touches(tmp_path: Path) -> None:
    """The wheels are round: no edge of what stands for them holds the robot on the way."""
    text = cart(casters=("0.12 0 0.03",), body="0 0 0.2").replace('xyz="0 0 0.1"', 'xyz="0.002 0 0.1"')
    (finding,) = find(tmp_path, text, "DYN006")
    # The ball is 20 mm too high, 0.12 m ahead, and the wheels roll on: 0.12 sin a + 0.02 cos a + 0.01 = 0.05 (1 - cos a) + ...
    assert finding.data["tilt"] == pytest.approx(9.53, abs=0.3)


def test_casters_with_a_little_play_are_sound(tmp_path: Path) -> None:
    assert not find(tmp_path, cart(casters=("0.12 0 0.011", "-0.12 0 0.011")), RULES)


def test_the_body_is_lower_than_the_wheels(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, cart(body="0 0 0.035"), "DYN006")
    assert finding.message_id == "touches"
    assert "5 mm below" in finding.message


def test_wheels_that_nothing_drives_carry_like_casters(tmp_path: Path) -> None:
    small = visual(cylinder(0.03, 0.02), rpy=TURN) + collision(cylinder(0.03, 0.02), rpy=TURN)
    places = {"front_swivel_wheel": "0.2 0 0.025", "rear_swivel_wheel": "-0.2 0 0.025"}
    wheels = [link(name, small) for name in places]
    joints = [
        joint(f"{name}_joint", "base_link", name, kind="continuous", xyz=xyz, axis="0 1 0")
        for name, xyz in places.items()
    ]
    text = cart(casters=()).replace("</robot>", "".join((*wheels, *joints)) + "</robot>")
    (finding,) = find(tmp_path, text, "DYN006")
    assert "the robot stands on front_swivel_wheel, rear_swivel_wheel" in finding.message
    assert finding.fix is not None
    assert "up by 5 mm" in finding.fix.title


def test_a_hub_with_a_larger_wheel_fixed_to_it_is_not_what_carries(tmp_path: Path) -> None:
    text = cart(left="0 0.15 0.07").replace("0 -0.15 0.05", "0 -0.15 0.07")
    for side in ("left", "right"):
        tyre = link(f"{side}_tyre", collision(cylinder(0.07, 0.02), rpy=TURN))
        text = text.replace("</robot>", tyre + joint(f"{side}_tyre", f"{side}_wheel", f"{side}_tyre") + "</robot>")
    assert not find(tmp_path, text, "DYN006")


@pytest.mark.parametrize(("body", "found"), [("0 0 0.045", ["leans"]), ("0 0 0.035", ["leans", "touches"])])
def test_a_body_that_only_touches_because_short_casters_lean_the_robot(
    tmp_path: Path, body: str, found: list[str]
) -> None:
    text = cart(casters=("0.12 0 0.03", "-0.12 0 0.03"), body=body)
    assert sorted(finding.message_id for finding in find(tmp_path, text, "DYN006")) == found


@pytest.mark.parametrize(
    ("drawn", "words", "repair"),
    [
        (
            "0 0 0.1",
            "the collision is 0.065 m off the visual of the same shape, which clears the ground",
            "copy the <origin>",
        ),
        (
            "0 0 0.038",
            "the collision is 0.003 m off the visual of the same shape, which reaches 2 mm below",
            "copy the <origin>",
        ),
        ("0 0 0.036", "the robot rests on it", "raise or shorten the collision of base_link"),
    ],
)
def test_a_body_that_collides_lower_than_it_is_drawn_needs_the_place_where_it_is_drawn(
    tmp_path: Path, drawn: str, words: str, repair: str
) -> None:
    shape = box("0.3 0.2 0.08")
    text = cart(body="0 0 0.035").replace("<collision>", visual(shape, xyz=drawn) + "<collision>", 1)
    (finding,) = find(tmp_path, text, "DYN006")
    assert finding.message.endswith(words)
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


@pytest.mark.parametrize(("radius", "count"), [(0.05, 0), (0.046, 0), (0.06, 2), (0.15, 2)])
def test_wheels_collide_with_the_drawn_radius(tmp_path: Path, radius: float, count: int) -> None:
    found = find(tmp_path, cart(collides=radius, body="0 0 0.3"), "GEO003")
    assert [finding.message_id for finding in found] == count * ["wheel"]
