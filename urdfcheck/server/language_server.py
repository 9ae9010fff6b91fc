"""The language server: what an editor reports and asks, and who answers it."""

from __future__ import annotations

import contextlib
import logging
import os
import sys
from typing import Any

from lsprotocol import types
from pygls import uris
from pygls.lsp.server import LanguageServer

from urdfcheck.run.request import RunOptions
from urdfcheck.server.check_client import CheckClient
from urdfcheck.server.check_schedule import CheckSchedule
from urdfcheck.server.diagnostics import SOURCE, ShownFinding, make_failure_diagnostics, show_findings
from urdfcheck.server.documents import DocumentStore
from urdfcheck.version import __version__

# The command that checks everything, and answers when it is done.
CHECK_COMMAND = "urdfcheck.check"
# Changes of these on the disk are checked: what models are made of, and what decides how they are checked.
WATCHED = "**/*.{urdf,xacro,srdf,xml,launch,py,yaml,yml,toml,stl,STL,dae,DAE,obj,ply,glb,gltf,bin,json}"


class UrdfcheckServer(LanguageServer):
    """The server with its state."""

    def __init__(self, options: RunOptions) -> None:
        super().__init__(SOURCE, f"v{__version__}", text_document_sync_kind=types.TextDocumentSyncKind.Full)
        self.documents = DocumentStore()
        self.client = CheckClient(options)
        self.schedule = CheckSchedule(self.client, self.documents, self.publish)
        self.shown: dict[str, list[ShownFinding]] = {}
        self._published: dict[str, list[types.Diagnostic]] = {}

    def publish(self) -> None:
        """Send the diagnostics of each file for which they differ from those sent before."""
        states = self.schedule.states
        self.shown = show_findings(states, self.documents)
        now = {uri: [finding.diagnostic for finding in findings] for uri, findings in self.shown.items()}
        for uri, failures in make_failure_diagnostics(states[0].answer, self.documents).items() if states else ():
            now[uri] = [*failures, *now.get(uri, [])]
        if self.schedule.problem:
            self.window_log_message(types.LogMessageParams(types.MessageType.Error, self.schedule.problem))
        for uri in {**self._published, **now}:
            diagnostics = now.get(uri, [])
            if self._published.get(uri, []) != diagnostics:
                document = self.documents.by_uri.get(uri)
                self.text_document_publish_diagnostics(
                    types.PublishDiagnosticsParams(uri, diagnostics, None if document is None else document.version)
                )
        self._published = {uri: diagnostics for uri, diagnostics in now.items() if diagnostics}


def make_server(options: RunOptions) -> UrdfcheckServer:
    """Make a server. ``options``: those of the command, which hold for all that is checked."""
    server = UrdfcheckServer(options)
    _add_lifecycle(server)
    _add_document_events(server)
    _add_commands(server)
    return server


def serve(options: RunOptions) -> None:
    """Speak the protocol on standard input and output until the client ends it."""
    # Nothing else may write where the protocol is spoken.
    channel = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    logging.getLogger("pygls").setLevel(logging.ERROR)
    make_server(options).start_io(sys.stdin.buffer, channel)


def _add_lifecycle(server: UrdfcheckServer) -> None:
    @server.feature(types.INITIALIZE)
    def start(params: types.InitializeParams) -> None:
        folders = [folder.uri for folder in params.workspace_folders or ()]
        root = uris.to_fs_path(folders[0] if folders else params.root_uri or "") or params.root_path
        if root is not None and os.path.isdir(root):
            os.chdir(root)  # names in messages are relative to it

    @server.feature(types.INITIALIZED)
    async def prepare(_: types.InitializedParams) -> None:
        server.documents.encoding = server.workspace.position_encoding or server.documents.encoding
        await server.client.start()
        await _watch_files(server)

    @server.feature(types.SHUTDOWN)
    async def end(*_: Any) -> None:
        await server.client.stop()


def _add_commands(server: UrdfcheckServer) -> None:
    @server.command(CHECK_COMMAND)
    async def check() -> None:
        server.schedule.note_save()
        await server.schedule.wait_until_rest()


async def _watch_files(server: UrdfcheckServer) -> None:
    """Ask the editor to tell which files change on the disk, where it can."""
    workspace = server.client_capabilities.workspace
    watching = None if workspace is None else workspace.did_change_watched_files
    if watching is None or not watching.dynamic_registration:
        return
    options = types.DidChangeWatchedFilesRegistrationOptions([types.FileSystemWatcher(WATCHED)])
    registration = types.Registration("watch", types.WORKSPACE_DID_CHANGE_WATCHED_FILES, options)
    with contextlib.suppress(Exception):  # an editor that cannot do what it said it can
        await server.client_register_capability_async(types.RegistrationParams([registration]))


def _add_document_events(server: UrdfcheckServer) -> None:
    documents, schedule = server.documents, server.schedule

    @server.feature(types.TEXT_DOCUMENT_DID_OPEN)
    def open_document(params: types.DidOpenTextDocumentParams) -> None:
        item = params.text_document
        if documents.open(item.uri, item.text, item.version) is not None:
            schedule.note_save()

    @server.feature(types.TEXT_DOCUMENT_DID_CHANGE)
    def change_document(params: types.DidChangeTextDocumentParams) -> None:
        uri = params.text_document.uri
        text = server.workspace.get_text_document(uri).source
        if documents.open(uri, text, params.text_document.version) is not None:
            schedule.note_edit()

    @server.feature(types.TEXT_DOCUMENT_DID_SAVE)
    def save_document(_: types.DidSaveTextDocumentParams) -> None:
        schedule.note_save()

    @server.feature(types.TEXT_DOCUMENT_DID_CLOSE)
    def close_document(params: types.DidCloseTextDocumentParams) -> None:
        if documents.close(params.text_document.uri) is not None:
            schedule.note_save()

    @server.feature(types.WORKSPACE_DID_CHANGE_WATCHED_FILES)
    def note_files(params: types.DidChangeWatchedFilesParams) -> None:
        others = [change for change in params.changes if change.uri not in documents.by_uri]
        if others:
            schedule.note_save(files_differ=any(c.type != types.FileChangeType.Changed for c in others))
