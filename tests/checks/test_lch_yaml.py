"""LCH008: what ROS 2 reads as yaml."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
import yaml
from builders import find
from conftest import check, command

from urdfcheck.core import Applicability, Finding
from urdfcheck.source.text.yaml.parameter_text import explain_failure, find_yaml_mark

HEAD = """import os
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import Command, LaunchConfiguration
from launch_ros.actions import Node  # a node
from launch_ros.substitutions import FindPackageShare
path = [FindPackageShare("car"), "/urdf/car.urdf.xacro"]
text = Command(["xacro ", *path])
text = None
"""
PATH = 'FindPackageShare("car"), "/urdf/car.urdf.xacro"'
COMMAND = f'Command(["xacro ", {PATH}, " sim:=true"])'
NODE = "Node(package='robot_state_publisher', executable='robot_state_publisher', parameters=[{}])\n"
MODEL = '<robot name="car" xmlns:xacro="http://ros.org/wiki/xacro">{}<link name="base"/></robot>'
TRAP = MODEL.format("<!-- note: heavy -->")


def find_in_python(folder: Path, body: str, model: str = TRAP, name: str = "car.urdf.xacro") -> list[Finding]:
    files = {
        "package.xml": "<package format='3'><name>car</name></package>",
        f"urdf/{name}": model,
        "launch/car.launch.py": HEAD + body,
    }
    return find(folder / "car", files, "LCH008", name="launch/car.launch.py")


def give(value: str) -> str:
    return NODE.format("{'robot_description': " + value + "}")


@pytest.mark.parametrize(
    "body",
    [
        give(COMMAND),
        give(f"[{COMMAND}]"),
        f"content = {COMMAND}\n" + give("content"),
        f"content = {COMMAND}\ndescription = {{'robot_description': content}}\n" + NODE.format("description, {'a': 1}"),
        "from launch_ros.parameter_descriptions import ParameterValue\n" + give(f"ParameterValue({COMMAND})"),
        give(f"Command(['cat ', {PATH}])"),
        give(f"Command([\n    'xacro ',\n    {PATH},\n])"),
        f"share = FindPackageShare('car')\ngiven = [{give(COMMAND).strip()}]\n",
    ],
)
@pytest.mark.usefixtures("one_process")
def test_a_command_without_a_type_is_reported_and_repaired(tmp_path: Path, body: str) -> None:
    (finding,) = find_in_python(tmp_path, body)
    assert finding.message_id == "passed"
    assert "note: heavy" in finding.message
    assert finding.fix is not None
    assert finding.fix.applicability is Applicability.SAFE
    command("check", str(tmp_path / "car" / "launch" / "car.launch.py"), "--fix", "--select", "LCH008")
    path = tmp_path / "car" / "launch" / "car.launch.py"
    mended = path.read_text(encoding="utf-8")
    ast.parse(mended)
    assert mended.count("from launch_ros.parameter_descriptions import ParameterValue\n") == 1
    assert mended.count("value_type=str") == 1
    assert not [f for f in check(path, codes={"LCH008"}).findings if f.message_id == "passed"]


@pytest.mark.parametrize(
    "body",
    [
        give(f"ParameterValue({COMMAND}, value_type=str)"),
        give(f"{COMMAND}.perform(context)"),
        give("open('car.urdf').read()"),
        give(f"xacro.process_file(os.path.join({PATH})).toxml()"),
        give(f"['a', {COMMAND}]"),
        give("text"),
        "description = {'robot_description': " + COMMAND + "}\n",
        "Node(arguments=['-string', " + COMMAND + "])\n",
        give('Command(["xacro ", FindPackageShare("car"), "/urdf/other.urdf.xacro"])'),
        give(f'Command(["generate ", {PATH}])'),
        "def f(robot_description):\n    return " + give("robot_description"),
    ],
)
def test_what_is_not_certainly_the_text_of_this_model_is_left_alone(tmp_path: Path, body: str) -> None:
    assert not [f for f in find_in_python(tmp_path, body) if f.message_id == "passed"]


def test_the_file_that_the_build_installs_there(tmp_path: Path) -> None:
    files = {
        "package.xml": "<package format='3'><name>car</name><export><build_type>ament_cmake</build_type></export></package>",
        "CMakeLists.txt": "install(DIRECTORY description/urdf DESTINATION share/${PROJECT_NAME})\n",
        "description/urdf/car.urdf.xacro": TRAP,
        "launch/car.launch.py": HEAD + give(COMMAND),
    }
    found = find(tmp_path / "car", files, "LCH008", name="launch/car.launch.py")
    assert [f.message_id for f in found] == ["passed"]


def test_no_edit_where_the_import_has_no_line_of_its_own(tmp_path: Path) -> None:
    files = {
        "package.xml": "<package format='3'><name>car</name></package>",
        "urdf/car.urdf.xacro": TRAP,
        "launch/car.launch.py": HEAD.replace("FindPackageShare\n", "FindPackageShare; import re\n").replace(
            "import Node  # a node", "import Node; import sys"
        )
        + give(COMMAND),
    }
    (finding,) = find(tmp_path / "car", files, "LCH008", name="launch/car.launch.py")
    assert finding.fix is not None
    assert not finding.fix.edits


@pytest.mark.usefixtures("one_process")
@pytest.mark.parametrize(
    ("param", "is_reported"),
    [
        ("""value="$(command 'xacro $(find-pkg-share car)/urdf/car.urdf.xacro')\"""", True),
        ("""value="$(command 'xacro $(find-pkg-share car)/urdf/car.urdf.xacro')" type="str\"""", False),
        ("""value="$(command 'xacro $(find-pkg-share car)/urdf/other.urdf.xacro')\"""", False),
    ],
)
def test_an_xml_launch_file(tmp_path: Path, param: str, is_reported: bool) -> None:
    node = f'<node pkg="robot_state_publisher" exec="x"><param name="robot_description" {param}/></node>'
    files = {
        "package.xml": "<package format='3'><name>car</name></package>",
        "urdf/car.urdf.xacro": TRAP,
        "launch/car.launch.xml": f"<launch>{node}</launch>",
    }
    found = find(tmp_path / "car", files, "LCH008", name="launch/car.launch.xml")
    assert [f.message_id for f in found if f.message_id == "passed"] == ["passed"] * is_reported
    if is_reported:
        path = tmp_path / "car" / "launch" / "car.launch.xml"
        command("check", str(path), "--fix", "--select", "LCH008")
        assert """xacro')" type="str"/>""" in path.read_text(encoding="utf-8")


# Blanks, marks of yaml and what they are in a model.
TEXTS = [
    '<robot name="a"/>',
    '<?xml version="1.0" ?>\n<robot name="a">\n  <link name="b"/>\n</robot>\n',
    '<robot name="a">\n  <!-- {x}, [y], & * ! | > %% @ ` "quoted" -->\n</robot>',
    '<robot name="a">\n  <!-- package://x:y 12:30 a:b -->\n</robot>',
    '<robot name="a">\n  <!-- note: x -->\n</robot>',
    '<robot name="a">\n  <!-- note:\n x -->\n</robot>',
    '<robot name="a: b"/>',
    '<robot name="a">\n\t<link name="b"/>\n</robot>',
    '<robot name="a">\n  <!-- a#1 -->\n</robot>',
    '<robot name="a">\n  <!-- a #1 -->\n</robot>',
    '<robot name="a">\n# </robot>',
    '<robot name="a">\n<!--\n---\n-->\n</robot>',
    '<robot name="a">\n<!--\n-----\n-->\n</robot>',
    '<robot name="a">\n<!-- Grad ° Ω \U0001f916 -->\n</robot>',
    '<robot name="a">\r\n  <link name="b"/>\r\n</robot>\r\n',
    '<robot name="a"><!-- \x7f --></robot>',
]


@pytest.mark.parametrize("text", TEXTS)
def test_a_text_has_a_mark_if_pyyaml_does_not_load_the_same_text(text: str) -> None:
    try:
        loaded = yaml.safe_load(text)
    except yaml.YAMLError:
        loaded = None
    is_same = isinstance(loaded, str) and loaded.split() == text.split()
    mark = find_yaml_mark(text)
    assert (mark is None) is is_same
    assert mark is None or explain_failure(text, mark) is not None


def test_xacro_writes_blanks_anew_but_keeps_comments(tmp_path: Path) -> None:
    tabs = MODEL.format("\n\t\n\t")
    assert not [f for f in find_in_python(tmp_path / "a", give(COMMAND), tabs) if f.message_id == "passed"]
    shown = find_in_python(tmp_path / "b", give(f"Command(['cat ', {PATH}])"), tabs)
    assert ["a tab" in f.message for f in shown] == [True]
    plain = '<robot name="car">\n\t<link name="base"/>\n</robot>'
    path = PATH.replace(".xacro", "")
    given = find_in_python(tmp_path / "c", give(f"Command(['xacro ', {path}])"), plain, name="car.urdf")
    assert not [f for f in given if f.message_id == "passed"]
    given = find_in_python(tmp_path / "d", give(f"Command(['cat ', {path}])"), plain, name="car.urdf")
    assert [f.message_id for f in given] == ["passed"]
