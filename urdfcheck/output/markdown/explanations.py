"""What is known of each finding beside its headline: the evidence, the other places, the consequences and the repair."""

from __future__ import annotations

import re
from collections.abc import Sequence

from urdfcheck.core import Applicability, Finding, Fix, Run, Severity
from urdfcheck.output.markdown.bounded_page import BoundedPage, make_fold, truncate_text
from urdfcheck.output.markdown.finding_rows import SIGNS
from urdfcheck.output.shared.diffs import iter_diff_lines
from urdfcheck.output.shared.escaping import escape_for_markdown, escape_invisible, format_code_span
from urdfcheck.output.shared.verdict.effects import ToldEffects, list_new_effects
from urdfcheck.output.shared.verdict.finding_details import describe_other_places
from urdfcheck.output.shared.wording import describe_models, format_place, sort_worst_first

APPLICABILITY_TEXTS = {
    Applicability.SAFE: "safe to apply as shown",
    Applicability.UNSAFE: "review first",
}
# Limit of a diff in lines: the other reports have everything.
MOST_DIFF_LINES = 30
_TICKS = re.compile("`+")


def add_explanations(page: BoundedPage, run: Run) -> None:
    """Add the evidence, the consequences and the repairs of errors and warnings, and the repairs of notes, folded."""
    told: ToldEffects = set()
    blocks = []
    for finding in sort_worst_first(run.active_findings):
        repair = _format_repair(run, finding)
        if finding.severity > Severity.INFO or repair:
            listed = [f"- {line}" for line in _list_evidence(run, finding, told)]
            message = f"{_format_place(run, finding)}: {escape_for_markdown(truncate_text(finding.message))}"
            blocks.append([_format_title(finding), "", message, "", *listed, *([""] if listed else []), *repair])
    _add_fold(page, blocks)


def add_brief_explanations(page: BoundedPage, run: Run) -> None:
    """Add what :func:`add_explanations` does of errors and warnings, an item of one line each, folded."""
    told: ToldEffects = set()
    blocks = []
    for finding in sort_worst_first(run.active_findings):
        if finding.severity == Severity.INFO:
            continue
        message = f"{_format_place(run, finding)}: {escape_for_markdown(truncate_text(finding.message))}"
        repair = [] if finding.fix is None else [f"**Repair**: {_format_repair_title(finding.fix)}"]
        blocks.append(
            ["- " + "<br>".join([_format_title(finding), message, *_list_evidence(run, finding, told), *repair])]
        )
    _add_fold(page, blocks)


def add_diffs(page: BoundedPage, run: Run) -> None:
    """Add the repairs as diffs, that of the worst finding first, folded."""
    blocks = []
    for finding in sort_worst_first(run.active_findings):
        if repair := _format_repair(run, finding):
            blocks.append([_format_title(finding), "", *repair])
    head, foot = make_fold("🔧 repairs as diffs")
    page.add_group("diff", head=head, blocks=blocks, foot=foot)


def _add_fold(page: BoundedPage, blocks: Sequence[Sequence[str]]) -> None:
    head, foot = make_fold(f"🔧 evidence, consequences and repairs ({len(blocks)})")
    page.add_group("explanation", head=head, blocks=blocks, foot=foot)


def _format_title(finding: Finding) -> str:
    return f"**{SIGNS[finding.severity]} {finding.code} {escape_for_markdown(finding.headline)}**"


def _format_place(run: Run, finding: Finding) -> str:
    """Return the place, and the arguments and models that it holds for."""
    span = finding.location.span
    where = format_code_span(finding.location.subject if span is None else format_place(span))
    arguments = " ".join(
        format_code_span(f"{name}:={value}") for name, value in sorted(run.find_variant_arguments(finding).items())
    )
    models = describe_models(run, finding)
    shared = f" in {escape_for_markdown(models)}" if models else ""
    return f"{where}{f' with {arguments}' if arguments else ''}{shared}"


def _list_evidence(run: Run, finding: Finding, told: ToldEffects) -> list[str]:
    """List the other places, and what programs do."""
    others = [f"also {escape_for_markdown(truncate_text(other))}" for other in describe_other_places(finding)]
    effects = [
        f"{escape_for_markdown(names)}: {escape_for_markdown(truncate_text(effect))}"
        for names, effect in list_new_effects(run, finding, told)
    ]
    return [*others, *effects]


def _format_repair(run: Run, finding: Finding) -> list[str]:
    fix = finding.fix
    if fix is None or not fix.edits or fix.applicability not in APPLICABILITY_TEXTS:
        return []
    lines = [line for _, line in iter_diff_lines(run.sources, fix.edits)]
    if len(lines) > MOST_DIFF_LINES:
        lines = [*lines[:MOST_DIFF_LINES], f"… {len(lines) - MOST_DIFF_LINES} more lines"]
    fence = wrap_in_fence("diff", [truncate_text(escape_invisible(line)) for line in lines])
    return [f"Repair: {_format_repair_title(fix)}", "", *fence, ""]


def _format_repair_title(fix: Fix) -> str:
    title = escape_for_markdown(truncate_text(fix.title))
    return f"{title} ({APPLICABILITY_TEXTS[fix.applicability]})" if fix.applicability in APPLICABILITY_TEXTS else title


def wrap_in_fence(language: str, lines: Sequence[str]) -> list[str]:
    """Wrap lines in a fence that is longer than any run of backticks in them."""
    longest = max((len(ticks) for line in lines for ticks in _TICKS.findall(line)), default=0)
    fence = "`" * max(3, longest + 1)
    return [f"{fence}{language}", *lines, fence]
