"""The kinematic tree as an inline SVG, and as nested lists for those who do not see it."""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from urdfcheck.core.scene import Scene
from urdfcheck.output.html.glyphs import render_glyph
from urdfcheck.output.html.text import escape_html
from urdfcheck.output.shared.anchors import ElementKey, SeverityMark, render_data_attribute
from urdfcheck.output.shared.graph import LAUNCH, LINK, MISSING, REPEATED, TreeEdge, TreeNode, build_forest
from urdfcheck.output.shared.wording import format_count

# The names are set in a monospaced face at 12 px, whose advance is 0.6 em in all common ones (DejaVu 0.602).
ADVANCE = 7.3
SMALL = 6.7  # the same at 11 px
BOX, PAD, ROW, LINE, INDENT, GAP = 28, 10, 44, 37, 30, 18
LONGEST_NAME = 36
# A drawing wider than this would have to be scrolled on a laptop: then names go below one another.
WIDEST = 820
# Chrome stops nesting elements at 512 levels; a list as deep as that helps nobody either.
DEEPEST_LIST = 24
NOTES = {LAUNCH: "frame of a launch file", MISSING: "no link of this name", REPEATED: "drawn elsewhere too"}


@dataclass(frozen=True, slots=True)
class TreeBox:
    """A placed node: its left edge, the middle of its height and its width, in px."""

    x: float
    y: float
    width: float


def render_tree(scene: Scene, marks: Mapping[ElementKey, SeverityMark], title: str) -> str:
    """The drawing with its legend and its text form."""
    nodes = build_forest(scene)
    if not nodes:
        return "<p>The model has no links.</p>"
    return (
        f'<figure class="tree"><div class="scroll" role="group" tabindex="0" aria-label="{escape_html(title)}">'
        f"{_draw_tree(nodes, marks)}</div>{_render_legend(nodes)}</figure>"
        f"<details><summary>The tree as a list</summary>{_render_list(nodes, marks)}</details>"
    )


# -- layout ------------------------------------------------------------------------------------------------------------


def lay_out_tree(nodes: Sequence[TreeNode]) -> tuple[list[TreeBox], bool]:
    """Where the boxes go, and whether they are layered (left to right) or indented (one below the other)."""
    layered = _lay_out_layered(nodes)
    if max(box.x + box.width for box in layered) <= WIDEST:
        return layered, True
    return _lay_out_indented(nodes), False


def _lay_out_layered(nodes: Sequence[TreeNode]) -> list[TreeBox]:
    """A column per depth, a row per leaf, each parent in the middle of its children."""
    deepest = max(node.depth for node in nodes)
    widths, gaps = [0.0] * (deepest + 1), [0.0] * (deepest + 1)
    for node in nodes:
        widths[node.depth] = max(widths[node.depth], _measure_node_width(node))
        if node.edge is not None:
            gaps[node.depth] = max(gaps[node.depth], 2 * GAP + 14 + _measure_label_width(node.edge))
    lefts = [0.0]
    for depth in range(1, deepest + 1):
        lefts.append(lefts[-1] + widths[depth - 1] + gaps[depth])
    rows = iter(range(len(nodes)))
    middles = [next(rows) * ROW + ROW / 2 if not node.children else 0.0 for node in nodes]
    first: dict[int, int] = {}
    last: dict[int, int] = {}
    for index, node in reversed(list(enumerate(nodes))):
        if node.children:
            middles[index] = (middles[first[index]] + middles[last[index]]) / 2
        first[node.parent] = index
        last.setdefault(node.parent, index)
    return [TreeBox(lefts[n.depth] + 1, y, _measure_node_width(n)) for n, y in zip(nodes, middles, strict=True)]


def _lay_out_indented(nodes: Sequence[TreeNode]) -> list[TreeBox]:
    """A row per node. An only child stays below its parent, so that a long chain does not run out of the page."""
    lefts: list[float] = []
    for node in nodes:
        if node.parent < 0:
            lefts.append(1.0)
        else:
            lefts.append(lefts[node.parent] + (0 if nodes[node.parent].children == 1 else INDENT))
    return [
        TreeBox(x, i * LINE + ROW / 2, _measure_node_width(n))
        for i, (n, x) in enumerate(zip(nodes, lefts, strict=True))
    ]


def _measure_node_width(node: TreeNode) -> float:
    return round(count_columns(shorten_name(node.name)) * ADVANCE + 2 * PAD + 20, 1)


def _measure_label_width(edge: TreeEdge) -> float:
    return max(count_columns(shorten_name(edge.name)), count_columns(edge.kind)) * SMALL + 18


def count_columns(text: str) -> int:
    return sum(2 if unicodedata.east_asian_width(c) in "WF" else 1 for c in text)


def shorten_name(name: str) -> str:
    """A name that fits: the middle goes, because robots tell their links apart at both ends."""
    half = LONGEST_NAME // 2
    return name if len(name) <= LONGEST_NAME else f"{name[: half - 1]}…{name[-half:]}"


# -- drawing -----------------------------------------------------------------------------------------------------------


def _draw_tree(nodes: Sequence[TreeNode], marks: Mapping[ElementKey, SeverityMark]) -> str:
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
            mark = marks.get(node.edge.element)
            order = mark.severity if mark is not None else 0 if node.edge.is_joint else -1
            edges.append((order, _draw_edge(node.edge, parent, box, is_layered, mark)))
            items.append(_draw_label(node.edge, parent, box, is_layered, mark))
        items.append(_draw_box(node, box, _find_node_mark(node, marks)))
    # Siblings share a stem: the worst is painted last, so that its colour is the one to be seen.
    drawn = "".join(path for _, path in sorted(edges, key=lambda e: e[0]))
    # Presentation attributes, so that the drawing is legible where a server's policy blocks the style.
    return (
        f'<svg class="graph" width="{width}" height="{height}" viewBox="0 0 {width} {height}" role="group" '
        f'aria-label="{format_count(len(nodes), "frame")}, drawn as a tree" font-family="monospace" font-size="12" '
        f'fill="none" stroke-width="1.5">'
        f"<g>{drawn}</g>{''.join(items)}</svg>"
    )


def _get_link_key(node: TreeNode) -> ElementKey | None:
    """The link that a box stands for, none where no link has its name."""
    return ("link", node.name) if node.kind in (LINK, REPEATED) else None


def _find_node_mark(node: TreeNode, marks: Mapping[ElementKey, SeverityMark]) -> SeverityMark | None:
    link = _get_link_key(node)
    if link is not None:
        return marks.get(link)
    # A frame that a launch file makes is as good as the transform that makes it.
    return marks.get(node.edge.element) if node.kind == LAUNCH and node.edge is not None else None


def _draw_edge(edge: TreeEdge, parent: TreeBox, child: TreeBox, is_layered: bool, mark: SeverityMark | None) -> str:
    if is_layered:
        start = parent.x + parent.width
        line = f"M{start:g} {parent.y:g}" + _trace_elbow(start + GAP, parent.y, child.x, child.y)
    elif child.x == parent.x:
        line = f"M{parent.x + 14:g} {parent.y + BOX / 2:g}V{child.y - BOX / 2:g}"
    else:
        x = parent.x + 14
        line = f"M{x:g} {parent.y + BOX / 2:g}V{child.y - 6:g}q0 6 6 6H{child.x:g}"
    return f'<path class="{_get_edge_class(edge, mark)}" stroke="currentColor"{_format_dashes(edge)} d="{line}"/>'


def _trace_elbow(bend: float, y0: float, x1: float, y1: float) -> str:
    if abs(y1 - y0) < 1:
        return f"H{x1:g}"
    r = min(8.0, abs(y1 - y0) / 2) * (1 if y1 > y0 else -1)
    return f"H{bend - abs(r):g}q{abs(r):g} 0 {abs(r):g} {r:g}V{y1 - r:g}q0 {r:g} {abs(r):g} {r:g}H{x1:g}"


def _format_dashes(edge: TreeEdge) -> str:
    if not edge.is_joint:
        return ' stroke-dasharray="7 4"'
    return ' stroke-dasharray="3 3"' if edge.kind == "fixed" else ""


def _get_edge_class(edge: TreeEdge, mark: SeverityMark | None) -> str:
    kind = "launch" if not edge.is_joint else "fixed" if edge.kind == "fixed" else "moving"
    return f"edge {kind}" if mark is None else f"edge {kind} {mark.severity}"


def _draw_label(edge: TreeEdge, parent: TreeBox, box: TreeBox, is_layered: bool, mark: SeverityMark | None) -> str:
    sign = "" if mark is None else f'<use href="#g-{mark.severity}" width="12" height="12" %s/>'
    if is_layered:
        x = parent.x + parent.width + GAP + 12
        y = box.y
        lines = [(edge.name, y - 5), (edge.kind, y + 14)] if edge.name else [(edge.kind, y - 5)]
        text = "".join(
            f'<text class="{"joint" if i == 0 else "type"}" x="{x + (16 if mark and i == 0 else 0):g}" y="{at:g}">'
            f"{escape_html(shorten_name(line))}</text>"
            for i, (line, at) in enumerate(lines)
        )
        sign = sign % f'x="{x:g}" y="{y - 15:g}"' if sign else ""
    else:
        x = box.x + box.width + GAP - 6
        sign = sign % f'x="{x:g}" y="{box.y - 6:g}"' if sign else ""
        text = (
            f'<text class="joint" x="{x + (16 if mark else 0):g}" y="{box.y + 4:g}">{escape_html(shorten_name(edge.name))}'
            f'<tspan class="type">{" · " if edge.name else ""}{escape_html(edge.kind)}</tspan></text>'
        )
    what = f"joint {edge.name}, {edge.kind}" if edge.is_joint else "static transform of a launch file"
    kind = _get_edge_class(edge, mark).replace("edge ", "label ")
    drawn = (
        f'<g class="{kind}"{render_data_attribute(edge.element)} fill="currentColor" font-size="11">'
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
        f'<g class="{kind}"{render_data_attribute(_get_link_key(node))}><title>{escape_html(_format_tooltip(what, mark))}</title>'
        f'<rect x="{box.x:g}" y="{top:g}" width="{box.width:g}" '
        f'height="{BOX}" rx="6" stroke="currentColor"{dashes}/><g fill="currentColor">{sign}'
        f'<text x="{left:g}" y="{box.y + 4:g}">{escape_html(shorten_name(node.name)) or "(no name)"}</text></g></g>'
    )
    return drawn if mark is None else f'<a href="#{mark.anchor}">{drawn}</a>'


def _format_tooltip(description: str, mark: SeverityMark | None) -> str:
    if mark is None:
        return description
    return f"{description}: {mark.severity}" + (f", the worst of {mark.count} findings" if mark.count > 1 else "")


def _render_legend(nodes: Sequence[TreeNode]) -> str:
    kinds = {_get_edge_class(n.edge, None): n.edge for n in nodes if n.edge is not None}
    names = {"edge moving": "moving joint", "edge fixed": "fixed joint", "edge launch": "launch file"}
    items = "".join(
        f'<li><svg class="graph" width="34" height="10" aria-hidden="true" focusable="false" fill="none" stroke-width="1.5">'
        f'<path class="{kind}" stroke="currentColor"{_format_dashes(kinds[kind])} d="M1 5H33"/></svg> {name}</li>'
        for kind, name in names.items()
        if kind in kinds
    )
    return f'<figcaption><ul class="legend">{items}</ul></figcaption>' if items else ""


# -- text form ---------------------------------------------------------------------------------------------------------


def _render_list(nodes: Sequence[TreeNode], marks: Mapping[ElementKey, SeverityMark]) -> str:
    """Nested lists; each line names its parent, so that the cut at :data:`DEEPEST_LIST` loses nothing."""
    parts: list[str] = []
    level = -1
    for node in nodes:
        depth = min(node.depth, DEEPEST_LIST)
        parts.append("<ul>" * (depth - level) if depth > level else "</li>" + "</ul></li>" * (level - depth))
        parts.append(f"<li>{_render_list_item(node, nodes, marks)}")
        level = depth
    return "".join(parts) + "</li></ul>" * (level + 1)


def _render_list_item(node: TreeNode, nodes: Sequence[TreeNode], marks: Mapping[ElementKey, SeverityMark]) -> str:
    text = f"<code{render_data_attribute(_get_link_key(node))}>{escape_html(node.name)}</code>"
    if node.kind != LINK:
        text += f" ({NOTES[node.kind]})"
    text += _render_mark_link(marks.get(("link", node.name)) if node.kind == LINK else None)
    if node.edge is None:
        return text
    parent = f"<code>{escape_html(nodes[node.parent].name)}</code>"
    if not node.edge.is_joint:
        return f"{text}, placed on {parent} by a launch file" + _render_mark_link(marks.get(node.edge.element))
    joint = f"<code{render_data_attribute(node.edge.element)}>{escape_html(node.edge.name)}</code> ({escape_html(node.edge.kind)})"
    return f"{text}, on {parent} by joint {joint}" + _render_mark_link(marks.get(node.edge.element))


def _render_mark_link(mark: SeverityMark | None) -> str:
    if mark is None:
        return ""
    return f' <a class="{mark.severity}" href="#{mark.anchor}">{render_glyph(mark.severity)} {mark.severity}</a>'
