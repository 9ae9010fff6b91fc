"""Edits of text that makes more than the finding is about: nobody but the author knows whether the rest is meant to change."""

from __future__ import annotations

from bisect import bisect_right
from collections import Counter
from collections.abc import Iterable, Mapping, Set
from dataclasses import replace

from urdfcheck.core import Applicability, Edit, Finding, Span
from urdfcheck.source.text.xml import Element


def within(findings: Iterable[Finding], root: Element | None) -> list[Finding]:
    """The findings of one model, their fixes unsafe where a macro makes several elements of the text that they change.
    ``root`` is the expanded model."""
    findings = list(findings)
    if root is None or not any(map(_safe_edits, findings)):
        return findings
    made = _Made(root)
    return [_unsafe(f) if any(map(made.several, _safe_edits(f))) else f for f in findings]


def between(findings: Iterable[Finding], users: Mapping[str, Set[str]]) -> list[Finding]:
    """The findings of a run, their fixes unsafe where another model is made of the text as well and does not have the finding
    there, or its fix is unsafe. ``users``: for each file the ids of the models that are made of it."""
    findings = list(findings)
    safe: dict[tuple[str, str, Edit], set[str]] = {}
    for finding in findings:
        for edit in _safe_edits(finding):
            safe.setdefault(_kind(finding, edit), set()).add(finding.model)
    return [
        _unsafe(f) if any(users.get(e.span.file, set()) - safe[_kind(f, e)] for e in _safe_edits(f)) else f
        for f in findings
    ]


def _kind(finding: Finding, edit: Edit) -> tuple[str, str, Edit]:
    return finding.code, finding.message_id, edit


def _safe_edits(finding: Finding) -> list[Edit]:
    """The edits of a safe fix that change what a model is made of: a comment makes nothing."""
    if finding.fix is None or finding.fix.applicability is not Applicability.SAFE:
        return []
    return [edit for edit in finding.fix.edits if not edit.expected.strip().startswith("<!--")]


def _unsafe(finding: Finding) -> Finding:
    assert finding.fix is not None
    return replace(finding, fix=replace(finding.fix, applicability=Applicability.UNSAFE))


class _Made:
    """How many elements of a model were made of each start tag."""

    def __init__(self, root: Element) -> None:
        self.number = Counter(e.span for e in root.walk() if e.span is not None)
        self.tags: dict[str, list[Span]] = {}
        for span in sorted(self.number):
            self.tags.setdefault(span.file, []).append(span)

    def several(self, edit: Edit) -> bool:
        """Whether several elements were made of the tags that an edit changes; of text between tags the one before it tells."""
        tags = self.tags.get(edit.span.file, [])
        first = bisect_right(tags, edit.span.start, key=lambda tag: tag.start) - 1
        end = bisect_right(tags, max(edit.span.end - 1, edit.span.start), key=lambda tag: tag.start)
        return any(self.number[tag] > 1 for tag in tags[max(first, 0) : end])
