"""Long texts and names in the files of a repository: the time of a check grows with their length, and no longer than that.

A pattern that looks for its end anew from each of many begins takes 64 times as long for eight times the text.
"""

from __future__ import annotations

import html
import time
from pathlib import Path

import pytest
from conftest import check

pytestmark = pytest.mark.long

# What begins a comment, a tag, an expression, a path or a name in the languages of these files.
PIECES = (
    *("<!-- a ", "<", "<a ", '<a b="c" ', '"', "'", " ", "\n", "\t \n", "a", "a.", "a_", "1", "1.", "-", "+", "/", "../", "a/"),
    *("$(", "$(find ", "$(arg ", "${", "${a ", "[", "((", "{{", "{%", "&", "#", "# a\n", "@", "\\", '\\"', "*", "%s", "e", "1e"),
    *('<gazebo reference="a">', '<joint name="a">', "<limit ", "<property ", "<xacro:macro ", "<?", '="', "find_package("),
    *("set(a ", "install(", "f'{a", "os.path.join(", "a=", "a:", ":=", "a:=b ", '"a" ', "a, ", "0 0 0 ", "<node ", "<depend>a"),
    *('<arg name="a" ', "package://", "model://", "file://", ".dae ", ".stl", "xacro ", "import ", "Command([", "```", "[a]("),
)  # fmt: skip
LINKS = """<link name="base"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="9"/>{comment}
</inertial><visual><geometry><mesh filename="package://arm/{short}.stl"/></geometry></visual></link>{comment}
<joint name="j" type="revolute"><parent link="base"/><child link="tip"/>
<limit lower="1{typed}" upper="2" effort="1" velocity="1"/>
</joint><link name="tip"/><gazebo><plugin name="x" filename="liby.so"><p>{typed}</p></plugin></gazebo>"""
FILES = {
    "urdf/r.urdf": f'<?xml version="1.0"?>{{comment}}<robot name="r">{LINKS}</robot>',
    "urdf/x.urdf.xacro": '{comment}<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    '<xacro:arg name="a" default="{short}"/>'
    '<xacro:property name="m" value="1"/>{comment}<link name="$(arg q)"/></robot>',
    "package.xml": "<package><name>arm</name>{comment}<description>{typed}</description></package>",
    "CMakeLists.txt": "project(arm)\n{text}\ninstall(DIRECTORY urdf DESTINATION share/arm)\n",
    "README.md": "{text}\nxacro urdf/x.urdf.xacro\n",
    "setup.py": "'''{text}'''\n{text}",
    "run.sh": "{text}\nxacro urdf/x.urdf.xacro > r.urdf\n",
    "config/c.yaml": "# {line}\na: b\n",
    "launch/a.launch.py": "# {line}\nfrom launch import X\nname = 'urdf/x.urdf.xacro'\ntext = '''{text}'''\n",
    "launch/b.launch": '<launch>{comment}<param name="robot_description" command="xacro $(find arm)/urdf/x.urdf.xacro {short}"/>'
    '<arg name="q" default="{short}"/></launch>',
}


def write_repository(folder: Path, text: str) -> Path:
    """Write a package whose every file holds a text."""
    inside = text.replace("--", "- ").replace("--", "- ")
    values = {
        "text": text,
        "line": text.replace("\n", " "),
        "typed": html.escape(text),
        "short": html.escape(text[:2000]),
        "comment": f"<!-- {inside} -->",
    }
    for name, pattern in {".git/HEAD": "", **FILES}.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(pattern.format(**values), encoding="utf-8")
    return folder


@pytest.mark.parametrize("piece", PIECES)
def test_a_check_takes_time_in_proportion_to_a_text(tmp_path: Path, piece: str) -> None:
    times = []
    for length in (8_000, 64_000):
        folder = write_repository(tmp_path / str(length), piece * (length // len(piece)))
        began = time.process_time()
        run = check(folder)
        times.append(time.process_time() - began)
        assert not run.failures
    assert times[1] < 24 * times[0]


# The last two name a package that is not here, but one of almost that name is.
NO_FILES = (
    *("package://arm/{}.stl", "package://{}/a.stl", "{}.stl", "file:///{}.stl", "model://arm/{}.stl"),
    *("package://Arm/{}.stl", "package://arms/{}.stl"),
)


@pytest.mark.parametrize(
    ("name", "element"),
    [(name, element) for name in NO_FILES for element in ("mesh", "texture")],
)
def test_a_name_that_no_file_can_have_ends_no_check(tmp_path: Path, name: str, element: str) -> None:
    path = name.format("n" * 300)
    shape = f'<mesh filename="{path}"/>' if element == "mesh" else '<sphere radius="1"/>'
    texture = f'<material name="m"><texture filename="{path}"/></material>' if element == "texture" else ""
    files = {
        "package.xml": "<package><name>arm</name></package>",
        "urdf/r.urdf": f'<robot name="r"><link name="a"><visual><geometry>{shape}</geometry>{texture}</visual></link></robot>',
        "launch/a.launch": f'<launch><param name="robot_description" textfile="$(find arm)/{"n" * 300}.urdf"/></launch>',
        "launch/b.launch.py": f"xacro.process_file('{'n' * 300}.xacro')",
    }
    for place, text in files.items():
        (tmp_path / place).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / place).write_text(text, encoding="utf-8")
    run = check(tmp_path)
    assert not run.failures
