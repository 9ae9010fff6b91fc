"""What an editor can do about findings, applied as an editor does."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import command
from lsprotocol import types

from .editor import Editor, list_children

pytestmark = [pytest.mark.slow, pytest.mark.long]

FIX_ALL = "source.fixAll.urdfcheck"
# A name that exists in one other spelling (unsafe), a blank behind a number and a decimal comma of which only the blank is safe.
ROBOT = """<?xml version="1.0"?>
<!-- 🤖 é -->
<robot name="r">
  <link name="base"/>
  <link name="arm"/>
  <joint name="é🤖" type="revolute"> <parent link="bsae"/>
    <child link="arm"/>
    <limit lower="-1" upper="1" effort="1" velocity="1 "/>
  </joint>
</robot>
"""


def ask(editor: Editor, path: Path, code: str = "", *, only: list[str] | None = None) -> list[types.CodeAction]:
    """The actions for the diagnostic with a code, or for the whole text; without commands."""
    return [action for action in ask_all(editor, path, code, only) if isinstance(action, types.CodeAction)]


def ask_all(
    editor: Editor, path: Path, code: str, only: list[str] | None = None
) -> list[types.CodeAction | types.Command]:
    range_ = types.Range(types.Position(0, 0), types.Position(999, 0))
    shown = [found for found in editor.diagnostics(path) if found.code == code]
    if code:
        range_ = shown[0].range
    params = types.CodeActionParams(editor.identify(path), range_, types.CodeActionContext(shown, only=only))
    return list(editor.wait(editor.client.text_document_code_action_async(params)) or [])


def apply(editor: Editor, edit: types.WorkspaceEdit | None) -> None:
    """Do what an editor does with an edit: of documents that are open in the version that it is for."""
    assert edit is not None
    paths = {path.as_uri(): path for path in editor.texts}
    if edit.changes is not None:
        changes = dict(edit.changes)
    else:
        changes = {}
        for change in edit.document_changes or ():
            assert isinstance(change, types.TextDocumentEdit)
            assert change.text_document.version == editor.versions[paths[change.text_document.uri]]
            changes[change.text_document.uri] = change.edits
    for uri, edits in changes.items():
        path = paths[uri]
        units = editor.texts[path].encode("utf-16-le")
        lines = [0]
        for line in editor.texts[path].split("\n"):
            lines.append(lines[-1] + 2 * len((line + "\n").encode("utf-16-le")) // 2)
        for one in sorted(edits, key=lambda e: (e.range.start.line, e.range.start.character), reverse=True):
            start, end = (lines[at.line] + 2 * at.character for at in (one.range.start, one.range.end))
            units = units[:start] + one.new_text.encode("utf-16-le") + units[end:]
        editor.type(path, units.decode("utf-16-le"))


@pytest.fixture
def path(editor: Editor, project: Path) -> Path:
    path = project / "urdf/r.urdf"
    path.write_text(ROBOT, encoding="utf-8")
    editor.open(path)
    return path


@pytest.mark.smoke
def test_an_edit_that_may_change_the_meaning_says_so(editor: Editor, path: Path) -> None:
    first, *_ = ask(editor, path, "KIN002")
    assert first.title == "KIN002: write `base`, or add the link bsae (may change the meaning)"
    assert not first.is_preferred
    apply(editor, first.edit)
    assert editor.texts[path] == ROBOT.replace("bsae", "base")
    assert "KIN002" not in editor.codes(path)


@pytest.mark.smoke
def test_a_safe_edit_is_preferred(editor: Editor, path: Path) -> None:
    (safe,) = [action for action in ask(editor, path, "XML007") if action.is_preferred]
    apply(editor, safe.edit)
    assert editor.texts[path] == ROBOT.replace('"1 "', '"1"')
    assert "XML007" not in editor.codes(path)


def test_an_edit_follows_the_text_that_was_typed_since(editor: Editor, path: Path) -> None:
    """The edit is for the present text, whether or not that was checked; none is offered where its own text was edited."""
    editor.diagnostics(path)
    above = ROBOT.replace("<link", "<!-- new -->\n  <link", 1)
    editor.type(path, above)
    range_ = types.Range(types.Position(6, 0), types.Position(6, 99))
    params = types.CodeActionParams(editor.identify(path), range_, types.CodeActionContext([]))
    found = editor.wait(editor.client.text_document_code_action_async(params)) or []
    first = next(action for action in found if "KIN002: write" in action.title)
    assert isinstance(first, types.CodeAction)
    apply(editor, first.edit)
    assert editor.texts[path] == above.replace("bsae", "base")


def test_all_safe_fixes_at_once(editor: Editor, path: Path) -> None:
    (whole,) = ask(editor, path, only=[types.CodeActionKind.SourceFixAll])
    assert whole.title == "Apply all safe fixes (1 finding)"
    apply(editor, whole.edit)
    assert editor.texts[path] == ROBOT.replace('"1 "', '"1"')
    assert ask(editor, path, only=[FIX_ALL]) == []
    assert ask(editor, path, only=["refactor"]) == []


def test_all_safe_fixes_beside_another_document(editor: Editor, project: Path, path: Path) -> None:
    other = project / "urdf/other.urdf"
    other.write_text('<robot name="other"><link name="base"/></robot>')
    editor.open(other)
    editor.rest()
    processes = list_children(editor)
    (whole,) = ask(editor, path, only=[FIX_ALL])
    apply(editor, whole.edit)
    assert editor.texts[path] == ROBOT.replace('"1 "', '"1"')
    assert ask(editor, path, only=[FIX_ALL]) == []
    assert list_children(editor) == processes


def test_all_safe_fixes_are_computed_when_they_are_chosen(editor: Editor, path: Path) -> None:
    (offered,) = [action for action in ask(editor, path, "XML007") if action.kind == FIX_ALL]
    assert offered.edit is None
    resolved = editor.wait(editor.client.code_action_resolve_async(offered))
    apply(editor, resolved.edit)
    assert editor.texts[path] == ROBOT.replace('"1 "', '"1"')


def test_a_finding_is_suppressed_once_it_has_a_reason(editor: Editor, path: Path) -> None:
    (action,) = [action for action in ask(editor, path, "KIN002") if action.title.startswith("Suppress")]
    apply(editor, action.edit)
    assert '<!-- urdfcheck:ignore[KIN002]  --> <parent link="bsae"/>' in editor.texts[path]
    assert {"KIN002", "URC903"} <= set(editor.codes(path)), "without a reason it has no effect"
    editor.type(path, editor.texts[path].replace("[KIN002]  -->", "[KIN002] the base comes later -->"))
    assert not {"KIN002", "URC903"} & set(editor.codes(path))


def test_findings_are_added_to_the_baseline_that_the_command_writes(editor: Editor, path: Path) -> None:
    """One after the other, in a file that the first of them makes; in the end it is what the command writes at once."""
    folder = path.parent.parent
    (folder / "urdfcheck.toml").write_text("")
    file = folder / "urdfcheck-baseline.json"
    wanted = folder / "wanted.json"
    command("baseline", "write", str(path), "--tier", "source", "--baseline", str(wanted), cwd=folder)
    editor.save(path)
    for _ in range(9):
        accepting = [action for action in ask(editor, path) if action.title.startswith("Accept ")]
        if not accepting:
            break
        assert accepting[0].title.endswith(" here: add it to urdfcheck-baseline.json")
        assert accepting[0].edit is not None
        made, *others = accepting[0].edit.document_changes or ()
        if isinstance(made, types.CreateFile):
            assert not file.exists()
            file.write_text("")
            editor.open(file)
            made = others[0]
            assert isinstance(made, types.TextDocumentEdit)
            made.text_document.version = 1
        apply(editor, types.WorkspaceEdit(document_changes=[made]))
    assert [d for d in editor.diagnostics(path) if d.code == "KIN002"] == []
    assert editor.texts[file] == wanted.read_text()


FLAT = """<robot name="r"><link name="base"/><link name="arm"><inertial><mass value="1"/>
<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="{izz}"/></inertial></link>
<joint name="j" type="continuous"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/></joint></robot>"""


def test_a_finding_that_has_become_worse_keeps_its_one_entry(editor: Editor, path: Path) -> None:
    folder = path.parent.parent
    (folder / "urdfcheck.toml").write_text("")
    file = folder / "urdfcheck-baseline.json"
    path.write_text(FLAT.format(izz="0.09"))
    command("baseline", "write", str(path), "--tier", "source", cwd=folder)
    wanted = file.read_text()
    path.write_text(FLAT.format(izz="0.03"))
    command("baseline", "write", str(path), "--tier", "source", cwd=folder)
    assert file.read_text() != wanted
    editor.open(file)
    editor.type(path, FLAT.format(izz="0.09"))
    editor.save(path)
    (action,) = [action for action in ask(editor, path, "INR003") if action.title.startswith("Accept INR003")]
    apply(editor, action.edit)
    assert editor.texts[file] == wanted


def test_the_page_of_a_rule_is_opened(editor: Editor, path: Path) -> None:
    commands = [action for action in ask_all(editor, path, "KIN002") if isinstance(action, types.Command)]
    (action,) = [command for command in commands if command.title.startswith("Open the page")]
    params = types.ExecuteCommandParams(action.command, action.arguments)
    editor.wait(editor.client.workspace_execute_command_async(params))
    assert Path(editor.client.shown_documents[-1].uri).name == "KIN002-unknown-link.md"
