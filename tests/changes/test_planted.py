"""A planted change is reported alone, with its size and the line that caused it; the way back is reported the other way round."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from builders import joint, link, robot
from versions import ARM, compare_texts

from urdfcheck.changes.effect_wording import describe_effect
from urdfcheck.core.model_diff import Diff, MechanismDiff, ModelDiff
from urdfcheck.output.changes.text import describe_torque
from urdfcheck.output.changes.text import render as render_text


@dataclass(frozen=True, kw_only=True)
class Planted:
    """A change: the text that it replaces, and what must be reported."""

    old: str
    new: str
    ids: tuple[str, ...]
    verdict: str
    subject: str
    numbers: Mapping[str, float] = field(default_factory=dict)
    headline: str = ""
    """What the verdict line contains."""
    text: str = ""
    """What the line about the first change contains."""
    backwards: Mapping[str, float] = field(default_factory=dict)
    """The numbers of the change back, where they are not those of a change of the same size."""
    line: str = ""
    """The edited line of the first version; by default the first line of `old`."""


WRIST = '<origin xyz="0.3 0 0" rpy="0 0 0"/>'
CHANGES: Mapping[str, Planted] = {
    "a joint moved": Planted(
        old=WRIST,
        new='<origin xyz="0.341 0 0" rpy="0 0 0"/>',
        ids=("joint-moved",),
        verdict="kinematic",
        subject="joint[wrist]",
        numbers={"distance": 0.041, "shift_x": 0.041, "angle": 0.0},
        backwards={"shift_x": -0.041},
        headline="tool0 moves by 41 mm in every configuration",
        text="joint wrist moves by 41 mm (x +41 mm) in link fore",
    ),
    "a joint turned off its axis": Planted(
        old='<origin xyz="0 0 0.1" rpy="0 0 0"/>',
        new='<origin xyz="0 0 0.1" rpy="0 0.1 0"/>',
        ids=("joint-moved",),
        verdict="kinematic",
        subject="joint[pan]",
        numbers={"angle": 0.1, "distance": 0.0, "axis_y": 1.0},
        backwards={"axis_y": -1.0},
        text="joint pan rotates by 5.73° about y in link base",
    ),
    "a zero shifted": Planted(
        old='<origin xyz="0 0 0.1" rpy="0 0 0"/>',
        new='<origin xyz="0 0 0.1" rpy="0 0 0.05"/>',
        ids=("zero-offset",),
        verdict="kinematic",
        subject="joint[pan]",
        numbers={"offset": 0.05},
        backwards={"offset": -0.05},
        text="joint pan has its zero shifted by 2.86°",
    ),
    "a fixed frame moved": Planted(
        old='<origin xyz="0.1 0 0" rpy="0 0 0"/>',
        new='<origin xyz="0.1 0 0.02" rpy="0 0 0"/>',
        ids=("joint-moved",),
        verdict="kinematic",
        subject="joint[tool]",
        numbers={"distance": 0.02, "shift_z": 0.02},
        backwards={"shift_z": -0.02},
        headline="tool0 moves by 20 mm in every configuration",
    ),
    "an axis reversed": Planted(
        old='<axis xyz="1 0 0"/>',
        new='<axis xyz="-1 0 0"/>',
        ids=("axis-reversed",),
        verdict="kinematic",
        subject="joint[wrist]",
        text="joint wrist axis is reversed",
    ),
    "an axis tilted": Planted(
        old='<axis xyz="1 0 0"/>',
        new='<axis xyz="1 0.1 0"/>',
        ids=("axis-tilted",),
        verdict="kinematic",
        subject="joint[wrist]",
        numbers={"angle": math.atan(0.1)},
    ),
    "a type": Planted(
        old='name="wrist" type="continuous"',
        new='name="wrist" type="fixed"',
        ids=("type",),
        verdict="kinematic",
        subject="joint[wrist]",
        text="joint wrist type continuous → fixed",
    ),
    "a limit": Planted(
        old='<limit lower="-1.8" upper="1.8"',
        new='<limit lower="-1.8" upper="2.1"',
        ids=("upper",),
        verdict="limits",
        subject="joint[elbow]",
        numbers={"before": 1.8, "after": 2.1},
        backwards={"before": 2.1, "after": 1.8},
        headline="kinematically identical; joint elbow upper limit 1.8 → 2.1 rad",
    ),
    "an effort": Planted(
        old='effort="40"',
        new='effort="35"',
        ids=("effort",),
        verdict="limits",
        subject="joint[elbow]",
        numbers={"before": 40.0, "after": 35.0},
        backwards={"before": 35.0, "after": 40.0},
        text="effort limit 40 → 35 N·m (-12 %)",
    ),
    "damping": Planted(
        old='damping="0.5"',
        new='damping="0.7"',
        ids=("damping",),
        verdict="dynamic",
        subject="joint[elbow]",
        numbers={"before": 0.5, "after": 0.7},
        backwards={"before": 0.7, "after": 0.5},
    ),
    "a mimic": Planted(
        old='multiplier="-1"',
        new='multiplier="-0.5"',
        ids=("mimic",),
        verdict="kinematic",
        subject="joint[grip_mirror]",
        text="joint grip_mirror follows -0.5 × grip instead of -1 × grip",
    ),
    "a mass": Planted(
        old='<mass value="0.6"/>',
        new='<mass value="0.9"/>',
        ids=("mass",),
        verdict="dynamic",
        subject="link[hand]",
        numbers={"before": 0.6, "after": 0.9},
        backwards={"before": 0.9, "after": 0.6},
        headline="kinematically identical; dynamics change by",
        text="link hand mass 0.6 → 0.9 kg (+50 %)",
    ),
    "a COM": Planted(
        old='<origin xyz="0.03 0 0" rpy="0 0 0"/>',
        new='<origin xyz="0.03 0 0.01" rpy="0 0 0"/>',
        ids=("com",),
        verdict="dynamic",
        subject="link[hand]",
        numbers={"distance": 0.01, "shift_z": 0.01},
        backwards={"shift_z": -0.01},
    ),
    "a tensor": Planted(
        old='ixx="0.0006"',
        new='ixx="0.0005"',
        ids=("tensor",),
        verdict="dynamic",
        subject="link[hand]",
        numbers={"before_1": 0.0006, "after_1": 0.0005},
        backwards={"before_1": 0.0005, "after_1": 0.0006},
    ),
    "a turned inertial frame": Planted(
        old='<origin xyz="0.03 0 0" rpy="0 0 0"/>',
        new='<origin xyz="0.03 0 0" rpy="0 0 0.5"/>',
        ids=("tensor",),
        verdict="dynamic",
        subject="link[hand]",
        text="link hand inertia tensor is rotated; its principal moments are the same",
    ),
    "a collision resized": Planted(
        old='<collision>\n      <origin xyz="0 0 0" rpy="0 0 0"/>\n      <geometry><box size="0.06 0.1 0.04"/></geometry>',
        new='<collision>\n      <origin xyz="0 0 0" rpy="0 0 0"/>\n      <geometry><box size="0.06 0.2 0.04"/></geometry>',
        ids=("shape-resized",),
        verdict="collision",
        subject="link[hand]",
        numbers={"volume_before": 0.00024, "volume_after": 0.00048},
        backwards={"volume_before": 0.00048, "volume_after": 0.00024},
        headline="kinematically and dynamically identical; link hand collision has another size",
        line='<geometry><box size="0.06 0.1 0.04"/></geometry>',
    ),
    "a visual moved": Planted(
        old='<visual>\n      <origin xyz="0.15 0 0" rpy="0 0 0"/>',
        new='<visual>\n      <origin xyz="0.15 0.01 0" rpy="0 0 0"/>',
        ids=("shape-moved",),
        verdict="visual",
        subject="link[fore]",
        numbers={"distance": 0.01, "angle": 0.0},
        line='<origin xyz="0.15 0 0" rpy="0 0 0"/>',
    ),
    "a name of the robot": Planted(
        old='<robot name="arm">',
        new='<robot name="arm_2">',
        ids=("robot-renamed",),
        verdict="extension",
        subject="robot",
        text="robot name arm → arm_2",
    ),
    "a plugin": Planted(
        old="<mu1>0.8</mu1>",
        new="<mu1>0.9</mu1>",
        ids=("extra-changed",),
        verdict="extension",
        subject="gazebo[hand]",
        headline="links, joints and shapes are identical; gazebo[hand] changes",
    ),
}


def get_mechanism(found: ModelDiff) -> MechanismDiff:
    assert found.mechanism is not None
    return found.mechanism


def check_change(found: ModelDiff, planted: Planted, numbers: Mapping[str, float], line: str) -> None:
    """Check that this change is reported alone, with its numbers, at its line."""
    changes = get_mechanism(found).changes
    assert tuple(change.id for change in changes) == planted.ids
    assert found.verdict == planted.verdict
    assert changes[0].subject == planted.subject
    for name, value in numbers.items():
        assert changes[0].numbers[name] == pytest.approx(value, rel=1e-6, abs=1e-9), name
    (cause,) = get_mechanism(found).causes
    assert cause.is_edited
    assert cause.changes == (0,)
    assert line in [text for _, _, text in cause.before]
    assert get_mechanism(found).notes == ()


@pytest.mark.parametrize("planted", CHANGES.values(), ids=CHANGES)
def test_a_planted_change_is_reported_alone(tmp_path: Path, planted: Planted) -> None:
    assert ARM.count(planted.old) >= 1
    changed = ARM.replace(planted.old, planted.new, 1)
    if planted.old == '<origin xyz="0.03 0 0" rpy="0 0 0"/>':
        assert ARM.count(planted.old) == 1
    there, back = compare_texts(tmp_path / "a", ARM, changed), compare_texts(tmp_path / "b", changed, ARM)
    old_line = planted.line or _find_line(ARM, planted.old)
    check_change(there, planted, planted.numbers, old_line)
    check_change(back, planted, {**planted.numbers, **planted.backwards}, _find_new_line(changed, old_line))
    assert planted.headline in there.headline
    assert planted.text in there.texts[0]
    shifts = get_mechanism(there).shifts, get_mechanism(back).shifts
    assert bool(shifts[0]) == (planted.verdict == "kinematic")
    assert [s.distance for s in shifts[0]] == pytest.approx([s.distance for s in shifts[1]], abs=1e-9)


def _find_line(text: str, part: str) -> str:
    return next(line.strip() for line in text.splitlines() if part.splitlines()[0] in line)


def _find_new_line(changed: str, old_line: str) -> str:
    """Return the line of the changed text at the place of a line of the arm that is no longer there."""
    pairs = zip(ARM.splitlines(), changed.splitlines(), strict=True)
    return next(new.strip() for old, new in pairs if old.strip() == old_line and new != old)


@pytest.mark.parametrize(
    ("old", "new", "label", "line"),
    [
        (
            '<limit effort="10" velocity="3"/>',
            '<limit effort="10" velocity="3" acceleration="5"/>',
            "joint[wrist]/limit@acceleration",
            '<axis xyz="1 0 0"/><limit effort="10" velocity="3" acceleration="5"/>',
        ),
        ("<collision>", '<collision name="bumper">', "collision[bumper]", '<collision name="bumper">'),
        ("<geometry>", "<contact/><geometry>", "link[base]/visual/contact", None),
        ("</robot>", "<gazebo><static/></gazebo></robot>", "gazebo", "<gazebo><static/></gazebo></robot>"),
        ('<link name="tool0"/>', '<link name="tool0"><sensor/></link>', "link[tool0]/sensor", None),
    ],
)
def test_what_is_not_physics_is_no_less_a_change(
    tmp_path: Path, old: str, new: str, label: str, line: str | None
) -> None:
    changed = ARM.replace(old, new, 1)
    for before, after, what in ((ARM, changed, "extra-added"), (changed, ARM, "extra-removed")):
        found = compare_texts(tmp_path, before, after)
        assert found.verdict == "extension"
        assert [(c.id, c.subject) for c in get_mechanism(found).changes] == [(what, label)]
        (cause,) = get_mechanism(found).causes
        shown = [text for _, _, text in (*cause.before, *cause.after)]
        assert shown == ([line] if line else shown)
        assert len(shown) == 1


def test_the_worst_configuration_is_named(tmp_path: Path) -> None:
    """A joint that is tilted moves the tool by more the farther it reaches."""
    found = compare_texts(tmp_path, ARM, ARM.replace('<axis xyz="0 1 0"/>', '<axis xyz="0 1 0.05"/>', 1))
    worst = get_mechanism(found).shifts[0]
    assert worst.link in {"left", "right", "tool0"}
    assert set(worst.configuration) >= {"pan", "elbow", "wrist"}
    assert abs(worst.configuration["elbow"]) > 1.0
    assert found.headline.startswith(f"{worst.link} moves by up to ")
    assert f"worst of {get_mechanism(found).samples} configurations at pan " in found.headline


def make_legs(*heights: float) -> str:
    """Return a body with four legs, each a hip at this height and a foot."""
    legs = [
        part
        for name, place, height in zip(("lf", "rf", "lh", "rh"), ("1 1", "1 -1", "-1 1", "-1 -1"), heights, strict=True)
        for part in (
            link(f"{name}_hip"),
            joint(f"{name}_hip_turn", "body", f"{name}_hip", kind="continuous", xyz=f"{place} {height}", axis="0 1 0"),
            link(f"{name}_foot"),
            joint(f"{name}_ankle", f"{name}_hip", f"{name}_foot", kind="fixed", xyz="0 0 -0.3"),
        )
    ]
    return robot(link("body"), *legs)


def test_branches_that_move_alike_are_counted(tmp_path: Path) -> None:
    found = compare_texts(tmp_path, make_legs(0, 0, 0, 0), make_legs(0.01, 0.01, 0.01, 0.01))
    assert found.headline == "8 links move by 10 mm in every configuration (lf_foot, lh_foot, rf_foot, …)"
    assert {shift.branch for shift in get_mechanism(found).shifts} == {"lf_hip", "rf_hip", "lh_hip", "rh_hip"}
    one = compare_texts(tmp_path / "one", make_legs(0, 0, 0, 0), make_legs(0.01, 0, 0, 0))
    assert one.headline == "lf_foot moves by 10 mm in every configuration"
    two = compare_texts(tmp_path / "two", make_legs(0, 0, 0, 0), make_legs(0.01, 0.02, 0, 0.02))
    assert two.headline == "4 links move by 20 mm in every configuration (rf_foot, rh_foot, …)"


def test_joints_that_are_moved_alike_in_several_links_are_one_line(tmp_path: Path) -> None:
    legs = make_legs(0, 0, 0, 0)
    shorter = legs.replace('xyz="0 0 -0.3"', 'xyz="0 0 -0.28"')
    lines = render_text(Diff(before="a", after="b", models=(compare_texts(tmp_path, legs, shorter),))).splitlines()
    said = "joints lf_ankle, rf_ankle, lh_ankle and 1 more: moves by 20 mm (z +20 mm), each in its parent link"
    assert [line.split(maxsplit=1)[1] for line in lines if line.startswith("  motion")] == [said]


def test_gravity_torques_are_those_of_statics(tmp_path: Path) -> None:
    """The elbow holds the forearm and all that hangs on it; stretched out, each at its lever."""
    found = compare_texts(tmp_path, ARM, ARM.replace('<mass value="0.6"/>', '<mass value="1.6"/>'))
    (torque,) = [torque for torque in get_mechanism(found).torques if torque.joint == "elbow"]
    # One kilogram more at 0.33 m, horizontal: an end of the range or a sample comes near it.
    assert torque.after - torque.before == pytest.approx(9.81 * 0.33, rel=0.02)
    assert (torque.effort, torque.unit, torque.main_link) == (40.0, "N·m", "hand")


_BAG = """<link name="bag">
    <inertial><mass value="2"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="strap" type="fixed"><parent link="hand"/><child link="bag"/></joint>
</robot>"""


@pytest.mark.parametrize(
    ("old", "new", "main"),
    [
        ('<mass value="0.6"/>', '<mass value="1.6"/>', "hand"),
        ('<mass value="0.05"/>', '<mass value="0.5"/>', ""),  # two fingers alike: each makes half
        ("</robot>", _BAG, "bag"),
    ],
)
def test_the_link_that_makes_most_of_a_load_is_named(tmp_path: Path, old: str, new: str, main: str) -> None:
    found = compare_texts(tmp_path, ARM, ARM.replace(old, new))
    mechanism = get_mechanism(found)
    (torque,) = [torque for torque in mechanism.torques if torque.joint == "elbow"]
    (inertia,) = [e for e in mechanism.effects if (e.id, e.subject) == ("joint-inertia", "joint[elbow]")]
    assert (torque.main_link, inertia.words["main_link"]) == (main, main)
    said = (describe_torque(torque), describe_effect(inertia))
    assert all((f"mostly because of link {main}" if main else "mostly") in text for text in said) == bool(main)


def test_two_changes_are_two_changes_with_a_cause_each(tmp_path: Path) -> None:
    changed = ARM.replace(WRIST, '<origin xyz="0.31 0 0" rpy="0 0 0"/>').replace('effort="40"', 'effort="35"')
    mechanism = get_mechanism(compare_texts(tmp_path, ARM, changed))
    assert [change.id for change in mechanism.changes] == ["joint-moved", "effort"]
    assert [cause.changes for cause in mechanism.causes] == [(0,), (1,)]


# Each change with the next one of another part.
_PAIRS = [(a, b) for a, b in itertools.pairwise(CHANGES) if CHANGES[a].subject != CHANGES[b].subject]


@pytest.mark.parametrize("pair", _PAIRS, ids=" and ".join)
def test_two_steps_are_the_sum_of_each(tmp_path: Path, pair: tuple[str, str]) -> None:
    """From A to B and from B to C the changes are those from A to C: nothing is lost or told twice on the way."""
    one, other = (CHANGES[name] for name in pair)
    middle = ARM.replace(one.old, one.new, 1)
    last = middle.replace(other.old, other.new, 1)

    def list_changes(name: str, before: str, after: str) -> list[tuple[str, str, dict[str, float]]]:
        found = get_mechanism(compare_texts(tmp_path / name, before, after))
        return [(change.id, change.subject, _round_numbers(change.numbers)) for change in found.changes]

    steps = list_changes("first", ARM, middle) + list_changes("second", middle, last)
    assert sorted(steps, key=str) == sorted(list_changes("both", ARM, last), key=str)
    assert len(steps) == len(one.ids) + len(other.ids)


def _round_numbers(numbers: Mapping[str, float]) -> dict[str, float]:
    """Return the numbers without the digits of rounding; what is not rotated has an axis at random."""
    return {
        name: round(value, 9) + 0.0  # not -0.0
        for name, value in numbers.items()
        if not (name.startswith("axis_") and abs(numbers["angle"]) < 1e-9)
    }


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ('<mass value="1e-05"/>', '<mass value="2e-05"/>', "mass"),
        ('<origin xyz="0.021 0 0" rpy="0 0 0"/>', '<origin xyz="0.031 0 0" rpy="0 0 0"/>', "com"),
        ('ixx="1e-09"', 'ixx="2e-09"', "tensor"),
    ],
)
def test_a_light_part_of_a_heavy_body_is_no_digit_of_it(tmp_path: Path, old: str, new: str, what: str) -> None:
    """A mark of 10 mg on a base of 4 kg: 0.001 % of the body is not counted, twice the mass of the mark is."""
    mark = (
        '<link name="mark"><inertial><origin xyz="0.021 0 0" rpy="0 0 0"/><mass value="1e-05"/>'
        '<inertia ixx="1e-09" ixy="0" ixz="0" iyy="1e-09" iyz="0" izz="1e-09"/></inertial></link>'
        '<joint name="stick" type="fixed"><parent link="base"/><child link="mark"/></joint></robot>'
    )
    marked = ARM.replace("</robot>", mark)
    (change,) = get_mechanism(compare_texts(tmp_path, marked, marked.replace(old, new))).changes
    assert (change.id, change.subject) == (what, "link[mark]")


def test_a_hand_on_an_empty_frame_moves_with_its_fingers(tmp_path: Path) -> None:
    """The directions of the fingers stay; where the hand is does not."""
    parts = [
        '<link name="flange"/>',
        '<joint name="mount" type="fixed"><parent link="base"/><child link="flange"/><origin xyz="0 0 0.1"/></joint>',
        '<link name="palm"><visual><geometry><box size="0.1 0.1 0.1"/></geometry></visual></link>',
        '<joint name="screws" type="fixed"><parent link="flange"/><child link="palm"/></joint>',
    ]
    for side in "ab":
        parts.append(
            f'<link name="finger_{side}"/><joint name="slide_{side}" type="prismatic"><parent link="palm"/>'
            f'<child link="finger_{side}"/><axis xyz="0 1 0"/><limit lower="0" upper="1" effort="1" velocity="1"/></joint>'
        )
    text = ARM.replace("</robot>", "".join(parts) + "</robot>")
    (change,) = get_mechanism(
        compare_texts(tmp_path, text, text.replace('xyz="0 0 0.1"/>', 'xyz="0 0 0.12"/>'))
    ).changes
    assert (change.id, change.subject) == ("joint-moved", "joint[mount]")


def test_the_colour_of_a_named_material_is_caused_where_it_is_typed(tmp_path: Path) -> None:
    of_robot = '<material name="m">\n<color rgba="1 0 0 1"/>\n</material>'
    used = ARM.replace('<robot name="arm">', f'<robot name="arm">{of_robot}').replace(
        "<visual>", '<visual><material name="m"/>'
    )
    found = compare_texts(tmp_path, used, used.replace("1 0 0 1", "0 1 0 1"))
    (cause,) = get_mechanism(found).causes
    assert [text for _, _, text in (*cause.before, *cause.after)] == [
        '<color rgba="1 0 0 1"/>',
        '<color rgba="0 1 0 1"/>',
    ]
    lines = render_text(Diff(before="a", after="b", models=(found,))).splitlines()
    assert lines[1] == "  visual     links base, upper, fore and 4 more: visual has another colour or texture"
    assert len(lines) == 5


def test_one_line_that_moves_many_parts_is_one_cause(tmp_path: Path) -> None:
    """A property of a file that another one includes."""
    legs = "".join(
        f'<link name="leg_{n}"/><joint name="hip_{n}" type="fixed"><parent link="base"/><child link="leg_{n}"/>'
        f'<origin xyz="0 ${{reach}} {n}"/></joint>\n'
        for n in range(5)
    )
    main = (
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">\n<xacro:include filename="sizes.xacro"/>\n'
        f'<link name="base"/>\n{legs}</robot>\n'
    )
    for side, reach in (("old", 0.4), ("new", 0.5)):
        (tmp_path / side).mkdir()
        (tmp_path / side / "sizes.xacro").write_text(
            '<robot xmlns:xacro="http://www.ros.org/wiki/xacro">\n<!-- sizes -->\n'
            f'<xacro:property name="reach" value="{reach}"/>\n</robot>\n'
        )
    found = compare_texts(tmp_path, main, main, name="r.urdf.xacro")
    mechanism = get_mechanism(found)
    assert {change.id for change in mechanism.changes} == {"joint-moved"}
    (cause,) = mechanism.causes
    assert len(cause.changes) == 5
    ((file, line, text),) = cause.before
    assert (file.rpartition("/")[2], line) == ("sizes.xacro", 3)
    assert text == '<xacro:property name="reach" value="0.4"/>'


@pytest.mark.parametrize(
    ("old", "new", "label"),
    [
        ('<mass value="0.6"/>', '<mass value="heavy"/>', "link[hand]/inertial/mass@value"),
        ('<mass value="0.6"/>', '<mass value="nan"/>', "link[hand]/inertial/mass@value"),
        ('<mass value="0.6"/>', '<mass value="1e308"/>', "link[hand]/inertial/mass@value"),
        ('effort="10"', 'effort="10 N"', "joint[wrist]/limit@effort"),
        ('<box size="0.06 0.1 0.04"/>', '<box size="0.06 0.1"/>', "link[hand]/visual/box@size"),
    ],
)
def test_what_is_no_number_is_compared_as_it_is_written(tmp_path: Path, old: str, new: str, label: str) -> None:
    """It was worth nothing in both versions: one that is as unreadable in another way was called cosmetic."""
    unreadable = ARM.replace(old, new, 1)
    assert unreadable != ARM
    found = [change.subject for change in get_mechanism(compare_texts(tmp_path / "a", ARM, unreadable)).changes]
    assert f"unreadable {label}" in found
    other = unreadable.replace(new, new.replace('="', '="x', 1), 1)
    found = compare_texts(tmp_path / "b", unreadable, other)
    assert [(change.id, change.subject) for change in get_mechanism(found).changes] == [
        ("extra-changed", f"unreadable {label}")
    ]
    assert found.verdict == "extension"
    assert compare_texts(tmp_path / "c", unreadable, unreadable.replace(f" {new}", f"  {new}")).verdict in {
        "cosmetic",
        "identical",
    }


def test_of_blocks_that_set_one_value_the_order_counts(tmp_path: Path) -> None:
    """And of others it does not."""
    rough, smooth, plain = (
        f'<gazebo reference="hand">{value}</gazebo>' for value in ("<mu1>1</mu1>", "<mu1>0</mu1>", "<kp>1</kp>")
    )

    def compare(folder: str, before: str, after: str) -> ModelDiff:
        old, new = (ARM.replace("</robot>", f"{blocks}</robot>") for blocks in (before, after))
        return compare_texts(tmp_path / folder, old, new)

    assert compare("swapped", rough + smooth, smooth + rough).verdict == "extension"
    assert compare("same", rough + plain, plain + rough).verdict == "cosmetic"
