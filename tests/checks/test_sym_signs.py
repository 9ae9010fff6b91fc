"""SYM004: slips of a sign, a coordinate or a decimal point in origins and axes that twins show, and when nothing is said."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import find, inertial, joint
from conftest import check_text

from urdfcheck.core import Finding, Severity

BOX = "<visual><origin xyz='0 0 {z}'/><geometry><box size='0.04 0.03 0.2'/></geometry></visual>"
SIDES = {"FL": (1, 1), "FR": (1, -1), "HL": (-1, 1), "HR": (-1, -1)}
LIMIT = '<limit lower="-0.5" upper="1" effort="20" velocity="5"/>'


def make_quadruped(sides: tuple[str, ...] = tuple(SIDES), **changed: str) -> str:
    """Two or four legs; ``FL_hip="1 2 3"`` is another origin, ``FL_hip_axis`` another axis, ``FL_hip_limit`` another range."""
    parts = ['<link name="trunk"><visual><geometry><box size="0.4 0.2 0.1"/></geometry></visual></link>']
    for side in sides:
        front, left = SIDES[side]
        places = {"roll": (f"{0.2 * front:g} {0.08 * left:g} 0", "1 0 0"), "hip": (f"0 {0.05 * left:g} 0", "0 1 0")}
        places["knee"] = (f"0 {0.01 * left:g} -0.2", "0 1 0")
        parent = "trunk"
        for name, (xyz, axis) in places.items():
            key = f"{side}_{name}"
            parts.append(f'<link name="{key}_link">{BOX.format(z=-0.1)}</link>')
            parts.append(
                joint(
                    key,
                    parent,
                    f"{key}_link",
                    changed.get(f"{key}_limit", LIMIT),
                    kind="revolute",
                    xyz=changed.get(key, xyz),
                    axis=changed.get(f"{key}_axis", axis),
                )
            )
            parent = f"{key}_link"
    return f'<robot name="r">{"".join(parts)}</robot>'


def find_slips(tmp_path: Path, text: str) -> list[Finding]:
    return [
        f
        for f in find(tmp_path, text, "SYM004")
        if f.message_id
        in {
            "slip",
            "sign",
            "reversed",
            "coincident",
            "opposed",
            "steering",
            "together",
            "crosswise",
            "diagonal",
            "diagonal_turned",
        }
    ]


def test_sound_legs_are_fine(tmp_path: Path) -> None:
    assert not find_slips(tmp_path, make_quadruped())
    assert not find_slips(tmp_path, make_quadruped(("FL", "FR")))


@pytest.mark.parametrize(("xyz", "cause"), [("0 -0.01 0.2", "sign"), ("0 -0.01 -2", "decimal")])
def test_a_slip_of_one_side_of_two_is_found_and_shows_both_repairs(tmp_path: Path, xyz: str, cause: str) -> None:
    (finding,) = find_slips(tmp_path, make_quadruped(("FL", "FR"), FR_knee=xyz))
    assert finding.cause is not None
    assert finding.cause.id == cause
    assert finding.fix is not None
    assert "0 -0.01 -0.2" in finding.fix.title
    assert not finding.fix.edits


@pytest.mark.parametrize(
    ("right", "found"),
    [
        ("0 -1.5 0.08", True),
        ("0 -0.15 0.08", False),
        ("0 -1.4 0.08", False),  # another number
        ("0 1.5 0.08", False),  # on the same side
        ("0.1 -1.5 0.08", False),  # another place
    ],
)
def test_two_hubs_are_mirror_images_but_for_a_decimal_point(tmp_path: Path, right: str, found: bool) -> None:
    """They need no other pair, and may be fixed: exactly ten times as far to one side is hardly meant."""
    joints = "".join(
        f'<joint name="{side}_hub" type="fixed"><origin xyz="{xyz}"/><parent link="base"/><child link="{side}_hub"/></joint>'
        f'<link name="{side}_hub"/>'
        for side, xyz in (("left", "0 0.15 0.08"), ("right", right))
    )
    slips = find_slips(tmp_path, f'<robot name="r"><link name="base"/>{joints}</robot>')
    assert [slip.cause.id for slip in slips if slip.cause is not None] == ["decimal"] * found


@pytest.mark.parametrize(
    ("front", "rear", "found"),
    [
        ("0.4145 0 0", "-4.145 0 0", True),
        ("0.4 0 0", "-4 0 0", False),  # numbers that are round may be two
        ("0.4145 0 0", "4.145 0 0", False),  # at one end
        ("0.4145 0 0", "-0.4145 0 0", False),
    ],
)
def test_two_ends_are_mirror_images_but_for_a_decimal_point(tmp_path: Path, front: str, rear: str, found: bool) -> None:
    joints = "".join(
        f'<joint name="{end}_face" type="fixed"><origin xyz="{xyz}"/><parent link="base"/><child link="{end}_face"/></joint>'
        f'<link name="{end}_face"/>'
        for end, xyz in (("front", front), ("rear", rear))
    )
    slips = find_slips(tmp_path, f'<robot name="r"><link name="base"/>{joints}</robot>')
    assert [(slip.location.subject, slip.cause.id) for slip in slips if slip.cause is not None] == [
        ("joint[rear_face]/origin@xyz", "decimal")
    ] * found


def test_a_rotor_is_ten_times_as_far_back_as_the_one_beside_it(tmp_path: Path) -> None:
    joints = "".join(
        f'<joint name="{name}_rotor" type="fixed"><origin xyz="{xyz}"/><parent link="base"/><child link="{name}_rotor"/></joint>'
        f'<link name="{name}_rotor"/>'
        for name, xyz in (("BL", "-3.1 0.19 0.1"), ("BR", "-0.31 -0.19 0.1"))
    )
    slips = find_slips(tmp_path, f'<robot name="r"><link name="base"/>{joints}</robot>')
    assert [slip.location.subject for slip in slips] == ["joint[BL_rotor]/origin@xyz"]


def test_another_place_is_no_slip(tmp_path: Path) -> None:
    assert not find_slips(tmp_path, make_quadruped(("FL", "FR"), FR_knee="0 -0.02 -0.3"))


def test_a_sign_that_the_next_joint_takes_back_moves_nothing(tmp_path: Path) -> None:
    """The hip turns about x, on which its frame may be anywhere: the knee is where it was."""
    legs = {f"{side}_hip": f"0.03 {0.05 * left:g} 0" for side, (_, left) in SIDES.items()}
    legs |= {f"{side}_hip_axis": "1 0 0" for side in SIDES} | {"FR_hip": "-0.03 -0.05 0"}
    assert not find_slips(tmp_path, make_quadruped(**legs, FR_knee="0.06 -0.01 -0.2"))
    (finding,) = find_slips(tmp_path, make_quadruped(**legs))
    assert finding.message_id == "slip"


@pytest.mark.parametrize("taken_back", [True, False])
def test_of_four_signs_the_only_other_one_is_found_unless_the_next_joint_takes_it_back(
    tmp_path: Path, taken_back: bool
) -> None:
    changed = {f"{side}_hip": "0.03 0 -0.05" for side in SIDES} | {f"{side}_hip_axis": "1 0 0" for side in SIDES}
    changed |= {"HR_hip": "-0.03 0 -0.05"} | ({"HR_knee": "0.06 -0.01 -0.2"} if taken_back else {})
    assert len(find_slips(tmp_path, make_quadruped(**changed))) == (not taken_back)


def test_one_module_on_both_sides_is_meant(tmp_path: Path) -> None:
    assert not find_slips(tmp_path, make_quadruped(("FL", "FR"), FR_knee="0 0.01 -0.2"))


def test_of_four_axes_the_only_reversed_one_is_found(tmp_path: Path) -> None:
    (finding,) = find_slips(tmp_path, make_quadruped(HL_hip_axis="0 -1 0"))
    assert (finding.message_id, finding.location.subject) == ("reversed", "joint[HL_hip]/axis@xyz")
    assert finding.fix is not None
    assert [edit.replacement for edit in finding.fix.edits] == ["0 1 0"]


def test_three_axes_and_one_may_be_two_mirrored_pairs(tmp_path: Path) -> None:
    """The knees of left and right are opposite: then the hips are too, and one of three hips is the wrong one."""
    text = make_quadruped(HL_hip_axis="0 -1 0", FL_knee_axis="0 -1 0", HL_knee_axis="0 -1 0")
    (finding,) = [f for f in find(tmp_path, text, "SYM004") if f.location.subject == "joint[HL_hip]/axis@xyz"]
    assert finding.message_id == "reversed"
    assert finding.fix is not None
    assert not finding.fix.edits
    assert finding.fix.title.startswith("if the four are meant to have one axis, write 0 1 0")


@pytest.mark.parametrize(("effort", "is_edited"), [("2", False), ("200", False), ("30", True)])
def test_a_limit_a_power_of_ten_off_may_be_the_only_right_one(tmp_path: Path, effort: str, is_edited: bool) -> None:
    text = make_quadruped(HL_hip_limit=LIMIT.replace('effort="20"', f'effort="{effort}"'))
    (finding,) = [f for f in find(tmp_path, text, "SYM004") if f.message_id == "limits"]
    assert finding.fix is not None
    assert bool(finding.fix.edits) == is_edited
    assert ("if the decimal point is wrong in the others" in finding.fix.title) == (not is_edited)


def test_two_and_two_axes_are_a_convention(tmp_path: Path) -> None:
    assert not find_slips(tmp_path, make_quadruped(FR_hip_axis="0 -1 0", HR_hip_axis="0 -1 0"))


def test_an_axis_that_is_reversed_with_its_limits_is_meant(tmp_path: Path) -> None:
    limit = LIMIT.replace("-0.5", "-1").replace('upper="1"', 'upper="0.5"')
    assert not find_slips(tmp_path, make_quadruped(HL_hip_axis="0 -1 0", HL_hip_limit=limit))


@pytest.mark.parametrize(("kind", "count"), [("continuous", 1), ("revolute", 0)])
def test_wheels_in_one_place_are_found_and_jaws_on_one_hinge_are_meant(tmp_path: Path, kind: str, count: int) -> None:
    inertial = (
        '<inertial><mass value="0.2"/><inertia ixx="1e-4" ixy="0" ixz="0" iyy="1e-4" iyz="0" izz="1e-4"/></inertial>'
    )
    sides = ("left_part", "right_part")
    links = "".join(f'<link name="{side}">{inertial}{BOX.format(z=0)}</link>' for side in sides)
    joints = "".join(joint(f"{s}_joint", "base", s, LIMIT, kind=kind, xyz="0 -0.1 0", axis="0 1 0") for s in sides)
    text = f'<robot name="r"><link name="base"/>{links}{joints}</robot>'
    assert [f.message_id for f in find_slips(tmp_path, text)] == ["coincident"] * count


@pytest.mark.parametrize(
    ("changed", "attribute", "expected"),
    [
        ({"HR_knee": "0 -0.01 -0.21"}, "origin@xyz", "0 -0.01 -0.2"),
        ({"FL_knee": "0 0.013 -2"}, "origin@xyz", "0 0.01 -0.2"),
        ({"FL_hip_axis": "0 0 1"}, "axis@xyz", "0 1 0"),
        ({"FL_hip_axis": "1 0 0"}, "axis@xyz", "0 1 0"),
    ],
)
def test_one_attribute_that_only_one_of_four_limbs_has_is_repaired(
    tmp_path: Path, changed: dict[str, str], attribute: str, expected: str
) -> None:
    text = make_quadruped(**changed)
    (finding,) = [
        f for f in find(tmp_path, text, "SYM004") if f.location.subject.startswith(f"joint[{next(iter(changed))[:6]}")
    ]
    assert finding.message_id == "odd"
    assert finding.location.subject.endswith(attribute)
    assert finding.fix is not None
    assert [edit.replacement for edit in finding.fix.edits] == [expected]


@pytest.mark.parametrize(
    "changed",
    [
        # Legs that are arranged otherwise: two attributes differ, or two of four.
        {"FL_knee": "0 0.01 -0.25", "FL_knee_axis": "0 0 1"},
        {"FL_knee": "0 0.01 -0.25", "FR_knee": "0 -0.01 -0.25"},
        # Less than a millimetre is an adjustment.
        {"FL_knee": "0 0.0105 -0.2"},
        # The hip turns about y: its frame is at another point of that axis, which the knee takes back.
        {"FL_hip": "0 0.08 0", "FL_knee": "0 -0.02 -0.2"},
    ],
)
def test_legs_that_are_arranged_otherwise_are_fine(tmp_path: Path, changed: dict[str, str]) -> None:
    assert "odd" not in {f.message_id for f in find(tmp_path, make_quadruped(**changed), "SYM004")}


@pytest.mark.parametrize(("axis", "count"), [("1 0 0", 1), ("0 0 1", 1), ("-1 5.55e-17 0", 1), ("0 -1 0", 0)])
def test_of_two_legs_an_axis_along_another_coordinate_is_found(tmp_path: Path, axis: str, count: int) -> None:
    found = [
        f for f in find(tmp_path, make_quadruped(("FL", "FR"), FR_hip_axis=axis), "SYM004") if f.message_id == "axis"
    ]
    assert len(found) == count
    for finding in found:
        assert "90.00°" in finding.headline
        assert finding.fix is None or not finding.fix.edits


@pytest.mark.parametrize(("drawn", "count"), [(0.014, 0), (0.0, 1)])
def test_a_wheel_whose_frame_is_elsewhere_on_its_axle_is_in_place_if_its_drawing_is(
    tmp_path: Path, drawn: float, count: int
) -> None:
    parts = ['<link name="base"/>']
    for number, (front, left) in enumerate(SIDES.values(), start=1):
        y = 0.018 if number == 1 else 0.032 * left
        at = drawn if number == 1 else 0.0
        parts.append(f'<link name="wheel{number}">{BOX.replace("0 0 {z}", f"0 {at} 0")}</link>')
        parts.append(
            joint(
                f"joint{number}", "base", f"wheel{number}", kind="continuous", xyz=f"{0.04 * front} {y} 0", axis="0 1 0"
            )
        )
    text = f'<robot name="r">{"".join(parts)}</robot>'
    assert [f.message_id for f in find(tmp_path, text, "SYM004")] == ["odd"] * count


def test_the_place_of_a_bolted_part_is_asked_about(tmp_path: Path) -> None:
    places = {
        "front_left": "0.04 0.08 0",
        "front_right": "0.04 -0.08 0",
        "rear_left": "-0.04 0.08 0",
        "rear_right": "-0.06 -0.08 0",
    }
    parts = [
        f'<link name="{name}_spacer">{BOX.format(z=0)}</link>'
        + joint(f"{name}_mount", "base", f"{name}_spacer", kind="fixed", xyz=xyz)
        for name, xyz in places.items()
    ]
    text = f'<robot name="r"><link name="base"/>{"".join(parts)}</robot>'
    (finding,) = find(tmp_path, text, "SYM004")
    assert finding.message_id == "odd"
    assert finding.fix is not None
    assert finding.fix.title.startswith(
        "if rear_right_mount is meant to be placed like the others, write -0.04 -0.08 0"
    )
    assert not finding.fix.edits


def test_an_angle_that_only_one_of_four_limbs_has_is_repaired(tmp_path: Path) -> None:
    text = make_quadruped()
    for angle, count in (("0.124", 1), ("0.5236", 0), ("0.002", 0)):
        turned = text.replace('<origin xyz="0 0.01 -0.2"', f'<origin rpy="0 {angle} 0" xyz="0 0.01 -0.2"', 1)
        turned = turned.replace(
            f'rpy="0 {angle} 0" xyz="0 0.01 -0.2" rpy="0 0 0"', f'rpy="0 {angle} 0" xyz="0 0.01 -0.2"'
        )
        (tmp_path / angle).mkdir()
        found = [f for f in find(tmp_path / angle, turned, "SYM004") if f.message_id == "odd"]
        assert len(found) == count


def test_the_only_wheel_in_its_place_is_not_blamed_for_two_that_share_one(tmp_path: Path) -> None:
    parts = ['<link name="left_base"/><link name="right_base"/><link name="base"/>']
    parts += [
        joint(f"{side}_mount", "base", f"{side}_base", kind="fixed", xyz=f"0 {y} 0")
        for side, y in (("left", 0.2), ("right", -0.2))
    ]
    places = {"left_front": 0.1, "left_back": 0.1, "right_front": 0.1, "right_back": -0.1}
    for name, x in places.items():
        parts.append(f'<link name="{name}_wheel">{BOX.format(z=0)}</link>')
        side = name.partition("_")[0]
        parts.append(
            joint(f"{name}_joint", f"{side}_base", f"{name}_wheel", kind="continuous", xyz=f"{x} 0 -0.1", axis="0 1 0")
        )
    assert "sign" not in {f.message_id for f in find_slips(tmp_path, f'<robot name="r">{"".join(parts)}</robot>')}


@pytest.mark.parametrize(
    ("changed", "count"),
    [
        ({"FR_knee": "-0.15 -0.01 -0.2"}, 1),
        ({"FR_knee": "0 -0.16 -0.2"}, 0),  # along the axis of the knee
        ({"FR_knee": "-0.15 -0.011 -0.2"}, 0),
        ({"FR_knee": "-0.15 -0.01 -0.2", "FR_hip": "0 -0.06 0"}, 0),
    ],
)
def test_one_coordinate_that_is_not_the_other_sides_is_found_at_any_distance(
    tmp_path: Path, changed: dict[str, str], count: int
) -> None:
    found = find_slips(tmp_path, make_quadruped(("FL", "FR"), **changed))
    assert len(found) == count
    for finding in found:
        assert finding.cause is None
        assert finding.location.subject == "joint[FR_knee]/origin@xyz"
        assert finding.fix is not None
        assert "0 -0.01 -0.2" in finding.fix.title


def make_rotors(**changed: str) -> str:
    """Four rotors on one body, the rear ones closer together."""
    places = {"0": "0.13 -0.22 0.02", "1": "-0.13 0.2 0.02", "2": "0.13 0.22 0.02", "3": "-0.13 -0.2 0.02"}
    parts = ['<link name="body"><visual><geometry><box size="0.4 0.2 0.1"/></geometry></visual></link>']
    for number, place in places.items():
        parts.append(f'<link name="rotor_{number}">{BOX.format(z=0)}</link>')
        xyz, axis = changed.get(f"at_{number}", place), changed.get(f"axis_{number}", "0 0 1")
        limit = '<limit lower="-1e9" upper="1e9" effort="20" velocity="5"/>'
        parts.append(
            joint(f"rotor_{number}_joint", "body", f"rotor_{number}", limit, kind="revolute", xyz=xyz, axis=axis)
        )
    return f'<robot name="r">{"".join(parts)}</robot>'


@pytest.mark.parametrize(
    ("changed", "messages"),
    [
        ({}, []),
        ({"at_3": "-0.28 -0.2 0.02"}, ["slip"]),
        ({"at_3": "-0.28 -0.2 0.02", "at_1": "-0.28 0.2 0.02"}, []),
        ({"at_3": "-0.28 -0.25 0.02"}, []),
        ({"axis_3": "0 0 -1"}, ["reversed"]),
        ({"axis_3": "0 0 -1", "axis_2": "0 0 -1"}, []),
    ],
)
def test_of_four_numbered_joints_on_one_link_the_odd_one_is_found(
    tmp_path: Path, changed: dict[str, str], messages: list[str]
) -> None:
    found = find_slips(tmp_path, make_rotors(**changed))
    assert [finding.message_id for finding in found] == messages
    assert all(finding.location.subject.startswith("joint[rotor_3_joint]") for finding in found)


@pytest.mark.parametrize(
    ("changed", "count"),
    [
        ({"FR_knee_axis": "0 -1 0"}, 1),
        ({"FR_knee_axis": "0 -1 0", "FR_hip_axis": "0 -1 0"}, 0),
        ({"FR_roll_axis": "-1 0 0"}, 0),
    ],
)
def test_of_two_legs_a_knee_that_bends_the_other_way_is_found(
    tmp_path: Path, changed: dict[str, str], count: int
) -> None:
    """Each range is the same to either side of zero. Rolls may be mirrored; so may all joints of a leg."""
    ranges = {
        f"{side}_{name}_limit": '<limit lower="-1" upper="1" effort="20" velocity="5"/>'
        for side in ("FL", "FR")
        for name in ("roll", "hip", "knee")
    }
    found = find_slips(tmp_path, make_quadruped(("FL", "FR"), **ranges, **changed))
    assert [finding.message_id for finding in found] == ["opposed"] * count
    assert all(finding.location.subject == "joint[FR_knee]/axis@xyz" for finding in found)


@pytest.mark.parametrize(("axis", "upper", "count"), [("0 0 1", "0.5", 0), ("0 0 -1", "0.5", 1), ("0 0 -1", "0.7", 0)])
def test_wheels_that_are_steered_to_opposite_sides_are_found(tmp_path: Path, axis: str, upper: str, count: int) -> None:
    parts = ['<link name="base"><visual><geometry><box size="0.4 0.2 0.1"/></geometry></visual></link>']
    for side, y in (("left", 0.1), ("right", -0.1)):
        limit = f'<limit lower="-0.5" upper="{upper}" effort="20" velocity="5"/>'
        turned = axis if side == "right" else "0 0 1"
        parts.append(f'<link name="{side}_hub"/><link name="{side}_wheel">{BOX.format(z=0)}</link>')
        parts.append(joint(f"{side}_steer", "base", f"{side}_hub", limit, kind="revolute", xyz=f"0 {y} 0", axis=turned))
        parts.append(joint(f"{side}_roll", f"{side}_hub", f"{side}_wheel", kind="continuous", axis="0 1 0"))
    found = find_slips(tmp_path, f'<robot name="r">{"".join(parts)}</robot>')
    assert [finding.message_id for finding in found] == ["steering"] * count


@pytest.mark.parametrize(
    ("axis", "second", "names", "count"),
    [
        ("0 -1 0", 'lower="0" upper="0.03"', "finger", 0),
        ("0 1 0", 'lower="-0.03" upper="0"', "finger", 0),
        ("0 1 0", 'lower="0" upper="0.03"', "finger", 1),
        ("0 -1 0", 'lower="-0.03" upper="0"', "finger", 1),
        ("0 1 0", 'lower="0" upper="0.03"', "carriage", 0),
        ("0 1 0", 'lower="-0.015" upper="0.015"', "finger", 0),
        ("0 0 1", 'lower="0" upper="0.03"', "finger", 1),
    ],
)
def test_fingers_that_slide_to_the_same_side_or_across_each_other_are_found(
    tmp_path: Path, axis: str, second: str, names: str, count: int
) -> None:
    parts = ['<link name="palm"><visual><geometry><box size="0.4 0.2 0.1"/></geometry></visual></link>']
    for number, y in ((1, 0.02), (2, -0.02)):
        bounds = second if number == 2 else 'lower="0" upper="0.03"'
        parts.append(f'<link name="{names}_{number}">{BOX.format(z=0)}</link>')
        parts.append(
            joint(
                f"{names}_{number}_joint", "palm", f"{names}_{number}", f'<limit {bounds} effort="20" velocity="5"/>',
                kind="prismatic", xyz=f"0 {y} 0", axis=axis if number == 2 else "0 1 0",
            )
        )  # fmt: skip
    found = find_slips(tmp_path, f'<robot name="r">{"".join(parts)}</robot>')
    assert [finding.message_id for finding in found] == ["crosswise" if axis == "0 0 1" else "together"] * count


@pytest.mark.parametrize("drawn", [True, False])
@pytest.mark.parametrize(
    ("axis", "second", "more", "count"),
    [
        ("0 0 -1", 'lower="0" upper="0.5"', "", 0),
        ("0 0 1", 'lower="-0.5" upper="0"', "", 0),
        ("0 0 1", 'lower="0" upper="0.5"', "", 1),
        ("0 0 1", 'lower="0" upper="0.4"', "", 0),
        ("0 0 1", 'lower="-0.3" upper="0.5"', "", 0),
        ("0 1 0", 'lower="0" upper="0.5"', "", 0),
        ("0 0 1", 'lower="0" upper="0.5"', '<mimic joint="finger_1_joint" multiplier="-1"/>', 0),
        ("0 0 1", 'lower="0" upper="0.5"', '<mimic joint="finger_1_joint"/>', 1),
    ],
)
def test_fingers_that_swing_to_the_same_side_are_found(
    tmp_path: Path, axis: str, second: str, more: str, count: int, drawn: bool
) -> None:
    ahead = '<visual><origin xyz="0.05 0 0"/><geometry><box size="0.1 0.01 0.02"/></geometry></visual>'
    part = ahead if drawn else inertial(0.1, 1e-4, com="0.05 0 0")
    parts = ['<link name="palm"/>']
    for number, y in ((1, 0.02), (2, -0.02)):
        bounds = second if number == 2 else 'lower="0" upper="0.5"'
        limit = f'<limit {bounds} effort="2" velocity="5"/>{more * (number == 2)}'
        parts.append(f'<link name="finger_{number}">{part}</link>')
        parts.append(
            joint(
                f"finger_{number}_joint", "palm", f"finger_{number}", limit,
                kind="revolute", xyz=f"0 {y} 0", axis=axis if number == 2 else "0 0 1",
            )
        )  # fmt: skip
    found = find_slips(tmp_path, f'<robot name="r">{"".join(parts)}</robot>')
    assert [finding.message_id for finding in found] == ["together"] * count


def test_tips_of_fingers_swing_like_the_fingers(tmp_path: Path) -> None:
    """Fingers that are side by side bend together; the tips of two that face each other do not."""
    for across, count in (("0 0.02 0", 1), ("0 0 0.02", 0)):
        parts = ['<link name="palm"/>']
        for side, sign in (("l", ""), ("r", "-")):
            xyz = " ".join(sign + word if word != "0" else word for word in across.split())
            limit = '<limit lower="0" upper="0.5" effort="2" velocity="5"/>'
            for name, parent, place, axis in (
                (f"{side}_finger", "palm", xyz, f"0 0 {sign}1" if count else "0 0 1"),
                (f"{side}_finger_tip", f"{side}_finger", "0.1 0 0", "0 0 1"),
            ):
                parts.append(f'<link name="{name}">{inertial(0.1, 1e-4, com="0.05 0 0")}</link>')
                parts.append(joint(f"{name}_joint", parent, name, limit, kind="revolute", xyz=place, axis=axis))
        found = find_slips(tmp_path, f'<robot name="r">{"".join(parts)}</robot>')
        assert [finding.message_id for finding in found] == ["together"] * count


@pytest.mark.parametrize(("axis", "count"), [("1 0 0", 1), ("0 0 1", 1), ("0 1 0", 0), ("0 -1 0", 0)])
def test_copies_of_one_module_have_their_axes_along_one_coordinate(tmp_path: Path, axis: str, count: int) -> None:
    text = make_quadruped(("FL", "FR"), FL_knee="0 0 -0.2", FR_knee="0 0 -0.2", FR_knee_axis=axis)
    found = [f.message_id for f in find(tmp_path, text, "SYM004") if f.message_id == "axis"]
    assert found == ["axis"] * count


def test_a_leg_that_has_changed_sides_is_found_beside_the_odd_one(tmp_path: Path) -> None:
    (finding,) = find_slips(tmp_path, make_quadruped(HL_hip="0 -0.05 0"))
    assert finding.message_id == "sign"
    assert finding.location.subject == "joint[HL_hip]/origin@xyz"
    assert finding.fix is not None
    assert [edit.replacement for edit in finding.fix.edits] == ["0 0.05 0"]


def test_the_first_pair_shows_the_plane_where_a_slip_takes_the_rest_along(tmp_path: Path) -> None:
    (finding,) = find_slips(tmp_path, make_quadruped(("FL", "FR"), FL_hip="0 0.05 -0.04", FR_hip="0 -0.05 0.04"))
    assert (finding.message_id, finding.location.subject) == ("slip", "joint[FR_hip]/origin@xyz")


@pytest.mark.parametrize(("z", "count"), [("-0.03", 0), ("0.03", 1)])
def test_a_sign_that_half_a_turn_of_the_parents_does_not_flip_is_a_slip(tmp_path: Path, z: str, count: int) -> None:
    parts = ['<link name="base"/>']
    for side, y, yaw in (("left", "0.2", "0"), ("right", "-0.2", "3.14159265358979")):
        names = [f"{side}_{part}" for part in ("arm", "wrist", "motor")]
        parts += [f'<link name="{name}">{BOX.format(z=0)}</link>' for name in names]
        parts.append(
            joint(f"{names[0]}_joint", "base", names[0], LIMIT, kind="revolute", xyz=f"0 {y} 0", rpy=f"0 0 {yaw}")
        )
        parts.append(joint(f"{names[1]}_joint", names[0], names[1], LIMIT, kind="revolute", xyz="0 0 -0.2"))
        place = f"0 -0.02 {z}" if side == "right" else "0 -0.02 -0.03"
        parts.append(joint(f"{names[2]}_joint", names[1], names[2], kind="fixed", xyz=place))
    found = find_slips(tmp_path, f'<robot name="r">{"".join(parts)}</robot>')
    assert [finding.message_id for finding in found] == ["slip"] * count


@pytest.mark.parametrize(
    ("hip", "knee", "messages"),
    [
        ("0.14 0 0", "0 0 0", ["turned"]),
        ("0.14 0 0", "-0.14 0 0", []),  # the next joint turns back
        ("0 0.14 0", "0 0 0", []),  # another zero
        ("0.01 0 0", "0 0 0", []),
        ("0.2617993878 0 0", "0 0 0", []),
    ],
)
def test_a_leg_that_is_turned_against_the_other_is_found(
    tmp_path: Path, hip: str, knee: str, messages: list[str]
) -> None:
    parts = ['<link name="trunk"/>']
    for side, y in (("left", 0.1), ("right", -0.1)):
        parent = "trunk"
        for name, xyz, rpy in (("hip", f"0 {y} 0", "0 0 0"), ("thigh", "0 0 -0.1", hip), ("shin", "0 0 -0.2", knee)):
            link, turned = f"{side}_{name}", rpy if side == "left" else "0 0 0"
            parts.append(f'<link name="{link}">{BOX.format(z=-0.1)}</link>')
            parts.append(
                joint(f"{link}_joint", parent, link, LIMIT, kind="revolute", xyz=xyz, rpy=turned, axis="0 1 0")
            )
            parent = link
    found = [
        f for f in find(tmp_path, f'<robot name="r">{"".join(parts)}</robot>', "SYM004") if "turned" in f.message_id
    ]
    assert [finding.message_id for finding in found] == messages
    for finding in found:
        assert finding.fix is not None
        assert [(edit.expected, edit.replacement) for edit in finding.fix.edits] == [(hip, "0 0 0")]


@pytest.mark.parametrize(("alike", "count"), [("one", 1), ("macro", 0), ("parent", 0)])
def test_a_finger_from_another_macro_or_on_another_kind_of_link_is_another_finger(
    tmp_path: Path, alike: str, count: int
) -> None:
    tip = (
        '<link name="${side}_tip"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
        '</inertial></link><joint name="${side}_tip" type="fixed"><parent link="${side}_PARENT"/><child link="${side}_tip"/>'
        '<origin xyz="${at}"/></joint>'
    )
    finger = '<link name="${side}_distal"/><link name="${side}_dummy"/>' + "".join(
        f'<joint name="${{side}}_{name}" type="revolute"><parent link="{parent}"/><child link="${{side}}_{name}"/>'
        f'<origin xyz="${{x}} 0 0.1"/><axis xyz="1 0 0"/>{LIMIT}</joint>'
        for name, parent in (("distal", "palm"), ("dummy", "${side}_distal"))
    )
    other = "dummy" if alike == "parent" else "distal"
    macros = "".join(
        f'<xacro:macro name="{name}" params="side x at">{finger}{tip.replace("PARENT", parent)}</xacro:macro>'
        for name, parent in (("plain", "distal"), ("special", other))
    )
    places = {"FL": "0 0.004 0.029", "FR": "0 0 0.026", "HL": "0 0 0.026", "HR": "0 0 0.026"}
    calls = "".join(
        f'<xacro:{"special" if side == "FL" and alike != "one" else "plain"} side="{side}" x="{i / 10}" at="{at}"/>'
        for i, (side, at) in enumerate(places.items())
    )
    text = f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="palm"/>{macros}{calls}</robot>'
    found = check_text(tmp_path, text, "r.urdf.xacro").findings
    assert [f.message_id for f in found if f.code == "SYM004"] == ["odd"] * count


@pytest.mark.parametrize(("wheels", "others", "count"), [(True, 3, 1), (False, 1, 1), (False, 0, 0)])
def test_a_steering_axis_along_another_coordinate_shows_where_another_pair_of_the_link_agrees(
    tmp_path: Path, wheels: bool, others: int, count: int
) -> None:
    parts = ['<link name="base"/>']
    for number, (side, (front, left)) in enumerate([*SIDES.items()][: 4 if others else 2]):
        axis = "1 0 0" if number == 0 else "0 0 1"
        parts.append(f'<link name="{side}_holder">{BOX.format(z=0)}</link>')
        parts.append(
            joint(
                f"{side}_steering",
                "base",
                f"{side}_holder",
                kind="continuous",
                xyz=f"{0.3 * front} {0.2 * left} 0",
                axis=axis,
            )
        )
        if wheels:
            parts.append(f'<link name="{side}_wheel">{BOX.format(z=0)}</link>')
            drive = {"kind": "continuous", "xyz": "0 0 -0.1", "axis": "0 1 0"}
            parts.append(joint(f"{side}_drive", f"{side}_holder", f"{side}_wheel", **drive))
    found = find(tmp_path, f'<robot name="r">{"".join(parts)}</robot>', "SYM004")
    assert [f.message_id for f in found if "steering" in f.message] == ["lone"] * count


def make_hips(fl: str, *, turn: str = "3.14159265") -> str:
    """Four hips on one trunk; the frames on the left are rotated by half a turn."""
    parts = ['<link name="trunk"/>']
    for side, (front, left) in SIDES.items():
        xyz = fl if side == "FL" else f"{0.3 * front:g} {0.2 * left:g} 0"
        parts.append(f'<link name="{side}_hip"/>')
        rpy = f"0 0 {turn}" if left > 0 else "0 0 0"
        parts.append(joint(f"{side}_roll", "trunk", f"{side}_hip", LIMIT, kind="revolute", xyz=xyz, rpy=rpy))
    return f'<robot name="r">{"".join(parts)}</robot>'


def test_half_a_turn_that_mirrored_limbs_have_too_explains_no_second_sign(tmp_path: Path) -> None:
    assert not find(tmp_path, make_hips("0.3 0.2 0"), "SYM004")
    (finding,) = find(tmp_path, make_hips("-0.3 0.2 0"), "SYM004")
    assert finding.message_id == "diagonal_turned"
    assert "HL_roll and HR_roll" in finding.message


@pytest.mark.parametrize(
    ("kind", "right", "found"),
    [
        ("fixed", "0 0.1 0.05", True),
        ("prismatic", "0 0.1 0.05", True),
        ("fixed", "0 -0.1 0.05", False),
        ("revolute", "0 0.1 0.05", False),  # the jaws of scissors
    ],
)
def test_a_left_and_a_right_part_are_not_one_inside_the_other(
    tmp_path: Path, kind: str, right: str, found: bool
) -> None:
    limit = '<limit lower="0" upper="0.03" effort="20" velocity="5"/>' if kind != "fixed" else ""
    parts = [
        f'<link name="{side}_part">{inertial(1.0, 0.1)}{BOX.format(z=0)}</link>'
        + joint(f"{side}_joint", "base", f"{side}_part", limit, kind=kind, xyz=xyz)
        for side, xyz in (("left", "0 0.1 0.05"), ("right", right))
    ]
    findings = find_slips(tmp_path, f'<robot name="r"><link name="base"/>{"".join(parts)}</robot>')
    assert ("coincident" in [finding.message_id for finding in findings]) == found


@pytest.mark.parametrize(("height", "count"), [(0.02, 0), (0.018, 0), (0.008, 1), (-0.006, 1)])
def test_fingers_that_are_drawn_as_mirror_images_are_in_place_whatever_their_frames_are(
    tmp_path: Path, height: float, count: int
) -> None:
    """The origins flip y and z, and the mesh of one side is moved along z in its frame."""
    parts = ["<link name='palm'/>"]
    for side, xyz, sign, z in (("left", "0 0.028 0.013", 1, -0.006), ("right", "0 -0.028 -0.013", -1, height)):
        bar, tip = (
            f'<visual><origin xyz="{x} {sign * y} {z + up}"/><geometry><box size="{size}"/></geometry></visual>'
            for x, y, up, size in ((0.01, 0.004, 0, "0.03 0.01 0.04"), (0.03, 0.009, 0.005, "0.02 0.006 0.01"))
        )
        parts.append(f'<link name="{side}_finger">{bar}{tip}</link>')
        parts.append(joint(f"{side}_slide", "palm", f"{side}_finger", LIMIT, kind="prismatic", xyz=xyz, axis="0 1 0"))
    found = find_slips(tmp_path, f'<robot name="r">{"".join(parts)}</robot>')
    assert [finding.message_id for finding in found] == ["diagonal"] * count


@pytest.mark.parametrize(("turn", "count"), [("0 0 3.14159265", 0), ("0 0 0", 1)])
def test_fingers_that_are_drawn_half_a_turn_apart_are_opposite_in_two_coordinates(
    tmp_path: Path, turn: str, count: int
) -> None:
    """The mesh is turned, and the frame is not."""
    parts = ["<link name='palm'/>"]
    for side, xyz, rpy, place in (
        ("left", "-0.024 0.045 -0.05", "0 0 0", "0.01 -0.04 -0.02"),
        ("right", "0.024 -0.045 -0.05", turn, "-0.01 0.04 -0.02" if count == 0 else "0.01 -0.04 -0.02"),
    ):
        bar, tip = (
            f'<visual><origin xyz="{at}" rpy="{rpy}"/><geometry><box size="{size}"/></geometry></visual>'
            for at, size in ((place, "0.03 0.01 0.06"), ("0 0 -0.08", "0.01 0.02 0.02"))
        )
        parts.append(f'<link name="{side}_tip">{bar}{tip}</link>')
        parts.append(joint(f"{side}_slide", "palm", f"{side}_tip", LIMIT, kind="prismatic", xyz=xyz, axis="0 1 0"))
    found = find_slips(tmp_path, f'<robot name="r">{"".join(parts)}</robot>')
    assert [finding.message_id for finding in found] == ["diagonal"] * count


@pytest.mark.parametrize(("turn", "count"), [("0", 1), ("3.14159265", 0)])
def test_fingers_whose_meshes_are_lacking_are_in_one_place_where_they_are_drawn_alike(
    tmp_path: Path, turn: str, count: int
) -> None:
    mesh = "<visual><origin rpy='0 0 {}'/><geometry><mesh filename='finger.obj'/></geometry></visual>"
    parts = [
        f"<link name='{side}_part'><inertial><origin xyz='0 0 0.05'/><mass value='0.1'/>"
        f"<inertia ixx='1e-3' ixy='0' ixz='0' iyy='1e-3' iyz='0' izz='1e-3'/></inertial>{mesh.format(angle)}</link>"
        + joint(f"{side}_joint", "base", f"{side}_part", LIMIT, kind="prismatic", xyz="0 0 0.1", axis="0 1 0")
        for side, angle in (("left", "0"), ("right", turn))
    ]
    found = find_slips(tmp_path, f'<robot name="r"><link name="base"/>{"".join(parts)}</robot>')
    assert [finding.message_id for finding in found] == ["coincident"] * count


@pytest.mark.parametrize(
    ("kind", "xyz", "severity", "words"),
    [
        ("prismatic", "0 0 0.08", Severity.INFO, "draw each on its own side"),
        ("fixed", "0 0 0.08", Severity.WARNING, "else move one of them to its place"),
        ("fixed", "0 0.1 0.08", Severity.WARNING, "should differ: y for left and right"),
    ],
)
def test_two_parts_in_one_place_are_moved_where_they_can_be(
    tmp_path: Path, kind: str, xyz: str, severity: Severity, words: str
) -> None:
    """Two fingers that slide apart are no leftover, and a zero has no sign."""
    limit = '<limit lower="0" upper="0.03" effort="20" velocity="5"/>' if kind != "fixed" else ""
    parts = [
        f'<link name="{side}_part">{inertial(1.0, 0.1)}{BOX.format(z=0)}</link>'
        + joint(f"{side}_joint", "base", f"{side}_part", limit, kind=kind, xyz=xyz, axis=axis)
        for side, axis in (("left", "0 1 0"), ("right", "0 -1 0"))
    ]
    found = find_slips(tmp_path, f'<robot name="r"><link name="base"/>{"".join(parts)}</robot>')
    (finding,) = [one for one in found if one.message_id == "coincident"]
    assert finding.severity is severity
    assert finding.fix is not None
    assert words in finding.fix.title
