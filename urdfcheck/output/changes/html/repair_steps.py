"""What ``urdfcheck repair`` did to make the second version: a row for each step, by stage, those that it left too."""

from __future__ import annotations

from collections import Counter
from itertools import groupby

from urdfcheck.core.model_diff import DONE, LEFT, OUTCOMES, WITHDRAWN, Diff, ReportedStep
from urdfcheck.output.changes.html.compared_models import ComparedModel
from urdfcheck.output.changes.html.rows import render_kind, render_row
from urdfcheck.output.html.glyphs import render_glyph
from urdfcheck.output.html.html_text import escape_html

_SIGNS = {DONE: "ok", WITHDRAWN: "warning", LEFT: "unchecked"}
_WORDS = {DONE: "done", WITHDRAWN: "withdrawn", LEFT: "left as it was"}


def render_steps(diff: Diff, model: ComparedModel) -> str:
    """Render the steps of the repair; nothing where no repair made the second version."""
    if not diff.steps:
        return ""
    rows = [(step.stage, _render_step(model, number, step)) for number, step in enumerate(diff.steps)]
    groups = [
        render_kind(stage, [row for _, row in group]) for stage, group in groupby(rows, key=lambda entry: entry[0])
    ]
    count = f'<span class="count">{len(rows)}</span>'
    return (
        f'<section class="changes steps" id="{model.id}-steps"><h3>What the repair did {count}</h3>'
        f'<p class="facts">{escape_html(describe_steps(diff))}. The copy was checked again after each stage.</p>'
        f"{''.join(groups)}</section>"
    )


def describe_steps(diff: Diff) -> str:
    """Return how many steps were made, withdrawn and left."""
    counts = Counter(step.outcome for step in diff.steps)
    return ", ".join(f"{counts[outcome]} {_WORDS[outcome]}" for outcome in OUTCOMES if counts[outcome])


def _render_step(model: ComparedModel, number: int, step: ReportedStep) -> str:
    sign = f'<span class="sign {_SIGNS[step.outcome]}">{render_glyph(_SIGNS[step.outcome])}</span>'
    word = f'<span class="sr">{_WORDS[step.outcome]}: </span>'
    what = f"{sign} {word}<b>{escape_html(step.subject)}</b> {escape_html(step.text)}"
    return render_row(f"{model.id}-r{number}", what, is_shown=model.has_parts(step.parts))
