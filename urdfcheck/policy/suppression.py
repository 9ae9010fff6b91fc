"""Findings that are suppressed: by a comment in the source, an entry of the configuration, or the baseline.

They stay in the report but do not count. Suppression precedes merging, so that of six links that one macro line makes a
single one can be suppressed.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from functools import cache
from typing import Any

from urdfcheck.core import Applicability, Edit, Finding, Location, Span, Suppression, UrdfcheckError
from urdfcheck.core.findings import OWN_FAMILY
from urdfcheck.core.records import dataclass
from urdfcheck.rules import load_rules, select_rules
from urdfcheck.source.text.suppression_comments import IgnoreComment

# What the baseline accepts in one model: how often each code, subject and message id.
BaselineEntries = Mapping[tuple[str, str, str], int]
# How bad that is at most, where it is known: see `Finding.excess`.
BaselineExcesses = Mapping[tuple[str, str, str], float]
# A finding is accepted until it is worse than it was by this share, which numbers do not change by being rounded or measured
# elsewhere (chosen).
_WORSE = 0.25


@dataclass(frozen=True, slots=True, kw_only=True)
class CommentUsage:
    """A suppression comment after its unit was checked."""

    comment: IgnoreComment
    codes: frozenset[str]
    """Rules that its selectors mean."""
    complaint: str
    """What is wrong with a selector that means no rule; empty if all mean one."""
    is_used: bool
    """Whether it suppresses a finding."""
    doubt: str
    """Reason to keep an apparently unused comment; empty without one."""
    removal: Edit
    """Deletes the comment."""


@dataclass(frozen=True, slots=True)
class SuppressionEntry:
    """An entry of the configuration that suppresses findings of these codes about subjects of this pattern."""

    codes: frozenset[str]
    subject: str
    """Pattern: ``*`` and ``?`` as in file names, everything else literally. One that names an element covers all in it."""
    reason: str

    def covers(self, finding: Finding) -> bool:
        """Whether the finding has one of the codes, and the pattern matches all its subjects."""
        literal = self.subject.replace("[", "[[]")  # fnmatch takes no longer for many asterisks than for one
        return finding.code in self.codes and all(
            any(fnmatchcase(subject, literal + end) for end in ("", "/*", "@*")) for subject in finding.subjects
        )


@cache
def resolve_selectors(selectors: tuple[str, ...]) -> tuple[frozenset[str], str]:
    """Return the codes that the selectors of a comment mean, and what is wrong with the first one that means none."""
    codes: set[str] = set()
    for word in selectors:
        try:
            meant = select_rules([word])
        except UrdfcheckError as error:
            return frozenset(codes), str(error)
        if all(code.startswith(OWN_FAMILY) for code in meant):
            return frozenset(codes), f"{word} is about urdfcheck itself and cannot be suppressed"
        codes |= {code for code in meant if not code.startswith(OWN_FAMILY)}
    return frozenset(codes), ""


def mark_suppressed(
    findings: Sequence[Finding],
    *,
    comments: Iterable[IgnoreComment],
    entries: Sequence[SuppressionEntry],
    baseline_entries: BaselineEntries,
    baseline_excesses: BaselineExcesses,
) -> tuple[list[Finding], set[Span]]:
    """Mark the findings that are suppressed with the reason; also return the comments that this needs.

    Only comments with a reason count. A comment covers a finding if it covers its text or a call that brought the text there;
    if a finding is about several elements, comments must cover all of them.
    """
    covering = _CommentIndex(comments)
    left = Counter(baseline_entries)
    used: set[Span] = set()
    taken: set[tuple[str, str, Span | None, tuple[str, ...]]] = set()
    marked = []
    for finding in findings:
        if finding.suppressed is not None or finding.is_about_urdfcheck or finding.blocks_check:
            marked.append(finding)
            continue
        reasons = []
        for places in _list_places(finding):
            needed = [c for place in places for c in covering.find_covering_comments(finding.code, place)]
            used.update(comment.span for comment in needed)
            reasons.append(needed[0].reason if needed else "")
        reason = Suppression("source", reasons[0]) if all(reasons) else None
        reason = reason or next((Suppression("configuration", e.reason) for e in entries if e.covers(finding)), None)
        # A text of which a macro makes the same element twice becomes one finding, and is one entry of the baseline.
        same = finding.code, finding.message_id, finding.location.span, finding.subjects
        is_worse = reason is None and _has_become_worse(finding, baseline_excesses)
        if reason is None and not is_worse and (same in taken or _take_baseline_entry(left, finding)):
            taken.add(same)
            reason = Suppression("baseline", "in the baseline")
        message = (
            f"{finding.message}. It has become worse since the baseline accepted it" if is_worse else finding.message
        )
        marked.append(replace(finding, message=message, suppressed=reason))
    return marked, used


class _CommentIndex:
    """Comments with a reason by the text that they cover.

    Such pieces of text, elements or lines, are disjoint or nested: from the innermost piece around a place the index walks
    outwards, however many comments a file has.
    """

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
        """Yield the comments that cover findings of this code at this place, innermost first; some more than once."""
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
    """Yield for each piece of text (its start and negated end) the index of the smallest piece around it, or -1."""
    open_since: list[int] = []
    for index, (start, _) in enumerate(pieces):
        while open_since and -pieces[open_since[-1]][1] <= start:
            open_since.pop()
        yield open_since[-1] if open_since else -1
        open_since.append(index)


def _list_places(finding: Finding) -> Iterator[list[Span]]:
    """Yield for each element that a finding is about the texts of which a comment must cover one."""
    others = set(finding.subjects) - {finding.location.subject}
    for place in (finding.location, *(r for r in finding.related if r.subject in others)):
        yield [*([] if place.span is None else [place.span]), *place.via]


def _take_baseline_entry(left: Counter[tuple[str, str, str]], finding: Finding) -> bool:
    """Whether the baseline accepts all subjects of a finding; each entry is used as often as it counts."""
    keys = [(finding.code, subject, finding.message_id) for subject in finding.subjects]
    if any(left[key] <= 0 for key in keys):
        return False
    left.subtract(keys)
    return True


def _has_become_worse(finding: Finding, excesses: BaselineExcesses) -> bool:
    """Whether a finding is much worse than the baseline accepts it."""
    accepted = (excesses.get((finding.code, subject, finding.message_id)) for subject in finding.subjects)
    return any(is_worse(finding.excess, before) for before in accepted)


def is_worse(excess: float, accepted: float | None) -> bool:
    """Whether something is much worse than it was when it was accepted; not if that is unknown."""
    return accepted is not None and excess - accepted > _WORSE * abs(accepted)


def assess_comment(
    comment: IgnoreComment,
    text: str,
    is_used: bool,
    checked_codes: Collection[str],
    skipped_codes: Collection[str],
    doubt: str,
) -> CommentUsage:
    """Assess a comment after the check of a unit.

    ``checked_codes``: rules that were selected; ``skipped_codes``: those of them that could not run; ``doubt``: why the file
    may need the comment although this unit does not.
    """
    codes, complaint = resolve_selectors(comment.selectors)
    missing = sorted(codes - set(checked_codes))
    blind = sorted(codes if "ALL" in skipped_codes else codes & set(skipped_codes))
    if missing and not codes & set(checked_codes):
        doubt = f"{missing[0]} was not looked for"
    elif blind:
        doubt = f"{blind[0]} could not be checked"
    return CommentUsage(
        comment=comment,
        codes=codes,
        complaint=complaint,
        is_used=is_used,
        doubt=doubt,
        removal=_make_removal_edit(comment.span, text),
    )


def _make_removal_edit(span: Span, text: str) -> Edit:
    """Return the edit that deletes a comment, with its line if that holds nothing else."""
    begin = span.start - span.col + 1
    newline = re.compile(r"[ \t]*(\r\n|\n|\r)").match(text, span.end)
    if newline is not None and not text[begin : span.start].strip(" \t"):
        whole = replace(span, start=begin, col=1, end=newline.end(), end_line=span.end_line + 1, end_col=1)
        return Edit(whole, text[begin : newline.end()], "")
    return Edit(span, text[span.start : span.end], "")


def report_bad_comments(comments: Iterable[tuple[str, CommentUsage]]) -> Iterator[Finding]:
    """Yield findings URC902 and URC903 about the comments in the units of a run.

    ``comments``: each with the id of its unit. A comment is needed if any unit needs it, and ignored if a unit has doubts.
    """
    by_place: dict[Span, list[tuple[str, CommentUsage]]] = {}
    for unit, usage in comments:
        by_place.setdefault(usage.comment.span, []).append((unit, usage))
    for span, usages in by_place.items():
        model, first = usages[0]
        comment, at = first.comment, Location(f"comment[{', '.join(first.comment.selectors)}]", span)
        rules, named = load_rules(), ", ".join(comment.selectors)
        data: dict[str, Any] = {}
        if not comment.selectors:
            message = "malformed"
        elif first.complaint:
            # What lists the rules is in the repair.
            message, data = "unknown", {"complaint": first.complaint.partition(" (")[0]}
        elif not comment.reason:
            yield replace(rules["URC903"].finding("no-reason", at=at, codes=named), model=model)
            continue
        elif any(usage.is_used or usage.doubt for _, usage in usages):
            continue
        else:
            message, data = "unused", {"codes": named}
        edits, safe = ([first.removal], Applicability.SAFE) if message == "unused" else ([], Applicability.DISPLAY)
        found = rules["URC902"].finding(message, at=at, edits=edits, applicability=safe, **data)
        yield replace(found, model=model)
