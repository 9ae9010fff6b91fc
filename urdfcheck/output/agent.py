"""The findings that matter first, in a few thousand tokens: what a language model reads before it edits, and after.

A line of claim, then a block for each finding with its place, evidence, cause, effect and edit. What does not fit is counted by
rule, with the option that shows it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence

from urdfcheck.core import Applicability, Confidence, Finding, Run
from urdfcheck.output.shared.diffs import iter_diff_lines
from urdfcheck.output.shared.escaping import escape_for_log
from urdfcheck.output.shared.verdict.claim import state_claim
from urdfcheck.output.shared.verdict.effects import ToldEffects
from urdfcheck.output.shared.verdict.finding_details import iter_details
from urdfcheck.output.shared.verdict.not_checked import group_unchecked
from urdfcheck.output.shared.wording import find_finding_file, format_count, format_place, sort_worst_first

# About three thousand tokens: an answer that leaves room for the work.
MOST_CHARACTERS = 10_000
# Of one finding: twelve of them fit.
MOST_OF_A_FINDING = 1_600
# Hexadecimal digits of a fingerprint that name a finding.
ID_DIGITS = 8
_SURE = {Confidence.PROOF: "proven", Confidence.STRONG: "strong evidence", Confidence.HEURISTIC: "a hint"}
_EDIT = {Applicability.SAFE: "safe edit", Applicability.UNSAFE: "edit to check", Applicability.DISPLAY: "advice"}


def render(run: Run) -> str:
    """Render a run for a program that reads text and pays for each word."""
    return render_findings(run, run.active_findings)


def render_findings(run: Run, findings: Sequence[Finding], *, most: int = MOST_CHARACTERS) -> str:
    """Render some findings of a run in about so many characters, the worst first, and what else the run has to say."""
    _, claim = state_claim(run)
    lines = [f"{claim}."]
    lines += [f"not finished: {failure}" for failure in run.failures]
    for group in group_unchecked(run.unchecked_models):
        paths = ", ".join(dict.fromkeys(info.path for info in group.models))
        lines.append(f"not checked: {paths}: {group.reason}{f' (try: {group.command})' if group.command else ''}")
    told: ToldEffects = set()
    ordered, used = sort_worst_first(findings), sum(map(len, lines))
    rest: list[Finding] = []
    for number, finding in enumerate(ordered):
        block = list(_iter_block(run, finding, told))
        used += sum(map(len, block))
        if used > most and number:
            rest = ordered[number:]
            break
        lines += ["", *block]
    return "".join(f"{escape_for_log(line)}\n" for line in (*lines, *_count_rest(rest)))


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


def _count_rest(findings: Sequence[Finding]) -> Iterator[str]:
    """Yield what was left out, by rule, and the option that shows it."""
    if findings:
        counts = Counter((finding.code, str(finding.severity)) for finding in findings)
        listed = ", ".join(f"{code} {format_count(count, severity)}" for (code, severity), count in counts.items())
        yield ""
        yield f"{format_count(len(findings), 'more finding')}: {listed} (ask for them with --select CODE)"
