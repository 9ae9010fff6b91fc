"""The head of every HTML page with its security policy, and the style and scripts of the package."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Sequence
from functools import cache
from importlib.resources import files

from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.shared.escaping import escape_for_html


def render_document_head(title: str, style: str, scripts: Sequence[str] = ()) -> str:
    """Render the beginning of a document up to its body; ``scripts``: the texts of all scripts in it."""
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
    """Build a policy that allows only this style and these scripts, so that names from a file cannot add any."""
    allowed = f" script-src {' '.join(map(_hash_for_policy, scripts))};" if scripts else ""
    style_source = _hash_for_policy(style)
    return f"default-src 'none'; style-src {style_source};{allowed} img-src data:; base-uri 'none'; form-action 'none'"


def _hash_for_policy(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


@cache
def read_style_sheet() -> str:
    """Read the style of every page."""
    return read_asset("style.css")


@cache
def read_frame_script() -> str:
    """Read the script of every page with a robot: it sorts tables, folds the 3D view and knows the theme."""
    return read_asset("tables.js") + read_asset("frame.js")


@cache
def read_page_script() -> str:
    """Read the script that searches, filters and groups the findings, and sorts the tables."""
    return read_frame_script() + read_asset("page.js")


@cache
def read_index_script() -> str:
    """Read the script of the page about many models."""
    return read_asset("tables.js") + read_asset("index.js")


def read_asset(name: str) -> str:
    """Read a style or a script that stands beside the modules of this package."""
    return files("urdfcheck.output.html").joinpath(name).read_text(encoding="utf-8")
