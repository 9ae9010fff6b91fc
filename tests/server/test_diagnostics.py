"""What an editor shows while a robot is typed."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
import warnings
from pathlib import Path

import pytest
from conftest import FIXTURES, command
from lsprotocol import types

from .editor import Editor, list_children

pytestmark = [pytest.mark.slow, pytest.mark.long]

INERTIA = '<inertia ixx="{}" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
ROBOT = (
    '<?xml version="1.0"?>\n<robot name="r">\n  <!-- {} --> <link name="base"><inertial><mass value="1"/>'
    + INERTIA
    + "</inertial></link>\n</robot>\n"
)
SOUND, IMPOSSIBLE = ROBOT.format("", 1), ROBOT.format("", 3)
BODY = "<inertial><mass value='1'/><inertia ixx='{}' ixy='0' ixz='0' iyy='0.01' iyz='0' izz='0.01'/></inertial>"
REFUSED = f"""<robot name="r">
  <link name="base">{BODY.format(0.01)}</link>
  <link name="arm">{BODY.format(0.03)}</link>
  <joint name="j" type="revolute">
    <parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
</robot>
"""
MACROS = f"""<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="body" params="name">
    <link name="${{name}}"><inertial><mass value="1"/>{INERTIA.format(1)}</inertial></link>
  </xacro:macro>
</robot>
"""
WRONG_MACROS = MACROS.replace('ixx="1"', 'ixx="3"')
USER = (
    '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">\n'
    '  <xacro:include filename="body.xacro"/>\n  <xacro:body name="base"/>\n</robot>\n'
)


def list_found(folder: Path, *paths: Path) -> set[tuple[str, int, int]]:
    """The findings of the command in the first of some files: code, line and column."""
    done = command(*map(str, paths), "--format", "json", cwd=folder)
    name = os.path.relpath(paths[0], folder)
    return {
        (finding["code"], place["line"], place["column"])
        for finding in json.loads(done.stdout)["findings"]
        if (place := finding["location"]) is not None and place["file"] == name and not finding["suppressed"]
    }


def list_shown(editor: Editor, path: Path) -> set[tuple[str, int, int]]:
    """The same as the editor shows it, of a text in ASCII."""
    return {
        (str(found.code), found.range.start.line + 1, found.range.start.character + 1)
        for found in editor.diagnostics(path)
    }


@pytest.mark.smoke
def test_what_is_typed_is_checked_before_it_is_saved(editor: Editor, project: Path) -> None:
    path = project / "urdf/r.urdf"
    path.write_text(SOUND)
    editor.open(path)
    assert "INR003" not in editor.codes(path)
    editor.type(path, IMPOSSIBLE)
    (found,) = [d for d in editor.diagnostics(path) if d.code == "INR003"]
    assert path.read_text() == SOUND
    assert found.severity == types.DiagnosticSeverity.Error
    assert found.message == "base: inertia breaks the triangle inequality (by 33.3 %)"
    assert found.source == "urdfcheck"
    assert found.code_description is not None
    assert "INR003-triangle-inequality.md" in found.code_description.href
    editor.type(path, SOUND)
    assert "INR003" not in editor.codes(path)


@pytest.mark.smoke
def test_a_file_that_does_not_parse_says_why(editor: Editor, project: Path) -> None:
    path = project / "urdf/r.urdf"
    path.write_text(SOUND)
    editor.open(path)
    editor.type(path, SOUND.replace("</link>", "</lnik>"))
    assert "XML001" in editor.codes(path)
    editor.type(path, "")
    assert editor.codes(path), "an empty file is no robot"
    editor.type(path, SOUND)
    assert "XML001" not in editor.codes(path)


def test_each_of_several_joints_that_are_wrong_alike_shows_it(editor: Editor, project: Path) -> None:
    path = project / "urdf/r.urdf"
    hinge = (
        '<joint name="{0}" type="revolute"><parent link="a"/><child link="{0}"/><axis xyz="0 0 1"/>'
        '<limit lower="-1" upper="1" effort="1e12" velocity="1"/></joint><link name="{0}"/>'
    )
    path.write_text(f"""<robot name="r"><link name="a"/>\n{hinge.format("b")}\n{hinge.format("c")}\n</robot>""")
    editor.open(path)
    found = [d for d in editor.diagnostics(path) if d.code == "JNT007"]
    assert [d.range.start.line for d in found] == [1, 2]
    assert [[r.location.range.start.line for r in d.related_information or ()] for d in found] == [[2], [1]]


@pytest.mark.parametrize("before", ["é", "🤖", "a\u2028c", "🤖é🤖"])
def test_positions_count_utf_16_units(editor: Editor, project: Path, before: str) -> None:
    path = project / "urdf/r.urdf"
    path.write_text(ROBOT.format(before, 3).replace("\n", "", 1), encoding="utf-8")
    editor.open(path)
    (found,) = [d for d in editor.diagnostics(path) if d.code == "INR003"]
    assert editor.read(path, found.range).startswith("<inertia ") or editor.read(path, found.range) in {"3", "1"}


def test_positions_are_counted_behind_a_byte_order_mark(editor: Editor, project: Path) -> None:
    """Where an editor sends it: most do not."""
    path = project / "urdf/r.urdf"
    path.write_text(
        '\ufeff<?xml version="1.0"?>\n<robot name="r"><link name="a">\n<inertial><mass value="1 "/></inertial></link></robot>'
    )
    editor.open(path)
    (found,) = [d for d in editor.diagnostics(path) if d.code == "XML007"]
    assert editor.read(path, found.range) == "1 "
    params = types.CodeActionParams(editor.identify(path), found.range, types.CodeActionContext([found]))
    (first, *_) = editor.wait(editor.client.text_document_code_action_async(params)) or []
    assert first.title.startswith("XML007: ")


@pytest.fixture
def macro_project(project: Path) -> tuple[Path, Path]:
    macros, user = project / "urdf/body.xacro", project / "urdf/r.urdf.xacro"
    macros.write_text(MACROS)
    user.write_text(USER)
    return macros, user


@pytest.mark.smoke
def test_an_edit_of_macros_renews_the_robots_that_use_them(editor: Editor, macro_project: tuple[Path, Path]) -> None:
    macros, user = macro_project
    editor.open(user)
    assert "INR003" not in editor.codes(macros)
    editor.open(macros)
    editor.type(macros, WRONG_MACROS)
    (found,) = [d for d in editor.diagnostics(macros) if d.code == "INR003"]
    (call, *_) = found.related_information
    assert call.location.uri == user.as_uri()
    assert editor.read(user, call.location.range).startswith("<xacro:body")
    editor.type(user, USER.replace('  <xacro:body name="base"/>', '  <link name="base"/>'))
    assert "INR003" not in editor.codes(macros), "nothing makes the link any more"


def test_macros_alone_are_checked_through_the_robots_that_include_them(
    editor: Editor, macro_project: tuple[Path, Path]
) -> None:
    macros, _ = macro_project
    editor.open(macros)
    editor.type(macros, WRONG_MACROS)
    assert "INR003" in editor.codes(macros)


ARM = """<robot name="arm">
  <link name="base"/>
  <link name="hand"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="wrist" type="revolute"><parent link="base"/><child link="hand"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>
"""
ARM_SRDF = '<robot name="arm"><group name="all"><chain base_link="base" tip_link="hnad"/></group></robot>'
ARM_CONTROLLERS = "arm_controller:\n  type: position_controllers/JointTrajectoryController\n  joints: [wrist, elbow]\n"


@pytest.mark.parametrize(
    ("name", "text", "named", "code"),
    [("arm.srdf", ARM_SRDF, 'base" tip', "SRD001"), ("controllers.yaml", ARM_CONTROLLERS, "wrist", "CTL004")],
    ids=["srdf", "controllers"],
)
def test_what_is_about_a_robot_is_checked_alone(
    editor: Editor, project: Path, name: str, text: str, named: str, code: str
) -> None:
    """One may open the semantic description only, and goes from there to the robot."""
    (project / "urdf/arm.urdf").write_text(ARM)
    path = project / "config" / name
    path.parent.mkdir()
    path.write_text(text)
    editor.open(path)
    assert code in editor.codes(path)
    params = types.DefinitionParams(editor.identify(path), editor.find(path, named))
    found = editor.wait(editor.client.text_document_definition_async(params))
    assert isinstance(found, list)
    assert [place.uri for place in found] == [(project / "urdf/arm.urdf").as_uri()]
    editor.type(path, text.replace("hnad", "hand").replace(", elbow", ""))
    assert code not in editor.codes(path)


def test_yaml_of_no_robot_is_left_alone(editor: Editor, project: Path) -> None:
    path = project / "compose.yaml"
    path.write_text("services: {web: {image: x}}\n")
    editor.open(path)
    assert editor.codes(path) == []


def test_the_configuration_counts(editor: Editor, project: Path) -> None:
    path = project / "urdf/r.urdf"
    path.write_text(IMPOSSIBLE)
    (project / "urdfcheck.toml").write_text('ignore = ["INR003"]')
    editor.open(path)
    assert "INR003" not in editor.codes(path)
    (project / "urdfcheck.toml").write_text('[severity]\nINR003 = "info"')
    (found,) = [d for d in editor.diagnostics(path) if d.code == "INR003"]
    assert found.severity == types.DiagnosticSeverity.Information
    (project / "urdfcheck.toml").write_text("selct = 1")
    (failure,) = editor.diagnostics(path)
    assert "unknown key 'selct'" in failure.message


def test_a_comment_in_the_buffer_suppresses(editor: Editor, project: Path) -> None:
    path = project / "urdf/r.urdf"
    path.write_text(IMPOSSIBLE)
    editor.open(path)
    editor.type(path, ROBOT.format("urdfcheck: ignore[INR003] an example", 3))
    assert "INR003" not in editor.codes(path)


def test_two_projects_are_checked_beside_each_other(editor: Editor, project: Path) -> None:
    """Each with its own configuration: that of one does not fail the other."""
    paths = []
    for name in ("one", "two"):
        folder = project / name
        folder.mkdir()
        (folder / ".git").mkdir()
        (folder / "r.urdf").write_text(IMPOSSIBLE)
        paths.append(folder / "r.urdf")
        editor.open(paths[-1])
    (project / "two/urdfcheck.toml").write_text("selct = 1")
    assert "INR003" in editor.codes(paths[0])
    assert "INR003" not in editor.codes(paths[1])


def test_what_is_closed_is_no_longer_shown(editor: Editor, project: Path) -> None:
    path = project / "urdf/r.urdf"
    path.write_text(IMPOSSIBLE)
    editor.open(path)
    assert editor.diagnostics(path)
    editor.close(path)
    assert not editor.diagnostics(path)


def test_findings_that_take_meshes_come_when_nothing_is_typed(tmp_path: Path) -> None:
    """Those of the source tier come first, at rest all of them, those of the command."""
    editor = Editor(tmp_path)
    path = tmp_path / "car.urdf"
    text = (FIXTURES / "car-3/urdf/car-3.urdf").read_text()
    path.write_text(text)
    editor.open(path)
    shown = list_shown(editor, path)
    assert shown == list_found(tmp_path, path)
    assert "SYM001" in {code for code, _, _ in shown}
    editor.type(path, text.replace("<link", "\n<link", 1))
    moved = list_shown(editor, path)
    assert {line for _, line, _ in moved} == {line + 1 for _, line, _ in shown}
    editor.save(path)
    assert list_shown(editor, path) == moved == list_found(tmp_path, path)
    editor.end()


@pytest.mark.long
@pytest.mark.parametrize("like", ["neovim", "emacs"])
def test_other_editors_get_what_they_said_they_understand(like: str, tmp_path: Path) -> None:
    """The client warns of anything that the capabilities of its editor do not allow."""
    editor = Editor(tmp_path, "--tier", "source", like=like)
    path = tmp_path / "é 🤖.urdf"
    path.write_text(IMPOSSIBLE)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        editor.open(path)
        (found,) = [d for d in editor.diagnostics(path) if d.code == "INR003"]
        params = types.CodeActionParams(editor.identify(path), found.range, types.CodeActionContext([found]))
        assert editor.wait(editor.client.text_document_code_action_async(params))
        hover = types.HoverParams(editor.identify(path), found.range.start)
        assert editor.wait(editor.client.text_document_hover_async(hover)) is not None
    editor.end()


def test_a_check_process_that_dies_is_started_again(editor: Editor, project: Path) -> None:
    path = project / "urdf/r.urdf"
    path.write_text(SOUND)
    editor.open(path)
    assert "INR003" not in editor.codes(path)
    for child in list_children(editor):
        os.kill(child, signal.SIGKILL)
    editor.type(path, IMPOSSIBLE)
    assert "INR003" in editor.codes(path)


def test_the_server_ends_when_its_client_is_gone(tmp_path: Path) -> None:
    """Without a word: the client was killed."""
    process = subprocess.Popen(
        [sys.executable, "-m", "urdfcheck", "server"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, cwd=tmp_path
    )
    assert process.stdin is not None
    process.stdin.write(b"Content-Length: 40\r\n\r\n{")
    process.stdin.close()
    assert process.wait(120) is not None
    assert process.stdout is not None
    process.stdout.close()


@pytest.mark.long
def test_what_an_engine_that_is_a_target_says_is_shown(tmp_path: Path) -> None:
    """As the command shows it: an engine that refuses the model."""
    pytest.importorskip("mujoco")
    words = ("--target", "mujoco", "--ignore", "INR003")
    editor = Editor(tmp_path, *words)
    path = tmp_path / "r.urdf"
    path.write_text(REFUSED)
    editor.open(path)
    done = command(str(path), *words, "--format", "json", cwd=tmp_path)
    reported = {finding["headline"] for finding in json.loads(done.stdout)["findings"]}
    assert any("MuJoCo" in headline for headline in reported)
    assert {found.message for found in editor.diagnostics(path)} == reported
    editor.end()


def test_the_server_and_its_processes_end_with_the_client(tmp_path: Path) -> None:
    editor = Editor(tmp_path)
    path = tmp_path / "r.urdf"
    path.write_text(SOUND)
    editor.open(path)
    editor.rest()
    children = list_children(editor)
    assert children
    assert editor.end().returncode == 0
    for _ in range(100):
        if not any(Path(f"/proc/{child}").exists() for child in children):
            break
        time.sleep(0.05)
    assert not [child for child in children if Path(f"/proc/{child}").exists()]
