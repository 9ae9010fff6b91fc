"""The strip under the verdict: a chip for each program, and what it does with the model."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from urdfcheck.core import Finding, Rule
from urdfcheck.output.html.glyphs import render_glyph
from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.html.program_outcomes import mark_programs


def render_program_strip(
    findings: Iterable[Finding], rules: Mapping[str, Rule], *, part: str, listed: Iterable[Finding] | None = None
) -> str:
    """Render the chips, which are links to the table of the part; the page's script makes filters of them.

    ``listed``: see `mark_programs`.
    """
    chips = "".join(
        f'<li><a class="chip {mark.kind}" href="#{part}-consumers" data-program="{mark.program}"'
        f"{'' if mark.is_listed else ' data-unlisted'} "
        f'title="{escape_html(mark.name)} {escape_html(mark.words)}">{render_glyph(mark.kind)} {escape_html(mark.name)}'
        f'<span class="sr"> {escape_html(mark.words)}</span></a></li>'
        for mark in mark_programs(findings, rules, listed)
    )
    return f'<ul class="programs" aria-label="In each program" data-model="{part}">{chips}</ul>'
