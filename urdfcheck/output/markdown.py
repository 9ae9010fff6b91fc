"""The report as Markdown: a comment on a pull request, and the summary of a job.

Untrusted text is code or plain words: it cannot add markup, links, pictures or mentions, nor close a cell or a fence.
"""

from __future__ import annotations

import html
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
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
from urdfcheck.output.shared.verdict.claim import describe_losses
from urdfcheck.output.shared.verdict.effects import ToldEffects, list_new_effects
from urdfcheck.output.shared.verdict.finding_details import describe_other_places
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
    get_base_name,
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
    Applicability.UNSAFE: "review first",
}
TABLE = ("| | what | where |", "| --- | --- | --- |")
# Limits of a text in characters and of a diff in lines: the other reports have everything.
LONGEST_TEXT, MOST_LINES = 600, 30
# Rows of errors and warnings that are not folded, in a comment and in a summary.
MOST_ROWS, MOST_SUMMARY_ROWS = 12, 100
# Places in a row.
MOST_PLACES = 3
MOST_TREES = 5
# Models that are named together.
MOST_NAMED = 5
# Bytes reserved for the last line and the end of a fold.
RESERVE = 500
_TICKS = re.compile("`+")


def render(run: Run) -> str:
    """Render a comment: the verdict, a table of headlines and places, and everything else folded."""
    page = _BoundedPage(COMMENT_LIMIT, [MARKER])
    _add_head(page, run)
    _add_findings(page, run, most=MOST_ROWS)
    _add_details(page, run)
    _add_notes(page, run)
    _add_trees(page, run, folded=True)
    return page.build_text()


def render_job_summary(run: Run, reports: Sequence[str] = (), byte_limit: int = SUMMARY_LIMIT) -> str:
    """Render the summary of a job in at most ``byte_limit`` bytes; ``reports``: the files of the run's HTML reports."""
    page = _BoundedPage(min(byte_limit, SUMMARY_LIMIT), [])
    _add_head(page, run)
    for report in reports:
        page.add_lines(f"The whole report, with the robot in 3D: {format_code_span(report)}", "")
    _add_findings(page, run, most=MOST_SUMMARY_ROWS)
    _add_details(page, run)
    _add_notes(page, run)
    _add_models(page, run)
    _add_trees(page, run, folded=False)
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
    losses = describe_losses(run)
    page.add_lines(f"### {VERDICT_SIGNS[kind]} {_describe_robot(run)}: {sentence}{losses and f'; {losses}'}", "")
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


def _describe_robot(run: Run) -> str:
    """Return the name of the robot if there is one model, else that of urdfcheck."""
    name = run.models[0].robot if len(run.models) == 1 else ""
    return format_code_span(name) if name else "urdfcheck"


def _add_findings(page: _BoundedPage, run: Run, *, most: int) -> None:
    """Add the errors and warnings, a row each, those beyond the first ``most`` folded."""
    urgent = [f for f in sort_worst_first(run.active_findings) if f.severity > Severity.INFO]
    rows = [[row] for row in _iter_finding_rows(run, urgent)]
    page.add_group("error or warning", head=TABLE, blocks=rows[:most], foot=[""])
    head, foot = _make_fold(f"{len(rows) - most} more errors and warnings")
    page.add_group("error or warning", head=[*head, *TABLE], blocks=rows[most:], foot=foot)


def _add_notes(page: _BoundedPage, run: Run) -> None:
    notes = [f for f in sort_worst_first(run.active_findings) if f.severity == Severity.INFO]
    head, foot = _make_fold(f"{SIGNS[Severity.INFO]} {format_count(len(notes), 'note')}")
    blocks = [[row] for row in _iter_finding_rows(run, notes)]
    page.add_group("note", head=[*head, *TABLE], blocks=blocks, foot=foot)


def _iter_finding_rows(run: Run, findings: Sequence[Finding]) -> Iterator[str]:
    """Yield a row for each headline: what is wrong, and the places."""
    groups: dict[tuple[Severity, str, str], list[Finding]] = {}
    for finding in findings:
        groups.setdefault((finding.severity, finding.code, finding.headline), []).append(finding)
    names = Counter(map(get_base_name, run.sources))
    for (severity, code, headline), group in groups.items():
        times = f" ×{len(group)}" if len(group) > 1 else ""
        places = _list_places(group, names)
        shown = ", ".join(map(format_code_span, places[:MOST_PLACES]))
        more = f" and {len(places) - MOST_PLACES} more" if len(places) > MOST_PLACES else ""
        yield f"| {SIGNS[severity]} | {escape_for_markdown(headline)}{times} ({code}) | {shown}{more} |"


def _list_places(findings: Iterable[Finding], names: Mapping[str, int]) -> list[str]:
    """Return the places of findings: ``file:line``, without the folder where one file has this name; ``:line`` for the same
    file."""
    places: dict[str, None] = {}
    last = ""
    for finding in findings:
        here = finding.location.file
        if not here:
            places.setdefault(finding.location.subject)
        for span in (finding.location.span, *(place.span for place in finding.related)):
            if span is not None and span.file == here:
                name = get_base_name(here) if names.get(get_base_name(here)) == 1 else here
                places.setdefault(f"{'' if here == last else name}:{span.line}")
                last = here
    return list(places)


def _add_details(page: _BoundedPage, run: Run) -> None:
    """Add the evidence, the consequences and the repairs of errors and warnings, and the repairs of notes, folded."""
    told: ToldEffects = set()
    blocks = []
    for finding in sort_worst_first(run.active_findings):
        repair = _format_repair(run, finding)
        if finding.severity > Severity.INFO or repair:
            blocks.append([*_format_evidence(run, finding, told), *repair])
    head, foot = _make_fold(f"🔧 evidence, consequences and repairs ({len(blocks)})")
    page.add_group("explanation", head=head, blocks=blocks, foot=foot)


def _format_evidence(run: Run, finding: Finding, told: ToldEffects) -> list[str]:
    span = finding.location.span
    where = format_code_span(finding.location.subject if span is None else format_place(span))
    arguments = " ".join(
        format_code_span(f"{name}:={value}") for name, value in sorted(run.find_variant_arguments(finding).items())
    )
    models = describe_models(run, finding)
    shared = f" in {escape_for_markdown(models)}" if models else ""
    title = f"**{SIGNS[finding.severity]} {finding.code} {escape_for_markdown(finding.headline)}**"
    effects = [
        f"- {escape_for_markdown(names)}: {escape_for_markdown(_truncate_text(effect))}"
        for names, effect in list_new_effects(run, finding, told)
    ]
    place = f"{where}{f' with {arguments}' if arguments else ''}{shared}"
    message = escape_for_markdown(_truncate_text(finding.message))
    others = [f"- also {escape_for_markdown(_truncate_text(other))}" for other in describe_other_places(finding)]
    listed = [*others, *effects]
    return [title, "", f"{place}: {message}", "", *listed, *([""] if listed else [])]


def _format_repair(run: Run, finding: Finding) -> list[str]:
    fix = finding.fix
    if fix is None or not fix.edits or fix.applicability not in APPLICABILITY_TEXTS:
        return []
    lines = [line for _, line in iter_diff_lines(run.sources, fix.edits)]
    if len(lines) > MOST_LINES:
        lines = [*lines[:MOST_LINES], f"… {len(lines) - MOST_LINES} more lines"]
    title = f"Repair: {escape_for_markdown(_truncate_text(fix.title))} ({APPLICABILITY_TEXTS[fix.applicability]})"
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
