"""Gazebo blocks and control interfaces."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import box, collision, find, inertial, joint, link, robot, visual
from conftest import check, check_text

from urdfcheck.core import Severity
from urdfcheck.core.merging import join_occurrences
from urdfcheck.model import Model
from urdfcheck.model.fixed_joint_lumping import reduce_fixed_joints
from urdfcheck.rules import load_rules
from urdfcheck.source.launch import model_launches
from urdfcheck.source.load import load_source
from urdfcheck.source.package.finder import PackageFinder

ARM = """<link name="a"/><link name="b"/><link name="c"/>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint>
<joint name="k" type="continuous"><parent link="a"/><child link="c"/></joint>"""


@pytest.mark.parametrize("reference", ["a", "j"])
def test_links_and_joints_can_be_referred_to(tmp_path: Path, reference: str) -> None:
    assert not find(tmp_path, robot(ARM, f'<gazebo reference="{reference}"><mu1>1</mu1></gazebo>'), "GZB001")


def test_one_unknown_name_is_one_finding(tmp_path: Path) -> None:
    body = '<gazebo reference="nobody"><mu1>1</mu1></gazebo>\n<gazebo reference="nobody"><mu2>1</mu2></gazebo>'
    (finding,) = find(tmp_path, robot(ARM, body), "GZB001")
    assert "mu1, mu2" in finding.message
    assert len(finding.related) == 1


def test_references_that_a_script_has_not_filled_in_are_one_finding(tmp_path: Path) -> None:
    body = "".join(f'<gazebo reference="{name}"><mu1>1</mu1></gazebo>' for name in ("{side}_a", "{side}_b", "nobody"))
    messages = {f.message_id: f for f in find(tmp_path, robot(ARM, body), "GZB001")}
    assert set(messages) == {"template", "unknown"}
    assert "2 <gazebo> blocks" in messages["template"].message


@pytest.mark.parametrize(
    ("filename", "words"),
    [
        ("libgazebo_ros_diff_drive.so", "gz-sim-diff-drive-system"),
        ("libgazebo_ros2_control.so", "gz_ros2_control"),
        ("libgazebo_ros_depth_camera.so", "gz-sim-sensors-system"),
        ("libhector_gazebo_ros_imu.so", "gz-sim-imu-system"),
        ("libgazebo_ros_ackerman.so", "gz-sim-ackermann-steering-system"),
        ("gz-sim-imu-system", None),
        ("ignition-gazebo-imu-system", None),
        ("libgz_ros2_control-system.so", None),
    ],
)
def test_plugins_of_gazebo_classic_have_a_successor(tmp_path: Path, filename: str, words: str | None) -> None:
    findings = find(tmp_path, robot(ARM, f'<gazebo><plugin name="p" filename="{filename}"/></gazebo>'), "GZB002")
    assert bool(findings) == (words is not None)
    assert all(f.fix is not None and str(words) in f.fix.title for f in findings)


def test_the_way_to_the_successor_is_shown_and_never_written(tmp_path: Path) -> None:
    """The names alone would leave a robot that runs in neither simulator."""
    body = (
        '<ros2_control name="c" type="system"><hardware><plugin> gazebo_ros2_control/GazeboSystem\n</plugin></hardware>'
        '</ros2_control><gazebo><plugin name="c" filename="libgazebo_ros2_control.so"><parameters>c.yaml</parameters>'
        "<robot_sim_type>gazebo_ros2_control/GazeboSystem</robot_sim_type></plugin></gazebo>"
    )
    (finding,) = find(tmp_path, robot(ARM, body), "GZB002")
    assert finding.fix is not None
    assert not finding.fix.edits
    assert "gz_ros2_control/GazeboSimSystem" in finding.fix.title
    assert [place.subject.split("/")[0] for place in finding.related] == ["ros2_control[c]"]


ROS1_PLUGIN = '<gazebo><plugin name="old" filename="libgazebo_ros_laser.so"/></gazebo>'
CLASSIC = '<gazebo><plugin name="p" filename="libgazebo_ros_diff_drive.so"/></gazebo>'
MANIFEST = '<package format="3"><name>p</name><version>1.0.0</version><description>d</description>{}</package>'


@pytest.mark.parametrize(
    ("manifest", "body", "targets", "severity"),
    [
        ("<export><build_type>ament_cmake</build_type></export>", "", (), Severity.INFO),
        ("<export><build_type>ament_cmake</build_type></export>", ROS1_PLUGIN, (), Severity.WARNING),
        ("<buildtool_depend>ament_cmake</buildtool_depend>", ROS1_PLUGIN, (), Severity.WARNING),
        ("<depend>ament_cmake</depend><depend>catkin</depend>", ROS1_PLUGIN, (), Severity.INFO),
        ("<buildtool_depend>catkin</buildtool_depend>", ROS1_PLUGIN, (), Severity.INFO),
        ("<buildtool_depend>catkin</buildtool_depend>", "", (), Severity.INFO),
        ("<buildtool_depend>catkin</buildtool_depend>", "", ("gazebo",), Severity.WARNING),
        ("<buildtool_depend>catkin</buildtool_depend>", "", ("moveit",), Severity.INFO),
        (None, "", (), Severity.INFO),
        (None, '<ros2_control name="c" type="system"/>', (), Severity.INFO),
        (None, '<ros2_control name="c" type="system"/>' + ROS1_PLUGIN, (), Severity.WARNING),
        (None, '<gazebo><plugin name="n" filename="gz-sim-imu-system"/></gazebo>', (), Severity.WARNING),
        ("<buildtool_depend>ament_cmake</buildtool_depend><depend>gazebo_ros</depend>", "", (), Severity.INFO),
        (
            "<buildtool_depend>ament_cmake</buildtool_depend><depend>gazebo_ros</depend>",
            "",
            ("gazebo",),
            Severity.WARNING,
        ),
        (
            "<buildtool_depend>ament_cmake</buildtool_depend><depend>gazebo_ros</depend><depend>ros_gz_sim</depend>",
            "",
            (),
            Severity.WARNING,
        ),
    ],
)
def test_a_plugin_of_classic_matters_to_robots_of_ros_2(
    tmp_path: Path, manifest: str | None, body: str, targets: tuple[str, ...], severity: Severity
) -> None:
    if manifest is not None:
        (tmp_path / "package.xml").write_text(MANIFEST.format(manifest))
    (finding,) = find(tmp_path, robot(ARM, CLASSIC, body), "GZB002", targets=targets)
    assert finding.severity == severity


def test_a_project_that_starts_classic_needs_its_plugins(tmp_path: Path) -> None:
    (tmp_path / "package.xml").write_text(MANIFEST.format("<depend>ros_gz_sim</depend>"))
    (tmp_path / "classic.launch.py").write_text("Node(package='gazebo_ros', executable='spawn_entity.py')")
    (finding,) = find(tmp_path, robot(ARM, CLASSIC), "GZB002")
    assert finding.severity == Severity.INFO
    (tmp_path / "package.xml").write_text(MANIFEST.format("<export><build_type>ament_cmake</build_type></export>"))
    (finding,) = find(tmp_path, robot(ARM, CLASSIC, ROS1_PLUGIN), "GZB002")
    assert (finding.severity, finding.fix and finding.fix.title) == (
        Severity.WARNING,
        "for Gazebo Classic in ROS 2, replace gazebo_ros_laser by gazebo_ros_ray_sensor",
    )
    (finding,) = find(tmp_path, robot(ARM, ROS1_PLUGIN), "GZB002")
    assert finding.headline == "1 plugin is for ROS 1 only: gazebo_ros_laser"


def test_a_control_plugin_of_ros_1_is_deleted_where_that_of_ros_2_is_loaded(tmp_path: Path) -> None:
    (tmp_path / "package.xml").write_text(MANIFEST.format("<export><build_type>ament_cmake</build_type></export>"))
    (tmp_path / "classic.launch.py").write_text("Node(package='gazebo_ros', executable='spawn_entity.py')")
    files = ("libgazebo_ros_control.so", "libgazebo_ros2_control.so")
    body = "".join(f'<gazebo><plugin name="p{i}" filename="{name}"/></gazebo>' for i, name in enumerate(files))
    (finding,) = find(tmp_path, robot(ARM, body, ROS1_PLUGIN), "GZB002")
    title = finding.fix.title if finding.fix else ""
    start = "for Gazebo Classic in ROS 2, delete gazebo_ros_control: gazebo_ros2_control is loaded already ("
    assert title.startswith(start)
    assert title.endswith("); replace gazebo_ros_laser by gazebo_ros_ray_sensor")


def test_a_plugin_with_other_parameters_is_not_renamed(tmp_path: Path) -> None:
    body = '<gazebo><plugin name="p" filename="libgazebo_ros_diff_drive.so"/></gazebo>'
    (finding,) = find(tmp_path, robot(ARM, body), "GZB002")
    assert finding.fix is not None
    assert not finding.fix.edits


def test_plugins_with_one_successor_share_its_advice(tmp_path: Path) -> None:
    names = ("libgazebo_ros_camera.so", "libgazebo_ros_ray_sensor.so", "libgazebo_ros_p3d.so")
    body = "".join(f'<gazebo><plugin name="p" filename="{name}"/></gazebo>' for name in names)
    (finding,) = find(tmp_path, robot(ARM, body), "GZB002")
    assert finding.fix is not None
    stay = "nothing for a robot that stays with Classic; to migrate, "
    assert finding.fix.title.startswith(f"{stay}replace gazebo_ros_camera, gazebo_ros_ray_sensor by the <sensor> alone")
    assert finding.fix.title.endswith("; gazebo_ros_p3d by gz-sim-odometry-publisher-system")
    assert finding.headline == "3 plugins are Gazebo Classic only: gazebo_ros_camera and 2 more"


def test_the_headline_counts_materials_and_lists_their_names(tmp_path: Path) -> None:
    names = ("Gazebo/DarkGrey", "Gazebo/DarkGrey", "Gazebo/FlatBlack")
    body = "".join(block("a", f"<material>{name}</material>\n") for name in names)
    (finding,) = find(tmp_path, robot(ARM, body), "GZB002")
    assert finding.headline == "3 materials use Gazebo Classic names (DarkGrey, FlatBlack)"


# -- what Gazebo merges -------------------------------------------------------------------------------------------------

SHAPE = "<geometry><box size='1 1 1'/></geometry>"


def make_link(name: str, mass: float = 1.0, *collisions: str) -> str:
    """Return a link with collisions of these names (empty: none)."""
    return link(name, inertial(mass) if mass else "", *(collision(box("1 1 1"), name=c) for c in collisions))


def fixed(name: str, parent: str, child: str, type_: str = "fixed") -> str:
    return f'<joint name="{name}" type="{type_}"><parent link="{parent}"/><child link="{child}"/></joint>'


def block(reference: str, *content: str) -> str:
    return f'<gazebo reference="{reference}">{"".join(content)}</gazebo>'


def messages(folder: Path, body: str, code: str) -> list[str]:
    return [f.message_id for f in find(folder, robot(body), code)]


MERGED = (
    make_link("base", 1.0, "", "foot")
    + make_link("tip", 1.0, "")
    + make_link("base_tip", 0.0, "")
    + make_link("named", 0.0, "foo", "base_bar")
    + make_link("inner", 0.0, "")
    + fixed("j", "base", "tip")
    + fixed("k", "base", "base_tip")
    + fixed("h", "base", "named")
    + fixed("l", "named", "inner")
)


def test_the_shapes_are_called_as_sdformat_calls_them(tmp_path: Path) -> None:
    """What sdformat 12.3 makes of this robot: joints in the order of their names, each branch before the next."""
    path = tmp_path / "robot.urdf"
    path.write_text(f'<robot name="r">{MERGED}</robot>', encoding="utf-8")
    source = load_source(path, {}, PackageFinder(path))
    assert source.root is not None
    assert [shape.name for shape in reduce_fixed_joints(Model(source=source, robot=source.root)).collisions] == [
        "base_collision",
        "base_fixed_joint_lump__foot_collision_1",
        "base_fixed_joint_lump__foo_collision_2",
        "base_bar_collision_3",
        "base_fixed_joint_lump__inner_collision_4",
        "base_fixed_joint_lump__tip_collision_5",
        "base_tip_collision_6",
    ]


@pytest.mark.parametrize(
    ("other", "expected"),
    [
        ('<xacro:unless value="${classic}"><plugin name="n" filename="ign_ros2_control-system"/></xacro:unless>', []),
        (
            '<xacro:unless value="${other}"><plugin name="n" filename="gz_ros2_control-system"/></xacro:unless>',
            ["plugin"],
        ),
        ("", ["plugin"]),
    ],
)
def test_a_model_with_a_branch_for_the_new_gazebo_keeps_that_for_classic(
    tmp_path: Path, other: str, expected: list[str]
) -> None:
    classic = '<xacro:if value="${classic}"><plugin name="c" filename="libgazebo_ros2_control.so"/></xacro:if>'
    values = '<xacro:property name="classic" value="true"/><xacro:property name="other" value="true"/>'
    block = f'<link name="a"/><gazebo>{classic}{other}</gazebo>'
    text = f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{values}{block}</robot>'
    assert [f.message_id for f in check_text(tmp_path, text, "r.urdf.xacro", codes={"GZB002"}).findings] == expected


@pytest.mark.parametrize("loaded", ["gz_ros2_control-system", "libign_ros2_control-system.so"])
def test_a_plugin_whose_successor_is_loaded_is_to_be_deleted(tmp_path: Path, loaded: str) -> None:
    plugins = f'<plugin name="a" filename="libgazebo_ros_control.so"/><plugin name="b" filename="{loaded}"/>'
    (finding,) = find(tmp_path, robot(ARM, f"<gazebo>{plugins}</gazebo>"), "GZB002")
    assert finding.fix is not None
    assert finding.fix.title.startswith("delete gazebo_ros_control: gz_ros2_control-system is loaded already (")


@pytest.mark.parametrize(
    ("reference", "lost"),
    [("base", ["named"]), ("tip", []), ("inner", []), ("base_tip", ["prefix"]), ("named", ["named"])],
)
def test_friction_finds_its_link_by_the_name_of_the_shape(tmp_path: Path, reference: str, lost: list[str]) -> None:
    assert messages(tmp_path, MERGED + block(reference, "<mu1>1</mu1>"), "GZB003") == lost


def test_how_many_shapes_do_not_get_it_is_said(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, robot(MERGED + block("base", "<mu1>1</mu1>")), "GZB003")
    assert "for 1 of 2" in finding.message


def test_a_named_shape_loses_its_friction_where_nothing_is_merged_too(tmp_path: Path) -> None:
    for name, lost in (("", []), ("base_link", []), ("base_link_box", []), ("box", ["named"])):
        body = make_link("base_link", 1.0, name) + block("base_link", "<mu1>1</mu1>")
        assert messages(tmp_path, body, "GZB003") == lost


def test_colours_are_worth_knowing(tmp_path: Path) -> None:
    body = f'<link name="a"><visual name="v">{SHAPE}</visual></link>' + block("a", "<material>Gazebo/Red</material>")
    (finding,) = find(tmp_path, robot(body), "GZB003")
    assert (finding.message_id, finding.severity) == ("named", Severity.INFO)


SENSOR = '<sensor name="s" type="force_torque"/>'


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        (block("j", SENSOR), [("joint", Severity.WARNING)]),
        (block("j", '<sensor name="c" type="camera"/>'), [("joint-content", Severity.WARNING)]),
        (block("j", '<plugin filename="libp.so"/>'), [("joint-content", Severity.WARNING)]),
        (block("j", "<provideFeedback>true</provideFeedback>"), [("joint-settings", Severity.INFO)]),
        (block("j", SENSOR, "<preserveFixedJoint>true</preserveFixedJoint>"), []),
        (block("j", SENSOR) + block("j", '<disableFixedJointLumping value="1"/>'), []),
        (block("j", SENSOR, "<preserveFixedJoint>false</preserveFixedJoint>"), [("joint", Severity.WARNING)]),
        (block("tip", SENSOR), []),
        (block("tip", "<preserveFixedJoint>true</preserveFixedJoint>"), [("link", Severity.WARNING)]),
        (block("base", "<preserveFixedJoint>true</preserveFixedJoint>"), [("link", Severity.INFO)]),
        (block("l", "<preserveFixedJoint>true</preserveFixedJoint>"), [("dropped", Severity.WARNING)]),
    ],
)
def test_blocks_of_joints(tmp_path: Path, body: str, expected: list[tuple[str, Severity]]) -> None:
    assert [(f.message_id, f.severity) for f in find(tmp_path, robot(MERGED + body), "GZB003")] == expected


@pytest.mark.parametrize(
    ("kind", "tags", "found"),
    [
        ("fixed", "<mu1>0</mu1><mu2>0</mu2>", ["surface"]),
        ("continuous", "<mu1>0</mu1><mu2>0</mu2>", ["surface"]),
        ("fixed", "<mu1>0</mu1><turnGravityOff>0</turnGravityOff>", ["surface"]),
        ("continuous", "<kp>1</kp><stopCfm>0</stopCfm>", []),
        ("fixed", "<kp>1</kp><stopCfm>0</stopCfm>", ["joint-settings"]),
        ("continuous", "<springStiffness>1</springStiffness>", []),
    ],
)
def test_a_joint_has_no_friction(tmp_path: Path, kind: str, tags: str, found: list[str]) -> None:
    body = make_link("base") + make_link("wheel", 0.1) + fixed("axle", "base", "wheel", kind) + block("axle", tags)
    assert messages(tmp_path, body, "GZB003") == found


@pytest.mark.parametrize(("kind", "spring"), [("fixed", False), ("prismatic", True)])
def test_the_repair_of_friction_of_a_joint_names_the_link(tmp_path: Path, kind: str, spring: bool) -> None:
    """In the block of a joint that moves, kp may be meant for a suspension."""
    body = (
        make_link("base") + make_link("leg", 0.1, "") + fixed("sus", "base", "leg", kind) + block("sus", "<kp>1</kp>")
    )
    (finding,) = find(tmp_path, robot(body), "GZB003")
    assert finding.fix is not None
    assert finding.fix.title.startswith("write the name of the link: leg")
    assert ("springStiffness" in finding.fix.title) is spring


@pytest.mark.parametrize(
    ("leg", "repair"),
    [
        (make_link("leg", 0.1), "delete the block, or write the name of the link that is meant: leg has no such shape"),
        (
            make_link("leg", 0.1, "") + block("leg", "<mu1>1</mu1>"),
            "delete the block: the one of leg has these settings",
        ),
    ],
)
def test_friction_of_a_joint_is_not_moved_to_a_link_that_has_it_or_cannot_have_it(
    tmp_path: Path, leg: str, repair: str
) -> None:
    body = make_link("base") + leg + fixed("axle", "base", "leg") + block("axle", "<mu1>0</mu1>")
    (finding,) = find(tmp_path, robot(body), "GZB003")
    assert finding.fix is not None
    assert finding.fix.title == repair


def test_a_sensor_that_names_a_merged_shape_follows_its_new_name(tmp_path: Path) -> None:
    watch = "<contact><collision>base_fixed_joint_lump__foo</collision></contact>"
    bumper = f'<sensor name="bumper" type="contact">{watch.replace("foo", "NAME")}</sensor>'
    (plain,) = find(tmp_path, robot(MERGED + block("named", "<mu1>1</mu1>")), "GZB003")
    name = plain.data["name"]
    body = block("named", "<mu1>1</mu1>" + bumper.replace("base_fixed_joint_lump__NAME", name))
    (finding,) = find(tmp_path, robot(MERGED + body), "GZB003")
    assert plain.fix is not None
    assert finding.fix is not None
    assert plain.fix.title.endswith("use the link's name (named)")
    assert finding.fix.title.endswith("; then write the new name of the shape also in the <collision> of sensor bumper")


def test_a_force_torque_sensor_beside_a_plugin_stays_with_its_joint(tmp_path: Path) -> None:
    body = block("j", '<sensor name="s" type="force_torque"/><plugin name="p" filename="libp.so"/>')
    (finding,) = find(tmp_path, robot(MERGED + body), "GZB003")
    assert finding.fix is not None
    assert finding.fix.title.startswith("keep the joint for the force_torque sensor")
    assert "to the block of the link (tip)" in finding.fix.title


@pytest.mark.parametrize(
    ("typed", "otherwise"),
    [
        ("IMU", "if this Gazebo type is meant, write sensor_msgs/msg/Imu as the ROS type"),
        ("Imu", "if gz.msgs.IMU is meant, write that, and sensor_msgs/msg/Imu as the ROS type"),
    ],
)
def test_of_two_types_of_a_bridge_either_may_be_wrong(tmp_path: Path, typed: str, otherwise: str) -> None:
    entry = f"topic_name: t, ros_type_name: sensor_msgs/msg/Image, gz_type_name: gz.msgs.{typed}"
    (tmp_path / "bridge.yaml").write_text(f"- {{{entry}}}\n", encoding="utf-8")
    (tmp_path / "package.xml").write_text("<package><name>car</name></package>", encoding="utf-8")
    (tmp_path / "car.urdf").write_text('<robot name="car"><link name="base"/></robot>', encoding="utf-8")
    (finding,) = check(tmp_path, codes={"GZB005"}).findings
    assert finding.fix is not None
    assert not finding.fix.edits
    assert finding.fix.title == f"write gz.msgs.Image; {otherwise}"


def test_settings_of_a_link_among_those_of_a_merged_joint_are_said_to_be_its(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, robot(MERGED + block("j", "<mu1>1</mu1><stopCfm>0</stopCfm>")), "GZB003")
    assert finding.fix is not None
    assert finding.fix.title.endswith("mu1 are for a link: write them in its block")


@pytest.mark.parametrize(("mass", "edits"), [(1.0, 1), (0.0, 0)])
def test_no_edit_keeps_the_joint_of_a_link_that_gazebo_would_drop_then(tmp_path: Path, mass: float, edits: int) -> None:
    body = make_link("base") + make_link("tip", mass, "") + fixed("j", "base", "tip")
    (finding,) = find(tmp_path, robot(body + block("tip", "<preserveFixedJoint>true</preserveFixedJoint>")), "GZB003")
    assert finding.fix is not None
    assert len(finding.fix.edits) == edits


def test_a_contact_sensor_of_a_link_without_collisions_needs_one(tmp_path: Path) -> None:
    sensor = '<sensor name="s" type="contact"><contact><collision>leg_collision</collision></contact></sensor>'
    (finding,) = find(tmp_path, robot(make_link("leg") + block("leg", sensor)), "GZB004")
    assert finding.fix is not None
    assert finding.fix.title == "give leg a collision, or move the sensor to the link that has it"


def test_two_blocks_of_one_link_are_two_places(tmp_path: Path) -> None:
    links = [f"base_{'x' * 20}_{i}" for i in range(2)]
    body = make_link("base", 1.0) + "".join(
        make_link(name, 0.0, "") + fixed(f"{name}_j", "base", name) for name in links
    )
    body += "".join(f"{block(name, '<mu1>1</mu1>')}\n" for name in (*links, links[1]))
    joint = join_occurrences(find(tmp_path, robot(body), "GZB003"), load_rules())
    assert joint.headline == "3 places: Gazebo ignores mu1, misled by its name"


def test_below_the_world_nothing_is_merged(tmp_path: Path) -> None:
    body = '<link name="world"/>' + make_link("base") + fixed("j", "world", "base") + block("j", SENSOR)
    assert not messages(tmp_path, body, "GZB003")


def test_joints_that_are_merged_are_one_finding_and_kept_by_edits_if_all_can_be(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, robot(MERGED + block("j", SENSOR)), "GZB003")
    assert finding.fix is not None
    assert [e.expected for e in finding.fix.edits] == ['<gazebo reference="j">']
    (finding,) = find(tmp_path, robot(MERGED + block("j", SENSOR) + block("l", SENSOR)), "GZB003")
    assert finding.fix is not None
    assert len(finding.subjects) == 2
    assert finding.fix.edits == ()  # the link below the other has no mass


def test_what_hangs_on_a_link_that_is_left_out_is_no_finding_of_its_own(tmp_path: Path) -> None:
    keep = "<preserveFixedJoint>true</preserveFixedJoint>"
    body = (
        MERGED
        + make_link("last", 1.0)
        + fixed("m", "inner", "last")
        + "".join(block(name, keep) for name in ("h", "l", "m"))
    )
    (finding,) = find(tmp_path, robot(body), "GZB003")
    assert "named" in finding.message
    assert "named and 2 links below it" in finding.message


OFF = "<turnGravityOff>true</turnGravityOff>"


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        (make_link("camera", 0.1) + fixed("c", "base", "camera") + block("camera", OFF), ["gravity"]),
        (make_link("camera", 0.1) + fixed("c", "base", "camera", "continuous") + block("camera", OFF), []),
        (make_link("camera", 0.1) + fixed("c", "base", "camera") + block("camera", OFF) + block("base", OFF), []),
        (
            make_link("camera", 0.1)
            + fixed("c", "base", "camera")
            + block("camera", OFF)
            + block("base", "<gravity>false</gravity>"),
            [],
        ),
        (
            make_link("camera", 0.1)
            + fixed("c", "base", "camera")
            + block("camera", OFF)
            + block("base", "<gravity>true</gravity>"),
            ["gravity"],
        ),
        (make_link("ballast", 9.0) + fixed("c", "base", "ballast") + block("ballast", OFF), []),
        (
            make_link("camera", 0.1) + fixed("c", "base", "camera") + block("camera", OFF.replace("true", "0")),
            [],
        ),
    ],
)
def test_gravity_goes_with_the_body(tmp_path: Path, body: str, expected: list[str]) -> None:
    assert messages(tmp_path, make_link("base") + body, "GZB003") == expected


def test_a_body_without_gravity_is_blamed_on_the_link_with_the_flag(tmp_path: Path) -> None:
    body = make_link("base", 1.0) + make_link("camera", 0.1) + fixed("c", "base", "camera") + block("camera", OFF)
    (finding,) = find(tmp_path, robot(body), "GZB003")
    assert finding.headline == "camera: turnGravityOff acts on all of base (1.1 kg)"


# -- sensors ------------------------------------------------------------------------------------------------------------


def sensor(type_: str, *content: str, name: str = "s") -> str:
    return f'<sensor name="{name}" type="{type_}">{"".join(content)}</sensor>'


RATE = "<update_rate>30</update_rate>"
PLUGIN = '<plugin filename="p"><frame_name>somewhere_else</frame_name></plugin>'
NEW = '<gazebo><plugin filename="gz-sim-imu-system" name="gz::sim::systems::Imu"/></gazebo>'


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        (block("tip", sensor("imu")), []),
        (block("tip", sensor("camera", RATE)), []),
        (block("tip", sensor("camera")), ["rate"]),
        (block("tip", sensor("gpu_lidar", "<update_rate>0</update_rate>")), ["rate"]),
        (block("tip", sensor("lidr", RATE)), ["type"]),
        (block("tip", sensor("ray", RATE)), []),
        (block("tip", sensor("ray", RATE)) + NEW, ["cpu-lidar"]),
        (block("tip", sensor("gpu_lidar", RATE)) + NEW, []),
        (block("tip", sensor("imu", "<gz_frame_id>tip</gz_frame_id>")), []),
        (block("tip", sensor("imu", "<gz_frame_id>Tip</gz_frame_id>")), ["frame"]),
        (block("tip", sensor("imu", "<gz_frame_id>tip_link</gz_frame_id>")), ["frame"]),
        (block("tip", sensor("imu", "<gz_frame_id>somewhere_else</gz_frame_id>")), ["frame-elsewhere"]),
        (block("tip", sensor("imu", "<gz_frame_id>robot1/tip</gz_frame_id>")), []),
        (block("tip", sensor("imu", "<gz_frame_id>tip</gz_frame_id>", PLUGIN)), ["frame-elsewhere"]),
        (block("tip", sensor("imu", "<gz_frame_id>tip</gz_frame_id>", PLUGIN)) + NEW, []),
        (block("tip", sensor("imu", "<imu><frame_id>somewhere_else</frame_id></imu>")), []),
        (block("tip", sensor("contact", "<plugin filename='p'><frameName>world</frameName></plugin>")), []),
        (block("tip", sensor("imu")) + block("base", sensor("imu")), ["twice"]),
        (block("tip", sensor("imu")) + block("base", sensor("imu", name="t")), []),
    ],
)
def test_sensors(tmp_path: Path, body: str, expected: list[str]) -> None:
    assert messages(tmp_path, MERGED + body, "GZB004") == expected


@pytest.mark.parametrize(
    ("kind", "optical", "meant"),
    [
        ("camera", "eye_optical_frame", "eye_optical_frame"),
        ("gpu_lidar", "eye_optical_frame", "tip"),
        ("camera", "eye", "tip"),
    ],
)
def test_the_frame_of_a_camera_is_its_optical_frame(tmp_path: Path, kind: str, optical: str, meant: str) -> None:
    eye = f'<link name="{optical}"/><joint name="o" type="fixed"><parent link="tip"/><child link="{optical}"/></joint>'
    body = block("tip", sensor(kind, RATE + "<gz_frame_id>tip_link</gz_frame_id>"))
    (finding,) = find(tmp_path, robot(MERGED, eye, body), "GZB004")
    assert finding.fix is not None
    assert finding.fix.title == f"write {meant}" + ("" if meant == "tip" else ", unless a program publishes tip_link")


@pytest.mark.parametrize(("away", "is_proposed"), [("0.015", True), ("0.06", False)])
def test_the_optical_frame_of_another_camera_of_a_rig_is_not_proposed(
    tmp_path: Path, away: str, is_proposed: bool
) -> None:
    eye = (
        '<link name="left_optical"/><joint name="o" type="fixed"><parent link="tip"/><child link="left_optical"/>'
        f'<origin xyz="0 {away} 0"/></joint>'
    )
    body = block("tip", sensor("camera", RATE + "<gz_frame_id>right_frame</gz_frame_id>"))
    (finding,) = find(tmp_path, robot(MERGED, eye, body), "GZB004")
    assert ("left_optical" in (finding.fix.title if finding.fix else "")) == is_proposed


@pytest.mark.parametrize(
    ("link_name", "more", "found"),
    [
        ("/eye", "", []),
        ("rover/eye", "", []),
        (
            "rover/eye",
            '<gazebo><plugin filename="gz-sim-imu-system" name="gz::sim::systems::Imu"/></gazebo>',
            ["frame-elsewhere"],
        ),
        ("rover_eye", "", ["frame-elsewhere"]),
    ],
)
def test_a_frame_may_get_the_namespace_of_the_links(
    tmp_path: Path, link_name: str, more: str, found: list[str]
) -> None:
    body = block(link_name, sensor("imu", RATE + "<frame_name>eye</frame_name>"))
    joints = fixed("j", "base", link_name)
    text = robot(link("base"), link(link_name), joints, body, more)
    assert [f.message_id for f in find(tmp_path, text, "GZB004")] == found


def test_a_frame_that_a_macro_computes_is_repaired_in_its_terms(tmp_path: Path) -> None:
    (tmp_path / "r.urdf.xacro").write_text(
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="front_link"/>'
        '<xacro:macro name="eye" params="side">'
        '<gazebo reference="${side}_link"><sensor name="s" type="imu"><frame_name>${side}</frame_name></sensor></gazebo>'
        '</xacro:macro><xacro:eye side="front"/></robot>'
    )
    (finding,) = check(tmp_path / "r.urdf.xacro", codes={"GZB004"}).findings
    assert finding.fix is not None
    assert finding.fix.title == "write ${side}_link"


def test_a_frame_that_a_launch_file_publishes_exists(tmp_path: Path) -> None:
    package = tmp_path / "package"
    (package / "launch").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>package</name></package>")
    node = '<node pkg="tf" type="static_transform_publisher" name="n" args="0 0 0 0 0 0 tip {} 100"/>'
    body = block("tip", sensor("imu", "<gz_frame_id>elsewhere</gz_frame_id>"))
    unknown = ["frame-elsewhere"]
    for frame, expected in (("elsewhere_too", unknown), ("x <!-- elsewhere -->", unknown), ("elsewhere", [])):
        (package / "launch" / "robot.launch").write_text(f"<launch>{node.format(frame)}</launch>")
        assert messages(package, MERGED + body, "GZB004") == expected


@pytest.mark.parametrize(
    ("launch", "expected"),
    [
        ('<arg name="extra_gazebo_args" value="-s libsonars.so"/>', []),
        ('<node pkg="gazebo_ros" type="gzserver" name="g" args="world -s $(find package)/lib/libsonars.so"/>', []),
        ("<!-- ['gzserver', '-s', 'libsonars.so'] -->", ["own-type"]),
        ('<arg name="extra_gazebo_args" value="-s libgazebo_ros_factory.so"/>', ["own-type"]),
        ('<arg name="extra_gazebo_args" value="--no-s libsonars.so"/>', ["own-type"]),
    ],
)
def test_a_plugin_that_gzserver_gets_may_add_a_type_of_sensor(tmp_path: Path, launch: str, expected: list[str]) -> None:
    package = tmp_path / "package"
    (package / "launch").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>package</name></package>")
    (package / "launch" / "robot.launch").write_text(f"<launch>{launch}</launch>")
    body = block("base", sensor("acme_dvl", '<plugin name="p" filename="libacme_dvl.so"/>'))
    assert messages(package, MERGED + body, "GZB004") == expected
    near = block("base", sensor("camra", RATE + '<plugin name="p" filename="libacme_dvl.so"/>'))
    assert messages(package, MERGED + near, "GZB004") == ["type"]


@pytest.mark.parametrize(("frame", "expected"), [("elsewhere", []), ("bsae", ["frame"])], ids=["unknown", "a typo"])
@pytest.mark.parametrize("inside", ["robot", ""], ids=["of a package", "of none"])
def test_a_frame_may_be_published_by_a_package_that_declares_nothing(
    tmp_path: Path, frame: str, expected: list[str], inside: str
) -> None:
    """Then it is not unknown; one that is spelt like a link may be another robot's."""
    (tmp_path / ".git").mkdir()
    for name in filter(None, (inside, "world")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "package.xml").write_text(f"<package><name>{name}</name></package>")
    node = f'<node pkg="tf" type="static_transform_publisher" name="n" args="0 0 0 0 0 0 tip {frame} 100"/>'
    (tmp_path / "world" / "world.launch").write_text(f"<launch>{node}</launch>")
    body = block("tip", sensor("imu", f"<gz_frame_id>{frame}</gz_frame_id>"))
    assert messages(tmp_path / inside, MERGED + body, "GZB004") == expected


def test_the_launch_files_are_read_once_for_all_frames(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "package.xml").write_text("<package><name>r</name></package>")
    read: list[object] = []
    read_launches = model_launches._read_launches
    monkeypatch.setattr(
        model_launches, "_read_launches", lambda folders, finder: read.append(1) or read_launches(folders, finder)
    )
    body = "".join(block("tip", sensor("imu", f"<gz_frame_id>{frame}</gz_frame_id>")) for frame in ("one", "two"))
    assert messages(tmp_path, MERGED + body, "GZB004").count("frame-elsewhere") == 2
    assert len(read) == 2, "around the model, and in its project"


def test_a_malformed_origin_hides_no_other_finding(tmp_path: Path) -> None:
    links = link("base") + link("eye") + link("eye_optical") + fixed("i", "eye", "eye_optical")
    eye = fixed("j", "base", "eye").replace("</joint>", '<origin xyz="0 x 0"/></joint>')
    camera = block("eye", sensor("camera", RATE + "<gz_frame_id>elsewhere</gz_frame_id>"))
    found = messages(tmp_path, links + eye + camera + block("base", sensor("nonsense", RATE)), "GZB004")
    assert {"type", "frame-elsewhere"} <= set(found)


def test_the_frame_of_a_camera_is_not_guessed_by_its_name(tmp_path: Path) -> None:
    body = block("tip", sensor("camera", RATE + "<gz_frame_id>bsae</gz_frame_id>"))
    assert messages(tmp_path, MERGED + body, "GZB004") == ["frame-elsewhere"]


def test_sensors_of_one_name_on_two_bodies(tmp_path: Path) -> None:
    body = MERGED.replace('"j" type="fixed"', '"j" type="continuous"')
    assert not messages(tmp_path, body + block("tip", sensor("imu")) + block("base", sensor("imu")), "GZB004")


def test_one_topic_for_two_sensors(tmp_path: Path) -> None:
    topic = "<topic>/scan</topic>"
    one, other = sensor("gpu_lidar", RATE, topic), sensor("gpu_lidar", RATE, "<topic> scan</topic>", name="t")
    assert messages(tmp_path, MERGED + block("tip", one) + block("base", other), "GZB004") == ["topic"]
    unnamed = [
        block(link, sensor("gpu_lidar", RATE, "<topic>__default_topic__</topic>", name=link))
        for link in ("tip", "base")
    ]
    assert not messages(tmp_path, MERGED + "".join(unnamed), "GZB004")
    imu = sensor("imu", topic, name="t")
    assert not messages(tmp_path, MERGED + block("tip", one) + block("base", imu), "GZB004")


@pytest.mark.parametrize(
    ("reference", "collision", "edit"),
    [
        ("base", "base_collision", None),
        ("base", "r::base::base_collision", None),
        ("tip", "base_fixed_joint_lump__tip_collision_5", None),
        ("tip", "tip_collision", ["base_fixed_joint_lump__tip_collision_5"]),
        ("named", "foo", []),  # it has two
    ],
)
def test_what_a_contact_sensor_watches(tmp_path: Path, reference: str, collision: str, edit: list[str] | None) -> None:
    contact = sensor("contact", f"<contact><collision>{collision}</collision></contact>")
    findings = find(tmp_path, robot(MERGED + block(reference, contact)), "GZB004")
    assert [[e.replacement for e in f.fix.edits] for f in findings if f.fix is not None] == (
        [] if edit is None else [edit]
    )


CLASSIC = '<gazebo><plugin name="d" filename="libgazebo_ros_diff_drive.so">{}</plugin></gazebo>'


@pytest.mark.parametrize(
    ("plugin", "more", "severity"),
    [
        ("", "", Severity.WARNING),  # in the new Gazebo, too
        ("", CLASSIC, Severity.INFO),
        ("", CLASSIC.format("<bumper_name>s</bumper_name>"), Severity.WARNING),
        ('<plugin name="b" filename="libgazebo_ros_bumper.so"/>', CLASSIC, Severity.WARNING),
    ],
)
def test_a_contact_sensor_of_classic_that_no_plugin_reads_is_worth_knowing(
    tmp_path: Path, plugin: str, more: str, severity: Severity
) -> None:
    contact = sensor("contact", "<contact><collision>foo</collision></contact>", plugin)
    (finding,) = find(tmp_path, robot(MERGED + block("named", contact), more), "GZB004")
    assert finding.severity == severity


def test_a_sensor_that_is_to_watch_a_merged_link_without_a_collision_does_not_get_the_one_around_it(
    tmp_path: Path,
) -> None:
    contact = sensor("contact", "<contact><collision>base_fixed_joint_lump__foot_collision_1</collision></contact>")
    body = '<link name="foot"/>' + make_link("base", 1.0, "") + fixed("j", "base", "foot")
    (finding,) = find(tmp_path, robot(body + block("base", contact)), "GZB004")
    assert finding.fix is not None
    assert not finding.fix.edits
    assert finding.fix.title.startswith("give foot a <collision>")


@pytest.mark.parametrize(("reference", "expected"), [("base", ["GZB004"]), ("laser", ["GZB001"])])
def test_a_sensor_in_a_block_without_effect_is_left_to_that_block(
    tmp_path: Path, reference: str, expected: list[str]
) -> None:
    sensor = '<sensor name="s" type="lidarr"><update_rate>5</update_rate></sensor>'
    body = f'<gazebo reference="{reference}">{sensor}</gazebo>'
    run = check_text(tmp_path, robot(link("base"), body), codes={"GZB001", "GZB004"})
    assert [f.code for f in run.findings] == expected


# -- bridges ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("entry", "expected", "edits"),
    [
        ("ros_type_name: std_msgs/msg/Bool, gz_type_name: gz.msgs.Boolean", [], []),
        ("ros_type_name: std_msgs/msg/Bool, gz_type_name: ignition.msgs.Boolean", [], []),
        ("ros_type_name: mine/msg/Bool2, gz_type_name: gz.msgs.Boolean", [], []),
        ("ros_type_name: $(var type), gz_type_name: gz.msgs.Boolean", [], []),
        ("ros_type_name: std_msgs/msg/Bool, gz_type_name: gz.msgs.Bool", ["gz-type"], ["gz.msgs.Boolean"]),
        ("ros_type_name: std_msgs/msg/Bool, gz_type_name: gz.msgs.Double", ["pair"], []),
        ("ros_type_name: std_msgs/Bool, gz_type_name: gz.msgs.Boolean", ["ros-type"], ["std_msgs/msg/Bool"]),
        ("ros_type_name: sensor_msgs/msg/CompressedImage, gz_type_name: gz.msgs.Image", ["compressed"], []),
        ("ros_type_name: std_msgs/msg/Bool, gz_type_name: Boolean", ["prefix"], ["gz.msgs.Boolean"]),
        ("ros_type_name: nav_msgs/msg/Odometry, gz_type_name: gz.msgs.Pose", ["pair"], []),
        ("ros_type_name: std_msgs/msg/Bool", ["missing"], []),
        ("ros_type_name: std_msgs/msg/Bool, gz_type_name: gz.msgs.Boolean, direction: GZ_TO_ROS", [], []),
        (
            "ros_type_name: std_msgs/msg/Bool, gz_type_name: gz.msgs.Boolean, direction: gz_to_ros",
            ["direction"],
            ["GZ_TO_ROS"],
        ),
        ("ros_type_name: std_msgs/msg/Bool, gz_type_name: gz.msgs.Boolean, ros_topic_name: a", ["both"], []),
        ("ros_type_name: std_msgs/msg/Bool, gz_type_name: gz.msgs.Boolean, lasy: true", ["key"], ["lazy"]),
        ("ros_type_name: std_msgs/msg/Bool, gz_type_name: gz.msgs.Boolean, comment: mine", [], []),
    ],
)
def test_bridges(tmp_path: Path, entry: str, expected: list[str], edits: list[str]) -> None:
    folder = tmp_path / "car"
    for name, text in {
        "package.xml": "<package><name>car</name></package>",
        "car.urdf": '<robot name="car"><link name="base"/></robot>',
        "bridge.yaml": f"- {{topic_name: t, {entry}}}\n# ros_type_name gz_type_name\n",
        "other.yaml": "ros_type_name: {gz_type_name: [",
    }.items():
        folder.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    run = check(folder, codes={"GZB005"})
    assert not run.failures
    assert [f.message_id for f in run.findings] == expected
    assert [e.replacement for f in run.findings if f.fix is not None for e in f.fix.edits] == edits


@pytest.mark.parametrize(
    ("other", "is_double"),
    [
        ("topic_name: clock, ros_type_name: rosgraph_msgs/msg/Clock, direction: GZ_TO_ROS", True),
        ("gz_topic_name: /clock, ros_type_name: rosgraph_msgs/msg/Clock", True),
        ("topic_name: clock, ros_type_name: rosgraph_msgs/msg/Clock, direction: ROS_TO_GZ", False),
        ("topic_name: time, ros_type_name: rosgraph_msgs/msg/Clock, direction: GZ_TO_ROS", False),
        ("topic_name: clock, ros_type_name: rosgraph_msgs/msg/Clok, direction: GZ_TO_ROS", False),
    ],
)
def test_a_second_bridge_of_two_topics_is_to_be_deleted(tmp_path: Path, other: str, is_double: bool) -> None:
    """Corrected, the entry would bridge what another one does."""
    wrong = (
        "ros_topic_name: /clock, gz_topic_name: /clock, ros_type_name: rosgraph_msgs/msg/clock, direction: GZ_TO_ROS"
    )
    entries = "".join(f"- {{{entry}, gz_type_name: gz.msgs.Clock}}\n" for entry in (other, wrong))
    (tmp_path / "bridge.yaml").write_text(entries, encoding="utf-8")
    (tmp_path / "package.xml").write_text("<package><name>car</name></package>", encoding="utf-8")
    (tmp_path / "car.urdf").write_text('<robot name="car"><link name="base"/></robot>', encoding="utf-8")
    *_, finding = check(tmp_path, codes={"GZB005"}).findings
    assert finding.fix is not None
    assert finding.fix.title.startswith("delete the entry: the one in line 1 already") == is_double
    assert bool(finding.fix.edits) != is_double


_SENSOR = '<gazebo reference="a"><sensor name="{name}" type="imu"><update_rate>9</update_rate></sensor></gazebo>'


def test_sensors_of_a_file_that_is_included_twice_need_one_include_less(tmp_path: Path) -> None:
    xmlns = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
    (tmp_path / "s.xacro").write_text(f"<robot {xmlns}>{_SENSOR.format(name='imu')}</robot>", encoding="utf-8")
    include = '<xacro:include filename="s.xacro"/>'
    (finding,) = find(tmp_path, robot(ARM, include, include, xacro=True), "GZB004", name="r.urdf.xacro")
    assert finding.message.endswith(
        "2 sensors named imu, because their file is included more than once; in the new Gazebo the second is dropped"
    )
    assert finding.location.span is not None
    assert finding.location.span.line > 1
    assert finding.fix is not None
    assert finding.fix.title == "delete one of the includes"


@pytest.mark.parametrize(
    ("body", "repair"),
    [
        (_SENSOR.format(name="imu") * 3, "give each sensor its own name"),
        (
            f'<xacro:macro name="m" params="p">{_SENSOR.format(name="imu")}</xacro:macro>'
            + "".join(f'<xacro:m p="{p}"/>' for p in "xyz"),
            "use a parameter of the macro in the name, so that it differs in each call",
        ),
    ],
)
def test_sensors_of_one_name_are_counted(tmp_path: Path, body: str, repair: str) -> None:
    (finding,) = find(tmp_path, robot(ARM, body, xacro=True), "GZB004", name="r.urdf.xacro")
    assert finding.message == "a has 3 sensors named imu; in the new Gazebo all but the first are dropped"
    assert finding.fix is not None
    assert finding.fix.title == repair


@pytest.mark.parametrize(
    ("plugin", "rate"), [("", 30), ("<updateRate>10</updateRate>", 10), ("<updateRate>0</updateRate>", 30)]
)
def test_a_sensor_renders_as_often_as_its_plugin_publishes(tmp_path: Path, plugin: str, rate: int) -> None:
    sensor = f'<sensor name="eye" type="camera"><plugin name="p" filename="libgazebo_ros_camera.so">{plugin}</plugin></sensor>'
    (finding,) = find(tmp_path, robot(ARM, block("a", sensor)), "GZB004")
    assert finding.fix is not None
    assert finding.fix.title.startswith(f"add <update_rate>{rate}</update_rate>")
    assert (
        finding.consequences["gazebo"]
        == "renders in every time step while the data is used, which can slow down the simulation"
    )


def test_one_of_two_equal_sensors_is_one_too_many(tmp_path: Path) -> None:
    sensor = '<sensor name="imu" type="imu"><update_rate>{}</update_rate></sensor>'
    for rate, repair in (("30", "delete one of the two: they are equal"), ("50", "give each sensor its own name")):
        body = block("a", sensor.format(30), sensor.format(rate))
        (finding,) = find(tmp_path / rate, robot(ARM, body), "GZB004")
        assert finding.fix is not None
        assert finding.fix.title == repair


# -- control ------------------------------------------------------------------------------------------------------------


def test_a_name_without_the_dollar_sign_of_its_expression_needs_that(tmp_path: Path) -> None:
    drives = "".join(f'<transmission name="t{i}"><joint name="{{leg}}_knee"/></transmission>' for i in range(2))
    (finding,) = find(tmp_path, robot(ARM, drives), "CTL001")
    assert finding.headline == "transmissions name a joint not in the robot: {leg}_knee"
    assert finding.severity is Severity.WARNING
    assert finding.fix is not None
    assert finding.fix.title.startswith("write ${leg} instead of {leg} where xacro expands the file")


@pytest.mark.parametrize(
    ("names", "repair"),
    [
        (("FLK", "FRK"), "write FL_KFE, FR_KFE for FLK, FRK"),
        (("FLK", "FL_KFE"), "write the joints of this robot"),  # that of the other leg is left
        (("FLK", "abad"), "write the joints of this robot"),
        (("FLK",), "write the joints of this robot"),
    ],
)
def test_short_forms_of_the_joints_that_are_left_are_those(tmp_path: Path, names: tuple[str, ...], repair: str) -> None:
    block = "".join(f'<joint name="{name}"/>' for name in names)
    legs = ARM.replace('name="j"', 'name="FL_KFE"').replace('name="k"', 'name="FR_KFE"')
    (finding,) = find(tmp_path, robot(legs, f'<ros2_control name="c" type="system">{block}</ros2_control>'), "CTL001")
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)


def test_what_a_transmission_without_a_type_lacks_is_one_finding(tmp_path: Path) -> None:
    bare = '<transmission name="t"><joint name="joint"/><actuator name="m"/></transmission>'
    (finding,) = find(tmp_path, robot(ARM, bare.replace('"joint"', '"j"')), "CTL003")
    assert (finding.message_id, finding.severity) == ("type", Severity.INFO)  # nothing here names ros_control
    assert finding.fix is not None
    assert finding.fix.title == (
        "add <type>transmission_interface/SimpleTransmission</type>, a <hardwareInterface> in the <joint>; "
        "or delete the transmission if no program reads it"
    )


def test_a_drive_plugin_of_a_robot_without_wheels_needs_wheels(tmp_path: Path) -> None:
    plugin = '<plugin name="d" filename="libgazebo_ros_diff_drive.so"><leftJoint>l</leftJoint><rightJoint>r</rightJoint></plugin>'
    body = joint("j", "base", "top", kind="fixed")
    found = find(tmp_path, robot(link("base"), link("top"), body, f"<gazebo>{plugin}</gazebo>"), "CTL007")
    repairs = {finding.fix.title for finding in found if finding.fix is not None}
    assert repairs == {
        "give the robot wheels with continuous joints of these names (no joint of it moves), or delete the plugin"
    }


def test_names_in_a_file_that_fits_another_robot_are_reported_where_this_one_uses_it(tmp_path: Path) -> None:
    """A file that expands nothing but the block has no robot that lacks the joints."""
    block = f'<ros2_control name="c" type="system">{"".join(f"<joint name={name!r}/>" for name in ("j", "k"))}</ros2_control>'
    include, call = '<xacro:include filename="drives.xacro"/>', "<xacro:drives/>"
    files = {
        "package.xml": "<package format='3'><name>p</name></package>",
        "drives.xacro": robot(f'<xacro:macro name="drives">{block}</xacro:macro>', xacro=True),
        "arm.urdf.xacro": robot(ARM, include, call, xacro=True),
        "block.urdf.xacro": robot(include, call, xacro=True),
        "cart.urdf.xacro": robot(ARM.replace('"j"', '"left"').replace('"k"', '"right"'), include, call, xacro=True),
    }
    (finding,) = find(tmp_path, files, "CTL001", name="cart.urdf.xacro")
    assert finding.location.span is not None
    assert finding.location.span.file.endswith("cart.urdf.xacro")
    assert finding.fix is not None
    assert "they may be right for arm.urdf.xacro" in finding.fix.title
    assert not find(tmp_path, files, "CTL001", name="block.urdf.xacro")
    assert not find(tmp_path, files, "CTL001", name="arm.urdf.xacro")


def test_a_description_of_hardware_alone_lacks_no_joints(tmp_path: Path) -> None:
    body = '<ros2_control name="c" type="system"><joint name="lift"/><joint name="head"/></ros2_control>'
    (finding,) = find(tmp_path, robot(link("base"), body), "CTL001")
    assert (finding.message_id, finding.severity) == ("ros2_control-lone", Severity.INFO)
    assert finding.fix is not None
    assert finding.fix.title.startswith("nothing for a controller manager before ROS 2 Jazzy")


def test_a_transmission_of_the_pr2_may_name_its_joint_anywhere(tmp_path: Path) -> None:
    body = '<transmission name="t"><rightActuator name="m"/><joint name="joint"/></transmission>'
    (finding,) = find(tmp_path, robot(ARM, body), "CTL001")
    assert finding.location.subject == "transmission[t]/joint[joint]@name"


@pytest.mark.parametrize(
    "body",
    [
        '<transmission name="t"><joint name="j"/><joint name="k"/></transmission>',
        '<gazebo><plugin filename="gz-sim-diff-drive-system"><left_joint>j</left_joint>'
        "<right_joint> k </right_joint></plugin></gazebo>",
        '<gazebo><plugin filename="libgazebo_ros_joint.so"><jointName>j, k</jointName></plugin></gazebo>',
    ],
)
def test_any_mention_in_control_counts_as_a_drive(tmp_path: Path, body: str) -> None:
    assert not find(tmp_path, robot(ARM, body), "CTL002")


def test_a_description_without_a_word_for_a_simulator_is_driven_elsewhere(tmp_path: Path) -> None:
    assert not find(tmp_path, robot(ARM), "CTL002")


def test_a_gazebo_reference_is_no_drive(tmp_path: Path) -> None:
    body = '<gazebo reference="j"/><gazebo reference="k"/>'
    assert [f.message_id for f in find(tmp_path, robot(ARM, body), "CTL002")] == ["none"]


def test_joints_left_out_of_control_are_listed(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, robot(ARM, '<transmission name="t"><joint name="j"/></transmission>'), "CTL002")
    assert (finding.message_id, finding.location.subject) == ("most", "joint[k]")


@pytest.mark.parametrize(("typed", "count"), [("right", 0), ("Right", 0), ("left", 1)])
def test_a_joint_that_is_meant_in_other_capitals_is_driven(tmp_path: Path, typed: str, count: int) -> None:
    wheels = "".join(link(side) + joint(f"{side}_wheel", "base", side, kind="continuous") for side in ("left", "right"))
    drives = "".join(f'<transmission name="{n}"><joint name="{n}_wheel"/></transmission>' for n in ("left", typed))
    assert len(find(tmp_path, robot(link("base"), wheels, drives), "CTL002")) == count


@pytest.mark.parametrize(
    ("names", "driven", "message"),
    [
        (("j_1", "j_2", "j_3", "j_4"), 3, "some"),  # one of a series
        (("j_1", "j_2", "j_3", "j_4"), 2, "most"),
        (("front_left", "front_right", "rear_left", "rear_right"), 2, "most"),
        (("front_left_wheel", "front_right_wheel", "rear_left_wheel", "rear_right_wheel"), 2, "some"),
        (("front_left_wheel", "front_right_wheel", "rear_left_wheel", "rear_right_wheel"), 1, "most"),
        (("left_wheel", "right_wheel", "left_rocker", "right_rocker"), 2, "most"),  # rockers have no motor
    ],
)
def test_few_joints_that_are_left_out_were_forgotten_if_others_like_them_are_driven(
    tmp_path: Path, names: tuple[str, ...], driven: int, message: str
) -> None:
    joints = "".join(
        f'<link name="l{i}"/><joint name="{name}" type="continuous"><parent link="base"/><child link="l{i}"/></joint>'
        for i, name in enumerate(names)
    )
    drives = "".join(
        f'<transmission name="t{i}"><joint name="{name}"/></transmission>' for i, name in enumerate(names[:driven])
    )
    (finding,) = find(tmp_path, robot(f'<link name="base"/>{joints}{drives}'), "CTL002")
    assert finding.message_id == message


@pytest.mark.parametrize("name", ["rear_caster_joint", "SwivelJoint", "passive_wheel"])
def test_a_joint_that_is_passive_by_name_needs_no_drive(tmp_path: Path, name: str) -> None:
    arm = ARM.replace('name="k"', f'name="{name}"')
    assert not find(tmp_path, robot(arm, '<transmission name="t"><joint name="j"/></transmission>'), "CTL002")


def test_a_joint_without_effort_needs_no_drive(tmp_path: Path) -> None:
    arm = ARM.replace('<child link="c"/>', '<child link="c"/><limit effort="0" velocity="1"/>')
    assert not find(tmp_path, robot(arm, '<transmission name="t"><joint name="j"/></transmission>'), "CTL002")


FOLLOWER = ARM.replace('<child link="c"/>', '<child link="c"/><mimic joint="j"/>')
COMMAND = '<command_interface name="position"/>'


def control(attributes: str = "", inner: str = COMMAND) -> str:
    return (
        f'<ros2_control name="c" type="system"><joint name="j">{COMMAND}</joint>'
        f'<joint name="k" {attributes}>{inner}</joint></ros2_control>'
    )


def test_a_follower_takes_no_command(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, robot(FOLLOWER, control()), "CTL002")
    assert (finding.message_id, finding.severity) == ("mimic", Severity.WARNING)


@pytest.mark.parametrize(
    ("plugins", "message"),
    [
        ("<plugin>gazebo_ros2_control/GazeboSystem</plugin>", None),
        ("<plugin>gz_ros2_control/GazeboSimSystem</plugin>", "mimic"),
        (
            '<xacro:if value="1"><plugin>gazebo_ros2_control/GazeboSystem</plugin></xacro:if>'
            '<xacro:unless value="1"><plugin>mock_components/GenericSystem</plugin></xacro:unless>',
            "mimic",
        ),
    ],
)
def test_gazebo_classic_moves_a_follower_by_its_own_interface(
    tmp_path: Path, plugins: str, message: str | None
) -> None:
    """Unless another variant of the file is for a ROS that refuses it."""
    block = control().replace('<joint name="j">', f'<hardware>{plugins}</hardware><joint name="j">')
    text = robot(FOLLOWER, block, xacro=True)
    assert [f.message_id for f in find(tmp_path, text, "CTL002", name="r.urdf.xacro")] == [message] * bool(message)


@pytest.mark.parametrize("body", [control('mimic="false"'), control(inner='<state_interface name="position"/>')])
def test_a_follower_may_be_measured_or_told_not_to_follow(tmp_path: Path, body: str) -> None:
    assert not find(tmp_path, robot(FOLLOWER, body), "CTL002")


def test_a_fixed_joint_takes_no_command(tmp_path: Path) -> None:
    arm = ARM.replace('"k" type="continuous"', '"k" type="fixed"')
    assert [f.message_id for f in find(tmp_path, robot(arm, control()), "CTL002")] == ["fixed"]


def test_all_fixed_joints_that_take_a_command_are_one_finding(tmp_path: Path) -> None:
    arm = ARM.replace('type="continuous"', 'type="fixed"')
    (finding,) = find(tmp_path, robot(arm, control()), "CTL002")
    assert finding.headline == "2 fixed joints have a command interface: j, k"


def test_a_headline_counts_the_blocks_of_merged_joints(tmp_path: Path) -> None:
    (finding,) = find(tmp_path, robot(MERGED + block("j", "<provideFeedback>true</provideFeedback>")), "GZB003")
    assert finding.headline == "Gazebo ignores 1 block: it merges j"


def test_a_block_for_a_link_of_another_variant_is_an_info(tmp_path: Path) -> None:
    """The accessory is in a file that this variant does not even include."""
    include = '<xacro:if value="false"><xacro:include filename="bumper.xacro"/></xacro:if>'
    block = '<gazebo reference="bumper_link"><mu1>0.2</mu1></gazebo>'
    files = {
        "robot.urdf.xacro": robot(link("base"), include, block, xacro=True),
        "bumper.xacro": robot(link("bumper_link"), xacro=True),
    }
    (finding,) = find(tmp_path / "a", files, "GZB001", name="robot.urdf.xacro")
    assert (finding.message_id, finding.severity) == ("optional", Severity.INFO)
    (unknown,) = find(tmp_path / "b", files | {"bumper.xacro": robot(xacro=True)}, "GZB001", name="robot.urdf.xacro")
    assert (unknown.message_id, unknown.severity) == ("unknown", Severity.WARNING)


@pytest.mark.parametrize("around", ["gazebo", "transmission", "ros2_control"])
def test_a_part_of_another_block_is_no_part_of_another_variant(tmp_path: Path, around: str) -> None:
    text = robot(
        link("base"),
        f'<{around}><joint name="pad_joint"/></{around}><gazebo reference="pad_joint"><mu1>0.2</mu1></gazebo>',
        xacro=True,
    )
    (finding,) = find(tmp_path, text, "GZB001", name="robot.urdf.xacro")
    assert finding.message_id == "unknown"


@pytest.mark.parametrize(("called", "expected"), [("", "optional"), ('<xacro:tag name="r/"/>', "unknown")])
def test_a_part_whose_name_is_typed_like_the_reference_is_of_another_variant(
    tmp_path: Path, called: str, expected: str
) -> None:
    """Where its macro made a part of another name, the reference is wrong."""
    macro = f'<xacro:macro name="tag" params="name">{link("${name}tag_link")}</xacro:macro>'
    block = '<xacro:property name="name" value="doris/"/><gazebo reference="${name}tag_link"><mu1>0.2</mu1></gazebo>'
    (finding,) = find(
        tmp_path, robot(link("base"), macro, called, block, xacro=True), "GZB001", name="robot.urdf.xacro"
    )
    assert finding.message_id == expected


@pytest.mark.parametrize(
    ("name", "severity"), [("caster", Severity.INFO), ("base_1_base", Severity.INFO), ("basee", Severity.WARNING)]
)
def test_the_colour_of_an_unknown_part_is_a_note(tmp_path: Path, name: str, severity: Severity) -> None:
    block = f'<gazebo reference="{name}"><material>Gazebo/Black</material></gazebo>'
    (finding,) = find(tmp_path, robot(link("base"), block), "GZB001")
    assert finding.severity == severity


def test_a_part_that_has_a_block_is_not_what_another_block_means(tmp_path: Path) -> None:
    other = '<gazebo reference="tipp"><mu1>0</mu1></gazebo>'
    (finding,) = find(tmp_path, robot(MERGED, other), "GZB001")
    assert finding.fix is not None
    assert finding.fix.edits
    (finding,) = find(tmp_path, robot(MERGED, other, '<gazebo reference="tip"><mu1>1</mu1></gazebo>'), "GZB001")
    assert finding.fix is None or not finding.fix.edits


@pytest.mark.parametrize(
    ("reference", "setting", "near"),
    [
        ("foot_link", "<mu1>1</mu1>", "foot"),
        ("foot_link", "<stopErp>1</stopErp>", None),
        ("foot", "<stopErp>1</stopErp>", "foot_joint"),
        ("foot_jont", "<kp>1</kp>", None),  # a joint has no stiffness of contacts
    ],
)
def test_proposed_reference_is_of_the_kind_that_the_settings_are_for(
    tmp_path: Path, reference: str, setting: str, near: str | None
) -> None:
    parts = [link("base"), link("tip"), joint("foot_joint", "base", "tip")]
    if reference == "foot_link":
        parts = [link("foot"), link("tip"), joint("foot_joint", "foot", "tip")]
    text = robot(*parts, f'<gazebo reference="{reference}">{setting}</gazebo>')
    (finding,) = find(tmp_path, text, "GZB001")
    assert finding.data["near"] == (f" (did you mean {near!r}?)" if near else "")


@pytest.mark.parametrize(
    ("named", "kind", "message", "near"),
    [
        ("wheel_joint", "fixed", "fixed", None),
        ("wheel_joints", "fixed", "unknown", " ('wheel_joint' is spelled like it, but is fixed)"),
        ("wheel_joints", "continuous", "unknown", " (did you mean 'wheel_joint'?)"),
        ("wheel_joint", "continuous", None, None),
    ],
)
def test_driven_joint_must_turn(tmp_path: Path, named: str, kind: str, message: str | None, near: str | None) -> None:
    plugin = f'<plugin filename="libgazebo_ros_diff_drive.so" name="d"><left_joint>{named}</left_joint></plugin>'
    text = robot(
        link("base"), link("wheel"), joint("wheel_joint", "base", "wheel", kind=kind), f"<gazebo>{plugin}</gazebo>"
    )
    found = find(tmp_path, text, "CTL007")
    assert [f.message_id for f in found] == ([message] if message else [])
    assert all(f.severity == Severity.ERROR for f in found)
    assert [f.data.get("near") for f in found] == ([near] if message else [])


@pytest.mark.parametrize(
    ("places", "drawn", "axis", "found"),
    [
        (("0 0.2 0", "0 -0.2 0"), "0", "1 0 0", True),
        (("0 0.2 0", "0 -0.2 0"), "0", "0 0 1", True),
        (("0 0.2 0", "0 -0.2 0"), "0", "0 1 0", False),
        (("0.1 0 0", "-0.1 0 0"), "0.3", "0 1 0", False),  # the wheels are drawn on two sides of their joints
    ],
)
def test_wheels_that_turn_across_the_line_between_them_do_not_drive(
    tmp_path: Path, places: tuple[str, str], drawn: str, axis: str, found: bool
) -> None:
    plugin = "".join(f"<{side}_joint>{side}</{side}_joint>" for side in ("left", "right"))
    parts = [
        link(f"{side}_wheel", visual('<sphere radius="0.05"/>', xyz=f"0 {sign}{drawn} 0"))
        + joint(side, "base", f"{side}_wheel", kind="continuous", xyz=place, axis=axis)
        for side, sign, place in zip(("left", "right"), ("", "-"), places, strict=True)
    ]
    block = f'<gazebo><plugin filename="libgazebo_ros_diff_drive.so" name="d">{plugin}</plugin></gazebo>'
    messages = [f.message_id for f in find(tmp_path, robot(link("base"), *parts, block), "CTL007")]
    assert messages == (["sideways"] if found else [])


@pytest.mark.parametrize(("rpy", "words"), [("0 0 0", "back by as much"), ("1.5708 0 0", "or only their axes")])
def test_wheels_that_collide_about_a_wrong_axis_turn_with_it(tmp_path: Path, rpy: str, words: str) -> None:
    plugin = "".join(f"<{side}_joint>{side}</{side}_joint>" for side in ("left", "right"))
    wheel = visual('<cylinder radius="0.05" length="0.02"/>', rpy="1.5708 0 0") + collision(
        '<cylinder radius="0.05" length="0.02"/>', rpy=rpy
    )
    parts = [
        link(f"{side}_wheel", wheel)
        + joint(side, "base", f"{side}_wheel", kind="continuous", xyz=f"0 {y} 0", axis="0 0 1")
        for side, y in (("left", 0.2), ("right", -0.2))
    ]
    block = f'<gazebo><plugin filename="libgazebo_ros_diff_drive.so" name="d">{plugin}</plugin></gazebo>'
    (finding,) = find(tmp_path, robot(link("base"), *parts, block), "CTL007")
    assert finding.fix is not None
    assert words in finding.fix.title


@pytest.mark.parametrize(("typed", "found"), [("0.29", ["narrow"]), ("0.31", []), ("0.8", []), ("", []), ("0", [])])
def test_the_track_of_a_skid_steer_is_tuned_wider_and_never_far_below_the_narrowest_pair(
    tmp_path: Path, typed: str, found: list[str]
) -> None:
    wheels = {
        "front_left": "0.2 0.25 0",
        "rear_left": "-0.2 0.4 0",
        "front_right": "0.2 -0.25 0",
        "rear_right": "-0.2 -0.4 0",
    }
    parts = [
        link(f"{name}_wheel") + joint(name, "base", f"{name}_wheel", kind="continuous", xyz=place, axis="0 1 0")
        for name, place in wheels.items()
    ]
    names = "".join(f"<{name.partition('_')[2]}_joint>{name}</{name.partition('_')[2]}_joint>" for name in wheels)
    plugin = f"{names}<wheel_separation>{typed}</wheel_separation>"
    block = f'<gazebo><plugin filename="libgazebo_ros_diff_drive.so" name="d">{plugin}</plugin></gazebo>'
    reported = find(tmp_path, robot(link("base"), *parts, block), "CTL007")
    assert [f.message_id for f in reported] == found
    assert [f.data["real"] for f in reported] == pytest.approx([0.5] * len(found))


def test_a_track_is_between_the_treads_whatever_the_sidewalls_are(tmp_path: Path) -> None:
    """The inner sidewall of each wheel stands out, a little below the tread: the middle of the tread is what rolls."""
    parts = []
    for side, sign in (("left", 1), ("right", -1)):
        shapes = [
            visual(f'<cylinder radius="{radius}" length="0.03"/>', xyz=f"0 {sign * y} 0", rpy="1.5707963 0 0")
            for radius, y in ((0.1, 0.0042), (0.094, -0.02))
        ]
        parts.append(link(f"{side}_wheel", *shapes))
        place = f"0 {0.25 * sign} 0"
        parts.append(joint(side, "base", f"{side}_wheel", kind="continuous", xyz=place, axis="0 1 0"))
    plugin = "<left_joint>left</left_joint><right_joint>right</right_joint><wheel_separation>0.8</wheel_separation>"
    block = f'<gazebo><plugin filename="libgazebo_ros_diff_drive.so" name="d">{plugin}</plugin></gazebo>'
    (finding,) = find(tmp_path, robot(link("base"), *parts, block), "CTL007")
    assert finding.data["real"] == pytest.approx(0.5084)
    assert finding.fix is not None
    assert finding.fix.title.startswith("write 0.508 for wheel_separation")


@pytest.mark.parametrize(("start", "says"), [("gzserver", "share one topic"), ("ros_gz_sim", "the second is dropped")])
def test_classic_loads_two_sensors_of_one_name(tmp_path: Path, start: str, says: str) -> None:
    files = {
        "package.xml": "<package><name>arm</name></package>",
        "launch/sim.launch.py": f"program = '{start}'",
        "arm.urdf": robot(ARM, _SENSOR.format(name="imu") * 2),
    }
    (finding,) = find(tmp_path, files, "GZB004", name="arm.urdf")
    assert says in finding.message
    assert ("Classic" in finding.consequences["gazebo"]) == (start != "gzserver")


def test_a_plugin_of_classic_shows_that_sensors_of_one_name_are_loaded(tmp_path: Path) -> None:
    plugin = '<plugin name="s" filename="libhector_gazebo_ros_sonar.so"/>'
    sonar = f'<gazebo reference="a"><sensor name="range" type="ray">{plugin}</sensor></gazebo>'
    (finding,) = find(tmp_path, robot(ARM, sonar * 3), "GZB004")
    assert (finding.message_id, finding.severity) == ("shared", Severity.INFO)
    assert finding.message == "a has 3 sensors named range; they share one topic"


@pytest.mark.parametrize(("name", "severity"), [("Thruster_1", Severity.INFO), ("axis_1", Severity.WARNING)])
def test_a_thruster_may_be_fixed(tmp_path: Path, name: str, severity: Severity) -> None:
    fixed = f'<link name="plate"/><joint name="{name}" type="fixed"><parent link="base"/><child link="plate"/></joint>'
    inner = f'<joint name="{name}"><command_interface name="effort"/></joint>'
    blocks = f'<ros2_control name="c" type="system">{inner}</ros2_control>'
    (finding,) = (f for f in find(tmp_path, robot(ARM + fixed, blocks), "CTL002") if f.message_id == "fixed")
    assert finding.severity == severity


def test_blocks_with_the_names_of_fixed_joints_may_be_for_those_that_move(tmp_path: Path) -> None:
    fixed = "".join(
        f'<link name="{n}_plate"/><joint name="{n}" type="fixed"><parent link="base"/><child link="{n}_plate"/></joint>'
        for n in ("p", "q")
    )
    blocks = control().replace('"j"', '"p"').replace('"k"', '"q"')
    (finding,) = (f for f in find(tmp_path, robot(ARM + fixed, blocks), "CTL002") if f.message_id == "fixed")
    assert finding.fix is not None
    assert finding.fix.title.startswith("name the joints that move there (j, k have no drive), or ")
