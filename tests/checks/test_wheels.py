"""Wheels and standing: what rolls which way, touches the ground, turns about its own axis, and whether it stays upright.

The robots are computed from a few numbers, so that the same one can be written with other frames, sizes and names.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from builders import find, joint, limit, link, robot, visual
from conftest import FIXTURES, check, check_text
from numpy.typing import NDArray

from urdfcheck.core import Finding, Severity
from urdfcheck.facts.motion.kinematics import matrix_to_rpy, rpy_to_matrix

pytestmark = pytest.mark.slow

Array = NDArray[np.float64]
# Of a cylinder along z, so that it lies along y.
ACROSS = rpy_to_matrix((np.pi / 2, 0, 0))
CODES = {"SYM005", "SYM006", "JNT015", "DYN004"}


@dataclass(frozen=True)
class Wheel:
    """A disc at ``place`` (m, root frame), round about y, that its joint turns about ``axis`` (None: not typed)."""

    name: str
    place: tuple[float, float, float]
    radius: float = 0.05
    axis: tuple[float, float, float] | None = (0, 1, 0)
    spin: int = 1
    offset: float = 0.0
    kind: str = "continuous"


@dataclass(frozen=True)
class Car:
    """A box with its COM at ``com`` and some wheels. ``frame`` turns every wheel's frame, ``root`` places the box in the root."""

    wheels: tuple[Wheel, ...]
    com: tuple[float, float, float] = (0.0, 0.0, 0.05)
    scale: float = 1.0
    frame: tuple[float, float, float] = (0.0, 0.0, 0.0)
    root: tuple[tuple[float, float, float], float] | None = None
    caster: tuple[float, float, float] | None = None
    prefix: str = ""

    def text(self) -> str:
        name, size = self.prefix, self.scale
        parts = [
            f'<link name="{name}base">{make_sized_inertial(5, self.com, (0.02, 0.02, 0.03), np.eye(3), size)}'
            f'<visual><origin xyz="{numbers((0, 0, 0.08), size)}"/><geometry>'
            f'<box size="{numbers((0.5, 0.2, 0.06), size)}"/></geometry></visual></link>'
        ]
        turn = rpy_to_matrix(self.frame)
        for wheel in self.wheels:
            spin = np.where(np.arange(3) == wheel.spin, 5e-4, 2.6e-4)
            axis = "" if wheel.axis is None else f'<axis xyz="{numbers(turn.T @ np.array(wheel.axis))}"/>'
            parts.append(
                f'<joint name="{name}{wheel.name}_joint" type="{wheel.kind}"><parent link="{name}base"/>'
                f'<child link="{name}{wheel.name}"/>{origin(wheel.place, turn, size)}{axis}</joint>'
                f'<link name="{name}{wheel.name}">{make_sized_inertial(0.4, (0, 0, 0), spin, turn.T, size)}<visual>'
                f"{origin(turn.T @ (wheel.offset, 0, 0), turn.T @ ACROSS, size)}<geometry>"
                f'<cylinder radius="{wheel.radius * size:.12g}" length="{0.02 * size:.12g}"/></geometry></visual></link>'
            )
        if self.caster is not None:
            parts.append(
                f'<joint name="{name}caster_joint" type="fixed"><parent link="{name}base"/><child link="{name}caster"/>'
                f'{origin(self.caster, np.eye(3), size)}</joint><link name="{name}caster"><visual><geometry>'
                f'<sphere radius="{0.02 * size:.12g}"/></geometry></visual></link>'
            )
        if self.root is not None:
            place, yaw = self.root
            parts.append(
                f'<link name="{name}footprint"/><joint name="{name}foot" type="fixed"><parent link="{name}footprint"/>'
                f'<child link="{name}base"/>{origin(place, rpy_to_matrix((0, 0, yaw)), size)}</joint>'
            )
        return f'<robot name="{name}car">{"".join(parts)}</robot>'


def numbers(values: object, size: float = 1.0) -> str:
    return " ".join(f"{round(float(v) * size, 9) + 0.0:.12g}" for v in np.asarray(values))


def origin(place: object, turn: Array, size: float = 1.0) -> str:
    rpy = " ".join(f"{round(angle, 12) + 0.0:.12g}" for angle in matrix_to_rpy(turn))
    return f'<origin xyz="{numbers(place, size)}" rpy="{rpy}"/>'


def make_sized_inertial(mass: float, com: object, moments: object, turn: Array, size: float) -> str:
    xx, yy, zz = np.asarray(moments) * size**2
    return (
        f'<inertial>{origin(com, turn, size)}<mass value="{mass}"/>'
        f'<inertia ixx="{xx:.12g}" ixy="0" ixz="0" iyy="{yy:.12g}" iyz="0" izz="{zz:.12g}"/></inertial>'
    )


CORNERS = (
    Wheel("front_left_wheel", (0.2, 0.12, 0)),
    Wheel("rear_left_wheel", (-0.2, 0.12, 0)),
    Wheel("rear_right_wheel", (-0.2, -0.12, 0)),
    Wheel("front_right_wheel", (0.2, -0.12, 0)),
)
PAIR = (Wheel("left_wheel", (0, 0.12, 0)), Wheel("right_wheel", (0, -0.12, 0)))
FOUR = Car(CORNERS)
# Two wheels and a caster ahead, on the same ground.
THREE = Car(PAIR, com=(0.08, 0, 0.05), caster=(0.2, 0, -0.03))


def changed(car: Car, index: int, **fields: object) -> Car:
    """The car with another value in one of its wheels."""
    wheels = [replace(w, **fields) if i == index else w for i, w in enumerate(car.wheels)]  # type: ignore[arg-type]
    return replace(car, wheels=tuple(wheels))


def find_in_car(folder: Path, code: str, car: Car | str) -> list[Finding]:
    return find(folder, car if isinstance(car, str) else car.text(), code)


def edits(finding: Finding) -> list[tuple[str, str]]:
    assert finding.fix is not None
    return [(e.expected, e.replacement) for e in finding.fix.edits]


def text_of(car: Car, old: str, new: str) -> str:
    text = car.text()
    assert old in text
    return text.replace(old, new)


@pytest.mark.parametrize("car", [FOUR, THREE], ids=["four", "three"])
def test_sound_robots_are_fine(tmp_path: Path, car: Car) -> None:
    assert not check_text(tmp_path, car.text(), codes=CODES).findings


def test_car_3_rolls_and_stands(tmp_path: Path) -> None:
    """Of the fixture only one wheel's zero is off, which none of these rules is about."""
    for name in ("car-3", "car-3-fixed"):
        assert not check(FIXTURES / name, codes=CODES).findings


# -- the verdict does not depend on how the robot is written ---------------------------------------------------------------

DEFECTS = {
    "SYM005": changed(FOUR, 2, axis=(0, -1, 0)),
    "SYM006": changed(FOUR, 1, place=(-0.2, 0.12, 0.002)),
    "JNT015": changed(FOUR, 3, spin=2),
    "DYN004": replace(THREE, com=(-0.05, 0, 0.05)),
}
WAYS: dict[str, Callable[[Car], Car]] = {
    "frames turned": lambda car: replace(car, frame=(0.3, -0.7, 2.0)),
    "quarter turn": lambda car: replace(car, frame=(-np.pi / 2, 0, 0)),
    "another root": lambda car: replace(car, root=((0.3, -0.1, 0.2), 2.5)),
    "ten times larger": lambda car: replace(car, scale=10.0),
    "a quarter of it": lambda car: replace(car, scale=0.25),
    "other names": lambda car: replace(car, prefix="left/"),
    "mirrored": lambda car: replace(
        car, wheels=tuple(replace(w, place=(w.place[0], -w.place[1], w.place[2])) for w in car.wheels)
    ),
}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("code", DEFECTS)
def test_verdicts_hold_however_the_robot_is_written(tmp_path: Path, code: str, way: str) -> None:
    plain, other = DEFECTS[code], WAYS[way](DEFECTS[code])
    (first,) = find_in_car(tmp_path / "plain", code, plain)
    (second,) = find_in_car(tmp_path / "other", code, other)
    assert second.message_id == first.message_id
    assert second.location.subject.replace(other.prefix, "") == first.location.subject
    clean = FOUR if code != "DYN004" else THREE
    assert not find_in_car(tmp_path / "clean", code, WAYS[way](clean))


# -- SYM005 ----------------------------------------------------------------------------------------------------------------


def test_wheels_whose_mesh_is_missing_are_known_by_their_name(tmp_path: Path) -> None:
    text = changed(FOUR, 0, axis=(0, -1, 0)).text()
    start = '<geometry><cylinder radius="0.05" length="0.02"/></geometry>'
    missing = text.replace(start, '<geometry><mesh filename="missing.stl"/></geometry>')
    (finding,) = find_in_car(tmp_path, "SYM005", missing)
    assert finding.message_id == "minority"


@pytest.mark.parametrize(("names", "severity"), [(range(1, 4), Severity.INFO), (range(4), Severity.WARNING)])
def test_a_wheel_without_a_transmission_turns_freely(tmp_path: Path, names: range, severity: Severity) -> None:
    car = changed(FOUR, 0, axis=(0, -1, 0))
    joints = re.findall(r'<joint name="(\w+)"', car.text())
    blocks = "".join(f'<transmission name="t{i}"><joint name="{joints[i]}"/></transmission>' for i in names)
    (finding,) = find_in_car(tmp_path, "SYM005", car.text().replace("</robot>", f"{blocks}</robot>"))
    assert finding.severity is severity


def test_a_wheel_high_above_the_ground_does_not_drive(tmp_path: Path) -> None:
    assert not find_in_car(tmp_path, "SYM005", changed(FOUR, 0, axis=(0, -1, 0), place=(0.2, 0.12, 0.2)))


def test_no_axis_is_edited_where_a_wheel_is_off_the_ground(tmp_path: Path) -> None:
    """Two wheels roll one way and two the other: the third of three is no minority if the fourth is elsewhere by mistake."""
    opposed = changed(changed(FOUR, 2, axis=(0, -1, 0)), 3, axis=(0, -1, 0))
    for name, place in (("a", (-0.2, -0.12, 0.0)), ("b", (-200, -120, 0.5))):
        (finding,) = find_in_car(tmp_path / name, "SYM005", changed(opposed, 2, place=place))
        assert not edits(finding)
    text = changed(FOUR, 2, axis=(0, -1, 0)).text()
    names = "".join(f"<left_joint>{joint}</left_joint>" for joint in re.findall(r'<joint name="(\w+)"', text))
    plugin = f'<gazebo><plugin name="d" filename="libgazebo_ros_diff_drive.so">{names}</plugin></gazebo></robot>'
    (finding,) = find_in_car(tmp_path / "c", "SYM005", text.replace("</robot>", plugin))
    assert edits(finding)


def test_a_wheel_beyond_its_radius_is_not_moved_by_its_height_alone(tmp_path: Path) -> None:
    found = find_in_car(tmp_path, "SYM006", changed(FOUR, 1, place=(-200, 120, 30)))
    assert [edits(finding) for finding in found] == [[]]


# -- SYM006 ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("place", range(4))
@pytest.mark.parametrize("off", [0.002, -0.002, 0.03])
def test_the_wheel_that_is_off_is_named_and_moved_back(tmp_path: Path, place: int, off: float) -> None:
    x, y, _ = CORNERS[place].place
    (finding,) = find_in_car(tmp_path, "SYM006", changed(FOUR, place, place=(x, y, off)))
    assert finding.message_id == "odd"
    assert finding.data["wheel"] == CORNERS[place].name
    assert finding.data["gap"] == pytest.approx(abs(off) * 1e3)
    assert edits(finding) == [(f"{x} {y} {off}", f"{x} {y} 0")]


@pytest.mark.parametrize(("height", "count"), [(-0.03, 0), (-0.02, 1)])
def test_on_what_a_robot_with_a_caster_stands_is_not_said(tmp_path: Path, height: float, count: int) -> None:
    """The ball has a radius of 20 mm, the wheels one of 50 mm."""
    car = replace(changed(FOUR, 0, place=(0.2, 0.12, 0.002)), caster=(0, 0, height))
    assert len(find_in_car(tmp_path, "SYM006", car)) == count


def test_what_hangs_at_least_so_high_is_not_rounded_up(tmp_path: Path) -> None:
    off = 0.00139
    (finding,) = find_in_car(
        tmp_path, "SYM006", changed(changed(FOUR, 0, place=(0.2, 0.12, off)), 2, place=(-0.2, -0.12, off))
    )
    assert "≥ 2.77 mm" in finding.headline or "≥ 2.78 mm" in finding.headline


def test_a_gap_of_a_hundredth_of_the_radius_is_the_limit(tmp_path: Path) -> None:
    assert not find_in_car(tmp_path / "a", "SYM006", changed(FOUR, 0, place=(0.2, 0.12, 0.00049)))
    assert find_in_car(tmp_path / "b", "SYM006", changed(FOUR, 0, place=(0.2, 0.12, 0.00051)))


def test_a_plane_that_leans_is_a_plane(tmp_path: Path) -> None:
    raised = changed(changed(FOUR, 0, place=(0.2, 0.12, 0.004)), 3, place=(0.2, -0.12, 0.004))
    assert not find_in_car(tmp_path, "SYM006", raised)


def test_diagonal_wheels_that_are_off_are_not_told_apart(tmp_path: Path) -> None:
    (finding,) = find_in_car(
        tmp_path, "SYM006", changed(changed(FOUR, 0, place=(0.2, 0.12, 0.004)), 2, place=(-0.2, -0.12, 0.004))
    )
    assert finding.message_id == "uneven"
    assert finding.data["gap"] == pytest.approx(8)


@pytest.mark.parametrize(("height", "count"), [(-0.03, 0), (0.0, 1)])
def test_a_robot_that_stands_on_a_fixed_caster_too_does_not_rock(tmp_path: Path, height: float, count: int) -> None:
    """The ball has a radius of 20 mm, and the wheels of 50 mm; the front left one is 4 mm higher."""
    car = replace(changed(FOUR, 0, place=(0.2, 0.12, 0.004)), caster=(0, 0, height))
    assert len(find_in_car(tmp_path, "SYM006", car)) == count


@pytest.mark.parametrize(
    ("left", "right", "message", "severity"),
    [
        ((8, 0, 0, 8), (8, 0, 0, 8), "axles", Severity.INFO),
        ((8, 0, 4, 0), (8, 0, 4, 0), "axles", Severity.INFO),
        ((8, 0, 0, 0), (0, 0, 0, 8), "uneven", Severity.WARNING),
        ((8, 0, 0, 0), (0, 0, 0, 0), "odd", Severity.WARNING),
    ],
)
def test_raised_axles_of_a_vehicle_with_many_are_by_design(
    tmp_path: Path, left: tuple[int, ...], right: tuple[int, ...], message: str, severity: Severity
) -> None:
    """Four axles from front to rear, and the heights of their wheels in mm."""
    wheels = [
        Wheel(f"{side}_{axle}_wheel", (0.3 - 0.2 * axle, y, 1e-3 * height))
        for side, y, heights in (("left", 0.12, left), ("right", -0.12, right))
        for axle, height in enumerate(heights)
    ]
    (finding,) = find_in_car(tmp_path, "SYM006", replace(FOUR, wheels=tuple(wheels)))
    assert (finding.message_id, finding.severity) == (message, severity)


@pytest.mark.parametrize(("place", "alone"), [((-0.2, 0.12, 0.004), True), ((-0.21, 0.12, 0.004), False)])
def test_no_height_is_offered_where_not_the_height_alone_differs(
    tmp_path: Path, place: tuple[float, float, float], alone: bool
) -> None:
    (finding,) = find_in_car(tmp_path, "SYM006", changed(FOUR, 1, place=place))
    assert finding.fix is not None
    assert bool(finding.fix.edits) == alone
    assert finding.fix.title.startswith("write xyz" if alone else "compare the origin")


def test_a_wheel_with_another_radius_is_told_as_that(tmp_path: Path) -> None:
    (finding,) = find_in_car(tmp_path, "SYM006", changed(FOUR, 1, radius=0.048))
    assert finding.message_id == "radius"
    assert finding.data["own"] == pytest.approx(48)
    assert finding.fix is not None
    assert "if rear_left_wheel is the same wheel as the others" in finding.fix.title
    assert not find_in_car(tmp_path / "b", "SYM006", changed(FOUR, 1, radius=0.048, place=(-0.2, 0.12, -0.002)))


def test_the_corners_of_a_drawn_wheel_are_not_its_height(tmp_path: Path) -> None:
    """A wheel of twelve corners is 3.4 % of its radius less high on its flat sides."""
    angles = np.arange(12) * np.pi / 6
    rim = [f"v {np.cos(a) * 0.05} {side} {np.sin(a) * 0.05}" for side in (-0.01, 0.01) for a in angles]
    faces = [
        f"f {i + 1} {(i + 1) % 12 + 1} {i + 13}\nf {(i + 1) % 12 + 1} {(i + 1) % 12 + 13} {i + 13}" for i in range(12)
    ]
    lids = [f"f 1 {i + 1} {i + 2}\nf 13 {i + 14} {i + 13}" for i in range(1, 11)]
    (tmp_path / "wheel.obj").write_text("\n".join([*rim, *faces, *lids]))
    cylinder = '<cylinder radius="0.05" length="0.02"/>'
    turned = (
        FOUR.text().replace(cylinder, '<mesh filename="wheel.obj"/>').replace('rpy="1.5707963268 0 0"', 'rpy="0 0 0"')
    )
    one = turned.replace('rpy="0 0 0"/><geometry><mesh', 'rpy="0 0.2617994 0"/><geometry><mesh', 1)
    assert one != turned
    assert not find_in_car(tmp_path, "SYM006", one)


@pytest.mark.parametrize(("axis", "said"), [("0 0 1", True), ("1 0 0", False)])
def test_steered_wheels_count_and_suspended_ones_do_not(tmp_path: Path, axis: str, said: bool) -> None:
    car = changed(FOUR, 0, place=(0.2, 0.12, 0.003))
    text = text_of(
        car,
        '<parent link="base"/><child link="front_right_wheel"/>',
        '<parent link="hub"/><child link="front_right_wheel"/>',
    )
    hub = (
        '<link name="hub"/><joint name="hub_joint" type="revolute"><parent link="base"/><child link="hub"/>'
        f'<axis xyz="{axis}"/><limit lower="-0.5" upper="0.5" effort="1" velocity="1"/></joint></robot>'
    )
    assert bool(find_in_car(tmp_path, "SYM006", text.replace("</robot>", hub))) is said


def test_wheels_far_above_the_ground_are_something_else(tmp_path: Path) -> None:
    """Return rollers of a track: two or more, or one of another size."""
    for extra in (
        [Wheel("upper_wheel_1", (0.1, 0.12, 0.05)), Wheel("upper_wheel_2", (0.1, -0.12, 0.05))],
        [Wheel("encoder_wheel", (0, 0, 0.05), radius=0.02)],
    ):
        assert not find_in_car(tmp_path, "SYM006", replace(FOUR, wheels=(*CORNERS, *extra)))


WHEEL_MACRO = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
<link name="base"/>
<xacro:macro name="wheel" params="name x y turn">
<link name="${{name}}_wheel">
<visual><origin rpy="1.5708 0 0"/><geometry><cylinder radius="0.05" length="0.02"/></geometry></visual>
</link>
<joint name="${{name}}" type="continuous"><parent link="base"/><child link="${{name}}_wheel"/>
<origin xyz="${{x}} ${{y}} 0" rpy="${{turn}} 0 0"/><axis xyz="0 1 0"/></joint>
</xacro:macro>
{calls}
</robot>
"""


@pytest.mark.parametrize("turned", [("rr",), ("fr", "rr")])
def test_a_line_that_makes_wheels_of_both_directions_is_not_edited(tmp_path: Path, turned: tuple[str, ...]) -> None:
    places = {"fl": (0.2, 0.1), "fr": (0.2, -0.1), "rl": (-0.2, 0.1), "rr": (-0.2, -0.1)}
    calls = "".join(
        f'<xacro:wheel name="{name}" x="{x}" y="{y}" turn="{3.14159265 if name in turned else 0.0}"/>'
        for name, (x, y) in places.items()
    )
    found = check_text(tmp_path, WHEEL_MACRO.format(calls=calls), "robot.urdf.xacro", codes={"SYM005"}).findings
    assert len(found) == 1
    assert found[0].fix is not None
    assert not found[0].fix.edits
    assert (
        f"give the macro a parameter for the axis, and invert it (all three signs) for {', '.join(turned)} alone"
        in (found[0].fix.title)
    )


@pytest.mark.parametrize(("base", "found"), [('<box size="0.3 0.15 0.05"/>', 1), ('<mesh filename="gone.stl"/>', 0)])
def test_parts_without_a_wheels_name_roll_only_below_all_that_is_known(tmp_path: Path, base: str, found: int) -> None:
    """A mesh that was not read may reach lower than the two round parts."""
    drawn = '<visual><origin rpy="1.5708 0 0"/><geometry><cylinder radius="0.05" length="0.02"/></geometry></visual>'
    parts = "".join(
        f'<link name="part_{side}">{drawn}</link><joint name="turn_{side}" type="continuous"><parent link="base"/>'
        f'<child link="part_{side}"/><origin xyz="0 {y} 0"/><axis xyz="0 {axis} 0"/></joint>'
        for side, y, axis in (("left", 0.1, 1), ("right", -0.1, -1))
    )
    text = f'<robot name="r"><link name="base"><visual><geometry>{base}</geometry></visual></link>{parts}</robot>'
    assert len(check_text(tmp_path, text, "robot.urdf", codes={"SYM005"}).findings) == found


# -- JNT015 ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("axis", [(0, 0, 1), (1, 0, 0), (0.1, 1, 0)])
def test_an_axis_that_is_not_the_wheels_is_replaced(tmp_path: Path, axis: tuple[float, float, float]) -> None:
    (finding,) = find_in_car(tmp_path, "JNT015", changed(FOUR, 0, axis=axis))
    assert finding.message_id == "axis"
    assert edits(finding) == [(numbers(axis), "0 1 0")]
    assert "its visual and inertia show that it is round" in finding.message


@pytest.mark.parametrize(
    ("odd", "backwards", "true"), [(0, {1, 2, 3}, "0 -1 0"), (0, {2, 3}, "0 1 0"), (2, {3}, "0 -1 0")]
)
def test_a_replaced_axis_points_where_those_of_its_side_do(
    tmp_path: Path, odd: int, backwards: set[int], true: str
) -> None:
    car = changed(FOUR, odd, axis=(0, 0, 1))
    for index in backwards:
        car = changed(car, index, axis=(0, -1, 0))
    (finding,) = find_in_car(tmp_path, "JNT015", car)
    assert edits(finding) == [("0 0 1", true)]


@pytest.mark.parametrize(
    ("name", "radius", "count"), [("front", 0.05, 3), ("front", 0.03, 2), ("front_swivel", 0.05, 2)]
)
def test_a_part_drawn_like_a_wheel_is_one_whatever_its_name(
    tmp_path: Path, name: str, radius: float, count: int
) -> None:
    """Its axis is upright, so that it does not roll."""
    plain = replace(CORNERS[0], name=name, radius=radius, axis=(0, 0, 1))
    tumbling = (replace(wheel, axis=(0, 0, 1)) for wheel in CORNERS[1:3])
    found = find_in_car(tmp_path, "JNT015", replace(FOUR, wheels=(plain, *tumbling, CORNERS[3])))
    assert sum(len(finding.list_occurrences()) for finding in found) == count


def test_an_axis_within_five_degrees_is_a_camber(tmp_path: Path) -> None:
    assert not find_in_car(tmp_path, "JNT015", changed(FOUR, 0, axis=(0.08, 1, 0)))


def test_a_wheel_without_axis_turns_about_x(tmp_path: Path) -> None:
    (finding,) = find_in_car(tmp_path, "JNT015", changed(FOUR, 0, axis=None))
    assert finding.message_id == "default"
    assert finding.fix is not None
    assert '<axis xyz="0 1 0"/>' in finding.fix.title


@pytest.mark.parametrize(("kind", "message"), [("fixed", "steered"), ("revolute", "default")])
def test_a_wheel_on_a_hinge_that_does_not_move_may_be_steered_by_its_joint(
    tmp_path: Path, kind: str, message: str
) -> None:
    hinge = joint("to_hinge", "base", "left_hinge", limit(-1, 1), kind=kind, axis="0 0 1")
    drawn = visual('<cylinder radius="0.05" length="0.02"/>', rpy="1.5708 0 0")
    wheel = joint("left_joint", "left_hinge", "left_wheel", kind="continuous")
    text = robot(link("base"), link("left_hinge"), link("left_wheel", drawn), hinge, wheel)
    (finding,) = find(tmp_path, text, "JNT015")
    assert finding.message_id == message
    assert finding.fix is not None
    assert ('<axis xyz="0 0 1"/>' in finding.fix.title) == (kind == "fixed")
    assert '<axis xyz="0 1 0"/>' in finding.fix.title


def test_a_steered_wheel_may_turn_about_its_fork(tmp_path: Path) -> None:
    tricycle = replace(THREE, caster=None, wheels=(*PAIR, Wheel("front_wheel", (0.2, 0, 0), axis=(0, 0, 1))))
    assert not find_in_car(tmp_path, "JNT015", tricycle)


def test_moments_in_the_wrong_places_are_exchanged(tmp_path: Path) -> None:
    (finding,) = find_in_car(tmp_path, "JNT015", changed(FOUR, 0, spin=2))
    assert finding.message_id == "inertia"
    assert finding.location.subject == "link[front_left_wheel]/inertial"
    assert edits(finding) == [("0.0005", "0.00026"), ("0.00026", "0.0005")]


TURNED = f"""<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="solid" params="rpy"><inertial><origin rpy="${{rpy}}"/><mass value="1"/>
    <inertia ixx="0.0026" iyy="0.0026" izz="0.005" ixy="0" ixz="0" iyz="0"/></inertial></xacro:macro>
  <xacro:macro name="wheel" params="name y">
    <link name="${{name}}_wheel">
      <xacro:solid rpy="RPY"/>
      <collision><origin rpy="COLLISION"/><geometry><cylinder radius="0.1" length="0.02"/></geometry></collision>
    </link>
    <joint name="${{name}}_wheel" type="continuous">
      <origin xyz="0 ${{y}} 0" rpy="{math.pi / 2} 0 0"/><parent link="base"/><child link="${{name}}_wheel"/><axis xyz="AXIS"/>
    </joint>
  </xacro:macro>
  <link name="base"><xacro:solid rpy="0 0 0"/></link>
  <xacro:wheel name="left" y="0.2"/>
  <xacro:wheel name="right" y="-0.2"/>
</robot>"""


@pytest.mark.parametrize(
    ("rpy", "collision", "axis", "message", "repair"),
    [
        ("${pi/2} 0 0", "0 0 0", "0 0 ${1 if y > 0 else -1}", "turned", 'write `rpy="0 0 0"` in the `<origin>`'),
        ("1.570796 0 0", "0 0 0", "0 0 1", "turned", 'write `rpy="0 0 0"` in the `<origin>`'),
        ("0 0 0", "1.570796 0 0", "0 1 0", "inertia", "rotate the `<origin>` of the inertial so that"),
        (
            "0.785398 0 0",
            "1.570796 0 0",
            "0 1 0",
            "inertia",
            "rotate the `<origin>` of the inertial so that",
        ),
    ],
)
def test_the_repair_of_moments_is_where_they_are_turned(
    tmp_path: Path, rpy: str, collision: str, axis: str, message: str, repair: str
) -> None:
    text = TURNED.replace("RPY", rpy).replace("COLLISION", collision).replace("AXIS", axis)
    (finding,) = find(tmp_path, text, "JNT015", name="r.xacro")
    assert finding.message_id == message
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)
    if message == "turned":
        assert finding.location.span is not None
        assert finding.location.span.line == 6
        assert edits(finding) == ([] if "$" in rpy else [(rpy, "0 0 0")])
    else:
        assert finding.fix.title.endswith("also give those of base")
        assert not finding.fix.edits


def test_what_is_drawn_is_turned_where_the_rest_agrees_with_the_joint(tmp_path: Path) -> None:
    text = FOUR.text().replace('rpy="1.5707963268 0 0"/><geometry>', 'rpy="0 0 0"/><geometry>', 1)
    (finding,) = find_in_car(tmp_path, "JNT015", text)
    assert finding.message_id == "drawn"
    assert finding.location.subject.startswith("link[front_left_wheel]/visual")


def test_the_axis_alone_is_no_repair_where_something_is_round_about_it(tmp_path: Path) -> None:
    """The visual stands upright; what agrees with the vertical joint axis must be turned with it, so no edit is offered."""
    text = changed(FOUR, 0, axis=(0, 0, 1), spin=2).text()
    (finding,) = find_in_car(tmp_path, "JNT015", text)
    assert finding.message_id == "upright"
    assert finding.fix is not None
    assert "write axis `0 1 0`, and turn inertia of front_left_wheel with it" in finding.fix.title
    assert not finding.fix.edits


def test_without_a_drawing_nobody_knows_which_is_wrong(tmp_path: Path) -> None:
    text = changed(FOUR, 0, spin=2).text()
    drawn = text[text.index("<visual>", text.index('<link name="front_left_wheel">')) :]
    drawn = drawn[: drawn.index("</visual>") + len("</visual>")]
    (finding,) = find_in_car(tmp_path, "JNT015", text.replace(drawn, "", 1))
    assert finding.message_id == "unsure"


@pytest.mark.parametrize(("offset", "said"), [(0.0024, False), (0.0026, True)])
def test_a_wheel_beside_its_axis_is_a_cam(tmp_path: Path, offset: float, said: bool) -> None:
    """A twentieth of the radius is the limit."""
    for frame in ((0, 0, 0), (0.3, -0.7, 2.0)):
        messages = [
            f.message_id for f in find_in_car(tmp_path, "JNT015", replace(changed(FOUR, 0, offset=offset), frame=frame))
        ]
        assert messages == (["eccentric"] if said else [])


def test_only_what_collides_lifts_the_robot(tmp_path: Path) -> None:
    """The origin of the wheel's joint carries the drawing along: moving it alone changes nothing."""
    text = changed(FOUR, 0, offset=0.01).text()
    (seen,) = find_in_car(tmp_path / "a", "JNT015", text)
    assert "lifts the robot" not in seen.message
    assert seen.fix is not None
    assert seen.fix.title.endswith("what front_left_wheel holds back by as much")
    drawn = text[text.index("<visual>", text.index('<link name="front_left_wheel">')) :]
    drawn = drawn[: drawn.index("</visual>") + len("</visual>")]
    both = text.replace(drawn, drawn + drawn.replace("visual>", "collision>"), 1)
    (felt,) = find_in_car(tmp_path / "b", "JNT015", both)
    assert "lifts the robot" in felt.message
    assert felt.data["kind"] == "visual and collision", "moving the drawing alone leaves what lifts the robot"


def test_only_round_things_are_judged(tmp_path: Path) -> None:
    """A square plate has the moments of a disc; an arm that is a cylinder turns about any axis."""
    plate = (
        changed(FOUR, 0, axis=(0, 0, 1))
        .text()
        .replace('<cylinder radius="0.05" length="0.02"/>', '<box size="0.1 0.1 0.02"/>')
    )
    assert {f.message_id for f in find_in_car(tmp_path / "a", "JNT015", plate)} <= {"unsure"}
    arm = Car((Wheel("upper_arm", (0, 0, 0.5), axis=(1, 0, 0)), Wheel("lower_arm", (0, 0.5, 0.5), axis=(1, 0, 0))))
    assert not find_in_car(tmp_path / "b", "JNT015", arm)


def test_rods_that_are_called_after_a_wheel_turn_as_they_like(tmp_path: Path) -> None:
    """A connecting rod, from its inertia and from its drawing."""
    rod = (
        '<robot name="engine"><link name="base"/><joint name="wheel_rod" type="continuous"><parent link="base"/>'
        '<child link="rod"/><axis xyz="1 0 0"/></joint><link name="rod">{}</link></robot>'
    )
    weight = make_sized_inertial(0.1, (0, 0, 0.1), (3e-4, 3e-4, 1e-5), np.eye(3), 1.0)
    drawing = '<visual><origin xyz="0 0 0.1"/><geometry><cylinder radius="0.01" length="0.2"/></geometry></visual>'
    for place, inside in enumerate((weight, drawing, weight + drawing)):
        assert not find_in_car(tmp_path / str(place), "JNT015", rod.format(inside))


# -- DYN004 ----------------------------------------------------------------------------------------------------------------


def test_a_cart_with_its_mass_behind_the_wheels_tips_over(tmp_path: Path) -> None:
    (finding,) = find_in_car(tmp_path, "DYN004", DEFECTS["DYN004"])
    assert finding.message_id == "tips"
    assert finding.severity is Severity.WARNING
    assert finding.data["side"] == "-x (to the rear)"
    assert finding.data["worst"] == "base"
    assert set(finding.data["contacts"]) == {"left_wheel", "right_wheel", "caster"}
    # 5 kg at x = -0.05 and 0.8 kg at 0.
    assert finding.data["margin"] == pytest.approx(0.05 * 5 / 5.8 * 1e3)


@pytest.mark.parametrize("held", ['<gazebo reference="base"><kinematic>{}</kinematic>', "<gazebo><static>{}</static>"])
def test_weight_does_not_tip_what_gazebo_poses(tmp_path: Path, held: str) -> None:
    text = DEFECTS["DYN004"].text()
    for flag in ("false", "true"):
        block = f"{held.format(flag)}</gazebo></robot>"
        found = find_in_car(tmp_path / flag, "DYN004", text.replace("</robot>", block))
        assert bool(found) == (flag == "false")
        if "kinematic" in held:  # Bullet reads none of it
            assert find(tmp_path / flag, text.replace("</robot>", block), "DYN004", targets=("bullet",))


def test_a_boat_does_not_stand_on_its_propellers(tmp_path: Path) -> None:
    boat = replace(DEFECTS["DYN004"], wheels=tuple(replace(w, name=w.name.replace("wheel", "propeller")) for w in PAIR))
    assert not find_in_car(tmp_path / "boat", "DYN004", boat)
    names = [replace(w, name=w.name.replace("wheel", "wheel_rotor")) for w in PAIR]
    assert find_in_car(tmp_path / "hub", "DYN004", replace(DEFECTS["DYN004"], wheels=tuple(names)))


def test_a_cart_whose_chassis_has_no_mass_has_no_known_com(tmp_path: Path) -> None:
    camera = (
        '<link name="camera"><inertial><mass value="0.1"/>'
        '<inertia ixx="1e-5" ixy="0" ixz="0" iyy="1e-5" iyz="0" izz="1e-5"/></inertial>'
        '<visual><geometry><box size="0.02 0.02 0.02"/></geometry></visual></link><joint name="eye" type="fixed">'
        '<parent link="base"/><child link="camera"/><origin xyz="-0.2 0 0.2"/></joint></robot>'
    )
    text = THREE.text().replace("</robot>", camera)
    assert find_in_car(tmp_path / "heavy", "DYN004", text.replace('mass value="0.1"', 'mass value="10"'))
    base = re.sub(r'(<link name="base">)<inertial>.*?</inertial>', r"\1", text, flags=re.S)
    assert base != text
    assert not find_in_car(tmp_path / "light", "DYN004", base)


@pytest.mark.parametrize(("x", "said"), [(0.004, "slope"), (0.02, None), (-0.0005, "slope"), (-0.004, "tips")])
def test_how_much_slope_it_bears(tmp_path: Path, x: float, said: str | None) -> None:
    """The COM is about 9 cm above the ground: 4.76° are 8 mm, and half a degree, 0.8 mm, is what rounding may leave."""
    messages = [f.message_id for f in find_in_car(tmp_path, "DYN004", replace(THREE, com=(x, 0, 0.05)))]
    assert messages == ([] if said is None else [said])


def test_two_wheels_in_a_line_have_no_slope_of_their_own(tmp_path: Path) -> None:
    """The caster is 5 mm short, so that the COM is on the line of the wheels."""
    cart = replace(THREE, caster=(0.2, 0, -0.025), com=(-0.0002, 0, 0.05))
    assert not find_in_car(tmp_path, "DYN004", cart)


def test_a_short_caster_only_leans_the_robot(tmp_path: Path) -> None:
    assert not find_in_car(tmp_path / "a", "DYN004", replace(THREE, caster=(0.2, 0, -0.02)))
    assert not find_in_car(tmp_path / "b", "DYN004", replace(THREE, caster=(0.2, 0, -0.036)))


@pytest.mark.parametrize("x", [0.0, 0.0005])
def test_two_wheels_in_a_line_have_no_support_polygon(tmp_path: Path, x: float) -> None:
    """A base that hangs low enough to catch the robot is no caster."""
    text = replace(THREE, com=(x, 0, 0.03), caster=None).text()
    box = '<visual><origin xyz="0 0 -0.0295"/><geometry><box size="0.2 0.2 0.02"/></geometry></visual>'
    (finding,) = find_in_car(tmp_path, "DYN004", text.replace("</inertial>", f"</inertial>{box}", 1))
    assert (finding.message_id, finding.severity) == ("line", Severity.INFO)
    assert "°" not in finding.headline


def test_a_balancer_is_kept_upright_by_its_controller(tmp_path: Path) -> None:
    assert not find_in_car(tmp_path, "DYN004", replace(THREE, com=(0.02, 0, 0.3), caster=None))


def test_what_is_fixed_to_the_world_cannot_fall(tmp_path: Path) -> None:
    bolted = '<link name="world"/><joint name="bolts" type="fixed"><parent link="world"/><child link="base"/></joint></robot>'
    assert not find_in_car(tmp_path, "DYN004", DEFECTS["DYN004"].text().replace("</robot>", bolted))


def test_masses_that_are_not_known_decide_nothing(tmp_path: Path) -> None:
    text = DEFECTS["DYN004"].text()
    run = check_text(tmp_path / "a", text.replace('<mass value="0.4"/>', '<mass value="a"/>', 1), codes={"DYN004"})
    assert not run.findings
    assert [skip.code for skip in run.skipped] == ["DYN004"]
    # Nor does a model whose base has none.
    start = text.index("<inertial>")
    bare = text[:start] + text[text.index("</inertial>") + len("</inertial>") :]
    assert not find_in_car(tmp_path / "b", "DYN004", bare)


def table(*, com: float, names: str = "leg") -> str:
    """Four legs of two joints each on the corners of a body."""
    parts = [f'<link name="body">{make_sized_inertial(8, (com, 0, 0), (0.1, 0.1, 0.1), np.eye(3), 1.0)}</link>']
    limit = '<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="9" velocity="9"/>'
    for i, (x, y) in enumerate([(0.2, 0.1), (0.2, -0.1), (-0.2, 0.1), (-0.2, -0.1)]):
        parts.append(
            f'<joint name="{names}_{i}_a" type="revolute"><parent link="body"/><child link="{names}_{i}_upper"/>'
            f'<origin xyz="{x} {y} 0"/>{limit}</joint><link name="{names}_{i}_upper"/>'
            f'<joint name="{names}_{i}_b" type="revolute"><parent link="{names}_{i}_upper"/><child link="{names}_{i}_lower"/>'
            f'<origin xyz="0 0 -0.2"/>{limit}</joint><link name="{names}_{i}_lower"><visual><origin xyz="0 0 -0.2"/>'
            '<geometry><sphere radius="0.02"/></geometry></visual></link>'
        )
    return f'<robot name="table">{"".join(parts)}</robot>'


@pytest.mark.parametrize(("toe", "messages"), [("", []), ("0.05", ["tips"])])
def test_two_wheels_on_legs_are_balanced_by_a_controller(tmp_path: Path, toe: str, messages: list[str]) -> None:
    """However near the ankles are to the ground. Feet that reach ahead are to stand."""
    parts = [f'<link name="body">{make_sized_inertial(8, (-0.05, 0, 0), (0.1, 0.1, 0.1), np.eye(3), 1.0)}</link>']
    limit = '<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="9" velocity="9"/>'
    foot = f'<visual><origin xyz="{toe} 0 -0.04"/><geometry><sphere radius="0.01"/></geometry></visual>' if toe else ""
    for side, y in (("left", 0.1), ("right", -0.1)):
        parts.append(
            f'<joint name="{side}_hip" type="revolute"><parent link="body"/><child link="{side}_thigh"/>'
            f'<origin xyz="0 {y} 0"/>{limit}</joint><link name="{side}_thigh"/>'
            f'<joint name="{side}_knee" type="revolute"><parent link="{side}_thigh"/><child link="{side}_leg"/>{limit}</joint>'
            f'<link name="{side}_leg"><visual><origin xyz="0 0 -0.3"/><geometry><sphere radius="0.047"/></geometry></visual>'
            "</link>"
            f'<joint name="{side}_ankle" type="revolute"><parent link="{side}_leg"/><child link="{side}_tire"/>'
            f'<origin xyz="0 0 -0.3"/>{limit}</joint>'
            f'<link name="{side}_tire"><visual><origin rpy="1.5707963268 0 0"/><geometry><cylinder radius="0.05" length="0.02"/>'
            f"</geometry></visual>{foot}</link>"
        )
    found = find_in_car(tmp_path, "DYN004", f'<robot name="upright">{"".join(parts)}</robot>')
    assert [f.message_id for f in found] == messages


def test_legs_are_only_mentioned(tmp_path: Path) -> None:
    """Nobody needs to stand with all joints at zero."""
    assert not find_in_car(tmp_path / "a", "DYN004", table(com=0.1))
    (finding,) = find_in_car(tmp_path / "b", "DYN004", table(com=0.3))
    assert finding.severity is Severity.INFO
    assert not find_in_car(tmp_path / "c", "DYN004", table(com=0.3, names="finger"))


@pytest.mark.parametrize(("places", "falls"), [((0.15, -0.15), False), ((0.15,), True)])
def test_a_foot_stands_on_several_small_spheres(tmp_path: Path, places: tuple[float, ...], falls: bool) -> None:
    """One so small is a dummy."""
    spheres = "".join(
        f'<collision><origin xyz="{x} 0 -0.24"/><geometry><sphere radius="0.005"/></geometry></collision>'
        for x in places
    )
    feet = "".join(
        f'<link name="foot_{i}">{spheres}</link><joint name="sole_{i}" type="fixed"><parent link="leg_{i}_lower"/>'
        f'<child link="foot_{i}"/></joint>'
        for i in range(4)
    )
    text = table(com=0.3).replace("</robot>", f"{feet}</robot>")
    assert bool(find_in_car(tmp_path, "DYN004", text)) is falls


@pytest.mark.parametrize(
    ("lower", "upper", "said"),
    [(0, 0, True), (-3.1416, 3.1416, True), (-0.6, 0.6, False)],
    ids=["empty", "turn", "steer"],
)
def test_a_revolute_wheel_is_judged_unless_its_range_may_be_that_of_a_steering(
    tmp_path: Path, lower: float, upper: float, said: bool
) -> None:
    cars = [changed(FOUR, 0, kind="revolute", offset=offset).text() for offset in (0.03, 0)]
    limit = f'<limit lower="{lower}" upper="{upper}" effort="1" velocity="1"/></joint>'
    cam, sound = (text.replace("</joint>", limit, 1) for text in cars)
    assert [f.message_id for f in find(tmp_path / "a", cam, "JNT015")] == ["eccentric"] * said
    assert not find(tmp_path / "b", sound, "JNT015")
