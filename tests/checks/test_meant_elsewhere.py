"""What looks wrong in the model alone and is meant: rollers under a wheel, arguments, fingers, programs that negate a side."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import box, collision, cylinder, find, inertial, joint, limit, link, robot, sphere, visual

from urdfcheck.core import Severity

TURN = "1.5707963267948966 0 0"
DISK = collision(cylinder(0.05, 0.02), rpy=TURN)
DRIVE = """<gazebo><plugin filename="{}" name="p"><left_joint>left_wheel_joint</left_joint>
<right_joint>right_wheel_joint</right_joint></plugin></gazebo>"""
DIFFERENTIAL = DRIVE.format("gz-sim-diff-drive-system")


def cart(*more: str, left_axis: str = "0 1 0") -> str:
    """Return a robot on two driven wheels and a ball."""
    return robot(
        link("base_link", inertial(3, 0.03)),
        *(link(f"{side}_wheel", DISK) for side in ("left", "right")),
        joint("left_wheel_joint", "base_link", "left_wheel", kind="continuous", xyz="0 0.15 0.05", axis=left_axis),
        joint("right_wheel_joint", "base_link", "right_wheel", kind="continuous", xyz="0 -0.15 0.05", axis="0 1 0"),
        link("ball", collision(sphere(0.01))),
        joint("ball_joint", "base_link", "ball", xyz="-0.1 0 0.01"),
        *more,
    )


def surface(name: str, friction: float) -> str:
    return f'<gazebo reference="{name}"><mu1>{friction}</mu1><mu2>{friction}</mu2></gazebo>'


# -- GZB008 ----------------------------------------------------------------------------------------------------------------

SLIPPERY = surface("left_wheel", 0) + surface("right_wheel", 0) + DIFFERENTIAL


def attach_rollers(kind: str, *, collides: bool = True) -> str:
    shape = (collision if collides else visual)(sphere(0.01))
    return "".join(
        link(f"{side}_roller", shape)
        + joint(f"{side}_r", f"{side}_wheel", f"{side}_roller", kind=kind, xyz="0 0 -0.05")
        for side in ("left", "right")
    )


@pytest.mark.parametrize("kind", ["continuous", "fixed"])
def test_a_hub_slides_where_its_rollers_or_its_tyre_touch_the_ground(tmp_path: Path, kind: str) -> None:
    assert not find(tmp_path, cart(SLIPPERY, attach_rollers(kind)), "GZB008")


def test_wheels_slide_with_rollers_that_slide_too_or_touch_nothing(tmp_path: Path) -> None:
    smooth = surface("left_roller", 0) + surface("right_roller", 0)
    for i, more in enumerate(("", attach_rollers("fixed") + smooth, attach_rollers("fixed", collides=False))):
        (finding,) = find(tmp_path / str(i), cart(SLIPPERY, more), "GZB008")
        assert finding.message_id == "slides"


CASTER = joint("c", "base_link", "caster", xyz="-0.1 0 0") + surface("caster", 1)


@pytest.mark.parametrize(
    ("more", "messages"),
    [
        (link("caster", collision(sphere(0.01))), ["drags"]),
        (link("caster"), []),
        (
            link("caster", collision(sphere(0.01))) + link("w") + joint("w_joint", "caster", "w", kind="continuous"),
            [],
        ),
        (
            link("caster", collision(sphere(0.01)))
            + '<gazebo><plugin name="p" filename="libgazebo_ros_planar_move.so"/></gazebo>',
            [],
        ),
    ],
)
def test_a_fixed_caster_drags_if_it_touches_cannot_roll_and_nothing_pushes(
    tmp_path: Path, more: str, messages: list[str]
) -> None:
    assert [f.message_id for f in find(tmp_path, cart(more, CASTER), "GZB008")] == messages


# -- SYM005 ----------------------------------------------------------------------------------------------------------------

CONTROLLER = """controller_manager: {ros__parameters: {d: {type: diff_drive_controller/DiffDriveController}}}
d: {ros__parameters: {left_wheel_names: [left_wheel_joint], right_wheel_names: [right_wheel_joint]}}
"""


@pytest.mark.parametrize(
    ("plugin", "severity"),
    [
        (DIFFERENTIAL, Severity.WARNING),
        (DRIVE.format("gz-sim-mecanum-drive-system"), Severity.WARNING),
        (DIFFERENTIAL.replace("right_wheel_joint", "left_wheel_joint"), Severity.INFO),
        (DRIVE.format("libmy_drive.so"), Severity.INFO),
        ("", Severity.INFO),
    ],
)
def test_opposite_axes_are_a_mistake_where_both_sides_get_one_sign(
    tmp_path: Path, plugin: str, severity: Severity
) -> None:
    (finding,) = find(tmp_path, cart(plugin, left_axis="0 -1 0"), "SYM005")
    assert (finding.message_id, finding.severity) == ("opposed", severity)


def test_a_drive_controller_of_the_package_gives_both_sides_one_sign(tmp_path: Path) -> None:
    files = {
        "package.xml": '<package format="3"><name>cart</name></package>',
        "config/c.yaml": CONTROLLER,
        "urdf/cart.urdf": cart(left_axis="0 -1 0"),
    }
    (finding,) = find(tmp_path, files, "SYM005", name="urdf/cart.urdf")
    assert finding.severity == Severity.WARNING


# -- SYM001 ----------------------------------------------------------------------------------------------------------------


def hand(*, beside: bool) -> str:
    """Return two fingers that fan out by 5°, beside each other on one palm or on a palm each."""
    finger = inertial(0.03, 1e-5, com="0.02 0 0") + visual(cylinder(0.005, 0.05))
    sides = []
    for i, (y, rpy) in enumerate((("0", "0 0 0"), ("0.021", "0.0872665 0 0"))):
        palm = "palm" if beside else f"palm_{i}"
        place = f"{0.013 * i} {y} {0.0062 * i * beside}"
        sides += [link(f"finger_{i}", finger)]
        sides += [joint(f"f{i}", palm, f"finger_{i}", kind="continuous", xyz=place, rpy=rpy, axis="0 0 1")]
        if not beside:
            sides += [link(palm), joint(f"p{i}", "wrist", palm, kind="fixed")]
    return robot(link("wrist"), *([link("palm"), joint("p", "wrist", "palm")] if beside else []), *sides)


def test_fingers_of_one_palm_may_fan_out(tmp_path: Path) -> None:
    assert not find(tmp_path / "a", hand(beside=True), "SYM001")
    (finding,) = find(tmp_path / "b", hand(beside=False), "SYM001")
    assert finding.message_id == "pair_tilt"


@pytest.mark.parametrize(("pinky", "count"), [(0.08, 0), (0.2, 1)])
def test_fingers_that_mirror_others_are_no_pair(tmp_path: Path, pinky: float, count: int) -> None:
    """Index and ring are alike, and at one height: but index is the mirror image of pinky, and middle that of ring."""
    fingers = {
        "index": (0.03, "0 -0.03 0.11", "-0.08 0 0"),
        "middle": (0.035, "0 -0.01 0.111", "-0.03 0 0"),
        "ring": (0.03, "0 0.01 0.11", "0.03 0 0"),
        "pinky": (0.025, "0 0.03 0.108", f"{pinky} 0 0"),
    }
    parts = []
    for name, (mass, place, rpy) in fingers.items():
        parts += [link(name, inertial(mass, 1e-5, com="0.02 0 0") + visual(cylinder(0.005, 0.05)))]
        parts += [joint(f"{name}_joint", "palm", name, kind="continuous", xyz=place, rpy=rpy, axis="0 0 1")]
    assert len(find(tmp_path, robot(link("palm"), *parts), "SYM001")) == count


# -- CTL003, CTL004 --------------------------------------------------------------------------------------------------------

TRANSMISSION = """<transmission name="t"><type>transmission_interface/SimpleTransmission</type>
<joint name="left_wheel_joint">{}</joint></transmission>"""
CLASSIC = '<gazebo><plugin name="c" filename="libgazebo_ros_control.so"/></gazebo>'
AMENT = "<export><build_type>ament_cmake</build_type></export>"


@pytest.mark.parametrize("inside", ["", "<hardwareInterface>EffortJointInterfce</hardwareInterface>"])
def test_nothing_in_ros_2_reads_the_interface_of_a_transmission(tmp_path: Path, inside: str) -> None:
    def count(name: str, more: str = "", export: str = "") -> int:
        files = {
            "package.xml": f'<package format="3"><name>cart</name>{export}</package>',
            "urdf/cart.urdf": cart(TRANSMISSION.format(inside), more),
        }
        return len(find(tmp_path / name, files, "CTL003", name="urdf/cart.urdf"))

    assert count("a") == 1
    assert count("b", export=AMENT) == 0
    assert count("c", '<ros2_control name="s" type="system"/>') == 0
    assert count("d", CLASSIC, export=AMENT) == 1


LOADER = """<gazebo><plugin filename="libgz_ros2_control-system.so" name="p">
<parameters>$(find cart)/config/c.yaml</parameters></plugin></gazebo>"""
VELOCITY = """controller_manager: {ros__parameters: {v: {type: velocity_controllers/JointGroupVelocityController}}}
v: {ros__parameters: {joints: [left_wheel_joint]}}
"""


@pytest.mark.parametrize(
    ("interface", "count"),
    [
        ('<command_interface name="position"/>', 1),
        ('<command_interface name="${kind}"/>', 1),
        ('<command_interface name="$(arg mode)"/>', 0),
        ('<command_interface name="${mode}"/>', 0),
        ('<xacro:if value="$(arg fast)"><command_interface name="velocity"/></xacro:if>', 0),
        ('<!-- <command_interface name="velocity"/> --><command_interface name="position"/>', 1),
    ],
)
def test_a_controller_may_be_for_the_interface_of_another_argument(tmp_path: Path, interface: str, count: int) -> None:
    block = (
        '<xacro:arg name="mode" default="position"/><xacro:arg name="fast" default="false"/>'
        '<xacro:property name="kind" value="position"/><xacro:property name="mode" value="$(arg mode)"/>'
        f'<ros2_control name="s" type="system"><joint name="left_wheel_joint">{interface}</joint></ros2_control>'
    )
    text = cart(block, LOADER).replace("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ')
    files = {
        "package.xml": '<package format="3"><name>cart</name></package>',
        "config/c.yaml": VELOCITY,
        "urdf/cart.urdf.xacro": text,
    }
    found = find(tmp_path, files, "CTL004", name="urdf/cart.urdf.xacro")
    assert len(found) == count


# -- GZB001, GZB003, GZB004 ------------------------------------------------------------------------------------------------

SHAPE = collision(box("0.1 0.1 0.1"))
LEG = robot(
    link("leg", inertial(), SHAPE),
    link("foot", inertial(), SHAPE),
    joint("foot_fixed", "leg", "foot"),
    '<gazebo reference="foot"><sensor name="s" type="contact"><contact><collision>foot_collision</collision></contact>'
    "</sensor></gazebo>",
    '<gazebo reference="{}"><preserveFixedJoint>true</preserveFixedJoint></gazebo>',
)


@pytest.mark.parametrize(
    ("kept", "found"),
    [
        ("foot_joint", [("GZB001", "unknown")]),
        ("foot", [("GZB003", "link")]),
        ("foot_fixed", []),
        ("hand_joint", [("GZB001", "unknown"), ("GZB004", "collision")]),
    ],
)
def test_a_foot_that_is_to_be_kept_needs_no_other_name_in_its_sensor(
    tmp_path: Path, kept: str, found: list[tuple[str, str]]
) -> None:
    findings = find(tmp_path, LEG.format(kept), {"GZB001", "GZB003", "GZB004"})
    assert sorted((f.code, f.message_id) for f in findings) == found
    assert any("did you mean 'foot_fixed'?" in f.message for f in findings) == (kept == "foot_joint")
    assert not any(f.fix is not None and f.fix.edits for f in findings if f.code == "GZB001")


@pytest.mark.parametrize(
    ("frame", "guess"),
    [("us_1_link", ""), ("scaner_link", "scanner_link"), ("wrist_link", "wrist_1_link"), ("link", "")],
)
def test_a_frame_is_guessed_by_its_own_words(tmp_path: Path, frame: str, guess: str) -> None:
    links = [link("base"), *(link(name) for name in ("wrist_1_link", "scanner_link"))]
    joints = [joint(f"j{i}", "base", name) for i, name in enumerate(("wrist_1_link", "scanner_link"))]
    sensor = (
        f'<gazebo reference="base"><sensor name="s" type="imu"><gz_frame_id>{frame}</gz_frame_id></sensor></gazebo>'
    )
    (finding,) = find(tmp_path, robot(*links, *joints, sensor), "GZB004")
    assert finding.data["meant"] == guess
    assert finding.message_id == ("frame" if guess else "frame-elsewhere")


def test_a_named_shape_is_not_said_to_lack_a_name_that_it_has(tmp_path: Path) -> None:
    text = robot(link("wheel", inertial(), collision(sphere(0.1), name="collision")), surface("wheel", 0.7))
    (finding,) = find(tmp_path, text, "GZB003")
    assert "wheel_fixed_joint_lump__collision_collision" in finding.message
    assert "It looks for wheel_collision at the start of that name or behind lump__" in finding.message


# -- NAM004 ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("reference", "kind", "moved"),
    [("eye_optical", "camera", True), ("eye_link", "camera", False), ("eye_optical", "imu", False)],
)
def test_a_camera_on_its_optical_frame_is_moved_before_the_frame_is_rotated(
    tmp_path: Path, reference: str, kind: str, moved: bool
) -> None:
    text = robot(
        link("eye_link"),
        link("eye_optical"),
        joint("j", "eye_link", "eye_optical", rpy="3.14159265 0 0"),
        f'<gazebo reference="{reference}"><sensor name="s" type="{kind}"/></gazebo>',
    )
    (finding,) = find(tmp_path, text, "NAM004")
    assert finding.fix is not None
    assert ("attach sensor s to eye_link" in finding.fix.title) == moved
    assert 'write rpy="-1.5707963267948966 0 -1.5707963267948966"' in finding.fix.title
    # A block that these arguments leave out is read as typed.
    left_out = text.replace("<gazebo", '<xacro:if value="false"><gazebo').replace("</gazebo>", "</gazebo></xacro:if>")
    left_out = left_out.replace("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ')
    (same,) = find(tmp_path / "x", left_out, "NAM004", name="r.urdf.xacro")
    assert same.fix is not None
    assert same.fix.title == finding.fix.title


# -- XML003 ----------------------------------------------------------------------------------------------------------------


def test_different_numbers_of_several_joints_are_alternatives(tmp_path: Path) -> None:
    joints = "".join(
        joint(f"j{n}", "a", f"b{n}", limit(-1, 1, effort=1000), f'<joint_properties damping="{n}"/>', kind="revolute")
        for n in range(1, 6)
    )
    text = robot(link("a"), *(link(f"b{n}") for n in range(1, 6)), joints)
    (finding,) = find(tmp_path, text, "XML003")
    assert finding.fix is not None
    assert "programs then use damping 1 or 2 or 3 or 2 other values." in finding.fix.title


@pytest.mark.parametrize(
    ("properties", "words", "edits"),
    [
        ('<joint_properties damping="0.5" friction="2"/>', "programs then use damping 0.5, friction 2", 1),
        ('<joint_properties damping="1." friction="1.0"/>', "programs then use damping 1, friction 1", 1),
        ('<joint_properties damping="100" friction="1000"/>', "less friction than `1000`", 0),
        ('<joint_properties damping="1000"/>', "less damping than 1000: at the velocity limit 1 it takes 1e+03", 0),
        (
            '<joint_properties damping="1"/><joint_properties friction="1"/>',
            "a single `<dynamics>` where a <joint> has the element twice",
            0,
        ),
    ],
)
def test_numbers_that_no_program_has_read_are_named_before_they_take_effect(
    tmp_path: Path, properties: str, words: str, edits: int
) -> None:
    text = robot(
        link("a"), link("b"), joint("j", "a", "b", limit(-1, 1, effort=1000), properties, kind="revolute", axis="0 1 0")
    )
    (finding,) = find(tmp_path, text, "XML003")
    assert finding.fix is not None
    assert words in finding.fix.title
    assert len(finding.fix.edits) == edits
