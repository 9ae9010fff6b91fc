"""A model and its repaired copy, compared: only what the repair changed, not what the copy leaves behind."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from urdfcheck.changes.compare_versions import compare_versions
from urdfcheck.core import Finding, Run
from urdfcheck.core.findings import iter_occurrences
from urdfcheck.core.model_diff import Diff, ReportedStep
from urdfcheck.core.text import format_count
from urdfcheck.run.jobs import Request
from urdfcheck.run.pipeline import IN_WORKERS, Execution

# Code, message id and subject.
_Key = tuple[str, str, str]


def compare_repaired(
    original: Request, copy: Request, unrepaired: Run, steps: Iterable[ReportedStep], execution: Execution = IN_WORKERS
) -> Diff:
    """Compare a model with its repaired copy, and draw both.

    The copy has only what the model reads: a finding about what lies around the model is in one of the two and no merit of the
    repair. Such findings are left out, and counted in the notes.

    :param unrepaired: the check of the copy before anything was repaired.
    :raises UrdfcheckError: if one of the two is gone.
    :raises KeyboardInterrupt: if the user interrupts.
    """
    first, second = (replace(request, options=replace(request.options, scene=True)) for request in (original, copy))
    diff = compare_versions(first, second, execution)
    known = {key for finding in iter_occurrences(unrepaired.active_findings) for key in _iter_keys(finding)}
    gone = tuple(_select_subjects(diff.findings.gone, known, are_known=True))
    new = tuple(_select_subjects(diff.findings.new, known, are_known=False))
    left_out = _count_subjects((*diff.findings.gone, *diff.findings.new)) - _count_subjects((*gone, *new))
    note = (
        f"{format_count(left_out, 'finding')} about what lies around the model: the copy has only what the model reads"
    )
    return replace(
        diff,
        findings=replace(diff.findings, new=new, gone=gone),
        steps=tuple(steps),
        notes=(*diff.notes, *((note,) if left_out else ())),
    )


def _iter_keys(finding: Finding) -> Iterator[_Key]:
    for subject in finding.subjects:
        yield finding.code, finding.message_ids.get(subject, finding.message_id), subject


def _select_subjects(findings: Iterable[Finding], known: set[_Key], *, are_known: bool) -> Iterator[Finding]:
    """Yield the findings with those of their subjects that are, or are not, among known ones."""
    for finding in findings:
        subjects = tuple(key[-1] for key in _iter_keys(finding) if (key in known) == are_known)
        if subjects:
            yield replace(finding, subjects=subjects)


def _count_subjects(findings: Iterable[Finding]) -> int:
    return sum(len(finding.subjects) for finding in findings)
