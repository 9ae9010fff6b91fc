"""An exchange with the server that is recorded: each question that an editor asks, and the whole answer.

``pytest tests/server/test_exchange.py --accept`` records it anew; the diff of `exchange.json` is the review.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Coroutine
from pathlib import Path
from typing import Any

import pytest
from conftest import REPOSITORY
from lsprotocol import types

from .editor import Editor
from .test_questions import MACROS, YAML
from .test_questions import ROBOT as SOUND

pytestmark = [pytest.mark.slow, pytest.mark.long]

RECORDED = Path(__file__).with_name("exchange.json")
# An edit that is safe, one that is not, and one expression.
ROBOT = SOUND.replace(
    "</robot>", '  <link name="tip"><inertial><mass value="1 "/></inertial></link>\n</robot>'
).replace('parent="left_arm"', 'parent="left_amr"')
LAUNCH = """from launch_ros.actions import Node

MODEL = "urdf/two_arms.urdf.xacro"
NODE = Node(package="amcl", executable="amcl", parameters=[{"base_frame_id": "base"}])
"""


def test_every_answer_is_the_recorded_one(editor: Editor, project: Path, request: pytest.FixtureRequest) -> None:
    user, macros = project / "urdf/two_arms.urdf.xacro", project / "urdf/arm.xacro"
    (project / "launch").mkdir()
    (project / "launch/r.launch.py").write_text(LAUNCH)
    (project / "urdf/sizes.yaml").write_text(YAML)
    for path, text in ((user, ROBOT), (macros, MACROS)):
        path.write_text(text, encoding="utf-8")
        editor.open(path)
    exchange = _Exchange(editor, project)
    exchange.note("initialize", editor.result)
    exchange.note("textDocument/publishDiagnostics", {path.name: editor.diagnostics(path) for path in (user, macros)})
    client, document = editor.client, editor.identify(user)
    whole = types.Range(types.Position(0, 0), types.Position(99, 0))
    base, reach = editor.find(user, 'name="base"', part="base"), editor.find(user, "$(arg reach)", part="reach")
    wrong = editor.find(user, "left_amr")
    context = types.ReferenceContext(include_declaration=True)
    for ask, params in (
        (client.text_document_hover_async, types.HoverParams(document, reach)),
        (client.text_document_definition_async, types.DefinitionParams(document, reach)),
        (client.text_document_references_async, types.ReferenceParams(context, document, base)),
        (client.text_document_document_symbol_async, types.DocumentSymbolParams(document)),
        (client.text_document_folding_range_async, types.FoldingRangeParams(document)),
        (client.text_document_code_lens_async, types.CodeLensParams(document)),
        (client.text_document_inlay_hint_async, types.InlayHintParams(document, whole)),
        (client.text_document_completion_async, types.CompletionParams(document, base)),
        (client.text_document_prepare_rename_async, types.PrepareRenameParams(document, base)),
        (
            client.text_document_code_action_async,
            types.CodeActionParams(document, types.Range(wrong, wrong), types.CodeActionContext([])),
        ),
        (
            client.text_document_code_action_async,
            types.CodeActionParams(
                document, whole, types.CodeActionContext([], only=[types.CodeActionKind.SourceFixAll])
            ),
        ),
    ):
        exchange.ask(ask, params)
    editor.type(user, ROBOT.replace("left_amr", "left_arm"))
    exchange.ask(client.text_document_rename_async, types.RenameParams(document, base, "chassis"))
    text = json.dumps(exchange.entries, indent=1, ensure_ascii=False) + "\n"
    if request.config.getoption("--accept"):
        RECORDED.write_text(text, encoding="utf-8")
    assert exchange.entries == json.loads(RECORDED.read_text(encoding="utf-8"))


class _Exchange:
    """What was asked and answered, as plain values without the place of the project."""

    def __init__(self, editor: Editor, project: Path) -> None:
        self.editor = editor
        self.project = project
        self.entries: list[dict[str, Any]] = []

    def note(self, method: str, answer: object, asked: object = None) -> None:
        self.entries.append({"method": method, "asked": self._strip(asked), "answer": self._strip(answer)})

    def ask(self, question: Callable[[Any], Coroutine[Any, Any, Any]], params: object) -> None:
        method = question.__name__.removesuffix("_async")
        self.note(method, self.editor.wait(question(params)), params)

    def _strip(self, value: object) -> Any:
        """A value as JSON, in which the folders of this machine and the version of urdfcheck are replaced."""
        text = json.dumps(self.editor.client.protocol._converter.unstructure(value), default=str)
        server = self.editor.result.server_info
        for place, name in (
            (self.project.as_uri(), "PROJECT"),
            (self.project.name, "PROJECT"),
            (self.editor.folder.as_uri(), "WORKSPACE"),
            (REPOSITORY.as_uri(), "REPOSITORY"),
            (f'"{server.version if server else None}"', '"VERSION"'),
        ):
            text = text.replace(place, name)
        return json.loads(text)
