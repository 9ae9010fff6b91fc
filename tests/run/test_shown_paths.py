"""No finding holds the absolute path of a checkout, unless the author has typed it."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
import trimesh
from conftest import check, list_machine_paths

from urdfcheck.run.shown_paths import PathShortener

XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
FILES = {
    "src/arm/package.xml": '<package format="3"><name>arm</name><exec_depend>gone</exec_depend></package>',
    "src/arm/config/broken.yaml": "a: [1",
    "src/arm/config/controllers.yaml": "controller_manager:\n  ros__parameters:\n    wheel:\n      type: a/B\n"
    "wheel:\n  ros__parameters:\n    joints: [nobody]\n",
    "src/arm/urdf/arm.urdf.xacro": f"""<robot name="arm" {XACRO}>
  <xacro:property name="here" value="$(find arm)"/>
  <xacro:property name="beside" value="$(dirname)"/>
  <xacro:macro name="part" params="name file">
    <link name="${{name}}">
      <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="5" ixy="0" ixz="0" iyz="0"/></inertial>
      <visual><geometry><mesh filename="${{file}}"/></geometry></visual>
      <collision><geometry><mesh filename="${{file}}"/></geometry></collision>
    </link>
  </xacro:macro>
  <xacro:part name="open" file="file://${{here}}/meshes/open.stl"/>
  <xacro:part name="twice" file="file:///${{here}}/meshes/twice.stl"/>
  <xacro:part name="heavy" file="file://${{beside}}/../meshes/heavy.stl"/>
  <xacro:part name="gone" file="file://${{here}}/meshes/gone.stl"/>
  <xacro:part name="case" file="${{here}}/meshes/OPEN.stl"/>
  <xacro:part name="text" file="${{here}}/meshes/text.stl"/>
  <link name="${{here}}/link"/>
  <joint name="j" type="fixed"><parent link="${{here}}"/><child link="open"/><origin xyz="${{here}} 0 0"/></joint>
  <gazebo><plugin name="c" filename="libgazebo_ros_control.so"><parameters>${{here}}/config/gone.yaml</parameters></plugin>
    <plugin name="d" filename="gz_ros2_control-system"><parameters>${{here}}/config/controllers.yaml</parameters></plugin>
  </gazebo>
</robot>
""",
    "src/arm/urdf/missing.urdf.xacro": f'<robot name="m" {XACRO}><xacro:include filename="$(find arm)/urdf/none.xacro"/></robot>',
    "src/arm/urdf/yaml.urdf.xacro": f"""<robot name="y" {XACRO}>
  <xacro:property name="v" value="${{xacro.load_yaml('$(find arm)/config/broken.yaml')}}"/>
  <link name="${{v}}"/></robot>
""",
    "src/arm/urdf/fatal.urdf.xacro": f"""<robot name="f" {XACRO}>
  <link name="${{xacro.fatal('$(find arm)/urdf is wrong')}}"/></robot>
""",
    "src/arm/launch/arm.launch": """<launch>
  <param name="robot_description" command="xacro '$(find arm)/urdf/nothing.urdf.xacro'"/>
  <include file="$(find arm)/launch/nothing.launch"/>
</launch>
""",
    "src/arm/launch/arm.launch.py": """import os
from ament_index_python.packages import get_package_share_directory
model = os.path.join(get_package_share_directory('arm'), 'urdf', 'nobody.urdf.xacro')
""",
}


def make_workspace(folder: Path) -> None:
    for name, text in FILES.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    meshes = folder / "src/arm/meshes"
    meshes.mkdir()
    box = trimesh.creation.box()
    box.update_faces(np.arange(10))
    box.export(meshes / "open.stl")
    trimesh.util.concatenate([trimesh.creation.box()] * 2).export(meshes / "twice.stl")
    trimesh.creation.icosphere(5).export(meshes / "heavy.stl")
    (meshes / "text.stl").write_text("solid nothing")


@pytest.mark.slow
@pytest.mark.parametrize("given", [".", "src/arm/urdf/arm.urdf.xacro"])
def test_no_finding_holds_the_path_of_the_checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, given: str) -> None:
    make_workspace(tmp_path)
    monkeypatch.chdir(tmp_path)
    run = check(Path(given), tier="mesh")
    assert not list_machine_paths(run, tmp_path)
    # Meshes and parameter files by computed paths are told by their place.
    assert {f.code for f in run.findings} >= {"MSH001", "MSH002", "MSH009", "PKG002", "CTL004", "XML007"}
    heavy = next(f for f in run.findings if f.code == "MSH009")
    assert "src/arm/meshes/heavy.stl" in heavy.message


@pytest.mark.slow
def test_fingerprints_are_the_same_in_another_checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = []
    for name in ("here", "elsewhere"):
        make_workspace(tmp_path / name)
        monkeypatch.chdir(tmp_path / name)
        found.append({print_ for f in check(Path(), tier="source").findings for print_ in f.fingerprints})
    assert found[0] == found[1]


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("the file {0}/a/b.stl is open", "the file a/b.stl is open"),
        ("the file file://{0}/a/b.stl.", "the file a/b.stl."),
        ("the file file:///{0}/a/b.stl: no", "the file a/b.stl: no"),
        ("two: {0}/a, {0}/b", "two: a, b"),
        ("in '{0}'", "in '.'"),
        ("other{0}/a", "other{0}/a"),
        ("{0}x/a", "{0}x/a"),
        ("typed {0}/typed.stl", "typed {0}/typed.stl"),
        ("../..{0}/a", "../..{0}/a"),
    ],
)
def test_what_is_shortened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, shown: str) -> None:
    monkeypatch.chdir(tmp_path)
    shortener = PathShortener([str(tmp_path)], lambda path: path.endswith("typed.stl"))
    assert shortener.shorten_text(text.format(tmp_path)) == shown.format(tmp_path)


@pytest.mark.parametrize("folder", [os.sep, "/usr", ""])
def test_a_root_is_not_taken_for_a_checkout(folder: str) -> None:
    assert (
        PathShortener([folder], lambda _: False).shorten_text("/usr/share/a and /cmd_vel")
        == "/usr/share/a and /cmd_vel"
    )
