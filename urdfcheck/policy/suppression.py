"""Findings that somebody knows already: by a comment in the source, an entry of the configuration, or the baseline.

They stay in the report, and count no more. All of this happens before findings are merged, so that of six links that one
macro line makes a single one can be known.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from functools import cache
from typing import Any

from urdfcheck import rules as catalogue
from urdfcheck.core import Applicability, Edit, Finding, Location, Span, Suppression, UrdfcheckError
from urdfcheck.source.text.suppression_comments import IgnoreComment

# What the baseline knows of one model: how often a code, subject and message id.
BaselineEntries = Mapping[tuple[str, str, str], int]
# Findings about urdfcheck and its configuration: a comment of the checked file must not silence them.
OWN_PREFIX = "URC"


@dataclass(frozen=True, slots=True)
class CommentUsage:
    """A comment after a unit was checked. ``codes``: what its words mean, ``wrong``: the complaint about a word that means
    nothing; ``used``: it covered a finding; ``unknown``: why it cannot be said that it is needless, empty where it can;
    ``line``: the edit that takes it out."""

    comment: IgnoreComment
    codes: frozenset[str]
    complaint: str
    is_used: bool
    doubt: str
    removal: Edit


@dataclass(frozen=True, slots=True)
class SuppressionEntry:
    """An entry of the configuration: findings of these codes about subjects of this pattern are known. ``subject``: ``*`` and
    ``?`` as in file names, everything else as it stands; a pattern that names an element covers all in it."""

    codes: frozenset[str]
    subject: str
    reason: str

    def covers(self, finding: Finding) -> bool:
        """Whether the finding is of the codes, and all its subjects are meant."""
        literal = self.subject.replace("[", "[[]")  # fnmatch takes no longer for many asterisks than for one
        return finding.code in self.codes and all(
            any(fnmatchcase(subject, literal + end) for end in ("", "/*", "@*")) for subject in finding.subjects
        )


@cache
def resolve_selectors(selectors: tuple[str, ...]) -> tuple[frozenset[str], str]:
    """The codes that the words of a comment mean, and what is wrong with the first word that means none."""
    codes: set[str] = set()
    for word in selectors:
        try:
            meant = catalogue.select_rules([word])
        except UrdfcheckError as error:
            return frozenset(codes), str(error)
        if all(code.startswith(OWN_PREFIX) for code in meant):
            return frozenset(codes), f"{word} is about urdfcheck itself and cannot be suppressed"
        codes |= {code for code in meant if not code.startswith(OWN_PREFIX)}
    return frozenset(codes), ""


def mark_suppressed(
    findings: Sequence[Finding],
    comments: Iterable[IgnoreComment],
    entries: Sequence[SuppressionEntry],
    baseline_entries: BaselineEntries,
) -> tuple[list[Finding], set[Span]]:
    """The findings, those that are known marked with the reason, and the comments that were needed for it.

    A comment counts with a reason only. It covers a finding whose text it covers, or any call that brought that text there; of a
    finding about several elements comments have to cover all.
    """
    covering = _CommentIndex(comments)
    left = Counter(baseline_entries)
    used: set[Span] = set()
    taken: set[tuple[str, str, Span | None, tuple[str, ...]]] = set()
    marked = []
    for finding in findings:
        if finding.suppressed is None and not finding.code.startswith(OWN_PREFIX):
            reasons = []
            for places in _list_places(finding):
                needed = [c for place in places for c in covering.find_covering_comments(finding.code, place)]
                used.update(comment.span for comment in needed)
                reasons.append(needed[0].reason if needed else "")
            reason = Suppression("source", reasons[0]) if all(reasons) else None
            reason = reason or next(
                (Suppression("configuration", e.reason) for e in entries if e.covers(finding)), None
            )
            # One text of which a macro makes the same element twice is one finding, and one entry, in the end.
            same = finding.code, finding.message_id, finding.location.span, finding.subjects
            if reason is None and (same in taken or _take_baseline_entry(left, finding)):
                taken.add(same)
                reason = Suppression("baseline", "in the baseline")
            finding = finding if reason is None else replace(finding, suppressed=reason)
        marked.append(finding)
    return marked, used


class _CommentIndex:
    """Comments with a reason by the text that they cover. Such pieces of text, elements or lines, lie beside or in each other: of
    those that hold a place each is found from the one in it, however many comments a file has."""

    def __init__(self, comments: Iterable[IgnoreComment]) -> None:
        # By file and piece: the comments on it, by the codes that they mean.
        self.comments_by_piece: dict[str, dict[tuple[int, int], dict[frozenset[str], list[IgnoreComment]]]] = {}
        for c in comments:
            if c.reason and c.start < c.end:
                on = self.comments_by_piece.setdefault(c.span.file, {}).setdefault((c.start, -c.end), {})
                on.setdefault(resolve_selectors(c.selectors)[0], []).append(c)
        self.pieces = {file: sorted(on) for file, on in self.comments_by_piece.items()}  # the outer one first
        self.enclosing = {file: list(_find_enclosing_pieces(pieces)) for file, pieces in self.pieces.items()}

    def find_covering_comments(self, code: str, place: Span) -> Iterator[IgnoreComment]:
        """The comments that cover findings of this code at this place, the nearest first, each once or more often."""
        pieces = self.pieces.get(place.file, [])
        index = bisect_right(pieces, (place.start, 1)) - 1
        while index >= 0:
            if place.start < -pieces[index][1]:
                for codes, comments in self.comments_by_piece[place.file][pieces[index]].items():
                    if code in codes:
                        yield from comments
                        del comments[1:]  # the others are known to be needed by now
            index = self.enclosing[place.file][index]


def _find_enclosing_pieces(pieces: Sequence[tuple[int, int]]) -> Iterator[int]:
    """For each piece of text (its start, and its end below zero) the index of the smallest one that it lies in, or -1."""
    open_since: list[int] = []
    for index, (start, _) in enumerate(pieces):
        while open_since and -pieces[open_since[-1]][1] <= start:
            open_since.pop()
        yield open_since[-1] if open_since else -1
        open_since.append(index)


def _list_places(finding: Finding) -> Iterator[list[Span]]:
    """For each element that a finding is about, the texts of which a comment may cover any."""
    others = set(finding.subjects) - {finding.location.subject}
    for place in (finding.location, *(r for r in finding.related if r.subject in others)):
        yield [*([] if place.span is None else [place.span]), *place.via]


def _take_baseline_entry(left: Counter[tuple[str, str, str]], finding: Finding) -> bool:
    """Whether the baseline knows all subjects of a finding; it knows each as often as it has it."""
    keys = [(finding.code, subject, finding.message_id) for subject in finding.subjects]
    if any(left[key] <= 0 for key in keys):
        return False
    left.subtract(keys)
    return True


def assess_comment(
    comment: IgnoreComment,
    text: str,
    is_used: bool,
    checked_codes: Collection[str],
    skipped_codes: Collection[str],
    doubt: str,
) -> CommentUsage:
    """What is known of a comment after the check of a unit: ``ran`` are the codes that were looked for, ``skipped`` those of
    them that could not be, ``doubt`` why the file may need the comment although this unit does not."""
    codes, wrong = resolve_selectors(comment.selectors)
    missing = sorted(codes - set(checked_codes))
    blind = sorted(codes if "ALL" in skipped_codes else codes & set(skipped_codes))
    unknown = doubt
    if missing and not codes & set(checked_codes):
        unknown = f"{missing[0]} was not looked for"
    elif blind:
        unknown = f"{blind[0]} could not be checked"
    return CommentUsage(comment, codes, wrong, is_used, unknown, _make_removal_edit(comment.span, text))


def _make_removal_edit(span: Span, text: str) -> Edit:
    """The edit that takes a comment out; the whole line where nothing else stands in it."""
    begin = span.start - span.col + 1
    newline = re.compile(r"[ \t]*(\r\n|\n|\r)").match(text, span.end)
    if newline is not None and not text[begin : span.start].strip(" \t"):
        whole = replace(span, start=begin, col=1, end=newline.end(), end_line=span.end_line + 1, end_col=1)
        return Edit(whole, text[begin : newline.end()], "")
    return Edit(span, text[span.start : span.end], "")


def report_bad_comments(comments: Iterable[tuple[str, CommentUsage]]) -> Iterator[Finding]:
    """What is wrong with the comments that the units of a run met, as findings of URC902 and URC903.

    ``comments``: each with the id of its unit. One that any unit needed is needed; one that a unit cannot judge is left alone.
    """
    by_place: dict[Span, list[tuple[str, CommentUsage]]] = {}
    for unit, judgement in comments:
        by_place.setdefault(judgement.comment.span, []).append((unit, judgement))
    for span, seen in by_place.items():
        model, first = seen[0]
        comment, at = first.comment, Location(f"comment[{', '.join(first.comment.selectors)}]", span)
        rules, named = catalogue.load_rules(), ", ".join(comment.selectors)
        data: dict[str, Any] = {}
        if not comment.selectors:
            message = "malformed"
        elif first.complaint:
            message, data = "unknown", {"complaint": first.complaint}
        elif not comment.reason:
            yield replace(rules["URC903"].finding("no-reason", at=at, codes=named), model=model)
            continue
        elif any(judgement.is_used or judgement.doubt for _, judgement in seen):
            continue
        else:
            message, data = "unused", {"codes": named}
        edits, safe = ([first.removal], Applicability.SAFE) if message == "unused" else ([], Applicability.DISPLAY)
        found = rules["URC902"].finding(message, at=at, edits=edits, applicability=safe, **data)
        yield replace(found, model=model)
