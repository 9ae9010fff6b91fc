"""The edits of findings, applied to a model's files and checked again.

Nothing is written before everything was checked: the edits are made in memory, and the workers read the edited text instead
of the files (`urdfcheck.system.files.overlay_files`). So nothing is rolled back on the disk, an interrupt leaves every file
unchanged, ``--diff`` shows what ``--fix`` does because it does the same, and other programs never see a half changed model.
At the end new files replace the old ones (`urdfcheck.fix.patch.write_files`).

Fixes that do not overlap are tried together. If that makes anything worse they are tried in halves, so that only the single
fix at fault is left out. It is tried once more after others were applied, and fixes that overlap come in the next round, until
a round changes nothing: then a second run would not either.
"""

from __future__ import annotations

import contextlib
from bisect import bisect_left, bisect_right, insort
from collections.abc import Callable, Container, Iterable, Iterator, Mapping
from dataclasses import field, replace
from itertools import pairwise
from pathlib import Path
from typing import Protocol, TypeVar

from urdfcheck.core import Applicability, Edit, Finding, Fix, Run
from urdfcheck.core.findings import iter_occurrences
from urdfcheck.core.records import dataclass
from urdfcheck.fix.patch import EditableFiles, EditableText, EditRefusedError
from urdfcheck.fix.regression import FILE_FAMILY, find_regression
from urdfcheck.run.jobs import Request
from urdfcheck.run.pipeline import IN_WORKERS, AuditedRun, Execution, run_audit

# Each round is another check, and applies one of several fixes that overlap.
MAX_ROUNDS = 10


@dataclass(frozen=True, slots=True, kw_only=True)
class FixResult:
    """The outcome of fixing."""

    outcome: Run
    """The run with the findings that remain."""
    fixed: tuple[Finding, ...] = ()
    refused: tuple[tuple[Finding, str], ...] = ()
    """Findings whose fix is not applied, and why."""
    unsafe_count: int = 0
    """Number of remaining findings that an unsafe fix would repair."""
    changes: Mapping[str, tuple[bytes, bytes]] = field(default_factory=dict)
    """Real path → content before and after."""


def compute_fixes(
    request: Request,
    execution: Execution = IN_WORKERS,
    *,
    include_unsafe: bool = False,
    are_only_shown: bool = False,
    accepts: Callable[[Finding], bool] = lambda _: True,
) -> FixResult:
    """Check, and compute the content of the files after the safe fixes, and with ``include_unsafe`` all. No file is changed.

    ``are_only_shown``: no file will be, so that those that cannot be written have fixes as well. ``accepts``: which findings
    are fixed, place by place.

    :raises KeyboardInterrupt: if a check of edited files was interrupted.
    """
    state = run_audit(request, execution)
    editable = EditableFiles(request.paths, _list_package_folders(state), are_written=not are_only_shown)
    fixer = _Fixer(editable, Execution(audit=execution.audit), include_unsafe=include_unsafe, accepts=accepts)
    if not state.outcome.partial:
        for _ in range(MAX_ROUNDS):
            before, state = state, fixer.run_round(state)
            if state is before:
                break
    return FixResult(
        outcome=fixer.hide_refused_fixes(state.outcome),
        fixed=tuple(fixer.fixed),
        refused=tuple(fixer.refused),
        unsafe_count=0 if include_unsafe else fixer.count_unsafe_fixes(state),
        changes={
            path: (original, state.request.options.texts[path])
            for path, original in fixer.originals.items()
            if state.request.options.texts.get(path, original) != original
        },
    )


@dataclass(frozen=True, slots=True, eq=False)
class _FixGroup:
    """Edits that belong together, with real paths in their spans.

    They repair one finding of each model that the text is part of.
    """

    edits: tuple[Edit, ...]
    findings: tuple[Finding, ...]


class _Fixer:
    def __init__(
        self, editable: EditableFiles, execution: Execution, *, include_unsafe: bool, accepts: Callable[[Finding], bool]
    ) -> None:
        self.accepts = accepts
        self.wanted = {Applicability.SAFE, Applicability.UNSAFE} if include_unsafe else {Applicability.SAFE}
        self.execution = execution
        self.editable = editable
        self.originals: dict[str, bytes] = {}
        self.fixed: list[Finding] = []
        self.refused: list[tuple[Finding, str]] = []

    def run_round(self, base: AuditedRun) -> AuditedRun:
        """Return the state after all fixes that can be made together and make nothing worse; ``base`` if there are none."""
        files = _EditableTexts(self.editable, base.request.options.texts)
        possible, self.refused = self.collect_candidates(base.outcome, files)
        state = base
        accepted: list[_FixGroup] = []
        together = select_disjoint(possible)
        # Fixes that make further files readable come last: what these files show must not be blamed on other fixes.
        waiting = [[c for c in together if _is_about_files(c) is last] for last in (True, False)]
        while waiting:
            some = waiting.pop()
            if not some:
                continue
            tried = [*accepted, *some]
            texts = {**base.request.options.texts, **files.apply_changes(tried)}
            request = replace(base.request, options=replace(base.request.options, texts=texts))
            after = run_audit(request, self.execution, previous=state)
            objection = _describe_lost_models(base, after) or find_regression(
                base.outcome, after.outcome, [f for c in tried for f in c.findings]
            )
            if not objection:
                accepted, state = tried, after
            elif len(some) == 1:
                self.refused += [(finding, objection) for finding in some[0].findings]
            else:
                half = len(some) // 2
                waiting += [some[half:], some[:half]]
        for path, text in files.by_path.items():
            self.originals.setdefault(path, text.data)
        self.fixed += [finding for change in accepted for finding in change.findings]
        return state

    def collect_candidates(
        self, outcome: Run, files: _EditableTexts
    ) -> tuple[list[_FixGroup], list[tuple[Finding, str]]]:
        """Return the changes that may be made, safe ones first, and the findings whose fix is refused."""
        found: dict[tuple[str, tuple[Edit, ...]], list[Finding]] = {}
        refused: list[tuple[Finding, str]] = []
        for finding, fix in iter_fixable(outcome, self.wanted):
            if not self.accepts(finding):
                continue
            try:
                found.setdefault((finding.code, files.resolve_edits(fix.edits)), []).append(finding)
            except EditRefusedError as reason:
                refused.append((finding, str(reason)))
        changes = [_FixGroup(edits, tuple(some)) for (_, edits), some in found.items()]
        return sorted(changes, key=lambda change: any(map(_is_unsafe, change.findings))), refused

    def count_unsafe_fixes(self, state: AuditedRun) -> int:
        """Count the findings with an unsafe fix in files that may be changed."""
        files, count = _EditableTexts(self.editable, state.request.options.texts), 0
        for _, fix in iter_fixable(state.outcome, {Applicability.UNSAFE}):
            with contextlib.suppress(EditRefusedError):
                files.resolve_edits(fix.edits)
                count += 1
        return count

    def hide_refused_fixes(self, outcome: Run) -> Run:
        """Return the run with refused fixes shown as advice only."""
        vain = {id(finding) for finding, _ in self.refused}

        def hide(finding: Finding) -> Finding:
            places = finding.list_occurrences()
            if not any(id(own) in vain for own in places):
                return finding
            left = [edit for own in places if id(own) not in vain and own.fix is not None for edit in own.fix.edits]
            shown = tuple(_demote_to_display(own) if id(own) in vain else own for own in finding.occurrences)
            finding = replace(finding, occurrences=shown)
            if not left or finding.fix is None:
                return _demote_to_display(finding)
            return replace(finding, fix=replace(finding.fix, edits=tuple(dict.fromkeys(left))))

        return replace(outcome, findings=tuple(map(hide, outcome.findings)))


def _list_package_folders(found: AuditedRun) -> Iterator[Path]:
    """Yield the folders of packages that the command line and the configurations name."""
    request = found.request
    yield from (*request.packages.all_folders, *request.allowed)
    for unit in found.units:
        if unit.packages is not None:
            yield from unit.packages.all_folders


def _describe_lost_models(before: AuditedRun, after: AuditedRun) -> str:
    """Name a unit that is not found any more; variants that were only made to reduce arguments do not count."""
    lost = {unit.id for unit in before.units if not unit.is_reduced} - {unit.id for unit in after.units}
    return f"with it {min(lost)} would not be found" if lost and not after.outcome.partial else ""


def iter_fixable(outcome: Run, kinds: Container[Applicability]) -> Iterator[tuple[Finding, Fix]]:
    """Yield the findings that count and have a fix of these kinds, each place with its own fix: one may be refused alone."""
    for finding in iter_occurrences(outcome.findings):
        fix = finding.fix
        if finding.suppressed is None and fix is not None and fix.edits and fix.applicability in kinds:
            yield finding, fix


def _is_about_files(change: _FixGroup) -> bool:
    return any(finding.code.startswith(FILE_FAMILY) for finding in change.findings)


def _is_unsafe(finding: Finding) -> bool:
    return finding.fix is not None and finding.fix.applicability is Applicability.UNSAFE


def _demote_to_display(finding: Finding) -> Finding:
    fix = finding.fix
    return finding if fix is None else replace(finding, fix=replace(fix, applicability=Applicability.DISPLAY))


class _EditableTexts:
    """The files that edits change, as they are in one round."""

    def __init__(self, editable: EditableFiles, texts: Mapping[str, bytes]) -> None:
        self.editable = editable
        self.texts = texts
        self.by_name: dict[str, EditableText | EditRefusedError] = {}
        self.by_path: dict[str, EditableText] = {}

    def resolve_edits(self, edits: Iterable[Edit]) -> tuple[Edit, ...]:
        """Return the edits with real paths in their spans, each once.

        :raises EditRefusedError: if one of them cannot be made.
        """
        located: dict[Edit, None] = {}
        for edit in edits:
            try:
                text = self._get_text(edit.span.file)
                text.ensure_applicable(edit)
            except EditRefusedError as reason:
                raise EditRefusedError(f"{edit.span.file}: {reason}") from None
            located[replace(edit, span=replace(edit.span, file=text.path))] = None
        spans = sorted((edit.span.file, edit.span.start, edit.span.end) for edit in located)
        if any(one[0] == two[0] and one[2] > two[1] for one, two in pairwise(spans)):
            raise EditRefusedError("its edits overlap")
        return tuple(located)

    def _get_text(self, name: str) -> EditableText:
        if name not in self.by_name:
            try:
                text = EditableText.read(name, self.editable, self.texts)
                self.by_name[name] = self.by_path[text.path] = text
            except EditRefusedError as reason:
                self.by_name[name] = reason
        found = self.by_name[name]
        if isinstance(found, EditRefusedError):
            raise found
        return found

    def apply_changes(self, changes: Iterable[_FixGroup]) -> dict[str, bytes]:
        """Return the content of the files after the changes, by real path."""
        edits: dict[str, dict[Edit, None]] = {}
        for edit in (edit for change in changes for edit in change.edits):
            edits.setdefault(edit.span.file, {})[edit] = None
        return {path: self.by_path[path].apply_edits(some) for path, some in edits.items()}


class _EditedRanges:
    """The pieces of text that edits change.

    An insertion does not overlap with an edit beside it or with another insertion, nor do two equal edits.
    """

    def __init__(self) -> None:
        self.edits: set[Edit] = set()
        self.ranges: dict[str, list[tuple[int, int]]] = {}
        self.insertions: dict[str, list[int]] = {}

    def try_take(self, edits: Iterable[Edit]) -> bool:
        """Take the text of these edits, which do not overlap each other; False if some of it is taken already."""
        new = [edit for edit in edits if edit not in self.edits]
        if any(map(self._overlaps, new)):
            return False
        for edit in new:
            self.edits.add(edit)
            file, start, end = edit.span.file, edit.span.start, edit.span.end
            if start == end:
                insort(self.insertions.setdefault(file, []), start)
            else:
                insort(self.ranges.setdefault(file, []), (start, end))
        return True

    def _overlaps(self, edit: Edit) -> bool:
        start, end = edit.span.start, edit.span.end
        pieces, insertions = self.ranges.get(edit.span.file, []), self.insertions.get(edit.span.file, [])
        before = bisect_left(pieces, (end, 0)) - 1
        if before >= 0 and pieces[before][1] > start:
            return True
        inside = bisect_right(insertions, start)
        return inside < len(insertions) and insertions[inside] < end


class HasEdits(Protocol):
    """Anything that consists of edits."""

    @property
    def edits(self) -> tuple[Edit, ...]: ...


Change = TypeVar("Change", bound=HasEdits)


def select_disjoint(changes: Iterable[Change]) -> list[Change]:
    """Return the changes that do not touch text that an earlier one changes."""
    taken = _EditedRanges()
    return [change for change in changes if taken.try_take(change.edits)]
