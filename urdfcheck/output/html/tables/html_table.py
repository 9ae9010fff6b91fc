"""The table that all others are made with, and its cells."""

from __future__ import annotations

from collections.abc import Iterable

from urdfcheck.output.html.element_names import render_element_name
from urdfcheck.output.html.glyphs import render_glyph
from urdfcheck.output.shared.anchors import ElementKey, SeverityMark
from urdfcheck.output.shared.wording import format_count


def render_table(caption: str, head: str, rows: Iterable[str], *, foot: str = "", is_sortable: bool = False) -> str:
    """Render a table in a box that scrolls on a narrow page; the page's script makes a sortable one sort by its columns."""
    foot = f"<tfoot>{foot}</tfoot>" if foot else ""
    kind = ' class="sortable"' if is_sortable else ""
    return (
        f'<div class="scroll" role="group" tabindex="0" aria-label="{caption}"><table{kind}><caption>{caption}</caption>'
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


def render_number_cell(text: str, value: float | None = None) -> str:
    """Render a cell that is aligned as a number; ``value``: what to sort it by where the text alone does not say."""
    return f'<td class="num">{text}</td>' if value is None else f'<td class="num" data-v="{value:.4g}">{text}</td>'
