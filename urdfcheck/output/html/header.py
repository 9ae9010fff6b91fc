"""The head of the report, and the bar that stays in sight: what was checked, the verdict, the way through the page."""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.core import ModelInfo, Run, Severity
from urdfcheck.output.html.glyphs import badges, glyph, words
from urdfcheck.output.html.model import Part, path_html
from urdfcheck.output.html.text import NONE, base_name, esc, number
from urdfcheck.output.shared.wording import ORDER, plural, verdict

MOST_NAMES = 3
# So many models and files have a place in the bar; more of them are in a menu.
MOST_ROWS = 4
GROUPS = (("severity", "severity"), ("rule", "rule"), ("element", "link or joint"), ("file", "file"))
DEPTHS = {"source": "source only", "mesh": "source and meshes", "full": "full"}


def title_of(run: Run) -> str:
    """The robots' names while they fit, then how many models there are; the file's name where there is only that."""
    if not run.models:
        return base_name(next(iter(run.ids))) if len(run.ids) == 1 else "No models"
    if len(run.models) > MOST_NAMES:
        return plural(len(run.models), "model")
    return ", ".join(dict.fromkeys(map(_robot_name, run.models)))


def _robot_name(info: ModelInfo) -> str:
    return info.robot or base_name(info.path)


def header_html(run: Run, title: str, back: str = "") -> str:
    """``back``: the file with the list of all models, for a page of a folder."""
    kind, sentence = verdict(run)
    up = f'<a class="back" href="{esc(back)}">All models</a>' if back else ""
    where = path_html(run.models[0].path, run.models[0].args) if len(run.models) == 1 else ""
    # They do nothing without the page's script, which brings them to sight.
    buttons = (
        '<button type="button" class="act fold-3d" id="fold" aria-controls="viewer" hidden>Hide 3D</button>'
        '<button type="button" class="act" id="theme" hidden>Theme: auto</button>'
        '<button type="button" class="act" id="help" aria-haspopup="dialog" hidden>Keys</button>'
    )
    return (
        f'<header class="top"><div class="line"><p class="brand">urdfcheck '
        f'<span>{esc(run.versions.get("urdfcheck", ""))}</span></p>{up}<div class="buttons">{buttons}</div></div>'
        f'<h1>{esc(title)}</h1>{where}<p class="verdict {kind}">{glyph(kind)} {esc(sentence)}</p>{_facts(run)}</header>'
    )


def _facts(run: Run) -> str:
    facts: list[tuple[str, str]] = []
    if len(run.models) > MOST_NAMES:
        facts.append(("Robots", _names(list(dict.fromkeys(map(_robot_name, run.models))))))
    if len(run.models) == 1:
        # A sum over models, often two versions of one robot, would mean nothing.
        info = run.models[0]
        facts += [("Links", str(info.links)), ("Joints", str(info.joints))]
        facts += [("Mass", f"{number(info.mass)} kg")] if info.mass is not None else []
    facts += [("Depth", DEPTHS[run.tier]), *_files(run)]
    return '<dl class="facts">' + "".join(f"<div><dt>{k}</dt><dd>{v}</dd></div>" for k, v in facts) + "</dl>"


def _names(names: Sequence[str]) -> str:
    shown = ", ".join(f"<code>{esc(name)}</code>" for name in names[:MOST_NAMES])
    return shown + (f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else "")


def _files(run: Run) -> list[tuple[str, str]]:
    """The models and every other file with findings, below the folder that they share; nothing where the one model's is all."""
    spans = (finding.location.span for finding in run.findings)
    paths = list(dict.fromkeys([*(info.path for info in run.models), *(span.file for span in spans if span)]))
    if len(paths) < 2 and len(run.models) == 1:
        return []
    folder = _shared_folder(paths) if len(paths) > 1 else ""
    items = "".join(
        f"<li><code>{esc(path[len(folder) :].lstrip('/') if folder else path)}</code></li>" for path in paths
    )
    listed = f"<ul>{items}</ul>" if paths else NONE
    if len(paths) > 1:
        listed = f"<details><summary>{len(paths)} files</summary>{listed}</details>"
    name = "Files" if len(paths) > 1 else "File"
    return [(f"{name} in <code>{esc(folder)}/</code>" if folder else name, listed)]


def _shared_folder(paths: Sequence[str]) -> str:
    shared = []
    for names in zip(*(path.split("/")[:-1] for path in paths), strict=False):
        if len(set(names)) > 1:
            break
        shared.append(names[0])
    return "/".join(shared)


def bar_html(run: Run, parts: Sequence[Part], has_rules: bool) -> str:
    """What stays in sight: the way through the page, and what is searched for and shown."""
    return f'<div class="bar">{_nav(parts, has_rules)}{_tools(run)}</div>'


def _tools(run: Run) -> str:
    """The tiles act through the style alone; the rest is brought to sight by the page's script, which fills the lists."""
    counts = {severity: run.count(severity) for severity in ORDER}
    tiles = "".join(_tile(s, counts[s], sum(map(bool, counts.values())) > 1) for s in ORDER)
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


def _tile(severity: Severity, count: int, is_filter: bool) -> str:
    told = f"{glyph(severity)} <b>{count}</b> <span>{words(count, severity)}</span>"
    if not count or not is_filter:
        return f'<span class="tile {severity}{"" if count else " none"}">{told}</span>'
    # Hidden where there is no style, because then it would do nothing.
    return f'<label class="tile {severity}"><input type="checkbox" id="show-{severity}" checked hidden>{told}</label>'


def _nav(parts: Sequence[Part], has_rules: bool) -> str:
    """The sections of the one robot, or where there are several their names with their counts; then all that is for all."""
    drawn = [part for part in parts if part.sections]
    titles = [part.title for part in parts]
    rows = []
    for part in parts:
        if drawn == [part]:
            rows += [f'<li><a href="#{i}">{name}</a></li>' for i, name in part.sections]
        else:
            rows.append(
                f'<li><a href="#{part.id}"><span class="name">{esc(part.title)}{_file(part, titles)}</span>'
                f'<span class="badges">{badges(part.counts)}</span></a></li>'
            )
    rest = [("rules" if has_rules else "skipped", "Rules and checks"), ("about", "About")]
    more = "".join(f'<li><a href="#{i}">{name}</a></li>' for i, name in rest)
    if len(parts) > MOST_ROWS:
        listed = (
            f'<details class="menu"><summary>{len(parts)} models and files</summary><ul>{"".join(rows)}</ul></details>'
        )
        return f'<nav aria-label="Contents">{listed}<ul>{more}</ul></nav>'
    return f'<nav aria-label="Contents"><ul>{"".join(rows)}{more}</ul></nav>'


def _file(part: Part, titles: Sequence[str]) -> str:
    return f" <small>{esc(part.file)}</small>" if titles.count(part.title) > 1 else ""
