"""The commands with which an editor shows the report: beside the text, following the cursor, or in a browser."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from lsprotocol import types
from pygls.capabilities import get_capability
from pygls.lsp.server import LanguageServer

from urdfcheck.server.check_client import CheckProcessError
from urdfcheck.server.check_schedule import CheckSchedule, is_checked
from urdfcheck.server.diagnostics import ShownFinding, show_findings
from urdfcheck.server.documents import DocumentStore
from urdfcheck.server.report.report_files import write_report
from urdfcheck.server.report.selection import count_findings, find_selection, get_card_id

# Shows the report of an open document in a browser, at a finding. An editor with a place of its own for it answers it itself.
SHOW_REPORT = "urdfcheck.showReport"
# Answer where the report is, what of it a position is about, and the counts of the findings once everything is checked.
WRITE_REPORT, FIND_SELECTION, AWAIT_VERDICT = (
    "urdfcheck.writeReport",
    "urdfcheck.findSelection",
    "urdfcheck.awaitVerdict",
)
_CARD = re.compile(r"f-[0-9A-Za-z-]+")


def make_view_command(found: ShownFinding, uri: str) -> types.Command:
    """Return the action that shows a finding of a document in 3D."""
    return types.Command(f"Show {found.finding.code} in 3D", SHOW_REPORT, arguments=[uri, get_card_id(found)])


def add_report_commands(server: LanguageServer, schedule: CheckSchedule, documents: DocumentStore) -> None:
    """Add the commands to a server."""

    async def write(uri: str) -> Path | None:
        """Return where the report on a document is; None if there is none, after saying why."""
        document = documents.by_uri.get(uri)
        if document is None or not is_checked(document):
            reason = "There is a report on robots and launch files that are open"
        else:
            try:
                return write_report(document.real, await schedule.make_report(document))
            except (CheckProcessError, OSError) as error:
                reason = f"There is no report: {error}"
        server.window_show_message(types.ShowMessageParams(types.MessageType.Error, reason))
        return None

    @server.command(WRITE_REPORT)
    async def write_one(uri: str) -> str | None:
        path = await write(uri)
        return None if path is None else str(path)

    @server.command(SHOW_REPORT)
    async def show(uri: str, card: str = "") -> None:
        path = await write(uri)
        if path is None:
            return
        if get_capability(server.client_capabilities, "window.show_document.support"):
            anchor = f"#{card}" if _CARD.fullmatch(card) else ""
            with contextlib.suppress(Exception):  # an editor that cannot do what it said it can
                params = types.ShowDocumentParams(f"{path.as_uri()}{anchor}", external=True)
                if (await server.window_show_document_async(params)).success:
                    return
        server.window_show_message(types.ShowMessageParams(types.MessageType.Info, f"The report: {path}"))

    @server.command(FIND_SELECTION)
    async def select(uri: str, line: int, character: int) -> dict[str, str]:
        document = documents.by_uri.get(uri)
        if document is None:
            return {}
        shown = show_findings(schedule.states, documents).get(uri, [])
        return find_selection(document, types.Position(line, character), shown, schedule.indexes, documents)

    @server.command(AWAIT_VERDICT)
    async def await_verdict(uri: str) -> dict[str, Any] | None:
        await schedule.wait_until_rest()
        document = documents.by_uri.get(uri)
        state = schedule.complete
        if document is None or not is_checked(document) or state is None:
            return None
        shown: Mapping[str, Sequence[ShownFinding]] = show_findings(schedule.states, documents)
        counts = count_findings(document, shown, schedule.indexes)
        failures = [failure for project in state.answer.projects for failure in project.failures]
        return {
            **{severity: counts[severity] for severity in ("error", "warning", "info")},
            "failures": [*failures, *filter(None, [schedule.problem])],
            "state": state.answer.number,
        }
