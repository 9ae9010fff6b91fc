"""LCH009: encodings that a model declares."""

from __future__ import annotations

from pathlib import Path

import pytest
from builders import find
from conftest import command
from lxml import etree

from urdfcheck.core import Finding, Severity

HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'
ROBOT = '<robot name="car"><link name="base"/></robot>'
SPAWN = "Node(package='gazebo_ros', executable='spawn_entity.py', arguments=[{}])"
RAW = "text = open('urdf/car.urdf').read()\n"
RSP = "Node(package='robot_state_publisher', parameters=[{'robot_description': text}])\n"


def find_in_package(folder: Path, launch: str, head: str = HEAD, encoding: str = "utf-8") -> list[Finding]:
    path = folder / "car" / "urdf" / "car.urdf"
    path.parent.mkdir(parents=True)
    path.write_bytes((head + ROBOT).encode(encoding))
    files = {"package.xml": "<package format='3'><name>car</name></package>", "launch/car.launch.py": launch}
    return [f for f in find(folder / "car", files, "LCH009", name="launch/car.launch.py") if f.message_id == "spawned"]


@pytest.mark.parametrize(
    ("launch", "is_reported"),
    [
        (RAW + RSP + SPAWN.format("'-topic', 'robot_description', '-entity', 'car'"), True),
        (RAW + RSP + SPAWN.format("'-topic', '/robot_description', '-entity', 'car'"), True),
        (RAW + SPAWN.format("'-file', join(get_package_share_directory('car'), 'urdf/car.urdf')"), True),
        (RAW + SPAWN.format("'-file', 'urdf/other.urdf'"), False),
        (RAW + SPAWN.format("'-database', 'car'"), False),
        (RAW + "Node(package='ros_gz_sim', executable='create', arguments=['-topic', 'robot_description'])", False),
        ("text = xacro.process_file('urdf/car.urdf')\n" + SPAWN.format("'-topic', 'robot_description'"), False),
        (RAW + RSP, False),
    ],
)
def test_the_spawner_gets_the_text_of_the_file(tmp_path: Path, launch: str, is_reported: bool) -> None:
    findings = find_in_package(tmp_path, launch)
    assert [f.severity for f in findings] == [Severity.ERROR] * is_reported


@pytest.mark.usefixtures("one_process")
@pytest.mark.parametrize(
    ("head", "is_refused"),
    [
        (HEAD, True),
        ("<?xml version='1.0' encoding='utf-8' standalone='yes'?>\n", True),
        ('<?xml version="1.0" ?>\n', False),
        ('<?xml version="1.0"?><!-- encoding="utf-8" -->\n', False),
        ('<!-- <?xml encoding="utf-8"?> -->', False),
        ("", False),
    ],
)
def test_what_is_reported_is_what_lxml_refuses(tmp_path: Path, head: str, is_refused: bool) -> None:
    launch = RAW + RSP + SPAWN.format("'-topic', 'robot_description'")
    assert len(find_in_package(tmp_path, launch, head)) == is_refused
    if is_refused:
        with pytest.raises(ValueError, match="encoding declaration"):
            etree.fromstring(head + ROBOT)
        command("check", str(tmp_path / "car"), "--fix", "--select", "LCH009")
    etree.fromstring((tmp_path / "car" / "urdf" / "car.urdf").read_text(encoding="utf-8"))


def test_no_edit_where_the_file_is_not_utf_8(tmp_path: Path) -> None:
    launch = RAW + RSP + SPAWN.format("'-topic', 'robot_description'")
    head = '<?xml version="1.0" encoding="ISO-8859-1"?><!-- Räder -->\n'
    (finding,) = find_in_package(tmp_path, launch, head, "latin-1")
    assert finding.fix is not None
    assert not finding.fix.edits
    assert finding.fix.title == "save the file in UTF-8 and delete the encoding: without one, XML is UTF-8"
