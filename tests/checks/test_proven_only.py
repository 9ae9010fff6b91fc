"""What looks wrong and is by choice, or wrong in another way: symmetric meshes, frames from a bridge, Classic on purpose."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from builders import box, collision, cylinder, find, inertial, joint, limit, link, mesh, robot, visual

from urdfcheck.core import Finding, Severity

MANIFEST = '<package format="3"><name>r</name><version>1.0.0</version><description>d</description>{}</package>'
AMENT = "<export><build_type>ament_cmake</build_type></export>"


def write_prism(path: Path, corners: list[tuple[float, float]], height: float = 0.02) -> None:
    """Write an upright prism on a convex polygon (m), given counterclockwise."""
    low, high = ([(x, y, z) for x, y in corners] for z in (0.0, height))
    faces = [(low[0], low[i + 1], low[i]) for i in range(1, len(low) - 1)]
    faces += [(high[0], high[i], high[i + 1]) for i in range(1, len(high) - 1)]
    for i in range(len(low)):
        k = (i + 1) % len(low)
        faces += [(low[i], low[k], high[k]), (low[i], high[k], high[i])]
    lines = (
        "facet normal 0 0 0 outer loop "
        + " ".join("vertex {} {} {}".format(*point) for point in face)
        + " endloop endfacet"
        for face in faces
    )
    path.write_text("solid p\n" + "\n".join(lines) + "\nendsolid p\n")


# -- GEO005 ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("corners", "turn", "found"),
    [
        ([(-0.1, -0.05), (0.1, -0.05), (0.1, 0.05), (-0.1, 0.05)], "3.14159265", False),
        ([(-0.1, -0.05), (0.1, -0.05), (0.1, 0.05), (-0.1, 0.05)], "1.57079633", True),
        ([(-0.1, -0.05), (0.1, -0.05), (0.1, 0.05), (-0.1, 0.052)], "3.14159265", True),
    ],
)
def test_a_mesh_that_a_half_turn_maps_onto_itself_is_in_place(
    tmp_path: Path, corners: list[tuple[float, float]], turn: str, found: bool
) -> None:
    write_prism(tmp_path / "part.stl", corners)
    part = mesh("part.stl")
    assert bool(find(tmp_path, robot(link("a", visual(part), collision(part, rpy=f"0 0 {turn}"))), "GEO005")) == found


@pytest.mark.parametrize(
    ("edges", "place", "rpy", "found"),
    [
        (24, "0 0 0", "0 0 0.7", False),
        (24, "0 0 0", "0 0 0.01", False),
        (24, "0 0 0.0003", "0 0 0.7", True),  # moved, too
        (24, "0 0 0", "0.7 0 0", True),
        (6, "0 0 0", "0 0 0.7", True),
        (6, "0 0 0", "0 0 0.01", True),
    ],
)
def test_a_round_mesh_may_be_rotated_by_less_than_an_edge(
    tmp_path: Path, edges: int, place: str, rpy: str, found: bool
) -> None:
    angles = [math.tau * n / edges for n in range(edges)]
    write_prism(tmp_path / "part.stl", [(0.1 * math.cos(angle), 0.1 * math.sin(angle)) for angle in angles])
    part = mesh("part.stl")
    text = robot(link("a", visual(part), collision(part, xyz=place, rpy=rpy)))
    assert bool(find(tmp_path, text, "GEO005")) == found


# -- SYM001, SYM003 --------------------------------------------------------------------------------------------------------


def hinges(left: float, right: float, rpy: str) -> str:
    """Two boxes that mirror each other, drawn askew in their frames by angles (rad) about z; the right joint has a rotation."""
    parts = [link("base")]
    for side, y, drawn, turn in (("left", 0.2, left, ""), ("right", -0.2, right, rpy)):
        part = visual(box("0.3 0.1 0.1"), rpy=f"0 0 {drawn}")
        parts.append(link(f"{side}_arm", inertial(1, 0.01), part))
        parts.append(
            joint(side, "base", f"{side}_arm", limit(-1, 1), kind="revolute", xyz=f"0 {y} 0", rpy=turn, axis="0 0 1")
        )
    return robot(*parts)


@pytest.mark.parametrize(
    ("left", "right", "found"), [(-0.022, -0.0386417, False), (-0.022, -0.022, True), (0, 0, True)]
)
def test_a_rotation_that_draws_the_part_square_to_the_root_is_kept(
    tmp_path: Path, left: float, right: float, found: bool
) -> None:
    findings = find(tmp_path, hinges(left, right, "0 0 0.0386417"), "SYM001")
    assert [f.message_id for f in findings] == (["limits"] if found else [])


@pytest.mark.parametrize(("angle", "severity"), [(0.0194, Severity.INFO), (0.0394, Severity.WARNING)])
def test_the_angle_of_a_wheel_is_a_note_below_two_degrees(tmp_path: Path, angle: float, severity: Severity) -> None:
    parts = [
        link(f"{name}_wheel", inertial(1, 0.01), visual(cylinder(0.05, 0.02)))
        + joint(
            name,
            "base",
            f"{name}_wheel",
            kind="continuous",
            xyz=f"{x} {y} 0",
            rpy=f"1.5707963267949 {turn} 0",
            axis="0 0 1",
        )
        for name, x, y, turn in (
            ("front_left", 0.2, 0.1, angle),
            ("front_right", 0.2, -0.1, 0),
            ("rear_left", -0.2, 0.1, 0),
            ("rear_right", -0.2, -0.1, 0),
        )
    ]
    (finding,) = find(tmp_path, robot(link("base"), *parts), "SYM001")
    assert (finding.message_id, finding.severity) == ("zero", severity)


@pytest.mark.parametrize(("com", "message"), [("0.0367", "pair"), ("0.4", "neither")])
def test_copies_that_are_both_far_from_their_drawing_are_not_copied(tmp_path: Path, com: str, message: str) -> None:
    write_prism(tmp_path / "part.stl", [(0, 0), (0.1, 0), (0.01, 0.06)])
    tensor = {"ixx": 2.33e-4, "iyy": 5.39e-4, "izz": 7.06e-4, "ixy": 1.33e-4}
    parts = [
        link(name, inertial(mass, com=f"{com} 0.02 0.01", **tensor), visual(mesh("part.stl")))
        + joint(f"{name}_joint", "base", name, kind="continuous", xyz=xyz, axis="0 0 1")
        for name, mass, xyz in (("one", 1, "0.2 0 0"), ("two", 1.1, "0 0.3 0.1"))
    ]
    (finding,) = find(tmp_path, robot(link("base"), *parts), "SYM003")
    assert finding.message_id == message
    assert finding.fix is not None
    assert ("is right, write" in finding.fix.title) == (message == "pair")


@pytest.mark.parametrize(
    ("coms", "message"),
    [(("0.06 0.03 0.01", "0.05 0.01 0.02"), "neither_com"), (("0.0367 0.02 0.01", "0.05 0.01 0.02"), "pair")],
)
def test_of_two_coms_that_are_both_beside_the_drawn_one_neither_is_called_right(
    tmp_path: Path, coms: tuple[str, str], message: str
) -> None:
    write_prism(tmp_path / "part.stl", [(0, 0), (0.1, 0), (0.01, 0.06)])
    tensor = {"ixx": 2.33e-4, "iyy": 5.39e-4, "izz": 7.06e-4, "ixy": 1.33e-4}
    parts = [
        link(name, inertial(1, com=com, **tensor), visual(mesh("part.stl")))
        + joint(f"{name}_joint", "base", name, kind="continuous", xyz=xyz, axis="0 0 1")
        for name, com, xyz in zip(("one", "two"), coms, ("0.2 0 0", "0 0.3 0.1"), strict=True)
    ]
    (finding,) = find(tmp_path, robot(link("base"), *parts), "SYM003")
    assert finding.message_id == message
    assert ("(36.67, 20, " in finding.message) == (message == "neither_com")


# -- wheels: SYM005, SYM006, CTL007 ----------------------------------------------------------------------------------------


def wheel(name: str, xyz: str, *, axis: str = "0 1 0", radius: float = 0.05) -> str:
    part = visual(cylinder(radius, 0.02), rpy="1.5708 0 0")
    return link(f"{name}_wheel", part) + joint(name, "base", f"{name}_wheel", kind="continuous", xyz=xyz, axis=axis)


def car(*heights: float) -> str:
    """A car with wheels in pairs from front to rear, whose axles have these heights (m)."""
    places = [(f"w{k}", f"{0.2 * (k // 2)} {0.1 if k % 2 else -0.1} {z}") for k, z in enumerate(heights)]
    return robot(link("base"), *(wheel(name, xyz) for name, xyz in places))


def test_wheels_far_below_the_others_carry_the_robot(tmp_path: Path) -> None:
    """The middle ones hang: that they are not in one plane means nothing."""
    assert find(tmp_path / "above", car(0, 0, 0, 0.004, 0.02, 0.02), "SYM006")
    assert not find(tmp_path / "below", car(0, 0, 0, 0.004, -0.02, -0.02), "SYM006")


DRIVE = '<gazebo><plugin filename="{}" name="{}">{}</plugin></gazebo>'


def name_sides(left: str, right: str, more: str = "") -> str:
    return f"<left_joint>{left}</left_joint><right_joint>{right}</right_joint>{more}"


def test_a_wheel_that_the_drive_turns_counts_wherever_it_hangs(tmp_path: Path) -> None:
    parts = (link("base"), wheel("l", "0 0.1 0"), wheel("r", "0 -0.1 0"), wheel("up", "0.3 0.1 0.04", axis="0 -1 0"))
    driven = DRIVE.format("gz-sim-diff-drive-system", "d", name_sides("l", "r", "<left_joint>up</left_joint>"))
    assert not find(tmp_path / "free", robot(*parts), "SYM005")
    (finding,) = find(tmp_path / "driven", robot(*parts, driven), "SYM005")
    assert (finding.message_id, finding.severity) == ("minority", Severity.WARNING)


@pytest.mark.parametrize(("factor", "severity"), [("-1.0", Severity.INFO), ("1.0", Severity.WARNING)])
def test_a_negative_radius_turns_the_wheels_of_one_side_round(tmp_path: Path, factor: str, severity: Severity) -> None:
    controller = (
        "controller_manager: {ros__parameters: {d: {type: diff_drive_controller/DiffDriveController}}}\n"
        f"d: {{ros__parameters: {{left_wheel_names: [l], right_wheel_names: [r], right_wheel_radius_multiplier: {factor}}}}}\n"
    )
    files = {
        "package.xml": MANIFEST.format(AMENT),
        "config/c.yaml": controller,
        "urdf/r.urdf": robot(link("base"), wheel("l", "0 0.1 0"), wheel("r", "0 -0.1 0", axis="0 -1 0")),
    }
    (finding,) = find(tmp_path, files, "SYM005", name="urdf/r.urdf")
    assert (finding.message_id, finding.severity) == ("opposed", severity)


@pytest.mark.parametrize("drives", [True, False])
def test_a_drive_plugin_may_turn_the_drums_of_a_mechanism(tmp_path: Path, drives: bool) -> None:
    drums = "".join(
        wheel(f"{side}_flywheel", f"0 {y} 0.3", axis="1 0 0") for side, y in (("left", 0.1), ("right", -0.1))
    )
    blocks = DRIVE.format("libgazebo_ros_diff_drive.so", "b", name_sides("left_flywheel", "right_flywheel"))
    if drives:
        blocks += DRIVE.format("libgazebo_ros_diff_drive.so", "a", name_sides("l", "r"))
    text = robot(link("base"), wheel("l", "0 0.1 0"), wheel("r", "0 -0.1 0"), drums, blocks)
    assert [f.message_id for f in find(tmp_path, text, "CTL007")] == ([] if drives else ["sideways"])


def test_a_wheel_is_as_large_as_it_collides_and_as_far_as_its_middle(tmp_path: Path) -> None:
    """A dot that hides the wheel is no wheel, and a joint at its inner face is not its middle."""
    rolling = collision('<cylinder radius="0.025" length="0.03"/>', xyz="0 0 {0}", rpy="1.5708 0 0") + visual(
        '<cylinder radius="0.001" length="0.001"/>', xyz="0 0 {0}", rpy="1.5708 0 0"
    )
    parts = [
        link(f"{name}_wheel", rolling.replace("0 0 {0}", f"0 {out} 0"))
        + joint(name, "base", f"{name}_wheel", kind="continuous", xyz=place, axis="0 1 0")
        for name, place, out in (("l", "0 0.1 0", "0.02"), ("r", "0 -0.1 0", "-0.02"))
    ]
    numbers = "<wheel_diameter>0.025</wheel_diameter><wheel_separation>0.3</wheel_separation>"
    block = DRIVE.format("libgazebo_ros_diff_drive.so", "d", name_sides("l", "r", numbers))
    found = {f.message_id: f.data["real"] for f in find(tmp_path, robot(link("base"), *parts, block), "CTL007")}
    assert found == pytest.approx({"radius": 0.05, "separation": 0.24}, rel=1e-4)


def test_the_separation_of_wheels_whose_meshes_are_missing_is_not_known(tmp_path: Path) -> None:
    """Joints may be at the faces of the wheels."""
    for name, shape, known in (("a", '<mesh filename="missing.stl"/>', False), ("b", '<sphere radius="0.05"/>', True)):
        parts = [
            link(f"{side}_wheel", visual(shape))
            + joint(side, "base", f"{side}_wheel", kind="continuous", xyz=place, axis="0 1 0")
            for side, place in (("l", "0 0.1 0"), ("r", "0 -0.1 0"))
        ]
        block = DRIVE.format(
            "libgazebo_ros_diff_drive.so", "d", name_sides("l", "r", "<wheel_separation>0.3</wheel_separation>")
        )
        found = [f.message_id for f in find(tmp_path / name, robot(link("base"), *parts, block), "CTL007")]
        assert ("separation" in found) == known


@pytest.mark.parametrize(("typed", "real"), [("0.34", []), ("0.28", [0.34])])
def test_an_axle_stub_does_not_move_the_middle_of_a_wheel(tmp_path: Path, typed: str, real: list[float]) -> None:
    parts = [
        link(
            f"{name}_wheel",
            collision('<cylinder radius="0.1" length="0.04"/>', xyz=f"0 {sign}0.07 0", rpy="1.5708 0 0")
            + collision('<cylinder radius="0.02" length="0.06"/>', xyz=f"0 {sign}0.02 0", rpy="1.5708 0 0"),
        )
        + joint(name, "base", f"{name}_wheel", kind="continuous", xyz=f"0 {sign}0.1 0", axis="0 1 0")
        for name, sign in (("l", ""), ("r", "-"))
    ]
    numbers = f"<wheel_separation>{typed}</wheel_separation>"
    block = DRIVE.format("libgazebo_ros_diff_drive.so", "d", name_sides("l", "r", numbers))
    found = [f.data["real"] for f in find(tmp_path, robot(link("base"), *parts, block), "CTL007")]
    assert found == pytest.approx(real, rel=1e-4)


@pytest.mark.parametrize(("diameter", "real"), [(0.08, 0.1), (0.1, None), (0.104, None), (0.12, 0.1)])
def test_a_bump_of_a_wheel_is_not_its_radius(tmp_path: Path, diameter: float, real: float | None) -> None:
    tyre = visual('<cylinder radius="0.05" length="0.03"/>', rpy="1.5708 0 0") + visual(
        '<sphere radius="0.002"/>', xyz="0 0 0.05"
    )
    parts = [
        link(f"{name}_wheel", tyre) + joint(name, "base", f"{name}_wheel", kind="continuous", xyz=place, axis="0 1 0")
        for name, place in (("l", "0 0.1 0"), ("r", "0 -0.1 0"))
    ]
    numbers = f"<wheel_diameter>{diameter}</wheel_diameter>"
    block = DRIVE.format("libgazebo_ros_diff_drive.so", "d", name_sides("l", "r", numbers))
    found = [f.data["real"] for f in find(tmp_path, robot(link("base"), *parts, block), "CTL007")]
    assert found == ([] if real is None else [pytest.approx(real, rel=2e-3)])


@pytest.mark.parametrize(
    ("filename", "more", "odometry"),
    [
        ("gz-sim-diff-drive-system", "", True),
        ("libgazebo_ros_diff_drive.so", "", False),
        ("libgazebo_ros_diff_drive.so", "<odometry_source>0</odometry_source>", True),
        ("libgazebo_ros_diff_drive.so", "<odometrySource> world </odometrySource>", False),
    ],
)
def test_odometry_of_the_true_pose_is_never_off(tmp_path: Path, filename: str, more: str, odometry: bool) -> None:
    block = DRIVE.format(filename, "d", name_sides("l", "r", f"<wheel_separation>0.5</wheel_separation>{more}"))
    (finding,) = find(tmp_path, robot(link("base"), wheel("l", "0 0.1 0"), wheel("r", "0 -0.1 0"), block), "CTL007")
    assert ("odometry" in finding.consequences["gazebo"]) == odometry


def test_a_drive_that_other_robots_include_becomes_an_argument(tmp_path: Path) -> None:
    def build(place: str) -> str:
        head = '<xacro:include filename="drive.xacro"/>'
        return robot(head, link("base"), wheel("l", f"0 {place} 0"), wheel("r", f"0 -{place} 0"), xacro=True)

    block = DRIVE.format(
        "gz-sim-diff-drive-system", "d", name_sides("l", "r", "<wheel_separation>0.5</wheel_separation>")
    )
    files = {
        "package.xml": MANIFEST.format(AMENT),
        "urdf/drive.xacro": robot(block),
        "urdf/small.urdf.xacro": build("0.1"),
    }
    (alone,) = find(tmp_path / "alone", files, "CTL007", name="urdf/small.urdf.xacro")
    files["urdf/large.urdf.xacro"] = build("0.25")
    whole = {
        **files,
        "urdf/drive.xacro": files["urdf/small.urdf.xacro"].replace('<xacro:include filename="drive.xacro"/>', block),
    }
    whole["urdf/small.urdf.xacro"] = robot('<xacro:include filename="drive.xacro"/>', xacro=True)
    (own,) = find(tmp_path / "own", whole, "CTL007", name="urdf/small.urdf.xacro")
    assert own.fix is not None
    assert own.fix.title.endswith("or correct the wheels' places")
    (shared,) = find(tmp_path / "shared", files, "CTL007", name="urdf/small.urdf.xacro")
    assert alone.fix is not None
    assert shared.fix is not None
    assert alone.fix.title.endswith("or correct the wheels' places")
    assert shared.fix.title.endswith(
        "; large.urdf.xacro includes this file too: if its wheels differ, make it an argument"
    )


# -- control blocks: CTL001, CTL004, CTL005, JNT007 ------------------------------------------------------------------------

TYPE = "<type>transmission_interface/SimpleTransmission</type>"
TRANSMISSION = f'<transmission name="t">{TYPE}<joint name="{{}}"/></transmission>'
PLUGIN = '<gazebo><plugin name="c" filename="libgazebo_ros_control.so"/></gazebo>'


@pytest.mark.parametrize(
    ("by_macro", "plugin", "severity"),
    [(True, "", Severity.WARNING), (True, PLUGIN, Severity.ERROR), (False, "", Severity.WARNING)],
)
def test_transmissions_of_a_part_on_show_drive_nothing(
    tmp_path: Path, by_macro: bool, plugin: str, severity: Severity
) -> None:
    block = TRANSMISSION.format("somewhere_else")
    if by_macro:
        block = f'<xacro:macro name="part">{block}</xacro:macro><xacro:part/>'
    (finding,) = find(tmp_path, robot(link("base"), block, plugin, xacro=True), "CTL001", name="r.urdf.xacro")
    assert (finding.message_id, finding.severity) == ("transmission-strange", severity)


@pytest.mark.parametrize(
    ("inside", "message"),
    [
        ('<xacro:if value="{}"><plugin>mock_components/GenericSystem</plugin></xacro:if>', "plugin-chosen"),
        ('<!-- <plugin>mock_components/GenericSystem</plugin> --><param name="{}">1</param>', "plugin"),
    ],
)
def test_a_plugin_that_arguments_choose_is_not_missing(tmp_path: Path, inside: str, message: str) -> None:
    block = f'<ros2_control name="c" type="system"><hardware>{inside.format("false")}</hardware></ros2_control>'
    (finding,) = find(tmp_path, robot(link("base"), block, xacro=True), "CTL005", name="r.urdf.xacro")
    assert (finding.message_id, finding.severity is Severity.INFO) == (message, message == "plugin-chosen")


@pytest.mark.parametrize("xacro", [True, False])
def test_a_path_of_one_machine_is_written_as_one_of_the_package(tmp_path: Path, xacro: bool) -> None:
    block = (
        '<gazebo><plugin name="c" filename="libgazebo_ros2_control.so">'
        "<parameters>/home/me/ws/install/r/share/r/config/c.yaml</parameters></plugin></gazebo>"
    )
    name = "urdf/r.urdf.xacro" if xacro else "urdf/r.urdf"
    files = {
        "package.xml": MANIFEST.format(AMENT),
        "config/c.yaml": "controller_manager: {ros__parameters: {}}\n",
        name: robot(link("base"), block, xacro=xacro),
    }
    (finding,) = [f for f in find(tmp_path, files, "CTL004", name=name) if f.message_id == "machine"]
    assert finding.fix is not None
    assert "write $(find r)/config/c.yaml" in finding.fix.title
    assert [edit.replacement for edit in finding.fix.edits] == ["$(find r)/config/c.yaml"] * xacro


@pytest.mark.parametrize(
    ("hardware", "interface", "message"),
    [
        ("gazebo_ros2_control/GazeboSystem", '<command_interface name="position"/>', "effort-unused"),
        ("gazebo_ros2_control/GazeboSystem", '<command_interface name="effort"/>', "effort-zero"),
        (
            "gazebo_ros2_control/GazeboSystem",
            '<command_interface name="position"/><param name="pos_kp">9</param>',
            "effort-zero",
        ),
        ("gz_ros2_control/GazeboSimSystem", '<command_interface name="position"/>', "effort-zero"),
    ],
)
def test_a_joint_that_classic_sets_directly_needs_no_effort(
    tmp_path: Path, hardware: str, interface: str, message: str
) -> None:
    control = (
        f'<ros2_control name="c" type="system"><hardware><plugin>{hardware}</plugin></hardware>'
        f'<joint name="j">{interface}</joint></ros2_control>'
    )
    text = robot(
        link("a"), link("b", inertial()), joint("j", "a", "b", limit(-1, 1, effort=0), kind="revolute"), control
    )
    assert [f.message_id for f in find(tmp_path, text, "JNT007")] == [message]


@pytest.mark.parametrize(("name", "found"), [("passive_1", False), ("wrist", True)])
def test_a_passive_joint_has_no_data_sheet(tmp_path: Path, name: str, found: bool) -> None:
    fast = joint(name, "b", "c", limit(-1, 1, velocity=1e9), kind="revolute")
    drive = joint("drive", "a", "b", limit(-1, 1), kind="revolute")
    text = robot(link("a"), link("b", inertial()), link("c", inertial()), drive, fast)
    assert bool(find(tmp_path, text, "JNT007")) == found


@pytest.mark.parametrize(("moves", "severity"), [("revolute", Severity.WARNING), ("fixed", Severity.INFO)])
def test_a_rounded_angle_before_the_first_moving_joint_skews_no_axes(
    tmp_path: Path, moves: str, severity: Severity
) -> None:
    kinds = (moves, "fixed", "fixed", "fixed", "revolute")
    parts = [
        link(f"l{k + 1}")
        + joint(f"j{k}", f"l{k}", f"l{k + 1}", limit(-1, 1) if kind == "revolute" else "", kind=kind, rpy="1.57 0 0")
        for k, kind in enumerate(kinds)
    ]
    (finding,) = find(tmp_path, robot(link("l0"), *parts), "JNT013", targets=("moveit",))
    assert finding.severity == severity


# -- Gazebo: GZB002, GZB004, GZB006, NAM004, COL001 ------------------------------------------------------------------------

CLASSIC_DRIVE = '<gazebo><plugin name="p" filename="libgazebo_ros_diff_drive.so"/></gazebo>'
CLASSIC_HARDWARE = (
    "<ros2_control name='c' type='system'><hardware><plugin>gazebo_ros2_control/GazeboSystem</plugin></hardware>"
    "</ros2_control>"
)


@pytest.mark.parametrize(
    ("launch", "severity"),
    [
        ("Node(package='gazebo_ros')", Severity.WARNING),
        ("Node(package='robot_state_publisher'); open('r.urdf')", Severity.INFO),
        ("Node(package='robot_state_publisher'); open('q.urdf')", Severity.WARNING),
        ("Node(package='robot_state_publisher'); open('r.urdf'); Node(package='gazebo_ros')", Severity.WARNING),
    ],
)
def test_ros_2_cannot_load_the_control_of_ros_1_in_classic_either(
    tmp_path: Path, launch: str, severity: Severity
) -> None:
    files = {
        "package.xml": MANIFEST.format(AMENT),
        "launch/go.launch.py": launch,
        "urdf/r.urdf": robot(link("base"), PLUGIN),
    }
    (finding,) = find(tmp_path, files, "GZB002", name="urdf/r.urdf")
    assert finding.severity == severity


@pytest.mark.parametrize("body", [CLASSIC_DRIVE, CLASSIC_HARDWARE])
@pytest.mark.parametrize(
    ("launch", "severity"),
    [
        ("Node(package='gazebo_ros', executable='spawn_entity.py')", Severity.INFO),
        ("# Node(package='ros_gz_sim')", Severity.INFO),
        ("Node(package='gazebo_ros'); Node(package='ros_gz_sim')", Severity.WARNING),
    ],
)
def test_a_launch_file_that_starts_classic_chooses_it(
    tmp_path: Path, body: str, launch: str, severity: Severity
) -> None:
    files = {
        "package.xml": MANIFEST.format(AMENT),
        "launch/go.launch.py": launch,
        "urdf/r.urdf": robot(link("base"), body),
    }
    (finding,) = find(tmp_path, files, "GZB002", name="urdf/r.urdf")
    assert finding.severity == severity


@pytest.mark.parametrize(("kind", "told"), [("ray", True), ("gpu_ray", False)])
def test_a_lidar_without_a_graphics_card_has_no_successor(tmp_path: Path, kind: str, told: bool) -> None:
    plugin = '<plugin name="p" filename="libgazebo_ros_ray_sensor.so"/>'
    block = f'<gazebo reference="base"><sensor name="s" type="{kind}">{plugin}</sensor></gazebo>'
    (finding,) = find(tmp_path, robot(link("base"), block), "GZB002")
    assert finding.fix is not None
    assert ("gpu_lidar" in finding.fix.title) == told


@pytest.mark.parametrize(("reference", "found"), [("base", True), ("nowhere", False)])
def test_a_block_for_no_link_has_no_frames(tmp_path: Path, reference: str, found: bool) -> None:
    sensor = (
        '<sensor name="s" type="ray"><plugin name="p" filename="x"><frame_name>hokuyo</frame_name></plugin></sensor>'
    )
    text = robot(link("base"), f'<gazebo reference="{reference}">{sensor}</gazebo>')
    assert bool(find(tmp_path, text, "GZB004")) == found


GZ = '<gazebo><plugin filename="gz_ros2_control-system" name="s"/></gazebo>'
BRIDGE = '- ros_topic_name: "/scan"\n  gz_topic_name: "/scan"\n  frame_id: "{}"\n'


def find_frame(folder: Path, text: str, **config: str) -> list[Finding]:
    files = {"package.xml": MANIFEST.format(""), "urdf/r.urdf": text}
    return find(
        folder, files | {f"config/{name}.yaml": text for name, text in config.items()}, "GZB006", name="urdf/r.urdf"
    )


@pytest.mark.parametrize(
    ("bridge", "found"),
    [
        (BRIDGE.format("lidar"), False),
        (BRIDGE.format("other"), True),
        (BRIDGE.replace("/scan", "/laser").format("lidar"), True),
    ],
)
def test_a_bridge_may_write_the_frame(tmp_path: Path, bridge: str, found: bool) -> None:
    sensor = '<sensor name="s" type="gpu_lidar"><topic>scan</topic></sensor>'
    text = robot(link("lidar"), f'<gazebo reference="lidar">{sensor}</gazebo>', GZ)
    assert bool(find_frame(tmp_path, text, bridge=bridge)) == found


def test_the_frame_names_the_link_that_gazebo_merges_into(tmp_path: Path) -> None:
    sensor = '<gazebo reference="lidar"><sensor name="s" type="gpu_lidar"/></gazebo>'
    text = robot(link("base", inertial()), link("lidar"), joint("j", "base", "lidar"), sensor, GZ)
    (finding,) = find_frame(tmp_path / "a", text)
    assert finding.data["example"] == "r/base/s"
    assert not find_frame(tmp_path / "b", text, transform="frame: r/base/s\n")


@pytest.mark.parametrize(("pose", "found"), [("0 0 0 0 -1.5707 -1.5707", False), ("0.1 0 0 0 0 0", True)])
def test_a_camera_that_is_turned_in_its_link_looks_elsewhere(tmp_path: Path, pose: str, found: bool) -> None:
    sensor = f'<sensor name="s" type="camera"><pose>{pose}</pose></sensor>'
    text = robot(
        link("camera_link"),
        link("camera_optical_frame"),
        joint("j", "camera_link", "camera_optical_frame", rpy="1.57079633 0 3.14159265"),
        f'<gazebo reference="camera_link">{sensor}</gazebo>',
    )
    assert bool(find(tmp_path, text, "NAM004")) == found


@pytest.mark.parametrize(
    ("ends", "kind", "found"),
    [(("b", "c"), "fixed", False), (("a", "c"), "revolute", False), (("b", "c"), "revolute", True), (None, "", True)],
)
def test_parts_that_gazebo_joins_may_overlap_as_neighbours_do(
    tmp_path: Path, ends: tuple[str, str] | None, kind: str, found: bool
) -> None:
    """Three cubes in a row; the last one is folded back into the first."""
    pytest.importorskip("coal")
    cube = collision(box("0.1 0.1 0.1"))
    turns = [
        joint(f"{one}_{other}", one, other, limit(-1, 1), kind="revolute", xyz=xyz, axis="0 0 1")
        for one, other, xyz in (("a", "b", "0.3 0 0"), ("b", "c", "-0.27 0 0"))
    ]
    one, other = ends or ("", "")
    inner = f"<parent>{one}</parent><child>{other}</child>"
    loop = f'<gazebo><joint name="l" type="{kind}">{inner}</joint></gazebo>' if ends else ""
    text = robot(*(link(name, inertial(), cube) for name in "abc"), *turns, loop)
    assert bool(find(tmp_path, text, "COL001")) == found


@pytest.mark.parametrize(
    ("name", "value", "count"), [("negligible", "1e-5", 0), ("small", "1e-5", 1), ("tiny", "0.1", 1)]
)
def test_a_mass_that_is_called_negligible_and_is_so_is_chosen(
    tmp_path: Path, name: str, value: str, count: int
) -> None:
    box = '<{0}><geometry><box size="0.02 0.02 0.02"/></geometry></{0}>'
    inertia = '<inertia ixx="${i}" ixy="0" ixz="0" iyy="${i}" iyz="0" izz="${i}"/>'
    own = f'<inertial><mass value="${{{name}}}"/>{inertia.replace("i}", name + "}")}</inertial>'
    body = (
        '<inertial><mass value="12"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>'
        '<collision><geometry><box size="0.3 0.2 0.2"/></geometry></collision>'
    )
    text = (
        f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:property name="{name}" value="{value}"/>'
        f'<link name="hull">{body}</link><link name="rotor">{own}{box.format("visual")}{box.format("collision")}</link>'
        '<joint name="j" type="continuous"><parent link="hull"/><child link="rotor"/><axis xyz="0 0 1"/></joint></robot>'
    )
    assert len(find(tmp_path, text, "INR005", name="r.urdf.xacro")) == count
