"""What differs in the files around the robots: a row for each statement, with its places in both versions."""

from __future__ import annotations

from urdfcheck.core import Span
from urdfcheck.core.model_diff import Diff, SeamChange
from urdfcheck.output.changes.causes import strip_revision
from urdfcheck.output.changes.html.rows import render_fact, render_kind
from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.shared.wording import format_place, get_base_name

# The id of the section.
SECTION = "around"


def render_seams(diff: Diff) -> str:
    """Render what differs around the robots, a list for each kind of file; nothing without differences."""
    if not diff.seams:
        return ""
    kinds: dict[str, list[str]] = {}
    for change in diff.seams:
        kinds.setdefault(change.kind, []).append(_render_seam(diff, change))
    groups = "".join(render_kind(kind, rows) for kind, rows in kinds.items())
    count = f'<span class="count">{len(diff.seams)}</span>'
    return f'<section class="model" id="{SECTION}"><h2>Around the robot {count}</h2><div class="changes">{groups}</div></section>'


def _render_seam(diff: Diff, change: SeamChange) -> str:
    sides = ((change.before, diff.before), (change.after, diff.after))
    places = [_render_place(span, version) for span, version in sides if span is not None]
    return render_fact(escape_html(change.text), f'<span class="places">{" → ".join(places)}</span>')


def _render_place(span: Span, version: str) -> str:
    """Render where a statement is: the file without its folders, which the title has."""
    short = f"{get_base_name(strip_revision(span.file, version))}:{span.line}"
    return f'<code title="{escape_html(format_place(span))}">{escape_html(short)}</code>'
