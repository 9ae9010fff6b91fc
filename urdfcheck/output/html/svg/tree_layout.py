"""The layout of the kinematic tree."""

from __future__ import annotations

from collections.abc import Sequence

from urdfcheck.core.records import dataclass
from urdfcheck.output.html.svg.label_text import ADVANCE, SMALL, count_columns, shorten_name
from urdfcheck.output.shared.kinematic_forest import TreeEdge, TreeNode

BOX, PAD, ROW, LINE, INDENT, GAP = 28, 10, 44, 37, 30, 18
# A wider drawing would need scrolling on a laptop: its boxes are placed one below the other.
WIDEST = 820


@dataclass(frozen=True, slots=True)
class TreeBox:
    """A placed node: its left edge, the middle of its height and its width, in px."""

    x: float
    y: float
    width: float


def lay_out_tree(nodes: Sequence[TreeNode]) -> tuple[list[TreeBox], bool]:
    """Place the boxes; return them and whether they are layered (left to right) or indented (one below the other)."""
    layered = _lay_out_layered(nodes)
    if max(box.x + box.width for box in layered) <= WIDEST:
        return layered, True
    return _lay_out_indented(nodes), False


def _lay_out_layered(nodes: Sequence[TreeNode]) -> list[TreeBox]:
    """Place a column per depth and a row per leaf, each parent in the middle of its children."""
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
    """Place a row per node. An only child is not indented, so that a long chain does not run off the page."""
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
