"""The findings that matter first, in a few thousand tokens: what a language model reads before it edits, and after.

A line of claim, then a block for each finding with its place, evidence, cause, effect and edit. What does not fit is counted by
rule, with the option that shows it.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from itertools import accumulate, islice

from urdfcheck.core import Applicability, Confidence, Finding, Run
from urdfcheck.core.text import join_names
from urdfcheck.output.shared.diffs import iter_diff_lines
from urdfcheck.output.shared.escaping import escape_for_log
from urdfcheck.output.shared.verdict.claim import state_claim
from urdfcheck.output.shared.verdict.effects import ToldEffects
from urdfcheck.output.shared.verdict.finding_details import iter_details
from urdfcheck.output.shared.verdict.not_checked import group_unchecked, list_launched_models
from urdfcheck.output.shared.wording import find_finding_file, format_count, format_place, sort_worst_first

# About three thousand tokens: an answer that leaves room for the work.
MOST_CHARACTERS = 10_000
# Of one finding: twelve of them fit.
MOST_OF_A_FINDING = 1_600
# How the command shows what does not fit.
_MORE = "ask for them with --select CODE, or for all with --format text"
# Hexadecimal digits of a fingerprint that name a finding.
ID_DIGITS = 8
_SURE = {Confidence.PROOF: "proven", Confidence.STRONG: "strong evidence", Confidence.HEURISTIC: "a hint"}
_EDIT = {Applicability.SAFE: "safe edit", Applicability.UNSAFE: "edit to check", Applicability.DISPLAY: "advice"}


def render(run: Run) -> str:
    """Render a run for a program that reads text and pays for each word."""
    return render_findings(run, run.active_findings)


def render_findings(
    run: Run, findings: Sequence[Finding], *, most: int = MOST_CHARACTERS, page: int = 1, more: str = _MORE
) -> str:
    """Render some findings of a run, the worst first, and before them what else the run has to say.

    ``page``: which piece of about ``most`` characters, from 1. ``more``: how to ask for what does not fit.
    """
    pages = _iter_pages(run, sort_worst_first(findings), most)
    lines, rest = next(islice(pages, page - 1, None), ([f"there is no page {page}"], []))
    return "".join(f"{escape_for_log(line)}\n" for line in (*lines, *_count_rest(rest, more)))


def _iter_pages(run: Run, ordered: Sequence[Finding], most: int) -> Iterator[tuple[list[str], Sequence[Finding]]]:
    """Yield the lines of each page with the findings that come after it."""
    lines = _list_claims(run, most)
    used, is_empty = sum(map(len, lines)), True
    told: ToldEffects = set()
    for number, finding in enumerate(ordered):
        block = ["", *_iter_block(run, finding, told)]
        size = sum(map(len, block))
        if used + size > most and not is_empty:
            yield lines, ordered[number:]
            lines, used, is_empty = [], 0, True
        lines, used, is_empty = [*lines, *block], used + size, False
    yield lines, []


def _list_claims(run: Run, most: int) -> list[str]:
    """Return the verdict, and what was not checked in at most a third of so many characters."""
    _, claim = state_claim(run)
    others = [f"not finished: {failure}" for failure in run.failures]
    for group in group_unchecked(run.unchecked_models):
        paths = join_names(dict.fromkeys(info.path for info in group.models))
        others.append(f"not checked: {paths}: {group.reason}{f' (try: {group.command})' if group.command else ''}")
    others += [f"not checked: {name}: {reason}" for name, reason in list_launched_models(run).items()]
    sizes = list(accumulate(map(len, others)))
    told = max(1, bisect_right(sizes, most // 3))
    left = len(others) - told
    return [
        f"{claim}.",
        *others[:told],
        *([f"… {format_count(left, 'more reason')} (check fewer models)"] if left > 0 else []),
    ]


def name_finding(finding: Finding) -> str:
    """Return the short id of a finding, by which an edit is asked for."""
    return finding.fingerprints[0][:ID_DIGITS]


def _iter_block(run: Run, finding: Finding, told: ToldEffects) -> Iterator[str]:
    """Yield the lines of a finding; a long diff is cut."""
    span = finding.location.span
    place = find_finding_file(run, finding) if span is None else format_place(span)
    yield f"[{name_finding(finding)}] {finding.severity} {finding.code} {place}"
    yield finding.headline
    yield f"{finding.message} ({_SURE[finding.confidence]})"
    fix = finding.fix
    for label, text in iter_details(run, finding, told):
        how = f", {_EDIT[fix.applicability if fix.edits else Applicability.DISPLAY]}" if fix and label == "Fix" else ""
        yield f"{label.lower()}{how}: {text}"
    if fix is not None:
        yield from _cut(line for _, line in iter_diff_lines(run.sources, fix.edits))


def _cut(lines: Iterable[str]) -> Iterator[str]:
    left = MOST_OF_A_FINDING
    for line in lines:
        left -= len(line)
        if left < 0:
            yield "… (the rest of the diff: --diff)"
            return
        yield line


def _count_rest(findings: Sequence[Finding], more: str) -> Iterator[str]:
    """Yield what was left out, by rule, and how to ask for it."""
    if findings:
        counts = Counter((finding.code, str(finding.severity)) for finding in findings)
        listed = ", ".join(f"{code} {format_count(count, severity)}" for (code, severity), count in counts.items())
        yield ""
        yield f"{format_count(len(findings), 'more finding')}: {listed} ({more})"
