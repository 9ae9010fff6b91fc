"""The table that all others are made with, and its cells."""

from __future__ import annotations

from collections.abc import Iterable

from urdfcheck.output.html.element_names import render_element_name
from urdfcheck.output.html.glyphs import render_glyph
from urdfcheck.output.shared.anchors import ElementKey, SeverityMark
from urdfcheck.output.shared.wording import format_count


def render_table(caption: str, head: str, rows: Iterable[str], *, foot: str = "") -> str:
    """Render a table in a box that scrolls on a narrow page."""
    foot = f"<tfoot>{foot}</tfoot>" if foot else ""
    return (
        f'<div class="scroll" role="group" tabindex="0" aria-label="{caption}"><table><caption>{caption}</caption>'
        f"<thead>{head}</thead><tbody>{''.join(rows)}</tbody>{foot}</table></div>"
    )


def render_name_cell(element_key: ElementKey, mark: SeverityMark | None) -> str:
    """Render the first cell of a row: the name of a link or a joint, and its mark as a link."""
    sign = ""
    if mark is not None:
        description = f"{format_count(mark.count, 'finding')}, worst: {mark.severity}"
        glyph = f'{render_glyph(mark.severity)}<span class="sr">{description}</span>'
        sign = f' <a class="{mark.severity}" href="#{mark.anchor}">{glyph}</a>'
    return f'<th scope="row">{render_element_name(element_key)}{sign}</th>'


def render_number_cell(text: str) -> str:
    """Render a cell that is aligned as a number."""
    return f'<td class="num">{text}</td>'
