"""One client for every server: it opens and changes documents, and keeps what is published about them."""

from __future__ import annotations

import asyncio
import contextlib
import os
from collections.abc import AsyncIterator, Callable
from pathlib import Path

from lsprotocol import types
from pygls.lsp.client import LanguageClient
from servers import Server

# Seconds after which a server that does not end is left.
LIMIT = 240.0


class Session:
    """A server at work in a folder: `start_session`."""

    def __init__(self, server: Server, folder: Path) -> None:
        self.server = server
        self.folder = folder
        self.diagnostics: dict[str, list[types.Diagnostic]] = {}
        """What is shown, by the address of the file."""
        self._versions: dict[Path, int] = {}
        self._ended: set[str] = set()
        self._news = asyncio.Event()
        self._client = LanguageClient("benchmark", "1")
        self._listen()

    @property
    def process(self) -> int:
        """The id of the server's process."""
        return int(self._client._server.pid)

    async def start(self) -> None:
        """Start the server and tell it which folder is open."""
        # As in an activated environment: a server may call commands that were installed with it.
        path = f"{Path(self.server.command[0]).parent}{os.pathsep}{os.environ['PATH']}"
        await self._client.start_io(*self.server.command, env={**os.environ, "PATH": path})
        await self._client.initialize_async(
            types.InitializeParams(
                capabilities=types.ClientCapabilities(),
                process_id=os.getpid(),
                root_uri=self.folder.as_uri(),
                workspace_folders=[types.WorkspaceFolder(self.folder.as_uri(), self.folder.name)],
                initialization_options=dict(self.server.options),
            )
        )
        self._client.initialized(types.InitializedParams())

    async def end(self) -> None:
        """End the server."""
        await self._client.shutdown_async(None)
        self._client.exit(None)
        await self._client.stop()

    def open(self, path: Path, text: str) -> None:
        """Open a document."""
        self._versions[path] = 1
        self._ended.clear()
        self._client.text_document_did_open(
            types.DidOpenTextDocumentParams(types.TextDocumentItem(path.as_uri(), "xml", 1, text))
        )

    def change(self, path: Path, text: str) -> None:
        """Replace the text of an open document."""
        self._versions[path] += 1
        self._ended.clear()
        document = types.VersionedTextDocumentIdentifier(self._versions[path], path.as_uri())
        change = types.TextDocumentContentChangeWholeDocument(text)
        self._client.text_document_did_change(types.DidChangeTextDocumentParams(document, [change]))

    async def rest(self, path: Path) -> None:
        """Wait until a document is checked.

        :raises TimeoutError: if the server does not end in `LIMIT`.
        """
        if self.server.end_command:
            command = types.ExecuteCommandParams(self.server.end_command)
            await asyncio.wait_for(self._client.workspace_execute_command_async(command), LIMIT)
        else:
            await self.wait_until(lambda: path.as_uri() in self._ended)

    async def wait_until(self, is_reached: Callable[[], bool]) -> None:
        """Wait until what the server has sent fulfils a condition.

        :raises TimeoutError: if it does not in `LIMIT`.
        """

        async def wait() -> None:
            while not is_reached():
                self._news.clear()
                await self._news.wait()

        await asyncio.wait_for(wait(), LIMIT)

    def _listen(self) -> None:
        @self._client.feature(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
        def take_diagnostics(sent: types.PublishDiagnosticsParams) -> None:
            self.diagnostics[sent.uri] = list(sent.diagnostics)
            self._news.set()

        @self._client.feature(types.WINDOW_LOG_MESSAGE)
        def take_log(sent: types.LogMessageParams) -> None:
            self._ended.add(sent.message.partition(": ")[0])
            self._news.set()


@contextlib.asynccontextmanager
async def start_session(server: Server, folder: Path) -> AsyncIterator[Session]:
    """Start a server in a folder; it ends with the block."""
    session = Session(server, folder)
    await session.start()
    try:
        yield session
    finally:
        await session.end()
