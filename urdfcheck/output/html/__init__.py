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
from urdfcheck.output.html.appendix import appendix_html, fired_rules
from urdfcheck.output.html.glyphs import SYMBOLS
from urdfcheck.output.html.header import bar_html, header_html, title_of
from urdfcheck.output.html.model import Part, model_html, parts_of
from urdfcheck.output.html.stage import stage_data
from urdfcheck.output.html.text import esc
from urdfcheck.output.html.viewer import scripts_html, viewer_html, viewer_style
from urdfcheck.output.shared.inert import for_html, for_json

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
    return _document(run, parts_of(run), title_of(run))


def pages(run: Run) -> Iterator[tuple[str, str]]:
    """A report as files of one folder, each with its name: a page for each model and for what belongs to none, each with all
    that concerns it, and last :data:`INDEX` with a row for each of them."""
    from urdfcheck.output.html import index

    parts = parts_of(run)
    names = file_names(part.title for part in parts)
    for part, name in zip(parts, names, strict=True):
        own = _only(run, part)
        yield name, _document(own, parts_of(own), part.title, INDEX)
    yield INDEX, index.of_run(run, parts, names)


def _only(run: Run, part: Part) -> Run:
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


def file_names(titles: Iterable[str]) -> list[str]:
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


def _document(run: Run, parts: Sequence[Part], title: str, back: str = "") -> str:
    drawn = [part for part in parts if part.scene is not None]
    models = "\n".join(model_html(run, part, alone=len(drawn) == 1) for part in parts)
    body = for_html(f"""{SYMBOLS}
<a class="skip" href="#content">Skip to the findings</a>
<div class="page">
{header_html(run, title, back)}
{viewer_html() if drawn else ""}
<div class="column">
{bar_html(run, parts, bool(fired_rules(run)))}
<main id="content">
{_failures(run)}{models}
{appendix_html(run)}
</main>
</div>
</div>
{_keys()}
""")
    scripts, allowed = _stage(drawn) if drawn else ("", [])
    style = style_sheet() + (viewer_style() if drawn else "")
    return f"""{head(title, style, [*allowed, page_script()])}<body>
{body}{scripts}<script>{page_script()}</script>
</body>
</html>
"""


def _stage(drawn: Sequence[Part]) -> tuple[str, list[str]]:
    """What draws the robots, and the texts of its scripts. JSON that is ASCII and inert needs nothing spelled in HTML."""
    titles = Counter(part.title for part in drawn)
    names = (part.title if titles[part.title] == 1 else f"{part.title} ({part.file})" for part in drawn)
    models = [(p.id, name, p.scene, p.cards) for p, name in zip(drawn, names, strict=True) if p.scene is not None]
    data, geometry = stage_data(models)
    return scripts_html(for_json(json.dumps(data, separators=(",", ":"), allow_nan=False)), geometry)


def _keys() -> str:
    """What the page's script does for whoever types, and where it says what it did."""
    rows = "".join(f"<div><dt><kbd>{key}</kbd></dt><dd>{what}</dd></div>" for key, what in KEYS)
    return (
        f'<dialog id="keys" aria-labelledby="keys-title"><h2 id="keys-title">Keys</h2><dl>{rows}</dl>'
        '<button type="button" id="close-keys">Close</button></dialog><p id="said" class="sr" role="status"></p>'
    )


def _failures(run: Run) -> str:
    if not run.failures:
        return ""
    items = "".join(f"<li>{esc(failure)}</li>" for failure in run.failures)
    return f'<section class="failures"><h2>What failed in urdfcheck</h2><ul>{items}</ul></section>\n'


def head(title: str, style: str, scripts: Sequence[str] = ()) -> str:
    """The beginning of a document up to its body; ``scripts`` are those that stand in it."""
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy(style, scripts)}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta name="referrer" content="no-referrer">
<title>{for_html(esc(title))} · urdfcheck</title>
<style>{style}</style>
</head>
"""


def policy(style: str, scripts: Sequence[str] = ()) -> str:
    """Nothing but this one style and these scripts: names from a file cannot bring scripts, pictures, styles or forms."""
    allowed = f" script-src {' '.join(map(_digest, scripts))};" if scripts else ""
    return (
        f"default-src 'none'; style-src {_digest(style)};{allowed} img-src data:; base-uri 'none'; form-action 'none'"
    )


def _digest(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


@cache
def style_sheet() -> str:
    """The style of every page."""
    return _own("style.css")


@cache
def page_script() -> str:
    """Searches, filters and groups what is there."""
    return _own("page.js")


def _own(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")
