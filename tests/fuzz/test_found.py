"""What long runs have found, as small as it gets."""

from __future__ import annotations

from pathlib import Path

import pytest
from fuzz.cases import Case
from fuzz.oracle import judge

pytestmark = pytest.mark.slow

pytest.importorskip("pinocchio")


def model(inside: str) -> bytes:
    return f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{inside}</robot>'.encode()


def drawn(mesh: str) -> bytes:
    return model(f'<link name="a"><visual><geometry><mesh filename="{mesh}"/></geometry></visual></link>')


FOUND = {
    "a spawned robot without arguments": Case(
        "it.launch", {"it.launch": b'<launch><node pkg="gazebo_ros" exec="spawn_entity.py" args=" "/></launch>'}
    ),
    "a model whose name no file system takes": Case(
        "it.launch",
        {"it.launch": f'<launch><param name="robot_description" textfile="/{"n" * 300}"/></launch>'.encode()},
    ),
    "an encoding of a Python launch file that nobody knows": Case(
        "it.launch.py", {"it.launch.py": b"# coding: nonsense"}
    ),
    "a byte in a Python launch file that is no UTF-8": Case("it.launch.py", {"it.launch.py": b"a = '\xb4'\n"}),
    "a moment of inertia with an exponent that decimals lack": Case(
        "model.urdf",
        {
            "model.urdf": model(
                '<link name="a"><inertial><mass value="1"/><inertia ixx="1e-999999999" ixy="0" ixz="0" iyy="1" iyz="0" '
                'izz="0.1"/></inertial></link>'
            )
        },
    ),
    "a shape so far away that its size is lost": Case(
        "model.urdf",
        {
            "model.urdf": model(
                '<link name="a"><visual><origin xyz="1e20 0 0"/><geometry><box size="1 1 1"/></geometry></visual>'
                '<collision><geometry><box size="1 1 1"/></geometry></collision></link>'
            )
        },
        tier="mesh",
    ),
    "a processing instruction inside of the robot, which the reference parser refuses": Case(
        "model.urdf", {"model.urdf": model('<link name="a"/><?x?>')}
    ),
    "a letter in the XML declaration that is not ASCII": Case(
        "model.urdf", {"model.urdf": '<?xml vérsion="1.0" encoding="utf-8"?>'.encode() + model("")}
    ),
    "a text of which Python thinks that it is an odd number": Case(
        "model.urdf.xacro",
        {"model.urdf.xacro": model('<xacro:property name="a" value="1"/><link name="${-1.is_integer}"/>')},
    ),
    "a package whose name no file system takes": Case(
        "model.urdf", {"model.urdf": drawn(f"package://{'n' * 300}/a.stl")}
    ),
    "a character that tells xacro of another in UTF-16": Case(
        "model.urdf.xacro",
        {"model.urdf.xacro": '<robot name="r"><link name="名"/></robot>'.encode("utf-16-le")},
        reading=True,
    ),
    "an entity before the root": Case("model.urdf", {"model.urdf": b'&#65279;<robot name="r"/>'}),
    "a comment for one encoding, links for another": Case(
        "model.urdf",
        {
            "model.urdf": b'<?xml version="1.0" encoding="utf-7"?><robot name="r"><link name="a"/>+ADwAIQAtAC0-<link name="b"/>'
            b"+AC0ALQA+-</robot>"
        },
        reading=True,
    ),
    "a name with a tab where its joint has a blank": Case(
        "model.urdf",
        {
            "model.urdf": model(
                '<link name="a\tb"/><link name="c"/><joint name="j" type="fixed"><parent link="a b"/><child link="c"/></joint>'
            )
        },
        reading=True,
    ),
    "an instruction at the top of a xacro": Case(
        "model.urdf.xacro", {"model.urdf.xacro": b"<?xml-model href='a'?>" + model('<link name="a"/>')}, reading=True
    ),
    "letters that are not UTF-8 in a xacro": Case(
        "model.urdf.xacro",
        {"model.urdf.xacro": '<?xml version="1.0" encoding="latin-1"?><robot name="ä"/>'.encode("latin-1")},
        reading=True,
    ),
    "a number that xacro cannot write": Case(
        "model.urdf.xacro",
        {"model.urdf.xacro": model('<link name="a"><xacro:attribute name="b" value="${2 * 2.0}"/></link>')},
        reading=True,
    ),
    "an include without a file in a launch file": Case("it.launch", {"it.launch": b"<launch><include/></launch>"}),
}


@pytest.mark.parametrize("what", FOUND)
def test_it_is_found_no_more(what: str, tmp_path: Path) -> None:
    verdict = judge(FOUND[what], tmp_path, everything=True)
    assert not verdict.failed, verdict.detail
