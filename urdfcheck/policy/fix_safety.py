"""Fixes that edit text which makes more than the finding is about: only the author knows whether the rest should change."""

from __future__ import annotations

from bisect import bisect_right
from collections import Counter
from collections.abc import Iterable, Mapping
from collections.abc import Set as AbstractSet
from dataclasses import replace

from urdfcheck.core import Applicability, Edit, Finding, Span
from urdfcheck.source.text.xml import Element


def mark_unsafe_in_model(findings: Iterable[Finding], root: Element | None) -> list[Finding]:
    """Demote a fix to *unsafe* if a macro makes several elements of the text that it changes. ``root``: the expanded model."""
    findings = list(findings)
    if root is None or not any(map(_list_safe_edits, findings)):
        return findings
    made = ElementCounts(root)
    return [_mark_unsafe(f) if any(map(made.makes_several_elements, _list_safe_edits(f))) else f for f in findings]


def mark_unsafe_across_models(findings: Iterable[Finding], users: Mapping[str, AbstractSet[str]]) -> list[Finding]:
    """Demote a fix to *unsafe* if another model expands the same text and does not report the same finding with a safe fix.

    ``users``: file → ids of the models that it is part of.
    """
    findings = list(findings)
    safe: dict[tuple[str, str, Edit], set[str]] = {}
    for finding in findings:
        for edit in _list_safe_edits(finding):
            safe.setdefault(_get_edit_key(finding, edit), set()).add(finding.model)
    return [
        _mark_unsafe(f)
        if any(users.get(e.span.file, set()) - safe[_get_edit_key(f, e)] for e in _list_safe_edits(f))
        else f
        for f in findings
    ]


def _get_edit_key(finding: Finding, edit: Edit) -> tuple[str, str, Edit]:
    return finding.code, finding.message_id, edit


def _list_safe_edits(finding: Finding) -> list[Edit]:
    """Return the edits of a safe fix that change what a model is made of; edits of comments do not."""
    if finding.fix is None or finding.fix.applicability is not Applicability.SAFE:
        return []
    return [edit for edit in finding.fix.edits if not edit.expected.strip().startswith("<!--")]


def _mark_unsafe(finding: Finding) -> Finding:
    fix = finding.fix
    return finding if fix is None else replace(finding, fix=replace(fix, applicability=Applicability.UNSAFE))


class ElementCounts:
    """Number of elements that a model has of each start tag."""

    def __init__(self, root: Element) -> None:
        self.count_by_span = Counter(e.span for e in root.walk() if e.span is not None)
        self.spans_by_file: dict[str, list[Span]] = {}
        for span in sorted(self.count_by_span):
            self.spans_by_file.setdefault(span.file, []).append(span)

    def makes_several_elements(self, edit: Edit) -> bool:
        """Whether the tags that an edit changes make several elements."""
        return self.count_elements(edit.span) > 1

    def count_elements(self, span: Span) -> int:
        """Count the elements that a tag in this text makes, of several tags the most; text belongs to the tag before it."""
        tags = self.spans_by_file.get(span.file, [])
        first = bisect_right(tags, span.start, key=lambda tag: tag.start) - 1
        end = bisect_right(tags, max(span.end - 1, span.start), key=lambda tag: tag.start)
        return max((self.count_by_span[tag] for tag in tags[max(first, 0) : end]), default=0)
