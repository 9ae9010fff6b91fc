"""GZB007: where Gazebo looks for meshes."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import find

from urdfcheck.core import Finding

MANIFEST = "<package format='3'><name>arm</name>{}</package>"
MODEL = '<robot name="arm"><link name="base"><visual><geometry><mesh filename="{}"/></geometry></visual></link></robot>'
MESH = "package://arm/meshes/base.stl"
FILES = "model = os.path.join(get_package_share_directory('arm'), 'urdf', 'arm.urdf')\n"
GAZEBO = "os.path.join(get_package_share_directory('ros_gz_sim'), 'launch', 'gz_sim.launch.py')"
INCLUDE = "IncludeLaunchDescription(PythonLaunchDescriptionSource({}))\n"
CREATE = "Node(package='ros_gz_sim', executable='create', arguments=['-topic', 'robot_description'])\n"
WHOLE = FILES + INCLUDE.format(GAZEBO) + CREATE


def find_path(folder: Path, launch: str, mesh: str = MESH, export: str = "", **files: str) -> list[Finding]:
    texts = {
        "package.xml": MANIFEST.format(export),
        "urdf/arm.urdf": MODEL.format(mesh),
        "launch/sim.launch.py": launch,
    }
    return find(folder / "arm", texts | files, "GZB007", name="launch/sim.launch.py")


@pytest.mark.parametrize(
    ("launch", "count"),
    [
        (WHOLE, 1),
        (WHOLE.replace("ros_gz_sim", "gazebo_ros").replace("gz_sim", "gazebo").replace("create", "spawn_entity.py"), 1),
        (FILES + CREATE, 0),  # Gazebo is started elsewhere
        (FILES + INCLUDE.format(GAZEBO), 0),
        (WHOLE + "AppendEnvironmentVariable('GZ_SIM_RESOURCE_PATH', share)\n", 0),
        (WHOLE + "os.environ['GAZEBO_MODEL_PATH'] = share\n", 0),
        (WHOLE + "text = text.replace('package://', share)\n", 0),
        (WHOLE + INCLUDE.format("os.path.join(get_package_share_directory('arm'), 'launch', 'world.launch.py')"), 0),
    ],
)
def test_a_launch_file_that_starts_gazebo_and_spawns(tmp_path: Path, launch: str, count: int) -> None:
    assert len(find_path(tmp_path, launch)) == count


def test_what_leads_to_the_meshes(tmp_path: Path) -> None:
    assert not find_path(tmp_path / "file", WHOLE, mesh="file:///tmp/base.stl")
    assert not find_path(tmp_path / "unknown", WHOLE, mesh="package://other/base.stl")
    export = '<export><gazebo_ros gazebo_model_path="${prefix}/.."/></export>'
    assert not find_path(tmp_path / "export", WHOLE, export=export)
    hook = {"env-hooks/arm.dsv.in": "prepend-non-duplicate;GZ_SIM_RESOURCE_PATH;share\n"}
    assert not find_path(tmp_path / "hook", WHOLE, **hook)
    (finding,) = find_path(tmp_path / "bad", WHOLE)
    assert "${prefix}/.." in (finding.fix.title if finding.fix is not None else "")
