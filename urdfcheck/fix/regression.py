"""Whether a check of fixed files is worse than the check before."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence

from urdfcheck.core import Finding, Run, Severity
from urdfcheck.core.findings import iter_occurrences

# Rules about files that are not found, such as meshes, and what rules need that look into these.
FILE_FAMILY, FILE_NEEDS = "PKG", frozenset({"mesh", "dynamics", "collision"})

# Model, code and message id of a finding.
_MessageKey = tuple[str, str, str]


def find_regression(previous: Run, current: Run, fixed: Sequence[Finding]) -> str:
    """Return what became worse when these findings were fixed, or that one of them remains; empty if all is well.

    :raises KeyboardInterrupt: if the second run was interrupted.
    """
    if current.partial:
        raise KeyboardInterrupt
    return (
        _describe_new_failure(previous, current)
        or _describe_unreadable_model(previous, current)
        or _describe_new_skip(previous, current)
        or _describe_remaining_finding(previous, current, fixed)
        or _describe_new_finding(previous, current, fixed)
    )


def _describe_new_failure(previous: Run, current: Run) -> str:
    """Name a failure of urdfcheck that was not there before."""
    new = (failure for failure in current.failures if failure not in previous.failures)
    return next((f"with it urdfcheck fails: {failure}" for failure in new), "")


def _describe_unreadable_model(previous: Run, current: Run) -> str:
    """Name a model that could be read before."""
    lost = current.unit_ids - _list_readable(current) - _list_unread(previous)
    return next((f"with it {model.id} could not be read" for model in previous.models if model.id in lost), "")


def _describe_new_skip(previous: Run, current: Run) -> str:
    """Name a check that had findings and could not run now: what is not looked for is not gone."""
    seen = {(model, code) for f in previous.findings for model in f.subjects_by_model for code in (f.code, "ALL")}
    seen -= {(skip.model, skip.code) for skip in previous.skipped}
    new = (skip for skip in current.skipped if (skip.model, skip.code) in seen)
    return next((f"with it {skip.code} could not be checked: {skip.reason}" for skip in new), "")


def _describe_remaining_finding(previous: Run, current: Run, fixed: Sequence[Finding]) -> str:
    """Say that a finding remains although it was fixed."""
    before, gone, after = (
        Counter(_iter_subject_keys(findings)) for findings in (previous.findings, fixed, current.findings)
    )
    remains = any(after[key] > before[key] - gone[key] for key in gone)
    return "the finding would still be there" if remains else ""


def _describe_new_finding(previous: Run, current: Run, fixed: Sequence[Finding]) -> str:
    """Name a finding that the fix brought, whatever it is about: an edit may give an element another name."""
    before, gone, after = (
        Counter(_iter_message_keys(findings)) for findings in (previous.findings, fixed, current.findings)
    )
    new_models = (_list_readable(current) & _list_unread(previous)) | (current.unit_ids - previous.unit_ids)
    uncovered = _list_uncovered(previous, current, fixed)
    grown = _list_grown(previous, current, fixed)
    for finding in iter_occurrences(current.findings):
        if finding.suppressed or finding.is_about_urdfcheck or finding.severity <= Severity.INFO:
            continue
        for model in finding.subjects_by_model:
            key = model, finding.code, finding.message_id
            if model in new_models or key[:2] in uncovered or (model in grown and finding.severity < Severity.ERROR):
                continue
            if after[key] > before[key] - gone[key]:
                return f"it would bring {finding.code} for {finding.subjects[0]}: {finding.message}"
    return ""


def _list_grown(previous: Run, current: Run, fixed: Iterable[Finding]) -> set[str]:
    """Return the models that gained links or joints by the fix of an error: what is wrong with these was not seen before."""
    sizes = {model.id: model.links + model.joints for model in previous.models}
    mended = {model for finding in fixed if finding.severity is Severity.ERROR for model in finding.subjects_by_model}
    return {m.id for m in current.models if m.id in mended and m.links + m.joints > sizes.get(m.id, 0)}


def _list_uncovered(previous: Run, current: Run, fixed: Iterable[Finding]) -> set[tuple[str, str]]:
    """Return the models and rules whose findings were there before, but could not be seen."""
    unread = _list_unread(previous)
    codes_in_files = [code for code, rule in current.rules.items() if FILE_NEEDS & set(rule.needs)]
    uncovered: set[tuple[str, str]] = set()
    for finding in fixed:
        codes = set(finding.data.get("hides", ()))
        if unread.intersection(finding.subjects_by_model):
            # A model that cannot be read reports one mistake after the other, mostly of the same kind.
            codes.add(finding.code)
        if finding.code.startswith(FILE_FAMILY):
            codes.update(codes_in_files)
        uncovered |= {(model, code) for model in finding.subjects_by_model for code in codes}
    return uncovered


def _list_readable(run: Run) -> set[str]:
    """Return the ids of the models that could be read."""
    return {model.id for model in run.models if model.status == "checked"}


def _list_unread(run: Run) -> set[str]:
    """Return the ids of the models that could not be read."""
    return {model.id for model in run.models if model.status != "checked"}


def _iter_message_keys(findings: Iterable[Finding]) -> Iterator[_MessageKey]:
    """Yield the message of each finding that is not suppressed, once for each subject."""
    return (key for key, _ in _iter_subject_keys(findings))


def _iter_subject_keys(findings: Iterable[Finding]) -> Iterator[tuple[_MessageKey, str]]:
    """Yield message and subject of each finding that is not suppressed."""
    for finding in iter_occurrences(findings):
        if finding.suppressed is None:
            for model, subjects in finding.subjects_by_model.items():
                yield from (((model, finding.code, finding.message_id), subject) for subject in subjects)
