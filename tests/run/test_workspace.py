"""A ROS 2 workspace as teams have them: one run finds its models and checks each file where it belongs."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Mapping
from pathlib import Path

import pytest
from conftest import check

from urdfcheck.core import Finding, Run
from urdfcheck.rules import load_rules
from urdfcheck.source.discover import discover_targets
from urdfcheck.source.package import finder

pytestmark = pytest.mark.slow

XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
FAMILIES = ("KIN", "LCH", "PKG", "SRD", "XAC", "XML")


def manifest(name: str, build: str, *depends: str) -> str:
    lines = "".join(f"  <exec_depend>{other}</exec_depend>\n" for other in depends)
    tool = f"  <buildtool_depend>{build}</buildtool_depend>\n" if build == "ament_cmake" else ""
    export = f"  <export>\n    <build_type>{build}</build_type>\n  </export>\n"
    return f'<package format="3">\n  <name>{name}</name>\n{tool}{lines}{export}</package>\n'


def cmake(name: str, *folders: str) -> str:
    installed = f"install(DIRECTORY {' '.join(folders)} DESTINATION share/${{PROJECT_NAME}})"
    head = f"cmake_minimum_required(VERSION 3.8)\nproject({name})\nfind_package(ament_cmake REQUIRED)"
    return f"{head}\n{installed}\nament_package()\n"


FILES: Mapping[str, str] = {
    "src/rover_description/package.xml": manifest("rover_description", "ament_cmake", "xacro", "robot_state_publisher"),
    "src/rover_description/CMakeLists.txt": cmake("rover_description", "launch", "meshes", "urdf"),
    "src/rover_description/urdf/rover.urdf.xacro": f"""<robot name="rover" {XACRO}>
  <xacro:arg name="use_sim" default="false"/>
  <xacro:include filename="materials.xacro"/>
  <xacro:include filename="$(find rover_description)/urdf/wheel.xacro"/>
  <link name="base_footprint"/>
  <joint name="base_joint" type="fixed">
    <parent link="base_footprint"/>
    <child link="base_link"/>
    <origin xyz="0 0 0.05"/>
  </joint>
  <link name="base_link">
    <inertial>
      <mass value="4"/>
      <inertia ixx="0.03" iyy="0.05" izz="0.08" ixy="0" ixz="0" iyz="0"/>
    </inertial>
    <visual>
      <geometry><mesh filename="package://rover_description/meshes/base.stl"/></geometry>
      <material name="grey"/>
    </visual>
    <collision><geometry><box size="0.4 0.3 0.1"/></geometry></collision>
  </link>
  <xacro:wheel name="left" y="${{track / 2}}"/>
  <xacro:wheel name="right" y="${{-track / 2}}"/>
  <xacro:if value="$(arg use_sim)">
    <xacro:include filename="$(find rover_description)/urdf/sim.xacro"/>
  </xacro:if>
</robot>
""",
    "src/rover_description/urdf/materials.xacro": f"""<robot {XACRO}>
  <xacro:property name="track" value="0.36"/>
  <material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>
</robot>
""",
    "src/rover_description/urdf/wheel.xacro": f"""<robot {XACRO}>
  <xacro:property name="radius" value="0.05"/>
  <xacro:macro name="wheel" params="name y">
    <link name="${{name}}_wheel">
      <inertial>
        <mass value="1"/>
        <inertia ixx="0.001" iyy="0.001" izz="0.001" ixy="0" ixz="0" iyz="0"/>
      </inertial>
      <visual><geometry><mesh filename="package://rover_description/meshes/wheel.stl"/></geometry></visual>
      <collision><geometry><sphere radius="${{radius}}"/></geometry></collision>
    </link>
    <joint name="${{name}}_wheel_joint" type="continuous">
      <parent link="base_link"/>
      <child link="${{name}}_wheel"/>
      <origin xyz="0 ${{y}} 0"/>
      <axis xyz="0 1 0"/>
    </joint>
  </xacro:macro>
</robot>
""",
    "src/rover_description/urdf/sim.xacro": f"""<robot {XACRO}>
  <gazebo reference="left_wheel"><mu1>${{radius * 20}}</mu1></gazebo>
</robot>
""",
    "src/rover_description/meshes/base.stl": "solid base\nendsolid base\n",
    "src/rover_description/meshes/wheel.stl": "solid wheel\nendsolid wheel\n",
    "src/rover_description/launch/view.launch.py": """import os
from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.substitutions import Command
from launch_ros.actions import Node


def generate_launch_description():
    share = get_package_share_directory('rover_description')
    model = os.path.join(share, 'urdf', 'rover.urdf.xacro')
    parameters = [{'robot_description': Command(['xacro ', model])}]
    return LaunchDescription([
        Node(package='robot_state_publisher', executable='robot_state_publisher', parameters=parameters),
    ])
""",
    "src/rover_bringup/package.xml": manifest(
        "rover_bringup", "ament_python", "rover_description", "ros_gz", "robot_state_publisher", "xacro"
    ),
    "src/rover_bringup/setup.py": """from glob import glob
from setuptools import setup

package_name = 'rover_bringup'
setup(
    name=package_name,
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
        ('share/' + package_name + '/launch', glob('launch/*')),
        ('share/' + package_name + '/config', glob('config/*.yaml')),
    ],
)
""",
    "src/rover_bringup/resource/rover_bringup": "",
    "src/rover_bringup/config/controllers.yaml": """controller_manager:
  ros__parameters:
    update_rate: 100
""",
    "src/rover_bringup/launch/sim.launch.xml": """<launch>
  <node pkg="robot_state_publisher" exec="robot_state_publisher">
    <param name="robot_description"
           value="$(command 'xacro $(find-pkg-share rover_description)/urdf/rover.urdf.xacro use_sim:=true')"/>
    <param from="$(find-pkg-share rover_bringup)/config/controllers.yaml"/>
  </node>
  <include file="$(find-pkg-share ros_gz_sim)/launch/gz_sim.launch.py"/>
</launch>
""",
    "src/rover_moveit_config/package.xml": manifest("rover_moveit_config", "ament_cmake", "rover_description", "xacro"),
    "src/rover_moveit_config/CMakeLists.txt": cmake("rover_moveit_config", "config", "launch"),
    "src/rover_moveit_config/config/rover.srdf": """<robot name="rover">
  <group name="drive"><joint name="left_wheel_joint"/><joint name="right_wheel_joint"/></group>
  <disable_collisions link1="base_link" link2="left_wheel" reason="Adjacent"/>
  <disable_collisions link1="base_link" link2="right_wheel" reason="Adjacent"/>
</robot>
""",
    "src/rover_moveit_config/config/joint_limits.yaml": """joint_limits:
  left_wheel_joint: &wheel {has_velocity_limits: true, max_velocity: 1.0, has_acceleration_limits: true, max_acceleration: 2.0}
  right_wheel_joint: *wheel
""",
    "src/rover_moveit_config/launch/demo.launch.py": """from moveit_configs_utils import MoveItConfigsBuilder


def generate_launch_description():
    return MoveItConfigsBuilder('rover', package_name='rover_moveit_config').to_moveit_configs()
""",
    # what colcon has made: copies of all that
    "build/rover_description/rover.urdf": '<robot name="copy"><link name="a"/><link name="b"/></robot>',
    "install/rover_description/share/rover_description/package.xml": manifest("rover_description", "ament_cmake"),
    "install/rover_description/share/rover_description/urdf/rover.urdf": '<robot name="copy"/>',
    "log/latest/rover.urdf": '<robot name="copy"/>',
}


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "src/.git").mkdir(parents=True)
    for name, text in FILES.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def audit(*paths: str) -> Run:
    codes = {code for code in load_rules() if code.startswith(FAMILIES)}
    run = check(*map(Path, paths), codes=codes, tier="source")
    assert not run.failures
    return run


def told(*paths: str) -> list[tuple[str, str]]:
    return [(f.code, f.location.span.file) for f in audit(*paths).findings if f.location.span is not None]


def change(name: str, old: str, new: str) -> None:
    path = Path(name)
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")


def test_a_sound_workspace_has_no_findings(workspace: Path) -> None:
    run = audit(".")
    assert [(f.code, f.message) for f in run.findings] == []
    # The parts are no models, the copies are none, and the launch file's arguments make the variant that is checked.
    assert {(m.path, tuple(m.args.items())) for m in run.models} == {
        ("src/rover_description/urdf/rover.urdf.xacro", (("use_sim", "true"),)),
    }
    assert {m.status for m in run.models} == {"checked"}
    assert [(m.links, m.joints) for m in run.models] == [(4, 3)]


@pytest.mark.parametrize(
    ("name", "old", "new", "finding"),
    [
        ("rover_description/CMakeLists.txt", " meshes urdf", " urdf",
         ("PKG008", "src/rover_description/CMakeLists.txt")),
        ("rover_description/CMakeLists.txt", " urdf ", " ", ("PKG008", "src/rover_description/CMakeLists.txt")),
        ("rover_bringup/setup.py", "/config', glob('config/", "', glob('cfg/", ("PKG008", "src/rover_bringup/setup.py")),
        ("rover_bringup/package.xml", "  <exec_depend>rover_description</exec_depend>\n", "",
         ("PKG007", "src/rover_bringup/package.xml")),
        ("rover_description/urdf/wheel.xacro", "meshes/wheel.stl", "meshes/base.stl",
         ("PKG010", "src/rover_description/package.xml")),
        ("rover_description/urdf/wheel.xacro", "meshes/wheel.stl", "mesh/wheel.stl",
         ("PKG002", "src/rover_description/urdf/wheel.xacro")),
        ("rover_description/urdf/wheel.xacro", "package://rover_description", "package://rover_descripton",
         ("PKG001", "src/rover_description/urdf/wheel.xacro")),
        ("rover_description/urdf/wheel.xacro", '<xacro:property name="radius"',
         '<xacro:property name="radius" value="0.5"/>\n  <xacro:property name="radius"',
         ("XAC008", "src/rover_description/urdf/wheel.xacro")),
        ("rover_description/urdf/sim.xacro", "<gazebo ", '<xacro:include filename="sim.xacro"/><gazebo ',
         ("XAC013", "src/rover_description/urdf/sim.xacro")),
        ("rover_description/urdf/sim.xacro", "<gazebo ", '<xacro:macro name="sun"><gazebo/></xacro:macro><gazebo ',
         ("XAC003", "src/rover_description/urdf/sim.xacro")),
        ("rover_description/urdf/rover.urdf.xacro", "<xacro:wheel name=\"right\"", "<wheel name=\"right\"",
         ("XAC007", "src/rover_description/urdf/rover.urdf.xacro")),
    ],
)  # fmt: skip
def test_what_is_broken_in_it_is_one_finding_in_the_file_that_must_change(
    workspace: Path, name: str, old: str, new: str, finding: tuple[str, str]
) -> None:
    change(f"src/{name}", old, new)
    assert [x for x in told(".") if x[0][:3] in {"PKG", "XAC"}] == [finding]


def test_a_package_alone_knows_its_workspace(workspace: Path) -> None:
    """What the other packages use is used, and what only they name is named, whichever of them the run is about."""
    change(
        "src/rover_description/urdf/rover.urdf.xacro",
        '  <xacro:if value="$(arg use_sim)">',
        '  <xacro:if value="${False}">',
    )
    assert told("src/rover_description") == []  # use_sim is handed over by rover_bringup's launch file
    change("src/rover_bringup/launch/sim.launch.xml", " use_sim:=true", "")
    assert told("src/rover_description") == [("XAC004", "src/rover_description/urdf/rover.urdf.xacro")]
    change("src/rover_description/launch/view.launch.py", "'urdf'", "'robots'")
    change("src/rover_description/CMakeLists.txt", "launch meshes urdf", "launch meshes")
    assert ("PKG008", "src/rover_description/CMakeLists.txt") in told("src/rover_description")


def test_a_single_model_of_it_is_not_asked_for_the_whole_package(workspace: Path) -> None:
    (workspace / "src/rover_description/meshes/old.stl").write_text("solid old\nendsolid old\n")
    assert told("src/rover_description/urdf/rover.urdf.xacro") == []
    assert told("src/rover_description") == [("PKG010", "src/rover_description/package.xml")]


def test_edits_of_the_build_files_mend_them(workspace: Path) -> None:
    change("src/rover_description/CMakeLists.txt", "launch meshes urdf", "launch")
    change("src/rover_bringup/package.xml", "  <exec_depend>rover_description</exec_depend>\n", "")
    findings: list[Finding] = list(audit(".").findings)
    assert [f.code for f in findings] == ["PKG007", "PKG008"]
    for finding in findings:
        assert finding.fix is not None
        (edit,) = finding.fix.edits
        path = Path(edit.span.file)
        text = path.read_text(encoding="utf-8")
        assert text[edit.span.start : edit.span.end] == edit.expected
        path.write_text(text[: edit.span.start] + edit.replacement + text[edit.span.end :], encoding="utf-8")
    assert told(".") == []


# -- files that lie elsewhere before they are installed ---------------------------------------------------------------


SPLIT: Mapping[str, str] = {
    "src/demo/package.xml": manifest("demo", "ament_cmake", "xacro", "robot_state_publisher"),
    "src/demo/CMakeLists.txt": "project(demo)\ninstall(DIRECTORY bringup/launch description/urdf description/meshes "
    "description/control DESTINATION share/${PROJECT_NAME})\nament_package()\n",
    "src/demo/description/urdf/demo.urdf.xacro": f"""<robot name="demo" {XACRO}>
  <xacro:include filename="$(find demo)/control/demo.control.xacro"/>
  <xacro:include filename="../control/limits.xacro"/>
  <link name="base">
    <visual><geometry><mesh filename="package://demo/meshes/base.stl"/></geometry></visual>
  </link>
  <xacro:control/>
</robot>
""",
    "src/demo/description/control/demo.control.xacro": f"""<robot {XACRO}>
  <xacro:include filename="../urdf/parts.xacro"/>
  <xacro:macro name="control"><xacro:tool/></xacro:macro>
</robot>
""",
    "src/demo/description/control/limits.xacro": f'<robot {XACRO}><xacro:property name="side" value="left"/></robot>',
    "src/demo/description/urdf/parts.xacro": f"""<robot {XACRO}>
  <xacro:macro name="tool">
    <link name="tool"/>
    <joint name="${{side}}_mount" type="fixed"><parent link="base"/><child link="tool"/></joint>
  </xacro:macro>
</robot>
""",
    "src/demo/description/meshes/base.stl": "solid base\nendsolid base\n",
    "src/demo/bringup/launch/demo.launch.xml": """<launch>
  <node pkg="robot_state_publisher" exec="robot_state_publisher">
    <param name="robot_description" value="$(command 'xacro $(find-pkg-share demo)/urdf/demo.urdf.xacro')"/>
  </node>
</launch>
""",
    "src/demo/bringup/launch/demo.launch.py": """from launch.substitutions import Command, PathJoinSubstitution, PathSubstitution
from launch_ros.substitutions import FindPackageShare

model = PathJoinSubstitution([FindPackageShare("demo"), "urdf", "demo.urdf.xacro"])
other = PathSubstitution(FindPackageShare("demo")) / "urdf" / "demo.urdf.xacro"
nodes = [Node(parameters=[{"robot_description": Command(["xacro ", model])}])]
""",
}


def run_workspace(folder: Path, monkeypatch: pytest.MonkeyPatch, files: Mapping[str, str]) -> Run:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    monkeypatch.chdir(folder)
    return audit(".")


def test_a_package_is_read_as_its_build_installs_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = run_workspace(tmp_path, monkeypatch, SPLIT)
    assert [(model.robot, model.links, model.status) for model in run.models] == [("demo", 2, "checked")]
    assert not [f for f in run.findings if f.code[:3] in {"LCH", "PKG", "XAC"}]


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        (" description/control", "", "XAC001"),
        ("{PROJECT_NAME})", '{PROJECT_NAME} PATTERN "*.stl" EXCLUDE)', "PKG002"),
        ("description/urdf ", "", "LCH001"),
    ],
)
def test_what_is_not_installed_is_not_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, old: str, new: str, code: str
) -> None:
    name = "src/demo/CMakeLists.txt"
    assert old in SPLIT[name]
    run = run_workspace(tmp_path, monkeypatch, {**SPLIT, name: SPLIT[name].replace(old, new)})
    assert code in {f.code for f in run.findings}


# -- packages at any depth --------------------------------------------------------------------------------------------


def write_deep(folder: Path, *repositories: str) -> None:
    """Two metapackages as `vcs import` makes them; the first one's robot uses a package far down in the other."""
    files = {
        "src/bot/bot_description/package.xml": manifest("bot_description", "ament_cmake", "xacro", "base_description"),
        "src/bot/bot_description/CMakeLists.txt": cmake("bot_description", "urdf"),
        "src/bot/bot_description/urdf/bot.urdf.xacro": f"""<robot name="bot" {XACRO}>
  <xacro:include filename="$(find base_description)/urdf/base.xacro"/>
  <xacro:base/>
</robot>
""",
        "src/maker/common/ros2/base_description/package.xml": manifest("base_description", "ament_cmake", "xacro"),
        "src/maker/common/ros2/base_description/CMakeLists.txt": cmake("base_description", "urdf"),
        "src/maker/common/ros2/base_description/urdf/base.xacro": f"""<robot {XACRO}>
  <xacro:macro name="base"><link name="base"/></xacro:macro>
</robot>
""",
    }
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    for repository in repositories:
        (folder / repository / ".git").mkdir()


@pytest.mark.parametrize("repositories", [(), ("src/bot", "src/maker"), ("",)])
@pytest.mark.parametrize("given", [".", "src", "src/bot", "src/bot/bot_description/urdf/bot.urdf.xacro"])
def test_packages_are_found_at_any_depth_below_the_given_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, given: str, repositories: tuple[str, ...]
) -> None:
    write_deep(tmp_path, *repositories)
    monkeypatch.chdir(tmp_path)
    run = audit(given)
    # In a repository of its own, a robot must not depend on what lies around the repository: only what was given is searched.
    found = given in {".", "src"} or "src/bot" not in repositories
    assert [model.status for model in run.models] == ["checked" if found else "failed"]
    assert ("PKG001" in {f.code for f in run.findings}) != found


def test_a_folder_is_not_walked_again_for_its_packages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The walk that looks for models finds the packages too, and a given file is searched around within a limit."""
    write_deep(tmp_path, "")
    for number in range(30):
        (tmp_path / f"data/{number}/a/b/leaf").mkdir(parents=True)
    monkeypatch.chdir(tmp_path)
    listed: list[str] = []
    scandir = os.scandir
    monkeypatch.setattr(os, "scandir", lambda path: listed.append(str(path)) or scandir(path))
    plan = discover_targets([Path()], {}, packages={}, package_paths=[])
    assert set(plan.known_packages) == {"bot_description", "base_description"}
    assert max(Counter(folder for folder in listed if folder.endswith("/leaf")).values()) == 1
    monkeypatch.setattr(finder, "MOST_FOLDERS_OF_REPOSITORY", 8)
    listed.clear()
    model = Path("src/bot/bot_description/urdf/plain.urdf")  # a xacro is looked for in all that may include it
    model.write_text('<robot name="r"><link name="a"/></robot>', encoding="utf-8")
    plan = discover_targets([model], {}, packages={}, package_paths=[])
    assert "base_description" not in plan.known_packages
    assert not [folder for folder in listed if folder.endswith("/leaf")]
