"""JNT018: which origins are too far away, which unit is named, and when nothing is said."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import find, joint

from urdfcheck.core import Finding

PLACES = {"shoulder": "0 0 0.2", "elbow": "0.3 0 0", "wrist": "0.25 0.01 0", "flange": "0.08 0 0"}
BOXES = {
    "base": '<origin xyz="0 0 0.1"/><geometry><box size="0.1 0.1 0.2"/></geometry>',
    "upper": '<origin xyz="0.15 0 0"/><geometry><box size="0.3 0.05 0.05"/></geometry>',
    "fore": '<origin xyz="0.12 0 0"/><geometry><box size="0.25 0.05 0.05"/></geometry>',
    "hand": '<origin xyz="0.04 0 0"/><geometry><box size="0.08 0.05 0.05"/></geometry>',
    "tool": '<geometry><box size="0.04 0.04 0.04"/></geometry>',
}


def make_arm(*, drawn: bool = True, root: str = "base", boxes: dict[str, str] | None = None, **xyz: str) -> str:
    links = [
        f'<link name="{root if name == "base" else name}">{f"<visual>{box}</visual>" if drawn else ""}</link>'
        for name, box in (BOXES | (boxes or {})).items()
    ]
    chain = [root, *list(BOXES)[1:]]
    joints = [
        joint(name, chain[i], chain[i + 1], kind="fixed" if name == "flange" else "continuous", xyz=xyz.get(name, usual),
              axis="" if name == "flange" else "0 1 0")
        for i, (name, usual) in enumerate(PLACES.items())
    ]  # fmt: skip
    return f'<robot name="arm">{"".join(links)}{"".join(joints)}</robot>'


def find_far(tmp_path: Path, text: str) -> list[Finding]:
    return find(tmp_path, text, "JNT018")


def test_a_sound_arm_is_fine(tmp_path: Path) -> None:
    assert not find_far(tmp_path, make_arm())
    assert not find_far(tmp_path, make_arm(drawn=False))


@pytest.mark.parametrize(
    ("name", "typed", "true"), [("elbow", "300 0 0", "0.300 0 0"), ("wrist", "250 10 0", "0.250 0.010 0")]
)
def test_millimetres_are_named_and_repaired(tmp_path: Path, name: str, typed: str, true: str) -> None:
    (finding,) = find_far(tmp_path, make_arm(**{name: typed}))
    assert finding.location.subject == f"joint[{name}]/origin@xyz"
    assert finding.cause is not None
    assert "in mm." in finding.cause.text
    assert finding.fix is not None
    assert [(edit.expected, edit.replacement) for edit in finding.fix.edits] == [(typed, true)]


def test_without_shapes_the_unit_is_named_and_nothing_is_edited(tmp_path: Path) -> None:
    (finding,) = find_far(tmp_path, make_arm(drawn=False, elbow="300 0 0"))
    assert finding.cause is not None
    assert "in mm." in finding.cause.text
    assert finding.fix is None or not finding.fix.edits


def test_several_units_that_fit_are_all_named(tmp_path: Path) -> None:
    (finding,) = find_far(tmp_path, make_arm(wrist="20 0 0"))
    assert finding.cause is not None
    assert "in mm or cm" in finding.cause.text
    assert finding.fix is None or not finding.fix.edits


def test_all_origins_in_millimetres_are_one_finding(tmp_path: Path) -> None:
    (finding,) = find_far(tmp_path, make_arm(shoulder="0 0 200", elbow="300 0 0", wrist="250 10 0", flange="80 0 0"))
    assert finding.message_id == "parts"
    assert len(finding.subjects) == 4
    assert finding.fix is not None
    assert [edit.replacement for edit in finding.fix.edits] == ["0 0 0.200", "0.300 0 0", "0.250 0.010 0", "0.080 0 0"]


def test_a_frame_far_away_from_its_part_is_meant(tmp_path: Path) -> None:
    back = '<origin xyz="-299.8 0 0"/><geometry><box size="0.25 0.05 0.05"/></geometry>'
    forth = '<origin xyz="-299.9 0 0"/><geometry><box size="0.08 0.05 0.05"/></geometry>'
    boxes = {"fore": back, "hand": forth, "tool": forth}
    assert not find_far(tmp_path, make_arm(boxes=boxes, elbow="300 0 0"))


def test_a_scene_is_as_large_as_it_is(tmp_path: Path) -> None:
    assert find_far(tmp_path, make_arm(root="pedestal", shoulder="0 0 200"))
    assert not find_far(tmp_path, make_arm(root="world", boxes={"base": ""}, drawn=False, shoulder="0 0 200"))


def test_a_camera_on_a_mast_is_meant(tmp_path: Path) -> None:
    assert not find_far(tmp_path, make_arm(flange="0 0 4"))
    assert find_far(tmp_path, make_arm(flange="0 0 80"))


def test_two_short_joints_do_not_say_how_large_the_robot_is(tmp_path: Path) -> None:
    text = make_arm(drawn=False, shoulder="0 0 0", elbow="5 0 0", wrist="0.1 0 0", flange="0.1 0 0")
    assert not find_far(tmp_path, text)


def test_the_twin_shows_which_coordinate_slipped(tmp_path: Path) -> None:
    names = {
        "left": ("0.2 10 0.1", "left_wheel"),
        "right": ("0.2 -0.1 0.1", "right_wheel"),
        "front": ("0.3 0 0", "bumper"),
    }
    joints = [
        joint(f"{name}_joint", "base", link, kind="continuous", xyz=xyz, axis="0 1 0")
        for name, (xyz, link) in names.items()
    ]
    joints.append(joint("rear_caster", "base", "caster", kind="continuous", xyz="-0.2 0 0", axis="0 1 0"))
    links = f"""<link name="base"><visual>{BOXES["base"]}</visual></link>""" + "".join(
        f"""<link name="{link}"/>""" for link in ("left_wheel", "right_wheel", "bumper", "caster")
    )
    (finding,) = find_far(tmp_path, f'<robot name="r">{links}{"".join(joints)}</robot>')
    assert finding.cause is not None
    assert finding.cause.id == "twin"
    assert finding.fix is not None
    assert [(edit.expected, edit.replacement) for edit in finding.fix.edits] == [("0.2 10 0.1", "0.2 0.10 0.1")]


def test_a_robot_is_not_ten_metres_above_its_footprint(tmp_path: Path) -> None:
    for root, count in (("base_footprint", 1), ("stand", 0), ("world", 0)):
        text = make_arm(root="base").replace('<link name="base">', f'<link name="{root}"/><link name="base">', 1)
        text = text.replace("</robot>", joint("ground", root, "base", kind="fixed", xyz="0 0 10") + "</robot>")
        (tmp_path / root).mkdir()
        assert len(find_far(tmp_path / root, text)) == count


@pytest.mark.parametrize(("com", "count"), [("0 0 0", 1), ("-2 0 0", 0)])
def test_without_shapes_a_com_beyond_shows_that_no_shaft_is_between(tmp_path: Path, com: str, count: int) -> None:
    tensor = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
    inertial = f'<inertial><origin xyz="{{}}"/><mass value="1"/>{tensor}</inertial>'
    text = make_arm(drawn=False, elbow="4 0 0")
    for name in BOXES:
        own = inertial.format(com if name == "fore" else "0 0 0")
        text = text.replace(f'<link name="{name}"></link>', f'<link name="{name}">{own}</link>')
    assert len(find_far(tmp_path, text)) == count


@pytest.mark.parametrize(("far", "count"), [("8 0 0", 1), ("4 0 0", 0)])
def test_a_fixed_part_is_far_if_it_is_drawn(tmp_path: Path, far: str, count: int) -> None:
    assert len(find_far(tmp_path, make_arm(flange=far))) == count


@pytest.mark.parametrize(("name", "count"), [("elbow", 1), ("wrist", 1), ("turn", 0)])
def test_in_an_arm_of_which_nothing_is_known_ten_times_is_enough_before_another_joint(
    tmp_path: Path, name: str, count: int
) -> None:
    chain = {"shoulder": "0 0 0.2", "elbow": "0.3 0 0", "wrist": "0.25 0 0", "bend": "0.1 0 0", "turn": "0.08 0 0"}
    places = list((chain | {name: "4 0 0"}).items())
    joints = [
        joint(one, f"p{i}", f"p{i + 1}", kind="continuous", xyz=xyz, axis="0 1 0")
        for i, (one, xyz) in enumerate(places)
    ]
    mesh = '<visual><geometry><mesh filename="package://arm/meshes/part.stl"/></geometry></visual>'
    links = [f'<link name="p{i}">{mesh}</link>' for i in range(len(places) + 1)]
    assert len(find_far(tmp_path, f'<robot name="arm">{"".join(links)}{"".join(joints)}</robot>')) == count
