"""Findings as an editor shows them."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import field
from pathlib import Path

from lsprotocol import types
from pygls import uris

from urdfcheck.core import Finding, Location, Severity, Span
from urdfcheck.core.findings import iter_occurrences
from urdfcheck.core.records import dataclass
from urdfcheck.rules import find_page
from urdfcheck.server.check_messages import CheckAnswer
from urdfcheck.server.documents import DocumentStore, TextPositions, TextShift

SOURCE = "urdfcheck"
_SEVERITIES = {
    Severity.ERROR: types.DiagnosticSeverity.Error,
    Severity.WARNING: types.DiagnosticSeverity.Warning,
    Severity.INFO: types.DiagnosticSeverity.Information,
}
# What editors draw faded, and struck through.
_UNUSED = frozenset({"XAC002", "XAC003", "XAC004", "LCH004"})
_DEPRECATED = frozenset({"XAC006", "XAC014", "LCH003"})


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ShownFinding:
    """A finding at one of its places, as it is shown."""

    finding: Finding
    """That of this place."""
    range: types.Range
    diagnostic: types.Diagnostic
    state: CheckedState
    """The outcome that has it."""


@dataclass(slots=True, kw_only=True)
class CheckedState:
    """The outcome of a job, and the texts of the open documents that it is about, by real path."""

    answer: CheckAnswer
    texts: Mapping[str, str]
    shifts: dict[str, TextShift] = field(default_factory=dict)
    """From these texts to the present ones, by real path."""

    def renew_shifts(self, documents: DocumentStore) -> None:
        """Compare the texts with the present ones."""
        self.shifts = {
            document.real: TextShift(self.texts[document.real], document.text)
            for document in documents.by_uri.values()
            if document.real in self.texts
        }

    def move_span(self, span: Span) -> tuple[int, int] | None:
        """Return the offsets of a span in the present text of its file; None where it was edited."""
        shift = self.shifts.get(os.path.realpath(span.file))
        if shift is not None:
            return shift.move(span.start, span.end)
        return span.start, span.end


def show_findings(states: Iterable[CheckedState], documents: DocumentStore) -> dict[str, list[ShownFinding]]:
    """Return what is shown, by the address of the file.

    ``states``: the latest outcome first; of an older one only what the latest did not compute: findings of the rules that need
    meshes or motion, as far as their text was not edited.
    """
    shown: dict[str, list[ShownFinding]] = {}
    seen: set[tuple[str, str, str, int, int]] = set()
    for age, state in enumerate(states):
        state.renew_shifts(documents)
        positions: dict[str, TextPositions | None] = {}
        for project in state.answer.projects:
            for finding, place in _iter_places(project.findings):
                if age and finding.code not in state.answer.deep_codes:
                    continue
                name, offsets = _find_place(finding, place, project.model_paths, state)
                if offsets is None:
                    continue
                if name not in positions:
                    positions[name] = documents.find_text(name)
                range_ = _make_range(place.span, offsets, positions[name], documents)
                uri = documents.find_uri(name)
                diagnostic = _make_diagnostic(finding, place, range_, documents)
                key = (uri, finding.code, diagnostic.message, *offsets)
                if key not in seen:  # two projects may read one file
                    seen.add(key)
                    shown.setdefault(uri, []).append(
                        ShownFinding(finding=finding, range=range_, diagnostic=diagnostic, state=state)
                    )
    return shown


def _iter_places(findings: Iterable[Finding]) -> Iterator[tuple[Finding, Location]]:
    """Yield each finding with each place of an element that it is about: of seven links that are wrong alike, each shows it."""
    for finding in iter_occurrences(findings):
        yield finding, finding.location
        subjects, shown = set(finding.subjects), {finding.location.span}
        for place in finding.related:
            if place.subject in subjects and place.span is not None and place.span not in shown:
                shown.add(place.span)
                yield finding, place


def _make_range(
    span: Span | None, offsets: tuple[int, int], positions: TextPositions | None, documents: DocumentStore
) -> types.Range:
    if positions is not None:
        return positions.make_range(*offsets)
    nowhere = types.Position(0, 0)
    return types.Range(nowhere, nowhere) if span is None else documents.locate(span).range


def _find_place(
    finding: Finding, place: Location, model_paths: Mapping[str, str], state: CheckedState
) -> tuple[str, tuple[int, int] | None]:
    """Return the file of a place of a finding, and its offsets there; none where the text was edited since.

    One without a place is shown at the beginning of its model.
    """
    span = place.span
    if span is None:
        return model_paths.get(finding.model, finding.model), (0, 0)
    return span.file, state.move_span(span)


def _make_diagnostic(
    finding: Finding, place: Location, range_: types.Range, documents: DocumentStore
) -> types.Diagnostic:
    tags = [types.DiagnosticTag.Unnecessary] if finding.code in _UNUSED else []
    tags += [types.DiagnosticTag.Deprecated] if finding.code in _DEPRECATED else []
    page = find_page(finding.code)
    related = list(_iter_related(finding, place, documents))
    return types.Diagnostic(
        range=range_,
        message=finding.headline,  # a hover has the evidence
        severity=_SEVERITIES[finding.severity],
        code=finding.code,
        code_description=None if page is None else types.CodeDescription(uris.from_fs_path(str(page)) or ""),
        source=SOURCE,
        tags=tags or None,
        related_information=related or None,
    )


def _iter_related(
    finding: Finding, shown: Location, documents: DocumentStore
) -> Iterator[types.DiagnosticRelatedInformation]:
    """Yield the calls that brought the text in, innermost first, then the other places: of like elements, and of definitions that
    the value was computed from."""
    for call in reversed(shown.via):
        yield _make_related(Location("", call), "is brought in here", documents)
    for place in (finding.location, *finding.related):
        if place.span is not None and place.span != shown.span:
            yield _make_related(place, place.subject, documents)


def _make_related(place: Location, text: str, documents: DocumentStore) -> types.DiagnosticRelatedInformation:
    assert place.span is not None  # of a call or a definition that was typed
    return types.DiagnosticRelatedInformation(documents.locate(place.span), text)


def make_failure_diagnostics(answer: CheckAnswer, documents: DocumentStore) -> dict[str, list[types.Diagnostic]]:
    """Return what urdfcheck itself could not do, at the beginning of each open document of the project."""
    shown: dict[str, list[types.Diagnostic]] = {}
    nowhere = types.Range(types.Position(0, 0), types.Position(0, 0))
    for project in answer.projects:
        for document in documents.by_uri.values():
            if (
                Path(project.folder) in Path(document.real).parents
                or Path(project.folder) in Path(document.path).parents
            ):
                shown[document.uri] = [
                    types.Diagnostic(
                        range=nowhere, message=failure, severity=types.DiagnosticSeverity.Error, source=SOURCE
                    )
                    for failure in project.failures
                ]
    return shown
