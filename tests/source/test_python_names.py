"""Which texts of a Python launch file are names of a robot's links and joints."""

from __future__ import annotations

from pathlib import Path

import pytest

from urdfcheck.source.launch.model_launches import find_named_texts
from urdfcheck.source.package.finder import PackageFinder

NAMES = {"link": {"base", "laser", "elbow"}, "joint": {"elbow"}}
LOAD = 'path = "urdf/r.urdf"\n'
NODE = "Node(parameters=[{'frame_id': %s}])"
TRANSFORM = 'Node(executable="static_transform_publisher", arguments=[%s])'


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (LOAD + NODE % "'laser'", ["laser"]),
        (LOAD + "Node(parameters=[{'frame_id': 'laser', **more, 1: 2}, 'frame_id'])", ["laser"]),
        (LOAD + "Node(parameters=[{'joints': ['elbow'], 'frame': 'elbow'}])", ["elbow", "elbow"]),
        (LOAD + TRANSFORM % "'0', '0', '0', '0', '0', '0', '1', 'base', 'laser'", ["base", "laser"]),
        (LOAD + TRANSFORM % "x, y, z, '0', '0', '0', '/base', 'name'", ["base"]),
        (LOAD + TRANSFORM % "'base'", ["base: nothing says that it names a part of the robot"]),
        (NODE % "'laser'", ["laser: the launch file does not load the robot"]),
        (LOAD + LOAD.replace("r.", "s.") + NODE % "'laser'", ["laser: the launch file loads several models"]),
        (
            LOAD + "Node(parameters=[{'frame_prefix': 'left_', 'frame_id': 'laser'}])",
            ["laser: a prefix is put before the frames"],
        ),
        (LOAD + "name = 'laser'\n" + NODE % "name", ["laser"]),
        (
            LOAD + "name = 'laser'\nprint(name)\n" + NODE % "name",
            ["laser: the variable may be used for something else"],
        ),
        (
            LOAD + "first = 'laser'\nname = first\nprint(name)\n" + NODE % "name",
            ["laser: the variable may be used for something else"],
        ),
        (LOAD + NODE % "'la' 'ser'" + NODE.join(("\n", "\n")) % r"'la\x73er'", []),
        (LOAD + "'the laser'", []),
        (LOAD + "Node(", []),
    ],
)
def test_texts_are_names_where_the_call_says_so(text: str, found: list[str], tmp_path: Path) -> None:
    (tmp_path / "package.xml").write_text("<package><name>p</name></package>")
    for folder, name in (("urdf", "r.urdf"), ("urdf", "s.urdf"), ("launch", "r.launch.py")):
        (tmp_path / folder).mkdir(exist_ok=True)
        (tmp_path / folder / name).write_text(text if folder == "launch" else "<robot name='r'/>")
    model = tmp_path / "urdf/r.urdf"
    texts = list(find_named_texts(model, PackageFinder(model), NAMES))
    assert [f"{t.name}: {t.doubt}" if t.doubt else t.name for t in texts] == found
    assert all(text[t.span.start : t.span.end] == t.name for t in texts)
