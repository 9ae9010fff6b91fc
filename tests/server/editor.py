"""An editor without a window, that speaks with a server of its own: what it is sent, and what it asks."""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
from collections.abc import Coroutine
from pathlib import Path
from typing import Any, TypeVar

import pytest_lsp
from conftest import REPOSITORY
from lsprotocol import types

T = TypeVar("T")
# No test is timed; this ends one that waits for what never comes.
_LONGEST = 240.0
CHECK = "urdfcheck.check"


class Editor:
    """A client of the protocol with the capabilities of a real editor."""

    def __init__(self, folder: Path, *options: str, like: str = "visual_studio_code") -> None:
        self.folder = folder
        self.loop = asyncio.new_event_loop()
        self.client = pytest_lsp.make_test_lsp_client()
        for asked in (types.CLIENT_REGISTER_CAPABILITY, types.WORKSPACE_CODE_LENS_REFRESH):
            self.client.feature(asked)(lambda params: None)
        self.texts: dict[Path, str] = {}
        self.versions: dict[Path, int] = {}
        self.result = self.wait(self._start(options, like))

    async def _start(self, options: tuple[str, ...], like: str) -> types.InitializeResult:
        await self.client.start_io(sys.executable, "-m", "urdfcheck", "server", *options, cwd=REPOSITORY)
        capabilities = pytest_lsp.client_capabilities(like)
        result: types.InitializeResult = await self.client.initialize_session(
            types.InitializeParams(
                capabilities=capabilities,
                process_id=os.getpid(),
                workspace_folders=[types.WorkspaceFolder(self.folder.as_uri(), self.folder.name)],
            )
        )
        return result

    def wait(self, work: Coroutine[Any, Any, T]) -> T:
        return self.loop.run_until_complete(asyncio.wait_for(work, _LONGEST))

    def rest(self) -> None:
        """Wait until everything that was typed is checked."""
        self.wait(self.client.workspace_execute_command_async(types.ExecuteCommandParams(CHECK)))

    def open(self, path: Path, text: str | None = None) -> str:
        self.texts[path] = path.read_bytes().decode() if text is None else text
        self.versions[path] = 1
        item = types.TextDocumentItem(path.as_uri(), "xml", 1, self.texts[path])
        self.client.text_document_did_open(types.DidOpenTextDocumentParams(item))
        return self.texts[path]

    def type(self, path: Path, text: str) -> None:
        """Replace the text of the buffer."""
        self.texts[path] = text
        self.versions[path] += 1
        document = types.VersionedTextDocumentIdentifier(self.versions[path], path.as_uri())
        change = types.TextDocumentContentChangeWholeDocument(text)
        self.client.text_document_did_change(types.DidChangeTextDocumentParams(document, [change]))

    def save(self, path: Path) -> None:
        path.write_bytes(self.texts[path].encode())
        self.client.text_document_did_save(types.DidSaveTextDocumentParams(self.identify(path)))

    def close(self, path: Path) -> None:
        self.client.text_document_did_close(types.DidCloseTextDocumentParams(self.identify(path)))
        del self.texts[path], self.versions[path]

    def close_all(self) -> None:
        for path in list(self.texts):
            self.close(path)
        self.rest()

    def identify(self, path: Path) -> types.TextDocumentIdentifier:
        return types.TextDocumentIdentifier(path.as_uri())

    def diagnostics(self, path: Path) -> list[types.Diagnostic]:
        """What the editor shows of a file at rest."""
        self.rest()
        return list(self.client.diagnostics.get(path.as_uri(), ()))

    def codes(self, path: Path) -> list[str]:
        return sorted(str(diagnostic.code) for diagnostic in self.diagnostics(path))

    def find(self, path: Path, text: str, *, part: str | None = None, occurrence: int = 0) -> types.Position:
        """The position of a text in a buffer, or of a part of that text, in UTF-16 units."""
        whole, at = self.texts[path], -1
        for _ in range(occurrence + 1):
            at = whole.index(text, at + 1)
        at += 0 if part is None else text.index(part)
        line = whole.count("\n", 0, at)
        before = whole[whole.rfind("\n", 0, at) + 1 : at]
        return types.Position(line, len(before.encode("utf-16-le")) // 2)

    def read(self, path: Path, range_: types.Range) -> str:
        """The text of a range in UTF-16 units."""
        lines = self.texts[path].split("\n") if path in self.texts else path.read_text().split("\n")
        start, end = (
            sum(len(line) + 1 for line in lines[: at.line])
            + len(lines[at.line].encode("utf-16-le")[: 2 * at.character].decode("utf-16-le"))
            for at in (range_.start, range_.end)
        )
        return "\n".join(lines)[start:end]

    def end(self) -> subprocess.CompletedProcess[bytes]:
        async def leave() -> int:
            await self.client.shutdown_async(None)
            self.client.exit(None)
            return await self.client._server.wait()

        code = self.wait(leave())
        self.wait(self.client.stop())
        self.loop.close()
        return subprocess.CompletedProcess((), code)


def list_children(editor: Editor) -> list[int]:
    """The processes that the server has started."""
    server = editor.client._server.pid
    return [int(word) for word in Path(f"/proc/{server}/task/{server}/children").read_text().split()]
