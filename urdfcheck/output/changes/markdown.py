"""The comparison of two versions as Markdown: a comment on a pull request, with the verdict and a table; the rest is folded.

Untrusted text is code or plain words, like in the report of a check.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from urdfcheck.core import Finding, Severity
from urdfcheck.core.model_diff import COSMETIC, IDENTICAL, UNKNOWN, Diff, ModelDiff
from urdfcheck.core.text import format_count
from urdfcheck.output.changes.causes import SharedCause, merge_causes
from urdfcheck.output.changes.summary import count_findings, describe_verdict, get_label, list_harm
from urdfcheck.output.changes.text import (
    describe_idle_edits,
    describe_seam,
    describe_torque,
    describe_unread,
    group_alike,
    has_headline,
    name_models,
)
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
    return _render_page(diff, BoundedPage(COMMENT_LIMIT, [MARKER]))


def render_job_summary(diff: Diff, byte_limit: int) -> str:
    """Render the summary of a job in at most ``byte_limit`` bytes."""
    return _render_page(diff, BoundedPage(byte_limit, []))


def _render_page(diff: Diff, page: BoundedPage) -> str:
    page.add_lines(f"### {_VERDICT_SIGNS.get(diff.verdict, '🔀')} {_describe_verdict(diff)}", "")
    versions = f"{format_code_span(diff.before)} → {format_code_span(diff.after)}"
    page.add_lines(" · ".join((versions, *(f"**{harm}**" for harm in list_harm(diff)), count_findings(diff))), "")
    failures = [failure for failure in diff.failures if not has_headline(diff, failure)]
    blocks = [[f"- not compared: {escape_for_markdown(truncate_text(text))}"] for text in (*failures, *diff.notes)]
    page.add_group("part that was not compared", head=[], blocks=blocks, foot=[""])
    _add_changes(page, diff)
    _add_causes(page, diff)
    _add_findings(page, diff)
    _add_notes(page, diff)
    return page.build_text()


def _describe_verdict(diff: Diff) -> str:
    """Return the verdict, of the only model with its name."""
    verdict = escape_for_markdown(truncate_text(describe_verdict(diff)))
    if len(diff.models) != 1:
        return verdict
    return f"{format_code_span(diff.models[0].after or diff.models[0].before)}: {verdict}"


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
        yield _format_row(name, get_label(change.category), text)
    for torque in found.torques:
        yield _format_row(name, "gravity", describe_torque(torque))
    for effect, text in zip(found.effects, model.effects, strict=True):
        yield _format_row(name, effect.kind, text)
    if unread := describe_unread(found):
        yield _format_row(name, "collision", unread)


def _format_row(name: str, kind: str, text: str) -> str:
    return f"| {name} | {kind} | {escape_for_markdown(truncate_text(text))} |"


def _add_causes(page: BoundedPage, diff: Diff) -> None:
    """Add the lines that caused the changes, as diffs, the one with the most changes first, folded."""
    blocks = [_format_cause(shared) for shared in merge_causes(diff.models)]
    head, foot = make_fold("🔎 the lines that caused it")
    page.add_group("cause", head=head, blocks=blocks, foot=foot)


def _format_cause(shared: SharedCause) -> list[str]:
    cause = shared.cause
    lines = [
        truncate_text(escape_one_line(f"{sign} {file}:{line}  {text}"))
        for sign, side in (("-", cause.before), ("+", cause.after))
        for file, line, text in side
    ]
    changes = format_count(len(shared.changes), "change")
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
        for note in (*model.notes, *([describe_idle_edits(model)] if model.idle_edits else ()))
    ]
    head, foot = make_fold(f"{SIGNS[Severity.INFO]} other descriptions of the same ({len(blocks)})")
    page.add_group("note", head=head, blocks=blocks, foot=foot)
