"""One defect is one finding, however many links, models and sets of arguments show it.

A model is what a run checks: a file with one set of arguments. A finding that several models share belongs to the one with the
fewest arguments, and lists all (``variants``).
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from urdfcheck.core import Applicability, Finding, Fix, Location, Severity, Span, Verdict
from urdfcheck.core.findings import iter_occurrences
from urdfcheck.core.merging import merge_alike
from urdfcheck.policy.fix_safety import ElementCounts
from urdfcheck.rules import load_rules
from urdfcheck.run.jobs import Unit
from urdfcheck.source.text.handed_values import is_computed
from urdfcheck.source.text.xml import Element

# The family of rules about launch files, whose text is not part of a model.
_LAUNCH_FAMILY = "LCH"
# The families of rules about files that a model names.
_FILE_FAMILIES = ("PKG", "MSH")


def merge_macro_lines(findings: Iterable[Finding], root: Element | None, texts: Mapping[str, str]) -> list[Finding]:
    """Merge findings of one model about all elements that a line of a macro makes: then the line is wrong, not its calls.

    The line must compute something: the wrong numbers of several calls are several defects, and so are findings with a repair
    of their own. The findings about such a line, and about text that is typed as it is, blame their text (``blames_text``).
    ``root``: the expanded model; ``texts``: the files by name.
    """
    groups: dict[tuple[Any, ...], list[Finding]] = {}
    for finding in findings:
        code, _, cause = _get_claim(finding)
        key = code, cause, finding.severity, finding.suppressed, finding.location.span
        groups.setdefault(key, []).append(finding)
    made = None if root is None else ElementCounts(root)
    merged: list[Finding] = []
    for group in groups.values():
        span = group[0].location.span
        text = "" if span is None else _get_text(span, texts)
        # A call makes many elements, each by a line of its own.
        is_line = is_computed(text) and not text.startswith("<xacro:")
        is_whole = made is not None and span is not None and is_line and _covers_all(group, made, span)
        if is_whole and len(group) > 1 and not any(map(_list_edits, group)):
            merged.append(replace(_join_calls(group), blames_text=True))
        elif is_whole or (text and "$" not in text):
            merged += [replace(finding, blames_text=True) for finding in group]
        else:
            merged += group
    return merged


def _covers_all(group: Iterable[Finding], made: ElementCounts, span: Span) -> bool:
    """Whether findings are about all elements that a text makes."""
    return len({subject for finding in group for subject in finding.subjects}) >= made.count_elements(span)


def merge_across_models(findings: Iterable[Finding], units: Iterable[Unit]) -> list[Finding]:
    """Merge what several models of a run show at one text: first those of one file with several sets of arguments.

    Models of several files share a finding if its text, rule, message, cause and repair are the same, and if besides the text
    itself is to blame in each of them (`merge_macro_lines`), or the value was computed from the same definitions, or a file is
    at fault, which the message names. Launch files share what they say of one file. What different configurations and baselines
    judge stays apart.
    """
    units = list(units)
    by_id = {unit.id: unit for unit in units}

    def get_home(finding: Finding) -> tuple[Any, ...] | None:
        home = _get_home(finding, by_id)
        return None if home is None else (*home, _list_edits(finding))

    def get_message_key(finding: Finding) -> tuple[Any, ...] | None:
        home = get_home(finding)
        if home is None or not finding.code.startswith((*_FILE_FAMILIES, _LAUNCH_FAMILY)):
            return None
        place = None if finding.code.startswith(_LAUNCH_FAMILY) else finding.location.span
        return *home, place, finding.message

    def get_text_key(finding: Finding) -> tuple[Any, ...] | None:
        home, span = get_home(finding), finding.location.span
        if home is None or span is None:
            return None
        return *home, span, finding.blames_text or _list_value_definitions(finding) or finding.message

    rank = _make_rank(by_id)
    merged = _merge_groups(_merge_variants(findings, units), get_message_key, rank=rank)
    return _merge_groups(merged, get_text_key, rank=rank)


def merge_copies(findings: Iterable[Finding], units: Iterable[Unit], digests: Mapping[str, str]) -> list[Finding]:
    """Merge what is found at the same text of files in several folders that are copies: of one name and one content.

    The finding is that of the first model, and its edits repair all copies. ``digests``: of the contents of files, by their names
    in findings.
    """
    by_id = {unit.id: unit for unit in units}
    number = Counter((name.rpartition("/")[2], digest) for name, digest in digests.items())
    copied = {key for key, count in number.items() if count > 1}

    def get_key(finding: Finding) -> tuple[Any, ...] | None:
        home, span = _get_home(finding, by_id), finding.location.span
        if home is None or span is None:
            return None
        content = span.file.rpartition("/")[2], digests.get(span.file, "")
        return (*home, content, span.start, span.end, finding.subjects) if content in copied else None

    return _merge_groups(findings, get_key, rank=_make_rank(by_id), join=_join_copies)


def _join_copies(group: Sequence[Finding], *, rank: Callable[[Finding], tuple[Any, ...]]) -> Finding:
    """Join findings as `_join_models` does, with the edits of all."""
    joined = _join_models(group, rank=rank)
    edits = dict.fromkeys(edit for finding in group for edit in _list_edits(finding))
    return joined if joined.fix is None else replace(joined, fix=replace(joined.fix, edits=tuple(edits)))


def _get_home(finding: Finding, by_id: Mapping[str, Unit]) -> tuple[Any, ...] | None:
    """Return what findings that become one share, whatever they are about; None for one that stays alone."""
    unit = by_id.get(finding.model)
    if unit is None or finding.is_about_urdfcheck or finding.location.span is None:
        return None
    words = tuple(sorted(finding.message_ids.items()))
    return unit.fail_on, unit.baseline_home, finding.suppressed, *_get_claim(finding), words


def _make_rank(by_id: Mapping[str, Unit]) -> Callable[[Finding], tuple[Any, ...]]:
    """Return the order of models: the one with the fewest arguments first."""

    def rank(finding: Finding) -> tuple[Any, ...]:
        return len(by_id[finding.model].arguments), finding.model

    return rank


def _merge_groups(
    findings: Iterable[Finding],
    get_key: Callable[[Finding], tuple[Any, ...] | None],
    *,
    rank: Callable[[Finding], tuple[Any, ...]],
    join: Callable[..., Finding] | None = None,
) -> list[Finding]:
    """Merge the findings of one key; those with the key None stay as they are. ``join``: `_join_models` without one."""
    alone: list[Finding] = []
    groups: dict[tuple[Any, ...], list[Finding]] = {}
    for finding in findings:
        key = get_key(finding)
        if key is None:
            alone.append(finding)
        else:
            groups.setdefault(key, []).append(finding)
    for group in groups.values():
        for same in _split_repeated(group):
            alone.append(same[0] if len(same) == 1 else (join or _join_models)(same, rank=rank))
    return alone


def _split_repeated(group: Sequence[Finding]) -> list[list[Finding]]:
    """Split findings of which a model has several by their measured values; what is still repeated stays apart."""
    parts = [list(group)]
    if _has_repeated_model(group):
        by_numbers: dict[tuple[Any, ...], list[Finding]] = {}
        for finding in group:
            numbers = tuple(sorted((k, v) for k, v in finding.data.items() if isinstance(v, (int, float))))
            by_numbers.setdefault(numbers, []).append(finding)
        parts = list(by_numbers.values())
    return [some for part in parts for some in ([[f] for f in part] if _has_repeated_model(part) else [part])]


def _has_repeated_model(group: Sequence[Finding]) -> bool:
    models = [model for finding in group for model in finding.subjects_by_model]
    return len(set(models)) < len(models)


def _join_models(group: Sequence[Finding], *, rank: Callable[[Finding], tuple[Any, ...]]) -> Finding:
    """Return the finding of the first model for which it is worst, with all models and with the places of the others that are
    elsewhere."""
    ordered = sorted(group, key=lambda finding: (-finding.severity, *rank(finding)))
    first = ordered[0]
    variants = {model: subjects for finding in ordered for model, subjects in finding.subjects_by_model.items()}
    places = {f.location.span: f.location for f in ordered if f.location.span != first.location.span}
    related = dict.fromkeys((*first.related, *places.values()))
    # What is not safe in one model is not safe.
    fixes = [finding.fix for finding in ordered if finding.fix is not None]
    order = list(Applicability)
    return replace(
        first,
        fix=max(fixes, key=lambda fix: order.index(fix.applicability), default=None),
        variants=dict(sorted(variants.items())),
        severity=max(finding.severity for finding in group),
        blocks_check=any(finding.blocks_check for finding in group),
        related=tuple(related),
    )


def _join_calls(group: Sequence[Finding]) -> Finding:
    """Return the first finding with the elements of all, and with the calls that made those of the others."""
    first = group[0]
    calls = (finding.location.via[-1] for finding in group[1:] if finding.location.via)
    shown = {call: Location("call", call) for call in calls if call not in first.location.via}
    places = dict.fromkeys((*shown.values(), *(place for finding in group for place in finding.related)))
    subjects = tuple(dict.fromkeys(subject for finding in group for subject in finding.subjects))
    title = f"correct what this line computes: it makes {len(subjects)} elements"
    if first.fix is not None:
        title += f" (for the first of them: {first.fix.title})"
    return replace(
        first,
        subjects=subjects,
        message_ids={s: f.message_id for f in group for s in f.subjects if f.message_id != first.message_id},
        fix=Fix(title),
        related=tuple(places),
    )


def merge_kinds(findings: Iterable[Finding], units: Iterable[Unit] = ()) -> list[Finding]:
    """Merge what models show in one file, if it is one kind of mistake: left and right, all fingers, each call of a macro.

    A kind is a rule with a cause; without a cause, with a message. Each place remains as an occurrence with its own numbers.
    What is known, what fails the run, what can be repaired and what programs refuse does not become one with what does not. What
    is about urdfcheck itself, or is why a model was not checked, stays alone.
    """
    by_id = {unit.id: unit for unit in units}

    def get_kind(finding: Finding) -> tuple[Any, ...] | None:
        span, unit = finding.location.span, by_id.get(finding.model)
        if span is None or finding.is_about_urdfcheck or finding.blocks_check:
            return None
        fix = finding.fix
        return (
            finding.code,
            finding.message_id if finding.cause is None else finding.cause.id,
            finding.severity,
            finding.confidence,
            finding.suppressed,
            None if fix is None else (fix.applicability, bool(fix.edits)),
            span.file,
            tuple((name, Verdict.from_sentence(text)) for name, text in sorted(finding.consequences.items())),
            None if unit is None else (unit.fail_on, unit.baseline_home),
        )

    return merge_alike(findings, load_rules(), get_kind)


def merge_unrequested(unrequested: Iterable[Finding], units: Iterable[Unit]) -> list[Finding]:
    """Merge the notes that were not asked for as those of a report are: the HTML report lists some of them."""
    units = list(units)
    return merge_kinds(merge_across_models(unrequested, units), units)


def count_more_notes(findings: Iterable[Finding], unrequested: Iterable[Finding], units: Iterable[Unit]) -> int:
    """Count by how many notes a report grows that lists the ones that were not asked for: one of each kind in a file.

    ``unrequested``: as `merge_unrequested` returns them.
    """
    shown = [f for f in findings if f.severity is Severity.INFO and f.suppressed is None]
    alike = merge_kinds(iter_occurrences([*shown, *unrequested]), units)
    return max(len(alike) - len(shown), 0)


# -- variants of one file ----------------------------------------------------------------------------------------------


def _merge_variants(findings: Iterable[Finding], units: Iterable[Unit]) -> list[Finding]:
    """Merge findings that several sets of arguments of one file show at the same text."""
    files = _find_variant_files(units)
    alike: dict[tuple[Any, ...], list[Finding]] = {}
    found: list[Finding] = []
    for finding in findings:
        if finding.model in files:
            alike.setdefault((files[finding.model][0], finding.suppressed, *get_defect_key(finding)), []).append(
                finding
            )
        else:
            found.append(finding)
    for group in alike.values():
        for same in _split_by_subjects(group):
            first = min(same, key=lambda f: (files[f.model][1], f.model))
            variants = {f.model: f.subjects for f in sorted(same, key=lambda f: f.model)}
            severity, blocks_check = max(f.severity for f in same), any(f.blocks_check for f in same)
            found.append(replace(first, variants=variants, severity=severity, blocks_check=blocks_check))
    return found


def _split_by_subjects(group: list[Finding]) -> list[list[Finding]]:
    """Split findings at one text: if a model has several, by their subjects, and equal ones by their order."""
    if len({finding.model for finding in group}) == len(group):
        return [group]
    seen: Counter[tuple[str, tuple[str, ...]]] = Counter()
    apart: dict[tuple[tuple[str, ...], int], list[Finding]] = {}
    for finding in group:
        seen[finding.model, finding.subjects] += 1
        apart.setdefault((finding.subjects, seen[finding.model, finding.subjects]), []).append(finding)
    return list(apart.values())


def _find_variant_files(units: Iterable[Unit]) -> dict[str, tuple[str, int]]:
    """Return file and number of arguments, by id, of the models of which the run has several variants."""
    found = {unit.id: (os.path.realpath(unit.path), len(unit.arguments)) for unit in units if unit.kind == "model"}
    number = Counter(file for file, _ in found.values())
    return {name: (file, length) for name, (file, length) in found.items() if number[file] > 1}


# -- what makes two findings the same ----------------------------------------------------------------------------------


def get_defect_key(finding: Finding) -> tuple[Any, ...]:
    """Return what identifies one defect in all variants: the same text, with a value from the same definitions."""
    span = finding.location.span
    made_of = frozenset(_list_definitions(finding, ("property[", "yaml[")))
    return finding.code, finding.message_id, finding.subjects if span is None else (span, made_of)


def _get_claim(finding: Finding) -> tuple[str, str, str]:
    """Return rule, message and cause."""
    return finding.code, finding.message_id, "" if finding.cause is None else finding.cause.id


def _list_definitions(finding: Finding, kinds: tuple[str, ...]) -> tuple[Span | None, ...]:
    """Return the places of the definitions that the value was computed from, in a stable order."""
    spans = {place.span for place in finding.related if place.subject.startswith(kinds)}
    return tuple(sorted(span for span in spans if span is not None))


def _list_value_definitions(finding: Finding) -> tuple[Span | None, ...]:
    """Return the definitions that decide the value: those in yaml where there are any, for the others only lead there."""
    in_yaml = _list_definitions(finding, ("yaml[",))
    return in_yaml or _list_definitions(finding, ("property[", "parameter[", "argument["))


def _list_edits(finding: Finding) -> tuple[Any, ...]:
    return () if finding.fix is None else finding.fix.edits


def _get_text(span: Span, texts: Mapping[str, str]) -> str:
    return texts.get(span.file, "")[span.start : span.end]
