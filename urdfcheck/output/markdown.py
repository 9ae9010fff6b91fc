"""The report as Markdown: a comment on a pull request, and the summary of a job.

Untrusted text is code or plain words: it cannot add markup, links, pictures or mentions, nor close a cell or a fence.
"""

from __future__ import annotations

import html
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from urdfcheck.core import Applicability, Finding, Run, Severity
from urdfcheck.core.scene import Scene
from urdfcheck.output.shared.diffs import iter_diff_lines
from urdfcheck.output.shared.escaping import (
    escape_for_log,
    escape_for_markdown,
    escape_invisible,
    escape_one_line,
    format_code_span,
)
from urdfcheck.output.shared.mermaid_chart import build_mermaid_chart
from urdfcheck.output.shared.verdict.effects import list_effects
from urdfcheck.output.shared.verdict.not_checked import (
    ACCEPTING_KEY,
    ACCEPTING_OPTION,
    GLYPH,
    UncheckedGroup,
    describe_status,
    group_unchecked,
    is_accepted,
)
from urdfcheck.output.shared.verdict.verdict import describe_checked_units, summarize_verdict
from urdfcheck.output.shared.wording import (
    SEVERITY_ORDER,
    describe_found_arguments,
    describe_models,
    format_count,
    format_place,
    join_first,
    sort_worst_first,
)

# At the top of a comment, so that a bot finds and replaces its own.
MARKER = "<!-- urdfcheck report -->"
# In bytes: GitHub accepts comments of 65,536 characters and summaries of 1 MiB from a step.
COMMENT_LIMIT, SUMMARY_LIMIT = 65_000, 1_000_000
SIGNS = {Severity.ERROR: "❌", Severity.WARNING: "⚠️", Severity.INFO: "ℹ️"}
VERDICT_SIGNS = {"error": "❌", "unchecked": GLYPH, "warning": "⚠️", "ok": "✅"}
APPLICABILITY_TEXTS = {
    Applicability.SAFE: "safe to apply as shown",
    Applicability.UNSAFE: "review it before it is applied",
}
# Limits of a table cell and of a diff, in characters, effects and lines: the other reports have everything.
LONGEST_TEXT, MOST_EFFECTS, MOST_LINES = 600, 3, 30
MOST_TREES = 5
# Models that are named together.
MOST_NAMED = 5
# Bytes reserved for the last line and the end of a fold.
RESERVE = 500
_TICKS = re.compile("`+")


def render(run: Run) -> str:
    """Render a comment: the verdict, a table of errors and warnings, and the less urgent rest folded."""
    page = _BoundedPage(COMMENT_LIMIT, [MARKER])
    _add_head(page, run)
    _add_findings(page, run)
    _add_repairs(page, run)
    _add_trees(page, run, folded=True)
    return page.build_text()


def render_job_summary(run: Run, reports: Sequence[str] = (), byte_limit: int = SUMMARY_LIMIT) -> str:
    """Render the summary of a job in at most ``byte_limit`` bytes; ``reports``: the files of the run's HTML reports."""
    page = _BoundedPage(min(byte_limit, SUMMARY_LIMIT), [])
    _add_head(page, run)
    for report in reports:
        page.add_lines(f"The whole report, with the robot in 3D: {format_code_span(report)}", "")
    _add_findings(page, run)
    _add_models(page, run)
    _add_trees(page, run, folded=False)
    _add_repairs(page, run)
    _add_skipped(page, run)
    return page.build_text()


class _BoundedPage:
    """Lines of a document of at most ``room`` bytes; what does not fit is counted, and reported at the end."""

    def __init__(self, room: int, lines: Iterable[str]) -> None:
        self.lines = list(lines)
        self.left = room - RESERVE - sum(map(_measure_size, self.lines))
        self.missing: list[str] = []

    def add_lines(self, *lines: str) -> bool:
        """Add the lines if all of them fit, and return whether they did."""
        lines = tuple(map(escape_for_log, lines))
        size = sum(map(_measure_size, lines))
        if size > self.left:
            return False
        self.left -= size
        self.lines += lines
        return True

    def add_group(
        self, noun: str, *, head: Sequence[str], blocks: Sequence[Sequence[str]], foot: Sequence[str]
    ) -> None:
        """Add as many blocks as fit between a head and a foot; ``noun``: the word for one block."""
        self.left -= sum(map(_measure_size, foot))
        shown = 0
        if blocks and self.add_lines(*head):
            while shown < len(blocks) and self.add_lines(*blocks[shown]):
                shown += 1
            self.lines += foot
        else:
            self.left += sum(map(_measure_size, foot))
        if shown < len(blocks):
            self.missing.append(format_count(len(blocks) - shown, noun))

    def build_text(self) -> str:
        """Join the lines, and report at the end what did not fit."""
        if self.missing:
            missing = ", ".join(self.missing)
            self.lines.append(
                f"*Left out, because a page like this has its limits: {missing}. The other reports have all.*"
            )
        return "\n".join(self.lines).rstrip("\n") + "\n"


def _measure_size(line: str) -> int:
    return len(line.encode(errors="replace")) + 1


def _make_fold(summary: str) -> tuple[list[str], list[str]]:
    return ["<details>", f"<summary>{summary}</summary>", ""], ["", "</details>", ""]


def _add_head(page: _BoundedPage, run: Run) -> None:
    kind, sentence = summarize_verdict(run)
    page.add_lines(f"### {VERDICT_SIGNS[kind]} urdfcheck: {sentence}", "")
    counts = " · ".join(f"{SIGNS[s]} {format_count(run.count_findings(s), str(s))}" for s in SEVERITY_ORDER)
    suppressed = sum(run.suppressed_counts.values())
    hidden = f" · {suppressed} known and not shown" if suppressed else ""
    page.add_lines(f"{counts} · in {describe_checked_units(run)}{hidden}", "")
    failures = [[f"- not checked: {escape_for_markdown(_truncate_text(failure))}"] for failure in run.failures]
    page.add_group("failure", head=[], blocks=failures, foot=[""])
    blocks = [[_format_unchecked_group(group)] for group in group_unchecked(run.unchecked_models)]
    page.add_group("reason why models were not checked", head=[], blocks=blocks, foot=[""])
    if not all(map(is_accepted, run.unchecked_models)):
        option, key = format_code_span(ACCEPTING_OPTION), format_code_span(ACCEPTING_KEY)
        page.add_lines(f"To accept that: {option}, or {key} in urdfcheck.toml", "")


def _format_unchecked_group(group: UncheckedGroup) -> str:
    names = join_first([format_code_span(info.id) for info in group.models], MOST_NAMED)
    how = f": {format_code_span(group.command)}" if group.command else ""
    return f"- {GLYPH} {names} not checked, {escape_for_markdown(_truncate_text(group.reason))}{how}"


def _add_findings(page: _BoundedPage, run: Run) -> None:
    findings = sort_worst_first(run.active_findings)
    table = ["| | rule | what, where, and → what follows |", "| --- | --- | --- |"]
    urgent = [[_format_finding_row(run, finding)] for finding in findings if finding.severity > Severity.INFO]
    page.add_group("error or warning", head=table, blocks=urgent, foot=[""])
    notes = [[_format_finding_row(run, finding)] for finding in findings if finding.severity == Severity.INFO]
    head, foot = _make_fold(f"{SIGNS[Severity.INFO]} {format_count(len(notes), 'info')}: worth knowing")
    page.add_group("info", head=[*head, *table], blocks=notes, foot=foot)


def _format_finding_row(run: Run, finding: Finding) -> str:
    span = finding.location.span
    where = format_code_span(finding.location.subject if span is None else format_place(span))
    arguments = " ".join(
        format_code_span(f"{name}:={value}") for name, value in sorted(run.find_variant_arguments(finding).items())
    )
    message = escape_for_markdown(_truncate_text(finding.message))
    effects = [
        f"→ {escape_for_markdown(names)}: {escape_for_markdown(_truncate_text(effect))}"
        for names, effect in list_effects(run, finding)
    ]
    models = describe_models(run, finding)
    shared = f" in {escape_for_markdown(models)}" if models else ""
    headline = f"**{escape_for_markdown(finding.headline)}**"
    lines = [headline, f"{where}{f' with {arguments}' if arguments else ''}{shared}", message, *effects[:MOST_EFFECTS]]
    lines += ["→ …"] if len(effects) > MOST_EFFECTS else []
    severity = f"{SIGNS[finding.severity]}&nbsp;{finding.severity}"
    return f"| {severity} | **{finding.code}**<br>{finding.name} | {'<br>'.join(lines)} |"


def _add_repairs(page: _BoundedPage, run: Run) -> None:
    repairs = (_format_repair(run, finding) for finding in sort_worst_first(run.active_findings))
    blocks = [block for block in repairs if block]
    head, foot = _make_fold(
        f"🔧 {format_count(len(blocks), 'repair')} to copy, or to apply with <code>urdfcheck --fix</code>"
    )
    page.add_group("repair", head=head, blocks=blocks, foot=foot)


def _format_repair(run: Run, finding: Finding) -> list[str]:
    fix = finding.fix
    if fix is None or not fix.edits or fix.applicability not in APPLICABILITY_TEXTS:
        return []
    lines = [line for _, line in iter_diff_lines(run.sources, fix.edits)]
    if len(lines) > MOST_LINES:
        lines = [*lines[:MOST_LINES], f"… {len(lines) - MOST_LINES} more lines"]
    title = f"**{finding.code}** {escape_for_markdown(_truncate_text(fix.title))} ({APPLICABILITY_TEXTS[fix.applicability]})"
    return [title, "", *_wrap_in_fence("diff", [_truncate_text(escape_invisible(line)) for line in lines]), ""]


def _wrap_in_fence(language: str, lines: Sequence[str]) -> list[str]:
    """Wrap lines in a fence that is longer than any run of backticks in them."""
    longest = max((len(ticks) for line in lines for ticks in _TICKS.findall(line)), default=0)
    fence = "`" * max(3, longest + 1)
    return [f"{fence}{language}", *lines, fence]


def _add_models(page: _BoundedPage, run: Run) -> None:
    head = [
        "| model | robot | links | joints | mass | errors | warnings | info |",
        "| --- | --- | --: | --: | --: | --: | --: | --: |",
    ]
    page.add_group("model", head=head, blocks=[[row] for row in _iter_model_rows(run)], foot=[""])


def _iter_model_rows(run: Run) -> Iterator[str]:
    for info in run.models:
        counts = [
            sum(info.id in f.subjects_by_model and f.severity == s for f in run.active_findings) for s in SEVERITY_ORDER
        ]
        told = describe_found_arguments(info)
        name = format_code_span(info.id) + (f"<br>{escape_for_markdown(told)}" if told else "")
        cells = [name, format_code_span(info.robot) if info.robot else ""]
        if info.status == "checked":
            cells += [str(info.links), str(info.joints), "" if info.mass is None else f"{info.mass:.4g} kg"]
        else:
            cells += [f"{GLYPH} {describe_status(info)}", "", ""]
        yield f"| {' | '.join([*cells, *map(str, counts)])} |"


def _add_trees(page: _BoundedPage, run: Run, *, folded: bool) -> None:
    scenes = [scene for scene in run.scenes if len(scene.links) > 1]
    for scene in scenes[:MOST_TREES]:
        findings = [
            replace(finding, subjects=finding.subjects_by_model[scene.model])
            for finding in run.findings
            if scene.model in finding.subjects_by_model
        ]
        head, foot = _make_fold(f"🌳 the kinematic tree of {_format_html_code(scene.model)}")
        if not folded:
            head, foot = [f"#### The kinematic tree of {format_code_span(scene.model)}", ""], [""]
        if not page.add_lines(*head, *_format_tree(scene, findings), *foot):
            page.missing.append("a kinematic tree")
    if len(scenes) > MOST_TREES:
        page.missing.append(format_count(len(scenes) - MOST_TREES, "kinematic tree"))


def _format_tree(scene: Scene, findings: Sequence[Finding]) -> list[str]:
    chart = build_mermaid_chart(scene, findings)
    more = f"Drawn are {chart.shown} of {chart.total} links and frames, those next to the root."
    return [*_wrap_in_fence("mermaid", chart.text.splitlines()), *(["", more] if chart.shown < chart.total else [])]


def _add_skipped(page: _BoundedPage, run: Run) -> None:
    reasons: dict[str, set[str]] = {}
    for skip in run.skipped:
        named = f" ({skip.model})" if skip.code == "ALL" and skip.model else ""
        reasons.setdefault(f"{skip.reason}{named}", set()).add(skip.code)
    blocks = [
        [f"- {', '.join(sorted(codes))}: {escape_for_markdown(_truncate_text(reason))}"]
        for reason, codes in sorted(reasons.items())
    ]
    head, foot = _make_fold("checks that could not run")
    page.add_group("reason why a check could not run", head=head, blocks=blocks, foot=foot)


def _format_html_code(text: str) -> str:
    """Format a name as code for the head of a fold, which is HTML and not Markdown."""
    return f"<code>{html.escape(escape_one_line(text))}</code>"


def _truncate_text(text: str) -> str:
    return text if len(text) <= LONGEST_TEXT else f"{text[:LONGEST_TEXT]}…"
