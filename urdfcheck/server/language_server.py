"""The language server: what an editor reports and asks, and who answers it."""

from __future__ import annotations

import contextlib
import logging
import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from lsprotocol import types
from pygls import uris
from pygls.capabilities import get_capability
from pygls.exceptions import JsonRpcException
from pygls.lsp.server import LanguageServer

from urdfcheck.core import Applicability
from urdfcheck.rules import find_page
from urdfcheck.run.request import RunOptions
from urdfcheck.server.accepted_findings import list_acceptances
from urdfcheck.server.check_client import CheckClient, CheckProcessError
from urdfcheck.server.check_messages import RenameWish
from urdfcheck.server.check_schedule import CheckSchedule
from urdfcheck.server.code_actions import FIX_ALL, OPEN_RULE, Action, list_actions, make_fix_all
from urdfcheck.server.code_lenses import list_code_lenses
from urdfcheck.server.completion import TRIGGERS, complete
from urdfcheck.server.diagnostics import SOURCE, ShownFinding, make_failure_diagnostics, show_findings
from urdfcheck.server.documents import DocumentStore, OpenDocument, TextPositions
from urdfcheck.server.hover import describe_position
from urdfcheck.server.names.navigation import find_definitions, find_references
from urdfcheck.server.names.rename_answers import (
    describe_doubtful_names,
    describe_untried_models,
    make_rename_edit,
    prepare_rename,
)
from urdfcheck.server.names.rename_plan import RenameRefusedError
from urdfcheck.server.report.commands import add_report_commands
from urdfcheck.server.symbols import list_folding_ranges, list_inlay_hints, list_symbols
from urdfcheck.version import __version__

# The command that checks everything, and answers when it is done.
CHECK_COMMAND = "urdfcheck.check"
_CODE = re.compile(r"[A-Z]{3}\d{3}")
# Changes of these on the disk are checked: what models are made of, and what decides how they are checked.
WATCHED = "**/*.{urdf,xacro,srdf,xml,launch,py,yaml,yml,toml,stl,STL,dae,DAE,obj,ply,glb,gltf,bin,json}"


class UrdfcheckServer(LanguageServer):
    """The server with its state."""

    def __init__(self, options: RunOptions) -> None:
        super().__init__(SOURCE, f"v{__version__}", text_document_sync_kind=types.TextDocumentSyncKind.Full)
        named = (*options.packages.values(), *options.package_paths, *options.allow_read)
        self.documents = DocumentStore(map(Path, named))
        self.client = CheckClient(options)
        self.schedule = CheckSchedule(self.client, self.documents, self.publish)
        self._published: dict[str, list[types.Diagnostic]] = {}

    def find_shown(self, uri: str) -> list[ShownFinding]:
        """Return the findings that a document has, at their present places."""
        return show_findings(self.schedule.states, self.documents).get(uri, [])

    async def find_place(
        self, asked: types.TextDocumentIdentifier, position: types.Position
    ) -> tuple[OpenDocument, int] | None:
        """Return the document and the offset of a question; None where the document is not open."""
        document = self.documents.by_uri.get(asked.uri)
        if document is None:
            return None
        await self.schedule.wait_until_known(document)
        document = self.documents.by_uri.get(asked.uri, document)
        return document, TextPositions(document.text, self.documents.encoding).find_offset(position)

    def publish(self) -> None:
        """Send the diagnostics of each file for which they differ from those sent before."""
        states = self.schedule.states
        shown = show_findings(states, self.documents)
        now = {uri: [finding.diagnostic for finding in findings] for uri, findings in shown.items()}
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
        if get_capability(self.client_capabilities, "workspace.inlay_hint.refresh_support"):
            self.workspace_inlay_hint_refresh(None)
        if get_capability(self.client_capabilities, "workspace.code_lens.refresh_support"):
            self.workspace_code_lens_refresh(None)


def make_server(options: RunOptions) -> UrdfcheckServer:
    """Make a server. ``options``: those of the command, which hold for all that is checked."""
    server = UrdfcheckServer(options)
    _add_lifecycle(server)
    _add_document_events(server)
    _add_questions(server)
    _add_renaming(server)
    _add_actions(server)
    _add_commands(server)
    add_report_commands(server, server.schedule, server.documents)
    return server


def serve(options: RunOptions) -> None:
    """Speak the protocol on standard input and output until the client ends it."""
    # Nothing else may write where the protocol is spoken.
    channel = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    logging.getLogger("pygls").setLevel(logging.ERROR)
    logging.getLogger("pygls.protocol.json_rpc").addFilter(_is_defect)
    make_server(options).start_io(sys.stdin.buffer, channel)


def _is_defect(record: logging.LogRecord) -> bool:
    """Whether a record of the library is about anything else than a refusal, which is an answer."""
    error = record.exc_info[1] if record.exc_info else None
    return not (isinstance(error, JsonRpcException) and error.code == types.LSPErrorCodes.RequestFailed.value)


def _add_lifecycle(server: UrdfcheckServer) -> None:
    @server.feature(types.INITIALIZE)
    def start(params: types.InitializeParams) -> None:
        folders = [folder.uri for folder in params.workspace_folders or ()]
        root = uris.to_fs_path(folders[0] if folders else params.root_uri or "") or params.root_path
        if root is not None and os.path.isdir(root):
            os.chdir(root)  # names in messages are relative to it

    @server.feature(types.INITIALIZED)
    async def prepare(_: types.InitializedParams) -> None:
        documents, capabilities = server.documents, server.client_capabilities
        documents.encoding = server.workspace.position_encoding or documents.encoding
        can = get_capability(capabilities, "workspace.workspace_edit.document_changes")
        documents.has_versioned_edits = bool(can)
        made = get_capability(capabilities, "workspace.workspace_edit.resource_operations") or ()
        documents.can_create_files = documents.has_versioned_edits and types.ResourceOperationKind.Create in made
        await server.client.start()
        await _watch_files(server)

    @server.feature(types.SHUTDOWN)
    async def end(*_: Any) -> None:
        await server.client.end()


def _add_questions(server: UrdfcheckServer) -> None:
    documents, indexes, find_place = server.documents, server.schedule.indexes, server.find_place

    @server.feature(types.TEXT_DOCUMENT_HOVER)
    async def hover(params: types.HoverParams) -> types.Hover | None:
        place = await find_place(params.text_document, params.position)
        if place is None:
            return None
        shown = server.find_shown(place[0].uri)
        return describe_position(place[0], params.position, indexes, documents, shown)

    @server.feature(types.TEXT_DOCUMENT_DEFINITION)
    async def define(params: types.DefinitionParams) -> list[types.Location]:
        place = await find_place(params.text_document, params.position)
        return [] if place is None else find_definitions(indexes, documents, *place)

    @server.feature(types.TEXT_DOCUMENT_REFERENCES)
    async def refer(params: types.ReferenceParams) -> list[types.Location]:
        place = await find_place(params.text_document, params.position)
        with_definitions = params.context.include_declaration
        return [] if place is None else find_references(indexes, documents, *place, with_definitions=with_definitions)

    @server.feature(types.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
    async def outline(params: types.DocumentSymbolParams) -> list[types.DocumentSymbol]:
        place = await find_place(params.text_document, types.Position(0, 0))
        return [] if place is None else list_symbols(place[0], indexes, documents)

    @server.feature(types.TEXT_DOCUMENT_COMPLETION, types.CompletionOptions(list(TRIGGERS)))
    async def suggest(params: types.CompletionParams) -> list[types.CompletionItem]:
        place = await find_place(params.text_document, params.position)
        return [] if place is None else complete(*place, indexes, documents)

    @server.feature(types.TEXT_DOCUMENT_FOLDING_RANGE)
    def fold(params: types.FoldingRangeParams) -> list[types.FoldingRange] | None:
        document = documents.by_uri.get(params.text_document.uri)
        return None if document is None else list_folding_ranges(document, documents)

    @server.feature(types.TEXT_DOCUMENT_CODE_LENS)
    async def count(params: types.CodeLensParams) -> list[types.CodeLens]:
        place = await find_place(params.text_document, types.Position(0, 0))
        shown = show_findings(server.schedule.states, documents)
        return [] if place is None else list_code_lenses(place[0], indexes, documents, shown)

    @server.feature(types.TEXT_DOCUMENT_INLAY_HINT)
    async def hint(params: types.InlayHintParams) -> list[types.InlayHint]:
        place = await find_place(params.text_document, params.range.start)
        return [] if place is None else list_inlay_hints(place[0], params.range, indexes, documents)


def _add_renaming(server: UrdfcheckServer) -> None:
    documents, schedule = server.documents, server.schedule

    @server.feature(types.TEXT_DOCUMENT_PREPARE_RENAME)
    async def prepare(params: types.PrepareRenameParams) -> types.PrepareRenamePlaceholder | None:
        place = await server.find_place(params.text_document, params.position)
        with _refuse_politely():
            return None if place is None else prepare_rename(*place, schedule.indexes, documents)

    @server.feature(types.TEXT_DOCUMENT_RENAME, types.RenameOptions(prepare_provider=True))
    async def rename(params: types.RenameParams) -> types.WorkspaceEdit | None:
        document = documents.by_uri.get(params.text_document.uri)
        if document is None:
            return None
        offset = TextPositions(document.text, documents.encoding).find_offset(params.position)
        with _refuse_politely():
            answer = await schedule.find_rename(RenameWish(path=document.real, offset=offset, text=params.new_name))
            if answer.refusal or answer.is_cancelled:
                raise RenameRefusedError(answer.refusal or "The text was changed meanwhile: try again.")
            edit = make_rename_edit(answer.edits, documents)
            text = " ".join((*describe_untried_models(answer.untried), *describe_doubtful_names(answer.doubtful)))
            if text:
                server.window_show_message(types.ShowMessageParams(types.MessageType.Warning, text))
            return edit


@contextlib.contextmanager
def _refuse_politely() -> Iterator[None]:
    """Answer a refusal as the protocol does: the editor shows its text."""
    try:
        yield
    except (RenameRefusedError, CheckProcessError) as refusal:
        raise JsonRpcException(str(refusal), types.LSPErrorCodes.RequestFailed.value) from None


def _add_actions(server: UrdfcheckServer) -> None:
    kinds: list[types.CodeActionKind | str] = [types.CodeActionKind.QuickFix, FIX_ALL]

    async def find_fix_all(document: OpenDocument) -> types.CodeAction | None:
        with contextlib.suppress(CheckProcessError):
            return make_fix_all(await server.schedule.find_fixes(document), server.documents)
        return None

    @server.feature(types.TEXT_DOCUMENT_CODE_ACTION, types.CodeActionOptions(kinds, resolve_provider=True))
    async def act(params: types.CodeActionParams) -> list[Action]:
        document = server.documents.by_uri.get(params.text_document.uri)
        if document is None:
            return []
        only = [str(getattr(kind, "value", kind)) for kind in params.context.only or ()]
        actions: list[Action] = []
        if _wants(only, types.CodeActionKind.QuickFix.value):
            shown = server.find_shown(document.uri)
            actions += list_actions(document, params.range, shown, server.documents)
            actions += list_acceptances(params.range, shown, server.documents)
        if only and _wants(only, FIX_ALL):
            await server.schedule.wait_until_known(document)
            whole = await find_fix_all(document)
            actions += [] if whole is None else [whole]
        elif any(_is_safe(found) for found in server.find_shown(document.uri)) and _can_resolve(server):
            actions.append(types.CodeAction("Apply all safe fixes", kind=FIX_ALL, data=document.uri))
        return actions

    @server.feature(types.CODE_ACTION_RESOLVE)
    async def resolve(action: types.CodeAction) -> types.CodeAction:
        document = server.documents.by_uri.get(str(action.data))
        whole = None if document is None else await find_fix_all(document)
        action.edit = types.WorkspaceEdit() if whole is None else whole.edit
        return action


def _wants(only: list[str], kind: str) -> bool:
    """Whether an editor that asks for some kinds of actions asks for one, by itself or by a part of its name."""
    return not only or any(kind == asked or kind.startswith(f"{asked}.") for asked in only)


def _is_safe(found: ShownFinding) -> bool:
    fix = found.finding.fix
    return fix is not None and bool(fix.edits) and fix.applicability is Applicability.SAFE


def _can_resolve(server: UrdfcheckServer) -> bool:
    support = get_capability(server.client_capabilities, "text_document.code_action.resolve_support.properties") or ()
    return "edit" in support


def _add_commands(server: UrdfcheckServer) -> None:
    @server.command(CHECK_COMMAND)
    async def check() -> None:
        server.schedule.note_save()
        await server.schedule.wait_until_rest()

    @server.command(OPEN_RULE)
    async def open_rule(code: str) -> None:
        page = find_page(code) if _CODE.fullmatch(code) else None
        if page is None:
            return
        if get_capability(server.client_capabilities, "window.show_document.support"):
            uri = uris.from_fs_path(str(page)) or ""
            await server.window_show_document_async(types.ShowDocumentParams(uri, take_focus=True))
        else:
            text = f"urdfcheck rule {code} explains it: {page}"
            server.window_show_message(types.ShowMessageParams(types.MessageType.Info, text))


async def _watch_files(server: UrdfcheckServer) -> None:
    """Ask the editor to tell which files change on the disk, where it can."""
    if not get_capability(server.client_capabilities, "workspace.did_change_watched_files.dynamic_registration"):
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
