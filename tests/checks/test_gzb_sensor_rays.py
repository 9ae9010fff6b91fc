"""GZB009: what range sensors see of their own robot."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from builders import box, collision, find, joint, limit, link, robot, visual

from urdfcheck.core import Severity
from urdfcheck.model.gazebo import GazeboSensor
from urdfcheck.model.shapes.sensor_rays import SelfScan
from urdfcheck.source.text.xml import Element

TETRAHEDRON = "v 1 0 0\nv 1.2 0.1 0\nv 1.2 -0.1 0\nv 1.1 0 0.3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"


def sensor(kind: str, *, low: float = -1.57, high: float = 1.57, least: float = 0.1, pose: str = "") -> str:
    """Return a block with a sensor of one layer."""
    return (
        f'<gazebo reference="base"><sensor name="scan" type="{kind}">{pose}<ray><scan><horizontal><samples>181</samples>'
        f"<min_angle>{low}</min_angle><max_angle>{high}</max_angle></horizontal></scan>"
        f"<range><min>{least}</min><max>5</max></range></ray></sensor></gazebo>"
    )


def list_seen(folder: Path, *parts: str) -> list[str]:
    return [finding.data["links"] for finding in find(folder, robot(*parts), "GZB009")]


AHEAD = joint("mount", "base", "camera", xyz="0.5 0 0") + link("camera", visual(box("0.1 0.2 0.1")))


def test_rendered_rays_meet_visuals_and_collided_rays_collisions(tmp_path: Path) -> None:
    assert list_seen(tmp_path, link("base"), AHEAD, sensor("gpu_ray")) == ["camera"]
    assert list_seen(tmp_path, link("base"), AHEAD, sensor("ray")) == []
    solid = AHEAD.replace("visual", "collision")
    assert list_seen(tmp_path, link("base"), solid, sensor("ray")) == ["camera"]


@pytest.mark.parametrize(
    "scan",
    [
        sensor("gpu_ray", least=0.7),
        sensor("gpu_ray", low=0.5),
        sensor("gpu_ray", pose="<pose>0 0 0.1 0 0 0</pose>"),
        sensor("gpu_ray", pose="<pose>0 0 0 0 0 3.14159</pose>"),
        sensor("gpu_ray", pose='<pose relative_to="camera">0 0 0 0 0 0</pose>'),
        sensor("camera"),
    ],
)
def test_nothing_is_reported_beside_or_before_the_scan(tmp_path: Path, scan: str) -> None:
    assert list_seen(tmp_path, link("base"), AHEAD, scan) == []


@pytest.mark.parametrize(
    ("frame", "low", "message"),
    [("base", -1.57, "turned"), ("back", -1.57, "sees"), ("elsewhere", -1.57, "sees"), ("base", -3.14, "sees")],
)
def test_a_pose_that_turns_the_scan_off_its_frame_is_the_cause(
    tmp_path: Path, frame: str, low: float, message: str
) -> None:
    """Not where the named frame is turned too or unknown, nor where the turned scan sees the robot anyway."""
    behind = AHEAD.replace("0.5 0 0", "-0.5 0 0") + joint("rear", "base", "back", rpy="0 0 3.14159") + link("back")
    scan = sensor("gpu_ray", low=low, high=-low, pose="<pose>0 0 0 0 0 3.14159</pose>")
    scan = scan.replace(
        "</sensor>", f'<plugin name="p" filename="f"><frame_name>{frame}</frame_name></plugin></sensor>'
    )
    (finding,) = find(tmp_path, robot(link("base"), behind, scan), "GZB009")
    assert finding.message_id == message


CLASSIC = '<gazebo><plugin name="d" filename="libgazebo_ros_diff_drive.so">{}</plugin></gazebo>'


@pytest.mark.parametrize(
    ("more", "pitch", "severity", "effect"),
    [
        ("", 0.0, Severity.WARNING, "obstacle"),
        ("", 1.5708, Severity.WARNING, "in place of the floor"),
        (CLASSIC, 1.5708, Severity.INFO, "no plugin"),
        (CLASSIC.format("<cliff_sensor_name>scan</cliff_sensor_name>"), 1.5708, Severity.WARNING, "floor"),
    ],
)
def test_what_a_scan_of_the_robot_does_depends_on_what_it_is_for(
    tmp_path: Path, more: str, pitch: float, severity: Severity, effect: str
) -> None:
    plate = joint("mount", "base", "plate", xyz=f"{0.5 if pitch == 0 else 0} 0 {0.0 if pitch == 0 else -0.5}")
    scan = sensor("ray", low=-0.1, high=0.1, pose=f"<pose>0 0 0 0 {pitch} 0</pose>")
    parts = (link("base"), plate, link("plate", collision(box("0.1 0.1 0.1"))), scan, more)
    (finding,) = find(tmp_path, robot(*parts), "GZB009")
    assert finding.severity == severity
    assert effect in finding.consequences["gazebo"]


def test_a_scan_may_run_backwards(tmp_path: Path) -> None:
    """From the greater angle to the smaller one, it has all rays between them."""
    shares, sectors = [], []
    for low, high in ((-0.5, 1.57), (1.57, -0.5)):
        (finding,) = find(tmp_path, robot(link("base"), AHEAD, sensor("gpu_ray", low=low, high=high)), "GZB009")
        shares.append(finding.data["share"])
        sectors.append(finding.data["sectors"])
    assert shares[0] == shares[1] < 0.3
    assert sectors[0] == sectors[1]


def test_an_arm_may_be_elsewhere_and_a_wheel_is_where_it_is(tmp_path: Path) -> None:
    arm = AHEAD.replace('type="fixed"', 'type="revolute"').replace("</joint>", f"{limit(-1, 1)}</joint>")
    assert list_seen(tmp_path, link("base"), arm, sensor("gpu_ray")) == []
    wheel = AHEAD.replace('type="fixed"', 'type="continuous"')
    assert list_seen(tmp_path, link("base"), wheel, sensor("gpu_ray")) == ["camera"]


@pytest.mark.parametrize("kind", ["continuous", "revolute"])
def test_all_of_a_rocker_that_carries_wheels_is_seen(tmp_path: Path, kind: str) -> None:
    limits, turn = (limit(-1, 1) if kind == "revolute" else ""), '<axis xyz="0 1 0"/>'
    rocker = joint("rock", "base", "rocker", limits, turn, kind=kind, xyz="0.5 0 0") + link(
        "rocker", visual(box("0.1 0.2 0.1"))
    )
    rim = link("wheel", visual('<cylinder radius="0.2" length="0.1"/>', rpy="1.5708 0 0"))
    wheel = joint("roll", "rocker", "wheel", turn, kind="continuous", xyz="0.1 0.6 0") + rim
    arm = joint("roll", "rocker", "wheel", limit(-1, 1), turn, kind="revolute", xyz="0.1 0.6 0") + rim
    assert list_seen(tmp_path, link("base"), rocker, wheel, sensor("gpu_ray")) == ["rocker, wheel"]
    assert list_seen(tmp_path, link("base"), rocker, arm, sensor("gpu_ray")) == (
        ["rocker"] if kind == "continuous" else []
    )


def test_a_housing_and_a_mesh(tmp_path: Path) -> None:
    (tmp_path / "nose.obj").write_text(TETRAHEDRON, encoding="utf-8")
    housing = link("base", visual(box("0.3 0.3 0.3")), collision(box("0.3 0.3 0.3")))
    assert list_seen(tmp_path, housing, sensor("gpu_ray")) == []
    nose = joint("mount", "base", "nose", xyz="0 0 -0.1") + link("nose", visual('<mesh filename="nose.obj"/>'))
    assert list_seen(tmp_path, housing, nose, sensor("gpu_ray")) == ["nose"]


@pytest.mark.parametrize("shape", [box("0.6 0.6 0.6"), '<sphere radius="0.3"/>', '<cylinder radius="0.3" length="1"/>'])
def test_collided_rays_end_at_the_far_side_of_what_holds_the_sensor(tmp_path: Path, shape: str) -> None:
    (finding,) = find(tmp_path, robot(link("base", collision(shape)), sensor("ray")), "GZB009")
    assert (finding.message_id, finding.data["share"], finding.data["nearest"]) == ("inside", 1.0, "300 mm")
    assert not find(tmp_path, robot(link("base", visual(shape)), sensor("gpu_ray")), "GZB009")
    assert not find(tmp_path, robot(link("base", collision(shape)), sensor("ray", least=0.5)), "GZB009")


@pytest.mark.parametrize(("height", "seen"), [(0.0499, ["camera"]), (0.04999, []), (0.0499999, []), (0.05, [])])
def test_rays_in_the_plane_of_a_face_show_nothing(tmp_path: Path, height: float, seen: list[str]) -> None:
    """The box ends at 0.05 m: rays just below that end at it in theory."""
    scan = sensor("gpu_ray", pose=f"<pose>0 0 {height - 1e-6} 0 0 0</pose>")
    assert list_seen(tmp_path, link("base"), AHEAD, scan) == seen


def test_a_graze_is_not_enough(tmp_path: Path) -> None:
    rod = joint("mount", "base", "rod", xyz="2 0 0") + link("rod", visual(box("0.01 0.01 1")))
    assert list_seen(tmp_path, link("base"), rod, sensor("gpu_ray")) == []


@pytest.mark.parametrize(
    ("blocked", "sectors"),
    [
        ("11111", ["0° to 1°"]),
        ("11011", ["0° to 1°"]),
        ("10001", ["0° to 0°", "1° to 1°"]),
    ],
)
def test_a_ray_between_two_sectors_does_not_part_them(blocked: str, sectors: list[str]) -> None:
    distances = np.array([[1.0 if ray == "1" else np.inf for ray in blocked]])
    parsed = GazeboSensor(Element("sensor", None), "base")
    scan = SelfScan(
        sensor=parsed, least=0.1, azimuths=np.radians([0, 0.2, 0.3, 0.45, 0.9]), distances=distances, seen=()
    )
    assert scan.describe_sectors() == sectors
