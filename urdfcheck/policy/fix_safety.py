"""Fixes that edit text which makes more than the finding is about: only the author knows whether the rest should change.

An edit of a value that xacro hands on stays only where every attribute that reads the value gets it right by it.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import replace

from urdfcheck.core import Applicability, Edit, Finding, Fix, Span
from urdfcheck.core.text import COMPUTED_NUMBERS, join_names
from urdfcheck.source.text.handed_values import find_typed_value
from urdfcheck.source.text.xml import Attribute, Element

# The six numbers of a tensor.
_MOST_SPELLED = 6
# Rule and edit: findings about left and right ask for the same one.
_Wish = tuple[str, Edit]


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


def lead_to_xacro(finding: Finding, sources: Mapping[str, str]) -> Finding:
    """Make the repair of a file that xacro wrote advice about its source: xacro overwrites an edit of the file itself.

    ``sources``: the files that xacro wrote → the path from there to the file that each is made from.
    """
    if finding.occurrences:
        finding = replace(finding, occurrences=tuple(lead_to_xacro(own, sources) for own in finding.occurrences))
    fix, span = finding.fix, finding.location.span
    if fix is None or span is None or span.file not in sources:
        return finding
    here = f"xacro generated this file from {sources[span.file]}: edit that if it is wrong too, and generate again"
    title = fix.title.replace(COMPUTED_NUMBERS, _spell_numbers(fix.edits))
    return replace(finding, fix=Fix(f"{title} ({here})"))


def _spell_numbers(edits: Sequence[Edit]) -> str:
    """Return what edits write in place of what, for a repair that loses them; of many, where they are seen."""
    if len(edits) > _MOST_SPELLED:
        return "the numbers that a check of the xacro file shows"
    ordered = sorted(edits, key=lambda edit: edit.span.start)
    return ", ".join(f"{edit.expected.strip()} → {edit.replacement.strip()}" for edit in ordered)


def _get_edit_key(finding: Finding, edit: Edit) -> tuple[str, str, Edit]:
    return finding.code, finding.message_id, edit


def _list_safe_edits(finding: Finding) -> list[Edit]:
    """Return the edits of a safe fix that change what a model is made of; edits of comments do not."""
    return [edit for edit in _list_edits(finding) if _is_safe(finding) and not edit.expected.strip().startswith("<!--")]


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


def withdraw_shared_edits(
    findings: Iterable[Finding], root: Element | None, loose_reads: AbstractSet[Span]
) -> list[Finding]:
    """Make a repair advice where it changes a yaml value, a property or a macro call that others read too, or text of which a
    macro makes others.

    It stays if the same attribute of each element that reads the value, or is made of the text, is what findings of the rule
    repair in this way.

    :param root: the expanded model.
    :param loose_reads: the places of definitions that something other than an attribute reads.
    """
    findings = list(findings)
    edited = {edit.span for finding in findings for edit in _list_edits(finding)}
    if root is None or not edited:
        return findings
    readers, made = _index_readers(root, edited), _index_typed_attributes(root, edited)
    owners: dict[_Wish, set[str]] = {}
    for finding in findings:
        for edit in _list_edits(finding):
            owners.setdefault((finding.code, edit), set()).update(map(_get_owner, finding.subjects))

    def is_shared(finding: Finding) -> bool:
        for edit in _list_edits(finding):
            own = owners[finding.code, edit]
            values = [reader for reader in readers.get(edit.span, ()) if _hands_on(reader, edit.span, own)]
            others = len(readers.get(edit.span, ())) > len(values) or edit.span in loose_reads
            if values and (others or len({(reader.owner.tag, reader.name) for reader in values}) > 1):
                return True
        return False

    def list_others(finding: Finding) -> list[str]:
        """List what is made of the text that a repair changes, and needs none."""
        if _is_safe(finding):
            return []
        others: set[str] = set()
        for edit in _list_edits(finding):
            several = made.get(edit.span, set())
            others |= several - owners[finding.code, edit] if len(several) > 1 else set()
        return sorted(others)

    settled = []
    for finding in findings:
        others = list_others(finding)
        kept = _withdraw(finding) if others or is_shared(finding) else finding
        settled.append(_except_others(kept, others) if others else kept)
    return settled


def _except_others(finding: Finding, owners: Sequence[str]) -> Finding:
    """Say that a repair is not for these elements, which a macro makes of the same text."""
    names = join_names(owner.partition("[")[2] or owner for owner in owners)
    verb = "is" if len(owners) == 1 else "are"
    title = "" if finding.fix is None else finding.fix.title
    return replace(finding, fix=Fix(f"{title}; not in {names}, which {verb} made of the same text"))


def _is_safe(finding: Finding) -> bool:
    return finding.fix is not None and finding.fix.applicability is Applicability.SAFE


def _list_edits(finding: Finding) -> tuple[Edit, ...]:
    return () if finding.fix is None else finding.fix.edits


def _index_readers(root: Element, spans: AbstractSet[Span]) -> Mapping[Span, list[Attribute]]:
    """Return the attributes that were computed from the definitions at some places, by place."""
    readers: dict[Span, list[Attribute]] = {}
    for element in root.walk():
        for attribute in element.attributes.values():
            for definition in attribute.collect_definitions() if attribute.reads else ():
                if definition.span is not None and definition.span in spans:
                    readers.setdefault(definition.span, []).append(attribute)
    return readers


def _index_typed_attributes(root: Element, spans: AbstractSet[Span]) -> Mapping[Span, set[str]]:
    """Return the owners of the attributes whose values were typed at some places, by place."""
    owners: dict[Span, set[str]] = {}
    for element in root.walk():
        for attribute in element.attributes.values():
            if attribute.literal and attribute.span is not None and attribute.span in spans:
                owners.setdefault(attribute.span, set()).add(_get_owner(element.subject))
    return owners


def _hands_on(reader: Attribute, span: Span, owners: AbstractSet[str]) -> bool:
    """Whether the text at ``span`` is the value of an attribute of one of these owners."""
    if _get_owner(reader.owner.subject) not in owners:
        return False
    typed = find_typed_value(reader)
    return typed is not None and typed.span == span


def _get_owner(subject: str) -> str:
    """Return the link, the joint or the like that a subject is part of."""
    return subject.partition("]")[0]


def _withdraw(finding: Finding) -> Finding:
    return finding if finding.fix is None else replace(finding, fix=Fix(finding.fix.title))
