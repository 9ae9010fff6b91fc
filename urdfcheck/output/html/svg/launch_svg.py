"""The graph of a launch file as an inline SVG like rqt_graph's."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from urdfcheck.output.html.element_names import describe_mark
from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.html.svg.label_text import ADVANCE, SMALL, count_columns
from urdfcheck.output.html.svg.launch_graph import KIND_NAMES, LaunchBox
from urdfcheck.output.html.svg.layered_layout import BoxPosition, EdgeCurve, lay_out_graph
from urdfcheck.output.shared.anchors import ElementKey, SeverityMark
from urdfcheck.output.shared.wording import format_count

MARGIN = 2


def draw_launch_graph(
    boxes: Sequence[LaunchBox], edges: Sequence[tuple[int, int, bool]], worst: Mapping[ElementKey, SeverityMark]
) -> str:
    """Draw the boxes and edges of a launch file, each box in the colour of its worst finding."""
    marks = [None if box.element_key is None else worst.get(box.element_key) for box in boxes]
    sizes = [(w + (18 if mark else 0), h) for (w, h), mark in zip((b.size for b in boxes), marks, strict=True)]
    layout = lay_out_graph(sizes, [(a, b) for a, b, _ in edges])
    width, height = round(layout.width) + 2 * MARGIN, round(layout.height) + 2 * MARGIN
    lines = "".join(_draw_edge(curve, dashed) for curve, (_, _, dashed) in zip(layout.curves, edges, strict=True))
    items = "".join(map(_draw_box, boxes, layout.positions, sizes, marks))
    # Presentation attributes keep the drawing legible if a server's policy blocks the style.
    return (
        f'<svg class="graph" width="{width}" height="{height}" viewBox="{-MARGIN} {-MARGIN} {width} {height}" role="group" '
        f'aria-label="{format_count(sum(b.element_key is not None for b in boxes), "part")} of a launch file, drawn as a graph" '
        f'font-family="monospace" font-size="12" fill="none" stroke-width="1.5"><g>{lines}</g>{items}</svg>'
    )


def _draw_edge(curve: EdgeCurve, dashed: bool) -> str:
    if not curve.points:
        return ""
    points = list(curve.points)
    # The arrow covers the end of the line.
    tip, sign = (points[0], -1) if curve.is_reversed else (points[-1], 1)
    (x, y), *rest = points
    path = f"M{x:g} {y:g}"
    for k, (x1, y1) in enumerate(rest):
        middle = (x + x1) / 2
        straight = k % 2 == 0 or abs(y1 - y) < 0.5
        path += f"H{x1:g}" if straight else f"C{middle:g} {y:g} {middle:g} {y1:g} {x1:g} {y1:g}"
        x, y = x1, y1
    dashes = ' stroke-dasharray="4 3"' if dashed else ""
    arrow = f"M{tip[0]:g} {tip[1]:g}l{-8 * sign} -4v8z"
    return (
        f'<path class="edge flow" stroke="currentColor"{dashes} d="{path}"/>'
        f'<path class="arrow" fill="currentColor" stroke="none" d="{arrow}"/>'
    )


def _draw_box(box: LaunchBox, place: BoxPosition, size: tuple[float, float], mark: SeverityMark | None) -> str:
    names = [
        "node",
        box.kind.replace(" ", "-"),
        *(["off"] if box.off_by_default else []),
        *([str(mark.severity)] if mark else []),
    ]
    dashes = ' stroke-dasharray="5 3"' if box.dashed else ""
    outline = f'<path stroke="currentColor"{dashes} d="{_trace_outline(box.kind, place, size)}"/>'
    middle = place.x + size[0] / 2 + (9 if mark else 0)
    first = place.y + 4 if len(box.lines) == 1 else place.y - 4
    text = f'<text x="{middle:g}" y="{first:g}" text-anchor="middle">{escape_html(box.lines[0])}</text>'
    if len(box.lines) > 1:
        text += (
            f'<text class="type" x="{middle:g}" y="{place.y + 13:g}" text-anchor="middle" font-size="11">'
            f"{escape_html(box.lines[1])}</text>"
        )
    tooltip = box.tooltip
    sign = ""
    if mark is not None:
        tooltip += f". {describe_mark(mark)}"
        left = middle - max(count_columns(box.lines[0]) * ADVANCE, count_columns(box.lines[-1]) * SMALL) / 2 - 19
        sign = f'<use href="#g-{mark.severity}" x="{left:g}" y="{place.y - 7:g}" width="14" height="14"/>'
    drawn = (
        f'<g class="{" ".join(names)}"><title>{escape_html(tooltip)}</title>{outline}'
        f'<g fill="currentColor">{sign}{text}</g></g>'
    )
    return drawn if mark is None else f'<a href="#{mark.anchor}">{drawn}</a>'


def _trace_outline(kind: str, place: BoxPosition, size: tuple[float, float]) -> str:
    """Trace a box for what runs, round ends for a topic, pointed ends for a service, a folded corner for a parameter or a file,
    and bars at the sides for a launch file."""
    (w, h), x, y = size, place.x, place.y - size[1] / 2
    if kind == "topic":
        r = h / 2
        return f"M{x + r:g} {y:g}h{w - h:g}a{r:g} {r:g} 0 0 1 0 {h:g}h{h - w:g}a{r:g} {r:g} 0 0 1 0 {-h:g}z"
    if kind == "service":
        return f"M{x + 12:g} {y:g}h{w - 24:g}l12 {h / 2:g}l-12 {h / 2:g}h{24 - w:g}l-12 {-h / 2:g}z"
    if kind in ("parameter", "file"):
        return f"M{x:g} {y:g}h{w - 11:g}l11 11v{h - 11:g}h{-w:g}zM{x + w - 11:g} {y:g}v11h11"
    if kind == "launch file":
        return f"M{x:g} {y:g}h{w:g}v{h:g}h{-w:g}zM{x + 6:g} {y:g}v{h:g}M{x + w - 6:g} {y:g}v{h:g}"
    return (
        f"M{x + 6:g} {y:g}h{w - 12:g}a6 6 0 0 1 6 6v{h - 12:g}a6 6 0 0 1 -6 6h{12 - w:g}"
        f"a6 6 0 0 1 -6 -6v{12 - h:g}a6 6 0 0 1 6 -6z"
    )


def render_launch_legend(boxes: Sequence[LaunchBox]) -> str:
    """Render the legend of the kinds of boxes that occur."""
    kinds = {box.kind for box in boxes}
    items = [_render_legend_item(kind, name) for kind, name in KIND_NAMES.items() if kind in kinds]
    if any(box.dashed and box.kind in ("node", "launch file", "process") for box in boxes):
        items.append(_render_legend_item("node", "started under a condition", ' stroke-dasharray="5 3"'))
    return f'<figcaption><ul class="legend">{"".join(items)}</ul></figcaption>'


def _render_legend_item(kind: str, name: str, dashes: str = "") -> str:
    outline = _trace_outline(kind, BoxPosition(1, 9), (32, 16))
    return (
        '<li><svg class="graph" width="34" height="18" aria-hidden="true" focusable="false" fill="none" stroke-width="1.5">'
        f'<g class="node {kind.replace(" ", "-")}"><path stroke="currentColor"{dashes} d="{outline}"/></g></svg> {name}</li>'
    )
