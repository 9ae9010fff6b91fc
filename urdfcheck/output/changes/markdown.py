"""The comparison of two versions as Markdown: a comment on a pull request, with the verdict and a table; the rest is folded.

Untrusted text is code or plain words, like in the report of a check.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from urdfcheck.core import Finding, Severity
from urdfcheck.core.model_diff import COSMETIC, IDENTICAL, UNKNOWN, ChangeCause, Diff, ModelDiff
from urdfcheck.core.text import format_count
from urdfcheck.output.changes.text import LABELS, describe_seam, describe_torque, group_alike, has_headline, name_models
from urdfcheck.output.markdown.bounded_page import BoundedPage, make_fold, truncate_text
from urdfcheck.output.markdown.explanations import wrap_in_fence
from urdfcheck.output.markdown.finding_rows import SIGNS
from urdfcheck.output.shared.escaping import escape_for_markdown, escape_one_line, format_code_span
from urdfcheck.output.shared.wording import format_place

# At the top of a comment, so that a bot finds and replaces its own.
MARKER = "<!-- urdfcheck diff -->"
# In bytes: GitHub accepts comments of 65,536 characters.
COMMENT_LIMIT = 65_000
# Rows that are not folded.
MOST_ROWS = 12
_VERDICT_SIGNS = {UNKNOWN: "❓", COSMETIC: "✅", IDENTICAL: "✅"}
_TABLE = ("| model | | what changes |", "| --- | --- | --- |")


def render(diff: Diff) -> str:
    """Render the comment."""
    page = BoundedPage(COMMENT_LIMIT, [MARKER])
    page.add_lines(f"### {_VERDICT_SIGNS.get(diff.verdict, '🔀')} {_describe_verdict(diff)}", "")
    page.add_lines(f"{format_code_span(diff.before)} → {format_code_span(diff.after)} · {_count_findings(diff)}", "")
    failures = [failure for failure in diff.failures if not has_headline(diff, failure)]
    blocks = [[f"- not compared: {escape_for_markdown(truncate_text(text))}"] for text in (*failures, *diff.notes)]
    page.add_group("part that was not compared", head=[], blocks=blocks, foot=[""])
    _add_changes(page, diff)
    _add_causes(page, diff)
    _add_findings(page, diff)
    _add_notes(page, diff)
    return page.build_text()


def _describe_verdict(diff: Diff) -> str:
    """Return the headline of the only model, or how many models have the worst verdict."""
    if not diff.models:
        return "not compared" if diff.failures else "identical: no robot uses a file that differs"
    if len(diff.models) == 1:
        model = diff.models[0]
        return f"{format_code_span(model.after or model.before)}: {escape_for_markdown(truncate_text(model.headline))}"
    unknown = sum(model.verdict == UNKNOWN for model in diff.models)
    changed = sum(model.verdict not in {UNKNOWN, COSMETIC, IDENTICAL} for model in diff.models)
    lost = f"; {unknown} cannot be compared" if unknown else ""
    if not changed:
        return f"no robot changes, of {len(diff.models)}{lost}"
    return f"{format_count(changed, 'robot changes', 'robots change')}, of {len(diff.models)}{lost}"


def _count_findings(diff: Diff) -> str:
    found = diff.findings
    return f"findings: {len(found.new)} new, {len(found.gone)} gone, {found.unchanged} unchanged"


def _add_changes(page: BoundedPage, diff: Diff) -> None:
    """Add a table of the models and their changes, those beyond the first rows folded."""
    rows = [[row] for alike in group_alike(diff.models) for row in _iter_rows(alike, is_only=len(diff.models) == 1)]
    rows += [[_format_row("", change.kind, describe_seam(change))] for change in diff.seams]
    page.add_group("change", head=_TABLE, blocks=rows[:MOST_ROWS], foot=[""])
    head, foot = make_fold(format_count(len(rows) - MOST_ROWS, "more change"))
    page.add_group("change", head=[*head, *_TABLE], blocks=rows[MOST_ROWS:], foot=foot)


def _iter_rows(alike: Sequence[ModelDiff], *, is_only: bool) -> Iterator[str]:
    """Yield a row for the verdict of models that change alike, unless the title has it, and one for each change."""
    model = alike[0]
    name = "" if is_only else format_code_span(name_models(alike))
    if not is_only and model.verdict != IDENTICAL:
        yield _format_row(name, f"**{model.verdict}**", model.headline)
        name = ""
    found = model.mechanism
    if found is None:
        return
    for change, text in zip(found.changes, model.texts, strict=True):
        yield _format_row(name, LABELS.get(change.category, change.category), text)
    for torque in found.torques:
        yield _format_row(name, "gravity", describe_torque(torque))
    for effect, text in zip(found.effects, model.effects, strict=True):
        yield _format_row(name, effect.kind, text)


def _format_row(name: str, kind: str, text: str) -> str:
    return f"| {name} | {kind} | {escape_for_markdown(truncate_text(text))} |"


def _add_causes(page: BoundedPage, diff: Diff) -> None:
    """Add the lines that caused the changes, as diffs, the one with the most changes first, folded."""
    causes = [cause for m in diff.models if m.mechanism is not None for cause in m.mechanism.causes]
    blocks = [_format_cause(cause) for cause in _merge_causes(causes)]
    head, foot = make_fold("🔎 the lines that caused it")
    page.add_group("cause", head=head, blocks=blocks, foot=foot)


def _merge_causes(causes: Sequence[ChangeCause]) -> list[tuple[ChangeCause, int]]:
    """Return each cause once, with the number of its changes in all models, the largest first."""
    counts: dict[tuple[object, ...], int] = {}
    by_lines: dict[tuple[object, ...], ChangeCause] = {}
    for cause in causes:
        key = (cause.before, cause.after, cause.is_edited)
        counts[key] = counts.get(key, 0) + len(cause.changes)
        by_lines.setdefault(key, cause)
    return sorted(((by_lines[key], count) for key, count in counts.items()), key=lambda entry: -entry[1])


def _format_cause(counted: tuple[ChangeCause, int]) -> list[str]:
    cause, count = counted
    lines = [
        truncate_text(escape_one_line(f"{sign} {file}:{line}  {text}"))
        for sign, side in (("-", cause.before), ("+", cause.after))
        for file, line, text in side
    ]
    changes = format_count(count, "change")
    return [
        f"{changes} by" if cause.is_edited else f"{changes}, no edited line; typed at",
        "",
        *wrap_in_fence("diff", lines),
        "",
    ]


def _add_findings(page: BoundedPage, diff: Diff) -> None:
    """Add the new findings, then those that are gone, folded."""
    for sign, word, findings in (("🆕", "new", diff.findings.new), ("🧹", "gone", diff.findings.gone)):
        ordered = sorted(findings, key=lambda finding: -finding.severity)
        head, foot = make_fold(f"{sign} findings: {len(ordered)} {word}")
        table = ["| | what | where |", "| --- | --- | --- |"]
        page.add_group(
            f"{word} finding", head=[*head, *table], blocks=[[_format_finding(f)] for f in ordered], foot=foot
        )


def _format_finding(finding: Finding) -> str:
    span = finding.location.span
    where = format_code_span(finding.location.subject if span is None else format_place(span))
    return (
        f"| {SIGNS[Severity(finding.severity)]} | {escape_for_markdown(finding.headline)} ({finding.code}) | {where} |"
    )


def _add_notes(page: BoundedPage, diff: Diff) -> None:
    """Add what differs in the description and not in the robot, folded."""
    blocks = [
        [f"- {format_code_span(model.after or model.before)}: {escape_for_markdown(truncate_text(note))}"]
        for model in diff.models
        for note in model.notes
    ]
    head, foot = make_fold(f"{SIGNS[Severity.INFO]} other descriptions of the same ({len(blocks)})")
    page.add_group("note", head=head, blocks=blocks, foot=foot)
