"""The whole HTML report as one document."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence

from urdfcheck.core import Run
from urdfcheck.output.html.glyphs import SYMBOLS
from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.html.page_frame import read_page_script, read_style_sheet, render_document_head
from urdfcheck.output.html.report_parts import ReportPart, collect_report_parts
from urdfcheck.output.html.sections.appendix import list_fired_rules, render_appendix
from urdfcheck.output.html.sections.key_help import VIEWER_KEYS, render_key_help
from urdfcheck.output.html.sections.model_section import render_model, render_part_strip
from urdfcheck.output.html.sections.page_header import make_report_title, render_header
from urdfcheck.output.html.sections.toolbar import render_toolbar
from urdfcheck.output.html.sections.unused_macros import render_unused_macros
from urdfcheck.output.html.viewer.scene_data import build_scene_data
from urdfcheck.output.html.viewer.viewer_page import read_viewer_style, render_viewer, render_viewer_scripts
from urdfcheck.output.shared.escaping import escape_for_html, escape_for_json
from urdfcheck.output.shared.verdict.losses import list_refusing_notes

KEYS = (
    ("/", "search the findings"),
    ("j, k", "next and previous finding"),
    ("Enter", "open or close it"),
    *VIEWER_KEYS,
    ("b", "hold: the other state of a repair in 3D, before or after"),
    ("Esc", "clear selection, search and filters"),
    ("?", "this list"),
)


def render(run: Run) -> str:
    """Render the whole document. Only the text of ``class="seconds"`` differs between equal runs."""
    run = list_refusing_notes(run)
    return render_document(run, collect_report_parts(run), title=make_report_title(run))


def render_document(run: Run, parts: Sequence[ReportPart], *, title: str, index_file: str = "") -> str:
    """Render the document for the parts of a run; ``index_file``: the page with all models, for a page of a folder."""
    drawn = [part for part in parts if part.scene is not None]
    models = "\n".join(render_model(run, part, is_only_model=len(drawn) == 1) for part in parts)
    strip = render_part_strip(run, drawn[0]) if len(run.models) == len(drawn) == 1 else ""
    body = escape_for_html(f"""{SYMBOLS}
<a class="skip" href="#content">Skip to the findings</a>
<div class="page">
{render_header(run, title, index_file, strip=strip)}
{render_viewer() if drawn else ""}
<div class="column">
{render_toolbar(run, parts, bool(list_fired_rules(run)))}
<main id="content">
<p class="nothing" id="nothing" role="status" hidden></p>
{_render_failures(run)}{models}
{render_unused_macros(run.unused_macro_files)}
{render_appendix(run)}
</main>
</div>
</div>
{render_key_help(KEYS)}
""")
    scripts, allowed = _render_scene_scripts(drawn) if drawn else ("", [])
    style = read_style_sheet() + (read_viewer_style() if drawn else "")
    return f"""{render_document_head(title, style, [*allowed, read_page_script()])}<body>
{body}{scripts}<script>{read_page_script()}</script>
</body>
</html>
"""


def _render_scene_scripts(drawn: Sequence[ReportPart]) -> tuple[str, list[str]]:
    """Render what draws the robots; return it and the texts of its scripts. ASCII JSON needs no escaping in HTML."""
    titles = Counter(part.title for part in drawn)
    names = (part.title if titles[part.title] == 1 else f"{part.title} ({part.file_label})" for part in drawn)
    models = [(p.id, name, p.scene, p.all_cards) for p, name in zip(drawn, names, strict=True) if p.scene is not None]
    data, geometry = build_scene_data(models)
    return render_viewer_scripts(escape_for_json(json.dumps(data, separators=(",", ":"), allow_nan=False)), geometry)


def _render_failures(run: Run) -> str:
    if not run.failures:
        return ""
    items = "".join(f"<li>{escape_html(failure)}</li>" for failure in run.failures)
    return f'<section class="failures"><h2>What could not be checked</h2><ul>{items}</ul></section>\n'
