"""Names of links and joints, and links to their worst findings."""

from __future__ import annotations

from urdfcheck.output.html.glyphs import render_glyph
from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.shared.anchors import ElementKey, SeverityMark


def render_data_attribute(element_key: ElementKey | None) -> str:
    """The attribute by which the page's script knows that something is about a link or a joint; empty for anything else."""
    return (
        f' data-{element_key[0]}="{escape_html(element_key[1])}"'
        if element_key is not None and len(element_key) == 2
        else ""
    )


def render_element_name(element_key: ElementKey) -> str:
    """The name of a link or a joint, by which the page's script finds it in the 3D view."""
    return f"<code{render_data_attribute(element_key)}>{escape_html(element_key[1])}</code>"


def render_mark_link(mark: SeverityMark | None) -> str:
    if mark is None:
        return ""
    return f' <a class="{mark.severity}" href="#{mark.anchor}">{render_glyph(mark.severity)} {mark.severity}</a>'
