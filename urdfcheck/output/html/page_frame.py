"""What every HTML page begins with: its head, security policy, style and scripts."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Sequence
from functools import cache
from importlib.resources import files

from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.shared.inert import escape_for_html


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
    return read_asset("style.css")


@cache
def read_page_script() -> str:
    """Searches, filters and groups what is there."""
    return read_asset("page.js")


def read_asset(name: str) -> str:
    return files("urdfcheck.output.html").joinpath(name).read_text(encoding="utf-8")
