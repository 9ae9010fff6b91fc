"""What an editor can do about a finding: repair it, suppress it, read its rule; and repair all that is safe to repair."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from lsprotocol import types

from urdfcheck.core import Applicability, Edit, Fix
from urdfcheck.fix.patch import EditableFiles, EditRefusedError
from urdfcheck.server.check_messages import CheckAnswer
from urdfcheck.server.check_schedule import is_checked
from urdfcheck.server.diagnostics import SOURCE, CheckedState, ShownFinding
from urdfcheck.server.documents import DocumentStore, OpenDocument, TextPositions, iter_differences, make_workspace_edit
from urdfcheck.server.report.commands import make_view_command
from urdfcheck.source.text.suppression_comments import MARK
from urdfcheck.source.text.xml import SourceFile
from urdfcheck.system.files import overlay_files

Action = types.CodeAction | types.Command
FIX_ALL = f"{types.CodeActionKind.SourceFixAll.value}.{SOURCE}"
# The command that shows the page of a rule.
OPEN_RULE = "urdfcheck.openRule"
_TAG = re.compile(r"<(?![/!?])[^<>]*", re.DOTALL)
_COMMENT = re.compile(r"<!--.*?(?:-->|\Z)|<!\[CDATA\[.*?(?:\]\]>|\Z)", re.DOTALL)
_HASH_SUFFIXES = (".yaml", ".yml", ".py", ".txt")


def list_actions(
    document: OpenDocument,
    range_: types.Range,
    shown: Iterable[ShownFinding],
    documents: DocumentStore,
) -> list[Action]:
    """Return what can be done about the findings in a range: repairs first, those that may change the meaning last of them."""
    findings = [found for found in shown if found.range.start <= range_.end and range_.start <= found.range.end]
    repairs: list[types.CodeAction] = []
    others: list[Action] = []
    for found in findings:
        repair = _make_repair(found, documents)
        repairs += [] if repair is None else [repair]
        others += _iter_suppressions(found, document, documents)
        others.append(_make_rule_command(found))
        if is_checked(document):
            others.append(make_view_command(found, document.uri))
    repairs.sort(key=lambda action: not action.is_preferred)
    return [*repairs, *_drop_repeated(others)]


def _drop_repeated(actions: Iterable[Action]) -> list[Action]:
    return list({action.title: action for action in actions}.values())


# -- repairs -----------------------------------------------------------------------------------------------------------


def _make_repair(found: ShownFinding, documents: DocumentStore) -> types.CodeAction | None:
    """Return the edit that repairs a finding; None if it has none, or the text has changed too much since."""
    fix = found.finding.fix
    if fix is None or not fix.edits:
        return None
    edits = _build_edits(fix, found.state, documents)
    if edits is None:
        return None
    is_safe = fix.applicability is Applicability.SAFE
    title = fix.title if is_safe else f"{fix.title} (may change the meaning)"
    return types.CodeAction(
        title=f"{found.finding.code}: {title}",
        kind=types.CodeActionKind.QuickFix,
        diagnostics=[found.diagnostic],
        is_preferred=is_safe,
        edit=make_workspace_edit(edits, documents),
    )


def _build_edits(fix: Fix, state: CheckedState, documents: DocumentStore) -> list[tuple[str, types.TextEdit]] | None:
    """Return the edits of a fix in the present texts; None if a text is not the one that the finding was about."""
    made = []
    editable = EditableFiles([Path(d.path) for d in documents.by_uri.values()], [], are_written=False)
    for edit in fix.edits:
        positions = documents.find_text(edit.span.file)
        place = state.move_span(edit.span)
        if positions is None or place is None or positions.text[place[0] : place[1]] != edit.expected:
            return None
        try:
            editable.ensure_editable(Path(edit.span.file))
        except EditRefusedError:
            return None
        made.append((edit.span.file, types.TextEdit(positions.make_range(*place), _adapt_breaks(edit, positions))))
    return made


def _adapt_breaks(edit: Edit, positions: TextPositions) -> str:
    """Return the new text of an edit with the line breaks of its file."""
    newline = "\r\n" if "\r\n" in positions.text else "\n"
    return edit.replacement.replace("\r\n", "\n").replace("\n", newline)


def make_fix_all(answer: CheckAnswer, documents: DocumentStore) -> types.CodeAction | None:
    """Return the edit of all safe fixes, which were checked again together; None where there is none."""
    edits: list[tuple[str, types.TextEdit]] = []
    for path, (before, after) in answer.changes.items():
        positions = documents.find_text(path)
        old, new = _decode(path, before), _decode(path, after)
        if positions is None or positions.text != old:  # it was edited meanwhile
            return None
        edits += [(path, edit) for edit in iter_differences(positions, new)]
    if not edits:
        return None
    count = f"{answer.fixed} finding{'' if answer.fixed == 1 else 's'}"
    return types.CodeAction(
        title=f"Apply all safe fixes ({count})",
        kind=FIX_ALL,
        edit=make_workspace_edit(edits, documents),
    )


def _decode(path: str, data: bytes) -> str:
    with overlay_files({os.path.realpath(path): data}):
        return SourceFile.read(Path(path), path).text


# -- suppression, and the rule -----------------------------------------------------------------------------------------


def _iter_suppressions(
    found: ShownFinding, document: OpenDocument, documents: DocumentStore
) -> Iterator[types.CodeAction]:
    """Yield the action that writes a comment before the element; the author adds the reason, without which it has no effect."""
    finding = found.finding
    if finding.is_about_urdfcheck or finding.blocks_check:
        return
    positions = TextPositions(document.text, documents.encoding)
    offset = positions.find_offset(found.range.start)
    newline = "\r\n" if "\r\n" in document.text else "\n"
    mark = f"{MARK}ignore[{finding.code}] "
    if document.path.endswith(_HASH_SUFFIXES):
        place = _find_line_start(document.text, offset)
        rest = document.text[place:]
        text = f"{rest[: len(rest) - len(rest.lstrip(' '))]}# {mark}{newline}"
    else:
        start = _find_element_start(document.text, offset)
        if start is None:
            return
        place = start
        before = document.text[_find_line_start(document.text, place) : place]
        text = f"<!-- {mark} -->{' ' if before.strip() else newline + before}"
    edit = types.TextEdit(positions.make_range(place, place), text)
    yield types.CodeAction(
        title=f"Suppress {finding.code} here: add the reason to the comment",
        kind=types.CodeActionKind.QuickFix,
        diagnostics=[found.diagnostic],
        edit=make_workspace_edit([(document.path, edit)], documents),
    )


def _find_line_start(text: str, offset: int) -> int:
    return max(text.rfind("\n", 0, offset), text.rfind("\r", 0, offset)) + 1


def _find_element_start(text: str, offset: int) -> int | None:
    """Return the offset of the start tag that an offset is in, or else of the last one before it."""
    comments = [match.span() for match in _COMMENT.finditer(text)]
    starts = [
        match.start()
        for match in _TAG.finditer(text, 0, offset + 1)
        if not any(start <= match.start() < end for start, end in comments)
    ]
    return starts[-1] if starts else None


def _make_rule_command(found: ShownFinding) -> types.Command:
    title = f"Open the page of {found.finding.code} {found.finding.name}"
    return types.Command(title, OPEN_RULE, arguments=[found.finding.code])
