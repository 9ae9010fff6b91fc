"""The kinematic tree as an inline SVG."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from urdfcheck.output.html.element_names import describe_mark, render_data_attribute
from urdfcheck.output.html.html_text import escape_html
from urdfcheck.output.html.svg.label_text import SMALL, count_columns, shorten_name
from urdfcheck.output.html.svg.tree_layout import BOX, GAP, PAD, ROW, TreeBox, lay_out_tree
from urdfcheck.output.shared.anchors import ElementKey, SeverityMark
from urdfcheck.output.shared.kinematic_forest import LAUNCH, LINK, MISSING, REPEATED, TreeEdge, TreeNode
from urdfcheck.output.shared.wording import format_count

NOTES = {LAUNCH: "frame of a launch file", MISSING: "no link of this name", REPEATED: "drawn elsewhere too"}


def draw_tree(nodes: Sequence[TreeNode], marks: Mapping[ElementKey, SeverityMark]) -> str:
    """Draw the tree, each box and edge in the colour of its worst finding."""
    boxes, is_layered = lay_out_tree(nodes)
    right = max(box.x + box.width for box in boxes)
    if not is_layered:
        labelled = [(b, n.edge) for b, n in zip(boxes, nodes, strict=True) if n.edge is not None]
        right = max(
            [right, *(b.x + b.width + GAP + count_columns(_format_inline_label(e)) * SMALL + 18 for b, e in labelled)]
        )
    width, height = round(right) + 2, round(max(box.y for box in boxes) + ROW / 2)
    edges: list[tuple[int, str]] = []
    items: list[str] = []
    for node, box in zip(nodes, boxes, strict=True):
        if node.edge is not None:
            parent = boxes[node.parent]
            mark = marks.get(node.edge.element_key)
            order = mark.severity if mark is not None else 0 if node.edge.is_joint else -1
            edges.append((order, _draw_edge(node.edge, mark, parent=parent, child=box, is_layered=is_layered)))
            items.append(_draw_label(node.edge, mark, parent=parent, child=box, is_layered=is_layered))
        items.append(_draw_box(node, box, _find_node_mark(node, marks)))
    # Siblings share a stem: the worst is painted last, so that its colour is visible.
    drawn = "".join(path for _, path in sorted(edges, key=lambda e: e[0]))
    # Presentation attributes keep the drawing legible if a server's policy blocks the style.
    return (
        f'<svg class="graph" width="{width}" height="{height}" viewBox="0 0 {width} {height}" role="group" '
        f'aria-label="{format_count(len(nodes), "frame")}, drawn as a tree" font-family="monospace" font-size="12" '
        f'fill="none" stroke-width="1.5">'
        f"<g>{drawn}</g>{''.join(items)}</svg>"
    )


def get_link_key(node: TreeNode) -> ElementKey | None:
    """Return the key of the link that a box shows; None if no link has its name."""
    return ("link", node.name) if node.kind in (LINK, REPEATED) else None


def _find_node_mark(node: TreeNode, marks: Mapping[ElementKey, SeverityMark]) -> SeverityMark | None:
    link = get_link_key(node)
    if link is not None:
        return marks.get(link)
    # A frame of a launch file has the mark of the transform that makes it.
    return marks.get(node.edge.element_key) if node.kind == LAUNCH and node.edge is not None else None


def _draw_edge(edge: TreeEdge, mark: SeverityMark | None, *, parent: TreeBox, child: TreeBox, is_layered: bool) -> str:
    if is_layered:
        start = parent.x + parent.width
        line = f"M{start:g} {parent.y:g}" + _trace_elbow(start + GAP, start_y=parent.y, end=child)
    elif child.x == parent.x:
        line = f"M{parent.x + 14:g} {parent.y + BOX / 2:g}V{child.y - BOX / 2:g}"
    else:
        x = parent.x + 14
        line = f"M{x:g} {parent.y + BOX / 2:g}V{child.y - 6:g}q0 6 6 6H{child.x:g}"
    return f'<path class="{_get_edge_class(edge, mark)}" stroke="currentColor"{_format_dashes(edge)} d="{line}"/>'


def _trace_elbow(bend: float, *, start_y: float, end: TreeBox) -> str:
    """Trace a line from ``start_y`` to the left edge of a box, with two rounded corners at x = ``bend``."""
    x, y = end.x, end.y
    if abs(y - start_y) < 1:
        return f"H{x:g}"
    r = min(8.0, abs(y - start_y) / 2) * (1 if y > start_y else -1)
    return f"H{bend - abs(r):g}q{abs(r):g} 0 {abs(r):g} {r:g}V{y - r:g}q0 {r:g} {abs(r):g} {r:g}H{x:g}"


def _format_dashes(edge: TreeEdge) -> str:
    if not edge.is_joint:
        return ' stroke-dasharray="7 4"'
    return ' stroke-dasharray="3 3"' if edge.kind == "fixed" else ""


def _get_edge_class(edge: TreeEdge, mark: SeverityMark | None) -> str:
    kind = "launch" if not edge.is_joint else "fixed" if edge.kind == "fixed" else "moving"
    return f"edge {kind}" if mark is None else f"edge {kind} {mark.severity}"


def _draw_label(edge: TreeEdge, mark: SeverityMark | None, *, parent: TreeBox, child: TreeBox, is_layered: bool) -> str:
    sign = "" if mark is None else f'<use href="#g-{mark.severity}" width="12" height="12" %s/>'
    if is_layered:
        x = parent.x + parent.width + GAP + 12
        y = child.y
        lines = [(edge.name, y - 5), (edge.kind, y + 14)] if edge.name else [(edge.kind, y - 5)]
        text = "".join(
            f'<text class="{"joint" if i == 0 else "type"}" x="{x + (16 if mark and i == 0 else 0):g}" y="{at:g}">'
            f"{escape_html(shorten_name(line))}</text>"
            for i, (line, at) in enumerate(lines)
        )
        sign = sign % f'x="{x:g}" y="{y - 15:g}"' if sign else ""
    else:
        x = child.x + child.width + GAP - 6
        sign = sign % f'x="{x:g}" y="{child.y - 6:g}"' if sign else ""
        text = (
            f'<text class="joint" x="{x + (16 if mark else 0):g}" y="{child.y + 4:g}">{escape_html(shorten_name(edge.name))}'
            f'<tspan class="type">{" · " if edge.name else ""}{escape_html(edge.kind)}</tspan></text>'
        )
    what = f"joint {edge.name}, {edge.kind}" if edge.is_joint else "static transform of a launch file"
    kind = _get_edge_class(edge, mark).replace("edge ", "label ")
    drawn = (
        f'<g class="{kind}"{render_data_attribute(edge.element_key)} fill="currentColor" font-size="11">'
        f"<title>{escape_html(_format_tooltip(what, mark))}</title>{sign}{text}</g>"
    )
    return drawn if mark is None else f'<a href="#{mark.anchor}">{drawn}</a>'


def _format_inline_label(edge: TreeEdge) -> str:
    return f"{shorten_name(edge.name)} · {edge.kind}" if edge.name else edge.kind


def _draw_box(node: TreeNode, box: TreeBox, mark: SeverityMark | None) -> str:
    top = box.y - BOX / 2
    kind = f"node {node.kind}" if mark is None else f"node {node.kind} {mark.severity}"
    what = f"link {node.name}" if node.kind == LINK else f"{node.name}: {NOTES[node.kind]}"
    dashes = "" if node.kind == LINK else ' stroke-dasharray="5 3"'
    sign = (
        ""
        if mark is None
        else f'<use href="#g-{mark.severity}" x="{box.x + 9:g}" y="{top + 7:g}" width="14" height="14"/>'
    )
    left = box.x + (PAD + 18 if mark else PAD + 10)
    drawn = (
        f'<g class="{kind}"{render_data_attribute(get_link_key(node))}><title>{escape_html(_format_tooltip(what, mark))}</title>'
        f'<rect x="{box.x:g}" y="{top:g}" width="{box.width:g}" '
        f'height="{BOX}" rx="6" stroke="currentColor"{dashes}/><g fill="currentColor">{sign}'
        f'<text x="{left:g}" y="{box.y + 4:g}">{escape_html(shorten_name(node.name)) or "(no name)"}</text></g></g>'
    )
    return drawn if mark is None else f'<a href="#{mark.anchor}">{drawn}</a>'


def _format_tooltip(description: str, mark: SeverityMark | None) -> str:
    return description if mark is None else f"{description}: {describe_mark(mark)}"


def render_tree_legend(nodes: Sequence[TreeNode]) -> str:
    """Render the legend of the kinds of edges that occur; empty without edges."""
    kinds = {_get_edge_class(n.edge, None): n.edge for n in nodes if n.edge is not None}
    names = {"edge moving": "moving joint", "edge fixed": "fixed joint", "edge launch": "launch file"}
    items = "".join(
        f'<li><svg class="graph" width="34" height="10" aria-hidden="true" focusable="false" fill="none" stroke-width="1.5">'
        f'<path class="{kind}" stroke="currentColor"{_format_dashes(kinds[kind])} d="M1 5H33"/></svg> {name}</li>'
        for kind, name in names.items()
        if kind in kinds
    )
    return f'<figcaption><ul class="legend">{items}</ul></figcaption>' if items else ""
