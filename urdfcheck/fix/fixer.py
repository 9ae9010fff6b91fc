"""The edits of findings, applied to a model's files and checked again.

Nothing is written before everything was checked: the edits are made in memory, and the workers read the files as if they held
the edited text (`urdfcheck.system.files.overlaid`). So there is nothing to roll back on the disk, an interrupt leaves every file as it
was, ``--diff`` shows what ``--fix`` would do because it does the same, and a model is never seen half changed by anybody else.
What is left for the end is to put files whose text is known in the place of the old ones (`urdfcheck.fix.patch.write`).

Fixes that do not overlap are tried together. Where that makes anything worse they are tried in halves, so that what is left
out is the single fix that is at fault. What was left out is tried once more after others were applied, and fixes that overlap
come in the next round, until a round changes nothing: then a second run would not either.
"""

from __future__ import annotations

import contextlib
from bisect import bisect_left, bisect_right, insort
from collections import Counter
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path

from urdfcheck.core import Applicability, Edit, Finding, Fix, Run, Severity
from urdfcheck.fix.patch import EditableFiles, EditableText, EditRefusedError
from urdfcheck.run.jobs import Request
from urdfcheck.run.pipeline import IN_WORKERS, AuditedRun, Execution, run_audit

# Findings about urdfcheck itself: of a comment that is needed no more, or an entry of the baseline.
OWN_PREFIX = "URC"
# Findings about files that are not found, such as meshes, and what rules need that look into these.
FILE_FAMILY, FILE_NEEDS = "PKG", frozenset({"mesh", "dynamics", "collision"})
# Each round is another check. Of fixes that overlap one is made in each.
MAX_ROUNDS = 10


@dataclass(frozen=True, slots=True)
class FixResult:
    """What fixing came to. ``outcome``: the findings that remain; ``fixed`` those that are gone; ``refused`` those whose fix
    was not made, and why; ``more``: how many remain that an unsafe fix would repair. ``changes``: the bytes of the files
    before and after, by real path."""

    outcome: Run
    fixed: tuple[Finding, ...] = ()
    refused: tuple[tuple[Finding, str], ...] = ()
    unsafe_count: int = 0
    changes: Mapping[str, tuple[bytes, bytes]] = field(default_factory=dict)


def compute_fixes(request: Request, execution: Execution = IN_WORKERS, *, include_unsafe: bool = False) -> FixResult:
    """Check as :func:`urdfcheck.run.pipeline.run` does, and work out what the files become when the safe fixes of the findings are
    applied, or the ``unsafe`` ones as well. No file is changed.

    :raises KeyboardInterrupt: when a check of edited files was interrupted.
    """
    state = run_audit(request, execution)
    fixer = _Fixer(state, Execution(audit=execution.audit), include_unsafe=include_unsafe)
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
            path: (fixer.originals[path], text)
            for path, text in state.request.options.texts.items()
            if text != fixer.originals[path]
        },
    )


@dataclass(frozen=True, slots=True, eq=False)
class _FixGroup:
    """Edits that belong together, with real paths in their spans, and the findings that they repair: one for each model that
    the text is part of."""

    edits: tuple[Edit, ...]
    findings: tuple[Finding, ...]


class _Fixer:
    def __init__(self, found: AuditedRun, execution: Execution, *, include_unsafe: bool) -> None:
        self.wanted = {Applicability.SAFE, Applicability.UNSAFE} if include_unsafe else {Applicability.SAFE}
        self.execution = execution
        self.editable = EditableFiles(found.request.paths, _list_package_folders(found))
        self.originals: dict[str, bytes] = {}
        self.fixed: list[Finding] = []
        self.refused: list[tuple[Finding, str]] = []

    def run_round(self, base: AuditedRun) -> AuditedRun:
        """The state after all fixes that can be made together and make nothing worse; ``base`` itself where there is none."""
        files = _EditableTexts(self.editable, base.request.options.texts)
        possible, self.refused = self.collect_candidates(base.outcome, files)
        state = base
        accepted: list[_FixGroup] = []
        together = select_disjoint(possible)
        # Last those that bring new files to look at, so that what these show is not taken for the work of others.
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
        """The changes that may be made, the safe ones first, and the findings whose fix may not be."""
        found: dict[tuple[str, tuple[Edit, ...]], list[Finding]] = {}
        refused: list[tuple[Finding, str]] = []
        for finding, fix in iter_fixable(outcome, self.wanted):
            try:
                found.setdefault((finding.code, files.resolve_edits(fix.edits)), []).append(finding)
            except EditRefusedError as reason:
                refused.append((finding, str(reason)))
        changes = [_FixGroup(edits, tuple(some)) for (_, edits), some in found.items()]
        return sorted(changes, key=lambda change: any(map(_is_unsafe, change.findings))), refused

    def count_unsafe_fixes(self, state: AuditedRun) -> int:
        """How many findings have an unsafe fix in files that may be changed."""
        files, count = _EditableTexts(self.editable, state.request.options.texts), 0
        for _, fix in iter_fixable(state.outcome, {Applicability.UNSAFE}):
            with contextlib.suppress(EditRefusedError):
                files.resolve_edits(fix.edits)
                count += 1
        return count

    def hide_refused_fixes(self, outcome: Run) -> Run:
        """A fix that was tried in vain is no offer any more."""
        vain = {id(finding) for finding, _ in self.refused}
        return replace(outcome, findings=tuple(_demote_to_display(f) if id(f) in vain else f for f in outcome.findings))


def _list_package_folders(found: AuditedRun) -> Iterator[Path]:
    """The folders of packages that the command line and the configurations name."""
    request = found.request
    yield from (*request.packages.all_folders, *request.allowed)
    for unit in found.units:
        if unit.packages is not None:
            yield from unit.packages.all_folders


def _describe_lost_models(before: AuditedRun, after: AuditedRun) -> str:
    """What is looked at no more; which variants tell of a finding with the fewest arguments is another matter."""
    lost = {unit.id for unit in before.units if not unit.is_reduced} - {unit.id for unit in after.units}
    return f"with it {min(lost)} would not be found" if lost and not after.outcome.partial else ""


def iter_fixable(outcome: Run, kinds: Container[Applicability]) -> Iterator[tuple[Finding, Fix]]:
    """The findings that count and have a fix of these kinds, with it."""
    for finding in outcome.findings:
        fix = finding.fix
        if finding.suppressed is None and fix is not None and fix.edits and fix.applicability in kinds:
            yield finding, fix


def _is_about_files(change: _FixGroup) -> bool:
    return any(finding.code.startswith(FILE_FAMILY) for finding in change.findings)


def _is_unsafe(finding: Finding) -> bool:
    return finding.fix is not None and finding.fix.applicability is Applicability.UNSAFE


def _demote_to_display(finding: Finding) -> Finding:
    assert finding.fix is not None
    return replace(finding, fix=replace(finding.fix, applicability=Applicability.DISPLAY))


class _EditableTexts:
    """The files that edits are about, as they are in one round."""

    def __init__(self, editable: EditableFiles, texts: Mapping[str, bytes]) -> None:
        self.editable = editable
        self.texts = texts
        self.by_name: dict[str, EditableText | EditRefusedError] = {}
        self.by_path: dict[str, EditableText] = {}

    def resolve_edits(self, edits: Iterable[Edit]) -> tuple[Edit, ...]:
        """Edits with the real path in their spans, each once.

        :raises Refused: when one of them cannot be made.
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
        """What the changes make of the files, by real path."""
        edits: dict[str, dict[Edit, None]] = {}
        for edit in (edit for change in changes for edit in change.edits):
            edits.setdefault(edit.span.file, {})[edit] = None
        return {path: self.by_path[path].apply_edits(some) for path, some in edits.items()}


class _EditedRanges:
    """The pieces of text that edits change. An insertion beside another edit, or where another one inserts, does not overlap
    with it, nor do two edits that are the same."""

    def __init__(self) -> None:
        self.edits: set[Edit] = set()
        self.ranges: dict[str, list[tuple[int, int]]] = {}
        self.insertions: dict[str, list[int]] = {}

    def try_take(self, edits: Iterable[Edit]) -> bool:
        """Take the text of all of these edits, which do not overlap, or say that some of it is taken already."""
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


def select_disjoint(changes: Iterable[_FixGroup]) -> list[_FixGroup]:
    """Those of the changes that touch no text that one before them changes."""
    taken = _EditedRanges()
    return [change for change in changes if taken.try_take(change.edits)]


def find_regression(previous: Run, current: Run, fixed: Sequence[Finding]) -> str:
    """What became worse when these findings were fixed, or that one of them is still there; empty where all is well.

    What a model or a mesh has that could not be read before was not known; what a fixed finding hid was there as well.

    :raises KeyboardInterrupt: when the second run was interrupted.
    """
    if current.partial:
        raise KeyboardInterrupt
    for failure in current.failures:
        if failure not in previous.failures:
            return f"with it urdfcheck fails: {failure}"
    readable = {model.id for model in current.models if model.status == "checked"}
    unread = {model.id for model in previous.models if model.status != "checked"}
    new = (readable & unread) | (current.unit_ids - previous.unit_ids)
    for model in previous.models:
        if model.id in current.unit_ids - readable - unread:
            return f"with it {model.id} could not be read"
    seen = {(finding.model, code) for finding in previous.findings for code in (finding.code, "ALL")}
    seen -= {(skip.model, skip.code) for skip in previous.skipped}
    for skip in current.skipped:
        if (skip.model, skip.code) in seen:  # what is not looked for is not gone
            return f"with it {skip.code} could not be checked: {skip.reason}"
    had, gone, has = (
        Counter(_iter_finding_keys(findings)) for findings in (previous.findings, fixed, current.findings)
    )
    for key in gone:
        if has[key] > had[key] - gone[key]:
            return "the finding would still be there"
    hidden = {(f.model, code) for f in fixed for code in f.data.get("hides", ())}
    # What cannot be read tells one mistake after the other, mostly of the same kind.
    hidden |= {(f.model, f.code) for f in fixed if f.model in unread}
    looking = [code for code, rule in current.rules.items() if FILE_NEEDS & set(rule.needs)]
    hidden |= {(f.model, code) for f in fixed if f.code.startswith(FILE_FAMILY) for code in looking}
    had, gone, has = (_count_by_message(counter) for counter in (had, gone, has))
    for finding in current.findings:
        key = finding.model, finding.code, finding.message_id
        known = finding.model in new or key[:2] in hidden or finding.code.startswith(OWN_PREFIX) or finding.suppressed
        if not known and finding.severity > Severity.INFO and has[key] > had[key] - gone[key]:
            return f"it would bring {finding.code} for {finding.subjects[0]}: {finding.message}"
    return ""


def _iter_finding_keys(findings: Iterable[Finding]) -> Iterator[tuple[str, ...]]:
    for finding in findings:
        if finding.suppressed is None:
            yield from ((finding.model, finding.code, finding.message_id, subject) for subject in finding.subjects)


def _count_by_message(counter: Counter[tuple[str, ...]]) -> Counter[tuple[str, ...]]:
    """How often each message is there, whatever it is about: an edit may give an element another name."""
    total: Counter[tuple[str, ...]] = Counter()
    for key, number in counter.items():
        total[key[:3]] += number
    return total
