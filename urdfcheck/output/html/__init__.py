"""The report for people: one HTML file that opens from a disk, loads nothing and needs no script."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from importlib.resources import files

from urdfcheck.core import Run
from urdfcheck.output.html.appendix import list_fired_rules, render_appendix
from urdfcheck.output.html.glyphs import SYMBOLS
from urdfcheck.output.html.header import make_report_title, render_header, render_toolbar
from urdfcheck.output.html.model import ReportPart, collect_report_parts, render_model
from urdfcheck.output.html.stage import build_stage_data
from urdfcheck.output.html.text import escape_html
from urdfcheck.output.html.viewer import read_viewer_style, render_viewer, render_viewer_scripts
from urdfcheck.output.shared.inert import escape_for_html, escape_for_json

INDEX = "index.html"
LONGEST_NAME = 60
_UNSAFE = re.compile(r"[^A-Za-z0-9._-]+")
_DEVICE = re.compile(r"(?:con|prn|aux|nul|com\d|lpt\d)(?:\.|$)", re.IGNORECASE)
KEYS = (
    ("/", "search the findings"),
    ("j, k", "next and previous finding"),
    ("Enter", "open or close it"),
    ("h", "the whole robot in 3D"),
    ("1 to 9", "layers in 3D"),
    ("Esc", "nothing chosen, nothing searched for"),
    ("?", "this list"),
)


def render(run: Run) -> str:
    """The whole document. Only what stands in ``class="seconds"`` differs between equal runs."""
    return _render_document(run, collect_report_parts(run), make_report_title(run))


def iter_report_pages(run: Run) -> Iterator[tuple[str, str]]:
    """A report as files of one folder, each with its name: a page for each model and for what belongs to none, each with all
    that concerns it, and last :data:`INDEX` with a row for each of them."""
    from urdfcheck.output.html import index

    parts = collect_report_parts(run)
    names = make_unique_file_names(part.title for part in parts)
    for part, name in zip(parts, names, strict=True):
        own = _restrict_run_to_part(run, part)
        yield name, _render_document(own, collect_report_parts(own), part.title, INDEX)
    yield INDEX, index.render_run_index(run, parts, names)


def _restrict_run_to_part(run: Run, part: ReportPart) -> Run:
    """What a run has found of one part."""
    name = part.path if part.info is None else part.info.id
    return replace(
        run,
        models=() if part.info is None else (part.info,),
        findings=tuple(card.finding for card in part.cards),
        skipped=tuple(skip for skip in run.skipped if skip.model in (name, "")),
        scenes=() if part.scene is None else (part.scene,),
        drops=() if part.drop is None else (part.drop,),
    )


def make_unique_file_names(titles: Iterable[str]) -> list[str]:
    """A name for each, one that every file system takes: they differ in more than case, and none is a device of Windows."""
    taken = {INDEX}
    used: Counter[str] = Counter()
    names = []
    for title in titles:
        plain = _UNSAFE.sub("-", title).strip("-.")[:LONGEST_NAME] or "model"
        plain = f"robot-{plain}" if _DEVICE.match(plain) else plain
        name = f"{plain}.html"
        while name.casefold() in taken:
            used[plain] += 1
            name = f"{plain}-{used[plain] + 1}.html"
        taken.add(name.casefold())
        names.append(name)
    return names


def _render_document(run: Run, parts: Sequence[ReportPart], title: str, index_file: str = "") -> str:
    drawn = [part for part in parts if part.scene is not None]
    models = "\n".join(render_model(run, part, is_only_model=len(drawn) == 1) for part in parts)
    body = escape_for_html(f"""{SYMBOLS}
<a class="skip" href="#content">Skip to the findings</a>
<div class="page">
{render_header(run, title, index_file)}
{render_viewer() if drawn else ""}
<div class="column">
{render_toolbar(run, parts, bool(list_fired_rules(run)))}
<main id="content">
{_render_failures(run)}{models}
{render_appendix(run)}
</main>
</div>
</div>
{_render_key_help()}
""")
    scripts, allowed = _render_stage_scripts(drawn) if drawn else ("", [])
    style = read_style_sheet() + (read_viewer_style() if drawn else "")
    return f"""{render_document_head(title, style, [*allowed, read_page_script()])}<body>
{body}{scripts}<script>{read_page_script()}</script>
</body>
</html>
"""


def _render_stage_scripts(drawn: Sequence[ReportPart]) -> tuple[str, list[str]]:
    """What draws the robots, and the texts of its scripts. JSON that is ASCII and inert needs nothing spelled in HTML."""
    titles = Counter(part.title for part in drawn)
    names = (part.title if titles[part.title] == 1 else f"{part.title} ({part.file_label})" for part in drawn)
    models = [(p.id, name, p.scene, p.cards) for p, name in zip(drawn, names, strict=True) if p.scene is not None]
    data, geometry = build_stage_data(models)
    return render_viewer_scripts(escape_for_json(json.dumps(data, separators=(",", ":"), allow_nan=False)), geometry)


def _render_key_help() -> str:
    """What the page's script does for whoever types, and where it says what it did."""
    rows = "".join(f"<div><dt><kbd>{key}</kbd></dt><dd>{what}</dd></div>" for key, what in KEYS)
    return (
        f'<dialog id="keys" aria-labelledby="keys-title"><h2 id="keys-title">Keys</h2><dl>{rows}</dl>'
        '<button type="button" id="close-keys">Close</button></dialog><p id="said" class="sr" role="status"></p>'
    )


def _render_failures(run: Run) -> str:
    if not run.failures:
        return ""
    items = "".join(f"<li>{escape_html(failure)}</li>" for failure in run.failures)
    return f'<section class="failures"><h2>What failed in urdfcheck</h2><ul>{items}</ul></section>\n'


def render_document_head(title: str, style: str, scripts: Sequence[str] = ()) -> str:
    """The beginning of a document up to its body; ``scripts`` are those that stand in it."""
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{build_security_policy(style, scripts)}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta name="referrer" content="no-referrer">
<title>{escape_for_html(escape_html(title))} · urdfcheck</title>
<style>{style}</style>
</head>
"""


def build_security_policy(style: str, scripts: Sequence[str] = ()) -> str:
    """Nothing but this one style and these scripts: names from a file cannot bring scripts, pictures, styles or forms."""
    allowed = f" script-src {' '.join(map(_hash_for_policy, scripts))};" if scripts else ""
    return f"default-src 'none'; style-src {_hash_for_policy(style)};{allowed} img-src data:; base-uri 'none'; form-action 'none'"


def _hash_for_policy(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


@cache
def read_style_sheet() -> str:
    """The style of every page."""
    return _read_asset("style.css")


@cache
def read_page_script() -> str:
    """Searches, filters and groups what is there."""
    return _read_asset("page.js")


def _read_asset(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")
