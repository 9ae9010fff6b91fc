"""The report as Markdown: a comment on a pull request, and the summary of a job.

Untrusted text is code or plain words: it cannot add markup, links, pictures or mentions, nor close a cell or a fence.
"""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.core import Run
from urdfcheck.output.markdown.bounded_page import BoundedPage
from urdfcheck.output.markdown.explanations import add_brief_explanations, add_diffs, add_explanations
from urdfcheck.output.markdown.finding_rows import add_notes, add_urgent_findings
from urdfcheck.output.markdown.overview import (
    add_folded_trees,
    add_models,
    add_skipped_checks,
    add_trees,
    add_verdict,
)
from urdfcheck.output.shared.escaping import format_code_span

# At the top of a comment, so that a bot finds and replaces its own.
MARKER = "<!-- urdfcheck report -->"
# In bytes: GitHub accepts comments of 65,536 characters and summaries of 1 MiB from a step.
COMMENT_LIMIT, SUMMARY_LIMIT = 65_000, 1_000_000
# Lines of a comment that diffs and trees may fill: who reads a thread scrolls past longer ones.
COMMENT_LINES = 60
# Rows of errors and warnings that are not folded, in a comment and in a summary.
MOST_ROWS, MOST_SUMMARY_ROWS = 12, 100


def render(run: Run) -> str:
    """Render a comment: the verdict, a table of headlines and places, everything else folded, and diffs while they are few."""
    page = BoundedPage(COMMENT_LIMIT, [MARKER])
    add_verdict(page, run)
    add_urgent_findings(page, run, most=MOST_ROWS)
    add_brief_explanations(page, run)
    add_notes(page, run)
    page.most_lines = COMMENT_LINES
    add_diffs(page, run)
    add_folded_trees(page, run)
    return page.build_text()


def render_job_summary(run: Run, reports: Sequence[str] = (), byte_limit: int = SUMMARY_LIMIT) -> str:
    """Render the summary of a job in at most ``byte_limit`` bytes; ``reports``: the files of the run's HTML reports."""
    page = BoundedPage(min(byte_limit, SUMMARY_LIMIT), [])
    add_verdict(page, run)
    for report in reports:
        page.add_lines(f"The whole report, with the robot in 3D: {format_code_span(report)}", "")
    add_urgent_findings(page, run, most=MOST_SUMMARY_ROWS)
    add_explanations(page, run)
    add_notes(page, run)
    add_models(page, run)
    add_trees(page, run)
    add_skipped_checks(page, run)
    return page.build_text()
