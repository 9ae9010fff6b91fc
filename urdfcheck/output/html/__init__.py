"""The report for people: one HTML file that opens from a disk, loads nothing and needs no script."""

from __future__ import annotations

import base64
import hashlib
from functools import cache
from importlib.resources import files

from urdfcheck.core import Run
from urdfcheck.output.html.appendix import appendix_html, fired_rules
from urdfcheck.output.html.glyphs import SYMBOLS
from urdfcheck.output.html.header import header_html, nav_html, title_of
from urdfcheck.output.html.model import model_html, parts_of
from urdfcheck.output.html.text import esc
from urdfcheck.output.inert import for_html


def render(run: Run) -> str:
    """The whole document. Only what stands in ``class="seconds"`` differs between equal runs."""
    parts = parts_of(run)
    models = "\n".join(model_html(run, part) for part in parts)
    return for_html(f"""{head(title_of(run), style_sheet())}<body>
{SYMBOLS}
<a class="skip" href="#content">Skip to the findings</a>
{header_html(run)}
<div class="page">
{nav_html(parts, bool(fired_rules(run)))}
<main id="content">
{_failures(run)}{models}
{appendix_html(run)}
</main>
</div>
</body>
</html>
""")


def _failures(run: Run) -> str:
    if not run.failures:
        return ""
    items = "".join(f"<li>{esc(failure)}</li>" for failure in run.failures)
    return f'<section class="failures"><h2>What failed in urdfcheck</h2><ul>{items}</ul></section>\n'


def head(title: str, style: str, script: str = "") -> str:
    """The beginning of a document up to its body; ``script`` is one that stands in it."""
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy(style, script)}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta name="referrer" content="no-referrer">
<title>{esc(title)} · urdfcheck</title>
<style>{style}</style>
</head>
"""


def policy(style: str, script: str = "") -> str:
    """Nothing but this one style and script: names from a file cannot bring scripts, pictures, styles or forms."""
    scripts = f" script-src {_digest(script)};" if script else ""
    return f"default-src 'none'; style-src {_digest(style)};{scripts} base-uri 'none'; form-action 'none'"


def _digest(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


@cache
def style_sheet() -> str:
    """The style of every page."""
    return files(__package__).joinpath("style.css").read_text(encoding="utf-8")
