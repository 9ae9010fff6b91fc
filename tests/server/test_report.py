"""The report with the robot in 3D, beside the text of an editor or in a browser."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from lsprotocol import types

from .editor import Editor

pytestmark = [pytest.mark.slow, pytest.mark.long]

ROBOT = """<robot name="walker">
  <link name="base">
    <inertial>
      <mass value="1"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="9"/>
    </inertial>
  </link>
  <link name="leg"/>
  <joint name="hip" type="fixed">
    <parent link="base"/>
    <child link="leg"/>
  </joint>
</robot>
"""
MACRO = """<robot name="walker" xmlns:xacro="http://ros.org/xacro">
  <xacro:macro name="limb" params="name">
    <link name="${name}"><visual><geometry><sphere radius="-1"/></geometry></visual></link>
    <joint name="to_${name}" type="fixed"><parent link="base"/><child link="${name}"/></joint>
  </xacro:macro>
  <link name="base"/>
  <xacro:limb name="leg"/>
</robot>
"""


def ask(editor: Editor, command: str, *arguments: Any) -> Any:
    params = types.ExecuteCommandParams(command, [*arguments])
    return editor.wait(editor.client.workspace_execute_command_async(params))


def select(editor: Editor, path: Path, text: str, part: str | None = None) -> Any:
    at = editor.find(path, text, part=part)
    return as_dict(ask(editor, "urdfcheck.findSelection", path.as_uri(), at.line, at.character))


def as_dict(answer: Any) -> dict[str, Any]:
    return answer if isinstance(answer, dict) else answer._asdict()


@pytest.fixture
def path(editor: Editor, project: Path) -> Path:
    path = project / "urdf/walker.urdf"
    path.write_text(ROBOT)
    editor.open(path)
    editor.rest()
    return path


@pytest.mark.smoke
def test_the_report_is_about_the_text_of_the_editor(editor: Editor, path: Path) -> None:
    editor.type(path, ROBOT.replace('"leg"', '"left_leg"'))
    report = Path(ask(editor, "urdfcheck.writeReport", path.as_uri())).read_text()
    assert "left_leg" in report
    assert 'id="uc-data"' in report
    (finding,) = [f for f in editor.diagnostics(path) if f.code == "INR003"]
    card = select(editor, path, 'izz="9"', "9")["finding"]
    assert f'id="{card}"' in report
    assert finding.code in report.partition(f'id="{card}"')[2][:400]


def test_one_file_has_one_report(editor: Editor, path: Path) -> None:
    first = ask(editor, "urdfcheck.writeReport", path.as_uri())
    assert ask(editor, "urdfcheck.writeReport", path.as_uri()) == first


def test_a_place_is_about_the_finding_and_the_part_around_it(editor: Editor, path: Path) -> None:
    assert select(editor, path, "<mass") == {"link": "base"}
    assert select(editor, path, '<parent link="base"', "base") == {"link": "base"}
    assert select(editor, path, '<joint name="hip"') == {"joint": "hip"}
    assert select(editor, path, "<robot") == {}
    # The finding is on the line, but not at the position.
    selection = select(editor, path, '<inertia ixx="1"')
    assert selection["link"] == "base"
    assert selection["finding"].startswith("f-")


def test_a_place_in_a_macro_or_its_call_is_about_what_it_makes(editor: Editor, project: Path) -> None:
    path = project / "urdf/walker.urdf.xacro"
    path.write_text(MACRO)
    editor.open(path)
    editor.rest()
    assert select(editor, path, "<joint")["joint"] == "to_leg"
    assert select(editor, path, "<sphere")["link"] == "leg"
    assert select(editor, path, '<xacro:limb name="leg"')["link"] == "leg"


@pytest.mark.smoke
def test_the_verdict_counts_what_the_robot_has_in_other_files_too(editor: Editor, project: Path) -> None:
    part = project / "urdf/limb.xacro"
    macro, _, rest = MACRO.partition('  <link name="base"/>')
    part.write_text(f"{macro}</robot>\n")
    path = project / "urdf/walker.urdf.xacro"
    path.write_text(
        '<robot name="walker" xmlns:xacro="http://ros.org/xacro">\n'
        f'<xacro:include filename="limb.xacro"/><link name="base"/>{rest}'
    )
    other = project / "urdf/sound.urdf"
    other.write_text('<robot name="sound"><link name="base"/></robot>')
    editor.open(path)
    editor.open(other)
    verdict = as_dict(ask(editor, "urdfcheck.awaitVerdict", path.as_uri()))
    assert verdict["error"] == 1
    assert verdict["failures"] == []
    assert as_dict(ask(editor, "urdfcheck.awaitVerdict", other.as_uri()))["error"] == 0


def test_a_browser_shows_the_report_at_the_finding(editor: Editor, path: Path) -> None:
    at = editor.find(path, 'izz="9"', part="9")
    context = types.CodeActionContext([])
    asked = types.CodeActionParams(editor.identify(path), types.Range(at, at), context)
    actions = editor.wait(editor.client.text_document_code_action_async(asked)) or []
    (action,) = [a for a in actions if a.title == "Show INR003 in 3D"]
    assert isinstance(action, types.Command)
    ask(editor, action.command, *(action.arguments or ()))
    params = editor.client.shown_documents[-1]
    assert params.external
    report, _, card = params.uri.partition("#")
    assert f'id="{card}"' in Path(report.removeprefix("file://")).read_text()


def test_what_is_no_robot_has_no_report(editor: Editor, project: Path) -> None:
    path = project / "config.yaml"
    editor.open(path, "a: 1\n")
    assert ask(editor, "urdfcheck.writeReport", path.as_uri()) is None
    assert "report on robots" in editor.client.messages[-1].message
