"""Links and joints that came, went, were renamed or attached elsewhere; and what only looks like it."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import pytest
from versions import ARM, compare_texts

from urdfcheck.core.model_diff import Diff, MechanismChange, ModelDiff
from urdfcheck.output.changes.text import render as render_text


def list_changes(found: ModelDiff) -> list[tuple[str, str]]:
    assert found.mechanism is not None
    return [(change.id, change.subject) for change in found.mechanism.changes]


def get_change(found: ModelDiff, name: str) -> MechanismChange:
    assert found.mechanism is not None
    return next(change for change in found.mechanism.changes if change.id == name)


def add(*parts: str) -> str:
    return ARM.replace("</robot>", "".join(parts) + "</robot>")


def test_a_renamed_link_is_matched_and_its_old_name_found(tmp_path: Path) -> None:
    """The plugin still has the old name; nothing moves."""
    changed = ARM.replace('<link name="hand">', '<link name="gripper">').replace('link="hand"', 'link="gripper"')
    for before, after, old, new, users in (
        (ARM, changed, "hand", "gripper", "gazebo[hand]"),
        (changed, ARM, "gripper", "hand", ""),
    ):
        found = compare_texts(tmp_path, before, after)
        assert list_changes(found) == [("link-renamed", f"link[{old}]")]
        change = get_change(found, "link-renamed")
        assert (change.new_name, change.words["users"]) == (new, users)
        assert change.numbers["confidence"] == pytest.approx(1.0)
        assert found.verdict == "structure"
        assert found.mechanism is not None
        assert found.mechanism.shifts == ()
        assert ("the old name is still used by gazebo[hand]" in found.texts[0]) == bool(users)


def test_a_prefix_renames_everything_and_moves_nothing(tmp_path: Path) -> None:
    changed = re.sub(r'(name|link|joint|reference)="(\w+)"', r'\1="left_\2"', ARM).replace("left_arm", "arm")
    found = compare_texts(tmp_path, ARM, changed)
    names = set(re.findall(r'<link name="(\w+)"', ARM))
    renamed = {subject for what, subject in list_changes(found) if what == "link-renamed"}
    assert renamed == {f"link[{name}]" for name in names}
    assert {what for what, _ in list_changes(found)} <= {
        "link-renamed",
        "joint-renamed",
        "extra-added",
        "extra-removed",
    }
    assert found.mechanism is not None
    assert found.mechanism.shifts == ()


def test_a_renamed_link_that_changed_has_a_smaller_confidence(tmp_path: Path) -> None:
    changed = ARM.replace('<link name="camera">', '<link name="eye">').replace('link="camera"', 'link="eye"')
    changed = changed.replace('<mass value="0.2"/>', '<mass value="0.3"/>')
    found = compare_texts(tmp_path, ARM, changed)
    assert list_changes(found) == [("link-renamed", "link[camera]"), ("mass", "link[camera]")]
    assert 0.6 <= get_change(found, "link-renamed").numbers["confidence"] < 1.0
    assert "matched by place and content" in found.texts[0]


def test_two_that_are_alike_are_told_apart_by_place_or_not_at_all(tmp_path: Path) -> None:
    """Two fingers swap nothing: each new name is at the place of its old one."""
    changed = ARM
    for old, new in (("left", "finger_a"), ("right", "finger_b")):
        changed = changed.replace(f'"{old}"', f'"{new}"')
    found = compare_texts(tmp_path, ARM, changed)
    assert found.mechanism is not None
    renamed = {c.subject: c.new_name for c in found.mechanism.changes if c.id == "link-renamed"}
    assert renamed == {"link[left]": "finger_a", "link[right]": "finger_b"}


def test_a_renamed_joint_moves_alike(tmp_path: Path) -> None:
    found = compare_texts(tmp_path, ARM, ARM.replace('"elbow"', '"joint_2"'))
    assert list_changes(found) == [("joint-renamed", "joint[elbow]")]
    # A leader that is renamed without its follower leaves that one behind.
    found = compare_texts(tmp_path, ARM, ARM.replace('<joint name="grip"', '<joint name="grasp"'))
    assert list_changes(found) == [("joint-renamed", "joint[grip]"), ("mimic", "joint[grip_mirror]")]
    assert get_change(found, "joint-renamed").words["users"] == "mimic of joint[grip_mirror]"


def test_a_new_branch_is_one_change(tmp_path: Path) -> None:
    branch = (
        '<link name="arm2"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
        "</link>\n"
        '<link name="tip2"/>\n<joint name="j2" type="revolute"><parent link="base"/><child link="arm2"/>'
        '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>\n'
        '<joint name="j3" type="fixed"><parent link="arm2"/><child link="tip2"/></joint>\n'
    )
    there, back = compare_texts(tmp_path / "a", ARM, add(branch)), compare_texts(tmp_path / "b", add(branch), ARM)
    assert list_changes(there) == [("link-added", "link[arm2]")]
    assert list_changes(back) == [("link-removed", "link[arm2]")]
    assert there.texts[0] == "link arm2 is new with tip2 (revolute joint j2 on base, 1 kg)"
    assert there.headline.startswith("structure changes: link arm2 is new")
    assert there.mechanism is not None
    assert (there.mechanism.shifts, [t.joint for t in there.mechanism.torques]) == ((), [])


def test_a_frame_that_others_use_is_not_only_a_note(tmp_path: Path) -> None:
    frame = '<link name="tcp"/><joint name="t" type="fixed"><parent link="hand"/><child link="tcp"/></joint>\n'
    assert list_changes(compare_texts(tmp_path, ARM, add(frame))) == [("link-added", "link[tcp]")]


def test_a_split_link_that_weighs_more_is_a_change(tmp_path: Path) -> None:
    part = (
        '<link name="cover"><inertial><mass value="0.1"/><inertia ixx="1e-5" ixy="0" ixz="0" iyy="1e-5" iyz="0" izz="1e-5"/>'
        '</inertial></link><joint name="c" type="fixed"><parent link="hand"/><child link="cover"/></joint>\n'
    )
    assert list_changes(compare_texts(tmp_path, ARM, add(part))) == [("link-added", "link[cover]")]


def test_a_link_on_another_parent(tmp_path: Path) -> None:
    """The camera at the same place, on the upper arm: it no longer follows the elbow."""
    changed = ARM.replace(
        '<parent link="fore"/>\n    <child link="camera"/>', '<parent link="upper"/>\n    <child link="camera"/>'
    )
    found = compare_texts(tmp_path, ARM, changed)
    assert ("reparented", "link[camera]") in list_changes(found)
    assert "link camera is attached to upper instead of fore" in found.texts
    assert found.mechanism is not None
    assert {shift.link for shift in found.mechanism.shifts} == {"camera"}


def test_a_base_that_is_held_is_a_change(tmp_path: Path) -> None:
    held = add(
        '<link name="world"/><joint name="hold" type="fixed"><parent link="world"/><child link="base"/></joint>\n'
    )
    there, back = compare_texts(tmp_path / "a", ARM, held), compare_texts(tmp_path / "b", held, ARM)
    assert list_changes(there) == [("base", "link[base]")]
    assert list_changes(back) == [("base", "link[world]")]
    assert "is held to the ground now" in there.headline
    assert "no longer holds the robot to the ground" in back.headline
    footprint = held.replace('"world"', '"base_footprint"')
    assert list_changes(compare_texts(tmp_path / "c", ARM, footprint)) == [("root", "link[base]")]


def test_a_joint_in_between_leaves_what_is_behind_it(tmp_path: Path) -> None:
    """A pan joint below the camera, which stays where it is at zero."""
    changed = ARM.replace(
        '<parent link="fore"/>\n    <child link="camera"/>', '<parent link="pan_link"/>\n    <child link="camera"/>'
    ).replace('<origin xyz="0.1 0 0.05" rpy="0.1 0.2 0.3"/>', '<origin xyz="0 0 0" rpy="0 0 0"/>')
    changed = changed.replace(
        "</robot>",
        '<link name="pan_link"/><joint name="pan2" type="revolute"><origin xyz="0.1 0 0.05" rpy="0.1 0.2 0.3"/>'
        '<parent link="fore"/><child link="pan_link"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>\n</robot>',
    )
    found = compare_texts(tmp_path, ARM, changed)
    assert set(list_changes(found)) == {("link-added", "link[pan_link]"), ("reparented", "link[camera]")}
    assert found.mechanism is not None
    assert found.mechanism.shifts == ()  # the new joint at zero


def test_links_that_are_renamed_from_the_root_on_are_matched_by_their_joints(tmp_path: Path) -> None:
    """Every link has another name, and the root another mass: nothing else is new or gone."""
    changed = ARM
    for name in ("base", "upper", "fore", "camera", "hand", "left", "right", "tool0"):
        changed = changed.replace(f'link name="{name}"', f'link name="{name}_link"')
        changed = changed.replace(f'link="{name}"', f'link="{name}_link"').replace(f'="{name}">', f'="{name}_link">')
    found = compare_texts(tmp_path, ARM, changed.replace('mass value="4.0"', 'mass value="5.0"'))
    assert list_changes(found)[0] == ("link-renamed", "link[base]")  # from the root outwards
    lines = render_text(Diff(before="a", after="b", models=(found,))).splitlines()
    names = "base → base_link, upper → upper_link, fore → fore_link and 5 more"
    assert lines[1] == f"  structure  links have other names: {names} (matched by place and content, each at least 75%)"
    assert Counter(name for name, _ in list_changes(found) if not name.startswith("extra-")) == {
        "link-renamed": 8,
        "mass": 1,
    }


def test_another_robot_is_not_another_root_alone(tmp_path: Path) -> None:
    other = (
        '<robot name="arm"><link name="foot"/><link name="leg"><inertial><mass value="3"/><inertia ixx="1" ixy="0" ixz="0" '
        'iyy="1" iyz="0" izz="1"/></inertial></link><joint name="ankle" type="fixed"><parent link="foot"/><child link="leg"/>'
        "</joint></robot>"
    )
    found = compare_texts(tmp_path, ARM, other)
    assert {("root", "link[base]"), ("link-removed", "link[upper]"), ("link-added", "link[leg]")} <= set(
        list_changes(found)
    )
    assert found.headline.startswith("structure changes: another root, 1 link added, 1 link removed")
