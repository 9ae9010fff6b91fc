"""GZB006: sensors without a frame."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import find

from urdfcheck.core import Finding, Severity

NEW = '<gazebo><plugin filename="gz_ros2_control-system" name="s"/></gazebo>'
WITHOUT_ROS = '<gazebo><plugin filename="gz-sim-sensors-system" name="s"/></gazebo>'
CLASSIC = '<gazebo><plugin filename="libgazebo_ros_control.so" name="s"/></gazebo>'
ROBOT = '<robot name="r"><link name="base"/><gazebo reference="base">{}</gazebo>{}</robot>'


def sensor(kind: str = "gpu_lidar", inner: str = "", name: str = "scan") -> str:
    return f'<sensor name="{name}" type="{kind}">{inner}</sensor>'


def find_frames(folder: Path, inner: str, plugin: str = NEW, **files: str) -> list[Finding]:
    texts = {f"launch/{name}.launch.py": text for name, text in files.items()}
    model = {"package.xml": "<package format='3'><name>r</name></package>", "urdf/r.urdf": ROBOT.format(inner, plugin)}
    return find(folder / "r", model | texts, "GZB006", name="urdf/r.urdf")


@pytest.mark.parametrize(
    ("inner", "plugin", "count"),
    [
        (sensor(), NEW, 1),
        (sensor("camera") + sensor("imu", name="imu"), NEW, 2),
        (sensor("ray"), NEW, 0),
        (sensor("contact"), NEW, 0),
        (sensor("altimeter"), NEW, 0),
        (sensor(), CLASSIC, 0),
        (sensor(), "", 0),
        (sensor(), WITHOUT_ROS, 0),
        (sensor(inner='<plugin filename="gz-sim-yarp-imu-system" name="y"/>'), NEW, 0),
        (sensor(inner="<gz_frame_id>base</gz_frame_id>"), NEW, 0),
        (sensor(inner="<ignition_frame_id>base</ignition_frame_id>"), NEW, 0),
        (sensor(inner="<gz_frame_id> </gz_frame_id>"), NEW, 1),
        (sensor("camera", "<camera><optical_frame_id>base</optical_frame_id></camera>"), NEW, 0),
    ],
)
def test_data_without_a_frame_of_the_robot(tmp_path: Path, inner: str, plugin: str, count: int) -> None:
    findings = find_frames(tmp_path, inner, plugin)
    assert [f.data["count"] for f in findings] == [count] * bool(count)


@pytest.mark.parametrize(("kind", "frame"), [("camera", "eye_optical"), ("gpu_lidar", "base")])
def test_a_camera_has_its_pictures_in_the_optical_frame(tmp_path: Path, kind: str, frame: str) -> None:
    optical = '<link name="eye_optical"/><joint name="o" type="fixed"><parent link="base"/><child link="eye_optical"/></joint>'
    (finding,) = find_frames(tmp_path, sensor(kind), NEW + optical)
    assert finding.fix is not None
    assert f"<gz_frame_id>{frame}</gz_frame_id>" in finding.fix.title


def test_each_sensor_is_told_its_own_frame(tmp_path: Path) -> None:
    inner = sensor() + '</gazebo><gazebo reference="top">' + sensor("imu", name="imu")
    top = '<link name="top"/><joint name="j" type="fixed"><parent link="base"/><child link="top"/></joint>'
    (finding,) = find_frames(tmp_path, inner, NEW + top)
    assert finding.fix is not None
    assert "into each: base into scan, top into imu (" in finding.fix.title


def test_a_broadcaster_of_ros2_control_names_the_frame(tmp_path: Path) -> None:
    control = '<ros2_control name="c" type="system"><sensor name="{}"/></ros2_control>'
    assert not find_frames(tmp_path / "a", sensor("imu"), NEW + control.format("scan"))
    assert find_frames(tmp_path / "b", sensor("imu"), NEW + control.format("other"))


def test_a_bridge_hands_the_data_to_ros(tmp_path: Path) -> None:
    assert find_frames(
        tmp_path, sensor(), WITHOUT_ROS, go="Node(package='ros_gz_bridge', executable='parameter_bridge')"
    )


def test_a_transform_may_supply_the_frame(tmp_path: Path) -> None:
    transform = "Node(executable='static_transform_publisher', arguments=['--child-frame-id', 'r/base/scan'])"
    assert not find_frames(tmp_path / "a", sensor(), go=transform)
    assert find_frames(tmp_path / "b", sensor(), go=transform.replace("scan", "imu"))


@pytest.mark.parametrize(
    ("kind", "bridge", "severity", "effect"),
    [
        ("gpu_lidar", "'/scan@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan'", Severity.WARNING, "drops the data"),
        ("gpu_lidar", "'/odom@nav_msgs/msg/Odometry[gz.msgs.Odometry'", Severity.INFO, "gets no data"),
        ("camera", "package='ros_gz_image', executable='image_bridge', arguments=['scan']", Severity.INFO, "pictures"),
        (
            "camera",
            "'/scan@sensor_msgs/msg/Image[gz.msgs.Image', '/scan/camera_info@…[gz.msgs.CameraInfo'",
            Severity.WARNING,
            "drops the data",
        ),
    ],
)
def test_only_data_that_a_bridge_hands_on_and_programs_place_needs_a_frame(
    tmp_path: Path, kind: str, bridge: str, severity: Severity, effect: str
) -> None:
    (finding,) = find_frames(tmp_path, sensor(kind), go=f"Node({bridge}) # ros_gz")
    assert finding.severity is severity
    assert effect in finding.consequences["rviz"]


def test_the_frame_begins_with_the_name_that_the_robot_is_spawned_with(tmp_path: Path) -> None:
    (finding,) = find_frames(tmp_path, sensor(), go="Node(executable='create', arguments=['-name', 'rover'])")
    assert "such as rover/base/scan" in finding.message


@pytest.mark.parametrize(
    ("build", "tag", "message"),
    [
        ("ament_python", "frameName", "frame-ignored"),
        ("ament_python", "frame_name", "frame"),
        ("catkin", "frameName", "frame"),
    ],
)
def test_the_tag_of_ros_1_is_not_read_in_ros_2(tmp_path: Path, build: str, tag: str, message: str) -> None:
    plugin = f'<plugin name="i" filename="libgazebo_ros_imu_sensor.so"><{tag}>base_link</{tag}></plugin>'
    manifest = f'<package format="3"><name>r</name><export><build_type>{build}</build_type></export></package>'
    model = {"package.xml": manifest, "urdf/r.urdf": ROBOT.format(sensor("imu", plugin), "")}
    (finding,) = find(tmp_path / "r", model, "GZB004", name="urdf/r.urdf")
    assert finding.message_id == message
