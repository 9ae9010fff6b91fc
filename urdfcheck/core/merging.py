"""Merge findings that report the same of several elements into one that names them all."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from urdfcheck.core import Edit, Finding, Located, Rule
from urdfcheck.core.text import join_names


def merge_same_text(findings: Iterable[Finding]) -> list[Finding]:
    """Merge findings of one code, source text, message and measured values into one with several subjects.

    One typo is one finding. Where a macro line gives each link another value, each value stays a finding with its own call.
    """
    groups: dict[tuple[Any, ...], list[Finding]] = {}
    for finding in findings:
        numbers = tuple(sorted((k, v) for k, v in finding.data.items() if isinstance(v, (int, float))))
        place = finding.location.span or finding.location.subject
        key = finding.code, finding.message_id, finding.model, place, numbers, finding.suppressed
        groups.setdefault(key, []).append(finding)
    return [
        replace(
            group[0],
            subjects=tuple(dict.fromkeys(subject for finding in group for subject in finding.subjects)),
            severity=max(finding.severity for finding in group),
        )
        for group in groups.values()
    ]


def merge_identical(
    rule: Rule, findings: Iterable[Finding], *names: str, varying: Collection[str] = ()
) -> Iterator[Finding]:
    """Merge findings whose ``data`` differ only in these names: a block that was copied is wrong once.

    The merged finding is at the first place, lists the others and repairs all. ``varying``: keys of ``data`` that may differ
    as well, because each finding has its own repair.
    """
    groups: dict[str, list[Finding]] = {}
    for finding in findings:
        same = {key: value for key, value in finding.data.items() if key not in {*names, *varying}}
        groups.setdefault(
            repr((finding.message_id, finding.severity, bool(_collect_edits([finding])), same)), []
        ).append(finding)
    for group in groups.values():
        yield _merge_group(rule, group, names=names, varying=varying) if len(group) > 1 else group[0]


def _merge_group(rule: Rule, group: Sequence[Finding], *, names: Sequence[str], varying: Collection[str]) -> Finding:
    first = group[0]
    places = list({finding.location.span or finding.location.subject: finding.location for finding in group}.values())
    data: dict[str, Any] = {
        key: _quote_first_text(group, key, names[0]) if key in varying else v for key, v in first.data.items()
    }
    data |= {name: join_names(dict.fromkeys(f.data[name] for f in group)) for name in names if name in data}
    finding = rule.finding(
        first.message_id,
        at=first.location,
        cause=first.cause.id if first.cause else None,
        edits=_collect_edits(group),
        related=[*places[1:], *(place for finding in group for place in finding.related)],
        severity=first.severity,
        confidence=first.confidence,
        **data,
    )
    message = finding.message
    for name in names:
        message = message.replace(f"{name} {data.get(name)}", f"{name}s {data.get(name)}", 1)  # link a → links a, b
    return replace(
        finding, message=message, subjects=tuple(dict.fromkeys(subject for f in group for subject in f.subjects))
    )


def _quote_first_text(group: Sequence[Finding], key: str, name: str) -> Any:
    """Return a text of the first finding, marked if the others have their own."""
    data: Mapping[str, Any] = group[0].data
    text = data[key]
    if not isinstance(text, str) or all(finding.data[key] == text for finding in group):
        return text
    return f"{text} (for {data[name]}, likewise for the others)"


def _collect_edits(group: Iterable[Finding]) -> list[Edit]:
    """Return the edits of all findings, each source text once: one macro line makes several elements."""
    edits = (edit for finding in group if finding.fix is not None for edit in finding.fix.edits)
    return list({edit.span: edit for edit in edits}.values())


def build_group_finding(rule: Rule, message: str, places: Sequence[Located], **details: Any) -> Finding:
    """Return one finding about all ``places``: at the first, with each other text in ``related``.

    :param details: what `Rule.finding` takes further.
    """
    here = places[0].location.span
    related = {span: place for place in places if (span := place.location.span) != here}
    finding = rule.finding(message, at=places[0], related=related.values(), **details)
    return replace(finding, subjects=tuple(place.location.subject for place in places))
