"""Merge findings that report the same of several elements, places or models into one that names them all."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

from urdfcheck.core import Applicability, Edit, Finding, Fix, Located, Rule, Verdict
from urdfcheck.core.findings import iter_occurrences
from urdfcheck.core.headlines import (
    LONGEST_HEADLINE,
    count_more,
    cut_line,
    fill_joint_headline,
    format_more,
    shorten_headline,
)
from urdfcheck.core.text import join_names

_BLOCKS = "<gazebo> blocks"
_THE_OTHER = "; the other has its own repair"
_EACH_OTHER = "; each of the others has its own repair"
# More elements than these are not named before their repair.
_FEW_NAMES = 2
# The longest repair of a second place that is told beside the first one's.
_SHORT_REPAIR = 80
_NAMED = re.compile(r"\w+\[(.*?)\](?=[/@]|$)", re.DOTALL)


def merge_same_text(findings: Iterable[Finding]) -> list[Finding]:
    """Merge findings of one code, source text, message and measured values into one with several subjects.

    One typo is one finding. Where a macro line gives each link another value, each value stays a finding with its own call, and
    so does each of several texts about one element (the packages that one package.xml lacks).
    """
    groups: dict[tuple[Any, ...], list[Finding]] = {}
    texts: dict[tuple[Any, ...], dict[str, int]] = {}
    for finding in findings:
        numbers = tuple(sorted((k, v) for k, v in finding.data.items() if isinstance(v, (int, float))))
        place = finding.location.span or finding.location.subject
        key = finding.code, finding.message_id, finding.model, place, numbers, finding.suppressed
        told = texts.setdefault((*key, finding.location.subject), {})
        groups.setdefault((*key, told.setdefault(finding.message, len(told))), []).append(finding)
    return [
        replace(
            group[0],
            subjects=tuple(dict.fromkeys(subject for finding in group for subject in finding.subjects)),
            severity=max(finding.severity for finding in group),
            fix=_agree_on_fix(group),
        )
        for group in groups.values()
    ]


def _agree_on_fix(group: Sequence[Finding]) -> Fix | None:
    """Return the repair of elements that one text makes; where each wants other numbers in that text, no edit repairs all."""
    fix = group[0].fix
    if fix is None or all(finding.fix == fix for finding in group):
        return fix
    if _has_overlap({edit: None for finding in group if finding.fix for edit in finding.fix.edits}):
        return Fix(_refer_to_others(fix.title, group))
    return _join_fixes(group)


def merge_identical(
    rule: Rule, findings: Iterable[Finding], *names: str, varying: Collection[str] = ()
) -> Iterator[Finding]:
    """Merge findings whose ``data`` differ only in these names: a block that was copied is wrong once.

    The merged finding is at the first place, lists the others and repairs all. ``varying``: keys of ``data`` that may differ
    too, because each finding has its own repair.
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
        consequences=_join_consequences(group),
        **data,
    )
    message = finding.message
    for name in names:
        message = message.replace(f"{name} {data.get(name)}", f"{name}s {data.get(name)}", 1)  # link a → links a, b
    subjects = tuple(dict.fromkeys(subject for f in group for subject in f.subjects))
    headline = finding.headline
    is_about = rule.headlines[first.message_id].startswith(f"{{{names[0]}}}: ")
    if is_about and not headline.startswith(str(first.data[names[0]])):
        # The number of elements and a whole claim say more than a name that was cut and a claim that was cut.
        headline = _join_headlines(group, {rule.code: rule})
    return replace(finding, headline=headline, message=message, subjects=subjects)


def _quote_first_text(group: Sequence[Finding], key: str, name: str) -> Any:
    """Return a text of the first finding, marked if the others have their own."""
    data: Mapping[str, Any] = group[0].data
    text = data[key]
    if not isinstance(text, str) or all(finding.data[key] == text for finding in group):
        return text
    return f"{text} (for {data[name]}; each of the others has its own)"


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


def merge_alike(
    findings: Iterable[Finding], rules: Mapping[str, Rule], get_key: Callable[[Finding], Hashable | None]
) -> list[Finding]:
    """Merge the findings of one key into one with an occurrence for each place; those with the key None stay as they are.

    Findings whose repairs change the same text in different ways stay apart, for one repair could not make both changes.
    """
    groups: dict[Hashable, list[Finding]] = {}
    merged: list[Finding] = []
    for finding in findings:
        key = get_key(finding)
        if key is None:
            merged.append(finding)
        else:
            groups.setdefault(key, []).append(finding)
    for group in groups.values():
        edits = {edit: None for finding in group if finding.fix for edit in finding.fix.edits}
        if len(group) == 1 or _has_overlap(edits):
            merged += group
        else:
            merged.append(join_occurrences(group, rules))
    return merged


def _has_overlap(edits: Iterable[Edit]) -> bool:
    ranges = sorted((edit.span.file, edit.span.start, edit.span.end) for edit in edits)
    return any(one[0] == two[0] and one[2] > two[1] for one, two in pairwise(ranges))


def join_occurrences(group: Sequence[Finding], rules: Mapping[str, Rule]) -> Finding:
    """Return one finding for several: that of the worst place, with what the others add in the order of the text."""
    ordered = sorted((own for finding in group for own in finding.list_occurrences()), key=_get_place_key)
    first = max(ordered, key=lambda own: (own.severity, own.excess))
    ordered.sort(key=lambda own: own is not first)
    subjects = tuple(dict.fromkeys(subject for own in ordered for subject in own.subjects))
    variants = _join_variants(ordered)
    others = [own.location for own in ordered if own.location.span != first.location.span]
    places = {place.span: place for place in others}.values()
    hidden = sorted({code for own in ordered for code in own.data.get("hides", ())})
    return replace(
        first,
        headline=_join_headlines(ordered, rules),
        severity=max(own.severity for own in ordered),
        subjects=variants.get(first.model, subjects),
        message_ids={
            subject: own.message_ids.get(subject, own.message_id)
            for own in reversed(ordered)
            for subject in own.subjects
            if own.message_ids.get(subject, own.message_id) != first.message_id
        },
        related=tuple(dict.fromkeys((*places, *(place for own in ordered for place in own.related)))),
        consequences=_join_consequences(ordered),
        data={**first.data, **({"hides": hidden} if hidden else {})},
        fix=_join_fixes(ordered),
        variants=variants,
        occurrences=tuple(ordered),
    )


def _get_place_key(finding: Finding) -> tuple[Any, ...]:
    span = finding.location.span
    place = ("", 0, 0) if span is None else (span.file, span.start, span.end)
    calls = [(call.file, call.start) for call in finding.location.via]
    return (*place, calls, -finding.severity, finding.message_id, finding.model, finding.subjects)


def _join_headlines(ordered: Sequence[Finding], rules: Mapping[str, Rule]) -> str:
    first = ordered[0]
    names = [_list_names(own) for own in ordered]
    rule = rules.get(first.code)
    template = "" if rule is None else rule.headlines.get(first.message_id, "")
    rest = format_more(count_more(template, [own.data for own in ordered], names))
    room = LONGEST_HEADLINE - len(rest)
    try:
        if template and len({own.message_id for own in ordered}) == 1:
            kind = _name_kind(ordered)
            # Several blocks may be for one link.
            places = len({own.location.span for own in ordered}) if kind == _BLOCKS else 0
            return fill_joint_headline(template, [own.data for own in ordered], names, kind, places)
        return shorten_headline(first.headline, template, first.data, room) + rest
    except (KeyError, ValueError, TypeError):  # a finding that the page did not make
        return cut_line(first.headline, room) + rest


def _name_kind(findings: Iterable[Finding]) -> str:
    """Return what the subjects of findings are, in the plural: ``links``, or ``elements`` of several kinds."""
    kinds = {
        match[0].partition("[")[0] for own in findings for s in own.subjects if (match := _NAMED.match(s)) is not None
    }
    kind = kinds.pop() if len(kinds) == 1 else "element"
    return _BLOCKS if kind == "gazebo" else f"{kind}s"


def _join_consequences(ordered: Iterable[Finding]) -> dict[str, str]:
    """Return for each program the worst that it does with one of the findings."""
    joint: dict[str, str] = {}
    for own in ordered:
        for program, effect in own.consequences.items():
            known = joint.setdefault(program, effect)
            if Verdict.from_sentence(effect) > Verdict.from_sentence(known):
                joint[program] = effect
    return joint


def _join_fixes(ordered: Sequence[Finding]) -> Fix | None:
    """Return the repair of all places; of repairs that exclude each other the first.

    Its words are those of the first place. Where they hold for that place alone, they say so: numbers of one link are wrong in
    another.
    """
    fixes = [own.fix for own in ordered if own.fix is not None]
    if not fixes:
        return None
    edits = tuple(dict.fromkeys(edit for fix in fixes for edit in fix.edits))
    if _has_overlap(edits):
        return fixes[0]
    title = fixes[0].title
    kinds: dict[str, list[Finding]] = {}
    for own in ordered:  # `move it …` is not `delete it …`
        if own.fix is not None:
            kinds.setdefault(own.fix.title.partition(" ")[0], []).append(own)
    if len(kinds) > 1:
        title += "".join(_tell_other(kind, ordered[0]) for kind in list(kinds.values())[1:])
        is_all_told = all(len({own.fix.title for own in kind if own.fix}) == 1 for kind in kinds.values())
        title += "" if is_all_told else _EACH_OTHER
    elif len({fix.title for fix in fixes}) > 1:
        title = _refer_to_others(title, ordered)
    return Fix(title, max((fix.applicability for fix in fixes), key=list(Applicability).index), edits)


def _tell_other(kind: Sequence[Finding], first: Finding) -> str:
    """Return what repairs places of another kind than the ``first``, with the names of those that it is for, if they are few."""
    told, title = ("" if own.fix is None else own.fix.title for own in (kind[0], first))
    alike = [own for own in kind if own.fix is not None and own.fix.title == told]
    names = dict.fromkeys(name for own in alike for name in _list_names(own))
    is_named = 0 < len(names) <= _FEW_NAMES and not names.keys() & set(_list_names(first))
    place = f"{join_names(names)}: " if is_named else "elsewhere "
    return f"; {place}{told.removesuffix(f', or {title}')}"  # both may end in the same advice


def _list_names(finding: Finding) -> list[str]:
    return [match[1] for s in finding.subjects if (match := _NAMED.match(s)) is not None]


def _refer_to_others(title: str, ordered: Sequence[Finding]) -> str:
    """End a repair that is another one at the other places: with the other one if short, or with the fact that there are more."""
    # Elements that one text makes may have been joined before.
    alone = title.removesuffix(_EACH_OTHER).removesuffix(_THE_OTHER)
    if len(ordered) > 2 or alone != title:
        return alone + _EACH_OTHER
    other = ordered[1]
    name = "".join(_list_names(other)[:1])
    if name and len(other.subjects) == 1 and other.fix is not None and len(other.fix.title) <= _SHORT_REPAIR:
        return f"{title}; {name}: {other.fix.title}"
    return title + _THE_OTHER


def _join_variants(ordered: Sequence[Finding]) -> dict[str, tuple[str, ...]]:
    """Return the models that share the findings, each with its subjects; none where it is a single model."""
    joint: dict[str, dict[str, None]] = {}
    for own in ordered:
        for model, subjects in own.subjects_by_model.items():
            joint.setdefault(model, {}).update(dict.fromkeys(subjects))
    is_shared = any(own.variants for own in ordered) or len(joint) > 1
    return {model: tuple(subjects) for model, subjects in sorted(joint.items())} if is_shared else {}


# -- what formats show of a line ----------------------------------------------------------------------------------------


def list_line_entries(findings: Iterable[Finding], rules: Mapping[str, Rule]) -> list[Finding]:
    """Return an entry for each place of each finding, for editors, code scanning and reviews of changed lines.

    Several entries of a rule on one line are one, with the severity of the worst.
    """
    return join_on_lines(iter_occurrences(findings), rules)


def join_on_lines(findings: Iterable[Finding], rules: Mapping[str, Rule]) -> list[Finding]:
    """Join the findings of one rule that begin on one line; those that are known stay apart from those that count."""
    groups: dict[Hashable, list[Finding]] = {}
    for number, finding in enumerate(findings):
        span = finding.location.span
        place: Hashable = number if span is None else (finding.code, span.file, span.line, finding.suppressed)
        groups.setdefault(place, []).append(finding)
    return [group[0] if len(group) == 1 else join_occurrences(group, rules) for group in groups.values()]
