"""What comes before and after the findings: the verdict, the models, the kinematic trees, and the checks that could not run."""

from __future__ import annotations

import html
from collections.abc import Callable, Iterator
from dataclasses import replace

from urdfcheck.core import Run, SkippedCheck
from urdfcheck.core.scene import Scene
from urdfcheck.core.text import join_names
from urdfcheck.output.markdown.bounded_page import BoundedPage, make_fold, truncate_text
from urdfcheck.output.markdown.explanations import wrap_in_fence
from urdfcheck.output.markdown.finding_rows import SIGNS
from urdfcheck.output.shared.escaping import escape_for_markdown, escape_one_line, format_code_span
from urdfcheck.output.shared.mermaid_chart import build_mermaid_chart
from urdfcheck.output.shared.verdict.claim import grade_by_losses
from urdfcheck.output.shared.verdict.losses import describe_losses
from urdfcheck.output.shared.verdict.not_checked import (
    ACCEPTING_KEY,
    ACCEPTING_OPTION,
    GLYPH,
    UncheckedGroup,
    describe_status,
    group_unchecked,
    is_accepted,
    list_launched_models,
)
from urdfcheck.output.shared.verdict.verdict import describe_checked_units, summarize_verdict
from urdfcheck.output.shared.wording import SEVERITY_ORDER, describe_found_arguments, format_count

VERDICT_SIGNS = {"error": "❌", "unchecked": GLYPH, "warning": "⚠️", "info": "ℹ️", "ok": "✅"}
# Models that are named together.
MOST_NAMED = 5
MOST_TREES = 5


def add_verdict(page: BoundedPage, run: Run) -> None:
    """Add the claim as a title, the counts, and what was not checked."""
    kind, sentence = summarize_verdict(run)
    losses = describe_losses(run)
    claim = "; ".join(filter(None, (sentence, losses.by_problems)))
    claim = " · ".join(filter(None, (claim, losses.by_others)))
    page.add_lines(f"### {VERDICT_SIGNS[grade_by_losses(kind, losses)]} {_describe_robot(run)}: {claim}", "")
    counts = " · ".join(f"{SIGNS[s]} {format_count(run.count_findings(s), str(s))}" for s in SEVERITY_ORDER)
    suppressed = sum(run.suppressed_counts.values())
    hidden = f" · {suppressed} known and not shown" if suppressed else ""
    page.add_lines(f"{counts} · in {describe_checked_units(run)}{hidden}", "")
    failures = [[f"- not checked: {escape_for_markdown(truncate_text(failure))}"] for failure in run.failures]
    page.add_group("failure", head=[], blocks=failures, foot=[""])
    blocks = [[_format_unchecked_group(group)] for group in group_unchecked(run.unchecked_models)]
    blocks += [
        [f"- {GLYPH} {format_code_span(name)} not checked, {escape_for_markdown(truncate_text(reason))}"]
        for name, reason in list_launched_models(run).items()
    ]
    page.add_group("reason why models were not checked", head=[], blocks=blocks, foot=[""])
    if not all(map(is_accepted, run.unchecked_models)):
        option, key = format_code_span(ACCEPTING_OPTION), format_code_span(ACCEPTING_KEY)
        page.add_lines(f"To accept that: {option}, or {key} in urdfcheck.toml", "")


def _format_unchecked_group(group: UncheckedGroup) -> str:
    names = join_names([format_code_span(info.id) for info in group.models], MOST_NAMED)
    how = f": {format_code_span(group.command)}" if group.command else ""
    return f"- {GLYPH} {names} not checked, {escape_for_markdown(truncate_text(group.reason))}{how}"


def _describe_robot(run: Run) -> str:
    """Return the name of the robot if there is one model, else that of urdfcheck."""
    name = run.models[0].robot if len(run.models) == 1 else ""
    return format_code_span(name) if name else "urdfcheck"


def add_models(page: BoundedPage, run: Run) -> None:
    """Add a table of the models."""
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


def add_trees(page: BoundedPage, run: Run) -> None:
    """Add the kinematic trees in the colours of their findings."""
    _add_trees(page, run, lambda model: ([f"#### The kinematic tree of {format_code_span(model)}", ""], [""]))


def add_folded_trees(page: BoundedPage, run: Run) -> None:
    """Add the kinematic trees in the colours of their findings, folded."""
    _add_trees(page, run, lambda model: make_fold(f"🌳 the kinematic tree of {_format_html_code(model)}"))


def _add_trees(page: BoundedPage, run: Run, frame: Callable[[str], tuple[list[str], list[str]]]) -> None:
    """Add trees between the lines that ``frame`` returns for the name of a model."""
    scenes = [scene for scene in run.scenes if len(scene.links) > 1]
    missing = max(len(scenes) - MOST_TREES, 0)
    for scene in scenes[:MOST_TREES]:
        head, foot = frame(scene.model)
        missing += not page.add_lines(*head, *_format_tree(run, scene), *foot)
    if missing:
        page.missing.append(format_count(missing, "kinematic tree"))


def _format_tree(run: Run, scene: Scene) -> list[str]:
    findings = [
        replace(finding, subjects=finding.subjects_by_model[scene.model])
        for finding in run.findings
        if scene.model in finding.subjects_by_model
    ]
    chart = build_mermaid_chart(scene, findings)
    more = f"Drawn are {chart.shown} of {chart.total} links and frames, those next to the root."
    return [*wrap_in_fence("mermaid", chart.text.splitlines()), *(["", more] if chart.shown < chart.total else [])]


def add_skipped_checks(page: BoundedPage, run: Run) -> None:
    """Add why checks could not run, folded."""
    reasons: dict[str, set[str]] = {}
    for skip in run.skipped:
        named = f" ({skip.model})" if skip.code in SkippedCheck.NO_RULES and skip.model else ""
        reasons.setdefault(f"{skip.reason}{named}", set()).add(skip.code)
    blocks = [
        [f"- {', '.join(sorted(codes))}: {escape_for_markdown(truncate_text(reason))}"]
        for reason, codes in sorted(reasons.items())
    ]
    head, foot = make_fold("checks that could not run")
    page.add_group("reason why a check could not run", head=head, blocks=blocks, foot=foot)


def _format_html_code(text: str) -> str:
    """Format a name as code for the head of a fold, which is HTML and not Markdown."""
    return f"<code>{html.escape(escape_one_line(text))}</code>"
