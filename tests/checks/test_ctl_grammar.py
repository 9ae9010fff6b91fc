"""CTL005 and CTL006: what the parser of ros2_control refuses, and values that do not fit."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import find, link, robot
from conftest import command

from urdfcheck.core import Finding, Severity

ROBOT = (
    '<robot name="r"><link name="base"/><link name="arm"/><link name="end"/>'
    '<joint name="a" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>'
    '<limit lower="-1.6" upper="1.6" effort="1" velocity="1"/></joint>'
    '<joint name="m" type="revolute"><parent link="arm"/><child link="end"/><axis xyz="0 0 1"/>'
    '<limit lower="-1.6" upper="1.6" effort="1" velocity="1"/><mimic joint="a"/></joint>{}</robot>'
)
HARDWARE = "<hardware><plugin>mock_components/GenericSystem</plugin></hardware>"
STATE = '<state_interface name="position"/>'


def block(inner: str, attributes: str = 'name="c" type="system"') -> str:
    return f"<ros2_control {attributes}>{inner}</ros2_control>"


def find_errors(folder: Path, control: str) -> list[Finding]:
    return find(folder, ROBOT.format(control), "CTL005")


@pytest.mark.parametrize(
    ("control", "messages"),
    [
        (block(HARDWARE + f'<joint name="a">{STATE}</joint>'), []),
        (block(HARDWARE + "<properties/><gpio name='g'/><sensor name='s'/>"), []),
        (block(HARDWARE, 'type="system"'), ["attribute"]),
        (block(HARDWARE, 'name="c"'), ["attribute"]),
        (block(HARDWARE, 'name="c" type="robot"'), ["type"]),
        (block(""), ["hardware"]),
        (block("<hardware/>"), ["plugin"]),
        (block("<hardware><plugin> </plugin></hardware>"), ["plugin-empty"]),
        (block("<hardware><plugin name='p'><parameters>a.yaml</parameters></plugin></hardware>"), ["plugin-empty"]),
        (block(HARDWARE + "<jiont/>"), ["tag"]),
        (block(HARDWARE + "<joint/>"), ["attribute"]),
        (block(HARDWARE + "<gpio><command_interface name='x'/></gpio>"), ["attribute"]),
        (block(HARDWARE + "<sensor name='s'><state_interface/></sensor>"), ["attribute"]),
        (block(HARDWARE.replace("</hardware>", "<param>1</param></hardware>")), ["attribute"]),
        (block(HARDWARE) + block(HARDWARE), ["duplicate"]),
        (block(HARDWARE) + block(HARDWARE, 'name="d" type="sensor"'), []),
        (block(HARDWARE + f'<joint name="a">{STATE}</joint>' * 2), ["twice"]),
        (block(HARDWARE + f'<joint name="a">{STATE}</joint><gpio name="a">{STATE}</gpio>'), ["kinds"]),
        (block(HARDWARE + f'<joint name="a">{STATE}</joint><sensor name="a"/>'), []),
        (block(HARDWARE + '<joint name="a" mimic="true"/>'), ["mimic"]),
        (block(HARDWARE + '<joint name="a" mimic="false"/>'), []),
        (block(HARDWARE + '<joint name="m"/>'), ["leader"]),
        (block(HARDWARE + '<joint name="m" mimic="false"/>'), []),
        (block(HARDWARE + '<joint name="a"/><joint name="m"/>'), []),
        (block(HARDWARE + '<transmission name="t"/>'), ["plugin"]),
        (
            block(HARDWARE + '<transmission name="t"><plugin>x/Y</plugin><joint name="a"/></transmission>'),
            ["attribute"],
        ),
        ('<transmission name="outside"/>', []),
    ],
)
def test_what_the_parser_refuses(tmp_path: Path, control: str, messages: list[str]) -> None:
    findings = find_errors(tmp_path, control)
    assert [f.message_id for f in findings] == messages
    assert all((f.severity is Severity.ERROR) == (f.message_id not in {"leader", "kinds"}) for f in findings)


@pytest.mark.parametrize("plugin", ["gazebo_ros2_control/GazeboSystem", "gz_ros2_control/GazeboSimSystem"])
def test_gazebo_activates_one_of_two_blocks_of_a_name(tmp_path: Path, plugin: str) -> None:
    control = block(f"<hardware><plugin>{plugin}</plugin></hardware>")
    (finding,) = find_errors(tmp_path, control + control)
    assert "activates only the first" in finding.message
    assert "stops loading" not in finding.message
    assert finding.consequences["gazebo"].startswith("activates only the first")
    (other,) = find_errors(tmp_path, control + block(HARDWARE))  # the second is of a driver
    assert "stops loading" in other.message


def test_an_ignored_block_repeats_no_name(tmp_path: Path) -> None:
    ignored = block("", 'name="c" type="fake_components/GenericSystem"')
    assert {f.message_id for f in find_errors(tmp_path, ignored + ignored)} == {"type"}
    assert [f.message_id for f in find_errors(tmp_path, ignored + block(HARDWARE))] == ["type"]


@pytest.mark.parametrize("plugin", ["gazebo_ros2_control/GazeboSystem", "gz_ros2_control/GazeboSimSystem"])
def test_gazebo_loads_a_block_whatever_its_type_is(tmp_path: Path, plugin: str) -> None:
    control = block(f"<hardware><plugin>{plugin}</plugin></hardware>", 'name="c" type="System"')
    (finding,) = find_errors(tmp_path, control)
    assert (finding.message_id, finding.severity) == ("type-simulated", Severity.INFO)


def test_hardware_that_the_arguments_leave_out_is_a_warning(tmp_path: Path) -> None:
    choice = f"""<xacro:arg name="mode" default="true"/><xacro:if value="${{'$(arg mode)' == 'mock'}}">{HARDWARE}</xacro:if>"""
    text = ROBOT.format(block(choice)).replace("<robot ", '<robot xmlns:xacro="http://ros.org/wiki/xacro" ')
    (finding,) = find(tmp_path, text, "CTL005", name="r.urdf.xacro")
    assert (finding.message_id, finding.severity) == ("hardware", Severity.WARNING)
    assert "with these arguments" in finding.message


def command_interface(name: str, *params: tuple[str, str], tag: str = "command_interface") -> str:
    inner = "".join(f'<param name="{key}">{value}</param>' for key, value in params)
    return f'<{tag} name="{name}">{inner}</{tag}>'


@pytest.mark.parametrize(
    ("typed", "repair"),
    [
        ("{-2*pi}", "write `${-2*pi}`, with the dollar sign before the braces"),
        ("-{pi /2}", "write `${-(pi /2)}`, with the dollar sign before the braces"),
        ("much", "write a number"),
    ],
)
def test_an_expression_without_its_dollar_sign_gets_it(tmp_path: Path, typed: str, repair: str) -> None:
    control = block(HARDWARE + f'<joint name="a">{command_interface("position", ("min", typed))}</joint>')
    text = ROBOT.format(control).replace("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ')
    (finding,) = find(tmp_path, text, "CTL006", name="r.urdf.xacro")
    assert finding.message.endswith("ros2_control ignores the limit")
    assert finding.fix is not None
    assert finding.fix.title == repair


@pytest.mark.parametrize(
    ("interface", "messages"),
    [
        (command_interface("position", ("min", "-1"), ("max", "1")), []),
        (command_interface("postion"), ["name"]),
        (command_interface("Velocity"), ["name"]),
        (command_interface("kp"), []),
        (command_interface("commanded_position"), []),
        (command_interface("external_effort"), []),
        (command_interface("position.x"), []),
        (command_interface("velocity", ("min", "1"), ("max", "-1")), ["inverted"]),
        (command_interface("effort", ("max", "much")), ["number"]),
        (command_interface("effort", ("max", "")), []),
        (command_interface("position", ("min", "-3"), ("max", "3")), ["loose", "loose"]),
        (command_interface("position", ("min", "-3"), ("max", "3"), tag="state_interface"), []),
        (command_interface("position", ("min", "2")), ["empty"]),
        (command_interface("position", ("initial_value", "1.605")), []),
        (command_interface("position", ("initial_value", "2")), ["start"]),
        (command_interface("velocity", ("initial_value", "2")), []),
    ],
)
def test_interfaces_and_values(tmp_path: Path, interface: str, messages: list[str]) -> None:
    findings = find(tmp_path, ROBOT.format(block(f'{HARDWARE}<joint name="a">{interface}</joint>')), "CTL006")
    assert [f.message_id for f in findings] == messages


@pytest.mark.parametrize(("value", "hint"), [("45", True), ("2", False)])
def test_degrees_are_recognised(tmp_path: Path, value: str, hint: bool) -> None:
    """Any small number fits as degrees."""
    interface = command_interface("position", ("initial_value", value))
    (finding,) = find(tmp_path, ROBOT.format(block(f'{HARDWARE}<joint name="a">{interface}</joint>')), "CTL006")
    assert ("as degrees it is 0.785 rad" in finding.message) is hint
    assert ("degrees" in finding.message) is hint


@pytest.mark.usefixtures("one_process")
def test_a_misspelled_interface_is_repaired(tmp_path: Path) -> None:
    path = tmp_path / "r.urdf"
    path.write_text(
        ROBOT.format(block(f'{HARDWARE}<joint name="a">{command_interface("Position")}</joint>')), encoding="utf-8"
    )
    command("check", str(path), "--fix", "--unsafe-fixes", "--select", "CTL006")
    assert '<command_interface name="position">' in path.read_text(encoding="utf-8")


BATTERY = '<sensor name="battery"><state_interface name="voltage"/></sensor>'
OTHER = block(HARDWARE, 'name="other" type="system"')
DRIVE = block("<hardware><plugin>p/Drive</plugin></hardware>", 'name="drive" type="system"')


@pytest.mark.parametrize(
    ("inner", "kind", "others", "repair"),
    [
        (BATTERY, "p/Drive", DRIVE, "delete the block, or move sensor[battery] into ros2_control drive, whose <hardware>"),
        (BATTERY, "p/Drive", OTHER + DRIVE, "delete the block, or move sensor[battery] into ros2_control drive"),
        (BATTERY, "p/Drive", DRIVE.replace("</ros2", BATTERY + "</ros2"), "delete the block: ros2_control drive has its own"),
        (BATTERY, "p/Drive", "", "write system, sensor or actuator, and add `<hardware><plugin>p/Drive</plugin>"),
        ("", "p/Drive", DRIVE, "delete the block: nothing is in it"),
        (BATTERY, "System", DRIVE, "write system, sensor or actuator, and add `<hardware><plugin>package/Class"),
        (HARDWARE + BATTERY, "p/Drive", DRIVE, "write system, sensor or actuator"),
    ],
)  # fmt: skip
def test_a_block_of_another_type_needs_a_class_under_each_type(
    tmp_path: Path, inner: str, kind: str, others: str, repair: str
) -> None:
    """With a valid type the resource manager fails to load a block without a class: its content belongs elsewhere."""
    (finding,) = find_errors(tmp_path, block(inner, f'name="power" type="{kind}"') + others)
    assert finding.message_id == "type"
    assert finding.fix is not None
    assert finding.fix.title.startswith(repair)
    assert "joint" not in finding.consequences["gazebo"]


def test_the_joints_of_a_block_of_another_type_have_no_controllers(tmp_path: Path) -> None:
    (finding,) = find_errors(tmp_path, block(HARDWARE + f'<joint name="a">{STATE}</joint>', 'name="c" type="arm"'))
    assert finding.consequences["gazebo"] == "the joints of the block have no controllers"


def test_a_hardware_under_a_condition_is_the_class_of_a_block_of_another_type(tmp_path: Path) -> None:
    inner = f'<xacro:if value="0">{HARDWARE}</xacro:if>{BATTERY}'
    text = robot(link("base"), block(inner, 'name="power" type="Sensors"'), DRIVE, xacro=True)
    (finding,) = find(tmp_path, text, "CTL005", name="r.urdf.xacro")
    assert finding.fix is not None
    assert finding.fix.title == "write system, sensor or actuator"


@pytest.mark.parametrize(
    ("plugin", "says"),
    [
        ("<plugin/>", "is empty"),
        ("<plugin><parameters>a.yaml</parameters></plugin>", "has no text"),
        ("<plugin filename='liba.so'/>", "has no text"),
    ],
)
def test_a_plugin_with_parts_but_no_text_is_not_empty(tmp_path: Path, plugin: str, says: str) -> None:
    (finding,) = find_errors(tmp_path, block(f"<hardware>{plugin}</hardware>"))
    assert f"of c {says}, so" in finding.message
