"""CTL004: interfaces of gpios that a controller claims."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import find, joint, limit, link, robot

PACKAGE = '<package format="3"><name>cell</name><version>1.0.0</version></package>'
ARM = link("base"), link("arm"), joint("swing", "base", "arm", limit(-1, 1), kind="revolute", axis="0 0 1")
BLOCK = (
    '<ros2_control name="cell" type="system"><joint name="swing"><command_interface name="position"/></joint>'
    '<gpio name="valve"><command_interface name="out.1"/><state_interface name="in.1"/></gpio></ros2_control>'
)
TYPES = """\
controller_manager:
  ros__parameters:
    arm: {type: position_controllers/JointGroupPositionController}
    valves: {type: gpio_controllers/GpioCommandController}
arm: {ros__parameters: {joints: [swing]}}
"""


def list_missing(folder: Path, claims: str, *, block: str = BLOCK, types: str = TYPES) -> list[str]:
    """List what is missing for a file beside the model that no file names."""
    files = {
        "package.xml": PACKAGE,
        "config/controllers.yaml": f"{types}valves: {{ros__parameters: {{{claims}}}}}\n",
        "urdf/robot.urdf": robot(*ARM, block),
    }
    return [f.data["missing"] for f in find(folder, files, "CTL004", name="urdf/robot.urdf")]


@pytest.mark.parametrize(
    ("claims", "missing"),
    [
        ("command_interfaces: {valve: {interfaces: [out.1]}}", []),
        ("command_interfaces: {valve: [out.1]}", []),
        ("command_interfaces: {valve: [{interfaces: [out.1]}]}", []),
        ("command_interfaces: {valve: {interfaces: [out.2]}}", ["valve/out.2 (command)"]),
        ("command_interfaces: {valve: [out.2, out.3]}", ["valve/out.2 (command), valve/out.3 (command)"]),
        ("state_interfaces: {valve: {interfaces: [out.1]}}", ["valve/out.1 (state)"]),
        ("state_interfaces: {valve: {interfaces: [in.1]}}", []),
        ("gpios: [valve]", []),
        ("command_interfaces: [valve]", []),
    ],
)
def test_each_way_to_write_the_claims(tmp_path: Path, claims: str, missing: list[str]) -> None:
    assert list_missing(tmp_path, claims) == missing


def test_a_file_that_nothing_names_may_be_for_other_hardware(tmp_path: Path) -> None:
    other = "command_interfaces: {lamp: [out.1]}"
    assert list_missing(tmp_path / "other", other) == []
    assert list_missing(tmp_path / "none", other, block="") == []
    alone = TYPES.replace("arm: {ros__parameters: {joints: [swing]}}\n", "")
    assert list_missing(tmp_path / "alone", "command_interfaces: {valve: [out.2]}", types=alone) == []


@pytest.mark.parametrize(
    ("launch", "messages"),
    [
        ("Node(package='controller_manager', executable='spawner', arguments=['arm'])", ["gpio-unstarted"]),
        ("Node(package='controller_manager', executable='spawner', arguments=['arm', 'valves'])", ["gpio"]),
        (
            "# valves\nExecuteProcess(cmd=['ros2', 'control', 'load_controller', '--set-state', 'active', 'arm'])",
            ["gpio-unstarted"],
        ),
        ("Node(package='controller_manager', executable='spawner', arguments=[LaunchConfiguration('name')])", ["gpio"]),
        ("Node(package='robot_state_publisher', arguments=['arm'])", ["gpio"]),
    ],
)
def test_what_a_controller_claims_that_is_never_started_is_a_note_on_request(
    tmp_path: Path, launch: str, messages: list[str]
) -> None:
    files = {
        "package.xml": PACKAGE,
        "launch/cell.launch.py": launch,
        "config/controllers.yaml": f"{TYPES}valves: {{ros__parameters: {{command_interfaces: {{valve: [out.2]}}}}}}\n",
        "urdf/robot.urdf": robot(*ARM, BLOCK),
    }
    found = find(tmp_path, files, "CTL004", name="urdf/robot.urdf")
    assert [finding.message_id for finding in found] == messages
