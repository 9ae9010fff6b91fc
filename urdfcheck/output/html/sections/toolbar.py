"""The bar that stays in sight: the way through the page, search and filters."""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.core import Run, Severity
from urdfcheck.output.html.glyphs import pluralize_severity, render_badges, render_glyph
from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.html.report_parts import ReportPart
from urdfcheck.output.shared.wording import SEVERITY_ORDER, format_count

# Up to this many models and files are in the bar itself; more are in a menu.
MOST_ROWS = 4
GROUPS = (("severity", "severity"), ("rule", "rule"), ("element", "link or joint"), ("file", "file"))


def render_toolbar(run: Run, parts: Sequence[ReportPart], has_rules: bool) -> str:
    """Render the bar that stays in sight: the navigation, and the tools to search and filter."""
    return f'<div class="bar">{_render_navigation(parts, has_rules)}{_render_tools(run)}</div>'


def _render_tools(run: Run) -> str:
    """Render the tools: the severity tiles need only the style; the page's script reveals the rest and fills the lists."""
    counts = {severity: run.count_findings(severity) for severity in SEVERITY_ORDER}
    tiles = "".join(_render_severity_tile(s, counts[s], sum(map(bool, counts.values())) > 1) for s in SEVERITY_ORDER)
    chosen = "".join(
        f'<label>{name} <select id="by-{key}"><option value="">all</option></select></label>'
        for key, name in (("rule", "Rule"), ("element", "Link or joint"), ("confidence", "Confidence"))
    )
    grouped = "".join(f'<option value="{key}">{name}</option>' for key, name in GROUPS)
    suppressed = sum(finding.suppressed is not None for finding in run.findings)
    also = f'<label><input type="checkbox" id="with-known"> {suppressed} known</label>' if suppressed else ""
    return (
        '<div class="tools" role="search" aria-label="Findings"><div class="find">'
        '<label class="act" hidden><span class="sr">Search the findings</span>'
        '<input type="search" id="find" placeholder="Search" aria-keyshortcuts="/"></label>'
        f'<fieldset class="tiles"><legend class="sr">Findings by severity</legend>{tiles}</fieldset>'
        '<button type="button" class="act" id="more" aria-expanded="false" aria-controls="filters" hidden>Filter</button></div>'
        f'<div id="filters" class="filters" hidden>{chosen}<label>Group by <select id="group">{grouped}</select></label>{also}'
        '<button type="button" id="unfold">Open all</button></div>'
        '<div class="state" hidden><button type="button" id="back" hidden></button><p id="shown" role="status"></p>'
        '<button type="button" id="chip" hidden></button>'
        '<button type="button" id="reset" hidden>Reset</button></div></div>'
    )


def _render_severity_tile(severity: Severity, count: int, is_filter: bool) -> str:
    content = f"{render_glyph(severity)} <b>{count}</b> <span>{pluralize_severity(count, severity)}</span>"
    if not count or not is_filter:
        return f'<span class="tile {severity}{"" if count else " none"}">{content}</span>'
    # Hidden without the style, because the checkbox would do nothing.
    return (
        f'<label class="tile {severity}"><input type="checkbox" id="show-{severity}" checked hidden>{content}</label>'
    )


def _render_navigation(parts: Sequence[ReportPart], has_rules: bool) -> str:
    """Render links to the sections of the only robot, or to several robots with their counts; then to the common sections."""
    drawn = [part for part in parts if part.sections]
    titles = [part.title for part in parts]
    rows = []
    for part in parts:
        if drawn == [part]:
            rows += [f'<li><a href="#{i}">{name}</a></li>' for i, name in part.sections]
        else:
            rows.append(
                f'<li><a href="#{part.id}"><span class="name">{escape_html(part.title)}{_render_file_label(part, titles)}</span>'
                f'<span class="badges">{_render_badges(part)}</span></a></li>'
            )
    rest = [("rules" if has_rules else "skipped", "Rules and checks"), ("about", "About")]
    more = "".join(f'<li><a href="#{i}">{name}</a></li>' for i, name in rest)
    if len(parts) > MOST_ROWS:
        listed = f'<details class="menu"><summary>{_count_parts(parts)}</summary><ul>{"".join(rows)}</ul></details>'
        return f'<nav aria-label="Contents">{listed}<ul>{more}</ul></nav>'
    return f'<nav aria-label="Contents"><ul>{"".join(rows)}{more}</ul></nav>'


def _render_badges(part: ReportPart) -> str:
    return render_badges(part.counts, is_checked=part.is_checked, is_set_aside=bool(part.set_aside))


def _count_parts(parts: Sequence[ReportPart]) -> str:
    """Return ``4 models and 1 other file``."""
    models = sum(part.info is not None for part in parts)
    others = len(parts) - models
    return " and ".join(format_count(n, word) for n, word in ((models, "model"), (others, "other file")) if n)


def _render_file_label(part: ReportPart, titles: Sequence[str]) -> str:
    return f" <small>{escape_html(part.file_label)}</small>" if titles.count(part.title) > 1 else ""
