"""Names of links and joints, and links to their worst findings."""

from __future__ import annotations

from urdfcheck.output.html.glyphs import render_glyph
from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.shared.anchors import ElementKey, SeverityMark


def render_data_attribute(element_key: ElementKey | None) -> str:
    """Render the attribute that tells the page's script which link or joint a tag is about; empty for anything else."""
    if element_key is None or len(element_key) != 2:
        return ""
    kind, name = element_key
    return f' data-{kind}="{escape_html(name)}"'


def render_element_name(element_key: ElementKey) -> str:
    """Render the name of a link or a joint, which the page's script links with the 3D view."""
    return f"<code{render_data_attribute(element_key)}>{escape_html(element_key[1])}</code>"


def describe_mark(mark: SeverityMark) -> str:
    """Describe the mark of an element for a tooltip."""
    return f"{mark.severity}, the worst of {mark.count} findings" if mark.count > 1 else str(mark.severity)


def render_mark_link(mark: SeverityMark | None) -> str:
    """Render a link to the card of an element's worst finding; empty without one."""
    if mark is None:
        return ""
    return f' <a class="{mark.severity}" href="#{mark.anchor}">{render_glyph(mark.severity)} {mark.severity}</a>'
