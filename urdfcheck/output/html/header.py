"""The head of the report, and the bar that stays in sight: what was checked, the verdict, the way through the page."""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.core import ModelInfo, Run, Severity
from urdfcheck.output.html.glyphs import pluralize_severity, render_badges, render_glyph
from urdfcheck.output.html.model import ReportPart, render_path
from urdfcheck.output.html.text import NO_VALUE, escape_html, format_number, get_base_name
from urdfcheck.output.shared.wording import SEVERITY_ORDER, format_count, summarize_verdict

MOST_NAMES = 3
# So many models and files have a place in the bar; more of them are in a menu.
MOST_ROWS = 4
GROUPS = (("severity", "severity"), ("rule", "rule"), ("element", "link or joint"), ("file", "file"))
DEPTHS = {"source": "source only", "mesh": "source and meshes", "full": "full"}


def make_report_title(run: Run) -> str:
    """The robots' names while they fit, then how many models there are; the file's name where there is only that."""
    if not run.models:
        return get_base_name(next(iter(run.unit_ids))) if len(run.unit_ids) == 1 else "No models"
    if len(run.models) > MOST_NAMES:
        return format_count(len(run.models), "model")
    return ", ".join(dict.fromkeys(map(_get_robot_name, run.models)))


def _get_robot_name(info: ModelInfo) -> str:
    return info.robot or get_base_name(info.path)


def render_header(run: Run, title: str, index_file: str = "") -> str:
    """``back``: the file with the list of all models, for a page of a folder."""
    kind, sentence = summarize_verdict(run)
    up = f'<a class="back" href="{escape_html(index_file)}">All models</a>' if index_file else ""
    where = render_path(run.models[0].path, run.models[0].args) if len(run.models) == 1 else ""
    # They do nothing without the page's script, which brings them to sight.
    buttons = (
        '<button type="button" class="act fold-3d" id="fold" aria-controls="viewer" hidden>Hide 3D</button>'
        '<button type="button" class="act" id="theme" hidden>Theme: auto</button>'
        '<button type="button" class="act" id="help" aria-haspopup="dialog" hidden>Keys</button>'
    )
    return (
        f'<header class="top"><div class="line"><p class="brand">urdfcheck '
        f'<span>{escape_html(run.versions.get("urdfcheck", ""))}</span></p>{up}<div class="buttons">{buttons}</div></div>'
        f'<h1>{escape_html(title)}</h1>{where}<p class="verdict {kind}">{render_glyph(kind)} {escape_html(sentence)}</p>{_render_facts(run)}</header>'
    )


def _render_facts(run: Run) -> str:
    facts: list[tuple[str, str]] = []
    if len(run.models) > MOST_NAMES:
        facts.append(("Robots", _render_robot_names(list(dict.fromkeys(map(_get_robot_name, run.models))))))
    if len(run.models) == 1:
        # A sum over models, often two versions of one robot, would mean nothing.
        info = run.models[0]
        facts += [("Links", str(info.links)), ("Joints", str(info.joints))]
        facts += [("Mass", f"{format_number(info.mass)} kg")] if info.mass is not None else []
    facts += [("Depth", DEPTHS[run.tier]), *_collect_file_facts(run)]
    return '<dl class="facts">' + "".join(f"<div><dt>{k}</dt><dd>{v}</dd></div>" for k, v in facts) + "</dl>"


def _render_robot_names(names: Sequence[str]) -> str:
    shown = ", ".join(f"<code>{escape_html(name)}</code>" for name in names[:MOST_NAMES])
    return shown + (f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else "")


def _collect_file_facts(run: Run) -> list[tuple[str, str]]:
    """The models and every other file with findings, below the folder that they share; nothing where the one model's is all."""
    spans = (finding.location.span for finding in run.findings)
    paths = list(dict.fromkeys([*(info.path for info in run.models), *(span.file for span in spans if span)]))
    if len(paths) < 2 and len(run.models) == 1:
        return []
    folder = _find_shared_folder(paths) if len(paths) > 1 else ""
    items = "".join(
        f"<li><code>{escape_html(path[len(folder) :].lstrip('/') if folder else path)}</code></li>" for path in paths
    )
    listed = f"<ul>{items}</ul>" if paths else NO_VALUE
    if len(paths) > 1:
        listed = f"<details><summary>{len(paths)} files</summary>{listed}</details>"
    name = "Files" if len(paths) > 1 else "File"
    return [(f"{name} in <code>{escape_html(folder)}/</code>" if folder else name, listed)]


def _find_shared_folder(paths: Sequence[str]) -> str:
    shared = []
    for names in zip(*(path.split("/")[:-1] for path in paths), strict=False):
        if len(set(names)) > 1:
            break
        shared.append(names[0])
    return "/".join(shared)


def render_toolbar(run: Run, parts: Sequence[ReportPart], has_rules: bool) -> str:
    """What stays in sight: the way through the page, and what is searched for and shown."""
    return f'<div class="bar">{_render_navigation(parts, has_rules)}{_render_tools(run)}</div>'


def _render_tools(run: Run) -> str:
    """The tiles act through the style alone; the rest is brought to sight by the page's script, which fills the lists."""
    counts = {severity: run.count_findings(severity) for severity in SEVERITY_ORDER}
    tiles = "".join(_render_severity_tile(s, counts[s], sum(map(bool, counts.values())) > 1) for s in SEVERITY_ORDER)
    chosen = "".join(
        f'<label>{name} <select id="by-{key}"><option value="">all</option></select></label>'
        for key, name in (("rule", "Rule"), ("element", "Link or joint"), ("confidence", "Confidence"))
    )
    grouped = "".join(f'<option value="{key}">{name}</option>' for key, name in GROUPS)
    known = sum(finding.suppressed is not None for finding in run.findings)
    also = f'<label><input type="checkbox" id="with-known"> {known} known</label>' if known else ""
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
    told = f"{render_glyph(severity)} <b>{count}</b> <span>{pluralize_severity(count, severity)}</span>"
    if not count or not is_filter:
        return f'<span class="tile {severity}{"" if count else " none"}">{told}</span>'
    # Hidden where there is no style, because then it would do nothing.
    return f'<label class="tile {severity}"><input type="checkbox" id="show-{severity}" checked hidden>{told}</label>'


def _render_navigation(parts: Sequence[ReportPart], has_rules: bool) -> str:
    """The sections of the one robot, or where there are several their names with their counts; then all that is for all."""
    drawn = [part for part in parts if part.sections]
    titles = [part.title for part in parts]
    rows = []
    for part in parts:
        if drawn == [part]:
            rows += [f'<li><a href="#{i}">{name}</a></li>' for i, name in part.sections]
        else:
            rows.append(
                f'<li><a href="#{part.id}"><span class="name">{escape_html(part.title)}{_render_file_label(part, titles)}</span>'
                f'<span class="badges">{render_badges(part.counts)}</span></a></li>'
            )
    rest = [("rules" if has_rules else "skipped", "Rules and checks"), ("about", "About")]
    more = "".join(f'<li><a href="#{i}">{name}</a></li>' for i, name in rest)
    if len(parts) > MOST_ROWS:
        listed = (
            f'<details class="menu"><summary>{len(parts)} models and files</summary><ul>{"".join(rows)}</ul></details>'
        )
        return f'<nav aria-label="Contents">{listed}<ul>{more}</ul></nav>'
    return f'<nav aria-label="Contents"><ul>{"".join(rows)}{more}</ul></nav>'


def _render_file_label(part: ReportPart, titles: Sequence[str]) -> str:
    return f" <small>{escape_html(part.file_label)}</small>" if titles.count(part.title) > 1 else ""
