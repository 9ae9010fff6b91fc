"""NAM rules: names that are fine, and names that are not."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest
from builders import find, joint, robot
from conftest import check, check_text

from urdfcheck.core import Severity

XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


def model(link: str, joint: str = "j") -> str:
    return (
        f'<robot name="r"><link name="base"/><link name="{link}"/>'
        f'<joint name="{joint}" type="fixed"><parent link="base"/><child link="{link}"/></joint></robot>'
    )


class TestNAM001:
    @pytest.mark.parametrize(
        ("script", "severity"),
        [
            ("xacro r.urdf > m.urdf\ngz sdf -p m.urdf > m.sdf", Severity.INFO),
            ("xacro r.urdf > m.urdf", Severity.WARNING),
            ("gz sdf -p s.urdf > m.sdf", Severity.WARNING),
            ("gz sdf -p r.urdf > m.sdf\nroslaunch p rviz.launch model:=r.urdf", Severity.WARNING),
        ],
    )
    def test_a_slash_in_a_file_that_only_gazebo_reads_is_a_note(
        self, tmp_path: Path, script: str, severity: Severity
    ) -> None:
        files = {
            "package.xml": "<package><name>p</name></package>",
            "r.urdf": '<robot name="r"><link name="/a"/></robot>',
            "make.sh": script,
        }
        (finding,) = find(tmp_path, files, "NAM001", name="r.urdf")
        assert finding.severity is severity

    @pytest.mark.parametrize(("name", "severity"), [("'s.urdf'", Severity.INFO), ("name + '.urdf'", Severity.WARNING)])
    def test_a_launch_file_that_computes_a_name_may_publish_the_frames(
        self, tmp_path: Path, name: str, severity: Severity
    ) -> None:
        files = {
            "package.xml": "<package><name>p</name></package>",
            "r.urdf": '<robot name="r"><link name="/a"/></robot>',
            "make.sh": "gz sdf -p r.urdf > m.sdf",
            "a.launch.py": f"Node(package='robot_state_publisher', arguments=[{name}])",
        }
        (finding,) = find(tmp_path, files, "NAM001", name="r.urdf")
        assert finding.severity is severity

    @pytest.mark.parametrize(
        ("namespace", "name", "typed"),
        [("", "${ns}/base", "${ns}/base"), ("", "/base${ns}", ""), ("/r", "${ns}/base", ""), ("/", "${ns}base", "")],
    )
    def test_a_slash_behind_an_empty_value(self, tmp_path: Path, namespace: str, name: str, typed: str) -> None:
        ns = f'<xacro:property name="ns" value="{namespace}"/>'
        text = f'<robot name="r" {XACRO}>{ns}<link name="{name}"/></robot>'
        finding = check_text(tmp_path, text, codes={"NAM001"}, name="r.xacro").findings[0]
        assert (finding.message_id, finding.data["typed"]) == (
            "slash_behind_nothing" if typed else "leading_slash",
            typed,
        )

    @pytest.mark.parametrize(
        ("wrong", "message"), [("/eye", "leading_slash"), ("my eye", "space"), ("a::eye", "scope"), ("a/eye", "slash")]
    )
    def test_the_place_is_where_a_call_or_a_property_gives_what_is_wrong(
        self, tmp_path: Path, wrong: str, message: str
    ) -> None:
        macro = '<xacro:macro name="camera" params="name">\n<link name="${name}_link"/>\n</xacro:macro>'
        text = f'<robot name="r" {XACRO}>{macro}\n<xacro:property name="eye" value="{wrong}"/>\n'
        for call, line in ((f'<xacro:camera name="{wrong}"/>', 5), ('<xacro:camera name="${eye}"/>', 4)):
            run = check_text(tmp_path, text + call + "</robot>", codes={"NAM001"}, name="r.xacro")
            (finding,) = (f for f in run.findings if f.message_id == message)
            assert finding.location.span is not None
            assert finding.location.span.line == line
            assert any(step.line == 2 for step in finding.location.via)

    @pytest.mark.parametrize(
        "name", ["arm", "arm_2", "arm-2", "arm.2", "a__b", "_arm", "__arm", "Arm", "worlds", "größe"]
    )
    def test_harmless(self, tmp_path: Path, name: str) -> None:
        assert not check_text(tmp_path, model(name, name + "_joint"), codes={"NAM001"}).findings

    @pytest.mark.parametrize(("kind", "severity"), [("fixed", Severity.INFO), ("continuous", Severity.WARNING)])
    def test_a_blank_in_the_name_of_a_fixed_joint_is_a_note(
        self, tmp_path: Path, kind: str, severity: Severity
    ) -> None:
        text = model("arm", "my joint").replace("fixed", kind)
        (finding,) = check_text(tmp_path, text, codes={"NAM001"}).findings
        assert (finding.message_id, finding.severity) == ("space", severity)

    @pytest.mark.parametrize(
        ("name", "script", "targets", "severity"),
        [
            ("my arm", "rviz2", (), Severity.INFO),
            ("my arm", "rviz2", ("isaac",), Severity.WARNING),
            ("my arm", "from isaacsim import SimulationApp", (), Severity.WARNING),
            ("my_arm ", "rviz2", (), Severity.WARNING),
        ],
    )
    def test_blanks_inside_names_matter_to_usd(
        self, tmp_path: Path, name: str, script: str, targets: tuple[str, ...], severity: Severity
    ) -> None:
        files = {
            "package.xml": "<package><name>p</name></package>",
            "r.urdf": f'<robot name="r"><link name="{name}"/></robot>',
            "start.py": script,
        }
        (finding,) = find(tmp_path, files, "NAM001", name="r.urdf", targets=targets)
        assert (finding.message_id, finding.severity) == ("space", severity)

    @pytest.mark.parametrize(
        ("name", "message", "severity"),
        [
            ("", "empty", Severity.WARNING),
            ("my arm", "space", Severity.WARNING),
            ("/arm", "leading_slash", Severity.WARNING),
            ("left::arm", "scope", Severity.WARNING),
            ("__arm__", "reserved", Severity.WARNING),
            ("world", "world", Severity.INFO),
            ("left/arm", "slash", Severity.INFO),
            ("2nd", "digit", Severity.INFO),
        ],
    )
    def test_kinds(self, tmp_path: Path, name: str, message: str, severity: Severity) -> None:
        (finding,) = check_text(tmp_path, model(name), codes={"NAM001"}).findings
        assert (finding.message_id, finding.severity) == (message, severity)

    def test_a_world_that_is_no_root_is_a_warning_in_a_model_with_a_mass(self, tmp_path: Path) -> None:
        """Without one the model is only drawn."""
        mass = '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
        text = model("world").replace('<link name="base"/>', f'<link name="base">{mass}</link>')
        assert mass in text
        (finding,) = check_text(tmp_path, text, codes={"NAM001"}).findings
        assert (finding.message_id, finding.severity) == ("world", Severity.WARNING)

    @pytest.mark.parametrize(
        ("parent", "kind", "found"),
        [("base", "revolute", True), ("base", "fixed", False), ("world", "fixed", True)],
    )
    def test_joint_called_world_disappears_where_its_links_are_merged(
        self, tmp_path: Path, parent: str, kind: str, found: bool
    ) -> None:
        text = model("arm", "world").replace('"base"', f'"{parent}"').replace("fixed", kind)
        messages = [f.message_id for f in check_text(tmp_path, text, codes={"NAM001"}).findings]
        assert messages == ["world-joint"] * found

    def test_world_as_the_root_is_a_convention(self, tmp_path: Path) -> None:
        text = model("arm").replace("base", "world")
        assert not check_text(tmp_path, text, codes={"NAM001"}).findings

    def test_all_names_of_a_kind_are_one_finding(self, tmp_path: Path) -> None:
        (finding,) = check_text(tmp_path, model("2nd", "1st"), codes={"NAM001"}).findings
        assert len(finding.subjects) == 2


class TestNAM003:
    @pytest.mark.parametrize(
        ("robot", "package", "included"),
        [
            ("panda", "franka_description", "hand"),
            ("husky", "husky_description", "husky_wheel"),
            ("fanuc_m16ib20", "fanuc_m16ib_support", "fanuc_common"),
            ("ur", "ur_description", "ur_macro"),
            ("left_arm", "right_arm_description", "arm_macro"),
        ],
    )
    def test_names_that_differ_for_good_reasons(self, tmp_path: Path, robot: str, package: str, included: str) -> None:
        folder = tmp_path / package
        folder.mkdir()
        (folder / "package.xml").write_text(f"<package><name>{package}</name></package>")
        (folder / "part.xacro").write_text(f'<robot name="{included}" {XACRO}/>')
        path = folder / f"{robot}.urdf.xacro"
        path.write_text(
            f'<robot name="{robot}" {XACRO}><xacro:include filename="part.xacro"/><link name="base"/></robot>'
        )
        assert not check(path, codes={"NAM003"}).findings

    @pytest.mark.parametrize(
        ("name", "file", "found"),
        [
            ("quadroped", "quadruped", True),
            ("anymal_quadropd", "anymal_quadruped", True),
            ("ezgripper_stand_alone", "ezgripper_quad_standalone", False),
            ("allegro_hand_left", "allegro_left_hand", False),
            ("left_gripper", "gripper_left", False),
            ("solo", "solo12", False),
            ("kr10r900", "kr10r1100", False),
            ("panda", "pando", False),
            ("gripper_left_r", "gripper_left_l", False),
        ],
    )
    def test_misspelt(self, tmp_path: Path, name: str, file: str, found: bool) -> None:
        run = check_text(tmp_path, f'<robot name="{name}"><link name="a"/></robot>', f"{file}.urdf", codes={"NAM003"})
        assert bool(run.findings) == found

    @pytest.mark.parametrize(
        ("folder", "repair"),
        [
            ("quadruped_description", 'write `name="quadruped"`, as the folder quadruped_description has it'),
            ("models", "use the same spelling for both"),
        ],
    )
    def test_the_folder_may_know_the_spelling(self, tmp_path: Path, folder: str, repair: str) -> None:
        (tmp_path / folder / "urdf").mkdir(parents=True)
        (tmp_path / folder / "urdf/quadruped.urdf").write_text('<robot name="quadroped"><link name="a"/></robot>')
        (finding,) = check(tmp_path / folder / "urdf/quadruped.urdf", codes={"NAM003"}).findings
        assert finding.fix is not None
        assert finding.fix.title.startswith(repair)


def links(*names: str) -> str:
    return "".join(f'<link name="{name}"/>' for name in names)


def make_joint(name: str, parent: str, child: str, origin: str = "", kind: str = "fixed") -> str:
    """Return a joint; ``origin`` are the attributes of this element."""
    return joint(name, parent, child, f"<origin {origin}/>", kind=kind)


class TestNAM002:
    LOWER = ("chassis_link", "left_wheel", "right_wheel", "rear_caster", "imu_mount")

    @pytest.mark.parametrize(
        ("names", "odd"),
        [
            ((*LOWER, "Laser_link"), ["Laser_link"]),
            ((*LOWER, "laserLink"), ["laserLink"]),
            ((*LOWER[:4], "Laser_link"), []),  # four names are no style yet
            ((*LOWER, "Laser_link", "Front_laser"), []),  # five of seven are no clear majority
            ((*LOWER, "base_link", "laser-2", "mast"), []),
            (("chassisLink", "leftWheel", "rightWheel", "rearCaster", "imuMount", "laser_link"), ["laser_link"]),
            (("chassisLink", "leftWheel", "rightWheel", "rearCaster", "imuMount", "base_link", "torso"), []),
            (
                ("FL_HAA", "FR_HAA", "HL_HAA", "HR_HAA", "FL_KFE", "base_inertia"),
                [],
            ),  # capitals are no style to keep to
        ],
    )
    def test_the_style_of_almost_all_names(self, tmp_path: Path, names: tuple[str, ...], odd: list[str]) -> None:
        findings = find(tmp_path, robot(links(*names)), "NAM002")
        assert [f.subjects for f in findings] == ([tuple(f"link[{name}]@name" for name in odd)] if odd else [])

    def test_one_finding_for_links_and_joints(self, tmp_path: Path) -> None:
        joints = "".join(make_joint(f"{name}_mount", "base_link", name) for name in (*self.LOWER, "Laser_link"))
        (finding,) = find(tmp_path, robot(links("base_link", *self.LOWER, "Laser_link") + joints), "NAM002")
        assert "Laser_link, Laser_link_mount" in finding.message


class TestNAM004:
    OPTICAL = 'rpy="-1.5707963267948966 0 -1.5707963267948966"'

    @pytest.mark.parametrize(
        ("parent", "origin", "message"),
        [
            ("camera_link", OPTICAL, None),
            ("camera_link", 'rpy="-1.57 0 -1.57"', None),
            ("camera_link", 'rpy="-1.59 0 -1.57"', None),  # calibrated
            ("camera_link", 'quat_xyzw="-0.5 0.5 -0.5 0.5"', None),
            ("camera_link", "", "optical-unturned"),
            ("camera_link", 'rpy="1.5707963 0 -1.5707963"', "optical"),
            ("camera_frame", 'rpy="-1.5707963 0 0"', "optical"),
            ("head", 'rpy="0.3 0 0"', None),  # how the camera is mounted
            ("rear_camera_link", "", None),
            ("camera_depth_optical_frame", "", None),
        ],
    )
    def test_optical_frames(self, tmp_path: Path, parent: str, origin: str, message: str | None) -> None:
        body = links(parent, "camera_optical_frame") + make_joint("j", parent, "camera_optical_frame", origin)
        assert [f.message_id for f in find(tmp_path, robot(body), "NAM004")] == ([] if message is None else [message])

    @pytest.mark.parametrize(("turned", "found"), [("0 1.5707963 0", False), ("0 0 1.5707963", True)])
    def test_a_camera_link_that_is_turned_may_hold_an_unusual_optical_frame(
        self, tmp_path: Path, turned: str, found: bool
    ) -> None:
        """Below a camera link that looks down, a quarter turn about z looks forward again, with the top of the picture up."""
        body = links("base_link", "camera_link", "camera_optical") + make_joint(
            "mount", "base_link", "camera_link", f'rpy="{turned}"'
        )
        body += make_joint("j", "camera_link", "camera_optical", 'rpy="0 0 -1.5707963"')
        assert bool(find(tmp_path, robot(body), "NAM004")) is found

    @pytest.mark.parametrize(
        ("sensor", "frame", "count"),
        [
            ("depth_camera", "camera_optical", 0),
            ("rgbd_camera", "camera_optical", 0),
            ("rgbd_camera", "camera_link", 1),
            ("camera", "camera_optical", 1),
        ],
    )
    def test_a_frame_of_a_cloud_of_points_of_gazebo_is_not_turned(
        self, tmp_path: Path, sensor: str, frame: str, count: int
    ) -> None:
        body = links("camera_link", "camera_optical") + make_joint("j", "camera_link", "camera_optical", "")
        inside = f'<sensor name="s" type="{sensor}"><gz_frame_id>{frame}</gz_frame_id></sensor>'
        body += f'<gazebo reference="camera_link">{inside}</gazebo>'
        assert len(find(tmp_path, robot(body), "NAM004")) == count

    @pytest.mark.parametrize(("sensor", "count"), [("gyro", 0), ("accel", 0), ("imu", 0), ("depth", 1)])
    def test_an_inertial_sensor_has_no_picture(self, tmp_path: Path, sensor: str, count: int) -> None:
        parent, child = f"camera_{sensor}_frame", f"camera_{sensor}_optical_frame"
        body = links(parent, child) + make_joint("j", parent, child, "")
        assert len(find(tmp_path, robot(body), "NAM004")) == count

    def test_several_frames_are_named_with_their_cameras(self, tmp_path: Path) -> None:
        names = ("left_camera", "left_camera_optical", "right_camera", "right_camera_optical")
        pairs = ("base left_camera", "base right_camera", f"{names[0]} {names[1]}", f"{names[2]} {names[3]}")
        body = links("base", *names) + "".join(make_joint(f"j{n}", *p.split(), "") for n, p in enumerate(pairs))
        (finding,) = find(tmp_path, robot(body), "NAM004")
        who = "left_camera_optical, right_camera_optical have the orientation of left_camera, right_camera;"
        assert finding.message.startswith(f"optical frames {who}")

    def test_where_a_wrong_one_looks_and_what_to_write(self, tmp_path: Path) -> None:
        """x forward turned by +90° about x and -90° about z: z points back, y up."""
        body = links("camera_link", "camera_optical") + make_joint(
            "j", "camera_link", "camera_optical", 'rpy="1.5708 0 -1.5708"'
        )
        (finding,) = find(tmp_path, robot(body), "NAM004")
        assert "looks back in camera_link, with the top of the picture down" in finding.message
        assert finding.fix is not None
        repair = (
            'write rpy="-1.5707963267948966 0 -1.5707963267948966" if x of camera_link is forward and z up; otherwise'
        )
        assert finding.fix.title.startswith(repair)  # a camera may have the axes of its CAD program
        assert finding.fix.edits == ()  # a heuristic changes nothing

    @pytest.mark.parametrize(
        ("chain", "message"),
        [
            (("base_link", "base_footprint"), "footprint"),
            (("base_link", "leg", "base_footprint"), "footprint"),
            (("base_footprint", "base_link"), None),
            (("world", "odom", "base_footprint", "base_link"), None),
            (("pedestal", "base_link"), None),  # an empty root above the base, for KDL
            (("cell", "pedestal", "base_link"), "base"),
            (("pedestal", "arm_base_link"), None),
        ],
    )
    def test_the_base(self, tmp_path: Path, chain: tuple[str, ...], message: str | None) -> None:
        joints = "".join(make_joint(f"j{i}", a, b) for i, (a, b) in enumerate(pairwise(chain)))
        findings = find(tmp_path, robot(links(*chain) + joints), "NAM004")
        assert [f.message_id for f in findings] == ([] if message is None else [message])

    @pytest.mark.parametrize(
        ("rpy", "right"),
        [
            ("1.5707963 0 1.5707963", True),  # Universal Robots
            ("0 1.5707963 0", True),  # KUKA
            ("3.1415927 -1.5707963 0", True),  # Fanuc
            ("0 0 0", False),
            ("0 -1.5707963 0", False),
        ],
    )
    def test_tool0_points_away_from_the_flange(self, tmp_path: Path, rpy: str, right: bool) -> None:
        body = links("flange", "tool0") + make_joint("j", "flange", "tool0", f'rpy="{rpy}"')
        assert bool(find(tmp_path, robot(body), "NAM004")) != right

    @pytest.mark.parametrize(
        ("axis", "flange", "message"),
        [
            ("1 0 0", "0 0 0", "tool"),
            ("-1 0 0", "0 0 0", "tool"),
            ("0 0 1", "0 0 0", "flange"),  # Elite: tool0 points out of the robot, the flange does not
            ("0 0 1", "0 -1.5707963 -1.5707963", "tool"),
            ("0 1 0", "0 0 0", "tool_or_flange"),
        ],
    )
    def test_the_last_axis_shows_which_of_flange_and_tool0_is_wrong(
        self, tmp_path: Path, axis: str, flange: str, message: str
    ) -> None:
        body = links("arm", "wrist", "flange", "tool0") + make_joint("j", "flange", "tool0")
        body += joint("wrist_joint", "arm", "wrist", kind="continuous", axis=axis)
        body += make_joint("wrist_flange", "wrist", "flange", f'rpy="{flange}"')
        (finding,) = find(tmp_path, robot(body), "NAM004")
        assert finding.message_id == message
        where = "wrist_flange" if message == "flange" else "j"
        assert finding.location.subject.startswith(f"joint[{where}]")


class TestNAM005:
    @staticmethod
    def robot(*pairs: tuple[str, str, float], type_: str = "continuous", rpy: str = "0 0 0") -> str:
        """Pairs of links beside a base, the first of each ``y`` to the left of the second."""
        body = links("base_link", *(name for pair in pairs for name in pair[:2]))
        for left, right, y in pairs:
            body += make_joint(f"j_{left}", "base_link", left, f'xyz="0 {y / 2} 0" rpy="{rpy}"', type_)
            body += make_joint(f"j_{right}", "base_link", right, f'xyz="0 {-y / 2} 0" rpy="{rpy}"', type_)
        return body

    USUAL = (("left_wheel", "right_wheel", 0.4), ("l_arm", "r_arm", 0.3))

    @pytest.mark.parametrize(
        ("pair", "wrong"),
        [
            (("left_lidar", "right_lidar", -0.2), True),
            (("LeftEye", "RightEye", -0.2), True),
            (("foot_fl", "foot_fr", -0.2), True),
            (("LShoulder", "RShoulder", -0.2), True),
            (("left_lidar", "right_lidar", 0.2), False),
            (("left_lidar", "right_lidar", -0.005), False),  # not apart
            (("left_lidar", "rear_lidar", -0.2), False),
        ],
    )
    def test_the_majority_tells_which_side_is_left(
        self, tmp_path: Path, pair: tuple[str, str, float], wrong: bool
    ) -> None:
        findings = find(tmp_path, robot(self.robot(*self.USUAL, pair)), "NAM005")
        assert [f.subjects for f in findings] == ([(f"link[{pair[0]}]", f"link[{pair[1]}]")] if wrong else [])
        repair = "swap the names if the places are right, else the y of the origins of their joints"
        assert [f.fix.title for f in findings if f.fix] == [repair] * wrong

    def test_a_base_that_is_turned_round_is_no_finding(self, tmp_path: Path) -> None:
        pairs = [(left, right, -y) for left, right, y in self.USUAL]
        assert not find(tmp_path, robot(self.robot(*pairs, ("left_lidar", "right_lidar", -0.2))), "NAM005")
        assert find(tmp_path, robot(self.robot(*pairs, ("left_lidar", "right_lidar", 0.2))), "NAM005")

    @pytest.mark.parametrize(("kind", "found"), [("fixed", False), ("continuous", True)])
    def test_who_moves_the_wrong_part_is_said_of_parts_that_move(self, tmp_path: Path, kind: str, found: bool) -> None:
        body = self.robot(*self.USUAL) + self.robot(("left_part", "right_part", -0.2), type_="fixed").partition("/>")[2]
        for side in ("left", "right"):
            body += links(f"{side}_tip") + make_joint(f"t_{side}", f"{side}_part", f"{side}_tip", "", kind)
        (finding,) = find(tmp_path, robot(body), "NAM005")
        assert ("ros2_control" in finding.consequences) == found

    @pytest.mark.parametrize(("kind", "found"), [("fixed", False), ("continuous", True)])
    def test_fixed_parts_alone_do_not_outvote_a_pair_on_the_usual_side(
        self, tmp_path: Path, kind: str, found: bool
    ) -> None:
        body = self.robot(("left_wheel", "right_wheel", 0.4)) + "".join(
            links(f"{end}_left", f"{end}_right")
            + make_joint(f"{end}_l", "base_link", f"{end}_left", 'xyz="0 -0.1 0"', kind)
            + make_joint(f"{end}_r", "base_link", f"{end}_right", 'xyz="0 0.1 0"', kind)
            for end in ("front", "rear")
        )
        assert bool(find(tmp_path, robot(body), "NAM005")) is found

    def test_names_that_a_macro_types_are_not_swapped_for_one_call(self, tmp_path: Path) -> None:
        frame = '<link name="${at}_%s"/>' + joint(
            "${at}_%s", "${at}", "${at}_%s", '<origin xyz="0 ${%s * m} 0"/>', kind="fixed"
        )
        frames = frame % ("left", "left", "left", "0.1") + frame % ("right", "right", "right", "-0.1")
        feet = "".join(
            f'<link name="foot_{side}"/>'
            + make_joint(f"f_{side}", "base_link", f"foot_{side}", f'xyz="0 {y} 0"', "continuous")
            + f'<xacro:corners at="foot_{side}" m="{m}"/>'
            for side, y, m in (("left", 0.2, 1), ("right", -0.2, -1))
        )
        text = robot(
            f'<xacro:macro name="corners" params="at m">{frames}</xacro:macro>{links("base_link")}{feet}'
        ).replace("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ', 1)
        (finding,) = check_text(tmp_path, text, "r.urdf.xacro", codes={"NAM005"}).findings
        assert finding.fix is not None
        assert finding.fix.title.startswith("the same macro names other pairs right: give it a parameter")

    @pytest.mark.parametrize(
        ("names", "repair"),
        [
            (
                ("cap_right", "cap_left"),
                "swap the names of the links; if each is drawn for the other side, swap the children of the joints cap_right",
            ),
            (("a", "b"), "swap the names if the places are right"),
        ],
    )
    def test_joints_that_say_their_side_have_swapped_children(
        self, tmp_path: Path, names: tuple[str, str], repair: str
    ) -> None:
        body = self.robot(*self.USUAL) + links("left_part", "right_part")
        body += make_joint(names[0], "base_link", "left_part", 'xyz="0 -0.1 0"', "fixed")
        body += make_joint(names[1], "base_link", "right_part", 'xyz="0 0.1 0"', "fixed")
        (finding,) = find(tmp_path, robot(body), "NAM005")
        assert finding.fix is not None
        assert finding.fix.title.startswith(repair)

    def test_one_against_one_decides_nothing(self, tmp_path: Path) -> None:
        assert not find(tmp_path, robot(self.robot(self.USUAL[0], ("left_lidar", "right_lidar", -0.2))), "NAM005")

    @pytest.mark.parametrize(("type_", "rpy"), [("prismatic", "0 0 0"), ("fixed", "0 0 3.14159")])
    def test_fingers_and_rear_cameras_have_a_left_of_their_own(self, tmp_path: Path, type_: str, rpy: str) -> None:
        body = self.robot(*self.USUAL) + links("left_part", "right_part")
        body += make_joint("a", "base_link", "left_part", f'xyz="0 -0.1 0" rpy="{rpy}"', type_)
        body += make_joint("b", "base_link", "right_part", f'xyz="0 0.1 0" rpy="{rpy}"', type_)
        assert not find(tmp_path, robot(body), "NAM005")

    def test_a_limb_counts_once(self, tmp_path: Path) -> None:
        """Two pairs of three links each, and one of them is wrong: nobody can tell which."""
        body = self.robot(("left_arm", "right_arm", 0.4), ("left_leg", "right_leg", -0.4))
        for side in ("left", "right"):
            body += links(f"{side}_hand", f"{side}_finger")
            body += make_joint(f"h_{side}", f"{side}_arm", f"{side}_hand") + make_joint(
                f"f_{side}", f"{side}_hand", f"{side}_finger"
            )
        assert not find(tmp_path, robot(body), "NAM005")

    def test_a_name_without_end(self, tmp_path: Path) -> None:
        assert not find(
            tmp_path,
            robot(self.robot(*self.USUAL) + links("l_" * 20_000) + make_joint("j", "l_arm", "l_" * 20_000)),
            "NAM005",
        )


class TestNAM006:
    def test_all_spellings_of_a_name_are_one_finding(self, tmp_path: Path) -> None:
        (finding,) = find(tmp_path, robot(links("wheel", "Wheel", "WHEEL", "arm")), "NAM006")
        assert "'Wheel' and 'WHEEL'" in finding.message

    def test_a_link_and_a_joint_are_never_confused(self, tmp_path: Path) -> None:
        assert not find(tmp_path, robot(links("base", "wheel") + make_joint("Wheel", "base", "wheel")), "NAM006")


class TestNAM007:
    @pytest.mark.parametrize(
        ("name", "parent", "child", "message"),
        [
            ("base_to_arm", "base", "arm", None),
            ("arm_to_base", "base", "arm", "reversed"),
            ("arm_link_to_base_link_joint", "base_link", "arm_link", "reversed"),
            ("wheel_2_to_wheel_1", "wheel_1", "wheel_2", "reversed"),
            ("base_to_mast", "base", "arm", None),  # an older name, but of whom?
            ("arm_link", "base", "arm", "link-as-joint"),
            ("base_to_arm_link", "base", "arm_link", None),
            ("arm_joint_link", "base", "arm", None),
            ("link", "base", "arm", None),
        ],
    )
    def test_one_name(self, tmp_path: Path, name: str, parent: str, child: str, message: str | None) -> None:
        findings = find(tmp_path, robot(links(parent, child) + make_joint(name, parent, child)), "NAM007")
        assert [f.message_id for f in findings] == ([] if message is None else [message])

    @pytest.mark.parametrize(
        ("name", "wrong"),
        [("wheel_4_joint", False), ("wheel_5_joint", False), ("wheel_3_joint", True), ("mast_joint", False)],
    )
    def test_another_wheel(self, tmp_path: Path, name: str, wrong: bool) -> None:
        wheels = [f"wheel_{i}" for i in range(1, 5)]
        body = links("base", "mast", *wheels) + make_joint("m", "base", "mast")
        body += "".join(make_joint(f"{wheel}_axle_joint", "base", wheel) for wheel in wheels[:3]).replace("_axle", "")
        findings = find(tmp_path, robot(body + make_joint(name, "base", "wheel_4")), "NAM007")
        assert [f.message_id for f in findings] == (["other"] if wrong else [])
