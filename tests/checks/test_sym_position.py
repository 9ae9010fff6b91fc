"""SYM002: which joint is misplaced, which word is edited, and when nothing is said."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import find, joint
from conftest import check_text

from urdfcheck.core import Finding
from urdfcheck.facts.motion.kinematics import rpy_to_matrix

WHEEL = (
    '<inertial><origin xyz="{com}"/><mass value="0.03"/>'
    '<inertia ixx="6.6e-6" ixy="0" ixz="0" iyy="1.27e-5" iyz="0" izz="6.6e-6"/></inertial>'
)
CORNERS = {
    "front_left": "0.07 0.052 0",
    "rear_left": "-0.07 0.052 0",
    "rear_right": "-0.07 -0.052 0",
    "front_right": "0.07 -0.052 0",
}


def make_joint_on_base(
    name: str, child: str, xyz: str, *, parent: str = "base", kind: str = "continuous", rpy: str = "0 0 0"
) -> str:
    return joint(name, parent, child, kind=kind, xyz=xyz, rpy=rpy, axis="" if kind == "fixed" else "0 1 0")


def car(com: dict[str, str] | None = None, *, base: str = "0 0 0", scale: float = 1.0, **xyz: str) -> str:
    """Four wheels on the corners of a rectangle, some at another xyz or with another COM, on a base that is turned."""
    parts = [
        '<link name="world"/><link name="base"/>',
        make_joint_on_base("to_world", "base", "0.3 0.1 0", parent="world", kind="fixed", rpy=base),
    ]
    for name, usual in CORNERS.items():
        place = " ".join(f"{float(word) * scale:.6g}" if scale != 1 else word for word in xyz.get(name, usual).split())
        parts.append(f'<link name="{name}_wheel">{WHEEL.format(com=(com or {}).get(name, "0 0.001 0"))}</link>')
        parts.append(make_joint_on_base(name, f"{name}_wheel", place))
    return f'<robot name="car">{"".join(parts)}</robot>'


def edits(finding: Finding) -> list[tuple[str, str]]:
    assert finding.fix is not None
    return [(e.expected, e.replacement) for e in finding.fix.edits]


def test_wheels_on_a_rectangle_are_fine(tmp_path: Path) -> None:
    assert not find(tmp_path, car(), "SYM002")


@pytest.mark.parametrize(("shift", "found"), [("0 0 0", True), ("-0.002 0 0", False)])
def test_what_is_drawn_in_its_place_is_not_off(tmp_path: Path, shift: str, found: bool) -> None:
    """All COMs are typed alike; only the drawing shows whether the wheel is elsewhere."""
    visual = '<visual><origin xyz="{}"/><geometry><box size="0.03 0.01 0.03"/></geometry></visual>'
    text = car(front_left="0.072 0.052 0")
    for name in CORNERS:
        head, mark, tail = text.partition(f'<link name="{name}_wheel">')
        text = head + mark + visual.format(shift if name == "front_left" else "0 0 0") + tail
    assert bool(find(tmp_path, text, "SYM002")) == found


@pytest.mark.parametrize("name", CORNERS)
def test_each_wheel_is_named_and_only_the_wrong_word_is_edited(tmp_path: Path, name: str) -> None:
    x, y, _ = CORNERS[name].split()
    (finding,) = find(tmp_path, car(**{name: f"{x.replace('7', '72')} {y} 0"}), "SYM002")
    assert finding.location.subject == f"joint[{name}]/origin@xyz"
    assert edits(finding) == [(x.replace("7", "72"), x)]
    assert finding.data["off"] == pytest.approx(2.0, abs=1e-3)
    assert f"2 mm along {'-' if x.startswith('-') else '+'}x of base" in finding.message
    assert "the corners of a rectangle of 140 mm by 104 mm" in finding.message


def test_the_repair_repairs_it(tmp_path: Path) -> None:
    (finding,) = find(tmp_path / "a", car(front_left="0.0712 0.0502 0.0031"), "SYM002")
    ((old, new),) = [("0.0712 0.0502 0.0031", " ".join(new for _, new in edits(finding)))]
    assert new == "0.07 0.052 0"
    assert not find(tmp_path / "b", car(front_left="0.0712 0.0502 0.0031").replace(old, new), "SYM002")


def test_a_base_that_is_turned_and_a_robot_of_another_size_change_nothing(tmp_path: Path) -> None:
    for i, changed in enumerate(
        (car(front_left="0.072 0.0535 0", base="0.3 -0.8 2"), car(front_left="0.072 0.0535 0", scale=20.0))
    ):
        (finding,) = find(tmp_path / str(i), changed, "SYM002")
        assert finding.location.subject == "joint[front_left]/origin@xyz"


@pytest.mark.parametrize("xyz", ["0.0701 0.052 0", "0.07 0.1 0", "0.16 0.052 0"])
def test_rounding_and_other_places_are_meant(tmp_path: Path, xyz: str) -> None:
    assert not find(tmp_path, car(front_left=xyz), "SYM002")


def test_a_frame_elsewhere_on_the_axis_is_a_choice_of_frame(tmp_path: Path) -> None:
    moved = {"front_left": "0 -0.004 0"}
    assert not find(tmp_path / "a", car(moved, front_left="0.07 0.057 0"), "SYM002")
    assert find(tmp_path / "b", car(front_left="0.07 0.057 0"), "SYM002")


def test_two_wheels_that_are_off_leave_nobody_to_blame(tmp_path: Path) -> None:
    assert not find(tmp_path, car(front_left="0.073 0.05 0", rear_right="-0.071 -0.055 0"), "SYM002")


def legs(*, mount: str = "", own: str = "", hip: str = "", literal: bool = True) -> str:
    """Four legs, each on a mount that is fixed to the base; the first one has other numbers. Thighs hang on hips."""
    parts = ['<link name="base"/>']
    for name, xyz in CORNERS.items():
        first = name == "front_left"
        parts.append(f'<link name="{name}_mount"/>')
        parts.append(
            make_joint_on_base(f"{name}_bolts", f"{name}_mount", mount if mount and first else xyz, kind="fixed")
        )
        parts.append(f'<link name="{name}_hip">{WHEEL.format(com="0 0 0.01")}</link>')
        parts.append(
            make_joint_on_base(
                name, f"{name}_hip", own if own and first else "0 0 0.01", parent=f"{name}_mount", kind="revolute"
            )
        )
        parts.append(f'<link name="{name}_thigh">{WHEEL.format(com="0 0 -0.05")}</link>')
        reach = hip if hip and first else "0 0 -0.02"
        parts.append(make_joint_on_base(f"{name}_knee", f"{name}_thigh", reach, parent=f"{name}_hip", kind="revolute"))
    return f'<robot name="dog">{"".join(parts)}</robot>'


def test_the_mount_is_named_when_it_is_what_stands_elsewhere(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, legs(mount="0.073 0.05 0"), "SYM002")
    assert (finding.message_id, finding.location.subject) == ("mount", "joint[front_left_bolts]/origin@xyz")
    assert edits(finding) == [("0.073", "0.07"), ("0.05", "0.052")]


def test_the_joint_is_named_when_the_mounts_are_alike(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, legs(own="0.003 0.001 0.01"), "SYM002")
    assert (finding.message_id, finding.location.subject) == ("misplaced", "joint[front_left]/origin@xyz")
    assert edits(finding) == [("0.003", "0"), ("0.001", "0")]


def test_what_hangs_on_a_misplaced_joint_is_not_reported_again(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, legs(hip="0.002 0.001 -0.02"), "SYM002")
    assert finding.location.subject == "joint[front_left_knee]/origin@xyz"


def test_what_hangs_on_a_joint_that_is_turned_stands_where_its_siblings_do(tmp_path: Path) -> None:
    turned = legs().replace('<origin xyz="0 0 0.01" rpy="0 0 0"/>', '<origin xyz="0 0 0.01" rpy="0 0.2 0"/>', 1)
    assert find(tmp_path / "a", turned, "SYM001")
    assert not find(tmp_path / "b", turned, "SYM002")


def test_the_mirror_image_of_a_misplaced_wheel_is_not_blamed(tmp_path: Path) -> None:
    arms = "".join(
        f'<link name="{side}_arm">{WHEEL.format(com="0 0 0")}</link>'
        + make_joint_on_base(f"{side}_arm", f"{side}_arm", f"0 {y} 0.1", kind="revolute")
        for side, y in (("left", 0.03), ("right", -0.03))
    )
    alike = car(rear_left="-0.072 0.052 0").replace("</robot>", arms + "</robot>")
    (guilty,) = find(tmp_path / "alike", alike, "SYM004")  # four wheels of one name show the odd one
    assert guilty.location.subject == "joint[rear_left]/origin@xyz"
    text = alike.replace("front_", "driven_").replace("rear_", "idle_")
    (innocent,) = find(tmp_path / "a", text, "SYM004")
    assert innocent.location.subject == "joint[idle_right]/origin@xyz"
    (finding,) = check_text(tmp_path / "b", text, codes={"SYM002", "SYM004"}).findings
    assert (finding.code, finding.location.subject) == ("SYM002", "joint[idle_left]/origin@xyz")
    assert finding.data["hides"] == ["SYM004"]


def drawn(text: str) -> str:
    wheel = '<visual><origin rpy="1.5708 0 0"/><geometry><cylinder radius="0.03" length="0.01"/></geometry></visual>'
    return text.replace("</inertial>", f"</inertial>{wheel}")


def wheels(folder: Path, text: str) -> dict[str, str]:
    """The code for each joint that is named."""
    codes = {"SYM002", "SYM004", "SYM006"}
    return {f.location.subject.split("/")[0]: f.code for f in check_text(folder, text, codes=codes).findings}


@pytest.mark.parametrize("name", CORNERS)
def test_a_wheel_that_is_too_high_hangs_in_the_air(tmp_path: Path, name: str) -> None:
    text = drawn(car(**{name: CORNERS[name][:-1] + "0.003"}))
    assert wheels(tmp_path, text) == {f"joint[{name}]": "SYM006"}


@pytest.mark.parametrize(
    ("z", "said"), [("0.003", "3 mm too high (3 mm along +z"), ("-0.003", "3 mm too low (3 mm along -z")]
)
def test_a_part_that_is_no_wheel_to_stand_on_is_too_high_all_the_same(tmp_path: Path, z: str, said: str) -> None:
    """Nothing is drawn here that could touch the ground."""
    (finding,) = find(tmp_path, car(front_left=f"0.07 0.052 {z}"), "SYM002")
    assert said in finding.message


def test_the_height_of_a_wheel_that_hangs_in_the_air_is_nobodys_layout(tmp_path: Path) -> None:
    text = drawn(car(front_left="0.07 0.052 0.003", rear_left="-0.068 0.052 0"))
    assert wheels(tmp_path / "a", text) == {"joint[front_left]": "SYM006", "joint[rear_left]": "SYM002"}
    (finding,) = find(tmp_path / "b", text, "SYM002")
    assert edits(finding) == [("-0.068", "-0.07")]


def test_a_wheel_that_is_off_in_every_direction_is_one_finding(tmp_path: Path) -> None:
    text = drawn(car(front_left="0.072 0.052 0.003"))
    assert wheels(tmp_path / "a", text) == {"joint[front_left]": "SYM002"}
    (finding,) = find(tmp_path / "b", text, "SYM002")
    assert edits(finding) == [("0.072", "0.07"), ("0.003", "0")]


def test_a_computed_place_leads_to_what_it_is_computed_from(tmp_path: Path) -> None:
    head = '<robot name="car" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:property name="reach" value="0.072"/>'
    text = car(front_left="${reach} 0.052 0").replace('<robot name="car">', head)
    (finding,) = find(tmp_path, text, "SYM002", name="robot.urdf.xacro")
    assert finding.message_id == "computed"
    assert not edits(finding)
    assert finding.fix is not None
    assert "make `${reach} 0.052 0` give `0.07 0.052 0`" in finding.fix.title
    assert "property reach (line 1" in finding.fix.title


@pytest.mark.parametrize("count", [5, 6])
def test_a_rotor_beside_its_ring_is_named(tmp_path: Path, count: int) -> None:
    parts = ['<link name="base"/>']
    for i in range(count):
        x, y, _ = rpy_to_matrix((0, 0, 6.283185307179586 * i / count))[:, 0] * (0.31 if i == 2 else 0.3)
        parts.append(f'<link name="blade_{i}">{WHEEL.format(com="0 0 0")}</link>')
        parts.append(make_joint_on_base(f"rotor_{i}", f"blade_{i}", f"{x:.5f} {y:.5f} 0.05"))
    (finding,) = find(tmp_path, f'<robot name="drone">{"".join(parts)}</robot>', "SYM002")
    assert finding.location.subject == "joint[rotor_2]/origin@xyz"
    assert finding.data["off"] == pytest.approx(10.0, abs=0.01)


@pytest.mark.parametrize(("drawn_at", "message"), [(0.073, "drawn"), (0.07, "misplaced")])
def test_a_wheel_is_not_taken_out_of_the_fork_that_its_parent_draws(
    tmp_path: Path, drawn_at: float, message: str
) -> None:
    """Each fork is a triangle beside its wheel."""
    lines, faces = [], []
    for name, place in CORNERS.items():
        x, y, z = map(float, place.split())
        x = drawn_at if name == "front_left" else x
        lines += [f"v {x + dx} {y * 0.9} {z + dz}" for dx, dz in ((0, 0), (0.004, 0.02), (-0.004, 0.02))]
        faces.append(f"f {len(lines) - 2} {len(lines) - 1} {len(lines)}")
    shape = '<link name="base"><visual><geometry><mesh filename="forks.obj"/></geometry></visual></link>'
    text = car(front_left="0.073 0.052 0").replace('<link name="base"/>', shape)
    (finding,) = find(tmp_path, {"robot.urdf": text, "forks.obj": "\n".join((*lines, *faces))}, "SYM002")
    assert finding.message_id == message
    assert bool(edits(finding)) == (message == "misplaced")


def test_a_wheel_that_is_off_in_other_directions_too_is_not_edited(tmp_path: Path) -> None:
    straight, askew = (drawn(car(front_left=xyz)) for xyz in ("0.07 0.052 0.003", "0.075 0.056 0.003"))
    (finding,) = find(tmp_path / "a", straight, "SYM006")
    assert edits(finding) == [("0.07 0.052 0.003", "0.07 0.052 0")]
    (finding,) = find(tmp_path / "b", askew, "SYM006")
    assert finding.fix is not None
    assert not finding.fix.edits
